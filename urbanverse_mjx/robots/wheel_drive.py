"""Converts a body velocity to wheel speeds and steering angles, for robots that are described by a file.

In:   (v, omega).
Out:  actuator commands.
When: every control step, inside jit.
"""

import dataclasses
import math
from collections.abc import Sequence
from typing import Any

import jax.numpy as jnp
import numpy as np

from .waypoint import STANDSTILL, clip_velocity

#: rad/s, yaw rate at which tyres slide and no longer creep.
SLIDE_RATE = 0.1


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

    @property
    def motors(self) -> tuple[int, ...]:
        """Indices of the actuators that take wheel speeds."""
        return tuple(dict.fromkeys((*self.left, *self.right)))

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


@dataclasses.dataclass(frozen=True)
class Wheel:
    """A driven or steered wheel.

    Attributes:
      x, y: m, its centre in the root body's frame, x ahead and y to the left.
      radius: m.
      motor: index of the actuator that takes its speed (rad/s); None if it is not driven.
      steer: index of the actuator that takes its angle (rad); None if it is not steered.
      max_steer: rad, largest angle.
    """

    x: float
    y: float
    radius: float
    motor: int | None = None
    steer: int | None = None
    max_steer: float = math.inf


@dataclasses.dataclass(frozen=True)
class WheelTable:
    """Drive of any wheels: differential, skid steering, Ackermann, and all wheels steered.

    Every wheel gets the angle and the speed of its own place on the body, which moves at v and turns at omega about a
    point of the line x = `axle`. Wheels that cannot turn to that direction skid. The angle of a wheel is at most 90
    degrees, so a wheel that would have to turn farther rolls backwards.

    Attributes:
      wheels: see `Wheel`.
      axle: m, place of that line in the root body's frame.
      skid: factor of the sides' difference in speed for wheels that are not steered, see `skid_factor`.
      size: number of all actuators.
      max_speed: m/s, max_yaw_rate: rad/s.
      curvature: 1/m, the largest; infinite where the robot turns on the spot.
      lateral: m/s², largest sideways acceleration v omega; above it, the robot slows down.
      bend: m/s per m/s² of sideways acceleration, half the additional difference in speed between the sides. A mass
        ahead of the axle resists a bend, and servos give a force only by an error of the speed.
      slide: m/s, the same for a tyre that slides straight ahead, at any yaw rate above `SLIDE_RATE`; one that slides
        aslant needs its share.
      held: index and command (rad) of each actuator that keeps its pose, as of legs that carry the wheels.
    """

    wheels: tuple[Wheel, ...]
    axle: float
    skid: float
    size: int
    max_speed: float
    max_yaw_rate: float
    curvature: float = math.inf
    lateral: float = math.inf
    bend: float = 0.0
    slide: float = 0.0
    held: tuple[tuple[int, float], ...] = ()

    @property
    def motors(self) -> tuple[int, ...]:
        """Indices of the actuators that take wheel speeds."""
        return tuple(wheel.motor for wheel in self.wheels if wheel.motor is not None)

    def _held(self, wheel: Wheel) -> float:
        """m/s, the part of `slide` of a wheel: in a turn, its tyre slides along the body and across it."""
        along, across = (self.skid - 1.0) * abs(wheel.y), abs(wheel.x - self.axle)
        return self.slide * along / math.hypot(along, across) if along else 0.0

    def __call__(self, velocity: Any) -> Any:
        """(size,) commands for (2,) m/s, rad/s."""
        v, omega = clip_velocity(velocity, self.max_speed, self.max_yaw_rate)
        if math.isfinite(self.lateral):
            v = jnp.minimum(v, self.lateral / jnp.maximum(jnp.abs(omega), 1e-6))
        # A robot that does not turn on the spot turns its wheels while it stands, and drives no arc that is too tight.
        scale = 1.0
        if math.isfinite(self.curvature):
            omega = jnp.clip(omega / jnp.maximum(v, STANDSTILL), -self.curvature, self.curvature)
            v, scale = 1.0, v
        commands = jnp.zeros(self.size)
        if self.held:
            actuators, angles = zip(*self.held, strict=True)
            commands = commands.at[np.array(actuators)].set(jnp.array(angles))
        for wheel in self.wheels:
            ahead, aside = v - omega * wheel.y, omega * (wheel.x - self.axle)
            if wheel.steer is not None:
                still = ahead * ahead + aside * aside < 1e-12
                # The safe value keeps the derivative of atan finite at rest.
                backwards = jnp.where(ahead < 0.0, -1.0, 1.0)
                angle = jnp.arctan2(backwards * aside, jnp.where(still, 1.0, jnp.abs(ahead)))
                commands = commands.at[wheel.steer].set(jnp.clip(angle, -wheel.max_steer, wheel.max_steer))
                rolls = backwards * jnp.sqrt(jnp.where(still, 0.0, ahead * ahead + aside * aside) + 1e-18)
            else:
                more = self.bend * v * omega + self._held(wheel) * jnp.tanh(2.0 * omega / SLIDE_RATE)
                rolls = v - omega * wheel.y * self.skid - float(np.sign(wheel.y)) * more
            if wheel.motor is not None:
                commands = commands.at[wheel.motor].set(scale * rolls / wheel.radius)
        return commands


def skid_factor(xs: Sequence[float], y: float) -> float:
    """Factor of the difference in speed between the sides with which skid steering turns at the wanted yaw rate.

    On a turn on the spot all tyres slide. With Coulomb friction and equal loads at distance a before and behind the
    centre of the turn and y to both sides, the moments of the friction forces sum to 0 at 1 + (a / y)^2: 1.85 for the
    Husky and 1.49 for the Jackal, whose makers drive them with 1.875 and 1.5 (`wheel_separation_multiplier` in
    clearpath_common). With more axles, the outer ones are those that carry.

    Args:
      xs: m, places of one side's wheels ahead of the centre of the turn.
      y: m, half the distance between the sides.
    """
    return 1.0 + (max(abs(x) for x in xs) / y) ** 2


def largest_curvature(steered: Sequence[tuple[float, float, float]], axle: float) -> float:
    """1/m, largest curvature at which no steered wheel exceeds its angle.

    Args:
      steered: x (m), y (m) and largest angle (rad) of each.
      axle: m, place of the axle that is not steered.
    """
    limits = [math.tan(angle) / (abs(x - axle) + abs(y) * math.tan(angle)) for x, y, angle in steered]
    return min(limits, default=math.inf)
