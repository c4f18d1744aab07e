"""Fleiss' kappa: agreement of many raters on categories, beyond chance."""

import numpy as np

from ..datatypes import validation as v

_DRAWS, _SEED = 2000, 0


def fleiss_kappa(counts: np.ndarray) -> float:
    """Kappa of Fleiss (1971), Psychological Bulletin 76(5), 378-382; 1 = full agreement, 0 = that of chance.

    Items may have different numbers of ratings; those with fewer than two are left out. If all ratings are of one
    category, chance alone gives full agreement, and the result is NaN.

    Args:
      counts: (items, categories), how many raters put an item into a category.

    Raises:
      ValidationError: no item has two ratings.
    """
    counts = np.asarray(counts, np.float64)
    number = counts.sum(1)
    counts, number = counts[number >= 2], number[number >= 2]
    if not len(counts):
        raise v.fail("Fleiss' kappa", "no item with two ratings", "at least one", "collect answers of more people")
    agree = ((counts**2).sum(1) - number) / (number * (number - 1))
    share = counts.sum(0) / number.sum()
    chance = float((share**2).sum())
    return float("nan") if chance > 1 - 1e-12 else float((agree.mean() - chance) / (1 - chance))


def kappa_interval(counts: np.ndarray) -> tuple[float, float] | None:
    """95 % percentile interval of `fleiss_kappa` by a bootstrap over items; None if it cannot be drawn."""
    counts = np.asarray(counts)[np.asarray(counts).sum(1) >= 2]
    rng = np.random.default_rng(_SEED)
    drawn = []
    for _ in range(_DRAWS if len(counts) > 1 else 0):
        value = fleiss_kappa(counts[rng.integers(len(counts), size=len(counts))])
        if np.isfinite(value):
            drawn.append(value)
    if not drawn:
        return None
    low, high = np.percentile(drawn, [2.5, 97.5])
    return float(low), float(high)
