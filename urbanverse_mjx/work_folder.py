"""Temporary folders that are cleaned up by the next run if their process was killed.

The owner of a folder holds a lock on a file in it, which the operating system releases when the process ends for any
reason. Only folders with such a file are removed, and a folder that replaces another one keeps a user's files.
"""

import contextlib
import fcntl
import os
import pathlib
import shutil
import tempfile
from collections.abc import Iterator, Sequence

#: The file that its owner locks.
OWNER = ".urbanverse-owner"
#: The file that lists what `replacing_folder` made in a folder, a path on each line.
MADE = ".urbanverse-files"
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
def replacing_folder(target: pathlib.Path, also: Sequence[str] = ()) -> Iterator[pathlib.Path]:
    """Creates a folder beside `target` that replaces it if the block succeeds and is removed if it fails.

    Files in `target` that no call made are kept: they are in the new folder under the same name, or with `.before` at
    its end where that name is taken. A folder without the list `MADE`, from an older version, is replaced as a whole.
    If an earlier call was killed between its two renames, the folder that it had moved aside is restored first.

    Args:
      also: patterns, as of `PurePath.match`, of files in `target` that the program wrote there afterwards.
    """
    prefix = f".{target.name}-"
    target.parent.mkdir(parents=True, exist_ok=True)
    sweep(target.parent, prefix)
    with work_folder(prefix, target.parent) as work:
        fresh, old = work / "new", work / _OLD
        fresh.mkdir()
        yield fresh
        made = sorted(path.relative_to(fresh).as_posix() for path in fresh.rglob("*"))
        (fresh / MADE).write_text("".join(f"{name}\n" for name in made), encoding="utf-8", errors="surrogateescape")
        if target.exists():
            _keep_others(target, fresh, also)
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


def _keep_others(target: pathlib.Path, fresh: pathlib.Path, also: Sequence[str]) -> None:
    """Gives `fresh` a second link to each file in `target` that is not listed, so that one remains at every moment."""
    lists = list(target.rglob(MADE))
    if target / MADE not in lists:
        return
    made = {path for listed in lists for path in (listed, listed.parent, *_listed(listed))}
    for path in sorted(target.rglob("*")):
        relative = path.relative_to(target)
        if path in made or any(relative.match(pattern) for pattern in also):
            continue
        kept = fresh / relative
        if path.is_dir() and not path.is_symlink():
            kept.mkdir(parents=True, exist_ok=True)
            continue
        kept.parent.mkdir(parents=True, exist_ok=True)
        if os.path.lexists(kept):
            kept = kept.with_name(f"{kept.name}.before")
        try:
            os.link(path, kept, follow_symlinks=False)
        except OSError:  # a file system without links
            shutil.copy2(path, kept, follow_symlinks=False)
    # Folders of other calls that now hold such files alone may be replaced again.
    for folder in (fresh / listed.parent.relative_to(target) for listed in lists):
        if folder.is_dir():
            (folder / MADE).touch()


def _listed(made: pathlib.Path) -> Iterator[pathlib.Path]:
    for name in made.read_text(encoding="utf-8", errors="surrogateescape").split("\n")[:-1]:
        yield made.parent / name


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
