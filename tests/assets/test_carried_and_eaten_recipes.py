"""Carried, worn, eaten and household objects: sizes within their priors, closed meshes, several kinds of each."""

import itertools

import numpy as np
import pytest

from urbanverse_mjx.assets.categories import ontology
from urbanverse_mjx.assets.categories.priors import prior
from urbanverse_mjx.assets.meshes import recipe
from urbanverse_mjx.assets.meshes.mesh_builder import BuiltAsset
from urbanverse_mjx.assets.records.index import make_record

#: Every mesh of some hundred leaves takes minutes; `test_index` always builds every 18th leaf.
pytestmark = pytest.mark.slow

MIDDLES = ("personal item", "fruits", "vegetables", "drinks", "food", "kitchenware", "personal care product")
LEAVES = [leaf for middle in MIDDLES for leaf in ontology.tree()["urban object"][middle]]
#: (leaf, axis) whose first variant is not within 6 % of the median, and why.
OFF_MEDIAN: dict[tuple[str, int], str] = {}
#: Leaves (or what one variant is called) whose front the table puts at an end, while ours is the broad side.
BROAD_FRONT = {"backpack": "its pocket is on the broad side", "a crab": "crabs are broader than long"}
#: Leaves (or what one variant is called) that the table has as round, but not every one is.
NOT_ROUND = {
    "a pair cherry": "two on one stalk",
    "half a red cabbage": "cut through its middle",
}


@pytest.fixture(scope="session")
def built() -> dict[str, list[BuiltAsset]]:
    """Every variant of every leaf, once."""
    found: dict[str, list[BuiltAsset]] = {}
    for one in recipe.all_recipes():
        if one.leaf in LEAVES:
            found.setdefault(one.leaf, []).extend(one.build(k) for k in range(one.variants))
    return found


def sizes(asset: BuiltAsset) -> tuple[float, float, float]:
    """length, width, height of the prior's columns, m."""
    x, y, z = (float(e) for e in asset.mesh.extent)
    return max(x, y), min(x, y), z


def test_every_leaf_has_two_or_three_variants(built: dict[str, list[BuiltAsset]]) -> None:
    assert set(built) == set(LEAVES)
    assert all(2 <= len(assets) for assets in built.values())


@pytest.mark.parametrize("leaf", LEAVES)
def test_sizes_lie_within_the_prior_and_start_at_its_median(leaf: str, built: dict[str, list[BuiltAsset]]) -> None:
    row = prior(leaf)
    spans = (row.length, row.width, row.height)
    for asset in built[leaf]:
        for name, size, (least, _, greatest) in zip(("length", "width", "height"), sizes(asset), spans, strict=True):
            assert least <= size <= greatest, f"{asset.description}: {name} {size:.4f} outside {least}-{greatest}"
    for axis, (size, (_, median, _)) in enumerate(zip(sizes(built[leaf][0]), spans, strict=True)):
        if (leaf, axis) not in OFF_MEDIAN:
            assert size == pytest.approx(median, rel=0.06), f"axis {axis} of the first {leaf}"


@pytest.mark.parametrize("leaf", LEAVES)
def test_meshes_stand_centred_and_are_light(leaf: str, built: dict[str, list[BuiltAsset]]) -> None:
    for asset in built[leaf]:
        vertices, faces = asset.mesh.vertices, asset.mesh.faces
        reach = float(asset.mesh.extent.max())
        assert vertices[:, 2].min() == pytest.approx(0, abs=1e-5 * reach)
        assert np.abs(vertices[:, :2].max(0) + vertices[:, :2].min(0)).max() < 1e-5 * reach
        assert 60 <= len(faces) <= 3000, asset.description
        assert max(asset.mesh.texture.shape[:2]) <= 512
        a, b, c = (vertices[faces[:, k]].astype(float) for k in range(3))
        assert (np.linalg.norm(np.cross(b - a, c - a), axis=1) > 0).mean() > 0.98, "slivers"


@pytest.mark.parametrize("leaf", LEAVES)
def test_the_front_lies_where_the_table_says(leaf: str, built: dict[str, list[BuiltAsset]]) -> None:
    front = prior(leaf).front
    for asset in built[leaf]:
        x, y, _ = asset.mesh.extent
        if front == "side" or leaf in BROAD_FRONT or asset.description in BROAD_FRONT:
            assert y >= 0.93 * x, asset.description
        elif front == "end":
            assert x >= 0.93 * y, asset.description


@pytest.mark.parametrize("leaf", LEAVES)
def test_variants_differ_in_shape_or_picture(leaf: str, built: dict[str, list[BuiltAsset]]) -> None:
    for first, second in itertools.combinations(built[leaf], 2):
        one, other = np.array(sizes(first)), np.array(sizes(second))
        proportion = np.abs(one / one.max() - other / other.max()).max()
        painted = first.mesh.texture.shape != second.mesh.texture.shape or (
            np.abs(first.mesh.texture.astype(int) - second.mesh.texture.astype(int)).mean() > 3
        )
        assert proportion > 0.03 or painted, f"{first.description} and {second.description}"
        assert np.abs(one / other - 1).max() > 0.03, f"{first.description} is as large as {second.description}"


@pytest.mark.parametrize("leaf", LEAVES)
def test_round_and_lying_objects_have_equal_sides(leaf: str, built: dict[str, list[BuiltAsset]]) -> None:
    section = prior(leaf).section
    for asset in built[leaf]:
        length, width, height = sizes(asset)
        if section == "lying":
            assert height == pytest.approx(width, rel=0.35), asset.description
        elif section == "round" and asset.description not in NOT_ROUND:
            assert length == pytest.approx(width, rel=0.12), asset.description


def test_records_weigh_what_the_prior_allows(built: dict[str, list[BuiltAsset]]) -> None:
    for one in recipe.all_recipes():
        if one.leaf in LEAVES:
            low, _, high = prior(one.leaf).mass
            record = make_record(one, 0, built[one.leaf][0])
            assert one.physics is None
            assert low - 1e-3 <= record.mass <= high + 1e-3, f"{one.leaf}: {record.mass} kg outside {low}-{high}"


@pytest.mark.parametrize("leaf", ["luggage", "grapes", "papaya", "snacks"])
def test_a_variant_is_the_same_mesh_again(leaf: str, built: dict[str, list[BuiltAsset]]) -> None:
    one = next(r for r in recipe.all_recipes() if r.leaf == leaf)
    for k, first in enumerate(built[leaf]):
        again = one.build(k)
        assert np.array_equal(first.mesh.vertices, again.mesh.vertices)
        assert np.array_equal(first.mesh.texture, again.mesh.texture)


@pytest.mark.parametrize("leaf", ["apple", "orange", "watermelon", "pumpkin", "egg", "potato", "wine", "suitcase"])
def test_solid_objects_enclose_what_their_form_says(leaf: str, built: dict[str, list[BuiltAsset]]) -> None:
    """The volume of the closed parts against the prior's form: a ball-like body fills about half of its box."""
    for asset in built[leaf][:1]:
        share = asset.volume / float(np.prod(asset.mesh.extent.astype(float)))
        assert share == pytest.approx(prior(leaf).bulk, rel=0.3)
