"""Initialises Warp without its warning about a missing CUDA driver on machines without CUDA."""

import ctypes
import os
import sys
import tempfile

import warp

#: Message of Warp's native library on standard error where it finds no driver; it has no switch.
NO_DRIVER = "Warp CUDA warning: Could not find or load the NVIDIA CUDA driver"


def has_cuda_driver() -> bool:
    """Whether the CUDA driver's library can be loaded; by the names that Warp tries."""
    names = ("nvcuda.dll",) if sys.platform == "win32" else ("libcuda.so", "libcuda.so.1")
    for name in names:
        try:
            ctypes.CDLL(name)
        except OSError:
            continue
        return True
    return False


def start_warp() -> None:
    """Starts Warp once per process; on a machine without CUDA its message about the missing driver is suppressed.

    Whatever else Warp writes while it starts is passed on.
    """
    if has_cuda_driver():
        warp.init()
        return
    sys.stderr.flush()
    own = os.dup(2)
    with tempfile.TemporaryFile() as said:
        os.dup2(said.fileno(), 2)
        try:
            warp.init()
        finally:
            os.dup2(own, 2)
            os.close(own)
        said.seek(0)
        lines = said.read().decode(errors="replace").splitlines(keepends=True)
    sys.stderr.write("".join(line for line in lines if NO_DRIVER not in line))
