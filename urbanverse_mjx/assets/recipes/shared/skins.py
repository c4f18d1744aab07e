"""Images that are wrapped round solids: skins of fruits, basket work, labels."""

from collections.abc import Sequence

import numpy as np
from PIL import Image

from ...meshes import paint
from ...meshes.mesh_builder import ImageLike, MeshBuilder
from ...meshes.palette import Color, rgb


def patch(
    b: MeshBuilder,
    image: ImageLike,
    radius: float | tuple[float, float],
    low: float,
    high: float,
    arc_deg: float = 150.0,
    facing_deg: float = 0.0,
) -> None:
    """A label bent round a standing vessel: radius (or that at its lower and upper edge), heights, degrees it covers.

    One that goes nearly round shows its image on the front and again on the back.
    """
    if arc_deg > 200:
        for turn_deg in (0, 180):
            patch(b, image, radius, low, high, arc_deg / 2, facing_deg + turn_deg)
        return
    columns = int(arc_deg / 12) + 2
    first, last = radius if isinstance(radius, tuple) else (radius, radius)
    turns = np.radians(facing_deg + np.linspace(-arc_deg / 2, arc_deg / 2, columns))
    rows = [
        np.stack([r * np.cos(turns), r * np.sin(turns), np.full(columns, z)], 1)
        for r, z in ((first, low), (last, high))
    ]
    b.sheet(np.stack(rows), image=image)


def skin(
    rng: np.random.Generator,
    colors: Sequence[Color],
    blush: Color | None = None,
    noise: float = 5.0,
    flecks: tuple[Color, int] | None = None,
    size: tuple[int, int] = (32, 48),
) -> np.ndarray:
    """(h, w, 3) image for `painted` shapes: colours from the bottom to the top, a blush on the front, flecks.

    Args:
      noise: standard deviation, 0-255.
      flecks: colour and number of single dots.
      size: (width, height) pixels.
    """
    width, height = size
    stops = np.array([rgb(c) for c in colors], float)
    at = np.linspace(0, len(stops) - 1, height)[::-1]
    column = np.stack([np.interp(at, np.arange(len(stops)), stops[:, k]) for k in range(3)], 1)
    image = np.repeat(column[:, None], width, 1)
    if blush is not None:
        share = np.clip(1.1 - 1.5 * np.linspace(0, 1, width), 0, 0.85)[None, :, None]
        image = image * (1 - share) + share * np.array(rgb(blush), float)
    image = image + rng.normal(0, noise, (height, width, 1))
    if flecks is not None:
        rows, columns = rng.integers(1, height - 1, flecks[1]), rng.integers(0, width, flecks[1])
        image[rows, columns] = rgb(flecks[0])
    return np.clip(image, 0, 255).astype(np.uint8)


def weave(first: Color, second: Color, size: int = 64, strand: int = 4) -> np.ndarray:
    """(size, size, 3) basket work: strands over and under in turn, darker where they dip."""
    y, x = np.mgrid[:size, :size]
    over = (x // (2 * strand) + y // strand) % 2 == 0
    depth = np.where(over, np.abs((x % (2 * strand)) / strand - 1), np.abs((y % strand) / strand * 2 - 1))
    base = np.where(over[..., None], np.array(rgb(first), float), np.array(rgb(second), float))
    return np.clip(base * (1.05 - 0.45 * depth[..., None]), 0, 255).astype(np.uint8)


def label(
    words: str,
    color: Color,
    ink: Color,
    size: tuple[int, int] = (64, 48),
    band: Color | None = None,
    bold: float = 0.03,
) -> Image.Image:
    """A printed label: words between two bands."""
    image, draw = paint.canvas(paint.smooth(size, 2), color)
    width, height = image.size
    if band is not None:
        draw.rectangle((0, 0, width, height * 0.14), fill=rgb(band))
        draw.rectangle((0, height * 0.86, width, height), fill=rgb(band))
    paint.text(draw, words, (width * 0.08, height * 0.22, width * 0.92, height * 0.78), ink, bold=bold)
    return paint.shrunk(image, size)
