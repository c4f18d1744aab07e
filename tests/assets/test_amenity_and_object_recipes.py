"""Amenities and household objects: every mesh has the size of its kind, stands, is its own variant and stays light."""

import itertools
from collections.abc import Mapping

import numpy as np
import pytest

from urbanverse_mjx.assets.categories import ontology, priors
from urbanverse_mjx.assets.meshes import recipe, shapes
from urbanverse_mjx.assets.meshes.mesh_builder import BuiltAsset, MeshBuilder
from urbanverse_mjx.assets.recipes.shared import forms, sizes

#: Every mesh of some hundred leaves takes minutes; `test_index` always builds every 18th leaf.
pytestmark = pytest.mark.slow

#: First parts of the recipes' names.
FAMILIES = (
    *("cabins", "case_furniture", "first_aid", "flags", "household", "leisure_places", "light_seats", "masts", "mills"),
    *("monuments", "notices", "office_furniture", "room_things", "sanitary", "street_terminals", "tents"),
    *("upholstery", "vessels", "yard_things"),
)
RECIPES = [r for r in recipe.all_recipes() if r.name.split(".")[0] in FAMILIES]
IDS = [r.leaf for r in RECIPES]
MEDIAN_SHARE = 0.06  # how far the first variant may lie from the median of its leaf

Built = Mapping[str, list[BuiltAsset]]


@pytest.fixture(scope="session")
def built() -> Built:
    return {r.leaf: [r.build(k) for k in range(r.variants)] for r in RECIPES}


def sides(leaf: str, asset: BuiltAsset) -> np.ndarray:
    """(length, width, height) m, named as the leaf's prior names them."""
    x, y, z = (float(v) for v in asset.mesh.extent)
    front = priors.prior(leaf).front
    level = {"side": (y, x), "end": (x, y), "none": (max(x, y), min(x, y))}[front]
    return np.array([*level, z])


def test_no_leaf_is_drawn_twice_and_all_of_the_rooms_are_drawn() -> None:
    assert len(set(IDS)) == len(IDS) == 112
    drawn = {r.leaf for r in recipe.all_recipes()}
    middles = ontology.tree()["urban object"]
    for middle in ("furniture", "fixtures", "cleaning equipment", "household items", "decorations", "street trash"):
        assert not set(middles[middle]) - drawn


@pytest.mark.parametrize("leaf", IDS)
def test_sizes_lie_in_the_range_of_the_kind(leaf: str, built: Built) -> None:
    prior = priors.prior(leaf)
    low, median, high = np.array([prior.length, prior.width, prior.height]).T
    for k, asset in enumerate(built[leaf]):
        found = sides(leaf, asset)
        assert (found >= low - 1e-6).all(), f"{leaf} {k}: {found.round(3)} below {low}"
        assert (found <= high + 1e-6).all(), f"{leaf} {k}: {found.round(3)} above {high}"
    first = sides(leaf, built[leaf][0])
    assert np.abs(first / median - 1).max() <= MEDIAN_SHARE, f"{leaf}: {first.round(3)} far from {median}"


@pytest.mark.parametrize("leaf", IDS)
def test_stands_centred_on_the_ground_and_is_light(leaf: str, built: Built) -> None:
    for asset in built[leaf]:
        vertices = asset.mesh.vertices
        assert vertices[:, 2].min() == pytest.approx(0, abs=1e-6)
        assert np.abs(vertices[:, :2].max(0) + vertices[:, :2].min(0)).max() < 1e-5 * max(1.0, vertices.max())
        assert 200 <= len(asset.mesh.faces) <= 3000
        assert max(asset.mesh.texture.shape[:2]) <= 512
        box = float(np.prod(asset.mesh.extent))
        # Overlapping parts count twice, so the sum may pass the box, but not by much; thin wire fills little of it.
        assert 1e-4 * box < asset.volume < 1.5 * box


@pytest.mark.parametrize("leaf", IDS)
def test_variants_differ_in_more_than_colour(leaf: str, built: Built) -> None:
    for one, other in itertools.combinations(built[leaf], 2):
        extents = np.abs(one.mesh.extent / other.mesh.extent - 1).max()
        volumes = abs(one.volume / other.volume - 1)
        faces = len(one.mesh.faces) != len(other.mesh.faces)
        assert extents > 0.02 or volumes > 0.02 or faces


def test_the_same_variant_is_the_same_mesh_again(built: Built) -> None:
    for r in RECIPES[:: max(1, len(RECIPES) // 24)]:
        again = r.build(r.variants - 1).mesh
        first = built[r.leaf][-1].mesh
        assert np.array_equal(first.vertices, again.vertices)
        assert np.array_equal(first.texture, again.texture)


def test_made_brings_a_drawing_to_its_size() -> None:
    b = MeshBuilder()
    b.box((2.0, 1.0, 0.5), (3.0, 0.0, 1.0), "red")
    asset = sizes.made(b, "a box", (1.0, None, 0.5), style="plain")
    # Half as long, as high as drawn; what is not asked for takes the mean of the two scales.
    assert np.allclose(asset.mesh.extent, (1.0, 0.75, 0.5))
    assert asset.volume == pytest.approx(1.0 * 0.75 * 0.5)
    assert asset.params == {"style": "plain"}
    assert sizes.made(b, "a box", (1.0, 1.0, 1.0), 0.3).volume == pytest.approx(0.3)


def test_padded_forms_have_the_size_asked_for_and_are_closed() -> None:
    for draw in (forms.soft, forms.pouch):
        b = MeshBuilder()
        draw(b, (0.6, 0.4, 0.2), (0.0, 0.0, 0.1), "red")
        low, high = b.bounds
        assert np.allclose(high - low, (0.6, 0.4, 0.2), rtol=0.02)
        assert low[2] == pytest.approx(0.1, abs=1e-3)
        assert 0.4 * 0.6 * 0.4 * 0.2 < b.build("a pad").volume < 0.6 * 0.4 * 0.2


def test_a_hollow_vessel_holds_less_matter_than_a_full_one() -> None:
    b = MeshBuilder()
    forms.hollow(b, [(0.1, 0.0), (0.1, 0.3)], 0.01, "red", segments=48)
    matter = b.build("a pot").volume
    full = shapes.volume(shapes.frustum(0.1, 0.1, 0.3, 48))
    # Wall of 10 mm and floor of 10 mm of a cylinder: 1 - 0.81 * 29 / 30.
    assert matter == pytest.approx(full * (1 - 0.81 * 29 / 30), rel=0.02)
