"""A residential cul-de-sac with a hammerhead: an open trench, a removal, and bins on both pavements.

The cul-de-sac runs north from a street and ends in a bar of asphalt for turning; a footpath between two gardens leads
on to a lane of garages. Pavements are 2.4 m wide; works, a lorry's load and parked cars on the kerb occupy most of
them.
"""

from ..canvas import ground_layers as lay
from ..canvas.canvas import Canvas, edge
from ..canvas.pieces import blank, chain, people
from ..catalogue import TREES

ID = "v08_close_with_works_and_removals"
PAVEMENT_HEIGHT, HALF, WALK, GARDEN = 0.12, 2.6, 2.6, 3.0
STEM_LENGTH, HEAD, BAR = 36.0, 7.0, 14.0  # m: to the hammerhead, its depth, half its width
LEFT, RIGHT = edge((-HALF, 0.0), (-HALF, STEM_LENGTH), 1), edge((HALF, 0.0), (HALF, STEM_LENGTH), -1)
BACK = STEM_LENGTH + HEAD  # y of the hammerhead's far kerb
STREET = edge((-26.0, -2.4), (26.0, -2.4), 1)


def _ground(c: Canvas) -> None:
    box = lay.rectangle
    outer = HALF + WALK
    c.ground("front_lots", "sidewalk", box(-26.0, -2.4, 26.0, 2.4), PAVEMENT_HEIGHT)
    c.ground("lots", "sidewalk", box(-outer - GARDEN - 2.4, 2.0, outer + GARDEN + 2.4, STEM_LENGTH), PAVEMENT_HEIGHT)
    c.ground("head_lots", "sidewalk", box(-BAR - 5.0, STEM_LENGTH - 3.0, BAR + 5.0, BACK + WALK), PAVEMENT_HEIGHT)
    c.ground("back_lots", "sidewalk", box(-BAR - 2.4, BACK + WALK, BAR + 2.4, BACK + 24.0), PAVEMENT_HEIGHT)
    c.ground("gardens_west", "ground", box(-outer - GARDEN, 2.0, -outer, STEM_LENGTH - WALK), PAVEMENT_HEIGHT)
    c.ground("gardens_east", "ground", box(outer, 2.0, outer + GARDEN, STEM_LENGTH - WALK), PAVEMENT_HEIGHT)
    c.ground("gardens_north_west", "ground", box(-BAR, BACK + WALK, -1.6, BACK + WALK + GARDEN), PAVEMENT_HEIGHT)
    c.ground("gardens_north_east", "ground", box(1.6, BACK + WALK, BAR, BACK + WALK + GARDEN), PAVEMENT_HEIGHT)
    c.ground("street", "road", box(-26.0, -8.4, 26.0, -2.4))
    c.ground("far_pavement", "sidewalk", box(-26.0, -13.4, 26.0, -8.4), PAVEMENT_HEIGHT)
    c.ground("pavement", "sidewalk", box(-26.0, -2.4, 26.0, 0.0), PAVEMENT_HEIGHT)
    c.ground("close", "road", box(-HALF, -2.4, HALF, STEM_LENGTH))
    c.ground("hammerhead", "road", box(-BAR, STEM_LENGTH, BAR, BACK))
    c.ground("garage_lane", "road", box(-BAR, BACK + 15.0, BAR, BACK + 20.0))
    c.ground("zebra_mouth", "crosswalk", box(-HALF, -2.2, HALF, 0.4))
    c.ground("crossing", "crosswalk", box(-HALF, 16.0, HALF, 19.0))
    c.ground("crossing_head", "crosswalk", box(-2.0, STEM_LENGTH, 2.0, BACK))
    c.ground("zebra_street", "crosswalk", box(-16.0, -8.4, -12.0, -2.4))
    c.ramp("ramp_mouth_w", (-HALF, -0.9), 180.0, parted=False, flare=0.4, half_width=0.9)
    c.ramp("ramp_mouth_e", (HALF, -0.9), 0.0, parted=False, flare=0.4, half_width=0.9)
    c.ramp("ramp_cross_w", (-HALF, 17.5), 180.0, parted=False)
    c.ramp("ramp_cross_e", (HALF, 17.5), 0.0, parted=False)
    c.ramp("ramp_head_n", (0.0, BACK), 90.0, parted=False)
    c.ramp("ramp_street_n", (-14.0, -2.4), 90.0, parted=False)
    c.ramp("ramp_street_s", (-14.0, -8.4), -90.0, parted=False)
    c.ground(
        "crossing_bar",
        "crosswalk",
        [(-HALF, STEM_LENGTH - 3.4), (HALF, STEM_LENGTH - 3.4), (HALF, STEM_LENGTH), (-HALF, STEM_LENGTH)],
    )
    c.ramp("ramp_bar_w", (-HALF, STEM_LENGTH - 2.0), 180.0, parted=False, flare=0.4)
    c.ramp("ramp_bar_e", (HALF, STEM_LENGTH - 2.0), 0.0, parted=False, flare=0.4)
    for name in ("lots", "front_lots", "head_lots", "back_lots"):
        for y in (0.0, 9.0, 25.0, STEM_LENGTH, BACK, BACK + WALK + GARDEN, BACK + 15.0):
            c.cut((-26.0, y), (26.0, y), name)
        for x in (-outer, outer, -1.6, 1.6):
            c.cut((x, -2.4), (x, BACK + 24.0), name)
    c.dashes("middle_west", (-26.0, -5.4), (-17.0, -5.4))
    c.dashes("middle_east", (-11.0, -5.4), (26.0, -5.4))
    c.wear("road", "road/asphalt_used-patched")
    c.wear((-20.0, -1.0), "sidewalk/brick_brown_running-worn")
    c.wear("ground", "grass")
    c.wear("crosswalk", "zebra_worn")
    c.wear("road_marking", "paint_white")
    c.sky("summer_evening-few_cumulus")


def _fronts(c: Canvas) -> None:
    d = WALK + GARDEN
    c.houses(LEFT, ("house", "house", "house"), 3.0, STEM_LENGTH - WALK - 0.4, d)
    c.houses(RIGHT, ("house", "garage", "house", "house"), 3.0, STEM_LENGTH - WALK - 0.4, d)
    back = edge((-BAR, BACK), (BAR, BACK), 1)
    c.houses(back, ("house", "house"), 0.0, BAR - 1.6, d)
    c.houses(back, ("house", "house"), BAR + 1.6, 2 * BAR, d)
    c.houses(edge((-BAR, STEM_LENGTH), (-BAR, BACK), 1), ("garage",), 0.0, HEAD, 2.6)
    c.houses(edge((BAR, STEM_LENGTH), (BAR, BACK), -1), ("garage",), 0.0, HEAD, 2.6)
    row = ("garage", "garage", "garage", "garage")
    c.houses(edge((-BAR, BACK + 20.0), (BAR, BACK + 20.0), 1), row, 0.0, 2 * BAR, 0.4)
    for x in (-BAR - 1.0, BAR + 1.0):
        chain(c, "wall", [(x, BACK + 14.2), (x, BACK + 20.2)], 2, stretch=1.2)
    c.houses(edge((-26.0, 0.0), (-17.0, 0.0), 1), ("house",), 0.0, 9.0, 0.0)
    c.houses(edge((17.0, 0.0), (26.0, 0.0), 1), ("house",), 0.0, 9.0, 0.0)
    south = ("house", "apartment building", "house", "house", "apartment building")
    c.houses(edge((-26.0, -11.0), (26.0, -11.0), -1), south, 0.0, 52.0, 0.0)


def _gardens(c: Canvas) -> None:
    hedge = (0.75, 2.28, 1.18)
    for line, places in ((LEFT, (4.2, 6.8, 14.6, 20.4, 23.0, 29.6)), (RIGHT, (4.2, 12.8, 15.2, 23.6, 26.2, 31.6))):
        for s in places:
            c.put("shrub", *line.at(s, WALK + 0.5), line.facing("street"), size=hedge)
    for x, y, growth in ((-7.0, 10.4, "blossom"), (7.0, 21.0, "blossom"), (-7.2, 26.4, "slim"), (7.0, 8.4, "slim")):
        c.put("tree", x, y, 30.0, size=TREES[growth])
    for x, y, variant in ((-7.2, 17.6, 0), (7.2, 18.2, 1), (-7.0, 31.6, 1), (7.2, 29.0, 0), (-10.0, BACK + 4.0, 0)):
        c.put("flower", x, y, 20.0, variant)
    chain(c, "fence", [(-1.5, BACK + WALK + 0.2), (-1.5, BACK + WALK + GARDEN - 0.1)], stretch=2.4)
    chain(c, "fence", [(1.5, BACK + WALK + GARDEN - 0.1), (1.5, BACK + WALK + 0.2)], stretch=2.4)
    for x in (-12.0, -8.0, -4.2, 4.2, 8.6, 12.2):
        c.put("shrub", x, BACK + WALK + 0.5, 90.0, size=hedge)
    c.put("beach chair", 10.0, BACK + 4.4, 40.0, 1)
    c.put("trampoline", -6.0, BACK + 4.2, 0.0, 2)
    c.put("lawn mower", 6.0, BACK + 4.6, 100.0, 0)


def _left(c: Canvas) -> None:
    """Works: a trench in the western pavement with its spoil and signs, and bins before and behind it."""
    c.along(
        LEFT,
        [
            ("lamppost", 2.0, 0.4, "street", 0),
            ("trash bin", 3.6, 2.2, "street", 0),
            ("trash bin", 4.5, 2.2, "street", 0),
            ("garbage bag", 5.6, 2.1, 20.0, 0),
            ("bicycle", 8.2, 2.25, "+"),
            ("road work detour ahead sign", 10.0, 0.7, "-", 0),
            ("traffic barricade", 11.6, 0.8, "-"),
            ("debris", 12.8, 0.75, 20.0, 0),
            ("barrow", 14.2, 0.6, "+", 0),
            ("traffic cone", 11.7, 1.75, 0.0, 0),
            ("construction worker", 10.9, -0.8, 60.0),
            ("street light", 22.4, 0.45, "street"),
            ("trash bin", 20.6, 2.2, "street", 0),
            ("garbage bag", 21.6, 2.1, 60.0, 1),
            ("pedestrian adult", 23.6, 1.2, "+"),
            ("dog", 25.0, 1.5, "+"),
            ("cat", 4.8, -1.6, 30.0),
            ("storage box", 27.0, 2.2, "street", 0),
            ("trash bin", 28.2, 2.2, "street", 0),
            ("stroller", 30.2, 2.2, "+"),
            ("potted plant", 31.8, 2.2, "street", 0),
            ("hatchback car", 24.6, -1.15, "+", 1),
            ("excavator", 8.4, -1.0, "+", 2),
            ("manhole cover", 20.4, -2.2, 0.0),
        ],
    )


def _right(c: Canvas) -> None:
    """A removal: a van at the kerb and furniture on the pavement."""
    c.along(
        RIGHT,
        [
            ("mailbox", 2.2, 2.35, "street", 0),
            ("trash bin", 4.0, 2.2, "street", 0),
            ("garbage bag", 5.0, 2.1, 10.0, 1),
            ("garbage bag", 5.9, 2.2, 80.0, 0),
            ("couch", 8.2, 2.0, "street", 1),
            ("armchair", 10.0, 2.05, "street", 0),
            ("refrigerator", 11.4, 2.2, "street", 0),
            ("parcels", 5.6, -1.0, 10.0),
            ("parcels", 6.0, -1.8, 50.0),
            ("lamp", 12.6, 2.3, 0.0, 1),
            ("chest of drawers", 13.8, 2.3, "street", 0),
            ("washing machine", 14.9, 2.25, "street", 0),
            ("delivery worker", 4.6, -1.2, "+"),
            ("lamppost", 20.6, 0.4, "street", 0),
            ("street cabinet", 22.0, 2.3, "street", 0),
            ("bench", 24.6, 2.1, "street", 2),
            ("elderly person", 26.4, 1.6, "-"),
            ("trash bin", 28.0, 2.2, "street", 0),
            ("trash bin", 28.9, 2.2, "street", 0),
            ("scooter", 30.4, 1.9, 70.0, 1),
            ("fire hydrant", 12.6, 0.4, "street"),
            ("van", 9.4, -1.3, "+"),
            ("sedan", 25.4, -1.2, "+"),
        ],
    )


def _head(c: Canvas) -> None:
    back = edge((-BAR, BACK), (BAR, BACK), 1)
    c.along(
        back,
        [
            ("trash bin", 2.2, 2.2, "street", 0),
            ("trash bin", 3.1, 2.2, "street", 0),
            ("garbage bag", 4.2, 2.1, 20.0, 0),
            ("bicycle", 6.6, 2.2, "+"),
            ("lamppost", 9.4, 0.4, "street", 0),
            ("pedestrian child", 10.8, 1.3, "+"),
            ("basketball", 12.2, 0.8, 0.0),
            ("potted plant", 17.4, 2.2, "street", 1),
            ("trash bin", 18.6, 2.2, "street", 0),
            ("garbage bag", 20.0, 2.1, 50.0, 1),
            ("street cabinet", 22.4, 2.2, "street", 1),
            ("motorcycle", 25.0, 1.8, "+"),
            ("pedestrian adult", 27.0, 1.2, "-"),
            ("suv", 24.4, -1.4, "+"),
            ("hatchback car", 3.6, -1.3, "-"),
        ],
    )
    lower_west, lower_east = (
        edge((-BAR, STEM_LENGTH), (-HALF, STEM_LENGTH), -1),
        edge((HALF, STEM_LENGTH), (BAR, STEM_LENGTH), -1),
    )
    c.along(
        lower_west,
        [
            ("garbage bag", 3.0, 2.1, 10.0, 0),
            ("trash bin", 4.2, 2.1, "street", 1),
            ("bench", 6.6, 2.0, "street", 1),
            ("pedestrian adult", 8.2, 1.2, 30.0),
        ],
    )
    c.along(
        lower_east,
        [
            ("dumpster", 5.4, 1.6, "street", 1),
            ("storage box", 8.0, 2.1, "street", 2),
            ("skateboard", 3.0, 1.8, 40.0, 0),
        ],
    )
    # the footpath, and the paving behind it before the garages
    y = BACK + WALK
    c.put("bollard", 0.0, y + GARDEN + 0.4, 0.0)
    c.put("pedestrian adult", 0.6, y + GARDEN + 6.0, 85.0)
    c.put("bicycle", -1.1, y + GARDEN + 4.0, 90.0)
    c.put("lamppost", 1.4, BACK + 14.2, 0.0, 0)
    c.put("sedan", -10.0, BACK + 17.0, 0.0)
    c.put("camper", 10.0, BACK + 17.4, 0.0, 2)
    for x, label, turn in ((-9.0, "trash bin", -90.0), (6.0, "garbage bag", 20.0), (8.4, "stroller", 0.0)):
        c.put(label, x, BACK + 14.4, turn)


def _street(c: Canvas) -> None:
    c.along(
        STREET,
        [
            ("street light", 6.0, 0.4, "street"),
            ("street light", 44.0, 0.4, "street"),
            ("postbox", 18.0, 1.9, "street"),
            ("bicycle", 4.0, 2.1, "+"),
            ("pedestrian adult", 8.6, 1.3, "+"),
            ("garbage bag", 20.0, 2.0, 20.0, 0),
            ("trash bin", 32.4, 2.0, "street", 0),
            ("pedestrian adult", 34.6, 1.2, "-"),
            ("stroller", 35.8, 1.4, "-"),
            ("parking meter", 40.0, 0.4, "street"),
            ("scooter", 40.4, 2.9, 30.0, 1),
            ("bench", 47.6, 2.05, "street", 2),
            ("sedan", 5.0, -1.2, "+"),
            ("pickup truck", 36.0, -1.25, "+"),
            ("taxi", 45.0, -1.2, "+"),
        ],
    )
    far = edge((-26.0, -8.4), (26.0, -8.4), -1)
    c.trees(far, (4.0, 18.0, 26.0, 34.0, 48.0), 0.9)
    c.along(
        far,
        [
            ("street light", 22.0, 0.4, "street"),
            ("trash bin", 8.0, 2.2, "street", 0),
            ("garbage bag", 9.0, 2.1, 10.0, 1),
            ("jogger", 15.0, 1.7, "+"),
            ("bench", 30.0, 0.7, "wall", 0),
            ("mailbox", 38.0, 2.3, "street", 0),
            ("elderly person", 42.0, 1.6, "-"),
            ("van", 20.0, -1.3, "-"),
        ],
    )
    people(c, [("pedestrian child", 3.4, 24.0, 90.0), ("maintenance worker", -1.6, 14.4, 170.0)])


def build() -> Canvas:
    c = blank(ID)
    _ground(c)
    _fronts(c)
    _gardens(c)
    _left(c)
    _right(c)
    _head(c)
    _street(c)
    c.trajectory = [
        (-14.0, -9.8),
        (-14.0, -1.2),
        (-4.0, -1.0),
        (3.6, -1.0),
        (20.0, -1.2),
        (3.6, -1.0),
        (3.8, 8.0),
        (4.0, 17.5),
    ]
    c.trajectory += [
        (-4.0, 17.5),
        (-3.6, 8.0),
        (-4.0, 17.5),
        (-4.2, 26.0),
        (-4.2, 34.0),
        (4.2, 34.0),
        (4.2, 24.0),
    ]
    c.trajectory += [
        (4.2, 34.0),
        (0.0, 34.0),
        (0.0, 40.0),
        (0.0, 44.4),
        (-7.0, 44.0),
        (8.0, 44.4),
        (0.0, 46.6),
        (0.6, 53.0),
        (0.4, 57.0),
    ]
    return c
