"""How large objects on a street are, and how much of the pavement they take.

Sizes are (along the heading, across, up) in metres, the convention of `GraphObject.size`. They are everyday
values: cars from the makers' data sheets of common models (with mirrors), street furniture from city design
manuals (NACTO Urban Street Design Guide: benches, racks, shelters), people about 1.7 m, longer when they stride.
Where an object comes in several sizes, the first of it that a street gets takes the first size, and so on round.
"""

import dataclasses

Size = tuple[float, float, float]

SIZES: dict[str, tuple[Size, ...]] = {
    # furniture and services
    "bollard": ((0.2, 0.2, 0.98),),
    "bench": ((0.63, 1.8, 0.9), (0.67, 1.76, 0.88)),
    "trash bin": ((0.64, 0.57, 1.02), (0.48, 0.48, 1.18), (0.53, 0.53, 0.82)),
    "dumpster": ((1.11, 1.36, 1.33), (1.35, 2.18, 1.3)),
    "street light": ((2.42, 0.33, 7.4), (2.13, 0.33, 8.2)),
    "lamppost": ((0.42, 0.41, 3.71), (0.54, 0.64, 3.9)),
    "traffic light": ((0.54, 0.5, 3.4),),
    "fire hydrant": ((0.39, 0.43, 0.77),),
    "mailbox": ((0.51, 0.19, 1.35), (0.58, 0.5, 1.27)),
    "postbox": ((0.46, 0.52, 1.25), (0.56, 0.55, 1.57)),
    "parking meter": ((0.18, 0.2, 1.49), (0.34, 0.4, 1.88)),
    "street cabinet": ((0.45, 0.84, 1.17), (0.47, 1.09, 1.23)),
    "bicycle parking": ((0.16, 1.96, 0.9), (0.45, 1.8, 0.49)),
    "bus shelter": ((1.67, 3.8, 2.6),),
    "vending machine": ((0.8, 1.0, 1.82),),
    "advertising board": ((0.49, 0.62, 1.0),),
    "kiosk": ((2.7, 3.1, 3.0),),
    "street food stall": ((2.1, 2.5, 2.6), (2.2, 2.2, 2.41)),
    "table": ((0.74, 0.74, 0.75), (0.65, 0.65, 0.74)),
    "chair": ((0.5, 0.42, 0.88), (0.53, 0.53, 0.86)),
    "picnic table": ((1.65, 1.88, 0.77), (1.56, 1.56, 0.75)),
    "potted plant": ((0.58, 0.57, 0.91), (0.55, 0.54, 1.7)),
    "plant pot": ((0.59, 0.59, 0.6), (0.42, 0.42, 0.37)),
    "garbage bag": ((0.53, 0.55, 0.48), (0.91, 0.77, 0.53), (0.51, 0.53, 0.48)),
    "storage box": ((0.47, 0.63, 0.38), (0.45, 0.57, 0.9), (0.54, 0.93, 0.5)),
    "parcels": ((0.44, 0.58, 0.33), (0.45, 0.53, 0.66)),
    "newspaper stand": ((0.42, 0.42, 1.12),),
    "telephone booth": ((0.96, 0.96, 2.5),),
    "fountain": ((3.77, 3.77, 2.42),),
    "sculpture": ((1.2, 1.2, 2.8), (0.6, 0.6, 2.03)),
    "manhole cover": ((0.7, 0.7, 0.012),),
    "guard stone": ((0.34, 0.34, 0.62), (0.48, 0.48, 0.75)),
    "rock": ((1.0, 0.95, 0.55), (0.92, 0.65, 0.45)),
    "sunshade": ((2.46, 2.46, 2.5),),
    "charging station": ((0.5, 0.67, 1.5),),
    "utility pole": ((0.36, 2.2, 8.5),),
    # signs
    "stop sign": ((0.1, 0.72, 2.7),),
    "no parking sign": ((0.15, 0.55, 2.7),),
    "do not enter sign": ((0.15, 0.58, 2.8),),
    "speed limit sign 30 km": ((0.15, 0.6, 2.72),),
    "directional sign": ((0.52, 1.7, 2.98), (0.8, 0.8, 3.06)),
    "road work detour ahead sign": ((0.74, 1.1, 1.75),),
    # barriers
    "traffic cone": ((0.34, 0.34, 0.7), (0.44, 0.44, 0.92)),
    "traffic barricade": ((0.64, 1.4, 1.2),),
    "jersey barrier": ((0.62, 2.0, 0.82),),
    "fence": ((0.1, 2.6, 1.15),),
    "guard rail": ((0.3, 3.0, 0.78),),
    # vehicles
    "sedan": ((4.75, 2.1, 1.49),),
    "hatchback car": ((4.1, 2.05, 1.54), (3.75, 2.05, 1.58)),
    "suv": ((4.7, 2.24, 1.8),),
    "van": ((5.3, 2.37, 2.2),),
    "minivan": ((4.8, 2.25, 1.8),),
    "pickup truck": ((5.3, 2.24, 1.8),),
    "taxi": ((4.85, 2.14, 1.7),),
    "police car": ((4.95, 2.16, 1.64),),
    "truck": ((6.77, 2.62, 3.19),),
    "bus": ((10.76, 2.8, 3.2),),
    "food truck": ((6.35, 3.2, 3.25),),
    "motorcycle": ((2.0, 0.75, 1.25),),
    "bicycle": ((1.76, 0.61, 1.06),),
    "scooter": ((1.14, 0.54, 1.18),),
    "wheelchair": ((1.01, 0.69, 0.98),),
    "stroller": ((1.05, 0.6, 1.15),),
    "handcart": ((1.01, 0.6, 0.96), (1.7, 1.0, 0.86)),
    "tricycle": ((2.25, 0.96, 1.02),),
    "delivery robot": ((0.82, 0.55, 1.14),),
    # street users: striding, standing
    "pedestrian adult": ((0.95, 0.58, 1.68), (0.4, 0.62, 1.8), (1.02, 0.63, 1.72), (0.72, 0.6, 1.78)),
    "pedestrian child": ((0.66, 0.41, 1.22), (0.25, 0.46, 1.4)),
    "elderly person": ((0.98, 0.59, 1.68), (0.66, 0.58, 1.6)),
    "construction worker": ((0.7, 0.6, 1.79), (1.02, 0.66, 1.82)),
    "police officer": ((0.35, 0.6, 1.87),),
    "jogger": ((1.28, 0.6, 1.65),),
    "cyclist": ((1.76, 0.66, 1.85),),
    "delivery worker": ((0.95, 0.6, 1.76),),
    "dog": ((1.08, 0.26, 0.75), (0.68, 0.16, 0.46)),
    "cat": ((0.63, 0.12, 0.41), (0.33, 0.27, 0.42)),
    "bird": ((0.39, 0.14, 0.27),),
    # plants
    "tree": ((3.7, 3.4, 7.4),),
    "shrub": ((1.17, 1.14, 1.09), (0.83, 0.82, 1.25)),
    "flower": ((0.82, 0.8, 0.54), (0.67, 0.67, 0.83)),
    "grass patch": ((2.0, 1.98, 0.03), (1.63, 1.45, 0.03)),
    # building fronts: depth, frontage, height
    "apartment building": ((8.4, 11.5, 18.2), (8.4, 12.5, 16.4), (8.4, 10.6, 16.4)),
    "house": ((8.3, 8.8, 8.5), (8.3, 7.0, 8.9), (8.2, 8.2, 8.2)),
    "office building": ((9.5, 13.0, 14.6), (9.5, 12.1, 17.7)),
    "hotel": ((10.0, 12.7, 14.9), (10.0, 11.7, 15.6)),
    "school": ((9.1, 14.1, 8.1), (9.45, 14.35, 12.1)),
    "garage": ((6.7, 6.7, 4.6), (6.7, 7.4, 3.3)),
    "cafe": ((6.8, 7.9, 11.0), (5.8, 6.9, 8.0), (7.3, 8.9, 14.1)),
    "restaurant": ((8.1, 9.9, 11.0), (7.1, 9.4, 14.1)),
    "bakery": ((6.6, 8.3, 9.8), (7.0, 7.4, 11.0)),
    "convenience store": ((6.8, 9.9, 8.0), (6.8, 9.4, 11.0)),
    "pharmacy": ((6.8, 9.4, 8.0), (6.0, 8.4, 11.0)),
    "bookstore": ((6.4, 8.4, 11.0), (7.4, 7.6, 16.3)),
    "bank": ((9.45, 11.8, 8.9), (9.45, 10.8, 10.3)),
    "clothing store": ((5.5, 9.4, 14.1), (6.9, 9.9, 11.0)),
    "supermarket": ((6.4, 14.4, 5.8), (7.1, 13.4, 7.6)),
    "flower shop": ((7.1, 7.4, 9.8), (6.4, 6.9, 11.0)),
    "bar": ((6.8, 7.4, 11.0), (6.6, 8.4, 8.0), (6.4, 9.3, 12.8)),
    "hair salon": ((6.7, 7.4, 11.0), (7.5, 6.9, 11.0)),
}

#: Growths of trees: for rows along a kerb, for narrow places, for the south, for spring, for parks.
TREES: dict[str, Size] = {
    "street": SIZES["tree"][0],
    "slim": (2.74, 2.75, 8.39),
    "palm": (3.91, 4.04, 5.93),
    "blossom": (4.36, 4.04, 4.89),
    "broad": (5.3, 5.5, 6.6),
}

#: A clipped hedge, one piece of a row.
HEDGE: Size = (0.75, 2.28, 1.18)


@dataclasses.dataclass(frozen=True)
class Stem:
    """Where a slender object stands.

    Attributes:
      side: m, of the square that it takes at walking height; the rest of its box hangs above heads.
      offset: m along the heading from the box's middle to the stem, as a share of the box's half length.
    """

    side: float
    offset: float = 0.0


STEMS: dict[str, Stem] = {
    "tree": Stem(0.45),
    "street light": Stem(0.35, -0.86),
    "lamppost": Stem(0.4),
    "traffic light": Stem(0.35, -0.5),
    "utility pole": Stem(0.4),
    "sunshade": Stem(0.6),
    "stop sign": Stem(0.2),
    "no parking sign": Stem(0.2),
    "do not enter sign": Stem(0.2),
    "speed limit sign 30 km": Stem(0.2),
    "directional sign": Stem(0.3),
}

#: Objects one walks or rolls over.
FLAT: frozenset[str] = frozenset({"manhole cover", "grass patch"})
