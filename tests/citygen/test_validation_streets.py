"""Validation streets: requirements on manually composed scenes, and difference from all plans of CraftBench."""

import dataclasses
import itertools
import math

import pytest
import shapely

from urbanverse_mjx.assets.records.regional import is_served, tradition_of
from urbanverse_mjx.citygen import craftbench
from urbanverse_mjx.citygen.validation_streets import BUILDERS, CITIES, build
from urbanverse_mjx.datatypes import SceneGraph, ValidationError
from urbanverse_mjx.pipeline.library.building import graph_of
from urbanverse_mjx.scene import library
from urbanverse_mjx.scene.roads import rules_of

from . import composed

IDS = list(BUILDERS)


@pytest.fixture(scope="module", params=IDS)
def graph(request) -> SceneGraph:
    return build(request.param)


def test_there_are_eight_and_each_has_the_committed_hash(graph):
    hashes = library.shipped_hashes("validation")
    assert list(hashes) == IDS
    assert len(IDS) == 8
    assert graph.content_hash() == hashes[graph.id]["graph"]
    with pytest.raises(ValidationError, match="v01_shopping"):
        build("nowhere")


def test_version_2_differs_in_the_city_alone(graph):
    """`validation` is frozen without a city, so its graphs must not name one."""
    first, second = (graph_of(library.scene_set(name), graph.id) for name in ("validation", "validation_v2"))
    assert first == graph
    assert (second.source.city, second.source.country) == CITIES[graph.id]
    assert dataclasses.replace(second, source=first.source) == first
    assert is_served(*CITIES[graph.id])
    assert second.content_hash() == library.shipped_hashes("validation_v2")[graph.id]["graph"]


def test_cities_of_version_2_are_of_other_traditions_and_have_the_traffic_of_their_scenes():
    assert set(CITIES) == set(IDS)
    ours = {tradition_of(*place) for place in CITIES.values()}
    assert len(ours) == len(CITIES)
    assert not ours & {tradition_of(*place) for place in craftbench.CITIES.values()}
    assert {scene_id[:3] for scene_id, place in CITIES.items() if rules_of(*place).traffic == "left"} == {"v04", "v08"}
    assert not any(rules_of(*place).tram for place in CITIES.values())


@pytest.mark.parametrize("scene_id", IDS)
def test_nothing_floats_overlaps_or_blocks_the_route(scene_id):
    assert BUILDERS[scene_id]().problems() == []


def test_rich_and_of_the_size_of_a_street(graph):
    assert 150 <= len(graph.objects) <= 300
    assert len({o.label for o in graph.objects}) >= 50
    x0, y0, x1, y1 = composed.walkable(graph).bounds
    assert 55.0 <= max(x1 - x0, y1 - y0) <= 95.0
    route = [p[:2] for p in graph.camera_path]
    assert sum(math.dist(a, b) for a, b in itertools.pairwise(route)) >= 80.0
    assert graph.source.video == "hand"
    assert graph.sky_descriptor is not None


def test_no_place_has_more_prisms_than_an_engine_looks_at(graph):
    most, place = composed.most_prisms_near(graph)
    assert most <= composed.PRISMS, f"{most} prisms near {place}"


def test_no_object_is_stretched(graph):
    assert composed.stretched(graph) == []


@pytest.mark.extended
def test_no_two_scenes_are_alike_and_none_is_like_craftbench():
    """Alike: 70 % of the labels, or ground that covers 85 % of the other's when both are laid on one another."""
    ours = [build(scene_id) for scene_id in IDS]
    theirs = [craftbench.build(scene_id) for scene_id in craftbench.BUILDERS]
    for a, b in [*itertools.combinations(ours, 2), *itertools.product(ours, theirs)]:
        assert composed.shared_labels(a, b) < 0.7, (a.id, b.id)
        assert _overlap(a, b) < 0.85, (a.id, b.id)


def _overlap(a: SceneGraph, b: SceneGraph) -> float:
    """Share of the union of two walkable grounds, the middles of their bounds on one another, that both cover."""
    moved = []
    for graph in (a, b):
        area = composed.walkable(graph)
        x0, y0, x1, y1 = area.bounds
        moved.append(shapely.affinity.translate(area, -(x0 + x1) / 2, -(y0 + y1) / 2))
    return moved[0].intersection(moved[1]).area / moved[0].union(moved[1]).area
