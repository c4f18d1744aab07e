"""Work in several threads, and without them where the process ends."""

import concurrent.futures
from collections.abc import Callable, Iterable


def run_all(pool: concurrent.futures.ThreadPoolExecutor, jobs: Iterable[Callable[[], None]]) -> None:
    """Calls every job in the threads of a pool, and returns when all are done."""
    pending = []
    for job in jobs:
        try:
            pending.append(pool.submit(job))
        except RuntimeError:  # no more threads: the process ends, as after Ctrl-C, while JAX still asks for images
            job()
    for done in pending:
        done.result()
