"""`WarpEngine`: simulation by MuJoCo Warp over a bank of scenes, with a different scene per env.

In:   `SceneBank`, `RobotSpec`; then `SimState` and actuator commands.
Out:  `SimState`.
When: every control step, inside jit, alone or under any nesting of `jax.vmap`.

A control step is one call into Warp, which selects slots, runs the physics steps and sums contacts. The bank is stored
on the Warp device, and an env's scene is data, so changing it needs no compilation.
"""

import functools
from collections.abc import Callable, Generator, Mapping, Sequence
from typing import Any

import jax
import jax.numpy as jnp
import warp as wp

from ...datatypes import AgentMotion, AgentShapes, Contacts, RobotSpec, SceneBank, SimState
from ...datatypes import validation as v
from ..collision_slots import body_slots
from ..engine_base import EngineBase, Substeps
from ..segments import staged
from ..warp_bridge import DeviceStore, batched_call, device_lock, jax_callable, register
from . import bodies_input
from .batch import WorldBatch
from .bodies_input import STATE
from .fused import FusedBatch, build_program, load_steps, make_step
from .model import DeviceModel, build_robot_model

__all__ = ["WarpEngine"]


#: What goes in and what comes out, in the order of `WarpEngine._run`.
_STATE = {
    "scene": wp.array[wp.int32],
    "centre": wp.array[wp.vec3],
    "qpos": wp.array2d[wp.float32],
    "qvel": wp.array2d[wp.float32],
    "warm": wp.array2d[wp.float32],
    "ctrl": wp.array2d[wp.float32],
    "friction": wp.array[wp.float32],
    "mass": wp.array[wp.float32],
}
_AGENTS = {
    "position": wp.array2d[wp.vec3],
    "heading": wp.array2d[wp.float32],
    "velocity": wp.array2d[wp.vec3],
    "turn_rate": wp.array2d[wp.float32],
    "present": wp.array2d[wp.int32],
}
_BODIES = {
    "taken": wp.array2d[wp.int32],
    "row": wp.array2d[wp.int32],
    "object_index": wp.array2d[wp.int32],
    "body": wp.array3d[wp.float32],
}
_AFTER = {
    "qpos_out": wp.array2d[wp.float32],
    "qvel_out": wp.array2d[wp.float32],
    "warm_out": wp.array2d[wp.float32],
    "xpos": wp.array2d[wp.vec3],
    "xquat": wp.array2d[wp.vec4],
    "force": wp.array[wp.float32],
    "touch": wp.array2d[wp.int32],
    "feet": wp.array2d[wp.float32],
    "path": wp.array3d[wp.float32],
    "hit": wp.array2d[wp.int32],
}
_BODIES_AFTER = {"body_out": wp.array3d[wp.float32]}


@functools.cache
def _call_into_warp(agents: bool, bodies: bool) -> Any:
    """What JAX calls; with bodies but no agents the agents' arrays are empty."""
    inputs = _STATE | (_AGENTS if agents or bodies else {}) | (_BODIES if bodies else {})
    outputs = _AFTER | (_BODIES_AFTER if bodies else {})
    return jax_callable("WarpEngine.step", WarpEngine._run, inputs, outputs)


class WarpEngine(EngineBase):
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
      graphs: whether physics steps are captured once as CUDA graph and replayed; disable for debugging.
      agents: shapes of moving agents, whose motion is passed to `step`; None = none.
      movable: sizes for objects that can be pushed, which are passed to `init`; None = none.
      friction: of `engine_base.FRICTIONS`, see `make_engine`.
      fused: whether all physics steps of a control step are one launch, see docs/decisions/fused_step.md, instead of
        MuJoCo Warp's kernels.

    Raises:
      ValidationError: the control period is not a multiple of the time step, there are too many or no slots, the
        bank's grids have a shorter reach than the robot in one control step, or the step of this robot is not fused.
    """

    def __init__(
        self,
        bank: SceneBank,
        robot: RobotSpec,
        control_dt: float = 0.2,
        num_slots: int = 16,
        num_prism_slots: int = 8,
        num_contacts: int = 12,
        iterations: int = 8,
        line_steps: int = 10,
        graphs: bool = True,
        agents: AgentShapes | None = None,
        movable: body_slots.Sizes | None = None,
        friction: str = "uniform",
        fused: bool = False,
    ) -> None:
        super().__init__(bank, robot, control_dt, num_slots, num_prism_slots, agents, movable, friction)
        self.bank = bank
        self.num_contacts = min(v.integer(num_contacts, "engine.num_contacts", 1), self.num_pairs)
        self._solver = v.integer(iterations, "engine.iterations", 1), v.integer(line_steps, "engine.line_steps", 1)
        self._robot_model = build_robot_model(
            self.physics,
            *self._solver,
            0 if self.movable is None else self.movable.awake,
            None if self.movable is None else self.body_table,
        )
        self.graphs = graphs
        contacts = self.num_contacts + self.num_agent_contacts
        number = 0 if self.agents is None else len(self.agents.radius)
        self._program = (
            build_program(self._robot_model, self.num_slots + self.num_prism_slots, contacts, number) if fused else None
        )
        self._devices: DeviceStore[DeviceModel, WorldBatch | FusedBatch] = DeviceStore()
        number = register(self)
        model = self.physics.model
        sizes = (model.nq, model.nv, model.nbody, len(robot.foot_geoms))
        awake = 0 if self.movable is None else self.movable.awake
        function = _call_into_warp(self.agents is not None, self.movable is not None)
        self._call = batched_call(_batch_function(function, number, sizes, 0, awake))
        self._call_and_record = batched_call(_batch_function(function, number, sizes, self.num_substeps, awake))

    def step(self, state: SimState, ctrl: Any, agents: AgentMotion | None = None) -> SimState:
        """One control step with the commands `ctrl` (nu,) held."""
        return self._advance(self._call, state, ctrl, agents)[0]

    def step_and_record(
        self, state: SimState, ctrl: Any, agents: AgentMotion | None = None
    ) -> tuple[SimState, Substeps]:
        """`step` with a record of its physics steps."""
        after, path, hit = self._advance(self._call_and_record, state, ctrl, agents)
        return after, Substeps(path, hit > 0)

    @property
    def fused(self) -> bool:
        """Whether all physics steps of a control step are one launch."""
        return self._program is not None

    def stage(self, place: int, scene: Mapping[str, Any]) -> Generator[None, None, Callable[[], None]]:
        """Copies the hulls of a scene to the device, a few megabytes at a time, while the others are in use.

        Args:
          place: row of the bank, of which the scenes change (`PlacedBank`).
          scene: of `places.scene_tables`.

        Returns:
          A function that puts the scene in its place, to be called while no program runs.
        """
        shared, _ = self._shared(wp.device_from_jax(jax.devices()[0]))
        assert shared.placed is not None, "scenes change in places"
        return (yield from staged(shared.device, shared.placed.stage(place, scene, shared.tables)))

    @property
    def placed_bytes(self) -> int:
        """Bytes of the scenes on the device, where they change in places."""
        shared, _ = self._shared(wp.device_from_jax(jax.devices()[0]))
        return 0 if shared.placed is None else shared.placed.num_bytes(shared.tables)

    @property
    def num_contexts(self) -> int:
        """Batches for which data is kept; made when a batch of a new size is first stepped."""
        return self._devices.num_batches

    def _advance(self, call: Any, state: SimState, ctrl: Any, agents: AgentMotion | None) -> tuple[SimState, Any, Any]:
        self.check_agents(agents)
        # Warp does not check indices; JAX's own gathers clamp them.
        scene = jnp.clip(jnp.asarray(state.scene, jnp.int32), 0, self.bank.num_scenes - 1)
        arrays = (state.xpos[self.physics.root], state.qpos, state.qvel, state.carry, ctrl)
        arrays += (state.friction_scale, state.mass_scale)
        moving = ()
        if agents is not None:
            moving = (*(jnp.asarray(x, jnp.float32) for x in agents[:-1]), jnp.asarray(agents.present, jnp.int32))
        slot, awake, asleep, bodies = None, None, None, state.bodies
        if bodies is not None and self.movable is not None:
            robot = state.xpos[self.physics.root]
            table = self.body_constants
            slot, awake, asleep = body_slots.wake(table, scene, bodies, robot, self.reach, self.movable.awake)
            if agents is None:
                moving = bodies_input.nobody()
            moving += bodies_input.inputs(bodies, awake)
        out = call(scene, *(jnp.asarray(x, jnp.float32) for x in arrays), *moving)
        qpos, qvel, warm, xpos, xquat, force, touch, feet, path, hit, *after_bodies = out
        owner, ground, count, overflow, agent = (touch[i] for i in range(5))
        contacts = Contacts(
            hit=count > 0,
            hit_object=owner,
            hit_ground=ground > 0,
            hit_force=force,
            hit_fraction=count / self.num_substeps,
            foot_force=feet / self.num_substeps,
            hit_agent=None if self.agents is None else agent,
        )
        if bodies is not None and awake is not None:
            overflow = overflow + asleep
            awake = bodies_input.read(awake, after_bodies[0])
            bodies = body_slots.put_back(self.body_constants, bodies, slot, awake)
        after = state._replace(
            qpos=qpos,
            qvel=qvel,
            xpos=xpos,
            xquat=xquat,
            contacts=contacts,
            slot_overflow=overflow,
            carry=warm,
            bodies=bodies,
        )
        return after, path, hit

    def _run(self, inputs: Sequence[wp.array], outputs: Sequence[wp.array]) -> None:
        """Steps a batch of worlds; called by Warp with its device set.

        Args:
          inputs: scene (n,) int, the root body's place (n,) vec3, qpos (n, nq), qvel (n, nv), warm start (n, nv),
            ctrl (n, nu), factors on friction and mass (n,); the fields of `AgentMotion` where there are agents.
            and where there are bodies: objects that are one (n, M), rows, objects and states (n, W, 19) of those awake.
          outputs: qpos, qvel, warm start, xpos (n, nbody) vec3, xquat (n, nbody) vec4, force (n,), touch (n, 5), feet
            (n, F), path (n, S, nq) and hit (n, S), S = 0 where no physics step is asked for; see
            `kernels.finish`, `record`; states of bodies (n, W, 19).
        """
        scene = inputs[0]
        if scene.shape[0] == 0:
            return
        with device_lock(scene.device):
            batch = self._batch(scene.device, scene.shape[0], outputs[9].shape[1])
            batch.control_step(inputs, outputs, self.num_substeps)

    def _shared(self, device: Any) -> tuple[DeviceModel, Any]:
        """The tables on a device, and the batches there."""

        def make() -> DeviceModel:
            with wp.ScopedDevice(device):
                return DeviceModel(self.bank, self._robot_model, self.reach, self.materials)

        return self._devices.get_or_make(device, make)

    def _batch(self, device: Any, total: int, recorded: int) -> WorldBatch | FusedBatch:
        shared, batches = self._shared(device)
        program = self._program
        if program is not None:
            slots = (self.num_slots, self.num_prism_slots)
            return batches.get_or_make(
                total, lambda: FusedBatch(shared, program, total, *slots, self.agents, *self._solver)
            )
        room = self.num_contacts + self.num_agent_contacts + self.num_body_contacts
        sizes = (self.num_slots, self.num_prism_slots, room)
        return batches.get_or_make(
            (total, recorded),
            lambda: WorldBatch(shared, total, *sizes, recorded, self.graphs, self.agents, self.movable),
        )


def load_fused_steps(engines: Sequence[WarpEngine], threads: int) -> None:
    """See `engines.load_kernels`."""
    programs = [engine._program for engine in engines]
    load_steps([make_step(program.source) for program in programs if program is not None], threads)


def _batch_function(function: Any, number: int, sizes: tuple[int, int, int, int], recorded: int, awake: int) -> Any:
    """(scene (n,), centre (n, 3), ...) -> outputs with a leading axis n. Holds the engine by its number.

    Args:
      function: of `_call_into_warp`.
      sizes: nq, nv, nbody and feet.
      recorded: number of physics steps whose states are returned.
      awake: bodies that may move; 0 = there are none.
    """
    nq, nv, nbody, feet = sizes

    def batch(scene: jax.Array, *arrays: jax.Array) -> Any:
        n = scene.shape[0]
        shapes: dict[str, tuple[int, ...]] = {"qpos_out": (n, nq), "qvel_out": (n, nv), "warm_out": (n, nv)}
        shapes |= {"xpos": (n, nbody), "xquat": (n, nbody), "force": (n,), "touch": (n, 5), "feet": (n, feet)}
        shapes |= {"path": (n, recorded, nq), "hit": (n, recorded)}
        if awake:
            shapes["body_out"] = (n, awake, STATE)
        return function(number, scene, *arrays, output_dims=shapes)

    return batch
