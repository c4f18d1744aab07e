"""Images of kerb stones, gutters, covers and paving for the blind, 64 pixels a side or 128 along."""

import functools
from collections.abc import Callable

import numpy as np

from ...assets.appearances import noise

_SIZE = 64
#: m along the border of one repetition of an image; across it, its width in m where that is not the strip's.
LENGTHS: dict[str, float] = {}
WIDTHS: dict[str, float] = {"concrete gutter": 0.3, "setts gutter": 0.3}
_IMAGES: dict[str, Callable[[np.random.Generator], np.ndarray]] = {}

Colour = tuple[float, float, float]


def _stones(*colours: Colour, grain: float = 0.05, worn: float = 0.0) -> Callable[[np.random.Generator], np.ndarray]:
    """A row of stones of these colours with a dark joint between them; paint on them is worn off in spots."""

    def paint(rng: np.random.Generator) -> np.ndarray:
        n = len(colours)
        image = np.zeros((_SIZE, _SIZE * n, 3))
        for k, colour in enumerate(colours):
            image[:, k * _SIZE : (k + 1) * _SIZE] = colour
            image[:, k * _SIZE : k * _SIZE + 2] *= 0.55
        for k in range(n):
            part = slice(k * _SIZE, (k + 1) * _SIZE)
            spots = noise.periodic_noise(rng, _SIZE, 1.2)
            image[:, part] *= (1 + grain * spots)[..., None]
            if worn:
                bare = np.clip((spots - np.quantile(spots, 1 - worn)) * 2, 0, 1)[..., None]
                image[:, part] = image[:, part] * (1 - bare) + 0.5 * bare
        return image

    return paint


def _gutter(rng: np.random.Generator) -> np.ndarray:
    image = np.full((_SIZE, 2 * _SIZE, 3), (0.53, 0.525, 0.51))
    image *= (1 + 0.06 * np.hstack([noise.periodic_noise(rng, _SIZE, 1.2), noise.periodic_noise(rng, _SIZE, 1.2)]))[
        ..., None
    ]
    image[:, :2] *= 0.6
    image[-2:] *= 0.7
    dirt = np.linspace(0.8, 1.0, _SIZE) ** 0.7  # against the kerb
    return image * dirt[::-1, None, None]


def _setts(rng: np.random.Generator) -> np.ndarray:
    image = np.full((_SIZE, 2 * _SIZE, 3), (0.5, 0.49, 0.475))
    for row in range(2):
        for k in range(7):
            rows, columns = slice(row * 32 + 2, row * 32 + 31), slice(int(k * 128 / 7) + 1, int((k + 1) * 128 / 7) - 1)
            image[rows, columns] *= 1 + 0.16 * rng.standard_normal()
    mask = np.zeros(image.shape[:2], bool)
    mask[[0, 1, 31, 32, 63]] = True
    mask[:, [int(k * 128 / 7) for k in range(7)]] = True
    image[mask] = (0.25, 0.24, 0.23)
    return image


def _domes(colour: Colour) -> Callable[[np.random.Generator], np.ndarray]:
    """A paving stone of 30 cm with five rows of domes."""

    def paint(rng: np.random.Generator) -> np.ndarray:
        image = np.full((_SIZE, _SIZE, 3), colour) * (1 + 0.04 * noise.periodic_noise(rng, _SIZE, 1.0))[..., None]
        y, x = (np.mgrid[0:_SIZE, 0:_SIZE] + 0.5) / _SIZE * 5 % 1.0 - 0.5
        away = np.hypot(x, y)
        image *= (1 + 0.14 * (away < 0.26) - 0.22 * ((away >= 0.26) & (away < 0.36)))[..., None]
        image[:1] *= 0.6
        image[:, :1] *= 0.6
        return image

    return paint


def _cover(rng: np.random.Generator) -> np.ndarray:
    y, x = (np.mgrid[0:_SIZE, 0:_SIZE] + 0.5) / _SIZE * 2 - 1
    away = np.hypot(x, y)
    image = (
        np.full((_SIZE, _SIZE, 3), (0.25, 0.24, 0.235)) * (1 + 0.1 * noise.periodic_noise(rng, _SIZE, 1.0))[..., None]
    )
    ribs = ((np.floor((x + 1) * 7) + np.floor((y + 1) * 7)) % 2 == 0) & (away < 0.72)
    image[ribs] *= 1.35
    image[(away > 0.78) & (away < 0.84)] *= 0.45
    image[away > 0.93] = (0.36, 0.36, 0.35)
    return image


def _gully(rng: np.random.Generator) -> np.ndarray:
    image = (
        np.full((_SIZE, _SIZE, 3), (0.29, 0.28, 0.27)) * (1 + 0.1 * noise.periodic_noise(rng, _SIZE, 1.0))[..., None]
    )
    for k in range(6):
        image[8:-8, 6 + 9 * k : 10 + 9 * k] = 0.05
    return image


def _register(name: str, length: float, paint: Callable[[np.random.Generator], np.ndarray]) -> None:
    LENGTHS[name] = length
    _IMAGES[name] = paint


_GREY, _GRANITE, _BASALT = (0.60, 0.595, 0.575), (0.63, 0.62, 0.61), (0.33, 0.33, 0.335)
_BLACK, _WHITE, _YELLOW, _RED = (0.10, 0.10, 0.10), (0.86, 0.86, 0.83), (0.86, 0.66, 0.12), (0.66, 0.14, 0.12)
_register("concrete kerb", 1.0, _stones(_GREY))
_register("granite kerb", 1.2, _stones(_GRANITE, grain=0.09))
_register("basalt kerb", 0.8, _stones(_BASALT, grain=0.08))
_register("yellow kerb", 1.0, _stones(_YELLOW, worn=0.25))
_register("white kerb", 1.0, _stones(_WHITE, worn=0.3))
_register("black white kerb", 1.6, _stones(_BLACK, _WHITE, worn=0.12))
_register("black yellow kerb", 1.6, _stones(_BLACK, _YELLOW, worn=0.1))
_register("red white kerb", 1.6, _stones(_RED, _WHITE, worn=0.15))
_register("concrete gutter", 2.0, _gutter)
_register("setts gutter", 1.05, _setts)
_register("yellow tactile", 0.3, _domes((0.84, 0.66, 0.14)))
_register("white tactile", 0.3, _domes((0.74, 0.73, 0.70)))
_register("red tactile", 0.3, _domes((0.58, 0.24, 0.20)))
_register("cover", 0.64, _cover)
_register("gully", 0.42, _gully)
WIDTHS |= {name: 0.3 for name in LENGTHS if name.endswith("tactile")}


@functools.cache
def paint_image(name: str) -> tuple[np.ndarray, float]:
    """Image (H, W, 3) u8, its first row at the greatest v, and its roughness."""
    image = _IMAGES[name](noise.generator(f"roads/{name}"))
    rough = 0.6 if name in ("cover", "gully") else 0.85
    return np.round(np.clip(image, 0.0, 1.0) * 255).astype(np.uint8), rough
