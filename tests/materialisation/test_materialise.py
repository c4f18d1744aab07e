"""Choice, placement, materials and the refusal of what is not known."""

import dataclasses
import math
import pathlib

import numpy as np
import pytest

from urbanverse_mjx.assets import category_of
from urbanverse_mjx.assets.appearances import looks
from urbanverse_mjx.assets.appearances.ground_materials import build_material
from urbanverse_mjx.datatypes import GraphObject, GroundRegion, NounError, SceneGraph, SceneLayout, Source
from urbanverse_mjx.materialisation import choice, materialise

from .fake_index import box_hulls, fake_index, record

SCENES = pathlib.Path(__file__).parents[2] / "scenes"
SOURCE = Source("hand", "Apache-2.0", "none", "none")
FLOOR = GroundRegion("floor", "sidewalk", ((-20, -20), (20, -20), (20, 20), (-20, 20)), (0.0, 0.0, 0.15))


def graph_of(*objects: GraphObject, ground: tuple[GroundRegion, ...] = (FLOOR,)) -> SceneGraph:
    return SceneGraph("little", SOURCE, objects, ground)


def thing(name: str, label: str, x: float, y: float, size: tuple[float, float, float], yaw: float = 0.0) -> GraphObject:
    return GraphObject(name, label, (x, y, 0.15 + size[2] / 2), size, yaw)


def world_box(placed, extent) -> np.ndarray:
    """(8, 3) corners of a placed asset's box, from the documented pose convention alone."""
    half = np.array(extent) * placed.scale / [2, 2, 1]
    corners = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (0, 1)]) * half
    c, s = math.cos(placed.yaw), math.sin(placed.yaw)
    return corners @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]).T + placed.position


@pytest.mark.parametrize(
    ("label", "size", "yaw"),
    [
        ("bench", (0.65, 1.8, 0.85), -math.pi / 2),  # sits across its heading, looks at the street to the south
        ("sedan", (4.6, 1.82, 1.45), math.pi),  # drives west, long along its heading
        ("bakery", (8.0, 7.5, 8.0), math.pi / 2),  # shop front looking north: deeper than wide
    ],
)
def test_box_of_the_graph_comes_back_from_the_pose(label, size, yaw):
    layout = materialise(graph_of(thing("it", label, 3.0, -2.0, size, yaw)), fake_index(), 1, hulls_of=box_hulls).layout
    placed = layout.objects[0]
    corners = world_box(placed, fake_index().get(placed.asset_uid).extent_xyz)
    along, across = size[:2]
    turned = abs(math.sin(yaw)) > 0.5
    want = np.array([across, along] if turned else [along, across])
    low, high = corners.min(0), corners.max(0)
    np.testing.assert_allclose((high - low)[:2], want, rtol=0.011)
    np.testing.assert_allclose((high + low)[:2] / 2, [3.0, -2.0], atol=1e-6)
    assert low[2] == pytest.approx(0.15)
    assert high[2] - low[2] == pytest.approx(size[2], rel=0.011)


def test_least_distorted_asset_wins_whatever_the_seed():
    long_one = thing("it", "sedan", 0, 0, (4.6 * 1.4, 1.82, 1.45))
    for seed in range(12):
        layout = materialise(graph_of(long_one), fake_index(), seed, hulls_of=box_hulls).layout
        assert layout.objects[0].asset_uid == "sedan/box/002"


def test_near_ties_are_all_used_and_worse_ones_never():
    cars = [thing(f"c{i}", "sedan", 8.0 * (i - 2), 0, (4.6, 1.82, 1.45)) for i in range(4)]
    used = set()
    for seed in range(8):
        layout = materialise(graph_of(*cars), fake_index(), seed, hulls_of=box_hulls).layout
        used |= {o.asset_uid for o in layout.objects}
    assert used == {"sedan/box/000", "sedan/box/001"}


def test_distortion_compares_longer_side_with_longer_side():
    bench = record("bench", 0, (0.65, 1.8, 0.85), False)
    assert choice.distortion((1.8, 0.65, 0.85), bench) == pytest.approx(0.0)
    assert choice.distortion((0.65, 1.8, 1.7), bench) == pytest.approx(math.log(2.0))


def test_scale_is_bounded_for_furniture_and_free_for_house_fronts():
    bench = record("bench", 0, (0.65, 1.8, 0.85), False)
    bakery = record("bakery", 0, (8.0, 7.5, 8.0), False)
    assert choice.scale_to((0.65 * 3, 1.8 * 3, 0.85 * 3), bench) == (1.25, 1.25, 1.25)
    assert choice.scale_to((0.65 * 1.2, 1.8, 0.85 / 1.2), bench) == pytest.approx((1.09, 1.0, 0.92))
    assert choice.scale_to((4.0, 9.0, 12.0), bakery) == (0.5, 1.2, 1.5)


def test_mass_grows_with_the_volume_factor_and_friction_comes_from_the_record():
    shrunk = thing("it", "bench", 0, 0, (0.65 * 0.9, 1.8 * 0.9, 0.85 * 0.9))
    index = fake_index()
    placed = materialise(graph_of(shrunk), index, 3, hulls_of=box_hulls).layout.objects[0]
    asset = index.get(placed.asset_uid)
    assert placed.mass == pytest.approx(asset.mass * math.prod(placed.scale), abs=1e-3)
    assert placed.friction == asset.friction_coefficient
    assert placed.movable == asset.movable
    assert placed.category == "bench" == asset.leaf
    assert category_of(placed.category) == asset.category


def test_feet_near_the_ground_are_put_onto_it_and_hanging_things_stay():
    ramp = GroundRegion("ramp", "sidewalk", ((0, 0), (2, 0), (2, 1.5), (0, 1.5)), (0.0, 0.1, 0.0))
    sunk = GraphObject("sunk", "bollard", (1.0, 1.0, 0.3), (0.2, 0.2, 0.95), 0.0)
    hung = GraphObject("hung", "directional sign", (1.0, 0.5, 4.0), (0.15, 1.0, 2.6), 0.0)
    layout = materialise(graph_of(sunk, hung, ground=(ramp,)), fake_index(), 0, hulls_of=box_hulls).layout
    assert layout.objects[0].position[2] == pytest.approx(0.1)
    assert layout.objects[1].position[2] == pytest.approx(4.0 - 1.3)


def test_same_inputs_same_layout_and_cousins_differ():
    graph, index = SceneGraph.load(SCENES / "park_edge" / "graph.json"), fake_index()
    first = materialise(graph, index, 7, hulls_of=box_hulls).layout
    again = materialise(graph, index, 7, hulls_of=box_hulls).layout
    assert first.to_json() == again.to_json()
    assert first.content_hash() == again.content_hash()
    cousin = materialise(graph, index, 7, cousin=1, hulls_of=box_hulls).layout
    other_seed = materialise(graph, index, 8, hulls_of=box_hulls).layout
    assert cousin.id == "park_edge_cousin1"
    assert cousin.graph_hash == first.graph_hash == graph.content_hash()
    for other in (cousin, other_seed):
        changed = [a.asset_uid != b.asset_uid for a, b in zip(first.objects, other.objects, strict=True)]
        assert 0.2 < np.mean(changed) < 0.8  # two near ties a leaf: about half change
    assert SceneLayout.from_json(first.to_json()) == first


def test_one_material_per_kind_except_that_separate_pavements_may_differ():
    graph, index = SceneGraph.load(SCENES / "commercial_cafes" / "graph.json"), fake_index()
    sides = set()
    for seed in range(6):
        layout = materialise(dataclasses.replace(graph, objects=()), index, seed, hulls_of=box_hulls).layout
        by_kind: dict[str, set[str]] = {}
        for region in layout.ground:
            by_kind.setdefault(region.kind, set()).add(region.material)
        assert all(len(found) == 1 for kind, found in by_kind.items() if kind != "sidewalk")
        left = {r.material for r in layout.ground if r.id.startswith("left_") and r.kind == "sidewalk"}
        assert len(left) == 1
        sides.add(len(by_kind["sidewalk"]))
        assert [(r.id, r.polygon, r.plane) for r in layout.ground] == [(r.id, r.polygon, r.plane) for r in graph.ground]
    assert max(sides) > 1


def test_unknown_label_is_refused_with_the_object_and_three_leaves_that_have_assets():
    index = fake_index()
    with pytest.raises(NounError) as caught:
        materialise(graph_of(thing("o7", "park bensh", 0, 0, (0.6, 1.8, 0.9))), index, 0, hulls_of=box_hulls)
    message = str(caught.value)
    assert "object 'o7'.label" in message
    assert "'park bensh'" in message
    assert "'bench'" in message
    assert sum(f"{leaf!r}" in message for leaf in index.leaves) == 3
    assert "--skip-unknown" in message


def test_leaf_without_any_asset_is_refused_too():
    with pytest.raises(NounError, match=r"object 'o1'\.label: found 'piano'"):
        materialise(graph_of(thing("o1", "piano", 0, 0, (1, 1, 1))), fake_index(), 0, hulls_of=box_hulls)


def test_skip_unknown_leaves_out_and_lists_what_it_does_not_know():
    graph = graph_of(
        thing("a", "zorblax", 0, 0, (1, 1, 1)),
        thing("b", "bench", 5, 0, (0.65, 1.8, 0.85)),
        thing("c", "piano", 9, 0, (1, 1, 1)),
    )
    done = materialise(graph, fake_index(), 0, skip_unknown=True, hulls_of=box_hulls)
    assert done.skipped == (("a", "zorblax"), ("c", "piano"))
    assert [o.id for o in done.layout.objects] == ["b"]


@pytest.mark.parametrize(("seed", "cousin"), [(-1, 0), (0, -1), (0.5, 0), (True, 0)])
def test_seed_and_cousin_are_whole_numbers(seed, cousin):
    with pytest.raises(NounError):
        materialise(graph_of(), fake_index(), seed, cousin, hulls_of=box_hulls)


def test_descriptors_choose_materials_and_sky():
    """Each piece gets the material whose descriptor it has; a scene without any keeps drawing them."""
    uids = {"path": "sidewalk/brick_red_herringbone", "lawn": "grass", "far": "sidewalk/asphalt_red"}
    sky = "autumn_noon-overcast"

    def square(name: str, kind: str, x: float) -> GroundRegion:
        ring = ((x, 0), (x + 2, 0), (x + 2, 2), (x, 2))
        picture = build_material(uids[name]).texture
        return GroundRegion(name, kind, ring, (0.0, 0.0, 0.0), looks.ground_descriptor(picture))

    ground = (square("path", "sidewalk", 0), square("lawn", "ground", 2), square("far", "sidewalk", 4))
    graph = dataclasses.replace(graph_of(ground=ground), sky_descriptor=looks.own_sky_descriptor(sky))
    layout = materialise(graph, fake_index(), 3).layout
    assert {g.id: g.material for g in layout.ground} == uids
    assert layout.sky == sky
    assert materialise(graph, fake_index(), 3, cousin=1).layout.ground != layout.ground


def test_named_materials_lie_side_by_side():
    """Touching regions wear the materials whose own descriptors they have; the rest of the piece joins the first."""

    def square(name: str, kind: str, x: float, descriptor: tuple[int, ...] | None) -> GroundRegion:
        return GroundRegion(name, kind, ((x, 0), (x + 2, 0), (x + 2, 2), (x, 2)), (0.0, 0.0, 0.0), descriptor)

    flags, brick = (looks.own_ground_descriptor(f"sidewalk/{n}") for n in ("flags_buff", "brick_charcoal"))
    grass, gravel = (looks.ground_descriptor(build_material(n).texture) for n in ("grass", "gravel"))
    ground = (
        square("a", "sidewalk", 0, flags),
        square("b", "sidewalk", 2, brick),
        square("c", "sidewalk", 4, None),
        square("d", "ground", 6, grass),
        square("e", "ground", 8, gravel),
    )
    layout = materialise(graph_of(ground=ground), fake_index(), 0).layout
    wanted = ["sidewalk/flags_buff", "sidewalk/brick_charcoal", "sidewalk/flags_buff", "grass", "gravel"]
    assert [g.material for g in layout.ground] == wanted
    blurred = dataclasses.replace(ground[1], descriptor=(brick[0] + 1, *brick[1:]))
    mixed = materialise(graph_of(ground=(ground[0], blurred, *ground[2:])), fake_index(), 0).layout
    assert len({g.material for g in mixed.ground if g.kind == "sidewalk"}) == 1
