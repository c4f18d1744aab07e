"""Converts errors about the user's input to one-sentence messages. Imports only the standard library."""

import contextlib
import errno
import os
import traceback
from collections.abc import Iterator

_FILE_ERRORS = (FileNotFoundError, PermissionError, IsADirectoryError, NotADirectoryError, FileExistsError)
#: Error code of a missing resource or permission -> advice.
_MACHINE_ERRORS = {
    errno.ENOSPC: "free space on that disk",
    errno.EDQUOT: "free space within the quota, or write elsewhere",
    errno.EROFS: "write elsewhere",
    errno.EFBIG: "raise the limit of file sizes (ulimit -f)",
    errno.EMFILE: "raise the limit of open files (ulimit -n)",
    errno.ENFILE: "close other programs",
    errno.EIO: "check the disk",
    errno.ENAMETOOLONG: "choose a shorter name",
    errno.ELOOP: "remove the links that lead in a circle",
}
#: Those of them that are about a disk.
_DISK_ERRORS = (errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EFBIG, errno.EIO)


def refusal(error: Exception) -> str | None:
    """One-line message about wrong input, a wrong path or a missing package; None for a bug, which should be raised."""
    # A ValidationError, or a ValueError raised by this package, is about the input; one from a library is a bug.
    if isinstance(error, ValueError) and _is_ours(error):
        sentence = str(error)
    elif isinstance(error, FileNotFoundError) and _is_removed_here():
        sentence = "the working folder: found that it was removed, needed one that exists; change to another folder."
    elif isinstance(error, _FILE_ERRORS) and error.filename is not None:
        sentence = f"{error.filename}: {error.strerror}."
    elif isinstance(error, _FILE_ERRORS) and error.errno is not None:
        sentence = f"{error.strerror}."  # of a library such as pyarrow, which names the file in the text
    elif isinstance(error, OSError) and error.errno in _MACHINE_ERRORS:
        where = "" if error.filename is None else f"{os.fspath(error.filename)}: "
        sentence = f"{where}found the error {os.strerror(error.errno)!r}; {_MACHINE_ERRORS[error.errno]}."
    elif isinstance(error, ModuleNotFoundError) and (error.name or "").partition(".")[0] != "urbanverse_mjx":
        sentence = f"the package {error.name!r} is not installed; `urbanverse doctor` prints the command for it."
    else:
        return None
    return " ".join(sentence.split())


@contextlib.contextmanager
def naming(path: str | os.PathLike[str]) -> Iterator[None]:
    """Gives an error of the machine, such as a full disk, this path where it names no file: libraries such as Arrow do
    not say which disk is full."""
    try:
        yield
    except OSError as error:
        if error.filename is None and error.errno in _DISK_ERRORS:
            error.filename = os.fspath(path)
        raise


def _is_removed_here() -> bool:
    """Whether the process stands in a folder that no longer exists."""
    try:
        os.getcwd()
    except FileNotFoundError:
        return True
    return False


def _is_ours(error: Exception) -> bool:
    frames = list(traceback.walk_tb(error.__traceback__))
    raised_in = frames[-1][0].f_globals.get("__name__", "") if frames else ""
    return any(name.partition(".")[0] == "urbanverse_mjx" for name in (type(error).__module__, raised_in))
