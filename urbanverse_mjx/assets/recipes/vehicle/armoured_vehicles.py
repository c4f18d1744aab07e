"""Crawler tracks, and the armoured vehicles that run on them or on many wheels."""

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import shade
from ...meshes.recipe import recipe
from ..shared.sizes import fitted
from .carts import solid_wheel


def tracks(b: MeshBuilder, length: float, height: float, width: float, gauge: float, wheels: int) -> None:
    """Two crawler tracks along x, centred: a band round its wheels; `gauge` between their middles."""
    r = height / 2
    half = length / 2 - r
    a = np.radians(np.linspace(-90, 90, 7))
    loop = [(half + r * np.cos(t), r + r * np.sin(t)) for t in a] + [
        (-half - r * np.cos(t), r - r * np.sin(t)) for t in a
    ]
    inner = [(x * (1 - 0.16 * r / (half + r)), r + (z - r) * 0.80) for x, z in loop]
    for side in (-1, 1):
        y = side * gauge / 2
        with b.frame((0, y + width / 2, 0), (90, 0, 0)):
            b.extrude(loop, width, color="rubber", holes=[inner])
        b.box((2 * half, width * 0.5, r * 0.7), (0, y, r * 0.65), "dark grey")
        for k in range(wheels):
            x = -half + 2 * half * k / (wheels - 1)
            radius = r * (0.78 if k in (0, wheels - 1) else 0.5)
            z = r if k in (0, wheels - 1) else r * 0.72
            b.cylinder(radius, width * 0.9, (x, y + width * 0.45, z), "grey", (90, 0, 0), segments=12)
        count = int(2 * half / 0.22)
        for k in range(count):  # grousers above and below
            x = -half + 2 * half * (k + 0.5) / count
            b.box((0.05, width * 1.02, 0.035), (x, y, 2 * r - 0.012), "black")


@recipe("combat tactical  vehicle", 3, name="armoured.combat_vehicle")
def combat_vehicle(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.85)
    paint_color = ("#5d6a42", "#a8946a", "#4c5540")[variant]
    dark = shade(paint_color, 0.72)
    if variant == 0:  # a tank
        tracks(b, 5.6, 0.95, 0.55, 2.35, 7)
        hull = [(-2.75, 0.55), (2.4, 0.45), (3.0, 0.85), (2.2, 1.25), (-2.75, 1.25)]
        b.profile(hull, 1.85, (0, 0, 0), paint_color)
        for side in (-1, 1):
            b.box((5.6, 0.62, 0.08), (0, side * 1.17, 0.98), paint_color)
            b.box((5.2, 0.04, 0.38), (0, side * 1.46, 0.62), dark)
        turret = [
            (1.15, 0.55, 1.27),
            (1.15, -0.55, 1.27),
            (0.95, 0.5, 1.75),
            (0.95, -0.5, 1.75),
            (-1.6, 0.9, 1.27),
            (-1.6, -0.9, 1.27),
            (-1.5, 0.7, 1.85),
            (-1.5, -0.7, 1.85),
            (0.0, 1.2, 1.27),
            (0.0, -1.2, 1.27),
            (-0.1, 0.95, 1.85),
            (-0.1, -0.95, 1.85),
        ]
        b.convex(turret, paint_color)
        b.rod((1.0, 0, 1.55), (3.9, 0, 1.62), 0.075, dark, sides=10)
        b.cylinder(0.11, 0.5, (2.4, 0, 1.585), dark, (0, 89, 0), segments=10)
        b.cylinder(0.32, 0.22, (-0.4, 0.35, 1.84), dark, segments=12)
        b.rod((-0.4, 0.35, 2.15), (0.5, 0.35, 2.2), 0.03, "black", sides=5)
        b.box((0.4, 0.15, 0.16), (-0.4, 0.35, 2.06), "black")
        b.rod((-1.4, -0.6, 1.85), (-1.7, -0.6, 2.6), 0.012, "black", sides=4)
    elif variant == 1:  # a sand-coloured patrol jeep, wide and low
        for x in (-1.65, 1.65):
            for side in (-1, 1):
                solid_wheel(b, (x, side * 0.92, 0.48), 0.48, 0.32, dark)
        body = [(-2.35, 0.6), (2.3, 0.6), (2.35, 1.05), (1.0, 1.2), (0.45, 1.75), (-1.3, 1.8), (-2.35, 1.3)]
        b.profile(body, 2.0, (0, 0, 0), paint_color)
        for side in (-1, 1):
            for x0, x1 in ((-1.1, -0.4), (-0.25, 0.4)):
                b.box((x1 - x0, 0.03, 0.38), ((x0 + x1) / 2, side * 1.005, 1.3), "dark glass")
            b.cylinder(0.11, 0.06, (2.32, side * 0.7, 0.9), "lamp", (0, 90, 0), segments=10)
        b.quad(
            [(0.92, 0.85, 1.27), (0.92, -0.85, 1.27), (0.52, -0.8, 1.70), (0.52, 0.8, 1.70)][::-1],
            "dark glass",
            both_sides=True,
        )
        for k in range(7):
            b.box((0.04, 0.06, 0.28), (2.34, -0.42 + 0.14 * k, 0.72), "black")
        b.cylinder(0.42, 0.12, (-0.5, 0, 1.78), dark, segments=12)
        b.rod((-0.5, 0, 2.05), (0.7, 0, 2.08), 0.04, "black", sides=6)
        b.box((0.5, 0.2, 0.25), (-0.4, 0, 1.9), "black")
        b.box((0.3, 2.2, 0.2), (2.42, 0, 0.55), dark)
    else:  # an eight-wheeled armoured carrier
        for x in (-2.4, -0.95, 0.85, 2.3):
            for side in (-1, 1):
                solid_wheel(b, (x, side * 1.15, 0.55), 0.55, 0.38, dark)
        hull = [(-3.3, 0.7), (2.6, 0.6), (3.5, 1.15), (2.0, 1.85), (-3.3, 2.0)]
        b.profile(hull, 2.1, (0, 0, 0), paint_color)
        upper = [(-3.2, 1.15), (2.9, 1.15), (1.9, 1.7), (-3.2, 1.75)]
        b.profile(upper, 2.7, (0, 0, 0), paint_color)
        b.cylinder(0.85, 0.4, (-0.2, 0, 1.95), paint_color, segments=14, top_radius=0.6)
        b.rod((0.3, 0, 2.15), (2.3, 0, 2.22), 0.06, dark, sides=8)
        for side in (-1, 1):
            b.cylinder(0.13, 0.08, (3.2, side * 0.85, 1.2), "lamp", (0, 70, 0), segments=10)
            b.box((0.9, 0.1, 0.25), (-1.8, side * 1.38, 1.3), dark)
    names = (
        "A green main battle tank",
        "A sand-coloured patrol jeep with a gun",
        "A green eight-wheeled armoured carrier",
    )
    size = ((6.7, 2.9, 2.5), (4.9, 2.2, 2.1), (7.0, 2.75, 2.4))[variant]
    return fitted(b.build(names[variant], {"kind": ("tank", "jeep", "carrier")[variant]}), size)
