"""Procedural skies: linear HDR panoramas without the sun's disc, and the sun as a directional light.

Clear air is single scattering through a spherical atmosphere (Rayleigh and Mie, exponential density, ozone-free),
integrated numerically for red, green and blue; grey skies follow the gradation of the CIE standard overcast sky
(ISO 15469: zenith three times the horizon). Clouds are a wrapping noise field on a plane overhead.
Everything is then scaled so that a white diffuse surface in the open is about 0.6-1.0 bright on a display.
"""

import dataclasses
import functools
import itertools

import numpy as np

from ...datatypes import validation as v
from . import noise, sky_maps

HEIGHT, WIDTH = 64, 128

# Bucholtz 1995 (Rayleigh at sea level) at 680, 550, 440 nm, 1/m; scale heights of the standard atmosphere, m.
RAYLEIGH_SCATTERING = np.array([5.8e-6, 13.6e-6, 33.1e-6])
RAYLEIGH_HEIGHT = 8_000.0
MIE_HEIGHT = 1_200.0
EARTH_RADIUS = 6_371_000.0
AIR_TOP = 60_000.0
#: Colour of sunlight above the air, relative to green (ASTM E-490 spectrum at the three wavelengths).
SUNLIGHT = np.array([1.02, 1.0, 1.0])
#: Multiply scattered light as a share of the mean first-order radiance, and its growth with haze (1/m).
MULTIPLE_SCATTERING, MULTIPLE_IN_HAZE = 0.5, 4e4
MAX_RADIANCE = 5.0
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # Rec. 709
#: Supersampling factor of clouds.
CLOUD_SUPERSAMPLING = 3


@dataclasses.dataclass(frozen=True)
class Sky:
    """Light sources of a scene: sky and sun.

    Attributes:
      id, description, tags: for search and matching.
      radiance: (64, 128, 3) float32 linear HDR; rows from zenith to nadir, column 0 at yaw -π growing
        counter-clockwise; the sun's disc is not in it.
      sun_direction: (3,) float32 unit, from the ground to the sun (yaw 0 at +x).
      sun_irradiance: (3,) float32 on a surface that faces the sun, same unit as π · radiance.
    """

    id: str
    description: str
    tags: tuple[str, ...]
    radiance: np.ndarray
    sun_direction: np.ndarray
    sun_irradiance: np.ndarray


@dataclasses.dataclass(frozen=True)
class _Weather:
    """Parameters of a sky.

    elevation, azimuth: of the sun, degrees; mie: aerosol scattering at the ground, 1/m (2e-6 crystal clear,
    2e-5 ordinary, 1e-4 haze); diffuse: share of the light that comes from the cloudless sky (measured under clear
    air 0.15-0.25, haze 0.5-0.7); cover: share of the sky under clouds; density: how opaque they are;
    overcast: share of a closed grey layer; exposure: brightness of a white surface; tint: of the clouds;
    kept_colour: cameras balance white, but not wholly: the illuminant's colour is kept to this power.
    """

    description: str
    tags: tuple[str, ...]
    elevation: float
    azimuth: float
    mie: float
    diffuse: float
    cover: float = 0.0
    density: float = 1.0
    overcast: float = 0.0
    exposure: float = 0.85
    tint: tuple[float, float, float] = (1.0, 1.0, 1.0)
    cloud_scale: float = 1.0
    kept_colour: float = 0.55


_WEATHER: dict[str, _Weather] = {
    "clear_noon": _Weather("Cloudless deep blue sky with a high sun", ("clear", "noon", "blue"), 62, 35, 6e-6, 0.22),
    "clear_morning": _Weather(
        "Clear pale blue morning sky with a sun of medium height", ("clear", "morning", "blue"), 28, -70, 1.2e-5, 0.27
    ),
    "clear_afternoon": _Weather(
        "Clear afternoon with a few fair-weather clouds",
        ("clear", "afternoon", "few clouds"),
        42,
        120,
        1e-5,
        0.25,
        0.18,
        0.8,
    ),
    "golden_hour": _Weather(
        "Warm golden light of a low sun and long shadows",
        ("golden", "evening", "warm"),
        10,
        155,
        1.4e-5,
        0.34,
        0.2,
        0.7,
        tint=(1.05, 0.97, 0.88),
        kept_colour=0.75,
    ),
    "sunset": _Weather(
        "Orange and pink sky, the sun at the horizon",
        ("sunset", "evening", "orange"),
        4.0,
        -165,
        1.5e-5,
        0.55,
        0.45,
        0.8,
        exposure=0.75,
        tint=(1.0, 0.74, 0.68),
        kept_colour=0.95,
    ),
    "partly_cloudy": _Weather(
        "Blue sky with white cumulus clouds", ("partly cloudy", "cumulus", "day"), 50, -30, 8e-6, 0.25, 0.42, 1.0
    ),
    "broken_clouds": _Weather(
        "Large broken clouds with blue gaps, soft sun",
        ("cloudy", "broken clouds", "day"),
        46,
        75,
        1e-5,
        0.28,
        0.66,
        1.0,
        overcast=0.15,
        cloud_scale=1.1,
    ),
    "overcast_bright": _Weather(
        "Bright white overcast, no shadows",
        ("overcast", "bright", "soft"),
        48,
        10,
        2e-5,
        0.3,
        0.6,
        0.5,
        overcast=0.9,
        exposure=0.9,
    ),
    "overcast_grey": _Weather(
        "Dull grey overcast sky of a rainy day",
        ("overcast", "grey", "rain"),
        35,
        -110,
        2e-5,
        0.3,
        0.75,
        1.0,
        overcast=1.0,
        exposure=0.65,
        tint=(0.93, 0.97, 1.03),
        cloud_scale=1.3,
    ),
    "hazy": _Weather("Milky hazy sky with a pale sun", ("hazy", "smog", "milky"), 36, 60, 7e-5, 0.6, exposure=0.8),
    "winter_morning": _Weather(
        "Cold low winter sun with high thin cloud",
        ("winter", "morning", "cold"),
        14,
        -40,
        1e-5,
        0.36,
        0.5,
        0.4,
        exposure=0.75,
        tint=(0.97, 0.99, 1.04),
        cloud_scale=2.0,
    ),
}


def sky_ids() -> tuple[str, ...]:
    """Ids of all skies, in a fixed order."""
    return tuple(_WEATHER)


def _directions(finer: int = 1) -> np.ndarray:
    """(64, 128, 3) · finer unit vector of every pixel's centre."""
    height, width = HEIGHT * finer, WIDTH * finer
    polar = (np.arange(height) + 0.5) / height * np.pi
    yaw = -np.pi + (np.arange(width) + 0.5) / width * 2 * np.pi
    sin = np.sin(polar)[:, None]
    return np.stack(
        [sin * np.cos(yaw), sin * np.sin(yaw), np.broadcast_to(np.cos(polar)[:, None], (height, width))], -1
    )


def _solid_angles() -> np.ndarray:
    """(64, 1) solid angle of a pixel of each row, sr."""
    edges = np.cos(np.arange(HEIGHT + 1) / HEIGHT * np.pi)
    return ((edges[:-1] - edges[1:]) * 2 * np.pi / WIDTH)[:, None]


def _to_top(origin: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """Distance (m) from points inside the air to its top along unit directions; (..., 3) from the earth's centre."""
    b = (origin * direction).sum(-1)
    c = (origin * origin).sum(-1) - (EARTH_RADIUS + AIR_TOP) ** 2
    return -b + np.sqrt(np.maximum(b * b - c, 0.0))


def _depths(origin: np.ndarray, direction: np.ndarray, steps: int = 16) -> tuple[np.ndarray, np.ndarray]:
    """Columns of Rayleigh and Mie air (m of sea-level air) from points (..., 3) to the top of the air."""
    length = _to_top(origin, direction)
    # Midpoints crowd near the start, where the air is dense.
    edges = np.linspace(0.0, 1.0, steps + 1) ** 2
    rayleigh, mie = np.zeros(length.shape), np.zeros(length.shape)
    for near, far in itertools.pairwise(edges):
        point = origin + direction * (length * (near + far) / 2)[..., None]
        height = np.maximum(np.linalg.norm(point, axis=-1) - EARTH_RADIUS, 0.0)
        step = length * (far - near)
        rayleigh += np.exp(-height / RAYLEIGH_HEIGHT) * step
        mie += np.exp(-height / MIE_HEIGHT) * step
    return rayleigh, mie


def _transmittance(rayleigh: np.ndarray, mie: np.ndarray, beta_mie: float) -> np.ndarray:
    """(..., 3) share of light left after columns of air; Mie extinction is scattering / 0.9."""
    return np.exp(-(rayleigh[..., None] * RAYLEIGH_SCATTERING + mie[..., None] * beta_mie / 0.9))


def _clear(directions: np.ndarray, sun: np.ndarray, beta_mie: float) -> tuple[np.ndarray, np.ndarray]:
    """Radiance of a cloudless sky and the sunlight at the ground, for sunlight 1 above the air.

    Args:
      directions: (n, 3) unit, upper half.
      sun: (3,) unit.
      beta_mie: 1/m.

    Returns:
      ((n, 3), (3,)).
    """
    ground = np.array([0.0, 0.0, EARTH_RADIUS + 10.0])
    length = _to_top(np.broadcast_to(ground, directions.shape), directions)
    cosine = directions @ sun
    phase_rayleigh = 3 / (16 * np.pi) * (1 + cosine**2)
    g = 0.76  # forward peak of continental aerosol (Henyey-Greenstein)
    phase_mie = (1 - g * g) / (4 * np.pi * (1 + g * g - 2 * g * np.minimum(cosine, 0.985)) ** 1.5)
    edges = np.linspace(0.0, 1.0, 25) ** 2.5
    total, isotropic = np.zeros((len(directions), 3)), np.zeros((len(directions), 3))
    column = [np.zeros(len(directions)), np.zeros(len(directions))]
    for near, far in itertools.pairwise(edges):
        point = ground + directions * (length * (near + far) / 2)[:, None]
        height = np.maximum(np.linalg.norm(point, axis=-1) - EARTH_RADIUS, 0.0)
        step = length * (far - near)
        density = np.exp(-height / RAYLEIGH_HEIGHT), np.exp(-height / MIE_HEIGHT)
        to_sun = _depths(point, np.broadcast_to(sun, point.shape))
        half = [c + d * step / 2 for c, d in zip(column, density, strict=True)]
        reach = _transmittance(half[0] + to_sun[0], half[1] + to_sun[1], beta_mie)
        air = (density[0] * step)[:, None] * RAYLEIGH_SCATTERING
        dust = (density[1] * step)[:, None] * np.full(3, beta_mie)
        total += reach * (air * phase_rayleigh[:, None] + dust * phase_mie[:, None])
        isotropic += _transmittance(half[0], half[1], beta_mie) * (air + dust) / (4 * np.pi)
        column = [c + d * step for c, d in zip(column, density, strict=True)]
    lift = total.mean(0) * 4 * np.pi * (MULTIPLE_SCATTERING + MULTIPLE_IN_HAZE * beta_mie)
    direct = _transmittance(*(np.asarray(x) for x in _depths(ground, sun)), beta_mie=beta_mie)
    return (total + isotropic * lift) * SUNLIGHT, direct * SUNLIGHT


def _clouds(directions: np.ndarray, weather: _Weather, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Opacity and inner thickness in [0, 1] of the clouds along (n, 3) directions."""
    rng = noise.generator(f"clouds/{name}")
    field = noise.periodic_noise(rng, 256, beta=3.2, lowest=2.0)
    detail = noise.periodic_noise(rng, 256, beta=2.2, lowest=8.0)
    up = np.maximum(directions[:, 2], 0.0) + 0.12  # a curved layer: the pattern stays finite at the horizon
    u, w = directions[:, 0] / up * 0.11 / weather.cloud_scale, directions[:, 1] / up * 0.11 / weather.cloud_scale
    value = noise.sample(field, u, w) + 0.28 * noise.sample(detail, u * 1.7, w * 1.7)
    # The noise is close to normal: its quantile gives the wanted cover.
    threshold = np.quantile(value, 1.0 - weather.cover) if weather.cover > 0 else np.inf
    thickness = np.clip((value - threshold) / 1.5, 0.0, 1.0)
    # Distant clouds fade into the air in front of them.
    near = np.clip(directions[:, 2] / 0.22, 0.0, 1.0) ** 0.7
    opacity = weather.density * np.clip(thickness * 3.0, 0.0, 1.0) * near
    return opacity, thickness


def _irradiance(sky: np.ndarray) -> np.ndarray:
    """(3,) on the ground from the upper half (32, 128, 3) of a panorama."""
    half = HEIGHT // 2
    return (sky * _directions()[:half, :, 2:] * _solid_angles()[:half, :, None]).sum((0, 1))


def _cloudless(sun: np.ndarray, weather: _Weather) -> tuple[np.ndarray, np.ndarray]:
    """Upper half (32, 128, 3) of the panorama and sunlight (3,), with the measured share of diffuse light."""
    upper = _directions()[: HEIGHT // 2].reshape(-1, 3)
    sky, direct = _clear(upper, sun, weather.mie)
    sky = sky.reshape(HEIGHT // 2, WIDTH, 3)
    # Exposure assumes a sun at 20 degrees or higher, because images show walls as well as ground.
    from_sun = float(direct @ LUMINANCE) * max(float(sun[2]), 0.35)
    from_sky = float(_irradiance(sky) @ LUMINANCE)
    return sky * (weather.diffuse / (1 - weather.diffuse) * from_sun / from_sky), direct


def _compose(sun: np.ndarray, weather: _Weather, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Upper half sky (32, 128, 3) with clouds, and the sunlight (3,) that passes them."""
    half = HEIGHT // 2
    clear, direct = _cloudless(sun, weather)
    ambient = _irradiance(clear) / np.pi
    light = direct * max(float(sun[2]), 0.35) / np.pi
    directions = _directions(CLOUD_SUPERSAMPLING)[: half * CLOUD_SUPERSAMPLING].reshape(-1, 3)
    fine = np.repeat(np.repeat(clear, CLOUD_SUPERSAMPLING, 0), CLOUD_SUPERSAMPLING, 1).reshape(-1, 3)
    opacity, thickness = _clouds(directions, weather, name)
    toward = np.clip(directions @ sun, 0.0, 1.0)
    # Thin edges let sunlight through, most towards the sun; thick cores are grey below.
    lit = light * (1.0 - 0.8 * thickness + 0.8 * toward**12 * (1 - thickness))[:, None] + ambient
    sky = fine * (1 - opacity[:, None]) + lit * weather.tint * opacity[:, None]
    grey = np.full(3, float((light + ambient).mean())) * weather.tint
    gradation = (1 + 2 * np.clip(directions[:, 2], 0.0, 1.0)) / 3
    texture = 1.0 - 0.30 * weather.density * thickness + 0.5 * (1 - weather.density) * toward**6
    sky = sky * (1 - weather.overcast) + grey * (gradation * texture)[:, None] * weather.overcast
    passed = (1 - weather.overcast) ** 2 * (1 - 0.45 * weather.cover * weather.density)
    return sky.reshape(half, CLOUD_SUPERSAMPLING, WIDTH, CLOUD_SUPERSAMPLING, 3).mean((1, 3)), direct * passed


def _tone(sky: np.ndarray, sun_light: np.ndarray, sun: np.ndarray, weather: _Weather) -> np.ndarray:
    """(3,) factors that make a white surface `exposure` bright and take part of the light's colour away."""
    total = _irradiance(sky) + sun_light * max(float(sun[2]), 0.35)
    luminance = float(total @ LUMINANCE)
    return weather.exposure * np.pi / luminance * (total / luminance) ** (weather.kept_colour - 1.0)


@functools.cache
def _map_uids() -> frozenset[str]:
    return frozenset(record.uid for record in sky_maps.sky_records())


def _from_map(uid: str) -> Sky:
    """A sky of the large collection at the resolution that scenes use."""
    painted = sky_maps.paint_sky(uid, 2 * HEIGHT)
    record = painted.record
    radiance = painted.radiance.reshape(HEIGHT, 2, WIDTH, 2, 3).mean((1, 3))
    # Renderers need a direction even for a sun or moon that has set: one degree above the horizon, without light.
    x, y, z = painted.sun_direction.astype(np.float64)
    low = np.sin(np.radians(1.0))
    raised = max(z, low)
    flat = np.sqrt((1 - raised**2) / max(x * x + y * y, 1e-12))
    return Sky(
        id=uid,
        description=record.description,
        tags=(record.season, record.time, record.kind, record.weather, record.horizon),
        radiance=np.minimum(radiance, MAX_RADIANCE).astype(np.float32),
        sun_direction=np.array([x * flat, y * flat, raised], np.float32),
        sun_irradiance=painted.sun_irradiance * np.float32(z > 0),
    )


@functools.cache
def build_sky(sky_id: str) -> Sky:
    """Computes a sky (about 0.1 s); the same id gives the same numbers.

    Args:
      sky_id: one of `sky_ids`, or the uid of one of the 306 skies of `sky_maps`.

    Raises:
      ValidationError: no such sky.
    """
    if sky_id in _map_uids():
        return _from_map(sky_id)
    weather = _WEATHER[v.choice(sky_id, "sky", sky_ids())]
    elevation, azimuth = np.radians(weather.elevation), np.radians(weather.azimuth)
    sun = np.array([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)])
    half = HEIGHT // 2
    sky, sun_light = _compose(sun, weather, sky_id)
    factor = _tone(sky, sun_light, sun, weather)
    sky, sun_light = sky * factor, sun_light * factor
    irradiance = _irradiance(sky) + sun_light * sun[2]
    # Distant ground has an albedo of 0.2 (asphalt 0.1, concrete 0.3) and fades into the haze at the horizon.
    ground = np.array([0.21, 0.20, 0.185]) * irradiance / np.pi
    depth = np.linspace(0.0, 1.0, half)[:, None, None]
    horizon = sky[-1:].mean(1, keepdims=True)
    lower = ground + (horizon * 0.6 - ground) * np.exp(-depth * 14.0)
    radiance = np.concatenate([sky, np.broadcast_to(lower, (half, WIDTH, 3))]).clip(0.0, MAX_RADIANCE)
    return Sky(
        id=sky_id,
        description=weather.description,
        tags=weather.tags,
        radiance=radiance.astype(np.float32),
        sun_direction=sun.astype(np.float32),
        sun_irradiance=sun_light.astype(np.float32),
    )
