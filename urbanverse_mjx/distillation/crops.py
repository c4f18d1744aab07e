"""Crops of objects, ground and sky, and the descriptors of the graph that are computed from them."""

import dataclasses
import itertools
import pathlib
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from PIL import Image

from ..datatypes import GROUND_KINDS, Recording
from ..datatypes.recording import SKY
from .lifting import Views

#: Function from an image (H, W, 3) u8 and its mask (H, W) bool to a descriptor of at most 64 8-bit numbers.
Descriptor = Callable[[np.ndarray, np.ndarray], Sequence[int]]
#: Number of frames, evenly spaced over the trajectory, whose sky and ground are cropped.
KEPT_FRAMES = 8
#: Number of views of an object that are cropped, the largest first.
KEPT_VIEWS = 2


@dataclasses.dataclass(frozen=True)
class CropOptions:
    """Size limits and margins of crops; chosen manually.

    Attributes:
      min_patch: pixels; smaller patches of ground or sky are not kept.
      margin: pixels around a mask that a crop keeps.
    """

    min_patch: int = 400
    margin: int = 4


_OPTIONS = CropOptions()


@dataclasses.dataclass(frozen=True)
class Descriptors:
    """Descriptors of objects by number, of ground by kind, and of the sky."""

    objects: dict[int, tuple[int, ...]]
    ground: dict[str, tuple[int, ...]]
    sky: tuple[int, ...] | None


def collect(
    recording: Recording,
    views: Views,
    object_of_view: np.ndarray,
    names: dict[int, str],
    describers: dict[str, Descriptor],
    folder: pathlib.Path | None,
) -> Descriptors:
    """Cuts out crops, writes them (RGBA PNG with the mask as alpha) and computes their descriptors.

    Args:
      object: (n,) which object each view shows.
      names: of the objects that are kept.
      describers: for any of "object", "ground", "sky".
      folder: gets objects/, ground/ and sky/; None: no files are written.
    """
    best = _best_views(views, object_of_view, names)
    wanted = sorted({int(views.origin[v, 0]) for rows in best.values() for v in rows})
    by_frame: dict[int, list[tuple[int, int, int]]] = {f: [] for f in wanted}
    for t, rows in best.items():
        for k, view in enumerate(rows):
            by_frame[int(views.origin[view, 0])].append((t, k, int(views.origin[view, 1])))
    objects: dict[int, tuple[int, ...]] = {}
    for frame in wanted:
        image, masks = recording.rgb(frame), recording.masks(frame)
        for t, k, detection in by_frame[frame]:
            cut, mask = _cut(image, masks == detection)
            _write(folder, f"objects/{names[t]}_{k}.png", cut, mask)
            if k == 0 and "object" in describers:
                objects[t] = _bytes(describers["object"](cut, mask))
    ground, sky = _scenery(recording, describers, folder)
    return Descriptors(objects, ground, sky)


def _best_views(views: Views, object_of_view: np.ndarray, names: dict[int, str]) -> dict[int, np.ndarray]:
    """For each object the `KEPT_VIEWS` views with the most pixels; complete views come before those cut off by the
    image border."""
    rank = np.where(views.clipped.any(1), views.pixels // 4, views.pixels)
    order = np.lexsort((-rank, object_of_view))
    bounds = np.r_[0, np.flatnonzero(np.diff(object_of_view[order])) + 1, len(order)]
    spans = [order[a:b][:KEPT_VIEWS] for a, b in itertools.pairwise(bounds) if b > a]
    return {int(object_of_view[rows[0]]): rows for rows in spans if int(object_of_view[rows[0]]) in names}


def _scenery(
    recording: Recording, describers: dict[str, Descriptor], folder: pathlib.Path | None
) -> tuple[dict[str, tuple[int, ...]], tuple[int, ...] | None]:
    """Crops of ground and sky of `KEPT_FRAMES` frames; the largest of each kind is described."""
    chosen = np.unique(np.linspace(0, len(recording) - 1, min(KEPT_FRAMES, len(recording))).round().astype(int))
    largest: dict[str, tuple[int, np.ndarray, np.ndarray]] = {}
    for number, frame in enumerate(chosen.tolist()):
        image, surfaces = recording.rgb(frame), recording.surfaces(frame)
        patches: dict[str, np.ndarray] = {}
        if surfaces is None:
            # As in the paper where the sky's region is unknown: the upper half of the frame.
            patches["sky"] = np.arange(image.shape[0])[:, None] < np.full(image.shape[1], image.shape[0] // 2)
        else:
            patches |= {GROUND_KINDS[k]: surfaces == k for k in np.unique(surfaces) if 0 < k != SKY}
            patches["sky"] = surfaces == SKY
        for kind, mask in patches.items():
            if mask.sum() < _OPTIONS.min_patch:
                continue
            cut, inside = _cut(image, mask)
            _write(folder, f"{'sky' if kind == 'sky' else 'ground'}/{kind}_{number}.png", cut, inside)
            if kind not in largest or mask.sum() > largest[kind][0]:
                largest[kind] = int(mask.sum()), cut, inside
    descriptors: dict[str, tuple[int, ...]] = {}
    for kind, (_, cut, inside) in largest.items():
        role = "sky" if kind == "sky" else "ground"
        if role in describers:
            descriptors[kind] = _bytes(describers[role](cut, inside))
    return {k: x for k, x in descriptors.items() if k != "sky"}, descriptors.get("sky")


def _cut(image: np.ndarray, mask: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    rows, columns = np.flatnonzero(mask.any(1)), np.flatnonzero(mask.any(0))
    where = tuple(slice(max(0, int(i[0]) - _OPTIONS.margin), int(i[-1]) + 1 + _OPTIONS.margin) for i in (rows, columns))
    return image[where], mask[where]


def _write(folder: pathlib.Path | None, name: str, image: np.ndarray, mask: np.ndarray) -> None:
    if folder is not None:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        Image.fromarray(np.dstack([image, np.where(mask, 255, 0).astype(np.uint8)])).save(path)


def _bytes(values: Any) -> tuple[int, ...]:
    return tuple(int(x) for x in values)
