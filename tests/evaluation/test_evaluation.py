"""Evaluation: intervals against published numbers, rollouts against the kinematic engine, reports that round-trip."""

import dataclasses
import json
import pathlib
from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest

from tests.support.unicycle import NOTHING, UnicycleEngine, unicycle_env, unicycle_robot
from urbanverse_mjx.datatypes import BenchmarkReport, EpisodeResult, SceneBank, SimState, ValidationError
from urbanverse_mjx.envs import NavEnv, default_config
from urbanverse_mjx.envs.navigation.scenarios import scenario_of
from urbanverse_mjx.evaluation import (
    Rollout,
    blank_image,
    fixed_episodes,
    go_to_goal,
    make_report,
    people,
    summarise,
    to_markdown,
)
from urbanverse_mjx.evaluation.agents import BASELINES, zero
from urbanverse_mjx.evaluation.metrics import drawn_counts, mean_interval, wilson_interval
from urbanverse_mjx.evaluation.report import write_report
from urbanverse_mjx.pipeline.evaluation import evaluation_config
from urbanverse_mjx.viewer.session import Machine, NamedPolicy, Session


def _result(**changes: object) -> EpisodeResult:
    base = {
        "agent": "a",
        "scene": "s",
        "episode": 0,
        "seed": 0,
        "result": "goal",
        "steps": 10,
        "duration": 2.0,
        "route_completion": 1.0,
        "distance_to_goal": 0.5,
        "hit_time": 0.0,
        "path_length": 12.5,
        "route_length": 10.0,
        "slot_overflow": 0,
    }
    return EpisodeResult(**{**base, **changes})  # type: ignore[arg-type]


def test_wilson_interval_against_published_values() -> None:
    # Newcombe 1998, Statistics in Medicine 17, table I: 81/263, 15/148, 0/20, 1/29, Wilson score without correction.
    for (r, n), (low, high) in {
        (81, 263): (0.2553, 0.3662),
        (15, 148): (0.0624, 0.1605),
        (0, 20): (0.0, 0.1611),
        (1, 29): (0.0061, 0.1718),
    }.items():
        assert wilson_interval(r, n) == pytest.approx((low, high), abs=6e-5)


def test_intervals_draw_scenes_before_episodes() -> None:
    """Ten scenes whose means differ with a deviation of 2, 40 episodes of each with a deviation of 0.5 around them."""
    rng = np.random.default_rng(0)
    means = rng.normal(3.0, 2.0, 10)
    values = (means[:, None] + rng.normal(0.0, 0.5, (10, 40))).ravel()
    scenes = [f"scene_{k}" for k in range(10) for _ in range(40)]
    found = mean_interval(values.tolist(), drawn_counts(scenes))
    assert found is not None
    half = 1.96 * means.std() / np.sqrt(10)
    np.testing.assert_allclose(found, (values.mean() - half, values.mean() + half), atol=0.15)
    # As if they were independent, they would claim a fifth of that.
    alone = mean_interval(values.tolist(), drawn_counts([f"scene_{k}" for k in range(400)]))
    assert alone is not None
    assert alone[1] - alone[0] == pytest.approx(2 * 1.96 * values.std() / 20, rel=0.06)
    assert found[1] - found[0] > 4 * (alone[1] - alone[0])


def test_draws_keep_scenes_whole_in_number() -> None:
    counts = drawn_counts(["a"] * 3 + ["b"] * 5)
    assert counts is not None
    times = np.stack([counts[:, :3].sum(1) / 3, counts[:, 3:].sum(1) / 5])
    np.testing.assert_array_equal(times, times.round())
    np.testing.assert_array_equal(times.sum(0), 2)
    # Each scene's episodes are drawn, too: not all of them count alike in a draw.
    assert (counts[:, 3:].max(1) > counts[:, 3:].min(1)).mean() > 0.5


def test_a_policy_that_succeeds_in_every_second_scene_is_not_known_well() -> None:
    """100 episodes of two scenes: Wilson's interval of independent ones is [40, 60]."""
    good = [_result(scene="a", episode=i) for i in range(50)]
    bad = [_result(scene="b", episode=i, result="timeout") for i in range(50)]
    s = summarise(good + bad)
    assert s["SR"] == {"mean": 50.0, "low": 0.0, "high": 100.0}
    assert (s["n"], s["scenes"]) == (100, 2)
    assert summarise(good)["SR"] == {"mean": 100.0, "low": None, "high": None}, "one scene tells nothing of others"
    # Without a success no draw has one, so the interval of independent episodes remains.
    none = summarise([_result(scene=x, result="timeout") for x in "abcdefgh" for _ in range(10)])["SR"]
    assert none == {"mean": 0.0, "low": 0.0, "high": round(100 * wilson_interval(0, 80)[1], 1)}


def test_summary_by_hand() -> None:
    results = [
        _result(),
        _result(result="hit", route_completion=0.5, distance_to_goal=5.5, hit_time=0.2, path_length=4.0),
        _result(result="timeout", route_completion=0.0, distance_to_goal=12.0, path_length=0.0),
        _result(path_length=10.0),
    ]
    s = summarise(results)
    assert s["SR"]["mean"] == 50.0  # type: ignore[index]
    assert s["CT"]["mean"] == 5.0  # type: ignore[index]
    assert s["RC"]["mean"] == 62.5  # type: ignore[index]
    assert s["DTG"]["mean"] == pytest.approx(18.5 / 4, abs=0.01)  # type: ignore[index]
    assert s["hit_episodes"]["mean"] == 25.0  # type: ignore[index]
    assert s["SPL"]["mean"] == pytest.approx(100 * (0.8 + 1.0) / 4, abs=0.05)  # type: ignore[index]
    assert s["n"] == 4


@pytest.mark.extended
def test_rollouts_tell_agents_apart_and_repeat(small_bank: SceneBank) -> None:
    env = unicycle_env(small_bank, {"terminate_off_traversable": False, "episode_length": 120})
    episodes = fixed_episodes(env, 9)
    assert set(episodes.scenes.tolist()) == {0, 1, 2}
    agents = {"zero": zero, "go_to_goal": go_to_goal}
    results, poses = Rollout(env).run(agents, episodes)
    assert [r.agent for r in results] == ["zero"] * 9 + ["go_to_goal"] * 9
    assert all(r.result == "timeout" and r.path_length < 1e-3 and r.steps == 120 for r in results[:9])
    for r in results[9:]:
        assert r.success
        assert r.distance_to_goal < 1.0
        assert r.route_completion == 1.0
        # The kinematic robot drives at 2 m/s; it turns first, so it is never faster than that.
        assert r.path_length <= 2.0 * r.duration + 1e-3
    assert poses.xpos.shape[1] == 18
    again, _ = Rollout(env).run(agents, episodes)
    assert again == results


class GroundEngine(UnicycleEngine):
    """The kinematic engine whose wall is ground."""

    def _state(self, *args: Any) -> SimState:
        state = super()._state(*args)
        return state._replace(contacts=state.contacts._replace(hit_ground=state.contacts.hit))


@pytest.mark.extended
@pytest.mark.parametrize(("engine", "outcome"), [(UnicycleEngine, "hit"), (GroundEngine, "hit_ground")])
def test_a_hit_of_the_ground_is_told_from_one_of_an_object(
    engine: type[UnicycleEngine], outcome: str, small_bank: SceneBank
) -> None:
    config = unicycle_env(small_bank, {"terminate_off_traversable": False, "episode_length": 60}).config
    robot = unicycle_robot()
    env = NavEnv(config, small_bank, robot, engine(robot, config.ctrl_dt, wall=-1e3), None)
    episodes = fixed_episodes(env, 2)
    results, _ = Rollout(env).run({"zero": zero}, episodes)
    assert {(r.result, r.outcome, r.success) for r in results} == {("hit", outcome, False)}
    session = Session(Machine(env, NamedPolicy("zero", zero)), int(episodes.scenes[0]), [int(episodes.episodes[0])])
    assert session.outcome(0) is None
    session.step()
    assert session.outcome(1) == outcome
    text = to_markdown(make_report("Zero", results, {}))
    assert ("A `hit` of the ground alone, by a part of the robot other than a foot: zero 2." in text) == (
        outcome == "hit_ground"
    )


def test_what_touches_an_object_or_an_agent_too_is_no_hit_of_the_ground_alone() -> None:
    ground = NOTHING._replace(hit=jnp.bool_(True), hit_ground=jnp.bool_(True))
    agent = ground._replace(hit_agent=jnp.int32(-1))
    assert ground.only_ground
    assert agent.only_ground
    for both in (ground._replace(hit_object=jnp.int32(3)), agent._replace(hit_agent=jnp.int32(0)), NOTHING):
        assert not both.only_ground


def test_another_way_than_the_lists_completes_no_more_than_is_true(small_bank: SceneBank) -> None:
    """The list's path leads round two sides of a square and the robot drives along its diagonal."""
    start, goal = small_bank.episode_start[..., None, :2], small_bank.episode_goal[..., None, :2]
    across = (goal - start)[..., ::-1] * np.array([-0.5, 0.5], np.float32)
    waypoints = small_bank.episode_waypoints.copy()
    waypoints[..., :2] = goal
    waypoints[..., :1, :2] = 0.5 * (start + goal) + across
    bank = dataclasses.replace(small_bank, episode_waypoints=waypoints)
    env = unicycle_env(bank, {"terminate_off_traversable": False, "episode_length": 22})
    results, _ = Rollout(env).run({"go_to_goal": go_to_goal}, fixed_episodes(env, 9))
    ended = [r for r in results if not r.success]
    assert len(ended) >= 3
    for r in ended:
        most = min(r.path_length, r.route_length - r.distance_to_goal)
        assert 0.05 < r.route_completion * r.route_length <= most + 1e-4
    # Past the middle the second leg is the nearer one, at half its length or more: the nearest point alone gives 75 %.
    beyond = [r for r in ended if r.distance_to_goal < 0.48 * r.route_length / np.sqrt(2.0)]
    assert beyond
    assert all(r.route_completion < 0.71 for r in beyond)


def test_an_answer_is_kept_for_as_many_steps_as_said(small_bank: SceneBank) -> None:
    """A random policy turns by the same angle five steps long, then by another; episodes last as long as before."""
    task = {"ctrl_dt": 0.04, "episode_length": 60, "terminate_off_traversable": False, "success_radius": 1e-3}
    env = unicycle_env(small_bank, task)
    results, poses = Rollout(env, chunk=4, hold=5).run({"random": BASELINES["random"]}, fixed_episodes(env, 3))
    assert [r.steps for r in results] == [60] * 3
    assert poses.running.shape == (60, 3)
    quaternion = poses.xquat[:, :, 1]
    turns = np.diff(np.unwrap(2.0 * np.arctan2(quaternion[..., 3], quaternion[..., 0]), axis=0), axis=0)
    # The pose before the 60th step is the last one: its turn is not seen.
    groups = turns[:55].reshape(11, 5, 3)
    np.testing.assert_allclose(groups, np.broadcast_to(groups[:, :1], groups.shape), atol=1e-5)
    assert (np.abs(np.diff(groups[:, 0], axis=0)) > 1e-4).mean() > 0.5


def test_blank_image_covers_only_pixels() -> None:
    seen = {}

    def spy(obs: dict, key: object) -> object:
        seen.update(obs)
        return jnp.zeros(2)

    blank_image(spy)({"pixels/front": jnp.ones((2, 2, 3), jnp.uint8), "goal": jnp.ones(2)}, None)  # type: ignore[arg-type]
    assert not np.asarray(seen["pixels/front"]).any()
    assert np.asarray(seen["goal"]).all()


def test_report_round_trip_and_files(tmp_path: pathlib.Path) -> None:
    report = make_report("Two agents", [_result(), _result(agent="b", result="hit")], {"seed": 0})
    write_report(report, tmp_path)
    assert BenchmarkReport.load(tmp_path / "report.json") == report
    text = (tmp_path / "report.md").read_text()
    assert text == to_markdown(report)
    assert "| a | 100 | 0 |" in text
    assert "| b | 0 | 0 |" in text
    assert len((tmp_path / "episodes.csv").read_text().splitlines()) == 3
    broken = json.loads((tmp_path / "report.json").read_text())
    broken["episodes"][0]["route_completion"] = 1.5
    (tmp_path / "broken.json").write_text(json.dumps(broken))
    with pytest.raises(ValidationError, match="route_completion"):
        BenchmarkReport.load(tmp_path / "broken.json")


def test_too_many_episodes_is_said(small_bank: SceneBank) -> None:
    with pytest.raises(ValidationError, match="episodes: found"):
        fixed_episodes(unicycle_env(small_bank), 100_000)


def test_a_policy_from_before_there_were_people_meets_the_crowd_of_its_preset() -> None:
    """The shipped policy's config names no scenario; as it was trained, its streets stay still."""
    path = pathlib.Path(__file__).parents[2] / "benchmarks" / "policies" / "coco_paper" / "policy.json"
    trained = json.loads(path.read_text(encoding="utf-8"))["env_config"]
    assert "scenario" not in trained
    still = evaluation_config("CocoNav", trained, "test", dynamic=False)
    assert scenario_of(still) == "static"
    dynamic = evaluation_config("CocoNav", trained, "park_edge", dynamic=True)
    assert scenario_of(dynamic) == "dynamic"
    assert dynamic.crowd.to_dict() == default_config(trained["preset"]).crowd.to_dict()
    assert (dynamic.scenes, dynamic.reward_config.to_dict()) == ("park_edge", still.reward_config.to_dict())
    own = {**dynamic.to_dict(), "crowd": {**dynamic.crowd.to_dict(), "yielding": 0.0}}
    assert evaluation_config("CocoNav", own, "test", dynamic=True).crowd.yielding == 0.0, "a trained crowd is kept"


def test_people_are_counted_from_step_to_step() -> None:
    """Three steps of one env and one of another: the least distance, seconds near people, and the speed there."""
    tally = people.no_people(2)
    assert {name: float(x[0]) for name, x in tally._asdict().items()} == {
        "nearest": people.MAX_PEOPLE_DISTANCE, "intimate": 0.0, "personal": 0.0, "speed": 0.0,
    }  # fmt: skip
    rows = [(3.0, 0.0, 0.0, 0.0), (0.4, 1.0, 1.0, 0.6), (0.9, 0.0, 1.0, 1.0)]
    names = ("people_distance", "intimate_time_per_step", "personal_time_per_step", "personal_speed_per_step")
    for row in rows:
        tally = people.counted(
            tally, {n: np.array([x, 5.0 if n == names[0] else 0.0]) for n, x in zip(names, row, strict=True)}
        )
    steps = np.array([4, 1])
    assert people.people_fields(tally, steps, 0) == {
        "people_distance": pytest.approx(0.4), "intimate_time": 0.25, "speed_near_people": pytest.approx(0.8),
    }  # fmt: skip
    alone = people.people_fields(tally, steps, 1)
    assert alone == {"people_distance": 5.0, "intimate_time": 0.0, "speed_near_people": None}
    assert people.people_fields(tally._replace(intimate=np.array([9.0, 0.0])), steps, 0)["intimate_time"] == 1.0


def test_people_in_the_summary_by_hand() -> None:
    people = [
        _result(people_distance=0.5, intimate_time=0.1, speed_near_people=0.8),
        _result(result="hit_agent", people_distance=0.0, intimate_time=0.3, speed_near_people=1.2),
        _result(people_distance=4.0, intimate_time=0.0),
    ]
    s = summarise(people)
    assert s["agent_hits"]["mean"] == pytest.approx(33.3)  # type: ignore[index]
    assert s["hit_episodes"]["mean"] == pytest.approx(33.3)  # type: ignore[index]
    assert s["people_distance"]["mean"] == 1.5  # type: ignore[index]
    assert s["IT"]["mean"] == pytest.approx(13.33)  # type: ignore[index]
    assert s["speed_near_people"]["mean"] == 1.0  # type: ignore[index]
    assert "IT" not in summarise([_result()])
    report = make_report("people", people, {})
    assert "| a | 33.3 | " in to_markdown(report)
    assert "| a | 50 [0, 100] | " in to_markdown(make_report("two", [_result(), _result(scene="t", result="hit")], {}))
    assert BenchmarkReport.from_json(json.loads(json.dumps(report.to_json()))) == report
    old = {k: x for k, x in report.to_json()["episodes"][0].items() if "people" not in k and k != "intimate_time"}
    assert EpisodeResult.from_json(old).people_distance is None, "reports from before there were people"


def test_scores_of_a_task_go_into_files_and_tables(tmp_path: pathlib.Path) -> None:
    plain = _result()
    assert "task_scores" not in plain.to_json()
    scored = [_result(agent=a, task_scores={"score": x, "jerk": 2.0}) for a, x in (("a", 0.25), ("b", 0.75))]
    again = EpisodeResult.from_json(scored[0].to_json())
    assert again == scored[0]
    assert scored[0].to_row()["task/score"] == 0.25
    assert "task_scores" not in scored[0].to_row()
    with pytest.raises(ValidationError, match=r"task_scores\.score"):
        _result(task_scores={"score": float("nan")})
    lost = _result(agent="b", result="lost", task_scores={"score": 0.25, "jerk": 4.0})
    report = make_report("a task", [*scored, lost], {})
    assert report.summary["b"]["task/score"]["mean"] == 0.5
    text = to_markdown(report)
    assert "| agent | score | jerk |\n|---|---|---|\n" in text
    assert "| b | 0.5 | 3 |" in text
    assert "| hit_agent | lost |" in text
    write_report(report, tmp_path)
    assert BenchmarkReport.load(tmp_path / "report.json").episodes == report.episodes
    assert (tmp_path / "episodes.csv").read_text().splitlines()[0].endswith("task/score,task/jerk")
    assert "lost" not in to_markdown(make_report("point goals", [plain], {})), "nobody to lose"
