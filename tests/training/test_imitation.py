"""A training by imitation as a run folder: its record, its policy, and that a resumed one is exact."""

import json
import pathlib
import shutil
from typing import Any

import jax
import jax.numpy as jnp
import pytest
from ml_collections import ConfigDict

from tests.support.cut_runs import killed_at
from tests.training.test_student import LAYERS, seeing_env
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs import State
from urbanverse_mjx.envs.navigation.ppo import ppo_config
from urbanverse_mjx.training import imitation, iterative
from urbanverse_mjx.training.imitation import distil
from urbanverse_mjx.training.policy import PolicySpec, latest_policy, load_policy
from urbanverse_mjx.training.record import RunRecord


def small_config() -> ConfigDict:
    config = ConfigDict(ppo_config("quick").to_dict())
    config.update({"num_envs": 4, "unroll_length": 4, "epochs": 1, "minibatches": 2, "num_timesteps": 96})
    config.network.update({"layers": LAYERS, "hidden": 16})
    return config


def teach(parameters: Any, state: State[Any], key: jax.Array) -> jax.Array:
    del parameters, key
    return jnp.clip(state.obs["goal"], -1.0, 1.0)


@pytest.mark.extended
def test_a_run_that_was_cut_ends_with_the_bytes_of_one_that_was_not(
    small_bank: SceneBank,
    tmp_path: pathlib.Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Also where the newest state and an older policy are damaged: it continues from the previous state."""
    env, config = seeing_env(small_bank), small_config()
    whole = distil("CocoNav", env, config, tmp_path / "whole", teach, quiet=True)
    assert whole.steps == 96
    with pytest.raises(ValidationError, match="needed a new folder"):
        distil("CocoNav", env, config, tmp_path / "whole", teach, quiet=True)
    with pytest.raises(ValidationError, match="done already; ask for more"):
        distil("CocoNav", env, config, tmp_path / "whole", teach, resume=True, quiet=True)
    # As if it had been killed between its last state and the policy of it.
    assert whole.policy is not None
    shutil.rmtree(whole.policy)
    completed = distil("CocoNav", env, config, tmp_path / "whole", teach, resume=True, quiet=True)
    assert (completed.policy, completed.steps) == (whole.policy, 96)
    assert PolicySpec.load(latest_policy(tmp_path / "whole")).steps == 96

    with killed_at(2, imitation, "save_student") as saved:
        distil("CocoNav", env, config, tmp_path / "cut", teach, quiet=True)
    newest = PolicySpec.load(latest_policy(tmp_path / "cut")).steps
    state, first = tmp_path / "cut" / iterative.STATE, saved[0]
    done = PolicySpec.load(first).steps
    assert 0 < done < newest < 96
    state.write_bytes(state.read_bytes()[:-1000])
    (first / "policy.json").unlink()
    capsys.readouterr()
    distil("CocoNav", env, config, tmp_path / "cut", teach, resume=True, quiet=True)
    (said,) = [line for line in capsys.readouterr().err.splitlines() if "state.npz" in line]
    assert said.endswith("going on from the state of the checkpoint before it")
    assert PolicySpec.load(latest_policy(first)).steps == done
    states = [(tmp_path / name / iterative.STATE).read_bytes() for name in ("whole", "cut")]
    assert states[0] == states[1]

    record = RunRecord.load(tmp_path / "cut")
    assert [s["from_steps"] for s in record.segments] == [0, done]
    assert record.ppo["algorithm"] == "dagger"
    steps = [json.loads(line)["step"] for line in (tmp_path / "cut" / "log.jsonl").read_text().splitlines()]
    assert steps == [16, 32, 32, 48, 64, 80, 96], "the second iteration was lost, and is done again"
    assert load_policy(tmp_path / "cut")[1].environment == "CocoNav"
