"""The six streets with assets of the catalogue and their collision hulls."""

import collections
import math
import pathlib

import numpy as np
import pytest
import shapely

from urbanverse_mjx.assets import load_hulls
from urbanverse_mjx.citygen import BUILDERS, clearance
from urbanverse_mjx.datatypes import SceneGraph
from urbanverse_mjx.materialisation import index_of, materialise_cousin, overlap

SCENES = pathlib.Path(__file__).parents[2] / "scenes"
ROLLED_OVER = ("manhole cover", "grass patch")
ROBOT_HEIGHT = 1.2  # m, a COCO with its flag mast down is 1.0 m high


@pytest.fixture(scope="module", params=list(BUILDERS))
def street(request):
    graph = SceneGraph.load(SCENES / request.param / "graph.json")
    return graph, materialise_cousin(graph)


def outline(placed, corners: np.ndarray) -> shapely.Geometry:
    """A hull from above in the scene frame, from the documented pose convention alone."""
    c, s = math.cos(placed.yaw), math.sin(placed.yaw)
    flat = (corners * np.array(placed.scale))[:, :2] @ np.array([[c, s], [-s, c]]) + placed.position[:2]
    return shapely.MultiPoint(flat).convex_hull


def test_everything_found_an_asset_and_a_place_of_its_own(street):
    graph, done = street
    assert done.left_out == ()
    assert done.unresolved == ()
    assert len(done.layout.objects) == len(graph.objects)
    moved = dict(done.moved)
    for obj, placed in zip(graph.objects, done.layout.objects, strict=True):
        shift = math.dist(obj.center[:2], placed.position[:2])
        assert shift <= 0.5 + 1e-3
        assert (shift > 1e-3) == (obj.id in moved)
    assert len(moved) <= 0.1 * len(graph.objects)


def test_no_two_hulls_share_a_place(street):
    """An independent count over all pairs of hulls of different objects, level by level."""
    _, done = street
    index, shapes = index_of(done.layout), []
    for number, placed in enumerate(done.layout.objects):
        for corners in load_hulls(index.get(placed.asset_uid)).hulls:
            z = corners[:, 2] * placed.scale[2] + placed.position[2]
            shapes.append((number, outline(placed, corners), z.min(), z.max()))
    for i, j in shapely.STRtree([s[1] for s in shapes]).query([s[1] for s in shapes], predicate="intersects").T:
        (a, pa, la, ha), (b, pb, lb, hb) = shapes[i], shapes[j]
        if a < b and min(ha, hb) - max(la, lb) > overlap.PENETRATION_TOLERANCE:
            # less than `TOUCH` deep is let be: a sliver no wider than that
            assert pa.intersection(pb).buffer(-overlap.PENETRATION_TOLERANCE / 2).is_empty, (a, b)


def test_assets_are_as_large_as_the_graph_says(street):
    """The longer side, the shorter side and the height are within a third, for nine in ten within a tenth."""
    graph, done = street
    index, errors = index_of(done.layout), []
    for obj, placed in zip(graph.objects, done.layout.objects, strict=True):
        extent = np.array(index.get(placed.asset_uid).extent_xyz) * placed.scale
        errors.append(np.abs(np.log(extent / obj.size)).max())
    assert max(errors) < math.log(4 / 3)
    assert np.quantile(errors, 0.9) < 0.1


def test_assets_differ_as_they_do_in_a_street(street):
    """Nearly half as many assets as objects (series share an asset), and no person asset is repeated often."""
    _, done = street
    counts = collections.Counter(placed.asset_uid for placed in done.layout.objects)
    assert len(counts) >= 0.45 * len(done.layout.objects)
    people = [counts[p.asset_uid] for p in done.layout.objects if done.chosen[p.id].record.category[0] == "street user"]
    assert max(people, default=0) <= 3


def test_a_robot_gets_by_the_real_objects_on_both_pavements(street):
    """Hulls below a robot's height, as they collide: a disc of 1.1 m still passes from end to end."""
    graph, done = street
    index = index_of(done.layout)
    taken = []
    for placed in done.layout.objects:
        if placed.category in ROLLED_OVER:
            continue
        for corners in load_hulls(index.get(placed.asset_uid)).hulls:
            if corners[:, 2].min() * placed.scale[2] < ROBOT_HEIGHT:
                taken.append(outline(placed, corners))
    reach = clearance.CLEARANCE / 2
    blocked = shapely.union_all(taken).buffer(reach, quad_segs=4)
    free = clearance.walkable(graph.ground).buffer(-reach, join_style="mitre").difference(blocked)
    section = BUILDERS[graph.id]().section
    for side in (1, -1):
        length = clearance.reach_along(free, side * section.half, side * section.front(side))
        assert length >= section.length - 2 * clearance.CLEARANCE
