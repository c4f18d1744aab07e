"""Sixteen places of `benchmarks.transfer`, composed by hand after the list of the paper's 16 real scenes.

The paper names each of its scenes in a few words (straight paths 01 and 04; turns 02, 03, 05, 06; obstacles on a
walkway 07 and on a sidewalk 08; obstacles after turns 09 and 10; a sidewalk blocked by a car 11; lampposts 12; a narrow
gate and a ramp 13 and 14; street crossings 15 and 16) and shows a photograph that we do not have. The numbers here are
the paper's; everything else is our composition, so the places are stand-ins and no reconstructions. `DIRECT` are driven
as composed; `FILMED` are filmed and distilled by `benchmarks.transfer_recordings`, and only the distilled graphs are
driven. No generator makes them, and nothing was trained, chosen or tuned on them.
"""

import functools
from collections.abc import Callable, Sequence

from urbanverse_mjx.citygen.canvas import ground_layers as lay
from urbanverse_mjx.citygen.canvas.canvas import Canvas, Edge, edge, edges
from urbanverse_mjx.citygen.canvas.ground_layers import Corner
from urbanverse_mjx.citygen.canvas.pieces import apron, bicycles, blank, chain, people, table

#: m: ground of all places, and of pavements beside a road.
LEVEL, KERB = 0.1, 0.14
_HEDGE = (0.75, 2.28, 1.18)


def _floor(c: Canvas, corners: Sequence[Corner], kind: str = "sidewalk", z: float = LEVEL) -> None:
    """The walkable ground, with ground under the fronts around it."""
    apron(c, "lots", corners, z)
    c.ground("floor", kind, corners, z)


def _beside_road(c: Canvas, length: float, width: float, lots: tuple[float, float]) -> Edge:
    """A pavement of a width along a road, the ground under the fronts between two distances from the kerb, and the
    other side of the road; returns the kerb."""
    c.ground("lots", "sidewalk", lay.rectangle(0.0, lots[0], length, lots[1]), KERB)
    c.ground("road", "road", lay.rectangle(0.0, -6.0, length, 0.0))
    c.ground("far", "sidewalk", lay.rectangle(0.0, -9.0, length, -6.0), KERB)
    c.ground("walk", "sidewalk", lay.rectangle(0.0, 0.0, length, width), KERB)
    return edge((0.0, 0.0), (length, 0.0), 1)


def _hedges(c: Canvas, line: Edge, begin: float, end: float, d: float) -> None:
    """A clipped hedge along an edge."""
    count = int((end - begin) / (_HEDGE[1] + 0.1))
    for k in range(count):
        at = begin + (k + 0.5) * (end - begin) / count
        c.put("shrub", *line.at(at, d), line.facing("street"), size=_HEDGE)


def _straight_forecourt(c: Canvas) -> None:
    """01: a straight path over the open forecourt of two offices."""
    _floor(c, lay.rectangle(0.0, 0.0, 46.0, 12.0))
    c.wear((20.0, 6.0), "sidewalk/granite_light")
    c.sky("spring_noon-few_cumulus")
    south, north = edge((0.0, 0.0), (46.0, 0.0), 1), edge((0.0, 12.0), (46.0, 12.0), -1)
    c.houses(south.road(), ("office building", "office building", "hotel"), 0.1, 45.9, 0.0)
    c.houses(north.road(), ("office building", "bank", "office building"), 0.1, 45.9, 0.0)
    c.row("bench", south, (6.0, 15.0, 31.0, 40.0), 1.0, "street", 0)
    c.row("potted plant", north, (4.0, 12.0, 20.0, 28.0, 36.0), 1.2, "street", 1)
    c.row("lamppost", north, (8.0, 24.0, 40.0), 3.0, "street", 0)
    c.along(south, [("trash bin", 10.4, 0.8, "street", 1), ("bicycle rental", 22.6, 1.2, "street", 0)])
    c.along(south, [("sculpture", 27.0, 6.4, 30.0, 0), ("information point", 36.4, 1.0, "street", 0)])
    people(c, [("pedestrian adult", 14.0, 8.2, 170.0), ("pedestrian adult", 32.6, 4.0, 20.0)])
    c.trajectory = [(2.5, 5.0), (44.0, 5.0)]


def _corner_pavement(c: Canvas) -> None:
    """02: a pavement of 3.4 m that turns by a right angle around an apartment block."""
    c.ground("lots", "sidewalk", lay.rectangle(-2.4, 0.0, 30.0, 26.0), KERB)
    c.ground("road_south", "road", lay.rectangle(-8.4, -9.4, 30.0, -3.4))
    c.ground("road_west", "road", lay.rectangle(-9.4, -9.4, -3.4, 26.0))
    c.ground("walk", "sidewalk", [(-3.4, -3.4), (30.0, -3.4), (30.0, 0.0), (0.0, 0.0), (0.0, 26.0), (-3.4, 26.0)], KERB)
    c.wear((10.0, -2.0), "sidewalk/concrete_grey")
    c.wear("road", "road/asphalt_used")
    c.sky("summer_morning-few_cumulus")
    south, west = edge((0.0, 0.0), (30.0, 0.0), -1), edge((0.0, 0.0), (0.0, 26.0), 1)
    c.houses(south.road(), ("apartment building", "apartment building"), 0.1, 29.9, 0.0)
    c.houses(west.road(), ("apartment building",), 9.4, 25.9, 0.0)
    c.row("parking meter", south, (4.0, 10.0, 16.0, 22.0), 3.0, "street", 0)
    c.along(
        south,
        [("fire hydrant", 13.0, 2.9, 0.0), ("trash bin", 19.2, 0.5, "street", 2), ("postbox", 7.4, 0.6, "street")],
    )
    c.along(
        west, [("street light", 6.0, 3.0, "street"), ("bicycle", 12.0, 0.6, "+"), ("garbage bag", 17.0, 0.6, 20.0, 0)]
    )
    c.along(
        west,
        [("stop sign", 1.0, 3.0, "-"), ("trash bin", 21.0, 0.6, "street", 1), ("street light", 20.0, 3.0, "street")],
    )
    c.along(south, [("sedan", 8.0, 4.8, "+"), ("hatchback car", 18.0, 4.8, "+"), ("pedestrian adult", 24.6, 1.6, "-")])
    c.trajectory = [(28.0, -1.7), (-1.7, -1.7), (-1.7, 24.5)]


def _hedge_turn(c: Canvas) -> None:
    """03: a footpath between hedges that turns twice."""
    path = [(0.0, 0.0), (16.0, 0.0), (16.0, 14.0), (34.0, 14.0)]
    c.ground("lawn", "ground", lay.rectangle(-2.0, -7.0, 36.0, 21.0), LEVEL)
    c.ground("path", "sidewalk", lay.strip(path, 3.0), LEVEL)
    c.wear("ground", "grass")
    c.wear((8.0, 0.0), "sidewalk/hoggin")
    c.sky("summer_noon-few_cumulus")
    for side in (1, -1):
        for line, length in zip(edges(path, 1.9, side), (16.0, 14.0, 18.0), strict=True):
            _hedges(c, line, 0.3, length - 2.6 if side == 1 else length - 0.4, 0.1)
    for x, y in ((6.0, 5.4), (26.0, 19.0), (24.0, 8.0), (8.0, -5.0)):
        c.put("tree", x, y, 20.0, 0)
    people(c, [("pedestrian adult", 10.0, 0.5, 0.0), ("dog", 24.0, 13.6, 180.0)])
    c.put("bench", 13.4, -0.9, 90.0, 0)
    c.trajectory = [(1.5, 0.0), (16.0, 0.0), (16.0, 14.0), (32.5, 14.0)]


def _straight_pavement(c: Canvas) -> None:
    """04: a straight residential pavement with front gardens and parked cars."""
    c.ground("gardens", "ground", lay.rectangle(0.0, 3.2, 44.0, 6.4), KERB)
    kerb = _beside_road(c, 44.0, 3.2, (6.4, 9.0))
    c.wear((10.0, 1.0), "sidewalk/flags_buff")
    c.wear("ground", "grass")
    c.sky("summer_afternoon-few_cumulus")
    c.houses(edge((0.0, 6.4), (44.0, 6.4), 1), ("house", "house", "house", "house", "house"), 0.1, 43.9, 0.0)
    c.houses(edge((0.0, -7.6), (44.0, -7.6), -1), ("house", "house", "house", "house", "house"), 0.1, 43.9, 0.0)
    for begin, end in ((0.4, 7.0), (9.6, 16.4), (18.8, 25.2), (28.0, 34.0), (36.6, 43.2)):
        _hedges(c, kerb, begin, end, 3.9)
    c.row("street light", kerb, (7.0, 22.0, 37.0), 0.5, "street", 0)
    c.along(kerb, [("trash bin", 12.0, 0.6, "street", 0), ("trash bin", 12.9, 0.6, "street", 0)])
    c.along(kerb, [("sedan", 9.0, -1.3, "+"), ("suv", 18.0, -1.3, "+"), ("hatchback car", 30.4, -1.3, "+")])
    c.along(
        kerb, [("bicycle", 26.0, 2.6, "+"), ("pedestrian adult", 33.0, 1.2, "-"), ("mailbox", 35.4, 2.7, "street", 0)]
    )
    c.trajectory = [(2.0, 1.7), (42.0, 1.7)]


def _park_bends(c: Canvas) -> None:
    """05: a path of 3 m with two bends over an open lawn."""
    path = [(0.0, 0.0), (12.0, 1.0), (21.0, 10.0), (32.0, 11.0), (42.0, 4.0)]
    c.ground("lawn", "ground", lay.rectangle(-3.0, -9.0, 45.0, 20.0), LEVEL)
    c.ground("path", "sidewalk", lay.strip(path, 3.0), LEVEL)
    c.wear("ground", "grass_dry")
    c.wear((6.0, 0.5), "sidewalk/asphalt_fine")
    c.sky("spring_morning-few_cumulus")
    for x, y in ((4.0, 5.0), (10.0, -4.0), (17.0, 12.0), (24.0, 5.0), (29.0, 16.0), (36.0, 2.0), (38.0, 14.0)):
        c.put("tree", x, y, 7.0 * x, 0)
    for x, y, turn in ((8.6, 3.2, -90.0), (20.6, 6.4, 135.0), (33.4, 13.2, -60.0)):
        c.put("bench", x, y, turn, 0)
    for x, y in ((15.4, 2.4), (26.0, 12.6), (38.6, 8.4)):
        c.put("trash bin", x, y, 0.0, 1)
    for x, y in ((14.0, 7.6), (31.0, 7.4), (5.0, -3.2)):
        c.put("shrub", x, y, 0.0, 0)
    people(c, [("jogger", 17.0, 5.6, 225.0), ("pedestrian adult", 28.6, 10.2, 10.0), ("bird", 22.0, 14.0, 0.0)])
    c.trajectory = [(1.5, 0.1), (12.0, 1.0), (21.0, 10.0), (32.0, 11.0), (41.0, 4.7)]


def _turn_around_kiosk(c: Canvas) -> None:
    """06: a turn back around a kiosk on an open square."""
    _floor(c, lay.rectangle(0.0, 0.0, 32.0, 20.0))
    c.wear((4.0, 4.0), "sidewalk/setts_small")
    c.sky("summer_noon-few_cumulus")
    west, east = edge((0.0, 0.0), (0.0, 20.0), 1), edge((32.0, 0.0), (32.0, 20.0), -1)
    c.houses(west, ("cafe", "bookstore"), 0.1, 19.9, 0.0)
    c.houses(east, ("bank", "pharmacy"), 0.1, 19.9, 0.0)
    c.houses(edge((0.0, 20.0), (32.0, 20.0), 1), ("hotel", "restaurant", "cafe"), 0.1, 31.9, 0.0)
    c.houses(edge((0.0, 0.0), (32.0, 0.0), -1), ("house", "bakery", "house"), 0.1, 31.9, 0.0)
    c.put("kiosk", 16.0, 10.0, 0.0, 0)
    chain(c, "fence", [(2.6, 9.4), (14.0, 9.4)], 0)
    table(c, 19.4, 13.2, (0.0, 180.0), 0)
    table(c, 19.4, 7.0, (90.0, 270.0), 0)
    c.row("lamppost", edge((0.0, 0.0), (32.0, 0.0), 1), (8.0, 24.0), 3.0, "street", 0)
    for x, y in ((24.0, 15.4), (7.0, 16.0), (26.6, 5.4)):
        c.put("tree", x, y, 40.0, 0)
    c.put("newspaper stand", 18.4, 10.0, 0.0, 0)
    people(c, [("pedestrian adult", 22.0, 10.4, 180.0), ("elderly person", 9.0, 5.2, 0.0)])
    c.trajectory = [(3.0, 4.0), (22.5, 4.6), (22.5, 12.0), (3.0, 13.0)]


def _campus_walkway(c: Canvas) -> None:
    """07: a walkway of 5 m with bicycles, boards and planters on it."""
    _floor(c, lay.rectangle(0.0, 0.0, 42.0, 5.0))
    c.wear((4.0, 2.0), "sidewalk/concrete_pale")
    c.sky("spring_noon-scattered_cumulus")
    south, north = edge((0.0, 0.0), (42.0, 0.0), 1), edge((0.0, 5.0), (42.0, 5.0), -1)
    c.houses(south.road(), ("school", "library", "school"), 0.1, 41.9, 0.0)
    c.houses(north.road(), ("school", "office building", "school"), 0.1, 41.9, 0.0)
    for x, y, turn in ((7.0, 1.0, 90.0), (19.0, 4.0, 90.0), (31.0, 1.0, 90.0)):
        bicycles(c, x, y, turn, (False, True, False), rack=False)
    c.along(
        south,
        [
            ("advertising board", 11.0, 2.2, "+"),
            ("plant pot", 14.6, 0.8, 0.0, 0),
            ("trash bin", 24.6, 0.7, "street", 1),
        ],
    )
    c.along(
        north,
        [("advertising board", 26.4, 2.2, "-"), ("plant pot", 13.0, 0.7, 0.0, 0), ("bench", 35.6, 0.8, "street", 0)],
    )
    c.along(
        south, [("potted plant", 22.0, 2.0, 0.0, 1), ("scooter", 37.8, 1.2, 30.0), ("storage box", 28.0, 1.0, 10.0, 0)]
    )
    people(c, [("pedestrian adult", 16.8, 2.0, 180.0), ("pedestrian adult", 33.6, 3.2, 0.0)])
    c.trajectory = [(2.0, 2.5), (40.0, 2.5)]


def _bins_on_pavement(c: Canvas) -> None:
    """08: a sidewalk with bins, bags and a delivery on collection day."""
    kerb = _beside_road(c, 42.0, 4.0, (4.0, 6.4))
    c.wear((10.0, 1.0), "sidewalk/flags_grey")
    c.sky("summer_evening-few_cumulus")
    c.houses(
        edge((0.0, 4.0), (42.0, 4.0), 1),
        ("apartment building", "bakery", "house", "apartment building"),
        0.1,
        41.9,
        0.0,
    )
    c.houses(edge((0.0, -7.4), (42.0, -7.4), -1), ("house", "apartment building", "house", "house"), 0.1, 41.9, 0.0)
    for s in (5.0, 5.9, 16.0, 16.9, 28.0, 28.9):
        c.put("trash bin", *kerb.at(s, 0.7), kerb.facing("street"), 0)
    for k, s in enumerate((7.2, 8.0, 17.9, 30.0, 30.8)):
        c.put("garbage bag", *kerb.at(s, 0.8), 40.0 * k, k % 3)
    c.along(kerb, [("van", 22.0, -1.4, "+"), ("parcels", 21.4, 0.9, 10.0, 1), ("handcart", 23.4, 1.1, "+", 0)])
    c.along(
        kerb,
        [
            ("storage box", 12.0, 3.4, "street", 0),
            ("potted plant", 19.8, 3.4, "street", 0),
            ("bicycle", 33.4, 3.4, "+"),
        ],
    )
    c.along(
        kerb,
        [("street light", 11.0, 0.5, "street", 0), ("street light", 35.0, 0.5, "street", 0), ("dog", 26.0, 2.6, "-")],
    )
    people(c, [("delivery worker", 24.8, 2.2, 180.0), ("pedestrian adult", 37.6, 2.4, 180.0)])
    c.trajectory = [(2.0, 2.2), (40.0, 2.2)]


def _bollards_after_turn(c: Canvas) -> None:
    """09: an alley that turns by a right angle, with bollards and crates directly behind the corner."""
    path = [(0.0, 0.0), (20.0, 0.0), (20.0, 22.0)]
    floor = lay.strip(path, 4.4)
    _floor(c, floor)
    c.wear((4.0, 0.0), "sidewalk/setts_bows")
    c.sky("summer_afternoon-scattered_cumulus")
    outer, inner = edges(path, 2.2, -1), edges(path, 2.2, 1)
    c.houses(outer[0], ("house", "bar", "house"), 0.1, 22.1, 0.0)
    c.houses(outer[1], ("restaurant", "house", "house"), 0.1, 24.1, 0.0)
    c.houses(inner[0], ("bookstore", "cafe"), 0.1, 17.7, 0.0)
    c.houses(inner[1], ("bar",), 8.6, 19.7, 0.0)
    for x in (19.2, 20.9):
        c.put("bollard", x, 3.4, 0.0, 0)
    c.put("storage box", 18.4, 6.6, 10.0, 1)
    c.put("storage box", 18.5, 7.5, 80.0, 0)
    c.put("barrel or bucket", 21.6, 9.6, 0.0, 0)
    table(c, 18.9, 12.4, (90.0, 270.0), 0)
    c.put("advertising board", 20.9, 15.6, 90.0, 0)
    c.put("trash bin", 8.0, 1.6, -90.0, 1)
    c.put("motorcycle", 12.6, -1.6, 0.0, 0)
    people(c, [("pedestrian adult", 20.8, 18.0, 270.0)])
    c.trajectory = [(1.5, 0.0), (20.0, 0.2), (20.0, 20.0)]


def _stall_after_turn(c: Canvas) -> None:
    """10: a passage that opens by a turn on a square whose entrance is half taken by a stall and a queue."""
    corners = [(0.0, 0.0), (20.0, 0.0), (20.0, -14.0), (38.0, -14.0), (38.0, 4.4), (0.0, 4.4)]
    _floor(c, corners)
    c.wear((4.0, 2.0), "sidewalk/limestone_polished")
    c.sky("summer_noon-few_cumulus")
    c.houses(edge((0.0, 4.4), (38.0, 4.4), 1), ("bookstore", "cafe", "pharmacy", "bakery"), 0.1, 37.9, 0.0)
    c.houses(edge((0.0, 0.0), (20.0, 0.0), -1), ("hotel",), 0.1, 19.9, 0.0)
    c.houses(edge((38.0, -14.0), (38.0, 4.4), -1), ("bank", "restaurant"), 0.1, 18.3, 0.0)
    c.houses(edge((20.0, -14.0), (38.0, -14.0), -1), ("restaurant", "cafe"), 0.1, 17.9, 0.0)
    c.put("street food stall", 23.4, -3.4, 0.0, 0)
    for x, y, turn in ((25.8, -3.2, 180.0), (26.9, -3.0, 190.0), (28.0, -3.4, 170.0)):
        c.put("pedestrian adult", x, y, turn)
    table(c, 30.0, -8.0, (0.0, 180.0), 0)
    table(c, 24.6, -10.6, (90.0, 270.0), 0)
    table(c, 34.0, -3.0, (45.0, 225.0), 0)
    c.put("bench", 8.0, 3.7, -90.0, 0)
    c.put("plant pot", 13.0, 0.7, 0.0, 0)
    c.put("plant pot", 16.2, 3.6, 0.0, 0)
    c.put("lamppost", 31.6, 1.6, 0.0, 0)
    c.trajectory = [(1.5, 2.2), (21.2, 1.6), (28.0, -1.2), (28.0, -12.0)]


def _car_on_pavement(c: Canvas) -> None:
    """11: a sidewalk that a parked car blocks, so that only the strip along the wall is left."""
    kerb = _beside_road(c, 42.0, 5.0, (5.0, 7.4))
    c.wear((10.0, 1.0), "sidewalk/concrete_grey-stained")
    c.sky("summer_morning-few_cumulus")
    c.houses(edge((0.0, 5.0), (42.0, 5.0), 1), ("garage", "house", "supermarket", "house"), 0.1, 41.9, 0.0)
    c.houses(edge((0.0, -7.4), (42.0, -7.4), -1), ("house", "house", "apartment building", "house"), 0.1, 41.9, 0.0)
    c.along(kerb, [("suv", 14.0, 1.4, "+"), ("sedan", 28.6, 2.0, 12.0), ("van", 21.0, -1.4, "+")])
    c.along(
        kerb,
        [
            ("street light", 8.0, 0.5, "street", 0),
            ("fire hydrant", 19.4, 0.5, 0.0),
            ("trash bin", 23.6, 4.4, "street", 1),
        ],
    )
    c.along(
        kerb, [("shopping cart", 35.0, 4.4, "+", 0), ("bicycle", 6.0, 4.5, "+"), ("traffic cone", 32.2, 1.0, 0.0, 0)]
    )
    people(c, [("pedestrian adult", 36.4, 2.2, 180.0)])
    c.trajectory = [(2.0, 2.5), (10.0, 3.2), (14.0, 3.8), (22.0, 2.4), (28.6, 4.1), (34.0, 2.6), (40.0, 2.5)]


def _lampposts(c: Canvas) -> None:
    """12: a plaza with a dense arrangement of lampposts; e-scooters, bollards and shrubs stand along its sides."""
    _floor(c, lay.rectangle(0.0, 0.0, 40.0, 11.0))
    c.wear((4.0, 4.0), "sidewalk/flags_large")
    c.sky("summer_noon-few_cumulus")
    south, north = edge((0.0, 0.0), (40.0, 0.0), 1), edge((0.0, 11.0), (40.0, 11.0), -1)
    c.houses(south.road(), ("office building", "cafe", "office building"), 0.1, 39.9, 0.0)
    c.houses(north.road(), ("museum",), 0.1, 39.9, 0.0)
    for row in range(3):
        for k in range(7):
            c.put("lamppost", 9.0 + 3.6 * k + (1.8 if row % 2 else 0.0), 3.0 + 2.5 * row, 0.0, 0)
    for k, s in enumerate((6.0, 7.0, 8.2, 21.0, 22.2, 33.0)):
        c.put("scooter", *south.at(s, 1.1), 60.0 + 25.0 * k, 0)
    c.row("bollard", north, (5.0, 7.0, 9.0, 25.0, 27.0, 29.0), 0.8)
    for s in (13.0, 16.0, 19.0, 34.0):
        c.put("shrub", *north.at(s, 0.9), 0.0, 0)
    c.row("shrub", south, (12.0, 15.0, 27.0), 0.9, "street", 0)
    c.trajectory = [(2.5, 4.2), (8.0, 4.2), (37.5, 6.8)]


def _narrow_gate(c: Canvas) -> None:
    """13: a gate of 1.7 m in a wall between two yards."""
    _floor(c, lay.rectangle(0.0, 0.0, 38.0, 10.0))
    c.wear((4.0, 4.0), "sidewalk/concrete_warm")
    c.sky("spring_noon-few_cumulus")
    south, north = edge((0.0, 0.0), (38.0, 0.0), 1), edge((0.0, 10.0), (38.0, 10.0), -1)
    c.houses(south.road(), ("apartment building", "garage", "apartment building"), 0.1, 37.9, 0.0)
    c.houses(north.road(), ("apartment building", "house", "apartment building"), 0.1, 37.9, 0.0)
    chain(c, "wall", [(19.0, 0.1), (19.0, 4.1)], 0, stretch=3.0)
    chain(c, "wall", [(19.0, 5.8), (19.0, 9.9)], 0, stretch=3.0)
    c.put("bollard", 15.6, 3.4, 0.0, 0)
    c.put("bollard", 15.6, 6.4, 0.0, 0)
    c.along(
        south,
        [("trash bin", 8.0, 0.8, "street", 0), ("trash bin", 9.0, 0.8, "street", 0), ("bench", 28.0, 1.0, "street", 0)],
    )
    c.along(north, [("bicycle", 11.0, 0.9, "+"), ("bicycle", 24.0, 0.9, "+"), ("plant pot", 32.0, 1.0, 0.0, 0)])
    for x, y in ((6.0, 6.6), (30.0, 6.4)):
        c.put("tree", x, y, 0.0, 0)
    people(c, [("pedestrian child", 25.6, 3.4, 90.0)])
    c.trajectory = [(2.5, 4.0), (17.0, 4.9), (21.0, 4.9), (35.5, 4.4)]


def _access_ramp(c: Canvas) -> None:
    """14: an access ramp of 1:10 between rails, from a pavement up to a terrace of 0.6 m."""
    c.ground("lots", "sidewalk", lay.rectangle(0.0, 5.4, 40.0, 7.8), LEVEL)
    c.ground("low", "sidewalk", lay.rectangle(0.0, 0.0, 15.0, 5.4), LEVEL)
    c.ground("high", "sidewalk", lay.rectangle(21.0, 0.0, 40.0, 5.4), LEVEL + 0.6)
    c.ground("high_lots", "sidewalk", lay.rectangle(21.0, 5.4, 40.0, 7.8), LEVEL + 0.6)
    c.ground("bank", "ground", lay.rectangle(15.0, 0.0, 21.0, 1.4), LEVEL)
    c.ground("bank_b", "ground", lay.rectangle(15.0, 4.0, 21.0, 5.4), LEVEL)
    ramp = [(15.0, 1.4, LEVEL), (15.0, 4.0, LEVEL), (21.0, 1.4, LEVEL + 0.6)]
    c.slope("ramp", "sidewalk", lay.rectangle(15.0, 1.4, 21.0, 4.0), ramp)
    c.wear((4.0, 2.0), "sidewalk/granite_courses")
    c.wear("ground", "grass")
    c.sky("summer_afternoon-scattered_cumulus")
    c.houses(edge((0.0, 5.4), (15.0, 5.4), 1), ("house", "house"), 0.1, 14.9, 0.0)
    c.houses(edge((21.0, 5.4), (40.0, 5.4), 1), ("school",), 0.1, 18.9, 0.0)
    south = edge((0.0, 0.0), (40.0, 0.0), 1)
    for y in (1.2, 4.2):
        for x in (16.0, 18.0, 20.0):
            c.put("shrub", x, y - 0.5 if y < 2.0 else y + 0.5, 90.0, size=(0.5, 1.5, 0.8))
    c.along(
        south,
        [("bench", 6.0, 4.6, "wall", 0), ("trash bin", 9.6, 0.8, "street", 1), ("lamppost", 12.0, 0.9, "street", 0)],
    )
    c.along(south, [("plant pot", 24.0, 0.9, 0.0, 0), ("bicycle", 29.0, 4.5, "+"), ("bench", 33.0, 0.9, "wall", 0)])
    people(c, [("pedestrian adult", 27.0, 2.6, 180.0)])
    c.trajectory = [(2.0, 2.6), (14.0, 2.7), (22.0, 2.7), (38.0, 2.7)]


def _zebra(c: Canvas) -> None:
    """15: a zebra crossing over a street of 7 m with bollards at both dropped kerbs."""
    c.ground("south_lots", "sidewalk", lay.rectangle(0.0, -12.4, 34.0, -8.0), KERB)
    c.ground("north_lots", "sidewalk", lay.rectangle(0.0, 8.0, 34.0, 12.4), KERB)
    c.ground("road", "road", lay.rectangle(0.0, -3.5, 34.0, 3.5))
    c.ground("south", "sidewalk", lay.rectangle(0.0, -8.0, 34.0, -3.5), KERB)
    c.ground("north", "sidewalk", lay.rectangle(0.0, 3.5, 34.0, 8.0), KERB)
    c.ground("zebra", "crosswalk", lay.rectangle(15.0, -3.5, 19.0, 3.5))
    c.ramp("ramp_n", (17.0, 3.5), 90.0, parted=False)
    c.ramp("ramp_s", (17.0, -3.5), -90.0, parted=False)
    c.wear((4.0, -5.0), "sidewalk/concrete_grey")
    c.wear("crosswalk", "zebra_new")
    c.sky("spring_noon-scattered_cumulus")
    south, north = edge((0.0, -3.5), (34.0, -3.5), -1), edge((0.0, 3.5), (34.0, 3.5), 1)
    c.houses(south, ("bakery", "bank", "house"), 0.1, 33.9, 4.5)
    c.houses(north, ("hotel", "pharmacy", "house"), 0.1, 33.9, 4.5)
    for line in (south, north):
        c.row("bollard", line, (11.4, 13.0, 21.0, 22.6), 0.5)
        c.along(line, [("street light", 7.0, 0.6, "street", 0), ("trash bin", 25.0, 3.8, "street", 1)])
    c.along(
        south, [("traffic light", 20.0, 1.6, "street"), ("sedan", 6.0, -1.4, "+"), ("bench", 9.0, 3.7, "street", 0)]
    )
    c.along(
        north, [("traffic light", 14.0, 1.6, "street"), ("bicycle", 28.0, 3.9, "+"), ("hatchback car", 27.0, -1.4, "-")]
    )
    people(c, [("pedestrian adult", 18.0, 0.8, 90.0), ("pedestrian adult", 12.0, 6.2, 0.0)])
    c.trajectory = [(3.0, -5.8), (17.0, -5.8), (17.0, 5.8), (31.0, 5.8)]


def _island_crossing(c: Canvas) -> None:
    """16: a crossing over two carriageways with an island between them."""
    for name, y0, y1 in (("south_lots", -15.4, -11.0), ("north_lots", 11.0, 15.4)):
        c.ground(name, "sidewalk", lay.rectangle(0.0, y0, 30.0, y1), KERB)
    c.ground("road", "road", lay.rectangle(0.0, -7.0, 30.0, 7.0))
    c.ground("south", "sidewalk", lay.rectangle(0.0, -11.0, 30.0, -7.0), KERB)
    c.ground("north", "sidewalk", lay.rectangle(0.0, 7.0, 30.0, 11.0), KERB)
    c.ground("island_w", "sidewalk", lay.rectangle(4.0, -1.2, 12.6, 1.2), KERB)
    c.ground("island_e", "sidewalk", lay.rectangle(17.4, -1.2, 26.0, 1.2), KERB)
    c.ground("zebra", "crosswalk", lay.rectangle(12.6, -7.0, 17.4, 7.0))
    c.ramp("ramp_n", (15.0, 7.0), 90.0, parted=False)
    c.ramp("ramp_s", (15.0, -7.0), -90.0, parted=False)
    c.wear((4.0, -9.0), "sidewalk/flags_grey")
    c.wear("crosswalk", "zebra_worn")
    c.sky("summer_morning-broken_cumulus")
    south, north = edge((0.0, -7.0), (30.0, -7.0), -1), edge((0.0, 7.0), (30.0, 7.0), 1)
    c.houses(south, ("office building", "hotel"), 0.1, 29.9, 4.0)
    c.houses(north, ("apartment building", "bank"), 0.1, 29.9, 4.0)
    for x in (11.6, 18.4):
        c.put("bollard", x, 0.6, 0.0, 0)
        c.put("bollard", x, -0.6, 0.0, 0)
        c.put("no parking sign", 4.6 if x < 15.0 else 25.4, 0.0, 180.0)
    for line in (south, north):
        c.row("bollard", line, (9.6, 11.0, 19.0, 20.4), 0.5)
        c.along(line, [("street light", 5.0, 0.6, "street", 0), ("traffic light", 18.0, 1.4, "street")])
    c.along(south, [("sedan", 5.0, -1.6, "+"), ("bench", 23.0, 3.3, "street", 0)])
    c.along(north, [("van", 25.0, -1.6, "-"), ("trash bin", 8.0, 3.4, "street", 1)])
    people(c, [("pedestrian adult", 14.0, 3.6, 270.0), ("elderly person", 6.0, 9.0, 0.0)])
    c.trajectory = [(3.0, -9.0), (15.0, -9.0), (15.0, 9.0), (27.0, 9.0)]


_Draw = Callable[[Canvas], None]
_DIRECT: dict[str, _Draw] = {
    "t01_straight_forecourt": _straight_forecourt,
    "t02_corner_pavement": _corner_pavement,
    "t05_park_bends": _park_bends,
    "t07_campus_walkway": _campus_walkway,
    "t09_bollards_after_turn": _bollards_after_turn,
    "t12_lampposts": _lampposts,
    "t13_narrow_gate": _narrow_gate,
    "t15_zebra": _zebra,
}
_FILMED: dict[str, _Draw] = {
    "t03_hedge_turn": _hedge_turn,
    "t04_straight_pavement": _straight_pavement,
    "t06_turn_around_kiosk": _turn_around_kiosk,
    "t08_bins_on_pavement": _bins_on_pavement,
    "t10_stall_after_turn": _stall_after_turn,
    "t11_car_on_pavement": _car_on_pavement,
    "t14_access_ramp": _access_ramp,
    "t16_island_crossing": _island_crossing,
}


def _canvas(place: str) -> Canvas:
    canvas = blank(place)
    (_DIRECT | _FILMED)[place](canvas)
    return canvas


def _builders(places: dict[str, _Draw]) -> dict[str, Callable[[], Canvas]]:
    return {place: functools.partial(_canvas, place) for place in places}


#: Id -> function that composes the place: those that are driven as composed, and those that are filmed.
DIRECT, FILMED = _builders(_DIRECT), _builders(_FILMED)
