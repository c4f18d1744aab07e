"""Distances from any point of a scene to the nearest object and to the edge of the walkable ground.

They are used by critics and rewards, not by policies, and looked up in a grid made once per bank.
"""

import concurrent.futures
import math
import pathlib
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int, UInt8
from scipy import ndimage

from ... import settings, versions
from ...datatypes import SceneBank, array_file, traversable
from ...geometry.grids import Grid, cell_of, pooled

#: m, side of a cell; the error of a look-up is half of it, a tenth of COCO's length.
CELL = 0.2
#: Number of hulls from which the fields of a bank, which take seconds, are cached.
MIN_CACHED_HULLS = 20_000
#: m, largest stored distance: the maximum of an unsigned byte in centimetres.
MAX_DISTANCE = 2.55
#: m; hulls below this height above the pavement are ignored, because wheels pass over them.
MIN_OBSTACLE_HEIGHT = 0.05
#: Distances that are computed together: few enough that they stay in a processor's cache.
_DISTANCES_TOGETHER = 1 << 15
#: Arrays of a bank on which the fields depend.
_READ = ("inst_hull", "inst_position", "inst_rotation", "hull_box", "map_kind", "map_origin", "episode_start")
#: Cells; the windows of hulls have multiples of it as sizes.
_WINDOW_MULTIPLE = 4


def _to_edge(bank: SceneBank, scene: int, shape: tuple[int, int]) -> np.ndarray:
    """(X, Y) m from each cell to the nearest one that is not completely walkable; 0 there."""
    walkable = traversable(bank.map_kind[scene])
    factor = round(CELL / float(bank.map_resolution))
    missing = [(0, n * factor - m) for n, m in zip(shape, walkable.shape, strict=True)]
    whole = pooled(np.pad(walkable, missing), factor, np.all)
    distance = np.zeros(shape)
    if whole.any():
        # Beyond the walkable cells all distances are 0, often on most of a map that is padded to the largest one.
        rows, columns = (np.flatnonzero(whole.any(axis)) for axis in (1, 0))
        part = slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)
        distance[part] = ndimage.distance_transform_edt(np.pad(whole[part], 1))[1:-1, 1:-1] * CELL
    return distance


def _to_hulls(bank: SceneBank, scene: int, grid: Grid, height: float, least: float) -> np.ndarray:
    """(X, Y) f32 m from each cell to the nearest box of a hull that extends between `least` and `height` m above
    ground, at most `MAX_DISTANCE`."""
    ground = _ground_height(bank, scene)
    bottom, top = ground + least, ground + height
    present = np.flatnonzero(bank.inst_hull[scene] >= 0)
    rotation, position = bank.inst_rotation[scene, present], bank.inst_position[scene, present]
    centre, half = np.moveaxis(bank.hull_box[bank.inst_hull[scene, present]], 1, 0)
    middle = position + (rotation @ centre[..., None])[..., 0]
    reach = (np.abs(rotation) @ half[..., None])[..., 0]
    # At the height at which the robot is nearest to the box's centre.
    z = np.clip(middle[:, 2], bottom, top) - position[:, 2]
    low, high = (middle - reach)[:, :2], (middle + reach)[:, :2]
    first, last = grid.windows(low - MAX_DISTANCE, high + MAX_DISTANCE)
    near = (middle[:, 2] - reach[:, 2] <= top) & (middle[:, 2] + reach[:, 2] >= bottom) & (first < last).all(1)
    # Windows a few cells larger than needed have few different sizes.
    size = np.minimum(_WINDOW_MULTIPLE * -(-(last - first) // _WINDOW_MULTIPLE), grid.shape)
    first = np.minimum(first, grid.shape - size)
    boxes = _Boxes(first, rotation, position, centre, half, z)
    square = np.full(grid.shape, np.inf, np.float32)
    for shape in np.unique(size[near], axis=0):
        alike = np.flatnonzero(near & (size == shape).all(1))
        for some in np.array_split(alike, math.ceil(len(alike) * shape.prod() / _DISTANCES_TOGETHER)):
            found = _squares(grid, _Boxes(*(values[some] for values in boxes)), shape)
            for (i, j), values in zip(first[some].tolist(), found, strict=True):
                part = square[i : i + shape[0], j : j + shape[1]]
                np.minimum(part, values, out=part)
    return np.minimum(np.sqrt(square), np.float32(MAX_DISTANCE))


class _Boxes(NamedTuple):
    """n boxes: their first cells (n, 2), T_world_hull, the box in the hull's frame, and the height (m) above the
    hull's origin at which distances count."""

    first: np.ndarray
    rotation: np.ndarray
    position: np.ndarray
    centre: np.ndarray
    half: np.ndarray
    z: np.ndarray


def _squares(grid: Grid, boxes: _Boxes, shape: np.ndarray) -> np.ndarray:
    """(n, X, Y) m^2, squared distances from the centres of X x Y cells, the first of which is `first`, to n boxes."""
    x, y = (grid.along(k, boxes.first[:, k, None] + np.arange(shape[k])) for k in (0, 1))
    x, y = x - boxes.position[:, 0, None], y - boxes.position[:, 1, None]
    square = np.zeros((len(x), *shape), np.float32)
    for k in range(3):
        # Along an axis of the hull's frame: a column of x, a row of y.
        along = boxes.rotation[:, 0, k, None] * x - boxes.centre[:, k, None]
        across = boxes.rotation[:, 1, k, None] * y + (boxes.rotation[:, 2, k] * boxes.z)[:, None]
        outside = along[:, :, None] + across[:, None, :]
        np.abs(outside, out=outside)
        outside -= boxes.half[:, k, None, None]
        np.maximum(outside, 0.0, out=outside)
        outside *= outside
        square += outside
    return square


def _ground_height(bank: SceneBank, scene: int) -> float:
    """m, ground height at the starts of the scene's episodes, which is that of the pavement nearly everywhere."""
    return float(np.median(bank.episode_start[scene, : int(bank.num_episodes[scene]), 2]))


def build_fields(bank: SceneBank, height: float, least: float = MIN_OBSTACLE_HEIGHT) -> UInt8[np.ndarray, "Z X Y 2"]:
    """(Z, X, Y, 2) u8 cm, distances to the nearest hull between `least` and `height` m above ground, and to the
    walkable edge."""
    size = np.array(bank.map_kind.shape[1:]) * float(bank.map_resolution)
    x, y = (int(n) for n in np.ceil(size / CELL - 1e-6))
    fields = np.zeros((bank.num_scenes, x, y, 2), np.uint8)

    def fill(scene: int) -> None:
        hulls = _to_hulls(bank, scene, Grid(bank.map_origin[scene], CELL, (x, y)), height, least)
        metres = np.stack([hulls, _to_edge(bank, scene, (x, y))], -1)
        fields[scene] = np.rint(np.minimum(metres, MAX_DISTANCE) * 100.0)

    with concurrent.futures.ThreadPoolExecutor(settings.num_threads()) as pool:
        list(pool.map(fill, range(bank.num_scenes)))
    return fields


def path_of(bank: SceneBank, height: float, least: float = MIN_OBSTACLE_HEIGHT) -> pathlib.Path:
    """The file in the cache of a bank's fields for hulls between two heights (m)."""
    parts = (versions.of("surroundings"), CELL, MAX_DISTANCE, least, height, float(bank.map_resolution))
    key = array_file.key_of(parts, {name: getattr(bank, name) for name in _READ})
    return settings.cache_dir("surroundings", f"{key}.npz")


def kept_fields(bank: SceneBank, height: float, least: float = MIN_OBSTACLE_HEIGHT) -> UInt8[np.ndarray, "Z X Y 2"]:
    """`build_fields` with a cache for large banks."""
    if int((bank.inst_hull >= 0).sum()) < MIN_CACHED_HULLS:
        return build_fields(bank, height, least)
    path = path_of(bank, height, least)
    found = array_file.load_cached(path, "distance fields", ("fields",))
    if found is None:
        found = {"fields": build_fields(bank, height, least)}
        array_file.save_cached(path, found)
    return found["fields"]


class Surroundings:
    """Distance fields of all scenes of a bank.

    Args:
      bank: the scenes.
      height: m, height of the robot; higher hulls are no obstacles.
      least: m, lower hulls are no obstacles.
    """

    def __init__(self, bank: SceneBank, height: float, least: float = MIN_OBSTACLE_HEIGHT) -> None:
        self._fields = jnp.asarray(kept_fields(bank, height, least))
        self._origin = jnp.asarray(bank.map_origin, jnp.float32)

    def held(self) -> tuple[tuple["Surroundings", str], ...]:
        """The fields and the corners of the maps, for `table_arguments.Held`."""
        return (self, "_fields"), (self, "_origin")

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
