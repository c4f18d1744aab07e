"""`FoundationPredictor`: OWLv2 and SAM 2, or SAM 3, find objects, Mask2Former the ground, a metric model the depth."""

import dataclasses
import importlib
import pathlib
from collections.abc import Sequence
from typing import Any

import numpy as np
from PIL import Image

from ....datatypes import Detection
from ....datatypes import validation as v
from ..observation import FrameObservation
from . import boxes, grounds
from .detectors import DETECTORS, Detector
from .loading import DEPTH, GROUND, Loaded, load


@dataclasses.dataclass(frozen=True)
class FoundationPredictor:
    """`Predictor` by foundation models. Make it with `load`.

    Attributes:
      labels: to search for.
      detector, ground, depth: the models.
      codes: surfaces of ground's classes.
    """

    labels: tuple[str, ...]
    detector: Detector
    ground: Loaded
    depth: Loaded
    codes: np.ndarray

    @staticmethod
    def load(
        labels: Sequence[str], models: pathlib.Path | None = None, detector: str = "owlv2"
    ) -> "FoundationPredictor":
        """Loads the models from folders `owlv2` and `sam2`, or `sam3`, and `mask2former` and `depth` below `models`, or
        from the hub.

        Args:
          detector: "owlv2" (with SAM 2) or "sam3".

        Raises:
          ValidationError: a package or weights are missing, or there is no such detector.
        """
        v.choice(detector, "--detector", tuple(DETECTORS))
        found = DETECTORS[detector].load(labels, models)
        ground, depth = (load(part, models) for part in (GROUND, DEPTH))
        names = {int(k): str(name) for k, name in ground.model.config.id2label.items()}
        return FoundationPredictor(tuple(labels), found, ground, depth, grounds.surface_codes(names))

    def __call__(self, rgb: np.ndarray, focal: float, /) -> FrameObservation:
        """See `Predictor`. The depth model takes no focal length; its depth is corrected later by the scale of the
        poses."""
        image = Image.fromarray(rgb)
        found = self.detector(image)
        masks, kept = boxes.paint(found.masks, found.boxes.score)
        objects = tuple(Detection(self.labels[found.boxes.label[k]], float(found.boxes.score[k])) for k in kept)
        surfaces = self.codes[self._classes(image)]
        # Object masks override the ground model.
        return FrameObservation(np.where(masks >= 0, 0, surfaces).astype(np.uint8), masks, objects, self._depth(image))

    def _classes(self, image: Image.Image) -> np.ndarray:
        """(H, W) numbers of classes."""
        answer = _run_model(self.ground, image)
        sizes = [(image.height, image.width)]
        return np.asarray(self.ground.processor.post_process_semantic_segmentation(answer, target_sizes=sizes)[0].cpu())

    def _depth(self, image: Image.Image) -> np.ndarray:
        """(H, W) f32 m."""
        depth = _run_model(self.depth, image).predicted_depth[0].float().cpu().numpy()
        scaled = Image.fromarray(depth, "F").resize(image.size, Image.Resampling.BILINEAR)
        return np.maximum(np.asarray(scaled, np.float32), 0.0)


def _run_model(part: Loaded, image: Image.Image) -> Any:
    torch: Any = importlib.import_module("torch")
    inputs = part.processor(images=image, return_tensors="pt").to(part.device)
    with torch.inference_mode():
        return part.model(**inputs)
