"""Observation of a frame, and the interface of perception models."""

import dataclasses
from typing import Protocol

import numpy as np

from ...datatypes import Detection


@dataclasses.dataclass(frozen=True)
class FrameObservation:
    """One frame of H x W pixels.

    Attributes:
      surfaces: (H, W) u8, see `Frame.surfaces`.
      masks: (H, W) i32 row of `detections`, -1 = none.
      detections: objects with their labels and scores.
      depth: (H, W) f32 m along the camera's axis, predicted from one image; None for models without depth.
    """

    surfaces: np.ndarray
    masks: np.ndarray
    detections: tuple[Detection, ...]
    depth: np.ndarray | None = None


class Predictor(Protocol):
    """Finds objects, surfaces and, if supported, depth in an image."""

    def __call__(self, rgb: np.ndarray, focal: float, /) -> FrameObservation:
        """(H, W, 3) u8 image of a pinhole with focal length `focal` (pixels)."""
        ...
