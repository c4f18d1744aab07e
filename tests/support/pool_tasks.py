"""Tasks of worker processes, in a module that a new process imports in no time."""

import os
import pathlib
import time


def sleep(folder: str, number: int) -> None:
    """Leaves a file `number` with the process id in a folder, and sleeps for two minutes."""
    path = pathlib.Path(folder) / f".{number}"
    path.write_text(str(os.getpid()))
    path.rename(pathlib.Path(folder) / str(number))
    time.sleep(120)


def platform_and_square(number: int) -> tuple[str, int]:
    """The platform of JAX in this process, and a square."""
    import jax

    return jax.default_backend(), number * number


def square(number: int) -> tuple[int, int]:
    """The square and the process id.

    Raises:
      ValueError: the number is negative.
    """
    if number < 0:
        raise ValueError(f"found {number}")
    return number * number, os.getpid()
