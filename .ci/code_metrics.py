#!/usr/bin/env python3
"""Sizes, repetitions, import circles and types of the Python code of one or several trees, as a Markdown table.

usage: .ci/code_metrics.py TREE ...

A tree is a folder with the repository's layout, such as the output of `git archive COMMIT`. Nothing of a tree is
imported, so that old ones can be measured by today's script.
"""

import ast
import collections
import dataclasses
import io
import pathlib
import sys
import tokenize
from collections.abc import Callable, Iterable, Iterator

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

PACKAGE = "urbanverse_mjx"
#: Folder of the package whose files are descriptions of objects rather than a library.
RECIPES = "assets/recipes"
#: Equal lines in succession, names included, from which code counts as repeated. (Pylint's default is 4.)
REPEATED_LINES = 6
_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)


@dataclasses.dataclass(frozen=True)
class Source:
    """A Python file.

    Attributes:
      module: dotted name.
      lines: all lines, with comments and blank ones.
    """

    module: str
    lines: tuple[str, ...]
    tree: ast.Module

    def functions(self) -> Iterator[ast.FunctionDef | ast.AsyncFunctionDef]:
        """All functions and methods, nested ones too."""
        return (node for node in ast.walk(self.tree) if isinstance(node, _FUNCTIONS))


def read(root: pathlib.Path, files: Iterable[pathlib.Path]) -> list[Source]:
    """Parses the files of a tree."""
    found = []
    for path in sorted(files):
        text = path.read_text(encoding="utf-8")
        module = ".".join(path.relative_to(root).with_suffix("").parts).removesuffix(".__init__")
        found.append(Source(module, tuple(text.splitlines()), ast.parse(text)))
    return found


def lengths(numbers: Iterable[int]) -> str:
    """Median, 95th percentile and maximum."""
    values = np.array(list(numbers))
    return " / ".join(f"{x:.0f}" for x in (*np.percentile(values, (50, 95)), values.max()))


def code_lines(source: Source) -> list[str]:
    """Lines with code, stripped; without comments, docstrings and imports, whose repetition is no fault."""
    left_out: set[int] = set()
    for node in ast.walk(source.tree):
        if isinstance(node, ast.Import | ast.ImportFrom):
            left_out.update(range(node.lineno, (node.end_lineno or node.lineno) + 1))
        body = getattr(node, "body", None)
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef) and body:
            first = body[0]
            if isinstance(first, ast.Expr) and isinstance(getattr(first.value, "value", None), str):
                left_out.update(range(first.lineno, (first.end_lineno or first.lineno) + 1))
    text = "\n".join(source.lines) + "\n"
    spans: dict[int, list[tokenize.TokenInfo]] = collections.defaultdict(list)
    silent = (tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER)
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type not in silent:
            for row in range(token.start[0], token.end[0] + 1):
                spans[row].append(token)
    return [source.lines[row - 1].strip() for row in sorted(spans) if row not in left_out]


def repeated(sources: list[Source]) -> int:
    """Lines that stand in a run of `REPEATED_LINES` lines which occurs again, the first occurrence not counted."""
    seen: set[tuple[str, ...]] = set()
    count = 0
    for source in sources:
        lines = code_lines(source)
        again: set[int] = set()
        for start in range(len(lines) - REPEATED_LINES + 1):
            run = tuple(lines[start : start + REPEATED_LINES])
            if run in seen:
                again.update(range(start, start + REPEATED_LINES))
            seen.add(run)
        count += len(again)
    return count


def imports(source: Source, modules: set[str], packages: set[str], within_functions: bool) -> set[str]:
    """Modules of the package that a file imports; a package that re-exports a name is not searched for its source."""
    base = source.module if source.module in packages else source.module.rpartition(".")[0]
    functions = [node for node in ast.walk(source.tree) if isinstance(node, _FUNCTIONS)]
    inside = {id(child) for function in functions for child in ast.walk(function)}
    found: set[str] = set()
    for node in ast.walk(source.tree):
        if not within_functions and id(node) in inside:
            continue
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            parts = base.split(".")
            start = parts[: len(parts) - node.level + 1] if node.level else []
            name = ".".join([*start, *([node.module] if node.module else [])])
            for alias in node.names:
                found.add(f"{name}.{alias.name}" if f"{name}.{alias.name}" in modules else name)
    return found & modules


def in_circles(imported: dict[str, set[str]]) -> list[list[str]]:
    """Groups of modules that import each other, also over others, for the imports of each module."""
    order = sorted(imported)
    number = {name: i for i, name in enumerate(order)}
    pairs = np.array([(number[a], number[b]) for a in order for b in imported[a]], int).reshape(-1, 2)
    graph = csr_matrix((np.ones(len(pairs)), tuple(pairs.T)), shape=(len(order), len(order)))
    count, labels = connected_components(graph, connection="strong")
    groups = [[order[i] for i in np.flatnonzero(labels == k)] for k in range(count)]
    return [group for group in groups if len(group) > 1]


def circles(sources: list[Source], packages: set[str], within_functions: bool) -> int:
    """Files in a circle of imports."""
    modules = {source.module for source in sources}
    imported = {source.module: imports(source, modules, packages, within_functions) for source in sources}
    return sum(len(group) for group in in_circles(imported))


def share_of_any(sources: list[Source]) -> str:
    """Share of annotated parameters and results whose annotation names `Any`."""
    count = named = 0
    for source in sources:
        for function in source.functions():
            arguments = function.args
            given = [*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs, arguments.vararg, arguments.kwarg]
            notes = [a.annotation for a in given if a is not None and a.annotation] + [function.returns]
            for note in filter(None, notes):
                count += 1
                named += "Any" in {getattr(n, "id", getattr(n, "attr", "")) for n in ast.walk(note)}
    return f"{100 * named / count:.1f} %"


def measures(root: pathlib.Path) -> dict[str, str]:
    """All rows of the table for one tree."""
    package = root / PACKAGE
    recipes = package / RECIPES
    paths = list(package.rglob("*.py"))
    packages = {".".join(p.parent.relative_to(root).parts) for p in paths if p.name == "__init__.py"}
    library = read(root, [p for p in paths if not p.is_relative_to(recipes)])
    parts = {
        "recipes": read(root, recipes.rglob("*.py")),
        "benchmarks": read(root, (root / "benchmarks").rglob("*.py")),
        "tests": read(root, (root / "tests").rglob("*.py")),
    }

    def total(sources: list[Source]) -> str:
        return f"{sum(len(source.lines) for source in sources):,} in {len(sources)}"

    functions: Callable[[ast.FunctionDef | ast.AsyncFunctionDef], int]
    functions = lambda node: (node.end_lineno or node.lineno) - node.lineno + 1  # noqa: E731
    rows = {"library without recipes, lines in files": total(library)}
    rows |= {f"{name}, lines in files": total(sources) for name, sources in parts.items()}
    rows["lines of a file, median / p95 / most"] = lengths(len(source.lines) for source in library)
    sizes = [functions(node) for source in library for node in source.functions()]
    rows["lines of a function, median / p95 / most"] = lengths(sizes)
    rows[f"lines in runs of {REPEATED_LINES} that stand elsewhere too"] = str(repeated(library))
    everything = read(root, paths)
    rows["files in circles of imports, at their head"] = str(circles(everything, packages, False))
    rows["files in circles of imports, within functions too"] = str(circles(everything, packages, True))
    rows["annotations with `Any`"] = share_of_any(library)
    return rows


def main() -> None:
    """Prints the table, a column for each tree."""
    columns = {pathlib.Path(name).resolve().name: measures(pathlib.Path(name)) for name in sys.argv[1:]}
    if not columns:
        sys.exit(__doc__)
    sys.stdout.write(f"| | {' | '.join(columns)} |\n|{' --- |' * (len(columns) + 1)}\n")
    for row in next(iter(columns.values())):
        sys.stdout.write(f"| {row} | {' | '.join(values[row] for values in columns.values())} |\n")


if __name__ == "__main__":
    main()
