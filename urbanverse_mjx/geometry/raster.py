"""Rasterises convex shapes on a ground grid, with the caller's cell sizes and cut-offs."""

from collections.abc import Callable, Iterable

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from .grids import Grid

#: Lower and upper corner (2,) m of a shape's footprint, and a function that returns the distances (X, Y) m from it to
#: points x (X,), y (Y,).
Shape = tuple[np.ndarray, np.ndarray, Callable[[np.ndarray, np.ndarray], np.ndarray]]


def outline(points: np.ndarray) -> np.ndarray:
    """Returns the (n, 2) corners of the convex outline of points (m, 2), counter-clockwise, or of their box if they lie
    on a line."""
    try:
        return points[ConvexHull(points).vertices]
    except QhullError:
        (x0, y0), (x1, y1) = points.min(0) - 1e-3, points.max(0) + 1e-3
        return np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])


def touched(grid: Grid, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Returns the cells (i, j) that the convex outline of points (n, 2) m touches."""
    i, j = np.mgrid[grid.window(points.min(0), points.max(0))]
    try:
        edges = ConvexHull(points).equations
    except QhullError:  # on a line: the cells that touch its box suffice
        return i.ravel(), j.ravel()
    # A square touches a convex outline if no edge of either separates them; the box above covers the square's edges.
    reach = grid.side / 2 * np.abs(edges[:, :2]).sum(1)
    inside = (grid.centres(np.stack([i, j], -1)) @ edges[:, :2].T + edges[:, 2] <= reach).all(-1)
    return i[inside], j[inside]


def nearest(grid: Grid, shapes: Iterable[Shape], far: float) -> np.ndarray:
    """Returns (X, Y) f32 m from each cell's centre to the nearest shape, at most `far`."""
    distance = np.full(grid.shape, far, np.float32)
    for low, high, distance_to in shapes:
        part = grid.window(low - far, high + far)
        np.minimum(distance[part], distance_to(*grid.axes(part)), out=distance[part])
    return distance


def to_outline(ring: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Returns the signed distance (X, Y) f32 m of the points of a grid x (X,), y (Y,) to a counter-clockwise convex
    ring (n, 2), negative inside."""
    x, y = x[:, None].astype(np.float32), y[None, :].astype(np.float32)
    square = np.full((x.size, y.size), np.inf, np.float32)
    beyond = np.full(square.shape, -np.inf, np.float32)
    for a, b in zip(ring.astype(np.float32), np.roll(ring, -1, 0).astype(np.float32), strict=True):
        along = b - a
        length = max(float(np.hypot(*along)), 1e-9)
        ux, uy = along / np.float32(length)
        t = np.clip((x - a[0]) * ux + (y - a[1]) * uy, 0.0, np.float32(length))
        square = np.minimum(square, (x - a[0] - t * ux) ** 2 + (y - a[1] - t * uy) ** 2)
        beyond = np.maximum(beyond, (x - a[0]) * uy - (y - a[1]) * ux)
    return np.where(beyond > 0.0, np.sqrt(square), beyond)
