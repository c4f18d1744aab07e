"""Which way objects face: houses by the front that is seen, others by the known shape on which their points lie, by
their outline, and by the street."""

import numpy as np
import pytest

from urbanverse_mjx.datatypes import LabelPrior, ValidationError
from urbanverse_mjx.distillation import boxes
from urbanverse_mjx.distillation.bearings import Bearings
from urbanverse_mjx.geometry import rotations

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
    # Along x, whichever side its heading is.
    assert np.abs(rotations.about_z(other.yaw)[0, :2]) @ other.size[:2] < 0.5


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


CAR = LabelPrior(np.array([[4.5, 1.8, 1.5]]))


def _car(yaw: float, blur: float) -> tuple[np.ndarray, np.ndarray]:
    """Points on the two visible sides of a car at the origin, and viewpoints that see it obliquely."""
    rng = np.random.default_rng(3)
    side = np.c_[rng.uniform(-2.25, 2.25, 500), np.full(500, -0.9), rng.uniform(0, 1.5, 500)]
    back = np.c_[np.full(200, -2.25), rng.uniform(-0.9, 0.9, 200), rng.uniform(0, 1.5, 200)]
    points = np.concatenate([side, back])
    points[:, :2] += rng.normal(0, blur, (700, 2))
    viewpoints = np.array([[-8.0, -6.0, 1.5], [-7.0, -6.5, 1.5]])
    return _turned(points, yaw), _turned(viewpoints, yaw)


def test_a_car_with_a_slanted_depth_stands_along_the_street_and_keeps_its_sides() -> None:
    points, viewpoints = _car(np.radians(18.0), 0.05)
    own = boxes.fit(points, viewpoints, CAR, 0.02, 1.5, 0.1)
    box = boxes.fit(points, viewpoints, CAR, 0.02, 1.5, 0.1, axis=0.0)
    assert abs(np.degrees(np.angle(np.exp(2j * (own.yaw - np.radians(18.0)))) / 2)) < 4.0
    assert abs(np.sin(box.yaw)) < 1e-6
    # Around the slanted points, a box along the street would be more than a metre wider.
    assert box.seen[:2] == pytest.approx(own.seen[:2], abs=0.1)
    assert box.center[:2] == pytest.approx(own.center[:2], abs=0.4)


@pytest.mark.parametrize(("degrees", "found"), [(12.0, 0.0), (35.0, 35.0)])
def test_a_front_stands_along_the_street_unless_it_clearly_does_not(degrees: float, found: float) -> None:
    rng = np.random.default_rng(0)
    front = np.c_[rng.normal(0.0, 0.05, 600), rng.uniform(-6, 6, 600), rng.uniform(0, 8, 600)]
    viewpoints = np.array([[9.0, -3.0, 1.5], [9.0, 3.0, 1.5]])
    yaw = np.radians(degrees)
    box = boxes.fit(_turned(front, yaw), _turned(viewpoints, yaw), HOUSE, 0.02, 8.0, 0.1, axis=0.0)
    assert abs(np.degrees(np.angle(np.exp(1j * (box.yaw - np.radians(found)))))) < 1.0
    assert box.size[1] == pytest.approx(12.0, abs=1.0)


def _outline(yaw: float, size: tuple[float, float]) -> Bearings:
    """What 14 views of a walk along x at 4 m show of a box at the origin."""
    c, s = np.cos(yaw), np.sin(yaw)
    corners = np.array([[1, 1], [1, -1], [-1, -1], [-1, 1]]) * np.array(size) / 2 @ np.array([[c, s], [-s, c]])
    viewpoint = np.c_[np.linspace(-7, 7, 14), np.full(14, -4.0)]
    away = corners - viewpoint[:, None]
    angle = np.arctan2(away[..., 1], away[..., 0])
    low, high = angle.min(1), angle.max(1)
    return Bearings(np.arange(14), viewpoint, (low + high) / 2, (high - low) / 2, np.linalg.norm(viewpoint, axis=1))


def test_masks_that_hold_some_ground_do_not_turn_an_object_by_a_quarter() -> None:
    """A board of 0.9 x 0.3 m along x; one point in 50 lies up to 1 m before or behind it, as the ground that inaccurate
    masks hold."""
    rng = np.random.default_rng(4)
    board = np.c_[rng.uniform(-0.45, 0.45, 600), rng.uniform(-0.15, 0.15, 600), rng.uniform(0, 1, 600)]
    ground = np.c_[rng.uniform(-0.3, 0.3, 12), rng.uniform(-1.0, 1.0, 12), rng.uniform(0, 0.05, 12)]
    points = np.concatenate([board, ground])
    prior = LabelPrior(np.array([[0.9, 0.3, 1.0]]))
    seen = _outline(0.0, (0.9, 0.3))
    viewpoints = np.c_[seen.viewpoint, np.full(14, 1.5)]
    box = boxes.fit(points, viewpoints, prior, 0.002, 1.0, 0.05, seen)
    assert abs(np.sin(box.yaw)) < 0.1
    # Exact masks would have no such points, so that their sides could be believed.
    exact = boxes.fit(points, viewpoints, prior, 0.002, 1.0, 0.05, seen, exact=True)
    assert abs(np.cos(exact.yaw)) < 0.1
    # The outline alone: points as wide as long.
    square = np.c_[rng.uniform(-0.45, 0.45, (600, 2)), rng.uniform(0, 1, 600)]
    for yaw in (0.0, np.pi / 2):
        turned = boxes.fit(square, viewpoints, prior, 0.002, 1.0, 0.05, _outline(yaw, (0.9, 0.3)))
        assert abs(np.sin(turned.yaw - yaw)) < 0.1


@pytest.mark.parametrize("yaw", np.radians([0.0, 50.0]))
def test_ground_and_walls_in_the_masks_of_a_box_do_not_move_it(yaw: float) -> None:
    """A box of 0.9 x 0.5 x 1.2 m, two of whose sides are seen. A third of the points of its masks are ground around its
    foot, the wall behind it, and what each view shows past its right edge."""
    rng = np.random.default_rng(6)
    size = np.array([0.9, 0.5, 1.2])
    seen = _outline(yaw, (0.9, 0.5))
    viewpoints = np.c_[seen.viewpoint, np.full(14, 1.5)]
    shell = rng.uniform(-0.5, 0.5, (900, 3)) * size
    face = rng.integers(0, 3, 900)
    shell[np.arange(900), face] = rng.choice([-0.5, 0.5], 900) * size[face]
    body = _turned(shell, yaw) + [0.0, 0.0, 0.6]
    around = np.c_[rng.uniform(-1.2, 1.2, (250, 2)), rng.uniform(0.0, 0.03, 250)]
    past = []
    for k in range(14):
        angle = seen.direction[k] - seen.half[k] - 0.02
        along = seen.reach[k] + rng.uniform(1.0, 2.5, 12)
        past.append(
            np.c_[viewpoints[k, 0] + along * np.cos(angle), viewpoints[k, 1] + along * np.sin(angle), np.full(12, 0.8)]
        )
    points = np.concatenate([body, around, *past])
    prior = LabelPrior(size[None])
    box = boxes.fit(points, viewpoints, prior, 0.002, 1.2, 0.05, seen)
    assert box.seen[:2] == pytest.approx(size[:2], abs=0.1)
    assert box.center == pytest.approx([0.0, 0.0, 0.6], abs=0.06)
    # The ground still is its lower end.
    assert box.center[2] - box.size[2] / 2 == pytest.approx(0.0, abs=0.02)
    # With exact masks, all of it would be the object.
    exact = boxes.fit(points, viewpoints, prior, 0.002, 1.2, 0.05, seen, exact=True)
    assert exact.seen[:2].max() > 1.15
    assert np.linalg.norm(exact.center[:2]) > 0.15


def test_what_is_low_or_widest_at_its_foot_keeps_its_sides() -> None:
    """At most a quarter of the height is left out, of a post 0.3 m high on a base of 0.09 m; and nothing where hardly
    anything would remain, of a plate with a knob."""
    rng = np.random.default_rng(7)
    viewpoints = np.array([[-4.0, 0.0, 1.5], [0.0, -4.0, 1.5]])
    base = np.c_[rng.uniform(-0.4, 0.4, (500, 2)), rng.uniform(0.0, 0.09, 500)]
    post = np.c_[rng.uniform(-0.1, 0.1, (500, 2)), rng.uniform(0.09, 0.3, 500)]
    prior = LabelPrior(np.array([[0.8, 0.8, 0.3]]))
    stand = boxes.fit(np.concatenate([base, post]), viewpoints, prior, 0.002, 0.3, 0.05)
    assert stand.seen == pytest.approx([0.8, 0.8, 0.3], abs=0.08)
    plate = np.c_[rng.uniform(-0.4, 0.4, (500, 2)), np.zeros(500)]
    knob = np.c_[rng.uniform(-0.1, 0.1, (100, 2)), rng.uniform(0.0, 0.06, 100)]
    prior = LabelPrior(np.array([[0.8, 0.8, 0.06]]))
    cover = boxes.fit(np.concatenate([plate, knob]), viewpoints, prior, 0.002, 0.06, 0.05)
    assert cover.seen == pytest.approx([0.8, 0.8, 0.06], abs=0.05)
