"""Percentile intervals of shares, from resampling whole units (photographs, streets) with replacement."""

import numpy as np

#: Draws of an interval.
DRAWS = 2000


def share_interval(top: np.ndarray, under: np.ndarray, seed: int = 0) -> tuple[float, float] | None:
    """95 % interval of sum(top) / sum(under), by the percentile bootstrap (Efron, 1979) over units.

    Args:
      top, under: (n,) numerator and denominator of each unit; units with a denominator of 0 take part in the draws.

    Returns:
      lower and upper bound, or None where fewer than two units have a denominator.
    """
    if np.count_nonzero(under) < 2:
        return None
    drawn = np.random.default_rng(seed).integers(len(under), size=(DRAWS, len(under)))
    tops, unders = top[drawn].sum(1), under[drawn].sum(1)
    low, high = np.percentile(tops[unders > 0] / unders[unders > 0], [2.5, 97.5])
    return float(low), float(high)


def with_interval(top: np.ndarray, under: np.ndarray) -> list[float] | None:
    """[share, low, high], rounded to three decimals; the share alone where there is no interval, None without one."""
    if not under.sum():
        return None
    bounds = share_interval(top, under)
    return [round(float(x), 3) for x in (top.sum() / under.sum(), *(bounds or ()))]
