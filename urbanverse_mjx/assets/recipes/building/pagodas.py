"""Temples, shrines and pagodas of East and South Asia, and a Greek temple."""

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import recipe
from ..shared.sizes import Size, fitted_as, size_of
from . import masonry as m


def _eaves(b: MeshBuilder, side: tuple[float, float], z: float, rise: float, color: Color, ridge: float = 0.0) -> None:
    """A curved hip roof with its corners drawn up, over a dark board."""
    b.box((0.92 * side[0], 0.92 * side[1], 0.06 * rise), (0, 0, z - 0.06 * rise), shade(color, 0.6))
    m.hip_roof(b, (side[0], side[1], rise), (0, 0, z), color, ridge, 0.35 * rise)


@recipe("pagoda", 3, hulls=10, name="pagodas.pagoda")
def pagoda(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Five or seven roofs over each other: red and grey, white stone, or dark wood."""
    size = size_of("pagoda", variant)
    side, z = size[0], size[2]
    roof, body, rail = (
        ("#4d5a5e", "#b5302a", "#e2c27a"),
        ("#6b6f6a", "#e4e0d6", "#c9c4b6"),
        ("#3c3a38", "#7a4a2c", "#d9c9a3"),
    )[variant]
    b, count = MeshBuilder(roughness=0.8), (5, 7, 5)[variant]
    b.box((0.96 * side, 0.96 * side, 0.04 * z), (0, 0, 0), "granite")
    foot, top = 0.04 * z, 0.82 * z
    storey = (top - foot) / count
    for k in range(count):
        share = 1 - (0.5, 0.55, 0.38)[variant] * k / (count - 1)
        w, low = 0.58 * side * share, foot + storey * k
        b.box((w, w, storey), (0, 0, low), body)
        b.box((1.18 * w, 1.18 * w, 0.05 * storey), (0, 0, low + 0.12 * storey), rail)
        for turn in (0, 90, 180, 270):
            with b.frame((0, 0, low), (0, 0, turn)):
                b.box((0.02 * side, 0.3 * w, 0.42 * storey), (w / 2, 0, 0.14 * storey), "dark wood")
                for s in (-1, 1):
                    b.box((0.03 * side, 0.03 * side, 0.6 * storey), (w / 2, s * 0.48 * w, 0), rail)
        with b.frame((0, 0, low + 0.56 * storey)):
            m.hip_roof(
                b, (0.98 * side * share, 0.98 * side * share, 0.62 * storey), (0, 0, 0), roof, 0.25, 0.12 * storey
            )
    b.cylinder(0.012 * side, z - top, (0, 0, top), "gold", segments=6)
    for k in range(5):
        b.cylinder(0.05 * side * (1 - 0.13 * k), 0.008 * z, (0, 0, top + (0.03 + 0.022 * k) * z), "gold", segments=10)
    m.steps(b, 0.48 * side, 0.3 * side, 2, 0.02 * z, 0.01 * side, "granite")
    names = ("red pagoda of five roofs", "white stone pagoda of seven roofs", "dark wooden pagoda of five roofs")
    return fitted_as(b.build(names[variant], {"roofs": count}), "pagoda", size)


def _east_temple(b: MeshBuilder, size: Size, roof: Color, body: Color) -> None:
    """A hall of red columns on a platform under two sweeping roofs."""
    x, y, z = size
    b.box((x, y, 0.08 * z), (0, 0, 0), "granite")
    m.steps(b, x / 2 - 0.06 * x, 0.3 * y, 4, 0.02 * z, 0.03 * x, "light grey")
    floor, high = 0.08 * z, 0.3 * z
    b.box((0.56 * x, 0.66 * y, high), (0, 0, floor), shade(body, 0.75))
    m.columns(b, 0.38 * x, list(np.linspace(-0.4, 0.4, 6) * y), floor, high, 0.02 * y, body, 8)
    m.columns(b, -0.38 * x, list(np.linspace(-0.4, 0.4, 6) * y), floor, high, 0.02 * y, body, 8)
    for k in (-1, 0, 1):
        m.gate(b, (0.28 * x, 0.2 * y * k, floor), 0.14 * y, 0.8 * high, "dark wood")
    with b.frame((0, 0, floor + high)):
        _eaves(b, (0.98 * x, 0.98 * y), 0.0, 0.2 * z, roof, 0.6)
        b.box((0.4 * x, 0.62 * y, 0.12 * z), (0, 0, 0.14 * z), body)
        _eaves(b, (0.66 * x, 0.84 * y), 0.25 * z, 0.26 * z, roof, 0.6)
        b.box((0.03 * x, 0.5 * y, 0.04 * z), (0, 0, 0.5 * z), shade(roof, 0.7))
        for s in (-1, 1):
            b.box((0.04 * x, 0.02 * y, 0.09 * z), (0, s * 0.25 * y, 0.5 * z), "gold")


def _greek_temple(b: MeshBuilder, size: Size) -> None:
    """Columns all round under a low gable."""
    x, y, z = size
    stone: Color = "#ddd2ba"
    for k in range(3):
        b.box((x * (1 - 0.03 * k), y * (1 - 0.03 * k), 0.045 * z), (0, 0, 0.045 * z * k), shade(stone, 0.95))
    floor, high = 0.135 * z, 0.5 * z
    b.box((0.6 * x, 0.7 * y, high), (0, 0, floor), shade(stone, 0.85))
    m.gate(b, (0.3 * x, 0, floor), 0.12 * y, 0.7 * high, "bronze")
    ys = list(np.linspace(-0.43, 0.43, 8) * y)
    for px in (-0.42 * x, 0.42 * x):
        m.columns(b, px, ys, floor, high, 0.028 * y, stone)
    for px in np.linspace(-0.25, 0.25, 3) * x:
        m.columns(b, px, [ys[0], ys[-1]], floor, high, 0.028 * y, stone)
    b.box((0.92 * x, 0.94 * y, 0.1 * z), (0, 0, floor + high), stone)
    m.pediment(b, 0.47 * x, 0.94 * x, 0.98 * y, floor + high + 0.1 * z, 1.0 * z - (floor + high + 0.1 * z), stone)


def _south_temple(b: MeshBuilder, size: Size) -> None:
    """A stepped gate tower full of niches."""
    x, y, z = size
    colors = ("#d9a84a", "#c8643c", "#5f9a8f", "#d98aa0", "#e2c46a", "#7aa0c8")
    b.box((x, y, 0.05 * z), (0, 0, 0), "sandstone")
    b.box((0.8 * x, 0.86 * y, 0.22 * z), (0, 0, 0.05 * z), "#cdb48a")
    m.gate(b, (0.4 * x, 0, 0.05 * z), 0.16 * y, 0.2 * z, "dark wood")
    for s in (-1, 1):
        m.columns(b, 0.43 * x, [s * 0.14 * y, s * 0.3 * y, s * 0.4 * y], 0.05 * z, 0.22 * z, 0.016 * y, "#c8643c", 8)
    for k in range(6):
        share, low = 1 - 0.11 * k, (0.27 + 0.105 * k) * z
        b.box((0.7 * x * share, 0.76 * y * share, 0.085 * z), (0, 0, low), colors[k], taper=(0.94, 0.94))
        b.box((0.74 * x * share, 0.8 * y * share, 0.022 * z), (0, 0, low + 0.085 * z), shade(colors[k], 0.75))
        for j in np.linspace(-0.32, 0.32, 7 - k // 2):
            at = (0.355 * x * share, j * y * share, low + 0.008 * z)
            b.box((0.03 * x, 0.05 * y, 0.06 * z), at, colors[(k + 2) % 6], taper=(0.7, 0.5))
    with b.frame((0, 0, 0.9 * z)):
        b.ball((0.14 * x, 0.2 * y, 0.05 * z), (0, 0, 0.02 * z), "#d9a84a", segments=12, rings=6)
        for j in (-0.12, -0.04, 0.04, 0.12):
            b.cone(0.02 * y, 0.04 * z, (0, j * y, 0.06 * z), "gold", segments=6)


@recipe("temple", 3, hulls=12, name="pagodas.temple")
def temple(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A hall under sweeping tiled roofs; a columned temple; a stepped tower of many colours."""
    size, b = size_of("temple", variant), MeshBuilder(roughness=0.8)
    if variant == 0:
        _east_temple(b, size, "#c8923a", "#a82a24")
    elif variant == 1:
        _south_temple(b, size)
    else:
        _greek_temple(b, size)
    names = ("temple hall under two tiled roofs", "stepped temple tower of many colours", "columned stone temple")
    return fitted_as(b.build(names[variant]), "temple", size)


@recipe("shrine", 3, hulls=8, name="pagodas.shrine")
def shrine(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A small wooden shrine behind a red gate; a roadside shrine with a statue; a spirit house on a post."""
    size, b = size_of("shrine", variant), MeshBuilder(roughness=0.8)
    x, y, z = size
    if variant == 0:
        for s in (-1, 1):  # the gate
            b.cylinder(0.03 * y, 0.84 * z, (0.42 * x, s * 0.34 * y, 0), "signal red", top_radius=0.025 * y, segments=10)
        b.box((0.05 * x, 0.82 * y, 0.05 * z), (0.42 * x, 0, 0.62 * z), "signal red")
        b.box((0.08 * x, y, 0.06 * z), (0.42 * x, 0, 0.82 * z), "signal red", taper=(1.0, 1.06))
        b.box((0.1 * x, 1.04 * y, 0.04 * z), (0.42 * x, 0, 0.88 * z), "black")
        with b.frame((-0.16 * x, 0, 0)):
            b.box((0.66 * x, 0.72 * y, 0.12 * z), (0, 0, 0), "granite")
            b.box((0.42 * x, 0.48 * y, 0.34 * z), (0, 0, 0.12 * z), "wood")
            m.gate(b, (0.21 * x, 0, 0.14 * z), 0.24 * y, 0.26 * z, "light wood")
            m.hip_roof(b, (0.74 * x, 0.84 * y, 0.34 * z), (0, 0, 0.46 * z), "#4a6a5c", 0.7, 0.08 * z)
            b.rod((0.31 * x, -0.2 * y, 0.42 * z), (0.31 * x, 0.2 * y, 0.42 * z), 0.02 * y, "cream", 6)
    elif variant == 1:
        b.box((0.95 * x, 0.95 * y, 0.16 * z), (0, 0, 0), "granite")
        b.box((0.3 * x, 0.78 * y, 0.56 * z), (-0.25 * x, 0, 0.16 * z), "off white")
        for s in (-1, 1):
            b.box((0.76 * x, 0.14 * y, 0.56 * z), (0, s * 0.33 * y, 0.16 * z), "off white")
        b.box((0.1 * x, 0.54 * y, 0.5 * z), (-0.1 * x, 0, 0.2 * z), "light blue")
        m.pediment(b, 0.46 * x, 0.9 * x, y, 0.72 * z, 0.2 * z, "#8c4a34")
        b.lathe(
            [(0.12 * x, 0), (0.1 * x, 0.12 * z), (0.05 * x, 0.27 * z)],
            (0.14 * x, 0, 0.2 * z),
            "signal blue",
            segments=10,
        )
        b.ball(0.045 * z, (0.14 * x, 0, 0.5 * z), "skin light", segments=10, rings=6)
        m.finial(b, (0.3 * x, 0, 0.9 * z), 0.12 * z, "cross")
        for s in (-1, 1):
            b.cylinder(0.05 * x, 0.08 * z, (0.36 * x, s * 0.18 * y, 0.16 * z), "red", segments=8)
    else:
        b.box((x, y, 0.05 * z), (0, 0, 0), "granite")
        b.lathe(
            [(0.22 * x, 0.05 * z), (0.1 * x, 0.12 * z), (0.09 * x, 0.36 * z), (0.3 * x, 0.42 * z)], (0, 0, 0), "#b5302a"
        )
        b.box((0.72 * x, 0.72 * y, 0.03 * z), (0, 0, 0.42 * z), "gold")
        b.box((0.4 * x, 0.4 * y, 0.2 * z), (-0.04 * x, 0, 0.45 * z), "#b5302a")
        m.gate(b, (0.16 * x, 0, 0.46 * z), 0.2 * y, 0.15 * z, "gold")
        for s in (-1, 1):
            m.columns(b, 0.28 * x, [s * 0.28 * y], 0.45 * z, 0.2 * z, 0.02 * x, "gold", 6)
        for k in range(3):
            share = 1 - 0.26 * k
            m.hip_roof(
                b, (0.8 * x * share, 0.8 * y * share, 0.14 * z), (0, 0, (0.65 + 0.08 * k) * z), "#2f6f4a", 0.4, 0.03 * z
            )
        b.cone(0.04 * x, 0.16 * z, (0, 0, 0.86 * z), "gold", segments=8)
    names = (
        "wooden shrine behind a red gate",
        "wayside shrine with a statue under a gable",
        "gilt spirit house on a post",
    )
    return fitted_as(b.build(names[variant]), "shrine", size)
