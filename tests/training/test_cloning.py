"""Behaviour cloning: what the readers see, that it learns from images and from memory, and that a cut run is exact."""

import pathlib
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from ml_collections import ConfigDict

from tests.support.cut_runs import killed_at
from tests.training.test_student import LAYERS, seeing_env
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs.navigation.ppo import ppo_config
from urbanverse_mjx.training import imitation, iterative, sequences
from urbanverse_mjx.training.cloning import Cloning, Demonstrations
from urbanverse_mjx.training.imitation import fit
from urbanverse_mjx.training.networks import PIXELS

SIDE = 12


def small_config(**changes: Any) -> ConfigDict:
    config = ConfigDict(ppo_config("quick").to_dict())
    config.update({"num_envs": 16, "unroll_length": 4, "epochs": 1, "minibatches": 1, "learning_rate": 1e-2})
    config.update({"final_learning_rate": 1e-3, "light": 0.0, "pixel_noise": 0.0, **changes})
    config.network.update({"layers": ((4, 4, 4),), "hidden": 16})
    return config


def demonstrations(lengths: tuple[int, ...], seed: int = 0) -> Demonstrations:
    """Episodes whose images are dark or bright, told only at the first step: the brightness of all others is random."""
    draw = np.random.default_rng(seed)
    count, begins = sum(lengths), np.zeros(sum(lengths), bool)
    begins[np.cumsum(lengths) - lengths] = True
    bright = np.repeat(draw.integers(0, 2, len(lengths)), lengths)
    shown = np.where(begins, bright, draw.integers(0, 2, count))
    pixels = np.broadcast_to((40 + 160 * shown)[:, None, None, None], (count, SIDE, SIDE, 3)).astype(np.uint8)
    goal = draw.normal(size=(count, 2)).astype(np.float32)
    proprio = draw.normal(size=(count, 5)).astype(np.float32)
    action = np.stack([bright - 0.5, np.clip(0.5 * goal[:, 1], -0.9, 0.9)], 1).astype(np.float32)
    return Demonstrations({PIXELS: np.array(pixels), "goal": goal, "proprio": proprio}, action, begins)


def trained(data: Demonstrations, config: ConfigDict, iterations: int) -> np.ndarray:
    """Mean absolute errors of the two actions at the end, episodes read from their first step on."""
    learner = Cloning(data, config)
    state = sequences.run(learner, iterations, float("inf"), lambda *_: None, learner.begin())
    obs = {name: jnp.asarray(x)[:, None] for name, x in data.obs.items()}
    begins = jnp.asarray(data.begins)[:, None]
    action = jax.jit(learner.student.apply)(state.params, obs, learner.student.first_memory(1), begins)[0]  # type: ignore[index]
    return np.abs(np.asarray(action[:, 0]) - data.action).mean(0)


def test_readers_that_do_not_divide_into_the_minibatches_are_refused() -> None:
    config = small_config(num_envs=6, minibatches=4)
    with pytest.raises(ValidationError, match=r"num_envs: found 6, needed a multiple .* take --num-envs"):
        Cloning(demonstrations((3, 4)), config)


@pytest.mark.extended
def test_readers_go_on_through_the_episodes_and_every_second_one_sees_a_mirror() -> None:
    data = demonstrations((3, 4))
    data.obs[PIXELS][:, :, 0] += 7  # the left column is brighter
    learner = Cloning(data, small_config())
    block = learner.block(jax.tree.map(jnp.asarray, data), jnp.array([5, 5]))
    np.testing.assert_array_equal(block.begins[:, 0], [False, False, True, False], "steps 5, 6 and 0, 1")
    np.testing.assert_array_equal(block.obs["goal"][:, 0], data.obs["goal"][[5, 6, 0, 1]])
    np.testing.assert_array_equal(block.obs[PIXELS][:, 0], data.obs[PIXELS][[5, 6, 0, 1]])
    np.testing.assert_array_equal(block.action[:, 0], data.action[[5, 6, 0, 1]])
    np.testing.assert_array_equal(block.obs[PIXELS][:, 1], data.obs[PIXELS][[5, 6, 0, 1]][:, :, ::-1])
    np.testing.assert_array_equal(block.action[:, 1], data.action[[5, 6, 0, 1]] * [1, -1])
    np.testing.assert_array_equal(block.obs["goal"][:, 1], data.obs["goal"][[5, 6, 0, 1]] * [1, -1])
    state = learner.begin()
    assert set(np.asarray(state.place)) == {0, 3}, "every reader begins at the first step of an episode"
    after, reported = learner.iterate(learner.begin(), jnp.float32(0.0))
    np.testing.assert_array_equal(after.place, (np.asarray(state.place) + 4) % 7)
    assert set(reported) == {"cloning", "error"}


@pytest.mark.extended
def test_it_learns_from_the_goal_and_what_only_the_first_image_shows_by_memory() -> None:
    data = demonstrations((11,) * 24)  # longer than what is read at once
    with_memory = small_config()
    with_memory.network.memory = 16
    error, blind = trained(data, with_memory, 250), trained(data, small_config(), 250)
    assert error[0] < 0.12, "the memory goes from one iteration to the next"
    assert blind[0] > 0.3, "without memory only every eleventh step says it"
    assert max(error[1], blind[1]) < 0.1


@pytest.mark.extended
def test_a_cut_run_ends_with_the_bytes_of_one_that_was_not(small_bank: SceneBank, tmp_path: pathlib.Path) -> None:
    env = seeing_env(small_bank)
    config = small_config(num_timesteps=256, num_checkpoints=4)
    config.network.update({"layers": LAYERS, "memory": 8})
    data = demonstrations((5, 6, 7))
    assert fit("CocoNav", env, config, tmp_path / "whole", Cloning(data, config), quiet=True).steps == 256
    with killed_at(2, imitation, "save_student"):
        fit("CocoNav", env, config, tmp_path / "cut", Cloning(data, config), quiet=True)
    fit("CocoNav", env, config, tmp_path / "cut", Cloning(data, config), resume=True, quiet=True)
    states = [(tmp_path / name / iterative.STATE).read_bytes() for name in ("whole", "cut")]
    assert states[0] == states[1]
