"""Runs a command again and again, each time with another of its accesses to files disturbed.

`python -m tests.support.disturbed FOLDER KIND WORD ...`: FOLDER holds `cache`, which each run gets a copy of, and the
command's inputs; KIND is `deleted` (the cache is removed then) or `refused` (a write raises one of `REFUSALS`), and
`KIND:N` disturbs the last N accesses only. Run k, a forked process in FOLDER/k, disturbs the k-th access; in a WORD,
`{run}` stands for that folder. Prints one JSON line per run; the last one had fewer accesses than k.
"""

import errno
import importlib
import itertools
import json
import os
import pathlib
import shutil
import sys
import traceback
from collections.abc import Callable
from typing import Any

#: Audit events of accesses by name.
_CHANGES = ("os.mkdir", "os.rename")
#: Of a full disk, a read-only file system, a quota and a folder of someone else.
REFUSALS = (errno.ENOSPC, errno.EROFS, errno.EDQUOT, errno.EACCES)


def _writes(event: str, args: tuple[Any, ...]) -> bool:
    if event == "open":
        return bool(args[2] & (os.O_WRONLY | os.O_RDWR | os.O_CREAT))
    return event in _CHANGES


def _hook(kind: str, run: pathlib.Path, number: int, seen: list[str]) -> Callable[[str, tuple[Any, ...]], None]:
    """An audit hook that disturbs access `number`, from 0, and lists the accesses before and at it."""
    below = f"{run / 'cache' if kind == 'deleted' else run}/"

    def hook(event: str, args: tuple[Any, ...]) -> None:
        if len(seen) > number or (event != "open" and event not in _CHANGES):
            return
        name = os.fsdecode(args[0]) if isinstance(args[0], str | bytes | os.PathLike) else ""
        if not name.startswith(below) or not (kind == "deleted" or _writes(event, args)):
            return
        seen.append(f"{event} {name.removeprefix(below)}")
        if len(seen) > number:
            if kind == "refused":
                code = REFUSALS[number % len(REFUSALS)]
                raise OSError(code, os.strerror(code), name)
            shutil.rmtree(run / "cache", ignore_errors=True)

    return hook


def _run(words: list[str], folder: pathlib.Path, kind: str, number: int) -> dict[str, Any]:
    """Runs the command in a forked process; returns its exit status, what it wrote and what was disturbed."""
    run = folder / str(number)
    shutil.copytree(folder / "cache", run / "cache")
    process = os.fork()  # the parent imports modules, and runs nothing of them
    if process == 0:
        os.environ["URBANVERSE_CACHE"] = str(run / "cache")
        with (folder / f"{number}.out").open("w") as out, (folder / f"{number}.err").open("w") as err:
            os.dup2(out.fileno(), 1)
            os.dup2(err.fileno(), 2)
        seen: list[str] = []
        status: Any = "traceback"
        try:
            from urbanverse_mjx.cli.main import main

            sys.addaudithook(_hook(kind, run, number, seen))
            status = main([word.format(run=run) for word in words])
        except BaseException:
            traceback.print_exc()
        finally:
            body = {"status": status, "seen": seen, "modules": [n for n in sys.modules if n.startswith("urban")]}
            (folder / f"{number}.json").write_text(json.dumps(body))
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(0)
    os.waitpid(process, 0)
    body = json.loads((folder / f"{number}.json").read_text())
    said = (folder / f"{number}.err").read_text()
    left = sorted(p.relative_to(run).as_posix() for p in run.rglob("*") if (run / "cache") not in (p, *p.parents))
    return {**body, "number": number, "said": said, "left": left}


def main(folder: pathlib.Path, kind: str, words: list[str], last: int | None = None) -> None:
    """Runs the command undisturbed, then until no access is left to disturb; last: of these, the last ones only."""
    first = 0
    for number in itertools.chain([10**6], itertools.count()):
        if number < first:
            continue
        done = _run(words, folder, kind, number)
        for name in done.pop("modules"):  # once, for all processes that are forked
            importlib.import_module(name)
        print(json.dumps(done), flush=True)
        if number == 10**6 and last is not None:
            first = max(len(done["seen"]) - last, 0)
        if number < 10**6 and len(done["seen"]) <= number:
            break


if __name__ == "__main__":
    kind, _, last = sys.argv[2].partition(":")
    main(pathlib.Path(sys.argv[1]), kind, sys.argv[3:], int(last) if last else None)
