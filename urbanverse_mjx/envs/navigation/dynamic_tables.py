"""Tables of a bank's scenes for crowds, and their ground heights: made once per bank and cached."""

import concurrent.futures
import hashlib
import pathlib
from collections.abc import Sequence
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int32

from ... import settings, versions
from ...crowds import crossings, flats, free_space, goal_fields, kinds, open_ground
from ...crowds.crowd import CrowdTables, make_tables
from ...datatypes import SceneBank, array_file

#: Cells of the free space along a side of a height cell of 0.2 m, in which a ramp of 1:12 rises by 2 cm.
POOL = 2
_ARRAYS = ("inst_hull", "inst_position", "inst_rotation", "hull_vertices", "prism_hull", "prism_position", "map_kind")


class DynamicTables(NamedTuple):
    """Attributes:
    crowd: see `CrowdTables`; rows are those of the scenes in use. height: (n, X, Y) f32 m; origin: (n, 2) m of its
      cells. row: (Z,) i32, the row of each scene of the bank; 0 for scenes that are not in use.
    """

    crowd: CrowdTables
    height: Float[Array, "n X Y"]
    origin: Float[Array, "n 2"]
    row: Int32[Array, " Z"]


def _parts() -> dict[str, tuple[type, Sequence[str]]]:
    """Name of each part of `CrowdTables`, its class and fields."""
    rows: dict[str, Any] = {f"flats/{name}": flats.Flats for name in kinds.SURFACES}
    rows |= {f"ground/{name}": open_ground.OpenGround for name in kinds.SURFACES}
    rows |= {f"ways/{name}": goal_fields.GoalRoutes for name in goal_fields.RULES}
    rows["crossings"] = crossings.Crossings
    return {name: (cls, cls._fields) for name, cls in rows.items()}


def build_tables(bank: SceneBank, scenes: Sequence[int]) -> dict[str, np.ndarray]:
    """Builds the arrays by name; their rows are `scenes`, because a row takes some 30 MB in a street of 200 m, and of
    the scenes of a bank often few are used."""
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
    found["height"] = ground_heights(bank, scenes)
    return found


def ground_heights(bank: SceneBank, scenes: Sequence[int] | np.ndarray) -> Float[np.ndarray, "n X Y"]:
    """(n, X, Y) f32 m, the ground of some scenes."""

    def height(scene: int) -> np.ndarray:
        return free_space.ground_height(bank, int(scene))[::POOL, ::POOL].astype(np.float32)

    # Most of it are distance transforms, which let other threads go on.
    with concurrent.futures.ThreadPoolExecutor(settings.num_threads()) as pool:
        return np.stack(list(pool.map(height, scenes)))


def rows_of(bank: SceneBank, scenes: Sequence[int] | np.ndarray) -> Int32[np.ndarray, " Z"]:
    """(Z,) i32, the row of each scene of a bank in tables of some scenes; 0 for others, which are not simulated."""
    row = np.zeros(bank.num_scenes, np.int32)
    row[np.asarray(scenes, np.int32)] = np.arange(len(scenes))
    return row


def ground_tables(bank: SceneBank, scenes: Sequence[int] | np.ndarray) -> tuple[Array, Array, Array]:
    """`height`, `origin` and `row` of `DynamicTables`, in the order of `scenes`, for who has no other table of them."""
    origin = jnp.asarray(bank.map_origin[np.asarray(scenes)], jnp.float32)
    return jnp.asarray(ground_heights(bank, scenes)), origin, jnp.asarray(rows_of(bank, scenes))


def path_of(bank: SceneBank, scenes: Sequence[int]) -> pathlib.Path:
    """The file in the cache of the tables of some scenes of a bank."""
    # The layout is part of the key, so that the tables' version, which the caches of routes depend on, stays.
    parts = (versions.of("crowds"), POOL, "row of each scene in use", sorted({int(z) for z in scenes}))
    digest = hashlib.sha256(repr(parts).encode())
    for name in _ARRAYS:
        digest.update(np.ascontiguousarray(getattr(bank, name)).data)
    return settings.cache_dir("crowds", f"{digest.hexdigest()[:24]}.npz")


def kept_tables(bank: SceneBank, scenes: Sequence[int]) -> DynamicTables:
    """`build_tables` with a cache; rows in ascending order of the scenes."""
    scenes = sorted({int(z) for z in scenes})
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
    origin = jnp.asarray(bank.map_origin[scenes], jnp.float32)
    return DynamicTables(crowd, jnp.asarray(arrays["height"]), origin, jnp.asarray(rows_of(bank, scenes)))
