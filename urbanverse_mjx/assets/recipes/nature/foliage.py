"""Leafy lumps used by trees, shrubs and pots: rough balls whose every facet shows a bit of leafy texture."""

from collections.abc import Sequence

import numpy as np
from PIL import Image, ImageDraw

from ...meshes import paint, shapes
from ...meshes.mesh_builder import MeshBuilder
from ...meshes.palette import Color, mix, rgb
from ...meshes.shapes import Shape

LEAF_SIZE = 96


def leaf_image(color: Color, rng: np.random.Generator, flowers: Color | None = None, grain: float = 1.0) -> np.ndarray:
    """(96, 96, 3): leaves, in shade at the bottom of the image and in the sun at its top."""
    image = Image.new("RGB", (LEAF_SIZE * 4, LEAF_SIZE * 4), mix(color, "black", 0.5))

    pen = ImageDraw.Draw(image)
    side = LEAF_SIZE * 4
    shaded, sunlit = mix(color, "black", 0.36), mix(color, "#f4f6b8", 0.36)
    for _ in range(2600):
        x, y = rng.random(2) * side
        light = 1 - y / side
        tone = mix(shaded, sunlit, min(max(float(light + rng.normal(0, 0.22)), 0.0), 1.0))
        if flowers is not None and rng.random() < 0.22:
            tone = mix(flowers, "black", 0.35 * (1 - light))
        r, a = grain * float(rng.uniform(6, 12)), float(rng.random() * np.pi)
        dx, dy = r * np.cos(a), r * np.sin(a)
        pen.polygon(
            [(x - dx, y - dy), (x + dy * 0.45, y - dx * 0.45), (x + dx, y + dy), (x - dy * 0.45, y + dx * 0.45)],
            fill=rgb(tone),
        )
    return np.asarray(image.resize((LEAF_SIZE, LEAF_SIZE), Image.Resampling.LANCZOS))


def small_leaves(color: Color, rng: np.random.Generator, size: int = 32) -> np.ndarray:
    """(size, size, 3): leaves, dark at the bottom of the image and sunlit at its top (as `foliage.leafy` expects)."""
    side = 4 * size
    image, pen = paint.canvas((side, side), mix(color, "black", 0.5))
    tones = [mix(mix(color, "black", 0.36), mix(color, "#f4f6b8", 0.36), k / 7) for k in range(8)]
    count = 340
    places, lights = rng.random((count, 2)) * side, rng.normal(0, 0.2, count)
    turns, lengths = rng.random(count) * np.pi, rng.uniform(0.045, 0.085, count) * side
    for (x, y), noise, a, r in zip(places, lights, turns, lengths, strict=True):
        tone = tones[int(np.clip((1 - y / side + noise) * 8, 0, 7))]
        dx, dy = r * np.cos(a), r * np.sin(a)
        pen.polygon(
            [(x - dx, y - dy), (x + dy * 0.45, y - dx * 0.45), (x + dx, y + dy), (x - dy * 0.45, y + dx * 0.45)], tone
        )
    return np.asarray(paint.shrunk(image, (size, size)))


def lump(
    radii: tuple[float, float, float], rng: np.random.Generator, segments: int = 8, rings: int = 5, rough: float = 0.15
) -> Shape:
    """A rough ellipsoid: every vertex moved in or out a little, so that it looks grown."""
    ball = shapes.ellipsoid((1.0, 1.0, 1.0), segments, rings)
    points, inverse = np.unique(np.round(ball.vertices, 6), axis=0, return_inverse=True)
    points = points * (1 + rng.normal(0, rough, (len(points), 1)).clip(-0.32, 0.32)) * np.asarray(radii)
    return Shape(points, inverse.reshape(-1)[ball.faces])


def leafy(
    builder: MeshBuilder,
    at: Sequence[float] | np.ndarray,
    radii: tuple[float, float, float],
    image: np.ndarray,
    rng: np.random.Generator,
    segments: int = 8,
    rings: int = 5,
    rough: float = 0.15,
    light: float = 0.5,
) -> None:
    """A lump of leaves centred on `at`; `light` in [0, 1] is how sunny the place is within its plant."""
    shape = lump(radii, rng, segments, rings, rough)
    corners = shape.vertices[shape.faces]
    level = corners.mean(1)[:, 2] / radii[2]
    v = np.clip(0.28 + 0.42 * light + 0.26 * level + rng.normal(0, 0.05, len(level)), 0.12, 0.88)
    u = rng.uniform(0.12, 0.88, len(level))
    turn = rng.random(len(level)) * 2 * np.pi
    angle = turn[:, None] + np.array([0.0, 2.1, 4.2])
    uv = np.stack([u[:, None] + 0.19 * np.cos(angle), v[:, None] + 0.13 * np.sin(angle)], -1).reshape(-1, 2)
    faces = np.arange(len(corners) * 3).reshape(-1, 3)
    builder.add(Shape(corners.reshape(-1, 3), faces, np.clip(uv, 0, 1)), at=tuple(at), image=image)


def potted_bush(
    builder: MeshBuilder,
    at: tuple[float, float, float],
    size: float,
    pot: Color,
    rng: np.random.Generator,
    color: Color = "leaf",
) -> None:
    """A pot `size` wide with a bush in it."""
    r = size / 2
    builder.lathe(
        [(r * 0.68, 0), (r * 0.95, size * 0.75), (r, size * 0.75), (r, size * 0.85), (r * 0.8, size * 0.85)],
        at,
        pot,
        segments=12,
    )
    image = _small(leaf_image(color, rng))
    leafy(builder, (at[0], at[1], at[2] + size * 1.35), (r * 1.2, r * 1.2, size * 0.62), image, rng, 8, 5)


def _small(image: np.ndarray) -> np.ndarray:
    """The image at 32 x 32, for assets whose texture is full."""
    return np.asarray(Image.fromarray(image).resize((32, 32), Image.Resampling.LANCZOS))
