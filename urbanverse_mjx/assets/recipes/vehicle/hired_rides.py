"""Rides for hire: horse carriages and rickshaws."""

import numpy as np

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.recipe import recipe
from ..shared.sizes import fitted
from .bicycles import spoked_wheel
from .carts import solid_wheel
from .small_vehicles import handlebar


@recipe("horse carriage", 3, name="hired_rides.horse_carriage")
def horse_carriage(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.55)
    color, wheel_color, seat = (
        ("black", "dark red", "#7a1f26"),
        ("#1f3d2c", "gold", "cream"),
        ("wood", "dark wood", "brown"),
    )[variant]
    for side in (-1, 1):
        spoked_wheel(b, (-0.85, side * 0.70, 0.58), 0.58, 0.028, wheel_color, 6)
        spoked_wheel(b, (0.95, side * 0.66, 0.44), 0.44, 0.028, wheel_color, 6)
        for x, z in ((-0.85, 0.58), (0.95, 0.44)):  # flat spokes, seen from afar
            for k in range(6):
                a = k * np.pi / 6
                d = np.array([np.cos(a), 0, np.sin(a)]) * (z - 0.06)
                c = np.array([x, side * (0.70 if x < 0 else 0.66), z])
                b.rod(tuple(c - d), tuple(c + d), 0.014, wheel_color, sides=4)
        b.rod((-0.85, 0, 0.58), (-0.85, side * 0.70, 0.58), 0.03, "black", sides=6)
        b.rod((0.95, 0, 0.44), (0.95, side * 0.66, 0.44), 0.03, "black", sides=6)
        b.tube(
            [(-1.25, side * 0.4, 0.62), (-0.85, side * 0.4, 0.70), (-0.45, side * 0.4, 0.62)], 0.025, "black", sides=5
        )
        b.rod((1.05, side * 0.28, 0.55), (2.35, side * 0.34, 0.80), 0.025, wheel_color, sides=6)
        b.cylinder(0.07, 0.16, (0.72, side * 0.62, 1.25), "gold", segments=8)
    hull = [
        (-1.30, 0.72),
        (-0.95, 0.58),
        (0.55, 0.58),
        (0.75, 0.78),
        (0.72, 1.12),
        (0.30, 1.02),
        (-0.25, 0.98),
        (-0.85, 1.05),
        (-1.35, 1.25),
    ]
    b.profile(hull, 1.12, (0, 0, 0), color)
    b.box((0.45, 1.0, 0.14), (-0.95, 0, 1.05), seat, bevel=0.05)
    b.box((0.14, 1.0, 0.45), (-1.25, 0, 1.12), seat, (0, -14, 0), bevel=0.05)
    b.box((0.4, 1.0, 0.14), (0.05, 0, 0.98), seat, bevel=0.05)
    b.box((0.42, 0.95, 0.12), (0.95, 0, 1.30), seat, bevel=0.04)  # the coachman's box
    b.box((0.12, 0.95, 0.35), (0.74, 0, 1.32), seat, (0, -8, 0), bevel=0.04)
    b.box((0.6, 0.7, 0.5), (0.95, 0, 0.8), color, bevel=0.04)
    b.box((0.05, 0.9, 0.35), (1.40, 0, 0.80), color, (0, 22, 0))
    if variant != 2:  # the folding hood over the back seat, or a full canopy
        angles = np.radians(np.linspace(20, 150, 6))
        hood = np.array(
            [
                [(-0.95 + 0.62 * np.cos(a), y, 1.25 + 0.85 * np.sin(a)) for y in np.linspace(-0.55, 0.55, 5)]
                for a in angles
            ]
        )
        b.sheet(hood, "charcoal" if variant == 0 else seat, both_sides=True)
    else:
        b.box((2.4, 1.4, 0.06), (-0.2, 0, 2.1), "cream", bevel=0.02)
        for x in (-1.3, 0.9):
            for side in (-1, 1):
                b.rod((x, side * 0.55, 0.9), (x, side * 0.62, 2.1), 0.025, "dark wood", sides=5)
    names = ("A black horse carriage with red wheels", "A green landau with gold wheels", "A wooden wagonette")
    size = ((3.45, 1.65, 2.1), (3.6, 1.7, 2.2), (3.3, 1.6, 2.3))[variant]
    return fitted(b.build(names[variant], {"hood": variant != 2}), size)


@recipe("rickshaw", 3, name="hired_rides.rickshaw")
def rickshaw(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.5)
    if variant == 2:
        return fitted(_cycle_rickshaw(b), (2.5, 1.1, 1.75))
    color, hood = (("#f0c020", "black"), ("#2f8f52", "#f0c020"))[variant]
    solid_wheel(b, (1.02, 0, 0.21), 0.21, 0.10, "grey")
    for side in (-1, 1):
        solid_wheel(b, (-0.75, side * 0.54, 0.21), 0.21, 0.11, "grey")
    tub = [
        (-1.28, 0.35),
        (-0.6, 0.28),
        (0.75, 0.22),
        (0.82, 0.30),
        (0.3, 0.34),
        (0.12, 0.85),
        (-0.1, 0.85),
        (-0.2, 0.42),
        (-0.6, 0.45),
        (-0.72, 0.95),
        (-1.28, 0.95),
    ]
    b.profile(tub, 1.18, (0, 0, 0), color)
    nose = [(0.75, 0.22), (1.18, 0.35), (1.25, 0.60), (1.0, 1.0), (0.85, 1.02), (0.8, 0.4)]
    b.convex(
        [(x, y * w, z) for (x, z), w in zip(nose, (0.55, 0.16, 0.15, 0.45, 0.56, 0.58), strict=True) for y in (-1, 1)],
        color,
    )
    b.ball((0.05, 0.10, 0.10), (1.22, 0, 0.66), "lamp", segments=10, rings=6)
    screen = [(0.95, 0.55, 1.0), (0.95, -0.55, 1.0), (0.62, -0.54, 1.55), (0.62, 0.54, 1.55)]
    b.quad(screen[::-1], "glass", both_sides=True)
    b.tube([screen[0], screen[3], screen[2], screen[1]], 0.025, hood, sides=6)
    roof = [
        (0.66, 1.55),
        (0.5, 1.66),
        (-1.0, 1.70),
        (-1.24, 1.55),
        (-1.30, 0.92),
        (-1.22, 0.92),
        (-1.15, 1.50),
        (-0.98, 1.62),
        (0.5, 1.58),
    ]
    b.profile(roof, 1.2, (0, 0, 0), hood)
    for side in (-1, 1):
        b.rod((-0.1, side * 0.57, 0.8), (-0.1, side * 0.57, 1.6), 0.025, hood, sides=5)
        b.box((0.55, 0.03, 0.4), (-0.98, side * 0.585, 1.2), hood)
        b.box((0.03, 0.12, 0.08), (-1.29, side * 0.45, 0.5), "red")
        b.rod((0.82, side * 0.5, 1.15), (0.95, side * 0.62, 1.22), 0.012, "black", sides=4)
        b.box((0.02, 0.10, 0.07), (0.95, side * 0.62, 1.20), "black")
    b.box((0.35, 1.0, 0.12), (-0.55, 0, 0.48), "black", bevel=0.03)
    b.box((0.12, 1.0, 0.5), (-0.76, 0, 0.55), "black", bevel=0.03)
    b.box((0.3, 0.5, 0.1), (0.02, 0, 0.86), "black", bevel=0.03)
    b.rod((0.95, 0, 0.5), (0.6, 0, 0.98), 0.025, "black", sides=6)
    handlebar(b, 0.62, 0.98, 0.28, 0.06)
    b.panel(paint.lettering("TAXI", hood, color, (32, 12)), (-1.31, 0, 1.25), 0.5, 0.18, "-x")
    names = ("A yellow and black auto rickshaw", "A green and yellow tuk-tuk")
    return fitted(b.build(names[variant], {"kind": "auto"}), ((2.65, 1.28, 1.75), (2.7, 1.32, 1.8))[variant])


def _cycle_rickshaw(b: MeshBuilder) -> BuiltAsset:
    red = "signal red"
    spoked_wheel(b, (1.0, 0, 0.34), 0.34, 0.02, "aluminium", 8)
    for side in (-1, 1):
        spoked_wheel(b, (-0.65, side * 0.48, 0.34), 0.34, 0.02, "aluminium", 8)
        b.tube([(-0.95, side * 0.42, 0.78), (-0.65, side * 0.48, 0.76), (-0.25, side * 0.42, 0.60)], 0.04, red, sides=5)
        b.rod((1.0, side * 0.05, 0.34), (0.86, side * 0.04, 0.78), 0.014, "dark blue", sides=5)
        b.box((0.09, 0.10, 0.02), (0.35 + side * 0.12, side * 0.12, 0.28 - side * 0.08), "black")
    b.tube([(0.84, 0, 0.80), (0.40, 0, 0.32), (-0.60, 0, 0.36)], 0.025, "dark blue", sides=6)
    b.rod((0.40, 0, 0.32), (0.22, 0, 0.90), 0.02, "dark blue", sides=6)
    b.box((0.25, 0.16, 0.05), (0.20, 0, 0.90), "black", bevel=0.02)
    b.rod((0.85, 0, 0.75), (0.78, 0, 1.02), 0.02, "dark blue", sides=6)
    handlebar(b, 0.80, 1.03, 0.28, 0.14)
    b.cylinder(0.10, 0.015, (0.35, -0.04, 0.28), "dark grey", (90, 0, 0), segments=12)
    b.rod((-0.65, -0.48, 0.34), (-0.65, 0.48, 0.34), 0.025, "dark grey", sides=6)
    b.box((0.55, 0.85, 0.16), (-0.65, 0, 0.55), red, bevel=0.03)
    b.box((0.45, 0.80, 0.12), (-0.62, 0, 0.70), "signal yellow", bevel=0.04)
    b.box((0.10, 0.80, 0.45), (-0.92, 0, 0.72), "signal yellow", (0, -10, 0), bevel=0.03)
    b.box((0.35, 0.7, 0.04), (-0.15, 0, 0.38), red)
    angles = np.radians(np.linspace(35, 165, 6))
    hood = np.array(
        [[(-0.72 + 0.55 * np.cos(a), y, 1.0 + 0.72 * np.sin(a)) for y in np.linspace(-0.45, 0.45, 5)] for a in angles]
    )
    b.sheet(hood, "#2a7f9e", both_sides=True)
    return b.build("A red cycle rickshaw with a blue hood", {"kind": "cycle"})
