"""A shopping street: cafe tables, boards, racks and people on wide pavements."""

from ..composer import LEFT, RIGHT, StreetComposer
from ..pieces import bay_lines, cafe_set, lane_paint, parked
from ..section import StreetSection

SECTION = StreetSection(length=72.0, carriageway=7.4, left=5.0, right=4.2, crosswalks=(14.0, 46.0), start="junction")

OBJECTS = (
    ("advertising board", 6.8, LEFT, 3.4, "+x"),
    ("advertising board", 21.0, LEFT, 2.3, "-x"),
    ("advertising board", 41.5, LEFT, 3.4, "+x"),
    ("advertising board", 63.5, LEFT, 2.6, 15.0),
    ("advertising board", 9.5, RIGHT, 2.6, "+x"),
    ("advertising board", 34.0, RIGHT, 2.2, "-x"),
    ("advertising board", 59.0, RIGHT, 3.0, "+x"),
    ("bicycle parking", 31.0, LEFT, 1.3, "wall"),
    ("bicycle", 29.3, LEFT, 1.4, "wall"),
    ("bicycle", 32.7, LEFT, 1.4, "street"),
    ("bicycle", 55.6, RIGHT, 1.1, "wall"),
    ("bicycle parking", 53.8, RIGHT, 1.1, "wall"),
    ("bench", 24.5, RIGHT, 0.75, "wall"),
    ("bench", 38.0, RIGHT, 0.75, "wall"),
    ("bench", 57.0, LEFT, 0.8, "wall"),
    ("trash bin", 26.2, RIGHT, 0.7, "wall"),
    ("trash bin", 39.8, LEFT, 0.7, "wall"),
    ("trash bin", 58.6, LEFT, 0.75, "wall"),
    ("newspaper stand", 18.2, LEFT, 0.7, "wall"),
    ("newspaper stand", 18.9, LEFT, 0.7, "wall"),
    ("telephone booth", 50.2, LEFT, 0.9, "wall"),
    ("parking meter", 20.5, RIGHT, 0.4, "wall"),
    ("parking meter", 35.0, RIGHT, 0.4, "wall"),
    ("parking meter", 62.0, RIGHT, 0.4, "wall"),
    ("vending machine", 66.5, LEFT, 4.5, "street"),
    ("vending machine", 67.6, LEFT, 4.5, "street"),
    ("postbox", 8.2, RIGHT, 0.6, "wall"),
    ("fire hydrant", 43.0, RIGHT, 0.5, "street"),
    ("traffic light", 11.3, RIGHT, 0.45, "-x"),
    ("traffic light", 16.7, LEFT, 0.45, "+x"),
    ("traffic light", 43.4, RIGHT, 0.45, "-x"),
    ("traffic light", 48.6, LEFT, 0.45, "+x"),
    ("no parking sign", 28.0, LEFT, 0.4, "+x"),
    ("directional sign", 3.0, LEFT, 0.5, "-x"),
    ("pedestrian adult", 11.0, LEFT, 2.1, "+x"),
    ("pedestrian adult", 11.3, LEFT, 2.95, "+x"),
    ("pedestrian adult", 27.6, LEFT, 1.6, "-x"),
    ("pedestrian adult", 44.0, LEFT, 1.8, 230.0),
    ("pedestrian child", 43.2, LEFT, 1.8, 250.0),
    ("pedestrian adult", 60.4, LEFT, 2.5, "-x"),
    ("pedestrian adult", 5.0, RIGHT, 1.7, "+x"),
    ("elderly person", 21.0, RIGHT, 2.1, "-x"),
    ("pedestrian adult", 30.6, RIGHT, 1.5, 40.0),
    ("pedestrian adult", 31.5, RIGHT, 2.0, 215.0),
    ("pedestrian adult", 49.6, RIGHT, 1.8, "-x"),
    ("pedestrian adult", 64.5, RIGHT, 1.6, "+x"),
    ("pedestrian adult", 14.3, RIGHT, -2.4, "street"),
    ("delivery worker", 56.0, LEFT, 3.8, "wall"),
    ("handcart", 55.0, LEFT, 2.9, "+x"),
    ("dog", 61.4, LEFT, 2.0, "-x"),
    ("bird", 69.0, RIGHT, 1.5, 30.0),
    ("bird", 69.7, RIGHT, 1.9, 140.0),
    ("stroller", 50.8, RIGHT, 1.8, "-x"),
    ("delivery robot", 36.4, LEFT, 2.2, "+x"),
    ("manhole cover", 33.0, RIGHT, -2.6, "+x"),
    ("manhole cover", 25.0, LEFT, 2.2, "+x"),
)


def build() -> StreetComposer:
    street = StreetComposer("commercial_cafes", SECTION, seed=202)
    street.facades(
        LEFT, ("bookstore", "cafe", "clothing store", "restaurant", "bakery", "pharmacy", "cafe", "bank", "hair salon")
    )
    street.facades(
        RIGHT, ("supermarket", "flower shop", "clothing store", "hotel", "cafe", "convenience store", "office building")
    )
    street.close_view(("office building", "bank", "apartment building"), at_end=False)
    street.close_view(("hotel", "cafe"), at_end=True)
    street.trees((6.0, 22.5, 35.5, 54.0, 62.9, 70.0), LEFT, 0.75)
    street.trees((3.0, 19.0, 29.0, 41.0, 51.2, 66.5), RIGHT, 0.7)
    street.row("lamppost", (9.6, 26.2, 42.4, 60.4), LEFT, 0.55)
    street.row("lamppost", (6.2, 32.0, 57.8, 70.5), RIGHT, 0.55)
    street.row("bollard", (10.4, 11.0, 17.2, 17.8), LEFT, 0.35)
    street.row("bollard", (42.3, 49.2, 49.9), RIGHT, 0.35)
    for x, chairs in ((5.2, 2), (7.8, 3), (23.4, 3), (26.0, 2)):
        cafe_set(street, x + 3.0, LEFT, 4.05 - 0.35 * (chairs - 2), chairs)
    for x, shade in ((50.4, True), (53.0, False)):
        cafe_set(street, x, LEFT, 3.7, 2, shade)
    for x in (37.0, 39.6, 42.4):
        cafe_set(street, x, RIGHT, 3.35, 2)
    street.row("potted plant", (12.6, 20.2, 34.6, 46.4), LEFT, 4.6)
    street.row("potted plant", (13.6, 18.4, 45.8, 56.8), RIGHT, 3.85)
    parked(street, (("sedan", 22.5), ("taxi", 28.5), ("suv", 34.4), ("van", 56.5), ("hatchback car", 62.6)), RIGHT)
    street.put_all(OBJECTS)
    street.scatter(("pedestrian adult", "plant pot", "scooter", "pedestrian adult"), 5, LEFT, (2.0, 70.0), (1.2, 3.2))
    street.scatter(
        ("pedestrian adult", "bicycle", "storage box", "pedestrian adult"), 4, RIGHT, (2.0, 70.0), (1.0, 2.8)
    )
    bay_lines(street, (19.4, 25.4, 31.4, 37.4, 53.2, 59.8, 65.4), RIGHT)
    lane_paint(street, 0.9)
    return street
