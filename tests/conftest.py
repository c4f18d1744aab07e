"""Fixtures shared by all rooms."""

import fcntl

import pytest

from tests.support.box_bank import box_bank
from urbanverse_mjx import settings
from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.pipeline import ensure_default_bank


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
