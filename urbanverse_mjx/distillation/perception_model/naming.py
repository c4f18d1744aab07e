"""Names an object from what the perception model believed in all of its views, and from its height.

A multinomial logistic regression over the leaves corrects what the network confuses (a minivan is often believed to be
a hatchback) and gives probabilities that are right as often as they say. It belongs to the shipped weights;
`benchmarks.object_names` fits it to objects of filmed streets. docs/decisions/gen_perception.md has its scores.
"""

import functools
import io
import pathlib
from typing import NamedTuple

import numpy as np
from scipy.special import softmax

from ...datatypes import ValidationError
from ...datatypes.validation import write_atomically
from . import classes

#: Objects with a less probable leaf have the name of their group (house, car): two of three such leaves are wrong.
MIN_PROBABILITY = 0.3
#: Smallest belief that counts, in the features and in the regression's own estimate: beliefs below 0.02 are not kept.
_FLOOR, OWN_FLOOR = 0.01, 0.001
#: m, heights are limited to this range.
_HEIGHTS = (0.05, 30.0)
_FILE = pathlib.Path(__file__).with_name("naming.npz")


class Naming(NamedTuple):
    """The regression: sharpness, factor of the logarithm of a leaf's own belief; weights (F, L) of `features`."""

    sharpness: float
    weights: np.ndarray

    def probabilities(self, belief: np.ndarray, height: np.ndarray) -> np.ndarray:
        """(n, L) probabilities of the leaves.

        Args:
          belief: (n, L) mean belief of an object's views in each of `classes.leaves()`.
          height: (n,) m.
        """
        own = np.log(np.maximum(belief, 0.0) + OWN_FLOOR)
        return softmax(self.sharpness * own + features(belief, height) @ self.weights, axis=1)

    def leaf(self, belief: np.ndarray, height: float) -> int:
        """Number of the most probable leaf of one object with beliefs (L,), or of the leaf that stands for its group
        if that is too improbable."""
        p = self.probabilities(belief[None], np.array([height]))[0]
        best = int(p.argmax())
        return best if p[best] >= MIN_PROBABILITY else generic()[best]


def features(belief: np.ndarray, height: np.ndarray) -> np.ndarray:
    """(n, F): logarithms of the beliefs in leaves and in groups, 0 for none; 1, and the height's logarithm and its
    square."""
    up = np.log(np.clip(height, *_HEIGHTS))
    beliefs = np.concatenate([belief, belief @ _groups()], axis=1)
    return np.concatenate([np.log1p(beliefs / _FLOOR), np.stack([np.ones_like(up), up, up**2], 1)], axis=1)


def used() -> np.ndarray:
    """(F, L) bool, the features on which a leaf depends: the leaves of its group, all groups, and the height."""
    kinds = classes.leaf_classes()
    others = np.ones((_groups().shape[1] + 3, len(kinds)), bool)
    return np.concatenate([kinds[:, None] == kinds[None], others])


@functools.cache
def generic() -> tuple[int, ...]:
    """For each leaf the number of the leaf that stands for its group."""
    leaves = classes.leaves()
    return tuple(leaves.index(classes.names()[kind]) for kind in classes.leaf_classes())


@functools.cache
def _groups() -> np.ndarray:
    """(L, G) 1 where a leaf belongs to a group."""
    return (classes.leaf_classes()[:, None] == np.arange(classes.FIRST_OBJECT + 1, len(classes.names()))).astype(float)


def save(naming: Naming, path: pathlib.Path) -> None:
    """Writes the regression with weights of 8 bits, one scale a leaf."""
    scale = np.maximum(np.abs(naming.weights).max(0), 1e-9) / 127.0
    body = io.BytesIO()
    np.savez_compressed(
        body,
        sharpness=np.float32(naming.sharpness),
        weights=np.round(naming.weights / scale).astype(np.int8),
        scale=scale.astype(np.float32),
    )
    write_atomically(path, lambda p: p.write_bytes(body.getvalue()))


def load(path: pathlib.Path = _FILE) -> Naming:
    """Reads what `save` writes.

    Raises:
      ValidationError: the file is for other leaves.
    """
    with np.load(path) as file:
        naming = Naming(float(file["sharpness"]), file["weights"].astype(float) * file["scale"])
    if naming.weights.shape != used().shape:
        raise ValidationError(
            f"{path}: found weights {naming.weights.shape}, needed {used().shape}; fit them by benchmarks.object_names."
        )
    return naming


@functools.cache
def shipped() -> Naming:
    """The regression of the shipped weights."""
    return load()
