"""Distance fields to the goals of episodes: the planner's cost-to-go.

In:   `ClearanceMaps`, goals.
Out:  `RouteFields`, a field for each episode, in a window around its route.
When: once per list of episodes, on the host.
"""

import dataclasses

import numpy as np
from scipy import ndimage

from ..envs.navigation.clearance_maps import CELL, ClearanceMaps
from ..geometry.geodesics import STEPS, Cells, GridGraph, Step, extra_near
from ..geometry.grids import cell_of, pooled

#: Cells of the maps along a side of a node, and m between nodes.
POOL = 2
NODE = POOL * CELL
#: One diagonal needs both adjacent cells to be free, the other neither. Published scores depend on this asymmetry.
_STEPS = {**STEPS, (1, -1): ((0, -1), (1, 0)), (-1, 1): ((0, 1), (-1, 0))}


@dataclasses.dataclass(frozen=True)
class RouteFieldOptions:
    """Costs per metre, and the range of a field; chosen manually.

    Attributes:
      tight_cost: factor on the cost per metre where the robot just fits.
      width_slack: m, tolerance of half the robot's width, because nodes seldom lie in the middle of a gap.
      tight_margin: m, clearance below which a gap counts as tight.
      window_margin: m, margin of the window around a route by default.
      reach_ratio: range of a field as a multiple of the route's length.
      reach_margin: m, additional range.
      outside_cost: cost per metre off the passable nodes, added to that of the nearest passable one.
    """

    tight_cost: float = 3.0
    width_slack: float = 0.015
    tight_margin: float = 0.03
    window_margin: float = 8.0
    reach_ratio: float = 2.0
    reach_margin: float = 15.0
    outside_cost: float = 3.0


_OPTIONS = RouteFieldOptions()


@dataclasses.dataclass(frozen=True)
class RouteFields:
    """Cost fields of n episodes.

    Attributes:
      origin: (n, 2) f32 m, centre of the first node of each window.
      cost: (n, X, Y) f32, cost-metres to the goal; large without a path. Nodes are `NODE` apart.
    """

    origin: np.ndarray
    cost: np.ndarray


def build_route_fields(
    maps: ClearanceMaps,
    scenes: np.ndarray,
    goals: np.ndarray,
    routes: np.ndarray,
    lengths: np.ndarray,
    half_width: float,
    margin: float = _OPTIONS.window_margin,
) -> RouteFields:
    """Computes the fields to the goals of n episodes.

    Args:
      scenes: (n,) rows of the maps.
      goals: (n, 2) m.
      routes: (n, W, 2) m, points of the routes, which the windows enclose.
      lengths: (n,) m.
      half_width: m, half the robot's width.
      margin: m, margin of the window around a route.
    """
    low = routes.min(1) - margin
    spans = np.ceil((routes.max(1) + margin - low) / NODE).astype(int)
    shape = np.minimum(spans.max(0), np.array(maps.to_hull.shape[1:]) // POOL)
    first = cell_of(low, maps.origin[scenes], NODE)
    first = np.clip(first, 0, np.array(maps.to_hull.shape[1:]) // POOL - shape)
    cost = np.zeros((len(scenes), *shape), np.float32)
    for scene in np.unique(scenes):
        graph = _Costs(maps, int(scene), half_width)
        rows = np.flatnonzero(scenes == scene)
        places, which = np.unique(goals[rows], axis=0, return_inverse=True)
        for k, goal in enumerate(places):
            own = rows[which.ravel() == k]
            field = graph.costs(goal, float(lengths[own].max()) * _OPTIONS.reach_ratio + _OPTIONS.reach_margin)
            for row in own:
                i, j = first[row]
                cost[row] = field[i : i + shape[0], j : j + shape[1]]
    origin = maps.origin[scenes] + (first + 0.5) * NODE
    return RouteFields(origin.astype(np.float32), cost)


class _Costs:
    """The passable nodes of one scene for the robot's centre, and their cost per metre."""

    def __init__(self, maps: ClearanceMaps, scene: int, half_width: float) -> None:
        clear = np.minimum(maps.to_hull[scene], maps.to_edge[scene]).astype(np.float32)
        clear = pooled(clear, POOL, np.mean)
        self._origin = maps.origin[scene]
        self._passable = clear >= half_width - _OPTIONS.width_slack
        near = 1.0 + extra_near(clear, half_width)
        price = np.where(clear < half_width + _OPTIONS.tight_margin, _OPTIONS.tight_cost * near, near)

        def mean(step: Step, a: Cells, b: Cells) -> np.ndarray:
            return NODE * np.hypot(*step) * (price[a] + price[b]) / 2

        self._graph = GridGraph(self._passable, mean, _STEPS)
        self._outside, self._nearest = ndimage.distance_transform_edt(~self._passable, return_indices=True)

    def costs(self, goal: np.ndarray, limit: float) -> np.ndarray:
        """(X, Y) f32, cost-metres from every node to the goal, up to about `limit`."""
        if not self._graph.edges.nnz:
            return np.full(self._passable.shape, limit, np.float32)
        i, j = cell_of(goal, self._origin, NODE, self._passable.shape)
        found, _ = self._graph.to_goal(int(self._graph.number[tuple(self._nearest[:, i, j])]), limit)
        field = np.full(self._passable.shape, limit, np.float32)
        field[self._passable] = np.minimum(found, limit)
        return field[self._nearest[0], self._nearest[1]] + np.float32(
            _OPTIONS.outside_cost * NODE
        ) * self._outside.astype(np.float32)
