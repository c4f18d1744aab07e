"""Open-vocabulary detectors: OWLv2 with SAM 2 for the masks, or SAM 3 alone. Each image is encoded once for all labels,
and each label once for all images."""

import dataclasses
import importlib
import pathlib
from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
from PIL import Image

from . import boxes
from .boxes import Boxes
from .loading import OWLV2, SAM2, SAM3, Loaded, load

#: Thresholds of scores: those of OWLv2's sigmoids are generally low, those of SAM 3 are probabilities.
OWLV2_SCORE, SAM3_SCORE = 0.2, 0.5
#: Labels per call.
_LABELS = 64


@dataclasses.dataclass(frozen=True)
class Found:
    """k objects of an image: boxes with labels and scores, and their masks (k, H, W) bool."""

    boxes: Boxes
    masks: np.ndarray


class Detector(Protocol):
    """Finds objects of given labels."""

    def __call__(self, image: Image.Image, /) -> Found:
        """The objects of an RGB image, overlapping boxes suppressed."""
        ...


@dataclasses.dataclass(frozen=True)
class Owlv2Detector:
    """OWLv2 (Minderer et al., NeurIPS 2023) finds boxes, SAM 2 (Ravi et al., 2024) their masks.

    Attributes:
      queries: (n, d) tensor, the vectors of the labels.
    """

    owlv2: Loaded
    sam2: Loaded
    queries: Any

    @staticmethod
    def load(labels: Sequence[str], models: pathlib.Path | None) -> "Owlv2Detector":
        """Loads `owlv2` and `sam2` and encodes the labels.

        Raises:
          ValidationError: a package or weights are missing.
        """
        owlv2, sam2 = load(OWLV2, models), load(SAM2, models)
        torch: Any = importlib.import_module("torch")
        vectors = []
        for start in range(0, len(labels), _LABELS):
            texts = [f"a photo of a {label}" for label in labels[start : start + _LABELS]]
            batch = owlv2.processor(text=[texts], return_tensors="pt").to(owlv2.device)
            with torch.inference_mode():
                vectors.append(tensor_of(owlv2.model.owlv2.get_text_features(**batch)))
        return Owlv2Detector(owlv2, sam2, torch.cat(vectors))

    def __call__(self, image: Image.Image, /) -> Found:
        """See `Detector`."""
        scores, corners = self.outputs(image)
        found = boxes.suppressed(boxes.decode_owl(scores, corners, image.height, image.width, OWLV2_SCORE))
        return Found(found, self._masks(image, found))

    def outputs(self, image: Image.Image) -> tuple[np.ndarray, np.ndarray]:
        """(p, n) logits and (p, 4) boxes of all patches, see `boxes.decode_owl`."""
        torch: Any = importlib.import_module("torch")
        model = self.owlv2.model
        inputs = self.owlv2.processor(images=image, return_tensors="pt").to(self.owlv2.device)
        with torch.inference_mode():
            features, _ = model.image_embedder(pixel_values=inputs["pixel_values"])
            patches = features.flatten(1, 2)
            where = model.box_predictor(patches, features)
            logits, _ = model.class_predictor(patches, self.queries[None])
        return logits[0].float().cpu().numpy(), where[0].float().cpu().numpy()

    def _masks(self, image: Image.Image, found: Boxes) -> np.ndarray:
        """(k, H, W) bool."""
        if not len(found.box):
            return np.zeros((0, image.height, image.width), bool)
        torch: Any = importlib.import_module("torch")
        inputs = self.sam2.processor(images=image, input_boxes=[found.box.tolist()], return_tensors="pt")
        with torch.inference_mode():
            answer = self.sam2.model(**inputs.to(self.sam2.device), multimask_output=False)
        masks = self.sam2.processor.post_process_masks(answer.pred_masks.cpu(), inputs["original_sizes"].cpu())[0]
        return np.asarray(masks)[:, 0].astype(bool)


@dataclasses.dataclass(frozen=True)
class Sam3Detector:
    """SAM 3 (Meta, 2025) finds all instances of a label with their masks.

    Attributes:
      labels: (vectors, attention mask) of each label's words.
    """

    sam3: Loaded
    labels: tuple[tuple[Any, Any], ...]

    @staticmethod
    def load(labels: Sequence[str], models: pathlib.Path | None) -> "Sam3Detector":
        """Loads `sam3` and encodes the labels.

        Raises:
          ValidationError: a package or weights are missing.
        """
        sam3 = load(SAM3, models)
        torch: Any = importlib.import_module("torch")
        encoded = []
        for label in labels:
            words = sam3.processor(text=label, return_tensors="pt").to(sam3.device)
            with torch.inference_mode():
                vectors = sam3.model.get_text_features(
                    input_ids=words["input_ids"], attention_mask=words["attention_mask"]
                )
            encoded.append((vectors, words["attention_mask"]))
        return Sam3Detector(sam3, tuple(encoded))

    def __call__(self, image: Image.Image, /) -> Found:
        """See `Detector`."""
        torch: Any = importlib.import_module("torch")
        inputs = self.sam3.processor(images=image, return_tensors="pt").to(self.sam3.device)
        size = [(image.height, image.width)]
        parts: list[Boxes] = []
        masks: list[np.ndarray] = []
        with torch.inference_mode():
            seen = self.sam3.model.get_vision_features(pixel_values=inputs["pixel_values"])
            for number, (vectors, mask) in enumerate(self.labels):
                answer = self.sam3.model(vision_embeds=seen, text_embeds=vectors, attention_mask=mask)
                (found,) = self.sam3.processor.post_process_instance_segmentation(
                    answer, threshold=SAM3_SCORE, target_sizes=size
                )
                score = found["scores"].float().cpu().numpy().astype(np.float64)
                corners = found["boxes"].float().cpu().numpy().astype(np.float64).reshape(-1, 4)
                parts.append(Boxes(corners, np.full(len(score), number), score))
                masks.append(np.asarray(found["masks"].cpu()).astype(bool).reshape(-1, image.height, image.width))
        everything = boxes.joined(parts, [0] * len(parts))
        kept = boxes.rows_kept(everything)  # there is at least one label, whose list may be empty
        return Found(everything.take(kept), np.concatenate(masks)[kept])


def tensor_of(found: Any) -> Any:
    """The vectors in what a model gives: version 5 of transformers adds more to them."""
    return getattr(found, "pooler_output", found)


#: Name of `--detector` -> its class.
DETECTORS = {"owlv2": Owlv2Detector, "sam3": Sam3Detector}
