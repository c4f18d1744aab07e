"""`FollowPerson`: where the person begins and is seen, how episodes end, and configurations that are refused."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.support.compiling import optimized
from tests.support.task_figures import check_task
from tests.support.unicycle import first_states, one, unicycle_env
from urbanverse_mjx.crowds.behaviours import ROAM
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs import NavEnv, Result, check_env
from urbanverse_mjx.envs.navigation import terms
from urbanverse_mjx.envs.navigation.tasks.config import follow_person_config
from urbanverse_mjx.envs.navigation.tasks.follow import FREE_RADIUS, LEADER, FollowPerson, reward_in_band
from urbanverse_mjx.evaluation import Rollout, fixed_episodes
from urbanverse_mjx.evaluation.agents import keep_distance, zero
from urbanverse_mjx.evaluation.task_agents import PersonFollower, baseline_of, planner_of

FEW = {f"crowd.slots.{kind}": 0 for kind in ("wheelchair", "cyclist", "car")}
FEW |= {"crowd.slots.pedestrian": 4, "terminate_off_traversable": False, "episode_length": 40}


@pytest.fixture(scope="module")
def env(small_bank: SceneBank) -> NavEnv:
    with optimized():  # the crowd's tables take seconds
        return unicycle_env(small_bank, FEW, config=follow_person_config())


@pytest.fixture(scope="module")
def task(env: NavEnv) -> FollowPerson:
    assert isinstance(env.task, FollowPerson)
    return env.task


@pytest.fixture(scope="module")
def begun(env: NavEnv) -> Any:
    """The first state of every episode of a scene."""
    return first_states(env)


def test_figures_of_the_task(env: NavEnv, begun: Any) -> None:
    check_task(env, begun)


def facing_east(nav: Any) -> Any:
    turn = jnp.array([1.0, 0.0, 0.0, 0.0])
    return nav._replace(sim=nav.sim._replace(xquat=nav.sim.xquat.at[1].set(turn)))


def with_people(nav: Any, places: list[tuple[float, float]]) -> Any:
    """A state with the person, then others, at (x, y) m from the robot."""
    number, xy = len(nav.crowd.present), nav.sim.xpos[1, :2]
    rows = np.array([*places, *[(99.0, 0.0)] * (number - len(places))], np.float32)
    body = nav.crowd.bodies._replace(x=xy[0] + rows[:, 0], y=xy[1] + rows[:, 1])
    return nav._replace(crowd=nav.crowd._replace(bodies=body, present=jnp.arange(number) < len(places)))


def free_place(env: NavEnv, begun: Any, reach: float) -> Any:
    """A state from whose robot nothing stands within `reach` m to the east."""
    points = np.stack([np.linspace(0.0, reach, 40), np.zeros(40)], -1)
    for row in range(len(begun.steps)):
        nav = one(begun, row)
        if float(env.task._hulls.distances(0, nav.sim.xpos[1, :2] + points)[:, 0].min()) > 0.5:  # type: ignore[attr-defined]
            return facing_east(nav)
    raise AssertionError("no such place")


@pytest.mark.extended
def test_the_person_begins_ahead_on_the_route_and_walks_along_it(env: NavEnv, begun: Any) -> None:
    body = begun.crowd.bodies
    person = np.stack([body.x[:, LEADER], body.y[:, LEADER]], -1)
    start = np.asarray(begun.start)[:, :2]
    away = np.linalg.norm(person - start, axis=-1)
    assert away.max() <= env.config.task.start_distance + 1e-4
    assert np.asarray(begun.task.in_sight).all()
    np.testing.assert_allclose(np.asarray(begun.goal)[:, :2], person, atol=1e-6)
    assert (np.asarray(begun.crowd.mode)[:, LEADER] == ROAM).all()
    speed = np.asarray(begun.crowd.speed)[:, LEADER]
    assert 0.8 <= speed.min() < speed.max() <= 1.34
    others = np.stack([body.x[:, 1:], body.y[:, 1:]], -1)
    gaps = np.linalg.norm(others - person[:, None], axis=-1)[np.asarray(begun.crowd.present)[:, 1:]]
    assert gaps.min() >= FREE_RADIUS


@pytest.mark.slow
def test_the_person_walks_away_from_the_robot(env: NavEnv, begun: Any) -> None:
    step = jax.jit(jax.vmap(lambda nav: env.advance(nav, jnp.zeros(2))[0]))
    nav = begun
    for _ in range(15):
        nav = step(nav)
    assert np.median(np.asarray(nav.goal_distance)) > env.config.task.start_distance + 1.0
    length = np.asarray(nav.route_length)
    assert (length >= np.asarray(nav.goal_distance) - 1e-3).all(), "their path is no shorter than the straight line"


@pytest.mark.parametrize(
    ("person", "others", "seen"),
    [
        ((2.0, 0.0), [], True),
        ((-2.0, 0.0), [], False),  # behind
        ((0.5, 2.0), [], False),  # beside
        ((2.5, 0.0), [(1.2, 0.2)], False),  # hidden by somebody
        ((2.5, 0.0), [(1.2, 0.4)], True),  # who stands beside the line
        ((2.5, 0.0), [(3.5, 0.0), (-1.0, 0.0)], True),  # or behind one of the ends
    ],
)
def test_who_is_in_sight(
    env: NavEnv, task: FollowPerson, begun: Any, person: tuple[float, float], others: Any, seen: bool
) -> None:
    nav = with_people(free_place(env, begun, 3.0), [person, *others])
    assert bool(task.sees(nav.sim.scene, nav.crowd, task.pose(nav.sim))) is seen


def test_the_field_of_view_is_the_cameras_and_sight_ends(env: NavEnv, task: FollowPerson, begun: Any) -> None:
    camera = env.mj_model.camera(env.robot.camera)
    tangent = np.tan(np.radians(float(camera.fovy[0])) / 2.0) * 240 / 135
    for side in (1.0, -1.0):
        for share, seen in ((0.95, True), (1.05, False)):
            nav = with_people(free_place(env, begun, 3.0), [(1.0, side * share * tangent)])
            assert bool(task.sees(nav.sim.scene, nav.crowd, task.pose(nav.sim))) is seen
    far = with_people(free_place(env, begun, 3.0), [(env.config.task.sight + 0.1, 0.0)])
    assert not bool(task.sees(far.sim.scene, far.crowd, task.pose(far.sim)))


def test_a_hull_hides_the_person(env: NavEnv, task: FollowPerson, begun: Any) -> None:
    """The person stands on the other side of the nearest box of an object that is as high as people."""
    fields = task._hulls.fields[0, :, :, 0]
    inside = np.argwhere(fields == 0)
    assert len(inside), "the scene has an object as high as people"
    middle = np.asarray(env.bank.map_origin[0]) + (inside[len(inside) // 2] + 0.5) * 0.2
    nav = facing_east(one(begun))
    place = nav.sim.xpos.at[1, :2].set(middle - np.array([3.0, 0.0]))
    nav = with_people(nav._replace(sim=nav.sim._replace(xpos=place)), [(6.0, 0.0)])
    assert not bool(task.sees(nav.sim.scene, nav.crowd, task.pose(nav.sim)))


def test_what_is_observed_is_the_last_place_in_sight(env: NavEnv, begun: Any) -> None:
    nav = with_people(free_place(env, begun, 3.0), [(2.0, 0.0)])
    nav = nav._replace(**env.task.advance(nav, nav.sim, nav.crowd))
    hidden = with_people(nav, [(-4.0, 1.0)])
    hidden = hidden._replace(**env.task.advance(nav, hidden.sim, hidden.crowd))
    np.testing.assert_allclose(env.observe(nav)["goal"], [2.0, 0.0], atol=1e-5)
    obs = env.observe(hidden)
    np.testing.assert_allclose(obs["goal"], [2.0, 0.0], atol=1e-5)
    np.testing.assert_allclose(obs["privileged"][:2], [-4.0, 1.0], atol=1e-5)
    assert (float(nav.task.unseen), float(hidden.task.unseen)) == (0.0, pytest.approx(env.dt))
    assert [float(env._proprio(x)[3]) for x in (nav, hidden)] == [1.0, 0.0]
    np.testing.assert_allclose(hidden.route_length - nav.route_length, np.hypot(6.0, 1.0), rtol=1e-5)


def test_the_band_counts_only_in_sight(env: NavEnv, begun: Any) -> None:
    kept = {}
    for person in ((1.4, 0.0), (1.6, 0.0), (2.9, 0.0), (3.1, 0.0), (-2.0, 0.0)):
        nav = with_people(free_place(env, begun, 3.5), [person])
        state = env.task.advance(nav, nav.sim, nav.crowd)["task"]
        kept[person] = float(state.kept)
        values = env.task.rewards(nav, nav._replace(task=state))
        assert float(values["kept"]) == kept[person]
    assert list(kept.values()) == [0.0, 1.0, 1.0, 0.0, 0.0]
    np.testing.assert_allclose(
        [reward_in_band(jnp.float32(x), (1.5, 3.0)) for x in (2.0, 0.5, 4.0)], [1.0, 1 - np.tanh(1), 1 - np.tanh(1)]
    )


@pytest.mark.parametrize(
    ("changes", "steps", "base", "end"),
    [
        ({}, 10, Result.RUNNING, Result.RUNNING),
        ({"unseen": 7.9}, 10, Result.RUNNING, Result.RUNNING),
        ({"unseen": 8.1}, 10, Result.RUNNING, Result.LOST),
        ({"distance": 10.1}, 10, Result.RUNNING, Result.LOST),
        ({"distance": 10.1}, 10, Result.HIT, Result.HIT),
        ({"kept": 20.0}, 40, Result.TIMEOUT, Result.GOAL),
        ({"kept": 19.0}, 40, Result.TIMEOUT, Result.TIMEOUT),
        ({"kept": 39.0}, 39, Result.RUNNING, Result.RUNNING),
        ({"kept": 40.0}, 40, Result.HIT_AGENT, Result.HIT_AGENT),
    ],
)
def test_ends(env: NavEnv, begun: Any, changes: dict[str, float], steps: int, base: Result, end: Result) -> None:
    nav = one(begun)
    values = {name: jnp.float32(x) for name, x in changes.items()}
    nav = nav._replace(task=nav.task._replace(**values), steps=jnp.int32(steps))
    assert int(env.task.result(nav, jnp.int32(base))) == end


def test_an_early_end_counts_as_time_outside(env: NavEnv, begun: Any) -> None:
    nav = one(begun)
    state = nav.task._replace(kept=jnp.float32(10.0), watched=jnp.float32(12.0), distances=jnp.float32(36.0))
    scores = env.task.scores(nav._replace(task=state, steps=jnp.int32(12)))
    assert {k: float(x) for k, x in scores.items()} == pytest.approx({"score": 0.25, "in_sight": 0.3, "distance": 3.0})


@pytest.mark.extended
def test_driving_up_to_the_person_is_no_arrival(env: NavEnv, begun: Any) -> None:
    nav = with_people(one(begun), [(0.7, 0.0)])
    assert float(jnp.linalg.norm(nav.sim.xpos[1, :2] - begun.start[0, :2])) < 0.1
    after = jax.jit(lambda state: env.advance(state, jnp.zeros(2))[0])(nav)
    assert float(after.goal_distance) < 1.0, "within what counts as arrived at a point"
    assert int(after.result) in (Result.RUNNING, Result.HIT_AGENT)


@pytest.mark.slow
def test_the_planner_keeps_the_person_longer_than_who_stands_and_the_baseline_is_scripted(env: NavEnv) -> None:
    agents = {"zero": zero, "keep_distance": keep_distance, "planner": planner_of(env)}
    assert isinstance(agents["planner"], PersonFollower)
    assert baseline_of(env) == ("keep_distance", keep_distance)
    results, trajectory = Rollout(env, chunk=20).run(agents, fixed_episodes(env, 6))
    score = {a: np.mean([r.task_scores["score"] for r in results if r.agent == a and r.task_scores]) for a in agents}
    assert score["planner"] > 0.6
    assert score["planner"] > score["zero"] + 0.2
    assert score["keep_distance"] > score["zero"]
    assert trajectory.goals is not None
    moved = np.linalg.norm(trajectory.goals[-1] - trajectory.goals[0], axis=-1)
    assert np.median(moved) > 2.0, "the goals of a film move with the person"


def test_keep_distance_stops_and_faces_the_goal() -> None:
    def length(goal: tuple[float, float]) -> float:
        return float(jnp.linalg.norm(keep_distance({"goal": jnp.array(goal)}, jax.random.key(0))))

    assert length((9.0, 0.0)) == pytest.approx(1.0)
    assert length((0.0, 2.5)) == pytest.approx(0.5)
    assert length((1.0, 0.0)) == pytest.approx(0.02)
    turned = keep_distance({"goal": jnp.array([0.0, 1.0])}, jax.random.key(0))
    assert float(turned[1]) > 0.0, "a waypoint of some length to the left, so that the robot turns"


@pytest.mark.slow
def test_check_env_accepts_it(env: NavEnv) -> None:
    check_env(env, num_envs=4, num_steps=6)


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        ({"task.band": (3.0, 1.5)}, "config.task.band: found 3 to 1.5 m"),
        ({"task.speed": (0.0, 1.0)}, "config.task.speed: found 0 to 1 m/s"),
        ({"task.lost_distance": 2.0}, "config.task.lost_distance: found 2 m, needed more than the band's 3 m"),
        ({"task.lost_distance": 20.0}, "at most sight, 15 m"),
        ({"task.lost_time": 0.0}, "config.task.lost_time"),
        ({"task.success_share": 1.5}, "config.task.success_share"),
        ({"crowd.slots.pedestrian": 0, "crowd.slots.car": 1}, "config.crowd.slots: found no pedestrian"),
        ({"scenario": "static"}, "found 'static' for the task 'follow_person'"),
    ],
)
def test_bad_configurations_are_refused_in_a_sentence(
    small_bank: SceneBank, overrides: dict[str, Any], words: str
) -> None:
    with pytest.raises(ValidationError, match=words):
        unicycle_env(small_bank, {**FEW, **overrides}, config=follow_person_config())


def test_the_heading_frame_is_the_one_of_the_terms() -> None:
    yaw = jnp.float32(0.7)
    there = jnp.array([1.0, -2.0])
    np.testing.assert_allclose(terms.to_world(there, -yaw), terms.to_body(there, yaw), atol=1e-6)
