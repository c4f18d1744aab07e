"""Which way objects face: houses by the front that is seen, others by the known shape on which their points lie."""

import numpy as np
import pytest

from urbanverse_mjx.datatypes import LabelPrior, ValidationError
from urbanverse_mjx.distillation import boxes

HOUSE = LabelPrior(np.array([[9.0, 13.0, 8.0]]), faces_road=True)


def _turned(points: np.ndarray, yaw: float) -> np.ndarray:
    c, s = np.cos(yaw), np.sin(yaw)
    return points @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])


def _chair(rng: np.random.Generator, count: int) -> np.ndarray:
    """(count, 3) m: a seat of 0.5 m by 0.5 m with a back behind it (-x): as long as wide."""
    seat = np.stack([rng.uniform(-0.25, 0.25, count), rng.uniform(-0.25, 0.25, count), np.full(count, 0.45)], -1)
    back = np.stack([np.full(count, -0.25), rng.uniform(-0.25, 0.25, count), rng.uniform(0.45, 0.9, count)], -1)
    legs = rng.choice([-0.24, 0.24], (count, 2))
    leg = np.c_[legs, rng.uniform(0.0, 0.45, count)]
    return np.concatenate([seat, back, leg])[rng.permutation(3 * count)[:count]]


@pytest.mark.parametrize("yaw", np.radians([0.0, 35.0, 100.0, 250.0]))
def test_a_part_of_a_front_is_no_side_wall(yaw: float) -> None:
    """9 m of a front of 13 m, as long as the house is deep, and 2 m of a wall, seen from far along the street, from
    where the wall is the visible face."""
    rng = np.random.default_rng(0)
    front = np.stack([np.zeros(600), rng.uniform(0, 9, 600), rng.uniform(0, 8, 600)], -1)
    wall = np.stack([rng.uniform(-2, 0, 200), np.full(200, 9.0), rng.uniform(0, 8, 200)], -1)
    viewpoints = np.array([[3.0, 25.0, 1.5], [3.0, 30.0, 1.5]])
    points, seen_from = _turned(np.concatenate([front, wall]), yaw), _turned(viewpoints, yaw)
    box = boxes.fit(points, seen_from, HOUSE, 0.002, 8.0, 0.1)
    # Modulo half a turn: the front is a side of 13 m.
    assert abs(np.sin(box.yaw - yaw)) < 0.03
    assert box.size[1] > box.size[0]


def test_a_front_like_none_that_is_known_has_a_depth_all_the_same() -> None:
    """5 m of a front, where every known one has 13; other objects stay as they were seen."""
    rng = np.random.default_rng(0)
    front = np.stack([rng.uniform(-0.2, 0.0, 600), rng.uniform(0, 5, 600), rng.uniform(0, 8, 600)], -1)
    viewpoints = np.array([[9.0, -6.0, 1.5], [9.0, 2.5, 1.5], [9.0, 11.0, 1.5]])
    house = boxes.fit(front, viewpoints, HOUSE, 0.05, 8.0, 0.1)
    assert house.size[0] == pytest.approx(9.0, abs=0.3)
    assert house.seen[:2].min() < 0.5
    # It grows away from where it was seen.
    assert house.center[0] == pytest.approx(-4.5, abs=0.4)
    other = boxes.fit(front, viewpoints, LabelPrior(HOUSE.extents), 0.05, 8.0, 0.1)
    assert other.size[0] < 0.5


@pytest.mark.parametrize("degrees", [0, 75, 140, 310])
def test_a_known_shape_tells_front_from_back(degrees: int) -> None:
    """A chair seen from behind: its box is ambiguous, and the visible side is the back."""
    rng = np.random.default_rng(1)
    shape = _chair(rng, 1500)
    prior = LabelPrior(np.array([[0.5, 0.5, 0.9]]), shapes=(shape,))
    yaw = np.radians(degrees)
    points = _turned(_chair(rng, 400), yaw) + [3.0, 2.0, 0.0]
    viewpoints = _turned(np.array([[-4.0, 0.3, 1.5], [-4.0, -0.3, 1.5]]), yaw) + [3.0, 2.0, 0.0]
    box = boxes.fit(points, viewpoints, prior, 0.002, 0.9, 0.05)
    assert np.cos(box.yaw - yaw) > np.cos(np.radians(5.0))
    blind = boxes.fit(points, viewpoints, LabelPrior(prior.extents), 0.002, 0.9, 0.05)
    assert np.cos(blind.yaw - yaw) < -0.9
    # Depth blurred by a third of its size hides the shape.
    blurred = boxes.fit(points, viewpoints, prior, 0.1, 0.9, 0.05)
    assert np.cos(blurred.yaw - yaw) < -0.9


def test_shapes_belong_to_extents() -> None:
    with pytest.raises(ValidationError, match="one for each extent"):
        LabelPrior(np.ones((2, 3)), shapes=(np.zeros((5, 3)),))
