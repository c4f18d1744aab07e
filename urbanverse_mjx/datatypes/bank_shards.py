"""Scene banks as folders: arrays in shards that are mapped into memory, equal ones stored once. Folder: `NAME.bank`.

A file of one bank (`SceneBank.save`) is read as a whole. A folder is opened by its index, and of the shards only what
the chosen scenes need is read, so that a few of a thousand streets take the time and memory of a few.

    index.npz             what follows, sealed by a checksum over all of it
    shard-<token>-0000.bin    pieces of bytes, one behind the other at multiples of 16, at most `SHARD_BYTES` a file

The index holds `pieces` (B,) of `PIECE` (file, offset, size, CRC-32) and, by numbers of pieces, the tables that all
scenes share: hulls (of `hull_dtype` each), meshes (vertices, UV and faces), textures, skies. Of each scene it holds the
pieces and shapes of `PARTS`, without the padding to the largest scene. Pieces are compared by content, so hulls, meshes
and textures of the assets that cousins and other scenes share stand once in a folder, whatever banks they came from.

A piece's checksum is compared when it is first read.
"""

import json
import mmap
import os
import pathlib
import threading
import zlib
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from . import array_file, bank_padding
from . import validation as v

SCHEMA = "urbanverse.scene_bank_shards/1"
#: Ending of the name of a folder.
SUFFIX = ".bank"
INDEX = "index.npz"
#: Largest size of a file of pieces, unless one piece alone is larger.
SHARD_BYTES = 1 << 28
PIECE = np.dtype([("file", "<u2"), ("offset", "<u8"), ("size", "<u8"), ("crc", "<u4")])
#: Arrays of each scene that stand in pieces, by their names in `SceneBank`, with their types and axes.
PARTS = {
    "inst_hull": ("<i4", 1),
    "inst_object": ("<i4", 1),
    "inst_position": ("<f4", 2),
    "inst_rotation": ("<f4", 3),
    "inst_friction": ("<f4", 1),
    "prism_hull": ("<i4", 1),
    "prism_position": ("<f4", 2),
    "prism_friction": ("<f4", 1),
    "prism_material_friction": ("<f4", 1),
    "prism_kind": ("<i4", 1),
    "hull_grid": ("<i4", 3),
    "prism_grid": ("<i4", 3),
    "map_kind": ("|u1", 2),
    "episode_start": ("<f4", 2),
    "episode_goal": ("<f4", 2),
    "episode_waypoints": ("<f4", 3),
    "episode_num_waypoints": ("<i4", 1),
    "episode_length": ("<f4", 1),
    "slot_mesh": ("<i4", 1),
    "slot_position": ("<f4", 2),
    "slot_quaternion": ("<f4", 2),
    "slot_category": ("<i4", 1),
    "slot_movable": ("|u1", 1),
    "slot_mass": ("<f4", 1),
}
#: Largest number of axes of a part.
MAX_AXES = 3
#: Arrays with a few numbers of each scene, and scalars, which stand in the index.
SMALL = ("grid_origin", "map_origin", "num_episodes", "scene_sky", "scene_sky_yaw")
SCALARS = ("grid_cell", "map_resolution")
#: Columns of `mesh_pieces`: what a mesh is made of.
MESH_PARTS = ("mesh_vertices", "mesh_uv", "mesh_faces")
MESH_DTYPES = ("<f4", "<f4", "<i4")
#: Texts of a scene's slots, as JSON: the last column of `scene_pieces`.
OBJECT_IDS = "object_ids"
_TABLES = {
    *("pieces", "hull_piece", "mesh_pieces", "mesh_counts", "mesh_material", "texture_piece", "texture_shape"),
    *("material_texture", "material_rgba", "material_roughness", "material_metallic"),
    *("sky_piece", "sky_sun_direction", "sky_sun_irradiance", "scene_pieces", "scene_shapes", *SMALL, *SCALARS),
}
_META = ("scene_ids", "splits", "categories", "skies", "hashes", "agents", "grid_reach", "shapes", "files")
_DAMAGED = "copy the folder again from where it is whole, or build it again"


def hull_dtype(corners: int, triangles: int) -> np.dtype:
    """The bytes of one hull; corners, triangles: the most that fit, see `SceneBank.hull_vertices`."""
    return np.dtype(
        [
            ("hull_vertices", "<f4", (corners, 3)),
            ("hull_triangles", "<i4", (triangles, 3)),
            ("hull_planes", "<f4", (triangles, 4)),
            ("hull_box", "<f4", (2, 3)),
            ("hull_num_vertices", "<i4"),
            ("hull_num_triangles", "<i4"),
        ]
    )


class BankShards:
    """An opened folder.

    Args:
      path: the folder; only its index is read.

    Attributes:
      meta: of all scenes, see `SceneBank.meta`, without "object_ids"; its "shapes" are the padded shapes of `PARTS`.

    Raises:
      ValidationError: there is no such folder, or its index is damaged or of another version.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = pathlib.Path(path)
        index = self.path / INDEX
        if not index.is_file():
            raise v.fail(
                str(path), f"no {INDEX} in it", "the folder of a scene bank", "write one with `urbanverse scene join`"
            )
        tables = array_file.load(index, "the index of a scene bank", _DAMAGED)
        self.meta = v.parse_json(tables.pop("meta", np.zeros(0, np.uint8)).tobytes(), f"{index}: meta")
        v.choice(self.meta.get("schema"), f"{index}: schema", (SCHEMA,))
        if set(tables) != _TABLES:
            wrong = ", ".join(sorted(_TABLES ^ set(tables)))
            raise v.fail(
                str(index), f"other tables than expected ({wrong})", "a bank of this version", "build it again"
            )
        self._tables = tables
        self._check_index(str(index))
        self._known = np.zeros(len(tables["pieces"]), bool)
        self._files: dict[int, mmap.mmap] = {}
        self._lock = threading.Lock()

    def _check_index(self, where: str) -> None:
        """Refuses an index whose rows are not within its tables."""
        tables, meta = self._tables, self.meta
        v.mapping(meta, f"{where}: meta", _META, ("schema", "materials_unknown", "key"), "write the bank again")
        v.mapping(meta["shapes"], f"{where}: meta.shapes", (*PARTS, "sky", "hull"))
        scenes, pieces = len(meta["scene_ids"]), len(tables["pieces"])
        for name, rows in (
            ("splits", meta["splits"]),
            *((n, tables[n]) for n in ("scene_pieces", "scene_shapes", *SMALL)),
        ):
            if len(rows) != scenes:
                raise v.fail(f"{where}: {name}", f"{len(rows)} rows", f"one for each of {scenes} scenes", _DAMAGED)
        for name, end in (
            *((name, pieces) for name in ("scene_pieces", "hull_piece", "mesh_pieces", "texture_piece", "sky_piece")),
            ("mesh_material", len(tables["material_rgba"])),
            ("material_texture", len(tables["texture_piece"])),
            ("scene_sky", min(len(tables["sky_piece"]), len(meta["skies"]))),
        ):
            least = -1 if name == "material_texture" else 0
            _check_rows(f"{where}: {name}", tables[name], least, end)
        _check_rows(f"{where}: pieces", tables["pieces"]["file"], 0, len(meta["files"]))
        size, counts = tables["pieces"]["size"].astype(np.float64), tables["mesh_counts"].astype(np.float64)
        bytes_of = {
            "texture_shape": (tables["texture_piece"], tables["texture_shape"].astype(np.float64).prod(1)),
            "mesh_counts": (tables["mesh_pieces"], counts[:, [0, 0, 1]] * [12, 8, 12]),
        }
        for name, (rows, wanted) in bytes_of.items():
            if (size[rows] != wanted).any():
                raise v.fail(f"{where}: {name}", "a size that is not its piece's", "the same", _DAMAGED)

    @property
    def scene_ids(self) -> tuple[str, ...]:
        return tuple(self.meta["scene_ids"])

    @property
    def num_scenes(self) -> int:
        return len(self.meta["scene_ids"])

    @property
    def resolution(self) -> float:
        """m, side of a cell of the maps."""
        return float(self._tables["map_resolution"])

    @property
    def num_bytes(self) -> int:
        """Bytes of all pieces."""
        return int(self._tables["pieces"]["size"].sum())

    def counts(self) -> dict[str, int]:
        """How many different hulls, meshes, textures and skies the scenes share."""
        tables = {"hulls": "hull_piece", "meshes": "mesh_pieces", "textures": "texture_piece", "skies": "sky_piece"}
        return {name: len(self._tables[table]) for name, table in tables.items()}

    def scenes_of(self, split: str) -> np.ndarray:
        """(n,) i32: rows of the scenes of a split."""
        return np.array([i for i, s in enumerate(self.meta["splits"]) if s == split], np.int32)

    def rows_of(self, scenes: Iterable[str]) -> np.ndarray:
        """(n,) i32, rows of scenes by their ids.

        Raises:
          ValidationError: an id is unknown.
        """
        numbers = {name: i for i, name in enumerate(self.meta["scene_ids"])}
        wanted = list(scenes)
        for name in wanted:
            if name not in numbers:
                known = ", ".join(self.meta["scene_ids"][:20])
                raise v.fail(str(self.path), f"no scene {name!r}", f"one of its {self.num_scenes} scenes ({known})")
        return np.array([numbers[name] for name in wanted], np.int32)

    @property
    def skies(self) -> np.ndarray:
        """(S, HS, WS, 3) f32: radiance of all skies, see `SceneBank.sky_radiance`."""
        return self._skies(np.arange(len(self._tables["sky_piece"])))["sky_radiance"]

    @property
    def scene_sky(self) -> np.ndarray:
        """(Z,) i32: row of `skies` of each scene."""
        return self._tables["scene_sky"]

    def take(
        self, rows: Sequence[int] | np.ndarray, looks: bool = True
    ) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
        """Arrays and meta of a `SceneBank` of some scenes, which has the shared tables' rows that these use.

        Arrays of scenes are padded as in the bank of all scenes, so their shapes do not depend on the rows.

        Args:
          rows: of the scenes, in this order, each once.
          looks: whether meshes, textures and skies are read; without them all slots are empty.

        Raises:
          ValidationError: there is no such row, or a file is missing or damaged.
        """
        rows = np.asarray(rows, np.int64).reshape(-1)
        if not len(rows) or len(set(rows.tolist())) < len(rows) or rows.min() < 0 or rows.max() >= self.num_scenes:
            found = v.show(rows.tolist())
            raise v.fail(f"{self.path}: scenes", found, f"different rows from 0 to {self.num_scenes - 1}, at least one")
        scenes = {name: self._scenes(name, rows) for name in PARTS}
        scenes |= {name: self._tables[name][rows] for name in SMALL}
        scenes |= {name: self._tables[name] for name in SCALARS}
        agents = {key: list(values) if looks else [] for key, values in self.meta["agents"].items()}
        if not looks:
            scenes["slot_mesh"], scenes["scene_sky"] = (
                np.full_like(scenes["slot_mesh"], -1),
                np.zeros_like(scenes["scene_sky"]),
            )
        for name, table in (("inst_hull", "hull_piece"), ("prism_hull", "hull_piece"), ("slot_mesh", "mesh_pieces")):
            _check_rows(f"{self.path}: {name}", scenes[name], -1, len(self._tables[table]))
        _check_rows(f"{self.path}: meta.agents.mesh", np.array(agents["mesh"]), 0, len(self._tables["mesh_pieces"]))
        hulls = _used(scenes["inst_hull"], scenes["prism_hull"])
        meshes = _used(scenes["slot_mesh"], np.array(agents["mesh"], np.int32))
        skies = _used(scenes["scene_sky"])
        for name, kept in (("inst_hull", hulls), ("prism_hull", hulls), ("slot_mesh", meshes), ("scene_sky", skies)):
            scenes[name] = _renumbered(scenes[name], kept)
        agents["mesh"] = _renumbered(np.array(agents["mesh"], np.int32), meshes).tolist()
        arrays = {**scenes, **self._hulls(hulls), **self._meshes(meshes), **self._skies(skies)}
        return arrays, self._meta(rows, skies, agents)

    def _meta(self, rows: np.ndarray, skies: np.ndarray, agents: dict[str, Any]) -> dict[str, Any]:
        width = self.meta["shapes"]["slot_mesh"][0]
        names = []
        for row in rows:
            own = json.loads(bytes(self._piece(int(self._tables["scene_pieces"][row, -1]), self._of_scene(row))))
            names.append([*own, *[""] * (width - len(own))])
        meta = {key: value for key, value in self.meta.items() if key not in ("schema", "shapes", "files")}
        return {
            **meta,
            "scene_ids": [self.meta["scene_ids"][row] for row in rows],
            "splits": [self.meta["splits"][row] for row in rows],
            "skies": [self.meta["skies"][sky] for sky in skies],
            OBJECT_IDS: names,
            "agents": agents,
        }

    def _scenes(self, name: str, rows: np.ndarray) -> np.ndarray:
        """(n, ...) of one of `PARTS`, padded."""
        dtype, axes = PARTS[name]
        column = list(PARTS).index(name)
        out = np.zeros((len(rows), *self.meta["shapes"][name]), dtype)
        for own, row in zip(out, rows, strict=True):
            shape = tuple(self._tables["scene_shapes"][row, column, :axes].tolist())
            body = self._piece(int(self._tables["scene_pieces"][row, column]), self._of_scene(row))
            bank_padding.fill_up(own, name, self._array(body, dtype, shape, self._of_scene(row)))
        return out

    def _hulls(self, rows: np.ndarray) -> dict[str, np.ndarray]:
        kind = hull_dtype(*self.meta["shapes"]["hull"])
        table = np.empty(len(rows), kind)
        for i, row in enumerate(rows):
            body = self._piece(int(self._tables["hull_piece"][row]), "a hull")
            table[i] = self._array(body, kind, (), "a hull")
        return {name: np.ascontiguousarray(table[name]) for name in kind.names or ()}

    def _meshes(self, rows: np.ndarray) -> dict[str, np.ndarray]:
        tables, counts = self._tables, self._tables["mesh_counts"][rows].astype(np.int64)
        arrays: dict[str, np.ndarray] = {}
        widths = (3, 2, 3)
        for part, (name, dtype, width) in enumerate(zip(MESH_PARTS, MESH_DTYPES, widths, strict=True)):
            ends = np.cumsum([0, *counts[:, int(name == "mesh_faces")]])
            arrays[name] = np.empty((int(ends[-1]), width), dtype)
            for row, first, last in zip(rows, ends[:-1], ends[1:], strict=True):
                body = self._piece(int(tables["mesh_pieces"][row, part]), "a mesh")
                arrays[name][first:last] = self._array(body, dtype, (int(last - first), width), "a mesh")
            if name != "mesh_uv":
                arrays["mesh_face_start" if name == "mesh_faces" else "mesh_vertex_start"] = ends.astype(np.int32)
        materials = _used(tables["mesh_material"][rows])
        arrays["mesh_material"] = _renumbered(tables["mesh_material"][rows], materials)
        for name in ("material_rgba", "material_roughness", "material_metallic"):
            arrays[name] = tables[name][materials]
        textures = _used(tables["material_texture"][materials])
        arrays["material_texture"] = _renumbered(tables["material_texture"][materials], textures)
        shapes = tables["texture_shape"][textures]
        ends = np.cumsum([0, *shapes.astype(np.int64).prod(1)])
        arrays |= {"texture_shape": shapes, "texture_start": ends, "texture_data": np.empty(int(ends[-1]), np.uint8)}
        for row, first, last in zip(textures, ends[:-1], ends[1:], strict=True):
            body = self._piece(int(tables["texture_piece"][row]), "a texture")
            arrays["texture_data"][first:last] = self._array(body, "|u1", (int(last - first),), "a texture")
        return arrays

    def _skies(self, rows: np.ndarray) -> dict[str, np.ndarray]:
        shape, tables = tuple(self.meta["shapes"]["sky"]), self._tables
        out = np.empty((len(rows), *shape), np.float32)
        for i, row in enumerate(rows):
            out[i] = self._array(self._piece(int(tables["sky_piece"][row]), "a sky"), "<f4", shape, "a sky")
        suns = {name: tables[name][rows] for name in ("sky_sun_direction", "sky_sun_irradiance")}
        return {"sky_radiance": out, **suns}

    def _of_scene(self, row: int) -> str:
        return f"scene {self.meta['scene_ids'][row]!r}"

    def _array(self, body: memoryview, dtype: Any, shape: tuple[int, ...], what: str) -> np.ndarray:
        try:
            return np.frombuffer(body, dtype).reshape(shape)
        except ValueError as error:
            raise v.fail(f"{self.path}: {what}", f"an array of another size ({error})", "that of its index") from error

    def _piece(self, number: int, what: str) -> memoryview:
        """A piece's bytes; its checksum is compared when it is read for the first time."""
        file, offset, size, crc = self._tables["pieces"][number].item()
        body = memoryview(self._file(file))[offset : offset + size]
        if not self._known[number]:
            if zlib.crc32(body) != crc:
                name = self.path / self.meta["files"][file]["name"]
                raise v.fail(f"{name}: {what}", "damaged bytes (their checksum is another one)", "whole ones", _DAMAGED)
            self._known[number] = True
        return body

    def _file(self, number: int) -> mmap.mmap:
        with self._lock:
            if number not in self._files:
                entry = self.meta["files"][number]
                path = self.path / entry["name"]
                try:
                    with path.open("rb") as file:
                        mapped = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
                except (OSError, ValueError) as error:
                    found = f"a file that is missing or cannot be read ({error})"
                    raise v.fail(str(path), found, "a shard of the bank", _DAMAGED) from error
                if len(mapped) != entry["bytes"]:
                    found, needed = f"{len(mapped)} bytes", f"the {entry['bytes']} of a whole shard"
                    raise v.fail(str(path), found, needed, _DAMAGED)
                self._files[number] = mapped
            return self._files[number]


def _check_rows(where: str, rows: np.ndarray, least: int, end: int) -> None:
    if rows.size and (int(rows.min()) < least or int(rows.max()) >= end):
        raise v.fail(where, "a row outside its table", f"[{least}, {end})", _DAMAGED)


def _used(*indices: np.ndarray) -> np.ndarray:
    """(n,) rising: the rows to which index arrays point, without -1."""
    rows = np.unique(np.concatenate([a.reshape(-1) for a in indices]))
    return rows[rows >= 0].astype(np.int64)


def _renumbered(indices: np.ndarray, kept: np.ndarray) -> np.ndarray:
    """The same rows by their places among those that are kept."""
    return np.where(indices >= 0, np.searchsorted(kept, indices), -1).astype(np.int32)
