"""Records that share a base shape: boxes, volumes, proportions, tints, meshes and hulls."""

import json

import numpy as np
import pytest

from urbanverse_mjx.assets import build_mesh, load_hulls, load_index
from urbanverse_mjx.assets.categories.ontology import categories
from urbanverse_mjx.assets.categories.physical import sample_uids
from urbanverse_mjx.assets.meshes.base_shapes import enclosed_volume, measure, shape_of
from urbanverse_mjx.assets.meshes.instances import (
    LONG,
    SHORT,
    STRETCH,
    STRETCH_ROLLING,
    UP,
    Proportion,
    _scales,
    palette_cells,
    place,
    proportion,
    scaled_mesh,
)
from urbanverse_mjx.assets.meshes.mesh_builder import MeshBuilder
from urbanverse_mjx.assets.meshes.palette import NAMED
from urbanverse_mjx.assets.meshes.recipe import get_recipe
from urbanverse_mjx.assets.meshes.tints import color_names, hsv, is_free, is_paint, tinted, tints
from urbanverse_mjx.assets.records.catalogue import build_leaf, leaf_uid
from urbanverse_mjx.assets.records.store import record_of
from urbanverse_mjx.datatypes import ValidationError

INDEX = load_index()
#: Leaves that are quick to build and of every kind: tied, rolling, round, free, alive.
QUICK = (
    *("bench", "bollard", "chair", "fire hydrant", "guard stone", "jersey barrier", "manhole cover", "parcels"),
    *("plant pot", "stop sign", "street cabinet", "table", "traffic cone", "trash bin", "utility pole", "wheelchair"),
)
PLACED = [leaf for leaf in QUICK if INDEX.by_leaf(leaf)]


def rows_of(leaf: str, count: int) -> list[dict]:
    return build_leaf(leaf, INDEX, len(INDEX.by_leaf(leaf)) + count).to_pylist()[-count:]


def check_meshes(leaf: str, count: int) -> None:
    """Built meshes against their records: 1 mm in the box, 2 % in the volume, measured on the scaled parts."""
    for row in rows_of(leaf, count):
        record = record_of(row)
        mesh = build_mesh(record)
        assert np.abs(mesh.extent - record.extent_xyz).max() <= 1e-3, record.uid
        assert mesh.vertices[:, 2].min() == pytest.approx(0.0, abs=1e-4)
        parts = parts_of(record)
        assert record.volume == pytest.approx(enclosed_volume(mesh, parts), rel=0.02), record.uid


def scale_of(record) -> np.ndarray:
    return np.array(record.params["instance"]["scale"])


_PARTS: dict[tuple[str, str, int], tuple[int, ...]] = {}


def parts_of(record) -> tuple[int, ...]:
    key = record.recipe, record.leaf, record.params["variant"]
    if key not in _PARTS:
        _PARTS[key] = get_recipe(record.recipe, record.leaf).build(record.params["variant"]).part_faces
    return _PARTS[key]


def test_enclosed_volumes_by_hand() -> None:
    """A box, a cylinder, two boxes of one skin, an open sheet; split at creases as every mesh is."""
    builder = MeshBuilder()
    builder.box((1, 2, 3))
    built = builder.build("box")
    assert enclosed_volume(built.mesh, built.part_faces) == pytest.approx(6.0, rel=1e-5)
    builder.cylinder(0.5, 2.0, at=(5, 0, 0), segments=64)
    with builder.solid():
        builder.box((1, 1, 1), at=(0, 5, 0), color="red")
        builder.box((1, 1, 1), at=(0, 6, 0), color="blue")
    built = builder.build("more")
    circle = 64 / 2 * 0.25 * np.sin(2 * np.pi / 64)
    assert enclosed_volume(built.mesh, built.part_faces) == pytest.approx(6.0 + 2 * circle + 2.0, rel=1e-5)
    sheet = MeshBuilder()
    sheet.quad([(0, 0, 0), (0, 1, 0), (0.3, 1, 1), (0.3, 0, 1)], "red", both_sides=False)
    sheet.rod((0, 0, 0), (0, 0, 1), 0.001)
    built = sheet.build("sheet")
    box = float(np.prod(built.mesh.extent))
    assert enclosed_volume(built.mesh, built.part_faces) == pytest.approx(0.02 * box, rel=1e-4)


@pytest.mark.parametrize("leaf", PLACED)
def test_built_meshes_agree_with_their_records(leaf: str) -> None:
    check_meshes(leaf, 10)


@pytest.mark.slow
def test_two_thousand_built_meshes_agree_with_their_records() -> None:
    per_leaf = -(-2000 // len(INDEX.leaves))
    for leaf in INDEX.leaves:
        check_meshes(leaf, per_leaf)


@pytest.mark.parametrize("leaf", sorted({*INDEX.leaves}))
def test_no_shape_is_bent_further_than_its_kind_allows(leaf: str) -> None:
    extents = np.array([r.extent_xyz for r in INDEX.by_leaf(leaf)])
    placed = place(leaf, [leaf_uid(leaf, k) for k in range(200)], extents)
    rule = proportion(leaf)
    # Boxes are rounded to 0.1 mm, which shows on thin objects.
    loose = 1.0 + 2e-4 / placed.extent.min(1)
    assert (placed.scale.max(1) / placed.scale.min(1) <= rule.stretch * loose).all()
    across = extents[placed.base][:, 1] > extents[placed.base][:, 0]
    sides = np.where(across[:, None], placed.scale[:, [1, 0, 2]], placed.scale)[:, list(rule.tied) or [0]]
    assert (sides.max(1) / sides.min(1) <= loose).all()


def test_the_largest_side_is_the_drawn_one() -> None:
    """Where axes are tied: people have the height, cars the length of their priors."""
    for leaf, axis in (("pedestrian adult", "height"), ("sedan", "length"), ("bollard", "height")):
        uids = [leaf_uid(leaf, k) for k in range(300)]
        placed = place(leaf, uids, np.array([r.extent_xyz for r in INDEX.by_leaf(leaf)]))
        found = placed.extent[:, 2] if axis == "height" else placed.extent[:, :2].max(1)
        assert found == pytest.approx(getattr(sample_uids(leaf, uids), axis), abs=1.01e-4)


def test_a_box_within_the_stretch_is_met_exactly() -> None:
    """Free axes: a third more of one side is no problem, double is shared between the sides."""
    rule = Proportion(1.35, (), LONG)
    assert _scales(rule, np.array([1.3, 1.0, 1.1])) == pytest.approx([1.3, 1.0, 1.1])
    assert _scales(rule, np.array([2.0, 1.0, 1.0])) == pytest.approx(np.sqrt([2 * 1.35, 2 / 1.35, 2 / 1.35]))
    assert _scales(Proportion(1.12, (LONG, UP), LONG), np.array([2.0, 1.0, 1.0])) == pytest.approx([2.0, 2 / 1.12, 2.0])
    assert _scales(Proportion(1.0, (LONG, SHORT, UP), UP), np.array([2.0, 1.0, 3.0])) == pytest.approx([3.0] * 3)


def test_kinds_of_proportion() -> None:
    assert proportion("pedestrian adult").stretch == proportion("stop sign").stretch == 1.0
    assert proportion("sedan") == proportion("sedan").__class__(STRETCH_ROLLING, (LONG, UP), LONG)
    assert proportion("plant pot").tied == (LONG, SHORT)
    assert proportion("bench").stretch == STRETCH
    assert all(1.0 <= proportion(leaf).stretch <= STRETCH for leaf in categories())


def test_no_base_shape_is_refused() -> None:
    with pytest.raises(ValidationError, match="found no base shape"):
        place("bench", ["bench/prior/00009"], np.zeros((0, 3)))


def test_every_base_shape_is_used() -> None:
    records = INDEX.by_leaf("pedestrian adult")
    placed = place(
        "pedestrian adult", [leaf_uid("x", k) for k in range(600)], np.array([r.extent_xyz for r in records])
    )
    assert len(np.unique(placed.base)) >= 0.8 * len(records)


def test_hulls_are_scaled_with_the_mesh() -> None:
    for leaf in ("bench", "trash bin"):
        for row in rows_of(leaf, 4):
            record = record_of(row)
            base = INDEX.get(record.params["instance"]["base"])
            for hull, own in zip(load_hulls(base).hulls, load_hulls(record).hulls, strict=True):
                assert own == pytest.approx(hull * scale_of(record), rel=1e-5)


def test_tints_are_mild_where_colour_has_a_meaning() -> None:
    red = np.array([[204, 30, 32]])
    many = tints([f"a/{k}" for k in range(400)])
    assert many == pytest.approx(tints([f"a/{k}" for k in range(400)]))
    assert not is_free("fire hydrant")
    assert not is_free("stop sign")
    assert not is_free("apple")
    assert not is_free("taxi")
    assert is_free("sedan")
    assert is_free("chair")
    hue = hsv(tinted(red, many[:, None], False))[0]
    assert np.minimum(hue, 1.0 - hue).max() < 0.03
    free = hsv(tinted(red, many[:, None], True))[0]
    assert np.histogram(free, bins=6, range=(0, 1))[0].min() > 20


def test_matter_keeps_its_colour() -> None:
    names = ("skin dark", "wood", "glass", "leaf", "brick")
    matter = np.array([NAMED[name] for name in names])
    assert not is_paint(matter).any()
    assert not is_paint(matter * 0.8).any()
    assert is_paint(np.array([NAMED["signal red"], NAMED["blue"], NAMED["yellow"]])).all()
    assert tinted(matter, np.array([0.5, 1.0, 1.0]), True) == pytest.approx(
        tinted(matter, np.array([0.5, 1.0, 1.0]), False)
    )


def test_no_tint_changes_nothing() -> None:
    colors = np.random.default_rng(0).integers(0, 256, (500, 3))
    assert tinted(colors, np.array([0.0, 1.0, 1.0]), True) == pytest.approx(colors.astype(float), abs=1e-9)


@pytest.mark.parametrize(
    ("color", "name"),
    [
        *(((40, 80, 40), "green"), ((26, 44, 92), "blue"), ((122, 26, 30), "red"), ((156, 108, 64), "brown")),
        *(((245, 245, 245), "white"), ((20, 20, 20), "black"), ((250, 206, 22), "yellow")),
    ],
)
def test_colour_names(color: tuple[int, int, int], name: str) -> None:
    from urbanverse_mjx.assets.meshes.tints import BASIC

    assert list(BASIC)[int(color_names(np.array(color)))] == name


def test_a_tinted_mesh_keeps_pictures_and_shape() -> None:
    record = INDEX.by_leaf("chair")[0]
    mesh = build_mesh(record)
    other = scaled_mesh(mesh, (1.0, 1.0, 1.0), (0.5, 1.0, 1.0), "chair")
    assert np.array_equal(mesh.faces, other.faces)
    assert not np.array_equal(mesh.texture, other.texture)
    cells = palette_cells(mesh)
    outside = np.ones(mesh.texture.shape[:2], bool)
    for row, column in cells.places:
        outside[row // 8 * 8 : row // 8 * 8 + 8, column // 8 * 8 : column // 8 * 8 + 8] = False
    assert np.array_equal(mesh.texture[outside], other.texture[outside])


def test_measures_are_those_of_the_mesh() -> None:
    """On failure: `python -m urbanverse_mjx.assets index`."""
    for leaf in PLACED[:6]:
        record = INDEX.by_leaf(leaf)[-1]
        found = measure(record.uid, get_recipe(record.recipe, leaf).build(record.params["variant"]), True)
        stored = shape_of(record)
        assert stored.extent == pytest.approx(found.extent, abs=1e-6)
        assert stored.volume == pytest.approx(found.volume, rel=1e-6)
        assert np.array_equal(stored.colors, found.colors)
        assert stored.share == pytest.approx(found.share, abs=0.02)
        assert stored.layouts.shape == (4, 16)


def test_every_record_of_the_index_has_measures() -> None:
    for record in INDEX.records:
        shape = shape_of(record)
        assert shape.share.sum() == pytest.approx(1.0, abs=1e-5)
        assert 0.0199 <= shape.volume / np.prod(shape.extent) <= 1.0


def test_params_of_an_instance_name_its_base() -> None:
    row = rows_of("bench", 1)[0]
    params = json.loads(row["params"])
    base = INDEX.get(params["instance"]["base"])
    assert params["variant"] == base.params["variant"]
    assert row["recipe"] == base.recipe
    assert row["extent_xyz"] == pytest.approx(np.array(params["instance"]["scale"]) * base.extent_xyz, abs=1e-3)
