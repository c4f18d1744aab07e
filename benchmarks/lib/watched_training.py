"""Runs `urbanverse train` and writes the memory of this process on its GPU into a file: other processes cannot read it.

    python -m benchmarks.lib.watched_training FILE --logdir FOLDER ...

`nvidia-smi` is not asked: it adds up all programs, and in a container it does not know their process ids.
"""

import pathlib
import sys
import threading
from collections.abc import Callable, Sequence

from urbanverse_mjx.cli.main import main as command

#: Checkpoints of `urbanverse train` below its --logdir.
CHECKPOINTS = "*/checkpoints/*/policy.json"


def watch(
    file: pathlib.Path, logdir: pathlib.Path, measure: Callable[[], float], every: float, ended: threading.Event
) -> None:
    """Writes what `measure` returns (MiB) to a file, every so many seconds, from the first checkpoint on.

    Asked before, JAX would choose its device earlier than without this thread.
    """
    while not ended.wait(every):
        if file.exists() or next(logdir.glob(CHECKPOINTS), None) is not None:
            part = file.with_suffix(".part")
            part.write_text(f"{measure():.3f}", encoding="ascii")
            part.replace(file)


def _peak_device_mib() -> float:
    # Imports JAX, which the command does after it has set the folder of compiled programs.
    from benchmarks.lib.memory import peak_device_mib

    return peak_device_mib()


def main(argv: Sequence[str]) -> int:
    file, options = pathlib.Path(argv[0]), list(argv[1:])
    logdir, ended = pathlib.Path(options[options.index("--logdir") + 1]), threading.Event()
    threading.Thread(target=watch, args=(file, logdir, _peak_device_mib, 1.0, ended), daemon=True).start()
    sys.argv[:] = ["urbanverse", "train", *options]
    try:
        return command()
    finally:
        ended.set()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
