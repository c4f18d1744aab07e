"""The ideal PD controller of the paper, which converts a waypoint to a body velocity for all robots.

In:   a waypoint in the body frame.
Out:  (v, omega).
When: every control step, inside jit.
"""

from typing import Any

import jax.numpy as jnp

WAYPOINT_REACH = 1.0  # m, design section 4: the action's range is [-1, 1] m
#: m; the robot stands still for a waypoint nearer than this.
STANDSTILL = 1e-3


def clip_velocity(velocity: Any, max_speed: float, max_yaw_rate: float) -> Any:
    """(2,) (v m/s, omega rad/s) clipped to the range of a robot that never drives backwards."""
    velocity = jnp.asarray(velocity)
    return jnp.stack([jnp.clip(velocity[0], 0.0, max_speed), jnp.clip(velocity[1], -max_yaw_rate, max_yaw_rate)])


def gait_command(velocity: Any, max_speed: float, max_yaw_rate: float) -> Any:
    """(3,) m/s ahead, m/s left, rad/s, the command of a gait, for (v, omega)."""
    v, omega = clip_velocity(velocity, max_speed, max_yaw_rate)
    return jnp.stack([v, 0.0 * v, omega])


def pd_velocity(waypoint: Any, control_period: float, max_speed: float, max_yaw_rate: float) -> tuple[Any, Any]:
    """Body velocity that reaches and faces the waypoint within one horizon.

    The horizon is the time to a waypoint at full reach at full speed, so a waypoint 1 m ahead means full speed at every
    control rate; it is never shorter than the control period, which would overshoot. For a waypoint beside or behind
    the robot, the speed is 0 and the yaw rate is the largest.

    Args:
      waypoint: (2,) m, x forward and y left, in the body frame.
      control_period: s.
      max_speed: m/s.
      max_yaw_rate: rad/s.

    Returns:
      v () m/s in [0, max_speed] and omega () rad/s in [-max_yaw_rate, max_yaw_rate].
    """
    horizon = max(WAYPOINT_REACH / max_speed, control_period)
    x, y = waypoint[0], waypoint[1]
    here = x * x + y * y < STANDSTILL**2
    # The safe value keeps the derivative of atan2 finite at the origin.
    bearing = jnp.where(here, 0.0, jnp.arctan2(jnp.where(here, 0.0, y), jnp.where(here, 1.0, x)))
    velocity = clip_velocity(jnp.stack([jnp.where(here, 0.0, x), bearing]) / horizon, max_speed, max_yaw_rate)
    return velocity[0], velocity[1]
