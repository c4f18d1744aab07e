"""Cousins over the catalogue: the same places and affordances, other assets; every node placed or named."""

import dataclasses
import math
from typing import Any

import numpy as np
import pytest

from urbanverse_mjx import settings
from urbanverse_mjx.assets import category_of, load_hulls
from urbanverse_mjx.assets.appearances import appearance_search
from urbanverse_mjx.assets.appearances.ground_materials import build_material
from urbanverse_mjx.assets.records.index import build_mesh
from urbanverse_mjx.assets.selection import descriptors
from urbanverse_mjx.datatypes import GraphObject, GroundRegion, SceneGraph, SceneLayout, Source, ValidationError
from urbanverse_mjx.materialisation import check_labels, index_of, materialise_cousin, materialise_cousins, overlap
from urbanverse_mjx.materialisation.shortlists import affordances

from .catalogue_part import few_objects

SOURCE = Source("hand", "Apache-2.0", "none", "none")
ROAD = GroundRegion("road", "road", ((-30, -8), (30, -8), (30, 0), (-30, 0)), (0.0, 0.0, 0.0))
WALK = GroundRegion("walk", "sidewalk", ((-30, 0), (30, 0), (30, 8), (-30, 8)), (0.0, 0.0, 0.15))
SIZES = {
    "bench": (0.65, 1.8, 0.85),
    "sedan": (4.6, 1.82, 1.45),
    "bollard": (0.2, 0.2, 0.95),
    "pedestrian adult": (0.45, 0.55, 1.72),
}


def obj(name: str, label: str, x: float, y: float, z: float = 0.15, yaw: float = 0.0, **more) -> GraphObject:
    size = more.pop("size", SIZES.get(label, (1.0, 1.0, 1.0)))
    return GraphObject(name, label, (x, y, z + size[2] / 2), size, yaw, **more)


def street(*objects: GraphObject, **more) -> SceneGraph:
    ground = more.pop("ground", (ROAD, WALK))
    return SceneGraph("little", SOURCE, objects, ground, **more)


OBJECTS = (
    obj("bench", "bench", 0, 5, yaw=-math.pi / 2),
    obj("car", "sedan", 5, -4, 0.0),
    *(obj(f"post_{k}", "bollard", 2.0 * k - 20, 0.5) for k in range(4)),
    *(obj(f"man_{k}", "pedestrian adult", 2.0 * k - 20, 4.0) for k in range(4)),
)


@pytest.fixture(scope="module")
def cousins():
    return materialise_cousins(street(*OBJECTS), 5, seed=3, objects=few_objects())


def test_the_same_inputs_give_the_same_layouts_and_another_seed_others(cousins):
    again = materialise_cousins(street(*OBJECTS), 5, seed=3, objects=few_objects())
    assert [c.layout.to_json() for c in again] == [c.layout.to_json() for c in cousins]
    other = materialise_cousins(street(*OBJECTS), 5, seed=4, objects=few_objects())
    assert other[0].layout.to_json()["objects"] != cousins[0].layout.to_json()["objects"]
    for cousin in cousins:
        assert SceneLayout.from_json(cousin.layout.to_json()) == cousin.layout


def test_a_cousin_is_the_same_alone_and_among_any_number(cousins):
    """With and without descriptors: the draw among near matches must not depend on the number of cousins."""
    image = np.random.default_rng(1).integers(0, 255, (60, 90, 3)).astype(np.uint8)
    appearance = tuple(map(int, descriptors.of_image(image)))
    seen = [dataclasses.replace(node, descriptor=appearance) for node in OBJECTS[:2]]
    walk = dataclasses.replace(WALK, descriptor=appearance_search.own_ground_descriptor("sidewalk/flags_buff"))
    graph = street(
        *seen,
        *OBJECTS[2:],
        ground=(ROAD, walk),
        sky_descriptor=appearance_search.own_sky_descriptor("autumn_noon-overcast"),
    )
    described = materialise_cousins(graph, 7, seed=3, objects=few_objects())
    for k in (0, 3, 6):
        assert materialise_cousin(graph, k, 3, objects=few_objects()).layout == described[k].layout
    for k in (1, 4):
        assert materialise_cousin(street(*OBJECTS), k, 3, objects=few_objects()).layout == cousins[k].layout
    assert materialise_cousins(graph, 2, seed=3, objects=few_objects())[1].layout == described[1].layout


def test_mass_grows_with_the_volume_factor_and_friction_comes_from_the_record(cousins):
    for cousin in cousins:
        for placed in cousin.layout.objects:
            asset = cousin.chosen[placed.id].record
            assert placed.mass == pytest.approx(asset.mass * math.prod(placed.scale), abs=1e-3)
            assert placed.friction == asset.friction_coefficient
            assert placed.movable == asset.movable
            assert placed.category == asset.leaf
            assert category_of(placed.category) == asset.category


def test_feet_near_the_ground_are_put_onto_it_and_hanging_objects_stay():
    ramp = GroundRegion("ramp", "sidewalk", ((0, 0), (2, 0), (2, 1.5), (0, 1.5)), (0.0, 0.1, 0.0))
    sunk = GraphObject("sunk", "bollard", (1.0, 1.0, 0.3), (0.2, 0.2, 0.95), 0.0)
    hung = GraphObject("hung", "directional sign", (1.0, 0.5, 4.0), (0.15, 1.0, 2.6), 0.0)
    placed = materialise_cousin(street(sunk, hung, ground=(ramp,)), objects=few_objects()).layout.objects
    assert placed[0].position[2] == pytest.approx(0.1)
    assert placed[1].position[2] == pytest.approx(4.0 - 1.3)


def test_a_label_without_an_asset_is_named_with_the_object_and_the_nearest_leaves():
    check_labels(street(*OBJECTS), few_objects())
    with pytest.raises(ValidationError) as caught:
        check_labels(street(*OBJECTS, obj("o7", "zqxv", 0, 0)), few_objects())
    message = str(caught.value)
    assert "object 'o7'.label: found 'zqxv'" in message
    assert "--skip-unknown" in message
    assert message.count("'") >= 10, "three leaves are named"
    with pytest.raises(ValidationError, match=r"'walk_2'\.label: found 'sidewalk' \('sidewalk' is ground"):
        check_labels(street(obj("walk_2", "sidewalk", 0, 0)), few_objects())


def test_cousins_keep_places_headings_and_affordances_and_differ_in_looks_and_physics(cousins):
    names = [c.layout.id for c in cousins]
    assert names == ["little", "little_cousin1", "little_cousin2", "little_cousin3", "little_cousin4"]
    for k, node in enumerate(OBJECTS):
        placed = [c.layout.objects[k] for c in cousins]
        records = [c.chosen[node.id].record for c in cousins]
        assert [p.id for p in placed] == [node.id] * 5
        assert len({p.asset_uid for p in placed}) == 5
        assert len({(p.mass, p.friction) for p in placed}) > 1
        assert len({affordances(r) for r in records}) == 1
        for p, r in zip(placed, records, strict=True):
            assert math.dist(p.position[:2], node.center[:2]) <= overlap.MAX_MOVE
            assert math.cos(p.yaw - node.yaw) == pytest.approx(1.0, abs=1e-6)
            assert np.abs(np.log(np.array(r.extent_xyz) * p.scale / node.size)).max() < math.log(4 / 3)
    for field in ("sky", "sky_yaw"):
        assert len({getattr(c.layout, field) for c in cousins}) == 5
    for region in range(2):
        assert len({c.layout.ground[region].material for c in cousins}) == 5
        assert len({(c.layout.ground[region].polygon, c.layout.ground[region].plane) for c in cousins}) == 1


def test_what_comes_in_series_looks_alike_and_people_do_not(cousins):
    for cousin in cousins:
        assert len({o.asset_uid for o in cousin.layout.objects if o.label == "bollard"}) == 1
        assert len({o.asset_uid for o in cousin.layout.objects if o.label == "pedestrian adult"}) > 1


def test_a_layout_is_compiled_from_its_own_records(cousins):
    index = index_of(cousins[0].layout, few_objects())
    for placed in cousins[0].layout.objects:
        record = index.get(placed.asset_uid)
        assert build_mesh(record).extent == pytest.approx(record.extent_xyz, abs=1e-3)
        assert load_hulls(record).hulls


def test_every_node_is_placed_or_named_with_a_reason():
    nodes = (
        *OBJECTS,
        obj("what", "zqxv", 10, 5),
        obj("ground", "sidewalk", 12, 5, size=(4.0, 4.0, 0.1)),
        obj("again", "sedan", 5.3, -4.1, 0.0, score=0.4),
    )
    for cousin in materialise_cousins(street(*nodes), 2, objects=few_objects()):
        gone = {entry.id: entry.reason for entry in cousin.left_out}
        assert {o.id for o in cousin.layout.objects} | gone.keys() == {n.id for n in nodes}
        assert gone.keys() == {"what", "ground", "again"}
        assert "no leaf" in gone["what"]
        assert "regions" in gone["ground"]
        assert "the same object" in gone["again"]


def test_nothing_shares_a_place_and_moves_are_small(cousins):
    near = [obj(f"man_{k}", "pedestrian adult", 0.25 * k, 4.0) for k in range(3)]
    for cousin in materialise_cousins(street(*near), 3, objects=few_objects()):
        bodies = [
            overlap.Body(p, cousin.chosen[p.id].record, overlap.prisms_of(p, load_hulls(cousin.chosen[p.id].record)))
            for p in cousin.layout.objects
        ]
        assert not overlap.penetrating_pairs(bodies)
        assert all(distance <= overlap.MAX_MOVE + 1e-6 for _, distance in cousin.moved)


def test_the_nearest_cousin_is_what_was_seen(cousins):
    """A node with a record's box and descriptor gets that record, or one of equal similarity."""
    record = cousins[2].chosen["car"].record
    appearance = tuple(int(x) for x in _own_descriptor(record))
    node = obj("car", "sedan", 5, -4, 0.0, size=record.extent_xyz, descriptor=appearance)
    best, *others = materialise_cousins(street(node), 5, seed=9, objects=few_objects())
    distances = [c.chosen["car"].match.appearance_distance or 0.0 for c in (best, *others)]
    assert distances[0] == min(distances)
    assert best.chosen["car"].match.distortion < 0.1


def _own_descriptor(record) -> np.ndarray:
    mesh = build_mesh(record)
    colours = mesh.texture.reshape(-1, 3)[:: max(1, mesh.texture.size // 3 // 1024)]
    return descriptors.of_image(colours[: len(colours) // 16 * 16].reshape(16, -1, 3))


def test_a_quarter_turn_is_taken_only_where_the_box_lies_across():
    wide = obj("across", "bench", 0, 5, size=(1.8, 0.65, 0.85))
    almost = obj("square", "bollard", 5, 5, size=(0.2, 0.22, 0.95))
    path = ((0.0, 2.0, 1.6, 0.0), (5.0, 2.0, 1.6, 0.0))
    for cousin in materialise_cousins(street(wide, almost, camera_path=path), 3, objects=few_objects()):
        bench, post = cousin.layout.objects
        assert bench.yaw == pytest.approx(-math.pi / 2, abs=1e-3)  # its front towards the trajectory
        assert post.yaw == pytest.approx(0.0)


def test_ground_and_sky_are_what_was_seen():
    walk, road, sky = (
        appearance_search.sidewalk.get_uids_all()[40],
        appearance_search.road.get_uids_all()[7],
        appearance_search.sky.get_uids_all()[123],
    )
    half = appearance_search.SKY_THUMBNAIL[0] // 2
    crops = {
        "walk": appearance_search.ground_descriptor(appearance_search.sidewalk.load_thumbnails([walk])[walk]),
        "road": appearance_search.ground_descriptor(appearance_search.road.load_thumbnails([road])[road]),
    }
    seen = appearance_search.sky_descriptor(appearance_search.sky.load_thumbnails([sky])[sky][half // 2 : half])
    ground = tuple(dataclasses.replace(r, descriptor=crops[r.id]) for r in (ROAD, WALK))
    best, *others = materialise_cousins(street(ground=ground, sky_descriptor=seen), 4, objects=few_objects())
    assert {r.id: r.material for r in best.layout.ground} == {"road": road, "walk": walk}
    assert best.layout.sky == sky
    ranked = [uid for uid, _ in appearance_search.rank_skies(seen)[:8]]
    assert all(c.layout.sky in ranked for c in others)


def test_a_sky_like_none_is_not_matched():
    black = appearance_search.sky_crop_descriptor(np.zeros((8, 8, 3), np.uint8), np.ones((8, 8), bool))
    found = materialise_cousins(street(sky_descriptor=black), 3, objects=few_objects())
    by_time = appearance_search.sky.load_annotations([c.layout.sky for c in found])
    assert all(record["time"] in ("morning", "noon", "afternoon", "evening") for record in by_time.values())
    assert all(c.sky.distance is None for c in found)


def test_crops_and_stored_descriptors_give_the_same():
    """A masked crop is described once; the graph written to JSON and read back gives the same layouts."""
    rng = np.random.default_rng(0)
    image = rng.integers(0, 255, (60, 90, 3)).astype(np.uint8)
    mask = np.zeros((60, 90), bool)
    mask[10:50, 20:80] = True
    node = dataclasses.replace(OBJECTS[0], descriptor=tuple(map(int, descriptors.of_image(image, mask))))
    walk = dataclasses.replace(WALK, descriptor=appearance_search.ground_crop_descriptor(image, mask))
    graph = street(node, ground=(ROAD, walk), sky_descriptor=appearance_search.sky_crop_descriptor(image, mask))
    stored = SceneGraph.from_json(graph.to_json())
    one, other = (materialise_cousins(g, 3, objects=few_objects()) for g in (graph, stored))
    assert [c.layout.to_json() for c in one] == [c.layout.to_json() for c in other]
    square = np.zeros_like(mask)
    square[5:30, 40:65] = True
    assert appearance_search.ground_crop_descriptor(image, square) == appearance_search.ground_descriptor(
        image[5:30, 40:65]
    )


def test_bad_numbers_are_refused():
    for count, seed, kerb in ((0, 0, 0.15), (65, 0, 0.15), (1, -1, 0.15), (1, 0, -0.1)):
        with pytest.raises(ValidationError):
            materialise_cousins(street(), count, seed, kerb, few_objects())
    wrong: tuple[Any, ...] = (-1, 64, 0.5, True)
    for number in wrong:
        with pytest.raises(ValidationError):
            materialise_cousin(street(), number, objects=few_objects())


def test_one_material_per_kind_except_that_separate_pavements_may_differ():
    graph = SceneGraph.load(settings.scene_root() / "commercial_cafes" / "graph.json")
    sides = set()
    for seed in range(6):
        layout = materialise_cousin(dataclasses.replace(graph, objects=()), 0, seed, objects=few_objects()).layout
        by_kind: dict[str, set[str]] = {}
        for region in layout.ground:
            by_kind.setdefault(region.kind, set()).add(region.material)
        assert all(len(found) == 1 for kind, found in by_kind.items() if kind != "sidewalk")
        left = {r.material for r in layout.ground if r.id.startswith("left_") and r.kind == "sidewalk"}
        assert len(left) == 1
        sides.add(len(by_kind["sidewalk"]))
        assert [(r.id, r.polygon, r.plane) for r in layout.ground] == [(r.id, r.polygon, r.plane) for r in graph.ground]
    assert max(sides) > 1


def test_named_materials_lie_side_by_side():
    """Touching regions wear the materials whose own descriptors they have; the rest of the piece joins the first."""

    def square(name: str, kind: str, x: float, descriptor: tuple[int, ...] | None) -> GroundRegion:
        return GroundRegion(name, kind, ((x, 0), (x + 2, 0), (x + 2, 2), (x, 2)), (0.0, 0.0, 0.0), descriptor)

    flags, brick = (appearance_search.own_ground_descriptor(f"sidewalk/{n}") for n in ("flags_buff", "brick_charcoal"))
    grass, gravel = (appearance_search.ground_descriptor(build_material(n).texture) for n in ("grass", "gravel"))
    ground = (
        square("a", "sidewalk", 0, flags),
        square("b", "sidewalk", 2, brick),
        square("c", "sidewalk", 4, None),
        square("d", "ground", 6, grass),
        square("e", "ground", 8, gravel),
    )
    layout = materialise_cousin(street(ground=ground), objects=few_objects()).layout
    wanted = ["sidewalk/flags_buff", "sidewalk/brick_charcoal", "sidewalk/flags_buff", "grass", "gravel"]
    assert [g.material for g in layout.ground] == wanted
    blurred = dataclasses.replace(ground[1], descriptor=(brick[0] + 1, *brick[1:]))
    mixed = materialise_cousin(street(ground=(ground[0], blurred, *ground[2:])), objects=few_objects()).layout
    assert len({g.material for g in mixed.ground if g.kind == "sidewalk"}) == 1
