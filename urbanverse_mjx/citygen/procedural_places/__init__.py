"""The procedural set `places`: alleys, parks, courtyards, markets, precincts, works, lots, as various as a city.

The streets of `procedural` have one section and a lane free along each pavement; policies trained there fail where it
is narrow, open or shut. Here nine templates take turns. A net of winding lanes, `site.LANE` wide, stays free; objects
may stand anywhere else.
"""

import dataclasses
import random
from collections.abc import Callable

from ...datatypes import SceneGraph, Source
from ...datatypes import validation as v
from . import alleys, parks, squares, streets
from .site import Site

#: Scenes of the set.
COUNT = 96
TEMPLATES: dict[str, Callable[[str, random.Random], Site]] = {
    "alley": alleys.alley,
    "park": parks.park,
    "courtyard": squares.courtyard,
    "market": squares.market,
    "precinct": alleys.precinct,
    "works": streets.works,
    "residential": streets.residential,
    "crossing": streets.crossing,
    "parking": parks.parking,
}


def template_of(index: int) -> str:
    """Name of the template of scene `index`; they take turns."""
    return list(TEMPLATES)[index % len(TEMPLATES)]


def site_of(index: int) -> Site:
    """Scene number `index` of `COUNT` with its parameters: lanes and density.

    Raises:
      ValidationError: no such number.
    """
    v.integer(index, "place", 0, COUNT - 1)
    name = template_of(index)
    return TEMPLATES[name](f"places_{name}_{index:03d}", random.Random(f"places-{index}"))


def build(index: int) -> SceneGraph:
    """Place number `index` of `COUNT`, the same on every machine.

    Raises:
      ValidationError: no such number.
    """
    source = Source(f"procedural {template_of(index)}", "Apache-2.0", "none", "none")
    return dataclasses.replace(site_of(index).graph(), source=source)
