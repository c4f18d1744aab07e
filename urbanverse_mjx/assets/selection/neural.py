"""Optional neural embeddings of sentences (sentence-transformers), labels (CLIP) and images (DINOv2).

Needs `pip install "urbanverse_mjx[embeddings]"`; the first use of a model downloads its weights unless a folder with
the weights is given.
"""

import dataclasses
import functools
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ...datatypes import optional

SENTENCE_MODEL = "sentence-transformers/all-mpnet-base-v2"  # the official toolkit's default
LABEL_MODEL = "openai/clip-vit-large-patch14"  # the paper's
IMAGE_MODEL = "facebook/dinov2-base"  # DINOv2 with patches of 14 pixels and vectors of 768 numbers
BATCH = 32


def _module(name: str) -> Any:
    return optional.package(name, "embedding", "embeddings", "leave the model out to match offline")


def _loaded(what: str, load: Callable[[], Any], model: str) -> Any:
    return optional.weights(load, what, model, "the name of a folder that holds them")


@dataclasses.dataclass(frozen=True, eq=False)
class SentenceEmbedder:
    """Texts -> vectors of length 1."""

    model: Any

    @staticmethod
    @functools.lru_cache(maxsize=2)
    def load(model: str = SENTENCE_MODEL) -> "SentenceEmbedder":
        """Loads a sentence-transformers model by name or folder.

        Raises:
          ValidationError: the package or the weights are missing.
        """
        package = _module("sentence_transformers")
        return SentenceEmbedder(_loaded("sentence model", lambda: package.SentenceTransformer(model), model))

    def __call__(self, texts: Sequence[str]) -> np.ndarray:
        """(n, d) float32."""
        return np.asarray(self.model.encode(list(texts), batch_size=BATCH, normalize_embeddings=True))


@dataclasses.dataclass(frozen=True, eq=False)
class LabelEmbedder:
    """Labels -> vectors of length 1 by CLIP's text encoder (Radford et al., ICML 2021).

    All of CLIP's text vectors lie near one another, so their mean over some labels is subtracted first.

    Attributes:
      mean: (d,), see `load`.
    """

    model: Any
    tokenizer: Any
    mean: np.ndarray

    @staticmethod
    @functools.lru_cache(maxsize=2)
    def load(labels: tuple[str, ...], model: str = LABEL_MODEL) -> "LabelEmbedder":
        """Loads a CLIP model by name or folder, onto a GPU if there is one.

        Args:
          labels: whose mean is subtracted.

        Raises:
          ValidationError: the packages or the weights are missing.
        """
        torch, package = _module("torch"), _module("transformers")
        network = _loaded("label model", lambda: package.CLIPModel.from_pretrained(model), model)
        tokenizer = _loaded("label model", lambda: package.AutoTokenizer.from_pretrained(model), model)
        device = "cuda" if torch.cuda.is_available() else "cpu"
        plain = LabelEmbedder(network.eval().to(device), tokenizer, np.zeros(1))
        return dataclasses.replace(plain, mean=plain._encoded(labels).mean(0))

    def __call__(self, texts: Sequence[str]) -> np.ndarray:
        """(n, d) float32."""
        centred = self._encoded(texts) - self.mean
        return centred / np.maximum(np.linalg.norm(centred, axis=1, keepdims=True), 1e-12)

    def _encoded(self, texts: Sequence[str]) -> np.ndarray:
        torch = _module("torch")
        vectors = []
        for start in range(0, len(texts), BATCH):
            asked = [f"a photo of a {text}" for text in texts[start : start + BATCH]]
            batch = self.tokenizer(asked, padding=True, truncation=True, return_tensors="pt")
            with torch.inference_mode():
                found = self.model.get_text_features(**batch.to(self.model.device))
            found = getattr(found, "pooler_output", found)  # transformers 5 gives more than the vectors
            vectors.append(torch.nn.functional.normalize(found, dim=-1).float().cpu().numpy())
        return np.concatenate(vectors)


@dataclasses.dataclass(frozen=True, eq=False)
class ImageEmbedder:
    """Images -> vectors of length 1: DINOv2's class token."""

    model: Any
    processor: Any

    @staticmethod
    @functools.lru_cache(maxsize=2)
    def load(model: str = IMAGE_MODEL) -> "ImageEmbedder":
        """Loads a DINOv2 model by name or folder, onto a GPU if there is one.

        Raises:
          ValidationError: the packages or the weights are missing.
        """
        torch, package = _module("torch"), _module("transformers")
        network = _loaded("image model", lambda: package.AutoModel.from_pretrained(model), model)
        processor = _loaded("image model", lambda: package.AutoImageProcessor.from_pretrained(model), model)
        device = "cuda" if torch.cuda.is_available() else "cpu"
        return ImageEmbedder(network.eval().to(device), processor)

    def __call__(self, images: Sequence[np.ndarray]) -> np.ndarray:
        """(n, d) float32 of (H, W, 3) uint8 images."""
        torch = _module("torch")
        vectors = []
        for start in range(0, len(images), BATCH):
            batch = self.processor(images=list(images[start : start + BATCH]), return_tensors="pt")
            with torch.inference_mode():
                token = self.model(**batch.to(self.model.device)).last_hidden_state[:, 0]
            vectors.append(torch.nn.functional.normalize(token, dim=-1).float().cpu().numpy())
        return np.concatenate(vectors)
