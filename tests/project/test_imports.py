"""Importing the package is quick and light, and one module alone reads the environment."""

import ast
import functools
import json
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


def loaded_after(statement: str) -> tuple[set[str], float]:
    """Top-level modules loaded by a statement in a fresh interpreter, and its processor time in s."""
    code = f"import sys, time; t = time.process_time(); {statement}; t = time.process_time() - t\n"
    code += "print(t, *{name.partition('.')[0] for name in sys.modules})"
    start = time.perf_counter()
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert time.perf_counter() - start < 60
    seconds, *names = done.stdout.split()
    return set(names), float(seconds)


#: Imports each package in a child of a process that has the libraries already: they take most of the time. The first
#: line of its arguments are packages and libraries before JAX, the second those after it.
CHILDREN = """
import importlib, json, os, sys

def names():
    return {name.partition(".")[0] for name in sys.modules}

found = {}
for packages, libraries in json.loads(sys.argv[1]):
    for library in libraries:
        importlib.import_module(library)
    before = names()
    for package in packages:
        reader, writer = os.pipe()
        child = os.fork()
        if not child:
            importlib.import_module("urbanverse_mjx." + package)
            os.write(writer, json.dumps(sorted(names())).encode())
            os._exit(0)
        os.close(writer)
        with os.fdopen(reader, "rb") as file:
            found[package] = json.loads(file.read())
        os.waitpid(child, 0)
        assert names() == before
print(json.dumps(found))
"""
WITHOUT_JAX = ["datatypes", "assets", "citygen", "materialisation", "scene"]
#: Libraries that packages import when they are imported; none of them may bring in what a test looks for.
LIBRARIES = (
    "numpy scipy.ndimage scipy.spatial.transform scipy.optimize scipy.stats scipy.interpolate mujoco shapely "
    "trimesh skimage.measure PIL.Image pyarrow.parquet networkx rich.progress"
).split()
AND_JAX = "jax jax.numpy jaxtyping flax.linen optax ml_collections gymnasium".split()


@functools.cache
def loaded() -> dict[str, set[str]]:
    """Package -> top-level modules that are loaded once it is imported."""
    rest = [package for package in PACKAGES if package not in WITHOUT_JAX]
    code, rounds = [sys.executable, "-W", "ignore", "-c", CHILDREN], [(WITHOUT_JAX, LIBRARIES), (rest, AND_JAX)]
    done = subprocess.run([*code, json.dumps(rounds)], capture_output=True, text=True, check=False, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    return {package: set(names) for package, names in json.loads(done.stdout).items()}


@pytest.mark.parametrize("module", ["urbanverse_mjx", "urbanverse_mjx.settings", "urbanverse_mjx.cli.main"])
def test_package_imports_nothing_heavy_within_a_second(module: str) -> None:
    # The least of three: the first one may compile bytecode.
    runs = [loaded_after(f"import {module}") for _ in range(3)]
    assert min(seconds for _, seconds in runs) < 1.0
    assert not runs[0][0] & set(HEAVY)


@pytest.mark.parametrize("package", PACKAGES)
def test_no_package_loads_warp_or_brax_when_imported(package: str) -> None:
    names = loaded()[package]
    # Warp is simulation's own library: the package must set its log level before MJX starts it. Capture films with it.
    allowed = {"warp"} if package in ("simulation", "capture") else set()
    assert not names & ({"warp", "brax", "mujoco_warp", "mujoco_warp_pbr"} - allowed)


@pytest.mark.parametrize("package", WITHOUT_JAX)
def test_what_makes_scenes_loads_no_jax(package: str) -> None:
    names = loaded()[package]
    assert "jax" not in names


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


def command_internals(code: str) -> list[str]:
    """What code takes from `urbanverse_mjx.cli` besides the command itself and its names."""
    found = []
    for node in ast.walk(ast.parse(code)):
        if isinstance(node, ast.ImportFrom) and f"{node.module}.".startswith("urbanverse_mjx.cli."):
            found += [f"{node.module}.{name.name}" for name in node.names]
        elif isinstance(node, ast.Import):
            found += [name.name for name in node.names if name.name.startswith("urbanverse_mjx.cli")]
    command = {f"urbanverse_mjx.cli.{name}" for name in ("main", "main.main", "main.COMMANDS")}
    return [name for name in found if name not in command]


def test_only_the_commands_own_tests_know_how_it_is_made() -> None:
    """Benchmarks and all other tests call `pipeline`, or run the command with words as a user does."""
    found = {}
    for folder in ("tests", "benchmarks"):
        for path in (ROOT / folder).rglob("*.py"):
            text = path.read_text(encoding="utf-8")
            own = path.is_relative_to(ROOT / "tests" / "cli")
            if not own and "cli" in text and (names := command_internals(text)):
                found[path.relative_to(ROOT).as_posix()] = names
    assert found == {}
    code = "from urbanverse_mjx.cli import main, train\nimport urbanverse_mjx.cli.scene\n"
    assert command_internals(code) == ["urbanverse_mjx.cli.train", "urbanverse_mjx.cli.scene"]
