"""Finds the nearest bodies around every agent.

In: positions and sizes of the bodies of each env. Out: indices of a fixed number of neighbours, nearest first. When:
every crowd step, inside jit.

Arrays are (body, env). Neighbours are ranked by the gap to the circumscribed disc, so that a car's front ranks before a
person behind it.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

_NEVER = jnp.iinfo(jnp.int32).max


class Neighbours(NamedTuple):
    """Attributes: index: (K, A, E) i32, numbers of bodies, nearest first. valid: (K, A, E) bool. missed: (A, E) i32,
    number of bodies in range that the search left out for lack of slots (0 if all are compared).
    """

    index: Any
    valid: Any
    missed: Any


def _sortable(distance: Any, index: Any, bits: int) -> Any:
    """i32 keys in the order of the distances (m), whose lowest `bits` bits hold the index.

    With 5 bits, a gap of 3 m is rounded to 8 µm.
    """
    raw = jax.lax.bitcast_convert_type(distance, jnp.int32)
    raw = raw ^ ((raw >> 31) & 0x7FFFFFFF)
    return (raw & ~((1 << bits) - 1)) | index


def _smallest(keys: Any, number: int, bits: int) -> tuple[Any, Any]:
    """Indices of the `number` smallest keys (C, A, E) along the first axis (0 if there are fewer), and their
    validity."""
    found, last = [], None
    for _ in range(number):
        last = jnp.min(keys if last is None else jnp.where(keys > last, keys, _NEVER), axis=0)
        found.append(last)
    all_found = jnp.stack(found)
    valid = all_found != _NEVER
    return jnp.where(valid, all_found & ((1 << bits) - 1), 0), valid


def all_pairs(x: Any, y: Any, size: Any, present: Any, agents: int, number: int) -> Neighbours:
    """Finds the nearest bodies by comparing all pairs.

    Args:
      x, y: (B, E) f32 m.
      size: (B, E) m, circumscribed radius.
      present: (B, E) bool.
      agents: A, number of the first rows, whose neighbours are searched.
      number: K, at most B - 1.
    """
    bodies = x.shape[0]
    bits = max(1, (bodies - 1).bit_length())
    dx, dy = x[:, None] - x[None, :agents], y[:, None] - y[None, :agents]
    gap = jnp.sqrt(dx * dx + dy * dy) - size[:, None]
    row = jnp.arange(bodies, dtype=jnp.int32)[:, None, None]
    seen = present[:, None] & (row != row[:agents, 0][None])
    keys = jnp.where(seen, _sortable(gap, row, bits), _NEVER)
    index, valid = _smallest(keys, min(number, bodies - 1), bits)
    return Neighbours(index, valid, jnp.zeros(x[:agents].shape, jnp.int32))


def in_grid(
    x: Any, y: Any, size: Any, present: Any, agents: int, number: int, cell: float, cells: int, depth: int
) -> Neighbours:
    """Finds the nearest bodies among those in the 3 x 3 cells around each agent.

    The plane is cut into square cells and wrapped onto `cells` x `cells` of them; bodies are sorted by cell, and each
    agent is compared with `depth` bodies of each cell.

    Args:
      x, y, size, present, agents, number: as in `all_pairs`.
      cell: m, side of a cell; bodies farther away may be missed.
      cells: number of cells along a side, at least 3.
      depth: number of bodies compared per cell.
    """
    bodies, envs = x.shape
    bits = max(1, (bodies - 1).bit_length())
    cx, cy = (jnp.floor(v / cell).astype(jnp.int32) % cells for v in (x, y))
    total = cells * cells
    env = jnp.arange(envs, dtype=jnp.int32)[None]
    rank = jnp.where(present, cx * cells + cy, total)
    order = jnp.argsort(rank, axis=0).astype(jnp.int32)
    count = jnp.zeros((total + 1, envs), jnp.int32).at[rank, jnp.broadcast_to(env, rank.shape)].add(1)
    start = jnp.cumsum(count, axis=0) - count
    step = jnp.arange(-1, 2, dtype=jnp.int32)
    around = (cx[None, None, :agents] + step[:, None, None, None]) % cells * cells
    around = (around + (cy[None, None, :agents] + step[None, :, None, None]) % cells).reshape(9, agents, envs)
    first, there = start[around, env[None]], count[around, env[None]]
    lane = jnp.arange(depth, dtype=jnp.int32)[:, None, None, None]
    row = order[jnp.minimum(first[None] + lane, bodies - 1), env[None, None]].reshape(depth * 9, agents, envs)
    seen = (lane < there[None]).reshape(depth * 9, agents, envs)
    seen &= row != jnp.arange(agents, dtype=jnp.int32)[None, :, None]
    dx, dy = x[row, env[None]] - x[None, :agents], y[row, env[None]] - y[None, :agents]
    gap = jnp.sqrt(dx * dx + dy * dy) - size[row, env[None]]
    keys = jnp.where(seen, _sortable(gap, row, bits), _NEVER)
    index, valid = _smallest(keys, min(number, bodies - 1), bits)
    return Neighbours(index, valid, jnp.sum(jnp.maximum(there - depth, 0), axis=0))
