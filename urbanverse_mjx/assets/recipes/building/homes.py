"""Bungalows, cabins, hostels, motels and trulli."""

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import recipe
from ..nature.foliage import leafy, small_leaves
from ..shared import facade_images as images
from ..shared.sizes import fitted_as, size_of
from . import masonry as m
from .facade import Facade, bays_over


@recipe("bungalow", 3, hulls=8, name="homes.bungalow")
def bungalow(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """One storey under a low hipped or gabled roof, with a porch."""
    size = size_of("bungalow", variant)
    x, y, z = size
    kind, color, roof, style = (
        ("plaster", "#e8dcc0", "#8c4a34", "casement"),
        ("boards", "#9ab0a8", "#4d5560", "sash"),
        ("brick", "#a5634a", "#5e4038", "grid"),
    )[variant]
    wall = 0.56 * z
    f = Facade(MeshBuilder(roughness=0.88), 0.9 * y, 0.78 * x, wall, "white")
    panes = [images.window(style, "white", rng, (52, 44)) for _ in range(2)]
    bays = bays_over(4, f.width - 1.0)
    door = (1, 2, 0)[variant]
    for k, by in enumerate(bays):
        if k == door:
            f.opening(
                by,
                0.2,
                1.1,
                min(2.1, 0.74 * wall),
                images.door(("dark green", "signal red", "dark wood")[variant]),
                0.2,
                sill=False,
            )
        else:
            f.opening(by, 0.36 * wall, 0.55 * f.width / 4, 0.44 * wall, panes[k % 2], 0.12)
    f.walls(images.wall(kind, (f.width, wall), color, rng, 160), shade(color, 0.72), 0.25)
    b = f.builder
    if variant == 1:
        f.gable_roof(z - wall - 0.15, roof, 0.5, along=True, wall=color)
    else:
        m.hip_roof(b, (1.0 * x, 1.02 * y, z - wall), (0, 0, wall - 0.02), roof, 0.45)
    by = bays[door]
    b.box((1.6, 2.6, 0.18), (f.front + 0.8, by, 0), "granite")
    b.box((1.7, 2.8, 0.16), (f.front + 0.8, by, 0.86 * wall), "white")
    for s in (-1, 1):
        b.box((0.16, 0.16, 0.86 * wall), (f.front + 1.45, by + s * 1.15, 0), "white")
    b.box((0.6, 0.8, 0.5 * (z - wall) + 0.6), (-0.1 * x, 0.26 * y, wall + 0.3 * (z - wall)), "brick")
    leaves = small_leaves("leaf", rng)
    for k in bays:
        if k != by:
            leafy(b, (f.front + 0.4, k, 0.35), (0.36, 0.16 * f.width / 2, 0.4), leaves, rng, 8, 5)
    names = ("cream bungalow with a hipped roof", "blue wooden bungalow", "brick bungalow")
    return fitted_as(b.build(names[variant], {"wall": kind}), "bungalow", size)


@recipe("cabin", 3, hulls=8, name="homes.cabin")
def cabin(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Logs with crossing ends under a steep roof; a plank hut with a porch; an A-frame."""
    size, b = size_of("cabin", variant), MeshBuilder(roughness=0.92)
    x, y, z = size
    wood: Color = ("#8a5a34", "#7a6a58", "#6b4528")[variant]
    if variant == 2:
        with b.frame((0, 0, 0), (0, 0, 90)):
            b.profile([(-0.44 * y, 0), (0.44 * y, 0), (0, 0.92 * z)], 0.86 * x, color=wood)
            b.profile(
                [(-0.5 * y, 0), (0, 0.93 * z), (0.5 * y, 0), (0.5 * y, 0.03 * z), (0, z), (-0.5 * y, 0.03 * z)],
                x,
                color="#3f4a44",
            )
        front, wall = 0.43 * x, 0.5 * z
        b.panel(images.window("grid", "cream", rng, (48, 48)), (front + 0.02, 0, 0.6 * z), 0.22 * y, 0.22 * z)
    else:
        wall, depth = 0.54 * z, 0.74 * x
        if variant == 0:
            rows = 9
            r = wall / rows / 2
            for k in range(rows):
                h = (2 * k + 1) * r
                for s in (-1, 1):
                    b.rod(
                        (s * depth / 2 - 0.1 * x, -0.47 * y, h),
                        (s * depth / 2 - 0.1 * x, 0.47 * y, h),
                        r * 1.03,
                        shade(wood, 0.92 + 0.05 * (k % 3)),
                        7,
                    )
                    b.rod(
                        (-depth / 2 - 0.16 * x, s * 0.42 * y, h + r * 0.5),
                        (depth / 2 - 0.04 * x, s * 0.42 * y, h + r * 0.5),
                        r * 1.03,
                        shade(wood, 1.0 - 0.05 * (k % 3)),
                        7,
                    )
        else:
            face = images.wall("boards", (0.84 * y, wall), wood, rng, 96)
            m.block(b, (depth, 0.86 * y, wall), (-0.1 * x, 0, 0), face, wood)
        front = depth / 2 - 0.1 * x + 0.06
        half, rise = 0.56 * x, z - wall
        b.profile([(-0.47 * x, wall), (depth / 2 - 0.1 * x, wall), (-0.1 * x, z - 0.14)], 0.8 * y, color=wood)
        roof = [
            (-0.5 * x, wall - 0.1 * rise),
            (-0.1 * x, z - 0.12),
            (half - 0.06 * x, wall - 0.02 * rise),
            (half - 0.06 * x, wall + 0.05),
            (-0.1 * x, z),
            (-0.5 * x, wall - 0.02 * rise),
        ]
        b.profile(roof, y, color=("#4a5548", "#7a4034")[variant])
        for k in (-0.44, 0.44):
            b.rod((0.44 * x, k * y, 0), (0.44 * x, k * y, wall), 0.07, wood, 7)
        b.box((0.24 * x, 0.96 * y, 0.12), (0.37 * x, 0, 0), "grey wood")
    door = 0.0 if variant == 2 else -0.2 * y
    b.box((0.08, 0.2 * y, 0.8 * wall), (front, door, 0.1), "dark wood")
    b.panel(images.door("#5d3a24", "panel", (28, 56)), (front + 0.06, door, 0.1 + 0.39 * wall), 0.17 * y, 0.76 * wall)
    if variant != 2:
        b.box((0.08, 0.26 * y, 0.42 * wall), (front, 0.2 * y, 0.36 * wall), "white")
        b.panel(
            images.window("grid", "white", rng, (40, 36)), (front + 0.06, 0.2 * y, 0.57 * wall), 0.23 * y, 0.38 * wall
        )
    b.box((0.12 * x, 0.12 * y, 0.34 * z), (-0.2 * x, 0.3 * y, 0.62 * z), "#8b857c")
    for h in (0.08, 0.2, 0.32):  # stacked firewood
        b.rod((0.24 * x, 0.47 * y, h), (-0.3 * x, 0.47 * y, h), 0.06, "light wood", 6)
    names = ("log cabin with a porch", "plank hut with a porch", "A-frame cabin")
    return fitted_as(b.build(names[variant]), "cabin", size)


@recipe("hostel", 3, hulls=8, name="homes.hostel")
def hostel(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A four-storey town house with a bright sign, flags and a bunk bed on its shield."""
    size = size_of("hostel", variant)
    x, y, z = size
    kind, color, back, name = (
        ("plaster", "#e0a84a", "teal", "HOSTEL"),
        ("brick", "#94553f", "signal blue", "YOUTH HOSTEL"),
        ("plaster", "#8fb8b0", "orange", "BACKPACKERS HOSTEL"),
    )[variant]
    roof = (0.45, 2.2, 0.45)[variant]
    f = Facade(MeshBuilder(roughness=0.85), 0.97 * y, 0.86 * x, z - roof, "off white")
    floors = max(3, round(f.height / 3.1))
    storey, count = (f.height - 0.4) / floors, max(4, round(f.width / 2.7))
    panes = [images.window(("casement", "sash", "grid")[variant], "white", rng) for _ in range(2)]
    for level in range(floors):
        for k, by in enumerate(bays_over(count, f.width - 0.8)):
            if level == 0 and abs(by) < 2.2:
                continue
            f.opening(by, level * storey + 0.9, 1.15, min(1.6, storey - 1.3), panes[(k + level) % 2])
    f.opening(0, 0.05, 2.0, min(2.5, storey - 0.4), images.door(back, "double", (48, 60)), 0.4, sill=False)
    f.course(storey - 0.05, 0.14, 0.1)
    f.walls(images.wall(kind, (f.width, f.height), color, rng, 180), shade(color, 0.7), 0.5)
    f.fascia(0, storey - 0.1, 0.62 * f.width, 1.3, images.sign(name, back, "white", (224, 26)), back)
    bunk, pen = images.paint.canvas((96, 96), "white")
    for top in (20, 54):
        pen.rectangle((14, top + 14, 82, top + 20), fill=images.rgb(back))
        pen.rounded_rectangle((26, top + 4, 82, top + 14), 4, fill=images.rgb("light blue"))
        pen.ellipse((14, top + 2, 28, top + 14), fill=images.rgb("cream"))
    for px in (10, 82):
        pen.rectangle((px, 12, px + 5, 90), fill=images.rgb(back))
    face = np.asarray(images.paint.shrunk(bunk, (48, 48)))
    f.blade_sign(-0.44 * f.width, 1.5 * storey, face, 1.7, back)
    for k, flag_y in enumerate((-0.3, -0.2, 0.2, 0.3)):
        pair = (("signal red", "white"), ("signal blue", "signal yellow"), ("green", "white"), ("orange", "dark blue"))[
            k
        ]
        with f.builder.frame((f.front, flag_y * f.width, storey + 0.6), (0, 50, 0)):
            m.flag(f.builder, (0, 0, 0), 1.9, pair)
    if roof > 1:
        f.gable_roof(roof - 0.15, "#6b4038", wall=color)
    else:
        f.cornice(f.height - 0.35, 0.25)
        f.flat_roof(roof)
    names = ("yellow hostel", "brick youth hostel", "turquoise backpackers' hostel")
    return fitted_as(f.builder.build(names[variant], {"name": name}), "hostel", size)


@recipe("motel", 3, hulls=10, name="homes.motel")
def motel(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Two floors of doors along a gallery, a stair, parked cars before them and a tall sign with an arrow."""
    size, b = size_of("motel", variant), MeshBuilder(roughness=0.8)
    x, y, z = size
    color, accent = (("#e8dcc0", "signal red"), ("#d98a6a", "teal"), ("#c9d4d8", "purple"))[variant]
    rooms, floors = (9, 6, 11)[variant], 2
    high = 0.84 * z
    room, pen = images.paint.canvas((160, 128), color)
    pen.rectangle((14, 28, 62, 128), fill=images.rgb(accent))
    pen.ellipse((52, 76, 58, 82), fill=images.rgb("gold"))
    pen.rectangle((78, 34, 150, 92), fill=images.rgb("white"))
    pen.rectangle((84, 40, 144, 86), fill=images.rgb("dark glass"))
    pen.polygon([(84, 40), (110, 40), (92, 86), (84, 86)], fill=images.rgb("cream"))
    pen.rectangle((34, 12, 48, 24), fill=images.rgb("lamp"))
    tile = images.paint.shrunk(room, (40, 32))
    depth, wide = 0.6 * x, 0.8 * y
    at_y = -0.08 * y
    b.box((depth, wide, high), (-0.16 * x, at_y, 0), color)
    front = depth / 2 - 0.16 * x
    for level in range(floors):
        for k in range(rooms):
            b.panel(
                tile,
                (front + 0.03, at_y + (k - (rooms - 1) / 2) * wide / rooms, (level + 0.5) * high / 2),
                wide / rooms,
                0.48 * high,
            )
    b.box((0.16 * x, wide, 0.03 * z), (front + 0.08 * x, at_y, 0.49 * high), "light grey")
    b.box((depth + 0.2 * x, 1.03 * wide, 0.04 * z), (-0.08 * x, at_y, high), accent)
    for k in range(rooms + 1):
        b.box((0.12, 0.12, high), (front + 0.15 * x, at_y + (k / rooms - 0.5) * wide * 0.99, 0), "white")
    for h in (0.06, 0.12, 0.17):
        b.box((0.05, wide, 0.05), (front + 0.15 * x, at_y, (0.43 + h) * z), "white")
    for k in range(10):
        b.box(
            (0.14 * x, 0.3, 0.05 * z),
            (front + 0.08 * x, at_y + wide / 2 + 0.2 + 0.28 * (9 - k), (k + 1) * 0.041 * z),
            "grey",
        )
    for k in range(3):  # parked cars
        car = (0.36 * x, at_y + (0.24 - 0.26 * k) * wide, 0.0)
        b.box((0.24 * x, 1.7, 0.75), (car[0], car[1], 0.3), ("signal red", "light blue", "off white")[k])
        b.box((0.13 * x, 1.5, 0.55), (car[0] - 0.01 * x, car[1], 1.05), "dark glass", taper=(0.75, 0.85))
        for px in (-0.07, 0.07):
            for py in (-0.75, 0.75):
                b.cylinder(0.3, 0.2, (car[0] + px * x, car[1] + py + 0.1, 0.3), "black", (90, 0, 0), segments=8)
    sign_y = 0.42 * y
    for s in (-1, 1):
        b.cylinder(0.12, 0.7 * z, (0.3 * x, sign_y + s * 0.04 * y, 0), "dark grey", segments=8)
    lettering = images.sign("MOTEL", accent, "white", (120, 40), "signal yellow")
    for s in (0, 180):
        with b.frame((0.3 * x, sign_y, 0.6 * z), (0, 0, s)):
            b.panel(lettering, (0.16, 0, 0.2 * z), 0.15 * y, 0.24 * z)
            b.panel(images.sign("VACANCY", "white", accent, (96, 20)), (0.16, 0, 0.02 * z), 0.1 * y, 0.08 * z)
    b.box((0.3, 0.155 * y, 0.26 * z), (0.3 * x, sign_y, 0.67 * z), accent)
    b.box((0.3, 0.1 * y, 0.09 * z), (0.3 * x, sign_y, 0.575 * z), "white")
    with b.frame((0.3 * x, sign_y + 0.07 * y, 0.93 * z), (0, 90, 0)):
        b.extrude(
            [(0.0, 0.03 * y), (0.0, -0.1 * y), (-0.05 * z, -0.1 * y), (0.03 * z, -0.13 * y)],
            0.2,
            (0, 0, -0.1),
            "signal yellow",
        )
    names = ("cream motel with red doors", "small orange motel", "grey motel with purple doors")
    return fitted_as(b.build(names[variant], {"rooms": rooms * floors}), "motel", size)


@recipe("trullo", 3, hulls=4, name="homes.trullo")
def trullo(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """White round or square walls under a cone of grey stone with a ball on its tip and a painted sign."""
    size, b = size_of("trullo", variant), MeshBuilder(roughness=0.92)
    z = size[2]
    wall, r = 0.42 * z, 0.47 * min(size[0], size[1])
    if variant == 1:
        b.box((1.9 * r, 1.9 * r, wall), (0, 0, 0), "white")
    else:
        b.cylinder(1.03 * r, wall, (0, 0, 0), "white", top_radius=0.97 * r, segments=20)
    rows = 9
    for k in range(rows):  # courses of flat stones, each a little smaller
        low = wall + (0.9 * z - wall) * k / rows
        share, upper = 1.08 - 0.98 * (k / rows) ** 1.1, 1.08 - 0.98 * ((k + 0.8) / rows) ** 1.1
        tone = shade("#8d8a82", 0.9 + 0.07 * (k % 3))
        b.cylinder(r * share, (0.9 * z - wall) / rows, (0, 0, low), tone, top_radius=r * upper, segments=18)
    b.cylinder(0.07 * r, 0.05 * z, (0, 0, 0.88 * z), "white", segments=10)
    b.ball(0.045 * z, (0, 0, 0.955 * z), "white", segments=10, rings=6)
    front = 1.0 * r if variant != 1 else 0.95 * r
    b.box((0.3 * r, 0.62 * r, 0.9 * wall), (front - 0.1 * r, 0, 0), "white")
    with b.frame((front + 0.05 * r, 0, 0.9 * wall), (0, 0, 90)):
        b.profile([(-0.34 * r, 0), (0.34 * r, 0), (0, 0.3 * r)], 0.2 * r, color="#8d8a82")
    b.panel(
        images.door(("dark green", "dark wood", "#2f5f8a")[variant], "panel", (28, 56)),
        (front + 0.06 * r, 0, 0.38 * wall),
        0.4 * r,
        0.76 * wall,
    )
    for s in (-1, 1):
        with b.frame((0, 0, 0), (0, 0, s * 42)):
            at = 1.0 * r if variant != 1 else 1.22 * r
            if variant != 1:
                b.box((0.1 * r, 0.2 * r, 0.2 * r), (at - 0.03 * r, 0, 0.5 * wall), "dark glass")
    # The whitewashed sign on the cone: a cross, a heart or a sun.
    with b.frame((0.66 * r, 0, wall + 0.18 * (z - wall)), (0, -40, 0)):
        if variant == 2:
            b.cylinder(0.16 * r, 0.05, (0.02 * r, 0, 0.1 * r), "white", (0, 90, 0), segments=14)
        else:
            b.box((0.06 * r, 0.09 * r, 0.5 * r), (0.06 * r, 0, 0), "white")
            b.box((0.06 * r, 0.34 * r, 0.09 * r), (0.06 * r, 0, 0.28 * r), "white")
    b.box((0.12 * r, 0.12 * r, 0.3 * z), (-0.5 * r, 0.55 * r, wall * 0.9), "white")
    names = ("round trullo", "square trullo", "round trullo with a blue door")
    return fitted_as(b.build(names[variant]), "trullo", size)
