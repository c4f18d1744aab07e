"""Gymnasium's interface: its own checkers, its own vector of single envs as the reference, its autoreset modes."""

import os
import pathlib
from collections.abc import Sequence
from typing import Any

import gymnasium
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode
from gymnasium.wrappers.vector import DictInfoToList, RecordEpisodeStatistics

import urbanverse_mjx.gym
from tests.gym.conftest import LENGTH
from tests.support import playground_page
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs import Result, registry

NUM = 3
STILL, AHEAD = np.zeros((NUM, 2), np.float32), np.tile(np.array([1.0, 0.0], np.float32), (NUM, 1))


@pytest.fixture
def name(unicycle_id: str) -> str:
    return unicycle_id


def vector(name: str, **options: Any) -> Any:
    return gymnasium.make_vec(name, num_envs=NUM, **options)


def reference(name: str, mode: AutoresetMode) -> Any:
    """Gymnasium's own vector around single envs."""
    return gymnasium.make_vec(name, NUM, "sync", vector_kwargs={"autoreset_mode": mode})


def assert_equal(a: Any, b: Any) -> None:
    """The same mappings of arrays that are equal but for how a batch rounds; pixels may differ by one."""
    assert a.keys() == b.keys()
    for key, x in a.items():
        if isinstance(x, dict):
            assert_equal(x, b[key])
            continue
        x, y = np.asarray(x), np.asarray(b[key])
        atol = 1.0 if x.dtype == np.uint8 else 1e-5
        np.testing.assert_allclose(x.astype(np.float64), y.astype(np.float64), atol=atol)


def test_every_registered_environment_has_an_id(name: str) -> None:
    assert {urbanverse_mjx.gym.env_id(n) for n in registry.all_envs()} <= set(gymnasium.registry)
    assert name in gymnasium.registry
    assert "urbanverse/CocoNav-v0" in gymnasium.registry


@pytest.mark.extended
@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_a_vector_is_as_gymnasiums_own_of_single_envs(name: str, mode: AutoresetMode) -> None:
    """Equal until an episode ends and in the report of its end; the next episode is drawn differently."""
    ours, theirs = vector(name, autoreset_mode=mode), reference(name, mode)
    assert ours.metadata["autoreset_mode"] is theirs.metadata["autoreset_mode"] is mode
    assert ours.observation_space == theirs.observation_space
    assert ours.action_space == theirs.action_space
    (obs, info), (their_obs, their_info) = ours.reset(seed=7), theirs.reset(seed=7)
    assert_equal(obs, their_obs)
    assert_equal(info, their_info)
    assert obs in ours.observation_space
    for i in range(1, 8):
        (obs, *ends, info), (their_obs, *their_ends, their_info) = ours.step(AHEAD), theirs.step(AHEAD)
        assert info.keys() == their_info.keys()
        for end, their_end in zip(ends[1:], their_ends[1:], strict=True):
            np.testing.assert_array_equal(end, their_end)
        if i < LENGTH or (i == LENGTH and mode is AutoresetMode.NEXT_STEP):
            assert_equal(obs, their_obs)
            assert_equal(info, their_info)
            np.testing.assert_allclose(ends[0], their_ends[0], rtol=1e-5)
        if i == LENGTH:
            assert ends[2].all()
            assert not ends[1].any()
        if i == LENGTH and mode is AutoresetMode.SAME_STEP:
            for row, their_row in zip(info["final_obs"], their_info["final_obs"], strict=True):
                assert_equal(row, their_row)
            assert_equal(info["final_info"], their_info["final_info"])
            assert (info["final_info"]["result"] == Result.TIMEOUT).all()
        if i == LENGTH + 1 and mode is AutoresetMode.NEXT_STEP:
            np.testing.assert_array_equal(ends[0], 0.0)
        np.testing.assert_array_equal(info["steps"], their_info["steps"])


def test_episodes_end_one_by_one_and_only_they_begin_anew(name: str) -> None:
    """SAME_STEP after one env was begun later than the others."""
    envs = vector(name, autoreset_mode="SameStep")
    envs.reset(seed=0)
    envs.step(AHEAD)
    before = envs.step(AHEAD)[0]
    mask = np.array([False, True, False])
    obs, info = envs.reset(seed=5, options={"reset_mask": mask})
    np.testing.assert_array_equal(info["_steps"], mask)
    for key, x in obs.items():
        np.testing.assert_array_equal(x[~mask], before[key][~mask])
    assert not np.allclose(obs["goal"][1], before["goal"][1])
    envs.step(AHEAD)
    obs, _, _, truncated, info = envs.step(AHEAD)
    np.testing.assert_array_equal(truncated, ~mask)
    np.testing.assert_array_equal(info["_final_obs"], ~mask)
    assert info["final_obs"][1] is None
    np.testing.assert_array_equal(info["steps"], [0, 2, 0])
    assert not np.allclose(info["final_obs"][0]["goal"], obs["goal"][0])


def test_disabled_waits_for_the_mask(name: str) -> None:
    envs = vector(name, autoreset_mode=AutoresetMode.DISABLED)
    with pytest.raises(gymnasium.error.ResetNeeded, match="reset"):
        envs.step(STILL)
    envs.reset(seed=0)
    for _ in range(LENGTH):
        truncated = envs.step(STILL)[3]
    assert truncated.all()
    with pytest.raises(gymnasium.error.ResetNeeded, match=r"\[0, 1, 2\]"):
        envs.step(STILL)
    envs.reset(options={"reset_mask": np.array([True, True, False])})
    with pytest.raises(gymnasium.error.ResetNeeded, match=r"\[2\]"):
        envs.step(STILL)
    envs.reset(options={"reset_mask": np.array([False, False, True])})
    np.testing.assert_array_equal(envs.step(STILL)[4]["steps"], 1)


def test_seeds_reproduce_and_none_draws_on(name: str) -> None:
    def drive(envs: Any, seed: Any) -> list[np.ndarray]:
        goals = [envs.reset(seed=seed)[0]["goal"]]
        goals += [envs.step(AHEAD)[0]["goal"] for _ in range(7)]
        return [*goals, envs.reset()[0]["goal"]]

    one, two = vector(name), vector(name)
    first = drive(one, 11)
    np.testing.assert_array_equal(first, drive(two, 11))
    np.testing.assert_array_equal(first, drive(two, 11))
    assert not np.allclose(first[0], first[-1])
    assert not np.allclose(first[0], one.reset(seed=12)[0]["goal"])
    np.testing.assert_array_equal(first[0][::-1], one.reset(seed=[13, 12, 11])[0]["goal"])


def test_an_episode_that_reaches_its_goal_terminates(name: str) -> None:
    env: Any = gymnasium.make(name)
    env.reset(seed=3)
    carried = env.unwrapped._carried
    env.unwrapped._carried = carried._replace(goal=carried.sim.qpos[:, :3])
    _, reward, *end, info = env.step(np.zeros(2, np.float32))
    assert isinstance(reward, float)
    assert end == [True, False]
    assert (info["result"], info["success"]) == (Result.GOAL, 1.0)


def test_outputs_are_arrays_of_the_library_asked_for(name: str) -> None:
    numpy, jax_ = vector(name), vector(name, output="jax", autoreset_mode=AutoresetMode.SAME_STEP)
    obs, _ = numpy.reset(seed=1)
    obs["goal"][:] = 0.0
    assert numpy.step(AHEAD)[1].dtype == np.float32
    jax_.reset(seed=1)
    *outputs, info = jax_.step(jnp.asarray(AHEAD))
    assert all(isinstance(x, jax.Array) for x in jax.tree.leaves([outputs, info["final_obs"], info["final_info"]]))
    assert not info["_final_obs"].any()
    assert "final_obs" not in vector(name, output="jax", autoreset_mode="SameStep", final_obs=False).reset()[1]


@pytest.mark.torch
def test_torch_shares_the_memory(name: str) -> None:
    import torch  # pyright: ignore[reportMissingImports]

    envs, other = vector(name, output="torch", autoreset_mode="SameStep"), vector(name, autoreset_mode="SameStep")
    obs, _ = envs.reset(seed=2)
    other.reset(seed=2)
    unwrapped: Any = envs.unwrapped
    for key, x in obs.items():
        assert x.data_ptr() == unwrapped._obs[key].unsafe_buffer_pointer()
        assert x.dtype == (torch.uint8 if key == "pixels/front" else torch.float32)
    action = torch.full((NUM, 2), 0.5, requires_grad=True)
    for _ in range(LENGTH):
        obs, reward, terminated, truncated, info = envs.step(action)
        their_obs, their_reward, *_ = other.step(np.full((NUM, 2), 0.5, np.float32))
        assert_equal({k: v.numpy() for k, v in obs.items()}, their_obs)
        np.testing.assert_allclose(reward.numpy(), their_reward, rtol=1e-6)
    assert (terminated.dtype, truncated.all().item()) == (torch.bool, True)
    assert info["final_obs"]["goal"].shape == (NUM, 2)


def test_stock_vector_wrappers_take_it(name: str) -> None:
    envs = DictInfoToList(RecordEpisodeStatistics(vector(name, autoreset_mode=AutoresetMode.SAME_STEP)))
    envs.reset(seed=0)
    rewards = []
    for _ in range(LENGTH):
        _, reward, _, _, info = envs.step(AHEAD)
        rewards.append(reward)
    assert [i["episode"]["l"] for i in info] == [LENGTH] * NUM
    np.testing.assert_allclose([i["episode"]["r"] for i in info], np.sum(rewards, axis=0), rtol=1e-5)
    assert info[0]["final_obs"].keys() == {"goal", "pixels/front"}


def test_equal_arguments_share_what_is_compiled_and_others_do_not(
    name: str, small_bank: SceneBank, tmp_path: pathlib.Path
) -> None:
    path = tmp_path / "bank.npz"
    small_bank.save(path)

    def batch(limit: float) -> Any:
        overrides = {"randomization.friction_scale": (1.0, limit)}
        return vector(name, bank=path, config_overrides=overrides).unwrapped._batch

    first = batch(1.0)
    assert batch(1.0) is first
    assert batch(1.5) is not first
    os.utime(path, ns=(0, 0))
    assert batch(1.0) is not first, "the file may hold other streets now"


def test_what_a_policy_may_not_know_is_given_only_by_name(name: str) -> None:
    assert set(vector(name).single_observation_space.spaces) == {"goal", "pixels/front"}
    chosen = vector(name, observations=["state", "privileged"])
    assert chosen.reset(seed=0)[0]["privileged"].shape == (NUM, 43)
    assert list(chosen.single_observation_space.spaces) == ["privileged", "state"]


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"output": "tensorflow"}, "numpy, torch, jax"),
        ({"autoreset_mode": "later"}, "NextStep, SameStep, Disabled"),
        ({"observations": ["depth"]}, "goal, pixels/front"),
        ({"render_mode": "human"}, "rgb_array"),
        ({"preset": "none"}, "preset"),
    ],
)
def test_wrong_options_are_named_in_a_sentence(name: str, options: dict[str, Any], match: str) -> None:
    with pytest.raises(ValidationError, match=match):
        vector(name, **options)


def test_gymnasiums_checker_passes(name: str) -> None:
    check_env(gymnasium.make(name).unwrapped, skip_render_check=True)  # `check_images` renders


@pytest.mark.extended
def test_the_pages_blocks_are_run(
    small_bank: SceneBank, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The one about Gymnasium here, and every other by the test that is named for it."""
    found = [[marker for marker in playground_page.MARKERS if marker in block] for block in playground_page.blocks()]
    assert found == [[marker] for marker in playground_page.MARKERS]
    for marker, test in playground_page.MARKERS.items():
        assert repr(marker.strip()).strip("'") in (pathlib.Path(__file__).parents[1] / test).read_text(encoding="utf-8")
    small_bank.save(tmp_path / "bank.npz")
    monkeypatch.setenv("URBANVERSE_BANK", str(tmp_path / "bank.npz"))
    space = playground_page.run_block("import urbanverse_mjx.gym\n")
    envs = space["envs"]
    assert space["obs"] in envs.observation_space
    assert (space["info"]["steps"] == 3).all()
    check_images(envs, gymnasium.make("urbanverse/CocoNav-v0", **space["options"]), space["images"])


def check_images(envs: Any, env: Any, last: Sequence[np.ndarray]) -> None:
    """A vector's images are those of its envs, and show what happens in each."""
    assert [(x.shape, x.dtype) for x in last] == [((240, 320, 3), np.uint8)] * 4
    assert env.unwrapped.render() is None
    env.reset(seed=0)
    envs.reset(seed=0)
    images = envs.render()
    np.testing.assert_array_equal(images[0], env.render())
    for other in (images[1], last[0]):
        assert np.abs(images[0].astype(np.float32) - other).mean() > 1.0
    check_env(env.unwrapped)
