"""Crosswalks as rectangles, and the cycle of signals."""

import jax.numpy as jnp
import numpy as np
import pytest

from urbanverse_mjx.crowds.crossings import CLEAR, STOP, WALK
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs.navigation.tasks.crosswalks import Crosswalks, Rectangle, _smallest, rectangles
from urbanverse_mjx.envs.navigation.tasks.route import crossings_of_route
from urbanverse_mjx.envs.navigation.tasks.signals import Cycle


def test_the_crosswalk_of_a_street_is_the_one_of_its_regions(small_bank: SceneBank) -> None:
    (row,) = rectangles(small_bank, 0)
    # x 28 to 32, y -4 to 4, in cells of 5 cm.
    np.testing.assert_allclose(row.centre, [30.0, 0.0], atol=0.06)
    np.testing.assert_allclose(row.half, [4.0, 2.0], atol=0.06)
    np.testing.assert_allclose(np.abs(row.axis), [0.0, 1.0], atol=1e-6)


@pytest.mark.parametrize("degrees", [0, 25, 90, 133])
def test_the_smallest_rectangle_of_turned_squares(degrees: int) -> None:
    angle = np.radians(degrees)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    side = 0.05
    x, y = np.meshgrid(np.arange(-3.0 + side / 2, 3.0, side), np.arange(-1.0 + side / 2, 1.0, side))
    row = _smallest(np.stack([x.ravel(), y.ravel()], -1) @ turn.T + [5.0, -2.0], side)
    np.testing.assert_allclose(row.centre, [5.0, -2.0], atol=1e-6)
    np.testing.assert_allclose(row.half, [3.0, 1.0], atol=1e-6)
    assert abs(row.axis @ turn[:, 0]) == pytest.approx(1.0, abs=1e-6)


def test_distances_to_crosswalks_by_hand(small_bank: SceneBank) -> None:
    table = Crosswalks.of(small_bank, [0], None)
    points = jnp.array([[30.0, 0.0], [30.0, 5.0], [35.0, 8.0], [25.0, 0.0]])
    found = np.asarray(table.away(jnp.int32(0), points))[:, 0]
    np.testing.assert_allclose(found, [0.0, 1.0, 5.0, 3.0], atol=0.06)  # the third: a triangle of 3 and 4
    assert np.isinf(np.asarray(table.away(jnp.int32(1), points))).all(), "its row was not asked for"


def test_where_a_line_enters_crosswalks() -> None:
    ahead = Rectangle(np.array([10.0, 0.0]), np.array([0.0, 1.0]), np.array([3.0, 2.0]))
    beside = Rectangle(np.array([10.0, 20.0]), np.array([1.0, 0.0]), np.array([3.0, 2.0]))
    # There, on beyond it, up over the other one, and back.
    line = np.array([[0.0, 0.0], [20.0, 0.0], [20.0, 20.0], [0.0, 20.0], [20.0, 20.0]])
    arcs, rows = crossings_of_route(line, [ahead, beside])
    assert rows.tolist() == [0, 1, 1]
    # 8 m; 40 m and 7 m to x = 13; 60 m and 7 m from x = 0. Within a step of 0.25 m.
    np.testing.assert_allclose(arcs, [8.0, 47.0, 67.0], atol=0.26)


def test_phases_of_a_cycle_by_hand() -> None:
    cycle = Cycle(60.0, 20.0).check(10.0)
    times = jnp.array([0.0, 19.9, 20.1, 25.5, 25.7, 59.9, 60.1])
    # 6 m at 1.07 m/s: 5.6 s of clearance.
    phases = cycle.phase(times, jnp.full(7, 6.0))
    assert phases.tolist() == [WALK, WALK, CLEAR, CLEAR, STOP, STOP, WALK]
    np.testing.assert_allclose(cycle.to_walk(times), [0, 0, 39.9, 34.5, 34.3, 0.1, 0], atol=1e-4)
    np.testing.assert_allclose(cycle.walk_left(times), [20.0, 0.1, 0, 0, 0, 0, 19.9], atol=1e-4)


@pytest.mark.parametrize(
    ("cycle", "words"),
    [
        (Cycle(60.0, 5.0), "config.task.walk: found 5 s, needed at least 7 s"),
        (Cycle(25.0, 20.0), "config.task.cycle: found 25 s, needed more than the 29.3 s"),  # 20 s and 10 m / 1.07 m/s
        (Cycle(float("nan"), 20.0), "config.task.cycle"),
    ],
)
def test_cycles_without_time_are_refused(cycle: Cycle, words: str) -> None:
    with pytest.raises(ValidationError, match=words):
        cycle.check(10.0)
