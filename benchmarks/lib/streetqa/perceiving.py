"""Answers by the perception model of this package: its detections, surfaces and depth instead of ground truth.

It knows the camera's height and pitch, which questions do not tell. What it cannot say (words on signs, an object that
it does not find) is answered blindly.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from PIL import Image

from urbanverse_mjx.datatypes import KIND_INDEX, traversable
from urbanverse_mjx.distillation.perception.observation import FrameObservation, Predictor

from . import colours, walkable
from .blind import Blind
from .lmms_eval_utils import chosen
from .templates import RANGE_NAMES, RANGES
from .views import CAMERA_HEIGHT, FOVY, PITCH
from .words import Word, words

#: m between samples of the ground, and the share of them from which on a path leads over the road.
_STEP, _MUCH_ROAD = 0.1, 0.15
_ROAD = (KIND_INDEX["road"], KIND_INDEX["road_marking"])


class Perceiving:
    """Answers questions about images.

    Args:
      model: a perception model.
      blind: answers what the model does not tell.
    """

    def __init__(self, model: Predictor, blind: Blind) -> None:
        self._model, self._blind = model, blind
        self._image, self._rgb, self._found = "", np.zeros((1, 1, 3), np.uint8), None

    def answer(self, doc: Mapping[str, Any], path: str, form: str) -> str:
        """The answer to a question; its letter if form is "mc".

        Args:
          path: of the image.
        """
        if path != self._image:
            self._rgb = np.asarray(Image.open(path).convert("RGB"))
            self._found = self._model(self._rgb, self._rgb.shape[0] / 2 / math.tan(FOVY / 2))
            self._image = path
        assert self._found is not None
        said = self._say(doc, self._found)
        if form == "free":
            return said or self._blind.say(doc)
        option = None if said is None else _option(doc, said)
        return "ABCD"[doc["options"].index(option)] if option else self._blind.choose(doc)

    def _say(self, doc: Mapping[str, Any], found: FrameObservation) -> str | None:
        """The answer in words, None where the model tells nothing."""
        template, subject = doc["template"], doc["subject"]
        if template in ("exists", "count"):
            number = len(_of_word(found, words()[subject]))
            return ("yes" if number else "no") if template == "exists" else str(max(number, 1))
        if template in ("right_of_way", "free_direction"):
            return self._ground(doc, found)
        if template in ("side", "nearer"):
            return self._compared(doc, found)
        if template == "text":
            return None
        mask = self._mask(found, subject if subject.startswith("the ") else f"the {subject}")
        return None if mask is None else self._single(template, found, mask)

    def _ground(self, doc: Mapping[str, Any], found: FrameObservation) -> str | None:
        degrees = doc["facts"]["degrees"]
        if doc["template"] == "right_of_way":
            kinds = self._kinds(found, degrees, 2.5, walkable.AHEAD)
            return None if not len(kinds) else "yes" if np.isin(kinds, _ROAD).mean() > _MUCH_ROAD else "no"
        shares = []
        for angle in (degrees, 0, -degrees):
            kinds = self._kinds(found, angle, 1.9, doc["facts"]["length"])
            shares.append(float(traversable(kinds).mean()) if len(kinds) else 0.0)
        return ("left", "straight ahead", "right")[int(np.argmax(shares))]

    def _compared(self, doc: Mapping[str, Any], found: FrameObservation) -> str | None:
        a, b = self._names(doc)
        first, second = self._mask(found, a), self._mask(found, b)
        if first is None or second is None:
            return None
        if doc["template"] == "side":
            return "left" if np.nonzero(first)[1].mean() < np.nonzero(second)[1].mean() else "right"
        return a if _range(found, first) < _range(found, second) else b

    def _single(self, template: str, found: FrameObservation, mask: np.ndarray) -> str | None:
        """What is asked of one object: its colour, distance, ground, or whether no road lies before it."""
        if template == "colour":
            rows = colours.name_rows(self._rgb[mask])
            rows = rows[rows >= 0]
            return colours.NAMES[int(np.bincount(rows).argmax())] if len(rows) else None
        if template == "distance":
            return f"{_range(found, mask):.1f} m"
        row, column = np.nonzero(mask)
        foot = int(row.max()), int(np.median(column[row == row.max()]))
        bottom, right = found.surfaces.shape[0] - 1, found.surfaces.shape[1]
        if template == "stands_on":
            below = int(found.surfaces[min(foot[0] + 3, bottom), foot[1]])
            names = {KIND_INDEX["sidewalk"]: "the pavement", KIND_INDEX["crosswalk"]: "a crosswalk"}
            return "the road" if below in _ROAD else names.get(below)
        share = np.linspace(0.0, 1.0, 60)
        rows = np.round(bottom + share * (foot[0] - bottom)).astype(int)
        columns = np.round(right / 2 + share * (foot[1] - right / 2)).astype(int)
        return "no" if np.isin(found.surfaces[rows, columns], _ROAD).mean() > _MUCH_ROAD else "yes"

    def _names(self, doc: Mapping[str, Any]) -> tuple[str, str]:
        if doc["template"] == "nearer":
            first, _, second = doc["question"].partition(", ")[2].rstrip("?").partition(" or ")
            return first, second
        a, _, b = doc["subject"].partition("/")
        return a, b

    def _mask(self, found: FrameObservation, phrase: str) -> np.ndarray | None:
        """(H, W) bool: the nearest detection that a phrase can mean."""
        word = words()[phrase.removeprefix("the ").removeprefix("nearest ")]
        masks = [found.masks == row for row in _of_word(found, word)]
        masks = [mask for mask in masks if mask.any()]
        return min(masks, key=lambda mask: _range(found, mask)) if masks else None

    def _kinds(self, found: FrameObservation, degrees: float, first: float, last: float) -> np.ndarray:
        """Kinds of ground that the image shows along a direction on flat ground."""
        away = np.arange(first, last + _STEP / 2, _STEP)
        turn = math.radians(degrees)
        right, ahead = -away * math.sin(turn), away * math.cos(turn)
        depth = ahead * math.cos(PITCH) - CAMERA_HEIGHT * math.sin(PITCH)
        down = CAMERA_HEIGHT * math.cos(PITCH) + ahead * math.sin(PITCH)
        h, w = found.surfaces.shape
        focal = h / 2 / math.tan(FOVY / 2)
        rows = np.floor(h / 2 + focal * down / depth).astype(int)
        columns = np.floor(w / 2 + focal * right / depth).astype(int)
        inside = (rows >= 0) & (rows < h) & (columns >= 0) & (columns < w)
        kinds = found.surfaces[rows[inside], columns[inside]].copy()
        kinds[found.masks[rows[inside], columns[inside]] >= 0] = 0
        return kinds


def _of_word(found: FrameObservation, word: Word) -> list[int]:
    """Rows of the detections that a word means; the model may only have named the group ("car")."""
    return [k for k, seen in enumerate(found.detections) if seen.label in word.leaves or seen.label == word.name]


def _range(found: FrameObservation, mask: np.ndarray) -> float:
    """m from the camera to the nearest point of a mask."""
    if found.depth is None or not mask.any():
        return math.inf
    h, w = mask.shape
    focal = h / 2 / math.tan(FOVY / 2)
    x, y = (np.arange(w) + 0.5 - w / 2) / focal, (np.arange(h) + 0.5 - h / 2) / focal
    ray = np.sqrt(1.0 + x[None] ** 2 + y[:, None] ** 2)
    return float(np.percentile((found.depth * ray)[mask], 5))


def _option(doc: Mapping[str, Any], said: str) -> str | None:
    if doc["template"] == "distance":
        away = float(said.removesuffix(" m"))
        middles = {name: math.sqrt(a * b) for name, a, b in zip(RANGE_NAMES, RANGES, RANGES[1:], strict=False)}
        return min(doc["options"], key=lambda name: abs(math.log(max(away, 0.1) / middles[name])))
    if doc["template"] == "count":
        return min(doc["options"], key=lambda name: abs(int(name) - int(said)))
    return chosen(said, doc["options"])
