"""Runs pytest in a process that has the libraries imported already, but nothing of this repository.

A fork server imports them once, for six seconds of a processor, and forks them for each fault.
"""

import contextlib
import multiprocessing
import os
import pathlib
import signal
import sys
import threading
from collections.abc import Mapping, Sequence

#: Starts no threads and no device of JAX.
LIBRARIES = (
    *("pytest", "hypothesis", "numpy", "scipy.ndimage", "scipy.spatial", "shapely", "pyarrow.parquet", "PIL.Image"),
    *("jax", "jax.numpy", "mujoco", "mujoco.mjx", "warp", "jaxtyping", "ml_collections", "flax.linen", "optax"),
    *("orbax.checkpoint", "brax.training.agents.ppo.train"),
)
_OWN = ("urbanverse_mjx", "benchmarks", "tests")


def run_tests(
    folder: pathlib.Path,
    environment: Mapping[str, str],
    words: Sequence[str],
    seconds: float,
    output: pathlib.Path | None = None,
) -> tuple[int | None, str]:
    """Runs pytest in a folder from which modules are imported; (exit status, None if it took longer; its output,
    which is written to a file, by default in that folder)."""
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([*LIBRARIES])
    output = output or folder / "output.txt"
    process = context.Process(target=_child, args=(folder, dict(environment), list(words), output))
    process.start()
    process.join(seconds)
    if late := process.is_alive():
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid or 0, signal.SIGKILL)
        process.join()
    text = output.read_text(encoding="utf-8", errors="replace") if output.is_file() else ""
    return None if late else process.exitcode, text


def _child(folder: pathlib.Path, environment: dict[str, str], words: list[str], output: pathlib.Path) -> None:
    os.setsid()
    _end_with_parent()
    file = os.open(output, os.O_WRONLY | os.O_CREAT)
    for stream in (1, 2):
        os.dup2(file, stream)
    os.environ.clear()
    os.environ.update(environment)
    os.chdir(folder)
    for name in [name for name in sys.modules if name.partition(".")[0] in _OWN]:
        del sys.modules[name]
    root = str(pathlib.Path(__file__).parents[3])
    sys.path[:] = [str(folder), *(path for path in sys.path if path not in ("", root)), root]
    sys.argv[:] = ["pytest", *words]
    import pytest

    status = pytest.main(words)
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    os._exit(int(status))


def _end_with_parent() -> None:
    """Ends this session as soon as the process that planted the fault has ended for any reason."""
    parent = multiprocessing.parent_process()

    def watch() -> None:
        if parent is not None:
            parent.join()
            os.killpg(os.getpid(), signal.SIGKILL)

    threading.Thread(target=watch, daemon=True).start()
