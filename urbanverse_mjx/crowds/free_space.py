"""Free space of road users: allowed ground without obstacles, for each surface of a scene.

In:   a `SceneBank`.
Out:  `FreeSpace`, a boolean map of one scene and surface.
When: once per scene, on the host.
"""

import dataclasses

import numpy as np
from scipy import ndimage

from ..datatypes import GROUND_KINDS, SceneBank
from ..datatypes import validation as v
from ..geometry.grids import Grid, pooled
from ..geometry.raster import touched
from .kinds import SURFACES

#: m, side of a cell: two cells of the scene's map.
CELL = 0.1
#: m above the ground; people walk under higher hulls (those of tree crowns reach down to 1.64 m) and over lower ones.
HEADROOM, STEP_OVER_HEIGHT = 1.6, 0.05


@dataclasses.dataclass(frozen=True)
class FreeSpace:
    """The free space of one scene for one surface.

    Attributes:
      origin: (2,) m, lower corner.
      free: (X, Y) bool over cells of `CELL`: allowed ground without an obstacle.
      kind: (X, Y) u8, kind of ground at the cell's lower corner.
    """

    origin: np.ndarray
    free: np.ndarray
    kind: np.ndarray

    def centres(self, cells: np.ndarray) -> np.ndarray:
        """(n, 2) m of cells (n, 2)."""
        return Grid(self.origin, CELL, self.free.shape).centres(cells)

    def distance(self) -> np.ndarray:
        """(X, Y) m from a cell's centre to the nearest cell that is not free; 0 in occupied cells."""
        return np.maximum(ndimage.distance_transform_edt(self.free) * CELL - CELL / 2, 0.0).astype(np.float32)


def free_spaces(bank: SceneBank, scene: int) -> dict[str, FreeSpace]:
    """The free space of every surface in `SURFACES`.

    Raises:
      ValidationError: the scene does not exist, or the map's resolution does not divide `CELL`.
    """
    if not 0 <= scene < bank.num_scenes:
        raise v.fail("free space", f"scene {scene}", f"one of 0 to {bank.num_scenes - 1}")
    pool = round(CELL / float(bank.map_resolution))
    if pool < 1 or abs(pool * float(bank.map_resolution) - CELL) > 1e-6:
        raise v.fail("free space", f"a map of {float(bank.map_resolution):g} m", f"one whose cells divide {CELL:g} m")
    grid = _grid(bank, scene)
    kind, blocked = bank.map_kind[scene], _blocked(bank, scene, grid)
    (x, y), spaces = grid.shape, {}
    for name, kinds in SURFACES.items():
        allowed = pooled(np.array([k in kinds for k in GROUND_KINDS])[kind], pool, np.all)
        spaces[name] = FreeSpace(grid.origin, allowed & ~blocked, kind[::pool, ::pool][:x, :y])
    return spaces


def ground_height(bank: SceneBank, scene: int, grid: Grid | None = None) -> np.ndarray:
    """(X, Y) m, height of the ground in the cells of a grid; that of the nearest ground in cells without.

    Args:
      grid: default: cells of `CELL` from the map's origin.
    """
    height = _ground(bank, scene, grid or _grid(bank, scene))
    missing = np.isnan(height)
    if missing.all():
        return np.zeros(height.shape)
    i, j = ndimage.distance_transform_edt(missing, return_distances=False, return_indices=True)
    return height[i, j]


def _grid(bank: SceneBank, scene: int) -> Grid:
    pool = round(CELL / float(bank.map_resolution))
    _, x, y = bank.map_kind.shape
    return Grid(np.asarray(bank.map_origin[scene], np.float64), CELL, (x // pool, y // pool))


def _ground(bank: SceneBank, scene: int, grid: Grid) -> np.ndarray:
    """(X, Y) m, height of the prisms' tops; NaN without ground."""
    height = np.full(grid.shape, np.nan)
    for hull, position in zip(bank.prism_hull[scene], bank.prism_position[scene], strict=True):
        if hull < 0:
            continue
        corners = bank.hull_vertices[hull, : bank.hull_num_vertices[hull], :2].astype(np.float64)
        cells = touched(grid, corners + position[:2])
        planes = bank.hull_planes[hull]
        normal, offset = planes[planes[:, 2].argmax(), :3], planes[planes[:, 2].argmax(), 3]
        at = grid.centres(np.stack(cells, -1)) - position[:2]
        top = (offset - at @ normal[:2]) / normal[2] + position[2]
        height[cells] = np.fmax(height[cells], top)
    return height


def _blocked(bank: SceneBank, scene: int, grid: Grid) -> np.ndarray:
    """(X, Y) bool, whether a hull is in the cell below head height."""
    ground, blocked = _ground(bank, scene, grid), np.zeros(grid.shape, bool)
    for corners in bank.standing_hulls(scene):
        cells = touched(grid, corners[:, :2])
        low, high = corners[:, 2].min() - ground[cells], corners[:, 2].max() - ground[cells]
        blocked[cells] |= (low < HEADROOM) & (high > STEP_OVER_HEIGHT)
    return blocked
