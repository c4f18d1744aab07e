"""Libraries, theatres and universities."""

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import recipe
from ..shared import facade_images as images
from ..shared.sizes import Size, fitted_as, size_of
from . import masonry as m
from .civic_halls import portico, wing

Point3 = tuple[float, float, float]


@recipe("library", 3, hulls=8, name="culture_halls.library")
def library(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A columned reading house; a glass cube with shelves behind it; a hall like a row of giant books."""
    size = size_of("library", variant)
    x, y, z = size
    b = MeshBuilder(roughness=0.8)
    if variant == 0:
        stone: Color = "#d5cbb3"
        wing(
            b, (0.76 * x, y, 0.86 * z), (-0.1 * x, 0, 0), ("ashlar", stone), 2, ("arch", "white"), rng, 4.0, (0.5, 0.7)
        )
        portico(b, 0.28 * x, 0.36 * y, 0.82 * z, 6, stone, "PUBLIC LIBRARY", 0.15 * z)
    else:
        shelves = images.shop_window("books", "charcoal", rng, (120, 64))
        body: Color = ("#3f474d", "#c9b795")[variant - 1]
        b.box((0.84 * x, y, 0.9 * z), (-0.06 * x, 0, 0), body)
        for level in range(2):
            for k in range(4):
                at = (0.365 * x, (k - 1.5) * 0.235 * y, (0.29 + 0.4 * level) * z)
                if level or k not in (1,):
                    b.panel(shelves, at, 0.22 * y, 0.34 * z)
        m.gate(b, (0.37 * x, -0.117 * y, 0), 0.12 * y, 0.34 * z, "charcoal")
        b.box((0.9 * x, 1.02 * y, 0.06 * z), (-0.05 * x, 0, 0.9 * z), shade(body, 0.7))
        m.board(b, "LIBRARY", (0.4 * x, 0, 0.85 * z), 0.56 * y, 0.15 * z, "cream", "#3a3226")
    if variant == 2:  # spines of books for an outer wall
        for k in range(9):
            tall, color = (
                (0.5 + 0.06 * ((k * 5) % 4)) * z,
                ("#a8322a", "#2d4a6b", "#3f6f4a", "#c9a23c", "#5b3b6b")[k % 5],
            )
            for s in (-1, 1):
                b.box((0.075 * x, 0.06 * y, tall), ((-0.38 + 0.085 * k) * x, s * 0.49 * y, 0), color)
    # An open book of stone before the door.
    with b.frame((0.46 * x, (0.3, 0.3, -0.36)[variant] * y, 0)):
        b.box((0.9, 1.4, 1.0), (0, 0, 0), "granite")
        for s in (-1, 1):
            b.box((1.2, 1.1, 0.12), (0, s * 0.52, 1.15), "cream", (14 * s, -18, 0))
            b.box((1.3, 1.2, 0.06), (0, s * 0.55, 1.08), "dark red", (14 * s, -18, 0))
    names = (
        "public library with columns",
        "glass-fronted library full of shelves",
        "library whose sides are giant book spines",
    )
    return fitted_as(b.build(names[variant]), "library", size)


def _mask(b: MeshBuilder, at: Point3, size: float, happy: bool) -> None:
    image, pen = images.paint.canvas((128, 128), "black")
    pen.ellipse((16, 8, 112, 120), fill=images.rgb("gold" if happy else "white"))
    for ex in (44, 84):
        pen.ellipse((ex - 12, 38, ex + 12, 56), fill=images.rgb("black"))
    box = (38, 52, 90, 100) if happy else (38, 76, 90, 124)
    pen.chord(box, *((0, 180) if happy else (180, 360)), fill=images.rgb("black"))
    b.panel(images.paint.shrunk(image, (40, 40)), at, size, size)


@recipe("theater", 3, hulls=8, name="culture_halls.theater")
def theater(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A columned opera front before a fly tower; a playhouse with a marquee; a modern house of folded walls."""
    size: Size = size_of("theater", variant)
    x, y, z = size
    b = MeshBuilder(roughness=0.8)
    stone: Color = ("#dccfae", "#9a5a44", "#d9dadb")[variant]
    b.box((0.34 * x, 0.62 * y, z), (-0.28 * x, 0, 0), shade(stone, 0.86))  # the fly tower
    b.box((0.36 * x, 0.64 * y, 0.03 * z), (-0.28 * x, 0, 0.97 * z), shade(stone, 0.7))
    if variant == 2:
        for k in range(5):
            b.box(
                (0.66 * x, 0.2 * y, (0.5 + 0.07 * (k % 3)) * z),
                (0.04 * x, (k - 2) * 0.2 * y, 0),
                stone,
                taper=(0.86, 1.0),
            )
        glass = m.painted_front(
            (y, 0.3 * z), (16, 2), ("panel", "charcoal"), ("ribbon", "aluminium"), rng, 180, (0.9, 0.86)
        )
        b.box((0.2 * x, 0.94 * y, 0.3 * z), (0.36 * x, 0, 0), "charcoal", skins={"+x": glass})
    else:
        wall: m.Wall = (("ashlar", stone), ("brick", stone))[variant]
        wing(b, (0.8 * x, 0.96 * y, 0.62 * z), (-0.08 * x, 0, 0), wall, 2, ("arch", "off white"), rng, 4.5, (0.5, 0.7))
    if variant == 0:
        portico(b, 0.32 * x, 0.6 * y, 0.58 * z, 8, shade(stone, 1.05), "OPERA THEATRE", 0.14 * z)
    else:
        front = 0.325 * x if variant == 1 else 0.46 * x
        b.box((0.14 * x, 0.5 * y, 0.09 * z), (front + 0.06 * x, 0, 0.22 * z), "dark red")
        m.board(b, "THEATRE", (front + 0.13 * x, 0, 0.225 * z), 0.48 * y, 0.08 * z, "dark red", "gold")
        for k in (-1, 0, 1):
            m.gate(b, (front, 0.13 * y * k, 0), 0.09 * y, 0.18 * z, "dark red")
    side = 0.2 * z
    mask_x = (0.47, 0.335, 0.47)[variant] * x
    for k, s in enumerate((-1, 1)):
        at = (mask_x, s * (0.4 if variant != 1 else 0.16) * y, (0.2 if variant == 2 else 0.44) * z)
        b.box((0.1, side * 1.1, side * 1.1), (at[0] - 0.08, at[1], at[2] - 0.55 * side), "dark red")
        _mask(b, at, side, k == 0)
    names = (
        "opera theatre with columns and a fly tower",
        "brick playhouse with a canopy",
        "modern theatre of folded walls",
    )
    return fitted_as(b.build(names[variant]), "theater", size)


@recipe("university", 3, hulls=10, name="culture_halls.university")
def university(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Two wings either side of a clock tower; a columned hall; a glass faculty with a lecture hall."""
    size = size_of("university", variant)
    x, y, z = size
    b = MeshBuilder(roughness=0.85)
    wall: m.Wall = (("brick", "#8a4a38"), ("ashlar", "#d6cbb2"), ("panel", "#c3cace"))[variant]
    high = (0.52, 0.6, 0.8)[variant] * z
    style = (("arch", "cream"), ("sash", "white"), ("ribbon", "signal blue"))[variant]
    wing(
        b,
        (0.62 * x, y, high),
        (-0.1 * x, 0, 0),
        wall,
        (3, 3, 5)[variant],
        style,
        rng,
        3.6,
        (0.5, 0.6) if variant < 2 else (0.9, 0.5),
    )
    if variant == 0:
        m.hip_roof(b, (0.66 * x, 1.01 * y, 0.12 * z), (-0.1 * x, 0, high + 0.01 * z), "#4d5560", 0.9)
        t = 0.13 * y
        side = m.painted_front((t, 0.76 * z), (2, 4), wall, ("arch", "cream"), rng, 56)
        m.block(b, (0.34 * x, t, 0.76 * z), (0.24 * x, 0, 0), side, wall[1])
        b.panel(m.clock_face(), (0.415 * x, 0, 0.68 * z), 0.09 * z, 0.09 * z)
        b.cylinder(0.12 * x, 0.22 * z, (0.24 * x, 0, 0.77 * z), "#4d5560", (0, 0, 45), 0.02, 4)
        m.gate(b, (0.42 * x, 0, 0), 0.05 * y, 0.2 * z, "dark wood")
        for s in (-1, 1):
            b.box((0.5 * x, 0.12 * y, 1.08 * high), (0.05 * x, s * 0.43 * y, 0), shade(wall[1], 0.95))
            m.pediment(b, 0.3 * x, 0.5 * x, 0.12 * y, 1.08 * high, 0.1 * z, shade(wall[1], 0.9), s * 0.43 * y)
    elif variant == 1:
        portico(b, 0.22 * x, 0.3 * y, 0.68 * z, 8, wall[1], "UNIVERSITAS", 0.14 * z)
        m.dome(b, (-0.1 * x, 0, high), 0.1 * y, "verdigris", 0.9)
    else:
        b.convex(
            [
                (px * x, py * y, pz * z)
                for px, py, pz in (
                    (0.15, -0.2, 0),
                    (0.15, 0.2, 0),
                    (0.45, -0.14, 0),
                    (0.45, 0.14, 0),
                    (0.15, -0.2, 0.3),
                    (0.15, 0.2, 0.3),
                    (0.48, -0.16, 0.42),
                    (0.48, 0.16, 0.42),
                )
            ],
            "#a8322a",
        )
        m.gate(b, (0.22 * x, 0.3 * y, 0), 0.06 * y, 0.16 * z, "charcoal")
    sign = (0.5 * x - 0.4, (0.2, -0.3, -0.3)[variant] * y, 0.0)
    for s in (-1, 1):
        b.box((0.2, 0.2, 1.1), (sign[0], sign[1] + s * 0.11 * y, 0), "granite")
    m.board(b, "UNIVERSITY", (sign[0], sign[1], 0.5), 0.26 * y, 0.13 * z, "dark blue", "white")
    names = (
        "brick university with a clock tower",
        "domed university hall with columns",
        "modern faculty with a lecture hall",
    )
    return fitted_as(b.build(names[variant]), "university", size)
