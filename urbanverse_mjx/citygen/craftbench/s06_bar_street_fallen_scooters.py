"""A bar street late in the evening, with shared scooters lying on the pavements.

The scooters lie across the pavements in groups of two or three, between terraces, queues, bottles and bags. A fallen
one is a box as broad as it is long and half a metre high (see `object_sizes`): low enough to be overlooked and heavy
enough to stop a robot.
"""

from ..canvas.canvas import Canvas, Edge, edge, edges
from ..canvas.ground_layers import Corner, strip
from ..canvas.groups import laid_table
from ..canvas.object_sizes import SCOOTER_FALLEN as FALLEN
from ..canvas.object_sizes import SCOOTER_STANDING as UPRIGHT

ID = "06_bar_street_dual_sidewalks_obstructed_fallen_scooters"

KERB = 0.16
HALF, WALK = 3.0, 4.4
MIDDLE: list[Corner] = [(0.0, 0.0), (44.0, 0.0), (80.0, -6.348)]

#: Scooters: s, d from the kerb, degrees from the street's direction, variant.
SCOOTERS_LEFT = (
    (
        (3.4, 1.0, 30.0, FALLEN),
        (5.0, 1.1, 110.0, FALLEN),
        (8.6, 0.6, 0.0, UPRIGHT),
        (10.2, 0.6, 8.0, UPRIGHT),
        (12.2, 1.0, 75.0, FALLEN),
        (22.6, 1.0, 20.0, FALLEN),
        (24.0, 1.05, 140.0, FALLEN),
        (29.6, 3.55, 60.0, FALLEN),
        (33.8, 1.0, 95.0, FALLEN),
        (40.4, 0.95, 0.0, FALLEN),
        (41.8, 1.0, 50.0, FALLEN),
    ),
    (
        (3.0, 3.55, 20.0, FALLEN),
        (9.8, 0.95, 0.0, FALLEN),
        (11.0, 1.0, 80.0, FALLEN),
        (12.4, 0.6, 0.0, UPRIGHT),
        (25.0, 1.0, 45.0, FALLEN),
        (29.4, 3.55, 130.0, FALLEN),
        (32.6, 1.0, 10.0, FALLEN),
    ),
)
SCOOTERS_RIGHT = (
    (
        (2.6, 3.55, 70.0, FALLEN),
        (6.4, 1.0, 20.0, FALLEN),
        (11.6, 1.0, 160.0, FALLEN),
        (13.0, 0.6, 5.0, UPRIGHT),
        (22.2, 1.0, 85.0, FALLEN),
        (23.6, 1.0, 40.0, FALLEN),
        (25.0, 0.6, 0.0, UPRIGHT),
        (31.4, 1.0, 120.0, FALLEN),
        (37.0, 3.55, 0.0, FALLEN),
        (43.0, 1.0, 70.0, FALLEN),
    ),
    (
        (4.4, 1.0, 35.0, FALLEN),
        (5.8, 0.95, 0.0, FALLEN),
        (13.4, 3.55, 100.0, FALLEN),
        (19.0, 1.0, 60.0, FALLEN),
        (27.6, 1.0, 150.0, FALLEN),
        (29.0, 1.0, 15.0, FALLEN),
        (34.0, 0.6, 0.0, UPRIGHT),
    ),
)

#: Terraces at the walls: s, bearings of the chairs, shade's variant or None.
TABLES_LEFT = (
    (
        (2.6, (0.0, 180.0), None),
        (6.8, (0.0, 180.0), None),
        (14.0, (0.0, 180.0), None),
        (26.2, (0.0, 180.0), None),
        (37.0, (0.0,), None),
    ),
    ((6.6, (0.0, 180.0), None), (15.4, (0.0, 180.0), None), (18.0, (0.0, 180.0), None), (22.6, (180.0,), None)),
)
TABLES_RIGHT = (
    ((5.4, (0.0, 180.0), None), (9.2, (0.0, 180.0), None), (26.8, (0.0, 180.0), None), (29.4, (0.0, 180.0), None)),
    ((3.0, (0.0, 180.0), None), (9.0, (0.0, 180.0), None), (21.2, (0.0, 180.0), None), (24.0, (0.0, 180.0), None)),
)

#: Against the walls: label, s, facing, variant.
WALL_LEFT = (
    (
        ("barrel or bucket", 9.0, "street", 0),
        ("barrel or bucket", 10.0, "street", 1),
        ("ashtray", 10.8, "street", 2),
        ("advertising board", 11.8, 70.0, 0),
        ("garbage bag", 22.2, 10.0, 0),
        ("garbage bag", 22.9, 50.0, 3),
        ("trash bin", 23.8, "street", 3),
        ("atm", 31.6, "street", 0),
        ("stereo sound system", 34.0, "street", 1),
        ("potted plant", 39.2, "street", 3),
        ("potted plant", 42.6, "street", 3),
    ),
    (
        ("vending machine", 1.4, "street", 0),
        ("barrel or bucket", 9.2, "street", 0),
        ("stool", 10.1, "street", 0),
        ("stool", 10.9, "street", 1),
        ("advertising board", 13.0, 100.0, 1),
        ("storage box", 25.4, "street", 1),
        ("storage box", 26.2, "street", 1),
        ("garbage bag", 31.4, 0.0, 0),
        ("garbage bag", 32.0, 40.0, 0),
        ("photo booth", 34.6, "street", 0),
    ),
)
WALL_RIGHT = (
    (
        ("advertising board", 12.0, 80.0, 0),
        ("vending machine", 13.4, "street", 2),
        ("bicycle", 22.6, "+", 0),
        ("barrel or bucket", 24.4, "street", 1),
        ("trash bin", 31.6, "street", 0),
        ("garbage bag", 32.4, 0.0, 0),
        ("garbage bag", 33.0, 20.0, 3),
        ("garbage bag", 33.8, 60.0, 0),
        ("ashtray", 39.4, "street", 2),
        ("potted plant", 41.6, "street", 0),
    ),
    (
        ("ashtray", 6.0, "street", 2),
        ("advertising board", 6.9, 90.0, 1),
        ("barrel or bucket", 11.6, "street", 0),
        ("arcade game cabinet", 16.0, "street", 1),
        ("trash bin", 18.4, "street", 3),
        ("storage box", 27.0, "street", 2),
        ("garbage bag", 30.6, 0.0, 0),
        ("bicycle", 33.0, "-", 1),
    ),
)

#: Along the kerbs.
KERB_LEFT = (
    (
        ("trash bin", 6.8, "wall", 2),
        ("bicycle", 26.6, "+", 2),
        ("fire hydrant", 31.6, "wall", 0),
    ),
    (
        ("bollard", 1.0, 0.0, 1),
        ("trash bin", 7.4, "wall", 2),
        ("telephone booth", 16.4, "wall", 0),
        ("bollard", 35.0, 0.0, 1),
    ),
)
KERB_RIGHT = (
    (
        ("trash bin", 9.4, "wall", 2),
        ("directional sign", 34.6, "+", 1),
        ("bicycle", 40.4, "+", 1),
    ),
    (
        ("bollard", 1.4, 0.0, 1),
        ("parking meter", 10.4, "wall", 0),
        ("trash bin", 15.6, "wall", 2),
        ("no parking sign", 31.6, "-", 0),
    ),
)

#: Motorcycles on the road, rear wheel at the kerb: s, degrees from the street's direction, variant.
MOTORCYCLES_LEFT = (((36.6, 75.0, 0), (37.8, 80.0, 1)), ((13.2, 100.0, 2), (14.4, 96.0, 0)))
MOTORCYCLES_RIGHT = (((27.4, 250.0, 1), (28.6, 255.0, 0)), ((21.6, 255.0, 3), (22.9, 250.0, 1)))

#: People and litter: label, s, d, facing, variant.
CROWD_LEFT = (
    (
        ("pedestrian adult", 11.2, 2.6, 200.0, 2),
        ("pedestrian adult", 10.4, 2.3, 20.0, 4),
        ("security guard", 16.4, 3.5, "street", 0),
        ("pedestrian adult", 23.6, 2.0, "+", 0),
        ("pedestrian adult", 28.4, 1.9, 250.0, 2),
        ("pedestrian adult", 35.5, 3.7, 120.0, 2),
        ("pedestrian adult", 34.8, 3.2, -40.0, 3),
        ("bottle", 30.2, 1.4, 0.0, 0),
        ("bottle", 35.0, 0.3, 0.0, 1),
        ("discarded can", 27.6, 0.25, 30.0, 1),
        ("discarded can", 7.6, 3.75, 0.0, 2),
        ("backpack", 25.0, 3.6, 30.0, 0),
    ),
    (
        ("security guard", 2.6, 1.0, 200.0, 1),
        ("pedestrian adult", 12.6, 3.4, 30.0, 2),
        ("pedestrian adult", 26.8, 2.0, "-", 5),
        ("pedestrian adult", 28.2, 0.8, "-", 1),
        ("bottle", 8.4, 3.7, 0.0, 2),
        ("discarded can", 17.4, 0.3, 60.0, 0),
    ),
)
CROWD_RIGHT = (
    (
        ("pedestrian adult", 1.0, 1.8, "-", 1),
        ("pedestrian adult", 14.4, 2.4, "wall", 2),
        ("pedestrian adult", 23.4, 2.3, "+", 3),
        ("security guard", 35.0, 3.5, "street", 2),
        ("pedestrian adult", 36.0, 3.2, 190.0, 4),
        ("pedestrian adult", 38.7, 3.4, 60.0, 2),
        ("pedestrian adult", 39.4, 2.8, 240.0, 4),
        ("bottle", 30.6, 0.3, 0.0, 0),
        ("discarded can", 38.2, 0.4, 0.0, 2),
        ("guitar", 21.0, 3.5, 20.0, 1),
    ),
    (
        ("pedestrian adult", 11.2, 2.2, "+", 0),
        ("pedestrian adult", 16.8, 2.8, "wall", 4),
        ("pedestrian adult", 22.9, 1.2, "-", 3),
        ("elderly person", 31.2, 2.2, "-", 0),
        ("dog", 32.4, 2.2, "-", 2),
        ("discarded can", 26.0, 0.3, 10.0, 1),
        ("bottle", 12.6, 3.8, 0.0, 1),
    ),
)

#: On the road: s along the left kerb, metres from it.
ROAD = (
    (
        ("taxi", 8.4, 1.2, "-", 0),
        ("taxi", 26.4, 1.2, "-", 2),
        ("police car", 36.6, 4.7, "+", 0),
        ("police officer", 34.4, 3.2, 200.0, 0),
        ("electric scooter rider", 13.0, 3.0, "+", 0),
        ("scooter", 29.6, 3.4, 30.0, FALLEN),
        ("food truck", 5.4, 4.35, "-", 0),
        ("manhole cover", 41.0, 2.6, 0.0, 0),
    ),
    (
        ("limousine", 8.0, 4.85, "+", 1),
        ("taxi", 21.6, 1.2, "-", 1),
        ("ambulance", 28.4, 4.7, "+", 0),
        ("emergency worker", 24.2, 3.0, 160.0, 1),
        ("pedestrian adult", 16.8, 3.9, 100.0, 1),
        ("scooter", 16.4, 2.6, 110.0, FALLEN),
    ),
)


def build() -> Canvas:
    street = Canvas(ID, seed=606)
    left, right = edges(MIDDLE, HALF, 1), edges(MIDDLE, HALF, -1)
    _lay(street)
    for lines, *tables in (
        (left, SCOOTERS_LEFT, TABLES_LEFT, WALL_LEFT, KERB_LEFT, CROWD_LEFT, MOTORCYCLES_LEFT),
        (right, SCOOTERS_RIGHT, TABLES_RIGHT, WALL_RIGHT, KERB_RIGHT, CROWD_RIGHT, MOTORCYCLES_RIGHT),
    ):
        for line, scooters, laid, wall, kerb, crowd, motorcycles in zip(lines, *tables, strict=True):
            for s, d, turn, variant in scooters:
                x, y = line.at(s, d)
                street.put("scooter", x, y, line.degrees + turn, variant)
            for s, seats, shade in laid:
                x, y = line.at(s, WALK - 0.6)
                laid_table(street, x, y, line.degrees, seats, shade)
            street.against(line.back(WALK), wall)
            street.against(line, kerb, 0.25)
            street.along(line, crowd)
            street.against(line.road(), [("motorcycle", *bike) for bike in motorcycles], 0.15)
    for line, rows in zip(left, ROAD, strict=True):
        street.along(line.road(), rows)
    street.row("lamppost", left[0], (1.4, 14.6, 28.4, 39.0), 0.45, "street", 0)
    street.row("lamppost", left[1], (5.2, 18.6, 30.6), 0.45, "street", 0)
    street.row("lamppost", right[0], (4.6, 14.6, 29.9, 38.4), 0.45, "street", 0)
    street.row("lamppost", right[1], (7.6, 21.6, 32.8), 0.45, "street", 0)
    street.trees(left[1], (14.4,), 0.9, "palm")
    street.trees(right[0], (36.2,), 0.9, "palm")
    street.trees(right[1], (17.2, 26.0), 0.9, "palm")
    _houses(street, left, right)
    street.wear("road", "road/asphalt_used-stained")
    street.wear((10.0, 5.0), "sidewalk/calcada_waves")
    street.sky("summer_evening-few_cumulus")
    street.trajectory = [(1.0, 5.4), left[0].at(18.4, 2.2), right[0].at(18.4, 2.2), right[0].at(3.0, 2.2)]
    street.trajectory += [
        right[0].at(18.4, 2.2),
        right[0].at(42.0, 2.6),
        right[1].at(12.0, 2.0),
        right[1].at(34.0, 2.2),
    ]
    street.trajectory += [
        right[1].at(38.0, -2.0),
        left[1].at(34.0, 2.3),
        left[1].at(12.0, 2.0),
        left[0].at(38.0, 2.2),
        left[0].at(18.4, 2.2),
    ]
    return street


def _lay(street: Canvas) -> None:
    on = edge(MIDDLE[1], MIDDLE[2], 1)
    line = [(-6.4, 0.0), MIDDLE[1], on.at(43.0, 0.0)]
    street.ground("walks", "sidewalk", strip(line, 2 * (HALF + WALK + 2.4)), KERB)
    street.ground("road", "road", strip(MIDDLE, 2 * HALF))
    street.ground("crossing", "crosswalk", [(16.4, -HALF), (20.4, -HALF), (20.4, HALF), (16.4, HALF)])
    street.ramp("left_ramp", (18.4, HALF), 90.0)
    street.ramp("right_ramp", (18.4, -HALF), -90.0)


def _houses(street: Canvas, left: list[Edge], right: list[Edge]) -> None:
    street.houses(left[0], ("bar", "pub", "pizzeria", "bar", "hotel"), -4.0, 44.2, WALK)
    street.houses(left[1], ("tattoo shop", "bar", "pub", "fast food restaurant"), 0.1, 41.4, WALK)
    street.houses(right[0], ("restaurant", "bar", "alcohol shop", "pub", "bar"), -4.0, 42.6, WALK)
    street.houses(right[1], ("bar", "hostel", "bar"), 1.1, 40.2, WALK)
    street.houses(edge((-4.0, -7.0), (-4.0, 7.0), 1), ("hotel",), 0.0, 14.0, 0.0)
    end = edge(MIDDLE[1], MIDDLE[2], 1)
    street.houses(edge(end.at(40.6, 7.0), end.at(40.6, -7.0), 1), ("restaurant", "hair salon"), 0.0, 14.0, 0.0)
