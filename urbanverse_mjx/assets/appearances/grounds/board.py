"""The canvas of a material: a tileable square of ground of known side in metres."""

import numpy as np
from scipy import ndimage

from .. import noise

Field = np.ndarray
#: Pixels a side of every map.
SIZE = 512


class Board:
    """Metric coordinates and seeded noise; every field is (size, size) and tileable.

    Attributes:
      metres: side of the tile.
      pixel: m.
      rng: all randomness of the material, seeded by its name.
    """

    def __init__(self, name: str, metres: float, size: int = SIZE) -> None:
        self.size, self.metres, self.pixel = size, metres, metres / size
        self.rng = noise.generator(f"grounds/{name}")
        line = (np.arange(size, dtype=np.float32) + 0.5) * np.float32(self.pixel)
        #: m to the right (u, the driving direction) and downwards in the image (against v).
        self.x, self.y = np.meshgrid(line, line)

    def noise(self, largest_m: float, beta: float = 2.0) -> Field:
        """Noise of mean 0 and standard deviation 1 with wavelengths up to `largest_m` and a spectrum of
        frequency^-beta."""
        lowest = min(max(self.metres / largest_m, 1.0), self.size / 3)
        return noise.periodic_noise(self.rng, self.size, beta, lowest).astype(np.float32)

    def grain(self, size_m: float) -> Field:
        """Noise of one grain size, mean 0, standard deviation 1."""
        sigma = size_m / 2.36 / self.pixel  # full width at half maximum
        white = self.rng.standard_normal((self.size, self.size), dtype=np.float32)
        blurred = self.blur(white, sigma * self.pixel) if sigma > 0.3 else white
        return blurred / blurred.std()

    def blur(self, field: Field, sigma_m: float) -> Field:
        sigma = sigma_m / self.pixel
        return ndimage.gaussian_filter(field.astype(np.float32), sigma, mode="wrap", truncate=3.0)

    def share(self, field: Field, share: float, soft: float = 0.15) -> Field:
        """[0, 1]: 1 where `field` is among its highest `share`, with an edge `soft` standard deviations wide."""
        if share <= 0:
            return np.zeros_like(field)
        if share >= 1:
            return np.ones_like(field)
        sample = field[::4, ::4]
        level = np.quantile(sample, 1.0 - share)
        return smoothstep((field - level) / (soft * max(float(sample.std()), 1e-9)) + 0.5)

    def bent(self, amount_m: float, scale_m: float) -> tuple[Field, Field]:
        """Coordinates moved by smooth noise, so that edges are not perfectly straight."""
        if amount_m <= 0:
            return self.x, self.y
        return (
            self.x + np.float32(amount_m) * self.noise(scale_m, 3.5),
            self.y + np.float32(amount_m) * self.noise(scale_m, 3.5),
        )

    def streaks(self, count: int, length_m: float, branches: float = 0.25, wander: float = 0.25) -> Field:
        """[0, 1] marks one pixel wide: cracks that wander and fork, `length_m` long on average."""
        image = np.zeros((self.size, self.size), np.float32)
        pending = [(self.rng.random(2) * self.metres, self.rng.random() * 2 * np.pi, length_m) for _ in range(count)]
        while pending:
            start, heading, length = pending.pop()
            steps = max(int(length * self.rng.uniform(0.6, 1.4) / self.pixel), 4)
            # A random walk of the direction with a limited range, so that a crack approximately keeps its direction.
            turn = np.cumsum(self.rng.normal(0.0, wander, steps)) * 0.35 + self.rng.normal(0.0, wander * 2, steps)
            direction = heading + turn
            path = start + np.cumsum(np.stack([np.sin(direction), np.cos(direction)], -1), 0) * self.pixel
            rows, columns = np.floor(path / self.pixel).astype(int).T % self.size
            image[rows, columns] = np.linspace(1.0, 0.55, steps)
            for k in np.flatnonzero(self.rng.random(steps) < branches / (0.3 / self.pixel)):
                if length > 0.15 and len(pending) < 60:
                    side = heading + turn[k] + self.rng.choice([-1, 1]) * self.rng.uniform(0.5, 1.2)
                    pending.append((path[k], side, length * (1 - k / steps) * 0.6))
        return image


def smoothstep(t: Field) -> Field:
    t = np.clip(t, 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def mix(a: np.ndarray, b: np.ndarray | tuple[float, float, float] | float, amount: Field) -> np.ndarray:
    """Blend of two fields or two (size, size, 3) images by (size, size) shares."""
    if a.ndim == 3:
        amount = amount[..., None]
    return a + (np.asarray(b, np.float32) - a) * amount
