"""Readings of sensors without images, computed from the recorded states: IMU, odometry, camera pose, contacts."""

from collections.abc import Mapping, Sequence
from typing import Any

import mujoco
import numpy as np

from ...datasets.features import Feature
from ...datatypes import RobotSpec
from ...geometry import rotations
from .driving import Steps

#: m/s^2, as in the physics models.
GRAVITY = 9.81
#: Turns the axes of MuJoCo's cameras (-z ahead, y up) into those of computer vision (z ahead, y down).
OPTICAL = np.array([0.0, 1.0, 0.0, 0.0])
#: Names that `--with` takes.
READINGS = ("imu", "odometry", "camera_pose", "contacts")
IMU, ODOMETRY, CAMERA_POSE = "observation.imu", "observation.odometry", "pose.camera"
FORCE, OBJECT, FEET = "next.contact_force", "next.contact_object", "next.foot_force"


class Readings:
    """Readings of a robot's sensors.

    Args:
      robot: with the camera `camera_pose` is that of.
      dt: s between two steps.
      wanted: of `READINGS`.
    """

    def __init__(self, robot: RobotSpec, model: mujoco.MjModel, dt: float, wanted: Sequence[str]) -> None:
        self._robot, self._model, self._dt, self.wanted = robot, model, dt, tuple(wanted)
        self.root = int(model.body(robot.root_body).id)
        self._dof = int(model.body_dofadr[self.root])
        self._wheels = wheels_of(robot, model)

    def features(self) -> dict[str, Feature]:
        """The features of the readings asked for; units are in the names' documentation, docs/datasets.md."""
        imu = ("gyro_x", "gyro_y", "gyro_z", "specific_force_x", "specific_force_y", "specific_force_z")
        feet = len(self._robot.foot_geoms)
        every = {
            "imu": {IMU: Feature("float32", (6,), imu)},
            "odometry": {ODOMETRY: Feature("float32", (6,), ("x", "y", "yaw", "forward", "left", "yaw_rate"))},
            "camera_pose": {CAMERA_POSE: Feature("float32", (7,), ("x", "y", "z", "qw", "qx", "qy", "qz"))},
            "contacts": {
                FORCE: Feature("float32", (1,)),
                OBJECT: Feature("int64", (1,)),
                **({FEET: Feature("float32", (feet,), self._robot.foot_geoms)} if feet else {}),
            },
        }
        return {name: feature for reading in self.wanted for name, feature in every[reading].items()}

    def columns(self, steps: Steps) -> dict[str, np.ndarray]:
        """(T, ...) of every feature for the steps of one episode."""
        found: dict[str, np.ndarray] = {}
        for reading in self.wanted:
            found |= getattr(self, f"_{reading}")(steps)
        return found

    def _imu(self, steps: Steps) -> dict[str, np.ndarray]:
        """Angular velocity (rad/s), and specific force (m/s^2) at the origin of the root body, the mean since the last
        step; both in the body's frame."""
        velocity = np.asarray(steps.qvel[:, self._dof : self._dof + 3], np.float64)
        change = np.diff(velocity, axis=0, prepend=velocity[:1]) / self._dt
        turn = rotations.matrix_f64(steps.xquat[:, self.root])
        force = np.einsum("tji,tj->ti", turn, change + np.array([0.0, 0.0, GRAVITY]))
        return {IMU: np.concatenate([steps.qvel[:, self._dof + 3 : self._dof + 6], force], axis=1)}

    def _odometry(self, steps: Steps) -> dict[str, np.ndarray]:
        """Pose since the episode's first step in that step's frame, and velocity in the body's frame."""
        speed = self._wheel_velocity(steps) if self._wheels else self._body_velocity(steps)
        return {ODOMETRY: np.concatenate([integrated(speed, self._dt), speed], axis=1)}

    def _body_velocity(self, steps: Steps) -> np.ndarray:
        """(T, 3) forward, left (m/s), yaw rate (rad/s) as the simulator has them."""
        turn = rotations.matrix_f64(steps.xquat[:, self.root])
        linear = np.einsum("tji,tj->ti", turn, np.asarray(steps.qvel[:, self._dof : self._dof + 3], np.float64))
        return np.concatenate([linear[:, :2], steps.qvel[:, self._dof + 5 : self._dof + 6]], axis=1)

    def _wheel_velocity(self, steps: Steps) -> np.ndarray:
        """(T, 3) forward (m/s), 0, yaw rate (rad/s): the rigid motion in the plane that fits the speeds of all wheels
        best (least squares), where each rolls without slip along its own direction and may slide across it."""
        back = np.swapaxes(rotations.matrix_f64(steps.xquat[:, self.root]), 1, 2)
        rows, rolled = [], []
        for wheel in self._wheels:
            place = np.einsum("tij,tj->ti", back, steps.xpos[:, wheel["body"]] - steps.xpos[:, self.root])
            axis = np.einsum("tij,tjk,k->ti", back, rotations.matrix_f64(steps.xquat[:, wheel["body"]]), wheel["axis"])
            ahead = np.stack([axis[:, 1], -axis[:, 0]], -1)  # axis x z
            rows.append(np.stack([ahead[:, 0], place[:, 0] * ahead[:, 1] - place[:, 1] * ahead[:, 0]], -1))
            rolled.append(wheel["radius"] * np.asarray(steps.qvel[:, wheel["dof"]], np.float64))
        fit = np.einsum("tij,tj->ti", np.linalg.pinv(np.stack(rows, 1)), np.stack(rolled, 1))
        return np.stack([fit[:, 0], np.zeros(len(fit)), fit[:, 1]], -1)

    def _camera_pose(self, steps: Steps) -> dict[str, np.ndarray]:
        position, turn = camera_pose(self._model, self._robot.camera, steps.xpos, steps.xquat)
        return {CAMERA_POSE: np.concatenate([position, rotations.product(turn, OPTICAL)], axis=1)}

    def _contacts(self, steps: Steps) -> dict[str, np.ndarray]:
        """Largest force (N), and what was touched, as the labels of the instance image; -1 = nothing or the ground."""
        contacts = steps.contacts
        touched = np.where(contacts.hit_object >= 0, contacts.hit_object + 3, -1)
        if contacts.hit_agent is not None:
            touched = np.where((touched < 0) & (contacts.hit_agent >= 0), 2, touched)
        feet = {FEET: contacts.foot_force} if self._robot.foot_geoms else {}
        return {FORCE: contacts.hit_force, OBJECT: touched, **feet}


def wheels_of(robot: RobotSpec, model: mujoco.MjModel) -> list[dict[str, Any]]:
    """Body, axis in it (3,), radius (m) and speed's index of each foot that turns on a hinge with its centre on it, and
    has friction: others turn at the speed of their motor whatever the robot does."""
    found = []
    for name in robot.foot_geoms:
        geom = model.geom(name)
        body = int(geom.bodyid[0])
        first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
        if geom.condim[0] == 1 or count != 1 or model.jnt_type[first] != mujoco.mjtJoint.mjJNT_HINGE:
            continue
        axis = model.jnt_axis[first]
        if np.linalg.norm(np.cross(geom.pos - model.jnt_pos[first], axis)) < 1e-3:
            dof = int(model.jnt_dofadr[first])
            found.append({"body": body, "axis": axis.copy(), "radius": float(geom.size[0]), "dof": dof})
    return found


def integrated(speed: np.ndarray, dt: float) -> np.ndarray:
    """(T, 3) x, y (m), yaw (rad) from (T, 3) forward, left (m/s) and yaw rate (rad/s): from zero, each step by the mean
    of the speeds at both ends."""
    middle = np.concatenate([np.zeros((1, 3)), 0.5 * (speed[1:] + speed[:-1])]) * dt
    yaw = np.cumsum(middle[:, 2])
    heading = yaw - 0.5 * middle[:, 2]
    c, s = np.cos(heading), np.sin(heading)
    x, y = c * middle[:, 0] - s * middle[:, 1], s * middle[:, 0] + c * middle[:, 1]
    return np.stack([np.cumsum(x), np.cumsum(y), yaw], -1)


def camera_pose(
    model: mujoco.MjModel, camera: str, xpos: np.ndarray, xquat: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Position (T, 3) m and wxyz rotation (T, 4), T_world_camera in MuJoCo's axes, of a camera of a robot at xpos
    (T, nbody, 3), xquat (T, nbody, 4)."""
    fixed = model.camera(camera)
    body = int(fixed.bodyid[0])
    turn = np.asarray(xquat[:, body], np.float64)
    place = np.broadcast_to(fixed.pos, (len(turn), 3))
    quaternion = rotations.product(turn, np.broadcast_to(fixed.quat, turn.shape))
    return xpos[:, body] + rotations.rotate(turn, place), quaternion


def intrinsics(model: mujoco.MjModel, camera: str, height: int, width: int) -> Mapping[str, float]:
    """Pinhole parameters in pixels; the centre of the pixel in the upper left corner is at (0.5, 0.5)."""
    focal = 0.5 * height / np.tan(0.5 * np.radians(float(model.camera(camera).fovy[0])))
    return {"fx": float(focal), "fy": float(focal), "cx": 0.5 * width, "cy": 0.5 * height}
