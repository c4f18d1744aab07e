"""The procedural set `places`: alleys, parks, courtyards, markets, pedestrian streets, works and parking lots.

The streets of `procedural` have one cross-section and a free lane along each pavement; policies trained there fail on
narrow, open or closed ground. This set cycles through nine templates. A network of winding lanes, `site.LANE` wide,
stays free; objects may stand anywhere else.
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
    """Returns the name of the template of scene `index`; the templates are used in turn."""
    return list(TEMPLATES)[index % len(TEMPLATES)]


def site_of(index: int) -> Site:
    """Returns the site of scene `index` of `COUNT` with its lanes and density.

    Raises:
      ValidationError: the index is out of range.
    """
    v.integer(index, "place", 0, COUNT - 1)
    name = template_of(index)
    return TEMPLATES[name](f"places_{name}_{index:03d}", random.Random(f"places-{index}"))


def build(index: int) -> SceneGraph:
    """Returns the graph of place `index` of `COUNT`; it is identical on every machine.

    Raises:
      ValidationError: the index is out of range.
    """
    source = Source(f"procedural {template_of(index)}", "Apache-2.0", "none", "none")
    return dataclasses.replace(site_of(index).graph(), source=source)
