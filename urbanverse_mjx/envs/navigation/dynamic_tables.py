"""Tables of a bank's scenes for crowds, and their ground heights: made once per bank and cached."""

import hashlib
import pathlib
from collections.abc import Sequence
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ... import settings, versions
from ...crowds import crossings, flats, free_space, goal_fields, kinds, open_ground
from ...crowds.crowd import CrowdTables, make_tables
from ...datatypes import SceneBank, array_file

#: Cells of the free space along a side of a height cell of 0.2 m, in which a ramp of 1:12 rises by 2 cm.
POOL = 2
_ARRAYS = ("inst_hull", "inst_position", "inst_rotation", "hull_vertices", "prism_hull", "prism_position", "map_kind")


class DynamicTables(NamedTuple):
    """Attributes:
    crowd: see `CrowdTables`; rows are those of the bank. height: (Z, X, Y) f32 m; origin: (Z, 2) m of its cells.
    """

    crowd: CrowdTables
    height: Float[Array, "Z X Y"]
    origin: Float[Array, "Z 2"]


def _parts() -> dict[str, tuple[type, Sequence[str]]]:
    """Name of each part of `CrowdTables`, its class and fields."""
    rows: dict[str, Any] = {f"flats/{name}": flats.Flats for name in kinds.SURFACES}
    rows |= {f"ground/{name}": open_ground.OpenGround for name in kinds.SURFACES}
    rows |= {f"ways/{name}": goal_fields.GoalRoutes for name in goal_fields.RULES}
    rows["crossings"] = crossings.Crossings
    return {name: (cls, cls._fields) for name, cls in rows.items()}


def build_tables(bank: SceneBank, scenes: Sequence[int]) -> dict[str, np.ndarray]:
    """Builds the arrays by name; rows of scenes other than `scenes` are empty, because they are not simulated."""
    tables = make_tables(bank, scenes)
    groups: dict[str, Any] = {f"flats/{n}": t for n, t in tables.flats.items()}
    groups |= {f"ground/{n}": t for n, t in tables.ground.items()}
    groups |= {f"ways/{n}": t for n, t in tables.routes.items()}
    groups["crossings"] = tables.crossings
    found = {
        f"{name}/{field}": np.asarray(getattr(groups[name], field))
        for name, (_, fields) in _parts().items()
        for field in fields
    }
    found["height"] = np.stack([free_space.ground_height(bank, z)[::POOL, ::POOL] for z in scenes]).astype(np.float32)
    out = {}
    for name, rows in found.items():
        out[name] = np.zeros((bank.num_scenes, *rows.shape[1:]), rows.dtype)
        out[name][np.asarray(scenes)] = rows
    return out


def path_of(bank: SceneBank, scenes: Sequence[int]) -> pathlib.Path:
    """The file in the cache of the tables of some scenes of a bank."""
    parts = (versions.of("crowds"), POOL, sorted(int(z) for z in scenes))
    digest = hashlib.sha256(repr(parts).encode())
    for name in _ARRAYS:
        digest.update(np.ascontiguousarray(getattr(bank, name)).data)
    return settings.cache_dir("crowds", f"{digest.hexdigest()[:24]}.npz")


def kept_tables(bank: SceneBank, scenes: Sequence[int]) -> DynamicTables:
    """`build_tables` with a cache."""
    path = path_of(bank, scenes)
    names = ["height", *(f"{name}/{field}" for name, (_, fields) in _parts().items() for field in fields)]
    arrays = array_file.load_cached(path, "tables of crowds", names)
    if arrays is None:
        arrays = build_tables(bank, scenes)
        array_file.save_cached(path, arrays)
    parts = {
        name: cls(*(jnp.asarray(arrays[f"{name}/{field}"]) for field in fields))
        for name, (cls, fields) in _parts().items()
    }
    crowd = CrowdTables(
        flats={name: parts[f"flats/{name}"] for name in kinds.SURFACES},
        ground={name: parts[f"ground/{name}"] for name in kinds.SURFACES},
        routes={name: parts[f"ways/{name}"] for name in goal_fields.RULES},
        crossings=parts["crossings"],
    )
    return DynamicTables(crowd, jnp.asarray(arrays["height"]), jnp.asarray(bank.map_origin, jnp.float32))
