"""The gate between the rooms closes: every import contract turns red at a planted fault."""

import pathlib
import shutil
import subprocess
import sys
import tomllib

import pytest

ROOT = pathlib.Path(__file__).parents[2]

#: Contract -> (file that gets the fault, the import that breaks the contract).
FAULTS = {
    "datatypes imports no other room": ("datatypes", "import urbanverse_mjx.robots"),
    "assets and robots import datatypes alone": ("robots", "import urbanverse_mjx.simulation"),
    "assets and robots do not know each other": ("assets", "import urbanverse_mjx.robots"),
    "citygen, materialisation and scene import datatypes and assets alone": ("scene", "import urbanverse_mjx.envs"),
    "citygen, materialisation and scene do not know each other": ("scene", "import urbanverse_mjx.materialisation"),
    "the runtime never imports what makes scenes": ("envs", "import urbanverse_mjx.scene"),
    "crowds imports datatypes alone": ("crowds", "import urbanverse_mjx.robots"),
    "simulation is below envs, envs below training and evaluation": ("simulation", "import urbanverse_mjx.envs"),
    "viz draws what the others make, but knows no training and no command line": (
        "viz",
        "import urbanverse_mjx.training",
    ),
    "the pipeline knows no command line": ("pipeline", "import urbanverse_mjx.cli"),
    "distillation imports datatypes alone": ("distillation", "import urbanverse_mjx.assets"),
    "capture imports datatypes and simulation alone": ("capture", "import urbanverse_mjx.envs"),
    "Brax stays in training": ("envs", "import brax"),
    "Warp stays in simulation": ("training", "import warp"),
    "what makes scenes needs no JAX": ("assets", "import jax"),
}


def contracts() -> list[str]:
    config = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    return [contract["name"] for contract in config["tool"]["importlinter"]["contracts"]]


def lint(folder: pathlib.Path) -> str:
    """Output of import-linter over the copy of the package in `folder`."""
    code = (
        "import sys; from importlinter.cli import lint_imports_command as c; sys.path.insert(0, '.'); c(['--no-cache'])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False, cwd=folder)
    return done.stdout + done.stderr


@pytest.fixture
def copy(tmp_path: pathlib.Path) -> pathlib.Path:
    shutil.copy2(ROOT / "pyproject.toml", tmp_path)
    shutil.copytree(ROOT / "urbanverse_mjx", tmp_path / "urbanverse_mjx", ignore=shutil.ignore_patterns("__pycache__"))
    return tmp_path


def test_every_contract_has_a_planted_fault() -> None:
    assert set(FAULTS) == set(contracts())


def test_the_package_keeps_every_contract(copy: pathlib.Path) -> None:
    assert f"{len(FAULTS)} kept, 0 broken" in lint(copy)


def test_planted_faults_break_their_contracts(copy: pathlib.Path) -> None:
    for number, (room, fault) in enumerate(FAULTS.values()):
        (copy / "urbanverse_mjx" / room / f"planted_{number}.py").write_text(f"{fault}\n")
    output = lint(copy)
    for name in FAULTS:
        assert f"{name} BROKEN" in output
