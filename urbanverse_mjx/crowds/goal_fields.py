"""Route fields from any point of a scene to each of a few goals, for people, cyclists and cars.

In:   `FreeSpace` of each scene. Out: `GoalRoutes`, directions to the goals and spawn positions, as a table on the
device. When: the table once per scene, on the host; `heading_at` every crowd step, inside jit.

Routes are cheapest paths on a grid with 16 directions. The cost is higher near objects and on the wrong side of the
road, so the cost of an edge depends on its direction.
"""

import dataclasses
from collections.abc import Sequence
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from scipy import ndimage
from scipy.sparse import csgraph

from ..datatypes import GROUND_KINDS
from ..datatypes import validation as v
from ..geometry.geodesics import Cells, GridGraph, Step, extra_near
from ..geometry.grids import pooled
from .free_space import CELL, FreeSpace
from .kinds import SURFACES


@dataclasses.dataclass(frozen=True)
class FieldOptions:
    """Costs and distances of direction fields; chosen manually.

    Attributes:
      wrong_side_cost: cost of a metre on the wrong side of the road.
      middle_cost: cost of a metre at a distance of one metre too near to the road's centre line.
      lookahead: number of nodes ahead on the route to which a direction points: about 1.2 m on foot and 2.5 m on the
        road.
      directions: number of quantised directions in a full turn.
      side_nodes: number of nodes after which a vehicle is on its side of the road.
      end_nodes: number of nodes from a vehicle's centre to the discs at its ends (1.6 m).
    """

    wrong_side_cost: float = 5.0
    middle_cost: float = 1.0
    lookahead: int = 4
    directions: int = 256
    side_nodes: int = 40
    end_nodes: int = 4


_OPTIONS = FieldOptions()


@dataclasses.dataclass(frozen=True)
class RouteRules:
    """Rules of the routes of one group of road users.

    Attributes:
      surface: row of `SURFACES`.
      pool: cells of the free space along a side of a node.
      clearance: m, free distance around the route.
      from_middle: m, distance to the centre line of the road; None to keep to no side.
      num_goals: number of goals per scene.
      left_hand: whether traffic keeps left.
    """

    surface: str
    pool: int
    clearance: float
    from_middle: float | None
    num_goals: int
    left_hand: bool = False

    @property
    def node(self) -> float:
        """m, side of a node."""
        return self.pool * CELL


#: Groups of kinds that share a table of routes. The clearances are half of the widths (kinds.py) plus about 0.1 m.
RULES = {
    "foot": RouteRules("foot", 2, 0.35, None, 8),
    "roll": RouteRules("foot", 2, 0.50, None, 8),
    "cycle": RouteRules("road", 4, 0.60, 1.8, 4),
    "drive": RouteRules("road", 4, 1.20, 1.4, 4),
}
RULE_OF_KIND = {"pedestrian": "foot", "wheelchair": "roll", "scooter": "roll", "cyclist": "cycle", "car": "drive"}
#: Number of spawn positions per scene.
NUM_PLACES = 256


class GoalRoutes(NamedTuple):
    """Routes of one group in all scenes, padded to the largest.

    Attributes:
      direction: (Z, G, X, Y) u8, direction of travel in units of 2π/256; off the routes it leads back to them.
      origin: (Z, 2) f32 m.
      goal: (Z, G, 2) f32 m.
      num_goals: (Z,) i32; 0 if the scene has no routes for the group.
      place: (Z, S, 2) f32 m, spawn positions from which every goal is reachable.
      place_goal: (Z, S) i32, goal whose route leads through the position, for groups that keep to a side; -1 if any
        goal is possible.
    """

    direction: Any
    origin: Any
    goal: Any
    num_goals: Any
    place: Any
    place_goal: Any


def _sides(road: np.ndarray, node: float) -> tuple[np.ndarray, np.ndarray]:
    """(X, Y, 2) unit vectors to the nearest edge of a road, and (X, Y) m, distance from its centre line towards that
    edge."""
    edge, (ei, ej) = ndimage.distance_transform_edt(road, return_indices=True)
    i, j = np.indices(road.shape)
    to_edge = np.stack([ei - i, ej - j], -1) / np.maximum(edge, 1e-9)[..., None]
    across = np.zeros(road.shape)
    open_ = road.copy()
    # Steps away from the nearest edge to the opposite one.
    for step in range(1, round(15.0 / node)):
        ci, cj = (np.round(i - step * to_edge[..., 0]).astype(int), np.round(j - step * to_edge[..., 1]).astype(int))
        inside = (ci >= 0) & (ci < road.shape[0]) & (cj >= 0) & (cj < road.shape[1])
        open_ &= inside & road[np.clip(ci, 0, road.shape[0] - 1), np.clip(cj, 0, road.shape[1] - 1)]
        across += open_
    return to_edge, 0.5 * (across - edge) * node


def _graph(space: FreeSpace, rules: RouteRules) -> tuple[np.ndarray, GridGraph]:
    """Passable nodes (X, Y) bool, and the function for the cost (m) of edges."""
    distance = pooled(space.distance(), rules.pool, np.min)
    nodes = distance >= rules.clearance
    price = 1.0 + extra_near(distance, rules.clearance)
    if rules.from_middle is None:
        return nodes, GridGraph(nodes, lambda step, tail, _: np.hypot(*step) * rules.node * price[tail])
    allowed = np.array([k in SURFACES[rules.surface] for k in GROUND_KINDS])[space.kind]
    to_edge, from_middle = _sides(pooled(allowed, rules.pool, np.all), rules.node)
    price += _OPTIONS.middle_cost * np.clip(rules.from_middle - from_middle, 0.0, None)

    def on_its_side(step: Step, tail: Cells, _: Cells) -> np.ndarray:
        (di, dj), length = step, np.hypot(*step)
        hand = (dj / length, -di / length) if not rules.left_hand else (-dj / length, di / length)
        wrong = to_edge[..., 0] * hand[0] + to_edge[..., 1] * hand[1] < -0.3
        return length * rules.node * price[tail] * np.where(wrong[tail], _OPTIONS.wrong_side_cost, 1.0)

    return nodes, GridGraph(nodes, on_its_side)


def _directions(nodes: np.ndarray, following: np.ndarray, reached: np.ndarray) -> np.ndarray:
    """(X, Y) u8, directions along the paths, and in nodes without a path to the nearest node with one."""
    cells = np.argwhere(nodes)
    ahead = np.arange(len(cells))
    for _ in range(_OPTIONS.lookahead):
        ahead = following[ahead]
    on_route = np.zeros(nodes.shape, bool)
    on_route[tuple(cells[reached].T)] = True
    vector = np.zeros((*nodes.shape, 2))
    vector[tuple(cells.T)] = cells[ahead] - cells
    i, j = np.indices(nodes.shape)
    ni, nj = ndimage.distance_transform_edt(~on_route, return_distances=False, return_indices=True)
    vector = np.where(on_route[..., None], vector, np.stack([ni - i, nj - j], -1))
    units = np.round(np.arctan2(vector[..., 1], vector[..., 0]) * _OPTIONS.directions / (2 * np.pi))
    return (units.astype(int) % _OPTIONS.directions).astype(np.uint8)


def fields_of(space: FreeSpace, rules: RouteRules, seed: int = 0) -> tuple[np.ndarray, ...]:
    """Computes directions (G, X, Y) u8, goals (G, 2) m, spawn positions (S, 2) m and their goals (S,) of one scene.

    All are empty if there is no room. Each goal is the position with the longest paths to all goals before it.
    """
    nodes, graph = _graph(space, rules)
    empty = np.zeros((0, *nodes.shape), np.uint8), np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0, int)
    if not nodes.any():
        return empty
    _, label = csgraph.connected_components(graph.edges, connection="strong")
    main = label == np.bincount(label).argmax()
    if main.sum() * rules.node**2 < 25.0:  # m²; too small for moving agents
        return empty
    cells = graph.cells
    centres = space.origin + (cells + 0.5) * rules.node
    costs: list[np.ndarray] = []
    goals: list[int] = []
    fields: list[np.ndarray] = []
    taken: list[np.ndarray] = []
    rng = np.random.default_rng(seed)
    at = int(np.flatnonzero(main)[0])
    at = int(np.where(main, graph.to_goal(at)[0], -1.0).argmax())
    for _ in range(rules.num_goals):
        cost, following = graph.to_goal(at)
        costs.append(cost)
        goals.append(at)
        fields.append(_directions(nodes, following, np.isfinite(cost)))
        taken.append(_on_the_route(following, main & (cost > _OPTIONS.side_nodes * rules.node)))
        farthest = np.where(main, np.min(costs, axis=0), -1.0)
        at = int(farthest.argmax())
        if farthest[at] < 5.0:
            break
    if rules.from_middle is None:
        places, place_goal = rng.choice(np.flatnonzero(main), NUM_PLACES), np.full(NUM_PLACES, -1)
    else:
        rows = [
            (node, g) for g, on_route in enumerate(taken) for node in on_route if _roomy(nodes, cells[node], fields[g])
        ]
        if not rows:
            return empty
        places, place_goal = np.array(rows)[rng.choice(len(rows), NUM_PLACES)].T
    return np.stack(fields), centres[goals], centres[places], place_goal


def _roomy(nodes: np.ndarray, cell: np.ndarray, field: np.ndarray) -> bool:
    """Whether there is room for both ends of a vehicle that is aligned with its route (`end_nodes` nodes from its
    centre)."""
    angle = field[tuple(cell)] * (2 * np.pi / _OPTIONS.directions)
    ends = np.round(
        cell + np.array([[-_OPTIONS.end_nodes], [_OPTIONS.end_nodes]]) * [np.cos(angle), np.sin(angle)]
    ).astype(int)
    inside = (ends >= 0).all(1) & (ends < nodes.shape).all(1)
    return bool(inside.all()) and bool(nodes[tuple(ends.T)].all())


def _on_the_route(following: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Nodes some distance along the paths from the nodes `start`, where agents are on their side of the road."""
    at = np.flatnonzero(start)
    for _ in range(_OPTIONS.side_nodes // 2):
        at = following[at]
    return np.unique(at)


def make_routes(spaces: Sequence[FreeSpace], found: Sequence[tuple[np.ndarray, ...]]) -> GoalRoutes:
    """The table of one group in several scenes.

    Args:
      found: `fields_of` each scene.

    Raises:
      ValidationError: no scene.
    """
    if not spaces:
        raise v.fail("ways", "no scene", "at least one")
    size = np.max([f.shape[1:] for f, *_ in found], axis=0)
    number = max(1, max(len(g) for _, g, *_ in found))
    direction = np.zeros((len(found), number, *size), np.uint8)
    goal, place = np.zeros((len(found), number, 2), np.float32), np.zeros((len(found), NUM_PLACES, 2), np.float32)
    place_goal = np.full((len(found), NUM_PLACES), -1, np.int32)
    for z, (fields, goals, places, its_goal) in enumerate(found):
        if len(goals):
            direction[z, : len(goals), : fields.shape[1], : fields.shape[2]] = fields
            goal[z, : len(goals)], place[z], place_goal[z] = goals, places, its_goal
    origin = np.stack([space.origin for space in spaces]).astype(np.float32)
    counts = np.array([len(g) for _, g, *_ in found], np.int32)
    return GoalRoutes(*(jnp.asarray(a) for a in (direction, origin, goal, counts, place, place_goal)))


def heading_at(routes: GoalRoutes, node: float, scene: Any, goal: Any, x: Any, y: Any) -> Any:
    """(A,) rad, direction of travel from positions (A,) m to goals (A,) i32 in a scene; straight to the goal within 2
    nodes.

    Directions are interpolated between the four nearest nodes.
    """
    origin = routes.origin[scene]
    u, w = (x - origin[0]) / node - 0.5, (y - origin[1]) / node - 0.5
    i, j = jnp.floor(u).astype(jnp.int32), jnp.floor(w).astype(jnp.int32)
    columns, rows = routes.direction.shape[2:]
    dx, dy = jnp.zeros_like(x), jnp.zeros_like(y)
    for di in (0, 1):
        for dj in (0, 1):
            weight = jnp.abs(1.0 - di - (u - i)) * jnp.abs(1.0 - dj - (w - j))
            a, b = jnp.clip(i + di, 0, columns - 1), jnp.clip(j + dj, 0, rows - 1)
            angle = routes.direction[scene, goal, a, b].astype(jnp.float32) * (2.0 * jnp.pi / _OPTIONS.directions)
            dx, dy = dx + weight * jnp.cos(angle), dy + weight * jnp.sin(angle)
    gx, gy = routes.goal[scene, goal, 0] - x, routes.goal[scene, goal, 1] - y
    close = gx * gx + gy * gy < (2.0 * node) ** 2
    return jnp.where(close, jnp.arctan2(gy, gx), jnp.arctan2(dy, dx))
