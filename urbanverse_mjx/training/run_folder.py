"""A training's folder: one process at a time is at work in it, and no two trainings make the same one."""

import contextlib
import fcntl
import os
import pathlib
import shutil
from collections.abc import Iterator

from ..datatypes import ValidationError

#: Locked by the running process; contains its id.
LOCK = ".lock"
#: Orbax's name of an incomplete checkpoint.
_HALF_A_CHECKPOINT = "**/checkpoints/[0-9]*.orbax-checkpoint-tmp*"


def check_new(folder: pathlib.Path) -> None:
    """Whether a folder can take a new run.

    Raises:
      ValidationError: there are checkpoints in it.
    """
    checkpoints = folder / "checkpoints"
    if checkpoints.exists() and any(checkpoints.iterdir()):
        raise ValidationError(f"run folder: found checkpoints in {folder}, needed a new folder; or pass --resume.")


@contextlib.contextmanager
def new_run(parent: pathlib.Path, name: str) -> Iterator[pathlib.Path]:
    """A folder of its own, NAME or NAME-2 and so on; it goes again where the block fails before anything is in it."""
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
    """Keeps other processes out of a run's folder, and removes checkpoints that a killed one left half written.

    Raises:
      ValidationError: no such folder, or another process is at work in it.
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
