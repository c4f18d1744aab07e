"""`JoystickEnv`: a blind legged robot follows velocity commands over uneven ground."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
from jaxtyping import Array, Float, Int, Key, PRNGKeyArray
from ml_collections import ConfigDict

from ...datatypes import RobotSpec, SceneBank, SimState, Simulator
from ...geometry import rotations
from ...precision import full_precision
from ...robots.gait import felt_gravity, sensor_frame
from .. import finite
from ..heights import GroundHeights
from ..navigation.terms import to_body, to_world
from ..staged import StagedBase, typed_key
from ..types import Carried, Result
from .draws import Body, draw_body, draw_command, draw_noise, draw_push
from .legs import Legs
from .schedule import TerrainLevels
from .terms import CONTACT_FORCE, Motion, terms

#: z component of the world's up axis in the body frame below which a robot counts as fallen (72 degrees).
_MIN_UP = 0.3
#: m, height of the trunk above the ground below which a robot counts as fallen, unless its config has another.
_MIN_TRUNK_HEIGHT = 0.12
#: m/s or rad/s; higher speeds mean that the simulation diverged (the fastest motor turns at 30 rad/s).
_MAX_SPEED = 1e3
#: Least reward of a step, so that a single impact does not outweigh a fall.
_MIN_REWARD = -5.0
#: m, distance from the border of a scene at which an episode ends.
_RIM_DISTANCE = 1.0
#: (63, 2) m in the heading frame, positions of the ground heights that critics observe.
SCAN = np.array([(x, y) for x in np.linspace(-0.6, 0.75, 9) for y in np.linspace(-0.45, 0.45, 7)], np.float32)
#: Scale of forces (N) in observations.
_FORCE_SCALE = 0.01


class _GaitFields(NamedTuple):
    """State of one env; J joints, F feet, T terrain kinds, H steps of history.

    Attributes:
      key: typed PRNG key.
      sim: the engine's `SimState`.
      body: see `Body`.
      kind: () i32, index of the terrain kind.
      levels: (T,) i32, the env's level of each kind, which is kept over episodes.
      command: (3,) m/s, m/s, rad/s.
      hold: () s until the next command.
      target: (J,) rad, targets of the servos from the last action.
      action: (J,) the action itself.
      joint_speed: (J,) rad/s at the end of the last step.
      history: (H, 9 + 3 J) sensor readings, newest first.
      feet: (F, 3) m.
      air_time: (F,) s.
      distance, distance_asked: () m, covered and commanded distance along the commands.
      steps: () i32.
      result: () i32, see `Result`.
    """

    key: Key[Array, ""]
    sim: SimState
    body: Body
    kind: Int[Array, ""]
    levels: Int[Array, " T"]
    command: Float[Array, "3"]
    hold: Float[Array, ""]
    target: Float[Array, " J"]
    action: Float[Array, " J"]
    joint_speed: Float[Array, " J"]
    history: Float[Array, "H n"]
    feet: Float[Array, "F 3"]
    air_time: Float[Array, " F"]
    distance: Float[Array, ""]
    distance_asked: Float[Array, ""]
    steps: Int[Array, ""]
    result: Int[Array, ""]


class GaitState(Carried, _GaitFields):
    __doc__ = _GaitFields.__doc__
    __slots__ = ()


class JoystickEnv(StagedBase[GaitState]):
    """Velocity-tracking locomotion; every env has its own kind and level of terrain.

    Observation (dict): history: (H * (9 + 3 J),) f32, the last H steps of `robots.gait.sensor_frame`, newest first,
    with noise: readings of a real robot's sensors, without velocity and ground. privileged: (P,) f32 for critics and
    tests only. Action: (J,) in [-1, 1], joint angles about the standing pose by `config.action_scale` rad, for position
    servos. Reward: the control step times the sum of `reward_config.scales` times `terms.terms`. Ends: FALL (tilt or
    trunk on the ground), NON_FINITE, TIMEOUT (also at the rim of a scene; a truncation).

        env = registry.load("Go2Joystick", config_overrides={"preset": "cpu"}, bank=terrain_bank())
    """

    def __init__(self, config: ConfigDict, bank: SceneBank, robot: RobotSpec, engine: Simulator) -> None:
        self._config, self.bank, self.robot, self.engine = config, bank, robot, engine
        self._legs = Legs(robot, tuple(config.action_scale))
        self._lowest = float(config.get("lowest", _MIN_TRUNK_HEIGHT))
        self._heights = GroundHeights(bank)
        self._levels = TerrainLevels(bank, config.terrain)
        self.scenes = np.unique(self._levels.scenes).astype(np.int32)

    # Properties in the interface of Playground and Brax.

    @property
    def action_size(self) -> int:
        return self._legs.number

    @property
    def mj_model(self) -> mujoco.MjModel:
        """The robot's model without ground."""
        return self._legs.model

    # The stages.

    def begin(self, key: PRNGKeyArray) -> GaitState:
        """Begins the first episode of an env, at low levels."""
        key, draw = jax.random.split(typed_key(key))
        return self.begin_at(key, self._levels.first(draw))

    def reset_episode(self, gait: GaitState) -> GaitState:
        """Begins the episode after that of `gait`: on harder ground of its kind after a success, on easier ground after
        a fall."""
        key, draw = jax.random.split(gait.key)
        lasted = gait.result == Result.TIMEOUT
        levels = self._levels.after(draw, gait.levels, gait.kind, lasted, gait.distance, gait.distance_asked)
        return self.begin_at(key, levels)

    @full_precision
    def begin_at(self, key: PRNGKeyArray, levels: Int[Array, " T"]) -> GaitState:
        """Begins a new episode at the given level (T,) of each kind."""
        config, legs = self._config, self._legs
        key, where, pose, body, command, noise = jax.random.split(typed_key(key), 6)
        choose, place, turn = jax.random.split(where, 3)
        kind, scene = self._levels.choose(choose, levels)
        reach = config.terrain.start_range
        middle = 0.5 * (self._heights.low[scene] + self._heights.high[scene])
        p_xy = middle + jax.random.uniform(place, (2,), jnp.float32, -reach, reach)
        yaw = jax.random.uniform(turn, (), jnp.float32, -jnp.pi, jnp.pi)
        sim = self._stand(scene, p_xy, yaw, pose)
        drawn = draw_body(body, config.randomization, legs.number)
        sim = sim._replace(friction_scale=drawn.friction_scale, mass_scale=drawn.mass_scale)
        sim = self.with_model(sim)
        wanted, hold = draw_command(command, config.command)
        zero, still = jnp.float32(0.0), jnp.zeros(legs.number)
        frame = self._frame(sim, wanted, still, drawn, noise)
        return GaitState(
            key=key,
            sim=sim,
            body=drawn,
            kind=kind,
            levels=levels,
            command=wanted,
            hold=hold,
            target=legs.stand,
            action=still,
            joint_speed=sim.qvel[6:],
            history=jnp.tile(frame, (int(config.history), 1)),
            feet=legs.feet(sim),
            air_time=jnp.zeros(len(legs.foot_body)),
            distance=zero,
            distance_asked=zero,
            steps=jnp.int32(0),
            result=jnp.int32(Result.RUNNING),
        )

    @full_precision
    def advance(
        self, gait: GaitState, action: Float[Array, " J"]
    ) -> tuple[GaitState, Float[Array, ""], Float[Array, ""], dict[str, Float[Array, ""]]]:
        """One control step: (next state, reward () f32, done () f32, metrics). The outputs are always finite.

        If inputs or simulation are not finite, the robot keeps its pose and the episode ends (`Result.NON_FINITE`).
        """
        gait, given = finite.repaired(gait)
        config, legs = self._config, self._legs
        key, push, noise, command = jax.random.split(gait.key, 4)
        action = jnp.clip(jnp.nan_to_num(action), -1.0, 1.0)
        target = jnp.clip(legs.stand + legs.scale * action, legs.limits[:, 0], legs.limits[:, 1])
        asked = jnp.where(gait.body.delay > 0, gait.target, target)
        angles = gait.sim.qpos[7:]
        # The servo uses its encoder, whose reading has the error joint_bias.
        ctrl = angles + gait.body.strength * (asked - gait.body.joint_bias - angles)
        kick = draw_push(push, config.randomization, self.dt)
        sim = self.engine.step(gait.sim._replace(qvel=gait.sim.qvel.at[:6].add(kick)), ctrl)
        sound = given & finite.is_sound(sim) & (jnp.abs(sim.qvel) < _MAX_SPEED).all()
        sim = finite.choose(sound, sim, gait.sim)
        motion = self._motion(gait, sim, action, ctrl)
        steps = gait.steps + 1
        result = self._result(sim, motion, sound, steps)
        done = (result != Result.RUNNING).astype(jnp.float32)
        fresh, hold = draw_command(command, config.command)
        change = gait.hold <= self.dt
        wanted = jnp.where(change, fresh, gait.command)
        frame = self._frame(sim, wanted, action, gait.body, noise)
        speed = jnp.linalg.norm(gait.command[:2])
        along = motion.linear[:2] @ gait.command[:2] / jnp.maximum(speed, 1e-6)
        new = gait._replace(
            key=key,
            sim=sim,
            command=wanted,
            hold=jnp.where(change, hold, gait.hold - self.dt),
            target=target,
            action=action,
            joint_speed=sim.qvel[6:],
            history=jnp.concatenate([frame[None], gait.history[:-1]]),
            feet=legs.feet(sim),
            air_time=jnp.where(motion.contact, 0.0, gait.air_time + self.dt),
            distance=gait.distance + self.dt * jnp.minimum(along, speed),
            distance_asked=gait.distance_asked + self.dt * speed,
            steps=steps,
            result=result,
        )
        values = terms(motion, config.reward_config, legs.stand, legs.limits)
        rewards = {n: jnp.float32(self.dt * s) * values[n] for n, s in config.reward_config.scales.items()}
        total = jnp.maximum(sum(rewards.values(), jnp.float32(0.0)), _MIN_REWARD)
        return new, total, done, self._metrics(new, motion, rewards)

    @full_precision
    def observe(self, gait: GaitState) -> dict[str, Array]:
        """Observations of a state."""
        return {"history": gait.history.reshape(-1), "privileged": self._privileged(gait)}

    def named_observations(self, gait: GaitState, obs: dict[str, Array]) -> dict[str, Array]:
        """`state`: `history`; `privileged_state`: `privileged`."""
        return {"state": obs["history"], "privileged_state": obs["privileged"]}

    # The environment as a whole.

    def info_of(self, gait: GaitState) -> dict[str, Array]:
        """Scene, episode and result of the env."""
        return self.episode_info(gait.sim.scene, jnp.int32(0), gait.result, gait.steps)

    def zero_metrics(self) -> dict[str, Float[Array, ""]]:
        """The metrics of an initial state."""
        names = [f"reward/{name}" for name in self._config.reward_config.scales]
        names += ["error_linear", "error_angular", "fall", "timeout", "non_finite", "touch", "slot_overflow"]
        names += [f"level_{kind}" for kind in self._levels.kinds]
        return {name: jnp.float32(0.0) for name in names}

    # Inside.

    def _stand(self, scene: jax.Array, p_xy: jax.Array, yaw: jax.Array, key: jax.Array) -> SimState:
        """The engine's state of a robot near its standing pose, with no foot below the ground."""
        legs = self._legs
        bend, move = jax.random.split(key)
        joints = legs.stand + jax.random.uniform(bend, legs.stand.shape, jnp.float32, -0.1, 0.1)
        joints = jnp.clip(joints, legs.limits[:, 0], legs.limits[:, 1])
        ground = self._heights(scene, p_xy + to_world(jnp.asarray(SCAN), yaw)).max()
        place = jnp.stack([p_xy[0], p_xy[1], ground + self.robot.spawn_height + 0.02])
        qvel = jnp.zeros(self.mj_model.nv).at[:6].set(jax.random.uniform(move, (6,), jnp.float32, -0.3, 0.3))
        return self.engine.init(scene, jnp.concatenate([place, rotations.from_yaw(yaw), joints]), qvel)

    def _frame(self, sim: SimState, command: jax.Array, action: jax.Array, body: Body, key: jax.Array) -> jax.Array:
        """(9 + 3 J,) sensor readings of a state, with noise."""
        sensed = self._sensed(sim) + draw_noise(key, self._config.noise, self._legs.number)
        n = self._legs.number
        joints = sensed[6 : 6 + n] + body.joint_bias - self._legs.stand
        return sensor_frame(jnp, sensed[:3], sensed[3:6], joints, sensed[6 + n :], command, action)

    def _sensed(self, sim: SimState) -> jax.Array:
        """(6 + 2 J,) angular velocity (rad/s) and gravity's direction in the body frame, joint angles and speeds."""
        gravity = felt_gravity(jnp, sim.xquat[self._legs.root])
        return jnp.concatenate([sim.qvel[3:6], gravity, sim.qpos[7:], sim.qvel[6:]])

    def _motion(self, gait: GaitState, sim: SimState, action: jax.Array, ctrl: jax.Array) -> Motion:
        legs = self._legs
        quaternion, feet = sim.xquat[legs.root], legs.feet(sim)
        under, up = self._heights(sim.scene, feet[:, :2]), -felt_gravity(jnp, quaternion)
        contact = legs.foot_force(sim) > CONTACT_FORCE
        speed = sim.qvel[6:]
        return Motion(
            linear=jnp.append(to_body(sim.qvel[:2], rotations.yaw_of(quaternion)), sim.qvel[2]),
            angular=sim.qvel[3:6],
            up=up,
            height=sim.xpos[legs.root, 2] - under.mean(),
            joints=sim.qpos[7:],
            joint_speed=speed,
            joint_acceleration=(speed - gait.joint_speed) / self.dt,
            torque=legs.torque(ctrl, sim.qpos, sim.qvel),
            foot_height=feet[:, 2] - legs.sole - under,
            foot_speed=jnp.linalg.norm(feet[:, :2] - gait.feet[:, :2], axis=-1) / self.dt,
            contact=contact,
            air_time=gait.air_time,
            landed=contact & (gait.air_time > 0.0),
            touch=sim.contacts.hit_fraction,
            action=action,
            last_action=gait.action,
            fell=(up[2] < _MIN_UP) | (sim.xpos[legs.root, 2] - under.min() < self._lowest),
            command=gait.command,
        )

    def _result(self, sim: SimState, motion: Motion, finite: jax.Array, steps: jax.Array) -> jax.Array:
        p_xy = sim.xpos[self._legs.root, :2]
        low, high = self._heights.low[sim.scene] + _RIM_DISTANCE, self._heights.high[sim.scene] - _RIM_DISTANCE
        late = (steps >= self._config.episode_length) | (p_xy < low).any() | (p_xy > high).any()
        result = jnp.where(late, Result.TIMEOUT, Result.RUNNING)
        result = jnp.where(motion.fell, Result.FALL, result)
        return jnp.where(finite, result, Result.NON_FINITE).astype(jnp.int32)

    def _privileged(self, gait: GaitState) -> jax.Array:
        """Observation of critics: sensors without noise, velocity, feet, ground heights around the robot, and its
        parameters."""
        sim, legs, n = gait.sim, self._legs, self._legs.number
        sensed = self._sensed(sim)
        bend = sensed[6 : 6 + n] - legs.stand
        position, yaw = sim.xpos[legs.root], rotations.yaw_of(sim.xquat[legs.root])
        around = self._heights(sim.scene, position[:2] + to_world(jnp.asarray(SCAN), yaw))
        soles = gait.feet[:, 2] - legs.sole - self._heights(sim.scene, gait.feet[:, :2])
        body = gait.body
        parts = [
            sensor_frame(jnp, sensed[:3], sensed[3:6], bend, sensed[6 + n :], gait.command, gait.action),
            to_body(sim.qvel[:2], yaw),
            sim.qvel[2:3],
            _FORCE_SCALE * legs.foot_force(sim),
            10.0 * soles,
            gait.air_time,
            5.0 * jnp.clip(position[2] - around - self.robot.spawn_height, -1.0, 1.0),
            jnp.stack([body.friction_scale, body.mass_scale, body.strength, body.delay]),
            gait.steps[None] / self._config.episode_length,
        ]
        return jnp.concatenate(parts).astype(jnp.float32)

    def _metrics(self, gait: GaitState, motion: Motion, rewards: dict[str, jax.Array]) -> dict[str, jax.Array]:
        def ended(code: Result) -> jax.Array:
            return (gait.result == code).astype(jnp.float32)

        return {
            **{f"reward/{name}": value for name, value in rewards.items()},
            "error_linear": jnp.linalg.norm(motion.command[:2] - motion.linear[:2]),
            "error_angular": jnp.abs(motion.command[2] - motion.angular[2]),
            "fall": ended(Result.FALL),
            "timeout": ended(Result.TIMEOUT),
            "non_finite": ended(Result.NON_FINITE),
            "touch": motion.touch,
            "slot_overflow": gait.sim.slot_overflow.astype(jnp.float32),
            **{f"level_{kind}": gait.levels[i].astype(jnp.float32) for i, kind in enumerate(self._levels.kinds)},
        }
