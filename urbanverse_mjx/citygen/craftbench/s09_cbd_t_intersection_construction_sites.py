"""A T junction in a business district with three construction sites.

An avenue of four lanes (96 m) meets a street that ends on it (50 m); kerbs are 18 cm high. A building site occupies
half of the north-west pavement. A trench closes the south pavement, so that the path leads down a ramp onto the road,
between concrete barriers, and up again. In the side street scaffolding and cable works leave 1.2 m free.
"""

from ..canvas import ground_layers as lay
from ..canvas.canvas import Canvas, edge
from ..canvas.pieces import blank, chain, people, table

ID = "09_cbd_t_intersection_construction_sites"
LENGTH, PAVEMENT_HEIGHT = 96.0, 0.18
NORTH, SOUTH = edge((0, 7.0), (LENGTH, 7.0), 1), edge((0, -7.0), (LENGTH, -7.0), -1)
WEST, EAST = edge((44.0, 12.0), (44.0, 62.0), 1), edge((54.0, 12.0), (54.0, 62.0), -1)


def _ground(c: Canvas) -> None:
    box = lay.rectangle
    c.ground("north_lots", "sidewalk", box(-12.0, 12.0, LENGTH + 6, 14.6), PAVEMENT_HEIGHT)
    c.ground("south_lots", "sidewalk", box(-12.0, -14.6, LENGTH + 6, -12.0), PAVEMENT_HEIGHT)
    c.ground("stem_lots", "sidewalk", box(37.0, 12.0, 61.0, 64.6), PAVEMENT_HEIGHT)
    c.ground("site_lots", "sidewalk", box(9.0, 30.0, 27.0, 32.6), PAVEMENT_HEIGHT)
    c.ground("west_lots", "sidewalk", box(-14.6, -18.6, -12.0, 18.6), PAVEMENT_HEIGHT)
    c.ground("east_lots", "sidewalk", box(LENGTH + 6, -12.0, LENGTH + 8.6, 12.0), PAVEMENT_HEIGHT)
    c.ground("west_far", "sidewalk", box(-12.0, -16.0, -9.0, 16.0), PAVEMENT_HEIGHT)
    c.ground("west_arms", "sidewalk", box(-9.0, -18.6, 0.0, 18.6), PAVEMENT_HEIGHT)
    c.ground("cross_road", "road", box(-9.0, -16.0, 0.0, 16.0))
    corner = [(0, 7), (41.5, 7), (44, 9.5), (44, 62), (39.5, 62), (39.5, 12), (0, 12)]
    c.ground("north_west", "sidewalk", corner, PAVEMENT_HEIGHT)
    corner = [(LENGTH, 7), (56.5, 7), (54, 9.5), (54, 62), (58.5, 62), (58.5, 12), (LENGTH, 12)]
    c.ground("north_east", "sidewalk", corner, PAVEMENT_HEIGHT)
    c.ground("south_pavement", "sidewalk", box(0, -12.0, LENGTH, -7.0), PAVEMENT_HEIGHT)
    c.ground("forecourt", "sidewalk", box(LENGTH, -12.0, LENGTH + 6, 12.0), PAVEMENT_HEIGHT)
    stem = [(41.5, 7), (56.5, 7), (54, 9.5), (54, 62), (44, 62), (44, 9.5)]
    c.ground("avenue", "road", box(0, -7.0, LENGTH, 7.0))
    c.ground("stem", "road", stem)
    c.ground("stem_end", "sidewalk", box(44.0, 59.0, 54.0, 62.0), PAVEMENT_HEIGHT)
    # ground outside the pavements: the site, the pit
    c.ground("site", "road", box(9.0, 10.6, 27.0, 30.0), PAVEMENT_HEIGHT)
    c.ground("tower_lot", "road", box(68.4, 22.2, 88.8, 42.8), PAVEMENT_HEIGHT)
    c.ground("pit", "road", box(68.5, -11.4, 77.5, -8.4), -0.3)
    c.ground("zebra_stem", "crosswalk", box(44.0, 10.0, 54.0, 14.0))
    c.ground("zebra_west", "crosswalk", box(34.0, -7.0, 38.0, 7.0))
    c.ground("zebra_east", "crosswalk", box(58.6, -7.0, 62.6, 7.0))
    c.ground("zebra_cross", "crosswalk", box(-9.0, -11.5, 0.0, -7.5))
    c.ground("detour", "sidewalk", box(64.6, -7.0, 81.4, -5.1))
    c.ramp("ramp_stem_w", (44.0, 12.0), 180.0, parted=False)
    c.ramp("ramp_stem_e", (54.0, 12.0), 0.0)
    c.ramp("ramp_nw", (36.0, 7.0), 90.0, parted=False)
    c.ramp("ramp_sw", (36.0, -7.0), -90.0)
    c.ramp("ramp_ne", (60.6, 7.0), 90.0, parted=False)
    c.ramp("ramp_se", (60.6, -7.0), -90.0, flare=0.9)
    c.ramp("ramp_cross_w", (-9.0, -9.5), 180.0, parted=False)
    c.ramp("ramp_cross_e", (0.0, -9.5), 0.0)
    c.ramp("detour_in", (65.9, -7.0), -90.0, 0.9, 1.6, 0.8, parted=False)
    c.ramp("detour_out", (80.1, -7.0), -90.0, 0.9, 1.6, 0.8)
    for name, y, spans in (
        ("double", 0.0, ((1.0, 31.0), (65.5, 95.0))),
        ("north_lane", 3.5, ((1.0, 31.0), (65.0, 95.0))),
        ("south_lane", -3.5, ((1.0, 31.0), (41.0, 57.0), (66.0, 95.0))),
    ):
        for i, (x0, x1) in enumerate(spans):
            if name == "double":
                c.paint(f"{name}_{i}", box(x0, y - 0.08, x1, y + 0.08))
            else:
                c.dashes(f"{name}_{i}", (x0, y), (x1, y), gap=6.5)
    c.paint("stop_west", box(33.0, -6.6, 33.4, -0.3))
    c.paint("stop_east", box(63.4, 0.3, 63.8, 6.6))
    c.paint("stop_stem", box(44.4, 15.0, 48.6, 15.4))
    c.dashes("stem_middle", (49.0, 17.0), (49.0, 57.0), gap=6.5)
    c.wear("road", "road/asphalt_used")
    c.wear((20.0, 20.0), "road/earth")
    c.wear((70.0, -10.0), "road/earth")
    for spot in ((20.0, 9.0), (70.0, 9.0), (-10.5, 0.0), (20.0, -9.0), (90.0, -9.0)):
        c.wear(spot, "sidewalk/granite_light")
    c.wear((72.0, -6.0), "sidewalk/asphalt_grey")
    c.wear("crosswalk", "zebra_worn")
    c.wear("road_marking", "paint_white")
    c.sky("summer_morning-broken_cumulus")


def _fronts(c: Canvas) -> None:
    south = ("office building", "bank", "hotel", "office building", "clothing store", "office building")
    c.houses(SOUTH, (*south, "apartment building", "hotel"), 0, 96, 5.0)
    c.houses(NORTH, ("office building",), 0, 9, 5.0)
    c.houses(NORTH, ("office building",), 27, 39.5, 5.0)
    c.houses(NORTH, ("bank",), 84.1, 96, 5.0)
    c.houses(NORTH, ("office building", "hotel"), 58.5, 84, 5.0)
    c.put("skyscraper", 78.6, 32.6, -90.0, size=(20.0, 20.0, 96.0))
    c.houses(edge((39.5, 21.6), (39.5, 62), 1), ("hotel", "office building", "bank"), 0, 40.4, 0)
    east = ("office building", "restaurant", "office building")
    c.houses(edge((58.5, 21.7), (58.5, 62), -1), east, 0, 40.3, 0)
    c.houses(edge((39.5, 62), (58.5, 62), 1), ("hotel", "cafe"), 0, 19, 0)
    c.houses(edge((9, 30), (27, 30), 1), ("apartment building", "house"), 0, 18, 0)
    west = ("hotel", "office building", "apartment building")
    c.houses(edge((-12, -16), (-12, 16), 1), west, 0, 32, 0)
    c.houses(edge((-12, 16), (0, 16), 1), ("bank",), 0, 12, 0)
    c.houses(edge((-12, -16), (0, -16), -1), ("office building",), 0, 12, 0)
    c.houses(edge((102, -12), (102, 12), -1), ("train station",), 0, 24, 0)
    chain(c, "wall", [(9.3, 29.8), (9.3, 21.8)], 1, 1.3)
    chain(c, "wall", [(26.7, 21.8), (26.7, 29.8)], 1, 1.3)


def _site(c: Canvas) -> None:
    """The building site in the north-west, and the narrowed pavement."""
    chain(c, "fence", [(9.1, 10.2), (17.4, 10.2)], 1, 1.3)
    chain(c, "fence", [(22.2, 10.2), (27.0, 10.2)], 1, 1.3)
    c.put("fence", 9.2, 11.2, 180.0, size=(0.13, 1.5, 1.8))
    c.put("fence", 26.9, 11.2, 0.0, size=(0.13, 1.5, 1.8))
    c.put("lift gate", 19.8, 10.3, -90.0, 0)
    c.put("excavator", 13.6, 22.6, 35.0, 0)
    c.put("crane", 21.4, 18.6, 95.0, 0)
    c.put("container", 12.6, 13.4, -90.0, 0)
    c.put("bulldozer", 23.6, 27.4, 100.0, 2)
    c.put("debris", 12.4, 27.0, 30.0, 1)
    c.put("rocky field", 17.7, 28.2, 0.0, 1)
    c.put("stone block", 24.6, 14.0, 10.0, 1)
    c.put("barrow", 25.2, 12.4, 80.0, 0)
    c.along(
        NORTH,
        [
            ("road work detour ahead sign", 5.2, 3.0, "-", 0),
            ("caution sign", 8.4, 0.6, "-", 0),
            ("traffic cone", 7.4, 2.5, 0.0, 1),
            ("storage box", 10.3, 2.7, 0.0, 0),
            ("stone block", 12.6, 0.7, 20.0, 1),
            ("stone block", 13.6, 0.7, 95.0, 1),
            ("traffic cone", 14.9, 1.2, 0.0, 0),
            ("construction worker", 16.0, 0.9, "street"),
            ("traffic barricade", 17.4, 1.0, "-"),
            ("traffic controller", 18.7, 0.7, "wall", 2),
            ("construction worker", 21.0, 0.8, 100.0),
            ("traffic barricade", 22.9, 0.9, "+"),
            ("ladder", 29.6, 4.3, "street", 1),
            ("barrel or bucket", 26.0, 0.9, 0.0, 1),
            ("traffic cone", 27.9, 1.2, 0.0, 1),
        ],
    )
    c.put("truck", 14.6, 5.1, 180.0, 0)
    c.put("cement mixer", 23.4, 5.2, 180.0, 0)
    c.row("traffic cone", edge((9.0, 3.3), (29.0, 3.3), 1), (0.0, 5.2, 10.4, 15.6), 0.0, 0.0, 1)


def _trench(c: Canvas) -> None:
    """The closed south pavement and the diversion on the road."""
    chain(c, "fence", [(67.9, -7.25), (78.1, -7.25)], 1, 1.3)
    chain(c, "fence", [(67.6, -11.8), (67.6, -7.4)], 1, 1.3)
    chain(c, "fence", [(78.4, -7.4), (78.4, -11.8)], 1, 1.3)
    chain(c, "jersey barrier", [(64.2, -4.75), (81.8, -4.75)])
    c.put("jersey barrier", 64.0, -6.1, 0.0, size=(0.62, 1.7, 0.82))
    c.put("jersey barrier", 82.1, -6.1, 0.0, size=(0.62, 1.7, 0.82))
    c.put("excavator", 73.2, -9.9, 178.0, size=(4.2, 1.55, 2.4))
    c.put("construction worker", 76.6, -9.0, 200.0)
    c.put("construction worker", 69.6, -9.4, 10.0)
    c.put("rock", 76.4, -10.5, 30.0, 0)
    c.put("debris", 70.3, -10.4, 80.0, 0)
    c.along(
        SOUTH,
        [
            ("road work detour ahead sign", 62.9, 2.0, "-", 0),
            ("traffic cone", 64.6, 2.6, 0.0, 1),
            ("traffic barricade", 66.6, 4.1, "-"),
            ("construction worker", 82.6, 3.1, 160.0),
            ("traffic barricade", 79.5, 4.0, "+"),
            ("traffic cone", 80.6, 3.0, 0.0, 1),
            ("handcart", 84.0, 4.2, "+", 1),
            ("road work detour ahead sign", 84.6, 1.9, "+", 0),
        ],
    )
    c.put("traffic cone", 72.8, -5.45, 0.0, 0)
    c.put("pedestrian adult", 75.2, -6.65, 180.0)
    c.put("caution sign", 83.0, -5.5, 0.0, 2)
    c.put("roadside assistance vehicle", 87.6, -5.6, 180.0, 1)


def _corner_life(c: Canvas) -> None:
    for s in (2.0, 29.8, 64.0, 79.6, 93.6):
        c.put("street light", *NORTH.at(s, 0.5), 90.0, 1)
    for s in (10.0, 27.0, 45.0, 56.0, 86.6):
        c.put("street light", *SOUTH.at(s, 0.5), -90.0, 1)
    c.along(
        NORTH,
        [
            ("traffic light", 33.2, 0.6, "-", 0),
            ("bollard", 39.4, 0.45, "street"),
            ("traffic light", 63.6, 0.6, "+", 0),
            ("street cabinet", 31.2, 4.4, "street", 1),
            ("atm", 33.8, 4.55, "street", 0),
            ("bench", 30.8, 1.1, "wall", 3),
            ("trash bin", 32.4, 0.7, "wall", 1),
            # the tower's corner
            ("bollard", 57.6, 0.45, "street"),
            ("potted plant", 64.4, 4.2, "street", 1),
            ("sculpture", 66.0, 1.4, "street", 0),
            ("bench", 69.0, 1.3, "wall", 3),
            ("bench", 72.0, 1.3, "wall", 3),
            ("tree", 70.5, 0.9, 40.0),
            ("tree", 75.8, 0.9, 100.0),
            ("food truck", 79.0, -1.75, "+"),
            ("advertising board", 77.4, 2.6, "+"),
            ("trash bin", 80.8, 1.0, "wall", 0),
            ("garbage bag", 81.6, 1.3, 30.0),
            ("bicycle parking", 85.4, 1.1, "wall", 0),
            ("bicycle", 86.7, 1.1, "wall"),
            ("bicycle", 84.0, 1.2, "street"),
            ("scooter", 90.8, 1.9, 60.0, 0),
            ("scooter", 91.8, 2.6, 10.0, 1),
            ("information point", 94.4, 1.4, "street", 0),
        ],
    )
    table(c, *NORTH.at(75.4, 3.9), (0.0, 180.0))
    table(c, *NORTH.at(78.6, 3.9), (20.0, 200.0))
    table(c, *NORTH.at(81.0, 3.5), (90.0, 270.0))
    c.along(
        SOUTH,
        [
            ("tree", 4.6, 0.9, 10.0),
            ("tree", 14.0, 0.9, 60.0),
            ("tree", 41.0, 0.9, 130.0),
            ("tree", 50.6, 0.9, 170.0),
            ("tree", 91.6, 0.9, 80.0),
            ("traffic light", 33.2, 0.6, "-", 0),
            ("traffic light", 57.6, 0.6, "-", 0),
            ("bus shelter", 18.0, 1.9, "street"),
            ("pedestrian adult", 16.6, 0.7, "street"),
            ("pedestrian adult", 20.6, 1.1, "-"),
            ("trash bin", 15.0, 1.6, "wall", 1),
            ("potted plant", 8.6, 4.4, "street", 1),
            ("bench", 6.6, 2.6, "street", 3),
            ("kiosk", 29.4, 1.75, "wall"),
            ("advertising board", 26.4, 3.2, "+"),
            ("storage box", 31.6, 2.1, 20.0, 1),
            ("parcel locker", 39.6, 4.5, "street", 0),
            ("telephone booth", 43.0, 2.0, "wall"),
            ("street cabinet", 47.2, 0.8, "wall", 0),
            ("street food stall", 46.0, 3.6, "street", 1),
            ("dumpster", 53.4, 3.9, "street", 1),
            ("garbage bag", 51.7, 4.1, 30.0),
            ("scooter", 52.4, 1.2, 110.0, 0),
            ("scooter", 53.4, 1.6, 20.0, 1),
            ("fire hydrant", 54.8, 0.5, "street"),
            ("advertising board", 49.3, 3.0, "-"),
            ("bench", 89.0, 2.0, "wall", 2),
        ],
    )
    people(
        c,
        [
            ("pedestrian adult", 3.4, 9.2, 0.0),
            ("pedestrian adult", 30.2, 10.2, 190.0),
            ("pedestrian adult", 33.0, 9.0, 170.0),
            ("pedestrian adult", 37.3, 3.2, -90.0),
            ("pedestrian adult", 34.7, 4.0, -85.0),
            ("pedestrian adult", 60.2, -2.6, 90.0),
            ("pedestrian adult", 61.4, 3.4, 95.0),
            ("pedestrian adult", 68.2, 10.3, 180.0),
            ("security guard", 70.0, 11.3, -90.0),
            ("pedestrian adult", 77.8, 8.4, 160.0),
            ("pedestrian adult", 79.0, 7.8, -90.0),
            ("pedestrian adult", 86.2, 10.6, 175.0),
            ("delivery robot", 88.4, 10.2, 180.0),
            ("pedestrian adult", 9.4, -9.4, 0.0),
            ("pedestrian adult", 23.6, -8.9, 180.0),
            ("wheelchair user", 40.6, -9.4, 180.0),
            ("pedestrian adult", 44.3, -9.2, -90.0),
            ("pedestrian adult", 45.6, -8.6, -80.0),
            ("police officer", 56.2, -9.0, 60.0),
            ("pedestrian adult", 61.2, -9.9, 0.0),
            ("delivery worker", 92.6, -10.0, 0.0),
            ("elderly person", 47.4, 12.6, 10.0),
            ("pedestrian adult", 51.8, 11.4, 180.0),
        ],
    )


def _stem(c: Canvas) -> None:
    c.along(
        WEST,
        [
            # scaffolding over the hotel's front: its feet, boards and barrels
            ("pole", 10.4, 1.0, "street", 0),
            ("pole", 13.0, 1.0, "street", 0),
            ("pole", 15.6, 1.0, "street", 0),
            ("pole", 10.4, 4.0, "street", 0),
            ("pole", 15.6, 4.0, "street", 0),
            ("ladder", 11.8, 3.9, "+", 1),
            ("barrel or bucket", 14.2, 3.8, 0.0, 1),
            ("construction worker", 12.9, 3.2, 120.0),
            ("storage box", 16.6, 3.9, "street", 2),
            ("traffic barricade", 9.2, 1.0, "-"),
            ("road work detour ahead sign", 7.2, 1.2, "-", 0),
            ("traffic cone", 9.0, 2.2, 0.0, 0),
            ("traffic cone", 17.2, 1.6, 0.0, 0),
            ("dumpster", 20.4, 0.95, "wall", 1),
            ("debris", 20.2, 3.7, 20.0, 2),
            ("street light", 4.6, 0.5, "street", 1),
            ("street light", 25.0, 0.5, "street", 1),
            ("tree", 28.0, 0.8, 10.0),
            ("advertising board", 24.6, 2.8, "+"),
            ("motorcycle", 30.6, 1.2, 60.0),
            ("motorcycle", 32.2, 1.2, 65.0),
            ("trash bin", 38.4, 0.8, "wall", 0),
            ("vending machine", 35.0, 4.0, "street"),
            ("bench", 41.4, 1.0, "wall", 0),
            ("pedestrian adult", 2.2, 1.6, "-"),
            ("pedestrian adult", 22.6, 2.3, "+"),
            ("pedestrian adult", 34.4, 2.9, "-"),
            ("police officer", 43.6, 2.6, "street"),
        ],
    )
    c.along(
        EAST,
        [
            # cable works on the east pavement
            ("traffic barricade", 20.0, 1.2, "-"),
            ("traffic barricade", 28.8, 1.2, "+"),
            ("traffic cone", 21.8, 2.5, 0.0, 0),
            ("traffic cone", 23.6, 2.6, 0.0, 0),
            ("traffic cone", 27.2, 2.5, 0.0, 0),
            ("debris", 22.4, 1.1, 10.0, 0),
            ("construction worker", 24.2, 1.2, 30.0),
            ("barrow", 25.9, 1.3, 70.0, 0),
            ("stone block", 27.6, 1.1, 20.0, 0),
            ("street cabinet", 6.4, 4.0, "street", 0),
            ("street light", 5.4, 0.5, "street", 1),
            ("street light", 31.0, 0.5, "street", 1),
            ("tree", 9.0, 0.8, 20.0),
            ("tree", 16.0, 0.8, 70.0),
            ("bench", 12.4, 1.0, "wall", 3),
            ("bicycle", 18.4, 1.2, "+"),
            ("potted plant", 33.0, 4.0, "street", 1),
            ("advertising board", 30.4, 4.0, "-"),
            ("advertising board", 40.8, 2.6, "+"),
            ("pedestrian adult", 14.0, 2.9, "-"),
            ("pedestrian adult", 31.8, 1.9, "+"),
            ("pedestrian adult", 46.0, 2.2, "-"),
            ("jogger", 38.0, 1.6, "-"),
        ],
    )
    table(c, *EAST.at(35.4, 3.9), (90.0, 270.0))
    table(c, *EAST.at(38.6, 3.8), (90.0, 270.0))
    # a manhole in the middle of the street, and vehicles waiting at it
    c.put("manhole cover", 50.9, 28.6, 0.0)
    for x, y, turn in ((49.6, 30.4, 90.0), (49.6, 26.8, -90.0), (52.0, 30.4, 90.0)):
        c.put("traffic barricade", x, y, turn)
    c.put("traffic cone", 52.2, 26.6, 0.0, 1)
    c.put("maintenance worker", 51.9, 28.4, 170.0)
    c.put("van", 51.9, 35.0, -90.0)
    c.put("taxi", 46.6, 19.4, -90.0)
    c.put("sedan", 46.4, 42.4, -90.0)
    c.put("suv", 51.6, 47.6, 90.0)
    c.put("potted plant", 45.8, 60.6, -90.0, 1)
    c.put("potted plant", 52.4, 60.6, -90.0, 1)
    c.put("bench", 49.0, 60.9, -90.0, 0)
    c.put("garbage truck", 88.0, 2.0, 180.0, 0)
    c.put("bus", 25.6, -5.3, 0.0, 0)
    c.put("taxi", 68.0, 1.9, 180.0)
    c.put("car", 76.0, -1.8, 0.0, 0)
    c.put("electric car", 6.0, -5.7, 0.0, 0)
    c.put("sedan", -2.4, 3.2, 90.0)
    c.put("van", -6.4, -1.8, -90.0)


def _ends(c: Canvas) -> None:
    far = edge((-9, -16), (-9, 16), 1)
    c.along(
        far,
        [
            ("street light", 14.0, 0.5, "street", 1),
            ("tree", 24.0, 0.8, 90.0),
            ("bench", 21.0, 1.0, "wall", 2),
            ("trash bin", 10.6, 2.6, "street", 1),
            ("pedestrian adult", 12.0, 1.9, "+"),
        ],
    )
    c.row("bollard", edge((96.4, -6), (96.4, 6), -1), (0.6, 4.2, 7.8, 11.4), 0.0)
    c.put("street clock", 98.6, 3.6, 180.0, 0)
    c.put("luggage", 100.0, -2.0, 30.0, 0)
    c.put("suitcase", 99.4, -2.6, 80.0, 0)
    people(
        c,
        [
            ("pedestrian adult", 99.2, -1.6, 170.0),
            ("pedestrian adult", 98.0, -6.2, 150.0),
            ("pedestrian adult", 99.6, 7.4, -140.0),
            ("pedestrian child", 98.9, 7.9, -140.0),
        ],
    )


def build() -> Canvas:
    c = blank(ID)
    _ground(c)
    _fronts(c)
    _site(c)
    _trench(c)
    _corner_life(c)
    _stem(c)
    _ends(c)
    c.trajectory = [
        (1.5, 9.2),
        (20.0, 8.6),
        (36.0, 9.6),
        (42.0, 12.0),
        (55.6, 12.0),
        (55.6, 9.8),
        (66.0, 10.4),
        (97.5, 9.6),
    ]
    c.trajectory += [
        (97.5, -9.6),
        (86.0, -9.0),
        (80.1, -6.2),
        (66.0, -6.2),
        (61.0, -9.2),
        (36.0, -9.2),
        (2.0, -9.5),
        (-10.4, -9.5),
    ]
    c.trajectory += [(2.0, -9.5), (36.0, -9.4), (36.0, 9.4), (41.4, 13.6), (41.6, 30.0), (41.6, 58.0), (49.0, 59.8)]
    c.trajectory += [(56.2, 58.0), (56.9, 34.0), (56.4, 14.0)]
    return c
