"""An old lane with a pavement on one side; on the other side the doors open directly onto the road.

Chairs and plants stand at the doors, motorcycles at the walls, and washing machines are being delivered. In the middle
a chapel faces a small square, which is reached by the only crossing; after it the lane turns to the right.
"""

from ..canvas.canvas import Canvas, Edge, edge, edges
from ..canvas.ground_layers import Corner, rectangle, strip

ID = "02_residential_street_single_sidewalk_door_to_street_buildings"

KERB = 0.18
HALF, WALK = 2.2, 3.2
MIDDLE: list[Corner] = [(0.0, 0.0), (48.0, 0.0), (84.0, -9.646)]
SQUARE = (20.0, -12.2, 35.0, -2.2)

#: Along the walls of the pavement: label, s, facing, variant.
WALL = (
    ("bicycle", 2.0, "+", 0),
    ("potted plant", 4.2, "street", 0),
    ("chair", 5.4, "street", 0),
    ("chair", 6.2, 250.0, 2),
    ("table", 7.2, "street", 1),
    ("plant pot", 9.6, "street", 0),
    ("trash bin", 11.4, "street", 3),
    ("garbage bag", 12.2, 40.0, 0),
    ("storage box", 14.6, "street", 0),
    ("storage box", 15.4, "street", 1),
    ("parcels", 16.1, 20.0, 0),
    ("potted plant", 18.6, "street", 3),
    ("bench", 20.8, "street", 3),
    ("potted plant", 22.6, "street", 3),
    ("mailbox", 30.2, "street", 0),
    ("plant pot", 31.4, "street", 2),
    ("advertising board", 33.2, 300.0, 0),
    ("barrel or bucket", 35.2, "street", 0),
    ("barrel or bucket", 36.0, "street", 1),
    ("chair", 37.4, "street", 1),
    ("stool", 38.2, "street", 0),
    ("broom", 39.1, "street", 0),
    ("plant pot", 40.6, "street", 1),
    ("bicycle", 43.2, "-", 1),
    ("street cabinet", 45.6, "street", 0),
)

WALL_FAR = (
    ("plant pot", 1.8, "street", 0),
    ("garbage bag", 4.6, 10.0, 0),
    ("garbage bag", 5.2, 70.0, 3),
    ("trash bin", 6.1, "street", 2),
    ("refrigerator", 9.2, "street", 2),
    ("washing machine", 10.2, "street", 0),
    ("storage box", 11.2, 15.0, 2),
    ("potted plant", 13.6, "street", 0),
    ("chair", 15.0, "street", 3),
    ("easel", 17.2, 285.0, 2),
    ("stool", 18.4, "street", 1),
    ("plant pot", 20.6, "street", 3),
    ("tricycle", 22.9, "+", 0),
    ("skateboard", 24.0, "+", 0),
    ("trash bin", 26.4, "street", 3),
    ("garbage bag", 27.2, 0.0, 0),
    ("bicycle", 30.0, "+", 2),
    ("ladder", 32.6, "street", 0),
    ("barrel or bucket", 33.6, "street", 2),
    ("shovel", 34.4, "street", 0),
)

#: Along the kerb of the pavement.
KERBSIDE = (
    ("guard stone", 1.0, 0.0, 1),
    ("guard stone", 3.0, 0.0, 1),
    ("guard stone", 5.0, 0.0, 1),
    ("guard stone", 7.0, 0.0, 1),
    ("guard stone", 9.0, 0.0, 1),
    ("parking meter", 13.0, "wall", 0),
    ("garbage bag", 17.0, 30.0, 0),
    ("fire hydrant", 23.4, "wall", 0),
    ("no parking sign", 31.2, "-", 2),
    ("guard stone", 33.0, 0.0, 3),
    ("guard stone", 34.6, 0.0, 3),
    ("postbox", 39.6, "wall", 1),
    ("guard stone", 44.0, 0.0, 1),
    ("guard stone", 46.0, 0.0, 1),
)

KERBSIDE_FAR = (
    ("guard stone", 1.6, 0.0, 1),
    ("guard stone", 3.6, 0.0, 1),
    ("no parking sign", 8.2, "-", 0),
    ("parking meter", 12.0, "wall", 1),
    ("garbage bag", 16.0, 50.0, 0),
    ("speed limit sign 20 km", 21.8, "-", 0),
    ("guard stone", 25.0, 0.0, 3),
    ("guard stone", 28.6, 0.0, 3),
    ("guard stone", 31.2, 0.0, 3),
)

#: Obstacles on the pavement: label, s, d from the kerb, facing, variant.
PEOPLE = (
    ("elderly person", 3.3, 2.65, "street", 1),
    ("pedestrian adult", 10.9, 0.7, "+", 0),
    ("pedestrian child", 9.7, 0.75, "+", 1),
    ("cat", 13.4, 2.6, 60.0, 1),
    ("pedestrian adult", 25.2, 2.3, -60.0, 2),
    ("pedestrian adult", 25.9, 1.7, 150.0, 4),
    ("dog", 39.0, 1.0, "+", 3),
    ("pedestrian adult", 36.0, 0.7, "+", 3),
    ("delivery worker", 42.0, 0.7, "-", 1),
)

PEOPLE_FAR = (
    ("maintenance worker", 9.5, 0.8, 200.0, 1),
    ("pedestrian adult", 14.0, 0.75, "-", 5),
    ("pedestrian adult", 19.6, 2.4, 190.0, 2),
    ("pedestrian child", 24.8, 2.5, 20.0, 3),
    ("bird", 29.0, 0.8, 40.0, 0),
    ("pedestrian adult", 35.4, 1.0, "-", 1),
)

#: On the road, along the walls whose doors open onto it.
DOORS = (
    ("stone block", 1.8, "street", 0),
    ("potted plant", 2.8, "street", 0),
    ("motorcycle", 5.6, "+", 0),
    ("plant pot", 7.6, "street", 2),
    ("stone block", 9.2, "street", 1),
    ("chair", 10.4, "street", 2),
    ("chair", 11.3, "street", 0),
    ("trash bin", 12.6, "street", 2),
    ("motorcycle", 15.0, "+", 1),
    ("motorcycle", 17.4, "+", 2),
    ("potted plant", 37.4, "street", 3),
    ("stone block", 38.6, "street", 0),
    ("bicycle", 40.6, "+", 2),
    ("plant pot", 42.2, "street", 0),
    ("garbage bag", 44.0, 10.0, 2),
    ("trash bin", 45.0, "street", 3),
)

DOORS_FAR = (
    ("stone block", 3.0, "street", 1),
    ("plant pot", 4.4, "street", 1),
    ("motorcycle", 7.0, "+", 3),
    ("chair", 9.4, "street", 3),
    ("potted plant", 10.6, "street", 1),
    ("stone block", 17.4, "street", 0),
    ("plant pot", 18.4, "street", 2),
    ("bicycle", 20.4, "+", 0),
    ("trash bin", 22.4, "street", 2),
    ("garbage bag", 23.2, 30.0, 3),
    ("motorcycle", 27.6, "+", 1),
    ("potted plant", 30.0, "street", 3),
    ("stone block", 31.2, "street", 1),
)

#: In the square: label, x, y, degrees, variant.
ON_SQUARE = (
    ("fountain", 26.2, -7.6, -90.0, 1),
    ("tree", 22.6, -9.2, 40.0, 0),
    ("tree", 32.4, -9.0, 150.0, 0),
    ("bench", 22.9, -6.0, 20.0, 0),
    ("bench", 31.6, -6.3, 165.0, 2),
    ("elderly person", 30.4, -5.6, 0.0, 1),
    ("table", 33.6, -4.4, 0.0, 1),
    ("chair", 33.0, -4.9, 50.0, 0),
    ("chair", 34.1, -3.8, 230.0, 1),
    ("lamppost", 21.0, -3.4, 0.0, 1),
    ("lamppost", 34.2, -10.6, 0.0, 1),
    ("guard stone", 21.4, -2.55, 0.0, 1),
    ("guard stone", 22.9, -2.55, 0.0, 1),
    ("guard stone", 24.4, -2.55, 0.0, 1),
    ("guard stone", 31.2, -2.55, 0.0, 1),
    ("guard stone", 32.7, -2.55, 0.0, 1),
    ("bird", 26.4, -4.8, 30.0, 0),
    ("bird", 27.3, -4.4, 140.0, 0),
    ("bird", 25.4, -5.2, 250.0, 1),
    ("pedestrian child", 24.4, -5.4, -30.0, 2),
    ("football", 24.9, -4.1, 0.0, 0),
    ("potted plant", 24.0, -11.7, 90.0, 1),
    ("potted plant", 31.0, -11.7, 90.0, 1),
    ("trash bin", 20.5, -5.2, 0.0, 2),
    ("bulletin board", 20.5, -7.4, 0.0, 0),
    ("bicycle", 34.5, -7.6, 92.0, 1),
    ("stroller", 30.2, -8.6, -100.0, 0),
    ("pedestrian adult", 30.2, -9.7, 85.0, 0),
)

#: Cars, by s along the left kerb of the lane and metres from it.
CARS = (
    ("hatchback car", 33.1, 3.1, "+", 1),
    ("cyclist", 8.6, 1.4, "-", 1),
    ("manhole cover", 16.0, 2.2, 0.0, 0),
)

CARS_FAR = (
    ("tricycle", 14.2, 3.4, "+", 1),
    ("van", 25.6, 1.35, "+", 1),
    ("manhole cover", 5.0, 2.2, 0.0, 0),
)


def build() -> Canvas:
    lane = Canvas(ID, seed=602)
    _lay(lane)
    left, left_far = edges(MIDDLE, HALF, 1)
    right, right_far = edges(MIDDLE, HALF, -1)
    _houses(lane, left, left_far, right, right_far)
    for line, wall, kerbside, people in (
        (left, WALL, KERBSIDE, PEOPLE),
        (left_far, WALL_FAR, KERBSIDE_FAR, PEOPLE_FAR),
    ):
        lane.against(line.back(WALK), wall)
        lane.against(line, kerbside, 0.22)
        lane.along(line, people)
    lane.row("utility pole", left, (11.8, 37.6), 0.45, "+", 0)
    lane.row("utility pole", left_far, (10.4, 23.4), 0.45, "+", 0)
    lane.against(right.road(), DOORS)
    lane.against(right_far.road(), DOORS_FAR)
    lane.along(left.road(), CARS)
    lane.along(left_far.road(), CARS_FAR)
    for label, x, y, degrees, variant in ON_SQUARE:
        lane.put(label, x, y, degrees, variant)
    lane.wear("road", "road/setts_granite-worn")
    lane.wear((10.0, 4.0), "sidewalk/sandstone-worn")
    lane.sky("summer_noon-few_cumulus")
    lane.trajectory = [(-2.0, 3.0), (15.0, 3.5), (28.0, 3.9), (28.0, -3.6), (24.0, -4.6), (28.0, -3.6), (28.0, 3.9)]
    lane.trajectory += [(47.0, 3.7), left_far.at(16.0, 1.4), left_far.at(38.0, 1.4)]
    return lane


def _lay(lane: Canvas) -> None:
    lane.ground("lots", "sidewalk", strip([(-4.0, 0.0), *MIDDLE, (87.864, -10.681)], 2 * (HALF + WALK + 2.4)), KERB)
    lane.ground("lots_ends", "sidewalk", rectangle(-6.4, -4.6, -4.0, 7.6), KERB)
    beyond = edge(MIDDLE[1], MIDDLE[2], 1)
    end = [beyond.at(s, d) for s, d in ((40.0, -4.6), (43.6, -4.6), (43.6, 7.6), (40.0, 7.6))]
    lane.ground("lots_end", "sidewalk", end, KERB)
    lane.ground("square", "sidewalk", rectangle(*SQUARE), KERB)
    lane.ground("lots_square", "sidewalk", rectangle(SQUARE[0], SQUARE[1] - 2.4, SQUARE[2], SQUARE[1]), KERB)
    lane.ground("lane", "road", strip(MIDDLE, 2 * HALF))
    lane.ground("crossing", "crosswalk", rectangle(26.0, -HALF, 30.0, HALF))
    lane.ramp("pavement_ramp", (28.0, HALF), 90.0)
    lane.ramp("square_ramp", (28.0, -HALF), -90.0)


def _houses(lane: Canvas, left: Edge, left_far: Edge, right: Edge, right_far: Edge) -> None:
    lane.houses(left, ("house", "apartment building", "house", "bakery", "house", "house"), -4.0, 48.3, WALK)
    lane.houses(left_far, ("house", "tobacco shop", "house", "apartment building", "house"), 0.2, 42.0, WALK)
    lane.houses(right, ("house", "house", "greengrocer"), -4.0, 20.0, 0.0)
    lane.houses(right, ("house", "bar"), 35.0, 46.0, 0.0)
    lane.houses(right_far, ("house", "garage", "house", "house", "house"), 1.6, 40.6, 0.0)
    lane.houses(edge((20.0, -12.2), (35.0, -12.2), -1), ("house", "chapel", "house"), 0.0, 15.0, 0.0)
    lane.houses(edge((-4.0, -2.2), (-4.0, 5.2), 1), ("house",), 0.0, 7.4, 0.0)
    end = edge(MIDDLE[1], MIDDLE[2], 1)
    lane.houses(edge(end.at(41.0, 5.2), end.at(41.0, -2.2), 1), ("house",), 0.0, 7.4, 0.0)
    # closes the wedge on the inside of the turn
    lane.put("gate", *right.at(47.1, 0.5), 82.0, size=(0.4, 2.1, 2.35))
