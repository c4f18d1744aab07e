"""A supermarket and its car park: raised walkways lead between the bays to the doors, with trolleys on them.

Pavement robots may not drive on the asphalt of the car park. A walkway (2.6 m) runs down its middle, another along its
west side, with zebra crossings at the aisles and a broad pavement before the doors. A street lies in the south.
"""

from ..canvas import ground_layers as lay
from ..canvas.canvas import Canvas, edge
from ..canvas.pieces import apron, bicycles, blank, chain, people, table

ID = "v07_supermarket_car_park"
PAVEMENT_HEIGHT = 0.12
LOT_WIDTH, LOT_DEPTH = 64.0, 46.0
KERB, FAR = edge((0.0, -2.0), (LOT_WIDTH, -2.0), 1), edge((0.0, -8.4), (LOT_WIDTH, -8.4), -1)
#: y of the two aisles that cars drive on, and their width.
AISLES, AISLE = (9.0, 25.0), 6.0
WEST, MIDDLE, EAST = (0.0, 3.0), (30.6, 33.4), (61.0, 64.0)


def _ground(c: Canvas) -> None:
    box = lay.rectangle
    apron(c, "lots", box(0.0, -11.4, LOT_WIDTH, LOT_DEPTH), PAVEMENT_HEIGHT)
    c.ground("far_pavement", "sidewalk", box(0.0, -11.4, LOT_WIDTH, -8.4), PAVEMENT_HEIGHT)
    c.ground("street", "road", box(-2.4, -8.4, LOT_WIDTH + 2.4, -2.0))
    c.ground("pavement", "sidewalk", box(0.0, -2.0, LOT_WIDTH, 1.6), PAVEMENT_HEIGHT)
    c.ground("car_park", "road", box(0.0, 1.6, LOT_WIDTH, 36.0))
    c.ground("front", "sidewalk", box(0.0, 36.0, LOT_WIDTH, LOT_DEPTH), PAVEMENT_HEIGHT)
    for name, (x0, x1) in (("west", WEST), ("middle", MIDDLE), ("east", EAST)):
        c.ground(f"walk_{name}", "sidewalk", box(x0, 1.6, x1, 36.0), PAVEMENT_HEIGHT)
    c.ground("walk_across", "sidewalk", box(3.0, 16.4, 61.0, 20.0), PAVEMENT_HEIGHT)
    for k, y in enumerate(AISLES):
        for name, (x0, x1) in (("west", WEST), ("middle", MIDDLE), ("east", EAST)):
            c.ground(f"zebra_{name}_{k}", "crosswalk", box(x0, y - AISLE / 2, x1, y + AISLE / 2))
            c.ramp(f"ramp_{name}_{k}_s", ((x0 + x1) / 2, y - AISLE / 2), -90.0, flare=0.3, half_width=1.0, parted=False)
            c.ramp(f"ramp_{name}_{k}_n", ((x0 + x1) / 2, y + AISLE / 2), 90.0, flare=0.3, half_width=1.0, parted=False)
    c.ground("mouth", "road", box(44.0, -2.0, 50.0, 1.6))
    c.ground("zebra_mouth", "crosswalk", box(44.0, -1.6, 50.0, 1.4))
    c.ramp("ramp_mouth_w", (44.0, -0.1), 180.0, half_width=0.9, flare=0.6, parted=False)
    c.ramp("ramp_mouth_e", (50.0, -0.1), 0.0, half_width=0.9, flare=0.6, parted=False)
    c.ground("zebra_street", "crosswalk", box(12.0, -8.4, 16.0, -2.0))
    c.ramp("ramp_near", (14.0, -2.0), 90.0, parted=False)
    c.ramp("ramp_far", (14.0, -8.4), -90.0)
    for row, (y0, y1) in enumerate(((1.8, 5.8), (12.2, 16.2), (28.2, 33.0))):
        for k, x in enumerate((5.8, 8.6, 11.4, 14.2, 17.0, 19.8, 22.6, 25.4, 36.4, 39.2, 42.0, 52.8, 55.6, 58.4)):
            if row or not 43.0 < x < 51.0:
                c.paint(f"bay_{row}_{k}", box(x - 0.05, y0, x + 0.05, y1))
    c.dashes("centre_west", (0.0, -5.2), (11.0, -5.2))
    c.dashes("centre_east", (17.0, -5.2), (63.0, -5.2))
    c.wear("road", "road/asphalt_old-cracked")
    c.wear((20.0, 40.0), "sidewalk/flags_grey")
    c.wear("crosswalk", "zebra_worn")
    c.wear("road_marking", "paint_white")
    c.sky("spring_morning-few_cumulus")


def _fronts(c: Canvas) -> None:
    c.houses(
        edge((0.0, LOT_DEPTH), (LOT_WIDTH, LOT_DEPTH), 1),
        ("supermarket", "supermarket", "electronics store", "bakery"),
        0.0,
        LOT_WIDTH,
        0.0,
    )
    c.houses(edge((0.0, 20.0), (0.0, LOT_DEPTH), 1), ("warehouse",), 0.0, LOT_DEPTH - 20.0, 0.0)
    c.houses(edge((0.0, -2.0), (0.0, 20.0), 1), ("house", "auto repair shop"), 0.0, 22.0, 0.0)
    c.houses(
        edge((LOT_WIDTH, -2.0), (LOT_WIDTH, LOT_DEPTH), -1),
        ("apartment building",) * 2 + ("garage", "apartment building"),
        0.0,
        48.0,
        0.0,
    )
    row = ("house", "house", "apartment building", "house", "bank", "house", "house")
    c.houses(edge((0.0, -11.4), (LOT_WIDTH, -11.4), -1), row, 0.0, LOT_WIDTH, 0.0)
    c.houses(edge((-2.4, -11.4), (-2.4, -2.0), 1), ("house",), 0.0, 9.4, 0.0)
    c.houses(edge((LOT_WIDTH + 2.4, -11.4), (LOT_WIDTH + 2.4, -2.0), -1), ("house",), 0.0, 9.4, 0.0)


def _cars(c: Canvas) -> None:
    """Bays are 2.8 m wide; a car in most of them."""
    kinds = ("hatchback car", "sedan", "suv", "minivan", "hatchback car", "pickup truck")
    south = (7.2, 12.8, 15.6, 21.2, 24.0, 37.8, 40.6, 54.2, 57.0)
    for k, x in enumerate(south):
        c.put(kinds[k % 6], x, 4.2 if k % 6 in (0, 4) else 4.4, 90.0 if k % 3 else -90.0)
    for k, x in enumerate((7.2, 10.0, 18.4, 21.2, 26.8, 37.8, 40.6, 43.4, 51.4, 57.0)):
        c.put(kinds[(k + 2) % 6], x, 13.9 if (k + 2) % 6 in (0, 4) else 13.7, -90.0)
    for k, x in enumerate((10.0, 12.8, 18.4, 24.0, 26.8, 37.8, 43.4, 49.0, 51.4, 57.0)):
        c.put(kinds[(k + 4) % 6], x, 31.2, 90.0 if k % 4 else -90.0)
    c.put("van", 28.0, 25.4, 0.0)
    c.put("taxi", 20.0, 8.2, 180.0)


def _walkways(c: Canvas) -> None:
    middle = edge((MIDDLE[0], 1.6), (MIDDLE[0], 36.0), -1)
    west, east = edge((WEST[0], 1.6), (WEST[0], 36.0), -1), edge((EAST[0], 1.6), (EAST[0], 36.0), -1)
    across = edge((3.0, 16.4), (61.0, 16.4), 1)
    for line, places in ((west, (3.0, 13.6, 31.0)), (east, (2.6, 13.4, 32.0))):
        for s in places:
            c.put("street light", *line.at(s, 0.45 if line is west else 2.55), 0.0 if line is west else 180.0)
    c.along(
        middle,
        [
            ("shopping cart", 2.2, 0.5, "+", 0),
            ("bollard", 0.4, 0.4, 0.0),
            ("bollard", 0.4, 2.4, 0.0),
            ("trash bin", 12.6, 0.5, "street", 2),
            ("pedestrian adult", 8.0, 1.0, "+"),
            ("shopping cart", 9.4, 0.7, "+", 1),
            ("shopping cart", 29.6, 2.1, "+", 2),
            ("lamppost", 32.4, 0.5, 0.0, 0),
            ("grocery bag", 1.8, 2.4, 20.0, 0),
            ("pedestrian child", 22.6, 1.8, "-"),
        ],
    )
    c.along(
        west,
        [
            ("bench", 15.6, 0.5, "wall", 0),
            ("bicycle", 1.2, 0.6, "+"),
            ("trash bin", 29.4, 2.6, "street", 1),
            ("shopping cart", 30.2, 0.6, 30.0, 0),
            ("garbage bag", 31.4, 0.6, 10.0, 0),
            ("pedestrian adult", 24.0, 1.6, "-"),
            ("storage box", 32.6, 0.6, "street", 2),
        ],
    )
    c.along(
        east,
        [
            ("bicycle", 14.9, 2.6, "+"),
            ("elderly person", 6.4, 1.4, "+"),
            ("shopping cart", 16.7, 2.5, "+", 2),
            ("parcels", 29.4, 2.5, 10.0),
            ("potted plant", 31.0, 2.4, "street", 0),
            ("pedestrian adult", 22.4, 1.2, "-"),
        ],
    )
    c.along(
        across,
        [
            ("tree", 4.0, 0.5, 0.0),
            ("tree", 11.0, 0.5, 0.0),
            ("tree", 18.0, 0.5, 0.0),
            ("tree", 24.6, 0.5, 0.0),
            ("tree", 34.0, 0.5, 0.0),
            ("tree", 41.0, 0.5, 0.0),
            ("tree", 48.0, 0.5, 0.0),
            ("tree", 54.6, 0.5, 0.0),
            ("shopping cart", 8.0, 0.5, 10.0, 0),
            ("shopping cart", 44.6, 0.6, 100.0, 1),
            ("pedestrian adult", 14.6, 1.4, "+"),
            ("pedestrian adult", 37.8, 1.2, "-"),
            ("dog", 20.6, 1.7, "-"),
            ("charging station", 15.6, 0.4, "street"),
            ("charging station", 45.8, 0.4, "street"),
        ],
    )


def _doors(c: Canvas) -> None:
    """The pavement before the shops: trolleys in rows, plants and grills for sale, a sausage stall."""
    front = edge((0.0, LOT_DEPTH), (LOT_WIDTH, LOT_DEPTH), -1)
    for k in range(5):
        c.put("shopping cart", *front.at(16.2, 1.0 + 1.02 * k), 90.0, 0)
    c.along(
        front,
        [
            ("flower", 3.0, 0.8, 0.0, 0),
            ("flower", 4.2, 0.9, 0.0, 1),
            ("plant pot", 5.4, 0.8, 0.0, 0),
            ("potted plant", 6.6, 0.8, "street", 0),
            ("potted plant", 7.6, 0.9, "street", 1),
            ("barbecue grill", 10.0, 0.9, "street", 0),
            ("storage box", 12.0, 0.8, "street", 2),
            ("storage box", 13.2, 0.8, "street", 0),
            ("vending machine", 19.6, 0.7, "street"),
            ("parcel locker", 23.0, 0.6, "street", 0),
            ("atm", 28.0, 0.6, "street", 0),
            ("bulletin board", 30.4, 0.4, "street", 1),
            ("bench", 32.6, 0.8, "street", 0),
            ("trash bin", 34.0, 0.6, "street", 0),
            ("washing machine", 40.4, 0.8, "street", 0),
            ("refrigerator", 41.6, 0.8, "street", 0),
            ("parcels", 43.0, 0.7, 20.0),
            ("handcart", 44.8, 1.2, 30.0, 1),
            ("television", 47.0, 0.6, "street", 0),
            ("advertising board", 49.0, 2.0, "+"),
            ("advertising board", 26.0, 2.4, "-"),
            ("street food stall", 50.4, 7.0, 180.0, 0),
            ("picnic table", 54.6, 6.6, 20.0),
            ("sunshade", 56.4, 4.6, 0.0),
            ("stroller", 24.6, 3.4, "+"),
            ("shopping cart", 22.0, 5.6, 60.0, 2),
            ("shopping cart", 37.6, 4.0, 140.0, 1),
            ("jersey barrier", 8.0, 9.0, "street"),
            ("waste station", 3.4, 5.0, 90.0, 1),
        ],
    )
    c.row(
        "bollard", edge((0.0, 36.0), (LOT_WIDTH, 36.0), 1), (11.0, 13.0, 20.0, 22.0, 24.0, 40.0, 42.0, 44.0, 46.0), 0.4
    )
    for x in (58.6, 61.2):
        table(c, x, 44.8, (0.0, 180.0), 1)
    table(c, 59.6, 42.4, (40.0, 220.0), 1)
    bicycles(c, 12.0, 39.2, 90.0, (False, True, False, True), rack=False)
    people(
        c,
        [
            ("pedestrian adult", 9.4, 43.6, 90.0),
            ("pedestrian adult", 18.8, 42.0, 0.0),
            ("pedestrian child", 19.6, 41.4, 20.0),
            ("elderly person", 29.2, 42.2, 200.0),
            ("wheelchair user", 34.8, 40.0, 10.0),
            ("pedestrian adult", 32.2, 38.2, 80.0),
            ("security guard", 21.6, 43.8, -90.0),
            ("pedestrian adult", 47.8, 38.4, 10.0),
            ("pedestrian adult", 47.6, 40.2, 0.0),
            ("delivery worker", 44.6, 43.2, 170.0),
            ("pedestrian adult", 7.6, 40.8, 60.0),
            ("delivery robot", 38.4, 38.4, 180.0),
            ("dog", 33.6, 44.0, 60.0),
        ],
    )


def _street(c: Canvas) -> None:
    c.trees(KERB, (5.0, 22.0, 29.0, 38.0, 56.0), 0.9, "slim")
    chain(c, "fence", [(17.2, 1.3), (30.4, 1.3)], stretch=2.2)
    chain(c, "fence", [(33.6, 1.3), (41.8, 1.3)], stretch=2.2)
    chain(c, "fence", [(3.2, 1.3), (11.0, 1.3)], stretch=2.2)
    c.along(
        KERB,
        [
            ("bus shelter", 25.6, 2.2, "street"),
            ("pedestrian adult", 23.2, 1.5, "street"),
            ("trash bin", 28.0, 2.6, "street", 0),
            ("street light", 10.0, 0.5, "street"),
            ("street light", 42.4, 0.5, "street"),
            ("scooter", 35.0, 2.0, 60.0, 1),
            ("pedestrian adult", 39.6, 2.7, "-"),
            ("jogger", 53.8, 1.8, "+"),
            ("advertising board", 51.8, 2.6, "+"),
            ("bench", 58.8, 0.8, "wall", 0),
            ("bollard", 11.8, 0.4, 0.0),
            ("bollard", 16.2, 0.4, 0.0),
            ("sedan", 34.0, -1.2, "+"),
            ("bus", 25.0, -1.6, "+"),
        ],
    )
    c.along(
        FAR,
        [
            ("street light", 20.0, 0.5, "street"),
            ("street light", 50.0, 0.5, "street"),
            ("trash bin", 6.6, 2.4, "street", 0),
            ("garbage bag", 7.6, 2.3, 10.0, 0),
            ("bicycle", 24.0, 2.4, "+"),
            ("potted plant", 30.0, 2.4, "street", 1),
            ("pedestrian adult", 28.0, 1.4, "-"),
            ("mailbox", 36.0, 0.6, "wall", 0),
            ("trash bin", 44.0, 2.4, "street", 0),
            ("trash bin", 44.9, 2.4, "street", 0),
            ("elderly person", 47.4, 1.4, "+"),
            ("hatchback car", 30.0, -1.2, "-"),
            ("suv", 56.0, -1.3, "-"),
        ],
    )


def build() -> Canvas:
    c = blank(ID)
    _ground(c)
    _fronts(c)
    _cars(c)
    _walkways(c)
    _doors(c)
    _street(c)
    c.trajectory = [
        (14.0, -10.0),
        (14.0, 0.2),
        (1.6, 0.2),
        (1.6, 9.0),
        (1.6, 17.6),
        (12.0, 17.9),
        (30.0, 17.9),
        (32.2, 9.0),
    ]
    c.trajectory += [(32.0, 0.4), (32.2, 9.0), (32.0, 18.0), (32.2, 25.0), (32.0, 35.0), (28.0, 39.6), (7.0, 38.4)]
    c.trajectory += [
        (1.6, 33.0),
        (1.6, 25.0),
        (1.6, 33.0),
        (28.0, 39.6),
        (46.0, 36.9),
        (62.2, 38.0),
        (62.4, 25.0),
        (62.2, 17.6),
    ]
    c.trajectory += [(62.2, 17.6), (48.0, 18.0), (62.2, 17.6), (62.2, 9.0), (62.2, 0.4), (47.0, -0.1), (34.0, 0.0)]
    return c
