"""Fits what names objects (`distillation.perception_model.naming`), for one set of weights of the perception model.

    python -m benchmarks.bank --layouts 12 --objects 200-300 --hulls 1-2 --seed 11 --out bank11.npz
    python -m benchmarks.fidelity --banks bank11.npz --scenes 12 --rgb 12 --rgb-frames 180 --captures CAPTURES \
        --perceived PERCEIVED
    python -m benchmarks.object_names --captures CAPTURES --perceived PERCEIVED/true_poses --out naming.npz

Every folder PERCEIVED/<scene>/recording is distilled, without names; an object is what most pixels of its views show in
CAPTURES/<scene>_rgb, with the leaf of that, or of its group where the perception model does not know the leaf. Use
streets other than those of reported tables. A fifth of the streets is held out at a time for the printed scores (one
JSON line): the share of right leaves by the mean belief and by the regression, and how often names of each probability
are right. --regularisation and --balance are to be chosen by these scores.
"""

import argparse
import collections
import json
import pathlib
import sys
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import scipy.optimize
from scipy.special import log_softmax

from urbanverse_mjx.assets.records.index import load_index
from urbanverse_mjx.assets.selection.label_priors import LabelPriors
from urbanverse_mjx.datatypes import Recording, ValidationError
from urbanverse_mjx.distillation.distil import fuse
from urbanverse_mjx.distillation.objects import Fused, height, mean_belief, views_of_objects
from urbanverse_mjx.distillation.perception_model import classes, naming

#: Pixels of a view that count at most, so that one near view does not decide alone; and the share of an object's pixels
#: that have to show the same object.
_MOST_PIXELS, _LEAST_SHARE = 2000, 0.5
#: Parts of the streets that are held out in turn.
_FOLDS = 5
_ITERATIONS = 150
_BOUNDS = (0.0, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0)


class Examples(NamedTuple):
    """n objects: belief (n, L), height (n,) m, true leaf (n,), and number of their street (n,)."""

    belief: np.ndarray
    height: np.ndarray
    leaf: np.ndarray
    street: np.ndarray


def examples(perceived: Recording, capture: Recording, priors: LabelPriors, street: int) -> Examples:
    """The objects of one street that the perception model knows.

    Args:
      perceived: with the model's beliefs.
      capture: the same frames with true masks and labels.
    """
    fused, _ = fuse(perceived, priors)
    if fused.leaves is None or not any(d.beliefs for f in perceived.frames for d in f.detections):
        raise ValidationError(
            f"recording {perceived.id!r}: found no beliefs of the perception model, needed them; perceive it again."
        )
    shown = _shown(perceived, capture)
    rows = []
    for group in views_of_objects(fused.object_of_view):
        leaf = _true_leaf(fused, group, shown)
        if leaf >= 0:
            belief = np.zeros(len(classes.leaves()))
            belief[fused.leaves] = mean_belief(fused, group)
            rows.append((belief, height(fused, group), leaf))
    belief, up, leaf = zip(*rows, strict=True)
    return Examples(np.array(belief), np.array(up), np.array(leaf), np.full(len(rows), street))


def _shown(perceived: Recording, capture: Recording) -> dict[tuple[int, int], tuple[str, str, float]]:
    """(frame, detection) -> track, label and share of the pixels of what most pixels of its mask show."""
    out = {}
    for number in map(int, perceived.registered):
        masks, true = perceived.masks(number), capture.masks(number)
        if masks is None or true is None:
            continue
        objects = capture.frames[number].detections
        counts = np.zeros((len(perceived.frames[number].detections), len(objects) + 1), int)
        np.add.at(counts, (masks[masks >= 0], true[masks >= 0]), 1)
        for row, count in enumerate(counts):
            best = int(count.argmax())
            if count.any() and best < len(objects):
                track = objects[best].track or ""
                out[number, row] = track, objects[best].label, count[best] / count.sum()
    return out


def _true_leaf(fused: Fused, rows: np.ndarray, shown: dict[tuple[int, int], tuple[str, str, float]]) -> int:
    """Number of the leaf that an object shows, -1 for none."""
    weight: collections.Counter[tuple[str, str]] = collections.Counter()
    pixels = np.minimum(fused.views.pixels[rows], _MOST_PIXELS)
    for (frame, row), count in zip(fused.views.origin[rows].tolist(), pixels.tolist(), strict=True):
        if (frame, row) in shown:
            track, label, share = shown[frame, row]
            weight[track, label] += share * count
    if not weight:
        return -1
    (_, label), most = weight.most_common(1)[0]
    kind = classes.class_of_leaf(label)
    if most < _LEAST_SHARE * pixels.sum() or kind <= classes.FIRST_OBJECT:
        return -1
    leaves = classes.leaves()
    return leaves.index(label if label in leaves else classes.names()[kind])


def fit(data: Examples, regularisation: float, balance: float) -> naming.Naming:
    """The regression that makes the weighted likelihood of the true leaves largest.

    Args:
      regularisation: weight of the squared coefficients of standardised heights and of the other features.
      balance: objects weigh 1 / (number of their leaf)^balance, so that a street's frequencies do not decide.
    """
    x = naming.features(data.belief, data.height)
    # The heights are standardised, and their mean is left out: no leaf is likelier as such.
    count = x.shape[1]
    middle, spread = x[:, -2:].mean(0), 3.0 * x[:, -2:].std(0) + 1e-9
    a = np.concatenate([x[:, :-3], (x[:, -2:] - middle) / spread], axis=1)
    used = np.delete(naming.used(), count - 3, axis=0)
    own = np.log(data.belief + naming.OWN_FLOOR)
    weight = 1.0 / np.bincount(data.leaf, minlength=used.shape[1])[data.leaf] ** balance
    weight /= weight.sum()
    rows = np.arange(len(a))

    def loss(flat: np.ndarray) -> tuple[float, np.ndarray]:
        w, sharpness = flat[:-1].reshape(used.shape) * used, np.exp(flat[-1])
        logs = log_softmax(sharpness * own + a @ w, axis=1)
        value = -(weight * logs[rows, data.leaf]).sum() + regularisation * (w**2).sum()
        slope = np.exp(logs)
        slope[rows, data.leaf] -= 1.0
        slope *= weight[:, None]
        return value, np.append((a.T @ slope + 2.0 * regularisation * w) * used, sharpness * (slope * own).sum())

    start = np.zeros(used.size + 1)
    best = scipy.optimize.minimize(loss, start, jac=True, method="L-BFGS-B", options={"maxiter": _ITERATIONS}).x
    w = best[:-1].reshape(used.shape) * used
    heights = w[-2:] / spread[:, None]
    weights = np.concatenate([w[:-2], -(middle @ heights)[None], heights])
    return naming.Naming(float(np.exp(best[-1])), weights)


def scores(data: Examples, regularisation: float, balance: float) -> dict[str, Any]:
    """Shares of right leaves among objects of streets that are held out, by the mean belief and by the regression; of
    houses and of the others; and for each range of probability the objects and the share of right names.

    Raises:
      ValidationError: there is only one street, so that none can be held out.
    """
    p = np.zeros(data.belief.shape)
    _, number = np.unique(data.street, return_inverse=True)
    if number.max() == 0:
        raise ValidationError("recordings: found those of one street, needed two or more, to hold one out.")
    for fold in range(_FOLDS):
        out = number % _FOLDS == fold
        if out.any() and not out.all():
            fitted = fit(Examples(*(x[~out] for x in data)), regularisation, balance)
            p[out] = fitted.probabilities(data.belief[out], data.height[out])
    right, before = p.argmax(1) == data.leaf, data.belief.argmax(1) == data.leaf
    house = classes.leaf_classes()[data.leaf] == classes.HOUSE
    sure = np.digitize(p.max(1), _BOUNDS[1:-1])
    parts = {"all": np.ones(len(house), bool), "houses": house, "others": ~house}
    return {
        "objects": len(right),
        "streets": int(number.max()) + 1,
        "by_belief": {name: round(float(before[part].mean()), 4) for name, part in parts.items() if part.any()},
        "by_regression": {name: round(float(right[part].mean()), 4) for name, part in parts.items() if part.any()},
        "right_by_probability": [
            [_BOUNDS[k], int((sure == k).sum()), round(float(right[sure == k].mean()), 3)] for k in np.unique(sure)
        ],
    }


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.object_names", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--captures", type=pathlib.Path, required=True)
    parser.add_argument("--perceived", type=pathlib.Path, required=True)
    parser.add_argument("--regularisation", type=float, default=3e-3)
    parser.add_argument("--balance", type=float, default=0.5)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    arguments = parser.parse_args(argv)
    try:
        priors = LabelPriors(load_index())
        folders = sorted(path.parent for path in arguments.perceived.glob("*/recording/recording.json"))
        found = []
        for street, folder in enumerate(folders):
            capture = Recording.load(arguments.captures / f"{folder.parent.name}_rgb")
            found.append(examples(Recording.load(folder), capture, priors, street))
        if not found:
            raise ValidationError(f"{arguments.perceived}: found no recording, needed those of some streets.")
        data = _joined(found)
        table = scores(data, arguments.regularisation, arguments.balance)
        naming.save(fit(data, arguments.regularisation, arguments.balance), arguments.out)
    except ValidationError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    print(json.dumps(table))
    return 0


def _joined(found: Sequence[Examples]) -> Examples:
    return Examples(*(np.concatenate(parts) for parts in zip(*found, strict=True)))


if __name__ == "__main__":
    sys.exit(main())
