"""Goods and furniture on the pavement close to a shop's wall: crates, tables, bicycles, an ice bench."""

import itertools
from collections.abc import Callable

import numpy as np

from ....meshes.palette import Color
from ...nature.foliage import leafy, small_leaves
from ..facade import Facade


def _crates(f: Facade, side: float, variant: int, rng: np.random.Generator) -> None:
    colors: tuple[Color, ...] = ("red", "orange", "lime", "signal yellow", "purple")
    for k in range(min(5, int((f.width - 2.2) / 0.9))):
        y = -side * (f.width / 2 - 0.6 - 0.9 * k)
        f.builder.box((0.6, 0.8, 0.55), (f.front + 0.34, y, 0), "wood")
        f.builder.box((0.62, 0.82, 0.1), (f.front + 0.34, y, 0.52), "light wood")
        for j in range(6):
            at = (f.front + 0.2 + 0.15 * (j // 2), y + (-0.19, 0.19)[j % 2], 0.64)
            f.builder.ball((0.12, 0.17, 0.12), at, colors[(k + variant) % 5], segments=6, rings=4)


def _tables(f: Facade, side: float, variant: int, rng: np.random.Generator) -> None:
    for k in range(2 if f.width > 6 else 1):
        y = -side * (f.width / 2 - 1.1 - 2.1 * k)
        x = f.front + 0.42
        f.builder.cylinder(0.34, 0.04, (x, y, 0.72), ("white", "light wood", "dark green")[variant], segments=12)
        f.builder.cylinder(0.03, 0.72, (x, y, 0), "black", segments=6)
        for dy in (-0.62, 0.62):
            f.builder.box((0.4, 0.38, 0.05), (x, y + dy, 0.43), ("dark wood", "red", "teal")[variant])
            f.builder.box((0.4, 0.04, 0.42), (x, y + 1.3 * dy, 0.45), ("dark wood", "red", "teal")[variant])
            f.builder.box((0.06, 0.3, 0.43), (x, y + dy, 0), "black")


def _bicycle(f: Facade, side: float, variant: int, rng: np.random.Generator) -> None:
    """Two bicycles along the wall."""
    for k in range(2):
        y0, x = -side * (f.width / 4 + 0.2) + (k - 0.5) * 1.9, f.front + 0.3
        color = ("signal red", "teal", "orange", "signal blue")[(2 * variant + k) % 4]
        for y in (-0.5, 0.5):
            f.builder.ring(0.32, 0.025, (x, y0 + y, 0.34), "black", (0, 90, 0), segments=14, sides=5)
        frame = [(-0.5, 0.34), (-0.2, 0.8), (0.3, 0.8), (0.0, 0.34), (-0.5, 0.34)]
        for (ya, za), (yb, zb) in itertools.pairwise(frame):
            f.builder.rod((x, y0 + ya, za), (x, y0 + yb, zb), 0.025, color, sides=5)
        f.builder.rod((x, y0 + 0.5, 0.34), (x, y0 + 0.3, 0.98), 0.022, color, sides=5)
        f.builder.rod((x, y0 + 0.3, 0.98), (x, y0 + 0.48, 1.02), 0.022, color, sides=5)
        f.builder.rod((x, y0, 0.34), (x, y0 - 0.22, 0.92), 0.022, color, sides=5)
        f.builder.box((0.14, 0.26, 0.06), (x, y0 - 0.22, 0.92), "black")


def _cone(f: Facade, side: float, variant: int, rng: np.random.Generator) -> None:
    """A giant ice cream by the door."""
    x, y = f.front + 0.42, -side * (f.width / 2 - 0.5)
    f.builder.cylinder(0.25, 0.08, (x, y, 0), "white", segments=10)
    f.builder.lathe([(0.06, 0.08), (0.34, 0.95), (0.36, 1.05)], (x, y, 0), "#d9a05a", segments=12)
    for (dx, dy, z), color in zip(
        ((0, -0.14, 1.15), (0, 0.16, 1.17), (0, 0, 1.5)), ("pink", "#6b4127", "#fbf3d4"), strict=True
    ):
        f.builder.ball(0.27, (x + dx, y + dy, z), color, segments=10, rings=6)


def _barrels(f: Facade, side: float, variant: int, rng: np.random.Generator) -> None:
    leaves = small_leaves("leaf", rng)
    for k in range(2):
        at = (f.front + 0.45, -side * (f.width / 2 - 0.7 - 1.3 * k), 0.0)
        profile = [(0.26, 0), (0.36, 0.25), (0.38, 0.45), (0.36, 0.65), (0.26, 0.9)]
        f.builder.lathe(profile, at, "wood", segments=12)
        for z in (0.16, 0.68):
            f.builder.cylinder(0.37, 0.06, (at[0], at[1], z), "black", segments=12)
        leafy(f.builder, (at[0], at[1], 1.1), (0.3, 0.3, 0.28), leaves, rng, 8, 5)


def _ice(f: Facade, side: float, variant: int, rng: np.random.Generator) -> None:
    """A slanting bench of crushed ice with fish on it."""
    width = min(3.4, f.width - 3.0)
    y0, x = -side * (f.width / 2 - 0.5 - width / 2), f.front + 0.45
    f.builder.box((0.7, width, 0.7), (x, y0, 0), "light blue")
    with f.builder.frame((x, y0, 0.72), (0, 14, 0)):
        f.builder.box((0.72, width, 0.12), (0, 0, 0), "white")
        for k in range(int(width / 0.32)):
            y = (k + 0.5) * 0.32 - width / 2
            color = ("#6f8fa5", "#e08a6a", "#9aa7ae")[k % 3]
            f.builder.ball((0.24, 0.09, 0.05), (0.0, y, 0.15), color, segments=8, rings=4)
            f.builder.cylinder(0.1, 0.04, (-0.27, y, 0.13), color, top_radius=0.04, segments=3)


_SETS: dict[str, Callable[[Facade, float, int, np.random.Generator], None]] = {
    "crates": _crates,
    "tables": _tables,
    "bicycle": _bicycle,
    "cone": _cone,
    "barrels": _barrels,
    "ice": _ice,
}


def set_out(f: Facade, what: str, side: float, variant: int, rng: np.random.Generator) -> None:
    """Sets out goods or tables away from the door, which lies on `side`."""
    _SETS[what](f, side, variant, rng)
