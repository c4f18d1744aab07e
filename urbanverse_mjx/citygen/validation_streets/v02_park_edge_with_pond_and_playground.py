"""The edge of a park: a round pond with a path around it, a playground on gravel, a kiosk with tables.

A street runs north in the west; behind its pavement, two gaps in a hedge lead into the park. Paths lead to the ring
around the pond (water 40 cm below its bank), on to the playground in the south-east and to the kiosk in the north-east.
"""

from ..canvas import ground_layers as lay
from ..canvas.canvas import Canvas, edge
from ..canvas.ground_layers import polar
from ..canvas.pieces import blank, chain, people, table
from ..catalogue import TREES

ID = "v02_park_edge_with_pond_and_playground"
PAVEMENT_HEIGHT, WATER_HEIGHT = 0.12, -0.3
POND = (25.0, 1.0)
NEAR, FAR = edge((-3.2, -26.0), (-3.2, 26.0), -1), edge((-9.6, -26.0), (-9.6, 26.0), 1)


def _ground(c: Canvas) -> None:
    box = lay.rectangle
    c.ground("far_pavement", "sidewalk", box(-15.0, -28.4, -9.6, 28.4), PAVEMENT_HEIGHT)
    c.ground("pavement", "sidewalk", box(-3.2, -28.4, 0.0, 28.4), PAVEMENT_HEIGHT)
    c.ground("street", "road", box(-9.6, -28.4, -3.2, 28.4))
    c.ground("lawn", "ground", box(0.0, -26.0, 56.0, 26.0), PAVEMENT_HEIGHT)
    c.ground("lots_east", "sidewalk", box(56.0, -28.4, 58.4, 28.4), PAVEMENT_HEIGHT)
    c.ground("lots_south", "sidewalk", box(0.0, -28.4, 56.0, -26.0), PAVEMENT_HEIGHT)
    c.ground("lots_north", "sidewalk", box(0.0, 26.0, 56.0, 28.4), PAVEMENT_HEIGHT)
    c.ground("path_west", "sidewalk", box(0.0, -0.6, 14.0, 2.6), PAVEMENT_HEIGHT)
    c.ground("path_south_west", "sidewalk", lay.strip([(0.0, -20.0), (8.0, -20.0), (19.5, -9.5)], 2.6), PAVEMENT_HEIGHT)
    c.ground("path_south_east", "sidewalk", lay.strip([(33.0, -7.6), (40.0, -14.0)], 2.8), PAVEMENT_HEIGHT)
    c.ground("path_north_east", "sidewalk", lay.strip([(33.0, 9.6), (42.0, 17.0)], 2.8), PAVEMENT_HEIGHT)
    c.ground(
        "path_east",
        "sidewalk",
        lay.strip([(45.0, -12.0), (49.0, -4.0), (49.0, 8.0), (46.0, 15.0)], 2.6),
        PAVEMENT_HEIGHT,
    )
    c.ground("kiosk_court", "sidewalk", box(39.0, 14.0, 53.0, 24.0), PAVEMENT_HEIGHT)
    c.ground(
        "playground",
        "sidewalk",
        [(36.0, -13.0), (46.0, -10.5), (53.5, -14.0), (53.5, -24.0), (36.0, -24.0)],
        PAVEMENT_HEIGHT,
    )
    c.ground("ring", "sidewalk", lay.disc(*POND, 12.6, 12), PAVEMENT_HEIGHT)
    c.ground("bank", "ground", lay.disc(*POND, 9.6, 12), PAVEMENT_HEIGHT)
    c.ground("pond", "road", lay.disc(*POND, 8.8, 12), WATER_HEIGHT)
    c.ground("crossing", "crosswalk", box(-9.6, -1.0, -3.2, 3.0))
    c.ramp("ramp_near", (-3.2, 1.0), 0.0, parted=False)
    c.ramp("ramp_far", (-9.6, 1.0), 180.0)
    for x in (-3.0, 12.0, 38.0):
        c.cut((x, -26.0), (x, 26.0), "lawn")
    for y in (-12.0, 14.0):
        c.cut((0.0, y), (56.0, y), "lawn")
    c.dashes("middle_south", (-6.4, -27.0), (-6.4, -2.0))
    c.dashes("middle_north", (-6.4, 4.5), (-6.4, 27.0))
    c.wear("ground", "grass")
    c.wear((-1.0, 10.0), "sidewalk/concrete_pale")
    for spot in ((5.0, 1.0), (5.0, -20.0), (36.5, -10.8), (37.5, 13.3), (49.0, 2.0), (25.0, 12.0), (25.0, -10.0)):
        c.wear(spot, "sidewalk/hoggin")
    c.wear((46.0, 20.0), "sidewalk/boardwalk")
    c.wear((45.0, -18.0), "sidewalk/concrete_warm-sanded")
    c.wear((-6.4, 20.0), "road/asphalt_old")
    c.wear((25.0, 1.0), "road/asphalt_new-wet")
    c.wear("crosswalk", "zebra_worn")
    c.wear("road_marking", "paint_white")
    c.sky("spring_noon-few_cumulus")


def _fronts(c: Canvas) -> None:
    row = ("apartment building", "cafe", "house", "bakery", "apartment building", "hotel")
    c.houses(edge((-12.6, -26.0), (-12.6, 26.0), 1), row, 0.0, 52.0, 0.0)
    east = ("house", "apartment building", "house", "apartment building", "school")
    c.houses(edge((56.0, -26.0), (56.0, 26.0), -1), east, 0.0, 52.0, 0.2)
    south = ("house", "house", "apartment building", "house", "apartment building")
    c.houses(edge((0.0, -26.0), (56.0, -26.0), -1), south, 0.0, 56.0, 0.2)
    c.houses(edge((0.0, 26.0), (56.0, 26.0), 1), ("apartment building", "school", "house", "hotel"), 0.0, 56.0, 0.2)
    c.houses(edge((-12.6, 26.0), (0.0, 26.0), 1), ("bank",), 0.0, 12.5, 2.3)
    c.houses(edge((-12.6, -26.0), (0.0, -26.0), -1), ("office building",), 0.0, 12.5, 2.3)


def _street(c: Canvas) -> None:
    c.trees(NEAR, (5.0, 15.0, 38.0, 48.0), 0.9)
    c.along(
        NEAR,
        [
            ("bollard", 25.2, 0.4, "street"),
            ("bollard", 28.8, 0.4, "street"),
            ("street light", 10.0, 0.5, "street"),
            ("street light", 34.0, 0.5, "street"),
            ("bus shelter", 43.0, 2.1, "street"),
            ("trash bin", 40.4, 0.8, "wall", 1),
            ("pedestrian adult", 39.2, 1.6, "street"),
            ("elderly person", 46.0, 1.0, "street"),
            ("scooter", 18.4, 2.1, 70.0, 1),
            ("scooter", 20.6, 1.2, 20.0, 0),
            ("bicycle", 12.4, 2.6, "+"),
            ("pedestrian adult", 22.0, 2.2, "+"),
            ("street food stall", 32.2, 2.0, "street", 1),
            ("bus", 44.0, -1.6, "+"),
            ("sedan", 8.0, -1.3, "+"),
            ("hatchback car", 14.6, -1.3, "+"),
            ("suv", 20.4, -1.3, "+"),
        ],
    )
    c.along(
        FAR,
        [
            ("street light", 22.0, 0.5, "street"),
            ("potted plant", 11.0, 2.5, "street", 0),
            ("bench", 17.0, 2.4, "street", 0),
            ("advertising board", 21.0, 1.9, "+"),
            ("pedestrian adult", 31.0, 1.6, "-"),
            ("van", 36.0, -1.4, "-"),
            ("taxi", 6.0, -1.3, "-"),
        ],
    )
    hedge = (0.8, 2.4, 1.2)
    for y in (-24.6, -22.6, -16.6, -14.1, -11.6, -9.1, -6.6, -4.1, 5.0, 7.5, 10.0, 12.5, 15.0, 17.5, 20.0, 22.5, 24.7):
        c.put("shrub", 0.8, y, 0.0, size=hedge if abs(y) < 24 else (0.8, 1.4, 1.2))


def _pond(c: Canvas) -> None:
    for bearing in (15.0, 50.0, 95.0, 130.0, 200.0, 235.0, 285.0, 320.0):
        c.put("shrub", *polar(POND, bearing, 9.2), bearing, 1)
    for bearing, reach in ((65.0, 9.3), (165.0, 9.4), (260.0, 9.3), (345.0, 9.4)):
        c.put("rock", *polar(POND, bearing, reach), bearing, 1)
    for bearing, reach, turn in ((20.0, 4.0, 0.0), (35.0, 5.0, 60.0), (160.0, 6.0, 200.0), (300.0, 3.0, 140.0)):
        c.put("duck", *polar(POND, bearing, reach), turn)
    c.put("swan", 23.0, 4.0, 30.0, 0)
    c.put("swan", 28.0, -3.0, 210.0, 1)
    # benches face the water from the outer side of the ring
    for bearing in (40.0, 115.0, 150.0, 215.0, 335.0):
        c.put("bench", *polar(POND, bearing, 12.0), bearing + 180.0, 0)
    for bearing in (28.0, 127.0, 228.0, 345.0):
        c.put("trash bin", *polar(POND, bearing, 11.9), bearing + 180.0, 2)
    for bearing in (75.0, 165.0, 262.0, 0.0):
        c.put("lamppost", *polar(POND, bearing, 11.8), bearing, 0)
    for bearing, reach, turn, label in (
        (20.0, 11.0, 110.0, "jogger"),
        (60.0, 10.6, 200.0, "pedestrian adult"),
        (66.0, 10.4, 240.0, "pedestrian child"),
        (100.0, 10.7, 190.0, "elderly person"),
        (140.0, 10.8, 50.0, "pedestrian adult"),
        (190.0, 10.5, 0.0, "pedestrian child"),
        (194.0, 11.4, 20.0, "pedestrian adult"),
        (250.0, 10.6, 340.0, "stroller"),
        (256.0, 10.7, 340.0, "pedestrian adult"),
        (290.0, 11.2, 20.0, "dog"),
        (297.0, 10.9, 10.0, "pedestrian adult"),
        (325.0, 10.9, 60.0, "wheelchair user"),
    ):
        c.put(label, *polar(POND, bearing, reach), turn)
    c.put("pedestrian adult", 8.0, 0.2, 0.0)
    c.along(
        edge((0.0, 1.0), (14.0, 1.0), 1),
        [
            ("bench", 5.0, 2.4, "street", 1),
            ("trash bin", 7.0, 2.2, "street", 0),
            ("bulletin board", 2.4, 2.4, "street", 1),
        ],
    )
    c.put("dog", 10.4, 1.9, 200.0, 1)
    c.put("bicycle", 3.4, -1.4, 10.0)


def _lawns(c: Canvas) -> None:
    for x, y, growth in (
        (5.0, 9.0, "broad"),
        (10.0, 17.5, "street"),
        (21.0, 20.0, "broad"),
        (31.0, 21.0, "blossom"),
        (5.0, -9.0, "blossom"),
        (20.0, -19.0, "broad"),
        (30.0, -20.5, "street"),
        (43.5, 2.0, "broad"),
        (53.0, -3.0, "street"),
        (53.0, 9.5, "slim"),
        (11.0, -14.0, "slim"),
    ):
        c.put("tree", x, y, c.uniform(-180.0, 180.0), size=TREES[growth])
    c.put("picnic basket", 14.0, 17.0, 20.0)
    c.put("football", 27.0, 18.6, 0.0)
    c.put("sculpture", 15.5, -20.5, 40.0, 1)
    c.put("flower", 14.0, -19.6, 0.0, 0)
    c.put("flower", 16.8, -19.4, 0.0, 1)
    c.put("lawn mower", 24.0, -16.0, 160.0, 0)
    people(
        c,
        [
            ("pedestrian adult", 13.2, 16.2, 60.0),
            ("pedestrian adult", 15.0, 16.0, 120.0),
            ("pedestrian child", 25.6, 19.4, 0.0),
            ("pedestrian child", 28.6, 18.0, 170.0),
            ("gardener", 22.6, -16.2, 0.0),
            ("pedestrian adult", 6.0, -19.6, 0.0),
            ("cyclist", 13.6, -15.6, 50.0),
            ("pedestrian adult", 48.6, 4.0, 80.0),
            ("dog", 49.4, 5.2, 100.0),
            ("jogger", 49.2, -2.4, 90.0),
        ],
    )


def _playground(c: Canvas) -> None:
    c.put("playground", 44.6, -17.6, 90.0, 0)
    c.put("playground", 50.6, -20.4, 180.0, 1)
    c.put("trampoline", 39.4, -15.6, 0.0, 2)
    c.put("horizontal bar", 38.4, -20.6, 10.0, 1)
    c.put("table-tennis table", 50.4, -15.4, 70.0, 1)
    chain(c, "fence", [(36.0, -24.0), (53.4, -24.0)], stretch=2.4)
    chain(c, "fence", [(53.4, -24.0), (53.4, -14.4)], stretch=2.4)
    chain(c, "fence", [(36.0, -14.6), (36.0, -24.0)], stretch=2.4)
    c.put("bench", 41.0, -23.2, 90.0, 0)
    c.put("bench", 46.0, -23.2, 90.0, 1)
    c.put("water point", 48.0, -12.6, -90.0, 0)
    c.put("tricycle", 41.2, -20.8, 140.0)
    c.put("stroller", 43.4, -22.6, 10.0)
    c.put("stroller", 44.0, -12.8, 100.0)
    people(
        c,
        [
            ("pedestrian child", 40.8, -18.2, 30.0),
            ("pedestrian child", 42.0, -14.6, -60.0),
            ("pedestrian child", 48.6, -17.0, 130.0),
            ("pedestrian child", 46.9, -21.0, 60.0),
            ("pedestrian adult", 40.0, -13.0, 250.0),
            ("pedestrian adult", 46.6, -14.2, 200.0),
            ("pedestrian adult", 38.2, -17.6, 0.0),
            ("pedestrian adult", 51.8, -17.6, 110.0),
        ],
    )


def _kiosk(c: Canvas) -> None:
    c.put("kiosk", 49.6, 21.6, -90.0)
    for x, y, turn in ((41.0, 22.0, 0.0), (44.4, 21.4, 40.0), (41.6, 18.6, 80.0), (51.4, 16.6, 20.0)):
        table(c, x, y, (turn, turn + 180.0), 0)
    c.put("sunshade", 42.8, 20.2, 0.0)
    c.put("sunshade", 51.6, 18.4, 0.0)
    c.put("advertising board", 45.4, 17.4, 200.0)
    c.put("handcart", 40.4, 15.4, 60.0, 1)
    c.put("trash bin", 47.2, 22.6, -90.0, 1)
    c.put("plant pot", 39.6, 16.8, 0.0, 0)
    c.put("plant pot", 52.4, 14.8, 0.0, 0)
    c.put("bicycle parking", 39.6, 24.8, 0.0, 0)
    people(
        c,
        [
            ("pedestrian adult", 49.4, 18.6, 90.0),
            ("pedestrian adult", 48.8, 17.4, 80.0),
            ("pedestrian child", 48.0, 17.6, 70.0),
            ("elderly person", 43.6, 15.8, 60.0),
        ],
    )


def build() -> Canvas:
    c = blank(ID)
    _ground(c)
    _fronts(c)
    _street(c)
    _pond(c)
    _lawns(c)
    _playground(c)
    _kiosk(c)
    c.trajectory = [(-11.2, 1.0), (-1.6, 1.0), (12.0, 0.6), polar(POND, 140.0, 11.6), polar(POND, 60.0, 11.6)]
    c.trajectory += [(38.0, 13.6), (46.6, 18.6), (48.6, 8.0), (48.6, -4.0), (44.4, -12.0), (40.6, -16.9), (36.0, -10.4)]
    c.trajectory += [polar(POND, 270.0, 11.2), (19.0, -10.0), (8.0, -20.0), (-1.6, -20.0), (-1.6, 1.0)]
    return c
