"""Makes closer collision hulls: of the surface below a robot's height, and out of where a robot can be.

The first hulls (`decompose`) bound what they miss and their volume, so they close door recesses, wheel arches and the
space between legs. Here the mesh is cut at `LEVELS`; in each cut, the points that an upright cylinder of a robot's
width reaches from outside, and that are further from the mesh than a limit, are forbidden. Convex polyhedra without
forbidden points are grown around points of the surface as in IRIS (Deits and Tedrake, "Computing large convex regions
of obstacle-free space through semidefinite programming", 2015), except that the ellipsoid is that of the surface points
inside, and that boxes along the axes are grown too; of many, those are chosen greedily that hold most of the surface
that is not yet covered, and pairs whose union holds no forbidden point are joined. First hulls without forbidden points
are kept; of the others, only what is above `CloseOptions.top`. If too many hulls are needed, the next limit is tried.

Sums are over whole millimetres and products over coordinates one by one. What `decompose` adds has products whose last
bits depend on the processor's BLAS and may decide between two hulls, so the store is made with one of its kernels.
"""

import dataclasses
import functools
import itertools
from collections.abc import Callable, Iterator, Sequence

import numpy as np
from scipy.ndimage import binary_dilation, binary_erosion, distance_transform_edt
from scipy.spatial import ConvexHull, QhullError, cKDTree

from urbanverse_mjx.datatypes import SceneLayout
from urbanverse_mjx.datatypes.asset import MAX_HULL_VERTICES, MAX_HULLS, AssetMesh, AssetRecord
from urbanverse_mjx.process_pool import worker_pool
from urbanverse_mjx.progress import Progress
from urbanverse_mjx.settings import use_blas_kernel

from ..categories.priors import prior
from ..recipes.building.regional.styles import DRESSINGS
from ..records.index import build_mesh, load_index
from ..records.regional import load_regional
from .decompose import OPTIONS as FIRST
from .decompose import Piece, convex_piece, is_flush, merge_pieces, simplified
from .hulls import MILLIMETRE, REVISIONS, HullStore, close_store_path, hull_key, load_hulls
from .overshoot import HEIGHTS, LIMIT, ROBOT_RADIUS, disc_reach, mesh_cut, overshoot, raster
from .within_reach import shape_of, shapes_of

#: Kernel of OpenBLAS with which the store is made on x86 (its variable OPENBLAS_CORETYPE): any with AVX2 has it.
KERNEL = "Haswell"
#: m, of the cuts, and of the surface points that are to be covered, so that a thin hull between two cuts gains nothing:
#: those of the measurement, and some in between.
LEVELS = tuple(
    sorted((*HEIGHTS, 0.1, 0.2, 0.256, 0.365, 0.42, 0.47, 0.58, 0.64, 0.77, 0.82, 0.87, 0.985, 1.05, 1.12, 1.235))
)


@dataclasses.dataclass(frozen=True)
class CloseOptions:
    """Options for making closer hulls, chosen by hand on a sample of shapes.

    Attributes:
      limits: m, distances from the mesh from which a point that a robot reaches is forbidden; tried in this order
        until hulls enough cover the mesh.
      closing, slimmer: m, a point counts as reached by a disc that comes so near to touching it, and the disc is so
        much slimmer than the robot: cells have a width.
      top: m, height up to which hulls are made anew.
      cell, cells: m, cells of the maps of a cut; at most so many along a side.
      spacing, most_points: m, distance of surface points that are to be covered, increased until they are so few.
      border, within: m, distance of forbidden points at the border of what is forbidden, and within, if they are less
        than `around` (m) from the mesh; others are half of that apart.
      coarse: so many of them let polyhedra grow; all of them cut those that are chosen.
      missed: m; surface points further outside all hulls are uncovered.
      inside: m; a forbidden point so far inside a hull forbids it.
      better: share of the first hulls' largest overshoot that closer ones may have.
      most_missed, most_missed_share: m, and share of the longest side, by which surface points may lie outside.
      standing: m, height below which a corner stands on the ground.
      least_foot: share of the area on which the first hulls stand that closer ones of a movable shape need.
      lattice, most_lattice: m, distance of points of level faces; at most so many along a side.
      seeds, updates: number of seeds in a round, and of updates of an ellipsoid.
      pool: largest number of polyhedra kept for the next round.
      hopeless: share of the points left uncovered by half of the hulls from which a limit is given up.
      spare: hulls more than the budget that may be made before some are joined.
      smallest: m, smallest standard deviation of an ellipsoid.
      budgets: largest number of hulls of a mesh whose largest side is below `BUDGET_SIDES`, and of others.
      prune: whether hulls are left out whose surface points others cover.
      lean: m, by which corners of a hull may lie outside those that are kept.
      whole: whether closer hulls must be within `overshoot.LIMIT`, whatever the first ones are.
      foot: m; hulls that end lower are continued to the surface below them.
      level: m, distance of points of level faces near which nothing is forbidden, above and below; 0: only what is near
        the mesh in its own cut is allowed, so that hulls may not touch a floor from below.
    """

    limits: tuple[float, ...] = (0.037, 0.055, 0.09, 0.16)
    closing: float = 0.02
    slimmer: float = 0.005
    top: float = 1.25
    cell: float = 0.0125
    cells: int = 700
    spacing: float = 0.03
    lattice: float = 0.1
    most_lattice: int = 60
    most_points: int = 2000
    border: float = 0.025
    within: float = 0.03
    around: float = 0.4
    coarse: int = 2500
    missed: float = 0.045
    inside: float = 0.008
    better: float = 0.6
    most_missed: float = 0.06
    most_missed_share: float = 0.01
    standing: float = 0.004
    least_foot: float = 0.45
    seeds: int = 3
    updates: int = 2
    pool: int = 40
    hopeless: float = 0.3
    spare: int = 4
    smallest: float = 0.02
    budgets: tuple[int, int, int, int] = (5, 7, 12, MAX_HULLS)
    prune: bool = False
    lean: float = 0.0
    whole: bool = False
    foot: float = 0.0
    level: float = 0.0


OPTIONS = CloseOptions()
#: m, largest sides of meshes from which on they may have more hulls.
BUDGET_SIDES = (1.1, 2.2, 6.0)
#: Options of each kind of hulls (`SceneLayout.hulls`); they differ in what follows the cuts alone.
OPTIONS_OF = {
    "close": OPTIONS,
    "close-2": dataclasses.replace(
        OPTIONS,
        limits=(0.043, 0.039, 0.035),
        hopeless=0.5,
        spare=12,
        budgets=(6, 8, 12, MAX_HULLS),
        prune=True,
        lean=0.014,
        whole=True,
        foot=0.08,
        level=0.02,
    ),
}
#: Sides of the boxes, and inverse covariances of the ellipsoids, with which growth begins.
_BOXES = ((1.0, 1.0, 1.0), (1.0, 1.0, 6.0), (6.0, 1.0, 1.0), (1.0, 6.0, 1.0))
_ELLIPSOIDS = (np.eye(3), np.diag((1.0, 1.0, 0.06)))


def close_budget(mesh: AssetMesh, kind: str = "close") -> int:
    """Largest number of closer hulls of a mesh, by its largest side."""
    return OPTIONS_OF[kind].budgets[int(np.searchsorted(BUDGET_SIDES, float(mesh.extent.max()), "right"))]


@dataclasses.dataclass(frozen=True)
class _Cut:
    """A cut through a mesh.

    Attributes:
      height: m.
      low, cell: m, middle of the first cell of the maps, and side of a cell.
      disc: map of the distance (m) to the nearest middle of a robot's disc that comes there from outside.
      near: map of the distance (m) to the mesh.
    """

    height: float
    low: np.ndarray
    cell: float
    disc: np.ndarray
    near: np.ndarray

    def reached(self, limit: float) -> np.ndarray:
        """Map of what hulls may not contain."""
        return (self.disc <= ROBOT_RADIUS - OPTIONS.closing) & (self.near > limit)

    def points(self, mask: np.ndarray, height: float) -> np.ndarray:
        """(n, 3) m: points of the border of a map, and some within."""
        edge = mask & ~binary_erosion(mask, border_value=1)
        some = np.zeros(mask.shape, bool)
        for within, around in ((OPTIONS.within, OPTIONS.around), (OPTIONS.around / 2, np.inf)):
            step = max(int(within / self.cell), 1)
            some[::step, ::step] |= (mask & (self.near < around))[::step, ::step]
        index = np.argwhere(edge | some)
        index = index[_one_each(index // max(int(OPTIONS.border / self.cell), 1))]
        return np.column_stack([self.low + index * self.cell, np.full(len(index), height)])


def _cuts(triangles: np.ndarray) -> list[_Cut]:
    """The cuts through a mesh at `LEVELS`; what a disc reaches depends on the cut and on those of `HEIGHTS` below."""
    margin = ROBOT_RADIUS * 3
    low, high = triangles[..., :2].min((0, 1)) - margin, triangles[..., :2].max((0, 1)) + margin
    span = float((high - low).max())
    cell = max(OPTIONS.cell, span / OPTIONS.cells)
    shape = tuple(np.ceil((high - low) / cell).astype(int) + 1)
    solid, known, found = np.zeros(shape, bool), np.zeros(shape, bool), []
    disc = np.zeros(shape)
    for height in LEVELS:
        cut = raster(mesh_cut(triangles, height), low, cell, shape)
        blocking = solid | cut
        # Cells beside those of the last map are the same wall.
        if (blocking & ~binary_dilation(known)).any() or (known & ~binary_dilation(blocking)).any():
            disc, known = disc_reach(blocking, cell, ROBOT_RADIUS - OPTIONS.slimmer), blocking
        if height in HEIGHTS:
            solid = blocking
        near = distance_transform_edt(~cut) * cell if cut.any() else np.full(shape, np.inf)
        found.append(_Cut(height, low, cell, disc, near))
    return found


def _forbidden_points(cuts: Sequence[_Cut], triangles: np.ndarray, limit: float) -> np.ndarray:
    """(n, 3) int64 mm: points that hulls may not contain, in the box of the mesh and a little around it.

    Args:
      limit: m, distance from the mesh up to which points are allowed.
    """
    found = [cut.points(cut.reached(limit), cut.height) for cut in cuts]
    points = np.round(np.concatenate(found) / MILLIMETRE).astype(np.int64)
    around = limit + 0.02
    low, high = (triangles.min((0, 1)) - around) / MILLIMETRE, (triangles.max((0, 1)) + around) / MILLIMETRE
    return points[((points > low) & (points < high))[:, :2].all(1)]


def surface_points(triangles: np.ndarray) -> np.ndarray:
    """(n, 3) int64 mm: corners of the mesh, and points of cuts and of level faces, up to `CloseOptions.top`."""
    corners = np.concatenate([triangles.reshape(-1, 3), _level_points(triangles, OPTIONS.lattice)])
    found = [corners[(corners[:, 2] <= OPTIONS.top) & (corners[:, 2] > FIRST.foot_plate + 1e-3)]]
    for height in (*LEVELS, OPTIONS.top):
        segments = mesh_cut(triangles, height)
        if not len(segments):
            continue
        a, b = segments[:, 0], segments[:, 1]
        count = np.ceil(np.sqrt(((b - a) ** 2).sum(1)) / OPTIONS.spacing).astype(int) + 1
        which = np.repeat(np.arange(len(a)), count)
        along = (np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count)) / np.maximum(count[which] - 1, 1)
        points = a[which] + along[:, None] * (b - a)[which]
        found.append(np.column_stack([points, np.full(len(points), height)]))
    points = np.round(np.concatenate(found) / MILLIMETRE).astype(np.int64)
    return points[_one_each(points)]


def _level_points(triangles: np.ndarray, lattice: float) -> np.ndarray:
    """(n, 3) m: points of the faces that are more level than upright, which cuts meet only at their edges.

    Args:
      lattice: m between them.
    """
    edges = np.roll(triangles, -1, 1) - triangles
    normal = np.cross(edges[:, 0], edges[:, 1])
    level = np.abs(normal[:, 2]) > 0.7 * np.sqrt((normal**2).sum(1))
    low = triangles[..., 2].min(1) < OPTIONS.top
    chosen, sides = triangles[level & low], np.sqrt((edges[level & low] ** 2).sum(2)).max(1)
    count = np.clip(np.ceil(sides / lattice), 1, OPTIONS.most_lattice).astype(int)
    found = [np.zeros((0, 3))]
    for number in np.unique(count):
        i, j = np.indices((number + 1, number + 1)).reshape(2, -1)
        i, j = i[i + j <= number] / number, j[i + j <= number] / number
        a, b, c = (chosen[count == number][:, None, k] for k in range(3))
        found.append((a + i[:, None] * (b - a) + j[:, None] * (c - a)).reshape(-1, 3))
    return np.concatenate(found)


def _one_each(rows: np.ndarray) -> np.ndarray:
    """Numbers of the first of equal rows (n, k) of integers below 2^20, in order."""
    rows = rows - rows.min(0, initial=0)
    number = np.zeros(len(rows), np.int64)
    for column in rows.T:
        number = number * 2**20 + column
    return np.sort(np.unique(number, return_index=True)[1])


def _thinned(points: np.ndarray, most: int) -> np.ndarray:
    """At most `most` of the points, one to a cube."""
    side = OPTIONS.spacing / MILLIMETRE
    while True:
        first = _one_each(points // int(side))
        if len(first) <= most:
            return points[first]
        side *= 1.3


def _dot(points: np.ndarray, normal: np.ndarray) -> np.ndarray:
    return points[:, 0] * normal[0] + points[:, 1] * normal[1] + points[:, 2] * normal[2]


def _inverse(matrix: np.ndarray) -> np.ndarray:
    """Inverse of a symmetric matrix (3, 3) by its cofactors."""
    rows = [np.cross(matrix[(k + 1) % 3], matrix[(k + 2) % 3]) for k in range(3)]
    cofactors = np.stack(rows, 1)
    return cofactors / (matrix[0] * rows[0]).sum()


@dataclasses.dataclass(frozen=True)
class _Polyhedron:
    """A convex polyhedron that grew around a point.

    Attributes:
      centre: (3,) mm.
      metric: (3, 3) inverse covariance (1/mm^2) of the ellipsoid that grew, or (3,) sides (mm) of the box that did.
      planes: (k, 4), n x < d inside.
    """

    centre: np.ndarray
    metric: np.ndarray
    planes: np.ndarray

    def cut(self, obstacles: np.ndarray) -> "_Polyhedron":
        """The polyhedron without obstacles (n, 3) mm: each time, a plane through the first that the body meets."""
        obstacles = obstacles[_within(obstacles, self.planes)]
        away = np.ascontiguousarray((obstacles - self.centre).T)
        if self.metric.ndim == 1:
            scaled = np.abs(away) / self.metric[:, None]
            reach, axes = scaled.max(0), scaled.argmax(0)
        else:
            normals = [row[0] * away[0] + row[1] * away[1] + row[2] * away[2] for row in self.metric]
            reach = away[0] * normals[0] + away[1] * normals[1] + away[2] * normals[2]
        left, planes = np.arange(len(reach)), list(self.planes)
        while len(left):
            k = left[reach[left].argmin()]
            if self.metric.ndim == 1:
                normal = np.zeros(3)
                normal[axes[k]] = np.sign(away[axes[k], k])
                along = normal[axes[k]] * away[axes[k], left]
                offset = abs(away[axes[k], k])
            else:
                normal, offset = np.array([n[k] for n in normals]), reach[k]
                along = normal[0] * away[0, left] + normal[1] * away[1, left] + normal[2] * away[2, left]
            # So far from the point that no sheet fits between two of them.
            offset -= OPTIONS.border / 2 / MILLIMETRE * np.sqrt(normal[0] ** 2 + normal[1] ** 2)
            planes.append(np.array([*normal, offset + _dot(self.centre[None], normal)[0]]))
            left = left[along < offset]
            left = left[left != k]
        return dataclasses.replace(self, planes=np.array(planes).reshape(-1, 4))


def _within(points: np.ndarray, planes: np.ndarray) -> np.ndarray:
    left = np.arange(len(points))
    for plane in planes:
        left = left[_dot(points[left], plane) < plane[3]]
    inside = np.zeros(len(points), bool)
    inside[left] = True
    return inside


def _ellipsoid(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean (mm) and inverse covariance of integer points."""
    total, count = points.sum(0), len(points)
    centre = np.floor(total / count)
    away = points - centre.astype(np.int64)
    spread = np.stack([(away[:, k, None] * away).sum(0) for k in range(3)]) / count
    return centre, _inverse(spread + np.eye(3) * (OPTIONS.smallest / MILLIMETRE) ** 2)


def _candidates(
    seed: np.ndarray, points: np.ndarray, left: np.ndarray, obstacles: np.ndarray
) -> list[tuple[_Polyhedron, np.ndarray]]:
    """Polyhedra grown around a seed, each with which points it contains."""
    found = []
    for shape in (*_BOXES, *_ELLIPSOIDS):
        centre, metric = seed.astype(float), np.array(shape)
        for _ in range(OPTIONS.updates):
            grown = _Polyhedron(centre, metric, np.zeros((0, 4))).cut(obstacles)
            inside = _within(points, grown.planes)
            found.append((grown, inside))
            if not (inside & left).any():
                break
            held = points[inside & left]
            if metric.ndim == 1:
                centre = np.floor((held.max(0) + held.min(0)) / 2)
                metric = np.ptp(held, axis=0) + 2 * OPTIONS.smallest / MILLIMETRE
            else:
                centre, metric = _ellipsoid(held)
    return found


def _gap(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """(n,) m, by which points (mm) lie outside the hull of corners (m); negative inside."""
    planes, points = ConvexHull(corners).equations, points * MILLIMETRE
    gap = np.full(len(points), -np.inf)
    for plane in planes:
        gap = np.maximum(gap, _dot(points, plane) + plane[3])
    return gap


def _blocks(corners: np.ndarray, obstacles: np.ndarray) -> bool:
    """Whether a hull (m) contains a forbidden point (mm)."""
    low, high = corners.min(0) / MILLIMETRE, corners.max(0) / MILLIMETRE
    left = obstacles
    for k in (2, 0, 1):
        left = left[(left[:, k] > low[k]) & (left[:, k] < high[k])]
    left = left * MILLIMETRE
    for plane in ConvexHull(corners).equations:
        if not len(left):
            return False
        left = left[_dot(left, plane) + plane[3] < -OPTIONS.inside]
    return len(left) > 0


def above(corners: np.ndarray, height: float) -> np.ndarray | None:
    """The part of a hull above a height (m); None without one."""
    if corners[:, 2].max() <= height + 0.02:
        return None
    low, high = corners[corners[:, 2] < height], corners[corners[:, 2] >= height]
    if not len(low):
        return corners
    t = (height - low[:, None, 2]) / (high[None, :, 2] - low[:, None, 2])
    cut = (low[:, None] + t[..., None] * (high[None] - low[:, None])).reshape(-1, 3)
    return np.concatenate([cut, high])


def cover(
    points: np.ndarray, obstacles: np.ndarray, known: Sequence[np.ndarray], most: int, hopeless: float
) -> tuple[list[np.ndarray], bool]:
    """Convex hulls of surface points without forbidden ones that cover the rest.

    Args:
      points, obstacles: (n, 3) int64 mm.
      known: corners (k, 3) m of hulls that cover some already.
      most: largest number of hulls.
      hopeless: see `CloseOptions`.

    Returns:
      corners (m) of each hull, and whether they cover all points.
    """
    coarse, few = _thinned(obstacles, OPTIONS.coarse), _thinned(points, OPTIONS.most_points)
    gap, made = _gaps(points, known), []
    while len(gap) and (uncovered := gap > OPTIONS.missed).any():
        if len(made) >= most:
            return made, False
        # Those that cubes left out.
        few = np.concatenate([few, _thinned(points[uncovered], OPTIONS.most_points // 4)])
        new, hopeful = _greedy(points, few, obstacles, coarse, [*known, *made], most - len(made), hopeless)
        if not new or not hopeful:
            return made, False
        made += new
        gap = np.minimum(gap, _gaps(points, new))
    return made, True


def _gaps(points: np.ndarray, hulls: Sequence[np.ndarray]) -> np.ndarray:
    """(n,) m, by which points (mm) lie outside the nearest hull (m)."""
    return np.minimum.reduce([np.full(len(points), np.inf), *(_gap(points, h) for h in hulls)])


def _greedy(
    points: np.ndarray,
    few: np.ndarray,
    obstacles: np.ndarray,
    coarse: np.ndarray,
    known: Sequence[np.ndarray],
    most: int,
    hopeless: float,
) -> tuple[list[np.ndarray], bool]:
    """Hulls that cover some of the points, `few`, and whether half of them covered enough to hope for the rest."""
    gap = _gaps(few, known)
    made: list[np.ndarray] = []
    pool: list[tuple[_Polyhedron, np.ndarray]] = []
    while len(made) < most and (left := gap > OPTIONS.missed).any():
        for seed in _spread(few[left], OPTIONS.seeds):
            pool += _candidates(seed, few, left, coarse)
        near = gap > 0.01
        worth = [5 * int((inside & left).sum()) + int((inside & near).sum()) for _, inside in pool]
        while True:
            best = int(np.argmax(worth))
            grown = pool[best][0].cut(obstacles)
            inside = _within(few, grown.planes)
            again = 5 * int((inside & left).sum()) + int((inside & near).sum())
            if again == worth[best]:
                break
            pool[best], worth[best] = (grown, inside), again
        if not (inside & left).any():
            break
        try:
            corners = _hull_of(points[_within(points, grown.planes)], obstacles)
        except QhullError:
            gap[inside] = 0.0
            continue
        made.append(corners)
        gap = np.minimum(gap, _gap(few, corners))
        if len(made) == most // 2 and (gap > OPTIONS.missed).mean() > hopeless:
            return made, False
        order = [int(k) for k in np.argsort(worth, kind="stable")[::-1] if k != best]
        pool = [pool[k] for k in order[: OPTIONS.pool]]
    return made, True


def _hull_of(points: np.ndarray, obstacles: np.ndarray) -> np.ndarray:
    """Corners (m) of the hull of points (mm), at most 32.

    Raises:
      QhullError: there are too few points for a hull.
    """
    try:
        points = points[ConvexHull(points).vertices]
    except QhullError:  # in a plane, or on a line
        points = _thinned(points, OPTIONS.most_points)
    return _limited(convex_piece(points * MILLIMETRE).corners, obstacles)


def _limited(corners: np.ndarray, obstacles: np.ndarray) -> np.ndarray:
    """At most 32 corners of a hull, which is enlarged unless it then contains forbidden points."""
    large = simplified(corners)
    return simplified(corners, enlarge=False) if len(corners) > len(large) and _blocks(large, obstacles) else large


def _spread(points: np.ndarray, count: int) -> np.ndarray:
    """Points that are far from each other, beginning with the one nearest to their mean."""
    centre = points.sum(0) // len(points)
    away = ((points - centre) ** 2).sum(1)
    chosen = [int(away.argmin())]
    distance = ((points - points[chosen[0]]) ** 2).sum(1)
    while len(chosen) < min(count, len(points)):
        chosen.append(int(distance.argmax()))
        distance = np.minimum(distance, ((points - points[chosen[-1]]) ** 2).sum(1))
    return points[chosen]


def close_hulls(mesh: AssetMesh, first: Sequence[np.ndarray], kind: str = "close") -> tuple[np.ndarray, ...]:
    """Closer hulls of a mesh, each (n, 3) int32 in whole millimetres with n <= 32; () if there are not enough for it.

    Args:
      first: corners (n, 3) m of its first hulls.
      kind: of `OPTIONS_OF`.
    """
    return next(_trials(mesh, first, kind), ())


def _trials(mesh: AssetMesh, first: Sequence[np.ndarray], kind: str) -> Iterator[tuple[np.ndarray, ...]]:
    """Closer hulls of a mesh for each of the limits with which the budget suffices, see `close_hulls`."""
    triangles, options = mesh.vertices.astype(np.float64)[mesh.faces], OPTIONS_OF[kind]
    points, cuts, budget = surface_points(triangles), _cuts(triangles), close_budget(mesh, kind)
    hulls = [np.asarray(h, np.float64) for h in first]
    for limit in options.limits:
        obstacles = _forbidden_points(cuts, triangles, limit)
        if options.level:
            obstacles = obstacles[~_near_level(obstacles, triangles, limit, options.level)]
        blocked = [_blocks(h, obstacles) for h in hulls]
        known = [h for h, b in zip(hulls, blocked, strict=True) if not b]
        cut = [above(h, OPTIONS.top) for h, b in zip(hulls, blocked, strict=True) if b]
        upper = [convex_piece(h) for h in cut if h is not None]
        made, whole = cover(points, obstacles, known, budget + options.spare - len(known), options.hopeless)
        if not whole:
            continue
        lower = _joined(_pruned(points, [*known, *made]) if options.prune else [*known, *made], obstacles)
        if options.prune:
            lower = [convex_piece(h) for h in _pruned(points, [piece.corners for piece in lower])]
        left = budget - len(lower)
        if left >= min(len(upper), 1):
            upper = merge_pieces(upper, left) if len(upper) > left else upper
            if options.foot:
                lower = [_grounded(piece, triangles, obstacles, options.foot) for piece in lower]
            pieces = [*lower, *upper]
            yield _stored([_lean(p, options.lean) for p in pieces] if options.lean else pieces, mesh)


def _near_level(points: np.ndarray, triangles: np.ndarray, limit: float, lattice: float) -> np.ndarray:
    """(n,) bool: whether points (n, 3) mm are less than `limit` (m) above or below a level face."""
    tree = cKDTree(_level_points(triangles, lattice))
    if not tree.n:
        return np.zeros(len(points), bool)
    return np.isfinite(tree.query(points * MILLIMETRE, distance_upper_bound=limit)[0])


def _pruned(points: np.ndarray, hulls: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Hulls (corners in m) without those, the smallest first, whose points (n, 3) mm others cover as well."""
    gaps = np.array([_gap(points, h) for h in hulls]).reshape(len(hulls), len(points))
    alive = np.ones(len(hulls), bool)
    for k in np.argsort([ConvexHull(h).volume for h in hulls], kind="stable"):
        alive[k] = False
        if not alive.any() or (gaps[alive].min(0) > np.maximum(gaps[k], OPTIONS.missed)).any():
            alive[k] = True
    return [h for h, a in zip(hulls, alive, strict=True) if a]


def _grounded(piece: Piece, triangles: np.ndarray, obstacles: np.ndarray, most: float) -> Piece:
    """A piece that ends less than `most` (m) above the ground with the corners of the mesh below it, so that it stands.

    It stays as it is where it would then contain forbidden points.
    """
    if piece.corners[:, 2].min() > most:
        return piece
    corners = triangles.reshape(-1, 3)
    corners = corners[corners[:, 2] <= FIRST.foot_plate + 1e-3]
    corners = np.unique(np.round(corners / MILLIMETRE).astype(np.int64), axis=0)
    under = corners[_gap(corners, piece.corners) < most] * MILLIMETRE
    if not len(under):
        return piece
    grown = convex_piece(np.concatenate([piece.corners, under]))
    grown = convex_piece(_limited(grown.corners, obstacles))
    return piece if _blocks(grown.corners, obstacles) else grown


def _lean(piece: Piece, most: float) -> Piece:
    """A piece without corners that lie less than `most` (m) outside the hull of the others, except on the ground."""
    corners = piece.corners
    kept = np.ones(len(corners), bool)
    while kept.sum() > 4:
        best, least = -1, most
        for k in np.flatnonzero(kept & (corners[:, 2] > OPTIONS.standing)):
            others = kept.copy()
            others[k] = False
            try:
                planes = ConvexHull(corners[others]).equations
            except QhullError:
                continue
            gap = float(((corners[:, None] * planes[:, :3]).sum(2) + planes[:, 3]).max())
            if gap < least:
                best, least = int(k), gap
        if best < 0:
            break
        kept[best] = False
    return convex_piece(corners[kept])


def _joined(hulls: Sequence[np.ndarray], obstacles: np.ndarray) -> list[Piece]:
    """Joins pairs of hulls (corners in m) whose union contains no forbidden point, first those that add least space."""
    coarse = _thinned(obstacles, OPTIONS.coarse)
    alive = {k: convex_piece(h) for k, h in enumerate(hulls)}
    added: dict[tuple[int, int], float] = {}
    while True:
        names = sorted(alive)
        for i, j in itertools.combinations(names, 2):
            if (i, j) not in added:
                union = ConvexHull(np.concatenate([alive[i].corners, alive[j].corners]))
                corners = union.points[union.vertices]
                blocked = _blocks(corners, coarse) or _blocks(corners, obstacles)
                blocked = blocked or (len(corners) > MAX_HULL_VERTICES and _blocks(simplified(corners), obstacles))
                added[i, j] = np.inf if blocked else union.volume - alive[i].volume - alive[j].volume
        pair = min(added, key=lambda p: (added[p], p), default=None)
        if pair is None or added[pair] == np.inf:
            return list(alive.values())
        both = np.concatenate([alive[k].corners for k in pair])
        corners = simplified(both[ConvexHull(both).vertices])
        alive = {k: piece for k, piece in alive.items() if k not in pair} | {max(alive) + 1: convex_piece(corners)}
        added = {p: a for p, a in added.items() if not {*p} & {*pair}}


def _stored(pieces: Sequence[Piece], mesh: AssetMesh) -> tuple[np.ndarray, ...]:
    """Hulls in whole millimetres within the mesh's box, the largest first, as `decompose` orders them."""
    slack = np.array([FIRST.max_protrusion, FIRST.max_protrusion, 0.0]) * mesh.extent
    low, high = mesh.vertices.min(0) - slack, mesh.vertices.max(0) + slack
    rounded = [np.round(np.clip(simplified(p.corners), low, high) / MILLIMETRE).astype(np.int32) for p in pieces]
    keyed = sorted(zip(pieces, rounded, strict=True), key=lambda x: (-round(x[0].volume, 6), x[1].min(0).tolist()))
    return tuple(np.unique(r, axis=0) for _, r in keyed)


def foot_area(hulls: Sequence[np.ndarray]) -> float:
    """m^2, area of the convex outline of the corners (m) that stand on the ground, z = 0; 0 where none do."""
    corners = np.concatenate([np.asarray(h, np.float64) for h in hulls])
    standing = corners[corners[:, 2] < OPTIONS.standing][:, :2]
    try:
        return float(ConvexHull(standing).volume)
    except (QhullError, ValueError):
        return 0.0


def stands_as_well(record: AssetRecord, first: Sequence[np.ndarray], made: Sequence[np.ndarray]) -> bool:
    """Whether closer hulls (m) stand on the ground as broadly as the first ones; what never moves need not."""
    still = prior(record.leaf).rest in ("fixed", "hangs", "alive")
    return still or foot_area(made) >= OPTIONS.least_foot * foot_area(first)


def closer(record: AssetRecord, before: float | None = None, kind: str = "close") -> tuple[str, tuple[np.ndarray, ...]]:
    """Key and closer hulls of a record's mesh.

    There are none, (), where the first hulls are within `overshoot.LIMIT`, or where closer ones would be neither within
    it nor at least `CloseOptions.better`, or would miss more than `CloseOptions.most_missed`, or where an object would
    no longer stand as broadly (`stands_as_well`).

    Args:
      before: m, largest overshoot of the first hulls, if it is known.
      kind: of `OPTIONS_OF`; of a later revision, closer hulls are made where the earlier ones are not within the limit.
    """
    mesh, first = build_mesh(record), load_hulls(record).hulls
    key = hull_key(record)
    earlier = REVISIONS[kind][1:]
    if before is None:
        before = overshoot(mesh.vertices, mesh.faces, load_hulls(record, earlier[0] if earlier else "").hulls).worst
    if before <= LIMIT or is_flush(mesh):
        return key, ()
    whole = OPTIONS_OF[kind].whole
    least = LIMIT if whole else max(LIMIT, OPTIONS.better * before)
    allowed = max(OPTIONS.most_missed, OPTIONS.most_missed_share * float(mesh.extent.max()))
    points = surface_points(mesh.vertices.astype(np.float64)[mesh.faces])
    for made in itertools.islice(_trials(mesh, first, kind), None if whole else 1):
        metres = [h * MILLIMETRE for h in made]
        good = overshoot(mesh.vertices, mesh.faces, metres).worst <= least and _gaps(points, metres).max() <= allowed
        if good and stands_as_well(record, first, metres):
            return key, made
    return key, ()


def build_close(
    leaf: str | None = None,
    jobs: int = 1,
    again: bool = False,
    report: Callable[[str], object] = print,
    layouts: Sequence[SceneLayout] | None = None,
    keep_first: bool = False,
    kind: str = "close",
) -> HullStore:
    """Adds missing closer hulls to their store in worker processes, writes it after every batch, and drops unused ones.

    A shape that has been tried and has none closer stands in the store without hulls, and is not tried again. A later
    revision tries it again, because an earlier one may have kept it without a trial.

    Args:
      leaf: only records of this leaf.
      again: whether to also make those that the store has.
      layouts: only shapes of these layouts that a robot can touch.
      keep_first: try none of the missing ones, and store that they have none, also where no robot can touch them: the
        scenes of these layouts keep their hulls from then on, whatever other sets need.
      kind: `SceneLayout.hulls`; its newest revision is added to.
    """
    every = [*load_index().records, *(r for r in load_regional().records if r.params["variant"] % DRESSINGS == 0)]
    store = REVISIONS[kind][0]
    found = dict(HullStore.load(close_store_path(store)).hulls)
    shapes = None if layouts is None else shapes_of(layouts, in_reach=not keep_first)
    chosen = [r for r in every if leaf in (None, r.leaf) and (shapes is None or shape_of(r) in shapes)]
    waiting = [r for r in chosen if again or hull_key(r) not in found]
    if keep_first:
        found |= {hull_key(r): () for r in waiting}
        waiting = []
    use_blas_kernel(KERNEL)  # in the worker processes
    with Progress() as progress:
        report_done, done = progress.task("closer hulls", len(waiting)), 0
        for first in range(0, len(waiting), FIRST.batch):
            with worker_pool(jobs, niceness=5) as pool:
                for key, hulls in pool.map(functools.partial(closer, kind=kind), waiting[first : first + FIRST.batch]):
                    found[key] = hulls
                    done += 1
                    report_done(done)
            HullStore(found).save(close_store_path(store))
    needed = {hull_key(r) for r in every}
    kept = HullStore({key: hulls for key, hulls in found.items() if key in needed})
    path, numbers = kept.save(close_store_path(store)), [len(h) for h in kept.hulls.values()]
    report(
        f"{path.name}: {len(numbers)} meshes tried, {sum(n > 0 for n in numbers)} with closer hulls, {sum(numbers)} "
        f"hulls, {path.stat().st_size} bytes"
    )
    return kept
