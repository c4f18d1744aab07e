"""Tells images without colour, whose grey says nothing of the colours of what they show."""

import numpy as np

from ..datatypes import Recording

#: Chroma, of 255, that less than `_COLOURED` of an image's pixels have if it has no colour; JPEG noise of grey images
#: stays below it.
_MIN_CHROMA, _COLOURED = 5.0, 0.01
#: Number of frames of a recording that are judged.
_FRAMES = 9


def is_colourless(image: np.ndarray) -> bool:
    """Whether an image (H, W, 3) u8 is grey, or grey with one tint."""
    part = image[::4, ::4].astype(np.float32)
    red, blue = (part[..., k] - part.mean(-1) for k in (0, 2))
    chroma = np.hypot(red - np.median(red), blue - np.median(blue))
    return bool((chroma > _MIN_CHROMA).mean() < _COLOURED)


def without_colour(recording: Recording) -> bool:
    """Whether most of a recording's frames have no colour."""
    chosen = np.unique(np.linspace(0, len(recording) - 1, min(_FRAMES, len(recording))).round().astype(int))
    return bool(np.mean([is_colourless(recording.rgb(int(number))) for number in chosen]) > 0.5)
