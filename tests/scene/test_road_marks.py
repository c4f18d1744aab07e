"""Marks of straight roads whose places are worked out by hand, in the road's own metres; the road lies askew."""

import dataclasses
import itertools
from collections.abc import Iterable, Sequence

import numpy as np
import pytest
import shapely
from shapely import affinity
from shapely.geometry.base import BaseGeometry

from urbanverse_mjx.datatypes import PlacedGround
from urbanverse_mjx.scene.roads import Parked, RoadRules
from urbanverse_mjx.scene.roads.axis import Axis
from urbanverse_mjx.scene.roads.markings import Mark, Roads, find_roads, lanes_of, marks

#: Where the road begins, m, and its direction, rad: nothing depends on them.
ORIGIN, TURN = np.array([40.0, -25.0]), np.radians(30.0)
LENGTH = 120.0
Box = tuple[float, float, float, float]


class Draws:
    """Stands for NumPy's generator: the given shares of each range, in turn."""

    def __init__(self, shares: Iterable[float] = ()) -> None:
        self._shares = iter(shares)

    def uniform(self, low: float, high: float) -> float:
        return low + next(self._shares) * (high - low)

    def random(self) -> float:
        return next(self._shares)


def placed(corners: Sequence[tuple[float, float]] | np.ndarray) -> np.ndarray:
    """Places of the scene of (s, d) m."""
    along = np.array([np.cos(TURN), np.sin(TURN)])
    at = np.asarray(corners, float)
    return ORIGIN + at[:, :1] * along + at[:, 1:] * np.array([-along[1], along[0]])


def of_road(shape: BaseGeometry) -> BaseGeometry:
    """A shape of the scene in (s, d) m."""
    moved = affinity.translate(shape, *(-ORIGIN))
    return affinity.rotate(moved, -TURN, origin=(0.0, 0.0), use_radians=True)


def rectangle(s0: float, s1: float, d0: float, d1: float) -> np.ndarray:
    return placed([(s0, d0), (s1, d0), (s1, d1), (s0, d1)])


def region(name: str, kind: str, box: Box) -> PlacedGround:
    corners = tuple((float(x), float(y)) for x, y in rectangle(*box))
    return PlacedGround(name, kind, corners, (0.0, 0.0, 0.0), "asphalt_old")


def street(half: float, crosswalk: bool = True, open_left: tuple[int, int] = (0, 0), beyond: float = 10.0) -> Roads:
    """A road of 120 m, at s = 58 to 62 a crosswalk; stations at which a side street opens on its left; it goes on so
    many metres beyond the ends of its axis, as a junction does."""
    pieces = [(-beyond, 58.0), (62.0, LENGTH + beyond)] if crosswalk else [(-beyond, LENGTH + beyond)]
    ground = [region(f"road{n}", "road", (a, b, -half, half)) for n, (a, b) in enumerate(pieces)]
    if crosswalk:
        ground.append(region("crosswalk", "crosswalk", (58.0, 62.0, -half, half)))
    found = find_roads(ground)
    stations = np.arange(LENGTH + 1)
    normal = np.tile([-np.sin(TURN), np.cos(TURN)], (len(stations), 1))
    opens = (stations >= open_left[0]) & (stations < open_left[1])
    middle = placed(np.stack([stations, 0.0 * stations], -1))
    axis = Axis(middle, normal, np.full(len(stations), half), opens, np.zeros(len(stations), bool))
    return Roads(found.road, found.carriageway, found.crossings, (axis,))


def made(roads: Roads, parked: Sequence[Parked] = (), draws: Iterable[float] = (), **rules: object) -> list[Mark]:
    plain: dict[str, object] = {"patches": 0.0, "bay": "none", "stop": 0.0, "edge": "none"}
    return marks(roads, RoadRules(**{**plain, **rules}), parked, Draws(draws))  # type: ignore[arg-type]


def boxes(found: Sequence[Mark], paint: str, kind: str = "road_marking") -> list[Box]:
    """Extents (s0, s1, d0, d1) of the rectangles of a paint; those of other forms are left out."""
    rows = []
    for mark in found:
        for part in shapely.get_parts(mark.shape) if (mark.paint, mark.kind) == (paint, kind) else ():
            piece = of_road(part)
            s0, d0, s1, d1 = piece.bounds
            if piece.area > 0.999 * (s1 - s0) * (d1 - d0):
                rows.append((s0, s1, d0, d1))
    return rows


def same(found: Sequence[Box], expected: Sequence[Box]) -> None:
    rows = [np.array(sorted(np.round(boxes, 3).tolist())).reshape(-1, 4) for boxes in (found, expected)]
    assert rows[0].shape == rows[1].shape, f"found {rows[0].tolist()}"
    np.testing.assert_allclose(rows[0], rows[1], atol=2e-3)


def dashes(start: float, d: float) -> list[Box]:
    """Of 3 m every 7.5 m between 9 m of solid line at both ends of 57.2 m: four, in the middle of the 39.2 m left."""
    ends = [(start, start + 9.0), (start + 48.2, start + 57.2)]
    broken = [(start + 15.85 + 7.5 * k, start + 18.85 + 7.5 * k) for k in range(4)]
    return [(a, b, d - 0.06, d + 0.06) for a, b in ends + broken]


def test_two_lanes_with_a_crosswalk_between_two_junctions() -> None:
    roads = street(4.5, open_left=(80, 91))
    found = made(roads, edge="white", stop=0.4)
    lanes = [(0.0, LENGTH, d - 0.28, d + 0.28) for d in (-3.0, -1.5, 1.5, 3.0)]
    assert [m.kind for m in found[:4]] == ["road"] * 4, "what lies below comes first"
    # Wheels also run over the crosswalk.
    same(boxes(found, "track", "road"), lanes)
    centre = dashes(0.0, 0.0) + dashes(62.8, 0.0)
    edges = [(1.0, 56.5, -4.06, -3.94), (63.5, 119.0, -4.06, -3.94)]
    edges += [(a, b, 3.94, 4.06) for a, b in ((1.0, 56.5), (63.5, 78.0), (92.0, 119.0))]
    stops = [(56.6, 57.0, -4.2, -0.1), (63.0, 63.4, 0.1, 4.2), (0.5, 0.9, 0.15, 4.2), (119.1, 119.5, -4.2, -0.15)]
    same(boxes(found, "white"), centre + edges + stops)
    bars = [(58.15, 61.85, -4.25 + k, -3.75 + k) for k in range(9)]
    same(boxes(found, "white", "crosswalk"), bars)
    arrows = [of_road(m.shape) for m in found if m.shape.area == pytest.approx(2.7 * 0.16 + 0.5 * 1.8 * 0.84, abs=1e-6)]
    (east, west) = sorted(arrows, key=lambda shape: -shape.bounds[0])
    np.testing.assert_allclose(east.bounds, (110.5, -2.175 - 0.42, 115.0, -2.175 + 0.42), atol=1e-6)
    np.testing.assert_allclose(west.bounds, (5.0, 2.175 - 0.42, 9.5, 2.175 + 0.42), atol=1e-6)
    # Their wide ends are ahead: the middle of their area lies beyond that of their extent.
    assert east.centroid.x > 112.75
    assert west.centroid.x < 7.25
    assert len(found) == len(lanes + centre + edges + stops + bars) + 2


def test_traffic_on_the_left_has_its_lines_on_the_other_half() -> None:
    found = made(street(4.5), traffic="left", stop=0.5)
    stops = [box for box in boxes(found, "white") if box[1] - box[0] < 0.6]
    expected = [(56.5, 57.0, 0.1, 4.2), (63.0, 63.5, -4.2, -0.1), (0.5, 1.0, -4.2, -0.15), (119.0, 119.5, 0.15, 4.2)]
    same(stops, expected)


def test_a_road_that_ends_without_a_junction_has_nothing_at_its_ends() -> None:
    found = made(street(4.5, beyond=1.0), stop=0.4)
    assert all(3.0 < box[0] < 117.0 or box[1] - box[0] > 5.0 for box in boxes(found, "white"))
    assert not any(m.shape.area == pytest.approx(1.188, abs=1e-6) for m in found)


def test_a_single_lane_has_stops_across_it_for_one_direction() -> None:
    """Below 4.9 m nobody can pass: no centre line, one pair of tracks, traffic along the axis alone."""
    found = made(street(2.4), stop=0.4)
    same(boxes(found, "track", "road"), [(0.0, LENGTH, d - 0.28, d + 0.28) for d in (-0.75, 0.75)])
    same(boxes(found, "white"), [(56.6, 57.0, -2.1, 2.1), (119.1, 119.5, -2.1, 2.1)])
    assert boxes(made(street(2.5)), "white"), "5 m hold two lanes"


def test_four_lanes_with_double_lines() -> None:
    found = made(street(6.0), edge="double yellow", centre="yellow", zebra="white", between="red", bar=0.4, bar_gap=0.6)
    spans = ((0.0, 57.2), (62.8, 120.0))
    yellow = [(a, b, d - 0.06, d + 0.06) for a, b in spans for d in (-0.12, 0.12)]
    for s0, s1 in ((1.0, 56.5), (63.5, 119.0)):
        yellow += [(s0, s1, side * d - 0.04, side * d + 0.04) for side in (-1, 1) for d in (5.6, 5.4)]
    same(boxes(found, "yellow"), yellow)
    lanes = [box for s0, _ in spans for d in (-3.0, 3.0) for box in dashes(s0, d)]
    stops = [(0.5, 0.8, 0.15, 5.7), (119.2, 119.5, -5.7, -0.15)]
    same(boxes(found, "white"), lanes + stops)
    # 12 m hold 12 bars of 0.4 m every metre, and what is between them.
    same(boxes(found, "white", "crosswalk"), [(58.15, 61.85, -5.7 + k, -5.3 + k) for k in range(12)])
    same(boxes(found, "red", "crosswalk"), [(58.15, 61.85, -5.3 + k, -4.7 + k) for k in range(11)])
    tracks = [(0.0, LENGTH, d - 0.28, d + 0.28) for d in (-3.75, -2.25, 2.25, 3.75)]
    same(boxes(found, "track", "road"), tracks)


@pytest.mark.parametrize(("style", "offsets"), [("double", (-0.12, 0.12)), ("solid", (0.0,))])
def test_centre_lines_without_gaps(style: str, offsets: tuple[float, ...]) -> None:
    found = made(street(3.5, crosswalk=False, beyond=1.0), centre="yellow", centre_style=style, edge="yellow")
    same(
        boxes(found, "yellow"),
        [(0.0, LENGTH, d - 0.06, d + 0.06) for d in offsets] + [(1.0, 119.0, s - 0.06, s + 0.06) for s in (-3.0, 3.0)],
    )


def test_a_ladder_has_a_line_across_at_both_ends_of_its_bars() -> None:
    found = made(street(4.5), zebra_style="ladder")
    ends = [(58.15, 58.45, -4.35, 4.35), (61.55, 61.85, -4.35, 4.35)]
    same(boxes(found, "white", "crosswalk"), ends + [(58.45, 61.55, -4.25 + k, -3.75 + k) for k in range(9)])


@pytest.mark.parametrize(("traffic", "side"), [("right", -1), ("left", 1)])
def test_diamonds_lie_in_the_lane_30_and_50_metres_before_a_crosswalk(traffic: str, side: int) -> None:
    found = made(street(4.5), traffic=traffic, approach="diamond")
    outer, inner = 2 * 2.5 * 0.75, 2 * (2.5 - 2.2 * 0.22) * (0.75 - 0.22)
    shapes = [of_road(m.shape) for m in found if m.shape.area == pytest.approx(outer - inner, abs=1e-6)]
    centres = sorted(tuple(np.round(shapely.get_coordinates(s.centroid)[0], 4).tolist()) for s in shapes)
    expected = [(8.0, 2.25 * side), (28.0, 2.25 * side), (92.0, -2.25 * side), (112.0, -2.25 * side)]
    assert centres == sorted(expected)
    for shape in shapes:
        s0, d0, s1, d1 = shape.bounds
        assert (s1 - s0, d1 - d0) == (pytest.approx(5.0, abs=1e-6), pytest.approx(1.5, abs=1e-6))
    narrow = [of_road(m.shape) for m in made(street(2.2), approach="diamond")]
    narrow = [s for s in narrow if s.area == pytest.approx(outer - inner, abs=1e-6)]
    assert sorted(round(s.centroid.x, 4) for s in narrow) == [8.0, 28.0]
    np.testing.assert_allclose([s.centroid.y for s in narrow], 0.0, atol=1e-6)


def test_zigzag_lines_run_along_both_sides_of_the_lane() -> None:
    """Eight strokes of 2 m and 0.44 m aside, from 2 m before the crosswalk on, 0.4 m inside the lane."""
    found = [of_road(m.shape) for m in made(street(4.5), approach="zigzag")]
    long = [s for s in found if s.area < 0.5 * s.envelope.area and 10.0 < s.bounds[2] - s.bounds[0] < 17.0]
    expected = [(40.0, 56.0, -4.1), (40.0, 56.0, -0.4), (64.0, 80.0, 0.4), (64.0, 80.0, 4.1)]
    assert len(long) == 4
    for s0, s1, d in expected:
        (shape,) = [s for s in long if abs(s.centroid.y - d) < 0.1 and s0 - 0.1 < s.centroid.x < s1 + 0.1]
        np.testing.assert_allclose(shape.bounds, (s0, d - 0.28, s1, d + 0.28), atol=0.02)
        first, sense = (s1, -1) if s1 < 60.0 else (s0, 1)
        corners = [(first + sense * 2.0 * k, d + (0.22 if k % 2 else -0.22)) for k in range(9)]
        assert shape.buffer(1e-3).contains(shapely.LineString(corners))
        assert shape.area == pytest.approx(8 * np.hypot(2.0, 0.44) * 0.12, rel=0.02)


@pytest.mark.parametrize("place", [21.6, 22.4, 35.6, 36.4, 55.6, 56.4, 63.6, 64.4, 83.6, 84.4, 97.6, 98.4])
@pytest.mark.parametrize("approach", ["zigzag", "diamond"])
def test_what_announces_a_crosswalk_stays_on_its_road(place: float, approach: str) -> None:
    """Zigzag lines end more than 2 m before the end of the road, diamonds lie more than 1.5 m from it; what does not
    fit is left out, at any distance of the crosswalk from the ends."""
    whole = street(4.5)
    shift = place - 60.0
    stations = np.arange(LENGTH + 1)
    (axis,) = whole.axes
    moved = dataclasses.replace(axis, middle=placed(np.stack([stations - shift, 0.0 * stations], -1)))
    found = [
        of_road(m.shape)
        for m in made(Roads(whole.road, whole.carriageway, whole.crossings, (moved,)), approach=approach)
    ]
    if approach == "zigzag":
        drawn = [s.bounds for s in found if s.area < 0.5 * s.envelope.area and 10.0 < s.bounds[2] - s.bounds[0] < 17.0]
        space = {1: place - 2.0 - 2.0 - 17.0, -1: LENGTH - place - 2.0 - 2.0 - 17.0}
        expected = [(60.0 - 20.0, 60.0 - 4.0)] * (2 * (space[1] > 1.0)) + [(64.0, 80.0)] * (2 * (space[-1] > 1.0))
    else:
        drawn = [
            s.bounds
            for s in found
            if isinstance(s, shapely.Polygon)
            and s.interiors
            and s.bounds[2] - s.bounds[0] == pytest.approx(5.0, abs=0.1)
        ]
        at = [(sense, away) for sense in (1, -1) for away in (30.0, 50.0)]
        along = [58.0 - away if sense > 0 else 62.0 + away for sense, away in at]
        expected = [(s - 2.5, s + 2.5) for s in along if 4.0 < s + shift < LENGTH - 4.0]
    np.testing.assert_allclose(sorted((b[0], b[2]) for b in drawn), sorted(expected), atol=0.03)


def test_tramways_have_a_track_for_each_direction_where_there_is_room() -> None:
    found = made(street(4.5), tram=True, tram_bed=True)
    same(boxes(found, "bed", "road"), [(0.0, LENGTH, d - 1.15, d + 1.15) for d in (-2.25, 2.25)])
    rails = [track + side * 0.7175 for track in (-2.25, 2.25) for side in (-1, 1)]
    same(boxes(found, "steel", "road"), [(0.0, LENGTH, d - 0.035, d + 0.035) for d in rails])
    inner = [track + side * (0.7175 - 0.055) for track in (-2.25, 2.25) for side in (-1, 1)]
    same(boxes(found, "groove", "road"), [(0.0, LENGTH, d - 0.02, d + 0.02) for d in inner])
    assert any(box[2] < 0.0 < box[3] for box in boxes(found, "white"))
    narrow = made(street(2.7), tram=True)
    same(boxes(narrow, "steel", "road"), [(0.0, LENGTH, d - 0.035, d + 0.035) for d in (-0.7175, 0.7175)])
    assert not boxes(narrow, "bed", "road")
    assert not any(box[2] < 0.0 < box[3] and box[3] - box[2] < 0.2 for box in boxes(narrow, "white")), "no centre line"


def car(s: float, d: float, turn: float = 0.0, length: float = 4.6) -> Parked:
    x, y = placed([(s, d)])[0]
    return Parked((float(x), float(y)), TURN + turn, length)


def test_bays_of_boxes_around_parked_cars_and_between_them() -> None:
    """On the right at s = 20 and 40: bays of 5.5 m, of which two more fit between; on the left nobody parks."""
    roads = street(5.0)
    cars = [car(20.0, -4.0), car(40.0, -4.0, np.pi), car(30.0, 4.0)]
    found = made(roads, cars, bay="box", bay_colour="blue", edge="white")
    # Between 22.75 and 37.25 two bays of 7.25 m; before 17.25, from 5 m before a crosswalk and 3 m after an end on.
    free = [3.0 + k * 14.25 / 2 for k in range(3)]
    along = [*itertools.pairwise(free), (17.25, 22.75), (22.75, 30.0), (30.0, 37.25), (37.25, 42.75)]
    inner = -(5.0 - 2.0 - 0.1)
    expected: list[Box] = []
    for s0, s1 in along:
        half = (s0 + s1) / 2
        expected += [(s0, half, inner - 0.05, inner + 0.05), (half, s1, inner - 0.05, inner + 0.05)]
        expected += [(s - 0.05, s + 0.05, -4.7, inner) for s in (s0, s1)]
    same(boxes(found, "blue"), expected)
    edges = [box for box in boxes(found, "white") if abs(abs(box[2] + box[3]) / 2 - 4.5) < 0.01]
    assert all(box[2] > 0.0 for box in edges), "no line where cars park"
    lanes = lanes_of(roads.axes[0], cars, RoadRules(bay="box"))
    assert lanes.parking == (False, True)
    assert (lanes.left(5.0), lanes.right(5.0), lanes.middle(5.0), lanes.width(5.0)) == (5.0, -3.0, 1.0, 8.0)
    # The lanes are what parking leaves: their middle is 1 m to the left.
    centre = [box for box in boxes(found, "white") if abs((box[2] + box[3]) / 2 - 1.0) < 0.01]
    assert {round(b[3] - b[2], 4) for b in centre} == {0.12}
    tracks = [(0.0, LENGTH, 1.0 + d - 0.28, 1.0 + d + 0.28) for d in (-2.75, -1.25, 1.25, 2.75)]
    same(boxes(found, "track", "road"), tracks)


def test_bays_of_tees_are_open() -> None:
    found = made(street(5.0), [car(20.0, 4.0), car(25.5, 4.0)], bay="tee", bay_colour="blue")
    bays = [(3.0, 10.125), (10.125, 17.25), (17.25, 22.75), (22.75, 28.25)]
    expected: list[Box] = []
    for s0, s1 in bays:
        expected += [(s0, s0 + 0.45, 2.85, 2.95), (s1 - 0.45, s1, 2.85, 2.95)]
        expected += [(s - 0.05, s + 0.05, 2.9, 2.9 + 0.3 * 1.8) for s in (s0, s1)]
    same(boxes(found, "blue"), expected)


@pytest.mark.parametrize(
    ("other", "parks"),
    [
        (car(40.0, 3.9), True),
        (car(40.0, 3.9, np.pi), True),
        (car(40.0, 3.9, 0.25), True),
        (car(40.0, 3.9, 0.35), False),  # askew
        (car(40.0, 3.9, np.pi / 2), False),
        (car(40.0, 2.6), False),  # 2.4 m off the kerb
        (car(40.0, 2.8), True),
        (car(40.0, 4.9), False),  # on the kerb
        (car(40.0, 5.9), False),
        (car(-3.0, 3.9), False),  # beyond the road
        (car(123.0, 3.9), False),
        (car(40.0, -3.9), False),  # on the other side
    ],
)
def test_who_parks(other: Parked, parks: bool) -> None:
    (axis,) = street(5.0).axes
    lanes = lanes_of(axis, [car(20.0, 4.0), other], RoadRules(bay="box"))
    assert lanes.parking == (parks, False)
    assert lanes_of(axis, [car(20.0, 4.0), other], RoadRules(bay="none")).vehicles == ()


def test_repaired_places_are_patches_and_trenches_with_seams() -> None:
    """Two per 100 m of 120 m, rounded: a pale patch of 2.4 m by 0.95 m in the middle, and a trench across."""
    draws = (0.5, 0.5, 0.5, 0.5, 0.9, 0.8, *(0.25, 0.5, 0.0, 0.0, 0.1, 0.2))
    found = made(street(4.5, crosswalk=False), draws=draws, patches=1.6)
    same(boxes(found, "pale patch", "road"), [(60.0 - 1.2, 60.0 + 1.2, -0.475, 0.475)])
    trench = 4.0 + 0.25 * 112.0
    same(boxes(found, "patch", "road"), [(trench - 0.35, trench + 0.35, -4.2, 4.2)])
    seams = [of_road(m.shape) for m in found if m.paint == "seam"]
    np.testing.assert_allclose(seams[0].bounds, (58.76, -0.515, 61.24, 0.515), atol=1e-6)
    assert seams[0].area == pytest.approx(2.48 * 1.03 - 2.4 * 0.95, abs=1e-6)
    assert seams[1].area == pytest.approx(0.78 * 8.48 - 0.7 * 8.4, abs=1e-6)
