"""Converts a body velocity to wheel speeds, for robots that are described by a file.

In:   (v, omega).
Out:  actuator commands.
When: every control step, inside jit.
"""

import dataclasses
from typing import Any

import jax.numpy as jnp
import numpy as np

from .waypoint import STANDSTILL, clip_velocity


@dataclasses.dataclass(frozen=True)
class WheelDrive:
    """Drive with two sides of wheels about the centre of their axle, or with a steered front axle.

    Attributes:
      left, right: indices of the actuators of both sides, which take wheel speeds (rad/s).
      wheel_radius: m.
      track: m between the sides.
      size: number of all actuators.
      max_speed: m/s, max_yaw_rate: rad/s.
      steer: index of the actuator that takes the front axle's angle (rad); None for a differential drive.
      wheelbase: m between the axles.
      max_steer: rad.
    """

    left: tuple[int, ...]
    right: tuple[int, ...]
    wheel_radius: float
    track: float
    size: int
    max_speed: float
    max_yaw_rate: float
    steer: int | None = None
    wheelbase: float = 1.0
    max_steer: float = 0.0

    def __call__(self, velocity: Any) -> Any:
        """(size,) commands for (2,) m/s, rad/s."""
        speed, yaw_rate = clip_velocity(velocity, self.max_speed, self.max_yaw_rate)
        commands = jnp.zeros(self.size)
        if self.steer is not None:
            # At rest the wheels do not turn, and only the sign of the angle is kept.
            angle = jnp.arctan2(self.wheelbase * yaw_rate, jnp.maximum(speed, STANDSTILL))
            angle = jnp.clip(angle, -self.max_steer, self.max_steer)
            commands, yaw_rate = commands.at[self.steer].set(angle), speed * jnp.tan(angle) / self.wheelbase
        half = 0.5 * self.track * yaw_rate
        commands = commands.at[np.array(self.left)].set((speed - half) / self.wheel_radius)
        return commands.at[np.array(self.right)].set((speed + half) / self.wheel_radius)
