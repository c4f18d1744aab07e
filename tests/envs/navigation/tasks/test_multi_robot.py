"""`MultiRobot`: its routes, deliveries to and fro, scores, and refused configurations."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.support.task_figures import check_task
from tests.support.unicycle import one, unicycle_env
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs import NavEnv, Result
from urbanverse_mjx.envs.navigation.fleet import START_SPACING
from urbanverse_mjx.envs.navigation.tasks.config import multi_robot_config
from urbanverse_mjx.envs.navigation.tasks.multi_robot import MOST_ROWS, MultiRobot
from urbanverse_mjx.evaluation import Rollout, fixed_episodes, task_agents
from urbanverse_mjx.evaluation.agents import go_to_goal, zero
from urbanverse_mjx.evaluation.planner import RouteField, waypoint_of
from urbanverse_mjx.evaluation.task_agents import DeliveryPlanner, baseline_of, planner_of

FEW = {"task.robots": 2, "episode_length": 60}


@pytest.fixture(scope="module")
def env(small_bank: SceneBank) -> NavEnv:
    return unicycle_env(small_bank, FEW, config=multi_robot_config())


@pytest.fixture(scope="module")
def task(env: NavEnv) -> MultiRobot:
    assert isinstance(env.task, MultiRobot)
    return env.task


@pytest.fixture(scope="module")
def pair(env: NavEnv) -> Any:
    """The first states of two robots of a street."""
    rows = jnp.arange(2, dtype=jnp.int32)
    return jax.vmap(env.begin_at)(jax.random.split(jax.random.key(0), 2), jnp.zeros(2, jnp.int32), rows)


def test_figures_of_the_task(env: NavEnv, pair: Any) -> None:
    check_task(env, pair)


def stepped(env: NavEnv, nav: Any, xy: Any) -> Any:
    """The state after a step that ends at (2,) m."""
    sim = nav.sim._replace(xpos=nav.sim.xpos.at[1, :2].set(jnp.asarray(xy, jnp.float32)))
    return nav._replace(sim=sim, **env.task.advance(nav, sim, nav.crowd))


def test_routes_are_those_of_the_street_with_starts_apart(env: NavEnv, small_bank: SceneBank) -> None:
    low, high = env.config.task.route_length
    for scene in range(3):
        number = int(env.bank.num_episodes[scene])
        assert 2 <= number <= MOST_ROWS
        start = env.bank.episode_start[scene, :number]
        apart = np.linalg.norm(start[:, None, :2] - start[None, :, :2], axis=-1) + np.diag(np.full(number, 99.0))
        assert apart.min() >= START_SPACING
        lengths = env.bank.episode_length[scene, :number]
        assert low <= lengths.min()
        assert lengths.max() <= high
        table = small_bank.episode_start[scene].tolist()
        for row in range(number):
            source = table.index(start[row].tolist())
            np.testing.assert_array_equal(env.bank.episode_goal[scene, row], small_bank.episode_goal[scene, source])


def test_the_way_back_is_the_way_there_reversed(env: NavEnv, task: MultiRobot) -> None:
    scene, row = jnp.int32(0), jnp.int32(0)
    start, waypoints, number = (np.asarray(x) for x in task.route(scene, row, jnp.bool_(False)))
    from_goal, back, _ = (np.asarray(x) for x in task.route(scene, row, jnp.bool_(True)))
    n = int(number)
    there = np.concatenate([start[None], waypoints[:n]])
    np.testing.assert_allclose(np.concatenate([from_goal[None], back[:n]]), there[::-1], atol=1e-6)
    np.testing.assert_allclose(back[n - 1 :], np.repeat(start[None], len(back) - n + 1, 0), atol=1e-6)


@pytest.mark.extended
def test_each_end_is_a_delivery_and_turns_the_robot_round(env: NavEnv, task: MultiRobot, pair: Any) -> None:
    nav = one(pair)
    start, goal = np.asarray(nav.start), np.asarray(nav.goal)
    far = stepped(env, nav, goal[:2] + [1.1, 0.0])
    assert (float(far.task.delivered), bool(far.task.arrived)) == (0.0, False)
    np.testing.assert_array_equal(far.goal, goal)
    nav = stepped(env, nav, goal[:2] + [0.9, 0.0])
    assert (float(nav.task.delivered), bool(nav.task.arrived)) == (1.0, True)
    np.testing.assert_allclose(nav.goal, start, atol=1e-6)
    np.testing.assert_allclose(nav.start, goal, atol=1e-6)
    assert (int(nav.waypoint), float(nav.route_done)) == (0, 0.0)
    nav = stepped(env, nav, goal[:2])
    assert float(nav.task.delivered) == 1.0, "one end is delivered to once"
    nav = stepped(env, nav, start[:2])
    assert float(nav.task.delivered) == 2.0
    np.testing.assert_allclose(nav.goal, goal, atol=1e-6)


def test_rewards_do_not_jump_where_the_goal_changes(env: NavEnv, task: MultiRobot, pair: Any) -> None:
    nav = one(pair)
    before = nav._replace(goal_distance=jnp.float32(1.5))
    reached = stepped(env, before, nav.goal[:2])._replace(goal_distance=jnp.float32(20.0))
    assert {k: float(x) for k, x in task.rewards(before, reached).items()} == {"approach": 0.0, "delivered": 1.0}
    nearer = stepped(env, nav, nav.start[:2])._replace(goal_distance=nav.goal_distance - 0.25)
    found = task.rewards(nav, nearer)
    assert float(found["approach"]) == pytest.approx(0.25, abs=1e-5)
    assert float(found["delivered"]) == 0.0


@pytest.mark.parametrize(
    ("delivered", "base", "end"),
    [
        (0.0, Result.TIMEOUT, Result.TIMEOUT),
        (1.0, Result.TIMEOUT, Result.GOAL),
        (3.0, Result.HIT_AGENT, Result.HIT_AGENT),
        (3.0, Result.RUNNING, Result.RUNNING),
    ],
)
def test_ends(task: MultiRobot, pair: Any, delivered: float, base: Result, end: Result) -> None:
    nav = one(pair)
    nav = nav._replace(task=nav.task._replace(delivered=jnp.float32(delivered)))
    assert int(task.result(nav, jnp.int32(base))) == end


def test_scores_are_deliveries_per_minute_of_the_street(env: NavEnv, task: MultiRobot, pair: Any) -> None:
    nav = one(pair)
    nav = nav._replace(task=nav.task._replace(delivered=jnp.float32(3.0)), result=jnp.int32(Result.HIT_AGENT))
    scores = {name: float(x) for name, x in task.scores(nav).items()}
    assert scores["score"] == pytest.approx(2 * 3.0 / (60 * env.dt / 60.0)), "two robots, twelve seconds"
    assert (scores["deliveries"], scores["robot_contact"]) == (3.0, 1.0)
    body = nav.crowd.bodies
    away = float(jnp.hypot(body.x[0] - nav.start[0], body.y[0] - nav.start[1]))
    expected = max(away - float(env.dynamic.shapes.radius[0]) - env.robot.planner_radius, 0.0)  # type: ignore[union-attr]
    # The body is longer than its disc by 7 mm at either end.
    assert scores["robot_distance"] == pytest.approx(expected, abs=8e-3)


@pytest.mark.extended
def test_robots_that_drive_to_their_goals_deliver_and_those_that_stand_do_not(env: NavEnv) -> None:
    agents = {"zero": zero, "go_to_goal": go_to_goal}
    results, _ = Rollout(env, chunk=20).run(agents, fixed_episodes(env, 12))
    made = {a: [r.task_scores["deliveries"] for r in results if r.agent == a and r.task_scores] for a in agents}
    assert max(made["zero"]) == 0.0
    assert max(made["go_to_goal"]) >= 1.0, "the kinematic engine has no walls"
    assert {r.result for r in results if r.agent == "zero"} == {"timeout"}


@pytest.mark.extended
def test_runs_are_reproducible(env: NavEnv) -> None:
    episodes = fixed_episodes(env, 4)
    first, again = (Rollout(env, chunk=20).run({"go_to_goal": go_to_goal}, episodes)[0] for _ in range(2))
    assert [r.to_json() for r in first] == [r.to_json() for r in again]


def test_episodes_of_a_street_stay_together(env: NavEnv) -> None:
    episodes = fixed_episodes(env, 8)
    scenes = episodes.scenes.reshape(-1, 2)
    assert (scenes[:, 0] == scenes[:, 1]).all()
    assert len(set(scenes[:3, 0])) == 3, "any number of groups uses the streets equally"
    with pytest.raises(ValidationError, match="episodes: found 3, needed a multiple of 2"):
        fixed_episodes(env, 3)


def test_the_planner_drives_to_the_end_of_the_route_whose_turn_it_is(
    env: NavEnv, pair: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """To the goal first, back to the start after each delivery there; what ORCA forbids makes a command dearer."""
    planner, nav = planner_of(env), one(pair)
    assert isinstance(planner, DeliveryPlanner)
    there = RouteField(jnp.zeros(2), jnp.full((2, 2), 1.0))
    commands, costs = jnp.array([[1.0, 0.0], [0.5, 0.3], [0.0, 0.0]]), jnp.array([1.0, 2.0, 3.0])
    fields: list[float] = []
    monkeypatch.setattr(
        planner, "_first_costs", lambda nav, field: fields.append(float(field.cost[0, 0])) or (commands, costs)
    )
    for forbidden, best in ((0.0, 0), (0.5, 1)):
        monkeypatch.setattr(planner, "_forbidden", lambda nav, c, forbidden=forbidden: jnp.array([forbidden, 0.0, 0.0]))
        for delivered in range(5):
            state = nav.task._replace(delivered=jnp.float32(delivered))
            action = planner.act(nav._replace(task=state), (there, jnp.full((2, 2), 2.0)))
            v, omega = np.asarray(commands[best])
            np.testing.assert_allclose(action, waypoint_of(v, omega, env.robot.max_speed, env.dt), atol=1e-6)
    assert fields == [1.0, 2.0, 1.0, 2.0, 1.0] * 2


@pytest.mark.extended
def test_the_planner_drives_around_a_robot_that_stands_in_its_way(env: NavEnv, pair: Any) -> None:
    """It would wait for it for ever. One that drives on is left to ORCA."""
    planner = planner_of(env)
    assert isinstance(planner, DeliveryPlanner)
    nav = one(pair, 0)
    row = np.asarray(nav.episode)[None]
    route = jax.tree.map(lambda x: x[0], planner.prepare(np.zeros(1, np.int32), row))
    xy, along = np.asarray(nav.start[:2]), np.asarray(nav.waypoints[0, :2] - nav.start[:2])
    along = along / np.linalg.norm(along)
    yaw = float(np.arctan2(along[1], along[0]))
    turned = jnp.array([np.cos(0.5 * yaw), 0.0, 0.0, np.sin(0.5 * yaw)])
    nav = nav._replace(sim=nav.sim._replace(xquat=nav.sim.xquat.at[1].set(turned)))
    act = jax.jit(planner.act)

    def with_other(away: float, speed: float) -> Any:
        at, v = jnp.asarray(xy + away * along, jnp.float32), jnp.asarray(speed * along, jnp.float32)
        body = nav.crowd.bodies._replace(x=at[:1], y=at[1:], vx=v[:1], vy=v[1:], heading=jnp.array([yaw + np.pi]))
        return nav._replace(crowd=nav.crowd._replace(bodies=body))

    free, _ = np.asarray(act(with_other(20.0, 0.0), route))
    assert free > 0.5, "nothing is in its way"
    faced = np.asarray(act(with_other(1.6, 0.0), route))
    assert np.linalg.norm(faced) > 1e-3, "it does not stand"
    assert abs(np.arctan2(faced[1], faced[0])) > 0.05, "it turns aside"
    assert float(planner._agents(with_other(1.6, 0.0))[0, 5]) == 1.0
    assert float(planner._agents(with_other(1.6, 1.0))[0, 5]) == 0.0
    # What ORCA permits a robot at rest before another that stands: the space between them, less the margin, in the
    # horizon.
    shapes = env.dynamic.shapes  # type: ignore[union-attr]
    reach = 2.0 * float(shapes.radius[0] + shapes.half_length[0]) + task_agents.ROBOT_MARGIN
    speeds = jnp.array([[0.1, 0.0], [0.9, 0.0], [-0.5, 0.0]])
    permitted = 1.0 / task_agents.HORIZON
    found = planner._forbidden(with_other(reach + 1.0, 0.0), speeds)
    np.testing.assert_allclose(found, [0.0, 0.9 - permitted, 0.0], atol=1e-3)


@pytest.mark.slow
def test_the_planner_delivers_more_than_the_baseline(small_bank: SceneBank) -> None:
    env = unicycle_env(small_bank, {**FEW, "episode_length": 150}, config=multi_robot_config())
    agents = {"go_to_goal": baseline_of(env)[1], "planner": planner_of(env)}
    assert isinstance(agents["planner"], DeliveryPlanner)
    results, _ = Rollout(env, chunk=20).run(agents, fixed_episodes(env, 12))
    score = {a: np.mean([r.task_scores["score"] for r in results if r.agent == a and r.task_scores]) for a in agents}
    assert score["planner"] > 2.0
    assert {r.result for r in results if r.agent == "planner"} <= {"goal", "timeout", "off_traversable"}


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        ({"task.route_length": (30.0, 8.0)}, "config.task.route_length: found 30 to 8 m"),
        ({"task.route_length": (200.0, 300.0)}, "found 0 starts 1.5 m apart with a route of 200 to 300 m, needed 2"),
        ({"task.arrival_distance": 0.0}, "config.task.arrival_distance: found 0 m"),
        ({"task.deliveries": 0}, "config.task.deliveries: found 0"),
        ({"task.robots": 0}, "config.task.robots: found 0, needed 2 to 8"),
    ],
)
def test_bad_configurations_are_refused_in_a_sentence(
    small_bank: SceneBank, overrides: dict[str, Any], words: str
) -> None:
    with pytest.raises(ValidationError, match=words):
        unicycle_env(small_bank, {**FEW, **overrides}, config=multi_robot_config())
