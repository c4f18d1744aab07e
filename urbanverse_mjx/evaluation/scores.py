"""Scores of a benchmark: over runs with standard errors, over scenes with bootstrap intervals.

Every score is a ratio of sums over episodes and is defined for any set of episodes:

| score | of what |
| --- | --- |
| SR | %, episodes that reach the goal and touch nothing (paper) |
| CT | %, mean share of an episode's time in contact (paper; next to 0 where episodes end at contact) |
| RC | %, mean share of the route done (paper) |
| DTG | m, mean distance to the goal at the end (paper) |
| hit_episodes | %, episodes with any contact |
| SPL | %, success weighted by the shortest path over the path driven (Anderson et al. 2018) |
| failures | per 100 m driven: contacts begun, and episodes that end by leaving the ground, falling or being late |
| speed | m/s, mean |
| reached | %, episodes that end at the goal, whatever was touched on the way |
"""

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from ..datatypes import EpisodeResult

#: Number of bootstrap draws, and their seed.
_DRAWS, _SEED = 10_000, 0


def _failures(r: EpisodeResult) -> float:
    if r.touches is None:
        contacts = int(r.touched)
    else:
        contacts = r.touches
    return 100.0 * (contacts + (r.result in ("off_traversable", "fall", "non_finite", "timeout")))


#: Score -> functions of an episode for its numerator and denominator.
_PARTS: dict[str, tuple[Callable[[EpisodeResult], float], Callable[[EpisodeResult], float]]] = {
    "SR": (lambda r: 100.0 * r.success, lambda r: 1.0),
    "CT": (lambda r: 100.0 * r.hit_time, lambda r: 1.0),
    "RC": (lambda r: 100.0 * r.route_completion, lambda r: 1.0),
    "DTG": (lambda r: r.distance_to_goal, lambda r: 1.0),
    "hit_episodes": (lambda r: 100.0 * r.touched, lambda r: 1.0),
    "SPL": (lambda r: 100.0 * r.spl, lambda r: 1.0),
    "failures": (_failures, lambda r: r.path_length),
    "speed": (lambda r: r.path_length, lambda r: r.duration),
    "reached": (lambda r: 100.0 * (r.result == "goal"), lambda r: 1.0),
}
SCORES = tuple(_PARTS)
#: m, driven distance below which a rate per 100 m is undefined.
_MIN_DISTANCE = 1.0

Score = float | None
Table = dict[str, dict[str, Score]]


def _sums(results: Sequence[EpisodeResult]) -> np.ndarray:
    """(scores, 2) sums of numerators and denominators."""
    return np.array([[sum(f(r) for r in results) for f in parts] for parts in _PARTS.values()], float)


def _ratios(sums: np.ndarray) -> np.ndarray:
    """(..., scores) from (..., scores, 2); NaN where the denominator is 0."""
    least = np.array([_MIN_DISTANCE if name == "failures" else 1e-9 for name in SCORES])
    return np.where(sums[..., 1] > least, sums[..., 0] / np.maximum(sums[..., 1], 1e-9), np.nan)


def scores(results: Sequence[EpisodeResult]) -> dict[str, Score]:
    """Score -> value over all episodes together; None where it is undefined (a rate per metre without motion)."""
    return {name: _plain(x) for name, x in zip(SCORES, _ratios(_sums(results)), strict=True)}


def by_scene(results: Sequence[EpisodeResult]) -> Table:
    """Scene -> its scores, in order of first appearance."""
    ids = dict.fromkeys(r.scene for r in results)
    return {scene: scores([r for r in results if r.scene == scene]) for scene in ids}


def over_runs(results: Sequence[EpisodeResult], runs: Sequence[int]) -> Table:
    """Score -> mean over runs, its standard error, and the number of runs.

    Args:
      runs: index of the run of each episode.
    """
    numbers = sorted(set(runs))
    rows = [_ratios(_sums([r for r, k in zip(results, runs, strict=True) if k == n])) for n in numbers]
    values = np.array(rows)
    error = values.std(0, ddof=1) / math.sqrt(len(rows)) if len(rows) > 1 else np.full(len(SCORES), np.nan)
    return {name: {"mean": _plain(values[:, i].mean()), "se": _plain(error[i])} for i, name in enumerate(SCORES)}


def over_scenes(results: Sequence[EpisodeResult]) -> Table:
    """Score -> mean over all episodes, standard error and 95 % interval of a bootstrap that draws scenes.

    Scenes differ more than the episodes of one scene, so an estimate for similar streets has to draw scenes.
    """
    ids = list(dict.fromkeys(r.scene for r in results))
    sums = np.array([_sums([r for r in results if r.scene == scene]) for scene in ids])
    drawn = np.random.default_rng(_SEED).integers(0, len(ids), (_DRAWS, len(ids)))
    values = _ratios(sums[drawn].sum(1))
    mean = _ratios(sums.sum(0))
    found: Table = {}
    for i, name in enumerate(SCORES):
        part = values[:, i][np.isfinite(values[:, i])]
        some = len(part) > 0 and len(ids) > 1
        low, high = np.percentile(part, [2.5, 97.5]) if some else (np.nan, np.nan)
        error = part.std() if some else np.nan
        found[name] = {"mean": _plain(mean[i]), "se": _plain(error), "low": _plain(low), "high": _plain(high)}
    return found


def _plain(x: float) -> Score:
    return round(float(x), 6) if math.isfinite(x) else None


def rounded(table: Mapping[str, Score], name: str) -> str:
    """Formats a cell: the value with significant digits, ± its standard error."""
    digits = 2 if name in ("CT", "DTG", "failures", "speed") else 1
    if table["mean"] is None:
        return "-"
    text = f"{table['mean']:.{digits}f}"
    return text if table.get("se") is None else f"{text} ± {table['se']:.{digits}f}"
