"""No two things in one place, and the moves that see to it."""

import math
import pathlib

import pytest
import shapely
from shapely import affinity

from urbanverse_mjx.citygen import BUILDERS, catalogue
from urbanverse_mjx.datatypes import GraphObject, GroundRegion, SceneGraph, Source
from urbanverse_mjx.materialisation import materialise
from urbanverse_mjx.materialisation.overlap import TOUCH

from .fake_index import box_hulls, fake_index

SCENES = pathlib.Path(__file__).parents[2] / "scenes"

Size = tuple[float, float, float]

PAVEMENT = GroundRegion("pavement", "sidewalk", ((-30, 0), (30, 0), (30, 8), (-30, 8)), (0.0, 0.0, 0.15))
ROAD = GroundRegion("road", "road", ((-30, -8), (30, -8), (30, 0), (-30, 0)), (0.0, 0.0, 0.0))


def at(
    name: str, label: str, x: float, y: float, size: tuple[float, float, float], yaw: float = 0.0, foot: float = 0.15
):
    return GraphObject(name, label, (x, y, foot + size[2] / 2), size, yaw)


def run(*objects: GraphObject):
    graph = SceneGraph("little", Source("hand", "Apache-2.0", "none", "none"), objects, (PAVEMENT, ROAD))
    done = materialise(graph, fake_index(), 5, hulls_of=box_hulls)
    return done, {o.id: o for o in done.layout.objects}


def rectangle(placed) -> tuple[shapely.Polygon, float, float]:
    """Footprint and heights of a placed box, computed without the room under test."""
    x, y, z = (e * s for e, s in zip(fake_index().get(placed.asset_uid).extent_xyz, placed.scale, strict=True))
    flat = affinity.rotate(shapely.box(-x / 2, -y / 2, x / 2, y / 2), placed.yaw, origin=(0, 0), use_radians=True)
    px, py, pz = placed.position
    return affinity.translate(flat, px, py), pz, pz + z


def shared_area(a, b) -> float:
    (pa, la, ha), (pb, lb, hb) = rectangle(a), rectangle(b)
    return pa.intersection(pb).area if min(ha, hb) - max(la, lb) > 0.011 else 0.0


def test_the_light_movable_thing_gives_way_and_the_house_never():
    done, placed = run(
        at("house", "bakery", 0, 5.0, (8.0, 7.5, 8.0), math.pi / 2),
        at("cone", "traffic cone", 3.9, 4.0, (0.36, 0.36, 0.7)),
    )
    assert placed["house"].position[:2] == (0.0, 5.0)
    assert [name for name, _ in done.moved] == ["cone"]
    assert not done.unresolved
    assert shared_area(placed["house"], placed["cone"]) < 0.01 * 0.36 + 1e-9
    assert math.dist(placed["cone"].position[:2], (3.9, 4.0)) <= 0.5 + 1e-6


def test_the_least_move_that_is_free_is_taken():
    done, _ = run(at("bin", "trash bin", 0, 4, (0.6, 0.6, 1.05)), at("bag", "garbage bag", 0.47, 4, (0.5, 0.5, 0.5)))
    # 8 cm deep at scale 1: two steps of 5 cm straight away from the bin, or one if the bag was drawn 3 % smaller
    assert done.moved[0][0] == "bag"
    assert done.moved[0][1] <= 0.1


def test_what_half_a_metre_cannot_part_is_reported_and_left():
    done, placed = run(
        at("one", "bakery", 0, 5.0, (8.0, 7.5, 8.0), math.pi / 2),
        at("two", "bank", 2.0, 5.0, (8.0, 10.0, 9.0), math.pi / 2),
    )
    assert done.unresolved == (("one", "two"),)
    assert not done.moved
    assert placed["two"].position[:2] == (2.0, 5.0)


def test_things_at_different_heights_may_share_a_plan():
    done, _ = run(
        at("car", "sedan", 0, -3, (4.6, 1.82, 1.45), foot=0.0),
        at("sign", "directional sign", 0, -3, (0.15, 1.0, 2.6), foot=2.0),
    )
    assert not done.moved
    assert not done.unresolved


def test_no_move_takes_a_thing_over_the_kerb():
    done, placed = run(
        at("booth", "telephone booth", 0.0, 1.0, (0.9, 0.9, 2.3)), at("bag", "garbage bag", 0.0, 0.42, (0.5, 0.5, 0.5))
    )
    assert placed["bag"].position[1] > 0.0
    assert not done.unresolved
    assert placed["bag"].position[2] == pytest.approx(0.15)


@pytest.mark.parametrize("scene_id", list(BUILDERS))
def test_shipped_streets_have_no_penetration_left(scene_id):
    """All pairs, not only those the room looked at: an independent count over rectangles finds none either."""
    done = materialise(SceneGraph.load(SCENES / scene_id / "graph.json"), fake_index(), 0, hulls_of=box_hulls)
    assert done.unresolved == ()
    solid = [o for o in done.layout.objects if o.category not in catalogue.STEMS]
    shapes = [rectangle(o) for o in solid]
    tree = shapely.STRtree([s[0] for s in shapes])
    for i, j in tree.query([s[0] for s in shapes], predicate="intersects").T:
        if i < j and min(shapes[i][2], shapes[j][2]) - max(shapes[i][1], shapes[j][1]) > TOUCH:
            common = shapes[i][0].intersection(shapes[j][0])
            # penetrations under `TOUCH` are let be: a sliver no wider than that
            assert common.buffer(-TOUCH / 2).is_empty, (solid[i].id, solid[j].id)
    kinds = {o.id: o.category for o in done.layout.objects}
    by_id = {o.id: o for o in done.layout.objects}
    for name, metres in done.moved:
        assert 0.0 < metres <= 0.5 + 1e-3
        assert kinds[name] not in {"tree", "street light", "lamppost", "bakery", "apartment building"}
    assert all(math.isfinite(c) for o in by_id.values() for c in o.position)
