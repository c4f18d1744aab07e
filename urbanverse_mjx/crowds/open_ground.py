"""Bit maps of free cells, used by `resolve_collisions` and by environments.

In:   `FreeSpace` of each scene, or their maps.
Out:  `OpenGround`, a table on the device; `is_open` looks it up.
When: the table once per scene; the look-up every step, inside jit.

Flats (`flats`) represent only a convex part of the free space; this is the complete map with one bit per cell. A table
that a jitted function closes over becomes part of its program, and with one byte per 5 cm cell, 160 streets of 200 m
would be too large for the compiler.
"""

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np

from ..geometry.grids import cell_of
from .free_space import CELL, FreeSpace


class OpenGround(NamedTuple):
    """Free cells of one surface in all scenes, padded to the largest.

    Attributes:
      table: (Z, X, Y / 8) u8, eight cells along y in a byte, the first in its lowest bit.
      origin: (Z, 2) f32 m.
    """

    table: Any
    origin: Any


def pack(free: Iterable[np.ndarray], origin: np.ndarray) -> OpenGround:
    """Packs the (X, Y) bool free cells of each scene, whose lower corners are (Z, 2) m."""
    # Scenes are packed one by one, because 200 unpacked streets need gigabytes.
    bits = np.stack([np.packbits(cells, axis=-1, bitorder="little") for cells in free])
    return OpenGround(jnp.asarray(bits), jnp.asarray(origin, jnp.float32))


def make_open_ground(spaces: Sequence[FreeSpace]) -> OpenGround:
    """The table of one surface in several scenes."""
    size = np.max([space.free.shape for space in spaces], axis=0)
    padded = (np.pad(s.free, [(0, n - m) for n, m in zip(size, s.free.shape, strict=True)]) for s in spaces)
    return pack(padded, np.stack([space.origin for space in spaces]))


def is_open(ground: OpenGround, scene: Any, x: Any, y: Any, cell: float = CELL) -> Any:
    """(...) bool, whether points (...) m of a scene () i32 lie in free cells of `cell` m; False outside the map."""
    origin = ground.origin[scene]
    i = cell_of(x, origin[0], cell)
    j = cell_of(y, origin[1], cell)
    columns, rows = ground.table.shape[1], 8 * ground.table.shape[2]
    inside = (i >= 0) & (i < columns) & (j >= 0) & (j < rows)
    byte = ground.table[scene, jnp.clip(i, 0, columns - 1), jnp.clip(j // 8, 0, rows // 8 - 1)].astype(jnp.int32)
    return inside & ((byte >> (j & 7)) & 1).astype(bool)
