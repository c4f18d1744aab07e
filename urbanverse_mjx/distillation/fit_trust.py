"""Fits the confidence calibration of the perception model, which belongs to one set of weights: `trust` of the two
scales' `perception_model.decode.DecodeOptions`, and `perception_model.scales.MergeOptions`.

    python -m benchmarks.perception_streets --split test --first 20 --layouts 16 --out perception_held.npz
    python -m urbanverse_mjx.distillation.fit_trust --streets perception_held.npz

Every object detected in rendered frames is right or wrong (half of its mask, and its class). Logistic regressions
predict the probability from the object's features, for each scale by itself and then from both. Use streets other than
those of reported tables. Prints one JSON line.
"""

import argparse
import dataclasses
import json
import pathlib
import sys
from collections.abc import Sequence
from typing import Any

import jax.numpy as jnp
import numpy as np
import scipy.optimize
from scipy.special import expit

from ..datatypes import SceneBank, ValidationError
from .perception_model import network, scales, score, weights
from .perception_model.decode import COARSE, FINE, Decoded, decode
from .perception_model.network import Seen
from .perception_model.targets import GroundTruth
from .perception_model.views import Views
from .train_perception import Frame, frame_of, make_outputs

#: Weight of the squared coefficients, so that evidence which decides everything keeps them finite.
_RIDGE = 1e-4


def right(seen: Decoded, kinds: np.ndarray, owner: np.ndarray) -> np.ndarray:
    """(n,) bool, which objects of a frame have a mask that overlaps half of a true object's mask of their class, and
    vice versa.

    Args:
      kinds: (h, w) true classes.
      owner: (h, w) which object a pixel belongs to, -1 = none.
    """
    out = np.zeros(len(seen.objects), bool)
    for number, obj in enumerate(seen.objects):
        mask = seen.masks == number
        owners = owner[mask]
        owners = owners[owners >= 0]
        if len(owners):
            true = owner == np.bincount(owners).argmax()
            shared = (true & mask).sum() / (true | mask).sum()
            out[number] = shared > score.MIN_IOU and kinds[true][0] == obj.kind
    return out


def fit(evidence: np.ndarray, is_right: np.ndarray) -> np.ndarray:
    """(k,) coefficients of a logistic regression of (n,) bool on (n, k) evidence, whose first column is 1."""

    def loss(x: np.ndarray) -> float:
        odds = evidence @ x
        return float((np.logaddexp(0.0, odds) - is_right * odds).mean() + _RIDGE * (x[1:] ** 2).sum())

    return scipy.optimize.minimize(loss, np.zeros(evidence.shape[1])).x


def _both(fine: Seen, coarse: Seen, wanted: GroundTruth) -> tuple[Frame, Frame]:
    """What was decoded in a frame at full and at half size, both at the outputs' full size."""
    found = decode(fine, network.CANONICAL_FOCAL, FINE), decode(coarse, network.CANONICAL_FOCAL / 2.0, COARSE)
    large = scales.enlarged(found[1], *found[0].masks.shape)
    return frame_of(found[0], wanted), frame_of(large, wanted)


def calibration(frames: Sequence[tuple[Frame, Frame]], streets: pathlib.Path) -> dict[str, Any]:
    """Coefficients by name, and the numbers of objects and of right ones at each scale.

    Args:
      frames: each at full and at half size.
      streets: their bank, for the error.

    Raises:
      ValidationError: a scale has no objects.
    """
    is_right = [[right(f.seen, f.kinds, f.owner) for f in scale] for scale in zip(*frames, strict=True)]
    scored, table = [], {}
    for name, scale, known in zip(("fine", "coarse"), zip(*frames, strict=True), is_right, strict=True):
        evidence = [[t.evidence for t in f.seen.objects] for f in scale if f.seen.objects]
        if not evidence:
            raise ValidationError(f"{streets}: found no objects in {len(frames)} frames, needed objects; add frames.")
        trust = fit(np.concatenate(evidence), np.concatenate(known))
        table[f"{name} trust"] = _rounded(trust)
        scored.append([rescored(f.seen, trust) for f in scale])
        table[f"{name} objects"] = [sum(map(len, known)), int(sum(x.sum() for x in known))]
    pairs = list(zip(*scored, strict=True))
    for name, known, ordered in (
        ("fine", is_right[0], pairs),
        ("coarse", is_right[1], [(b, a) for a, b in pairs]),
    ):
        features = np.concatenate([scales.agreement(a, b) for a, b in ordered])
        table[f"{name} merged"] = _rounded(fit(features, np.concatenate(known)))
    return table


def rescored(seen: Decoded, trust: np.ndarray) -> Decoded:
    """The same objects with the scores that coefficients (k,) of their evidence give."""
    objects = tuple(dataclasses.replace(t, score=float(expit(np.dot(trust, t.evidence)))) for t in seen.objects)
    return dataclasses.replace(seen, objects=objects)


def _rounded(coefficients: np.ndarray) -> list[float]:
    return [round(float(x), 2) for x in coefficients]


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m urbanverse_mjx.distillation.fit_trust", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--streets", type=pathlib.Path, required=True, help="bank of streets")
    parser.add_argument("--weights", type=pathlib.Path, help="default: the shipped ones")
    parser.add_argument("--frames", type=int, default=48)
    parser.add_argument("--batch", type=int, default=4)
    parser.add_argument("--seed", type=int, default=2)
    arguments = parser.parse_args(argv)
    try:
        variables, _ = weights.load(arguments.weights)
        views = Views.of(SceneBank.load(arguments.streets), *network.SIZE, appearance=0.0)
        model = weights.network(jnp.float32, network.blocks_of(variables))
        outputs = make_outputs(model, views)(variables, arguments.frames, arguments.batch, arguments.seed)
        table = calibration([_both(*x) for x in outputs], arguments.streets)
    except ValidationError as error:
        sys.stderr.write(f"error: {error}\n")
        return 2
    sys.stdout.write(json.dumps(table) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
