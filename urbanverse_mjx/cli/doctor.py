"""`urbanverse doctor`: what this machine has, and the command that fixes what is missing.

Every check runs in a process of its own, so that a package that crashes, hangs or gives wrong information about itself
affects one line of the table only. Exit status 0 if all requirements of `make train` are met, 1 otherwise.
"""

import argparse
import concurrent.futures
import dataclasses
import json
import signal
import subprocess
import sys
from collections.abc import Sequence

from .. import __version__
from .doctor_checks import CHECKS, Finding, reinstall

#: s; the first frame on a machine compiles the renderer's kernels (20 s on a GPU, docs/sources/measured.md).
TIMEOUT = 300.0


@dataclasses.dataclass(frozen=True)
class Row:
    """One line of the table: a finding and whether the main job needs it."""

    name: str
    required: bool
    finding: Finding


def examine(name: str, timeout: float = TIMEOUT) -> Row:
    """Runs one check in a fresh interpreter; whatever happens to it becomes a finding."""
    required, package = CHECKS[name].required, CHECKS[name].package
    fix = reinstall(package) if package else "make setup"
    command = [sys.executable, "-m", "urbanverse_mjx.cli.doctor_checks", name]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=timeout, check=False)
    except subprocess.TimeoutExpired:
        return Row(name, required, Finding("problem", f"no answer within {timeout:.0f} s", fix))
    lines = done.stdout.strip().splitlines()
    try:
        return Row(name, required, Finding(**json.loads(lines[-1])))
    except (IndexError, TypeError, ValueError):
        return Row(name, required, Finding("problem", f"the check {_ending(done)}", fix))


def _ending(done: subprocess.CompletedProcess[str]) -> str:
    how = f"ended with status {done.returncode}"
    if done.returncode < 0:
        how = f"was killed by {signal.Signals(-done.returncode).name}"
    said = done.stderr.strip().splitlines()
    return f"{how}: {said[-1][:160]}" if said else how


def examine_all(names: Sequence[str], workers: int = 2) -> list[Row]:
    """Rows in the order of `names`. Two at a time: each loads a large library."""
    with concurrent.futures.ThreadPoolExecutor(workers) as pool:
        return list(pool.map(examine, names))


def table(rows: Sequence[Row]) -> str:
    """The rows as text, with the fixes below what they fix."""
    lines = []
    for row in rows:
        status = row.finding.status
        if status == "missing" and not row.required:
            status = "absent"
        lines.append(f"{row.name:<13} {status:<8} {row.finding.detail}")
        if row.finding.fix:
            lines.append(f"{'':<13} {'':<8} fix: {row.finding.fix}")
    return "\n".join(lines)


def able(rows: Sequence[Row]) -> bool:
    """Whether everything that the main job needs was found in order."""
    return all(row.finding.status == "ok" for row in rows if row.required)


def main(argv: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="urbanverse doctor", description=__doc__)
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.add_argument("--only", nargs="+", choices=list(CHECKS), metavar="CHECK", help=f"of {', '.join(CHECKS)}")
    arguments = parser.parse_args(argv)
    rows = examine_all(arguments.only or list(CHECKS))
    if arguments.json:
        checks = {r.name: {"required": r.required, **dataclasses.asdict(r.finding)} for r in rows}
        print(json.dumps({"urbanverse": __version__, "able": able(rows), "checks": checks}, ensure_ascii=False))
    else:
        print(table(rows))
        print()
        if able(rows):
            print("Everything the main job needs is here.")
        else:
            wanting = ", ".join(r.name for r in rows if r.required and r.finding.status != "ok")
            print(f"The main job cannot run yet: {wanting}.")
    return 0 if able(rows) else 1
