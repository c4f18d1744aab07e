"""`routes.json`: one planned route per goal in the manner of CraftBench-Nav (facts/reference_systems.md b.2)."""

import dataclasses
from typing import Any

import numpy as np

from ..datatypes.ground import GROUND_KINDS, KIND_INDEX
from .geometry import EpisodeTable
from .planner import POOL, FreeSpace, GoalField, RobotSize, path_length, resample

FORMAT = 1
#: Distance (m) between waypoints of a route, and the rise (m) within one of them that counts as a kerb.
SPACING, KERB = 0.5, 0.03
#: A change of direction (rad) that counts as a turn.
TURN = np.pi / 6


def routes_json(scene_id: str, space: FreeSpace, size: RobotSize, episodes: EpisodeTable) -> dict[str, Any]:
    """Routes for the longest episode to every goal; waypoints (x, y, z, yaw) every 0.5 m."""
    goals, numbers = np.unique(episodes.goal, axis=0, return_inverse=True)
    routes = []
    for g, goal in enumerate(goals):
        rows = np.flatnonzero(numbers == g)
        row = rows[episodes.length[rows].argmax()]
        field = GoalField(space, _coarse(space, goal[:2]))
        (path,) = field.paths(_coarse(space, episodes.start[row, :2])[None])
        routes.append(_route(f"{scene_id}_{g:02d}", space, size, path))
    return {
        "format": FORMAT,
        "scene": scene_id,
        "robot": {"name": "delivery", **dataclasses.asdict(size)},
        "routes": routes,
    }


def _coarse(space: FreeSpace, xy: np.ndarray) -> np.ndarray:
    return np.floor((xy - space.map.origin) / (POOL * space.map.resolution)).astype(int)


def _route(name: str, space: FreeSpace, size: RobotSize, path: np.ndarray) -> dict[str, Any]:
    points = np.concatenate([path[:1], resample(path, SPACING)])
    steps = np.diff(points, axis=0)
    yaw = np.arctan2(steps[:, 1], steps[:, 0])
    yaw = np.append(yaw, yaw[-1])
    z = space.map.height[space.cell(points)].astype(np.float64)
    rows = np.round(np.column_stack([points, z, yaw]), 4)
    start, goal = rows[0], rows[-1]
    return {
        "id": name,
        "start": {"x": start[0], "y": start[1], "z": start[2], "yaw": start[3]},
        "via": [],
        "goal": {"x": goal[0], "y": goal[1], "z": goal[2]},
        "note": "",
        "facts": _facts(space, size, path),
        "waypoints": rows.tolist(),
    }


def _facts(space: FreeSpace, size: RobotSize, path: np.ndarray) -> dict[str, Any]:
    fine = np.concatenate([path[:1], resample(path, space.map.resolution)])
    cells = space.cell(fine)
    kind, z = space.map.kind[cells], space.map.height[cells].astype(np.float64)
    length, straight = path_length(path), float(np.linalg.norm(path[-1] - path[0]))
    share = np.bincount(kind, minlength=len(GROUND_KINDS)) / len(kind) * length
    crossing = np.concatenate([[False], kind == KIND_INDEX["crosswalk"]])
    legs = np.diff(path, axis=0)
    heading = np.unwrap(np.arctan2(legs[:, 1], legs[:, 0]))
    rise = np.diff(z)
    return {
        "length_m": round(length, 3),
        "straight_m": round(straight, 3),
        "detour": round(length / straight, 3),
        "by_kind_m": {n: round(float(s), 3) for n, s in zip(GROUND_KINDS, share, strict=True) if s > 0},
        "road_crossings": int((np.diff(crossing.astype(int)) > 0).sum()),
        "curbs": int((np.abs(rise) > KERB).sum()),
        "min_clearance_m": round(float(space.distance[cells].min()), 3),
        "turns": int((np.abs(np.diff(heading)) > TURN).sum()),
        "climb_m": round(float(rise[rise > 0].sum()), 3),
        "robot_radius_m": size.radius,
    }
