"""How far collision hulls stand out of a mesh where a robot can touch them, by rays from outside.

The mesh is cut at `HEIGHTS`. In each cut, horizontal rays come from `DIRECTIONS` directions, `SPACING` apart. Where a
ray reaches a hull before the mesh, the distance of that point from the mesh's surface (in space, not along the ray) is
the overshoot. It counts where a robot could be without the hull: an upright cylinder of `ROBOT_RADIUS` comes there from
outside without touching the mesh at this height or below. So hulls may close a gap between slats, or a window above its
sill, but no doorway.
"""

import dataclasses
from collections.abc import Sequence

import numpy as np
from scipy.ndimage import distance_transform_edt, label
from scipy.spatial import ConvexHull, QhullError

#: m, of the cuts; odd numbers, because edges of meshes lie at even ones.
HEIGHTS = (0.0533, 0.1471, 0.3117, 0.5231, 0.7133, 0.9171, 1.1837)
DIRECTIONS = 16
#: m between rays; at most `MOST_RAYS` a direction.
SPACING, MOST_RAYS = 0.05, 150
#: m, half the width of the narrowest robot shipped (the Go2).
ROBOT_RADIUS = 0.155
#: m, overshoot that is allowed, and cells of the maps on which the disc moves.
LIMIT, CELL = 0.05, 0.02
#: Points of a cut whose distance in space is computed, at least half of this number where there are more.
MOST_POINTS = 200
#: Largest number of cells along a side of such a map; cells are larger for longer objects.
MOST_CELLS = 700


@dataclasses.dataclass(frozen=True)
class Overshoot:
    """Overshoot of a shape's hulls.

    Attributes:
      rays: number of rays that reach a hull not later than the mesh.
      over: how many of these overshoot by more than `LIMIT` where a robot can touch.
      worst: m, largest overshoot where a robot can touch.
      place: (3,) m, where that is.
    """

    rays: int
    over: int
    worst: float
    place: tuple[float, float, float]


def overshoot(
    vertices: np.ndarray, faces: np.ndarray, hulls: Sequence[np.ndarray], heights: Sequence[float] = HEIGHTS
) -> Overshoot:
    """Measures the overshoot of hulls over a mesh.

    Args:
      vertices: (n, 3) m.
      faces: (m, 3) indices.
      hulls: corners (k, 3) m of each convex hull.
      heights: m, of the horizontal cuts.
    """
    triangles = np.asarray(vertices, float)[faces]
    rays, over, worst, place = 0, 0, 0.0, (0.0, 0.0, 0.0)
    below = np.zeros((0, 2, 2))
    for height in sorted(heights):
        segments = mesh_cut(triangles, height)
        below = np.concatenate([below, segments])
        polygons = [p for p in (_hull_cut(np.asarray(h, float), height) for h in hulls) if p is not None]
        if not polygons:
            continue
        points = _first_points(polygons, segments)
        rays += len(points)
        if not len(points):
            continue
        gap = _gap_in_plane(points, segments)
        far = np.flatnonzero(gap > LIMIT)
        if len(far):
            far = far[_touchable(points[far], below)]
        part = max(1, len(far) // MOST_POINTS)
        far = far[np.argsort(-gap[far], kind="stable")[::part]]
        # The surface above or below may be nearer than the cut.
        low, high = triangles[..., 2].min(1), triangles[..., 2].max(1)
        near = triangles[(low < height + gap[far].max(initial=0)) & (high > height - gap[far].max(initial=0))]
        distances = np.array([min(gap[k], _distance(np.array([*points[k], height]), near)) for k in far])
        over += part * int((distances > LIMIT).sum())
        close = gap <= LIMIT
        for candidates, values in ((np.flatnonzero(close), gap[close]), (far, distances)):
            if len(values) and values.max() > worst:
                k = candidates[values.argmax()]
                worst, place = float(values.max()), (float(points[k, 0]), float(points[k, 1]), height)
    return Overshoot(rays, over, worst, place)


def mesh_cut(triangles: np.ndarray, height: float) -> np.ndarray:
    """(n, 2, 2) m: the segments in which triangles (m, 3, 3) meet a horizontal plane."""
    above = triangles[..., 2] > height
    cut = triangles[(above.any(1)) & (~above.all(1))]
    if not len(cut):
        return np.zeros((0, 2, 2))
    above = cut[..., 2] > height
    lone = np.where(above.sum(1) == 1, above.argmax(1), (~above).argmax(1))  # the corner alone on its side
    rows = np.arange(len(cut))
    a = cut[rows, lone]
    ends = []
    for k in (1, 2):
        b = cut[rows, (lone + k) % 3]
        t = (height - a[:, 2]) / (b[:, 2] - a[:, 2])
        ends.append(a[:, :2] + t[:, None] * (b[:, :2] - a[:, :2]))
    return np.stack(ends, 1)


def _hull_cut(corners: np.ndarray, height: float) -> np.ndarray | None:
    """(n, 3) half planes a x + b y + c <= 0 of a hull's cut; None if the plane misses it."""
    if not corners[:, 2].min() < height < corners[:, 2].max():
        return None
    low, high = corners[corners[:, 2] < height], corners[corners[:, 2] >= height]
    t = (height - low[:, None, 2]) / (high[None, :, 2] - low[:, None, 2])
    points = (low[:, None, :2] + t[..., None] * (high[None, :, :2] - low[:, None, :2])).reshape(-1, 2)
    try:
        return ConvexHull(points).equations
    except QhullError:
        return None


def _first_points(polygons: Sequence[np.ndarray], segments: np.ndarray) -> np.ndarray:
    """(n, 2) m, where rays from outside reach a polygon not later than any segment."""
    found = []
    corners = np.concatenate([_corners(p) for p in polygons])
    middle, reach = (corners.min(0) + corners.max(0)) / 2, np.linalg.norm(np.ptp(corners, axis=0)) / 2 + 0.1
    if len(segments):
        reach = max(reach, float(np.linalg.norm(segments - middle, axis=-1).max()) + 0.1)
    for angle in np.arange(DIRECTIONS) * 2 * np.pi / DIRECTIONS + 0.013:
        along = np.array([np.cos(angle), np.sin(angle)])
        aside = np.array([-along[1], along[0]])
        extent = np.abs((corners - middle) @ aside).max()
        count = int(np.clip(2 * extent / SPACING, 8, MOST_RAYS))
        offset = (np.arange(count) + 0.5) / count * 2 * extent - extent
        starts = middle - reach * along + offset[:, None] * aside
        met = np.min([_enter(p, starts, along) for p in polygons], 0)
        seen = _meet(segments, starts, along, aside)
        hit = np.isfinite(met) & (met <= seen + 1e-3)
        found.append(starts[hit] + met[hit, None] * along)
    return np.concatenate(found)


def _corners(planes: np.ndarray) -> np.ndarray:
    """Corners of a polygon from its half planes in order of their angle."""
    p = planes[np.argsort(np.arctan2(planes[:, 1], planes[:, 0]))]
    q = np.roll(p, -1, 0)
    det = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
    keep = np.abs(det) > 1e-12
    p, q, det = p[keep], q[keep], det[keep]
    x = (p[:, 1] * q[:, 2] - q[:, 1] * p[:, 2]) / det
    y = (q[:, 0] * p[:, 2] - p[:, 0] * q[:, 2]) / det
    return np.stack([x, y], 1)


def _enter(planes: np.ndarray, starts: np.ndarray, along: np.ndarray) -> np.ndarray:
    """(n,) m along rays to a polygon; infinite where they miss it."""
    speed = planes[:, :2] @ along
    value = starts @ planes[:, :2].T + planes[:, 2]
    still = np.abs(speed) < 1e-12
    with np.errstate(divide="ignore", invalid="ignore"):
        t = -value / speed
    first = np.where(speed < 0, t, -np.inf)[:, ~still].max(1, initial=-np.inf)
    last = np.where(speed > 0, t, np.inf)[:, ~still].min(1, initial=np.inf)
    missed = (value[:, still] > 0).any(1) | (first > last)
    return np.where(missed, np.inf, first)


def _meet(segments: np.ndarray, starts: np.ndarray, along: np.ndarray, aside: np.ndarray) -> np.ndarray:
    """(n,) m along rays to the first segment; infinite where they miss all."""
    seen = np.full(len(starts), np.inf)
    if not len(segments):
        return seen
    far, side = segments @ along, segments @ aside
    at, begin = starts @ aside, starts @ along
    low, high = side.min(1), side.max(1)
    for first in range(0, len(segments), 2000):
        part = slice(first, first + 2000)
        width = np.where(np.abs(side[part, 1] - side[part, 0]) < 1e-9, 1.0, side[part, 1] - side[part, 0])
        t = (at[:, None] - side[None, part, 0]) / width
        distance = far[None, part, 0] + np.clip(t, 0, 1) * (far[part, 1] - far[part, 0]) - begin[:, None]
        inside = (at[:, None] >= low[part] - 1e-6) & (at[:, None] <= high[part] + 1e-6)
        seen = np.minimum(seen, np.where(inside, distance, np.inf).min(1))
    return seen


def _gap_in_plane(points: np.ndarray, segments: np.ndarray) -> np.ndarray:
    """(n,) m from points to the nearest segment; infinite without any."""
    gap = np.full(len(points), np.inf)
    if not len(segments):
        return gap
    a, ab = segments[:, 0], segments[:, 1] - segments[:, 0]
    length = np.maximum((ab**2).sum(1), 1e-18)
    for first in range(0, len(points), 500):
        p = points[first : first + 500, None]
        t = np.clip(((p - a) * ab).sum(-1) / length, 0, 1)
        gap[first : first + 500] = np.sqrt(((p - a - t[..., None] * ab) ** 2).sum(-1).min(1))
    return gap


def _touchable(points: np.ndarray, segments: np.ndarray) -> np.ndarray:
    """(n,) bool: whether a disc comes from outside to `LIMIT` beyond these points without touching the segments."""
    if not len(segments):
        return np.ones(len(points), bool)
    everything = np.concatenate([segments.reshape(-1, 2), points])
    margin = 3 * ROBOT_RADIUS
    low, high = everything.min(0) - margin, everything.max(0) + margin
    cell = max(CELL, float((high - low).max()) / MOST_CELLS)
    shape = (np.ceil((high - low) / cell).astype(int) + 1).tolist()
    reached = disc_reach(raster(segments, low, cell, shape), cell) <= ROBOT_RADIUS - LIMIT + cell / 2
    index = np.round((points - low) / cell).astype(int)
    return reached[index[:, 0], index[:, 1]]


def raster(segments: np.ndarray, low: np.ndarray, cell: float, shape: Sequence[int]) -> np.ndarray:
    """Map of the cells that segments (n, 2, 2) m pass; `low` is the middle of the first cell, `cell` their side (m)."""
    solid = np.zeros(tuple(shape), bool)
    a, b = segments[:, 0], segments[:, 1]
    count = np.ceil(np.sqrt(((b - a) ** 2).sum(1)) / (cell / 2)).astype(int) + 2
    which = np.repeat(np.arange(len(a)), count)
    t = (np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count)) / (count[which] - 1)
    index = np.round((a[which] + t[:, None] * (b - a)[which] - low) / cell).astype(int)
    solid[index[:, 0], index[:, 1]] = True
    return solid


def disc_reach(solid: np.ndarray, cell: float, radius: float = ROBOT_RADIUS) -> np.ndarray:
    """m from each cell to the nearest middle of a disc that comes there from outside.

    Args:
      solid: map of what the disc may not touch; its first cell is outside.
      cell: m, side of a cell.
      radius: m, of the disc.
    """
    parts, _ = label(distance_transform_edt(~solid) * cell >= radius)
    return distance_transform_edt(parts != parts[0, 0]) * cell


def _distance(point: np.ndarray, triangles: np.ndarray) -> float:
    """m from a point to the nearest triangle."""
    corner = np.sqrt(((triangles - point) ** 2).sum(-1).min())
    apart = np.maximum(triangles.min(1) - point, point - triangles.max(1))
    near = triangles[(apart <= corner).all(1)]
    a, ab, ac = near[:, 0], near[:, 1] - near[:, 0], near[:, 2] - near[:, 0]
    normal = np.cross(ab, ac)
    area = np.maximum((normal**2).sum(1), 1e-18)
    ap = point - a
    # Barycentric coordinates of the foot of the perpendicular.
    v = (np.cross(ap, ac) * normal).sum(1) / area
    w = (np.cross(ab, ap) * normal).sum(1) / area
    inside = (v >= 0) & (w >= 0) & (v + w <= 1)
    perpendicular = np.abs((ap * normal).sum(1)) / np.sqrt(area)
    best = np.where(inside, perpendicular, np.inf).min(initial=np.inf)
    for k in range(3):
        start, edge = near[:, k], near[:, (k + 1) % 3] - near[:, k]
        t = np.clip(((point - start) * edge).sum(1) / np.maximum((edge**2).sum(1), 1e-18), 0, 1)
        best = min(best, float(np.linalg.norm(point - start - t[:, None] * edge, axis=1).min()))
    return float(best)
