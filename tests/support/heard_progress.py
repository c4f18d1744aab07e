"""Records the names and notes of tasks of `Progress`."""

from collections.abc import Callable
from typing import Any

from urbanverse_mjx.progress import Progress, Report


def noted(notes: list[tuple[str, str | None]]) -> Callable[..., Report]:
    """A `Progress.task` that appends (task, note) as a task begins and whenever it reports; None: the same note."""
    begin = Progress.task

    def task(self: Progress, name: str, *rest: Any, note: str = "", **more: Any) -> Report:
        notes.append((name, note))
        report = begin(self, name, *rest, note=note, **more)

        def noting(*now: Any, note: str | None = None) -> None:
            notes.append((name, note))
            report(*now, note=note)

        return noting

    return task
