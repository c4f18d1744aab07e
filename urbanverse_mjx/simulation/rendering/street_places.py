"""Streets that come and go: what a scene brings, and where it stands in the renderer's tables.

In:   a bank of one scene, in a process with a processor alone; then its arrays. Out: the tables of
`street_kernels.Street` with the scene in a place. When: at an exchange. Kernels and their arguments are those of
streets that stay.

Objects have rows of their place, as many as a scene has slots. Triangles, nodes, texels and what else differs in number
stand in segments of common tables (`segments`); what refers to a row of them is shifted on the way to the device.
"""

import dataclasses
import weakref
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import warp as wp

from ...datatypes import PlacedBank, SceneBank
from ..segments import SegmentTables, put, put_row
from .model import RenderModel, build_render_model, images
from .pbr_private import effective_geom_rgba, resolve_geom_materials, sky_harmonics
from .scenes import digest_of, linear_texels, make_texture, mip_levels, texture_sizes, upload_textures
from .settings import Settings
from .street_batch import Streets, part_textures
from .street_kernels import ENTRY, FACE, OBJECT
from .street_light_native import CELL_BYTES, SHEET, THOUSAND
from .street_tree import EMPTY, LEAF, as_floats

#: Rows of a triangle and of a node, and nodes that are shifted at once.
_TRIANGLE, _NODE, _TOGETHER = 3, 4, 1 << 15
#: Textures that are made at once.
_TEXTURES = 4
_ROW = wp.vec4


class _SceneLooks(Streets):
    """The tables of one scene without anything that moves; on the processor, where its light is baked with them."""

    def __init__(self, bank: SceneBank, settings: Settings, on_host: bool) -> None:
        self.rows: dict[str, np.ndarray] = {}
        self.levels: list[list[np.ndarray]] = []
        self.digests: list[str] = []
        self._on_host = on_host
        model = build_render_model(bank, None)
        self._begin(model, settings)
        self._add_tables(bank, model)

    @property
    def num_mesh_nodes(self) -> int:
        """Nodes of the meshes' trees, behind which those of the scene stand."""
        return self._num_mesh_nodes

    def _keep(self, name: str, rows: np.ndarray) -> None:
        self.rows[name] = np.ascontiguousarray(rows, np.float32)
        super()._keep(name, rows)

    def _keep_bytes(self, name: str, values: np.ndarray) -> None:
        self.rows[name] = values
        super()._keep_bytes(name, values)

    def _upload(self, texture_images: Sequence[np.ndarray]) -> np.ndarray:
        known: dict[str, list[np.ndarray]] = {}
        self.digests = [digest_of(image) for image in texture_images]
        for digest, image in zip(self.digests, texture_images, strict=True):
            if digest not in known:
                known[digest] = mip_levels(linear_texels(image, self._on_host))
            self.levels.append(known[digest])
        return texture_sizes(texture_images)

    def _add_skies(self, radiance: np.ndarray) -> np.ndarray:
        return np.stack([sky_harmonics(image) for image in radiance]).astype(np.float32)


def scene_looks(bank: SceneBank, settings: Settings, sky: int, on_host: bool) -> dict[str, Any]:
    """What the renderer needs of the one scene of a bank.

    Args:
      sky: number of its sky among those of the folder.
      on_host: whether images are drawn by the processor.
    """
    with wp.ScopedDevice("cpu"):
        looks = _SceneLooks(bank, dataclasses.replace(settings, bodies=0), on_host)
        found = {
            **looks.rows,
            "roots": looks.roots.numpy(),
            "labels": looks.labels.numpy(),
            "object_of_slot": looks.object_of_slot.numpy(),
        }
    lights = found["lights"].copy()
    lights[0, 6, 3] = sky
    return {
        **found,
        "lights": lights,
        "num_mesh_nodes": looks.num_mesh_nodes,
        "levels_of_textures": looks.levels,
        "digests": looks.digests,
    }


class PlacedStreets(Streets):
    """`Streets` on Warp's current device, in whose N places scenes are put by `stage`; empty before.

    Args:
      bank: with a row for each place.
      model: of what moves, without the bank's meshes.
    """

    def __init__(self, bank: PlacedBank, model: RenderModel, settings: Settings) -> None:
        self._shared = {
            "nodes": SegmentTables({"nodes": (_ROW, _NODE)}),
            "faces": SegmentTables({"triangles": (_ROW, _TRIANGLE), "faces": (_ROW, FACE)}),
            "entries": SegmentTables({"entries": (_ROW, ENTRY)}),
            "texels": SegmentTables({"texels": (wp.uint8, 2)}),
            "cells": SegmentTables({"cells": (wp.uint8, CELL_BYTES)}),
            "textures": SegmentTables({"textures": (wp.Texture2D, 1)}),
        }
        #: Where the segments of each place begin, and its textures.
        self._held: dict[int, dict[str, int]] = {}
        self._own_textures: dict[int, list[wp.Texture2D]] = {}
        self._known: weakref.WeakValueDictionary[str, wp.Texture2D] = weakref.WeakValueDictionary()
        super().__init__(bank, model, settings)

    @property
    def num_bytes(self) -> int:
        """Bytes of the tables of all places, without textures' texels."""
        fixed = (self._objects, self._balls, self.labels, self.object_of_slot, self._lights, self._sheets)
        return sum(tables.num_bytes for tables in self._shared.values()) + sum(array.capacity for array in fixed)

    @property
    def texture_bytes(self) -> int:
        """Bytes of the different textures of all places, without their smaller copies."""
        each = 16 if wp.get_device().is_cpu else 8
        return sum(each * int(t.width) * int(t.height) for t in list(self._known.values()))

    def _add_tables(self, bank: SceneBank, model: RenderModel) -> None:
        assert isinstance(bank, PlacedBank), "places have a folder"
        places, slots, parts = bank.num_scenes, bank.slot_mesh.shape[1], self.num_parts
        self.objects_of_place, objects = slots, places * slots
        self.street.num_objects = objects
        self._objects = wp.zeros((objects + parts) * OBJECT, dtype=_ROW)
        self._balls = wp.zeros(objects, dtype=_ROW)
        self.labels = wp.zeros(objects + parts, dtype=wp.vec2i)
        self.object_of_slot = wp.full((places, slots), -1, dtype=int)
        self.roots = wp.full(places, EMPTY, dtype=int)
        self._lights, self._sheets = wp.zeros((places, 9), dtype=_ROW), wp.zeros((places, SHEET), dtype=_ROW)
        self.street.object_rows, self.street.balls = self._objects.ptr or 0, self._balls.ptr or 0
        self.street.lights, self.street.sheets = self._lights.ptr or 0, self._sheets.ptr or 0
        # An entry for each object and each part; those of parts of large objects follow.
        self._shared["entries"].take(objects + parts)
        self._textures: list[object] = []
        self._add_skies(bank.folder.skies)
        self._add_moving(model, objects)
        self._add_parts(model, np.arange(model.model.ngeom))
        if self.is_baked:
            self._add_shades(bank, model)
        self._tell()

    def _add_moving(self, model: RenderModel, objects: int) -> None:
        """Meshes, materials and labels of what moves, behind the objects."""
        mjm = model.model
        if not mjm.ngeom:
            return
        rows: dict[str, np.ndarray] = {}
        trees = self.mesh_tables(model.meshes, rows.__setitem__)
        first = {"nodes": self._shared["nodes"].take(len(trees.nodes))}
        first["faces"] = self._shared["faces"].take(len(trees.order))
        nodes = _shifted(trees.nodes, first["nodes"], first["faces"])
        _run(self._shared["nodes"].write("nodes", first["nodes"], nodes))
        for name in ("triangles", "faces"):
            _run(self._shared["faces"].write(name, first["faces"], rows[name]))
        texture_images = list(images(mjm))
        start = self._shared["textures"].take(len(texture_images))
        textures, sizes = upload_textures(texture_images)
        self._put_textures(start, textures, -1)
        texture = part_textures(mjm, 0)
        metallic, roughness, _ = resolve_geom_materials(mjm)
        surfaces = np.zeros((mjm.ngeom, OBJECT, 4), np.float32)
        surfaces[:, 3, :3] = effective_geom_rgba(mjm)[:, :3]
        surfaces[:, 4, 0] = np.where(texture >= 0, texture + start, -1)
        surfaces[:, 4, 1] = np.where(texture >= 0, sizes.max(1)[texture] if len(sizes) else 1.0, 1.0)
        surfaces[:, 4, 2], surfaces[:, 4, 3] = roughness, metallic
        put(self._objects, objects * OBJECT, surfaces.reshape(-1, 4))
        put(self.labels, objects, model.labels)
        entries = np.zeros((mjm.ngeom, ENTRY, 4), np.float32)
        roots = trees.roots[mjm.geom_dataid]
        entries[:, 3, 0] = as_floats(_moved(roots, first["nodes"], first["faces"]))
        entries[:, 3, 1] = as_floats(LEAF + objects + np.arange(mjm.ngeom))
        _run(self._shared["entries"].write("entries", objects, entries))

    def _tell(self) -> None:
        """Tells kernels where the tables stand that may have grown."""
        for tables in self._shared.values():
            for name, array in tables.tables.items():
                if name != "textures":
                    setattr(self.street, name, array.ptr or 0)
        self.textures = self._shared["textures"].tables["textures"]

    def _put_textures(self, start: int, textures: list[wp.Texture2D], place: int) -> None:
        self._own_textures[place] = textures
        if textures:
            table = self._shared["textures"].tables["textures"]
            wp.copy(table, wp.array(textures, dtype=wp.Texture2D), dest_offset=start, count=len(textures))

    def stage(self, place: int, scene: Mapping[str, Any]) -> Generator[None, None, Callable[[], None]]:
        """Copies a scene to rows that nobody reads; returns a function that puts it in its place.

        scene: of `scene_looks`.
        """
        count = len(scene["labels"])
        first = {
            "nodes": self._shared["nodes"].take(len(scene["nodes"])),
            "faces": self._shared["faces"].take(len(scene["faces"])),
            "entries": self._shared["entries"].take(len(scene["entries"]) - count),
            "textures": self._shared["textures"].take(len(scene["digests"])),
        }
        if self.is_baked:
            first["texels"] = self._shared["texels"].take(len(scene["texels"]) // 2)
            first["cells"] = self._shared["cells"].take(len(scene["cells"]) // CELL_BYTES)
        self._tell()
        own = place * self.objects_of_place

        def entry(number: np.ndarray) -> np.ndarray:
            return np.where(number < count, own + number, first["entries"] + number - count)

        yield from self._stage_nodes(scene, first, entry)
        for name in ("triangles", "faces"):
            yield from self._shared["faces"].write(name, first["faces"], scene[name])
        entries = scene["entries"].copy()
        entries[:, 3, 0] = as_floats(_moved(_references(entries[:, 3, 0]), first["nodes"], first["faces"]))
        entries[:, 3, 1] = as_floats(_references(entries[:, 3, 1]) + own)
        yield from self._shared["entries"].write("entries", first["entries"], entries[count:])
        for name in ("texels", "cells") if self.is_baked else ():
            yield from self._shared[name].write(name, first[name], scene[name])
        textures: list[wp.Texture2D] = []
        for digest, levels in zip(scene["digests"], scene["levels_of_textures"], strict=True):
            made = self._known.get(digest)
            if made is None:
                made = self._known[digest] = make_texture(levels)
                if len(textures) % _TEXTURES == 0:
                    yield
            textures.append(made)
        rows = scene["object_rows"].copy()
        rows[:, 4, 0] = np.where(rows[:, 4, 0] >= 0, rows[:, 4, 0] + first["textures"], rows[:, 4, 0])
        yield

        def commit() -> None:
            self._put_textures(first["textures"], textures, place)
            put(self._objects, own * OBJECT, rows.reshape(-1, 4))
            put(self._balls, own, scene["balls"].reshape(-1, 4))
            put(self.labels, own, scene["labels"])
            _run(self._shared["entries"].write("entries", own, entries[:count]))
            slots = scene["object_of_slot"][0]
            put_row(self.object_of_slot, place, np.where(slots >= 0, slots + own, slots))
            put_row(self._lights, place, scene["lights"][0])
            if self.is_baked:
                put_row(self._sheets, place, _sheet(scene["sheets"], first["texels"], first["cells"]))
            put(self.roots, place, _of_scene(scene["roots"], first["nodes"], entry))
            for name, start in self._held.pop(place, {}).items():
                self._shared[name].segments.give_back(start)
            self._held[place] = first
            wp.synchronize_device()

        return commit

    def _stage_nodes(
        self, scene: Mapping[str, Any], first: Mapping[str, int], entry: Callable[[np.ndarray], np.ndarray]
    ) -> Iterator[None]:
        nodes, meshes = scene["nodes"].reshape(-1, _NODE, 4), scene["num_mesh_nodes"]
        for begin, end, of_scene in (*_parts(0, meshes, False), *_parts(meshes, len(nodes), True)):
            part = nodes[begin:end].copy()
            for row in (0, 2):
                found = _references(part[:, row, 3])
                if of_scene:
                    part[:, row, 3] = as_floats(_of_scene(found, first["nodes"], entry))
                else:
                    part[:, row, 3] = as_floats(_moved(found, first["nodes"], first["faces"]))
            yield from self._shared["nodes"].write("nodes", first["nodes"] + begin, part)


def _parts(begin: int, end: int, of_scene: bool) -> list[tuple[int, int, bool]]:
    return [(k, min(k + _TOGETHER, end), of_scene) for k in range(begin, end, _TOGETHER)]


def _run(work: Iterator[None]) -> None:
    for _ in work:
        pass


def _references(column: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(column).view(np.int32)


def _moved(references: np.ndarray, nodes: int, faces: int) -> np.ndarray:
    """References into the trees of meshes, for nodes and triangles that stand so many rows later."""
    return np.where(references < LEAF, references + nodes, references + faces).astype(np.int32)


def _of_scene(references: np.ndarray, nodes: int, entry: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """References into the tree of a scene, whose leaves lead to entries."""
    leaf = np.where(references < LEAF, 0, references - LEAF)
    moved = np.where(references < LEAF, references + nodes, LEAF + entry(leaf))
    return np.where(references >= EMPTY, references, moved).astype(np.int32)


def _shifted(nodes: np.ndarray, first: int, faces: int) -> np.ndarray:
    nodes = nodes.copy()
    for row in (0, 2):
        nodes[:, row, 3] = as_floats(_moved(_references(nodes[:, row, 3]), first, faces))
    return nodes


def _sheet(sheets: np.ndarray, texels: int, cells: int) -> np.ndarray:
    """The rows of a scene in `street_light_native.SHEET`, whose tables begin so many rows later."""
    sheet = sheets.reshape(SHEET, 4).copy()
    sheet[0, 3], sheet[3, 3] = cells // THOUSAND, cells % THOUSAND
    sheet[1, 2], sheet[1, 3] = texels // THOUSAND, texels % THOUSAND
    return sheet
