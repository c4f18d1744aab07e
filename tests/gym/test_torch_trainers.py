"""Trainers of PyTorch on our envs."""

import pathlib
from typing import Any

import gymnasium
import numpy as np
import pytest
from mujoco_playground import wrapper_torch

import urbanverse_mjx.gym
from tests.gym.conftest import LENGTH
from tests.support.playground_page import run_block
from tests.support.unicycle import unicycle_env
from urbanverse_mjx.datatypes import SceneBank, ValidationError

TORCH: dict[str, Any] = {"output": "torch", "autoreset_mode": "SameStep"}


@pytest.fixture
def default_bank(small_bank: Any, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The streets of the environments that the page loads."""
    small_bank.save(tmp_path / "bank.npz")
    monkeypatch.setenv("URBANVERSE_BANK", str(tmp_path / "bank.npz"))


@pytest.mark.torch("rsl_rl")
@pytest.mark.usefixtures("default_bank")
def test_the_pages_rsl_rl_example_trains() -> None:
    space = run_block("OnPolicyRunner(", gymnasium=gymnasium)
    runner, vec_env = space["runner"], space["vec_env"]
    assert runner.current_learning_iteration == 3
    seen = runner.alg.actor.obs_normalizer.count
    assert int(seen) >= 4 * 32 * 32
    assert np.isfinite(space["policy"](vec_env.get_observations()).detach().numpy()).all()
    assert vec_env.cfg["preset"] == "cpu"


@pytest.mark.torch("stable_baselines3")
@pytest.mark.usefixtures("default_bank")
def test_the_pages_stable_baselines_example_trains() -> None:
    model = run_block("stable_baselines3", gymnasium=gymnasium)["model"]
    assert model.num_timesteps == 512
    assert len(model.ep_info_buffer) == 0 or model.ep_info_buffer[0]["l"] > 0


@pytest.mark.torch("rsl_rl")
def test_rsl_rl_learns_and_is_told_of_ends(unicycle_id: str, tmp_path: pathlib.Path) -> None:
    """A robot without inertia, rewarded for driving towards the goal: in 2,560 steps it closes half of the gap to 40,
    the largest return of an episode."""
    import torch  # pyright: ignore[reportMissingImports]
    from rsl_rl.runners import OnPolicyRunner  # pyright: ignore[reportMissingImports]

    from urbanverse_mjx.gym.rsl_rl import RslRlVecEnv

    torch.manual_seed(0)
    envs = gymnasium.make_vec(unicycle_id, 16, observations=["state", "pixels/front"], **TORCH)
    vec_env = RslRlVecEnv(envs)
    first = vec_env.get_observations()
    assert (tuple(first["state"].shape), tuple(first["pixels/front"].shape)) == ((16, 7), (16, 3, 12, 16))
    assert 0.0 <= float(first["pixels/front"].min()) <= float(first["pixels/front"].max()) <= 1.0
    assert first is vec_env.get_observations(), "asking again begins no episodes"
    for i in range(1, 5):
        obs, reward, ended, extras = vec_env.step(torch.zeros(16, 2))
        assert bool(ended.all()) is (i == 4)
        assert bool(extras["time_outs"].all()) is (i == 4)
        np.testing.assert_array_equal(vec_env.episode_length_buf, i % 4)
    assert float(extras["log"]["/success"]) == 0.0
    assert (reward.shape, obs.batch_size) == ((16,), (16,))
    with pytest.raises(ValidationError, match="init_at_random_ep_len"):
        vec_env.episode_length_buf = torch.zeros(16)

    network = {"class_name": "MLPModel", "hidden_dims": [32]}
    config = {
        "num_steps_per_env": 16,
        "save_interval": 100,
        "obs_groups": {"actor": ["state"], "critic": ["state"]},
        "actor": {**network, "distribution_cfg": {"class_name": "GaussianDistribution", "init_std": 1.0}},
        "critic": network,
        "algorithm": {"class_name": "PPO", "learning_rate": 3e-3, "schedule": "fixed", "entropy_coef": 0.0},
    }
    runner = OnPolicyRunner(vec_env, config, log_dir=str(tmp_path))
    runner.learn(1)
    before = float(np.mean(runner.logger.rewbuffer))
    runner.learn(9)
    after = float(np.mean(runner.logger.rewbuffer))
    assert 40.0 - after < 0.5 * (40.0 - before)


@pytest.mark.torch("rsl_rl")
@pytest.mark.parametrize(
    ("options", "match"), [({"output": "numpy"}, 'output="torch"'), ({"autoreset_mode": "NextStep"}, '"SameStep"')]
)
def test_rsl_rl_needs_tensors_and_episodes_that_begin_at_once(
    unicycle_id: str, options: dict[str, Any], match: str
) -> None:
    from urbanverse_mjx.gym.rsl_rl import RslRlVecEnv

    with pytest.raises(ValidationError, match=match):
        RslRlVecEnv(gymnasium.make_vec(unicycle_id, 2, **(TORCH | options)))


@pytest.mark.torch("tensordict")
def test_playgrounds_own_wrapper_for_rsl_rl_runs_unchanged(small_bank: SceneBank) -> None:
    import torch  # pyright: ignore[reportMissingImports]

    env = unicycle_env(small_bank, {"episode_length": LENGTH})
    wrapped = wrapper_torch.RSLRLBraxWrapper(env, 3, seed=0, episode_length=LENGTH, action_repeat=1)
    assert tuple(wrapped.reset()["privileged_state"].shape) == (3, 43)
    for i in range(1, LENGTH + 2):
        obs, reward, ended, extras = wrapped.step(torch.zeros(3, 2))
        assert bool(ended.all()) is bool(extras["time_outs"].all()) is (i == LENGTH)
    assert (tuple(obs["state"].shape), tuple(reward.shape)) == ((3, 7), (3,))


def test_without_gymnasium_the_error_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    import importlib
    import sys

    monkeypatch.setitem(sys.modules, "gymnasium", None)
    with pytest.raises(ImportError, match=r"urbanverse_mjx\[gymnasium\]"):
        importlib.reload(urbanverse_mjx.gym)
