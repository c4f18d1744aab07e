"""Bakes the light of streets: what of the sun and of the sky reaches the ground and the objects of a scene.

In:   the tables of `Streets` on the device, and the bank. Out: `BakedLight` per scene. When: once per scene, when the
first frame is drawn; later processes read it from the cache folder (`light/`).

Rays are those of the renderer itself. The ground has a map of texels; for everything else there is a coarse grid.
"""

import concurrent.futures
import dataclasses
import functools
import hashlib
import math
import pathlib
import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np
import warp as wp
from scipy import ndimage

from ... import settings as process
from ...datatypes import SceneBank, ValidationError, array_file
from ...progress import Progress
from ..threads import run_all
from .light_kernels import AROUND_RAYS, DARKEST, PATTERN, RANGE, SKY_RAYS, bake_grid, bake_ground
from .scenes import scene_sun, sky_ambient, slot_boxes
from .street_kernels import Street, Views
from .street_light_native import CELL, CELL_BYTES, TEXEL, THOUSAND

#: Version of the baked light: part of the keys in the cache, to be raised with every change of its values.
VERSION = 1
#: m around the map of a scene that its tables cover, and above its highest ground.
MARGIN, HEADROOM = 4.0, 12.0
#: Begin of the names of such slots (`scene.backdrop`).
AROUND = "drawn/around/"
#: A camera makes up for this power of what the street is darker than open ground, up to a factor.
EXPOSURE, BRIGHTEST = 0.7, 2.0
#: Brightness of a white surface in the open from which a sky counts as daylight: at dusk or in heavy rain a camera
#: opens by the same power, up to the same factor.
DAYLIGHT = 0.65
#: Least sine of the sun's height by which its light counts for that, as skies are exposed (walls face a low sun).
LOW_SUN = 0.35
#: rad, half the angle of the sun's disc.
SUN_RADIUS = 0.00465
#: Texels or cells of one launch on a CPU, which other threads compute at the same time.
_PIECE = 1 << 14
#: A cell with less light than this lies inside an object, and takes that of its neighbours.
_INSIDE = 0.16


@dataclasses.dataclass(frozen=True)
class BakedLight:
    """Light of one scene.

    Attributes:
      ground_origin: (2,) m, lower corner of the ground's map of `TEXEL` squares.
      ground: (X, Y, 2) u8, unhidden shares of sun and sky.
      origin: (3,) m, lower corner of the grid of `CELL` cubes.
      grid: (I, J, K, 8) u8; of each cell sun and mean of the light around, then its gradient (i8 x, y, z).
      exposure: () f32, factor on all light that the camera takes in, as the street is darker than open ground.
    """

    ground_origin: np.ndarray
    ground: np.ndarray
    origin: np.ndarray
    grid: np.ndarray
    exposure: np.ndarray


def _hemisphere() -> np.ndarray:
    """(16 patterns * rays, 3) directions, each pattern spread over the upper half by the cosine."""
    number = PATTERN**2
    ray = np.arange(SKY_RAYS)
    side = math.isqrt(SKY_RAYS)
    directions = []
    for pattern in range(number):
        # A low-discrepancy shift of the pattern within its strata.
        shift = np.array([pattern * 0.7548776662, pattern * 0.5698402910]) % 1.0
        height, around = (ray // side + shift[0]) / side, (ray % side + shift[1]) / side
        radius = np.sqrt(height)
        angle = 2 * np.pi * around
        directions.append(np.stack([radius * np.cos(angle), radius * np.sin(angle), np.sqrt(1.0 - height)], -1))
    return np.concatenate(directions)


def _sphere(number: int) -> np.ndarray:
    """(number, 3) directions spread evenly over the sphere."""
    i = np.arange(number) + 0.5
    z, angle = 1.0 - 2.0 * i / number, np.pi * (1.0 + 5.0**0.5) * i
    radius = np.sqrt(1.0 - z * z)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), z], -1)


def around_scenes(bank: SceneBank) -> np.ndarray:
    """(Z, N) bool, slots with ground behind the houses of a scene and beyond its ends.

    It has the light of the nearest ground of the scene: most of it lies below houses or in courts, and would count as
    dark ground in the exposure and darken the feet of walls.
    """
    found = np.zeros(bank.slot_mesh.shape, bool)
    for scene, names in enumerate(bank.meta["object_ids"]):
        found[scene, : len(names)] = [name.startswith(AROUND) for name in names]
    return found


class Baker:
    """Bakes scenes of one bank on Warp's current device.

    Args:
      street: the tables of the bank's scenes, without moving parts.
      roots: (Z,) i32 of their trees.
      is_ground: (objects,) bool, which rows of the object table are ground with light of its own.
    """

    def __init__(self, bank: SceneBank, street: Any, roots: np.ndarray, is_ground: np.ndarray) -> None:
        self._bank, self._roots = bank, roots
        self._is_ground = wp.array(is_ground.astype(np.int32), dtype=int)
        self._street = Street()
        tables = ("nodes", "triangles", "faces", "object_rows", "entries", "lights", "parts", "balls")
        for name in (*tables, "num_objects"):
            setattr(self._street, name, getattr(street, name))
        self._zeros = wp.zeros(4, dtype=wp.vec4)
        self._views = Views()
        for name in ("cameras", "poses", "balls", "seen", "moved"):
            setattr(self._views, name, self._zeros.ptr)
        self._sky = wp.array(_hemisphere(), dtype=wp.vec3)
        self._around = wp.array(_sphere(AROUND_RAYS), dtype=wp.vec3)
        self._suns, self._irradiance = scene_sun(bank)
        self._ambient = sky_ambient(bank)
        self._lower, self._upper = slot_boxes(bank)
        self._on_host = bool(wp.get_device().is_cpu)
        self._mesh_digests: dict[int, bytes] = {}
        self._around_scene = around_scenes(bank)

    def lights(self) -> list[BakedLight]:
        """Light of every scene, from the cache where it is there."""
        folder = process.cache_dir("light")
        paths = [folder / f"{self._key(scene)}.npz" for scene in range(self._bank.num_scenes)]
        found = [_read(path) for path in paths]
        todo = [scene for scene, light in enumerate(found) if light is None]
        if todo:
            with Progress() as progress:
                report = progress.task("computing shadows", len(todo), unit="scenes")
                for done, scene in enumerate(todo, 1):
                    found[scene] = self._bake(scene)
                    _write(paths[scene], found[scene])
                    report(done)
        return [
            dataclasses.replace(light, exposure=light.exposure * self._opened(scene))
            for scene, light in enumerate(found)
            if light is not None
        ]

    def _opened(self, scene: int) -> np.float32:
        """Factor on the exposure of a scene for a sky darker than daylight; not part of what the cache keeps."""
        sun = float(np.mean(self._irradiance[scene]) / np.pi * max(self._suns[scene][2], LOW_SUN))
        white = max(sun + float(np.mean(self._ambient[scene])), 1e-6)
        return np.float32(np.clip((DAYLIGHT / white) ** EXPOSURE, 1.0, BRIGHTEST))

    def _key(self, scene: int) -> str:
        """Hash of all that the light of a scene depends on."""
        bank, digest = self._bank, hashlib.sha256()
        slots = np.flatnonzero(bank.slot_mesh[scene] >= 0)
        kind = "cpu" if self._on_host else "cuda"
        digest.update(
            repr((VERSION, kind, TEXEL, CELL, MARGIN, HEADROOM, RANGE, DARKEST, EXPOSURE, BRIGHTEST)).encode()
        )
        for mesh in bank.slot_mesh[scene, slots].tolist():
            digest.update(self._mesh_digest(mesh))
        ground = np.array([name.startswith("ground:") for name in bank.meta["categories"]])
        for array in (
            bank.slot_position[scene, slots],
            bank.slot_quaternion[scene, slots],
            ground[bank.slot_category[scene, slots]] & ~self._around_scene[scene, slots],
            bank.map_origin[scene],
            bank.map_kind[scene].any(1),
            bank.map_kind[scene].any(0),
            np.round(self._suns[scene], 6),
            np.round(self._sunlit(scene), 3),
        ):
            digest.update(np.ascontiguousarray(array).tobytes())
        return digest.hexdigest()[:32]

    def _mesh_digest(self, mesh: int) -> bytes:
        if mesh not in self._mesh_digests:
            bank, digest = self._bank, hashlib.sha256()
            for table, start in ((bank.mesh_vertices, bank.mesh_vertex_start), (bank.mesh_faces, bank.mesh_face_start)):
                digest.update(np.ascontiguousarray(table[start[mesh] : start[mesh + 1]]).tobytes())
            self._mesh_digests[mesh] = digest.digest()
        return self._mesh_digests[mesh]

    def _sunlit(self, scene: int) -> float:
        """The sun's share of the light on open ground."""
        sun = float(np.mean(self._irradiance[scene]) / np.pi * max(self._suns[scene][2], 0.0))
        return sun / max(sun + float(np.mean(self._ambient[scene])), 1e-6)

    def _area(self, scene: int) -> tuple[np.ndarray, np.ndarray]:
        """(2,) lower and upper corner, m, of what the tables of a scene cover."""
        bank = self._bank
        rows, columns = (np.flatnonzero(bank.map_kind[scene].any(axis)) for axis in (1, 0))
        size = float(bank.map_resolution)
        if len(rows):
            first, last = np.array([rows[0], columns[0]]), np.array([rows[-1], columns[-1]]) + 1
            low, high = (bank.map_origin[scene].astype(np.float64) + edge * size for edge in (first, last))
        else:
            present = bank.slot_mesh[scene] >= 0
            low, high = self._lower[scene, present, :2].min(0), self._upper[scene, present, :2].max(0)
        return np.floor(low - MARGIN), np.ceil(high + MARGIN)

    def _bake(self, scene: int) -> BakedLight:
        low, high = self._area(scene)
        shape = np.maximum(np.round((high - low) / TEXEL).astype(int), 2)
        sun = self._suns[scene]
        if self._irradiance[scene].max() < 1e-3:
            sun = np.array([0.0, 0.0, -1.0])
        common = [self._street, self._views, int(self._roots[scene]), self._is_ground]
        towards = wp.vec3(*sun)
        suns = wp.array(_disc(sun), dtype=wp.vec3)
        light = wp.zeros((int(shape.prod()), 3), dtype=float)
        inputs = [*common, wp.vec2(*low), int(shape[1]), towards, suns, self._sky, light]
        self._launch(bake_ground, len(light), inputs)
        ground = light.numpy().reshape(*shape, 3)
        known = ground[..., 2] > -1e5
        if known.any() and not known.all():
            # Where there is no ground, as at the foot of a wall, that of the nearest place.
            nearest = ndimage.distance_transform_edt(~known, return_distances=False, return_indices=True)
            ground[..., :2] = ground[(*nearest, slice(0, 2))]
        ground[..., 1] = _smoothed(ground[..., 1])
        heights = ground[known, 2]
        bottom, top = (0.0, 1.0) if not len(heights) else (float(heights.min()), float(heights.max()))
        origin = np.array([*low, math.floor(bottom)])
        cells = np.maximum(np.ceil(([*high, top + HEADROOM] - origin) / CELL).astype(int), 2)
        around = wp.zeros((int(cells.prod()), 5), dtype=float)
        table = wp.array(np.ascontiguousarray(ground, np.float32), dtype=float)
        inputs = [*common, table, wp.vec2(*low), self._sunlit(scene), wp.vec3(*origin), int(cells[1]), int(cells[2])]
        self._launch(bake_grid, len(around), [*inputs, towards, suns, self._around, around])
        return BakedLight(
            low.astype(np.float32),
            np.round(np.clip(ground[..., :2], 0.0, 1.0) * 255.0).astype(np.uint8),
            origin.astype(np.float32),
            _packed(_filled(around.numpy().reshape(*cells, 5))),
            self._exposure(scene, ground[known, :2]),
        )

    def _exposure(self, scene: int, ground: np.ndarray) -> np.ndarray:
        """Exposure for ground with these shares (n, 2) of sun and sky; that of open ground is 1."""
        if not len(ground):
            return np.asarray(1.0, np.float32)
        sunlit = self._sunlit(scene)
        mean = float(ground.mean(0) @ np.array([sunlit, 1.0 - sunlit]))
        return np.asarray(np.clip(mean**-EXPOSURE, 1.0, BRIGHTEST), np.float32)

    def _launch(self, kernel: Any, number: int, inputs: Sequence[object]) -> None:
        """Launches a kernel whose first input is the first of its items; on a CPU in pieces in several threads."""
        if not self._on_host:
            wp.launch(kernel, dim=number, inputs=[0, *inputs])
            return
        # The first launch compiles the kernel, which threads must not do at the same time.
        pieces = [(first, min(_PIECE, number - first)) for first in range(0, number, _PIECE)]
        launch = functools.partial(_launch_piece, kernel, inputs)
        launch(pieces.pop(0))
        with concurrent.futures.ThreadPoolExecutor(process.num_threads()) as pool:
            run_all(pool, [functools.partial(launch, piece) for piece in pieces])


def _launch_piece(kernel: Any, inputs: Sequence[object], piece: tuple[int, int]) -> None:
    wp.launch(kernel, dim=piece[1], inputs=[piece[0], *inputs], device="cpu")


def _disc(sun: np.ndarray) -> np.ndarray:
    """(4, 3) directions within the sun's disc."""
    side = np.cross(sun, [0.0, 0.0, 1.0] if abs(sun[2]) < 0.9 else [1.0, 0.0, 0.0])
    side /= np.linalg.norm(side)
    up = np.cross(side, sun)
    angle = np.pi * (0.25 + 0.5 * np.arange(4))[:, None]
    return sun + 0.7 * SUN_RADIUS * (np.cos(angle) * side + np.sin(angle) * up)


def _smoothed(sky: np.ndarray) -> np.ndarray:
    """Means that hold every texel of the pattern with the same weight."""
    weights = np.array([0.125, 0.25, 0.25, 0.25, 0.125])
    return ndimage.convolve1d(ndimage.convolve1d(sky, weights, axis=0, mode="nearest"), weights, axis=1, mode="nearest")


def _filled(light: np.ndarray) -> np.ndarray:
    """(I, J, K, 5): cells inside objects with the mean of their neighbours outside, as far as two cells."""
    light, known = light.copy(), light[..., 1] >= _INSIDE
    for _ in range(2):
        near = ndimage.uniform_filter(known.astype(np.float64), 3, mode="nearest")
        mean = np.stack(
            [ndimage.uniform_filter(np.where(known, x, 0.0), 3, mode="nearest") for x in np.moveaxis(light, -1, 0)], -1
        )
        take = ~known & (near > 1e-6)
        light[take] = mean[take] / near[take, None]
        known = known | take
    return light


def _packed(light: np.ndarray) -> np.ndarray:
    """(..., 8) u8 from (..., 5); see `BakedLight`."""
    cells = np.zeros((*light.shape[:-1], CELL_BYTES), np.uint8)
    cells[..., :2] = np.round(np.clip(light[..., :2], 0.0, 1.0) * 255.0)
    cells[..., 2:5] = np.round(np.clip(light[..., 2:], -1.0, 1.0) * 127.0).astype(np.int8).view(np.uint8)
    return cells


def _read(path: pathlib.Path) -> BakedLight | None:
    """The light of a file; None where there is none, or a damaged one, which is baked again."""
    if not path.is_file():
        return None
    try:
        arrays = array_file.load(path, "baked light", "delete it")
        return BakedLight(**arrays)
    except (ValidationError, TypeError) as error:
        warnings.warn(f"baked light: found a damaged file and bakes the scene again: {error}", stacklevel=2)
        return None


def _write(path: pathlib.Path, light: BakedLight | None) -> None:
    """Writes a file of the cache; where that is not possible, later processes bake the scene again."""
    if light is None:
        return
    try:
        array_file.save(path, {f.name: getattr(light, f.name) for f in dataclasses.fields(light)})
    except (OSError, ValidationError) as error:
        message = f"baked light: cannot keep it in {path.parent} ({error}); every process bakes it again"
        warnings.warn(message, stacklevel=2)


def light_tables(lights: Sequence[BakedLight]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(Z, 4, 4) f32 rows of the scenes (`street_light_native.SHEET`), and all texels and cells as bytes."""
    texels = np.cumsum([0, *(light.ground[..., 0].size for light in lights)])
    cells = np.cumsum([0, *(light.grid[..., 0].size for light in lights)])
    sheets = np.zeros((len(lights), 4, 4), np.float32)
    for sheet, light, texel, cell in zip(sheets, lights, texels[:-1].tolist(), cells[:-1].tolist(), strict=True):
        sheet[0] = *light.ground_origin, light.exposure, cell // THOUSAND
        sheet[1] = *light.ground.shape[:2], texel // THOUSAND, texel % THOUSAND
        sheet[2, :3] = light.origin
        sheet[3] = *light.grid.shape[:3], cell % THOUSAND
    tables = ([light.ground.ravel() for light in lights], [light.grid.ravel() for light in lights])
    return sheets, np.concatenate(tables[0]), np.concatenate(tables[1])
