"""The programs against the published algorithm, line by line in float64 and to rounding in float32."""

import functools
from typing import Any

import jax
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.crowds import reference
from urbanverse_mjx.crowds import linear_program
from urbanverse_mjx.crowds.linear_program import HalfPlanes

#: Cases a test: one number, so that few shapes compile, which takes seconds for six lines and more with their square.
CASES = 1000


@functools.cache
def compiled(num_hard: int) -> Any:
    return jax.jit(lambda *a: linear_program.solve(HalfPlanes(*a[:3]), num_hard, *a[3:]))


def solve(
    lines: np.ndarray, num_hard: int, limit: np.ndarray, preferred_velocity: np.ndarray, dtype: Any
) -> np.ndarray:
    """(2, B) velocities for lines (3, N, B), limits (B,) and preferred velocities (2, B)."""
    with jax.enable_x64(dtype == np.float64):
        arrays = [np.asarray(a, dtype) for a in (*lines, limit, *preferred_velocity)]
        return np.stack([np.asarray(a, np.float64) for a in compiled(num_hard)(*arrays)])


def ground_truth(
    lines: np.ndarray, num_hard: int, limit: np.ndarray, preferred_velocity: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The published algorithm's choice (2, B), and whether it satisfies all lines (B,)."""
    chosen, kept = np.zeros_like(preferred_velocity), np.zeros(len(limit), bool)
    for b in range(len(limit)):
        rows = [reference.Line(offset * complex(x, y), complex(y, -x)) for x, y, offset in lines[:, :, b].T.tolist()]
        found, kept[b] = reference.new_velocity(rows, num_hard, float(limit[b]), complex(*preferred_velocity[:, b]))
        chosen[:, b] = found.real, found.imag
    return chosen, kept


def random_cases(seed: int, number: int, num_hard: int, tightness: float, count: int = CASES) -> tuple[Any, ...]:
    """Lines (3, N, B) with hard ones that permit rest, limits and preferred velocities."""
    rng = np.random.default_rng(seed)
    angle = rng.uniform(-np.pi, np.pi, (number, count))
    offset = rng.normal(tightness - 0.5, 0.7, (number, count))
    offset[:num_hard] = -np.abs(offset[:num_hard])
    lines = np.stack([np.cos(angle), np.sin(angle), offset])
    return lines, rng.uniform(0.5, 2.0, count), rng.normal(0, 1, (2, count))


@pytest.mark.parametrize(
    ("number", "num_hard", "tightness"),
    [
        *[(6, 0, -0.3), (6, 0, 0.3), (5, 2, -0.2), (5, 2, 0.4), (3, 1, 0.2)],
        *[pytest.param(8, 3, tightness, marks=pytest.mark.slow) for tightness in (-0.2, 0.4)],
    ],
)
def test_it_chooses_what_the_published_algorithm_chooses(number: int, num_hard: int, tightness: float) -> None:
    lines, limit, preferred_velocity = random_cases(number + num_hard, number, num_hard, tightness)
    expected, kept = ground_truth(lines, num_hard, limit, preferred_velocity)
    # Both programs are in play.
    assert 0.05 < kept.mean() < 0.95
    exact = solve(lines, num_hard, limit, preferred_velocity, np.float64)
    np.testing.assert_allclose(exact, expected, atol=1e-7)
    np.testing.assert_allclose(solve(lines, num_hard, limit, preferred_velocity, np.float32), expected, atol=2e-4)


def test_more_who_are_crowded_than_a_chunk_holds() -> None:
    # Every agent goes through the second program, in many chunks.
    lines, limit, preferred_velocity = random_cases(5, 6, 0, 1.5)
    expected, kept = ground_truth(lines, 0, limit, preferred_velocity)
    assert kept.mean() < 0.02
    np.testing.assert_allclose(solve(lines, 0, limit, preferred_velocity, np.float32), expected, atol=2e-4)


def test_velocities_do_not_depend_on_how_many_agents_there_are() -> None:
    """Of more than 2,048 agents a chunk is a share."""
    lines, limit, preferred_velocity = random_cases(5, 6, 0, 1.5)
    few = solve(lines, 0, limit, preferred_velocity, np.float32)
    many = solve(np.tile(lines, 3), 0, np.tile(limit, 3), np.tile(preferred_velocity, 3), np.float32)
    np.testing.assert_allclose(many, np.tile(few, 3), atol=1e-5)


@pytest.mark.extended
def test_missing_lines_change_nothing() -> None:
    lines, limit, preferred_velocity = random_cases(6, 6, 0, 0.0)
    expected, _ = ground_truth(lines, 0, limit, preferred_velocity)
    empty = np.zeros((3, 2, CASES))
    empty[0], empty[2] = 1.0, linear_program.NO_LIMIT
    padded = np.concatenate([lines[:, :4], empty, lines[:, 4:]], axis=1)
    np.testing.assert_allclose(solve(padded, 0, limit, preferred_velocity, np.float32), expected, atol=2e-4)


def test_without_lines_only_the_speed_limit_counts() -> None:
    preferred_velocity = np.array([[3.0, 0.2], [4.0, -0.1]])
    lines = np.zeros((3, 0, 2))
    chosen = solve(lines, 0, np.array([1.0, 1.0]), preferred_velocity, np.float32)
    np.testing.assert_allclose(chosen, [[0.6, 0.2], [0.8, -0.1]], atol=1e-6)


def test_lines_through_one_point_leave_that_point() -> None:
    # Three lines whose only common point is (0.5, 0): the interval on the last one is closed up to rounding.
    angle = np.array([np.pi / 2, np.pi / 2 + 2 * np.pi / 3, np.pi / 2 - 2 * np.pi / 3])
    normal = np.stack([np.cos(angle), np.sin(angle)])
    lines = np.concatenate([normal, [0.5 * normal[0]]])[:, :, None]
    chosen = solve(lines, 0, np.array([1.0]), np.array([[0.9], [0.7]]), np.float32)
    np.testing.assert_allclose(chosen[:, 0], [0.5, 0.0], atol=1e-5)


_NUMBER = 4
_floats = st.floats(-1.5, 1.5, width=32, allow_subnormal=False)
_angles = st.lists(st.floats(-3.125, 3.125, width=32, allow_subnormal=False), min_size=_NUMBER, max_size=_NUMBER)


@pytest.mark.extended
@settings(max_examples=300, deadline=None)
@given(
    angles=_angles,
    offsets=st.lists(_floats, min_size=_NUMBER, max_size=_NUMBER),
    preferred_velocity=st.tuples(_floats, _floats),
)
def test_whatever_the_lines_nothing_better_is_found(
    angles: list[float], offsets: list[float], preferred_velocity: tuple[float, float]
) -> None:
    # Rounding may separate the two programs for nearly parallel lines; then the objective is compared, not the point.
    num_hard, limit = 2, np.array([1.3])
    offsets = [-abs(o) if i < num_hard else o for i, o in enumerate(offsets)]
    lines = np.stack([np.cos(angles), np.sin(angles), offsets])[:, :, None]
    aim = np.array(preferred_velocity)[:, None]
    chosen = solve(lines, num_hard, limit, aim, np.float32)[:, 0]
    expected, kept = ground_truth(lines, num_hard, limit, aim)
    depth = lines[2, :, 0] - chosen @ lines[:2, :, 0]
    assert np.hypot(*chosen) <= limit[0] + 1e-5
    assert depth[:num_hard].max() <= 1e-4
    best = lines[2, :, 0] - expected[:, 0] @ lines[:2, :, 0]
    assert depth[num_hard:].max() <= max(best[num_hard:].max(), 0.0) + 1e-3
    if kept[0] and depth.max() <= 1e-6:
        assert np.hypot(*(chosen - preferred_velocity)) <= np.hypot(*(expected[:, 0] - preferred_velocity)) + 1e-3
