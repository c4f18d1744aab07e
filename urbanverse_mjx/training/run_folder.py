"""Run folders: only one process uses a folder at a time, and every training creates its own."""

import contextlib
import fcntl
import os
import pathlib
import shutil
from collections.abc import Iterator

from ..datatypes import ValidationError

#: File that the running process locks; contains its id.
LOCK = ".lock"
#: Pattern of Orbax's names of incomplete checkpoints.
_HALF_A_CHECKPOINT = "**/checkpoints/[0-9]*.orbax-checkpoint-tmp*"


def check_new(folder: pathlib.Path) -> None:
    """Checks that a folder can be used for a new run.

    Raises:
      ValidationError: the folder contains checkpoints.
    """
    checkpoints = folder / "checkpoints"
    if checkpoints.exists() and any(checkpoints.iterdir()):
        raise ValidationError(f"run folder: found checkpoints in {folder}, needed a new folder; or pass --resume.")


@contextlib.contextmanager
def new_run(parent: pathlib.Path, name: str) -> Iterator[pathlib.Path]:
    """Context that creates a new folder NAME, NAME-2 and so on, and removes it if the block fails while it is empty."""
    folder = _make(parent, name)
    try:
        with at_work(folder):
            yield folder
    finally:
        with contextlib.suppress(OSError):
            if [path.name for path in folder.iterdir()] == [LOCK]:
                (folder / LOCK).unlink()
                folder.rmdir()


def _make(parent: pathlib.Path, name: str) -> pathlib.Path:
    parent.mkdir(parents=True, exist_ok=True)
    folder, number = parent / name, 1
    while True:
        try:
            folder.mkdir()
            return folder
        except FileExistsError:
            number += 1
            folder = parent / f"{name}-{number}"


@contextlib.contextmanager
def at_work(folder: pathlib.Path) -> Iterator[None]:
    """Context that locks a run's folder and removes incomplete checkpoints of a killed process.

    Raises:
      ValidationError: the folder does not exist, or another process uses it.
    """
    if not folder.is_dir():
        raise ValidationError(f"run folder: found no folder {folder}, needed one that `urbanverse train` made.")
    with (folder / LOCK).open("a+", encoding="utf-8") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            lock.seek(0)
            raise ValidationError(
                f"run folder: found process {lock.read(20).strip()} at work in {folder}, needed it alone; wait for its "
                "end, or end it."
            ) from error
        lock.truncate(0)
        lock.write(f"{os.getpid()}\n")
        lock.flush()
        for half in folder.glob(_HALF_A_CHECKPOINT):
            shutil.rmtree(half, ignore_errors=True)
        yield
