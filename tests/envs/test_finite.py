"""All outputs of `step` are finite, whatever values the state, the action or the engine has."""

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.support import disturbed_steps
from tests.support.unicycle import UnicycleEngine, unicycle_env, unicycle_robot
from tests.support.unsound import NO_NUMBERS, float_leaves, spoil, unsound
from urbanverse_mjx.datatypes import AgentMotion, SceneBank, SimState
from urbanverse_mjx.envs import NavEnv, Result
from urbanverse_mjx.envs.finite import MAX_MAGNITUDE, is_sound


class BrokenEngine(UnicycleEngine):
    """Corrupts one float of its result; the friction scale of an env, from 2 on, selects the leaf."""

    def step(self, state: SimState, ctrl: Any, agents: AgentMotion | None = None) -> SimState:
        sim = super().step(state, ctrl, agents)._replace(friction_scale=state.friction_scale)
        names = float_leaves(sim)

        def spoilt(path: Any, leaf: Any) -> Any:
            name = jax.tree_util.keystr(path)
            if name not in names:
                return leaf
            bad = jnp.full_like(leaf, jnp.nan).at[(0,) * max(leaf.ndim - 1, 0)].set(jnp.inf)
            return jnp.where(state.friction_scale == 2.0 + names.index(name), bad, leaf)

        return jax.tree_util.tree_map_with_path(spoilt, sim)


@pytest.fixture(scope="module")
def env(small_bank: SceneBank) -> NavEnv:
    plain = unicycle_env(small_bank)
    robot = unicycle_robot()
    return NavEnv(plain.config, small_bank, robot, BrokenEngine(robot, plain.config.ctrl_dt), None)


def test_a_spoilt_state_or_action_ends_the_episode_and_spoils_nothing_else(env: NavEnv) -> None:
    state = jax.jit(jax.vmap(env.reset))(jax.random.split(jax.random.key(0), 64))
    assert len(float_leaves(state.data)) < 32, "each leaf is spoilt at least twice"
    step = jax.jit(jax.vmap(env.step))
    still, rng = jnp.zeros((64, 2)), np.random.default_rng(0)
    clean = step(state, still)
    for round_ in range(6):
        spoilt = np.flatnonzero(rng.random(64) < 0.5)
        action = np.zeros((64, 2), np.float32)
        given = dataclasses.replace(state, data=spoil(state.data, rng, spoilt))
        after = step(given, jnp.asarray(action))
        assert unsound(after) == [], round_
        assert (np.asarray(after.info["result"])[spoilt] == Result.NON_FINITE).all()
        assert (np.asarray(after.done)[spoilt] == 1.0).all()
        others = np.setdiff1d(np.arange(64), spoilt)
        for a, b in zip(
            jax.tree.leaves((after.obs, after.reward)), jax.tree.leaves((clean.obs, clean.reward)), strict=True
        ):
            np.testing.assert_array_equal(np.asarray(a)[others], np.asarray(b)[others])
        action[spoilt, rng.integers(2)] = rng.choice(NO_NUMBERS)
        after = step(state, jnp.asarray(action))
        assert unsound(after) == []
        assert (np.asarray(after.info["result"]) == np.asarray(clean.info["result"])).all(), "an action is clipped"


def test_an_action_beyond_its_range_means_the_end_of_the_range(small_bank: SceneBank) -> None:
    env = unicycle_env(small_bank, {"action_mode": "velocity"})
    given = [(1.7, -0.4), (0.3, -9.0), (np.inf, 0.2), (0.5, -np.inf), (-3.0, 1.2), (np.nan, 0.5)]
    meant = [(1.0, -0.4), (0.3, -1.0), (1.0, 0.2), (0.5, -1.0), (-1.0, 1.0), (0.0, 0.5)]
    state = jax.jit(jax.vmap(env.reset))(jnp.repeat(jax.random.split(jax.random.key(0), 1), len(given)))
    step = jax.jit(jax.vmap(env.step))
    found, wanted = (np.asarray(step(state, jnp.float32(actions)).data.sim.qpos) for actions in (given, meant))
    np.testing.assert_array_equal(found, wanted)
    assert len(np.unique(wanted.round(4), axis=0)) == len(given), "each of them moves differently"


def test_what_an_engine_spoils_ends_the_episode_where_it_stood(env: NavEnv) -> None:
    state = jax.jit(jax.vmap(env.reset))(jax.random.split(jax.random.key(0), 64))
    names = float_leaves(jax.eval_shape(env.begin, jax.random.key(0)).sim)
    assert {".qpos", ".qvel", ".xpos", ".xquat", ".contacts.hit_force", ".contacts.hit_fraction"} <= set(names)
    which = np.arange(64) < len(names)
    sim = state.data.sim._replace(friction_scale=jnp.where(jnp.asarray(which), 2.0 + jnp.arange(64), 1.0))
    given = dataclasses.replace(state, data=state.data._replace(sim=sim))
    after = jax.jit(jax.vmap(env.step))(given, jnp.ones((64, 2)))
    assert unsound(after) == []
    np.testing.assert_array_equal(np.asarray(after.info["result"]) == Result.NON_FINITE, which)
    moved = np.abs(np.asarray(after.data.sim.xpos - sim.xpos)).max((1, 2)) > 0.0
    np.testing.assert_array_equal(moved, ~which)


def test_the_largest_number_is_sound_and_the_next_is_not() -> None:
    tree = {"count": jnp.int32(2**31 - 1), "key": jax.random.key(0)}
    assert is_sound({**tree, "x": jnp.float32([MAX_MAGNITUDE, -MAX_MAGNITUDE])})
    for wrong in (np.nextafter(np.float32(MAX_MAGNITUDE), np.float32(np.inf)), *NO_NUMBERS):
        assert not is_sound({**tree, "x": jnp.float32([0.0, wrong])})


@pytest.mark.slow
@pytest.mark.parametrize("impl", ["jax", "warp"])
@pytest.mark.parametrize("scenario", ["static", "dynamic"])
def test_half_a_million_spoilt_steps_of_an_engine(small_bank: SceneBank, impl: str, scenario: str) -> None:
    env = disturbed_steps.env_of(small_bank, impl, scenario)
    programs = disturbed_steps.programs(env)
    for part in range(500_000 // disturbed_steps.PART):
        disturbed_steps.disturb_part(*programs, part)
