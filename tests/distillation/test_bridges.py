"""Breaks of a structure are bridged by a mapping of the frames around them, where it fits both sides."""

import dataclasses

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.support.street_models import CAMERA, TRAJECTORY, model_of, structure_of
from urbanverse_mjx.distillation.perception import bridges, trajectory_error
from urbanverse_mjx.distillation.perception.bridges import BridgeOptions, Rebuild, bridged
from urbanverse_mjx.distillation.perception.pieces import cut
from urbanverse_mjx.distillation.perception.structure import Structure

COUNT = len(TRAJECTORY)
OPTIONS = BridgeOptions()


def projected(structure: Structure) -> np.ndarray:
    """(o, 2) pixels where the points of the observations are seen."""
    inverse = np.linalg.inv(structure.poses)[structure.frame]
    seen = np.einsum("oij,oj->oi", inverse[:, :3, :3], structure.points[structure.point]) + inverse[:, :3, 3]
    return CAMERA.fx * seen[:, :2] / seen[:, 2:]


def with_pixels(structure: Structure) -> Structure:
    return dataclasses.replace(structure, pixel=projected(structure).astype(np.float32))


def mapped(low: int, high: int) -> Structure:
    """A right structure of some frames in a unit and axes of its own."""
    rows = np.arange(low, high + 1)
    made = with_pixels(structure_of([model_of(np.arange(COUNT), 7, 0.3)])[0])
    return made.only(rows)


def broken(first: int, last: int, turn: float = 1.0, length: float = 10.0, factor: float = 2.5) -> Structure:
    """A structure whose steps from frame `first` to `last` are `length` times as long, and which goes on behind
    turned by `turn` rad and in a unit of `factor` times that before."""
    whole = with_pixels(structure_of([model_of(np.arange(COUNT), 1, 0.5)])[0])
    poses = whole.poses.copy()
    steps = np.diff(poses[:, :3, 3], axis=0)
    later = Rotation.from_rotvec(turn * np.array([0.3, -0.5, 0.8])).as_matrix()
    for k in range(first, COUNT):
        step = steps[k - 1] * length if k <= last else factor * later @ steps[k - 1]
        poses[k, :3, 3] = poses[k - 1, :3, 3] + step
    poses[last + 1 :, :3, :3] = later @ poses[last + 1 :, :3, :3]
    # The later frames have points of their own, right where they see them.
    shift = poses[-1, :3, 3] - factor * later @ whole.poses[-1, :3, 3]
    count = len(whole.points)
    points = np.concatenate([whole.points, factor * whole.points @ later.T + shift])
    return dataclasses.replace(
        whole, poses=poses, points=points, point=np.where(whole.frame > last, whole.point + count, whole.point)
    )


def counted(rebuild: Rebuild) -> tuple[list[tuple[int, int]], Rebuild]:
    """The windows that are asked for, and the function that is asked."""
    asked: list[tuple[int, int]] = []

    def again(low: int, high: int) -> Structure | None:
        asked.append((low, high))
        return rebuild(low, high)

    return asked, again


@pytest.mark.parametrize(("first", "last"), [(30, 37), (20, 20), (40, 52)])
def test_a_break_is_bridged_exactly(first: int, last: int) -> None:
    structure = broken(first, last)
    assert trajectory_error(structure.poses, TRAJECTORY).worst > 3.0
    assert len(cut(structure.model, structure.registered, structure.poses)) > 1
    asked, rebuild = counted(mapped)
    found = bridged(structure, rebuild)
    assert len(asked) == found.bridges == 1
    assert list(found.registered) == list(range(COUNT))
    assert len(np.unique(found.model)) == 1
    # In the unit and axes of the first frames, in which the whole was right before it was broken.
    right = structure_of([model_of(np.arange(COUNT), 1, 0.5)])[0].poses
    np.testing.assert_allclose(found.poses, right, atol=1e-6)
    assert len(cut(found.model, found.registered, found.poses)) == 1
    # Each frame sees its points where it saw them.
    np.testing.assert_allclose(projected(found), found.pixel, atol=1e-2)
    before = np.bincount(structure.frame, minlength=COUNT)
    assert (np.bincount(found.frame, minlength=COUNT) == before).all()
    assert found.point.max() == len(found.points) - 1


def test_models_without_a_common_frame_become_one() -> None:
    pair = [model_of(np.arange(36), 1, 0.4), model_of(np.arange(36, COUNT), 2, 2.5)]
    structure = with_pixels(structure_of(pair)[0])
    found = bridged(structure, mapped)
    assert set(found.model) == {0}
    assert found.bridges == 1
    np.testing.assert_allclose(found.poses, structure_of([model_of(np.arange(COUNT), 1, 0.4)])[0].poses, atol=1e-6)
    np.testing.assert_allclose(projected(found), found.pixel, atol=1e-2)


def test_two_breaks_one_after_the_other() -> None:
    rows = np.arange(24), np.arange(24, 48), np.arange(48, COUNT)
    structure = with_pixels(
        structure_of([model_of(k, n + 1, unit) for n, (k, unit) in enumerate(zip(rows, (0.4, 2.5, 1.3), strict=True))])[
            0
        ]
    )
    found = bridged(structure, mapped)
    assert list(found.registered) == list(range(COUNT))
    np.testing.assert_allclose(found.poses, structure_of([model_of(np.arange(COUNT), 1, 0.4)])[0].poses, atol=1e-6)
    # The second alone is bridged where the first is not: its sides go on in the unit of the piece before it.
    some = bridged(structure, lambda low, high: mapped(low, high) if low > 24 else None)
    assert [set(some.model[k]) for k in rows] == [{0}, {1}, {1}]
    np.testing.assert_allclose(
        some.poses[24:], structure_of([model_of(np.arange(COUNT), 2, 2.5)])[0].poses[24:], atol=1e-5
    )


def test_what_no_mapping_fits_stays_as_it_is() -> None:
    structure = broken(30, 37)
    # No matches lead across the break: more frames are not tried.
    apart = structure_of([model_of(np.arange(30), 1, 0.4), model_of(np.arange(30, COUNT), 2, 2.5)])[0]
    for nothing in (lambda low, high: None, lambda low, high: apart.only(np.arange(low, high + 1))):
        asked, rebuild = counted(nothing)
        assert bridged(structure, rebuild) is structure
        assert len(asked) == 1
    asked, rebuild = counted(lambda low, high: structure.only(np.arange(low, high + 1)))
    assert bridged(structure, rebuild) is structure
    assert len(asked) == len(OPTIONS.pads)

    def bent(low: int, high: int) -> Structure:
        made = mapped(low, high)
        poses = made.poses.copy()
        poses[:, :3, 3] += (
            0.02 * np.arange(len(poses))[:, None] ** 2 * np.linalg.norm(poses[1, :3, 3] - poses[0, :3, 3])
        )
        return dataclasses.replace(made, poses=poses)

    def turned(low: int, high: int) -> Structure:
        made = mapped(low, high)
        poses = made.poses.copy()
        poses[:, :3, :3] = (
            Rotation.from_rotvec(np.radians(3) * np.arange(len(poses))[:, None] * [0.0, 1.0, 0.0]).as_matrix()
            @ poses[:, :3, :3]
        )
        return dataclasses.replace(made, poses=poses)

    def short(low: int, high: int) -> Structure:
        return mapped(max(low, 24), high)

    for wrong in (bent, turned, short):
        assert bridged(structure, wrong) is structure


def test_a_wider_mapping_is_tried_where_the_first_does_not_fit() -> None:
    structure = broken(30, 37)
    asked, rebuild = counted(
        lambda low, high: mapped(low, high) if len(asked) > 1 else structure.only(np.arange(low, high + 1))
    )
    found = bridged(structure, rebuild)
    assert len(asked) == 2
    assert list(found.registered) == list(range(COUNT))
    assert asked[1][0] < asked[0][0] < 30
    assert 37 < asked[0][1] < asked[1][1]


def test_frames_that_share_a_wrong_unit_are_no_side() -> None:
    """Frames 40 to 52 have the right directions and steps 2.5 times too long: alone they fit any right mapping."""
    structure = structure_of([model_of(np.arange(COUNT), 1, 0.5)])[0]
    poses = structure.poses.copy()
    steps = np.diff(poses[:, :3, 3], axis=0)
    steps[40:52] *= 2.5
    poses[1:, :3, 3] = poses[0, :3, 3] + np.cumsum(steps, axis=0)
    side = bridges._Part(dataclasses.replace(structure, poses=poses), np.arange(COUNT), np.eye(4), 0)
    again = mapped(38, COUNT - 1)
    wrong, right = side.between(40, 52), side.between(54, COUNT - 1)
    assert bridges._laid(again, wrong) is not None
    assert bridges._first_fit(again, side, [wrong]) is None
    found = bridges._first_fit(again, side, [wrong, right])
    assert found is not None
    assert found[1] is right


def test_an_unbroken_structure_and_a_long_break_are_not_mapped_again() -> None:
    asked, rebuild = counted(mapped)
    whole = structure_of([model_of(np.arange(COUNT), 1, 0.5)])[0]
    assert bridged(whole, rebuild) is whole
    long = np.tile(TRAJECTORY, (3, 1, 1))
    long[:, :3, 3] += np.arange(len(long))[:, None] * [0.0, 0.0, 1e-3]
    rows = np.r_[0:36, 36 + OPTIONS.max_gap : 72 + OPTIONS.max_gap]
    apart = structure_of([model_of(rows[:36], 1, 0.4, trajectory=long), model_of(rows[36:], 2, 2.0, trajectory=long)])[
        0
    ]
    assert bridged(apart, rebuild) is apart
    assert not asked
