"""`StreetComposer`: places objects on a street by pavement side, distance from the kerb and facing."""

import math
from collections.abc import Iterable, Sequence

from ..datatypes import GraphObject, GroundRegion, SceneGraph
from . import catalogue, clearance
from .section import CROSS_ROAD_LENGTH, StreetSection, ground_regions
from .stage import JOINT, Stage

#: One manual placement: label, x (m), side (+1 left, -1 right), distance from the kerb (m), facing. Facing is "street",
#: "wall", "+x", "-x", or degrees counter-clockwise from +x.
Placement = tuple[str, float, int, float, str | float]

LEFT, RIGHT = 1, -1


class StreetComposer(Stage):
    """Collects the objects of one street; `graph()` makes the scene graph."""

    def __init__(self, scene_id: str, section: StreetSection, seed: int) -> None:
        super().__init__(scene_id, seed)
        self.section = section
        self.lay(ground_regions(section))

    def y_at(self, side: int, from_kerb: float) -> float:
        return side * (self.section.half + from_kerb)

    def _degrees(self, facing: str | float, side: int) -> float:
        if isinstance(facing, str):
            return {"street": -90.0 * side, "wall": 90.0 * side, "+x": 0.0, "-x": 180.0}[facing]
        return float(facing)

    def put(
        self,
        label: str,
        x: float,
        side: int,
        from_kerb: float,
        facing: str | float = "street",
        size: catalogue.Size | None = None,
    ) -> GraphObject:
        """Adds one object `from_kerb` metres behind the kerb of a side (negative: on the road)."""
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
        """Adds the same object at several x; `jitter` (degrees) is the range of a random rotation."""
        for x in xs:
            turn = self.uniform(-jitter, jitter) if jitter else 0.0
            self.put(label, x, side, from_kerb, self._degrees(facing, side) + turn, size)

    def trees(self, xs: Iterable[float], side: int, from_kerb: float, growth: str = "street") -> None:
        """Adds a row of trees, rotated at random."""
        for x in xs:
            self.put("tree", x, side, from_kerb, self.uniform(-180, 180), catalogue.TREES[growth])

    def facades(self, side: int, labels: Sequence[str], x0: float | None = None, x1: float | None = None) -> None:
        """Adds house fronts without gaps along a side, with frontages of the catalogue stretched to fill it."""
        a, b = self.section.span()
        self._wall(labels, a if x0 is None else x0, b if x1 is None else x1, side)

    def _wall(self, labels: Sequence[str], x0: float, x1: float, side: int) -> None:
        sizes = self.frontages(labels, x1 - x0)
        x = x0
        for label, (depth, width, height) in zip(labels, sizes, strict=True):
            y = side * (self.section.front(side) + depth / 2)
            self.add(self.make(label, x + width / 2, y, -90.0 * side, (depth, round(width - JOINT, 3), height)))
            x += width

    def close_view(self, labels: Sequence[str], at_end: bool) -> None:
        """Adds house fronts across one end of the street, facing along it."""
        kind = self.section.end if at_end else self.section.start
        margin = 0.0 if kind == "court" else CROSS_ROAD_LENGTH
        y0, y1 = -self.section.front(-1) - margin, self.section.front(1) + margin
        edge, y = self.section.closing_x(at_end), y0
        for label, (depth, width, height) in zip(labels, self.frontages(labels, y1 - y0), strict=True):
            x = edge + (depth / 2 if at_end else -depth / 2)
            box = (depth, round(width - JOINT, 3), height)
            self.add(self.make(label, x, y + width / 2, 180.0 if at_end else 0.0, box))
            y += width
        if kind == "junction":
            self._close_cross_road(labels, at_end)

    def _close_cross_road(self, labels: Sequence[str], at_end: bool) -> None:
        """Adds a house across each end of the cross road, so that no horizontal ray leaves the scene."""
        edge = self.section.length if at_end else 0.0
        far = self.section.closing_x(at_end)
        for side, label in ((LEFT, labels[0]), (RIGHT, labels[-1])):
            (depth, width, height), *_ = self.frontages((label,), abs(far - edge))
            y = side * (self.section.front(side) + CROSS_ROAD_LENGTH + depth / 2)
            self.add(self.make(label, (edge + far) / 2, y, -90.0 * side, (depth, round(width - JOINT, 3), height)))

    def scatter(
        self, labels: Sequence[str], count: int, side: int, x: tuple[float, float], from_kerb: tuple[float, float]
    ) -> int:
        """Places objects at random positions without contact and with a passage left free; returns their number."""
        placed = 0
        for _ in range(40 * count):
            if placed == count:
                break
            label = labels[int(self.uniform(0, len(labels)))]
            y = self.y_at(side, self.uniform(*from_kerb))
            obj = self.make(label, self.uniform(*x), y, self.uniform(-180.0, 180.0))
            if self._fits(obj, side):
                self.add(obj)
                placed += 1
        return placed

    def _fits(self, obj: GraphObject, side: int) -> bool:
        shape = clearance.footprint(obj).buffer(0.08)
        if any(clearance.footprint(o).intersects(shape) for o in self.objects if clearance.is_obstacle(o)):
            return False
        return self.clear_length(side, [*self.objects, obj]) >= self.section.length - 2 * clearance.CLEARANCE

    def clear_length(self, side: int, objects: Sequence[GraphObject] | None = None) -> float:
        """Returns the length (m) of a side's pavement that a robot can traverse without interruption."""
        space = clearance.free_space(self.regions, self.objects if objects is None else objects)
        return clearance.reach_along(space, side * self.section.half, side * self.section.front(side))

    def paint(self, regions: Iterable[GroundRegion]) -> None:
        self.lay(regions)

    def _trajectory(self) -> tuple[tuple[float, float, float, float], ...]:
        """Returns a walk at eye level (1.6 m) along the middle of the right pavement, one point every 5 m."""
        y = -(self.section.half + self.section.right / 2)
        z = 0.15 + 1.6
        steps = math.floor(self.section.length / 5.0)
        return tuple((5.0 * i, round(y, 3), round(z, 3), 0.0) for i in range(steps + 1))

    def graph(self) -> SceneGraph:
        return SceneGraph(
            self.scene_id, self.source, tuple(self.objects), tuple(self.regions), None, self._trajectory()
        )
