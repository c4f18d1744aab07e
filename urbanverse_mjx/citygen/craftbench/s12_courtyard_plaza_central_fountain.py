"""A courtyard behind the town hall: a fountain in a sunken square with chairs around it.

The square (38 by 26 m) lies 20 cm below the walk along its four fronts, and only four ramps lead down to it. Stalls, a
concert, a wedding, terraces, a scaffold and planters stand on both levels. A passage in the west leads to a yard of
bins and bicycles, one in the north past deliveries. The scene has no road.
"""

from ..canvas import ground_layers as lay
from ..canvas.canvas import Canvas, edge
from ..canvas.pieces import apron, barrel, bicycles, blank, people, table

ID = "12_courtyard_plaza_central_fountain"
SQUARE, WALK, TERRACE = 0.0, 0.2, 0.5
RAMP = 2.0  # m: 1:10


def _ground(c: Canvas) -> None:
    box = lay.rectangle
    whole = [(-24, -18), (24, -18), (24, 18), (18, 18), (18, 36), (14, 36), (14, 18), (-24, 18), (-24, 1), (-32, 1)]
    whole += [(-32, 5), (-44, 5), (-44, -7), (-33.5, -7), (-33.5, -3), (-24, -3)]
    apron(c, "lots", whole, WALK)
    c.ground("walk", "sidewalk", box(-24.0, -18.0, 24.0, 18.0), WALK)
    c.ground("passage_north", "sidewalk", box(14.0, 18.0, 18.0, 36.0), WALK)
    yard = [(-24, -3), (-24, 1), (-32, 1), (-32, 5), (-44, 5), (-44, -7), (-33.5, -7), (-33.5, -3)]
    c.ground("passage_west", "sidewalk", yard, WALK)
    c.ground("square", "sidewalk", box(-19.0, -13.0, 19.0, 13.0), SQUARE)
    ring = [(-3, -8), (3, -8), (8, -3), (8, 3), (3, 8), (-3, 8), (-8, 3), (-8, -3)]
    c.ground("ring", "sidewalk", ring, SQUARE)
    plinth = [(-1.5, -3.5), (1.5, -3.5), (3.5, -1.5), (3.5, 1.5), (1.5, 3.5), (-1.5, 3.5), (-3.5, 1.5), (-3.5, -1.5)]
    c.ground("plinth", "sidewalk", plinth, 0.15)
    # raised beds
    c.ground("bed_ne", "ground", box(10.0, 7.6, 16.5, 10.6), 0.4)
    c.ground("bed_se", "ground", box(10.0, -10.6, 16.5, -7.6), 0.4)
    c.ground("bed_sw", "ground", box(-16.5, -5.0, -13.5, 0.5), 0.4)
    # the town hall's steps and the ramp beside them
    c.ground("terrace", "sidewalk", box(-12.0, 15.5, 2.0, 18.0), TERRACE)
    c.slope(
        "terrace_ramp",
        "sidewalk",
        box(-15.0, 15.8, -12.0, 17.6),
        [(-15.0, 15.8, WALK), (-15.0, 17.6, WALK), (-12.0, 15.8, TERRACE)],
    )
    c.stairs("steps", (-5.0, 14.86), 90.0, 8.0, 2)
    c.ramp("ramp_west", (-19.0, 6.0), 180.0, 1.0, RAMP, parted=False)
    c.ramp("ramp_east", (19.0, -3.0), 0.0, 1.0, RAMP)
    c.ramp("ramp_north", (9.0, 13.0), 90.0, 1.0, RAMP, parted=False)
    c.ramp("ramp_south", (-8.0, -13.0), -90.0, 1.0, RAMP)
    c.wear((-21.0, 0.0), "sidewalk/flags_buff")
    # a layer with holes is split into parts, each with its own name
    for spot in ((-17.7, -2.2), (-10.7, -1.2), (10.6, 0.0), (16.1, 3.3)):
        c.wear(spot, "sidewalk/limestone_polished")
    for spot in ((-5.7, 0.0), (5.7, 0.0)):
        c.wear(spot, "sidewalk/setts_bows")
    c.wear((0.0, 2.0), "sidewalk/granite_dark")
    c.wear((0.0, 17.0), "sidewalk/granite_light")
    c.wear((16.0, 26.0), "sidewalk/concrete_grey-stained")
    c.wear((-40.0, 0.0), "sidewalk/concrete_grey-stained")
    c.wear("ground", "grass")
    c.sky("summer_afternoon-scattered_cumulus")


def _fronts(c: Canvas) -> None:
    c.houses(edge((-24, 18), (14, 18), 1), ("town hall",), 0, 38, 0)
    c.houses(edge((18, 18), (24.05, 18), 1), ("watch shop",), 0, 6.05, 0)
    c.houses(edge((24, -18), (24, 18), -1), ("apartment building", "cafe", "pastry shop", "flower shop"), 0, 36, 0)
    south = ("apartment building", "bar", "bistro", "apartment building", "photography shop")
    c.houses(edge((-24, -18), (24, -18), -1), south, 0, 48, 0)
    c.houses(edge((-24, -18), (-24, -3), 1), ("hotel",), 0, 15, 0)
    c.houses(edge((-24, 1), (-24, 18), 1), ("restaurant", "ice cream shop"), 0, 17, 0)
    c.houses(edge((18, 23.8), (18, 36), -1), ("house",), 0, 12.2, 0)
    c.houses(edge((14, 36), (18.01, 36), 1), ("garage",), 0, 4.01, 0)
    c.houses(edge((-44, -7), (-44, 5), 1), ("apartment building",), 0, 12, 0)
    c.houses(edge((-44, 5), (-32, 5), 1), ("house",), 0, 11.8, 0)
    c.houses(edge((-44, -7), (-33.5, -7), -1), ("laundry",), 0, 9.9, 0)


def _fountain(c: Canvas) -> None:
    c.put("fountain", 0.0, 0.0, 0.0, size=(3.77, 3.77, 2.42))
    for x, y, turn in ((5.3, 0.9, 90.0), (4.3, 4.2, 135.0), (-0.8, 5.4, 180.0), (-4.4, 4.0, 45.0), (-5.4, -1.0, 90.0)):
        c.put("bench", x, y, turn - 90.0, 2)
    for x, y, turn in ((-4.0, -4.4, 45.0), (1.2, -5.4, 90.0), (4.4, -4.0, 135.0)):
        c.put("stone block", x, y, turn, 1)
    for x, y in ((8.6, 8.4), (-8.6, 8.4), (-8.6, -8.4), (8.6, -8.4)):
        c.put("lamppost", x, y, 0.0, 1)
    people(
        c,
        [
            ("pedestrian child", -2.6, 4.4, -70.0),
            ("pedestrian child", 4.3, -1.8, 160.0),
            ("pedestrian adult", 5.6, -2.4, 170.0),
            ("pedestrian adult", -6.9, 2.0, -10.0),
            ("pedestrian adult", -6.6, 3.1, -30.0),
            ("pedestrian adult", 2.4, 7.2, -100.0),
            ("pedestrian adult", 6.6, 6.4, 215.0),
            ("elderly person", -2.6, -6.6, 70.0),
            ("pedestrian adult", 1.4, -7.4, 95.0),
            ("dog", 2.6, -7.0, 80.0),
            ("bird", -3.4, -6.0, 20.0),
            ("bird", -4.4, -6.6, 160.0),
            ("bird", -3.9, -7.3, 250.0),
            ("bird", 6.2, 2.6, 100.0),
            ("bird", 6.9, 3.4, 10.0),
            ("bird", 2.7, 2.6, 220.0),
        ],
    )
    c.put("tripod", 7.2, -0.6, 180.0, 0)
    c.put("luggage", -7.4, 3.9, 30.0, 1)
    c.put("skateboard", 7.4, -5.0, 60.0, 0)


def _beds(c: Canvas) -> None:
    for x, y, turn in ((11.2, 9.1, 10.0), (15.3, 9.1, 80.0), (11.2, -9.1, 140.0), (15.3, -9.1, 200.0)):
        c.put("tree", x, y, turn, size=(3.7, 3.4, 7.4))
    c.put("tree", -15.0, -2.3, 40.0, size=(5.3, 5.5, 6.6))
    for label, x, y, turn in (
        ("flower", 13.2, 8.1, 0.0),
        ("shrub", 13.3, 9.6, 0.0),
        ("flower", 10.7, 10.0, 80.0),
        ("flower", 13.2, -8.1, 0.0),
        ("shrub", 13.3, -9.6, 90.0),
        ("flower", 16.0, -10.0, 10.0),
        ("shrub", -14.9, -4.2, 0.0),
        ("flower", -14.9, -0.2, 0.0),
    ):
        c.put(label, x, y, turn)
    c.put("bench", 13.2, 7.1, -90.0, 0)
    c.put("bench", 13.2, -7.1, 90.0, 0)
    c.put("bench", -13.0, -2.4, 0.0, 0)
    c.put("trash bin", 9.4, 7.2, 0.0, 2)
    c.put("trash bin", -13.0, -5.6, 0.0, 0)


def _concert(c: Canvas) -> None:
    """The stage in the square's north-west, and the audience."""
    c.put("stage", -15.6, 9.6, -45.0, 2)
    c.put("stereo sound system", -17.8, 6.9, -45.0, 1)
    c.put("stereo sound system", -12.9, 11.9, -45.0, 1)
    c.put("drum", -11.4, 9.4, -45.0, 1)
    for x, y in ((-12.3, 5.4), (-11.0, 6.7), (-9.7, 8.0), (-11.4, 4.5), (-10.1, 5.8)):
        c.put("chair", x, y, 135.0, 0)
    people(
        c,
        [
            ("pedestrian adult", -13.1, 7.6, -40.0),
            ("pedestrian adult", -9.2, 4.6, 130.0),
            ("pedestrian child", -8.9, 5.6, 140.0),
            ("wheelchair user", -12.6, 3.4, 100.0),
            ("pedestrian adult", -8.2, 10.6, 190.0),
        ],
    )
    c.put("guitar", -13.6, 6.6, 30.0)


def _market(c: Canvas) -> None:
    """Stalls in two rows in the south of the square."""
    for x, y, turn, variant in (
        (-4.6, -11.4, 90.0, 0),
        (0.6, -11.5, 90.0, 1),
        (5.8, -11.4, 90.0, 0),
        (-11.6, -9.6, 0.0, 1),
        (-17.4, -9.8, 0.0, 0),
    ):
        c.put("street food stall", x, y, turn, variant)
    for label, x, y, turn, variant in (
        ("storage box", -2.0, -11.6, 10.0, 2),
        ("storage box", -2.1, -10.6, 80.0, 0),
        ("barrel or bucket", 3.2, -11.4, 0.0, 0),
        ("storage box", 3.2, -12.3, 20.0, 1),
        ("handcart", 9.0, -11.7, 20.0, 1),
        ("storage box", -15.1, -11.8, 30.0, 2),
        ("storage box", -11.6, -11.9, 0.0, 2),
        ("advertising board", -9.4, -8.2, 60.0, 0),
        ("storage box", -17.6, -7.6, 0.0, 1),
    ):
        c.put(label, x, y, turn, variant)
    people(
        c,
        [
            ("pedestrian adult", -4.4, -9.5, -90.0),
            ("pedestrian adult", -5.3, -9.2, -80.0),
            ("pedestrian adult", 0.9, -9.7, -95.0),
            ("elderly person", 5.6, -9.5, -90.0),
            ("pedestrian adult", 6.7, -9.2, -110.0),
            ("pedestrian adult", -9.8, -9.8, 180.0),
            ("pedestrian adult", -15.4, -9.4, 170.0),
            ("stroller", 3.5, -8.6, 0.0),
        ],
    )


def _town_hall(c: Canvas) -> None:
    """A wedding on the steps."""
    for x in (-11.1, 1.1):
        c.put("potted plant", x, 17.3, -90.0, 1)
        c.put("flag", x, 16.2, -90.0, 0)
    people(
        c,
        [
            ("pedestrian adult", -5.5, 16.4, -90.0),
            ("pedestrian adult", -4.6, 16.4, -90.0),
            ("pedestrian adult", -7.6, 16.9, -70.0),
            ("pedestrian adult", -2.4, 16.8, -110.0),
            ("pedestrian child", -6.6, 16.0, -80.0),
            ("pedestrian adult", -9.4, 16.8, -60.0),
            ("pedestrian adult", -0.6, 16.6, -120.0),
            ("pedestrian adult", -5.2, 12.0, 90.0),
            ("pedestrian adult", -3.6, 11.6, 100.0),
            ("pedestrian child", -6.9, 11.8, 75.0),
            ("security guard", 3.4, 17.0, -90.0),
        ],
    )
    c.put("tripod", -4.6, 10.4, 90.0, 1)
    c.put("convertible car", 5.0, 10.6, 170.0, 0)
    c.put("flower", -8.8, 16.0, 0.0, 0)
    c.put("flower", -1.4, 15.9, 0.0, 1)
    c.put("bulletin board", 5.4, 17.5, -90.0, 0)
    c.put("bicycle parking", 7.8, 17.2, -90.0, 0)
    c.put("bicycle", 10.4, 16.9, 85.0)
    c.put("scooter", 11.6, 16.6, 100.0, 0)
    c.put("scooter", 12.8, 15.7, 30.0, 1)
    c.put("sculpture", -17.6, 16.9, -90.0, 1)
    c.put("bench", -20.4, 17.4, -90.0, 0)
    c.put("street clock", -20.6, 14.6, -45.0, 1)
    c.put("trash bin", -22.9, 17.3, -90.0, 1)
    c.put("pedestrian adult", -15.6, 14.6, 10.0)
    c.put("delivery robot", 5.6, 14.2, 180.0)


def _terraces(c: Canvas) -> None:
    """Tables on the east and west walks, barrels in the south."""
    for x, y in ((22.6, 16.2), (22.6, 13.4), (22.6, 8.4), (22.6, 5.6), (22.6, 2.8)):
        table(c, x, y, (90.0, 270.0))
    for x, y in ((20.3, 14.8), (20.2, 7.0), (20.2, 4.0)):
        table(c, x, y, (80.0, 260.0))
    c.put("sunshade", 22.4, 14.8, 0.0)
    c.put("sunshade", 22.4, 4.2, 0.0)
    c.put("potted plant", 20.0, 9.0, 0.0, 0)
    c.put("potted plant", 19.9, 2.0, 0.0, 0)
    c.put("advertising board", 20.3, 10.9, 90.0)
    c.put("advertising board", 20.4, -5.8, 90.0)
    for x, y, turn in ((23.1, -7.6, 0.0), (23.0, -9.0, 30.0), (23.0, -10.3, 70.0), (22.2, -8.4, 10.0)):
        c.put("flower", x, y, turn)
    c.put("barrel or bucket", 22.0, -10.0, 0.0, 2)
    c.put("shrub", 22.8, -11.8, 0.0, 0)
    c.put("bench", 20.0, -10.0, 180.0, 2)
    c.put("bicycle", 22.9, -15.2, 90.0)
    # west
    for x, y in ((-22.6, 2.6), (-22.6, 5.4), (-22.6, 8.2), (-22.6, 11.0)):
        table(c, x, y, (90.0, 270.0))
    for x, y in ((-20.6, 9.2), (-20.5, 12.2)):
        table(c, x, y, (100.0, 280.0))
    c.put("sunshade", -22.4, 6.8, 0.0)
    c.put("blackboard", -20.4, 1.6, 90.0, 2)
    c.put("potted plant", -20.0, 4.2, 0.0, 0)
    c.put("counter", -22.8, 14.6, 0.0, 0)
    c.put("luggage", -22.9, -5.2, 10.0, 0)
    c.put("suitcase", -22.4, -6.0, 60.0, 0)
    c.put("handcart", -22.7, -8.0, 90.0, 0)
    c.put("potted plant", -23.3, -9.6, 0.0, 1)
    c.put("potted plant", -23.3, -3.8, 0.0, 1)
    c.put("bench", -20.0, -8.6, 0.0, 2)
    c.put("telephone booth", -22.8, -13.0, 0.0)
    # south: two bars, a scaffold
    for x in (-10.4, -6.4, -3.2):
        barrel(c, x, -16.6, (0.0, 180.0))
    for x in (0.4, 3.2):
        table(c, x, -16.6, (0.0, 180.0))
    c.put("sunshade", 1.8, -16.4, 0.0)
    c.put("advertising board", -1.4, -15.4, 0.0)
    for x in (8.0, 11.0, 14.0):
        c.put("pole", x, -17.4, 0.0, 0)
        c.put("pole", x, -15.6, 0.0, 0)
    c.put("ladder", 9.6, -17.0, 90.0, 1)
    c.put("barrel or bucket", 12.4, -17.0, 0.0, 1)
    c.put("construction worker", 11.8, -16.0, 60.0)
    c.put("traffic barricade", 6.9, -16.4, 180.0)
    c.put("traffic barricade", 15.2, -16.4, 0.0)
    c.put("traffic cone", 9.4, -15.0, 0.0, 0)
    c.put("traffic cone", 12.6, -15.0, 0.0, 0)
    c.put("storage box", 17.0, -17.2, 90.0, 2)
    c.put("debris", 18.6, -16.9, 20.0, 2)
    c.put("motorcycle", -15.0, -16.8, 20.0)
    c.put("motorcycle", -17.6, -16.7, 10.0)
    c.put("trash bin", -12.6, -17.3, 90.0, 0)
    c.put("vending machine", -20.4, -17.2, 90.0)
    people(
        c,
        [
            ("pedestrian adult", 21.0, 12.2, -90.0),
            ("pedestrian adult", 21.4, -1.0, 80.0),
            ("pedestrian adult", 21.0, -6.9, 10.0),
            ("jogger", 20.8, -13.8, 100.0),
            ("pedestrian adult", -21.2, -1.0, 0.0),
            ("pedestrian child", -21.4, -1.9, 10.0),
            ("pedestrian adult", -21.0, -11.4, 90.0),
            ("pedestrian adult", -4.9, -15.3, 20.0),
            ("pedestrian adult", 4.9, -15.2, 170.0),
            ("cat", -8.2, -17.2, 40.0),
            ("pedestrian adult", -14.0, -14.6, 0.0),
            ("delivery worker", -20.6, -15.0, 60.0),
        ],
    )


def _yards(c: Canvas) -> None:
    """The yard in the west, the passage in the north: bins, boxes, bicycles."""
    c.put("dumpster", -42.8, 3.8, 0.0, 1)
    c.put("dumpster", -42.8, 1.0, 0.0, 0)
    c.put("waste station", -36.6, 4.0, -90.0, 2)
    c.put("garbage bag", -41.4, 2.2, 30.0)
    c.put("garbage bag", -41.2, 3.2, 100.0)
    c.put("washing machine", -43.4, -1.4, 0.0, 0)
    c.put("mattress", -43.2, -3.6, 90.0, 1)
    c.put("armchair", -41.6, -4.2, 60.0)
    bicycles(c, -37.6, -5.6, 90.0, (False, True, False), rack=False)
    c.put("street cabinet", -34.4, -5.6, 180.0, 0)
    c.put("tricycle", -39.0, 0.2, 20.0, 0)
    c.put("lamppost", -32.6, 4.4, 0.0, 0)
    c.put("potted plant", -33.7, 4.4, -90.0, 1)
    c.put("bollard", -24.6, -2.2, 0.0)
    c.put("bollard", -24.6, 0.4, 0.0)
    c.put("bicycle", -29.0, 0.55, 180.0)
    c.put("storage box", -31.4, -2.5, 0.0, 2)
    c.put("parcels", -27.0, -2.5, 10.0)
    c.put("elderly person", -35.0, -1.0, 0.0)
    c.put("cat", -40.0, -2.2, 70.0)
    # north
    c.put("van", 15.3, 31.0, -90.0)
    c.put("parcels", 15.4, 27.2, 20.0)
    c.put("parcels", 14.8, 26.4, 70.0)
    c.put("handcart", 17.2, 24.6, 90.0, 0)
    c.put("delivery worker", 16.6, 27.6, -80.0)
    c.put("trash bin", 14.6, 20.0, 0.0, 0)
    c.put("trash bin", 14.6, 21.0, 0.0, 0)
    c.put("garbage bag", 14.7, 22.2, 40.0)
    c.put("storage box", 17.5, 21.2, 0.0, 2)
    c.put("bicycle", 17.4, 34.0, 90.0)
    c.put("advertising board", 17.0, 18.8, -90.0)


def build() -> Canvas:
    c = blank(ID)
    _ground(c)
    _fronts(c)
    _fountain(c)
    _beds(c)
    _concert(c)
    _market(c)
    _town_hall(c)
    _terraces(c)
    _yards(c)
    c.trajectory = [
        (-38.0, -1.0),
        (-26.0, -1.0),
        (-20.6, 3.2),
        (-17.0, 5.0),
        (-9.6, 0.5),
        (-8.0, -7.0),
        (-8.0, -14.2),
        (-18.0, -14.6),
    ]
    c.trajectory += [
        (-8.0, -14.2),
        (14.0, -14.0),
        (21.0, -12.4),
        (21.2, -3.0),
        (17.0, -3.0),
        (9.6, 0.0),
        (9.0, 12.0),
        (10.0, 14.6),
    ]
    c.trajectory += [
        (16.0, 19.4),
        (16.4, 25.4),
        (16.0, 15.0),
        (21.4, 12.0),
        (21.6, 1.0),
        (9.0, 14.6),
        (-8.0, 14.0),
        (-18.0, 14.2),
    ]
    return c
