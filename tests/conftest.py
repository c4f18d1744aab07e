"""Fixtures shared by all packages."""

import fcntl
import gc
import importlib.util
import os
import pathlib
import random
import sys

import pytest

from tests.support.box_bank import box_bank
from tests.support.engine_versions import HAS_MJX
from tests.support.kept_programs import remove_least_recent
from urbanverse_mjx import settings
from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.pipeline import ensure_default_bank

TESTS = pathlib.Path(__file__).parent
#: Bytes of compiled programs that are kept for later runs.
KEPT = 2**30
#: Folders whose tests take a second each or more, by their total time.
LONG = (
    *("envs", "simulation", "training", "project", "crowds", "cli", "benchmarks", "robots", "gym", "evaluation"),
    *("assets", "scene", "distillation", "pipeline", "viewer"),
)


def programs_folder() -> pathlib.Path:
    """Where compiled programs are kept."""
    return settings.cache_dir("tests", "jax")


def pytest_addoption(parser: pytest.Parser) -> None:
    """Adds `--shuffle SEED`."""
    description = "run the modules, and the tests of each, in an order drawn from a seed"
    parser.addoption("--shuffle", type=int, metavar="SEED", help=description)


def pytest_configure(config: pytest.Config) -> None:
    """Sets how XLA compiles in this process, in xdist's workers and in the processes that tests start.

    Compiling takes most of the time of the quick tests: they share compiled programs in a folder of the cache, which
    later runs use again (JAX's keys hold the program, its options and its own version), and their programs are compiled
    with few of LLVM's optimizations. Slow tests and those on a GPU compute longer than they compile: they run what
    users run.

    Nothing that is imported dies, so Python's collector waits until the tests begin.

    Bytecode is kept, as by `make test`: without it each of the processes that tests start compiles the packages that
    it imports anew, for up to ten seconds.
    """
    gc.disable()
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    sys.dont_write_bytecode = False
    if hasattr(config, "workerinput") or "not slow" not in config.option.markexpr:
        return
    options = {
        "jax_disable_most_optimizations": True,
        "jax_compilation_cache_dir": str(programs_folder()),
        "jax_compilation_cache_max_size": -1,  # `pytest_unconfigure` sees to it
        "jax_persistent_cache_min_compile_time_secs": 0,
    }
    for name, value in options.items():
        if name.upper() in os.environ:
            continue
        os.environ[name.upper()] = str(value)
        if "jax" in sys.modules:  # imported by the conftest of a folder: it has read the environment
            sys.modules["jax"].config.update(name, value)


def pytest_unconfigure(config: pytest.Config) -> None:
    """Bounds the folder of compiled programs, once after a run."""
    if not hasattr(config, "workerinput"):
        remove_least_recent(programs_folder(), KEPT)


def shuffled(items: list[pytest.Item], seed: int) -> list[pytest.Item]:
    """Modules in any order, and the tests of each: none may need another one, nor be harmed by it."""
    draw, modules = random.Random(seed), dict[pathlib.Path, list[pytest.Item]]()
    for item in items:
        modules.setdefault(item.path, []).append(item)
    order = list(modules.values())
    draw.shuffle(order)
    return [item for module in order for item in draw.sample(module, len(module))]


@pytest.hookimpl(trylast=True)  # when slow tests are out of the list
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Deals the folders of long tests to xdist's workers, so that quick tests are left when the first worker is done.

    Each worker begins with a part of the list, all of them equally long; whole folders share fixtures.
    """
    seed = config.getoption("shuffle")
    if seed is not None:
        items[:] = shuffled(items, seed)
        return
    workers = getattr(config, "workerinput", {}).get("workercount", 1)
    if workers == 1:
        return
    folders: dict[str, list[pytest.Item]] = {}
    for item in items:
        folders.setdefault(item.path.relative_to(TESTS).parts[0], []).append(item)
    parts: list[list[pytest.Item]] = [[] for _ in range(workers)]
    for number, name in enumerate(name for name in LONG if name in folders):
        parts[number % workers] += folders.pop(name)
    for folder in folders.values():
        min(parts, key=len).extend(folder)
    items[:] = [item for part in parts for item in part]


def pytest_itemcollected(item: pytest.Item) -> None:
    """Marks what runs the MJX engine: a parameter `impl` that names it, or one of its fixtures."""
    called = getattr(item, "callspec", None)
    by_name = called is not None and called.params.get("impl") == "jax"
    if by_name or not {"jax_engine", "jax_step"}.isdisjoint(getattr(item, "fixturenames", ())):
        item.add_marker("mjx")


@pytest.hookimpl(tryfirst=True)  # before fixtures, which may import the packages
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skips a test marked `torch` where its packages are missing; fails it where such tests were asked for. Skips one
    marked `mjx` with a MuJoCo that has no mujoco-mjx."""
    if not HAS_MJX and item.get_closest_marker("mjx"):
        pytest.skip("needs mujoco-mjx, which MuJoCo 4 has not")
    needed = {name for mark in item.iter_markers("torch") for name in ("torch", *mark.args)}
    missing = sorted(name for name in needed if importlib.util.find_spec(name) is None)
    if missing:
        said = f"found no package {', '.join(missing)}; `make test-torch` installs it"
        if "not torch" not in item.config.option.markexpr and "torch" in item.config.option.markexpr:
            pytest.fail(said, pytrace=False)
        pytest.skip(said)


@pytest.hookimpl(trylast=True)
def pytest_collection_finish() -> None:
    """Keeps the modules and the collected tests out of Python's garbage collections.

    Tracing makes millions of objects that hold no cycles. With Python's own thresholds, made for small programs, the
    collector takes a sixth of the time of the tests that trace; with these it takes a hundredth, in as much memory.
    """
    gc.freeze()
    gc.set_threshold(100_000, 20, 20)
    gc.enable()


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
