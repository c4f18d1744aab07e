"""CraftBench: twelve hand-made scenes, one module `sNN_...` each with a `build() -> Canvas`.

Their ids and themes are those of the authors' release (docs/sources/reference_systems.md b.1). `CITIES` names a city
for each, whose look version 2 of the benchmark has; version 1 has none.
"""

import dataclasses

from ...datatypes import GraphObject, SceneGraph
from ..canvas import discovery
from ..canvas.canvas import Canvas, sky_descriptor
from ..canvas.graph_file import write

__all__ = ["BUILDERS", "CITIES", "SIZES", "SKIES", "Canvas", "build", "write"]

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


#: Scene id -> object id -> m (along, across, up): a size for which another asset is chosen, where that of the scene's
#: own size belongs into other cities: red telephone boxes, and a palm in Paris, in whose place only a slim tree fits;
#: or is longer than the place in its row (jersey barriers of 2.15 m, 2.05 m apart) or falls over: a fitness machine.
SIZES: dict[str, dict[str, tuple[float, float, float]]] = {
    "04_commercial_street_asymmetric_sidewalks_benches_bicycles": {"tree_00": (2.7, 2.6, 8.4)},
    "06_bar_street_dual_sidewalks_obstructed_fallen_scooters": {"telephone_booth_00": (0.58, 0.76, 2.18)},
    "09_cbd_t_intersection_construction_sites": {"telephone_booth_00": (0.58, 0.76, 2.18)},
    "10_cbd_cross_intersection_diverse_obstacles": {
        "telephone_booth_00": (0.58, 0.76, 2.18),
        **{f"jersey_barrier_{k:02d}": (0.64, 1.99, 0.81) for k in range(10)},
    },
    "11_urban_park_dogs_sports_area": {"fitness_equipments_01": (1.2, 0.55, 1.22)},
}
#: Scene id -> another sky: with baked shadows, the side of a crossing away from a clear noon's sun was nearly black.
SKIES = {"10_cbd_cross_intersection_diverse_obstacles": "summer_noon-broken_cumulus"}


def build(scene_id: str, in_city: bool = False) -> SceneGraph:
    """Returns the graph of one hand-made scene; it is identical on every machine.

    Args:
      in_city: whether its source names the scene's city of `CITIES`; apart from `SIZES` and `SKIES`, nothing else
        differs.

    Raises:
      ValidationError: no scene has this id.
    """
    graph = discovery.build(BUILDERS, scene_id)
    if not in_city:
        return graph
    city, country = CITIES[scene_id]
    sizes = SIZES.get(scene_id, {})
    return dataclasses.replace(
        graph,
        source=dataclasses.replace(graph.source, city=city, country=country),
        objects=tuple(_resized(obj, sizes[obj.id]) if obj.id in sizes else obj for obj in graph.objects),
        sky_descriptor=sky_descriptor(SKIES[scene_id]) if scene_id in SKIES else graph.sky_descriptor,
    )


def _resized(obj: GraphObject, size: tuple[float, float, float]) -> GraphObject:
    """An object of another size on the same place of the ground."""
    x, y, z = obj.center
    return dataclasses.replace(obj, center=(x, y, z + (size[2] - obj.size[2]) / 2), size=size)
