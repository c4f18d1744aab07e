"""Finds unusable frames of a video: dark, blurred, without change, or turning too fast."""

import dataclasses
from collections.abc import Sequence

import cv2
import numpy as np
from scipy import ndimage

#: Rows and columns of the small grey image on which motion is measured.
_MOTION_SIZE = (54, 96)
#: Image height at which sharpness is measured; a smaller one hides slight blur, a larger one shows sensor noise.
_SHARPNESS_ROWS = 270


@dataclasses.dataclass(frozen=True)
class ScreenLimits:
    """Thresholds below or above which a frame is unusable.

    Attributes:
      dark: least brightness, in [0, 1], of a frame's brightest twentieth.
      blurred: least sharpness of a frame as a share of its neighbours' median sharpness.
      flat: least absolute sharpness (fog, a thumb on the lens, a wall), see `measure`.
      still: least median change of a frame since the last one kept, in [0, 1].
      turn: largest share of the width that leaves the view between frames.
    """

    dark: float = 0.12
    blurred: float = 0.3
    flat: float = 0.01
    still: float = 0.004
    turn: float = 0.5


@dataclasses.dataclass(frozen=True)
class Measures:
    """Measures of one frame: brightness of its brightest twentieth in [0, 1]; sharpness; small (54, 96) f32 grey
    image."""

    bright: float
    sharpness: float
    small: np.ndarray


def measure(rgb: np.ndarray) -> Measures:
    """Computes the measures of an image (H, W, 3) u8. Sharpness is the standard deviation of the Laplacian over that of
    the brightness."""
    grey = cv2.cvtColor(rgb.astype(np.float32) / np.float32(255.0), cv2.COLOR_RGB2GRAY)
    height, width = grey.shape
    step = max(1, height // _SHARPNESS_ROWS)
    part = cv2.resize(grey, (width // step, height // step), interpolation=cv2.INTER_AREA) if step > 1 else grey
    contrast = float(part.std())
    sharpness = float(cv2.Laplacian(part, cv2.CV_32F, ksize=1).std()) / contrast if contrast > 0.01 else 0.0
    small = cv2.resize(grey, _MOTION_SIZE[::-1], interpolation=cv2.INTER_AREA)
    return Measures(float(np.quantile(grey[::4, ::4], 0.95)), sharpness, small)


def turned(before: Measures, after: Measures) -> float:
    """Share of the width by which the image moved sideways, by phase correlation; 0 without a match.

    Source: Kuglin and Hines, "The phase correlation image alignment method", 1975. OpenCV's `phaseCorrelate` sums the
    response around the peak, which no longer distinguishes noise from a match: 0.27 for noise, 0.24 for a turn by half
    a width.
    """
    window = np.outer(np.hanning(_MOTION_SIZE[0]), np.hanning(_MOTION_SIZE[1]))
    a, b = (np.fft.rfft2((x.small - x.small.mean()) * window) for x in (before, after))
    cross = a * b.conj()
    peak = np.fft.irfft2(cross / np.maximum(np.abs(cross), 1e-9), _MOTION_SIZE)
    _, column = np.unravel_index(np.argmax(peak), _MOTION_SIZE)
    shift = min(column, _MOTION_SIZE[1] - column) / _MOTION_SIZE[1]
    # Unrelated images also have a highest peak, of about 0.05 at this size.
    return float(shift) if peak.max() > 0.1 else 0.0


def screen(frames: Sequence[Measures], turns: Sequence[float], limits: ScreenLimits) -> list[str | None]:
    """The reason why each frame is unusable, or None.

    Args:
      frames: in order.
      turns: share of the width that left the view before each frame.
    """
    sharp = np.array([f.sharpness for f in frames])
    usual = ndimage.median_filter(sharp, min(15, 2 * (len(sharp) // 2) + 1), mode="nearest") if len(sharp) else sharp
    reasons: list[str | None] = []
    last: Measures | None = None
    for k, frame in enumerate(frames):
        reason = None
        if frame.bright < limits.dark:
            reason = "dark"
        elif frame.sharpness < max(limits.flat, limits.blurred * usual[k]):
            reason = "blurred"
        elif turns[k] > limits.turn:
            reason = "too fast"
        elif last is not None and np.median(np.abs(frame.small - last.small)) < limits.still:
            reason = "static"
        reasons.append(reason)
        if reason is None:
            last = frame
    return reasons
