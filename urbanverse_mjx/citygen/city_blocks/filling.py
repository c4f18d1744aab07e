"""`Filler`: places objects at free positions of a block and keeps a lane free for walking."""

import math
import random
from collections.abc import Sequence

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from ...datatypes import GraphObject
from .. import catalogue, clearance
from . import stock
from .ground import CROSSWALK_HALF, END_RAMP, Plan
from .line import Point

#: Labels that are placed along a narrow pavement instead of across it.
TWO_WHEELED = frozenset({"bicycle", "motorcycle", "scooter"})
#: m, least gap between two objects.
MIN_GAP = 0.06
#: m along the street between the points of a lane, and between its bends.
LANE_POINT_SPACING, LANE_BEND_SPACING = 2.0, 11.0
#: m kept free at both ends of the road.
END_CLEARANCE = 4.0
#: m kept free before and after a crosswalk.
MOUTH = CROSSWALK_HALF + 0.5


class Filler:
    """Collects the objects of a block.

    Positions are given as s (m along the street), side (+1 left, -1 right) and v (m from the kerb, negative on the
    road).
    """

    def __init__(self, plan: Plan, rng: random.Random) -> None:
        self.plan, self.rng, self.line = plan, rng, plan.line
        self.objects: list[GraphObject] = []
        self._counts: dict[str, int] = {}
        self._shapes: list[BaseGeometry] = []
        self._bounds: list[tuple[float, float, float, float]] = []
        self.blocked: dict[int, list[tuple[float, float]]] = {1: [], -1: []}
        self.lanes = {side: self._lane(side) for side in (1, -1) if plan.walked(side)}
        self._closed: list[BaseGeometry] = []

    def uniform(self, low: float, high: float) -> float:
        return low + (high - low) * self.rng.random()

    def chance(self, share: float) -> bool:
        return self.rng.random() < share

    # -- what stays free ------------------------------------------------------------------------------------------

    def _lane(self, side: int) -> list[Point]:
        """Returns the middle line (s, v) of a side's lane, which winds between kerb and houses."""
        plan = self.plan
        low = plan.verge(side) + plan.profile.lane / 2 + 0.1
        high = max(plan.width(side) - plan.profile.lane / 2 - 0.1, low)
        knots = np.arange(0.0, self.line.length + LANE_BEND_SPACING, LANE_BEND_SPACING)
        wanted, at = [], self.uniform(low, high)
        for _ in knots:
            wanted.append(at)
            at = min(max(at + self.uniform(-0.6, 0.6) * (high - low), low), high)
        s = np.arange(0.0, self.line.length + LANE_POINT_SPACING / 2, LANE_POINT_SPACING)
        return [(float(a), float(b)) for a, b in zip(s, np.interp(s, knots, wanted), strict=True)]

    def close_zones(self) -> None:
        """Reserves free areas: lanes except their blocked parts, crosswalks, mouths of side streets."""
        plan, zones = self.plan, []
        for side, lane in self.lanes.items():
            half = plan.profile.lane / 2
            run: list[Point] = []
            for s, v in [*lane, (math.inf, 0.0)]:
                shut = s == math.inf or any(a <= s <= b for a, b in self.blocked[side])
                if not shut:
                    run.append((s, v))
                elif run:
                    edges = [self.at(a, side, b - half) for a, b in run] + [
                        self.at(a, side, b + half) for a, b in reversed(run)
                    ]
                    if len(run) > 1:
                        zones.append(shapely.Polygon(edges).buffer(0))
                    run = []
        reach = plan.half + max(plan.profile.left, plan.profile.right)
        zones += [self._box(c - MOUTH, c + MOUTH, -reach, reach) for c in plan.crosswalks]
        for m in plan.side_streets:
            near, far = m.side * (plan.half - 1.5), m.side * (plan.half + plan.width(m.side) + 0.2)
            zones.append(self._box(m.begin - END_RAMP, m.end + END_RAMP, near, far))
        self._closed = zones

    def _box(self, s0: float, s1: float, t0: float, t1: float) -> shapely.Polygon:
        piece = self.line.piece_at((s0 + s1) / 2)
        return shapely.Polygon([self.line.place(s, t, piece) for s, t in ((s0, t0), (s1, t0), (s1, t1), (s0, t1))])

    # -- placing --------------------------------------------------------------------------------------------------

    def at(self, s: float, side: int, v: float) -> Point:
        return self.line.place(s, side * (self.plan.half + v))

    def level(self, side: int, s: float, v: float) -> float:
        """Returns the height z (m) of the ground away from ramps."""
        if v < 0 or (v < self.plan.front(side) and any(m.begin <= s <= m.end for m in self.plan.mouths(side))):
            return 0.0
        return self.plan.profile.kerb

    def degrees(self, facing: str | float, side: int, s: float) -> float:
        """Returns the world yaw in degrees for "street", "wall", "+", "-" (along or against the street), or for degrees
        relative to the street."""
        turn = {"street": -90.0 * side, "wall": 90.0 * side, "+": 0.0, "-": 180.0}
        relative = turn[facing] if isinstance(facing, str) else facing
        return math.degrees(self.line.yaw(s)) + relative

    def put(
        self,
        item: stock.Item,
        s: float,
        side: int,
        v: float,
        facing: str | float = "street",
        foot: float | None = None,
        free: bool = False,
        lane: bool = False,
    ) -> bool:
        """Adds an object if its position is free.

        Args:
          foot: m above the ground for a hanging object; None for one that stands. free: skip all checks. lane: the
            object may stand in the lane.
        """
        x, y = self.at(s, side, v)
        yaw = clearance.heading(self.degrees(facing, side, s))
        along, _, up = item.size
        stem = catalogue.STEMS.get(item.label)
        if stem:
            ahead = stem.offset * along / 2
            x, y = x - ahead * math.cos(yaw), y - ahead * math.sin(yaw)
        z = (foot or 0.0) + self.level(side, s, v) + up / 2
        number = self._counts.get(item.label, 0)
        name = f"{item.label.replace(' ', '_')}_{number:02d}"
        center = (round(x, 3), round(y, 3), round(z, 4))
        obj = GraphObject(name, item.label, center, item.size, yaw, 1.0, item.descriptor)
        shape = clearance.footprint(obj)
        if not free and not self._fits(shape, lane):
            return False
        if foot is None and clearance.is_obstacle(obj):
            self._shapes.append(shape)
            self._bounds.append(shape.bounds)
        self._counts[item.label] = number + 1
        self.objects.append(obj)
        return True

    def _fits(self, shape: BaseGeometry, lane: bool) -> bool:
        wide = shape.buffer(MIN_GAP)
        if not lane and any(zone.intersects(shape) for zone in self._closed):
            return False
        if not self._bounds:
            return True
        x0, y0, x1, y1 = np.array(self._bounds).T
        a0, b0, a1, b1 = wide.bounds
        near = np.flatnonzero((x0 < a1) & (x1 > a0) & (y0 < b1) & (y1 > b0))
        return not any(self._shapes[i].intersects(wide) for i in near)

    def somewhere(
        self,
        names: stock.Mix,
        side: int,
        band: str,
        facing: str | float | None = None,
        tries: int = 25,
        span: tuple[float, float] | None = None,
    ) -> bool:
        """Places one object of a mix at a free position of a band: "kerb", "wall" or "any"."""
        width, verge = self.plan.width(side), self.plan.verge(side)
        a, b = span or (1.0, self.line.length - 1.0)
        for _ in range(tries):
            item = stock.draw(stock.pick(names, self.rng), self.rng)
            s = self.uniform(a, b)
            stem = catalogue.STEMS.get(item.label)
            along, across = (stem.side, stem.side) if stem else item.size[:2]
            turned = facing
            if turned is None and item.label in TWO_WHEELED and band != "any" and width < 3.6:
                turned = "+" if self.chance(0.5) else "-"
            if turned is None:
                turned = self.uniform(-180, 180) if band == "any" else ("street" if band == "wall" else "wall")
            deep = along if turned in ("street", "wall") else across if turned in ("+", "-") else max(along, across)
            if band == "kerb":
                v = max(0.12 + deep / 2, self.uniform(0.2, max(verge, 0.5) - 0.1))
            elif band == "wall":
                v = width - 0.08 - deep / 2 - (self.uniform(0, 0.25) if width > 2.5 else 0.0)
            else:
                v = self.uniform(0.1 + deep / 2, max(width - deep / 2, 0.2 + deep / 2))
            turn = self.degrees(turned, side, s) - math.degrees(self.line.yaw(s))
            if self.put(item, s, side, v, turn + self.uniform(-4, 4)):
                return True
        return False

    def stretch(self, side: int, length: float, road: bool = False) -> float:
        """Returns a random start s of a free stretch of a side, away from crosswalks and mouths."""
        for _ in range(30):
            s = self.uniform(END_CLEARANCE, self.line.length - END_CLEARANCE - length)
            clear = all(c + MOUTH < s or c - MOUTH > s + length for c in self.plan.crosswalks)
            if clear and all(m.end + END_RAMP < s or m.begin - END_RAMP > s + length for m in self.plan.mouths(side)):
                return s
        return self.uniform(END_CLEARANCE, self.line.length - END_CLEARANCE - length)

    def sides(self) -> Sequence[int]:
        """Returns the sides whose pavements are walked on."""
        return tuple(self.lanes)
