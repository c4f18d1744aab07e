"""`urbanverse doctor`: checks this machine and prints commands that fix problems.

Every check runs in a process of its own, so that a package that crashes or hangs affects only one line of the table.
Exit status 0 if all requirements of `make train` are met, 1 otherwise.
"""

import argparse
import concurrent.futures
import dataclasses
import json
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence

from .. import __version__
from .doctor_checks import CHECKS, Finding, reinstall

#: s of processor time, because checks take much longer in wall time on a busy machine. The first frame on a machine
#: compiles the renderer's kernels (20 s on a GPU, docs/sources/measured.md).
TIMEOUT = 300.0
#: s of wall time without computation after which a check counts as hanging.
IDLE_TIMEOUT = 120.0
#: Share of one core below which a process counts as idle.
_IDLE_SHARE = 0.01


@dataclasses.dataclass(frozen=True)
class Row:
    """One line of the table: a finding and whether the main job needs it."""

    name: str
    required: bool
    finding: Finding


def examine(name: str, timeout: float = TIMEOUT, idle: float = IDLE_TIMEOUT) -> Row:
    """Runs one check in a new interpreter; crashes and time-outs become findings.

    Args:
      name: a key of `CHECKS`.
      timeout: s of processor time that the check may take.
      idle: s of wall time that it may be idle.
    """
    required, package = CHECKS[name].required, CHECKS[name].package
    fix = reinstall(package) if package else "make setup"
    command = [sys.executable, "-m", "urbanverse_mjx.cli.doctor_checks", name]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        try:
            stdout, stderr = _answer(process, timeout, idle)
        except TimeoutError as error:
            return Row(name, required, Finding("problem", str(error), fix))
        except BaseException:
            process.kill()
            raise
    lines = stdout.strip().splitlines()
    try:
        return Row(name, required, Finding(**json.loads(lines[-1])))
    except (IndexError, TypeError, ValueError):
        return Row(name, required, Finding("problem", f"the check {_ending(process.returncode, stderr)}", fix))


def _answer(process: subprocess.Popen[str], timeout: float, idle: float) -> tuple[str, str]:
    """The output of the process; kills it and raises TimeoutError if it computes for too long or is idle."""
    worked = moved = 0.0
    since = time.monotonic()
    while True:
        try:
            return process.communicate(timeout=min(1.0, timeout, idle))
        except subprocess.TimeoutExpired:
            now = time.monotonic()
            worked = max(worked, _processor_seconds(process.pid))
        if worked - moved > _IDLE_SHARE * (now - since):
            moved, since = worked, now
        if worked >= timeout:
            said = f"no answer after {timeout:.0f} s of the processor's time"
        elif now - since >= idle:
            said = f"no answer, and nothing computed for {idle:.0f} s"
        else:
            continue
        process.kill()
        process.communicate()
        raise TimeoutError(said)


def _processor_seconds(pid: int) -> float:
    """Processor time in s of a process and its children, such as compilers; 0 if psutil does not report it."""
    try:
        import psutil

        process = psutil.Process(pid)
        times = [p.cpu_times() for p in (process, *process.children(recursive=True))]
    except Exception:  # the doctor examines machines with broken packages; the process may also have just ended
        return 0.0
    return sum(t.user + t.system for t in times)


def _ending(status: int, stderr: str) -> str:
    how = f"ended with status {status}"
    if status < 0:
        how = f"was killed by {signal.Signals(-status).name}"
    said = stderr.strip().splitlines()
    return f"{how}: {said[-1][:160]}" if said else how


def examine_all(names: Sequence[str], workers: int = 2) -> Iterator[Row]:
    """Yields rows in the order of `names` as soon as they are available. Two checks run in parallel, because each loads
    a large library."""
    with concurrent.futures.ThreadPoolExecutor(workers) as pool:
        yield from pool.map(examine, names)


def line(row: Row) -> str:
    """Formats a row as text, with the fix below the finding."""
    status = row.finding.status
    if status == "missing" and not row.required:
        status = "absent"
    text = f"{row.name:<13} {status:<8} {row.finding.detail}"
    return f"{text}\n{'':<13} {'':<8} fix: {row.finding.fix}" if row.finding.fix else text


def able(rows: Sequence[Row]) -> bool:
    """Whether all requirements of `make train` are met."""
    return all(row.finding.status == "ok" for row in rows if row.required)


def main(argv: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="urbanverse doctor", description=__doc__)
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.add_argument("--only", nargs="+", choices=list(CHECKS), metavar="CHECK", help=f"of {', '.join(CHECKS)}")
    arguments = parser.parse_args(argv)
    names = arguments.only or list(CHECKS)
    if not arguments.json:
        sys.stderr.write(f"{len(names)} checks; on a new machine they compile kernels, for a minute or more\n")
    rows = []
    for row in examine_all(names):
        rows.append(row)
        if not arguments.json:
            print(line(row), flush=True)
    if arguments.json:
        checks = {r.name: {"required": r.required, **dataclasses.asdict(r.finding)} for r in rows}
        print(json.dumps({"urbanverse": __version__, "able": able(rows), "checks": checks}, ensure_ascii=False))
    else:
        print()
        if able(rows):
            print("Everything the main job needs is here.")
        else:
            wanting = ", ".join(r.name for r in rows if r.required and r.finding.status != "ok")
            print(f"The main job cannot run yet: {wanting}.")
    return 0 if able(rows) else 1
