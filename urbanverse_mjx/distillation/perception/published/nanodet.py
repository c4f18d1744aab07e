"""The NanoDet detector (RangiLyu, 2021): boxes of COCO's 80 classes, from the whole image and from tiles of it.

Every cell of three maps gives a score for each class and, as in Generalized Focal Loss (Li et al., NeurIPS 2020), a
distribution over the distances to the four sides of the box, whose mean is taken.
"""

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np
from PIL import Image

from ....datatypes import validation as v
from ..foundation.boxes import Boxes, joined, rows_kept
from . import weights

#: The network's normalisation of blue, green and red (configuration `nanodet-g` of its authors).
_MEAN, _DEVIATION = np.array([103.53, 116.28, 123.675]), np.array([57.375, 57.12, 58.395])


@dataclasses.dataclass(frozen=True)
class NanoDetOptions:
    """Options of the detector.

    Attributes:
      least: smallest score.
      overlap: boxes of one class that overlap by more (intersection over union) are one object; that of the authors.
      tile: side of a tile as share of the image's longer side; 1 for the whole image alone. Chosen on the photographs
        for calibration (docs/decisions/gen_perception.md).
      shared: least share of a tile that its neighbour covers too.
      cut_off: share of a tile's side; boxes nearer to a side inside the image are cut off and not used.
    """

    least: float = 0.15
    overlap: float = 0.6
    tile: float = 0.4
    shared: float = 0.25
    cut_off: float = 0.02


_OPTIONS = NanoDetOptions()


@dataclasses.dataclass(frozen=True)
class NanoDet:
    """Finds objects of COCO's classes.

    Attributes:
      session: of ONNX Runtime; input (1, 3, s, s), outputs (1, n, classes) and (1, n, 4 bins) of each map.
    """

    session: Any
    options: NanoDetOptions = _OPTIONS

    @staticmethod
    def load(where: str = "--second-opinion nanodet") -> "NanoDet":
        """Loads the weights from the cache.

        Raises:
          ValidationError: they were not fetched.
        """
        return NanoDet(weights.session("nanodet", where))

    def __call__(self, rgb: np.ndarray) -> Boxes:
        """Objects of an image (H, W, 3) u8, with the numbers of their classes in COCO's order (0 = person)."""
        parts = []
        for left, top, side in tiles(rgb.shape[0], rgb.shape[1], self.options):
            crop = rgb[top : top + side, left : left + side]
            found = self._boxes(crop)
            parts.append(_inside(found, (left, top), crop.shape[:2], rgb.shape[:2], self.options.cut_off))
        return by_class(joined(parts, [0] * len(parts)), self.options.overlap)

    def _boxes(self, rgb: np.ndarray) -> Boxes:
        given = self.session.get_inputs()[0]
        image, factor = letterbox(rgb, int(given.shape[2]))
        bgr = (image[..., ::-1] - _MEAN) / _DEVIATION
        outputs = self.session.run(None, {given.name: bgr.transpose(2, 0, 1)[None].astype(np.float32)})
        found = decode(outputs, int(given.shape[2]), self.options.least)
        corners = np.clip(found.box / factor, 0, np.tile(rgb.shape[1::-1], 2))
        whole = (corners[:, 2:] - corners[:, :2] >= 1).all(1)
        return dataclasses.replace(found, box=corners).take(np.flatnonzero(whole).tolist())


def letterbox(rgb: np.ndarray, side: int) -> tuple[np.ndarray, float]:
    """An image (side, side, 3) u8 with `rgb` scaled to its upper left, black elsewhere, and the scale."""
    height, width = rgb.shape[:2]
    factor = side / max(height, width)
    rows, columns = max(1, round(height * factor)), max(1, round(width * factor))
    out = np.zeros((side, side, 3), np.uint8)
    out[:rows, :columns] = np.asarray(Image.fromarray(rgb).resize((columns, rows), Image.Resampling.BILINEAR))
    return out, factor


def decode(outputs: Sequence[np.ndarray], side: int, least: float) -> Boxes:
    """Decodes the outputs for one image.

    Args:
      outputs: scores (1, n, classes) of each map, and as many distributions (1, n, 4 * bins), for n = k * k cells.
      side: of the input, pixels.
      least: smallest score.

    Raises:
      ValidationError: the outputs are not those of a NanoDet.
    """
    half = len(outputs) // 2
    scores = sorted((x[0] for x in outputs[:half]), key=len)
    distances = sorted((x[0] for x in outputs[half:]), key=len)
    if [len(x) for x in scores] != [len(x) for x in distances] or any(
        round(len(x) ** 0.5) ** 2 != len(x) for x in scores
    ):
        raise v.fail("detector", f"outputs {[x.shape for x in outputs]}", "scores and distances of square maps", "")
    parts = []
    for score, distance in zip(scores, distances, strict=True):
        cells = round(len(score) ** 0.5)
        stride = side / cells
        row, column = np.divmod(np.arange(len(score)), cells)
        centre = np.stack([column + 0.5, row + 0.5], 1) * stride
        p = distance.reshape(len(score), 4, -1).astype(np.float64)
        p = np.exp(p - p.max(-1, keepdims=True))
        reach = (p @ np.arange(p.shape[-1])) / p.sum(-1) * stride
        corners = np.concatenate([centre - reach[:, :2], centre + reach[:, 2:]], 1)
        cell, label = np.nonzero(score >= least)
        parts.append(Boxes(corners[cell], label, score[cell, label].astype(np.float64)))
    return joined(parts, [0] * len(parts))


def tiles(height: int, width: int, options: NanoDetOptions = _OPTIONS) -> list[tuple[int, int, int]]:
    """(left, top, side) of the squares that are searched, pixels: one around the whole image, then the tiles."""
    longer = max(height, width)
    out = [(0, 0, longer)]
    side = round(options.tile * longer)
    if side < longer:
        tops, lefts = (_starts(length, side, options.shared) for length in (height, width))
        out += [(left, top, side) for top in tops for left in lefts]
    return out


def _starts(length: int, side: int, shared: float) -> list[int]:
    """Where tiles begin along a side, evenly spread."""
    if length <= side:
        return [0]
    count = int(np.ceil((length - side) / ((1.0 - shared) * side))) + 1
    return np.round(np.linspace(0, length - side, count)).astype(int).tolist()


def _inside(
    found: Boxes, start: tuple[int, int], size: tuple[int, ...], image: tuple[int, ...], cut_off: float
) -> Boxes:
    """Boxes of a tile in the image's pixels, without those that the tile's sides cut off."""
    height, width = size
    margin = cut_off * max(size)
    left, top = start
    box = found.box
    keep = np.ones(len(box), bool)
    keep &= (box[:, 0] > margin) | (left == 0)
    keep &= (box[:, 1] > margin) | (top == 0)
    keep &= (box[:, 2] < width - margin) | (left + width >= image[1])
    keep &= (box[:, 3] < height - margin) | (top + height >= image[0])
    moved = dataclasses.replace(found, box=box + np.array([left, top, left, top]))
    return moved.take(np.flatnonzero(keep).tolist())


def by_class(found: Boxes, overlap: float) -> Boxes:
    """Keeps the surest of the boxes of one class that overlap, in a fixed order, whatever the order of `found`."""
    order = np.lexsort((*found.box.T, found.label, -found.score))
    found = found.take(order.tolist())
    kept: list[int] = []
    for label in np.unique(found.label):
        rows = np.flatnonzero(found.label == label)
        kept += rows[rows_kept(found.take(rows.tolist()), overlap)].tolist()
    return found.take(sorted(kept))
