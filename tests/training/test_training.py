"""Brax PPO end to end on a kinematic engine: it learns, it resumes, its policies load as they were trained."""

import json
import os
import pathlib
import shutil

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.support.unicycle import unicycle_env
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs.registry import with_overrides
from urbanverse_mjx.evaluation import Rollout, fixed_episodes
from urbanverse_mjx.training import brax_compat, run
from urbanverse_mjx.training.config import batch_shape, default_ppo_config, steps_trained
from urbanverse_mjx.training.policy import (
    export_actor,
    initial_params,
    latest_policy,
    load_params,
    load_policy,
    make_policy_function,
)
from urbanverse_mjx.training.progress import TrainingLog
from urbanverse_mjx.training.run import train

POLICIES = pathlib.Path(__file__).parents[2] / "benchmarks" / "policies"
CPU_REWARDS = {
    "reward_config.scales.arrived": 10.0,
    "reward_config.scales.position": 0.0,
    "reward_config.scales.position_fine": 0.0,
    "reward_config.scales.velocity_cosine": 0.0,
    "reward_config.scales.progress": 1.0,
    "terminate_off_traversable": False,
    "episode_length": 100,
}
SMALL = {"num_envs": 64, "num_timesteps": 4096, "num_checkpoints": 2, "network.layers": ((8, 4, 4), (8, 2, 2))}


def test_shim_gives_pmaps_own_sharding_and_ppo_loads() -> None:
    devices = jax.local_devices()
    tree = {"a": jnp.arange(3.0), "b": jnp.int32(4)}
    placed = brax_compat.device_put_replicated(tree, devices)
    assert placed["a"].shape == (len(devices), 3)
    np.testing.assert_array_equal(placed["a"][0], tree["a"])
    through = jax.pmap(lambda t: t, axis_name="i")(placed)  # Brax's axis name
    assert jax.tree.map(lambda x: x.sharding, placed) == jax.tree.map(lambda x: x.sharding, through)
    np.testing.assert_array_equal(brax_compat.own_copy(through)["a"], tree["a"])
    assert callable(brax_compat.load_ppo().train)


def test_batch_shape_divides_or_says_why() -> None:
    assert batch_shape(default_ppo_config("paper")) == (16, 6)
    with pytest.raises(ValidationError, match="num_envs"):
        batch_shape(with_overrides(default_ppo_config(), {"num_envs": 50}))
    with pytest.raises(ValidationError, match="minibatch"):
        batch_shape(with_overrides(default_ppo_config(), {"minibatch": 500}))


@pytest.mark.parametrize(("asked", "trained"), [(1, 16_384), (16_384, 16_384), (20_000, 32_768)])
def test_whole_rollouts_are_trained_before_each_checkpoint(asked: int, trained: int) -> None:
    assert steps_trained(default_ppo_config("cpu"), asked) == trained


def test_papers_table() -> None:
    """The values of the paper's table of hyper-parameters, number by number."""
    c = default_ppo_config("paper")
    assert (c.learning_rate, c.discounting, c.gae_lambda, c.clipping_epsilon) == (1e-4, 0.99, 0.95, 0.2)
    assert (c.desired_kl, c.entropy_cost, c.vf_loss_coefficient, c.max_grad_norm) == (0.01, 0.002, 1.0, 1.0)
    assert (c.unroll_length, c.minibatch, c.num_updates_per_batch) == (32, 512, 5)
    assert (c.num_envs, c.num_timesteps) == (96, 1500 * 32 * 96)


def test_released_codes_table() -> None:
    """Where URBAN-SIM's static_train.yaml differs from the paper (docs/sources/reference_systems.md, b.7)."""
    c = default_ppo_config("urbansim_v0_1")
    assert (c.learning_rate, c.entropy_cost, c.minibatch, c.num_envs) == (1e-3, 0.005, 2048, 256)
    assert c.num_timesteps == 3000 * 32 * 256


def test_shipped_policies_have_the_networks_of_their_preset() -> None:
    """They were trained with `best`, which continues from them with --start-from."""
    config = default_ppo_config("best")
    for name in ("coco_best", "go2_best"):
        record = json.loads((POLICIES / name / "policy.json").read_text())["ppo_config"]
        for field in ("layers", "hidden", "memory"):
            assert json.loads(json.dumps(config.network[field])) == record["network"][field], (name, field)
    preset = json.loads(json.dumps(config.to_dict()))
    record = json.loads((POLICIES / "coco_best" / "policy.json").read_text())["ppo_config"]
    for ours, theirs in ((preset, record), (preset["finetune"], record["finetune"])):
        fields = ours.keys() & theirs.keys() - {"seed", "finetune"}
        assert len(fields) > 15
        assert {f: ours[f] for f in fields} == {f: theirs[f] for f in fields}


@pytest.fixture(scope="module")
def begun(small_bank: SceneBank, tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """Run folder of a finished training, for all tests that continue one."""
    folder = tmp_path_factory.mktemp("begun")
    env = unicycle_env(small_bank, CPU_REWARDS, vision=True)
    assert train("CocoNav", env, with_overrides(default_ppo_config("cpu"), SMALL), folder, quiet=True).steps == 4096
    return folder


def test_trains_stops_resumes_and_loads(begun: pathlib.Path, small_bank: SceneBank, tmp_path: pathlib.Path) -> None:
    env = unicycle_env(small_bank, CPU_REWARDS, vision=True)
    ppo = with_overrides(default_ppo_config("cpu"), SMALL)
    shutil.copytree(begun, tmp_path, dirs_exist_ok=True)
    first = latest_policy(tmp_path)
    assert len(list((tmp_path / "checkpoints").iterdir())) == 2
    with pytest.raises(ValidationError, match="resume"):
        train("CocoNav", env, ppo, tmp_path, quiet=True)

    longer = with_overrides(ppo, {"num_timesteps": 6144, "num_checkpoints": 1})
    second = train("CocoNav", env, longer, tmp_path, resume=True, quiet=True)
    assert second.steps == 6144
    assert latest_policy(tmp_path) == second.policy != first
    steps = [json.loads(line)["step"] for line in (tmp_path / "log.jsonl").read_text().splitlines()]
    assert max(steps) == 6144
    assert steps[-1] > 4096, "the counter goes on after a resume"

    act, spec = load_policy(tmp_path)
    assert spec.steps == 6144
    assert spec.scene_ids == list(small_bank.scene_ids)
    obs = jax.jit(jax.vmap(env.reset))(jax.random.split(jax.random.key(0), 3)).obs
    assert second.policy is not None
    params = load_params(second.policy)
    direct = make_policy_function(spec.observations, 2, longer, params)
    np.testing.assert_array_equal(act(obs, jax.random.key(0)), direct(obs, jax.random.key(0)))
    one = act(jax.tree.map(lambda x: x[1], obs), jax.random.key(0))
    np.testing.assert_allclose(one, act(obs, jax.random.key(0))[1], atol=1e-5)

    files = [f for f in second.policy.rglob("*") if f.is_file()]
    named = [f for f in files for folder in (tmp_path, begun) if str(folder).encode() in f.read_bytes()]
    assert not named, "a policy names no folder of its machine"
    actor = export_actor(tmp_path, tmp_path / "exported" / "checkpoints" / "actor")
    alone, exported = load_policy(pathlib.Path(os.path.relpath(actor)))
    assert exported == spec
    np.testing.assert_array_equal(alone(obs, jax.random.key(0)), act(obs, jax.random.key(0)))
    with pytest.raises(ValidationError, match="empty folder"):
        export_actor(tmp_path, actor)
    with pytest.raises(ValidationError, match="without its critic"):
        train("CocoNav", env, longer, tmp_path / "exported", resume=True, quiet=True)


@pytest.mark.extended
def test_starts_from_another_policy_with_a_new_critic(
    begun: pathlib.Path, small_bank: SceneBank, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    env = unicycle_env(small_bank, CPU_REWARDS, vision=True)
    ppo = with_overrides(default_ppo_config("cpu"), {**SMALL, "num_timesteps": 1500, "num_checkpoints": 1})
    actor = export_actor(begun, tmp_path / "actor")
    # With a learning rate of 0 the parameters do not change.
    still = with_overrides(ppo, {"learning_rate": 0.0, "learning_rate_schedule": "NONE", "seed": 7})
    totals: list[int] = []
    monkeypatch.setattr(run, "TrainingLog", lambda *given: totals.append(given[1]) or TrainingLog(*given))
    second = train("Go2Nav", env, still, tmp_path / "second", quiet=True, start_from=actor)
    assert second.policy is not None
    assert [second.steps] == totals == [2048], "progress counts to the steps that Brax trains, not to those asked for"
    before, after = (load_params(latest_policy(folder)) for folder in (begun, tmp_path / "second"))
    jax.tree.map(np.testing.assert_array_equal, before[1], after[1])
    critics = zip(jax.tree.leaves(before[2]), jax.tree.leaves(after[2]), strict=True)
    assert any((x != y).any() for x, y in critics), "a critic of its own"

    with pytest.raises(ValidationError, match="one of them"):
        train("Go2Nav", env, still, tmp_path / "second", resume=True, quiet=True, start_from=actor)
    other = with_overrides(still, {"network.layers": ((8, 4, 4), (16, 2, 2))})
    with pytest.raises(ValidationError, match="actor layers of other shapes"):
        train("Go2Nav", env, other, tmp_path / "third", quiet=True, start_from=actor)


@pytest.mark.slow
def test_learns_to_reach_goals(small_bank: SceneBank, tmp_path: pathlib.Path) -> None:
    env = unicycle_env(small_bank, CPU_REWARDS)
    ppo = with_overrides(default_ppo_config("cpu"), {"num_timesteps": 120_000, "num_checkpoints": 1})
    train("CocoNav", env, ppo, tmp_path, quiet=True)
    act, spec = load_policy(tmp_path)
    start = make_policy_function(spec.observations, 2, ppo, initial_params(spec.observations, 2, ppo, 0))
    results, _ = Rollout(env).run({"untrained": start, "trained": act}, fixed_episodes(env, 60))
    success = {name: np.mean([r.success for r in results if r.agent == name]) for name in ("untrained", "trained")}
    assert success["untrained"] < 0.1
    assert success["trained"] > 0.9
