"""A batch of worlds in MuJoCo Warp: their data, and a control step."""

import copy
import functools
import warnings
from collections.abc import Callable, Sequence
from typing import Any

import mujoco_warp as mjw
import numpy as np
import warp as wp

from ...datatypes import AgentShapes
from ..collision_slots import body_slots
from . import agents as warp_agents
from . import bodies as warp_bodies
from . import body_types, contact, kernels
from .model import DeviceModel


class WorldBatch:
    """Worlds that are stepped together, with MuJoCo Warp's data and the launches of a physics step.

    On the CPU a batch runs on one core: Warp's tile kernels keep their scratch memory in one place per process.

    Args:
      shared: the model and the tables of the bank.
      number: worlds.
      num_objects, num_prisms: slots of either kind.
      num_contacts: contacts a world can hold.
      recorded: physics steps per control step that are recorded; 0 records none.
      graphs: whether the physics step is captured once and replayed, or launched kernel by kernel every time.
      agents: shapes of the agent slots behind those of hulls; None = none.
      movable: sizes of the body slots, whose hulls stand between both; None = none.
    """

    def __init__(
        self,
        shared: DeviceModel,
        number: int,
        num_objects: int,
        num_prisms: int,
        num_contacts: int,
        recorded: int,
        graphs: bool,
        agents: AgentShapes | None,
        movable: body_slots.Sizes | None = None,
    ) -> None:
        self.shared, self.number, self.recorded = shared, number, recorded
        self.num_objects, self.num_prisms = num_objects, num_prisms
        model = shared.robot.model
        limits = int(np.count_nonzero(model.jnt_limited))
        self.data = mjw.make_data(model, nworld=number, nconmax=num_contacts, njmax=4 * num_contacts + limits)
        shape = (number, num_objects + num_prisms)
        theirs = 0 if movable is None else movable.awake * movable.hulls
        self.agents = None if agents is None else self._make_agents(agents, shape[1] + theirs, model.opt.timestep)
        self.nearby = kernels.Nearby()
        self.nearby.row, self.nearby.distance = wp.empty(shape, dtype=int), wp.empty(shape, dtype=float)
        self.nearby.missing = wp.empty((number, 2), dtype=int)
        self.num_hulls, self.num_convex = shape[1], shape[1] + theirs
        shape = (number, self.num_convex + (0 if agents is None else len(agents.radius)))
        self.slots = contact.Slots()
        # Nothing stands anywhere before the first call.
        self.slots.hull, self.slots.owner = wp.full(shape, -1, dtype=int), wp.full(shape, -1, dtype=int)
        self.slots.position, self.slots.rotation = wp.zeros(shape, dtype=wp.vec3), wp.zeros(shape, dtype=wp.mat33)
        self.slots.geom = wp.full(shape, shared.robot.ground, dtype=int)
        self.slots.friction = wp.zeros(shape, dtype=float)
        self.slots.friction_scale = wp.ones(number, dtype=float)
        self.slots.least = int(shared.materials)
        self.masses, self.model = self._make_masses(model.nbody)
        self.nothing = wp.zeros((number, 0), dtype=int)
        self.bodies = None if movable is None else self._make_bodies(movable)
        self.places = self._make_places(num_contacts)
        self.touch = kernels.Touch()
        self.touch.force, self.touch.agent_force = wp.zeros(number, dtype=float), wp.zeros(number, dtype=float)
        for name in ("owner", "ground", "count", "missed", "agent"):
            setattr(self.touch, name, wp.zeros(number, dtype=int))
        self.touch.foot = wp.zeros((number, shared.num_feet), dtype=float)
        self.origin = wp.zeros(number, dtype=wp.vec3)
        self.step_number, self.seen = wp.zeros(number, dtype=int), wp.zeros(number, dtype=int)
        self.path = wp.zeros((number, recorded, shared.robot.physics.model.nq), dtype=float)
        self.hit = wp.zeros((number, recorded), dtype=int)
        self._substep, self._kinematics = self._physics_step, self._place_bodies
        if graphs:
            self._substep, self._kinematics = _captured(self._physics_step), _captured(self._place_bodies)

    def _make_places(self, room: int) -> Any:
        """Room for contacts in MuJoCo Warp's arrays, so much for each world; all of it counts, unused types are 0."""
        found, out = self.data.contact, contact.Places()
        for array in (found.type, found.includemargin, found.geomcollisionid, found.adhesion, found.solreffriction):
            array.zero_()
        found.worldid.assign(np.repeat(np.arange(self.number, dtype=np.int32), room))
        self.data.nacon.fill_(self.number * room)
        out.count, out.room = wp.zeros(self.number, dtype=int), room
        out.slot = wp.zeros(self.number * room, dtype=int)
        for name in ("type", "dim", "geom", "dist", "pos", "frame", "friction", "solref", "solimp"):
            setattr(out, name, getattr(found, name))
        out.address = found.efc_address
        return out

    def _make_agents(self, shapes: AgentShapes, hulls: int, timestep: float) -> Any:
        out, size = warp_agents.Agents(), (self.number, len(shapes.radius))
        out.place, out.velocity = wp.zeros(size, dtype=wp.vec3), wp.zeros(size, dtype=wp.vec3)
        out.turn, out.turn_rate = wp.zeros(size, dtype=float), wp.zeros(size, dtype=float)
        out.present, out.hulls, out.dt = wp.zeros(size, dtype=int), hulls, timestep
        out.radius, out.half, out.height = (wp.array(a, dtype=float) for a in shapes)
        return out

    def _make_masses(self, bodies: int) -> tuple[Any, Any]:
        """Masses of the robot in each world, and the shared model that looks for them there."""
        masses, model = kernels.Masses(), copy.copy(self.shared.model)
        shape = (self.number, bodies)
        masses.mass, masses.subtree = wp.zeros(shape, dtype=float), wp.zeros(shape, dtype=float)
        masses.inertia = wp.zeros(shape, dtype=wp.vec3)
        model.body_mass, model.body_inertia, model.body_subtreemass = masses.mass, masses.inertia, masses.subtree
        return masses, model

    def _make_bodies(self, sizes: body_slots.Sizes) -> Any:
        """Room for the bodies that are awake, and their geoms in the slots of their hulls."""
        free, table = self.shared.robot.bodies, self.shared.body_table
        assert free is not None, "an engine with body slots has bodies"
        assert table is not None, "a model with bodies has their table"
        out, each = body_types.Bodies(), (self.number, free.number)
        near, points = (*each, body_slots.PRISMS + body_slots.HULLS), (*each, table.points.shape[1])
        out.row = wp.full(each, -1, dtype=int)
        out.near_row, out.near_distance = (wp.zeros((each[0] * each[1], near[2]), dtype=t) for t in (int, float))
        out.near_hull, out.near_friction = wp.zeros(near, dtype=int), wp.zeros(near, dtype=float)
        out.near_position, out.near_rotation = wp.zeros(near, dtype=wp.vec3), wp.zeros(near, dtype=wp.mat33)
        out.position, out.rotation = wp.zeros(each, dtype=wp.vec3), wp.zeros(each, dtype=wp.mat33)
        for name in ("point", "ground_normal", "other_normal"):
            setattr(out, name, wp.zeros(points, dtype=wp.vec3))
        for name in ("ground_depth", "ground_friction", "other_depth", "other_friction"):
            setattr(out, name, wp.zeros(points, dtype=float))
        out.other_geom = wp.zeros(points, dtype=int)
        described = np.tile(self.shared.robot.model.body_invweight0[None], (self.number, 1, 1))
        out.invweight = wp.array(described, dtype=wp.vec2)
        self.model.body_invweight0 = out.invweight
        out.first_qpos, out.first_dof, out.first_body, out.first_geom = free.qpos, free.dof, free.body, free.geom
        out.first_slot, out.ground = self.num_hulls, self.shared.robot.ground
        out.least = int(self.shared.materials)
        geom = self.slots.geom.numpy()
        geom[:, self.num_hulls : self.num_convex] = (
            free.geom + np.arange(self.num_convex - self.num_hulls) // sizes.hulls
        )
        self.slots.geom.assign(geom)
        return out

    @property
    def is_captured(self) -> bool:
        """Whether the physics step is a graph that is replayed."""
        return self._substep != self._physics_step

    def control_step(self, inputs: Sequence[wp.array], outputs: Sequence[wp.array], substeps: int) -> None:
        """Reads states, finds slots, runs the physics and writes the new states; see `WarpEngine._run`."""
        scene, centre, qpos, qvel, warm, ctrl, friction, mass, *others = inputs
        agents, (taken, row, object_index, body) = others, (self.nothing, None, None, None)
        if self.bodies is not None:
            *agents, taken, row, object_index, body = others
        shared, tables, data, n = self.shared, self.shared.tables, self.data, self.number
        launch = functools.partial(wp.launch, device=self.shared.device)
        where = [tables, scene, centre, self.num_objects]
        launch(kernels.find_slots, dim=(n, 2), inputs=[*where, self.num_prisms, self.nearby, taken])
        launch(kernels.place_slots, dim=(n, self.num_hulls), inputs=[*where, self.nearby, self.slots])
        state, root = [data.qpos, data.qvel, data.qacc_warmstart, data.ctrl], self.shared.robot.root
        scales = [friction, mass, self.shared.masses, self.slots, self.masses]
        here = [root, *state, self.origin, self.touch, self.step_number]
        launch(kernels.begin, dim=n, inputs=[centre, qpos, qvel, warm, ctrl, *scales, *here])
        if self.agents is not None:
            moving = [*agents, self.origin, self.slots, self.agents]
            launch(warp_agents.begin_agents, dim=self.agents.present.shape, inputs=moving)
        if self.bodies is not None:
            own = [shared.body_table, self.slots, self.masses, self.bodies]
            moves = [row, object_index, body, self.origin, *own, *state[:3]]
            launch(warp_bodies.begin_bodies, dim=self.bodies.row.shape, inputs=moves)
            step = substeps * shared.robot.model.opt.timestep
            near = [tables, scene, body, taken, step, self.origin, shared.body_table, self.bodies]
            launch(warp_bodies.find_near, dim=(*self.bodies.row.shape, 2), inputs=near)
        # The solver reads some values past the last row and multiplies them by zero, which would propagate a NaN of an
        # earlier state.
        data.efc.J.zero_()
        data.efc.D.zero_()
        for _ in range(substeps):
            self._substep()
        self._kinematics()
        after = [*state[:3], data.xpos, data.xquat, self.origin, root, self.touch, self.nearby]
        launch(kernels.finish, dim=n, inputs=after, outputs=list(outputs[:8]))
        if self.bodies is not None:
            moved = [*state[:3], self.origin, shared.body_table, self.bodies]
            launch(warp_bodies.finish_bodies, dim=self.bodies.row.shape, inputs=moved, outputs=[outputs[10]])
        if self.recorded:
            wp.copy(outputs[8], self.path)
            wp.copy(outputs[9], self.hit)

    def _physics_step(self) -> None:
        """The step of MuJoCo Warp with the collision detection of this package; see docs/decisions/warp_engine.md."""
        model, data, shared = self.model, self.data, self.shared
        for stage in (mjw.kinematics, mjw.com_pos, mjw.crb):
            stage(model, data)
        if self.bodies is not None:
            placed = [shared.body_table, data.xpos, data.xquat, self.slots, self.bodies]
            wp.launch(warp_bodies.place_bodies, dim=self.bodies.row.shape, inputs=placed)
        wp.launch(
            contact.find_contacts,
            dim=(self.number, self.num_convex),
            inputs=[shared.hulls, shared.spheres, self.slots, data.geom_xpos, self.places],
        )
        if self.agents is not None:
            meeting = [shared.spheres, self.slots, self.agents, data.geom_xpos, self.places]
            wp.launch(warp_agents.find_agent_contacts, dim=self.agents.present.shape, inputs=meeting)
        if self.bodies is not None:
            deep = [shared.body_table, shared.hulls, self.slots, self.bodies]
            wp.launch(warp_bodies.find_depths, dim=self.bodies.point.shape, inputs=deep)
            put = [shared.body_table, data.xpos, self.bodies, self.places]
            wp.launch(warp_bodies.put_contacts, dim=self.bodies.row.shape, inputs=put)
        for stage in (mjw.make_constraint, mjw.transmission, mjw.fwd_velocity, mjw.fwd_actuation):
            stage(model, data)
        mjw.fwd_acceleration(model, data, factorize=True)
        mjw.solve(model, data)
        mjw.euler(model, data)
        touches = [shared.foot_of, self.slots, data.efc.force, self.places, self.touch]
        wp.launch(kernels.note, dim=self.number, inputs=touches)
        if self.recorded:
            path = [data.qpos, self.origin, shared.robot.root, self.touch, self.step_number, self.seen]
            wp.launch(kernels.record, dim=self.number, inputs=[*path, self.path, self.hit])

    def _place_bodies(self) -> None:
        mjw.kinematics(self.model, self.data)


def _captured(launches: Callable[[], None]) -> Callable[[], None]:
    """Records what `launches` launches, to be replayed without Python; `launches` itself where that is not possible."""
    # Kernels are compiled and loaded at their first launch, which a capture does not allow.
    launches()
    try:
        with wp.ScopedCapture() as capture:
            launches()
    except RuntimeError as error:
        warnings.warn(f"found no graph capture ({error}); physics steps are launched one by one, slowly", stacklevel=2)
        return launches
    graph = capture.graph
    return launches if graph is None else functools.partial(wp.capture_launch, graph)
