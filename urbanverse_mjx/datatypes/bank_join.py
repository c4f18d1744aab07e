"""Joins scene banks to one bank with all their scenes."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from . import validation as v
from .bank_padding import EMPTY
from .scene_bank import SceneBank

#: Index arrays with a leading scene axis -> the array to whose rows they refer.
_INDICES = {
    "inst_hull": "hull_vertices",
    "prism_hull": "hull_vertices",
    "slot_mesh": "mesh_material",
    "mesh_material": "material_texture",
    "material_texture": "texture_shape",
    "scene_sky": "sky_radiance",
}
#: Offset tables -> the array whose parts they delimit.
_STARTS = {
    "mesh_vertex_start": "mesh_vertices",
    "mesh_face_start": "mesh_faces",
    "texture_start": "texture_data",
}
_SCALARS = ("grid_cell", "map_resolution")


def join(banks: Sequence[SceneBank]) -> SceneBank:
    """Joins banks in order.

    Maps are subsampled to the coarsest resolution. Meshes and hulls that two banks share are stored twice.

    Raises:
      ValidationError: no bank, a scene id twice, skies of different sizes, grids of different cells or reach, or map
        resolutions that are no multiples of each other.
    """
    if not banks:
        raise v.fail("join", "no bank", "at least one")
    v.unique((name for bank in banks for name in bank.scene_ids), "joined scenes")
    for what, values in (
        ("sky images", {bank.sky_radiance.shape[1:] for bank in banks}),
        ("grid cells (m)", {round(float(bank.grid_cell), 6) for bank in banks}),
        ("grid reaches (m)", {round(float(bank.meta["grid_reach"]), 6) for bank in banks}),
    ):
        if len(values) > 1:
            raise v.fail("join", f"{what} {sorted(values)}", "the same in all banks", "build them with one version")
    resolution = max(float(bank.map_resolution) for bank in banks)
    parts = [coarse_map(bank, resolution) for bank in banks]
    categories = list(dict.fromkeys(name for bank in banks for name in bank.meta["categories"]))
    for bank, part in zip(banks, parts, strict=True):
        rows = np.array([*(categories.index(name) for name in bank.meta["categories"]), -1], np.int32)
        part["slot_category"] = rows[bank.slot_category]
    arrays = {name: parts[0][name] if name in _SCALARS else joined(name, parts) for name in parts[0]}
    return SceneBank(**arrays, meta=_meta(banks, categories, arrays["slot_mesh"].shape[1]))


def coarse_map(bank: SceneBank, resolution: float) -> dict[str, np.ndarray]:
    """The bank's arrays with a map of every n-th cell, of `resolution` m.

    Raises:
      ValidationError: the resolution is no multiple of the bank's.
    """
    arrays = bank.arrays()
    step = round(resolution / float(bank.map_resolution))
    if abs(step * float(bank.map_resolution) - resolution) > 1e-6:
        found = f"cells of {float(bank.map_resolution):g} and {resolution:g} m"
        raise v.fail("join", found, "multiples of each other", "build one of the banks with another --map-cell")
    middle = slice(step // 2, None, step)
    return {
        **arrays,
        "map_kind": np.ascontiguousarray(bank.map_kind[:, middle, middle]),
        "map_resolution": np.array(resolution, np.float32),
    }


def joined(name: str, parts: Sequence[dict[str, np.ndarray]]) -> np.ndarray:
    """One array of several banks; each of `parts` also holds the tables that its indices count."""
    arrays = [part[name] for part in parts]
    if name in _INDICES:
        before = np.cumsum([0, *(len(part[_INDICES[name]]) for part in parts)])
        arrays = [np.where(a >= 0, a + n, -1).astype(a.dtype) for a, n in zip(arrays, before[:-1], strict=True)]
    if name in _STARTS:
        before = np.cumsum([0, *(len(part[_STARTS[name]]) for part in parts)])
        ends = [a[1:] + n for a, n in zip(arrays, before[:-1], strict=True)]
        return np.concatenate([arrays[0][:1], *ends]).astype(arrays[0].dtype)
    return _stacked(arrays, name)


def _stacked(arrays: Sequence[np.ndarray], name: str) -> np.ndarray:
    """Arrays one after the other along the first axis; shorter other axes are filled up."""
    shapes = [a.shape[1:] for a in arrays]
    if len(set(shapes)) == 1:
        return np.concatenate(arrays)
    shape, fill = tuple(max(sizes) for sizes in zip(*shapes, strict=True)), EMPTY.get(name, 0)
    # The system allocates no memory for zeros that are never written, which saves half of the maps of 200 streets.
    whole, dtype = (sum(len(a) for a in arrays), *shape), arrays[0].dtype
    out = np.full(whole, fill, dtype) if fill else np.zeros(whole, dtype)
    first = 0
    for array in arrays:
        block = out[first : first + len(array)]
        if name == "map_kind":
            for scene, cells in zip(block, array, strict=True):
                _copy_filled(scene, cells)
        else:
            block[tuple(slice(0, n) for n in array.shape)] = array
        if name == "inst_rotation":
            block[:, array.shape[1] :] = np.eye(3)
        if name == "slot_quaternion":
            block[:, array.shape[1] :] = (1.0, 0.0, 0.0, 0.0)
        if name.startswith("episode_") and array.shape[1] < shape[0]:
            block[:, array.shape[1] :] = block[:, :1]
        first += len(array)
    if name == "episode_waypoints":
        return _repeat_last(out, arrays)
    return out


def _copy_filled(out: np.ndarray, cells: np.ndarray) -> None:
    """Copies (X, Y) cells into zeros, without those beyond the last that is not 0 along either axis."""
    used = [np.flatnonzero(cells.any(axis)) for axis in (1, 0)]
    if len(used[0]):
        part = tuple(slice(0, int(rows[-1]) + 1) for rows in used)
        out[part] = cells[part]


def _repeat_last(out: np.ndarray, arrays: Sequence[np.ndarray]) -> np.ndarray:
    first = 0
    for array in arrays:
        block = out[first : first + len(array)]
        count = array.shape[2]
        block[:, :, count:] = block[:, :, count - 1 : count]
        first += len(array)
    return out


def _meta(banks: Sequence[SceneBank], categories: list[str], slots: int) -> dict[str, Any]:
    def rows(name: str) -> list[Any]:
        return [row for bank in banks for row in bank.meta[name]]

    hashes: dict[str, str] = {}
    for bank in banks:
        hashes |= bank.meta["hashes"]
    return {
        "scene_ids": rows("scene_ids"),
        "splits": rows("splits"),
        "categories": categories,
        "skies": rows("skies"),
        "object_ids": [[*names, *[""] * (slots - len(names))] for names in rows("object_ids")],
        "hashes": hashes,
        "grid_reach": banks[0].meta["grid_reach"],
        "agents": _agents(banks, categories),
        **({} if all(bank.knows_materials for bank in banks) else {"materials_unknown": True}),
    }


def _agents(banks: Sequence[SceneBank], categories: list[str]) -> dict[str, list[Any]]:
    """The appearances of the first bank that has any, which are the same in all banks."""
    before = 0
    for bank in banks:
        agents = bank.agents
        if agents["kind"]:
            names = [categories.index(bank.meta["categories"][c]) for c in agents["category"]]
            return {**agents, "mesh": [mesh + before for mesh in agents["mesh"]], "category": names}
        before += bank.num_meshes
    return banks[0].agents
