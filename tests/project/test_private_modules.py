"""Private modules of other packages: one adapter each imports them, and reports a version that lacks one."""

import ast
import importlib
import pathlib
import re
import sys
import tomllib
from importlib import metadata

import pytest

from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.pipeline.errors import refusal

ROOT = pathlib.Path(__file__).parents[2]
OURS = ("urbanverse_mjx", "tests", "benchmarks")
#: Adapter -> the distribution and module whose privates it takes.
ADAPTERS = {
    "urbanverse_mjx/simulation/rendering/pbr_private.py": ("mujoco-warp-pbr", "mujoco_warp_pbr"),
    "urbanverse_mjx/simulation/warp_engine/mujoco_warp_private.py": ("mujoco-warp", "mujoco_warp"),
}


def privates(tree: ast.AST) -> list[str]:
    """Private modules of other packages that a file names, however it spells them."""
    found = []
    for node in ast.walk(tree):
        names: list[str] = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and not node.level:
            names = [f"{node.module}.{alias.name}" for alias in node.names]
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            names = re.findall(r"^\w+(?:\.\w+)*\._src\b[\w.]*$", node.value)
        elif isinstance(node, ast.Attribute) and node.attr == "_src":
            names = [ast.unparse(node)]
        private = re.compile(r"\._(?!_)")
        found += [name for name in names if private.search(name) and name.partition(".")[0] not in OURS]
    return found


def test_adapters_alone_import_private_modules() -> None:
    found = {}
    for package in OURS:
        for path in (ROOT / package).rglob("*.py"):
            text = path.read_text(encoding="utf-8")
            # Parsing all files takes seconds, so a text search comes first.
            if re.search(r"_src\b|import.*[. ]_[a-z]|\._[a-z]\w* import", text) and (
                names := privates(ast.parse(text))
            ):
                found[path.relative_to(ROOT).as_posix()] = {name.partition(".")[0] for name in names}
    found.pop("tests/project/test_private_modules.py", None)
    assert found == {path: {module} for path, (_, module) in ADAPTERS.items()}


def test_the_scan_sees_every_spelling() -> None:
    code = [
        *("import a._src.b", "from a._src import b", "from a import _b", "import a\na._src.f()", "load('a._src.b')"),
        *("from ._src import b", "from urbanverse_mjx.x import _y", "from __future__ import annotations", "'in _src'"),
    ]
    assert [bool(privates(ast.parse(text))) for text in code] == [True] * 5 + [False] * 4


def taken(path: str) -> list[tuple[str, str, str]]:
    """(adapter, private module, name) of everything that an adapter takes."""
    tree = ast.parse((ROOT / path).read_text(encoding="utf-8"))
    imports = [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) and not node.level]
    return [(path, str(n.module), alias.name) for n in imports for alias in n.names if "_src" in str(n.module)]


TAKEN = [row for path in ADAPTERS for row in taken(path)]


def reloaded(path: str) -> None:
    importlib.reload(importlib.import_module(path.removesuffix(".py").replace("/", ".")))


@pytest.mark.parametrize(("path", "module", "name"), TAKEN)
def test_a_name_that_is_gone_is_said_with_both_versions(
    path: str, module: str, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    reloaded(path)
    package, _ = ADAPTERS[path]
    with monkeypatch.context() as patch:
        patch.delattr(importlib.import_module(module), name)
        patch.setattr(metadata, "version", {package: "9.8.7"}.__getitem__)
        with pytest.raises(ValidationError) as caught:
            reloaded(path)
    needed = importlib.import_module(path.removesuffix(".py").replace("/", ".")).NEEDED
    assert str(caught.value).startswith(
        f"{package}: found version 9.8.7, without {module}.{name}, needed {package}{needed}"
    )
    assert f'pip install "{package}{needed}"' in str(caught.value)
    assert refusal(caught.value), "a command ends with this sentence"
    reloaded(path)


def test_a_module_that_is_gone_is_said_too(monkeypatch: pytest.MonkeyPatch) -> None:
    for path, module, _ in TAKEN:
        with monkeypatch.context() as patch:
            patch.setitem(sys.modules, module, None)
            with pytest.raises(ValidationError, match=re.escape(f"without {module}, needed")):
                reloaded(path)
        reloaded(path)


def test_the_needed_versions_are_those_of_the_installation() -> None:
    wanted = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["dependencies"]
    for path, (package, _) in ADAPTERS.items():
        needed = importlib.import_module(path.removesuffix(".py").replace("/", ".")).NEEDED
        assert f"{package}{needed}" in wanted
