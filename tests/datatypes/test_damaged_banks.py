"""Damaged banks: one sentence for a user's own file, which stays; a file of the cache is set aside and built anew."""

import dataclasses
import pathlib
from collections.abc import Callable

import numpy as np
import pytest

from tests.support.box_bank import box_bank
from urbanverse_mjx import settings
from urbanverse_mjx.datatypes import SceneBank, ValidationError, array_file
from urbanverse_mjx.pipeline import banks


@pytest.fixture(scope="module")
def body(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The bytes of a small bank."""
    path = tmp_path_factory.mktemp("bank") / "bank.npz"
    box_bank(1, seed=0).save(path)
    return path.read_bytes()


@pytest.fixture(autouse=True)
def _own_cache(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path / "cache"))
    monkeypatch.delenv("URBANVERSE_BANK", raising=False)


def refused(path: pathlib.Path) -> str:
    """The sentence with which a bank is refused."""
    before = path.read_bytes()
    with pytest.raises(ValidationError) as caught:
        SceneBank.load(path)
    assert path.read_bytes() == before
    assert "\n" not in str(caught.value)
    assert str(path) in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("share", [0.0, 0.001, 0.5, 0.99])
def test_a_bank_that_is_cut_off_is_refused(body: bytes, tmp_path: pathlib.Path, share: float) -> None:
    path = tmp_path / "bank.npz"
    path.write_bytes(body[: int(len(body) * share)])
    assert "damaged" in refused(path)


def test_a_changed_bit_is_refused_or_changes_nothing(body: bytes, tmp_path: pathlib.Path) -> None:
    """Anywhere in the file, and in the directory at its end, where only dates and the like may change unseen."""
    path = tmp_path / "bank.npz"
    path.write_bytes(body)
    whole = SceneBank.load(path)
    rng = np.random.default_rng(0)
    directory = body.index(b"PK\x01\x02")
    places = [*rng.integers(0, directory, 60), *rng.integers(directory, len(body), 60)]
    found = 0
    for k, place in enumerate(places):
        flipped = bytearray(body)
        flipped[place] ^= 1 << int(rng.integers(8))
        path.write_bytes(flipped)
        try:
            bank = SceneBank.load(path)
        except ValidationError:
            found += k < 60
            continue
        for name, array in whole.arrays().items():
            np.testing.assert_array_equal(bank.arrays()[name], array, err_msg=f"{name}, byte {place}")
        assert bank.meta == whole.meta
    assert found >= 55, "what holds the arrays is nearly all of the file"


def test_arrays_of_every_kind_come_back(tmp_path: pathlib.Path) -> None:
    rng = np.random.default_rng(0)
    arrays = {
        "single": np.array(3.5),
        "none": np.zeros((0, 3), np.int32),
        "columns": np.asfortranarray(rng.random((70, 5))),
        "flags": rng.random(9) < 0.5,
        "words": np.array(["a", "kerb"]),
        "large": rng.integers(0, 255, (3, 200_001), np.uint8),
    }
    array_file.save(tmp_path / "a.npz", arrays)
    np.savez_compressed(tmp_path / "b.npz", **arrays)  # pyright: ignore[reportArgumentType]
    for name in ("a.npz", "b.npz"):
        found = array_file.load(tmp_path / name, "arrays", "")
        assert list(found) == list(arrays)
        for key, array in arrays.items():
            np.testing.assert_array_equal(found[key], array)
            assert (found[key].dtype, found[key].flags.writeable) == (array.dtype, True)
            assert found[key].flags.f_contiguous == array.flags.f_contiguous
    with np.load(tmp_path / "a.npz") as others:
        np.testing.assert_array_equal(others["columns"], arrays["columns"])


@pytest.mark.parametrize("write", [np.savez_compressed, lambda path, **arrays: array_file.save(path, arrays)])
def test_every_changed_byte_of_an_array_is_noticed(tmp_path: pathlib.Path, write: Callable[..., object]) -> None:
    """Also in files of NumPy, which have no checksum over the whole file."""
    path = tmp_path / "x.npz"
    write(path, x=np.arange(40))
    body = path.read_bytes()
    start = body.index(b"x.npy") + 5
    for place in range(start + 20, body.index(b"PK\x01\x02"), 3):
        path.write_bytes(body[:place] + bytes([body[place] ^ 4]) + body[place + 1 :])
        with pytest.raises(ValidationError, match="damaged"):
            array_file.load(path, "an array", "")


def test_a_cached_file_of_an_older_version_gets_a_checksum_over_all_of_it(
    tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """It is loaded and written again, whole; from then on a changed name of an array is noticed too."""
    path, x = tmp_path / "x.npz", np.arange(40.0)
    np.savez_compressed(path, x=x)
    older = path.read_bytes()
    for _ in range(2):
        found = array_file.load_cached(path, "an array", ("x",))
        assert found is not None
        np.testing.assert_array_equal(found["x"], x)
    body = path.read_bytes()
    assert b"crc32" in body
    assert b"crc32" not in older
    assert capsys.readouterr().err == ""
    path.write_bytes(body.replace(b"x.npy", b"y.npy"))
    assert array_file.load_cached(path, "an array", ("x",)) is None
    assert "its checksum is another one" in capsys.readouterr().err
    assert [p.name for p in tmp_path.iterdir()] == ["x.npz.bad"]


def test_a_shape_that_asks_for_more_memory_than_there_is_costs_none(tmp_path: pathlib.Path) -> None:
    """The checksum of an array comes after it: its header alone must not be trusted."""
    path = tmp_path / "bank.npz"
    np.savez(path, hull_grid=np.zeros((2, 1000), np.int32))
    small, large = b"(2, 1000), }" + b" " * 9, b"(2, 1000000000000), }"
    assert path.read_bytes().count(small) == 1
    path.write_bytes(path.read_bytes().replace(small, large))
    assert "size that its header gives" in refused(path)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("hull_triangles", 32),
        ("hull_num_vertices", 33),
        ("hull_num_triangles", 0),
        ("inst_object", 10**6),
        ("inst_hull", -2),
        ("prism_hull", 10**6),
        ("prism_kind", 6),
        ("hull_grid", 10**6),
        ("prism_grid", -2),
        ("map_kind", 6),
        ("episode_num_waypoints", 0),
        ("num_episodes", 10**6),
        ("mesh_faces", 10**6),
        ("mesh_faces", -1),
        ("mesh_vertex_start", -3),
        ("mesh_face_start", 10**7),
        ("mesh_material", -1),
        ("material_texture", 10**6),
        ("texture_start", 1),
        ("texture_shape", 5),
        ("slot_mesh", 10**6),
        ("slot_category", 10**6),
        ("scene_sky", 9),
    ],
)
def test_an_index_outside_its_table_is_refused(
    small_bank: SceneBank, tmp_path: pathlib.Path, name: str, value: int
) -> None:
    """Also in a file whose checksums are right."""
    array = getattr(small_bank, name).copy()
    array.reshape(-1)[array.size // 2] = value
    with pytest.raises(ValidationError, match=rf"bank\.{name}: "):
        dataclasses.replace(small_bank, **{name: array})
    path = tmp_path / "bank.npz"
    small_bank.save(path)
    arrays = array_file.load(path, "", "")
    array_file.save(path, {**arrays, name: array})
    with pytest.raises(ValidationError, match=rf"bank\.{name}: "):
        SceneBank.load(path)


def test_appearances_of_agents_outside_the_meshes_are_refused(small_bank: SceneBank) -> None:
    agents = {"kind": ["adult"], "mesh": [small_bank.num_meshes], "category": [0]}
    with pytest.raises(ValidationError, match=r"meta\.agents\.mesh"):
        dataclasses.replace(small_bank, meta={**small_bank.meta, "agents": agents})


def test_a_damaged_bank_of_the_cache_is_set_aside_and_built_anew(
    body: bytes, small_bank: SceneBank, capsys: pytest.CaptureFixture[str]
) -> None:
    path = settings.cache_dir("banks", "bank-0123456789abcdef.npz")
    assert banks.cached_bank(path, lambda: small_bank).key == "0123456789abcdef"
    whole = path.read_bytes()
    for k, bad in enumerate((whole[:1000], body[:-40], b"", whole[:5000] + b"?" + whole[5001:])):
        path.write_bytes(bad)
        assert banks.cached_bank(path, lambda: small_bank).scene_ids == small_bank.scene_ids
        said = capsys.readouterr().err
        assert said.count("\n") == 1
        name = f"{path.name}.bad" + (f"-{k + 1}" if k else "")
        assert f"kept as {name}, building it anew" in said
        assert path.with_name(name).read_bytes() == bad
        assert SceneBank.load(path).key == "0123456789abcdef"


def test_a_bank_that_the_user_names_is_never_renamed(
    body: bytes, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "mine.npz"
    path.write_bytes(body[:-100])
    monkeypatch.setenv("URBANVERSE_BANK", str(path))
    with pytest.raises(ValidationError, match="damaged"):
        banks.ensure_default_bank(quiet=True)
    assert [p.name for p in tmp_path.iterdir()] == ["mine.npz"]
