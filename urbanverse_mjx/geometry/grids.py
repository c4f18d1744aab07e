"""Square cells on the ground plane: cell (i, j) covers origin + [i, i + 1) x [j, j + 1) sides."""

import dataclasses
import math
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy import ndimage


def cell_of(points: Any, origin: Any, side: float, shape: tuple[int, ...] | None = None) -> Any:
    """Returns the indices of the cells that contain points, for numpy or JAX arrays.

    Args:
      points: (..., 2) m, or (...) m along one axis.
      origin: (2,) or () m.
      side: m.
      shape: (X, Y) cells; if given, points outside get the nearest cell.
    """
    xp = points.__array_namespace__()
    cell = xp.floor((points - origin) / side).astype(int)
    return cell if shape is None else xp.clip(cell, 0, xp.asarray(shape) - 1)


@dataclasses.dataclass(frozen=True)
class Grid:
    """The cells of one scene, in host memory.

    Attributes:
      origin: (2,) m, lower corner.
      side: m, of a cell.
      shape: (X, Y) cells.
    """

    origin: np.ndarray
    side: float
    shape: tuple[int, int]

    def cell(self, points: np.ndarray) -> np.ndarray:
        """Returns (..., 2) cells of points (..., 2) m; points outside get the nearest cell."""
        return cell_of(np.asarray(points), self.origin, self.side, self.shape)

    def at(self, values: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Returns the values (...) of the cells (X, Y) that contain points (..., 2) m; outside, of the nearest cell."""
        cells = self.cell(points)
        return values[cells[..., 0], cells[..., 1]]

    def centres(self, cells: np.ndarray) -> np.ndarray:
        """Returns the centres (..., 2) m of cells (..., 2)."""
        return self.origin + (np.asarray(cells) + 0.5) * self.side

    def window(self, low: np.ndarray, high: np.ndarray) -> tuple[slice, slice]:
        """Returns the cells of the grid that a rectangle from `low` to `high` (2,) m touches."""
        (i, j), (m, n) = self.windows(low, high)
        return slice(i, m), slice(j, n)

    def windows(self, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Returns the first cells (..., 2) that rectangles from `low` to `high` (..., 2) m touch, and the cells behind
        their last ones."""
        first, last = (np.floor((corner - self.origin) / self.side).astype(int) for corner in (low, high))
        return np.clip(first, 0, self.shape), np.clip(last + 1, 0, self.shape)

    def along(self, axis: int, cells: np.ndarray) -> np.ndarray:
        """Returns where the centres of cells with these indices are along an axis, m, in the origin's precision."""
        return self.origin[axis] + (cells.astype(self.origin.dtype) + 0.5) * self.side

    def axes(self, window: tuple[slice, slice]) -> tuple[np.ndarray, np.ndarray]:
        """Returns x (n,) and y (m,) m of the cells' centres in a window, in the origin's precision."""
        x, y = (self.along(axis, np.arange(part.start, part.stop)) for axis, part in enumerate(window))
        return x, y


def pooled(cells: np.ndarray, side: int, reduce: Callable[..., np.ndarray]) -> np.ndarray:
    """Returns (X // side, Y // side) values: blocks of side x side cells reduced by `reduce(blocks, axis=...)`;
    incomplete blocks at the upper edges are left out."""
    x, y = (n // side for n in cells.shape)
    blocks = cells[: x * side, : y * side].reshape(x, side, y, side)
    if reduce is np.mean:  # its rounding depends on the order
        return reduce(blocks, axis=(1, 3))
    # One axis after the other, both along contiguous cells, is some twenty times faster.
    return reduce(np.ascontiguousarray(np.moveaxis(reduce(blocks, axis=1), -1, 0)), axis=0)


def closed(mask: np.ndarray, reach: float, side: float) -> np.ndarray:
    """Returns a mask (X, Y) of cells of `side` m after a morphological closing, which fills gaps of up to twice `reach`
    (m)."""
    if not mask.any():
        return mask
    pad = math.ceil(reach / side) + 1
    i, j = np.nonzero(mask)
    window = np.s_[max(0, i.min() - pad) : i.max() + pad + 1, max(0, j.min() - pad) : j.max() + pad + 1]
    near = ndimage.distance_transform_edt(~mask[window]) * side <= reach
    near = np.pad(near, 1)  # beyond the window no cell is near
    filled = mask.copy()
    filled[window] |= (ndimage.distance_transform_edt(near) * side > reach)[1:-1, 1:-1]
    return filled
