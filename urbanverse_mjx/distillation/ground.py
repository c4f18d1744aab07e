"""The ground on a grid from above: points of each kind, planes through their heights, steps between kinds."""

import dataclasses
from collections.abc import Sequence

import cv2
import numpy as np
import scipy.ndimage
import shapely
from shapely.geometry.base import BaseGeometry

from ..datatypes import GROUND_KINDS, KIND_INDEX, GroundRegion
from ..geometry.grids import cell_of
from .lifting import GroundPoints
from .straight_pieces import FitOptions

CELL = 0.25  # m: kerb stones are 12 to 30 cm wide


@dataclasses.dataclass(frozen=True)
class GroundOptions:
    """Options for converting ground cells to regions and kerbs.

    Chosen manually; `benchmarks.fidelity` measures their effect (docs/decisions/generation.md).

    Attributes:
      fill_distance: m, largest extension of ground under objects that hide it.
      min_area: m^2; smaller regions are removed as wrong votes, or merged into the neighbour that surrounds them.
      max_plane_error: m; a region whose top deviates more from its plane is split across its longer side.
      max_corners: a region with more corners is split in two.
      min_kerb: m; lower steps do not count as kerbs.
      fit: options for straightening borders.
    """

    fill_distance: float = 2.5
    min_area: float = 3.0
    max_plane_error: float = 0.05
    max_corners: int = 200
    min_kerb: float = 0.03
    fit: FitOptions = dataclasses.field(default_factory=FitOptions)


OPTIONS = GroundOptions()
#: Kinds of ground beside the carriageway, and those of the carriageway.
WALKED, DRIVEN = ("sidewalk", "ground"), ("road", "crosswalk")


@dataclasses.dataclass(frozen=True)
class GroundMap:
    """The observed ground as a grid seen from above; cell (i, j) covers origin + [i, i + 1) x [j, j + 1) cells of
    `CELL` m.

    kind (X, Y) u8, 0 = nothing known; height (X, Y) f64 m, NaN where nothing was seen; count (X, Y) i64 points.
    """

    origin: np.ndarray
    kind: np.ndarray
    height: np.ndarray
    count: np.ndarray

    def at(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Kind (...) u8 and height (...) m under points (..., 2) m; 0 and NaN outside."""
        cells = cell_of(points, self.origin, CELL)
        inside = ((cells >= 0) & (cells < self.kind.shape)).all(-1)
        i, j = np.where(inside[..., None], cells, 0).swapaxes(0, -1) if cells.ndim == 2 else cells
        return np.where(inside, self.kind[i, j], 0).astype(np.uint8), np.where(inside, self.height[i, j], np.nan)


@dataclasses.dataclass(frozen=True)
class Kerb:
    """A step between two adjacent kinds of ground: its median height (m) and the observed length (m)."""

    low: str
    high: str
    height: float
    length: float


def ground_map(ground: GroundPoints, poses: np.ndarray, scale: np.ndarray, noise: float) -> GroundMap | None:
    """Computes the grid; None if no ground was seen.

    The weight of a point is 1 / sigma^2 with sigma = `noise` x range, because distant ground is seen at a grazing
    angle.
    """
    if not len(ground.frame):
        return None
    rotation, shift = poses[ground.frame, :3, :3], poses[ground.frame, :3, 3]
    arms = np.einsum("gij,gj->gi", rotation, ground.points) * scale[ground.frame, None]
    world = arms + shift
    weight = 1.0 / (0.05 + noise * np.linalg.norm(arms, axis=1)) ** 2
    origin = np.floor(world[:, :2].min(0) / CELL) * CELL
    cells = cell_of(world[:, :2], origin, CELL)
    shape = (int(cells[:, 0].max()) + 1, int(cells[:, 1].max()) + 1)
    flat = cells[:, 0] * shape[1] + cells[:, 1]
    votes = np.stack(
        [
            np.bincount(flat, weight * (ground.kind == k), shape[0] * shape[1]).reshape(shape)
            for k in range(len(GROUND_KINDS))
        ]
    )
    # Votes are smoothed over neighbouring cells, so that a single outlier has no effect.
    votes = np.stack([scipy.ndimage.gaussian_filter(v, 0.7) for v in votes])
    kind = np.where(votes.max(0) > 1e-6, votes.argmax(0), 0).astype(np.uint8)
    own = ground.kind == kind.ravel()[flat]
    total = np.bincount(flat, weight * own, shape[0] * shape[1])
    height = np.bincount(flat, weight * own * world[:, 2], shape[0] * shape[1]) / np.where(total > 0, total, np.nan)
    count = np.bincount(flat, minlength=shape[0] * shape[1])
    return _filled(GroundMap(origin, kind, height.reshape(shape), count.reshape(shape)))


def _filled(seen: GroundMap) -> GroundMap:
    """Assigns the kind and height of the nearest observed ground to holes, to ground under objects and to outliers."""
    kind = _majority(np.where(np.isfinite(seen.height), seen.kind, 0))
    # The height of a cell that its neighbours outvoted belongs to the wrong kind.
    known = (kind > 0) & (kind == seen.kind) & _large(kind)
    distance, nearest = scipy.ndimage.distance_transform_edt(~known, return_indices=True)
    # Morphological closing: gaps between observed ground are filled, the outer border does not move.
    reach, rim = OPTIONS.fill_distance / CELL, int(OPTIONS.fill_distance / CELL) + 2
    grown = np.pad(distance <= reach, rim)
    closed = (scipy.ndimage.distance_transform_edt(grown) > reach)[rim:-rim, rim:-rim]
    use = known | closed
    kind = np.where(use, seen.kind[tuple(nearest)], 0)
    kind = np.where(_large(kind), kind, 0)
    height = np.where(kind > 0, seen.height[tuple(nearest)], np.nan)
    return GroundMap(seen.origin, kind.astype(np.uint8), height, np.where(known, seen.count, 0))


def _majority(kind: np.ndarray) -> np.ndarray:
    """Assigns each cell the most frequent kind of the 5 x 5 cells around it, which smooths outlines."""
    masks = [(kind == k).astype(np.float32) for k in range(len(GROUND_KINDS))]
    votes = np.stack([scipy.ndimage.uniform_filter(m, 5) for m in masks])
    votes[0] *= kind == 0
    return np.where(kind > 0, votes.argmax(0), 0).astype(np.uint8)


def _large(kind: np.ndarray) -> np.ndarray:
    """(X, Y) bool: cells that belong to a connected area of one kind of at least `min_area`."""
    large = np.zeros(kind.shape, bool)
    for k in np.unique(kind[kind > 0]):
        _, numbers, boxes, _ = cv2.connectedComponentsWithStats((kind == k).astype(np.uint8), connectivity=4)
        sizes = boxes[:, cv2.CC_STAT_AREA] * CELL**2
        sizes[0] = 0.0
        large |= (sizes >= OPTIONS.min_area)[numbers]
    return large


def fit_plane(seen: GroundMap, area: shapely.Polygon, kind: int) -> tuple[tuple[float, float, float], float]:
    """Plane (a, b, c) of z = a x + b y + c under an area, by least squares with Tukey's biweight, and its robust
    residual (m); areas of fewer than 12 cells get a level plane at the height of the nearest cells of their kind."""
    x0, y0, x1, y1 = area.bounds
    i0, j0 = np.maximum(np.floor((np.array([x0, y0]) - seen.origin) / CELL).astype(int), 0)
    i1, j1 = np.ceil((np.array([x1, y1]) - seen.origin) / CELL).astype(int)
    i, j = np.meshgrid(np.arange(i0, min(i1, seen.kind.shape[0])), np.arange(j0, min(j1, seen.kind.shape[1])))
    xy = seen.origin + (np.stack([i.ravel(), j.ravel()], -1) + 0.5) * CELL
    z = seen.height[i.ravel(), j.ravel()]
    good = np.isfinite(z) & (seen.kind[i.ravel(), j.ravel()] == kind) & shapely.contains_xy(area, *xy.T)
    xy, z = xy[good], z[good]
    if len(z) < 12:
        return (0.0, 0.0, round(_level(seen, area, kind), 4)), 0.0
    middle = xy.mean(0)
    columns = np.c_[xy - middle, np.ones(len(z))]
    weight, plane, spread = np.ones(len(z)), np.zeros(3), 0.0
    for _ in range(8):
        # A small ridge term, because a strip one cell wide does not determine its cross slope.
        normal = columns.T @ (weight[:, None] * columns) + np.diag([1e-2, 1e-2, 0.0])
        plane = np.linalg.solve(normal, columns.T @ (weight * z))
        residual = z - columns @ plane
        spread = max(1.4826 * float(np.median(np.abs(residual))), 0.003)
        weight = np.clip(1.0 - (residual / (4.685 * spread)) ** 2, 1e-6, None) ** 2
    a, b = (float(np.clip(p, -1.0, 1.0)) for p in plane[:2])
    return (round(a, 6), round(b, 6), round(float(plane[2] - a * middle[0] - b * middle[1]), 4)), spread


def _level(seen: GroundMap, area: shapely.Polygon, kind: int) -> float:
    """m, median height of the 12 cells of a kind that are nearest to an area's centre."""
    cells = np.argwhere((seen.kind == kind) & np.isfinite(seen.height))
    middle = area.representative_point()
    away = np.linalg.norm(seen.origin + (cells + 0.5) * CELL - [middle.x, middle.y], axis=1)
    nearest = cells[np.argsort(away, kind="stable")[:12]]
    return float(np.median(seen.height[tuple(nearest.T)]))


def kerbs(seen: GroundMap) -> tuple[Kerb, ...]:
    """The steps between neighbouring cells of two kinds, for each pair of kinds."""
    found = []
    pairs: dict[tuple[int, int], list[np.ndarray]] = {}
    # Heights two cells apart are compared, because the cell on the edge mixes both.
    for axis in (0, 1):
        a, b = (np.roll(seen.kind, -s, axis) for s in (-1, 1))
        step = np.roll(seen.height, -1, axis) - np.roll(seen.height, 1, axis)
        edge = (a != b) & (a > 0) & (b > 0) & np.isfinite(step)
        for low, high, sign in ((a, b, 1.0), (b, a, -1.0)):
            for k in range(1, len(GROUND_KINDS)):
                for m in range(1, len(GROUND_KINDS)):
                    here = edge & (low == k) & (high == m) & (sign * step >= 0)
                    if k != m and here.any():
                        pairs.setdefault((k, m), []).append(sign * step[here])
    for (low, high), steps in sorted(pairs.items()):
        all_steps = np.concatenate(steps)
        height = float(np.median(all_steps))
        if height >= OPTIONS.min_kerb and len(all_steps) * CELL / 2 >= 2.0:
            length = round(len(all_steps) * CELL / 2, 1)
            found.append(Kerb(GROUND_KINDS[low], GROUND_KINDS[high], round(height, 3), length))
    return tuple(found)


def allowed_area(seen: Sequence[GroundRegion], kinds: tuple[str, ...]) -> BaseGeometry:
    """Area in which objects that stand on these kinds of ground can be."""
    wanted = {KIND_INDEX[k] for k in kinds}
    return shapely.union_all([shapely.Polygon(r.polygon) for r in seen if KIND_INDEX[r.kind] in wanted])
