"""`CrossStreet`: its routes, near misses, stops and scores, and configurations that are refused."""

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.support.compiling import optimized
from tests.support.unicycle import unicycle_env
from urbanverse_mjx.datatypes import KIND_INDEX, SceneBank, ValidationError
from urbanverse_mjx.envs import NavEnv, Result, check_env
from urbanverse_mjx.envs.navigation.tasks.config import cross_street_config
from urbanverse_mjx.envs.navigation.tasks.cross import OBSERVED, CrossState, CrossStreet
from urbanverse_mjx.evaluation.task_agents import GapPlanner, planner_of

FEW = {"crowd.slots.pedestrian": 1, "crowd.slots.cyclist": 1, "crowd.slots.car": 2}
#: The agents of `FEW`.
KINDS = ("pedestrian", "cyclist", "car", "car")
#: m, half of a car's length and width (kinds.py), and the radius of the disc around COCO.
HALF_LENGTH, HALF_WIDTH, ROBOT = 2.37, 0.88, 0.443


@pytest.fixture(scope="module")
def env(small_bank: SceneBank) -> NavEnv:
    with optimized():  # the crowd's tables take seconds
        return unicycle_env(small_bank, {**FEW, "scenes": small_bank.scene_ids[0]}, config=cross_street_config())


@pytest.fixture(scope="module")
def task(env: NavEnv) -> CrossStreet:
    assert isinstance(env.task, CrossStreet)
    return env.task


@pytest.fixture(scope="module")
def begun(env: NavEnv) -> Any:
    return jax.jit(env.begin_at)(jax.random.key(0), jnp.int32(0), jnp.int32(0))


def state_of(
    nav: Any,
    xy: tuple[float, float],
    velocity: tuple[float, float] = (0.0, 0.0),
    cars: list[tuple[float, float, float]] | None = None,
    pedestrian: tuple[float, float, float] | None = None,
) -> Any:
    """A state with the robot at a point (m) with a velocity (m/s) and agents at (x, y) m that go east (m/s)."""
    rows = np.array([(99.0, 99.0, 0.0)] * 4, np.float32)
    there = np.zeros(4, bool)
    for row, values in enumerate(cars or [], 2):
        rows[row], there[row] = values, True
    if pedestrian is not None:
        rows[0], there[0] = pedestrian, True
    x, y, v = (jnp.asarray(a) for a in rows.T)
    body = nav.crowd.bodies._replace(x=x, y=y, vx=v, vy=jnp.zeros(4), heading=jnp.zeros(4))
    sim = nav.sim._replace(
        xpos=nav.sim.xpos.at[1, :2].set(jnp.array(xy)), qvel=nav.sim.qvel.at[:2].set(jnp.array(velocity))
    )
    return nav._replace(sim=sim, crowd=nav.crowd._replace(bodies=body, present=jnp.asarray(there)))


def after(env: NavEnv, nav: Any, *place: Any, **others: Any) -> Any:
    """The state after a step to `state_of`."""
    new = state_of(nav, *place, **others)
    return new._replace(**env.task.advance(nav, new.sim, new.crowd), steps=nav.steps + 1)


def test_routes_lead_straight_over_the_crosswalk_from_pavement_to_pavement(env: NavEnv) -> None:
    bank, scene = env.bank, int(env.scenes[0])
    count = int(bank.num_episodes[scene])
    assert count >= 32
    start, goal = bank.episode_start[scene, :count, :2], bank.episode_goal[scene, :count, :2]
    # The crosswalk is at x 28 to 32, y -4 to 4; its border lies on the map's cells.
    for ends in (start, goal):
        beyond = np.abs(ends[:, 1]) - 4.0
        assert (beyond > 1.7).all()
        assert (beyond < 6.2).all()
    assert (start[:, 1] * goal[:, 1] < 0.0).all()
    straight = np.linalg.norm(goal - start, axis=-1)
    assert (bank.episode_length[scene, :count] <= 1.2 * straight + 1e-3).all()
    assert len(np.unique(np.sign(start[:, 1]))) == 2, "both ways"


def test_near_misses_by_hand(env: NavEnv, task: CrossStreet, begun: Any) -> None:
    """A car comes from the west on the robot's line at 8 m/s."""
    reach = HALF_LENGTH - HALF_WIDTH + HALF_WIDTH + ROBOT
    for seconds, missed in ((1.6, 0.0), (1.4, 1.0)):
        nav = after(env, begun, (30.0, -2.0), cars=[(30.0 - reach - 8.0 * seconds, -2.0, 8.0)])
        assert float(nav.task.time) == pytest.approx(seconds, abs=0.01)
        assert float(nav.task.near_misses) == missed
        assert float(task.rewards(begun, nav)["near_miss"]) == missed
        penalty = float(task.rewards(begun, nav)["time_to_collision"])
        assert penalty == pytest.approx(1.0 - seconds / 3.0, abs=0.01)
    # Beside its lane nothing is missed, and people do not count here.
    for others in (
        {"cars": [(22.0, -2.0 - HALF_WIDTH - ROBOT - 0.05, 8.0)]},
        {"pedestrian": (29.0, -2.0, 2.0)},
    ):
        assert float(after(env, begun, (30.0, -2.0), **others).task.near_misses) == 0.0


def test_a_near_miss_counts_once(env: NavEnv, begun: Any) -> None:
    near, far = [(24.0, -2.0, 6.0)], [(2.0, -2.0, 2.0)]
    nav, counts = begun, []
    # Two steps near, four of 0.2 s away from it, near again: one miss. Six steps away: another.
    for cars in (near, near, *[far] * 4, near, *[far] * 6, near):
        nav = after(env, nav, (30.0, -2.0), cars=cars)
        counts.append(float(nav.task.near_misses))
    assert counts == [1.0] * 13 + [2.0]
    assert float(nav.task.least) < 1.5


def test_stops_count_on_the_road_and_waiting_beside_it(env: NavEnv, task: CrossStreet, begun: Any) -> None:
    nav = begun
    for xy, velocity, stops, waited in (
        ((30.0, -6.0), (0.0, 0.0), 0.0, 0.2),  # stands at the kerb
        ((30.0, -6.0), (0.0, 0.2), 0.0, 0.4),  # still, until it goes faster than 0.3 m/s
        ((30.0, -5.0), (0.0, 1.0), 0.0, 0.4),
        ((30.0, -3.0), (0.0, 1.0), 0.0, 0.4),
        ((30.0, -2.9), (0.0, 0.05), 1.0, 0.4),  # stops on the road
        ((30.0, -2.9), (0.0, 0.0), 1.0, 0.4),
        ((30.0, -2.8), (0.0, 0.2), 1.0, 0.4),
        ((30.0, -2.8), (0.0, 0.05), 1.0, 0.4),  # it had not gone on
        ((30.0, -2.0), (0.0, 1.0), 1.0, 0.4),
        ((30.0, -1.9), (0.0, 0.0), 2.0, 0.4),
        ((30.0, 5.0), (0.0, 0.0), 2.0, 0.6),
    ):
        new = after(env, nav, xy, velocity)
        assert (float(new.task.stops), float(new.task.waited)) == (stops, pytest.approx(waited))
        assert float(task.rewards(nav, new)["stop"]) == stops - float(nav.task.stops)
        nav = new


@pytest.mark.parametrize(
    ("result", "near_misses", "stops", "seconds", "score"),
    [
        (Result.GOAL, 0, 0, 5.0, 1.0),  # 10 m at 2 m/s
        (Result.GOAL, 0, 0, 14.0, 0.8),  # 9 s of delay
        (Result.GOAL, 1, 2, 14.0, 0.8 * 0.5 * 0.64),
        (Result.GOAL, 0, 0, 55.0, 0.0),
        (Result.HIT_AGENT, 0, 0, 5.0, 0.0),
        (Result.TIMEOUT, 0, 0, 60.0, 0.0),
    ],
)
def test_scores_by_hand(
    task: CrossStreet, begun: Any, result: Result, near_misses: int, stops: int, seconds: float, score: float
) -> None:
    state = begun.task._replace(near_misses=jnp.float32(near_misses), stops=jnp.float32(stops))
    nav = begun._replace(
        task=state, result=jnp.int32(result), steps=jnp.int32(round(seconds / 0.2)), route_length=jnp.float32(10.0)
    )
    found = {name: float(x) for name, x in task.scores(nav).items()}
    assert list(found) == list(task.SCORES)
    assert found["score"] == pytest.approx(score, abs=1e-5)
    assert (found["near_misses"], found["stops"]) == (near_misses, stops)
    assert (found["seconds"], found["delay"]) == pytest.approx((seconds, seconds - 5.0), abs=1e-4)


def test_drivers_give_way_in_the_share_of_episodes_and_it_is_observed(
    env: NavEnv, task: CrossStreet, begun: Any
) -> None:
    keys = jax.random.split(jax.random.key(3), 200)
    shares = jax.vmap(lambda key: task.begin(key, begun).task.priority)(keys)
    assert 0.35 < float(shares.mean()) < 0.65
    for priority in (True, False):
        nav = begun._replace(task=begun.task._replace(priority=jnp.bool_(priority)))
        rights = task.rights(nav)
        assert bool(rights.walks) == priority
        assert not np.asarray(rights.phase).any(), "no signals"
        assert float(env._proprio(nav)[3]) == priority


def test_the_privileged_vector_tells_of_vehicles_alone(env: NavEnv, begun: Any) -> None:
    nav = after(env, begun, (30.0, -2.0), cars=[(25.0, -2.0, 5.0)], pedestrian=(31.0, -2.0, 0.0))
    turn = nav._replace(sim=nav.sim._replace(xquat=nav.sim.xquat.at[1].set(jnp.array([1.0, 0.0, 0.0, 0.0]))))
    values = np.asarray(env.observe(turn)["privileged"])[-(3 + 5 * OBSERVED) :]
    np.testing.assert_allclose(values[1:3], [1.0, float(nav.task.time) / 10.0], atol=1e-6)
    np.testing.assert_allclose(values[3:8], [-0.5, 0.0, 1.0, 0.0, 1.0], atol=1e-5)
    np.testing.assert_array_equal(values[8:], 0.0)


def test_the_planner_waits_for_what_comes_and_not_for_what_does_not(env: NavEnv, begun: Any) -> None:
    planner = planner_of(env)
    assert isinstance(planner, GapPlanner)
    kerb = (30.0, -5.5)
    for cars, closed in (
        ([], False),
        ([(10.0, -2.0, 7.5)], True),  # is there in 2 s
        ([(45.0, -2.0, 7.5)], False),  # has passed
        ([(24.0, -2.0, 0.0)], False),  # has stopped before it
        ([(30.0, 2.0, 0.0)], True),  # stands on it
        ([(1.0, -2.0, 1.0)], False),  # far and slow
    ):
        assert bool(planner.closed(state_of(begun, kerb, cars=cars))[0]) == closed, cars
    assert not bool(planner.closed(state_of(begun, (30.0, 0.0), cars=[(10.0, -2.0, 7.5)]))[0]), "it goes on"


def test_an_episode_is_the_same_when_it_is_run_again(env: NavEnv) -> None:
    begin = jax.jit(lambda key: env.begin_at(key, jnp.int32(0), jnp.int32(3)))
    first, second = begin(jax.random.key(1)), begin(jax.random.key(1))
    assert isinstance(first.task, CrossState)
    step = jax.jit(lambda nav: env.advance(nav, jnp.array([0.5, 0.1]))[0])
    for _ in range(3):
        first, second = step(first), step(second)
    parts = [jax.tree.leaves((nav.sim, nav.task, nav.crowd)) for nav in (first, second)]
    for a, b in zip(*parts, strict=True):
        np.testing.assert_array_equal(a, b)


@pytest.mark.slow
def test_check_env_accepts_it(env: NavEnv) -> None:
    check_env(env, num_envs=4, num_steps=6)


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        ({"task.priority": 1.5}, "config.task.priority: found 1.5, needed a share"),
        ({"task.horizon": 1.0}, "config.task.horizon: found 1 s, needed more than the 1.5 s of a near miss"),
        ({"crowd.slots.cyclist": 0, "crowd.slots.car": 0}, "config.crowd.slots: found no vehicle"),
        ({"scenario": "static"}, "found 'static' for the task 'cross_street'"),
    ],
)
def test_bad_configurations_are_refused_in_a_sentence(
    small_bank: SceneBank, overrides: dict[str, Any], words: str
) -> None:
    scenes = {"scenes": small_bank.scene_ids[0]}
    with pytest.raises(ValidationError, match=words):
        unicycle_env(small_bank, {**FEW, **scenes, **overrides}, config=cross_street_config())


def test_scenes_without_a_road_are_refused_in_a_sentence(small_bank: SceneBank) -> None:
    kinds = np.where(small_bank.map_kind == KIND_INDEX["road"], 0, small_bank.map_kind).astype(np.uint8)
    bank = dataclasses.replace(small_bank, map_kind=kinds)
    with pytest.raises(ValidationError, match="with a crosswalk that routes of vehicles pass"):
        unicycle_env(bank, {**FEW, "scenes": bank.scene_ids[0]}, config=cross_street_config())
