"""Room to drive in, to the centimetre: how far it is from anywhere in a scene to what stands there, and to the edge of
the ground a robot may be on.

In:   a `SceneBank`.
Out:  `Room`, two signed distance fields of each scene.
When: once per bank, on the host; for those who may know the scene, such as `evaluation.planner`.

`surroundings` tells critics and rewards about the same in cells of 0.2 m; a robot that shall pass where 10 cm are left
needs it finer, with signs, and up to the corners of the hulls instead of those of their boxes.
"""

import dataclasses
from collections.abc import Sequence

import numpy as np
from scipy import ndimage
from scipy.spatial import ConvexHull, QhullError

from ...crowds import free_space
from ...datatypes import SceneBank, traversable

#: m, side of a cell: that of a compiled scene's map.
CELL = 0.05
#: m, distances are not told beyond this.
FAR = 1.0
#: m, what rises less above the ground is no obstacle: hulls that lie in the pavement, such as lids.
LOW = 0.005
#: m, least step of the ground that counts from one cell of `free_space.CELL` to the next: the lowest kerb (4 cm); a
#: ramp of 1:3 does not.
STEP = 0.035


@dataclasses.dataclass(frozen=True)
class Room:
    """Distances (m) at the centres of cells of `CELL`, at most `FAR`.

    Attributes:
      origin: (Z, 2) m, lower corner of each scene's cells.
      to_hull: (Z, X, Y) f16 m on the ground plane to the nearest hull's outline, negative inside.
      to_edge: (Z, X, Y) f16 m to the nearest ground that is not walkable or has a step, negative there.
    """

    origin: np.ndarray
    to_hull: np.ndarray
    to_edge: np.ndarray


def build_room(bank: SceneBank, scenes: Sequence[int], height: float) -> Room:
    """The room of some scenes of a bank; the rows of all others stay 0.

    Args:
      height: m, of the robot: what hangs higher above the ground is no obstacle.
    """
    cells = round(float(bank.map_resolution) / CELL)
    shape = (bank.map_kind.shape[1] * cells, bank.map_kind.shape[2] * cells)
    to_hull, to_edge = (np.zeros((bank.num_scenes, *shape), np.float16) for _ in range(2))
    origin = np.asarray(bank.map_origin, np.float64)
    for scene in scenes:
        ground = _finer(free_space.ground_height(bank, scene), round(free_space.CELL / CELL), shape)
        to_hull[scene] = _to_hull(bank, scene, origin[scene], ground, height)
        to_edge[scene] = _to_edge(np.kron(bank.map_kind[scene], np.ones((cells, cells), np.uint8)), ground)
    return Room(origin, to_hull, to_edge)


def _finer(coarse: np.ndarray, times: int, shape: tuple[int, int]) -> np.ndarray:
    """Every cell as `times` x `times` ones, the last ones repeated where the map goes on."""
    fine = np.kron(coarse, np.ones((times, times)))[: shape[0], : shape[1]]
    missing = [(0, n - m) for n, m in zip(shape, fine.shape, strict=True)]
    return np.pad(fine, missing, mode="edge")


def _to_hull(bank: SceneBank, scene: int, origin: np.ndarray, ground: np.ndarray, height: float) -> np.ndarray:
    distance = np.full(ground.shape, FAR, np.float32)
    for q in np.flatnonzero(bank.inst_hull[scene] >= 0):
        hull = bank.inst_hull[scene, q]
        corners = bank.hull_vertices[hull, : bank.hull_num_vertices[hull]].astype(np.float64)
        corners = corners @ bank.inst_rotation[scene, q].T.astype(np.float64) + bank.inst_position[scene, q]
        i, j = np.clip(((corners[:, :2].mean(0) - origin) / CELL).astype(int), 0, np.array(ground.shape) - 1)
        if corners[:, 2].min() - ground[i, j] > height or corners[:, 2].max() - ground[i, j] < LOW:
            continue
        first = np.clip(np.floor((corners[:, :2].min(0) - FAR - origin) / CELL).astype(int), 0, ground.shape)
        last = np.clip(np.ceil((corners[:, :2].max(0) + FAR - origin) / CELL).astype(int), 0, ground.shape)
        part = slice(first[0], last[0]), slice(first[1], last[1])
        x, y = (origin[k] + (np.arange(first[k], last[k]) + 0.5) * CELL for k in (0, 1))
        np.minimum(distance[part], to_outline(_outline(corners[:, :2]), x, y), out=distance[part])
    return distance


def _outline(points: np.ndarray) -> np.ndarray:
    """(n, 2) corners of the convex outline of points, counter-clockwise; of their box where they lie on a line."""
    try:
        return points[ConvexHull(points).vertices]
    except QhullError:
        (x0, y0), (x1, y1) = points.min(0) - 1e-3, points.max(0) + 1e-3
        return np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])


def to_outline(ring: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """(X, Y) f32 m, signed distance of the points of a grid to a convex ring (n, 2), counter-clockwise."""
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


def _to_edge(kind: np.ndarray, ground: np.ndarray) -> np.ndarray:
    walkable = traversable(kind)
    for axis in (0, 1):
        step = np.abs(np.diff(ground, axis=axis)) > STEP
        step &= np.take(walkable, range(1, walkable.shape[axis]), axis) & np.take(
            walkable, range(walkable.shape[axis] - 1), axis
        )
        walkable &= ~np.insert(step, step.shape[axis], False, axis) & ~np.insert(step, 0, False, axis)
    padded = np.pad(walkable, 1)
    inside = ndimage.distance_transform_edt(padded)[1:-1, 1:-1] * CELL - CELL / 2
    outside = ndimage.distance_transform_edt(~padded)[1:-1, 1:-1] * CELL - CELL / 2
    return np.clip(np.where(walkable, inside, -outside), -FAR, FAR)
