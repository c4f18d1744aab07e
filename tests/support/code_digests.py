"""Digests of the code behind each version number: `python -m tests.support.code_digests` stores them anew.

A module's digest is taken over its syntax tree without comments and docstrings, a data file's over its bytes. The
digests lie in `tests/project/code_digests.json`, a line for each file, so that two branches meet only where both
changed the same file.
"""

import ast
import dataclasses
import functools
import hashlib
import json
import pathlib
import re
import sys
from collections.abc import Callable, Iterator, Mapping

from urbanverse_mjx import versions

ROOT = pathlib.Path(__file__).parents[2]
STORED = ROOT / "tests" / "project" / "code_digests.json"
PACKAGE = "urbanverse_mjx"
HOW_TO = (
    "The meaning of code that caches depend on has changed. Where it makes anything else of the same input, raise the "
    "version that is named, in urbanverse_mjx/versions.py; where it does not, leave the version. Then store the new "
    f"digests in {STORED.relative_to(ROOT).as_posix()}, by hand or by `python -m tests.support.code_digests`."
)

# Meaning -------------------------------------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True)
class Meaning:
    """The meaning of a file.

    Attributes:
      digest: 16 hexadecimal digits.
      imports: (level, module, name) of each import but those for annotations alone; `import a.b` is (0, "a.b", "").
    """

    digest: str
    imports: tuple[tuple[int, str, str], ...] = ()


def meaning_of(path: pathlib.Path) -> Meaning:
    """Reads a file."""
    status = path.stat()
    return _read(path, status.st_mtime_ns, status.st_size)


@functools.cache
def _read(path: pathlib.Path, time_ns: int, size: int) -> Meaning:
    """`meaning_of` a file as it was at that time: parsing the package takes seconds."""
    del time_ns, size
    if path.suffix != ".py":
        return Meaning(hashlib.sha256(path.read_bytes()).hexdigest()[:16])
    tree = ast.parse(path.read_text(encoding="utf-8"))
    words: list[str] = []
    _spell(tree, words.append)
    return Meaning(hashlib.sha256(" ".join(words).encode()).hexdigest()[:16], tuple(_imports(tree)))


def _spell(node: object, add: Callable[[str], None]) -> None:
    """Adds the words of a syntax tree; alike under every Python, whose own `ast.dump` changes between versions."""
    if isinstance(node, ast.AST):
        add(f"{type(node).__name__}(")
        for name in node._fields:
            value = getattr(node, name, None)
            if value is not None and value != []:
                add(name)
                _spell(value, add)
        add(")")
    elif isinstance(node, list):
        add("[")
        for item in node:
            if not _is_remark(item):
                _spell(item, add)
        add("]")
    else:
        add(f"{type(node).__name__}:{node!r}")


def _is_remark(node: object) -> bool:
    """Whether a statement is a docstring, or a text that stands alone as one does: it has no effect."""
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)


def _imports(tree: ast.AST) -> Iterator[tuple[int, str, str]]:
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.Import):
            yield from ((0, alias.name, "") for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from ((node.level, node.module or "", alias.name) for alias in node.names)
        elif isinstance(node, ast.stmt) and not (
            isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
        ):
            yield from _imports(node)
        elif isinstance(node, ast.excepthandler | ast.match_case):
            yield from _imports(node)


# Files behind a number -----------------------------------------------------------------------------------------------


def files_of(name: str, root: pathlib.Path = ROOT) -> set[str]:
    """Paths below `root` of the files of a module, or of a package with all that lies below it.

    Raises:
      AssertionError: there is no such module or package.
    """
    base = root.joinpath(PACKAGE, *name.split("."))
    if not base.is_dir():
        return files_of_one(name, root)
    found = (path for path in base.rglob("*") if path.is_file() and "__pycache__" not in path.parts)
    return {path.relative_to(root).as_posix() for path in found}


def files_of_one(name: str, root: pathlib.Path = ROOT) -> set[str]:
    """The path below `root` of a module, of a package that of its `__init__.py`.

    Raises:
      AssertionError: there is no such module or package.
    """
    base = root.joinpath(PACKAGE, *name.split("."))
    path = base / "__init__.py" if base.is_dir() else base.with_suffix(".py")
    assert path.is_file(), f"found no module {name!r} below {PACKAGE}/, needed one"
    return {path.relative_to(root).as_posix()}


def covered_by(name: str, root: pathlib.Path = ROOT) -> set[str]:
    """Paths below `root` of the files behind one version number."""
    code = versions.CODE[name]
    among, apart = ({p for m in modules for p in files_of(m, root)} for modules in (code.modules, code.apart))
    return among - apart


def covered(root: pathlib.Path = ROOT) -> dict[str, list[str]]:
    """Path below `root` of every file behind a version number -> names of the code that it belongs to."""
    found: dict[str, list[str]] = {}
    for name in versions.CODE:
        for path in covered_by(name, root):
            found.setdefault(path, []).append(name)
    return dict(sorted(found.items()))


def raised(*names: str) -> dict[str, versions.Code]:
    """`versions.CODE` with some numbers higher by one."""
    higher = {name: dataclasses.replace(versions.CODE[name], version=versions.CODE[name].version + 1) for name in names}
    return {**versions.CODE, **higher}


# Stored digests ------------------------------------------------------------------------------------------------------


def digests(root: pathlib.Path = ROOT) -> dict[str, str]:
    """Path below `root` -> digest, of every file behind a version number."""
    return {path: meaning_of(root / path).digest for path in covered(root)}


def stored() -> dict[str, str]:
    """The digests that were acknowledged last."""
    # Line by line: a merge may have left both sides of a conflict in the file, of which this reads the latter.
    found = re.findall(r'^ "(.+)": "(\w+)",?$', STORED.read_text(encoding="utf-8"), re.MULTILINE)
    return dict(found)


def complaints(known: Mapping[str, str], root: pathlib.Path = ROOT) -> list[str]:
    """A sentence for each file whose digest is not the one that is known, and one for each that is gone."""
    owners = covered(root)
    lines = []
    for path, now in digests(root).items():
        if known.get(path) != now:
            names = " and ".join(f"{name!r} ({versions.CODE[name].version})" for name in owners[path])
            lines.append(f'{path}: found the digest "{now}", needed "{known.get(path, "none")}"; belongs to {names}.')
    gone = sorted(known.keys() - owners)
    return lines + [f"{path}: found no such file behind a version number, needed it." for path in gone]


# Imports -------------------------------------------------------------------------------------------------------------


def imports_of(path: pathlib.Path, root: pathlib.Path = ROOT) -> set[str]:
    """Names below the package of the modules that a file imports; names that a package re-exports count as its own.

    Imports for annotations alone do not count.
    """
    found = {
        _defining(_base(path, level, module, root), name, root) for level, module, name in meaning_of(path).imports
    }
    return {name for name in found if name is not None}


def _base(path: pathlib.Path, level: int, module: str, root: pathlib.Path) -> list[str]:
    """The dotted name, in parts, of the module or package that is imported from."""
    inside = list(path.relative_to(root).parent.parts)
    return (inside[: len(inside) - level + 1] if level else []) + (module.split(".") if module else [])


def _defining(base: list[str], name: str, root: pathlib.Path) -> str | None:
    """The module that a name of a module or package comes from; None where that is another distribution's."""
    if base[:1] != [PACKAGE]:
        return None
    if name and _is_module([*base, name], root):
        return ".".join([*base, name][1:])
    init = root.joinpath(*base, "__init__.py")
    for level, module, given in meaning_of(init).imports if init.is_file() and len(base) > 1 else ():
        if name and given == name:
            return _defining(_base(init, level, module, root), name, root)
    return ".".join(base[1:]) or None


def _is_module(parts: list[str], root: pathlib.Path) -> bool:
    path = root.joinpath(*parts)
    return path.with_suffix(".py").is_file() or (path / "__init__.py").is_file()


def main() -> None:
    """Stores the current digests and prints the changes."""
    lines = complaints(stored() if STORED.is_file() else {})
    STORED.write_text(json.dumps(digests(), indent=1) + "\n", encoding="utf-8")
    sys.stdout.write("\n".join([*lines, f"{STORED.relative_to(ROOT)}: {len(lines)} changed"]) + "\n")


if __name__ == "__main__":
    main()
