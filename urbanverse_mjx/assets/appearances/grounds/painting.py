"""Painting a material: its record becomes maps of 512 x 512 pixels (about a third of a second)."""

import dataclasses

import numpy as np

from . import board as drawing
from .surface import eight_bits, lit, normals, shade_crevices
from .table import GroundRecord, find_ground
from .weathering import CONDITIONS


@dataclasses.dataclass(frozen=True)
class GroundMaps:
    """A tileable set of maps; rows run against v, columns along u.

    Attributes:
      record: what it is of.
      albedo: (512, 512, 3) uint8 sRGB.
      normal: (512, 512, 3) uint8, (n + 1) / 2 with x along u, y along v (up the image), z out of the ground.
      roughness: (512, 512) uint8, 255 is 1.
      height: (512, 512) float32 m, 0 at the top of what one walks on.
      preview: (512, 512, 3) uint8, lit from above: what thumbnails are cut from.
    """

    record: GroundRecord
    albedo: np.ndarray
    normal: np.ndarray
    roughness: np.ndarray
    height: np.ndarray
    preview: np.ndarray


def paint_ground(uid: str) -> GroundMaps:
    """Paints a material; the same uid gives the same maps.

    Raises:
      ValidationError: no such material.
    """
    record, variant = find_ground(uid)
    board = drawing.Board(uid, record.tile_size_m)
    # Two neighbours in the table are not cast from the same batch.
    batch = 1.0 + board.rng.uniform(-0.04, 0.04) + board.rng.uniform(-0.015, 0.015) * np.array([1.0, 0.0, -1.0])
    surface = variant.make(board)
    surface = dataclasses.replace(surface, colour=surface.colour * batch.astype(np.float32))
    surface = shade_crevices(CONDITIONS[record.condition].apply(surface, board, record.family), board)
    normal = normals(surface.height, board.pixel)
    albedo, roughness = eight_bits(surface.colour), eight_bits(surface.roughness)
    return GroundMaps(
        record=record,
        albedo=albedo,
        normal=eight_bits(normal * 0.5 + 0.5),
        roughness=roughness,
        height=surface.height.astype(np.float32),
        preview=lit(albedo / 255.0, normal, roughness / 255.0),
    )
