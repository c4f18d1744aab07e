"""Accuracy of the perception model: recall and precision of objects by class, overlap of surfaces, error of depth."""

import dataclasses
from typing import Any

import numpy as np

from . import classes
from .decode import Decoded

#: Intersection over union from which a mask counts as found (the threshold of panoptic quality, Kirillov et al. 2019).
MIN_IOU = 0.5
#: Objects smaller than this, in output pixels, count neither as missed nor as false.
MIN_PIXELS = 100


@dataclasses.dataclass
class Score:
    """Counts over frames, by class: found, missed and false objects; pixels of surfaces; and, of the found objects of
    classes with leaves, the number with the right leaf and the total."""

    found: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros(len(classes.names()), np.int64))
    missed: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros(len(classes.names()), np.int64))
    invented: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros(len(classes.names()), np.int64))
    both: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros(len(classes.names()), np.int64))
    either: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros(len(classes.names()), np.int64))
    right_leaves: int = 0
    with_leaf: int = 0
    depth_errors: list[float] = dataclasses.field(default_factory=list)

    def add(self, seen: Decoded, kinds: np.ndarray, owner: np.ndarray, depth: np.ndarray, leaves: np.ndarray) -> None:
        """Adds the counts of one frame.

        Args:
          kinds: (h, w) true classes.
          owner: (h, w) which object a pixel belongs to, -1 = none.
          depth: (h, w) true m, 0 where unknown.
          leaves: (h, w) true leaf's number, -1 = none.
        """
        for kind in range(classes.FIRST_OBJECT):
            a, b = seen.kinds == kind, kinds == kind
            self.both[kind] += (a & b).sum()
            self.either[kind] += (a | b).sum()
        self._add_objects(seen, kinds, owner, leaves)
        known = depth > 0
        if known.any():
            self.depth_errors.append(float(np.median(np.abs(seen.depth[known] - depth[known]) / depth[known])))

    def _add_objects(self, seen: Decoded, kinds: np.ndarray, owner: np.ndarray, leaves: np.ndarray) -> None:
        true, inverse, sizes = np.unique(owner, return_inverse=True, return_counts=True)
        inverse = inverse.reshape(owner.shape)
        kind_of = np.zeros(len(true), np.int64)
        leaf_of = kind_of.copy()
        kind_of[inverse], leaf_of[inverse] = kinds, leaves
        counts = np.zeros((len(true), len(seen.objects)), np.int64)
        inside = seen.masks >= 0
        np.add.at(counts, (inverse[inside], seen.masks[inside]), 1)
        areas = np.bincount(seen.masks[inside], minlength=len(seen.objects))
        iou = counts / np.maximum(sizes[:, None] + areas[None] - counts, 1)
        asked = (true >= 0) & (sizes >= MIN_PIXELS) & (kind_of > classes.FIRST_OBJECT)
        predicted = np.array([t.kind for t in seen.objects], np.int64)
        hit = (iou > MIN_IOU) & (kind_of[:, None] == predicted[None])
        for row in np.flatnonzero(asked):
            (self.found if hit[row].any() else self.missed)[kind_of[row]] += 1
            if hit[row].any() and leaf_of[row] >= 0:
                self.with_leaf += 1
                self.right_leaves += seen.objects[int(hit[row].argmax())].leaf == leaf_of[row]
        # Detections that mostly cover objects that are too small or belong to no group do not count as false.
        excused = (counts[(true >= 0) & ~asked].sum(0) > 0.5 * areas) | (areas < MIN_PIXELS)
        for column in np.flatnonzero(~hit[asked].any(0) & ~excused):
            self.invented[predicted[column]] += 1

    def table(self) -> dict[str, Any]:
        """Recall, precision and number of objects by class, share of right leaves among the found objects, overlap by
        surface, median relative depth error."""
        rows = {}
        for kind in range(classes.FIRST_OBJECT + 1, len(classes.names())):
            rows[classes.names()[kind]] = _row(self.found[kind], self.missed[kind], self.invented[kind])
        surfaces = {
            name: round(float(self.both[k] / self.either[k]), 3)
            for k, name in enumerate(classes.names()[: classes.FIRST_OBJECT])
            if self.either[k]
        }
        depth = round(float(np.median(self.depth_errors)), 4) if self.depth_errors else None
        all_objects = _row(self.found.sum(), self.missed.sum(), self.invented.sum())
        leaf = round(self.right_leaves / self.with_leaf, 3) if self.with_leaf else None
        return {"objects": rows, "all": all_objects, "leaf": leaf, "surface_iou": surfaces, "depth_error": depth}


def _row(found: int, missed: int, invented: int) -> dict[str, Any]:
    there, said = int(found + missed), int(found + invented)
    return {
        "there": there,
        "recall": round(int(found) / there, 3) if there else None,
        "precision": round(int(found) / said, 3) if said else None,
    }


def as_markdown(table: dict[str, Any]) -> str:
    """Formats the table as Markdown."""
    lines = ["| class | there | recall | precision |", "| --- | --- | --- | --- |"]
    for name, row in {**table["objects"], "all": table["all"]}.items():
        lines.append(f"| {name} | {row['there']} | {_show(row['recall'])} | {_show(row['precision'])} |")
    surfaces = ", ".join(f"{name} {iou:.2f}" for name, iou in table["surface_iou"].items())
    return "\n".join(
        [
            *lines,
            "",
            f"Right leaf, of the found objects: {_show(table['leaf'])}.",
            f"Surfaces, IoU: {surfaces}.",
            f"Depth, median error: {_show(table['depth_error'])}.",
        ]
    )


def _show(x: float | None) -> str:
    return "-" if x is None else f"{x:.2f}"
