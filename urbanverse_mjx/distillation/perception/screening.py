"""Which frames of a video are of no use: dark, blurred, without anything new, or turned away too fast."""

import dataclasses
from collections.abc import Sequence

import numpy as np
from scipy import ndimage

#: Rows and columns of the small grey picture on which motion is measured.
_SMALL = (54, 96)
#: Rows that sharpness is measured at: fewer hide slight blur, more show the noise of the sensor.
_ROWS = 270


@dataclasses.dataclass(frozen=True)
class ScreenLimits:
    """Where a frame becomes unusable.

    Attributes:
      dark: the brightest twentieth of a frame is at least this bright, of 1.
      blurred: a frame is at least this sharp, as a share of the middle sharpness of its neighbours.
      flat: and at least this sharp in itself (fog, a thumb on the lens, a wall); see `measure`.
      still: half of a frame has changed by at least this since the last one kept, of 1.
      turn: at most this share of the width has gone out of sight since the frame before.
    """

    dark: float = 0.12
    blurred: float = 0.3
    flat: float = 0.01
    still: float = 0.004
    turn: float = 0.5


@dataclasses.dataclass(frozen=True)
class Measures:
    """Of one frame: brightness of its brightest twentieth in [0, 1]; sharpness; small (54, 96) f32 grey."""

    bright: float
    sharpness: float
    small: np.ndarray


def measure(rgb: np.ndarray) -> Measures:
    """Measures of a picture (H, W, 3) u8. Sharpness: deviation of its Laplacian over that of its brightness."""
    grey = rgb @ np.array([0.299, 0.587, 0.114], np.float32) / np.float32(255.0)
    step = max(1, grey.shape[0] // _ROWS)
    part = ndimage.uniform_filter(grey, step)[::step, ::step] if step > 1 else grey
    contrast = float(part.std())
    sharpness = float(ndimage.laplace(part).std()) / contrast if contrast > 0.01 else 0.0
    zoom = _SMALL[0] / grey.shape[0], _SMALL[1] / grey.shape[1]
    blurred = ndimage.gaussian_filter(grey, [0.5 / z for z in zoom])
    rows, columns = (np.minimum(((np.arange(n) + 0.5) / z).astype(int), size - 1)
                     for n, z, size in zip(_SMALL, zoom, grey.shape, strict=True))  # fmt: skip
    return Measures(float(np.quantile(grey[::4, ::4], 0.95)), sharpness, blurred[np.ix_(rows, columns)])


def turned(before: Measures, after: Measures) -> float:
    """Share of the width by which the picture moved sideways, by phase correlation; 0 where nothing matches.

    Source: Kuglin and Hines, "The phase correlation image alignment method", 1975.
    """
    window = np.outer(np.hanning(_SMALL[0]), np.hanning(_SMALL[1]))
    a, b = (np.fft.rfft2((x.small - x.small.mean()) * window) for x in (before, after))
    cross = a * b.conj()
    peak = np.fft.irfft2(cross / np.maximum(np.abs(cross), 1e-9), _SMALL)
    _, column = np.unravel_index(np.argmax(peak), _SMALL)
    shift = min(column, _SMALL[1] - column) / _SMALL[1]
    # Two pictures with nothing in common have a highest peak too, of about 0.05 at this size.
    return float(shift) if peak.max() > 0.1 else 0.0


def screen(frames: Sequence[Measures], turns: Sequence[float], limits: ScreenLimits) -> list[str | None]:
    """Why each frame is unusable, or None.

    Args:
      frames: in order. turns: share of the width that went out of sight before each.
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
