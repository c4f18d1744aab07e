"""Makes smaller banks from a large one with fewer scenes or hulls, without the scene compiler."""

import dataclasses
from collections.abc import Sequence

import numpy as np

from urbanverse_mjx.datatypes import SceneBank, ValidationError, bank_join

#: Arrays of a bank with a leading scene axis.
_BY_SCENE = ("inst_", "prism_", "grid_origin", "hull_grid", "map_kind", "map_origin", "episode_", "slot_", "scene_sky")


def joined(banks: Sequence[SceneBank]) -> SceneBank:
    """Returns one bank with the scenes of all; a single one is not copied."""
    return bank_join.join(banks) if len(banks) > 1 else banks[0]


def first_scenes(bank: SceneBank, count: int) -> SceneBank:
    """Returns the first `count` scenes with their visible meshes; hulls, textures and skies stay.

    Raises:
      ValidationError: the bank has fewer scenes.
    """
    if not 1 <= count <= bank.num_scenes:
        raise ValidationError(f"--scenes: found {count}, needed 1 to {bank.num_scenes}, the scenes of the bank.")
    arrays = bank.arrays()
    cut = {name: a[:count] for name, a in arrays.items() if name.startswith(_BY_SCENE) or name == "num_episodes"}
    meta = {**bank.meta, **{name: bank.meta[name][:count] for name in ("scene_ids", "splits", "object_ids")}}
    return _without_unseen_meshes(SceneBank(**{**arrays, **cut}, meta=meta))


def _without_unseen_meshes(bank: SceneBank) -> SceneBank:
    """Returns the bank with only the meshes that a slot or agent uses."""
    agents = bank.agents
    used = np.unique(np.concatenate([bank.slot_mesh[bank.slot_mesh >= 0], np.array(agents["mesh"], np.int32)]))
    number = np.full(bank.num_meshes + 1, -1, np.int32)
    number[used] = np.arange(len(used), dtype=np.int32)
    fields = {"slot_mesh": number[bank.slot_mesh], "mesh_material": bank.mesh_material[used]}
    for start, names in (("mesh_vertex_start", ("mesh_vertices", "mesh_uv")), ("mesh_face_start", ("mesh_faces",))):
        bounds = getattr(bank, start)
        rows = np.concatenate([np.arange(bounds[m], bounds[m + 1]) for m in used])
        fields |= {name: getattr(bank, name)[rows] for name in names}
        fields[start] = np.concatenate([[0], np.cumsum(np.diff(bounds)[used])]).astype(bounds.dtype)
    agents = {**agents, "mesh": [int(number[mesh]) for mesh in agents["mesh"]]}
    return dataclasses.replace(bank, **fields, meta={**bank.meta, "agents": agents})


def with_hulls(bank: SceneBank, count: int, seed: int = 0) -> SceneBank:
    """Returns the bank with at most `count` hulls per scene; objects keep theirs in a random order until the limit.

    Visual meshes, the map and the episodes do not change, so costs can be compared.

    Raises:
      ValidationError: `count` below 1.
    """
    if count < 1:
        raise ValidationError(f"--hulls-per-scene: found {count}, needed at least 1.")
    hull, grid = bank.inst_hull.copy(), bank.hull_grid.copy()
    for scene in range(bank.num_scenes):
        rng = np.random.default_rng([seed, scene])
        rank = rng.permutation(int(bank.inst_object[scene].max(initial=0)) + 1)
        present = np.flatnonzero(hull[scene] >= 0)
        order = present[np.argsort(rank[bank.inst_object[scene, present]], kind="stable")]
        hull[scene, order[count:]] = -1
        listed = grid[scene]
        gone = (listed >= 0) & (hull[scene][listed] < 0)
        grid[scene] = np.where(gone, -1, listed)
    # The hulls nearest to a cell's middle stay first, empty entries last.
    order = np.argsort(grid < 0, axis=-1, kind="stable")
    grid = np.take_along_axis(grid, order, -1)
    depth = max(1, int((grid >= 0).sum(-1).max(initial=0)))
    objects = np.where(hull >= 0, bank.inst_object, -1)
    return dataclasses.replace(bank, inst_hull=hull, inst_object=objects, hull_grid=grid[..., :depth])
