"""Gear to ride on wheels, water, snow and wind: skateboards, surfboards, paddles, skis, kites. Noses look along +x."""

import numpy as np

from ....meshes import paint
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, rgb
from ....meshes.recipe import recipe
from ...shared.outlines import curve, ellipse, section
from ...shared.sizes import varied


@recipe("skateboard", 3, hulls=1, name="riding_gear.skateboard")
def skateboard(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Popsicle deck with upturned ends, long pointed cruiser, small plastic board; wheels down, nose at +x."""
    b = MeshBuilder(roughness=0.7)
    style = ("street", "long cruiser", "small plastic")[variant]
    grip, side, wheel = (
        ("black", "light wood", "off white"),
        ("charcoal", "wood", "orange"),
        ("teal", "teal", "pink"),
    )[variant]
    xs = np.linspace(-0.395, 0.395, 19)
    flip, tail = ((0.045, 0.045), (0.0, 0.0), (0.0, 0.04))[variant]
    ahead, behind = (np.clip(side * xs - 0.27, 0.0, None) / 0.125 for side in (1, -1))
    rise = flip * ahead**1.3 + tail * behind**1.3
    end = np.clip((0.395 - np.abs(xs)) / 0.1, 0, 1)
    half = 0.1 * np.sqrt(np.clip(1 - (1 - end) ** 2, 0.02, 1))
    if variant > 0:
        half = half * np.interp(xs, [-0.395, -0.1, 0.1, 0.395], [0.75, 1.0, 1.0, 0.45])
    rows = [
        np.array([(x, y, z + h) for y, h in ((-w, 0), (w, 0), (w, 0.012), (-w, 0.012))])
        for x, w, z in zip(xs, half, rise + 0.088, strict=True)
    ]
    b.loft(rows, side, crease_deg=30.0)
    top = np.array(
        [[(x, y * w * 0.99, z + 0.0128) for y in (1, -1)] for x, w, z in zip(xs, half, rise + 0.088, strict=True)]
    )
    b.sheet(top, grip)
    for x in (-0.21, 0.21):
        b.box((0.075, 0.055, 0.012), (x, 0, 0.076), "aluminium")
        b.convex(
            [
                (x + dx, dy, z)
                for dx, dy, z in (
                    (-0.03, 0.02, 0.077),
                    (0.03, 0.02, 0.077),
                    (-0.03, -0.02, 0.077),
                    (0.03, -0.02, 0.077),
                    (0, 0.05, 0.02),
                    (0, -0.05, 0.02),
                )
            ],
            "galvanised",
        )
        b.cylinder(0.009, 0.16, (x, 0.08, 0.027), "aluminium", (90, 0, 0), segments=8)
        for s in (-1, 1):
            with b.frame((x, 0.082 * s, 0.027), (90, 0, 0)):
                b.lathe([(0.022, -0.018), (0.027, -0.012), (0.027, 0.012), (0.022, 0.018)], color=wheel, segments=16)
                b.cylinder(0.01, 0.038, (0, 0, -0.019), "charcoal", segments=8)
        for dx in (-0.025, 0.025):
            for y in (-0.02, 0.02):
                b.cylinder(0.004, 0.001, (x + dx, y, 0.1008), "aluminium", segments=6)
    size = ((0.79, 0.2, 0.115), (1.0, 0.23, 0.12), (0.57, 0.155, 0.105))[variant]
    return varied(b, rng, size, f"a {style} skateboard", style)


@recipe("paddle", 3, name="riding_gear.paddle")
def paddle(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Wooden canoe paddle, yellow plastic one, double kayak paddle; lying, a blade at +x."""
    b = MeshBuilder(roughness=0.45)
    style = ("wooden canoe", "yellow canoe", "double kayak")[variant]
    shaft, blade, grip = (
        ("wood", "light wood", "wood"),
        ("aluminium", "signal yellow", "black"),
        ("charcoal", "orange", "black"),
    )[variant]

    def leaf(at: float, ahead: float) -> None:
        long = 0.5
        rows = []
        for share, w, t in (
            (0.0, 0.016, 0.015),
            (0.2, 0.055, 0.012),
            (0.5, 0.098, 0.009),
            (0.85, 0.1, 0.006),
            (0.97, 0.075, 0.005),
            (1.0, 0.03, 0.004),
        ):
            a = np.arange(12) * (2 * np.pi / 12) * ahead
            rows.append(np.stack([np.full(12, at + ahead * long * share), w * np.cos(a), t * np.sin(a)], 1))
        b.loft(rows, blade)
        b.rod((at - ahead * 0.02, 0, 0.003), (at + ahead * long * 0.6, 0, 0.006), 0.008, shaft, sides=6)

    leaf(0.22, 1.0)
    if style == "double kayak":
        leaf(-1.0, -1.0)
        b.rod((-1.02, 0, 0), (0.26, 0, 0), 0.0155, shaft, sides=10)
        for x in (-0.8, 0.02):
            b.ring(0.02, 0.008, (x, 0, 0), "black", (0, 90, 0), segments=12, sides=5)
    else:
        b.rod((-0.66, 0, 0), (0.26, 0, 0), 0.0155, shaft, sides=10)
        b.tube([(-0.68, -0.05, 0), (-0.69, 0, 0), (-0.68, 0.05, 0)], [0.013, 0.02, 0.013], grip, sides=8)
        b.rod((-0.69, 0, 0), (-0.62, 0, 0), 0.018, grip, sides=8)
    if variant == 0:
        for x in (0.5, 0.54):
            b.box((0.012, 0.19, 0.0215), (x, 0, -0.0107), "dark red")
    size = ((1.42, 0.195, 0.064), (1.3, 0.205, 0.06), (2.12, 0.18, 0.065))[variant]
    return varied(b, rng, size, f"a {style} paddle", style)


@recipe("skis", 2, name="riding_gear.skis")
def skis(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A pair of carving skis with bindings; narrow wooden ones. Side by side, tips at +x."""
    b = MeshBuilder(roughness=0.3)
    style = ("carving", "wooden")[variant]
    top, mark = (("signal red", "white"), ("wood", "dark wood"))[variant]
    for s in (-1, 1):
        with b.frame((0, 0.042 * s, 0)):
            rows, tops = [], []
            for x, w, z in (
                (-0.85, 0.02, 0.012),
                (-0.82, 0.034, 0.004),
                (-0.4, 0.031, 0.0),
                (0, 0.029, 0.004),
                (0.5, 0.033, 0.0),
                (0.7, 0.037, 0.012),
                (0.8, 0.033, 0.045),
                (0.86, 0.008, 0.085),
            ):
                w *= 1.0 if variant == 0 else 0.85
                rows.append(np.array([(x, -w, z), (x, w, z), (x, w, z + 0.012), (x, -w, z + 0.012)]))
                tops.append([(x, w * 0.5, z + 0.0127), (x, -w * 0.5, z + 0.0127)])
            b.loft(rows, top, crease_deg=30.0)
            b.sheet(np.array(tops[2:7]), mark)
            b.box((0.09, 0.055, 0.035), (0.13, 0, 0.016), "black", bevel=0.008)
            b.box((0.05, 0.06, 0.03), (0.155, 0, 0.045), "grey", bevel=0.008)
            b.box((0.1, 0.05, 0.03), (-0.18, 0, 0.016), "black", bevel=0.008)
            b.box((0.05, 0.05, 0.045), (-0.2, 0, 0.045), "grey", bevel=0.012, taper=(0.7, 0.8))
            b.rod((-0.23, 0, 0.06), (-0.3, 0, 0.085), 0.01, "black", sides=6)
            for y in (-0.04, 0.04):
                b.rod((-0.12, 0.6 * y, 0.02), (-0.17, y, 0.008), 0.004, "black", sides=5)
    size = ((1.72, 0.16, 0.112), (1.85, 0.145, 0.105))[variant]
    return varied(b, rng, size, f"a pair of {style} skis", style)


@recipe("surfboard", 3, hulls=1, name="riding_gear.surfboard")
def surfboard(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """White short board with stripes, long yellow one, blue one with a rounded nose; deck up, nose at +x."""
    b = MeshBuilder(roughness=0.2)
    style = ("white striped", "long yellow", "blue round-nosed")[variant]
    deck, stripe = (("white", "signal red"), ("signal yellow", "orange"), ("light blue", "white"))[variant]
    nose = (0.02, 0.14, 0.17)[variant]
    rows = []
    for x in np.concatenate([np.linspace(-1, 0.9, 14), [0.96, 1.0]]):
        back = np.sqrt(max(1 - ((-x - 0.72) / 0.29) ** 2, 0.0)) if x < -0.72 else 1.0
        half = (
            0.26 * (1 - 0.12 * x**2) * back
            if x < 0
            else 0.26 * np.sqrt(max(1 - x**2.2, 0)) * (1 - (0.25 - nose) * x**2)
        )
        half = max(half, 0.1 if x < -0.9 else 0.008)
        rocker = 0.05 * max(x, 0) ** 2.5 + 0.02 * max(-x, 0) ** 3
        rows.append((x, half, 0.03 * np.sqrt(max(1 - abs(x) ** 4, 0.02)), 0.13 + rocker))
    b.loft([section(x, w, t, z, 14, 2.4) for x, w, t, z in rows], deck)
    for y in (-0.06, 0.06) if variant == 0 else (0.0,):
        wide = 0.018 if variant != 1 else 0.03
        band = [
            [
                (x, y + s * wide, z + t * np.sqrt(max(1 - (abs(y) + wide) ** 2 / max(w, 0.1) ** 2, 0.05)) + 0.004)
                for s in (1, -1)
            ]
            for x, w, t, z in rows[1:13]
        ]
        b.sheet(np.array(band), stripe)
    if variant == 2:
        for k in range(3):
            _, _, t, z = rows[10]
            b.extrude(
                ellipse(0.075 - 0.022 * k, 0.075 - 0.022 * k, 20, (0.45, 0)),
                0.002 + 0.001 * k,
                (0, 0, z + t - 0.002),
                ("signal red", "white", "orange")[k],
            )
    for x, y in ((-0.82, 0.0), (-0.68, 0.13), (-0.68, -0.13)) if variant != 1 else ((-0.8, 0.0),):
        b.convex(
            [
                (x + dx, y + dy, z)
                for dy in (-0.003, 0.003)
                for dx, z in ((0.06, 0.125), (-0.05, 0.125), (-0.07, 0.0), (-0.045, 0.0))
            ],
            "charcoal",
        )
    size = ((2.05, 0.525, 0.144), (2.7, 0.57, 0.2), (1.8, 0.5, 0.13))[variant]
    return varied(b, rng, size, f"a {style} surfboard", style)


@recipe("kite", 3, name="riding_gear.kite")
def kite(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Diamond with a tail of bows, delta, box-like octopus of ribbons; upright, its face towards +x."""
    b = MeshBuilder(roughness=0.8)
    style = ("diamond", "delta", "round with ribbons")[variant]
    inks: tuple[Color, ...] = (
        ("signal red", "signal yellow", "signal blue", "green"),
        ("purple", "teal", "orange", "lime"),
        ("orange", "signal yellow", "pink", "light blue"),
    )[variant]
    if style == "round with ribbons":
        image, pen = paint.canvas((96, 96), inks[1])
        for k in range(12):
            pen.pieslice((0, 0, 95, 95), 30 * k, 30 * k + 15, fill=rgb(inks[0]))
        pen.ellipse((22, 22, 74, 74), fill=rgb(inks[1]))
        for x in (36, 60):
            pen.ellipse((x - 6, 34, x + 6, 50), fill=(20, 20, 20))
        pen.arc((32, 40, 64, 66), 20, 160, fill=(20, 20, 20), width=4)
        disc = [(y, z) for y, z in ellipse(0.34, 0.34, 28)]
        b.plate(disc, 0.01, (0.05, 0, 0.75), image, inks[0], both_faces=True)
        for k in range(7):
            y = -0.24 + 0.08 * k
            path = curve(
                [(0.05, y, 0.5), (0.03, y * 1.1, 0.3), (0.08, y * 1.2, 0.12), (0.02 + 0.01 * k, y * 1.3, 0.0)], 3
            )
            b.sheet(np.stack([path + [0, 0.02, 0], path - [0, 0.02, 0]], 1), inks[k % 4], both_sides=True)
    else:
        top, low = np.array([0.03, 0, 0.95]), np.array([0.0, 0, 0.0 if variant else 0.18])
        sides = [np.array([-0.03, s * 0.5, 0.66 if variant == 0 else 0.12]) for s in (-1, 1)]
        mid = np.array([0.06, 0, sides[0][2] if variant == 0 else 0.2])
        quarters = [(sides[0], mid, top), (mid, sides[1], top), (low, sides[1], mid), (low, mid, sides[0])]
        for k, (p, q, r) in enumerate(quarters):
            face = np.array([[p, q], [r, r]]) if k < 2 else np.array([[p, q], [p, r]])
            b.sheet(face, inks[k], both_sides=True)
        b.tube([top, mid, low], 0.006, "light wood", sides=5)
        b.tube([sides[0], mid - [0.02, 0, 0], sides[1]], 0.005, "light wood", sides=5)
        for end in (top, low, *sides):
            b.ball(0.012, end, "charcoal", segments=6, rings=4)
        b.tube([top - [0, 0, 0.2], mid + [0.08, 0, -0.05], low + [0, 0, 0.1]], 0.0015, "white", sides=3)
        count, span = (5, 0.2) if variant == 0 else (0, 0.0)
        tail = curve([low, low + [0.02, 0.05, -0.06], low + [0, -0.04, -0.12], low + [0.01, 0.03, -span]], 4)
        if count:
            b.tube(tail, 0.003, "white", sides=4)
            for k in range(count):
                at = tail[2 + 2 * k]
                for s in (-1, 1):
                    b.convex(
                        [at, at + [0.004, 0, 0], at + [0.002, 0.045 * s, 0.02], at + [0.002, 0.045 * s, -0.02]],
                        inks[k % 4],
                    )
        else:
            for k in range(5):
                y = -0.3 + 0.15 * k
                z = 0.16 if abs(y) > 0.01 else 0.02
                ribbon = curve([(0, y, z), (0.03, y, z - 0.06), (-0.02, y, z - 0.16), (0.02, y, z - 0.3)], 3)
                b.sheet(np.stack([ribbon + [0, 0.014, 0], ribbon - [0, 0.014, 0]], 1), inks[k % 4], both_sides=True)
    size = ((0.122, 1.0, 0.96), (0.14, 1.5, 1.2), (0.1, 0.75, 1.15))[variant]
    return varied(b, rng, size, f"a {style} kite", style)
