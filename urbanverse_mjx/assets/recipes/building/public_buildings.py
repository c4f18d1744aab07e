"""Hotels, banks, schools."""

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import recipe
from ..nature.foliage import potted_bush
from ..shared import facade_images as images
from .facade import BUILDING, Facade, bays_over, finish_block, stoop


@recipe("hotel", 3, BUILDING, hulls=8, name="public_buildings.hotel")
def hotel(variant: int, rng: np.random.Generator) -> BuiltAsset:
    kind, color, name, back, ink, width = (
        ("ashlar", "#d9ccb3", "GRAND HOTEL", "dark red", "gold", 13.0),
        ("brick", "#7e4335", "HOTEL PARK", "dark green", "cream", 11.0),
        ("plaster", "#e5e2da", "CITY HOTEL", "signal blue", "white", 12.0),
    )[variant]
    floors, storey, depth = 4, 3.0, 8.0
    height = 4.0 + (floors - 1) * storey + 0.4
    f = Facade(MeshBuilder(roughness=0.85), width, depth, height, "off white")
    panes = [images.window("sash", "white", rng, lit=k == 1) for k in range(3)]
    bays = bays_over(5, width - 0.8)
    for level in range(floors - 1):
        z = 4.0 + level * storey
        for k, y in enumerate(bays):
            f.opening(y, z + 0.55, 1.15, 1.8, panes[int(rng.integers(3))], lintel="off white" if variant != 2 else None)
            if variant == 0 and level == 0 and k != 2:
                f.balcony(y, z + 0.42, 1.7, 0.5)
    lobby = images.shop_window("tables", shade(back, 0.8), rng, (96, 72))
    for k in (0, 1, 3, 4):
        f.opening(bays[k], 0.7, 1.75, 2.1, lobby, 0.18)
    f.opening(0, 0.05, 2.0, 2.6, images.door(back, "double", (48, 60)), 0.5, sill=False)
    # The canopy over the entrance on two posts.
    reach = 1.5
    f.builder.box(
        (reach, 3.0, 0.3), (f.front + reach / 2, 0, 2.9), back, skins={"+x": images.sign(name, back, ink, (128, 14))}
    )
    for side in (-1, 1):
        f.builder.cylinder(0.05, 2.9, (f.front + reach - 0.15, side * 1.35, 0), "brass", segments=8)
        potted_bush(f.builder, (f.front + 0.5, side * 1.7, 0), 0.5, "black", rng, "dark leaf")
    f.course(3.35, 0.2, 0.12)
    tall = np.asarray(images.paint.shrunk(_vertical("HOTEL", back, ink), (24, 96)))
    y = width / 2 - 0.7
    f.builder.box((0.7, 0.14, 2.8), (f.front + 0.55, y, 5.2), back, skins={"+y": tall, "-y": tall})
    f.walls(images.wall(kind, (width, height), color, rng), "granite", 0.6)
    f.cornice(height - 0.36, 0.35)
    if variant == 0:
        f.mansard(2.2, "#46525c", bays_over(4, width - 1), panes[0])
    else:
        f.flat_roof(0.6)
        f.builder.box(
            (0.2, 5.0, 0.9),
            (f.front - 0.3, 0, height + 0.6),
            back,
            skins={"+x": images.sign(name, back, ink, (160, 28))},
        )
    names = (
        "A grand hotel with a canopy and balconies",
        "A brick hotel with a green canopy",
        "A white city hotel with a roof sign",
    )
    return finish_block(f, names[variant], {"name": name, "wall": kind})


def _vertical(words: str, back: Color, ink: Color) -> images.Image.Image:
    image, pen = images.paint.canvas((96, 384), back)
    for k, letter in enumerate(words):
        images.paint.text(pen, letter, (16, 12 + 72 * k, 80, 72 + 72 * k), ink, 0.03)
    return image


@recipe("bank", 3, BUILDING, hulls=8, name="public_buildings.bank")
def bank(variant: int, rng: np.random.Generator) -> BuiltAsset:
    name, color, width = (
        ("FIRST BANK", "#d8d2c2", 11.0),
        ("SAVINGS BANK", "#c9b595", 12.0),
        ("BANCO CENTRAL", "#b9bcbd", 10.0),
    )[variant]
    height, depth = (8.2, 7.4, 9.6)[variant], 7.5
    f = Facade(MeshBuilder(roughness=0.7), width, depth, height, shade(color, 1.05))
    bays = bays_over(5, width - 1.2)
    pane = images.window("grid", "#5d4a2a", rng, (32, 80))
    for k, y in enumerate(bays):
        if k == 2:
            f.opening(y, 0.68, 1.5, 3.0, images.door("#4a3a22", "double", (40, 72)), 0.5, sill=False)
        else:
            f.opening(y, 1.4, 1.0, 3.0, pane, 0.3)
        if variant == 2:
            f.opening(y, 6.0, 1.0, 1.7, pane, 0.3)
    steps = 4
    for k in range(steps):
        reach = 0.35 * (steps - k) + 0.55
        f.builder.box(
            (reach, width * 0.62 if variant != 2 else 3.0, 0.17), (f.front + reach / 2, 0, 0.17 * k), "granite"
        )
    top = 5.3
    if variant != 2:
        for k in range(6):
            y = (k - 2.5) * (width * 0.62 - 0.5) / 5
            if abs(y) < 0.3:
                continue
            f.builder.lathe(
                [(0.36, 0), (0.36, 0.14), (0.29, 0.24), (0.25, top - 1.2), (0.34, top - 1.02), (0.36, top - 0.9)],
                (f.front + 0.42, y, 0.68),
                color,
                segments=12,
            )
        f.builder.box(
            (0.95, width * 0.66, 0.75),
            (f.front + 0.47, 0, top - 0.24),
            color,
            skins={"+x": images.sign(name, color, "#3a3226", (192, 24))},
        )
        with f.builder.frame((f.front + 0.55, 0, top + 0.51), (0, 0, 90)):
            f.builder.profile([(-width * 0.35, 0), (width * 0.35, 0), (0, 1.3)], 1.1, color=shade(color, 0.96))
    else:
        for y in (-width / 2 + 0.3, -width / 4, width / 4, width / 2 - 0.3):
            f.pilaster(y, 0.5, height - 0.5, 0.5)
        f.fascia(0, 4.85, width - 1.2, 0.6, images.sign(name, "#2d3a4a", "gold", (192, 14)), "#2d3a4a")
    f.course(0.5, 0.15, 0.08)
    f.walls(images.wall("ashlar", (width, height), color, rng), shade(color, 0.8), 0.5)
    f.cornice(height - 0.4, 0.4)
    f.flat_roof(0.7)
    names = (
        "A bank with columns and a pediment",
        "A sandstone savings bank with columns",
        "A stone bank with pilasters",
    )
    return finish_block(f, names[variant], {"name": name})


@recipe("school", 3, BUILDING, hulls=8, name="public_buildings.school")
def school(variant: int, rng: np.random.Generator) -> BuiltAsset:
    kind, color, width, name = (
        ("brick", "#9a5843", 14.0, "PRIMARY SCHOOL"),
        ("plaster", "#e1c77a", 14.0, "SCHOOL"),
        ("panel", "#cdd3d6", 13.0, "CITY SCHOOL"),
    )[variant]
    height, depth = 7.6, 7.5
    f = Facade(MeshBuilder(roughness=0.88), width, depth, height, "white")
    panes = [images.window("grid", ("white", "signal blue", "signal red")[variant], rng, (64, 48)) for _ in range(2)]
    # Children's paintings in one of the windows.
    pixels = np.asarray(panes[1]).copy()
    for k in range(6):
        pixels[26:38, 6 + 9 * k : 13 + 9 * k] = images.rgb(("red", "yellow", "blue", "green", "orange", "pink")[k])
    bays = bays_over(5, width - 0.8)
    for level in range(2):
        for k, y in enumerate(bays):
            if level == 0 and k == 2:
                continue
            f.opening(
                y,
                0.95 + 3.4 * level,
                2.0,
                1.7,
                pixels if (k + level) % 3 == 0 else panes[0],
                0.12,
                lintel="white" if variant == 0 else None,
            )
    f.opening(
        0,
        0.36,
        2.0,
        2.5,
        images.door(("dark green", "signal blue", "signal red")[variant], "double", (48, 60)),
        0.5,
        sill=False,
    )
    stoop(f, 0, 3.2, 2)
    f.builder.box((1.6, 3.4, 0.18), (f.front + 0.8, 0, 3.05), "white")
    for side in (-1, 1):
        f.builder.cylinder(0.08, 3.05, (f.front + 1.4, side * 1.5, 0), "white", segments=8)
    f.fascia(0, 3.25, 5.4, 0.62, images.sign(name, "white", "dark blue", (176, 20)), "white")
    f.course(0.6, 0.1, 0.05)
    f.walls(images.wall(kind, (width, height), color, rng), shade(color, 0.7), 0.6)
    if variant == 0:
        f.gable_roof(2.2, "#7b3f33", wall=color)
        f.builder.box((1.2, 1.2, 1.6), (0, 0, height + 1.6), "white", skins={"+x": _clock()})
        f.builder.box((1.5, 1.5, 1.3), (0, 0, height + 3.2), "#7b3f33", taper=(0.02, 0.02))
    else:
        f.flat_roof(0.5)
        if variant == 1:
            f.builder.panel(_clock(), (f.front + 0.03, 0, height - 0.9), 1.1, 1.1)
    f.builder.cylinder(0.03, 5.0, (f.front + 0.9, width / 2 - 0.7, 0), "aluminium", segments=6)
    f.builder.quad(
        [(f.front + 0.93, width / 2 - 0.7 - k, z) for k, z in ((1.2, 4.2), (0, 4.2), (0, 4.95), (1.2, 4.95))],
        "signal blue",
        both_sides=True,
    )
    names = (
        "A brick primary school with a clock turret",
        "A yellow school with a clock",
        "A modern school with a red door",
    )
    return finish_block(f, names[variant], {"name": name, "wall": kind})


def _clock() -> np.ndarray:
    image, pen = images.paint.canvas((128, 128), "white")
    pen.ellipse((6, 6, 122, 122), outline=images.rgb("black"), width=8)
    for k in range(12):
        a = np.pi * k / 6
        pen.line(
            (64 + 44 * np.cos(a), 64 + 44 * np.sin(a), 64 + 54 * np.cos(a), 64 + 54 * np.sin(a)),
            fill=images.rgb("black"),
            width=5,
        )
    pen.line((64, 64, 64, 22), fill=images.rgb("black"), width=6)
    pen.line((64, 64, 92, 76), fill=images.rgb("black"), width=8)
    return np.asarray(images.paint.shrunk(image, (32, 32)))
