"""The folder of compiled programs that runs of the tests share."""

import contextlib
import pathlib


def remove_least_recent(folder: pathlib.Path, limit: int) -> None:
    """Removes the files that were not read for longest, down to `limit` bytes.

    JAX can do this, too: with each program that it writes it then reads a file of every other one, a tenth of a second
    where there are two thousand.
    """
    files = []
    for path in folder.glob("*-cache"):
        with contextlib.suppress(OSError):  # another run removes files at the same time
            found = path.stat()
            files.append((max(found.st_atime, found.st_mtime), found.st_size, path))
    kept = 0
    for _, size, path in sorted(files, reverse=True):
        kept += size
        if kept > limit:
            path.unlink(missing_ok=True)
