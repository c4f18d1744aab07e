"""Towers, gates, arches, bridges and tunnels: single masonry landmarks."""

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import recipe
from ..shared import facade_images as images
from ..shared.sizes import fitted_as, size_of
from . import masonry as m


def arched_wall(
    b: MeshBuilder,
    depth: float,
    width: float,
    height: float,
    arches: list[tuple[float, float, float]],
    color: Color,
    x: float = 0.0,
) -> None:
    """A wall across y with arches (y of the middle, half width, height) cut through it along x.

    Piers and what spans the openings are solids of their own, so that the collision hulls leave the passages free.
    """
    edge = -width / 2
    for y, half, top in [*sorted(arches), (width / 2, 0.0, 0.0)]:
        b.box((depth, y - half - edge, height), (x, (y - half + edge) / 2, 0), color)
        edge = y + half
        if half > 0:
            spring = max(top - half, 0.4 * top)
            a = np.linspace(np.pi, 0, 9)
            soffit = [(y + half * np.cos(t), spring + (top - spring) * np.sin(t)) for t in a]
            with b.frame((x, 0, 0), (0, 0, 90)):
                b.profile([*soffit, (y + half, height), (y - half, height)], depth, color=color)


def battlements(b: MeshBuilder, size: tuple[float, float], z: float, tooth: float, color: Color) -> None:
    """Merlons round the top of a block of size (x, y) at height z."""
    for axis in (0, 1):
        length, other = size[axis], size[1 - axis]
        count = max(2, round(length / (2.2 * tooth)))
        for k in range(count):
            along = (k + 0.5) / count * length - length / 2
            for s in (-1, 1):
                across = s * (other / 2 - tooth * 0.25)
                at = (along, across, z) if axis == 0 else (across, along, z)
                b.box((tooth, 0.5 * tooth, tooth) if axis == 0 else (0.5 * tooth, tooth, tooth), at, color)


@recipe("tower", 3, hulls=6, name="landmarks.tower")
def tower(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A battlemented keep; a round tower with a cone roof; a brick tower with a loggia."""
    size, b = size_of("tower", variant), MeshBuilder(roughness=0.9)
    w, z = size[0], size[2]
    stone: Color = ("#a79c88", "#bfb29a", "#a05f45")[variant]
    if variant == 1:
        b.lathe(
            [(0.46 * w, 0), (0.42 * w, 0.06 * z), (0.40 * w, 0.7 * z), (0.48 * w, 0.74 * z), (0.48 * w, 0.8 * z)],
            (0, 0, 0),
            stone,
            segments=18,
        )
        b.cone(0.5 * w, 0.2 * z, (0, 0, 0.8 * z), "#5a4644", segments=18)
        for k in range(5):
            with b.frame((0, 0, (0.16 + 0.13 * k) * z), (0, 0, 60.0 * k - 60)):
                b.box((0.1, 0.07 * w, 0.04 * z), (0.41 * w, 0, 0), "black")
        m.gate(b, (0.43 * w, 0, 0), 0.22 * w, 0.1 * z, "dark wood")
        return fitted_as(b.build("round tower with a cone roof"), "tower", size)
    image = images.wall("ashlar" if variant == 0 else "brick", (w, z), stone, rng, 64)
    shaft = (0.84 * w, 0.84 * w, (0.88, 0.74)[variant // 2] * z)
    m.block(b, shaft, (0, 0, 0), image, stone)
    b.box((0.92 * w, 0.92 * w, 0.04 * z), (0, 0, 0), shade(stone, 0.8))
    b.box((w, w, 0.05 * z), (0, 0, shaft[2]), shade(stone, 0.92))
    for turn in (0, 90, 180, 270):
        with b.frame((0, 0, 0), (0, 0, turn)):
            for k in range(3):
                pane = m.arch_window(shade(stone, 1.15), (20, 36), "black", stone)
                b.panel(pane, (0.425 * w, 0, (0.3 + 0.18 * k) * z), 0.16 * w, 0.09 * z)
    m.gate(b, (0.43 * w, 0, 0), 0.24 * w, 0.1 * z, "dark wood")
    if variant == 0:
        battlements(b, (w, w), shaft[2] + 0.05 * z, 0.11 * w, stone)
        m.flag(b, (0, 0, shaft[2] + 0.05 * z), 0.07 * z, ("signal red", "white"))
    else:
        for sx in (-1, 1):
            for sy in (-1, 1):
                b.box((0.18 * w, 0.18 * w, 0.1 * z), (sx * 0.35 * w, sy * 0.35 * w, shaft[2] + 0.05 * z), stone)
        b.box((0.5 * w, 0.5 * w, 0.1 * z), (0, 0, shaft[2] + 0.05 * z), "charcoal")
        m.hip_roof(b, (1.04 * w, 1.04 * w, 0.11 * z), (0, 0, shaft[2] + 0.15 * z), "#8a4a34", 0.0)
    return fitted_as(
        b.build(("square keep with battlements", "", "brick tower with an open loggia")[variant]), "tower", size
    )


@recipe("clock tower", 3, hulls=6, name="landmarks.clock_tower")
def clock_tower(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A square shaft with four dials under a spire, a dome or battlements."""
    size, b = size_of("clock tower", variant), MeshBuilder(roughness=0.85)
    w, z = size[0], size[2]
    stone: Color = ("#c7a774", "#9a5743", "#d8d3c6")[variant]
    kind = ("ashlar", "brick", "plaster")[variant]
    shaft = 0.62 * z
    front = m.painted_front((0.7 * w, shaft), (1, 4), (kind, stone), ("arch", shade(stone, 1.1)), rng, 64, (0.3, 0.5))
    b.box((w, w, 0.06 * z), (0, 0, 0), shade(stone, 0.8))
    m.block(b, (0.7 * w, 0.7 * w, shaft), (0, 0, 0.06 * z), front, stone)
    top = shaft + 0.06 * z
    b.box((0.9 * w, 0.9 * w, 0.02 * z), (0, 0, top - 0.02 * z), shade(stone, 1.12))
    b.box((0.82 * w, 0.82 * w, 0.15 * z), (0, 0, top), stone)
    for turn in (0, 90, 180, 270):
        with b.frame((0, 0, 0), (0, 0, turn)):
            b.panel(m.clock_face(56), (0.412 * w, 0, top + 0.075 * z), 0.74 * w, 0.135 * z)
            b.box((0.09 * w, 0.09 * w, shaft), (0.34 * w, 0.34 * w, 0.06 * z), shade(stone, 1.08))
    b.box((0.94 * w, 0.94 * w, 0.02 * z), (0, 0, top + 0.15 * z), shade(stone, 1.12))
    cap = top + 0.17 * z
    if variant == 0:
        b.cylinder(0.6 * w, z - cap, (0, 0, cap), "#4a6a68", (0, 0, 45), 0.02, 4)
    elif variant == 1:
        battlements(b, (0.94 * w, 0.94 * w), cap, 0.1 * w, stone)
        b.cylinder(0.3 * w, 0.06 * z, (0, 0, cap), stone, segments=8)
        b.cone(0.34 * w, 0.09 * z, (0, 0, cap + 0.06 * z), "#4d5560", segments=8)
    else:
        b.cylinder(0.32 * w, 0.04 * z, (0, 0, cap), stone, segments=12)
        m.dome(b, (0, 0, cap + 0.04 * z), 0.36 * w, "verdigris", 1.0, 0.3)
        m.finial(b, (0, 0, 0.94 * z), 0.06 * z, "ball")
    m.gate(b, (0.4 * w, 0, 0.0), 0.24 * w, 0.11 * z, "dark wood")
    names = (
        "sandstone clock tower with a spire",
        "brick clock tower with battlements",
        "white clock tower with a dome",
    )
    return fitted_as(b.build(names[variant]), "clock tower", size)


@recipe("lighthouse", 3, hulls=6, name="landmarks.lighthouse")
def lighthouse(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A tapering shaft in bands under a gallery and a glazed lantern."""
    size, b = size_of("lighthouse", variant), MeshBuilder(roughness=0.6)
    w, z = size[0], size[2]
    first, second = (("white", "signal red"), ("white", "black"), ("white", "signal blue"))[variant]
    bands, sides = (6, 5, 1)[variant], (18, 18, 8)[variant]
    low, high, r0, r1 = 0.05 * z, 0.78 * z, 0.42 * w, 0.27 * w
    b.cylinder(0.5 * w, low, (0, 0, 0), "granite", segments=sides)
    for k in range(bands):
        t0, t1 = k / bands, (k + 1) / bands
        ra, rb = r0 + (r1 - r0) * t0, r0 + (r1 - r0) * t1
        color = (first, second)[(k + 1) % 2] if bands > 1 else "white"
        b.cylinder(ra, (high - low) / bands, (0, 0, low + (high - low) * t0), color, top_radius=rb, segments=sides)
    b.lathe([(r1, 0), (0.38 * w, 0.02 * z), (0.38 * w, 0.035 * z)], (0, 0, high), "charcoal", segments=sides)
    deck = high + 0.035 * z
    b.ring(0.36 * w, 0.012 * w, (0, 0, deck + 0.035 * z), second, segments=16, sides=4)
    for k in range(10):
        a = 2 * np.pi * k / 10
        b.rod(
            (0.36 * w * np.cos(a), 0.36 * w * np.sin(a), deck),
            (0.36 * w * np.cos(a), 0.36 * w * np.sin(a), deck + 0.035 * z),
            0.008 * w,
            second,
            4,
        )
    b.cylinder(0.2 * w, 0.07 * z, (0, 0, deck), "lamp", segments=10)
    for k in range(5):
        a = 2 * np.pi * k / 5
        b.box((0.02 * w, 0.02 * w, 0.07 * z), (0.2 * w * np.cos(a), 0.2 * w * np.sin(a), deck), second)
    m.dome(b, (0, 0, deck + 0.07 * z), 0.24 * w, second, 0.8, sides=12)
    m.finial(b, (0, 0, deck + 0.07 * z + 0.17 * w), 0.05 * z, "ball", "black")
    m.gate(b, (r0, 0, 0.0), 0.2 * w, 0.12 * z, second)
    for k in range(3):
        x = r0 + (r1 - r0) * (0.3 + 0.22 * k)
        b.box((0.1 * w, 0.1 * w, 0.045 * z), (x - 0.03 * w, 0, (0.26 + 0.17 * k) * z), "dark glass")
    if variant == 2:
        plain = images.wall("plaster", (3, 3), "white", rng, 24)
        m.hall(b, (0.3 * w, 0.5 * w, 0.1 * z), (0.28 * w, 0, 0), 0.05 * z, plain, plain, "signal red", "white")
    names = ("red and white banded lighthouse", "black and white banded lighthouse", "white eight-sided lighthouse")
    return fitted_as(b.build(names[variant]), "lighthouse", size)


@recipe("triumphal arch", 3, hulls=8, name="landmarks.triumphal_arch")
def triumphal_arch(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """One or three passages between columns under a tall attic with an inscription."""
    size, b = size_of("triumphal arch", variant), MeshBuilder(roughness=0.9)
    x, y, z = size
    stone: Color = ("#d4c6a6", "#c8bda8", "#e2ddd0")[variant]
    arches = (
        [(0.0, 0.2 * y, 0.62 * z)],
        [(0.0, 0.15 * y, 0.6 * z), (-0.33 * y, 0.08 * y, 0.36 * z), (0.33 * y, 0.08 * y, 0.36 * z)],
        [(0.0, 0.22 * y, 0.66 * z)],
    )[variant]
    arched_wall(b, 0.84 * x, 0.92 * y, 0.8 * z, arches, stone)
    b.box((x, y, 0.035 * z), (0, 0, 0.74 * z), shade(stone, 1.06))
    b.box((0.82 * x, 0.9 * y, 0.17 * z), (0, 0, 0.78 * z), stone)
    b.box((0.96 * x, 0.97 * y, 0.03 * z), (0, 0, 0.95 * z), shade(stone, 1.06))
    words = ("VICTORIA", "IMPERATOR", "PAX")[variant]
    for s in (1, -1):
        with b.frame((0, 0, 0), (0, 0, 0 if s > 0 else 180)):
            m.board(b, words, (0.41 * x, 0, 0.82 * z), 0.6 * y, 0.09 * z, shade(stone, 0.95), "#5a4c38")
            ys = ([-0.4, -0.26, 0.26, 0.4], [-0.45, -0.2, 0.2, 0.45], [-0.4, 0.4])[variant]
            m.columns(b, 0.44 * x, [k * y for k in ys], 0.06 * z, 0.68 * z, 0.022 * y, shade(stone, 1.04))
            for k in ys:
                b.box((0.12 * x, 0.08 * y, 0.06 * z), (0.44 * x, k * y, 0), shade(stone, 0.9))
            for k in (-0.33, 0.33) if variant != 1 else ():
                b.box((0.03 * x, 0.1 * y, 0.16 * z), (0.42 * x, k * y, 0.4 * z), shade(stone, 0.86))
    if variant == 2:  # a chariot's horses on top
        for k in range(4):
            with b.frame((0.1 * x, (k - 1.5) * 0.09 * y, 0.98 * z)):
                b.ball((0.16 * x, 0.03 * y, 0.04 * z), (0, 0, 0.06 * z), "verdigris", segments=8, rings=5)
                b.beam((0.1 * x, 0, 0.07 * z), (0.2 * x, 0, 0.13 * z), 0.03 * y, 0.05 * x, "verdigris")
                for dx in (-0.1, 0.1):
                    b.box((0.03 * x, 0.02 * y, 0.06 * z), (dx * x, 0, 0), "verdigris")
    names = ("triumphal arch of one passage", "triumphal arch of three passages", "white arch with four bronze horses")
    return fitted_as(b.build(names[variant]), "triumphal arch", size)


@recipe("gatehouse", 3, hulls=14, name="landmarks.gatehouse")
def gatehouse(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A passage under rooms: between round towers, under a steep roof, or timber-framed."""
    size, b = size_of("gatehouse", variant), MeshBuilder(roughness=0.9)
    x, y, z = size
    stone: Color = ("#a89c88", "#a2583f", "#e6dcc6")[variant]
    high = (0.78, 0.62, 0.66)[variant] * z
    arched_wall(b, 0.8 * x, (0.62 if variant == 0 else 0.96) * y, high, [(0.0, 0.15 * y, 0.38 * z)], stone)
    pane = m.arch_window(shade(stone, 1.15), (20, 30), "black", stone)
    for k in (-1, 0, 1):
        b.panel(pane, (0.405 * x, k * 0.2 * y, 0.56 * z if variant == 0 else 0.5 * z), 0.09 * y, 0.13 * z)
    b.box((0.06 * x, 0.28 * y, 0.16 * z), (-0.2 * x, 0, 0.22 * z), "black")
    for k in range(5):  # the raised portcullis
        b.box((0.04 * x, 0.015 * y, 0.14 * z), (0.3 * x, (k - 2) * 0.055 * y, 0.24 * z), "dark wood")
    if variant == 0:
        for s in (-1, 1):
            b.lathe(
                [(0.21 * y, 0), (0.18 * y, 0.08 * z), (0.18 * y, 0.84 * z), (0.2 * y, 0.86 * z), (0.2 * y, 0.9 * z)],
                (0.2 * x, s * 0.3 * y, 0),
                stone,
                segments=14,
            )
            for k in range(7):
                a = 2 * np.pi * k / 7
                at = (0.2 * x + 0.17 * y * np.cos(a), s * 0.3 * y + 0.17 * y * np.sin(a), 0.9 * z)
                b.box((0.07 * y, 0.07 * y, 0.06 * z), at, stone)
        battlements(b, (0.8 * x, 0.3 * y), high, 0.07 * y, stone)
    else:
        if variant == 2:
            for k in np.linspace(-0.46, 0.46, 8):
                b.box((0.02 * x, 0.025 * y, 0.26 * z), (0.405 * x, k * y, 0.4 * z), "dark wood")
            for k in (0.4, 0.52, 0.64):
                b.box((0.03 * x, 0.96 * y, 0.02 * z), (0.405 * x, 0, k * z), "dark wood")
        m.hip_roof(b, (x, 1.04 * y, z - high), (0, 0, high), ("", "#5a4038", "#8a4a34")[variant], 0.45)
        m.flag(b, (0, 0, 0.86 * z), 0.18 * z, ("signal red", "white"))
    names = ("stone gatehouse between two round towers", "brick gatehouse with a steep roof", "timber-framed gatehouse")
    return fitted_as(b.build(names[variant]), "gatehouse", size)
