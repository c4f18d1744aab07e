"""Trash bins, dumpsters and recycling points."""

import numpy as np
from PIL import Image

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, rgb, shade
from ...meshes.recipe import Physics, recipe
from ..shared.facade_images import sign
from ..shared.sizes import made

BIN = Physics(
    ("plastic", "steel"),
    130.0,
    (8.0, 60.0),
    0.5,
    True,
    "a 120-240 l wheelie bin weighs 10-15 kg empty, a steel litter bin 25-50 kg",
)


def recycle_mark(size: int, color: Color, ink: Color) -> Image.Image:
    image, draw = paint.canvas((size, size), color)
    c, r = size / 2, size * 0.32
    for k in range(3):
        start = 120 * k - 60
        draw.arc((c - r, c - r, c + r, c + r), start, start + 85, fill=rgb(ink), width=max(size // 9, 3))
        a = np.radians(start + 98)
        tip = np.array([c + r * np.cos(a), c + r * np.sin(a)])
        along, out = np.array([-np.sin(a), np.cos(a)]), np.array([np.cos(a), np.sin(a)])
        base = tip - along * size * 0.17
        points = [tip, base + out * size * 0.14, base - out * size * 0.14]
        draw.polygon([tuple(p) for p in points], fill=rgb(ink))
    return image


def _wheelie(b: MeshBuilder, color: Color, lid: Color, height: float) -> None:
    b.box((0.42, 0.44, height - 0.12), (0, 0, 0.06), color, taper=(1.22, 1.2), bevel=0.02)
    b.box((0.56, 0.56, 0.05), (0.0, 0, height - 0.08), color, bevel=0.015)
    b.box((0.6, 0.56, 0.06), (0.01, 0, height - 0.045), lid, bevel=0.025, taper=(0.92, 0.92))
    # The wheels carry the back, this edge the front: without it the bin tips forward.
    b.box((0.06, 0.4, 0.1), (0.18, 0, 0), color, bevel=0.01)
    b.rod((-0.33, -0.24, height - 0.06), (-0.33, 0.24, height - 0.06), 0.016, "black", sides=6)
    for y in (-0.26, 0.26):
        b.beam((-0.25, y * 0.9, height - 0.06), (-0.33, y * 0.9, height - 0.06), 0.03, 0.03, "black")
        b.cylinder(0.1, 0.05, (-0.22, y - 0.025, 0.1), "rubber", turn_deg=(-90, 0, 0), segments=14)
    b.panel(recycle_mark(48, color, "white"), (0.243, 0, height * 0.5), 0.2, 0.2, tilt_deg=-3.0)


@recipe("trash bin", 4, BIN, hulls=2, name="waste.trash_bin")
def trash_bin(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Wheelie bin, slatted park bin, steel drum with hood, post-mounted basket. Front +x."""
    b = MeshBuilder(roughness=0.6)
    style = ("wheelie", "slatted", "hooded steel", "recycling wheelie")[variant % 4]
    if style == "wheelie":
        _wheelie(b, "dark green", shade("dark green", 1.2), float(rng.uniform(1.0, 1.1)))
    elif style == "recycling wheelie":
        _wheelie(b, "charcoal", "signal blue", float(rng.uniform(0.95, 1.05)))
    elif style == "slatted":
        r, h = 0.26, float(rng.uniform(0.8, 0.9))
        b.cylinder(r - 0.03, h - 0.08, (0, 0, 0.06), "charcoal", segments=18)
        for k in range(18):
            with b.frame(turn_deg=(0, 0, 20 * k)):
                b.box((0.025, 0.07, h - 0.1), (r - 0.012, 0, 0.05), "wood")
        for z in (0.1, h - 0.14):
            b.cylinder(r + 0.004, 0.03, (0, 0, z), "charcoal", segments=24)
        b.ring(r - 0.02, 0.025, (0, 0, h - 0.03), "charcoal", segments=24, sides=6)
        b.cylinder(r - 0.05, 0.01, (0, 0, h - 0.05), "black", segments=18)
        b.cylinder(r * 0.8, 0.05, color="charcoal", segments=18)
    else:
        r, h = 0.23, float(rng.uniform(0.78, 0.88))
        b.cylinder(r, h, color="galvanised", segments=22)
        b.cylinder(r + 0.01, 0.06, color="dark grey", segments=22)
        b.cylinder(r + 0.012, 0.05, (0, 0, h - 0.05), "dark grey", segments=22)
        dome = [(r, h), (r, h + 0.2), (r * 0.85, h + 0.3), (r * 0.5, h + 0.36), (0, h + 0.38)]
        b.lathe(dome, color="dark grey", segments=22)
        mouth = [(0.14 * np.sin(a), 0.075 * np.cos(a)) for a in np.linspace(0, 2 * np.pi, 12, endpoint=False)]
        b.extrude(mouth, 0.02, (r - 0.015, 0, h + 0.13), "black", turn_deg=(90, 0, 90))
        b.panel(recycle_mark(48, "galvanised", "dark green"), (r + 0.004, 0, h * 0.55), 0.16, 0.16)
    return b.build(f"a {style} trash bin", {"style": style})


DUMPSTER = Physics(
    ("steel",),
    95.0,
    (60.0, 480.0),
    0.6,
    False,
    "a 1,100 l four-wheel container weighs 60-130 kg, a front-load dumpster 300-450 kg",
)


@recipe("dumpster", 3, DUMPSTER, hulls=3, name="waste.dumpster")
def dumpster(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Slant-topped front loader, 1,100-litre roll container, open skip. Lids open towards +x."""
    b = MeshBuilder(roughness=0.6)
    style = ("front-load", "roll container", "skip")[variant % 3]
    if style == "front-load":
        color, w = ("green", float(rng.uniform(1.8, 2.0)))
        b.profile([(-0.6, 0.12), (0.55, 0.12), (0.65, 0.95), (-0.65, 1.25)], w, color=color)
        b.profile([(0.67, 0.95), (0.67, 1.0), (-0.67, 1.3), (-0.67, 1.25)], w * 0.99, color="black")
        for y in (-w / 2 - 0.04, w / 2 + 0.04):
            b.box((0.9, 0.1, 0.16), (0, y, 0.62), color)
        for y in np.linspace(-w / 2 + 0.12, w / 2 - 0.12, 5):
            b.beam((0.57, y, 0.14), (0.66, y, 0.93), 0.06, 0.05, shade(color, 0.8))
        for x in (-0.45, 0.45):
            for y in (-w / 2 + 0.15, w / 2 - 0.15):
                b.cylinder(0.08, 0.06, (x, y - 0.03, 0.08), "rubber", turn_deg=(-90, 0, 0), segments=12)
    elif style == "roll container":
        b.box((0.95, 1.2, 0.85), (0, 0, 0.22), "dark grey", taper=(1.1, 1.08), bevel=0.03)
        b.box((1.08, 1.36, 0.07), (0, 0, 1.04), "dark grey", bevel=0.02)
        dome = [(-0.52, 0.0), (0.52, 0.0), (0.5, 0.1), (0.3, 0.2), (-0.3, 0.22), (-0.5, 0.12)]
        b.profile(dome, 1.32, (0, 0, 1.11), "signal yellow" if rng.random() < 0.5 else "blue")
        for x in (-0.36, 0.36):
            for y in (-0.48, 0.48):
                b.cylinder(0.1, 0.05, (x, y - 0.025, 0.1), "rubber", turn_deg=(-90, 0, 0), segments=12)
                b.box((0.08, 0.09, 0.1), (x, y, 0.15), "galvanised")
        b.rod((0.55, -0.5, 0.9), (0.55, 0.5, 0.9), 0.02, "galvanised", sides=6)
        b.panel(recycle_mark(48, "dark grey", "white"), (0.517, 0, 0.62), 0.4, 0.4, tilt_deg=-3.2)
    else:
        w = 1.7
        side = [(-1.7, 1.2), (-0.9, 0.05), (0.9, 0.05), (1.7, 1.2)]
        inner = [(-1.55, 1.2), (-0.85, 0.15), (0.85, 0.15), (1.55, 1.2)]
        b.profile(side + list(reversed(inner)), w, color="orange")
        for y in (-w / 2, w / 2):
            b.profile(side, 0.06, (0, y, 0), "orange")
            b.beam((-1.72, y, 1.2), (1.72, y, 1.2), 0.1, 0.08, shade("orange", 0.85))
            for x in (-0.7, 0.0, 0.7):
                b.beam((x, y * 1.03, 0.1), (x * 1.15, y * 1.03, 1.15), 0.05, 0.07, shade("orange", 0.85))
        b.convex(
            [
                (-1.2, -0.75, 0.5),
                (1.2, 0.75, 0.5),
                (1.2, -0.75, 0.5),
                (-1.2, 0.75, 0.5),
                (-0.4, 0.2, 1.15),
                (0.5, -0.3, 1.05),
            ],
            "dark concrete",
        )
        b.convex([(0.1, -0.6, 0.6), (0.9, 0.5, 0.8), (0.5, 0.1, 1.25), (0.2, 0.5, 0.7), (1.1, -0.4, 0.7)], "brick")
    return b.build(f"a {style} dumpster", {"style": style})


@recipe("waste station", 3, name="yard_things.waste_station")
def waste_station(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Three igloos for glass and paper, four square banks with slots, an underground point with columns; front +x."""
    b = MeshBuilder(roughness=0.6)
    goods = (("green", "GLASS"), ("signal blue", "PAPER"), ("signal yellow", "PLASTIC"), ("light grey", "METAL"))
    count = (3, 4, 3)[variant % 3]
    for k in range(count):
        color, words = goods[k]
        y = (k - (count - 1) / 2) * 1.35
        ink = "black" if color in ("signal yellow", "light grey") else "white"
        image = sign(words, color, ink, (80, 20))
        if variant % 3 == 0:
            b.lathe(
                [(0.5, 0.08), (0.62, 0.14), (0.64, 0.7), (0.52, 1.3), (0.3, 1.6), (0.1, 1.7)],
                (0, y, 0),
                color,
                segments=16,
            )
            b.ring(0.1, 0.025, (0, y, 1.8), "charcoal", (0, 90, 0), 14, 5)
            for side in (-1, 1):
                b.cylinder(0.11, 0.06, (0.45, y + side * 0.2, 1.25), "black", turn_deg=(0, 62, 0), segments=14)
            b.panel(image, (0.65, y, 0.62), 0.66, 0.2)
            b.panel(recycle_mark(40, color, ink), (0.628, y, 0.98), 0.3, 0.3, tilt_deg=13.0)
        elif variant % 3 == 1:
            b.box((1.1, 1.24, 0.1), (0, y, 0), "charcoal", bevel=0.02)
            b.profile([(-0.55, 0.1), (0.55, 0.1), (0.55, 1.25), (0.3, 1.75), (-0.55, 1.75)], 1.22, (0, y, 0), color)
            b.box((0.06, 0.8, 0.22), (0.42, y, 1.36), "black", turn_deg=(0, -27, 0), bevel=0.01)
            b.panel(image, (0.556, y, 1.05), 1.0, 0.26)
            b.panel(recycle_mark(40, color, ink), (0.556, y, 0.6), 0.5, 0.5)
            b.box((0.1, 1.22, 0.05), (-0.1, y, 1.74), shade(color, 0.7), bevel=0.01)
        else:
            b.box((1.5, 1.3, 0.05), (0, y, 0.02), "aluminium", bevel=0.01)
            b.box((0.5, 0.55, 1.05), (0, y, 0.06), "charcoal", bevel=0.03)
            b.convex(
                [(sx * 0.3, y + sy * 0.32, 1.1) for sx in (-1, 1) for sy in (-1, 1)]
                + [(-0.3, y + s * 0.32, 1.3) for s in (-1, 1)]
                + [(0.1, y + s * 0.32, 1.3) for s in (-1, 1)],
                color,
            )
            b.cylinder(0.15, 0.05, (0.23, y, 0.85), color, turn_deg=(0, 90, 0), segments=20)
            b.cylinder(0.115, 0.02, (0.27, y, 0.85), "black", turn_deg=(0, 90, 0), segments=20)
            b.panel(image, (0.254, y, 0.5), 0.48, 0.13)
    b.box((1.9 if variant % 3 != 1 else 1.5, count * 1.35 + 0.1, 0.08), (0, 0, -0.02), "concrete")
    if variant % 3 == 0:
        for side in (-1, 1):
            b.box((1.6, 0.06, 1.4), (-0.1, side * (count * 0.675 + 0.0), 0.1), "grey wood")
        for z in np.arange(0.2, 1.5, 0.22):
            b.box((0.05, count * 1.35, 0.17), (-0.9, 0, float(z)), "grey wood")
    size = ((1.9, 4.2, 1.9), (1.5, 5.5, 1.8), (1.9, 4.15, 1.32))[variant % 3]
    return made(b, f"a recycling point of {count} containers", size, containers=count)
