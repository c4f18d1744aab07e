"""A small picture of leaves, for the bushes and hedges about buildings."""

import numpy as np

from ...meshes import paint
from ...meshes.palette import Color, mix


def small_leaves(color: Color, rng: np.random.Generator, size: int = 32) -> np.ndarray:
    """(size, size, 3): leaves, dark at the bottom of the picture and sunlit at its top (as `foliage.leafy` expects)."""
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
