"""A kinematic engine: no contact, exact motion. It lets the task's logic be checked against arithmetic."""

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from ml_collections import ConfigDict

from urbanverse_mjx.datatypes import AgentMotion, Bodies, Contacts, RobotSpec, SceneBank, SimState
from urbanverse_mjx.envs import NavEnv, default_config
from urbanverse_mjx.envs.navigation.fleet import fleet_size
from urbanverse_mjx.envs.registry import with_overrides
from urbanverse_mjx.geometry import rotations
from urbanverse_mjx.robots import make_coco

NOTHING = Contacts(jnp.bool_(False), jnp.int32(-1), jnp.bool_(False), jnp.float32(0.0), jnp.float32(0.0), jnp.zeros(0))


def unicycle_robot() -> RobotSpec:
    """COCO whose command is the body velocity itself."""
    return dataclasses.replace(make_coco(), command=lambda velocity: velocity)


class UnicycleEngine:
    """`Simulator` of a point that obeys (v, omega) at once; a hit whenever x passes `wall` (m).

    With agents it also hits the nearest of them within `TOUCH` of its centre at the end of a step.
    """

    TOUCH = 0.6

    def __init__(self, robot: RobotSpec, control_dt: float, wall: float = jnp.inf, agents: bool = False):
        self._dt = control_dt
        self._wall = wall
        self._height = robot.spawn_height
        self._agents = agents

    @property
    def body_rows(self) -> np.ndarray | None:
        return None

    @property
    def num_bodies(self) -> int:
        return 0

    def _state(self, scene: Any, qpos: Any, qvel: Any, hit: Any, agent: Any = -1) -> SimState:
        xpos = jnp.zeros((2, 3)).at[1].set(qpos[:3])
        xquat = jnp.zeros((2, 4)).at[:, 0].set(1.0).at[1].set(qpos[3:7])
        contacts = NOTHING._replace(hit=hit, hit_fraction=hit.astype(jnp.float32))
        if self._agents:
            contacts = contacts._replace(hit_agent=jnp.int32(agent))
        return SimState(scene, qpos, qvel, xpos, xquat, contacts, jnp.int32(0), (), jnp.float32(1.0), jnp.float32(1.0))

    def init(self, scene: Any, qpos: Any, qvel: Any, objects: Any = None) -> SimState:
        return self._state(scene, qpos, qvel, jnp.bool_(False))

    def step(self, state: SimState, ctrl: Any, agents: AgentMotion | None = None) -> SimState:
        v, omega = ctrl
        yaw = 2.0 * jnp.arctan2(state.qpos[6], state.qpos[3]) + omega * self._dt
        velocity = v * jnp.stack([jnp.cos(yaw), jnp.sin(yaw)])
        xy = state.qpos[:2] + velocity * self._dt
        turn = rotations.from_yaw(yaw)
        qpos = state.qpos.at[:2].set(xy).at[3:7].set(turn)
        qvel = state.qvel.at[:2].set(velocity).at[5].set(omega)
        if agents is None:
            return self._state(state.scene, qpos, qvel, xy[0] > self._wall)
        away = jnp.linalg.norm((agents.position + self._dt * agents.velocity)[:, :2] - xy, axis=-1)
        away = jnp.where(agents.present, away, jnp.inf)
        nearest = jnp.argmin(away)
        met = away[nearest] < self.TOUCH
        return self._state(state.scene, qpos, qvel, met | (xy[0] > self._wall), jnp.where(met, nearest, -1))


class GoalImage:
    """A renderer whose image shows where the robot stands: enough to see frames change."""

    def __call__(
        self,
        scene: Any,
        xpos: Any,
        xquat: Any,
        appearance_seed: Any = 0,
        agents: Any = None,
        bodies: Bodies | None = None,
        mount: Any = None,
    ) -> dict[str, Any]:
        del appearance_seed, agents, mount
        self.check(bodies)
        rows = jnp.arange(12)[:, None, None] + scene * 7 + xpos[1, 0] * 10.0
        frame = (rows + jnp.arange(16)[None, :, None] * 3 + xquat[1, 3] * 50.0 + jnp.zeros((12, 16, 3))) % 256
        return {"rgb": frame.astype(jnp.uint8)}

    def check(self, bodies: Bodies | None) -> None:
        """Called with the poses of movable objects of every image."""


def unicycle_env(
    bank: SceneBank,
    overrides: dict[str, Any] | None = None,
    wall: float = jnp.inf,
    vision: bool = False,
    config: ConfigDict | None = None,
    robot: RobotSpec | None = None,
) -> NavEnv:
    """`CocoNav`'s task, or that of a config, on the kinematic engine; robot: whose command is the body velocity."""
    chosen = default_config("paper") if config is None else config
    complete = with_overrides(chosen, {"scenes": "all", **(overrides or {})})
    robot = robot or unicycle_robot()
    moving = complete.scenario == "dynamic" or fleet_size(complete) > 0
    engine = UnicycleEngine(robot, complete.ctrl_dt, wall, agents=moving)
    return NavEnv(complete, bank, robot, engine, GoalImage() if vision else None)


def first_states(env: NavEnv) -> Any:
    """The first state of every episode of the first scene."""
    rows = jnp.arange(int(env.bank.num_episodes[0]))
    keys = jax.random.split(jax.random.key(0), len(rows))
    return jax.jit(jax.vmap(lambda key, row: env.begin_at(key, jnp.int32(0), row)))(keys, rows)


def one(states: Any, row: int = 0) -> Any:
    """The state of one env of a batch."""
    return jax.tree.map(lambda x: x[row], states)


def drive_to_goal(obs: dict[str, jax.Array]) -> jax.Array:
    """Waypoint straight to the goal."""
    return obs["goal"] / jnp.linalg.norm(obs["goal"])
