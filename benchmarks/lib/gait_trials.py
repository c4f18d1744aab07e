"""The trials of `benchmarks.go2_gait`: grounds, commands and what counts as success; all seeded.

Every trial is a batch of robots in C MuJoCo (`evaluation.gait_walks`) on ground made of the prisms that streets have.
"""

import concurrent.futures
import dataclasses
from collections.abc import Iterator, Sequence
from typing import Any

import mujoco
import numpy as np

from urbanverse_mjx.datatypes import GroundRegion, RobotSpec
from urbanverse_mjx.evaluation.gait_walks import Walk, walk
from urbanverse_mjx.geometry import rotations
from urbanverse_mjx.robots import legged
from urbanverse_mjx.robots.gait import Gait
from urbanverse_mjx.scene.mjcf import scene_spec
from urbanverse_mjx.scene.terrain import region_scene, strips_regions
from urbanverse_mjx.simulation.parity.c_mujoco import reference_model

#: Largest random commands of the Go2 (m/s, m/s, rad/s), and the time that each is held (s).
RANGE, HOLD = np.array([1.0, 0.5, 1.0]), 5.0
#: s after a new command in which the error does not count; s over which velocities are averaged: two strides or so.
RISE_TIME, WINDOW = 1.0, 0.5
#: m, and share of the height (up) at which a robot has passed a kerb that lies at x = 0.
PASSED = 0.7
KERBS = (0.05, 0.08, 0.10, 0.12, 0.15, 0.18, 0.20)
#: Ramps of streets go up to 1:8; the steepest that the gait was trained on is 24 degrees (0.45).
SLOPES = (0.05, 1 / 12, 1 / 8, 0.2, 0.3, 0.4, 0.45)
#: rad and m/s: how a kerb or a ramp is met; m before it where a robot starts.
ANGLE, SPEED, RUN_UP = np.pi / 4, (0.5, 1.0), 1.0
#: 1/s. The heading controller of straight commands: yaw rate per radian of heading error (mjlab's 0.5).
HEADING_GAIN = 0.5
PUSH, PUSH_AT = 0.5, 2.0  # m/s, s
#: Robots that one process steps together.
CHUNK = 10
#: m, sides of grounds: no robot leaves them in 20 s at 1.1 m/s straight ahead, nor across a kerb or a ramp at `ANGLE`.
SIDE, KERB_SIDE, RAMP_SIDE = 50.0, 16.0, 36.0


@dataclasses.dataclass(frozen=True)
class Judge:
    """Common data of all trials: the robot, the gait, and processes that step it (None: this one)."""

    robot: RobotSpec
    gait: Gait
    pool: concurrent.futures.Executor | None = None

    @property
    def speed_limit(self) -> np.ndarray:
        """(J,) rad/s of the motors."""
        return np.array(legged.row(self.robot.name).motor_speeds)

    @property
    def range(self) -> np.ndarray:
        """(3,) largest random commands (m/s, m/s, rad/s): those that the robot practised to both sides."""
        walk = legged.row(self.robot.name).walk
        if walk is None:
            return RANGE
        return np.array([min(abs(x) for x in span) for span in (walk.forward, walk.aside, walk.turn)])

    def model(self, regions: list[GroundRegion]) -> mujoco.MjModel:
        """The robot on a ground."""
        return reference_model(scene_spec(region_scene("ground", regions)), self.robot)

    def start(self, model: mujoco.MjModel, places: np.ndarray, yaws: np.ndarray) -> np.ndarray:
        """(N, nq) robots standing at places (N, 3) m of the ground."""
        qpos = np.tile(model.qpos0, (len(places), 1))
        qpos[:, :3] = places + np.array([0.0, 0.0, self.robot.spawn_height])
        qpos[:, 3:7] = rotations.from_yaw(yaws)
        qpos[:, 7:] = self.gait.stand
        return qpos

    def run(
        self,
        model: mujoco.MjModel,
        qpos: np.ndarray,
        commands: "Wandering | Straight",
        seconds: float,
        kick: tuple[float, np.ndarray] | None = None,
    ) -> Walk:
        """Walks robots in chunks; kick: s and (N, 2) m/s."""
        steps, jobs = round(seconds / self.gait.control_dt), []
        for rows in np.array_split(np.arange(len(qpos)), -(-len(qpos) // CHUNK)):
            kicks = {round(kick[0] / self.gait.control_dt): kick[1][rows]} if kick else None
            ground, requested = np.zeros(len(rows), int), commands.of(rows)
            walked = (self.robot, self.gait, qpos[rows], requested, steps, self.speed_limit, kicks)
            jobs.append(([model], ground, *walked, requested.finished))
        apply = map if self.pool is None else self.pool.map
        parts = list(apply(walk, *zip(*jobs, strict=True)))
        names = [f.name for f in dataclasses.fields(Walk)]
        return Walk(**{n: np.concatenate([getattr(p, n) for p in parts]) for n in names})


@dataclasses.dataclass(frozen=True)
class Wandering:
    """Commands (N, C, 3), each held for `HOLD` s. A `Commander` that other processes can be sent."""

    drawn: np.ndarray

    def of(self, rows: np.ndarray) -> "Wandering":
        """Those of some robots."""
        return Wandering(self.drawn[rows])

    def __call__(self, places: np.ndarray, yaws: np.ndarray, time: float) -> np.ndarray:
        del places, yaws
        return self.drawn[:, int(time / HOLD)]

    def finished(self, places: np.ndarray, time: float) -> np.ndarray:
        """No walk stops early."""
        del time
        return np.zeros(len(places), bool)


@dataclasses.dataclass(frozen=True)
class Straight:
    """Ahead at a speed (N,) m/s with a heading (N,) rad that is kept, until x is beyond `goal` (m) or `late` (N,) s are
    over. A `Commander` as well."""

    speed: np.ndarray
    heading: np.ndarray
    goal: float
    late: np.ndarray

    def of(self, rows: np.ndarray) -> "Straight":
        """Those of some robots."""
        return Straight(self.speed[rows], self.heading[rows], self.goal, self.late[rows])

    def __call__(self, places: np.ndarray, yaws: np.ndarray, time: float) -> np.ndarray:
        del places, time
        off = (self.heading - yaws + np.pi) % (2 * np.pi) - np.pi
        turn = np.clip(HEADING_GAIN * off, -RANGE[2], RANGE[2])
        return np.stack([self.speed, 0.0 * turn, turn], 1)

    def finished(self, places: np.ndarray, time: float) -> np.ndarray:
        """Walks that have passed, or are too late."""
        return (places[:, 0] > self.goal) | (time > self.late)


def flat() -> list[GroundRegion]:
    """One level square."""
    return strips_regions(iter([(SIDE, 0.0, 0.0)]), SIDE)


def kerb(low: float, high: float) -> list[GroundRegion]:
    """Ground at a height of `low` m, then at `high` from x = 0 on."""
    return strips_regions(iter([(KERB_SIDE / 2, low, low), (KERB_SIDE / 2, high, high)]), KERB_SIDE)


def ramp(slope: float) -> list[GroundRegion]:
    """Level, 3 m up from x = 0, 2 m level, 3 m down, level."""
    top = 3.0 * slope
    strips = [(RAMP_SIDE / 2, 0.0, 0.0), (3.0, 0.0, top), (2.0, top, top), (3.0, top, 0.0), (RAMP_SIDE, 0.0, 0.0)]
    return strips_regions(iter(strips), RAMP_SIDE)


def _wandering(judge: Judge, seed: int, number: int, seconds: float) -> Wandering:
    """Commands drawn anew every `HOLD` s, the same for every gait of a robot."""
    count = int(np.ceil(seconds / HOLD)) + 1
    return Wandering(np.random.default_rng([seed, 1]).uniform(-judge.range, judge.range, (number, count, 3)))


def settled_errors(found: Walk, control_dt: float) -> tuple[np.ndarray, np.ndarray]:
    """Errors of linear (m/s) and angular (rad/s) velocity averaged over `WINDOW`, where a command has been held.

    Returns:
      (n,) each, over all robots and times at which they count.
    """
    window, hold, rise = (round(s / control_dt) for s in (WINDOW, HOLD, RISE_TIME))
    kernel = np.ones(window) / window
    smooth = np.apply_along_axis(lambda x: np.convolve(x, kernel, "valid"), 1, found.velocity)
    command = found.command[:, window - 1 :]
    time = np.arange(window - 1, found.command.shape[1]) % hold
    counts = time >= rise + window - 1
    off = (command - smooth)[:, counts].reshape(-1, 3)
    off = off[np.isfinite(off).all(1)]
    return np.linalg.norm(off[:, :2], axis=1), np.abs(off[:, 2])


def judge_flat(judge: Judge, episodes: int, seconds: float, seed: int) -> dict[str, Any]:
    """Random commands on level ground: errors, falls, cost of transport, slip, limits."""
    model = judge.model(flat())
    yaws = np.random.default_rng([seed, 0]).uniform(-np.pi, np.pi, episodes)
    found = judge.run(
        model, judge.start(model, np.zeros((episodes, 3)), yaws), _wandering(judge, seed, episodes, seconds), seconds
    )
    linear, angular = settled_errors(found, judge.gait.control_dt)
    speed = np.linalg.norm(found.velocity[..., :2], axis=-1)
    moving = (np.linalg.norm(found.command[..., :2], axis=-1) > 0.3) & np.isfinite(speed)
    mass = float(model.body_subtreemass[1])
    instant = found.command - found.velocity
    return {
        "episodes": episodes,
        "seconds": seconds,
        "error_linear_m_s": _mean(linear),
        "error_angular_rad_s": _mean(angular),
        "error_linear_instant_m_s": _mean(np.linalg.norm(instant[..., :2], axis=-1)),
        "error_angular_instant_rad_s": _mean(np.abs(instant[..., 2])),
        "falls_percent": 100.0 * float(found.fell.mean()),
        "cost_of_transport": float(found.power[moving].sum() / (mass * 9.81 * speed[moving].sum()))
        if moving.any()
        else None,
        "slip_m_s": _mean(found.slip[moving]),
        "touch_percent": 100.0 * float(found.touch.mean()),
        "torque_share_p99": _quantile(found.torque, 0.99),
        "torque_share_max": _quantile(found.torque, 1.0),
        "speed_share_p99": _quantile(found.speed, 0.99),
        "speed_share_max": _quantile(found.speed, 1.0),
        "beyond_range_max_rad": _quantile(found.beyond, 1.0),
    }


def judge_straight(judge: Judge, episodes: int, seed: int) -> dict[str, Any]:
    """A command of full speed ahead from rest: the mean forward speed in steady state."""
    model, speed, seconds = judge.model(flat()), float(RANGE[0]), HOLD
    yaws = np.random.default_rng([seed, 3]).uniform(-np.pi, np.pi, episodes)
    requested = Wandering(np.tile([speed, 0.0, 0.0], (episodes, 1, 1)))
    found = judge.run(model, judge.start(model, np.zeros((episodes, 3)), yaws), requested, seconds)
    settled = found.velocity[:, round(RISE_TIME / judge.gait.control_dt) :, 0]
    return {"episodes": episodes, "told_m_s": speed, "speed_m_s": _mean(settled)}


def judge_pushes(judge: Judge, episodes: int, seed: int) -> dict[str, Any]:
    """A kick of `PUSH` m/s from a random side while walking; 5 s later the robot must be on its feet."""
    model, rng = judge.model(flat()), np.random.default_rng([seed, 2])
    angle, yaws = rng.uniform(-np.pi, np.pi, (2, episodes))
    kick = PUSH * np.stack([np.cos(angle), np.sin(angle)], 1)
    start = judge.start(model, np.zeros((episodes, 3)), yaws)
    seconds = PUSH_AT + 5.0
    found = judge.run(model, start, _wandering(judge, seed, episodes, seconds), seconds, (PUSH_AT, kick))
    return {"episodes": episodes, "kick_m_s": PUSH, "survived_percent": 100.0 * float((~found.fell).mean())}


def _crossing(
    judge: Judge, regions: list[GroundRegion], height: float, length: float, episodes: int, rng: Any
) -> np.ndarray:
    """(episodes,) bool: from `RUN_UP` m before x = 0 to `PASSED` m behind `length` without a fall, in time."""
    model = judge.model(regions)
    heading, speed = rng.uniform(-ANGLE, ANGLE, episodes), rng.uniform(*SPEED, episodes)
    places = np.stack([np.full(episodes, -RUN_UP), np.zeros(episodes), np.full(episodes, height)], 1)
    # Twice the time for the distance at the commanded speed.
    late = 2.0 * (RUN_UP + length + PASSED) / np.cos(ANGLE) / speed
    requested = Straight(speed, heading, length + PASSED, late)
    found = judge.run(model, judge.start(model, places, heading), requested, float(late.max()))
    x = np.where(np.isfinite(found.position[..., 0]), found.position[..., 0], -np.inf)
    return (x > requested.goal).any(1)


def judge_kerbs(judge: Judge, episodes: int, seed: int, heights: Sequence[float] = KERBS) -> Iterator[dict[str, Any]]:
    """Kerbs up and down, met at up to `ANGLE` and at `SPEED`."""
    for height in heights:
        for route, regions, begin in (("up", kerb(0.0, height), 0.0), ("down", kerb(height, 0.0), height)):
            rng = np.random.default_rng([seed, 3, round(1e3 * height), route == "up"])
            passed = _crossing(judge, regions, begin, 0.0, episodes, rng)
            yield {
                "height_m": height,
                "way": route,
                "episodes": episodes,
                "passed_percent": 100.0 * float(passed.mean()),
            }


def judge_ramps(judge: Judge, episodes: int, seed: int, slopes: Sequence[float] = SLOPES) -> Iterator[dict[str, Any]]:
    """Ramps up and down again."""
    for slope in slopes:
        rng = np.random.default_rng([seed, 4, round(1e3 * slope)])
        passed = _crossing(judge, ramp(slope), 0.0, 8.0, episodes, rng)
        yield {"slope": round(slope, 4), "episodes": episodes, "passed_percent": 100.0 * float(passed.mean())}


def _mean(values: np.ndarray) -> float | None:
    known = values[np.isfinite(values)]
    return float(known.mean()) if known.size else None


def _quantile(values: np.ndarray, share: float) -> float | None:
    known = values[np.isfinite(values)]
    return float(np.quantile(known, share)) if known.size else None
