"""Scores of a suite belong to the conditions with which its benchmarks were frozen."""

import dataclasses
import pathlib
import types
from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest
from ml_collections import ConfigDict

from tests.support.box_bank import box_bank
from tests.support.unicycle import unicycle_env
from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.datatypes.validation import ValidationError
from urbanverse_mjx.evaluation.frozen import freeze
from urbanverse_mjx.evaluation.held_out import Suite
from urbanverse_mjx.evaluation.rollouts import EpisodeSet


def _env(**config: str) -> types.SimpleNamespace:
    return types.SimpleNamespace(config=ConfigDict(config))


@pytest.mark.parametrize(
    ("frozen", "config", "fits"),
    [
        ("uniform", {"friction": "uniform"}, True),
        ("uniform", {}, True),  # configs saved before the key existed
        ("uniform", {"friction": "materials"}, False),
        ("materials", {"friction": "materials"}, True),
        ("materials", {}, False),
        (None, {"friction": "materials"}, True),
        (None, {}, True),
    ],
)
def test_scores_on_other_ground_than_the_frozen_one_are_refused(
    frozen: str | None, config: dict[str, str], fits: bool
) -> None:
    suite = Suite(box_bank(1), {}, {}, frozen)
    if fits:
        suite.check(_env(**config))
        return
    with pytest.raises(ValidationError, match=f"needed '{frozen}', with which the benchmarks were frozen"):
        suite.check(_env(**config))
    with pytest.raises(ValidationError, match=f'pass the environment option friction="{frozen}"'):
        suite.score(_env(**config), "agent", None)


def test_a_suite_takes_the_friction_of_its_frozen_lists(
    small_bank: SceneBank, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("URBANVERSE_PROTOCOL_ROOT", str(tmp_path))
    hashes = {name: f"{k}" * 64 for k, name in enumerate(small_bank.scene_ids)}
    bank = dataclasses.replace(small_bank, meta={**small_bank.meta, "hashes": hashes})
    for name, friction in (("before", "uniform"), ("other", "uniform"), ("today", "materials")):
        conditions = {"vision_config.light": "direct", "friction": friction}
        dataclasses.replace(freeze(name, bank, 8, seed=0), conditions=conditions).save(tmp_path / f"{name}.json")
    assert Suite.of(bank, {}, 0, ["before", "other"]).friction == "uniform"
    assert Suite.of(bank, {}, 0, ["today"]).friction == "materials"
    assert Suite.of(bank, {"held": bank.scene_ids[:1]}, 4, []).friction is None
    with pytest.raises(ValidationError, match="friction of before: uniform, today: materials, needed one for all"):
        Suite.of(bank, {}, 0, ["before", "today"])


class Straight:
    """A student that waits for a step, then drives to the goal, or away from it where its parameter is negative."""

    def first_memory(self, count: int) -> Any:
        return jnp.zeros((count, 1))

    def apply(self, params: Any, obs: Any, memory: Any, begins: Any) -> Any:
        towards = obs["goal"] / jnp.linalg.norm(obs["goal"], axis=-1, keepdims=True)
        return params * towards * (memory > 0.0), memory + 1.0, begins


def test_quick_rates_are_those_of_each_set_when_all_steps_are_driven(small_bank: SceneBank) -> None:
    """Routes of 10 to 13 m take up to 31 steps of 0.4 m and the longest, of 24 m, more than the 40 of an episode."""
    env = unicycle_env(small_bank, {"terminate_off_traversable": False, "episode_length": 40})
    order = np.argsort(small_bank.episode_length[0, :12])
    near, mixed = order[:3].astype(np.int32), order[[0, 1, 2, -1]].astype(np.int32)
    sets = {
        "near": EpisodeSet(np.zeros(3, np.int32), near, seeds=np.arange(3)),
        "mixed": EpisodeSet(np.zeros(4, np.int32), mixed, seeds=np.arange(4)),
    }
    rates = Suite(small_bank, {}, sets, None).quick(env, Straight(), ["mixed", "near"], chunk=25)
    assert rates(jnp.float32(1.0)) == {"mixed": 0.75, "near": 1.0}
    assert rates(jnp.float32(-1.0)) == {"mixed": 0.0, "near": 0.0}
