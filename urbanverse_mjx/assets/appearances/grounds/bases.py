"""Dry, clean surfaces: asphalt, cast concrete, paving of units, loose stone. Sizes are in metres, colours in sRGB."""

import dataclasses
from collections.abc import Sequence

import numpy as np

from .board import Board, Field, mix, smoothstep
from .layouts import Laid, cells
from .surface import Surface

Colour = tuple[float, float, float]


def toned(colour: np.ndarray | Colour, *layers: Field) -> np.ndarray:
    """A colour, or an image, brightened and darkened by layers (0.1 = 10 %)."""
    total = sum(layers[1:], layers[0])
    return np.asarray(colour, np.float32) * (1.0 + total)[..., None]


def asphalt(
    board: Board, grey: float, chip_m: float = 0.010, exposed: float = 0.35, tint: Colour = (1.0, 1.0, 1.0),
    contrast: float = 0.3, stain: float = 0.06,
) -> Surface:  # fmt: skip
    """Stones in bitumen.

    Args:
      grey: sRGB grey of the whole (new 0.22-0.28, in use 0.34-0.45, bleached 0.5-0.58).
      chip_m: size of the coarse stones (8-11 mm wearing course, 16 mm coarse binder, 5 mm footways).
      exposed: share of the surface where traffic has removed the bitumen from the stones.
      contrast: contrast of bare stones and bitumen.
      stain: strength of large soft patches.
    """
    stones = board.grain(chip_m)
    bare = board.share(stones, exposed, 0.5)
    kind = board.grain(chip_m * 0.8)  # light and dark rock
    fine = board.grain(chip_m * 0.35)
    large = board.noise(1.6, 2.4)
    colour = toned(tuple(grey * t for t in tint), 0.10 * fine, stain * large)  # pyright: ignore[reportArgumentType]
    stone = toned((grey * 1.02, grey, grey * 0.97), contrast * (0.75 + 0.45 * kind), 0.05 * fine, stain * large)
    pits = board.share(-stones, 0.12, 0.6)
    image = mix(mix(colour, stone, bare * 0.8), (grey * 0.45, grey * 0.45, grey * 0.47), pits * 0.65)
    height = 0.0008 * np.tanh(stones) * chip_m / 0.010 - 0.0012 * pits + 0.0012 * large
    return Surface(image, height, 0.88 - 0.06 * bare + 0.03 * fine, np.zeros_like(height))


def cast_concrete(board: Board, colour: Colour, finish: str, mottling: float = 0.05) -> Surface:
    """Concrete poured in place, without joints; finish: "broom", "smooth", "exposed" (pebbles show) or "float"."""
    large, fine = board.noise(1.2, 2.6), board.grain(0.006)
    cloud = board.noise(0.35, 1.8)
    image = toned(colour, mottling * large, 0.025 * cloud, 0.025 * fine)
    height = 0.0006 * cloud + 0.0002 * fine
    rough = 0.82 + 0.03 * fine
    if finish == "broom":
        # Bristles leave grooves across the walk, some 4 mm apart: noise drawn out along v.
        ridge = board.blur(np.repeat(board.grain(0.005)[:1], board.size, 0) + 0.35 * board.grain(0.02), 0.002)
        image, height = toned(image, 0.05 * ridge), height + 0.0006 * ridge
        rough = rough + 0.08
    elif finish == "exposed":
        pebble = board.grain(0.014)
        shown = board.share(pebble, 0.55, 0.35)
        kind = board.grain(0.012)
        warm = board.grain(0.013)
        stones = toned(colour, 0.17 * kind, -0.08 + 0 * kind) * (1 + warm[..., None] * np.array([0.06, 0.0, -0.06]))
        image, height = mix(image * 0.86, stones, shown), height + 0.0015 * np.tanh(pebble)
        rough = mix(rough, 0.6, shown)
    elif finish == "smooth":
        rough = rough - 0.25
    holes = board.share(board.grain(0.008), 0.006, 0.3)
    image = image * (1 - 0.4 * holes)[..., None]
    return Surface(image.astype(np.float32), height - 0.001 * holes, rough, np.zeros_like(height))


@dataclasses.dataclass(frozen=True)
class Matter:
    """Materials of units and their joints.

    Attributes:
      colours: sRGB colours, drawn per unit.
      weights: probability of each colour.
      spread, hue: brightness and warmth that differ from unit to unit.
      mottling, speckle: soft clouds inside a unit; grains of rock (granite 0.15).
      joint_m, joint: width and colour of the joint; joint_depth m below the top.
      chamfer_m: width of the worn or bevelled rim.
      dome_m: how much higher the middle is.
      uneven_m: height difference of units.
      roughness: roughness of the top.
    """

    colours: tuple[Colour, ...]
    weights: tuple[float, ...] = ()
    spread: float = 0.07
    hue: float = 0.012
    mottling: float = 0.04
    speckle: float = 0.04
    speckle_m: float = 0.006
    joint_m: float = 0.006
    joint: Colour = (0.40, 0.38, 0.35)
    joint_depth: float = 0.004
    chamfer_m: float = 0.005
    dome_m: float = 0.0
    uneven_m: float = 0.0008
    roughness: float = 0.8


def laid(board: Board, pattern: Laid, matter: Matter, choice: np.ndarray | None = None) -> Surface:
    """A surface of units of a material in a layout.

    Args:
      choice: (size, size) index of the colour of each pixel's unit; drawn by `weights` if None.
    """
    inside = np.clip((pattern.edge - matter.joint_m / 2) / board.pixel + 0.5, 0.0, 1.0)
    count, number = pattern.count, pattern.number
    if choice is None:
        weights = np.asarray(matter.weights or (1.0,) * len(matter.colours))
        choice = board.rng.choice(len(matter.colours), count, p=weights / weights.sum())[number]
    value = board.rng.normal(0.0, 0.6, count).clip(-1.3, 1.3).astype(np.float32)[number]
    warm = board.rng.normal(0.0, 1.0, count).clip(-2, 2).astype(np.float32)[number] * matter.hue
    # The mottling is sampled at another offset for each unit.
    jumps = board.rng.integers(0, board.size, (2, count), dtype=np.int32)
    cloud = _cut(board.noise(0.25, 2.2), jumps, number)
    grain = board.grain(matter.speckle_m)
    image = np.asarray(matter.colours, np.float32)[choice]
    image = toned(image, matter.spread * value, matter.mottling * cloud, matter.speckle * grain)
    image = image * (1.0 + warm[..., None] * np.array([1.0, 0.1, -1.0], np.float32))
    rim = smoothstep((pattern.edge - matter.joint_m / 2) / max(matter.chamfer_m, board.pixel))
    image = image * (0.90 + 0.10 * rim)[..., None]
    sand = toned(matter.joint, 0.10 * board.grain(0.005), 0.10 * board.noise(0.5))
    image = mix(sand, image, inside)
    level = matter.uneven_m * board.rng.normal(0.0, 1.0, count).clip(-2, 2).astype(np.float32)[number]
    dome = matter.dome_m * (smoothstep(pattern.edge / max(float(pattern.edge.max()), 1e-6)) - 1.0)
    top = level + dome + 0.0003 * cloud + 0.00025 * grain - 0.45 * matter.chamfer_m * (1 - rim)
    height = mix(np.full_like(top, -matter.joint_depth - matter.dome_m), top, inside)
    rough = mix(np.full_like(top, 0.95), matter.roughness + 0.04 * cloud * (matter.roughness < 0.9), inside)
    return Surface(image.astype(np.float32), height, rough, 1.0 - inside, number)


def _cut(field: Field, jumps: np.ndarray, number: np.ndarray) -> Field:
    """Samples `field` at another offset for every unit."""
    size = field.shape[0]
    rows, columns = np.mgrid[0:size, 0:size].astype(np.int32)
    return field[(rows + jumps[0][number]) % size, (columns + jumps[1][number]) % size]


def loose_stone(board: Board, colours: Sequence[Colour], stone_m: float, fines: Colour, fines_share: float) -> Surface:
    """Gravel: two sizes of stones on top of each other, with fines between them."""
    image = toned(fines, 0.08 * board.grain(0.004), 0.06 * board.noise(0.8))
    height = np.full_like(board.x, -0.5 * stone_m) + 0.0005 * board.grain(0.004)
    palette = np.asarray(colours, np.float32)
    for size_m, kept in ((stone_m * 0.7, 0.95), (stone_m, 0.62)):
        across = round(board.metres / size_m)
        pattern = cells(board, across, across, 1.0, bend=size_m * 0.05, bend_scale=size_m * 2)
        there = board.rng.random(pattern.count) < kept - fines_share * 0.7
        shade = board.rng.normal(0.0, 0.10, pattern.count).clip(-0.22, 0.22).astype(np.float32)[pattern.number]
        deep = pattern.edge / (0.5 * size_m)
        cover = there[pattern.number] * np.clip((deep - 0.16) * 0.5 * size_m / board.pixel + 0.5, 0.0, 1.0)
        kind = board.rng.integers(0, len(palette), pattern.count)[pattern.number]
        stone = toned(palette[kind], shade, 0.05 * board.grain(0.004), 0.22 * np.clip(deep, 0, 0.6) - 0.10)
        image = mix(image * (1 - 0.5 * (cover > 0) * (1 - cover))[..., None], stone, cover)
        top = size_m * (0.55 * np.sqrt(np.clip(deep, 0.0, 1.0)) - 0.45)
        height = mix(height, np.maximum(height, top), cover)
    return Surface(image.astype(np.float32), height, np.full_like(height, 0.95), np.zeros_like(height))


def beaten_earth(board: Board, colour: Colour, pebbles: float = 0.03) -> Surface:
    """Compacted earth or stabilised sand with a few small stones."""
    large, mid, fine = board.noise(1.5, 2.2), board.noise(0.3, 2.0), board.grain(0.006)
    image = toned(colour, 0.06 * large, 0.05 * mid, 0.05 * fine)
    stone = board.grain(0.018)
    shown = board.share(stone, pebbles, 0.2)
    image = mix(image, toned((0.58, 0.55, 0.50), 0.12 * board.grain(0.02)), shown)
    height = 0.003 * mid + 0.0006 * fine + 0.003 * shown
    return Surface(image.astype(np.float32), height, np.full_like(height, 0.96), np.zeros_like(height))
