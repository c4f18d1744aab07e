"""A school street when lessons end: cars wait in two rows, parents and children fill the pavement and the forecourt.

The road (6 m) runs north, shifts 7 m to the east and runs on; a raised crossing lies before the school's forecourt,
a dropped kerb further south. Railings keep the pavement apart from the road where children come out.
"""

from ..canvas import ground_layers as lay
from ..canvas.canvas import Canvas, edge, edges
from ..canvas.pieces import bicycles, blank, chain, people, table

ID = "v06_school_street_with_chicane"
PAVEMENT_HEIGHT, HALF, WALK = 0.14, 3.0, 4.2
MIDDLE = [(0.0, 0.0), (0.0, 20.0), (7.0, 29.0), (7.0, 62.0)]
L1, L2, L3 = edges(MIDDLE, HALF, 1)
R1, R2, R3 = edges(MIDDLE, HALF, -1)
#: The forecourt: a rectangle east of the upper stretch.
COURT = (14.2, 32.0, 26.8, 58.0)


def _ground(c: Canvas) -> None:
    box = lay.rectangle
    x0, y0, x1, y1 = COURT
    c.ground("lots", "sidewalk", lay.strip(MIDDLE, 2 * (HALF + WALK) + 4.8), PAVEMENT_HEIGHT)
    c.ground("court_lots", "sidewalk", box(x0, y0 - 2.4, x1 + 2.4, y1 + 2.4), PAVEMENT_HEIGHT)
    c.ground("south_lots", "sidewalk", box(-9.6, -2.4, 9.6, 0.0), PAVEMENT_HEIGHT)
    c.ground("north_lots", "sidewalk", box(-2.6, 62.0, 16.6, 64.4), PAVEMENT_HEIGHT)
    c.ground("pavement", "sidewalk", lay.strip(MIDDLE, 2 * (HALF + WALK)), PAVEMENT_HEIGHT)
    c.ground("court", "sidewalk", box(x0, y0, x1, y1), PAVEMENT_HEIGHT)
    c.ground("lawn", "ground", box(20.0, 33.0, 25.0, 41.0), PAVEMENT_HEIGHT)
    c.ground("road", "road", lay.strip(MIDDLE, 2 * HALF))
    c.ground("table", "crosswalk", box(4.0, 42.0, 10.0, 47.0), PAVEMENT_HEIGHT)
    c.slope(
        "table_up", "road", box(4.0, 40.4, 10.0, 42.0), [(4.0, 40.4, 0), (10.0, 40.4, 0), (4.0, 42.0, PAVEMENT_HEIGHT)]
    )
    c.slope(
        "table_down",
        "road",
        box(4.0, 47.0, 10.0, 48.6),
        [(4.0, 48.6, 0), (10.0, 48.6, 0), (4.0, 47.0, PAVEMENT_HEIGHT)],
    )
    c.ground("crossing", "crosswalk", box(-3.0, 8.0, 3.0, 12.0))
    c.ramp("ramp_west", (-3.0, 10.0), 180.0)
    c.ramp("ramp_east", (3.0, 10.0), 0.0)
    for number in (1, 2):
        c.cut(edges(MIDDLE, 9.8, 1)[number].start, edges(MIDDLE, 9.8, -1)[number].start)
    c.cut(L2.at(5.5, 8.0), R2.at(5.5, 8.0))
    c.dashes("middle_south", (0.0, 0.5), (0.0, 7.5))
    c.dashes("middle_north", (7.0, 50.0), (7.0, 61.5))
    c.wear("road", "road/asphalt_used-patched")
    c.wear((-5.0, 4.0), "sidewalk/concrete_grey")
    c.wear("ground", "grass_dry")
    c.wear("crosswalk", "zebra_new")
    c.wear("road_marking", "paint_white")
    c.sky("summer_noon-few_cumulus")


def _fronts(c: Canvas) -> None:
    x0, y0, x1, y1 = COURT
    c.houses(edge((x1, y0), (x1, y1), -1), ("school", "school"), 0.0, y1 - y0, 0.0)
    c.houses(edge((x0, y0), (x1, y0), -1), ("house",), 0.2, 9.0, 0.0)
    c.put("wall", x1 - 1.7, y0 - 0.2, 90.0, size=(0.28, 3.2, 1.9))
    c.houses(edge((x0, y1), (x1, y1), 1), ("community center",), 0.0, 12.5, 0.0)
    c.houses(L1, ("house", "bakery"), 0.0, 20.4, WALK)
    c.houses(L2, ("house",), 0.0, 7.0, WALK)
    c.houses(L3, ("apartment building", "house", "convenience store"), 4.5, 32.0, WALK)
    c.houses(R1, ("apartment building",), 0.0, 14.4, WALK)
    c.houses(R2, ("garage",), 4.4, 9.6, WALK)
    chain(c, "wall", [R2.at(10.0, WALK + 0.4), (14.1, 31.2)], 0, stretch=1.4)
    chain(c, "wall", [(-7.4, 20.6), L2.at(-0.6, WALK + 0.2)], 3, stretch=1.4)
    c.houses(edge((-9.6, 0.0), (9.6, 0.0), -1), ("house", "house"), 0.0, 19.2, 0.0)
    c.houses(edge((-0.1, 62.0), (13.2, 62.0), 1), ("apartment building",), 0.0, 13.3, 0.0)


def _south(c: Canvas) -> None:
    c.along(
        L1,
        [
            ("street light", 3.0, 0.45, "street"),
            ("street light", 18.0, 0.45, "street"),
            ("trash bin", 5.2, 3.8, "street", 0),
            ("bicycle", 14.6, 3.7, "+"),
            ("bicycle", 16.6, 3.7, "-"),
            ("bollard", 7.6, 0.35, "street"),
            ("bollard", 12.4, 0.35, "street"),
            ("advertising board", 13.2, 2.4, "+"),
            ("bench", 18.6, 3.7, "street", 0),
            ("pedestrian adult", 6.2, 1.6, "+"),
            ("pedestrian child", 7.2, 1.2, "+"),
            ("stroller", 15.8, 1.4, "-"),
            ("pedestrian adult", 17.0, 1.6, "-"),
            ("caution sign", 2.0, 0.45, "-", 0),
            ("sedan", 4.2, -1.2, "-"),
            ("hatchback car", 16.0, -1.2, "-"),
        ],
    )
    c.along(
        R1,
        [
            ("street light", 14.6, 0.45, "street"),
            ("garbage bag", 3.2, 3.7, 10.0, 0),
            ("garbage bag", 4.2, 3.6, 70.0, 1),
            ("trash bin", 5.4, 3.7, "street", 0),
            ("bollard", 7.6, 0.35, "street"),
            ("bollard", 12.4, 0.35, "street"),
            ("mailbox", 13.6, 3.9, "street", 0),
            ("tree", 5.8, 0.9, 0.0),
            ("tree", 18.4, 0.9, 0.0),
            ("elderly person", 15.4, 2.0, "+"),
            ("potted plant", 17.2, 3.7, "street", 0),
            ("scooter", 2.0, 1.4, 70.0, 1),
            ("street cabinet", 20.0, 3.7, "street", 0),
            ("suv", 3.6, -1.25, "+"),
            ("minivan", 17.0, -1.25, "+"),
        ],
    )
    # the bend: a flower bed narrows the road, and parents' cars stand on it
    c.along(
        L2,
        [
            ("plant pot", 3.0, 0.7, 0.0, 0),
            ("plant pot", 4.2, 0.7, 0.0, 1),
            ("bench", 7.4, 3.6, "street", 1),
            ("backpack", 6.0, 3.6, 30.0, 0),
            ("pedestrian adult", 5.8, 1.9, "+"),
            ("pedestrian child", 8.4, 1.5, 200.0),
            ("traffic sign", 9.8, 0.5, "-", 0),
        ],
    )
    c.along(
        R2,
        [
            ("parking meter", 2.0, 0.4, "street"),
            ("bicycle", 4.4, 3.6, "+"),
            ("pedestrian adult", 5.8, 1.2, 160.0),
            ("pedestrian child", 6.8, 1.6, 160.0),
            ("bulletin board", 8.6, 3.8, "street", 0),
            ("pickup truck", 5.0, -1.3, "+"),
        ],
    )


def _before_the_school(c: Canvas) -> None:
    for s0, s1 in ((4.2, 12.6), (18.6, 27.4)):
        chain(c, "guard rail", [R3.at(s0, 0.3), R3.at(s1, 0.3)], stretch=1.2)
    c.along(
        R3,
        [
            ("street light", 2.6, 0.45, "street"),
            ("street light", 28.4, 0.45, "street"),
            ("traffic controller", 13.0, 0.6, "street"),
            ("caution sign", 18.0, 0.7, "-", 1),
            ("pedestrian adult", 5.0, 1.9, 70.0),
            ("pedestrian child", 6.0, 1.5, 80.0),
            ("pedestrian adult", 8.6, 2.4, 10.0),
            ("stroller", 10.2, 1.4, "-"),
            ("pedestrian adult", 11.6, 1.5, "-"),
            ("pedestrian adult", 19.4, 2.2, 120.0),
            ("pedestrian child", 20.4, 1.3, 200.0),
            ("elderly person", 24.0, 1.6, "+"),
            ("backpack", 21.6, 3.4, 10.0, 1),
            ("scooter", 30.0, 3.4, 40.0, 0),
            ("school bus", 26.2, -1.5, "+"),
            ("suv", 4.0, -1.25, "+"),
        ],
    )
    c.along(
        L3,
        [
            ("tree", 3.6, 0.9, 0.0),
            ("tree", 9.4, 0.9, 0.0),
            ("tree", 24.4, 0.9, 0.0),
            ("street light", 20.6, 0.45, "street"),
            ("bench", 6.6, 0.8, "wall", 0),
            ("trash bin", 11.0, 0.7, "wall", 1),
            ("bollard", 12.8, 0.35, "street"),
            ("bollard", 18.4, 0.35, "street"),
            ("pedestrian adult", 13.8, 1.8, "street"),
            ("pedestrian child", 15.0, 1.6, "street"),
            ("dog", 16.8, 2.4, 30.0),
            ("vending machine", 26.0, 3.7, "street"),
            ("shopping cart", 28.4, 3.6, "+", 0),
            ("advertising board", 23.0, 3.4, "-"),
            ("storage box", 30.2, 3.7, "street", 2),
            ("newspaper stand", 31.2, 3.7, "street"),
            ("bicycle", 4.6, 3.7, "-"),
            ("postbox", 21.8, 0.6, "wall"),
            ("pedestrian adult", 25.6, 1.4, "+"),
            ("potted plant", 2.0, 3.8, "street", 1),
            ("delivery worker", 28.8, 1.4, "-"),
            ("sedan", 4.8, -1.2, "-"),
            ("taxi", 24.0, -1.2, "-"),
            ("hatchback car", 29.4, -1.2, "-"),
        ],
    )


def _court(c: Canvas) -> None:
    chain(c, "fence", [(14.3, 57.8), (14.3, 49.0)], stretch=2.2)
    chain(c, "fence", [(14.3, 40.4), (14.3, 34.8)], stretch=2.2)
    for y in (40.6, 43.0, 46.4, 48.8):
        c.put("guard stone", 14.3, y, 0.0, 0)
    bicycles(c, 16.0, 55.4, 90.0, (False, True, False, True, False), rack=False)
    bicycles(c, 21.0, 55.4, 90.0, (True, False, False), rack=False)
    c.put("tree", 22.4, 35.6, 20.0, size=(5.3, 5.5, 6.6))
    c.put("tree", 18.6, 51.0, 70.0)
    c.put("bench", 18.6, 52.6, -90.0, 0)
    c.put("bench", 19.2, 36.0, 180.0, 0)
    c.put("bench", 19.2, 39.4, 180.0, 1)
    c.put("table-tennis table", 16.4, 36.4, 20.0, 0)
    c.put("flag", 24.6, 43.4, 180.0, 0)
    c.put("trash bin", 25.3, 50.4, 180.0, 2)
    c.put("potted plant", 25.3, 46.6, 180.0, 0)
    c.put("potted plant", 25.3, 42.4, 180.0, 0)
    c.put("water point", 25.4, 52.6, 180.0, 0)
    table(c, 22.8, 48.2, (0.0, 180.0), 0)
    c.put("advertising board", 21.4, 46.4, 180.0)
    c.put("football", 17.4, 33.6, 0.0)
    c.put("skateboard", 15.0, 39.4, 30.0, 0)
    people(
        c,
        [
            ("pedestrian child", 15.8, 43.4, 180.0),
            ("pedestrian child", 16.8, 42.8, 190.0),
            ("pedestrian child", 18.4, 46.6, 160.0),
            ("pedestrian child", 20.4, 44.0, 180.0),
            ("pedestrian adult", 17.0, 48.6, 30.0),
            ("pedestrian adult", 18.0, 49.4, 210.0),
            ("pedestrian child", 22.2, 50.6, 240.0),
            ("pedestrian child", 15.4, 34.0, 10.0),
            ("pedestrian child", 18.2, 34.4, 200.0),
            ("pedestrian adult", 23.6, 44.8, 180.0),
            ("wheelchair user", 20.6, 41.8, 170.0),
            ("pedestrian child", 15.2, 52.2, 80.0),
            ("pedestrian adult", 15.0, 47.0, 190.0),
            ("roller skater", 17.8, 40.8, 120.0),
        ],
    )


def build() -> Canvas:
    c = blank(ID)
    _ground(c)
    _fronts(c)
    _south(c)
    _before_the_school(c)
    _court(c)
    c.trajectory = [(-5.2, 1.4), (-5.0, 10.0), (5.0, 10.0), (4.6, 2.0), (5.0, 10.0), (4.4, 18.6), R2.at(7.4, 2.2)]
    c.trajectory += [
        R3.at(1.6, 1.8),
        R3.at(15.6, 1.8),
        (15.6, 45.0),
        (22.0, 45.4),
        (20.0, 52.0),
        (17.6, 38.6),
        (15.6, 45.0),
    ]
    c.trajectory += [
        (2.2, 44.5),
        L3.at(30.0, 2.0),
        (2.2, 44.5),
        L3.at(3.0, 2.2),
        L2.at(6.4, 1.2),
        (-4.8, 18.6),
        (-5.0, 10.0),
    ]
    return c
