"""Simulates robots that walk by a gait in C MuJoCo, and records every step.

In:   models of grounds with the robot in them, a gait, commands. Out:  `Walk`. When: on the host, to evaluate a gait
outside the engine in which it was trained.
"""

import dataclasses
from collections.abc import Callable, Sequence
from typing import Any

import mujoco
import numpy as np

from ..datatypes import RobotSpec
from ..robots.gait import Gait, sensor_frame

#: z component of the world's up axis in the body frame below which a robot counts as fallen (72 degrees), as in
#: `envs.joystick`.
MIN_UPRIGHT = 0.3
#: Prefix of the robot's names in `simulation.parity.c_mujoco.reference_model`.
_ROBOT = "robot/"
#: (N, 3) positions (m), (N,) headings (rad), () s -> (N, 3) commands.
Commander = Callable[[np.ndarray, np.ndarray, float], np.ndarray]
#: Function (positions (N, 3) m, () s) -> (N,) bool, walks that may stop.
Finish = Callable[[np.ndarray, float], np.ndarray]


@dataclasses.dataclass(frozen=True)
class Walk:
    """Record of N robots over T control steps; NaN after a fall or after a walk has stopped.

    Attributes:
      command: (N, T, 3) m/s, m/s, rad/s.
      position: (N, T, 3) m, position of the trunk.
      yaw: (N, T) rad.
      velocity: (N, T, 3) forward and left (m/s) and yaw rate (rad/s), at the end of the step.
      power: (N, T) W, sum over the joints of |torque x speed|, mean of the step's physics steps.
      torque: (N, T) largest share of a motor's torque limit.
      speed: (N, T) largest share of its speed limit.
      beyond: (N, T) rad, farthest that a joint is beyond its range.
      slip: (N, T) m/s, mean speed over ground of feet in contact; NaN without contact.
      touch: (N, T) bool, whether a part other than a foot has contact.
      fell: (N,) bool.
    """

    command: np.ndarray
    position: np.ndarray
    yaw: np.ndarray
    velocity: np.ndarray
    power: np.ndarray
    torque: np.ndarray
    speed: np.ndarray
    beyond: np.ndarray
    slip: np.ndarray
    touch: np.ndarray
    fell: np.ndarray


class _Body:
    """Indices of the robot in a model to which `reference_model` attached it."""

    def __init__(self, model: mujoco.MjModel, robot: RobotSpec) -> None:
        self.root = model.body(_ROBOT + robot.root_body).id
        names = [model.geom(g).name for g in range(model.ngeom)]
        self.feet = np.array([names.index(_ROBOT + name) for name in robot.foot_geoms])
        own = np.array([name.startswith(_ROBOT) for name in names])
        self.foot_of = np.full(model.ngeom, -1)
        self.foot_of[self.feet] = np.arange(len(self.feet))
        self.is_trunk = own & (model.geom_bodyid == self.root)
        self.is_other = own & (self.foot_of < 0)


class _Walker:
    """One robot in C MuJoCo."""

    def __init__(self, model: mujoco.MjModel, body: _Body, qpos: np.ndarray, substeps: int) -> None:
        self.model, self.body, self.substeps = model, body, substeps
        self.data = mujoco.MjData(model)
        self.data.qpos[:] = qpos
        mujoco.mj_forward(model, self.data)
        self.feet = self.data.geom_xpos[body.feet].copy()
        self.fell = self.touch = False
        self.standing = np.zeros(len(body.feet), bool)
        self.power = self.torque = 0.0

    def step(self, ctrl: np.ndarray) -> None:
        """One control step with the servo targets `ctrl` (J,)."""
        model, data, body = self.model, self.data, self.body
        self.feet[:] = data.geom_xpos[body.feet]
        self.standing[:], self.touch, self.power, self.torque = False, False, 0.0, 0.0
        data.ctrl[:] = ctrl
        limit = model.actuator_forcerange[:, 1]
        for _ in range(self.substeps):
            mujoco.mj_step(model, data)
            torque = data.actuator_force + data.qfrc_passive[6:]
            self.power += np.abs(torque * data.qvel[6:]).sum() / self.substeps
            self.torque = max(self.torque, float((np.abs(torque) / limit).max()))
            geoms = data.contact.geom[data.contact.dist < 0.0].ravel()
            self.standing[body.foot_of[geoms][body.foot_of[geoms] >= 0]] = True
            self.touch = self.touch or bool(body.is_other[geoms].any())
            self.fell = self.fell or bool(body.is_trunk[geoms].any())
        # mj_step leaves positions as they were before the integration.
        mujoco.mj_kinematics(model, data)
        lying = data.xmat[body.root, 8] < MIN_UPRIGHT or not np.isfinite(data.qpos).all()
        self.fell = self.fell or bool(lying)

    def slip(self, control_dt: float) -> float:
        """m/s, mean speed of the feet in contact in the last step."""
        moved = np.linalg.norm((self.data.geom_xpos[self.body.feet] - self.feet)[:, :2], axis=1)
        return float(moved[self.standing].mean() / control_dt) if self.standing.any() else np.nan

    def felt(self) -> tuple[np.ndarray, np.ndarray]:
        """(3,) angular velocity and (3,) gravity's direction in the body frame."""
        return self.data.qvel[3:6].copy(), -self.data.xmat[self.body.root].reshape(3, 3)[2]

    @property
    def yaw(self) -> float:
        matrix = self.data.xmat[self.body.root]
        return float(np.arctan2(matrix[3], matrix[0]))


class _Recorder:
    """Fills the arrays of a `Walk`."""

    def __init__(self, number: int, steps: int, speed_limit: np.ndarray) -> None:
        names = {"command": 3, "position": 3, "velocity": 3}
        singles = ("yaw", "power", "torque", "speed", "beyond", "slip")
        self.arrays: dict[str, Any] = {n: np.full((number, steps, k), np.nan) for n, k in names.items()}
        self.arrays |= {n: np.full((number, steps), np.nan) for n in singles}
        self.arrays["touch"] = np.zeros((number, steps), bool)
        self._speed_limit = speed_limit

    def note(self, i: int, t: int, walker: _Walker, command: np.ndarray, control_dt: float) -> None:
        data, a, yaw = walker.data, self.arrays, walker.yaw
        c, s = np.cos(yaw), np.sin(yaw)
        x, y = data.qvel[:2]
        joints, span = data.qpos[7:], walker.model.jnt_range[1:]
        a["command"][i, t] = command
        a["position"][i, t] = data.xpos[walker.body.root]
        a["yaw"][i, t] = yaw
        a["velocity"][i, t] = c * x + s * y, c * y - s * x, data.qvel[5]
        a["power"][i, t], a["torque"][i, t] = walker.power, walker.torque
        a["speed"][i, t] = (np.abs(data.qvel[6:]) / self._speed_limit).max()
        a["beyond"][i, t] = max(0.0, (span[:, 0] - joints).max(), (joints - span[:, 1]).max())
        a["slip"][i, t] = walker.slip(control_dt)
        a["touch"][i, t] = walker.touch


def walk(
    models: Sequence[mujoco.MjModel],
    ground: np.ndarray,
    robot: RobotSpec,
    gait: Gait,
    qpos: np.ndarray,
    commander: Commander,
    steps: int,
    speed_limit: np.ndarray,
    kicks: dict[int, np.ndarray] | None = None,
    finish: Finish | None = None,
) -> Walk:
    """Simulates N robots, each in a world of its own.

    Args:
      models: models of the grounds with the robot (`simulation.parity.c_mujoco.reference_model`).
      ground: (N,) index of each walk's model.
      qpos: (N, nq) first positions, at rest.
      commander: function that returns the robots' commands at every control step.
      speed_limit: (J,) rad/s of the motors.
      kicks: control step -> (N, 2) m/s, world frame, by which the trunk's velocity changes at its beginning.
      finish: function that returns the walks to stop; None for no early stop.
    """
    substeps = round(gait.control_dt / robot.physics_timestep)
    bodies = [_Body(model, robot) for model in models]
    walkers = [_Walker(models[g], bodies[g], q, substeps) for g, q in zip(ground, qpos, strict=True)]
    record = _Recorder(len(walkers), steps, speed_limit)
    action, history = np.zeros((len(walkers), len(gait.stand))), None
    for t in range(steps):
        places = np.array([w.data.xpos[w.body.root] for w in walkers])
        yaws = np.array([w.yaw for w in walkers])
        command = commander(places, yaws, t * gait.control_dt)
        frame = _sense(walkers, gait, command, action)
        history = frame[:, None].repeat(gait.history, 1) if history is None else history
        history = np.concatenate([frame[:, None], history[:, :-1]], axis=1)
        action = gait.action(np, history.reshape(len(walkers), -1))
        ctrl = gait.target(action)
        for walker, kick in zip(walkers, (kicks or {}).get(t, ()), strict=False):
            walker.data.qvel[:2] += kick
        stopped = finish(places, t * gait.control_dt) if finish else np.zeros(len(walkers), bool)
        for i in [i for i, w in enumerate(walkers) if not (w.fell or stopped[i])]:
            walkers[i].step(ctrl[i])
            record.note(i, t, walkers[i], command[i], gait.control_dt)
    return Walk(fell=np.array([w.fell for w in walkers]), **record.arrays)


def _sense(walkers: Sequence[_Walker], gait: Gait, command: np.ndarray, action: np.ndarray) -> np.ndarray:
    felt = [w.felt() for w in walkers]
    angular, gravity = (np.array([f[i] for f in felt]) for i in (0, 1))
    bend = np.array([w.data.qpos[7:] for w in walkers]) - gait.stand
    joint_speed = np.array([w.data.qvel[6:] for w in walkers])
    return sensor_frame(np, angular, gravity, bend, joint_speed, command, action)
