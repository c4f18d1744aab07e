"""Temporary folders that outlive nobody: the next run removes what a killed one left.

A folder's owner holds a lock on a file in it for as long as it lives; the operating system lets go of the lock however
the owner ends. Only folders with such a file are ever removed, so nothing that a user put there is.
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


@contextlib.contextmanager
def work_folder(prefix: str, parent: pathlib.Path | None = None) -> Iterator[pathlib.Path]:
    """A new folder that is removed when the block ends, and by the next call of the same prefix where it was killed.

    Args:
      prefix: of the folder's name. parent: where it lies; None for the system's place for temporary files.
    """
    parent = pathlib.Path(tempfile.gettempdir()) if parent is None else parent
    parent.mkdir(parents=True, exist_ok=True)
    sweep(prefix, parent)
    folder, lock = _make(prefix, parent)
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        os.close(lock)


def sweep(prefix: str, parent: pathlib.Path) -> None:
    """Removes the folders of this prefix that this user's `work_folder` made in processes that have ended."""
    for folder in [path for path in parent.iterdir() if path.name.startswith(prefix)]:
        with contextlib.suppress(OSError):
            if folder.is_symlink() or folder.stat().st_uid != os.getuid():
                continue
            lock = os.open(folder / OWNER, os.O_RDWR | os.O_NOFOLLOW)
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                shutil.rmtree(folder, ignore_errors=True)
            finally:
                os.close(lock)


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
