"""Episodes drawn by p (1 - p): the mean of their ends, their weights, the draw, and a training that counts them."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.support.unicycle import unicycle_env
from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.envs import Result, wrap_for_training
from urbanverse_mjx.envs.navigation.config import default_config
from urbanverse_mjx.envs.navigation.learnability import MIN_WEIGHT, NEW_RESULT_WEIGHT, Learnability, drawn
from urbanverse_mjx.envs.navigation.schedule import EpisodeSchedule
from urbanverse_mjx.envs.wrappers import SUCCESS


@pytest.fixture
def table(small_bank: SceneBank) -> Learnability:
    """Of all scenes but the first."""
    return Learnability(small_bank, np.arange(1, small_bank.num_scenes))


def test_the_mean_follows_the_ends_of_each_episode_alone(table: Learnability) -> None:
    """Against a loop; two envs end the same episode in one step, another one goes on."""
    success = table.first()
    steps = [
        ([1, 1, 2, 1], [0, 0, 3, 1], [Result.GOAL, Result.HIT, Result.GOAL, Result.RUNNING]),
        ([1, 2, 2, 1], [0, 3, 4, 1], [Result.GOAL, Result.TIMEOUT, Result.RUNNING, Result.FALL]),
    ]
    expected = np.full(success.shape, 0.5)
    for scene, row, result in steps:
        success = table.updated(success, jnp.array(scene), jnp.array(row), jnp.array(result))
        for key in set(zip(scene, row, strict=True)):
            ends = [r == Result.GOAL for z, e, r in zip(scene, row, result, strict=True) if (z, e) == key and r != 0]
            if ends:
                expected[key] += NEW_RESULT_WEIGHT * (np.mean(ends) - expected[key])
    np.testing.assert_allclose(success, expected, rtol=1e-6)
    assert (expected != 0.5).sum() == 3


def test_episodes_are_drawn_by_their_weight(table: Learnability, small_bank: SceneBank) -> None:
    rng = np.random.default_rng(0)
    success = rng.uniform(0.0, 1.0, table.first().shape).astype(np.float32)
    success[1, :5] = (0.0, 1.0, 0.5, 0.5, 0.0)
    weights = success * (1 - success) + MIN_WEIGHT
    exists = np.arange(success.shape[1]) < small_bank.num_episodes[:, None]
    exists[0] = False
    weights = np.where(exists, weights, 0.0)
    bounds = table.bounds(jnp.asarray(success))
    n = 200_000
    scene, row = jax.vmap(lambda u: drawn(bounds, success.shape[1], u))((jnp.arange(n) + 0.5) / n)
    counts = np.zeros(success.shape)
    np.add.at(counts, (np.asarray(scene), np.asarray(row)), 1.0)
    np.testing.assert_allclose(counts / n, weights / weights.sum(), atol=2e-5)
    assert counts[~exists].sum() == 0


def test_the_ends_of_the_range_are_episodes(table: Learnability, small_bank: SceneBank) -> None:
    bounds = table.bounds(table.first())
    for share in (0.0, float(np.nextafter(np.float32(1.0), np.float32(0.0))), 1.0):
        scene, row = (int(x) for x in drawn(bounds, table.first().shape[1], jnp.float32(share)))
        assert scene >= 1
        assert row < small_bank.num_episodes[scene]


def test_the_share_is_drawn_so_and_the_rest_as_without(small_bank: SceneBank) -> None:
    config = default_config().schedule
    rows = np.arange(small_bank.num_scenes, dtype=np.int32)
    plain = EpisodeSchedule(config, small_bank, rows)
    config = config.copy_and_resolve_references()
    config.learnable = 0.5
    schedule = EpisodeSchedule(config, small_bank, rows)
    weights = np.zeros((small_bank.num_scenes, small_bank.episode_length.shape[1]))
    weights[1, 2] = 1.0
    bounds = jnp.asarray(np.cumsum(weights), jnp.float32)
    keys, zero = jax.random.split(jax.random.key(0), 4000), jnp.int32(0)
    old = np.stack(jax.vmap(lambda key: plain.draw(key, zero, zero))(keys))
    new = np.stack(jax.vmap(lambda key: schedule.draw(key, zero, zero, bounds))(keys))
    chosen = (new == np.array([[1], [2]])).all(0)
    assert chosen.mean() == pytest.approx(0.5, abs=0.03)
    np.testing.assert_array_equal(new[:, ~chosen], old[:, ~chosen])
    without = np.stack(jax.vmap(lambda key: schedule.draw(key, zero, zero))(keys))
    np.testing.assert_array_equal(without, old)


@pytest.mark.extended
def test_training_counts_the_ends_of_all_envs(small_bank: SceneBank) -> None:
    """Standing robots run out of time: the mean of their episodes falls, and they are drawn less."""
    options = {"episode_length": 3, "terminate_off_traversable": False, "schedule.learnable": 1.0}
    wrapped = wrap_for_training(unicycle_env(small_bank, options), 3)
    state = jax.jit(wrapped.reset)(jax.random.split(jax.random.key(0), 16))
    shape = (small_bank.num_scenes, small_bank.episode_length.shape[1])
    expected = np.full(shape, 0.5)
    step = jax.jit(wrapped.step)
    for number in range(1, 10):
        begun = np.asarray(state.data.sim.scene), np.asarray(state.data.episode)
        state = step(state, jnp.zeros((16, 2)))
        assert state.info[SUCCESS].shape == shape
        if number % 3 == 0:
            np.testing.assert_array_equal(state.info["result"], Result.TIMEOUT)
            for key in set(zip(*(x.tolist() for x in begun), strict=True)):
                expected[key] *= 1.0 - NEW_RESULT_WEIGHT
        np.testing.assert_allclose(state.info[SUCCESS], expected, rtol=1e-5)
    assert (expected < 0.5).sum() >= 32, "rarely the same again"
