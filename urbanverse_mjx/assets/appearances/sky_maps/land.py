"""The land below and along the horizon: far hills, trees, roofs or towers in the haze, and the ground."""

import numpy as np

from .. import noise

#: sRGB-linear reflectance of far land by season.
_LAND = {
    "spring": (0.10, 0.12, 0.06),
    "summer": (0.09, 0.11, 0.05),
    "autumn": (0.13, 0.11, 0.06),
    "winter": (0.12, 0.11, 0.09),
}
_SNOW, _WALLS, _TOWN_GROUND = (0.62, 0.65, 0.70), (0.26, 0.24, 0.22), (0.21, 0.20, 0.185)
#: Share of the view that is haze at the near and the far row of the skyline: 3 and 9 km in air seen through for 20.
_NEAR_HAZE, _FAR_HAZE = 0.42, 0.74


def _wave(rng: np.random.Generator, yaw: np.ndarray, lowest: int, highest: int, beta: float) -> np.ndarray:
    """Noise round the horizon, mean 0, standard deviation 1."""
    k = np.arange(lowest, highest)
    gain = k ** (-beta / 2.0)
    turn = rng.random(len(k)) * 2 * np.pi
    wave = (gain * np.cos(k * yaw[:, None] + turn)).sum(1)
    return wave / np.sqrt((gain**2).sum() / 2)


def _roofs(rng: np.random.Generator, yaw: np.ndarray, width: float, low: float, high: float, tall: float) -> np.ndarray:
    """Degrees of a row of buildings `width` degrees wide on average; `tall` is the share of towers."""
    count = int(360 / width)
    cuts = np.sort(rng.random(count)) * 2 * np.pi - np.pi
    number = np.searchsorted(cuts, yaw) % count
    heights = rng.uniform(low, high, count) * np.where(rng.random(count) < tall, rng.uniform(1.6, 3.2, count), 1.0)
    return heights[number]


def skyline(kind: str, rng: np.random.Generator, yaw: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Degrees above the horizon of the near and the far row, at each yaw."""
    soft = _wave(rng, yaw, 1, 12, 1.5)
    far = np.clip(1.3 + 0.5 * _wave(rng, yaw, 2, 60, 2.2), 0.3, None)
    if kind == "hills":
        return np.clip(1.8 + 0.9 * _wave(rng, yaw, 2, 80, 2.6), 0.2, None), np.clip(3.0 + 1.2 * soft, 0.5, None)
    if kind == "trees":
        crowns = np.abs(_wave(rng, yaw, 25, 90, 0.6)) * 0.5 + 0.25 * _wave(rng, yaw, 60, 250, 0.6)
        return np.clip(1.6 + 0.5 * soft + crowns, 0.4, None), far
    if kind == "town":
        return _roofs(rng, yaw, 2.6, 0.9, 2.3, 0.04) * (1 + 0.15 * soft), _roofs(rng, yaw, 1.5, 0.8, 2.0, 0.06) + 0.6
    if kind == "towers":
        return _roofs(rng, yaw, 3.2, 1.0, 2.8, 0.12) * (1 + 0.2 * soft), _roofs(rng, yaw, 2.0, 1.2, 3.2, 0.25)
    return np.clip(0.5 + 0.25 * _wave(rng, yaw, 4, 120, 1.2), 0.1, None), far * 0.6


def add_land(
    sky: np.ndarray, kind: str, season: str, snow: bool, light: np.ndarray, haze: float, lamps: float,
    rng: np.random.Generator,
) -> np.ndarray:  # fmt: skip
    """The whole panorama: (rows, columns, 3) of sky with the skyline before it, and as many rows of ground.

    Args:
      light: (3,) irradiance of the ground.
      haze: how much thicker than clear air, as a factor on the shares of haze.
      lamps: radiance of lit windows; 0 by day.
    """
    rows, columns = sky.shape[:2]
    yaw = -np.pi + (np.arange(columns) + 0.5) / columns * 2 * np.pi
    near, far = skyline(kind, rng, yaw)
    pixel = 90.0 / rows
    elevation = 90.0 - (np.arange(rows) + 0.5) * pixel
    air = sky[-max(rows // 24, 1) :].mean(0, keepdims=True)
    built = kind in ("town", "towers")
    land = np.asarray(_SNOW if snow and not built else _WALLS if built else _LAND[season])
    land = land * (1.0 + 0.12 * _wave(rng, yaw, 20, columns // 3, 0.4).clip(-2, 2))[None, :, None]
    image = sky
    for heights, share in ((far, _FAR_HAZE), (near, _NEAR_HAZE)):
        share = 1.0 - (1.0 - share) ** haze
        cover = np.clip((heights[None, :] - elevation[:, None]) / pixel + 0.5, 0.0, 1.0)[..., None]
        # Walls and slopes see half of the sky and of the ground.
        front = land * light / np.pi * 0.75 * (1 - share) + air * share * 0.92
        if lamps and built:
            lit = (rng.random((rows, columns, 1)) < 0.22) * lamps * rng.uniform(0.3, 1.0, (rows, columns, 1))
            front = front + lit * np.array([1.0, 0.72, 0.40])
        image = image * (1 - cover) + front * cover
    ground = np.asarray(_SNOW if snow else _TOWN_GROUND) * light / np.pi
    down = (np.arange(rows) + 0.5)[:, None, None] / rows
    # The last degrees below the horizon are far away and seen through haze.
    veil = np.exp(-down * 26.0) * 0.6
    patches = 1.0 + 0.05 * noise.blur(rng.standard_normal((rows, columns)), 1.5)[..., None] * np.exp(-down * 4.0)
    lower = ground * patches * (1 - veil) + air * veil * 0.8
    if lamps:
        lower = lower + lamps * 0.02 * np.array([1.0, 0.75, 0.45]) * np.exp(-down * 3.0)
    return np.concatenate([image, np.broadcast_to(lower, (rows, columns, 3))])
