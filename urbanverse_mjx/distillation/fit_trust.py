"""Fits the confidence calibration of the perception model, `perception_model.decode.DecodeOptions.trust`, which belongs
to one set of weights.

    python -m benchmarks.perception_streets --split test --first 20 --layouts 16 --out perception_held.npz
    python -m urbanverse_mjx.distillation.fit_trust --streets perception_held.npz

Every object detected in rendered frames is right or wrong (half of its mask, and its class); a logistic regression
predicts the probability from the object's features. Use streets other than those of reported tables. Prints one JSON
line.
"""

import argparse
import json
import pathlib
import sys

import jax.numpy as jnp
import numpy as np
import scipy.optimize

from ..datatypes import SceneBank, ValidationError
from .perception_model import network, score, weights
from .perception_model.decode import Decoded
from .perception_model.views import Views
from .train_perception import predict

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
        frames = predict(model, variables, views, arguments.frames, arguments.batch, arguments.seed)
        parts = [
            ([t.evidence for t in f.seen.objects], right(f.seen, f.kinds, f.owner)) for f in frames if f.seen.objects
        ]
        if not parts:
            raise ValidationError(
                f"{arguments.streets}: found no objects in {arguments.frames} frames, needed objects; add frames."
            )
    except ValidationError as error:
        sys.stderr.write(f"error: {error}\n")
        return 2
    evidence, is_right = (np.concatenate(x) for x in zip(*parts, strict=True))
    trust = [round(float(x), 2) for x in fit(evidence, is_right)]
    sys.stdout.write(json.dumps({"trust": trust, "objects": len(is_right), "right": int(is_right.sum())}) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
