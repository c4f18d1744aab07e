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


class Recorded:
    """An env that notes the actions that it gets."""

    def __init__(self, env: Any) -> None:
        self._env, self.given = env, list[np.ndarray]()
        self.action_size, self.reset, self.learns_episodes = env.action_size, env.reset, False

    def step(self, state: State, action: jax.Array) -> State:
        jax.debug.callback(lambda a: self.given.append(np.asarray(a)), action)
        return self._env.step(state, action)


@pytest.fixture(scope="module")
def learning(small_bank: SceneBank) -> tuple[Recorded, finetune.Finetune, Any]:
    """An env, its training without the imitation term, with progress towards the goal as the only reward, and the
    parameters of a random student."""
    env = seeing_env(small_bank)
    wrapped = wrap_for_training(env, env.config.episode_length)
    imitation = dagger.default_dagger_config()
    imitation.network.update({"layers": LAYERS, "hidden": 32, "memory": 8, "bfloat16": False})
    config = finetune.default_finetune_config()
    config.update({"num_envs": 16, "unroll_length": 16, "minibatches": 4, "epochs": 4, "learning_rate": 3e-3})
    config.update({"critic_only": 3 * 256, "imitation": 0.0, "final_imitation": 0.0, "noise": 0.3, "light": 0.0})
    config.update({"map_layers": (), "critic_hidden": (32, 32), "reward_scaling": 1.0, "pixel_noise": 0.0})

    def teach(params: None, state: State[Any], key: jax.Array) -> jax.Array:
        del params, key
        return jnp.zeros_like(state.obs["goal"])

    recorded = Recorded(wrapped)
    first = dagger.Dagger(wrapped, teach, imitation).begin().params
    return recorded, finetune.Finetune(recorded, teach, imitation, config), first


@pytest.mark.extended
def test_the_actor_waits_for_the_critic_and_then_earns_more(learning: tuple[Recorded, finetune.Finetune, Any]) -> None:
    _, learner, first = learning
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


def test_a_mirrored_student_drives_as_its_mirror_image(learning: tuple[Recorded, finetune.Finetune, Any]) -> None:
    """The action that the env gets is the student's, flipped: turns of the mirrored half change their sign."""
    recorded, learner, first = learning
    # A student that always turns left.
    actor = jax.tree.map(jnp.zeros_like, first)
    actor["params"]["action"]["bias"] = jnp.array([0.1, 0.5])
    recorded.given.clear()
    learner.iterate(learner.begin(actor), jnp.float32(0.0))
    jax.effects_barrier()
    turns = np.stack(recorded.given)[..., 1]
    assert turns.shape == (16, 16)
    # Noise of 0.3 leaves 0.027 in the means of 128.
    np.testing.assert_allclose(turns[:, ::2].mean(), np.tanh(0.5), atol=0.09)
    np.testing.assert_allclose(turns[:, 1::2].mean(), -np.tanh(0.5), atol=0.09)
    np.testing.assert_allclose(turns.std(), np.hypot(np.tanh(0.5), 0.3), atol=0.06)


def test_gradients_are_clipped_before_adam(learning: tuple[Recorded, finetune.Finetune, Any]) -> None:
    """So that no gradient changes the length of the first step, whose every entry is Adam's 1 or -1."""
    optimizer = learning[1]._optimizer
    params = {"actor": jnp.zeros(50), "critic": jnp.zeros(50)}
    sign = jnp.where(jnp.arange(50) % 3 == 0, -1.0, 1.0)
    for size in (0.01, 100.0):
        found, _ = optimizer.update(dict.fromkeys(params, size * sign), optimizer.init(params), params)
        for part in found.values():
            np.testing.assert_allclose(part, sign, rtol=1e-4)
