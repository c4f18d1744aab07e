"""Fits how far the boxes of a published detector are trusted: `fusion.FusionOptions.trust`.

    python -m benchmarks.second_opinion --clones DIR

Every box that the detector finds in the photographs for calibration (`benchmarks.photographs`, --part calibration) is
right, if a labelled object of its class has a box of IoU 0.5 or more that no surer box has, or wrong; boxes lower than
`photographs.MIN_HEIGHT` that match nothing are not judged. A logistic regression predicts the probability from the
box's features (`fusion.evidence`). The coefficients belong to the detector's and the perception model's weights.

Prints one JSON line: the coefficients, the number of boxes and of right ones, and how many are right in five equal
intervals of the probability, on the photographs for calibration and on those of the tables.
"""

import argparse
import json
import pathlib
import sys
from typing import Any

import numpy as np
from scipy.special import expit

from benchmarks import photographs
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.distillation.fit_trust import fit
from urbanverse_mjx.distillation.perception.published import fusion, groups
from urbanverse_mjx.distillation.perception.published.opinion import DETECTORS, Detects
from urbanverse_mjx.distillation.perception_model import classes
from urbanverse_mjx.distillation.perception_model.inference import PerceptionModel


def judged(
    found: list[fusion.Candidate], box: np.ndarray, labelled: list[tuple[str, np.ndarray]]
) -> list[tuple[tuple[float, ...], bool]]:
    """The features of each box that is judged, and whether it is right.

    Args:
      found: the surest first.
      box: (k, 4) of them in the photograph's pixels.
      labelled: classes and boxes (4,) of the labels.
    """
    names = {group: name for name, members in photographs.GROUPS.items() for group in members}
    free = set(range(len(labelled)))
    out = []
    for one, corners in zip(found, box, strict=True):
        name = names[classes.names()[one.kind]]
        same = [k for k in free if labelled[k][0] == name]
        best = max(same, key=lambda k: photographs.iou(labelled[k][1], corners), default=None)
        right = best is not None and photographs.iou(labelled[best][1], corners) >= photographs.MIN_IOU
        if right:
            free.discard(best)
        if right or corners[3] - corners[1] >= photographs.MIN_HEIGHT:
            out.append((one.evidence, right))
    return out


def evidence(
    model: PerceptionModel, detector: Detects, clones: pathlib.Path, part: str
) -> tuple[np.ndarray, np.ndarray]:
    """(n, k) features of all judged boxes of a part of the photographs, and (n,) bool whether they are right."""
    body = v.read_json(photographs.LABELS, "labels of photographs")
    rows: list[tuple[tuple[float, ...], bool]] = []
    for entry in photographs.part_of(body["photographs"], part):
        raw = photographs.read_file(clones, entry["repository"], entry["commit"], entry["path"])
        image = photographs.photograph(raw, body["width"])
        seen = model.decoded(image, 0.8 * body["width"])
        found = fusion.candidates(seen, groups.to_groups(detector(image)), image.shape[:2])
        scale = np.array([image.shape[1] / seen.masks.shape[1], image.shape[0] / seen.masks.shape[0]] * 2)
        box = np.array([one.box for one in found]).reshape(-1, 4) * scale
        rows += judged(found, box, [(name, np.array(corners, float)) for name, *corners in entry["boxes"]])
    if not rows:
        raise ValidationError("photographs: found no boxes, needed some; check --clones.")
    features, right = zip(*rows, strict=True)
    return np.array(features), np.array(right)


def reliability(probability: np.ndarray, right: np.ndarray) -> list[dict[str, Any]]:
    """Number of boxes, mean probability and share of right ones in five intervals of the probability."""
    interval = np.minimum((probability * 5).astype(int), 4)
    return [
        {
            "boxes": int((interval == k).sum()),
            "probability": round(float(probability[interval == k].mean()), 2),
            "right": round(float(right[interval == k].mean()), 2),
        }
        for k in range(5)
        if (interval == k).any()
    ]


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.second_opinion", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--clones", type=pathlib.Path, required=True, help="folder of the repositories' clones")
    parser.add_argument("--detector", choices=sorted(DETECTORS), default="nanodet")
    arguments = parser.parse_args(argv)
    try:
        model, detector = PerceptionModel.load(), DETECTORS[arguments.detector]()
        parts = {p: evidence(model, detector, arguments.clones, p) for p in ("calibration", "report")}
    except ValidationError as error:
        sys.stderr.write(f"error: {error}\n")
        return 2
    trust = [round(float(x), 2) for x in fit(*parts["calibration"])]
    table: dict[str, Any] = {"trust": trust}
    for name, (features, right) in parts.items():
        bins = reliability(expit(features @ trust), right)
        table[name] = {"boxes": len(right), "right": int(right.sum()), "reliability": bins}
    sys.stdout.write(json.dumps(table) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
