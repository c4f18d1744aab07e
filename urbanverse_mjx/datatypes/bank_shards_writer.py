"""Writes scene banks as folders (`bank_shards`), bank by bank, so that no more than one of them is in memory."""

import hashlib
import json
import os
import pathlib
import secrets
import types
import zlib
from collections.abc import Mapping
from typing import Any, BinaryIO

import numpy as np

from . import array_file, bank_padding
from . import validation as v
from .bank_shards import (
    INDEX,
    MAX_AXES,
    MESH_DTYPES,
    MESH_PARTS,
    OBJECT_IDS,
    PARTS,
    PIECE,
    SCALARS,
    SCHEMA,
    SHARD_BYTES,
    SMALL,
    SUFFIX,
    hull_dtype,
)

_ALIGNMENT = 16
_SHARDS = "shard-*.bin"
_SURFACE = ("material_rgba", "material_roughness", "material_metallic")
_SUN = ("sky_sun_direction", "sky_sun_irradiance")


class BankShardsWriter:
    """A folder that is being written; readers see it when the block ends without an exception.

        with BankShardsWriter("streets.bank") as writer:
            for bank in banks:
                writer.add(bank.arrays(), bank.meta)

    Files of an older bank in the folder, and of writers that were killed, are removed at the end.

    Args:
      path: the folder; its name ends in .bank.

    Attributes:
      scene_ids, splits: of the scenes so far; splits may be changed.

    Raises:
      ValidationError: the name has another ending, or the folder holds other files.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = pathlib.Path(path)
        if self.path.suffix != SUFFIX:
            raise v.fail(str(path), "another ending", f"a folder whose name ends in {SUFFIX}")
        if self.path.exists() and not self._is_ours():
            raise v.fail(
                str(path), "something that is not a scene bank", "a new folder, or one of a bank", "take another name"
            )
        self.scene_ids: list[str] = []
        self.splits: list[str] = []
        #: Hulls of objects and ground prisms in all scenes.
        self.counts = {"hulls": 0, "prisms": 0}
        self._token = secrets.token_hex(4)
        self._files: list[dict[str, Any]] = []
        self._file: BinaryIO | None = None
        self._pieces: list[tuple[int, int, int, int]] = []
        self._numbers: dict[bytes, int] = {}
        self._items: dict[str, dict[Any, int]] = {name: {} for name in ("hull", "texture", "material", "mesh", "sky")}
        self._skies: dict[str, list[Any]] = {"names": [], **{name: [] for name in _SUN}}
        self._scenes: dict[str, list[Any]] = {name: [] for name in ("pieces", "shapes", *SMALL)}
        self._categories: dict[str, int] = {}
        self._meta: dict[str, Any] = {}
        self._shapes: dict[str, list[int]] = {name: [0] * axes for name, (_, axes) in PARTS.items()}
        self._scalars: dict[str, np.ndarray] = {}

    def __enter__(self) -> "BankShardsWriter":
        self.path.mkdir(parents=True, exist_ok=True)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: types.TracebackType | None
    ) -> None:
        if self._file is not None:
            v.sync(pathlib.Path(self._file.name))
            self._file.close()
        try:
            if error is None:
                self._write_index()
        finally:
            self._remove_others()

    def add(self, arrays: Mapping[str, np.ndarray], meta: Mapping[str, Any]) -> None:
        """Adds all scenes of a bank.

        The appearances of moving agents are those of the first bank that has any.

        Args:
          arrays, meta: as `SceneBank` describes them, checked.

        Raises:
          ValidationError: a scene of this id is there already, or grids, maps, skies or hulls are of other sizes than
            those of the banks before.
        """
        self._check_alike(arrays, meta)
        v.unique([*self.scene_ids, *meta["scene_ids"]], "bank scenes")
        categories = [self._categories.setdefault(name, len(self._categories)) for name in meta["categories"]]
        agents = meta.get("agents", {"kind": [], "mesh": [], "category": []})
        adopted = not self._meta.get("agents", {}).get("kind") and agents["kind"]
        hulls = self._add_hulls(arrays)
        meshes = self._add_meshes(arrays, agents["mesh"] if adopted else [])
        skies = self._add_skies(arrays, meta["skies"])
        rows = {
            "inst_hull": hulls,
            "prism_hull": hulls,
            "slot_mesh": meshes,
            "slot_category": np.array([*categories, -1], np.int32),
        }
        if adopted:
            theirs = {"mesh": meshes[agents["mesh"]].tolist(), "category": [categories[c] for c in agents["category"]]}
            self._meta["agents"] = {**agents, **theirs}
        self._meta.setdefault("agents", dict(agents))
        self._meta["hashes"] = self._meta.get("hashes", {}) | meta["hashes"]
        if "materials_unknown" in meta:
            self._meta["materials_unknown"] = meta["materials_unknown"]
        self._meta["key"] = "" if self.scene_ids else meta.get("key", "")
        for z, names in enumerate(meta[OBJECT_IDS]):
            self._add_scene(arrays, z, rows, names)
        self._scenes["scene_sky"][-len(meta["scene_ids"]) :] = skies[arrays["scene_sky"]]
        self.scene_ids += meta["scene_ids"]
        self.splits += meta["splits"]
        for name, key in (("hulls", "inst_hull"), ("prisms", "prism_hull")):
            self.counts[name] += int((arrays[key] >= 0).sum())

    def _check_alike(self, arrays: Mapping[str, np.ndarray], meta: Mapping[str, Any]) -> None:
        own = {
            "grid cells (m)": round(float(arrays["grid_cell"]), 6),
            "map cells (m)": round(float(arrays["map_resolution"]), 6),
            "grid reaches (m)": round(float(meta["grid_reach"]), 6),
            "sky images": arrays["sky_radiance"].shape[1:],
            "hulls": (arrays["hull_vertices"].shape[1], arrays["hull_triangles"].shape[1]),
        }
        known = self._meta.setdefault("alike", own)
        for what, value in own.items():
            if known[what] != value:
                raise v.fail(
                    f"{self.path}: {what}", f"{known[what]} and {value}", "the same", "build them with one version"
                )
        if not self._scalars:
            self._scalars = {name: np.asarray(arrays[name]) for name in SCALARS}
            self._meta["grid_reach"] = meta["grid_reach"]
            self._shapes["sky"], self._shapes["hull"] = list(own["sky images"]), list(own["hulls"])

    def _add_scene(
        self, arrays: Mapping[str, np.ndarray], z: int, rows: Mapping[str, np.ndarray], names: list[str]
    ) -> None:
        pieces, shapes = [], []
        for name, (dtype, axes) in PARTS.items():
            whole = np.ascontiguousarray(arrays[name][z], dtype)
            if name in rows:
                whole = np.where(whole >= 0, rows[name][whole], -1).astype(dtype)
            part = self._trimmed(name, whole)
            pieces.append(self._piece(part.tobytes()))
            shapes.append([*part.shape, *[0] * (MAX_AXES - axes)])
            self._shapes[name] = [max(pair) for pair in zip(self._shapes[name], whole.shape, strict=True)]
        filled = [i for i, text in enumerate(names) if text]
        own = names[: filled[-1] + 1] if filled else []
        pieces.append(self._piece(json.dumps(own, ensure_ascii=False).encode("utf-8")))
        self._scenes["pieces"].append(pieces)
        self._scenes["shapes"].append(shapes)
        for name in SMALL:
            self._scenes[name].append(arrays[name][z])

    @staticmethod
    def _trimmed(name: str, whole: np.ndarray) -> np.ndarray:
        """The part from which padding makes all of it; all of it where that is not so."""
        part = bank_padding.trimmed(name, whole)
        again = np.empty_like(whole)
        bank_padding.fill_up(again, name, part)
        return part if again.tobytes() == whole.tobytes() else whole

    def _add_hulls(self, arrays: Mapping[str, np.ndarray]) -> np.ndarray:
        """Adds the hulls in use; returns the number of each row of the table here, -1 if not in use."""
        kind = hull_dtype(*self._shapes["hull"])
        used = np.unique(np.concatenate([arrays[name].reshape(-1) for name in ("inst_hull", "prism_hull")]))
        numbers, record = np.full(len(arrays["hull_vertices"]), -1, np.int32), np.zeros((), kind)
        for row in used[used >= 0]:
            for name in kind.names or ():
                record[name] = arrays[name][row]
            numbers[row] = self._item("hull", self._piece(record.tobytes()))
        return numbers

    def _add_meshes(self, arrays: Mapping[str, np.ndarray], also: list[int]) -> np.ndarray:
        """Adds the meshes in use and some others with their materials and textures; returns their numbers here."""
        used = np.unique(np.concatenate([arrays["slot_mesh"].reshape(-1), np.array(also, np.int32)]))
        numbers = np.full(len(arrays["mesh_material"]), -1, np.int32)
        materials: dict[int, int] = {}
        for row in used[used >= 0]:
            pieces, counts = [], []
            for name, dtype in zip(MESH_PARTS, MESH_DTYPES, strict=True):
                start = arrays["mesh_face_start" if name == "mesh_faces" else "mesh_vertex_start"]
                part = np.ascontiguousarray(arrays[name][start[row] : start[row + 1]], dtype)
                pieces.append(self._piece(part.tobytes()))
                counts.append(len(part))
            material = int(arrays["mesh_material"][row])
            if material not in materials:
                materials[material] = self._add_material(arrays, material)
            numbers[row] = self._item("mesh", (*pieces, counts[0], counts[2], materials[material]))
        return numbers

    def _add_material(self, arrays: Mapping[str, np.ndarray], row: int) -> int:
        texture = int(arrays["material_texture"][row])
        if texture >= 0:
            first, last = arrays["texture_start"][texture : texture + 2]
            shape = tuple(arrays["texture_shape"][texture].tolist())
            texture = self._item("texture", (self._piece(arrays["texture_data"][first:last].tobytes()), *shape))
        surface = [np.asarray(arrays[name][row], np.float32).tobytes() for name in _SURFACE]
        return self._item("material", (texture, *surface))

    def _add_skies(self, arrays: Mapping[str, np.ndarray], names: list[str]) -> np.ndarray:
        numbers = np.full(len(names), -1, np.int32)
        for row in np.unique(arrays["scene_sky"]):
            body = np.ascontiguousarray(arrays["sky_radiance"][row], "<f4").tobytes()
            suns = [np.asarray(arrays[name][row], np.float32) for name in _SUN]
            before = len(self._items["sky"])
            numbers[row] = self._item("sky", (self._piece(body), names[row], *(sun.tobytes() for sun in suns)))
            if numbers[row] == before:
                self._skies["names"].append(names[row])
                for name, sun in zip(_SUN, suns, strict=True):
                    self._skies[name].append(sun)
        return numbers

    def _item(self, table: str, content: Any) -> int:
        """The number of a row of a shared table, which is added where it is not there yet."""
        rows = self._items[table]
        return rows.setdefault(content, len(rows))

    def _piece(self, body: bytes) -> int:
        """The number of a piece, which is written where none of this content is."""
        digest = hashlib.blake2b(body, digest_size=16).digest()
        if digest not in self._numbers:
            self._numbers[digest] = len(self._pieces)
            if self._file is None or (self._files[-1]["bytes"] and self._files[-1]["bytes"] + len(body) > SHARD_BYTES):
                self._next_file()
            assert self._file is not None
            entry = self._files[-1]
            self._pieces.append((len(self._files) - 1, entry["bytes"], len(body), zlib.crc32(body)))
            padded = body + bytes(-len(body) % _ALIGNMENT)
            self._file.write(padded)
            entry["bytes"] += len(padded)
        return self._numbers[digest]

    def _next_file(self) -> None:
        if self._file is not None:
            v.sync(pathlib.Path(self._file.name))
            self._file.close()
        name = f"shard-{self._token}-{len(self._files):04d}.bin"
        self._files.append({"name": name, "bytes": 0})
        self._file = (self.path / name).open("wb")

    def _write_index(self) -> None:
        if not self.scene_ids:
            raise v.fail(str(self.path), "no scene", "at least one")
        meta = {key: value for key, value in self._meta.items() if key != "alike" and (value or key != "key")}
        meta |= {"schema": SCHEMA, "scene_ids": self.scene_ids, "splits": self.splits, "shapes": self._shapes}
        meta |= {"categories": list(self._categories), "skies": self._skies["names"], "files": self._files}
        mesh = np.array(list(self._items["mesh"]), np.int32).reshape(-1, 6)
        material, texture = list(self._items["material"]), np.array(list(self._items["texture"]), np.int32)
        texture = texture.reshape(-1, 4)
        surface = {
            name: np.array([np.frombuffer(row[1 + i], "<f4") for row in material], np.float32)
            for i, name in enumerate(_SURFACE)
        }
        tables = {
            "meta": np.frombuffer(json.dumps(meta).encode("utf-8"), np.uint8),
            "pieces": np.array(self._pieces, PIECE),
            "hull_piece": np.array(list(self._items["hull"]), np.int32),
            "mesh_pieces": mesh[:, :3],
            "mesh_counts": mesh[:, 3:5],
            "mesh_material": mesh[:, 5],
            "texture_piece": texture[:, 0],
            "texture_shape": texture[:, 1:],
            "material_texture": np.array([row[0] for row in material], np.int32),
            "material_rgba": surface["material_rgba"].reshape(-1, 4),
            "material_roughness": surface["material_roughness"].reshape(-1),
            "material_metallic": surface["material_metallic"].reshape(-1),
            "sky_piece": np.array([row[0] for row in self._items["sky"]], np.int32),
            **{name: np.array(self._skies[name], np.float32).reshape(-1, 3) for name in _SUN},
            "scene_pieces": np.array(self._scenes["pieces"], np.int32),
            "scene_shapes": np.array(self._scenes["shapes"], np.int32),
            **{name: np.array(self._scenes[name]) for name in SMALL},
            **self._scalars,
        }
        array_file.save(
            self.path / INDEX, {name: np.ascontiguousarray(a) if a.ndim else a for name, a in tables.items()}
        )

    def _is_ours(self) -> bool:
        return self.path.is_dir() and (
            (self.path / INDEX).is_file() or all(file.match(_SHARDS) for file in self.path.iterdir())
        )

    def _remove_others(self) -> None:
        """Removes the shards that the index does not name."""
        kept: set[str] = set()
        if (self.path / INDEX).is_file():
            body = array_file.load(self.path / INDEX, "the index of a scene bank", "")["meta"].tobytes()
            kept = {entry["name"] for entry in v.parse_json(body, str(self.path))["files"]}
        for file in self.path.glob(_SHARDS):
            if file.name not in kept:
                file.unlink()
