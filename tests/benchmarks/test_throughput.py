"""The throughput benchmark: its placing and timing on their own, then one tiny run of the whole."""

import json
import pathlib
import time
from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest

from benchmarks import _placing, _timing, throughput
from tests.support.box_bank import box_bank
from urbanverse_mjx.datatypes import NounError, SceneBank
from urbanverse_mjx.robots import make_coco


def test_samples_give_median_spread_and_rate() -> None:
    sample = _timing.Sample((2.0, 1.0, 4.0))
    assert sample.median == 2.0
    assert sample.spread == 1.5  # (4 - 1) / 2
    assert sample.rate(10) == 5.0


def test_timing_awaits_and_leaves_the_first_call_out() -> None:
    calls = []

    def slow_first() -> Any:
        calls.append(None)
        time.sleep(0.2 if len(calls) == 1 else 0.01)
        return jnp.zeros(())

    sample = _timing.time_(slow_first, repeats=3)
    assert len(calls) == 4
    assert 0.01 <= min(sample.seconds)
    assert max(sample.seconds) < 0.2


def test_calls_in_turn_alternate() -> None:
    order: list[str] = []
    calls = {name: lambda name=name: order.append(name) or jnp.zeros(()) for name in ("a", "b")}
    samples = _timing.time_in_turn(calls, repeats=2)
    assert order == ["a", "b"] * 3
    assert {name: len(sample.seconds) for name, sample in samples.items()} == {"a": 2, "b": 2}


def test_peak_memory_grows_with_what_is_held() -> None:
    before = _timing.peak_rss_mib()
    held = np.ones(int((before + 64) * 2**20 / 8))  # as much as the whole process, so it must set a new peak
    assert _timing.peak_rss_mib() > before + 32
    del held


def test_offsets_point_to_the_nearest_point_of_each_box(small_bank: SceneBank) -> None:
    """Against the hulls' own corners: no corner of a hull is nearer than its box, and inside is zero."""
    scene = 1
    rng = np.random.default_rng(0)
    points = np.column_stack([rng.uniform(0, 60, 50), rng.uniform(-8, 8, 50), rng.uniform(0, 1, 50)])
    offsets = _placing._offsets_to_boxes(small_bank, scene, points)
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
        assert np.abs(_placing._offsets_to_boxes(small_bank, scene, centre[None])[0, column]).max() < 1e-5


def test_crowded_poses_face_the_nearest_hull_and_hold_the_most(small_bank: SceneBank) -> None:
    robot = make_coco()
    poses = _placing.crowded_poses(small_bank, robot, 12, control_dt=0.2)
    assert (np.diff(poses.in_reach) <= 0).all()
    assert poses.in_reach.min() >= 1
    everywhere = _placing.crowded_poses(small_bank, robot, 5000, control_dt=0.2)
    assert poses.in_reach.max() == everywhere.in_reach.max()
    for scene, position, yaw, distance in zip(poses.scene, poses.position, poses.yaw, poses.distance, strict=True):
        eye = position + np.array([0.0, 0.0, 0.5 * robot.planner_height])
        offsets = _placing._offsets_to_boxes(small_bank, int(scene), eye[None].astype(np.float32))[0]
        lengths = np.linalg.norm(offsets, axis=-1)
        assert lengths.min() == pytest.approx(distance, abs=1e-5)
        x, y = offsets[lengths.argmin(), :2]
        if np.hypot(x, y) > 1e-3:
            assert np.cos(yaw) * x + np.sin(yaw) * y == pytest.approx(np.hypot(x, y), abs=1e-4)


def test_a_bank_without_objects_is_refused() -> None:
    with pytest.raises(NounError, match="no hull within"):
        _placing.crowded_poses(box_bank(1, num_objects=0), make_coco(), 4, control_dt=0.2)


@pytest.mark.parametrize("pixels", ["36", "36x", "axb", "36x64x3"])
def test_pixels_must_be_height_and_width(pixels: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        throughput.parse(["--pixels", pixels])
    assert caught.value.code == 2
    assert "needed HEIGHTxWIDTH such as 36x64" in capsys.readouterr().err


def test_a_missing_bank_is_one_sentence(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert throughput.main(["--bank", str(tmp_path / "none.npz")]) == 2
    assert capsys.readouterr().err.startswith("error: ")


def test_the_whole_prints_one_json_line_whose_parts_add_up(
    small_bank: SceneBank, tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bank = tmp_path / "bank.npz"
    small_bank.save(bank)
    options = ["--impl", "jax", "--num-envs", "4", "--pixels", "8x12", "--steps", "3", "--repeats", "2", "--json"]
    assert throughput.main([*options, "--bank", str(bank)]) == 0
    (line,) = capsys.readouterr().out.splitlines()
    result = json.loads(line)
    assert (result["num_envs"], result["pixels"], result["impl"]) == (4, [8, 12], "jax")
    seconds, share = result["seconds_per_step"], result["share"]
    assert seconds["physics"] > 0
    assert seconds["render"] > 0
    assert seconds["physics"] + seconds["render"] + seconds["rest"] == pytest.approx(seconds["total"], rel=1e-2)
    assert sum(share.values()) == pytest.approx(1.0, abs=2e-3)
    assert result["env_steps_per_s"] == pytest.approx(4 / seconds["total"], rel=1e-2)
    assert all(value > 0 for value in result["compile_s"].values())
    assert result["memory"]["peak_rss_mib"] > 100
    physics = result["physics_active"]
    assert physics["physics_steps_per_s"] > 0
    ratio = physics["no_slots_physics_steps_per_s"] / physics["physics_steps_per_s"]
    assert physics["cost_ratio_to_no_slots"] == pytest.approx(ratio, rel=1e-2)
    # Robots that stand with hulls in reach and drive at the nearest are in contact for part of the time.
    assert physics["hulls_in_reach_at_start"] >= 1
    assert physics["share_of_envs_in_contact"] > 0
