"""Memory use of this process and its device."""

import os
import pathlib
import resource
import subprocess
import sys

import jax


def peak_rss_mib() -> float:
    """Returns the peak resident memory of this process, MiB."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (2**20 if sys.platform == "darwin" else 2**10)  # bytes on macOS, KiB elsewhere


def jax_mib() -> tuple[float | None, float | None]:
    """Returns current and peak memory of JAX on the first device, or None for devices without statistics (CPU)."""
    stats = jax.devices()[0].memory_stats() or {}
    now, most = (stats.get(name) for name in ("bytes_in_use", "peak_bytes_in_use"))
    return now and now / 2**20, most and most / 2**20


def warp_mib() -> tuple[float | None, float | None]:
    """Returns current and peak memory of Warp's pool on its first CUDA device, or None without CUDA."""
    wp = sys.modules.get("warp")
    if wp is None or not wp.is_cuda_available() or not wp.is_mempool_enabled("cuda:0"):
        return None, None
    return tuple(f("cuda:0") / 2**20 for f in (wp.get_mempool_used_mem_current, wp.get_mempool_used_mem_high))


def peak_device_mib() -> float:
    """Returns the peak memory of this process on its GPU: that of JAX and of Warp's pool, MiB; 0 without a GPU.

    Unlike `device_mib` it does not depend on other programs, nor on the moment within a step.
    """
    return (jax_mib()[1] or 0.0) + (warp_mib()[1] or 0.0)


def device_mib() -> float | None:
    """Returns the memory in use by all programs on the first GPU that this process sees, or None without nvidia-smi.

    CUDA_VISIBLE_DEVICES names it by its index, in the order of nvidia-smi, or its UUID. JAX takes most of a GPU at its
    start unless XLA_PYTHON_CLIENT_PREALLOCATE=false.
    """
    named = [name.strip() for name in os.environ.get("CUDA_VISIBLE_DEVICES", "").split(",") if name.strip()]
    which = ["-i", named[0]] if named else []
    command = ["nvidia-smi", *which, "--query-gpu=memory.used", "--format=csv,noheader,nounits"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=20)
        return float(done.stdout.split()[0])
    except (OSError, subprocess.SubprocessError, ValueError, IndexError):
        return None


def in_use_mib() -> float:
    """Returns the current memory of JAX and Warp on the GPU, or resident memory without a GPU.

    Raises:
      OSError: no GPU, and a system that does not tell (no /proc).
    """
    jax_now, warp_now = jax_mib()[0], warp_mib()[0]
    return rss_mib() if jax_now is None else jax_now + (warp_now or 0.0)


def rss_mib() -> float:
    """Resident memory of this process now, MiB.

    Raises:
      OSError: a system that does not tell (no /proc).
    """
    pages = int(pathlib.Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * resource.getpagesize() / 2**20


def report() -> dict[str, float | None]:
    """Returns all memory figures. Peaks are per process, so measure one configuration per process."""
    (jax_now, jax_peak), (warp_now, warp_peak) = jax_mib(), warp_mib()
    return {
        "peak_rss_mib": peak_rss_mib(),
        "jax_mib": jax_now,
        "peak_device_mib": jax_peak,
        "warp_pool_mib": warp_now,
        "peak_warp_pool_mib": warp_peak,
        "gpu_used_mib": device_mib(),
    }
