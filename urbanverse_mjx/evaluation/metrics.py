"""SR, CT, RC, DTG and relatives with 95 % intervals.

SR: share of episodes that reach the goal without a hit. CT: mean share of episode time in contact (the paper's
definition; near 0 where an episode ends at contact, so the share of episodes with a hit stands beside it).
RC: mean share of the route reached. DTG: mean distance to the goal at the end, m. SPL: Anderson et al. 2018.

With people (scenario dynamic): agent_hits, share of episodes that end by touching an agent; people_distance, mean over
episodes of the least distance to a person, m; IT, mean share of time within 0.45 m of one (Hall's intimate distance);
speed_near_people, mean speed within 1.2 m of one, m/s, over the episodes that have such time.
"""

import math
from collections.abc import Sequence

import numpy as np

from ..datatypes import EpisodeResult

_Z = 1.959964  # 97.5 % quantile of the normal distribution


def wilson_interval(successes: int, total: int) -> tuple[float, float]:
    """95 % interval of a proportion (Wilson 1927), in [0, 1]."""
    if total <= 0:
        return 0.0, 1.0
    p = successes / total
    centre = p + _Z**2 / (2 * total)
    spread = _Z * math.sqrt(p * (1 - p) / total + _Z**2 / (4 * total**2))
    scale = 1 + _Z**2 / total
    return max(0.0, (centre - spread) / scale), min(1.0, (centre + spread) / scale)


def bootstrap_interval(values: Sequence[float], draws: int = 2000, seed: int = 0) -> tuple[float, float]:
    """95 % percentile interval of the mean over episodes drawn with replacement."""
    array = np.asarray(values, float)
    rng = np.random.default_rng(seed)
    means = array[rng.integers(0, len(array), (draws, len(array)))].mean(1)
    low, high = np.percentile(means, [2.5, 97.5])
    return float(low), float(high)


def _entry(mean: float, interval: tuple[float, float], digits: int = 3) -> dict[str, float]:
    return {"mean": round(mean, digits), "low": round(interval[0], digits), "high": round(interval[1], digits)}


def summarise(results: Sequence[EpisodeResult]) -> dict[str, object]:
    """Metric -> {"mean", "low", "high"}; SR, CT, RC and rates in percent, DTG in metres, n the number of episodes."""

    def share(flags: list[bool]) -> dict[str, float]:
        low, high = wilson_interval(sum(flags), len(flags))
        return _entry(100 * float(np.mean(flags)), (100 * low, 100 * high), 1)

    def mean(values: list[float], factor: float = 1.0, digits: int = 1) -> dict[str, float]:
        scaled = [factor * x for x in values]
        return _entry(float(np.mean(scaled)), bootstrap_interval(scaled), digits)

    found: dict[str, object] = {
        "SR": share([r.success for r in results]),
        "CT": mean([r.hit_time for r in results], 100.0, 2),
        "RC": mean([r.route_completion for r in results], 100.0),
        "DTG": mean([r.distance_to_goal for r in results], 1.0, 2),
        "hit_episodes": share([r.touched for r in results]),
        "SPL": mean([r.spl for r in results], 100.0),
        "n": len(results),
    }
    distances = [r.people_distance for r in results if r.people_distance is not None]
    if distances:
        speeds = [r.speed_near_people for r in results if r.speed_near_people is not None]
        found["agent_hits"] = share([r.result == "hit_agent" for r in results])
        found["people_distance"] = mean(distances, 1.0, 2)
        found["IT"] = mean([r.intimate_time for r in results if r.intimate_time is not None], 100.0, 2)
        found["speed_near_people"] = mean(speeds, 1.0, 2) if speeds else None
    return found
