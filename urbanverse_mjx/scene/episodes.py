"""Builds episode tables: starts and goals 10-30 m apart with the geodesic between them, each driven once."""

import dataclasses
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from scipy import ndimage

from ..datatypes import validation as v
from ..datatypes.ground import KIND_INDEX
from .drive import Drive
from .geometry import EpisodeTable
from .planner import POOL, FreeSpace, GoalField, RobotSize, path_length, resample

#: Function (starts (E, 4), paths) -> result of each drive.
DriveAll = Callable[[np.ndarray, Sequence[np.ndarray]], list[Drive]]


@dataclasses.dataclass(frozen=True)
class SamplingOptions:
    """Numbers of starts and goals to try; chosen manually.

    Attributes:
      starts_per_goal: starts tried for every goal, among which rows are selected.
      samples: positions tried for starts with a free straight line to the goal.
      goal_spacing: m, least distance between goals, as long as there are enough positions.
      min_island: least size of a connected area that is used, as a share of the largest one.
      min_crossing: m, least length of crosswalk on a route that counts as a crossing.
    """

    starts_per_goal: int = 28
    samples: int = 400
    goal_spacing: float = 2.0
    min_island: float = 0.4
    min_crossing: float = 2.0


_OPTIONS = SamplingOptions()


@dataclasses.dataclass(frozen=True)
class EpisodeRules:
    """Rules of an episode table (paper: goals 10-30 m away; here 256 rows, 32 goals, waypoints every 5 m).

    Attributes:
      rows, goals: number of rows and of goals.
      distance: (low, high) m, straight from start to goal.
      detour: largest ratio of path length to straight distance.
      spacing: m between waypoints.
      yaw: rad, largest deviation of the start's yaw from its first segment.
      line_share, crossing_share: target shares of rows with a free straight line, and of rows over a crosswalk.
    """

    rows: int = 256
    goals: int = 40
    distance: tuple[float, float] = (10.0, 30.0)
    detour: float = 1.8
    spacing: float = 5.0
    yaw: float = np.pi / 6
    line_share: float = 1 / 3
    crossing_share: float = 0.2


#: Fewest rows with which a scene can be used.
MIN_ROWS = 256


@dataclasses.dataclass(frozen=True)
class _Row:
    goal: int
    start: np.ndarray
    path: np.ndarray
    line_free: bool
    crosses: bool


def build_episodes(
    space: FreeSpace, size: RobotSize, seed: int, drive: DriveAll, rules: EpisodeRules | None = None
) -> EpisodeTable:
    """Builds the table of one scene, deterministically for a seed.

    Rows that `drive` fails are replaced by others as long as there are any.

    Raises:
      NoRoomError: the walkable ground has too little room for `MIN_ROWS` rows.
    """
    rules = rules or EpisodeRules()
    rng = np.random.default_rng(seed)
    cells = _end_cells(space, size)
    if len(cells) < 2:
        raise _no_room(f"{len(cells)} places to start from")
    pool = _candidate_pool(space, cells, rules, rng)
    pool = [pool[i] for i in _mixed_order(pool, rules, rng)]
    chosen: list[tuple[_Row, np.ndarray, Drive]] = []
    while pool and len(chosen) < rules.rows:
        batch, pool = pool[: rules.rows - len(chosen)], pool[rules.rows - len(chosen) :]
        starts = np.array([_start(space, row, rules, rng) for row in batch])
        drives = drive(starts, [row.path for row in batch])
        chosen += [(r, s, d) for r, s, d in zip(batch, starts, drives, strict=True) if d.seconds >= 0]
    if len(chosen) < MIN_ROWS:
        raise _no_room(f"{len(chosen)} routes of {rules.distance[0]:g}-{rules.distance[1]:g} m that a robot can drive")
    return _table(space, chosen, rules)


class NoRoomError(v.ValidationError):
    """Error: the walkable ground has too little room for a table."""


def _no_room(found: str) -> Exception:
    needed = f"walkable ground (sidewalk, crosswalk) with room for {MIN_ROWS} episodes"
    return NoRoomError(str(v.fail("scene", found, needed, "add or widen sidewalks, or free them of objects")))


def _end_cells(space: FreeSpace, size: RobotSize) -> np.ndarray:
    """(n, 2) planning cells for starts and goals, away from obstacles, on sidewalks if there are any.

    Areas much smaller than the largest connected one are left out, because routes there are too short.
    """
    place, _ = ndimage.label(space.cost > 0, np.ones((3, 3)))
    sizes = np.bincount(place.ravel())
    sizes[0] = 0
    middle = np.argwhere(sizes[place] >= max(1, _OPTIONS.min_island * sizes.max()))
    i, j = space.cell(space.coarse_center(middle))
    roomy = space.distance[i, j] >= size.radius + size.end_margin
    on_sidewalk = space.map.kind[i, j] == KIND_INDEX["sidewalk"]
    return middle[roomy & (on_sidewalk if (roomy & on_sidewalk).any() else np.ones(len(middle), bool))]


def _candidate_pool(space: FreeSpace, cells: np.ndarray, rules: EpisodeRules, rng: np.random.Generator) -> list[_Row]:
    """Paths to `rules.goals` goals that have enough paths and, if possible, are far enough from each other."""
    order = rng.permutation(len(cells))
    pool: list[_Row] = []
    taken: list[np.ndarray] = []
    for spacing in (_OPTIONS.goal_spacing, 2 * POOL * space.map.resolution):
        for goal in cells[order]:
            if len(taken) == rules.goals:
                return pool
            place = space.coarse_center(goal)
            if taken and np.linalg.norm(np.array(taken) - place, axis=1).min() < spacing:
                continue
            rows = _candidates(space, cells, goal, len(taken), rules, rng)
            if len(rows) >= _OPTIONS.starts_per_goal // 3:
                taken.append(place)
                pool += rows
    return pool


def _candidates(
    space: FreeSpace, cells: np.ndarray, goal: np.ndarray, number: int, rules: EpisodeRules, rng: np.random.Generator
) -> list[_Row]:
    """Paths to one goal from starts whose straight distances fill the allowed range evenly.

    Half of the starts are searched among positions with a free straight line to the goal, which are rare in a crowded
    street.
    """
    field = GoalField(space, goal)
    end = space.coarse_center(goal)
    away = np.linalg.norm(space.coarse_center(cells) - end, axis=1)
    reach = (
        np.isfinite(field.cost[cells[:, 0], cells[:, 1]]) & (away >= rules.distance[0]) & (away <= rules.distance[1])
    )
    sampled = rng.permutation(np.flatnonzero(reach))[: _OPTIONS.samples]
    visible = sampled[_seen(space, space.coarse_center(cells[sampled]), end)].tolist()
    chosen: list[int] = []
    for draw, wanted in enumerate(rng.uniform(*rules.distance, _OPTIONS.starts_per_goal)):
        near = np.flatnonzero(reach & (np.abs(away - wanted) < 0.5))
        if visible and draw % 2 == 0:
            chosen.append(visible.pop(int(np.abs(away[visible] - wanted).argmin())))
        elif len(near):
            chosen.append(int(rng.choice(near)))
    paths = field.paths(cells[chosen])
    paths = [p for p in paths if path_length(p) <= rules.detour * np.linalg.norm(p[0] - p[-1])]
    free = _seen(space, np.array([p[0] for p in paths]).reshape(-1, 2), end)
    return [_Row(number, p[0], p, bool(f), _crosses(space, p)) for p, f in zip(paths, free, strict=True)]


def _seen(space: FreeSpace, places: np.ndarray, end: np.ndarray) -> np.ndarray:
    """(n,) bool: whether the robot can go straight from places (n, 2) m to the goal (2,) m."""
    return space.lines_free(places, np.broadcast_to(end, places.shape)) if len(places) else np.zeros(0, bool)


def _crosses(space: FreeSpace, path: np.ndarray) -> bool:
    points = resample(path, 0.1)
    return bool((space.map.kind[space.cell(points)] == KIND_INDEX["crosswalk"]).sum() * 0.1 >= _OPTIONS.min_crossing)


def _mixed_order(pool: list[_Row], rules: EpisodeRules, rng: np.random.Generator) -> list[int]:
    """Order of the pool in which every section has the target mix and all goals occur."""
    order = rng.permutation(len(pool))
    turn = dict.fromkeys(range(rules.goals), 0)
    rank = []
    for i in order:
        turn[pool[i].goal] += 1
        rank.append(turn[pool[i].goal])
    order = order[np.argsort(rank, kind="stable")]
    crossing = [i for i in order if pool[i].crosses]
    straight = [i for i in order if pool[i].line_free and not pool[i].crosses]
    winding = [i for i in order if not pool[i].line_free and not pool[i].crosses]
    shares = [rules.crossing_share, rules.line_share, 1 - rules.crossing_share - rules.line_share]
    return _interleave([crossing, straight, winding], shares)


def _interleave(queues: list[list[int]], shares: list[float]) -> list[int]:
    """Merges the queues; the next entry comes from the queue that is farthest below its share."""
    taken, out = [0] * len(queues), []
    while any(len(q) > t for q, t in zip(queues, taken, strict=True)):
        open_queues = [k for k, q in enumerate(queues) if taken[k] < len(q)]
        k = min(open_queues, key=lambda k: (taken[k] + 1) / shares[k])
        out.append(int(queues[k][taken[k]]))
        taken[k] += 1
    return out


def _start(space: FreeSpace, row: _Row, rules: EpisodeRules, rng: np.random.Generator) -> np.ndarray:
    first = resample(row.path, rules.spacing)[0] - row.start
    yaw = np.arctan2(first[1], first[0]) + rng.uniform(-rules.yaw, rules.yaw)
    return np.array([*row.start, space.map.height[space.cell(row.start)], np.arctan2(np.sin(yaw), np.cos(yaw))])


def _table(space: FreeSpace, chosen: list[Any], rules: EpisodeRules) -> EpisodeTable:
    resampled = [resample(row.path, rules.spacing) for row, _, _ in chosen]
    most = max(len(w) for w in resampled)
    flat = np.stack([np.concatenate([w, np.repeat(w[-1:], most - len(w), 0)]) for w in resampled])
    waypoints = np.concatenate([flat, space.map.height[space.cell(flat)][..., None]], -1)
    return EpisodeTable(
        start=np.stack([s for _, s, _ in chosen]),
        goal=waypoints[:, -1],
        waypoints=waypoints,
        num_waypoints=np.array([len(w) for w in resampled], np.int32),
        length=np.array([path_length(r.path) for r, _, _ in chosen]),
        line_free=np.array([r.line_free for r, _, _ in chosen]),
        crosses_road=np.array([r.crosses for r, _, _ in chosen]),
        drive_time=np.array([d.seconds for _, _, d in chosen]),
    )
