"""A shopping street with a blocked bicycle lane: a van unloads on it and hire bikes protrude over its kerb.

The street is 96 m long between a cross road and a paved end, with pavements of 4.4 and 4.6 m and a side street in the
middle. On the north the lane runs behind a bus island; cable trenches, terraces, goods and hire scooters force a slalom
on the pavements.
"""

from ..canvas import ground_layers as lay
from ..canvas.canvas import Canvas, edge
from ..canvas.pieces import blank, people, tables

ID = "08_commercial_street_bike_lane_dual_sidewalks"
LENGTH, PAVEMENT_HEIGHT = 96.0, 0.14
NORTH, SOUTH = edge((0, 5.0), (LENGTH, 5.0), 1), edge((0, -5.6), (LENGTH, -5.6), -1)


def _ground(c: Canvas) -> None:
    box = lay.rectangle
    c.ground("north_lots", "sidewalk", box(0, 9.6, LENGTH + 5, 12.6), PAVEMENT_HEIGHT)
    c.ground("south_lots", "sidewalk", box(0, -13.0, LENGTH + 5, -10.0), PAVEMENT_HEIGHT)
    c.ground("side_lots", "sidewalk", box(40.0, 9.6, 54.0, 26.0), PAVEMENT_HEIGHT)
    c.ground("west_lots", "sidewalk", box(-13.0, -18.5, -10.0, 18.5), PAVEMENT_HEIGHT)
    c.ground("west_far", "sidewalk", box(-10.0, -16.0, -7.0, 16.0), PAVEMENT_HEIGHT)
    c.ground("end_lots", "sidewalk", box(LENGTH + 5, -10.0, LENGTH + 8, 9.6), PAVEMENT_HEIGHT)
    c.ground("north_pavement", "sidewalk", box(0, 5.0, LENGTH, 9.6), PAVEMENT_HEIGHT)
    c.ground("south_pavement", "sidewalk", box(0, -10.0, LENGTH, -5.6), PAVEMENT_HEIGHT)
    c.ground("end", "sidewalk", box(LENGTH, -10.0, LENGTH + 5, 9.6), PAVEMENT_HEIGHT)
    c.ground("cross_road", "road", box(-7.0, -16.0, 0.0, 16.0))
    c.ground("road", "road", box(0, -5.6, LENGTH, 3.0))
    c.ground("lane", "road", box(0, 3.0, LENGTH, 5.0))
    c.ground("side_pavement", "sidewalk", box(42.0, 9.6, 52.0, 24.0), PAVEMENT_HEIGHT)
    c.ground("side_road", "road", box(44.0, 5.0, 50.0, 24.0))
    c.ground("zebra_west", "crosswalk", box(18.0, -5.6, 22.0, 5.0))
    c.ground("zebra_east", "crosswalk", box(82.0, -5.6, 86.0, 5.0))
    c.ground("zebra_side", "crosswalk", box(44.0, 5.7, 50.0, 9.7))
    c.ground("zebra_cross", "crosswalk", box(-7.0, 5.2, 0.0, 9.2))
    c.ramp("ramp_nw", (20.0, 5.0), 90.0, parted=False)
    c.ramp("ramp_sw", (20.0, -5.6), -90.0)
    c.ramp("ramp_ne", (84.0, 5.0), 90.0, parted=False)
    c.ramp("ramp_se", (84.0, -5.6), -90.0)
    c.ramp("ramp_side_w", (44.0, 7.7), 180.0, parted=False)
    c.ramp("ramp_side_e", (50.0, 7.7), 0.0)
    c.ramp("ramp_cross_w", (-7.0, 7.2), 180.0, parted=False)
    c.ramp("ramp_cross_e", (0.0, 7.2), 0.0)
    # the bus island, and the raised crossing to it over the lane
    c.ground("island", "sidewalk", box(60.0, 1.1, 76.0, 3.0), PAVEMENT_HEIGHT)
    c.ground("hump", "crosswalk", box(66.4, 3.0, 69.6, 5.0), PAVEMENT_HEIGHT)
    c.slope(
        "hump_up", "road", box(65.0, 3.0, 66.4, 5.0), [(65.0, 3.0, 0), (65.0, 5.0, 0), (66.4, 3.0, PAVEMENT_HEIGHT)]
    )
    c.slope(
        "hump_down", "road", box(69.6, 3.0, 71.0, 5.0), [(71.0, 3.0, 0), (71.0, 5.0, 0), (69.6, 3.0, PAVEMENT_HEIGHT)]
    )
    for i, (x0, x1) in enumerate(((0.4, 17.4), (22.6, 59.4), (76.6, 81.4), (86.6, 95.4))):
        c.paint(f"lane_edge_{i}", box(x0, 2.86, x1, 3.0))
    for i, (x0, x1) in enumerate(((1.0, 16.0), (24.5, 80.0), (88.5, 95.0))):
        c.dashes(f"middle_{i}", (x0, -0.4), (x1, -0.4))
    c.paint("stop_west", box(22.9, -0.25, 23.3, 2.8))
    c.paint("stop_east", box(80.9, -3.2, 81.3, -0.55))
    for i, x in enumerate((30.0, 36.0, 42.0, 48.0, 54.0, 60.0, 66.0, 72.0)):
        c.paint(f"bay_{i}", box(x - 0.05, -5.5, x + 0.05, -3.4))
    c.wear("road", "road/asphalt_used")
    for x in (2.0, 30.0, 65.5, 70.0, 75.0, 90.0):
        c.wear((x, 4.0), "road/lane_red-painted_red")
    for spot in ((30.0, 7.0), (60.0, 7.0), (30.0, -8.0), (-8.5, 0.0), (98.0, 0.0), (62.0, 2.0)):
        c.wear(spot, "sidewalk/flags_grey")
    c.wear("crosswalk", "zebra_new")
    c.wear("road_marking", "paint_white")
    c.sky("spring_noon-scattered_cumulus")


def _fronts(c: Canvas) -> None:
    c.houses(NORTH, ("supermarket", "clothing store", "cafe", "bookstore"), 0, 42, 4.6)
    c.houses(NORTH, ("hotel", "bakery", "electronics store", "optical store"), 52, 96, 4.6)
    south = ("pharmacy", "toy shop", "restaurant", "bank", "bicycle shop", "convenience store", "hair salon")
    c.houses(SOUTH, (*south, "fast food restaurant", "flower shop", "jewelry store"), 0, 96, 4.4)
    c.houses(edge((42, 17.6), (42, 24), 1), ("house",), 0, 6.4, 0)
    c.houses(edge((52, 19.65), (52, 24), -1), ("garage",), 0, 4.35, 0)
    c.houses(edge((42, 24), (52, 24), 1), ("apartment building",), 0, 10, 0)
    west = ("office building", "clothing store", "apartment building")
    c.houses(edge((-10, -16), (-10, 16), 1), west, 0, 32, 0)
    c.houses(edge((101, -10), (101, 9.6), -1), ("theater",), 0, 19.6, 0)
    c.houses(edge((-10, 16), (0, 16), 1), ("bank",), 0, 10, 0)
    c.houses(edge((-10, -16), (0, -16), -1), ("hotel",), 0, 10, 0)


def _north(c: Canvas) -> None:
    c.trees(NORTH, (4.6, 13.4, 27.4, 38.8, 56.0, 78.4, 90.6), 0.75)
    for s in (8.6, 30.9, 54.2, 79.8, 94.0):
        c.put("street light", *NORTH.at(s, 0.45), 90.0)
    c.along(
        NORTH,
        [
            # the supermarket's objects
            ("shopping cart", 2.0, 4.0, "+", 0),
            ("storage box", 5.6, 4.2, "street", 1),
            ("storage box", 6.4, 4.2, "street", 2),
            ("advertising board", 7.2, 2.6, "+"),
            ("trash bin", 6.6, 0.7, "wall", 0),
            ("newspaper stand", 9.9, 0.65, "wall"),
            ("vending machine", 12.2, 4.1, "street"),
            ("bench", 11.0, 3.0, "street", 2),
            ("parcels", 15.0, 4.1, 20.0),
            ("traffic light", 17.2, 0.45, "-"),
            ("traffic light", 23.0, 0.45, "+"),
            ("bollard", 17.6, 0.35, "street"),
            ("bollard", 22.5, 0.35, "street"),
            # hire bikes in the rack and beside it
            ("bicycle rental", 33.9, 1.15, "wall", 1),
            ("bicycle", 40.2, 1.8, 10.0),
            ("scooter", 29.9, 1.2, 100.0, 0),
            ("scooter", 28.6, 1.2, 20.0, 1),
            ("scooter", 37.3, 1.5, 150.0, 1),
            ("advertising board", 24.9, 3.2, "+"),
            ("advertising board", 35.6, 3.5, "-"),
            ("postbox", 40.6, 0.7, "wall"),
            ("fire hydrant", 25.6, 0.5, "street"),
            ("bookcase", 38.4, 4.15, "street", 1),
            ("advertising board", 40.4, 3.4, "+"),
            # beyond the side street: cable works before the hotel
            ("road work detour ahead sign", 53.4, 2.0, "-", 0),
            ("traffic barricade", 54.9, 2.2, "-"),
            ("debris", 57.3, 2.0, 20.0, 0),
            ("debris", 58.8, 1.1, 100.0, 2),
            ("barrow", 60.3, 1.7, 40.0, 0),
            ("construction worker", 58.6, 2.3, 160.0),
            ("construction worker", 61.4, 1.1, 200.0),
            ("traffic barricade", 62.4, 1.7, "+"),
            ("traffic cone", 55.6, 3.05, 0.0, 1),
            ("traffic cone", 58.8, 3.05, 0.0, 1),
            ("traffic cone", 61.9, 2.8, 0.0, 1),
            ("luggage", 64.4, 4.15, 20.0),
            ("suitcase", 65.1, 4.2, 80.0),
            ("potted plant", 53.0, 4.2, "street", 1),
            ("potted plant", 63.4, 4.2, "street", 1),
            # bakery and electronics
            ("advertising board", 71.8, 1.9, "+"),
            ("bench", 64.2, 0.8, "wall", 0),
            ("trash bin", 72.6, 0.7, "wall", 0),
            ("refrigerator", 78.0, 4.1, "street", 0),
            ("washing machine", 79.2, 4.15, "street", 0),
            ("parcels", 80.2, 3.4, 30.0),
            ("handcart", 81.3, 3.9, "+", 1),
            ("traffic light", 81.2, 0.45, "-"),
            ("traffic light", 86.9, 0.45, "+"),
            ("bollard", 81.6, 0.35, "street"),
            ("bollard", 86.5, 0.35, "street"),
            ("atm", 88.6, 4.2, "street", 0),
            ("advertising board", 91.8, 2.9, "+"),
            ("telephone booth", 93.2, 4.0, "street"),
            ("bicycle", 89.0, 0.9, "+"),
            ("charging station", 92.6, 0.5, "street"),
        ],
    )
    tables(c, NORTH, [(25.0, 4.0), (27.8, 4.05), (30.6, 3.95), (33.2, 4.0)])
    tables(c, NORTH, [(26.6, 2.75)], (20.0, 200.0))
    c.put("sunshade", *NORTH.at(29.2, 3.2), 0.0)
    tables(c, NORTH, [(67.0, 3.9), (69.6, 3.95)])
    c.put("plant pot", *NORTH.at(23.6, 4.1), 0.0, 0)
    c.put("kiosk", *NORTH.at(74.6, 1.6), 90.0)
    people(
        c,
        [
            ("pedestrian adult", 8.9, 8.6, 180.0),
            ("pedestrian adult", 9.0, 6.1, 0.0),
            ("pedestrian child", 14.4, 7.3, 190.0),
            ("pedestrian adult", 14.3, 6.6, 185.0),
            ("wheelchair user", 24.4, 6.7, 180.0),
            ("pedestrian adult", 37.6, 8.3, 10.0),
            ("delivery robot", 16.8, 7.2, 0.0),
            ("pedestrian adult", 65.8, 8.3, 200.0),
            ("pedestrian adult", 76.9, 6.4, 180.0),
            ("elderly person", 77.5, 5.7, 160.0),
            ("jogger", 88.2, 7.0, 180.0),
            ("dog", 90.2, 7.6, 160.0),
            ("pedestrian adult", 91.0, 8.0, 165.0),
            ("pedestrian adult", 70.8, 6.6, 100.0),
        ],
    )


def _south(c: Canvas) -> None:
    c.trees(SOUTH, (7.2, 14.2, 33.4, 45.4, 57.2, 69.4, 91.4), 0.75, "slim")
    for s in (3.2, 27.0, 51.2, 75.2):
        c.put("lamppost", *SOUTH.at(s, 0.55), 0.0, 0)
    c.along(
        SOUTH,
        [
            ("advertising board", 4.4, 2.6, "+"),
            ("bench", 5.4, 0.85, "wall", 0),
            ("trash bin", 9.0, 0.7, "wall", 0),
            ("tricycle", 12.6, 3.2, 30.0, 0),
            ("advertising board", 15.8, 3.3, "-"),
            ("traffic light", 17.2, 0.45, "-"),
            ("traffic light", 22.9, 0.45, "+"),
            ("potted plant", 18.2, 4.0, "street", 0),
            ("potted plant", 27.0, 4.0, "street", 0),
            ("blackboard", 24.4, 1.7, "+", 2),
            ("postbox", 28.4, 0.7, "wall"),
            ("police officer", 34.8, 3.4, "street"),
            ("street cabinet", 36.6, 0.7, "wall", 0),
            ("scooter", 38.2, 0.8, 70.0, 0),
            ("scooter", 39.0, 1.5, 10.0, 1),
            ("parking meter", 40.6, 0.4, "wall"),
            # the bicycle shop's display
            ("bicycle", 42.6, 3.35, 70.0),
            ("bicycle", 43.7, 3.35, 75.0),
            ("bicycle", 44.8, 3.35, 70.0),
            ("bicycle", 46.2, 3.3, 80.0),
            ("bicycle repair station", 47.4, 2.2, "wall", 0),
            ("vehicle wheel", 48.4, 4.1, "street"),
            ("advertising board", 49.4, 2.2, "+"),
            ("storage box", 53.0, 4.0, "street", 2),
            ("storage box", 54.1, 3.95, 80.0, 1),
            ("vending machine", 55.6, 3.9, "street"),
            ("garbage bag", 56.6, 1.5, 40.0),
            ("garbage bag", 57.9, 1.6, 100.0),
            ("dumpster", 60.4, 0.95, "wall", 0),
            ("coatrack", 62.4, 3.9, "street"),
            ("advertising board", 64.8, 3.2, "-"),
            ("parking meter", 66.2, 0.4, "wall"),
            # fast food: occupied tables, overflowing bins
            ("trash bin", 67.8, 2.6, "street", 0),
            ("garbage bag", 68.6, 2.9, 20.0),
            ("motorcycle", 72.4, 1.0, 45.0),
            ("motorcycle", 74.0, 1.0, 45.0),
            ("advertising board", 77.8, 1.2, "+"),
            ("traffic light", 81.2, 0.45, "-"),
            ("traffic light", 86.9, 0.45, "+"),
            # flowers
            ("flower", 83.4, 3.85, 0.0, 0),
            ("flower", 84.6, 3.9, 40.0, 1),
            ("plant pot", 88.0, 3.0, 0.0, 0),
            ("shrub", 89.2, 3.6, 0.0, 0),
            ("barrel or bucket", 87.3, 2.6, 0.0, 2),
            ("advertising board", 92.6, 3.2, "+"),
            ("fire hydrant", 79.4, 0.5, "street"),
        ],
    )
    tables(c, SOUTH, [(19.6, 3.7), (22.2, 3.7), (25.2, 3.75)])
    tables(c, SOUTH, [(71.0, 3.6), (74.0, 3.7), (76.8, 3.6), (79.8, 3.7)])
    c.put("sunshade", *SOUTH.at(78.3, 3.3), 0.0)
    people(
        c,
        [
            ("pedestrian adult", 8.2, -8.0, 0.0),
            ("pedestrian child", 11.3, -8.1, -80.0),
            ("pedestrian adult", 2.6, -7.2, 190.0),
            ("pedestrian adult", 31.7, -8.2, -100.0),
            ("elderly person", 37.2, -8.2, 180.0),
            ("pedestrian adult", 51.7, -8.25, 175.0),
            ("pedestrian adult", 51.9, -9.05, 175.0),
            ("stroller", 54.6, -7.9, 0.0),
            ("pedestrian adult", 53.5, -7.7, 0.0),
            ("delivery worker", 62.6, -7.5, -100.0),
            ("pedestrian adult", 69.9, -6.75, 20.0),
            ("pedestrian adult", 82.1, -8.6, 180.0),
            ("cat", 88.9, -6.6, 120.0),
        ],
    )


def _road(c: Canvas) -> None:
    lane = edge((0, 3.0), (LENGTH, 3.0), 1)
    c.row("bollard", lane, (2.0, 5.5, 9.0, 12.5, 16.0, 34.5, 38.0, 41.5, 52.5, 56.0, 78.5, 89.0, 92.5), -0.3)
    c.along(
        lane,
        [
            ("cyclist", 6.8, 1.0, "-"),
            ("cyclist", 14.6, 0.9, "-"),
            ("van", 27.2, 0.4, "-"),
            ("parcels", 31.4, 1.2, 20.0),
            ("delivery worker", 32.8, 1.1, "-"),
            ("traffic cone", 23.7, 0.6, 0.0, 0),
            ("cyclist", 39.8, 0.5, 165.0),
            ("cyclist", 62.2, 1.0, "-"),
            ("cyclist", 72.8, 1.0, "-"),
            ("electric scooter rider", 88.0, 1.1, "-"),
            ("dumpster", 93.2, 0.9, "wall", 0),
        ],
    )
    island = edge((60, 1.1), (76, 1.1), 1)
    c.put("bus shelter", 63.1, 2.05, -90.0, size=(1.67, 3.58, 2.55))
    c.along(
        island,
        [
            ("pole", 0.8, 0.9, "-", 2),
            ("trash bin", 5.6, 1.4, "street", 1),
            ("pedestrian adult", 8.2, 0.4, "-"),
            ("pedestrian adult", 10.6, 0.6, "street"),
            ("pedestrian adult", 12.0, 0.9, "-"),
            ("elderly person", 13.0, 0.5, "street"),
            ("bench", 14.4, 1.4, "street", 2),
        ],
    )
    c.put("bus", 67.6, -0.55, 180.0, 0)
    bays = edge((0, -4.42), (LENGTH, -4.42), 1)
    cars = (("hatchback car", 27.0), ("electric car", 33.0), ("sedan", 39.0), ("suv", 45.0), ("pickup truck", 57.0))
    for label, s in (*cars, ("taxi", 63.2), ("minivan", 69.2)):
        c.put(label, *bays.at(s, 0.0), c.uniform(-1.5, 1.5))
    c.put("truck", 8.4, -4.0, 1.0)
    c.put("motorcycle", 49.6, -4.4, 70.0)
    c.put("motorcycle", 51.2, -4.4, 60.0)
    c.put("car", 91.0, -2.2, 0.0)
    c.put("sedan", 36.0, 1.2, 180.0)
    c.put("police car", -3.6, -9.0, 90.0)
    c.put("taxi", -2.0, 12.4, -90.0)
    c.put("hatchback car", 47.0, 19.4, 90.0)
    c.put("trash bin", 43.0, 14.0, 0.0, 0)
    c.put("garbage bag", 43.1, 15.2, 30.0)
    c.put("bicycle", 51.3, 15.0, 90.0)
    people(
        c,
        [
            ("pedestrian adult", 19.6, 1.2, 90.0),
            ("pedestrian adult", 20.8, -2.2, -90.0),
            ("pedestrian adult", 84.6, -1.0, 90.0),
            ("pedestrian adult", 46.6, 7.9, 0.0),
        ],
    )


def _ends(c: Canvas) -> None:
    c.row("bollard", edge((96.5, -5), (96.5, 5), -1), (1.2, 3.0, 4.8, 6.6, 8.4), 0.0)
    c.put("sculpture", 98.6, 0.4, 180.0, 0)
    c.put("bench", 98.8, 4.6, 180.0, 0)
    c.put("bench", 98.8, -4.2, 180.0, 0)
    c.put("advertising board", 99.4, -7.8, 180.0, size=(1.44, 1.44, 3.26))
    c.put("potted plant", 100.2, 8.6, 180.0, 1)
    c.put("pedestrian adult", 97.8, -2.0, 100.0)
    c.put("pedestrian adult", 98.0, -1.1, -80.0)
    far = edge((-7, -16), (-7, 16), 1)
    c.along(
        far,
        [
            ("street light", 6.0, 0.45, "street"),
            ("bus shelter", 11.0, 1.9, "street"),
            ("trash bin", 14.0, 0.7, "street", 1),
            ("pedestrian adult", 8.3, 0.8, "street"),
            ("tree", 16.8, 0.8, 30.0),
            ("bench", 20.0, 2.4, "street", 0),
            ("bicycle parking", 27.5, 1.0, "street", 1),
            ("bicycle", 28.8, 1.1, "street"),
        ],
    )


def build() -> Canvas:
    c = blank(ID)
    _ground(c)
    _fronts(c)
    _north(c)
    _south(c)
    _road(c)
    _ends(c)
    c.trajectory = [
        (-8.6, 7.2),
        (1.0, 7.2),
        (20.0, 7.2),
        (42.0, 7.4),
        (52.0, 7.7),
        (68.0, 7.4),
        (84.0, 7.4),
        (84.0, -7.4),
    ]
    c.trajectory += [(60.0, -8.4), (40.0, -8.0), (20.0, -7.4), (3.0, -8.0)]
    return c
