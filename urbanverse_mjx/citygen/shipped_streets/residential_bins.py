"""A residential street on collection day: houses, parked cars, bins and bags left on narrow pavements."""

from ..composer import LEFT, RIGHT, StreetComposer
from ..pieces import bay_lines, lane_paint, parked, rubbish
from ..section import StreetSection

SECTION = StreetSection(
    length=70.0, carriageway=8.4, left=3.2, right=3.4, crosswalks=(16.0, 52.0), end="junction", yards=True
)

OBJECTS = (
    ("fire hydrant", 21.0, RIGHT, 0.5, "street"),
    ("street cabinet", 34.5, RIGHT, 3.1, "street"),
    ("postbox", 12.0, RIGHT, 0.55, "wall"),
    ("mailbox", 29.5, LEFT, 2.85, "street"),
    ("mailbox", 62.5, LEFT, 2.85, "street"),
    ("stop sign", 69.3, RIGHT, 0.45, "-x"),
    ("speed limit sign 30 km", 1.5, RIGHT, 0.45, "-x"),
    ("no parking sign", 41.6, LEFT, 0.4, "+x"),
    ("bench", 41.0, LEFT, 2.8, "street"),
    ("bench", -2.9, RIGHT, -3.0, "+x"),
    ("storage box", 26.4, LEFT, 2.5, 20.0),
    ("parcels", 25.6, LEFT, 2.85, 100.0),
    ("stroller", 44.5, RIGHT, 1.5, "+x"),
    ("pedestrian adult", 43.3, RIGHT, 1.5, "+x"),
    ("pedestrian adult", 6.0, LEFT, 1.7, "+x"),
    ("pedestrian child", 6.2, LEFT, 2.4, "+x"),
    ("elderly person", 57.4, LEFT, 1.3, "-x"),
    ("pedestrian adult", 33.0, LEFT, 1.1, 200.0),
    ("pedestrian adult", 31.9, LEFT, 1.5, 20.0),
    ("dog", 34.3, LEFT, 0.75, 160.0),
    ("jogger", 27.0, RIGHT, 1.8, "+x"),
    ("delivery worker", 24.6, LEFT, 2.6, "wall"),
    ("cat", 61.0, RIGHT, 2.9, 60.0),
    ("bicycle", 38.3, LEFT, 2.75, "+x"),
    ("bicycle", 9.2, RIGHT, 2.95, "-x"),
    ("scooter", 47.8, RIGHT, 1.75, 75.0),
    ("wheelchair", 65.0, RIGHT, 1.7, "-x"),
    ("plant pot", 19.6, LEFT, 2.85, "street"),
    ("plant pot", 22.9, LEFT, 2.85, "street"),
    ("potted plant", 55.6, RIGHT, 3.05, "street"),
    ("potted plant", 58.6, RIGHT, 3.05, "street"),
    ("manhole cover", 30.0, RIGHT, -4.9, "+x"),
    ("manhole cover", 49.0, LEFT, 1.6, "+x"),
)


def build() -> StreetComposer:
    street = StreetComposer("residential_bins", SECTION, seed=101)
    street.facades(
        LEFT, ("house", "apartment building", "house", "house", "garage", "apartment building", "house", "house")
    )
    street.facades(
        RIGHT, ("apartment building", "house", "house", "apartment building", "garage", "house", "apartment building")
    )
    street.close_view(("house", "apartment building"), at_end=False)
    street.close_view(("house", "apartment building", "house", "house"), at_end=True)
    street.trees((4.0, 11.0, 23.5, 30.0, 38.5, 48.8, 59.5, 66.5), LEFT, 0.6, "blossom")
    street.trees((7.5, 25.0, 33.0, 41.0, 58.0), RIGHT, 0.6, "slim")
    street.row("street light", (8.0, 28.0, 44.0, 63.5), LEFT, 0.45, "street")
    street.row("utility pole", (2.8, 37.5, 66.0), RIGHT, 0.4, "street")
    parked(street, (("hatchback car", 4.5), ("sedan", 10.5), ("suv", 22.5), ("minivan", 28.6), ("sedan", 36.0)), RIGHT)
    parked(street, (("hatchback car", 42.0), ("pickup truck", 47.0), ("sedan", 58.4), ("van", 65.5)), RIGHT)
    parked(
        street,
        (("suv", 8.5), ("hatchback car", 24.0), ("sedan", 34.0), ("hatchback car", 45.2), ("minivan", 62.0)),
        LEFT,
    )
    rubbish(street, 13.0, RIGHT, 2.9, bags=2)
    rubbish(street, 23.2, RIGHT, 1.3, bags=3)
    rubbish(street, 38.2, RIGHT, 2.2, bags=2)
    rubbish(street, 61.5, RIGHT, 1.0, bags=3)
    rubbish(street, 9.8, LEFT, 2.5, bags=2)
    rubbish(street, 36.0, LEFT, 1.0, bags=2)
    rubbish(street, 46.0, LEFT, 2.5, bags=3)
    rubbish(street, 61.5, LEFT, 0.9, bags=2)
    street.put_all(OBJECTS)
    street.scatter(("garbage bag", "storage box", "trash bin"), 7, RIGHT, (2.0, 68.0), (0.5, 3.0))
    street.scatter(("garbage bag", "parcels", "trash bin"), 6, LEFT, (2.0, 68.0), (0.5, 2.8))
    bay_lines(street, (1.5, 7.5, 13.0, 19.6, 25.6, 32.2, 39.2, 44.4, 49.8, 55.4, 61.8, 68.8), RIGHT)
    lane_paint(street, 0.0)
    return street
