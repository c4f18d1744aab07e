"""Loads models of the transformers library from a folder or by their name on the hub."""

import dataclasses
import pathlib
from typing import Any

from ....datatypes import ValidationError, optional


@dataclasses.dataclass(frozen=True)
class Part:
    """One model: folder below the models' folder, name on the hub, its classes in `transformers`."""

    folder: str
    hub: str
    model: str
    processor: str


OWLV2 = Part("owlv2", "google/owlv2-base-patch16-ensemble", "Owlv2ForObjectDetection", "Owlv2Processor")
SAM2 = Part("sam2", "facebook/sam2.1-hiera-small", "Sam2Model", "Sam2Processor")
SAM3 = Part("sam3", "facebook/sam3", "Sam3Model", "Sam3Processor")
GROUND = Part(
    "mask2former",
    "facebook/mask2former-swin-large-mapillary-vistas-semantic",
    "Mask2FormerForUniversalSegmentation",
    "AutoImageProcessor",
)
DEPTH = Part(
    "depth",
    "depth-anything/Depth-Anything-V2-Metric-Outdoor-Small-hf",
    "AutoModelForDepthEstimation",
    "AutoImageProcessor",
)


@dataclasses.dataclass(frozen=True)
class Loaded:
    """A model in evaluation mode with its input processor; `device` holds its parameters."""

    model: Any
    processor: Any
    device: str


def load(part: Part, models: pathlib.Path | None) -> Loaded:
    """Loads a part.

    Args:
      models: folder with one folder per part; a missing part, or None, is loaded by its name on the hub.

    Raises:
      ValidationError: torch or transformers is not installed, or there are no weights.
    """
    torch, transformers = (
        optional.package(package, "--perception foundation", "foundation", "leave the option out for the small network")
        for package in ("torch", "transformers")
    )
    local = models is not None and (models / part.folder).is_dir()
    name = str(models / part.folder) if models is not None and local else part.hub
    try:
        makers = [getattr(transformers, kind) for kind in (part.processor, part.model)]
    except AttributeError as error:
        raise ValidationError(
            f"transformers {transformers.__version__}: found no {part.model}, needed a newer version; "
            "`pip install -U transformers`."
        ) from error
    processor, model = optional.weights(
        lambda: [maker.from_pretrained(name) for maker in makers],
        part.folder,
        name,
        f"a folder {part.folder!r} with them below --models",
    )
    device = "cuda" if torch.cuda.is_available() else "cpu"
    return Loaded(model.to(device).eval(), processor, device)
