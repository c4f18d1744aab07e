"""Cheapest paths to a goal over the passable cells of a grid, in 16 directions."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse import csgraph

Step = tuple[int, int]
#: Indices (i, j) of cells.
Cells = tuple[np.ndarray, np.ndarray]


def _passed(step: Step) -> list[Step]:
    """Returns the two cells that a knight's move passes, relative to its first cell."""
    i, j = (int(np.sign(k)) for k in step)
    return [(i * (abs(step[0]) == 2), j * (abs(step[1]) == 2)), (i, j)] if max(map(abs, step)) == 2 else []


#: Each direction as a step from cell to cell, with the cells on its way that must be passable as well.
STEPS: Mapping[Step, Sequence[Step]] = {
    (i, j): _passed((i, j)) for i in range(-2, 3) for j in range(-2, 3) if np.gcd(i, j) == 1
}


def extra_near(distance: Any, clearance: float, most: float = 1.5, reach: float = 0.6) -> Any:
    """Returns the extra cost per metre near objects: `most` at `clearance` (m) from them, 0 from `reach` m farther on.

    The defaults are used for people's routes and by the planner.

    Args:
      distance: (...) m to the nearest object.
    """
    return most * np.clip(1.0 - (distance - clearance) / reach, 0.0, 1.0)


class GridGraph:
    """The passable cells of a grid as nodes.

    Args:
      passable: (X, Y) bool.
      price: function of a step's start cells (i, j), n of each, and end cells (i, j); returns the costs (n,).
      steps: see `STEPS`.

    Attributes:
      cells: (n, 2) cell of each node.
      number: (X, Y) node of each cell, -1 where it is not passable.
      edges: (n, n) cost of the step from one node to another.
    """

    def __init__(
        self,
        passable: np.ndarray,
        price: Callable[[Step, Cells, Cells], np.ndarray],
        steps: Mapping[Step, Sequence[Step]] = STEPS,
    ) -> None:
        self.cells = np.argwhere(passable)
        self.number = np.full(passable.shape, -1)
        self.number[passable] = np.arange(len(self.cells))
        (x, y), padded = passable.shape, np.pad(passable, 2)
        tails, heads, prices = [], [], []
        for (di, dj), passed in steps.items():
            through = passable.copy()
            for a, b in ((di, dj), *passed):
                through &= padded[2 + a : 2 + a + x, 2 + b : 2 + b + y]
            i, j = np.nonzero(through)
            head = i + di, j + dj
            tails.append(self.number[i, j])
            heads.append(self.number[head])
            prices.append(price((di, dj), (i, j), head))
        entries = (np.concatenate(prices), (np.concatenate(tails), np.concatenate(heads)))
        self.edges = sparse.csr_matrix(entries, shape=(len(self.cells), len(self.cells)))
        self._backwards = self.edges.T.tocsr()

    def to_goal(self, goal: int, limit: float = np.inf) -> tuple[np.ndarray, np.ndarray]:
        """Returns (n,) cost from every node to a goal node, inf where no path costs at most `limit`, and (n,) the next
        node on the path (itself at the end)."""
        cost, following = csgraph.dijkstra(self._backwards, indices=goal, limit=limit, return_predecessors=True)
        return cost, np.where(following < 0, np.arange(len(following)), following)

    @staticmethod
    def path(following: np.ndarray, start: int) -> np.ndarray:
        """Returns the nodes (m,) of a path from a start to where it ends, by the next nodes (n,) of `to_goal`."""
        nodes = [start]
        while following[nodes[-1]] != nodes[-1]:
            nodes.append(int(following[nodes[-1]]))
        return np.array(nodes)

    def to_goals(self, goals: np.ndarray, limit: float = np.inf) -> tuple[np.ndarray, np.ndarray]:
        """Returns the same as `to_goal` for the nearest of several goal nodes (g,)."""
        cost, following, _ = csgraph.dijkstra(
            self._backwards, indices=goals, limit=limit, min_only=True, return_predecessors=True
        )
        return cost, np.where(following < 0, np.arange(len(following)), following)
