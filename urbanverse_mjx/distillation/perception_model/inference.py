"""Inference of the perception model on images of any size."""

import dataclasses
import os
from typing import Any

import jax
import numpy as np
from PIL import Image

from ...datatypes import Detection
from ..perception.observation import FrameObservation
from . import classes, scales, weights
from .decode import Decoded, FoundObject
from .network import LEAF_STRIDE, OUTPUT_STRIDE, SIZE, STRIDE, Seen, blocks_of

#: Least probability of reported objects; fusion over frames would otherwise place false objects on free ground.
MIN_SCORE = 0.5
#: Certainty from which an object has the label of its leaf; less certain ones have that of their group (house, car).
#: Calibrated on 42 frames of three streets of AutoBench: from here on more leaves are right than wrong
#: (docs/decisions/gen_perception.md).
MIN_CERTAINTY, MIN_HOUSE_CERTAINTY = 0.4, 0.7


@dataclasses.dataclass(frozen=True)
class PerceptionModel:
    """`Predictor` implemented by the built-in network. Create it with `PerceptionModel.load`.

    Attributes:
      variables: variables of the network.
      record: how they were trained.
    """

    variables: Any
    record: dict[str, Any]

    @staticmethod
    def load(path: str | os.PathLike[str] | None = None) -> "PerceptionModel":
        """Loads the perception model with the shipped weights or those of a file.

        Raises:
          ValidationError: there are no weights at the path.
        """
        return PerceptionModel(*weights.load(path))

    def __call__(self, rgb: np.ndarray, focal: float) -> FrameObservation:
        """See `Predictor`."""
        return full_size(self.decoded(rgb, focal).surer(MIN_SCORE), *rgb.shape[:2])

    def decoded(self, rgb: np.ndarray, focal: float) -> Decoded:
        """All objects of an image (H, W, 3) u8, whatever their score, at the outputs' size.

        The image is scaled so that its longer side is as long as in training, and to half of that.
        """
        factor = max(SIZE) / max(rgb.shape[:2])
        return scales.decoded(self._outputs(rgb, factor), self._outputs(rgb, factor / 2.0), focal * factor)

    def _outputs(self, rgb: np.ndarray, factor: float) -> Seen:
        """The network's outputs for an image (H, W, 3) u8 that is scaled by a factor."""
        height, width = rgb.shape[:2]
        small = round(height * factor), round(width * factor)
        image = Image.fromarray(rgb).resize(small[::-1], Image.Resampling.BILINEAR)
        # Multiples of the network's stride: padding at the bottom and the right repeats the border.
        pad = [(0, -n % STRIDE) for n in small]
        padded = np.pad(np.asarray(image), [*pad, (0, 0)], "edge")
        seen = _apply(self.variables, padded[None] / np.float32(255.0))
        rows, columns = (-(-n // OUTPUT_STRIDE) for n in small)
        leaves = np.asarray(seen.leaves)[0, : -(-rows // LEAF_STRIDE), : -(-columns // LEAF_STRIDE)]
        kinds, centre, offset, log_depth = (np.asarray(x)[0, :rows, :columns] for x in seen[:-1])
        return Seen(kinds, centre, offset, log_depth, leaves)


@jax.jit
def _apply(variables: Any, images: jax.Array) -> Seen:
    seen: Any = weights.network(blocks=blocks_of(variables)).apply(variables, images, train=False)
    return seen


def label_of(obj: FoundObject) -> str:
    """The leaf of an object if it is certain enough, else the name of its group, which is a plain leaf."""
    least = MIN_HOUSE_CERTAINTY if obj.kind == classes.HOUSE else MIN_CERTAINTY
    return classes.leaves()[obj.leaf] if obj.certainty >= least else classes.names()[obj.kind]


def full_size(seen: Decoded, height: int, width: int) -> FrameObservation:
    """The decoded outputs at the size of the image, with labels in place of numbers."""
    # Depth is upsampled by repetition, because it is discontinuous between objects.
    seen = scales.enlarged(seen, height, width)
    leaves = classes.leaves()
    found = tuple(
        Detection(label_of(obj), obj.score, beliefs=tuple((leaves[k], round(p, 3)) for k, p in obj.beliefs))
        for obj in seen.objects
    )
    return FrameObservation(classes.surface_codes()[seen.kinds], seen.masks, found, seen.depth)
