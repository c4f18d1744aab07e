"""`urbanverse view`: wrong input is one sentence and exit status 2, before anything is served."""

import json
import pathlib
import re
import socket
import time

import pytest

from urbanverse_mjx import progress
from urbanverse_mjx.cli import main as cli
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.pipeline import machines, view_scenes
from urbanverse_mjx.pipeline.view_scenes import ViewScenes
from urbanverse_mjx.viewer import page


def refused(capsys: pytest.CaptureFixture[str], *argv: str) -> str:
    assert cli.main(["view", *argv, "--no-open"]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith("error: ")
    assert said.err.count("\n") == 1
    return said.err


def test_an_unknown_scene_is_refused_with_the_nearest(capsys: pytest.CaptureFixture[str]) -> None:
    said = refused(capsys, "parkedge")
    assert "scene: found no 'parkedge'" in said
    assert "did you mean 'park_edge'" in said


def test_a_file_that_is_no_graph_is_refused(capsys: pytest.CaptureFixture[str], tmp_path: pathlib.Path) -> None:
    wrong = tmp_path / "wrong.graph.json"
    wrong.write_text(json.dumps({"schema": "other"}), encoding="utf-8")
    assert "scene graph.id: found nothing" in refused(capsys, str(wrong), "--port", "0")


def test_a_port_in_use_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        assert f"--port: found {port} on 127.0.0.1 taken" in refused(capsys, "park_edge", "--port", str(port))


@pytest.mark.parametrize("wrong", ["no/such/folder", "missing.onnx", "go_to_gaol"])
def test_a_missing_policy_is_refused(
    capsys: pytest.CaptureFixture[str], bank: SceneBank, monkeypatch: pytest.MonkeyPatch, wrong: str
) -> None:
    monkeypatch.setattr(ViewScenes, "open", lambda self, name, cousin=0: (bank, 0))
    assert wrong in refused(capsys, "park_edge", "--port", "0", "--policy", wrong)


def test_the_terminal_says_that_the_page_is_prepared(
    capsys: pytest.CaptureFixture[str], bank: SceneBank, monkeypatch: pytest.MonkeyPatch
) -> None:
    said, limit = "", time.monotonic() + 20.0

    def prepare(*_: object) -> None:
        nonlocal said
        while "\n" not in said and time.monotonic() < limit:
            time.sleep(0.02)
            said += capsys.readouterr().err
        raise ValidationError("prepared.")

    monkeypatch.setattr(progress, "LINE_EVERY", 0.05)
    monkeypatch.setattr(ViewScenes, "open", lambda self, name, cousin=0: (bank, 0))
    monkeypatch.setattr(page, "Page", prepare)
    refused(capsys, "park_edge", "--port", "0")
    assert re.match(r"opening: 0/1 street, \d+ s, preparing the page\n", said)


def test_ctrl_c_is_the_normal_end_of_a_page_but_not_of_its_preparation(
    capsys: pytest.CaptureFixture[str], bank: SceneBank, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Served:
        def __init__(self, *_: object) -> None:
            if preparing:
                raise KeyboardInterrupt

        def open_scene(self, name: str) -> None:
            raise NotImplementedError

        def run(self, until: object) -> None:
            raise KeyboardInterrupt

    monkeypatch.setattr(ViewScenes, "open", lambda self, name, cousin=0: (bank, 0))
    monkeypatch.setattr(page, "Page", Served)
    preparing = False
    assert cli.main(["view", "park_edge", "--port", "0", "--no-open"]) == 0
    said = capsys.readouterr()
    assert re.fullmatch(r"open http://127\.0\.0\.1:\d+\S*\nstopped; the page is closed\n", said.err)
    assert said.out == ""
    preparing = True
    assert cli.main(["view", "park_edge", "--port", "0", "--no-open"]) == 130
    assert capsys.readouterr().err == "interrupted\n"


def test_numbers_out_of_range_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert "--robots" in refused(capsys, "park_edge", "--robots", "9")
    assert "--port" in refused(capsys, "park_edge", "--port", "70000")


def test_scenes_by_name_file_folder_and_bank(
    tmp_path: pathlib.Path, small_bank: SceneBank, monkeypatch: pytest.MonkeyPatch
) -> None:
    library = tmp_path / "library"
    for cousin in (1, 2):
        (library / "craftbench" / "scenes" / f"alley_Cousin_0{cousin}").mkdir(parents=True)
        (library / "craftbench" / "scenes" / f"alley_Cousin_0{cousin}" / "metadata.json").write_text("{}")
    monkeypatch.setattr(view_scenes.settings, "cache_dir", lambda *parts: tmp_path.joinpath(*parts))
    graph = tmp_path / "corner.graph.json"
    graph.write_text("{}", encoding="utf-8")
    own = tmp_path / "street" / "graph.json"
    own.parent.mkdir()
    own.write_text("{}", encoding="utf-8")
    small_bank.save(tmp_path / "boxes.npz")
    scenes = ViewScenes([str(graph), str(own), str(tmp_path / "boxes.npz"), "alley_Cousin_02", "park_edge"])
    first = f"boxes/{small_bank.scene_ids[0]}"
    assert scenes.first == ["corner", "street", first, "alley_Cousin_02", "park_edge"]
    assert set(scenes.first) <= set(scenes.names)
    assert {"alley", "residential_bins"} <= set(scenes.names)
    assert [scenes.cousins(x) for x in ("corner", "alley", "alley_Cousin_02", first)] == [64, 2, 1, 1]
    bank, row = scenes.open(f"boxes/{small_bank.scene_ids[2]}")
    assert bank.scene_ids[row] == small_bank.scene_ids[2]
    # The programs of a bank's machine are compiled once for all its scenes.
    assert scenes.open(first)[0] is bank
    small_bank.save(tmp_path / "many.bank")
    scenes = ViewScenes([str(tmp_path / "many.bank")])
    assert scenes.first == [f"many/{small_bank.scene_ids[0]}"]
    bank, row = scenes.open(f"many/{small_bank.scene_ids[2]}")
    assert (bank.scene_ids, row) == ((small_bank.scene_ids[2],), 0), "the others are not read"
    with pytest.raises(ValidationError, match="found 2, needed one of 0 to 1"):
        scenes.open("alley", 2)


def test_a_cousin_of_a_graph_is_compiled_once(
    bank: SceneBank, small_bank: SceneBank, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = []

    def compiled(graph: pathlib.Path, cousin: int) -> SceneBank:
        asked.append((graph.parent.name, cousin))
        return small_bank

    monkeypatch.setattr(view_scenes, "_compiled", compiled)
    scenes = ViewScenes()
    for _ in range(2):
        assert scenes.open("construction_narrow", 1) == (small_bank, 0)
    assert asked == [("construction_narrow", 1)]
    # The first cousin is the one that the bank of the shipped streets holds.
    found, row = scenes.open("construction_narrow")
    assert (found.scene_ids, row) == (bank.scene_ids, bank.scene_ids.index("construction_narrow"))
    assert scenes.open("park_edge") == (found, bank.scene_ids.index("park_edge"))
    assert scenes.open("park_edge")[0] is found
    assert asked == [("construction_narrow", 1)]


def test_a_graph_with_the_name_of_a_shipped_street_is_the_users(
    tmp_path: pathlib.Path, small_bank: SceneBank, monkeypatch: pytest.MonkeyPatch
) -> None:
    own = tmp_path / "park_edge" / "graph.json"
    own.parent.mkdir()
    own.write_text("{}", encoding="utf-8")
    asked = []

    def compiled(graph: pathlib.Path, cousin: int) -> SceneBank:
        asked.append(graph)
        return small_bank

    monkeypatch.setattr(view_scenes, "_compiled", compiled)
    scenes = ViewScenes([str(own)])
    assert scenes.open("park_edge") == (small_bank, 0)
    assert asked == [own]


def test_the_camera_of_a_rule_is_drawn_and_everything_is_as_in_the_bank() -> None:
    config = machines._fresh_config(None, False, "cpu", machines.IMAGE_SIZE)
    assert config.vision
    assert (config.vision_config.height, config.vision_config.width) == machines.IMAGE_SIZE
    assert config.randomization.appearance == 0


def test_a_recorder_draws_no_image_for_a_rule() -> None:
    config = machines._fresh_config(None, False, "paper", None)
    assert (config.preset, config.vision) == ("paper", False)
