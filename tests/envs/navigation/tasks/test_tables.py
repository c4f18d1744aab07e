"""Tables of tasks: none has a large row for streets that are not in use."""

from collections.abc import Iterator, Mapping
from typing import Any

import jax
import numpy as np
import pytest

from tests.support.compiling import optimized
from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.envs import registry
from urbanverse_mjx.envs.navigation.surroundings import Surroundings
from urbanverse_mjx.envs.navigation.tasks import TASKS

#: Bytes that a table may hold for a street that is not in use: numbers of its episodes, not maps.
MOST = 10_000
NAMES = [name for name in registry.ALL_ENVS if registry.get_default_config(name).get("task", None) is not None]


def tables(found: Any, path: str, seen: set[int]) -> Iterator[tuple[str, Any]]:
    """Path and array of all that an object of this package holds, but for the distances that all environments share."""
    if id(found) in seen or isinstance(found, Surroundings | SceneBank):
        return
    seen.add(id(found))
    if isinstance(found, jax.Array | np.ndarray):
        yield path, found
    elif isinstance(found, Mapping):
        for name, value in found.items():
            yield from tables(value, f"{path}/{name}", seen)
    elif isinstance(found, list | tuple):
        names = getattr(found, "_fields", range(len(found)))
        for name, value in zip(names, found, strict=True):
            yield from tables(value, f"{path}/{name}", seen)
    elif type(found).__module__.startswith("urbanverse_mjx"):
        for name, value in getattr(found, "__dict__", {}).items():
            yield from tables(value, f"{path}.{name}", seen)


def test_every_task_has_an_environment() -> None:
    assert {registry.get_default_config(name).task.name for name in NAMES} == set(TASKS) - {"point_goal"}


@pytest.mark.parametrize("name", NAMES)
def test_streets_that_are_not_in_use_take_no_memory(small_bank: SceneBank, name: str) -> None:
    options = {"impl": "jax", "vision": False, "scenes": small_bank.scene_ids[0]}
    config = registry.with_overrides(registry.get_default_config(name, "cpu"), options)
    with optimized():
        env = registry.load_nav_env(name, config, small_bank)
    assert len(env.scenes) == 1
    count = env.bank.num_scenes
    held = list(tables({"task": env.task, "dynamic": env.dynamic}, name, set()))
    assert held
    large = {
        path: (x.shape, x.nbytes // count) for path, x in held if x.shape[:1] == (count,) and x.nbytes > count * MOST
    }
    assert not large
