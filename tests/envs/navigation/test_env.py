"""The navigation task on a kinematic engine: its arithmetic, its ends, its wrapper."""

import contextlib
import dataclasses
import types
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from ml_collections import ConfigDict

from tests.support.unicycle import drive_to_goal, first_states, one, unicycle_env
from urbanverse_mjx.datatypes import SceneBank, ValidationError, traversable
from urbanverse_mjx.envs import (
    PRESETS,
    NavEnv,
    Result,
    check_env,
    checks,
    default_config,
    joystick_config,
    registry,
    wrap_for_training,
)
from urbanverse_mjx.envs.checks import EnvCheckError
from urbanverse_mjx.envs.navigation.make import make_wheeled_env
from urbanverse_mjx.envs.navigation.ppo import ppo_config
from urbanverse_mjx.envs.types import NavState
from urbanverse_mjx.pipeline.training_run import bank_of
from urbanverse_mjx.scene.terrain import terrain_bank
from urbanverse_mjx.simulation.jax_engine import JaxEngine
from urbanverse_mjx.simulation.rendering.renderer import Renderer
from urbanverse_mjx.training.record import RunRequest, configs_of


@pytest.mark.extended
def test_check_env_accepts_the_task(small_bank: SceneBank) -> None:
    check_env(unicycle_env(small_bank, {"episode_length": 40}, vision=True))


@pytest.mark.parametrize("impl", ["warp", pytest.param("jax", marks=pytest.mark.slow)])
def test_check_env_accepts_the_registered_task(small_bank: SceneBank, impl: str) -> None:
    """The real engine and renderer, as `registry.load` makes them."""
    overrides = {"preset": "cpu", "scenes": "all", "vision_config.height": 12, "vision_config.width": 20, "impl": impl}
    check_env(registry.load("CocoNav", config_overrides=overrides, bank=small_bank), num_envs=4, num_steps=6)


@pytest.mark.extended
def test_joint_actions_are_shares_of_the_control_range(small_bank: SceneBank) -> None:
    """Wheels: full speed straight ahead is 1; the axle of the Ackermann drive: its stops."""
    overrides = {"vision": False, "scenes": "all", "action_mode": "joint", "drive": "ackermann"}
    env = registry.load("CocoNav", config_overrides=overrides, bank=small_bank)
    wheels = np.abs(np.asarray(env.robot.command(jnp.array([env.robot.max_speed, 0.0]))))[:4]
    assert env.action_size == 5
    assert env.observation_size["privileged"] == (46,)
    nav = jax.jit(env.begin)(jax.random.key(3))
    stop = env.mj_model.actuator("steer").ctrlrange
    for action, steer in ((1.0, stop[1]), (-1.0, stop[0]), (0.0, 0.0)):
        ctrl = np.asarray(env._control(nav, jnp.full(5, action)))
        np.testing.assert_allclose(ctrl, [*(action * wheels), steer], atol=1e-6)
    by_velocity = registry.load("CocoNav", config_overrides={**overrides, "action_mode": "velocity"}, bank=small_bank)
    wheels_turn = sent(env, nav, jnp.array([1.0, 1.0, 1.0, 1.0, 0.0]))
    np.testing.assert_array_equal(sent(by_velocity, nav, jnp.array([1.0, 0.0])), wheels_turn)


def test_where_a_robot_may_be_is_what_the_map_says(small_bank: SceneBank) -> None:
    """At random places of every scene, in and around its map, and in its last cells; the table holds a bit a cell."""
    env = unicycle_env(small_bank)
    rng = np.random.default_rng(5)
    size = np.array(small_bank.map_kind.shape[1:])
    cells = np.concatenate([rng.uniform(-0.2, 1.2, (500, 2)) * size, size - 1.0 + rng.uniform(-1.5, 1.5, (100, 2))])
    cells = np.floor(cells) + 0.5  # the middle of each: rounding plays no part
    inside = ((cells >= 0) & (cells < size)).all(1)
    at = np.clip(np.floor(cells).astype(int), 0, size - 1)
    look_up = jax.jit(jax.vmap(env.is_traversable, (None, 0)))
    for scene in range(small_bank.num_scenes):
        ground_truth = inside & traversable(small_bank.map_kind[scene, at[:, 0], at[:, 1]])
        assert 0.05 < ground_truth.mean() < 0.95
        places = small_bank.map_origin[scene] + cells * float(small_bank.map_resolution)
        np.testing.assert_array_equal(look_up(scene, jnp.asarray(places, jnp.float32)), ground_truth)
    constants = jax.make_jaxpr(env.is_traversable)(0, jnp.zeros(2)).consts
    assert sum(c.nbytes for c in constants) < small_bank.map_kind.nbytes / 7


def sent(env: NavEnv, nav: NavState, action: jax.Array) -> jax.Array:
    """The commands of an env to its engine in one step."""

    def advance(nav: NavState) -> jax.Array:
        ctrl = []
        env.engine.step = lambda sim, command, agents: ctrl.append(command) or sim  # type: ignore[method-assign]
        env.advance(nav, action)
        return ctrl.pop()

    return jax.jit(advance)(nav._replace(last_action=jnp.zeros(env.action_size)))


@pytest.mark.extended
def test_check_env_finds_a_constant_observation(small_bank: SceneBank) -> None:
    env = unicycle_env(small_bank)
    whole = env.observe
    env.observe = lambda nav: {**whole(nav), "goal": jnp.ones(2)}  # type: ignore[method-assign]
    with pytest.raises(EnvCheckError, match=r"different first states|constants"):
        check_env(env, num_envs=2, num_steps=3)


@pytest.mark.parametrize(("allowed", "found"), [(2, False), (1, True), (0, True)])
def test_a_number_of_values_may_stay_the_same(allowed: int, found: bool) -> None:
    """Two of five in each of three envs; pixels have a share of their own."""
    steps = np.random.default_rng(0).normal(size=(4, 3, 5))
    steps[..., [1, 3]] = 2.0
    states = [types.SimpleNamespace(obs={"goal": x, "pixels/front": x[:, [0, 1, 2, 4]]}) for x in steps]
    with pytest.raises(EnvCheckError, match="40% constant") if found else contextlib.nullcontext():
        checks._check_no_constant(states, {"goal": allowed})


@pytest.mark.extended
def test_check_env_finds_a_stale_reset(small_bank: SceneBank) -> None:
    env = unicycle_env(small_bank)
    whole = env.begin
    # A begin that always gives the same episode: what Brax's AutoResetWrapper would do.
    env.begin = lambda key: whole(jax.random.key(0))  # type: ignore[method-assign]
    with pytest.raises(EnvCheckError, match="different seeds"):
        check_env(env, num_envs=2, num_steps=3)


def test_driving_straight_on_open_ground_reaches_the_goal_with_the_papers_reward(small_bank: SceneBank) -> None:
    env = unicycle_env(small_bank, {"terminate_off_traversable": False})
    state = jax.jit(env.reset)(jax.random.key(3))
    step = jax.jit(lambda s: env.step(s, drive_to_goal(s.obs)))
    rewards = []
    while not float(state.done):
        before = float(state.data.goal_distance)
        state = step(state)
        rewards.append((before, float(state.data.goal_distance), float(state.reward)))
    assert int(state.info["result"]) == Result.GOAL
    assert float(state.metrics["success"]) == 1.0
    assert float(state.metrics["route_completion"]) == 1.0
    _, last, reward = rewards[-1]
    # On the last step the robot drives at 2 m/s straight at the goal: arrived + both position terms + cosine.
    cosine = float(state.metrics["reward/velocity_cosine"]) / 10
    expected = 2000 + 10 * (1 - np.tanh(last / 5)) + 50 * (1 - np.tanh(last)) + 10 * cosine
    assert reward == pytest.approx(expected, rel=1e-5)
    assert last < 1.0 <= rewards[-1][0]


def test_completion_of_a_route_is_where_the_robot_is_and_no_more_than_it_drove(small_bank: SceneBank) -> None:
    """At the second waypoint, after a detour of 99 m and after 25 cm."""
    env = unicycle_env(small_bank, {"terminate_off_traversable": False})
    nav = jax.jit(env.begin)(jax.random.key(3))
    assert int(nav.num_waypoints) > 2
    corners = np.concatenate([nav.start[None, :2], nav.waypoints[:2, :2]])
    there = float(np.linalg.norm(np.diff(corners, axis=0), axis=1).sum())
    sim = env.engine.init(nav.sim.scene, nav.sim.qpos.at[:2].set(nav.waypoints[1, :2]), nav.sim.qvel)
    advance = jax.jit(env.advance)
    for driven, completed in ((99.0, there), (0.25, 0.25)):
        after, *_ = advance(nav._replace(sim=sim, driven=jnp.float32(driven)), jnp.zeros(2))
        assert float(after.route_done) == pytest.approx(completed, abs=1e-3)


class _Touching:
    """An engine in which the robot touches the agent whose number is its height in whole metres; -1 for a wall."""

    def __init__(self, engine: Any) -> None:
        self._engine = engine

    def step(self, state: Any, ctrl: Any, agents: Any = None) -> Any:
        after = self._engine.step(state, ctrl, agents)
        agent = jnp.round(state.qpos[2]).astype(jnp.int32)
        return after._replace(contacts=after.contacts._replace(hit=jnp.bool_(True), hit_agent=agent))


def test_whoever_is_touched_first_or_last_ends_the_episode(small_bank: SceneBank) -> None:
    env = unicycle_env(small_bank, {"terminate_off_traversable": False})
    nav = one(first_states(env))
    env.engine = _Touching(env.engine)  # type: ignore[assignment]

    def result(height: jax.Array) -> jax.Array:
        before = nav.sim.contacts._replace(hit_agent=jnp.int32(-1))
        sim = nav.sim._replace(qpos=nav.sim.qpos.at[2].set(height), contacts=before)
        return env.advance(nav._replace(sim=sim), jnp.zeros(2))[0].result

    found = jax.jit(jax.vmap(result))(jnp.array([-1.0, 0.0, 1.0, 15.0]))
    assert found.tolist() == [Result.HIT, Result.HIT_AGENT, Result.HIT_AGENT, Result.HIT_AGENT]


def test_hit_ends_the_episode_or_is_only_measured(small_bank: SceneBank) -> None:
    for terminate in (True, False):
        env = unicycle_env(small_bank, {"terminate_on_hit": terminate, "terminate_off_traversable": False}, wall=-1e9)
        state = jax.jit(lambda key, env=env: env.step(env.reset(key), jnp.array([0.0, 0.0])))(jax.random.key(0))
        assert bool(state.done) == terminate
        assert float(state.metrics["hit_time_per_step"]) == 1.0
        assert float(state.metrics["reward/hit"]) == -200.0


@pytest.mark.extended
def test_leaving_the_pavement_ends_the_episode(small_bank: SceneBank) -> None:
    env = unicycle_env(small_bank)
    state = jax.jit(env.reset)(jax.random.key(1))
    qpos = state.data.sim.qpos.at[:2].set(jnp.array([-50.0, 0.0]))
    state = dataclasses.replace(
        state, data=state.data._replace(sim=env.engine.init(state.data.sim.scene, qpos, state.data.sim.qvel))
    )
    state = jax.jit(env.step)(state, jnp.zeros(2))
    assert int(state.info["result"]) == Result.OFF_TRAVERSABLE


def test_non_finite_physics_is_a_result_and_never_reaches_reward_or_neighbours(small_bank: SceneBank) -> None:
    env = unicycle_env(small_bank)
    state = jax.jit(jax.vmap(env.reset))(jax.random.split(jax.random.key(0), 3))
    step = jax.jit(jax.vmap(env.step))
    clean = step(state, jnp.zeros((3, 2)))
    sim = state.data.sim
    broken = sim._replace(qpos=sim.qpos.at[1].set(jnp.nan))
    after = step(dataclasses.replace(state, data=state.data._replace(sim=broken)), jnp.zeros((3, 2)))
    assert int(after.info["result"][1]) == Result.NON_FINITE
    assert np.isfinite(np.asarray(after.reward)).all()
    assert all(np.isfinite(np.asarray(m)).all() for m in after.metrics.values())
    for i in (0, 2):
        assert float(after.reward[i]) == float(clean.reward[i])
    wrapped = wrap_for_training(env, env.config.episode_length)
    first = jax.jit(wrapped.reset)(jax.random.split(jax.random.key(0), 3))
    first = dataclasses.replace(
        first, data=first.data._replace(sim=first.data.sim._replace(qpos=first.data.sim.qpos.at[1].set(jnp.nan)))
    )
    after = jax.jit(wrapped.step)(first, jnp.zeros((3, 2)))
    assert all(np.isfinite(np.asarray(x)).all() for x in after.obs.values())


@pytest.mark.extended
def test_wrapper_sums_and_new_episodes(small_bank: SceneBank) -> None:
    env = unicycle_env(small_bank, {"episode_length": 7, "terminate_off_traversable": False})
    wrapped = wrap_for_training(env, 7)
    state = jax.jit(wrapped.reset)(jax.random.split(jax.random.key(5), 4))
    step = jax.jit(wrapped.step)
    total = np.zeros(4)
    starts = {
        (i, int(s), int(e)) for i, (s, e) in enumerate(zip(state.info["scene"], state.info["episode"], strict=True))
    }
    for i in range(1, 29):
        state = step(state, jnp.ones((4, 2)) * 0.01)
        total += np.asarray(state.reward)
        assert (np.asarray(state.done) == (i % 7 == 0)).all()
        assert (np.asarray(state.info["truncation"]) == (i % 7 == 0)).all()
        if i % 7 == 0:
            np.testing.assert_allclose(state.info["episode_metrics"]["sum_reward"], total, rtol=1e-5)
            assert (np.asarray(state.info["episode_metrics"]["length"]) == 7).all()
            total[:] = 0
            starts |= {
                (j, int(s), int(e))
                for j, (s, e) in enumerate(zip(state.data.sim.scene, state.data.episode, strict=True))
            }
    assert len(starts) > 12, "every episode begins somewhere else"


def test_overrides_and_errors(small_bank: SceneBank) -> None:
    config = registry.with_overrides(default_config(), {"reward_config.scales.hit": -50})
    assert config.reward_config.scales.hit == -50
    assert default_config().reward_config.scales.hit == -200, "defaults are fresh each time"
    with pytest.raises(ValidationError, match="no_such_key"):
        registry.with_overrides(default_config(), {"no_such_key": 1})
    with pytest.raises(ValidationError, match=r"CocoNav.*did you mean 'CocoNav'"):
        registry.load("CocoNva", bank=small_bank)
    with pytest.raises(ValidationError, match=r"preset: found 'faster', needed .*; did you mean 'fast'\?$"):
        default_config("faster")
    with pytest.raises(ValidationError, match="names no scene"):
        unicycle_env(small_bank, {"scenes": "validation"})


@pytest.mark.parametrize(
    ("overrides", "said"),
    [
        (
            {"reward_config.scales.hitt": -1},
            r"'reward_config.scales.hitt': found no 'hitt' in 'reward_config.scales', needed one of arrived, hit, "
            r".*; did you mean 'hit'\?$",
        ),
        (
            {"visoin_config.height": 8},
            r"found no 'visoin_config' in the config, needed .*did you mean 'vision_config'\?$",
        ),
        ({"sim_dt.x": 1}, r"'sim_dt.x': found no keys in 'sim_dt', needed 'sim_dt' itself\.$"),
        ({"sim_dt": "x"}, r"'sim_dt': found 'x', needed a value of the type of 0\.01, which it replaces\.$"),
        ({"reward_config": 3}, r"'reward_config': found 3, needed one of its keys; write reward_config\.\w+\.$"),
    ],
)
def test_a_wrong_override_is_one_plain_sentence(overrides: dict[str, Any], said: str) -> None:
    """Without the quotes, line ends and nested values of the library's errors."""
    with pytest.raises(ValidationError, match=said) as error:
        registry.with_overrides(default_config(), overrides)
    assert not set('\n\\"{') & set(str(error.value))


def test_configs_of_older_policies_mean_what_there_was_before(small_bank: SceneBank) -> None:
    """All presets draw baked light and have the friction of materials, but for the released code's ground; a config
    without these keys does not."""
    assert {p: default_config(p).friction for p in PRESETS} == {
        **dict.fromkeys(PRESETS, "materials"),
        "urbansim_v0_1": "uniform",
    }
    assert {p: default_config(p).vision_config.light for p in PRESETS} == dict.fromkeys(PRESETS, "baked")
    old = default_config("cpu").to_dict()
    del old["vision_config"]["light"], old["friction"], old["randomization"]["wet"]
    assert registry.same_task(ConfigDict(old), "Go2Nav").friction == "uniform"
    config = registry.with_overrides(ConfigDict(old), {"scenes": "all", "impl": "jax"})
    asked = registry.with_overrides(config, {"vision_config.light": "baked", "friction": "materials"})
    assert "light" not in config.vision_config
    for given, light, materials in ((config, "direct", False), (asked, "baked", True)):
        env = registry.load("CocoNav", config=given, bank=small_bank)
        assert isinstance(env.renderer, Renderer)
        assert isinstance(env.engine, JaxEngine)
        assert (env.renderer.settings.light, env.engine.materials) == (light, materials)


@pytest.mark.parametrize("preset", ["cpu", "fast"])
def test_small_and_fast_presets_change_only_image_weights_and_randomization(preset: str) -> None:
    paper, cpu = default_config("paper").to_dict(), default_config(preset).to_dict()
    for config in (paper, cpu):
        for key in ("preset", "vision_config", "randomization"):
            config.pop(key)
        config["reward_config"].pop("scales")
    assert paper == cpu


@pytest.mark.extended
def test_register_from_outside(small_bank: SceneBank) -> None:
    """The trainer and the pipeline use all registered parts."""

    def own_training(preset: str) -> ConfigDict:
        return registry.with_overrides(ppo_config(preset), {"num_envs": 32})

    registry.register_environment(
        "TestOnlyNav", make_wheeled_env, default_config, lambda: small_bank, "cpu", ("cpu",), own_training
    )
    assert "TestOnlyNav" in registry.ALL_ENVS
    _, env, ppo = configs_of(RunRequest(environment="TestOnlyNav"))
    assert (env.preset, ppo.num_envs) == ("cpu", 32)
    assert bank_of("TestOnlyNav") is small_bank
    with pytest.raises(ValidationError, match="found another task"):
        registry.load_nav_env("Go2Joystick", joystick_config("cpu"), terrain_bank(0, 1))
    with pytest.raises(ValidationError, match="registered already"):
        registry.register_environment("TestOnlyNav", make_wheeled_env, default_config)
