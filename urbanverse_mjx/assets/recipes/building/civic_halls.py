"""Courts, seats of government, town halls, libraries, theatres, universities: stone fronts with a telling middle."""

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import recipe
from ..shared import facade_images as images
from ..shared.sizes import fitted_as, size_of
from . import masonry as m

Point3 = tuple[float, float, float]


def wing(
    b: MeshBuilder,
    size: Point3,
    at: Point3,
    wall: m.Wall,
    floors: int,
    window: tuple[str, Color],
    rng: np.random.Generator,
    bay: float = 3.4,
    fill: tuple[float, float] = (0.48, 0.58),
    pixels: int = 180,
) -> None:
    """A block of several storeys with painted windows all round, a plinth and a cornice; bays of `bay` m."""
    x, y, z = size
    front = m.painted_front(
        (y, z), (max(2, round(y / bay)), floors), wall, window, rng, pixels, fill, shade(wall[1], 0.82)
    )
    side = m.painted_front((x, z), (max(1, round(x / bay)), floors), wall, window, rng, 90, fill, shade(wall[1], 0.82))
    m.block(b, size, at, front, "dark concrete", side)
    b.box((x + 0.3, y + 0.3, 0.05 * z), at, shade(wall[1], 0.75))
    m.cornice(b, size, at, shade(wall[1], 1.08), 0.022 * z + 0.15)


def portico(
    b: MeshBuilder, x: float, width: float, high: float, count: int, stone: Color, words: str, rise: float
) -> None:
    """Steps, columns, a lettered beam and a pediment in front of the wall plane x."""
    floor, deep = 0.12 * high, 0.26 * high
    for k in range(5):
        b.box(
            (deep + 0.05 * high * (5 - k), width * 1.06, floor / 5),
            (x + deep / 2 + 0.025 * high * (5 - k), 0, floor / 5 * k),
            "light grey",
        )
    m.columns(b, x + 0.7 * deep, list(np.linspace(-0.46, 0.46, count) * width), floor, 0.7 * high, 0.045 * high, stone)
    m.gate(b, (x + 0.02, 0, floor), 0.2 * width, 0.5 * high, "bronze")
    top = floor + 0.7 * high
    b.box((deep + 0.1 * high, width * 1.04, 0.14 * high), (x + 0.5 * deep, 0, top), stone)
    m.board(
        b,
        words,
        (x + 0.5 * deep + 0.5 * (deep + 0.1 * high) - 0.12, 0, top + 0.015 * high),
        0.9 * width,
        0.11 * high,
        stone,
        "#3a3226",
    )
    m.pediment(b, x + 1.1 * deep, deep * 1.4, width * 1.1, top + 0.14 * high, rise, stone)


def _scales(b: MeshBuilder, at: Point3, height: float) -> None:
    """The scales of justice in bronze on a plinth."""
    x, y, z = at
    h = height
    b.box((0.3 * h, 0.3 * h, 0.2 * h), at, "granite")
    b.lathe([(0.1 * h, 0.2 * h), (0.04 * h, 0.3 * h), (0.03 * h, h)], at, "bronze", segments=8)
    b.beam((x, y - 0.36 * h, z + 0.9 * h), (x, y + 0.36 * h, z + 0.9 * h), 0.04 * h, 0.06 * h, "bronze")
    for s in (-1, 1):
        side = y + s * 0.34 * h
        for d in (-0.12, 0.12):
            b.rod((x, side, z + 0.9 * h), (x, side + d * h, z + 0.6 * h), 0.01 * h, "brass", 4)
        b.lathe(
            [(0.03 * h, 0), (0.12 * h, 0.03 * h), (0.16 * h, 0.09 * h)], (x, side, z + 0.53 * h), "brass", segments=10
        )


@recipe("courthouse", 3, hulls=10, name="civic_halls.courthouse")
def courthouse(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Heavy stone with columns, a pediment and steps; the second under a dome, the third of red stone."""
    size = size_of("courthouse", variant)
    x, y, z = size
    stone: Color = ("#d8d0bd", "#e3e0d8", "#b87f66")[variant]
    b = MeshBuilder(roughness=0.85)
    high = (0.78, 0.58, 0.78)[variant] * z
    wing(
        b,
        (0.72 * x, 0.98 * y, 0.92 * high),
        (-0.12 * x, 0, 0),
        ("ashlar", stone),
        2 if variant else 3,
        ("grid", "white"),
        rng,
    )
    b.box((0.76 * x, 0.42 * y, high), (-0.08 * x, 0, 0), shade(stone, 0.97))
    portico(
        b,
        0.3 * x,
        0.4 * y,
        high,
        (8, 6, 6)[variant],
        shade(stone, 1.06),
        ("COURTHOUSE", "COUNTY COURT", "LAW COURTS")[variant],
        z * (0.16, 0.12, 0.16)[variant],
    )
    if variant == 1:
        b.cylinder(0.13 * y, 0.12 * z, (-0.08 * x, 0, high), stone, segments=16)
        m.dome(b, (-0.08 * x, 0, high + 0.12 * z), 0.12 * y, "verdigris", 0.9)
        m.finial(b, (-0.08 * x, 0, high + 0.12 * z + 0.1 * y), 0.08 * z, "ball")
    _scales(b, (0.45 * x, -0.34 * y, 0.0), 0.42 * z)
    b.box((0.5, 0.24 * y, 0.05 * z), (0.45 * x, 0.36 * y, 0), "granite")
    m.board(b, "COURTHOUSE", (0.45 * x, 0.36 * y, 0.05 * z), 0.26 * y, 0.13 * z, "#3a3226", "white")
    names = (
        "neoclassical courthouse with eight columns",
        "domed county courthouse",
        "red stone law courts with columns",
    )
    return fitted_as(b.build(names[variant]), "courthouse", size)


@recipe("government building", 3, hulls=10, name="civic_halls.government_building")
def government_building(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A capitol with a high dome; a palace front with flags; a ministry of glass and stone."""
    size = size_of("government building", variant)
    x, y, z = size
    b = MeshBuilder(roughness=0.85)
    stone: Color = ("#e9e6df", "#d9c49a", "#c9c6bf")[variant]
    wall = ("ashlar", stone)
    if variant == 0:
        high = 0.44 * z
        wing(b, (0.6 * x, y, 0.86 * high), (-0.16 * x, 0, 0), wall, 3, ("sash", "white"), rng)
        b.box((0.74 * x, 0.3 * y, high), (-0.08 * x, 0, 0), stone)
        portico(b, 0.29 * x, 0.28 * y, high, 8, stone, "NATIONAL ASSEMBLY", 0.09 * z)
        r = 0.105 * y
        at = (-0.1 * x, 0.0)
        b.cylinder(1.25 * r, 0.1 * z, (*at, high), stone, segments=20)
        b.cylinder(0.86 * r, 0.16 * z, (*at, high + 0.1 * z), shade(stone, 0.85), segments=16)
        for k in range(14):
            a = 2 * np.pi * k / 14
            b.cylinder(0.08 * r, 0.16 * z, (at[0] + r * np.cos(a), r * np.sin(a), high + 0.1 * z), stone, segments=6)
        b.cylinder(1.12 * r, 0.03 * z, (*at, high + 0.26 * z), stone, segments=20)
        m.dome(b, (*at, high + 0.29 * z), r, "#f1efe9", 1.1)
        b.cylinder(0.18 * r, 0.06 * z, (*at, high + 0.29 * z + 1.05 * r), stone, segments=8)
        m.finial(b, (*at, 0.94 * z), 0.06 * z, "ball", "bronze")
    elif variant == 1:
        wing(b, (0.8 * x, y, 0.72 * z), (-0.08 * x, 0, 0), wall, 3, ("sash", "white"), rng, 4.0)
        m.hip_roof(b, (0.84 * x, 1.02 * y, 0.16 * z), (-0.08 * x, 0, 0.74 * z), "#5f6e70", 0.8)
        b.box((0.16 * x, 0.24 * y, 0.76 * z), (0.34 * x, 0, 0), shade(stone, 1.05))
        m.pediment(b, 0.44 * x, 0.2 * x, 0.27 * y, 0.76 * z, 0.12 * z, shade(stone, 1.05))
        m.columns(b, 0.45 * x, list(np.linspace(-0.1, 0.1, 4) * y), 0.26 * z, 0.48 * z, 0.012 * y, stone)
        m.gate(b, (0.42 * x, 0, 0), 0.05 * y, 0.2 * z, "dark wood")
        m.board(b, "MINISTRY", (0.42 * x, 0, 0.21 * z), 0.14 * y, 0.05 * z, stone, "#3a3226")
    else:
        wing(
            b,
            (0.7 * x, y, 0.66 * z),
            (-0.1 * x, 0, 0),
            ("panel", stone),
            5,
            ("ribbon", "charcoal"),
            rng,
            3.0,
            (0.86, 0.56),
        )
        wing(
            b,
            (0.5 * x, 0.2 * y, 0.9 * z),
            (0.12 * x, 0, 0),
            ("panel", "#8d969c"),
            7,
            ("ribbon", "charcoal"),
            rng,
            2.6,
            (0.9, 0.7),
        )
        m.board(b, "GOVERNMENT OFFICES", (0.372 * x, 0, 0.8 * z), 0.19 * y, 0.05 * z, "charcoal", "white")
        b.box((0.2 * x, 0.26 * y, 0.02 * z), (0.44 * x, 0, 0.16 * z), "charcoal")
        m.gate(b, (0.375 * x, 0, 0), 0.08 * y, 0.13 * z, "charcoal")
    for k in range(3):
        y0 = (-0.2 + 0.2 * k) * y if variant else (k - 1) * 0.04 * y
        at = (0.46 * x, y0 if abs(y0) > 0.01 else 0.3 * y, 0.0)
        m.flag(b, at, 0.34 * z, ("signal blue", "white", "signal red"))
    names = ("capitol with a high dome", "ministry in a palace", "modern government office building")
    return fitted_as(b.build(names[variant]), "government building", size)


@recipe("town hall", 3, hulls=10, name="civic_halls.town_hall")
def town_hall(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A gabled front with a clock turret; a belfry in the middle; a timber-framed hall on arches."""
    size = size_of("town hall", variant)
    x, y, z = size
    b = MeshBuilder(roughness=0.85)
    wall: m.Wall = (("plaster", "#d9b98a"), ("brick", "#94553f"), ("plaster", "#f0e9dc"))[variant]
    roof: Color = ("#7d3f30", "#4d5560", "#8a4a34")[variant]
    high = 0.42 * z
    wing(b, (0.84 * x, 0.96 * y, high), (-0.03 * x, 0, 0), wall, 2, ("grid", "white"), rng, 3.2)
    m.hip_roof(b, (0.88 * x, y, 0.2 * z), (-0.03 * x, 0, high + 0.01 * z), roof, 0.7)
    front = 0.40 * x
    if variant != 1:  # the gable over the middle
        with b.frame((front - 0.1 * x, 0, high), (0, 0, 90)):
            w = 0.17 * y
            outline = [
                (-w, 0),
                (w, 0),
                (w, 0.06 * z),
                (0.66 * w, 0.06 * z),
                (0.66 * w, 0.12 * z),
                (0.33 * w, 0.12 * z),
                (0.33 * w, 0.18 * z),
                (-0.33 * w, 0.18 * z),
                (-0.33 * w, 0.12 * z),
                (-0.66 * w, 0.12 * z),
                (-0.66 * w, 0.06 * z),
                (-w, 0.06 * z),
            ]
            b.profile(outline, 0.2 * x, color=shade(wall[1], 1.04))
        t, at, base = 0.1 * y, (0.0, 0.0), high + 0.16 * z
    else:
        t, at, base = 0.15 * y, (front - 0.02 * x, 0.0), 0.0
    tower = images.wall(wall[0], (t, 0.8 * z - base), wall[1], rng, 48)
    m.block(b, (t, t, 0.8 * z - base), (*at, base), tower, wall[1])
    for turn in (0, 90, 180, 270):
        with b.frame((*at, 0), (0, 0, turn)):
            b.panel(m.clock_face(), (t / 2 + 0.06, 0, 0.74 * z), 0.74 * t, 0.74 * t)
    m.cornice(b, (t, t, 0.8 * z - base), (*at, base), "off white", 0.05 * t)
    if variant == 0:
        m.dome(b, (*at, 0.82 * z), 0.52 * t, "verdigris", 0.9, 0.4, 12)
    else:
        b.cylinder(0.74 * t, 0.14 * z, (*at, 0.82 * z), roof, (0, 0, 45), 0.02, 4)
    m.finial(b, (*at, 0.93 * z), 0.06 * z, "ball")
    face = (front - 0.02 * x + t / 2 if variant == 1 else front - 0.01 * x, 0.0, 0.0)
    m.gate(b, face, 0.07 * y, 0.2 * z, "dark wood")
    m.board(
        b,
        ("TOWN HALL", "CITY HALL", "RATHAUS")[variant],
        (face[0], 0, 0.225 * z),
        0.2 * y,
        0.05 * z,
        "dark red",
        "gold",
    )
    for k in np.linspace(-0.42, 0.42, 6) if variant == 2 else ():
        m.columns(b, front + 0.03 * x, [k * y], 0, 0.2 * z, 0.2, "sandstone", 8)
    if variant == 2:
        b.box((0.06 * x, 0.92 * y, 0.015 * z), (front + 0.02 * x, 0, 0.2 * z), wall[1])
    m.flag(b, (0.47 * x, 0.3 * y, 0), 0.4 * z, ("signal red", "white"))
    names = (
        "gabled town hall with a clock turret",
        "brick city hall with a belfry",
        "town hall with an arcade and stepped gable",
    )
    return fitted_as(b.build(names[variant]), "town hall", size)
