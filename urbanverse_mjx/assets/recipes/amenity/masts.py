"""Slender objects of the street: poles, cameras, horizontal bars, lamps."""

import itertools

import numpy as np

from ...meshes import shapes
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color
from ...meshes.recipe import recipe
from ..shared.outlines import arc, pairs
from ..shared.sizes import made


@recipe("pole", 3, name="masts.pole")
def pole(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A galvanised tube on a bolted flange, a wooden post with bands, a painted one with rings and a ball on top."""
    b = MeshBuilder(roughness=0.6)
    style = ("galvanised", "wooden", "painted")[variant % 3]
    if style == "galvanised":
        b.cylinder(0.055, 0.02, color="dark grey", segments=24)
        for k in range(4):
            with b.frame(turn_deg=(0, 0, 45 + 90 * k)):
                b.cylinder(0.006, 0.025, (0.046, 0, 0.015), "black", segments=6)
        b.lathe([(0.04, 0.02), (0.036, 0.06), (0.034, 3.46)], color="galvanised", segments=24)
        b.lathe([(0.037, 3.46), (0.037, 3.49), (0.02, 3.5)], color="black", segments=24)
        b.box((0.012, 0.04, 0.16), (0.031, 0, 0.7), "dark grey", bevel=0.004)
        size = (0.11, 0.11, 3.5)
    elif style == "wooden":
        z = np.linspace(0, 6.2, 12)
        lean = 0.02 * np.sin(0.9 * z + float(rng.uniform(0, 3)))
        b.tube(np.column_stack([lean, lean[::-1], z]), list(np.linspace(0.13, 0.09, 12)), "bark", sides=16)
        for level in (1.5, 2.1):
            b.cylinder(0.125, 0.06, (0, 0, level), "galvanised", segments=16)
        b.cone(0.095, 0.1, (lean[-1], lean[0], 6.2), "dark grey")
        size = (0.26, 0.26, 6.3)
    else:
        b.lathe([(0.1, 0), (0.1, 0.1), (0.07, 0.16), (0.06, 0.5), (0.05, 0.56), (0.04, 2.6)], color="dark green")
        for level in (0.5, 1.2, 2.55):
            b.ring(0.048, 0.014, (0, 0, level), "gold", segments=16, sides=6)
        b.ball(0.07, (0, 0, 2.66), "gold", segments=16)
        size = (0.2, 0.2, 2.7)
    return made(b, f"a {style} pole", size, style=style)


@recipe("surveillance camera", 3, name="masts.surveillance_camera")
def surveillance_camera(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A bullet camera under its shade, a dome on a wall arm, a box camera in a housing; they look along +x."""
    b = MeshBuilder(roughness=0.4)
    style = ("bullet", "dome", "housing")[variant % 3]
    if style == "bullet":
        b.cylinder(0.045, 0.012, (-0.115, 0, 0.045), "white", turn_deg=(0, 90, 0))
        b.tube([(-0.105, 0, 0.045), (-0.07, 0, 0.03), (-0.045, 0, 0.05)], 0.014, "white")
        with b.frame((-0.06, 0, 0.06), (0, 94, 0)):
            b.lathe([(0.03, 0), (0.036, 0.008), (0.036, 0.13), (0.032, 0.145)], color="white", segments=20)
            b.cylinder(0.029, 0.004, (0, 0, 0.144), "black", segments=20)
            b.ball(0.016, (0, 0, 0.146), "dark glass", segments=14)
            for k in range(6):
                a = np.pi * k / 3
                b.cylinder(0.0035, 0.003, (0.023 * np.cos(a), 0.023 * np.sin(a), 0.147), "light red", segments=6)
        hood = pairs(arc(0.042, 10, 170, 11)) + pairs(arc(0.046, 170, 10, 11))
        b.extrude(hood, 0.19, (-0.07, 0, 0.062), "off white", turn_deg=(90, 0, 90))
        size = (0.22, 0.1, 0.11)
    elif style == "dome":
        b.box((0.02, 0.11, 0.14), (-0.16, 0, 0.06), "light grey", bevel=0.006)
        b.tube([(-0.15, 0, 0.15), (-0.04, 0, 0.17), (0.03, 0, 0.15), (0.04, 0, 0.1)], 0.018, "light grey", sides=12)
        b.lathe([(0.07, 0.02), (0.076, 0.03), (0.072, 0.07), (0.03, 0.1)], (0.04, 0, 0.02), "white", segments=24)
        b.lathe(
            [(0.0, -0.068), (0.035, -0.056), (0.055, -0.03), (0.062, 0.02)], (0.04, 0, 0.02), "dark glass", segments=24
        )
        b.ball(0.02, (0.075, 0, -0.01), "black", segments=12)
        size = (0.3, 0.17, 0.23)
    else:
        b.box((0.3, 0.1, 0.09), (0.02, 0, 0.1), "light grey", bevel=0.008)
        b.convex(
            [
                (x, y, z)
                for x, y, z in [(-0.14, s * 0.06, 0.19) for s in (-1, 1)]
                + [(0.23, s * 0.06, 0.19) for s in (-1, 1)]
                + [(-0.12, s * 0.05, 0.21) for s in (-1, 1)]
                + [(0.21, s * 0.05, 0.21) for s in (-1, 1)]
            ],
            "white",
        )
        b.box((0.006, 0.08, 0.07), (0.17, 0, 0.11), "dark glass")
        b.cylinder(0.025, 0.01, (0.172, 0, 0.145), "black", turn_deg=(0, 90, 0), segments=18)
        b.ring(0.026, 0.004, (0.182, 0, 0.145), "light grey", (0, 90, 0), 18, 5)
        b.box((0.06, 0.07, 0.05), (0, 0, 0.05), "dark grey", bevel=0.01)
        b.beam((0, 0, 0.05), (-0.18, 0, 0.0), 0.04, 0.03, "dark grey", bevel=0.006)
        b.box((0.015, 0.09, 0.1), (-0.19, 0, -0.05), "dark grey", bevel=0.004)
        b.tube([(-0.13, 0.02, 0.14), (-0.19, 0.03, 0.1), (-0.18, 0.02, 0.03)], 0.008, "black", sides=6)
        size = (0.4, 0.12, 0.24)
    return made(b, f"a {style} surveillance camera", size, style=style)


@recipe("horizontal bar", 3, name="masts.horizontal_bar")
def horizontal_bar(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A steel frame, wooden posts with two heights, a low bent hoop with stay feet; the bar lies along y."""
    b = MeshBuilder(roughness=0.5)
    if variant % 3 == 0:
        for y in (-1.08, 1.08):
            b.cylinder(0.045, 2.1, (0, y, 0), "signal blue", segments=18)
            b.lathe([(0.05, 0), (0.05, 0.02), (0.046, 0.05)], (0, y, 0), "charcoal", segments=18)
            b.ball(0.047, (0, y, 2.1), "charcoal", segments=14, rings=6)
            b.ball(0.05, (0, y, 1.98), "charcoal", segments=12, rings=6)
        b.rod((0, -1.08, 1.98), (0, 1.08, 1.98), 0.017, "aluminium", sides=12)
        return made(b, "a steel horizontal bar", (0.1, 2.2, 2.1), bars=1)
    if variant % 3 == 1:
        for y, top in ((-1.3, 1.75), (0.0, 2.3), (1.3, 2.3)):
            b.box((0.12, 0.12, top), (0, y, 0), "light wood", bevel=0.015)
            b.box((0.16, 0.16, 0.1), (0, y, 0), "galvanised", bevel=0.01)
            b.convex(
                [(sx * 0.06, y + sy * 0.06, top) for sx in (-1, 1) for sy in (-1, 1)] + [(0, y, top + 0.06)], "wood"
            )
        for y0, y1, z in ((-1.3, 0.0, 1.6), (0.0, 1.3, 2.15)):
            b.rod((0, y0, z), (0, y1, z), 0.018, "aluminium", sides=12)
            for y in (y0 + 0.07, y1 - 0.07):
                b.cylinder(0.035, 0.02, (0, y - 0.01, z), "charcoal", turn_deg=(-90, 0, 0), segments=12)
        return made(b, "a horizontal bar of two heights on wooden posts", (0.16, 2.7, 2.35), bars=2)
    bend = [(0, -0.85, 0.03), (0, -0.85, 1.25), (0, -0.8, 1.38), (0, -0.68, 1.43)]
    b.tube([*bend, *[(0, -y, z) for _, y, z in reversed(bend)]], 0.025, "safety orange", sides=12)
    for y in (-0.85, 0.85):
        b.box((0.5, 0.08, 0.03), (0, y, 0), "charcoal", bevel=0.008)
        for side in (-1, 1):
            b.rod((side * 0.22, y, 0.03), (0, y, 0.6), 0.014, "safety orange", sides=8)
        b.ring(0.03, 0.006, (0, y * 0.55, 1.43), "black", (90, 0, 0), 12, 5)
    return made(b, "a low hoop to swing on", (0.5, 1.8, 1.45), bars=1)


def _shade(b: MeshBuilder, z: float, low: float, high: float, height: float, color: Color) -> None:
    """An open lamp shade with its bulb."""
    b.lathe(
        [(low, z), (high, z + height), (high - 0.004, z + height), (low - 0.006, z + 0.003)], color=color, segments=24
    )
    b.ball(0.03, (0, 0, z + height * 0.45), "lamp", segments=10, rings=6)
    for radius, level in ((low, z), (high, z + height)):
        b.ring(radius, 0.004, (0, 0, level), "charcoal", segments=24, sides=4)


@recipe("lamp", 3, name="masts.lamp")
def lamp(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A table lamp with a ceramic foot, a floor lamp on a tripod, a jointed desk lamp."""
    b = MeshBuilder(roughness=0.5)
    style = ("table", "floor", "desk")[variant % 3]
    if style == "table":
        foot = [(0.07, 0), (0.075, 0.015), (0.05, 0.03), (0.085, 0.12), (0.075, 0.2), (0.03, 0.26), (0.02, 0.28)]
        b.lathe(foot, color="teal", segments=22)
        b.cylinder(0.008, 0.2, (0, 0, 0.27), "brass", segments=8)
        _shade(b, 0.29, 0.14, 0.09, 0.21, "cream")
        b.ball(0.012, (0, 0, 0.51), "brass", segments=8, rings=6)
        size = (0.28, 0.28, 0.52)
    elif style == "floor":
        for k in range(3):
            a = 2 * np.pi * k / 3
            b.rod((0.25 * np.cos(a), 0.25 * np.sin(a), 0), (0.02 * np.cos(a), 0.02 * np.sin(a), 1.2), 0.014, "wood")
        b.lathe([(0.035, 1.12), (0.045, 1.15), (0.045, 1.2), (0.02, 1.22)], color="charcoal", segments=16)
        b.cylinder(0.01, 0.2, (0, 0, 1.2), "charcoal", segments=8)
        _shade(b, 1.28, 0.22, 0.2, 0.28, "off white")
        size = (0.46, 0.46, 1.56)
    else:
        b.lathe([(0.1, 0), (0.1, 0.015), (0.02, 0.03)], (-0.06, 0, 0), "red", segments=22)
        joint = [(-0.06, 0, 0.02), (-0.14, 0, 0.24), (0.02, 0, 0.42)]
        for start, end in itertools.pairwise(joint):
            for y in (-0.012, 0.012):
                b.rod((start[0], y, start[2]), (end[0], y, end[2]), 0.006, "red", sides=6)
        for p in joint[1:]:
            b.cylinder(0.018, 0.04, (p[0], 0.02, p[2]), "charcoal", turn_deg=(90, 0, 0), segments=12)
        with b.frame((0.02, 0, 0.42), (0, 150, 0)):
            head = [(0.02, -0.03), (0.03, 0.02), (0.075, 0.09), (0.072, 0.09), (0.03, 0.03), (0, 0.03)]
            b.add(shapes.lathe(head, 20), "red")
            b.ball(0.025, (0, 0, 0.06), "lamp", segments=10, rings=6)
        size = (0.26, 0.2, None)
    return made(b, f"a {style} lamp", size, style=style)
