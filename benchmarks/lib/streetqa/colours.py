"""Names of colours: of the paint that faces a camera, and of what an image shows of it."""

import numpy as np

from urbanverse_mjx.envs.navigation.tasks.colours import NAMES, lab, main_colour, name_rows, table

__all__ = ["NAMES", "main_colour", "name_rows", "shown_as"]

#: C*ab below which a pixel is without colour; rad of hue within which it has that of a name.
_GREY_CHROMA, _HUE = 14.0, 0.55
#: Share of an object's pixels that must show the hue, or no colour.
_SHOWN = 0.4
#: L* of the median pixel of what is black, grey or white.
_LIGHTNESS = {"black": (0.0, 30.0), "grey": (25.0, 70.0), "white": (62.0, 100.0)}


def shown_as(rgb: np.ndarray, name: str) -> bool:
    """Whether the pixels (n, 3) 0-255 of an object in a lit image agree with a name: by hue, for black, grey and white
    by little colour and the median's lightness."""
    seen = lab(np.asarray(rgb).reshape(-1, 3))
    chroma = np.hypot(seen[:, 1], seen[:, 2])
    if name in _LIGHTNESS:
        low, high = _LIGHTNESS[name]
        return bool((chroma < _GREY_CHROMA).mean() >= 0.5 and low <= np.median(seen[:, 0]) <= high)
    examples, owner = table()
    wanted = examples[owner == NAMES.index(name)]
    hue = np.arctan2(seen[:, 2], seen[:, 1])
    turn = np.abs(np.angle(np.exp(1j * (hue[:, None] - np.arctan2(wanted[:, 2], wanted[:, 1])))))
    return bool(((turn.min(1) < _HUE) & (chroma >= _GREY_CHROMA * 0.7)).mean() >= _SHOWN)
