"""Episodes that ask for a named object: from the starts of a bank's episodes, with the shortest path to the nearest
place from which the object is within reach.

In:   a bank, a robot, the range of path lengths.
Out:  the bank with these episodes, and what each of them asks for.
When: once per bank, on the host; cached.
"""

import collections
import dataclasses
import hashlib
import json
import pathlib
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from .... import settings, versions
from ....crowds import free_space
from ....datatypes import RobotSpec, SceneBank, ValidationError, array_file
from ....geometry.geodesics import GridGraph
from ....geometry.grids import Grid, pooled
from ....geometry.polylines import arc_lengths, points_at
from ..clearance_maps import CELL, build_clearance_maps
from ..surroundings import kept_fields
from . import object_names
from .object_names import MOST_MEANT, StreetObject

#: Cells of the clearance maps along a side of a node, and m between nodes.
POOL = 4
NODE = POOL * CELL
#: m, additional clearance around the robot on the path.
MARGIN = 0.1
#: m by which the path goes on within the distance of success.
INSIDE = 0.15
#: m between waypoints, as in the bank's episodes.
SPACING = 5.0
#: m above ground between which a hull hides an object from a camera at 0.6 m.
HIDING = (0.45, 0.75)
#: m before an object at which the line of sight to it ends, because its own hulls begin there.
BEFORE = 0.3
#: Number of points at which a line of sight is checked.
POINTS = 24
_TABLES = ("episode_start", "episode_goal", "episode_waypoints", "episode_num_waypoints", "episode_length")
_USED = (
    *("inst_hull", "inst_position", "inst_rotation", "hull_vertices", "prism_hull", "prism_position", "map_kind"),
    *("slot_mesh", "slot_position", "slot_quaternion", "slot_category", "mesh_vertices", "mesh_faces", "mesh_uv"),
    *("mesh_material", "material_texture", "material_rgba", "texture_data", *_TABLES[:4], "num_episodes"),
)


class ObjectGoals(NamedTuple):
    """What the episodes ask for.

    Attributes:
      texts: phrases of all scenes, see `object_names`.
      which: (Z, E) i32, phrase of each episode.
      source: (Z, E) i32, row of the bank's own table from which an episode has its start.
      routes: (Z, E, W, 3) m, waypoints of the bank's own table.
      boxes: (T, I, 5) f32, boxes of the objects that each phrase means, see `StreetObject.box`.
      count: (T,) i32, number of these objects.
    """

    texts: tuple[str, ...]
    which: np.ndarray
    source: np.ndarray
    routes: np.ndarray
    boxes: np.ndarray
    count: np.ndarray

    def vectors(self) -> np.ndarray:
        """(T, EMBEDDING_SIZE) f32, vectors of the phrases."""
        return np.stack([object_names.embedding(text) for text in self.texts])


def to_boxes(xp: Any, p_xy: Any, boxes: Any) -> tuple[Any, Any]:
    """Distances (..., I) m of points (..., 2) to boxes (I, 5) on the ground, and the nearest points (..., I, 2) m.

    Args:
      xp: numpy or jax.numpy.
    """
    c, s = xp.cos(boxes[:, 4]), xp.sin(boxes[:, 4])
    away = p_xy[..., None, :] - boxes[:, :2]
    local = xp.stack([c * away[..., 0] + s * away[..., 1], c * away[..., 1] - s * away[..., 0]], -1)
    inside = xp.clip(local, -boxes[:, 2:4], boxes[:, 2:4])
    x, y = inside[..., 0], inside[..., 1]
    nearest = boxes[:, :2] + xp.stack([c * x - s * y, s * x + c * y], -1)
    return xp.sqrt(((p_xy[..., None, :] - nearest) ** 2).sum(-1) + 1e-12), nearest


def sight_points(xp: Any, p_xy: Any, nearest: Any, distance: Any) -> Any:
    """(POINTS, ..., 2) m, points of the lines of sight from p_xy (..., 1, 2) up to `BEFORE` an object."""
    share = xp.maximum(distance - BEFORE, 0.0) / xp.maximum(distance, 1e-6)
    along = np.linspace(0.0, 1.0, POINTS).reshape(-1, *([1] * (nearest.ndim))) * share[..., None]
    return p_xy + along * (nearest - p_xy)


def with_object_episodes(
    bank: SceneBank, scenes: Sequence[int], robot: RobotSpec, reach: float, lengths: tuple[float, float]
) -> tuple[SceneBank, ObjectGoals]:
    """The bank with episodes for objects in some scenes; other scenes keep theirs.

    Args:
      reach: m between the robot's centre and an object within which it is found.
      lengths: m, least and greatest length of the path.

    Raises:
      ValidationError: no object of a scene can be reached by a path of such a length.
    """
    path = _path_of(bank, scenes, robot, reach, lengths)
    names = (*_TABLES, "texts", "which", "source", "boxes", "count")
    arrays = array_file.load_cached(path, "episodes for objects", names)
    if arrays is None:
        arrays = _build(bank, scenes, robot, reach, lengths)
        array_file.save_cached(path, arrays)
    texts = tuple(json.loads(arrays["texts"].tobytes()))
    which, source, boxes, count = (arrays[k] for k in names[-4:])
    goals = ObjectGoals(texts, which, source, bank.episode_waypoints, boxes, count)
    return dataclasses.replace(bank, **{name: arrays[name] for name in _TABLES}), goals


def _path_of(
    bank: SceneBank, scenes: Sequence[int], robot: RobotSpec, reach: float, lengths: tuple[float, float]
) -> pathlib.Path:
    parts = (versions.of("object_goals"), [int(z) for z in scenes], robot.planner_radius, robot.planner_height)
    told = (*parts, reach, lengths, bank.meta["categories"], bank.scene_ids)
    key = array_file.key_of(told, {name: getattr(bank, name) for name in _USED})
    return settings.cache_dir("object_goals", f"{key}.npz")


def _build(
    bank: SceneBank, scenes: Sequence[int], robot: RobotSpec, reach: float, lengths: tuple[float, float]
) -> dict[str, np.ndarray]:
    maps = build_clearance_maps(bank, scenes, robot.planner_height)
    hulls = kept_fields(bank, HIDING[1], HIDING[0])
    tables = {name: np.array(getattr(bank, name)) for name in _TABLES}
    most = int(np.ceil(lengths[1] / SPACING)) + 1
    before = tables["episode_waypoints"]
    width = max(before.shape[2], most)
    tables["episode_waypoints"] = np.concatenate(
        [before, np.repeat(before[:, :, -1:], width - before.shape[2], axis=2)], axis=2
    )
    which, source = np.zeros(bank.episode_length.shape, np.int32), np.zeros(bank.episode_length.shape, np.int32)
    source[:] = np.arange(source.shape[1])
    texts: list[str] = []
    boxes: list[np.ndarray] = []
    for scene in scenes:
        clear = np.minimum(maps.to_hull[scene], maps.to_edge[scene]).astype(np.float32)
        own = _Scene(bank, scene, pooled(clear, POOL, np.mean), hulls[scene, ..., 0], robot)
        own.find(reach, lengths[1])
        own.fill(tables, which, source, lengths, len(texts))
        texts += [p.text for p in own.phrases]
        boxes += [np.array([own.objects[i].box for i in p.meant], np.float32) for p in own.phrases]
    count = np.array([len(x) for x in boxes], np.int32)
    padded = np.stack([np.concatenate([x, np.repeat(x[:1], MOST_MEANT - len(x), axis=0)]) for x in boxes])
    encoded = np.frombuffer(json.dumps(texts).encode(), np.uint8)
    return {**tables, "texts": encoded, "which": which, "source": source, "boxes": padded, "count": count}


class _Scene:
    """Paths to the objects of one scene.

    Args:
      clear: (X, Y) m, distances to hulls and edges at the nodes.
      hulls: (X, Y) u8 cm, distances to hulls that hide objects.
    """

    def __init__(self, bank: SceneBank, scene: int, clear: np.ndarray, hulls: np.ndarray, robot: RobotSpec) -> None:
        self.bank, self.scene, self.hulls = bank, scene, hulls
        self.rows = int(bank.num_episodes[scene])
        self.grid = Grid(np.asarray(bank.map_origin[scene], np.float64), NODE, clear.shape)
        passable = clear >= robot.planner_radius + MARGIN
        self.graph = GridGraph(passable, lambda step, a, b: np.full(len(a[0]), NODE * np.hypot(*step)))
        self.centres = self.grid.centres(self.graph.cells)
        starts = self.grid.cell(bank.episode_start[scene, : self.rows, :2])
        self.nodes = self.graph.number[starts[:, 0], starts[:, 1]]
        pavement = float(np.median(bank.episode_start[scene, : self.rows, 2]))
        self.height = free_space.ground_height(bank, scene, self.grid)
        self.objects: list[StreetObject] = object_names.objects_of(bank, scene, pavement)
        self.phrases = object_names.phrases_of(self.objects)

    def find(self, reach: float, limit: float) -> None:
        """Computes the path lengths from all starts to all phrases, and the next node on the way."""
        zones = [self._zone(o, reach) for o in self.objects]
        kept, self.lengths, self.following = [], [], []
        for phrase in self.phrases:
            ends = np.unique(np.concatenate([zones[i] for i in phrase.meant]))
            if not len(ends) or not all(len(zones[i]) for i in phrase.meant):
                continue  # a phrase of which some objects cannot be reached asks for too much luck
            cost, following = self.graph.to_goals(ends, limit)
            kept.append(phrase)
            self.lengths.append(np.where(self.nodes >= 0, cost[self.nodes], np.inf))
            self.following.append(following)
        self.phrases = kept

    def _zone(self, o: StreetObject, reach: float) -> np.ndarray:
        """Nodes from which an object is within reach and in sight."""
        far = np.hypot(*o.box[2:4]) + reach
        near = np.flatnonzero((np.abs(self.centres - np.array(o.box[:2])) <= far).all(1))
        points = self.centres[near]
        distance, nearest = to_boxes(np, points, np.array([o.box]))
        line = sight_points(np, points[:, None], nearest, distance)[:, :, 0]
        cells = np.floor((line - self.grid.origin) / NODE).astype(int)
        cells = np.clip(cells, 0, np.array(self.hulls.shape) - 1)
        free = (self.hulls[cells[..., 0], cells[..., 1]] > 0).all(0)
        return near[(distance[:, 0] <= reach - INSIDE) & free]

    def fill(
        self,
        tables: dict[str, np.ndarray],
        which: np.ndarray,
        source: np.ndarray,
        lengths: tuple[float, float],
        first: int,
    ) -> None:
        """Writes the scene's rows; `first` is the number of its first phrase."""
        name, scene = self.bank.scene_ids[self.scene], self.scene
        asks = self._choices(lengths, name)
        rows = sorted(asks)
        if not rows:
            raise ValidationError(
                f"scene {name!r}: found no object at the end of a path of {lengths[0]:g} to {lengths[1]:g} m, needed "
                "one; widen config.task.path_length, or take other scenes."
            )
        for row in range(self.rows):
            taken = row if row in asks else rows[row % len(rows)]
            self._write(tables, row, taken, asks[taken])
            which[scene, row], source[scene, row] = first + asks[taken], taken
        which[scene, self.rows :] = which[scene, 0]

    def _choices(self, lengths: tuple[float, float], name: str) -> dict[int, int]:
        """Row -> phrase, for the rows from whose start one is at the right distance: classes are equally likely, and
        so are the phrases of a class."""
        table = np.array(self.lengths).reshape(len(self.phrases), self.rows)
        right = (table >= lengths[0]) & (table <= lengths[1])
        rng = np.random.default_rng(np.frombuffer(hashlib.sha256(name.encode()).digest(), np.uint32))
        asks = {}
        for row in np.flatnonzero(right.any(0)).tolist():
            by_class: dict[str, list[int]] = collections.defaultdict(list)
            for k in np.flatnonzero(right[:, row]).tolist():
                by_class[self.phrases[k].name].append(k)
            chosen = by_class[sorted(by_class)[rng.integers(len(by_class))]]
            asks[row] = chosen[rng.integers(len(chosen))]
        return asks

    def _write(self, tables: dict[str, np.ndarray], row: int, taken: int, phrase: int) -> None:
        scene, start = self.scene, self.bank.episode_start[self.scene, taken]
        nodes = self.graph.path(self.following[phrase], int(self.nodes[taken]))[1:]
        line = np.concatenate([start[None, :2].astype(np.float64), self.centres[nodes]])
        points = _spaced(line)
        z = self.grid.at(self.height, points)
        waypoints = np.column_stack([points, z]).astype(np.float32)
        width = tables["episode_waypoints"].shape[2]
        tables["episode_start"][scene, row] = start
        tables["episode_goal"][scene, row] = waypoints[-1]
        tables["episode_waypoints"][scene, row] = waypoints[np.minimum(np.arange(width), len(waypoints) - 1)]
        tables["episode_num_waypoints"][scene, row] = len(waypoints)
        tables["episode_length"][scene, row] = np.linalg.norm(np.diff(line, axis=0), axis=1).sum()


def _spaced(line: np.ndarray) -> np.ndarray:
    """(n, 2) m: points every `SPACING` m along a line of corners (m, 2) after its first, and its end."""
    lengths = arc_lengths(line)
    places = np.append(np.arange(SPACING, lengths[-1] - 0.5 * SPACING, SPACING), lengths[-1])
    return points_at(line, lengths, places)
