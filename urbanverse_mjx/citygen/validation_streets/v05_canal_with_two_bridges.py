"""Two quays along a canal, joined by a level and a humped bridge, with a ramp beside every step.

The canal (8 m wide) runs east. The eastern half of both quays lies 40 cm higher than the western one: a ramp of 1:12
along the water, steps along the fronts. Trees, moored boats, bicycles, terraces and boxes stand on 5.6 m of quay.
"""

from ..canvas import ground_layers as lay
from ..canvas.canvas import Canvas, edge
from ..canvas.pieces import bicycles, blank, chain, people, tables

ID = "v05_canal_with_two_bridges"
LENGTH, HALF, QUAY = 76.0, 4.0, 5.6
LOW_QUAY_HEIGHT, HIGH_QUAY_HEIGHT, BRIDGE_HEIGHT, WATER_HEIGHT = 0.15, 0.55, 0.83, -0.7
NORTH, SOUTH = edge((0.0, HALF), (LENGTH, HALF), 1), edge((0.0, -HALF), (LENGTH, -HALF), -1)
WEST_BRIDGE, EAST_BRIDGE = (16.0, 19.6), (58.0, 61.6)
RISE = (38.0, 42.8)  # m, where the quays climb


def _ground(c: Canvas) -> None:
    box = lay.rectangle
    for side, name in ((1, "north"), (-1, "south")):
        inner, outer, lots = side * HALF, side * (HALF + QUAY), side * (HALF + QUAY + 2.4)
        middle = side * (HALF + 2.9)
        a, b = _span(inner, lots)
        c.ground(f"{name}_low", "sidewalk", box(0.0, a, RISE[0], b), LOW_QUAY_HEIGHT)
        c.ground(f"{name}_high", "sidewalk", box(RISE[1], a, LENGTH, b), HIGH_QUAY_HEIGHT)
        a, b = _span(outer, lots)
        c.ground(f"{name}_lots", "sidewalk", box(RISE[0], a, RISE[1], b), LOW_QUAY_HEIGHT)
        slope = [
            (RISE[0], inner, LOW_QUAY_HEIGHT),
            (RISE[0], middle, LOW_QUAY_HEIGHT),
            (RISE[1], inner, HIGH_QUAY_HEIGHT),
        ]
        a, b = _span(inner, middle)
        c.slope(f"{name}_ramp", "sidewalk", box(RISE[0], a, RISE[1], b), slope)
        a, b = _span(middle, outer)
        c.ground(f"{name}_ledge", "sidewalk", box(RISE[0], a, RISE[1], b), LOW_QUAY_HEIGHT)
        c.stairs(f"{name}_steps", (RISE[1] - 0.96, (middle + outer) / 2), 0.0, abs(outer - middle), 3)
    c.ground("canal", "road", box(0.0, -HALF, LENGTH, HALF), WATER_HEIGHT)
    c.ground("bridge_west", "sidewalk", box(WEST_BRIDGE[0], -HALF, WEST_BRIDGE[1], HALF), LOW_QUAY_HEIGHT)
    x0, x1 = EAST_BRIDGE
    c.ground("bridge_east", "sidewalk", box(x0, -0.8, x1, 0.8), BRIDGE_HEIGHT)
    c.slope(
        "bridge_up",
        "sidewalk",
        box(x0, -HALF, x1, -0.8),
        [(x0, -HALF, HIGH_QUAY_HEIGHT), (x1, -HALF, HIGH_QUAY_HEIGHT), (x0, -0.8, BRIDGE_HEIGHT)],
    )
    c.slope(
        "bridge_down",
        "sidewalk",
        box(x0, 0.8, x1, HALF),
        [(x0, HALF, HIGH_QUAY_HEIGHT), (x1, HALF, HIGH_QUAY_HEIGHT), (x0, 0.8, BRIDGE_HEIGHT)],
    )
    c.ground("west_end", "sidewalk", box(-7.0, -12.0, 0.0, 12.0), LOW_QUAY_HEIGHT)
    c.ground("east_end", "sidewalk", box(LENGTH, -12.0, LENGTH + 5.0, 12.0), HIGH_QUAY_HEIGHT)
    c.wear((10.0, 6.0), "sidewalk/setts_small")
    c.wear((17.0, 0.0), "sidewalk/boardwalk")
    c.wear((60.0, 0.0), "sidewalk/granite_light")
    c.wear((30.0, 0.0), "road/asphalt_new-wet")
    c.sky("summer_afternoon-scattered_cumulus")


def _span(a: float, b: float) -> tuple[float, float]:
    return min(a, b), max(a, b)


def _fronts(c: Canvas) -> None:
    north = ("house", "cafe", "apartment building", "bookstore")
    c.houses(NORTH, north, 0.0, RISE[0] - 0.2, QUAY)
    c.houses(NORTH, ("restaurant", "house", "flower shop", "hotel"), RISE[0], LENGTH, QUAY)
    c.houses(SOUTH, ("bicycle shop", "house", "bar", "house"), 0.0, RISE[0] - 0.2, QUAY)
    c.houses(SOUTH, ("house", "bakery", "clothing store", "apartment building"), RISE[0], LENGTH, QUAY)
    c.houses(edge((-4.6, -12.0), (-4.6, 12.0), 1), ("bank", "house"), 0.0, 24.0, 0.0)
    c.houses(edge((LENGTH + 3.0, -12.0), (LENGTH + 3.0, 12.0), -1), ("pub", "apartment building"), 0.0, 24.0, 0.0)


def _rails(c: Canvas) -> None:
    """Railings on the bridges and the ramps, and remaining pieces along the water."""
    for x, inside in ((WEST_BRIDGE[0], 0.12), (WEST_BRIDGE[1], -0.12)):
        chain(c, "fence", [(x + inside, -3.9), (x + inside, 3.9)], stretch=2.2)
    # posts on the humped bridge, because a piece of railing would stand on two slopes
    for x, inside in ((EAST_BRIDGE[0], 0.2), (EAST_BRIDGE[1], -0.2)):
        for k in range(11):
            c.put("bollard", x + inside, 0.76 * (k - 5), 0.0)
    for side in (1.0, -1.0):
        for s0, s1 in ((20.4, 37.6), (43.4, 57.2), (62.4, 75.4)):
            chain(c, "fence", [(s0, side * 4.12), (s1, side * 4.12)], stretch=2.2)
    c.row("bollard", NORTH, (1.0, 3.0, 5.0, 7.0, 9.0, 11.0, 13.0, 15.0), 0.3)
    c.row("guard stone", SOUTH, (1.0, 3.2, 5.4, 7.6, 9.8, 12.0, 14.2), 0.35)


def _boats(c: Canvas) -> None:
    size = (4.9, 1.85, 1.4)
    for x, y, degrees in (
        (8.0, 2.6, 0.0),
        (28.0, -2.6, 180.0),
        (34.0, 2.5, 2.0),
        (47.0, 2.6, 178.0),
        (69.0, -2.6, 0.0),
    ):
        c.put("boat", x, y, degrees, size=size)
    for x, y in ((24.0, 0.4), (26.0, 0.9), (51.0, -1.6)):
        c.put("duck", x, y, 40.0)


def _north(c: Canvas) -> None:
    c.trees(NORTH, (2.0, 12.0, 24.0, 34.0, 46.0, 65.0, 73.0), 1.0)
    for s in (7.0, 29.0, 54.6, 69.0):
        c.put("lamppost", *NORTH.at(s, 0.75), -90.0, 0)
    tables(c, NORTH, [(11.2, 4.8), (13.8, 4.7), (16.6, 4.8)])
    tables(c, NORTH, [(46.6, 4.8), (44.4, 4.7)])
    tables(c, NORTH, [(48.6, 1.2)], (30.0, 210.0))
    c.along(
        NORTH,
        [
            ("sunshade", 12.4, 2.9, 0.0),
            ("advertising board", 18.2, 4.0, "-"),
            ("bicycle", 4.6, 1.3, "+"),
            ("bicycle", 6.6, 5.1, "-"),
            ("potted plant", 1.0, 5.1, "street", 0),
            ("bench", 9.4, 1.0, "street", 0),
            ("trash bin", 21.8, 0.7, "street", 1),
            ("bench", 26.6, 1.0, "wall", 0),
            ("scooter", 22.4, 4.8, 60.0, 0),
            ("bookcase", 30.4, 5.15, "street", 1),
            ("bookcase", 32.4, 5.15, "street", 2),
            ("table", 34.4, 4.8, "street", 0),
            ("advertising board", 35.6, 3.8, "+"),
            ("street cabinet", 37.0, 5.0, "street", 0),
            ("motorcycle", 50.8, 4.9, "+"),
            ("storage box", 53.4, 5.1, "street", 2),
            ("flower", 58.0, 5.0, 0.0, 0),
            ("flower", 59.2, 5.0, 0.0, 1),
            ("plant pot", 60.4, 5.0, 0.0, 0),
            ("plant pot", 62.2, 5.0, 0.0, 1),
            ("advertising board", 63.6, 4.2, "-"),
            ("luggage", 67.2, 5.0, 30.0),
            ("taxi", 71.0, 4.2, "+"),
            ("bench", 62.8, 0.9, "wall", 0),
            ("parcels", 55.6, 5.1, 20.0),
        ],
    )
    people(
        c,
        [
            ("pedestrian adult", 3.4, 7.8, 0.0),
            ("pedestrian adult", 8.6, 7.4, 190.0),
            ("pedestrian adult", 14.8, 7.4, 90.0),
            ("elderly person", 27.4, 7.0, 180.0),
            ("pedestrian child", 31.0, 7.4, 80.0),
            ("pedestrian adult", 32.2, 7.7, 95.0),
            ("cyclist", 25.0, 8.2, 0.0),
            ("pedestrian adult", 36.8, 5.6, 10.0),
            ("wheelchair user", 49.6, 7.7, 180.0),
            ("pedestrian adult", 57.0, 7.2, 20.0),
            ("delivery worker", 55.0, 7.4, 120.0),
            ("dog", 66.4, 6.8, 170.0),
            ("pedestrian adult", 67.6, 7.2, 175.0),
        ],
    )


def _south(c: Canvas) -> None:
    c.trees(SOUTH, (8.8, 22.0, 31.0, 52.0, 63.4, 72.0), 1.0, "slim")
    for s in (13.0, 35.6, 48.6, 67.6):
        c.put("lamppost", *SOUTH.at(s, 0.75), 90.0, 0)
    bicycles(c, *SOUTH.at(4.0, 4.4), 90.0, (False, True, False, False), rack=False)
    tables(c, SOUTH, [(22.8, 4.8), (25.6, 4.7), (28.0, 4.8)])
    c.along(
        SOUTH,
        [
            ("bicycle", 7.4, 5.0, "+"),
            ("vehicle wheel", 8.9, 5.2, 20.0, 0),
            ("bicycle repair station", 1.0, 5.1, "street", 0),
            ("advertising board", 6.8, 2.6, "-"),
            ("potted plant", 11.4, 5.1, "street", 1),
            ("bench", 15.0, 5.0, "street", 0),
            ("garbage bag", 17.6, 5.1, 20.0, 0),
            ("trash bin", 18.6, 5.1, "street", 0),
            ("barrel or bucket", 20.8, 5.0, 0.0, 0),
            ("sunshade", 24.4, 2.7, 0.0),
            ("blackboard", 30.0, 4.0, "+", 2),
            ("handcart", 33.0, 4.5, 30.0, 1),
            ("storage box", 35.2, 5.1, "street", 1),
            ("mailbox", 36.8, 5.2, "street", 0),
            ("bench", 27.4, 1.0, "wall", 0),
            ("potted plant", 44.0, 5.1, "street", 0),
            ("counter", 49.4, 4.9, "street", 0),
            ("advertising board", 52.0, 4.1, "+"),
            ("coatrack", 57.4, 5.0, "street", 2),
            ("coatrack", 58.8, 5.0, "street", 2),
            ("scooter", 63.0, 4.6, 100.0, 1),
            ("bench", 55.0, 1.0, "wall", 1),
            ("trash bin", 56.6, 0.7, "wall", 1),
            ("washing machine", 66.4, 5.1, "street", 0),
            ("couch", 69.4, 4.9, "street", 1),
            ("parcels", 71.4, 5.0, 30.0),
            ("tricycle", 73.6, 4.2, "+"),
        ],
    )
    people(
        c,
        [
            ("pedestrian adult", 10.6, -6.4, 0.0),
            ("pedestrian adult", 12.0, -7.0, 170.0),
            ("pedestrian child", 19.8, -6.2, 60.0),
            ("pedestrian adult", 29.4, -5.6, 90.0),
            ("elderly person", 34.4, -6.0, 0.0),
            ("jogger", 46.2, -6.2, 180.0),
            ("pedestrian adult", 49.2, -6.4, -90.0),
            ("pedestrian adult", 50.2, -6.0, -80.0),
            ("stroller", 60.0, -6.0, 10.0),
            ("pedestrian adult", 58.8, -6.2, 10.0),
            ("maintenance worker", 68.0, -6.0, -90.0),
            ("cat", 17.0, -6.8, 40.0),
        ],
    )


def _bridges(c: Canvas) -> None:
    people(
        c,
        [
            ("pedestrian adult", 17.0, -1.4, 180.0),
            ("pedestrian adult", 18.9, 1.8, 80.0),
            ("bicycle", 16.6, 2.6, 90.0),
            ("pedestrian child", 59.0, 0.0, 180.0),
            ("pedestrian adult", -1.4, 2.0, 0.0),
            ("pedestrian adult", -2.0, -5.6, 80.0),
            ("delivery robot", 77.0, 2.4, -90.0),
        ],
    )
    c.put("bench", -3.9, 1.0, 0.0, 0)
    c.put("tree", -2.4, 5.4, 0.0)
    c.put("information point", -3.9, -2.6, 0.0, 0)
    c.put("bollard", -0.6, 0.0, 0.0)
    c.put("bollard", -0.6, -2.0, 0.0)
    c.put("sculpture", 77.6, 0.0, 180.0, 1)
    chain(c, "fence", [(-0.1, -3.9), (-0.1, 3.9)], stretch=2.2)
    chain(c, "fence", [(76.2, 3.9), (76.2, -3.9)], stretch=2.2)


def build() -> Canvas:
    c = blank(ID)
    c.sizes = {**c.sizes, "boat": ((4.9, 1.85, 1.4),)}
    _ground(c)
    _fronts(c)
    _rails(c)
    _boats(c)
    _north(c)
    _south(c)
    _bridges(c)
    c.trajectory = [
        (-2.0, 0.4),
        (2.0, 6.4),
        (17.8, 6.2),
        (17.8, -6.0),
        (2.0, -6.2),
        (17.8, -6.0),
        (30.0, -6.8),
        (40.4, -5.2),
    ]
    c.trajectory += [(50.0, -5.4), (60.0, -6.4), (60.2, 0.0), (59.8, 6.2), (74.0, 6.0), (77.8, -5.0), (70.0, -6.0)]
    c.trajectory += [(59.8, -6.0), (59.8, 6.2), (50.0, 6.0), (40.4, 5.4), (30.0, 6.6), (17.8, 6.2)]
    return c
