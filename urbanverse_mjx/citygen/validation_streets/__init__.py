"""Validation streets: eight hand-made scenes, one module `vNN_...` each with a `build() -> Canvas`.

Checkpoints, presets and ablations are chosen on them (with the other scenes of `scenes/validation.json`), so that
CraftBench and AutoBench are used for final tables only. Their layouts differ from CraftBench's. `CITIES` names a city
for each, whose look the set `validation_v2` has; `validation` has none.
"""

import dataclasses

from ...datatypes import SceneGraph
from ..canvas import discovery

__all__ = ["BUILDERS", "CITIES", "build"]

BUILDERS = discovery.builders(__name__, __path__, "v")

#: Scene id -> (city, country): a place where such a street occurs, on whose side of the road the scene's vehicles
#: stand. No two share a tradition of building, and none has one of CraftBench's.
CITIES = {
    "v01_shopping_alley_with_two_bends": ("Seoul", "South Korea"),
    "v02_park_edge_with_pond_and_playground": ("Almaty", "Kazakhstan"),
    "v03_market_square_with_five_sides": ("Tunis", "Tunisia"),
    "v04_hospital_forecourt_with_bus_stops": ("Singapore", "Singapore"),
    "v05_canal_with_two_bridges": ("Haarlem", "Netherlands"),
    "v06_school_street_with_chicane": ("Guadalajara", "Mexico"),
    "v07_supermarket_car_park": ("Los Angeles", "United States"),
    "v08_close_with_works_and_removals": ("Auckland", "New Zealand"),
}


def build(scene_id: str, in_city: bool = False) -> SceneGraph:
    """Returns the graph of one validation street; it is identical on every machine.

    Args:
      in_city: whether its source names the scene's city of `CITIES`; nothing else differs.

    Raises:
      ValidationError: no scene has this id.
    """
    graph = discovery.build(BUILDERS, scene_id)
    if not in_city:
        return graph
    city, country = CITIES[scene_id]
    return dataclasses.replace(graph, source=dataclasses.replace(graph.source, city=city, country=country))
