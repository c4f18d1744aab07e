"""Episode tables of tasks whose routes differ from those of a bank: long ones over pavements and crosswalks.

In:   a bank, the robot's size. Out: `Routes` of each scene, and the bank with them in place of its own. When: once per
bank and robot, on the host; cached.

A long route is a walk between places that are far from each other, on shortest paths, until it has its length: a scene
is shorter than that, so the route comes back over the same pavements and crosswalks, as the missions of
`benchmarks.missions` do.
"""

import dataclasses
import functools
import hashlib
import pathlib
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Int32
from scipy import ndimage
from scipy.sparse import csgraph

from .... import settings, versions
from ....crowds import free_space
from ....datatypes import KIND_INDEX, RobotSpec, SceneBank, ValidationError, array_file
from ....geometry.geodesics import GridGraph, extra_near
from ....geometry.grids import Grid, pooled
from ....process_pool import results_in_order, workers_for
from ..clearance_maps import CELL, build_clearance_maps
from .crosswalks import rectangles

#: Cells of the clearance maps along a side of a node, and m between nodes.
POOL = 4
NODE = POOL * CELL


@dataclasses.dataclass(frozen=True)
class RouteOptions:
    """Costs and sizes of routes; chosen here.

    Attributes:
      number: routes of a scene.
      width_share: half the robot's width as a share of `planner_radius`, the radius of the disc around it.
      slack: m, distance beyond half the robot's width.
      lawn_cost: cost of a metre on the kind `ground` (lawns, beds), so that routes keep to pavements.
      place_clearance: m, free distance around starts, goals and the places of a walk.
      places: number of places of a walk.
      min_part: m², pavements between crosswalks that are smaller have no place of their own.
      min_leg: m from one place to the next.
      other_side: weight of places on another pavement than the last one, so that most legs cross a road.
      shortening: length of a path on the grid as a multiple of that through its waypoints.
      tolerance: m between a path and the line through its waypoints.
      spacing: m, largest distance of waypoints.
      from_kerb: m, least distance of starts, goals and places from a crosswalk.
      tries: largest number of drawn routes for each that is taken.
    """

    number: int = 64
    width_share: float = 0.75
    slack: float = 0.1
    lawn_cost: float = 3.0
    place_clearance: float = 0.6
    places: int = 12
    min_part: float = 10.0
    min_leg: float = 12.0
    other_side: float = 4.0
    shortening: float = 1.1
    tolerance: float = 0.3
    spacing: float = 5.0
    from_kerb: float = 2.0
    tries: int = 20


_OPTIONS = RouteOptions()
#: Number of points of a path that are compared with a line at once.
_AHEAD = 32


class Routes(NamedTuple):
    """Routes of one scene; the fields are those of `SceneBank` for its episodes.

    Attributes:
      start: (E, 4) f32 x, y, z m and yaw.
      waypoints: (E, W, 3) f32 m; the last is the goal and repeats.
      num_waypoints: (E,) i32.
      length: (E,) f32 m.
    """

    start: np.ndarray
    waypoints: np.ndarray
    num_waypoints: np.ndarray
    length: np.ndarray


class _Ground:
    """The graph of places of a robot's centre in one scene; only its largest connected part."""

    def __init__(self, bank: SceneBank, scene: int, robot: RobotSpec) -> None:
        half_width = _OPTIONS.width_share * float(robot.planner_radius)
        maps = build_clearance_maps(bank, [scene], robot.planner_height)
        clear = np.minimum(maps.to_hull[scene], maps.to_edge[scene]).astype(np.float32)
        self.clear = pooled(clear, POOL, np.mean)
        self.grid = Grid(maps.origin[scene], NODE, self.clear.shape)
        self.heights = free_space.ground_height(bank, scene, self.grid)
        step = round(NODE / float(bank.map_resolution))
        x, y = self.clear.shape
        self.kind = bank.map_kind[scene][step // 2 :: step, step // 2 :: step][:x, :y]
        price = 1.0 + extra_near(self.clear, half_width)
        price = np.where(self.kind == KIND_INDEX["ground"], _OPTIONS.lawn_cost * price, price)
        self.graph = GridGraph(
            self.clear >= half_width + _OPTIONS.slack,
            lambda step, tail, head: NODE * np.hypot(*step) * (price[tail] + price[head]) / 2,
        )
        cells = self.graph.cells
        self.main = np.zeros(len(cells), bool)
        if self.graph.edges.nnz:
            _, label = csgraph.connected_components(self.graph.edges, connection="strong")
            self.main = label == np.bincount(label).argmax()
        #: Nodes where a robot may begin or end.
        self.places = np.zeros(self.clear.shape, bool)
        wide = self.main & (self.clear[tuple(cells.T)] >= _OPTIONS.place_clearance)
        self.places[tuple(cells[wide].T)] = True
        self.places &= self.kind == KIND_INDEX["sidewalk"]
        centres = self.grid.centres(np.argwhere(self.places))
        for row in rectangles(bank, scene):
            self.places[self.places] = ~row.holds(centres, _OPTIONS.from_kerb - NODE)
            centres = self.grid.centres(np.argwhere(self.places))

    def route(self, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
        """Start (4,), waypoints (W, 3) and length (m) of a route through nodes (n,)."""
        cells = self.graph.cells[nodes]
        points = np.concatenate([self.grid.centres(cells), self.heights[tuple(cells.T)][:, None]], -1)
        corners = points[_corners(points[:, :2])]
        along = corners[1] - corners[0]
        length = float(np.linalg.norm(np.diff(corners[:, :2], axis=0), axis=-1).sum())
        return np.append(corners[0], np.arctan2(along[1], along[0])), corners[1:], length


def _corners(points: np.ndarray) -> list[int]:
    """Indices of points (n, 2) m of a path, the first and last among them, whose line keeps to the path."""
    found, last = [0], len(points) - 1
    while found[-1] < last:
        first, behind = found[-1], found[-1] + 1
        while behind < last:
            kept = _kept_by(points[first : min(behind + _AHEAD, last) + 1], behind - first)
            behind += kept
            if kept < _AHEAD:
                break
        found.append(behind)
    return found


def _kept_by(points: np.ndarray, checked: int) -> int:
    """How many of the points (n, 2) m of a path behind number `checked` a line from the first reaches one after the
    other without leaving the path."""
    chords = points[checked + 1 :] - points[0]
    lengths = np.sqrt(chords[:, 0] * chords[:, 0] + chords[:, 1] * chords[:, 1])
    passed = points[1:-1] - points[0]
    aside = np.abs(passed[:, 0] * chords[:, 1:] - passed[:, 1] * chords[:, :1]) / np.maximum(lengths, 1e-9)[:, None]
    between = np.arange(len(passed)) < checked + np.arange(len(chords))[:, None]
    leaves = np.where(between, aside, 0.0).max(1, initial=0.0) > _OPTIONS.tolerance
    ends = np.flatnonzero(leaves | (lengths < NODE) | (lengths > _OPTIONS.spacing))
    return int(ends[0]) if len(ends) else len(chords)


def _stacked(rows: Sequence[tuple[np.ndarray, np.ndarray, float]]) -> Routes | None:
    if not rows:
        return None
    most = max(len(points) for _, points, _ in rows)
    waypoints = np.stack([np.concatenate([p, np.repeat(p[-1:], most - len(p), 0)]) for _, p, _ in rows])
    return Routes(
        np.stack([start for start, _, _ in rows]).astype(np.float32),
        waypoints.astype(np.float32),
        np.array([len(points) for _, points, _ in rows], np.int32),
        np.array([length for *_, length in rows], np.float32),
    )


def long_routes(
    bank: SceneBank, scene: int, number: int, robot: RobotSpec, length: float, needs_crosswalk: bool
) -> Routes | None:
    """Routes of at least `length` m over pavements and crosswalks of a scene, drawn from `number`; None if there are
    none.

    Args:
      needs_crosswalk: whether there are none in a scene without a crosswalk. In others each route has one.
    """
    ground = _Ground(bank, scene, robot)
    cells, graph = ground.graph.cells, ground.graph
    on_foot = np.zeros(ground.kind.shape, bool)
    on_foot[tuple(cells[ground.main].T)] = True
    crosses = on_foot & (ground.kind == KIND_INDEX["crosswalk"])
    has_crosswalk = bool(crosses.any())
    if (needs_crosswalk and not has_crosswalk) or not ground.places.any():
        return None
    parts, count = ndimage.label(on_foot & ~crosses, np.ones((3, 3)))
    large = [k for k in range(1, count + 1) if (parts == k).sum() * NODE**2 >= _OPTIONS.min_part]
    candidates = graph.number[ground.places & np.isin(parts, large)]
    if not len(candidates):
        return None
    side_of = parts[tuple(cells.T)]
    # One place on each pavement, then always the farthest from those before it.
    places: list[int] = []
    costs: list[np.ndarray] = []
    following: list[np.ndarray] = []

    def add(place: int) -> None:
        cost, after = graph.to_goal(place)
        places.append(place)
        costs.append(cost)
        following.append(after)

    for k in large:
        here = candidates[side_of[candidates] == k]
        if len(here) and len(places) < _OPTIONS.places:
            add(int(here[np.argmax(ground.clear[tuple(cells[here].T)])]))
    while len(places) < _OPTIONS.places:
        nearest = np.min(costs, axis=0)[candidates]
        if nearest.max() < _OPTIONS.min_leg:
            break
        add(int(candidates[nearest.argmax()]))
    rng = np.random.default_rng(number)
    rows = []
    for _ in range(_OPTIONS.tries * _OPTIONS.number):
        nodes = _walk(ground, places, costs, following, side_of, _OPTIONS.shortening * length, rng)
        if nodes is None or (has_crosswalk and not crosses[tuple(cells[nodes].T)].any()):
            continue
        route = ground.route(nodes)
        if route[2] >= length:
            rows.append(route)
        if len(rows) == _OPTIONS.number:
            break
    return _stacked(rows)


def _walk(
    ground: _Ground,
    places: Sequence[int],
    costs: Sequence[np.ndarray],
    following: Sequence[np.ndarray],
    side_of: np.ndarray,
    length: float,
    rng: np.random.Generator,
) -> np.ndarray | None:
    """(n,) nodes of a walk between places that ends at the first place after `length` m; None if there is nowhere to
    go on to."""
    at, before = int(rng.integers(len(places))), -1
    walked, total = [np.array([places[at]])], 0.0
    cells = ground.graph.cells
    is_place = ground.places[tuple(cells.T)]
    while total < length:
        others = [
            k for k in range(len(places)) if k not in (at, before) and _OPTIONS.min_leg <= costs[k][places[at]] < np.inf
        ] or ([before] if before >= 0 else [])
        if not others:
            return None
        across = np.array([side_of[places[k]] != side_of[places[at]] for k in others])
        weight = np.where(across, _OPTIONS.other_side, 1.0)
        at, before = int(rng.choice(others, p=weight / weight.sum())), at
        leg = ground.graph.path(following[at], places[before])[1:]
        steps = np.linalg.norm(np.diff(cells[np.append(walked[-1][-1:], leg)], axis=0), axis=-1) * NODE
        reached = total + np.cumsum(steps)
        ends = np.flatnonzero((reached >= length) & is_place[leg])
        if len(ends):
            return np.concatenate([*walked, leg[: ends[0] + 1]])
        walked.append(leg)
        total = float(reached[-1])
    return np.concatenate(walked)


# Tables of banks.


def with_long_routes(
    bank: SceneBank, scenes: Int32[np.ndarray, " n"], robot: RobotSpec, length: float, needs_crosswalk: bool = True
) -> tuple[SceneBank, Int32[np.ndarray, " n"]]:
    """`with_routes` of `long_routes`.

    Raises:
      ValidationError: no scene has routes.
    """
    make = functools.partial(long_routes, robot=robot, length=length, needs_crosswalk=needs_crosswalk)
    name = f"long {length:g}" + ("" if needs_crosswalk else ", crosswalk or not")
    needed = "a crosswalk between pavements" if needs_crosswalk else f"a way of {length:g} m over pavements"
    return with_routes(bank, scenes, robot, name, make, needed)


def with_routes(
    bank: SceneBank,
    scenes: Int32[np.ndarray, " n"],
    robot: RobotSpec,
    name: str,
    make: Callable[[SceneBank, int, int], Routes | None],
    needed: str,
) -> tuple[SceneBank, Int32[np.ndarray, " n"]]:
    """The bank with routes in place of the episodes of some scenes (n,), and those scenes that have any.

    Args:
      name: of the routes, with their parameters: a part of the cache's key.
      make: function (bank, scene, number) -> routes of a scene with that number in `bank`, see `long_routes`; of many
        scenes in processes of their own, each with `SceneBank.geometry_of` the scene.
      needed: what a scene needs for them, for the message.

    Raises:
      ValidationError: no scene has routes.
    """
    paths = dict(zip(scenes.tolist(), paths_of(bank, scenes.tolist(), robot, name), strict=True))
    arrays = {z: array_file.load_cached(path, "routes of a task", Routes._fields) for z, path in paths.items()}
    missing = [z for z, kept in arrays.items() if kept is None]
    tasks = ((bank.geometry_of(z), 0, z) for z in missing)
    workers = workers_for(len(missing), settings.num_threads())
    for z, routes in zip(missing, results_in_order(make, tasks, workers, settings.use_processor_alone), strict=True):
        # A scene without any has a table without rows.
        made = routes or Routes(np.zeros((0, 4)), np.zeros((0, 1, 3)), np.zeros(0, np.int32), np.zeros(0))
        own = dict(made._asdict())
        array_file.save_cached(paths[z], own)
        arrays[z] = own
    found = {z: _routes_in(kept) for z, kept in arrays.items() if kept is not None}
    usable = np.array([z for z, routes in found.items() if routes is not None], np.int32)
    if not len(usable):
        names = ", ".join(bank.scene_ids[z] for z in list(found)[:5])
        raise ValidationError(
            f"config.scenes: found none of {len(found)} ({names}) with {needed}, needed one; name other scenes or "
            "another bank."
        )
    kept = [routes for routes in found.values() if routes is not None]
    rows, points = max(len(r.start) for r in kept), max(r.waypoints.shape[1] for r in kept)
    count = bank.num_scenes
    # Scenes that are not used keep their first episode, because each needs one.
    start = np.repeat(bank.episode_start[:, :1], rows, 1)
    waypoints = np.repeat(bank.episode_goal[:, :1, None], rows, 1).repeat(points, 2)
    number, lengths = np.ones((count, rows), np.int32), np.repeat(bank.episode_length[:, :1], rows, 1)
    total = np.ones(count, np.int32)
    for z, routes in found.items():
        if routes is None:
            continue
        n, w = routes.waypoints.shape[:2]
        start[z, :n], number[z, :n], lengths[z, :n] = routes.start, routes.num_waypoints, routes.length
        waypoints[z, :n] = routes.waypoints[:, -1:]
        waypoints[z, :n, :w] = routes.waypoints
        total[z] = n
    new = dataclasses.replace(
        bank,
        episode_start=start,
        episode_goal=np.ascontiguousarray(waypoints[:, :, -1]),
        episode_waypoints=waypoints,
        episode_num_waypoints=number,
        episode_length=lengths,
        num_episodes=total,
    )
    return new, usable


_OF_SCENE = ("inst_hull", "inst_position", "inst_rotation", "prism_hull", "prism_position", "map_kind", "map_origin")


def _routes_in(arrays: Mapping[str, np.ndarray]) -> Routes | None:
    return Routes(**{k: arrays[k] for k in Routes._fields}) if len(arrays["start"]) else None


def paths_of(bank: SceneBank, scenes: Sequence[int], robot: RobotSpec, name: str) -> list[pathlib.Path]:
    """The files in the cache of the routes of some scenes."""
    parts = (versions.of("routes"), dataclasses.astuple(_OPTIONS), name, robot.mjcf, robot.planner_height)
    shared = hashlib.sha256(repr((*parts, float(bank.map_resolution))).encode())
    shared.update(np.ascontiguousarray(bank.hull_vertices).data)
    found = []
    for scene in scenes:
        digest = shared.copy()
        digest.update(str(int(scene)).encode())
        for field in _OF_SCENE:
            digest.update(np.ascontiguousarray(getattr(bank, field)[scene]).data)
        found.append(settings.cache_dir("routes", f"{digest.hexdigest()[:24]}.npz"))
    return found
