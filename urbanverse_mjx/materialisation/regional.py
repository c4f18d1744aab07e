"""Gives a cousin the look of its city: houses of the region's tradition, colours of cars and clothes as they are there,
trees of its climate and season, and the place whose roads the compiler draws.

The step comes after materialisation; positions, headings, labels and categories of what stays do not change.
"""

import dataclasses
from collections.abc import Callable

from ..assets import load_hulls
from ..assets.records import regional
from ..assets.records.index import AssetIndex
from ..datatypes import AssetRecord, HullSet, SceneGraph
from ..datatypes import validation as v
from . import paints
from .cousins import Cousin, index_of, trees_of
from .facades import dress


def check_city(graph: SceneGraph) -> None:
    """Checks that a tradition serves a graph's city or country.

    Raises:
      ValidationError: none does.
    """
    if regional.tradition_of(graph.source.city, graph.source.country) is None:
        raise v.fail(
            "graph.source.city",
            f"{v.show(graph.source.city)} in {v.show(graph.source.country)}",
            f"one of {', '.join(regional.places())}",
            "correct the city or the country, or leave --regional out",
        )


def localise(
    cousin: Cousin,
    graph: SceneGraph,
    index: AssetIndex | None = None,
    hulls_of: Callable[[AssetRecord], HullSet] = load_hulls,
) -> Cousin:
    """A cousin with the look of its graph's city; the same cousin if no tradition serves the city.

    Args:
      cousin: a cousin of the graph.
      graph: its source names the city.
      index: records of the cousin's assets; default: from the catalogue.
      hulls_of: function that returns the collision hulls of a record.
    """
    index = index or index_of(cousin.layout)
    dressed = dress(cousin, graph, index, hulls_of)
    if dressed is cousin:
        return cousin
    layout, place = dressed.layout, (graph.source.city, graph.source.country)
    key = (layout.graph_id, layout.seed, layout.cousin)
    allowed = paints.species(place, layout.sky)
    objects, changed = [], set[str]()
    for placed in layout.objects:
        if regional.MARK in placed.asset_uid:
            objects.append(placed)
            continue
        planted, record = paints.replanted(placed, index.get(placed.asset_uid), allowed, trees_of, *key)
        changed |= {placed.id} if planted is not placed else set()
        objects.append(paints.painted(planted, record, place, *key))
    layout = dataclasses.replace(layout, objects=tuple(objects), place=place)
    chosen = {name: c for name, c in dressed.chosen.items() if name not in changed}
    return dataclasses.replace(dressed, layout=layout, chosen=chosen)
