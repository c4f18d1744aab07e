"""Plans routes as CraftBench-Nav does (docs/sources/reference_systems.md b.2), between given or chosen points.

A `Wanted` route has a start and a goal that a person selected or `RoutePlanner.choose` drew; a `Route` is planned from
it for one robot.
"""

import dataclasses
import itertools
from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy import ndimage

from ..datatypes.ground import GROUND_KINDS, KIND_INDEX
from .geometry import SceneMap
from .planner import MIN_KERB_STEP, NAVBENCH, ROBOTS, FreeSpace, GoalField, RobotSize, free_space, path_length, resample

Point = tuple[float, float]

#: Distance (m) between waypoints of a route.
SPACING = 0.5
#: rad, least change of direction that counts as a turn.
MIN_TURN = np.pi / 6
#: m, least continuous length on these kinds that counts as a road crossing.
MIN_CROSSING_LENGTH = 1.0
ROAD_KINDS = ("road", "road_marking", "crosswalk")
#: m by which a start, via point or goal on blocked ground may be moved.
MAX_SNAP_DISTANCE = 1.0
#: For each goal of the chosen routes, the path costs of its starts, as shares of the largest path cost to it.
START_COST_SHARES = ((1.0, 0.75, 0.5, 0.25), (0.9, 0.65, 0.4, 0.2), (1.0, 0.7, 0.45, 0.2))
#: m, additional clearance at chosen starts and goals.
_START_CLEARANCE = 0.15
#: Relative difference to the target cost within which starts are equally good.
_COST_TOLERANCE = 0.03


@dataclasses.dataclass(frozen=True)
class Wanted:
    """A route to be planned: (x, y) m in the world; `via` are points to pass, in order."""

    id: str
    start: Point
    goal: Point
    via: tuple[Point, ...] = ()
    note: str = ""


@dataclasses.dataclass(frozen=True, eq=False)
class Route:
    """A planned route.

    Attributes:
      id, note: those of the `Wanted` route.
      points: start, via points and goal, moved off blocked ground.
      path: (n, 2) m, its corners.
      waypoints: (N, 4) x, y, z, yaw every 0.5 m.
      facts: its statistics in `routes.json`.
    """

    id: str
    note: str
    points: tuple[Point, ...]
    path: np.ndarray
    waypoints: np.ndarray
    facts: dict[str, Any]


@dataclasses.dataclass(frozen=True)
class NoRoute:
    """A route that could not be planned, and the reason in one sentence."""

    id: str
    note: str
    error: str


class RoutePlanner:
    """Plans routes over one map for one robot."""

    def __init__(self, scene_map: SceneMap, robot: str = "delivery", size: RobotSize | None = None) -> None:
        """`size`: size of a robot that is not in `ROBOTS`."""
        self.robot = robot
        self.size = size or ROBOTS[robot]
        self.space: FreeSpace = free_space(scene_map, self.size, NAVBENCH)
        self._fields: dict[tuple[int, int], GoalField] = {}

    def plan(self, wanted: Sequence[Wanted]) -> list[Route | NoRoute]:
        """Plans routes; returns for each the route or the reason of the failure."""
        return [self._plan(w) for w in wanted]

    def choose(self, seed: int = 0) -> list[Wanted]:
        """Chooses twelve routes across the scene: to both ends and the middle of the longest path, from several
        distances.

        Empty without walkable ground for the robot.
        """
        rng = np.random.default_rng([seed, 12])
        cells = self._places()
        if len(cells) < 2:
            return []
        first = self._farthest(cells, tuple(cells[0]))
        second = self._farthest(cells, first)
        halfway = self._costs(cells, first)
        middle = tuple(cells[int(np.abs(halfway - halfway.max() / 2).argmin())])
        ends = []
        for goal, shares in zip((first, second, middle), START_COST_SHARES, strict=True):
            costs = self._costs(cells, goal)
            for share in shares:
                off = np.abs(costs - share * costs.max())
                alike = np.flatnonzero(off <= max(_COST_TOLERANCE * costs.max(), off.min()))
                ends.append((cells[int(rng.choice(alike))], goal))
        centres = [tuple(self._point(cell) for cell in pair) for pair in ends]
        return [Wanted(f"r{i:03d}", start, goal) for i, (start, goal) in enumerate(centres, 1) if start != goal]

    def _places(self) -> np.ndarray:
        """(n, 2) planning cells with clearance in the largest connected area, on sidewalks if there are any."""
        place, _ = ndimage.label(self.space.cost > 0, np.ones((3, 3)))
        sizes = np.bincount(place.ravel())
        sizes[0] = 0
        cells = np.argwhere((place == sizes.argmax()) & (self.space.cost > 0))
        i, j = self.space.cell(self.space.coarse_center(cells))
        roomy = self.space.distance[i, j] >= self.size.radius + _START_CLEARANCE
        on_sidewalk = roomy & (self.space.map.kind[i, j] == KIND_INDEX["sidewalk"])
        return cells[on_sidewalk if on_sidewalk.any() else roomy]

    def _field(self, cell: tuple[int, int]) -> GoalField:
        """Paths to a planning cell; the last few fields are cached."""
        if cell not in self._fields:
            if len(self._fields) == 4:
                del self._fields[next(iter(self._fields))]
            self._fields[cell] = GoalField(self.space, np.array(cell))
        return self._fields[cell]

    def _costs(self, cells: np.ndarray, goal: tuple[int, int]) -> np.ndarray:
        return self._field(goal).cost[cells[:, 0], cells[:, 1]]

    def _farthest(self, cells: np.ndarray, goal: tuple[int, int]) -> tuple[int, int]:
        i, j = cells[int(self._costs(cells, goal).argmax())]
        return int(i), int(j)

    def _point(self, cell: Any) -> Point:
        x, y = self.space.coarse_center(np.asarray(cell))
        return round(float(x), 3), round(float(y), 3)

    def _plan(self, wanted: Wanted) -> Route | NoRoute:
        places = [wanted.start, *wanted.via, wanted.goal]
        names = ["start", *(f"via point {i}" for i in range(1, len(places) - 1)), "goal"]
        cells = []
        for place, name in zip(places, names, strict=True):
            cell = self._snap(place)
            if cell is None:
                where = f"the {name} ({place[0]:.2f}, {place[1]:.2f})"
                why = (
                    f"{where} is blocked for the {self.robot} robot or off the map, and so is all within "
                    f"{MAX_SNAP_DISTANCE:g} m"
                )
                return NoRoute(wanted.id, wanted.note, why)
            cells.append(cell)
        path = np.asarray([self.space.coarse_center(np.array(cells[0]))])
        for a, b, name in zip(cells, cells[1:], names[1:], strict=False):
            field = self._field(b)
            if not np.isfinite(field.cost[a]):
                why = f"the {name} cannot be reached: there is no way for the {self.robot} robot"
                return NoRoute(wanted.id, wanted.note, why)
            if a != b:
                (leg,) = field.paths(np.array([a]))
                path = np.concatenate([path, leg[1:]])
        if len(path) < 2:
            return NoRoute(wanted.id, wanted.note, "start and goal are the same place")
        points = tuple(self._point(cell) for cell in cells)
        return Route(wanted.id, wanted.note, points, path, self._waypoints(path), self._facts(path))

    def _snap(self, place: Point) -> tuple[int, int] | None:
        """The passable planning cell at a point or the nearest one within `MAX_SNAP_DISTANCE`."""
        shape = np.array(self.space.cost.shape)
        cell = self.space.coarse_cell(np.array(place))
        if ((cell < 0) | (cell >= shape)).any():
            return None
        reach = int(np.ceil(MAX_SNAP_DISTANCE / (self.space.pool * self.space.map.resolution)))
        low, high = np.maximum(cell - reach, 0), np.minimum(cell + reach + 1, shape)
        near = np.argwhere(self.space.cost[low[0] : high[0], low[1] : high[1]] > 0) + low
        away = np.linalg.norm(near - cell, axis=1)
        if not len(near) or away.min() > reach:
            return None
        i, j = near[int(away.argmin())]
        return int(i), int(j)

    def _waypoints(self, path: np.ndarray) -> np.ndarray:
        points = np.concatenate([path[:1], resample(path, SPACING)])
        steps = np.diff(points, axis=0)
        yaw = np.arctan2(steps[:, 1], steps[:, 0])
        z = self.space.map.height[self.space.cell(points)].astype(np.float64)
        return np.round(np.column_stack([points, z, np.append(yaw, yaw[-1])]), 4)

    def _facts(self, path: np.ndarray) -> dict[str, Any]:
        """Statistics of a path: lengths in m; `curbs` counts steps over 3 cm, `climb_m` is the difference of the
        highest and the lowest ground (definitions of CraftBench-Nav)."""
        m = self.space.map
        fine = np.concatenate([path[:1], resample(path, m.resolution)])
        cells = self.space.cell(fine)
        kind, z = m.kind[cells], m.height[cells].astype(np.float64)
        length, straight = path_length(path), float(np.linalg.norm(path[-1] - path[0]))
        share = np.bincount(kind, minlength=len(GROUND_KINDS)) / len(kind) * length
        on_road = np.isin(kind, [KIND_INDEX[name] for name in ROAD_KINDS])
        runs = [len(list(run)) for road, run in itertools.groupby(on_road) if road]
        legs = np.diff(path, axis=0)
        turns = np.diff(np.unwrap(np.arctan2(legs[:, 1], legs[:, 0])))
        return {
            "length_m": round(length, 2),
            "straight_m": round(straight, 2),
            "detour": round(length / straight, 3) if straight > 0 else None,
            "by_kind_m": {n: round(float(s), 2) for n, s in zip(GROUND_KINDS, share, strict=True) if s > 0},
            "road_crossings": sum(n * length / len(kind) >= MIN_CROSSING_LENGTH for n in runs),
            "curbs": int((np.abs(np.diff(z)) > MIN_KERB_STEP).sum()),
            "min_clearance_m": round(float(self.space.distance[cells].min()), 2),
            "turns": int((np.abs(turns) > MIN_TURN).sum()),
            "climb_m": round(float(np.ptp(z)), 2),
        }
