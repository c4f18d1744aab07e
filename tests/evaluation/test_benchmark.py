"""Frozen protocols and their scores: by hand, refused by name, the same every time."""

import dataclasses
import json
import math
import pathlib
from typing import Any

import jax
import numpy as np
import pytest

from tests.evaluation.test_evaluation import _result
from tests.support.unicycle import unicycle_env
from urbanverse_mjx import settings
from urbanverse_mjx.datatypes import BenchmarkReport, EpisodeResult, SceneBank, ValidationError
from urbanverse_mjx.evaluation import benchmark, go_to_goal
from urbanverse_mjx.evaluation.agents import zero
from urbanverse_mjx.evaluation.frozen import RUNS, FrozenEpisode, Protocol, freeze, half_rows
from urbanverse_mjx.evaluation.scores import by_scene, over_runs, over_scenes, scores
from urbanverse_mjx.scene import library


@pytest.fixture(scope="module")
def hashed(small_bank: SceneBank) -> SceneBank:
    """The box streets with a hash each."""
    hashes = {name: f"{i}" * 64 for i, name in enumerate(small_bank.scene_ids)}
    return dataclasses.replace(small_bank, meta={**small_bank.meta, "hashes": hashes})


FOUR = [
    _result(touches=0),
    _result(result="hit", touches=1, route_completion=0.5, distance_to_goal=5.5, hit_time=0.2, path_length=4.0),
    _result(result="timeout", touches=0, route_completion=0.0, distance_to_goal=12.0, path_length=0.0, duration=60.0),
    # Reached the goal, but not without touching: no success as the paper counts it.
    _result(touches=3, hit_time=0.1, path_length=20.0, duration=20.0),
]


def test_scores_by_hand() -> None:
    s = scores(FOUR)
    assert s["SR"] == 25.0
    assert s["reached"] == 50.0
    assert s["CT"] == pytest.approx(100 * 0.3 / 4)
    assert s["RC"] == 62.5
    assert s["DTG"] == pytest.approx(18.5 / 4)
    assert s["hit_episodes"] == 50.0
    assert s["SPL"] == pytest.approx(100 * 0.8 / 4)
    # 1 + 3 contacts and one timeout over 12.5 + 4 + 0 + 20 m.
    assert s["failures"] == pytest.approx(100 * 5 / 36.5, abs=1e-6)
    assert s["speed"] == pytest.approx(36.5 / (2 + 2 + 60 + 20), abs=1e-6)


@pytest.mark.parametrize(("driven", "route", "share"), [(20.0, 10.0, 50.0), (10.0, 10.0, 100.0), (15.73, 16.52, 100.0)])
def test_spl_of_a_success_by_hand(driven: float, route: float, share: float) -> None:
    """A robot that stops at the edge of the goal's circle has driven less than the route; completion is at most 1."""
    assert scores([_result(touches=0, path_length=driven, route_length=route)])["SPL"] == pytest.approx(share)


@pytest.mark.parametrize(
    ("result", "failures"),
    [("goal", 0), ("hit", 1), ("hit_agent", 1), ("off_traversable", 1), ("fall", 1), ("non_finite", 1), ("timeout", 1)],
)
def test_every_end_but_the_goal_is_one_failure(result: str, failures: int) -> None:
    touches = int(result in ("hit", "hit_agent"))
    assert scores([_result(result=result, touches=touches, path_length=50.0)])["failures"] == pytest.approx(
        2 * failures
    )


def test_who_stands_still_has_no_failures_per_metre() -> None:
    assert scores([FOUR[2]])["failures"] is None
    assert scores([FOUR[2]])["SR"] == 0.0


def test_means_over_runs_by_hand() -> None:
    table = over_runs(FOUR, [0, 0, 1, 1])
    # Run 0: one of two succeeds; run 1: none. Means 50 and 0, standard error |50 - 0| / 2.
    assert table["SR"] == {"mean": 25.0, "se": 25.0}
    assert table["DTG"]["mean"] == pytest.approx((3.0 + 6.25) / 2)
    assert over_runs(FOUR[:1], [0])["SR"] == {"mean": 100.0, "se": None}


def test_intervals_draw_scenes_and_not_episodes() -> None:
    good = [_result(scene="a", episode=i) for i in range(64)]
    bad = [_result(scene="b", episode=i, result="timeout") for i in range(64)]
    table = over_scenes(good + bad)["SR"]
    # Two scenes drawn with replacement: 0, 50 or 100 % with probabilities 1/4, 1/2, 1/4.
    assert (table["mean"], table["low"], table["high"]) == (50.0, 0.0, 100.0)
    assert table["se"] == pytest.approx(100 * math.sqrt(1 / 8), rel=0.03)
    # Three scenes, of which one is driven well: three draws of 100 % with probability 1/3.
    worse = [_result(scene="c", episode=i, result="timeout") for i in range(64)]
    table = over_scenes(good + bad + worse)["SR"]
    assert table["se"] == pytest.approx(100 * math.sqrt(2 / 27), rel=0.03)
    assert over_scenes(good)["SR"]["se"] is None
    assert by_scene(good + bad) == {"a": scores(good), "b": scores(bad)}


def test_old_reports_know_no_touches() -> None:
    old = {k: x for k, x in _result(result="hit").to_json().items() if k != "touches"}
    assert scores([EpisodeResult.from_json(old)])["failures"] == pytest.approx(100 / 12.5)


def test_a_list_is_the_same_every_time_and_comes_back_from_its_file(hashed: SceneBank, tmp_path: pathlib.Path) -> None:
    protocol = freeze("boxes", hashed, 8, seed=0)
    assert protocol == freeze("boxes", hashed, 8, seed=0)
    assert protocol.content_hash() != freeze("boxes", hashed, 8, seed=1).content_hash()
    protocol.save(tmp_path / "boxes.json")
    assert Protocol.load(tmp_path / "boxes.json") == protocol
    assert protocol.conditions == {"vision_config.light": "baked", "friction": "materials"}
    before = dataclasses.replace(protocol, conditions={"vision_config.light": "direct", "friction": "uniform"})
    before.save(tmp_path / "before.json")
    assert "conditions" not in json.loads((tmp_path / "before.json").read_text())
    assert Protocol.load(tmp_path / "before.json") == before
    changed = (tmp_path / "boxes.json").read_text().replace('"seed":', '"seed":1', 1)
    (tmp_path / "changed.json").write_text(changed)
    with pytest.raises(ValidationError, match="do not fit their hash"):
        Protocol.load(tmp_path / "changed.json")


def test_the_frozen_episodes_are_what_is_driven(hashed: SceneBank) -> None:
    protocol = freeze("boxes", hashed, 8, seed=0)
    # Tables that were planned anew, as if another version had compiled the scenes.
    planned = dataclasses.replace(hashed, episode_start=hashed.episode_start[:, ::-1] + 0.5)
    runs = protocol.on(planned)
    assert len(runs.episodes) == 24
    begin_at = jax.jit(unicycle_env(runs.bank).begin_at)
    for i in (0, 9, 23):
        frozen = protocol.scenes[int(runs.episodes.scenes[i])].episodes[int(runs.episodes.episodes[i])]
        nav = begin_at(jax.random.key(0), runs.episodes.scenes[i], runs.episodes.episodes[i])
        np.testing.assert_allclose(nav.sim.xpos[1, :2], frozen.start[:2], atol=1e-3)
        np.testing.assert_allclose(nav.goal, frozen.goal, atol=1e-5)
        assert int(nav.num_waypoints) == len(frozen.way)
        assert float(nav.route_length) == pytest.approx(
            float(np.linalg.norm(np.diff([frozen.start[:2], *[p[:2] for p in frozen.way]], axis=0), axis=1).sum()),
            1e-4,
        )


def test_a_scene_that_changed_is_refused_by_its_name(hashed: SceneBank) -> None:
    protocol = freeze("boxes", hashed, 8, seed=0)
    name = hashed.scene_ids[1]
    other = {**hashed.meta, "hashes": {**hashed.meta["hashes"], name: "f" * 64}}
    with pytest.raises(ValidationError, match=f"scene '{name}': found hash ffffffffffff, needed 111111111111"):
        protocol.on(dataclasses.replace(hashed, meta=other))
    ids = [*hashed.scene_ids[:2], "another"]
    renamed = {**hashed.meta, "scene_ids": ids}
    with pytest.raises(ValidationError, match=f"found no scene '{hashed.scene_ids[2]}'"):
        protocol.on(dataclasses.replace(hashed, meta=renamed))


def test_the_paper_protocol_leaves_extra_scenes_out(hashed: SceneBank) -> None:
    extra = hashed.scene_ids[1]
    protocol = freeze("boxes", hashed, 8, seed=0, extra=[extra])
    runs = protocol.on(hashed, "paper")
    assert runs.scenes == (hashed.scene_ids[0], hashed.scene_ids[2])
    assert sorted(set(runs.episodes.episodes.tolist())) == list(range(RUNS))
    assert len(protocol.on(hashed, "full").scenes) == 3
    with pytest.raises(ValidationError, match="extra scenes"):
        freeze("boxes", hashed, 8, seed=0, extra=["nowhere"])
    with pytest.raises(ValidationError, match="needed a number of at least 5"):
        freeze("boxes", hashed, 3, seed=0)


@pytest.mark.parametrize(
    ("name", "scenes", "episodes"),
    [
        ("autobench", 10, 64),
        ("autobench_v2", 10, 64),
        ("craftbench", 12, 64),
        ("craftbench_v2", 12, 64),
        ("validation", 8, 48),
    ],
)
def test_frozen_lists_name_the_scenes_as_committed(name: str, scenes: int, episodes: int) -> None:
    """A scene that was frozen anew without its list, or the other way round, would refuse every run."""
    protocol = Protocol.load(settings.protocol_root() / f"{name}.json")
    assert len(protocol.scenes) == scenes
    assert {len(scene.episodes) for scene in protocol.scenes} == {episodes}
    hashes = library.shipped_hashes(name)
    assert {scene.id: scene.hash for scene in protocol.scenes} == {k: row["scene"] for k, row in hashes.items()}


def test_half_length_ways_stay_in_the_first_half(hashed: SceneBank) -> None:
    for row in range(hashed.num_scenes):
        number = int(hashed.num_episodes[row])
        x = np.concatenate([hashed.episode_start[row, :number, :1], hashed.episode_waypoints[row, :number, :, 0]], 1)
        for half in (20.0, 1000.0):
            rows = half_rows(hashed, row, half)
            limit = x.min() + min(half, float(np.ptp(x)) / 2.0)
            assert set(rows) == set(np.flatnonzero(x.max(1) <= limit + 1e-4))
            assert len(rows) < number
    with pytest.raises(ValidationError, match="episodes that fit"):
        freeze("boxes", hashed, 8, seed=0, half=20.0)


def test_a_benchmark_repeats_to_the_last_digit_in_any_number_of_batches(
    hashed: SceneBank, tmp_path: pathlib.Path
) -> None:
    runs = freeze("boxes", hashed, 5, seed=0).on(hashed, "paper")
    env = unicycle_env(runs.bank, {"terminate_off_traversable": False, "episode_length": 60})

    def write(folder: str, at_once: int) -> benchmark.Outcome:
        outcome = benchmark.drive(env, "go_to_goal", go_to_goal, runs.episodes, False, at_once)
        summary = benchmark.write_outcome(tmp_path / folder, "boxes", runs, outcome, {"seed": 0})
        rows = {"go_to_goal": summary}
        page = benchmark.to_markdown("boxes", {"ends": rows}, {"ends": by_scene(outcome.results)}, "±")
        benchmark.write_page(tmp_path / folder, page)
        return outcome

    once, again, parts = write("a", 100), write("b", 100), write("c", 4)
    assert once.results == again.results
    assert len(parts.results) == len(once.results) == 15
    assert [(r.scene, r.episode, r.result) for r in parts.results] == [
        (r.scene, r.episode, r.result) for r in once.results
    ]
    for name in ("report.json", "report.md", "episodes.csv", "scenes.csv"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()
    assert BenchmarkReport.load(tmp_path / "a" / "report.json").episodes == once.results
    for result, trajectory in zip(once.results, once.trajectories, strict=True):
        assert len(trajectory) == result.steps
    ends = json.loads((tmp_path / "a" / "report.json").read_text())["summary"]["go_to_goal"]["ends"]
    assert sum(ends.values()) == 15


def test_zero_gets_nothing(hashed: SceneBank) -> None:
    runs = freeze("boxes", hashed, 5, seed=0).on(hashed, "paper")
    env = unicycle_env(runs.bank, {"episode_length": 40})
    outcome = benchmark.drive(env, "zero", zero, runs.episodes, False, 15)
    assert scores(outcome.results)["SR"] == 0.0
    assert scores(outcome.results)["RC"] == pytest.approx(0.0, abs=1.0)


def test_contact_is_counted_where_an_episode_goes_on(hashed: SceneBank) -> None:
    """A wall at x = 5 m that the kinematic robot is `in` from there on: one touch, and no success at the goal."""
    runs = freeze("boxes", hashed, 5, seed=0).on(hashed, "paper")
    task = {"terminate_off_traversable": False, "terminate_on_hit": False, "episode_length": 150}
    env = unicycle_env(runs.bank, task, wall=5.0)
    results = benchmark.drive(env, "go_to_goal", go_to_goal, runs.episodes, False, 15).results
    assert {r.result for r in results} <= {"goal", "timeout"}
    touched = [r for r in results if r.touched]
    assert touched, "some path leads beyond the wall"
    assert not any(r.success for r in touched)
    assert all(r.touches and r.hit_time > 0.0 for r in touched)


def test_the_least_episode_is_accepted_and_less_is_refused() -> None:
    fields: dict[str, Any] = {"start": (0, 0, 0, 0), "goal": (1, 0, 0), "way": ((1, 0, 0),), "length": 1e-3, "seed": 0}
    assert FrozenEpisode(**fields).way == ((1.0, 0.0, 0.0),)
    for name, wrong in [
        *[("seed", -1), ("length", 0.0), ("way", ()), ("start", (0, 0, 0)), ("goal", (1, 0)), ("goal", (1, 0, np.nan))],
        *[("seed", 0.5), ("way", ((1, 0),))],
    ]:
        with pytest.raises(ValidationError, match=rf"episode\.{name}"):
            FrozenEpisode(**{**fields, name: wrong})
