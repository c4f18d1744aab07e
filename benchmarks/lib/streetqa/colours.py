"""Names of colours: of the paint that faces a camera, and of what an image shows of it."""

import functools

import numpy as np
from skimage.color import rgb2lab

#: Examples (sRGB) of the eleven basic colour terms of English (Berlin and Kay 1969).
_EXAMPLES = {
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
NAMES = tuple(_EXAMPLES)
#: The next other name's nearest example must be farther by this factor (CIE L*a*b* 1976).
MARGIN = 1.3
#: Least share of the paint with the name, and largest one with any other.
LEAST_SHARE, OTHER_SHARE = 0.5, 0.25
#: C*ab below which a pixel is without colour; rad of hue within which it has that of a name.
_GREY_CHROMA, _HUE = 14.0, 0.55
#: Share of an object's pixels that must show the hue, or no colour.
_SHOWN = 0.4
#: L* of the median pixel of what is black, grey or white.
_LIGHTNESS = {"black": (0.0, 30.0), "grey": (25.0, 70.0), "white": (62.0, 100.0)}


@functools.cache
def _table() -> tuple[np.ndarray, np.ndarray]:
    examples = np.array([e for rows in _EXAMPLES.values() for e in rows], np.float64)
    return rgb2lab(examples[None] / 255.0)[0], np.repeat(np.arange(len(NAMES)), [len(x) for x in _EXAMPLES.values()])


def name_rows(rgb: np.ndarray) -> np.ndarray:
    """(n,) row of `NAMES` of colours (n, 3) 0-255, -1 where two names are about equally near."""
    lab = rgb2lab(np.asarray(rgb, np.float64).reshape(1, -1, 3) / 255.0)[0]
    examples, owner = _table()
    away = np.linalg.norm(lab[:, None] - examples, axis=-1)
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


def shown_as(rgb: np.ndarray, name: str) -> bool:
    """Whether the pixels (n, 3) 0-255 of an object in a lit image agree with a name: by hue, for black, grey and white
    by little colour and the median's lightness."""
    lab = rgb2lab(np.asarray(rgb, np.float64).reshape(1, -1, 3) / 255.0)[0]
    chroma = np.hypot(lab[:, 1], lab[:, 2])
    if name in _LIGHTNESS:
        low, high = _LIGHTNESS[name]
        return bool((chroma < _GREY_CHROMA).mean() >= 0.5 and low <= np.median(lab[:, 0]) <= high)
    examples, owner = _table()
    wanted = examples[owner == NAMES.index(name)]
    hue = np.arctan2(lab[:, 2], lab[:, 1])
    turn = np.abs(np.angle(np.exp(1j * (hue[:, None] - np.arctan2(wanted[:, 2], wanted[:, 1])))))
    return bool(((turn.min(1) < _HUE) & (chroma >= _GREY_CHROMA * 0.7)).mean() >= _SHOWN)
