"""Checks that the arrays of a scene bank are consistent and indices are within their tables."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from . import validation as v
from .ground import GROUND_KINDS

_HINT = "build the bank again"
#: Name prefixes of arrays whose first axis is the scene.
_BY_SCENE = ("inst_", "prism_", "slot_", "episode_", "map_kind", "hull_grid", "grid_origin", "scene_sky", "num_")


def check_bank(arrays: Mapping[str, np.ndarray], meta: Mapping[str, Any]) -> None:
    """Checks finite numbers, leading axes and every index of a bank.

    Args:
      arrays: as `SceneBank` describes them.
      meta: as there.

    Raises:
      ValidationError: names the first array that is wrong.
    """
    scenes = len(arrays["inst_hull"])
    for key in ("scene_ids", "splits", "object_ids"):
        found = meta.get(key, [])
        if not isinstance(found, list) or len(found) != scenes:
            raise v.fail(f"bank.meta.{key}", v.show(found), f"a list with an entry per scene ({scenes})", _HINT)
    for name, array in arrays.items():
        if array.dtype.kind == "f" and not np.isfinite(array).all():
            raise v.fail(f"bank.{name}", "a NaN or infinity", "finite numbers", _HINT)
        if name.startswith(_BY_SCENE) and array.shape[:1] != (scenes,):
            raise v.fail(f"bank.{name}", f"shape {array.shape}", f"a leading axis of {scenes} scenes", _HINT)
    for name, (low, high) in _limits(arrays, meta).items():
        _check_range(name, arrays[name], low, high)
    _check_starts(arrays)
    agents = meta.get("agents", {})
    for key, table in (("mesh", arrays["mesh_material"]), ("category", meta.get("categories", []))):
        _check_range(f"meta.agents.{key}", np.array(agents.get(key, []), np.int64), 0, len(table))


def _limits(arrays: Mapping[str, np.ndarray], meta: Mapping[str, Any]) -> dict[str, tuple[int, int]]:
    """Index array -> its least valid value, and the first one outside its table."""
    length = {name: len(array) for name, array in arrays.items() if array.ndim}
    across = {name: array.shape[1] for name, array in arrays.items() if array.ndim > 1}
    return {
        "hull_num_vertices": (1, across["hull_vertices"] + 1),
        "hull_num_triangles": (1, across["hull_triangles"] + 1),
        "hull_triangles": (0, across["hull_vertices"]),
        "inst_hull": (-1, length["hull_vertices"]),
        "inst_object": (-1, across["slot_mesh"]),
        "prism_hull": (-1, length["hull_vertices"]),
        "prism_kind": (0, len(GROUND_KINDS)),
        "hull_grid": (-1, across["inst_hull"]),
        "prism_grid": (-1, across["prism_hull"]),
        "map_kind": (0, len(GROUND_KINDS)),
        "episode_num_waypoints": (1, arrays["episode_waypoints"].shape[2] + 1),
        "num_episodes": (1, across["episode_start"] + 1),
        "mesh_material": (0, length["material_texture"]),
        "material_texture": (-1, length["texture_shape"]),
        "slot_mesh": (-1, length["mesh_material"]),
        "slot_category": (-1, len(meta.get("categories", ()))),
        "scene_sky": (0, length["sky_radiance"]),
    }


def _check_range(name: str, array: np.ndarray, low: int, high: int) -> None:
    """Checks that every value of an index array lies in [low, high)."""
    if array.dtype.kind not in "iu":
        raise v.fail(f"bank.{name}", f"numbers of type {array.dtype}", "whole numbers", _HINT)
    below = array.dtype.kind == "i" or low > 0  # the least of unsigned numbers is no index before 0
    if array.size and (int(array.max()) >= high or (below and int(array.min()) < low)):
        raise v.fail(f"bank.{name}", "an index outside its table", f"[{low}, {high})", _HINT)


def _check_starts(arrays: Mapping[str, np.ndarray]) -> None:
    """Checks the offsets of meshes and textures, and that faces use corners of their own mesh."""
    meshes, textures = len(arrays["mesh_material"]), len(arrays["texture_shape"])
    for starts, parts, count in (
        ("mesh_vertex_start", "mesh_vertices", meshes),
        ("mesh_face_start", "mesh_faces", meshes),
        ("texture_start", "texture_data", textures),
    ):
        rows, end = arrays[starts], len(arrays[parts])
        whole = rows.shape == (count + 1,) and rows[0] == 0 and rows[-1] == end and (np.diff(rows) >= 0).all()
        if not whole:
            raise v.fail(f"bank.{starts}", v.show(rows), f"{count + 1} rising numbers from 0 to {end}", _HINT)
    if (arrays["texture_shape"].prod(1) != np.diff(arrays["texture_start"])).any():
        raise v.fail("bank.texture_shape", "a size that is not its texture's", "height x width x 3", _HINT)
    # Seen as unsigned, a negative index is too large as well.
    faces = np.ascontiguousarray(arrays["mesh_faces"], np.int32).view(np.uint32)
    some = np.flatnonzero(np.diff(arrays["mesh_face_start"]))
    first = arrays["mesh_face_start"][some].astype(np.int64) * faces.shape[1]
    corners = np.diff(arrays["mesh_vertex_start"])[some]
    if len(some) and (np.maximum.reduceat(faces.reshape(-1), first) >= corners).any():
        raise v.fail("bank.mesh_faces", "an index outside its mesh", "corners of the face's own mesh", _HINT)
