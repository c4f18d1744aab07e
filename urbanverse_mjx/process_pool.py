"""Worker processes that end with the process that started them.

The workers of a `ProcessPoolExecutor` wait for work on a pipe whose other end they hold themselves, so the workers of a
killed process (SIGKILL) wait for ever. Every pool and every process that this package starts watches its parent.
"""

import concurrent.futures
import multiprocessing
import multiprocessing.connection
import os
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any

#: s between two checks of the parent's id, where the operating system gives no notice of its end.
_INTERVAL = 0.5


def end_with_parent(parent: int | None = None) -> None:
    """Ends this process, with status 1, as soon as its parent has ended, however that happened.

    Args:
      parent: id of the process that started this one; None in a process that `multiprocessing` started.
    """
    started_by = multiprocessing.parent_process()
    if parent is None and started_by is None:
        return

    def watch() -> None:
        if parent is None and started_by is not None:
            multiprocessing.connection.wait([started_by.sentinel])
        else:
            while os.getppid() == parent:
                time.sleep(_INTERVAL)
        os._exit(1)

    threading.Thread(target=watch, name="end_with_parent", daemon=True).start()


def worker_pool(
    workers: int, niceness: int = 0, initializer: Callable[..., object] | None = None, initargs: tuple[Any, ...] = ()
) -> concurrent.futures.ProcessPoolExecutor:
    """A pool of processes that end with this one.

    They are spawned, not forked: JAX and MuJoCo may already run threads here.

    Args:
      niceness: added to that of this process, so that others on the machine go first.
      initializer: called with `initargs` in each process before its first task.
    """
    context = multiprocessing.get_context("spawn")
    return concurrent.futures.ProcessPoolExecutor(workers, context, _begin, (niceness, initializer, initargs))


def _begin(niceness: int, initializer: Callable[..., object] | None, initargs: tuple[Any, ...]) -> None:
    end_with_parent()
    if niceness:
        os.nice(niceness)
    if initializer is not None:
        initializer(*initargs)


def results_as_completed(
    function: Callable[..., Any], tasks: Sequence[tuple[Any, ...]], workers: int
) -> Iterator[tuple[int, Any]]:
    """Calls `function(*task)` for every task, in as many processes as asked for but no more than there are tasks.

    With one worker the work runs in this process.

    Yields:
      (number of the task, its result), as they end.

    Raises:
      Exception: that of a task; tasks that have not begun are then dropped.
    """
    workers = min(workers, len(tasks))
    if workers <= 1:
        for number, task in enumerate(tasks):
            yield number, function(*task)
        return
    with worker_pool(workers) as pool:
        jobs = {pool.submit(function, *task): number for number, task in enumerate(tasks)}
        try:
            for job in concurrent.futures.as_completed(jobs):
                yield jobs[job], job.result()
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
