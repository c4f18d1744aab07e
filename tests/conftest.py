"""Fixtures shared by all rooms."""

import fcntl
import os
import sys
import tempfile

import pytest

from tests.support.box_bank import box_bank
from urbanverse_mjx import settings
from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.pipeline import ensure_default_bank


def pytest_configure(config: pytest.Config) -> None:
    """Sets how XLA compiles in this process, in xdist's workers and in the processes that tests start.

    Compiling takes most of the time of the quick tests: they share compiled programs in a folder that goes with the
    run, and their programs are compiled with few of LLVM's optimizations. Slow tests and those on a GPU compute longer
    than they compile: they run what users run.
    """
    if hasattr(config, "workerinput") or "not slow" not in config.option.markexpr:
        return
    folder = tempfile.TemporaryDirectory(prefix="urbanverse-xla-")
    config.add_cleanup(folder.cleanup)
    options = {
        "jax_disable_most_optimizations": True,
        "jax_compilation_cache_dir": folder.name,
        "jax_persistent_cache_min_compile_time_secs": 0.1,
    }
    for name, value in options.items():
        if name.upper() in os.environ:
            continue
        os.environ[name.upper()] = str(value)
        if "jax" in sys.modules:  # imported by the conftest of a folder: it has read the environment
            sys.modules["jax"].config.update(name, value)


@pytest.fixture(scope="session")
def small_bank() -> SceneBank:
    """Three box streets, built in memory."""
    return box_bank(3, seed=0)


@pytest.fixture(scope="session")
def bank() -> SceneBank:
    """The six shipped streets: from the cache, or built into it by the first test that asks; other processes wait."""
    folder = settings.cache_dir("banks")
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "tests.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        return ensure_default_bank(quiet=True)
