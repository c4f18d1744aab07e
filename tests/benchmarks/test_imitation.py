"""Demonstrations of equal number, rows of equal samples, and a row from the recording to its scores."""

import argparse
import json
import pathlib
from typing import Any

import jax
import numpy as np
import pyarrow.parquet as pq
import pytest
from ml_collections import ConfigDict

from benchmarks import imitation
from benchmarks.lib.unseen import Log, Streets, load
from tests.support.box_machine import box_env
from tests.support.cut_runs import killed_at
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs.navigation.ppo import ppo_config
from urbanverse_mjx.evaluation import BASELINES
from urbanverse_mjx.evaluation.held_out import Suite
from urbanverse_mjx.pipeline import machines
from urbanverse_mjx.training import snapshot
from urbanverse_mjx.training.policy import PolicySpec, latest_policy, load_student
from urbanverse_mjx.viewer.session import Machine, NamedPolicy

EASY = {"terminate_off_traversable": False}


def args_of(out: pathlib.Path, role: str, *words: str) -> argparse.Namespace:
    given = ("--train", "bank.npz", "--out", str(out), "--num-envs", "4", "--readers", "4", "--record-envs", "2")
    return imitation.arguments([role, *given, "--recorded", str(out / "recorded"), *words])


def drive_by(bank: SceneBank, monkeypatch: pytest.MonkeyPatch, **overrides: Any) -> list[str]:
    """The recorder gets a machine that drives straight to its goal; returns the policies that were asked for."""
    env, asked = box_env(bank, "best", {**EASY, **overrides}), list[str]()

    def load(policy: str, *_: Any) -> Machine:
        asked.append(policy)
        return Machine(env, NamedPolicy(policy, BASELINES["go_to_goal"]))

    monkeypatch.setattr(machines, "load_machine", load)
    return asked


@pytest.mark.extended
def test_as_many_episodes_reach_their_goal_as_are_asked_for(
    small_bank: SceneBank, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Within the time of half of them, so that others are driven in place of the rest."""
    offset = small_bank.episode_goal - small_bank.episode_start[..., :3]
    steps = int(np.median(np.linalg.norm(offset[..., :2], axis=-1)) / 0.4)
    asked = drive_by(small_bank, monkeypatch, episode_length=steps)
    streets = Streets(small_bank, list(small_bank.scene_ids), Suite(small_bank, {}, {}))
    env, log = box_env(small_bank, "best"), Log(tmp_path / "log")
    args = args_of(tmp_path, "record", "--demonstrations", "4", "--noise", "0.1")
    found = imitation.record(args, streets, env, log)
    assert found["episodes"] == 4
    assert found["driven"] > 4
    assert set(asked) == {"planner"}
    folder = tmp_path / imitation.DEMONSTRATIONS
    rows = pq.read_table(folder / "data/chunk-000/file-000.parquet").to_pydict()
    assert sum(rows["next.success"]) == sum(rows["next.done"]) == 4
    assert len(rows["action"]) == found["frames"]
    origin = json.loads((folder / "meta/urbanverse.json").read_text())
    assert (origin["policy"], origin["noise"]["deviation"]) == ("planner", 0.1)
    # A command that was killed and is started again asks for no fewer episodes than it had driven.
    assert imitation.record(args, streets, env, log) == found


def test_every_row_of_ppo_has_equally_many_samples(small_bank: SceneBank, tmp_path: pathlib.Path) -> None:
    args = args_of(tmp_path, "ppo", "--samples", "2000", "--set", "unroll_length=8", "noise=0.5")
    alone = imitation.ppo(args, None, 0)
    assert (alone.num_timesteps, alone.finetune.noise, alone.network.last_action) == (1984, 0.5, False)
    assert imitation.ppo(args, None, 500).num_timesteps == 1472 <= 2000 - 500
    with pytest.raises(
        ValidationError, match="--samples: found 2,000, needed more than the 1,990 of the demonstrations"
    ):
        imitation.ppo(args, None, 1990)
    # The network is that of the policy which goes on.
    config = ConfigDict(ppo_config("best").to_dict())
    config.network.update({"hidden": 24, "last_action": True})
    spec = PolicySpec.of("CocoNav", box_env(small_bank, "best"), config, 0)
    (tmp_path / "policy").mkdir()
    spec.save(tmp_path / "policy")
    found = imitation.ppo(args, tmp_path / "policy", 0).network
    assert json.loads(found.to_json()) == json.loads(config.network.to_json())
    cloned = imitation.cloning(args_of(tmp_path, "clone", "--set", "network.hidden=12"))
    assert (cloned.algorithm, cloned.network.hidden, cloned.network.last_action, cloned.num_envs) == (
        "dagger",
        12,
        False,
        4,
    )
    assert "finetune" not in cloned
    assert imitation.cloning(args_of(tmp_path, "clone", "--last-action")).network.last_action


@pytest.mark.slow
def test_a_row_from_the_recording_to_its_scores(
    small_bank: SceneBank, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With a recording by the project's recorder, a cloning that is killed and goes on, and PPO from its policy."""
    drive_by(small_bank, monkeypatch, episode_length=60)
    ids = list(small_bank.scene_ids)
    suite = Suite.of(small_bank, {"validation_composed": ids[2:]}, 2, [])
    monkeypatch.setattr(imitation, "load", lambda *_: Streets(small_bank, ids[:2], suite))
    short = {**EASY, "episode_length": 30}
    monkeypatch.setattr(imitation, "environment", lambda args, streets: box_env(small_bank, "best", short))
    small = ("network.layers=[[4,4,4],[4,2,2]]", "network.hidden=16", "network.memory=8", "unroll_length=4")
    words = (
        "--demonstrations",
        "2",
        "--recorded",
        str(tmp_path / "recorded"),
        "--cloning-steps",
        "64",
        "--set",
        *small,
    )
    words = (*words, "minibatches=2")
    out = {role: tmp_path / role for role in ("clone", "ppo")}
    commands = {role: vars(args_of(out[role], role)) for role in out}
    assert commands["clone"]["readers"] == 4
    given = ["--train", "bank.npz", "--num-envs", "4", "--readers", "4", "--record-envs", "2"]
    recording = ["record", *given, "--out", str(tmp_path / "recorded"), "--demonstrations", "3"]
    assert imitation.main(recording) == 0
    with killed_at(1, snapshot, "save_state"):
        imitation.main(["clone", *given, "--out", str(out["clone"]), *words])
    assert not (out["clone"] / "result.json").exists()
    assert imitation.main(["clone", *given, "--out", str(out["clone"]), *words]) == 0
    result = json.loads((out["clone"] / "result.json").read_text())
    frames = result["demonstrations"]["frames"]
    assert (result["demonstrations"]["episodes"], result["steps"]) == (2, frames)
    every = json.loads((tmp_path / "recorded" / "result.json").read_text())["demonstrations"]
    assert (every["episodes"], frames < every["frames"]) == (3, True)
    for name in ("student", "covered"):
        scores = result[name]["validation_composed"]["by_scene"]
        assert set(scores) == set(ids[2:])
        assert all(0.0 <= x["SR"] <= 100.0 for x in scores.values())
    tiny = ("unroll_length=4", "epochs=1", "minibatches=2", "map_layers=[]", "critic_hidden=[8,8,8]")
    samples = frames + 3 * 16 + 5
    words = ("--start", str(out["clone"]), "--samples", str(samples), "--set", *tiny, "critic_only=1000000")
    assert imitation.main(["ppo", *given, "--out", str(out["ppo"]), *words]) == 0
    tuned = json.loads((out["ppo"] / "result.json").read_text())
    assert tuned["steps"] == frames + 48 <= samples
    # The critic alone learns in so few steps: the actor is still the one that was cloned.
    policies = [load_student(latest_policy(path / imitation.TRAINING / "checkpoints")) for path in out.values()]
    jax.tree.map(np.testing.assert_array_equal, *policies)
    assert PolicySpec.load(latest_policy(out["ppo"] / imitation.TRAINING)).ppo_config["network"]["last_action"] is False
    assert tuned["student"] == result["student"]


def test_of_the_first_scenes_the_last_are_held_out(small_bank: SceneBank, tmp_path: pathlib.Path) -> None:
    path = tmp_path / "boxes" / "bank.npz"
    path.parent.mkdir()
    small_bank.save(path)
    ids, log = list(small_bank.scene_ids), Log(tmp_path / "log")
    some, everything = load([path], [], [1], 2, log, 2), load([path], [], [1], 2, log)
    assert (some.train, set(some.suite.scenes["validation_boxes"])) == (ids[:1], {ids[1]})
    assert list(some.bank.scene_ids) == ids[:2], "other scenes stay in memory"
    assert (everything.train, set(everything.suite.scenes["validation_boxes"])) == (ids[:2], {ids[2]})
