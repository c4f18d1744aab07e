"""Scores of tasks beside point goals: between baseline and ceiling, as rows of a table and in its page."""

import csv
import json
import pathlib
import types
from typing import Any

import pytest

from benchmarks import campaign, films, tasks
from tests.benchmarks.test_campaign import _args
from urbanverse_mjx.envs import registry
from urbanverse_mjx.evaluation import report, task_agents
from urbanverse_mjx.training import policy


def result(seed: int = 0, teacher: float = 0.6) -> dict[str, Any]:
    def agent(score: float, steps: int) -> dict[str, Any]:
        values = {"mean": score, "low": score - 0.1, "high": score + 0.1}
        return {"steps": steps, "summary": {"task/score": values, "SR": {**values, "low": None}, "n": 48, "ends": {}}}

    agents = {"go_to_goal": agent(0.2, 0), "planner": agent(0.9, 0), "teacher": agent(teacher, 1_000_000)}
    return {"task": "CocoSocialNav", "seed": seed, "agents": agents}


def test_relative_is_0_at_the_baseline_and_1_at_the_ceiling() -> None:
    assert tasks.relative(0.2, 0.2, 0.8) == 0.0
    assert tasks.relative(0.8, 0.2, 0.8) == pytest.approx(1.0)
    assert tasks.relative(0.5, 0.2, 0.8) == pytest.approx(0.5)
    assert tasks.relative(0.5, 0.8, 0.8) is None


def test_rows_replace_those_of_the_same_agents_and_seed(tmp_path: pathlib.Path) -> None:
    path, page = tmp_path / "tasks.csv", tmp_path / "social_nav.md"
    for body in (result(0, 0.3), result(1, 0.7), result(0, 0.55)):
        (tmp_path / "result.json").write_text(json.dumps(body))
        tasks.add(tmp_path / "result.json", path)
    with path.open(newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["metric"] == "task/score"]
    found = [(row["agent"], row["seed"], row["mean"]) for row in rows]
    assert found == [
        ("go_to_goal", "", "0.2"), ("planner", "", "0.9"), ("teacher", "0", "0.55"), ("teacher", "1", "0.7")
    ]  # fmt: skip
    page.write_text(f"# Page\n{tasks.MARKS[0]}\nold\n{tasks.MARKS[1]}\nend\n")
    tasks.write_pages(path, tmp_path)
    text = page.read_text()
    assert "old" not in text
    assert text.endswith("end\n")
    assert "| go_to_goal | 0.200 [0.100, 0.300] | 0.2 | - |" in text
    (line,) = [x for x in text.splitlines() if x.startswith("| teacher, seed 0, 1,000,000 steps")]
    assert line.endswith("| 48 | 0.50 |"), "(0.55 - 0.2) / (0.9 - 0.2)"


def test_references_of_the_table_are_those_that_a_policy_alone_is_compared_with(
    tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "tasks.csv"
    (tmp_path / "result.json").write_text(json.dumps(result(0, 0.3)))
    tasks.add(tmp_path / "result.json", path)
    assert tasks.references("CocoSocialNav", path) == {"go_to_goal": 0.2, "planner": 0.9}
    assert tasks.driven_references("CocoSocialNav", path) == 48
    assert tasks.driven_references("CocoDeliver", path) == 0
    monkeypatch.setattr(tasks, "driven_references", lambda _: 0)
    with pytest.raises(SystemExit):
        tasks.arguments(["--task", "CocoDeliver", "--out", str(tmp_path), "--alone"])
    assert "no scores of CocoDeliver's baseline and planner" in capsys.readouterr().err


@pytest.mark.parametrize("alone", [False, True])
def test_a_policy_alone_is_compared_with_the_table_and_others_with_what_was_driven(
    alone: bool, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    known = {"go_to_goal": 0.1, "planner": 0.9, "teacher": 0.3}
    driven: list[str] = []

    def score(_: Any, name: str, *__: Any) -> list[Any]:
        driven.append(name)
        return []

    def summary(_: Any) -> dict[str, Any]:
        return {"task/score": {"mean": known[driven[-1]]}, "ends": {}}

    monkeypatch.setattr(tasks, "references", lambda _: {"go_to_goal": 0.2, "planner": 0.7})
    monkeypatch.setattr(tasks, "driven_references", lambda _: 5)
    monkeypatch.setattr(tasks, "scoring_env", lambda *_: None)
    monkeypatch.setattr(tasks, "suite_of", lambda *_: types.SimpleNamespace(episodes={"validation": [0] * 5}))
    monkeypatch.setattr(tasks, "score", score)
    monkeypatch.setattr(tasks, "summary_of", summary)
    monkeypatch.setattr(task_agents, "baseline_of", lambda _: ("go_to_goal", None))
    monkeypatch.setattr(task_agents, "planner_of", lambda _: None)
    monkeypatch.setattr(report, "write_csv", lambda *_: None)
    monkeypatch.setattr(policy, "load_policy", lambda _: (None, None))
    monkeypatch.setattr(policy.PolicySpec, "load", lambda _: types.SimpleNamespace(steps=7))
    words = ["--task", "CocoFollowRoute", "--out", str(tmp_path), "--teacher", "told", *(["--alone"] if alone else [])]
    found = tasks.measure(tasks.arguments(words), lambda **_: None)["agents"]
    assert driven == (["teacher"] if alone else ["go_to_goal", "planner", "teacher"])
    assert list(found) == driven
    of_table, of_driven = (0.3 - 0.2) / (0.7 - 0.2), (0.3 - 0.1) / (0.9 - 0.1)
    assert found["teacher"]["relative"] == pytest.approx(of_table if alone else of_driven)
    # Of other episodes than the table's, nothing is trained or driven.
    driven.clear()
    monkeypatch.setattr(tasks, "driven_references", lambda _: 6)
    if alone:
        with pytest.raises(SystemExit, match=r"found 5 episodes to drive and 6 of CocoFollowRoute's .* --episodes 6"):
            tasks.measure(tasks.arguments(words), lambda **_: None)
        assert not driven
    else:
        tasks.measure(tasks.arguments(words), lambda **_: None)


def test_every_task_has_a_page_with_marks_and_a_film_and_scores_of_its_own() -> None:
    for name, (page, metrics) in tasks.TASKS.items():
        assert name in registry.all_envs()
        assert registry.about(name)
        text = (tasks.PAGES / page).read_text(encoding="utf-8")
        assert all(mark in text for mark in tasks.MARKS)
        film = page.removesuffix(".md")
        assert films.TASKS[film] == name
        assert f"--only {film}" in text
        assert next(iter(metrics)) == tasks.HEADLINE


def test_the_campaign_has_a_teacher_and_a_camera_policy_of_each_task(tmp_path: pathlib.Path) -> None:
    args = _args(tmp_path, "--rows", "task-*", "--seeds", "3", "--task-steps", "1000")
    jobs = [job for job in campaign.trainings(args) if job.name.startswith("task-")]
    assert len(jobs) == 2 * len(tasks.TASKS)
    for job in jobs:
        parsed = tasks.arguments([*job.command[2:]])
        assert (parsed.steps, parsed.seed, parsed.train_scenes) == (1000, 3, campaign.TASK_STREETS)
        assert parsed.camera == ("-teacher-" not in job.name)
        assert parsed.train == [campaign.bank(name) for name in campaign.TASK_SETS]
        assert parsed.alone == (tasks.driven_references(parsed.task) >= 256)
        assert parsed.out == job.gives.parent
        assert set(job.needs) >= {*parsed.train, parsed.test}


def test_steps_are_those_of_the_teacher(tmp_path: pathlib.Path) -> None:
    from urbanverse_mjx.training.teacher_student import TeacherStudent

    words = ["--task", "CocoFollowPerson", "--out", str(tmp_path), "--steps", "9000", "--num-envs", "32", "--seed", "5"]
    args = tasks.arguments([*words, "--set", "teacher.learning_rate=0.001"])
    config = tasks.training_config(args)
    training = TeacherStudent(args.task, None, lambda: None, config, tmp_path)
    assert training.steps("teacher") == pytest.approx(9000, abs=1)
    assert training.steps("imitation") > 9000
    assert (config.num_envs, config.seed, config.teacher.learning_rate) == (32, 5, 0.001)


def test_options_of_the_training_alone_are_not_those_of_the_scoring(tmp_path: pathlib.Path) -> None:
    words = ["--task", "CocoFollowRoute", "--out", str(tmp_path), "--env", "task.length=100.0", "task.walk=25.0"]
    args = tasks.arguments([*words, "--train-env", "task.needs_crosswalk=false", "task.walk=30.0"])
    trained, scored = tasks.overrides(args, ["one"], False, True), tasks.overrides(args, ["one"], False)
    assert trained == scored | {"task.needs_crosswalk": False, "task.walk": 30.0}
    assert scored["task.walk"] == 25.0
    assert "task.needs_crosswalk" not in scored


@pytest.mark.parametrize("text", ["task.walk=False", "task.walk", "=1.0", "scenes=all"])
def test_options_that_are_no_json_are_refused_in_a_sentence(capsys: pytest.CaptureFixture[str], text: str) -> None:
    with pytest.raises(SystemExit):
        tasks.arguments(["--task", "CocoFollowRoute", "--out", "somewhere", "--train-env", "task.walk=30.0", text])
    assert f"argument --train-env: found {text!r}, needed NAME=VALUE with a value in JSON" in capsys.readouterr().err


def test_policies_that_are_there_are_scored_as_what_they_are(tmp_path: pathlib.Path) -> None:
    words = ["--task", "CocoSocialNav", "--out", str(tmp_path)]
    both = tasks.arguments([*words, "--student", "seeing", "--teacher", "told"])
    assert tasks.given(both) == {"teacher": pathlib.Path("told"), "student": pathlib.Path("seeing")}
    assert tasks.given(tasks.arguments([*words, "--student", "seeing"])) == {"student": pathlib.Path("seeing")}
    assert not tasks.given(tasks.arguments(words))


def test_a_command_line_without_a_task_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        tasks.arguments(["--out", "somewhere"])
    assert "found neither --task and --out nor" in capsys.readouterr().err
