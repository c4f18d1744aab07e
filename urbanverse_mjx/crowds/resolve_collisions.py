"""Resolves collisions of a crowd step: no body ends the step inside another, or deeper in one than before.

In:   positions of bodies, their positions after `orca`, whether the ground there is free. Out:  new positions: each
body takes its whole step, or holds. When: every crowd step, after `orca`, inside jit; per env, alone or under
`jax.vmap`.

Half-planes do not guarantee this. Where a crowd is too dense they cannot all hold, legs and wheels lag behind the
chosen velocity, and an arc is not its chord. So every step is checked once more as a whole, for all pairs of bodies. A
pair is safe if its bodies are apart afterwards or, where they were not apart before, no nearer:

* both go: their new places are compared;
* one goes: its new place and the other's present one;
* both hold: nothing changes.

The set of moving bodies starts empty, which is safe. In each round the candidates are the bodies that are safe with all
moving ones and with the present places of all others; of two candidates whose new places conflict the first one is
added. Each added body is therefore safe with all others, whether or not these are added later, after any number of
rounds; more rounds let more bodies move into places that others leave. Holding is always safe, so the proof does not
depend on how steps were chosen, and existing overlap (two bodies placed on each other) can only decrease.
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

#: Rounds in which agents may move into a place that another agent leaves. Bodies keep more than a step's length apart
#: where there is room (`AgentKind.margin`), so the second is rarely needed.
_FOLLOWING_ROUNDS = 3
#: Bits of a word in which conflicts are kept: a round then costs one operation per agent.
_WORD_BITS = 32
#: m by which bodies may enter each other, or pass a flat: rounding for two that move on in contact, or for one that
#: slides along a wall. It does not accumulate: a body this deep comes no deeper.
_MAX_PENETRATION = 1e-4


def keeps_off(walls: HalfPlanes, rear: HalfPlanes, before: Bodies, after: Bodies, traits: Traits) -> Any:
    """(A, ...) bool: a step does not push the body through a flat of the free space around it.

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
        # An offset is minus the free space over the horizon: that is the distance left, whatever the velocity.
        return jnp.all(rows.x * dx + rows.y * dy >= rows.offset * horizon - _MAX_PENETRATION, axis=0)

    found = kept(walls, slice(None), 1.0)
    if not wheeled:
        return found
    return found.at[walkers:].set(found[walkers:] & kept(rear, slice(walkers, None), -1.0))


def apart(one: Bodies, other: Bodies, half: tuple[Any, Any], long: slice) -> Any:
    """(B, A, E) m²: the square of the distance between the axes of bodies (A, E) and others (B, E).

    Args:
      half: (A, E) and (B, E) m, half lengths of the axes.
      long: those of both whose axis is longer than a point.
    """
    dx, dy = other.x[:, None] - one.x, other.y[:, None] - one.y
    found = dx * dx + dy * dy
    if long.start == long.stop:
        return found
    # Without the barrier XLA works the angles out again for each pair.
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
    """(A, E) bool: agents that take their step.

    Args:
      into_place: (W, A, E) u32, see `packed`: the agent's step ends in the present places of these agents.
      into_step: (W, A, E) u32: it ends in their steps (symmetric but for rounding).
      may: (A, E) bool: no other obstacle prevents the step.
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
    """Bodies (A, E) at the end of a step: as `after`, or as they were, at rest.

    Args:
      num_long: how many of the A, the last ones, are longer than wide; all others are discs.
      bodies, traits: (B, E) at its beginning; rows from A on are others that stay where they are (robots).
      after: (A, E), where the first A would go.
      may: (A, E) bool, the ground there is free.
    """
    agents = after.x.shape[0]
    here, like = Bodies(*(a[:agents] for a in bodies)), Traits(*(a[:agents] for a in traits))
    row = jnp.arange(bodies.x.shape[0])
    pairs = (row[:, None] != row[:agents])[..., None] & traits.present[:, None] & like.present
    halves, long = (like.half_length, traits.half_length), slice(agents - num_long, agents)
    # Overlapping bodies may come no nearer; all others may come into contact.
    reach = traits.radius[:, None] + like.radius - _MAX_PENETRATION
    least = jnp.minimum(reach * reach, apart(here, bodies, halves, long))
    into_place = pairs & (apart(after, bodies, halves, long) < least)
    into_step = pairs[:agents] & (apart(after, after, (halves[0], halves[0]), long) < least[:agents])
    place, step = jax.lax.optimization_barrier((packed(into_place[:agents]), packed(into_step)))
    go = who_goes(place, step, may & ~into_place[agents:].any(0)) | ~like.present
    # A disc that holds turns freely: that changes no distance.
    heading = jnp.where(go | (like.half_length == 0.0), after.heading, here.heading)
    rest = jnp.zeros_like(here.vx)
    held = Bodies(here.x, here.y, rest, rest, heading)
    return Bodies(*(jnp.where(go, a, b) for a, b in zip(after, held, strict=True)))


def make_resolve_collisions(num_long: int) -> Callable[..., Bodies]:
    """A function (bodies, after, traits, may) -> bodies over arrays of one env: `settled` without E."""
    return over_envs(functools.partial(resolved, num_long=num_long))
