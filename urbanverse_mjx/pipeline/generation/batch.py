"""Runs many sources, each in a process of its own, with a journal and retries.

The journal (`journal.jsonl`) gets a line when a source starts, fails or is done; a killed batch continues with the
sources that are not done. A failure of one source's process does not affect the others.
"""

import dataclasses
import datetime
import hashlib
import json
import os
import pathlib
import re
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from ... import settings
from ...datatypes import validation as v
from ...progress import Progress
from . import one_source
from .executors import EXECUTORS, Job, Outcome
from .run_folder import key_of
from .stages import GenerationOptions, check_options

JOURNAL = "journal.jsonl"
#: Exit status for an invalid source, for which a retry is useless.
WRONG_INPUT = 2
_LAST_WORDS = 400  # characters of a failed process's last line that the journal keeps


class Journal:
    """The lines of `journal.jsonl`; one process writes them."""

    def __init__(self, path: pathlib.Path) -> None:
        self._path = path

    def write(self, **event: Any) -> None:
        """Appends a line, on disk before this returns."""
        now = datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")
        with self._path.open("a", encoding="utf-8") as file:
            file.write(json.dumps({"time": now, **event}) + "\n")
            file.flush()
            os.fsync(file.fileno())

    def last(self) -> dict[str, Mapping[str, Any]]:
        """source -> its last event; an incomplete line of a killed process is ignored."""
        events: dict[str, Mapping[str, Any]] = {}
        if self._path.is_file():
            for line in self._path.read_text(encoding="utf-8").splitlines():
                try:
                    event = json.loads(line)
                    events[event["source"]] = event
                except (ValueError, KeyError, TypeError):
                    continue
        return events


def read_list(path: pathlib.Path) -> list[pathlib.Path]:
    """Reads the sources of a list, without duplicates.

    Raises:
      ValidationError: the file does not exist or is empty.
    """
    if not path.is_file():
        raise v.fail(str(path), "no such file", "a text file with one source a line", "check the path")
    lines = [line.partition("#")[0].strip() for line in path.read_text(encoding="utf-8").splitlines()]
    sources = [(path.parent / pathlib.Path(line).expanduser()).absolute() for line in lines if line]
    if not sources:
        raise v.fail(str(path), "no source", "one source a line", "name videos, recordings or graphs")
    return list(dict.fromkeys(sources))


def folder_name(source: pathlib.Path) -> str:
    """Name of the run folder of a source: the source's name and a digest of its path, because names are not unique."""
    stem = source.parent.name if source.name == "graph.json" else source.stem
    slug = re.sub(r"[^A-Za-z0-9_-]+", "_", stem)[:60]
    return f"{slug}-{hashlib.sha256(str(source).encode()).hexdigest()[:8]}"


def run_batch(
    sources: str | os.PathLike[str],
    out: str | os.PathLike[str],
    options: GenerationOptions,
    executor: str = "local",
    workers: int | None = None,
    retries: int = 1,
    quiet: bool = True,
) -> dict[str, Any]:
    """Runs all sources of a list that are not done according to the journal.

    Returns:
      counts: sources, done (earlier ones included), failed; the failed ones with their last words.

    Raises:
      ValidationError: the list does not exist, the executor is unknown, or the folder is not writable.
    """
    v.choice(executor, "--executor", tuple(EXECUTORS))
    v.integer(retries, "--retries", 0)
    check_options(options)
    if workers is not None:
        v.integer(workers, "--workers", 1, 1024)
    out = pathlib.Path(out).absolute()
    listed = read_list(pathlib.Path(sources))
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise v.fail(str(out), f"no way to write there ({error.strerror})", "a folder to write into") from error
    asked = dataclasses.asdict(options)
    asked["tour"] = asked.pop("video")  # the field's name in existing journals
    journal, key = Journal(out / JOURNAL), key_of("generation", options=asked)
    last = journal.last()
    todo = [s for s in listed if not _is_done(last.get(str(s)), key, out / folder_name(s))]
    failed: dict[str, str] = {}
    with Progress(quiet) as progress:
        report = progress.task("sources", len(listed))
        report(len(listed) - len(todo), len(listed))
        for finished, (source, outcome) in enumerate(
            _attempts(todo, out, options, journal, key, EXECUTORS[executor], workers, retries), 1
        ):
            if outcome.status:
                failed[str(source)] = outcome.words
            report(len(listed) - len(todo) + finished, len(listed))
    return {"sources": len(listed), "done": len(listed) - len(failed), "failed": failed, "journal": str(out / JOURNAL)}


def _is_done(event: Mapping[str, Any] | None, key: str, folder: pathlib.Path) -> bool:
    finished = event is not None and event.get("event") == "done" and event.get("key") == key
    return finished and (folder / "report.html").is_file()


def _attempts(
    todo: Sequence[pathlib.Path],
    out: pathlib.Path,
    options: GenerationOptions,
    journal: Journal,
    key: str,
    executor: Any,
    workers: int | None,
    retries: int,
) -> Iterator[tuple[pathlib.Path, Outcome]]:
    """Yields every source with its final outcome as they end; temporary failures are retried."""
    waiting = [(source, 1) for source in todo]
    with executor(workers or settings.num_threads()) as pool:
        running: dict[Any, tuple[pathlib.Path, int]] = {}
        while waiting or running:
            while waiting and len(running) < pool.size:
                source, attempt = waiting.pop(0)
                journal.write(source=str(source), event="started", attempt=attempt, key=key)
                running[pool.submit(run_source, job_of(source, out, options))] = source, attempt
            ticket, outcome = pool.next(list(running))
            source, attempt = running.pop(ticket)
            facts = {"attempt": attempt, "key": key, "seconds": outcome.seconds}
            if outcome.status == 0:
                journal.write(source=str(source), event="done", **facts)
            else:
                journal.write(
                    source=str(source), event="failed", status=outcome.status, error=outcome.words, **facts
                )  # fmt: skip
                if outcome.status != WRONG_INPUT and attempt <= retries:
                    waiting.append((source, attempt + 1))
                    continue
            yield source, outcome


def job_of(source: pathlib.Path, out: pathlib.Path, options: GenerationOptions) -> Job:
    """The job of one source; by default its cousins are compiled sequentially."""
    return Job(source, out / folder_name(source), dataclasses.replace(options, workers=options.workers or 1))


def run_source(job: Job) -> Outcome:
    """Makes the cousins of one source in a process of its own and waits for it."""
    start = time.perf_counter()
    command = [sys.executable, "-m", one_source.__name__, one_source.argument(job, os.getpid())]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    words = (done.stderr.strip().splitlines() or [f"ended with status {done.returncode} without a message"])[-1]
    return Outcome(done.returncode, words[-_LAST_WORDS:], round(time.perf_counter() - start, 3))
