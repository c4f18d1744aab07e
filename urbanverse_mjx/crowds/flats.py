"""Static obstacles for avoidance: the free space around every position as a few half-planes ("flats").

In:   `FreeSpace` of each scene.
Out:  `Flats`, a table on the device; `walls_at` looks it up.
When: the table once per scene; the look-up every crowd step, inside jit.

For the centre of every coarse cell, the nearest blocked point defines the first flat: the plane through it,
perpendicular to the line from the centre. Points behind that flat are removed; the nearest remaining point defines the
second flat, and so on. The published library processes obstacles in this order and skips those that earlier lines
cover; here this is precomputed, and the result is a convex part of the free space around the cell. A look-up is one
gather of `NUM_FLATS` pairs of bytes.
"""

import concurrent.futures
import contextlib
from collections.abc import Sequence
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from .. import settings
from . import half_planes
from .free_space import CELL, FreeSpace
from .linear_program import HalfPlanes

#: Number of flats per cell; a passage between a wall, a post and a kerb needs three or four.
NUM_FLATS = 6
#: Cells of the free space along a coarse cell.
POOL = 2
#: m, search distance of flats by surface: speed times wall horizon plus body for pedestrians; shorter for cars, whose
#: route fields keep them away from static obstacles.
REACH = {"foot": 3.0, "road": 6.0}
#: m, unit of the stored distances; 255 units mean no flat.
UNIT = 0.025
#: m, largest protrusion from a flat, due to the steps of oblique walls in the grid.
_MAX_PROTRUSION = 0.05
_DIRECTIONS = 256
#: Number of cells per batch.
_CHUNK = 8192


class Flats(NamedTuple):
    """Flats of one surface in all scenes, padded to the largest.

    Attributes:
      table: (Z, X, Y, 2 M) u8: M directions in units of 2π/256, then M distances from the cell's centre in `UNIT`.
      origin: (Z, 2) f32 m.
    """

    table: Any
    origin: Any


def _directions() -> np.ndarray:
    """(256, 2) unit vectors."""
    angle = 2.0 * np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
    return np.stack([np.cos(angle), np.sin(angle)], -1)


def _offsets(reach: float) -> np.ndarray:
    """(n, 2) offsets in cells from a coarse cell's centre to the fine cells around it, nearest first."""
    half = int(np.ceil(reach / CELL))
    i, j = np.meshgrid(np.arange(-half, half), np.arange(-half, half), indexing="ij")
    cells = np.stack([i.ravel(), j.ravel()], -1)
    distance = np.linalg.norm(cells + 0.5, axis=1)
    order = np.lexsort((cells[:, 1], cells[:, 0], distance))
    return cells[order][distance[order] * CELL <= reach]


@jax.jit
def _peel(blocked: Any, corner: Any, offsets: Any) -> tuple[Any, Any]:
    """Directions (M, C) i32 and distances (M, C) m of the flats around corners (C, 2) of the fine grid."""
    count = corner.shape[0]
    unit = jnp.asarray(_directions(), jnp.float32)

    def inspect(n: Any, carry: tuple[Any, ...]) -> tuple[Any, ...]:
        direction, mx, my, behind, used = carry
        cell = corner + offsets[n]
        inside = (cell >= 0).all(-1) & (cell < jnp.array(blocked.shape)).all(-1)
        cell = jnp.clip(cell, 0, jnp.array(blocked.shape) - 1)
        stands = ~inside | blocked[cell[:, 0], cell[:, 1]]
        q = (offsets[n] + 0.5) * CELL
        covered = (mx * q[0] + my * q[1] >= behind - _MAX_PROTRUSION).any(0)
        new = stands & ~covered & (used < NUM_FLATS)
        code = jnp.round(jnp.arctan2(q[1], q[0]) * (_DIRECTIONS / (2.0 * jnp.pi))).astype(jnp.int32) % _DIRECTIONS
        slot = new & (jnp.arange(NUM_FLATS)[:, None] == used)
        ux, uy = unit[code, 0], unit[code, 1]
        direction = jnp.where(slot, code, direction)
        mx, my = jnp.where(slot, ux, mx), jnp.where(slot, uy, my)
        behind = jnp.where(slot, ux * q[0] + uy * q[1], behind)
        return direction, mx, my, behind, used + new

    zeros = jnp.zeros((NUM_FLATS, count))
    start = (zeros.astype(jnp.int32), zeros, zeros, zeros + 1e6, jnp.zeros(count, jnp.int32))
    direction, mx, my, behind, _ = jax.lax.fori_loop(0, offsets.shape[0], inspect, start)
    # The flat passes through the nearest side of the blocked cell.
    return direction, behind - 0.5 * CELL * (jnp.abs(mx) + jnp.abs(my))


def _on_host() -> contextlib.AbstractContextManager[Any]:
    """Puts arrays and programs on the CPU; changes nothing where JAX may not use it, as with `JAX_PLATFORMS=cuda`."""
    try:
        return jax.default_device(jax.local_devices(backend="cpu")[0])
    except RuntimeError:
        return contextlib.nullcontext()


def flats_of(space: FreeSpace, reach: float) -> np.ndarray:
    """(X, Y, 2 M) u8, the table of one scene; cells that are not free at their centre have no flat."""
    shape = tuple(n // POOL for n in space.free.shape)
    table = np.full((*shape, 2 * NUM_FLATS), 255, np.uint8)
    # The centre of a coarse cell is a corner of fine cells, all of which must be free.
    crowded = ~space.free[: shape[0] * POOL, : shape[1] * POOL]
    free = ~crowded.reshape(shape[0], POOL, shape[1], POOL).any((1, 3))
    cells = np.argwhere(free)
    # On the host: the loop has a turn for each of thousands of offsets, each of which a GPU would launch by itself.
    with _on_host():
        offsets, blocked = jnp.asarray(_offsets(reach)), jnp.asarray(~space.free)
        for start in range(0, len(cells), _CHUNK):
            part = cells[start : start + _CHUNK]
            padded = np.pad(part, ((0, _CHUNK - len(part)), (0, 0)), mode="edge")
            found = _peel(blocked, jnp.asarray(padded * POOL + POOL // 2), offsets)
            direction, distance = (np.asarray(a).T for a in found)
            units = np.clip(np.floor(np.maximum(distance, 0.0) / UNIT), 0, 255)
            row = np.concatenate([direction, units], axis=1).astype(np.uint8)
            table[part[:, 0], part[:, 1]] = row[: len(part)]
    return table


def make_flats(spaces: Sequence[FreeSpace], reach: float) -> Flats:
    """The table of one surface in several scenes."""
    with concurrent.futures.ThreadPoolExecutor(settings.num_threads()) as pool:
        tables = list(pool.map(lambda space: flats_of(space, reach), spaces))
    size = np.max([t.shape[:2] for t in tables], axis=0)
    padded = [
        np.pad(t, ((0, size[0] - t.shape[0]), (0, size[1] - t.shape[1]), (0, 0)), constant_values=255) for t in tables
    ]
    origin = np.stack([space.origin for space in spaces]).astype(np.float32)
    return Flats(jnp.asarray(np.stack(padded)), jnp.asarray(origin))


def walls_at(flats: Flats, scene: Any, x: Any, y: Any, radius: Any, horizon: Any) -> HalfPlanes:
    """Permitted velocities (M, A) of discs in one env's scene; there are no walls outside the map.

    Args:
      scene: () i32.
      x, y: (A,) m, centres.
      radius: (A,) m.
      horizon: (A,) s.
    """
    side = POOL * CELL
    origin = flats.origin[scene]
    u, w = (x - origin[0]) / side, (y - origin[1]) / side
    i, j = jnp.floor(u).astype(jnp.int32), jnp.floor(w).astype(jnp.int32)
    columns, rows = flats.table.shape[1:3]
    inside = (i >= 0) & (i < columns) & (j >= 0) & (j < rows)
    row = flats.table[scene, jnp.clip(i, 0, columns - 1), jnp.clip(j, 0, rows - 1)].T.astype(jnp.float32)
    direction, units = row[:NUM_FLATS] * (2.0 * jnp.pi / _DIRECTIONS), row[NUM_FLATS:]
    mx, my = jnp.cos(direction), jnp.sin(direction)
    from_centre = mx * ((u - i - 0.5) * side) + my * ((w - j - 0.5) * side)
    space = jnp.where(inside & (units < 255.0), units * UNIT - from_centre, jnp.inf)
    return half_planes.towards_walls((mx, my), space, radius, horizon)
