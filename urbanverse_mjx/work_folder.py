"""Temporary folders that are cleaned up by the next run if their process was killed.

The owner of a folder holds a lock on a file in it, which the operating system releases when the process ends for any
reason. Only folders with such a file are removed, never a user's files.
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
#: Number of random letters that `tempfile` appends to a prefix.
_RANDOM = 8
_OLD = "old"


def lock_file(path: pathlib.Path) -> int:
    """Locks a file, which is made with its folders where it is missing.

    Returns:
      its descriptor; the lock ends when that is closed, or with the process. Its owner may remove the file
        before closing it.

    Raises:
      BlockingIOError: another owner has the lock.
      OSError: the file cannot be made, or its file system has no locks.
    """
    while True:
        path.parent.mkdir(parents=True, exist_ok=True)
        with contextlib.suppress(FileNotFoundError):
            lock = os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o666)
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                if os.path.samestat(os.fstat(lock), path.stat()):
                    return lock
            except BaseException:
                os.close(lock)
                raise
            os.close(lock)
        # Its last owner removed the file before this one had the lock; there is none, or one that is new.


@contextlib.contextmanager
def work_folder(prefix: str, parent: pathlib.Path | None = None) -> Iterator[pathlib.Path]:
    """Creates a folder that is removed when the block ends, or by the next call with the same prefix if the process was
    killed.

    Args:
      prefix: prefix of the folder's name.
      parent: its parent folder; None for the system's folder of temporary files.
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
    """Creates a folder beside `target` that replaces it if the block succeeds and is removed if it fails.

    If an earlier call was killed between its two renames, the folder that it had moved aside is restored first.
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
    """Removes the folders that `work_folder` created for this user in processes that have ended.

    Restores a folder that `replacing_folder` had moved aside without replacing it.

    Args:
      prefix: prefix of the folders; "" for all in `parent`.
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
    """Restores a missing folder that a killed `replacing_folder` had moved aside."""
    if not target.exists() and target.parent.is_dir():
        sweep(target.parent, f".{target.name}-")


def recover_below(place: pathlib.Path) -> None:
    """Calls `recover` for a folder and for all folders at any depth in it."""
    recover(place)
    for parent in {owner.parent.parent for owner in place.rglob(f".*/{OWNER}")}:
        sweep(parent)


def is_unfinished(folder: pathlib.Path, place: pathlib.Path) -> bool:
    """Returns whether a folder below `place` is inside one made by `work_folder`: incomplete, or moved aside."""
    between = [parent for parent in folder.parents if parent != place and parent.is_relative_to(place)]
    return any((parent / OWNER).exists() for parent in between)


def _put_back(left: pathlib.Path) -> None:
    """Moves a folder that `replacing_folder` had renamed to `.NAME-xxxxxxxx` back to NAME."""
    target = left.with_name(left.name[1 : -_RANDOM - 1])
    if left.name.startswith(".") and not target.exists() and (left / _OLD).is_dir():
        (left / _OLD).rename(target)


def _make(prefix: str, parent: pathlib.Path) -> tuple[pathlib.Path, int]:
    """Creates a folder; returns it and the file descriptor that holds its lock."""
    while True:
        folder = pathlib.Path(tempfile.mkdtemp(prefix=prefix, dir=parent))
        lock = os.open(folder / OWNER, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o600)
        with contextlib.suppress(BlockingIOError):
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if (folder / OWNER).exists():
                return folder, lock
        # A concurrent sweep removed the folder before the lock was taken.
        os.close(lock)
