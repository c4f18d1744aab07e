"""Computes the 5 cm map of a scene: height and kind of the ground, free height, and height of objects."""

import dataclasses
from collections.abc import Iterator, Sequence

import numpy as np

from ..datatypes.ground import PAINT_KINDS
from ..geometry.grids import Grid
from ..geometry.polygons import filled, grown_outline
from .geometry import SceneMap
from .ground import Region, kind_index, plane_height

RESOLUTION = 0.05
#: m, clearance of a cell without a hull above it, and height above which hulls are ignored (navbench's format).
FREE_CLEARANCE, CEILING_HEIGHT = 9.99, 6.4
#: m, width of the margin without ground around the regions.
_MAP_MARGIN = 0.5


def ground_map(regions: Sequence[Region]) -> SceneMap:
    """Computes the map of the ground without objects."""
    rings = [np.asarray(r.polygon) for r in regions]
    low, high = np.min([r.min(0) for r in rings], 0), np.max([r.max(0) for r in rings], 0)
    origin = np.floor((low - _MAP_MARGIN) / RESOLUTION) * RESOLUTION
    width, depth = (int(n) for n in np.ceil((high + _MAP_MARGIN - origin) / RESOLUTION))
    shape = (width, depth)
    grid = Grid(origin, RESOLUTION, shape)
    height, kind = np.full(shape, np.nan, np.float32), np.zeros(shape, np.uint8)
    for paint in (False, True):
        for region, ring in zip(regions, rings, strict=True):
            if (region.kind in PAINT_KINDS) != paint:
                continue
            i, j = filled(grid, ring)
            if paint:
                on_ground = kind[i, j] > 0
                i, j = i[on_ground], j[on_ground]
            else:
                height[i, j] = plane_height(region.plane, grid.centres(np.stack([i, j], -1)))
            kind[i, j] = kind_index(region)
    return SceneMap(origin, RESOLUTION, height, kind, np.full(shape, np.float32(FREE_CLEARANCE)))


def with_clearance(
    scene_map: SceneMap, hulls: Sequence[np.ndarray], rotations: np.ndarray, positions: np.ndarray
) -> SceneMap:
    """Adds the free height below the hulls (n, 3) at T_world_hull to a map.

    The height of a hull is that of its lowest corner, for every cell that its footprint touches.
    """
    clearance = scene_map.clearance.copy()
    for i, j, low, high in _footprints(scene_map, hulls, rotations, positions):
        ground = scene_map.height[i, j]
        above = np.where(high > ground, np.maximum(low - ground, 0.0), FREE_CLEARANCE)
        above = np.where(above < CEILING_HEIGHT, above, FREE_CLEARANCE)
        clearance[i, j] = np.fmin(clearance[i, j], above)
    return dataclasses.replace(scene_map, clearance=clearance)


def tops(scene_map: SceneMap, hulls: Sequence[np.ndarray], rotations: np.ndarray, positions: np.ndarray) -> np.ndarray:
    """(X, Y) float32 m: height of the highest object in each cell, ground included, NaN without ground.

    The height of a hull is that of its highest corner.
    """
    top = scene_map.height.copy()
    for i, j, _, high in _footprints(scene_map, hulls, rotations, positions):
        top[i, j] = np.fmax(top[i, j], np.float32(high))
    return top


def _footprints(
    scene_map: SceneMap, hulls: Sequence[np.ndarray], rotations: np.ndarray, positions: np.ndarray
) -> Iterator[tuple[np.ndarray, np.ndarray, float, float]]:
    """Yields for each hull (n, 3) at T_world_hull the cells (i, j) of its footprint and its lowest and highest z, m."""
    for corners, rotation, position in zip(hulls, rotations, positions, strict=True):
        world = corners @ rotation.T + position
        i, j = filled(scene_map.grid, grown_outline(world[:, :2], RESOLUTION * np.sqrt(0.5)))
        yield i, j, world[:, 2].min(), world[:, 2].max()
