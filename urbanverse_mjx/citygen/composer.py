"""`StreetComposer`: places things on a street by pavement side, distance from the kerb and facing."""

import math
import random
from collections.abc import Iterable, Sequence

import shapely
import shapely.ops

from ..datatypes import GraphObject, GroundRegion, SceneGraph, Source
from ..datatypes.ground import PAINT_KINDS, height_at
from . import catalogue, passage
from .section import CROSS_ARM, StreetSection, ground_regions

#: One authored placement: label, x (m), side (+1 left, -1 right), distance from the kerb (m), facing.
#: Facing is "street", "wall", "+x", "-x", or degrees counter-clockwise from +x.
Placement = tuple[str, float, int, float, str | float]

LEFT, RIGHT = 1, -1

JOINT = 0.01  # m between two house fronts, so that rounding to millimetres never makes them overlap


class StreetComposer:
    """Collects the objects of one street; `graph()` makes the noun."""

    def __init__(self, scene_id: str, section: StreetSection, seed: int) -> None:
        self.scene_id = scene_id
        self.section = section
        self.regions: list[GroundRegion] = ground_regions(section)
        self.objects: list[GraphObject] = []
        self._random = random.Random(seed)
        self._counts: dict[str, int] = {}
        carrying = [r for r in self.regions if r.kind not in PAINT_KINDS]
        self._planes = [(shapely.Polygon(r.polygon), r.plane) for r in carrying]

    def uniform(self, low: float, high: float) -> float:
        """A number from the street's own seeded stream; `random()` alone is stable over Python versions."""
        return low + (high - low) * self._random.random()

    def ground_height(self, x: float, y: float) -> float:
        """z (m) of the ground's top at a place; the highest where regions meet, the nearest beyond the edge."""
        point = shapely.Point(x, y)
        heights = [height_at(plane, x, y) for ring, plane in self._planes if ring.intersects(point)]
        if heights:
            return max(heights)
        ring, plane = min(self._planes, key=lambda entry: entry[0].distance(point))
        near = shapely.ops.nearest_points(ring, point)[0]
        return height_at(plane, near.x, near.y)

    def y_at(self, side: int, from_kerb: float) -> float:
        return side * (self.section.half + from_kerb)

    def _degrees(self, facing: str | float, side: int) -> float:
        if isinstance(facing, str):
            return {"street": -90.0 * side, "wall": 90.0 * side, "+x": 0.0, "-x": 180.0}[facing]
        return float(facing)

    def _number(self, label: str) -> int:
        return self._counts.get(label, 0)

    def next_size(self, label: str) -> catalogue.Size:
        """The size that the next thing of a label gets."""
        sizes = catalogue.SIZES[label]
        return sizes[self._number(label) % len(sizes)]

    def make(self, label: str, x: float, y: float, degrees: float, size: catalogue.Size | None = None) -> GraphObject:
        """The object that `put` would add: its stem, or else its middle, stands on the ground at (x, y)."""
        along, across, up = size or self.next_size(label)
        z = self.ground_height(x, y) + up / 2
        stem = catalogue.STEMS.get(label)
        if stem:
            ahead, angle = stem.offset * along / 2, math.radians(degrees)
            x, y = x - ahead * math.cos(angle), y - ahead * math.sin(angle)
        name = f"{label.replace(' ', '_')}_{self._number(label):02d}"
        center = (round(x, 3), round(y, 3), round(z, 4))
        return GraphObject(name, label, center, (along, across, up), passage.heading(degrees))

    def add(self, thing: GraphObject) -> GraphObject:
        self._counts[thing.label] = self._number(thing.label) + 1
        self.objects.append(thing)
        return thing

    def put(
        self,
        label: str,
        x: float,
        side: int,
        from_kerb: float,
        facing: str | float = "street",
        size: catalogue.Size | None = None,
    ) -> GraphObject:
        """Adds one thing `from_kerb` metres behind the kerb of a side (negative: on the road)."""
        return self.add(self.make(label, x, self.y_at(side, from_kerb), self._degrees(facing, side), size))

    def put_all(self, placements: Iterable[Placement]) -> None:
        for label, x, side, from_kerb, facing in placements:
            self.put(label, x, side, from_kerb, facing)

    def row(
        self,
        label: str,
        xs: Iterable[float],
        side: int,
        from_kerb: float,
        facing: str | float = "street",
        jitter: float = 0.0,
        size: catalogue.Size | None = None,
    ) -> None:
        """The same thing at several x; `jitter` (degrees) turns each a little."""
        for x in xs:
            turn = self.uniform(-jitter, jitter) if jitter else 0.0
            self.put(label, x, side, from_kerb, self._degrees(facing, side) + turn, size)

    def trees(self, xs: Iterable[float], side: int, from_kerb: float, growth: str = "street") -> None:
        """A row of trees, turned at random so that they look grown."""
        for x in xs:
            self.put("tree", x, side, from_kerb, self.uniform(-180, 180), catalogue.TREES[growth])

    def facades(self, side: int, labels: Sequence[str], x0: float | None = None, x1: float | None = None) -> None:
        """House fronts wall to wall along a side: frontages from the catalogue, stretched to fill it."""
        a, b = self.section.span()
        self._wall(labels, a if x0 is None else x0, b if x1 is None else x1, side)

    def _wall(self, labels: Sequence[str], x0: float, x1: float, side: int) -> None:
        sizes = self._frontages(labels, x1 - x0)
        x = x0
        for label, (depth, width, height) in zip(labels, sizes, strict=True):
            y = side * (self.section.front(side) + depth / 2)
            self.add(self.make(label, x + width / 2, y, -90.0 * side, (depth, round(width - JOINT, 3), height)))
            x += width

    def close_view(self, labels: Sequence[str], at_end: bool) -> None:
        """House fronts across one end of the street, facing along it."""
        kind = self.section.end if at_end else self.section.start
        margin = 0.0 if kind == "court" else CROSS_ARM
        y0, y1 = -self.section.front(-1) - margin, self.section.front(1) + margin
        edge, y = self.section.closing_x(at_end), y0
        for label, (depth, width, height) in zip(labels, self._frontages(labels, y1 - y0), strict=True):
            x = edge + (depth / 2 if at_end else -depth / 2)
            box = (depth, round(width - JOINT, 3), height)
            self.add(self.make(label, x, y + width / 2, 180.0 if at_end else 0.0, box))
            y += width
        if kind == "junction":
            self._close_cross_road(labels, at_end)

    def _close_cross_road(self, labels: Sequence[str], at_end: bool) -> None:
        """A house across each end of the cross road, so that no ray leaves the scene level."""
        edge = self.section.length if at_end else 0.0
        far = self.section.closing_x(at_end)
        for side, label in ((LEFT, labels[0]), (RIGHT, labels[-1])):
            (depth, width, height), *_ = self._frontages((label,), abs(far - edge))
            y = side * (self.section.front(side) + CROSS_ARM + depth / 2)
            self.add(self.make(label, (edge + far) / 2, y, -90.0 * side, (depth, round(width - JOINT, 3), height)))

    def _frontages(self, labels: Sequence[str], length: float) -> list[catalogue.Size]:
        """Depth, frontage and height (m) of each house, the frontages stretched to fill a length together."""
        counts: dict[str, int] = {}
        sizes = []
        for label in labels:
            options = catalogue.SIZES[label]
            sizes.append(options[(self._number(label) + counts.get(label, 0)) % len(options)])
            counts[label] = counts.get(label, 0) + 1
        stretch = length / sum(size[1] for size in sizes)
        return [(depth, width * stretch, height) for depth, width, height in sizes]

    def scatter(
        self, labels: Sequence[str], count: int, side: int, x: tuple[float, float], from_kerb: tuple[float, float]
    ) -> int:
        """Drops things at seeded places where they touch nothing and leave a passage; returns how many found one."""
        placed = 0
        for _ in range(40 * count):
            if placed == count:
                break
            label = labels[int(self.uniform(0, len(labels)))]
            y = self.y_at(side, self.uniform(*from_kerb))
            thing = self.make(label, self.uniform(*x), y, self.uniform(-180.0, 180.0))
            if self._fits(thing, side):
                self.add(thing)
                placed += 1
        return placed

    def _fits(self, thing: GraphObject, side: int) -> bool:
        shape = passage.footprint(thing).buffer(0.08)
        if any(passage.footprint(o).intersects(shape) for o in self.objects if passage.is_obstacle(o)):
            return False
        return self.passage_length(side, [*self.objects, thing]) >= self.section.length - 2 * passage.PASSAGE

    def passage_length(self, side: int, objects: Sequence[GraphObject] | None = None) -> float:
        """Metres of a side's pavement that a robot can pass in one go."""
        space = passage.free_space(self.regions, self.objects if objects is None else objects)
        return passage.reach_along(space, side * self.section.half, side * self.section.front(side))

    def paint(self, regions: Iterable[GroundRegion]) -> None:
        self.regions.extend(regions)

    def _tour(self) -> tuple[tuple[float, float, float, float], ...]:
        """A walk at eye level (1.6 m) along the middle of the right pavement, one point every 5 m."""
        y = -(self.section.half + self.section.right / 2)
        z = 0.15 + 1.6
        steps = math.floor(self.section.length / 5.0)
        return tuple((5.0 * i, round(y, 3), round(z, 3), 0.0) for i in range(steps + 1))

    def graph(self) -> SceneGraph:
        source = Source(video="synthetic", licence="Apache-2.0", city="none", country="none")
        return SceneGraph(self.scene_id, source, tuple(self.objects), tuple(self.regions), None, self._tour())
