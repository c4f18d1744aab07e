"""The gates between packages close: every import contract turns red at a planted fault."""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tomllib

import grimp
import pytest

from tests.support import ci_script

ROOT = pathlib.Path(__file__).parents[2]

LAYERS = "every package stands in its layer"
ASSETS = "assets build on one another"
#: (Contract, package with the fault, its forbidden import.)
FAULTS = [
    (LAYERS, "datatypes", "urbanverse_mjx.robots"),
    (LAYERS, "datatypes", "urbanverse_mjx.settings"),
    (LAYERS, "geometry", "urbanverse_mjx.datatypes"),
    (LAYERS, "robots", "urbanverse_mjx.simulation"),
    (LAYERS, "assets", "urbanverse_mjx.robots"),
    (LAYERS, "assets", "urbanverse_mjx.scene"),
    (LAYERS, "crowds", "urbanverse_mjx.robots"),
    (LAYERS, "crowds", "urbanverse_mjx.envs"),
    (LAYERS, "distillation", "urbanverse_mjx.assets"),
    (LAYERS, "distillation", "urbanverse_mjx.simulation.engines"),
    (LAYERS, "scene", "urbanverse_mjx.materialisation"),
    (LAYERS, "materialisation", "urbanverse_mjx.citygen"),
    (LAYERS, "scene", "urbanverse_mjx.simulation"),
    (LAYERS, "simulation", "urbanverse_mjx.envs"),
    (LAYERS, "capture", "urbanverse_mjx.envs"),
    (LAYERS, "envs", "urbanverse_mjx.training"),
    (LAYERS, "evaluation", "urbanverse_mjx.training"),
    (LAYERS, "training", "urbanverse_mjx.evaluation"),
    (LAYERS, "viz", "urbanverse_mjx.training"),
    (LAYERS, "viz", "urbanverse_mjx.pipeline"),
    (LAYERS, "pipeline", "urbanverse_mjx.cli"),
    (ASSETS, "assets/meshes", "urbanverse_mjx.assets.records.index"),
    (ASSETS, "assets/collision", "urbanverse_mjx.assets.appearances.appearance_search"),
    (ASSETS, "assets/records", "urbanverse_mjx.assets.selection.search"),
    ("the runtime never imports what makes scenes", "envs", "urbanverse_mjx.scene"),
    ("the runtime never imports what makes scenes", "capture", "urbanverse_mjx.assets"),
    ("the runtime needs no library that makes scenes", "evaluation", "shapely"),
    ("what makes scenes needs no JAX", "assets", "jax"),
    (LAYERS, "policies", "urbanverse_mjx.robots"),
    ("what runs on a robot is light", "deployment", "mujoco"),
    ("Brax stays in training", "envs", "brax"),
    ("Warp stays in simulation", "training", "warp"),
]


def contracts() -> list[str]:
    config = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    return [contract["name"] for contract in config["tool"]["importlinter"]["contracts"]]


def lint(folder: pathlib.Path) -> str:
    """Output of import-linter over the copy of the package in `folder`."""
    code = (
        "import sys; from importlinter.cli import lint_imports_command as c; sys.path.insert(0, '.'); c(['--no-cache'])"
    )
    # Its lines are as wide as the terminal.
    wide = {**os.environ, "COLUMNS": "400"}
    run = [sys.executable, "-c", code]
    done = subprocess.run(run, capture_output=True, text=True, check=False, cwd=folder, env=wide)
    return done.stdout + done.stderr


@pytest.fixture
def copy(tmp_path: pathlib.Path) -> pathlib.Path:
    shutil.copy2(ROOT / "pyproject.toml", tmp_path)
    shutil.copytree(ROOT / "urbanverse_mjx", tmp_path / "urbanverse_mjx", ignore=shutil.ignore_patterns("__pycache__"))
    return tmp_path


def test_every_contract_has_a_planted_fault() -> None:
    assert {contract for contract, _, _ in FAULTS} == set(contracts())


def test_the_package_keeps_every_contract(copy: pathlib.Path) -> None:
    assert f"{len(contracts())} kept, 0 broken" in lint(copy)


def test_planted_faults_break_their_contracts(copy: pathlib.Path) -> None:
    for number, (_, package, module) in enumerate(FAULTS):
        (copy / "urbanverse_mjx" / package / f"planted_{number}.py").write_text(f"import {module}\n")
    output = lint(copy)
    for contract in contracts():
        assert f"{contract} BROKEN" in output
    # Below its title each broken contract lists its own imports.
    sections = re.split(r"^(.+)\n-{5,}\n", output, flags=re.MULTILINE)
    listed = dict(zip(sections[1::2], sections[2::2], strict=True))
    for number, (contract, package, module) in enumerate(FAULTS):
        assert f"urbanverse_mjx.{package.replace('/', '.')}.planted_{number} -> {module}" in listed[contract]


def test_a_new_package_must_be_given_a_layer(copy: pathlib.Path) -> None:
    (copy / "urbanverse_mjx" / "newcomer").mkdir()
    (copy / "urbanverse_mjx" / "newcomer" / "__init__.py").write_text("")
    output = lint(copy)
    assert f"{LAYERS} BROKEN" in output
    assert "newcomer" in output


def test_no_modules_import_each_other() -> None:
    """Imports within functions and for types included."""
    in_circles = ci_script.load("code_metrics").in_circles
    assert in_circles({"a": {"b"}, "b": {"c"}, "c": {"a"}, "d": {"a"}}) == [["a", "b", "c"]]
    assert in_circles({"a": set()}) == []
    graph = grimp.build_graph("urbanverse_mjx", cache_dir=None)
    assert in_circles({name: graph.find_modules_directly_imported_by(name) for name in graph.modules}) == []
