"""A shopping street with a broad and a narrow pavement on a market morning, with many bicycles.

The broad side has trees, benches, terraces and, where the houses recede, a market; the narrow side has a wall, lamps
and deliveries.
"""

from ..canvas.canvas import Canvas, Edge, edge
from ..canvas.ground_layers import rectangle
from ..canvas.groups import laid_table, railed_bicycles

ID = "04_commercial_street_asymmetric_sidewalks_benches_bicycles"

KERB = 0.14
LENGTH, HALF, BROAD_PAVEMENT_WIDTH, NARROW_PAVEMENT_WIDTH = 84.0, 2.8, 6.8, 2.7
MARKET = (30.0, 52.0, 4.0)  # x from and to, m by which the houses recede

#: Against the fronts of the broad side.
FRONTS = (
    ("bicycle", 3.0, "+", 0),
    ("potted plant", 5.6, "street", 3),
    ("potted plant", 8.4, "street", 3),
    ("atm", 12.4, "street", 0),
    ("advertising board", 22.0, 20.0, 1),
    ("storage box", 24.4, "street", 1),
    ("storage box", 25.2, "street", 1),
    ("flower", 26.2, "street", 0),
    ("flower", 27.3, "street", 3),
    ("bicycle", 56.0, "-", 1),
    ("vending machine", 66.2, "street", 0),
    ("parcel locker", 70.0, "street", 0),
    ("potted plant", 75.6, "street", 1),
    ("potted plant", 79.4, "street", 1),
    ("bicycle", 82.4, "+", 2),
)

#: Along the kerb of the broad side.
KERBSIDE = (
    ("bench", 4.6, "wall", 0),
    ("trash bin", 6.6, "wall", 2),
    ("postbox", 11.4, "wall", 0),
    ("telephone booth", 22.0, "wall", 0),
    ("bench", 26.6, "wall", 2),
    ("bench", 42.0, "wall", 0),
    ("trash bin", 44.0, "wall", 2),
    ("information point", 48.4, "wall", 1),
    ("street cabinet", 55.2, "wall", 0),
    ("bench", 66.6, "street", 2),
    ("newspaper stand", 69.0, "wall", 1),
    ("bench", 77.4, "wall", 0),
    ("trash bin", 79.4, "wall", 2),
    ("charging station", 82.0, "wall", 0),
)

#: In the middle of the broad side: label, s, d, facing, variant.
BROAD_SIDE = (
    ("bench", 3.2, 3.1, "+", 3),
    ("plant pot", 4.8, 3.1, 0.0, 1),
    ("advertising board", 10.9, 6.3, 20.0, 0),
    ("pedestrian adult", 9.0, 3.6, "+", 0),
    ("pedestrian adult", 9.2, 4.3, "+", 3),
    ("dog", 13.0, 3.2, "-", 3),
    ("elderly person", 14.0, 3.0, "-", 0),
    ("bicycle", 21.6, 3.3, 25.0, 2),
    ("wheelchair user", 23.6, 4.6, "-", 0),
    ("pedestrian adult", 24.8, 4.4, "-", 1),
    ("delivery robot", 27.4, 3.2, "+", 0),
    ("stroller", 54.6, 3.6, "-", 0),
    ("pedestrian adult", 55.6, 3.6, "-", 5),
    ("pedestrian child", 55.2, 4.6, "-", 1),
    ("scooter", 65.6, 2.7, 70.0, 1),
    ("pedestrian adult", 65.2, 4.8, "+", 0),
    ("pedestrian adult", 68.0, 3.3, 200.0, 2),
    ("pedestrian adult", 67.2, 3.0, 20.0, 4),
    ("advertising board", 73.4, 3.0, "+", 0),
    ("guitar", 71.2, 4.3, 40.0, 0),
    ("pedestrian adult", 71.6, 5.1, "street", 2),
    ("stereo sound system", 72.6, 5.3, "street", 1),
    ("pedestrian adult", 77.0, 3.5, "+", 1),
    ("cat", 80.8, 5.8, 30.0, 1),
    ("bird", 20.4, 2.9, 100.0, 0),
    ("bird", 20.0, 5.2, 200.0, 1),
)

#: On the market: label, x, y, degrees, variant.
STALLS = (
    ("street food stall", 32.4, 11.6, -90.0, 0),
    ("street food stall", 36.0, 11.7, -90.0, 1),
    ("street food stall", 40.0, 11.7, -90.0, 2),
    ("street food stall", 49.4, 11.4, -110.0, 0),
    ("counter", 44.2, 11.9, -90.0, 0),
    ("storage box", 46.0, 12.4, 0.0, 3),
    ("storage box", 46.0, 11.3, 10.0, 1),
    ("storage box", 34.2, 12.6, 0.0, 2),
    ("storage box", 38.1, 12.7, 20.0, 0),
    ("parcels", 38.1, 11.9, 0.0, 2),
    ("garbage bag", 50.9, 9.6, 40.0, 1),
    ("garbage bag", 51.0, 8.5, 0.0, 0),
    ("trash bin", 51.4, 7.6, 180.0, 3),
    ("barrow", 42.4, 12.4, 80.0, 0),
    ("pedestrian adult", 32.2, 9.6, 90.0, 2),
    ("pedestrian adult", 35.6, 9.7, 80.0, 4),
    ("pedestrian child", 36.6, 9.6, 100.0, 2),
    ("pedestrian adult", 40.4, 9.8, 95.0, 2),
    ("elderly person", 44.0, 10.4, 90.0, 1),
    ("pedestrian adult", 48.4, 9.3, 70.0, 1),
    ("shopping cart", 43.0, 9.8, 60.0, 2),
    ("tricycle", 33.9, 6.2, 15.0, 1),
    ("sculpture", 46.6, 7.6, -90.0, 1),
    ("stone block", 45.5, 6.9, 40.0, 1),
    ("stone block", 47.7, 6.9, -40.0, 1),
    ("pedestrian adult", 37.6, 7.6, -10.0, 5),
    ("dog", 38.7, 7.2, -10.0, 2),
    ("bird", 44.0, 8.4, 20.0, 0),
    ("bird", 44.6, 8.0, 150.0, 0),
    ("bird", 43.4, 7.8, 260.0, 1),
)

#: Against the wall of the narrow side.
NARROW_WALL = (
    ("bicycle", 2.4, "+", 0),
    ("bicycle", 4.6, "-", 1),
    ("advertising board", 9.2, 90.0, 0),
    ("parcels", 11.2, "street", 0),
    ("parcels", 11.9, 20.0, 1),
    ("trash bin", 21.6, "street", 0),
    ("garbage bag", 22.5, 10.0, 0),
    ("bicycle", 26.0, "+", 2),
    ("storage box", 30.4, "street", 0),
    ("storage box", 31.2, "street", 1),
    ("plant pot", 34.6, "street", 2),
    ("bicycle", 38.2, "-", 0),
    ("bicycle", 40.3, "-", 1),
    ("fire alarm box", 44.0, "street", 2),
    ("bicycle", 48.8, "+", 1),
    ("handcart", 52.0, "+", 0),
    ("parcels", 53.2, "street", 2),
    ("parcels", 54.0, "street", 0),
    ("bicycle", 66.8, "+", 0),
    ("advertising board", 70.6, 80.0, 1),
    ("garbage bag", 74.0, 0.0, 3),
    ("garbage bag", 74.7, 30.0, 0),
    ("bicycle", 78.6, "-", 2),
    ("bicycle", 80.7, "-", 0),
    ("plant pot", 82.8, "street", 0),
)
NARROW_PEOPLE = (
    ("pedestrian adult", 8.0, 0.7, "-", 1),
    ("delivery worker", 12.9, -0.6, "+", 1),
    ("pedestrian adult", 33.0, 0.75, "+", 3),
    ("pedestrian adult", 46.2, 1.9, "street", 2),
    ("delivery worker", 51.2, -0.7, "+", 0),
    ("pedestrian adult", 68.6, 1.9, 30.0, 4),
    ("pedestrian child", 59.8, 2.3, "+", 0),
    ("pedestrian adult", 76.3, 0.7, "+", 0),
)

#: On the road: metres from the kerb of the narrow side towards the middle.
ROAD = (
    ("van", 28.4, 1.35, "+", 0),
    ("truck", 47.4, 1.5, "+", 1),
    ("cyclist", 9.4, 3.8, "-", 0),
    ("cyclist", 36.0, 4.0, "-", 1),
    ("hatchback car", 71.0, 1.2, "+", 0),
    ("electric car", 77.0, 1.15, "+", 1),
    ("manhole cover", 20.4, 2.6, 0.0, 0),
    ("manhole cover", 56.0, 3.0, 0.0, 1),
    ("electric scooter rider", 67.0, 4.2, "-", 0),
    ("taxi", 5.0, 1.3, "+", 0),
)


def build() -> Canvas:
    street = Canvas(ID, seed=604)
    _lay(street)
    broad, narrow = edge((0.0, HALF), (LENGTH, HALF), 1), edge((0.0, -HALF), (LENGTH, -HALF), -1)
    street.against(broad.back(BROAD_PAVEMENT_WIDTH), FRONTS)
    street.against(broad, KERBSIDE, 0.45)
    street.along(broad, BROAD_SIDE)
    for label, x, y, degrees, variant in STALLS:
        street.put(label, x, y, degrees, variant)
    railed_bicycles(street, broad, 8.8, 2.4, (-0.75, 0.0, 0.78))
    railed_bicycles(street, broad, 24.2, 2.4, (-0.8, 0.75))
    railed_bicycles(street, broad, 38.4, 2.4, (-0.76, -0.02, 0.8))
    railed_bicycles(street, broad, 51.8, 2.4, (0.0, 0.74))
    railed_bicycles(street, broad, 73.6, 2.0, (-0.74, 0.74))
    street.trees(broad, (2.2, 13.0, 28.8, 35.4, 45.6, 54.0, 64.6, 70.6, 80.6), 1.1, "street")
    street.row("lamppost", broad, (1.0, 31.6, 49.8, 75.6), 0.6, "street", 1)
    street.row("lamppost", narrow, (6.2, 24.4, 36.4, 44.2, 56.4, 72.6), 0.4, "street", 1)
    street.row("bollard", broad, (13.9, 20.1, 57.9, 64.0), 0.35, variant=1)
    street.row("bollard", narrow, (13.9, 20.1, 57.9, 64.1), 0.35, variant=1)
    # the terraces
    laid_table(street, 16.6, 8.4, 180.0, (0.0, 180.0), 0)
    laid_table(street, 19.6, 8.4, 30.0, (0.0, 120.0, 240.0))
    laid_table(street, 59.0, 8.2, 0.0, (0.0, 180.0))
    laid_table(street, 61.8, 8.4, 45.0, (0.0, 90.0, 180.0))
    laid_table(street, 63.9, 6.3, 180.0, (0.0, 160.0), 0)
    laid_table(street, 77.0, 8.5, 0.0, (0.0, 180.0))
    street.put("pedestrian adult", 60.4, 7.2, 100.0, 4)
    street.against(narrow.back(NARROW_PAVEMENT_WIDTH), NARROW_WALL)
    street.along(narrow, NARROW_PEOPLE)
    street.along(narrow.road(), ROAD)
    street.put("bus", -3.0, -4.0, 90.0, 1)
    street.put("bus shelter", -7.6, 6.0, 0.0, 0)
    street.put("pedestrian adult", -6.6, 3.0, 20.0, 2)
    street.put("street clock", 40.6, 5.4, 0.0, 1)
    _houses(street, broad, narrow)
    street.wear("road", "road/clinker_running-worn")
    street.wear((10.0, 6.0), "sidewalk/granite_light")
    street.wear((10.0, -4.0), "sidewalk/brick_brown_running-worn")
    street.sky("spring_noon-few_cumulus")
    street.trajectory = [(2.0, 7.0), (17.0, 6.4), (17.0, -4.2), (2.0, -4.6), (35.0, -4.2), (60.9, -4.2), (82.0, -4.0)]
    street.trajectory += [(86.5, 0.0), (82.0, 6.8), (61.0, 5.6), (44.0, 6.2), (29.0, 6.8), (17.0, 6.4)]
    return street


def _lay(street: Canvas) -> None:
    a, b, deep = MARKET
    front = HALF + BROAD_PAVEMENT_WIDTH
    street.ground("start", "sidewalk", rectangle(-10.9, -12.0, 0.0, 18.0), KERB)
    street.ground("broad", "sidewalk", rectangle(0.0, HALF, LENGTH, front + 2.4), KERB)
    street.ground("market", "sidewalk", rectangle(a, front, b, front + deep + 2.4), KERB)
    street.ground("narrow", "sidewalk", rectangle(0.0, -HALF - NARROW_PAVEMENT_WIDTH - 2.4, LENGTH, -HALF), KERB)
    street.ground(
        "end", "sidewalk", rectangle(LENGTH, -HALF - NARROW_PAVEMENT_WIDTH - 2.4, LENGTH + 7.4, front + 2.4), KERB
    )
    street.ground("road", "road", rectangle(0.0, -HALF, LENGTH, HALF))
    street.ground("cross_road", "road", rectangle(-6.0, -12.0, 0.0, 18.0))
    for number, x in enumerate((17.0, 61.0)):
        street.ground(f"crossing_{number}", "crosswalk", rectangle(x - 2.2, -HALF, x + 2.2, HALF))
        street.ramp(f"broad_ramp_{number}", (x, HALF), 90.0, 1.2)
        street.ramp(f"narrow_ramp_{number}", (x, -HALF), -90.0, 1.2, 1.4)
    street.dashes("middle", (24.0, 0.0), (56.0, 0.0))


def _houses(street: Canvas, broad: Edge, narrow: Edge) -> None:
    a, b, deep = MARKET
    street.houses(broad, ("pastry shop", "bank", "flower shop"), 0.0, a, BROAD_PAVEMENT_WIDTH)
    street.houses(broad, ("bookstore", "clothing store"), a + 0.05, b - 0.05, BROAD_PAVEMENT_WIDTH + deep)
    street.houses(broad, ("cafe", "bistro", "electronics store"), b, LENGTH + 5.0, BROAD_PAVEMENT_WIDTH)
    shops = ("hair salon", "bicycle shop", "pharmacy", "butcher shop", "optical store", "shoe store", "toy shop")
    street.houses(narrow, (*shops, "bakery", "restaurant", "bookstore"), 0.0, LENGTH + 5.0, NARROW_PAVEMENT_WIDTH)
    street.houses(edge((LENGTH + 5.0, 9.6), (LENGTH + 5.0, -5.5), 1), ("clothing store", "cafe"), 0.0, 15.1, 0.0)
    street.houses(edge((-8.5, -12.0), (-8.5, 18.0), 1), ("hotel", "restaurant", "office building"), 0.0, 30.0, 0.0)
    street.houses(edge((-8.5, 18.0), (0.0, 18.0), 1), ("cheese shop",), 0.0, 8.5, 0.0)
    street.houses(edge((-8.5, -12.0), (0.0, -12.0), -1), ("watch shop",), 0.0, 8.5, 0.0)
