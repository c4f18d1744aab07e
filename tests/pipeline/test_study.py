"""`urbanverse study` from compiled scenes to the page's files, and layouts of compiled scenes against their graphs."""

import dataclasses
import json
import pathlib
from typing import Any

import imageio.v2 as imageio
import numpy as np
import pytest
from PIL import Image

from tests.support.box_bank import KERB, street_regions
from tests.support.toy_assets import TOY_SOURCE, few_episodes, toy_index, toy_layout
from urbanverse_mjx import materialisation, pipeline
from urbanverse_mjx.cli.main import main
from urbanverse_mjx.datatypes import GraphObject, SceneGraph, Source, ValidationError
from urbanverse_mjx.pipeline import make_controller
from urbanverse_mjx.pipeline.study import walkthrough
from urbanverse_mjx.scene import compile_scene, pack_bank

OBJECTS = [
    GraphObject("post", "bollard", (20.0, 6.6, KERB + 0.5), (0.3, 0.3, 1.0), 0.0),
    GraphObject("other", "bollard", (24.0, 5.0, KERB + 0.5), (0.3, 0.3, 1.0), 0.5),
]


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> dict[str, pathlib.Path]:
    """Two cousins of one graph, a procedural street, and the folder of graphs."""
    root = tmp_path_factory.mktemp("scenes")
    graph = SceneGraph("toy", Source("hand", "Apache-2.0", "none", "none"), tuple(OBJECTS), tuple(street_regions()))
    graph.save(root / "graphs" / "toy" / "graph.json.gz")
    controller = make_controller()
    with few_episodes():
        for place, name in (("ours", "toy_Cousin_01"), ("ours", "toy_Cousin_02"), ("procedural", "street_000")):
            layout = dataclasses.replace(toy_layout(graph, 3), id=name)
            compile_scene(layout, toy_index(), root / place / name, controller, source=TOY_SOURCE)
    return {name: root / name for name in ("ours", "procedural", "graphs")}


@pytest.fixture(scope="module")
def made(folders: dict[str, pathlib.Path], tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    out = tmp_path_factory.mktemp("study") / "page"
    assert main(words(out, folders)) == 0
    return out


def words(out: pathlib.Path, folders: dict[str, pathlib.Path]) -> list[str]:
    places = ["--ours", str(folders["ours"]), "--baseline", str(folders["procedural"])]
    numbers = ["--pairs", "3", "--rated", "1", "--catches", "1", "--width", "96", "--frames", "4", "--quiet"]
    return ["study", "make", "--out", str(out), *places, "--graphs", str(folders["graphs"]), *numbers]


@pytest.mark.extended
def test_the_page_shows_every_kind_of_trial(made: pathlib.Path) -> None:
    key = json.loads((made.parent / "page-key.json").read_text())
    kinds = [trial["kind"] for trial in key["trials"]]
    assert [kinds.count(kind) for kind in ("pair", "rating", "fidelity")] == [4, 3, 1]
    groups = sorted(row["group"] for row in key["key"].values())
    # Two overviews, a video and one image from straight above of ours; an overview and a video of the other.
    assert groups == ["procedural"] * 2 + ["source"] + ["urbanverse"] * 4
    assert sorted(path.name for path in (made / "media").iterdir()) == sorted(key["key"])
    for name in key["key"]:
        if name.endswith(".jpg"):
            image = np.asarray(Image.open(made / "media" / name).convert("RGB"), float)
            assert image.std() > 5.0, name
        else:
            frames = np.array(imageio.mimread(made / "media" / name), float)
            assert frames.shape == (4, 60, 96, 3)
            assert np.abs(np.diff(frames, axis=0)).mean() > 2.0


def test_a_second_run_draws_nothing_anew(
    made: pathlib.Path, folders: dict[str, pathlib.Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    page = (made / "index.html").read_bytes()

    def refuse(*_: Any, **__: Any) -> None:
        raise AssertionError("drawn again")

    monkeypatch.setattr("urbanverse_mjx.viz.images.Studio", refuse)
    assert main(words(made, folders)) == 0
    assert (made / "index.html").read_bytes() == page


def test_a_walk_turns_once_around_along_the_longest_route(folders: dict[str, pathlib.Path]) -> None:
    bank = pack_bank([folders["procedural"] / "street_000"], ["train"])
    cameras = list(walkthrough(bank, 0, 40))
    places, ahead = np.array([at for at, _ in cameras]), np.array([direction for _, direction in cameras])
    row = int(np.argmax(bank.episode_length[0]))
    np.testing.assert_allclose(
        places[[0, -1], :2], [bank.episode_start[0, row, :2], bank.episode_goal[0, row, :2]], atol=1e-4
    )
    steps = np.linalg.norm(np.diff(places[:, :2], axis=0), axis=1)
    assert steps.max() < 1.5 * bank.episode_length[0, row] / 39
    yaw = np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0]))
    assert yaw[-1] - yaw[0] == pytest.approx(2 * np.pi * 39 / 40)


def test_cousins_stand_where_their_graph_says_and_are_otherwise_compared(
    folders: dict[str, pathlib.Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(materialisation, "index_of", lambda _: toy_index())
    found = pipeline.compare_layouts([folders["ours"]], graphs=folders["graphs"], permutations=19)
    assert (found["streets"], found["paired"]) == ([1, 1], True)
    statistics = found["statistics"]
    assert statistics["spacing_m"]["median_a"] == pytest.approx(statistics["spacing_m"]["median_b"], abs=0.02)
    assert statistics["categories"]["distance"] == 0.0
    other = pipeline.compare_layouts([folders["ours"]], [folders["procedural"]], permutations=19)
    assert (other["streets"], other["paired"]) == ([2, 1], False)


@pytest.mark.parametrize(
    ("changed", "text"),
    [
        ({}, "both or neither"),
        ({"graphs": "graphs", "permutations": 3}, "permutations"),
        ({"graphs": "ours"}, "graph.json"),
    ],
)
def test_what_cannot_be_compared_is_named(
    folders: dict[str, pathlib.Path], changed: dict[str, Any], text: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(materialisation, "index_of", lambda _: toy_index())
    options = {**changed, **({"graphs": folders[changed["graphs"]]} if "graphs" in changed else {})}
    with pytest.raises(ValidationError, match=text):
        pipeline.compare_layouts([folders["ours"]], **options)


def test_a_study_of_nothing_is_refused(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "empty").mkdir()
    assert main(["study", "make", "--out", str(tmp_path / "out"), "--ours", str(tmp_path / "empty")]) == 2
    assert "no compiled scene" in capsys.readouterr().err
    assert main(["study", "analyse", str(tmp_path / "key.json"), "a.csv"]) == 2
    assert not (tmp_path / "out").exists()
