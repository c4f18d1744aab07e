"""Trainings whose scenes come and go: a run that was cut ends as one that was not, and options that do not fit."""

import dataclasses
import json
import pathlib
import shutil
from collections.abc import Mapping
from typing import Any

import jax
import pytest
from ml_collections import ConfigDict

from tests.support.cut_runs import killed_at
from tests.support.placed import OVERRIDES, placed_env
from tests.training.test_imitation import small_config, teach
from tests.training.test_tuning import small_config as small_tuning
from urbanverse_mjx.datatypes import BankShards, SceneBank, ValidationError
from urbanverse_mjx.envs import registry, wrap_for_training
from urbanverse_mjx.envs.navigation.places import ScenePlaces
from urbanverse_mjx.pipeline.training_run import TrainOptions, train
from urbanverse_mjx.training import imitation, iterative
from urbanverse_mjx.training.dagger import Dagger, make_student
from urbanverse_mjx.training.devices import Devices
from urbanverse_mjx.training.imitation import distil
from urbanverse_mjx.training.policy import PolicySpec, latest_policy, save_student
from urbanverse_mjx.training.record import RunRecord, RunRequest
from urbanverse_mjx.training.student import initial_student


@pytest.fixture(scope="module")
def folder(small_bank: SceneBank, tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    path = tmp_path_factory.mktemp("placed") / "streets.bank"
    small_bank.save(path)
    return path


@pytest.mark.extended
def test_a_run_that_was_cut_has_the_same_scenes_and_ends_with_the_same_bytes(
    folder: pathlib.Path, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Iterations have 16 env-steps, exchanges come every 24: some iterations have none before them."""
    env, config = placed_env(BankShards(folder)), small_config()
    came: list[tuple[int, int]] = []
    stage = ScenePlaces._stage

    def noted(self: Any, number: int, place: int, path: pathlib.Path) -> Any:
        if path.name.startswith("scene-"):
            came.append((number, place))
        return stage(self, number, place, path)

    monkeypatch.setattr(ScenePlaces, "_stage", noted)

    def run(name: str, resume: bool) -> Any:
        with ScenePlaces(env, 24) as places:
            result = distil("CocoNav", env, config, tmp_path / name, teach, resume, quiet=True)
            assert env.places is places
        assert env.places is None
        return result

    whole = run("whole", False)
    assert whole.steps == 96
    exchanged, came[:] = list(came), []
    # The last two are ahead of exchanges that may come.
    assert exchanged[:3] == [(1, 0), (2, 1), (3, 0)]
    spec = PolicySpec.load(latest_policy(tmp_path / "whole"))
    assert sorted(spec.scene_ids) == sorted(env.bank.all_ids)  # type: ignore[attr-defined]
    rows = [json.loads(line) for line in (tmp_path / "whole" / "log.jsonl").read_text().splitlines()]
    assert [row["places/exchanges"] for row in rows] == [0.0, 0.0, 1.0, 2.0, 2.0, 3.0]
    assert all(0.0 <= row["places/stalled"] < 1.0 for row in rows)

    with killed_at(2, imitation, "save_student"):
        run("cut", False)
    done, came[:] = PolicySpec.load(latest_policy(tmp_path / "cut")).steps, []
    assert 0 < done < 96
    run("cut", True)
    first = came[0][0]
    assert first == max(done - 16, 0) // 24 + 1
    assert came[: 4 - first] == exchanged[first - 1 : 3]
    states = [(tmp_path / name / iterative.STATE).read_bytes() for name in ("whole", "cut")]
    assert states[0] == states[1]


@pytest.mark.extended
def test_tuning_validates_on_streets_that_stay(small_bank: SceneBank, tmp_path: pathlib.Path) -> None:
    """By `urbanverse train --preset tune`, whose exchanges are spread over its iterations of 16 env-steps."""
    splits = ["train", "train", "validation"]
    dataclasses.replace(small_bank, meta={**small_bank.meta, "splits": splits}).save(tmp_path / "streets.bank")
    changes = {name: x for name, x in OVERRIDES.items() if name != "preset"} | {"scenes": "train"}
    config = tuning_config()
    env = registry.load("CocoNav", config_overrides={"preset": "tune", **changes}, bank=small_bank)
    params = initial_student(make_student(config, env.action_size), env.observation_size, 3)
    start = save_student(tmp_path / "student", params, PolicySpec.of("CocoNav", env, config, 1000))
    seen = train(
        RunRequest("CocoNav", "tune", {**changes, "schedule.places": 1}, flat(config)),
        TrainOptions(
            logdir=tmp_path / "runs",
            bank=tmp_path / "streets.bank",
            start_from=start,
            num_episodes=0,
            video=False,
        ),
    )
    folder = pathlib.Path(seen["folder"])
    assert RunRecord.load(folder).env["schedule"]["exchange_steps"] == 32
    rows = [json.loads(line) for line in (folder / "log.jsonl").read_text().splitlines()]
    assert rows[-1]["step"] == 64
    assert [row["places/exchanges"] for row in rows] == [0.0, 0.0, 1.0, 1.0]
    assert 0.0 <= rows[-1]["validation/validation"] <= 1.0
    assert (folder / iterative.VALIDATION).is_file()
    policies = list(folder.glob("checkpoints/*/policy.json"))
    for policy in policies:
        assert sorted(PolicySpec.load(policy.parent).scene_ids) == sorted(small_bank.scene_ids[:2])


def tuning_config() -> ConfigDict:
    config = small_tuning()
    config.validation_episodes = 2
    return config


def flat(config: ConfigDict) -> dict[str, Any]:
    """What differs from the preset, by dotted keys."""
    preset = registry.get_ppo_config("CocoNav", "tune")
    keys = config.to_dict()
    own = {name: x for name, x in keys.items() if not isinstance(x, dict)}
    own |= {f"{part}.{name}": x for part in ("network", "finetune") for name, x in keys[part].items()}
    before = {**preset.to_dict(), **{f"{p}.{n}": x for p in ("network", "finetune") for n, x in preset[p].items()}}
    return {name: x for name, x in own.items() if before.get(name) != x}


#: Of `small_config`, three iterations.
SMALL: Mapping[str, Any] = {"num_envs": 4, "unroll_length": 4, "epochs": 1, "minibatches": 2, "num_timesteps": 48}


def request(changes: dict[str, Any]) -> dict[str, Any]:
    return {**{k: x for k, x in OVERRIDES.items() if k != "preset"}, **changes}


@pytest.mark.parametrize(
    ("preset", "changes", "match"),
    [
        ("cpu", {"schedule.places": 1}, "preset 'cpu'"),
        ("best", {"schedule.places": 1}, "preset 'best'"),
        ("quick", {"schedule.places": 3}, "fewer places than scenes"),
        ("quick", {"schedule.places": 2, "schedule.exchange_steps": 1}, "at least 8"),
    ],
)
def test_what_does_not_fit_is_refused(
    folder: pathlib.Path, tmp_path: pathlib.Path, preset: str, changes: dict[str, Any], match: str
) -> None:
    options = TrainOptions(logdir=tmp_path / "runs", bank=folder, num_episodes=0, video=False)
    with pytest.raises(ValidationError, match=match):
        train(RunRequest("CocoNav", preset, request(changes), SMALL if preset == "quick" else {}), options)


def test_a_file_of_a_bank_is_refused(small_bank: SceneBank, tmp_path: pathlib.Path) -> None:
    small_bank.save(tmp_path / "bank.npz")
    options = TrainOptions(logdir=tmp_path, bank=tmp_path / "bank.npz", num_episodes=0, video=False)
    with pytest.raises(ValidationError, match="needed a folder of scenes"):
        train(RunRequest("CocoNav", "quick", request({"schedule.places": 2}), SMALL), options)


def test_several_devices_and_trainings_without_exchanges_are_refused(
    folder: pathlib.Path, tmp_path: pathlib.Path
) -> None:
    env, config = placed_env(BankShards(folder)), small_config()
    with pytest.raises(ValidationError, match="without anything that exchanges them"):
        distil("CocoNav", env, config, tmp_path / "run", teach, quiet=True)
    two = Devices((jax.devices()[0],) * 2)
    with pytest.raises(ValidationError, match="needed one device"):
        Dagger(wrap_for_training(env, env.config.episode_length), teach, config, devices=two)
    assert not (tmp_path / "run").exists()
    shutil.rmtree(tmp_path)
