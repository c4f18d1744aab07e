"""Progress reports on standard error: bars in a terminal, a line every few seconds elsewhere."""

import multiprocessing
import sys
import threading
import time
from collections.abc import Callable
from types import TracebackType

import rich.progress
from rich.console import Console
from rich.progress import BarColumn, ProgressColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.text import Text

from .datatypes.validation import counted

#: s between two lines if standard error is not a terminal; a log without output for longer looks like a hang.
LINE_EVERY = 10.0

#: Note of a task whose first report comes when its program is compiled and has run once, which can take a minute.
COMPILING = "compiling"
#: Takes the amount done and the total, if known.
Report = Callable[..., None]


class _Count(ProgressColumn):
    """Column with the amount done and the total, with thousands separators: "1,024/204,800"."""

    def render(self, task: rich.progress.Task) -> Text:
        return Text(_count(task))


def _count(task: rich.progress.Task) -> str:
    return counted(task.completed, task.fields["unit"], task.total)


class Progress:
    """Progress of one task or several, as a context manager.

    If standard error is not a terminal, a line reports the most recently begun task every `LINE_EVERY` seconds, with or
    without progress; shorter work prints nothing.

    Args:
      quiet: print no progress, as in a process that another one started by `multiprocessing`.
    """

    def __init__(self, quiet: bool = False) -> None:
        # What works for another process would write between its lines.
        quiet = quiet or multiprocessing.parent_process() is not None
        terminal = sys.stderr.isatty()
        columns = (
            TextColumn("{task.description:<24}"),
            BarColumn(),
            _Count(),
            TextColumn("{task.fields[note]}"),
            TimeElapsedColumn(),
            TextColumn("left"),
            TimeRemainingColumn(),
        )
        self._bars = rich.progress.Progress(*columns, console=Console(stderr=True), disable=quiet or not terminal)
        self._tasks: dict[rich.progress.TaskID, float] = {}
        self._lines = not quiet and not terminal
        self._ended = threading.Event()
        self._thread: threading.Thread | None = None

    def start(self) -> "Progress":
        """Begins the display, like entering the context; `stop` ends it."""
        self._bars.start()
        if self._lines:
            self._thread = threading.Thread(target=self._write_lines, name="progress", daemon=True)
            self._thread.start()
        return self

    def __enter__(self) -> "Progress":
        return self.start()

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.stop()

    def stop(self) -> None:
        """Ends all tasks, like leaving the context."""
        self._ended.set()
        if self._thread is not None:
            self._thread.join()
        self._bars.stop()

    def task(self, name: str, total: float | None = None, done: float = 0, unit: str = "", note: str = "") -> Report:
        """Begins a task; returns a function of (done, total=None, note=None), where None keeps the previous value.

        Args:
          unit: of both amounts, in the plural: "steps".
        """
        task = self._bars.add_task(name, total=total, unit=unit, note=note)
        self._bars.update(task, completed=done)
        self._tasks[task] = time.monotonic()

        def report(done: float, total: float | None = None, note: str | None = None) -> None:
            if note is not None:
                self._bars.update(task, note=note)
            self._bars.update(task, completed=done, total=total)

        return report

    def print(self, text: str) -> None:
        """Prints a line above the bars."""
        self._bars.console.print(text, highlight=False, markup=False, soft_wrap=True)

    def _write_lines(self) -> None:
        while not self._ended.wait(LINE_EVERY):
            if self._tasks:
                task, begin = next(reversed(self._tasks.items()))
                sys.stderr.write(_line(self._bars.tasks[task], time.monotonic() - begin))
                sys.stderr.flush()


def _line(task: rich.progress.Task, seconds: float) -> str:
    """Returns task, count, seconds and note: "training: 1,024/204,800 steps, 35 s, 310 steps/s"."""
    note = f", {task.fields['note']}" if task.fields["note"] else ""
    return f"{task.description}: {_count(task)}, {seconds:.0f} s{note}\n"
