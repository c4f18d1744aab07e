"""`SceneBank`: many compiled scenes as padded arrays with a leading `scene` axis. File: `bank-<hash>.npz`, or a folder
`NAME.bank` (`bank_shards`), of which scenes can be read alone.

It holds all data for physics, rendering, environments and evaluation, so a GPU machine needs no other file. All
positions are in the scene's world frame (z up, metres), rotations R_world_x.

Sizes: Z scenes, T distinct hulls, V = 32 corners and F = 60 triangles a hull, Q hull instances a scene,
P ground prisms a scene, N visual slots a scene, E episodes a scene, W waypoints an episode, M meshes,
K materials, S skies, A categories.
"""

import dataclasses
import json
import os
import pathlib
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from . import array_file
from . import validation as v
from .asset import MAX_HULL_VERTICES
from .bank_checks import check_bank
from .bank_shards import SUFFIX, BankShards
from .bank_shards_writer import BankShardsWriter

SCHEMA = "urbanverse.scene_bank/1"
#: Splits of scenes: for training; for the choice of presets, checkpoints and ablations; for reports.
SPLITS = ("train", "validation", "test")
MAX_HULL_TRIANGLES = 2 * MAX_HULL_VERTICES - 4
#: For `SceneBank.geometry_of`: beginnings of the names of arrays by scene, arrays by hull, and those of looks alone.
_OF_SCENE = (
    *("inst_", "prism_", "slot_", "episode_", "num_episodes", "map_kind", "map_origin", "hull_grid", "grid_origin"),
    "scene_sky",
)
_OF_HULL = (*("hull_vertices", "hull_num_vertices", "hull_triangles", "hull_num_triangles", "hull_planes", "hull_box"),)
_LOOKS = (
    *("mesh_vertices", "mesh_uv", "mesh_faces", "mesh_material", "texture_data", "texture_shape"),
    *("material_texture", "material_rgba", "material_roughness", "material_metallic"),
)


@dataclasses.dataclass(frozen=True)
class SceneBank:
    """Arrays of a bank; -1 marks an empty slot, padding repeats a valid entry where an index is needed.

    Hull table (shared by all scenes; ground prisms stand in it too):
      hull_vertices (T, V, 3) f32: corners in the hull's own frame, padded by repeating corner 0.
      hull_num_vertices (T,) i32.
      hull_triangles (T, F, 3) i32: outward triangles over the corners, padded by repeating triangle 0.
      hull_num_triangles (T,) i32.
      hull_planes (T, F, 4) f32: outward unit normal n and offset d of each triangle, inside is n·x <= d.
      hull_box (T, 2, 3) f32: centre and half size of the box around the hull in the hull's frame.

    Static hulls of objects:
      inst_hull (Z, Q) i32: row of the hull table, -1 = empty.
      inst_object (Z, Q) i32: object (= visual slot) the hull belongs to, -1 = empty.
      inst_position (Z, Q, 3) f32, inst_rotation (Z, Q, 3, 3) f32: T_world_hull.
      inst_friction (Z, Q) f32.

    Ground prisms (same meaning; prism_kind indexes `ground.GROUND_KINDS`):
      prism_hull (Z, P) i32, prism_position (Z, P, 3) f32 (no rotation), prism_friction (Z, P) f32,
      prism_material_friction (Z, P) f32 of the ground's material, which engines use if asked to, prism_kind (Z, P) i32.

    Grids of the hulls and prisms near each place (built for `grid_reach` metres): grid_origin (Z, 2) f32 lower corner,
    grid_cell () f32 m, hull_grid (Z, X, Y, L) i32 and prism_grid (Z, X, Y, G) i32: instance numbers, -1 = empty.

    Map: map_kind (Z, MX, MY) u8 over `ground.GROUND_KINDS`, map_origin (Z, 2) f32, map_resolution () f32 m;
      cell (i, j) covers origin + [i, i+1) x [j, j+1) cells.

    Episodes: episode_start (Z, E, 4) f32 x, y, z of the ground, yaw; episode_goal (Z, E, 3) f32;
      episode_waypoints (Z, E, W, 3) f32 every 5 m along the geodesic, the last is the goal and repeats;
      episode_num_waypoints (Z, E) i32; episode_length (Z, E) f32 geodesic m; num_episodes (Z,) i32.

    Visual data: mesh_vertices (ΣV, 3) f32, mesh_uv (ΣV, 2) f32, mesh_faces (ΣF, 3) i32 (indices local to the mesh),
    mesh_vertex_start (M+1,) i32, mesh_face_start (M+1,) i32, mesh_material (M,) i32; material_texture (K,) i32 (-1
    none), material_rgba (K, 4) f32, material_roughness (K,) f32, material_metallic (K,) f32; texture_data (bytes,) u8,
    texture_start (number+1,) i64, texture_shape (number, 3) i32; slot_mesh (Z, N) i32 (-1 empty), slot_position (Z, N,
    3) f32, slot_quaternion (Z, N, 4) f32 wxyz, slot_category (Z, N) i32: row of `meta["categories"]`. Slots keep one
    spatial order (along the street) in every scene; slots of ground regions come after the objects.

    Movable objects: slot_movable (Z, N) u8, 1 where the object of a slot is, with its hulls (`inst_object`) and the
    uniform density that slot_mass (Z, N) f32 kg (0 = empty or ground) gives them.

    Skies: sky_radiance (S, HS, WS, 3) f32 equirectangular, rows from zenith to nadir, column 0 at yaw -π growing
      counter-clockwise, the sun's disc taken out; sky_sun_direction (S, 3) f32 unit, from the ground to the sun;
      sky_sun_irradiance (S, 3) f32; scene_sky (Z,) i32, scene_sky_yaw (Z,) f32.

    meta: {"schema", "scene_ids": [Z], "splits": [Z] of `SPLITS` or others, "categories": [A], "skies": [S],
    "object_ids": [Z lists], "hashes": {...}, "grid_reach": m, "agents": {"kind": [L], "mesh": [L], "category": [L]}},
    the last being the appearances of moving people and vehicles: names of kinds, rows of the meshes and categories.
    "materials_unknown": true stands in banks from before there was the friction of materials (`knows_materials`).
    Banks in the cache hold their key there as well, "key": a hexadecimal hash of all their inputs.
    """

    hull_vertices: np.ndarray
    hull_num_vertices: np.ndarray
    hull_triangles: np.ndarray
    hull_num_triangles: np.ndarray
    hull_planes: np.ndarray
    hull_box: np.ndarray
    inst_hull: np.ndarray
    inst_object: np.ndarray
    inst_position: np.ndarray
    inst_rotation: np.ndarray
    inst_friction: np.ndarray
    prism_hull: np.ndarray
    prism_position: np.ndarray
    prism_friction: np.ndarray
    prism_material_friction: np.ndarray
    prism_kind: np.ndarray
    grid_origin: np.ndarray
    grid_cell: np.ndarray
    hull_grid: np.ndarray
    prism_grid: np.ndarray
    map_kind: np.ndarray
    map_origin: np.ndarray
    map_resolution: np.ndarray
    episode_start: np.ndarray
    episode_goal: np.ndarray
    episode_waypoints: np.ndarray
    episode_num_waypoints: np.ndarray
    episode_length: np.ndarray
    num_episodes: np.ndarray
    mesh_vertices: np.ndarray
    mesh_uv: np.ndarray
    mesh_faces: np.ndarray
    mesh_vertex_start: np.ndarray
    mesh_face_start: np.ndarray
    mesh_material: np.ndarray
    material_texture: np.ndarray
    material_rgba: np.ndarray
    material_roughness: np.ndarray
    material_metallic: np.ndarray
    texture_data: np.ndarray
    texture_start: np.ndarray
    texture_shape: np.ndarray
    slot_mesh: np.ndarray
    slot_position: np.ndarray
    slot_quaternion: np.ndarray
    slot_category: np.ndarray
    slot_movable: np.ndarray
    slot_mass: np.ndarray
    sky_radiance: np.ndarray
    sky_sun_direction: np.ndarray
    sky_sun_irradiance: np.ndarray
    scene_sky: np.ndarray
    scene_sky_yaw: np.ndarray
    meta: dict[str, Any]

    def __post_init__(self) -> None:
        check_bank(self.arrays(), self.meta)

    @property
    def num_scenes(self) -> int:
        return len(self.inst_hull)

    @property
    def num_hulls(self) -> int:
        return len(self.hull_vertices)

    @property
    def num_meshes(self) -> int:
        return len(self.mesh_material)

    @property
    def scene_ids(self) -> tuple[str, ...]:
        return tuple(self.meta["scene_ids"])

    @property
    def key(self) -> str:
        """The key by which `settings` names a bank in the cache; empty in other banks."""
        return self.meta.get("key", "")

    @property
    def knows_materials(self) -> bool:
        """Whether `prism_material_friction` is that of materials: files written before it existed do not have it."""
        return not self.meta.get("materials_unknown", False)

    @property
    def agents(self) -> dict[str, list[Any]]:
        """Appearances of moving agents, see `meta`; empty lists if there are none."""
        return self.meta.get("agents", {"kind": [], "mesh": [], "category": []})

    def scenes_of(self, split: str) -> np.ndarray:
        """(n,) i32: numbers of the scenes of a split, one of `SPLITS` or another."""
        return np.array([i for i, s in enumerate(self.meta["splits"]) if s == split], np.int32)

    def standing_hulls(self, scene: int) -> Iterator[np.ndarray]:
        """Of each hull of a scene's objects the corners (n, 3) f64 m in the world."""
        rows = zip(self.inst_hull[scene], self.inst_position[scene], self.inst_rotation[scene], strict=True)
        for hull, position, rotation in rows:
            if hull >= 0:
                local = self.hull_vertices[hull, : self.hull_num_vertices[hull]].astype(np.float64)
                yield local @ rotation.T.astype(np.float64) + position

    def geometry_of(self, scene: int) -> "SceneBank":
        """A bank of one scene with what robots and people can touch, walk on and drive to, and without its looks: a few
        MB, for a process that makes tables of it."""
        own = {name: array[scene : scene + 1] for name, array in self.arrays().items() if name.startswith(_OF_SCENE)}
        used, rows = np.unique(np.concatenate([own["inst_hull"], own["prism_hull"]], 1), return_inverse=True)
        # The first is -1, an empty row, where there is one.
        empty = int(used[0] < 0)
        rows = (rows.reshape(1, -1) - empty).astype(np.int32)
        own["inst_hull"], own["prism_hull"] = np.split(rows, [own["inst_hull"].shape[1]], 1)
        hulls = {name: getattr(self, name)[used[empty:]] for name in _OF_HULL}
        shared = {"grid_cell": self.grid_cell, "map_resolution": self.map_resolution}
        looks = {name: getattr(self, name)[:0] for name in _LOOKS}
        starts = {name: getattr(self, name)[:1] for name in ("mesh_vertex_start", "mesh_face_start", "texture_start")}
        slots = {"slot_mesh": np.full_like(own["slot_mesh"], -1), "scene_sky": np.zeros_like(own["scene_sky"])}
        sky = {name: getattr(self, name)[:1] for name in ("sky_sun_direction", "sky_sun_irradiance")}
        sky["sky_radiance"] = self.sky_radiance[:1, :1, :1]
        meta = {**self.meta, **{k: [self.meta[k][scene]] for k in ("scene_ids", "splits", "object_ids")}}
        meta = {k: x for k, x in meta.items() if k not in ("agents", "key")}
        return SceneBank(meta=meta, **(own | hulls | shared | looks | starts | slots | sky))

    def arrays(self) -> dict[str, np.ndarray]:
        """Every array by its name."""
        return {f.name: getattr(self, f.name) for f in dataclasses.fields(SceneBank) if f.name != "meta"}

    def texture(self, index: int) -> np.ndarray:
        """(H, W, 3) uint8 pixels of one texture, sRGB, row 0 at the top."""
        body = self.texture_data[self.texture_start[index] : self.texture_start[index + 1]]
        return body.reshape(tuple(self.texture_shape[index]))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a file, or a folder (`bank_shards`) where the name ends in .bank.

        Raises:
          ValidationError: there is a folder of this name that is not a bank's.
        """
        if pathlib.Path(path).suffix == SUFFIX:
            with BankShardsWriter(path) as writer:
                writer.add(self.arrays(), self.meta)
            return
        meta = np.frombuffer(json.dumps({**self.meta, "schema": SCHEMA}).encode("utf-8"), np.uint8)
        array_file.save(path, {"meta": meta, **self.arrays()})

    @staticmethod
    def load(path: str | os.PathLike[str]) -> "SceneBank":
        """Reads a bank from a file or a folder, with all its scenes.

        Raises:
          ValidationError: the file does not exist, is damaged, has another schema, or its arrays are inconsistent.
        """
        if os.path.isdir(path):
            shards = BankShards(path)
            return SceneBank.take(shards, range(shards.num_scenes))
        if not os.path.isfile(path):
            raise v.fail(str(path), "no such file", "a scene bank", "build one with `urbanverse scene bank`")
        arrays = array_file.load(path, "a whole scene bank", "build it again, or copy it again from where it is whole")
        meta = v.parse_json(arrays.pop("meta", np.zeros(0, np.uint8)).tobytes(), f"{path}: meta")
        v.choice(meta.get("schema"), f"{path}: schema", (SCHEMA,))
        names = {f.name for f in dataclasses.fields(SceneBank)} - {"meta"}
        if "slot_mesh" in arrays and not {"slot_movable", "slot_mass"} & set(arrays):
            # In older files without this array, no object is movable.
            shape = arrays["slot_mesh"].shape
            arrays |= {"slot_movable": np.zeros(shape, np.uint8), "slot_mass": np.zeros(shape, np.float32)}
        if "prism_friction" in arrays and "prism_material_friction" not in arrays:
            arrays["prism_material_friction"], meta["materials_unknown"] = arrays["prism_friction"], True
        if names != set(arrays):
            wrong = ", ".join(sorted(names ^ set(arrays)))
            raise v.fail(str(path), f"other arrays than expected ({wrong})", "a bank of this version", "build it again")
        return SceneBank(meta=meta, **arrays)

    @staticmethod
    def take(shards: BankShards, rows: "Sequence[int] | np.ndarray", looks: bool = True) -> "SceneBank":
        """Reads some scenes of a folder; of hulls, meshes, textures and skies only those that they use.

        Args:
          rows: of the scenes, in this order, each once.
          looks: whether meshes, textures and skies are read, see `BankShards.take`.

        Raises:
          ValidationError: there is no such row, a file is missing or damaged, or its arrays are inconsistent.
        """
        arrays, meta = shards.take(rows, looks)
        return SceneBank(meta={**meta, "schema": SCHEMA}, **arrays)
