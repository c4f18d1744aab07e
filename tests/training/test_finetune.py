"""PPO of a student: advantages, likelihood ratios, and an iteration that teaches what rewards ask for."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.training.test_student import LAYERS, seeing_env
from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.envs import State, wrap_for_training
from urbanverse_mjx.training import dagger, finetune, sequences
from urbanverse_mjx.training.student_learner import LearnerState


def test_advantages_are_the_sum_of_discounted_differences_up_to_an_end() -> None:
    rng = np.random.default_rng(0)
    reward, value = rng.normal(size=(2, 6, 2))
    last = rng.normal(size=2)
    done = np.zeros((6, 2))
    done[3, 0] = 1.0
    gamma, trace = 0.9, 0.7
    steps = jnp.asarray(reward), jnp.asarray(done), jnp.asarray(value)
    found = finetune.advantages(*steps, jnp.asarray(last), gamma, trace)
    following = np.concatenate([value[1:], last[None]])
    for n in range(2):
        for t in range(6):
            expected, factor = 0.0, 1.0
            for k in range(t, 6):
                going = 1.0 - done[k, n]
                expected += factor * (reward[k, n] + gamma * going * following[k, n] - value[k, n])
                factor *= gamma * trace * going
            assert found[t, n] == pytest.approx(expected, abs=1e-5)


def test_the_ratio_is_that_of_two_normal_densities() -> None:
    rng = np.random.default_rng(1)
    action, new, old = rng.normal(size=(3, 5, 2))

    def log_density(mean: np.ndarray) -> jax.Array:
        return jax.scipy.stats.norm.logpdf(action, mean, 0.3).sum(-1)

    found = finetune.log_ratio(jnp.asarray(action), jnp.asarray(new), jnp.asarray(old), 0.3)
    np.testing.assert_allclose(found, log_density(new) - log_density(old), rtol=1e-4)


@pytest.mark.parametrize(
    ("ratio", "advantage", "gain"),
    [(1.0, 2.0, 2.0), (1.1, 2.0, 2.2), (1.5, 2.0, 2.4), (0.5, 2.0, 1.0), (0.5, -2.0, -1.6), (1.5, -2.0, -3.0)],
)
def test_a_gain_is_clipped_and_a_loss_is_not(ratio: float, advantage: float, gain: float) -> None:
    """By hand, with a clip of 0.2."""
    assert finetune.clipped_gain(jnp.float32(ratio), jnp.float32(advantage), 0.2) == pytest.approx(gain)


def test_the_actor_waits_for_the_critic_and_then_earns_more(small_bank: SceneBank) -> None:
    """From a random student, without the imitation term, with progress towards the goal as the only reward."""
    env = seeing_env(small_bank)
    imitation = dagger.default_dagger_config()
    imitation.network.update({"layers": LAYERS, "hidden": 32, "memory": 8, "bfloat16": False})
    config = finetune.default_finetune_config()
    config.update({"num_envs": 16, "unroll_length": 16, "minibatches": 4, "epochs": 4, "learning_rate": 3e-3})
    config.update({"critic_only": 3 * 256, "imitation": 0.0, "final_imitation": 0.0, "noise": 0.3, "light": 0.0})
    config.update({"map_layers": (), "critic_hidden": (32, 32), "reward_scaling": 1.0})

    def teach(params: None, state: State[Any], key: jax.Array) -> jax.Array:
        del params, key
        return jnp.zeros_like(state.obs["goal"])

    learner = finetune.Finetune(wrap_for_training(env, env.config.episode_length), teach, imitation, config)
    first = dagger.Dagger(wrap_for_training(env, env.config.episode_length), teach, imitation).begin().params
    actors, rewards, values = [], [], []

    def on_iteration(number: int, state: LearnerState, reported: dict[str, float]) -> None:
        actors.append(np.concatenate([np.asarray(x).ravel() for x in jax.tree.leaves(state.params["actor"])]))
        rewards.append(reported["reward"])
        values.append(reported["critic"])

    sequences.run(learner, 40, float("inf"), on_iteration, learner.begin(first))
    before = np.concatenate([np.asarray(x).ravel() for x in jax.tree.leaves(first)])
    np.testing.assert_array_equal(actors[2], before)
    assert np.abs(actors[3] - before).max() > 1e-4
    assert values[2] < values[0]
    assert np.mean(rewards[-5:]) > np.mean(rewards[:5]) + 0.05


def test_a_mirrored_student_drives_as_its_mirror_image(small_bank: SceneBank) -> None:
    """The action that the env gets is the student's, flipped: turns of the mirrored half change their sign."""
    env = seeing_env(small_bank)
    wrapped = wrap_for_training(env, env.config.episode_length)
    given = []

    class Recorded:
        def __init__(self) -> None:
            self.action_size, self.reset = wrapped.action_size, wrapped.reset
            self.learns_episodes = False

        def step(self, state: State, action: jax.Array) -> State:
            jax.debug.callback(lambda a: given.append(np.asarray(a)), action)
            return wrapped.step(state, action)

    imitation = dagger.default_dagger_config()
    imitation.network.update({"layers": LAYERS, "hidden": 16, "memory": 0, "bfloat16": False})
    config = finetune.default_finetune_config()
    config.update({"num_envs": 4, "unroll_length": 2, "minibatches": 1, "epochs": 1, "noise": 1e-6, "light": 0.0})
    config.update({"map_layers": (), "critic_hidden": (8,), "pixel_noise": 0.0})
    learner = finetune.Finetune(
        Recorded(), lambda params, state, key: jnp.zeros_like(state.obs["goal"]), imitation, config
    )
    actor = dagger.Dagger(wrapped, lambda params, state, key: state.obs["goal"], imitation).begin().params
    # A student that always turns left.
    actor = jax.tree.map(jnp.zeros_like, actor)
    actor["params"]["action"]["bias"] = jnp.array([0.1, 0.5])
    learner.iterate(learner.begin(actor), jnp.float32(0.0))
    jax.effects_barrier()
    turns = np.stack(given)[..., 1]
    np.testing.assert_allclose(turns[:, ::2], np.tanh(0.5), atol=1e-4)
    np.testing.assert_allclose(turns[:, 1::2], -np.tanh(0.5), atol=1e-4)
