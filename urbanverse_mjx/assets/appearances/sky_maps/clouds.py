"""Clouds: heaps and rolls as a field of water in the air with light marched through it, veils and decks as sheets.

A field of cumulus clouds is a box of 16 km that repeats, 256 x 256 columns and a dozen levels. Its shape is fractal
noise warped by fractal noise, cut off at the wanted cover, flat below, bulging above. Sunlight is carried down level by
level along the sun's slant, which gives the amount of cloud between each place and the sun; multiple scattering is the
sum of two exponentials (Wrenninge 2013's octaves). Views march through the levels over a round earth, which gives the
perspective towards the horizon; far clouds fade into haze.
"""

import dataclasses

import numpy as np
from scipy import ndimage

from .. import noise
from .atmosphere import EARTH_RADIUS, henyey_greenstein

CELLS = 256


@dataclasses.dataclass(frozen=True)
class Heaps:
    """Clouds with bodies.

    cover: share of the box under cloud; base, thick: m; size: m of the largest heaps; rolls: 0 heaps to 1 flat rolls;
    density: extinction 1/m (cumulus 0.02-0.1).
    """

    cover: float
    base: float = 1_200.0
    thick: float = 900.0
    size: float = 4_000.0
    rolls: float = 0.0
    density: float = 0.03
    tile: float = 16_000.0
    levels: int = 12


@dataclasses.dataclass(frozen=True)
class Sheet:
    """Clouds without bodies: cover, greatest optical depth, height m, wind (rad) they are drawn out along, and how far
    (1 none, 6 mares' tails), size m of the largest features; even: 0 broken into strands to 1 a plain veil."""

    cover: float
    depth: float
    height: float = 9_000.0
    wind: float = 0.0
    drawn: float = 5.0
    size: float = 14_000.0
    even: float = 0.0


@dataclasses.dataclass(frozen=True)
class Light:
    """sun: (3,) sunlight; above, below: (3,) radiance of the sky and of the ground; direction: to the sun;
    haze: (3,) 1/m; far: (rows, columns, 3) what distance fades to."""

    sun: np.ndarray
    above: np.ndarray
    below: np.ndarray
    direction: np.ndarray
    haze: np.ndarray
    far: np.ndarray


def distance_to(sine: np.ndarray, height: np.ndarray | float) -> np.ndarray:
    """m along a ray of elevation `sine` to a layer over the round earth."""
    return -EARTH_RADIUS * sine + np.sqrt((EARTH_RADIUS * sine) ** 2 + 2 * EARTH_RADIUS * height + np.square(height))


def _fractal(rng: np.random.Generator, beta: float, waves: float) -> np.ndarray:
    return noise.periodic_noise(rng, CELLS, beta, waves).astype(np.float32)


def _warped(field: np.ndarray, rng: np.random.Generator, by: float, waves: float) -> np.ndarray:
    """`field` read at places moved by smooth noise, `by` in tiles."""
    line = (np.arange(CELLS) + 0.5) / CELLS
    u, w = np.meshgrid(line, line)
    return noise.sample(field, u + by * _fractal(rng, 3.5, waves), w + by * _fractal(rng, 3.5, waves)).astype(
        np.float32
    )


def grow(heaps: Heaps, rng: np.random.Generator) -> np.ndarray:
    """(levels, 256, 256) float32 water from 0 to 1."""
    waves = heaps.tile / heaps.size
    shape = _warped(_fractal(rng, 3.2 if heaps.thick > 1_500.0 else 2.7, waves), rng, 0.35 / waves * 0.25, waves)
    if heaps.rolls:
        line = (np.arange(CELLS) + 0.5) / CELLS
        u, w = np.meshgrid(line, line)
        across = round(waves)
        bend = 0.5 * _fractal(rng, 3.0, 1.0)
        turn = 2 * np.pi * (across * u + max(across // 3, 1) * w) + 2.2 * bend
        shape = (1 - 0.6 * heaps.rolls) * shape / shape.std() + heaps.rolls * np.sin(turn)
    level = np.quantile(shape[::3, ::3], 1.0 - heaps.cover)
    span = max(1.1 * float(shape.std()), float(np.quantile(shape[::3, ::3], 0.99) - level))
    inside = np.clip((shape - level) / span, -0.5, 1.0)
    lumps = [_fractal(rng, 2.9, waves * 2.0), _fractal(rng, 2.5, waves * 4.5)]
    top = np.clip(inside, 0.0, 1.0) ** (0.55 + 0.2 * heaps.rolls)
    # Lumps are as deep as they are wide, however tall the cloud.
    rough = min(1.0, 800.0 / heaps.thick)
    water = np.empty((heaps.levels, CELLS, CELLS), np.float32)
    for k in range(heaps.levels):
        z = (k + 0.5) / heaps.levels
        # Two flat noises slid over each other make one that changes with height.
        lump = np.roll(lumps[0], 3 * k, 0) + 0.7 * np.roll(lumps[1], -4 * k, 1)
        body = np.minimum((top - z) * 3.2, (inside + 0.10) * 4.0) + (0.20 + 0.50 * z) * rough * lump
        body = np.where(inside > -0.12, body, -1.0)
        water[k] = np.clip(body * 1.1, 0.0, 1.0) * min(1.0, 0.45 + 2.0 * z)
    return water


def _depth_to_sun(water: np.ndarray, heaps: Heaps, sun: np.ndarray) -> np.ndarray:
    """(levels, 256, 256) optical depth from each place to the sun."""
    sine = max(float(sun[2]), 0.16)  # lower suns light the sides; the slant is held at nine degrees
    step = heaps.thick / heaps.levels
    cell = heaps.tile / CELLS
    flat = np.hypot(sun[0], sun[1])
    slide = step * np.sqrt(1 - sine**2) / sine / cell * (np.array([sun[0], sun[1]]) / max(flat, 1e-9))
    depth = np.zeros_like(water)
    total = np.zeros_like(water[0])
    for k in range(len(water) - 1, -1, -1):
        own = water[k] * np.float32(heaps.density * step / sine)
        depth[k] = total + 0.5 * own
        # Seen from the level below, the cloud above stands nearer to the sun.
        total = _slid(total + own, slide)
    return depth


def _slid(field: np.ndarray, by: np.ndarray) -> np.ndarray:
    """`field` moved against (x, y) cells, wrapping; its slant over several cells blurs it."""
    for axis, amount in ((1, -by[0]), (0, -by[1])):
        whole = int(np.floor(amount))
        part = np.float32(amount - whole)
        field = (1 - part) * np.roll(field, whole, axis) + part * np.roll(field, whole + 1, axis)
    return field


def heap_clouds(
    image: np.ndarray, directions: np.ndarray, heaps: Heaps, light: Light, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Draws heaps over an image.

    Args:
      image: (rows, columns, 3) radiance behind.
      directions: (rows, columns, 3) unit, above the horizon.

    Returns:
      the image with clouds, and (rows, columns) share of light that passes.
    """
    water = grow(heaps, rng)
    depth = _depth_to_sun(water, heaps, light.direction)
    field = np.stack([water, depth], -1).reshape(-1, 2)
    sine = np.maximum(directions[..., 2], 1e-3).astype(np.float32)
    flat = np.maximum(np.hypot(directions[..., 0], directions[..., 1]), 1e-6)
    slope = (directions[..., :2] / flat[..., None]).astype(np.float32)
    cosine = directions @ light.direction
    forward = 4 * np.pi * (0.7 * henyey_greenstein(cosine, 0.55) + 0.3 * henyey_greenstein(cosine, -0.15))
    passed = np.ones(sine.shape, np.float32)
    gathered = np.zeros((*sine.shape, 2), np.float32)  # of sunlight, of skylight
    offset = rng.random(2).astype(np.float32) * CELLS
    # Its own generator: how fine the image is must not change the clouds.
    jitter = np.random.default_rng(0).random(sine.shape, dtype=np.float32)
    seen_at = np.zeros_like(passed)
    step = heaps.thick / heaps.levels
    # The path of a view within one level grows towards the horizon, up to a limit.
    crossed = np.minimum(step / sine, 12 * step).astype(np.float32)
    # Multiply scattered light came in from above: little of it under a low sun.
    deep = 0.34 * min(1.0, 0.15 + 2.5 * max(float(light.direction[2]), 0.0))
    for k in range(heaps.levels):
        at = distance_to(sine, heaps.base + (k + jitter) * step) * flat
        x = at * slope[..., 0] * (CELLS / heaps.tile) + offset[0]
        y = at * slope[..., 1] * (CELLS / heaps.tile) + offset[1]
        value = _bilinear(field, k, x.astype(np.float32), y.astype(np.float32))
        share = 1.0 - np.exp(-heaps.density * crossed * value[..., 0])
        tau = value[..., 1]
        lit = 0.40 * np.exp(-tau) * forward + 0.40 * np.exp(-0.20 * tau) + deep * np.exp(-0.05 * tau)
        taken = passed * share
        gathered[..., 0] += taken * lit
        gathered[..., 1] += taken * (0.35 + 0.65 * (k + 0.5) / heaps.levels)
        seen_at += taken * at
        passed *= 1.0 - share
    # The thrown steps leave grain of one pixel; no cloud has an edge as sharp as that.
    gathered, passed, seen_at = (_softened(part) for part in (gathered, passed, seen_at))
    covered = np.maximum(1.0 - passed, 1e-6)
    glow = gathered[..., :1] * light.sun / np.pi + gathered[..., 1:] * light.above
    glow += (covered - gathered[..., 1])[..., None] * light.below
    fade = np.exp(-(seen_at / covered)[..., None] * light.haze)
    cloud = glow * fade + covered[..., None] * light.far * (1.0 - fade)
    return image * passed[..., None] + cloud, passed


def _softened(field: np.ndarray) -> np.ndarray:
    """Blurred by a pixel; columns wrap around."""
    sigma = (1.0, 1.0, 0.0)[: field.ndim]
    return ndimage.gaussian_filter(field, sigma, mode=("nearest", "wrap", "nearest")[: field.ndim], truncate=2.5)


def _bilinear(field: np.ndarray, level: int, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """(..., 2) of a level at (x, y) in cells, wrapping."""
    x0, y0 = np.floor(x), np.floor(y)
    fx, fy = (x - x0)[..., None], (y - y0)[..., None]
    left, low = x0.astype(np.int32) & (CELLS - 1), y0.astype(np.int32) & (CELLS - 1)
    right, high = (left + 1) & (CELLS - 1), (low + 1) & (CELLS - 1)
    low, high = (low + level * CELLS) * CELLS, (high + level * CELLS) * CELLS
    upper = field[low + left] * (1 - fx) + field[low + right] * fx
    return upper * (1 - fy) + (field[high + left] * (1 - fx) + field[high + right] * fx) * fy


def sheet_depth(directions: np.ndarray, sheet: Sheet, rng: np.random.Generator) -> np.ndarray:
    """(rows, columns) vertical optical depth of a sheet along views."""
    sine = np.maximum(directions[..., 2], 1e-3)
    at = distance_to(sine, sheet.height)
    x, y = at * directions[..., 0], at * directions[..., 1]
    along = np.cos(sheet.wind) * x + np.sin(sheet.wind) * y
    across = np.cos(sheet.wind) * y - np.sin(sheet.wind) * x
    tile = sheet.size * 6
    coarse, mid, fine = (_fractal(rng, b, w) for b, w in ((3.0, 4.0), (2.2, 4.0), (1.9, 10.0)))
    u, w = along / tile / max(sheet.drawn / 2.0, 1.0), across / tile
    bend = noise.sample(coarse, u * 0.5, w * 0.5) * (0.07 - 0.045 * sheet.even)
    patches = noise.sample(coarse, u * 1.3 + 0.3, w * 1.3)
    strands = noise.sample(mid, u + bend, w * 1.6 + bend) + 0.6 * noise.sample(fine, u * 0.9 - bend, w * 2.3 + bend)
    value = patches * 0.9 + strands * 0.55
    level = np.quantile(value[::3, ::3], 1.0 - sheet.cover) if sheet.cover < 1 else float(value.min())
    broken = np.clip((value - level) / (1.6 * float(value.std())), 0.0, 1.0) ** 1.3
    broken = broken * (0.7 + 0.3 * np.tanh(strands))
    return sheet.depth * ((1 - sheet.even) * broken + sheet.even * (0.9 + 0.08 * value))


def sheet_clouds(
    image: np.ndarray, directions: np.ndarray, sheet: Sheet, light: Light, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Draws a thin sheet over an image: as `heap_clouds`."""
    sine = np.maximum(directions[..., 2], 0.02)
    slant = np.minimum(1.0 / sine, 4.0)
    depth = sheet_depth(directions, sheet, rng) * slant
    passed = np.exp(-depth)
    cosine = directions @ light.direction
    # Ice scatters forwards strongly, and a little to all sides.
    phase = 4 * np.pi * (0.6 * henyey_greenstein(cosine, 0.75) + 0.4 * henyey_greenstein(cosine, 0.0))
    shown = (1.0 - passed)[..., None]
    glow = shown * (light.sun / np.pi * (0.38 * np.minimum(phase, 8.0))[..., None] + light.above * 0.75)
    fade = np.exp(-np.minimum(distance_to(sine, sheet.height), 2e5)[..., None] * light.haze * 0.5)
    return image * passed[..., None] + glow * fade + shown * light.far * (1 - fade), passed
