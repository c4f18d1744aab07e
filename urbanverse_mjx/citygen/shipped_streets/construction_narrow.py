"""A street under repair: fences, barriers and cones narrow both pavements."""

from ..composer import LEFT, RIGHT, StreetComposer
from ..pieces import lane_paint, parked
from ..section import StreetSection

SECTION = StreetSection(length=64.0, carriageway=7.0, left=3.6, right=3.0, crosswalks=(12.0, 50.0), end="junction")

OBJECTS = (
    ("road work detour ahead sign", 9.2, RIGHT, 0.65, "-x"),
    ("road work detour ahead sign", 17.0, LEFT, -1.0, "-x"),
    ("road work detour ahead sign", 58.5, LEFT, 1.0, "+x"),
    ("truck", 27.0, LEFT, -1.6, "+x"),
    ("pickup truck", 36.5, LEFT, -1.5, "-x"),
    ("dumpster", 21.0, LEFT, -1.2, "street"),
    ("traffic barricade", 16.0, LEFT, -1.0, "-x"),
    ("traffic barricade", 16.0, LEFT, -2.7, "-x"),
    ("traffic barricade", 43.8, LEFT, -1.0, "+x"),
    ("traffic barricade", 43.9, LEFT, -2.7, "+x"),
    ("traffic barricade", 21.6, RIGHT, 0.75, "-x"),
    ("traffic barricade", 36.0, RIGHT, 0.75, "+x"),
    ("traffic barricade", 29.2, LEFT, 0.9, 80.0),
    ("storage box", 24.5, LEFT, 0.7, 10.0),
    ("storage box", 25.2, LEFT, 0.8, 60.0),
    ("storage box", 38.6, LEFT, 0.6, 0.0),
    ("parcels", 31.0, RIGHT, 0.6, 30.0),
    ("rock", 26.5, RIGHT, 0.6, 40.0),
    ("rock", 28.0, RIGHT, 0.6, 110.0),
    ("handcart", 33.2, RIGHT, 0.75, "+x"),
    ("handcart", 41.9, LEFT, 0.7, 70.0),
    ("construction worker", 24.0, RIGHT, 0.7, 60.0),
    ("construction worker", 31.6, LEFT, -0.6, "street"),
    ("construction worker", 32.0, LEFT, -1.5, 200.0),
    ("construction worker", 34.7, RIGHT, 0.6, 120.0),
    ("construction worker", 43.3, LEFT, 0.5, 250.0),
    ("police officer", 15.0, RIGHT, 0.6, "street"),
    ("pedestrian adult", 5.5, LEFT, 1.8, "+x"),
    ("pedestrian adult", 19.5, RIGHT, 2.2, "-x"),
    ("pedestrian adult", 48.0, LEFT, 3.25, "-x"),
    ("pedestrian adult", 56.0, RIGHT, 1.5, "-x"),
    ("elderly person", 60.9, RIGHT, 2.55, "+x"),
    ("pedestrian adult", 53.5, LEFT, 2.6, "-x"),
    ("delivery robot", 46.3, RIGHT, 1.8, "+x"),
    ("trash bin", 4.0, RIGHT, 0.6, "wall"),
    ("trash bin", 54.0, LEFT, 0.6, "wall"),
    ("garbage bag", 4.65, RIGHT, 0.6, 10.0),
    ("garbage bag", 5.6, RIGHT, 0.9, 80.0),
    ("dumpster", 45.0, LEFT, 2.85, "street"),
    ("street cabinet", 17.5, RIGHT, 2.7, "street"),
    ("street cabinet", 55.0, RIGHT, 2.7, "street"),
    ("fire hydrant", 40.4, RIGHT, 0.45, "street"),
    ("parking meter", 57.5, RIGHT, 0.4, "wall"),
    ("bench", 58.0, LEFT, 3.1, "street"),
    ("bicycle", 40.4, RIGHT, 2.6, "+x"),
    ("scooter", 48.3, LEFT, 0.7, 100.0),
    ("do not enter sign", 14.6, LEFT, 0.4, "-x"),
    ("no parking sign", 20.6, RIGHT, 0.35, "-x"),
    ("stop sign", 63.2, RIGHT, 0.4, "-x"),
    ("potted plant", 2.5, LEFT, 3.2, "street"),
    ("potted plant", 61.5, LEFT, 3.2, "street"),
    ("manhole cover", 40.0, RIGHT, -2.0, "+x"),
    ("jersey barrier", -0.8, RIGHT, -0.9, "+x"),
    ("jersey barrier", -0.8, RIGHT, -3.2, "+x"),
    ("jersey barrier", -0.8, LEFT, -0.9, "+x"),
)


def build() -> StreetComposer:
    street = StreetComposer("construction_narrow", SECTION, seed=303)
    street.facades(
        LEFT, ("apartment building", "office building", "garage", "apartment building", "convenience store", "house")
    )
    street.facades(RIGHT, ("house", "apartment building", "bank", "hotel", "office building", "bar"))
    street.close_view(("office building",), at_end=False)
    street.close_view(("apartment building", "office building", "house"), at_end=True)
    # road works on the left: barriers on the road, a fence on the pavement that leaves 1.7 m along the fronts
    street.row(
        "jersey barrier",
        (18.0, 20.2, 22.4, 24.6, 26.8, 29.0, 31.2, 33.4, 35.6, 37.8, 40.0, 42.2),
        LEFT,
        -3.3,
        "street",
        2.0,
    )
    street.row("fence", (19.2, 21.85, 24.5, 27.15, 31.8, 34.45, 37.1, 39.75), LEFT, 1.5, "wall")
    # the trench on the right: a fence that leaves 1.5 m
    street.row("fence", (23.6, 26.25, 28.9, 31.55, 34.2), RIGHT, 1.35, "wall")
    street.row("traffic cone", (17.2, 18.4, 19.8), LEFT, 0.45, "street", 30.0)
    street.row("traffic cone", (44.9, 45.8, 46.7), LEFT, -2.2, "street", 30.0)
    street.row("traffic cone", (8.2, 14.4, 16.4, 38.0, 39.4, 41.5), RIGHT, 0.5, "street", 30.0)
    street.row("traffic cone", (42.8, 43.9), RIGHT, 1.0, "street", 30.0)
    street.row("traffic cone", (28.4, 30.3), LEFT, 1.75, "street", 30.0)
    street.row("street light", (8.0, 45.8, 59.6), LEFT, 0.4)
    street.row("street light", (2.5, 20.0, 37.2, 53.5), RIGHT, 0.4)
    street.trees((3.5, 55.8, 62.2), LEFT, 0.65)
    street.trees((6.4, 58.9), RIGHT, 0.6, "slim")
    parked(street, (("hatchback car", 6.0), ("sedan", 56.8)), RIGHT)
    parked(street, (("hatchback car", 4.8), ("sedan", 58.6)), LEFT)
    street.put_all(OBJECTS)
    street.scatter(("traffic cone", "garbage bag", "storage box"), 5, LEFT, (2.0, 62.0), (0.4, 3.2))
    street.scatter(("traffic cone", "guard stone", "parcels"), 5, RIGHT, (2.0, 62.0), (0.4, 2.6))
    lane_paint(street, 0.0)
    return street
