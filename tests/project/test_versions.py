"""Caches are keyed by version numbers and data, and no change of meaning passes unacknowledged behind a number."""

import ast
import json
import os
import pathlib
import shutil
import subprocess
import sys

import pytest

from tests.support import code_digests
from tests.support.box_bank import box_bank
from urbanverse_mjx import settings, versions
from urbanverse_mjx.assets.meshes import mesh_cache
from urbanverse_mjx.assets.previews import thumbnails
from urbanverse_mjx.assets.records import index, store
from urbanverse_mjx.envs.navigation import dynamic_tables, surroundings
from urbanverse_mjx.pipeline.generation.run_folder import key_of

ROOT = pathlib.Path(__file__).parents[2]
PACKAGE = ROOT / "urbanverse_mjx"
#: Modules that no version number needs to stand for: they find files, start processes, show progress, free memory, keep
#: the record of a run or word errors, and what the generators of graphs make enters keys as the graph's content.
APART = {
    *("settings", "versions", "precision", "process_pool", "work_folder", "progress"),
    *("simulation.private_modules", "simulation.host_memory"),
    *("pipeline.generation.run_folder", "pipeline.generation.sources"),
    *("citygen.craftbench", "citygen.procedural_places", "citygen.procedural_streets", "citygen.validation_streets"),
    "scene.library",
}


# What stands behind a number -----------------------------------------------------------------------------------------


def test_changes_of_meaning_are_acknowledged() -> None:
    lines = code_digests.complaints(code_digests.stored())
    assert not lines, "\n".join([*lines, code_digests.HOW_TO])


def test_what_a_number_stands_for_holds_all_that_it_imports() -> None:
    """A module that results depend on, but no number stands for, could change and leave stale files in caches."""
    missing = []
    for name in versions.CODE:
        behind = set().union(*(code_digests.covered_by(used) for used in versions.of(name)))
        for path in sorted(code_digests.covered_by(name)):
            imported = code_digests.imports_of(ROOT / path) - APART if path.endswith(".py") else set()
            missing += [f"{name}: {path} imports {m}" for m in imported if not code_digests.files_of_one(m) <= behind]
    assert not missing


def test_imports_are_followed_to_the_module_that_defines_a_name(tmp_path: pathlib.Path) -> None:
    package = tmp_path / "urbanverse_mjx"
    (package / "folder").mkdir(parents=True)
    (package / "folder" / "__init__.py").write_text("from .deep import value\nfrom . import other\n")
    for name in ("deep", "other", "third", "typing_alone"):
        (package / "folder" / f"{name}.py").write_text("")
    module = package / "module.py"
    module.write_text(
        "import numpy\nimport urbanverse_mjx.folder.other\n"
        "from typing import TYPE_CHECKING\nfrom .folder import value\n"
        "if TYPE_CHECKING:\n    from .folder import typing_alone\n"
        "def f():\n    from urbanverse_mjx.folder import third\n    from .folder.deep import value\n"
    )
    assert code_digests.imports_of(module, tmp_path) == {"folder.other", "folder.deep", "folder.third"}


# Digests -------------------------------------------------------------------------------------------------------------

CODE = "import a\n\nHEIGHT = 1.0\n\n\ndef f(x, y=2):\n    z = x + y\n    return [z, 'text']\n"
SAME = [
    '"""Module."""\n' + CODE,
    CODE.replace("    z =", "    # A remark.\n    z =").replace("1.0", "1.0  # m, of a door"),
    CODE.replace("    z =", '    """Adds."""\n    z =').replace("HEIGHT = 1.0", 'HEIGHT = 1.0\n"""m, of a door."""'),
    CODE.replace("[z, 'text']", '[\n        z,\n        "text",\n    ]').replace("x + y", "(x + y)"),
]
OTHER = [
    CODE.replace("1.0", "1.1"),
    CODE.replace("1.0", "1"),
    CODE.replace("y=2", "y=3"),
    CODE.replace("x + y", "y + x"),
    CODE.replace("x + y", "x - y"),
    CODE.replace("'text'", "'test'"),
    CODE.replace("'text'", "b'text'"),
    CODE.replace("import a", "import b as a"),
    CODE.replace("def f", "@a.cache\ndef f"),
    CODE.replace("HEIGHT", "WIDTH"),
]


@pytest.mark.parametrize("code", SAME)
def test_remarks_and_layout_have_no_meaning(code: str, tmp_path: pathlib.Path) -> None:
    assert digest(code, tmp_path) == digest(CODE, tmp_path)


@pytest.mark.parametrize("code", OTHER)
def test_everything_else_has(code: str, tmp_path: pathlib.Path) -> None:
    assert digest(code, tmp_path) != digest(CODE, tmp_path)


def digest(code: str, folder: pathlib.Path) -> str:
    (folder / "module.py").write_text(code)
    return code_digests.meaning_of(folder / "module.py").digest


def test_a_digest_is_the_same_under_every_python(tmp_path: pathlib.Path) -> None:
    assert digest(CODE, tmp_path) == "2166caeeb8929135"


# A planted change ----------------------------------------------------------------------------------------------------


@pytest.fixture
def small(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> pathlib.Path:
    """A package of two modules and a table behind two numbers; returns its folder."""
    folder = tmp_path / "urbanverse_mjx" / "folder"
    folder.mkdir(parents=True)
    (folder / "__init__.py").write_text("")
    (folder / "walls.py").write_text(CODE)
    (folder / "table.csv").write_text("1,2")
    (folder / "test.py").write_text("")
    apart = versions.Code(3, ("folder",), (), ("folder.test",))
    monkeypatch.setattr(versions, "CODE", {"folder": apart, "walls": versions.Code(7, ("folder.walls",))})
    return tmp_path


def test_a_change_of_meaning_is_named_with_its_numbers_and_both_ways_out(small: pathlib.Path) -> None:
    known = code_digests.digests(small)
    assert [path.rpartition("/")[2] for path in known] == ["__init__.py", "table.csv", "walls.py"]
    walls = small / "urbanverse_mjx" / "folder" / "walls.py"
    walls.write_text(SAME[1])
    (walls.parent / "test.py").write_text("changed = 1")
    assert code_digests.complaints(known, small) == []
    walls.write_text(OTHER[0])
    now, name = code_digests.meaning_of(walls).digest, "urbanverse_mjx/folder/walls.py"
    line = f"{name}: found the digest \"{now}\", needed \"{known[name]}\"; belongs to 'folder' (3) and 'walls' (7)."
    assert code_digests.complaints(known, small) == [line]
    assert code_digests.complaints({**known, name: now}, small) == []
    for words in ("raise the version", "urbanverse_mjx/versions.py", "does not", "tests/project/code_digests.json"):
        assert words in code_digests.HOW_TO


def test_changed_data_and_new_and_vanished_modules_are_noticed(small: pathlib.Path) -> None:
    known = code_digests.digests(small)
    folder = small / "urbanverse_mjx" / "folder"
    (folder / "table.csv").write_text("1,3")
    (folder / "new.py").write_text("")
    data, new = code_digests.complaints({**known, "urbanverse_mjx/folder/new.py": "none"}, small)
    assert data.startswith("urbanverse_mjx/folder/new.py: found the digest ")
    assert "needed \"none\"; belongs to 'folder' (3)." in data
    assert new.startswith("urbanverse_mjx/folder/table.csv: found the digest ")
    (folder / "new.py").unlink()
    (folder / "table.csv").write_text("1,2")
    (line,) = code_digests.complaints({**known, "urbanverse_mjx/folder/new.py": "0"}, small)
    assert line == "urbanverse_mjx/folder/new.py: found no such file behind a version number, needed it."


# Keys ----------------------------------------------------------------------------------------------------------------


def keys() -> dict[str, str]:
    """The cache's keys, each by the name of the code that it must change with."""
    bank = box_bank(1)
    record = index.load_index().records[0]
    store.inputs_key.cache_clear()
    found = {
        "meshes": mesh_cache.path_of("recipe", "leaf", 0),
        "catalogue": store.store_path(),
        "thumbnails": thumbnails.path_of(record, index.build_mesh(record)),
        "scenes": settings.terrain_bank_path(),
        "bank": settings.shipped_bank_path(),
        "crowds": dynamic_tables.path_of(bank, [0]),
        "surroundings": surroundings.path_of(bank, 1.0),
        **{name: key_of(name) for name in ("perception", "distillation", "cousins", "library", "report", "generation")},
    }
    store.inputs_key.cache_clear()
    return {name: str(key) for name, key in found.items()}


def test_an_edited_comment_makes_nothing_anew(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A clone in which every module has another comment and docstring finds what this one built."""
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path / "cache"))
    monkeypatch.delenv("URBANVERSE_BANK", raising=False)
    record = index.load_index().records[0]
    index._build_cached.cache_clear()
    index.build_mesh(record)
    (mesh,) = (tmp_path / "cache").rglob("*.npz")
    built = mesh.stat().st_mtime_ns
    clone = tmp_path / "clone"
    for name in ("urbanverse_mjx", "tests/project", "tests/support"):
        shutil.copytree(ROOT / name, clone / name, ignore=shutil.ignore_patterns("__pycache__"))
    (clone / "tests" / "__init__.py").touch()
    for name in ("assets_index", "scenes"):
        (clone / name).symlink_to(ROOT / name)
    shutil.copy2(ROOT / "pyproject.toml", clone)
    for path in (clone / "urbanverse_mjx").rglob("*.py"):
        path.write_text(f"# An edited comment.\n{path.read_text(encoding='utf-8')}# Another.\n", encoding="utf-8")
    code = "import json; from tests.project import test_versions as t; print(json.dumps([t.__file__, t.keys()]))"
    environment = {**os.environ, "PYTHONPATH": str(clone)}
    run = [sys.executable, "-c", code]
    done = subprocess.run(run, capture_output=True, text=True, check=False, cwd=clone, env=environment)
    assert done.returncode == 0, done.stderr
    where, found = json.loads(done.stdout)
    assert pathlib.Path(where).is_relative_to(clone)
    assert found == keys()
    assert list((tmp_path / "cache").rglob("*.npz")) == [mesh]
    assert mesh.stat().st_mtime_ns == built


def test_a_raised_number_makes_its_results_anew_and_no_others(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("URBANVERSE_BANK", raising=False)
    before = keys()
    for name in before:
        with monkeypatch.context() as patch:
            patch.setattr(versions, "CODE", code_digests.raised(name))
            changed = {other for other, key in keys().items() if key != before[other]}
        made_of = {other for other in before if name in versions.of(other)}
        # Thumbnails are keyed by their meshes; the stages of a run share the number of their order.
        expected = made_of - {"thumbnails"} | {name}
        if name == "generation":
            expected = {"perception", "distillation", "cousins", "library", "report", "generation"}
        assert changed == expected, name


def test_of_holds_what_is_used_at_every_remove(monkeypatch: pytest.MonkeyPatch) -> None:
    assert versions.of("meshes") == {name: versions.CODE[name].version for name in ("datatypes", "meshes")}
    assert versions.of("bank").keys() >= {"datatypes", "meshes", "catalogue", "appearances", "cousins", "scenes"}
    assert "catalogue" not in versions.of("meshes"), "a new catalogue builds no mesh anew"
    raised = versions.CODE["catalogue"].version + 1
    monkeypatch.setattr(versions, "CODE", code_digests.raised("catalogue"))
    assert versions.of("bank")["catalogue"] == raised


# No module reads sources ---------------------------------------------------------------------------------------------


def reads_sources(tree: ast.Module) -> list[int]:
    """Lines that ask for the source of a function or module, or name files of Python code."""
    names = {"getsource", "getsourcelines", "getsourcefile", "findsource", "co_code"}
    lines = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute | ast.Name):
            lines += [node.lineno] if (node.attr if isinstance(node, ast.Attribute) else node.id) in names else []
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value.endswith((".py", ".pyc")):
            lines.append(node.lineno)
    return lines


def test_no_module_reads_source_text() -> None:
    found = {}
    for path in PACKAGE.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        # Parsing takes a hundred times as long as looking for the letters.
        if any(letters in text for letters in ("source", ".py", "co_code")) and (
            lines := reads_sources(ast.parse(text))
        ):
            found[path.relative_to(PACKAGE).as_posix()] = lines
    assert not found


def test_the_scan_sees_every_spelling() -> None:
    code = "inspect.getsource(f)\nfolder.glob('**/*.py')\nfolder / f'{name}.py'\nf.__code__.co_code\ngetsource(f)\n"
    assert sorted(reads_sources(ast.parse(code))) == [1, 2, 3, 4, 5]
