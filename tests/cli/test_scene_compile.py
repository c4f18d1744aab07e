"""`urbanverse scene compile` on broken input: status 2, one sentence, no file written."""

import copy
import json
import pathlib
import subprocess
import sys
import time
import types
from collections.abc import Callable
from typing import Any, get_args

import pytest

from tests.support.box_bank import street_regions
from tests.support.toy_assets import few_episodes
from urbanverse_mjx import pipeline, progress
from urbanverse_mjx.cli import scene
from urbanverse_mjx.cli.main import main
from urbanverse_mjx.datatypes import GraphObject, SceneGraph, Source
from urbanverse_mjx.datatypes.scene_layout import HULL_KINDS

Corrupt = Callable[[dict[str, Any]], Any]


def _good() -> dict[str, Any]:
    objects = (GraphObject("post", "bollard", (10.0, 6.0, 0.6), (0.2, 0.2, 0.9), 0.0),)
    source = Source("hand", "Apache-2.0", "none", "none")
    return SceneGraph("street", source, objects, tuple(street_regions())).to_json()


def _drop(*path: Any) -> Corrupt:
    def change(graph: dict[str, Any]) -> None:
        body: Any = graph
        for key in path[:-1]:
            body = body[key]
        del body[path[-1]]

    return change


def _put(value: Any, *path: Any) -> Corrupt:
    def change(graph: dict[str, Any]) -> None:
        body: Any = graph
        for key in path[:-1]:
            body = body[key]
        body[path[-1]] = value

    return change


def _many(graph: dict[str, Any]) -> None:
    graph["objects"] = [{**graph["objects"][0], "id": f"o{i}"} for i in range(10_000)]


def _overlapping(graph: dict[str, Any]) -> None:
    graph["ground"].append({**graph["ground"][0], "id": "second_road"})


def _only_road(graph: dict[str, Any]) -> None:
    graph["objects"] = []
    graph["ground"] = [g for g in graph["ground"] if g["kind"] == "road"]


BROKEN = {
    "missing field": (_drop("objects", 0, "size"), "'post'.size"),
    "missing ground": (_drop("ground"), "ground"),
    "unknown category": (_put("zqxv", "objects", 0, "label"), "zqxv"),
    "NaN": (_put(float("nan"), "objects", 0, "center", 1), "NaN"),
    "infinity": (_put(float("inf"), "ground", 0, "plane", 2), "finite"),
    "negative size": (_put(-0.2, "objects", 0, "size", 0), "at least 0.001"),
    "text for a number": (_put("wide", "objects", 0, "size", 0), "finite number"),
    "self-crossing polygon": (_put([[0, 0], [4, 4], [4, 0], [0, 4]], "ground", 0, "polygon"), "cross"),
    "10,000 objects": (_many, "at most 5000"),
    "overlapping regions": (_overlapping, "'second_road'"),
    "no walkable ground": (_only_road, "walkable ground"),
    "unknown kind of ground": (_put("lava", "ground", 0, "kind"), "lava"),
    "twice the same id": (_put("road_west", "ground", 1, "id"), "twice"),
    "other schema": (_put("urbanverse.scene_graph/9", "schema"), "schema"),
}


def _refused(path: pathlib.Path, out: pathlib.Path, needle: str, capsys: pytest.CaptureFixture[str]) -> None:
    status = main(["scene", "compile", str(path), "--out", str(out)])
    captured = capsys.readouterr()
    assert status == 2
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    assert captured.err.endswith(".\n")
    assert "Traceback" not in captured.err
    assert needle in captured.err


@pytest.mark.parametrize("name", BROKEN)
def test_broken_graph_is_one_sentence_and_no_file(
    name: str, tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    change, needle = BROKEN[name]
    graph = copy.deepcopy(_good())
    change(graph)
    path = tmp_path / "graph.json"
    path.write_text(json.dumps(graph))
    _refused(path, tmp_path / "out", needle, capsys)
    assert [p.name for p in tmp_path.iterdir()] == ["graph.json"]


@pytest.mark.parametrize(
    ("body", "needle"),
    [
        (b"<mujoco/>", "not JSON"),
        (bytes(range(256)) * 40, "not JSON"),
        (b"", "not JSON"),
        (b"[" * 100_000, "not JSON"),
        (b"[1, 2]", "JSON object"),
    ],
    ids=["xml", "binary", "empty", "deep", "list"],
)
def test_what_is_no_graph_at_all(
    body: bytes, needle: str, tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "graph.json"
    path.write_bytes(body)
    _refused(path, tmp_path / "out", needle, capsys)
    assert [p.name for p in tmp_path.iterdir()] == ["graph.json"]


def test_folder_with_other_objects_stays_as_it_is(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "graph.json"
    path.write_text(json.dumps(_good()))
    out = tmp_path / "mine"
    out.mkdir()
    (out / "diary.txt").write_text("dear diary")
    _refused(path, out, "other files", capsys)
    assert [p.name for p in out.iterdir()] == ["diary.txt"]
    _refused(path, out / "diary.txt", "a file", capsys)
    assert (out / "diary.txt").read_text() == "dear diary"
    _refused(tmp_path / "nowhere.json", tmp_path / "new", "no such file", capsys)


def test_a_long_compilation_says_that_it_goes_on(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def compiles(*arguments: Any) -> Any:
        time.sleep(0.2)
        layout = types.SimpleNamespace(id="street")
        return types.SimpleNamespace(left_out=(), raised=()), types.SimpleNamespace(
            layout=layout, metadata={"counts": {}, "bodies": {}}
        )

    monkeypatch.setattr(pipeline, "compile_graph", compiles)
    monkeypatch.setattr(progress, "LINE_EVERY", 0.05)
    assert main(["scene", "compile", "graph.json", "--out", str(tmp_path / "out")]) == 0
    said = capsys.readouterr()
    assert said.err.startswith("compiling scenes: 0/1")
    assert json.loads(said.out)["id"] == "street"


def test_a_street_without_kerbs_gets_some_and_says_so(
    tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The written heights are not those of the compiled ground, which nobody would notice otherwise."""
    graph = _good()
    graph["ground"] = [
        {"id": name, "kind": kind, "polygon": [[0, a], [30, a], [30, b], [0, b]], "plane": [0, 0, z]}
        for name, kind, a, b, z in (("lane", "road", 0, 4, 0.0), ("path", "sidewalk", 4, 9, 0.02))
    ]
    (tmp_path / "graph.json").write_text(json.dumps(graph))
    with few_episodes():
        assert main(["scene", "compile", str(tmp_path / "graph.json"), "--out", str(tmp_path / "street")]) == 0
    said = capsys.readouterr()
    assert "raised path to a kerb of 15 cm, because no step from there to the road is 5 cm or more\n" in said.err
    assert json.loads(said.out)["raised"] == ["path"]
    layout = json.loads((tmp_path / "street" / "layout.json").read_text())
    assert {g["id"]: g["plane"][2] for g in layout["ground"]} == pytest.approx({"lane": 0.0, "path": 0.15})


def test_as_a_process_without_a_traceback(tmp_path: pathlib.Path) -> None:
    path = tmp_path / "graph.json"
    path.write_text("not json")
    command = [
        sys.executable,
        "-m",
        "urbanverse_mjx.cli.main",
        "scene",
        "compile",
        str(path),
        "--out",
        str(tmp_path / "out"),
    ]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 2
    assert run.stdout == ""
    assert run.stderr.startswith("error: ")
    assert run.stderr.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_the_command_knows_every_kind_of_hulls() -> None:
    assert get_args(scene.CompileArgs.__annotations__["hulls"]) == HULL_KINDS
