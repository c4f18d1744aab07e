"""A market alley that bends twice: shop goods stand out on both sides, people stop to look at them.

A street with a crossing lies in the west; from it the alley (5.2 m between the fronts) runs east, turns 29° to the
left and back again, and ends in a yard with a shrine and bicycles. Goods and people leave 1.3 to 2.5 m.
"""

from ..canvas import ground_layers as lay
from ..canvas.canvas import Canvas, edge, edges
from ..canvas.pieces import bicycles, blank, people, table

ID = "v01_shopping_alley_with_two_bends"
PAVEMENT_HEIGHT, HALF = 0.1, 2.6
MIDDLE = [(0.0, 0.0), (22.0, 0.0), (40.0, 10.0), (64.0, 10.0)]
L1, L2, L3 = edges(MIDDLE, HALF, 1)
R1, R2, R3 = edges(MIDDLE, HALF, -1)
NEAR, FAR = edge((-3.2, -17.0), (-3.2, 17.0), -1), edge((-9.2, -17.0), (-9.2, 17.0), 1)


def _ground(c: Canvas) -> None:
    box = lay.rectangle
    c.ground("lots", "sidewalk", lay.strip(MIDDLE, 2 * HALF + 4.8), PAVEMENT_HEIGHT)
    c.ground("yard_lots", "sidewalk", box(64.0, 0.6, 76.4, 21.4), PAVEMENT_HEIGHT)
    c.ground("near_lots", "sidewalk", box(-3.2, -19.4, 2.4, 19.4), PAVEMENT_HEIGHT)
    c.ground("far_lots", "sidewalk", box(-14.4, -19.4, -9.2, 19.4), PAVEMENT_HEIGHT)
    c.ground("street", "road", box(-9.2, -19.4, -3.2, 19.4))
    c.ground("near_pavement", "sidewalk", box(-3.2, -17.0, 0.0, 17.0), PAVEMENT_HEIGHT)
    c.ground("alley", "sidewalk", lay.strip(MIDDLE, 2 * HALF), PAVEMENT_HEIGHT)
    c.ground("yard", "sidewalk", box(64.0, 3.0, 74.0, 19.0), PAVEMENT_HEIGHT)
    c.ground("crossing", "crosswalk", box(-9.2, -2.0, -3.2, 2.0))
    c.ramp("ramp_near", (-3.2, 0.0), 0.0, parted=False)
    c.ramp("ramp_far", (-9.2, 0.0), 180.0)
    c.dashes("middle_south", (-6.2, -16.5), (-6.2, -3.0))
    c.dashes("middle_north", (-6.2, 3.0), (-6.2, 16.5))
    for left, right in ((L2.start, R2.start), (L3.start, R3.start)):
        c.cut(edge(left, right, 1).at(-3.0, 0.0), edge(right, left, 1).at(-3.0, 0.0))
    c.cut(L2.at(10.0, 3.0), R2.at(10.0, 3.0))
    c.wear((10.0, 0.0), "sidewalk/concrete_warm")
    c.wear("road", "road/asphalt_used")
    c.wear("crosswalk", "zebra_new")
    c.wear("road_marking", "paint_white")
    c.sky("summer_morning-few_cumulus")


def _fronts(c: Canvas) -> None:
    c.houses(L1, ("greengrocer", "seafood shop", "tobacco shop"), 0.0, 19.1, 0.0)
    c.houses(L2, ("clothing store", "pastry shop"), 2.2, 20.5, 0.0)
    c.houses(L3, ("toy shop", "bakery", "optical store"), 0.1, 23.4, 0.0)
    c.houses(R1, ("butcher shop", "bar", "shoe store"), 0.0, 22.6, 0.0)
    c.houses(R2, ("bookstore", "laundry"), 0.1, 18.2, 0.0)
    c.houses(R3, ("comic shop", "restaurant", "hair salon"), 2.3, 23.2, 0.0)
    c.houses(edge((64.0, 19.0), (74.0, 19.0), 1), ("apartment building",), 0.0, 10.0, 0.0)
    c.houses(edge((64.0, 3.0), (74.0, 3.0), -1), ("hotel",), 0.0, 10.0, 0.0)
    c.houses(edge((74.0, 3.0), (74.0, 19.0), -1), ("house", "house"), 0.0, 16.0, 0.0)
    c.houses(edge((0.0, 11.4), (0.0, 19.4), -1), ("pharmacy",), 0.0, 8.0, 0.0)
    c.houses(edge((0.0, -19.4), (0.0, -11.4), -1), ("cafe",), 0.0, 8.0, 0.0)
    c.houses(edge((-12.0, -17.0), (-12.0, 17.0), 1), ("bank", "office building", "hotel"), 0.0, 34.0, 0.0)
    c.houses(edge((-12.0, 17.0), (0.0, 17.0), 1), ("apartment building",), 0.0, 11.9, 2.4)
    c.houses(edge((-12.0, -17.0), (0.0, -17.0), -1), ("apartment building",), 0.0, 11.9, 2.4)


def _first_stretch(c: Canvas) -> None:
    c.against(
        L1.road(),
        [
            ("cabinet or shelf", 1.0, "street", 1),
            ("storage box", 2.6, "street", 2),
            ("storage box", 3.8, "street", 2),
            ("counter", 5.4, "street", 0),
            ("storage box", 7.2, "street", 1),
            ("barrel or bucket", 13.6, "street", 2),
            ("counter", 10.0, "street", 1),
            ("refrigerator", 12.4, "street", 1),
            ("vending machine", 14.8, "street", 0),
            ("vending machine", 16.0, "street", 0),
            ("newspaper stand", 17.4, "street", 0),
            ("potted plant", 20.2, "street", 0),
        ],
    )
    c.against(
        R1.road(),
        [
            ("advertising board", 0.8, "+"),
            ("counter", 3.2, "street", 0),
            ("trash bin", 5.6, "street", 1),
            ("stool", 9.0, "street", 0),
            ("stool", 9.6, "street", 1),
            ("bench", 12.0, "street", 2),
            ("potted plant", 13.8, "street", 0),
            ("cabinet or shelf", 15.6, "street", 0),
            ("cabinet or shelf", 17.0, "street", 1),
            ("storage box", 18.6, "street", 1),
            ("bicycle", 20.4, "+"),
        ],
    )
    c.along(
        L1,
        [
            ("storage box", 2.2, -1.0, 10.0, 0),
            ("advertising board", 9.0, -1.15, "-"),
            ("blackboard", 13.2, -1.2, "+", 2),
            ("handcart", 18.2, -1.1, "+", 0),
        ],
    )
    c.along(
        R1,
        [
            ("parcels", 4.8, -1.1, 20.0),
            ("advertising board", 11.0, -1.3, "+"),
            ("scooter", 14.2, -1.2, 20.0, 0),
        ],
    )
    people(
        c,
        [
            ("pedestrian adult", 5.2, 0.6, 90.0),
            ("elderly person", 7.0, -0.2, 175.0),
            ("pedestrian adult", 12.2, 0.2, 60.0),
            ("pedestrian adult", 16.4, -0.9, -70.0),
            ("pedestrian child", 17.2, -0.4, 200.0),
            ("dog", 20.2, 0.8, 120.0),
        ],
    )


def _second_stretch(c: Canvas) -> None:
    c.against(
        L2.road(),
        [
            ("coatrack", 3.4, "street", 2),
            ("coatrack", 4.6, "street", 2),
            ("armchair", 6.4, "street", 0),
            ("storage box", 8.2, "street", 2),
            ("storage box", 12.4, "street", 2),
            ("trash bin", 14.6, "street", 2),
            ("bench", 16.6, "street", 2),
            ("potted plant", 18.6, "street", 1),
        ],
    )
    c.against(
        R2.road(),
        [
            ("bookcase", 1.2, "street", 1),
            ("bookcase", 3.0, "street", 2),
            ("table", 5.0, "street", 0),
            ("bookcase", 6.8, "street", 0),
            ("washing machine", 10.6, "street", 0),
            ("chest of drawers", 12.2, "street", 0),
            ("bicycle", 14.6, "-"),
            ("motorcycle", 17.2, "+"),
        ],
    )
    c.along(
        L2,
        [
            ("advertising board", 10.4, -1.2, "+"),
            ("bookcase", 5.2, -1.5, "+", 0),
            ("stroller", 14.8, -1.3, "-"),
        ],
    )
    c.along(R2, [("blackboard", 8.6, -1.2, "-", 2), ("storage box", 16.0, -1.0, 30.0, 1)])
    for line, s, d, turn in (
        (L2, 2.6, -1.6, 200.0),
        (R2, 4.2, -1.2, 90.0),
        (L2, 12.0, -1.0, 80.0),
        (R2, 11.4, -1.5, 0),
    ):
        c.put("pedestrian adult", *line.at(s, d), line.degrees + turn)
    c.put("delivery worker", *L2.at(17.6, -1.9), L2.degrees + 180.0)


def _third_stretch(c: Canvas) -> None:
    c.against(
        L3.road(),
        [
            ("stuffed toy", 1.6, "street", 2),
            ("tricycle", 3.2, "+", 0),
            ("arcade game cabinet", 5.2, "street", 0),
            ("arcade game cabinet", 6.2, "street", 2),
            ("counter", 10.2, "street", 0),
            ("potted plant", 12.4, "street", 0),
            ("potted plant", 15.0, "street", 1),
            ("vending machine", 17.0, "street", 0),
            ("bench", 19.4, "street", 2),
            ("street cabinet", 22.0, "street", 1),
        ],
    )
    c.against(
        R3.road(),
        [
            ("bookcase", 3.4, "street", 2),
            ("newspaper stand", 5.2, "street", 0),
            ("air conditioner", 8.2, "street", 2),
            ("garbage bag", 18.2, "street", 1),
            ("garbage bag", 19.2, "street", 0),
            ("trash bin", 20.2, "street", 0),
            ("bicycle", 22.6, "+"),
        ],
    )
    for s in (10.4, 12.6, 15.0):
        table(c, *R3.at(s, -0.62), (0.0, 180.0), 1)
    c.along(
        L3,
        [
            ("advertising board", 8.4, -1.25, "-"),
            ("storage box", 14.0, -1.0, 15.0, 0),
            ("barrel or bucket", 20.8, -1.2, 0.0, 0),
        ],
    )
    c.along(R3, [("advertising board", 7.0, -1.2, "+"), ("potted plant", 16.6, -0.7, "street", 1)])
    people(
        c,
        [
            ("pedestrian adult", 44.4, 10.6, 90.0),
            ("pedestrian child", 45.6, 10.9, 110.0),
            ("pedestrian adult", 49.8, 10.4, 100.0),
            ("elderly person", 55.6, 9.6, 0.0),
            ("wheelchair user", 60.2, 10.6, 180.0),
        ],
    )


def _yard_and_street(c: Canvas) -> None:
    c.put("shrine", 69.6, 16.6, -90.0, 0)
    for x in (67.0, 72.4):
        c.put("guard stone", x, 15.0, -90.0, 0)
    c.put("tree", 72.2, 5.0, 40.0, size=(4.36, 4.04, 4.89))
    bicycles(c, 69.0, 4.3, 90.0, (False, True, False), rack=False)
    c.put("bench", 73.3, 11.0, 180.0, 0)
    c.put("water point", 66.0, 17.4, -90.0, 0)
    c.put("lamppost", 65.0, 4.2, 90.0, 0)
    c.put("cat", 71.0, 12.2, 30.0)
    c.put("dumpster", 65.3, 6.0, 0.0, 0)
    people(c, [("pedestrian adult", 69.6, 13.6, 90.0), ("elderly person", 67.4, 9.0, 190.0)])
    c.along(
        NEAR,
        [
            ("bollard", 14.6, 0.4, "street"),
            ("bollard", 19.4, 0.4, "street"),
            ("street light", 7.0, 0.5, "street"),
            ("postbox", 9.6, 0.6, "wall"),
            ("bicycle", 11.6, 2.4, "+"),
            ("parking meter", 24.0, 0.4, "street"),
            ("trash bin", 21.4, 0.7, "wall", 1),
            ("tree", 27.6, 0.9, 0.0),
            ("pedestrian adult", 13.2, 1.8, "+"),
            ("scooter", 22.6, 2.0, 40.0, 1),
            ("sedan", 6.0, -1.3, "+"),
            ("van", 26.6, -1.4, "+"),
        ],
    )
    c.along(
        FAR,
        [
            ("street light", 27.0, 0.5, "street"),
            ("potted plant", 8.2, 2.3, "street", 0),
            ("pedestrian adult", 20.4, 1.5, "-"),
            ("fire hydrant", 12.2, 0.5, "street"),
            ("taxi", 27.0, -1.3, "-"),
        ],
    )


def build() -> Canvas:
    c = blank(ID)
    _ground(c)
    _fronts(c)
    _first_stretch(c)
    _second_stretch(c)
    _third_stretch(c)
    _yard_and_street(c)
    c.trajectory = [(-10.6, 0.2), (-2.0, 0.2), (12.0, -0.6), (22.0, 0.1), (31.0, 4.9), (40.0, 9.6)]
    c.trajectory += [(52.0, 11.2), (62.0, 9.6), (68.0, 10.6), (69.0, 8.0)]
    return c
