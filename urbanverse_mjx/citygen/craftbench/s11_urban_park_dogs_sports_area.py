"""A busy park between houses: dogs off the lead, ball games outside the court, a fallen branch on the path.

The park has 84 by 56 m of lawns (open ground), crossed by gravel paths 2.4-3 m wide, and a street with a crossing along
its south side. A dog run and a basketball court are fenced, each with a gap for a gate; a ramp leads up to the terrace
of a bandstand. Blankets, tables, bicycles, mowers and forty people and dogs are on and off the paths.
"""

from ..canvas import ground_layers as lay
from ..canvas.canvas import Canvas, edge
from ..canvas.pieces import apron, blank, chain, people, table

ID = "11_urban_park_dogs_sports_area"
PAVEMENT_HEIGHT, TERRACE_HEIGHT = 0.15, 0.45


def _ground(c: Canvas) -> None:
    box = lay.rectangle
    apron(c, "lots", box(0, -14.0, 84.0, 56.0), PAVEMENT_HEIGHT)
    c.ground("far_pavement", "sidewalk", box(0, -14.0, 84.0, -11.0), PAVEMENT_HEIGHT)
    c.ground("pavement", "sidewalk", box(0, -4.0, 84.0, 0.0), PAVEMENT_HEIGHT)
    c.ground("street", "road", box(0, -11.0, 84.0, -4.0))
    c.ground("zebra", "crosswalk", box(40.0, -11.0, 44.0, -4.0))
    c.ground("lawn", "ground", box(0, 0, 84.0, 56.0), PAVEMENT_HEIGHT)
    for i, x in enumerate((18.0, 40.0, 62.0)):
        c.ground(f"gate_{i}", "sidewalk", box(x, 0, x + 4.0, 3.0), PAVEMENT_HEIGHT)
    c.ground("diagonal", "sidewalk", [(18.6, 6.0), (22.0, 6.0), (36.0, 20.0), (34.3, 21.7)], PAVEMENT_HEIGHT)
    c.ground("promenade", "sidewalk", box(0, 3.0, 84.0, 6.0), PAVEMENT_HEIGHT)
    c.ground("west_path", "sidewalk", box(3.0, 6.0, 6.0, 50.0), PAVEMENT_HEIGHT)
    c.ground("east_path", "sidewalk", box(78.0, 6.0, 81.0, 50.0), PAVEMENT_HEIGHT)
    c.ground("north_path", "sidewalk", box(6.0, 47.0, 78.0, 50.0), PAVEMENT_HEIGHT)
    c.ground("long_path", "sidewalk", box(6.0, 25.0, 78.0, 28.0), PAVEMENT_HEIGHT)
    c.ground("cross_path", "sidewalk", box(38.0, 6.0, 41.0, 47.0), PAVEMENT_HEIGHT)
    ring = [
        (36.5, 19.5),
        (42.5, 19.5),
        (46.5, 23.5),
        (46.5, 29.5),
        (42.5, 33.5),
        (36.5, 33.5),
        (32.5, 29.5),
        (32.5, 23.5),
    ]
    c.ground("circle", "sidewalk", ring, PAVEMENT_HEIGHT)
    c.ground("sand", "ground", box(60.0, 10.0, 75.0, 22.0), PAVEMENT_HEIGHT)
    c.ground("dog_run", "ground", box(9.0, 31.0, 27.0, 44.0), PAVEMENT_HEIGHT)
    c.ground("court", "sidewalk", box(45.0, 29.6, 75.0, 46.0), PAVEMENT_HEIGHT)
    c.ground("terrace", "sidewalk", box(9.0, 15.0, 18.0, 23.0), TERRACE_HEIGHT)
    low, high = [(9.6, 12.0, PAVEMENT_HEIGHT), (11.4, 12.0, PAVEMENT_HEIGHT)], [(9.6, 15.0, TERRACE_HEIGHT)]
    c.slope("terrace_ramp", "sidewalk", box(9.6, 12.0, 11.4, 15.0), [*low, *high])
    c.stairs("steps", (18.64, 19.0), 180.0, 4.0, 2)
    c.ramp("ramp_park", (42.0, -4.0), 90.0, parted=False)
    c.ramp("ramp_far", (42.0, -11.0), -90.0)
    c.dashes("middle_west", (2.0, -7.5), (38.0, -7.5), gap=6.0)
    c.dashes("middle_east", (46.0, -7.5), (83.0, -7.5), gap=6.0)
    c.wear("road", "road/asphalt_old")
    c.wear((20.0, -2.0), "sidewalk/flags_grey")
    c.wear((20.0, -12.5), "sidewalk/flags_grey")
    for spot in (
        (20.0, 1.5),
        (42.0, 1.5),
        (64.0, 1.5),
        (20.0, 4.5),
        (4.5, 20.0),
        (79.5, 20.0),
        (20.0, 48.5),
        (20.0, 26.5),
    ):
        c.wear(spot, "sidewalk/hoggin")
    for spot in ((60.0, 26.5), (39.5, 12.0), (39.5, 40.0), (39.5, 26.0), (60.0, 48.5), (26.0, 12.0)):
        c.wear(spot, "sidewalk/hoggin")
    c.wear((60.0, 29.8), "sidewalk/asphalt_fine")
    c.wear((16.0, 17.0), "sidewalk/boardwalk")
    c.wear((10.5, 13.5), "sidewalk/boardwalk")
    c.wear((30.0, 40.0), "grass")
    c.wear((66.0, 16.0), "earth")
    c.wear((20.0, 40.0), "grass_dry")
    c.wear("crosswalk", "zebra_worn")
    c.wear("road_marking", "paint_white")
    c.sky("summer_morning-few_cumulus")


def _fronts(c: Canvas) -> None:
    north = ("apartment building", "school", "apartment building", "school", "hotel")
    c.houses(edge((0, 56), (84, 56), 1), (*north, "apartment building"), 0, 84, 0)
    west = ("house", "apartment building", "school", "apartment building", "house")
    c.houses(edge((0, 0), (0, 56), 1), west, 0, 56, 0)
    c.houses(edge((84, 0), (84, 56), -1), ("school", "apartment building", "hotel", "apartment building"), 0, 56, 0)
    south = ("cafe", "bakery", "apartment building", "flower shop", "bicycle shop", "hotel")
    c.houses(edge((0, -14), (84, -14), -1), (*south, "apartment building", "restaurant"), 0, 84, 0)
    c.houses(edge((0, -14), (0, 0), 1), ("house",), 0, 14, 0)
    c.houses(edge((84, -14), (84, 0), -1), ("apartment building",), 0, 14, 0)


def _edges(c: Canvas) -> None:
    """Railings and trees around the park, and the street along it."""
    chain(c, "fence", [(0.2, 0.5), (17.6, 0.5)], stretch=2.4)
    chain(c, "fence", [(22.4, 0.5), (39.6, 0.5)], stretch=2.4)
    chain(c, "fence", [(44.4, 0.5), (61.6, 0.5)], stretch=2.4)
    chain(c, "fence", [(66.4, 0.5), (83.8, 0.5)], stretch=2.4)
    c.trees(edge((0, 0), (84, 0), 1), (9.0, 51.0, 74.0), 1.9, "broad")
    c.trees(edge((0, 53), (84, 53), 1), (6.0, 18.0, 33.0, 45.0, 60.0, 74.0), 0.0, "broad")
    c.trees(edge((1.5, 0), (1.5, 56), -1), (12.0, 38.0), 0.0, "street")
    c.trees(edge((82.6, 0), (82.6, 56), 1), (10.0, 34.0), 0.0, "street")
    pavement = edge((0, -4), (84, -4), 1)
    c.along(
        pavement,
        [
            ("street light", 6.0, 0.5, "street"),
            ("street light", 30.0, 0.5, "street"),
            ("street light", 79.0, 0.5, "street"),
            ("bicycle rental", 12.4, 1.15, "wall", 1),
            ("bicycle", 16.4, 1.6, 30.0),
            ("scooter", 18.6, 2.3, 100.0, 1),
            ("street food stall", 25.4, 1.4, "wall", 0),
            ("pedestrian adult", 25.0, 3.1, "street"),
            ("pedestrian child", 26.0, 2.9, "street"),
            ("bus shelter", 50.4, 2.7, "street"),
            ("pedestrian adult", 47.8, 1.6, "street"),
            ("trash bin", 33.2, 0.7, "wall", 0),
            ("bulletin board", 60.4, 3.3, "street", 1),
            ("information point", 67.2, 2.9, "street", 1),
            ("bollard", 39.0, 0.4, "street"),
            ("bollard", 45.0, 0.4, "street"),
            ("food truck", 70.0, -1.7, "+"),
            ("advertising board", 68.4, 1.8, "+"),
            ("pedestrian adult", 71.0, 1.6, "street"),
            ("elderly person", 36.6, 2.0, "+"),
            ("dog", 37.6, 2.6, "+", 1),
            ("jogger", 8.0, 2.7, "+"),
            ("tree debris", 56.4, 2.1, 30.0, 2),
            ("sedan", 4.0, -1.2, "+"),
            ("suv", 21.0, -1.25, "+"),
            ("hatchback car", 61.6, -1.2, "+"),
        ],
    )
    far = edge((0, -11), (84, -11), -1)
    c.along(
        far,
        [
            ("advertising board", 5.4, 1.9, "+"),
            ("potted plant", 9.0, 2.5, "street", 1),
            ("bench", 20.0, 2.6, "street", 0),
            ("flower", 46.2, 2.5, 0.0, 0),
            ("plant pot", 50.2, 2.4, 0.0, 0),
            ("bicycle", 54.0, 1.9, 75.0),
            ("bicycle", 56.0, 1.9, 80.0),
            ("pedestrian adult", 26.0, 1.4, "+"),
            ("street light", 38.0, 0.5, "street"),
            ("van", 52.0, -1.25, "-"),
            ("sedan", 74.0, -1.25, "-"),
        ],
    )
    table(c, 3.4, -13.1, (0.0, 180.0))
    table(c, 77.6, -13.1, (0.0, 180.0))
    c.put("pedestrian adult", 41.4, -6.2, -90.0)
    c.put("cyclist", 28.0, -8.6, 180.0)


def _dogs(c: Canvas) -> None:
    """The dog run, and dogs outside of it."""
    chain(c, "fence", [(9.0, 31.0), (15.6, 31.0)], stretch=2.4)
    chain(c, "fence", [(17.4, 31.0), (27.0, 31.0)], stretch=2.4)
    chain(c, "fence", [(27.0, 31.0), (27.0, 44.0)], stretch=2.4)
    chain(c, "fence", [(27.0, 44.0), (9.0, 44.0)], stretch=2.4)
    chain(c, "fence", [(9.0, 44.0), (9.0, 31.0)], stretch=2.4)
    for x, y, turn, variant in (
        (13.0, 36.0, 30.0, 0),
        (15.2, 38.6, 200.0, 1),
        (18.0, 35.4, 140.0, 0),
        (20.6, 40.4, -30.0, 1),
        (22.8, 37.4, 100.0, 0),
        (11.4, 41.0, 60.0, 1),
        (24.4, 33.6, 170.0, 1),
    ):
        c.put("dog", x, y, turn, variant)
    c.put("bench", 14.6, 34.0, 0.0, 2)
    c.put("vehicle wheel", 21.6, 34.6, 40.0, 2)
    c.put("water point", 10.2, 32.4, 45.0, 0)
    c.put("bench", 18.4, 43.2, -90.0, 0)
    c.put("bench", 10.0, 38.2, 0.0, 0)
    c.put("trash bin", 17.9, 32.0, 90.0, 2)
    c.put("tree", 23.6, 42.0, 30.0, size=(5.3, 5.5, 6.6))
    c.put("sports ball", 17.0, 37.2, 0.0, 2)
    c.put("frisbee", 19.4, 38.0, 0.0, 0)
    people(
        c,
        [
            ("pedestrian adult", 16.6, 41.0, -60.0),
            ("pedestrian adult", 12.4, 33.6, 40.0),
            ("pedestrian adult", 21.8, 39.0, 160.0),
            ("pedestrian adult", 16.4, 29.6, 90.0),
            ("pedestrian adult", 8.2, 26.2, 10.0),
            ("pedestrian adult", 30.6, 26.9, 180.0),
            ("pedestrian adult", 4.2, 36.4, -90.0),
            ("pedestrian child", 44.8, 23.0, 60.0),
            ("elderly person", 61.0, 48.2, 180.0),
            ("pedestrian adult", 79.4, 30.4, 95.0),
        ],
    )
    for x, y, turn, variant in (
        (15.6, 29.4, 90.0, 1),
        (9.4, 26.5, 5.0, 0),
        (29.4, 27.2, 180.0, 0),
        (4.9, 35.6, -80.0, 1),
        (45.8, 23.4, 40.0, 1),
        (59.9, 48.0, 180.0, 1),
        (79.2, 31.8, 95.0, 0),
        (35.0, 7.9, 130.0, 0),
        (52.2, 24.0, -20.0, 1),
    ):
        c.put("dog", x, y, turn, variant)


def _sports(c: Canvas) -> None:
    """The fenced court, and the games beside it."""
    c.put("basketball court", 60.0, 37.8, 0.0, 0)
    for line in ([(45.2, 29.9), (57.4, 29.9)], [(59.4, 29.9), (74.8, 29.9)], [(74.8, 29.9), (74.8, 45.8)]):
        chain(c, "fence", line, 1, 2.4)
    for line in ([(74.8, 45.8), (45.2, 45.8)], [(45.2, 45.8), (45.2, 29.9)]):
        chain(c, "fence", line, 1, 2.4)
    c.put("bench", 66.4, 28.9, 90.0, 2)
    c.put("bench", 51.4, 28.9, 90.0, 2)
    c.put("bicycle", 63.2, 28.75, 0.0)
    c.put("trash bin", 56.6, 29.0, -90.0, 1)
    c.put("basketball", 58.2, 26.2, 0.0)
    people(
        c,
        [
            ("pedestrian adult", 57.4, 26.6, 60.0),
            ("pedestrian child", 59.6, 27.2, 180.0),
            ("pedestrian adult", 61.8, 28.8, 90.0),
            ("pedestrian adult", 48.4, 28.9, 90.0),
        ],
    )
    # table tennis and exercise by the north path
    c.put("table-tennis table", 43.6, 36.0, 0.0, 0)
    c.put("pedestrian adult", 42.0, 36.1, 0.0)
    c.put("table-tennis table", 43.4, 41.6, 0.0, 0)
    c.put("fitness equipments", 30.4, 43.0, 20.0, 0)
    c.put("fitness equipments", 33.4, 44.6, 100.0, 1)
    c.put("horizontal bar", 34.4, 41.0, 90.0, 0)
    c.put("jogger", 32.0, 41.8, 200.0)
    c.put("roller skater", 70.0, 48.6, 0.0)
    c.put("jogger", 27.4, 48.2, 180.0)
    c.put("jogger", 5.2, 22.2, 90.0)
    c.put("skateboard", 36.4, 20.6, 60.0, 0)


def _play(c: Canvas) -> None:
    """Playground, pond and the picnic lawns."""
    c.put("playground", 66.2, 17.2, 180.0, 0)
    c.put("sand patch", 71.6, 13.4, 20.0, 0)
    c.put("trampoline", 72.2, 19.2, 0.0, 2)
    c.put("bench", 62.0, 10.9, 90.0, 0)
    c.put("stroller", 63.9, 11.2, 80.0)
    c.put("stroller", 61.2, 18.2, 10.0)
    c.put("tricycle", 70.0, 11.8, 30.0, size=(0.8, 0.42, 0.57))
    people(
        c,
        [
            ("pedestrian child", 70.2, 16.4, 160.0),
            ("pedestrian child", 62.8, 16.6, 20.0),
            ("pedestrian child", 73.2, 15.6, -120.0),
            ("pedestrian adult", 63.0, 12.6, 60.0),
            ("infant", 71.2, 14.6, 60.0),
        ],
    )
    c.put("pond", 50.0, 14.6, 15.0, 2)
    for x, y, turn in ((45.0, 12.2, 40.0), (45.7, 11.6, 80.0), (54.6, 17.6, 200.0), (55.2, 12.0, 150.0)):
        c.put("duck", x, y, turn)
    c.put("swan", 46.4, 18.4, -20.0)
    c.put("bench", 50.4, 19.6, -90.0, 0)
    c.put("bench", 43.6, 15.6, 0.0, 0)
    c.put("pedestrian adult", 47.4, 10.2, 70.0)
    c.put("rock", 55.4, 15.4, 30.0, 0)
    c.trees(edge((0, 22.2), (84, 22.2), 1), (47.4, 56.8), 0.0, "broad")
    # picnic south of the diagonal
    for x, y, turn in ((28.2, 9.6, 20.0), (32.6, 8.9, -15.0), (35.4, 15.4, 40.0)):
        c.put("picnic table", x, y, turn)
    c.put("barbecue grill", 30.6, 11.2, 60.0, 0)
    c.put("picnic basket", 26.4, 8.2, 0.0)
    c.put("beach chair", 36.0, 9.6, 120.0, 1)
    c.put("hammock", 32.0, 14.2, 50.0, 0)
    c.put("kite", 37.0, 13.2, 20.0, 0)
    c.put("football", 23.4, 12.0, 0.0)
    c.put("tree", 30.2, 7.3, 10.0, size=(5.3, 5.5, 6.6))
    c.put("tree", 35.6, 12.0, 70.0, size=(4.36, 4.04, 4.89))
    people(
        c,
        [
            ("pedestrian adult", 31.4, 12.0, -120.0),
            ("pedestrian adult", 24.4, 11.4, 140.0),
            ("pedestrian child", 22.4, 10.6, 30.0),
            ("pedestrian child", 36.6, 14.2, 250.0),
        ],
    )
    # lawn in the north-west corner of the crossing
    c.put("picnic table", 32.6, 32.0, 10.0)
    c.put("picnic table", 35.0, 36.6, 70.0)
    c.put("tree", 29.6, 35.0, 80.0, size=(5.3, 5.5, 6.6))
    c.put("flower", 30.6, 29.2, 0.0, 0)
    c.put("guitar", 31.2, 30.4, 20.0)
    c.put("pedestrian adult", 30.9, 33.2, -20.0)


def _bandstand(c: Canvas) -> None:
    c.put("stage", 11.6, 19.0, 0.0, 2)
    c.put("drum", 14.6, 17.6, 0.0, 1)
    c.put("stereo sound system", 14.4, 21.4, 0.0, 1)
    c.put("stereo sound system", 14.4, 16.2, 0.0, 1)
    c.put("pedestrian adult", 15.4, 19.4, 0.0)
    c.put("pedestrian adult", 15.2, 20.6, -10.0)
    c.put("potted plant", 17.4, 15.6, 0.0, 0)
    for x, ys in ((23.0, (17.0, 18.4, 20.6, 22.0)), (25.0, (17.6, 19.6, 22.4))):
        for y in ys:
            c.put("chair", x, y, 180.0, 0)
    people(
        c,
        [
            ("pedestrian adult", 21.4, 20.6, 170.0),
            ("pedestrian child", 21.2, 19.8, 180.0),
            ("elderly person", 26.6, 21.0, 190.0),
        ],
    )
    c.put("canopy", 28.8, 22.4, 180.0, 0)
    c.put("advertising board", 20.2, 15.8, -40.0)
    c.put("wheelchair user", 27.0, 18.6, 175.0)


def _paths(c: Canvas) -> None:
    """Objects, people and animals on the paths."""
    c.put("sculpture", 39.5, 26.5, -90.0, 1)
    for x, y, turn in ((44.6, 29.6, -140.0), (34.4, 29.6, -40.0), (34.4, 23.4, 40.0), (44.9, 26.5, 180.0)):
        c.put("bench", x, y, turn, 0)
    c.put("kiosk", 42.6, 31.2, -120.0)
    c.put("trash bin", 36.2, 31.4, -60.0, 2)
    c.put("lamppost", 33.6, 26.5, 0.0, 0)
    for x, y in ((14.0, 6.6), (46.0, 6.6), (6.5, 30.0)):
        c.put("lamppost", x, y, 0.0, 0)
    for x, y in ((77.5, 14.0), (77.5, 42.0), (58.0, 50.5)):
        c.put("lamppost", x, y, 0.0, 0)
    # the branch over the north path, and workers sawing it up
    c.put("tree debris", 48.2, 48.0, 70.0, 2)
    c.put("tree debris", 50.6, 49.4, 10.0, 1)
    c.put("gardener", 46.0, 48.9, 0.0)
    c.put("barrow", 53.9, 49.4, 30.0, 0)
    c.put("traffic cone", 52.2, 48.2, 0.0, 0)
    c.put("traffic barricade", 44.0, 49.0, 180.0)
    c.put("lawn mower", 69.4, 24.0, 200.0, 0)
    c.put("gardener", 70.9, 24.4, 195.0)
    c.put("handcart", 75.8, 25.6, 170.0, 1)
    c.put("all-terrain vehicle", 79.0, 24.0, 90.0, 2)
    c.put("bicycle", 53.6, 26.9, 30.0)
    c.put("scooter", 49.8, 26.2, 70.0, 1)
    c.put("delivery robot", 40.2, 18.4, 90.0)
    c.put("robot dog", 39.0, 10.4, -80.0, 0)
    c.put("trash bin", 77.2, 7.2, 180.0, 0)
    c.put("bench", 22.0, 6.7, -90.0, 0)
    c.put("bench", 68.6, 6.7, -90.0, 0)
    c.put("bench", 81.5, 38.0, 180.0, 0)
    c.put("bench", 12.0, 46.5, 90.0, 0)
    c.put("mud patch", 13.0, 26.0, 20.0, 0)
    c.put("street food stall", 12.6, 4.2, 90.0, 0)
    c.put("advertising board", 15.4, 5.4, 180.0)
    c.put("public toilets", 74.6, 8.2, -90.0, 0)
    c.put("bicycle parking", 57.2, 4.0, -90.0, 0)
    c.put("bicycle", 58.6, 4.0, 85.0)
    people(
        c,
        [
            ("pedestrian adult", 12.4, 6.3, -90.0),
            ("pedestrian adult", 20.6, 2.2, 90.0),
            ("cyclist", 34.0, 5.0, 0.0),
            ("pedestrian adult", 46.4, 4.2, 180.0),
            ("wheelchair user", 64.4, 4.2, 170.0),
            ("pedestrian adult", 36.0, 26.0, 0.0),
            ("pedestrian child", 42.2, 23.6, 120.0),
            ("police officer", 42.6, 20.9, 200.0),
            ("horse", 20.4, 26.9, 0.0),
            ("elderly person", 64.8, 26.0, 170.0),
            ("unicycle", 38.2, 31.6, 90.0),
            ("bird", 41.6, 28.8, 20.0),
            ("squirrel", 27.0, 14.8, 40.0),
        ],
    )


def build() -> Canvas:
    c = blank(ID)
    _ground(c)
    _fronts(c)
    _edges(c)
    _dogs(c)
    _sports(c)
    _play(c)
    _bandstand(c)
    _paths(c)
    c.trajectory = [
        (2.0, -2.0),
        (42.0, -2.0),
        (42.0, 4.6),
        (20.0, 4.6),
        (20.8, 6.8),
        (28.4, 14.1),
        (36.2, 22.0),
        (30.0, 26.0),
    ]
    c.trajectory += [
        (12.0, 27.2),
        (4.4, 27.0),
        (4.4, 48.4),
        (30.0, 48.0),
        (39.4, 44.0),
        (39.4, 32.0),
        (52.0, 25.6),
        (76.0, 27.2),
    ]
    c.trajectory += [(79.4, 40.0), (76.0, 48.4), (79.6, 14.0), (70.0, 4.6), (42.0, 4.4), (42.0, -2.0), (42.0, -12.6)]
    return c
