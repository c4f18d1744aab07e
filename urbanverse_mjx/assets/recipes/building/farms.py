"""Barns, cowsheds, greenhouses, farms, warehouses, factories and tanks."""

import numpy as np

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, rgb, shade
from ...meshes.recipe import recipe
from ..nature.foliage import leafy, small_leaves
from ..shared import facade_images as images
from ..shared.sizes import fitted_as, size_of
from . import masonry as m

Point3 = tuple[float, float, float]


def barn_door(color: Color, trim: Color = "white") -> np.ndarray:
    """(48, 48, 3): two wings braced with crosses."""
    image, pen = paint.canvas((192, 192), color)
    for k in range(12):
        pen.line((16 * k, 0, 16 * k, 192), fill=shade(color, 0.75), width=2)
    for k in (0, 96):
        pen.rectangle((k + 3, 3, k + 92, 188), outline=rgb(trim), width=9)
        pen.line((k + 6, 6, k + 90, 186), fill=rgb(trim), width=9)
        pen.line((k + 90, 6, k + 6, 186), fill=rgb(trim), width=9)
    return np.asarray(paint.shrunk(image, (48, 48)))


def gambrel(b: MeshBuilder, length: float, width: float, low: float, high: float, wall: Color, roof: Color) -> None:
    """A barn's body along x with the broken roof of American barns."""
    w = width / 2
    outline = [
        (-w, 0),
        (w, 0),
        (w, low),
        (0.62 * w, low + 0.62 * (high - low)),
        (0, high - 0.12),
        (-0.62 * w, low + 0.62 * (high - low)),
        (-w, low),
    ]
    top = [
        (1.08 * w, low - 0.1),
        (0.66 * w, low + 0.66 * (high - low)),
        (0, high),
        (-0.66 * w, low + 0.66 * (high - low)),
        (-1.08 * w, low - 0.1),
        (-1.0 * w, low - 0.1),
        (-0.62 * w, low + 0.62 * (high - low)),
        (0, high - 0.14),
        (0.62 * w, low + 0.62 * (high - low)),
        (1.0 * w, low - 0.1),
    ]
    with b.frame((0, 0, 0), (0, 0, 90)):
        b.profile(outline, length * 0.96, color=wall)
        b.profile(top, length, color=roof)


@recipe("barn", 3, hulls=8, name="farms.barn")
def barn(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Red with a gambrel roof; weathered boards under a gable; stone below and black boards above."""
    size, b = size_of("barn", variant), MeshBuilder(roughness=0.9)
    x, y, z = size
    color: Color = ("#9c2f28", "#8a7f70", "#3c3a38")[variant]
    front = 0.48 * x
    if variant == 0:
        gambrel(b, x, 0.92 * y, 0.42 * z, 0.9 * z, color, "#5a5c60")
    else:
        low = 0.52 * z
        boards = images.wall("boards", (x, low), color, rng, 100)
        end = images.wall("boards", (y, low), color, rng, 64)
        m.hall(
            b, (0.95 * x, 0.9 * y, low), (0, 0, 0), 0.46 * z, boards, end, ("", "#7a4034", "#6e4a3a")[variant], color
        )
        front = 0.475 * x
    if variant == 2:
        b.box((0.97 * x, 0.93 * y, 0.22 * z), (0, 0, 0), "#a39a88")
        front = 0.485 * x
    b.box((0.12, 0.5 * y, 0.44 * z), (front, 0, 0), "white" if variant == 0 else shade(color, 0.7))
    trim: Color = ("white", "cream", "white")[variant]
    b.panel(barn_door(color, trim), (front + 0.08, 0, 0.21 * z), 0.46 * y, 0.42 * z)
    b.box((0.12, 0.16 * y, 0.16 * z), (front - 0.01, 0, 0.6 * z), trim)
    b.panel(barn_door(color, trim), (front + 0.06, 0, 0.68 * z), 0.13 * y, 0.13 * z)
    for s in (-1, 1):
        b.box((0.1, 0.1 * y, 0.1 * z), (front, s * 0.36 * y, 0.2 * z), trim)
        b.box((0.14, 0.07 * y, 0.07 * z), (front, s * 0.36 * y, 0.215 * z), "dark glass")
        for k in (-0.3, 0.0, 0.3):
            b.box((0.07 * x, 0.05, 0.09 * z), (k * x, s * 0.465 * y, 0.22 * z), trim)
    if variant == 0:
        b.box((0.08 * x, 0.08 * x, 0.1 * z), (0, 0, 0.86 * z), "white")
        b.cone(0.07 * x, 0.06 * z, (0, 0, 0.96 * z), "#5a5c60", segments=4)
    else:
        for k in range(3):
            b.cylinder(
                0.09 * y,
                0.12 * y,
                (front + 0.1 * y, (0.32 + 0.05 * k) * y, (0.1 * (k == 2)) * y),
                "#d6b765",
                segments=12,
            )
    names = ("red barn with a gambrel roof", "weathered wooden barn", "black barn on a stone base")
    return fitted_as(b.build(names[variant]), "barn", size)


def _cow(b: MeshBuilder, at: Point3, k: float, spots: Color) -> None:
    """A cow of 1.4 m times k."""
    with b.frame(at, (0, 0, 0), k):
        b.ball((0.85, 0.34, 0.4), (0, 0, 1.0), "white", segments=10, rings=6)
        b.ball((0.3, 0.36, 0.28), (0.2, 0, 1.1), spots, segments=8, rings=5)
        b.ball((0.28, 0.35, 0.26), (-0.45, 0, 1.08), spots, segments=8, rings=5)
        b.box((0.5, 0.24, 0.26), (1.0, 0, 1.05), spots, (0, 18, 0), taper=(0.8, 0.9))
        b.box((0.14, 0.2, 0.18), (1.24, 0, 1.0), "pink")
        for s in (-1, 1):
            b.cone(0.05, 0.2, (0.82, s * 0.12, 1.28), "cream", segments=5)
            for px in (-0.55, 0.5):
                b.cylinder(0.08, 0.75, (px, s * 0.2, 0), "white", segments=6)


@recipe("cowshed", 3, hulls=8, name="farms.cowshed")
def cowshed(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Long and low, open at the sides behind a feed rail with cows, a vent along the ridge."""
    size, b = size_of("cowshed", variant), MeshBuilder(roughness=0.9)
    x, y, z = size
    wall: Color = ("#cfc7b6", "#9c5b45", "#8f9a8a")[variant]
    low = 0.56 * z
    kind = ("plaster", "brick", "boards")[variant]
    flank = m.painted_front(
        (x, low), (max(4, round(x / 2.6)), 1), (kind, wall), ("grid", "white"), rng, 160, (0.55, 0.34)
    )
    end = images.wall(kind, (y, low), wall, rng, 64)
    m.hall(
        b,
        (0.94 * x, 0.8 * y, low),
        (-0.02 * x, 0, 0),
        0.38 * z,
        flank,
        end,
        ("#7a4a3c", "#5e5a58", "#8c9294")[variant],
        wall,
    )
    b.box((0.8 * x, 0.08 * y, 0.06 * z), (-0.02 * x, 0, 0.93 * z), "light grey")
    front = 0.455 * x
    b.box((0.1, 0.34 * y, 0.5 * z), (front, 0, 0), "white")
    b.panel(barn_door(("dark green", "#7a2f28", "#3f5f8a")[variant]), (front + 0.07, 0, 0.24 * z), 0.32 * y, 0.47 * z)
    for s in (-1, 1):
        b.rod((-0.4 * x, s * 0.49 * y, 0.2 * z), (0.44 * x, s * 0.49 * y, 0.2 * z), 0.05, "galvanised", 6)
        for k in range(7):
            px = (-0.4 + 0.14 * k) * x
            b.rod((px, s * 0.49 * y, 0), (px, s * 0.49 * y, 0.22 * z), 0.05, "galvanised", 5)
    k = min(1.0, 0.2 * z)
    _cow(b, (0.3 * x, 0.44 * y, 0), k, "black")
    _cow(b, (0.05 * x, 0.44 * y, 0), k, ("#6b3a20", "black", "#6b3a20")[variant])
    _cow(b, (-0.2 * x, -0.44 * y, 0), k, "black")
    names = ("plastered cowshed with cows", "brick cowshed with cows", "boarded cowshed with cows")
    return fitted_as(b.build(names[variant]), "cowshed", size)


def _panes(bays: int, rows: int, frame: Color, rng: np.random.Generator) -> np.ndarray:
    """(64, 96, 3): glass over green leaves, in bars."""
    image, pen = paint.canvas((384, 256), "#a9cdc4")
    for _ in range(160):
        px, py = rng.random() * 384, 256 - abs(rng.normal(0, 70))
        tone = ("#5f9a4a", "#3f7a3c", "#8fb85a", "#d0503c")[
            int(rng.integers(0, 10)) % 4 if rng.random() < 0.3 else int(rng.integers(3))
        ]
        pen.ellipse((px - 16, py - 16, px + 16, py + 16), fill=rgb(tone))
    pixels = np.asarray(image, float)
    image = paint.Image.fromarray((pixels * 0.72 + np.array([206, 230, 236]) * 0.28).astype(np.uint8))
    pen = paint.ImageDraw.Draw(image)
    for k in range(bays + 1):
        pen.line((384 * k / bays, 0, 384 * k / bays, 256), fill=rgb(frame), width=9)
    for k in range(rows + 1):
        pen.line((0, 256 * k / rows, 384, 256 * k / rows), fill=rgb(frame), width=9)
    return np.asarray(paint.shrunk(image, (96, 64)))


@recipe("greenhouse", 3, hulls=6, name="farms.greenhouse")
def greenhouse(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Glass over plants: a small gabled house, a rounded tunnel, a long orangery with a raised middle."""
    size, b = size_of("greenhouse", variant), MeshBuilder(roughness=0.3)
    x, y, z = size
    frame: Color = ("white", "galvanised", "dark green")[variant]
    side, end = _panes(6, 2, frame, rng), _panes(4, 2, frame, rng)
    low = 0.55 * z
    b.box((x, 0.98 * y, 0.1 * z), (0, 0, 0), ("brick", "concrete", "sandstone")[variant])
    if variant == 1:
        a = np.linspace(0, np.pi, 9)
        for k in range(8):
            rim = [(0.49 * y * np.cos(t), 0.08 * z + 0.92 * z * np.sin(t)) for t in (a[k], a[k + 1])]
            (y0, z0), (y1, z1) = rim
            b.quad([(-0.48 * x, y0, z0), (0.48 * x, y0, z0), (0.48 * x, y1, z1), (-0.48 * x, y1, z1)][::-1], image=side)
        for px in np.linspace(-0.48, 0.48, 6) * x:
            b.tube([(px, 0.49 * y * np.cos(t), 0.08 * z + 0.92 * z * np.sin(t)) for t in a], 0.03, frame, 5)
        for s in (-1, 1):
            outline = [(0.49 * y * np.cos(t), 0.92 * z * np.sin(t)) for t in a]
            with b.frame((s * 0.48 * x, 0, 0.08 * z), (0, 0, 90)):
                b.profile(outline, 0.04, color="#b9d8d2")
    else:
        b.box(
            (0.96 * x, 0.94 * y, low - 0.1 * z),
            (0, 0, 0.1 * z),
            "#b9d8d2",
            skins={"+x": end, "-x": end, "+y": side, "-y": side},
        )
        w = 0.5 * y
        for s in (-1, 1):
            corners = [
                (-s * 0.49 * x, s * w, low),
                (s * 0.49 * x, s * w, low),
                (s * 0.49 * x, 0, z * 0.98),
                (-s * 0.49 * x, 0, z * 0.98),
            ]
            b.quad(corners, image=side, both_sides=True)
            with b.frame((s * 0.475 * x, 0, low), (0, 0, 90)):
                b.profile([(-0.94 * w, 0), (0.94 * w, 0), (0, 0.95 * (z - low))], 0.05, color="#b9d8d2")
        b.rod((-0.49 * x, 0, 0.98 * z), (0.49 * x, 0, 0.98 * z), 0.02 * z, frame, 6)
        for px in np.linspace(-0.48, 0.48, 7) * x:
            for s in (-1, 1):
                b.rod((px, s * w, low), (px, 0, 0.98 * z), 0.012 * z, frame, 4)
        if variant == 2:
            b.box((0.24 * x, 0.5 * y, 0.1 * z), (0, 0, 0.86 * z), "#b9d8d2", skins={"+y": side, "-y": side})
    b.box((0.06, 0.3 * y, 0.6 * z), (0.49 * x, 0, 0.02 * z), frame)
    b.box((0.08, 0.24 * y, 0.5 * z), (0.49 * x, 0, 0.06 * z), "#d5ece8")
    leaves = small_leaves("leaf", rng)
    for s in (-1, 1):
        leafy(b, (0.495 * x - 0.1, s * 0.36 * y, 0.2 * z), (0.12, 0.1 * y, 0.14 * z), leaves, rng, 7, 4)
    names = ("white gabled greenhouse", "tunnel greenhouse", "green orangery on a stone base")
    return fitted_as(b.build(names[variant]), "greenhouse", size)


def silo(b: MeshBuilder, at: Point3, radius: float, height: float, color: Color) -> None:
    b.cylinder(radius, 0.86 * height, at, color, segments=14)
    m.dome(
        b, (at[0], at[1], at[2] + 0.86 * height), 1.02 * radius, shade(color, 0.85), 0.14 * height / radius, sides=14
    )
    for k in range(4):
        b.cylinder(
            1.02 * radius,
            0.02 * height,
            (at[0], at[1], at[2] + 0.2 * height * (k + 0.5)),
            shade(color, 0.8),
            segments=14,
        )


@recipe("farm", 3, hulls=12, name="farms.farm")
def farm(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Dwelling, barn and silo round a yard."""
    size, b = size_of("farm", variant), MeshBuilder(roughness=0.9)
    x, y, z = size
    b.box((x, y, 0.02 * z), (0, 0, 0), ("#a58e6a", "#8f8a70", "#9a8468")[variant])
    red: Color = ("#9c2f28", "#6e5a48", "#a8604a")[variant]
    with b.frame((-0.06 * x, -0.27 * y, 0.02 * z)):
        gambrel(b, 0.78 * x, 0.36 * y, 0.42 * z, 0.86 * z, red, "#5a5c60")
        b.panel(barn_door(red), (0.39 * x, 0, 0.19 * z), 0.2 * y, 0.36 * z)
    body: m.Wall = (("boards", "#f0ede4"), ("plaster", "#e2cfa4"), ("brick", "#8f4a38"))[variant]
    front = m.painted_front((0.34 * y, 0.42 * z), (3, 2), body, ("grid", "white"), rng, 80)
    with b.frame((-0.2 * x, 0.26 * y, 0.02 * z)):
        with b.frame((0, 0, 0), (0, 0, 90)):
            m.hall(b, (0.36 * y, 0.4 * x, 0.42 * z), (0, 0, 0), 0.24 * z, front, front, "#6b4038", body[1])
        m.gate(b, (0.2 * x, 0, 0), 0.05 * y, 0.19 * z, "dark green")
        b.box((0.06 * x, 0.06 * x, 0.16 * z), (-0.06 * x, 0.1 * y, 0.56 * z), "brick")
    silo(b, (-0.38 * x, 0.0, 0.02 * z), 0.06 * y, 0.98 * z, ("galvanised", "#b9b0a0", "dark blue")[variant])
    if variant != 1:
        silo(b, (-0.4 * x, -0.03 * y, 0.02 * z), 0.04 * y, 0.8 * z, "galvanised")
    for k in range(9):
        b.box((0.1, 0.1, 0.13 * z), (0.48 * x, (0.06 + 0.05 * k) * y, 0.02 * z), "white")
    for h in (0.07, 0.12):
        b.box((0.06, 0.4 * y, 0.02 * z), (0.48 * x, 0.26 * y, h * z), "white")
    for k in range(3):
        b.cylinder(0.5, 0.9, (0.3 * x, (0.02 - 0.05 * k) * y, 0.02 * z), "#d6b765", segments=12)
    names = ("farm with a red barn and silos", "old farm with a wooden barn", "brick farm with a blue silo")
    return fitted_as(b.build(names[variant]), "farm", size)
