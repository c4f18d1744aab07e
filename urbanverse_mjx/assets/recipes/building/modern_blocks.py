"""Skyscrapers, planetariums, kindergartens, institutes and conference centres: houses known by their form."""

import numpy as np

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, rgb, shade
from ...meshes.recipe import recipe
from ..shared.sizes import fitted_as, size_of
from . import masonry as m
from .civic_halls import wing
from .shops.icons import ICONS, Ink

Point3 = tuple[float, float, float]


def glass_skin(
    size_m: tuple[float, float], floors: int, bays: int, glass: Color, frame: Color, rng: np.random.Generator
) -> np.ndarray:
    """A curtain wall: panes of slightly different tone between mullions, paler towards the sky."""
    cell = 6 if floors * 6 <= 240 else 4
    w, h = min(bays * 6, 200), min(floors * cell, 240)
    tone = rng.normal(0, 0.07, (floors, bays))
    rows = (np.arange(h) * floors // h)[:, None]
    cols = (np.arange(w) * bays // w)[None, :]
    sky = 0.3 * (1 - np.arange(h)[:, None] / h)
    base, pale = np.array(rgb(glass), float), np.array([206.0, 224.0, 236.0])
    image = base * (1 + tone[rows, cols])[..., None]
    image = image + (pale - image) * sky[..., None]
    edge = ((np.arange(h) * floors % h) < floors)[:, None] | ((np.arange(w) * bays % w) < bays)[None, :]
    image[edge] = rgb(frame)
    return np.clip(image, 0, 255).astype(np.uint8)


@recipe("skyscraper", 3, hulls=6, name="modern_blocks.skyscraper")
def skyscraper(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A stepped stone tower with a spire; a glass slab with a sloped crown; a twisted tower of glass."""
    size, b = size_of("skyscraper", variant), MeshBuilder(roughness=0.35)
    x, y, z = size
    if variant == 0:
        stone: Color = "#c9bfa8"
        levels = ((1.0, 0.0, 0.3), (0.8, 0.3, 0.58), (0.6, 0.58, 0.78), (0.4, 0.78, 0.88))
        for share, low, top in levels:
            high = (top - low) * z
            face = m.painted_front(
                (share * y, high),
                (round(14 * share), max(4, round(high / 4.5))),
                ("plaster", stone),
                ("single", "dark grey"),
                rng,
                90,
                (0.5, 0.66),
            )
            m.block(b, (share * x, share * y, high), (0, 0, low * z), face, shade(stone, 0.8))
            for k in np.linspace(-0.46, 0.46, max(3, round(8 * share))):
                for s in (-1, 1):
                    b.box(
                        (0.01 * x, 0.02 * y, high * 1.02),
                        (s * share * x / 2, k * share * y, low * z),
                        shade(stone, 1.1),
                    )
                    b.box(
                        (0.02 * x, 0.01 * y, high * 1.02),
                        (k * share * x, s * share * y / 2, low * z),
                        shade(stone, 1.1),
                    )
        b.cylinder(0.12 * x, 0.06 * z, (0, 0, 0.88 * z), "#8fa5a5", (0, 0, 45), 0.03 * x, 8)
        b.cylinder(0.012 * x, 0.07 * z, (0, 0, 0.93 * z), "aluminium", top_radius=0.002 * x, segments=6)
    elif variant == 1:
        skin = glass_skin((y, z), 40, 22, "#3f6f8f", "#c9d6dc", rng)
        b.box(
            (0.9 * x, 0.94 * y, 0.84 * z),
            (0, 0, 0.03 * z),
            "charcoal",
            skins=dict.fromkeys(("+x", "-x", "+y", "-y"), skin),
        )
        b.profile([(-0.45 * x, 0.87 * z), (0.45 * x, 0.87 * z), (-0.45 * x, z)], 0.94 * y, color="#6f9ab0")
        for s in (-1, 1):
            b.box((0.1 * x, 0.03 * y, 0.88 * z), (0.45 * x, s * 0.46 * y, 0.03 * z), "aluminium")
    else:
        n, turns = 14, 90.0
        skin = glass_skin((y, z), 4, 20, "#4f7a74", "#dfe8e6", rng)
        ring = np.array([(1, -1), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)], float)
        for k in range(n):
            sections = []
            for t in (k / n, (k + 1) / n):
                a, share = np.radians(turns * t), 0.36 * (1 - 0.25 * t)
                turn = np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]])
                sections.append(np.column_stack([ring @ turn.T * share * [x, y], np.full(9, (0.03 + 0.9 * t) * z)]))
            b.sheet(np.stack(sections), image=skin)
        top = sections[1][:8]
        b.convex(np.concatenate([top, top * [0.5, 0.5, 1] + [0, 0, 0.04 * z]]), "#dfe8e6")
        b.cylinder(0.01 * x, 0.05 * z, (0, 0, 0.95 * z), "aluminium", segments=6)
    b.box((x, y, 0.03 * z), (0, 0, 0), "granite")
    b.box((0.04 * x, 0.4 * y, 0.02 * z), (0.48 * x, 0, 0.01 * z), "charcoal")
    m.gate(b, (0.5 * x, 0, 0), 0.2 * y, 0.016 * z, "charcoal")
    names = ("stepped stone skyscraper with a spire", "glass skyscraper with a sloped top", "twisted glass skyscraper")
    return fitted_as(b.build(names[variant]), "skyscraper", size)


@recipe("planetarium", 3, hulls=4, name="modern_blocks.planetarium")
def planetarium(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A great dome over a low ring with an entrance, stars on its sign and a planet with rings before it."""
    size, b = size_of("planetarium", variant), MeshBuilder(roughness=0.4)
    x, y, z = size
    shell: Color = ("#dfe3e6", "#2f4a7a", "#7fa39a")[variant]
    low, r = 0.34 * z, 0.42 * x
    face = m.painted_front((y, low), (14, 1), ("plaster", "#e9e4d8"), ("single", "dark grey"), rng, 120, (0.5, 0.6))
    if variant == 1:
        b.box((0.92 * x, y, 0.8 * low), (-0.03 * x, 0, 0), "off white", skins={"+x": face, "+y": face, "-y": face})
    else:
        b.cylinder(0.49 * x, low, (-0.01 * x, 0, 0), "off white", segments=28)
        for k in range(18):
            with b.frame((-0.01 * x, 0, 0), (0, 0, 20 * k + 10)):
                b.box((0.02 * x, 0.09 * x, 0.6 * low), (0.485 * x, 0, 0.2 * low), "dark glass")
        for s in (-1, 1):
            b.box((0.4 * x, 0.2 * y, 0.7 * low), (0, s * 0.4 * y, 0), "off white")
    m.dome(b, (-0.02 * x, 0, 0.8 * low), r, shell, (z - 0.8 * low) / r, sides=26)
    for k in range(12):  # ribs of the dome
        a = 2 * np.pi * k / 12
        t = np.linspace(0, 1.5, 7)
        path = [
            (
                -0.02 * x + 1.005 * r * np.cos(u) * np.cos(a),
                1.005 * r * np.cos(u) * np.sin(a),
                0.8 * low + (z - 0.8 * low) * np.sin(u),
            )
            for u in t
        ]
        b.tube(path, 0.008 * x, shade(shell, 0.8), 4)
    b.box((0.1 * x, 0.34 * y, 0.8 * low), (0.45 * x, 0, 0), "dark blue")
    night, pen = paint.canvas((420, 90), "dark blue")
    for _ in range(70):
        px, py = rng.random() * 420, rng.random() * 90
        pen.ellipse((px - 2, py - 2, px + 2, py + 2), fill=rgb("lamp"))
    paint.text(pen, "PLANETARIUM", (16, 14, 404, 76), "white", 0.04)
    b.box(
        (0.04 * x, 0.5 * y, 0.3 * low),
        (0.48 * x, 0, 0.8 * low),
        "dark blue",
        skins={"+x": paint.shrunk(night, (210, 45))},
    )
    m.gate(b, (0.502 * x, 0, 0), 0.18 * y, 0.64 * low, "charcoal")
    planet = (0.42 * x, 0.4 * y, 0.3 * z)
    b.cylinder(0.01 * x, 0.24 * z, (planet[0], planet[1], 0), "aluminium", segments=6)
    b.ball(0.075 * z, planet, "amber", segments=12, rings=8)
    b.ring(0.12 * z, 0.01 * z, planet, "cream", (20, 0, 0), segments=20, sides=4)
    names = ("white-domed planetarium", "blue-domed planetarium", "copper-domed planetarium")
    return fitted_as(b.build(names[variant]), "planetarium", size)


@recipe("kindergarten", 3, hulls=8, name="modern_blocks.kindergarten")
def kindergarten(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Low coloured pavilions with paintings on the windows, a sand pit, a slide, a fence of crayons."""
    size, b = size_of("kindergarten", variant), MeshBuilder(roughness=0.8)
    x, y, z = size
    tones: tuple[Color, ...] = (
        ("#f2c14a", "#e0684a", "#6fb06a"),
        ("#7fb8d8", "#f2d06a", "#e08aa0"),
        ("#e9e0d0", "#9ac06a", "#f0a04a"),
    )[variant]
    pane, pen = paint.canvas((160, 100), "dark glass")
    for k, color in enumerate(("red", "yellow", "lime", "orange", "pink", "light blue")):
        ICONS[("home", "apple", "teddy", "ball", "blocks", "fish")[k]](
            Ink(pen, 6 + 50 * (k % 3), 4 + 48 * (k // 3), 42), color
        )
    pen.rectangle((0, 0, 159, 99), outline=rgb("white"), width=6)
    window = paint.shrunk(pane, (72, 44))
    count = 3
    for k in range(count):
        at = (-0.16 * x, (k - 1) * 0.33 * y, 0.0)
        high = 0.6 * z
        b.box((0.6 * x, 0.32 * y, high), at, tones[k])
        front = at[0] + 0.3 * x
        for s in (-1, 1):
            b.panel(window, (front + 0.03, at[1] + s * 0.085 * y, 0.36 * z), 0.12 * y, 0.3 * z)
        with b.frame((at[0], at[1], high), (0, 0, 90)):
            b.profile(
                [(-0.18 * y, 0), (0.18 * y, 0), (0, 0.4 * z)],
                0.66 * x,
                color=("#a8503a", "#5f6a70", "#7a4a34")[variant],
            )
            b.profile([(-0.13 * y, 0.05), (0.13 * y, 0.05), (0, 0.28 * z)], 0.665 * x, color=tones[k])
    m.gate(b, (0.14 * x + 0.03, 0, 0), 0.07 * y, 0.42 * z, "teal")
    m.board(b, "KINDERGARTEN", (0.17 * x, 0, 0.5 * z), 0.3 * y, 0.14 * z, "white", "signal red")
    b.box((0.38 * x, y, 0.02 * z), (0.31 * x, 0, 0), "grass")
    crayons: tuple[Color, ...] = ("signal red", "signal yellow", "signal blue", "green", "orange", "purple")
    n = 26
    for k in range(n):
        y0 = (k + 0.5) * y / n - y / 2
        if abs(y0) > 0.06 * y:
            b.cylinder(0.14, 0.2 * z, (0.485 * x, y0, 0), crayons[k % 6], segments=6)
            b.cone(0.14, 0.06 * z, (0.485 * x, y0, 0.2 * z), crayons[k % 6], segments=6)
    pit = (0.32 * x, -0.28 * y, 0.0)
    b.box((0.16 * x, 0.16 * y, 0.05 * z), pit, "wood")
    b.box((0.14 * x, 0.14 * y, 0.055 * z), pit, "#dcc48c")
    b.box((0.05 * x, 0.05 * x, 0.3 * z), (0.24 * x, 0.28 * y, 0), "signal blue")
    b.beam((0.26 * x, 0.28 * y, 0.3 * z), (0.42 * x, 0.28 * y, 0.04 * z), 0.7, 0.1, "signal red")
    names = (
        "yellow kindergarten of three pavilions",
        "blue kindergarten of three pavilions",
        "cream kindergarten of three pavilions",
    )
    return fitted_as(b.build(names[variant]), "kindergarten", size)


@recipe("research institute", 3, hulls=8, name="modern_blocks.research_institute")
def research_institute(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A laboratory block with flues on its roof, a dish aerial or an observatory dome, an atom before the door."""
    size, b = size_of("research institute", variant), MeshBuilder(roughness=0.55)
    x, y, z = size
    wall: m.Wall = (("panel", "#dfe3e4"), ("brick", "#8f5a48"), ("panel", "#5b6670"))[variant]
    high = 0.74 * z
    wing(
        b,
        (0.7 * x, 0.98 * y, high),
        (-0.1 * x, 0, 0),
        wall,
        4,
        ("ribbon", ("teal", "white", "aluminium")[variant]),
        rng,
        3.4,
        (0.9, 0.5),
    )
    b.box((0.34 * x, 0.2 * y, 0.86 * z), (0.12 * x, 0.2 * y, 0), ("teal", "charcoal", "#c9d4da")[variant])
    for k in range(6):
        b.cylinder(0.008 * y, 0.2 * z, (-0.2 * x, (-0.4 + 0.07 * k) * y, high), "aluminium", segments=8)
    if variant == 1:
        m.dome(b, (-0.1 * x, -0.02 * y, high + 0.04 * z), 0.13 * x, "white", 1.0, sides=16)
        b.cylinder(0.135 * x, 0.06 * z, (-0.1 * x, -0.02 * y, high), "white", segments=16)
        b.box((0.14 * x, 0.03 * x, 0.1 * z), (-0.03 * x, -0.02 * y, high + 0.06 * z), "black")
    else:
        with b.frame((-0.05 * x, 0.0, high + 0.06 * z), (0, 50, 0)):
            b.lathe(
                [
                    (0.0, 0.0),
                    (0.08 * x, 0.02 * x),
                    (0.13 * x, 0.07 * x),
                    (0.125 * x, 0.075 * x),
                    (0.07 * x, 0.035 * x),
                    (0.0, 0.02 * x),
                ],
                (0, 0, 0),
                "white",
                segments=18,
            )
            b.rod((0, 0, 0), (0, 0, 0.13 * x), 0.006 * x, "grey", 5)
        b.cylinder(0.02 * x, 0.1 * z, (-0.05 * x, 0, high), "grey", segments=8)
    m.board(b, "RESEARCH INSTITUTE", (0.255 * x, -0.16 * y, 0.62 * z), 0.46 * y, 0.1 * z, "dark blue", "white")
    m.gate(b, (0.295 * x, 0.2 * y, 0), 0.09 * y, 0.2 * z, "charcoal")
    b.box((0.12 * x, 0.16 * y, 0.03 * z), (0.34 * x, 0.2 * y, 0.22 * z), "charcoal")
    atom = (0.42 * x, -0.2 * y, 0.24 * z)
    b.cylinder(0.012 * x, 0.12 * z, (atom[0], atom[1], 0), "granite", segments=8)
    b.ball(0.035 * z, atom, "signal red", segments=10, rings=6)
    for k in range(3):
        b.ring(0.12 * z, 0.01 * z, atom, "aluminium", (90, 60 * k, 0), segments=20, sides=5)
    names = (
        "laboratory block with a dish aerial",
        "brick institute with an observatory dome",
        "dark institute with a dish aerial",
    )
    return fitted_as(b.build(names[variant]), "research institute", size)


@recipe("conference center", 3, hulls=6, name="modern_blocks.conference_center")
def conference_center(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A long glass foyer under a sweeping roof on slender columns, halls behind it, flags before it."""
    size, b = size_of("conference center", variant), MeshBuilder(roughness=0.4)
    x, y, z = size
    glass: Color = ("#4f7f9a", "#5f7a70", "#3f5f86")[variant]
    b.box((0.44 * x, 0.9 * y, 0.62 * z), (-0.24 * x, 0, 0), "#d4d6d4")
    skin = glass_skin((0.92 * y, 0.6 * z), 5, 26, glass, "white", rng)
    b.box(
        (0.42 * x, 0.92 * y, (0.7, 0.62, 0.56)[variant] * z),
        (0.14 * x, 0, 0),
        "white",
        skins=dict.fromkeys(("+x", "+y", "-y"), skin),
    )
    if variant == 0:  # a wing that rises towards the street
        path = [(-0.48 * x, 0.62 * z), (-0.2 * x, 0.68 * z), (0.1 * x, 0.8 * z), (0.49 * x, z)]
        b.profile(
            [*path, (0.49 * x, 0.96 * z), (0.1 * x, 0.74 * z), (-0.2 * x, 0.62 * z), (-0.48 * x, 0.57 * z)],
            y,
            color="white",
        )
    elif variant == 1:  # waves along the street
        ys = np.linspace(-0.5, 0.5, 25) * y
        top = 0.82 * z + 0.17 * z * np.sin(np.linspace(0, 4 * np.pi, 25))
        with b.frame((0, 0, 0), (0, 0, 90)):
            b.profile(
                [*zip(ys, top, strict=True), *zip(ys[::-1], top[::-1] - 0.05 * z, strict=True)],
                0.96 * x,
                color="aluminium",
            )
    else:
        b.box((0.96 * x, y, 0.06 * z), (0, 0, 0.62 * z), "charcoal")
        b.ball((0.22 * x, 0.2 * y, 0.34 * z), (-0.08 * x, 0.1 * y, 0.66 * z), "#c98a4a", segments=16, rings=8)
    for k in range(9):
        py = (k / 8 - 0.5) * 0.94 * y
        b.cylinder(0.006 * y, (0.92, 0.6, 0.62)[variant] * z, (0.45 * x, py, 0), "white", segments=8)
    m.board(
        b,
        ("CONFERENCE CENTER", "CONGRESS CENTRE", "CONVENTION HALL")[variant],
        (0.36 * x, 0, 0.4 * z),
        0.6 * y,
        0.11 * z,
        "dark blue",
        "white",
    )
    for k in (-1, 0, 1):
        m.gate(b, (0.352 * x, 0.1 * y * k, 0), 0.07 * y, 0.2 * z, "aluminium")
    for k in range(5):
        m.flag(
            b,
            (0.48 * x, (0.2 + 0.06 * k) * y, 0),
            0.5 * z,
            (("signal blue", "white"), ("signal red", "white"), ("green", "white"))[k % 3],
        )
    names = (
        "conference centre under a rising roof",
        "conference centre under a waved roof",
        "convention hall with a copper egg",
    )
    return fitted_as(b.build(names[variant]), "conference center", size)
