"""A tidy suburb with verges, lawns and drives, and people in front of their houses.

There is little clutter. The difficulty is a winding street whose pavement is crossed by drives, dogs, children and a
mower.
"""

from ..canvas.canvas import Canvas, Edge, edge, edges
from ..canvas.ground_layers import Corner, strip

ID = "03_residential_street_dual_sidewalks_clean"

KERB = 0.10
HALF, VERGE, WALK, LAWN = 3.2, 1.6, 2.0, 5.0
FRONT = VERGE + WALK + LAWN
MIDDLE: list[Corner] = [(0.0, 0.0), (34.0, 0.0), (66.0, 12.0), (98.0, 12.0)]
HEDGE = (0.75, 2.28, 1.18)

#: Houses of each stretch: s of their middle, variant.
HOUSES_LEFT = (((5.0, 0), (15.6, 1), (25.6, 3)), ((8.4, 0), (19.6, 2), (29.6, 1)), ((5.0, 3), (16.4, 0), (27.6, 1)))
HOUSES_RIGHT = (((5.4, 1), (17.4, 0), (29.0, 3)), ((4.6, 0), (15.6, 1), (26.0, 2)), ((8.6, 1), (19.4, 3), (28.6, 0)))
#: Drives: s of their middle.
DRIVES_LEFT = ((10.4,), (14.4, 24.2), (10.5,))
DRIVES_RIGHT = ((23.4,), (10.1,), (14.1,))

#: On the verges: label, s, d, facing, variant. Trees stand apart.
VERGE_LEFT = (
    (
        ("mailbox", 8.2, 0.5, "street", 0),
        ("trash bin", 13.0, 0.6, "street", 1),
        ("street light", 2.0, 0.5, "street", 0),
        ("fire hydrant", 21.4, 0.5, "street", 0),
        ("mailbox", 23.0, 0.5, "street", 2),
        ("speed limit sign 30 km", 28.0, 0.5, "-", 0),
    ),
    (
        ("mailbox", 12.0, 0.5, "street", 0),
        ("street light", 6.0, 0.5, "street", 0),
        ("bench", 21.0, 0.9, "wall", 0),
        ("mailbox", 23.1, 0.5, "street", 2),
        ("trash bin", 27.6, 0.6, "street", 1),
        ("bird", 31.0, 0.9, 60.0, 0),
    ),
    (
        ("mailbox", 8.6, 0.5, "street", 0),
        ("street light", 4.0, 0.5, "street", 0),
        ("fire hydrant", 14.0, 0.5, "street", 2),
        ("trash bin", 21.4, 0.6, "street", 1),
        ("mailbox", 22.4, 0.5, "street", 1),
    ),
)
VERGE_RIGHT = (
    (
        ("street light", 9.6, 0.5, "street", 0),
        ("mailbox", 21.2, 0.5, "street", 2),
        ("trash bin", 26.0, 0.6, "street", 1),
        ("mailbox", 11.0, 0.5, "street", 0),
        ("squirrel", 30.6, 0.8, 100.0, 0),
    ),
    (
        ("mailbox", 8.1, 0.5, "street", 0),
        ("trash bin", 12.5, 0.6, "street", 1),
        ("street light", 20.4, 0.5, "street", 0),
        ("fire hydrant", 23.0, 0.5, "street", 0),
        ("mailbox", 30.2, 0.5, "street", 2),
    ),
    (
        ("mailbox", 11.6, 0.5, "street", 0),
        ("street light", 17.6, 0.5, "street", 0),
        ("trash bin", 16.4, 0.6, "street", 1),
        ("mailbox", 24.8, 0.5, "street", 1),
        ("traffic sign", 29.6, 0.5, "-", 0),
    ),
)
TREES_LEFT = ((5.0, 25.4), (3.4, 17.4, 33.0), (6.4, 16.8, 25.0))
TREES_RIGHT = ((3.6, 28.2), (4.0, 15.0, 26.8), (3.8, 8.4, 27.2))

#: In the gardens, d from the kerb: lawns begin at 3.6, fronts stand at 8.6.
GARDENS_LEFT = (
    (
        ("flower", 3.2, 7.9, 0.0, 0),
        ("flower", 4.4, 8.0, 40.0, 3),
        ("potted plant", 6.6, 8.2, "street", 1),
        ("bicycle", 7.6, 6.4, 70.0, 0),
        ("tree", 13.6, 6.2, 20.0, 3),
        ("shrub", 16.0, 8.0, 0.0, 0),
        ("shrub", 17.6, 8.0, 50.0, 3),
        ("parcels", 19.0, 8.2, 10.0, 0),
        ("picnic table", 23.4, 6.2, 20.0, 0),
        ("barbecue grill", 26.2, 6.0, 200.0, 1),
        ("pedestrian adult", 27.1, 6.2, 180.0, 2),
        ("pedestrian adult", 24.0, 4.5, 60.0, 3),
        ("beach chair", 28.4, 5.0, 120.0, 2),
        ("tree", 31.6, 6.6, 80.0, 1),
    ),
    (
        ("flower", 5.4, 7.9, 0.0, 1),
        ("flower", 6.6, 8.0, 30.0, 2),
        ("shrub", 9.6, 7.8, 0.0, 2),
        ("lawn mower", 10.0, 5.4, 30.0, 0),
        ("gardener", 8.8, 4.7, 30.0, 1),
        ("trampoline", 19.2, 6.3, 0.0, 0),
        ("pedestrian child", 20.9, 5.0, 140.0, 0),
        ("tree", 22.0, 7.2, 0.0, 0),
        ("potted plant", 28.4, 8.2, "street", 0),
        ("potted plant", 30.8, 8.2, "street", 0),
        ("skateboard", 28.0, 5.0, 40.0, 0),
        ("football", 29.6, 4.9, 0.0, 0),
        ("shrub", 32.0, 7.8, 10.0, 0),
    ),
    (
        ("flower", 3.4, 8.0, 0.0, 3),
        ("flower", 6.2, 8.0, 60.0, 0),
        ("rock", 4.6, 6.0, 20.0, 2),
        ("rock", 5.7, 5.3, 80.0, 0),
        ("tree", 7.4, 6.2, 10.0, 3),
        ("bench", 16.2, 7.6, "street", 0),
        ("flower", 14.4, 8.0, 0.0, 1),
        ("flower", 18.0, 8.0, 0.0, 2),
        ("elderly person", 15.4, 6.3, 120.0, 1),
        ("barrow", 24.6, 6.2, 40.0, 0),
        ("shovel", 26.0, 8.1, "street", 0),
        ("mud patch", 26.4, 6.0, 0.0, 1),
        ("shrub", 28.8, 8.0, 0.0, 3),
    ),
)
GARDENS_RIGHT = (
    (
        ("shrub", 3.4, 7.8, 0.0, 0),
        ("shrub", 5.0, 7.7, 0.0, 2),
        ("tricycle", 7.2, 5.0, 160.0, 0),
        ("pedestrian child", 8.4, 5.2, 200.0, 3),
        ("potted plant", 15.4, 8.2, "street", 1),
        ("potted plant", 19.2, 8.2, "street", 1),
        ("tree", 12.0, 6.6, 0.0, 4),
        ("flower", 27.6, 8.0, 0.0, 0),
        ("flower", 30.4, 8.0, 50.0, 3),
        ("beach chair", 27.0, 5.2, 70.0, 1),
        ("umbrella", 31.6, 6.0, 0.0, 0),
        ("cat", 20.4, 4.4, 60.0, 0),
    ),
    (
        ("flower", 3.2, 8.0, 0.0, 1),
        ("flower", 6.0, 8.0, 0.0, 3),
        ("table", 14.6, 5.8, 0.0, 1),
        ("chair", 13.8, 5.8, "+", 0),
        ("chair", 15.4, 5.8, "-", 0),
        ("chair", 14.6, 6.7, "street", 2),
        ("pedestrian adult", 17.4, 6.6, 210.0, 4),
        ("shrub", 18.6, 7.8, 0.0, 0),
        ("tree", 20.9, 6.8, 0.0, 3),
        ("potted plant", 24.2, 8.2, "street", 3),
        ("potted plant", 27.8, 8.2, "street", 3),
        ("suitcase", 12.4, 8.2, 20.0, 2),
    ),
    (
        ("shrub", 6.6, 7.9, 0.0, 2),
        ("flower", 9.6, 8.0, 0.0, 0),
        ("basketball", 17.0, 4.6, 0.0, 0),
        ("pedestrian child", 18.0, 5.4, 240.0, 1),
        ("tree", 24.0, 6.4, 0.0, 0),
        ("ladder", 20.2, 8.0, "street", 1),
        ("maintenance worker", 21.2, 7.2, 60.0, 1),
        ("toolbox", 20.0, 7.0, 30.0, 0),
        ("rabbit", 27.6, 5.2, 100.0, 0),
        ("flower", 27.0, 8.0, 0.0, 2),
        ("flower", 30.2, 8.0, 0.0, 1),
        ("kite", 22.4, 4.8, 30.0, 2),
    ),
)

#: On the pavements, between 1.6 and 3.6 from the kerb.
PEOPLE_LEFT = (
    (("jogger", 19.0, 2.1, "+", 0), ("pedestrian adult", 29.4, 2.0, "-", 0), ("stroller", 30.6, 2.0, "-", 1)),
    (("dog", 4.2, 2.1, "+", 0), ("pedestrian adult", 3.0, 2.1, "+", 1), ("roller skater", 28.6, 3.0, "-", 1)),
    (("pedestrian adult", 12.6, 2.1, "+", 5), ("dog", 13.8, 2.0, "+", 2), ("pedestrian child", 20.0, 3.1, "-", 0)),
)
PEOPLE_RIGHT = (
    (("elderly person", 10.6, 3.1, "+", 0), ("dog", 12.0, 3.2, "+", 2), ("delivery robot", 26.4, 2.1, "-", 0)),
    (("jogger", 18.0, 3.1, "-", 1), ("delivery worker", 29.2, 2.1, "+", 0), ("cat", 22.6, 3.2, 30.0, 0)),
    (("pedestrian adult", 4.6, 2.1, "+", 3), ("pedestrian adult", 5.2, 2.9, "+", 0), ("bicycle", 25.6, 3.4, "+", 0)),
)
#: On the road, by metres from the kerb of that side.
CARS_LEFT = (
    (("suv", 29.4, 1.2, "-", 1), ("cyclist", 6.4, 1.4, "-", 0)),
    (("minivan", 20.2, 1.2, "-", 0),),
    (("electric car", 18.4, 1.1, "-", 1), ("sedan", 26.4, 1.2, "-", 0)),
)
CARS_RIGHT = (
    (("hatchback car", 6.0, 1.15, "+", 1), ("sedan", 29.0, 1.2, "+", 2)),
    (("convertible car", 25.4, 1.1, "+", 0), ("manhole cover", 8.0, 2.0, 0.0, 0)),
    (("van", 22.6, 1.3, "+", 1),),
)
#: In the drives: label, variant, turn of the car in degrees from facing the street.
IN_DRIVES_LEFT = (
    (("sedan", 3, 180.0),),
    (("hatchback car", 0, 0.0), ("pickup truck", 0, 180.0)),
    (("electric car", 0, 0.0),),
)
IN_DRIVES_RIGHT = ((("suv", 2, 0.0),), (("coupe car", 1, 180.0),), (("minivan", 1, 0.0),))


def build() -> Canvas:
    street = Canvas(ID, seed=603)
    left, right = edges(MIDDLE, HALF, 1), edges(MIDDLE, HALF, -1)
    _lay(street, left, right)
    for lines, houses, drives, cars in (
        (left, HOUSES_LEFT, DRIVES_LEFT, IN_DRIVES_LEFT),
        (right, HOUSES_RIGHT, DRIVES_RIGHT, IN_DRIVES_RIGHT),
    ):
        for line, of_houses, of_drives, of_cars in zip(lines, houses, drives, cars, strict=True):
            for s, variant in of_houses:
                depth = street.sizes["house"][variant][0]
                street.put("house", *line.at(s, FRONT + depth / 2), line.facing("street"), variant)
            for s, (label, variant, turn) in zip(of_drives, of_cars, strict=True):
                street.put(
                    label, *line.at(s, 5.7 if label == "pickup truck" else 6.05), line.facing("street") + turn, variant
                )
    for lines, *tables in (
        (left, VERGE_LEFT, GARDENS_LEFT, PEOPLE_LEFT),
        (right, VERGE_RIGHT, GARDENS_RIGHT, PEOPLE_RIGHT),
    ):
        for table in tables:
            for line, rows in zip(lines, table, strict=True):
                street.along(line, rows)
    for lines, table, trees in ((left, CARS_LEFT, TREES_LEFT), (right, CARS_RIGHT, TREES_RIGHT)):
        for line, rows, places in zip(lines, table, trees, strict=True):
            street.along(line.road(), rows)
            street.trees(line, places, 0.8, "slim")
    _hedges(street, left, right)
    _ends(street)
    street.wear("road", "road/asphalt_new")
    street.wear((5.0, 6.2), "sidewalk/concrete_pale")
    street.wear((5.0, -6.2), "sidewalk/concrete_pale")
    street.wear("ground", "grass")
    street.sky("summer_afternoon-few_cumulus")
    street.trajectory = [left[0].at(2.0, 2.6), left[0].at(17.0, 2.6), right[0].at(17.0, 2.6), right[0].at(32.0, 2.6)]
    street.trajectory += [
        right[1].at(32.0, 2.6),
        right[2].at(30.0, 2.6),
        right[1].at(20.0, 2.6),
        right[0].at(17.0, 2.6),
    ]
    street.trajectory += [left[0].at(17.0, 2.6), left[1].at(2.0, 2.6), left[1].at(30.0, 2.6), left[2].at(30.0, 2.6)]
    return street


def _lay(street: Canvas, left: list[Edge], right: list[Edge]) -> None:
    far = [(-9.0, 0.0), *MIDDLE[1:3], (107.0, 12.0)]
    street.ground("gardens", "ground", strip(far, 2 * (HALF + FRONT + 2.4)), KERB)
    street.ground("pavements", "sidewalk", strip(MIDDLE, 2 * (HALF + VERGE + WALK)), KERB)
    street.ground("verges", "ground", strip(MIDDLE, 2 * (HALF + VERGE)), KERB)
    drives = [("left", left[k], k, s) for k, places in enumerate(DRIVES_LEFT) for s in places]
    drives += [("right", right[k], k, s) for k, places in enumerate(DRIVES_RIGHT) for s in places]
    for name, line, number, s in drives:
        for part, near, far in (("apron", -0.3, VERGE + 0.3), ("drive", VERGE + WALK - 0.3, FRONT + 2.5)):
            ring = [line.at(s - 1.5, near), line.at(s + 1.5, near), line.at(s + 1.5, far), line.at(s - 1.5, far)]
            street.ground(f"{name}_{part}_{number}_{s:.0f}", "sidewalk", ring, KERB)
    street.ground("road", "road", strip(MIDDLE, 2 * HALF))
    street.ground("crossing", "crosswalk", [(15.0, -HALF), (19.0, -HALF), (19.0, HALF), (15.0, HALF)])
    for name, line, number, s in drives:
        if number != 1:  # on the slanted part of the street the drives have a low kerb across them
            street.ramp(f"{name}_drive_ramp_{number}_{s:.0f}", line.at(s, 0), line.facing("wall"), 1.5, 0.9, 0.0)
    far_left, far_right = edges(MIDDLE, 16.0, 1), edges(MIDDLE, 16.0, -1)
    for k in (1, 2):
        street.cut(far_left[k].start, far_right[k].start)
    for s in (4.4, 19.2, 29.4):
        street.cut(left[1].at(s, 16.0), left[1].at(s, -22.5))
    for name, line in (("left", left[0]), ("right", right[0])):
        ring = [line.at(15.0, 0), line.at(19.0, 0), line.at(19.0, VERGE), line.at(15.0, VERGE)]
        street.ground(f"{name}_landing", "sidewalk", ring, KERB)
        street.ramp(f"{name}_ramp", line.at(17.0, 0), line.facing("wall"), 1.2, 1.2, 0.8)


def _hedges(street: Canvas, left: list[Edge], right: list[Edge]) -> None:
    """Hedges and fences between the gardens, and fences that close the gaps between the houses."""
    gaps_left = (((10.34, 1.7), (20.75, 1.45), (30.9, 2.0)), ((3.1, 1.2), (14.48, 3.1), (24.16, 2.0)))
    gaps_left += (((10.54, 2.75), (22.03, 2.3)),)
    gaps_right = (((11.36, 3.1), (23.36, 2.95), (33.9, 1.4)), ((10.13, 2.1), (21.24, 2.45), (30.9, 2.6)))
    gaps_right += (((2.7, 2.6), (14.12, 2.2)),)
    for lines, gaps in ((left, gaps_left), (right, gaps_right)):
        for line, of_line in zip(lines, gaps, strict=True):
            for s, width in of_line:
                street.put("fence", *line.at(s, FRONT + 1.6), line.facing("street"), size=(0.1, width, 1.8))
    for line, places in ((left[0], (0.4, 20.8)), (left[1], (1.6,)), (left[2], (21.9,)), (right[0], (0.6,))):
        for s in places:
            street.put("shrub", *line.at(s, 7.14), line.facing("+"), size=HEDGE)
            street.put("shrub", *line.at(s, 4.83), line.facing("+"), size=HEDGE)
    for line, places in ((right[2], (1.6,)),):
        for s in places:
            street.put("shrub", *line.at(s, 7.14), line.facing("+"), size=HEDGE)


def _ends(street: Canvas) -> None:
    """A house, trees and fences across either end, behind a lawn."""
    for line, variant in ((edge((-4.0, -11.0), (-4.0, 11.0), 1), 2), (edge((102.0, 23.0), (102.0, 1.0), 1), 0)):
        depth = street.sizes["house"][variant][0]
        street.put("house", *line.at(11.0, depth / 2), line.facing("street"), variant)
        street.row("fence", line, (1.3, 4.1, 17.9, 20.7), 0.4, "street", 2)
        street.trees(line, (3.0, 19.0), 2.6, "broad")
        street.along(
            line, (("bench", 11.0, -2.6, "street", 0), ("flower", 8.6, -0.7, 0.0, 0), ("flower", 13.4, -0.7, 0.0, 3))
        )
        street.along(
            line, (("traffic barricade", 9.4, -3.6, "street", 1), ("traffic barricade", 12.4, -3.6, "street", 1))
        )
