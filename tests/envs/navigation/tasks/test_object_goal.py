"""`ObjectGoal`: its episodes, what counts as found, how episodes end, what is observed, and refused configurations."""

import types
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.support.task_figures import check_task
from tests.support.unicycle import first_states, one, unicycle_env
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs import NavEnv, Result, check_env, registry
from urbanverse_mjx.envs.navigation.tasks.config import object_goal_config
from urbanverse_mjx.envs.navigation.tasks.object_episodes import SPACING, sight_points, to_boxes
from urbanverse_mjx.envs.navigation.tasks.object_goal import STANDING_SPEED, ObjectGoal
from urbanverse_mjx.envs.navigation.tasks.object_names import EMBEDDING_SIZE, embedding
from urbanverse_mjx.evaluation import Rollout, fixed_episodes
from urbanverse_mjx.evaluation.agents import go_to_goal, zero
from urbanverse_mjx.evaluation.planner import Planner
from urbanverse_mjx.evaluation.task_agents import ObjectPlanner, ObjectWanderer, baseline_of, planner_of
from urbanverse_mjx.training.networks import goal_features
from urbanverse_mjx.training.sequences import mirrored_view

SHORT = {"episode_length": 60, "task.path_length": (3.0, 25.0)}


@pytest.fixture(scope="module")
def env(small_bank: SceneBank) -> NavEnv:
    return unicycle_env(small_bank, SHORT, config=object_goal_config())


@pytest.fixture(scope="module")
def task(env: NavEnv) -> ObjectGoal:
    assert isinstance(env.task, ObjectGoal)
    return env.task


@pytest.fixture(scope="module")
def begun(env: NavEnv) -> Any:
    """The first state of every episode of a scene."""
    return first_states(env)


def test_figures_of_the_task(env: NavEnv, begun: Any) -> None:
    check_task(env, begun)


def at(nav: Any, xy: Any, speed: float = 0.0, turn: float = 0.0) -> Any:
    sim = nav.sim
    place = sim.xpos.at[1, :2].set(jnp.asarray(xy, jnp.float32))
    velocity = sim.qvel.at[:2].set(jnp.array([speed, 0.0])).at[5].set(turn)
    return nav._replace(sim=sim._replace(xpos=place, qvel=velocity))


def stepped(env: NavEnv, nav: Any) -> Any:
    """The task's state after a step that ends as `nav` is."""
    return nav._replace(**env.task.advance(nav, nav.sim, None))


# Episodes.


def test_a_path_leads_from_the_streets_start_to_where_the_object_is_within_reach(
    env: NavEnv, task: ObjectGoal, small_bank: SceneBank
) -> None:
    low, high = env.config.task.path_length
    for scene in range(3):
        for row in range(int(env.bank.num_episodes[scene])):
            source = task.goals.source[scene, row]
            np.testing.assert_array_equal(env.bank.episode_start[scene, row], small_bank.episode_start[scene, source])
            length = float(env.bank.episode_length[scene, row])
            assert low <= length <= high + 0.5
            waypoints = env.bank.episode_waypoints[scene, row, : env.bank.episode_num_waypoints[scene, row]]
            line = np.concatenate([env.bank.episode_start[scene, row, None, :2], waypoints[:, :2]])
            spans = np.linalg.norm(np.diff(line, axis=0), axis=1)
            assert spans.max() <= 1.5 * SPACING + 0.3
            assert spans.sum() <= length + 0.3, "waypoints cut corners"
            np.testing.assert_array_equal(waypoints[-1], env.bank.episode_goal[scene, row])
            which = task.goals.which[scene, row]
            boxes = task.goals.boxes[which][: task.goals.count[which]]
            distance, _ = to_boxes(np, waypoints[-1, :2].astype(float), boxes)
            assert distance.min() <= env.config.task.success_distance
            assert distance.min() > env.robot.planner_radius


def test_the_same_bank_gives_the_same_episodes_and_other_ranges_give_others(
    env: NavEnv, task: ObjectGoal, small_bank: SceneBank
) -> None:
    again = unicycle_env(small_bank, SHORT, config=object_goal_config())
    assert isinstance(again.task, ObjectGoal)
    np.testing.assert_array_equal(again.bank.episode_waypoints, env.bank.episode_waypoints)
    np.testing.assert_array_equal(again.task.goals.which, task.goals.which)
    far = unicycle_env(small_bank, {**SHORT, "task.path_length": (12.0, 25.0)}, config=object_goal_config())
    # The start is up to half a node from the middle of its own.
    assert float(far.bank.episode_length.min()) >= 12.0 - 0.2 > float(env.bank.episode_length.min())


def test_episodes_ask_for_many_objects(task: ObjectGoal) -> None:
    asked = {task.goal_name(0, row) for row in range(32)}
    assert len(asked) > 8
    assert all(text.split()[0] in ("the", "a", "an") for text in asked)


def test_distances_to_a_turned_box() -> None:
    boxes = np.array([[1.0, 2.0, 0.5, 0.2, np.pi / 2]])
    points = np.array([[1.0, 4.0], [3.0, 2.0], [1.0, 2.1]])
    distance, nearest = to_boxes(np, points, boxes)
    np.testing.assert_allclose(distance[:, 0], [1.5, 1.8, 0.0], atol=1e-5)
    np.testing.assert_allclose(nearest[0, 0], [1.0, 2.5], atol=1e-9)
    line = sight_points(np, points[:1, None], nearest[:1], distance[:1])
    np.testing.assert_allclose(line[0, 0, 0], [1.0, 4.0])
    np.testing.assert_allclose(line[-1, 0, 0], [1.0, 2.8], atol=1e-6)


# Ends.


def test_a_stop_within_reach_succeeds_and_one_elsewhere_fails(env: NavEnv, begun: Any) -> None:
    nav = one(begun)
    for place, end in ((nav.goal[:2], Result.GOAL), (nav.start[:2], Result.STOPPED)):
        now, ends = at(nav, place), []
        for _ in range(5):
            now = stepped(env, now)
            ends.append(int(env.task.result(now, jnp.int32(Result.RUNNING))))
        assert ends == [Result.RUNNING] * 4 + [end], "after one second at 5 Hz"


@pytest.mark.parametrize(("speed", "turn"), [(STANDING_SPEED + 0.01, 0.0), (0.0, 0.25)])
def test_who_drives_or_turns_does_not_stop(env: NavEnv, begun: Any, speed: float, turn: float) -> None:
    nav = one(begun)
    now = at(nav, nav.goal[:2], speed, turn)
    for _ in range(8):
        now = stepped(env, now)
    assert float(now.task.standing) == 0.0
    assert int(env.task.result(now, jnp.int32(Result.RUNNING))) == Result.RUNNING


@pytest.mark.parametrize(
    ("base", "end"),
    [(Result.HIT, Result.HIT), (Result.FALL, Result.FALL), (Result.TIMEOUT, Result.GOAL)],
)
def test_other_ends_come_first_except_the_time_limit(env: NavEnv, begun: Any, base: Result, end: Result) -> None:
    nav = one(begun)
    now = at(nav, nav.goal[:2])
    for _ in range(5):
        now = stepped(env, now)
    assert int(env.task.result(now, jnp.int32(base))) == end


def test_any_of_several_counts(env: NavEnv, task: ObjectGoal, begun: Any) -> None:
    """At every object that a phrase means, some place beside it is a success."""
    counts = task.goals.count[task.goals.which[0]]
    row = int(np.argmax(counts))
    assert counts[row] > 1, "a phrase of the scene means several"
    nav, angles = one(begun, row), np.linspace(0.0, 2 * np.pi, 16, endpoint=False)
    for box in task.goals.boxes[task.goals.which[0, row]][: counts[row]]:
        ring = box[:2] + (np.hypot(*box[2:4]) + 0.5) * np.stack([np.cos(angles), np.sin(angles)], -1)
        assert any(bool(stepped(env, at(nav, point)).task.reached) for point in ring)


def test_behind_a_hull_it_is_not_found(env: NavEnv, task: ObjectGoal, begun: Any) -> None:
    """A hull between the robot and an object within reach: the line of sight meets it."""
    nav = one(begun)
    hidden, _, free = task.sight(nav.sim.scene, nav.episode, nav.goal[:2])
    assert bool((free & (hidden < task.reach)).any())
    fields = task._hulls.fields[0, :, :, 0]
    wall = np.argwhere(fields == 0)
    middle = np.asarray(env.bank.map_origin[0]) + (wall[len(wall) // 2] + 0.5) * 0.2
    box = np.array([[middle[0] + 0.8, middle[1], 0.05, 0.05, 0.0]], np.float32)
    task_boxes, task._boxes = task._boxes, jnp.asarray(np.repeat(box[None], len(task.goals.texts), 0))
    try:
        distance, _, seen = task.sight(nav.sim.scene, nav.episode, jnp.asarray(middle - [0.1, 0.0], jnp.float32))
    finally:
        task._boxes = task_boxes
    assert float(distance[0]) < task.reach
    assert not bool(seen[0])


def test_the_camera_sees_what_is_ahead_only(env: NavEnv, task: ObjectGoal, begun: Any) -> None:
    nav = one(begun)
    now = at(nav, nav.goal[:2])
    distance, nearest, free = task.sight(now.sim.scene, now.episode, nav.goal[:2])
    ok = np.flatnonzero(np.asarray(free & (distance < 1.0)))[0]
    away = np.asarray(nearest[ok]) - np.asarray(nav.goal[:2])
    for turn, seen in ((0.0, True), (np.pi, False)):
        yaw = np.arctan2(away[1], away[0]) + turn
        quaternion = jnp.array([np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2)], jnp.float32)
        facing = now._replace(sim=now.sim._replace(xquat=now.sim.xquat.at[1].set(quaternion)))
        assert bool(task.in_view(facing, 1.0)[0]) is seen
        assert not bool(task.in_view(facing, 0.1)[0]), "farther than asked"


# Scores, rewards, observations.


def test_scores_are_spl_and_the_distance_left(env: NavEnv, task: ObjectGoal, begun: Any) -> None:
    nav = stepped(env, one(begun))
    long = nav._replace(driven=2.0 * nav.route_length, result=jnp.int32(Result.GOAL))
    assert float(task.scores(long)["score"]) == pytest.approx(0.5)
    short = nav._replace(driven=0.5 * nav.route_length, result=jnp.int32(Result.GOAL))
    assert float(task.scores(short)["score"]) == pytest.approx(1.0), "stopped before the end of the path"
    assert float(task.scores(nav._replace(result=jnp.int32(Result.STOPPED)))["score"]) == 0.0
    left = float(task.scores(nav)["distance_to_success"])
    assert left == pytest.approx(float(nav.task.distance) - 1.0, abs=1e-5)
    there = stepped(env, at(nav, nav.goal[:2]))
    assert float(task.scores(there)["distance_to_success"]) == 0.0


def test_rewards(env: NavEnv, task: ObjectGoal, begun: Any) -> None:
    nav = one(begun)
    values = {}
    for name, state in {"there": at(nav, nav.goal[:2]), "fast": at(nav, nav.goal[:2], 0.5), "off": nav}.items():
        values[name] = float(task.rewards(nav, stepped(env, state))["at_object"])
    assert values == {"there": 1.0, "fast": pytest.approx(0.5), "off": 0.0}
    assert float(task.rewards(nav, nav._replace(result=jnp.int32(Result.STOPPED)))["stopped"]) == 1.0
    assert float(task.rewards(nav, nav._replace(result=jnp.int32(Result.GOAL)))["stopped"]) == 0.0


def test_the_goal_is_the_phrase_and_no_place(env: NavEnv, task: ObjectGoal, begun: Any) -> None:
    assert env.observation_size["goal"] == (EMBEDDING_SIZE,)
    for row in (0, 5):
        nav = one(begun, row)
        goal = env.observe(nav)["goal"]
        np.testing.assert_array_equal(goal, embedding(task.goal_name(0, row)))
        moved = at(nav, nav.start[:2] + 1.0)
        np.testing.assert_array_equal(env.observe(moved)["goal"], goal, "it does not depend on where the robot is")
    names = dict(zip(env.observe(nav), env.observe(at(nav, nav.goal[:2])).values(), strict=True))
    assert names["privileged"].shape == (env.observation_size["privileged"][0],)


def test_networks_and_mirrors_leave_a_phrase_as_it_is() -> None:
    goal = jnp.arange(8.0).reshape(2, 4)
    np.testing.assert_array_equal(goal_features(goal), goal)
    obs = {"pixels/front": jnp.zeros((2, 3, 4, 3), jnp.uint8), "goal": goal, "proprio": jnp.ones((2, 5))}
    seen = mirrored_view(obs, jnp.array([True, False]))
    np.testing.assert_array_equal(seen["goal"], goal)
    assert float(seen["proprio"][0, 1]) == -1.0


def test_agents_that_drive_to_a_vector_refuse_a_phrase(env: NavEnv, begun: Any) -> None:
    with pytest.raises(ValidationError, match="found a goal of 160 numbers, such as a phrase's"):
        go_to_goal(env.observe(one(begun)), jax.random.key(0))


# Whole episodes.


@pytest.mark.extended
def test_who_stands_still_stops_elsewhere(env: NavEnv) -> None:
    results, _ = Rollout(env, chunk=10).run({"zero": zero}, fixed_episodes(env, 3))
    assert {r.result for r in results} == {"stopped"}
    assert {r.steps for r in results} == {5}


def test_the_wanderer_follows_the_route_until_it_sees_the_object(env: NavEnv, begun: Any) -> None:
    """It drives to what it sees, else to 3.5 m ahead on its route; it stops within reach, or where the route ends."""
    agent, nav = ObjectWanderer(env), one(begun)
    route = jnp.array([[10.0, 0.0, 0.0], [10.0, 10.0, 0.0], [10.0, 10.0, 0.0]])
    aim = jnp.array([3.0, 4.0])
    agent.towards = lambda nav, place: place  # type: ignore[method-assign]
    reach = float(env.task.reach)  # type: ignore[attr-defined]
    asked = []
    for at, sees, reached, distance, expected in (
        ((2.0, 0.5), False, False, 9.0, (5.5, 0.0)),
        ((8.0, 0.0), False, False, 9.0, (10.0, 1.5)),
        ((2.0, 0.5), True, False, 9.0, (3.0, 4.0)),
        ((2.0, 0.5), True, True, reach - 0.06, (0.0, 0.0)),
        ((2.0, 0.5), True, True, reach - 0.04, (3.0, 4.0)),
        ((2.0, 0.5), True, False, reach - 0.06, (3.0, 4.0)),
        ((10.0, 9.1), False, False, 9.0, (0.0, 0.0)),
        ((10.0, 8.9), False, False, 9.0, (10.0, 10.0)),
        ((10.0, 9.1), True, False, 9.0, (3.0, 4.0)),
    ):
        agent._task = types.SimpleNamespace(  # type: ignore[assignment]
            reach=reach, in_view=lambda nav, far, sees=sees: asked.append(far) or (jnp.bool_(sees), aim)
        )
        state = nav.task._replace(reached=jnp.bool_(reached), distance=jnp.float32(distance))
        sim = nav.sim._replace(xpos=nav.sim.xpos.at[agent._root, :2].set(jnp.array(at)))
        action = agent.act(nav._replace(sim=sim, task=state, start=jnp.zeros(4)), route)
        np.testing.assert_allclose(action, expected, atol=1e-4, err_msg=f"{at} {sees} {reached} {distance}")
    assert set(asked) == {8.0}, "m at which it recognises an object"


def test_the_planner_drives_the_last_metre_straight_and_stops_within_reach(
    env: NavEnv, begun: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    agent, nav = ObjectPlanner(env), one(begun)
    monkeypatch.setattr(Planner, "act", lambda *_: jnp.array([0.7, -0.2]))
    reach, yaw = float(env.task.reach), 0.6  # type: ignore[attr-defined]
    turn = jnp.array([np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2)])
    for ahead, reached, distance, expected in (
        ((1.5, 0.2), False, 9.0, (0.7, -0.2)),
        ((0.6, 0.4), False, 9.0, (0.3 * 0.6 / np.hypot(0.6, 0.4), 0.3 * 0.4 / np.hypot(0.6, 0.4))),
        ((0.6, 0.4), True, reach - 0.06, (0.0, 0.0)),
        ((0.6, 0.4), False, reach - 0.06, (0.3 * 0.6 / np.hypot(0.6, 0.4), 0.3 * 0.4 / np.hypot(0.6, 0.4))),
        ((1.5, 0.2), True, reach - 0.04, (0.7, -0.2)),
    ):
        c, s = np.cos(yaw), np.sin(yaw)
        place = nav.goal[:2] - jnp.array([c * ahead[0] - s * ahead[1], s * ahead[0] + c * ahead[1]])
        root = agent._root
        sim = nav.sim._replace(xpos=nav.sim.xpos.at[root, :2].set(place), xquat=nav.sim.xquat.at[root].set(turn))
        state = nav.task._replace(reached=jnp.bool_(reached), distance=jnp.float32(distance))
        action = agent.act(nav._replace(sim=sim, task=state), None)  # type: ignore[arg-type]
        np.testing.assert_allclose(action, expected, atol=1e-4, err_msg=f"{ahead} {reached} {distance}")


@pytest.mark.slow
def test_the_planner_finds_and_the_wanderer_mostly_does_not(env: NavEnv) -> None:
    agents = {"wander": baseline_of(env)[1], "planner": planner_of(env)}
    assert isinstance(agents["planner"], ObjectPlanner)
    assert isinstance(agents["wander"], ObjectWanderer)
    results, _ = Rollout(env, chunk=20).run(agents, fixed_episodes(env, 12))
    found = {name: [r.result == "goal" for r in results if r.agent == name] for name in agents}
    assert np.mean(found["planner"]) > 0.6
    assert np.mean(found["planner"]) > np.mean(found["wander"]) + 0.2


@pytest.mark.slow
def test_check_env_accepts_it(env: NavEnv) -> None:
    check_env(env, num_envs=4, num_steps=6)


@pytest.mark.slow
@pytest.mark.parametrize("impl", ["jax", "warp-fused"])
def test_in_both_engines_a_robot_that_is_set_beside_its_object_and_stands_has_found_it(
    small_bank: SceneBank, impl: str
) -> None:
    options = {"preset": "cpu", "vision": False, "scenes": "all", "impl": impl, **SHORT, "terminate_on_hit": False}
    env = registry.load_nav_env(
        "CocoObjectGoal",
        registry.with_overrides(registry.get_default_config("CocoObjectGoal", "cpu"), _without_preset(options)),
        small_bank,
    )
    step = jax.jit(jax.vmap(env.advance))
    keys, rows = jax.random.split(jax.random.key(0), 2), jnp.array([0, 1])
    nav = jax.jit(jax.vmap(env.begin_at))(keys, jnp.zeros(2, jnp.int32), rows)
    qpos = nav.sim.qpos.at[0, :3].set(nav.goal[0] + jnp.array([0.0, 0.0, env.robot.spawn_height]))
    nav = nav._replace(sim=nav.sim._replace(qpos=qpos))
    ended = np.zeros(2, int)
    for _ in range(15):
        nav, *_ = step(nav, jnp.zeros((2, 2)))
        ended = np.where(ended == 0, np.asarray(nav.result), ended)
    assert ended.tolist() == [Result.GOAL, Result.STOPPED]


def _without_preset(options: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in options.items() if name != "preset"}


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        ({"task.path_length": (20.0, 10.0)}, "config.task.path_length: found 20 to 10 m"),
        ({"task.path_length": (200.0, 300.0)}, "found no object at the end of a path of 200 to 300 m"),
        ({"task.success_distance": 0.4}, "config.task.success_distance: found 0.4 m, needed more than the robot's"),
        ({"task.stop_time": 0.1}, "config.task.stop_time: found 0.1 s, needed at least a control step, 0.2 s"),
        ({"task.name": "find"}, "config.task.name: found 'find'"),
    ],
)
def test_bad_configurations_are_refused_in_a_sentence(
    small_bank: SceneBank, overrides: dict[str, Any], words: str
) -> None:
    with pytest.raises(ValidationError, match=words):
        unicycle_env(small_bank, {**SHORT, **overrides}, config=object_goal_config())
