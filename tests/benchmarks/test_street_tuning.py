"""Tuning on a filmed street: routes of the choice are not scored, stopped runs continue, and rows make the table."""

import csv
import json
import pathlib
import types
from typing import Any

import numpy as np
import pytest

from benchmarks import results, street_tuning
from tests.support.cut_runs import killed_at
from tests.training.test_student import seeing_env
from tests.training.test_tuning import small_config
from urbanverse_mjx import settings
from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.evaluation.frozen import Protocol
from urbanverse_mjx.training import snapshot
from urbanverse_mjx.training.dagger import make_student
from urbanverse_mjx.training.policy import PolicySpec, save_student
from urbanverse_mjx.training.student import initial_student

STREET = street_tuning.STREETS[0]
HEAD = "street,film,seconds_prepare,arm,seed,env_steps,seconds_train,ends"


def args_of(out: pathlib.Path, *words: str) -> Any:
    return street_tuning.arguments([*words, "--out", str(out), "--streets", STREET])


def test_routes_that_chose_a_street_are_not_scored() -> None:
    frozen = Protocol.load(settings.protocol_root() / "craftbench.json").scenes[-1].episodes
    start = np.array([e.start for e in frozen] + [[x, 0.5, 0.0, 0.0] for x in range(96)])
    goal = np.array([e.goal for e in frozen] + [[x + 9.0, 0.5, 0.0] for x in range(96)])
    order = np.random.default_rng(0).permutation(len(start))
    # A bank's numbers are in single precision; the same start with another goal is another route.
    start, goal = start[order].astype(np.float32), goal[order].astype(np.float32)
    table = {"episode_start": start[None], "episode_goal": goal[None], "num_episodes": np.array([len(start)])}
    rows = street_tuning.scored(types.SimpleNamespace(**table), 1000)
    assert sorted(order[rows]) == list(range(len(frozen), len(start)))
    fewer = street_tuning.scored(types.SimpleNamespace(**table), 10)
    assert len(fewer) == 10
    assert set(fewer) < set(rows)
    assert (fewer[0], fewer[-1]) == (rows[0], rows[-1]), "spread over the whole table"
    table["episode_goal"] = table["episode_goal"] + np.float32(0.5)
    assert len(street_tuning.scored(types.SimpleNamespace(**table), 1000)) == len(start)


def test_streets_are_known_and_those_of_the_worst_scores() -> None:
    assert {*street_tuning.STREETS, "t13_narrow_gate"} <= set(street_tuning.known_streets())
    with (results.SCORES / "by_scene.csv").open(encoding="utf-8") as file:
        rows = [r for r in csv.DictReader(file) if (r["policy"], r["benchmark"]) == ("coco_best", "craftbench")]
    rates = {row["scene"]: float(row["SR"]) for row in rows}
    others = [rate for scene, rate in rates.items() if scene not in street_tuning.STREETS]
    assert max(rates[street] for street in street_tuning.STREETS) <= min(others)


def test_a_spoilt_image_is_less_sharp_and_as_bright() -> None:
    board = np.kron(np.indices((8, 8)).sum(0) % 2, np.ones((8, 8)))[..., None].repeat(3, -1)
    image = (90 + 60 * board).astype(np.uint8)
    rng = np.random.default_rng(0)
    found = [street_tuning.spoil(image, rng).astype(float) for _ in range(8)]
    assert not np.array_equal(found[0], found[1])
    for one in found:
        # 0.3 powers of two in linear light are at most a seventh in sRGB.
        assert 0.85 < one.mean() / image.mean() < 1.16
        assert one.shape == image.shape
    # The edge between the first two fields, 60 in the image.
    assert 15 < np.mean([np.abs(one[:, 8] - one[:, 7]).mean() for one in found]) < 50


class Stages:
    """In place of the stages of `prepare`: writes their files and notes what ran; `at` fails."""

    def __init__(self, at: str = "") -> None:
        self.ran: list[str] = []
        self.at = at

    def note(self, name: str) -> None:
        self.ran.append(name)
        if name == self.at:
            raise KeyboardInterrupt

    def film(self, bank: pathlib.Path, folder: pathlib.Path, frames: int | None) -> None:
        assert bank.is_file()
        self.note("film")
        folder.mkdir()
        (folder / "recording.json").touch()

    def seen(self, film: pathlib.Path, folder: pathlib.Path, kind: str, seed: int) -> None:
        assert (film / "recording.json").is_file()
        self.note(f"seen {kind} {seed}")
        folder.mkdir()

    def generate(self, source: pathlib.Path, out: pathlib.Path, cousins: int, *_: Any) -> dict[str, Any]:
        assert source.exists()
        self.note(f"gen {source.name}")
        out.mkdir(exist_ok=True)
        (out / "bank.npz").write_text(source.name)
        if source.name == "seen-video":
            (out / "recording").mkdir(exist_ok=True)
            record = {"registered": 43, "frames": {"kept": 141}}
            (out / "recording" / "perception.json").write_text(json.dumps(record))
        return {"nodes": 9, "placed": [8] * cousins, "seconds": {"graph": 2.0, "scenes": len(self.ran)}}


def test_a_preparation_continues_where_it_was_stopped(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def stages(at: str = "") -> Stages:
        made = Stages(at)
        for name in ("film", "seen", "generate"):
            monkeypatch.setattr(street_tuning, name, getattr(made, name))
        return made

    args, number = args_of(tmp_path, "prepare", "--film", "video"), int(STREET[:2])
    stopped = stages("gen seen-video")
    with pytest.raises(KeyboardInterrupt):
        street_tuning.prepare(STREET, args)
    assert stopped.ran == ["gen graph.json", "film", f"seen video {number}", "gen seen-video"]
    folder = tmp_path / "prepared" / STREET
    assert not (folder / "prepared.json").exists()
    # `gen` skips stages that are done by itself.
    again = stages()
    body = street_tuning.prepare(STREET, args)
    assert again.ran == ["gen graph.json", "gen seen-video"]
    assert body["with_pose"] == "43 of 141"
    assert set(body["seconds"]) == {"own", "film", "spoiling", "gen"}
    assert (body["seconds"]["own"], body["seconds"]["gen"]) == (3.0, 4.0)
    assert (folder / "own" / "bank.npz").read_text() == "graph.json"
    assert (folder / "film" / "bank.npz").read_text() == "seen-video"
    assert street_tuning.prepare(STREET, args) == body
    assert len(again.ran) == 2
    with pytest.raises(street_tuning.ValidationError, match="take another folder"):
        street_tuning.prepare(STREET, args_of(tmp_path, "prepare"))


def test_a_street_that_is_not_prepared_is_named(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert street_tuning.main(["tune", "--out", str(tmp_path), "--streets", STREET]) == 2
    assert f"prepare --out {tmp_path} --streets {STREET}" in capsys.readouterr().err
    assert street_tuning.main(["tune", "--out", str(tmp_path), "--streets", "t99"]) == 2
    assert "--streets: found 't99'" in capsys.readouterr().err


@pytest.fixture
def prepared(small_bank: SceneBank, tmp_path: pathlib.Path) -> pathlib.Path:
    folder = tmp_path / "out" / "prepared" / STREET
    for name in ("own", "film"):
        (folder / name).mkdir(parents=True)
        small_bank.save(folder / name / "bank.npz")
    seconds = {"own": 1000.0, "film": 500.0, "spoiling": 7.0, "gen": 60.0}
    body = {"street": STREET, "film": "video", "cousins": 5, "seconds": seconds}
    (folder / "prepared.json").write_text(json.dumps(body))
    return tmp_path / "out"


def test_scores_of_other_options_are_not_taken(prepared: pathlib.Path) -> None:
    out, words = prepared / "tuned" / STREET, ("tune", "--seeds", "5", "--episodes", "3")
    arms = [{"arm": "before", "seed": None}, {"arm": "film", "seed": 5}, {"arm": "own", "seed": 5}]
    out.mkdir(parents=True)
    (out / "result.json").write_text(json.dumps({"street": STREET, "arms": arms}))
    assert street_tuning.tune_street(STREET, args_of(prepared, *words))["arms"] == arms
    for other in (("--policy", "another"), ("--episodes", "4"), ("--steps", "32")):
        with pytest.raises(street_tuning.ValidationError, match="take another folder"):
            street_tuning.tune_street(STREET, args_of(prepared, *words, *other))


@pytest.mark.slow
def test_a_training_that_was_stopped_goes_on_and_is_scored_on_the_street(
    small_bank: SceneBank, prepared: pathlib.Path, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    env, config = seeing_env(small_bank), small_config()
    student = initial_student(make_student(config, env.action_size), env.observation_size, 3)
    policy = save_student(tmp_path / "student", student, PolicySpec.of("CocoNav", env, config, 1000))
    monkeypatch.setattr(street_tuning, "environment", lambda bank, args: seeing_env(bank))
    monkeypatch.setattr(street_tuning, "scored", lambda bank, count: np.arange(count, dtype=np.int32))
    monkeypatch.setattr("urbanverse_mjx.training.config.default_ppo_config", lambda preset: small_config())
    driven: list[str] = []
    drive = street_tuning.drive

    def noted(env: Any, policy: pathlib.Path, scenes: np.ndarray, rows: np.ndarray) -> list[Any]:
        driven.append(policy.parent.parent.name)
        assert not scenes.any(), "the street that was filmed is the first of its bank"
        return drive(env, policy, scenes, rows)

    monkeypatch.setattr(street_tuning, "drive", noted)
    words = ("tune", "--policy", str(policy), "--seeds", "5", "--episodes", "3", "--steps", "32", "--num-envs", "4")
    with killed_at(1, snapshot, "save_state"):
        street_tuning.tune_street(STREET, args_of(prepared, *words))
    result = street_tuning.tune_street(STREET, args_of(prepared, *words))
    assert driven == [policy.parent.parent.name, "film-5", "own-5"], "the policy before was not driven again"
    assert [(arm["arm"], arm["seed"], arm["env_steps"]) for arm in result["arms"]] == [
        ("before", None, 0),
        ("film", 5, 32),
        ("own", 5, 32),
    ]
    assert all(len(arm["ends"]) == 3 and set(arm["ends"]) <= set("ghot") for arm in result["arms"])
    _, film, own = result["arms"]
    # A time that was measured in parts says nothing.
    assert street_tuning.minutes(film, result["prepared"]) is None
    assert street_tuning.minutes(own, result["prepared"]) == pytest.approx(
        (60.0 + own["seconds_train"]) / 60.0, abs=0.051
    )
    with pytest.raises(street_tuning.ValidationError, match="other options"):
        street_tuning.train(STREET, "film", 5, env, args_of(prepared, *words, "--set", "finetune.noise=0.5"))


def test_rows_become_the_table(tmp_path: pathlib.Path) -> None:
    (tmp_path / "street_tuning.csv").write_text(HEAD + "\n")
    empty = street_tuning.page_text(tmp_path)
    assert empty.startswith(f"Not run yet: `{STREET}`")
    prepared = {"film": "video", "seconds": {"own": 1000.0, "film": 500.0, "gen": 120.0}}
    arms = [
        {"arm": "before", "seed": None, "env_steps": 0, "seconds_train": 0.0, "ends": "hhhg"},
        {"arm": "film", "seed": 0, "env_steps": 9, "seconds_train": 240.0, "ends": "gghg"},
        {"arm": "own", "seed": 0, "env_steps": 9, "seconds_train": 60.0, "ends": "gggg"},
        {"arm": "film", "seed": 1, "env_steps": 9, "seconds_train": None, "ends": "gtho"},
        {"arm": "own", "seed": 1, "env_steps": 9, "seconds_train": 60.0, "ends": "gggg"},
    ]
    for street in (STREET, "t99"):
        folder = tmp_path / "tuned" / street
        folder.mkdir(parents=True)
        (folder / "result.json").write_text(json.dumps({"street": street, "prepared": prepared, "arms": arms}))
    for result in 2 * sorted(tmp_path.glob("tuned/*/result.json")):  # replaces its own rows
        assert street_tuning.add(result, tmp_path) == 5
    rows = street_tuning.read(tmp_path)
    assert {street: len(found) for street, found in rows.items()} == {STREET: 5, "t99": 5}
    text = street_tuning.page_text(tmp_path)
    row = next(line for line in text.splitlines() if line.startswith(f"| {STREET}"))
    cells = [cell.split(" ")[0] for cell in row.strip("| ").split(" | ")]
    # Of four routes one, then three and one, then all; six minutes from the film where it was measured whole.
    assert cells == [STREET, "video", "4", "2", "25.0", "50.0", "100.0", "25.0", "50.0", "50.0", "6"]
    assert "| 50.0 (3) | 50.0 (1) |" in row
    assert STREET not in text.split("Not run yet")[1]
    assert (
        results.with_table("{}\nold\n{}".format(*street_tuning.MARKS), text, street_tuning.MARKS).count("| t99 |") == 1
    )


def test_every_end_of_an_episode_has_a_letter() -> None:
    from urbanverse_mjx.datatypes.evaluation import RESULTS

    assert set(RESULTS) <= set(street_tuning.LETTERS)
    assert len(set(street_tuning.LETTERS.values())) == len(street_tuning.LETTERS)
