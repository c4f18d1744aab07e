"""`JaxEngine`: simulation by MJX over a bank of scenes, with a different scene per env.

In:   `SceneBank`, `RobotSpec`; then `SimState` and actuator commands.
Out:  `SimState`.
When: every control step, inside jit, alone or under `jax.vmap`.

MJX's public functions compute the robot's dynamics; `hull_contact` computes contacts with the hulls that `static_slots`
selects near the robot, and `constraint` solves for the acceleration. The bank is stored on the device, and an env's
scene is data, so changing it needs no compilation.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from mujoco import mjx

from ...datatypes import AgentMotion, AgentShapes, Contacts, RobotSpec, SceneBank, SimState
from ...datatypes import validation as v
from ...precision import full_precision
from ..collision_slots import agent_slots, body_slots, hull_contact, static_slots
from ..engine_base import EngineBase, Substeps
from . import body_dynamics, constraint


class EngineTables(NamedTuple):
    """The bank on the device.

    Attributes:
      hulls: see `HullTable`.
      objects, prisms: see `InstanceTable`.
      grid_origin: (Z, 2) m.
      grid_cell: () m.
    """

    hulls: hull_contact.HullTable
    objects: static_slots.InstanceTable
    prisms: static_slots.InstanceTable
    grid_origin: Any
    grid_cell: Any


class _Touch(NamedTuple):
    """Touches gathered over the physics steps of one control step."""

    force: Any
    owner: Any
    ground: Any
    count: Any
    missed: Any
    foot: Any
    agent: Any = None
    agent_force: Any = None


class _Moving(NamedTuple):
    """State that a physics step changes: joints, the solver's warm start, contacts so far, and awake bodies."""

    qpos: Any
    qvel: Any
    warm: Any
    touch: _Touch
    awake: body_slots.Awake | None


class JaxEngine(EngineBase):
    """Simulates one robot per env in any scene of a bank; implements `Simulator`.

    Args:
      bank: the scenes.
      robot: the robot; all its collision geoms are spheres.
      control_dt: s, a multiple of the robot's physics time step.
      num_slots: least number of object hulls per control step, increased if the bank's streets need more; 0 for only
        ground.
      num_prism_slots: least number of ground prisms per control step, increased if the streets need more.
      num_contacts: largest number of simultaneous contacts of spheres with hulls.
      iterations, line_steps: largest numbers of iterations of the constraint solver and of its line search.
      agents: shapes of moving agents, whose motion is passed to `step`; None = none.
      movable: sizes for objects that can be pushed, which are passed to `init`; None = none.
      friction: of `engine_base.FRICTIONS`, see `make_engine`.

    Raises:
      ValidationError: the control period is not a multiple of the time step, there are too many or no slots, or the
        bank's grids have a shorter reach than the robot in one control step.
    """

    def __init__(
        self,
        bank: SceneBank,
        robot: RobotSpec,
        control_dt: float = 0.2,
        num_slots: int = 16,
        num_prism_slots: int = 8,
        num_contacts: int = 12,
        iterations: int = 10,
        line_steps: int = 8,
        agents: AgentShapes | None = None,
        movable: body_slots.Sizes | None = None,
        friction: str = "uniform",
    ) -> None:
        super().__init__(bank, robot, control_dt, num_slots, num_prism_slots, agents, movable, friction)
        self._data = mjx.make_data(self.physics.model)
        self.num_contacts = v.integer(num_contacts, "engine.num_contacts", 1, self.num_pairs)
        self.iterations = v.integer(iterations, "engine.iterations", 1)
        self.line_steps = v.integer(line_steps, "engine.line_steps", 1)
        objects, prisms = jax.tree.map(jnp.asarray, static_slots.instance_tables(bank, self.materials))
        self.tables = EngineTables(
            hull_contact.hull_table(bank), objects, prisms, jnp.asarray(bank.grid_origin), jnp.asarray(bank.grid_cell)
        )
        if self.movable is not None:
            self._prism_planes = body_dynamics.prism_planes(bank, self.tables.hulls)
            self._boxes = jnp.asarray(bank.hull_box)
        self._grid_shape = (bank.hull_grid.shape[1], bank.hull_grid.shape[2])
        first = int(self.physics.model.jnt_qposadr[self.physics.model.body_jntadr[self.physics.root]])
        self._root_qpos = slice(first, first + 3)

    def step(self, state: SimState, ctrl: Any, agents: AgentMotion | None = None) -> SimState:
        """One control step with the commands `ctrl` (nu,) held."""
        return self.step_and_record(state, ctrl, agents)[0]

    @full_precision
    def step_and_record(
        self, state: SimState, ctrl: Any, agents: AgentMotion | None = None
    ) -> tuple[SimState, Substeps]:
        """`step` with a record of its physics steps."""
        self.check_agents(agents)
        centre = state.xpos[self.physics.root]
        taken = None if state.bodies is None else state.bodies.object_index
        nearby, overflow = self.find_slots(state.scene, centre, taken)
        ctrl = jnp.asarray(ctrl, jnp.float32)
        # Tens of metres from the origin, the resolution of float32 is a few micrometres, too coarse for lever arms and
        # for tyres that penetrate by 0.2 mm. The physics therefore uses a whole-metre origin near the robot.
        origin = jnp.round(centre).at[2].set(0.0)
        nearby = nearby._replace(position=nearby.position - origin)
        model = self._scaled_model(state.mass_scale)
        if agents is not None:
            agents = agents._replace(position=agents.position - origin)
        awake, slot, around, scenery = None, None, state.bodies, None
        if around is not None:
            slot, awake, asleep = self._wake(state, centre)
            overflow += asleep
            scenery = self._scenery(state, awake, origin)
            awake = awake._replace(place=awake.place - origin)

        def substep(before: _Moving, number: Any) -> tuple[_Moving, Substeps]:
            met = None if agents is None else agent_slots.moved(agents, number * self.robot.physics_timestep)
            after = self._physics_step(model, state.friction_scale, nearby, met, scenery, ctrl, before)
            touched = after.touch.count > before.touch.count
            return after, Substeps(after.qpos.at[self._root_qpos].add(origin), touched)

        zero, none = jnp.zeros((), jnp.int32), jnp.full((), -1, jnp.int32)
        feet = jnp.zeros(len(self.robot.foot_geoms))
        touch = _Touch(jnp.zeros(()), none, jnp.zeros((), bool), zero, zero, feet)
        numbers = None
        if agents is not None:
            touch, numbers = touch._replace(agent=none, agent_force=jnp.zeros(())), jnp.arange(self.num_substeps)
        start = _Moving(state.qpos.at[self._root_qpos].add(-origin), state.qvel, state.carry, touch, awake)
        (qpos, qvel, warm, touch, awake), record = jax.lax.scan(substep, start, numbers, length=self.num_substeps)
        qpos = qpos.at[self._root_qpos].add(origin)
        data = mjx.kinematics(self.physics.mjx_model, self._data.replace(qpos=qpos, qvel=qvel))
        contacts = Contacts(
            hit=touch.count > 0,
            hit_object=touch.owner if agents is None else jnp.maximum(touch.owner, -1),
            hit_ground=touch.ground,
            hit_force=touch.force,
            hit_fraction=touch.count / self.num_substeps,
            foot_force=touch.foot / self.num_substeps,
            hit_agent=touch.agent,
        )
        missed = overflow + touch.missed
        if around is not None and awake is not None:
            awake = awake._replace(place=awake.place + origin)
            around = body_slots.put_back(self.body_constants, around, slot, awake)
        after = state._replace(
            qpos=qpos,
            qvel=qvel,
            xpos=data.xpos,
            xquat=data.xquat,
            contacts=contacts,
            slot_overflow=missed,
            carry=warm,
            bodies=around,
        )
        return after, record

    def find_slots(self, scene: Any, centre: Any, taken: Any = None) -> tuple[static_slots.Slots, Any]:
        """The hulls near `centre` (3,) in a scene, objects first, and () i32, how many within reach found no slot.

        taken: (M,) i32, objects that are bodies and so no static hulls; None = no such.
        """
        tables = self.tables
        cell = static_slots.grid_cell(tables.grid_origin[scene], tables.grid_cell, self._grid_shape, centre)
        hulls, missing = static_slots.nearest(tables.objects, cell, scene, centre, self.reach, self.num_slots, taken)
        prisms, absent = static_slots.nearest(tables.prisms, cell, scene, centre, self.reach, self.num_prism_slots)
        return static_slots.join(hulls, prisms), missing + absent

    def find_contacts(self, centres: Any, radii: Any, slots: static_slots.Slots) -> hull_contact.SphereContacts:
        """The contacts of spheres (S, 3) m, (S,) m with hulls; see `hull_contact.find_contacts`."""
        sizes = self.num_contacts, self.num_contacts if self.crowded else 0
        return hull_contact.find_contacts(centres, radii, slots, self.tables.hulls, *sizes)

    def _wake(self, state: SimState, centre: Any) -> tuple[Any, body_slots.Awake, Any]:
        assert self.movable is not None
        assert state.bodies is not None
        return body_slots.wake(self.body_constants, state.scene, state.bodies, centre, self.reach, self.movable.awake)

    def _scenery(self, state: SimState, awake: body_slots.Awake, origin: Any) -> body_dynamics.Scenery:
        """What stands near each of the bodies, about the origin (3,)."""
        assert state.bodies is not None
        tables, scene, objects = self.tables, state.scene, state.bodies.object_index

        def near(place: Any, reach: Any) -> Any:
            cell = static_slots.grid_cell(tables.grid_origin[scene], tables.grid_cell, self._grid_shape, place)
            where = cell, scene, place, reach
            prisms, _ = static_slots.nearest(tables.prisms, *where, body_slots.PRISMS)
            hulls, _ = static_slots.nearest(tables.objects, *where, body_slots.HULLS, objects)
            return prisms, hulls

        reach = body_slots.reach(self.body_constants, awake, self.control_dt)
        found = jax.vmap(near)(awake.place, reach)
        prisms, hulls = (x._replace(position=x.position - origin) for x in found)
        return body_dynamics.Scenery(prisms, hulls, self._prism_planes, self._boxes, tables.hulls)

    def _scaled_model(self, mass_scale: Any) -> Any:
        """The robot's model with all its masses multiplied by () mass_scale."""
        model = self.physics.mjx_model
        names = ("body_mass", "body_inertia", "body_subtreemass")
        return model.tree_replace({name: getattr(model, name) * mass_scale for name in names})

    def _physics_step(
        self,
        model: Any,
        friction_scale: Any,
        nearby: static_slots.Slots,
        agents: AgentMotion | None,
        scenery: body_dynamics.Scenery | None,
        ctrl: Any,
        before: _Moving,
    ) -> _Moving:
        qpos, qvel, warm, touch, awake = before
        spheres, dt = self.physics.spheres, self.robot.physics_timestep
        data = self._data.replace(qpos=qpos, qvel=qvel, ctrl=ctrl)
        for stage in (mjx.kinematics, mjx.com_pos, mjx.crb, mjx.factor_m, mjx.transmission, mjx.fwd_velocity):
            data = stage(model, data)
        data = mjx.fwd_acceleration(model, mjx.fwd_actuation(model, data))
        radii = jnp.asarray(spheres.radius, jnp.float32)
        places = data.geom_xpos[spheres.geom]
        own, static = None, nearby.hull.shape[0]
        if awake is not None:
            own = body_dynamics.matter(self.body_constants, awake)
            hulls = body_dynamics.hull_slots(awake, own)
            nearby = static_slots.join(nearby, hulls)
        found = self.find_contacts(places, radii, nearby)
        if agents is not None and self.agents is not None:
            room = self.num_agent_contacts
            found, nearby = agent_slots.with_agents(found, places, radii, agents, self.agents, nearby, room)
        centre = data.subtree_com[self.physics.root]
        grip = nearby.friction, friction_scale
        mass, free, pushed, speed = mjx.full_m(model, data), data.qacc_smooth, None, qvel
        if awake is not None and own is not None:
            pushed = body_dynamics.pushed(found.slot - static, awake, own)
            mass = body_dynamics.joint_mass(mass, awake, own)
            free = jnp.concatenate([free, body_dynamics.free_acceleration(awake, own)])
            speed = jnp.concatenate([qvel, body_dynamics.velocities(awake)])
            warm = jnp.concatenate([warm, awake.warm.reshape(-1)])
        least = self.materials
        rows = constraint.contact_rows(found, spheres, *grip, data.cdof, centre, speed, dt, pushed, least)
        if awake is not None and own is not None and scenery is not None:
            theirs = body_dynamics.find_contacts(awake, own, hulls, scenery, least)
            rows = constraint.join(rows, body_dynamics.contact_rows(theirs, awake, own, speed, dt))
        if len(self.physics.limits.dof):
            rows = constraint.join(rows, constraint.limit_rows(self.physics.limits, data.qpos, speed, dt))
        qacc, force = constraint.solve(mass, free, warm, rows, self.iterations, self.line_steps)
        pull, robot = force @ rows.jacobian, qvel.shape[0]
        if awake is not None:
            awake = body_dynamics.moved(awake, qacc[robot:], dt)
            qacc, pull = qacc[:robot], pull[:robot]
        data = mjx.euler(model, data.replace(qacc=qacc, qfrc_constraint=pull))
        normal_force = force[: 4 * len(found.sphere)].reshape(-1, 4).sum(1)
        return _Moving(data.qpos, data.qvel, qacc, self._note(touch, found, nearby, normal_force), awake)

    def _note(
        self, touch: _Touch, found: hull_contact.SphereContacts, nearby: static_slots.Slots, force: Any
    ) -> _Touch:
        """Adds the contacts of one physics step: robot against object, and no foot against the ground."""
        owner = nearby.owner[found.slot]
        touching = found.distance < 0
        foot = jnp.asarray(self.physics.spheres.foot)[found.sphere]
        on_ground = touching & (owner < 0) & (foot < 0)
        hit = (touching & (owner >= 0)) | on_ground
        if self.agents is not None:
            met = touching & (owner <= agent_slots.FIRST_OWNER)
            on_ground &= ~met
            hit |= met
            touch = agent_slots.noted(touch, met, owner, force)
        strength = jnp.where(hit, force, -1.0)
        best = jnp.argmax(strength)
        # A product with zeros and ones is faster than a scatter.
        loads = force @ (foot[:, None] == jnp.arange(len(self.robot.foot_geoms))).astype(force.dtype)
        stronger = (strength[best] > touch.force) | ((touch.count == 0) & hit.any())
        return touch._replace(
            force=jnp.maximum(touch.force, strength[best]),
            owner=jnp.where(stronger, owner[best], touch.owner),
            ground=touch.ground | on_ground.any(),
            count=touch.count + hit.any().astype(jnp.int32),
            missed=jnp.maximum(touch.missed, found.missed),
            foot=touch.foot + loads,
        )
