"""The stop watch of the peers: the same for all of them."""

import statistics
import time
from collections.abc import Callable
from typing import Any, Protocol

import numpy as np


class Peer(Protocol):
    """An engine with its envs at their starts, ready to be timed."""

    #: What it does and leaves out, a phrase of the table.
    does: str
    #: Geoms of a street that a robot can hit, the most of all streets.
    hulls: int

    def run(self, steps: int) -> None:
        """Goes on by so many control steps with images and new beginnings; returns when all is done."""
        ...

    def qpos(self) -> np.ndarray:
        """Returns (n, nq) positions."""
        ...

    def image(self, env: int) -> np.ndarray:
        """Returns an image of an env, uint8 with R, G, B last."""
        ...

    def close(self) -> None:
        """Ends processes and threads that it started."""
        ...


def steps_for(seconds_each: float, seconds: float, most: int) -> int:
    """Returns how many control steps take about `seconds`, from 1 to `most`."""
    return int(np.clip(round(seconds / max(seconds_each, 1e-9)), 1, most))


def timed(make: Callable[[], Peer], count: int, repeats: int, seconds: float, most: int) -> tuple[Peer, dict[str, Any]]:
    """Makes a peer and times it.

    Args:
      make: makes the peer, which counts as compilation, as its first control step does.
      count: envs.
      repeats: timed runs, of which the median counts.
      seconds: about how long a timed run should take.
      most: control steps of a run at most.

    Returns:
      the peer and its figures.
    """
    begin = time.perf_counter()
    peer = make()
    start = peer.qpos().copy()
    peer.run(1)
    ready = time.perf_counter()
    peer.run(1)
    steps = steps_for(time.perf_counter() - ready, seconds, most)
    taken = []
    for _ in range(repeats):
        since = time.perf_counter()
        peer.run(steps)
        taken.append(time.perf_counter() - since)
    median = statistics.median(taken)
    return peer, {
        "env_steps_per_s": steps * count / median,
        "env_steps_per_s_spread": (max(taken) - min(taken)) / median,
        "compile_s": ready - begin,
        "steps": steps,
        "repeats": repeats,
        "hulls": peer.hulls,
        "does": peer.does,
        **driven(start, peer.qpos()),
    }


def driven(start: np.ndarray, end: np.ndarray) -> dict[str, Any]:
    """Tells whether the engine really drove: the mean distance from the start, and the envs that are not on the street.

    Args:
      start, end: (n, nq) positions, x, y, z first.
    """
    fine = np.isfinite(end).all(1) & (np.abs(end[:, 2] - start[:, 2]) < 1.0)
    driven_m = np.linalg.norm(end[fine, :2] - start[fine, :2], axis=1)
    return {"driven_m": float(driven_m.mean()) if fine.any() else 0.0, "lost_share": float(1.0 - fine.mean())}
