"""PPO of one policy on several robots: an iteration against its parts, and a run folder that goes on exactly."""

import dataclasses
import pathlib
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from ml_collections import ConfigDict

from tests.support.unicycle import unicycle_env, unicycle_robot
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs import NavEnv, wrap_for_training
from urbanverse_mjx.robots import load
from urbanverse_mjx.robots.embodiment import FIELDS, describe
from urbanverse_mjx.training import iterative
from urbanverse_mjx.training.policy import PolicySpec, initial_params, latest_policy, load_policy, make_policy_function
from urbanverse_mjx.training.shared_ppo import ENDS, SharedPPO, SharedState, shared_ppo_config, train_shared


def env_of(bank: SceneBank, name: str, **overrides: Any) -> NavEnv:
    """A robot of the catalogue that obeys (v, omega) at once."""
    robot = dataclasses.replace(load(name), command=lambda velocity: velocity)
    given = {"preset": "fast", "vision": False, "episode_length": 12, "observations.robot": True, **overrides}
    return unicycle_env(bank, given, robot=robot)


def config_of(*names: str, told: bool = True, **values: Any) -> ConfigDict:
    config = shared_ppo_config(names, told)
    config.update({"num_envs": 4, "unroll_length": 8, "minibatches": 2, "num_updates_per_batch": 2, **values})
    config.network.hidden = (16, 16)
    return config


@pytest.fixture(scope="module")
def envs(small_bank: SceneBank) -> dict[str, NavEnv]:
    """Two robots with states of other shapes: three wheels, one of them steered twice, and four."""
    found = {name: env_of(small_bank, name) for name in ("hunter", "husky")}
    assert len({env.qpos0.shape for env in found.values()}) == 2
    return found


def learner_of(envs: dict[str, NavEnv], *names: str, **values: Any) -> SharedPPO:
    wrapped = [wrap_for_training(envs[name], 12) for name in names]
    return SharedPPO(wrapped, config_of(*names, **values))


def leaves(tree: Any) -> list[np.ndarray]:
    return [
        np.asarray(jax.random.key_data(x) if jnp.issubdtype(x.dtype, jax.dtypes.prng_key) else x)
        for x in jax.tree.leaves(tree)
    ]


def assert_equal(a: Any, b: Any) -> None:
    for x, y in zip(leaves(a), leaves(b), strict=True):
        np.testing.assert_array_equal(x, y)


@pytest.mark.extended
def test_with_one_environment_an_iteration_is_a_rollout_and_an_update_of_it(envs: dict[str, NavEnv]) -> None:
    """To the bit: what a robot's policy learns alone is what the plain algorithm learns."""
    learner = learner_of(envs, "husky")
    state = learner.begin()
    key, key_learn, key_roll = jax.random.split(state.key, 3)
    env, batch, _ = jax.jit(lambda p, s, k: learner._rollout(learner.envs[0], p, s, k))(
        state.params, state.envs[0], key_roll
    )
    start = state.params, state.optimizer
    (params, optimizer), rate, _ = jax.jit(learner._update)(start, (batch,), state.rate, key_learn)
    expected = SharedState(params, optimizer, rate, (env,), key, state.steps + 1)
    assert_equal(learner.iterate(learner.begin(), jnp.float32(0.0))[0], expected)


@pytest.mark.extended
def test_each_robot_drives_by_the_same_parameters_and_all_of_them_teach(envs: dict[str, NavEnv]) -> None:
    both = learner_of(envs, "hunter", "husky")
    state = both.begin()
    before = jax.device_get(state.params)
    _, key_learn, *keys = jax.random.split(state.key, 4)
    parts = [both._rollout(env, state.params, s, k)[:2] for env, s, k in zip(both.envs, state.envs, keys, strict=True)]
    batches = [batch for _, batch in parts]
    for name, batch in zip(("hunter", "husky"), batches, strict=True):
        assert batch.obs["robot"].shape == (8, 4, len(FIELDS))
        np.testing.assert_allclose(batch.obs["robot"][3, 2], describe(envs[name].robot), rtol=1e-6)
        # Each robot counts as much as the other.
        assert float(batch.advantage.mean()) == pytest.approx(0.0, abs=1e-5)
        assert float(batch.advantage.std()) == pytest.approx(1.0, abs=1e-4)
    start = state.params, state.optimizer
    (params, _), _, _ = both._update(start, tuple(batches), state.rate, key_learn)
    one, *_ = both._update(start, (batches[0], batches[0]), state.rate, key_learn)
    new, reported = both.iterate(state, jnp.float32(0.0))
    for (env, _), found in zip(parts, new.envs, strict=True):
        np.testing.assert_allclose(env.data.sim.qpos, found.data.sim.qpos, atol=1e-4)
    moved = [np.abs(a - b).max() for a, b in zip(leaves(new.params), leaves(before), strict=True)]
    assert max(moved) > 1e-5
    for found, expected in zip(leaves(new.params), leaves(params), strict=True):
        np.testing.assert_allclose(found, expected, atol=1e-4)
    assert max(np.abs(a - b).max() for a, b in zip(leaves(new.params), leaves(one[0]), strict=True)) > 1e-4
    assert {"robots/hunter", "robots/husky", "kl", "rate", "ended"} <= set(reported)


@pytest.mark.extended
def test_the_first_divergence_is_none_and_the_rate_follows_it(envs: dict[str, NavEnv]) -> None:
    for desired, factor in ((1e9, 1.5), (1e-12, 1 / 1.5)):
        learner = learner_of(envs, "husky", desired_kl=desired)
        state, _ = learner.iterate(learner.begin(), jnp.float32(0.0))
        assert float(state.rate) == pytest.approx(3e-4 * factor, rel=1e-3)
    # One update of one minibatch: the policy is still the one that acted.
    learner = learner_of(envs, "husky", minibatches=1, num_updates_per_batch=1)
    _, reported = learner.iterate(learner.begin(), jnp.float32(0.0))
    assert float(reported["kl"]) == pytest.approx(0.0, abs=1e-6)


@pytest.mark.extended
def test_it_learns_to_drive_where_the_reward_is_progress(small_bank: SceneBank) -> None:
    scales = {f"reward_config.scales.{k}": 0.0 for k in ("arrived", "hit", "off_traversable", "near_object")}
    options = {**scales, "terminate_off_traversable": False}
    envs = {name: env_of(small_bank, name, **options) for name in ("hunter", "husky")}
    learner = learner_of(
        envs, "hunter", "husky", num_envs=16, minibatches=4, num_updates_per_batch=4, reward_scaling=1.0
    )
    state, rewards = learner.begin(), []
    for _ in range(25):
        state, reported = learner.iterate(state, jnp.float32(0.0))
        rewards.append(float(reported["reward"]))
    # 0.2 to 0.4 m in a step at full speed.
    assert np.mean(rewards[-3:]) > np.mean(rewards[:3]) + 0.05


@pytest.mark.extended
def test_programs_that_are_compiled_ahead_do_the_same(envs: dict[str, NavEnv]) -> None:
    lazy, ahead = learner_of(envs, "hunter", "husky"), learner_of(envs, "hunter", "husky")
    ahead.compile(2)
    found = [learner.iterate(learner.begin(), jnp.float32(0.0))[0] for learner in (lazy, ahead)]
    assert_equal(found[0].params, found[1].params)


@pytest.mark.extended
def test_a_run_that_was_cut_ends_with_the_bytes_of_one_that_was_not(
    envs: dict[str, NavEnv], tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    config = config_of("hunter", "husky", num_timesteps=3 * 64, num_checkpoints=3)
    both = list(envs.values())
    whole = train_shared("HunterNav", both, config, tmp_path / "whole", quiet=True)
    assert whole.steps == 192
    write = SharedPPO.write

    def killed(self: SharedPPO, *given: Any) -> pathlib.Path:
        if (tmp_path / "cut" / "checkpoints").exists():
            raise KeyboardInterrupt
        return write(self, *given)

    monkeypatch.setattr(SharedPPO, "write", killed)
    with pytest.raises(KeyboardInterrupt):
        train_shared("HunterNav", both, config, tmp_path / "cut", quiet=True)
    monkeypatch.undo()
    assert latest_policy(tmp_path / "cut").name == "000000000064"
    train_shared("HunterNav", both, config, tmp_path / "cut", resume=True, quiet=True, threads=2)
    states = [(tmp_path / name / iterative.STATE).read_bytes() for name in ("whole", "cut")]
    assert states[0] == states[1]
    # The policy says what it is told, and drives a robot that it was not trained with.
    policy, spec = load_policy(tmp_path / "cut")
    assert spec == dataclasses.replace(PolicySpec.load(latest_policy(tmp_path / "whole")))
    assert spec.observations["robot"] == [len(FIELDS)]
    assert spec.ppo_config["network"]["told"]
    assert list(spec.ppo_config["robots"]) == ["hunter", "husky"]
    obs = {"privileged": jnp.ones(43), "robot": jnp.asarray(describe(unicycle_robot()))}
    action = policy(obs, jax.random.key(0))
    assert action.shape == (2,)
    other = policy(obs | {"robot": jnp.asarray(describe(load("kickscooter")))}, jax.random.key(0))
    assert np.abs(np.asarray(action - other)).max() > 1e-6
    turned = config_of("husky", "hunter", num_timesteps=4 * 64, num_checkpoints=3)
    with pytest.raises(ValidationError, match=r"ppo\.robots"):
        train_shared("HunterNav", both, turned, tmp_path / "cut", resume=True, quiet=True)


def test_shares_of_robots_are_of_their_own_episodes(envs: dict[str, NavEnv]) -> None:
    """Rates by hand, also of a robot of which no episode has ended."""
    learner = learner_of(envs, "hunter", "husky")
    rng = np.random.default_rng(0)
    counts = [{name: jnp.float32(rng.integers(0, 40)) for name in (*ENDS, "ended", "reward")} for _ in range(2)]
    counts[0] |= {"ended": jnp.float32(50.0), "success": jnp.float32(20.0)}
    counts[1] |= {"ended": jnp.float32(0.0), "success": jnp.float32(0.0)}
    found = {name: float(x) for name, x in learner._metrics(counts).items()}
    assert found["robots/hunter"] == pytest.approx(20.0 / 50.0)
    assert found["robots/husky"] == 0.0
    for name in ENDS:
        assert found[name] == pytest.approx(float(counts[0][name] + counts[1][name]) / 50.0)
    assert found["ended"] == 50.0
    assert found["reward"] == pytest.approx(float(counts[0]["reward"] + counts[1]["reward"]) / (2 * 4 * 8))
    both = learner._metrics([counts[0], counts[0]])
    assert float(both["robots/hunter"]) == float(both["robots/husky"]) == float(both["success"])


def test_a_training_begins_with_other_draws_for_each_robot_and_seed(
    envs: dict[str, NavEnv], monkeypatch: pytest.MonkeyPatch
) -> None:
    def begun(seed: int) -> tuple[SharedState, list[np.ndarray]]:
        """The first state and the keys from which each robot's envs begin."""
        learner, given = learner_of(envs, "hunter", "husky", seed=seed), []
        monkeypatch.setattr(
            learner, "_reset", lambda k, keys: given.append((k, jax.random.key_data(keys))) or {"env": k}
        )
        state = learner.begin()
        assert [k for k, _ in given] == [0, 1]
        return state, [np.asarray(keys) for _, keys in given]

    state, keys = begun(3)
    assert [env["env"] for env in state.envs] == [0, 1]
    assert (int(state.steps), float(state.rate)) == (0, pytest.approx(float(config_of("husky").learning_rate)))
    rows = [tuple(row) for part in [*keys, *begun(4)[1]] for row in part.reshape(-1, part.shape[-1]).tolist()]
    assert len(rows) == 2 * 2 * 4 == len(set(rows))
    again, same = begun(3)
    np.testing.assert_array_equal(np.concatenate(same), np.concatenate(keys))
    assert_equal(again.params, state.params)
    other = leaves(begun(4)[0].params)
    assert any((a != b).any() for a, b in zip(other, leaves(state.params), strict=True))


def test_who_is_not_told_answers_alike_for_all_robots() -> None:
    sizes = {"privileged": (43,), "robot": (len(FIELDS),)}
    for told in (True, False):
        config = config_of("husky", told=told)
        policy = make_policy_function(sizes, 2, config, initial_params(sizes, 2, config, 0))
        obs = [{"privileged": jnp.ones(43), "robot": jnp.full(len(FIELDS), x)} for x in (0.0, 1.0)]
        difference = np.abs(np.subtract(*(np.asarray(policy(one, jax.random.key(0))) for one in obs))).max()
        assert (difference > 1e-6) == told


def test_what_does_not_fit_is_a_sentence(small_bank: SceneBank, envs: dict[str, NavEnv]) -> None:
    silent = env_of(small_bank, "husky", **{"observations.robot": False})
    with pytest.raises(ValidationError, match="found no observation 'robot', which the network sees"):
        learner_of({"husky": silent}, "husky")
    learner_of({"husky": silent}, "husky", told=False)
    silent._told = jnp.zeros(3)
    with pytest.raises(ValidationError, match=r"envs\[1\].*needed the observations and actions of the first"):
        learner_of(envs | {"other": silent}, "hunter", "other")
    with pytest.raises(ValidationError, match=r"ppo\.minibatches"):
        learner_of(envs, "husky", minibatches=3)
    with pytest.raises(ValidationError, match="envs"):
        learner_of(envs)
