"""The house's sizes: short files, short functions, no path of somebody's machine."""

import ast
import pathlib
import re
import subprocess

import pytest

ROOT = pathlib.Path(__file__).parents[2]
MAX_FILE_LINES = 400
MAX_FUNCTION_LINES = 75
#: Tables of things and cities in Python's clothes: a street composed by hand is a list of what stands where.
TABLES, MAX_TABLE_LINES, MAX_TABLE_FUNCTION_LINES = re.compile(r"citygen/(craft/s\d|cities/)"), 480, 100
SOURCES = sorted(p for room in ("urbanverse_mjx", "benchmarks") for p in (ROOT / room).rglob("*.py"))


def _functions(tree: ast.AST) -> list[ast.FunctionDef | ast.AsyncFunctionDef]:
    return [n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef | ast.AsyncFunctionDef)]


def _is_kernel(function: ast.FunctionDef | ast.AsyncFunctionDef) -> bool:
    # Warp compiles one Python function into one kernel; its inner loop cannot be cut without costing registers.
    return any(ast.unparse(d).startswith("wp.kernel") for d in function.decorator_list)


def long_functions(tree: ast.Module, limit: int = MAX_FUNCTION_LINES) -> dict[str, int]:
    """Names and lengths of functions longer than the limit; nested ones count for themselves, Warp kernels not."""
    found = {}
    for function in _functions(tree):
        inner = [n for child in function.body for n in _functions(child)]
        lines = set(range(function.lineno, (function.end_lineno or function.lineno) + 1))
        for nested in inner:
            lines -= set(range(nested.lineno, (nested.end_lineno or nested.lineno) + 1))
        if len(lines) > limit and not _is_kernel(function):
            found[function.name] = len(lines)
    return found


@pytest.mark.parametrize("path", SOURCES, ids=lambda p: p.relative_to(ROOT).as_posix())
def test_files_and_functions_are_short(path: pathlib.Path) -> None:
    text = path.read_text(encoding="utf-8")
    table = TABLES.search(path.as_posix())
    assert text.count("\n") <= (MAX_TABLE_LINES if table else MAX_FILE_LINES)
    assert not long_functions(ast.parse(text), MAX_TABLE_FUNCTION_LINES if table else MAX_FUNCTION_LINES)


def test_the_scan_finds_a_long_function() -> None:
    body = "\n".join(["def long():", *["    x = 1"] * MAX_FUNCTION_LINES])
    assert long_functions(ast.parse(body)) == {"long": MAX_FUNCTION_LINES + 1}


def tracked() -> list[pathlib.Path]:
    done = subprocess.run(["git", "ls-files", "-z"], capture_output=True, text=True, check=False, cwd=ROOT)
    if done.returncode:
        pytest.skip("not a git checkout")
    return [ROOT / name for name in done.stdout.split("\0") if name and (ROOT / name).is_file()]


def test_no_path_of_a_machine_is_tracked() -> None:
    # Written in pieces, so that this file does not find itself.
    places = re.compile("|".join(["/" + "home/[a-z]", "/" + "root/", "/" + "Users/[a-z]", "/" + "work/[a-z]"]))
    found = []
    for path in tracked():
        if path.suffix in (".py", ".md", ".toml", ".json", ".csv", ".xml", ".lock", "") and path.stat().st_size < 10**6:
            text = path.read_text(encoding="utf-8", errors="ignore")
            found += [f"{path.name}: {match.group()}" for match in places.finditer(text)]
    assert not found


def test_locks_hold_hashes_and_no_address() -> None:
    locks = sorted(ROOT.glob("requirements*.lock"))
    assert len(locks) == 3
    for lock in locks:
        text = lock.read_text(encoding="utf-8")
        assert "://" not in text
        assert "index-url" not in text
        entries = re.split(r"\n(?=[a-z0-9])", text.strip())
        assert len(entries) > 15
        assert all("==" in entry and "--hash=sha256:" in entry for entry in entries)


def test_the_locks_agree_with_each_other() -> None:
    versions: dict[str, set[str]] = {}
    for lock in ROOT.glob("requirements*.lock"):
        for name, version in re.findall(r"^([a-z0-9-]+)==([^\s\\;]+)", lock.read_text(encoding="utf-8"), re.MULTILINE):
            versions.setdefault(name, set()).add(version)
    assert not {name: found for name, found in versions.items() if len(found) > 1}


def test_the_repository_stays_small() -> None:
    files = tracked()
    assert sum(path.stat().st_size for path in files) < 25 * 10**6
    assert all(path.stat().st_size <= 2 * 2**20 for path in files if path.suffix == ".mp4")
