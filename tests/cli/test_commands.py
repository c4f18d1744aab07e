"""Commands from their words to their files, the line that they print and their exit status."""

import json
import pathlib

import numpy as np
import pytest

from tests.datatypes.test_bank_join import renamed
from tests.distillation.test_readers import SEQUENCE, write_kitti
from tests.scene.test_exchange import their_files
from tests.training.test_export_gait import save_walking_policy
from urbanverse_mjx.cli.main import main
from urbanverse_mjx.datatypes import Recording, SceneBank
from urbanverse_mjx.robots.gait import Gait
from urbanverse_mjx.scene.exchange import load_map
from urbanverse_mjx.scene.exchange_routes import load_annotations, load_planned, save_annotations
from urbanverse_mjx.scene.routes import Wanted


def test_the_command_joins_and_makes_splits(
    small_bank: SceneBank, tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    small_bank.save(tmp_path / "a.npz")
    renamed(small_bank, "_b").save(tmp_path / "b.npz")
    files = [str(tmp_path / name) for name in ("a.npz", "b.npz")]
    out = tmp_path / "both.npz"
    assert main(["scene", "join", *files, "--out", str(out), "--split", "held_out=*_b"]) == 0
    assert json.loads(capsys.readouterr().out)["scenes"] == list(SceneBank.load(out).scene_ids)
    n = small_bank.num_scenes
    np.testing.assert_array_equal(SceneBank.load(out).scenes_of("held_out"), np.arange(n, 2 * n))
    assert main(["scene", "join", *files, "--out", str(out), "--split", "held_out=nothing"]) == 2
    assert "NAME=PATTERN" in capsys.readouterr().err


def test_the_command_imports_and_refuses_a_folder_in_use(
    tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_kitti(tmp_path / "kitti")
    words = ["gen", "import", str(tmp_path / "kitti"), "--out", str(tmp_path / "out"), "--format", "kitti360"]
    assert main([*words, "--sequence", SEQUENCE, "--last", "5", "--quiet"]) == 0
    assert json.loads(capsys.readouterr().out)["frames"] == 1
    assert main([*words, "--sequence", SEQUENCE, "--quiet"]) == 2
    said = capsys.readouterr().err
    assert said.startswith("error: ")
    assert "something there already" in said
    assert said.count("\n") == 1


def test_the_command_plans_their_annotations_over_their_map(tmp_path: pathlib.Path, capsys) -> None:
    folder, notes, out = tmp_path / "s", tmp_path / "notes", tmp_path / "out"
    their_files(folder)
    x, y = load_map(folder).map.origin
    good, bad = Wanted("r001", (x + 2, y + 1), (x + 18, y + 9)), Wanted("r002", (x + 2, y + 1), (x + 99, y + 9))
    save_annotations(notes / "s.json", "s", [good, bad])
    assert main(["scene", "routes", str(folder), "--out", str(out), "--annotations", str(notes)]) == 1
    said = capsys.readouterr()
    assert json.loads(said.out)["routes"] == 1
    assert "s r002: the goal" in said.err
    assert [r.id for r in load_planned(out / "routes" / "s").planned] == ["r001"]
    assert load_annotations(out / "routes" / "s.json") == load_annotations(notes / "s.json")
    np.testing.assert_array_equal(load_map(out / "maps" / "s").map.kind, load_map(folder).map.kind)
    assert main(["scene", "routes", str(folder), "--out", str(out), "--robot", "wheelchair"]) == 0
    assert load_planned(out / "routes" / "s").robot == "wheelchair"
    assert main(["scene", "routes", str(folder), "--out", str(out), "--robot", "hovercraft"]) == 2
    assert main(["scene", "routes", str(tmp_path), "--out", str(out)]) == 2
    assert "no such file" in capsys.readouterr().err


@pytest.mark.extended
def test_the_command_films_and_writes_a_video(
    small_bank: SceneBank, tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    small_bank.save(tmp_path / "bank.npz")
    options = ["--bank", str(tmp_path / "bank.npz"), "--frames", "2", "--size", "36x64", "--samples", "1", "--quiet"]
    video = tmp_path / "walk.mp4"
    assert main(["capture", "--out", str(tmp_path / "r"), "--video", str(video), *options]) == 0
    assert '"frames": 2' in capsys.readouterr().out
    assert video.stat().st_size > 500
    assert len(Recording.load(tmp_path / "r")) == 2
    assert main(["capture", "--out", str(tmp_path / "s"), "--scene", "nowhere", *options]) == 2
    assert "needed one of" in capsys.readouterr().err


@pytest.mark.extended
def test_the_command_exports_a_gait(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    save_walking_policy(tmp_path / "run" / "checkpoints")
    out = tmp_path / "gait.npz"
    assert main(["export-gait", str(tmp_path / "run"), "--out", str(out), "--meta", '{"wall_seconds": 5}']) == 0
    assert json.loads(capsys.readouterr().out)["steps"] == 4096
    assert Gait.load(out).meta["wall_seconds"] == 5
    assert main(["export-gait", str(tmp_path / "run"), "--out", str(out), "--meta", "[5]"]) == 2
    assert "--meta" in capsys.readouterr().err
