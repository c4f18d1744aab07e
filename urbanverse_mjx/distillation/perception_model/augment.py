"""Image augmentation by random faults of cameras, codecs and lenses. Runs inside jit on one rendered frame."""

import jax
import jax.numpy as jnp
import numpy as np

#: Quantisation table of luminance in the JPEG standard (ITU-T T.81, Annex K.1).
_JPEG_TABLE = np.array(
    [
        [16, 11, 10, 16, 24, 40, 51, 61],
        [12, 12, 14, 19, 26, 58, 60, 55],
        [14, 13, 16, 24, 40, 57, 69, 56],
        [14, 17, 22, 29, 51, 87, 80, 62],
        [18, 22, 37, 56, 68, 109, 103, 77],
        [24, 35, 55, 64, 81, 104, 113, 92],
        [49, 64, 78, 87, 103, 121, 120, 101],
        [72, 92, 95, 98, 112, 100, 103, 99],
    ],
    np.float32,
)
_BLUR_RADIUS = 4  # pixels


def _cosines() -> np.ndarray:
    """(8, 8) orthonormal DCT-II: rows are frequencies."""
    k, n = np.mgrid[:8, :8]
    basis = np.cos(np.pi * (2 * n + 1) * k / 16) / 2
    basis[0] /= np.sqrt(2)
    return basis.astype(np.float32)


def jpeg(image: jax.Array, quality: jax.Array) -> jax.Array:
    """Applies the block artefacts of JPEG: quantises every 8 x 8 block in frequency, equally for each colour channel.

    Args:
      image: (H, W, 3) in [0, 1], sides multiples of 8.
      quality: () 1 to 100 as libjpeg counts it.
    """
    h, w, _ = image.shape
    scale = jnp.where(quality < 50.0, 50.0 / quality, 2.0 - quality / 50.0)
    step = jnp.maximum(_JPEG_TABLE * scale, 1.0)
    basis = jnp.asarray(_cosines())
    blocks = (image * 255.0 - 128.0).reshape(h // 8, 8, w // 8, 8, 3)
    frequencies = jnp.einsum("ki,aibjc,lj->akblc", basis, blocks, basis)
    table = step[None, :, None, :, None]
    rounded = jnp.round(frequencies / table) * table
    back = jnp.einsum("ki,akblc,lj->aibjc", basis, rounded, basis)
    return jnp.clip((back.reshape(h, w, 3) + 128.0) / 255.0, 0.0, 1.0)


def blur(image: jax.Array, sigma: jax.Array, radius: int = _BLUR_RADIUS) -> jax.Array:
    """Gaussian blur of rows and columns with `sigma` (2,) pixels, cut off at `radius` pixels."""
    offsets = jnp.arange(-radius, radius + 1, dtype=jnp.float32)
    for axis in (0, 1):
        weight = jnp.exp(-(offsets**2) / (2.0 * sigma[axis] ** 2 + 1e-6))
        weight = weight / weight.sum()
        padded = jnp.pad(image, [(radius, radius) if a == axis else (0, 0) for a in range(3)], "edge")
        size = image.shape[axis]

        def add(i: jax.Array, total: jax.Array, weight=weight, padded=padded, size=size, axis=axis) -> jax.Array:
            return total + weight[i] * jax.lax.dynamic_slice_in_dim(padded, i, size, axis=axis)

        # A loop, not a sum of slices: the graph of a training step compiles faster.
        image = jax.lax.fori_loop(0, 2 * radius + 1, add, jnp.zeros_like(image))
    return image


#: Matrix from RGB to YIQ (luminance and two colour differences).
_YIQ = np.array([[0.299, 0.587, 0.114], [0.596, -0.274, -0.322], [0.211, -0.523, 0.312]], np.float32)


def recolour(key: jax.Array, image: jax.Array, region: jax.Array, regions: int) -> jax.Array:
    """Gives each region (H, W) i32 < `regions` of an image (H, W, 3) u8 a random hue, saturation and brightness, and a
    third of them less contrast inside, down to one flat colour.

    Most regions approximately keep their hue. The model then has to recognise objects by shape.
    """
    keys, of = jax.random.split(key, 7), (regions,)
    turn = jax.random.uniform(keys[0], of, minval=-jnp.pi, maxval=jnp.pi)
    turn = jnp.where(jax.random.bernoulli(keys[1], 0.35, of), turn, 0.15 * jax.random.normal(keys[2], of))
    brightness = jnp.exp(0.3 * jax.random.normal(keys[3], of))
    colour = brightness * jax.random.uniform(keys[4], of, minval=0.2, maxval=1.8)
    table = jnp.stack([brightness, colour * jnp.cos(turn), colour * jnp.sin(turn)], -1)
    gain, c, s = jnp.moveaxis(table[region], -1, 0)
    colours, at = image.astype(jnp.float32).reshape(-1, 3), region.ravel()
    size = jax.ops.segment_sum(jnp.ones(len(at)), at, regions)
    mean = jax.ops.segment_sum(colours, at, regions) / jnp.maximum(size, 1.0)[:, None]
    contrast = jax.random.uniform(keys[6], of, minval=-0.1, maxval=0.8)
    contrast = jnp.where(jax.random.bernoulli(keys[5], 0.35, of), jnp.maximum(contrast, 0.0), 1.0)
    colours = mean[at] + contrast[at][:, None] * (colours - mean[at])
    y, i, q = jnp.moveaxis(colours.reshape(image.shape) @ _YIQ.T, -1, 0)
    dyed = jnp.stack([gain * y, c * i - s * q, s * i + c * q], -1) @ np.linalg.inv(_YIQ).T.astype(np.float32)
    return jnp.clip(dyed, 0.0, 255.0).astype(jnp.uint8)


def augment(key: jax.Array, image: jax.Array) -> jax.Array:
    """Augments a clean uint8 image by blur, exposure, white balance, tone, noise and JPEG; returns (H, W, 3) float in
    [0, 1]."""
    return with_faults(key, image.astype(jnp.float32) / 255.0)


def with_faults(key: jax.Array, image: jax.Array) -> jax.Array:
    """The same for an image (H, W, 3) of floats in [0, 1]."""
    keys, x = jax.random.split(key, 8), image
    # Defocus and camera shake: mostly below one pixel, sometimes two along one axis.
    x = blur(x, jnp.abs(jax.random.normal(keys[0], (2,))) * 0.7)
    x = x * jnp.exp(jax.random.normal(keys[1], ()) * 0.2) * jnp.exp(jax.random.normal(keys[2], (3,)) * 0.06)
    grey = x.mean(-1, keepdims=True)
    x = grey + (x - grey) * jax.random.uniform(keys[3], (), minval=0.5, maxval=1.4)
    middle = x.mean()
    x = middle + (x - middle) * jax.random.uniform(keys[4], (), minval=0.75, maxval=1.25)
    x = jnp.clip(x, 1e-4, 1.0) ** jnp.exp(jax.random.normal(keys[5], ()) * 0.2)
    grain, strength = jax.random.split(keys[6])
    x = x + jax.random.normal(grain, x.shape) * jax.random.uniform(strength, (), maxval=0.04)
    return jpeg(jnp.clip(x, 0.0, 1.0), jax.random.uniform(keys[7], (), minval=25.0, maxval=98.0))
