"""Plays an environment as a robot on the bridge of `urbanverse deploy`, in real time."""

import dataclasses
import pathlib
import time
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import jax
import jax.numpy as jnp
import numpy as np

from .. import table_arguments
from ..datatypes import RESULTS
from ..datatypes import validation as v
from ..deployment.messages import Image, Odometry
from ..deployment.robot_side import RobotLink
from ..envs import NavEnv, registry
from ..envs.navigation.terms import to_body
from ..geometry import rotations

if TYPE_CHECKING:
    from ..envs import NavState

#: s between two states, and between two images.
STEP, IMAGE_STEPS = 0.02, 5
#: ns that the robot's clock shows at the beginning.
_EPOCH = 10**9
HORIZON = 60.0  # s
#: s for which the sensors go on after the end of an episode.
AFTER = 2.0


@dataclasses.dataclass(frozen=True)
class SimulationOptions:
    """The street and the episode."""

    scene: str | None = None
    """Scene of the bank; default: the first."""
    episode: int = 0
    """Row of the scene's table of episodes."""
    bank: pathlib.Path | None = None
    """Scene bank; default: that of the shipped streets, or the one that URBANVERSE_BANK names."""
    people: bool = False
    """With moving people and vehicles."""
    port: int = 5601
    """Port of the sensors; commands are taken on the next one."""
    seed: int = 0
    """Of the street's random draws."""
    wait: float = 60.0
    """s to wait for the first command."""


class SimulatedRobot:
    """One episode of an environment that obeys body velocities.

    Args:
      env: with `action_mode` "velocity", a control step of `STEP` and a renderer.
      scene, row: of the bank and of the scene's episode table.
      link: the bridge.
      seed: of the street's random draws.
      publish: called with (kind, message) in place of `link.publish`, to lose, delay or damage messages.

    Attributes:
      velocity: (m/s ahead, rad/s) that was in force in the last step.
      steps: number of steps.
    """

    def __init__(
        self,
        env: NavEnv,
        scene: int,
        row: int,
        link: RobotLink,
        seed: int = 0,
        publish: Callable[[str, Odometry | Image], None] | None = None,
    ) -> None:
        self.env, self._link = env, link
        self._publish = publish or (lambda _, message: link.publish(message))
        self._advance = table_arguments.jit(lambda nav, action: env.advance(nav, action)[0])
        self._pixels = table_arguments.jit(lambda nav: env.observe(nav)["pixels/front"])
        self._motion = table_arguments.jit(self._motion_of)
        begin = table_arguments.jit(env.begin_at)
        self._nav: NavState = begin(jax.random.key(seed), jnp.int32(scene), jnp.int32(row))
        self._fovy = float(np.radians(env.mj_model.camera(env.robot.camera).fovy[0]))
        self.velocity, self.steps = (0.0, 0.0), 0
        # Compile before time counts.
        jax.block_until_ready(
            (self._advance(self._nav, jnp.zeros(2)), self._pixels(self._nav), self._motion(self._nav))
        )

    @property
    def goal(self) -> tuple[float, float]:
        """m, in the odometry frame, which is the street's."""
        x, y = np.asarray(self._nav.goal)[:2].tolist()
        return x, y

    @property
    def stamp_ns(self) -> int:
        """The robot's clock."""
        return _EPOCH + round(self.steps * self.env.dt * 1e9)

    @property
    def result(self) -> str | None:
        """How the episode ended, of `datatypes.RESULTS`; None while it continues."""
        number = int(self._nav.result)
        return RESULTS[number - 1] if number else None

    def _motion_of(self, nav: "NavState") -> tuple[Any, ...]:
        root = self.env.mj_model.body(self.env.robot.root_body).id
        yaw = rotations.yaw_of(nav.sim.xquat[root])
        return nav.sim.xpos[root], nav.sim.xquat[root], to_body(nav.sim.qvel[:2], yaw), nav.sim.qvel[5]

    def odometry(self) -> Odometry:
        """Where the robot is and how it moves, without errors."""
        position, quaternion, velocity, turn = (np.asarray(x, np.float64).tolist() for x in self._motion(self._nav))
        return Odometry(self.stamp_ns, tuple(position), tuple(quaternion), tuple(velocity), turn)

    def tick(self) -> None:
        """Publishes what the sensors measure, takes commands, and moves for one step."""
        if self.steps % IMAGE_STEPS == 0:
            self._publish("image", Image(self.stamp_ns, self._fovy, np.asarray(self._pixels(self._nav))[..., :3]))
        self._publish("odometry", self.odometry())
        self._link.receive(self.stamp_ns)
        self.velocity = self._link.gate.velocity(self.stamp_ns)
        robot = self.env.robot
        action = [2.0 * self.velocity[0] / robot.max_speed - 1.0, self.velocity[1] / robot.max_yaw_rate]
        self._nav = jax.block_until_ready(self._advance(self._nav, jnp.asarray(action, jnp.float32)))
        self.steps += 1


class RealTime:
    """Waits between steps so that the simulation is not faster than the clock; where it is slower, it does not catch
    up."""

    def __init__(self, period: float) -> None:
        self._period, self._next = period, time.monotonic()

    def wait(self) -> None:
        self._next += self._period
        left = self._next - time.monotonic()
        if left > 0.0:
            time.sleep(left)
        else:
            self._next -= left


def robot_config(environment: str, trained: Mapping[str, Any], people: bool) -> Any:
    """A policy's task in steps of `STEP`, for body velocities."""
    from .evaluation import evaluation_config

    config = evaluation_config(environment, trained, "all", people)
    steps = round(HORIZON / STEP)
    overrides = {"ctrl_dt": STEP, "action_mode": "velocity", "episode_length": steps, "impl": "auto", "vision": True}
    return registry.with_overrides(config, overrides)


def simulate_robot(
    policy: pathlib.Path,
    options: SimulationOptions | None = None,
    ready: Callable[[dict[str, Any]], None] | None = None,
) -> dict[str, Any]:
    """Plays one episode as a robot that `deploy` drives.

    Args:
      policy: ONNX file of `urbanverse export-onnx`, whose robot and camera are simulated.
      ready: called once with the scene, the episode, the goal (m, odometry frame) and the endpoints.

    Returns:
      result: of `datatypes.RESULTS`, or "no command" if none came; seconds; distance_to_goal (m); real_time: s of
      simulation per s.

    Raises:
      ValidationError: the policy, scene or episode does not exist, or the port is taken.
    """
    from ..deployment.policy_process import load
    from .banks import chosen_bank

    options = options or SimulationOptions()
    v.integer(options.port, "--port", 1, 65534)
    record = load(policy)[0].record
    assert record is not None
    bank = chosen_bank(options.bank)
    env = registry.load_nav_env(
        record.environment, robot_config(record.environment, record.env_config, options.people), bank
    )
    scene = 0 if options.scene is None else bank.scene_ids.index(v.choice(options.scene, "--scene", bank.scene_ids))
    v.integer(options.episode, "--episode", 0, int(bank.num_episodes[scene]) - 1)
    link = RobotLink(f"tcp://127.0.0.1:{options.port}", f"tcp://127.0.0.1:{options.port + 1}")
    try:
        robot = SimulatedRobot(env, scene, options.episode, link, options.seed)
        if ready is not None:
            where = {"scene": bank.scene_ids[scene], "episode": options.episode}
            ready({**where, "goal": list(robot.goal), "endpoints": list(link.endpoints)})
        return _run(robot, link, options.wait)
    finally:
        link.close()


def _run(robot: SimulatedRobot, link: RobotLink, wait: float) -> dict[str, Any]:
    clock, end = RealTime(robot.env.dt), time.monotonic() + wait
    while link.gate.last is None and time.monotonic() < end:
        robot.tick()
        clock.wait()
    steps, began = robot.steps, time.monotonic()
    while link.gate.last is not None and robot.result is None:
        robot.tick()
        clock.wait()
    seconds, taken = (robot.steps - steps) * robot.env.dt, max(time.monotonic() - began, 1e-9)
    found = robot.result
    distance = float(np.linalg.norm(np.array(robot.odometry().position_m[:2]) - robot.goal))
    # The sensors go on, so that the other side sees the end.
    for _ in range(round(AFTER / robot.env.dt) if found else 0):
        robot.tick()
        clock.wait()
    return {
        "result": found or "no command",
        "seconds": round(seconds, 2),
        "distance_to_goal": round(distance, 2),
        "real_time": round(seconds / taken, 3) if found else None,
    }
