"""Bins, bags, boxes and parcels."""

import numpy as np
from PIL import Image

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, rgb, shade
from ...meshes.recipe import Physics, recipe

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


BAG = Physics(("plastic",), 110.0, (3.0, 16.0), 0.6, True, "a full household bag of 40-100 l weighs 4-15 kg")


@recipe("garbage bag", 4, BAG, hulls=3, name="waste.garbage_bag")
def garbage_bag(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """One bag, or a heap of two or three, knotted at the top."""
    b = MeshBuilder(roughness=0.35)
    count, color = ((1, "black"), (3, "black"), (2, "light blue"), (1, "light grey"))[variant % 4]
    places = [(0.0, 0.0), (0.38, 0.24), (0.05, 0.46)][:count]
    for x, y in places:
        r, h = rng.uniform(0.23, 0.29), rng.uniform(0.42, 0.55)
        rows = []
        for z, s in (
            (0.0, 0.7),
            (0.05, 0.95),
            (0.4, 1.0),
            (0.65, 0.85),
            (0.82, 0.5),
            (0.9, 0.16),
            (0.94, 0.1),
            (1.0, 0.2),
        ):
            angle = np.arange(12) * np.pi / 6
            wobble = 1 + rng.uniform(-0.09, 0.09, 12) * (s > 0.3)
            rows.append(
                np.column_stack(
                    [x + r * s * wobble * np.cos(angle), y + r * s * wobble * np.sin(angle), np.full(12, h * z)]
                )
            )
        b.loft(rows, shade(color, float(rng.uniform(0.9, 1.15))), crease_deg=28.0)
        b.cylinder(0.03, 0.03, (x, y, h * 0.9), "red" if color == "light grey" else shade(color, 1.5), segments=8)
    return b.build(f"{count} {color} garbage bag{'s' if count > 1 else ''}", {"count": count, "color": color})


CRATE = Physics(
    ("wood", "plastic"), 160.0, (1.5, 40.0), 0.5, True, "empty crates weigh 1.5-12 kg; grit boxes are heavier"
)


@recipe("storage box", 4, CRATE, hulls=2, name="waste.storage_box")
def storage_box(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Wooden crate, stacked plastic crates, steel-cornered chest, yellow grit box."""
    b = MeshBuilder(roughness=0.75)
    style = ("wooden crate", "plastic crates", "chest", "grit box")[variant % 4]
    if style == "wooden crate":
        _wooden_crate(b, rng)
    elif style == "plastic crates":
        _plastic_crates(b, rng)
    elif style == "chest":
        _chest(b)
    else:
        _grit_box(b)
    return b.build(f"a {style}", {"style": style})


def _wooden_crate(b: MeshBuilder, rng: np.random.Generator) -> None:
    """Slats around a box, on battens."""
    x, y, z = (float(v) for v in rng.uniform((0.4, 0.55, 0.35), (0.5, 0.7, 0.45)))
    b.box((x - 0.03, y - 0.03, z - 0.02), color="dark wood")
    for k in range(3):
        at = z * (k + 0.5) / 3
        for s in (-1, 1):
            b.box((0.018, y, z / 3 - 0.02), (s * (x / 2 - 0.009), 0, at), "light wood", centered=True)
            b.box((x, 0.018, z / 3 - 0.02), (0, s * (y / 2 - 0.009), at), "light wood", centered=True)
    for sx in (-1, 1):
        for sy in (-1, 1):
            b.box((0.05, 0.05, z), (sx * (x / 2 - 0.02), sy * (y / 2 - 0.02), 0), "wood")
    for k in range(4):
        b.box((x / 4 - 0.015, y, 0.02), (-x / 2 + x * (k + 0.5) / 4, 0, z - 0.015), "light wood")


def _plastic_crates(b: MeshBuilder, rng: np.random.Generator) -> None:
    """Two or three crates, one on the other."""
    for k, color in enumerate(("red", "blue", "signal yellow")[: int(rng.integers(2, 4))]):
        with b.frame((0, 0, 0.3 * k), (0, 0, float(rng.uniform(-6, 6)))):
            b.box((0.36, 0.5, 0.28), color=color, taper=(1.04, 1.03))
            b.box((0.4, 0.54, 0.03), (0, 0, 0.265), shade(color, 0.85))
            for z in (0.06, 0.13):
                b.box((0.381, 0.4, 0.03), (0, 0, z), shade(color, 0.6))
                b.box((0.3, 0.521, 0.03), (0, 0, z), shade(color, 0.6))
            b.box((0.405, 0.12, 0.035), (0, 0, 0.2), "black")


def _chest(b: MeshBuilder) -> None:
    """A chest with a lid and two locks."""
    b.box((0.5, 0.9, 0.42), color="dark green", bevel=0.015)
    b.box((0.53, 0.93, 0.1), (0, 0, 0.4), shade("dark green", 1.25), bevel=0.02)
    for y in (-0.3, 0.3):
        b.box((0.02, 0.06, 0.12), (0.26, y, 0.34), "galvanised")
    for y in (-0.43, 0.43):
        b.box((0.52, 0.05, 0.06), (0, y, 0.0), "black")


def _grit_box(b: MeshBuilder) -> None:
    """A lettered box under a sloping lid."""
    b.box((0.55, 0.9, 0.5), color="signal yellow", taper=(1.1, 1.08), bevel=0.02)
    roof = [(-0.34, 0), (0.34, 0), (0.32, 0.08), (-0.25, 0.2), (-0.34, 0.18)]
    b.profile(roof, 1.02, (0, 0, 0.5), "signal yellow")
    image, draw = paint.canvas((64, 32), "signal yellow")
    paint.text(draw, "GRIT", (4, 3, 60, 29), "black", bold=0.05)
    b.panel(image, (0.295, 0, 0.28), 0.4, 0.2, tilt_deg=-3)


PARCEL = Physics(("cardboard",), 140.0, (0.5, 25.0), 0.5, True, "cardboard parcels of 5-100 l weigh 0.5-20 kg")


@recipe("parcels", 4, PARCEL, hulls=3, name="waste.parcels")
def parcels(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """One box or a small stack, taped and labelled."""
    b = MeshBuilder(roughness=0.9)
    label, draw = paint.canvas((40, 28), "white")
    draw.rectangle((3, 3, 22, 5), fill=(60, 60, 60))
    draw.rectangle((3, 8, 18, 10), fill=(120, 120, 120))
    for k in range(14):
        draw.rectangle((4 + 2 * k + (k % 3), 15, 4 + 2 * k + (k % 3) + k % 2, 24), fill=(20, 20, 20))
    count = (1, 2, 3, 4)[variant % 4]
    level, top = 0.0, (0.6, 0.7)
    for k in range(count):
        size = rng.uniform((0.26, 0.34, 0.18), (0.42, 0.5, 0.36)) * (1.15 if k == 0 else 0.95)
        beside = k == 3
        place = (0.05, top[1] / 2 + size[1] / 2 + 0.06, 0.0) if beside else (0.0, 0.0, level)
        color = shade("cardboard", float(rng.uniform(0.85, 1.12)))
        with b.frame(place, (0, 0, float(rng.uniform(-12, 12)))):
            b.box(size, color=color)
            b.box((0.05, size[1] + 0.004, size[2] + 0.002), color="beige")
            b.panel(label, (size[0] / 2 + 0.003, size[1] * 0.12, size[2] * 0.55), 0.14, 0.1)
        if not beside:
            level, top = level + float(size[2]), (float(size[0]), float(size[1]))
            if k == 0:
                top = (float(size[0]), float(size[1]) * 1.1)
    return b.build(f"{count} cardboard parcel{'s' if count > 1 else ''}", {"count": count})
