"""A hospital forecourt: a drive leads from the street past the entrance and back, with two bus stops on it.

The street runs east in the south. Its northern pavement (4 m) crosses both mouths of the drive on zebras; inside the
drive is a garden with paths, and a raised crossing leads from it to the entrance. Objects include wheelchairs,
visitors, waiting taxis, ambulances, a bicycle stand and a paving repair.
"""

from ..canvas import ground_layers as lay
from ..canvas.canvas import Canvas, edge
from ..canvas.pieces import bicycles, blank, chain, people, table
from ..catalogue import TREES

ID = "v04_hospital_forecourt_with_bus_stops"
PAVEMENT_HEIGHT = 0.14
DRIVE = [(14.0, -2.0), (14.0, 8.5), (21.5, 16.0), (44.5, 16.0), (52.0, 8.5), (52.0, -2.0)]
KERB, FAR = edge((0.0, -2.0), (66.0, -2.0), 1), edge((0.0, -9.0), (66.0, -9.0), -1)
FRONT = edge((4.0, 26.0), (62.0, 26.0), 1)


def _ground(c: Canvas) -> None:
    box = lay.rectangle
    c.ground("lots", "sidewalk", box(-2.4, -14.4, 68.4, 28.4), PAVEMENT_HEIGHT)
    c.ground("court", "sidewalk", box(0.0, -2.0, 66.0, 26.0), PAVEMENT_HEIGHT)
    c.ground("far_pavement", "sidewalk", box(-2.4, -12.0, 68.4, -9.0), PAVEMENT_HEIGHT)
    c.ground("street", "road", box(-2.4, -9.0, 68.4, -2.0))
    c.ground("drive", "road", lay.strip(DRIVE, 5.0))
    c.ground("lawn_west", "ground", box(1.0, 6.0, 9.0, 20.0), PAVEMENT_HEIGHT)
    c.ground("lawn_east", "ground", box(57.0, 6.0, 65.0, 20.0), PAVEMENT_HEIGHT)
    c.ground("bed", "ground", [(19.0, 3.6), (30.0, 3.6), (30.0, 11.0), (23.6, 11.0), (19.0, 6.4)], PAVEMENT_HEIGHT)
    c.ground("bed_east", "ground", [(36.0, 3.6), (47.0, 3.6), (47.0, 6.4), (42.4, 11.0), (36.0, 11.0)], PAVEMENT_HEIGHT)
    c.ground("zebra_in", "crosswalk", box(11.5, -1.8, 16.5, 2.2))
    c.ground("zebra_out", "crosswalk", box(49.5, -1.8, 54.5, 2.2))
    c.ground("zebra_street", "crosswalk", box(31.0, -9.0, 35.0, -2.0))
    c.ground("hump", "crosswalk", box(31.0, 13.5, 35.0, 18.5), PAVEMENT_HEIGHT)
    c.slope(
        "hump_up",
        "road",
        box(29.4, 13.5, 31.0, 18.5),
        [(29.4, 13.5, 0), (29.4, 18.5, 0), (31.0, 13.5, PAVEMENT_HEIGHT)],
    )
    c.slope(
        "hump_down",
        "road",
        box(35.0, 13.5, 36.6, 18.5),
        [(36.6, 13.5, 0), (36.6, 18.5, 0), (35.0, 13.5, PAVEMENT_HEIGHT)],
    )
    c.ramp("ramp_in_west", (11.5, 0.2), 180.0, parted=False)
    c.ramp("ramp_in_east", (16.5, 0.2), 0.0, parted=False)
    c.ramp("ramp_out_west", (49.5, 0.2), 180.0, parted=False)
    c.ramp("ramp_out_east", (54.5, 0.2), 0.0, parted=False)
    c.ramp("ramp_near", (33.0, -2.0), 90.0, parted=False)
    c.ramp("ramp_far", (33.0, -9.0), -90.0)
    c.cut((0.0, 3.0), (66.0, 3.0), "court")
    for x in (8.0, 20.0, 33.0, 46.0, 58.0):
        c.cut((x, 3.0), (x, 26.0), "court")
    c.cut((0.0, 21.0), (66.0, 21.0), "court")
    c.dashes("middle_west", (0.0, -5.5), (29.0, -5.5))
    c.dashes("middle_east", (37.0, -5.5), (66.0, -5.5))
    c.paint("stop_west", box(20.0, -2.25, 29.0, -2.1))
    c.paint("stop_east", box(37.0, -2.25, 48.0, -2.1))
    c.wear("road", "road/asphalt_used")
    c.wear((33.0, 22.0), "sidewalk/granite_light")
    c.wear("ground", "grass")
    c.wear("crosswalk", "zebra_new")
    c.wear("road_marking", "paint_white")
    c.sky("spring_noon-scattered_cumulus")


def _fronts(c: Canvas) -> None:
    c.houses(FRONT, ("hospital",), 0.0, 58.0, 0.0)
    c.houses(edge((0.0, 2.0), (0.0, 26.0), 1), ("clinic",), 0.0, 24.0, 0.0)
    c.houses(edge((66.0, 2.0), (66.0, 26.0), -1), ("pharmacy", "flower shop", "office building"), 0.0, 24.0, 0.0)
    south = ("cafe", "apartment building", "bakery", "optical store", "hotel", "convenience store", "house")
    c.houses(edge((0.0, -12.0), (66.0, -12.0), -1), south, 0.0, 66.0, 0.0)
    c.houses(edge((-2.4, -12.0), (-2.4, 1.0), 1), ("bank",), 0.0, 13.0, -0.1)
    c.houses(edge((68.4, -12.0), (68.4, 1.0), -1), ("apartment building",), 0.0, 13.0, 0.0)


def _street(c: Canvas) -> None:
    c.along(
        KERB,
        [
            ("street light", 6.0, 0.5, "street"),
            ("street light", 28.9, 0.5, "street"),
            ("street light", 60.0, 0.5, "street"),
            ("bus shelter", 24.4, 3.6, "street"),
            ("trash bin", 27.4, 3.8, "street", 1),
            ("pedestrian adult", 23.6, 1.6, "street"),
            ("pedestrian adult", 25.0, 1.4, 200.0),
            ("elderly person", 22.0, 2.0, "street"),
            ("suitcase", 21.2, 1.6, 30.0, 0),
            ("bus shelter", 43.0, 3.6, "street"),
            ("pedestrian adult", 40.0, 1.4, "-"),
            ("wheelchair user", 42.4, 1.6, "street"),
            ("pedestrian adult", 45.6, 2.4, "street"),
            ("vending machine", 46.2, 4.0, "street"),
            ("newspaper stand", 39.4, 3.9, "street"),
            ("bus", 42.8, -1.6, "+"),
            ("taxi", 4.6, -1.3, "+"),
            ("sedan", 60.4, -1.3, "+"),
            ("bollard", 30.8, 0.4, "street"),
            ("bollard", 35.2, 0.4, "street"),
            ("bicycle", 3.4, 2.4, 20.0),
            ("scooter", 8.4, 3.2, 70.0, 1),
            ("pedestrian adult", 7.2, 1.4, "+"),
            ("parking meter", 2.0, 0.4, "street"),
            ("street cabinet", 57.6, 3.4, "street", 0),
            ("jogger", 61.6, 2.0, "-"),
            ("fire hydrant", 56.8, 0.5, "street"),
            ("postbox", 63.8, 0.6, "wall"),
            ("delivery robot", 19.0, 2.2, "+"),
        ],
    )
    c.trees(KERB, (10.2, 37.2, 47.4, 57.0), 1.0, "slim")
    c.along(
        FAR,
        [
            ("street light", 16.0, 0.5, "street"),
            ("street light", 48.0, 0.5, "street"),
            ("advertising board", 5.0, 1.8, "+"),
            ("potted plant", 9.4, 2.5, "street", 0),
            ("trash bin", 30.0, 0.7, "wall", 0),
            ("bench", 21.6, 2.5, "street", 0),
            ("pedestrian adult", 26.0, 1.6, "+"),
            ("bicycle", 38.6, 2.5, "+"),
            ("flower", 41.4, 2.4, 0.0, 0),
            ("storage box", 44.6, 2.5, "street", 2),
            ("advertising board", 52.8, 2.0, "-"),
            ("elderly person", 56.0, 1.4, "-"),
            ("garbage bag", 59.6, 2.5, 20.0, 0),
            ("garbage bag", 60.5, 2.4, 70.0, 1),
            ("van", 22.0, -1.4, "-"),
            ("hatchback car", 55.0, -1.3, "-"),
        ],
    )
    table(c, 2.2, -11.2, (0.0, 180.0), 1)


def _garden(c: Canvas) -> None:
    """Inside the drive: two beds with a path between them."""
    for x, y, growth in ((22.0, 7.0, "street"), (27.4, 8.4, "blossom"), (39.0, 8.6, "blossom"), (44.2, 6.4, "street")):
        c.put("tree", x, y, c.uniform(-180.0, 180.0), size=TREES[growth])
    for x, y, variant in (
        (21.0, 4.4, 0),
        (25.0, 4.6, 1),
        (28.8, 10.0, 0),
        (37.0, 4.6, 1),
        (41.0, 4.4, 0),
        (37.0, 10.2, 1),
    ):
        c.put("flower", x, y, 0.0, variant)
    c.put("sculpture", 33.0, 8.4, -90.0, 1)
    for x, y, turn in ((30.6, 5.2, 0.0), (35.4, 5.2, 180.0), (30.6, 10.0, 0.0), (35.4, 10.0, 180.0)):
        c.put("bench", x, y, turn, 0)
    c.put("trash bin", 30.6, 7.4, 0.0, 2)
    c.put("lamppost", 35.4, 7.6, 180.0, 0)
    c.put("lamppost", 18.2, 3.2, 0.0, 0)
    c.put("lamppost", 48.0, 3.2, 0.0, 0)
    c.put("directional sign", 29.6, 12.4, -90.0)
    people(
        c,
        [
            ("elderly person", 32.0, 6.2, 60.0),
            ("pedestrian adult", 34.2, 11.6, 100.0),
            ("doctor", 32.0, 12.2, -80.0),
            ("wheelchair user", 33.4, 3.6, 90.0),
            ("pedestrian child", 24.0, 12.2, 30.0),
            ("pedestrian adult", 25.2, 12.3, 200.0),
            ("bird", 40.0, 12.0, 40.0),
            ("bird", 41.0, 12.2, 130.0),
            ("stroller", 42.4, 12.3, 180.0),
        ],
    )


def _entrance(c: Canvas) -> None:
    c.row("bollard", edge((20.0, 18.5), (46.0, 18.5), 1), (2.0, 4.0, 6.0, 8.0, 10.4, 15.6, 18.0, 20.0, 22.0), 0.45)
    c.put("canopy", 29.2, 23.0, -90.0, 2)
    c.put("canopy", 36.8, 23.0, -90.0, 2)
    c.along(
        edge((4.0, 26.0), (62.0, 26.0), -1),
        [
            ("potted plant", 26.6, 0.6, "street", 0),
            ("potted plant", 31.4, 0.6, "street", 0),
            ("wheelchair", 21.8, 0.8, "street"),
            ("wheelchair", 20.6, 0.8, "street"),
            ("wheelchair", 19.4, 0.8, "street"),
            ("ashtray", 36.6, 1.2, "street", 2),
            ("bench", 17.0, 0.8, "street", 1),
            ("bench", 13.8, 0.8, "street", 1),
            ("trash bin", 15.4, 0.6, "street", 1),
            ("vending machine", 39.0, 0.7, "street"),
            ("self-service payment kiosk or terminal", 40.6, 0.6, "street", 0),
            ("parcel locker", 44.0, 0.6, "street", 0),
            ("bulletin board", 10.6, 0.4, "street", 1),
            ("bench", 48.0, 0.8, "street", 0),
            ("garbage bag", 51.0, 0.7, 30.0, 0),
            ("dumpster", 53.4, 1.0, "street", 0),
            ("dumpster", 55.4, 1.0, "street", 1),
        ],
    )
    people(
        c,
        [
            ("doctor", 30.6, 19.8, 70.0),
            ("pedestrian adult", 35.0, 20.2, 250.0),
            ("elderly person", 26.4, 20.4, 10.0),
            ("emergency worker", 42.8, 20.0, 200.0),
            ("pedestrian adult", 46.0, 21.6, 170.0),
            ("pedestrian adult", 21.4, 22.4, 60.0),
            ("security guard", 40.4, 21.0, -90.0),
        ],
    )
    # on the drive: waiting people, arriving patients
    c.put("ambulance", 41.4, 16.9, 180.0)
    c.put("taxi", 25.0, 16.9, 180.0)
    c.put("sedan", 14.9, 8.0, 90.0)
    c.put("hatchback car", 51.1, 8.0, -90.0)


def _sides(c: Canvas) -> None:
    # the west side: bicycles, and slabs that are being relaid
    bicycles(c, 5.0, 23.6, 90.0, (False, True, False), rack=False)
    c.put("traffic barricade", 10.2, 14.4, 90.0)
    c.put("traffic barricade", 10.2, 18.4, 90.0)
    c.put("traffic cone", 11.2, 14.4, 0.0, 0)
    c.put("traffic cone", 11.4, 18.2, 0.0, 1)
    c.put("storage box", 10.0, 16.2, 20.0, 2)
    c.put("construction worker", 10.6, 17.2, 200.0)
    c.put("barrow", 10.0, 12.0, 100.0, 0)
    c.put("debris", 6.4, 12.4, 20.0, 0)
    c.put("tree", 4.6, 9.4, 0.0, size=TREES["broad"])
    c.put("tree", 4.6, 17.6, 60.0, size=TREES["street"])
    c.put("bench", 9.6, 8.0, 180.0, 0)
    chain(c, "fence", [(1.2, 5.6), (8.8, 5.6)], stretch=2.0)
    # the east side: a kiosk's tables, smokers under a shelter
    c.put("kiosk", 62.6, 22.6, 180.0)
    for x, y in ((58.8, 23.6), (59.2, 21.2)):
        table(c, x, y, (20.0, 200.0), 1)
    c.put("shelter", 55.8, 23.4, -90.0, 1)
    c.put("ashtray", 54.6, 20.8, 0.0, 2)
    c.put("tree", 61.0, 10.0, 0.0, size=TREES["broad"])
    c.put("tree", 61.0, 16.6, 0.0, size=TREES["street"])
    c.put("bench", 56.2, 9.0, 0.0, 0)
    c.put("trash bin", 56.4, 11.4, 0.0, 0)
    chain(c, "fence", [(57.2, 5.6), (64.8, 5.6)], stretch=2.0)
    people(
        c,
        [
            ("pedestrian adult", 54.6, 19.4, 30.0),
            ("pedestrian adult", 10.2, 5.0, 80.0),
            ("wheelchair user", 56.0, 14.0, -90.0),
            ("dog", 62.4, 13.0, 40.0),
            ("pedestrian adult", 63.0, 4.0, 190.0),
        ],
    )


def build() -> Canvas:
    c = blank(ID)
    _ground(c)
    _fronts(c)
    _street(c)
    _garden(c)
    _entrance(c)
    _sides(c)
    c.trajectory = [
        (2.0, 0.2),
        (14.0, 0.2),
        (20.0, 0.2),
        (33.0, 1.2),
        (33.0, -10.6),
        (33.0, 1.2),
        (32.6, 4.6),
        (34.2, 8.4),
    ]
    c.trajectory += [(33.0, 12.2), (33.0, 20.0), (24.0, 21.4), (12.6, 21.6), (10.6, 4.0), (10.6, 21.6), (33.0, 20.6)]
    c.trajectory += [(50.0, 21.6), (55.6, 16.0), (55.8, 3.4), (47.0, 0.2), (62.0, 0.4)]
    return c
