"""Where agents appear: on their routes, clear of each other and out of the robot's sight.

In: a table of places, the present bodies, the robot's pose. Out: a place. When: at reset for all agents, then for those
that arrive, inside jit.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from .motion import wrapped

#: m, within which an agent counts as visible to the robot; beyond it an agent covers a few pixels: a person 30 m away
#: is 6 pixels high in the paper's frame of 135 rows at a field of view of 60°.
NOTICED, SEEN = 4.0, 30.0
#: rad, half the angle within which an agent is in sight, wider than the camera's field of view.
HALF_VIEW = 1.0


class Observer(NamedTuple):
    """Attributes:
    x, y: () m. heading: () rad. present: () bool, there is a robot.
    """

    x: Any
    y: Any
    heading: Any
    present: Any


def visible(observer: Observer, x: Any, y: Any) -> Any:
    """(...) bool: the observer would see an agent appear or vanish at places (...) m; occlusion is not considered."""
    dx, dy = x - observer.x, y - observer.y
    distance = jnp.sqrt(dx * dx + dy * dy)
    ahead = jnp.abs(wrapped(jnp.arctan2(dy, dx) - observer.heading)) < HALF_VIEW
    return observer.present & ((distance < NOTICED) | (ahead & (distance < SEEN)))


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
    """One of the places (S, 2) m at random among those that will do.

    Args:
      size: () m, radius of the new agent; a place must be clear of the present bodies (B,) at x, y by a step (0.5 m).
      their_size: m around each of them, with its braking distance.
      hidden: the place must be out of the observer's sight; at reset a body's length away from it suffices.
      reach: m; places nearer to the observer than this come first.

    Returns:
      () i32 and () bool: there is such a place.
    """
    gap = jnp.sqrt((place[:, :1] - x) ** 2 + (place[:, 1:] - y) ** 2) - their_size - size
    clear = jnp.all((gap > 0.5) | ~present, axis=1)
    away = jnp.sqrt((place[:, 0] - observer.x) ** 2 + (place[:, 1] - observer.y) ** 2) - size
    if hidden:
        clear &= ~visible(observer, place[:, 0], place[:, 1])
    else:
        clear &= (away > 1.5) | ~observer.present
    luck = jax.random.uniform(key, clear.shape)
    if reach is not None:
        luck += observer.present & (away < reach)
    return jnp.argmax(jnp.where(clear, luck, -1.0)).astype(jnp.int32), clear.any()
