"""How far a robot can go along arcs before it touches an object: an observation for privileged teachers.

In:   a bank, and discs of a robot's footprint; per env its scene and pose. Out: free shares and margins of `ARCS`
motions. When: the field once per bank, on the host, cached; the look-ups in every control step, inside jit.

The distances of `privileged` and `privileged_map` are those of `surroundings`: to the boxes of hulls, in cells of
0.2 m, at 15 points and at points 0.4 m apart. They do not show whether a robot fits through a gap that is 10 cm wider
than itself on each side, as gaps on the routes of `FollowRoute` are. These are measured as the planner measures: discs
of the footprint in a field of distances to the hulls' outlines, in cells of 5 cm. Where there is a crowd the same is
told of its agents, as they are when the robot gets there.
"""

import itertools
import pathlib
from collections.abc import Callable

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int, UInt8

from ... import settings, versions
from ...datatypes import SceneBank, array_file
from ...geometry.grids import cell_of
from .clearance_maps import CELL, build_clearance_maps

#: 1/m, curvatures of the arcs, left turns positive.
CURVATURES = (-2.5, -1.2, -0.6, -0.25, 0.0, 0.25, 0.6, 1.2, 2.5)
#: Number of motions: the arcs, and a quarter turn on the spot to the right and to the left.
ARCS = len(CURVATURES) + 2
#: Poses that are checked on each, and m between them on an arc.
POSES, STEP = 12, 0.15
#: Poses of which the margin is told, from the first one on.
NEAR = 6
#: m, largest margin that is told, on both sides of 0.
MARGIN = 0.4
#: m along each arc, and rad of a turn on the spot, of each pose.
_ALONG, _TURN = STEP * np.arange(1, POSES + 1), np.linspace(0.0, np.pi / 2.0, POSES + 1)[1:]
#: m/s and rad/s at which the robot is taken to go along them, among agents that move.
SPEED, TURN_RATE = 1.0, 1.0
#: m, range of distances of the field, which a byte spans: 0.5 cm a unit.
LEAST, MOST = -0.25, 1.0
#: Largest number of scenes whose field is made at a time.
_TOGETHER = 8
#: Arrays of a bank on which the field depends.
_READ = ("inst_hull", "inst_position", "inst_rotation", "hull_box", "map_kind", "map_origin")


def arc_poses() -> Float[np.ndarray, "ARCS POSES 3"]:
    """(ARCS, POSES, 3) x, y (m) and yaw (rad) in the heading frame, along the motions."""
    poses = []
    for curvature in CURVATURES:
        angle = curvature * _ALONG
        # sin(a) / k and (1 - cos(a)) / k, which are s and 0 where k is 0.
        ahead, aside = _ALONG * np.sinc(angle / np.pi), _ALONG * np.sin(angle / 2.0) * np.sinc(angle / (2.0 * np.pi))
        poses.append(np.stack([ahead, aside, angle], -1))
    for side in (-1.0, 1.0):
        angle = side * _TURN
        poses.append(np.stack([0.0 * angle, 0.0 * angle, angle], -1))
    return np.stack(poses)


def arc_times() -> Float[np.ndarray, "ARCS POSES"]:
    """(ARCS, POSES) s until the poses of `arc_poses`, at `SPEED` and `TURN_RATE`."""
    return np.stack([_ALONG / SPEED] * len(CURVATURES) + [_TURN / TURN_RATE] * (ARCS - len(CURVATURES)))


#: Function (points (..., 2) m, s from now (...)) -> (..., A) m to the bodies of agents that go on as they do.
Gaps = Callable[[Float[Array, "*n 2"], Float[Array, "*n"]], Float[Array, "*n A"]]


def build_field(bank: SceneBank, height: float) -> UInt8[np.ndarray, "Z X Y"]:
    """(Z, X, Y) u8, distances from the centres of cells of `CELL` to the outlines of hulls that a robot of `height` m
    does not pass, `LEAST` to `MOST`."""
    rows: list[np.ndarray] = []
    # As many scenes at a time as there are threads: the maps of a scene of 200 m take 1 GB while they are made.
    for some in itertools.batched(range(bank.num_scenes), min(settings.num_threads(), _TOGETHER)):
        metres = build_clearance_maps(bank, some, height).to_hull[list(some)].astype(np.float32)
        rows.append(np.rint((np.clip(metres, LEAST, MOST) - LEAST) * (255.0 / (MOST - LEAST))).astype(np.uint8))
    return np.concatenate(rows)


def path_of(bank: SceneBank, height: float) -> pathlib.Path:
    """The file in the cache of a bank's field for robots of a height (m)."""
    parts = (versions.of("clear_arcs"), CELL, LEAST, MOST, height, float(bank.map_resolution))
    key = array_file.key_of(parts, {name: getattr(bank, name) for name in _READ})
    return settings.cache_dir("clear_arcs", f"{key}.npz")


def kept_field(bank: SceneBank, height: float) -> UInt8[np.ndarray, "Z X Y"]:
    """`build_field` with a cache: a scene takes seconds."""
    path = path_of(bank, height)
    found = array_file.load_cached(path, "distances to outlines", ("field",))
    if found is None:
        found = {"field": build_field(bank, height)}
        array_file.save_cached(path, found)
    return found["field"]


class ClearArcs:
    """The motions of a robot that are free of objects, in all scenes of a bank.

    Args:
      bank: the scenes.
      discs: (D, 3) x, y, radius (m) of the robot's `Footprint`.
      height: m, of the robot; higher hulls are no obstacles.
    """

    def __init__(self, bank: SceneBank, discs: Float[np.ndarray, "D 3"], height: float) -> None:
        self._field = jnp.asarray(kept_field(bank, height))
        self._origin = jnp.asarray(bank.map_origin, jnp.float32)
        poses = arc_poses()
        c, s = np.cos(poses[..., 2, None]), np.sin(poses[..., 2, None])
        x = poses[..., 0, None] + c * discs[:, 0] - s * discs[:, 1]
        y = poses[..., 1, None] + s * discs[:, 0] + c * discs[:, 1]
        self._points = jnp.asarray(np.stack([x, y], -1), jnp.float32)
        self._radii = jnp.asarray(discs[:, 2], jnp.float32)
        self._times = jnp.asarray(arc_times(), jnp.float32)

    def margins(
        self, scene: Int[Array, ""] | int, p_xy: Float[Array, "2"], yaw: Float[Array, ""]
    ) -> Float[Array, "ARCS POSES"]:
        """(ARCS, POSES) m between the robot and the nearest object at each pose of each motion, negative in it, at most
        `MOST`; an error of 3 cm by the size of cells.

        Args:
          scene: () i32.
          p_xy: (2,) m in the world's frame. yaw: () rad.
        """
        cell = cell_of(self._places(p_xy, yaw), self._origin[scene], CELL, self._field.shape[1:])
        found = self._field[scene, cell[..., 0], cell[..., 1]]
        metres = LEAST + found.astype(jnp.float32) * ((MOST - LEAST) / 255.0)
        return (metres - self._radii).min(-1)

    def margins_to_agents(
        self, gaps: Gaps, p_xy: Float[Array, "2"], yaw: Float[Array, ""]
    ) -> Float[Array, "ARCS POSES"]:
        """(ARCS, POSES) m between the robot and the nearest agent when it is at each pose of each motion; infinite
        without agents. For arguments see `margins` and `Gaps`."""
        places = self._places(p_xy, yaw)
        times = jnp.broadcast_to(self._times[..., None], places.shape[:-1])
        return (gaps(places, times).min(-1) - self._radii).min(-1)

    def observe(
        self, scene: Int[Array, ""] | int, p_xy: Float[Array, "2"], yaw: Float[Array, ""], gaps: Gaps | None = None
    ) -> Float[Array, " n"]:
        """(2 ARCS,) f32: the share of each motion that is free from its beginning, and the least margin at its first
        `NEAR` poses in units of `MARGIN`, -1 to 1; with `gaps` as many that are free of agents."""
        found = _told(self.margins(scene, p_xy, yaw))
        return found if gaps is None else jnp.concatenate([found, _told(self.margins_to_agents(gaps, p_xy, yaw))])

    def _places(self, p_xy: Float[Array, "2"], yaw: Float[Array, ""]) -> Float[Array, "ARCS POSES D 2"]:
        """(ARCS, POSES, D, 2) m, centres of the discs in the world's frame."""
        c, s = jnp.cos(yaw), jnp.sin(yaw)
        x, y = self._points[..., 0], self._points[..., 1]
        return p_xy + jnp.stack([c * x - s * y, s * x + c * y], -1)


def _told(margins: Float[Array, "ARCS POSES"]) -> Float[Array, " n"]:
    free = jnp.cumprod((margins > 0.0).astype(jnp.float32), axis=-1).mean(-1)
    near = jnp.clip(margins[:, :NEAR].min(-1) / MARGIN, -1.0, 1.0)
    return jnp.concatenate([free, near])
