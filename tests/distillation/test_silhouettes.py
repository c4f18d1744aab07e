"""Headings from the angular widths of an object in several views."""

import numpy as np
import pytest

from urbanverse_mjx.datatypes import LabelPrior
from urbanverse_mjx.distillation import silhouettes
from urbanverse_mjx.distillation.bearings import Bearings

SCOOTER = LabelPrior(extents=np.array([[1.2, 0.5, 1.2], [1.0, 0.45, 1.1]]))


def passing(yaw: float, size: tuple[float, float], rim: float = 0.0, side: float = 4.0) -> Bearings:
    """A box at (1, 2) observed on a walk along x at `side` m; directions have an error of `rim` rad."""
    rng = np.random.default_rng(2)
    c, s = np.cos(yaw), np.sin(yaw)
    corners = np.array([[1, 1], [1, -1], [-1, -1], [-1, 1]]) * np.array(size) / 2 @ np.array([[c, s], [-s, c]]) + [1, 2]
    viewpoint = np.c_[np.linspace(-7, 8, 14), np.full(14, 2 - side)]
    away = corners - viewpoint[:, None]
    angle = np.arctan2(away[..., 1], away[..., 0]) + rng.normal(0, rim, (14, 4))
    low, high = angle.min(1), angle.max(1)
    reach = np.linalg.norm(np.array([1, 2]) - viewpoint, axis=1) * (1 + rng.normal(0, 0.1, 14))
    return Bearings(np.arange(14), viewpoint, (low + high) / 2, (high - low) / 2, reach)


def off(a: float, b: float) -> float:
    """Degrees between two headings modulo half a turn."""
    return float(np.degrees(abs((a - b + np.pi / 2) % np.pi - np.pi / 2)))


@pytest.mark.parametrize("yaw", np.radians([0.0, 30.0, 75.0, 120.0, 165.0]))
def test_a_box_turns_out_as_it_stands(yaw: float) -> None:
    fit = silhouettes.face(passing(yaw, (1.2, 0.5)), SCOOTER)
    assert fit is not None
    assert fit.clear
    assert off(fit.best, yaw) <= 6.0


def test_a_size_between_the_known_ones_and_rims_half_a_degree_off_do_not_matter() -> None:
    errors = [
        off(fit.best, yaw)
        for yaw in np.radians(np.arange(0, 180, 15))
        if (fit := silhouettes.face(passing(yaw, (1.1, 0.5), np.radians(0.5)), SCOOTER)) is not None
    ]
    assert len(errors) == 12
    assert np.mean(errors) < 10.0


def test_a_round_object_has_no_clear_heading() -> None:
    angle = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    post = np.c_[0.2 * np.cos(angle), 0.2 * np.sin(angle), np.linspace(0, 1, 40)]
    prior = LabelPrior(extents=np.array([[0.4, 0.4, 1.0]]), shapes=(post,))
    fit = silhouettes.face(passing(0.3, (0.35, 0.35)), prior)
    assert fit is not None
    assert not fit.clear


def test_an_outline_with_a_front_tells_it() -> None:
    # A wedge: a wide back and a narrow front.
    wedge = np.array([[-0.5, -0.5, 0], [-0.5, 0.5, 0], [0.8, 0, 0], [0.8, 0, 1]])
    prior = LabelPrior(extents=np.array([[1.3, 1.0, 1.0]]), shapes=(wedge,))
    for yaw in np.radians([20.0, 200.0]):
        c, s = np.cos(yaw), np.sin(yaw)
        corners = wedge[:3, :2] @ np.array([[c, s], [-s, c]]) + [1, 2]
        viewpoint = np.c_[np.linspace(-7, 8, 14), np.full(14, -2.0)]
        away = corners - viewpoint[:, None]
        angle = np.arctan2(away[..., 1], away[..., 0])
        low, high = angle.min(1), angle.max(1)
        seen = Bearings(
            np.arange(14), viewpoint, (low + high) / 2, (high - low) / 2, np.linalg.norm([1, 2] - viewpoint, axis=1)
        )
        fit = silhouettes.face(seen, prior)
        assert fit is not None
        assert np.cos(fit.best - yaw) > 0.98
        assert fit.tells_front(yaw)
        assert not fit.tells_front(yaw + np.pi)


def test_one_view_or_an_unknown_label_tells_nothing() -> None:
    seen = passing(0.4, (1.2, 0.5))
    assert silhouettes.face(seen.of(np.array([3])), SCOOTER) is None
    assert silhouettes.face(seen, LabelPrior()) is None


POST = np.c_[0.2 * np.cos(np.arange(40) * np.pi / 20), 0.2 * np.sin(np.arange(40) * np.pi / 20), np.linspace(0, 3, 40)]
LAMP = LabelPrior(extents=np.array([[0.4, 0.4, 3.0]]), shapes=(POST,))


def around(yaw: float, size: tuple[float, float]) -> Bearings:
    """A box at (1, 2) observed on a walk along one side and back along the other."""
    ahead, back = passing(yaw, size), passing(yaw, size, side=-5.0)
    joined = [
        np.concatenate([getattr(x, f) for x in (ahead, back)]) for f in ("viewpoint", "direction", "half", "reach")
    ]
    return Bearings(np.arange(28), *joined)


@pytest.mark.parametrize("factor", [0.5, 0.8, 1.0, 1.6])
@pytest.mark.parametrize("yaw", np.radians([0.0, 30.0, 120.0]))
def test_sides_come_from_the_images_and_not_from_the_known_sizes(factor: float, yaw: float) -> None:
    size = np.array([1.2, 0.5]) * [factor, 1.0]
    found = silhouettes.sides(around(yaw, (size[0], size[1])), SCOOTER, yaw, np.array([1.0, 2.0]), 0.2)
    assert found is not None
    # The ratio of the known sides says something, too: a scooter half as long or 1.6 times as long is unusual.
    assert found.size == pytest.approx(size, rel=0.08 if 0.7 < factor < 1.3 else 0.25)
    assert found.error.max() < 0.2


def test_depth_that_is_wrong_and_poses_that_drift_do_not_change_the_sides() -> None:
    seen = around(0.3, (1.2, 0.5))
    drift = np.cumsum(np.random.default_rng(1).normal(0, 0.05, (28, 2)), axis=0)
    moved = Bearings(seen.frame, seen.viewpoint + drift, seen.direction, seen.half, 1.3 * seen.reach)
    found = silhouettes.sides(moved, SCOOTER, 0.3, np.array([1.0, 2.0]), 0.2)
    assert found is not None
    assert found.size == pytest.approx([1.2, 0.5], rel=0.15)


def test_a_wrong_place_from_depth_is_corrected_by_the_directions() -> None:
    found = silhouettes.sides(around(0.0, (1.2, 0.5)), SCOOTER, 0.0, np.array([1.4, 2.5]), 0.5)
    assert found is not None
    assert found.center == pytest.approx([1.0, 2.0], abs=0.05)


def test_from_one_direction_the_hidden_side_follows_from_the_shape() -> None:
    """Far views along y see the width of a thin post alone: it is as deep as wide, whatever is known."""
    away = np.array([[0.0, -12.0], [0.2, -10.0], [-0.1, -8.0]])
    half = np.arcsin(0.05 / np.linalg.norm(away, axis=1))
    towards = np.arctan2(-away[:, 1], -away[:, 0])
    seen = Bearings(np.arange(3), away, towards, half, np.linalg.norm(away, axis=1))
    post = silhouettes.sides(seen, LAMP, 0.0, np.zeros(2), 0.2)
    assert post is not None
    assert post.size[0] < 0.25, "0.4 m is the only known width"
    assert post.size[1] == pytest.approx(post.size[0], rel=0.5)
    assert post.error[0] < 0.5 * post.error[1]


def test_too_few_views_have_no_sides() -> None:
    seen = around(0.0, (1.2, 0.5))
    assert silhouettes.sides(seen.of(np.array([3])), SCOOTER, 0.0, np.zeros(2), 0.2) is None
    assert silhouettes.sides(seen, LabelPrior(), 0.0, np.zeros(2), 0.2) is None
