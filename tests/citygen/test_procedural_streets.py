"""Procedural scenes: each template's ground and objects, counted on the graphs."""

import itertools

import numpy as np
import pytest
import shapely

from urbanverse_mjx.citygen import catalogue, clearance
from urbanverse_mjx.citygen.procedural_streets import COUNT, build, template_of
from urbanverse_mjx.citygen.procedural_streets.templates import TEMPLATES
from urbanverse_mjx.datatypes import SceneGraph, ValidationError
from urbanverse_mjx.datatypes.ground import height_at
from urbanverse_mjx.scene.ground import check_regions, ground_prisms


@pytest.fixture(scope="module", params=range(5))
def graph(request) -> SceneGraph:
    return build(request.param)


def test_every_template_has_its_turn() -> None:
    assert COUNT == 160
    assert sorted(template_of(i) for i in range(COUNT)) == sorted(list(TEMPLATES) * 32)
    with pytest.raises(ValidationError, match="160"):
        build(160)


def test_the_same_number_is_the_same_scene_and_another_another() -> None:
    assert build(7).content_hash() == build(7).content_hash()
    assert len({build(i).content_hash() for i in (0, 5, 10)}) == 3


def test_the_ground_compiles(graph: SceneGraph) -> None:
    check_regions(graph.ground)
    assert len(ground_prisms(graph.ground)) < 120
    assert {r.kind for r in graph.ground} == {"road", "crosswalk", "sidewalk"}
    assert any(r.id.startswith("plaza") for r in graph.ground) == ("plaza" in graph.id)


def test_neighbours_meet_level_except_at_the_kerb(graph: SceneGraph) -> None:
    solid = [(r, shapely.Polygon(r.polygon)) for r in graph.ground]
    level_feet = 0
    for (a, sa), (b, sb) in itertools.combinations(solid, 2):
        edge = sa.boundary.intersection(sb.boundary)
        if edge.length < 0.05:
            continue
        points = [edge.interpolate(t) for t in np.linspace(0, edge.length, 7)]
        step = np.abs([height_at(a.plane, p.x, p.y) - height_at(b.plane, p.x, p.y) for p in points])
        on_road = [r.kind in ("road", "crosswalk") for r in (a, b)]
        assert step.max() < (1e-4 if on_road[0] == on_road[1] else 0.151), (a.id, b.id)
        level_feet += on_road[0] != on_road[1] and step.max() < 1e-4 and edge.length >= 1.9
    assert level_feet == 2 * sum(r.kind == "crosswalk" for r in graph.ground)


def test_objects_stand_on_the_ground_and_apart(graph: SceneGraph) -> None:
    shapes = [(o, clearance.footprint(o)) for o in graph.objects]
    tree = shapely.STRtree([s for _, s in shapes])
    for (o, shape), near in ((s, tree.query(s[1])) for s in shapes):
        for k in near:
            other, there = shapes[k]
            assert other is o or shape.intersection(there).area < 0.01, (o.id, other.id)
    regions = [(r, shapely.Polygon(r.polygon)) for r in graph.ground]
    for o, shape in shapes:
        if catalogue.SIZES[o.label][0][0] > 5.4:
            continue
        spot = shape.centroid
        heights = [height_at(r.plane, spot.x, spot.y) for r, s in regions if s.intersects(spot)]
        assert heights, o.id
        assert min(abs(o.center[2] - o.size[2] / 2 - h) for h in heights) < 0.16, o.id


def test_a_robot_gets_from_end_to_end(graph: SceneGraph) -> None:
    """Three quarters of where a robot's middle could be on the empty pavements hang together with the objects there."""
    empty = clearance.free_space(graph.ground, [o for o in graph.objects if o.size[1] > 5.0])
    full = clearance.free_space(graph.ground, graph.objects)
    largest = max(shapely.get_parts(full), key=lambda part: part.area)
    widest = max(shapely.get_parts(empty), key=lambda part: part.area)
    assert largest.area > 0.5 * widest.area
    assert len(graph.objects) >= 80
