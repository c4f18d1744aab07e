"""Runs that are killed at a checkpoint."""

import contextlib
from collections.abc import Iterator
from typing import Any

import pytest


@contextlib.contextmanager
def killed_at(number: int, owner: Any, function: str) -> Iterator[list[Any]]:
    """Within, the process is killed right after call `number` of a function that writes; it has to come that far.

    Yields:
      what the function returned, call by call.
    """
    write, written = getattr(owner, function), list[Any]()

    def killed(*given: Any) -> Any:
        written.append(write(*given))
        if len(written) == number:
            raise KeyboardInterrupt
        return written[-1]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(owner, function, killed)
        with pytest.raises(KeyboardInterrupt):
            yield written
