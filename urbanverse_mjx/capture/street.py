"""Grid of a bank's scene seen from above: kind and height of the ground, and distance to the nearest solid object."""

import dataclasses

import numpy as np
import scipy.ndimage

from ..datatypes import KIND_INDEX, SceneBank, traversable
from ..geometry import rotations
from ..geometry.grids import Grid
from ..geometry.polygons import filled
from ..geometry.raster import outline

CELL = 0.2  # m: a path is smoothed afterwards, and streets of 200 m stay under 200,000 cells
#: m above the ground; an object between these heights blocks a person with a camera.
_MIN_OBSTACLE_HEIGHT, _MAX_OBSTACLE_HEIGHT = 0.3, 2.0
GROUND_PREFIX = "ground:"


@dataclasses.dataclass(frozen=True)
class StreetGrid:
    """A street as a grid; cell (i, j) covers origin + [i, i + 1) x [j, j + 1) cells of `CELL` m.

    kind (X, Y) u8: `ground.GROUND_KINDS`, 0 = no ground. height (X, Y) f32: m, top of the ground, NaN where there is
    none. clearance (X, Y) f32: m to the nearest solid object or end of the walkable ground, 0 inside.
    """

    origin: np.ndarray
    kind: np.ndarray
    height: np.ndarray
    clearance: np.ndarray

    @property
    def grid(self) -> Grid:
        """The street's cells."""
        x, y = self.kind.shape
        return Grid(self.origin, CELL, (x, y))

    def cell(self, points: np.ndarray) -> np.ndarray:
        """(..., 2) i64, cells of points (..., 2) m, clipped to the grid."""
        return self.grid.cell(points)

    def middle(self, cells: np.ndarray) -> np.ndarray:
        """(..., 2) m, centres of cells."""
        return self.grid.centres(cells)


def slot_vertices(bank: SceneBank, scene: int, slot: int) -> np.ndarray:
    """(n, 3) f64 m: corners of a visual slot's mesh in the world."""
    mesh = bank.slot_mesh[scene, slot]
    corners = bank.mesh_vertices[bank.mesh_vertex_start[mesh] : bank.mesh_vertex_start[mesh + 1]]
    rotation = rotations.matrix_f64(bank.slot_quaternion[scene, slot])
    return corners.astype(np.float64) @ rotation.T + bank.slot_position[scene, slot]


def ground_tops(bank: SceneBank, scene: int) -> list[tuple[int, int, np.ndarray]]:
    """(slot, kind, (t, 3, 3) m triangles that face up) of every ground region."""
    tops = []
    for slot in np.flatnonzero(bank.slot_mesh[scene] >= 0):
        category = bank.meta["categories"][bank.slot_category[scene, slot]]
        if not category.startswith(GROUND_PREFIX):
            continue
        mesh = bank.slot_mesh[scene, slot]
        faces = bank.mesh_faces[bank.mesh_face_start[mesh] : bank.mesh_face_start[mesh + 1]]
        triangles = slot_vertices(bank, scene, int(slot))[faces]
        normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        up = normal[:, 2] > 0.4 * np.linalg.norm(normal, axis=1)  # tops are at most 63° steep, sides upright
        tops.append((int(slot), KIND_INDEX[category.removeprefix(GROUND_PREFIX)], triangles[up]))
    return tops


def _draw_heights(tops: list[tuple[int, int, np.ndarray]], grid: Grid) -> np.ndarray:
    height = np.full(grid.shape, np.nan, np.float32)
    for _, _, triangles in tops:
        for triangle in triangles:
            rows, columns = filled(grid, triangle[:, :2])
            if not len(rows):
                continue
            corners = (triangle[:, :2] - grid.origin) / CELL - 0.5
            plane = np.linalg.solve(np.c_[corners, np.ones(3)], triangle[:, 2])
            height[rows, columns] = np.fmax(height[rows, columns], plane[0] * rows + plane[1] * columns + plane[2])
    return height


def _draw_solids(bank: SceneBank, scene: int, street: "StreetGrid") -> np.ndarray:
    """(X, Y) bool, cells that a hull covers at a pedestrian's height."""
    solid = np.zeros(street.kind.shape, bool)
    floor = np.nan_to_num(street.height, nan=0.0)
    for world in bank.standing_hulls(scene):
        i, j = street.cell(world[:, :2].mean(0))
        if (
            world[:, 2].min() > floor[i, j] + _MAX_OBSTACLE_HEIGHT
            or world[:, 2].max() < floor[i, j] + _MIN_OBSTACLE_HEIGHT
        ):
            continue
        solid[filled(street.grid, outline(world[:, :2]))] = True
    return solid


def street_grid(bank: SceneBank, scene: int) -> StreetGrid:
    """Computes the grid of one scene."""
    stride = max(1, round(CELL / float(bank.map_resolution)))
    kind = bank.map_kind[scene][stride // 2 :: stride, stride // 2 :: stride]
    origin = bank.map_origin[scene].astype(np.float64)
    used = np.argwhere(kind > 0)
    kind = kind[: used[:, 0].max() + 1, : used[:, 1].max() + 1].copy()
    none = np.zeros(kind.shape, np.float32)
    street = StreetGrid(origin, kind, none, none)
    height = _draw_heights(ground_tops(bank, scene), street.grid)
    street = dataclasses.replace(street, height=height)
    free = traversable(kind) & ~_draw_solids(bank, scene, street) & np.isfinite(height)
    clearance = scipy.ndimage.distance_transform_edt(np.pad(free, 1))[1:-1, 1:-1] * CELL
    return dataclasses.replace(street, clearance=clearance.astype(np.float32))
