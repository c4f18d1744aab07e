"""Timing of compiled functions: medians over repeats with their spread, compilation apart."""

import dataclasses
import statistics
import time
from collections.abc import Callable
from typing import Any

import jax


@dataclasses.dataclass(frozen=True)
class Sample:
    """Repeated wall times of one call.

    Attributes:
      seconds: one entry a repeat, s.
    """

    seconds: tuple[float, ...]

    @property
    def median(self) -> float:
        return statistics.median(self.seconds)

    @property
    def spread(self) -> float:
        """(slowest - fastest) / median."""
        return (max(self.seconds) - min(self.seconds)) / self.median

    def rate(self, count: float) -> float:
        """Returns the rate per second of `count` events, by the median time."""
        return count / self.median


@dataclasses.dataclass(frozen=True)
class Compiled:
    """A compiled function with its tracing and compile time (s)."""

    call: Callable[..., Any]
    seconds: float


def compile_(function: Callable[..., Any], *arguments: Any) -> Compiled:
    """Compiles `function` for these arguments, ahead of its first call."""
    start = time.perf_counter()
    call = jax.jit(function).lower(*arguments).compile()
    return Compiled(call, time.perf_counter() - start)


def first_call(call: Callable[..., Any], *arguments: Any) -> tuple[Any, float]:
    """Returns the result of a call and its seconds; the first call may load or compile Warp's kernels."""
    start = time.perf_counter()
    out = jax.block_until_ready(call(*arguments))
    return out, time.perf_counter() - start


def time_(call: Callable[..., Any], *arguments: Any, repeats: int) -> Sample:
    """Times a call, results awaited, after an untimed one: it may load kernels, and what was called before and is not
    awaited yet ends before it."""
    jax.block_until_ready(call(*arguments))
    seconds = []
    for _ in range(repeats):
        start = time.perf_counter()
        jax.block_until_ready(call(*arguments))
        seconds.append(time.perf_counter() - start)
    return Sample(tuple(seconds))


def time_in_turn(calls: dict[str, Callable[[], Any]], repeats: int) -> dict[str, Sample]:
    """Times several calls in turn, so that a slow phase of the machine affects all of them equally."""
    for call in calls.values():
        jax.block_until_ready(call())
    seconds: dict[str, list[float]] = {name: [] for name in calls}
    for _ in range(repeats):
        for name, call in calls.items():
            start = time.perf_counter()
            jax.block_until_ready(call())
            seconds[name].append(time.perf_counter() - start)
    return {name: Sample(tuple(values)) for name, values in seconds.items()}
