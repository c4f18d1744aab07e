"""Resolves deadlocks between people that block each other.

In:   preferred velocities and the motion so far. Out:  preferred velocities, turned to one side for agents without
progress for a while. When: every crowd step, before `orca`, inside jit.

ORCA does not resolve symmetric deadlocks of several agents: in a ring of people whose goals are on the opposite side,
all touch and none can move forward (this also holds for the published algorithm with any horizon, see
`tests/crowds/test_scenes.py`). The usual disturbance of every preferred velocity by a thousandth separates two agents
that meet head-on, but not such a ring. People step to a habitual side, in most countries the right (Moussaïd et al.,
Proc. R. Soc. B 276, 2009: in four of five encounters), which makes the ring rotate.
"""

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp

from .bodies import PreferredVelocity
from .motion import wrapped

#: s, time constant of the average progress.
PROGRESS_TIME_CONSTANT = 1.5
#: rad, largest rotation of the preferred velocity; with more than pi / 2 an agent would walk back.
MAX_ROTATION = 1.3
#: s, mean time after which a blocked agent tries the other side.
SIDE_CHANGE_TIME = 3.0
#: s, time that a vehicle stands before it backs up (plus about a second); s, duration, and m/s, speed of backing up.
STUCK_TIME, BACK_TIME, BACK_SPEED = 4.0, 3.0, 0.8
#: Share of people that step to the right (Moussaïd et al. 2009, right-hand side countries).
RIGHT_SIDE_SHARE = 0.8


@dataclasses.dataclass(frozen=True)
class DeadlockOptions:
    """Conditions for a blocked pedestrian to step aside; chosen manually.

    Attributes:
      first_share: missing share of the preferred velocity from which an agent steps aside.
      full_share: missing share at which it does so fully.
      min_speed: m/s; smaller preferred velocities belong to agents that have arrived or wait.
    """

    first_share: float = 0.35
    full_share: float = 0.8
    min_speed: float = 0.3


_OPTIONS = DeadlockOptions()


def habitual_side(key: Any, agents: int, right: float = RIGHT_SIDE_SHARE) -> Any:
    """(agents,) f32: -1 for agents that step to their right, 1 for the others."""
    return jnp.where(jax.random.uniform(key, (agents,)) < right, -1.0, 1.0)


def held_up(blocked: Any, preferred_velocity: PreferredVelocity, velocity: tuple[Any, Any], dt: float) -> Any:
    """(A,) in [0, 1], recently missing share of the preferred velocity.

    Args:
      blocked: (A,), the value of the previous step; 0 at the start.
      preferred_velocity, velocity: (A,) m/s, the (rotated) input of `orca` and its result, so that an agent that steps
        aside freely does not count as blocked and soon turns to its goal again.
      dt: s.
    """
    (wx, wy, _), (vx, vy) = preferred_velocity, velocity
    square = wx * wx + wy * wy
    wanted = square > _OPTIONS.min_speed * _OPTIONS.min_speed
    forward = jnp.where(wanted, (wx * vx + wy * vy) / jnp.where(wanted, square, 1.0), 1.0)
    return blocked + min(1.0, dt / PROGRESS_TIME_CONSTANT) * (1.0 - jnp.clip(forward, 0.0, 1.0) - blocked)


def step_aside(preferred_velocity: PreferredVelocity, blocked: Any, side: Any) -> PreferredVelocity:
    """Preferred velocities (A,), rotated to `side` for blocked agents (see `habitual_side`; 0 for no rotation)."""
    angle = (
        side
        * MAX_ROTATION
        * jnp.clip((blocked - _OPTIONS.first_share) / (_OPTIONS.full_share - _OPTIONS.first_share), 0.0, 1.0)
    )
    cos, sin = jnp.cos(angle), jnp.sin(angle)
    return PreferredVelocity(
        cos * preferred_velocity.x - sin * preferred_velocity.y,
        sin * preferred_velocity.x + cos * preferred_velocity.y,
        preferred_velocity.face,
    )


def back_up(preferred_velocity: PreferredVelocity, backing: Any, heading: Any) -> PreferredVelocity:
    """Preferred velocities (A,) of vehicles, backwards if their remaining time to back up, (A,) s, is above 0."""
    backs = backing > 0.0
    x, y = -BACK_SPEED * jnp.cos(heading), -BACK_SPEED * jnp.sin(heading)
    # The desired heading turns towards the route by a limited angle, so that the motion stays backwards.
    turn = jnp.clip(wrapped(preferred_velocity.face - heading), -0.7, 0.7)
    return PreferredVelocity(
        jnp.where(backs, x, preferred_velocity.x),
        jnp.where(backs, y, preferred_velocity.y),
        jnp.where(backs, wrapped(heading + turn), preferred_velocity.face),
    )


def backing_time(backing: Any, still: Any, key: Any, dt: float) -> Any:
    """(A,) s, remaining time to back up after one step; vehicles that stood for `STUCK_TIME` s (`still`, (A,) s) begin
    to back up."""
    begins = (still > STUCK_TIME) & (jax.random.uniform(key, backing.shape) < dt)
    return jnp.where(backing > 0.0, jnp.maximum(backing - dt, 0.0), jnp.where(begins, BACK_TIME, 0.0))


def reconsider(side: Any, blocked: Any, key: Any, dt: float) -> Any:
    """Sides (A,) after one step; an agent that stepped aside without success tries the other side after about
    `SIDE_CHANGE_TIME` s."""
    chance = jnp.where(blocked >= _OPTIONS.full_share, min(1.0, dt / SIDE_CHANGE_TIME), 0.0)
    return jnp.where(jax.random.uniform(key, side.shape) < chance, -side, side)
