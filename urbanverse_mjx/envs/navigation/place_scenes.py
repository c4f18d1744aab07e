"""Prepares a scene for a place: everything that needs MuJoCo's compiler, search trees and baked light.

In:   a folder of scenes, a row. Out: a file with the arrays that engine, renderer and environment copy to the device.
When: ahead of an exchange, in a process of its own (`places`): in a thread it would hold the interpreter's lock, which
calls from programs into Warp need.
"""

import dataclasses
import functools
import mmap
import pathlib
import pickle
import time
from typing import Any

import jax
import numpy as np

from ...crowds import open_ground
from ...datatypes import BankShards, SceneBank, traversable
from ...simulation import host_memory
from .schedule import episode_rows
from .surroundings import build_fields

#: Names of the episode tables that episodes are drawn from.
EPISODES = ("episode_start", "episode_goal", "episode_waypoints", "episode_num_waypoints")
#: Bytes; arrays begin at multiples of it.
_ALIGNED = 64


@dataclasses.dataclass(frozen=True)
class Recipe:
    """What a scene is prepared for.

    Attributes:
      folder: of the scenes.
      height: m, of the robot (`Surroundings`).
      materials: whether the ground has the friction of its materials.
      looks: `rendering.settings.Settings`; None where nothing is drawn.
      on_host: whether images are drawn by the processor.
    """

    folder: str
    height: float
    materials: bool
    looks: Any
    on_host: bool


@functools.lru_cache(maxsize=1)
def _opened(folder: str) -> BankShards:
    return BankShards(folder)


def scene_arrays(recipe: Recipe, bank: SceneBank, sky: int) -> dict[str, Any]:
    """Arrays of the one scene of a bank: "physics", "looks" and "tables", those of `NavEnv.held` with one row each.

    Args:
      sky: number of its sky among those of the folder.
    """
    from ...simulation.rendering.street_places import scene_looks
    from ...simulation.warp_engine.places import scene_tables

    tables = (
        {name: getattr(bank, name) for name in EPISODES},
        open_ground.pack(map(traversable, bank.map_kind), bank.map_origin),
        build_fields(bank, recipe.height),
        bank.map_origin,
        *episode_rows(bank),
    )
    looks = None if recipe.looks is None else scene_looks(bank, recipe.looks, sky, recipe.on_host)
    physics = scene_tables(bank, recipe.materials)
    return {"physics": physics, "looks": looks, "tables": jax.tree.map(np.asarray, tables)}


def prepare(recipe: Recipe, row: int, path: str) -> float:
    """Writes the arrays of a scene to a file; returns the seconds that it took."""
    begin, shards = time.monotonic(), _opened(recipe.folder)
    save(pathlib.Path(path), scene_arrays(recipe, SceneBank.take(shards, [row]), int(shards.scene_sky[row])))
    host_memory.give_back()
    return time.monotonic() - begin


def save(path: pathlib.Path, tree: Any) -> None:
    """Writes a tree of arrays to a file that `load` maps into memory."""
    buffers: list[pickle.PickleBuffer] = []
    head = pickle.dumps(tree, protocol=5, buffer_callback=buffers.append)
    sizes = [buffer.raw().nbytes for buffer in buffers]
    with path.open("wb") as file:
        pickle.dump((len(head), sizes), file)
        file.write(head)
        for buffer in buffers:
            file.seek(-file.tell() % _ALIGNED, 1)
            file.write(buffer.raw())
        file.truncate()


def load(path: pathlib.Path) -> Any:
    """The tree of arrays of a file of this process or of one that it started; read from disk when they are used."""
    with path.open("rb") as file:
        size, sizes = pickle.load(file)
        head, at = file.read(size), file.tell()
        body = memoryview(mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ))
    parts = []
    for number in sizes:
        at += -at % _ALIGNED
        parts.append(body[at : at + number])
        at += number
    return pickle.loads(head, buffers=parts)
