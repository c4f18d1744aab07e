"""A shopping street with a bicycle lane, a bus stop and market stalls (never trained on)."""

from .. import section
from ..composer import LEFT, RIGHT, StreetComposer
from ..pieces import cafe_set, lane_paint, parked
from ..section import StreetSection

SECTION = StreetSection(length=76.0, carriageway=9.0, left=4.8, right=3.8, crosswalks=(22.0, 58.0), end="junction")
BIKE_LANE = 1.9  # m, between the left kerb and the traffic (NACTO: 1.5 m at least, plus a buffer)

OBJECTS = (
    ("bus", 38.0, RIGHT, -1.5, "+x"),
    ("bus shelter", 40.0, RIGHT, 2.7, "street"),
    ("directional sign", 44.5, RIGHT, 0.6, "+x"),
    ("trash bin", 35.4, RIGHT, 3.3, "street"),
    ("bench", 47.6, RIGHT, 3.2, "street"),
    ("pedestrian adult", 36.0, RIGHT, 1.2, "street"),
    ("pedestrian adult", 37.3, RIGHT, 0.4, 100.0),
    ("pedestrian adult", 42.8, RIGHT, 1.7, "street"),
    ("elderly person", 40.6, RIGHT, 0.35, "+x"),
    ("street food stall", 8.0, LEFT, 1.25, "wall"),
    ("street food stall", 12.6, LEFT, 1.25, "wall"),
    ("street food stall", 33.0, LEFT, 1.25, "wall"),
    ("street food stall", 37.4, LEFT, 1.25, "wall"),
    ("kiosk", 66.8, LEFT, 1.7, "wall"),
    ("storage box", 10.3, LEFT, 1.1, 10.0),
    ("storage box", 10.4, LEFT, 1.8, 70.0),
    ("storage box", 35.2, LEFT, 1.3, 30.0),
    ("parcels", 14.9, LEFT, 1.7, 15.0),
    ("pedestrian adult", 8.3, LEFT, 2.95, "street"),
    ("pedestrian adult", 13.0, LEFT, 2.95, "street"),
    ("pedestrian child", 13.9, LEFT, 2.8, "street"),
    ("pedestrian adult", 32.6, LEFT, 2.95, "street"),
    ("pedestrian adult", 37.6, LEFT, 2.95, "street"),
    ("pedestrian adult", 46.0, LEFT, 2.2, "+x"),
    ("pedestrian adult", 54.0, LEFT, 2.8, "-x"),
    ("pedestrian adult", 53.0, LEFT, 3.3, "-x"),
    ("jogger", 63.0, LEFT, 2.2, "-x"),
    ("pedestrian adult", 4.5, RIGHT, 1.8, "+x"),
    ("pedestrian adult", 16.5, RIGHT, 1.4, "-x"),
    ("pedestrian adult", 27.2, RIGHT, 1.9, "+x"),
    ("wheelchair", 52.6, RIGHT, 1.6, "+x"),
    ("pedestrian adult", 63.8, RIGHT, 1.9, "-x"),
    ("police officer", 71.5, RIGHT, 1.2, "street"),
    ("pedestrian adult", 22.4, LEFT, -3.4, "street"),
    ("cyclist", 30.2, LEFT, -0.95, "-x"),
    ("cyclist", 49.4, LEFT, -0.95, "-x"),
    ("delivery worker", 27.8, LEFT, 2.0, "-x"),
    ("delivery robot", 51.4, LEFT, 1.7, "-x"),
    ("bicycle parking", 45.2, LEFT, 0.9, "wall"),
    ("bicycle parking", 48.2, LEFT, 0.9, "wall"),
    ("bicycle", 43.6, LEFT, 1.0, "wall"),
    ("bicycle", 46.7, LEFT, 1.0, "street"),
    ("bicycle", 49.9, LEFT, 1.0, "wall"),
    ("bicycle", 30.3, RIGHT, 3.2, "+x"),
    ("scooter", 19.0, RIGHT, 2.4, 70.0),
    ("scooter", 69.3, LEFT, 3.0, 120.0),
    ("advertising board", 5.4, LEFT, 3.6, "+x"),
    ("advertising board", 29.2, LEFT, 4.2, "-x"),
    ("advertising board", 42.0, LEFT, 3.5, "+x"),
    ("advertising board", 10.6, RIGHT, 2.3, "-x"),
    ("advertising board", 49.8, RIGHT, 2.0, "+x"),
    ("advertising board", 67.0, RIGHT, 2.4, "-x"),
    ("charging station", 70.6, RIGHT, 0.5, "street"),
    ("parking meter", 9.0, RIGHT, 0.4, "wall"),
    ("postbox", 17.2, LEFT, 0.7, "wall"),
    ("newspaper stand", 61.8, LEFT, 0.7, "wall"),
    ("vending machine", 31.8, RIGHT, 3.3, "street"),
    ("fire hydrant", 65.4, RIGHT, 0.5, "street"),
    ("traffic light", 19.4, RIGHT, 0.45, "-x"),
    ("traffic light", 24.6, LEFT, 0.45, "+x"),
    ("traffic light", 55.4, RIGHT, 0.45, "-x"),
    ("traffic light", 60.6, LEFT, 0.45, "+x"),
    ("no parking sign", 28.8, RIGHT, 0.4, "-x"),
    ("dog", 46.9, LEFT, 2.7, "+x"),
    ("bird", 70.0, LEFT, 2.2, 40.0),
    ("manhole cover", 30.0, RIGHT, -3.0, "+x"),
    ("manhole cover", 44.0, LEFT, 2.8, "+x"),
)


def build() -> StreetComposer:
    street = StreetComposer("commercial_bike_lane", SECTION, seed=505)
    street.facades(
        LEFT,
        (
            "supermarket",
            "flower shop",
            "bakery",
            "office building",
            "pharmacy",
            "restaurant",
            "clothing store",
            "bookstore",
        ),
    )
    street.facades(
        RIGHT,
        ("convenience store", "hotel", "hair salon", "bank", "cafe", "clothing store", "apartment building", "bar"),
    )
    street.close_view(("school",), at_end=False)
    street.close_view(("office building", "hotel", "apartment building"), at_end=True)
    street.trees((3.0, 15.9, 28.0, 41.0, 53.6, 63.0, 72.2), LEFT, 0.75)
    street.trees((6.2, 14.0, 31.4, 50.6, 61.4, 69.4), RIGHT, 0.65, "slim")
    street.row("street light", (5.8, 31.0, 51.2, 69.0), LEFT, 0.4)
    street.row("street light", (2.6, 26.6, 46.0, 73.6), RIGHT, 0.4)
    street.row(
        "bollard", (4.0, 8.0, 12.0, 16.0, 28.0, 33.0, 39.0, 44.0, 52.5, 64.0, 68.0, 72.0), LEFT, -BIKE_LANE - 0.25
    )
    for x in (49.0, 51.8, 54.4):
        cafe_set(street, x, LEFT, 4.15, 2)
    cafe_set(street, 33.6, RIGHT, 3.2, 2)
    street.row("potted plant", (19.0, 25.4, 56.4, 61.4), LEFT, 4.35)
    street.row("plant pot", (7.4, 21.0, 59.0), RIGHT, 3.35)
    parked(street, (("hatchback car", 5.6), ("sedan", 11.6), ("van", 65.4), ("taxi", 71.6)), RIGHT)
    street.put_all(OBJECTS)
    street.scatter(("pedestrian adult", "scooter", "parcels", "pedestrian adult"), 5, LEFT, (2.0, 74.0), (1.6, 3.8))
    street.scatter(("pedestrian adult", "bicycle", "garbage bag", "plant pot"), 4, RIGHT, (2.0, 74.0), (0.9, 2.8))
    edge = street.y_at(LEFT, -BIKE_LANE)
    for i, (x0, x1) in enumerate(((0.0, 20.0), (24.0, 56.0), (60.0, 76.0))):
        street.paint([section.line(f"bike_lane_{i}", x0, x1, edge - 0.1, edge + 0.1)])
    lane_paint(street, -0.9)
    return street
