"""Houses on one side, a small park with a fountain on the other (never trained on)."""

from .. import catalogue
from ..composer import LEFT, RIGHT, StreetComposer
from ..pieces import cafe_set, lane_paint, parked
from ..section import StreetSection

SECTION = StreetSection(
    length=72.0,
    carriageway=7.0,
    left=3.4,
    right=3.8,
    crosswalks=(18.0, 54.0),
    start="junction",
    left_park=12.0,
    yards=True,
)

OBJECTS = (
    ("fountain", 36.0, LEFT, 9.2, "street"),
    ("sculpture", 9.5, LEFT, 8.0, "street"),
    ("sculpture", 64.0, LEFT, 10.5, "street"),
    ("bench", 31.6, LEFT, 7.2, "wall"),
    ("bench", 40.4, LEFT, 7.2, "wall"),
    ("bench", 32.2, LEFT, 11.8, -120.0),
    ("bench", 39.8, LEFT, 11.8, -60.0),
    ("bench", 12.5, LEFT, 4.2, "street"),
    ("bench", 24.0, LEFT, 4.2, "street"),
    ("bench", 48.0, LEFT, 4.2, "street"),
    ("bench", 60.0, LEFT, 4.2, "street"),
    ("bench", 34.0, RIGHT, 3.4, "street"),
    ("trash bin", 25.6, LEFT, 4.2, "street"),
    ("trash bin", 46.2, LEFT, 4.2, "street"),
    ("trash bin", 9.0, RIGHT, 0.6, "wall"),
    ("picnic table", 20.0, LEFT, 10.0, 20.0),
    ("picnic table", 52.0, LEFT, 9.4, -15.0),
    ("picnic table", 56.6, LEFT, 12.2, 40.0),
    ("food truck", 27.0, LEFT, -1.55, "+x"),
    ("kiosk", 45.0, LEFT, 12.8, "street"),
    ("street food stall", 29.2, LEFT, 2.2, "wall"),
    ("bicycle parking", 14.0, LEFT, 0.9, "wall"),
    ("bicycle", 12.4, LEFT, 1.0, "wall"),
    ("bicycle", 11.7, LEFT, 1.0, "street"),
    ("bicycle", 51.0, RIGHT, 3.3, "+x"),
    ("scooter", 42.0, LEFT, 1.5, 50.0),
    ("scooter", 43.0, LEFT, 2.0, 100.0),
    ("scooter", 27.4, RIGHT, 1.2, 80.0),
    ("stroller", 46.0, LEFT, 2.4, "+x"),
    ("pedestrian adult", 44.9, LEFT, 2.4, "+x"),
    ("pedestrian child", 34.0, LEFT, 6.6, 30.0),
    ("pedestrian child", 38.0, LEFT, 6.4, 200.0),
    ("pedestrian adult", 36.6, LEFT, 5.8, 100.0),
    ("jogger", 22.0, LEFT, 1.8, "+x"),
    ("jogger", 63.0, LEFT, 2.2, "-x"),
    ("pedestrian adult", 29.6, LEFT, 4.0, "street"),
    ("elderly person", 11.0, LEFT, 3.5, 30.0),
    ("pedestrian adult", 58.0, LEFT, 7.0, 140.0),
    ("dog", 59.4, LEFT, 6.6, 200.0),
    ("dog", 17.0, LEFT, 8.2, 60.0),
    ("pedestrian adult", 15.6, LEFT, 8.6, -30.0),
    ("dog", 62.0, RIGHT, 1.5, "-x"),
    ("pedestrian adult", 61.0, RIGHT, 1.9, "-x"),
    ("pedestrian adult", 5.0, RIGHT, 2.0, "+x"),
    ("pedestrian adult", 23.0, RIGHT, 2.4, "-x"),
    ("pedestrian adult", 23.4, RIGHT, 1.7, "-x"),
    ("delivery worker", 44.2, RIGHT, 2.5, "wall"),
    ("parcels", 43.2, RIGHT, 2.6, 20.0),
    ("parcels", 44.6, RIGHT, 3.3, 70.0),
    ("wheelchair", 40.0, RIGHT, 1.8, "+x"),
    ("police officer", 50.4, LEFT, 2.2, "street"),
    ("bird", 33.0, LEFT, 5.4, 20.0),
    ("bird", 33.8, LEFT, 5.0, 90.0),
    ("bird", 39.4, LEFT, 5.2, 170.0),
    ("cat", 66.4, RIGHT, 3.3, 110.0),
    ("garbage bag", 9.7, RIGHT, 0.7, 20.0),
    ("garbage bag", 65.7, RIGHT, 1.3, 20.0),
    ("trash bin", 64.7, RIGHT, 1.0, "street"),
    ("advertising board", 30.8, RIGHT, 2.2, "+x"),
    ("advertising board", 58.4, RIGHT, 2.4, "-x"),
    ("mailbox", 69.4, RIGHT, 3.4, "street"),
    ("postbox", 14.6, RIGHT, 0.6, "wall"),
    ("fire hydrant", 49.9, RIGHT, 0.5, "street"),
    ("parking meter", 29.0, RIGHT, 0.4, "wall"),
    ("parking meter", 42.0, RIGHT, 0.4, "wall"),
    ("speed limit sign 30 km", 2.0, RIGHT, 0.45, "-x"),
    ("directional sign", 2.4, LEFT, 0.5, "-x"),
    ("stop sign", 0.8, LEFT, 0.4, "+x"),
    ("rock", 6.4, LEFT, 11.0, 30.0),
    ("rock", 68.0, LEFT, 7.6, 80.0),
    ("manhole cover", 33.0, RIGHT, -2.6, "+x"),
)

HEDGE = (4.1, 6.4, 8.7, 62.8, 65.1, 67.4)
FLOWERS = ((33.0, 7.9), (33.2, 10.6), (39.0, 7.9), (38.8, 10.6), (8.4, 7.2), (10.6, 7.2), (62.8, 9.6), (65.2, 9.6))


def build() -> StreetComposer:
    street = StreetComposer("park_edge", SECTION, seed=606)
    street.facades(RIGHT, ("house", "apartment building", "cafe", "hotel", "bakery", "school", "apartment building"))
    street.facades(
        LEFT, ("house", "house", "apartment building", "house", "house", "apartment building", "house", "house")
    )
    street.close_view(("apartment building", "school", "office building", "house"), at_end=False)
    street.close_view(("hotel", "house", "restaurant"), at_end=True)
    street.trees((7.0, 21.4, 32.5, 40.5, 49.0, 61.0, 68.5), LEFT, 0.7, "blossom")
    street.trees((5.5, 14.5, 27.0, 45.5, 67.0), LEFT, 6.6, "broad")
    street.trees((4.0, 12.0, 24.0, 49.5, 60.5, 69.0), LEFT, 11.9, "broad")
    street.trees((7.0, 24.8, 37.0, 47.9, 63.6), RIGHT, 0.65)
    street.row("street light", (11.2, 27.6, 44.8, 66.8), RIGHT, 0.4)
    street.row("lamppost", (9.8, 26.4, 37.4, 58.2), LEFT, 0.55)
    street.row("bollard", (15.2, 20.8, 51.2, 56.8), LEFT, 0.35)
    street.row("bollard", (15.2, 20.8, 51.2, 56.8), RIGHT, 0.35)
    street.row("fence", (1.6, 70.4), LEFT, 3.6, "street")
    street.row("shrub", HEDGE, LEFT, 4.0, "street", size=catalogue.HEDGE)
    for x, from_kerb in FLOWERS:
        street.put("flower", x, LEFT, from_kerb, street.uniform(-180.0, 180.0))
    for x in (30.6, 33.2):
        cafe_set(street, x + 8.0, RIGHT, 3.2, 2)
    street.row("potted plant", (11.0, 27.8, 57.0), RIGHT, 3.4)
    parked(street, (("hatchback car", 6.0), ("suv", 12.0), ("sedan", 25.0), ("minivan", 31.4), ("sedan", 44.0)), RIGHT)
    parked(street, (("van", 61.0), ("hatchback car", 66.6)), RIGHT)
    street.put_all(OBJECTS)
    street.scatter(("pedestrian adult", "scooter", "bicycle", "plant pot"), 5, LEFT, (2.0, 70.0), (0.6, 2.8))
    street.scatter(("pedestrian adult", "garbage bag", "plant pot", "storage box"), 5, RIGHT, (2.0, 70.0), (0.6, 2.8))
    street.scatter(("rock", "shrub", "grass patch", "flower"), 10, LEFT, (2.0, 70.0), (5.0, 14.0))
    lane_paint(street, 0.0)
    return street
