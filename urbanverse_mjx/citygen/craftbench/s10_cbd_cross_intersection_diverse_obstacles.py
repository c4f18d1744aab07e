"""A crossing of two business streets with a different kind of obstacle on each of its four corners.

The arms are 40 m long, the pavements 4.5 and 5 m wide, and the kerbs 15 cm high, 5 cm on the tower's side. A bus queue,
hotel luggage, boxes of a sale and a burst water main line the long street; market stalls, terraces, a heap of hire
scooters and planters line the other. A square with a bookstall lies on the north-eastern corner; an ambulance stands on
the crossing.
"""

from ..canvas import ground_layers as lay
from ..canvas.canvas import Canvas, edge
from ..canvas.pieces import apron, blank, chain, people, table

ID = "10_cbd_cross_intersection_diverse_obstacles"
PAVEMENT_HEIGHT, LOW_PAVEMENT_HEIGHT = 0.15, 0.05
NW_LONG, NE_LONG = edge((-48, 6), (-12, 6), 1), edge((12, 6), (48, 6), 1)
SW_LONG, SE_LONG = edge((-48, -6), (-12, -6), -1), edge((12, -6), (48, -6), -1)
NW_SHORT, NE_SHORT = edge((-5.5, 13), (-5.5, 44), 1), edge((5.5, 13), (5.5, 44), -1)
SW_SHORT, SE_SHORT = edge((-5.5, -44), (-5.5, -13), 1), edge((5.5, -44), (5.5, -13), -1)


def _ground(c: Canvas) -> None:
    box = lay.rectangle
    west_end, north_end = box(-52.0, -11.0, -48.0, 11.0), box(-10.0, 44.0, 10.0, 48.0)
    north_west = [(-48, 6), (-8, 6), (-5.5, 8.5), (-5.5, 44), (-10, 44), (-10, 11), (-48, 11)]
    north_east = [(48, 6), (8, 6), (5.5, 8.5), (5.5, 44), (10, 44), (10, 18), (17, 18), (17, 11), (48, 11)]
    south_west = [(-48, -6), (-8, -6), (-5.5, -8.5), (-5.5, -44), (-10, -44), (-10, -11), (-48, -11)]
    south_east = [(48, -6), (8, -6), (5.5, -8.5), (5.5, -44), (10, -44), (10, -11), (48, -11)]
    high = {"north_west": north_west, "north_east": north_east, "south_west": south_west}
    high |= {"west_end": west_end, "north_end": north_end}
    apron(c, "south_east_lots", south_east, LOW_PAVEMENT_HEIGHT)
    for name, ring in high.items():
        apron(c, f"{name}_lots", ring, PAVEMENT_HEIGHT)
    for name, ring in high.items():
        c.ground(name, "sidewalk", ring, PAVEMENT_HEIGHT)
    c.ground("south_east", "sidewalk", south_east, LOW_PAVEMENT_HEIGHT)
    c.ground("tower_lot", "road", box(20.4, -42.4, 40.8, -22.0), LOW_PAVEMENT_HEIGHT)
    c.ground("east_lot", "road", box(48.0, -6.0, 50.4, 6.0))
    c.ground("south_lot", "road", box(-5.5, -46.4, 5.5, -44.0))
    c.ground("long", "road", box(-48.0, -6.0, 48.0, 6.0))
    c.ground("short", "road", box(-5.5, -44.0, 5.5, 44.0))
    middle = [(-8, -6), (-5.5, -8.5), (5.5, -8.5), (8, -6), (8, 6), (5.5, 8.5), (-5.5, 8.5), (-8, 6)]
    c.ground("middle", "road", middle)
    c.ground("zebra_west", "crosswalk", box(-12.0, -6.0, -8.0, 6.0))
    c.ground("zebra_east", "crosswalk", box(8.0, -6.0, 12.0, 6.0))
    c.ground("zebra_north", "crosswalk", box(-5.5, 8.5, 5.5, 12.5))
    c.ground("zebra_south", "crosswalk", box(-5.5, -12.5, 5.5, -8.5))
    c.ramp("ramp_west_n", (-10.0, 6.0), 90.0, parted=False)
    c.ramp("ramp_west_s", (-10.0, -6.0), -90.0)
    c.ramp("ramp_east_n", (10.0, 6.0), 90.0, parted=False)
    c.ramp("ramp_east_s", (10.0, -6.0), -90.0)
    c.ramp("ramp_north_w", (-5.5, 10.5), 180.0, parted=False)
    c.ramp("ramp_north_e", (5.5, 10.5), 0.0)
    c.ramp("ramp_south_w", (-5.5, -10.5), 180.0, parted=False)
    c.ramp("ramp_south_e", (5.5, -10.5), 0.0)
    for x0, x1 in ((-46.0, -14.0), (14.0, 46.0)):
        c.paint(f"long_middle_{x0:g}", box(x0, -0.07, x1, 0.07))
        c.dashes(f"long_north_{x0:g}", (x0, 3.0), (x1, 3.0), gap=6.0)
        c.dashes(f"long_south_{x0:g}", (x0, -3.0), (x1, -3.0), gap=6.0)
    for y0, y1 in ((-43.0, -14.5), (14.5, 43.0)):
        c.paint(f"short_middle_{y0:g}", box(-0.07, y0, 0.07, y1))
    c.paint("stop_west", box(-13.0, -5.7, -12.6, -0.3))
    c.paint("stop_east", box(12.6, 0.3, 13.0, 5.7))
    c.paint("stop_north", box(-5.2, 13.1, -0.3, 13.5))
    c.paint("stop_south", box(0.3, -13.5, 5.2, -13.1))
    c.wear("road", "road/asphalt_new")
    c.wear((-40.0, 8.0), "sidewalk/flags_large")
    c.wear((-40.0, -8.0), "sidewalk/flags_large")
    c.wear((40.0, 8.0), "sidewalk/granite_courses")
    c.wear((7.7, 31.0), "sidewalk/granite_courses")
    c.wear((40.0, -8.0), "sidewalk/flags_charcoal")
    c.wear("crosswalk", "zebra_new")
    c.wear("road_marking", "paint_white")
    c.sky("summer_noon-few_cumulus")


def _fronts(c: Canvas) -> None:
    c.houses(edge((-52, 11), (-10, 11), 1), ("hotel", "bank", "office building"), 0, 42, 0)
    c.houses(edge((-10, 20.7), (-10, 48), 1), ("clothing store", "office building"), 0, 27.3, 0)
    c.houses(edge((17, 11), (48, 11), 1), ("bank", "cafe", "hotel"), 0, 31, 0)
    c.houses(edge((10, 18), (10, 48), -1), ("pharmacy", "office building"), 0, 30, 0)
    c.houses(edge((-52, -11), (-10, -11), -1), ("electronics store", "office building", "clothing store"), 0, 42, 0)
    c.houses(edge((-10, -44), (-10, -18.3), 1), ("hotel", "restaurant"), 0, 25.7, 0)
    c.houses(edge((10, -11), (48, -11), -1), ("bank", "office building", "hotel"), 0, 38, 0)
    c.houses(edge((10, -44), (10, -20.6), -1), ("cafe", "office building"), 0, 23.4, 0)
    c.put("skyscraper", 30.6, -32.2, 90.0, size=(20.0, 20.0, 104.0))
    c.houses(edge((-52, -11), (-52, 11), 1), ("hotel", "restaurant"), 0, 22, 0)
    c.houses(edge((48.1, -13.6), (48.1, 13.6), -1), ("town hall",), 0, 27.2, 0)
    c.houses(edge((-10, 48), (10, 48), 1), ("church",), 0, 20, 0)
    c.houses(edge((-12.6, -44.1), (12.6, -44.1), -1), ("cinema",), 0, 25.2, 0)


def _north_west(c: Canvas) -> None:
    """The bus queue, and market day in the street."""
    for s in (1.6, 20.4):
        c.put("street light", *NW_LONG.at(s, 0.5), 90.0, 1)
    c.along(
        NW_LONG,
        [
            ("tree", 6.4, 0.9, 10.0),
            ("tree", 28.6, 0.9, 80.0),
            ("bus shelter", 13.4, 1.9, "street"),
            ("trash bin", 16.4, 1.6, "street", 1),
            ("pedestrian adult", 10.6, 1.2, "+"),
            ("pedestrian adult", 9.6, 1.3, "+"),
            ("pedestrian child", 8.7, 1.1, "+"),
            ("pedestrian adult", 8.0, 1.6, 20.0),
            ("elderly person", 15.9, 0.6, "-"),
            ("suitcase", 11.4, 0.8, 30.0, 1),
            ("newspaper stand", 18.0, 0.65, "wall"),
            ("atm", 21.8, 4.55, "street", 0),
            ("pedestrian adult", 21.8, 3.6, "wall"),
            ("potted plant", 4.2, 4.4, "street", 1),
            ("luggage", 5.6, 4.2, 20.0, 1),
            ("advertising board", 12.8, 4.6, "+"),
            ("street cabinet", 23.6, 0.8, "wall", 1),
            ("bicycle parking", 25.6, 1.1, "wall", 0),
            ("bicycle", 26.9, 1.2, "wall"),
            ("bicycle", 24.8, 1.9, 15.0),
            ("bench", 31.0, 2.4, "street", 3),
            ("telephone booth", 32.8, 0.9, "wall"),
            ("traffic light", 35.4, 0.6, "-", 0),
            ("pedestrian adult", 2.4, 2.6, "+"),
            ("garbage bag", 17.0, 4.3, 30.0),
        ],
    )
    c.along(
        NW_SHORT,
        [
            ("traffic light", 0.4, 0.6, "+", 0),
            ("street food stall", 6.2, 1.25, "wall", 0),
            ("street food stall", 11.6, 1.25, "wall", 1),
            ("street food stall", 17.2, 1.25, "wall", 0),
            ("storage box", 8.8, 1.0, 20.0, 2),
            ("storage box", 13.9, 1.0, 0.0, 2),
            ("barrel or bucket", 15.0, 1.2, 0.0, 2),
            ("handcart", 26.6, 1.0, "+", 1),
            ("handcart", 3.2, 1.0, "+", 0),
            ("advertising board", 15.2, 3.9, "+"),
            ("potted plant", 9.6, 4.05, "street", 0),
            ("pedestrian adult", 6.6, 2.9, "street"),
            ("pedestrian adult", 11.0, 3.0, "street"),
            ("pedestrian child", 18.2, 2.85, "street"),
            ("wheelchair user", 2.4, 2.6, "+"),
            ("pedestrian adult", 27.0, 2.8, "-"),
            ("street light", 29.4, 0.5, "street", 1),
        ],
    )


def _north_east(c: Canvas) -> None:
    """A hotel's luggage, the square, terraces."""
    for s in (2.6, 22.0):
        c.put("street light", *NE_LONG.at(s, 0.5), 90.0, 1)
    c.along(
        NE_LONG,
        [
            ("traffic light", 0.6, 0.6, "+", 0),
            ("tree", 9.0, 0.9, 50.0),
            ("tree", 17.4, 0.9, 120.0),
            ("tree", 34.6, 0.9, 20.0),
            ("atm", 8.4, 4.5, "street", 2),
            ("police officer", 12.0, 3.6, "street"),
            ("advertising board", 16.2, 3.4, "+"),
            ("potted plant", 24.8, 4.4, "street", 1),
            ("handcart", 28.0, 3.6, "+", 0),
            ("luggage", 29.4, 4.2, 10.0, 0),
            ("suitcase", 29.6, 3.4, 30.0, 0),
            ("suitcase", 31.2, 3.6, 100.0, 2),
            ("backpack", 30.6, 3.0, 0.0),
            ("pedestrian adult", 31.2, 2.6, "street"),
            ("pedestrian adult", 27.0, 2.2, 30.0),
            ("security guard", 25.9, 4.3, "street"),
            ("bollard", 26.0, 0.45, "street"),
            ("bollard", 28.0, 0.45, "street"),
            ("bench", 13.4, 0.9, "wall", 2),
            ("trash bin", 11.6, 0.8, "wall", 0),
            ("scooter", 6.4, 1.4, 40.0, 0),
            ("scooter", 5.4, 2.0, 110.0, 1),
            ("delivery robot", 21.0, 2.6, "-"),
            ("pedestrian adult", 10.2, 2.6, "-"),
            ("flag", 23.6, 4.5, "street", 0),
        ],
    )
    table(c, *NE_LONG.at(18.0, 3.9), (0.0, 180.0))
    table(c, *NE_LONG.at(21.0, 4.0), (0.0, 180.0))
    table(c, *NE_LONG.at(19.4, 2.6), (70.0, 250.0))
    # the square
    c.put("sculpture", 13.6, 14.6, -120.0, 1)
    c.put("bench", 16.4, 13.8, 180.0, 0)
    c.put("bench", 13.2, 17.3, -90.0, 0)
    c.put("kiosk", 11.9, 13.4, 180.0)
    c.put("bookcase", 10.0, 15.8, 180.0, 1)
    c.put("bicycle", 16.0, 16.6, 130.0)
    c.put("tree", 15.2, 11.9, 60.0)
    c.put("pedestrian adult", 12.0, 16.4, 160.0)
    c.put("pedestrian adult", 14.9, 15.6, 200.0)
    c.put("bird", 12.6, 11.4, 30.0)
    c.along(
        NE_SHORT,
        [
            ("traffic light", 0.4, 0.6, "-", 0),
            ("street light", 4.0, 0.5, "street", 1),
            ("street light", 22.4, 0.5, "street", 1),
            ("tree", 8.4, 0.8, 20.0),
            ("tree", 27.0, 0.8, 130.0),
            ("potted plant", 6.0, 4.1, "street", 1),
            ("advertising board", 9.4, 3.2, "+"),
            ("mailbox", 10.6, 0.7, "wall", 1),
            ("elderly person", 12.2, 3.2, "-"),
            ("motorcycle", 18.2, 1.2, 60.0),
            ("motorcycle", 19.8, 1.2, 66.0),
            ("parcels", 24.6, 3.8, 10.0),
            ("delivery worker", 24.2, 2.8, "wall"),
            ("vending machine", 17.0, 4.0, "street"),
            ("bench", 29.4, 1.0, "wall", 3),
            ("pedestrian adult", 6.6, 2.2, "+"),
            ("pedestrian adult", 21.0, 3.8, "-"),
            ("dumpster", 29.8, 3.6, "street", 0),
        ],
    )


def _south_west(c: Canvas) -> None:
    """A sale's boxes; hire scooters and meal couriers."""
    for s in (4.0, 23.0):
        c.put("street light", *SW_LONG.at(s, 0.5), -90.0, 1)
    c.along(
        SW_LONG,
        [
            ("traffic light", 35.4, 0.6, "-", 0),
            ("tree", 8.0, 0.9, 40.0),
            ("tree", 15.4, 0.9, 100.0),
            ("tree", 30.6, 0.9, 160.0),
            ("refrigerator", 1.4, 4.4, "street", 1),
            ("washing machine", 2.6, 4.45, "street", 0),
            ("television", 4.6, 4.4, "street", 1),
            ("parcels", 6.2, 4.3, 10.0),
            ("parcels", 6.8, 3.1, 100.0),
            ("handcart", 5.4, 1.4, 20.0, 1),
            ("delivery worker", 3.6, 2.2, "wall"),
            ("advertising board", 9.4, 3.6, "+"),
            ("traffic barricade", 10.4, 2.5, 60.0),
            ("pedestrian adult", 11.9, 4.3, "-"),
            ("pedestrian adult", 12.8, 4.3, "-"),
            ("pedestrian adult", 14.7, 4.4, 170.0),
            ("elderly person", 16.5, 4.3, "-"),
            ("stroller", 17.8, 3.9, "-"),
            ("shopping cart", 10.8, 0.9, 30.0, 0),
            ("trash bin", 12.4, 0.7, "wall", 0),
            ("bench", 18.8, 1.0, "wall", 0),
            ("street clock", 20.8, 1.0, "+", 0),
            ("potted plant", 22.0, 4.4, "street", 1),
            ("ladder", 24.4, 4.3, "street", 0),
            ("maintenance worker", 24.6, 3.5, "wall"),
            ("traffic cone", 25.6, 3.6, 0.0, 0),
            ("coatrack", 29.4, 4.2, "street"),
            ("advertising board", 33.4, 3.2, "-"),
            ("pedestrian adult", 27.0, 2.4, "+"),
            ("pedestrian adult", 33.8, 2.0, "-"),
        ],
    )
    c.along(
        SW_SHORT,
        [
            ("traffic light", 30.5, 0.6, "-", 0),
            ("street light", 8.0, 0.5, "street", 1),
            ("street light", 26.2, 0.5, "street", 1),
            ("scooter", 14.0, 1.0, "wall", 0),
            ("scooter", 16.0, 1.5, 20.0, 1),
            ("scooter", 17.5, 1.0, 90.0, 1),
            ("scooter", 17.2, 2.4, 60.0, 1),
            ("scooter", 18.9, 1.0, 75.0, 0),
            ("scooter", 21.1, 1.3, 150.0, 1),
            ("bicycle", 22.8, 1.05, 80.0),
            ("motorcycle", 3.6, 1.3, 60.0),
            ("motorcycle", 5.2, 1.3, 64.0),
            ("delivery worker", 1.9, 1.6, "+"),
            ("delivery worker", 6.5, 1.0, 200.0),
            ("advertising board", 9.6, 3.2, "+"),
            ("potted plant", 11.6, 4.1, "street", 0),
            ("plant pot", 25.4, 4.0, "street", 0),
            ("trash bin", 10.4, 0.8, "wall", 1),
            ("blackboard", 24.4, 3.9, "-", 2),
            ("pedestrian adult", 25.8, 1.7, "-"),
            ("cat", 1.6, 3.8, 30.0),
        ],
    )
    table(c, *SW_SHORT.at(14.2, 3.8), (90.0, 270.0))
    table(c, *SW_SHORT.at(21.8, 3.9), (100.0, 280.0))


def _south_east(c: Canvas) -> None:
    """A burst water main before the tower; its planters, flags and smokers around the corner."""
    for s in (3.4, 26.4):
        c.put("street light", *SE_LONG.at(s, 0.5), -90.0, 1)
    c.along(
        SE_LONG,
        [
            ("traffic light", 0.6, 0.6, "+", 0),
            ("traffic barricade", 9.6, 1.4, "-"),
            ("traffic barricade", 9.8, 3.0, 170.0),
            ("traffic barricade", 16.4, 1.3, "+"),
            ("traffic barricade", 16.2, 2.8, 10.0),
            ("debris", 12.4, 1.4, 20.0, 0),
            ("debris", 14.2, 2.2, 110.0, 2),
            ("emergency worker", 13.4, 2.7, 200.0),
            ("maintenance worker", 15.2, 1.0, 170.0),
            ("traffic cone", 11.4, 3.3, 0.0, 1),
            ("traffic cone", 13.0, 3.4, 0.0, 1),
            ("traffic cone", 14.8, 3.3, 0.0, 1),
            ("tree", 6.0, 0.9, 30.0),
            ("tree", 20.4, 0.9, 90.0),
            ("stone block", 5.0, 3.2, 90.0, 1),
            ("bench", 22.6, 1.6, "wall", 3),
            ("bench", 25.0, 2.4, "street", 3),
            ("advertising board", 19.0, 3.4, "-"),
            ("street food stall", 29.0, 1.5, "wall", 1),
            ("pedestrian adult", 28.5, 3.2, "street"),
            ("trash bin", 31.0, 1.8, "wall", 0),
            ("scooter", 33.4, 2.4, 40.0, 1),
            ("pedestrian adult", 19.6, 2.2, "+"),
            ("pedestrian adult", 7.2, 4.2, "-"),
            ("jogger", 33.8, 3.6, "-"),
            ("roadside assistance vehicle", 13.6, -1.4, "+", 1),
        ],
    )
    c.along(
        SE_SHORT,
        [
            ("traffic light", 30.5, 0.6, "+", 0),
            ("flag", 27.4, 4.0, "street", 0),
            ("bollard", 28.4, 0.45, "street"),
            ("bollard", 24.8, 0.45, "street"),
            ("bollard", 21.2, 0.45, "street"),
            ("plant pot", 22.2, 1.5, "street", 0),
            ("shrub", 19.2, 1.4, "street", 1),
            ("potted plant", 23.6, 3.9, "street", 1),
            ("obelisk", 20.4, 3.6, "street", 2),
            ("security guard", 18.2, 3.8, "street"),
            ("pedestrian adult", 16.3, 1.0, 60.0),
            ("pedestrian adult", 15.3, 1.1, 100.0),
            ("ashtray", 15.2, 3.6, "street", 2),
            ("tree", 12.6, 0.8, 30.0),
            ("street light", 9.6, 0.5, "street", 1),
            ("bench", 11.4, 2.6, "street", 2),
            ("humanoid robot", 24.6, 2.3, "-", 0),
            ("advertising board", 8.9, 3.9, "+"),
            ("bicycle", 2.6, 1.0, "+"),
        ],
    )
    table(c, *SE_SHORT.at(3.6, 3.8), (90.0, 270.0))


def _road(c: Canvas) -> None:
    c.put("ambulance", -2.2, -3.0, 24.0, 0)
    c.put("police car", 3.4, -4.4, 100.0)
    c.put("emergency worker", 1.4, -1.2, 150.0)
    c.put("motorcycle", 2.4, 0.6, 30.0)
    c.put("police officer", 0.4, 3.0, 90.0)
    c.row("traffic cone", edge((4.6, -1.4), (4.6, 2.6), 1), (0.0, 1.3, 2.6), 0.0, 0.0, 1)
    c.put("taxi", 16.2, 1.6, 180.0)
    c.put("sedan", 22.6, 1.5, 180.0)
    c.put("bus", 24.6, 4.5, 180.0, 0)
    c.put("suv", -16.4, -1.6, 0.0)
    c.put("van", -22.6, -1.6, 0.0)
    c.put("truck", -41.6, -4.5, 0.0, 0)
    c.put("hatchback car", -28.4, -4.6, 0.0)
    c.put("cyclist", -15.2, -4.4, 0.0)
    c.put("sedan", -2.8, 17.4, -90.0)
    c.put("minivan", 3.0, 31.0, 90.0)
    c.put("car", 2.8, -18.0, 90.0, 2)
    c.put("garbage truck", -3.6, -36.0, -90.0, 0)
    c.put("school bus", -34.6, 4.5, 180.0, 1)
    chain(c, "jersey barrier", [(46.8, -5.6), (46.8, 5.6)])
    chain(c, "jersey barrier", [(-5.2, -43.0), (5.2, -43.0)])
    people(
        c,
        [
            ("pedestrian adult", -9.4, 2.6, -90.0),
            ("pedestrian adult", -10.6, -1.8, 90.0),
            ("pedestrian adult", 9.4, -3.0, 90.0),
            ("pedestrian adult", 10.8, 2.2, -90.0),
            ("elderly person", -2.8, 10.2, 180.0),
            ("pedestrian adult", 2.6, 11.2, 0.0),
            ("pedestrian adult", -1.6, -10.8, 180.0),
            ("stroller", 3.0, -10.0, 0.0),
            ("pedestrian adult", 1.7, -10.0, 0.0),
        ],
    )
    # the ends
    c.row("bollard", edge((-48.4, -5.4), (-48.4, 5.4), 1), (0.6, 4.4, 8.2), 0.0)
    c.put("bench", -50.8, 3.0, 0.0, 0)
    c.put("potted plant", -51.2, -0.4, 0.0, 1)
    c.row("bollard", edge((-5.0, 44.4), (5.0, 44.4), 1), (0.6, 4.2, 7.8), 0.0)
    c.put("bench", -4.0, 47.2, -90.0, 0)
    c.put("shrub", 4.6, 47.0, 0.0, 0)
    c.put("elderly person", -2.0, 46.4, -60.0)


def build() -> Canvas:
    c = blank(ID)
    _ground(c)
    _fronts(c)
    _north_west(c)
    _north_east(c)
    _south_west(c)
    _south_east(c)
    _road(c)
    c.trajectory = [
        (-46.0, 8.4),
        (-30.0, 9.4),
        (-10.0, 9.0),
        (-10.0, -8.6),
        (-30.0, -8.2),
        (-46.0, -8.4),
        (-49.6, 0.0),
        (-46.0, 8.4),
    ]
    c.trajectory += [
        (-10.0, 9.2),
        (-8.0, 12.0),
        (-8.8, 27.0),
        (-8.0, 45.4),
        (8.0, 45.4),
        (8.0, 24.0),
        (8.0, 12.4),
        (12.0, 9.0),
    ]
    c.trajectory += [
        (30.0, 8.0),
        (45.0, 9.0),
        (12.0, 9.0),
        (10.0, 0.0),
        (11.0, -8.6),
        (24.0, -10.0),
        (45.0, -9.0),
        (11.0, -8.6),
    ]
    c.trajectory += [
        (8.2, -11.0),
        (7.6, -26.0),
        (7.6, -40.0),
        (8.2, -11.0),
        (-8.0, -10.6),
        (-7.6, -22.0),
        (-7.8, -41.0),
    ]
    return c
