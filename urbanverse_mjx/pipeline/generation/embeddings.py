"""Embeddings for the choice of assets: none without weights, CLIP and DINOv2 for `--retrieval neural`."""

import pathlib

import numpy as np
from PIL import Image

from ...assets.categories import ontology
from ...assets.selection.neural import IMAGE_MODEL, LABEL_MODEL, ImageEmbedder, LabelEmbedder
from ...datatypes import SceneGraph, optional
from ...datatypes import validation as v
from ...datatypes.recording import UNREADABLE
from ...materialisation import BUILT_IN, Embeddings
from .video_options import RETRIEVALS

#: sRGB of the background of thumbnails, on which crops are put.
BACKGROUND = (158, 162, 166)


def check_packages(retrieval: str) -> None:
    """Checks before a long run that what a retrieval needs is installed.

    Raises:
      ValidationError: another retrieval, or a missing package.
    """
    v.choice(retrieval, "--retrieval", RETRIEVALS)
    if retrieval == "neural":
        for package in ("torch", "transformers"):
            optional.package(package, "--retrieval neural", "foundation", "leave the option out to match by words")


def load_embeddings(retrieval: str, models: str | None, graph: SceneGraph, crops: pathlib.Path) -> Embeddings:
    """Loads what the options ask for.

    Args:
      retrieval: one of `RETRIEVALS`.
      models: folder with folders `clip` and `dinov2`; a missing one, or None, is loaded by its name on the hub.
      crops: folder of the objects' crops, see `distillation.crops`; may be missing.

    Raises:
      ValidationError: another retrieval, a missing package, or missing weights.
    """
    check_packages(retrieval)
    if retrieval == "built-in":
        return BUILT_IN
    text = LabelEmbedder.load(tuple(ontology.categories()), _where(models, "clip", LABEL_MODEL))
    image = ImageEmbedder.load(_where(models, "dinov2", IMAGE_MODEL))
    cut = {obj.id: crop for obj in graph.objects if (crop := _crop(crops / f"{obj.id}_0.png")) is not None}
    return Embeddings(text, image, cut)


def _where(models: str | None, folder: str, hub: str) -> str:
    local = None if models is None else pathlib.Path(models) / folder
    return str(local) if local is not None and local.is_dir() else hub


def _crop(path: pathlib.Path) -> np.ndarray | None:
    """(H, W, 3) uint8 of an object cut out by its mask, on the thumbnails' background; None where there is no file.

    Raises:
      ValidationError: a damaged file.
    """
    if not path.is_file():
        return None
    try:
        with Image.open(path) as image:
            cut = image.convert("RGBA")
    except UNREADABLE as error:
        raise v.fail(str(path), f"an unreadable image ({error})", "a whole PNG", "make the run again") from error
    shown = Image.new("RGBA", cut.size, (*BACKGROUND, 255))
    shown.alpha_composite(cut)
    return np.asarray(shown.convert("RGB"))
