"""Inserts faults and lists those that no test detects: `make mutants`; `python -m tests.support.mutants --help` has
options.

Results are kept in a folder: an interrupted run continues, `--again` begins anew.
"""

import argparse
import collections
import contextlib
import json
import os
import pathlib
import random
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from urbanverse_mjx import settings
from urbanverse_mjx.work_folder import work_folder

from .covered import OUT
from .operators import Mutant, places_of, plant

ROOT = pathlib.Path(__file__).parents[3]
PACKAGE = "urbanverse_mjx"
#: Packages to change: those where a wrong number is hard to notice.
TARGETS = ("envs/navigation", "envs/joystick", "evaluation", "scene", "simulation", "crowds", "training")
#: Tests of the text of the code notice every change of it.
LEFT_OUT = ("tests/project/",)
#: Caches that tests need; linked anew for each fault, which may spoil them.
CACHES = ("assets", "banks", "crowds", "meshes", "surroundings")
_SLOWER, _START = 5.0, 120.0  # times as long as without the fault, and s, before tests are ended


def main() -> int:
    options = _options()
    out = options.out.absolute()
    if options.again:
        for name in ("coverage.json", "results.jsonl"):
            (out / name).unlink(missing_ok=True)
    out.mkdir(parents=True, exist_ok=True)
    covered = coverage(out, options.tests, options.workers)
    sample = sample_of(ROOT, options.targets, options.number, options.seed)
    done = {row["name"]: row for row in results(out)}
    with (out / "results.jsonl").open("a", encoding="utf-8") as file:
        for number, mutant in enumerate(sample):
            if mutant.name in done:
                continue
            row = judge(mutant, covered)
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
    parser.add_argument("--tests", nargs="+", default=["tests"], help="tests that may notice them")
    parser.add_argument("--workers", default="logical", help="test processes while coverage is recorded")
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


def coverage(out: pathlib.Path, tests: Sequence[str], workers: str, root: pathlib.Path = ROOT) -> dict[str, Any]:
    """{"lines": {"file:line": [tests]}, "seconds": {test: s}} of the tests, from the last run where there is one."""
    path = out / "coverage.json"
    if path.is_file():
        return json.loads(path.read_text(encoding="utf-8"))
    with work_folder("urbanverse-coverage-") as parts:
        command = [sys.executable, "-m", "pytest", "-q", "-n", workers, "-p", "tests.support.mutants.covered"]
        left_out = [f"--ignore={name}" for name in LEFT_OUT]
        environment = {**os.environ, OUT: str(parts), "PYTHONPATH": f"{root}{os.pathsep}{ROOT}"}
        done = subprocess.run([*command, *left_out, *tests], cwd=root, env=environment, check=False)
        if done.returncode:
            raise SystemExit(f"mutants: found tests that fail without a fault (status {done.returncode}).")
        lines, seconds = collections.defaultdict(list), {}
        for part in sorted(parts.glob("*.json")):
            body = json.loads(part.read_text())
            seconds |= body["seconds"]
            for test, places in body["tests"].items():
                for file, line in places:
                    lines[f"{file}:{line}"].append(test)
    body = {"lines": lines, "seconds": seconds}
    path.write_text(json.dumps(body))
    return body


def tests_of(mutant: Mutant, lines: Mapping[str, Sequence[str]]) -> set[str]:
    """The tests that ran a mutant's line; of one that runs when its module is imported, all that ran the module."""
    places = [f"{mutant.file}:{line}" for line in (mutant.line, mutant.statement)]
    found = {test for place in places for test in lines.get(place, ())}
    of_module = (tests for place, tests in lines.items() if place.startswith(f"{mutant.file}:"))
    return found or {test for tests in of_module for test in tests}


def judge(mutant: Mutant, covered: Mapping[str, Any], root: pathlib.Path = ROOT) -> dict[str, Any]:
    """Results of the tests that ran a mutant's line, the fastest first."""
    seconds = covered["seconds"]
    tests = sorted(tests_of(mutant, covered["lines"]), key=lambda test: seconds.get(test, 0.0))
    begin, outcome, said = time.monotonic(), "uncovered", ""
    if tests:
        limit = _START + _SLOWER * sum(seconds.get(test, 0.0) for test in tests)
        with planted(mutant, root) as (folder, environment):
            (folder / "chosen.txt").write_text("\n".join(tests))
            command = [sys.executable, "-m", "pytest", "-q", "-x", "-n", "0", "-p", "no:cacheprovider", "@chosen.txt"]
            try:
                done = subprocess.run(
                    command, cwd=folder, env=environment, capture_output=True, text=True, timeout=limit, check=False
                )
                outcome = "survived" if done.returncode == 0 else "killed"
                said = next((x for x in done.stdout.splitlines() if x.startswith(("FAILED", "ERROR"))), "")
            except subprocess.TimeoutExpired:
                outcome = "timeout"
    place = {"name": mutant.name, "file": mutant.file, "line": mutant.line}
    change = {"before": mutant.before, "after": mutant.after, "outcome": outcome, "tests": len(tests)}
    return place | change | {"said": said[:200], "seconds": round(time.monotonic() - begin, 1)}


@contextlib.contextmanager
def planted(mutant: Mutant, root: pathlib.Path) -> Iterator[tuple[pathlib.Path, dict[str, str]]]:
    """A copy of the repository with the fault, and the environment in which its tests run."""
    with work_folder("urbanverse-mutant-") as folder:
        for path in root.iterdir():
            if path.name in (PACKAGE, "tests"):
                shutil.copytree(path, folder / path.name, copy_function=_link, ignore=_no_bytecode)
            elif path.name not in (".git", "build", "runs"):
                (folder / path.name).symlink_to(path)
        changed = folder / mutant.file
        changed.unlink()
        changed.write_text(mutant.source, encoding="utf-8")
        for name in CACHES:
            if settings.cache_dir(name).is_dir():
                shutil.copytree(settings.cache_dir(name), folder / ".cache" / name, copy_function=_link)
        environment = {**os.environ, "PYTHONPATH": str(folder), "URBANVERSE_CACHE": str(folder / ".cache")}
        yield folder, environment


def _link(source: str, target: str) -> None:
    """A hard link, since files are never changed in place."""
    try:
        os.link(source, target)
    except OSError:  # another disk
        shutil.copy2(source, target)


def _no_bytecode(folder: str, names: Sequence[str]) -> list[str]:
    return [name for name in names if name == "__pycache__"]


def results(out: pathlib.Path) -> list[dict[str, Any]]:
    """Results of earlier runs; a truncated line does not count."""
    path = out / "results.jsonl"
    rows = []
    for line in path.read_text(encoding="utf-8").splitlines() if path.is_file() else ():
        with contextlib.suppress(ValueError):
            rows.append(json.loads(line))
    return rows


def summary(rows: Sequence[Mapping[str, Any]]) -> str:
    """Markdown: how many were noticed, by folder, and every one that was not."""
    noticed = [row for row in rows if row["outcome"] in ("killed", "timeout")]
    lines = [f"{len(noticed)} of {len(rows)} faults noticed ({100.0 * len(noticed) / max(len(rows), 1):.1f} %).", ""]
    folders = collections.Counter(row["file"].rpartition("/")[0] for row in rows)
    good = collections.Counter(row["file"].rpartition("/")[0] for row in noticed)
    lines += ["| folder | faults | noticed |", "| --- | --- | --- |"]
    lines += [f"| {folder} | {count} | {good[folder]} |" for folder, count in sorted(folders.items())]
    lines += ["", "| missed | before | after | tests that ran the line |", "| --- | --- | --- | --- |"]
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
