"""`FollowRoute`: its routes, signals, ends and scores, and configurations that are refused."""

import dataclasses
import functools
import itertools
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.support.compiling import optimized
from tests.support.task_figures import check_task
from tests.support.unicycle import unicycle_env
from urbanverse_mjx.crowds.crossings import CLEAR, STOP, UNSIGNALLED, WALK
from urbanverse_mjx.datatypes import KIND_INDEX, SceneBank, ValidationError
from urbanverse_mjx.envs import NavEnv, Result, check_env, registry
from urbanverse_mjx.envs.navigation.clear_arcs import ARCS, ClearArcs
from urbanverse_mjx.envs.navigation.tasks import routes
from urbanverse_mjx.envs.navigation.tasks.config import follow_route_config
from urbanverse_mjx.envs.navigation.tasks.crosswalks import rectangles
from urbanverse_mjx.envs.navigation.tasks.people import UNIT
from urbanverse_mjx.envs.navigation.tasks.route import DISTANCE_UNIT, OBSERVED, FollowRoute, RouteState
from urbanverse_mjx.evaluation.agents import go_to_goal
from urbanverse_mjx.evaluation.task_agents import SignalPlanner, baseline_of, planner_of
from urbanverse_mjx.geometry import rotations
from urbanverse_mjx.robots import make_coco
from urbanverse_mjx.robots.footprint import footprint

FEW = {f"crowd.slots.{kind}": 0 for kind in ("wheelchair", "cyclist")}
FEW |= {"crowd.slots.pedestrian": 2, "crowd.slots.car": 1, "task.length": 60.0, "episode_length": 400}


@pytest.fixture(scope="module")
def env(small_bank: SceneBank) -> NavEnv:
    with optimized():  # the crowd's tables take seconds
        return unicycle_env(small_bank, {**FEW, "scenes": small_bank.scene_ids[0]}, config=follow_route_config())


@pytest.fixture(scope="module")
def task(env: NavEnv) -> FollowRoute:
    assert isinstance(env.task, FollowRoute)
    return env.task


@pytest.fixture(scope="module")
def begun(env: NavEnv) -> Any:
    return jax.jit(env.begin_at)(jax.random.key(0), jnp.int32(0), jnp.int32(0))


def test_figures_of_the_task(env: NavEnv, begun: Any) -> None:
    check_task(env, begun)


def at(nav: Any, xy: tuple[float, float]) -> Any:
    return nav._replace(sim=nav.sim._replace(xpos=nav.sim.xpos.at[1, :2].set(jnp.array(xy))))


def after(env: NavEnv, nav: Any, xy: tuple[float, float]) -> Any:
    """The state after a step to a point (m)."""
    moved = at(nav, xy)
    changes = env.task.advance(nav, moved.sim, nav.crowd)
    return moved._replace(**changes, steps=nav.steps + 1)


def with_time(nav: Any, seconds: float) -> Any:
    """A state in which the signals of all crosswalks began to walk some seconds ago."""
    return nav._replace(task=nav.task._replace(offset=jnp.full_like(nav.task.offset, seconds)), steps=jnp.int32(0))


def test_routes_are_long_lead_over_the_crosswalk_and_stay_where_a_robot_may_be(env: NavEnv) -> None:
    bank, scene = env.bank, int(env.scenes[0])
    (row,) = rectangles(bank, scene)
    assert int(bank.num_episodes[scene]) == 64
    for k in range(0, 64, 9):
        count = int(bank.episode_num_waypoints[scene, k])
        line = np.concatenate([bank.episode_start[scene, k, None, :2], bank.episode_waypoints[scene, k, :count, :2]])
        span = np.linalg.norm(np.diff(line, axis=0), axis=-1)
        assert 60.0 <= span.sum() < 80.0
        assert span.sum() == pytest.approx(float(bank.episode_length[scene, k]), rel=1e-5)
        assert span.max() < 5.3
        np.testing.assert_allclose(bank.episode_goal[scene, k], bank.episode_waypoints[scene, k, count - 1])
        points = np.concatenate([np.linspace(a, b, 20) for a, b in itertools.pairwise(line)])
        assert row.holds(points).any()
        assert not row.holds(line[[0, -1]], 1.0).any(), "nobody begins or ends at the kerb"
        cells = np.floor((points - bank.map_origin[scene]) / float(bank.map_resolution)).astype(int)
        kinds = set(np.unique(bank.map_kind[scene][tuple(cells.T)]).tolist())
        assert kinds <= {KIND_INDEX["sidewalk"], KIND_INDEX["crosswalk"]}


def test_scenes_that_are_not_used_keep_an_episode_and_the_bank_stays_as_it_was(
    env: NavEnv, small_bank: SceneBank
) -> None:
    assert env.bank.num_episodes.tolist() == [64, 1, 1]
    np.testing.assert_array_equal(env.bank.episode_start[1, 0], small_bank.episode_start[1, 0])
    assert int(small_bank.num_episodes[0]) != 64


def test_ways_cost_their_metres_times_their_prices(small_bank: SceneBank) -> None:
    """Edge by edge: 1 per metre far from everything, up to 2.5 beside a wall, lawn dearer; only where a robot fits."""
    robot = make_coco()
    ground = routes._Ground(small_bank, 0, robot)
    half = routes._OPTIONS.width_share * robot.planner_radius
    edges = ground.graph.edges.tocoo()
    rng = np.random.default_rng(0)
    lawn = KIND_INDEX["ground"]
    plain = 0
    for k in rng.choice(edges.nnz, 500, replace=False):
        ends = ground.graph.cells[[edges.row[k], edges.col[k]]]
        metres = routes.NODE * float(np.linalg.norm(ends[0] - ends[1]))
        prices = []
        for i, j in ends:
            clear = float(ground.clear[i, j])
            assert clear >= half + routes._OPTIONS.slack - 1e-5
            price = 1.0 + 1.5 * min(max(1.0 - (clear - half) / 0.6, 0.0), 1.0)
            prices.append(price * (routes._OPTIONS.lawn_cost if ground.kind[i, j] == lawn else 1.0))
        assert edges.data[k] == pytest.approx(metres * np.mean(prices), rel=1e-4)
        plain += prices == [1.0, 1.0]
    assert plain > 20


def test_routes_are_the_same_when_they_are_made_again(
    env: NavEnv, small_bank: SceneBank, monkeypatch: pytest.MonkeyPatch, tmp_path: Any
) -> None:
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path))
    named = np.array([0], np.int32)
    again, scenes, _ = FollowRoute.episodes(env.config, small_bank, env.robot, named)
    assert scenes.tolist() == [0]
    np.testing.assert_array_equal(again.episode_waypoints, env.bank.episode_waypoints)
    np.testing.assert_array_equal(again.episode_start, env.bank.episode_start)


@pytest.mark.parametrize(
    ("seconds", "phase", "violations"), [(5.0, WALK, 0.0), (21.0, CLEAR, 1.0), (40.0, STOP, 1.0), (59.9, WALK, 0.0)]
)
def test_entering_a_crosswalk_counts_by_its_phase(
    env: NavEnv, task: FollowRoute, begun: Any, seconds: float, phase: int, violations: float
) -> None:
    nav = with_time(at(begun, (30.0, -4.5)), seconds)
    new = after(env, nav, (30.0, -3.9))  # a step of 0.2 s later: 59.9 s is 0.1 s
    assert int(task.phases(jnp.int32(0), new.task.offset, new.steps)[0]) == phase
    assert (float(new.task.entries), float(new.task.violations)) == (1.0, violations)
    assert float(task.rewards(nav, new)["violation"]) == violations
    # On it, at its border and 0.4 m beside it, it is the same crossing; beyond that it is left.
    for xy, inside in (((30.0, 0.0), 0), ((30.0, 4.4), 0), ((30.0, 3.9), 0), ((30.0, 4.6), -1)):
        new = after(env, new, xy)
        assert int(new.task.inside) == inside
        assert float(new.task.entries) == 1.0
        assert not bool(new.task.violated)


def test_the_light_of_the_next_crosswalk_is_observed(env: NavEnv, task: FollowRoute, begun: Any) -> None:
    arc = float(task._arc[0, 0, 0])
    nav = with_time(begun, 45.0)._replace(route_done=jnp.float32(arc - 6.0))
    light = task.light(nav)
    assert (int(light.phase), int(light.row), bool(light.on)) == (STOP, 0, False)
    assert float(light.to_walk) == pytest.approx(15.0, abs=1e-3)
    assert float(light.distance) >= 6.0 - 1e-3
    values = np.asarray(env._proprio(nav))[3:8]
    np.testing.assert_allclose(values, [float(light.distance) / 20.0, 0.0, 0.0, 0.5, 0.0], atol=1e-4)
    np.testing.assert_allclose(env.observe(nav)["privileged"][43:48], values, atol=1e-6)
    on = after(env, with_time(at(nav, (30.0, -4.2)), 4.8), (30.0, 0.0))
    np.testing.assert_allclose(env._proprio(on)[3:8], [0.0, 1.0, 1.0, 0.0, 15.0 / 30.0], atol=1e-4)
    done = begun._replace(route_done=begun.route_length)
    assert int(task.light(done).phase) == UNSIGNALLED
    np.testing.assert_allclose(env._proprio(done)[3:8], [1.0, 0.0, 1.0, 0.0, 1.0])


def test_the_nearest_agents_are_observed_in_the_heading_frame(env: NavEnv, begun: Any) -> None:
    assert env.dynamic is not None
    robot, bodies = env.task.pose(begun.sim), begun.crowd.bodies
    rows = np.asarray(env.observe(begun)["privileged"][48:]).reshape(-1, 5)
    gaps = np.asarray(env.dynamic.gaps(begun.crowd, robot.xy))
    here = np.isfinite(np.sort(gaps))
    assert len(rows) == min(OBSERVED, len(gaps)) == 3
    assert 0 < here.sum() < 3, "agents in this street, and one that waits for its turn"
    np.testing.assert_array_equal(rows[:, 4], here)
    assert np.all(rows[~here] == 0.0)
    turn = np.array([[np.cos(robot.yaw), np.sin(robot.yaw)], [-np.sin(robot.yaw), np.cos(robot.yaw)]])
    away = (np.stack([bodies.x, bodies.y], -1) - robot.xy) @ turn.T
    speed = (np.stack([bodies.vx, bodies.vy], -1) - robot.velocity) @ turn.T
    order = np.argsort(gaps)[here]
    np.testing.assert_allclose(rows[here, :2], np.clip(away[order] / UNIT, -2.0, 2.0), atol=1e-5)
    np.testing.assert_allclose(rows[here, 2:4], speed[order], atol=1e-5)


@pytest.mark.parametrize(("preset", "told"), [("paper", False), ("cpu", False), ("quick", True), ("best", True)])
def test_teachers_are_told_which_arcs_are_free(preset: str, told: bool) -> None:
    assert follow_route_config(preset).observations.clear_arcs is told


def test_its_teacher_looks_as_far_ahead_as_a_cycle_lasts() -> None:
    assert registry.get_ppo_config("CocoFollowRoute", "best").teacher.discounting == 0.995
    assert registry.get_ppo_config("CocoNav", "best").teacher.discounting == 0.99
    assert registry.get_ppo_config("CocoFollowRoute", "paper") == registry.get_ppo_config("CocoNav", "paper")


@pytest.mark.extended
def test_free_arcs_follow_the_other_values(small_bank: SceneBank, env: NavEnv, begun: Any) -> None:
    options = {**FEW, "scenes": small_bank.scene_ids[0], "observations.clear_arcs": True}
    with optimized():
        other = unicycle_env(small_bank, options, config=follow_route_config())
    # Turned by a quarter, beside the edge of the first object.
    turned = jnp.array([np.cos(np.pi / 4), 0.0, 0.0, np.sin(np.pi / 4)])
    objects = small_bank.inst_position[0, small_bank.inst_hull[0] >= 0, :2]
    nav = at(begun, tuple(objects[0] + np.array([0.9, -0.9])))
    nav = nav._replace(sim=nav.sim._replace(xquat=nav.sim.xquat.at[1].set(turned)))
    without, with_them = env.observe(nav)["privileged"], other.observe(nav)["privileged"]
    arcs = ClearArcs(small_bank, footprint(env.robot).discs, env.robot.planner_height)
    place, yaw = nav.sim.xpos[1, :2], rotations.yaw_of(nav.sim.xquat[1])
    told = arcs.observe(nav.sim.scene, place, yaw)
    np.testing.assert_allclose(with_them[: len(without)], without)
    np.testing.assert_allclose(with_them[len(without) : len(without) + 2 * ARCS], told)
    assert np.abs(told - arcs.observe(nav.sim.scene, place, -yaw)).max() > 0.1, "a heading that makes a difference"
    assert len(with_them) - len(without) == 4 * ARCS
    assert env.dynamic is not None
    both = arcs.observe(nav.sim.scene, place, yaw, functools.partial(env.dynamic.gaps, nav.crowd))
    np.testing.assert_allclose(with_them[len(without) :], both)


def test_progress_counts_on_the_way_to_the_next_waypoint_only(env: NavEnv, task: FollowRoute, begun: Any) -> None:
    corners = np.concatenate([np.asarray(begun.start)[None, :2], np.asarray(begun.waypoints)[:, :2]])
    ends = np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=-1))
    first, third = (begun._replace(waypoint=jnp.int32(k)) for k in (0, 3))
    middle = 0.5 * (corners[3] + corners[4])
    assert float(task.position(third, jnp.asarray(middle))) == pytest.approx(0.5 * (ends[2] + ends[3]), abs=1e-3)
    assert float(task.position(first, jnp.asarray(corners[-1]))) == 0.0, "the goal is not reached past the others"
    assert float(task.position(third, jnp.asarray(corners[0]))) >= ends[2] - 1e-3


@pytest.mark.parametrize(
    ("waypoint", "steps", "base", "end"),
    [
        (3, 10, Result.GOAL, Result.RUNNING),
        (3, 400, Result.GOAL, Result.TIMEOUT),
        (-1, 10, Result.GOAL, Result.GOAL),
        (3, 10, Result.HIT, Result.HIT),
        (-1, 400, Result.TIMEOUT, Result.TIMEOUT),
        (3, 10, Result.RUNNING, Result.RUNNING),
    ],
)
def test_ends(env: NavEnv, begun: Any, waypoint: int, steps: int, base: Result, end: Result) -> None:
    row = waypoint if waypoint >= 0 else int(begun.num_waypoints) + waypoint
    nav = begun._replace(waypoint=jnp.int32(row), steps=jnp.int32(steps))
    assert int(env.task.result(nav, jnp.int32(base))) == end


@pytest.mark.parametrize(
    ("result", "agent", "violations", "factor"),
    [
        (Result.TIMEOUT, -1, 0.0, 1.0),
        (Result.TIMEOUT, -1, 2.0, 0.49),
        (Result.HIT, -1, 0.0, 0.65),
        (Result.HIT_AGENT, 0, 1.0, 0.35),  # a pedestrian: 0.5, and 0.7
        (Result.HIT_AGENT, 2, 0.0, 0.60),  # the car behind two pedestrians
    ],
)
def test_the_score_is_the_completed_share_times_factors(
    env: NavEnv, task: FollowRoute, begun: Any, result: Result, agent: int, violations: float, factor: float
) -> None:
    assert env.dynamic is not None
    assert env.dynamic.kinds == ("pedestrian", "pedestrian", "car")
    state = begun.task._replace(violations=jnp.float32(violations), entries=jnp.float32(3.0), standing=jnp.float32(4.0))
    contacts = begun.sim.contacts._replace(hit_agent=jnp.int32(agent))
    nav = begun._replace(
        sim=begun.sim._replace(contacts=contacts),
        task=state,
        result=jnp.int32(result),
        route_done=0.5 * begun.route_length,
        steps=jnp.int32(50),
    )
    scores = {name: float(x) for name, x in task.scores(nav).items()}
    assert scores == pytest.approx(
        {"score": 0.5 * factor, "violations": violations, "crossings": 3.0, "standing": 4.0, "seconds": 10.0}
    )


def test_signals_hold_people_and_vehicles_and_drivers_stop_for_the_robot(task: FollowRoute, begun: Any) -> None:
    for seconds, phase in ((5.0, WALK), (21.0, CLEAR), (40.0, STOP)):
        rights = task.rights(with_time(begun, seconds))
        assert int(rights.phase[task.crosswalks.number[0, 0]]) == phase
        assert int(rights.phase[0]) == UNSIGNALLED
        assert bool(rights.walks)


@pytest.mark.extended
def test_an_episode_is_the_same_when_it_is_run_again(env: NavEnv) -> None:
    begin = jax.jit(lambda key: env.begin_at(key, jnp.int32(0), jnp.int32(3)))
    first, second, other = begin(jax.random.key(1)), begin(jax.random.key(1)), begin(jax.random.key(2))
    assert isinstance(first.task, RouteState)
    np.testing.assert_array_equal(first.task.offset, second.task.offset)
    assert float(first.task.offset[0]) != float(other.task.offset[0])
    step = jax.jit(lambda nav: env.advance(nav, jnp.array([0.5, 0.1]))[0])
    for _ in range(3):
        first, second = step(first), step(second)
    for a, b in zip(jax.tree.leaves((first.sim, first.task)), jax.tree.leaves((second.sim, second.task)), strict=True):
        np.testing.assert_array_equal(a, b)


def test_the_planner_may_not_enter_crosswalks_while_their_signals_forbid_it(env: NavEnv, begun: Any) -> None:
    planner = planner_of(env)
    assert isinstance(planner, SignalPlanner)
    assert baseline_of(env) == ("go_to_goal", go_to_goal)
    for seconds, xy, closed in (
        (5.0, (30.0, -6.0), False),
        (19.0, (30.0, -6.0), True),  # 2 m before it, with a second to enter it
        (21.0, (30.0, -6.0), True),
        (40.0, (30.0, -6.0), True),
        (59.9, (30.0, -6.0), True),
    ):
        assert bool(planner.closed(with_time(at(begun, xy), seconds))[0]) == closed, seconds
    on = after(env, with_time(at(begun, (30.0, -4.5)), 5.0), (30.0, -3.9))
    assert not bool(planner.closed(with_time(on, 40.0))[0]), "it leaves the crosswalk on which it is"


def posed(env: NavEnv, nav: Any, xy: tuple[float, float], yaw: float, seconds: float) -> Any:
    """A state in which the robot stands at a point (m) and heading, after the step that leads there."""
    new = after(env, with_time(nav, seconds - env.dt), xy)
    turned = jnp.array([np.cos(0.5 * yaw), 0.0, 0.0, np.sin(0.5 * yaw)])
    return new._replace(sim=new.sim._replace(xquat=new.sim.xquat.at[1].set(turned)))


@pytest.fixture(scope="module")
def planner(env: NavEnv) -> SignalPlanner:
    planner = planner_of(env)
    assert isinstance(planner, SignalPlanner)
    return planner


@pytest.fixture(scope="module")
def legs(planner: SignalPlanner) -> Any:
    """The planner's data of the first route."""
    return jax.tree.map(lambda x: x[0], planner.prepare(np.array([0], np.int32), np.array([0], np.int32)))


@pytest.mark.extended
def test_the_planners_cost_leads_past_every_waypoint(planner: SignalPlanner, legs: Any, begun: Any) -> None:
    places, rest = np.asarray(legs.places), np.asarray(legs.rest)
    left = np.append(np.linalg.norm(np.diff(places, axis=0), axis=-1)[::-1].cumsum()[::-1], 0.0)
    assert (np.diff(rest) < 0.0).all()
    assert (rest >= 0.9 * left - 1.0).all()
    assert rest[0] < 3.0 * left[0]
    for k in range(len(places) - 1):
        # From one waypoint to the next, and past the one that is missing.
        assert float(legs.on(k + 1).at(legs.places[k])) == pytest.approx(rest[k], abs=1e-3)
        assert float(legs.on(k).at(legs.places[k + 1])) > rest[k] + 0.9 * np.linalg.norm(places[k + 1] - places[k]) - 1
        assert int(legs.part(jnp.int32(k), legs.places[k])) == k + 1
    assert int(legs.part(jnp.int32(len(places) - 1), legs.places[-1])) == len(places) - 1
    far = legs.places[0] + jnp.array([2.1, 0.0])
    assert int(legs.part(jnp.int32(0), far)) == 0
    assert float(legs.at(begun.start[:2])) > rest[0]


@pytest.fixture(scope="module")
def before_crosswalk(env: NavEnv, begun: Any) -> Any:
    """Where the first route comes to the crosswalk: m before it, seconds and m/s -> the state there."""
    arc = float(env.task._arc[0, 0, 0])  # type: ignore[attr-defined]
    corners = np.concatenate([np.asarray(begun.start)[None, :2], np.asarray(begun.waypoints)[:, :2]])
    ends = np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=-1))
    k = int(np.searchsorted(ends, arc))
    along = (corners[k + 1] - corners[k]) / np.linalg.norm(corners[k + 1] - corners[k])
    yaw = float(np.arctan2(along[1], along[0]))

    def state(metres: float, seconds: float, speed: float) -> Any:
        xy = corners[k] + (arc - (ends[k - 1] if k else 0.0) - metres) * along
        nav = posed(env, begun, tuple(xy), yaw, seconds)
        nav = nav._replace(waypoint=jnp.int32(k), route_done=jnp.float32(arc - metres))
        return nav._replace(sim=nav.sim._replace(qvel=nav.sim.qvel.at[:2].set(speed * along)))

    return state


@pytest.fixture(scope="module")
def act(planner: SignalPlanner, legs: Any) -> Any:
    return jax.jit(lambda nav: planner.act(nav, legs)[0])


@pytest.mark.extended
def test_the_planner_waits_before_a_closed_crosswalk_and_enters_an_open_one(before_crosswalk: Any, act: Any) -> None:
    """It stands as long as it is closed, whatever lies behind."""
    for seconds, enters in ((5.0, True), (21.0, False), (40.0, False), (59.0, False), (60.5, True)):
        forward = float(act(before_crosswalk(0.85, seconds, 0.0)))
        assert (forward > 0.3) if enters else (forward < 0.02), (seconds, forward)


@pytest.mark.parametrize(("metres", "speed"), [(1.9, 0.0), (0.8, 0.7), (0.8, 0.4), (0.5, 0.4), (0.3, 0.0)])
def test_a_robot_that_stops_too_near_to_a_closed_crosswalk_does_not_drive_on(
    before_crosswalk: Any, act: Any, metres: float, speed: float
) -> None:
    """It comes nearer than it should whatever it does, which is no reason to enter."""
    assert float(act(before_crosswalk(metres, 40.0, speed))) < 0.02


@pytest.mark.parametrize(
    ("y", "yaw", "end"),
    [(-3.0, np.pi / 2, -4.0), (-3.0, -np.pi / 2, -4.0), (1.0, np.pi / 2, 4.0), (-0.5, np.pi / 2, 4.0)],
)
def test_the_planner_leaves_a_crosswalk_by_the_shorter_way(
    env: NavEnv, planner: SignalPlanner, begun: Any, y: float, yaw: float, end: float
) -> None:
    """In time: ahead to a far end takes no turn, and 0.5 m from the middle a turn takes longer than the way on."""
    on = after(env, with_time(at(begun, (30.0, -4.5)), 5.0), (30.0, -3.9))
    for seconds, leaves in ((10.0, False), (22.0, False), (40.0, True)):
        nav = posed(env, on, (30.0, y), yaw, seconds)
        place, outwards = planner._exit(nav)
        np.testing.assert_allclose(outwards, [0.0, leaves * np.sign(end)], atol=0.02)
        if leaves:
            np.testing.assert_allclose(place, [30.0, end], atol=0.2)
    beside = posed(env, on, (30.0, -4.3), yaw, 40.0)
    assert not np.any(planner._exit(beside)[1]), "it is out"


@pytest.mark.slow
def test_check_env_accepts_it(env: NavEnv) -> None:
    # No env comes onto a crosswalk in this time, and no agent comes or goes.
    constants = {"privileged": 3, "privileged_state": 3, "state": 1}
    check_env(env, num_envs=4, num_steps=6, constants=constants)


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        ({"task.length": 5.0}, "config.task.length: found 5 m, needed 20 to 1000 m"),
        ({"task.walk": 3.0}, "config.task.walk: found 3 s, needed at least 7 s"),
        ({"task.cycle": 22.0}, "config.task.cycle: found 22 s, needed more than the 27.5 s"),
        ({"goal_mode": "final"}, "config.goal_mode: found 'final' for the task 'follow_route', needed 'waypoint'"),
    ],
)
def test_bad_configurations_are_refused_in_a_sentence(
    small_bank: SceneBank, overrides: dict[str, Any], words: str
) -> None:
    scenes = {"scenes": small_bank.scene_ids[0], "scenario": "static"}
    with pytest.raises(ValidationError, match=words):
        unicycle_env(small_bank, {**FEW, **scenes, **overrides}, config=follow_route_config())


def test_scenes_without_a_crosswalk_are_refused_in_a_sentence(small_bank: SceneBank) -> None:
    road = KIND_INDEX["road"]
    kinds = np.where(small_bank.map_kind == KIND_INDEX["crosswalk"], road, small_bank.map_kind).astype(np.uint8)
    bank = dataclasses.replace(small_bank, map_kind=kinds)
    with pytest.raises(
        ValidationError, match=r"config.scenes: found none of 1 \(\w+\) with a crosswalk between pavements"
    ):
        unicycle_env(bank, {**FEW, "scenes": bank.scene_ids[0], "scenario": "static"}, config=follow_route_config())


def test_streets_without_a_crosswalk_are_used_where_that_is_asked(small_bank: SceneBank) -> None:
    # The last street has its crosswalk no more.
    kinds = np.array(small_bank.map_kind)
    kinds[-1][kinds[-1] == KIND_INDEX["crosswalk"]] = KIND_INDEX["road"]
    bank = dataclasses.replace(small_bank, map_kind=kinds)
    scenes, robot, last = np.arange(bank.num_scenes, dtype=np.int32), make_coco(), bank.num_scenes - 1
    strict, few = routes.with_long_routes(bank, scenes, robot, 60.0)
    wide, all_ = routes.with_long_routes(bank, scenes, robot, 60.0, needs_crosswalk=False)
    np.testing.assert_array_equal(few, scenes[:-1])
    np.testing.assert_array_equal(all_, scenes)
    # The others have the same routes.
    most = strict.episode_waypoints.shape[2]
    for name in ("episode_start", "episode_num_waypoints", "episode_length", "num_episodes"):
        np.testing.assert_array_equal(getattr(wide, name)[:-1], getattr(strict, name)[:-1])
    np.testing.assert_array_equal(wide.episode_waypoints[:-1, :, :most], strict.episode_waypoints[:-1])
    # In the last one the robot stays on its pavement.
    assert int(wide.num_episodes[last]) == 64
    assert float(wide.episode_length[last].min()) >= 60.0
    for row in range(64):
        points = wide.episode_waypoints[last, row, : int(wide.episode_num_waypoints[last, row]), :2]
        cells = np.floor((points - bank.map_origin[last]) / float(bank.map_resolution)).astype(int)
        assert (kinds[last][tuple(cells.T)] == KIND_INDEX["sidewalk"]).all()
    options = {**FEW, "scenes": bank.scene_ids[last], "scenario": "static", "task.needs_crosswalk": False}
    env = unicycle_env(bank, options, config=follow_route_config())
    assert isinstance(env.task, FollowRoute)
    state = jax.jit(env.step)(jax.jit(env.reset)(jax.random.key(0)), jnp.zeros(2))
    light = env.task.light(state.data)
    assert (int(light.row), int(light.phase), float(light.distance)) == (-1, UNSIGNALLED, DISTANCE_UNIT)
    assert float(state.data.task.violations) == 0.0


def _corners_one_by_one(points: np.ndarray) -> list[int]:
    """`routes._corners`, one point after the other."""
    found = [0]
    while found[-1] < len(points) - 1:
        first, end = found[-1], found[-1] + 1
        for k in range(first + 2, len(points)):
            chord = points[k] - points[first]
            length = float(np.hypot(*chord))
            if not routes.NODE <= length <= routes._OPTIONS.spacing:
                break
            away = points[first + 1 : k] - points[first]
            if np.abs(away @ [-chord[1], chord[0]]).max() / length > routes._OPTIONS.tolerance:
                break
            end = k
        found.append(end)
    return found


@pytest.mark.parametrize("seed", range(6))
def test_lines_of_a_route_keep_to_its_path(seed: int) -> None:
    """Paths that run straight for longer than the points that are compared at once, turn and come back."""
    rng = np.random.default_rng(seed)
    turns = rng.normal(0.0, (0.05, 0.6)[seed % 2], 300).cumsum()
    turns[200:] += np.pi
    # Off the grid, so that no length is exactly a limit.
    points = (np.stack([np.cos(turns), np.sin(turns)], -1) * (routes.NODE, 0.03)[seed // 4]).cumsum(0)
    assert routes._corners(points) == _corners_one_by_one(points)
    assert routes._corners(points[:2]) == [0, 1]


@pytest.mark.extended
def test_many_scenes_have_the_same_routes_from_processes(
    small_bank: SceneBank, monkeypatch: pytest.MonkeyPatch
) -> None:
    scenes, robot = np.arange(small_bank.num_scenes, dtype=np.int32), make_coco()
    banks = []
    for workers in (1, 2):
        monkeypatch.setattr(routes, "workers_for", lambda *_, workers=workers: workers)
        monkeypatch.setattr(routes.array_file, "load_cached", lambda *_: None)
        banks.append(routes.with_long_routes(small_bank, scenes, robot, 60.0)[0])
    here, apart = banks
    assert int(here.num_episodes.max()) == 64
    for name in ("episode_start", "episode_waypoints", "episode_num_waypoints", "episode_length", "num_episodes"):
        np.testing.assert_array_equal(getattr(here, name), getattr(apart, name))
