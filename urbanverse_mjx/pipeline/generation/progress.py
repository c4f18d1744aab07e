"""One progress bar per stage, on standard error."""

from collections.abc import Callable

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TextColumn, TimeElapsedColumn


class StageBars:
    """A bar for each stage; quiet draws none."""

    def __init__(self, quiet: bool = False) -> None:
        columns = (TextColumn("{task.description:<28}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
        self._bars = Progress(*columns, console=Console(stderr=True), disable=quiet)

    def __enter__(self) -> "StageBars":
        self._bars.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._bars.stop()

    def stage(self, name: str, total: int = 1) -> Callable[[int, int], None]:
        """Adds a bar; the function returned takes (done, total)."""
        task: TaskID = self._bars.add_task(name, total=total)

        def report(done: int, total: int) -> None:
            self._bars.update(task, completed=done, total=total)

        return report
