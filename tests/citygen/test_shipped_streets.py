"""Requirements on the six streets, checked on the committed files."""

import functools
import itertools
import json
import pathlib

import numpy as np
import pytest
import shapely

from urbanverse_mjx.citygen import BUILDERS, SPLITS, build, catalogue, clearance
from urbanverse_mjx.datatypes import PAINT_KINDS, SceneGraph, ValidationError
from urbanverse_mjx.datatypes.ground import height_at

SCENES = pathlib.Path(__file__).parents[2] / "scenes"
IDS = list(BUILDERS)
#: The street of an id, which is only read.
street_of = functools.cache(lambda scene_id: BUILDERS[scene_id]())


@pytest.fixture(scope="module", params=IDS)
def graph(request) -> SceneGraph:
    return SceneGraph.load(SCENES / request.param / "graph.json")


def solid(graph: SceneGraph):
    return [(r, shapely.Polygon(r.polygon)) for r in graph.ground if r.kind not in PAINT_KINDS]


def is_house(obj) -> bool:
    return catalogue.SIZES[obj.label][0][0] >= 5.4 and obj.size[2] >= 3.2


@pytest.mark.parametrize("scene_id", IDS)
def test_the_committed_file_is_what_the_generator_writes(scene_id, tmp_path):
    build(scene_id).save(tmp_path / "graph.json")
    committed = SCENES / scene_id / "graph.json"
    assert committed.read_bytes() == (tmp_path / "graph.json").read_bytes()
    assert committed.stat().st_size <= 100_000


def test_splits_name_every_scene_once():
    splits = json.loads((SCENES / "splits.json").read_text())
    assert splits == SPLITS
    assert (len(splits["train"]), len(splits["test"])) == (4, 2)
    assert sorted(splits["train"] + splits["test"]) == sorted(IDS)
    assert sorted(p.parent.name for p in SCENES.glob("*/graph.json")) == sorted(IDS)


def test_an_unknown_scene_is_refused():
    with pytest.raises(ValidationError, match="residential_bins"):
        build("nowhere")


def test_size_of_the_street(graph):
    road = shapely.union_all([s for r, s in solid(graph) if r.id.startswith(("road", "crosswalk"))])
    assert road.bounds[2] - road.bounds[0] >= 60.0
    assert 40 <= len(graph.objects) <= 250
    assert len(solid(graph)) <= 40
    assert max(len(r.polygon) for r in graph.ground) <= 8
    assert sum(r.kind == "crosswalk" for r in graph.ground) >= 2


def test_regions_tile_one_area_without_overlap_or_gap(graph):
    shapes = [s for _, s in solid(graph)]
    whole = shapely.union_all(shapes)
    assert isinstance(whole, shapely.Polygon)
    assert not whole.interiors
    assert whole.area == pytest.approx(sum(s.area for s in shapes), abs=1e-9)
    for a, b in itertools.combinations(shapes, 2):
        assert a.intersection(b).area == 0.0
    for shape in shapes:
        assert shape.convex_hull.area == pytest.approx(shape.area, abs=1e-9)


def test_neighbours_meet_without_a_step_except_at_the_kerb(graph):
    """Along every shared edge the two tops are level, or it is a kerb: at most 15 cm, road on the low side."""
    regions = solid(graph)
    ramps = 0
    for (ra, sa), (rb, sb) in itertools.combinations(regions, 2):
        edge = sa.intersection(sb)
        if edge.length < 1e-6:
            continue
        step = [
            height_at(ra.plane, *p) - height_at(rb.plane, *p)
            for p in map(edge.interpolate, np.linspace(0, edge.length, 7))
            for p in [(p.x, p.y)]
        ]
        on_road = [r.kind in ("road", "crosswalk") for r in (ra, rb)]
        if on_road[0] == on_road[1]:
            assert np.abs(step).max() < 1e-6, (ra.id, rb.id)
        else:
            up = -np.array(step) if on_road[0] else np.array(step)
            assert up.min() > -1e-6, (ra.id, rb.id)
            assert up.max() < 0.15 + 1e-6, (ra.id, rb.id)
            # a ramp's foot: level with the crosswalk along a metre and a half or more
            ramps += (
                {ra.kind, rb.kind} == {"crosswalk", "sidewalk"} and np.abs(step).max() < 1e-6 and edge.length >= 1.5
            )
    assert ramps == 2 * sum(r.kind == "crosswalk" for r in graph.ground)


def test_ramps_are_gentle_and_long_enough(graph):
    tilted = [r for r in graph.ground if r.plane[:2] != (0.0, 0.0) and "flare" not in r.id]
    assert tilted
    for region in tilted:
        x0, y0, x1, y1 = shapely.Polygon(region.polygon).bounds
        assert np.hypot(*region.plane[:2]) <= 1 / 8
        assert y1 - y0 >= 1.2
        assert x1 - x0 >= 1.5


def test_objects_stand_on_the_ground(graph):
    regions = solid(graph)
    for obj in graph.objects:
        spot = clearance.footprint(obj).centroid
        under = [(r, s) for r, s in regions if s.intersects(spot)]
        if is_house(obj):
            # its front stands on the ground, its back needs none
            under = [(r, s) for r, s in regions if s.intersection(clearance.footprint(obj)).area > 1.0]
        heights = [height_at(r.plane, spot.x, spot.y) for r, s in under]
        assert heights, obj.id
        foot = obj.center[2] - obj.size[2] / 2
        assert min(abs(foot - h) for h in heights) < 1e-3, obj.id


def test_nothing_stands_in_another_object(graph):
    solid_objects = [(o, clearance.footprint(o)) for o in graph.objects if clearance.is_obstacle(o)]
    for (a, fa), (b, fb) in itertools.combinations(solid_objects, 2):
        assert fa.intersection(fb).area < 0.02, (a.id, b.id)


def test_objects_are_in_the_way_but_a_robot_gets_by(graph):
    """A disc of 1.1 m passes each pavement from end to end, and at least five objects stand in its middle half."""
    street = street_of(graph.id)
    space = clearance.free_space(graph.ground, graph.objects)
    for side in (1, -1):
        near, far = side * street.section.half, side * street.section.front(side)
        assert clearance.reach_along(space, near, far) >= street.section.length - 2 * clearance.CLEARANCE
        width = street.section.width(side)
        right, left = sorted((near + side * 0.25 * width, near + side * 0.75 * width))
        middle = shapely.box(2.0, right, street.section.length - 2.0, left)
        blocking = [
            o for o in graph.objects if clearance.is_obstacle(o) and middle.contains(clearance.footprint(o).centroid)
        ]
        assert len(blocking) >= 5


def test_house_fronts_line_both_sides_and_close_both_ends(graph):
    """A ray from the middle of the street in any level direction meets a house."""
    fronts = shapely.union_all([clearance.footprint(o).buffer(0.02) for o in graph.objects if is_house(o)])
    section = street_of(graph.id).section
    for x in np.linspace(3.0, section.length - 3.0, 9):
        for angle in np.linspace(0.0, 2 * np.pi, 180, endpoint=False):
            ray = shapely.LineString([(x, 0.0), (x + 150 * np.cos(angle), 150 * np.sin(angle))])
            assert ray.intersects(fronts), (x, np.degrees(angle))


def test_streets_differ_in_character():
    """No two streets share more than 70 % of their labels, weighted by count and houses aside."""
    counts = []
    for scene_id in IDS:
        labels = [o.label for o in SceneGraph.load(SCENES / scene_id / "graph.json").objects]
        counts.append({name: labels.count(name) for name in set(labels) if catalogue.SIZES[name][0][0] < 5.4})
    for a, b in itertools.combinations(counts, 2):
        common = sum(min(a.get(k, 0), b.get(k, 0)) for k in a)
        assert common / max(sum(a.values()), sum(b.values())) < 0.7


def test_nobody_can_walk_behind_the_houses(graph):
    """Walkable ground is in front of the houses: the rest of it is one street, not a yard behind."""
    houses = shapely.union_all([clearance.footprint(o).buffer(0.02) for o in graph.objects if is_house(o)])
    open_ground = shapely.union_all([s for _, s in solid(graph)]).difference(houses).buffer(-0.3)
    pieces = [p for p in shapely.get_parts(open_ground) if p.area > 0.5]
    assert len(pieces) == 1
