"""`SocialNav`: its measures of comfort by hand, its score, and configurations that are refused."""

import types
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.support.compiling import optimized
from tests.support.task_figures import check_task
from tests.support.unicycle import unicycle_env
from urbanverse_mjx.crowds import Bodies
from urbanverse_mjx.crowds.behaviours import GO, STAY
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs import NavEnv, Result, check_env
from urbanverse_mjx.envs.navigation.dynamic import MAX_PEOPLE_DISTANCE
from urbanverse_mjx.envs.navigation.tasks.config import social_nav_config
from urbanverse_mjx.envs.navigation.tasks.people import MAX_TIME_TO_COLLISION, PeopleTask, time_to_collision
from urbanverse_mjx.envs.navigation.tasks.social import (
    OBSERVED,
    SocialNav,
    SocialState,
    reward_personal_space,
    reward_time_to_collision,
)
from urbanverse_mjx.evaluation.agents import go_to_goal
from urbanverse_mjx.evaluation.planner import Planner
from urbanverse_mjx.evaluation.task_agents import baseline_of, planner_of

FEW = {f"crowd.slots.{kind}": 0 for kind in ("wheelchair", "scooter")}
FEW |= {"crowd.slots.pedestrian": 3, "terminate_off_traversable": False, "episode_length": 12}
#: m, between the centres of the robot's disc and a pedestrian's at a distance of 0 between them.
PEDESTRIAN = 0.27


@pytest.fixture(scope="module")
def env(small_bank: SceneBank) -> NavEnv:
    with optimized():  # the crowd's tables take seconds
        return unicycle_env(small_bank, FEW, config=social_nav_config())


@pytest.fixture(scope="module")
def begun(env: NavEnv) -> Any:
    return jax.jit(env.begin_at)(jax.random.key(0), jnp.int32(0), jnp.int32(0))


def test_figures_of_the_task(env: NavEnv, begun: Any) -> None:
    check_task(env, begun)


def with_people(nav: Any, places: list[tuple[float, float, float, float]], mode: int = GO) -> Any:
    """A state with people at (x, y) m from the robot with velocities (m/s), and nobody else."""
    number = len(nav.crowd.present)
    rows = np.array([*places, *[(99.0, 0.0, 0.0, 0.0)] * (number - len(places))], np.float32)
    robot = nav.sim.xpos[1, :2]
    x, y = robot[0] + rows[:, 0], robot[1] + rows[:, 1]
    body = nav.crowd.bodies._replace(x=x, y=y, vx=jnp.asarray(rows[:, 2]), vy=jnp.asarray(rows[:, 3]))
    there = jnp.arange(number) < len(places)
    crowd = nav.crowd._replace(bodies=body, present=there, mode=jnp.full(number, mode), speed=jnp.full(number, 1.0))
    return nav._replace(crowd=crowd)


def after(env: NavEnv, nav: Any, velocity: tuple[float, float] = (0.0, 0.0)) -> SocialState:
    """The task's state after a step to the same places, in which the robot has a velocity (m/s)."""
    sim = nav.sim._replace(qvel=nav.sim.qvel.at[:2].set(jnp.array(velocity)))
    state: SocialState = env.task.advance(nav, sim, nav.crowd)["task"]
    return state


@pytest.mark.parametrize(
    ("away", "velocity", "seconds"),
    [
        ((4.0, 0.0), (-1.0, 0.0), 3.0),  # 4 m apart, discs of together 1 m, at 1 m/s
        ((4.0, 0.0), (1.0, 0.0), MAX_TIME_TO_COLLISION),  # leaves
        ((4.0, 1.1), (-1.0, 0.0), MAX_TIME_TO_COLLISION),  # passes beside
        ((4.0, 0.6), (-1.0, 0.0), 4.0 - 0.8),  # touches where the offset is 0.6: a 3-4-5 triangle
        ((0.5, 0.0), (1.0, 0.0), 0.0),  # overlaps
        ((4.0, 0.0), (0.0, 0.0), MAX_TIME_TO_COLLISION),  # nothing moves
        ((90.0, 0.0), (-1.0, 0.0), MAX_TIME_TO_COLLISION),  # later than counts
    ],
)
def test_time_to_collision_by_hand(away: tuple[float, float], velocity: tuple[float, float], seconds: float) -> None:
    found = time_to_collision(jnp.array([away]), jnp.array([velocity]), jnp.array([1.0]))
    assert float(found[0]) == pytest.approx(seconds, abs=1e-5)


def test_penalties_grow_from_personal_to_intimate_distance_and_to_contact() -> None:
    gaps = jnp.array([2.0, 1.2, 0.825, 0.45, 0.0])
    np.testing.assert_allclose([reward_personal_space(x) for x in gaps], [0.0, 0.0, 0.5, 1.0, 1.0], atol=1e-6)
    times = jnp.array([9.0, 3.0, 1.5, 0.0])
    np.testing.assert_allclose([reward_time_to_collision(x, 3.0) for x in times], [0.0, 0.0, 0.5, 1.0], atol=1e-6)


@pytest.mark.extended
def test_distances_and_delays_are_those_of_the_nearest_people(env: NavEnv, begun: Any) -> None:
    radius = env.robot.planner_radius
    # Bodies 0.3 m and 1.0 m from the robot's disc; both prefer 1 m/s, one stands and one walks at half of it.
    places = [(radius + PEDESTRIAN + 0.3, 0.0, 0.0, 0.0), (0.0, radius + PEDESTRIAN + 1.0, 0.0, 0.5)]
    state = after(env, with_people(begun, places))
    assert float(state.nearest) == float(state.gap) == pytest.approx(0.3, abs=1e-5)
    assert (float(state.intimate), float(state.personal)) == (1.0, 1.0)
    assert float(state.delay) == pytest.approx(env.dt * 1.5, abs=1e-5)
    state = after(env, with_people(begun, places[1:]))
    assert (float(state.intimate), float(state.personal)) == (0.0, 1.0)
    assert float(after(env, with_people(begun, places, STAY)).delay) == 0.0, "who stands on purpose loses no time"
    nobody = after(env, with_people(begun, []))
    assert float(nobody.nearest) == MAX_PEOPLE_DISTANCE
    assert (float(nobody.intimate), float(nobody.personal), float(nobody.delay)) == (0.0, 0.0, 0.0)


def test_the_robots_own_motion_counts_in_the_time_to_collision(env: NavEnv, begun: Any) -> None:
    gap = 2.0
    nav = with_people(begun, [(env.robot.planner_radius + PEDESTRIAN + gap, 0.0, -0.5, 0.0)])
    assert float(after(env, nav).least_time) == pytest.approx(gap / 0.5, abs=1e-4)
    assert float(after(env, nav, (1.5, 0.0)).least_time) == pytest.approx(gap / 2.0, abs=1e-4)
    assert float(after(env, nav, (-0.5, 0.0)).least_time) == MAX_TIME_TO_COLLISION
    assert float(after(env, with_people(begun, []), (1.5, 0.0)).least_time) == MAX_TIME_TO_COLLISION


@pytest.mark.parametrize(("heading", "gap"), [(0.0, 3.0), (np.pi, 3.0), (np.pi / 2, 4.5)])
def test_the_time_to_a_collision_with_a_car_is_that_to_its_nearest_point(heading: float, gap: float) -> None:
    """A car of 5 m by 2 m, 6 m ahead of a robot of 0.5 m that drives at 1 m/s: its tail, its front, or its side."""
    f = lambda *v: jnp.array(v, jnp.float32)  # noqa: E731
    shapes = types.SimpleNamespace(half_length=np.array([0.0, 1.5]), radius=np.array([0.3, 1.0]))
    task: Any = types.SimpleNamespace(dynamic=types.SimpleNamespace(shapes=shapes), radius=0.5)
    crowd: Any = types.SimpleNamespace(bodies=Bodies(f(1.0, 6.0), f(0.0, 0.0), f(0, 0), f(0, 0), f(0.0, heading)))
    robot: Any = types.SimpleNamespace(xy=f(0.0, 0.0), velocity=f(1.0, 0.0))
    time = PeopleTask.time_to_collision(task, crowd, robot, jnp.array([False, True]))
    assert float(time) == pytest.approx(gap, abs=1e-5)


def test_jerk_turning_and_scores_of_a_drive(env: NavEnv, begun: Any) -> None:
    """From rest to 1 m/s within a step, on at that speed, then a quarter turn: by differences of velocities."""
    advance = jax.jit(env.task.advance)
    nav = with_people(begun, [])
    velocities, yaws = [(1.0, 0.0), (1.0, 0.0), (0.0, 1.0)], [0.0, 0.0, np.pi / 2]
    nav = nav._replace(sim=nav.sim._replace(xquat=nav.sim.xquat.at[1].set(jnp.array([1.0, 0.0, 0.0, 0.0]))))
    for velocity, yaw in zip(velocities, yaws, strict=True):
        turn = jnp.array([np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2)])
        sim = nav.sim._replace(qvel=nav.sim.qvel.at[:2].set(jnp.array(velocity)))
        sim = sim._replace(xquat=sim.xquat.at[1].set(turn))
        nav = nav._replace(**advance(nav, sim, nav.crowd), sim=sim, steps=nav.steps + 1)
    known = np.diff(np.array([(0.0, 0.0), (0.0, 0.0), *velocities]), axis=0) / env.dt
    jerks = np.linalg.norm(np.diff(known, axis=0), axis=1) / env.dt
    nav = nav._replace(driven=jnp.float32(2.0), result=jnp.int32(Result.GOAL))
    scores = env.task.scores(nav)
    assert tuple(scores) == SocialNav.SCORES
    assert float(scores["jerk"]) == pytest.approx(jerks.mean(), rel=1e-5)
    assert float(scores["turning"]) == pytest.approx(np.pi / 2 / 2.0, rel=1e-5)
    assert float(scores["score"]) == 1.0
    close = nav._replace(task=nav.task._replace(intimate=jnp.float32(1.0), personal=jnp.float32(2.0)))
    scores = env.task.scores(close)
    assert float(scores["score"]) == pytest.approx(2 / 3)
    assert float(scores["personal_time"]) == pytest.approx(2 / 3)
    for result in (Result.TIMEOUT, Result.HIT_AGENT, Result.RUNNING):
        assert float(env.task.scores(close._replace(result=jnp.int32(result)))["score"]) == 0.0


def test_rewards_have_the_signs_of_penalties(env: NavEnv, begun: Any) -> None:
    scales = env.config.reward_config.scales
    assert all(scales[name] < 0.0 for name in ("personal_space", "time_to_collision", "jerk"))
    near = with_people(begun, [(env.robot.planner_radius + PEDESTRIAN + 0.2, 0.0, -1.0, 0.0)])
    values = env.task.rewards(near, near._replace(task=after(env, near, (1.0, 0.0))))
    assert float(values["personal_space"]) == 1.0
    assert float(values["time_to_collision"]) == pytest.approx(1.0 - 0.1 / 3.0, abs=1e-4)
    assert 0.0 < float(values["jerk"]) <= 1.0
    far = with_people(begun, [])
    values = env.task.rewards(far, far._replace(task=after(env, far)))
    assert {name: float(x) for name, x in values.items()} == dict.fromkeys(values, 0.0)


def test_privileged_lists_the_nearest_people_in_the_heading_frame(env: NavEnv, begun: Any) -> None:
    quarter = jnp.array([np.cos(np.pi / 4), 0.0, 0.0, np.sin(np.pi / 4)])
    nav = with_people(begun, [(0.0, 4.0, 0.0, -1.0), (0.0, 2.0, 0.5, 0.0)])
    nav = nav._replace(sim=nav.sim._replace(xquat=nav.sim.xquat.at[1].set(quarter)))
    people, time = env.task.privileged(nav)
    rows = np.asarray(people).reshape(-1, 5)
    assert len(rows) == min(OBSERVED, 3)
    # Facing north: 2 m ahead walking to the right, 4 m ahead coming nearer, and nobody third.
    np.testing.assert_allclose(rows, [[0.4, 0, 0, -0.5, 1], [0.8, 0, -1, 0, 1], [0, 0, 0, 0, 0]], atol=1e-5)
    assert time.shape == (1,)


@pytest.mark.extended
def test_the_ceiling_is_a_planner_to_whom_nearness_to_people_costs(env: NavEnv, begun: Any) -> None:
    planner, plain = planner_of(env), Planner(env)
    assert isinstance(planner, Planner)
    assert baseline_of(env) == ("go_to_goal", go_to_goal)
    known = jax.tree.map(lambda x: x[0], plain.prepare(np.array([0]), np.array([0])))
    state = jnp.concatenate([begun.start[:2], jnp.zeros(3)])

    both = jax.jit(lambda agents: [x.costs(jnp.int32(0), state, known, agents) for x in (planner, plain)])

    def costs(x: float, y: float) -> list[np.ndarray]:
        agents = jnp.array([[begun.start[0] + x, begun.start[1] + y, 0.0, 0.0, PEDESTRIAN, 1.0]])
        return [np.asarray(values) for values in both(agents)]

    far, near = costs(20.0, 0.0), costs(1.0, 1.0)
    np.testing.assert_array_equal(far[0], far[1])
    more = near[0] - near[1]
    assert more.min() >= -1e-3
    assert more.max() > 0.1


@pytest.mark.slow
def test_check_env_accepts_it(env: NavEnv) -> None:
    check_env(env, num_envs=4, num_steps=6)


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        ({"task.horizon": 0.0}, "config.task.horizon: found 0.0"),
        ({"task.jerk_limit": -1.0}, "config.task.jerk_limit"),
        ({"scenario": "static"}, "found 'static' for the task 'social_nav', needed 'dynamic'"),
        ({"task.name": "fly"}, "config.task.name: found 'fly', needed one of point_goal, social_nav"),
    ],
)
def test_bad_configurations_are_refused_in_a_sentence(
    small_bank: SceneBank, overrides: dict[str, Any], words: str
) -> None:
    with pytest.raises(ValidationError, match=words):
        unicycle_env(small_bank, {**FEW, **overrides}, config=social_nav_config())
