"""`FoundationPredictor`: OWLv2 finds boxes, SAM 2 their masks, Mask2Former the ground, a metric model the depth."""

import dataclasses
import importlib
import pathlib
from collections.abc import Sequence
from typing import Any

import numpy as np
from PIL import Image

from ....datatypes import Detection
from ..observation import FrameObservation
from . import boxes, grounds
from .loading import DEPTH, DETECTOR, GROUND, SEGMENTER, Loaded, load

#: Queries per call of OWLv2, and the threshold of its scores (outputs of sigmoids, which are generally low).
QUERIES, LEAST_SCORE = 64, 0.2


@dataclasses.dataclass(frozen=True)
class FoundationPredictor:
    """`Predictor` by four models. Make it with `load`.

    Attributes:
      labels: to search for.
      detector, segmenter, ground, depth: the models.
      codes: surfaces of ground's classes.
    """

    labels: tuple[str, ...]
    detector: Loaded
    segmenter: Loaded
    ground: Loaded
    depth: Loaded
    codes: np.ndarray

    @staticmethod
    def load(labels: Sequence[str], models: pathlib.Path | None = None) -> "FoundationPredictor":
        """Loads the models from folders `owlv2`, `sam2`, `mask2former` and `depth` below `models`, or from the hub.

        Raises:
          ValidationError: a package or weights are missing.
        """
        detector, segmenter, ground, depth = (load(part, models) for part in (DETECTOR, SEGMENTER, GROUND, DEPTH))
        names = {int(k): str(name) for k, name in ground.model.config.id2label.items()}
        return FoundationPredictor(tuple(labels), detector, segmenter, ground, depth, grounds.surface_codes(names))

    def __call__(self, rgb: np.ndarray, focal: float, /) -> FrameObservation:
        """See `Predictor`. The depth model takes no focal length; its depth is corrected later by the scale of the
        poses."""
        image = Image.fromarray(rgb)
        found = boxes.suppressed(self._detect(image))
        masks, kept = boxes.paint(self._masks(image, found), found.score)
        objects = tuple(Detection(self.labels[found.label[k]], float(found.score[k])) for k in kept)
        surfaces = self.codes[self._classes(image)]
        # Object masks override the ground model.
        return FrameObservation(np.where(masks >= 0, 0, surfaces).astype(np.uint8), masks, objects, self._depth(image))

    def _detect(self, image: Image.Image) -> boxes.Boxes:
        starts = range(0, len(self.labels), QUERIES)
        parts = []
        for start in starts:
            texts = [[f"a photo of a {label}" for label in self.labels[start : start + QUERIES]]]
            answer = _run_model(self.detector, text=texts, images=image)
            logits, where = (x[0].float().cpu().numpy() for x in (answer.logits, answer.pred_boxes))
            parts.append(boxes.decode_owl(logits, where, image.height, image.width, LEAST_SCORE))
        return boxes.joined(parts, list(starts))

    def _masks(self, image: Image.Image, found: boxes.Boxes) -> np.ndarray:
        """(k, H, W) bool."""
        if not len(found.box):
            return np.zeros((0, image.height, image.width), bool)
        inputs = self.segmenter.processor(images=image, input_boxes=[found.box.tolist()], return_tensors="pt")
        answer = _answer(self.segmenter, inputs, multimask_output=False)
        masks = self.segmenter.processor.post_process_masks(answer.pred_masks.cpu(), inputs["original_sizes"])[0]
        return np.asarray(masks)[:, 0].astype(bool)

    def _classes(self, image: Image.Image) -> np.ndarray:
        """(H, W) numbers of classes."""
        answer = _run_model(self.ground, images=image)
        sizes = [(image.height, image.width)]
        return np.asarray(self.ground.processor.post_process_semantic_segmentation(answer, target_sizes=sizes)[0].cpu())

    def _depth(self, image: Image.Image) -> np.ndarray:
        """(H, W) f32 m."""
        depth = _run_model(self.depth, images=image).predicted_depth[0].float().cpu().numpy()
        scaled = Image.fromarray(depth, "F").resize(image.size, Image.Resampling.BILINEAR)
        return np.maximum(np.asarray(scaled, np.float32), 0.0)


def _run_model(part: Loaded, **given: Any) -> Any:
    return _answer(part, part.processor(**given, return_tensors="pt"))


def _answer(part: Loaded, inputs: Any, **options: Any) -> Any:
    torch: Any = importlib.import_module("torch")
    with torch.inference_mode():
        return part.model(**inputs.to(part.device), **options)
