"""Every leaf of vehicles, street users, barriers, traffic signs and transport places: buildable, of the size of its
kind, the right way round, and each variant another one."""

import csv
import dataclasses
import functools
from collections.abc import Callable

import numpy as np
import pytest

from urbanverse_mjx.assets.categories import ontology
from urbanverse_mjx.assets.meshes import recipe
from urbanverse_mjx.assets.meshes.mesh_builder import BuiltAsset, MeshBuilder
from urbanverse_mjx.assets.recipes.amenity import speed_limits
from urbanverse_mjx.assets.recipes.shared import sizes
from urbanverse_mjx.assets.recipes.street_user import limbs
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.settings import asset_root

#: Every mesh of some hundred leaves takes minutes; `test_index` always builds every 18th leaf.
pytestmark = pytest.mark.slow

Variants = Callable[[str], list[BuiltAsset]]

TOPS = {"vehicle", "street user", "barrier"}
MIDDLES = {"traffic signs", "transportation amenity"}
MODULES = {
    "access_barriers",
    "aircraft",
    "armoured",
    "beasts",
    "coaches",
    "earthmovers",
    "guards",
    "hired_rides",
    "large_ships",
    "loose_matter",
    "motorbikes",
    "parking_places",
    "road_cars",
    "road_service",
    "robots",
    "service_trucks",
    "small_craft",
    "small_creatures",
    "small_vehicles",
    "speed_limits",
    "transit_places",
    "uniforms",
    "warning_signs",
    "wheeled_people",
}
RECIPES = [r for r in recipe.all_recipes() if r.name.split(".")[0] in MODULES]
LEAVES = sorted({r.leaf for r in RECIPES})

#: Most triangles. A person on a machine is two assets in one (as the cyclist is), a stretched car or an articulated
#: bus has more windows than a car.
USUAL_TRIANGLES = 3000
MORE_TRIANGLES = {
    "motorcycle rider": 4000,
    "wheelchair user": 4000,
    "limousine": 3500,
    "trolleybus": 3500,
    "train": 3500,
    "bicycle rental": 3500,
    "convertible car": 3200,
}
#: Median -> how far the first variant's may be off; 6 % elsewhere.
FAR_FROM_MEDIAN: dict[str, float] = {}


@dataclasses.dataclass(frozen=True)
class Spans:
    """(3, 3) least, median, greatest of length, width, height, m; `front`: where the asset's front lies."""

    table: np.ndarray
    front: str

    def measured(self, asset: BuiltAsset) -> np.ndarray:
        """Length, width, height of a mesh as the table counts them: a `side` front has its length across."""
        x, y, z = asset.mesh.extent
        if self.front == "side":
            return np.array([y, x, z])
        return np.array([x, y, z] if self.front == "end" else [max(x, y), min(x, y), z])


@pytest.fixture(scope="session")
def spans() -> dict[str, Spans]:
    with (asset_root() / "priors.csv").open(encoding="utf-8") as file:
        rows = {row["leaf"]: row for row in csv.DictReader(file)}
    columns = ("length", "width", "height")
    return {
        k: Spans(np.array([[float(v) for v in r[c].split()] for c in columns]), r["front"]) for k, r in rows.items()
    }


@pytest.fixture(scope="session")
def variants() -> Variants:
    """Builds each leaf's variants once, when first asked."""
    return functools.cache(lambda leaf: [r.build(k) for r in RECIPES if r.leaf == leaf for k in range(r.variants)])


def test_every_leaf_of_these_categories_has_a_recipe() -> None:
    groups = ((top, middle, leaves) for top, mids in ontology.tree().items() for middle, leaves in mids.items())
    wanted = {leaf for top, middle, leaves in groups if top in TOPS or middle in MIDDLES for leaf in leaves}
    missing = wanted - {r.leaf for r in recipe.all_recipes()}
    assert not missing, sorted(missing)
    assert wanted >= set(LEAVES), "a module builds a leaf of another category"


@pytest.mark.parametrize("leaf", LEAVES)
def test_sizes_lie_within_the_priors(leaf: str, variants: Variants, spans: dict[str, Spans]) -> None:
    span = spans[leaf]
    least, median, greatest = span.table.T
    for k, asset in enumerate(variants(leaf)):
        size = span.measured(asset)
        assert (size >= 0.999 * least).all(), f"{asset.description}: {size.round(3)} under {least}"
        assert (size <= 1.001 * greatest).all(), f"{asset.description}: {size.round(3)} over {greatest}"
        if k == 0:
            off = np.abs(size / median - 1).max()
            assert off <= FAR_FROM_MEDIAN.get(leaf, 0.06) + 1e-3, f"{leaf}: {size.round(3)} against {median}"


@pytest.mark.parametrize("leaf", LEAVES)
def test_meshes_stand_centred_on_the_ground_in_few_triangles(leaf: str, variants: Variants) -> None:
    for asset in variants(leaf):
        vertices = asset.mesh.vertices
        high = np.abs(vertices).max()
        assert np.abs(vertices[:, 2].min()) < 1e-5 * max(high, 1)
        assert np.abs(vertices[:, :2].max(0) + vertices[:, :2].min(0)).max() < 1e-5 * max(high, 1)
        assert 40 <= len(asset.mesh.faces) <= MORE_TRIANGLES.get(leaf, USUAL_TRIANGLES), asset.description
        assert max(asset.mesh.texture.shape[:2]) <= 512
        assert asset.volume > 0
        assert asset.volume < np.prod(asset.mesh.extent), "more matter than fits into its own box"
        assert 0 <= asset.mesh.uv.min() <= asset.mesh.uv.max() <= 1


@pytest.mark.parametrize("leaf", LEAVES)
def test_variants_differ(leaf: str, variants: Variants) -> None:
    assets = variants(leaf)
    assert len(assets) >= 2
    assert len({a.description for a in assets}) == len(assets)
    for i, first in enumerate(assets):
        for second in assets[i + 1 :]:
            a, b = first.mesh, second.mesh
            same_texture = a.texture.shape == b.texture.shape and np.array_equal(a.texture, b.texture)
            assert not same_texture or np.abs(a.extent / b.extent - 1).max() > 0.02, leaf


def test_builds_are_the_same_every_time(variants: Variants) -> None:
    for r in RECIPES[::12]:
        again, first = r.build(0).mesh, variants(r.leaf)[0].mesh
        np.testing.assert_array_equal(again.vertices, first.vertices)
        np.testing.assert_array_equal(again.texture, first.texture)


@pytest.mark.parametrize("leaf", ["car", "coupe car", "limousine", "electric car", "ambulance", "tractor"])
def test_road_vehicles_look_along_x_on_wheels(leaf: str, variants: Variants) -> None:
    """Low bonnet before a high cabin, and ground under all four corners."""
    for asset in variants(leaf):
        vertices, half = asset.mesh.vertices, asset.mesh.extent[0] / 2
        low = vertices[vertices[:, 2] < 0.06 * asset.mesh.extent[2]]
        assert len({tuple(np.sign(p[:2]).astype(int)) for p in low if (p[:2] != 0).all()}) == 4
        nose = vertices[vertices[:, 0] > 0.72 * half][:, 2].max()
        assert nose < 0.85 * vertices[:, 2].max(), asset.description


@pytest.mark.parametrize("limit", speed_limits.SIZES)
def test_the_sign_face_is_a_white_disc_in_a_red_rim(limit: int) -> None:
    face = np.asarray(speed_limits.limit_disc(str(limit)), float)
    n = len(face)
    rim, ground = face[n // 2, 3], face[n // 4, n // 2]
    assert rim[0] > 150 > 90 > rim[1], "red at the rim"
    assert ground.min() > 200, "white above the number"
    middle = face[n // 3 : 2 * n // 3, n // 4 : 3 * n // 4]
    dark = (middle.max(2) < 90).mean()
    assert 0.3 < dark < 0.75, "a black number in the middle"


def test_numbers_on_signs_differ(variants: Variants) -> None:
    faces = [np.asarray(speed_limits.limit_disc(str(k)), int) for k in speed_limits.SIZES]
    for i, first in enumerate(faces):
        for second in faces[i + 1 :]:
            assert (np.abs(first - second).max(2) > 100).mean() > 0.01


def test_fitted_scales_to_a_box_and_refuses_to_squash() -> None:
    b = MeshBuilder()
    b.box((1.0, 2.0, 3.0))
    built = b.build("a block")
    grown = sizes.fitted(built, (1.1, 0, 3.3))
    np.testing.assert_allclose(grown.mesh.extent, (1.1, 2.2, 3.3), rtol=1e-5)
    assert grown.volume == pytest.approx(6 * 1.1**3, rel=1e-5)
    with pytest.raises(ValidationError, match="same proportions"):
        sizes.fitted(built, (1.0, 2.0, 6.0))


def test_two_links_keep_their_lengths_and_reach_the_end() -> None:
    start, end = np.array([0.0, 0.1, 1.4]), np.array([0.35, 0.2, 1.1])
    joint, tip = limbs.two_links(start, end, (0.32, 0.27), (0.0, 0.0, -1.0))
    assert np.linalg.norm(joint - start) == pytest.approx(0.32)
    assert np.linalg.norm(tip - joint) == pytest.approx(0.27)
    np.testing.assert_allclose(tip, end, atol=1e-9)
    assert joint[2] < (start[2] + end[2]) / 2, "bent downwards"
    _, far = limbs.two_links(start, start + np.array([2.0, 0, 0]), (0.32, 0.27), (0.0, 0.0, -1.0))
    assert np.linalg.norm(far - start) == pytest.approx(0.59, rel=0.01), "stretched, no further than its length"
