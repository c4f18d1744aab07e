"""Compares the detectors of `--blur` on faces in photographs of streets.

    python -m benchmarks.face_blur --clones DIR
    python -m benchmarks.face_blur --clones DIR --detectors haar

The photographs are those of `benchmarks.photographs` in which faces are labelled: of people and cyclists higher than 90
of 1000 pixels, every face from the front or the side that is neither blurred already nor too dark to be seen. A face is
covered if boxes with the margin of `Blur` cover three quarters of its label. A box whose centre is in no labelled
person is false; people lower than 40 pixels are not labelled, so this is an upper bound. Photographs are 1000 pixels
wide; intervals are 95 % bootstrap intervals over photographs. Prints one JSON line.
"""

import argparse
import json
import pathlib
import sys
from typing import Any

import numpy as np

from benchmarks import photographs
from benchmarks.lib.resampling import with_interval
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.distillation.perception.privacy import Blur, blur_by_name

#: Least share of a face that is covered.
COVERED = 0.75
#: Widths of faces (pixels) that are told apart.
WIDTHS = (8.0, 16.0)


def share_covered(face: np.ndarray, boxes: np.ndarray) -> float:
    """Share of a box (4,) that the union of boxes (k, 4) covers, on a grid of 40 x 40 points."""
    x, y = ((np.arange(40) + 0.5) / 40 * (face[k + 2] - face[k]) + face[k] for k in (0, 1))
    inside = (x[None, None] >= boxes[:, 0, None, None]) & (x[None, None] <= boxes[:, 2, None, None])
    below = (y[None, :, None] >= boxes[:, 1, None, None]) & (y[None, :, None] <= boxes[:, 3, None, None])
    return float((inside & below).any(0).mean())


def false_boxes(boxes: np.ndarray, people: np.ndarray) -> int:
    """Number of boxes (k, 4) whose centre is in no person (n, 4)."""
    centre = (boxes[:, None, :2] + boxes[:, None, 2:]) / 2.0
    return int((~((centre >= people[None, :, :2]) & (centre <= people[None, :, 2:])).all(-1).any(-1)).sum())


def score_detector(blur: Blur, clones: pathlib.Path) -> dict[str, Any]:
    """Shares of covered faces, by width, and the number of false boxes."""
    body = v.read_json(photographs.LABELS, "labels of photographs")
    entries = [e for e in body["photographs"] if "faces" in e]
    there, found = np.zeros((2, len(entries), len(WIDTHS) + 1), int)
    false = 0
    for k, entry in enumerate(entries):
        raw = photographs.read_file(clones, entry["repository"], entry["commit"], entry["path"])
        boxes = np.asarray(blur.detector(photographs.photograph(raw, body["width"])), np.float64).reshape(-1, 4)
        people = np.array([b for name, *b in entry["boxes"] if name in ("person", "cyclist")], np.float64)
        false += false_boxes(boxes, people)
        grown = boxes + blur.margin * (boxes[:, 2:] - boxes[:, :2])[:, [0, 1, 0, 1]] * np.array([-1, -1, 1, 1])
        for face in np.array(entry["faces"], np.float64):
            size = int(np.searchsorted(WIDTHS, face[2] - face[0], side="right"))
            there[k, size] += 1
            found[k, size] += share_covered(face, grown) >= COVERED
    names = (f"below {WIDTHS[0]:.0f}", f"{WIDTHS[0]:.0f} to {WIDTHS[1]:.0f}", f"{WIDTHS[1]:.0f} and more")
    widths = {
        name: {"faces": int(there[:, j].sum()), "covered": with_interval(found[:, j], there[:, j])}
        for j, name in enumerate(names)
    }
    everything = {"faces": int(there.sum()), "covered": with_interval(found.sum(1), there.sum(1))}
    return {"photographs": len(entries), "false": false, "all": everything, "widths": widths}


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.face_blur", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--clones", type=pathlib.Path, required=True, help="folder of the repositories' clones")
    parser.add_argument("--detectors", nargs="+", default=["haar", "centerface"])
    arguments = parser.parse_args(argv)
    try:
        table = {name: score_detector(blur_by_name(name), arguments.clones) for name in arguments.detectors}
    except ValidationError as error:
        sys.stderr.write(f"error: {error}\n")
        return 2
    sys.stdout.write(json.dumps(table) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
