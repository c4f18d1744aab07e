"""One policy for many robots: a row from its training to its scores, and the table of all rows."""

import dataclasses
import json
import pathlib
from collections.abc import Mapping, Sequence
from typing import Any

import pytest

from benchmarks import campaign, embodiment, robots
from tests.benchmarks.test_campaign import _args
from tests.support.unicycle import unicycle_env
from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.envs import NavEnv, registry
from urbanverse_mjx.robots import catalogue, load


@pytest.fixture
def bank_file(small_bank: SceneBank, tmp_path: pathlib.Path) -> pathlib.Path:
    small_bank.save(tmp_path / "bank.npz")
    return tmp_path / "bank.npz"


@pytest.mark.extended
def test_a_row_is_trained_goes_on_and_is_scored(
    bank_file: pathlib.Path, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With robots that obey at once."""
    made = []

    def make(name: str, bank: SceneBank, scenes: Sequence[str], impl: str, options: Mapping[str, Any]) -> NavEnv:
        made.append((name, tuple(scenes), impl))
        robot = dataclasses.replace(load(name), command=lambda velocity: velocity)
        given = {"vision": False, "episode_length": 10, "observations.robot": True, "scenes": ",".join(scenes)}
        return unicycle_env(bank, {**given, **options}, robot=robot)

    monkeypatch.setattr(embodiment, "make_env", make)
    sizes = ("--num-envs", "4", "--steps", "64", "--threads", "1", "--impl", "jax")
    options = ("--set", "unroll_length=8", "minibatches=2", "--train", str(bank_file), "--train-scenes", "1")
    shared, words = tmp_path / "shared", ("--robots", "husky", "hunter")
    for _ in range(2):  # the second time there is nothing left to train
        assert embodiment.main(["train", *words, *sizes, *options, "--seed", "3", "--out", str(shared)]) == 0
    body = json.loads((shared / "result.json").read_text())
    assert (body["steps"], body["told"], body["robots"]) == (128, True, ["husky", "hunter"])
    assert [name for name, *_ in made] == ["husky", "hunter"]
    assert all(len(scenes) == 1 and impl == "jax" for _, scenes, impl in made)
    policies = ("--shared", str(shared), "--own", str(shared))
    out = str(tmp_path / "score")
    words = ("score", "--robot", "hunter", "--test", str(bank_file), "--episodes", "3", "--out", out, *policies)
    assert embodiment.main(words) == 0
    agents = json.loads((tmp_path / "score" / "result.json").read_text())["agents"]
    assert list(agents) == ["go_to_goal", "shared", "own"]
    assert agents["shared"]["robots"] == ["husky", "hunter"]
    assert [agents[name].get("seed") for name in agents] == [None, 3, 3]
    counts = {sum(agent["ends"].values()) for agent in agents.values()}
    assert counts == {agents["own"]["episodes"]}
    path = tmp_path / "embodiment.csv"
    path.write_text(",".join(embodiment.COLUMNS) + "\n")
    for _ in range(2):
        embodiment.add(tmp_path / "score" / "result.json", path)
    lines = path.read_text().splitlines()
    assert len(lines) == 4
    assert lines[2].startswith(f"hunter,shared,3,128,{agents['shared']['episodes']},")


def test_the_registered_robots_are_told_what_they_are(small_bank: SceneBank) -> None:
    ids = small_bank.scene_ids
    for name in ("coco", "wheelchair", "husky"):
        env = embodiment.make_env(name, small_bank, ids, "jax", {})
        assert env.robot.name in (name, "coco_differential")
        assert env.config.observations.robot
        assert not env.config.vision


def rows(path: pathlib.Path, *given: tuple[str, str, int | str, int, int]) -> pathlib.Path:
    lines = [",".join(embodiment.COLUMNS)]
    for robot, agent, seed, won, episodes in given:
        lines.append(f"{robot},{agent},{seed},1000,{episodes},{won},{episodes - won},0,0,0,0,0.5")
    path.write_text("\n".join(lines) + "\n")
    return path


def test_the_table_counts_robots_that_are_driven_halfway_to_the_planner(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """husky: 20 % and 90 %, so 55 % is halfway; the planner of jackal is that of the robots' own table."""
    monkeypatch.setattr(robots, "kept", lambda: {"jackal": {"planner": {"episodes": 16, "ends": {"goal": 16}}}})
    path = rows(
        tmp_path / "embodiment.csv",
        ("husky", "go_to_goal", "", 20, 100), ("husky", "planner", "", 90, 100),
        ("husky", "shared", 0, 50, 100), ("husky", "shared", 1, 60, 100), ("husky", "untold", 0, 54, 100),
        ("jackal", "go_to_goal", "", 40, 100), ("jackal", "shared", 0, 80, 100), ("jackal", "own", 0, 71, 100),
        ("scout", "go_to_goal", "", 10, 100), ("scout", "shared", 0, 30, 100),
    )  # fmt: skip
    page = tmp_path / "robots.md"
    page.write_text(f"# Page\n{embodiment.MARKS[0]}\nbefore\n{embodiment.MARKS[1]}\nend\n")
    embodiment.write_page(path, page)
    text = page.read_text()
    assert "before" not in text
    lines = text.splitlines()
    assert lines[2] == "| robot | go_to_goal | own policy | shared, told | shared, not told | planner |"
    assert lines[4] == "| `husky` | 20 [13, 29] |  | 55 [48, 62] | 54 [44, 63] | 90 [83, 94] |"
    assert lines[5].startswith("| `jackal` | 40 [31, 50] | 71 [61, 79] | 80 [71, 87] |  | 100 [81, 100] |")
    assert lines[6] == "| mean of 2 in the training | 30.0 |  | 67.5 |  | 95.0 |"
    assert lines[7].startswith("| `scout`, held out | 10 ")
    assert lines[8] == "| mean of 1 held out | 10.0 |  | 30.0 |  |  |"
    assert "* shared, told: 2 of 2 robots in the training" in lines
    assert "* shared, not told: 0 of 1 robots in the training" in lines
    assert "* own policy: 1 of 1 robots in the training" in lines
    assert not [line for line in lines if line.startswith("*") and "held out" in line], "its planner is missing"


def test_nothing_stands_in_the_table_before_there_are_rows(tmp_path: pathlib.Path) -> None:
    assert embodiment.table(embodiment.tallies(rows(tmp_path / "none.csv"))) == embodiment.NOT_RUN
    assert embodiment.SCORES.read_text().splitlines()[0] == ",".join(embodiment.COLUMNS)
    text = embodiment.PAGE.read_text(encoding="utf-8")
    assert embodiment.table(embodiment.tallies()) in text, "run python -m benchmarks.embodiment --page"


def test_robots_are_of_every_kind_and_none_is_trained_and_held_out() -> None:
    assert len(embodiment.TRAINED) >= 12
    assert len(embodiment.HELD_OUT) == 3
    both = (*embodiment.TRAINED, *embodiment.HELD_OUT)
    assert len(set(both)) == len(both)
    for name in both:
        assert embodiment.environment_of(name)[0] in registry.ALL_ENVS
    kinds = {catalogue.row(name).drive for name in embodiment.TRAINED if name in catalogue.NAMES}
    assert kinds == {"skid", "differential", "ackermann", "swerve"}
    assert {catalogue.row(name).drive for name in embodiment.HELD_OUT} == kinds - {"swerve"}


def test_the_campaign_trains_equal_steps_and_scores_what_it_trained(tmp_path: pathlib.Path) -> None:
    args = _args(tmp_path, "--rows", "embodiment-*", "--seeds", "4", "--embodiment-steps", "1000")
    jobs = {job.name: job for job in campaign.trainings(args) if job.name.startswith("embodiment-")}
    trained = [f"embodiment-{name}-4" for name in ("shared", "untold", *embodiment.TRAINED)]
    scored = [f"embodiment-score-{name}-4" for name in (*embodiment.TRAINED, *embodiment.HELD_OUT)]
    assert list(jobs) == trained + scored
    found = {name: embodiment.arguments([*job.command[2:]]) for name, job in jobs.items()}
    assert {(found[name].steps, found[name].seed) for name in trained} == {(1000, 4)}
    assert [found[name].not_told for name in trained[:3]] == [False, True, True]
    assert found["embodiment-husky-4"].robots == ["husky"]
    assert tuple(found["embodiment-untold-4"].robots) == embodiment.TRAINED
    husky, scout = (found[f"embodiment-score-{name}-4"] for name in ("husky", "scout"))
    folders = embodiment.policies_of(husky)
    assert {name: folder.name for name, folder in folders.items()} == {
        "shared": "embodiment-shared-4", "untold": "embodiment-untold-4", "own": "embodiment-husky-4"
    }  # fmt: skip
    assert set(embodiment.policies_of(scout)) == {"shared", "untold"}
    assert {folder / "result.json" for folder in folders.values()} <= set(jobs["embodiment-score-husky-4"].needs)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["train", "--out", "o"], "found no --train"),
        (["train", "--out", "o", "--train", "b", "--robots", "hover"], "--robots: found 'hover', needed names of coco"),
        (["score", "--out", "o", "--robot", "hover"], "--robot: found 'hover'"),
        (["score", "--out", "o"], "--robot: found None"),
        ([], "found neither a role and --out nor"),
    ],
)
def test_a_wrong_command_line_is_a_sentence(words: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        embodiment.arguments(words)
    assert said in capsys.readouterr().err
