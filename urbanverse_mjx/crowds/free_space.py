"""Where road users may be: what a scene's ground and hulls leave free for each surface.

In:   a `SceneBank`.
Out:  `FreeSpace`, a boolean map of one scene and surface.
When: once per scene, on the host.
"""

import dataclasses

import numpy as np
from scipy import ndimage
from scipy.spatial import ConvexHull

from ..datatypes import GROUND_KINDS, SceneBank
from ..datatypes import validation as v
from .kinds import SURFACES

#: m, side of a cell: two cells of the scene's map.
CELL = 0.1
#: m above the ground: what hangs higher is walked under (the hulls of tree crowns reach down to 1.64 m), what is
#: lower is walked over.
HEADROOM, KICKED = 1.6, 0.05


@dataclasses.dataclass(frozen=True)
class FreeSpace:
    """One scene as one surface's users see it.

    Attributes:
      origin: (2,) m, lower corner. free: (X, Y) bool over cells of `CELL`: allowed ground and nothing in the way.
      kind: (X, Y) u8, kind of ground at the cell's lower corner.
    """

    origin: np.ndarray
    free: np.ndarray
    kind: np.ndarray

    def centres(self, cells: np.ndarray) -> np.ndarray:
        """(n, 2) m of cells (n, 2)."""
        return self.origin + (np.asarray(cells) + 0.5) * CELL

    def distance(self) -> np.ndarray:
        """(X, Y) m from a cell's centre to the nearest cell that is not free; 0 in those."""
        return np.maximum(ndimage.distance_transform_edt(self.free) * CELL - CELL / 2, 0.0).astype(np.float32)


def free_spaces(bank: SceneBank, scene: int) -> dict[str, FreeSpace]:
    """The free space of every surface in `SURFACES`.

    Raises:
      NounError: no such scene, or a map whose resolution does not divide `CELL`.
    """
    if not 0 <= scene < bank.num_scenes:
        raise v.fail("free space", f"scene {scene}", f"one of 0 to {bank.num_scenes - 1}")
    pool = round(CELL / float(bank.map_resolution))
    if pool < 1 or abs(pool * float(bank.map_resolution) - CELL) > 1e-6:
        raise v.fail("free space", f"a map of {float(bank.map_resolution):g} m", f"one whose cells divide {CELL:g} m")
    kind = bank.map_kind[scene]
    shape = (kind.shape[0] // pool, kind.shape[1] // pool)
    blocks = kind[: shape[0] * pool, : shape[1] * pool].reshape(shape[0], pool, shape[1], pool)
    origin = np.asarray(bank.map_origin[scene], np.float64)
    blocked = _blocked(bank, scene, origin, shape)
    spaces = {}
    for name, kinds in SURFACES.items():
        allowed = np.array([k in kinds for k in GROUND_KINDS])[blocks].all(axis=(1, 3))
        spaces[name] = FreeSpace(origin, allowed & ~blocked, blocks[:, 0, :, 0])
    return spaces


def _corners(bank: SceneBank, hull: int, position: np.ndarray, rotation: np.ndarray) -> np.ndarray:
    """(n, 3) m, corners in the world."""
    local = bank.hull_vertices[hull, : bank.hull_num_vertices[hull]].astype(np.float64)
    return local @ np.asarray(rotation, np.float64).T + position


def _touched(corners: np.ndarray, origin: np.ndarray, shape: tuple[int, int]) -> tuple[np.ndarray, np.ndarray] | None:
    """Cells that the outline of points (n, 3) seen from above touches; None where there are none."""
    low = np.clip(np.floor((corners[:, :2].min(0) - origin) / CELL).astype(int), 0, shape)
    high = np.clip(np.floor((corners[:, :2].max(0) - origin) / CELL).astype(int) + 1, 0, shape)
    if (high <= low).any():
        return None
    i, j = np.meshgrid(np.arange(low[0], high[0]), np.arange(low[1], high[1]), indexing="ij")
    centres = origin + (np.stack([i, j], -1) + 0.5) * CELL
    try:
        edges = ConvexHull(corners[:, :2]).equations
    except Exception:  # qhull's error for points on a line: what touches its box is enough
        return i.ravel(), j.ravel()
    # A square touches a convex outline where no edge of either parts them; its own edges are the box above.
    reach = CELL / 2 * np.abs(edges[:, :2]).sum(1)
    inside = (centres @ edges[:, :2].T + edges[:, 2] <= reach).all(-1)
    return i[inside], j[inside]


def ground_height(bank: SceneBank, scene: int) -> np.ndarray:
    """(X, Y) m, height of the ground in cells of `CELL` from the map's origin on; that of the nearest where none is."""
    pool = round(CELL / float(bank.map_resolution))
    shape = (bank.map_kind.shape[1] // pool, bank.map_kind.shape[2] // pool)
    height = _ground(bank, scene, np.asarray(bank.map_origin[scene], np.float64), shape)
    missing = np.isnan(height)
    if missing.all():
        return np.zeros(shape)
    i, j = ndimage.distance_transform_edt(missing, return_distances=False, return_indices=True)
    return height[i, j]


def _ground(bank: SceneBank, scene: int, origin: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """(X, Y) m, height of the prisms' tops; NaN where there is none."""
    height = np.full(shape, np.nan)
    for hull, position in zip(bank.prism_hull[scene], bank.prism_position[scene], strict=True):
        if hull < 0:
            continue
        cells = _touched(_corners(bank, hull, position, np.eye(3)), origin, shape)
        if cells is None:
            continue
        planes = bank.hull_planes[hull]
        normal, offset = planes[planes[:, 2].argmax(), :3], planes[planes[:, 2].argmax(), 3]
        at = origin + (np.stack(cells, -1) + 0.5) * CELL - position[:2]
        top = (offset - at @ normal[:2]) / normal[2] + position[2]
        height[cells] = np.fmax(height[cells], top)
    return height


def _blocked(bank: SceneBank, scene: int, origin: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """(X, Y) bool, a hull stands or hangs in the way."""
    ground, blocked = _ground(bank, scene, origin, shape), np.zeros(shape, bool)
    rows = zip(bank.inst_hull[scene], bank.inst_position[scene], bank.inst_rotation[scene], strict=True)
    for hull, position, rotation in rows:
        if hull < 0:
            continue
        corners = _corners(bank, hull, position, rotation)
        cells = _touched(corners, origin, shape)
        if cells is None:
            continue
        low, high = corners[:, 2].min() - ground[cells], corners[:, 2].max() - ground[cells]
        blocked[cells] |= (low < HEADROOM) & (high > KICKED)
    return blocked
