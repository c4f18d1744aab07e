"""The folder of one run, with a record of finished stages, so that a killed run can continue.

`run.json` holds for every finished stage the key of its inputs (its options, and the key of the previous stage). A
stage whose key and files exist is skipped. Files are written atomically.
"""

import contextlib
import dataclasses
import datetime
import hashlib
import json
import os
import pathlib
import re
import time
from collections.abc import Iterator, Mapping
from typing import Any

from ... import versions
from ...datatypes import validation as v
from ...work_folder import lock_file, replacing_folder, sweep

SCHEMA = "urbanverse.generation/1"
FILE, LOCK = "run.json", ".lock"


def key_of(code: str, **parts: Any) -> str:
    """Hash of 16 hexadecimal digits over JSON values and the versions of the code of a stage.

    Args:
      code: name of the code in `versions.CODE`.
    """
    body = {"code": versions.of(code), "stages": versions.CODE["generation"].version, **parts}
    return hashlib.sha256(json.dumps(body, sort_keys=True).encode()).hexdigest()[:16]


@dataclasses.dataclass
class RunFolder:
    """A run's folder and its record.

    Attributes:
      path: the folder.
      record: the content of `run.json`.
    """

    path: pathlib.Path
    record: dict[str, Any]

    @staticmethod
    @contextlib.contextmanager
    def open(path: str | os.PathLike[str], source: str) -> Iterator["RunFolder"]:
        """Creates or reopens a run's folder, locked by this process.

        Removes unfinished parts of a killed run; a run that fails before its first stage is done leaves no files.

        Raises:
          ValidationError: the folder is not writable, holds other files, is used by another process, or belongs to
            another source.
        """
        path = pathlib.Path(path)
        if path.exists() and not path.is_dir():
            raise v.fail(str(path), "a file", "the name of a folder", "choose another")
        if path.is_dir() and not (path / FILE).is_file() and any(p.name != LOCK for p in path.iterdir()):
            raise v.fail(str(path), "a folder with other files", "a new name or an earlier run", "choose another")
        made = not path.exists()
        try:
            lock = lock_file(path / LOCK)
        except BlockingIOError as error:
            raise v.fail(str(path), "another run at work in it", "a folder of its own", "wait for it") from error
        except OSError as error:
            raise v.fail(str(path), f"no way to write there ({error.strerror})", "a folder to write into") from error
        with os.fdopen(lock):
            run = RunFolder(path, _read(path / FILE, source))
            _sweep(path)
            try:
                if not (path / FILE).is_file():
                    # Written immediately, so that the next run recognises the folder of a killed one.
                    v.write_json(path / FILE, run.record)
                yield run
            finally:
                _sweep(path)
                if not run.record["stages"] and {p.name for p in path.iterdir()} == {FILE, LOCK}:
                    for name in (FILE, LOCK):
                        (path / name).unlink(missing_ok=True)
                    if made:
                        path.rmdir()

    def done(self, stage: str, key: str, *files: str) -> bool:
        """Whether a stage was finished with the same input and its files still exist."""
        entry = self.record["stages"].get(stage)
        return bool(entry and entry["key"] == key and all((self.path / name).exists() for name in files))

    def finish(self, stage: str, key: str, seconds: float, **facts: Any) -> None:
        """Records that a stage is done, with `Clock.resources` among the facts."""
        now = datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")
        self.record["stages"][stage] = {"key": key, "seconds": round(seconds, 3), "finished": now, **facts}
        v.write_json(self.path / FILE, self.record)

    @property
    def seconds(self) -> Mapping[str, float]:
        """stage -> seconds it took when it was done."""
        return {name: entry["seconds"] for name, entry in self.record["stages"].items()}

    @contextlib.contextmanager
    def replacing(self, name: str, *also: str) -> Iterator[pathlib.Path]:
        """Context with a temporary folder that replaces `name` if the block succeeds, and is removed if it fails; see
        `work_folder.replacing_folder`."""
        with replacing_folder(self.path / name, also) as folder:
            yield folder


#: Temporary name of a file of a run during atomic writing.
_HALF_A_FILE = re.compile(
    r"\.((run|materialisation|assets|layout|check)-(urbanverse-)?\w{8}\.json"
    r"|bank-(urbanverse-)?\w{8}\.npz|report-(urbanverse-)?\w{8}\.html)"
)


def _sweep(folder: pathlib.Path) -> None:
    """Removes only unfinished parts of a killed run: folders as `replacing` makes them, parts of files.

    The caller must hold the run's lock.
    """
    for place in (folder, *(path for path in folder.glob("cousins/*") if path.is_dir())):
        sweep(place)
        for path in list(place.iterdir()):
            if _HALF_A_FILE.fullmatch(path.name) and path.is_file():
                path.unlink(missing_ok=True)


def _read(path: pathlib.Path, source: str) -> dict[str, Any]:
    if not path.is_file():
        return {"schema": SCHEMA, "source": source, "stages": {}}
    try:
        record = v.mapping(v.read_json(path, "run's record"), path.name, ("schema", "source", "stages"))
        v.choice(record["schema"], "schema", (SCHEMA,))
    except v.ValidationError as error:
        raise v.ValidationError(
            f"{path}: found no record of a run ({error}), needed one; choose another folder."
        ) from error
    if record["source"] != source:
        raise v.fail(str(path.parent), f"a run of {record['source']}", f"one of {source}", "choose another folder")
    return dict(record)


class Clock:
    """What a stage takes: seconds since the clock was made, processor seconds of this process and of its children that
    have ended, and the largest memory of this process since then."""

    def __init__(self) -> None:
        self._start, self._processor = time.perf_counter(), _processor()
        # Linux forgets the largest memory of this process.
        with contextlib.suppress(OSError):
            pathlib.Path("/proc/self/clear_refs").write_text("5", encoding="ascii")

    @property
    def seconds(self) -> float:
        return time.perf_counter() - self._start

    @property
    def resources(self) -> dict[str, float]:
        """processor_s, and memory_mb where the system tells it."""
        memory = _largest_memory()
        found = {"processor_s": round(_processor() - self._processor, 3)}
        return found if memory is None else {**found, "memory_mb": memory}


def _processor() -> float:
    spent = os.times()
    return spent.user + spent.system + spent.children_user + spent.children_system


def _largest_memory() -> float | None:
    """MB, largest resident memory of this process since it was forgotten; None where /proc does not tell."""
    with contextlib.suppress(OSError):
        for line in pathlib.Path("/proc/self/status").read_text(encoding="ascii", errors="replace").splitlines():
            if line.startswith("VmHWM:"):
                return round(int(line.split()[1]) / 1024.0, 1)
    return None
