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

Report = Callable[[int, int], None]


def _descriptor_of_object(image: np.ndarray, mask: np.ndarray) -> list[int]:
    return descriptors.of_image(image, mask).tolist()


#: The descriptors of the asset index, which the materialisation compares.
DESCRIBE = Describe(
    _descriptor_of_object, appearance_search.ground_crop_descriptor, appearance_search.sky_crop_descriptor
)


def distil_to(recording: Recording, folder: pathlib.Path, report: Report) -> SceneGraph:
    """Distils a recording into a folder: `graph.json`, `evidence.json`, `crops/`.

    Raises:
      ValidationError: see `distil`.
    """
    found = distil(
        recording, LabelPriors(load_index()), describe=DESCRIBE, crop_folder=folder / "crops", progress=report
    )
    body = {
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
