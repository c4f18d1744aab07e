"""Returns freed memory of this process to the system."""

import ctypes
import sys


def give_back() -> None:
    """Returns freed memory to the system; call it after building large tables.

    glibc keeps freed blocks below its mmap threshold (up to 32 MB), which amounts to gigabytes after the render model
    of a large bank is built. This function has an effect only on Linux with glibc. It does not run Python's garbage
    collection, because the tables are not in reference cycles and a full collection takes seconds.
    """
    if sys.platform == "linux":
        trim = getattr(ctypes.CDLL(None), "malloc_trim", None)  # other C libraries have none
        if trim is not None:
            trim(0)
