"""Runs a function in a separate process with limits on time, memory and file size, so that crashes are contained."""

import contextlib
import dataclasses
import multiprocessing
import os
import resource
import signal
import sys
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Any

from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.process_pool import end_with_parent

from .screening import RefusedFileError

CRASHED, TIME, MEMORY, UNABLE = "crashed", "out of time", "out of memory", "not possible"

#: Failures that the machine rather than the file may have caused.
FAILURES = (CRASHED, TIME, MEMORY, UNABLE)


@dataclasses.dataclass(frozen=True)
class Bounds:
    """Limits of one process: wall time and processor time in s, memory and any one file it writes in bytes."""

    seconds: float = 300.0
    memory: int = 4 * 2**30
    file_bytes: int = 2**30


@dataclasses.dataclass(frozen=True)
class Outcome:
    """The result of a process: a value, or the reason and the sentence of a failure."""

    value: Any = None
    reason: str = ""
    sentence: str = ""


def context() -> Any:
    """A fork server starts the workers in milliseconds, without threads or GPU state of this process."""
    methods = multiprocessing.get_all_start_methods()
    chosen = multiprocessing.get_context("forkserver" if "forkserver" in methods else "spawn")
    if chosen.get_start_method() == "forkserver":
        chosen.set_forkserver_preload(["urbanverse_mjx.assets.importing.work"])
    return chosen


def contained(function: Callable[..., Any], *args: Any, bounds: Bounds = Bounds()) -> Outcome:
    """Calls `function(*args)` in a fresh process and waits for it.

    No exception of that process is raised here: refusals, errors, crashes and exceeded bounds come back as an outcome.
    """
    chosen = context()
    here, there = chosen.Pipe(duplex=False)
    process = chosen.Process(target=_child, args=(there, bounds, function, args), daemon=True)
    process.start()
    there.close()
    try:
        return here.recv() if here.poll(bounds.seconds) else Outcome(reason=TIME, sentence=_late(bounds))
    except (EOFError, OSError):  # the process died before it sent a result
        process.join(10)
        return _death(process.exitcode, bounds)
    finally:
        here.close()
        process.join(1)
        if process.is_alive():
            process.kill()
            process.join()


def check_workers() -> None:
    """Checks that processes can be started, so that a failure is not attributed to a file.

    Raises:
      ValidationError: processes do not start, for example under a script on standard input or without a main guard.
    """
    outcome = contained(os.getpid)
    if outcome.reason:
        raise ValidationError(
            f"worker process: found that none starts ({outcome.sentence}), needed one; call this from a script file "
            'under `if __name__ == "__main__":`, or use the command line.'
        )


def _late(bounds: Bounds) -> str:
    return f"took more than {bounds.seconds:g} s"


def _death(code: int | None, bounds: Bounds) -> Outcome:
    if code == -signal.SIGXCPU:
        return Outcome(reason=TIME, sentence=_late(bounds))
    if code == -signal.SIGKILL:
        return Outcome(reason=MEMORY, sentence="was killed by the system, most likely for its memory")
    name = signal.Signals(-code).name if code is not None and code < 0 else f"exit status {code}"
    return Outcome(reason=CRASHED, sentence=f"ended its process ({name})")


def _child(there: Connection, bounds: Bounds, function: Callable[..., Any], args: tuple[Any, ...]) -> None:
    end_with_parent()
    _limit(bounds)
    # Output of readers and CoACD is discarded; the report has one line per file.
    null = os.open(os.devnull, os.O_WRONLY)
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError, AttributeError):
            os.dup2(null, stream.fileno())
    try:
        outcome = Outcome(function(*args))
    except RefusedFileError as error:
        outcome = Outcome(reason=error.reason, sentence=error.sentence)
    except ValidationError as error:
        outcome = Outcome(reason=UNABLE, sentence=str(error))
    except MemoryError:
        outcome = Outcome(reason=MEMORY, sentence=f"needs more than {bounds.memory} bytes")
    except Exception as error:
        outcome = Outcome(reason=CRASHED, sentence=f"{type(error).__name__}: {str(error)[:200]}")
    there.send(outcome)
    there.close()


def _limit(bounds: Bounds) -> None:
    seconds = int(bounds.seconds) + 1
    limits = [("RLIMIT_CPU", seconds * 2), ("RLIMIT_FSIZE", bounds.file_bytes), ("RLIMIT_CORE", 0)]
    # The limit is on data, not address space, of which renderers reserve much and use little. macOS enforces neither
    # reliably.
    limits.append(("RLIMIT_DATA", bounds.memory))
    for name, value in limits:
        with contextlib.suppress(AttributeError, ValueError, OSError):
            hard = resource.getrlimit(getattr(resource, name))[1]
            value = value if hard == resource.RLIM_INFINITY else min(value, hard)
            resource.setrlimit(getattr(resource, name), (value, hard))
    with contextlib.suppress(OSError):
        os.nice(5)
