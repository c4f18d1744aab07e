"""The 5 cm map of a scene: ground height, kind and free height."""

from collections.abc import Sequence

import numpy as np
from skimage.draw import polygon as fill

from ..datatypes.ground import PAINT_KINDS
from .geometry import SceneMap
from .ground import Region, kind_index, plane_height

RESOLUTION = 0.05
#: Clearance of a cell with nothing above it, and the height (m) from which on nothing counts (navbench's format).
FREE, CEILING = 9.99, 6.4
#: Ground-free cells around the regions, m.
_MARGIN = 0.5


def raster(ring: np.ndarray, origin: np.ndarray, shape: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Numbers (i, j) of the cells whose centres lie in a ring (n, 2)."""
    cells = (ring - origin) / RESOLUTION - 0.5
    return fill(cells[:, 0], cells[:, 1], shape)


def ground_map(regions: Sequence[Region]) -> SceneMap:
    """Height and kind of the ground; nothing stands on it yet."""
    rings = [np.asarray(r.polygon) for r in regions]
    low, high = np.min([r.min(0) for r in rings], 0), np.max([r.max(0) for r in rings], 0)
    origin = np.floor((low - _MARGIN) / RESOLUTION) * RESOLUTION
    shape = tuple(int(n) for n in np.ceil((high + _MARGIN - origin) / RESOLUTION))
    height, kind = np.full(shape, np.nan, np.float32), np.zeros(shape, np.uint8)
    for paint in (False, True):
        for region, ring in zip(regions, rings, strict=True):
            if (region.kind in PAINT_KINDS) != paint:
                continue
            i, j = raster(ring, origin, shape)
            if paint:
                on_ground = kind[i, j] > 0
                i, j = i[on_ground], j[on_ground]
            else:
                centres = origin + (np.stack([i, j], -1) + 0.5) * RESOLUTION
                height[i, j] = plane_height(region.plane, centres)
            kind[i, j] = kind_index(region)
    return SceneMap(origin, RESOLUTION, height, kind, np.full(shape, np.float32(FREE)))
