"""Small objects, whose depth is blurred, stand along or across the large objects around them."""

import dataclasses

import numpy as np

from urbanverse_mjx.distillation.boxes import Box
from urbanverse_mjx.distillation.objects import Street, shows_street


def house(x: float, y: float, degrees: float, size: tuple[float, float] = (9.0, 5.0)) -> Box:
    whole = np.array([*size, 6.0])
    return Box(np.array([x, y, 3.0]), whole, np.radians(degrees), 0.1, 0.1, (False, False, False), whole)


def street_of(*houses: Box) -> Street:
    return Street.of(houses, [True] * len(houses))


def quarter(angle: float | None) -> float:
    assert angle is not None
    return float(np.degrees(angle) % 90.0)


def test_the_axis_is_that_of_the_houses_around_whatever_way_they_face() -> None:
    street = street_of(house(0, 5, 10), house(10, 5, 100), house(20, 5, -80), house(30, 5, 191))
    assert abs(quarter(street.axis(np.array([12.0, 0.0]))) - 10.0) < 1.0


def test_near_houses_say_more_than_far_ones() -> None:
    street = street_of(*(house(x, 5, 0) for x in (0, 10, 20)), *(house(80, y, 30) for y in (0, 10, 20)))
    assert quarter(street.axis(np.array([5.0, 0.0]))) % 89.0 < 3.0
    assert abs(quarter(street.axis(np.array([78.0, 12.0]))) - 30.0) < 3.0


def test_no_axis_far_from_everything_or_where_houses_disagree() -> None:
    street = street_of(house(0, 5, 0), house(4, -5, 45))
    assert street.axis(np.array([2.0, 0.0])) is None
    assert street_of(house(0, 5, 0)).axis(np.array([200.0, 0.0])) is None
    assert street_of().axis(np.zeros(2)) is None


def test_long_sharp_sides_say_more_than_short_blurred_ones() -> None:
    row = [house(0, 5, 4, (16.0, 5.0))]
    row += [dataclasses.replace(house(x, -5, 12, (5.0, 3.0)), blur=0.6) for x in (-4, 0, 4)]
    assert abs(quarter(street_of(*row).axis(np.zeros(2))) - 4.0) < 1.0


def test_vehicles_say_less_than_houses() -> None:
    row = [house(0, 5, 0), house(0, -3, 8)]
    assert abs(quarter(street_of(*row).axis(np.zeros(2))) - 4.0) < 0.5
    assert quarter(Street.of(row, [True, False]).axis(np.zeros(2))) < 2.0


def test_an_oblique_house_does_not_turn_the_street() -> None:
    row = [house(x, 5, 3) for x in (-20, -10, 0, 10, 20)]
    assert abs(quarter(street_of(*row, house(5, -5, 28)).axis(np.zeros(2))) - 3.0) < 0.8


def test_what_was_seen_with_a_long_side_shows_the_street() -> None:
    assert shows_street(house(0, 5, 20, (5.0, 2.0)))
    assert not shows_street(house(0, 5, 20, (2.0, 0.5)))
    assert not shows_street(house(0, 5, 20, (5.0, 4.8)))
    # As wide as deep, but its front alone was seen.
    front = dataclasses.replace(house(0, 5, 20, (6.0, 6.0)), seen=np.array([1.0, 6.0, 6.0]))
    assert shows_street(front)
