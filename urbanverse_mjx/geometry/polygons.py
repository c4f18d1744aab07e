"""Polygons on the ground plane, for modules that build scenes. Requires shapely and scikit-image."""

import numpy as np
import shapely
from shapely import affinity
from skimage.draw import polygon

from .grids import Grid

#: Two regions of ground overlap if they share more than this area (m²); rounding of corners alone causes smaller
#: overlaps along long edges.
MAX_OVERLAP = 1e-3


def rectangle(along: float, across: float, yaw: float, x: float, y: float, ahead: float = 0.0) -> shapely.Polygon:
    """Returns a box seen from above, counter-clockwise from the right corner of its front.

    Args:
      along, across: m, its sides along and across its heading.
      yaw: rad.
      x, y: m, the centre of rotation.
      ahead: m, distance of the box's middle in front of that centre.
    """
    flat = shapely.box(ahead - along / 2, -across / 2, ahead + along / 2, across / 2)
    return affinity.translate(affinity.rotate(flat, yaw, origin=(0.0, 0.0), use_radians=True), x, y)


def filled(grid: Grid, ring: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Returns the cells (i, j) whose centres lie in a ring (n, 2) m."""
    cells = (ring - grid.origin) / grid.side - 0.5
    return polygon(cells[:, 0], cells[:, 1], grid.shape)


def grown_outline(points: np.ndarray, reach: float) -> np.ndarray:
    """Returns the (m, 2) corners of the convex outline of points (n, 2), grown by `reach` m."""
    return np.array(shapely.MultiPoint(points).convex_hull.buffer(reach, quad_segs=2).exterior.coords[:-1])
