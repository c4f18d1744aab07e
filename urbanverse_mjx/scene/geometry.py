"""`SceneGeometry`: one compiled scene as plain arrays, before it is written as MJCF or packed into a bank.

`scene.xml` and the bank are both written from it, so they cannot differ. File: `geometry.npz`.
"""

import dataclasses
import json
import os
from typing import Any, Protocol

import numpy as np

from ..datatypes import AssetMesh, array_file
from ..datatypes import validation as v
from ..datatypes.ground import GROUND_KINDS
from ..geometry.grids import Grid

SCHEMA = "urbanverse.scene_geometry/1"


class Sky(Protocol):
    """Light of a scene, as `assets.appearances.skies` builds it.

    Attributes:
      radiance: (H, W, 3) float32 equirectangular, rows from zenith to nadir, column 0 at yaw -π growing
        counter-clockwise, the sun's disc taken out.
      sun_direction: (3,) unit vector from the ground to the sun, before the scene's sky yaw.
      sun_irradiance: (3,) on a plane facing the sun.
    """

    @property
    def radiance(self) -> np.ndarray: ...
    @property
    def sun_direction(self) -> np.ndarray: ...
    @property
    def sun_irradiance(self) -> np.ndarray: ...


@dataclasses.dataclass(frozen=True)
class SceneMap:
    """5 cm map of one scene; cell (i, j) covers origin + [i, i + 1) x [j, j + 1) cells.

    Attributes:
      origin: (2,) m, lower corner.
      resolution: m.
      height: (X, Y) float32 m of the ground's top at the cell's centre, NaN where there is none.
      kind: (X, Y) uint8 over `ground.GROUND_KINDS`, paint included.
      clearance: (X, Y) float32 m, free height above the ground; `FREE_CLEARANCE` if no hull hangs below 6.4 m.
    """

    origin: np.ndarray
    resolution: float
    height: np.ndarray
    kind: np.ndarray
    clearance: np.ndarray

    @property
    def grid(self) -> Grid:
        """The map's cells."""
        x, y = self.kind.shape
        return Grid(self.origin, self.resolution, (x, y))


@dataclasses.dataclass(frozen=True)
class EpisodeTable:
    """Table of E episodes with at most W waypoints.

    Attributes:
      start: (E, 4) x, y, z of the ground, yaw.
      goal: (E, 3).
      waypoints: (E, W, 3) every 5 m along the geodesic; the last is the goal, which is repeated as padding.
      num_waypoints: (E,) i32.
      length: (E,) geodesic m.
      line_free: (E,) bool, whether the straight line from start to goal is free.
      crosses_road: (E,) bool, whether the path uses a crosswalk.
      drive_time: (E,) s that the controller needs without obstacles, -1 if it was not driven.
    """

    start: np.ndarray
    goal: np.ndarray
    waypoints: np.ndarray
    num_waypoints: np.ndarray
    length: np.ndarray
    line_free: np.ndarray
    crosses_road: np.ndarray
    drive_time: np.ndarray

    def __len__(self) -> int:
        return len(self.start)


#: Kinds as which ground and what is drawn beside it are labelled: `region_kind` is an index into these.
SHOWN_KINDS = (*GROUND_KINDS, "building")
#: Fields that follow from the layout, which lies beside the file.
_DERIVED = ("prism_material_friction",)


@dataclasses.dataclass(frozen=True)
class SceneGeometry:
    """The geometry of a scene as arrays.

    Attributes:
      scene_id: unique in a bank.
      object_ids, object_categories: one each per object, in visual-slot order (along x).
      object_position: (O, 3) m.
      object_quaternion: (O, 4) wxyz.
      object_mesh: (O,) index into `meshes`.
      object_mass: (O,) kg.
      object_friction: (O,).
      object_movable: (O,) bool.
      hulls: distinct hulls, (n, 3) float32 corners in the frame of the object or prism they belong to.
      inst_hull, inst_object: (Q,) i32: hull of an instance and the object that carries it.
      prism_hull: (P,) i32.
      prism_position: (P, 3) m.
      prism_kind: (P,) i32.
      prism_friction: (P,).
      prism_region: (P,) i32, the ground region a prism belongs to.
      prism_material_friction: (P,) of its region's material; not in `geometry.npz`, see `CompiledScene.load`.
      region_ids: ids of the ground regions, then of what is drawn on and around them (`roads`, `backdrop`), without
        prisms.
      region_kind: (R,) i32, index into `SHOWN_KINDS`.
      region_mesh: (R,) index into `meshes`.
      region_position: (R, 3) m.
      meshes: distinct visual meshes.
      sky: id of the sky.
      sky_yaw: rad.
      map, episodes: see `SceneMap` and `EpisodeTable`.
    """

    scene_id: str
    object_ids: tuple[str, ...]
    object_categories: tuple[str, ...]
    object_position: np.ndarray
    object_quaternion: np.ndarray
    object_mesh: np.ndarray
    object_mass: np.ndarray
    object_friction: np.ndarray
    object_movable: np.ndarray
    hulls: tuple[np.ndarray, ...]
    inst_hull: np.ndarray
    inst_object: np.ndarray
    prism_hull: np.ndarray
    prism_position: np.ndarray
    prism_kind: np.ndarray
    prism_friction: np.ndarray
    prism_region: np.ndarray
    prism_material_friction: np.ndarray
    region_ids: tuple[str, ...]
    region_kind: np.ndarray
    region_mesh: np.ndarray
    region_position: np.ndarray
    meshes: tuple[AssetMesh, ...]
    sky: str
    sky_yaw: float
    map: SceneMap
    episodes: EpisodeTable

    def with_objects(self, keep: np.ndarray) -> "SceneGeometry":
        """The scene with only the objects of `keep` (O,) bool; ground, meshes and hulls do not change."""
        number = np.cumsum(keep, dtype=np.int32) - 1
        rows = keep[self.inst_object]
        names = ("position", "quaternion", "mesh", "mass", "friction", "movable")
        return dataclasses.replace(
            self,
            object_ids=tuple(np.array(self.object_ids, object)[keep]),
            object_categories=tuple(np.array(self.object_categories, object)[keep]),
            **{f"object_{name}": getattr(self, f"object_{name}")[keep] for name in names},
            inst_hull=self.inst_hull[rows],
            inst_object=number[self.inst_object[rows]],
        )

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes `geometry.npz`: arrays by name, and lists of arrays concatenated together with their offsets."""
        body: dict[str, np.ndarray] = {}
        meta: dict[str, Any] = {"schema": SCHEMA}
        for field in dataclasses.fields(self):
            value = getattr(self, field.name)
            if field.name in _DERIVED:
                continue
            if isinstance(value, np.ndarray):
                body[field.name] = value
            elif field.name not in ("hulls", "meshes", "map", "episodes"):
                meta[field.name] = list(value) if isinstance(value, tuple) else value
        body |= _join("hulls", self.hulls)
        for name in ("vertices", "faces", "uv"):
            body |= _join(f"meshes.{name}", [getattr(m, name) for m in self.meshes])
        textures = {m.texture.tobytes(): m.texture for m in self.meshes}
        number = {key: i for i, key in enumerate(textures)}
        body |= _join("textures", textures.values())
        body["meshes.texture"] = np.array([number[m.texture.tobytes()] for m in self.meshes], np.int32)
        body["meshes.surface"] = np.array([[m.roughness, m.metallic] for m in self.meshes], np.float64).reshape(-1, 2)
        for group in ("map", "episodes"):
            part = getattr(self, group)
            body |= {f"{group}.{f.name}": np.asarray(getattr(part, f.name)) for f in dataclasses.fields(part)}
        body["meta"] = np.frombuffer(json.dumps(meta).encode("utf-8"), np.uint8)
        array_file.save(path, body)

    @staticmethod
    def load(path: str | os.PathLike[str]) -> "SceneGeometry":
        """Reads `geometry.npz`; the friction of materials, which it does not hold, is `prism_friction`."""
        if not os.path.isfile(path):
            raise v.fail(str(path), "no such file", "a compiled scene", "run `urbanverse scene compile` again")
        body = array_file.load(path, "a compiled scene", "run `urbanverse scene compile` again")
        meta = v.parse_json(body.pop("meta", np.zeros(0, np.uint8)).tobytes(), f"{path}: meta")
        v.choice(meta.pop("schema", None), f"{path}: schema", (SCHEMA,))
        columns = [_split(body, f"meshes.{name}") for name in ("vertices", "faces", "uv")]
        textures = _split(body, "textures")
        columns.append([textures[i] for i in body.pop("meshes.texture")])
        surface = body.pop("meshes.surface")
        meshes = tuple(
            AssetMesh(*parts, roughness=float(s[0]), metallic=float(s[1]))
            for *parts, s in zip(*columns, surface, strict=True)
        )
        scene_map = {f.name: body.pop(f"map.{f.name}") for f in dataclasses.fields(SceneMap)}
        scene_map["resolution"] = float(scene_map["resolution"])
        episodes = {f.name: body.pop(f"episodes.{f.name}") for f in dataclasses.fields(EpisodeTable)}
        hulls = tuple(_split(body, "hulls"))
        meta = {k: tuple(x) if isinstance(x, list) else x for k, x in meta.items()}
        body["prism_material_friction"] = body["prism_friction"]
        return SceneGeometry(
            **meta, **body, hulls=hulls, meshes=meshes, map=SceneMap(**scene_map), episodes=EpisodeTable(**episodes)
        )


def _join(name: str, arrays: Any) -> dict[str, np.ndarray]:
    """Stores arrays of different shapes as one flat array and their shapes."""
    arrays = list(arrays)
    dims = max((a.ndim for a in arrays), default=1)
    flat = np.concatenate([a.ravel() for a in arrays]) if arrays else np.zeros(0, np.float32)
    return {f"{name}.data": flat, f"{name}.shape": np.array([a.shape for a in arrays], np.int64).reshape(-1, dims)}


def _split(body: dict[str, np.ndarray], name: str) -> list[np.ndarray]:
    data, shapes = body.pop(f"{name}.data"), body.pop(f"{name}.shape")
    starts = np.concatenate([[0], np.cumsum(shapes.prod(1))]).astype(np.int64)
    return [data[a:b].reshape(shape) for a, b, shape in zip(starts, starts[1:], shapes, strict=False)]
