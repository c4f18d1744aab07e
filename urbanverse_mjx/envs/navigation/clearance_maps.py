"""Clearance maps: distances from any point of a scene to obstacles and to the edge of the traversable ground, accurate
to about a centimetre.

In:   a `SceneBank`. Out:  `ClearanceMaps`: signed distance fields and heights. When: once per bank, on the host;
for privileged code such as `evaluation.planner`.

`surroundings` has such distances for critics and rewards in cells of 0.2 m. A planner that passes obstacles with a
clearance of 10 cm needs this finer grid with signed distances to the hulls instead of to their boxes.
"""

import concurrent.futures
import dataclasses
import functools
from collections.abc import Iterator, Sequence

import numpy as np
from scipy import ndimage

from ...crowds import free_space
from ...datatypes import SceneBank, traversable
from ...geometry.grids import Grid
from ...geometry.raster import Shape, nearest, outline, to_outline
from ...settings import num_threads

#: m, side of a cell, the same as in a compiled scene's map.
CELL = 0.05
#: m, largest stored distance.
MAX_DISTANCE = 1.0
#: m; hulls that rise less above the ground, such as manhole covers, are no obstacles.
MIN_OBSTACLE_HEIGHT = 0.005
#: m, least step between cells that counts as an edge: less than the lowest kerb (4 cm), more than the lips of up to
#: 2 cm at the ends of fitted dropped kerbs (1:8) in cells of `CELL`; in cells twice as wide these would count.
MIN_EDGE_STEP = 0.035


@dataclasses.dataclass(frozen=True)
class ClearanceMaps:
    """Distances (m) at the centres of cells of `CELL`, at most `MAX_DISTANCE`.

    Attributes:
      origin: (Z, 2) m, lower corner of each scene's cells.
      to_hull: (Z, X, Y) f16 m on the ground plane to the nearest hull's outline, negative inside.
      to_edge: (Z, X, Y) f16 m to the nearest ground that is not walkable or has a step, negative there.
      ground: (Z, X, Y) f32 m, height of the ground; 0 behind the last walkable cells.
    """

    origin: np.ndarray
    to_hull: np.ndarray
    to_edge: np.ndarray
    ground: np.ndarray


def build_clearance_maps(bank: SceneBank, scenes: Sequence[int], height: float) -> ClearanceMaps:
    """Computes the clearance maps of some scenes of a bank; rows of other scenes are 0.

    Args:
      height: m, height of the robot; higher hulls are no obstacles.
    """
    cells = round(float(bank.map_resolution) / CELL)
    shape = (bank.map_kind.shape[1] * cells, bank.map_kind.shape[2] * cells)
    to_hull, to_edge = (np.zeros((bank.num_scenes, *shape), np.float16) for _ in range(2))
    heights = np.zeros((bank.num_scenes, *shape), np.float32)
    origin = np.asarray(bank.map_origin, np.float64)

    def fill(scene: int) -> None:
        grid = Grid(origin[scene], CELL, shape)
        ground = free_space.ground_height(bank, scene, grid)
        to_hull[scene] = nearest(grid, _outlines(bank, scene, grid, ground, height), MAX_DISTANCE)
        walkable = np.kron(traversable(bank.map_kind[scene]), np.ones((cells, cells), bool))
        to_edge[scene] = -MAX_DISTANCE
        near = _up_to_its_ground(walkable)
        to_edge[scene][near] = _to_edge(walkable[near], ground[near])
        heights[scene][near] = ground[near]

    # Most of it are distance transforms and large arrays, which let other threads go on. A scene of 200 m takes 1 GB.
    with concurrent.futures.ThreadPoolExecutor(min(num_threads(), 8)) as pool:
        list(pool.map(fill, scenes))
    return ClearanceMaps(origin, to_hull, to_edge, heights)


def _outlines(bank: SceneBank, scene: int, grid: Grid, ground: np.ndarray, height: float) -> Iterator[Shape]:
    """The outlines of the hulls that a robot of that height cannot pass under or over."""
    for corners in bank.standing_hulls(scene):
        floor = ground[tuple(grid.cell(corners[:, :2].mean(0)))]
        if corners[:, 2].min() - floor > height or corners[:, 2].max() - floor < MIN_OBSTACLE_HEIGHT:
            continue
        flat = corners[:, :2]
        yield flat.min(0), flat.max(0), functools.partial(to_outline, outline(flat))


def _up_to_its_ground(walkable: np.ndarray) -> tuple[slice, slice]:
    """The cells (X, Y) up to `MAX_DISTANCE` behind the last walkable ones: a bank's maps are padded to the largest."""
    margin = round(MAX_DISTANCE / CELL) + 1
    x, y = (int(np.flatnonzero(walkable.any(1 - axis)).max(initial=0)) + 1 + margin for axis in (0, 1))
    return slice(x), slice(y)


def _to_edge(walkable: np.ndarray, ground: np.ndarray) -> np.ndarray:
    """(X, Y) m from each cell to the nearest that is not walkable or has a step, negative there. The outside
    is not walkable."""
    walkable = walkable.copy()
    for axis in (0, 1):
        step = np.abs(np.diff(ground, axis=axis)) > MIN_EDGE_STEP
        step &= np.take(walkable, range(1, walkable.shape[axis]), axis) & np.take(
            walkable, range(walkable.shape[axis] - 1), axis
        )
        walkable &= ~np.insert(step, step.shape[axis], False, axis) & ~np.insert(step, 0, False, axis)
    padded = np.pad(walkable, 1)
    inside = ndimage.distance_transform_edt(padded)[1:-1, 1:-1] * CELL - CELL / 2
    outside = ndimage.distance_transform_edt(~padded)[1:-1, 1:-1] * CELL - CELL / 2
    return np.clip(np.where(walkable, inside, -outside), -MAX_DISTANCE, MAX_DISTANCE)
