"""Regional buildings: outside the catalogue, as indexed, with hulls that a robot meets where it sees a wall."""

import functools

import numpy as np
import pytest
import trimesh

from urbanverse_mjx.assets import load_hulls, load_index
from urbanverse_mjx.assets.collision.hulls import HullStore, hull_budget, mesh_key, regional_store_path, store_path
from urbanverse_mjx.assets.meshes.recipe import all_recipes, get_recipe, regional_recipes
from urbanverse_mjx.assets.recipes.building.regional import words
from urbanverse_mjx.assets.recipes.building.regional.styles import DRESSINGS, TRADES, traditions
from urbanverse_mjx.assets.records import regional
from urbanverse_mjx.assets.records.index import build_mesh, make_record, uid_of
from urbanverse_mjx.citygen.city_blocks import PROFILES
from urbanverse_mjx.datatypes import AssetMesh, AssetRecord, ValidationError

INDEX = regional.load_regional()
#: Records of all traditions and dressings.
SAMPLE = INDEX.records[::17]


@functools.cache
def _mesh(uid: str) -> AssetMesh:
    return build_mesh(INDEX.get(uid))


def mesh_of(record: AssetRecord) -> AssetMesh:
    return _mesh(record.uid)


def test_the_catalogue_does_not_know_them() -> None:
    assert not [r.uid for r in load_index().records if regional.MARK in r.uid]
    assert not {r.name for r in all_recipes()} & {r.name for r in regional_recipes()}
    assert not set(HullStore.load(store_path()).hulls) & set(HullStore.load(regional_store_path()).hulls)


def test_every_variant_of_every_recipe_has_its_frozen_uid() -> None:
    named = {uid_of(r, k): (r.name, r.leaf, k) for r in regional_recipes() for k in range(r.variants)}
    assert named == {r.uid: (r.recipe, r.leaf, r.params["variant"]) for r in INDEX.records}
    assert all(regional.MARK in uid for uid in named)


@pytest.mark.parametrize("record", SAMPLE, ids=lambda r: r.uid)
def test_a_record_is_what_its_recipe_builds(record: AssetRecord) -> None:
    """Built in the dressing itself, while the index reuses one geometry for all dressings of a size.

    On failure: `python -m urbanverse_mjx.assets regional`.
    """
    recipe = get_recipe(record.recipe, record.leaf)
    built = recipe.build(record.params["variant"])
    assert make_record(recipe, record.params["variant"], built) == record
    assert mesh_key(built.mesh, hull_budget(built.mesh, recipe.hulls)) in HullStore.load(regional_store_path()).hulls


def test_dressings_share_their_geometry_but_not_their_paint() -> None:
    recipe = get_recipe("regional.kyoto", "retail")
    first, second = (recipe.build(k).mesh for k in range(2))
    assert np.array_equal(first.vertices, second.vertices)
    assert first.texture.shape != second.texture.shape or not np.array_equal(first.texture, second.texture)
    sizes = len(INDEX.records) / DRESSINGS
    assert len(HullStore.load(regional_store_path()).hulls) == sizes


@pytest.mark.parametrize("record", SAMPLE, ids=lambda r: r.uid)
def test_a_mesh_stands_on_the_ground_within_its_budget(record: AssetRecord) -> None:
    mesh = mesh_of(record)
    assert mesh.vertices[:, 2].min() == pytest.approx(0.0, abs=1e-4)
    middle = (mesh.vertices.max(0) + mesh.vertices.min(0)) / 2
    assert np.abs(middle[:2]).max() < 1e-4
    assert 100 <= len(mesh.faces) <= 8000
    assert max(mesh.texture.shape[:2]) <= 512


@pytest.mark.parametrize("record", SAMPLE, ids=lambda r: r.uid)
def test_the_block_is_where_the_record_says(record: AssetRecord) -> None:
    """Most of the front's area lies in the plane that places the building; little stands before it at the foot."""
    front, middle, width, _ = record.params["block"]
    mesh = mesh_of(record)
    corners = mesh.vertices[mesh.faces].astype(float)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(normal, axis=1) / 2
    in_plane = (np.abs(corners[:, :, 0] - front) < 1e-3).all(1) & (normal[:, 0] > 0)
    assert area[in_plane].sum() > 0.3 * width * record.height * 0.6
    low = mesh.vertices[mesh.vertices[:, 2] < 2.0]
    assert low[:, 0].max() < front + 0.45
    assert np.abs(low[:, 1] - middle).max() < width / 2 + 0.1


@pytest.mark.parametrize("record", SAMPLE, ids=lambda r: r.uid)
def test_robots_meet_hulls_where_they_see_walls(record: AssetRecord) -> None:
    """Rays towards the front at the heights of a robot hit a hull within 5 cm of the mesh, unless they enter an opening
    of the wall, which hulls close."""
    front, middle, width, _ = record.params["block"]
    mesh = mesh_of(record)
    start_y = middle + np.linspace(-0.49, 0.49, 41) * width
    starts = np.array([(front + 3.0, y, z) for y in start_y for z in (0.13, 0.31, 0.52, 0.93, 1.31)])
    seen = _hit(mesh.vertices, mesh.faces, starts)
    parts = [trimesh.convex.convex_hull(np.asarray(h, float)) for h in load_hulls(record).hulls]
    met = np.min([_hit(p.vertices, p.faces, starts) for p in parts], 0)
    wall = seen <= 3.0 + 1e-3
    assert wall.sum() >= 10
    assert np.abs(met - seen)[wall].max() <= 0.05
    assert (met[~wall] <= seen[~wall] + 0.05).all()


def _hit(vertices: np.ndarray, faces: np.ndarray, starts: np.ndarray) -> np.ndarray:
    """(n,) m from each start along -x to a surface; infinite where there is none."""
    a, b, c = (np.asarray(vertices, float)[faces[:, k]] for k in range(3))
    p = starts[:, None, 1:]
    u, w = b[:, 1:] - a[:, 1:], c[:, 1:] - a[:, 1:]
    d = p - a[:, 1:]
    det = u[:, 0] * w[:, 1] - u[:, 1] * w[:, 0]
    flat = np.abs(det) < 1e-12
    det = np.where(flat, 1.0, det)
    s = (d[..., 0] * w[:, 1] - d[..., 1] * w[:, 0]) / det
    t = (u[:, 0] * d[..., 1] - u[:, 1] * d[..., 0]) / det
    x = a[:, 0] + s * (b[:, 0] - a[:, 0]) + t * (c[:, 0] - a[:, 0])
    away = starts[:, :1] - x
    inside = (s >= 0) & (t >= 0) & (s + t <= 1) & ~flat & (away >= 0)
    return np.where(inside, away, np.inf).min(1)


# Traditions and words ----------------------------------------------------------------------------------------------


def test_every_city_of_the_library_has_one_tradition() -> None:
    for profile in PROFILES["urbanverse160"]:
        assert regional.tradition_of(profile.city, profile.country), profile.city
    places = regional.places()
    assert len(set(places)) == len(places)
    assert regional.tradition_of("Kyoto", "Japan") == "kyoto"
    assert regional.tradition_of("Osaka", "Japan") == "tokyo"
    assert regional.tradition_of("Testville", "nowhere") is None


def test_every_language_has_words_for_every_trade_and_each_is_drawn() -> None:
    used = {t.language for t in traditions().values()}
    assert used | set(words.board_table()["shops"]) == set(words.languages())
    for language, trades in words.languages().items():
        assert tuple(sorted(trades)) == tuple(sorted(TRADES)), language
        for entry in (entry for entries in trades.values() for entry in entries):
            for line in words.lines(entry):
                ink = np.asarray(words.mask(language, line))
                assert 0.1 < (ink > 0).mean() < 0.9, (language, line)
    assert words.mask("japanese", "薬局", upright=True).height == 2 * words.HEIGHT
    assert words.can_stand("korean")
    assert not words.can_stand("egyptian")


def test_an_unknown_word_is_one_sentence() -> None:
    with pytest.raises(ValidationError, match=r"found 'french/PUB', needed one of words\.npz"):
        words.mask("french", "PUB")


def test_fonts_that_are_missing_are_named(tmp_path) -> None:
    with pytest.raises(ValidationError, match=r"found no NotoSerif-Bold\.ttf"):
        words.draw_words(tmp_path)
