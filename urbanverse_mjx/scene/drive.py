"""Drives every episode once in C MuJoCo over the ground without objects, to remove episodes whose route cannot be
driven."""

import dataclasses
from collections.abc import Callable, Sequence

import mujoco
import mujoco.rollout
import numpy as np

from ..datatypes import RobotSpec, traversable
from ..geometry import rotations
from .geometry import SceneGeometry
from .mjcf import scene_spec
from .planner import FreeSpace, path_length, resample

#: The task's control period, s (paper: 5 Hz).
CONTROL_PERIOD = 0.2
#: m, distance along the path to the point that the robot steers for; within the action's range of 1 m.
LOOKAHEAD = 1.0
#: Distance (m) to the goal that counts as arrived.
ARRIVAL_DISTANCE = 0.5
#: Slowest average speed (m/s) and waiting time (s) before a drive counts as stuck.
MIN_MEAN_SPEED, MAX_WAIT = 0.6, 6.0
_PATH_SPACING = 0.1


@dataclasses.dataclass(frozen=True)
class Controller:
    """A robot and its batched waypoint controller.

    Attributes:
      robot: the robot.
      command: waypoints (n, 2) m in the body frame -> actuator commands (n, nu), for steps of `CONTROL_PERIOD`.
    """

    robot: RobotSpec
    command: Callable[[np.ndarray], np.ndarray]


@dataclasses.dataclass(frozen=True)
class Drive:
    """Result of driving a row: seconds to the goal, or -1 and the reason of the failure."""

    seconds: float
    reason: str


def ground_model(scene: SceneGeometry, robot: RobotSpec) -> mujoco.MjModel:
    """The robot on the scene's ground prisms, without objects and without the robot's visual geoms."""
    spec = scene_spec(scene.with_objects(np.zeros(len(scene.object_ids), bool)))
    body = mujoco.MjSpec.from_string(robot.mjcf)
    for geom in [g for g in body.geoms if not (g.contype or g.conaffinity)]:
        if geom.mass == 0.0 or geom.parent.explicitinertial:
            body.delete(geom)
    spec.attach(body, prefix="robot/", frame=spec.worldbody.add_frame())
    spec.option.timestep = robot.physics_timestep
    return spec.compile()


def drive_all(
    model: mujoco.MjModel, controller: Controller, space: FreeSpace, starts: np.ndarray, paths: Sequence[np.ndarray]
) -> list[Drive]:
    """Drives each path (n, 2) from its start (E, 4) = x, y, ground z, yaw; all simultaneously."""
    robot, data = controller.robot, mujoco.MjData(model)
    adr = int(model.jnt_qposadr[model.body(f"robot/{robot.root_body}").jntadr[0]])
    state = _initial_states(model, data, adr, robot, starts)
    substeps = round(CONTROL_PERIOD / model.opt.timestep)
    dense = _Paths([np.concatenate([p[:1], resample(p, _PATH_SPACING)]) for p in paths])
    progress = np.zeros(len(paths), int)
    limit = np.array([path_length(p) / MIN_MEAN_SPEED + MAX_WAIT for p in paths])
    drives: list[Drive | None] = [None] * len(paths)
    alive, time = np.arange(len(paths)), 0.0
    while len(alive):
        pose = state[alive, 1 + adr : 1 + adr + 7]
        for e, drive in zip(alive, _judge(pose, dense.goals[alive], space, time, limit[alive]), strict=True):
            drives[e] = drive
        going = np.array([drives[e] is None for e in alive])
        alive, pose = alive[going], pose[going]
        if len(alive):
            targets = np.zeros((len(paths), 2))
            progress[alive], targets[alive] = _target(pose, dense, alive, progress[alive])
            control = np.asarray(controller.command(targets), np.float64)[alive]
            control = np.repeat(control[:, None], substeps, 1)
            out, _ = mujoco.rollout.rollout(model, data, state[alive], control)
            state[alive] = out[:, -1]
            time += CONTROL_PERIOD
    return [d for d in drives if d is not None]


class _Paths:
    """Paths of different lengths as one array.

    Attributes:
      points: (E, most, 2) m; after the end of a path its last point.
      counts: (E,) points of each.
      goals: (E, 2) m, their last points.
    """

    def __init__(self, paths: Sequence[np.ndarray]) -> None:
        self.counts = np.array([len(p) for p in paths])
        most = int(self.counts.max(initial=1))
        last = np.minimum(np.arange(most), self.counts[:, None] - 1)
        self.points = np.array([p[k] for p, k in zip(paths, last, strict=True)]).reshape(len(paths), most, 2)
        self.goals = self.points[:, -1]


def _initial_states(
    model: mujoco.MjModel, data: mujoco.MjData, adr: int, robot: RobotSpec, starts: np.ndarray
) -> np.ndarray:
    size = mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    state = np.zeros((len(starts), size))
    for row, (x, y, z, yaw) in zip(state, starts, strict=True):
        mujoco.mj_resetData(model, data)
        data.qpos[adr : adr + 7] = [x, y, z + robot.spawn_height, *rotations.from_yaw(yaw)]
        mujoco.mj_getState(model, data, row, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    return state


def _judge(pose: np.ndarray, goal: np.ndarray, space: FreeSpace, time: float, limit: np.ndarray) -> list[Drive | None]:
    """Of each pose (n, 7) with its goal (n, 2) and limit (n,) s: the finished drive, or None while it continues."""
    stable = np.isfinite(pose).all(1)
    pose = np.where(stable[:, None], pose, 0.0)
    arrived = np.linalg.norm(pose[:, :2] - goal, axis=1) < ARRIVAL_DISTANCE
    tipped = rotations.up_of(pose[:, 3:7]) < 0.7
    outside = ~traversable(space.map.kind[space.cell(pose[:, :2])])
    ends = np.select([~stable, arrived, tipped, outside, time > limit], range(5), default=-1)
    reasons = ("unstable", "", "tipped over", "off the traversable area", "stuck")
    return [None if k < 0 else Drive(time if reasons[k] == "" else -1.0, reasons[k]) for k in ends]


def _target(pose: np.ndarray, paths: _Paths, rows: np.ndarray, progress: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(n,) index of the nearest point of the paths `rows` from `progress` on, and (n, 2) body-frame points to steer
    for."""
    window = np.minimum(progress[:, None] + np.arange(30), paths.counts[rows, None] - 1)
    apart = np.linalg.norm(paths.points[rows[:, None], window] - pose[:, None, :2], axis=2)
    progress = progress + apart.argmin(1)
    far = np.minimum(progress + round(LOOKAHEAD / _PATH_SPACING), paths.counts[rows] - 1)
    ahead = paths.points[rows, far] - pose[:, :2]
    yaw = rotations.yaw_of(pose[:, 3:7])
    c, s = np.cos(yaw), np.sin(yaw)
    return progress, np.stack([c * ahead[:, 0] + s * ahead[:, 1], -s * ahead[:, 0] + c * ahead[:, 1]], 1)
