"""Generates a sky from its record: an equirectangular image of radiance and a sun (about a third of a second)."""

import dataclasses
import itertools

import numpy as np

from .... import srgb
from .. import noise
from .atmosphere import MIE_ALBEDO, RAYLEIGH_SCATTERING, SUN_LUX, Air, build_air, clear_sky
from .clouds import Heaps, Light, Sheet, heap_clouds, sheet_clouds, sheet_depth
from .land import add_land
from .table import SkyRecord, find_sky, unit_to_sun

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # Rec. 709
#: Rows of the image by default; twice as many columns.
HEIGHT = 256
#: Elevation (degrees) below which rows are supersampled, because a row spans kilometres there, and the supersampling
#: factor.
_HORIZON_ELEVATION, _HORIZON_SUPERSAMPLING = 10.0, 3
#: Half the angle of the sun's and the moon's disc, rad.
DISC_RADIUS = np.radians(0.2666)
#: Full moon against the sun in lux: 0.25 over 133,000; and the sky glow over a city, cd/m2 against a clear day's
#: radiance unit: at the horizon some 0.02 cd/m2, at the zenith 0.004 (bright urban sky, Bortle 8-9).
MOON_RADIANCE = 0.25 / SUN_LUX
GLOW_COLOUR = np.array([1.0, 0.70, 0.42])
_ZENITH_GLOW, _HORIZON_GLOW = 0.006 / SUN_LUX, 0.030 / SUN_LUX


@dataclasses.dataclass(frozen=True)
class SkyMap:
    """A painted sky. Radiances are scaled to an image: a white surface in the open is `record.exposure` bright.

    Attributes:
      record: record of the sky.
      radiance: (height, 2 height, 3) float32 linear RGB without the sun's disc; rows from zenith to nadir, column 0
        at yaw -π growing counter-clockwise.
      sun_direction: (3,) unit to the sun (the moon at night); below the horizon at dawn and dusk.
      sun_irradiance: (3,) on a surface that faces the sun, after clouds, in the unit of π · radiance.
      lux_per_unit: illuminance in lux of one unit of irradiance.
    """

    record: SkyRecord
    radiance: np.ndarray
    sun_direction: np.ndarray
    sun_irradiance: np.ndarray
    lux_per_unit: float


def _rows(height: int) -> tuple[np.ndarray, np.ndarray]:
    """Elevations (rad) of the rows of the upper half, low ones several times, and how many belong to each row."""
    half = height // 2
    edges = 90.0 - np.arange(half + 1) * 90.0 / half
    elevations, counts = [], []
    for top, bottom in itertools.pairwise(edges):
        count = _HORIZON_SUPERSAMPLING if top <= _HORIZON_ELEVATION else 1
        elevations += [top + (bottom - top) * (i + 0.5) / count for i in range(count)]
        counts.append(count)
    return np.radians(elevations), np.array(counts)


def _heaps(record: SkyRecord, rng: np.random.Generator) -> Heaps | None:
    vary = rng.uniform(0.88, 1.12, 3)
    cover = min(record.cover * float(vary[0]), 0.97)
    base, size = 1_250.0 * float(vary[1]), float(vary[2])
    return {
        "few_cumulus": Heaps(cover, base, 450.0, 2_800.0 * size),
        "scattered_cumulus": Heaps(cover, base, 750.0, 3_800.0 * size),
        "broken_cumulus": Heaps(cover, base, 900.0, 4_600.0 * size),
        "towering_cumulus": Heaps(cover, base * 0.9, 2_300.0, 7_000.0 * size, density=0.04, levels=14),
        "cumulus_under_cirrus": Heaps(cover * 0.7, base, 700.0, 3_600.0 * size),
        "stratocumulus": Heaps(cover, base, 420.0, 3_000.0 * size, 0.35, 0.025),
        "closed_stratocumulus": Heaps(cover, base * 0.9, 480.0, 3_400.0 * size, 0.3, 0.03),
        "mackerel": Heaps(cover, 3_600.0, 260.0, 900.0 * size, 0.45, 0.008, tile=14_000.0),
        "rain": Heaps(0.50, 550.0, 350.0, 3_000.0 * size, 0.0, 0.006),
    }.get(record.weather)


def _sheet(record: SkyRecord, rng: np.random.Generator) -> Sheet | None:
    wind = float(rng.uniform(0, np.pi))
    return {
        "cirrus": Sheet(record.cover, 0.55, 9_500.0, wind, 3.6),
        "cumulus_under_cirrus": Sheet(0.40, 0.45, 9_500.0, wind, 6.0),
        "veil": Sheet(1.0, 0.28, 8_500.0, wind, 4.0, even=0.85),
        "towering_cumulus": Sheet(0.25, 0.30, 9_500.0, wind, 4.0),
        "scattered_cumulus": Sheet(0.15, 0.25, 10_000.0, wind, 6.0),
    }.get(record.weather)


def _deck(
    clear: np.ndarray, directions: np.ndarray, record: SkyRecord, light: Light, rng: np.random.Generator
) -> tuple[np.ndarray, float]:
    """A closed layer: the gradation of the CIE standard overcast sky (ISO 15469: zenith three times the horizon) with
    soft folds; thin ones let the sun through as a pale glow. Returns the sky and the share of sunlight left."""
    sine = directions[..., 2]
    low = {"thin_overcast": 4_500.0, "overcast": 1_200.0, "rain": 1_000.0, "mist": 250.0}[record.weather]
    folds = sheet_depth(directions, Sheet(1.0, 1.0, low, float(rng.uniform(0, 3)), 2.0, low * 3.0, 1.0), rng) - 0.9
    contrast = {"thin_overcast": 0.9, "overcast": 1.1, "rain": 1.6, "mist": 0.25}[record.weather]
    fade = np.exp(-(sine**-1) * 0.10) if record.weather != "mist" else np.ones_like(sine) * 0.5
    folds = np.tanh(folds * contrast * 1.6) * fade
    passes = {"thin_overcast": 0.62, "overcast": 0.35, "rain": 0.16, "mist": 0.45}[record.weather]
    sun = light.sun * max(float(light.direction[2]), 0.12)
    grey = (sun / np.pi + light.above * 0.9) * passes
    # Drops whiten what passes through them.
    grey = 0.6 * float(grey @ LUMINANCE) + 0.4 * grey
    gradation = (1 + 2 * sine) / 3 if record.weather != "mist" else 0.75 + 0.25 * sine
    sky = grey * (gradation * (1.0 + folds))[..., None]
    if record.weather == "thin_overcast":
        cosine = np.clip(directions @ light.direction, -1.0, 1.0)
        angle = np.degrees(np.arccos(cosine))
        glow = 1.9 * np.exp(-angle / 9.0) + 0.7 * np.exp(-angle / 30.0) + 14.0 * np.exp(-((angle / 0.9) ** 2))
        risen = np.clip(float(unit_to_sun(record)[2]) / 0.05, 0.0, 1.0)
        sky = sky + light.sun / np.pi * 0.28 * risen * (glow * (1 + 0.6 * folds))[..., None]
        return sky * 0.93 + clear * 0.07, 0.06
    return sky, 0.0


def _night(directions: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Moonless part of a city's night: lamp light scattered back by the air, strongest low down, and a few stars."""
    sine = directions[..., 2]
    height = _ZENITH_GLOW + (_HORIZON_GLOW - _ZENITH_GLOW) * np.exp(-sine / 0.22)
    yaw = np.arctan2(directions[..., 1], directions[..., 0])
    centre = rng.uniform(-np.pi, np.pi)
    height = height * (1.0 + 0.35 * np.cos(yaw - centre) * (1 - sine))
    stars = np.random.default_rng(1).random(sine.shape)
    bright = np.where(stars > 0.9985, (stars - 0.9985) / 0.0015, 0.0) ** 3 * 0.25 / SUN_LUX * np.clip(sine * 1.6, 0, 1)
    blue = np.array([0.30, 0.42, 0.75]) * 0.002 / SUN_LUX
    return height[..., None] * GLOW_COLOUR + blue + bright[..., None]


def _halo(directions: np.ndarray, sun: np.ndarray) -> np.ndarray:
    """Extra brightness of the 22 degree halo: sharp and reddish inside, soft outside."""
    angle = np.degrees(np.arccos(np.clip(directions @ sun, -1.0, 1.0)))[..., None]
    edge = angle - np.array([21.6, 21.9, 22.3])
    return np.where(edge < 0, np.exp(-((edge / 0.5) ** 2)), np.exp(-edge / 2.2)) * 0.35


def paint_sky(uid: str, height: int = HEIGHT) -> SkyMap:
    """Generates a sky, deterministically for a uid and height.

    Args:
      height: rows, a multiple of 4.

    Raises:
      ValidationError: no such sky.
    """
    record = find_sky(uid)
    rng = noise.generator(f"sky_maps/painting/{uid}")
    sun = unit_to_sun(record)
    elevations, counts = _rows(height)
    yaw = -np.pi + (np.arange(2 * height) + 0.5) / (2 * height) * 2 * np.pi
    cosine, sine = np.cos(elevations)[:, None], np.sin(elevations)
    directions = np.stack(
        [cosine * np.cos(yaw), cosine * np.sin(yaw), np.broadcast_to(sine[:, None], (len(sine), len(yaw)))], -1
    )
    air = build_air(record.turbidity)
    clear = clear_sky(air, sine, yaw - np.radians(record.sun_azimuth), float(sun[2]))
    direct = air.sunlight(float(sun[2]))
    night = record.time == "night"
    if night:
        clear, direct = clear * MOON_RADIANCE + _night(directions, rng), direct * MOON_RADIANCE
    sky, passed = _weather(clear, direct, directions, record, air, sun, rng)
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
    sky = np.add.reduceat(sky, starts, axis=0) / counts[:, None, None]
    return _developed(sky, direct * passed, sun, record, noise.generator(f"sky_maps/land/{uid}"))


def _weather(
    clear: np.ndarray, direct: np.ndarray, directions: np.ndarray, record: SkyRecord, air: Air, sun: np.ndarray,
    rng: np.random.Generator,
) -> tuple[np.ndarray, float]:  # fmt: skip
    """The sky with its clouds, and the share of sunlight that passes them."""
    night = record.time == "night"
    weight = (directions[..., 2] * np.cos(np.arcsin(directions[..., 2])))[..., None]
    above = (clear * weight).sum((0, 1)) / weight.sum()
    ground = 0.45 if record.snow else 0.18
    below = ground * (direct * max(float(sun[2]), 0.0) / np.pi + above)
    if night:  # lamps light clouds from below
        below = below + GLOW_COLOUR * 0.022 / SUN_LUX
    far = _distance_colour(clear, record.cover)
    haze = (RAYLEIGH_SCATTERING + 0.7 * air.haze / MIE_ALBEDO) * 1.6
    # High clouds are still lit by a sun that has just set.
    lit = air.sunlight(max(float(sun[2]), 0.0) + 0.02) if not night else direct
    late = float(np.clip((np.degrees(np.arcsin(sun[2])) + 5.0) / 5.0, 0.0, 1.0))
    light = Light(lit * late, above, below, _raised(sun), haze, far)
    sky, passed = clear, 1.0
    sheet = _sheet(record, rng)
    if sheet is not None:
        sky, _ = sheet_clouds(sky, directions, sheet, light, rng)
        passed *= 1.0 - 0.25 * sheet.cover
        if record.weather == "veil" and not night:
            sky = sky * (1.0 + _halo(directions, light.direction) * np.clip(float(sun[2]) * 8, 0, 1))
    if record.kind == "overcast":
        sky, through = _deck(sky, directions, record, light, rng)
        if night:
            sky = sky + GLOW_COLOUR * 0.02 / SUN_LUX * (0.6 + 0.8 * np.exp(-directions[..., 2:] / 0.25))
        passed *= through
    heaps = _heaps(record, rng)
    if heaps is not None:
        if record.kind == "overcast":
            light = dataclasses.replace(light, far=np.broadcast_to(sky[-6:].mean((0, 1)), sky.shape))
        if record.weather == "rain":
            # Scud below the deck: lit by the deck alone, so it is grey and darker.
            dim = 0.45 * sky[len(sky) // 2 :].mean((0, 1))
            light = dataclasses.replace(light, sun=np.zeros(3), above=dim, below=dim * 0.5)
        sky, _ = heap_clouds(sky, directions, heaps, light, rng)
        passed *= 1.0 - 0.85 * heaps.cover if heaps.cover > 0.5 else 1.0 - 0.25 * heaps.cover
    return sky, passed


def _distance_colour(clear: np.ndarray, cover: float) -> np.ndarray:
    """The colour of far objects, as `clear`: the light of the air low over the horizon, less where clouds shade it."""
    low = clear[-3:].mean(0, keepdims=True)
    mean = low.mean(1, keepdims=True)
    return np.broadcast_to((0.3 * np.minimum(low, 3.0 * mean) + 0.7 * mean) * (1.0 - 0.5 * cover), clear.shape)


def _raised(sun: np.ndarray) -> np.ndarray:
    """Direction of the light at cloud height, some two degrees higher than at the ground; never below the horizon."""
    sine = max(float(sun[2]) + 0.02, 0.02)
    flat = sun[:2] / max(float(np.hypot(*sun[:2])), 1e-9) * np.sqrt(1 - sine**2)
    return np.array([*flat, sine])


def _irradiance(sky: np.ndarray) -> np.ndarray:
    """(3,) on the ground from the upper half of a panorama."""
    half, columns = sky.shape[:2]
    edges = np.sin(np.radians(90.0 - np.arange(half + 1) * 90.0 / half)) ** 2 / 2
    return (sky.sum(1) * ((edges[:-1] - edges[1:]) * 2 * np.pi / columns)[:, None]).sum(0)


def _developed(
    sky: np.ndarray, sunlight: np.ndarray, sun: np.ndarray, record: SkyRecord, rng: np.random.Generator
) -> SkyMap:
    """Adds the land, and exposes and balances the image as a camera would."""
    # Images show walls as well as ground: exposure treats a low sun as one at 20 degrees.
    facing = max(float(sun[2]), 0.35) if sun[2] > 0 else 0.0
    total = _irradiance(sky) + sunlight * facing
    luminance = float(total @ LUMINANCE)
    # Cameras take only part of the light's colour away, least of a sunset's.
    kept = 0.65 if record.sun_elevation > 12 or record.kind == "overcast" else 0.85
    if record.time == "night":
        kept = 0.9
    factor = record.exposure * np.pi / luminance * (total / luminance) ** (kept - 1.0)
    light = _irradiance(sky) + sunlight * max(float(sun[2]), 0.0)
    dark = record.time in ("night", "dusk", "dawn")
    lamps = (1.6 if record.time == "night" else 0.5 * dark) * luminance / np.pi
    thick = {"mist": 3.5, "rain": 1.6, "smog": 2.4, "hazy": 1.5, "crisp": 0.7}.get(record.weather, 1.0)
    panorama = add_land(sky, record.horizon, record.season, record.snow, light, thick, lamps, rng)
    return SkyMap(
        record=record,
        radiance=(np.maximum(panorama, 0.0) * factor).astype(np.float32),
        sun_direction=sun.astype(np.float32),
        sun_irradiance=(sunlight * factor).astype(np.float32),
        lux_per_unit=float(SUN_LUX / (factor @ LUMINANCE)),
    )


def with_disc(sky: SkyMap) -> np.ndarray:
    """The radiance with the sun's (or moon's) disc drawn in: what a photograph shows; as `radiance`."""
    image = sky.radiance.copy()
    height, width = image.shape[:2]
    if sky.sun_direction[2] <= 0:
        return image
    polar = (np.arange(height)[:, None] + 0.5) * np.pi / height
    yaw = (np.arange(width)[None, :] + 0.5) * 2 * np.pi / width - np.pi
    x, y, z = sky.sun_direction
    cosine = np.sin(polar) * (np.cos(yaw) * x + np.sin(yaw) * y) + np.cos(polar) * z
    # A disc smaller than a pixel is spread over a spot of pixel size that holds the same light.
    spot = max(DISC_RADIUS, 0.75 * np.pi / height)
    cover = np.exp(-2.0 * (1.0 - cosine) / spot**2)
    weight = (cover * np.sin(polar)).sum() * (np.pi / height) * (2 * np.pi / width)
    return image + (cover / weight)[..., None].astype(np.float32) * sky.sun_irradiance


def preview(radiance: np.ndarray, gain: float = 2.0) -> np.ndarray:
    """uint8 sRGB of radiances, exposed for the sky: a film's shoulder 1 - exp(-gain x) keeps bright places."""
    shown = 1.0 - np.exp(-gain * np.maximum(radiance, 0.0))
    return np.round(srgb.encoded(shown) * 255).astype(np.uint8)
