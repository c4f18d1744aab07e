"""Arrays of moving bodies. Within this package their axes are (body, env): many envs lie side by side in memory."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np

from ..datatypes import validation as v
from .kinds import AgentKind


class Bodies(NamedTuple):
    """States of bodies; every array (B, E) f32.

    Attributes:
      x, y: m.
      vx, vy: m/s.
      heading: rad.
    """

    x: Any
    y: Any
    vx: Any
    vy: Any
    heading: Any


class PreferredVelocity(NamedTuple):
    """Preferred motion of agents; every array (A, E) f32.

    Attributes:
      x, y: m/s, preferred velocity.
      face: rad, desired heading of a pedestrian: towards its goal, or towards the person it talks to. It turns to this
        heading when it stands, and limits retreat against it.
    """

    x: Any
    y: Any
    face: Any


class Traits(NamedTuple):
    """Parameters of bodies; every array (B, E) f32, or bool where stated. See `AgentKind` for the meaning.

    Attributes:
      present: bool; an absent body does not move, and others ignore it.
      radius, half_length, margin: m.
      limit: m/s, this body's largest speed.
      acceleration, braking, lateral: m/s².
      turn_radius: m.
      pivot, turn_rate: rad/s.
      horizon, wall_horizon: s.
      yielding: see `AgentKind`; 0 for a body that avoids no other (a robot, for example).
    """

    present: Any
    radius: Any
    half_length: Any
    margin: Any
    limit: Any
    acceleration: Any
    braking: Any
    lateral: Any
    turn_radius: Any
    pivot: Any
    turn_rate: Any
    horizon: Any
    wall_horizon: Any
    yielding: Any


def traits_of(kinds: Sequence[AgentKind], num_envs: int = 1) -> Traits:
    """Traits (A, num_envs) f32 of agents of these kinds, all present, at their kinds' largest speed.

    Raises:
      ValidationError: a pedestrian kind comes after a wheeled kind (see `num_wheeled`).
    """
    num_wheeled(kinds)

    def column(name: str) -> Any:
        values = np.array([getattr(kind, name) for kind in kinds], np.float32)
        return jnp.asarray(np.repeat(values[:, None], num_envs, 1))

    names = [name for name in Traits._fields if name not in ("present", "limit")]
    present = jnp.ones((len(kinds), num_envs), bool)
    return Traits(present=present, limit=column("speed_limit"), **{name: column(name) for name in names})


def num_wheeled(kinds: Sequence[AgentKind]) -> int:
    """Number of wheeled agents. They come last, so that pedestrians and vehicles are two slices.

    Raises:
      ValidationError: a pedestrian kind comes after a wheeled kind, or there is no agent.
    """
    rolls = [kind.wheeled for kind in kinds]
    if not rolls:
        raise v.fail("crowd kinds", "no agent", "at least one")
    if rolls != sorted(rolls):
        first = rolls.index(True)
        late = kinds[rolls.index(False, first)].name
        found = f"a {late} after a {kinds[first].name}"
        raise v.fail("crowd kinds", found, "walkers before wheeled kinds", "sort them by `kind.wheeled`")
    return sum(rolls)


def num_long(kinds: Sequence[AgentKind]) -> int:
    """Number of the last agents that may not be discs: the first that is longer than wide, and all after it."""
    long = [kind.half_length > 0.0 for kind in kinds]
    return len(long) - long.index(True) if any(long) else 0
