"""Halves of a structure that a few matches of similar objects link are separated, and rightly linked ones stay."""

import dataclasses

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.support.street_models import (
    CAMERA,
    GROUND,
    HEIGHT,
    OUT,
    POINTS,
    SIDEWALK,
    TRAJECTORY,
    model_of,
    structure_of,
)
from urbanverse_mjx.capture.path import camera_poses
from urbanverse_mjx.distillation.perception import links, trajectory_error
from urbanverse_mjx.distillation.perception.bridges import bridged
from urbanverse_mjx.distillation.perception.metric import to_metric
from urbanverse_mjx.distillation.perception.pieces import cut
from urbanverse_mjx.distillation.perception.structure import Structure

OVERLAP = 8
#: Frames on either side of the half turn, which is in the middle of the street.
HALF = 24
PATH = np.concatenate([TRAJECTORY[:HALF], TRAJECTORY[-HALF:]])
#: s of the frames: those of the half turn were left out.
TIMES = 0.5 * (np.arange(2.0 * HALF) + 15.0 * (np.arange(2 * HALF) >= HALF))


def in_image(structure: Structure) -> np.ndarray:
    """(o,) bool: whether each observation's point is inside its frame's image."""
    inverse = np.linalg.inv(structure.poses)[structure.frame]
    seen = np.einsum("oij,oj->oi", inverse[:, :3, :3], structure.points[structure.point]) + inverse[:, :3, 3]
    pixel = CAMERA.fx * seen[:, :2] / seen[:, 2:] + [CAMERA.cx, CAMERA.cy]
    return ((pixel > 0) & (pixel < [CAMERA.width, CAMERA.height])).all(1)


def only_seen(structure: Structure, seen: np.ndarray) -> Structure:
    """A structure with some of its observations (o,) bool."""
    return dataclasses.replace(
        structure, frame=structure.frame[seen], point=structure.point[seen], pixel=structure.pixel[seen]
    )


def filmed(trajectory: np.ndarray, seed: int = 0, share: float = 0.6) -> Structure:
    """The right structure of a film (m, 4, 4) in the made-up street: each frame finds a share of what it shows."""
    made, _ = structure_of([model_of(np.arange(len(trajectory)), 3, 0.7, trajectory=trajectory)])
    rng = np.random.default_rng(seed)
    return only_seen(made, in_image(made) & (rng.random(len(made.frame)) < share))


def split(structure: Structure, own: np.ndarray | None = None, overlap: int = OVERLAP) -> Structure:
    return links.split(structure, np.zeros(len(structure.model), int) if own is None else own, overlap)


def wrongly_linked(turn: float, shared: int, seed: int = 0) -> Structure:
    """There and back along the street, where the way back begins at the last frame's place, turned from it by `turn`
    rad, instead of by half a turn; it is held there by `shared` points on a wall that frames of both sides see."""
    whole = filmed(PATH, seed)
    up = -whole.poses[:, :3, 1].mean(0)
    up /= np.linalg.norm(up)
    goal = np.identity(4)
    goal[:3, :3] = Rotation.from_rotvec(turn * up).as_matrix() @ whole.poses[HALF - 1, :3, :3]
    step = whole.poses[HALF - 1, :3, 3] - whole.poses[HALF - 2, :3, 3]
    goal[:3, 3] = whole.poses[HALF - 1, :3, 3] + step
    wrong = goal @ np.linalg.inv(whole.poses[HALF])
    poses = whole.poses.copy()
    poses[HALF:] = wrong @ poses[HALF:]
    count = len(whole.points)
    points = np.concatenate([whole.points, whole.points @ wrong[:3, :3].T + wrong[:3, 3]])
    point = np.where(whole.frame >= HALF, whole.point + count, whole.point)
    # Points of the last frames that the first ones of the way back have in their images, from near ones on.
    frames = np.arange(HALF - 4, HALF + 4)
    inverse = np.linalg.inv(poses)[frames]
    known = np.unique(point[np.isin(whole.frame, frames[:4])])
    seen = np.einsum("fij,pj->fpi", inverse[:, :3, :3], points[known]) + inverse[:, None, :3, 3]
    pixel = CAMERA.fx * seen[..., :2] / seen[..., 2:] + [CAMERA.cx, CAMERA.cy]
    inside = ((pixel > 0) & (pixel < [CAMERA.width, CAMERA.height])).all(-1) & (seen[..., 2] > 0)
    wall = known[inside.all(0)]
    assert len(wall) >= shared + 3
    near = np.linalg.norm(points[wall] - points[wall[0]], axis=1)
    chosen = wall[np.argsort(near)[:shared]]
    # Three more are seen by the first of the way back alone.
    once = wall[np.argsort(near)[shared : shared + 3]]
    frame = np.concatenate([whole.frame, np.repeat(frames[4:], shared), np.full(3, HALF)]).astype(np.int32)
    point = np.concatenate([point, np.tile(chosen, 4), once]).astype(np.int32)
    pixels = np.concatenate([whole.pixel, np.zeros((4 * shared + 3, 2), np.float32)])
    return dataclasses.replace(whole, poses=poses, points=points, frame=frame, point=point, pixel=pixels)


def turning(turn: float, count: int) -> np.ndarray:
    """(m, 4, 4): along the street, `turn` rad within `count` steps at the end of it, and on or back."""
    x = 5.0 + 0.9 * np.arange(20)
    there = np.c_[x, np.full(20, -1.2), np.full(20, HEIGHT)]
    end = there[-1] + np.c_[0.05 * np.arange(1, count), 0.1 * np.arange(1, count), np.zeros(count - 1)]
    ahead = np.array([np.cos(turn), np.sin(turn), 0.0])
    after = (end[-1:] if count > 1 else there[-1:]) + 0.5 * np.arange(1, 13)[:, None] * ahead
    yaw = np.r_[np.zeros(20), turn * np.arange(1, count) / count, np.full(12, turn)]
    return camera_poses(np.concatenate([there, end, after]), yaw)


def _named(structure: Structure) -> np.ndarray:
    """(o,): frame and point of each observation, the same in structures that number the points differently."""
    rows = np.c_[structure.frame, structure.points[structure.point]]
    return np.array([row.tobytes() for row in rows])


def _halves(structure: Structure) -> tuple[np.ndarray, np.ndarray]:
    """(o,) bool of both halves: observations of their frames."""
    return structure.frame < HALF, structure.frame >= HALF


@pytest.mark.parametrize("shared", [20, 45])
@pytest.mark.parametrize("degrees", [-40.0, -15.0, 0.0, 15.0, 40.0])
def test_halves_at_a_wrong_angle_are_separated(degrees: float, shared: int) -> None:
    structure = wrongly_linked(np.radians(degrees), shared)
    # No step is unusual: nothing else notices.
    assert len(cut(structure.model, structure.registered, structure.poses)) == 1
    assert trajectory_error(structure.poses, PATH).worst > 5.0
    found = split(structure)
    np.testing.assert_array_equal(found.model, np.repeat([0, 1], HALF))
    np.testing.assert_array_equal(found.poses, structure.poses)
    assert [len(rows) for rows in cut(found.model, found.registered, found.poses)] == [HALF, HALF]
    # Points are seen by frames of one model alone; each frame sees those of its own that it saw, where they were.
    there, back = (found.point[half] for half in _halves(found))
    assert not np.intersect1d(there, back).size
    assert found.point.max() < len(found.points)
    kept = np.isin(_named(structure), _named(found))
    np.testing.assert_array_equal(_named(structure)[kept], _named(found))
    # Gone are the single views of points that the other half sees.
    views = [np.bincount(structure.point[half], minlength=len(structure.points)) for half in _halves(structure)]
    single = [half & (own == 1)[structure.point] for half, own in zip(_halves(structure), views, strict=True)]
    shown_twice = (np.minimum(*views) > 0)[structure.point]
    np.testing.assert_array_equal(kept, ~(shown_twice & (single[0] | single[1])))
    assert (~kept).sum() >= 3


def test_separated_halves_are_joined_by_what_both_show() -> None:
    structure = wrongly_linked(np.radians(-15.0), 30)
    codes = np.where(GROUND[structure.point % len(POINTS)], SIDEWALK, 0).astype(np.uint8)
    wrong = to_metric(structure, codes, HEIGHT, TIMES)
    assert wrong.pieces == 1
    assert trajectory_error(wrong.poses, PATH).worst > 5.0
    found = split(structure)
    # Observations keep their order.
    kept = np.isin(_named(structure), _named(found))
    metric = to_metric(found, codes[kept], HEIGHT, TIMES)
    assert metric.pieces == 2
    assert list(metric.kept) == list(range(2 * HALF))
    assert trajectory_error(metric.poses, PATH).worst < 0.5


def test_a_bridge_with_the_same_wrong_link_is_not_built() -> None:
    structure = wrongly_linked(np.radians(-15.0), 30)
    asked: list[tuple[int, int]] = []

    def again(low: int, high: int) -> Structure:
        asked.append((low, high))
        return split(structure.only(np.arange(low, high + 1)))

    found = split(structure)
    assert bridged(found, again) is found
    assert len(asked) == 1


@pytest.mark.parametrize("share", [0.25, 1.0])
@pytest.mark.parametrize(("degrees", "count"), [(180.0, 7), (-180.0, 9), (90.0, 2), (50.0, 1), (60.0, 1), (120.0, 3)])
def test_a_proper_turn_stays(degrees: float, count: int, share: float) -> None:
    structure = filmed(turning(np.radians(degrees), count), share=share)
    assert split(structure) is structure


def test_frames_without_a_common_view_are_not_judged() -> None:
    """Half a turn between two frames: no point of one side is expected on the other."""
    structure = filmed(PATH)
    assert split(structure) is structure


@pytest.mark.parametrize(("degrees", "judged"), [(40.0, True), (80.0, False)])
def test_a_sliver_of_a_common_view_is_not_judged(degrees: float, judged: bool) -> None:
    """A right turn between two frames without a match; the image is 75 degrees wide."""
    structure = filmed(turning(np.radians(degrees), 1))
    side = structure.frame >= 20
    structure = dataclasses.replace(
        structure,
        points=np.concatenate([structure.points] * 2),
        point=np.where(side, structure.point + len(structure.points), structure.point).astype(np.int32),
    )
    assert (split(structure) is structure) != judged


@pytest.mark.parametrize(("second", "judged"), [(-4.0, True), (-2.0, False), (-6.0 + 4.0j, True), (8.0j, False)])
def test_points_from_far_nearer_or_another_side_are_not_expected(second: complex, judged: bool) -> None:
    """A cube is filmed from 8 m in front of it, and next, without a match, from `second` (x + iy, m)."""
    cube = np.random.default_rng(2).uniform([-0.4, -0.4, HEIGHT - 0.4], [0.4, 0.4, HEIGHT + 0.4], (400, 3))
    sideways = 0.02 * np.arange(12)
    paths = []
    for place in (-8.0 + 0.0j, second):
        x = np.full(12, place.real)
        paths.append(camera_poses(np.c_[x, place.imag + sideways, np.full(12, HEIGHT)], np.full(12, np.angle(-place))))
    path = np.concatenate(paths)
    made = structure_of([model_of(rows, 3, 0.7, cube, path) for rows in (np.arange(12), np.arange(12, 24))])[0]
    structure = only_seen(dataclasses.replace(made, model=np.zeros(24, np.int32)), in_image(made))
    assert (split(structure) is structure) != judged


@pytest.mark.parametrize("hidden", ["before", "after"])
def test_something_near_that_hides_the_street_separates_nothing(hidden: str) -> None:
    """A lorry covers nine tenths of the street from one frame on, or up to it; what is beside it both sides see."""
    structure = filmed(turning(np.radians(60.0), 6))
    at = 12
    covered = np.random.default_rng(5).random(len(structure.points)) < 0.9
    behind = structure.frame >= at if hidden == "after" else structure.frame < at
    partly = only_seen(structure, ~(behind & covered[structure.point]))
    assert split(partly) is partly
    # If neither side saw what the other does, it would.
    other = np.where(np.random.default_rng(6).random(len(structure.points)) < 0.9, covered, ~covered)
    contrary = only_seen(partly, behind[~(behind & covered[structure.point])] | other[partly.point])
    found = split(contrary)
    np.testing.assert_array_equal(found.model, np.arange(len(found.model)) >= at)


def in_two_parts(first: np.ndarray, second: np.ndarray, step: float) -> Structure:
    """Two models of parts of one path, `step` m a frame, right and in one unit, without a common point."""
    path = camera_poses(np.c_[5.0 + step * np.arange(OUT), np.full(OUT, -1.2), np.full(OUT, HEIGHT)], np.zeros(OUT))
    made = structure_of([model_of(rows, 3, 0.7, trajectory=path) for rows in (first, second)])[0]
    return only_seen(dataclasses.replace(made, model=np.zeros(len(made.model), np.int32)), in_image(made))


def test_merged_models_have_no_common_points_to_compare() -> None:
    structure = in_two_parts(np.arange(16), np.arange(16, OUT), 0.9)
    own = (np.arange(OUT) >= 16).astype(int)
    assert split(structure, own) is structure
    np.testing.assert_array_equal(split(structure).model, own)


def test_frames_that_were_not_matched_are_not_compared() -> None:
    """Frames 12 to 20 have no pose, and frame 11 was matched with frames up to 19 alone."""
    structure = in_two_parts(np.arange(12), np.arange(21, OUT), 0.2)
    assert split(structure) is structure
    assert list(np.flatnonzero(np.diff(split(structure, overlap=2 * OVERLAP).model))) == [11]


def test_each_wrong_link_is_cut_at_its_own_frame() -> None:
    """There and back, and there again on the other side of the street: two wrong links, 20 frames apart."""
    first = wrongly_linked(np.radians(-15.0), 30).only(np.arange(HALF - 20, HALF + 20))
    np.testing.assert_array_equal(split(first).model, np.repeat([0, 1], 20))
    second = wrongly_linked(np.radians(30.0), 30, seed=3).only(np.arange(HALF - 20, HALF + 20))
    # The second film goes on where the first ends, with the same pose in the frame of both.
    place = first.poses[-1] @ np.linalg.inv(second.poses[0])
    later = second.only(np.arange(1, 40))
    count, rows = len(first.points), len(first.registered)
    both = dataclasses.replace(
        first,
        registered=np.arange(rows + 39, dtype=np.int32),
        poses=np.concatenate([first.poses, place @ later.poses]),
        points=np.concatenate([first.points, later.points @ place[:3, :3].T + place[:3, 3]]),
        frame=np.concatenate([first.frame, later.frame + rows]).astype(np.int32),
        point=np.concatenate([first.point, later.point + count]).astype(np.int32),
        pixel=np.concatenate([first.pixel, later.pixel]),
        model=np.zeros(rows + 39, np.int32),
    )
    own = (np.arange(rows + 39) >= rows).astype(int)
    found = split(both, own)
    assert list(np.flatnonzero(np.diff(found.model))) == [19, rows + 18]
    assert len(np.unique(found.model)) == 3
