"""Executors of a batch's jobs: processes of this machine, or a Ray cluster."""

import concurrent.futures
import dataclasses
import pathlib
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

from ...datatypes import ValidationError, optional
from .stages import GenerationOptions


@dataclasses.dataclass(frozen=True)
class Job:
    """One source of a batch: the source, the folder of its run, and the options of its cousins."""

    source: pathlib.Path
    out: pathlib.Path
    options: GenerationOptions


@dataclasses.dataclass(frozen=True)
class Outcome:
    """Result of a job: exit status, last line of its output, and duration in seconds."""

    status: int
    words: str
    seconds: float


Work = Callable[[Job], Outcome]


class Executor(Protocol):
    """Interface of executors, which run `size` jobs at a time; a context manager."""

    size: int

    def __enter__(self) -> "Executor": ...
    def __exit__(self, *_: object) -> None: ...
    def submit(self, work: Work, job: Job) -> Any:
        """Starts a job and returns its ticket."""
        ...

    def next(self, tickets: Sequence[Any]) -> tuple[Any, Outcome]:
        """Waits for one of the tickets and returns it with its outcome."""
        ...


class LocalExecutor:
    """Threads that each wait for one process at a time."""

    def __init__(self, workers: int) -> None:
        self.size = workers
        self._pool = concurrent.futures.ThreadPoolExecutor(workers)

    def __enter__(self) -> "LocalExecutor":
        return self

    def __exit__(self, *_: object) -> None:
        self._pool.shutdown()

    def submit(self, work: Work, job: Job) -> concurrent.futures.Future:
        return self._pool.submit(work, job)

    def next(self, tickets: Sequence[concurrent.futures.Future]) -> tuple[concurrent.futures.Future, Outcome]:
        done, _ = concurrent.futures.wait(tickets, return_when=concurrent.futures.FIRST_COMPLETED)
        ticket = done.pop()
        return ticket, ticket.result()


class RayExecutor:
    """Ray tasks of one core each: on the cluster that RAY_ADDRESS names, else on one started here with `workers` cores.

    Workers need this package installed and see the same files. A job whose worker dies counts as failed with status 1.

    Raises:
      ValidationError: Ray is not installed.
    """

    def __init__(self, workers: int) -> None:
        self._ray, self._workers = optional.package("ray", "--executor ray", "cluster"), workers
        self.size = workers

    def __enter__(self) -> "RayExecutor":
        if not self._ray.is_initialized():
            try:
                self._ray.init(include_dashboard=False, log_to_driver=False, logging_level="error")
                cores = int(self._ray.cluster_resources().get("CPU", 1))
                self.size = min(self._workers, cores) if cores else self._workers
            except ConnectionError as error:
                raise ValidationError(
                    f"--executor ray: found no cluster ({error}), needed one; check RAY_ADDRESS."
                ) from error
        return self

    def __exit__(self, *_: object) -> None:
        self._ray.shutdown()

    def submit(self, work: Work, job: Job) -> Any:
        return self._ray.remote(num_cpus=1, max_retries=0)(work).remote(job)

    def next(self, tickets: Sequence[Any]) -> tuple[Any, Outcome]:
        (ticket, *_), _ = self._ray.wait(list(tickets), num_returns=1)
        try:
            return ticket, self._ray.get(ticket)
        except self._ray.exceptions.RayError as error:
            return ticket, Outcome(1, f"Ray: {str(error).splitlines()[0]}", 0.0)


EXECUTORS: Mapping[str, Callable[[int], Executor]] = {"local": LocalExecutor, "ray": RayExecutor}
