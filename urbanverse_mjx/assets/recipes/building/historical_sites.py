"""Historical attractions and bonsai trees: old things that people look at."""

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import recipe
from ..nature.foliage import leafy
from ..nature.greenery import small_leaves
from ..nature.terrain import boulder
from ..shared.fitting import Size, fitted, size_of
from . import masonry as m


def _castle(b: MeshBuilder, size: Size, stone: Color, rng: np.random.Generator) -> None:
    """A broken round tower, a crumbling wall with two windows, fallen stones."""
    x, y, z = size
    b.lathe([(0.2 * x, 0), (0.17 * x, 0.05 * z), (0.165 * x, 0.8 * z)], (-0.24 * x, -0.3 * y, 0), stone, segments=16)
    for k in range(10):
        a = 2 * np.pi * k / 10
        tall = (0.2, 0.14, 0.06, 0.1, 0.18, 0.04, 0.12, 0.2, 0.08, 0.16)[k] * z
        b.box(
            (0.06 * x, 0.1 * x, tall),
            (-0.24 * x + 0.14 * x * np.cos(a), -0.3 * y + 0.14 * x * np.sin(a), 0.79 * z),
            stone,
            (0, 0, np.degrees(a)),
        )
    heights = (0.62, 0.7, 0.44, 0.5, 0.3, 0.36, 0.18)
    for k, tall in enumerate(heights):
        b.box(
            (0.09 * x, 0.085 * y, tall * z),
            (-0.24 * x, (-0.14 + 0.083 * k) * y, 0),
            shade(stone, 0.94 + 0.05 * (k % 3)),
        )
    for k in (1, 3):
        b.box((0.1 * x, 0.035 * y, 0.16 * z), (-0.235 * x, (-0.14 + 0.083 * k) * y, 0.2 * z), "black")
    for k, tall in enumerate((0.5, 0.3, 0.22)):
        b.box((0.14 * x, 0.07 * y, tall * z), ((-0.1 + 0.16 * k) * x, 0.42 * y, 0), shade(stone, 0.98))
    for _ in range(9):
        s = float(rng.uniform(0.02, 0.05)) * y
        boulder(
            b,
            (float(rng.uniform(-0.1, 0.4)) * x, float(rng.uniform(-0.4, 0.4)) * y, 0.04 * z),
            (s, s, 0.7 * s),
            shade(stone, float(rng.uniform(0.85, 1.1))),
            rng,
        )


def _colonnade(b: MeshBuilder, size: Size, stone: Color) -> None:
    """Columns whole and broken on a stepped base, one end of the gable still up."""
    x, y, z = size
    for k in range(3):
        b.box(
            ((0.8 - 0.06 * k) * x, (0.9 - 0.05 * k) * y, 0.05 * z),
            (-0.06 * x, 0, 0.03 * z + 0.05 * z * k),
            shade(stone, 0.92),
        )
    floor = 0.18 * z
    whole = [(-0.3, 1), (-0.15, 1), (0.0, 1), (0.15, 0.66), (0.3, 0.36)]
    for k, share in whole:
        m.columns(b, 0.16 * x, [k * y], floor, 0.6 * z * share, 0.035 * y, stone)
        m.columns(b, -0.26 * x, [k * y], floor, 0.6 * z * (1.3 - share if share > 0.9 else 1.0), 0.035 * y, stone)
    b.box((0.1 * x, 0.4 * y, 0.1 * z), (0.16 * x, -0.15 * y, floor + 0.6 * z), stone)
    b.convex(
        [
            (0.16 * x + u * 0.05 * x, v * y, w * z)
            for u in (-1, 1)
            for v, w in ((-0.35, 0.88), (0.0, 0.88), (-0.22, 1.0))
        ],
        stone,
    )
    for k in range(3):
        b.cylinder(
            0.035 * y,
            0.1 * y,
            (0.4 * x, (0.1 + 0.13 * k) * y, 0.03 * z + 0.035 * y),
            shade(stone, 0.95),
            (90, 0, 0),
            segments=10,
        )


def _obelisk(b: MeshBuilder, size: Size, stone: Color) -> None:
    """A carved needle on steps behind a rail."""
    x, y, z = size
    for k in range(4):
        b.box(((0.8 - 0.14 * k) * x, (0.8 - 0.14 * k) * y, 0.03 * z), (0, 0, 0.03 * z * (k + 1)), shade(stone, 0.9))
    w = 0.22 * min(x, y)
    b.box((1.5 * w, 1.5 * w, 0.1 * z), (0, 0, 0.15 * z), shade(stone, 1.05))
    b.box((w, w, 0.66 * z), (0, 0, 0.25 * z), stone, taper=(0.62, 0.62))
    b.box((0.62 * w, 0.62 * w, 0.09 * z), (0, 0, 0.91 * z), shade(stone, 1.08), taper=(0.02, 0.02))
    for k in range(9):
        for turn in (0, 90, 180, 270):
            with b.frame((0, 0, 0), (0, 0, turn)):
                half = w / 2 * (1 - 0.38 * (0.04 + 0.075 * k * 1.1) / 0.75)
                b.box(
                    (0.03 * w, (0.4, 0.24, 0.34)[k % 3] * w, 0.03 * z),
                    (half, (0.06, -0.08, 0)[k % 3] * w, (0.3 + 0.065 * k) * z),
                    shade(stone, 0.72),
                )
    for sx in (-1, 1):
        for sy in (-1, 1):
            b.cylinder(0.03 * y, 0.09 * z, (sx * 0.42 * x, sy * 0.42 * y, 0.03 * z), "granite", segments=8)
    for s in (-1, 1):
        b.rod((s * 0.42 * x, -0.42 * y, 0.1 * z), (s * 0.42 * x, 0.42 * y, 0.1 * z), 0.006 * z, "black", 5)


@recipe("historical attractions", 3, hulls=10, name="relics.historical_attractions")
def historical_attractions(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A ruined castle with a broken tower; standing columns of a temple; an obelisk on steps. A plate explains each."""
    size, b = size_of("historical attractions", variant), MeshBuilder(roughness=0.95)
    x, y, z = size
    stone: Color = ("#a39884", "#d8ccb0", "#c99a7c")[variant]
    b.box((x, y, 0.03 * z), (0, 0, 0), ("#7f9a55", "#b5a582", "#b9b2a2")[variant])
    if variant == 0:
        _castle(b, size, stone, rng)
    elif variant == 1:
        _colonnade(b, size, stone)
    else:
        _obelisk(b, size, stone)
    plate = (0.44 * x, -0.3 * y if variant != 2 else 0.0, 0.0)
    b.box((0.08, 0.08, 1.0), plate, "dark grey")
    m.board(b, "HISTORIC SITE", (plate[0], plate[1], 0.95), 1.8, 0.7, "#5b3a24", "white")
    names = ("ruined castle", "standing columns of an ancient temple", "obelisk on steps")
    return fitted(b.build(names[variant]), "historical attractions", size)


@recipe("bonsai", 3, hulls=6, name="relics.bonsai")
def bonsai(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A bent trunk with pads of leaves in a shallow glazed tray: an old pine, a slanting maple, an upright juniper."""
    size, b = size_of("bonsai", variant), MeshBuilder(roughness=0.7)
    x, y, z = size
    glaze: Color = ("#2f5a7a", "#7a3a2a", "#3f5f4a")[variant]
    pot = 0.17 * z
    if variant == 1:
        with b.frame((0, 0, 0), scale=(x / y, 1.0, 1.0)):
            b.lathe(
                [(0.3 * y, 0.03 * z), (0.38 * y, pot), (0.42 * y, pot), (0.42 * y, 1.15 * pot), (0.36 * y, 1.15 * pot)],
                (0, 0, 0),
                glaze,
                segments=18,
            )
    else:
        b.box((0.66 * x, 0.62 * y, pot), (0, 0, 0.03 * z), glaze, taper=(1.14, 1.14))
        b.box((0.8 * x, 0.76 * y, 0.04 * z), (0, 0, pot), shade(glaze, 1.15))
    for sx in (-1, 1):
        for sy in (-1, 1):
            b.box((0.1 * x, 0.1 * y, 0.04 * z), (sx * 0.22 * x, sy * 0.2 * y, 0), shade(glaze, 0.8))
    b.ball((0.3 * x, 0.28 * y, 0.05 * z), (0, 0, pot + 0.03 * z), "#6f8a48", segments=12, rings=6)
    bend = (0.16, 0.3, -0.05)[variant] * y
    base = pot + 0.04 * z
    spine = [
        (0, -0.12 * y, base),
        (0.02 * x, 0.06 * y, 0.38 * z),
        (0, -0.4 * bend, 0.52 * z),
        (0, bend, 0.68 * z),
        (0, 0.7 * bend, 0.84 * z),
    ]
    b.tube(spine, [0.09 * y, 0.065 * y, 0.05 * y, 0.035 * y, 0.015 * y], ("bark", "#8a7a68", "#7a4f38")[variant], 8)
    for k in range(4):
        a = 1.5 * k + 0.4
        b.tube(
            [
                (0, -0.12 * y, base + 0.03 * z),
                (0.14 * x * np.cos(a), -0.12 * y + 0.14 * y * np.sin(a), base - 0.01 * z),
            ],
            [0.05 * y, 0.015 * y],
            "bark",
            6,
        )
    leaves = small_leaves(("dark leaf", "#c8502a", "#5f8f4a")[variant], rng)
    pads = (
        (0.0, -0.30, 0.46, 0.9),
        (0.04, 0.32, 0.56, 1.0),
        (-0.1, -0.22, 0.66, 0.8),
        (0.06, 0.12, 0.78, 0.9),
        (0.0, 0.0, 0.92, 0.7),
    )
    for px, py, pz, k in pads:
        end = (px * x, py * y + 0.4 * bend, pz * z)
        b.tube([(0, 0.3 * bend, (pz - 0.1) * z), (end[0], end[1], end[2] - 0.02 * z)], [0.03 * y, 0.012 * y], "bark", 6)
        leafy(b, end, (0.24 * k * x, 0.19 * k * y, 0.075 * z), leaves, rng, 10, 5, 0.12, 0.3 + 0.5 * pz)
        leafy(
            b,
            (end[0], end[1] + 0.09 * y, end[2] + 0.03 * z),
            (0.15 * k * x, 0.12 * k * y, 0.06 * z),
            leaves,
            rng,
            8,
            4,
            0.14,
            0.4 + 0.5 * pz,
        )
    if variant == 0:
        b.ball((0.06 * x, 0.07 * y, 0.05 * z), (0.18 * x, 0.24 * y, pot + 0.06 * z), "granite", segments=7, rings=4)
    names = ("pine bonsai in a blue tray", "maple bonsai in an oval red tray", "juniper bonsai in a green tray")
    return fitted(b.build(names[variant]), "bonsai", size)
