"""How far it is from anywhere to an episode's goal, for who knows the scene: the planner's sense of direction.

In:   `Room`, goals.
Out:  `Ways`, a field for each episode, in a window around its route.
When: once per list of episodes, on the host.
"""

import dataclasses

import numpy as np
from scipy import ndimage, sparse
from scipy.sparse import csgraph

from ..envs.navigation.room import CELL, Room

#: Cells of the room along a node, and m between nodes.
POOL = 2
NODE = POOL * CELL
#: A metre right beside something costs so much more than one `_NEAR` m away from everything; one where the robot just
#: fits costs `_TIGHT` times as much.
_NEAR_COST, _NEAR, _TIGHT = 1.5, 0.6, 3.0
#: m that may be missing from half the robot's width: nodes seldom lie in the middle of a gap.
_SLACK = 0.015
#: m of tightness: fits by less than this.
_SNUG = 0.03
#: m around a route that its window shows, and times its length and m that a field reaches.
_MARGIN, _REACH, _MORE = 8.0, 2.0, 15.0
#: Cost of a metre off the passable nodes, added to that of the nearest passable one.
_OUTSIDE = 3.0
_STEPS = np.array([(1, 0), (0, 1), (1, 1), (1, -1), (1, 2), (2, 1), (1, -2), (2, -1)])


@dataclasses.dataclass(frozen=True)
class Ways:
    """Fields of n episodes.

    Attributes:
      origin: (n, 2) f32 m, centre of the first node of each window.
      cost: (n, X, Y) f32, cost-metres to the goal; large where there is no way. Nodes are `NODE` apart.
    """

    origin: np.ndarray
    cost: np.ndarray


def build_ways(
    room: Room, scenes: np.ndarray, goals: np.ndarray, routes: np.ndarray, lengths: np.ndarray, half_width: float
) -> Ways:
    """Fields to the goals of n episodes.

    Args:
      scenes: (n,) rows of the room; goals: (n, 2) m.
      routes: (n, W, 2) m, points of the routes, which the windows enclose; lengths: (n,) m.
      half_width: m, of the robot across its heading.
    """
    low = routes.min(1) - _MARGIN
    spans = np.ceil((routes.max(1) + _MARGIN - low) / NODE).astype(int)
    shape = np.minimum(spans.max(0), np.array(room.to_hull.shape[1:]) // POOL)
    first = np.floor((low - room.origin[scenes]) / NODE).astype(int)
    first = np.clip(first, 0, np.array(room.to_hull.shape[1:]) // POOL - shape)
    cost = np.zeros((len(scenes), *shape), np.float32)
    for scene in np.unique(scenes):
        graph = _Graph(room, int(scene), half_width)
        rows = np.flatnonzero(scenes == scene)
        places, which = np.unique(goals[rows], axis=0, return_inverse=True)
        for k, goal in enumerate(places):
            own = rows[which.ravel() == k]
            field = graph.costs(goal, float(lengths[own].max()) * _REACH + _MORE)
            for row in own:
                i, j = first[row]
                cost[row] = field[i : i + shape[0], j : j + shape[1]]
    origin = room.origin[scenes] + (first + 0.5) * NODE
    return Ways(origin.astype(np.float32), cost)


class _Graph:
    """The nodes of one scene that the robot's middle may pass, and what a metre there costs."""

    def __init__(self, room: Room, scene: int, half_width: float) -> None:
        clear = np.minimum(room.to_hull[scene], room.to_edge[scene]).astype(np.float32)
        x, y = (n // POOL for n in clear.shape)
        clear = clear[: x * POOL, : y * POOL].reshape(x, POOL, y, POOL).mean((1, 3))
        self._origin = room.origin[scene]
        self._passable = clear >= half_width - _SLACK
        near = 1.0 + _NEAR_COST * np.clip(1.0 - (clear - half_width) / _NEAR, 0.0, 1.0)
        price = np.where(clear < half_width + _SNUG, _TIGHT * near, near)
        self._number = np.full(clear.shape, -1)
        nodes = np.argwhere(self._passable)
        self._number[nodes[:, 0], nodes[:, 1]] = np.arange(len(nodes))
        self._graph = self._edges(nodes, price)
        self._outside, self._nearest = ndimage.distance_transform_edt(~self._passable, return_indices=True)

    def _edges(self, nodes: np.ndarray, price: np.ndarray) -> sparse.csr_matrix:
        rows, columns, weights = [], [], []
        shape = np.array(self._passable.shape)
        for step in _STEPS:
            to = nodes + step
            inside = ((to >= 0) & (to < shape)).all(1)
            a, b = nodes[inside], to[inside]
            # A knight's move must not jump over a corner.
            between = self._passable[tuple(((a + b) // 2).T)] & self._passable[tuple((-(-(a + b) // 2)).T)]
            there = self._passable[tuple(b.T)] & between
            a, b = a[there], b[there]
            rows.append(self._number[tuple(a.T)])
            columns.append(self._number[tuple(b.T)])
            weights.append(NODE * np.hypot(*step) * (price[tuple(a.T)] + price[tuple(b.T)]) / 2)
        shape = (len(nodes), len(nodes))
        entries = np.concatenate(weights), (np.concatenate(rows), np.concatenate(columns))
        return sparse.csr_matrix(entries, shape)

    def costs(self, goal: np.ndarray, limit: float) -> np.ndarray:
        """(X, Y) f32, cost-metres to the goal of every node, at most about `limit`."""
        if not len(self._graph.data):
            return np.full(self._passable.shape, limit, np.float32)
        cell = np.clip(np.floor((goal - self._origin) / NODE).astype(int), 0, np.array(self._passable.shape) - 1)
        start = self._number[tuple(self._nearest[:, cell[0], cell[1]])]
        # `limit` cuts what is farther; costs of a metre are at most (1 + _NEAR_COST) * _TIGHT.
        found = csgraph.dijkstra(self._graph, directed=False, indices=start, limit=limit)
        field = np.full(self._passable.shape, limit, np.float32)
        field[self._passable] = np.minimum(found, limit)
        return field[self._nearest[0], self._nearest[1]] + np.float32(_OUTSIDE * NODE) * self._outside.astype(
            np.float32
        )
