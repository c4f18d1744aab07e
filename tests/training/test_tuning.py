"""The preset `tune`: a trained student goes on by PPO from its own parameters, exactly when cut off."""

import pathlib
import shutil
from typing import Any

import jax
import numpy as np
import pytest
from ml_collections import ConfigDict

from tests.support.cut_runs import killed_at
from tests.training.test_student import LAYERS, seeing_env
from tests.training.test_teacher_student import by_last_bias
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs.navigation.ppo import ppo_config
from urbanverse_mjx.training import snapshot
from urbanverse_mjx.training.dagger import make_student
from urbanverse_mjx.training.policy import PolicySpec, latest_policy, load_policy, load_student, save_student
from urbanverse_mjx.training.record import RunRecord
from urbanverse_mjx.training.run import TrainingResult
from urbanverse_mjx.training.student import Student, initial_student
from urbanverse_mjx.training.tuning import tune


def small_config(**finetune: Any) -> ConfigDict:
    config = ConfigDict(ppo_config("tune").to_dict())
    config.update({"num_envs": 4, "num_timesteps": 4 * 16, "num_checkpoints": 4})
    config.network.update({"layers": LAYERS, "hidden": 16, "memory": 8})
    config.finetune.update({"unroll_length": 4, "epochs": 1, "minibatches": 2, "critic_only": 0})
    config.finetune.update({"map_layers": (), "critic_hidden": (8, 8, 8), "learning_rate": 1e-2, **finetune})
    return config


@pytest.fixture
def student(small_bank: SceneBank, tmp_path: pathlib.Path) -> pathlib.Path:
    """A policy with random parameters."""
    env, config = seeing_env(small_bank), small_config()
    params = initial_student(make_student(config, env.action_size), env.observation_size, 3)
    return save_student(tmp_path / "student", params, PolicySpec.of("CocoNav", env, config, 1000))


def tuned(
    bank: SceneBank, folder: pathlib.Path, start: pathlib.Path | None, resume: bool = False, **finetune: Any
) -> TrainingResult:
    return tune("CocoNav", seeing_env(bank), small_config(**finetune), folder, start, resume, True)


def leaves(policy: pathlib.Path | None) -> np.ndarray:
    assert policy is not None
    return np.concatenate([np.asarray(x).ravel() for x in jax.tree.leaves(load_student(policy))])


@pytest.mark.extended
def test_it_begins_at_the_parameters_of_the_policy(
    small_bank: SceneBank, student: pathlib.Path, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as elsewhere:
        elsewhere.chdir(student.parent)
        changed = tuned(small_bank, tmp_path / "changed", pathlib.Path(student.name), critic_only=2 * 16)
    assert changed.policy is not None
    # While the critic learns alone, for two of the four iterations, the actor stays what it was.
    np.testing.assert_array_equal(leaves(tmp_path / "changed" / "checkpoints" / f"{32:012d}"), leaves(student))
    assert changed.policy == latest_policy(tmp_path / "changed")
    assert changed.steps == PolicySpec.load(changed.policy).steps == 64
    assert 1e-3 < np.abs(leaves(changed.policy) - leaves(student)).max() < 0.5
    assert load_policy(tmp_path / "changed")[0].first_memory().shape == (8,)
    assert RunRecord.load(tmp_path / "changed").segments[0]["start_from"] == str(student)


@pytest.mark.slow
def test_a_run_that_was_cut_off_ends_at_the_same_policy(
    small_bank: SceneBank, student: pathlib.Path, tmp_path: pathlib.Path
) -> None:
    whole = tuned(small_bank, tmp_path / "whole", student)
    with killed_at(2, snapshot, "save_state"):
        tuned(small_bank, tmp_path / "cut", student)
    # The command does not name the policy again, and does not need it.
    shutil.rmtree(student)
    again = tuned(small_bank, tmp_path / "cut", None, resume=True)
    np.testing.assert_array_equal(leaves(again.policy), leaves(whole.policy))


@pytest.mark.slow
def test_the_initial_policy_is_kept_where_none_is_as_good(
    small_bank: SceneBank, student: pathlib.Path, tmp_path: pathlib.Path
) -> None:
    def worse(network: Student) -> Any:
        rate = by_last_bias(network)
        return lambda params: {"validation": -rate(params)["validation"]}

    def run(name: str, validator: Any) -> pathlib.Path | None:
        folder = tmp_path / name
        return tune("CocoNav", seeing_env(small_bank), small_config(), folder, student, validator=validator).policy

    # The initial bias is 0, and training changes it.
    assert run("worse", worse) == student
    better = run("better", by_last_bias)
    assert better is not None
    assert tmp_path / "better" in better.parents


def test_what_it_cannot_do_is_refused(small_bank: SceneBank, student: pathlib.Path, tmp_path: pathlib.Path) -> None:
    with pytest.raises(ValidationError, match="found no --start-from"):
        tuned(small_bank, tmp_path / "run", None)
    with pytest.raises(ValidationError, match=r"finetune\.imitation: found 0\.5, needed 0\.0"):
        tuned(small_bank, tmp_path / "run", student, imitation=0.5)
    other = small_config()
    other.network.hidden = 32
    with pytest.raises(ValidationError, match="--start-from: found layers of other shapes"):
        tune("CocoNav", seeing_env(small_bank), other, tmp_path / "run", student)
    # Its weights for the action before would be those that it began with.
    blind = small_config()
    blind.network.last_action = False
    with pytest.raises(ValidationError, match=r"found network.last_action true .* pass --ppo-overrides '{\"network"):
        tune("CocoNav", seeing_env(small_bank), blind, tmp_path / "run", student)
    assert not (tmp_path / "run").exists()
