"""Hard conditions for training images: cast shadows, night, rain, haze, flare, a bonnet, grey film, other colours.

Runs inside jit on one image. They stand for what photographs show and our streets do not; amounts were chosen manually.
"""

import dataclasses

import jax
import jax.numpy as jnp

from .augment import blur


@dataclasses.dataclass(frozen=True)
class ConditionOptions:
    """Shares of the images with each condition, among the share `any` that may have some."""

    any: float = 0.5
    shadows: float = 0.3
    light: float = 0.3
    style: float = 0.4
    night: float = 0.15
    haze: float = 0.2
    rain: float = 0.12
    flare: float = 0.12
    bonnet: float = 0.15
    shake: float = 0.25
    grey: float = 0.12
    soft: float = 0.3


_OPTIONS = ConditionOptions()
_SHAKE_RADIUS = 9  # pixels
_SOFT_RADIUS = 4  # pixels
_LAMPS = 6
_STREAK = 14  # pixels


def vary(key: jax.Array, image: jax.Array) -> tuple[jax.Array, jax.Array]:
    """A clean image (H, W, 3) u8 under random conditions.

    Returns:
      the image as floats in [0, 1], and (H, W) bool where a bonnet hides the street.
    """
    x = image.astype(jnp.float32) / 255.0
    gate, *keys = jax.random.split(key, 12)
    may = jax.random.bernoulli(gate, _OPTIONS.any)
    hidden = jnp.zeros(x.shape[:2], bool)
    steps = (
        (_OPTIONS.shadows, _shadows),
        (_OPTIONS.light, _light),
        (_OPTIONS.style, _style),
        (_OPTIONS.night, _night),
        (_OPTIONS.haze, _haze),
        (_OPTIONS.rain, _rain),
        (_OPTIONS.flare, _flare),
        (_OPTIONS.shake, _shake),
        (_OPTIONS.grey, _grey),
        (_OPTIONS.soft, _soft),
    )
    for of, (share, change) in zip(keys, steps, strict=False):
        decide, draw = jax.random.split(of)
        x = jnp.where(may & jax.random.bernoulli(decide, share), change(draw, x), x)
    decide, draw = jax.random.split(keys[-1])
    shape, painted = _bonnet(draw, x)
    present = may & jax.random.bernoulli(decide, _OPTIONS.bonnet)
    hidden = present & shape
    return jnp.clip(jnp.where(hidden[..., None], painted, x), 0.0, 1.0), hidden


def _between(key: jax.Array, low: float, high: float, shape: tuple[int, ...] = ()) -> jax.Array:
    return jax.random.uniform(key, shape, minval=low, maxval=high)


def _field(key: jax.Array, x: jax.Array, cells: tuple[int, int]) -> jax.Array:
    """(H, W) smooth random field of about unit deviation."""
    return jax.image.resize(jax.random.normal(key, cells), x.shape[:2], "cubic")


def _grid(x: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Rows and columns (H, W) from 0 to 1 of the height."""
    rows, columns = jnp.mgrid[: x.shape[0], : x.shape[1]].astype(jnp.float32)
    return rows / x.shape[0], columns / x.shape[0]


def _shadows(key: jax.Array, x: jax.Array) -> jax.Array:
    """Patches of shade with soft edges, bluish as under a clear sky."""
    a, b, c, d = jax.random.split(key, 4)
    shade = jax.nn.sigmoid(_between(b, 4.0, 30.0) * (_field(a, x, (7, 12)) - _between(c, -0.3, 0.8)))
    return x * (1.0 - shade[..., None] * _between(d, 0.2, 0.6) * jnp.array([1.0, 0.97, 0.9]))


def _light(key: jax.Array, x: jax.Array) -> jax.Array:
    a, b = jax.random.split(key)
    return x * jnp.exp(_between(a, 0.05, 0.35) * _field(b, x, (3, 5)))[..., None]


def _style(key: jax.Array, x: jax.Array) -> jax.Array:
    """Mixed colour channels, and a tone curve of its own for each."""
    a, b = jax.random.split(key)
    mixed = x @ (jnp.identity(3) + 0.06 * jax.random.normal(a, (3, 3))).T
    return jnp.clip(mixed, 1e-4, 1.0) ** jnp.exp(0.12 * jax.random.normal(b, (3,)))


def _night(key: jax.Array, x: jax.Array) -> jax.Array:
    """Little, bluish light, and glowing lamps."""
    a, b, c, d, e = jax.random.split(key, 5)
    dark = x ** _between(a, 1.0, 1.6) * _between(b, 0.08, 0.4) * jnp.array([0.85, 0.95, 1.15])
    rows, columns = _grid(x)
    at = _between(c, 0.0, 1.0, (_LAMPS, 2)) * jnp.array([0.6, x.shape[1] / x.shape[0]])
    away = (rows[..., None] - at[:, 0]) ** 2 + (columns[..., None] - at[:, 1]) ** 2
    glow = (jnp.exp(-away / 0.03) * 0.5 + jnp.exp(-away / 0.0004)) * _between(d, 0.0, 0.6, (_LAMPS,))
    return dark + glow.sum(-1)[..., None] * jnp.array([1.0, 0.85, 0.55]) * _between(e, 0.2, 1.0)


def _haze(key: jax.Array, x: jax.Array) -> jax.Array:
    a, b = jax.random.split(key)
    share = _between(a, 0.1, 0.5)
    return (1.0 - share) * x + share * _between(b, 0.5, 0.85)


def _rain(key: jax.Array, x: jax.Array) -> jax.Array:
    """Bright streaks, paler and darker colours."""
    a, b, c = jax.random.split(key, 3)
    drops = jax.random.bernoulli(a, 0.004, x.shape[:2]).astype(jnp.float32)
    edge = jnp.pad(drops, _STREAK)
    slant = _between(b, -0.4, 0.4)

    def add(k: jax.Array, total: jax.Array) -> jax.Array:
        aside = _STREAK - jnp.round(slant * k).astype(jnp.int32)
        return total + jax.lax.dynamic_slice(edge, (_STREAK - k, aside), drops.shape)

    streaks = jax.lax.fori_loop(0, _STREAK, add, jnp.zeros_like(drops))
    grey = x.mean(-1, keepdims=True)
    return 0.85 * (0.5 * x + 0.5 * grey) + jnp.minimum(streaks, 1.0)[..., None] * _between(c, 0.05, 0.25)


def _flare(key: jax.Array, x: jax.Array) -> jax.Array:
    """A glow around a light, and discs on the line through the middle."""
    a, b, c, d = jax.random.split(key, 4)
    rows, columns = _grid(x)
    width = x.shape[1] / x.shape[0]
    at = _between(a, 0.0, 1.0, (2,)) * jnp.array([0.7, width])
    glow = _between(b, 0.2, 0.9) * jnp.exp(-jnp.hypot(rows - at[0], columns - at[1]) / _between(c, 0.05, 0.3))
    middle = jnp.array([0.5, width / 2.0])
    discs = jnp.zeros_like(rows)
    for share, radius in ((-0.4, 0.05), (-0.9, 0.09), (0.4, 0.03)):
        place = middle + share * (at - middle)
        discs += 0.12 * (jnp.hypot(rows - place[0], columns - place[1]) < radius)
    tint = 1.0 + 0.2 * jax.random.normal(d, (3,))
    return x + (glow + discs)[..., None] * tint


def _shake(key: jax.Array, x: jax.Array) -> jax.Array:
    """Blur along one axis, as by a moving camera."""
    a, b = jax.random.split(key)
    along = _between(a, 1.0, 3.5)
    axes = jnp.where(jax.random.bernoulli(b), jnp.array([0.3, 1.0]), jnp.array([1.0, 0.3]))
    return blur(x, along * axes, _SHAKE_RADIUS)


def _soft(key: jax.Array, x: jax.Array) -> jax.Array:
    """The detail of a smaller image that was enlarged: films of fewer pixels than the network's."""
    return blur(x, jnp.repeat(_between(key, 0.5, 1.5), 2), _SOFT_RADIUS)


def _grey(key: jax.Array, x: jax.Array) -> jax.Array:
    share = jnp.abs(jax.random.normal(key, (3,))) + 0.2
    return jnp.broadcast_to((x @ (share / share.sum()))[..., None], x.shape)


def _bonnet(key: jax.Array, x: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Mask (H, W) and colours (H, W, 3) of a bonnet at the lower border, which mirrors the sky."""
    a, b, c, d, e = jax.random.split(key, 5)
    rows, columns = _grid(x)
    middle, half = x.shape[1] / x.shape[0] * _between(a, 0.35, 0.65), _between(b, 0.6, 1.3)
    top = 1.0 - _between(c, 0.06, 0.25) * jnp.sqrt(jnp.maximum(1.0 - ((columns - middle) / half) ** 2, 0.0))
    colour = _between(d, 0.02, 0.7, (3,)) * 0.5 + 0.5 * _between(d, 0.02, 0.7)
    mirrored = blur(x[::-1], jnp.array([2.5, 2.5])) * _between(e, 0.1, 0.5)
    return rows > top, jnp.clip(colour * (0.6 + 0.4 * (1.0 - rows))[..., None] + mirrored, 0.0, 1.0)
