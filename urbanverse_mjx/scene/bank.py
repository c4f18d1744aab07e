"""Packs many `SceneGeometry` into one `SceneBank`. Equal hulls, meshes and textures are stored once."""

import dataclasses
import hashlib
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..datatypes import SPLITS, AgentAppearance, AssetMesh, SceneBank, bank_join
from ..datatypes import validation as v
from ..datatypes.ground import GROUND_KINDS
from ..geometry import rotations
from . import grids
from .geometry import SceneGeometry, Sky
from .hulls import ConvexPart, convex_part, hull_table

#: Empty rows and columns of grid cells around a scene, so that a robot outside it finds no hull.
_GRID_MARGIN = 2
#: Leaf as which windows at the ends of rows and fronts behind a scene are labelled.
DRAWN_BUILDING = "apartment building"


def ground_category(kind: int) -> str:
    """Category name of the visual slot of a ground region, or of what is drawn beside it."""
    return f"ground:{GROUND_KINDS[kind]}" if kind < len(GROUND_KINDS) else DRAWN_BUILDING


class _Library:
    """Distinct items in order of first use."""

    def __init__(self) -> None:
        self.items: list[Any] = []
        self._rows: dict[Any, int] = {}

    def row(self, key: Any, make: Any) -> int:
        if key not in self._rows:
            self._rows[key] = len(self.items)
            self.items.append(make())
        return self._rows[key]


def _fingerprint(*arrays: np.ndarray) -> bytes:
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(str((array.shape, array.dtype.str)).encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.digest()


def _spread(count: int, slots: int) -> np.ndarray:
    """Slots of `count` objects in spatial order, so that a slot is at a similar position in every scene."""
    return np.arange(count) * slots // max(count, 1)


def _fill(rows: Sequence[np.ndarray], fill: float, dtype: Any, width: int | None = None) -> np.ndarray:
    """Stacks arrays whose leading axes differ in length to one padded array."""
    width = max([len(r) for r in rows] + [1]) if width is None else width
    out = np.full((len(rows), width, *rows[0].shape[1:]), fill, dtype)
    for line, row in zip(out, rows, strict=True):
        line[: len(row)] = row
    return out


def pack(
    scenes: Sequence[SceneGeometry],
    splits: Sequence[str],
    skies: Mapping[str, Sky],
    hashes: Mapping[str, str] | None = None,
) -> SceneBank:
    """Makes one bank of all scenes.

    Args:
      scenes: at least one, with unique ids.
      splits: split of each scene, one of `SPLITS`.
      skies: id -> sky, for every sky that a scene names; all have one image size.
      hashes: hashes to record in the bank's metadata.

    Raises:
      ValidationError: there is no scene, an id occurs twice, a sky is missing, or skies differ in size.
    """
    if not scenes:
        raise v.fail("bank", "no scene", "at least one", "compile a scene first")
    v.unique((s.scene_id for s in scenes), "bank scenes")
    for split in splits:
        v.choice(split, "bank split", SPLITS)
    hulls, meshes, categories = _Library(), _Library(), _Library()
    hull_rows = [_hull_rows(s, hulls) for s in scenes]
    mesh_rows = [np.array([_mesh_row(m, meshes) for m in s.meshes], np.int32) for s in scenes]
    slots, object_slots, object_ids = _slots(scenes, mesh_rows, categories)
    arrays = {
        **hull_table(hulls.items),
        **_instances(scenes, hull_rows, object_slots),
        **_prisms(scenes, hull_rows),
        **_grid_arrays(scenes, hull_rows, hulls.items),
        **_map_arrays(scenes),
        **_episode_arrays(scenes),
        **_mesh_arrays(meshes.items),
        **slots,
        **_sky_arrays(scenes, skies),
    }
    meta = {
        "scene_ids": [s.scene_id for s in scenes],
        "splits": list(splits),
        "categories": list(categories.items),
        "skies": sorted({s.sky for s in scenes}),
        "object_ids": object_ids,
        "hashes": dict(hashes or {}),
        "grid_reach": grids.REACH,
    }
    return SceneBank(**arrays, meta=meta)


def with_agents(bank: SceneBank, appearances: Sequence[AgentAppearance]) -> SceneBank:
    """Replaces the appearances of moving people and vehicles in a bank.

    Raises:
      ValidationError: there is no appearance.
    """
    if not appearances:
        raise v.fail("bank agents", "no appearance", "at least one")
    arrays, extra = bank.arrays(), _mesh_arrays([appearance.mesh for appearance in appearances])
    names = list(dict.fromkeys([*bank.meta["categories"], *(appearance.category for appearance in appearances)]))
    agents = {
        "kind": [appearance.kind for appearance in appearances],
        "mesh": [bank.num_meshes + i for i in range(len(appearances))],
        "category": [names.index(appearance.category) for appearance in appearances],
    }
    joined = {name: bank_join.joined(name, [arrays, extra]) for name in extra}
    return dataclasses.replace(bank, **joined, meta={**bank.meta, "categories": names, "agents": agents})


def _hull_rows(scene: SceneGeometry, library: _Library) -> np.ndarray:
    def make(corners: np.ndarray, i: int) -> ConvexPart:
        return convex_part(corners, f"scene {scene.scene_id!r} hull {i}")

    rows = [library.row(_fingerprint(h), lambda h=h, i=i: make(h, i)) for i, h in enumerate(scene.hulls)]
    return np.array(rows, np.int32)


def _mesh_row(mesh: AssetMesh, library: _Library) -> int:
    surface = np.array([mesh.roughness, mesh.metallic], np.float32)
    return library.row(_fingerprint(mesh.vertices, mesh.faces, mesh.uv, mesh.texture, surface), lambda: mesh)


def _instances(scenes: Any, hull_rows: Any, object_slots: Any) -> dict[str, np.ndarray]:
    rotation = [rotations.matrix(s.object_quaternion)[s.inst_object].reshape(-1, 3, 3) for s in scenes]
    inst_rotation = _fill(rotation, 0.0, np.float32)
    for line, rows in zip(inst_rotation, rotation, strict=True):
        line[len(rows) :] = np.eye(3)
    return {
        "inst_hull": _fill([h[s.inst_hull] for s, h in zip(scenes, hull_rows, strict=True)], -1, np.int32),
        "inst_object": _fill([o[s.inst_object] for s, o in zip(scenes, object_slots, strict=True)], -1, np.int32),
        "inst_position": _fill([s.object_position[s.inst_object].reshape(-1, 3) for s in scenes], 0.0, np.float32),
        "inst_rotation": inst_rotation,
        "inst_friction": _fill([s.object_friction[s.inst_object] for s in scenes], 1.0, np.float32),
    }


def _prisms(scenes: Any, hull_rows: Any) -> dict[str, np.ndarray]:
    return {
        "prism_hull": _fill([h[s.prism_hull] for s, h in zip(scenes, hull_rows, strict=True)], -1, np.int32),
        "prism_position": _fill([s.prism_position for s in scenes], 0.0, np.float32),
        "prism_friction": _fill([s.prism_friction for s in scenes], 1.0, np.float32),
        "prism_material_friction": _fill([s.prism_material_friction for s in scenes], 1.0, np.float32),
        "prism_kind": _fill([s.prism_kind for s in scenes], 0, np.int32),
    }


def _grid_arrays(scenes: Any, hull_rows: Any, parts: list[ConvexPart]) -> dict[str, np.ndarray]:
    box = np.stack([p.box for p in parts]).astype(np.float64)
    tables: dict[str, list[Any]] = {"hull_grid": [], "prism_grid": []}
    origins = []
    for scene, rows in zip(scenes, hull_rows, strict=True):
        rotation = rotations.matrix(scene.object_quaternion)[scene.inst_object].reshape(-1, 3, 3)
        hull, prism = box[rows[scene.inst_hull]], box[rows[scene.prism_hull]]
        hull_centre = scene.object_position[scene.inst_object] + np.einsum("nij,nj->ni", rotation, hull[:, 0])
        prism_centre = scene.prism_position + prism[:, 0]
        low = (prism_centre - prism[:, 1]).min(0)[:2]
        high = (prism_centre + prism[:, 1]).max(0)
        origin = np.floor(low / grids.CELL) * grids.CELL - _GRID_MARGIN * grids.CELL
        shape = tuple(np.ceil((high[:2] - origin) / grids.CELL).astype(int) + _GRID_MARGIN)
        eye = np.broadcast_to(np.eye(3), (len(prism), 3, 3))
        ceiling = float(high[2]) + grids.HEADROOM
        tables["hull_grid"].append(grids.build_grid(origin, shape, hull_centre, rotation, hull[:, 1], ceiling=ceiling))
        tables["prism_grid"].append(grids.build_grid(origin, shape, prism_centre, eye, prism[:, 1]))
        origins.append(origin)
    packed = {name: _pack_grids(table) for name, table in tables.items()}
    return {**packed, "grid_origin": np.array(origins, np.float32), "grid_cell": np.array(grids.CELL, np.float32)}


def _pack_grids(tables: list[list[list[list[int]]]]) -> np.ndarray:
    shape = [max(len(t) for t in tables), max(len(t[0]) for t in tables)]
    depth = max([len(cell) for t in tables for row in t for cell in row] + [1])
    out = np.full((len(tables), *shape, depth), -1, np.int32)
    for z, table in enumerate(tables):
        for i, row in enumerate(table):
            for j, cell in enumerate(row):
                out[z, i, j, : len(cell)] = cell
    return out


def _map_arrays(scenes: Any) -> dict[str, np.ndarray]:
    shape = np.array([s.map.kind.shape for s in scenes]).max(0)
    kind = np.zeros((len(scenes), *shape), np.uint8)
    for z, scene in enumerate(scenes):
        x, y = scene.map.kind.shape
        kind[z, :x, :y] = scene.map.kind
    if len({s.map.resolution for s in scenes}) > 1:
        raise v.fail("bank maps", "different resolutions", "one for all scenes", "compile the scenes again")
    origin = np.array([s.map.origin for s in scenes], np.float32)
    return {"map_kind": kind, "map_origin": origin, "map_resolution": np.array(scenes[0].map.resolution, np.float32)}


def _episode_arrays(scenes: Any) -> dict[str, np.ndarray]:
    tables = [s.episodes for s in scenes]
    for scene, table in zip(scenes, tables, strict=True):
        if not len(table):
            raise v.fail(f"scene {scene.scene_id!r}", "no episode", "at least one", "widen its walkable ground")
    most = max(t.waypoints.shape[1] for t in tables)

    def waypoints(table: Any) -> np.ndarray:
        extra = most - table.waypoints.shape[1]
        return np.concatenate([table.waypoints, np.repeat(table.goal[:, None], extra, 1)], 1)

    def rows(arrays: list[np.ndarray], dtype: Any) -> np.ndarray:
        width = max(len(a) for a in arrays)
        return np.stack([np.concatenate([a, np.repeat(a[:1], width - len(a), 0)]) for a in arrays]).astype(dtype)

    return {
        "episode_start": rows([t.start for t in tables], np.float32),
        "episode_goal": rows([t.goal for t in tables], np.float32),
        "episode_waypoints": rows([waypoints(t) for t in tables], np.float32),
        "episode_num_waypoints": rows([t.num_waypoints for t in tables], np.int32),
        "episode_length": rows([t.length for t in tables], np.float32),
        "num_episodes": np.array([len(t) for t in tables], np.int32),
    }


def _mesh_arrays(meshes: list[AssetMesh]) -> dict[str, np.ndarray]:
    materials, textures = _Library(), _Library()
    mesh_material = []
    for mesh in meshes:
        texture = textures.row(_fingerprint(mesh.texture), lambda m=mesh: m.texture)
        surface = (texture, float(mesh.roughness), float(mesh.metallic))
        mesh_material.append(materials.row(surface, lambda s=surface: s))
    surfaces = np.array(materials.items, np.float64).reshape(-1, 3)
    return {
        "mesh_vertices": np.concatenate([m.vertices for m in meshes]),
        "mesh_uv": np.concatenate([m.uv for m in meshes]),
        "mesh_faces": np.concatenate([m.faces for m in meshes]),
        "mesh_vertex_start": _starts([len(m.vertices) for m in meshes], np.int32),
        "mesh_face_start": _starts([len(m.faces) for m in meshes], np.int32),
        "mesh_material": np.array(mesh_material, np.int32),
        "material_texture": surfaces[:, 0].astype(np.int32),
        "material_rgba": np.ones((len(surfaces), 4), np.float32),
        "material_roughness": surfaces[:, 1].astype(np.float32),
        "material_metallic": surfaces[:, 2].astype(np.float32),
        "texture_data": np.concatenate([t.ravel() for t in textures.items]),
        "texture_start": _starts([t.size for t in textures.items], np.int64),
        "texture_shape": np.array([t.shape for t in textures.items], np.int32),
    }


def _starts(sizes: list[int], dtype: Any) -> np.ndarray:
    return np.concatenate([[0], np.cumsum(sizes)]).astype(dtype)


def _slots(scenes: Any, mesh_rows: Any, categories: _Library) -> Any:
    """Slot arrays, the slot of every object, and the object id of every slot ("" = empty)."""
    most = max(len(s.object_ids) for s in scenes)
    ground = max(len(s.region_ids) for s in scenes)
    shape = (len(scenes), most + ground)
    slots = {
        "slot_mesh": np.full(shape, -1, np.int32),
        "slot_position": np.zeros((*shape, 3), np.float32),
        "slot_quaternion": np.tile(np.array([1, 0, 0, 0], np.float32), (*shape, 1)),
        "slot_category": np.full(shape, -1, np.int32),
        "slot_movable": np.zeros(shape, np.uint8),
        "slot_mass": np.zeros(shape, np.float32),
    }
    object_slots, object_ids = [], []
    for z, (scene, rows) in enumerate(zip(scenes, mesh_rows, strict=True)):
        objects = _spread(len(scene.object_ids), most)
        regions = most + _spread(len(scene.region_ids), ground)
        slots["slot_mesh"][z, objects] = rows[scene.object_mesh]
        slots["slot_mesh"][z, regions] = rows[scene.region_mesh]
        slots["slot_position"][z, objects] = scene.object_position
        slots["slot_position"][z, regions] = scene.region_position
        slots["slot_quaternion"][z, objects] = scene.object_quaternion
        slots["slot_movable"][z, objects] = scene.object_movable
        slots["slot_mass"][z, objects] = scene.object_mass
        names = [*scene.object_categories, *(ground_category(k) for k in scene.region_kind)]
        numbers = [categories.row(name, lambda name=name: name) for name in names]
        slots["slot_category"][z, np.concatenate([objects, regions])] = numbers
        names = [""] * shape[1]
        for slot, name in zip([*objects, *regions], [*scene.object_ids, *scene.region_ids], strict=True):
            names[slot] = name
        object_slots.append(objects.astype(np.int32))
        object_ids.append(names)
    return slots, object_slots, object_ids


def _sky_arrays(scenes: Any, skies: Mapping[str, Sky]) -> dict[str, np.ndarray]:
    names = sorted({s.sky for s in scenes})
    for name in names:
        if name not in skies:
            raise v.fail(f"sky {name!r}", "nothing of that name", "one of " + ", ".join(sorted(skies)))
    if len({skies[n].radiance.shape for n in names}) > 1:
        raise v.fail("bank skies", "images of different sizes", "one size for all")
    return {
        "sky_radiance": np.stack([skies[n].radiance for n in names]).astype(np.float32),
        "sky_sun_direction": np.stack([skies[n].sun_direction for n in names]).astype(np.float32),
        "sky_sun_irradiance": np.stack([skies[n].sun_irradiance for n in names]).astype(np.float32),
        "scene_sky": np.array([names.index(s.sky) for s in scenes], np.int32),
        "scene_sky_yaw": np.array([s.sky_yaw for s in scenes], np.float32),
    }
