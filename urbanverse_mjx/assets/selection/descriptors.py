"""Appearance descriptor of an object: 61 8-bit numbers, 44 for colours, 16 for the silhouette, 1 for its aspect.

It is computed from an image and its mask, or from a record's parameters (the tinted visible colours of its base shape
under the light of the thumbnails), so that matching needs no rendering. It is the format of the `descriptor` of a scene
graph's object.
"""

import dataclasses
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from urbanverse_mjx.datatypes import ValidationError

from ..meshes.base_shapes import CELLS, GRID, BaseShape
from ..meshes.tints import hsv, tinted

HUES, VALUES, GREYS = 12, 3, 8
COLORS = HUES * VALUES + GREYS
LAYOUT = CELLS * CELLS
SIZE = COLORS + LAYOUT + 1
# Saturation below which a colour counts as grey, and above which it counts as coloured; in between, it is shared.
_MAX_GREY_SATURATION, _MIN_COLOUR_SATURATION = 0.10, 0.28
# Range of the aspect's byte in octaves of width over height, 2^-4 to 2^4.
_ASPECT_SPAN = 8.0
#: Weights of the three parts of the distance, chosen on renders of 300 records of leaves other than the reported ones.
WEIGHTS = (1.0, 0.6, 0.6)


def histogram(colors: NDArray, share: NDArray) -> NDArray[np.float64]:
    """(..., 44) colour histogram of the visible surface with linear interpolation between bins.

    Args:
      colors: (..., C, 3), 0-255.
      share: (..., C), sums to 1.
    """
    hue, saturation, value = hsv(colors)
    colored = np.clip((saturation - _MAX_GREY_SATURATION) / (_MIN_COLOUR_SATURATION - _MAX_GREY_SATURATION), 0.0, 1.0)
    low_h, part_h = _split(hue * HUES)
    low_v, part_v = _split(np.clip(value * VALUES - 0.5, 0.0, VALUES - 1.0))
    low_g, part_g = _split(np.clip(value * GREYS - 0.5, 0.0, GREYS - 1.0))
    shape = colors.shape[:-2]
    flat = np.zeros((int(np.prod(shape, dtype=np.int64)), COLORS))
    rows = np.broadcast_to(np.arange(len(flat)).reshape(*shape, 1), colors.shape[:-1])
    for dh in (0, 1):
        weight_h = part_h if dh else 1.0 - part_h
        for dv in (0, 1):
            weight = share * colored * weight_h * (part_v if dv else 1.0 - part_v)
            column = ((low_h + dh) % HUES) * VALUES + np.minimum(low_v + dv, VALUES - 1)
            np.add.at(flat, (rows, column), weight)
    for dg in (0, 1):
        weight = share * (1.0 - colored) * (part_g if dg else 1.0 - part_g)
        np.add.at(flat, (rows, HUES * VALUES + np.minimum(low_g + dg, GREYS - 1)), weight)
    return flat.reshape(*shape, COLORS)


def _split(position: NDArray) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    low = np.floor(position)
    return low.astype(np.int64), position - low


def of_image(image: NDArray, mask: NDArray | None = None) -> NDArray[np.uint8]:
    """(61,) the descriptor of a crop.

    Args:
      image: (H, W, 3) uint8.
      mask: (H, W) true on the object; None for the whole image.

    Raises:
      ValidationError: the shapes are wrong, or the mask is empty.
    """
    image = np.asarray(image)
    mask = np.ones(image.shape[:2], bool) if mask is None else np.asarray(mask, bool)
    if image.ndim != 3 or image.shape[2] != 3 or mask.shape != image.shape[:2] or not mask.any():
        raise ValidationError(
            f"crop: found an image {image.shape} and a mask {mask.shape} with {int(mask.sum())} pixels, "
            "needed (H, W, 3) and (H, W) with at least one."
        )
    rows, columns = np.flatnonzero(mask.any(1)), np.flatnonzero(mask.any(0))
    inner = mask[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    seen = image[mask].astype(np.float64)
    colors = histogram(seen[None], np.full((1, len(seen)), 1.0 / len(seen)))[0]
    height, width = inner.shape
    pick_r, pick_c = ((np.arange(GRID) + 0.5) / GRID * n for n in (height, width))
    small = inner[pick_r.astype(np.int64)][:, pick_c.astype(np.int64)].astype(np.float64)
    step = GRID // CELLS
    layout = small.reshape(CELLS, step, CELLS, step).mean((1, 3)).ravel()
    return np.concatenate([_bytes(np.sqrt(colors)), _bytes(layout), _aspect_byte(np.array([width / height]))])


@dataclasses.dataclass(frozen=True)
class DescriptorTable:
    """Descriptors of n records, computed from their parameters.

    Attributes:
      colors: (n, 44) square roots of the shares.
      layouts: (n, V, 16) and aspects: (n, V) per view, in [0, 1].
    """

    colors: NDArray[np.float64]
    layouts: NDArray[np.float64]
    aspects: NDArray[np.float64]

    def distances(self, query: Sequence[int] | NDArray) -> NDArray[np.float64]:
        """(n,) distance to a descriptor: Hellinger distance of the colours, plus the least silhouette distance over the
        views.

        Raises:
          ValidationError: the query is not such a descriptor.
        """
        wanted = np.asarray(query, dtype=np.float64)
        if wanted.shape != (SIZE,):
            raise ValidationError(
                f"descriptor: found {wanted.shape} numbers, needed ({SIZE},) as `of_image` makes them."
            )
        wanted = wanted / 255.0
        colors = np.sqrt(np.maximum(1.0 - self.colors @ wanted[:COLORS], 0.0))
        layout = np.abs(self.layouts - wanted[COLORS : COLORS + LAYOUT]).mean(-1)
        aspect = np.abs(self.aspects - wanted[-1]) * _ASPECT_SPAN
        outline = WEIGHTS[1] * layout + WEIGHTS[2] * np.minimum(aspect, 1.0)
        return WEIGHTS[0] * colors + outline.min(-1)


def of_records(
    leaf_free: NDArray, shapes: Sequence[BaseShape], which: NDArray, tint: NDArray, scale: NDArray
) -> DescriptorTable:
    """Descriptors of records.

    Args:
      leaf_free: (n,) whether tints are applied in full to the record's leaf.
      shapes: base shapes.
      which: (n,) index of each record's base shape.
      tint: (n, 3).
      scale: (n, 3); ones for a base shape itself, whose tint is neutral.
    """
    most = max(len(s.share) for s in shapes)
    colors, share, light, paint = (np.zeros((len(shapes), most, k)) for k in (3, 1, 1, 1))
    for k, shape in enumerate(shapes):
        count = len(shape.share)
        colors[k, :count], share[k, :count, 0] = shape.colors, shape.share
        light[k, :count, 0], paint[k, :count, 0] = shape.light, shape.paint
    full = (paint[which, :, 0] > 0) & np.asarray(leaf_free, bool)[:, None]
    shown = tinted(colors[which], tint[:, None], True, full) * light[which]
    found = histogram(np.clip(shown, 0.0, 255.0), share[which, :, 0])
    layouts = np.stack([s.layouts for s in shapes])[which] / 255.0
    stretch = np.sqrt(scale[:, 0] * scale[:, 1]) / scale[:, 2]
    aspects = np.stack([s.aspects for s in shapes])[which] * stretch[:, None]
    return DescriptorTable(np.sqrt(found), layouts, _aspect(aspects))


def _aspect(ratio: NDArray) -> NDArray[np.float64]:
    return np.clip(np.log2(ratio) / _ASPECT_SPAN + 0.5, 0.0, 1.0)


def _aspect_byte(ratio: NDArray) -> NDArray[np.uint8]:
    return _bytes(_aspect(ratio))


def _bytes(values: NDArray) -> NDArray[np.uint8]:
    return np.floor(np.clip(values, 0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)
