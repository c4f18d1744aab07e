"""The committed index against the recipes' present output."""

import numpy as np
import pytest

from tests.support.leaves import always, leaf_params
from urbanverse_mjx.assets import build_mesh, load_index
from urbanverse_mjx.assets.categories.ontology import categories
from urbanverse_mjx.assets.categories.physical import ROLLING_RESISTANCE
from urbanverse_mjx.assets.categories.priors import prior
from urbanverse_mjx.assets.exporting.export import export_glb
from urbanverse_mjx.assets.meshes.glb import read_glb
from urbanverse_mjx.assets.meshes.recipe import all_recipes
from urbanverse_mjx.assets.records.index import build_index, make_record, save_index, uid_of
from urbanverse_mjx.datatypes import ValidationError

INDEX = load_index()


@pytest.mark.extended
def test_sampled_records_are_what_the_recipes_build() -> None:
    """On failure: `python -m urbanverse_mjx.assets index`, then `hulls`."""
    leaves = always(INDEX.leaves)
    found = [make_record(r, k) for r in all_recipes() if r.leaf in leaves for k in range(r.variants)]
    assert sorted(r.uid for r in found) == sorted(r.uid for leaf in leaves for r in INDEX.by_leaf(leaf))
    assert [r.uid for r in found if r != INDEX.get(r.uid)] == []


def test_every_variant_of_every_recipe_has_its_frozen_uid() -> None:
    """A recipe that is renamed, or that is not found where it was moved, changes what layouts name and its own seed."""
    named = {uid_of(r, k): (r.name, r.leaf, k) for r in all_recipes() for k in range(r.variants)}
    assert named == {r.uid: (r.recipe, r.leaf, r.params["variant"]) for r in INDEX.records}
    assert set(INDEX.leaves) == set(categories()), "all 659 leaves"


def test_every_recipe_lies_in_the_folder_of_its_category() -> None:
    folders = {r.leaf: r.function.__module__.removeprefix("urbanverse_mjx.assets.recipes.") for r in all_recipes()}
    top = {leaf: categories()[leaf][0].replace(" ", "_") for leaf in folders}
    assert {leaf: f for leaf, f in folders.items() if f.split(".")[0] != top[leaf]} == {}


@pytest.mark.slow
def test_the_committed_index_is_what_the_recipes_build() -> None:
    rebuilt = build_index()
    stale = [r.uid for r in INDEX.records if r.uid not in {x.uid for x in rebuilt.records}]
    changed = [r.uid for r in rebuilt.records if r.uid in {x.uid for x in INDEX.records} and r != INDEX.get(r.uid)]
    assert (stale, changed) == ([], [])
    assert INDEX.content_hash() == rebuilt.content_hash()


def test_at_least_sixty_leaves_with_three_variants() -> None:
    assert sum(len(INDEX.by_leaf(leaf)) >= 3 for leaf in INDEX.leaves) >= 60
    assert min(len(INDEX.by_leaf(leaf)) for leaf in INDEX.leaves) >= 2


@pytest.mark.parametrize("leaf", leaf_params(INDEX.leaves))
def test_meshes_of_a_leaf(leaf: str) -> None:
    """Extent, frame, budget of triangles, texture, and outward faces, for every record of the leaf."""
    for record in INDEX.by_leaf(leaf):
        mesh = build_mesh(record)
        assert np.abs(mesh.extent - record.extent_xyz).max() <= 1e-3, record.uid
        assert mesh.vertices[:, 2].min() == pytest.approx(0.0, abs=1e-4), record.uid
        centre = (mesh.vertices.max(0) + mesh.vertices.min(0)) / 2
        assert np.abs(centre[:2]).max() < 1e-4, record.uid
        assert record.length == max(record.extent_xyz[:2])
        assert record.width == min(record.extent_xyz[:2])
        assert record.category == categories()[leaf]
        assert 12 <= len(mesh.faces) <= 8000, record.uid
        assert max(mesh.texture.shape[:2]) <= 512
        assert 0 <= mesh.uv.min() <= mesh.uv.max() <= 1


@pytest.mark.parametrize("leaf", leaf_params(INDEX.leaves))
def test_variants_differ_visibly(leaf: str) -> None:
    """No two records of a leaf share both their mesh and their texture."""
    seen = set()
    for record in INDEX.by_leaf(leaf):
        mesh = build_mesh(record)
        seen.add((mesh.vertices.tobytes(), mesh.texture.tobytes()))
    assert len(seen) == len(INDEX.by_leaf(leaf))


# Front and sides, checked by geometry: the sitter of a bench faces +x, the backrest is at -x.
def test_a_bench_is_long_across_and_its_back_is_behind() -> None:
    record = next(r for r in INDEX.by_leaf("bench") if r.params.get("style") == "slatted iron")
    x, y, z = record.extent_xyz
    assert 1.4 < y < 2.1
    assert x < 0.8
    mesh = build_mesh(record)
    assert mesh.vertices[mesh.vertices[:, 2] > 0.7, 0].max() < 0.0
    assert 0.75 < z < 1.0


@pytest.mark.parametrize(
    ("leaf", "low", "high"),
    [
        ("traffic cone", 0.4, 1.2),
        ("fire hydrant", 0.6, 1.2),
        ("stop sign", 2.2, 3.2),
        ("street light", 4.0, 10.0),
        ("bollard", 0.6, 1.3),
        ("bus shelter", 2.3, 3.2),
        ("picnic table", 0.65, 0.9),
        ("manhole cover", 0.005, 0.03),
        ("telephone booth", 1.8, 2.9),
    ],
)
def test_heights_are_those_of_the_street(leaf: str, low: float, high: float) -> None:
    assert all(low <= r.height <= high for r in INDEX.by_leaf(leaf))


def test_masses_are_plausible() -> None:
    cone, barrier = INDEX.by_leaf("traffic cone"), INDEX.by_leaf("jersey barrier")
    assert all(1 <= r.mass <= 7 and r.movable for r in cone)
    assert max(r.mass for r in barrier) > 1000
    assert not any(r.movable for r in barrier)
    own = {r.leaf for r in all_recipes() if r.physics is not None}
    for record in INDEX.records:
        rolls = record.leaf not in own and prior(record.leaf).rest == "rolls"
        coefficient = ROLLING_RESISTANCE if rolls else record.friction_coefficient
        assert record.required_force == pytest.approx(coefficient * record.mass * 9.81, abs=0.1, rel=2e-3), record.uid


@pytest.mark.parametrize("leaf", leaf_params(INDEX.leaves))
def test_every_asset_exports_and_reloads(leaf: str, tmp_path) -> None:
    for record in INDEX.by_leaf(leaf):
        mesh = build_mesh(record)
        again = read_glb(export_glb(record, tmp_path / "asset.glb"))
        assert again.vertices.min(0) == pytest.approx(mesh.vertices.min(0), abs=1e-5)
        assert again.vertices.max(0) == pytest.approx(mesh.vertices.max(0), abs=1e-5)
        assert np.array_equal(again.texture, mesh.texture)
        assert np.abs(again.uv - mesh.uv).max() < 1e-5
        assert (again.roughness, again.metallic) == pytest.approx((mesh.roughness, mesh.metallic))


def test_the_index_survives_its_file(tmp_path) -> None:
    path = save_index(INDEX, tmp_path / "index.parquet")
    again = load_index(path)
    assert again.records == INDEX.records
    assert again.content_hash() == INDEX.content_hash()


def test_unknown_uid_and_leaf_are_refused() -> None:
    with pytest.raises(ValidationError, match="no-such-thing"):
        INDEX.get("no-such-thing")
    with pytest.raises(ValidationError, match="bensh"):
        INDEX.by_leaf("bensh")
