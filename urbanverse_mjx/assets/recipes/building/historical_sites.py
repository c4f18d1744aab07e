"""Historical attractions: a castle, a colonnade, an obelisk."""

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import recipe
from ..nature.terrain import boulder
from ..shared.sizes import Size, fitted_as, size_of
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
    return fitted_as(b.build(names[variant]), "historical attractions", size)
