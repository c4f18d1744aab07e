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
    dense = [np.concatenate([p[:1], resample(p, _PATH_SPACING)]) for p in paths]
    progress = np.zeros(len(paths), int)
    limit = np.array([path_length(p) / MIN_MEAN_SPEED + MAX_WAIT for p in paths])
    drives: list[Drive | None] = [None] * len(paths)
    alive, time = np.arange(len(paths)), 0.0
    while len(alive):
        pose = state[:, 1 + adr : 1 + adr + 7]
        targets = np.zeros((len(paths), 2))
        for e in alive:
            drives[e] = _judge(pose[e], dense[e][-1], space, time, limit[e])
            progress[e], targets[e] = _target(pose[e], dense[e], int(progress[e]))
        alive = np.array([e for e in alive if drives[e] is None], int)
        if len(alive):
            control = np.asarray(controller.command(targets), np.float64)[alive]
            control = np.repeat(control[:, None], substeps, 1)
            out, _ = mujoco.rollout.rollout(model, data, state[alive], control)
            state[alive] = out[:, -1]
            time += CONTROL_PERIOD
    return [d for d in drives if d is not None]


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


def _judge(pose: np.ndarray, goal: np.ndarray, space: FreeSpace, time: float, limit: float) -> Drive | None:
    """A finished drive, or None while it continues."""
    if not np.isfinite(pose).all():
        return Drive(-1.0, "unstable")
    if np.linalg.norm(pose[:2] - goal) < ARRIVAL_DISTANCE:
        return Drive(time, "")
    if rotations.up_of(pose[3:7]) < 0.7:
        return Drive(-1.0, "tipped over")
    if not traversable(space.map.kind[space.cell(pose[:2])]):
        return Drive(-1.0, "off the traversable area")
    return Drive(-1.0, "stuck") if time > limit else None


def _target(pose: np.ndarray, path: np.ndarray, progress: int) -> tuple[int, np.ndarray]:
    """The nearest point of the path from `progress` on, and the body-frame point to steer for."""
    window = path[progress : progress + 30]
    progress += int(np.linalg.norm(window - pose[:2], axis=1).argmin())
    ahead = path[min(progress + round(LOOKAHEAD / _PATH_SPACING), len(path) - 1)] - pose[:2]
    yaw = rotations.yaw_of(pose[3:7])
    c, s = np.cos(yaw), np.sin(yaw)
    return progress, np.array([c * ahead[0] + s * ahead[1], -s * ahead[0] + c * ahead[1]])
