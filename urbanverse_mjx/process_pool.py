"""Worker processes that exit when their parent process exits.

The workers of a `ProcessPoolExecutor` hold both ends of the pipe on which they wait for work, so they wait forever if
their parent is killed (SIGKILL). Every pool and process that this package starts therefore watches its parent.
"""

import collections
import concurrent.futures
import concurrent.futures.process
import contextlib
import multiprocessing
import multiprocessing.connection
import os
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any

#: Least number of streets for which a process of its own is started: importing JAX takes as long as the tables of one.
_STREETS_EACH = 4
#: s between two checks of the parent's id, on operating systems that do not signal its exit.
_INTERVAL = 0.5


def end_with_parent(parent: int | None = None, delay: float = 0.0) -> None:
    """Exits this process with status 1 as soon as its parent has exited for any reason.

    Args:
      parent: id of the process that started this one; None in a process that `multiprocessing` started.
      delay: s to wait after that.
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
        time.sleep(delay)
        os._exit(1)

    threading.Thread(target=watch, name="end_with_parent", daemon=True).start()


def worker_pool(
    workers: int, niceness: int = 0, initializer: Callable[..., object] | None = None, initargs: tuple[Any, ...] = ()
) -> concurrent.futures.ProcessPoolExecutor:
    """Returns a pool of processes that exit with this one.

    They are spawned, not forked: JAX and MuJoCo may already run threads here.

    Args:
      niceness: added to this process's niceness, so that other processes on the machine have priority.
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
    """Calls `function(*task)` for every task, in at most `workers` processes and no more than there are tasks.

    With one worker the work runs in this process.

    Yields:
      (index of the task, its result), in order of completion.

    Raises:
      Exception: a task failed; tasks that have not begun are dropped.
      ValidationError: a worker process ended by itself, for want of memory or because it ran the calling script again.
    """
    workers = min(workers, len(tasks))
    if workers <= 1:
        for number, task in enumerate(tasks):
            yield number, function(*task)
        return
    with _work(workers, worker_pool(workers)) as pool:
        jobs = {pool.submit(function, *task): number for number, task in enumerate(tasks)}
        for job in concurrent.futures.as_completed(jobs):
            yield jobs[job], job.result()


def results_in_order(
    function: Callable[..., Any],
    tasks: Iterable[tuple[Any, ...]],
    workers: int,
    initializer: Callable[[], object] | None = None,
) -> Iterator[Any]:
    """Calls `function(*task)` for every task, in `workers` processes.

    With one worker the work runs in this process. Tasks are made while others run, two for each worker at most, so that
    many large ones take little memory.

    Args:
      initializer: called in each process before its first task.

    Yields:
      the result of each task, in their order.

    Raises:
      Exception, ValidationError: see `results_as_completed`.
    """
    if workers <= 1:
        for task in tasks:
            yield function(*task)
        return
    with _work(workers, worker_pool(workers, initializer=initializer)) as pool:
        jobs: collections.deque[concurrent.futures.Future[Any]] = collections.deque()
        for task in tasks:
            jobs.append(pool.submit(function, *task))
            if len(jobs) == 2 * workers:
                yield jobs.popleft().result()
        while jobs:
            yield jobs.popleft().result()


def workers_for(streets: int, cores: int) -> int:
    """The number of processes for work that takes seconds of a core for each of some streets; 0 or 1: this one."""
    return min(cores, streets // _STREETS_EACH)


@contextlib.contextmanager
def _work(
    workers: int, pool: concurrent.futures.ProcessPoolExecutor
) -> Iterator[concurrent.futures.ProcessPoolExecutor]:
    """The pool; at the end drops tasks that have not begun, and tells in a sentence if a worker ended by itself."""
    from .datatypes import ValidationError

    with pool:
        try:
            yield pool
        except concurrent.futures.process.BrokenProcessPool as error:
            raise ValidationError(
                f"worker processes: found that one of {workers} ended by itself, needed all of them. In a script of "
                'yours, put the calls below `if __name__ == "__main__":`, because workers import the script; if memory '
                "is short, take fewer processes (URBANVERSE_THREADS=1 starts none)."
            ) from error
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
