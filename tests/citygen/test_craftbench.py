"""CraftBench: requirements on manually composed scenes, checked on the graphs that its modules build."""

import dataclasses
import functools
import itertools
import math

import pytest

from urbanverse_mjx.assets import load_index
from urbanverse_mjx.assets.records.regional import is_served, tradition_of
from urbanverse_mjx.citygen.craftbench import BUILDERS, CITIES, SIZES, SKIES, build, write
from urbanverse_mjx.datatypes import SceneGraph, ValidationError
from urbanverse_mjx.pipeline.library.building import graph_of
from urbanverse_mjx.scene import library
from urbanverse_mjx.scene.roads import rules_of

from . import composed

IDS = list(BUILDERS)
#: The ids of the authors' release (docs/sources/reference_systems.md b.1).
PUBLISHED = {
    "01_residential_street_dual_sidewalks_dense_bollards_trash_bags",
    "02_residential_street_single_sidewalk_door_to_street_buildings",
    "03_residential_street_dual_sidewalks_clean",
    "04_commercial_street_asymmetric_sidewalks_benches_bicycles",
    "05_japanese_tourist_street_dual_sidewalks_blocked_by_vehicles",
    "06_bar_street_dual_sidewalks_obstructed_fallen_scooters",
    "07_narrow_alley_outdoor_dining",
    "08_commercial_street_bike_lane_dual_sidewalks",
    "09_cbd_t_intersection_construction_sites",
    "10_cbd_cross_intersection_diverse_obstacles",
    "11_urban_park_dogs_sports_area",
    "12_courtyard_plaza_central_fountain",
}


#: A scene of an id, which is only read.
built = functools.cache(build)


@pytest.fixture(scope="module", params=IDS)
def graph(request) -> SceneGraph:
    return built(request.param)


def test_a_graph_has_the_committed_hash_and_survives_its_file(graph, tmp_path):
    assert graph.content_hash() == library.shipped_hashes("craftbench")[graph.id]["graph"]
    written = write(graph, tmp_path / "graph.json")
    assert SceneGraph.load(written) == graph
    assert written.stat().st_size <= 55_000


def test_every_scene_is_one_of_the_published_ids():
    assert set(IDS) <= PUBLISHED
    assert set(library.shipped_hashes("craftbench")) == set(IDS)
    with pytest.raises(ValidationError, match="01_residential"):
        build("nowhere")


def test_version_2_differs_in_the_city_and_what_its_tables_name(graph):
    """Version 1 is frozen without a city, so its graphs must not name one."""
    first, second = (graph_of(library.scene_set(name), graph.id) for name in ("craftbench", "craftbench_v2"))
    assert first == graph
    assert (second.source.city, second.source.country) == CITIES[graph.id]
    assert (second.sky_descriptor != first.sky_descriptor) == (graph.id in SKIES)
    plain = dataclasses.replace(second, source=first.source, sky_descriptor=first.sky_descriptor)
    assert dataclasses.replace(plain, objects=first.objects) == first
    other = {b.id: (a, b) for a, b in zip(first.objects, second.objects, strict=True) if a != b}
    assert {name: b.size for name, (_, b) in other.items()} == SIZES.get(graph.id, {})
    for a, b in other.values():
        assert b.center[:2] == a.center[:2]
        assert b.center[2] - b.size[2] / 2 == pytest.approx(a.center[2] - a.size[2] / 2)
        assert (b.id, b.label, b.yaw) == (a.id, a.label, a.yaw)
    assert is_served(*CITIES[graph.id])


def test_cities_of_version_2_differ_and_have_the_traffic_of_their_scenes():
    assert set(CITIES) == set(IDS)
    assert len({tradition_of(*place) for place in CITIES.values()}) == len(CITIES)
    left = {scene_id[:2] for scene_id, place in CITIES.items() if rules_of(*place).traffic == "left"}
    assert left == {"05", "11"}
    # Rails belong into no lane of two and a half metres beside parked cars.
    assert not any(rules_of(*place).tram for place in CITIES.values())


@pytest.mark.parametrize("scene_id", IDS)
def test_a_scene_has_no_faults(scene_id):
    assert BUILDERS[scene_id]().problems() == []


def test_rich_and_long_enough(graph):
    assert 150 <= len(graph.objects) <= 300
    assert len({o.label for o in graph.objects}) >= 30
    route = [p[:2] for p in graph.camera_path]
    assert 80.0 <= sum(math.dist(a, b) for a, b in itertools.pairwise(route)) <= 600.0
    assert graph.source.video == "hand"
    assert graph.sky_descriptor is not None


def test_ground_compiles_and_no_place_has_more_prisms_than_an_engine_looks_at(graph):
    most, place = composed.most_prisms_near(graph)
    assert most <= composed.PRISMS, f"{most} prisms near {place}"


def test_every_object_has_an_asset_of_its_size(graph):
    """Materialisation stretches only house fronts, hedges and fences."""
    assert composed.stretched(graph) == []


def test_scenes_differ_in_character():
    """No two scenes share more than 70 % of their labels, weighted by count."""
    for a, b in itertools.combinations([built(scene_id) for scene_id in IDS], 2):
        assert composed.shared_labels(a, b) < 0.7


def test_fallen_scooters_lie_and_bollards_are_dense():
    def graph_objects(prefix: str, label: str) -> list:
        found = next(s for s in IDS if s.startswith(prefix))
        return [o for o in built(found).objects if o.label == label]

    scooters = graph_objects("06", "scooter")
    assert sum(o.size[2] < 0.6 and min(o.size[:2]) > 1.0 for o in scooters) >= 25
    index = load_index()
    lying = [r for r in index.by_label("scooter") if r.height < 0.6]
    assert lying
    for obj in scooters:
        best = min(index.by_label("scooter"), key=lambda r: composed.distortion(obj.size, r))
        assert (best in lying) == (obj.size[2] < 0.6)
    assert len(graph_objects("01", "bollard")) >= 60
    assert len(graph_objects("01", "garbage bag")) >= 35
