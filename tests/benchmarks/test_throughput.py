"""The speedometer's timing, placing, configurations, baselines and tables, each on its own; the whole runs in
`test_throughput_run`."""

import json
import pathlib
import subprocess
import sys
from types import SimpleNamespace
from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest
from PIL import Image

from benchmarks import throughput
from benchmarks.lib import memory, placing, report, timing
from benchmarks.lib.cases import Case, read_grid
from tests.support.box_bank import box_bank
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.robots import make_coco


def test_samples_give_median_spread_and_rate() -> None:
    sample = timing.Sample((2.0, 1.0, 4.0))
    assert sample.median == 2.0
    assert sample.spread == 1.5  # (4 - 1) / 2
    assert sample.rate(10) == 5.0


def test_timing_leaves_the_first_call_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """By a clock that the calls themselves put forward: 5 s the first one, 1 s each of the others."""
    calls: list[float] = []
    monkeypatch.setattr(timing, "time", SimpleNamespace(perf_counter=lambda: sum(calls)))

    def slow_first() -> Any:
        calls.append(1.0 if calls else 5.0)
        return jnp.zeros(())

    assert timing.time_(slow_first, repeats=3).seconds == (1.0, 1.0, 1.0)
    assert len(calls) == 4


def test_what_was_called_before_is_not_timed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Devices work in order: whoever awaits a result awaits all work that was dispatched before, too."""
    clock, pending = [0.0], [7.0]

    def dispatch() -> None:
        pending.append(1.0)

    def wait(_: Any) -> None:
        clock[0] += sum(pending)
        pending.clear()

    monkeypatch.setattr(timing, "time", SimpleNamespace(perf_counter=lambda: clock[0]))
    monkeypatch.setattr(timing, "jax", SimpleNamespace(block_until_ready=wait))
    assert timing.time_(dispatch, repeats=3).seconds == (1.0, 1.0, 1.0)


def test_calls_in_turn_alternate() -> None:
    order: list[str] = []
    calls = {name: lambda name=name: order.append(name) or jnp.zeros(()) for name in ("a", "b")}
    samples = timing.time_in_turn(calls, repeats=2)
    assert order == ["a", "b"] * 3
    assert {name: len(sample.seconds) for name, sample in samples.items()} == {"a": 2, "b": 2}


def test_offsets_point_to_the_nearest_point_of_each_box(small_bank: SceneBank) -> None:
    """Against the hulls' own corners: no corner of a hull is nearer than its box, and inside is zero."""
    scene = 1
    rng = np.random.default_rng(0)
    points = np.column_stack([rng.uniform(0, 60, 50), rng.uniform(-8, 8, 50), rng.uniform(0, 1, 50)])
    offsets = placing._offsets_to_boxes(small_bank, scene, points)
    rows = np.flatnonzero(small_bank.inst_hull[scene] >= 0)
    for column, row in enumerate(rows):
        hull = small_bank.inst_hull[scene, row]
        corners = small_bank.hull_vertices[hull] @ small_bank.inst_rotation[scene, row].T
        corners = corners + small_bank.inst_position[scene, row]
        to_corners = np.linalg.norm(points[:, None] - corners[None], axis=-1).min(1)
        assert (np.linalg.norm(offsets[:, column], axis=-1) <= to_corners + 1e-4).all()
        centre = (
            small_bank.hull_box[hull, 0] @ small_bank.inst_rotation[scene, row].T + small_bank.inst_position[scene, row]
        )
        assert np.abs(placing._offsets_to_boxes(small_bank, scene, centre[None])[0, column]).max() < 1e-5


def test_crowded_poses_face_the_nearest_hull_and_hold_the_most(small_bank: SceneBank) -> None:
    robot = make_coco()
    poses = placing.crowded_poses(small_bank, robot, 12, control_dt=0.2)
    assert (np.diff(poses.in_reach) <= 0).all()
    assert poses.in_reach.min() >= 1
    everywhere = placing.crowded_poses(small_bank, robot, 5000, control_dt=0.2)
    assert poses.in_reach.max() == everywhere.in_reach.max()
    for scene, position, yaw, distance in zip(poses.scene, poses.position, poses.yaw, poses.distance, strict=True):
        camera_position = position + np.array([0.0, 0.0, 0.5 * robot.planner_height])
        offsets = placing._offsets_to_boxes(small_bank, int(scene), camera_position[None].astype(np.float32))[0]
        lengths = np.linalg.norm(offsets, axis=-1)
        assert lengths.min() == pytest.approx(distance, abs=1e-5)
        x, y = offsets[lengths.argmin(), :2]
        if np.hypot(x, y) > 1e-3:
            assert np.cos(yaw) * x + np.sin(yaw) * y == pytest.approx(np.hypot(x, y), abs=1e-4)


def test_a_bank_without_objects_is_refused() -> None:
    with pytest.raises(ValidationError, match="no hull within"):
        placing.crowded_poses(box_bank(1, num_objects=0), make_coco(), 4, control_dt=0.2)


@pytest.mark.extended
def test_peak_memory_grows_with_what_is_held() -> None:
    """In a process of its own: a new peak of this one would take as much memory as all tests so far."""
    code = (
        "import numpy as np; from benchmarks.lib import memory; before = memory.peak_rss_mib()\n"
        "held = np.ones(int((before + 64) * 2**20 / 8)); print(before, memory.peak_rss_mib())"
    )
    # A process begins with the peak of the one that starts it: a shell in between.
    command = ["sh", "-c", '"$0" -c "$1"; exit $?', sys.executable, code]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=pathlib.Path(__file__).parents[2])
    before, after = map(float, done.stdout.split())
    assert before + 32 < after < 3 * before + 256
    assert set(memory.report()) >= {"peak_rss_mib", "peak_device_mib", "peak_warp_pool_mib"}


def cases(*options: str) -> list[Case]:
    return throughput.cases_of(throughput.parse(list(options)))


def test_comma_lists_are_measured_in_every_combination() -> None:
    found = cases("--num-envs", "4,8", "--pixels", "8x12,none", "--scenes", "1,2", "--measure", "step", "--learn")
    assert len(found) == 8
    assert len({(c.num_envs, c.pixels, c.scenes) for c in found}) == 8
    assert {c.size for c in found} == {(8, 12), None}
    assert {c.measure for c in found} == {("step", "learn")}


def test_options_reach_the_config() -> None:
    (case,) = cases("--substeps", "10", "--no-sky", "--shadows", "--set", "vision_config.samples=2", "--num-slots", "8")
    assert case.config_overrides(0.2) == {
        "preset": "cpu",
        "impl": "auto",
        "vision_config.samples": 2,
        "vision_config.height": 36,
        "vision_config.width": 64,
        "vision_config.shadows": True,
        "vision_config.sky": False,
        "sim_dt": 0.02,
        "num_slots": 8,
    }
    assert cases("--pixels", "none")[0].config_overrides(0.2) == {"preset": "cpu", "impl": "auto", "vision": False}


def test_a_grid_names_configurations_one_by_one(tmp_path: pathlib.Path) -> None:
    grid = tmp_path / "grid.json"
    rows = [{"num_envs": 2, "measure": "step,learn"}, {"pixels": "8x12", "rivals": ["c"]}]
    grid.write_text(json.dumps(rows))
    found = cases("--grid", str(grid), "--steps", "7", "--measure", "step")
    assert [(c.num_envs, c.pixels, c.steps) for c in found] == [(2, "36x64", 7), (64, "8x12", 7)]
    assert [c.measure for c in found] == [("step", "learn"), ("step",)]
    assert found[1].rivals == ("c",)
    for case in found:
        assert Case.from_json(json.loads(json.dumps(case.to_json()))) == case


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--pixels", "36"], "needed HEIGHTxWIDTH such as 36x64"),
        (["--pixels", "36x"], "needed HEIGHTxWIDTH such as 36x64"),
        (["--pixels", "0x4"], "needed HEIGHTxWIDTH such as 36x64"),
        (["--num-envs", "0"], "num_envs: found 0"),
        (["--num-envs", "a"], "--num-envs: found 'a', needed a comma list of numbers"),
        (["--measure", "speed"], "measure: found 'speed', needed some of step"),
        (["--baselines", "isaac"], "found 'isaac', needed one of mjx, warp, c"),
        (["--impl", "fast"], "found 'fast', needed one of"),
        (["--set", "samples"], "needed KEY=JSON"),
        (["--grid", "none.json"], "found no readable JSON"),
        (["--bank", "none.npz"], "no such file"),
    ],
)
def test_mistakes_are_one_sentence(options: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert throughput.main([*options, "--json"]) == 2
    error = capsys.readouterr().err
    assert error.startswith("error: ")
    assert said in error


@pytest.mark.parametrize("body", ["{}", "[]", "[1]", '[{"envs": 3}]', '[{"measure": 3}]'])
def test_a_grid_must_be_one(body: str, tmp_path: pathlib.Path) -> None:
    grid = tmp_path / "grid.json"
    grid.write_text(body)
    with pytest.raises(ValidationError, match="grid"):
        cases("--grid", str(grid))


MACHINE = {"device": "cpu", "cores": 2}


def row(rate: float, **more: Any) -> dict[str, Any]:
    same = {"env": "CocoNav", "impl": "jax", "num_envs": 64, "pixels": [36, 64], "bank": "0123", "machine": MACHINE}
    return {**same, "env_steps_per_s": rate, "parts": {"physics_steps_per_s": 50 * rate}, **more}


def test_a_run_is_compared_with_its_own_baseline(tmp_path: pathlib.Path) -> None:
    path = tmp_path / "cpu.json"
    report.save_baseline([row(100.0), row(10.0, num_envs=8), row(0.0, num_envs=9, error="out of memory")], path)
    now = [row(86.0), row(8.0, num_envs=8), row(1.0, num_envs=9), row(1.0, bank="other")]
    found = {(f["baseline"], f["rate"]): f for f in report.compare(now, path, 0.15)}
    assert len(found) == 4  # two rates of the two rows that the baseline holds
    assert found[100.0, "env_steps_per_s"]["ratio"] == pytest.approx(0.86)
    assert not found[100.0, "env_steps_per_s"]["slower"]
    assert found[10.0, "env_steps_per_s"]["slower"]
    assert found[500.0, "parts.physics_steps_per_s"]["slower"]
    # A rate that the baseline has and the run lacks is slower, too.
    lacking = {name: value for name, value in row(100.0).items() if name != "parts"}
    assert [f["slower"] for f in report.compare([lacking], path, 0.15)] == [False, True]


def test_every_device_kind_has_a_baseline_of_its_own() -> None:
    path = report.own_baseline([{"error": "x"}, row(1.0, machine={"device": "NVIDIA H200", "cores": 16})])
    assert path.parts[-3:] == ("benchmarks", "baselines", "nvidia-h200.json")


@pytest.mark.parametrize("name", ["cpu", "gpu"])
def test_the_shipped_grids_are_valid(name: str) -> None:
    grid = pathlib.Path(throughput.__file__).parent / "grids" / f"{name}.json"
    rows = read_grid(grid, Case())
    assert len({json.dumps(r.to_json()) for r in rows}) == len(rows) > 2


def test_what_cannot_be_compared_is_refused(tmp_path: pathlib.Path) -> None:
    path = tmp_path / "cpu.json"
    with pytest.raises(ValidationError, match="found no baseline"):
        report.compare([row(1.0)], path, 0.15)
    report.save_baseline([row(1.0)], path)
    with pytest.raises(ValidationError, match="baseline of cores 2, needed one of 4"):
        report.compare([row(1.0, machine={"device": "cpu", "cores": 4})], path, 0.15)
    with pytest.raises(ValidationError, match="no row of the baseline measured"):
        report.compare([row(1.0, num_envs=1)], path, 0.15)
    path.write_text("{}")
    with pytest.raises(ValidationError, match="found something else"):
        report.compare([row(1.0)], path, 0.15)
    with pytest.raises(ValidationError, match="no row without an error"):
        report.save_baseline([row(1.0, error="x")], path)


def test_the_exit_status_says_whether_it_became_slower(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path, rows = tmp_path / "cpu.json", [row(100.0)]
    monkeypatch.setattr(throughput, "rows_of", lambda case, proof: iter(rows))
    assert throughput.main(["--save-baseline", str(path)]) == 0
    assert throughput.main(["--compare", str(path)]) == 0
    rows[:] = [row(80.0)]
    assert throughput.main(["--compare", str(path)]) == 1
    assert "SLOWER 0.800 of the baseline: env_steps_per_s" in capsys.readouterr().err
    assert throughput.main(["--compare", str(path), "--tolerance", "0.25"]) == 0
    rows[:] = [row(100.0), row(0.0, num_envs=1, error="out of memory")]
    assert throughput.main(["--compare", str(path)]) == 1
    assert throughput.main([]) == 1


def test_the_table_has_a_line_a_row_and_says_what_failed() -> None:
    rows = [row(1234.5), row(0.5, num_envs=9999, error="out of | memory")]
    rows += [{"rival": "C MuJoCo", "does": "one scene for all", "physics_steps_per_s": 777.0, "machine": MACHINE}]
    lines = report.markdown(rows).splitlines()
    assert len(lines) == 5
    assert len({line.count("|") for line in lines}) == 1
    assert "1,234" in lines[2]
    assert "out of / memory" in lines[3]
    assert "one scene for all" in lines[4]
    assert "777" in lines[4]


def test_the_proof_sheet_shows_every_frame_once(tmp_path: pathlib.Path) -> None:
    frames = np.random.default_rng(0).integers(0, 255, (5, 4, 6, 3), np.uint8)
    report.proof_sheet(frames, tmp_path / "proof.png")
    sheet = np.asarray(Image.open(tmp_path / "proof.png"))
    assert sheet.shape == (2 * 5 - 1, 3 * 7 - 1, 3)
    for i, frame in enumerate(frames):
        y, x = i // 3 * 5, i % 3 * 7
        np.testing.assert_array_equal(sheet[y : y + 4, x : x + 6], frame)


def test_numbers_that_json_cannot_hold_become_none() -> None:
    found = report.rounded({"a": 1.23456, "b": {"c": float("nan")}, "d": 12345})
    assert found == {"a": 1.235, "b": {"c": None}, "d": 12345}


def test_the_hash_of_a_bank_tells_banks_apart(small_bank: SceneBank) -> None:
    assert report.bank_hash(small_bank) == report.bank_hash(box_bank(3, seed=0))
    assert report.bank_hash(small_bank) != report.bank_hash(box_bank(3, seed=1))


def test_an_isolated_case_that_dies_becomes_a_row(monkeypatch: pytest.MonkeyPatch) -> None:
    """The process prints one row and is killed: the row is kept, and another one records how the process ended."""

    def run(command: list[str], input: str, **options: Any) -> Any:
        code = "import os; print('{}', flush=True); os.kill(os.getpid(), 9)"
        return real([sys.executable, "-c", code], input=input, **options)

    real = subprocess.run
    monkeypatch.setattr(subprocess, "run", run)
    first, second = throughput.isolated(Case(num_envs=3), None, 60.0)
    assert first == {}
    assert (second["num_envs"], second["pixels"]) == (3, [36, 64])
    assert "status -9" in second["error"]


def test_an_isolated_case_that_hangs_becomes_a_row(monkeypatch: pytest.MonkeyPatch) -> None:
    def run(command: list[str], input: str, **options: Any) -> Any:
        code = "import time; print('{}', flush=True); time.sleep(60)"
        return real([sys.executable, "-c", code], input=input, **options)

    real = subprocess.run
    monkeypatch.setattr(subprocess, "run", run)
    first, second = throughput.isolated(Case(num_envs=3), None, 2.0)
    assert first == {}
    assert second["error"] == "no end within 2 s"
