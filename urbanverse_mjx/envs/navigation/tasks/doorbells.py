"""Where doorbells and parcel boxes stand, and the episodes that lead to them: from a start a few metres away, by two
straight lines.

In:   a bank, a robot with an arm, options.
Out:  the bank with posts (`posts`) or boxes (`boxes`) and with these episodes.
When: once per bank, on the host; cached.
"""

import dataclasses
import hashlib
import json
import pathlib
from collections.abc import Sequence
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int, Int32

from .... import settings, versions
from ....datatypes import RobotSpec, SceneBank, ValidationError, array_file
from ....datatypes.ground import GROUND_KINDS
from ....geometry.grids import Grid
from ..clearance_maps import CELL, build_clearance_maps
from . import boxes
from .posts import DEPTH, HALF_SIDE, HEADINGS, Post, with_posts

#: m between the robot's origin and the button's surface from which the arm reaches it, and at which the last straight
#: line begins.
STANDOFF, APPROACH = 0.65, 1.1
#: m that the robot keeps from everything on its two lines, a post from hulls and edges, and the robot where it turns
#: from one line to the other: about its rear axle, 0.235 m behind its origin, with 0.6 m around that.
MARGIN, POST_CLEARANCE, TURN_CLEARANCE = 0.08, 0.3, 0.8
#: m, up to which a post stands from a hull or an edge: at a wall or a kerb, not in the middle of the pavement. Where
#: there is none, it stands anywhere.
BESIDE = 0.9
#: m between posts of a scene.
POST_SPACING = 3.0
#: m, largest change of the ground's height between `SPACING` m of a line, and from the post's foot to the standoff and
#: to `TURN_RADIUS` m around the approach.
STEP, SPACING, LEVEL, TURN_RADIUS = 0.02, 0.1, 0.04, 0.6
#: rad, largest angle between the robot's heading at the start and the first line, as in the bank's own episodes.
START_ANGLE = np.pi / 6
#: Places tried for the posts of a scene, starts tried for a post, and starts kept of each.
POST_TRIES, START_TRIES, STARTS = 6000, 400, 8
#: Ground for posts; not crosswalks.
_PAVEMENT = [GROUND_KINDS.index(kind) for kind in ("sidewalk", "ground")]
_TABLES = ("episode_start", "episode_goal", "episode_waypoints", "episode_num_waypoints", "episode_length")
_USED = (
    *("inst_hull", "inst_position", "inst_rotation", "hull_vertices", "prism_hull", "prism_position", "map_kind"),
    *("num_episodes",),
)


#: Largest number of posts in a scene, each of which costs slots of collision and of the image.
MOST_POSTS = 32


class Fixtures(NamedTuple):
    """What the episodes of a bank lead to, as a table on the device.

    Attributes:
      places: (Z, P, 4) f32 x, y, z (m) and yaw (rad): of the middle of each button's surface and the direction in which
        it faces, or of the middle between a box's rims and that of the side to stand at.
      nearest: (Z, E) i32, the row of the one nearest to the goal of each episode.
    """

    places: Float[Array, "Z P 4"]
    nearest: Int32[Array, "Z E"]

    @staticmethod
    def of(bank: SceneBank, name: str) -> "Fixtures":
        """Those of a bank with posts ("buttons") or parcel boxes ("boxes"), by their name in its meta."""
        listed = bank.meta[name]
        most = max(map(len, listed))
        places, nearest = np.zeros((len(listed), most, 4), np.float32), np.zeros(bank.episode_length.shape, np.int32)
        for z, own in enumerate(listed):
            if own:
                places[z] = [own[k % len(own)] for k in range(most)]
                away = np.linalg.norm(bank.episode_goal[z, :, None, :2] - places[z, None, :, :2], axis=-1)
                nearest[z] = away.argmin(1)
        return Fixtures(jnp.asarray(places), jnp.asarray(nearest))

    def of_episode(self, scene: Int[Array, ""], episode: Int[Array, ""]) -> tuple[Float[Array, "3"], Float[Array, "3"]]:
        """(3,) m, the place of an episode's, and (3,) the direction of its yaw."""
        row = self.places[scene, self.nearest[scene, episode]]
        return row[:3], jnp.stack([jnp.cos(row[3]), jnp.sin(row[3]), jnp.zeros_like(row[3])])


class Options(NamedTuple):
    """Attributes:
    posts: greatest number in a scene.
    height: m, least and greatest height of a button, or of a box's rim, above the ground.
    distance: m, least and greatest distance of a start from its post.
    """

    posts: int
    height: tuple[float, float]
    distance: tuple[float, float]


class Stand(NamedTuple):
    """What stands there.

    Attributes:
      name: in messages, and of its folder in the cache.
      half_side: m. before: m from its middle to the surface before which the robot stands.
      clearance: m that it keeps from hulls and edges.
    """

    name: str
    half_side: float
    before: float
    clearance: float


#: A post with a doorbell, and a parcel box.
DOORBELL = Stand("doorbell", HALF_SIDE, HALF_SIDE + DEPTH, POST_CLEARANCE)
BOX = Stand("parcel box", boxes.HALF_SIDE, boxes.HALF_SIDE, POST_CLEARANCE + boxes.HALF_SIDE - HALF_SIDE)


def checked_options(options: Any, lowest: float, highest: float) -> Options:
    """The options of `config.task` with heights from lowest to highest (m).

    Raises:
      ValidationError: a value is out of its range.
    """
    if not 1 <= options.posts <= MOST_POSTS:
        raise ValidationError(f"config.task.posts: found {options.posts}, needed 1 to {MOST_POSTS} in a scene.")
    low, high = (float(x) for x in options.height)
    if not lowest <= low <= high <= highest:
        raise ValidationError(
            f"config.task.height: found {low:g} to {high:g} m, "
            f"needed least <= greatest between {lowest:g} and {highest:g}."
        )
    near, far = (float(x) for x in options.distance)
    if not APPROACH <= near < far:
        raise ValidationError(
            f"config.task.distance: found {near:g} to {far:g} m, needed {APPROACH:g} <= least < greatest."
        )
    return Options(int(options.posts), (low, high), (near, far))


def with_doorbells(bank: SceneBank, scenes: Sequence[int], robot: RobotSpec, options: Options) -> SceneBank:
    """The bank with posts and their episodes in some scenes; other scenes, and those without space for a post, stay
    as they are.

    Raises:
      ValidationError: no scene has space for a post.
    """
    return with_posts(*_furnished(bank, scenes, robot, options, DOORBELL))


def with_parcel_boxes(bank: SceneBank, scenes: Sequence[int], robot: RobotSpec, options: Options) -> SceneBank:
    """The same with parcel boxes.

    Raises:
      ValidationError: see `with_doorbells`.
    """
    return boxes.with_boxes(*_furnished(bank, scenes, robot, options, BOX))


def _furnished(
    bank: SceneBank, scenes: Sequence[int], robot: RobotSpec, options: Options, stand: Stand
) -> tuple[SceneBank, dict[int, list[Post]]]:
    """The bank with the episodes, and the posts of each scene that has some."""
    path = _path_of(bank, scenes, robot, options, stand)
    names = ("posts", "start", "of")
    arrays = array_file.load_cached(path, "doorbells", names)
    if arrays is None:
        arrays = _build(bank, scenes, robot, options, stand)
        array_file.save_cached(path, arrays)
    posts = {int(z): [Post(tuple(p), h, b) for p, h, b in own] for z, own in json.loads(arrays["posts"].tobytes())}
    if not posts:
        raise ValidationError(
            f"config.scenes: found no space for a {stand.name} in {len(scenes)} scenes, needed a post on "
            f"a pavement and {options.distance[0]:g} m of level ground before it; take other scenes or distances."
        )
    return _with_rows(bank, posts, arrays["start"], arrays["of"], stand), posts


def _path_of(bank: SceneBank, scenes: Sequence[int], robot: RobotSpec, options: Options, stand: Stand) -> pathlib.Path:
    told = (versions.of("doorbells"), [int(z) for z in scenes], robot.planner_radius, robot.planner_height, options)
    told = (*told, bank.scene_ids, *(stand if stand != DOORBELL else ()))
    key = array_file.key_of(told, {name: getattr(bank, name) for name in _USED})
    return settings.cache_dir("doorbells" if stand == DOORBELL else "parcel_boxes", f"{key}.npz")


def _build(
    bank: SceneBank, scenes: Sequence[int], robot: RobotSpec, options: Options, stand: Stand
) -> dict[str, np.ndarray]:
    """posts: JSON of (scene, (place, heading, button) of each); start (S, 4) x, y, z, yaw; of (S, 2) i32, scene and
    post of each start."""
    maps = build_clearance_maps(bank, scenes, robot.planner_height)
    found, starts, of = [], [], []
    for scene in scenes:
        clear = np.minimum(maps.to_hull[scene], maps.to_edge[scene]).astype(np.float32)
        name = hashlib.sha256(bank.scene_ids[scene].encode()).digest()
        side = round(float(bank.map_resolution) / CELL)
        pavement = np.kron(np.isin(bank.map_kind[scene], _PAVEMENT), np.ones((side, side), bool))
        street = _Street(maps.origin[scene], clear, maps.ground[scene], pavement, robot.planner_radius, stand)
        own, rows = street.furnish(options, np.random.default_rng(np.frombuffer(name, np.uint32)))
        if own:
            found.append((int(scene), own))
        starts += [row for row, _ in rows]
        of += [(int(scene), number) for _, number in rows]
    encoded = np.frombuffer(json.dumps(found).encode(), np.uint8)
    return {"posts": encoded, "start": np.array(starts).reshape(-1, 4), "of": np.array(of, np.int32).reshape(-1, 2)}


def _directed(yaw: np.ndarray) -> np.ndarray:
    return np.stack([np.cos(yaw), np.sin(yaw)], -1)


class _Street:
    """The free ground of a scene.

    Args:
      origin: (2,) m. clear: (X, Y) m, distance to hulls and edges, ground: (X, Y) m, height, pavement: (X, Y) bool,
        where a post may stand, in cells of `CELL`.
      radius: m, of the robot.
      stand: what is to stand there.
    """

    def __init__(
        self,
        origin: np.ndarray,
        clear: np.ndarray,
        ground: np.ndarray,
        pavement: np.ndarray,
        radius: float,
        stand: Stand = DOORBELL,
    ) -> None:
        self.grid = Grid(np.asarray(origin, np.float64), CELL, clear.shape)
        self.clear, self.ground, self.pavement, self.radius, self.post = clear, ground, pavement, radius, stand

    def passable(self, start: np.ndarray, end: np.ndarray) -> np.ndarray:
        """(n,) bool, whether the robot drives straight from points (n, 2) m to others with `MARGIN` to everything and
        without a step."""
        # All lines get as many points as the longest, so that a line of a share s of its length passes slopes of
        # STEP / SPACING / s in place of STEP / SPACING. Points of its own for each line would draw other episodes.
        longest = np.linalg.norm(end - start, axis=1).max(initial=0.0)
        share = np.linspace(0.0, 1.0, max(int(longest / SPACING), 1) + 1)[:, None, None]
        line = start + share * (end - start)
        free = (self.grid.at(self.clear, line) > self.radius + MARGIN).all(0)
        return free & (np.abs(np.diff(self.grid.at(self.ground, line), axis=0)) < STEP).all(0)

    def furnish(
        self, options: Options, rng: np.random.Generator
    ) -> tuple[list[tuple[list[float], int, float]], list[tuple[list[float], int]]]:
        """Posts (place, heading, height of the button), and starts (x, y, z, yaw) with the number of their post."""
        cells = np.argwhere((self.clear > self.post.clearance) & self.pavement)
        if not len(cells):
            return [], []
        places = self.grid.centres(cells[rng.integers(len(cells), size=POST_TRIES)])
        heading = rng.integers(HEADINGS, size=POST_TRIES)
        out = _directed(2.0 * np.pi * heading / HEADINGS)
        before = self.post.before
        stand, approach = places + (before + STANDOFF) * out, places + (before + APPROACH) * out
        height = self.grid.at(self.ground, places)
        # A robot that turns on a slope slides off its line.
        ring = TURN_RADIUS * _directed(np.arange(8) * np.pi / 4)
        near = np.concatenate([stand[None], approach[None], approach + ring[:, None]])
        level = (np.abs(self.grid.at(self.ground, near) - height) < LEVEL).all(0)
        turns = self.grid.at(self.clear, approach) > TURN_CLEARANCE
        paved = self.grid.at(self.pavement, stand) & self.grid.at(self.pavement, approach)
        free = np.flatnonzero(level & turns & paved & self.passable(approach, stand))
        # Those at walls and kerbs first.
        free = free[np.argsort(self.grid.at(self.clear, places[free]) > BESIDE, kind="stable")]
        chosen: list[int] = []
        for i in free:
            if len(chosen) == options.posts:
                break
            if all(np.linalg.norm(places[i] - places[j]) >= POST_SPACING for j in chosen):
                chosen.append(int(i))
        rows, kept = [], []
        for i in chosen:
            others = places[[j for j in chosen if j != i]]
            own = self._starts(places[i], stand[i], approach[i], others, options.distance, rng)
            if len(own):
                rows += [(row, len(kept)) for row in own.tolist()]
                kept.append(i)
        button = rng.uniform(*options.height, size=POST_TRIES)
        # Heights are above the ground on which the robot stands.
        told = button + self.grid.at(self.ground, stand) - height
        posts = [([*places[i].tolist(), float(height[i])], int(heading[i]), float(told[i])) for i in kept]
        return posts, rows

    def _starts(
        self,
        place: np.ndarray,
        stand: np.ndarray,
        approach: np.ndarray,
        others: np.ndarray,
        distance: tuple[float, float],
        rng: np.random.Generator,
    ) -> np.ndarray:
        """(n, 4) up to `STARTS` starts x, y, z, yaw from which the robot drives straight to the approach of a post,
        past other posts (m, 2)."""
        away = rng.uniform(*distance, START_TRIES)
        points = place + away[:, None] * _directed(rng.uniform(-np.pi, np.pi, START_TRIES))
        ends = np.broadcast_to(approach, points.shape)
        free = self.passable(points, ends) & (self.grid.at(self.clear, points) > self.radius + 2.0 * MARGIN)
        # Its own post and the others, which the maps do not have.
        for post in [place, *others]:
            free &= _apart(points, ends, post) > self.radius + self.post.half_side + MARGIN
        if any(
            _apart(approach[None], stand[None], post)[0] <= self.radius + self.post.half_side + MARGIN
            for post in others
        ):
            return np.zeros((0, 4))
        points = points[np.flatnonzero(free)[:STARTS]]
        line = approach - points
        yaw = np.arctan2(line[:, 1], line[:, 0]) + rng.uniform(-START_ANGLE, START_ANGLE, len(points))
        return np.column_stack([points, self.grid.at(self.ground, points), yaw])


def _apart(start: np.ndarray, end: np.ndarray, point: np.ndarray) -> np.ndarray:
    """(n,) m from a point (2,) to segments (n, 2), (n, 2)."""
    span = end - start
    share = np.clip(((point - start) * span).sum(1) / np.maximum((span**2).sum(1), 1e-12), 0.0, 1.0)
    return np.linalg.norm(start + share[:, None] * span - point, axis=1)


def _with_rows(
    bank: SceneBank, posts: dict[int, list[Post]], start: np.ndarray, of: np.ndarray, stand: Stand
) -> SceneBank:
    """The bank with the episodes of the posts in place of its own, in scenes that have posts."""
    tables = {name: np.array(getattr(bank, name)) for name in _TABLES}
    number = np.array(bank.num_episodes)
    for scene, own in posts.items():
        rows = np.flatnonzero(of[:, 0] == scene)[: len(tables["episode_length"][scene])]
        number[scene] = len(rows)
        for row in range(len(tables["episode_length"][scene])):
            at = rows[row % len(rows)]
            post, begin = own[of[at, 1]], start[at]
            ahead = stand.before + np.array([APPROACH, STANDOFF])
            points = np.array(post.place)[:2] + ahead[:, None] * _directed(np.array(post.yaw))
            # Level ground: that of the start serves all, as it does for other episodes' waypoints.
            places = np.column_stack([points, np.full(2, begin[2])])
            width = tables["episode_waypoints"].shape[2]
            tables["episode_start"][scene, row] = begin
            tables["episode_goal"][scene, row] = places[1]
            tables["episode_waypoints"][scene, row] = places[np.minimum(np.arange(width), 1)]
            tables["episode_num_waypoints"][scene, row] = 2
            line = np.concatenate([begin[None, :2], points])
            tables["episode_length"][scene, row] = np.linalg.norm(np.diff(line, axis=0), axis=1).sum()
    return dataclasses.replace(bank, num_episodes=number, **tables)
