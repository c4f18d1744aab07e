"""Patterns for ground textures: courses, herringbone, setts, stones, cracks, stripes. All of them are tileable."""

import numpy as np

from . import noise

SIZE = 256
Colour = tuple[float, float, float]


def tone(base: np.ndarray | Colour, *layers: np.ndarray) -> np.ndarray:
    """(256, 256, 3): a colour brightened and darkened by (256, 256) layers (0.1 = 10 %)."""
    image = np.broadcast_to(np.asarray(base, float), (SIZE, SIZE, 3))
    return image * (1.0 + sum(layers, np.zeros((SIZE, SIZE))))[..., None]


def mix(a: np.ndarray, b: np.ndarray | Colour, amount: np.ndarray) -> np.ndarray:
    return a + (np.asarray(b, float) - a) * np.clip(amount, 0.0, 1.0)[..., None]


def speckle(rng: np.random.Generator, share: float, soft: float = 0.6) -> np.ndarray:
    """(256, 256) in [0, 1]: pebbles or chips over a share of the tile."""
    grain = noise.blur(rng.standard_normal((SIZE, SIZE)), soft)
    return (grain > np.quantile(grain, 1 - share)).astype(float)


def crack(rng: np.random.Generator, count: int, width: float = 1.0) -> np.ndarray:
    """(256, 256) in [0, 1]: random walks that wrap around, as thin cracks."""
    image = np.zeros((SIZE, SIZE))
    for _ in range(count):
        heading = rng.random() * 2 * np.pi
        position = rng.random(2) * SIZE
        for _ in range(int(rng.integers(90, 240))):
            heading += rng.normal(0, 0.28)
            position = (position + np.array([np.sin(heading), np.cos(heading)])) % SIZE
            image[int(position[0]) % SIZE, int(position[1]) % SIZE] = 1.0
    return np.clip(noise.blur(image, width) * 4.0 * width, 0.0, 1.0)


def bricks(
    rng: np.random.Generator, rows: int, columns: int, joint_px: float, shift: float = 0.5
) -> tuple[np.ndarray, np.ndarray]:
    """Courses of slabs: (joint in [0, 1], random number per slab in [-1, 1]), both (256, 256)."""
    y, x = np.mgrid[0:SIZE, 0:SIZE] + 0.5
    row = np.floor(y / SIZE * rows).astype(int)
    along = (x / SIZE * columns + shift * row) % columns
    column = np.floor(along).astype(int)
    to_edge = np.minimum(
        to_nearest(along % 1.0) * SIZE / columns,
        to_nearest((y / SIZE * rows) % 1.0) * SIZE / rows,
    )
    value = rng.uniform(-1, 1, (rows, columns))[row, column]
    return np.clip(joint_px - to_edge + 0.5, 0.0, 1.0), value


def to_nearest(fraction: np.ndarray) -> np.ndarray:
    return np.minimum(fraction, 1.0 - fraction)


def herringbone(rng: np.random.Generator, cells: int, joint_px: float) -> tuple[np.ndarray, np.ndarray]:
    """A 2:1 herringbone on a grid of cells (a multiple of 4): as `bricks`."""
    y, x = np.mgrid[0:SIZE, 0:SIZE] + 0.5
    gx, gy = np.floor(x / SIZE * cells).astype(int), np.floor(y / SIZE * cells).astype(int)
    # Along every row the pattern is: two cells of a lying brick, then one cell each of two standing ones.
    phase = (gx - gy) % 4
    lying = phase < 2
    left = np.where(phase == 0, gx, gx - 1)
    bottom = np.where(phase == 2, gy - 1, gy)
    number = np.where(lying, (gy % cells) * cells + left % cells, (bottom % cells) * cells + gx % cells + cells * cells)
    value = rng.uniform(-1, 1, 2 * cells * cells)[number]
    cell = SIZE / cells
    fx, fy = (x / SIZE * cells) % 1.0 * cell, (y / SIZE * cells) % 1.0 * cell
    ends_x = np.where(lying, np.where(phase == 0, fx, cell - fx), np.minimum(fx, cell - fx))
    ends_y = np.where(lying, np.minimum(fy, cell - fy), np.where(phase == 2, cell - fy, fy))
    return np.clip(joint_px - np.minimum(ends_x, ends_y) + 0.5, 0.0, 1.0), value


def stones(rng: np.random.Generator, count: int, joint_px: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Irregular stones: (joint in [0, 1], random number per stone, domed height in [0, 1])."""
    near, second, number = noise.periodic_cells(rng, SIZE, count)
    gap = second - near
    value = rng.uniform(-1, 1, count)[number]
    return np.clip(joint_px - gap + 0.5, 0.0, 1.0), value, np.clip(gap / (SIZE / np.sqrt(count)) * 2.0, 0.0, 1.0)


def setts(rng: np.random.Generator, rows: int, columns: int, joint_px: float) -> tuple[np.ndarray, np.ndarray]:
    """Hewn stones in wavy courses: as `bricks`, edges bent by noise."""
    bend = noise.periodic_noise(rng, SIZE, 3.0, 3.0) * 2.0
    joint, value = bricks(rng, rows, columns, joint_px)
    y, x = np.mgrid[0:SIZE, 0:SIZE]
    rows_at, columns_at = (y + bend.astype(int)) % SIZE, (x + np.roll(bend, 60, 0).astype(int)) % SIZE
    return joint[rows_at, columns_at], value[rows_at, columns_at]


def paved(
    rng: np.random.Generator,
    pattern: tuple[np.ndarray, np.ndarray],
    colour: Colour,
    varied: float,
    grain: tuple[float, float],
    joint_colour: Colour,
    filled: float,
) -> np.ndarray:
    """(256, 256, 3): units that differ in brightness, and the joints between them.

    Args:
      pattern: result of `bricks`, `herringbone` or `setts`.
      varied: relative difference of the brightness of units.
      grain: spectral slope and amplitude of the noise on units.
      filled: share of a joint that has the joint's colour.
    """
    joint, value = pattern
    image = tone(colour, value * varied, noise.periodic_noise(rng, SIZE, grain[0]) * grain[1])
    return mix(image, joint_colour, joint * filled)


def asphalt(
    rng: np.random.Generator, grey: float, chips: float, wear: float, tint: Colour = (1.0, 1.0, 1.02)
) -> np.ndarray:
    base = np.asarray(tint) * grey
    fine = noise.periodic_noise(rng, SIZE, 0.3) * 0.09
    stain = noise.periodic_noise(rng, SIZE, 2.6, 2.0) * wear
    image = tone(base, fine, stain)
    return mix(image, (grey * 1.9, grey * 1.9, grey * 1.9), speckle(rng, chips) * 0.6)


def slabs(
    rng: np.random.Generator,
    rows: int,
    columns: int,
    colour: Colour,
    spread: float = 0.06,
    joint: Colour = (0.3, 0.3, 0.3),
    joint_px: float = 1.6,
    shift: float = 0.5,
    dirt: float = 0.05,
) -> np.ndarray:
    gaps, value = bricks(rng, rows, columns, joint_px, shift)
    image = tone(colour, value * spread, noise.periodic_noise(rng, SIZE, 0.6) * 0.035,
                  noise.periodic_noise(rng, SIZE, 2.4, 2.0) * dirt)  # fmt: skip
    return mix(image, joint, gaps * 0.85)


def zebra(rng: np.random.Generator, ground: np.ndarray, paint: Colour, wear: float, stripes: int) -> np.ndarray:
    """Stripes of equal width, constant along u (the driving direction), with worn edges and patches."""
    y = np.mgrid[0:SIZE, 0:SIZE][0] + 0.5
    ragged = noise.periodic_noise(rng, SIZE, 1.2, 6.0) * 1.3
    wave = ((y + ragged) / SIZE * stripes) % 1.0
    inside = np.clip((0.25 - np.abs(wave - 0.5)) * SIZE / stripes, 0.0, 1.0)
    worn = noise.periodic_noise(rng, SIZE, 1.1, 3.0) + 0.6 * noise.periodic_noise(rng, SIZE, 0.2)
    covered = inside * np.clip(1.0 - np.clip(worn - np.quantile(worn, 1 - wear), 0, 1) * 2.0, 0.12, 1.0)
    return mix(ground, tone(paint, noise.periodic_noise(rng, SIZE, 0.6) * 0.03), covered)
