"""An alley of an old town with restaurants in every house; deliveries have to pass between the guests.

The alley runs 46 m east between walls of varying distance, opens into a small court with a well and a chapel on a
terrace, and continues north to a street. Guests, boards, barrels and a wrongly parked van leave 1.1-1.6 m free.
"""

from ..canvas import ground_layers as lay
from ..canvas.canvas import Canvas, edge
from ..canvas.pieces import apron, barrel, blank, people, table, tables

ID = "07_narrow_alley_outdoor_dining"
PAVEMENT_HEIGHT, TERRACE_HEIGHT = 0.12, 0.3  # m over the street's asphalt
EAST, NORTH = 46.0, 38.0  # m, lengths of the alley's two arms


def _ground(c: Canvas) -> None:
    alley = [(0, -2.2), (12, -2.2), (12, -1.9), (30, -1.9), (30, -2.8), (46, -2.8), (46, -5), (60, -5), (60, 11)]
    alley += [(54.6, 11), (54.6, 24), (55.4, 24), (55.4, 49), (49.2, 49), (49.2, 30), (50, 30), (50, 11), (46, 11)]
    alley += [(46, 2.1), (34, 2.1), (34, 3.4), (18, 3.4), (18, 2.4), (0, 2.4)]
    apron(c, "lots", alley, PAVEMENT_HEIGHT)
    c.ground("alley", "sidewalk", alley, PAVEMENT_HEIGHT)
    c.ground("terrace", "sidewalk", lay.rectangle(57.2, 4.2, 60.0, 11.0), TERRACE_HEIGHT)
    c.slope(
        "terrace_ramp",
        "sidewalk",
        lay.rectangle(57.6, 2.2, 59.4, 4.2),
        [(57.6, 2.2, PAVEMENT_HEIGHT), (59.4, 2.2, PAVEMENT_HEIGHT), (57.6, 4.2, TERRACE_HEIGHT)],
    )
    c.ground("pavement", "sidewalk", lay.rectangle(41.0, 49.0, 64.0, 52.0), PAVEMENT_HEIGHT)
    c.ground("far_pavement", "sidewalk", lay.rectangle(41.0, 58.0, 64.0, 61.0), PAVEMENT_HEIGHT)
    c.ground("far_lot", "sidewalk", lay.rectangle(41.0, 61.0, 64.0, 64.0), PAVEMENT_HEIGHT)
    c.ground("west_lot", "sidewalk", lay.rectangle(38.0, 49.0, 41.0, 61.0), PAVEMENT_HEIGHT)
    c.ground("east_lot", "sidewalk", lay.rectangle(64.0, 49.0, 67.0, 61.0), PAVEMENT_HEIGHT)
    c.ground("street", "road", lay.rectangle(41.0, 52.0, 64.0, 58.0))
    c.ground("crossing", "crosswalk", lay.rectangle(50.3, 52.0, 54.3, 58.0))
    c.ramp("ramp_near", (52.3, 52.0), -90.0, parted=False)
    c.ramp("ramp_far", (52.3, 58.0), 90.0)
    c.dashes("middle_west", (41.5, 55.0), (49.0, 55.0))
    c.dashes("middle_east", (55.5, 55.0), (63.5, 55.0))
    c.wear("sidewalk", "sidewalk/setts_small")
    c.wear("road", "road/asphalt_old")
    c.wear("crosswalk", "zebra_worn")
    c.wear("road_marking", "paint_white")
    c.sky("summer_afternoon-few_cumulus")


def _walls(c: Canvas) -> None:
    north, south = edge((0, 0), (EAST, 0), 1), edge((0, 0), (EAST, 0), -1)
    west, east = edge((52.3, 11), (52.3, 49), 1), edge((52.3, 11), (52.3, 49), -1)
    c.houses(north, ("restaurant", "bistro"), 0, 18, 2.4)
    c.houses(north, ("pizzeria", "pastry shop"), 18, 34, 3.4)
    c.houses(north, ("apartment building",), 34, 46, 2.1)
    c.houses(south, ("tattoo shop", "bubble tea bar"), 0, 12, 2.2)
    c.houses(south, ("bar", "pub"), 12, 30, 1.9)
    c.houses(south, ("cafe", "cheese shop"), 30, 46, 2.8)
    c.houses(edge((46, -5), (60, -5), -1), ("flower shop", "bakery"), 0, 14, 0)
    c.houses(edge((60, -5), (60, 11), -1), ("cafe", "chapel"), 0, 16, 0)
    c.houses(west, ("seafood shop", "bar"), 0, 19, 2.3)
    c.houses(west, ("apartment building", "greengrocer"), 19, 38, 3.1)
    c.houses(east, ("watch shop", "ice cream shop"), 0, 13, 2.3)
    c.houses(east, ("restaurant", "laundry", "tobacco shop"), 13, 38, 3.1)
    c.put("gatehouse", -3.55, 0.1, 0.0, size=(7.0, 9.0, 9.5))
    c.houses(edge((41, 61), (64, 61), 1), ("hotel", "bank"), 0, 23, 0)
    c.houses(edge((41, 49), (41, 61), 1), ("apartment building",), 0, 12, 0)
    c.houses(edge((64, 49), (64, 61), -1), ("house",), 0, 12, 0)


def _first_arm(c: Canvas) -> None:
    north, south = edge((0, 0), (EAST, 0), 1), edge((0, 0), (EAST, 0), -1)
    # the restaurant and the bistro at the gate
    tables(c, north, [(2.7, 1.6), (5.5, 1.65), (8.3, 1.55)])
    tables(c, north, [(12.2, 1.65), (15.2, 1.6)], (10.0, 170.0))
    for s in (2.6, 5.7, 8.8):
        c.put("awning", *north.at(s, 1.62), -90.0, 0, above=2.45)
    c.along(
        north,
        [
            ("potted plant", 0.8, 2.0, "street", 1),
            ("potted plant", 10.4, 2.0, "street", 0),
            ("advertising board", 10.3, 1.0, "-"),
            ("bench", 17.25, 2.05, "street", 2),
            ("potted plant", 13.9, 2.1, "street", 1),
            # the pizzeria's deck: plants between the guests and the alley
            ("plant pot", 18.7, 0.75, 0.0, 0),
            ("potted plant", 24.1, 0.7, 0.0, 0),
            ("plant pot", 28.9, 0.75, 0.0, 0),
            ("potted plant", 33.6, 0.7, 0.0, 0),
            ("sunshade", 21.4, 2.25, 0.0, 0),
            ("sunshade", 27.2, 2.25, 0.0, 0),
            ("blackboard", 34.5, 1.55, "+", 2),
            ("potted plant", 36.2, 1.75, "street", 1),
            ("bicycle", 38.6, 1.7, "+"),
            ("bicycle", 40.6, 1.68, "-"),
            ("trash bin", 43.0, 1.75, "street", 1),
            ("garbage bag", 43.8, 1.7, 30.0),
            ("garbage bag", 44.5, 1.65, 100.0),
            ("air conditioner", 42.0, 1.95, "street", 1),
        ],
    )
    tables(c, north, [(19.9, 2.85), (23.0, 2.85), (25.8, 2.8), (29.0, 2.85), (32.0, 2.8)])
    tables(c, north, [(21.4, 1.3), (26.4, 1.3), (31.2, 1.35)], (5.0, 185.0))
    for s in (20.5, 24.5, 28.5, 32.2):
        c.put("awning", *north.at(s, 2.62), -90.0, 0, above=2.5)
    c.along(
        south,
        [
            ("motorcycle", 2.4, 1.72, "+"),
            ("advertising board", 4.8, 1.85, "+"),
            ("storage box", 6.2, 1.85, 10.0, 0),
            ("scooter", 7.9, 1.45, 60.0, 1),
            ("potted plant", 9.3, 1.85, "street", 1),
            ("storage box", 12.6, 1.5, 0.0, 0),
            ("bench", 16.4, 1.6, "street", 2),
            ("blackboard", 18.2, 1.55, "-", 2),
            ("bench", 22.4, 1.6, "street", 2),
            ("advertising board", 26.9, 1.5, "+"),
            ("storage box", 28.2, 1.45, 20.0, 2),
            ("storage box", 29.2, 1.6, 80.0, 1),
            ("potted plant", 30.7, 2.4, "street", 1),
            ("sunshade", 35.0, 2.2, 0.0, 0),
            ("potted plant", 39.1, 2.4, "street", 1),
            ("counter", 41.9, 2.3, "street", 0),
            ("storage box", 44.0, 2.35, 90.0, 2),
            ("barrel or bucket", 45.2, 2.35, 0.0, 0),
            ("advertising board", 40.4, 1.6, "-"),
        ],
    )
    for s, turns in ((14.2, (0.0, 180.0)), (20.3, (20.0, 200.0)), (24.9, (0.0, 180.0))):
        barrel(c, *south.at(s, 1.5), turns)
    tables(c, south, [(33.0, 2.1), (37.0, 2.15)])
    tables(c, south, [(35.2, 0.9)], (50.0, 230.0))
    c.put("handcart", 5.5, -0.9, 8.0, 0)
    c.put("advertising board", 44.6, -1.2, 100.0)
    people(
        c,
        [
            ("pedestrian adult", 3.2, 0.75, 175.0),
            ("pedestrian adult", 7.0, -0.25, 10.0),
            ("pedestrian adult", 10.6, -1.6, -90.0),
            ("pedestrian child", 11.2, -1.5, -80.0),
            ("pedestrian adult", 15.4, -0.75, 250.0),
            ("pedestrian adult", 28.8, 1.75, 40.0),
            ("pedestrian adult", 29.9, -1.0, 95.0),
            ("pedestrian adult", 37.4, 0.8, 0.0),
            ("elderly person", 40.1, -0.3, 180.0),
            ("delivery robot", 43.0, 0.2, 180.0),
            ("cat", 17.9, -1.0, 30.0),
            ("cat", 35.3, 1.7, -60.0),
            ("delivery worker", 32.9, 0.05, 5.0),
            ("pedestrian adult", 16.9, 0.75, 90.0),
            ("pedestrian adult", 22.4, -0.85, 80.0),
            ("pedestrian adult", 13.4, -0.1, -100.0),
        ],
    )


def _court(c: Canvas) -> None:
    c.put("water well", 53.2, 3.2, 20.0, 0)
    c.put("tree", 48.6, 7.4, 40.0, size=(5.3, 5.5, 6.6))
    c.put("bench", 48.6, 5.7, -90.0, 0)
    c.put("bench", 50.3, 7.6, 0.0, 1)
    c.put("lamppost", 56.3, 9.2, 0.0, 0)
    c.put("lamppost", 47.2, -1.6, 0.0, 0)
    c.put("lamppost", 56.4, -4.2, 0.0, 0)
    c.put("street food stall", 57.9, -1.6, 180.0, 1)
    c.put("bulletin board", 46.3, 8.6, 0.0, 0)
    c.put("bicycle parking", 46.5, 4.2, 0.0, 0)
    c.put("bicycle", 47.6, 3.7, 8.0)
    c.put("trash bin", 55.9, 10.4, -90.0, 0)
    c.put("newspaper stand", 54.0, 10.5, -90.0, 0)
    table(c, 48.4, -3.7, (0.0, 180.0))
    table(c, 51.3, -3.6, (80.0, 260.0))
    table(c, 54.0, -3.7, (0.0, 180.0))
    table(c, 52.5, -1.2, (30.0, 210.0))
    c.put("sunshade", 49.9, -3.7, 0.0)
    c.put("flower", 46.8, -4.4, 0.0, 0)
    c.put("flower", 55.6, -4.5, 50.0, 1)
    c.put("potted plant", 47.4, 10.4, 0.0, 1)
    # the terrace before the chapel
    c.put("bench", 59.5, 5.4, 180.0, 0)
    c.put("potted plant", 57.6, 10.5, 0.0, 1)
    c.put("potted plant", 57.6, 4.7, 0.0, 0)
    c.put("plant pot", 57.6, 7.6, 0.0, 0)
    c.put("pedestrian adult", 58.6, 6.9, 200.0)
    c.put("sculpture", 58.9, 9.6, 180.0, 0)
    # two musicians and a listener
    people(
        c,
        [
            ("pedestrian adult", 55.6, 5.6, 200.0),
            ("pedestrian adult", 55.9, 7.0, 215.0),
            ("pedestrian adult", 52.2, 6.0, 10.0),
            ("pedestrian child", 53.2, 5.6, 20.0),
            ("pedestrian adult", 52.9, 7.6, -15.0),
            ("elderly person", 51.4, 9.9, -50.0),
            ("pedestrian adult", 55.7, -1.6, 0.0),
            ("pedestrian adult", 55.9, -0.4, -35.0),
            ("dog", 49.7, 1.4, 150.0),
            ("pedestrian adult", 50.6, 1.0, 170.0),
            ("bird", 56.2, 1.4, 60.0),
            ("bird", 55.4, 2.1, 130.0),
            ("bird", 56.9, 1.9, 220.0),
        ],
    )
    c.put("drum", 54.5, 6.9, 200.0, 0)
    c.put("stereo sound system", 56.2, 4.6, 190.0, 0)
    c.put("picnic basket", 54.6, 4.9, 0.0)


def _second_arm(c: Canvas) -> None:
    west, east = edge((52.3, 11), (52.3, 49), 1), edge((52.3, 11), (52.3, 49), -1)
    c.along(
        west,
        [
            ("counter", 2.6, 1.85, "street", 0),
            ("storage box", 4.6, 1.95, 20.0, 0),
            ("storage box", 5.4, 1.9, 70.0, 2),
            ("barrel or bucket", 6.6, 1.9, 0.0, 1),
            ("advertising board", 8.2, 1.7, "-"),
            ("bench", 15.9, 1.95, "street", 2),
            ("potted plant", 18.3, 1.9, "street", 1),
            ("van", 22.6, 1.86, "+"),
            ("handcart", 26.9, 1.9, 80.0, 1),
            ("parcels", 28.0, 2.6, 10.0),
            ("parcels", 28.6, 2.1, 50.0),
            ("street cabinet", 30.0, 2.8, "street", 0),
            ("storage box", 32.0, 2.4, "street", 2),
            ("storage box", 33.1, 2.4, 85.0, 2),
            ("storage box", 34.2, 2.35, "street", 2),
            ("storage box", 35.6, 2.5, 15.0, 1),
            ("trash bin", 36.9, 2.6, "street", 2),
        ],
    )
    barrel(c, *west.at(10.6, 1.6), (90.0, 270.0))
    barrel(c, *west.at(13.4, 1.55), (80.0, 260.0))
    tables(c, east, [(2.4, 1.65), (5.2, 1.6)])
    tables(c, east, [(15.0, 2.3), (17.9, 2.35), (20.8, 2.3), (24.0, 2.35)], (0.0, 180.0))
    c.along(
        east,
        [
            ("potted plant", 0.6, 1.95, "street", 1),
            ("advertising board", 7.1, 1.5, "+"),
            ("chair", 8.6, 1.9, "street"),
            ("bench", 10.6, 1.95, "street", 2),
            ("potted plant", 12.5, 1.85, "street", 0),
            ("sunshade", 16.4, 2.2, 0.0, 0),
            ("sunshade", 22.4, 2.2, 0.0, 0),
            ("plant pot", 13.6, 1.7, 0.0, 0),
            ("potted plant", 25.7, 2.4, "street", 1),
            ("blackboard", 26.2, 1.4, "+", 2),
            ("scooter", 28.2, 2.4, 30.0, 0),
            ("scooter", 29.6, 2.2, 110.0, 1),
            ("washing machine", 31.4, 2.6, "street", 0),
            ("garbage bag", 32.5, 2.5, 20.0),
            ("garbage bag", 33.3, 2.4, 130.0),
            ("trash bin", 34.3, 2.65, "street", 0),
            ("bicycle", 36.2, 2.3, "+"),
        ],
    )
    for s in (3.8, 10.8):
        c.put("awning", *west.at(s, 1.52), 0.0, 0, above=2.45)
    for s in (16.4, 21.0):
        c.put("awning", *east.at(s, 2.32), 180.0, 0, above=2.5)
    people(
        c,
        [
            ("pedestrian adult", 51.6, 18.6, 80.0),
            ("pedestrian adult", 53.0, 22.3, -95.0),
            ("pedestrian adult", 51.4, 30.0, 200.0),
            ("delivery worker", 51.4, 39.4, 150.0),
            ("pedestrian adult", 53.9, 42.4, 100.0),
            ("pedestrian child", 53.2, 42.7, 95.0),
            ("jogger", 52.4, 46.6, -90.0),
            ("motorcycle", 50.9, 45.4, 60.0),
        ],
    )


def _street(c: Canvas) -> None:
    near = edge((41, 52), (64, 52), -1)
    far = edge((41, 58), (64, 58), 1)
    c.along(
        near,
        [
            ("street light", 3.0, 0.45, "street"),
            ("no parking sign", 6.6, 0.4, "-"),
            ("bollard", 8.6, 0.35, "street"),
            ("bollard", 14.0, 0.35, "street"),
            ("trash bin", 15.2, 0.6, "wall", 0),
            ("bicycle parking", 18.0, 1.0, "street", 0),
            ("bicycle", 19.6, 1.1, "street"),
            ("fire hydrant", 21.6, 0.5, "street"),
            ("pedestrian adult", 5.0, 1.6, "+"),
            ("pedestrian adult", 12.2, 1.9, "street"),
            ("sedan", 4.2, -1.25, "+", 0),
            ("traffic light", 8.4, 0.6, "-"),
        ],
    )
    c.along(
        far,
        [
            ("street light", 19.5, 0.45, "street"),
            ("postbox", 7.0, 0.6, "wall", 0),
            ("bench", 4.2, 2.5, "street", 0),
            ("potted plant", 8.9, 2.6, "street", 1),
            ("pedestrian adult", 17.0, 1.7, "-"),
            ("taxi", 18.9, -1.25, "-"),
            ("advertising board", 14.6, 2.3, "+"),
        ],
    )


def build() -> Canvas:
    c = blank(ID)
    _ground(c)
    _walls(c)
    _first_arm(c)
    _court(c)
    _second_arm(c)
    _street(c)
    c.trajectory = [
        (1.5, -0.4),
        (17.0, -0.3),
        (33.0, -0.5),
        (46.0, 0.2),
        (51.6, 4.6),
        (52.4, 12.0),
        (52.4, 30.0),
        (52.3, 48.0),
    ]
    c.trajectory += [(52.3, 50.5), (52.3, 60.0)]
    return c
