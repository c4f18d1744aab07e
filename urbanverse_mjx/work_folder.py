"""Temporary folders; the next run removes those of a killed one.

A folder's owner holds a lock on a file in it for as long as it lives; the operating system releases the lock however
the owner ends. Only folders with such a file are ever removed, never a user's files.
"""

import contextlib
import fcntl
import os
import pathlib
import shutil
import tempfile
from collections.abc import Iterator

#: The file that its owner locks.
OWNER = ".urbanverse-owner"
#: Letters that `tempfile` puts after a prefix.
_RANDOM = 8
_OLD = "old"


@contextlib.contextmanager
def work_folder(prefix: str, parent: pathlib.Path | None = None) -> Iterator[pathlib.Path]:
    """A new folder that is removed when the block ends, and by the next call of the same prefix where it was killed.

    Args:
      prefix: of the folder's name.
      parent: where it lies; None for the system's place for temporary files.
    """
    parent = pathlib.Path(tempfile.gettempdir()) if parent is None else parent
    parent.mkdir(parents=True, exist_ok=True)
    sweep(parent, prefix)
    folder, lock = _make(prefix, parent)
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        os.close(lock)


@contextlib.contextmanager
def replacing_folder(target: pathlib.Path) -> Iterator[pathlib.Path]:
    """A folder beside `target` that takes its place when the block succeeds and vanishes when it fails.

    Where an earlier call was killed between the two renames, the folder that it had put aside comes back first.
    """
    prefix = f".{target.name}-"
    target.parent.mkdir(parents=True, exist_ok=True)
    sweep(target.parent, prefix)
    with work_folder(prefix, target.parent) as work:
        fresh, old = work / "new", work / _OLD
        fresh.mkdir()
        yield fresh
        if target.exists():
            target.rename(old)
        fresh.rename(target)


def sweep(parent: pathlib.Path, prefix: str = "") -> None:
    """Removes the folders that this user's `work_folder` made in processes that have ended.

    A folder that `replacing_folder` had put aside, with no other in its place yet, comes back.

    Args:
      prefix: of the folders; "" for all in `parent`.
    """
    for folder in list(parent.iterdir()):
        if prefix and not (folder.name.startswith(prefix) and len(folder.name) == len(prefix) + _RANDOM):
            continue
        with contextlib.suppress(OSError):
            if folder.is_symlink() or folder.stat().st_uid != os.getuid():
                continue
            lock = os.open(folder / OWNER, os.O_RDWR | os.O_NOFOLLOW)
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                _put_back(folder)
                shutil.rmtree(folder, ignore_errors=True)
            finally:
                os.close(lock)


def recover(target: pathlib.Path) -> None:
    """Brings back a folder that is not there because a killed `replacing_folder` had put it aside."""
    if not target.exists() and target.parent.is_dir():
        sweep(target.parent, f".{target.name}-")


def recover_below(place: pathlib.Path) -> None:
    """`recover` for a folder, and for all folders at any depth in it."""
    recover(place)
    for parent in {owner.parent.parent for owner in place.rglob(f".*/{OWNER}")}:
        sweep(parent)


def is_unfinished(folder: pathlib.Path, place: pathlib.Path) -> bool:
    """Whether a folder below `place` lies in one that `work_folder` made there: half made, or put aside."""
    between = [parent for parent in folder.parents if parent != place and parent.is_relative_to(place)]
    return any((parent / OWNER).exists() for parent in between)


def _put_back(left: pathlib.Path) -> None:
    """The old folder that `replacing_folder` moved to `.NAME-xxxxxxxx`, as NAME."""
    target = left.with_name(left.name[1 : -_RANDOM - 1])
    if left.name.startswith(".") and not target.exists() and (left / _OLD).is_dir():
        (left / _OLD).rename(target)


def _make(prefix: str, parent: pathlib.Path) -> tuple[pathlib.Path, int]:
    """A new folder and the descriptor that holds its lock."""
    while True:
        folder = pathlib.Path(tempfile.mkdtemp(prefix=prefix, dir=parent))
        lock = os.open(folder / OWNER, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o600)
        with contextlib.suppress(BlockingIOError):
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if (folder / OWNER).exists():
                return folder, lock
        # A sweep came between the file and its lock, and took the folder for an abandoned one.
        os.close(lock)
