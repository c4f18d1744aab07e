"""Where what is painted on roads lies: polygons by paint, in metres of the scene."""

import dataclasses
from collections.abc import Iterator, Sequence

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from ..ground import Region, traffic_turn
from .axis import STEP, Axis, axes
from .rules import RoadRules

#: m, widths of lines: centre and lanes, edges, bays, and of the lines of a crosswalk's ladder.
LINE, EDGE, BAY_LINE, LADDER = 0.12, 0.12, 0.10, 0.3
#: m, width of gutters; edge lines lie beyond them.
GUTTER = 0.3
#: m, between a crosswalk and its stop line.
_STOP_AWAY = 1.0
#: m; narrower carriageways have one lane, wider ones two a direction.
_BOTH_LANES, _FOUR_LANES = 4.9, 11.0
#: m, width of a parking lane, least length of a bay, what a bay is longer than its vehicle, and what stays free before
#: crosswalks and at corners.
_PARKING, _BAY, _BAY_ROOM, _BAY_AWAY = 2.0, 5.0, 0.9, 5.0
#: m; a vehicle whose middle is nearer to the kerb is parked.
_PARKED_WITHIN = 2.3
#: m of solid line before a crosswalk or a junction.
_SOLID = 9.0
#: m of carriageway beside parked vehicles in which two tracks of a tramway fit.
_TWO_TRACKS = 5.6
#: m from the middle of a track to its rails, their width, and the width of a tramway's bed.
_GAUGE, _RAIL, _BED = 0.7175, 0.07, 2.3


@dataclasses.dataclass(frozen=True)
class Mark:
    """Something painted or laid flat on the ground.

    Attributes:
      paint: a key of `drawing.PAINTS`.
      kind: kind of ground as which it is labelled.
      shape: (multi)polygon, m.
    """

    paint: str
    kind: str
    shape: BaseGeometry


@dataclasses.dataclass(frozen=True)
class Parked:
    """A vehicle: its middle (x, y), heading and length."""

    place: tuple[float, float]
    yaw: float
    length: float


@dataclasses.dataclass(frozen=True)
class Crossing:
    """A crosswalk in the direction of the traffic over it.

    Attributes:
      shape: its polygon.
      origin: (2,) m, its centre.
      along: (2,) unit vector of the traffic.
      low, high: (2,) m, extent along the traffic and to its left about the origin.
    """

    shape: shapely.Polygon
    origin: np.ndarray
    along: np.ndarray
    low: np.ndarray
    high: np.ndarray

    @property
    def left(self) -> np.ndarray:
        return np.array([-self.along[1], self.along[0]])

    def box(self, u0: float, u1: float, v0: float, v1: float) -> shapely.Polygon:
        """The rectangle u0..u1 along and v0..v1 to the left of the traffic."""
        return self.outline([(u0, v0), (u1, v0), (u1, v1), (u0, v1)])

    def outline(self, corners: Sequence[tuple[float, float]]) -> shapely.Polygon:
        at = np.asarray(corners)
        return shapely.Polygon(self.origin + at[:, :1] * self.along + at[:, 1:] * self.left)


@dataclasses.dataclass(frozen=True)
class Roads:
    """The roads of a scene.

    Attributes:
      road: union of the roads. carriageway: with the crosswalks.
      crossings: the crosswalks.
      axes: see `axis.axes`.
    """

    road: BaseGeometry
    carriageway: BaseGeometry
    crossings: tuple[Crossing, ...]
    axes: tuple[Axis, ...]


def find_roads(regions: Sequence[Region]) -> Roads:
    """Finds the roads of a scene in its ground."""
    by_kind = {k: [shapely.Polygon(r.polygon) for r in regions if r.kind == k] for k in ("road", "crosswalk")}
    road = shapely.union_all(by_kind["road"])
    joined = shapely.union_all([*by_kind["road"], *by_kind["crosswalk"]]).buffer(0.03).buffer(-0.03)
    crossings = [_crossing(r, regions) for r in regions if r.kind == "crosswalk"]
    return Roads(road, joined, tuple(crossings), tuple(axes(joined)) if by_kind["road"] else ())


def _crossing(region: Region, regions: Sequence[Region]) -> Crossing:
    turn = traffic_turn(region, regions)
    along = np.array([np.cos(turn), np.sin(turn)])
    shape = shapely.Polygon(region.polygon)
    origin = shapely.get_coordinates(shape.centroid)[0]
    away = np.asarray(region.polygon) - origin
    at = np.stack([away @ along, away @ np.array([-along[1], along[0]])], -1)
    return Crossing(shape, origin, along, at.min(0), at.max(0))


def marks(roads: Roads, rules: RoadRules, parked: Sequence[Parked], rng: np.random.Generator) -> list[Mark]:
    """Everything that lies on the roads, from below to above.

    Args:
      rng: decides where repaired places are.
    """
    streets = [lanes_of(axis, parked, rules) for axis in roads.axes]
    found = [m for lanes in streets for m in _surface(lanes, roads, rules, rng)]
    zone = shapely.union_all([c.shape for c in roads.crossings]).buffer(0.6) if roads.crossings else shapely.Point()
    for lanes in streets:
        lines = _lines(lanes, roads, rules)
        found += [dataclasses.replace(m, shape=m.shape.difference(zone)) for m in lines]
    for crossing in roads.crossings:
        found += _zebra(crossing, rules)
        found += _stop_lines(crossing, streets, roads, rules)
    found += [m for lanes in streets for m in _junctions(lanes, roads, rules)]
    if rules.tram:
        found += [m for lanes in streets for m in _rails(lanes, rules)]
    return [m for m in found if not m.shape.is_empty]


# Lanes ----------------------------------------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True)
class Lanes:
    """The lanes of a road: of what parking leaves free, the middle and the width as functions of half the road's width.

    Attributes:
      axis: middle of the road.
      vehicles: (s, side, length) of the vehicles parked along the kerbs, by s; side 1 is the left, -1 the right.
      parking: (left, right), whether there is a parking lane.
    """

    axis: Axis
    vehicles: tuple[tuple[float, int, float], ...]
    parking: tuple[bool, bool]

    def left(self, half: float) -> float:
        return half - (_PARKING if self.parking[0] else 0.0)

    def right(self, half: float) -> float:
        return -half + (_PARKING if self.parking[1] else 0.0)

    def middle(self, half: float) -> float:
        return (self.left(half) + self.right(half)) / 2

    def width(self, half: float) -> float:
        return self.left(half) - self.right(half)


def _parked_at(axis: Axis, parked: Sequence[Parked]) -> list[tuple[float, int, float]]:
    """See `Lanes.vehicles`."""
    if not parked:
        return []
    place = axis.project(np.array([p.place for p in parked]))
    found = []
    for (s, d), vehicle in zip(place, parked, strict=True):
        at = axis.points(np.array([s - 1, s + 1]), 0.0)
        along = at[1] - at[0]
        turned = np.sin(vehicle.yaw - np.arctan2(along[1], along[0]))
        kerb = axis.half_at(s) - abs(d)
        if 0.0 < s < axis.length and 0.2 < kerb < _PARKED_WITHIN and abs(turned) < 0.3:
            found.append((float(s), 1 if d > 0 else -1, vehicle.length))
    return sorted(found)


def lanes_of(axis: Axis, parked: Sequence[Parked], rules: RoadRules) -> Lanes:
    """The lanes of a road; two or more parked vehicles make a parking lane, where the country marks bays."""
    if rules.bay == "none":
        return Lanes(axis, (), (False, False))
    vehicles = tuple(_parked_at(axis, parked))
    sides = [side for _, side, _ in vehicles]
    return Lanes(axis, vehicles, (sides.count(1) >= 2, sides.count(-1) >= 2))


def _intervals(flags: np.ndarray) -> list[tuple[float, float]]:
    """First and last place (m along the axis) of each run of stations that are true."""
    edge = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(int), [0]])))
    return [(float(a) * STEP, float(b - 1) * STEP) for a, b in edge.reshape(-1, 2)]


def _spans(axis: Axis, roads: Roads, away: float) -> list[tuple[float, float]]:
    """Pieces of an axis (s0, s1) between its crosswalks, `away` m from them."""
    cut = []
    for crossing in roads.crossings:
        if _is_over(axis, crossing):
            s = axis.project(shapely.get_coordinates(crossing.shape))[:, 0]
            cut.append((float(s.min()) - away, float(s.max()) + away))
    spans, start = [], 0.0
    for a, b in sorted(cut):
        spans.append((start, a))
        start = b
    spans.append((start, axis.length))
    return [(a, b) for a, b in spans if b - a > 1.0]


def _is_over(axis: Axis, crossing: Crossing) -> bool:
    s, d = axis.project(crossing.origin[None])[0]
    return 0.5 < s < axis.length - 0.5 and abs(d) < 0.5 * axis.half_at(s)


def _lines(lanes: Lanes, roads: Roads, rules: RoadRules) -> Iterator[Mark]:
    axis = lanes.axis
    usual = float(np.median(axis.half))
    width = lanes.width(usual)
    for s0, s1 in _spans(axis, roads, 0.8):
        if width >= _BOTH_LANES and not (rules.tram and width < _TWO_TRACKS):
            yield from _centre(lanes, rules, s0, s1, width >= _FOUR_LANES)
        if width >= _FOUR_LANES:
            for share in (-0.25, 0.25):
                for a, b in _dashes(s0, s1, rules):
                    d = lanes.middle(usual) + share * width
                    yield _line("white", axis, a, b, d, LINE)
    yield from _edges(lanes, roads, rules)
    if rules.bay != "none":
        yield from _bays(lanes, roads, rules)
    if rules.approach in ("diamond", "zigzag"):
        for crossing in roads.crossings:
            if _is_over(axis, crossing):
                yield from _approaches(lanes, rules, crossing)


def _edges(lanes: Lanes, roads: Roads, rules: RoadRules) -> Iterator[Mark]:
    """Lines along the kerbs where nobody parks."""
    axis = lanes.axis
    for side, is_parking in ((1, lanes.parking[0]), (-1, lanes.parking[1])):
        shut = ~(axis.open_left if side > 0 else axis.open_right)
        for a, b in _intervals(shut):
            for s0, s1 in _spans(axis, roads, 1.5):
                low, high = max(a + 1.0, s0), min(b - 1.0, s1)
                if high - low > 2.0 and not is_parking:
                    yield from _edge(axis, side, rules, low, high)


def _line(paint: str, axis: Axis, s0: float, s1: float, d: float, width: float, kind: str = "road_marking") -> Mark:
    return Mark(paint, kind, axis.strip(s0, s1, d - width / 2, d + width / 2))


def _dashes(s0: float, s1: float, rules: RoadRules) -> list[tuple[float, float]]:
    """Pieces of a broken line: `_SOLID` m at each end without a gap, dashes between; one piece if no dash fits."""
    inner0, inner1 = s0 + _SOLID, s1 - _SOLID
    if inner1 - inner0 < rules.dash:
        return [(s0, s1)]
    period = rules.dash + rules.gap
    count = int((inner1 - inner0 - rules.gap) // period)
    start = (inner0 + inner1 - count * period + rules.gap) / 2
    dashes = [(start + k * period, start + k * period + rules.dash) for k in range(count)]
    return [(s0, inner0), *dashes, (inner1, s1)]


def _centre(lanes: Lanes, rules: RoadRules, s0: float, s1: float, wide: bool) -> Iterator[Mark]:
    axis = lanes.axis
    d = lanes.middle(float(np.median(axis.half)))
    if rules.centre_style == "double" or wide:
        for side in (-1, 1):
            yield _line(rules.centre, axis, s0, s1, d + side * LINE, LINE)
    elif rules.centre_style == "solid":
        yield _line(rules.centre, axis, s0, s1, d, LINE)
    else:
        for a, b in _dashes(s0, s1, rules):
            yield _line(rules.centre, axis, a, b, d, LINE)


def _edge(axis: Axis, side: int, rules: RoadRules, s0: float, s1: float) -> Iterator[Mark]:
    paint = "yellow" if "yellow" in rules.edge else "white"
    away = {"none": (), "double yellow": (0.1, 0.3)}.get(rules.edge, (0.2,))
    width = EDGE if len(away) == 1 else 0.08
    for inner in away:
        off = GUTTER + inner
        yield Mark(paint, "road_marking", axis.kerb_strip(side, s0, s1, off - width / 2, off + width / 2))


def _bays(lanes: Lanes, roads: Roads, rules: RoadRules) -> Iterator[Mark]:
    """Bays around the parked vehicles, and empty ones between them where one fits."""
    axis = lanes.axis
    spans = _spans(axis, roads, _BAY_AWAY)
    for side in (1, -1):
        shut = ~(axis.open_left if side > 0 else axis.open_right)
        vehicles = [(s, max(length + _BAY_ROOM, _BAY)) for s, of, length in lanes.vehicles if of == side]
        if len(vehicles) < 2:
            continue
        for bays in _rows(vehicles, spans, [(a + 3.0, b - 3.0) for a, b in _intervals(shut)]):
            for s0, s1 in bays:
                half = axis.half_at((s0 + s1) / 2)
                inner, outer = side * (half - _PARKING - 0.1), side * (half - GUTTER)
                reach = 0.45 if rules.bay == "tee" else (s1 - s0) / 2
                ends = ((s0, s0 + reach), (s1 - reach, s1))
                for a, b in ends:
                    yield _line(rules.bay_colour, axis, a, b, inner, BAY_LINE)
                deep = inner + (outer - inner) * (0.3 if rules.bay == "tee" else 1.0)
                for s in (s0, s1):
                    low, high = sorted((inner, deep))
                    shape = axis.strip(s - BAY_LINE / 2, s + BAY_LINE / 2, low, high)
                    yield Mark(rules.bay_colour, "road_marking", shape)


def _rows(
    vehicles: Sequence[tuple[float, float]], spans: Sequence[tuple[float, float]], shut: Sequence[tuple[float, float]]
) -> Iterator[list[tuple[float, float]]]:
    """Bays (s0, s1) in each piece of kerb that is free of crosswalks and openings."""
    for a, b in spans:
        for c, d in shut:
            low, high = max(a, c), min(b, d)
            inside = [(s, length) for s, length in vehicles if low < s < high]
            if not inside:
                continue
            bays: list[tuple[float, float]] = []
            for k, (s, length) in enumerate(inside):
                before = (inside[k - 1][0] + s) / 2 if k else low
                after = (s + inside[k + 1][0]) / 2 if k + 1 < len(inside) else high
                start, end = max(s - length / 2, before, low), min(s + length / 2, after, high)
                last = bays[-1][1] if bays else low
                free = int((start - last) // (_BAY + _BAY_ROOM)) if k or not bays else 0
                size = (start - last) / free if free else 0.0
                bays += [(last + n * size, last + (n + 1) * size) for n in range(free)]
                bays.append((start, end))
            yield [bay for bay in bays if bay[1] - bay[0] > 2.0]


def _approaches(lanes: Lanes, rules: RoadRules, crossing: Crossing) -> Iterator[Mark]:
    """Diamonds 30 and 50 m before a crosswalk, as far as the road is long, or zigzag lines along the lane."""
    axis = lanes.axis
    s = axis.project(shapely.get_coordinates(crossing.shape))[:, 0]
    half = float(np.median(axis.half))
    width, middle = lanes.width(half), lanes.middle(half)
    for sense in (1, -1) if width >= _BOTH_LANES else (1,):
        side = (-1 if rules.traffic == "right" else 1) * sense
        lane = middle + side * width / 4 if width >= _BOTH_LANES else middle
        reach = width / 4 if width >= _BOTH_LANES else width / 2
        start = float(s.min()) if sense > 0 else float(s.max())
        if rules.approach == "diamond":
            for away in (30.0, 50.0):
                at = start - sense * away
                if 4.0 < at < axis.length - 4.0:
                    yield Mark("white", "road_marking", _diamond(axis, at, lane))
        else:
            for d in (lane - reach + 0.4, lane + reach - 0.4):
                yield from _zigzag(axis, start - sense * 2.0, -sense, d)


def _diamond(axis: Axis, s: float, d: float) -> BaseGeometry:
    def ring(grow: float) -> BaseGeometry:
        long, wide = 2.5 - 2.2 * grow, 0.75 - grow
        return axis.shape(np.array([(s - long, d), (s, d - wide), (s + long, d), (s, d + wide)]))

    return ring(0.0).difference(ring(0.22))


def _zigzag(axis: Axis, s: float, sense: int, d: float) -> Iterator[Mark]:
    corners = [axis.points(s + sense * 2.0 * k, d + (0.22 if k % 2 else -0.22)) for k in range(9)]
    if 1.0 < s + sense * 17.0 < axis.length - 1.0:
        yield Mark(
            "white", "road_marking", shapely.LineString(corners).buffer(0.06, cap_style="flat", join_style="mitre")
        )


# Crosswalks -----------------------------------------------------------------------------------------------------------


def _zebra(crossing: Crossing, rules: RoadRules) -> Iterator[Mark]:
    """Bars along the traffic, alike on both sides of the middle."""
    (u0, v0), (u1, v1) = crossing.low, crossing.high
    u0, u1 = u0 + 0.15, u1 - 0.15
    period = rules.bar + rules.bar_gap
    count = int((v1 - v0 - 0.3 + rules.bar_gap) // period)
    first = (v0 + v1 - count * period + rules.bar_gap) / 2
    if rules.zebra_style == "ladder":
        for u in (u0, u1 - LADDER):
            yield Mark(rules.zebra, "crosswalk", crossing.box(u, u + LADDER, v0 + 0.15, v1 - 0.15))
        u0, u1 = u0 + LADDER, u1 - LADDER
    for k in range(count):
        v = first + k * period
        yield Mark(rules.zebra, "crosswalk", crossing.box(u0, u1, v, v + rules.bar).intersection(crossing.shape))
        if rules.between and k + 1 < count:
            shape = crossing.box(u0, u1, v + rules.bar, v + period).intersection(crossing.shape)
            yield Mark(rules.between, "crosswalk", shape)


def _stop_lines(crossing: Crossing, streets: Sequence[Lanes], roads: Roads, rules: RoadRules) -> Iterator[Mark]:
    """A stop line, or teeth, for the lane that comes to a crosswalk."""
    over = [lanes for lanes in streets if _is_over(lanes.axis, crossing)]
    (u0, v0), (u1, v1) = crossing.low, crossing.high
    v0, v1 = v0 + GUTTER, v1 - GUTTER
    both_lanes = v1 - v0 >= _BOTH_LANES - GUTTER
    forward = 1
    for lanes in over:
        ahead = lanes.axis.project(np.stack([crossing.origin, crossing.origin + crossing.along]))[:, 0]
        forward = 1 if ahead[1] > ahead[0] else -1
        half = lanes.axis.half_at(float(ahead[0]))
        both_lanes = lanes.width(half) >= _BOTH_LANES
        # Left and right of the axis, which may run against the crossing's direction.
        sides = (lanes.right(half), lanes.left(half)) if forward > 0 else (-lanes.left(half), -lanes.right(half))
        v0, v1 = max(v0, sides[0]), min(v1, sides[1])
    for sense in (1, -1):  # of the vehicle
        edge = u0 if sense > 0 else u1
        before = crossing.origin + (edge - sense * 3.0) * crossing.along
        if not over and any(_comes_from(axis, before, crossing) for axis in roads.axes):
            continue
        if not both_lanes and over and sense != forward:
            continue
        right = (rules.traffic == "right") == (sense > 0)
        middle = (v0 + v1) / 2
        low, high = ((v0, middle - 0.1) if right else (middle + 0.1, v1)) if both_lanes else (v0, v1)
        near, far = edge - sense * _STOP_AWAY, edge - sense * (_STOP_AWAY + rules.stop)
        if rules.approach == "teeth":
            teeth = [
                crossing.outline([(near, v), (near, v + 0.5), (near - sense * 0.6, v + 0.25)])
                for v in np.arange(low + 0.1, high - 0.5, 0.75)
            ]
            yield Mark("white", "road_marking", shapely.union_all(teeth).intersection(roads.road))
        elif rules.stop > 0.0:
            shape = crossing.box(min(near, far), max(near, far), low, high)
            yield Mark("white", "road_marking", shape.intersection(roads.road))


def _comes_from(axis: Axis, place: np.ndarray, crossing: Crossing) -> bool:
    """Whether a place beside a crosswalk of a side street lies towards a road."""
    here, there = axis.project(np.stack([crossing.origin, place]))
    return 0.0 < here[0] < axis.length and abs(there[1]) < abs(here[1])


def _junctions(lanes: Lanes, roads: Roads, rules: RoadRules) -> Iterator[Mark]:
    """Stop lines and arrows where a road meets another at its end."""
    axis, half = lanes.axis, float(np.median(lanes.axis.half))
    width, middle = lanes.width(half), lanes.middle(half)
    for end, sense in ((0.0, -1), (axis.length, 1)):
        beyond = axis.points(end, 0.0) + 3.0 * (axis.points(end, 0.0) - axis.points(end - sense, 0.0))
        if not shapely.contains_xy(roads.carriageway, *beyond) or (width < _BOTH_LANES and sense < 0):
            continue
        side = (-1 if rules.traffic == "right" else 1) * sense
        stop = end - sense * 0.5
        s0, s1 = sorted((stop, stop - sense * max(rules.stop, 0.3)))
        low, high = lanes.right(half) + GUTTER, lanes.left(half) - GUTTER
        if width >= _BOTH_LANES:
            low, high = (low, middle - 0.15) if side < 0 else (middle + 0.15, high)
        yield Mark("white", "road_marking", axis.strip(s0, s1, low, high).intersection(roads.road))
        if high - low >= 1.8:
            shape = _arrow(axis, stop - sense * 9.0, (low + high) / 2, sense)
            yield Mark("white", "road_marking", shape.intersection(roads.road))


def _arrow(axis: Axis, s: float, d: float, sense: int) -> BaseGeometry:
    """An arrow straight on, 4.5 m long, whose tip points along `sense`."""
    outline = [(0, 0.08), (2.7, 0.08), (2.7, 0.42), (4.5, 0), (2.7, -0.42), (2.7, -0.08), (0, -0.08)]
    return axis.shape(np.array([(s + sense * u, d + v) for u, v in outline]))


# Below the paint ------------------------------------------------------------------------------------------------------


def _surface(lanes: Lanes, roads: Roads, rules: RoadRules, rng: np.random.Generator) -> Iterator[Mark]:
    """Wheel tracks, trenches and patches."""
    axis, half = lanes.axis, float(np.median(lanes.axis.half))
    middle, width = lanes.middle(half), lanes.width(half)
    for lane in (middle - width / 4, middle + width / 4) if width >= _BOTH_LANES else (middle,):
        for d in (lane - 0.75, lane + 0.75):
            yield Mark(
                "track", "road", axis.strip(0.0, axis.length, d - 0.28, d + 0.28).intersection(roads.carriageway)
            )
    for _ in range(round(rules.patches * axis.length / 100.0)):
        s, d = rng.uniform(4.0, axis.length - 4.0), rng.uniform(-half + 1.0, half - 1.0)
        long, wide = rng.uniform(0.8, 4.0), rng.uniform(0.5, 1.4)
        shape = axis.strip(s - long / 2, s + long / 2, d - wide / 2, d + wide / 2)
        if rng.random() < 0.25:  # a trench across the road
            shape = axis.strip(s - 0.35, s + 0.35, -half + GUTTER, half - GUTTER)
        shape = shape.intersection(roads.road)
        paint = "patch" if rng.random() < 0.7 else "pale patch"
        yield Mark("seam", "road", shape.buffer(0.04, join_style="mitre").difference(shape).intersection(roads.road))
        yield Mark(paint, "road", shape)


def _rails(lanes: Lanes, rules: RoadRules) -> Iterator[Mark]:
    """Two tracks, one per direction, if the road is wide enough; otherwise one."""
    axis, half = lanes.axis, float(np.median(lanes.axis.half))
    width, middle = lanes.width(half), lanes.middle(half)
    tracks = (middle - width / 4, middle + width / 4) if width >= _TWO_TRACKS else (middle,)
    for track in tracks:
        if rules.tram_bed:
            yield Mark("bed", "road", axis.strip(0.0, axis.length, track - _BED / 2, track + _BED / 2))
    for track in tracks:
        for side in (-1, 1):
            d = track + side * _GAUGE
            yield _line("steel", axis, 0.0, axis.length, d, _RAIL, "road")
            yield _line("groove", axis, 0.0, axis.length, d - side * (_RAIL + 0.04) / 2, 0.04, "road")
