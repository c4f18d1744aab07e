"""Small vehicles that people push or pedal: handcarts, strollers, wheelchairs, tricycles."""

import dataclasses

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import Physics, recipe
from .bicycles import spoked_wheel

_WHEELCHAIR = Physics(
    ("steel", "nylon", "rubber"),
    400.0,
    (12.0, 120.0),
    0.7,
    True,
    "folding wheelchairs weigh 14-20 kg, powered ones 60-110 kg",
)
_STROLLER = Physics(("aluminium", "fabric", "plastic"), 150.0, (6.0, 16.0), 0.6, True, "pushchairs weigh 6-15 kg")
_HANDCART = Physics(
    ("wood", "steel"), 300.0, (10.0, 90.0), 0.6, True, "sack trucks weigh 10-15 kg, wooden market carts 40-80 kg empty"
)
_TRICYCLE = Physics(
    ("steel", "plastic", "rubber"),
    300.0,
    (5.0, 120.0),
    0.7,
    True,
    "children's tricycles 5-8 kg, cargo tricycles 35-60 kg plus load",
)


def solid_wheel(
    b: MeshBuilder, at: tuple[float, float, float], radius: float, width: float, rim: Color = "light grey"
) -> None:
    """A solid rubber tyre on a disc, upright across y; `at` is its centre."""
    y0 = at[1] + width / 2
    b.ring(radius - width * 0.5, width * 0.5, at, "rubber", (90, 0, 0), segments=16, sides=6)
    b.cylinder(radius - width * 0.6, width * 0.6, (at[0], y0 - width * 0.2, at[2]), rim, (90, 0, 0), segments=12)
    b.cylinder(radius * 0.28, width * 0.9, (at[0], y0 - width * 0.05, at[2]), "dark grey", (90, 0, 0), segments=8)


@recipe("wheelchair", 3, _WHEELCHAIR, hulls=4, name="carts.wheelchair")
def wheelchair(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.6, metallic=0.1)
    cloth = ("dark blue", "black", "dark red")[variant]
    frame = ("aluminium", "charcoal", "signal red")[variant]
    half = 0.25
    b.box((0.44, 2 * half - 0.06, 0.06), (0.0, 0, 0.48), cloth, bevel=0.02)
    b.box((0.05, 2 * half - 0.06, 0.46), (-0.23, 0, 0.50), cloth, turn_deg=(0, -8, 0), bevel=0.02)
    for s in (-1, 1):
        y = s * half
        b.tube([(-0.42, y, 0.96), (-0.30, y, 0.95), (-0.22, y, 0.50), (-0.22, y, 0.20)], 0.013, frame, sides=6)
        b.rod((-0.42, y, 0.96), (-0.34, y, 0.955), 0.02, "black")
        b.tube([(-0.24, y, 0.49), (0.24, y, 0.49), (0.36, y, 0.18), (0.42, y * 0.8, 0.13)], 0.013, frame, sides=6)
        b.tube([(-0.26, y, 0.70), (0.16, y, 0.70), (0.22, y, 0.50)], 0.012, frame, sides=6)
        b.box((0.30, 0.05, 0.03), (-0.05, y, 0.70), "black", bevel=0.01)
        b.box((0.24, 0.015, 0.17), (-0.05, y, 0.51), shade(cloth, 0.8))
        b.box((0.17, 0.14, 0.02), (0.42, s * 0.11, 0.11), "black", turn_deg=(0, -12, 0))
        if variant != 1:
            spoked_wheel(b, (-0.20, s * (half + 0.055), 0.305), 0.305, 0.016, "aluminium", 8)
            b.ring(0.265, 0.008, (-0.20, s * (half + 0.085), 0.305), "aluminium", (90, 0, 0), 18, 4)
        else:
            solid_wheel(b, (-0.18, s * (half + 0.05), 0.17), 0.17, 0.08, "dark grey")
        solid_wheel(b, (0.26, s * (half - 0.02), 0.09), 0.09, 0.035)
        b.rod((0.26, s * (half - 0.02), 0.10), (0.24, s * (half - 0.02), 0.45), 0.012, frame, sides=6)
    if variant == 1:  # a powered chair: battery box and joystick
        b.box((0.48, 0.38, 0.22), (-0.04, 0, 0.16), "charcoal", bevel=0.04)
        b.box((0.12, 0.07, 0.05), (0.14, -half, 0.73), "dark grey", bevel=0.01)
        b.rod((0.16, -half, 0.77), (0.16, -half, 0.83), 0.012, "black")
        b.box((0.07, 0.28, 0.16), (-0.31, 0, 0.98), "black", bevel=0.02)
    else:
        for k in (-1, 1):
            b.rod((-0.10, k * half, 0.22), (-0.10, -k * half, 0.47), 0.010, frame, sides=5)
    names = (
        "A folding wheelchair with a blue seat",
        "A powered wheelchair with a joystick",
        "An active wheelchair with a red frame",
    )
    built = b.build(names[variant], {"powered": variant == 1}, mass=(17.0, 85.0, 12.0)[variant])
    return dataclasses.replace(built, volume=0.05)


@recipe("stroller", 3, _STROLLER, hulls=4, name="carts.stroller")
def stroller(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.8)
    cloth = ("teal", "charcoal", "#a33b4a")[variant]
    half = 0.24
    # Chassis: handle down to the front wheels, braces to the rear wheels.
    for s in (-1, 1):
        y = s * half
        b.tube(
            [(-0.52, y, 1.02), (-0.42, y, 0.98), (0.0, y, 0.52), (0.34, y, 0.20), (0.40, y * 0.9, 0.13)],
            0.013,
            "aluminium",
            sides=6,
        )
        b.tube([(0.02, y, 0.52), (-0.30, y, 0.14)], 0.013, "aluminium", sides=6)
        solid_wheel(b, (-0.30, s * (half + 0.04), 0.14), 0.14, 0.045)
        if variant != 2:
            solid_wheel(b, (0.40, s * (half - 0.03), 0.11), 0.11, 0.04)
    if variant == 2:
        solid_wheel(b, (0.52, 0.0, 0.15), 0.15, 0.05)
        b.tube(
            [(0.34, half, 0.20), (0.52, 0.06, 0.16), (0.52, -0.06, 0.16), (0.34, -half, 0.20)],
            0.014,
            "aluminium",
            sides=6,
        )
    b.rod((-0.52, half, 1.02), (-0.52, -half, 1.02), 0.02, "black", sides=8)
    b.rod((-0.30, half, 0.14), (-0.30, -half, 0.14), 0.012, "dark grey", sides=6)
    b.box((0.44, 0.40, 0.14), (0.02, 0, 0.20), "black", taper=(1.1, 1.1))
    # Seat or carrycot, and the hood of three hoops.
    if variant == 1:
        rows = [_slab(x, 0.21 * w, 0.58, 0.86) for x, w in ((-0.40, 0.75), (-0.34, 1.0), (0.34, 1.0), (0.42, 0.75))]
        b.loft(rows, cloth, crease_deg=50)
        b.box((0.42, 0.36, 0.05), (0.14, 0, 0.85), shade(cloth, 1.5), bevel=0.02)
        start, centre, radius = 8.0, (-0.12, 0.86), 0.33
    else:
        b.box((0.34, 0.38, 0.06), (0.06, 0, 0.52), cloth, bevel=0.02)
        b.box((0.06, 0.38, 0.52), (-0.12, 0, 0.54), cloth, turn_deg=(0, -22, 0), bevel=0.02)
        b.box((0.26, 0.34, 0.03), (0.31, 0, 0.34), shade(cloth, 0.8), turn_deg=(0, 48, 0))
        for s in (-1, 1):
            b.box((0.30, 0.02, 0.20), (0.06, s * 0.195, 0.55), shade(cloth, 0.85))
        b.tube(
            [(0.20, 0.20, 0.74), (0.32, 0.12, 0.76), (0.32, -0.12, 0.76), (0.20, -0.20, 0.74)], 0.018, "black", sides=6
        )
        start, centre, radius = 20.0, (-0.12, 0.82), 0.33
    angles = np.radians(np.linspace(start, 150, 6))
    hood = np.array(
        [
            [
                (
                    centre[0] + radius * np.cos(a) * (1 - 0.10 * (y / 0.23) ** 4),
                    y,
                    centre[1] + radius * np.sin(a) * (1 - 0.25 * (y / 0.23) ** 2),
                )
                for y in np.linspace(-0.23, 0.23, 7)
            ]
            for a in angles
        ]
    )
    b.sheet(hood, shade(cloth, 0.9), both_sides=True)
    if variant == 0:
        b.ball((0.075, 0.07, 0.08), (0.04, 0, 0.88), "skin light", segments=10, rings=7)
        b.box((0.20, 0.20, 0.26), (0.04, 0, 0.58), "signal yellow", bevel=0.06)
    names = ("A teal pushchair with a child", "A black pram with a carrycot", "A red three-wheeled jogging stroller")
    built = b.build(names[variant], {"wheels": 3 if variant == 2 else 4}, mass=(18.0, 14.0, 11.0)[variant])
    return dataclasses.replace(built, volume=0.08)


def _slab(x: float, half: float, z0: float, z1: float) -> np.ndarray:
    c = 0.05
    points = [(half - c, z0), (half, z0 + c), (half, z1), (-half, z1), (-half, z0 + c), (-half + c, z0)]
    return np.array([(x, y, z) for y, z in points])


@recipe("handcart", 3, _HANDCART, hulls=4, name="carts.handcart")
def handcart(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.85)
    if variant == 0:  # sack truck with boxes
        for s in (-1, 1):
            b.tube(
                [(-0.35, s * 0.2, 1.15), (-0.20, s * 0.2, 1.18), (-0.06, s * 0.2, 0.10)], 0.016, "signal red", sides=6
            )
            solid_wheel(b, (-0.14, s * 0.25, 0.13), 0.13, 0.06, "signal yellow")
            b.rod((-0.35, s * 0.2, 1.15), (-0.27, s * 0.2, 1.17), 0.022, "black", sides=6)
        for z in (0.25, 0.6, 0.95):
            x = -0.06 - 0.13 * (z - 0.1)
            b.rod((x, -0.2, z), (x, 0.2, z), 0.013, "signal red", sides=6)
        b.box((0.30, 0.42, 0.015), (0.08, 0, 0.05), "dark grey")
        for k, (w, h) in enumerate(((0.40, 0.34), (0.36, 0.30), (0.30, 0.22))):
            b.box(
                (0.28, w, h),
                (0.08 - 0.03 * k, 0.01 * k, 0.07 + (0, 0.345, 0.65)[k]),
                ("cardboard", "beige", "cardboard")[k],
                bevel=0.008,
            )
            b.box((0.283, 0.05, h + 0.004), (0.08 - 0.03 * k, 0.01 * k, 0.068 + (0, 0.345, 0.65)[k]), "light wood")
    elif variant == 1:  # market barrow with fruit
        b.box((1.25, 0.75, 0.06), (0, 0, 0.62), "wood")
        for s in (-1, 1):
            b.box((1.25, 0.03, 0.20), (0, s * 0.36, 0.66), "light wood")
            spoked_wheel(b, (0.05, s * 0.46, 0.36), 0.36, 0.025, "dark wood", 10)
            b.rod((-0.60, s * 0.30, 0.64), (-1.05, s * 0.26, 0.80), 0.022, "wood", sides=6)
            b.rod((-0.45, s * 0.30, 0.62), (-0.50, s * 0.30, 0.0), 0.025, "wood", sides=6)
            b.box((0.03, 0.75, 0.20), (s * 0.61, 0, 0.66), "light wood")
        b.rod((0.05, -0.46, 0.36), (0.05, 0.46, 0.36), 0.025, "dark grey", sides=6)
        b.box((0.1, 0.6, 0.25), (0.05, 0, 0.38), "wood")
        for k, color in enumerate(("red", "orange", "lime", "yellow")):
            for j in range(6):
                x, y = -0.50 + 0.28 * k + 0.13 * (j % 2), -0.22 + 0.20 * (j // 2)
                b.ball(0.075, (x, y, 0.74), color, segments=7, rings=4)
    else:  # blue two-wheeled hand trolley with a box and mesh
        b.box((0.95, 0.60, 0.04), (0, 0, 0.22), "signal blue", bevel=0.01)
        for x in (-0.34, 0.34):
            for s in (-1, 1):
                solid_wheel(b, (x, s * 0.22, 0.09), 0.09, 0.045)
                b.box((0.05, 0.05, 0.12), (x, s * 0.22, 0.12), "dark grey")
        b.tube(
            [(-0.45, 0.27, 0.24), (-0.52, 0.27, 0.95), (-0.52, -0.27, 0.95), (-0.45, -0.27, 0.24)],
            0.017,
            "aluminium",
            sides=6,
        )
        b.rod((-0.49, 0.27, 0.6), (-0.49, -0.27, 0.6), 0.012, "aluminium", sides=6)
        b.box((0.42, 0.50, 0.36), (0.20, 0, 0.26), "green", bevel=0.02)
        b.box((0.36, 0.44, 0.30), (-0.20, 0.0, 0.26), "cardboard", bevel=0.01)
    names = ("A red sack truck with boxes", "A wooden market barrow with fruit", "A blue platform trolley with crates")
    built = b.build(
        names[variant], {"kind": ("sack truck", "barrow", "trolley")[variant]}, mass=(38.0, 85.0, 45.0)[variant]
    )
    return dataclasses.replace(built, volume=(0.12, 0.25, 0.15)[variant])


@recipe("tricycle", 3, _TRICYCLE, hulls=5, name="carts.tricycle")
def tricycle(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.5)
    if variant == 0:  # a child's tricycle
        solid_wheel(b, (0.32, 0, 0.15), 0.15, 0.05, "signal yellow")
        for s in (-1, 1):
            solid_wheel(b, (-0.22, s * 0.19, 0.11), 0.11, 0.045, "signal yellow")
            b.rod((0.32, s * 0.04, 0.15), (0.32, s * 0.13, 0.10 if s > 0 else 0.20), 0.010, "aluminium", sides=5)
            b.box((0.07, 0.07, 0.02), (0.32, s * 0.14, 0.09 if s > 0 else 0.19), "black")
            b.rod((0.24, s * 0.02, 0.52), (0.20, s * 0.18, 0.55), 0.012, "aluminium", sides=6)
            b.rod((0.21, s * 0.13, 0.545), (0.195, s * 0.20, 0.555), 0.018, "signal yellow", sides=6)
            b.rod((0.26, s * 0.035, 0.40), (0.32, s * 0.035, 0.15), 0.010, "red", sides=5)
        b.rod((0.23, 0, 0.53), (0.275, 0, 0.38), 0.018, "red")
        b.tube([(0.265, 0, 0.40), (0.10, 0, 0.28), (-0.15, 0, 0.24), (-0.22, 0, 0.12)], 0.022, "red", sides=8)
        b.rod((-0.22, -0.19, 0.11), (-0.22, 0.19, 0.11), 0.012, "aluminium", sides=6)
        b.box((0.20, 0.20, 0.04), (-0.06, 0, 0.29), "signal blue", bevel=0.015)
        b.box((0.03, 0.18, 0.14), (-0.16, 0, 0.31), "signal blue", bevel=0.01)
    else:
        _cargo_trike(b, ("dark green", "signal blue")[variant - 1], box_front=variant == 1)
    names = (
        "A child's red tricycle",
        "A green cargo tricycle with a box in front",
        "A blue cargo tricycle with a platform behind",
    )
    built = b.build(
        names[variant], {"kind": ("child", "front box", "rear platform")[variant]}, mass=(6.0, 48.0, 55.0)[variant]
    )
    return dataclasses.replace(built, volume=(0.01, 0.12, 0.12)[variant])


def _cargo_trike(b: MeshBuilder, color: Color, box_front: bool) -> None:
    single, pair = (-0.85, 0.55) if box_front else (0.85, -0.60)
    spoked_wheel(b, (single, 0, 0.33), 0.33, 0.022, "aluminium", 8)
    for s in (-1, 1):
        spoked_wheel(b, (pair, s * 0.44, 0.28), 0.28, 0.022, "aluminium", 8)
    b.rod((pair, -0.44, 0.28), (pair, 0.44, 0.28), 0.02, "dark grey")
    if box_front:
        b.box((0.85, 0.70, 0.48), (0.58, 0, 0.30), "light wood", taper=(1.1, 1.08))
        b.box((0.95, 0.77, 0.03), (0.58, 0, 0.78), color)
        b.tube([(-0.85, 0.05, 0.33), (-0.35, 0.02, 0.30), (0.15, 0, 0.42)], 0.025, color, sides=7)
        b.rod((-0.35, 0, 0.30), (-0.48, 0, 0.92), 0.02, color)
        b.rod((-0.85, -0.05, 0.33), (-0.45, -0.01, 0.74), 0.012, color)
        b.tube(
            [(0.12, 0.36, 0.70), (0.02, 0.36, 0.98), (0.02, -0.36, 0.98), (0.12, -0.36, 0.70)], 0.014, "black", sides=6
        )
        saddle, crank = (-0.48, 0.95), (-0.35, 0.30)
    else:
        b.box((0.95, 0.80, 0.05), (-0.62, 0, 0.44), "wood")
        for s in (-1, 1):
            b.box((0.95, 0.03, 0.22), (-0.62, s * 0.39, 0.48), color)
        b.box((0.03, 0.80, 0.22), (-1.08, 0, 0.48), color)
        b.box((0.5, 0.5, 0.34), (-0.75, 0.05, 0.49), "cardboard", bevel=0.01)
        b.tube([(0.68, 0, 0.72), (0.25, 0, 0.32), (-0.60, 0, 0.34)], 0.025, color, sides=7)
        b.rod((0.14, 0, 0.32), (0.02, 0, 0.92), 0.02, color)
        b.rod((0.60, 0, 1.0), (0.70, 0, 0.62), 0.02, color)
        for s in (-1, 1):
            b.rod((0.70, s * 0.03, 0.64), (0.85, s * 0.04, 0.33), 0.012, color)
            b.tube([(0.60, 0, 1.02), (0.58, s * 0.18, 1.05), (0.42, s * 0.28, 1.04)], 0.012, "aluminium", sides=6)
            b.rod((0.50, s * 0.245, 1.045), (0.41, s * 0.285, 1.04), 0.018, "black", sides=6)
        saddle, crank = (0.02, 0.95), (0.22, 0.32)
    b.box((0.25, 0.16, 0.05), (saddle[0], 0, saddle[1] - 0.03), "black", bevel=0.02, taper=(0.8, 0.8))
    b.cylinder(0.09, 0.012, (crank[0], -0.045, crank[1]), "dark grey", (90, 0, 0), segments=12)
    for s in (-1, 1):
        b.beam(
            (crank[0], s * 0.07, crank[1]),
            (crank[0] + s * 0.12, s * 0.07, crank[1] - s * 0.08),
            0.018,
            0.014,
            "aluminium",
        )
        b.box((0.09, 0.09, 0.02), (crank[0] + s * 0.12, s * 0.13, crank[1] - s * 0.08), "black", centered=True)
