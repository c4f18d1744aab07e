"""Buildings, pieces of road and ground: sizes within the table of priors, at home in their frame, each its own."""

import functools

import numpy as np
import pytest

from urbanverse_mjx.assets.categories import ontology
from urbanverse_mjx.assets.categories.priors import Prior, prior
from urbanverse_mjx.assets.meshes import recipe
from urbanverse_mjx.assets.meshes.mesh_builder import BuiltAsset

#: Every mesh of some hundred leaves takes minutes; `test_index` always builds every 18th leaf.
pytestmark = pytest.mark.slow

TOPS = ("building", "road", "nature")
RECIPES = {r.leaf: r for r in recipe.all_recipes() if r.physics is None and ontology.category_of(r.leaf)[0] in TOPS}
LEAVES = sorted(RECIPES)
#: Plain by nature: a painted slab needs no more triangles than its kerb has stones.
PLAIN = 40


@functools.cache
def built(leaf: str) -> tuple[BuiltAsset, ...]:
    return tuple(RECIPES[leaf].build(k) for k in range(RECIPES[leaf].variants))


def sides(asset: BuiltAsset) -> np.ndarray:
    """(length, width, height), m."""
    x, y, z = (float(e) for e in asset.mesh.extent)
    return np.array([max(x, y), min(x, y), z])


def ranges(row: Prior) -> np.ndarray:
    """(3, 3): least, median and greatest of length, width and height, m."""
    return np.array([row.length, row.width, row.height])


def test_every_leaf_of_these_branches_has_a_recipe() -> None:
    leaves = {leaf for top in TOPS for group in ontology.tree()[top].values() for leaf in group}
    assert leaves == {r.leaf for r in recipe.all_recipes()} & leaves


@pytest.mark.parametrize("leaf", LEAVES)
def test_sizes_are_in_the_table_and_the_first_is_usual(leaf: str) -> None:
    span = ranges(prior(leaf))
    for asset in built(leaf):
        assert (sides(asset) >= span[:, 0] * 0.999).all(), asset.description
        assert (sides(asset) <= span[:, 2] * 1.001).all(), asset.description
    assert sides(built(leaf)[0]) == pytest.approx(span[:, 1], rel=0.06)


@pytest.mark.parametrize("leaf", LEAVES)
def test_the_front_is_where_the_table_says(leaf: str) -> None:
    """Along the long side for "side" (then x is the shorter extent), at an end of the length for "end"."""
    front = prior(leaf).front
    for asset in built(leaf):
        x, y = (float(e) for e in asset.mesh.extent[:2])
        if front == "side":
            assert x <= y * 1.001
        elif front == "end":
            assert x >= y * 0.999


@pytest.mark.parametrize("leaf", LEAVES)
def test_meshes_stand_on_the_ground_about_their_middle(leaf: str) -> None:
    for asset in built(leaf):
        mesh = asset.mesh
        assert np.isfinite(mesh.vertices).all()
        assert mesh.vertices[:, 2].min() == pytest.approx(0.0, abs=1e-5)
        middle = (mesh.vertices[:, :2].max(0) + mesh.vertices[:, :2].min(0)) / 2
        assert np.abs(middle).max() < 1e-4 * max(1.0, float(mesh.extent.max()))
        assert PLAIN <= len(mesh.faces) <= 3000, (asset.description, len(mesh.faces))
        assert max(mesh.texture.shape[:2]) <= 512
        assert mesh.uv.min() >= 0.0
        assert mesh.uv.max() <= 1.0
        assert 0.0 < asset.volume <= float(np.prod(mesh.extent))


@pytest.mark.parametrize("leaf", LEAVES)
def test_variants_differ_in_shape_and_look(leaf: str) -> None:
    """Not one mesh stretched: once each is scaled to a unit box, shape or painting still differ."""
    variants = built(leaf)
    assert len(variants) >= 2
    assert len({a.description for a in variants}) == len(variants)
    for k, first in enumerate(variants):
        for second in variants[:k]:
            assert (np.abs(sides(first) / sides(second) - 1.0) > 0.02).any()
            same_shape = first.mesh.vertices.shape == second.mesh.vertices.shape and np.allclose(
                first.mesh.vertices / first.mesh.extent, second.mesh.vertices / second.mesh.extent, atol=1e-3
            )
            same_texture = np.array_equal(first.mesh.texture, second.mesh.texture)
            assert not (same_shape and same_texture)


@pytest.mark.parametrize("leaf", ["shoe store", "church", "pond", "road"])
def test_the_same_variant_is_the_same_mesh_again(leaf: str) -> None:
    again = RECIPES[leaf].build(1).mesh
    assert np.array_equal(built(leaf)[1].mesh.vertices, again.vertices)
    assert np.array_equal(built(leaf)[1].mesh.texture, again.texture)


@pytest.mark.parametrize("leaf", ["shoe store", "optical store", "fast food restaurant", "hostel", "bungalow"])
def test_the_door_is_in_the_front(leaf: str) -> None:
    """Recessed doors and windows lie on the +x side: the front half has more triangles than the rear."""
    for asset in built(leaf):
        depth = float(asset.mesh.extent[0])
        centres = asset.mesh.vertices[asset.mesh.faces].mean(1)[:, 0]
        assert (centres > 0.25 * depth).sum() > 2 * (centres < -0.25 * depth).sum()
