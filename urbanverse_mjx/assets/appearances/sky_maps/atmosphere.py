"""Light in cloudless air: a spherical atmosphere of air molecules, haze and ozone, integrated numerically.

The model is that of Bruneton and Neyret 2008 ("Precomputed Atmospheric Scattering"), multiple scattering by Hillaire
2020 ("A Scalable and Production Ready Sky and Atmosphere Rendering Technique"): light scattered twice and more is
taken as isotropic, a geometric series f = L2 / (1 - fms) tabulated over height and sun height. Unlike the closed
formulas of Preetham 1999 and Hosek 2012, it holds for a sun at and below the horizon. Sunlight above the air is 1.
"""

import dataclasses
import itertools

import numpy as np
from scipy import ndimage

EARTH_RADIUS, AIR_TOP = 6_371_000.0, 60_000.0  # m
# Scattering of sea-level air, 13.558e-6 1/m at 550 nm (Bruneton 2017's re-implementation), falls as wavelength^-4. The
# wavelengths are where the display's red, green and blue lie: the usual 680, 550, 440 nm lie outside of what
# sRGB shows and turn twilight purple, for at 680 nm ozone takes less than at 550, which at 630 nm it does not.
WAVELENGTHS = np.array([630.0, 550.0, 455.0])
RAYLEIGH_SCATTERING = 13.558e-6 * (550.0 / WAVELENGTHS) ** 4
#: Ozone's absorption at the peak of a tent 10-40 km high, 1/m: 1.881e-6 at 550 nm (ibid.), and by the shape of the
#: Chappuis band (cross sections 3.6, 3.4 and 0.5e-21 cm2, from memory).
OZONE_ABSORPTION = 1.881e-6 * np.array([3.6, 3.4, 0.5]) / 3.4
#: m, scale heights: over these, the density of air molecules and of haze falls to 1/e.
RAYLEIGH_HEIGHT, MIE_HEIGHT = 8_000.0, 1_200.0
#: Share of the light that haze takes out of a ray which it scatters; it absorbs the rest.
MIE_ALBEDO = 0.9
#: Forward peak of haze (Henyey-Greenstein); urban aerosol 0.7-0.8.
MIE_ASYMMETRY = 0.76
#: Colour of sunlight above the air, relative to green (ASTM E-490).
SUNLIGHT = np.array([1.02, 1.0, 0.98])
#: Illuminance of the sun above the air, lx.
SUN_LUX = 133_100.0
#: Share of the light that the ground around reflects.
GROUND_ALBEDO = 0.2

#: Size of the tables: heights, and cosines of the angle from the zenith.
_NUM_HEIGHTS, _NUM_COSINES = 24, 192
_MIN_SUN_COSINE = -0.30  # cosine of the lowest sun in the tables
#: Optical depth of pure air at 550 nm; turbidity is what air with haze has more of (Linke's idea).
_AIR_DEPTH = 13.558e-6 * RAYLEIGH_HEIGHT


def henyey_greenstein(cosine: np.ndarray, g: float) -> np.ndarray:
    """1/sr; integrates to 1 over the sphere."""
    return (1 - g * g) / (4 * np.pi * (1 + g * g - 2 * g * cosine) ** 1.5)


@dataclasses.dataclass(frozen=True)
class Air:
    """Air of one turbidity with its tables.

    Attributes:
      haze: Mie scattering at the ground, 1/m.
      through: (_NUM_HEIGHTS, _NUM_COSINES, 3) share of sunlight that reaches a height from a direction.
      manifold: (_NUM_HEIGHTS, _NUM_COSINES, 3) light scattered more than once, 1/sr, for sunlight 1.
    """

    haze: float
    through: np.ndarray
    manifold: np.ndarray

    def sunlight(self, sine: float) -> np.ndarray:
        """(3,) sunlight at the ground on a surface that faces the sun, `sine` of its elevation."""
        return _look_up(self.through, np.array([0.0]), np.array([sine]))[0] * SUNLIGHT

    def extinction(self) -> np.ndarray:
        """(3,) 1/m at the ground: how fast far objects drown in haze."""
        return RAYLEIGH_SCATTERING + self.haze / MIE_ALBEDO


def build_air(turbidity: float) -> Air:
    """Air of a turbidity: the optical depth of air with haze over that of pure air; 1.5 clear, 3 haze, 6 smog."""
    haze = (turbidity - 1.0) * _AIR_DEPTH * MIE_ALBEDO / MIE_HEIGHT
    heights, cosines = np.meshgrid(
        _height_of(np.arange(_NUM_HEIGHTS)), _cosine_of(np.arange(_NUM_COSINES)), indexing="ij"
    )
    air = Air(haze, _through(heights, cosines, haze), np.zeros((_NUM_HEIGHTS, _NUM_COSINES, 3)))
    return dataclasses.replace(air, manifold=_manifold(air))


def clear_sky(air: Air, sines: np.ndarray, turns: np.ndarray, sun_sine: float) -> np.ndarray:
    """Radiance of the cloudless sky, (elevations, azimuths, 3).

    Args:
      sines: (elevations,) sines of elevation, > 0.
      turns: (azimuths,) rad away from the sun's azimuth.
      sun_sine: sine of the sun's elevation; may be below 0.
    """
    # The three parts vary slowly; only the phase functions are sharp. So they are integrated on a coarse grid.
    coarse_e = np.radians(90.0 * np.linspace(0.0, 1.0, 26) ** 2 + 0.05)
    coarse_t = np.linspace(0.0, np.pi, 13)
    parts = _march(air, np.sin(coarse_e)[:, None], coarse_t[None, :], sun_sine)
    elevation = np.arcsin(np.clip(sines, 0.0, 1.0))
    row = np.sqrt(np.clip((np.degrees(elevation) - 0.05) / 90.0, 0.0, 1.0)) * 25
    turn = np.abs((turns + np.pi) % (2 * np.pi) - np.pi)
    column = turn / np.pi * 12
    at = np.broadcast_arrays(row[:, None], column[None, :])
    molecules, haze, manifold = (
        np.stack([ndimage.map_coordinates(part[..., k], at, order=1, mode="nearest") for k in range(3)], -1)
        for part in parts
    )
    cos_e, sun_cos = np.cos(elevation)[:, None], np.sqrt(1 - sun_sine**2)
    cosine = cos_e * sun_cos * np.cos(turn)[None, :] + sines[:, None] * sun_sine
    phase_r = 3 / (16 * np.pi) * (1 + cosine**2)
    phase_m = henyey_greenstein(np.minimum(cosine, 0.9995), MIE_ASYMMETRY)
    return (molecules * phase_r[..., None] + haze * phase_m[..., None] + manifold) * SUNLIGHT


def _height_of(index: np.ndarray) -> np.ndarray:
    return AIR_TOP * (index / (_NUM_HEIGHTS - 1)) ** 2


def _cosine_of(index: np.ndarray) -> np.ndarray:
    return _MIN_SUN_COSINE + (1.0 - _MIN_SUN_COSINE) * (index / (_NUM_COSINES - 1)) ** 1.5


def _look_up(table: np.ndarray, height: np.ndarray, cosine: np.ndarray) -> np.ndarray:
    row = np.sqrt(np.clip(height / AIR_TOP, 0.0, 1.0)) * (_NUM_HEIGHTS - 1)
    column = np.clip((cosine - _MIN_SUN_COSINE) / (1.0 - _MIN_SUN_COSINE), 0.0, 1.0) ** (1 / 1.5) * (_NUM_COSINES - 1)
    return np.stack(
        [ndimage.map_coordinates(table[..., k], (row, column), order=1, mode="nearest") for k in range(3)], -1
    )


def _densities(height: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    height = np.maximum(height, 0.0)
    ozone = np.maximum(1.0 - np.abs(height - 25_000.0) / 15_000.0, 0.0)
    return np.exp(-height / RAYLEIGH_HEIGHT), np.exp(-height / MIE_HEIGHT), ozone


def _to_top(height: np.ndarray, cosine: np.ndarray) -> np.ndarray:
    r = EARTH_RADIUS + height
    return -r * cosine + np.sqrt(np.maximum(r * r * (cosine**2 - 1.0) + (EARTH_RADIUS + AIR_TOP) ** 2, 0.0))


def _along(height: np.ndarray, cosine: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """Height after `distance` along a ray."""
    r = EARTH_RADIUS + height
    return np.sqrt(r * r + distance**2 + 2 * r * cosine * distance) - EARTH_RADIUS


def _through(height: np.ndarray, cosine: np.ndarray, haze: float) -> np.ndarray:
    length = _to_top(height, cosine)
    edges = np.linspace(0.0, 1.0, 25) ** 2
    depth = np.zeros((*height.shape, 3))
    for near, far in itertools.pairwise(edges):
        air, dust, ozone = _densities(_along(height, cosine, length * (near + far) / 2))
        step = (length * (far - near))[..., None]
        depth += step * (
            air[..., None] * RAYLEIGH_SCATTERING
            + dust[..., None] * haze / MIE_ALBEDO
            + ozone[..., None] * OZONE_ABSORPTION
        )
    r = EARTH_RADIUS + height
    grazing = -np.sqrt(np.maximum(1.0 - (EARTH_RADIUS / r) ** 2, 0.0))
    # The sun's disc is half a degree wide: it sets gradually.
    seen = np.clip((cosine - grazing) / 0.0093 + 0.5, 0.0, 1.0)
    return np.exp(-depth) * seen[..., None]


def _manifold(air: Air) -> np.ndarray:
    """Hillaire's table: second-order light over one minus the share that is scattered on."""
    heights = _height_of(np.arange(_NUM_HEIGHTS))[::3]
    suns = _cosine_of(np.arange(_NUM_COSINES))[::8]
    # Directions over the sphere: 8 cosines of Gauss and Legendre; azimuths matter little to an isotropic mean.
    nodes, weights = np.polynomial.legendre.leggauss(8)
    h = heights[:, None, None]
    up = nodes[None, None, :]
    sun = suns[None, :, None]
    shape = np.broadcast_shapes(h.shape, up.shape, sun.shape)
    h, up, sun = (np.broadcast_to(a, shape) for a in (h, up, sun))
    length = _to_top(h, up)
    r = EARTH_RADIUS + h
    inside = r * r * (up**2 - 1.0) + EARTH_RADIUS**2
    hits = (up < 0) & (inside > 0)
    length = np.where(hits, -r * up - np.sqrt(np.maximum(inside, 0.0)), length)
    second, passed_on, clear = np.zeros((*shape, 3)), np.zeros((*shape, 3)), np.ones((*shape, 3))
    steps = 12
    for k in range(steps):
        distance, step = length * ((k + 0.5) / steps) ** 1.5, length * (((k + 1) / steps) ** 1.5 - (k / steps) ** 1.5)
        height = _along(h, up, distance)
        molecules, dust, ozone = (d[..., None] for d in _densities(height))
        scatter = molecules * RAYLEIGH_SCATTERING + dust * air.haze
        extinct = molecules * RAYLEIGH_SCATTERING + dust * air.haze / MIE_ALBEDO + ozone * OZONE_ABSORPTION
        lit = _look_up(air.through, height.ravel(), sun.ravel()).reshape(*shape, 3)
        here = clear * (1 - np.exp(-extinct * step[..., None])) / np.maximum(extinct, 1e-12)
        second += here * scatter * lit / (4 * np.pi)
        passed_on += here * scatter
        clear = clear * np.exp(-extinct * step[..., None])
    ground = _look_up(air.through, np.zeros(h.size), sun.ravel()).reshape(*shape, 3)
    bounce = hits[..., None] * clear * ground * np.maximum(sun, 0.0)[..., None] * GROUND_ALBEDO / np.pi
    second, passed_on = ((a * weights[:, None]).sum(-2) / 2 for a in (second + bounce, passed_on))
    coarse = second / (1.0 - np.minimum(passed_on, 0.95))
    zoom = ndimage.map_coordinates
    at = np.meshgrid(np.arange(_NUM_HEIGHTS) / 3.0, np.arange(_NUM_COSINES) / 8.0, indexing="ij")
    return np.stack([zoom(coarse[..., k], at, order=1, mode="nearest") for k in range(3)], -1)


def _march(air: Air, sine: np.ndarray, turn: np.ndarray, sun_sine: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Light scattered towards the ground by molecules, by haze (both without their phase functions) and manifold."""
    sine, turn = np.broadcast_arrays(sine, turn)
    cosine = np.sqrt(1 - sine**2)
    length = _to_top(np.zeros_like(sine), sine)
    toward = np.stack([cosine * np.cos(turn), cosine * np.sin(turn), sine], -1)
    sun = np.array([np.sqrt(1 - sun_sine**2), 0.0, sun_sine])
    shape = (*sine.shape, 3)
    totals = np.zeros(shape), np.zeros(shape), np.zeros(shape)
    clear = np.ones((*sine.shape, 3))
    edges = np.linspace(0.0, 1.0, 25) ** 2
    for near, far in itertools.pairwise(edges):
        distance, step = length * (near + far) / 2, (length * (far - near))[..., None]
        point = toward * distance[..., None] + np.array([0.0, 0.0, EARTH_RADIUS])
        radius = np.linalg.norm(point, axis=-1)
        height, local = radius - EARTH_RADIUS, (point @ sun) / radius
        molecules, dust, ozone = (d[..., None] for d in _densities(height))
        extinct = molecules * RAYLEIGH_SCATTERING + dust * air.haze / MIE_ALBEDO + ozone * OZONE_ABSORPTION
        fade = np.exp(-extinct * step)
        here = clear * (1 - fade) / np.maximum(extinct, 1e-12)
        lit = _look_up(air.through, height.ravel(), local.ravel()).reshape(*sine.shape, 3)
        more = _look_up(air.manifold, height.ravel(), local.ravel()).reshape(*sine.shape, 3)
        totals[0][...] += here * molecules * RAYLEIGH_SCATTERING * lit
        totals[1][...] += here * dust * air.haze * lit
        totals[2][...] += here * (molecules * RAYLEIGH_SCATTERING + dust * air.haze) * more
        clear = clear * fade
    return totals
