"""Resolves collisions of a crowd step: no body ends the step inside another one, or deeper than before.

In:   positions of bodies, their positions after `orca`, whether the ground there is free. Out:  new positions: each
body either takes its complete step or keeps its position. When: every crowd step, after `orca`, inside jit; per env,
alone or under `jax.vmap`.

Half-planes do not guarantee this: in a dense crowd they may be infeasible, bodies lag behind the chosen velocity, and
an arc differs from its chord. Every step is therefore checked for all pairs of bodies. A pair is safe if its bodies do
not overlap afterwards or, if they overlapped before, are no nearer:

* both move: their new positions are compared;
* one moves: its new position and the other's current one;
* both stay: nothing changes.

The set of moving bodies starts empty, which is safe. In each round, the candidates are the bodies that are safe with
all moving ones and with the current positions of all others; of two candidates whose new positions conflict, the first
one is added. Each added body is therefore safe with all others, whether or not these are added later. More rounds let
more bodies move to positions that others leave. Staying is always safe, so this does not depend on how steps were
chosen, and existing overlap can only decrease.
"""

import functools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp

from . import half_planes
from .batching import over_envs
from .bodies import Bodies, Traits
from .linear_program import HalfPlanes

#: Rounds in which agents may move to a position that another agent leaves. Bodies keep more than a step's length apart
#: if there is room (`AgentKind.margin`), so the second round is rarely needed.
_FOLLOWING_ROUNDS = 3
#: Number of bits of the words that store conflicts, with which a round needs one operation per agent.
_WORD_BITS = 32
#: m, tolerated penetration of bodies or flats, for rounding errors of bodies in contact. It does not accumulate,
#: because a body this deep cannot move deeper.
_MAX_PENETRATION = 1e-4


def keeps_off(walls: HalfPlanes, rear: HalfPlanes, before: Bodies, after: Bodies, traits: Traits) -> Any:
    """(A, ...) bool, whether a step does not move the body through a flat.

    Args:
      walls: (M, A, ...), see `half_planes.towards_walls`, for walkers' bodies and the front discs of vehicles.
      rear: (M, W, ...), the same for the rear discs of the W vehicles, the last bodies.
      before, after: (A, ...).
      traits: (A, ...).
    """
    wheeled = rear.offset.shape[1]
    walkers = walls.offset.shape[1] - wheeled

    def kept(rows: HalfPlanes, part: slice, end: float) -> Any:
        old, new = (Bodies(*(a[part] for a in b)) for b in (before, after))
        half, horizon = end * traits.half_length[part], traits.wall_horizon[part]
        dx = new.x - old.x + half * (jnp.cos(new.heading) - jnp.cos(old.heading))
        dy = new.y - old.y + half * (jnp.sin(new.heading) - jnp.sin(old.heading))
        # An offset is minus the free space over the horizon, which gives the remaining distance.
        return jnp.all(rows.x * dx + rows.y * dy >= rows.offset * horizon - _MAX_PENETRATION, axis=0)

    found = kept(walls, slice(None), 1.0)
    if not wheeled:
        return found
    return found.at[walkers:].set(found[walkers:] & kept(rear, slice(walkers, None), -1.0))


def apart(one: Bodies, other: Bodies, half: tuple[Any, Any], long: slice) -> Any:
    """(B, A, E) m², squared distance between the axes of bodies (A, E) and others (B, E).

    Args:
      half: (A, E) and (B, E) m, half lengths of the axes.
      long: bodies of both whose axis has a length.
    """
    dx, dy = other.x[:, None] - one.x, other.y[:, None] - one.y
    found = dx * dx + dy * dy
    if long.start == long.stop:
        return found
    # The barrier prevents XLA from recomputing the angles for each pair.
    axes = [(h * jnp.cos(b.heading), h * jnp.sin(b.heading)) for b, h in zip((one, other), half, strict=True)]
    own, theirs = jax.lax.optimization_barrier(tuple(axes))

    def between(rows: slice, columns: slice) -> Any:
        delta = dx[rows, columns], dy[rows, columns]
        near_x, near_y, _ = half_planes.nearest_places(
            delta, (own[0][columns], own[1][columns]), (theirs[0][rows, None], theirs[1][rows, None])
        )
        return near_x * near_x + near_y * near_y

    discs, rest = slice(0, long.start), slice(long.stop, None)
    left = jnp.concatenate([found[discs, discs], between(long, discs), found[rest, discs]])
    return jnp.concatenate([left, between(slice(None), long)], axis=1)


def packed(flags: Any) -> Any:
    """(W, ..., E) u32: bools (B, ..., E), 32 of the first axis in a word, the first in its lowest bit."""
    words = -(-flags.shape[0] // _WORD_BITS)
    rows = jnp.pad(flags, [(0, words * _WORD_BITS - flags.shape[0])] + [(0, 0)] * (flags.ndim - 1))
    rows = rows.reshape(words, _WORD_BITS, *flags.shape[1:])
    bit = (jnp.uint32(1) << jnp.arange(_WORD_BITS, dtype=jnp.uint32)).reshape(_WORD_BITS, *(1,) * (flags.ndim - 1))
    return jnp.where(rows, bit, jnp.uint32(0)).sum(1, dtype=jnp.uint32)


def who_goes(into_place: Any, into_step: Any, may: Any) -> Any:
    """(A, E) bool, agents that take their step.

    Args:
      into_place: (W, A, E) u32, see `packed`, agents with whose current position the agent's step conflicts.
      into_step: (W, A, E) u32, agents with whose step it conflicts (symmetric except for rounding).
      may: (A, E) bool, whether no other obstacle prevents the step.
    """
    agents = may.shape[0]
    row = jnp.arange(agents)
    first = packed(row[:, None] < row)[..., None]
    go = jnp.zeros_like(may)
    for _ in range(_FOLLOWING_ROUNDS):
        gone = packed(go)[:, None]
        blocked = ((into_place & ~gone) | (into_step & gone)).any(0)
        candidate = may & ~go & ~blocked
        go |= candidate & ~(into_step & packed(candidate)[:, None] & first).any(0)
    return go


def resolved(bodies: Bodies, after: Bodies, traits: Traits, may: Any, num_long: int) -> Bodies:
    """Bodies (A, E) at the end of a step: those of `after`, or unmoved and at rest.

    Args:
      num_long: number of the last of the A bodies that are longer than wide; all others are discs.
      bodies, traits: (B, E) at its beginning; rows from A are bodies that are not moved (robots).
      after: (A, E), the first A bodies after their step.
      may: (A, E) bool, the ground there is free.
    """
    agents = after.x.shape[0]
    here, like = Bodies(*(a[:agents] for a in bodies)), Traits(*(a[:agents] for a in traits))
    row = jnp.arange(bodies.x.shape[0])
    pairs = (row[:, None] != row[:agents])[..., None] & traits.present[:, None] & like.present
    halves, long = (like.half_length, traits.half_length), slice(agents - num_long, agents)
    # Overlapping bodies may not come nearer; others may come into contact.
    reach = traits.radius[:, None] + like.radius - _MAX_PENETRATION
    least = jnp.minimum(reach * reach, apart(here, bodies, halves, long))
    into_place = pairs & (apart(after, bodies, halves, long) < least)
    into_step = pairs[:agents] & (apart(after, after, (halves[0], halves[0]), long) < least[:agents])
    place, step = jax.lax.optimization_barrier((packed(into_place[:agents]), packed(into_step)))
    go = who_goes(place, step, may & ~into_place[agents:].any(0)) | ~like.present
    # A disc that stays may turn, which changes no distance.
    heading = jnp.where(go | (like.half_length == 0.0), after.heading, here.heading)
    rest = jnp.zeros_like(here.vx)
    held = Bodies(here.x, here.y, rest, rest, heading)
    return Bodies(*(jnp.where(go, a, b) for a, b in zip(after, held, strict=True)))


def make_resolve_collisions(num_long: int) -> Callable[..., Bodies]:
    """A function (bodies, after, traits, may) -> bodies over arrays of one env: `resolved` without the env axis."""
    return over_envs(functools.partial(resolved, num_long=num_long))
