"""Streets distilled from images alone: the film, the banks of both arms, and the table."""

import argparse
import json
import pathlib

import numpy as np
import pytest

from benchmarks import image_streets
from benchmarks.lib import fidelity_scores as scores
from benchmarks.lib import fidelity_store
from urbanverse_mjx.citygen import city_blocks
from urbanverse_mjx.datatypes import GraphObject


def test_ten_streets_of_all_continents_that_walk_and_drive() -> None:
    names = image_streets.streets()
    assert len(set(names)) == 10
    assert set(names) <= set(city_blocks.layouts(image_streets.SET))
    assert len({name.split("_")[0] for name in names}) >= 5
    assert {name.split("_")[-2] for name in names} == {"walk", "drive"}


def test_the_camera_makes_equal_steps_along_a_bent_way() -> None:
    places = np.array([[0, 0, 1.5, 0.0], [10, 0, 1.5, 0.0], [10, 8, 1.7, np.pi / 2], [10, 16, 1.7, np.pi / 2]])
    path = image_streets.camera_path(places)
    position = path.T_world_camera[:, :3, 3]
    assert len(position) == len(np.arange(0, 26, 0.7))
    assert np.diff(path.time_s) == pytest.approx(np.full(len(position) - 1, 0.5))
    steps = np.linalg.norm(np.diff(position[:, :2], axis=0), axis=1)
    assert np.median(steps) == pytest.approx(0.7)
    assert steps.max() < 0.71
    # The ways of the library turn to both sides alternately; an image-based reconstruction needs small turns.
    forward = path.T_world_camera[:, :3, 2]
    turns = np.degrees(np.arccos(np.clip((forward[1:] * forward[:-1]).sum(1), -1, 1)))
    assert turns.max() < 18.0
    assert np.ptp(position[:, 2]) == pytest.approx(0.2, abs=0.01)


def test_a_camera_that_turns_around_on_the_spot_takes_three_seconds() -> None:
    places = np.array([[0, 0, 1.5, 0.0], [20, 0, 1.5, 0.0], [20, 0.6, 1.5, np.pi], [0, 0.6, 1.5, np.pi]])
    path = image_streets.camera_path(places)
    position, forward = path.T_world_camera[:, :3, 3], path.T_world_camera[:, :3, 2]
    on_the_spot = (position[:, 0] > 19.99).sum()
    assert on_the_spot == pytest.approx(3.0 * image_streets.RATE, abs=1)
    turns = np.degrees(np.arccos(np.clip((forward[1:] * forward[:-1]).sum(1), -1, 1)))
    # Half a second at 60 degrees/s, and the sway on top.
    assert turns.max() < 40.0
    steps = np.linalg.norm(np.diff(position[:, :2], axis=0), axis=1)
    assert np.median(steps) == pytest.approx(0.7)


@pytest.fixture
def out(tmp_path: pathlib.Path) -> pathlib.Path:
    """One street with both arms, and one from whose images nothing came."""
    true = [GraphObject("a", "car", (0.0, 0.0, 0.75), (4.0, 2.0, 1.5), 0.0)]
    found = [GraphObject("b", "car", (0.6, 0.8, 0.75), (4.0, 2.0, 1.5), 0.1)]
    score = scores.score(found, true, [], {"a": True})
    row = {**scores.table_row([score]), "trajectory_m": 0.25, "planner_percent": 93.75}
    for arm in image_streets.ARMS:
        fidelity_store.save(tmp_path / "streets" / "one" / arm / "scores.json", {arm: (score, {"trajectory_m": 0.25})})
    (tmp_path / "streets" / "one" / image_streets.DONE).write_text(json.dumps(dict.fromkeys(image_streets.ARMS, row)))
    (tmp_path / "streets" / "two").mkdir()
    failed = {"exact": row, "images": {"failed": "found poses for 0 of 80 frames, needed 3"}}
    (tmp_path / "streets" / "two" / image_streets.DONE).write_text(json.dumps(failed))
    return tmp_path


def test_the_table_pools_streets_of_both_arms_and_names_the_others(out: pathlib.Path) -> None:
    lines = image_streets.page_text(out).splitlines()
    assert len({line.count("|") for line in lines}) == 1
    pooled = [line for line in lines if line.startswith("| all 1 | images")]
    assert len(pooled) == 1
    assert "| 100 | 1 | 5.73 |" in pooled[0]
    assert pooled[0].endswith("| 0.25 | 93.8 |")
    assert sum("found poses for 0 of 80 frames" in line for line in lines) == 1
    assert image_streets.page_text(out / "empty").startswith("Not run yet")


def test_a_street_that_failed_is_in_neither_bank_and_not_tried_again(
    out: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(image_streets, "film", lambda *_: pytest.fail("a finished street was filmed again"))
    joined: list[list[pathlib.Path]] = []

    class Bank:
        def __init__(self, path: pathlib.Path) -> None:
            self.path = path

        @staticmethod
        def load(path: pathlib.Path) -> "Bank":
            return Bank(path)

    class Joined:
        def save(self, path: pathlib.Path) -> None:
            path.write_text("bank")

    monkeypatch.setattr(image_streets, "SceneBank", Bank)
    monkeypatch.setattr(image_streets, "join", lambda banks: joined.append([b.path for b in banks]) or Joined())
    args = argparse.Namespace(out=out, cousins=5, length=200.0)
    found = {street: image_streets.street_done(street, args) for street in ("one", "two")}
    assert image_streets.join_banks(args, found) == ["one"]
    work = out / "streets" / "one"
    assert joined == [[work / arm / "run" / "bank.npz"] for arm in image_streets.ARMS]
    assert json.loads((out / image_streets.BANKS).read_text())["streets"] == ["one"]
