"""Polygons on the ground plane: where they are drawn. For what makes scenes: it needs shapely and scikit-image."""

import numpy as np
import shapely
from skimage.draw import polygon

from .grids import Grid


def filled(grid: Grid, ring: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Cells (i, j) whose centres lie in a ring (n, 2) m."""
    cells = (ring - grid.origin) / grid.side - 0.5
    return polygon(cells[:, 0], cells[:, 1], grid.shape)


def grown_outline(points: np.ndarray, reach: float) -> np.ndarray:
    """(m, 2) corners of the convex outline of points (n, 2), `reach` m farther out."""
    return np.array(shapely.MultiPoint(points).convex_hull.buffer(reach, quad_segs=2).exterior.coords[:-1])
