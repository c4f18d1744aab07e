"""Wrappers of Brax and of MuJoCo Playground, unchanged, around our environments."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest
from brax.envs.wrappers import training as brax_wrappers
from mujoco_playground import wrapper as playground

from tests.support.playground_page import run_block
from tests.support.unicycle import drive_to_goal, unicycle_env
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs import NavEnv, Result, registry
from urbanverse_mjx.envs.playground import FRICTION, MASS
from urbanverse_mjx.envs.staged import observed_size
from urbanverse_mjx.training.config import brax_ppo_config

LENGTH, NUM = 4, 3


@pytest.fixture(scope="module")
def env(small_bank: SceneBank) -> NavEnv:
    return unicycle_env(small_bank, {"episode_length": LENGTH, "terminate_off_traversable": False}, vision=True)


def full_reset(env: Any, length: int, action_repeat: int = 1) -> Any:
    return playground.wrap_for_brax_training(env, length, action_repeat, full_reset=True)


WRAPS: list[Callable[..., Any]] = [brax_wrappers.wrap, playground.wrap_for_brax_training, full_reset]


@pytest.mark.extended
@pytest.mark.parametrize("wrap", WRAPS, ids=lambda f: f.__name__)
def test_episodes_end_by_time_and_begin_again(env: NavEnv, wrap: Callable[..., Any]) -> None:
    """Nine steps of standing: two episodes end, as truncations; what carries on is the wrapper's own choice."""
    wrapped = wrap(env, LENGTH)
    assert (wrapped.action_size, wrapped.unwrapped, set(wrapped.observation_size)) == (
        2,
        env,
        set(env.observation_size),
    )
    first = jax.jit(wrapped.reset)(jax.random.split(jax.random.PRNGKey(1), NUM))
    still = jnp.zeros((NUM, 2))

    def step(state: Any, _: None) -> tuple[Any, Any]:
        state = wrapped.step(state, still)
        shown = {name: state.info[name] for name in ("steps", "truncation", "result", "scene")}
        return state, (state.done, state.data.steps, state.data.goal, state.obs["pixels/front"], shown)

    # scan requires constant structure, shapes and types, as the stock trainers do.
    last, (done, steps, goal, pixels, shown) = jax.jit(lambda s: jax.lax.scan(step, s, None, 9))(first)
    ends = np.arange(1, 10) % LENGTH == 0
    np.testing.assert_array_equal(done, np.tile(ends[:, None], NUM))
    # A full reset also replaces `info`, so truncation is always 0 in Playground's wrapper.
    np.testing.assert_array_equal(shown["truncation"], 0.0 * done if wrap is full_reset else done)
    np.testing.assert_array_equal(shown["steps"], np.tile(np.arange(9)[:, None] % LENGTH + 1, NUM))
    timed_out = (shown["steps"] == LENGTH) & (wrap is not full_reset)
    np.testing.assert_array_equal(shown["result"] == Result.TIMEOUT, timed_out)
    np.testing.assert_array_equal(steps, np.tile(np.arange(1, 10)[:, None] % LENGTH, NUM))
    sums = last.info["episode_metrics"]
    assert (np.asarray(sums["length"]) == 1).all()
    # After an end Brax and Playground restore the first state, and `full_reset` begins another episode.
    first_goal = np.asarray(first.data.goal)
    same = np.isclose(np.asarray(goal[LENGTH - 1]), first_goal).all(-1)
    assert same.all() if wrap is not full_reset else not same.all()
    np.testing.assert_array_equal(pixels[0], first.obs["pixels/front"])
    if wrap is not full_reset:
        np.testing.assert_array_equal(pixels[LENGTH - 1], first.obs["pixels/front"])


@pytest.mark.extended
def test_the_page_wraps_an_env_and_steps_it(env: NavEnv) -> None:
    state = run_block("wrapped.step", env=env, jax=jax, jnp=jnp)["state"]
    assert state.obs["state"].shape == (4, 7)
    np.testing.assert_array_equal(state.info["steps"], 1)


@pytest.mark.extended
def test_ends_by_the_task_are_no_truncations(small_bank: SceneBank) -> None:
    env = unicycle_env(small_bank, {"episode_length": 200, "terminate_off_traversable": False})
    wrapped: Any = playground.wrap_for_brax_training(env, 200)  # pyright: ignore[reportArgumentType]
    step, state = jax.jit(wrapped.step), jax.jit(wrapped.reset)(jax.random.split(jax.random.PRNGKey(3), 1))
    length, reward = 0, 0.0
    while not length or not float(state.done[0]):
        state = step(state, jax.vmap(drive_to_goal)(state.obs))
        length, reward = length + 1, reward + float(state.reward[0])
    assert int(state.info["result"][0]) == Result.GOAL
    assert float(state.info["truncation"][0]) == 0.0
    sums = state.info["episode_metrics"]
    assert (float(sums["length"][0]), float(sums["success"][0])) == (length, 1.0)
    assert float(sums["sum_reward"][0]) == pytest.approx(reward, rel=1e-5)


@pytest.mark.extended
def test_actions_can_be_repeated_and_metrics_of_an_evaluation_stay(env: NavEnv) -> None:
    """Brax's evaluator puts a metric of its own beside the env's."""
    wrapped = brax_wrappers.EvalWrapper(brax_wrappers.wrap(env, LENGTH, 2))  # pyright: ignore[reportArgumentType]

    def run(keys: jax.Array) -> Any:
        state = wrapped.reset(keys)
        return jax.lax.scan(lambda s, _: (wrapped.step(s, jnp.ones((NUM, 2))), s.data.steps), state, None, 3)

    state, steps = jax.jit(run)(jax.random.split(jax.random.PRNGKey(1), NUM))
    np.testing.assert_array_equal(steps[:, 0], [0, 2, 0])
    found = state.info["eval_metrics"]
    assert (np.asarray(found.active_episodes) == 0).all()
    assert (np.asarray(found.episode_steps) == LENGTH).all()


def test_a_state_is_read_and_changed_by_dotted_names(env: NavEnv) -> None:
    state: Any = jax.jit(env.reset)(jax.random.key(0))
    qpos = state.data.qpos.at[0].add(1.0)
    moved = state.tree_replace({"data.qpos": qpos, "info.scene": jnp.int32(2), "data.steps": jnp.int32(7)})
    np.testing.assert_array_equal(moved.data.sim.qpos, qpos)
    assert (int(moved.info["scene"]), int(moved.data.steps)) == (2, 7)
    assert int(state.data.steps) == 0, "the old state is as it was"
    assert jax.tree.structure(moved) == jax.tree.structure(state)
    assert moved.replace(pipeline_state=state.data).data is state.data
    np.testing.assert_array_equal(state.pipeline_state.xquat, state.data.sim.xquat)


@pytest.mark.extended
def test_a_randomiser_changes_friction_and_mass_of_each_env_and_nothing_else_can_be(small_bank: SceneBank) -> None:
    env = unicycle_env(small_bank, {"randomization.friction_scale": (1.0, 1.0), "randomization.mass_scale": (1.0, 1.0)})
    keys = jax.random.split(jax.random.PRNGKey(0), 8)
    randomize = registry.get_domain_randomizer("CocoNav")

    def draw(model: Any) -> Any:
        return randomize(model, keys)

    for wrap in (brax_wrappers.wrap, playground.wrap_for_brax_training):
        state = jax.jit(wrap(env, LENGTH, randomization_fn=draw).reset)(keys)  # pyright: ignore[reportArgumentType]
        for found, (low, high) in ((state.data.sim.friction_scale, FRICTION), (state.data.sim.mass_scale, MASS)):
            assert len(set(np.asarray(found).tolist())) == 8
            assert low <= float(found.min()) < float(found.max()) <= high
    assert float(jax.jit(env.reset)(keys[0]).data.sim.mass_scale) == 1.0

    def other(model: Any) -> Any:
        axes = jax.tree.map(lambda _: None, model).tree_replace({"dof_damping": 0})
        return model.tree_replace({"dof_damping": jnp.tile(model.dof_damping, (8, 1))}), axes

    wrapped: Any = playground.wrap_for_brax_training(env, LENGTH, randomization_fn=other)  # pyright: ignore[reportArgumentType]
    with pytest.raises(ValidationError, match="dof_damping"):
        jax.eval_shape(wrapped.reset, keys)


def test_the_model_is_there_under_playgrounds_names(env: NavEnv) -> None:
    model = mujoco.MjModel.from_xml_path(env.xml_path, env.model_assets)
    assert (model.nq, model.nu, model.nbody) == (env.mj_model.nq, env.mj_model.nu, env.mj_model.nbody)
    np.testing.assert_allclose(env.mjx_model.body_mass, model.body_mass, rtol=1e-6)
    state = jax.jit(env.reset)(jax.random.key(0))
    np.testing.assert_array_equal(state.obs["state"][:2], state.obs["goal"])
    assert state.obs["state"].shape == (2 + 3 + env.action_size,)
    np.testing.assert_array_equal(state.obs["privileged_state"], state.obs["privileged"])
    assert set(env.observation_size) - set(observed_size(env)) == {"state", "privileged_state"}


@pytest.mark.extended
def test_brax_trains_under_playgrounds_wrapper(small_bank: SceneBank) -> None:
    """2,048 steps by the call of Playground's training script, as docs/playground.md gives it, with a small camera."""
    params = brax_ppo_config("CocoNav", "cpu")
    assert params.batch_size * params.num_minibatches == params.num_envs
    env = unicycle_env(small_bank, {"episode_length": 16, "terminate_off_traversable": False}, vision=True)
    found = run_block("load_ppo()", env=env)
    metrics, trained = found["metrics"], found["parameters"]
    assert 0.0 < float(metrics["eval/avg_episode_length"]) <= 16
    assert np.isfinite(float(metrics["training/total_loss"]))
    assert not np.allclose(trained[0].mean["state"], 0.0), "its statistics have seen observations"
    assert int(trained[0].count) >= 2048
    state = jax.jit(env.reset)(jax.random.key(0))
    action, _ = found["make_policy"](trained, deterministic=True)(state.obs, jax.random.key(1))
    assert action.shape == (2,)
