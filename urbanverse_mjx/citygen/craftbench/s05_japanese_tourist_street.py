"""A lane of old shops up to a shrine in the tourist season; coaches, vans and rickshaws stand on the pavements.

Kerbs are low, poles stand on the path and vending machines at the walls, and visitors stop for the view.
"""

from ..canvas.canvas import Canvas, Edge, edge, edges
from ..canvas.ground_layers import Corner, strip
from ..canvas.groups import laid_table

ID = "05_japanese_tourist_street_dual_sidewalks_blocked_by_vehicles"

KERB = 0.06
HALF, LEFT_WALK, RIGHT_WALK = 2.6, 4.6, 4.4
#: Up the hill to the shrine: two gentle turns.
MIDDLE: list[Corner] = [(0.0, 0.0), (36.0, 0.0), (66.0, 6.4), (82.0, 6.4)]
SHRINE: Edge = edge((82.0, 14.0), (82.0, -1.2), 1)

#: Against the shops: label, s, facing, variant.
LEFT_WALL = (
    (
        ("vending machine", 1.4, "street", 0),
        ("vending machine", 2.5, "street", 1),
        ("potted plant", 4.6, "street", 0),
        ("flag", 6.4, "street", 2),
        ("bench", 9.0, "street", 1),
        ("potted plant", 11.0, "street", 3),
        ("banner", 13.4, 100.0, 1),
        ("storage box", 14.6, "street", 1),
        ("barrel or bucket", 16.2, "street", 0),
        ("barrel or bucket", 17.0, "street", 0),
        ("bicycle", 26.0, "+", 0),
        ("advertising board", 28.2, 80.0, 0),
        ("vending machine", 30.6, "street", 2),
        ("trash bin", 31.8, "street", 0),
        ("potted plant", 34.0, "street", 1),
    ),
    (
        ("flag", 2.2, "street", 2),
        ("stool", 3.6, "street", 0),
        ("stool", 4.3, "street", 1),
        ("photo booth", 7.4, "street", 0),
        ("plant pot", 9.4, "street", 2),
        ("advertising board", 12.4, 100.0, 1),
        ("bench", 15.4, "street", 1),
        ("vending machine", 18.0, "street", 0),
        ("vending machine", 19.1, "street", 2),
        ("trash bin", 20.2, "street", 2),
        ("flag", 23.0, "street", 2),
        ("potted plant", 25.6, "street", 3),
        ("arcade game cabinet", 28.0, "street", 0),
    ),
    (("potted plant", 2.4, "street", 3), ("barrel or bucket", 5.0, "street", 1), ("banner", 7.4, 80.0, 1)),
)
RIGHT_WALL = (
    (
        ("potted plant", 2.0, "street", 3),
        ("flag", 4.4, "street", 2),
        ("newspaper stand", 6.4, "street", 1),
        ("storage box", 8.0, "street", 0),
        ("storage box", 8.8, "street", 0),
        ("bicycle", 12.4, "+", 1),
        ("vending machine", 15.0, "street", 1),
        ("plant pot", 23.6, "street", 3),
        ("flag", 25.4, "street", 2),
        ("bench", 28.0, "street", 1),
        ("luggage", 29.9, "street", 0),
        ("advertising board", 32.0, 100.0, 0),
        ("potted plant", 35.0, "street", 0),
    ),
    (
        ("trash bin", 1.6, "street", 2),
        ("garbage bag", 2.4, 20.0, 0),
        ("stool", 5.2, "street", 0),
        ("stool", 6.0, "street", 1),
        ("flag", 8.2, "street", 2),
        ("vending machine", 10.4, "street", 0),
        ("plant pot", 13.4, "street", 2),
        ("bicycle", 17.0, "-", 2),
        ("advertising board", 20.0, 75.0, 1),
        ("potted plant", 22.6, "street", 3),
        ("banner", 26.2, 90.0, 1),
        ("barrel or bucket", 28.4, "street", 2),
    ),
    (("vending machine", 2.0, "street", 2), ("bench", 5.4, "street", 3), ("potted plant", 8.0, "street", 0)),
)

#: Whole vehicles on the pavements, against the kerb: label, s, facing, variant.
LEFT_PARKED = (
    (("van", 8.0, "-", 1), ("hatchback car", 29.0, "-", 1)),
    (("motorcycle", 4.2, 70.0, 0), ("motorcycle", 5.3, 75.0, 1), ("minivan", 11.6, "-", 1), ("car", 24.0, "+", 1)),
    (("rickshaw", 3.6, "-", 0),),
)
RIGHT_PARKED = (
    (("taxi", 6.2, "+", 0), ("van", 26.6, "+", 0)),
    (("car", 5.4, "+", 3), ("handcart", 12.6, "+", 1), ("hatchback car", 20.4, "+", 2)),
    (("motorcycle", 4.0, 250.0, 0), ("motorcycle", 5.1, 256.0, 0)),
)

#: Along the kerbs without parked vehicles.
LEFT_KERB = (
    (
        ("utility pole", 3.0, "+", 0),
        ("traffic cone", 4.4, 0.0, 0),
        ("traffic cone", 11.6, 0.0, 0),
        ("utility pole", 33.4, "+", 0),
        ("mailbox", 14.2, "wall", 1),
        ("traffic sign", 26.0, "-", 1),
    ),
    (
        ("utility pole", 8.6, "+", 0),
        ("postbox", 16.0, "wall", 0),
        ("scooter", 18.6, "+", 0),
        ("utility pole", 28.4, "+", 0),
    ),
    (("utility pole", 8.0, "+", 0),),
)
RIGHT_KERB = (
    (
        ("fire hydrant", 2.2, "wall", 0),
        ("no parking sign", 10.2, "-", 0),
        ("bicycle", 13.0, "+", 2),
        ("directional sign", 33.0, "+", 1),
    ),
    (
        ("guard stone", 1.6, 0.0, 1),
        ("no parking sign", 9.0, "-", 1),
        ("guard stone", 16.0, 0.0, 1),
        ("tricycle", 26.4, "+", 1),
    ),
    (("guard stone", 1.4, 0.0, 1),),
)

#: Visitors and shopkeepers: label, s, d, facing, variant.
LEFT_PEOPLE = (
    (
        ("pedestrian adult", 20.4, 3.6, "street", 0),
        ("pedestrian adult", 21.2, 3.8, "street", 2),
        ("delivery worker", 12.8, 1.2, "-", 1),
        ("parcels", 13.0, 0.5, 20.0, 3),
        ("pedestrian adult", 17.0, 1.6, 80.0, 2),
        ("camera", 17.2, 0.9, 0.0, 2),
        ("tripod", 22.4, 3.2, 0.0, 0),
        ("pedestrian adult", 23.4, 3.3, 180.0, 4),
        ("suitcase", 33.2, 1.0, 20.0, 0),
        ("pedestrian adult", 34.0, 1.1, "+", 1),
    ),
    (
        ("pedestrian child", 2.8, 1.6, "+", 1),
        ("pedestrian adult", 1.6, 1.5, "+", 5),
        ("pedestrian adult", 15.2, 2.2, "wall", 2),
        ("pedestrian adult", 20.6, 1.0, 30.0, 3),
        ("pedestrian adult", 21.4, 1.5, 210.0, 2),
        ("cat", 18.8, 2.6, 40.0, 1),
    ),
    (("pedestrian adult", 1.0, 1.4, 60.0, 2),),
)
RIGHT_PEOPLE = (
    (
        ("pedestrian adult", 11.4, 1.0, "+", 1),
        ("elderly person", 15.0, 1.4, "+", 0),
        ("pedestrian adult", 22.9, 1.5, "-", 3),
        ("pedestrian child", 22.9, 0.75, "-", 0),
        ("luggage", 30.8, 2.4, 70.0, 2),
        ("pedestrian adult", 31.6, 1.4, "+", 0),
    ),
    (
        ("pedestrian adult", 9.8, 1.0, "-", 2),
        ("pedestrian adult", 11.0, 1.9, "wall", 4),
        ("pedestrian adult", 15.4, 1.0, "+", 5),
        ("pedestrian adult", 23.4, 1.6, 100.0, 2),
        ("pedestrian child", 24.6, 1.1, 160.0, 3),
        ("dog", 14.4, 1.9, "+", 2),
    ),
    (("pedestrian adult", 7.0, 1.3, "+", 0),),
)

#: On the road: s along the left kerb, metres from it.
ROAD = (
    (("cyclist", 4.0, 3.4, "+", 1), ("bus", 30.8, 1.7, "-", 1), ("manhole cover", 11.0, 2.6, 0.0, 0)),
    (("rickshaw", 7.0, 2.0, "-", 1), ("taxi", 18.0, 3.7, "+", 1), ("motorcycle rider", 26.0, 1.6, "-", 0)),
    (("traffic barricade", 8.2, 2.2, "-", 1), ("traffic cone", 8.2, 0.8, 0.0, 1), ("traffic cone", 8.2, 3.8, 0.0, 1)),
)

#: Before the shrine: label, s along its front (from the left), metres in front of it, facing, variant.
COURT = (
    ("guard stone", 3.6, 1.4, 0.0, 0),
    ("guard stone", 11.6, 1.4, 0.0, 0),
    ("lamp", 4.6, 0.9, 0.0, 1),
    ("lamp", 10.6, 0.9, 0.0, 1),
    ("stone block", 7.6, 0.7, "street", 1),
    ("water point", 1.7, 3.0, 0.0, 2),
    ("bulletin board", 13.6, 0.5, "street", 1),
    ("pedestrian adult", 6.2, 2.6, "wall", 2),
    ("pedestrian adult", 8.4, 2.8, "wall", 4),
    ("pedestrian child", 9.1, 2.6, "wall", 2),
    ("bird", 11.6, 3.4, 30.0, 0),
    ("bird", 12.2, 3.1, 80.0, 0),
    ("bird", 5.0, 3.6, 200.0, 1),
    ("bonsai", 4.0, 0.4, 0.0, 2),
)


def build() -> Canvas:
    lane = Canvas(ID, seed=605)
    left, right = edges(MIDDLE, HALF, 1), edges(MIDDLE, HALF, -1)
    _lay(lane, left, right)
    for lines, width, wall, parked, kerb, people in (
        (left, LEFT_WALK, LEFT_WALL, LEFT_PARKED, LEFT_KERB, LEFT_PEOPLE),
        (right, RIGHT_WALK, RIGHT_WALL, RIGHT_PARKED, RIGHT_KERB, RIGHT_PEOPLE),
    ):
        for line, at_wall, on_walk, at_kerb, by_hand in zip(lines, wall, parked, kerb, people, strict=True):
            lane.against(line.back(width), at_wall)
            lane.against(line, on_walk, 0.14)
            for label, s, facing, variant in at_kerb:
                reach = 0.45 if label == "utility pole" else 0.3 + lane.sizes[label][variant][1] / 2
                lane.put(label, *line.at(s, reach), line.facing(facing), variant)
            lane.along(line, by_hand)
    for line, rows in zip(left, ROAD, strict=True):
        lane.along(line.road(), rows)
    lane.along(SHRINE.road(), COURT)
    lane.trees(left[0], (22.6,), 0.9, "blossom")
    lane.trees(right[1], (29.4,), 0.9, "blossom")
    lane.trees(SHRINE.road(), (1.6, 13.6), 1.7, "blossom")
    laid_table(lane, *left[1].at(26.9, 3.5), 12.0, (0.0, 180.0))
    laid_table(lane, *right[0].at(21.2, 3.75), 0.0, (0.0, 180.0), None)
    _houses(lane, left, right)
    lane.wear("road", "road/asphalt_used-patched")
    lane.wear((12.0, 4.0), "sidewalk/granite_courses")
    lane.wear("ground", "gravel")
    lane.sky("spring_noon-few_cumulus")
    lane.trajectory = [(2.0, 5.4), left[0].at(18.6, 3.0), right[0].at(18.6, 2.2), right[0].at(3.0, 2.8)]
    lane.trajectory += [
        right[0].at(18.6, 2.2),
        right[0].at(34.0, 2.0),
        right[1].at(16.0, 2.4),
        right[2].at(9.0, 2.2),
        (80.0, 4.6),
    ]
    lane.trajectory += [left[2].at(8.0, 2.4), left[1].at(20.0, 2.6), left[1].at(1.0, 2.8), left[0].at(18.6, 2.6)]
    return lane


def _lay(lane: Canvas, left: list[Edge], right: list[Edge]) -> None:
    lane.ground("shrine_court", "sidewalk", [(75.0, 13.0), (75.0, -0.2), (84.4, -0.2), (84.4, 13.0)], KERB)
    lane.ground(
        "walks", "sidewalk", strip([(-6.4, 0.0), *MIDDLE[1:3], (82.0, 6.4)], 2 * (HALF + LEFT_WALK + 2.4)), KERB
    )
    lane.ground("lane", "road", strip([MIDDLE[0], *MIDDLE[1:3], (75.5, 6.4)], 2 * HALF))
    lane.ground("gravel", "ground", [(77.5, 9.6), (77.5, 3.2), (80.6, 3.2), (80.6, 9.6)], KERB)
    x = 18.6
    lane.ground("crossing", "crosswalk", [(x - 2, -HALF), (x + 2, -HALF), (x + 2, HALF), (x - 2, HALF)])
    lane.ramp("left_ramp", (x, HALF), 90.0, 1.2, 0.9, 0.6)
    lane.ramp("right_ramp", (x, -HALF), -90.0, 1.2, 0.9, 0.6)


def _houses(lane: Canvas, left: list[Edge], right: list[Edge]) -> None:
    lane.houses(left[0], ("seafood shop", "toy shop", "restaurant", "flower shop", "watch shop"), -4.0, 34.6, LEFT_WALK)
    lane.houses(
        left[1], ("bubble tea bar", "comic shop", "pastry shop", "juice bar", "tobacco shop"), 1.4, 30.9, LEFT_WALK
    )
    lane.houses(left[2], ("ice cream shop", "jewelry store"), 0.2, 11.6, LEFT_WALK)
    lane.houses(
        right[0],
        ("restaurant", "bakery", "bubble tea bar", "photography shop", "seafood shop", "tobacco shop"),
        -4.0,
        36.3,
        RIGHT_WALK,
    )
    lane.houses(right[1], ("butcher shop", "video game store", "tattoo shop", "travel agency"), 0.2, 28.9, RIGHT_WALK)
    lane.houses(right[2], ("greengrocer", "ice cream shop"), 1.5, 12.2, RIGHT_WALK)
    lane.houses(edge((-4.0, -6.4), (-4.0, 6.6), 1), ("cheese shop", "dry cleaning"), 0.0, 13.0, 0.0)
    depth, width, height = lane.sizes["temple"][1]
    lane.put("temple", *SHRINE.at(7.6, depth / 2 + 0.3), 180.0, size=(depth, width, height))
    lane.put("shrine", *SHRINE.at(1.75, -6.0), 180.0, 1)
    lane.put("gate", 76.3, 6.4, 180.0, size=(0.4, 4.4, 3.2))
