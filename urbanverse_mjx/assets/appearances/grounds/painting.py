"""Generates the maps (512 x 512 pixels) of a material from its record; takes about a third of a second."""

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
      record: record of the material.
      albedo: (512, 512, 3) uint8 sRGB.
      normal: (512, 512, 3) uint8, (n + 1) / 2 with x along u, y along v (up the image), z out of the ground.
      roughness: (512, 512) uint8, 255 is 1.
      height: (512, 512) float32 m, 0 at the level of the walked-on top.
      preview: (512, 512, 3) uint8, lit from above; the source of thumbnails.
    """

    record: GroundRecord
    albedo: np.ndarray
    normal: np.ndarray
    roughness: np.ndarray
    height: np.ndarray
    preview: np.ndarray


def paint_ground(uid: str) -> GroundMaps:
    """Generates the maps of a material, deterministically for a uid.

    Raises:
      ValidationError: no such material.
    """
    record, variant = find_ground(uid)
    board = drawing.Board(uid, record.tile_size_m)
    # A random tint, so that neighbours in the table differ.
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
