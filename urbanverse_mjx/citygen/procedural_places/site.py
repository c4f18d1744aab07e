"""`Site`: builder of a place: its ground, the lanes that stay free, the houses around it, and its objects."""

import dataclasses
import itertools
import math
import random
from collections.abc import Iterable, Sequence

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from ...datatypes import SceneGraph
from .. import catalogue
from ..canvas.canvas import Canvas
from ..stage import JOINT
from . import stock
from .outlines import Corner, corners, ring

#: m, free width of a lane: a robot of 0.4 m radius, plus the planner's cells of 20 cm.
LANE = 1.25
#: m, depth of the ground under the fronts; less than the depth of any house, so that no path leads behind them.
APRON_DEPTH = 2.4
#: At most this many hulls within `REACH` (m) of a point of the raster (`CELL`, m): 16 slots, minus a reserve for points
#: between those of the raster.
MAX_HULLS_IN_REACH, REACH, CELL = 14, 0.95, 0.3
#: m, least gap between two objects, and height from which an object collides with overhanging crowns and arms.
MIN_GAP, OVERHANG_HEIGHT = 0.06, 1.9
_BLOCK = 4.0  # m, side of the squares of the neighbour index


@dataclasses.dataclass(frozen=True)
class _Front:
    """A house front or wall: its box on the ground, and the ground behind it (m)."""

    label: str
    x: float
    y: float
    degrees: float
    size: catalogue.Size
    shape: shapely.Polygon
    behind: shapely.Polygon


def _front(label: str, size: catalogue.Size, a: Corner, b: Corner, s: float) -> _Front:
    """Returns a front s metres along the edge from a to b, on its right, facing it."""
    length = math.dist(a, b)
    u, w = (b[0] - a[0]) / length, (b[1] - a[1]) / length
    degrees = math.degrees(math.atan2(u, -w))
    depth, width, _ = size

    def at(out: float) -> Corner:
        return a[0] + u * (s + width / 2) + w * out, a[1] + w * (s + width / 2) - u * out

    x, y = at(JOINT + depth / 2)
    behind = box(*at(JOINT + depth + APRON_DEPTH), degrees, 2 * APRON_DEPTH, width + 2 * JOINT)
    return _Front(label, x, y, degrees, size, box(x, y, degrees, depth, width), behind)


class _Shapes:
    """Occupied outlines (m), indexed by the squares that they touch."""

    def __init__(self) -> None:
        self._squares: dict[tuple[int, int], list[shapely.Polygon]] = {}

    def add(self, shape: shapely.Polygon) -> None:
        shapely.prepare(shape)
        for square in self._touched(shape.bounds):
            self._squares.setdefault(square, []).append(shape)

    def near(self, shape: shapely.Polygon, gap: float) -> bool:
        x0, y0, x1, y1 = shape.bounds
        bounds = (x0 - gap, y0 - gap, x1 + gap, y1 + gap)
        return any(
            other.dwithin(shape, gap) for square in self._touched(bounds) for other in self._squares.get(square, ())
        )

    def _touched(self, bounds: tuple[float, float, float, float]) -> Iterable[tuple[int, int]]:
        x0, y0, x1, y1 = (math.floor(b / _BLOCK) for b in bounds)
        return ((i, j) for i in range(x0, x1 + 1) for j in range(y0, y1 + 1))


def box(x: float, y: float, degrees: float, along: float, across: float) -> shapely.Polygon:
    """Returns the oriented rectangle (m) around (x, y)."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    a, b = along / 2, across / 2
    corners = ((a, b), (-a, b), (-a, -b), (a, -b))
    return shapely.Polygon([(round(x + c * u - s * w, 3), round(y + s * u + c * w, 3)) for u, w in corners])


class Site:
    """Collects the ground and objects of one place.

    Args:
      scene_id: id of the graph.
      rng: source of every random choice.

    Attributes:
      canvas: the ground and the objects.
      density: of scattered objects, 0.3 (sparse) to 1 (crowded).
      lanes: (n, 2) m each, pieces of the middle lines of the lanes that stay free.
    """

    def __init__(self, scene_id: str, rng: random.Random) -> None:
        self.rng = rng
        self.canvas = Canvas(scene_id)
        self.canvas.sizes = stock.SIZES
        self.density = rng.uniform(0.3, 1.0)
        self.lanes: list[shapely.LineString] = []
        self._fronts: list[_Front] = []
        self._solid, self._over = _Shapes(), _Shapes()
        self._kept: BaseGeometry = shapely.Polygon()
        self._origin = np.zeros(2)
        self._hulls = np.zeros((0, 0), np.int64)

    def graph(self) -> SceneGraph:
        return self.canvas.graph()

    def uniform(self, low: float, high: float) -> float:
        return self.rng.uniform(low, high)

    # Ground and houses.

    def enclose(self, outline: shapely.Polygon, z: float, labels: Sequence[str] = (), walls: float = 0.05) -> None:
        """Plans the fronts around an outline (m) and lays the ground under them; call it before any other ground.

        Args:
          labels: labels of the houses; if empty, twelve random ones.
          walls: share of bare walls, which also fill gaps too small for a house.
        """
        wide = outline.buffer(APRON_DEPTH, join_style="mitre", mitre_limit=2.0)
        x0, y0, x1, y1 = wide.bounds
        self._origin = np.array([x0, y0])
        self._hulls = np.zeros((math.ceil((x1 - x0) / CELL) + 1, math.ceil((y1 - y0) / CELL) + 1), np.int64)
        self._plan_fronts(outline, labels or self.rng.sample(stock.HOUSES, 12), walls)
        behind = [front.behind for front in self._fronts if front.label == "wall"]
        lots = shapely.set_precision(wide.difference(shapely.union_all(behind)), 0.001)
        for k, lot in enumerate(sorted(shapely.get_parts(lots), key=lambda part: part.bounds)):
            if isinstance(lot, shapely.Polygon) and lot.area > 0.5:
                self.canvas.ground(f"lot_{k}", "sidewalk", corners(lot.exterior)[:-1], z)

    def houses(self) -> None:
        """Places the planned fronts."""
        for front in self._fronts:
            self._take(front.label, front.shape, front.shape, front.size, house=True)
            self.canvas.put(front.label, front.x, front.y, front.degrees, size=front.size)

    def _plan_fronts(self, outline: shapely.Polygon, labels: Sequence[str], walls: float) -> None:
        """Returns house fronts along an outline, facing in."""
        inside = outline.buffer(-0.02, join_style="mitre")
        taken = _Shapes()
        for a, b in itertools.pairwise(ring(outline)):
            length, s = math.dist(a, b), 0.0
            while s < length - 0.2:
                label = self.rng.choice(labels)
                tried = self._tried(label, length - s, bare=self.uniform(0.0, 1.0) < walls)
                fronts = (_front(name, size, a, b, s) for name, size in tried)
                free = (f for f in fronts if not (f.shape.intersects(inside) or taken.near(f.shape, 0.0)))
                front = next(free, None)
                if front:
                    taken.add(front.shape)
                    self._fronts.append(front)
                s += front.size[1] + JOINT if front else min(length - s, 0.5)

    def _tried(self, label: str, rest: float, bare: bool) -> list[tuple[str, catalogue.Size]]:
        """Yields labels and sizes that fit `rest` metres of an edge, best first."""
        deep, wide, high = self.rng.choice(stock.SIZES[label])
        tall, some = round(self.uniform(2.6, 5.2), 2), self.uniform(3.0, 6.0)
        first = rest if 0.55 * wide < rest < 1.5 * wide else wide
        houses = [] if bare else [(label, d, x, high) for x in (first, 0.6 * wide) for d in (deep, 0.55 * deep)]
        walls = [("wall", 0.3, x, tall) for x in (rest if rest < 7.0 else some, 3.0, 1.3)]
        fits = [f for f in (*houses, *walls) if 0.6 < f[2] < rest + 1e-6]
        return [(name, (round(depth, 3), round(width - JOINT, 3), up)) for name, depth, width, up in fits]

    # Lanes.

    def lane(self, points: Sequence[Corner], reach: float = 0.0, width: float = LANE) -> None:
        """Keeps a lane free along a polyline (m); between its points the lane winds up to `reach` (m) to either
        side."""
        path: list[Corner] = [points[0]]
        for a, b in itertools.pairwise(points):
            length = math.dist(a, b)
            count = max(1, round(length / self.uniform(2.5, 5.0)))
            for i in range(1, count):
                off = self.rng.choice((-reach, reach, self.uniform(-reach, reach)))
                x, y = (a[k] + (b[k] - a[k]) * i / count for k in (0, 1))
                path.append((x - (b[1] - a[1]) / length * off, y + (b[0] - a[0]) / length * off))
            path.append(b)
        line = shapely.LineString([(round(x, 3), round(y, 3)) for x, y in path])
        self.lanes.append(line)
        self._kept = self._kept.union(line.buffer(width / 2, quad_segs=3))
        shapely.prepare(self._kept)
        if not self.canvas.trajectory:
            self.canvas.trajectory = corners(line)

    def keep(self, shape: BaseGeometry) -> None:
        """Keeps an area free of objects."""
        self._kept = self._kept.union(shape)
        shapely.prepare(self._kept)

    # Objects.

    def put(
        self,
        label: str,
        x: float,
        y: float,
        degrees: float,
        zone: BaseGeometry | None = None,
        size: catalogue.Size | None = None,
        gap: float = MIN_GAP,
        above: float = 0.0,
    ) -> bool:
        """Places an object unless it would leave its zone, stand in a lane or touch another; returns whether it was
        placed."""
        size = size or self.size_of(label)
        stem = catalogue.STEMS.get(label)
        reach = stem.offset * size[0] / 2 if stem else 0.0
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        whole = box(x - reach * c, y - reach * s, degrees, size[0], size[1])
        foot = box(x, y, degrees, stem.side, stem.side) if stem else whole
        if zone is not None and not zone.contains(foot):
            return False
        if self._kept.intersects(foot) or self._solid.near(foot, gap):
            return False
        if size[2] > OVERHANG_HEIGHT and self._over.near(whole, 0.02):
            return False
        if not self._take(label, foot, whole, size):
            return False
        self.canvas.put(label, x, y, degrees, size=size, above=above)
        return True

    def size_of(self, label: str) -> catalogue.Size:
        return self.rng.choice(stock.SLIM if label == "tree" else stock.SIZES[label])

    def _take(
        self, label: str, foot: shapely.Polygon, whole: shapely.Polygon, size: catalogue.Size, house: bool = False
    ) -> bool:
        """Reserves an object's outline; returns False if a robot beside it would have more hulls in reach than
        slots."""
        near = foot.buffer(REACH, quad_segs=2)
        x0, y0, x1, y1 = near.bounds
        low = np.maximum(np.floor((np.array([x0, y0]) - self._origin) / CELL).astype(int), 0)
        high = np.maximum(np.ceil((np.array([x1, y1]) - self._origin) / CELL).astype(int) + 1, 0)
        part = self._hulls[low[0] : high[0], low[1] : high[1]]
        i, j = np.indices(part.shape)
        xs, ys = self._origin[0] + (low[0] + i) * CELL, self._origin[1] + (low[1] + j) * CELL
        inside = shapely.contains_xy(near, xs, ys) if part.size else np.zeros(part.shape, bool)
        hulls = stock.hulls(label, size, house)
        if not house and part.size and (part + hulls)[inside].max(initial=0) > MAX_HULLS_IN_REACH:
            return False
        part += hulls * inside
        self._solid.add(foot)
        if size[2] > OVERHANG_HEIGHT:
            self._over.add(whole)
        return True

    def scatter(self, zone: BaseGeometry, mix: str, per_100: float, tries: int = 8) -> int:
        """Scatters objects of a mix over a zone in any pose, `per_100` per 100 m² at full density; returns their
        number."""
        if zone.is_empty:
            return 0
        shapely.prepare(zone)
        x0, y0, x1, y1 = zone.bounds
        placed = 0
        for _ in range(round(self.density * per_100 * zone.area / 100.0)):
            label = self.rng.choice(stock.MIXES[mix])
            for _ in range(tries):
                x, y = self.uniform(x0, x1), self.uniform(y0, y1)
                if self.put(label, x, y, self.uniform(-180.0, 180.0), zone):
                    placed += 1
                    break
        return placed

    def lean(
        self,
        line: Sequence[Corner],
        mix: str | Sequence[str],
        apart: tuple[float, float],
        zone: BaseGeometry | None = None,
        off: float = 0.05,
        turn: float = 8.0,
        dense: bool = True,
    ) -> None:
        """Places objects along a line (m), their backs `off` metres to its left, facing away from it, with gaps of
        `apart` metres, longer at low density if `dense`."""
        labels = stock.MIXES[mix] if isinstance(mix, str) else mix
        loose = 1.0 / self.density if dense else 1.0
        for a, b in itertools.pairwise(line):
            length = math.dist(a, b)
            if length < 0.5:
                continue
            u, w = (b[0] - a[0]) / length, (b[1] - a[1]) / length
            facing = math.degrees(math.atan2(u, -w))
            s = self.uniform(0.0, apart[1])
            while s < length:
                label = self.rng.choice(labels)
                size = self.size_of(label)
                stem = catalogue.STEMS.get(label)
                deep, wide = (stem.side, stem.side) if stem else size[:2]
                angle = self.uniform(-turn, turn)
                away = off + deep / 2 + math.sin(math.radians(abs(angle))) * wide / 2
                middle = s + wide / 2
                x, y = a[0] + u * middle - w * away, a[1] + w * middle + u * away
                self.put(label, x, y, facing + angle, zone, size)
                s += wide + self.uniform(*apart) * loose

    def row(
        self,
        label: str,
        a: Corner,
        b: Corner,
        apart: float,
        zone: BaseGeometry | None = None,
        turn: float = 0.0,
        skip: float = 0.0,
    ) -> None:
        """Places the same object from one point to another, `apart` metres between middles, with a share `skip` left
        out."""
        length = math.dist(a, b)
        degrees = math.degrees(math.atan2(b[1] - a[1], b[0] - a[0])) + 90.0 + turn
        size = self.size_of(label)
        for i in range(int(length / apart) + 1):
            share = i * apart / length
            if self.uniform(0.0, 1.0) >= skip:
                self.put(label, a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share, degrees, zone, size, 0.02)
