"""A bent street of terraced houses on collection day, with rubbish bags outside and bollards along every kerb.

Front gardens behind hedges on the left, doors at the pavement on the right, a turning circle at the end.
"""

from ..canvas.canvas import Canvas, edge, edges
from ..canvas.ground_layers import Corner, disc, polar, rectangle, strip

ID = "01_residential_street_dual_sidewalks_dense_bollards_trash_bags"

KERB = 0.12
HALF, WALK_LEFT, WALK_RIGHT, GARDEN = 2.7, 3.3, 3.2, 1.5
#: Middle of the road: straight, then 15° to the left.
MIDDLE: list[Corner] = [(0.0, 0.0), (50.0, 0.0), (84.773, 9.317)]
CIRCLE: Corner = (88.636, 10.353)
FRONT_LEFT, FRONT_RIGHT = WALK_LEFT + GARDEN, WALK_RIGHT

BIN, BAG_SMALL, BAG_SPREAD, BAG_TALL = 1, 0, 1, 2

LEFT = (
    # the corner: a lamp, the mailbox, a heap of rubbish
    ("mailbox", 2.2, 0.55, "wall", 1),
    ("garbage bag", 3.3, 2.75, 5.0, 2),
    ("garbage bag", 4.1, 2.95, 80.0, 0),
    ("garbage bag", 3.7, 2.1, 140.0, 0),
    ("storage box", 4.9, 2.9, 10.0, 1),
    ("trash bin", 7.2, 2.85, "street", 3),
    ("trash bin", 8.0, 2.9, "street", 0),
    ("garbage bag", 8.9, 2.78, 90.0, 1),
    ("pedestrian adult", 6.4, 0.75, "-", 0),
    ("dog", 5.3, 0.8, "-", 3),
    ("bicycle", 11.6, 3.0, "+", 0),
    ("street cabinet", 18.4, 3.0, "street", 0),
    # after the crossing: furniture left after a removal
    ("mattress", 24.9, 2.3, 2.0, 1),
    ("garbage bag", 26.4, 2.85, 10.0, 1),
    ("armchair", 27.4, 2.85, -70.0, 0),
    ("television", 28.3, 2.95, -100.0, 1),
    ("storage box", 29.3, 2.9, 15.0, 2),
    ("parcels", 30.2, 2.95, -20.0, 0),
    ("lamp", 28.0, 2.2, 30.0, 1),
    ("cat", 29.6, 2.25, -60.0, 1),
    ("trash bin", 33.0, 2.85, "street", 3),
    ("garbage bag", 34.15, 2.8, 90.0, 2),
    ("garbage bag", 32.0, 2.8, 0.0, 0),
    ("elderly person", 35.6, 0.8, "+", 1),
    ("shopping cart", 36.6, 0.85, "+", 2),
    ("street cabinet", 43.2, 3.0, "street", 3),
    ("garbage bag", 44.6, 2.85, 33.0, 1),
    ("garbage bag", 45.75, 2.9, 150.0, 2),
    ("trash bin", 46.75, 2.9, "street", 0),
    ("pedestrian adult", 49.0, 0.9, 200.0, 2),
    ("pedestrian adult", 48.1, 0.8, 20.0, 3),
)

LEFT_FAR = (
    ("garbage bag", 3.4, 2.9, 70.0, 1),
    ("trash bin", 4.4, 2.9, "street", 3),
    ("garbage bag", 4.6, 2.15, 15.0, 0),
    ("stroller", 7.6, 1.15, "+", 0),
    ("pedestrian adult", 6.7, 1.1, "+", 4),
    ("bicycle", 10.4, 3.0, "-", 1),
    ("garbage bag", 13.2, 2.9, 95.0, 1),
    ("garbage bag", 14.35, 2.9, 5.0, 2),
    ("storage box", 15.15, 2.95, 60.0, 0),
    ("washing machine", 16.1, 2.95, "street", 0),
    ("trash bin", 19.4, 2.9, "street", 0),
    ("garbage bag", 20.2, 2.9, 45.0, 2),
    ("garbage bag", 19.8, 2.15, 120.0, 0),
    ("guard stone", 22.6, 2.9, "street", 0),
    ("potted plant", 24.0, 2.95, "street", 0),
    ("bird", 17.8, 1.0, 200.0, 0),
    ("bird", 18.4, 1.3, 150.0, 1),
)

RIGHT = (
    # doors at the pavement: objects of the houses along their walls
    ("plant pot", 1.6, 2.8, "street", 2),
    ("garbage bag", 4.2, 2.55, 30.0, 1),
    ("garbage bag", 5.25, 2.65, 70.0, 2),
    ("garbage bag", 4.7, 1.95, 10.0, 0),
    ("trash bin", 6.0, 2.75, "street", 3),
    ("bicycle", 8.7, 2.75, "+", 2),
    ("pedestrian adult", 11.2, 1.35, "+", 1),
    ("garbage bag", 13.4, 2.55, 0.0, 1),
    ("parcels", 14.3, 2.8, 12.0, 1),
    ("fire hydrant", 16.2, 0.5, "street", 0),
    ("plant pot", 18.2, 2.7, "street", 1),
    ("plant pot", 25.1, 2.8, "street", 2),
    ("trash bin", 26.2, 2.75, "street", 0),
    ("garbage bag", 27.1, 2.5, 25.0, 1),
    ("garbage bag", 28.15, 2.65, 95.0, 2),
    ("garbage bag", 27.6, 2.0, 0.0, 0),
    ("scooter", 31.0, 2.5, 70.0, 1),
    ("bench", 34.2, 2.7, "street", 3),
    ("elderly person", 36.9, 0.85, 80.0, 1),
    ("plant pot", 36.0, 2.8, "street", 0),
    ("trash bin", 40.2, 2.75, "street", 3),
    ("garbage bag", 41.0, 2.8, 130.0, 0),
    ("garbage bag", 41.6, 2.05, 0.0, 0),
    ("garbage bag", 42.3, 2.6, 15.0, 2),
    ("chair", 43.6, 2.75, -60.0, 1),
    ("storage box", 44.4, 2.8, 5.0, 1),
    ("cat", 38.9, 2.6, 30.0, 0),
    ("potted plant", 47.8, 2.8, "street", 0),
    ("pedestrian child", 32.4, 0.8, "-", 0),
    ("pedestrian adult", 33.3, 0.75, "-", 3),
)

RIGHT_FAR = (
    ("garbage bag", 2.2, 2.55, 12.0, 1),
    ("garbage bag", 3.25, 2.65, 66.0, 2),
    ("trash bin", 4.1, 2.75, "street", 0),
    ("tricycle", 6.6, 2.65, "+", 0),
    ("plant pot", 8.2, 2.8, "street", 2),
    ("garbage bag", 11.2, 2.55, 0.0, 1),
    ("garbage bag", 11.9, 2.2, 100.0, 0),
    ("couch", 14.0, 2.65, "street", 1),
    ("cushion", 15.3, 2.45, 40.0, 0),
    ("garbage bag", 16.3, 2.6, 35.0, 2),
    ("handcart", 18.9, 2.6, "-", 2),
    ("trash bin", 21.4, 2.75, "street", 3),
    ("garbage bag", 22.2, 2.6, 75.0, 1),
    ("garbage bag", 23.25, 2.65, 20.0, 2),
    ("maintenance worker", 16.2, -1.2, 120.0, 1),
    ("barrow", 25.6, 2.5, "+", 0),
)

#: On the road: s along the right kerb and d from it (negative: on the road).
ON_ROAD = (
    ("hatchback car", 6.2, -1.15, "+", 0),
    ("sedan", 12.0, -1.15, "+", 2),
    ("suv", 29.6, -1.2, "+", 2),
    ("hatchback car", 35.0, -1.15, "+", 1),
    ("motorcycle", 38.6, -1.15, 70.0, 0),
    ("motorcycle", 39.8, -1.15, 76.0, 1),
    ("van", 44.6, -1.25, "+", 1),
    ("manhole cover", 25.6, -2.3, 0.0, 0),
    ("cyclist", 9.4, -3.4, "-", 0),
    ("delivery worker", 40.9, -2.6, "wall", 1),
)

ON_ROAD_FAR = (
    ("garbage truck", 9.6, -1.75, "+", 2),
    ("maintenance worker", 4.0, -1.3, "+", 0),
    ("trash bin", 3.1, -0.8, "+", 3),
    ("car", 19.6, -1.1, "+", 1),
    ("electric car", 25.4, -1.15, "+", 0),
)

#: In the turning circle: label, bearing from its middle, distance (m), rotation from facing the middle, variant.
AROUND_CIRCLE = (
    ("street light", 118.0, 6.7, 180.0, 3),
    ("bench", 72.0, 8.6, 0.0, 2),
    ("trash bin", 82.0, 8.55, 0.0, 2),
    ("garbage bag", 48.0, 8.5, 20.0, 1),
    ("garbage bag", 55.0, 8.6, 100.0, 0),
    ("garbage bag", 41.5, 8.65, 60.0, 0),
    ("garbage bag", 49.0, 7.75, 0.0, 0),
    ("plant pot", 28.0, 8.6, 0.0, 1),
    ("shrub", 1.0, 8.3, 30.0, 3),
    ("trash bin", -6.0, 8.6, 0.0, 0),
    ("garbage bag", -13.0, 8.5, 70.0, 2),
    ("garbage bag", -20.5, 8.6, 15.0, 0),
    ("dumpster", -43.0, 8.3, 0.0, 1),
    ("storage box", -53.0, 8.5, 30.0, 2),
    ("garbage bag", -59.5, 8.5, 60.0, 2),
    ("garbage bag", -53.0, 7.8, 10.0, 0),
    ("bollard", -62.0, 6.35, 0.0, 0),
    ("bollard", -34.0, 6.35, 0.0, 0),
    ("bollard", -20.0, 6.35, 0.0, 0),
    ("bollard", -6.0, 6.35, 0.0, 0),
    ("bollard", 8.0, 6.35, 0.0, 0),
    ("bollard", 22.0, 6.35, 0.0, 0),
    ("bollard", 36.0, 6.35, 0.0, 0),
    ("bollard", 64.0, 6.35, 0.0, 0),
    ("bollard", 78.0, 6.35, 0.0, 0),
    ("bollard", 92.0, 6.35, 0.0, 0),
    # two children play in the middle of the circle
    ("basketball", -120.0, 1.4, 0.0, 0),
    ("pedestrian child", -150.0, 2.6, 0.0, 0),
    ("pedestrian child", 20.0, 1.6, 40.0, 3),
    ("hatchback car", 95.0, 4.4, 90.0, 3),
)


def build() -> Canvas:
    street = Canvas(ID, seed=601)
    _lay(street)
    left, left_far = edges(MIDDLE, HALF, 1)
    right, right_far = edges(MIDDLE, HALF, -1)
    # bollards every 1.5 m on both sides, except at the crossing
    street.row("bollard", left, (1.0, 2.6, 4.1, 5.6, 7.1, 8.6, 10.1, 11.6, 13.1, 14.6, 16.1, 17.6), 0.32, variant=0)
    street.row("bollard", left, (23.9, 25.4, 26.9, 28.4, 29.9, 31.4, 32.9, 34.4, 35.9, 37.4, 38.9), 0.32, variant=0)
    street.row("bollard", left, (41.9, 43.4, 44.9, 46.4, 47.9), 0.32, variant=0)
    street.row("bollard", left_far, (1.0, 2.5, 4.0, 5.5, 7.0, 8.5, 10.0, 11.5, 14.5, 16.0, 17.5, 19.0), 0.32, variant=0)
    street.row("bollard", right, (1.0, 2.5, 4.0, 5.5, 7.0, 8.5, 10.0, 11.5, 13.0, 14.5, 17.6), 0.32, variant=0)
    street.row("bollard", right, (23.8, 25.3, 26.8, 28.3, 29.8, 31.3, 32.8, 34.3, 35.8, 37.3, 38.8), 0.32, variant=0)
    street.row("bollard", right, (41.8, 43.3, 44.8, 46.3, 47.8, 49.3), 0.32, variant=0)
    street.row(
        "bollard", right_far, (1.2, 2.7, 5.7, 7.2, 8.7, 10.2, 13.2, 14.7, 16.2, 17.7, 19.2, 20.7), 0.32, variant=0
    )
    street.row("lamppost", left, (10.8, 40.4), 0.4, "street", 1)
    street.row("lamppost", left_far, (13.0,), 0.4, "street", 1)
    street.row("lamppost", right, (16.9, 40.3), 0.4, "street", 1)
    street.row("lamppost", right_far, (11.7,), 0.4, "street", 1)
    street.along(left, LEFT)
    street.along(left_far, LEFT_FAR)
    street.along(right, RIGHT)
    street.along(right_far, RIGHT_FAR)
    street.along(right, ON_ROAD)
    street.along(right_far, ON_ROAD_FAR)
    for label, bearing, reach, turn, variant in AROUND_CIRCLE:
        street.put(label, *polar(CIRCLE, bearing, reach), bearing + 180.0 + turn, variant)
    _gardens(street)
    _houses(street)
    street.sky("spring_morning-few_cumulus")
    street.wear("road", "road/asphalt_old-cracked")
    street.wear((10.0, 4.0), "sidewalk/brick_red_running")
    street.wear("ground", "grass")
    street.trajectory = [(3.0, 4.0), (20.0, 4.4), (20.0, -3.9), (42.0, -3.6), (50.6, -3.6), (72.0, 2.2), (93.0, 6.4)]
    street.trajectory += [(92.0, 15.6), (83.4, 14.4), (62.0, 7.2), (41.0, 4.6), (24.0, 4.4)]
    return street


def _lay(street: Canvas) -> None:
    # the lots first, then gardens, pavements and road on top of them
    street.ground("lots", "sidewalk", strip(MIDDLE, 2 * (HALF + FRONT_LEFT + 2.4)), KERB)
    street.ground("lots_circle", "sidewalk", disc(*CIRCLE, 11.4, 16), KERB)
    street.ground("lots_start", "sidewalk", rectangle(-12.0, -18.0, 0.0, 18.0), KERB)
    near, near_far = edges(MIDDLE, HALF + WALK_LEFT, 1)
    far, far_far = edges(MIDDLE, HALF + FRONT_LEFT + 2.4, 1)
    band = [near.at(7.5, 0.0), near_far.start, near_far.at(35.0, 0.0)]
    street.ground("gardens", "ground", [*band, far_far.at(35.9, 0.0), far_far.start, far.at(7.5, 0.0)], KERB)
    street.ground("road", "road", strip(MIDDLE, 2 * HALF))
    street.ground("circle", "road", disc(*CIRCLE, 6.0, 16))
    street.ground("cross_road", "road", rectangle(-5.5, -18.0, 0.0, 18.0))
    street.ground("crossing", "crosswalk", rectangle(18.6, -HALF, 22.6, HALF))
    street.ramp("left_ramp", (20.6, HALF), 90.0)
    street.ramp("right_ramp", (20.6, -HALF), -90.0)
    bend, on = edges(MIDDLE, 12.0, 1), edges(MIDDLE, 12.0, -1)
    street.cut(bend[1].start, on[1].start)
    street.cut(bend[1].at(18.0, 0.0), on[1].at(20.9, 0.0))


def _gardens(street: Canvas) -> None:
    hedge = (0.75, 2.28, 1.18)
    left, left_far = edges(MIDDLE, HALF + WALK_LEFT, 1)
    for s in (9.0, 11.3, 14.6, 16.9, 22.0, 24.3, 28.6, 30.9, 36.2, 38.5, 43.4, 45.7):
        street.put("shrub", *left.at(s, 0.5), left.facing("street"), size=hedge)
    for s in (4.5, 9.6, 11.9, 16.4, 18.7):
        street.put("shrub", *left_far.at(s, 0.5), left_far.facing("street"), size=hedge)
    street.along(left, (("flower", 12.9, 0.6, 0.0, 0), ("flower", 20.2, 0.6, 40.0, 3), ("flower", 33.0, 0.7, 10.0, 1)))
    street.along(left, (("gate", 26.4, 0.25, "street", 2), ("gate", 40.6, 0.25, "street", 2)))
    street.along(left_far, (("flower", 7.1, 0.6, 0.0, 1), ("flower", 14.2, 0.7, 20.0, 3), ("rock", 21.6, 0.7, 10.0, 0)))
    street.put("tree", 49.2, 7.4, 30.0, size=(2.74, 2.75, 8.39))


def _houses(street: Canvas) -> None:
    left, left_far = edges(MIDDLE, HALF, 1)
    right, right_far = edges(MIDDLE, HALF, -1)
    street.houses(left, ("house", "house", "house", "house", "house"), 7.5, 47.6, FRONT_LEFT)
    street.houses(left, ("convenience store",), 0.0, 7.4, WALK_LEFT)
    street.houses(left_far, ("house", "house", "garage", "house"), 2.6, 35.4, FRONT_LEFT)
    street.houses(right, ("bakery", "house", "house", "house", "house", "house"), 0.0, 50.3, FRONT_RIGHT)
    street.houses(right_far, ("house", "garage", "house", "house"), 0.1, 36.2, FRONT_RIGHT)
    for degrees, variant in ((105.0, 3), (60.0, 2), (15.0, 0), (-30.0, 1), (-75.0, 2)):
        depth, _, height = street.sizes["house"][variant]
        street.put("house", *polar(CIRCLE, degrees, 8.95 + depth / 2), degrees + 180.0, size=(depth, 7.35, height))
    # the far side of the cross road, and its two ends
    across = edge((-5.5, -16.0), (-5.5, 16.0), 1)
    street.houses(across, ("apartment building", "house", "house"), 0.0, 32.0, 2.5)
    street.houses(edge((-8.0, 16.0), (0.0, 16.0), 1), ("house",), 0.0, 8.0, 0.0)
    street.houses(edge((-8.0, -16.0), (0.0, -16.0), -1), ("house",), 0.0, 8.0, 0.0)
    street.put("wall", -0.2, 14.3, 180.0, size=(0.28, 3.4, 2.4))
    street.put("wall", -0.2, -14.4, 180.0, size=(0.28, 3.2, 2.4))
