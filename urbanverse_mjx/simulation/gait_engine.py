"""`GaitEngine`: a legged robot as a `Simulator` with body velocities as commands.

In: an engine at the gait's rate, the gait; then `SimState` and the gait's command. Out: `SimState`. When: every control
step of the navigation policy, inside jit, alone or under any nesting of `jax.vmap`.

A control step is several steps of the gait, each with sensing, inference and servo targets, as on the robot. The gait's
history is in `SimState.carry` behind the data of the engine below.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ..datatypes import AgentMotion, Contacts, RobotSpec, SimState, Simulator, ValidationError
from ..precision import full_precision
from ..robots.gait import Gait, felt_gravity, sensor_frame
from .physics_model import make_physics_model


class GaitMemory(NamedTuple):
    """The state of a gait; J joints, H steps.

    Attributes:
      engine: the `carry` of the engine below.
      action: (J,) the last one.
      history: (H, 9 + 3 J), see `sensor_frame`, newest first.
    """

    engine: Any
    action: Any
    history: Any


class GaitEngine:
    """Simulates a legged robot by its gait; implements `Simulator` with commands (3,): m/s ahead, m/s left, rad/s.

    Args:
      engine: of the robot, with the gait's control step.
      robot: robot whose first actuators take joint angles.
      gait: of this robot.
      control_dt: s, a multiple of the gait's.

    Raises:
      ValidationError: time steps do not divide, or the gait has another number of joints.
    """

    def __init__(self, engine: Simulator, robot: RobotSpec, gait: Gait, control_dt: float) -> None:
        self.gait_steps = round(control_dt / gait.control_dt)
        if self.gait_steps < 1 or abs(self.gait_steps * gait.control_dt - control_dt) > 1e-9:
            raise ValidationError(
                f"control_dt: found {control_dt:g} s, needed a multiple of the gait's control step "
                f"{gait.control_dt:g} s."
            )
        physics = make_physics_model(robot)
        if len(gait.stand) != physics.model.nu:
            raise ValidationError(
                f"gait: found one for {len(gait.stand)} joints, needed one for the {physics.model.nu} of "
                f"{robot.name!r}; export one with `urbanverse export-gait`."
            )
        self.robot, self.engine, self.gait, self.control_dt = robot, engine, gait, control_dt
        self._root = physics.root

    @property
    def body_rows(self) -> np.ndarray | None:
        """(Z, N) i32, see `Simulator`."""
        return self.engine.body_rows

    @property
    def num_bodies(self) -> int:
        """M, body slots of an env."""
        return self.engine.num_bodies

    @full_precision
    def init(self, scene: Any, qpos: Any, qvel: Any, objects: Any = None) -> SimState:
        """The engine's state at rest, with the history of a gait that stands."""
        sim = self.engine.init(scene, qpos, qvel, objects)
        still = jnp.zeros(len(self.gait.stand))
        frame = self._feel(sim, jnp.zeros(3), still)
        return sim._replace(carry=GaitMemory(sim.carry, still, jnp.tile(frame, (self.gait.history, 1))))

    @full_precision
    def step(self, state: SimState, ctrl: Any, agents: AgentMotion | None = None) -> SimState:
        """One control step with the command `ctrl` (3,) held; contacts are those of all its physics steps.

        Raises:
          ValidationError: there are agents, which are not supported.
        """
        if agents is not None:
            raise ValidationError("engine.step: found agents around a robot with a gait, needed none.")
        command = jnp.asarray(ctrl, jnp.float32)
        memory: GaitMemory = state.carry

        def stride(carry: Any, _: None) -> tuple[Any, tuple[Contacts, Any]]:
            sim, action, history = carry
            frame = self._feel(sim, command, action)
            history = jnp.concatenate([frame[None], history[:-1]])
            action = self.gait.action(jnp, history.reshape(-1))
            sim = self.engine.step(sim, self.gait.target(action))
            return (sim, action, history), (sim.contacts, sim.slot_overflow)

        begin = (state._replace(carry=memory.engine), memory.action, memory.history)
        (sim, action, history), (contacts, overflow) = jax.lax.scan(stride, begin, None, length=self.gait_steps)
        memory = GaitMemory(sim.carry, action, history)
        return sim._replace(carry=memory, contacts=summed_contacts(contacts), slot_overflow=overflow.max())

    def _feel(self, sim: SimState, command: Any, action: Any) -> Any:
        gravity = felt_gravity(jnp, sim.xquat[self._root])
        return sensor_frame(jnp, sim.qvel[3:6], gravity, sim.qpos[7:] - self.gait.stand, sim.qvel[6:], command, action)


def summed_contacts(parts: Contacts) -> Contacts:
    """Combines the contacts of consecutive steps, stacked along the first axis, to those of one long step."""
    strongest = jnp.argmax(jnp.where(parts.hit, parts.hit_force, -1.0))
    return Contacts(
        hit=parts.hit.any(),
        hit_object=parts.hit_object[strongest],
        hit_ground=parts.hit_ground.any(),
        hit_force=parts.hit_force.max(),
        hit_fraction=parts.hit_fraction.mean(),
        foot_force=parts.foot_force.mean(0),
    )
