"""Leafy lumps used by shrubs, pots and trees."""

from collections.abc import Sequence

import numpy as np

from .. import shapes
from ..mesh_builder import MeshBuilder
from ..palette import Color, mix
from ..shapes import Shape


def lump(
    radii: tuple[float, float, float], rng: np.random.Generator, segments: int = 9, rings: int = 6, rough: float = 0.16
) -> Shape:
    """A rough ellipsoid: every vertex moved in or out a little, so that it looks grown."""
    ball = shapes.ellipsoid((1.0, 1.0, 1.0), segments, rings)
    points, inverse = np.unique(np.round(ball.vertices, 6), axis=0, return_inverse=True)
    points = points * (1 + rng.normal(0, rough, (len(points), 1)).clip(-0.3, 0.3)) * np.asarray(radii)
    return Shape(points, inverse.reshape(-1)[ball.faces])


def leafy(
    builder: MeshBuilder, at: Sequence[float], radii: tuple[float, float, float], color: Color, rng: np.random.Generator,
    segments: int = 9, rings: int = 6, rough: float = 0.16,
) -> None:
    """A lump of leaves, darker below and lighter above, faceted like foliage."""
    shape = lump(radii, rng, segments, rings, rough)
    middle = shape.vertices[shape.faces].mean(1)[:, 2] / radii[2]
    tone = middle + rng.normal(0, 0.30, len(middle))
    bands = (
        (mix(color, "black", 0.42), tone < -0.35), (mix(color, "black", 0.2), (tone >= -0.35) & (tone < 0.05)),
        (color, (tone >= 0.05) & (tone < 0.5)), (mix(color, "#e8f0a0", 0.2), tone >= 0.5),
    )  # fmt: skip
    for paint, chosen in bands:
        if chosen.any():
            used, faces = np.unique(shape.faces[chosen], return_inverse=True)
            builder.add(Shape(shape.vertices[used], faces.reshape(-1, 3)), paint, at, crease_deg=10.0)


def potted_bush(
    builder: MeshBuilder, at: tuple[float, float, float], size: float, pot: Color, rng: np.random.Generator, color: Color = "leaf"
) -> None:
    """A pot `size` wide with a bush in it."""
    r = size / 2
    builder.lathe([(r * 0.68, 0), (r * 0.95, size * 0.75), (r, size * 0.75), (r, size * 0.85), (r * 0.8, size * 0.85)], at, pot, segments=12)
    top = (at[0], at[1], at[2] + size * 1.35)
    leafy(builder, top, (r * 1.2, r * 1.2, size * 0.62), color, rng, 8, 5)
