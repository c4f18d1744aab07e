"""Scripted behaviours of people: stand, queue, talk, block a route, approach head-on, be overtaken.

In:   places and headings. Out:  `Script` rows: an agent's start, the point it keeps and its heading. When: at reset,
inside jit; all are plain functions of their arguments.

Every agent has one of three modes. ROAM follows the routes of the scene from goal to goal. GO walks straight to one
point. STAY keeps to a point with a fixed heading: the agent avoids others by ORCA and returns.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from .bodies import Bodies, PreferredVelocity
from .motion import wrapped

ROAM, GO, STAY = 0, 1, 2
#: m between the centres of two people who talk, the middle of Hall's "personal" distance (The Hidden Dimension, 1966:
#: 0.45-1.2 m), and of two in a queue, in the lower half of that range.
TALK_DISTANCE, QUEUE_DISTANCE = 0.85, 0.75
#: 1/s, rate at which a staying agent returns to its point, and its largest speed in m/s.
_RETURN_RATE, _RETURN_SPEED = 1.0, 0.6


class Script(NamedTuple):
    """Rows (n,) f32, mode i32.

    Attributes:
      mode: `ROAM`, `GO` or `STAY`.
      x, y: m, start.
      heading: rad.
      speed: m/s, preferred; 0 keeps the agent's own.
      anchor_x, anchor_y: m, the point that it goes to or keeps.
      face: rad, heading while it stays.
    """

    mode: Any
    x: Any
    y: Any
    heading: Any
    speed: Any
    anchor_x: Any
    anchor_y: Any
    face: Any


def _stay(x: Any, y: Any, face: Any) -> Script:
    face = wrapped(face)
    mode = jnp.full(x.shape, STAY, jnp.int32)
    return Script(mode, x, y, face, jnp.zeros_like(x), x, y, face)


def go(x: Any, y: Any, to_x: Any, to_y: Any, speed: Any) -> Script:
    """People at points (n,) m who walk straight to other points at () or (n,) m/s."""
    heading = jnp.arctan2(to_y - y, to_x - x)
    speed = jnp.broadcast_to(jnp.asarray(speed, x.dtype), x.shape)
    return Script(jnp.full(x.shape, GO, jnp.int32), x, y, heading, speed, to_x, to_y, heading)


def talk(x: Any, y: Any, number: int, turn: Any = 0.0) -> Script:
    """`number` people in a ring around a point () m, facing each other; `turn` rad rotates the ring."""
    radius = TALK_DISTANCE / (2.0 * jnp.sin(jnp.pi / max(number, 2)))
    angle = turn + 2.0 * jnp.pi * jnp.arange(number) / number
    return _stay(x + radius * jnp.cos(angle), y + radius * jnp.sin(angle), angle + jnp.pi)


def queue(x: Any, y: Any, back: Any, number: int) -> Script:
    """`number` people in a line from a point () m in the direction `back` rad; all face its start."""
    behind_first = QUEUE_DISTANCE * jnp.arange(number)
    return _stay(x + behind_first * jnp.cos(back), y + behind_first * jnp.sin(back), jnp.full((number,), back + jnp.pi))


def obstruct(x: Any, y: Any, face: Any) -> Script:
    """One person that stands at a point () m, for example on the robot's route, with heading `face` rad."""
    return _stay(*(jnp.reshape(jnp.asarray(a, jnp.float32), (1,)) for a in (x, y, face)))


def head_on(x: Any, y: Any, heading: Any, distance: float, speed: float = 1.34, beside: float = 0.0) -> Script:
    """One person `distance` m ahead of a pose (m, m, rad) that walks towards it and past it.

    Args:
      beside: m, lateral offset to the left of the pose's line.
    """
    cos, sin = jnp.cos(heading), jnp.sin(heading)
    x, y = x - beside * sin, y + beside * cos
    ends = [jnp.reshape(x + d * cos, (1,)) for d in (distance, -distance)]
    ends += [jnp.reshape(y + d * sin, (1,)) for d in (distance, -distance)]
    return go(ends[0], ends[2], ends[1], ends[3], speed)


def overtaken(x: Any, y: Any, heading: Any, distance: float, speed: float = 0.6) -> Script:
    """One slow person `distance` m ahead of a pose that walks in the same direction for 30 m."""
    cos, sin = jnp.cos(heading), jnp.sin(heading)
    near, far = ((jnp.reshape(x + d * cos, (1,)), jnp.reshape(y + d * sin, (1,))) for d in (distance, distance + 30.0))
    return go(*near, *far, speed)


def cross(x: Any, y: Any, heading: Any, distance: float, aside: float = 4.0, speed: float = 1.34) -> Script:
    """One person that crosses a pose's line at a right angle, `distance` m ahead, from `aside` m to its left."""
    cos, sin = jnp.cos(heading), jnp.sin(heading)

    def end(side: float) -> tuple[Any, Any]:
        return jnp.reshape(x + distance * cos - side * sin, (1,)), jnp.reshape(y + distance * sin + side * cos, (1,))

    return go(*end(aside), *end(-aside), speed)


def together(*scripts: Script) -> Script:
    """Concatenates the rows of several scripts."""
    return jax.tree.map(lambda *rows: jnp.concatenate(rows), *scripts)


def scripted_velocity(mode: Any, anchor: tuple[Any, Any], face: Any, speed: Any, bodies: Bodies) -> PreferredVelocity:
    """Preferred velocities of agents in mode GO or STAY (rows (A,)); the rows of agents in mode ROAM are undefined."""
    dx, dy = anchor[0] - bodies.x, anchor[1] - bodies.y
    distance = jnp.sqrt(dx * dx + dy * dy)
    goes = mode == GO
    # An agent within a step's length of its point stops.
    pace = jnp.where(goes, jnp.minimum(speed, 2.0 * distance), jnp.minimum(_RETURN_RATE * distance, _RETURN_SPEED))
    scale = pace / jnp.maximum(distance, 1e-3)
    heading = jnp.where(goes & (distance > 0.3), jnp.arctan2(dy, dx), face)
    return PreferredVelocity(dx * scale, dy * scale, heading)
