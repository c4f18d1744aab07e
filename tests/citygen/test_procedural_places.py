"""The set `places`: ground, objects, lanes and variety of each template, counted on the graphs."""

import collections
import itertools
import re

import numpy as np
import pytest
import shapely

from urbanverse_mjx.citygen import clearance, procedural_places
from urbanverse_mjx.citygen.canvas.ground_layers import seams
from urbanverse_mjx.citygen.procedural_places import COUNT, TEMPLATES, build, site_of, stock, template_of
from urbanverse_mjx.citygen.procedural_places.site import Site
from urbanverse_mjx.datatypes import SceneGraph, ValidationError
from urbanverse_mjx.datatypes.ground import PAINT_KINDS, height_at
from urbanverse_mjx.scene.ground import check_regions, ground_prisms

#: One of each template, not the same as any other test compiles.
CHOSEN = range(len(TEMPLATES))


@pytest.fixture(scope="module", params=CHOSEN, ids=lambda k: template_of(k))
def site(request: pytest.FixtureRequest) -> Site:
    return site_of(request.param)


@pytest.fixture
def graph(site: Site) -> SceneGraph:
    return site.graph()


def _is_front(label: str) -> bool:
    return label == "wall" or label in stock.HOUSES + stock.SHEDS + stock.HOMES


def test_every_template_has_its_turn() -> None:
    turns = collections.Counter(template_of(k) for k in range(COUNT))
    assert set(turns) == set(TEMPLATES)
    assert max(turns.values()) - min(turns.values()) <= 1
    with pytest.raises(ValidationError, match=str(COUNT - 1)):
        build(COUNT)


def test_the_same_number_is_the_same_scene_and_another_another() -> None:
    assert build(9) == build(9)
    assert len({build(k).content_hash() for k in (0, 9, 18)}) == 3
    assert build(9).source.video == "procedural alley"


def test_the_ground_compiles(graph: SceneGraph) -> None:
    check_regions(graph.ground)
    assert len(ground_prisms(graph.ground)) < 150
    assert not seams([r for r in graph.ground if r.kind not in PAINT_KINDS])


def test_every_lane_can_be_driven_and_all_hang_together(site: Site) -> None:
    """A disc of 1.1 m gets along every lane, and from each to all others, without a kerb; free space is one piece."""
    solid = [r for r in site.graph().ground if r.kind in ("sidewalk", "ground", "crosswalk")]
    steps = shapely.union_all([shapely.buffer(edge, 0.02) for edge in _kerbs(site.graph())])
    free = clearance.free_space(solid, site.canvas.objects).difference(steps)
    largest = max(shapely.get_parts(free), key=lambda part: part.area)
    assert largest.area > 0.85 * free.area
    for lane in site.lanes:
        assert lane.difference(largest.buffer(0.08)).length < 0.05, lane


def _kerbs(graph: SceneGraph) -> list[shapely.Geometry]:
    """Borders between walkable regions that are a step of more than 3 cm."""
    regions = [(r, shapely.Polygon(r.polygon)) for r in graph.ground if r.kind in ("sidewalk", "ground", "crosswalk")]
    found = []
    for (a, p), (b, q) in itertools.combinations(regions, 2):
        edge = p.boundary.intersection(q.boundary) if p.distance(q) < 1e-3 else shapely.Point()
        for line in (part for part in shapely.get_parts(edge) if part.length > 0.02):
            points = [line.interpolate(t, normalized=True) for t in (0.1, 0.5, 0.9)]
            if max(abs(height_at(a.plane, c.x, c.y) - height_at(b.plane, c.x, c.y)) for c in points) > 0.03:
                found.append(line)
    return found


def test_nothing_stands_in_another_object(graph: SceneGraph) -> None:
    shapes = [clearance.footprint(o) for o in graph.objects]
    for i, j in shapely.STRtree(shapes).query(shapes, predicate="intersects").T:
        assert i >= j or shapes[i].intersection(shapes[j]).area < 0.01, (graph.objects[i].id, graph.objects[j].id)


def test_objects_stand_on_the_ground(graph: SceneGraph) -> None:
    regions = [(r, shapely.Polygon(r.polygon)) for r in graph.ground if r.kind not in PAINT_KINDS]
    astride = 0
    for o in (o for o in graph.objects if not _is_front(o.label)):
        spot = clearance.footprint(o).centroid
        under = [height_at(r.plane, spot.x, spot.y) for r, s in regions if s.dwithin(spot, 1e-6)]
        assert under, o.id
        above = o.center[2] - o.size[2] / 2 - max(under)
        assert -1e-3 < above < 0.13, o.id
        astride += above > 1e-3
    assert astride == 0 or "residential" in graph.id, "only cars half on a low kerb"


def test_fronts_close_the_view_on_all_sides(site: Site) -> None:
    """Of the rays from the middle of each lane at most one in 50 leaves the place without meeting a front."""
    fronts = shapely.union_all([clearance.footprint(o).buffer(0.1) for o in site.canvas.objects if _is_front(o.label)])
    out = 0
    for lane in site.lanes:
        camera_position = lane.interpolate(0.5, normalized=True)
        for angle in np.linspace(0.0, 2 * np.pi, 50, endpoint=False):
            ray = shapely.LineString(
                [camera_position, (camera_position.x + 300 * np.cos(angle), camera_position.y + 300 * np.sin(angle))]
            )
            out += not ray.intersects(fronts)
    assert out <= len(site.lanes), f"{out} of {50 * len(site.lanes)} rays"


def test_hulls_near_any_point_leave_slots(site: Site) -> None:
    """Counted anew from the boxes, at points off the raster that the site itself counts on."""
    graph_objects = [
        (clearance.footprint(o), stock.hulls(o.label, o.size, _is_front(o.label))) for o in site.canvas.objects
    ]
    tree = shapely.STRtree([shape for shape, _ in graph_objects])
    worst = 0
    for lane in site.lanes:
        for s in np.arange(0.0, lane.length, 0.5):
            near = tree.query(lane.interpolate(s), predicate="dwithin", distance=0.95)
            worst = max(worst, sum(graph_objects[k][1] for k in near))
    assert 0 < worst <= 18, "an engine has 16 slots where the streets need no more"


@pytest.fixture(scope="module")
def some() -> list[SceneGraph]:
    return [build(k) for k in range(0, COUNT, 7)]


@pytest.mark.extended
def test_labels_poses_and_densities_vary(some: list[SceneGraph]) -> None:
    assert len({o.label for g in some for o in g.objects}) >= 150
    askew = [abs(np.degrees(o.yaw) % 90.0 - 45.0) < 40.0 for g in some for o in g.objects if not _is_front(o.label)]
    assert np.mean(askew) > 0.5, "in free poses, not along the axes alone"
    counts = [sum(not _is_front(o.label) for o in g.objects) for g in some]
    assert max(counts) > 3 * min(counts)
    assert {label for mix in stock.MIXES.values() for label in mix} <= set(stock.SIZES)
    assert set(stock.HULLS) <= set(stock.SIZES)


def test_decks_have_ramps() -> None:
    decks = [g for g in map(build, (2, 11, 20)) if any(r.id == "deck" for r in g.ground)]
    assert decks
    for graph in decks:
        slopes = [np.hypot(*r.plane[:2]) for r in graph.ground if re.match(r"ramp_(up|down)", r.id)]
        assert len(slopes) == 2
        assert max(slopes) <= 0.101


def test_alleys_are_narrow() -> None:
    site = site_of(0)
    walls = shapely.union_all([shapely.Polygon(r.polygon) for r in site.canvas.regions if r.id == "alley"]).boundary
    reach = [walls.distance(lane.interpolate(s)) for lane in site.lanes for s in np.arange(0.0, lane.length, 1.0)]
    assert 0.6 < min(reach)
    assert np.median(reach) < 2.0


def test_the_library_builds_the_set_as_committed() -> None:
    from urbanverse_mjx.pipeline.library.building import graph_of, layouts_of
    from urbanverse_mjx.scene import library

    scenes = library.scene_set("places")
    assert len(layouts_of(scenes)) == procedural_places.COUNT == 96
    assert graph_of(scenes, "places_005").ground == build(5).ground
    known = library.shipped_hashes("places")
    assert set(known) == set(layouts_of(scenes))
    for layout in ("places_009", "places_011", "places_014"):
        assert graph_of(scenes, layout).content_hash() == known[layout]["graph"], layout
