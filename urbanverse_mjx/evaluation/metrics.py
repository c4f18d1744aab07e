"""Metrics SR, CT, RC, DTG and others with 95 % intervals.

SR: share of episodes that reach the goal without a hit. CT: mean share of episode time in contact (the paper's
definition; near 0 if episodes end at contact, so the share of episodes with a hit is reported too). RC: mean share of
the route reached. DTG: mean distance to the goal at the end, m. SPL: Anderson et al. 2018.

With people (scenario dynamic): agent_hits, share of episodes that end by touching an agent; people_distance, mean over
episodes of the least distance to a person, m; IT, mean share of time within 0.45 m of a person (Hall's intimate
distance); speed_near_people, mean speed within 1.2 m of a person, m/s, over the episodes with such time.

With a task beside point goals: its scores as task/NAME (`envs.navigation.tasks`).
"""

import math
from collections.abc import Sequence

import numpy as np

from ..datatypes import EpisodeResult

_Z = 1.959964  # 97.5 % quantile of the normal distribution
#: Number of bootstrap draws, and their seed.
_DRAWS, _SEED = 2000, 0


def wilson_interval(successes: int, total: int) -> tuple[float, float]:
    """95 % interval of a proportion (Wilson 1927), in [0, 1]."""
    if total <= 0:
        return 0.0, 1.0
    p = successes / total
    centre = p + _Z**2 / (2 * total)
    spread = _Z * math.sqrt(p * (1 - p) / total + _Z**2 / (4 * total**2))
    scale = 1 + _Z**2 / total
    return max(0.0, (centre - spread) / scale), min(1.0, (centre + spread) / scale)


def drawn_counts(scenes: Sequence[str]) -> np.ndarray | None:
    """(draws, n) count of each of n episodes in each draw of a two-stage bootstrap.

    Scenes are drawn with replacement, then from each drawn scene as many episodes as it has, with replacement, because
    the episodes of one scene are correlated and the interval is for similar streets (Davison and Hinkley 1997, section
    3.8).

    Args:
      scenes: the scene of each episode.

    Returns:
      None if all episodes are in one scene, which does not allow an interval over scenes.
    """
    ids, which = np.unique(np.asarray(scenes), return_inverse=True)
    if len(ids) < 2:
        return None
    rng = np.random.default_rng(_SEED)
    times = rng.multinomial(len(ids), np.full(len(ids), 1.0 / len(ids)), _DRAWS)
    counts = np.zeros((_DRAWS, len(which)), int)
    for k in range(len(ids)):
        rows = np.flatnonzero(which.ravel() == k)
        counts[:, rows] = rng.multinomial(times[:, k] * len(rows), np.full(len(rows), 1.0 / len(rows)))
    return counts


def mean_interval(values: Sequence[float | None], counts: np.ndarray | None) -> tuple[float, float] | None:
    """95 % percentile interval of the mean over the episodes that have a value; None without draws.

    Args:
      values: (n,) value of each episode, or None.
      counts: see `drawn_counts`.
    """
    if counts is None:
        return None
    there = np.array([x is not None for x in values])
    array = np.array([0.0 if x is None else x for x in values], float)
    number = counts @ there
    means = (counts @ array)[number > 0] / number[number > 0]
    if not len(means):
        return None
    low, high = np.percentile(means, [2.5, 97.5])
    return float(low), float(high)


def _entry(mean: float, interval: tuple[float, float] | None, digits: int) -> dict[str, float | None]:
    low, high = (None, None) if interval is None else (round(x, digits) for x in interval)
    return {"mean": round(mean, digits), "low": low, "high": high}


def summarise(results: Sequence[EpisodeResult]) -> dict[str, object]:
    """Metric -> {"mean", "low", "high"}; SR, CT, RC and rates in percent, DTG in metres.

    `n` is the number of episodes, `scenes` that of scenes; low and high are None for a single scene.
    """
    counts = drawn_counts([r.scene for r in results])

    def share(flags: Sequence[bool]) -> dict[str, float | None]:
        found = mean_interval([100.0 * x for x in flags], counts)
        if found is not None:
            # Without any success, the bootstrap has no spread; the interval is at least Wilson's.
            low, high = wilson_interval(sum(flags), len(flags))
            found = min(found[0], 100.0 * low), max(found[1], 100.0 * high)
        return _entry(100.0 * float(np.mean(flags)), found, 1)

    def mean(values: Sequence[float | None], factor: float = 1.0, digits: int = 1) -> dict[str, float | None] | None:
        scaled = [None if x is None else factor * x for x in values]
        there = [x for x in scaled if x is not None]
        return _entry(float(np.mean(there)), mean_interval(scaled, counts), digits) if there else None

    found: dict[str, object] = {
        "SR": share([r.success for r in results]),
        "CT": mean([r.hit_time for r in results], 100.0, 2),
        "RC": mean([r.route_completion for r in results], 100.0),
        "DTG": mean([r.distance_to_goal for r in results], 1.0, 2),
        "hit_episodes": share([r.touched for r in results]),
        "SPL": mean([r.spl for r in results], 100.0),
        "n": len(results),
        "scenes": len({r.scene for r in results}),
    }
    if any(r.people_distance is not None for r in results):
        found["agent_hits"] = share([r.result == "hit_agent" for r in results])
        found["people_distance"] = mean([r.people_distance for r in results], 1.0, 2)
        found["IT"] = mean([r.intimate_time for r in results], 100.0, 2)
        found["speed_near_people"] = mean([r.speed_near_people for r in results], 1.0, 2)
    for name in dict.fromkeys(name for r in results for name in r.task_scores or ()):
        found[f"task/{name}"] = mean([(r.task_scores or {}).get(name) for r in results], 1.0, 3)
    return found
