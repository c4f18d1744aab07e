"""Hospitals, police, fire and ambulance stations, post offices, prisons: blocks with their signs and gates."""

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, rgb, shade
from ...meshes.recipe import recipe
from ..shared import facade_images as images
from ..shared.sizes import fitted_as, size_of
from . import masonry as m
from .civic_halls import wing
from .shops import icons

Point3 = tuple[float, float, float]


def sign_box(b: MeshBuilder, name: str, at: Point3, side: float, color: Color, back: Color) -> None:
    """A square lit sign with a pictogram, facing +x, its lower middle at `at`."""
    b.box((0.2 * side, side, side), at, shade(back, 0.8), skins={"+x": icons.drawn(name, 48, color, back)})


def roller_door(color: Color, glazed: bool = True) -> np.ndarray:
    """(56, 48, 3): a sectional door, with a row of panes."""
    image, pen = images.paint.canvas((192, 224), color)
    for k in range(6):
        pen.line((0, 37 * k, 192, 37 * k), fill=shade(color, 0.65), width=5)
    if glazed:
        for k in range(3):
            pen.rectangle((14 + 58 * k, 82, 62 + 58 * k, 104), fill=rgb("dark glass"))
    pen.rectangle((0, 0, 191, 223), outline=shade(color, 0.5), width=8)
    return np.asarray(images.paint.shrunk(image, (48, 56)))


def vehicle_hall(
    b: MeshBuilder, size: Point3, at: Point3, bays: int, wall: m.Wall, door: Color, rng: np.random.Generator
) -> None:
    """A low hall with large doors side by side on its front."""
    x, y, z = size
    face = images.wall(wall[0], (y, z), wall[1], rng, 120)
    m.block(b, size, at, face, "dark concrete")
    m.cornice(b, size, at, "off white", 0.03 * z)
    gate, wide = roller_door(door), 0.8 * y / bays
    for k in range(bays):
        where = (at[0] + x / 2 + 0.03, at[1] + (k - (bays - 1) / 2) * 0.94 * y / bays, at[2] + 0.36 * z)
        b.box((0.12, wide * 1.08, 0.76 * z), (where[0] - 0.05, where[1], at[2]), "light grey")
        b.panel(gate, (where[0] + 0.03, where[1], where[2]), wide, 0.72 * z)


@recipe("hospital", 3, hulls=10, name="services.hospital")
def hospital(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A ward block over a broad base, red crosses, an emergency canopy, a helicopter pad."""
    size, b = size_of("hospital", variant), MeshBuilder(roughness=0.7)
    x, y, z = size
    wall: m.Wall = (("plaster", "#e9ebe8"), ("brick", "#b58a6e"), ("panel", "#cfdbe0"))[variant]
    window = (("ribbon", "white"), ("single", "white"), ("ribbon", "teal"))[variant]
    low = 0.26 * z
    wing(b, (0.8 * x, y, low), (-0.04 * x, 0, 0), wall, 2, ("ribbon", "white"), rng, 4.0, (0.8, 0.5))
    towers = (((0.0, 0.86 * y),), ((-0.3 * y, 0.3 * y), (0.3 * y, 0.3 * y)), ((0.14 * y, 0.6 * y),))[variant]
    for middle, width in towers:
        at = (-0.12 * x, middle, low)
        wing(b, (0.5 * x, width, 0.66 * z), at, wall, 6, window, rng, 3.6, (0.78, 0.5) if variant != 1 else (0.45, 0.5))
        b.box((0.3 * x, 0.3 * width, 0.07 * z), (-0.16 * x, middle, 0.92 * z), "galvanised")
    middle = towers[0][0]
    sign_box(b, "cross", (0.15 * x, middle, 0.64 * z), 0.27 * z, "signal red", "white")
    m.board(
        b,
        "HOSPITAL",
        (0.14 * x, middle - (0.3 if variant != 1 else 0.0) * y * 0.8, 0.56 * z),
        0.26 * y,
        0.09 * z,
        "white",
        "signal red",
    )
    b.box((0.16 * x, 0.22 * y, 0.03 * z), (0.42 * x, 0.2 * y, 0.15 * z), "signal red")
    m.board(b, "EMERGENCY", (0.5 * x - 0.15, 0.2 * y, 0.15 * z), 0.2 * y, 0.05 * z, "signal red", "white")
    for s in (-1, 1):
        b.cylinder(0.006 * y, 0.15 * z, (0.47 * x, 0.2 * y + s * 0.1 * y, 0), "white", segments=8)
    m.gate(b, (0.37 * x, 0.2 * y, 0), 0.09 * y, 0.13 * z, "aluminium")
    pad, pen = images.paint.canvas((96, 96), "dark grey")
    pen.ellipse((4, 4, 92, 92), outline=rgb("signal yellow"), width=6)
    images.paint.text(pen, "H", (24, 20, 72, 76), "white", 0.06)
    top = (-0.12 * x, towers[-1][0] - 0.28 * towers[-1][1], 0.95 * z)
    side = min(0.4 * x, 0.3 * towers[-1][1] + 4)
    b.box((side, side, 0.02 * z), top, "dark grey", skins={"+z": pad})
    names = (
        "white ward block with a red cross",
        "brick hospital of two ward towers",
        "hospital with a glazed ward block",
    )
    return fitted_as(b.build(names[variant]), "hospital", size)


@recipe("clinic", 3, hulls=8, name="services.clinic")
def clinic(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Doctors' house with a cross, a glazed porch and a ramp."""
    size, b = size_of("clinic", variant), MeshBuilder(roughness=0.75)
    x, y, z = size
    wall: m.Wall = (("plaster", "#eef0ea"), ("brick", "#a5634a"), ("panel", "#dfe8ea"))[variant]
    color: Color = ("green", "signal red", "signal blue")[variant]
    high = (0.9, 0.68, 0.9)[variant] * z
    wing(b, (0.78 * x, 0.98 * y, high), (-0.08 * x, 0, 0), wall, 2, ("casement", "white"), rng, 2.6)
    if variant == 1:
        m.hip_roof(b, (0.86 * x, 1.04 * y, 0.3 * z), (-0.08 * x, 0, high), "#5e4038", 0.6)
    porch = (0.3, -0.25, 0.0)[variant] * y
    b.box((0.16 * x, 0.3 * y, 0.36 * z), (0.36 * x, porch, 0), "light blue")
    b.box((0.22 * x, 0.36 * y, 0.04 * z), (0.38 * x, porch, 0.36 * z), color)
    m.gate(b, (0.445 * x, porch, 0), 0.14 * y, 0.32 * z, "aluminium")
    m.board(
        b,
        ("CLINIC", "MEDICAL CENTRE", "HEALTH CLINIC")[variant],
        (0.44 * x, porch, 0.405 * z),
        0.34 * y,
        0.1 * z,
        "white",
        color,
    )
    sign_box(b, "cross", (0.32 * x, -porch if porch else 0.36 * y, 0.42 * z), 0.36 * z, color, "white")
    b.beam((0.4 * x, porch - 0.34 * y, 0.05), (0.4 * x, porch - 0.14 * y, 0.3), 0.16 * x, 0.1, "concrete")
    names = ("white clinic with a green cross", "brick medical centre", "modern clinic with a blue cross")
    return fitted_as(b.build(names[variant]), "clinic", size)


@recipe("police station", 3, hulls=8, name="services.police_station")
def police_station(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """POLICE in white on blue, a blue lamp by the door, a shield, aerials on the roof, a car gate."""
    size, b = size_of("police station", variant), MeshBuilder(roughness=0.8)
    x, y, z = size
    wall: m.Wall = (("plaster", "#d9d6cc"), ("brick", "#8a5040"), ("panel", "#b9c2c9"))[variant]
    high = 0.84 * z
    wing(
        b,
        (0.84 * x, y, high),
        (-0.05 * x, 0, 0),
        wall,
        3,
        (("single", "signal blue"), ("sash", "white"), ("ribbon", "dark blue"))[variant],
        rng,
        3.2,
        (0.5, 0.52) if variant < 2 else (0.86, 0.5),
    )
    front = 0.37 * x
    b.box((0.05 * x, 0.7 * y, 0.1 * z), (front + 0.02 * x, 0, 0.27 * z), "signal blue")
    m.board(b, "POLICE", (front + 0.04 * x, 0, 0.27 * z), 0.62 * y, 0.1 * z, "signal blue", "white")
    door = (0.0, -0.2, 0.2)[variant] * y
    m.gate(b, (front + 0.02, door, 0.02 * z), 0.13 * y, 0.2 * z, "signal blue")
    m.steps(b, front, 0.2 * y, 2, 0.01 * z, 0.35, "granite", door)
    for s in (-1, 1):
        b.rod((front, door + s * 0.1 * y, 0.18 * z), (front + 0.8, door + s * 0.1 * y, 0.18 * z), 0.06, "black", 6)
        b.ball((0.35, 0.35, 0.45), (front + 0.8, door + s * 0.1 * y, 0.2 * z), "#2a6fe0", segments=10, rings=6)
    b.panel(
        roller_door("signal blue"), (front + 0.04, (-0.36 if door >= 0 else 0.36) * y, 0.11 * z), 0.16 * y, 0.22 * z
    )
    sign_box(b, "shield", (front + 0.01 * x, 0, 0.5 * z), 0.24 * z, "signal blue", "white")
    for k in range(3):
        b.cylinder(0.06, (0.14, 0.1, 0.08)[k] * z, (-0.2 * x, (0.1 * k - 0.1) * y, high), "galvanised", segments=6)
    m.flag(b, (0.46 * x, 0.4 * y, 0), 0.5 * z, ("signal blue", "white"))
    names = ("three-storey police station", "brick police station with blue lamps", "modern police station")
    return fitted_as(b.build(names[variant]), "police station", size)


@recipe("fire station", 3, hulls=8, name="services.fire_station")
def fire_station(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Large red doors side by side and a hose tower."""
    size, b = size_of("fire station", variant), MeshBuilder(roughness=0.8)
    x, y, z = size
    wall: m.Wall = (("brick", "#a8604a"), ("plaster", "#e3d9c6"), ("panel", "#c9ced1"))[variant]
    bays, side = (4, 2, 5)[variant], (1, -1, 1)[variant]
    low = 0.5 * z
    vehicle_hall(b, (0.84 * x, 0.8 * y, low), (-0.04 * x, -side * 0.1 * y, 0), bays, wall, "signal red", rng)
    upper = m.painted_front((0.8 * y, 0.2 * z), (bays * 2, 1), wall, ("casement", "white"), rng, 140, (0.5, 0.7))
    m.block(b, (0.5 * x, 0.8 * y, 0.2 * z), (-0.2 * x, -side * 0.1 * y, low + 0.02 * z), upper, "dark concrete")
    t = 0.17 * y
    tower = m.painted_front((t, 0.92 * z), (1, 6), wall, ("single", "white"), rng, 40, (0.4, 0.4))
    at = (0.1 * x, side * (0.5 * y - t / 2), 0.0)
    m.block(b, (t, t, 0.92 * z), at, tower, "dark concrete")
    if variant == 1:
        m.hip_roof(b, (1.2 * t, 1.2 * t, 0.1 * z), (at[0], at[1], 0.92 * z), "#8a4a34", 0.0)
    else:
        m.cornice(b, (t, t, 0.92 * z), at, "off white", 0.05 * t)
    front = 0.38 * x
    m.board(
        b,
        ("FIRE STATION", "FEUERWEHR", "FIRE & RESCUE")[variant],
        (front, -side * 0.1 * y, 0.4 * z),
        0.56 * y,
        0.08 * z,
        "white",
        "signal red",
    )
    sign_box(b, "flame", (at[0] + t / 2, at[1], 0.66 * z), 0.75 * t, "signal red", "white")
    b.box((0.12 * x, 0.78 * y, 0.02), (0.44 * x, -side * 0.1 * y, 0), "dark grey")
    names = ("brick fire station with four red doors", "small fire station with a roofed tower", "modern fire station")
    return fitted_as(b.build(names[variant]), "fire station", size)


@recipe("ambulance station", 3, hulls=8, name="services.ambulance_station")
def ambulance_station(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A vehicle hall with white doors, a star of life and a lit sign; one ambulance before it."""
    size, b = size_of("ambulance station", variant), MeshBuilder(roughness=0.75)
    x, y, z = size
    wall: m.Wall = (("panel", "#dfe3e4"), ("brick", "#a5694f"), ("plaster", "#f0d24a"))[variant]
    side = (1, -1, 1)[variant]
    vehicle_hall(
        b,
        (0.74 * x, 0.68 * y, 0.84 * z),
        (-0.12 * x, -side * 0.15 * y, 0),
        (3, 2, 4)[variant],
        wall,
        ("white", "signal yellow", "white")[variant],
        rng,
    )
    wing(b, (0.66 * x, 0.3 * y, 0.6 * z), (-0.14 * x, side * 0.345 * y, 0), wall, 1, ("casement", "white"), rng, 2.2)
    front = 0.25 * x
    m.board(b, "AMBULANCE", (front, -side * 0.15 * y, 0.8 * z), 0.6 * y, 0.17 * z, "signal red", "white")
    sign_box(b, "cross", (0.2 * x, side * 0.38 * y, 0.62 * z), 0.34 * z, "signal blue", "white")
    m.gate(b, (0.19 * x, side * 0.3 * y, 0), 0.07 * y, 0.38 * z, "signal blue")
    # An ambulance, nose to the street.
    with b.frame((0.34 * x, -side * 0.3 * y, 0)):
        k = 0.3 * x / 5.4
        for px in (-1.5, 1.5):
            for py in (-0.8, 0.8):
                b.cylinder(0.36 * k, 0.22 * k, (px * k, (py + 0.1) * k, 0.36 * k), "black", (90, 0, 0), segments=10)
        b.box((3.4 * k, 2.0 * k, 2.1 * k), (-0.9 * k, 0, 0.4 * k), "white")
        b.box((1.9 * k, 1.9 * k, 1.5 * k), (1.6 * k, 0, 0.4 * k), "white", taper=(0.7, 0.94))
        b.box((5.3 * k, 2.04 * k, 0.3 * k), (0, 0, 0.9 * k), "signal red")
        b.box((0.3 * k, 1.5 * k, 0.18 * k), (0.5 * k, 0, 2.5 * k), "#2a6fe0")
        b.box((0.9 * k, 1.7 * k, 0.5 * k), (2.05 * k, 0, 1.3 * k), "dark glass", taper=(0.5, 0.95))
    names = ("ambulance station of three bays", "small brick ambulance station", "yellow ambulance station")
    return fitted_as(b.build(names[variant]), "ambulance station", size)


@recipe("post office", 3, hulls=8, name="services.post_office")
def post_office(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A high counter hall with an envelope or a horn's colours, and letter boxes by the door."""
    size, b = size_of("post office", variant), MeshBuilder(roughness=0.8)
    x, y, z = size
    wall: m.Wall = (("brick", "#9c5b45"), ("ashlar", "#d6c8ab"), ("panel", "#d4d6d4"))[variant]
    color, ink = (("signal red", "white"), ("signal yellow", "black"), ("signal blue", "white"))[variant]
    high = (0.76, 0.9, 0.92)[variant] * z
    wing(
        b,
        (0.86 * x, y, high),
        (-0.05 * x, 0, 0),
        wall,
        2,
        (("sash", "white"), ("arch", "white"), ("ribbon", "white"))[variant],
        rng,
        3.0,
        (0.5, 0.62),
    )
    if variant == 0:
        m.hip_roof(b, (0.92 * x, 1.04 * y, 0.22 * z), (-0.05 * x, 0, high), "#4d5560", 0.7)
    front = 0.38 * x
    b.box((0.06 * x, 0.8 * y, 0.12 * z), (front + 0.02 * x, 0, 0.38 * z), color)
    m.board(
        b,
        ("POST OFFICE", "POST", "POSTAL SERVICE")[variant],
        (front + 0.045 * x, 0, 0.38 * z),
        0.7 * y,
        0.12 * z,
        color,
        ink,
    )
    m.gate(b, (front + 0.03, 0, 0), 0.14 * y, 0.3 * z, color)
    sign_box(b, "envelope", (front + 0.02 * x, 0.0, 0.56 * z), 0.24 * z, "white" if variant != 1 else "black", color)
    for k, s in enumerate((-1, 1)):
        at = (0.45 * x, s * 0.16 * y, 0.0)
        b.cylinder(0.04 * y, 1.5, at, color, segments=12)
        m.dome(b, (at[0], at[1], 1.5), 0.043 * y, shade(color, 0.9), 0.5, sides=12)
        b.box((0.05, 0.05 * y, 0.06), (at[0] + 0.04 * y, at[1], 1.25 + 0.01 * k), "black")
    names = ("brick post office with a red sign", "stone post office with a yellow sign", "modern postal building")
    return fitted_as(b.build(names[variant]), "post office", size)


@recipe("prison", 2, hulls=10, name="services.prison")
def prison(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Cell blocks with barred windows behind a wall with wire, towers at its corners and a barred gate."""
    size, b = size_of("prison", variant), MeshBuilder(roughness=0.9)
    x, y, z = size
    stone: Color = ("#a8a49a", "#9a6a54")[variant]
    wall, high = (("panel", stone), ("brick", stone))[variant], 0.42 * z
    b.box((x * 0.98, y * 0.98, 0.05), (0, 0, 0), "dark concrete")
    for s in (-1, 1):
        b.box((0.02 * x, 0.96 * y, high), (s * 0.47 * x, 0, 0), shade(stone, 1.1))
        b.box((0.94 * x, 0.02 * x, high), (0, s * 0.47 * y, 0), shade(stone, 1.1))
        for k in range(2):
            z0 = high + 0.025 * z * (k + 1)
            b.rod((s * 0.47 * x, -0.47 * y, z0), (s * 0.47 * x, 0.47 * y, z0), 0.009 * z, "galvanised", 4)
            b.rod((-0.47 * x, s * 0.47 * y, z0), (0.47 * x, s * 0.47 * y, z0), 0.009 * z, "galvanised", 4)
    for k in range(3 if variant == 0 else 2):
        at = (-0.06 * x, (k - (1 if variant == 0 else 0.5)) * (0.29 if variant == 0 else 0.4) * y, 0.0)
        wing(b, (0.66 * x, 0.16 * y, 0.78 * z), at, wall, 4, ("grid", "black"), rng, 3.0, (0.4, 0.34), 80)
    wing(b, (0.14 * x, 0.8 * y, 0.66 * z), (-0.36 * x, 0, 0), wall, 3, ("grid", "black"), rng, 3.4, (0.4, 0.34), 120)
    for sx in (-1, 1):
        for sy in (-1, 1):
            at = (sx * 0.46 * x, sy * 0.46 * y, 0.0)
            b.cylinder(0.035 * y, 0.72 * z, at, shade(stone, 1.05), segments=8)
            b.cylinder(0.055 * y, 0.12 * z, (at[0], at[1], 0.72 * z), "dark glass", segments=8)
            b.cone(0.065 * y, 0.14 * z, (at[0], at[1], 0.84 * z), "charcoal", segments=8)
    b.box((0.06 * x, 0.16 * y, 0.56 * z), (0.46 * x, 0, 0), shade(stone, 0.9))
    for k in range(9):
        b.box((0.1, 0.006 * y, 0.32 * z), (0.495 * x, (k - 4) * 0.011 * y, 0), "black")
    m.board(b, ("STATE PRISON", "PRISON")[variant], (0.49 * x, 0, 0.42 * z), 0.15 * y, 0.08 * z, "charcoal", "white")
    return fitted_as(
        b.build(f"{('concrete', 'brick')[variant]} prison with cell blocks and watch towers", {"wall": wall[0]}),
        "prison",
        size,
    )
