"""Names of the colours of surfaces: the eleven basic colour terms of English (Berlin and Kay, 1969)."""

import functools

import numpy as np

from .... import srgb

#: Examples (sRGB).
EXAMPLES = {
    "black": ((15, 15, 15), (40, 40, 44)),
    "white": ((245, 245, 245), (222, 222, 216)),
    "grey": ((128, 130, 132), (92, 94, 97), (165, 168, 170)),
    "red": ((178, 28, 30), (215, 45, 40), (138, 24, 28)),
    "orange": ((236, 122, 20), (226, 96, 28)),
    "yellow": ((242, 200, 30), (226, 182, 60)),
    "green": ((40, 120, 52), (84, 160, 72), (30, 82, 46)),
    "blue": ((30, 72, 164), (60, 122, 204), (24, 42, 96)),
    "purple": ((108, 58, 150), (80, 40, 120)),
    "pink": ((232, 142, 172), (225, 110, 160)),
    "brown": ((112, 70, 40), (142, 96, 60), (80, 50, 30)),
}
NAMES = tuple(EXAMPLES)
#: The next other name's nearest example must be farther by this factor (CIE L*a*b* 1976).
MARGIN = 1.3
#: Least share of the paint with the name, and largest one with any other.
LEAST_SHARE, OTHER_SHARE = 0.5, 0.25
#: XYZ of linear sRGB, and of its white, D65 seen at 2 degrees (IEC 61966-2-1).
_XYZ = np.array([[0.412453, 0.357580, 0.180423], [0.212671, 0.715160, 0.072169], [0.019334, 0.119193, 0.950227]])
_WHITE = np.array([0.95047, 1.0, 1.08883])


def lab(rgb: np.ndarray) -> np.ndarray:
    """CIE L*a*b* (1976) (..., 3) of sRGB colours (..., 3) 0-255."""
    t = srgb.linear(np.asarray(rgb, np.float64) / 255.0) @ _XYZ.T / _WHITE
    x, y, z = np.moveaxis(np.where(t > 0.008856, np.cbrt(t), 7.787 * t + 16.0 / 116.0), -1, 0)
    return np.stack([116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)], -1)


@functools.cache
def table() -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) L*a*b* of all examples, and (n,) the rows of `NAMES` that they belong to."""
    examples = np.array([e for rows in EXAMPLES.values() for e in rows], np.float64)
    return lab(examples), np.repeat(np.arange(len(NAMES)), [len(x) for x in EXAMPLES.values()])


def name_rows(rgb: np.ndarray) -> np.ndarray:
    """(n,) row of `NAMES` of colours (n, 3) 0-255, -1 where two names are about equally near."""
    examples, owner = table()
    away = np.linalg.norm(lab(rgb)[:, None] - examples, axis=-1)
    by_name = np.stack([away[:, owner == k].min(1) for k in range(len(NAMES))], 1)
    order = np.sort(by_name, 1)
    return np.where(order[:, 1] >= MARGIN * order[:, 0], by_name.argmin(1), -1)


def main_colour(rgb: np.ndarray, weight: np.ndarray) -> str | None:
    """The name of most of a surface, or None if no name is clear.

    Args:
      rgb: (n, 3) 0-255 of its pieces; weight: (n,) their sizes as seen.
    """
    if not len(rgb) or weight.sum() <= 0:
        return None
    rows = name_rows(rgb)
    share = np.bincount(rows + 1, weight, len(NAMES) + 1) / weight.sum()
    best = int(share[1:].argmax())
    others = np.delete(share[1:], best).max()
    return NAMES[best] if share[1 + best] >= LEAST_SHARE and others <= OTHER_SHARE else None
