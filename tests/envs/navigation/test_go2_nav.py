"""Nav environments of robots with a gait: COCO's task on legs. Observations and actions are the same, so one policy
runs on all."""

import pathlib

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from ml_collections import ConfigDict

from tests.support.gaits import make_gait
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs import NavEnv, Result, check_env, default_config, registry
from urbanverse_mjx.robots import catalogue, go2_body
from urbanverse_mjx.simulation.gait_engine import GaitEngine

BLIND = {"preset": "cpu", "scenes": "all", "vision": False}
FOR_EVER = {"terminate_on_hit": False, "terminate_off_traversable": False, "success_radius": 1e-3}


@pytest.fixture(scope="module")
def stands(small_bank: SceneBank, tmp_path_factory: pytest.TempPathFactory) -> NavEnv:
    """With a gait that only stands."""
    path = tmp_path_factory.mktemp("gait") / "stands.npz"
    make_gait().save(path)
    return registry.load("Go2Nav", config_overrides={**BLIND, "impl": "warp", "gait": str(path)}, bank=small_bank)


def test_a_policy_cannot_tell_the_robots_apart(stands: NavEnv, small_bank: SceneBank) -> None:
    coco = registry.load("CocoNav", config_overrides=BLIND, bank=small_bank)
    assert stands.observation_size == coco.observation_size
    assert stands.action_size == coco.action_size == 2
    assert stands.zero_metrics() == coco.zero_metrics()
    both, own = (dict(env.config.items()) for env in (stands, coco))
    for name in ("robot", "gait", "menagerie", "sim_dt", "impl"):
        both.pop(name)
    for name in ("robot", "drive", "sim_dt", "impl"):
        own.pop(name)
    assert ConfigDict(both) == ConfigDict(own)
    # The same way towards the same waypoint, as fast as each robot goes.
    for waypoint in ([1.0, 0.0], [0.5, 0.1], [0.0, -1.0], [-0.3, 0.2]):
        fast, slow = (np.array(r.waypoint_to_velocity(jnp.array(waypoint), 0.2)) for r in (coco.robot, stands.robot))
        assert fast[0] == pytest.approx(2.0 * slow[0])
        assert np.sign(fast[1]) == np.sign(slow[1])


@pytest.mark.extended
def test_it_begins_on_its_feet_and_stays_there(stands: NavEnv) -> None:
    reset, step = jax.jit(jax.vmap(stands.reset)), jax.jit(jax.vmap(stands.step))
    state = reset(jax.random.split(jax.random.key(0), 2))
    np.testing.assert_allclose(state.data.sim.qpos[:, 7:], np.tile(go2_body.stand_pose(), (2, 1)), atol=1e-6)
    first = np.asarray(state.data.sim.xpos[:, 1])
    for _ in range(5):
        state = step(state, jnp.tile(jnp.array([1.0, 0.0]), (2, 1)))
    assert [int(r) for r in state.data.result] == [Result.RUNNING] * 2
    moved = np.asarray(state.data.sim.xpos[:, 1]) - first
    assert np.linalg.norm(moved[:, :2], axis=1).max() < 0.1
    assert np.abs(moved[:, 2]).max() < 0.06
    weight = np.asarray(state.data.sim.contacts.foot_force).sum(1)
    np.testing.assert_allclose(weight, 15.206 * 9.81, rtol=0.05)


def test_a_config_of_one_robot_becomes_that_of_the_other() -> None:
    config = default_config("fast")
    changed = registry.with_overrides(config, {"episode_length": 77, "reward_config.scales.hit": -9.0})
    task = registry.same_task(changed, "Go2Nav")
    assert (task.robot, task.sim_dt, task.episode_length) == ("go2", 0.005, 77)
    assert task.reward_config.scales.hit == -9.0
    back = registry.same_task(task, "CocoNav")
    assert ConfigDict(back.to_dict()) == ConfigDict(changed.to_dict())
    with pytest.raises(ValidationError, match="another task"):
        registry.same_task(config, "Go2Joystick")


def test_what_does_not_go_is_said(small_bank: SceneBank, tmp_path: pathlib.Path) -> None:
    with pytest.raises(ValidationError, match="'joint' for a robot with a gait"):
        registry.load("Go2Nav", config_overrides={**BLIND, "action_mode": "joint"}, bank=small_bank)
    with pytest.raises(ValidationError, match="export-gait"):
        registry.load("Go2Nav", config_overrides={**BLIND, "gait": str(tmp_path / "none.npz")}, bank=small_bank)
    with pytest.raises(ValidationError, match="Menagerie: found no"):
        registry.load("Go2Nav", config_overrides={**BLIND, "menagerie": str(tmp_path)}, bank=small_bank)


@pytest.mark.parametrize("name", ["mini_cheetah", "b2", "g1"])
def test_other_robots_have_the_go2s_task_with_their_own_gait(name: str, small_bank: SceneBank) -> None:
    task = catalogue.environment_name(name)
    own, go2 = (registry.get_default_config(x, "cpu").to_dict() for x in (task, "Go2Nav"))
    assert own.pop("robot") == name
    assert {k: x for k, x in go2.items() if k not in ("robot", "menagerie")} == own
    env = registry.load(task, config_overrides={**BLIND, "impl": "warp"}, bank=small_bank)
    assert isinstance(env, NavEnv)
    assert (env.robot.name, env.action_size) == (name, 2)
    engine = env.engine
    assert isinstance(engine, GaitEngine)
    assert engine.gait.meta["robot"] == name
    np.testing.assert_allclose(env.qpos0[7:], engine.gait.stand, atol=1e-6)
    with pytest.raises(ValidationError, match="'dynamic' or clutter for a robot with a gait"):
        registry.load(task, config_overrides={**BLIND, "scenario": "dynamic"}, bank=small_bank)


@pytest.mark.slow
@pytest.mark.parametrize("task", ["Go2Nav", "MiniCheetahNav", "B2Nav", "G1Nav"])
def test_it_keeps_every_promise(task: str, small_bank: SceneBank) -> None:
    """With the shipped gait: to one that only stands the share of the route that is left never changes."""
    env = registry.load(task, config_overrides={**BLIND, "impl": "warp"}, bank=small_bank)
    check_env(env, num_envs=4, num_steps=6)


@pytest.mark.extended
def test_the_shipped_gait_walks_towards_waypoints(small_bank: SceneBank) -> None:
    """4 s straight ahead at full command, then 2 s of a turn on the spot to the left."""
    env = registry.load("Go2Nav", config_overrides={**BLIND, "impl": "warp", **FOR_EVER}, bank=small_bank)
    reset, step = jax.jit(jax.vmap(env.reset)), jax.jit(jax.vmap(env.step))
    state = reset(jax.random.split(jax.random.key(0), 2))

    def walk(waypoint: list[float], steps: int) -> tuple[np.ndarray, np.ndarray]:
        nonlocal state
        for _ in range(steps):
            state = step(state, jnp.tile(jnp.array(waypoint), (2, 1)))
        x = np.asarray(state.data.sim.xquat[:, 1])
        return np.asarray(state.data.sim.xpos[:, 1, :2]), 2 * np.arctan2(x[:, 3], x[:, 0])

    first, yaw = walk([0.0, 0.0], 1)
    there, _ = walk([1.0, 0.0], 20)
    ahead = ((there - first) * np.stack([np.cos(yaw), np.sin(yaw)], 1)).sum(1)
    # 4 m less the distance lost in acceleration and to obstacles.
    assert (ahead > 3.0).all()
    assert (ahead < 4.3).all()
    _, before = walk([0.0, 0.0], 3)
    _, after = walk([0.0, 1.0], 10)
    turned = (after - before + np.pi) % (2 * np.pi) - np.pi
    np.testing.assert_allclose(turned, 2.0, atol=0.4)
