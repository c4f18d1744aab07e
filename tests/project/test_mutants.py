"""`make mutants`: each change is in code and at one place, coverage maps lines to tests, and tests run in a copy."""

import ast
import difflib
import os
import pathlib
import subprocess
import sys
import time
from collections.abc import Callable

import pytest

from tests.support.mutants import __main__ as mutants
from tests.support.mutants.operators import Mutant, places_of, plant

MODULE = '''
"""Text of 1 + 1."""
import numpy as np
LIMIT = 2.0

@dataclasses.dataclass(frozen=True)
class Range:
    """Of numbers."""

def inside(x: int, *more: "1 < 2") -> bool:
    """Whether x < LIMIT + 1."""
    if not x > 0 and x != 3:
        raise ValueError(f"found {x + 1}")
    abs(x, x)
    return np.minimum(x, LIMIT) - 1 < min(x, 5) + abs(x, 5)
'''


def test_changes_are_of_code_each_of_one_place() -> None:
    found = [plant("m.py", MODULE, place) for place in places_of(MODULE)]
    small = {(m.line, m.before, m.after) for m in found if len(m.before) < 12}
    assert small == {
        (4, "2.0", "4.0"), (12, "x > 0", "x >= 0"), (12, "x != 3", "x == 3"), (12, "0", "1"), (12, "3", "4"),
        (12, "not x > 0", "not not x > 0"), (15, "min(x, 5)", "max(x, 5)"), (15, "abs(x, 5)", "abs(5, x)"),
        (15, "1", "2"), (15, "5", "6"), (15, "np.minimum", "np.maximum"),
    }  # fmt: skip
    plain = ast.unparse(ast.parse(MODULE)).splitlines()
    for mutant in found:
        lines = difflib.ndiff(plain, mutant.source.rstrip().splitlines())
        assert sum(line.startswith("+ ") for line in lines) == 1, mutant
        assert (mutant.statement, mutant.line) in ((4, 4), (12, 12), (15, 15))
    assert len({mutant.name for mutant in found}) == len(found)


@pytest.fixture
def project(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> pathlib.Path:
    """A repository with a function, a test of half of it beside it, and one of the rest elsewhere."""
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path / "cache"))
    (tmp_path / "urbanverse_mjx" / "halves").mkdir(parents=True)
    (tmp_path / "urbanverse_mjx" / "__init__.py").touch()
    (tmp_path / "urbanverse_mjx" / "halves" / "half.py").write_text(
        "def half(x):\n    if x < 0:\n        return -x\n    return x / 2\n"
    )
    for name in ("halves", "other"):
        (tmp_path / "tests" / name).mkdir(parents=True)
    (tmp_path / "tests" / "other" / "test_use.py").write_text(
        "from urbanverse_mjx.halves.half import half\n\ndef test_use():\n    assert half(-6) == 6\n"
    )
    (tmp_path / "tests" / "halves" / "test_half.py").write_text(
        "from urbanverse_mjx.halves.half import half\n\ndef test_positive():\n    assert half(4) == 2\n\n"
        "def test_negative():\n    half(-4)\n\ndef test_other():\n    assert True\n\n"
        "def test_that_fails_already():\n    assert half(-4) == half(2) == 3\n"
    )
    return tmp_path


@pytest.mark.slow
def test_a_fault_is_judged_by_the_tests_of_its_line(project: pathlib.Path) -> None:
    out, file = project / "out", "urbanverse_mjx/halves/half.py"
    out.mkdir()
    covered = mutants.coverage(out, ["tests"], root=project)
    tests = {line: {t.rpartition("::")[2] for t in covered["lines"].get(f"{file}:{line}", ())} for line in (2, 3, 4)}
    negative = {"test_negative", "test_use"}
    assert tests == {2: {"test_positive", *negative}, 3: negative, 4: {"test_positive"}}
    source = (project / file).read_text()
    found = {m.after: m for m in (plant(file, source, place) for place in places_of(source))}
    rows = {after: mutants.judge(found[after], covered, project) for after in ("x * 2", "+x")}
    assert {after: (row["outcome"], row["tests"]) for after, row in rows.items()} == {
        "x * 2": ("killed", 3),
        "+x": ("survived", 3),
    }
    assert (project / file).read_text() == source
    text = mutants.summary(list(rows.values()))
    assert "1 of 2 faults noticed (50.0 %)" in text
    assert "| urbanverse_mjx/halves/half.py:3 | `-x` | `+x` | 3 |" in text
    rows = {after: mutants.judge(found[after], covered, project, wide=True) for after in ("x * 2", "+x")}
    assert {after: (row["outcome"], row["stage"], row["tests"]) for after, row in rows.items()} == {
        "x * 2": ("killed", "near", 3),
        "+x": ("killed", "wide", 4),
    }
    text = mutants.summary(list(rows.values()))
    assert "2 of 2 faults noticed (100.0 %).\n1 of them by the tests of their own package." in text


@pytest.mark.skipif(not pathlib.Path("/proc/self").exists(), reason="no list of processes")
def test_an_interrupted_run_leaves_no_tests_running(tmp_path: pathlib.Path) -> None:
    """They run in a session of their own, which a signal to the terminal's group does not reach."""
    note = tmp_path / "running"
    (tmp_path / "test_long.py").write_text(
        f"import os, pathlib, time\n\ndef test_long():\n    pathlib.Path({str(note)!r}).write_text(str(os.getpid()))\n"
        "    time.sleep(300)\n"
    )
    program = (
        "import os, pathlib\nfrom tests.support.mutants import child\nchild.LIBRARIES = ('pytest',)\n"
        "words = ['-p', 'no:cacheprovider', 'test_long.py']\n"
        f"if __name__ == '__main__':\n    child.run_tests(pathlib.Path({str(tmp_path)!r}), os.environ, words, 200.0)\n"
    )
    (tmp_path / "program.py").write_text(program)
    environment = {**os.environ, "PYTHONPATH": str(mutants.ROOT)}
    run = subprocess.Popen([sys.executable, str(tmp_path / "program.py")], env=environment, cwd=tmp_path)
    assert waited(note.is_file, 120.0)
    assert waited(lambda: note.read_text() != "", 10.0)
    tests = pathlib.Path(f"/proc/{note.read_text()}")
    assert tests.exists()
    run.kill()
    run.wait()
    assert waited(lambda: not tests.exists() or "Z" in tests.joinpath("stat").read_text().rpartition(")")[2], 60.0)


def waited(condition: Callable[[], bool], seconds: float) -> bool:
    """Whether a condition holds within this time."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.05)
    return True


def test_tests_of_a_line_come_first_then_the_others_of_their_files() -> None:
    seconds = {"a.py::x": 5.0, "a.py::y": 1.0, "a.py::z": 2.0, "b.py::x": 0.1, "c.py::x": 9.0, "c.py::y": 3.0}
    covered = {"lines": {"m.py:1": ["a.py::x", "c.py::y"], "m.py:2": ["b.py::x"]}, "seconds": seconds}
    fault = Mutant("m.py", 1, 1, "", "", "")
    assert mutants.chosen_tests(fault, covered, 99.0) == ["c.py::y", "a.py::x", "a.py::y", "a.py::z", "c.py::x"]
    assert mutants.chosen_tests(fault, covered, 9.5) == ["c.py::y", "a.py::x", "a.py::y"]
    assert mutants.chosen_tests(fault, covered, 0.1) == ["c.py::y"], "one at least"
    assert mutants.chosen_tests(fault, covered, 9.5, "a.py") == ["a.py::x", "a.py::y", "a.py::z"]
    assert mutants.chosen_tests(fault, covered, 9.5, left_out=("a.py",)) == ["c.py::y"]
    assert mutants.chosen_tests(fault, covered, 12.0, left_out=("a.py",)) == ["c.py::y", "c.py::x"], (
        "a limit of its own"
    )
    assert mutants.chosen_tests(Mutant("n/n.py", 1, 1, "", "", ""), covered, 99.0) == []
    assert mutants.folder_of_tests(Mutant("urbanverse_mjx/a/b/c.py", 1, 1, "", "", "")) == "tests/a/"


def test_files_that_import_the_module_of_a_fault_come_first(tmp_path: pathlib.Path) -> None:
    """As for kernels, whose lines no test is seen to run: all of their folder may notice them."""
    (tmp_path / "test_a.py").write_text("import a.other\nfrom a.b import c, d\nfrom . import near\n")
    assert mutants.imported(tmp_path / "test_a.py") == {"a.other", "a.b", "a.b.c", "a.b.d"}
    seconds = {"slow.py::x": 7.0, "slow.py::y": 8.0, "fast.py::x": 1.0, "fast.py::y": 2.0}
    covered = {"lines": {"a/b/c.py:1": list(seconds)}, "seconds": seconds, "imports": {"slow.py": {"a.b.c"}}}
    found = mutants.chosen_tests(Mutant("a/b/c.py", 1, 1, "", "", ""), covered, 16.0)
    assert found == ["slow.py::x", "slow.py::y", "fast.py::x"]
    found = mutants.chosen_tests(Mutant("a/b/d.py", 1, 1, "", "", ""), covered, 10.0)
    assert found == ["fast.py::x", "fast.py::y", "slow.py::x"]


def test_a_fault_in_a_line_of_the_import_is_judged_first_by_the_tests_of_defaults() -> None:
    seconds = {"tests/a/test_b.py::x": 1.0, "tests/b/test_defaults.py::x": 2.0}
    covered = {"lines": {"a/c.py:3": ["tests/a/test_b.py::x"]}, "seconds": seconds}
    found = {n: mutants.chosen_tests(Mutant("a/c.py", n, n, "", "", ""), covered, 9.0, "tests/a/") for n in (1, 3)}
    assert found == {1: ["tests/b/test_defaults.py::x", "tests/a/test_b.py::x"], 3: ["tests/a/test_b.py::x"]}


def test_what_was_missed_is_judged_again_with_the_other_folders() -> None:
    rows = [
        {"outcome": outcome, "wide": wide} for outcome in ("killed", "survived", "uncovered") for wide in (False, True)
    ]
    assert [mutants.settled(row, wide=True) for row in rows] == [True, True, False, True, False, True]
    assert all(mutants.settled(row, wide=False) for row in rows)
    older = {"outcome": "killed", "file": "urbanverse_mjx/a.py", "line": 1, "before": "", "after": ""}
    assert "1 of 1 faults noticed" in mutants.summary([older]), "of a folder from before there were stages"


def test_a_fault_that_no_test_ran_is_not_planted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mutants, "planted", lambda *_: pytest.fail("planted"))
    row = mutants.judge(Mutant("urbanverse_mjx/a/b.py", 1, 1, "", "", ""), {"lines": {}, "seconds": {}}, wide=True)
    assert (row["outcome"], row["tests"], row["wide"]) == ("uncovered", 0, True)


def test_a_file_of_tests_that_changed_is_run_again(project: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ran: list[str] = []

    def run(path: str, marks: str, root: pathlib.Path) -> dict[str, dict[str, float]]:
        ran.append(path)
        return {"tests": {}, "seconds": {}}

    def files_that_ran(marks: str) -> list[str]:
        ran.clear()
        mutants.coverage(project, ["tests"], marks, project)
        return list(ran)

    monkeypatch.setattr(mutants, "_run_with_coverage", run)
    both = ["tests/halves/test_half.py", "tests/other/test_use.py"]
    assert [files_that_ran("not slow"), files_that_ran("not slow"), files_that_ran("slow")] == [both, [], both]
    (project / both[1]).write_text("def test_use():\n    pass\n")
    assert files_that_ran("not slow") == both[1:]


def test_tests_of_a_kernel_are_those_that_ran_its_folder() -> None:
    lines = {"a/engine.py:3": ["x"], "a/kernels.py:1": ["y"], "b/engine.py:3": ["z"]}
    tests = {f: mutants.tests_of(Mutant(f, 9, 9, "", "", ""), lines) for f in ("a/bodies.py", "a/kernels.py", "c/d.py")}
    assert tests == {"a/bodies.py": {"x", "y"}, "a/kernels.py": {"y"}, "c/d.py": set()}


def test_the_sample_is_the_same_for_a_seed_and_goes_on(project: pathlib.Path, tmp_path: pathlib.Path) -> None:
    samples = [[m.name for m in mutants.sample_of(project, ["halves/half.py"], 3, seed)] for seed in (0, 0, 1)]
    assert samples[0] == samples[1] != samples[2]
    (tmp_path / "results.jsonl").write_text('{"name": "a", "outcome": "killed"}\n{"name": "b", "out')
    assert [row["name"] for row in mutants.results(tmp_path)] == ["a"]
