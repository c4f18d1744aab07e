"""Finds the part of the vehicle that carries the camera (bonnet, handlebar, dashboard) in its frames.

It stays where it is while the street moves past, and it has an edge. A smooth road in front of the vehicle hardly
changes either, but blends into the rest of the road.
"""

import dataclasses

import cv2
import numpy as np
from scipy import ndimage

from .frames import Frames


@dataclasses.dataclass(frozen=True)
class OwnVehicleOptions:
    """What counts as a part of the own vehicle; chosen manually on synthetic frames.

    Attributes:
      frames: number of frames, evenly spaced, that are compared.
      rows: pixels, height at which they are compared.
      min_motion: grey levels, least change of the upper half; without it nothing can be told.
      still: largest change, in grey levels and as a share of that of the upper half.
      min_area: least share of the image.
      min_width: least share of the lower border.
      edge: grey levels, least difference across the upper border of the part, in at least `edge_share` of its columns.
      margin: pixels by which the part is widened.
    """

    frames: int = 24
    rows: int = 180
    min_motion: float = 6.0
    still: tuple[float, float] = (5.0, 0.35)
    min_area: float = 0.02
    min_width: float = 0.3
    edge: float = 12.0
    edge_share: float = 0.6
    margin: int = 2


_OPTIONS = OwnVehicleOptions()


def own_vehicle(frames: Frames) -> np.ndarray | None:
    """(H, W) bool, the pixels that show the own vehicle in every frame; None if there are none, or the frames are too
    few or too alike to tell."""
    chosen = np.unique(np.linspace(0, len(frames) - 1, min(_OPTIONS.frames, len(frames))).round().astype(int))
    if len(chosen) < 5:
        return None
    columns = round(frames.width * _OPTIONS.rows / frames.height)
    images = np.array([_grey(frames.rgb(int(number)), columns) for number in chosen])
    usual = np.median(images, axis=0)
    change = np.median(np.abs(images - usual), axis=0)
    moving = float(np.quantile(change[: _OPTIONS.rows // 2], 0.75))
    if moving < _OPTIONS.min_motion:
        return None
    still = change < min(_OPTIONS.still[0], _OPTIONS.still[1] * moving)
    still[: _OPTIONS.rows // 2] = False
    still = ndimage.binary_opening(ndimage.binary_closing(np.pad(still, 4, "edge"), iterations=3), iterations=3)
    still = still[4:-4, 4:-4]
    parts, _ = ndimage.label(still)
    at_bottom = np.unique(parts[-1][parts[-1] > 0])
    part = ndimage.binary_fill_holes(np.isin(parts, at_bottom))
    assert part is not None
    if part.mean() < _OPTIONS.min_area or part[-1].mean() < _OPTIONS.min_width or not _has_edge(part, usual):
        return None
    grown = ndimage.binary_dilation(part, iterations=_OPTIONS.margin)
    size = frames.width, frames.height
    return cv2.resize(grown.astype(np.uint8), size, interpolation=cv2.INTER_NEAREST).astype(bool)


def _grey(rgb: np.ndarray, columns: int) -> np.ndarray:
    grey = cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY)
    return cv2.resize(grey, (columns, _OPTIONS.rows), interpolation=cv2.INTER_AREA).astype(np.float32)


def _has_edge(part: np.ndarray, usual: np.ndarray) -> bool:
    """Whether the median image (h, w) has an edge along most of the upper border of a part (h, w)."""
    columns = np.flatnonzero(part.any(0))
    top = part[:, columns].argmax(0)
    near = [np.clip(top + shift, 0, len(part) - 1) for shift in range(-5, 6)]
    levels = np.stack([usual[rows, columns] for rows in near])
    return bool((np.ptp(levels, axis=0) >= _OPTIONS.edge).mean() >= _OPTIONS.edge_share)
