"""Paths over a grid have the cost that a simple search finds, and avoid impassable cells."""

import heapq

import numpy as np
import pytest

from urbanverse_mjx.geometry.geodesics import STEPS, Cells, GridGraph, Step, extra_near

SIDE = 0.2


def length(step: Step, tail: Cells, _: Cells) -> np.ndarray:
    return np.full(len(tail[0]), SIDE * np.hypot(*step))


def test_sixteen_directions_and_knights_pass_two_cells() -> None:
    assert len(STEPS) == 16
    assert STEPS[(1, 0)] == STEPS[(1, -1)] == []
    assert set(STEPS[(2, 1)]) == {(1, 0), (1, 1)}
    assert set(STEPS[(-1, -2)]) == {(0, -1), (-1, -1)}


def test_ways_around_a_wall_by_hand() -> None:
    passable = np.ones((9, 9), bool)
    passable[4, :7] = False
    graph = GridGraph(passable, length)
    cost, following = graph.to_goal(graph.number[8, 2])
    assert cost[graph.number[6, 3]] == pytest.approx(SIDE * np.sqrt(5.0))
    node, route = graph.number[2, 2], []
    while node != following[node]:
        route.append(tuple(graph.cells[node]))
        node = following[node]
    assert tuple(graph.cells[node]) == (8, 2)
    assert {c[1] for c in route if c[0] == 4} <= {7, 8}
    assert any(c[1] >= 7 for c in route)
    walled = passable.copy()
    walled[4] = False
    graph = GridGraph(walled, length)
    cost, following = graph.to_goal(graph.number[8, 2])
    start = graph.number[2, 2]
    assert np.isinf(cost[start])
    assert following[start] == start
    assert np.isinf(graph.to_goal(graph.number[8, 2], limit=0.3)[0][graph.number[6, 2]])


def by_search(passable: np.ndarray, price: np.ndarray, goal: tuple[int, int]) -> np.ndarray:
    """(X, Y) cost of going to a goal where a step costs the price of the cell that it leaves."""
    cost = np.full(passable.shape, np.inf)
    cost[goal] = 0.0
    queue = [(0.0, goal)]
    while queue:
        so_far, (i, j) = heapq.heappop(queue)
        if so_far > cost[i, j]:
            continue
        for (di, dj), passed in STEPS.items():
            tail = (i - di, j - dj)
            cells = [tail, *((tail[0] + a, tail[1] + b) for a, b in passed)]
            if all(0 <= a < passable.shape[0] and 0 <= b < passable.shape[1] and passable[a, b] for a, b in cells):
                new = so_far + np.hypot(di, dj) * price[tail]
                if new < cost[tail]:
                    cost[tail] = new
                    heapq.heappush(queue, (new, tail))
    return cost


@pytest.mark.parametrize("seed", range(4))
def test_costs_whose_price_depends_on_the_direction_agree_with_a_search(seed: int) -> None:
    rng = np.random.default_rng(seed)
    passable, price = rng.random((14, 11)) > 0.3, rng.uniform(1.0, 4.0, (14, 11))
    graph = GridGraph(passable, lambda step, tail, _: np.hypot(*step) * price[tail])
    i, j = (int(k) for k in graph.cells[5])
    found = graph.to_goal(5)[0]
    np.testing.assert_allclose(found, by_search(passable, price, (i, j))[passable])
    assert np.isfinite(found).sum() > 20


def test_a_metre_costs_more_near_objects() -> None:
    distance = np.array([0.3, 0.4, 0.7, 1.0, 5.0])
    np.testing.assert_allclose(extra_near(distance, 0.4), [1.5, 1.5, 0.75, 0.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(extra_near(distance, 0.4, 1.0, 0.5), [1.0, 1.0, 0.4, 0.0, 0.0], atol=1e-12)
