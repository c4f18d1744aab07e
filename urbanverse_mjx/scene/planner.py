"""Path planning for a robot: cost fields on a coarse grid, and paths shortened on the 5 cm map.

There are two cost tables: `WALK`, with which episodes stay on pavements and never cross a kerb (a free straight line is
then always optimal), and `NAVBENCH`, with which CraftBench-Nav's robots climb kerbs and cross roads where that is
cheaper.
"""

import dataclasses
from collections.abc import Generator, Mapping, Sequence

import numpy as np
from scipy import ndimage
from skimage.graph import MCP_Geometric

from ..datatypes.ground import GROUND_KINDS, KIND_INDEX
from ..geometry.geodesics import extra_near
from ..geometry.grids import cell_of, closed, pooled
from ..geometry.polylines import arc_lengths, points_at
from .geometry import SceneMap

#: Cells of the 5 cm map along a side of a planning cell (20 cm) for episodes.
POOL = 4
#: Cost per metre by kind of ground; up to 1.0 is added within 0.5 m of objects (docs/sources/reference_systems.md b.2).
KIND_COST = {"sidewalk": 1.0, "ground": 1.2, "crosswalk": 1.5}
NEAR_COST, NEAR_DISTANCE = 1.0, 0.5
#: m, least step between neighbouring cells that counts as a kerb (same source).
MIN_KERB_STEP = 0.03
#: m; road within this distance of painted stripes on two sides is part of the crosswalk (same source).
_MAX_STRIPE_GAP = 0.6
#: Number of additional shortening passes; even, because each reverses the path.
_SHORTENING_PASSES = 2


@dataclasses.dataclass(frozen=True)
class RobotSize:
    """Size of the robot for route planning; defaults are navbench's `delivery` robot (docs/sources/reference_systems.md
    b.2).

    Attributes:
      radius: m, half of the width that it needs.
      margin: m, additional clearance while driving.
      end_margin: m, additional clearance at starts and goals.
      height: m.
      step: m, the highest edge that it may drive over.
    """

    radius: float = 0.35
    margin: float = 0.05
    end_margin: float = 0.15
    height: float = 1.0
    step: float = 0.03


@dataclasses.dataclass(frozen=True)
class PriceList:
    """The cost of a path and the resolution of its search grid.

    Attributes:
      kinds: cost per metre by kind of ground; other kinds are not traversable.
      pool: cells of the map along a side of a planning cell.
      kerb: m of sidewalk that cost as much as climbing one kerb. If above 0, a straight line replaces a path only if it
        costs no more.
    """

    kinds: Mapping[str, float]
    pool: int = POOL
    kerb: float = 0.0


WALK = PriceList(KIND_COST)
#: CraftBench-Nav: 10 cm cells; the cost of roads is six times that of sidewalks, that of a kerb is 5 m.
NAVBENCH = PriceList({**KIND_COST, "road": 6.0, "road_marking": 6.0}, pool=2, kerb=5.0)

#: CraftBench-Nav's robots: radius, height, and the highest step that they climb.
ROBOTS: dict[str, RobotSize] = {
    "delivery": RobotSize(0.35, margin=0.0, height=1.0, step=0.22),
    "quadruped": RobotSize(0.35, margin=0.0, height=0.5, step=0.25),
    "wheelchair": RobotSize(0.45, margin=0.0, height=1.4, step=0.05),
}


@dataclasses.dataclass(frozen=True)
class FreeSpace:
    """The traversable space of a robot on the 5 cm map.

    Attributes:
      map: its input.
      distance: (X, Y) m from a cell to the nearest obstacle or end of the ground, minus half a cell.
      free: (X, Y) bool, whether the robot's centre may be in a cell.
      cost: (X // pool, Y // pool) per metre, -1 = not passable.
      pool: cells of the map along a side of a planning cell.
      price: (X, Y) cost per metre of straight lines; None if free straight lines are always optimal.
    """

    map: SceneMap
    distance: np.ndarray
    free: np.ndarray
    cost: np.ndarray
    pool: int = POOL
    price: np.ndarray | None = None

    def cell(self, xy: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(i, j) of points (..., 2), clipped to the map."""
        cells = self.map.grid.cell(xy)
        return cells[..., 0], cells[..., 1]

    def coarse_center(self, cells: np.ndarray) -> np.ndarray:
        """(n, 2) centres, m, of planning cells (n, 2)."""
        return self.map.origin + (np.asarray(cells) + 0.5) * self.pool * self.map.resolution

    def coarse_cell(self, xy: np.ndarray) -> np.ndarray:
        """(..., 2) indices of the planning cells that contain points (..., 2); they may be outside the map."""
        return cell_of(np.asarray(xy), self.map.origin, self.pool * self.map.resolution)

    def _lines(self, a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Cells (i, j) under points at most one cell (half a cell if lines have a cost) apart on the straight lines
        from a to b, (n, 2) m, concatenated, and (n,) the index at which each line begins."""
        span, resolution = b - a, self.map.resolution
        apart = resolution if self.price is None else resolution / 2
        number = np.maximum(1, np.ceil(np.sqrt((span * span).sum(1)) / apart)).astype(np.intp)
        first = np.concatenate([[0], np.cumsum(number + 1)])
        step = np.arange(first[-1]) - np.repeat(first[:-1], number + 1)
        line = np.repeat(np.arange(len(a)), number + 1)
        cells = ((a - self.map.origin)[line] + step[:, None] * (span / number[:, None])[line]) / resolution
        i, j = cells.astype(np.intp).T
        return i, j, first

    def lines_free(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """(n,) bool, whether the robot can drive straight from a to b, (n, 2) m each."""
        i, j, first = self._lines(a, b)
        return np.logical_and.reduceat(self.free[i, j], first[:-1])

    def line_prices(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """(n,) cost of the straight lines from a to b, (n, 2) m each, free or not; equal to their length if all costs
        are 1."""
        length = np.linalg.norm(b - a, axis=1)
        if self.price is None:
            return length
        i, j, first = self._lines(a, b)
        return length * np.add.reduceat(self.price[i, j], first[:-1]) / np.diff(first)


def free_space(scene_map: SceneMap, size: RobotSize, prices: PriceList = WALK) -> FreeSpace:
    """Dilates obstacles by the robot's radius and assigns costs to the free cells."""
    kind = whole_crosswalks(scene_map).kind if prices.kerb else scene_map.kind
    of_kind = np.array([prices.kinds.get(name, 0.0) for name in GROUND_KINDS])
    allowed = (of_kind > 0)[kind] & (scene_map.clearance >= size.height) & ~_edges(scene_map.height, size.step)
    resolution = scene_map.resolution
    distance = (ndimage.distance_transform_edt(allowed) * resolution - resolution / 2).astype(np.float32)
    free = distance >= size.radius + size.margin
    price = of_kind[kind] + extra_near(distance, size.radius, NEAR_COST, NEAR_DISTANCE)
    cost = pooled(price, prices.pool, np.max)
    if prices.kerb:
        # Both cells beside a kerb count as its edge, so crossing it passes two of them.
        kerb = _edges(scene_map.height, MIN_KERB_STEP) * (prices.kerb / (2 * resolution))
        cost, price = cost + pooled(kerb, prices.pool, np.mean), price + kerb
    cost = np.where(pooled(free, prices.pool, np.all), cost, -1.0)
    return FreeSpace(scene_map, distance, free, cost, prices.pool, price if prices.kerb else None)


def whole_crosswalks(scene_map: SceneMap) -> SceneMap:
    """Marks the road between the stripes of a crosswalk as crosswalk. The authors' maps mark only the stripes, and
    paths would weave between them."""
    stripes = scene_map.kind == KIND_INDEX["crosswalk"]
    road = np.isin(scene_map.kind, [KIND_INDEX["road"], KIND_INDEX["road_marking"]])
    between = closed(stripes, _MAX_STRIPE_GAP, scene_map.resolution) & road
    return dataclasses.replace(scene_map, kind=np.where(between, np.uint8(KIND_INDEX["crosswalk"]), scene_map.kind))


def _edges(height: np.ndarray, step: float) -> np.ndarray:
    """Cells beside a step higher than `step`."""
    edge = np.zeros(height.shape, bool)
    for axis in (0, 1):
        jump = np.abs(np.diff(height, axis=axis)) > step  # False beside NaN: no ground is not traversable anyway
        pad = [(0, 0), (0, 0)]
        pad[axis] = (0, 1)
        low = np.pad(jump, pad)
        pad[axis] = (1, 0)
        edge |= low | np.pad(jump, pad)
    return edge


class GoalField:
    """Cheapest paths from all cells to one goal."""

    def __init__(self, space: FreeSpace, goal: np.ndarray) -> None:
        """`goal`: (2,) numbers of a passable planning cell."""
        self._space = space
        self._search = MCP_Geometric(space.cost, fully_connected=True)
        costs, _ = self._search.find_costs([tuple(int(c) for c in goal)])
        #: Cost from every planning cell to the goal, inf without a path.
        self.cost: np.ndarray = costs * space.pool * space.map.resolution

    def paths(self, starts: np.ndarray) -> list[np.ndarray]:
        """Shortened paths (k, 2) m to the goal from planning cells (n, 2) of finite cost."""
        paths = []
        for start in starts:
            cells = np.array(self._search.traceback(tuple(int(c) for c in start)))[::-1]
            paths.append(self._space.coarse_center(cells))
        paths = _pull_all(self._space, paths)
        # Corners lie on planning cells; further shortening between finer points, from both ends, removes most of this
        # discretisation.
        for _ in range(_SHORTENING_PASSES):
            fine = [np.concatenate([p[:1], resample(p, self._space.pool * self._space.map.resolution)]) for p in paths]
            paths = _pull_all(self._space, [p[::-1] for p in fine])
        return paths


def _pull_all(space: FreeSpace, paths: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Shortens several paths (k, 2) at once, so that NumPy checks their lines in one batch."""
    kept: list[np.ndarray] = [np.zeros((0, 2))] * len(paths)
    pulls = {n: _pull(len(path)) for n, path in enumerate(paths)}
    answers: dict[int, bool | None] = dict.fromkeys(pulls)
    running_costs = None if space.price is None else [_costs_along(space, path) for path in paths]
    while pulls:
        asked = {}
        for n, pull in list(pulls.items()):
            try:
                asked[n] = pull.send(answers[n])
            except StopIteration as end:
                kept[n] = paths[n][end.value]
                del pulls[n]
        if asked:
            a = np.array([paths[n][i] for n, (i, _) in asked.items()])
            b = np.array([paths[n][j] for n, (_, j) in asked.items()])
            good = space.lines_free(a, b)
            if running_costs is not None:
                # Tolerance of 0.1 %, because sampling changes the cost of the same line slightly.
                along = np.array([running_costs[n][j] - running_costs[n][i] for n, (i, j) in asked.items()])
                good &= space.line_prices(a, b) <= 1.001 * along
            answers = dict(zip(asked, good.tolist(), strict=True))
    return kept


def _costs_along(space: FreeSpace, path: np.ndarray) -> np.ndarray:
    """(k,) cost of a path (k, 2) from its first point to each."""
    return np.concatenate([[0.0], np.cumsum(space.line_prices(path[:-1], path[1:]))])


def _pull(count: int) -> Generator[tuple[int, int], bool | None, list[int]]:
    """Coroutine that replaces sections of a path by straight lines; tries section lengths by doubling.

    Yields the indices of two of the path's `count` points, receives whether the line between them is allowed, and
    returns the indices of the points that are kept.
    """
    kept, here, last = [0], 0, count - 1
    while here < last:
        near, stride = here + 1, 2
        while near < last and (yield here, min(here + stride, last)):
            near, stride = min(here + stride, last), stride * 2
        far = min(here + stride, last)
        while far - near > 1:
            middle = (near + far) // 2
            near, far = (middle, far) if (yield here, middle) else (near, middle)
        here = near
        kept.append(here)
    return kept


def path_length(path: np.ndarray) -> float:
    """Length (m) of a polyline (n, 2)."""
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())


def resample(path: np.ndarray, spacing: float) -> np.ndarray:
    """Points on a polyline (n, 2) every `spacing` m, without its first point and always with its last."""
    span = arc_lengths(path)
    number = max(1, int(np.ceil(span[-1] / spacing - 1e-6)))
    at = np.minimum(spacing * np.arange(1, number + 1), span[-1])
    points = points_at(path, span, at)
    points[-1] = path[-1]  # to the bit: the same goal in every row
    return points
