"""Distils a recording to `graph.json` with descriptors, `evidence.json` and crops."""

import dataclasses
import json
import pathlib
from collections.abc import Callable

import numpy as np

from ...assets import load_index
from ...assets.appearances import appearance_search
from ...assets.selection import descriptors
from ...assets.selection.label_priors import LabelPriors
from ...datatypes import Recording, SceneGraph
from ...distillation import Describe, distil
from ...distillation.colour import without_colour

Report = Callable[[int, int], None]


def _descriptor_of_object(image: np.ndarray, mask: np.ndarray) -> list[int]:
    return descriptors.of_image(image, mask).tolist()


#: The descriptors of the asset index, which the materialisation compares.
DESCRIBE = Describe(
    _descriptor_of_object, appearance_search.ground_crop_descriptor, appearance_search.sky_crop_descriptor
)


def _outline_of_object(image: np.ndarray, mask: np.ndarray) -> list[int]:
    """The descriptor with all colours at 0, at which every asset's colours are equally far."""
    numbers = descriptors.of_image(image, mask)
    numbers[: descriptors.COLORS] = 0
    return numbers.tolist()


#: The descriptors of images without colour: outlines of objects alone. Ground and sky without a descriptor get any dry
#: material and any daytime sky; by their grey they would be wet and overcast.
DESCRIBE_GREY = Describe(_outline_of_object)


def distil_to(recording: Recording, folder: pathlib.Path, report: Report) -> SceneGraph:
    """Distils a recording into a folder: `graph.json`, `evidence.json`, `crops/`.

    Raises:
      ValidationError: see `distil`.
    """
    grey = without_colour(recording)
    describe = DESCRIBE_GREY if grey else DESCRIBE
    found = distil(
        recording, LabelPriors(load_index()), describe=describe, crop_folder=folder / "crops", progress=report
    )
    body = {
        "colour": not grey,
        "views": found.views,
        "left_out": found.left_out,
        "removed": [dataclasses.asdict(entry) for entry in found.separation.removed],
        "cut": [list(entry) for entry in found.separation.cut],
        "moved_out": [list(entry) for entry in found.separation.moved],
        "kerbs": [dataclasses.asdict(k) for k in found.kerbs],
        "objects": [e.to_json() for e in found.evidence],
    }
    (folder / "evidence.json").write_text(json.dumps(body, indent=1, default=str) + "\n", encoding="utf-8")
    found.graph.save(folder / "graph.json")
    return found.graph
