"""Brings a finished asset to the length, width and height of its kind."""

import numpy as np

from urbanverse_mjx.datatypes import ValidationError

from ...meshes.mesh_builder import BuiltAsset
from ...meshes.shapes import Point3

#: How far one axis may be stretched against another before round things look oval.
GREATEST_DISTORTION = 1.35


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
