"""Small buildings of streets and squares: toilets, photo booths, pump houses, transformer towers, lifts. Door at +x."""

import numpy as np
from PIL import Image

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, rgb, shade
from ...meshes.recipe import recipe
from ..shared.facade_images import door, sign, wall, window
from ..shared.sizes import made
from .shelters import glazing
from .street_terminals import bolt_image

SIDES = ("+x", "-x", "+y", "-y")


def people_mark(back: Color = "signal blue") -> Image.Image:
    """A man and a woman beside a dividing line."""
    image, draw = paint.canvas((192, 192), back)
    white = rgb("white")
    for x, skirt in ((52, False), (140, True)):
        draw.ellipse((x - 15, 22, x + 15, 52), fill=white)
        if skirt:
            draw.polygon([(x - 14, 58), (x + 14, 58), (x + 34, 128), (x - 34, 128)], fill=white)
        else:
            draw.rectangle((x - 24, 58, x + 24, 116), fill=white)
        draw.rectangle((x - 15, 110, x - 3, 172), fill=white)
        draw.rectangle((x + 3, 110, x + 15, 172), fill=white)
    draw.rectangle((93, 24, 99, 168), fill=white)
    return paint.shrunk(image, (48, 48))


@recipe("public toilets", 3, name="cabins.public_toilets")
def public_toilets(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """An oval automatic cabin, a plastic site cabin, a brick house with two doors."""
    b = MeshBuilder(roughness=0.6)
    if variant % 3 == 0:
        rows = [
            np.array(
                [
                    (0.9 * np.sign(c) * abs(c) ** 0.6, 1.0 * np.sign(s) * abs(s) ** 0.6, z)
                    for c, s in zip(np.cos(t), np.sin(t), strict=True)
                ]
            )
            for z in (0.1, 2.2)
            for t in [np.linspace(0, 2 * np.pi, 29)[:-1]]
        ]
        b.loft([r * (1.02, 1.02, 0) + (0, 0, z) for r in rows[:1] for z in (0, 0.12)], "dark grey")
        b.loft(rows, "#6d7f86")
        b.loft([rows[0] * (1.05, 1.05, 0) + (0, 0, z) for z in (2.2, 2.32)], "charcoal")
        b.loft([rows[0] * (s, s, 0) + (0, 0, z) for s, z in ((0.98, 2.32), (0.5, 2.5))], "#6d7f86")
        b.box((0.06, 0.95, 2.02), (0.885, -0.1, 0.1), "light grey", bevel=0.015)
        b.box((0.03, 0.04, 0.3), (0.93, 0.28, 0.95), "charcoal", bevel=0.01)
        b.box((0.05, 0.24, 0.5), (0.88, 0.6, 1.0), "charcoal", bevel=0.01)
        b.box((0.02, 0.1, 0.05), (0.91, 0.6, 1.35), "light green")
        b.panel(sign("TOILET", "signal blue", "white", (96, 20)), (0.95, -0.1, 2.27), 0.9, 0.1)
        b.panel(people_mark(), (0.92, -0.1, 1.65), 0.42, 0.42)
        return made(b, "an automatic public toilet", (1.8, 2.0, 2.5), style="automatic")
    if variant % 3 == 1:
        color = "signal blue"
        b.box((1.1, 1.1, 0.12), color="black", bevel=0.02)
        b.box((1.06, 1.06, 1.95), (0, 0, 0.12), color, bevel=0.03)
        for side in (-1, 1):
            for k in range(4):
                b.box((0.14, 0.03, 1.5), (-0.36 + 0.24 * k, side * 0.53, 0.3), shade(color, 1.2), bevel=0.01)
        b.box((0.04, 0.8, 1.8), (0.525, 0, 0.2), shade(color, 1.25), bevel=0.015)
        b.box((0.03, 0.6, 0.02), (0.55, 0, 1.15), shade(color, 0.7))
        b.box((0.04, 0.1, 0.12), (0.555, 0.3, 1.0), "black", bevel=0.01)
        b.box((0.012, 0.05, 0.03), (0.58, 0.3, 1.09), "light green")
        for k in range(6):
            b.box((0.012, 0.5, 0.012), (0.55, 0, 1.8 + 0.025 * k), "black")
        b.panel(sign("WC", "white", "signal blue", (48, 32)), (0.549, 0, 1.5), 0.38, 0.26)
        half = 0.56
        b.convex(
            [(x * half, y * half, 2.07) for x in (-1, 1) for y in (-1, 1)]
            + [(x * half * 0.8, y * half * 0.6, 2.28) for x in (-1, 1) for y in (-1, 1)],
            "white",
        )
        b.cylinder(0.05, 0.4, (-0.45, 0.4, 2.0), "white", segments=12)
        return made(b, "a plastic toilet cabin", (1.13, 1.13, 2.35), style="site cabin")
    w, d, h = 4.4, 3.2, 2.7
    image = wall("brick", (w, h), "#9a5a44", rng, 192)
    b.box((d, w, h), color="brick", skins=dict.fromkeys(SIDES, image))
    for y, words in ((-1.2, "WOMEN"), (1.2, "MEN")):
        b.box((0.08, 1.05, 2.15), (d / 2, y, 0), "white", skins={"+x": door("dark green", "panel", (32, 64))})
        b.panel(sign(words, "signal blue", "white", (64, 18)), (d / 2 + 0.05, y, 2.34), 0.85, 0.22)
    b.panel(people_mark(), (d / 2 + 0.01, 0, 1.7), 0.6, 0.6)
    for y in (-0.5, 0.5):
        b.box((0.1, 0.5, 0.35), (d / 2, y, 2.25), "white", skins={"+x": glazing(24, 16, 2, 1, "white")})
    b.box((d + 0.6, w + 0.6, 0.14), (0, 0, h), "white", bevel=0.02)
    x, y = d / 2 + 0.3, w / 2 + 0.3
    b.convex(
        [(sx * x, sy * y, h + 0.14) for sx in (-1, 1) for sy in (-1, 1)] + [(0, s * (y - x), h + 0.8) for s in (-1, 1)],
        "dark grey",
    )
    for k in range(6):
        b.box((0.06, 0.8, 0.02), (-d / 2, 0, 1.7 + 0.08 * k), "charcoal")
    b.box((0.3, w * 0.8, 0.05), (d / 2 + 0.4, 0, 0), "concrete", bevel=0.01)
    return made(b, "a brick house with public toilets", (3.8, 5.0, 3.5), style="house")


@recipe("photo booth", 3, name="cabins.photo_booth")
def photo_booth(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A booth with a half curtain over a stool, sample strips and a slot; the seat's opening at +x."""
    b = MeshBuilder(roughness=0.4)
    color, title, curtain, (x, y, z) = (
        ("signal blue", "PHOTOS", "dark red", (0.78, 1.6, 1.98)),
        ("cream", "PHOTOMATIC", "dark green", (0.75, 1.75, 2.0)),
        ("charcoal", "PHOTO-ME", "orange", (0.85, 1.45, 1.95)),
    )[variant % 3]
    b.box((0.74, 0.62, 1.95), (0, 0.48, 0), color, bevel=0.02)
    b.box((0.72, 0.05, 1.9), (0, -0.77, 0), color, bevel=0.01)
    b.box((0.04, 1.0, 1.9), (-0.34, -0.3, 0), shade(color, 0.9))
    b.box((0.74, 1.6, 0.08), (0, 0, 0), "charcoal", bevel=0.01)
    b.box((0.78, 1.6, 0.22), (0, 0, 1.76), color, bevel=0.02)
    b.panel(sign(title, shade(color, 0.6), "signal yellow", (160, 22)), (0.392, 0, 1.87), 1.45, 0.18)
    u = np.linspace(-0.74, 0.12, 29)
    fold = 0.31 + 0.03 * np.sin(46 * u)
    b.sheet(
        np.array([[(f, v, low) for f, v in zip(fold, u, strict=True)] for low in (0.85, 1.76)]),
        curtain,
        both_sides=True,
    )
    b.cylinder(0.03, 0.5, (0, -0.3, 0.06), "aluminium")
    b.lathe([(0.17, 0.5), (0.18, 0.53), (0.17, 0.57)], (0, -0.3, 0.03), "black", segments=18)
    b.box((0.03, 0.5, 0.42), (-0.3, -0.3, 1.1), "light grey")
    strip, draw = paint.canvas((48, 160), "white")
    for k in range(4):
        top = 4 + 39 * k
        draw.rectangle((4, top, 44, top + 35), fill=rgb(("light blue", "amber", "teal", "pink")[(k + variant) % 4]))
        draw.ellipse((15, top + 6, 33, top + 24), fill=rgb(("skin light", "skin dark", "skin medium")[k % 3]))
        draw.pieslice((8, top + 22, 40, top + 48), 180, 360, fill=rgb(("dark blue", "red", "green")[k % 3]))
        draw.pieslice((14, top + 3, 34, top + 20), 180, 360, fill=rgb(("dark wood", "black", "gold")[k % 3]))
    for k in range(2):
        b.panel(strip, (0.373, 0.34 + 0.26 * k, 1.3), 0.2, 0.66)
    b.box((0.03, 0.14, 0.26), (0.37, 0.36, 0.55), "black", bevel=0.01)
    b.box((0.03, 0.1, 0.14), (0.37, 0.62, 0.7), "aluminium", bevel=0.01)
    return made(b, f"a {color} photo booth", (x, y, z), 0.8, title=title)


@recipe("pumping station", 3, name="cabins.pumping_station")
def pumping_station(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A brick pump house with a hipped roof and pipes, a concrete kiosk with a valve, a long one with three pumps."""
    b = MeshBuilder(roughness=0.85)
    kind, color, (d, w, h), roof = (
        ("brick", "#a35f46", (2.7, 3.8, 2.5), "terracotta"),
        ("panel", "concrete", (2.0, 2.6, 2.4), None),
        ("plaster", "cream", (3.6, 6.5, 3.2), "dark grey"),
    )[variant % 3]
    b.box((d + 0.3, w + 0.5, 0.15), (0.05, 0, 0), "dark concrete")
    b.box((d, w, h), (0, 0, 0.1), color, skins=dict.fromkeys(SIDES, wall(kind, (w, h), color, rng, 144)))
    b.box((0.08, 1.1, 2.0), (d / 2, -w / 2 + 0.9, 0.1), "dark green", skins={"+x": door("dark green", "panel")})
    for y in (0.3,) if w < 5 else (0.2, 1.5):
        b.box((0.1, 0.8, 0.7), (d / 2, y, 1.35), "white", skins={"+x": window("grid", "white", rng, (32, 28))})
    b.panel(
        sign("PUMPING STATION", "signal blue", "white", (112, 18)),
        (d / 2 + 0.012, w * 0.1, h - 0.2),
        min(w * 0.6, 2.6),
        0.3,
    )
    for k in range(1 if w < 5 else 3):
        y, x = w / 2 - 0.35 - 0.75 * k, d / 2
        b.tube(
            [(x - 0.1, y, 0.7), (x + 0.35, y, 0.7), (x + 0.5, y, 0.6), (x + 0.5, y, 0.1)], 0.13, "signal blue", sides=12
        )
        for at in (0.02, 0.22):
            b.cylinder(0.2, 0.05, (x + at, y, 0.7), "dark blue", turn_deg=(0, 90, 0), segments=16)
        b.cylinder(0.2, 0.05, (x + 0.5, y, 0.15), "dark blue", segments=16)
        b.cylinder(0.03, 0.25, (x + 0.16, y, 0.8), "dark grey", segments=8)
        b.ring(0.13, 0.02, (x + 0.16, y, 1.05), "signal red", segments=16, sides=6)
        b.rod((x + 0.03, y, 1.05), (x + 0.29, y, 1.05), 0.014, "signal red", sides=5)
    if roof:
        x, y = d / 2 + 0.3, w / 2 + 0.3
        b.box((2 * x, 2 * y, 0.12), (0, 0, h + 0.1), "white")
        b.convex(
            [(sx * x, sy * y, h + 0.22) for sx in (-1, 1) for sy in (-1, 1)]
            + [(0, s * (y - x * 0.9), h + 1.0) for s in (-1, 1)],
            roof,
        )
    else:
        b.box((d + 0.2, w + 0.2, 0.15), (0, 0, h + 0.1), "dark concrete", bevel=0.02)
        b.tube([(0, 0.4, h + 0.2), (0, 0.4, h + 0.6), (0.1, 0.4, h + 0.72), (0.25, 0.4, h + 0.6)], 0.07, "galvanised")
    size = ((3.6, 4.5, 3.6), (2.7, 3.1, 3.1), (4.6, 7.1, 4.4))[variant % 3]
    return made(b, f"a {kind} pumping station", size, wall=kind)


@recipe("transformer tower", 3, name="cabins.transformer_tower")
def transformer_tower(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A plastered tower with a tent roof and insulators, a brick one with a gable, a bare concrete one."""
    b = MeshBuilder(roughness=0.85)
    kind, color, roof, size = (
        ("plaster", "#dccfae", "terracotta", (3.4, 3.6, 8.5)),
        ("brick", "#8f4c38", "dark red", (3.2, 3.3, 10.5)),
        ("panel", "concrete", "dark concrete", (2.6, 2.8, 6.4)),
    )[variant % 3]
    d, w, h = 2.9, 3.0, 6.6
    image = wall(kind, (w, h), color, rng, 112)
    b.box((d, w, h), color=color, skins=dict.fromkeys(SIDES, image))
    b.box((d + 0.12, w + 0.12, 0.5), color="granite")
    b.box((d + 0.16, w + 0.16, 0.16), (0, 0, 4.9), shade(color, 0.85))
    b.box((0.1, 1.3, 2.1), (d / 2, 0, 0.05), "charcoal", skins={"+x": door("#4f5f50", "panel", (40, 64))})
    b.panel(bolt_image(), (d / 2 + 0.062, 0.0, 1.55), 0.32, 0.32)
    for side in SIDES[2:]:
        y = (w / 2 + 0.011) * (1 if side == "+y" else -1)
        b.panel(paint.stripes((32, 16), ("charcoal", "dark grey"), 2), (0, y, 3.9), 1.0, 0.5, side)
    for y in (-0.8, 0, 0.8):
        b.rod((d / 2, y, 5.75), (d / 2 + 0.3, y, 5.75), 0.03, "dark grey", sides=6)
        b.lathe(
            [(0.05, 0), (0.09, 0.04), (0.05, 0.09), (0.09, 0.13), (0.05, 0.18), (0.07, 0.25)],
            (d / 2 + 0.3, y, 5.75),
            "brown",
            segments=10,
        )
        b.cylinder(0.13, 0.02, (d / 2, y, 6.25), "black", turn_deg=(0, 90, 0), segments=12)
    e = 0.32
    base = [(sx * (d / 2 + e), sy * (w / 2 + e), h) for sx in (-1, 1) for sy in (-1, 1)]
    base += [(sx * (d / 2 + e), sy * (w / 2 + e), h - 0.12) for sx in (-1, 1) for sy in (-1, 1)]
    if variant % 3 == 0:
        b.convex([*base, (0, 0, h + 1.8)], roof)
        b.ball(0.12, (0, 0, h + 1.85), "dark grey")
    elif variant % 3 == 1:
        b.convex([*base, (-d / 2 - e, 0, h + 1.5), (d / 2 + e, 0, h + 1.5)], roof)
        b.convex(
            [(d / 2 + e - 0.05, s * w / 2, h + 0.05) for s in (-1, 1)]
            + [(d / 2 + e + 0.03, s * w / 2 * 0.9, h + 0.05) for s in (-1, 1)]
            + [(d / 2 + e + 0.03, 0, h + 1.35), (d / 2 + e - 0.05, 0, h + 1.35)],
            shade(color, 1.15),
        )
    else:
        b.box((d + 2 * e, w + 2 * e, 0.25), (0, 0, h), roof, bevel=0.03)
        b.rod((0, -w / 2, h + 0.5), (0, w / 2, h + 0.5), 0.04, "galvanised", sides=6)
        for y in (-1.0, 1.0):
            b.rod((0, y, h), (0, y, h + 0.5), 0.03, "galvanised", sides=6)
    return made(b, f"a {kind} transformer tower", size, wall=kind)


@recipe("elevator", 3, name="cabins.elevator")
def elevator(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A glass lift in a steel frame, a clad one with an L-shaped canopy, a tall glass tower; doors at +x."""
    b = MeshBuilder(roughness=0.35)
    frame, clad, size, levels = (
        ("charcoal", False, (1.7, 1.9, 3.1), 1),
        ("light grey", True, (1.9, 2.1, 3.4), 1),
        ("signal blue", False, (1.9, 2.2, 7.2), 2),
    )[variant % 3]
    d, w, h = 1.6, 1.8, 3.0 * levels
    pane = glazing(48, 64, 2, 2, frame) if not clad else wall("panel", (w, h), frame, rng, 64)
    b.box((d + 0.1, w + 0.1, 0.08), color="dark concrete")
    for level in range(levels):
        z = 0.08 + 3.0 * level
        b.box(
            (d - 0.06, w - 0.06, 2.9),
            (0, 0, z),
            "dark glass" if not clad else frame,
            skins=dict.fromkeys(("-x", "+y", "-y"), pane),
        )
        b.box((0.05, w - 0.2, 2.5), (d / 2 - 0.02, 0, z), frame)
        for side in (-1, 1):
            b.box((0.04, 0.48, 2.1), (d / 2 + 0.01, side * 0.245, z + 0.02), "aluminium", bevel=0.008)
            b.panel(glazing(16, 48, 1, 1, "aluminium"), (d / 2 + 0.033, side * 0.245, z + 1.15), 0.3, 1.5)
        b.box((0.03, 0.12, 0.3), (d / 2 + 0.015, 0.68, z + 1.0), "black", bevel=0.006)
        for k, ink in ((0, "light green"), (1, "white")):
            b.cylinder(0.02, 0.012, (d / 2 + 0.03, 0.68, z + 1.09 + 0.1 * k), ink, turn_deg=(0, 90, 0), segments=10)
        mark = sign("^ 1 v", "black", "amber", (48, 16))
        b.panel(mark, (d / 2 + 0.012, 0, z + 2.32), 0.5, 0.17)
    for x in (-d / 2, d / 2):
        for y in (-w / 2, w / 2):
            b.box((0.1, 0.1, h), (x, y, 0.08), frame, bevel=0.01)
    for level in range(levels + 1):
        b.box((d + 0.1, w + 0.1, 0.12), (0, 0, 3.0 * level - (0 if level == levels else -0.02) + 0.0), frame)
    b.box(
        (d + (0.5 if clad else 0.2), w + 0.2, 0.12), (0.15 if clad else 0, 0, h + 0.08), shade(frame, 0.8), bevel=0.02
    )
    b.panel(
        sign("LIFT", frame, "white" if frame != "light grey" else "black", (64, 20)),
        (d / 2 + 0.045, 0, h - 0.22),
        0.7,
        0.22,
    )
    return made(b, "a glass lift" if not clad else "a clad lift", size, storeys=levels)
