"""The scripted controller that students imitate: along the route, around obstacles on it, without contact."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.support.unicycle import unicycle_env
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs.navigation import terms
from urbanverse_mjx.envs.navigation.scenarios import bank_for
from urbanverse_mjx.evaluation import Rollout, fixed_episodes
from urbanverse_mjx.evaluation.route_follower import RouteFollower, route_point


def test_a_point_of_the_route_lies_at_its_arc_length() -> None:
    start, waypoints = jnp.array([1.0, 2.0, 0.0]), jnp.array([[4.0, 2.0, 0.0], [4.0, 6.0, 0.0], [4.0, 6.0, 0.0]])
    for position, expected in ((-1.0, (1.0, 2.0)), (2.0, (3.0, 2.0)), (4.0, (4.0, 3.0)), (9.0, (4.0, 6.0))):
        point = route_point(start, waypoints, jnp.float32(position))
        np.testing.assert_allclose(point, expected, atol=1e-5)
        if 0.0 < position < 7.0:
            assert float(terms.route_position(point, start, waypoints)) == pytest.approx(position, abs=1e-4)


@pytest.mark.extended
def test_it_reaches_every_goal_of_a_free_scene(small_bank: SceneBank) -> None:
    env = unicycle_env(bank_for("clean", small_bank))
    results, _ = Rollout(env).run({"follower": RouteFollower(env)}, fixed_episodes(env, 6))
    assert [r.result for r in results] == ["goal"] * 6


@pytest.mark.extended
def test_it_comes_through_a_furnished_scene_without_touching_a_hull(small_bank: SceneBank) -> None:
    """The kinematic engine has no contacts, so distances below a disc's radius minus the look-up error count as one."""
    env = unicycle_env(small_bank)
    follower = RouteFollower(env)
    episodes = np.linspace(0, int(small_bank.num_episodes[0]) - 1, 6).astype(np.int32)
    begin = jax.jit(lambda rows: jax.vmap(lambda k, row: env.begin_at(k, jnp.int32(0), row))(
        jax.random.split(jax.random.key(0), len(episodes)), rows
    ))  # fmt: skip

    @jax.jit
    def drive(nav):
        def step(nav, _):
            new = jax.vmap(lambda n: env.advance(n, follower.act(n))[0])(nav)
            here = new.sim.xpos[:, follower._root, :2]
            gap = jax.vmap(env.distances)(new, here)[:, 0]
            return new, (gap, new.goal_distance)

        return jax.lax.scan(step, nav, None, length=150)[1]

    gaps, left = drive(begin(jnp.asarray(episodes)))
    assert (np.asarray(left).min(0) < 1.0).sum() >= 5
    # Until the goal, the body's middle is never nearer to a hull than the half width of the body.
    before = np.maximum.accumulate(np.asarray(left)[::-1], 0)[::-1] > 1.0
    assert np.asarray(gaps)[before].min() > follower._body.half_width - 0.15


def test_other_action_modes_are_refused(small_bank: SceneBank) -> None:
    env = unicycle_env(small_bank, {"action_mode": "velocity"})
    with pytest.raises(ValidationError, match="needed 'waypoint'"):
        RouteFollower(env)
