"""Sizes of recipes without physics of their own: drawn for a share of the leaf's range, then fitted to it exactly."""

import dataclasses

import numpy as np
from scipy.spatial import ConvexHull

from ...categories.priors import FORMS, Range, prior
from ...meshes.mesh_builder import BuiltAsset

Size = tuple[float, float, float]
#: Where each variant lies in the range of (length, width, height): 0 the median, -1 the least, 1 the greatest.
SPREAD: tuple[Size, ...] = ((0.0, 0.0, 0.0), (-0.42, -0.34, -0.3), (0.3, 0.2, 0.24))


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


def fitted(built: BuiltAsset, leaf: str, size: Size) -> BuiltAsset:
    """The asset stretched so that its box is `size`; its volume is its hull's, or less where the form is hollow.

    Recipes draw nearly the right size, so that circles stay round; the fit takes up what eaves and steps add.
    """
    boxed = built.to_box(size)
    volume = float(ConvexHull(boxed.mesh.vertices).volume)
    return dataclasses.replace(boxed, volume=min(volume, FORMS[prior(leaf).form] * float(np.prod(size))))
