"""Inputs that a policy's ONNX file requires of a robot, and the velocity that its actions stand for.

In:   a `PolicyRecord`. Out: `Contract`: inputs from odometry, goal and image; velocities from actions. When: every
control step.
"""

import dataclasses
import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from ..datatypes import ValidationError
from ..datatypes.policy_file import PolicyRecord, RobotRecord
from ..policies.onnx_agent import IMAGE, PROPRIO
from .messages import Odometry

#: m, as in `robots.waypoint`: the largest waypoint, and the nearest one that the robot moves for.
_REACH, _STANDSTILL = 1.0, 1e-3


def yaw_of(q: tuple[float, ...]) -> float:
    """Yaw (rad) of a unit quaternion wxyz: the direction of the body's x axis on the ground."""
    w, x, y, z = q
    return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


def tilt_of(q: tuple[float, ...]) -> float:
    """Angle (rad) between the body's z axis and the vertical."""
    _, x, y, _ = q
    return math.acos(min(1.0, max(-1.0, 1.0 - 2.0 * (x * x + y * y))))


@dataclasses.dataclass(frozen=True)
class Contract:
    """How a policy is driven.

    Attributes:
      observations: names of its inputs.
      size: (height, width) of its images; None without images.
      period_ns: time between two of its actions.
      action_mode: "waypoint" or "velocity".
      goal_limit: m, to which the goal vector is shortened; 0 for no limit.
      robot: that it was trained with.
    """

    observations: tuple[str, ...]
    size: tuple[int, int] | None
    period_ns: int
    action_mode: str
    goal_limit: float
    robot: RobotRecord

    @staticmethod
    def of(record: PolicyRecord | None, observations: tuple[str, ...], where: str) -> "Contract":
        """The contract of a file.

        Raises:
          ValidationError: the file does not say how it is driven, or needs what no robot gives.
        """
        if record is None or record.robot is None:
            raise ValidationError(
                f"{where}: found no description of the robot in its metadata, needed a file of `urbanverse "
                "export-onnx`; export the policy again."
            )
        config = record.env_config
        mode = str(config.get("action_mode", "waypoint"))
        if mode not in ("waypoint", "velocity"):
            raise ValidationError(f"{where}: found actions of mode {mode!r}, needed 'waypoint' or 'velocity'.")
        unknown = sorted(set(observations) - {IMAGE, "goal", PROPRIO})
        if unknown:
            raise ValidationError(f"{where}: found the input {unknown[0]!r}, needed what a robot measures.")
        shapes = {t.name: t.shape for t in record.inputs}
        size = None
        if IMAGE in observations:
            if shapes[IMAGE][3] != 3:
                raise ValidationError(f"{where}: found images of {shapes[IMAGE][3]} channels, needed colour alone.")
            size = int(shapes[IMAGE][1]), int(shapes[IMAGE][2])
        limit = float(config.get("goal_observation_limit", 0.0))
        return Contract(observations, size, round(1e9 / record.rate_hz), mode, limit, record.robot)

    def inputs(
        self, odometry: Odometry, goal: tuple[float, float], action: np.ndarray, image: np.ndarray | None
    ) -> dict[str, np.ndarray]:
        """Observations (1, ...) by name.

        Args:
          goal: m, in the odometry frame.
          action: (2,) of the step before, in [-1, 1]; zeros at the beginning.
          image: (height, width, 3) u8.
        """
        yaw = yaw_of(odometry.orientation_wxyz)
        dx, dy = goal[0] - odometry.position_m[0], goal[1] - odometry.position_m[1]
        cos, sin = math.cos(yaw), math.sin(yaw)
        ahead, left = cos * dx + sin * dy, cos * dy - sin * dx
        distance = math.hypot(ahead, left)
        if 0.0 < self.goal_limit < distance:
            ahead, left = ahead * self.goal_limit / distance, left * self.goal_limit / distance
        found: dict[str, Any] = {
            "goal": np.array([[ahead, left]], np.float32),
            PROPRIO: np.array([[*odometry.velocity_mps, odometry.yaw_rate_radps, *action]], np.float32),
        }
        if image is not None:
            found[IMAGE] = image[None]
        return {name: found[name] for name in self.observations}

    def velocity(self, action: Iterable[float]) -> tuple[float, float]:
        """(m/s ahead, rad/s to the left) of an action (2,) in [-1, 1]."""
        x, y = (min(1.0, max(-1.0, float(a))) for a in action)
        speed, turn = self.robot.max_speed, self.robot.max_yaw_rate
        if self.action_mode == "velocity":
            return (x + 1.0) / 2.0 * speed, y * turn
        if math.hypot(x, y) < _STANDSTILL:
            return 0.0, 0.0
        horizon = max(_REACH / speed, self.period_ns * 1e-9)
        return min(max(x / horizon, 0.0), speed), min(max(math.atan2(y, x) / horizon, -turn), turn)


def checked_actions(action: np.ndarray) -> np.ndarray:
    """(2,) f32 action of one robot, clipped to [-1, 1].

    Raises:
      ValidationError: it has another shape or is not finite.
    """
    action = np.asarray(action, np.float32)
    if action.shape != (1, 2) or not np.isfinite(action).all():
        raise ValidationError(
            f"policy: found an action of shape {action.shape}, needed finite numbers of shape (1, 2)."
        )
    return np.clip(action[0], -1.0, 1.0)


Inputs = Mapping[str, np.ndarray]
