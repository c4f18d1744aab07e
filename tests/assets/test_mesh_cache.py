"""Base meshes in the cache: bit-equal, found again, and harmless if damaged or read-only."""

import pathlib

import numpy as np
import pytest

from tests.support.code_digests import raised
from urbanverse_mjx import versions
from urbanverse_mjx.assets.meshes.mesh_cache import cached_mesh
from urbanverse_mjx.assets.meshes.recipe import all_recipes
from urbanverse_mjx.datatypes import AssetMesh, array_file

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


def test_what_is_read_is_what_was_built() -> None:
    first = cached_mesh("r", "leaf", 0, build)
    assert same(cached_mesh("r", "leaf", 0, refuse), first)
    with pytest.raises(AssertionError, match="built again"):
        cached_mesh("r", "leaf", 1, refuse)


@pytest.mark.parametrize("damage", ["cut", "changed", "other"])
def test_a_damaged_file_is_set_aside_and_built_anew(
    tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str], damage: str
) -> None:
    first = cached_mesh("r", "leaf", 0, build)
    (file,) = tmp_path.rglob("*.npz")
    body = bytearray(file.read_bytes())
    if damage == "cut":
        file.write_bytes(body[: len(body) // 2])
    elif damage == "changed":
        body[len(body) // 3] ^= 8
        file.write_bytes(body)
    else:
        array_file.save(file, {"vertices": first.vertices})
    bad = file.read_bytes()
    assert not capsys.readouterr().err
    assert same(cached_mesh("r", "leaf", 0, build), first)
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert str(file) in said
    assert f"kept as {file.name}.bad, building it anew" in said
    assert file.with_name(f"{file.name}.bad").read_bytes() == bad
    assert same(cached_mesh("r", "leaf", 0, refuse), first)
    assert not capsys.readouterr().err


def test_another_version_finds_nothing(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cached_mesh("r", "leaf", 0, build)
    monkeypatch.setattr(versions, "CODE", raised("meshes"))
    with pytest.raises(AssertionError, match="built again"):
        cached_mesh("r", "leaf", 0, refuse)


def test_without_a_place_to_write_it_is_built(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path / "file"))
    assert same(cached_mesh("r", "leaf", 0, build), build())
