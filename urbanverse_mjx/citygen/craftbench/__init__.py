"""CraftBench: twelve hand-made scenes, one module `sNN_...` each with a `build() -> Canvas`.

Their ids and themes are those of the authors' release (docs/sources/reference_systems.md b.1). `CITIES` names a city
for each, whose look version 2 of the benchmark has; version 1 has none.
"""

import dataclasses

from ...datatypes import SceneGraph
from ..canvas import discovery
from ..canvas.canvas import Canvas
from ..canvas.graph_file import write

__all__ = ["BUILDERS", "CITIES", "Canvas", "build", "write"]

BUILDERS = discovery.builders(__name__, __path__, "s")

#: Scene id -> (city, country): a place where such a street occurs, on whose side of the road the scene's vehicles
#: stand. No two share a tradition of building; towns without trams stand for streets too narrow for them.
CITIES = {
    "01_residential_street_dual_sidewalks_dense_bollards_trash_bags": ("Boston", "United States"),
    "02_residential_street_single_sidewalk_door_to_street_buildings": ("Bari", "Italy"),
    "03_residential_street_dual_sidewalks_clean": ("Reykjavík", "Iceland"),
    "04_commercial_street_asymmetric_sidewalks_benches_bicycles": ("Paris", "France"),
    "05_japanese_tourist_street_dual_sidewalks_blocked_by_vehicles": ("Kyoto", "Japan"),
    "06_bar_street_dual_sidewalks_obstructed_fallen_scooters": ("Rio de Janeiro", "Brazil"),
    "07_narrow_alley_outdoor_dining": ("Barcelona", "Spain"),
    "08_commercial_street_bike_lane_dual_sidewalks": ("Bogotá", "Colombia"),
    "09_cbd_t_intersection_construction_sites": ("Dubai", "United Arab Emirates"),
    "10_cbd_cross_intersection_diverse_obstacles": ("Buenos Aires", "Argentina"),
    "11_urban_park_dogs_sports_area": ("Sydney", "Australia"),
    "12_courtyard_plaza_central_fountain": ("Stockholm", "Sweden"),
}


def build(scene_id: str, in_city: bool = False) -> SceneGraph:
    """Returns the graph of one hand-made scene; it is identical on every machine.

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
