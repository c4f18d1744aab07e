"""`Predictor` implemented by the built-in network and a published detector."""

import dataclasses
from collections.abc import Callable

import numpy as np

from ....datatypes import validation as v
from ...perception_model.decode import Decoded
from ...perception_model.inference import MIN_SCORE, PerceptionModel, full_size
from ..foundation.boxes import Boxes
from ..observation import FrameObservation
from . import fusion, groups
from .nanodet import NanoDet

Detects = Callable[[np.ndarray], Boxes]


@dataclasses.dataclass(frozen=True)
class SecondOpinion:
    """The built-in network's objects, surfaces and depth, fused with a detector's boxes.

    Attributes:
      model: the built-in network.
      detector: (H, W, 3) u8 -> boxes with COCO's classes.
      options: of the fusion.
    """

    model: PerceptionModel
    detector: Detects
    options: fusion.FusionOptions = fusion.OPTIONS

    def __call__(self, rgb: np.ndarray, focal: float) -> FrameObservation:
        """See `Predictor`."""
        return full_size(self.decoded(rgb, focal).surer(MIN_SCORE), *rgb.shape[:2])

    def decoded(self, rgb: np.ndarray, focal: float) -> Decoded:
        """All objects of an image (H, W, 3) u8, whatever their score, at the size of the network's outputs."""
        found = groups.to_groups(self.detector(rgb))
        return fusion.fuse(self.model.decoded(rgb, focal), found, rgb.shape[:2], self.options)


#: Names of `--second-opinion`.
DETECTORS: dict[str, Callable[[], Detects]] = {"nanodet": NanoDet.load}


def second_opinion(model: PerceptionModel, name: str) -> SecondOpinion:
    """Adds a published detector to the built-in network.

    Raises:
      ValidationError: no such detector, or its weights were not fetched.
    """
    v.choice(name, "--second-opinion", tuple(DETECTORS))
    return SecondOpinion(model, DETECTORS[name]())
