"""Covers convex shapes by few spheres and measures the largest error.

The engines support only contacts between spheres and hulls, so other collision shapes of a robot are covered by
spheres. MuJoCo collides meshes as their convex hulls, so every shape here is convex. For centres c_i at depths d_i
below the surface, radii d_i leave a gap G = max over surface points p of min_i (|p - c_i| - d_i); radii d_i + G / 2
protrude from the shape by at most G / 2 and leave a gap of at most G / 2. Centres are chosen greedily (set cover) for
the smallest G within a budget.
"""

import dataclasses
import functools

import numpy as np
import trimesh
from scipy.spatial import ConvexHull, cKDTree
from scipy.spatial.distance import cdist

from ..datatypes import validation as v

#: Candidate centres and surface samples along a shape's longest side.
_CENTRES_PER_SIDE, _SAMPLES_PER_SIDE = 13, 20
#: Samples along the longest side on which the error of a finished cover is measured.
_ERROR_SAMPLES = 80
_HALVINGS = 7
#: Largest number of spheres that may replace one shape.
MOST_SPHERES = 64


@dataclasses.dataclass(frozen=True)
class FitOptions:
    """Options of the fit: tolerance, m, sufficient accuracy; spheres, largest number of spheres per shape."""

    tolerance: float = 0.02
    spheres: int = 16

    def __post_init__(self) -> None:
        v.number(self.tolerance, "fit.tolerance", above=0.0, maximum=1.0)
        v.integer(self.spheres, "fit.spheres", 1, MOST_SPHERES)


@dataclasses.dataclass(frozen=True)
class Cover:
    """Spheres in place of a shape.

    Attributes:
      centre: (k, 3) m.
      radius: (k,) m.
      protrudes: m, largest protrusion of a sphere from the shape.
      falls_short: m, largest distance of a surface point outside all spheres.
    """

    centre: np.ndarray
    radius: np.ndarray
    protrudes: float
    falls_short: float

    @property
    def error(self) -> float:
        """m, the larger of both errors."""
        return max(self.protrudes, self.falls_short)


def cover(points: np.ndarray, options: FitOptions | None = None) -> Cover:
    """Spheres that cover the convex hull of (n, 3) points in m, in its frame, whose axes should be those of the shape.

    Raises:
      ValidationError: the points enclose no volume.
    """
    points = np.ascontiguousarray(points, np.float64)
    return _cover(points.tobytes(), options or FitOptions())


@functools.lru_cache(maxsize=64)
def _cover(data: bytes, options: FitOptions) -> Cover:
    """`cover` of the bytes of (n, 3) f64, cached because a robot is built several times in a process."""
    points = np.frombuffer(data).reshape(-1, 3)
    if len(points) < 4 or np.linalg.matrix_rank(points - points.mean(0), tol=1e-6) < 3:
        raise v.fail("collision shape", "points that enclose no volume", "a solid", "give it a thickness")
    hull = ConvexHull(points)
    planes = hull.equations
    centres = _candidates(points, planes)
    depth = _depth(centres, planes)
    surface = _surface(points, hull, _SAMPLES_PER_SIDE)
    # (p, c) distance between p and a sphere about c that touches the surface from inside.
    gap = cdist(surface, centres).astype(np.float32) - depth[None].astype(np.float32)
    chosen = _chosen(gap, options)
    centre, inner = centres[chosen], depth[chosen]
    fine = _surface(points, hull, _ERROR_SAMPLES)
    uncovered = cdist(fine, centre) - inner[None]
    half = max(float(uncovered.min(1).max()), 0.0) / 2
    return Cover(centre, inner + half, half, half)


def _depth(at: np.ndarray, planes: np.ndarray) -> np.ndarray:
    """(n,) m below the surface."""
    return -(at @ planes[:, :3].T + planes[:, 3]).max(1)


def _candidates(points: np.ndarray, planes: np.ndarray) -> np.ndarray:
    """(n, 3) points inside: a grid along the axes that has a layer in the middle of thin shapes."""
    low, high = points.min(0), points.max(0)
    step = (high - low).max() / _CENTRES_PER_SIDE
    axes = []
    for a, b in zip(low, high, strict=True):
        count = max(1, round((b - a) / step)) | 1
        axes.append(a + (b - a) * (np.arange(count) + 0.5) / count)
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)
    inside = np.concatenate([grid, points.mean(0)[None]])
    return inside[_depth(inside, planes) > 1e-9]


def _surface(points: np.ndarray, hull: ConvexHull, count: int) -> np.ndarray:
    """(n, 3) points of the hull's surface, no farther apart than a `count`th of its longest side; corners included."""
    longest = np.ptp(points, axis=0).max() / count
    vertices = trimesh.remesh.subdivide_to_size(points, hull.simplices, longest, max_iter=30)[0]
    # One point per cell of half that size, because hulls of many small triangles have more points than needed.
    cell = np.round(vertices / (longest / 2)).astype(np.int64)
    _, first = np.unique(cell, axis=0, return_index=True)
    corners = points[hull.vertices]
    return np.concatenate([vertices[np.sort(first)], corners if len(corners) <= 64 else corners[:: len(corners) // 64]])


def _chosen(gap: np.ndarray, options: FitOptions) -> np.ndarray:
    """Columns of `gap` (p, c): few enough for the budget, and of that number those that leave the least gap.

    As many as the tolerance needs, or the whole budget where that is not enough. Of several sets of that number that
    are within the tolerance, the closest is chosen: one sphere for a ball is the ball.
    """
    one = np.array([int(gap.max(0).argmin())])
    low, high, most = 2 * options.tolerance, float(gap.max(0).min()), options.spheres
    best = _greedy(gap <= low, most)
    if best is None:
        best = one
    else:
        low, high, most = 0.0, low, len(best)
        if most == 1:
            return one
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        found = _greedy(gap <= middle, most)
        if found is None:
            low = middle
        else:
            best, high = found, middle
    return best


def _greedy(covers: np.ndarray, most: int) -> np.ndarray | None:
    """At most `most` columns of (p, c) bool that together cover every row; None where greedy choice needs more."""
    left, weights = np.ones(len(covers), bool), covers.astype(np.float32)
    chosen: list[int] = []
    while left.any():
        if len(chosen) == most:
            return None
        gain = left.astype(np.float32) @ weights
        best = int(gain.argmax())
        if gain[best] == 0:
            return None
        chosen.append(best)
        left &= ~covers[:, best]
    return np.array(chosen)


def wheel(points: np.ndarray, axis: np.ndarray, anchor: np.ndarray) -> Cover:
    """Spheres for a shape that rolls about an axis: centred on the axis, with the radius of the shape.

    Args:
      points: (n, 3) m of the shape.
      axis: (3,) unit.
      anchor: (3,) m, a point of the axis.
    """
    arm = np.asarray(points, np.float64) - anchor
    along = arm @ axis
    away = np.linalg.norm(arm - along[:, None] * axis, axis=1)
    radius, low, high = float(away.max()), float(along.min()), float(along.max())
    count = max(1, int(np.ceil((high - low) / (2 * radius) - 1e-6)))
    at = low + (high - low) * (np.arange(count) + 0.5) / count
    centre = anchor + at[:, None] * axis
    hull = ConvexHull(points)
    # The point of a sphere that is farthest from the shape lies on the axis or on the wheel's rim.
    ball = trimesh.creation.icosphere(subdivisions=3, radius=radius).vertices
    out = (centre[:, None] + ball[None]).reshape(-1, 3)
    fine = _surface(np.asarray(points, np.float64), hull, _ERROR_SAMPLES)
    gap = cdist(fine, centre).min(1) - radius
    return Cover(centre, np.full(count, radius), _outside(out, hull, fine), max(float(gap.max()), 0.0))


def _outside(at: np.ndarray, hull: ConvexHull, surface: np.ndarray) -> float:
    """m, the largest distance of points (n, 3) from a hull that they lie outside of, by samples of its surface."""
    beyond = at[_depth(at, hull.equations) < 0.0]
    return float(cKDTree(surface).query(beyond)[0].max()) if len(beyond) else 0.0
