"""Seamless noise for textures and clouds: everything wraps around, so that tiles and skies have no seam."""

import zlib

import numpy as np
from scipy import ndimage
from scipy.spatial import KDTree


def generator(name: str) -> np.random.Generator:
    """A random generator that depends on the name alone (not on the process' hash seed)."""
    return np.random.default_rng(zlib.crc32(name.encode("utf-8")))


def periodic_noise(rng: np.random.Generator, size: int = 256, beta: float = 2.0, lowest: float = 1.0) -> np.ndarray:
    """(size, size) noise that wraps around, mean 0 and standard deviation 1.

    Args:
      rng: where the white noise comes from.
      size: pixels a side.
      beta: the power spectrum falls as frequency^-beta: 0 white, 2 cloudy, 4 smooth.
      lowest: frequencies (cycles a tile) below this are left out, so that a repeated tile shows no blotch.
    """
    spectrum = np.fft.rfft2(rng.standard_normal((size, size)))
    fy = np.fft.fftfreq(size, 1.0 / size)[:, None]
    fx = np.fft.rfftfreq(size, 1.0 / size)[None, :]
    frequency = np.hypot(fx, fy)
    gain = np.where(frequency >= lowest, np.maximum(frequency, 1.0) ** (-beta / 2.0), 0.0)
    noise = np.fft.irfft2(spectrum * gain, s=(size, size))
    noise -= noise.mean()
    return noise / max(float(noise.std()), 1e-9)


def periodic_cells(
    rng: np.random.Generator, size: int, count: int, aspect: float = 1.0
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A wrapping Voronoi pattern.

    Args:
      rng, size: as above.
      count: number of cells.
      aspect: how much wider (u) than tall (v) cells tend to be.

    Returns:
      (distance to the nearest seed, distance to the second nearest, number of the nearest), each (size, size); px.
    """
    seeds = rng.random((count, 2)) * size
    # Nine copies of the seeds make the pattern wrap around.
    shifts = np.array([(x, y) for x in (-size, 0, size) for y in (-size, 0, size)])
    tiled = (seeds[None] + shifts[:, None]).reshape(-1, 2)
    rows, columns = np.mgrid[0:size, 0:size] + 0.5
    distances, numbers = KDTree(tiled / [aspect, 1.0]).query(np.stack([columns / aspect, rows], -1), k=2)
    return distances[..., 0], distances[..., 1], numbers[..., 0] % count


def blur(image: np.ndarray, sigma: float) -> np.ndarray:
    """Gaussian blur of the first two axes that wraps around."""
    sigmas = (sigma, sigma) + (0.0,) * (image.ndim - 2)
    return ndimage.gaussian_filter(image, sigmas, mode="wrap")


def sample(noise: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Bilinear look-up of wrapping noise at (u, v) in tiles."""
    size = noise.shape[0]
    return ndimage.map_coordinates(noise, [v * size, u * size], order=1, mode="grid-wrap")
