"""Models of a made-up street, each in a unit and axes of its own, become one metric trajectory again."""

import dataclasses
import pathlib

import numpy as np
import pycolmap
import pytest
from scipy.spatial.transform import Rotation

from urbanverse_mjx.capture.path import camera_poses
from urbanverse_mjx.datatypes import GROUND_KINDS, Camera
from urbanverse_mjx.distillation.perception import pieces, trajectory_error
from urbanverse_mjx.distillation.perception import structure as structure_module
from urbanverse_mjx.distillation.perception.frames import Frames
from urbanverse_mjx.distillation.perception.metric import Metric, to_metric
from urbanverse_mjx.distillation.perception.structure import Structure

CAMERA = Camera(320, 180, 210.0, 210.0, 160.0, 90.0)
HEIGHT = 1.5  # m
SIDEWALK = GROUND_KINDS.index("sidewalk")
OUT = 36  # frames of the outward path


def _street() -> tuple[np.ndarray, np.ndarray]:
    """(p, 3) m points of two rows of houses that stand forward and back, poles and ground; (p,) whether ground."""
    rng = np.random.default_rng(3)
    x = rng.uniform(0.0, 44.0, 5000)
    side = rng.integers(0, 2, len(x))
    front = rng.uniform(0.0, 1.5, (2, 8))[side, (x / 5.5).astype(int)]
    walls = np.c_[x, (2 * side - 1) * (6.0 + front), rng.uniform(0.0, 5.0, len(x))]
    poles = np.c_[rng.uniform([0.0, -5.0], [44.0, 5.0], (25, 2)), np.zeros(25)]
    poles = np.repeat(poles, 30, 0) + rng.uniform(0.0, [0.2, 0.2, 3.0], (750, 3))
    ground = np.c_[rng.uniform([0.0, -5.0], [44.0, 5.0], (4000, 2)), rng.normal(0.0, 0.01, 4000)]
    points = np.concatenate([walls, poles, ground])
    return points, np.arange(len(points)) >= len(walls) + len(poles)


POINTS, GROUND = _street()


def _trajectory() -> np.ndarray:
    """(2 OUT, 4, 4): along one side, half a turn from one frame to the next, and back along the other."""
    there = np.c_[5.0 + 0.9 * np.arange(OUT), np.full(OUT, -1.2), np.full(OUT, HEIGHT)]
    back = there[::-1] + [0.2, 0.8, 0.0]
    yaw = np.r_[0.25 * np.sin(np.arange(OUT) / 3), np.pi + 0.25 * np.sin(np.arange(OUT) / 3)]
    return camera_poses(np.concatenate([there, back]), yaw)


TRAJECTORY = _trajectory()


def _model(
    rows: np.ndarray, seed: int, unit: float, points: np.ndarray = POINTS, trajectory: np.ndarray = TRAJECTORY
) -> dict[str, np.ndarray]:
    """Points within 14 m of the frames of some rows, in the model's own unit and axes."""
    own = np.eye(4)
    own[:3, :3] = Rotation.random(random_state=seed).as_matrix()
    own[:3, 3] = 3.0 * seed
    ahead = points[None] - trajectory[rows, None, :3, 3]
    seen = (np.linalg.norm(ahead, axis=-1) < 14.0) & (np.einsum("mpi,mi->mp", ahead, trajectory[rows, :3, 2]) > 1.0)
    frame, point = np.nonzero(seen)
    poses = own @ trajectory[rows]
    poses[:, :3, 3] *= unit
    moved = unit * (points @ own[:3, :3].T + own[:3, 3])
    return {"rows": rows, "poses": poses, "points": moved, "frame": frame, "point": point}


def _structure(models: list[dict[str, np.ndarray]]) -> tuple[Structure, np.ndarray]:
    """The models as one structure, and the codes of what its observations show."""
    first = np.cumsum([0, *(len(m["rows"]) for m in models)])
    below = np.cumsum([0, *(len(m["points"]) for m in models)])
    point = np.concatenate([m["point"] + n for m, n in zip(models, below, strict=False)])
    whole = Structure(
        CAMERA,
        0.0,
        np.concatenate([m["rows"] for m in models]).astype(np.int32),
        np.concatenate([m["poses"] for m in models]),
        np.concatenate([m["points"] for m in models]),
        np.concatenate([m["frame"] + n for m, n in zip(models, first, strict=False)]).astype(np.int32),
        point.astype(np.int32),
        np.zeros((len(point), 2), np.float32),
        0.0,
        np.repeat(np.arange(len(models)), np.diff(first)).astype(np.int32),
    )
    on_ground = np.concatenate([GROUND[m["point"] % len(POINTS)] & m.get("ground", True) for m in models])
    return whole, np.where(on_ground, SIDEWALK, 0).astype(np.uint8)


def _off(structure: Structure, metric: Metric) -> float:
    """m, largest position error after alignment of the two paths."""
    return trajectory_error(metric.poses, TRAJECTORY[structure.registered[metric.kept]]).worst


THERE, BACK = np.arange(OUT), np.arange(OUT, 2 * OUT)


def test_two_models_that_share_no_point_are_joined():
    structure, codes = _structure([_model(THERE, 1, 0.4), _model(BACK, 2, 2.5)])
    metric = to_metric(structure, codes, HEIGHT)
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
    structure, codes = _structure([_model(np.arange(20), 1, 0.4), _model(np.arange(20, 2 * OUT), 2, 2.5)])
    metric = to_metric(structure, codes, HEIGHT)
    assert list(structure.registered[metric.kept]) == list(range(2 * OUT))
    assert _off(structure, metric) < 0.35


@pytest.mark.parametrize("factor", [0.2, 4.0])
def test_a_unit_that_changes_on_the_way_is_fixed(factor: float):
    model = _model(THERE, 1, 1.0)
    at = 20
    anchor = model["poses"][at, :3, 3].copy()
    # Later frames have points of their own, as COLMAP's have where almost no match connects them.
    later = model["frame"] > at
    grown = anchor + factor * (model["points"] - anchor)
    model["points"] = np.concatenate([model["points"], grown])
    model["point"] = np.where(later, model["point"] + len(POINTS), model["point"])
    model["poses"][at + 1 :, :3, 3] = anchor + factor * (model["poses"][at + 1 :, :3, 3] - anchor)
    structure, codes = _structure([model])
    assert trajectory_error(structure.poses, TRAJECTORY[:OUT]).worst > 3.0
    metric = to_metric(structure, codes, HEIGHT)
    assert metric.pieces == 2
    assert _off(structure, metric) < 0.5


def test_a_jump_to_a_house_that_looks_alike_is_undone():
    model = _model(np.arange(2 * OUT), 1, 1.0)
    # Behind the turn COLMAP's model continues 11 m ahead, rotated by a quarter turn.
    up = -model["poses"][:, :3, 1].mean(0)
    wrong = Rotation.from_rotvec(np.pi / 2 * up / np.linalg.norm(up)).as_matrix()
    anchor = model["poses"][OUT, :3, 3].copy()
    ahead = anchor + 11.0 * model["poses"][OUT - 1, :3, 2]
    model["points"] = np.concatenate([model["points"], ahead + (model["points"] - anchor) @ wrong.T])
    model["point"] = np.where(model["frame"] >= OUT, model["point"] + len(POINTS), model["point"])
    model["poses"][OUT:, :3, :3] = wrong @ model["poses"][OUT:, :3, :3]
    model["poses"][OUT:, :3, 3] = ahead + (model["poses"][OUT:, :3, 3] - anchor) @ wrong.T
    structure, codes = _structure([model])
    assert trajectory_error(structure.poses, TRAJECTORY).worst > 5.0
    metric = to_metric(structure, codes, HEIGHT)
    assert metric.pieces == 2
    assert _off(structure, metric) < 0.5


def test_a_piece_that_saw_another_street_is_left_out():
    elsewhere = np.random.default_rng(9).uniform([-60.0, -60.0, 0.0], [60.0, 60.0, 5.0], POINTS.shape)
    elsewhere[GROUND] = POINTS[GROUND]
    structure, codes = _structure([_model(THERE, 1, 0.4), _model(BACK[:20], 2, 2.5, elsewhere)])
    metric = to_metric(structure, codes, HEIGHT)
    assert list(metric.kept) == list(THERE)
    assert not metric.ground[len(POINTS) :].any()
    assert _off(structure.only(metric.kept), metric) < 0.2


def test_a_piece_without_ground_takes_the_speed_of_the_others():
    blind = _model(BACK, 2, 2.5)
    blind["ground"] = np.array(False)
    structure, codes = _structure([_model(THERE, 1, 0.4), blind])
    metric = to_metric(structure, codes, HEIGHT)
    assert metric.scale[-1] == pytest.approx(1 / 2.5, rel=0.02)
    assert _off(structure, metric) < 0.35


def test_who_stands_still_for_a_while_does_not_change_the_scale():
    trajectory = np.concatenate([TRAJECTORY[:15], np.repeat(TRAJECTORY[15:16], 7, 0), TRAJECTORY[16:OUT]])
    structure, codes = _structure([_model(np.arange(len(trajectory)), 1, 0.5, trajectory=trajectory)])
    metric = to_metric(structure, codes, HEIGHT)
    assert list(metric.kept) == list(range(len(trajectory)))
    assert trajectory_error(metric.poses, trajectory).worst < 0.5
    np.testing.assert_allclose(metric.scale, 2.0, rtol=0.02)


@pytest.mark.parametrize("at", [0, OUT - 1])
def test_a_single_frame_that_stands_elsewhere_is_left_out(at: int):
    model = _model(THERE, 1, 0.5)
    model["poses"][at, :3, 3] += 4.0
    structure, codes = _structure([model])
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
    whole, _ = _structure([_model(np.arange(2 * OUT), 1, 0.5)])
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

        def made(models: object, frames: object) -> Structure:
            tried.append(next(left))
            return tried[-1]

        monkeypatch.setattr(structure_module, "_maps", lambda *_: iter([[_Model()] for _ in answers]))
        monkeypatch.setattr(structure_module, "_structure", made)
        frames = Frames(
            pathlib.Path(), tuple(f"{k}.png" for k in range(2 * OUT)), tuple(np.arange(2.0 * OUT)), 320, 180
        )
        return structure_module.reconstruct(frames)

    assert found(jumped, whole) is whole
    assert found(worse, jumped) is jumped
    assert found(jumped, worse) is jumped
    assert found(whole, jumped) is whole
    assert len(tried) == 1


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
