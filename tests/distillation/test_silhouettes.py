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
