"""Chooses spawn positions of agents: on their routes, clear of other bodies and out of the robot's sight.

In: a table of positions, the present bodies, the robot's pose. Out: a position. When: at reset for all agents, then for
those that arrive, inside jit.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from .motion import wrapped

#: m, distance within which an agent counts as visible from any side, and within the field of view; a person 30 m away
#: is 6 pixels high in the paper's frame of 135 rows at a field of view of 60°.
NOTICE_DISTANCE, VIEW_DISTANCE = 4.0, 30.0
#: rad, half the angle of view within which an agent is visible, wider than the camera's.
HALF_VIEW_ANGLE = 1.0


class Observer(NamedTuple):
    """Attributes:
    x, y: () m. heading: () rad. present: () bool, there is a robot.
    """

    x: Any
    y: Any
    heading: Any
    present: Any


def visible(observer: Observer, x: Any, y: Any) -> Any:
    """(...) bool, whether the observer would see an agent appear or vanish at points (...) m; ignores occlusion."""
    dx, dy = x - observer.x, y - observer.y
    distance = jnp.sqrt(dx * dx + dy * dy)
    ahead = jnp.abs(wrapped(jnp.arctan2(dy, dx) - observer.heading)) < HALF_VIEW_ANGLE
    return observer.present & ((distance < NOTICE_DISTANCE) | (ahead & (distance < VIEW_DISTANCE)))


def choose(
    key: Any,
    place: Any,
    size: Any,
    x: Any,
    y: Any,
    their_size: Any,
    present: Any,
    observer: Observer,
    hidden: bool,
    reach: float | None = None,
) -> tuple[Any, Any]:
    """Draws one of the suitable positions (S, 2) m.

    Args:
      size: () m, radius of the new agent; its distance to the present bodies (B,) at x, y must be at least 0.5 m.
      their_size: m around each of them, including its braking distance.
      hidden: whether the position must be out of the observer's sight; otherwise a body's length of distance suffices.
      reach: m; positions within this distance of the observer are preferred.

    Returns:
      () i32, the position, and () bool, whether there is one.
    """
    gap = jnp.sqrt((place[:, :1] - x) ** 2 + (place[:, 1:] - y) ** 2) - their_size - size
    clear = jnp.all((gap > 0.5) | ~present, axis=1)
    away = jnp.sqrt((place[:, 0] - observer.x) ** 2 + (place[:, 1] - observer.y) ** 2) - size
    if hidden:
        clear &= ~visible(observer, place[:, 0], place[:, 1])
    else:
        clear &= (away > 1.5) | ~observer.present
    priority = jax.random.uniform(key, clear.shape)
    if reach is not None:
        priority += observer.present & (away < reach)
    return jnp.argmax(jnp.where(clear, priority, -1.0)).astype(jnp.int32), clear.any()
