"""Ends deadlocks between people that block each other.

In:   preferred velocities and the motion so far. Out:  preferred velocities, turned to one side for agents without
progress for a while. When: every crowd step, before `orca`, inside jit.

Where several agents meet in symmetry, ORCA never resolves the deadlock: in a ring of people whose goals are on the
opposite side, all touch and none can move forward (the published algorithm does the same, whatever its horizon;
`tests/crowds/test_scenes.py` holds the case). The usual disturbance of every preferred velocity by a thousandth
separates two agents that meet head on, but not such a ring. People step to a habitual side, in most countries the right
(Moussaïd et al., Proc. R. Soc. B 276, 2009: the right in four of five meetings), and the ring starts to rotate.
"""

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp

from .bodies import PreferredVelocity
from .motion import wrapped

#: s, over which coming forward is averaged.
MEMORY = 1.5
#: rad, how far the preferred velocity is turned at most: just past sideways one would walk back.
MOST = 1.3
#: s, mean time after which a blocked agent tries the other side.
CHANGE_MIND = 3.0
#: s, how long a vehicle stands before it backs up (about a second more); how long it does, s, and how fast, m/s.
STUCK, BACK_TIME, BACK_SPEED = 4.0, 3.0, 0.8
#: Share of people that step to the right (Moussaïd et al. 2009, right-hand side countries).
RIGHT = 0.8


@dataclasses.dataclass(frozen=True)
class DeadlockOptions:
    """When a blocked walker steps aside; chosen manually.

    Attributes:
      first_share: share of the preferred velocity that must be missing before an agent steps aside.
      full_share: share at which it does so fully.
      min_speed: m/s, preferred velocities below it are those of agents that have arrived or wait.
    """

    first_share: float = 0.35
    full_share: float = 0.8
    min_speed: float = 0.3


_OPTIONS = DeadlockOptions()


def habitual_side(key: Any, agents: int, right: float = RIGHT) -> Any:
    """(agents,) f32: -1 for agents that step to their right, 1 for the others."""
    return jnp.where(jax.random.uniform(key, (agents,)) < right, -1.0, 1.0)


def held_up(blocked: Any, preferred_velocity: PreferredVelocity, velocity: tuple[Any, Any], dt: float) -> Any:
    """(A,) in [0, 1]: share of the preferred velocity that failed of late.

    Args:
      blocked: (A,), the value one step before; 0 at the start.
      preferred_velocity, velocity: (A,) m/s, the input of `orca` (already turned) and its result: an agent that steps
        aside freely is not blocked, and soon turns to its goal again.
      dt: s.
    """
    (wx, wy, _), (vx, vy) = preferred_velocity, velocity
    square = wx * wx + wy * wy
    wanted = square > _OPTIONS.min_speed * _OPTIONS.min_speed
    forward = jnp.where(wanted, (wx * vx + wy * vy) / jnp.where(wanted, square, 1.0), 1.0)
    return blocked + min(1.0, dt / MEMORY) * (1.0 - jnp.clip(forward, 0.0, 1.0) - blocked)


def step_aside(preferred_velocity: PreferredVelocity, blocked: Any, side: Any) -> PreferredVelocity:
    """Preferred velocities (A,), turned to `side` (see `habitual_side`; 0 never turns) for blocked agents."""
    angle = (
        side
        * MOST
        * jnp.clip((blocked - _OPTIONS.first_share) / (_OPTIONS.full_share - _OPTIONS.first_share), 0.0, 1.0)
    )
    cos, sin = jnp.cos(angle), jnp.sin(angle)
    return PreferredVelocity(
        cos * preferred_velocity.x - sin * preferred_velocity.y,
        sin * preferred_velocity.x + cos * preferred_velocity.y,
        preferred_velocity.face,
    )


def back_up(preferred_velocity: PreferredVelocity, backing: Any, heading: Any) -> PreferredVelocity:
    """Preferred velocities (A,) of vehicles, backwards for those with time left to back up, (A,) s."""
    backs = backing > 0.0
    x, y = -BACK_SPEED * jnp.cos(heading), -BACK_SPEED * jnp.sin(heading)
    # The desired heading turns towards the route, but never so far that backwards becomes forwards.
    turn = jnp.clip(wrapped(preferred_velocity.face - heading), -0.7, 0.7)
    return PreferredVelocity(
        jnp.where(backs, x, preferred_velocity.x),
        jnp.where(backs, y, preferred_velocity.y),
        jnp.where(backs, wrapped(heading + turn), preferred_velocity.face),
    )


def backing_time(backing: Any, still: Any, key: Any, dt: float) -> Any:
    """(A,) s left to back up, one step later: vehicles that stood for `STUCK` s (`still`, (A,) s) begin with it."""
    begins = (still > STUCK) & (jax.random.uniform(key, backing.shape) < dt)
    return jnp.where(backing > 0.0, jnp.maximum(backing - dt, 0.0), jnp.where(begins, BACK_TIME, 0.0))


def reconsider(side: Any, blocked: Any, key: Any, dt: float) -> Any:
    """Sides (A,) one step later: an agent that stepped aside in vain tries the other side after about `CHANGE_MIND`."""
    chance = jnp.where(blocked >= _OPTIONS.full_share, min(1.0, dt / CHANGE_MIND), 0.0)
    return jnp.where(jax.random.uniform(key, side.shape) < chance, -side, side)
