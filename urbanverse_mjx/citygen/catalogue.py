"""Sizes of the objects on a street, and the part of the pavement that they occupy.

Sizes are (along the heading, across, up) in metres, the convention of `GraphObject.size`. They are everyday values:
cars from the makers' data sheets of common models (with mirrors), street furniture from city design manuals (NACTO
Urban Street Design Guide: benches, racks, shelters), people about 1.7 m, longer when they stride. Where a label has
several sizes, the objects of a street take them in turn.
"""

import dataclasses

from ..datatypes.toml_table import table

Size = tuple[float, float, float]

SIZES: dict[str, tuple[Size, ...]] = table(__file__)

#: Growth forms of trees: for rows along a kerb, narrow streets, southern cities, spring and parks.
TREES: dict[str, Size] = {
    "street": SIZES["tree"][0],
    "slim": (2.74, 2.75, 8.39),
    "palm": (3.91, 4.04, 5.93),
    "blossom": (4.36, 4.04, 4.89),
    "broad": (5.3, 5.5, 6.6),
}

#: One piece of a row of clipped hedge.
HEDGE: Size = (0.75, 2.28, 1.18)


@dataclasses.dataclass(frozen=True)
class Stem:
    """Position of the stem of a slender object.

    Attributes:
      side: m, of the square that it occupies at walking height; the rest of its box is above heads.
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

#: Flat objects that a person or robot passes over.
FLAT: frozenset[str] = frozenset({"manhole cover", "grass patch"})
