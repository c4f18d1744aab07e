"""Market day on a five-sided square: stalls stand in rings around a stone cross, with queues between them.

Three lanes lead in between its fronts. Before the church in the north is a terrace (25 cm high) with a ramp at one end
and steps at the other. Crates, carts and hand trolleys stand around the stalls.
"""

import math

from ..canvas.canvas import Canvas, Edge, edge
from ..canvas.ground_layers import polar
from ..canvas.pieces import apron, barrel, bicycles, blank, people, table

ID = "v03_market_square_with_five_sides"
PAVEMENT_HEIGHT, TERRACE_HEIGHT = 0.1, 0.35
CORNERS = [(0.0, 4.0), (40.0, -4.0), (56.0, 18.0), (48.0, 40.0), (4.0, 40.0)]
CROSS = (27.0, 18.6)
LANE = 4.4  # m, width of the three lanes
#: A side of the square, metres along it where its lane begins, and how deep the lane is.
LANES = ((0, 24.0, 13.0), (1, 10.0, 12.0), (4, 15.0, 13.0))


def _edge(number: int, side: int) -> Edge:
    """Side `number` of the square; +1 for objects inside of it, -1 for the fronts outside."""
    return edge(CORNERS[number], CORNERS[(number + 1) % 5], side)


def _ground(c: Canvas) -> None:
    apron(c, "lots", CORNERS, PAVEMENT_HEIGHT)
    for number, begin, deep in LANES:
        line = _edge(number, -1)
        a, b, far = begin - 2.4, begin + LANE + 2.4, deep + 2.4
        ring = [line.at(a, 0.0), line.at(b, 0.0), line.at(b, far), line.at(a, far)]
        for s in (a, b):
            c.cut(line.at(s, -0.1), line.at(s, 3.0), "lots")
        c.ground(f"lane_lots_{number}", "sidewalk", ring, PAVEMENT_HEIGHT)
    c.ground("square", "sidewalk", CORNERS, PAVEMENT_HEIGHT)
    for number, begin, deep in LANES:
        line = _edge(number, -1)
        ring = [line.at(begin, 0.0), line.at(begin + LANE, 0.0), line.at(begin + LANE, deep), line.at(begin, deep)]
        c.ground(f"lane_{number}", "sidewalk", ring, PAVEMENT_HEIGHT)
    church = _edge(3, 1)
    c.ground("terrace", "sidewalk", [church.at(s, d) for s, d in ((8, 0), (26, 0), (26, 5), (8, 5))], TERRACE_HEIGHT)
    foot, top = [(*church.at(5.0, d), PAVEMENT_HEIGHT) for d in (0.4, 2.6)], (*church.at(8.0, 0.4), TERRACE_HEIGHT)
    ramp = [church.at(s, d) for s, d in ((5.0, 0.4), (8.0, 0.4), (8.0, 2.6), (5.0, 2.6))]
    c.slope("terrace_ramp", "sidewalk", ramp, [*foot, top])
    c.stairs("steps", church.at(17.0, 5.64), church.degrees - 90.0, 5.0, 2)
    c.cut(church.at(-3.0, 5.0), church.at(47.0, 5.0), "square")
    for s in (5.0, 8.0, 26.0):
        c.cut(church.at(s, -0.1), church.at(s, 5.1), "square")
    for x, y in CORNERS:
        c.cut((x, y), polar((x, y), math.degrees(math.atan2(y - CROSS[1], x - CROSS[0])), 9.0), "lots")
    c.wear((20.0, 4.0), "sidewalk/setts_bows")
    c.wear(church.at(15.0, 2.0), "sidewalk/limestone_polished")
    c.sky("summer_noon-few_cumulus")


def _fronts(c: Canvas) -> None:
    rows = {
        0: (("cafe", "pharmacy", "bakery"), ("bank",)),
        1: (("flower shop",), ("hotel",)),
        4: (("butcher shop", "cheese shop"), ("bookstore", "house")),
    }
    for number, begin, deep in LANES:
        line = _edge(number, -1)
        length = math.dist(CORNERS[number], CORNERS[(number + 1) % 5])
        first, second = rows[number]
        c.houses(line, first, 0.1, begin, 0.0)
        c.houses(line, second, begin + LANE, length - 0.1, 0.0)
        c.houses(line, ("house",), begin - 2.2, begin + LANE + 2.2, deep)
    c.put("church", *_edge(3, -1).at(17.0, 15.2), _edge(3, -1).facing("street"), 0)
    c.houses(_edge(3, -1), ("house",), 0.1, 9.0, 0.0)
    c.houses(_edge(3, -1), ("apartment building", "bar"), 25.2, 43.9, 0.0)
    c.houses(_edge(2, -1), ("apartment building", "clothing store"), 0.1, 23.3, 0.0)


def _stalls(c: Canvas) -> None:
    """Three rings of stalls: the inner one faces outward, the outer ones inward, with queues between them."""
    c.put("obelisk", *CROSS, 20.0, 0)
    for bearing in (45.0, 135.0, 225.0, 315.0):
        c.put("guard stone", *polar(CROSS, bearing, 1.5), bearing, 0)
    for bearing in (20.0, 75.0, 135.0, 195.0, 250.0, 305.0):
        c.put("street food stall", *polar(CROSS, bearing, 5.4), bearing, 0)
        c.put("storage box", *polar(CROSS, bearing + 17.0, 5.9), bearing, 2)
        c.put("storage box", *polar(CROSS, bearing - 18.0, 5.9), bearing + 30.0, 0)
        c.put("pedestrian adult", *polar(CROSS, bearing + 4.0, 7.5), bearing + 180.0)
    for bearing, variant in (
        (5.0, 1),
        (40.0, 0),
        (85.0, 2),
        (125.0, 0),
        (190.0, 1),
        (225.0, 2),
        (265.0, 0),
        (325.0, 2),
    ):
        c.put("canopy", *polar(CROSS, bearing, 13.6), bearing + 180.0, variant)
        c.put("counter", *polar(CROSS, bearing, 11.2), bearing + 180.0, 0)
        c.put("storage box", *polar(CROSS, bearing + 11.5, 13.6), bearing + 20.0, 1)
    for bearing, reach, turn, label in (
        (20.0, 8.9, 60.0, "pedestrian adult"),
        (47.0, 9.8, 30.0, "elderly person"),
        (81.0, 10.3, 80.0, "pedestrian adult"),
        (88.0, 10.2, 95.0, "pedestrian child"),
        (122.0, 10.3, 120.0, "pedestrian adult"),
        (131.0, 9.8, 140.0, "stroller"),
        (170.0, 8.4, 250.0, "pedestrian adult"),
        (188.0, 10.2, 190.0, "pedestrian adult"),
        (228.0, 10.2, 230.0, "elderly person"),
        (262.0, 10.3, 260.0, "pedestrian adult"),
        (320.0, 10.2, 330.0, "pedestrian adult"),
        (345.0, 9.0, 80.0, "dog"),
        (350.0, 10.2, 90.0, "pedestrian adult"),
        (290.0, 9.0, 200.0, "handcart"),
        (150.0, 10.4, 300.0, "shopping cart"),
    ):
        c.put(label, *polar(CROSS, bearing, reach), turn)


def _sides(c: Canvas) -> None:
    south, east, north, west = (_edge(n, 1) for n in (0, 1, 2, 4))
    # the café on the south side, beside its lane the bank
    for s, d in ((3.4, 1.6), (6.2, 1.7), (9.2, 1.6), (4.8, 3.8), (7.8, 3.9)):
        table(c, *south.at(s, d), (south.degrees, south.degrees + 180.0), 0)
    c.along(
        south,
        [
            ("sunshade", 5.0, 2.7, 0.0),
            ("sunshade", 8.4, 2.8, 0.0),
            ("advertising board", 11.2, 2.6, "+"),
            ("plant pot", 1.6, 3.6, 0.0, 0),
            ("bench", 14.6, 0.7, "street", 0),
            ("trash bin", 17.0, 0.6, "street", 1),
            ("bicycle", 20.4, 0.8, "+"),
            ("bicycle", 22.6, 0.9, "-"),
            ("barrel or bucket", 29.4, 0.7, 0.0, 0),
            ("atm", 36.4, 0.6, "street", 0),
            ("lamppost", 38.6, 1.4, "street", 0),
            ("lamppost", 13.0, 2.0, "street", 0),
            ("street cabinet", 31.0, 0.7, "street", 0),
            ("van", 35.6, 3.6, 20.0),
            ("parcels", 31.8, 3.4, 10.0),
            ("delivery worker", 31.0, 2.4, "-"),
            ("potted plant", 33.4, 0.8, "street", 0),
        ],
    )
    c.along(
        east,
        [
            ("flower", 1.8, 0.9, 0.0, 0),
            ("flower", 3.2, 1.0, 0.0, 1),
            ("plant pot", 4.6, 0.8, 0.0, 0),
            ("plant pot", 5.8, 0.9, 0.0, 1),
            ("cabinet or shelf", 7.6, 0.7, "street", 1),
            ("advertising board", 9.8, 1.7, "-"),
            ("bollard", 10.4, 0.4, "street"),
            ("bollard", 14.0, 0.4, "street"),
            ("luggage", 18.0, 0.8, 20.0),
            ("suitcase", 18.9, 0.9, 70.0),
            ("taxi", 21.4, 3.0, "+"),
            ("potted plant", 24.6, 0.8, "street", 1),
            ("bench", 26.2, 0.8, "street", 1),
        ],
    )
    c.along(
        north,
        [
            ("advertising board", 6.6, 1.5, "+"),
            ("counter", 3.2, 0.8, "street", 0),
            ("storage box", 5.2, 0.7, "street", 0),
            ("bookcase", 8.4, 0.6, "street", 1),
            ("bookcase", 10.4, 0.6, "street", 0),
            ("trash bin", 12.4, 0.7, "street", 0),
            ("bulletin board", 14.2, 0.6, "street", 1),
            ("scooter", 16.2, 1.0, 60.0, 0),
            ("scooter", 17.6, 1.2, 10.0, 1),
            ("motorcycle", 19.6, 1.3, 70.0),
            ("motorcycle", 21.2, 1.3, 75.0),
            ("lamppost", 15.4, 2.2, "street", 1),
        ],
    )
    c.along(
        west,
        [
            ("waste station", 3.4, 1.3, "street", 0),
            ("garbage bag", 6.2, 0.8, 20.0, 0),
            ("garbage bag", 7.2, 0.9, 80.0, 1),
            ("coatrack", 24.0, 0.8, "street", 2),
            ("coatrack", 25.4, 0.8, "street", 2),
            ("advertising board", 20.6, 1.6, "+"),
            ("telephone booth", 34.0, 1.0, "street"),
            ("water point", 22.0, 3.2, "street", 0),
        ],
    )
    barrel(c, *west.at(28.0, 1.6), (0.0, 120.0, 240.0))
    barrel(c, *west.at(31.0, 1.6), (60.0, 200.0))
    bicycles(c, *west.at(9.6, 2.9), 20.0, (False, True, False), rack=False)
    c.trees(west, (12.6,), 4.0, "broad")
    c.trees(north, (9.0, 17.0), 3.4, "street")
    c.trees(south, (16.0,), 3.6, "street")
    church = _edge(3, 1)
    c.along(
        church,
        [
            ("bench", 11.0, 0.8, "street", 0),
            ("potted plant", 13.2, 0.8, "street", 1),
            ("potted plant", 20.8, 0.8, "street", 1),
            ("bench", 23.4, 0.8, "street", 0),
            ("elderly person", 12.4, 2.6, "street"),
            ("pedestrian adult", 19.0, 2.8, "wall"),
            ("pedestrian adult", 21.8, 3.2, 30.0),
            ("lamppost", 29.4, 1.6, "street", 0),
        ],
    )
    for number, begin, _ in LANES:
        lane = _edge(number, -1)
        c.along(
            lane,
            [
                ("bicycle", begin + 0.6, 4.4, 90.0),
                ("trash bin", begin + LANE - 0.6, 8.0, -90.0, 1),
                ("storage box", begin + 0.7, 9.4, 10.0, 2),
                ("pedestrian adult", begin + 2.6, 5.6, 80.0),
                ("cat", begin + 2.2, 10.4, 30.0),
            ],
        )
    people(
        c,
        [
            ("pedestrian adult", 6.0, 14.0, 0.0),
            ("pedestrian adult", 7.0, 15.4, 250.0),
            ("wheelchair user", 12.6, 7.4, 90.0),
            ("police officer", 42.0, 6.0, 140.0),
            ("pedestrian adult", 47.2, 14.0, 200.0),
            ("pedestrian child", 10.0, 24.6, 40.0),
            ("pedestrian child", 11.4, 25.6, 210.0),
            ("delivery robot", 40.0, 24.4, 150.0),
            ("bird", 21.0, 30.6, 60.0),
            ("bird", 21.8, 31.2, 160.0),
        ],
    )


def build() -> Canvas:
    c = blank(ID)
    _ground(c)
    _fronts(c)
    _stalls(c)
    _sides(c)
    church = _edge(3, 1)
    c.trajectory = [
        _edge(0, -1).at(26.2, 10.0),
        _edge(0, 1).at(26.2, 2.6),
        polar(CROSS, 285.0, 9.0),
        polar(CROSS, 340.0, 8.6),
    ]
    c.trajectory += [
        _edge(1, 1).at(12.2, 2.0),
        _edge(1, -1).at(12.2, 9.0),
        _edge(1, 1).at(12.2, 2.0),
        church.at(3.4, 1.6),
    ]
    c.trajectory += [church.at(9.6, 2.4), church.at(16.0, 2.6), church.at(3.4, 1.6), polar(CROSS, 55.0, 9.0)]
    c.trajectory += [polar(CROSS, 105.0, 9.0), _edge(4, 1).at(17.2, 2.6), _edge(4, -1).at(17.2, 10.0)]
    c.trajectory += [_edge(4, 1).at(17.2, 2.6), _edge(4, 1).at(22.0, 5.8), _edge(0, 1).at(12.0, 5.4)]
    return c
