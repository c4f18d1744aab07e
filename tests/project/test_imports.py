"""Importing the package is quick and light, and one module alone reads the environment."""

import ast
import functools
import pathlib
import subprocess
import sys
import time

import pytest

ROOT = pathlib.Path(__file__).parents[2]
PACKAGE = ROOT / "urbanverse_mjx"
HEAVY = ("jax", "warp", "brax", "mujoco", "numpy", "flax", "trimesh")
#: Packages below urbanverse_mjx, and the modules that importing one must not load.
PACKAGES = sorted(path.parent.name for path in PACKAGE.glob("*/__init__.py"))
#: What makes scenes.
WITHOUT_JAX = ["datatypes", "assets", "citygen", "materialisation", "scene"]
#: Libraries that every package may load, and those of the packages that may load JAX: imported once.
SHARED = ["mujoco", "pyarrow.parquet", "scipy.ndimage", "scipy.spatial.transform", "shapely", "trimesh", "PIL.Image"]
SHARED_WITH_JAX = ["jax.numpy", "flax.linen", "ml_collections", "optax"]
FORBIDDEN = {"warp", "brax", "mujoco_warp", "mujoco_warp_pbr"}
#: Arguments: libraries, packages, further libraries, further packages. A line for each package: it and what is loaded.
FORKS = """
import importlib, os, sys
for libraries, packages in zip(sys.argv[1::2], sys.argv[2::2]):
    for library in libraries.split(","):
        importlib.import_module(library)
    for package in ["nothing", *packages.split(",")]:
        sys.stdout.flush()
        if os.fork() == 0:
            if package != "nothing":
                importlib.import_module(f"urbanverse_mjx.{package}")
            print(package, *{name.partition(".")[0] for name in sys.modules}, flush=True)
            os._exit(0)
        assert os.wait()[1] == 0, package
"""


def loaded_after(statement: str) -> tuple[set[str], float]:
    """Top-level modules loaded by a statement in a fresh interpreter, and its wall time in s."""
    code = f"import sys, time; t = time.perf_counter(); {statement}; t = time.perf_counter() - t\n"
    code += "print(t, *{name.partition('.')[0] for name in sys.modules})"
    start = time.perf_counter()
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert time.perf_counter() - start < 60
    seconds, *names = done.stdout.split()
    return set(names), float(seconds)


@functools.cache
def loaded_by_packages() -> dict[str, set[str]]:
    """Package -> top-level modules that importing it loads: each in a process forked from one that holds `SHARED`
    alone, and `SHARED_WITH_JAX` for the packages that may load JAX. Fresh interpreters would take half a minute."""
    others = [package for package in PACKAGES if package not in WITHOUT_JAX]
    command = [
        sys.executable,
        "-c",
        FORKS,
        *(",".join(names) for names in (SHARED, WITHOUT_JAX, SHARED_WITH_JAX, others)),
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT)
    lines = [line.split() for line in done.stdout.splitlines()]
    return {package: set(names) for package, *names in lines}


@pytest.mark.parametrize("module", ["urbanverse_mjx", "urbanverse_mjx.settings", "urbanverse_mjx.cli.main"])
def test_package_imports_nothing_heavy_within_a_second(module: str) -> None:
    # The best of three: a busy machine may delay one of them.
    runs = [loaded_after(f"import {module}") for _ in range(3)]
    assert min(seconds for _, seconds in runs) < 1.0
    assert not runs[0][0] & set(HEAVY)


@pytest.mark.parametrize("package", PACKAGES)
def test_no_package_loads_warp_or_brax_when_imported(package: str) -> None:
    names = loaded_by_packages()[package]
    # Warp is simulation's own library: the package must set its log level before MJX starts it. Capture films with it.
    allowed = {"warp"} if package in ("simulation", "capture") else set()
    assert not names & (FORBIDDEN - allowed)
    assert "urbanverse_mjx" in names


@pytest.mark.parametrize("package", WITHOUT_JAX)
def test_what_makes_scenes_loads_no_jax(package: str) -> None:
    assert "jax" not in loaded_by_packages()[package]


def test_the_shared_libraries_hide_nothing() -> None:
    """The forked processes begin without the package, and without what it is searched for."""
    names = loaded_by_packages()["nothing"]
    assert "jax" in names, "of the second group"
    assert not names & (FORBIDDEN | {"urbanverse_mjx"})
    assert "warp" in loaded_by_packages()["simulation"]


#: Names by which the process environment is reached.
ENVIRONMENT = ("environ", "environb", "getenv", "putenv", "unsetenv")


def reads_environment(code: str) -> list[int]:
    """Lines that touch the process environment, however it is spelled."""
    if not any(name in code for name in ENVIRONMENT):
        return []  # parsing the whole package takes seconds
    lines = []
    for node in ast.walk(ast.parse(code)):
        if isinstance(node, ast.Attribute) and node.attr in ENVIRONMENT:
            lines.append(node.lineno)
        if isinstance(node, ast.ImportFrom) and node.module == "os":
            lines += [node.lineno for name in node.names if name.name in ENVIRONMENT]
    return lines


def test_settings_alone_reads_the_environment() -> None:
    found = {}
    for path in PACKAGE.rglob("*.py"):
        lines = reads_environment(path.read_text(encoding="utf-8"))
        if lines:
            found[path.relative_to(PACKAGE).as_posix()] = lines
    assert set(found) == {"settings.py"}, found


def test_the_scan_sees_every_spelling() -> None:
    code = "import os\nfrom os import environ\nos.environ['A']\nos.getenv('A')\nx = os\nx.environ\n"
    assert sorted(reads_environment(code)) == [2, 3, 4, 6]
