"""Tints of records that share a base shape: deterministic functions of the uid, weak for colours with a meaning.

A tint is three numbers: a shift of the hue (1 is the full circle), and factors of saturation and value. It is applied
in full to painted cells of leaves with arbitrary paint (cars, chairs, coats). Skin, glass, leaves, wood, lamps and
similar parts change only slightly, as does everything of leaves whose colour has a meaning (signs, hydrants, food,
animals). Only + - * / are used, so that results are the same on every machine.
"""

import functools
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..categories import ontology
from ..categories.physical import uniforms
from . import palette

Floats = NDArray[np.float64]

#: Middle categories with arbitrary paint.
FREE_MIDDLES = frozenset(
    {
        "cleaning equipment",
        "decorations",
        "electrical appliances",
        "facilities amenity",
        "furniture",
        "household items",
        "kitchenware",
        "office supplies",
        "person",
        "personal care product",
        "personal item",
        "private vehicle",
        "public vehicle",
        "robot",
        "toys",
        "waste management amenity",
        "watercraft vehicle",
    }
)
#: Leaves of these categories with a characteristic colour, which they keep.
MEANING_LEAVES = frozenset(
    {
        "combat tactical  vehicle",
        "construction worker",
        "doctor",
        "emergency worker",
        "firefighter",
        "maintenance worker",
        "police officer",
        "school bus",
        "security guard",
        "taxi",
        "telephone booth",
        "traffic controller",
    }
)
#: Colours of matter rather than paint.
_MATTER = (
    *("skin light", "skin medium", "skin dark", "glass", "dark glass", "lamp", "amber", "light red"),
    *("light green", "leaf", "dark leaf", "light leaf", "yellow leaf", "grass", "bark", "soil", "water", "wood"),
    *("light wood", "dark wood", "grey wood", "brick", "terracotta", "sandstone", "rust", "bronze", "brass", "gold"),
    "cardboard",
)
# Distance of chromaticities (r, g, b over their sum) below which a colour, including its shades, counts as that of the
# material. The distance of the lightest skin and beige paint is 0.03.
_COLOUR_TOLERANCE = 0.03
HUE_SHIFT_SHARE = 0.04  # share of the hue shift that is applied to a colour with a meaning: at most 0.02, 7 degrees
SATURATION_VALUE_SHARE = 0.4  # the same for saturation and value
SATURATION, VALUE = 0.25, 0.18  # largest relative change of a painted cell; an estimate of the variation in a street

BASIC: dict[str, tuple[int, int, int]] = {
    "white": (238, 238, 236),
    "silver": (186, 188, 190),
    "grey": (124, 126, 128),
    "black": (34, 34, 36),
    "red": (190, 34, 38),
    "orange": (236, 110, 26),
    "yellow": (242, 204, 44),
    "green": (50, 126, 60),
    "teal": (36, 128, 128),
    "blue": (40, 88, 168),
    "light blue": (128, 178, 216),
    "purple": (108, 62, 136),
    "pink": (222, 142, 162),
    "brown": (106, 72, 46),
    "beige": (212, 192, 158),
}


def is_free(leaf: str) -> bool:
    """Whether the paint of a leaf's objects is arbitrary.

    Raises:
      UnknownLabelError: no such leaf.
    """
    return ontology.category_of(leaf)[1] in FREE_MIDDLES and leaf not in MEANING_LEAVES


def tints(uids: Sequence[str]) -> Floats:
    """(n, 3) hue turn in [-0.5, 0.5), saturation factor and value factor, each rounded to 0.001."""
    draws = uniforms([f"{uid}#tint" for uid in uids])[:, :3]
    spread = np.array([1.0, 2.0 * SATURATION, 2.0 * VALUE])
    middle = np.array([0.0, 1.0, 1.0])
    return np.floor(((draws - 0.5) * spread + middle) * 1000.0 + 0.5) / 1000.0


def is_paint(colors: NDArray) -> NDArray[np.bool_]:
    """(...,) which of (..., 3) colours (0-255) are paint rather than the natural colour of a material."""
    chroma = _chroma(np.asarray(colors, dtype=np.float64))
    distance = ((chroma[..., None, :] - _matter()) ** 2).sum(-1).min(-1)
    return distance > _COLOUR_TOLERANCE * _COLOUR_TOLERANCE


def tinted(colors: NDArray, tint: NDArray, free: bool, paint: NDArray[np.bool_] | None = None) -> Floats:
    """(..., 3) colours (0-255) after a tint.

    Args:
      colors: (..., 3), 0-255.
      tint: (3,) or (..., 3) broadcast against the colours.
      free: see `is_free`.
      paint: (...,) which colours are paint; None asks `is_paint`.
    """
    colors = np.asarray(colors, dtype=np.float64)
    tint = np.asarray(tint, dtype=np.float64)
    full = (is_paint(colors) if paint is None else np.asarray(paint)) & free
    hue, saturation, value = hsv(colors)
    hue = hue + tint[..., 0] * np.where(full, 1.0, HUE_SHIFT_SHARE)
    saturation = saturation * (1.0 + (tint[..., 1] - 1.0) * np.where(full, 1.0, SATURATION_VALUE_SHARE))
    value = value * (1.0 + (tint[..., 2] - 1.0) * np.where(full, 1.0, SATURATION_VALUE_SHARE))
    return 255.0 * _rgb(hue - np.floor(hue), np.clip(saturation, 0.0, 1.0), np.clip(value, 0.0, 1.0))


def hsv(colors: NDArray) -> tuple[Floats, Floats, Floats]:
    """Hue in [0, 1), saturation and value in [0, 1] of (..., 3) colours (0-255)."""
    c = np.asarray(colors, dtype=np.float64) / 255.0
    high, low = c.max(-1), c.min(-1)
    span = np.where(high > low, high - low, 1.0)
    r, g, b = c[..., 0], c[..., 1], c[..., 2]
    sector = np.where(high == r, (g - b) / span, np.where(high == g, 2.0 + (b - r) / span, 4.0 + (r - g) / span))
    hue = np.where(high > low, sector, 0.0) / 6.0
    return hue - np.floor(hue), np.where(high > 0.0, (high - low) / np.where(high > 0.0, high, 1.0), 0.0), high


def color_names(colors: NDArray) -> NDArray[np.int64]:
    """(...,) index into `BASIC` of the nearest basic colour, by lightness and by chroma relative to it (dark green is
    green, not black)."""
    basics = np.array(list(BASIC.values()), dtype=np.float64)
    apart = _opponent(np.asarray(colors, dtype=np.float64))[..., None, :] - _opponent(basics)
    return (apart * apart).sum(-1).argmin(-1)


def _opponent(colors: Floats) -> Floats:
    """Lightness, and red against green and yellow against blue over the lightness; 40 keeps near-black grey."""
    r, g, b = colors[..., 0], colors[..., 1], colors[..., 2]
    light = (r + g + b) / 3.0
    return np.stack([light / 255.0, (r - g) / (light + 40.0), ((r + g) / 2.0 - b) / (light + 40.0)], axis=-1)


def _chroma(colors: Floats) -> Floats:
    return (colors + 1.0) / (colors.sum(-1, keepdims=True) + 3.0)


@functools.cache
def _matter() -> Floats:
    return _chroma(np.array([palette.NAMED[name] for name in _MATTER], dtype=np.float64))


def _rgb(hue: Floats, saturation: Floats, value: Floats) -> Floats:
    """The inverse of `hsv`, in [0, 1]."""
    channels = []
    for offset in (5.0, 3.0, 1.0):
        k = offset + hue * 6.0
        k = k - 6.0 * np.floor(k / 6.0)
        channels.append(value - value * saturation * np.clip(np.minimum(k, 4.0 - k), 0.0, 1.0))
    return np.stack(channels, axis=-1)
