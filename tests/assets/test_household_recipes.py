"""Appliances, tools, weapons, instruments, office, sports and toy recipes: of their row's size, closed, distinct."""

import itertools

import numpy as np
import pytest

from urbanverse_mjx.assets.categories import ontology
from urbanverse_mjx.assets.categories.priors import Prior, prior
from urbanverse_mjx.assets.meshes import recipe
from urbanverse_mjx.assets.meshes.mesh_builder import BuiltAsset
from urbanverse_mjx.assets.recipes.urban_object.sports.balls import _folded_seam, directions

#: Every mesh of some hundred leaves takes minutes; `test_index` always builds every 18th leaf.
pytestmark = pytest.mark.slow

MIDDLES = (
    "electrical appliances",
    "tools",
    "weapons",
    "musical instruments",
    "office supplies",
    "sports equipments",
    "toys",
)
LEAVES = [leaf for middle in MIDDLES for leaf in ontology.tree()["urban object"][middle]]
#: Of the same recipe as the others, but these need hardly any parts: a letter, and a chalk board on four laths.
PLAIN = {"envelope": 40, "blackboard": 80}

Built = dict[str, list[BuiltAsset]]


@pytest.fixture(scope="module")
def built() -> Built:
    """leaf -> its variants, built once."""
    wanted: Built = {leaf: [] for leaf in LEAVES}
    for r in recipe.all_recipes():
        if r.leaf in wanted:
            assert r.physics is None, f"{r.leaf}: mass and matter come from priors.csv"
            wanted[r.leaf] += [r.build(k) for k in range(r.variants)]
    return wanted


def sides(asset: BuiltAsset) -> np.ndarray:
    """(length, width, height), m: the longer and the shorter level side, then up."""
    x, y, z = (float(v) for v in asset.mesh.extent)
    return np.array([max(x, y), min(x, y), z])


def ranges(row: Prior) -> np.ndarray:
    """(3, 3): length, width, height by least, median, greatest."""
    return np.array([row.length, row.width, row.height])


@pytest.mark.parametrize("leaf", LEAVES)
def test_variants_have_the_sizes_of_their_row(built: Built, leaf: str) -> None:
    row = ranges(prior(leaf))
    assert len(built[leaf]) >= 2, f"{leaf}: needs two variants"
    for asset in built[leaf]:
        size = sides(asset)
        assert (size >= row[:, 0] - 1e-5).all(), f"{asset.description}: {size.round(4)}"
        assert (size <= row[:, 2] + 1e-5).all(), f"{asset.description}: {size.round(4)}"
        if prior(leaf).front == "side":
            assert asset.mesh.extent[0] <= asset.mesh.extent[1], f"{asset.description}: its front is a long side"
    first = sides(built[leaf][0])
    assert np.abs(first / row[:, 1] - 1).max() < 0.06, f"{leaf}: the first is {first.round(4)}, its median {row[:, 1]}"


@pytest.mark.parametrize("leaf", LEAVES)
def test_meshes_stand_centred_and_keep_their_budgets(built: Built, leaf: str) -> None:
    for asset in built[leaf]:
        vertices = asset.mesh.vertices
        middle = vertices[:, :2].max(0) + vertices[:, :2].min(0)
        assert abs(float(vertices[:, 2].min())) < 1e-6
        assert np.abs(middle).max() < 1e-5
        most = 1500 if sides(asset).max() < 0.3 else 3000
        assert PLAIN.get(leaf, 120) <= len(asset.mesh.faces) <= most, f"{asset.description}: {len(asset.mesh.faces)}"
        assert max(asset.mesh.texture.shape[:2]) <= 512


@pytest.mark.parametrize("leaf", LEAVES)
def test_variants_differ_in_shape_or_paint(built: Built, leaf: str) -> None:
    for a, b in itertools.combinations(built[leaf], 2):
        stretched = np.abs(sides(a) / sides(b) - 1).max() > 0.03
        repainted = a.mesh.texture.shape != b.mesh.texture.shape or not np.array_equal(a.mesh.texture, b.mesh.texture)
        assert stretched or repainted, f"{leaf}: {a.description!r} is {b.description!r}"
        assert a.description != b.description


def enclosed(vertices: np.ndarray, faces: np.ndarray) -> float | None:
    """m^3 inside a part, negative where its faces point inwards; None for a sheet."""
    _, place = np.unique(np.round(vertices / 1e-7).astype(np.int64), axis=0, return_inverse=True)
    shared = place.reshape(-1)[faces]
    edges = np.sort(np.concatenate([shared[:, [0, 1]], shared[:, [1, 2]], shared[:, [2, 0]]]), axis=1)
    keys = edges[:, 0] * (len(vertices) + 1) + edges[:, 1]
    if (np.unique(keys, return_counts=True)[1] != 2).any():
        return None
    a, b, c = (vertices[faces[:, i]] - vertices.mean(0) for i in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6


def test_closed_parts_have_their_faces_outside(built: Built) -> None:
    """A part turned inside out is invisible from one side and has a negative mass."""
    wrong = []
    for asset in itertools.chain.from_iterable(built.values()):
        matter, start = 0.0, 0
        for count in asset.part_faces:
            used, faces = np.unique(asset.mesh.faces[start : start + count], return_inverse=True)
            inside = enclosed(asset.mesh.vertices[used].astype(float), faces.reshape(-1, 3))
            start += count
            matter += inside or 0.0
            if inside is not None and inside < -1e-10:
                wrong.append(f"{asset.description}: part of {count} faces encloses {inside * 1e6:.3f} cm3")
        assert 0 < matter < 3 * float(np.prod(asset.mesh.extent)), asset.description
        assert asset.volume == pytest.approx(matter, rel=0.02), asset.description
    assert not wrong, "\n".join(wrong)


def test_the_same_variant_is_the_same_mesh_again(built: Built) -> None:
    for leaf in ("air conditioner", "baseball", "guitar", "keyboard", "ice maker", "stuffed toy"):
        (again,) = (r.build(1) for r in recipe.all_recipes() if r.leaf == leaf)
        first = built[leaf][1]
        assert np.array_equal(first.mesh.vertices, again.mesh.vertices)
        assert np.array_equal(first.mesh.texture, again.mesh.texture)


def test_the_folded_seam_lies_on_the_ball_and_halves_it() -> None:
    """Both leathers of a baseball's cover have one shape: what is above turns into what is below."""
    seam = _folded_seam(400)
    assert np.linalg.norm(seam, axis=1) == pytest.approx(np.ones(400), abs=1e-12)
    turned = seam[:, [1, 0, 2]] * [-1, 1, -1]
    nearest = np.linalg.norm(seam[:, None] - turned[None], axis=2).min(1)
    assert nearest.max() < 1e-12
    assert np.linalg.norm(directions(), axis=-1).min() > 0.999
