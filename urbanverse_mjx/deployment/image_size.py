"""Cuts and scales a camera's image to what a policy was trained with.

In:   an image of any size, its vertical field of view. Out: (height, width, 3) u8. When: once per image.
"""

import math

import numpy as np
from PIL import Image

from ..datatypes import ValidationError

#: Share by which a camera's field of view may be smaller than the policy's.
_TOLERANCE = 0.02


def fit_image(pixels: np.ndarray, fovy: float, size: tuple[int, int], wanted_fovy: float) -> np.ndarray:
    """The centre of an image, as a camera with the policy's field of view and number of pixels would see it.

    Pixels are averaged over areas. An image that already has the field of view and size is returned as it is.

    Args:
      pixels: (H, W, 3) u8.
      fovy: rad, vertical field of view of a camera without distortion; 0: only the shape is adapted.
      size: (height, width) of the result.
      wanted_fovy: rad, vertical field of view of the result.

    Raises:
      ValidationError: the camera sees less than the policy needs.
    """
    rows, columns = pixels.shape[:2]
    height = float(rows)
    if fovy > 0.0:
        height = rows * math.tan(wanted_fovy / 2) / math.tan(fovy / 2)
    width = height * size[1] / size[0]
    if fovy == 0.0 and width > columns:
        height, width = columns * size[0] / size[1], float(columns)
    if height > rows * (1 + _TOLERANCE) or width > columns * (1 + _TOLERANCE):
        needed = 2 * math.atan(math.tan(fovy / 2) * columns / rows)
        raise ValidationError(
            f"image: found a camera that sees {fovy:.3f} rad up and down and {needed:.3f} rad across, needed "
            f"{wanted_fovy:.3f} and {2 * math.atan(math.tan(wanted_fovy / 2) * size[1] / size[0]):.3f} rad; "
            "take a wider lens, or set its field of view right."
        )
    height, width = min(height, rows), min(width, columns)
    left, top = (columns - width) / 2, (rows - height) / 2
    if (rows, columns) == size and (height, width) == size:
        return pixels
    box = (left, top, left + width, top + height)
    return np.asarray(Image.fromarray(pixels).resize((size[1], size[0]), Image.Resampling.BOX, box))
