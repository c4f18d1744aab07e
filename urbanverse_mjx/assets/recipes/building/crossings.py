"""Bridges, tunnels and railway stations."""

import itertools

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import recipe
from ..shared.sizes import Size, fitted_as, size_of
from . import masonry as m
from .civic_halls import wing
from .landmarks import arched_wall


def _stone_bridge(b: MeshBuilder, size: Size, stone: Color) -> None:
    """Two arches, a hump, parapets with end posts and a cutwater on the pier."""
    x, y, z = size
    with b.frame((0, 0, 0), (0, 0, 90)):
        arched_wall(b, 0.96 * y, x, 0.62 * z, [(-0.23 * x, 0.18 * x, 0.46 * z), (0.23 * x, 0.18 * x, 0.46 * z)], stone)
    b.profile(
        [
            (-0.5 * x, 0.6 * z),
            (0.5 * x, 0.6 * z),
            (0.5 * x, 0.66 * z),
            (0.1 * x, 0.76 * z),
            (-0.1 * x, 0.76 * z),
            (-0.5 * x, 0.66 * z),
        ],
        0.96 * y,
        color="#8f8a80",
    )
    for s in (-1, 1):
        b.profile(
            [
                (-0.5 * x, 0.62 * z),
                (0.5 * x, 0.62 * z),
                (0.5 * x, 0.86 * z),
                (0.1 * x, 0.97 * z),
                (-0.1 * x, 0.97 * z),
                (-0.5 * x, 0.86 * z),
            ],
            0.06 * y,
            (0, s * 0.47 * y, 0),
            stone,
        )
        b.convex(
            [
                (u * 0.03 * x, s * (0.48 + v) * y, w)
                for u, v, w in (
                    (-1, 0, 0),
                    (1, 0, 0),
                    (0, 0.02, 0),
                    (-1, 0, 0.5 * z),
                    (1, 0, 0.5 * z),
                    (0, 0.02, 0.5 * z),
                )
            ],
            shade(stone, 0.85),
        )
        for px in (-0.48, 0.48):
            b.box((0.04 * x, 0.09 * y, 0.94 * z), (px * x, s * 0.46 * y, 0), shade(stone, 1.06))


def _framed_bridge(b: MeshBuilder, size: Size, stone: Color, timber: bool) -> None:
    """An arched deck of planks between railings, or a level deck in a steel truss."""
    x, y, z = size
    deck = (0.4 if timber else 0.3) * z

    def arch(t: float) -> float:
        return deck + ((0.22 * z) * (1 - (2 * t) ** 2) if timber else 0.0)

    ts = np.linspace(-0.5, 0.5, 13)
    for t0, t1 in itertools.pairwise(ts):
        mid = (t0 + t1) / 2
        b.box(
            (x / 12 * 0.94, 0.92 * y, 0.05 * z),
            (mid * x, 0, arch(mid)),
            "light wood" if timber else "dark concrete",
        )
    top = 0.36 * z if timber else 0.66 * z
    for s in (-1, 1):
        b.tube([(t * x, s * 0.46 * y, arch(t) - 0.03 * z) for t in ts], 0.05 * z, stone, 6)
        b.tube([(t * x, s * 0.46 * y, arch(t) + top) for t in (ts if timber else ts[1:-1])], 0.03 * z, stone, 6)
        for k, t in enumerate(ts if timber else ts[1:-1]):
            b.rod((t * x, s * 0.46 * y, arch(t)), (t * x, s * 0.46 * y, arch(t) + top), 0.018 * z, stone, 5)
            if not timber and k < 10:
                a, c = (0.0, top) if k % 2 == 0 else (top, 0.0)
                b.rod((t * x, s * 0.46 * y, deck + a), (ts[k + 2] * x, s * 0.46 * y, deck + c), 0.02 * z, stone, 5)
        if not timber:
            b.rod((-0.49 * x, s * 0.46 * y, deck), (ts[1] * x, s * 0.46 * y, deck + top), 0.03 * z, stone, 6)
            b.rod((0.49 * x, s * 0.46 * y, deck), (ts[-2] * x, s * 0.46 * y, deck + top), 0.03 * z, stone, 6)
    for px in (-0.47, 0.47):
        b.box((0.06 * x, y, arch(0.47)), (px * x, 0, 0), "concrete")
    if timber:
        for px in (-0.17, 0.17):
            b.box((0.03 * x, 0.8 * y, arch(0.17)), (px * x, 0, 0), "dark wood")
    else:
        for t in ts[1:-1:2]:
            b.rod((t * x, -0.46 * y, deck + top), (t * x, 0.46 * y, deck + top), 0.025 * z, stone, 5)


@recipe("bridge", 3, hulls=10, name="crossings.bridge")
def bridge(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A stone bridge of two arches, a timber foot bridge, a steel truss; one crosses along x."""
    size, b = size_of("bridge", variant), MeshBuilder(roughness=0.85)
    stone: Color = ("#a89c86", "wood", "#4f7f6a")[variant]
    if variant == 0:
        _stone_bridge(b, size, stone)
    else:
        _framed_bridge(b, size, stone, timber=variant == 1)
    names = ("stone bridge of two arches", "arched timber foot bridge", "green steel truss bridge")
    return fitted_as(b.build(names[variant]), "bridge", size)


@recipe("tunnel", 3, hulls=8, name="crossings.tunnel")
def tunnel(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A portal in a green slope with the road going in; stone for trains, concrete for cars."""
    size, b = size_of("tunnel", variant), MeshBuilder(roughness=0.9)
    x, y, z = size
    stone: Color = ("concrete", "#9a8c78", "brick")[variant]
    half, top = 0.34 * y, 0.72 * z
    arched_wall(b, 0.1 * x, y, 0.92 * z, [(0.0, half, top)], stone, 0.44 * x)
    arched_wall(b, 0.8 * x, 0.86 * y, 0.8 * z, [(0.0, 0.94 * half, 0.97 * top)], "#4a4844", 0.0)
    b.box((0.04 * x, 0.8 * y, 0.78 * z), (-0.38 * x, 0, 0), "black")
    b.box((0.12 * x, 1.0 * y, 0.05 * z), (0.44 * x, 0, 0.92 * z), shade(stone, 1.1))
    b.box((x, 2 * half, 0.02 * z), (0, 0, 0), "asphalt" if variant != 1 else "#77706a")
    a = np.linspace(0, np.pi, 11)
    ring = [
        (0.495 * x, (half + 0.02 * y) * np.cos(t), top - half + (half + 0.02 * z) * np.sin(t))
        if half < top
        else (0.0, 0.0, 0.0)
        for t in a
    ]
    b.tube(ring, 0.03 * z, shade(stone, 1.15), 6)
    for k in range(6):  # a grass slope over and beside the tube
        px, tone = (0.34 - 0.15 * k) * x, shade("#6f8f48", 0.92 + 0.05 * (k % 3))
        for s in (-1, 1):
            flank = ((0.39, 0.0), (0.5, 0.0), (0.42, 0.82), (0.39, 0.82))
            b.convex([(px + u * 0.1 * x, s * v * y, w * z) for u in (-1, 1) for v, w in flank], tone)
        cap = ((-0.43, 0.8), (0.43, 0.8), (-0.3, 0.93), (0.3, 0.93), (0.0, 0.98))
        b.convex([(px + u * 0.1 * x, v * y, w * z) for u in (-1, 1) for v, w in cap], tone)
    if variant == 1:
        for s in (-1, 1):
            b.box((x, 0.08, 0.03 * z), (0, s * 0.72, 0.04 * z), "rust")
        for k in range(12):
            b.box((0.22, 2.6, 0.02 * z), ((k / 11 - 0.5) * 0.96 * x, 0, 0.02 * z), "dark wood")
    else:
        for k in range(7):
            b.box((0.07 * x, 0.14, 0.005 * z), ((k / 6 - 0.5) * 0.9 * x, 0, 0.02 * z), "white")
        m.board(
            b,
            ("TUNNEL", "", "OLD TUNNEL")[variant],
            (0.485 * x, 0, 0.76 * z),
            0.4 * y,
            0.13 * z,
            "signal blue",
            "white",
        )
    names = ("concrete road tunnel", "stone railway tunnel", "brick road tunnel")
    return fitted_as(b.build(names[variant]), "tunnel", size)


@recipe("train station", 3, hulls=10, name="crossings.train_station")
def train_station(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """An entrance hall with a great arched window and clock; wings; a platform roof and a train behind."""
    size, b = size_of("train station", variant), MeshBuilder(roughness=0.8)
    x, y, z = size
    wall: m.Wall = (("ashlar", "#d0bd94"), ("brick", "#94553f"), ("panel", "#c3cace"))[variant]
    style = (("arch", "white"), ("sash", "white"), ("ribbon", "charcoal"))[variant]
    wing(b, (0.36 * x, 0.96 * y, 0.56 * z), (0.1 * x, 0, 0), wall, 2, style, rng, 4.0, (0.5, 0.66))
    hall = 0.24 * y
    b.box((0.5 * x, hall, 0.76 * z), (0.14 * x, 0, 0), shade(wall[1], 1.04))
    front = 0.39 * x
    if variant == 2:
        b.box((0.6 * x, 1.3 * hall, 0.04 * z), (0.2 * x, 0, 0.78 * z), "charcoal")
        glass = m.painted_front((hall, 0.7 * z), (8, 4), ("panel", "white"), ("ribbon", "white"), rng, 80, (0.9, 0.9))
        b.panel(glass, (front + 0.03, 0, 0.4 * z), 0.94 * hall, 0.7 * z)
        t = 0.06 * y
        b.box((t, t, z), (0.3 * x, 0.72 * hall, 0), "off white")
        b.panel(m.clock_face(), (0.3 * x + t / 2 + 0.05, 0.72 * hall, 0.9 * z), 0.9 * t, 0.14 * z)
    else:
        m.pediment(b, front + 0.02, 0.5 * x, 1.08 * hall, 0.76 * z, 0.2 * z, wall[1])
        b.panel(
            m.arch_window("white", (64, 56), "dark glass", shade(wall[1], 1.04)),
            (front + 0.03, 0, 0.46 * z),
            0.72 * hall,
            0.46 * z,
        )
        b.panel(m.clock_face(48), (front + 0.1, 0, 0.84 * z), 0.15 * z, 0.15 * z)
        m.hip_roof(b, (0.4 * x, 0.98 * y, 0.12 * z), (0.1 * x, 0, 0.58 * z), "#5f5a58", 0.9)
    b.box((0.1 * x, 1.1 * hall, 0.03 * z), (front + 0.05 * x, 0, 0.24 * z), "charcoal")
    m.board(
        b,
        ("CENTRAL STATION", "RAILWAY STATION", "STATION")[variant],
        (front + 0.1 * x, 0, 0.19 * z),
        1.2 * hall,
        0.15 * z,
        "signal blue",
        "white",
    )
    for k in (-1, 0, 1):
        m.gate(b, (front, 0.28 * hall * k, 0), 0.2 * hall, 0.19 * z, "charcoal")
    b.box((0.2 * x, y, 0.08 * z), (-0.2 * x, 0, 0), "light grey")
    b.box((0.26 * x, y, 0.03 * z), (-0.22 * x, 0, 0.42 * z), "dark grey")
    for k in range(8):
        b.cylinder(0.004 * y, 0.42 * z, (-0.22 * x, (k / 7 - 0.5) * 0.92 * y, 0), "dark green", segments=6)
    b.box((0.12 * x, y, 0.02 * z), (-0.42 * x, 0, 0), "#77706a")
    for s in (-1, 1):
        b.box((0.08, y, 0.03 * z), (-0.42 * x + s * 0.72, 0, 0.02 * z), "rust")
    for k in range(3):
        at = (-0.42 * x, (k - 1) * 0.26 * y + 0.06 * y, 0.08 * z)
        b.box((0.11 * x, 0.245 * y, 0.26 * z), at, ("signal red", "dark green", "signal blue")[variant], bevel=0.3)
        b.box((0.112 * x, 0.22 * y, 0.09 * z), (at[0], at[1], 0.19 * z), "dark glass")
    names = ("sandstone railway station", "brick railway station", "modern station with a clock tower")
    return fitted_as(b.build(names[variant]), "train station", size)
