"""Detects faces and number plates by the Haar cascades that ship with OpenCV 4 (Viola and Jones 2001).

The cascades find frontal faces, profiles and single-line plates of at least about 24 pixels; neural detectors miss
fewer. OpenCV 5 does not ship the cascades.
"""

import pathlib
from typing import Any

import cv2
import numpy as np

from ...datatypes import ValidationError

_CASCADES = (
    "haarcascade_frontalface_default.xml",
    "haarcascade_profileface.xml",
    "haarcascade_russian_plate_number.xml",
)
#: Scale factor between pyramid levels, and number of neighbouring detections that must agree. The settings favour
#: recall, because a false detection only blurs a signboard.
_SCALE_STEP, _MIN_NEIGHBOURS = 1.1, 3


def detector() -> "HaarDetector":
    """Returns the detector, for `blur_by_name`.

    Raises:
      ValidationError: the installed OpenCV has no cascades.
    """
    folder = pathlib.Path(cv2.__file__).parent / "data"
    missing = [name for name in _CASCADES if not (folder / name).is_file()]
    if missing:
        raise ValidationError(
            f"--blur haar: found OpenCV {cv2.__version__} without {missing[0]}, needed version 4, which brings it; "
            '`pip install "opencv-python-headless<5"`.'
        )
    return HaarDetector([cv2.CascadeClassifier(str(folder / name)) for name in _CASCADES])


class HaarDetector:
    """`FindsPrivate` implemented by Haar cascades."""

    def __init__(self, cascades: list[Any]) -> None:
        self._cascades = cascades

    def __call__(self, rgb: np.ndarray, /) -> np.ndarray:
        """(k, 4) left, top, right, bottom; profiles of both sides."""
        grey = cv2.equalizeHist(cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY))
        found = [np.zeros((0, 4))]
        for number, cascade in enumerate(self._cascades):
            found.append(self._boxes(cascade, grey))
            if number == 1:
                left, top, right, bottom = self._boxes(cascade, np.ascontiguousarray(grey[:, ::-1])).T
                width = grey.shape[1]
                found.append(np.stack([width - right, top, width - left, bottom], 1))
        return np.concatenate(found)

    def _boxes(self, cascade: Any, grey: np.ndarray) -> np.ndarray:
        boxes = np.array(
            cascade.detectMultiScale(grey, scaleFactor=_SCALE_STEP, minNeighbors=_MIN_NEIGHBOURS), np.float64
        )
        boxes = boxes.reshape(-1, 4)
        return np.concatenate([boxes[:, :2], boxes[:, :2] + boxes[:, 2:]], 1)
