"""Converts outputs of open-vocabulary detectors and box-prompted segmenters to labels, boxes and one mask image."""

import dataclasses
from collections.abc import Sequence

import numpy as np


@dataclasses.dataclass(frozen=True)
class Boxes:
    """k detected objects: box (k, 4) left, top, right, bottom in pixels; label (k,) row of the queries; score (k,)."""

    box: np.ndarray
    label: np.ndarray
    score: np.ndarray

    def take(self, rows: Sequence[int]) -> "Boxes":
        """Some of the objects, by row."""
        return Boxes(self.box[rows], self.label[rows], self.score[rows])


def decode_owl(logits: np.ndarray, boxes: np.ndarray, height: int, width: int, least: float) -> Boxes:
    """Decodes the output of OWLv2 (Minderer et al., NeurIPS 2023).

    Args:
      logits: (p, q) of every patch for every query.
      boxes: (p, 4) centre, width and height in shares of the square that the image was padded to at its right and
        bottom.
      height, width: of the image.
      least: smallest score.
    """
    score = 1.0 / (1.0 + np.exp(-logits.astype(np.float64)))
    label = score.argmax(1)
    best = score[np.arange(len(score)), label]
    cx, cy, w, h = boxes.astype(np.float64).T * max(height, width)
    corners = np.stack([cx - w / 2, cy - h / 2, cx + w / 2, cy + h / 2], 1)
    corners = np.clip(corners, 0, [width, height, width, height])
    keep = (best >= least) & (corners[:, 2] - corners[:, 0] >= 1) & (corners[:, 3] - corners[:, 1] >= 1)
    return Boxes(corners[keep], label[keep], best[keep])


def joined(parts: Sequence[Boxes], starts: Sequence[int]) -> Boxes:
    """Concatenates the detections of several lists of queries; `starts`: number of each list's first query."""
    return Boxes(
        np.concatenate([p.box for p in parts]),
        np.concatenate([p.label + s for p, s in zip(parts, starts, strict=True)]),
        np.concatenate([p.score for p in parts]),
    )


def suppressed(found: Boxes, most: float = 0.6) -> Boxes:
    """Keeps the box with the highest score of those that overlap by more than `most` (intersection over union),
    whatever their labels, because similar words find one object twice."""
    return found.take(rows_kept(found, most))


def rows_kept(found: Boxes, most: float = 0.6) -> list[int]:
    """The rows that `suppressed` keeps, highest score first."""
    order = np.argsort(-found.score, kind="stable")
    kept: list[int] = []
    for i in order:
        low = np.maximum(found.box[i, :2], found.box[kept, :2])
        high = np.minimum(found.box[i, 2:], found.box[kept, 2:])
        shared = np.prod(np.maximum(high - low, 0.0), axis=-1)
        joint = area_of(found.box[i]) + area_of(found.box[kept]) - shared
        if not (shared > most * joint).any():
            kept.append(int(i))
    return kept


def overlap(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(n, m) intersection over union of boxes (n, 4) and (m, 4)."""
    sides = np.minimum(a[:, None, 2:], b[None, :, 2:]) - np.maximum(a[:, None, :2], b[None, :, :2])
    shared = np.prod(np.maximum(sides, 0.0), -1)
    return shared / np.maximum(area_of(a)[:, None] + area_of(b)[None] - shared, 1e-9)


def area_of(box: np.ndarray) -> np.ndarray:
    """(...) areas of boxes (..., 4)."""
    return (box[..., 2] - box[..., 0]) * (box[..., 3] - box[..., 1])


def paint(masks: np.ndarray, score: np.ndarray, least_pixels: int = 24) -> tuple[np.ndarray, np.ndarray]:
    """Draws all masks into one image; small objects are drawn over large ones, since they are usually in front.

    Args:
      masks: (k, H, W) bool.
      score: (k,).

    Returns:
      (H, W) i32 row of the kept detection, -1 = none; and (n,) the numbers of the kept ones, highest score first.
    """
    area = masks.sum((1, 2))
    image = np.full(masks.shape[1:], -1, np.int32)
    for k in np.argsort(-area, kind="stable"):
        image[masks[k]] = k
    left = np.bincount(image[image >= 0], minlength=len(masks))
    kept = np.flatnonzero(left >= least_pixels)
    kept = kept[np.argsort(-score[kept], kind="stable")]
    row = np.full(len(masks) + 1, -1, np.int32)
    row[kept] = np.arange(len(kept))
    return row[image], kept
