"""Gives memory that this process has freed back to the system."""

import ctypes
import gc
import sys


def give_back() -> None:
    """Returns freed memory to the system, to be called after large tables were built.

    glibc keeps freed blocks below the size that it maps, up to 32 MB: after the render model of a large bank that is
    gigabytes. Elsewhere than on Linux with glibc only Python's own garbage is collected.
    """
    gc.collect()
    if sys.platform == "linux":
        trim = getattr(ctypes.CDLL(None), "malloc_trim", None)  # other C libraries have none
        if trim is not None:
            trim(0)
