"""Models of a made-up street, each in a unit and axes of its own, become one metric trajectory again."""

import dataclasses
import pathlib

import numpy as np
import pycolmap
import pytest
from scipy.spatial.transform import Rotation

from tests.support.street_models import GROUND, HEIGHT, OUT, POINTS, TRAJECTORY, model_of, structure_of
from urbanverse_mjx.capture.path import camera_poses
from urbanverse_mjx.distillation.perception import mapping, pieces, trajectory_error
from urbanverse_mjx.distillation.perception import metric as metric_module
from urbanverse_mjx.distillation.perception.frames import Frames
from urbanverse_mjx.distillation.perception.metric import Metric, to_metric
from urbanverse_mjx.distillation.perception.structure import Structure

#: s of the frames: those of the half turn were left out.
TIMES = 0.5 * (np.arange(2.0 * OUT) + 15.0 * (np.arange(2 * OUT) >= OUT))


def _off(structure: Structure, metric: Metric) -> float:
    """m, largest position error after alignment of the two paths."""
    return trajectory_error(metric.poses, TRAJECTORY[structure.registered[metric.kept]]).worst


THERE, BACK = np.arange(OUT), np.arange(OUT, 2 * OUT)


def test_two_models_that_share_no_point_are_joined():
    structure, codes = structure_of([model_of(THERE, 1, 0.4), model_of(BACK, 2, 2.5)])
    metric = to_metric(structure, codes, HEIGHT, TIMES)
    assert metric.pieces == 2
    assert list(metric.kept) == list(range(2 * OUT))
    assert _off(structure, metric) < 0.35
    np.testing.assert_allclose(metric.scale, np.repeat([1 / 0.4, 1 / 2.5], OUT), rtol=0.02)
    # Points that both observed coincide.
    there, back = (structure.point[np.isin(structure.frame, k)] % len(POINTS) for k in (THERE, BACK))
    seen = np.intersect1d(there, back)
    apart = metric.points[seen] - metric.points[seen + len(POINTS)]
    assert np.median(np.linalg.norm(apart, axis=1)) < 0.35


def test_the_way_keeps_its_order_where_the_later_model_is_the_larger():
    structure, codes = structure_of([model_of(np.arange(20), 1, 0.4), model_of(np.arange(20, 2 * OUT), 2, 2.5)])
    metric = to_metric(structure, codes, HEIGHT, TIMES)
    assert list(structure.registered[metric.kept]) == list(range(2 * OUT))
    assert _off(structure, metric) < 0.35


@pytest.mark.parametrize("factor", [0.2, 4.0])
def test_a_unit_that_changes_on_the_way_is_fixed(factor: float):
    model = model_of(THERE, 1, 1.0)
    at = 20
    anchor = model["poses"][at, :3, 3].copy()
    # Later frames have points of their own, as COLMAP's have where almost no match connects them.
    later = model["frame"] > at
    grown = anchor + factor * (model["points"] - anchor)
    model["points"] = np.concatenate([model["points"], grown])
    model["point"] = np.where(later, model["point"] + len(POINTS), model["point"])
    model["poses"][at + 1 :, :3, 3] = anchor + factor * (model["poses"][at + 1 :, :3, 3] - anchor)
    structure, codes = structure_of([model])
    assert trajectory_error(structure.poses, TRAJECTORY[:OUT]).worst > 3.0
    metric = to_metric(structure, codes, HEIGHT, TIMES)
    assert metric.pieces == 2
    assert _off(structure, metric) < 0.5


def test_a_jump_to_a_house_that_looks_alike_is_undone():
    model = model_of(np.arange(2 * OUT), 1, 1.0)
    # Behind the turn COLMAP's model continues 11 m ahead, rotated by a quarter turn.
    up = -model["poses"][:, :3, 1].mean(0)
    wrong = Rotation.from_rotvec(np.pi / 2 * up / np.linalg.norm(up)).as_matrix()
    anchor = model["poses"][OUT, :3, 3].copy()
    ahead = anchor + 11.0 * model["poses"][OUT - 1, :3, 2]
    model["points"] = np.concatenate([model["points"], ahead + (model["points"] - anchor) @ wrong.T])
    model["point"] = np.where(model["frame"] >= OUT, model["point"] + len(POINTS), model["point"])
    model["poses"][OUT:, :3, :3] = wrong @ model["poses"][OUT:, :3, :3]
    model["poses"][OUT:, :3, 3] = ahead + (model["poses"][OUT:, :3, 3] - anchor) @ wrong.T
    structure, codes = structure_of([model])
    assert trajectory_error(structure.poses, TRAJECTORY).worst > 5.0
    metric = to_metric(structure, codes, HEIGHT, TIMES)
    assert metric.pieces == 2
    assert _off(structure, metric) < 0.5


def test_a_piece_that_saw_another_street_is_left_out():
    elsewhere = np.random.default_rng(9).uniform([-60.0, -60.0, 0.0], [60.0, 60.0, 5.0], POINTS.shape)
    elsewhere[GROUND] = POINTS[GROUND]
    structure, codes = structure_of([model_of(THERE, 1, 0.4), model_of(BACK[:20], 2, 2.5, elsewhere)])
    metric = to_metric(structure, codes, HEIGHT, TIMES)
    assert list(metric.kept) == list(THERE)
    assert not metric.ground[len(POINTS) :].any()
    assert _off(structure.only(metric.kept), metric) < 0.2


def test_a_piece_without_ground_takes_the_speed_of_the_others():
    blind = model_of(BACK, 2, 2.5)
    blind["ground"] = np.array(False)
    structure, codes = structure_of([model_of(THERE, 1, 0.4), blind])
    metric = to_metric(structure, codes, HEIGHT, TIMES)
    assert metric.scale[-1] == pytest.approx(1 / 2.5, rel=0.02)
    assert _off(structure, metric) < 0.35


def test_who_stands_still_for_a_while_does_not_change_the_scale():
    trajectory = np.concatenate([TRAJECTORY[:15], np.repeat(TRAJECTORY[15:16], 7, 0), TRAJECTORY[16:OUT]])
    structure, codes = structure_of([model_of(np.arange(len(trajectory)), 1, 0.5, trajectory=trajectory)])
    metric = to_metric(structure, codes, HEIGHT)
    assert list(metric.kept) == list(range(len(trajectory)))
    assert trajectory_error(metric.poses, trajectory).worst < 0.5
    np.testing.assert_allclose(metric.scale, 2.0, rtol=0.02)


@pytest.mark.parametrize("at", [0, OUT - 1])
def test_a_single_frame_that_stands_elsewhere_is_left_out(at: int):
    model = model_of(THERE, 1, 0.5)
    model["poses"][at, :3, 3] += 4.0
    structure, codes = structure_of([model])
    metric = to_metric(structure, codes, HEIGHT)
    assert list(metric.kept) == [k for k in THERE if k != at]
    assert _off(structure, metric) < 0.1


class _Model:
    """As much of COLMAP's answer as is asked before it becomes a `Structure`."""

    def __init__(self) -> None:
        camera = pycolmap.Camera(model="SIMPLE_RADIAL", width=320, height=180, params=[210.0, 160.0, 90.0, 0.0])
        self.cameras = {1: camera}

    def num_reg_images(self) -> int:
        return 2 * OUT


def test_a_way_that_breaks_is_made_again_and_the_least_broken_is_kept(monkeypatch: pytest.MonkeyPatch):
    whole, _ = structure_of([model_of(np.arange(2 * OUT), 1, 0.5)])
    poses = whole.poses.copy()
    poses[20:, :3, 3] += 10.0
    jumped = dataclasses.replace(whole, poses=poses)
    poses = poses.copy()
    poses[50:, :3, 3] -= 10.0
    worse = dataclasses.replace(whole, poses=poses)
    tried: list[Structure] = []

    def found(*answers: Structure) -> Structure:
        left = iter(answers)
        tried.clear()

        def made(models: object, frames: object, overlap: object) -> Structure:
            tried.append(next(left))
            return tried[-1]

        monkeypatch.setattr(mapping, "_maps", lambda *_: iter([[_Model()] for _ in answers]))
        monkeypatch.setattr(mapping, "_structure", made)
        monkeypatch.setattr(mapping, "bridged", lambda structure, rebuild: structure)
        frames = Frames(
            pathlib.Path(), tuple(f"{k}.png" for k in range(2 * OUT)), tuple(np.arange(2.0 * OUT)), 320, 180
        )
        return mapping.reconstruct(frames)

    assert found(jumped, whole) is whole
    assert found(worse, jumped) is jumped
    assert found(jumped, worse) is jumped
    assert found(whole, jumped) is whole
    assert len(tried) == 1


@pytest.mark.parametrize(("seconds", "joined"), [(0.5, False), (8.0, True)])
def test_a_camera_does_not_turn_round_between_two_frames(seconds: float, joined: bool) -> None:
    """Half a turn fits what both pieces show, and takes longer than half a second."""
    structure, codes = structure_of([model_of(THERE, 1, 0.4), model_of(BACK, 2, 2.5)])
    times = 0.5 * np.arange(2.0 * OUT) + (seconds - 0.5) * (np.arange(2 * OUT) >= OUT)
    metric = to_metric(structure, codes, HEIGHT, times)
    assert (len(metric.kept) == 2 * OUT) == joined
    if not joined:
        assert list(metric.kept) == list(THERE)


@pytest.mark.parametrize("rate", [0.4, -0.4])
def test_a_piece_is_expected_where_a_turning_camera_would_be(rate: float) -> None:
    """Two pieces of a steady turn, frames 0 to 5 and 10 to 15; the second's axes are turned by 0.7 rad."""
    at = np.arange(16.0)
    poses = camera_poses(np.tile([0.0, 0.0, HEIGHT], (16, 1)), rate * at)
    back = np.eye(4)
    back[:3, :3] = Rotation.from_euler("z", -0.7).as_matrix()
    none = np.zeros((0, 3))
    first, second = (
        pieces.Piece(rows, rows, at[rows], 0, place @ poses[rows], none)
        for rows, place in ((np.arange(6), np.eye(4)), (np.arange(10, 16), back))
    )
    likely, reach = pieces._turned_on(first, 5, second, 0)
    assert np.angle(np.exp(1j * (likely - 0.7))) == pytest.approx(0.0, abs=1e-6)
    assert reach == pytest.approx(np.radians(20.0 + 5 * 10.0))


def test_shifts_are_searched_as_far_as_the_places_may_be_off() -> None:
    """The known points lie 2 m beside the own ones: found where the search reaches so far, never beyond its reach."""
    rng = np.random.default_rng(0)
    own = np.c_[rng.uniform(-15.0, 15.0, (300, 2)), rng.uniform(0.0, 3.0, 300)]
    known = own + [2.0, -1.0, 0.0]
    steps = (np.radians(2.0), np.radians(4.0), 0.5, 0.5)
    found = {
        reach: pieces._search(known, own, lambda _: np.zeros(3), 0.0, np.zeros(2), steps, reach) for reach in (1.0, 3.0)
    }
    for reach, (turns, scores, shifts) in found.items():
        assert len(turns) == len(scores) == len(shifts) == 5
        assert np.abs(shifts).max() <= reach
    turns, scores, shifts = found[3.0]
    best = int(scores.argmax())
    assert turns[best] == pytest.approx(0.0)
    np.testing.assert_allclose(shifts[best], [2.0, -1.0])
    assert scores[best] > 1.2 * found[1.0][1].max()


def _with_drift(scales: np.ndarray) -> tuple[Structure, np.ndarray, np.ndarray]:
    """A structure of one model along 200 m whose unit changes: `scales` (k,) of the frames; each frame's observations
    are points of its own, as far as its unit says. Also the codes of what they show, and the true path (k, 4, 4)."""
    street = np.concatenate([POINTS + [44.0 * k, 0.0, 0.0] for k in range(5)])
    x = np.linspace(5.0, 205.0, len(scales))
    path = camera_poses(np.stack([x, np.full_like(x, -1.2), np.full_like(x, HEIGHT)], -1), 0.25 * np.sin(x / 3))
    model = model_of(np.arange(len(scales)), 1, 1.0, street, path)
    model["frame"], model["point"] = model["frame"][::30], model["point"][::30]
    centres, frame = model["poses"][:, :3, 3], model["frame"]
    moved = np.zeros_like(centres)
    moved[1:] = np.cumsum(np.diff(centres, axis=0) * (scales[1:] + scales[:-1])[:, None] / 2, axis=0)
    seen = moved[frame] + scales[frame, None] * (model["points"][model["point"]] - centres[frame])
    model["poses"][:, :3, 3] = moved
    structure, codes = structure_of([model])
    return dataclasses.replace(structure, points=seen, point=np.arange(len(seen), dtype=np.int32)), codes, path


@pytest.mark.parametrize("ends", [(1.0, 0.88), (1.0, 1.0)])
def test_a_unit_that_drifts_is_held_to_the_cameras_height(ends: tuple[float, float]) -> None:
    scales = 0.4 * np.linspace(*ends, 300)
    structure, codes, path = _with_drift(scales)
    metric = to_metric(structure, codes, HEIGHT)
    assert metric.pieces == 1
    # Without the correction 2.5 m for the first.
    assert trajectory_error(metric.poses, path).worst < 1.2
    np.testing.assert_allclose(metric.scale * scales, 1.0, atol=0.04)
    assert np.nanmedian(metric.heights) == pytest.approx(HEIGHT, rel=0.02)
    # Its points stand where they are: each camera sees them at the same pixels as before.
    before, after = (
        np.einsum("oij,oj->oi", np.linalg.inv(poses)[structure.frame][:, :3, :3], points[structure.point])
        + np.linalg.inv(poses)[structure.frame][:, :3, 3]
        for poses, points in ((structure.poses, structure.points), (metric.poses, metric.points))
    )
    np.testing.assert_allclose(after / after[:, 2:], before / before[:, 2:], atol=1e-6)


def test_heights_over_a_road_do_not_bend_the_drift() -> None:
    """30 of 160 m are 10 % higher above the ground, the rest drifts by 6 %."""
    x = np.linspace(0.0, 160.0, 230)
    true = np.exp(0.06 * x / 160.0)
    found = metric_module._drift(np.stack([x, 0 * x, 0 * x], -1), np.where((x > 60.0) & (x < 90.0), true / 1.1, true))
    np.testing.assert_allclose(found, true, rtol=0.02)
    np.testing.assert_array_equal(metric_module._drift(np.zeros((30, 3)), np.full(30, 0.9)), 1.0)
    unknown = np.where(np.arange(230) < metric_module.MetricOptions().min_heights - 1, true, np.nan)
    np.testing.assert_array_equal(metric_module._drift(np.stack([x, 0 * x, 0 * x], -1), unknown), 1.0)


def test_a_kerb_for_some_metres_does_not_change_the_scale() -> None:
    """Over a road 0.15 m below the pavement the camera is higher above the ground, and no nearer."""
    structure, codes = structure_of([model_of(THERE, 1, 1.0)])
    low = structure.points.copy()
    up = -structure.poses[:, :3, 1].mean(0)
    up /= np.linalg.norm(up)
    along = POINTS[structure.point % len(POINTS), 0]
    rows = np.unique(structure.point[(along > 14.0) & (along < 20.0) & (codes > 0)])
    low[rows] -= 0.15 * up
    metric = to_metric(dataclasses.replace(structure, points=low), codes, HEIGHT)
    assert np.nanmax(metric.heights) > HEIGHT + 0.1
    np.testing.assert_allclose(metric.scale, 1.0, rtol=0.025)
