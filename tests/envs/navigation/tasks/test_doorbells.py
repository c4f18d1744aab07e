"""Where doorbells stand in a yard whose distances are known, and the lines that lead to them."""

from typing import Any

import numpy as np
import pytest
import shapely

from urbanverse_mjx.envs.navigation.clearance_maps import CELL
from urbanverse_mjx.envs.navigation.tasks import doorbells
from urbanverse_mjx.envs.navigation.tasks.doorbells import APPROACH, BESIDE, MARGIN, STANDOFF, START_ANGLE, Options
from urbanverse_mjx.envs.navigation.tasks.posts import DEPTH, HALF_SIDE, HEADINGS

RADIUS = 0.4
#: m, corner and size of a yard, and the middle of a pillar of 0.5 m radius in it.
ORIGIN, SIZE, PILLAR = np.array([-4.0, 7.0]), np.array([24.0, 16.0]), np.array([8.0, 15.0])


def clear(points: np.ndarray) -> np.ndarray:
    """m, to the walls and the pillar."""
    inside = np.minimum(points - ORIGIN, ORIGIN + SIZE - points).min(-1)
    return np.minimum(inside, np.linalg.norm(points - PILLAR, axis=-1) - 0.5)


def ground(points: np.ndarray) -> np.ndarray:
    """m, level west of x = 14, then up to x = 16, where there is a step of 3 cm."""
    x = points[..., 0]
    return 0.1 * np.clip(x - 14.0, 0.0, 2.0) + 0.03 * (x >= 16.0)


def yard(paved: bool = True) -> doorbells._Street:
    cells = (round(SIZE[0] / CELL), round(SIZE[1] / CELL))
    centres = ORIGIN + (np.moveaxis(np.indices(cells), 0, -1) + 0.5) * CELL
    pavement = np.full(cells, paved)
    pavement[centres[..., 1] > 19.0] = False  # lawn, or whatever
    return doorbells._Street(ORIGIN, clear(centres), ground(centres), pavement, RADIUS)


def test_straight_lines_keep_their_distance_and_climb_no_step() -> None:
    street = yard()
    lines = [
        ((0.0, 9.0), (6.0, 9.0), True),
        ((0.0, 7.6), (6.0, 7.6), True),  # 0.6 m beside a wall
        ((0.0, 7.42), (6.0, 7.42), False),  # 0.42 m
        ((4.0, 15.0), (12.0, 15.0), False),  # through the pillar
        ((4.0, 13.9), (12.0, 13.9), True),  # 0.6 m beside it
        ((4.0, 14.1), (12.0, 14.1), False),
        ((0.0, 14.0), (8.0, 11.0), True),
        ((13.0, 9.0), (15.5, 9.0), True),  # 1 cm in 10 cm
        ((15.0, 9.0), (17.5, 9.0), False),  # over the step
        ((17.0, 9.0), (17.0, 12.0), True),  # along the step
        ((3.0, 10.0), (3.0, 10.0), True),
        ((3.0, 10.0), (3.05, 10.0), True),
    ]
    start, end, expected = (np.array(column) for column in zip(*lines, strict=True))
    np.testing.assert_array_equal(street.passable(start, end), expected)
    for a, b, one in zip(start, end, expected, strict=True):
        assert street.passable(a[None], b[None]).tolist() == [one], "alone as together"
    far = np.array([[-99.0, 8.0], [99.0, 8.0], [3.0, -99.0]])
    nearest = np.array([[-3.975, 8.0], [19.975, 8.0], [3.0, 7.025]])
    np.testing.assert_allclose(street.grid.at(street.clear, far), clear(nearest), atol=CELL)


def test_distances_to_segments() -> None:
    start, end = np.array([[0.0, 0.0], [0.0, 0.0], [2.0, 2.0]]), np.array([[4.0, 0.0], [0.0, 3.0], [2.0, 2.0]])
    for point in ((1.0, 2.0), (-3.0, 4.0), (5.0, -1.0)):
        expected = [
            shapely.distance(shapely.LineString([a, b]) if (a != b).any() else shapely.Point(a), shapely.Point(point))
            for a, b in zip(start, end, strict=True)
        ]
        np.testing.assert_allclose(doorbells._apart(start, end, np.array(point)), expected, atol=1e-9)


@pytest.fixture(scope="module")
def furnished() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Posts (place, heading, button), starts (x, y, z, yaw) and the number of their post."""
    posts, rows = yard().furnish(Options(12, (0.9, 1.2), (2.0, 6.0)), np.random.default_rng(5))
    return (
        np.array([[*place, heading, button] for place, heading, button in posts]),
        np.array([row for row, _ in rows]),
        np.array([number for _, number in rows]),
    )


def directed(yaw: np.ndarray) -> np.ndarray:
    return np.stack([np.cos(yaw), np.sin(yaw)], -1)


def test_posts_stand_beside_walls_on_level_pavement(furnished: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
    posts, _, _ = furnished
    place, out = posts[:, :2], directed(2 * np.pi * posts[:, 3] / HEADINGS)
    assert len(posts) == 12
    apart = np.linalg.norm(place[:, None] - place[None], axis=-1) + 99.0 * np.identity(len(place))
    assert apart.min() >= 3.0
    assert 0.3 < clear(place).min() < 0.45
    beside = clear(place) <= BESIDE + CELL
    assert beside[:8].all(), "first those at walls"
    assert (np.diff(beside.astype(int)) <= 0).all()
    assert (place[:, 1] < 19.0).all()
    stand, approach = (place + (HALF_SIDE + DEPTH + away) * out for away in (STANDOFF, APPROACH))
    assert (stand[:, 1] < 19.0 + CELL).all()
    assert (approach[:, 1] < 19.0 + CELL).all()
    assert clear(approach).min() > 0.8 - CELL
    line = stand + np.linspace(0.0, 1.0, 30)[:, None, None] * (approach - stand)
    assert clear(line).min() > RADIUS + MARGIN - CELL
    np.testing.assert_allclose(posts[:, 2], ground(place), atol=0.02)
    ring = approach + 0.6 * directed(np.arange(64) * np.pi / 32)[:, None]
    rise = np.abs(ground(np.concatenate([stand[None], ring])) - ground(place))
    assert rise.max() < 0.04 + 0.3 * CELL
    button = posts[:, 4] + posts[:, 2] - ground(stand)
    assert 0.9 - 0.01 < button.min() < 0.97
    assert 1.13 < button.max() < 1.2 + 0.01


def test_starts_lead_past_all_posts(furnished: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
    posts, starts, of = furnished
    place, out = posts[:, :2], directed(2 * np.pi * posts[:, 3] / HEADINGS)
    approach, stand = (place + (HALF_SIDE + DEPTH + away) * out for away in (APPROACH, STANDOFF))
    assert np.bincount(of).tolist() == [doorbells.STARTS] * 12
    away = np.linalg.norm(starts[:, :2] - place[of], axis=1)
    assert 2.0 <= away.min() < 2.2
    assert 5.8 < away.max() <= 6.0
    np.testing.assert_allclose(starts[:, 2], ground(starts[:, :2]), atol=0.02)
    line = starts[:, :2] + np.linspace(0.0, 1.0, 120)[:, None, None] * (approach[of] - starts[:, :2])
    assert clear(line).min() > RADIUS + MARGIN - CELL
    # Of many starts for a post at a wall, the nearest is a margin farther from it than a line has to be.
    post, ahead = np.array([2.0, 7.5]), np.array([0.0, HALF_SIDE + DEPTH])
    ends = [post + ahead + [0.0, away] for away in (STANDOFF, APPROACH)]
    many = [
        yard()._starts(post, ends[0], ends[1], np.zeros((0, 2)), (2.0, 6.0), np.random.default_rng(seed))
        for seed in range(25)
    ]
    nearest = min(clear(rows[:, :2]).min() for rows in many)
    assert RADIUS + 2 * MARGIN - CELL < nearest < RADIUS + 2 * MARGIN + 0.08
    keep = RADIUS + HALF_SIDE + MARGIN
    points: Any = shapely.points(place)
    for row, number in zip(starts, of, strict=True):
        lines = shapely.linestrings([row[:2], approach[number]]), shapely.linestrings([approach[number], stand[number]])
        for other, point in enumerate(points):
            assert shapely.distance(lines[0], point) > keep
            assert other == number or shapely.distance(lines[1], point) > keep
    aim = approach[of] - starts[:, :2]
    turn = starts[:, 3] - np.arctan2(aim[:, 1], aim[:, 0])
    assert -START_ANGLE <= turn.min() < -0.9 * START_ANGLE
    assert 0.9 * START_ANGLE < turn.max() <= START_ANGLE


def test_without_pavement_or_room_there_are_none() -> None:
    options = Options(3, (0.9, 1.2), (2.0, 6.0))
    assert yard(paved=False).furnish(options, np.random.default_rng(0)) == ([], [])
    posts, rows = yard().furnish(options._replace(distance=(30.0, 31.0)), np.random.default_rng(0))
    assert (posts, rows) == ([], [])
    posts, _ = yard().furnish(options, np.random.default_rng(0))
    assert len(posts) == 3
