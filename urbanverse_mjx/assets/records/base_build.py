"""Builds every recipe's variants in a pool of processes: the records of the base index and their measures."""

from collections.abc import Callable

from urbanverse_mjx.datatypes import AssetRecord
from urbanverse_mjx.process_pool import worker_pool

from ..meshes.base_shapes import BaseShape, measure
from ..meshes.recipe import all_recipes, get_recipe
from .index import AssetIndex, make_record

CHUNK = 4  # variants per task of a process


def build_base(
    jobs: int = 2, progress: Callable[[int, int], object] = lambda done, total: None
) -> tuple[AssetIndex, list[BaseShape]]:
    """Builds and measures every variant of every recipe.

    Args:
      jobs: number of parallel processes.
      progress: called with (variants done, variants in all).
    """
    tasks = [(recipe.name, recipe.leaf, k) for recipe in all_recipes() for k in range(recipe.variants)]
    records, shapes = [], []
    with worker_pool(jobs) as pool:
        for done, (record, shape) in enumerate(pool.map(_work, tasks, chunksize=CHUNK), 1):
            records.append(record)
            shapes.append(shape)
            progress(done, len(tasks))
    return AssetIndex(records), shapes


def _work(task: tuple[str, str, int]) -> tuple[AssetRecord, BaseShape]:
    name, leaf, variant = task
    recipe = get_recipe(name, leaf)
    built = recipe.build(variant)
    record = make_record(recipe, variant, built)
    return record, measure(record.uid, built, recipe.physics is not None or built.mass is not None)
