"""Imperfect cameras: exposure, white balance, focus and pixel noise of rendered images."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Key, UInt8

from ... import srgb


class CameraNoise(NamedTuple):
    """How the camera of an episode differs from an ideal one.

    Attributes:
      exposure: () EV, powers of two by which linear light is multiplied.
      white_balance: (3,) factor of each channel's linear light.
      blur: () in [0, 1], strength of `blurred`.
      noise: () standard deviation of each pixel's channel, as a share of the full range.
    """

    exposure: Float[Array, ""]
    white_balance: Float[Array, "3"]
    blur: Float[Array, ""]
    noise: Float[Array, ""]


def blurred(x: Float[Array, "*n H W C"], strength: Float[Array, "*m"]) -> Float[Array, "*n H W C"]:
    """Blends images of a float type with their binomial blur over 3 x 3 pixels; strength: in [0, 1], of the last of the
    dimensions n, 1 = only the blurred image."""
    soft = x
    for axis in (x.ndim - 3, x.ndim - 2):
        first, last = jnp.take(soft, jnp.array([0]), axis), jnp.take(soft, jnp.array([-1]), axis)
        wide = jnp.concatenate([first, soft, last], axis)
        size = soft.shape[axis]
        parts = [jax.lax.slice_in_dim(wide, k, k + size, axis=axis) for k in range(3)]
        soft = 0.25 * parts[0] + 0.5 * parts[1] + 0.25 * parts[2]
    share = strength.astype(x.dtype)[..., None, None, None]
    return x + share * (soft - x)


def through_camera(image: UInt8[Array, "H W 3"], camera: CameraNoise, key: Key[Array, ""]) -> UInt8[Array, "H W 3"]:
    """An sRGB image as a camera with noise gives it: blurred and exposed in linear light, clipped at white, with
    independent normal noise on the encoded values; `key` is typed."""
    linear = srgb.linear(image.astype(jnp.float32) / 255.0)
    linear = blurred(linear, camera.blur) * camera.white_balance * 2.0**camera.exposure
    noise = camera.noise * jax.random.normal(key, image.shape, jnp.float32)
    return jnp.clip(jnp.rint(255.0 * (srgb.encoded(linear) + noise)), 0.0, 255.0).astype(jnp.uint8)
