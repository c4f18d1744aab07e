"""A bar street in a tourist quarter: scooters and vehicles on the pavement, crowds at the doors."""

from ..composer import LEFT, RIGHT, StreetComposer
from ..pieces import cafe_set, lane_paint, rubbish
from ..section import StreetSection

SECTION = StreetSection(length=68.0, carriageway=6.4, left=3.8, right=4.4, crosswalks=(20.0, 50.0))

#: Carelessly parked scooters: across the pavement, in groups of two or three.
SCOOTERS = (
    (6.2, LEFT, 1.0, 35.0),
    (9.4, LEFT, 1.5, 100.0),
    (10.3, LEFT, 1.4, 80.0),
    (26.8, LEFT, 1.1, 170.0),
    (33.5, LEFT, 1.8, 60.0),
    (34.4, LEFT, 2.4, 140.0),
    (55.4, LEFT, 1.2, 20.0),
    (61.0, LEFT, 2.0, 95.0),
    (8.2, RIGHT, 1.2, 110.0),
    (15.2, RIGHT, 2.3, 30.0),
    (27.2, RIGHT, 2.2, 75.0),
    (28.0, RIGHT, 2.0, 95.0),
    (38.6, RIGHT, 2.5, 160.0),
    (45.4, RIGHT, 1.4, 50.0),
    (57.0, RIGHT, 1.6, 120.0),
    (65.0, RIGHT, 2.2, 85.0),
)

OBJECTS = (
    ("hatchback car", 31.0, RIGHT, 0.98, "+x"),
    ("van", 60.6, RIGHT, 1.05, "+x"),
    ("sedan", 13.6, LEFT, 0.95, "-x"),
    ("motorcycle", 28.6, LEFT, 0.75, 75.0),
    ("motorcycle", 29.8, LEFT, 0.75, 80.0),
    ("motorcycle", 31.0, LEFT, 0.75, 70.0),
    ("motorcycle", 41.0, RIGHT, 0.8, 250.0),
    ("motorcycle", 42.2, RIGHT, 0.8, 255.0),
    ("motorcycle", 64.2, LEFT, 0.8, 100.0),
    ("taxi", 42.5, LEFT, -1.1, "-x"),
    ("police car", 38.0, RIGHT, -1.15, "+x"),
    ("tricycle", 56.5, LEFT, -1.0, "-x"),
    ("food truck", 6.8, RIGHT, -1.55, "-x"),
    ("advertising board", 24.6, LEFT, 2.3, "+x"),
    ("advertising board", 46.2, LEFT, 2.0, "-x"),
    ("advertising board", 12.0, RIGHT, 2.8, "-x"),
    ("advertising board", 36.0, RIGHT, 2.6, "+x"),
    ("advertising board", 54.6, RIGHT, 2.9, "+x"),
    ("kiosk", -2.4, RIGHT, -3.2, "+x"),
    ("street food stall", 24.6, RIGHT, 1.3, "wall"),
    ("directional sign", 23.2, LEFT, 0.45, "+x"),
    ("directional sign", 47.2, RIGHT, 0.45, "-x"),
    ("trash bin", 24.4, LEFT, 0.6, "wall"),
    ("trash bin", 44.0, RIGHT, 0.6, "wall"),
    ("fire hydrant", 36.6, LEFT, 0.45, "street"),
    ("telephone booth", 35.3, RIGHT, 0.85, "wall"),
    ("pedestrian adult", 4.2, LEFT, 2.0, "+x"),
    ("pedestrian adult", 18.6, LEFT, 2.6, 210.0),
    ("pedestrian adult", 17.8, LEFT, 2.2, 30.0),
    ("pedestrian adult", 27.8, LEFT, 3.35, "-x"),
    ("pedestrian adult", 38.6, LEFT, 1.6, "+x"),
    ("pedestrian adult", 38.9, LEFT, 2.2, "+x"),
    ("pedestrian adult", 52.8, LEFT, 2.8, 300.0),
    ("pedestrian adult", 53.9, LEFT, 3.0, 120.0),
    ("pedestrian adult", 58.8, LEFT, 1.5, "-x"),
    ("pedestrian adult", 3.2, RIGHT, 1.8, "+x"),
    ("pedestrian adult", 22.5, RIGHT, 1.6, "+x"),
    ("pedestrian child", 22.3, RIGHT, 0.9, "+x"),
    ("pedestrian adult", 33.7, RIGHT, 1.0, "-x"),
    ("pedestrian adult", 40.6, RIGHT, 2.2, 330.0),
    ("pedestrian adult", 41.5, RIGHT, 2.0, 160.0),
    ("pedestrian adult", 48.0, RIGHT, 2.2, "-x"),
    ("elderly person", 55.9, RIGHT, 2.4, "+x"),
    ("police officer", 36.4, RIGHT, -2.8, "-x"),
    ("cyclist", 30.0, LEFT, -1.6, "-x"),
    ("dog", 59.8, LEFT, 1.9, "-x"),
    ("cat", 2.0, LEFT, 3.4, 70.0),
    ("bird", 20.8, RIGHT, 3.6, 10.0),
    ("bird", 63.8, LEFT, 3.2, 200.0),
    ("manhole cover", 34.0, LEFT, -3.0, "+x"),
    ("guard stone", 17.4, LEFT, 0.35, "+x"),
    ("guard stone", 22.6, LEFT, 0.35, "+x"),
    ("guard stone", 47.4, LEFT, 0.35, "+x"),
    ("guard stone", 52.6, LEFT, 0.35, "+x"),
    ("guard stone", 17.4, RIGHT, 0.35, "+x"),
    ("guard stone", 52.6, RIGHT, 0.35, "+x"),
)


def build() -> StreetComposer:
    street = StreetComposer("tourist_scooters", SECTION, seed=404)
    street.facades(LEFT, ("bar", "hotel", "restaurant", "bar", "bar", "hair salon", "restaurant", "bar", "cafe"))
    street.facades(RIGHT, ("restaurant", "bar", "cafe", "bar", "hotel", "bar", "restaurant", "bakery", "bar"))
    street.close_view(("hotel",), at_end=False)
    street.close_view(("restaurant", "bar"), at_end=True)
    street.row("lamppost", (7.8, 16.2, 26.0, 44.6, 54.0, 66.0), LEFT, 0.5)
    street.row("lamppost", (5.6, 15.6, 26.6, 37.2, 46.2, 66.4), RIGHT, 0.5)
    street.trees((3.2, 40.2, 57.2), LEFT, 0.7, "palm")
    street.trees((2.2, 12.3, 54.2), RIGHT, 0.7, "palm")
    for x, side in ((5.0, RIGHT), (19.0, RIGHT), (43.4, RIGHT), (51.6, RIGHT)):
        cafe_set(street, x, side, 3.7, 2)
    for x in (7.0, 31.4, 42.6, 49.0):
        cafe_set(street, x, LEFT, 3.4, 2)
    street.row("potted plant", (21.0, 36.4, 57.8), LEFT, 3.4)
    street.row("plant pot", (10.4, 34.2, 47.6), RIGHT, 4.0)
    rubbish(street, 59.9, LEFT, 0.7, bags=2)
    rubbish(street, 68.5, RIGHT, 3.9, bags=3)
    for x, side, from_kerb, facing in SCOOTERS:
        street.put("scooter", x, side, from_kerb, facing)
    street.put_all(OBJECTS)
    street.scatter(("scooter", "garbage bag", "pedestrian adult", "chair"), 5, LEFT, (2.0, 66.0), (0.5, 3.0))
    street.scatter(("scooter", "bicycle", "pedestrian adult", "chair"), 5, RIGHT, (2.0, 66.0), (0.5, 3.5))
    lane_paint(street, 0.0)
    return street
