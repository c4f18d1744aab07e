"""The middle of a road: a polyline between its borders, and places along and across it."""

import dataclasses

import numpy as np
import shapely
from scipy.ndimage import median_filter, uniform_filter1d
from scipy.sparse import coo_array, csgraph
from scipy.spatial import Voronoi
from shapely.geometry.base import BaseGeometry

#: m between the stations of an axis.
STEP = 1.0
#: m between the points of a border, of which the middle is the Voronoi diagram's inner part.
_BORDER_STEP = 0.8
#: m; shorter roads have no axis.
_LEAST_LENGTH = 25.0
#: m across which widths and middles are smoothed.
_WIDTH_WINDOW, _MIDDLE_WINDOW = 41, 9
#: Share of the width by which a station may differ from its neighbours; others are mouths of side streets.
_TOLERANCE = 0.12
_FARTHEST = 30.0  # m from the middle to a border
#: rad in m: a road that turns more than this near its end turns into the road that it meets there; and the m from its
#: ends within which that is looked for.
_TURN, _TURN_WITHIN, _END = 0.35, 8, 25


@dataclasses.dataclass(frozen=True)
class Axis:
    """Stations every `STEP` along the middle of a road, and how far its borders are.

    Attributes:
      middle: (n, 2) m.
      normal: (n, 2) unit vectors to the left.
      half: (n,) m, half the width between the kerbs.
      open_left, open_right: (n,) bool, where a side street or a junction opens.
    """

    middle: np.ndarray
    normal: np.ndarray
    half: np.ndarray
    open_left: np.ndarray
    open_right: np.ndarray

    @property
    def length(self) -> float:
        return (len(self.middle) - 1) * STEP

    def half_at(self, s: float) -> float:
        """Half the width (m) at s m along the road."""
        return float(self._halves(np.asarray(s)))

    def _halves(self, s: np.ndarray) -> np.ndarray:
        return np.interp(s / STEP, np.arange(len(self.half)), self.half)

    def _stations(self, s0: float, s1: float) -> np.ndarray:
        """s0, the stations between, and s1."""
        s = np.unique(np.concatenate([[s0], np.arange(np.ceil(s0 / STEP), np.floor(s1 / STEP) + 1) * STEP, [s1]]))
        return s[(s >= s0) & (s <= s1)]

    def points(self, s: np.ndarray | float, d: np.ndarray | float) -> np.ndarray:
        """(..., 2) places s m along and d m to the left of the middle."""
        s, d = np.broadcast_arrays(np.asarray(s, float), np.asarray(d, float))
        at, number = s / STEP, np.arange(len(self.middle))
        found = [
            np.interp(at, number, self.middle[:, k]) + d * np.interp(at, number, self.normal[:, k]) for k in (0, 1)
        ]
        return np.stack(found, -1)

    def project(self, points: np.ndarray) -> np.ndarray:
        """(n, 2) of s and d of places (n, 2)."""
        line = shapely.LineString(self.middle)
        length = self.length / line.length
        s = shapely.line_locate_point(line, shapely.points(np.asarray(points, float))) * length
        away = np.asarray(points) - self.points(s, 0.0)
        toward = self.points(s, 1.0) - self.points(s, 0.0)
        return np.stack([s, (away * toward).sum(-1)], -1)

    def strip(self, s0: float, s1: float, d0: float, d1: float) -> BaseGeometry:
        """The part from s0 to s1 along and d0 to d1 across."""
        s = self._stations(s0, s1)
        return _valid(shapely.Polygon(np.concatenate([self.points(s, d0), self.points(s[::-1], d1)])))

    def kerb_strip(self, side: int, s0: float, s1: float, near: float, far: float) -> BaseGeometry:
        """The part from s0 to s1 along and near to far m off the kerb to the left (side 1) or right (-1)."""
        s = self._stations(s0, s1)
        kerb = self._halves(s)
        ring = [self.points(s, side * (kerb - near)), self.points(s, side * (kerb - far))[::-1]]
        return _valid(shapely.Polygon(np.concatenate(ring)))

    def shape(self, corners: np.ndarray) -> BaseGeometry:
        """The polygon of corners (n, 2) given as s and d."""
        return _valid(shapely.Polygon(self.points(corners[:, 0], corners[:, 1])))


def _valid(shape: shapely.Polygon) -> BaseGeometry:
    """The shape without loops, which a strip has inside a sharp bend."""
    return shape if shape.is_valid else shape.buffer(0.0)


def axes(carriageway: BaseGeometry) -> list[Axis]:
    """The axis of each road that is long enough; side streets and junctions belong to the road they open into."""
    found = [_axis(part) for part in shapely.get_parts(carriageway) if isinstance(part, shapely.Polygon)]
    return [axis for axis in found if axis is not None]


def _axis(part: shapely.Polygon) -> Axis | None:
    path = _longest_path(part)
    if path is None:
        return None
    middle = _evenly(uniform_filter1d(path, _MIDDLE_WINDOW, axis=0, mode="nearest"))
    if len(middle) * STEP < _LEAST_LENGTH:
        return None
    for extend in (True, True, False):
        left, right = _reach(part, middle)
        width = left + right
        usual = median_filter(width, _WIDTH_WINDOW, mode="nearest")
        inner = np.flatnonzero(np.abs(width - usual) < _TOLERANCE * usual)
        if len(inner) * STEP < _LEAST_LENGTH:
            return None
        shift = np.interp(np.arange(len(middle)), inner, ((left - right) / 2)[inner])
        middle = middle + shift[:, None] * _normals(middle)
        middle = middle[inner[0] : inner[-1] + 1]
        if extend:
            middle = _evenly(uniform_filter1d(middle, 5, axis=0, mode="nearest"))
            middle = _straight_ends(part, middle, float(np.median(width[inner])))
        if len(middle) * STEP < _LEAST_LENGTH:
            return None
    # A border across the end may lie beside the last station.
    middle = _evenly(uniform_filter1d(middle[1:-1], 3, axis=0, mode="nearest"))
    middle = _straight_ends(part, middle, float(np.median(width)))
    left, right = _reach(part, middle)
    width = left + right
    half = median_filter(width, min(_WIDTH_WINDOW, len(width)), mode="nearest") / 2
    half = uniform_filter1d(half, _MIDDLE_WINDOW, mode="nearest")
    slack = half * (1 + 2 * _TOLERANCE)
    return Axis(middle, _normals(middle), half, left > slack, right > slack)


def _straight_ends(part: shapely.Polygon, middle: np.ndarray, width: float) -> np.ndarray:
    """Cuts what turns into another road at the ends, and continues straight as far as the road is as wide as before."""
    for _ in range(2):
        middle = middle[::-1]  # the end is looked at, then the beginning
        along = np.diff(middle, axis=0)
        heading = np.unwrap(np.arctan2(along[:, 1], along[:, 0]))
        turn = np.abs(heading[_TURN_WITHIN:] - heading[:-_TURN_WITHIN])
        sharp = np.flatnonzero(turn[-_END:] > _TURN)
        if len(sharp) and len(middle) > 2 * _END:
            middle = middle[: max(len(turn) - min(_END, len(turn)) + int(sharp[0]) - 2, 12)]
        step = middle[-1] - middle[-9]
        step *= STEP / np.linalg.norm(step)
        more = middle[-1] + np.arange(1, 2 * _END)[:, None] * step
        left, right = _reach(part, np.concatenate([middle[-3:], more]))
        # Beside a side street only the other border is where it was.
        fits = np.minimum(np.abs(left - width / 2), np.abs(right - width / 2))[3:] < _TOLERANCE * width
        fits &= shapely.contains_xy(part, *more.T)
        middle = np.concatenate([middle, more[: int(np.argmin(fits)) if not fits.all() else len(more)]])
    return middle


def _longest_path(part: shapely.Polygon) -> np.ndarray | None:
    """(n, 2) points of the longest path in the medial axis; None without one."""
    border = shapely.segmentize(shapely.Polygon(part.exterior).simplify(0.03), _BORDER_STEP)
    diagram = Voronoi(shapely.get_coordinates(border)[:-1])
    edges = np.array(diagram.ridge_vertices)
    inside = shapely.contains_xy(part, *diagram.vertices.T)
    edges = edges[(edges >= 0).all(1)]
    edges = edges[inside[edges].all(1)]
    if not len(edges):
        return None
    points = diagram.vertices
    lengths = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1) + 1e-9
    graph = coo_array((lengths, (edges[:, 0], edges[:, 1])), (len(points), len(points))).tocsr()
    start = int(edges[0, 0])
    for _ in range(2):
        away, before = csgraph.dijkstra(graph, directed=False, indices=start, return_predecessors=True)
        end = int(np.where(np.isfinite(away), away, -1.0).argmax())
        start, last = end, start
    path, at = [start], start
    while at != last and before[at] >= 0:
        at = int(before[at])
        path.append(at)
    found = points[np.array(path)]
    if len(found) < 2:
        return None
    # From west to east, so that the result does not depend on the order of the borders.
    return found if tuple(found[0]) < tuple(found[-1]) else found[::-1]


def _evenly(points: np.ndarray) -> np.ndarray:
    """The polyline with points every `STEP`; the last piece, which is shorter, is left out."""
    line = shapely.LineString(points)
    count = int(line.length / STEP) + 1
    return shapely.get_coordinates(shapely.line_interpolate_point(line, np.arange(count) * STEP))


def _normals(middle: np.ndarray) -> np.ndarray:
    along = np.gradient(middle, axis=0)
    along = uniform_filter1d(along, 3, axis=0, mode="nearest")
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    return np.stack([-along[:, 1], along[:, 0]], -1)


def _reach(part: shapely.Polygon, middle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(n,) m from each station to the border on its left and right."""
    normal, border = _normals(middle), part.boundary
    sides = []
    for sign in (1.0, -1.0):
        rays = shapely.linestrings(np.stack([middle, middle + sign * _FARTHEST * normal], 1))
        hits = shapely.intersection(rays, border)
        distance = shapely.distance(shapely.points(middle), hits)
        sides.append(np.where(np.isfinite(distance), distance, _FARTHEST))
    return sides[0], sides[1]
