"""Distances from any point of a scene to the nearest object and to the edge of the walkable ground.

They are used by critics and rewards, not by policies, and looked up in a grid made once per bank.
"""

import functools
import hashlib
import pathlib
from collections.abc import Iterator

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int, UInt8
from scipy import ndimage

from ... import settings, versions
from ...datatypes import SceneBank, array_file, traversable
from ...geometry.grids import Grid, cell_of, pooled
from ...geometry.raster import Shape, nearest

#: m, side of a cell; the error of a look-up is half of it, a tenth of COCO's length.
CELL = 0.2
#: Number of hulls from which the fields of a bank, which take seconds, are cached.
MIN_CACHED_HULLS = 20_000
#: m, largest stored distance: the maximum of an unsigned byte in centimetres.
MAX_DISTANCE = 2.55


def _to_edge(bank: SceneBank, scene: int, shape: tuple[int, int]) -> np.ndarray:
    """(X, Y) m from each cell to the nearest one that is not completely walkable; 0 there."""
    walkable = traversable(bank.map_kind[scene])
    factor = round(CELL / float(bank.map_resolution))
    missing = [(0, n * factor - m) for n, m in zip(shape, walkable.shape, strict=True)]
    whole = pooled(np.pad(walkable, missing), factor, np.all)
    return ndimage.distance_transform_edt(np.pad(whole, 1))[1:-1, 1:-1] * CELL


def _boxes(bank: SceneBank, scene: int, height: float) -> Iterator[Shape]:
    """The boxes of the hulls that extend between `MIN_OBSTACLE_HEIGHT` and `height` m above ground."""
    ground = _ground_height(bank, scene)
    bottom, top = ground + MIN_OBSTACLE_HEIGHT, ground + height
    for q in np.flatnonzero(bank.inst_hull[scene] >= 0):
        rotation, position = bank.inst_rotation[scene, q], bank.inst_position[scene, q]
        box = bank.hull_box[bank.inst_hull[scene, q]]
        middle, reach = position + rotation @ box[0], np.abs(rotation) @ box[1]
        if middle[2] - reach[2] > top or middle[2] + reach[2] < bottom:
            continue
        # At the height at which the robot is nearest to the box's centre.
        z = np.clip(middle[2], bottom, top) - position[2]
        low, high = middle[:2] - reach[:2], middle[:2] + reach[:2]
        yield low, high, functools.partial(_to_box, rotation, position, box, z)


def _to_box(
    rotation: np.ndarray, position: np.ndarray, box: np.ndarray, z: float | np.floating, x: np.ndarray, y: np.ndarray
) -> np.ndarray:
    """(X, Y) m from the points of a grid, `z` above the hull's origin, to the hull's box (2, 3)."""
    centre, half = box
    # In the hull's frame, one axis at a time: a column of x, a row of y.
    along = np.outer(rotation[0], x - position[0]) - centre[:, None]
    across = np.outer(rotation[1], y - position[1]) + (rotation[2] * z)[:, None]
    square = 0.0
    for a, b, h in zip(along, across, half, strict=True):
        outside = np.maximum(np.abs(a[:, None] + b) - h, 0.0)
        square = square + outside * outside
    return np.sqrt(square)


def _ground_height(bank: SceneBank, scene: int) -> float:
    """m, ground height at the starts of the scene's episodes, which is that of the pavement nearly everywhere."""
    return float(np.median(bank.episode_start[scene, : int(bank.num_episodes[scene]), 2]))


#: m; hulls below this height above the pavement are ignored, because wheels pass over them.
MIN_OBSTACLE_HEIGHT = 0.05


def build_fields(bank: SceneBank, height: float) -> UInt8[np.ndarray, "Z X Y 2"]:
    """(Z, X, Y, 2) u8 cm, distances to the nearest hull between `MIN_OBSTACLE_HEIGHT` and `height` m above ground, and
    to the walkable edge."""
    size = np.array(bank.map_kind.shape[1:]) * float(bank.map_resolution)
    x, y = (int(n) for n in np.ceil(size / CELL - 1e-6))
    fields = np.zeros((bank.num_scenes, x, y, 2), np.uint8)
    for scene in range(bank.num_scenes):
        hulls = nearest(Grid(bank.map_origin[scene], CELL, (x, y)), _boxes(bank, scene, height), MAX_DISTANCE)
        metres = np.stack([hulls, _to_edge(bank, scene, (x, y))], -1)
        fields[scene] = np.rint(np.minimum(metres, MAX_DISTANCE) * 100.0)
    return fields


def path_of(bank: SceneBank, height: float) -> pathlib.Path:
    """The file in the cache of a bank's fields for a robot of some height (m)."""
    parts = (versions.of("surroundings"), CELL, MAX_DISTANCE, MIN_OBSTACLE_HEIGHT, height, float(bank.map_resolution))
    digest = hashlib.sha256(repr(parts).encode())
    for name in ("inst_hull", "inst_position", "inst_rotation", "hull_box", "map_kind", "map_origin", "episode_start"):
        array = np.ascontiguousarray(getattr(bank, name))
        digest.update(f"{name} {array.shape} {array.dtype}".encode())
        digest.update(array.data)
    return settings.cache_dir("surroundings", f"{digest.hexdigest()[:24]}.npz")


def kept_fields(bank: SceneBank, height: float) -> UInt8[np.ndarray, "Z X Y 2"]:
    """`build_fields` with a cache for large banks."""
    if int((bank.inst_hull >= 0).sum()) < MIN_CACHED_HULLS:
        return build_fields(bank, height)
    path = path_of(bank, height)
    found = array_file.load_cached(path, "distance fields", ("fields",))
    if found is None:
        found = {"fields": build_fields(bank, height)}
        array_file.save_cached(path, found)
    return found["fields"]


class Surroundings:
    """Distance fields of all scenes of a bank.

    Args:
      bank: the scenes.
      height: m, height of the robot; higher hulls are no obstacles.
    """

    def __init__(self, bank: SceneBank, height: float) -> None:
        self._fields = jnp.asarray(kept_fields(bank, height))
        self._origin = jnp.asarray(bank.map_origin, jnp.float32)

    @property
    def fields(self) -> UInt8[np.ndarray, "Z X Y 2"]:
        """See `build_fields`; copied from the device."""
        return np.asarray(self._fields)

    def distances(self, scene: Int[Array, ""] | int, p_xy: Float[Array, "*n 2"]) -> Float[Array, "*n 2"]:
        """(..., 2) m to the nearest hull and to the edge of the walkable ground, at most `MAX_DISTANCE`.

        Args:
          scene: () i32.
          p_xy: (..., 2) m in the world's frame. Outside the map both are 0.
        """
        cell = cell_of(p_xy, self._origin[scene], CELL)
        size = jnp.array(self._fields.shape[1:3])
        inside = ((cell >= 0) & (cell < size)).all(-1, keepdims=True)
        cell = jnp.clip(cell, 0, size - 1)
        return jnp.where(inside, self._fields[scene, cell[..., 0], cell[..., 1]] / 100.0, 0.0)
