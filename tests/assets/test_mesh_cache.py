"""Base meshes in the cache: the same to the bit, found again, and never in the way."""

import pathlib

import numpy as np
import pytest

from urbanverse_mjx.assets import mesh_cache
from urbanverse_mjx.assets.mesh_cache import cached_mesh
from urbanverse_mjx.assets.recipe import all_recipes
from urbanverse_mjx.datatypes import AssetMesh

RECIPE = all_recipes()[0]


def build() -> AssetMesh:
    return RECIPE.build(0).mesh


def refuse() -> AssetMesh:
    raise AssertionError("built again")


def same(a: AssetMesh, b: AssetMesh) -> bool:
    arrays = all(np.array_equal(getattr(a, n), getattr(b, n)) for n in ("vertices", "faces", "uv", "texture"))
    return arrays and (a.roughness, a.metallic) == (b.roughness, b.metallic)


@pytest.fixture(autouse=True)
def own_cache(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path))


def test_what_is_read_is_what_was_built(tmp_path: pathlib.Path) -> None:
    first = cached_mesh("r", "leaf", 0, build)
    (file,) = tmp_path.rglob("*.npz")
    assert same(cached_mesh("r", "leaf", 0, refuse), first)
    with pytest.raises(AssertionError, match="built again"):
        cached_mesh("r", "leaf", 1, refuse)
    file.write_bytes(file.read_bytes()[:100])
    assert same(cached_mesh("r", "leaf", 0, build), first)
    assert same(cached_mesh("r", "leaf", 0, refuse), first)


def test_other_code_finds_nothing(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cached_mesh("r", "leaf", 0, build)
    monkeypatch.setattr(mesh_cache, "_code_digest", lambda: "other")
    with pytest.raises(AssertionError, match="built again"):
        cached_mesh("r", "leaf", 0, refuse)


def test_without_a_place_to_write_it_is_built(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path / "file"))
    assert same(cached_mesh("r", "leaf", 0, build), build())
