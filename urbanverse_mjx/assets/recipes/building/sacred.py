"""Churches, chapels, cathedrals, monasteries, mosques, temples, shrines and pagodas, by their silhouettes."""

from collections.abc import Sequence

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import recipe
from ..shared import facade_images as images
from ..shared.sizes import Size, fitted_as, size_of
from . import masonry as m


def _end_wall(b: MeshBuilder, x: float, width: float, z: float, stone: Color, door: Color, rose: bool) -> None:
    """Portal and rose window on a front at x."""
    m.gate(b, (x, 0, 0), 0.22 * width, 0.34 * z, door)
    if rose:
        side = 0.34 * width
        b.panel(m.rose_window(stone), (x + 0.06, 0, 0.72 * z), side, side)


def _nave(
    b: MeshBuilder, size: Size, x: float, rise: float, wall: m.Wall, roof: Color, rng: np.random.Generator
) -> None:
    bays = max(3, round(size[0] / (0.45 * size[2])))
    flank = m.painted_front((size[0], size[2]), (bays, 1), wall, ("arch", "off white"), rng, 160, (0.42, 0.66))
    plain = images.wall(wall[0], (size[1], size[2]), wall[1], rng, 64)
    m.hall(b, size, (x, 0, 0), rise, flank, plain, roof, wall[1])
    for k in range(bays + 1):
        for s in (-1, 1):
            at = (x + (k / bays - 0.5) * size[0] * 0.98, s * size[1] * 0.53, 0.0)
            b.box((0.05 * size[1], 0.08 * size[1], 0.82 * size[2]), at, shade(wall[1], 0.9), taper=(1.0, 0.5))


@recipe("church", 3, hulls=10, name="sacred.church")
def church(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A nave behind a west tower: with a pointed spire, a pyramid roof, or a white wooden steeple."""
    size = size_of("church", variant)
    x, y, z = size
    wall, roof, spire = (
        (("ashlar", "#c3b69c"), "#5b5a5e", "#55707a"),
        (("brick", "#93523f"), "#5e4038", "#5e4038"),
        (("boards", "#ece9e0"), "#4c545c", "#4c545c"),
    )[variant]
    side, b = 0.40 * y, MeshBuilder(roughness=0.85)
    nave = (x - side * 0.7, 0.86 * y, (0.30, 0.34, 0.26)[variant] * z)
    _nave(b, nave, -side * 0.35, 0.5 * y * (0.9, 0.75, 0.8)[variant], wall, roof, rng)
    shaft = (0.56, 0.66, 0.46)[variant] * z
    front = m.painted_front((side, shaft), (1, 3), wall, ("arch", "off white"), rng, 56, (0.34, 0.4))
    at = x / 2 - side / 2
    m.block(b, (side, side, shaft), (at, 0, 0), front, wall[1])
    m.cornice(b, (side, side, shaft), (at, 0, 0), shade(wall[1], 1.08), 0.05 * side)
    m.gate(b, (at + side / 2, 0, 0), 0.5 * side, 0.14 * z, "dark wood")
    top = z - 0.05 * z - shaft
    if variant == 2:
        b.box((0.7 * side, 0.7 * side, 0.3 * top), (at, 0, shaft), wall[1])
        b.cylinder(0.38 * side, 0.7 * top, (at, 0, shaft + 0.3 * top), spire, top_radius=0.02, segments=8)
    else:
        sides = 8 if variant == 0 else 4
        with b.frame((at, 0, shaft), (0, 0, 180 / sides)):
            b.cylinder(
                0.56 * side if sides == 8 else 0.74 * side, top, (0, 0, 0), spire, top_radius=0.02, segments=sides
            )
        b.panel(m.clock_face(), (at + side / 2 + 0.05, 0, 0.9 * shaft), 0.5 * side, 0.5 * side)
    m.finial(b, (at, 0, 0.94 * z), 0.06 * z, "cross")
    names = (
        "stone church with a pointed spire",
        "brick church with a square tower",
        "white wooden church with a steeple",
    )
    return fitted_as(b.build(names[variant], {"wall": wall[0]}), "church", size)


@recipe("chapel", 3, hulls=6, name="sacred.chapel")
def chapel(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """One nave with a bell turret on its ridge, or a bell gable over the door."""
    size = size_of("chapel", variant)
    x, y, z = size
    wall, roof = (
        (("plaster", "#efe8d8"), "#8c4a34"),
        (("ashlar", "#b5aa94"), "#50545a"),
        (("plaster", "#f4f2ec"), "#3f6fa0"),
    )[variant]
    high, rise, b = 0.36 * z, 0.26 * z, MeshBuilder(roughness=0.85)
    _nave(b, (0.92 * x, 0.84 * y, high), 0.0, rise, wall, roof, rng)
    front = 0.46 * x
    m.gate(b, (front + 0.03, 0, 0.0), 0.26 * y, 0.26 * z, "dark wood")
    b.panel(m.rose_window(wall[1], 40), (front + 0.05, 0, 0.45 * z), 0.24 * y, 0.24 * y)
    m.steps(b, front, 0.45 * y, 2, 0.14, 0.3, "granite")
    w = 0.2 * y
    if variant == 0:
        b.box((w, w, 0.2 * z), (0.3 * x, 0, 0.56 * z), "white")
        b.cylinder(0.72 * w, 0.16 * z, (0.3 * x, 0, 0.76 * z), roof, top_radius=0.02, segments=8)
    elif variant == 1:
        for s in (-1, 1):
            b.box((0.5, 0.3 * w, 0.2 * z), (front - 0.2, s * 0.5 * w, 0.58 * z), wall[1])
        m.pediment(b, front + 0.05, 0.5, 1.6 * w, 0.78 * z, 0.12 * z, wall[1])
        b.lathe([(0.3 * w, 0), (0.2 * w, 0.5 * w), (0.02, 0.6 * w)], (front - 0.2, 0, 0.65 * z), "bronze", segments=10)
    else:
        b.cylinder(0.6 * w, 0.12 * z, (0.1 * x, 0, 0.54 * z), wall[1], segments=12)
        m.dome(b, (0.1 * x, 0, 0.66 * z), 0.9 * w, roof, 1.2)
    m.finial(b, ((0.3 * x, front - 0.2, 0.1 * x)[variant], 0, (0.9, 0.88, 0.8)[variant] * z), 0.1 * z, "cross")
    names = (
        "small white chapel with a ridge turret",
        "stone chapel with a bell gable",
        "white chapel with a blue dome",
    )
    return fitted_as(b.build(names[variant], {"wall": wall[0]}), "chapel", size)


@recipe("cathedral", 2, hulls=12, name="sacred.cathedral")
def cathedral(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Twin west towers, a rose window, three portals, transept, apse and flying buttresses; the second with a dome."""
    size = size_of("cathedral", variant)
    x, y, z = size
    stone: Color = ("#bdb4a2", "#d8cdb4")[variant]
    roof: Color = ("#5f6e70", "#6f9484")[variant]
    wall, b = ("ashlar", stone), MeshBuilder(roughness=0.88)
    high, t = 0.42 * z, 0.36 * y
    _nave(b, (0.86 * x, 0.52 * y, high), 0.0, 0.18 * z, wall, roof, rng)
    with b.frame((-0.14 * x, 0, 0), (0, 0, 90)):
        end = m.painted_front((0.24 * x, high), (1, 1), wall, ("arch", "off white"), rng, 60, (0.5, 0.7))
        m.hall(b, (y * 0.96, 0.22 * x, high * 0.96), (0, 0, 0), 0.15 * z, end, end, roof, stone)
    b.cylinder(0.24 * y, high * 0.8, (-0.43 * x, 0, 0), stone, segments=12)
    b.cylinder(0.25 * y, 0.14 * z, (-0.43 * x, 0, high * 0.8), roof, top_radius=0.3, segments=12)
    for k in range(4):
        for s in (-1, 1):
            bx = 0.06 * x + 0.07 * x * k
            b.box((0.5 + 0.01 * x, 0.05 * y, 0.3 * z), (bx, s * 0.40 * y, 0), shade(stone, 0.92))
            b.beam((bx, s * 0.40 * y, 0.29 * z), (bx, s * 0.26 * y, 0.38 * z), 0.012 * x, 0.02 * z, shade(stone, 0.92))
    front = 0.5 * x
    shaft = (0.66 if variant == 0 else 0.56) * z
    image = m.painted_front((t, shaft), (2, 4), wall, ("arch", shade(stone, 1.15)), rng, 70, (0.5, 0.66))
    for s in (-1, 1):
        at = (front - t / 2, s * (y / 2 - t / 2), 0.0)
        m.block(b, (t, t, shaft), at, image, stone)
        m.cornice(b, (t, t, shaft), at, shade(stone, 1.06), 0.03 * t)
        m.gate(b, (front, at[1], 0), 0.4 * t, 0.15 * z, "dark wood")
        if variant == 0:
            b.cylinder(0.5 * t, 0.96 * z - shaft, (at[0], at[1], shaft), roof, top_radius=0.1, segments=8)
            for dx in (-1, 1):
                for dy in (-1, 1):
                    corner = (at[0] + dx * 0.45 * t, at[1] + dy * 0.45 * t, shaft)
                    b.cone(0.09 * t, 0.1 * z, corner, shade(stone, 0.95), segments=6)
            m.finial(b, (at[0], at[1], 0.95 * z), 0.05 * z, "cross")
        else:
            b.cylinder(0.34 * t, 0.08 * z, (at[0], at[1], shaft), stone, segments=10)
            m.dome(b, (at[0], at[1], shaft + 0.08 * z), 0.36 * t, roof, 1.2, sides=12)
    mid = y - 2 * t
    b.box((0.6 * t, mid + 0.2, 0.52 * z), (front - 0.4 * t, 0, 0), stone)
    b.panel(m.rose_window(stone, 64), (front - 0.1 * t + 0.1, 0, 0.37 * z), 0.95 * mid, 0.95 * mid)
    m.gate(b, (front - 0.1 * t, 0, 0), 0.6 * mid, 0.22 * z, "dark wood")
    m.steps(b, front, 0.8 * y, 4, 0.2, 0.6, "granite")
    if variant == 1:
        b.cylinder(0.2 * y, 0.18 * z, (-0.14 * x, 0, 0.5 * z), stone, segments=16)
        m.dome(b, (-0.14 * x, 0, 0.68 * z), 0.22 * y, roof, 1.15)
        b.cylinder(0.035 * y, 0.06 * z, (-0.14 * x, 0, 0.68 * z + 0.25 * y), stone, segments=8)
        m.finial(b, (-0.14 * x, 0, 0.9 * z), 0.1 * z, "cross")
    else:
        b.cone(0.05 * y, 0.3 * z, (-0.14 * x, 0, 0.56 * z), roof, segments=8)
    names = ("gothic cathedral with two spires and a rose window", "domed baroque cathedral with two towers")
    return fitted_as(b.build(names[variant], {"towers": 2}), "cathedral", size)


@recipe("monastery", 2, hulls=12, name="sacred.monastery")
def monastery(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Four wings round a cloister garden, with a church on one side and its tower."""
    size = size_of("monastery", variant)
    x, y, z = size
    wall: m.Wall = (("plaster", "#e8dcc0"), ("ashlar", "#bfae90"))[variant]
    roof: Color = ("#a4553a", "#7a4a38")[variant]
    b, high, deep = MeshBuilder(roughness=0.88), 0.36 * z, 0.2 * x
    b.box((0.62 * x, 0.7 * y, 0.1), (0, 0, 0), "grass")
    for turn, length, offset in ((90, y, x / 2), (0, x, y / 2), (90, y, -x / 2)):
        with b.frame((0, 0, 0), (0, 0, turn)):
            at = (0, -(offset - np.sign(offset) * deep / 2), 0) if turn else (0, offset - deep / 2, 0)
            face = m.painted_front((length, high), (round(length / 4), 2), wall, ("casement", "white"), rng, 160)
            end = m.painted_front((deep, high), (2, 2), wall, ("casement", "white"), rng, 40)
            m.hall(b, (length * 0.98, deep, high), at, 0.16 * z, face, end, roof, wall[1])
    _wing = (0.98 * x, 1.2 * deep, 0.44 * z)
    with b.frame((0, -(y / 2 - 0.6 * deep), 0)):
        _nave(b, _wing, 0.0, 0.22 * z, wall, roof, rng)
    t = 0.14 * y
    at = (x / 2 - t / 2 + 0.2, -(y / 2 - 0.6 * deep), 0.0)
    tower = m.painted_front((t, 0.68 * z), (1, 4), wall, ("arch", "white"), rng, 40, (0.4, 0.5))
    m.block(b, (t, t, 0.68 * z), at, tower, wall[1])
    if variant == 0:
        m.dome(b, (at[0], at[1], 0.68 * z), 0.5 * t, "verdigris", 1.0, 0.5, sides=12)
    else:
        b.cylinder(0.7 * t, 0.22 * z, (at[0], at[1], 0.68 * z), roof, (0, 0, 45), 0.02, 4)
    m.finial(b, (at[0], at[1], 0.9 * z), 0.1 * z, "cross")
    m.gate(b, (x / 2 + 0.02, 0.1 * y, 0), 0.08 * y, 0.3 * z, "dark wood")
    # The cloister's arcade, towards the garden.
    for k in np.linspace(-0.26, 0.3, 8):
        m.columns(b, x / 2 - deep - 0.6, [k * y], 0.0, 0.18 * z, 0.12, "marble", 6)
    b.cylinder(0.8, 0.7, (0, 0.05 * y, 0.1), "granite", segments=10)
    return fitted_as(
        b.build(
            f"{('plastered', 'stone')[variant]} monastery of four wings round a cloister garden", {"wall": wall[0]}
        ),
        "monastery",
        size,
    )


def minaret(b: MeshBuilder, at: Sequence[float], height: float, radius: float, stone: Color, cap: Color) -> None:
    """A slender shaft with two balconies, a pointed cap and a crescent."""
    x, y = at[0], at[1]
    h, r = height, radius
    profile = [
        (1.35 * r, 0),
        (1.35 * r, 0.14 * h),
        (r, 0.17 * h),
        (0.92 * r, 0.55 * h),
        (1.45 * r, 0.58 * h),
        (1.45 * r, 0.605 * h),
        (0.8 * r, 0.605 * h),
        (0.75 * r, 0.72 * h),
        (1.2 * r, 0.745 * h),
        (1.2 * r, 0.765 * h),
        (0.65 * r, 0.765 * h),
        (0.6 * r, 0.84 * h),
    ]
    b.lathe(profile, (x, y, 0), stone, segments=12)
    b.cone(0.75 * r, 0.12 * h, (x, y, 0.84 * h), cap, segments=12)
    m.finial(b, (x, y, 0.95 * h), 0.05 * h, "crescent")


@recipe("mosque", 3, hulls=10, name="sacred.mosque")
def mosque(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A domed prayer hall behind a portico, with one or two minarets."""
    size = size_of("mosque", variant)
    x, y, z = size
    stone: Color = ("#dcd3c0", "#e9dcb8", "#f0eee8")[variant]
    cap: Color = ("#7f96a0", "#2f8f8a", "#caa23c")[variant]
    b, high = MeshBuilder(roughness=0.8), 0.3 * z
    hall = (0.74 * x, 0.84 * y, high)
    wall = ("ashlar", stone)
    front = m.painted_front((hall[1], high), (7, 1), wall, ("arch", "white"), rng, 160, (0.55, 0.6))
    side = m.painted_front((hall[0], high), (6, 1), wall, ("arch", "white"), rng, 120, (0.55, 0.6))
    m.block(b, hall, (-0.1 * x, 0, 0), front, stone, side)
    m.cornice(b, hall, (-0.1 * x, 0, 0), shade(stone, 1.05), 0.02 * x)
    r = (0.27 if variant != 2 else 0.21) * y
    b.cylinder(1.05 * r, 0.1 * z, (-0.1 * x, 0, high), stone, segments=20)
    m.dome(b, (-0.1 * x, 0, high + 0.1 * z), r, cap, 0.85, 0.3 if variant == 2 else 0.0, 24)
    m.finial(b, (-0.1 * x, 0, high + 0.1 * z + (1.1 if variant == 2 else 0.84) * r), 0.12 * z, "crescent")
    for sx in (-1, 1):
        for sy in (-1, 1):
            m.dome(b, (-0.1 * x + sx * 0.28 * x, sy * 0.32 * y, high), 0.1 * y, cap, 0.9, sides=12)
    # The portico: pointed arches on columns under small domes.
    px = 0.27 * x
    b.box((0.2 * x, 0.8 * y, 0.06 * z), (px + 0.1 * x, 0, 0.22 * z), stone)
    m.columns(b, px + 0.18 * x, list(np.linspace(-0.38, 0.38, 6) * y), 0.0, 0.22 * z, 0.014 * y, "marble", 6)
    for k in np.linspace(-0.3, 0.3, 5):
        m.dome(b, (px + 0.1 * x, k * y, 0.28 * z), 0.055 * y, cap, 0.8, sides=8)
    b.box((0.06 * x, 0.24 * y, 0.36 * z), (0.45 * x, 0, 0), stone)
    m.gate(b, (0.48 * x, 0, 0), 0.14 * y, 0.26 * z, ("dark green", "teal", "#8a6a2a")[variant])
    for s in ((-1, 1), (1,), (-1, 1))[variant]:
        minaret(b, ((0.24, 0.3, -0.4)[variant] * x, s * 0.455 * y), z, 0.035 * y, stone, cap)
    names = (
        "stone mosque with a lead dome and two minarets",
        "mosque with a turquoise dome and one minaret",
        "white mosque with golden domes",
    )
    return fitted_as(b.build(names[variant], {"minarets": (2, 1, 2)[variant]}), "mosque", size)
