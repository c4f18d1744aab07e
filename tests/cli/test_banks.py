"""`urbanverse scene bank` and `scene terrain`: which file a bank goes to, and what happens to a wrong one there."""

import json
import pathlib

import pytest

from tests.support.code_digests import raised
from urbanverse_mjx import settings
from urbanverse_mjx.cli.main import main
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs import registry
from urbanverse_mjx.pipeline import banks


@pytest.fixture(autouse=True)
def _own_cache(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path / "cache"))
    monkeypatch.delenv("URBANVERSE_BANK", raising=False)


@pytest.fixture
def builds(small_bank: SceneBank, monkeypatch: pytest.MonkeyPatch) -> list[list[str]]:
    """Records the graphs of every requested bank and returns the same small bank."""
    made: list[list[str]] = []

    def build(graphs, splits, seed=0, quiet=False, cousins=1, imported=False):
        made.append([pathlib.Path(graph).parent.name for graph in graphs])
        return small_bank

    monkeypatch.setattr(banks, "build_bank", build)
    return made


def _bank(capsys: pytest.CaptureFixture[str], *argv: str) -> pathlib.Path:
    assert main(["scene", "bank", "--quiet", *argv]) == 0
    return pathlib.Path(json.loads(capsys.readouterr().out)["bank"])


def test_a_users_bank_leaves_the_shipped_one_alone(builds, tmp_path, capsys) -> None:
    shipped = _bank(capsys)
    before = shipped.read_bytes()
    graph = tmp_path / "mine" / "graph.json"
    graph.parent.mkdir()
    graph.write_text("{}")
    names = {
        shipped,
        _bank(capsys, str(graph)),
        _bank(capsys, str(graph), "--cousins", "2"),
        _bank(capsys, str(graph), "--seed", "1"),
        _bank(capsys, str(graph), "--split", "test"),
        _bank(capsys, "--seed", "1"),
        # The very files of the shipped streets, given by name, in one split.
        _bank(capsys, *(str(path) for path in banks.shipped_scenes()[0])),
    }
    assert len(names) == 7, "every one has a file of its own"
    assert all(path.parent == shipped.parent and path.is_file() for path in names)
    assert shipped.read_bytes() == before
    graph.write_text("{ }")
    assert _bank(capsys, str(graph)) not in names
    number = len(builds)
    assert _bank(capsys, str(graph), "--seed", "1") not in names
    assert _bank(capsys, str(graph), "--seed", "1").is_file()
    assert len(builds) == number + 1, "the same again is read from the cache"


def test_a_banks_line_counts_what_stands_in_its_scenes(builds, small_bank, capsys) -> None:
    """As `scene compile` counts one scene: not the shapes of the table, of which ground is a part."""
    assert main(["scene", "bank", "--quiet"]) == 0
    said = json.loads(capsys.readouterr().out)
    hulls = sum(len(list(row[row >= 0])) for row in small_bank.inst_hull)
    prisms = sum(len(list(row[row >= 0])) for row in small_bank.prism_hull)
    assert (said["hulls"], said["prisms"]) == (hulls, prisms)
    assert min(hulls, prisms) > 0


def test_a_wrong_bank_under_the_shipped_name_is_built_anew(builds, small_bank, tmp_path, capsys) -> None:
    path = settings.shipped_bank_path()
    small_bank.save(path)
    wrong = path.read_bytes()
    with pytest.raises(ValidationError, match=r"found other scenes than those in its name.*urbanverse scene bank"):
        registry.load_default_bank()
    assert main(["scene", "bank", "--quiet"]) == 0
    captured = capsys.readouterr()
    assert captured.err.count("\n") == 1
    assert f"kept as {path.name}.bad" in captured.err
    assert path.with_name(f"{path.name}.bad").read_bytes() == wrong
    assert len(builds) == 1
    assert builds[0][0] == banks.shipped_scenes()[0][0].parent.name
    assert registry.load_default_bank().key == settings.bank_key(path)
    # A second wrong one does not replace the first that was kept.
    small_bank.save(path)
    banks.ensure_default_bank(quiet=True)
    assert path.with_name(f"{path.name}.bad-2").is_file()


def test_a_bank_that_is_named_is_taken_as_it_is_and_never_written(builds, small_bank, tmp_path, monkeypatch) -> None:
    path = tmp_path / "mine.npz"
    monkeypatch.setenv("URBANVERSE_BANK", str(path))
    with pytest.raises(ValidationError, match="no such file"):
        banks.ensure_default_bank(quiet=True)
    small_bank.save(path)
    before = path.read_bytes()
    assert banks.ensure_default_bank(quiet=True).scene_ids == small_bank.scene_ids
    assert registry.load_default_bank().scene_ids == small_bank.scene_ids
    assert path.read_bytes() == before
    assert not builds


@pytest.mark.extended
def test_terrain_of_another_seed_has_a_file_of_its_own(capsys) -> None:
    assert main(["scene", "terrain", "--levels", "1", "--seed", "1"]) == 0
    path = pathlib.Path(json.loads(capsys.readouterr().out)["bank"])
    assert path == settings.terrain_bank_path(1, 1) != settings.terrain_bank_path()
    with pytest.raises(ValidationError, match="urbanverse scene terrain"):
        registry.load_terrain_bank()


def test_the_key_changes_with_versions_assets_and_libraries(tmp_path, monkeypatch) -> None:
    names = {settings.shipped_bank_path()}
    monkeypatch.setattr(settings.metadata, "version", lambda package: "0")
    names.add(settings.shipped_bank_path())
    index = tmp_path / "assets_index"
    index.mkdir()
    monkeypatch.setenv("URBANVERSE_ASSET_ROOT", str(index))
    names.add(settings.shipped_bank_path())
    (index / "table.csv").write_text("1")
    names.add(settings.shipped_bank_path())
    (index / "table.csv").rename(index / "other.csv")
    names.add(settings.shipped_bank_path())
    assert len(names) == 5
    monkeypatch.setattr(settings.versions, "CODE", raised("meshes"))
    assert settings.shipped_bank_path() not in names, "a bank is made of meshes"
