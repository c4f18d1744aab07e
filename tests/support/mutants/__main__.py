"""Inserts faults and lists those that no test detects: `make mutants`; `python -m tests.support.mutants --help` has
options.

A fault is judged by tests that ran its line: first by those in the folder of tests of its package, and, if they do not
notice it and `--wide` is given, by those in the other folders. Results are kept in a folder: an interrupted run
continues, `--again` begins anew.
"""

import argparse
import ast
import collections
import contextlib
import hashlib
import itertools
import json
import os
import pathlib
import random
import shutil
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from urbanverse_mjx import settings
from urbanverse_mjx.work_folder import work_folder

from .child import run_tests
from .covered import OUT
from .operators import Mutant, places_of, plant

ROOT = pathlib.Path(__file__).parents[3]
PACKAGE = "urbanverse_mjx"
#: Packages to change: those where a wrong number is hard to notice.
TARGETS = ("envs/navigation", "envs/joystick", "evaluation", "scene", "simulation", "crowds", "training")
#: Tests that run them.
TESTS = (
    *("tests/crowds", "tests/evaluation", "tests/scene", "tests/envs", "tests/training", "tests/simulation"),
    *("tests/robots", "tests/geometry", "tests/datatypes", "tests/pipeline", "tests/gym", "tests/viewer", "tests/cli"),
)
#: Marks of those that continuous integration runs: the quick and the extended ones; and of the quick ones alone.
MARKS, QUICK = "not slow and not gpu", "not extended and not slow and not gpu"
#: Tests of the text of the code notice every change of it.
LEFT_OUT = ("tests/project/",)
#: Ends of files whose tests compare constants and defaults of modules: tracing does not show which values they read.
DEFAULTS = "_defaults.py"
#: Caches that tests need; linked anew for each fault, which may spoil them.
CACHES = ("assets", "banks", "crowds", "kernels", "light", "meshes", "surroundings", "tests/jax")
#: Caches without which a fault in these packages is judged: a table that was made without it would hide it.
MADE_BY = {"crowds": ("crowds/", "envs/navigation/"), "light": ("simulation/rendering/",), "surroundings": ("scene/",)}
#: Outcomes of a fault that tests notice.
NOTICED = ("killed", "timeout")
_START = 90.0  # s, for imports, before tests are ended
_LONGEST = 3600.0  # s, for the tests of a file without a fault


def main() -> int:
    options = _options()
    out = options.out.absolute()
    if options.again:
        shutil.rmtree(out / "coverage", ignore_errors=True)
        (out / "results.jsonl").unlink(missing_ok=True)
    out.mkdir(parents=True, exist_ok=True)
    marks = QUICK if options.quick else MARKS
    covered = coverage(out, options.tests, marks)
    sample = sample_of(ROOT, options.targets, options.number, options.seed)
    done = {row["name"]: row for row in results(out)}
    with (out / "results.jsonl").open("a", encoding="utf-8") as file:
        for number, mutant in enumerate(sample):
            if mutant.name in done and settled(done[mutant.name], options.wide):
                continue
            limits = {"seconds": options.seconds, "slower": options.slower}
            row = judge(mutant, covered, marks=marks, wide=options.wide, **limits)
            done[mutant.name] = row
            file.write(json.dumps(row) + "\n")
            file.flush()
            sys.stderr.write(f"{number + 1}/{len(sample)} {row['outcome']:<9} {_place(row)}\n")
    print(summary([done[mutant.name] for mutant in sample]))
    return 0


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.support.mutants", description=__doc__)
    parser.add_argument("--number", type=int, default=120, help="faults that are planted")
    parser.add_argument("--seed", type=int, default=0, help="of the sample")
    parser.add_argument("--targets", nargs="+", default=TARGETS, help=f"files or folders of {PACKAGE}")
    parser.add_argument("--tests", nargs="+", default=TESTS, help="files or folders of tests that may notice them")
    parser.add_argument(
        "--seconds", type=float, default=300.0, help="of tests for one fault, as long as they take without it"
    )
    parser.add_argument(
        "--slower", type=float, default=4.0, help="times as long as without the fault before tests are ended"
    )
    parser.add_argument("--quick", action="store_true", help="only with the tests that `make test` runs")
    parser.add_argument("--wide", action="store_true", help="what its own folder misses, also with the other folders")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "build" / "mutants", help="folder of results")
    parser.add_argument("--again", action="store_true", help="forget what was done")
    return parser.parse_args()


def sample_of(root: pathlib.Path, targets: Sequence[str], number: int, seed: int) -> list[Mutant]:
    """So many changes of the targets, each as probable as another; the same ones for the same code and seed."""
    paths = [root / PACKAGE / target for target in targets]
    files = sorted({f for path in paths for f in (path.rglob("*.py") if path.is_dir() else [path])})
    places = [(file, place) for file in files for place in places_of(file.read_text(encoding="utf-8"))]
    chosen = random.Random(seed).sample(places, min(number, len(places)))
    return [plant(str(f.relative_to(root)), f.read_text(encoding="utf-8"), place) for f, place in chosen]


def coverage(out: pathlib.Path, tests: Sequence[str], marks: str = MARKS, root: pathlib.Path = ROOT) -> dict[str, Any]:
    """{"lines": {"file:line": [tests]}, "seconds": {test: s}, "imports": {file of tests: modules}} of the tests that
    pass; each file of `tests`, which may be folders, is run once in a process of its own and its result kept until it
    changes."""
    lines, seconds = collections.defaultdict[str, list[str]](list), dict[str, float]()
    (out / "coverage").mkdir(exist_ok=True)
    for path in _files_of(root, tests):
        digest = hashlib.sha256(marks.encode() + (root / path).read_bytes()).hexdigest()[:12]
        kept = out / "coverage" / f"{path.replace('/', '-')}-{digest}.json"
        if not kept.is_file():
            kept.write_text(json.dumps(_run_with_coverage(path, marks, root)))
        body = json.loads(kept.read_text(encoding="utf-8"))
        seconds |= body["seconds"]
        for test, files in body["tests"].items():
            for file, numbers in files.items():
                for line in numbers:
                    lines[f"{file}:{line}"].append(test)
    files = {test.partition("::")[0] for test in seconds}
    return {"lines": lines, "seconds": seconds, "imports": {file: imported(root / file) for file in files}}


def imported(path: pathlib.Path) -> set[str]:
    """Modules, by their dotted names, that a file imports, and what it imports of them."""
    found = set[str]()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            found |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    return found


def _files_of(root: pathlib.Path, tests: Sequence[str]) -> list[str]:
    paths = [root / path for path in tests]
    files = {f for path in paths for f in (path.rglob("test_*.py") if path.is_dir() else [path])}
    names = sorted(str(file.relative_to(root)) for file in files)
    return [name for name in names if not name.startswith(LEFT_OUT)]


def _run_with_coverage(path: str, marks: str, root: pathlib.Path) -> dict[str, Any]:
    """{"tests": {test: {file: [lines]}}, "seconds": {test: s}} of the tests in a file that pass."""
    with work_folder("urbanverse-coverage-") as parts:
        words = ["-q", "-n", "0", "-p", "no:cacheprovider", "-p", "tests.support.mutants.covered", "-m", marks, path]
        environment = {**os.environ, OUT: str(parts), "PYTHONPATH": f"{root}{os.pathsep}{ROOT}"}
        status, text = run_tests(root, environment, words, _LONGEST, parts / "output.txt")
        if status not in (0, 1, 5):
            raise SystemExit(f"mutants: found that the tests in {path} do not run (status {status}).\n{text[-2000:]}")
        body: dict[str, Any] = {"tests": {}, "seconds": {}}
        for part in sorted(parts.glob("*.json")):
            found = json.loads(part.read_text())
            failed = set(found["failed"])
            if failed:
                sys.stderr.write(f"mutants: left out, as they fail without a fault: {', '.join(sorted(failed))}\n")
            for key, of_test in body.items():
                of_test.update((test, x) for test, x in found[key].items() if test not in failed)
    return body


def tests_of(mutant: Mutant, lines: Mapping[str, Sequence[str]]) -> set[str]:
    """The tests that ran a mutant's line; of one that runs when its module is imported, all that ran the module; of
    kernels, which Warp compiles, all that ran its folder."""

    def of(start: str) -> set[str]:
        return {test for place, tests in lines.items() if place.startswith(start) for test in tests}

    places = [f"{mutant.file}:{line}" for line in (mutant.line, mutant.statement)]
    found = {test for place in places for test in lines.get(place, ())}
    return found or of(f"{mutant.file}:") or of(f"{mutant.file.rpartition('/')[0]}/")


def chosen_tests(
    mutant: Mutant, covered: Mapping[str, Any], limit: float, start: str = "", left_out: tuple[str, ...] = ()
) -> list[str]:
    """Tests that may notice a fault and whose names begin so and not like `left_out`, as many as take so long without
    it (s), at least one: those that ran its line, then the others of their files, since what one test traces or a
    fixture computes, others check; of both, those of files that import its module first, then the fastest. A fault in
    a line that no test ran, since it runs when its module is imported, is judged first by the tests that compare what
    modules hold then."""
    seconds: Mapping[str, float] = covered["seconds"]
    module = mutant.file.removesuffix(".py").replace("/", ".")
    near = {file for file, names in covered.get("imports", {}).items() if module in names}

    def compares(test: str) -> bool:
        return test.partition("::")[0].endswith(DEFAULTS)

    def rank(test: str) -> tuple[bool, bool, float]:
        return not compares(test), test.partition("::")[0] not in near, seconds.get(test, 0.0)

    ran = tests_of(mutant, covered["lines"])
    if not any(f"{mutant.file}:{line}" in covered["lines"] for line in (mutant.line, mutant.statement)):
        ran |= {test for test in seconds if compares(test)}
    ran = {test for test in ran if (test.startswith(start) or compares(test)) and not test.startswith(left_out)}
    files = {test.partition("::")[0] for test in ran}
    others = {test for test in seconds if test.partition("::")[0] in files} - ran
    tests = [test for part in (ran, others) for test in sorted(part, key=rank)]
    total = itertools.accumulate(seconds.get(test, 0.0) for test in tests)
    return tests[: max(1, sum(t <= limit for t in total))]


def folder_of_tests(mutant: Mutant) -> str:
    """The folder of the tests of a mutant's package, such as "tests/scene/"."""
    return f"tests/{mutant.file.split('/')[1]}/"


def judge(
    mutant: Mutant,
    covered: Mapping[str, Any],
    root: pathlib.Path = ROOT,
    seconds: float = 300.0,
    marks: str = MARKS,
    wide: bool = False,
    slower: float = 4.0,
) -> dict[str, Any]:
    """Results of the `chosen_tests` of a mutant in the `folder_of_tests` of its package, and, where they miss it and
    `wide` is true, of those in all other folders; "stage" tells which noticed it."""
    begin, near = time.monotonic(), folder_of_tests(mutant)
    stages = {"near": chosen_tests(mutant, covered, seconds, near)}
    if wide:
        stages["wide"] = chosen_tests(mutant, covered, seconds, left_out=(near,))
    row = {"outcome": "uncovered", "stage": "near", "tests": 0, "said": ""}
    if any(stages.values()):
        with planted(mutant, root) as (folder, environment):
            row |= _run_stages(folder, environment, stages, covered["seconds"], marks, slower)
    place = {"name": mutant.name, "file": mutant.file, "line": mutant.line, "wide": wide}
    change = {"before": mutant.before, "after": mutant.after}
    return place | change | row | {"seconds": round(time.monotonic() - begin, 1)}


def _run_stages(
    folder: pathlib.Path,
    environment: Mapping[str, str],
    stages: Mapping[str, Sequence[str]],
    seconds: Mapping[str, float],
    marks: str,
    slower: float,
) -> dict[str, Any]:
    """Runs the tests of one stage after the other until one notices the fault."""
    row: dict[str, Any] = {}
    ran = 0
    for stage, tests in stages.items():
        if not tests:
            continue
        limit = _START + slower * sum(seconds.get(test, 0.0) for test in tests)
        (folder / "chosen.txt").write_text("\n".join(tests))
        words = ["-q", "-x", "-n", "0", "-m", marks, "-p", "no:cacheprovider", "@chosen.txt"]
        status, text = run_tests(folder, environment, words, limit)
        said = next((x for x in text.splitlines() if x.startswith(("FAILED", "ERROR"))), "")
        outcome = {0: "survived", None: "timeout"}.get(status, "killed")
        ran += len(tests)
        row = {"outcome": outcome, "stage": stage, "tests": ran, "said": said[:200]}
        if outcome != "survived":
            break
    return row


@contextlib.contextmanager
def planted(mutant: Mutant, root: pathlib.Path) -> Iterator[tuple[pathlib.Path, dict[str, str]]]:
    """A copy of the repository with the fault, and the environment in which its tests run."""
    with work_folder("urbanverse-mutant-") as folder:
        for path in root.iterdir():
            if path.name in (PACKAGE, "tests"):
                shutil.copytree(path, folder / path.name, copy_function=_link)
            elif path.name not in (".git", "build", "runs"):
                (folder / path.name).symlink_to(path)
        changed = folder / mutant.file
        changed.unlink()
        changed.write_text(mutant.source, encoding="utf-8")
        for name in CACHES:
            made_here = mutant.file.removeprefix(f"{PACKAGE}/").startswith(MADE_BY.get(name, ()))
            if settings.cache_dir(name).is_dir() and not made_here:
                shutil.copytree(settings.cache_dir(name), folder / ".cache" / name, copy_function=_link)
        environment = {**os.environ, "PYTHONPATH": str(folder), "URBANVERSE_CACHE": str(folder / ".cache")}
        yield folder, environment


def _link(source: str, target: str) -> None:
    """A hard link, since files are never changed in place."""
    try:
        os.link(source, target)
    except OSError:  # another disk
        shutil.copy2(source, target)


def results(out: pathlib.Path) -> list[dict[str, Any]]:
    """Results of earlier runs; a truncated line does not count."""
    path = out / "results.jsonl"
    rows = []
    for line in path.read_text(encoding="utf-8").splitlines() if path.is_file() else ():
        with contextlib.suppress(ValueError):
            rows.append(json.loads(line))
    return rows


def settled(row: Mapping[str, Any], wide: bool) -> bool:
    """Whether a kept result answers: not one that was missed without the other folders, if they are asked for."""
    return not wide or row["outcome"] in NOTICED or row.get("wide", False)


def summary(rows: Sequence[Mapping[str, Any]]) -> str:
    """Markdown: how many were noticed, by folder, and every one that was not."""
    noticed = [row for row in rows if row["outcome"] in NOTICED]
    lines = [f"{len(noticed)} of {len(rows)} faults noticed ({100.0 * len(noticed) / max(len(rows), 1):.1f} %)."]
    if wide := sum(row.get("stage") == "wide" for row in noticed):
        lines.append(f"{len(noticed) - wide} of them by the tests of their own package.")
    lines.append("")
    folders = collections.Counter(row["file"].rpartition("/")[0] for row in rows)
    good = collections.Counter(row["file"].rpartition("/")[0] for row in noticed)
    lines += ["| folder | faults | noticed |", "| --- | --- | --- |"]
    lines += [f"| {folder} | {count} | {good[folder]} |" for folder, count in sorted(folders.items())]
    lines += ["", "| missed | before | after | tests |", "| --- | --- | --- | --- |"]
    for row in sorted(rows, key=lambda row: (row["file"], row["line"])):
        if row not in noticed:
            before, after = (" ".join(row[key].split())[:100].replace("|", "\\|") for key in ("before", "after"))
            lines.append(f"| {row['file']}:{row['line']} | `{before}` | `{after}` | {row['tests']} |")
    return "\n".join(lines)


def _place(row: Mapping[str, Any]) -> str:
    before, after = (" ".join(row[key].split())[:60] for key in ("before", "after"))
    return f"{row['seconds']:7.1f} s  {row['file']}:{row['line']}  {before}  ->  {after}"


if __name__ == "__main__":
    sys.exit(main())
