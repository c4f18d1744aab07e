"""The last step of a recipe: what was drawn is brought to the size of its kind, in metres.

`size_of` gives a variant's size by the prior of its leaf; `made`, `varied` and `varied_cm` build a drawing and scale it
to a given size, `fitted` and `fitted_as` an asset that is built already.
"""

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull

from urbanverse_mjx.datatypes import ValidationError

from ...categories.priors import FORMS, Range, prior
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.shapes import Point3

Size = tuple[float, float, float]
#: Where each variant lies in the range of (length, width, height): 0 the median, -1 the least, 1 the greatest.
SPREAD: tuple[Size, ...] = ((0.0, 0.0, 0.0), (-0.42, -0.34, -0.3), (0.3, 0.2, 0.24))
#: Relative, to either side: how far copies of one product differ in a side, so that no two meshes are alike.
SIDE_JITTER = 0.012
#: The same of the whole of what has grown or is filled by hand: no two apples are alike, but the kind keeps its size.
WHOLE_JITTER = 0.015
#: Largest stretch of one axis relative to another without visibly oval round parts.
GREATEST_DISTORTION = 1.35


def _at(span: Range, share: float) -> float:
    """Between the median and an end of the range, on a logarithmic scale."""
    low, middle, high = span
    return float(middle * ((high if share > 0 else low) / middle) ** abs(share))


def size_of(leaf: str, variant: int, spread: tuple[Size, ...] = SPREAD) -> Size:
    """(x, y, z) extents in m of one variant of a leaf; x is the shorter side where the leaf's front is its long one."""
    row = prior(leaf)
    length, width, height = (
        _at(span, share) for span, share in zip((row.length, row.width, row.height), spread[variant], strict=True)
    )
    length, width = max(length, width), min(length, width)
    return (width, length, height) if row.front == "side" else (length, width, height)


def hull_volume(built: BuiltAsset) -> float:
    """m^3 of the convex hull, for forms whose open surface encloses no volume."""
    return float(ConvexHull(built.mesh.vertices).volume)


def made(
    b: MeshBuilder,
    words: str,
    size: Sequence[float | None] | np.ndarray,
    fill: float | None = None,
    /,
    **params: object,
) -> BuiltAsset:
    """The asset brought to `size`.

    Args:
      words: what it is, without a full stop.
      size: m along (x, y, z); None is scaled by the mean of the others.
      fill: for open skins, the share of the convex hull that counts as the volume; else the closed parts count.
      params: recorded in the index.
    """
    boxed = b.build(words, params).to_box(size)
    return boxed if fill is None else dataclasses.replace(boxed, volume=hull_volume(boxed) * fill)


def varied(
    b: MeshBuilder, rng: np.random.Generator, size: Size, description: str, style: str, jitter: float = SIDE_JITTER
) -> BuiltAsset:
    """The asset brought to size (x, y, z), m, give or take `jitter` of each side; params hold the style."""
    return made(b, description, np.asarray(size) * (1.0 + rng.uniform(-jitter, jitter, 3)), style=style)


def varied_cm(
    b: MeshBuilder,
    description: str,
    size_cm: Point3,
    rng: np.random.Generator,
    params: Mapping[str, Any] | None = None,
) -> BuiltAsset:
    """The asset brought to `size_cm` = (x, y, z), cm, the whole larger or smaller by up to `WHOLE_JITTER`."""
    size = 0.01 * np.asarray(size_cm, float) * rng.uniform(1 - WHOLE_JITTER, 1 + WHOLE_JITTER)
    return made(b, description, size, **(params or {}))


def fitted(built: BuiltAsset, size: Point3) -> BuiltAsset:
    """The asset scaled to a box.

    Args:
      size: (x, y, z) of the box, m; 0 along an axis keeps the mean scale of the others there.

    Raises:
      ValidationError: the axes' scales differ by more than `GREATEST_DISTORTION`.
    """
    scale = built.box_scale(size)
    if scale.max() / scale.min() > GREATEST_DISTORTION:
        raise ValidationError(
            f"{built.description!r}: found a box of {built.mesh.extent.round(2)} m to be fitted to {np.array(size)} m, "
            f"needed the same proportions within a factor of {GREATEST_DISTORTION}; draw the parts nearer to that size."
        )
    return built.scaled(scale)


def fitted_as(built: BuiltAsset, leaf: str, size: Size) -> BuiltAsset:
    """The asset stretched so that its box is `size`; its volume is its hull's, or less where the leaf's form is hollow.

    Recipes draw nearly the right size, so that circles stay round; the fit takes up what eaves and steps add.
    """
    boxed = built.to_box(size)
    return dataclasses.replace(boxed, volume=min(hull_volume(boxed), FORMS[prior(leaf).form] * float(np.prod(size))))
