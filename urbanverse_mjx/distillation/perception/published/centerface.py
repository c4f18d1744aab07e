"""Detects faces by CenterFace (Xu et al., 2019), for `--blur centerface`: published weights, see `weights`.

A map of a quarter of the image's size gives, for each cell, the probability that a face's centre is in it, the
logarithm of the face's height and width in cells, and the centre's offset.
"""

import dataclasses
from typing import Any

import numpy as np
from PIL import Image

from ..foundation.boxes import Boxes, rows_kept
from . import weights

_CELL, _STRIDE = 4, 32


@dataclasses.dataclass(frozen=True)
class CenterFace:
    """`FindsPrivate` implemented by CenterFace; it finds no number plates.

    Attributes:
      session: of ONNX Runtime; input (1, 3, h, w), outputs of (1, c, h / 4, w / 4): heat, size and offset first.
      least: smallest probability. False detections only blur a few pixels, so that it is low.
      overlap: boxes that overlap by more are one face.
      longer: largest longer side of the searched image, pixels.
    """

    session: Any
    least: float = 0.2
    overlap: float = 0.3
    longer: int = 1600

    def __call__(self, rgb: np.ndarray, /) -> np.ndarray:
        """(k, 4) left, top, right, bottom in pixels."""
        height, width = rgb.shape[:2]
        factor = min(1.0, self.longer / max(height, width))
        rows, columns = (max(_STRIDE, _STRIDE * round(n * factor / _STRIDE)) for n in (height, width))
        image = np.asarray(Image.fromarray(rgb).resize((columns, rows), Image.Resampling.BILINEAR), np.float32)
        given = self.session.get_inputs()[0].name
        heat, size, offset = self.session.run(None, {given: image.transpose(2, 0, 1)[None]})[:3]
        found = decode(heat[0, 0], size[0], offset[0], self.least)
        kept = found.take(rows_kept(found, self.overlap))
        scale = np.array([width / columns, height / rows] * 2)
        return np.clip(kept.box * scale, 0, [width, height, width, height])


def decode(heat: np.ndarray, size: np.ndarray, offset: np.ndarray, least: float) -> Boxes:
    """Faces in pixels of the input, from the maps (h, w), (2, h, w) and (2, h, w), rows before columns."""
    cell = np.argwhere(heat >= least)
    at = tuple(cell.T)
    centre = (cell + 0.5 + np.stack([m[at] for m in offset], 1)) * _CELL
    half = np.exp(np.stack([m[at] for m in size], 1).astype(np.float64)) * _CELL / 2.0
    corners = np.concatenate([(centre - half)[:, ::-1], (centre + half)[:, ::-1]], 1).reshape(-1, 4)
    return Boxes(corners, np.zeros(len(cell), int), heat[at].astype(np.float64))


def detector() -> CenterFace:
    """Returns the detector, for `blur_by_name`.

    Raises:
      ValidationError: the weights were not fetched.
    """
    return CenterFace(weights.session("centerface", "--blur centerface"))
