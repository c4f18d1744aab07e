"""Makes faces and plates unreadable before a frame is stored. This module sends no frames anywhere."""

import dataclasses
import importlib
from collections.abc import Callable
from typing import Protocol

import cv2
import numpy as np

from ...datatypes import ValidationError

#: Short names of detectors.
_SHORT = {"haar": f"{__package__}.haar:detector", "centerface": f"{__package__}.published.centerface:detector"}


class FindsPrivate(Protocol):
    """(H, W, 3) u8 RGB -> (k, 4) left, top, right, bottom in pixels of faces and plates."""

    def __call__(self, rgb: np.ndarray, /) -> np.ndarray: ...


@dataclasses.dataclass(frozen=True)
class Blur:
    """Makes the regions that a detector finds unreadable.

    Attributes:
      detector: function that finds faces and plates.
      name: name of the detector in the records.
      margin: share of a box's size added to each side, because detectors leave out ears and frames of plates.
    """

    detector: FindsPrivate
    name: str
    margin: float = 0.15

    def __call__(self, rgb: np.ndarray) -> np.ndarray:
        """A copy of an image (H, W, 3) u8 with the boxes filled by their own mean colours, four cells to a side.

        Raises:
          ValidationError: the detector did not return boxes.
        """
        boxes = np.asarray(self.detector(rgb), np.float64)
        if boxes.size == 0:
            return rgb.copy()
        if boxes.ndim != 2 or boxes.shape[1] != 4 or not np.isfinite(boxes).all():
            raise ValidationError(f"detector {self.name}: found boxes of shape {boxes.shape}, needed finite (k, 4).")
        out = rgb.copy()
        height, width = rgb.shape[:2]
        for left, top, right, bottom in boxes:
            dx, dy = self.margin * abs(right - left), self.margin * abs(bottom - top)
            x0, x1 = (int(np.clip(x, 0, width)) for x in (np.floor(left - dx), np.ceil(right + dx)))
            y0, y1 = (int(np.clip(y, 0, height)) for y in (np.floor(top - dy), np.ceil(bottom + dy)))
            if x1 > x0 and y1 > y0:
                out[y0:y1, x0:x1] = _coarse(rgb[y0:y1, x0:x1])
        return out


def _coarse(part: np.ndarray) -> np.ndarray:
    """An image of means over at most 4 x 4 cells. Unlike a blur, this cannot be undone by sharpening."""
    height, width = part.shape[:2]
    cells = cv2.resize(part, (min(4, width), min(4, height)), interpolation=cv2.INTER_AREA)
    return cv2.resize(cells, (width, height), interpolation=cv2.INTER_NEAREST)


def blur_by_name(name: str) -> Blur:
    """Makes a blur from "module:attribute", where the attribute is a function without arguments that returns a
    detector; "haar" stands for `haar.detector`, "centerface" for `published.centerface.detector`.

    Raises:
      ValidationError: no such module or attribute.
    """
    module, _, attribute = _SHORT.get(name, name).partition(":")
    try:
        make: Callable[[], FindsPrivate] = getattr(importlib.import_module(module), attribute)
    except (ImportError, AttributeError, ValueError) as error:
        raise ValidationError(
            f"detector: found {name!r} ({error}), needed 'module:function' of an installed package whose function "
            "returns a detector of faces and plates."
        ) from error
    return Blur(make(), name)
