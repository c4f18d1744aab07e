"""Builds the records and the collision hulls of regional buildings."""

import concurrent.futures
import dataclasses
from collections.abc import Callable

import numpy as np

from urbanverse_mjx.datatypes import AssetRecord
from urbanverse_mjx.process_pool import worker_pool

from ..meshes.mesh_builder import BuiltAsset
from ..meshes.recipe import get_recipe, regional_recipes
from ..recipes.building.regional.buildings import dressed
from ..recipes.building.regional.styles import DRESSINGS
from ..records.index import AssetIndex, make_record, save_index
from ..records.regional import index_path
from .decompose import OPTIONS, decompose
from .hulls import HullStore, hull_budget, mesh_key, regional_store_path

#: m, height from which parts whose box is smaller than the second figure, m^3, have no hulls: railings, sills, cables,
#: washing. A block of flats has a thousand of them, and no robot reaches them.
OVERHEAD, SMALL = 2.2, 0.1


def build_regional(
    jobs: int = 2, progress: Callable[[int, int], object] = lambda done, total: None
) -> tuple[AssetIndex, HullStore]:
    """Builds all variants, writes their index, and makes the hulls that the store lacks.

    Args:
      jobs: number of parallel processes.
      progress: called with (sizes done, sizes in all).
    """
    known = HullStore.load(regional_store_path()).hulls
    tasks = [(r.name, r.leaf, k) for r in regional_recipes() for k in range(0, r.variants, DRESSINGS)]
    records: list[AssetRecord] = []
    found: dict[str, tuple[np.ndarray, ...]] = {}
    done = 0
    for first in range(0, len(tasks), OPTIONS.batch):
        with worker_pool(jobs, niceness=5) as pool:
            futures = [
                pool.submit(_work, *task, set(known) | set(found)) for task in tasks[first : first + OPTIONS.batch]
            ]
            for future in concurrent.futures.as_completed(futures):
                made, key, hulls = future.result()
                records += made
                found[key] = known.get(key, hulls) or found[key]
                done += 1
                progress(done, len(tasks))
        HullStore(dict(known) | found).save(regional_store_path())
    index, store = AssetIndex(records), HullStore(found)
    save_index(index, index_path())
    store.save(regional_store_path())
    return index, store


def _work(name: str, leaf: str, variant: int, known: set[str]) -> tuple[list[AssetRecord], str, tuple[np.ndarray, ...]]:
    """Records of all dressings of a size, and key and hulls of the geometry that they share."""
    recipe = get_recipe(name, leaf)
    built = recipe.build(variant)
    budget = hull_budget(built.mesh, recipe.hulls)
    key = mesh_key(built.mesh, budget)
    hulls = () if key in known else hulls_of(built, budget)
    variants = range(variant, variant + DRESSINGS)
    return [make_record(recipe, k, dressed(name, leaf, k, built)) for k in variants], key, hulls


def hulls_of(built: BuiltAsset, budget: int) -> tuple[np.ndarray, ...]:
    """The hulls of a building without its thin parts overhead; see `decompose`."""
    mesh = built.mesh
    kept, counts, start = [], [], 0
    for count in built.part_faces:
        faces = mesh.faces[start : start + count]
        start += count
        points = mesh.vertices[faces.ravel()]
        size = points.max(0) - points.min(0)
        if points[:, 2].min() < OVERHEAD or np.prod(size) >= SMALL:
            kept.append(faces)
            counts.append(count)
    return decompose(dataclasses.replace(mesh, faces=np.concatenate(kept)), budget, counts)
