"""Machines and weights of gyms and gardens; the user faces +x."""

import numpy as np
from PIL import Image

from ....meshes import paint
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, rgb, shade
from ....meshes.recipe import recipe
from ...shared.outlines import curve, rounded
from ...shared.sizes import varied


def disc(b: MeshBuilder, y: float, z: float, radius: float, thick: float, color: Color, segments: int = 16) -> None:
    """A weight on a bar along y, its middle at (0, y, z)."""
    with b.frame((0, y, z), (90, 0, 0)):
        rim = [(radius * 0.94, -thick / 2), (radius, -thick * 0.35), (radius, thick * 0.35), (radius * 0.94, thick / 2)]
        b.lathe(rim, color=color, segments=segments)
        for side in (-1, 1):
            b.ring(radius * 0.8, thick * 0.12, (0, 0, side * thick / 2), shade(color, 1.35), segments=segments, sides=3)
        b.cylinder(radius * 0.2, thick * 1.16, (0, 0, -thick * 0.58), "aluminium", segments=8)


@recipe("barbell", 2, name="gym.barbell")
def barbell(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Long bar with coloured discs; short bar with small iron ones. It lies on its discs, the bar along y."""
    b = MeshBuilder(roughness=0.45)
    style = ("coloured discs", "iron discs")[variant]
    half, plates = (
        (1.05, [(0.21, 0.05, "signal red"), (0.21, 0.045, "signal blue"), (0.16, 0.03, "signal yellow")]),
        (0.75, [(0.15, 0.04, "charcoal"), (0.12, 0.035, "charcoal"), (0.09, 0.03, "charcoal")]),
    )[variant]
    z = plates[0][0]
    b.rod((0, -half, z), (0, half, z), 0.014, "aluminium", sides=10)
    for s in (-1, 1):
        b.rod((0, s * half * 0.62, z), (0, s * half, z), 0.025, "light grey", sides=12)
        b.cylinder(0.036, 0.03, (0, s * half * 0.62, z), "grey", (90 * s, 0, 0), segments=14)
        y = half * 0.62 + 0.03
        for radius, thick, color in plates:
            disc(b, s * (y + thick / 2), z, radius, thick, color)
            y += thick * 1.12
        b.cylinder(0.04, 0.04, (0, s * (y + 0.01), z), "black", (-90 * s, 0, 0), segments=12)
        b.rod((0, s * 0.12, z), (0, s * 0.55 * half, z), 0.0148, "grey", sides=10)
    size = ((0.42, 2.1, 0.42), (0.3, 1.5, 0.3))[variant]
    return varied(b, rng, size, f"a barbell with {style}", style, jitter=0.0)


@recipe("dumbbell", 3, name="gym.dumbbell")
def dumbbell(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Six-sided rubber heads, iron discs, small vinyl ones; the handle along y."""
    b = MeshBuilder(roughness=0.5)
    style = ("six-sided", "iron disc", "vinyl")[variant]
    color: Color = ("charcoal", "dark grey", "teal")[variant]
    b.rod((0, -0.12, 0.07), (0, 0.12, 0.07), 0.015, "aluminium" if variant < 2 else color, sides=12)
    for s in (-1, 1):
        if style == "iron disc":
            disc(b, 0.085 * s, 0.07, 0.07, 0.028, color, 12)
            disc(b, 0.115 * s, 0.07, 0.055, 0.024, "signal red", 12)
            b.cylinder(0.024, 0.02, (0, 0.128 * s, 0.07), "aluminium", (-90 * s, 0, 0), segments=6)
            b.rod((0, 0.12 * s, 0.07), (0, 0.155 * s, 0.07), 0.014, "aluminium", sides=10)
        else:
            with b.frame((0, 0.065 * s, 0.07), (-90 * s, 0, 0)):
                head = [(0.055, 0.0), (0.07, 0.012), (0.07, 0.07), (0.055, 0.085)]
                b.lathe(head, color=color, turn_deg=(0, 0, 0), segments=6, crease_deg=20)
                b.cylinder(0.04, 0.002, (0, 0, 0.0855), shade(color, 1.5), segments=16)
                mark, pen = paint.canvas((32, 32), shade(color, 1.5))
                paint.text(pen, ("10", "", "3")[variant], (4, 6, 28, 26), "white", 0.04)
            b.panel(mark, (0, s * 0.1535, 0.07), 0.045, 0.045, "+y" if s > 0 else "-y")
    for k in range(9):
        b.ring(
            0.0155,
            0.0016,
            (0, -0.045 + 0.011 * k, 0.07),
            "grey" if variant < 2 else shade(color, 0.8),
            (90, 0, 0),
            segments=10,
            sides=3,
        )
    size = ((0.142, 0.3, 0.142), (0.17, 0.37, 0.17), (0.095, 0.2, 0.095))[variant]
    return varied(b, rng, size, f"a {style} dumbbell", style, jitter=0.0)


@recipe("punching bag", 3, hulls=1, name="gym.punching_bag")
def punching_bag(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Black bag on chains, red one with a white band, brown leather one; hung from their ring above."""
    b = MeshBuilder(roughness=0.55)
    style = ("black", "red banded", "brown leather")[variant]
    skin, band = (("charcoal", "signal red"), ("signal red", "white"), ("#6b3d22", "#8c5a38"))[variant]
    r, long = 0.17, 0.86
    b.lathe(
        [(r * 0.86, 0.0), (r * 0.98, 0.02), (r, 0.05), (r, long - 0.05), (r * 0.97, long - 0.01), (r * 0.85, long)],
        color=skin,
        segments=22,
    )
    for z in (0.1, long - 0.16):
        b.cylinder(r + 0.0025, 0.07, (0, 0, z), band, segments=22)
    for z in (0.3, 0.52):
        b.ring(r - 0.001, 0.0035, (0, 0, z), shade(skin, 0.7), segments=22, sides=4)
    b.box((0.02, 0.014, long * 0.86), (0, r - 0.002, 0.06), shade(skin, 0.7))
    b.panel(_fist(skin, band), (r + 0.003, 0, 0.44), 0.13, 0.13)
    for k in range(4):
        a = np.pi / 4 + np.pi / 2 * k
        foot = np.array([0.9 * r * np.cos(a), 0.9 * r * np.sin(a), long - 0.01])
        b.ring(0.014, 0.004, foot, "aluminium", (90, 0, 45 + 90 * k), segments=10, sides=4)
        tip = np.array([0, 0, long + 0.22])
        for j in range(7):
            at = foot + (tip - foot) * (j + 0.6) / 7
            b.beam(
                at - 0.06 * (tip - foot),
                at + 0.06 * (tip - foot),
                0.006 + 0.008 * (j % 2),
                0.014 - 0.008 * (j % 2),
                "aluminium",
            )
    b.ring(0.022, 0.005, (0, 0, long + 0.235), "galvanised", (90, 0, 0), segments=14, sides=5)
    size = ((0.36, 0.36, 1.16), (0.4, 0.4, 1.4), (0.33, 0.33, 0.95))[variant]
    return varied(b, rng, size, f"a {style} punching bag", style)


def _fist(ground: Color, ink: Color) -> Image.Image:
    image, pen = paint.canvas((48, 48), ground)
    pen.ellipse((3, 3, 45, 45), outline=rgb(ink), width=3)
    paint.text(pen, "BOX", (8, 14, 40, 34), ink, 0.06)
    return image


@recipe("training bench", 3, name="gym.training_bench")
def training_bench(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Bench with an upright back, flat bench with a rack and bar, inclined board."""
    b = MeshBuilder(roughness=0.5)
    style = ("adjustable", "press bench", "sit-up board")[variant]
    steel, pad = (("black", "charcoal"), ("signal red", "black"), ("aluminium", "dark blue"))[variant]
    if style == "sit-up board":
        with b.frame((-0.1, 0, 0.42), (0, -20, 0)):
            b.extrude(rounded(1.05, 0.3, 0.05), 0.06, (-0.05, 0, 0), pad)
            b.beam((-0.55, 0, -0.03), (0.55, 0, -0.03), 0.06, 0.05, steel)
        for z, x in ((0.86, 0.42), (0.66, 0.56)):
            b.cylinder(0.05, 0.4, (x, 0.2, z), "black", (90, 0, 0), segments=14)
        b.beam((0.4, 0, 0.0), (0.42, 0, 0.9), 0.05, 0.05, steel)
        for x, y in ((0.4, 0.25), (-0.55, 0.2)):
            b.beam((x, -y, 0.025), (x, y, 0.025), 0.05, 0.05, steel)
        b.beam((-0.55, 0, 0.03), (-0.52, 0, 0.25), 0.05, 0.05, steel)
    else:
        flat = style == "press bench"
        back = 2.0 if flat else 42.0
        b.extrude(rounded(0.38 if not flat else 0.45, 0.3, 0.04), 0.06, (0.22, 0, 0.42), pad)
        with b.frame((0.02, 0, 0.42), (0, back, 0)):
            b.extrude(rounded(0.72, 0.28, 0.04), 0.06, (-0.37, 0, 0), pad)
            b.beam((-0.66, 0, -0.02), (-0.02, 0, -0.02), 0.05, 0.04, steel)
        b.beam((-0.58, 0, 0.2), (0.5, 0, 0.36), 0.06, 0.06, steel)
        b.beam((0.48, 0, 0.0), (0.42, 0, 0.42), 0.06, 0.06, steel)
        b.beam((-0.58, 0, 0.02), (-0.56, 0, 0.36), 0.06, 0.06, steel)
        for x, y in ((0.48, 0.22), (-0.58, 0.26)):
            b.beam((x, -y, 0.025), (x, y, 0.025), 0.05, 0.05, steel)
            for s in (-1, 1):
                b.box((0.06, 0.03, 0.06), (x, s * y, 0), "black", bevel=0.006)
        if flat:
            for s in (-1, 1):
                b.beam((-0.5, s * 0.45, 0.0), (-0.5, s * 0.45, 1.02), 0.06, 0.06, steel)
                b.beam((-0.7, s * 0.45, 0.025), (-0.2, s * 0.45, 0.025), 0.05, 0.05, steel)
                b.box((0.1, 0.05, 0.03), (-0.46, s * 0.45, 1.0), steel)
                b.box((0.02, 0.05, 0.07), (-0.42, s * 0.45, 1.0), steel)
                with b.frame((-0.46, 0, 0)):
                    disc(b, s * 0.54, 1.05, 0.17, 0.05, "charcoal", 16)
            b.beam((-0.5, -0.45, 0.3), (-0.5, 0.45, 0.3), 0.05, 0.05, steel)
            b.rod((-0.46, -0.6, 1.05), (-0.46, 0.6, 1.05), 0.014, "aluminium")
        else:
            b.beam((-0.3, 0, 0.3), (-0.28, 0, 0.6), 0.03, 0.03, "aluminium")
    size = ((1.28, 0.55, 0.8), (1.3, 1.18, 1.2), (1.45, 0.52, 0.9))[variant]
    return varied(b, rng, size, f"a training bench: {style}", style)


@recipe("treadmill", 2, name="gym.treadmill")
def treadmill(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Home treadmill, gym treadmill with long rails; the runner looks along +x at its screen."""
    b = MeshBuilder(roughness=0.5)
    style = ("home", "gym")[variant]
    frame, trim = (("charcoal", "signal red"), ("light grey", "black"))[variant]
    b.box((1.5, 0.46, 0.05), (-0.05, 0, 0.1), "black")
    b.box((1.42, 0.44, 0.006), (-0.07, 0, 0.15), "dark grey")
    for s in (-1, 1):
        b.box((1.56, 0.13, 0.07), (-0.05, 0.3 * s, 0.1), frame, bevel=0.015)
        b.beam((0.66, 0.36 * s, 0.1), (0.5, 0.36 * s, 1.14), 0.06, 0.09, frame, bevel=0.01)
        rail = curve(
            [(0.5, 0.36 * s, 1.08), (0.3, 0.36 * s, 1.02), (0.05 if variant == 0 else -0.15, 0.36 * s, 0.92)], 3
        )
        b.tube(rail, 0.024, "black", sides=8)
        b.box((0.1, 0.05, 0.1), (-0.75, 0.3 * s, 0.0), "black", bevel=0.01)
        b.box((0.12, 0.05, 0.1), (0.55, 0.3 * s, 0.0), "black", bevel=0.01)
    b.box((0.34, 0.66, 0.16), (0.66, 0, 0.1), frame, bevel=0.05)
    b.box((0.2, 0.5, 0.01), (0.66, 0, 0.26), trim)
    screen, pen = paint.canvas((96, 44), "#101820")
    paint.text(pen, "9.5", (4, 4, 44, 28), "light green")
    pen.line([(50 + 4 * k, 30 - 8 * np.sin(k / 1.7) - k) for k in range(11)], fill=rgb("light blue"), width=2)
    paint.text(pen, "12:40  3.2 km", (4, 30, 92, 42), "amber")
    with b.frame((0.5, 0, 1.1), (0, -35, 0)):
        b.box((0.06, 0.74, 0.24), color=trim if variant == 0 else "charcoal", bevel=0.015)
        b.panel(screen, (-0.0325, 0, 0.14), 0.42, 0.17, "-x")
        b.box((0.01, 0.09, 0.03), (-0.032, 0, 0.015), "signal red")
    b.rod((0.45, -0.36, 1.06), (0.45, 0.36, 1.06), 0.022, "black", sides=8)
    size = ((1.68, 0.8, 1.35), (1.95, 0.9, 1.5))[variant]
    return varied(b, rng, size, f"a {style} treadmill", style)


@recipe("indoor rower", 2, name="gym.indoor_rower")
def indoor_rower(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Air rower with its fan cage, wooden water rower; the flywheel at +x, a seat on the rail."""
    b = MeshBuilder(roughness=0.45)
    style = ("air", "wooden water")[variant]
    if style == "air":
        b.beam((-1.2, 0, 0.32), (0.85, 0, 0.24), 0.05, 0.1, "light grey")
        b.cylinder(0.27, 0.12, (0.86, 0.06, 0.33), "charcoal", (90, 0, 0), segments=26)
        for s in (-1, 1):
            for share in (0.9, 0.65, 0.4):
                b.ring(0.27 * share, 0.008, (0.86, 0.062 * s, 0.33), "black", (90, 0, 0), segments=22, sides=4)
        b.tube([(0.86, 0, 0.55), (0.78, 0, 0.8), (0.5, 0, 0.95)], 0.022, "charcoal", sides=8)
        screen_at = (0.47, 0, 0.9)
        legs = ((-1.15, 0.2), (0.95, 0.28))
        steel: Color = "black"
    else:
        for s in (-1, 1):
            b.beam((-1.2, 0.1 * s, 0.3), (1.1, 0.1 * s, 0.22), 0.03, 0.1, "wood")
        b.lathe([(0.2, 0.0), (0.26, 0.03), (0.26, 0.15), (0.2, 0.18)], (0.8, 0, 0.28), "water", segments=24)
        b.cylinder(0.06, 0.24, (0.8, 0, 0.26), "dark wood", segments=12)
        b.beam((0.55, 0, 0.3), (0.5, 0, 0.62), 0.2, 0.04, "wood")
        screen_at = (0.48, 0, 0.6)
        legs = ((-1.15, 0.2), (1.0, 0.26))
        steel = "wood"
    for x, y in legs:
        b.beam((x, -y, 0.03), (x, y, 0.03), 0.07, 0.06, steel)
        b.beam((x, 0, 0.03), (x, 0, 0.28), 0.05, 0.05, steel)
    b.box((0.3, 0.26, 0.05), (-0.55, 0, 0.38), "black", bevel=0.02)
    b.box((0.14, 0.1, 0.08), (-0.55, 0, 0.31), "dark grey")
    for s in (-1, 1):
        with b.frame((0.42, 0.14 * s, 0.3), (0, 42, 0)):
            b.box((0.3, 0.12, 0.03), color="charcoal", bevel=0.01)
            b.box((0.05, 0.13, 0.05), (0.02, 0, 0.02), "grey")
    b.rod((0.32, -0.24, 0.52), (0.32, 0.24, 0.52), 0.016, "wood" if variant else "black", sides=8)
    b.rod((0.32, 0, 0.52), (0.7, 0, 0.45), 0.005, "grey", sides=4)
    screen, pen = paint.canvas((40, 40), "#8ea484")
    paint.text(pen, "2:05", (4, 4, 36, 20), "black")
    paint.text(pen, "24 s/m", (4, 24, 36, 36), "black")
    b.box((0.04, 0.2, 0.2), screen_at, "charcoal", bevel=0.01)
    b.panel(screen, (screen_at[0] - 0.022, 0, screen_at[2] + 0.1), 0.15, 0.15, "-x")
    size = ((2.4, 0.58, 0.97), (2.15, 0.54, 0.75))[variant]
    return varied(b, rng, size, f"an {style} rower" if variant == 0 else f"a {style} rower", style)
