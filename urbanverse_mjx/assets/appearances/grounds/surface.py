"""A surface during its generation (colour, height, roughness), and its conversion to maps and a lit image."""

import dataclasses

import numpy as np

from .... import srgb
from .board import Board, Field

#: Light of the images: half past ten on a fair day, from the upper left. Unit vector in (u, v, up).
_SUN = np.array([-0.45, 0.5, 0.74], np.float32)


@dataclasses.dataclass(frozen=True)
class Surface:
    """Attributes:
    colour: (size, size, 3) display sRGB in [0, 1].
    height: (size, size) m, 0 at the level of the walked-on top.
    roughness: (size, size) in [0, 1].
    joint: (size, size) in [0, 1], 1 where there is a joint or a crack: where dirt, moss, water and snow gather.
    unit: (size, size) int32 number of the brick, slab or stone; None where there are none.
    """

    colour: np.ndarray
    height: Field
    roughness: Field
    joint: Field
    unit: np.ndarray | None = None


def normals(height: Field, pixel: float) -> np.ndarray:
    """(size, size, 3) unit normals in (u, v, up): right, up the image, out of the ground; height and pixel in m."""
    du = (np.roll(height, -1, 1) - np.roll(height, 1, 1)) / (2 * pixel)
    # v grows against the rows.
    dv = (np.roll(height, 1, 0) - np.roll(height, -1, 0)) / (2 * pixel)
    n = np.stack([-du, -dv, np.ones_like(height)], -1)
    return n / np.linalg.norm(n, axis=-1, keepdims=True)


def eight_bits(values: np.ndarray) -> np.ndarray:
    return np.round(np.clip(values, 0.0, 1.0) * 255).astype(np.uint8)


def lit(colour: np.ndarray, normal: np.ndarray, roughness: Field) -> np.ndarray:
    """(h, w, 3) uint8 image of maps seen from above in sun and skylight.

    Diffuse light is Lambert's; what is smooth mirrors the sky by Schlick's approximation of Fresnel's law for water
    (0.02 at right angles) seen at 60 degrees, as a passer-by does.
    """
    linear = srgb.linear(colour)
    sun = np.maximum(normal @ _SUN, 0.0) / _SUN[2]
    light = 0.68 * sun[..., None] * np.array([1.03, 1.0, 0.95]) + 0.32 * normal[..., 2:] * np.array([0.92, 1.0, 1.1])
    mirrored = (0.02 + 0.98 * 0.5**5) * 3.0 * np.clip(1.0 - roughness / 0.5, 0.0, 1.0) ** 2
    # The mirror shows brighter sky where the surface tips towards the light.
    tipped = 0.55 + 1.5 * (normal[..., 1] - 0.6 * normal[..., 0])
    linear = linear * light + (mirrored * np.clip(tipped, 0.05, 3.0))[..., None] * np.array([0.82, 0.93, 1.05])
    return eight_bits(srgb.encoded(linear))


def shade_crevices(surface: Surface, board: Board, strength: float = 0.5) -> Surface:
    """Darkens parts below their surroundings, which receive less skylight."""
    around = board.blur(surface.height, 0.012)
    wide = board.blur(surface.height, 0.04)
    depth = np.clip((around - surface.height) / 0.006, 0, 1) * 0.6 + np.clip((wide - surface.height) / 0.02, 0, 1) * 0.4
    return dataclasses.replace(surface, colour=surface.colour * (1.0 - strength * depth)[..., None])
