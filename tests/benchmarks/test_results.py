"""The table of docs/results.md is that of the rows, and its intervals draw seeds and scenes."""

import csv
import json
import pathlib
import shutil

import numpy as np
import pytest

from benchmarks import results
from tests.evaluation.test_evaluation import _result
from urbanverse_mjx.datatypes import BenchmarkReport


def test_the_page_holds_the_table_of_the_rows() -> None:
    page = results.PAGE.read_text(encoding="utf-8")
    assert results.with_table(page, results.table(results.read(results.SCORES))) == page, "run make results"


@pytest.mark.parametrize("name", results.COMPARISONS)
def test_the_page_holds_the_table_of_a_comparison(name: str) -> None:
    page = results.PAGE.read_text(encoding="utf-8")
    text = results.arm_table(results.COMPARISONS[name], results.read_arms(results.SCORES, name))
    assert results.with_table(page, text, results.arm_marks(name)) == page, "run make results"


def test_the_page_holds_the_table_of_the_benchmarks_versions() -> None:
    page = results.PAGE.read_text(encoding="utf-8")
    text = results.version_table(results.read_versions(results.SCORES))
    assert results.with_table(page, text, results.arm_marks("versions")) == page, "run make results"


def benchmark_run(folder: pathlib.Path, benchmark: str, rates: dict[str, float]) -> pathlib.Path:
    """A folder as `urbanverse benchmark` writes it, with two episodes a scene."""
    scores = {scene: {"SR": rate, "RC": rate, "hit_episodes": 0.0} for scene, rate in rates.items()}
    episodes = tuple(_result(scene=scene, episode=k) for scene in rates for k in range(2))
    record = {"protocol": "paper", "benchmark": benchmark}
    (folder / "ends").mkdir(parents=True, exist_ok=True)
    report = BenchmarkReport("of a test", {"planner": {"by_scene": scores}}, episodes, record)
    report.save(folder / "ends" / "report.json")
    return folder


def test_runs_of_both_versions_stand_in_one_row_and_a_repeated_run_replaces_its_own(tmp_path: pathlib.Path) -> None:
    head = (results.SCORES / "versions.csv").read_text(encoding="utf-8").splitlines(keepends=True)[0]
    (tmp_path / "versions.csv").write_text(head, encoding="utf-8")
    assert results.version_table(results.read_versions(tmp_path)).startswith("Not run yet")
    for benchmark, rate in (("craftbench", 40.0), ("craftbench_v2", 60.0), ("craftbench_v2", 80.0)):
        run = benchmark_run(tmp_path / "run", benchmark, {"a": rate, "b": rate})
        results.add_version(tmp_path, run, "COCO")
    assert results.version_table(results.read_versions(tmp_path)).splitlines()[2:] == [
        "| planner | COCO | paper | 40.0 [40.0, 40.0] | 80.0 [80.0, 80.0] |"
    ]
    results.add_version(tmp_path, benchmark_run(tmp_path / "run", "autobench", {"c": 90.0}), "Go2")
    assert results.version_table(results.read_versions(tmp_path)).splitlines()[2] == (
        "| planner | COCO | paper | 40.0 [40.0, 40.0] | 80.0 [80.0, 80.0] | - |"
    )
    with (tmp_path / "versions.csv").open(encoding="utf-8") as file:
        rows = [r for r in csv.DictReader(file) if r["robot"] == "COCO"]
        assert [(r["benchmark"], r["scene"], r["episodes"]) for r in rows] == [
            ("craftbench", "a", "2"),
            ("craftbench", "b", "2"),
            ("craftbench_v2", "a", "2"),
            ("craftbench_v2", "b", "2"),
        ]
    with pytest.raises(SystemExit, match="found benchmark 'shipped'"):
        results.add_version(tmp_path, benchmark_run(tmp_path / "other", "shipped", {"a": 1.0}), "COCO")
    with pytest.raises(SystemExit, match=r"found no ends/report\.json"):
        results.add_version(tmp_path, tmp_path, "COCO")


def test_arms_are_compared_with_the_reference_alone_if_that_has_rows() -> None:
    comparison = results.Comparison("student", {"a": "A"}, "as it is", "student-arm-*")
    rates = {"as it is": {"a": np.full((2, 3), 80.0)}, "blind": {"a": np.full((2, 3), 30.0)}}
    assert results.arm_table(comparison, rates).splitlines()[2:] == [
        "| as it is | 2 | 80.0 [80.0, 80.0] |",
        "| blind | 2 | 30.0 [30.0, 30.0] |",
        "| blind - as it is | 2 | -50.0 [-50.0, -50.0] |",
    ]
    assert results.arm_table(comparison, {"blind": rates["blind"]}).count("blind") == 1
    assert results.arm_table(comparison, {}).startswith("Not run yet")


def test_a_difference_pairs_scenes_and_draws_seeds_of_each() -> None:
    scenes = np.linspace(20.0, 90.0, 8)
    easier, harder = np.stack([scenes + 5.0] * 3), np.stack([scenes] * 2)
    found = results.difference(easier, harder)
    assert found[:3] == pytest.approx((5.0, 5.0, 5.0))  # the same in every scene, however different the scenes are
    apart = results.difference(easier + np.array([[-9.0], [0.0], [9.0]]), harder)
    assert apart.mean == pytest.approx(5.0)
    # The standard error of a mean of three seeds, times 2 x 1.96; drawn with replacement.
    assert apart.high - apart.low == pytest.approx(3.92 * np.std([-9.0, 0.0, 9.0]) / np.sqrt(3), rel=0.15)


def test_added_arms_stand_in_place_of_those_of_the_same_seed(tmp_path: pathlib.Path) -> None:
    shutil.copy(results.SCORES / "training_streets.csv", tmp_path)
    before = results.read_arms(tmp_path, "training_streets")
    with (tmp_path / "training_streets.csv").open(encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file) if (row["arm"], row["seed"]) == ("144 procedural", "1")]
    by_set = {
        name: {r["scene"]: {"SR": 50.0} for r in rows if r["set"] == name}
        for name in results.COMPARISONS["training_streets"].sets
    }
    body = {"teacher": {name: {"by_scene": scores} for name, scores in by_set.items()}}
    (tmp_path / "result.json").write_text(json.dumps(body))
    results.add_arm(tmp_path, tmp_path / "result.json", "teacher", "training_streets", "144 procedural", 1)
    after = results.read_arms(tmp_path, "training_streets")
    for streets, sets in before.items():
        for name, rates in sets.items():
            wanted = rates.copy()
            if streets == "144 procedural":
                wanted[1] = 50.0
            np.testing.assert_array_equal(after[streets][name], wanted)


def test_a_seed_that_differs_widens_the_interval() -> None:
    scenes = np.linspace(60.0, 90.0, 10)
    alike = results.over_seeds_and_scenes(np.stack([scenes, scenes, scenes]))
    one = results.over_seeds_and_scenes(scenes[None])
    assert alike.mean == one.mean == pytest.approx(75.0)
    assert alike.high - alike.low == pytest.approx(one.high - one.low, rel=0.1)
    # The standard error of a mean of ten draws, times 2 x 1.96.
    assert one.high - one.low == pytest.approx(3.92 * scenes.std() / np.sqrt(10), rel=0.1)
    apart = results.over_seeds_and_scenes(np.stack([scenes - 30.0, scenes, scenes + 30.0]))
    assert apart.high - apart.low > 2.0 * (one.high - one.low)
    assert apart.seeds == 3


def test_a_missing_scene_is_refused_by_name(tmp_path: pathlib.Path) -> None:
    shutil.copy(results.SCORES / "totals.csv", tmp_path)
    rows = (results.SCORES / "by_scene.csv").read_text(encoding="utf-8").splitlines(keepends=True)
    gone = next(i for i, row in enumerate(rows) if row.startswith('"student, ideal sensors",COCO,2,'))
    (tmp_path / "by_scene.csv").write_text("".join(rows[:gone] + rows[gone + 1 :]), encoding="utf-8")
    with pytest.raises(
        SystemExit, match=r"student, ideal sensors, craftbench: found no row for seed and scene \('2', '01_"
    ):
        results.read(tmp_path)


@pytest.mark.extended
def test_a_policy_is_drawn_for_each_benchmark(tmp_path: pathlib.Path) -> None:
    results.draw(results.read(results.SCORES), tmp_path / "figure.png")
    assert (tmp_path / "figure.png").stat().st_size > 10_000


def test_added_rows_stand_in_place_of_those_of_the_same_policy_robot_and_seed(tmp_path: pathlib.Path) -> None:
    for name in ("totals.csv", "by_scene.csv"):
        shutil.copy(results.SCORES / name, tmp_path)
    before = (tmp_path / "by_scene.csv").read_text(encoding="utf-8").splitlines()
    scenes = {
        name: [row.split(",")[5] for row in before if row.startswith("student,COCO,0,") and f",{name}," in row]
        for name in results.BENCHMARKS
    }
    score = {"SR": 12.5, "RC": 50.0, "hit_episodes": 87.5}
    body = {"steps": 7, "student": {name: {"by_scene": dict.fromkeys(ids, score)} for name, ids in scenes.items()}}
    (tmp_path / "result.json").write_text(json.dumps(body))
    results.add(tmp_path, tmp_path / "result.json", "student", "student", "COCO", 0)
    after = (tmp_path / "by_scene.csv").read_text(encoding="utf-8").splitlines()
    others = [row for row in before if not row.startswith("student,COCO,0,")]
    assert len(after) == len(before)
    assert after[: len(others)] == others
    assert after[-1] == f"student,COCO,0,7,autobench,{max(scenes['autobench'])},12.5,50.0,87.5"
    with pytest.raises(SystemExit, match=r"found no agent 'teacher', needed one of \['student'\]"):
        results.add(tmp_path, tmp_path / "result.json", "teacher", "teacher", "COCO", 1)
