"""Gives memory that this process has freed back to the system."""

import ctypes
import sys


def give_back() -> None:
    """Returns freed memory to the system, to be called after large tables were built.

    glibc keeps freed blocks below the size that it maps, up to 32 MB: after the render model of a large bank that is
    gigabytes. Elsewhere than on Linux with glibc nothing happens. Python's garbage is not collected: the tables are in
    no reference cycles, and a full collection takes seconds in a process that has compiled much.
    """
    if sys.platform == "linux":
        trim = getattr(ctypes.CDLL(None), "malloc_trim", None)  # other C libraries have none
        if trim is not None:
            trim(0)
