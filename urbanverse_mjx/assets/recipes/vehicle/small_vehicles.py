"""Small vehicles: quad, wheelbarrow, hoverboard, segway, snowmobile, unicycle."""

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import recipe
from ..shared.sizes import fitted
from .bicycles import spoked_wheel
from .carts import solid_wheel
from .road_service import farm_wheel


def handlebar(b: MeshBuilder, x: float, z: float, half: float, back: float = 0.10) -> None:
    path = [(x - back, half, z), (x, half * 0.5, z + 0.01), (x, -half * 0.5, z + 0.01), (x - back, -half, z)]
    b.tube(path, 0.014, "black", sides=6)
    for side in (-1, 1):
        b.rod((x - back * 0.5, side * half * 0.78, z), (x - back, side * half * 1.02, z), 0.02, "black", sides=6)


@recipe("all-terrain vehicle", 3, name="small_vehicles.all_terrain_vehicle")
def all_terrain_vehicle(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.5)
    color = ("signal red", "#4f6b3c", "safety orange")[variant]
    wide = variant == 2
    base, gauge, r = (0.66, 0.44, 0.30) if not wide else (0.95, 0.58, 0.34)
    for x in (-base, base):
        for side in (-1, 1):
            farm_wheel(b, (x, side * gauge, r), r, 0.24, "grey")
            if not wide:
                arch = [
                    (x - 0.38, 0.52),
                    (x - 0.2, 0.68),
                    (x + 0.2, 0.70),
                    (x + 0.38, 0.55),
                    (x + 0.2, 0.64),
                    (x - 0.2, 0.62),
                ]
                b.profile(arch, 0.34, (0, side * (gauge - 0.06), 0), color)
        b.rod((x, -gauge, r), (x, gauge, r), 0.04, "dark grey", sides=6)
    if not wide:
        b.box((1.1, 0.36, 0.34), (0, 0, 0.28), "charcoal", bevel=0.05)
        tank = [(-0.15, 0.55), (0.55, 0.5), (0.75, 0.6), (0.45, 0.86), (0.1, 0.82), (-0.15, 0.7)]
        b.profile(tank, 0.34, (0, 0, 0), color)
        b.box((0.75, 0.30, 0.12), (-0.35, 0, 0.70), "black", bevel=0.05)
        for x, length in ((0.72, 0.45), (-0.78, 0.5)):  # racks
            for y in (-0.28, -0.09, 0.09, 0.28):
                b.rod((x - length / 2, y, 0.80), (x + length / 2, y, 0.80), 0.012, "black", sides=4)
            for dx in (-0.5, 0.5):
                b.rod((x + dx * length, -0.30, 0.80), (x + dx * length, 0.30, 0.80), 0.014, "black", sides=4)
        b.rod((0.55, 0, 0.7), (0.35, 0, 1.05), 0.03, "black", sides=6)
        handlebar(b, 0.36, 1.06, 0.38)
        b.box((0.06, 0.75, 0.06), (0.98, 0, 0.42), "black")
        for side in (-1, 1):
            b.rod((0.80, side * 0.2, 0.45), (1.0, side * 0.3, 0.62), 0.02, "black", sides=5)
            b.ball((0.05, 0.08, 0.06), (0.80, side * 0.20, 0.62), "lamp", segments=8, rings=5)
            b.box((0.55, 0.18, 0.03), (0.0, side * 0.36, 0.28), "black")
        if variant == 1:
            b.box((0.42, 0.55, 0.3), (-0.80, 0, 0.81), "black", bevel=0.06)
    else:  # a side-by-side under its cage
        b.box((2.3, 0.85, 0.35), (0, 0, 0.30), "charcoal", bevel=0.05)
        nose = [(0.55, 0.5), (1.35, 0.45), (1.4, 0.6), (0.75, 0.98), (0.55, 0.95)]
        b.profile(nose, 1.0, (0, 0, 0), color)
        b.box((0.6, 1.1, 0.35), (-1.0, 0, 0.62), color, bevel=0.05)
        for side in (-1, 1):
            b.box((0.4, 0.42, 0.12), (-0.2, side * 0.27, 0.62), "black", bevel=0.04)
            b.box((0.12, 0.42, 0.5), (-0.42, side * 0.27, 0.66), "black", (0, -12, 0), bevel=0.04)
            b.tube(
                [
                    (0.62, side * 0.52, 0.95),
                    (0.25, side * 0.50, 1.62),
                    (-0.65, side * 0.50, 1.62),
                    (-0.85, side * 0.52, 0.9),
                ],
                0.03,
                color,
                sides=6,
            )
            b.ball((0.05, 0.10, 0.06), (1.33, side * 0.33, 0.66), "lamp", segments=8, rings=5)
        for x in (0.25, -0.65):
            b.rod((x, -0.5, 1.62), (x, 0.5, 1.62), 0.03, color, sides=6)
        b.ring(0.16, 0.018, (0.32, 0.27, 0.98), "black", (0, -55, 0), 14, 5)
        b.box((0.9, 1.0, 0.03), (-0.2, 0, 1.64), color)
    names = ("A red quad bike", "A green farm quad with a box", "An orange side-by-side buggy")
    size = ((2.15, 1.20, 1.22), (2.2, 1.2, 1.25), (2.9, 1.5, 1.85))[variant]
    return fitted(b.build(names[variant], {"seats": 2 if wide else 1}), size)


@recipe("barrow", 3, name="small_vehicles.barrow")
def barrow(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.7)
    tray, frame = (("#2f6f44", "galvanised"), ("signal red", "black"), ("wood", "dark wood"))[variant]
    two = variant == 1
    for y in (-0.16, 0.16) if two else (0.0,):
        solid_wheel(b, (0.52, y, 0.19), 0.19, 0.08, "signal red" if variant == 0 else "grey")
    for side in (-1, 1):
        path = [
            (0.55, side * (0.06 if not two else 0.22), 0.20),
            (0.10, side * 0.20, 0.30),
            (-0.35, side * 0.25, 0.52),
            (-0.82, side * 0.27, 0.58),
        ]
        b.tube(path, 0.018, frame, sides=6)
        b.rod((-0.70, side * 0.265, 0.57), (-0.84, side * 0.272, 0.585), 0.024, "black", sides=6)
        b.tube(
            [
                (0.0, side * 0.21, 0.32),
                (-0.22, side * 0.24, 0.02),
                (-0.38, side * 0.24, 0.02),
                (-0.36, side * 0.25, 0.52),
            ],
            0.016,
            frame,
            sides=6,
        )
    b.rod((-0.30, -0.24, 0.02), (-0.30, 0.24, 0.02), 0.016, frame, sides=5)
    low = [(0.28, 0.16), (0.28, -0.16), (-0.26, -0.20), (-0.26, 0.20)]
    high = [(0.62, 0.27), (0.62, -0.27), (-0.42, -0.31), (-0.42, 0.31)]
    outer = [np.array([(x, y, z) for x, y in ring]) for ring, z in ((low, 0.33), (high, 0.60))]
    inner = [np.array([(x * 0.96, y * 0.94, z) for x, y in ring]) for ring, z in ((high, 0.601), (low, 0.36))]
    b.loft([s[::-1] for s in (*outer, *inner)], tray, crease_deg=20)
    if variant != 1:  # a heap of soil or stones
        heap = [(x * 0.9, y * 0.88, 0.58) for x, y in high] + [
            (0.2, 0.1, 0.72),
            (-0.05, -0.08, 0.74),
            (0.32, -0.06, 0.68),
        ]
        b.convex(heap, ("soil", "grey wood")[variant // 2])
    names = ("A green wheelbarrow full of soil", "A red two-wheeled garden cart", "A wooden wheelbarrow with gravel")
    size = ((1.42, 0.64, 0.64), (1.36, 0.68, 0.60), (1.55, 0.62, 0.72))[variant]
    return fitted(b.build(names[variant], {"wheels": 2 if two else 1}), size)


@recipe("hoverboard", 3, name="small_vehicles.hoverboard")
def hoverboard(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.35)
    color = ("black", "signal red", "white")[variant]
    for side in (-1, 1):
        y = side * 0.27
        b.cylinder(0.085, 0.05, (0, y + 0.025, 0.085), "rubber", (90, 0, 0), segments=18)
        b.cylinder(0.05, 0.052, (0, y + 0.026, 0.085), "light grey", (90, 0, 0), segments=12)
        # Half a body: thick over the wheel, waisted in the middle where it twists.
        sections = []
        for at, half, low, high in (
            (0.29, 0.085, 0.11, 0.172),
            (0.22, 0.095, 0.045, 0.172),
            (0.10, 0.085, 0.05, 0.125),
            (0.012, 0.055, 0.06, 0.12),
        ):
            ring = [
                (-half, low + 0.02),
                (-half * 0.7, low),
                (half * 0.7, low),
                (half, low + 0.02),
                (half, high - 0.02),
                (half * 0.7, high),
                (-half * 0.7, high),
                (-half, high - 0.02),
            ]
            sections.append(np.array([(x * side, side * at, z) for x, z in ring]))
        b.loft(sections, color, crease_deg=50)
        b.box((0.15, 0.13, 0.008), (0, side * 0.13, 0.126), "charcoal", (side * 12, 0, 0))
        b.box((0.01, 0.08, 0.016), (0.088, side * 0.15, 0.085), "light blue")
    b.cylinder(0.045, 0.05, (0, 0.025, 0.09), "dark grey", (90, 0, 0), segments=12)
    names = ("A black hoverboard", "A red hoverboard", "A white hoverboard")
    size = ((0.19, 0.64, 0.18), (0.20, 0.60, 0.175), (0.21, 0.70, 0.19))[variant]
    return fitted(b.build(names[variant], {"color": color}), size)


@recipe("segway", 3, name="small_vehicles.segway")
def segway(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.45)
    color = ("light grey", "black", "white")[variant]
    r = (0.24, 0.27, 0.22)[variant]
    for side in (-1, 1):
        y = side * 0.27
        b.ring(r - 0.035, 0.035, (0, y, r), "rubber", (90, 0, 0), segments=20, sides=6)
        b.cylinder(r - 0.06, 0.04, (0, y + 0.02, r), "grey", (90, 0, 0), segments=16)
        for k in range(5):
            a = k * 2 * np.pi / 5
            b.box(
                (0.03, 0.05, r - 0.08),
                (0.04 * np.cos(a), y, r + 0.04 * np.sin(a)),
                "light grey",
                (0, 90 - float(np.degrees(a)), 0),
            )
        angles = np.radians(np.linspace(20, 160, 7))
        fender = np.array(
            [[((r + 0.03) * np.cos(a), y + d, r + (r + 0.03) * np.sin(a)) for d in (-0.05, 0.05)] for a in angles]
        )
        b.sheet(fender, color, both_sides=True)
        b.box((0.30, 0.16, 0.012), (0, side * 0.12, r + 0.045), "black")
    b.box((0.40, 0.44, 0.14), (0, 0, r - 0.10), color, bevel=0.04)
    top = (1.16, 1.22, 0.80)[variant]
    b.tube([(0.16, 0, r), (0.20, 0, r + 0.25), (0.10, 0, top)], [0.04, 0.028, 0.022], "dark grey", sides=8)
    if variant == 2:  # the small one, steered with the knees
        for side in (-1, 1):
            b.ball((0.06, 0.05, 0.11), (0.10, side * 0.06, top), "black", segments=8, rings=6)
    else:
        path = [
            (-0.02, 0.26, top + 0.02),
            (0.10, 0.14, top + 0.02),
            (0.12, 0, top - 0.04),
            (0.10, -0.14, top + 0.02),
            (-0.02, -0.26, top + 0.02),
        ]
        b.tube(path, [0.02, 0.017, 0.02, 0.017, 0.02], "black", sides=6)
        b.box((0.06, 0.10, 0.04), (0.12, 0, top - 0.02), "black", bevel=0.01)
        if variant == 1:
            b.box((0.14, 0.26, 0.20), (0.22, 0, top - 0.35), "charcoal", bevel=0.03)
    names = ("A grey two-wheeled personal transporter", "A black segway with a bag", "A white knee-steered segway")
    size = ((0.63, 0.60, 1.20), (0.68, 0.64, 1.28), (0.55, 0.57, 0.92))[variant]
    return fitted(b.build(names[variant], {"wheel_radius": r}), size)


@recipe("snowmobile", 2, name="small_vehicles.snowmobile")
def snowmobile(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.45)
    color = ("signal yellow", "#2468b0")[variant]
    track = [(-1.45, 0.25), (-1.25, 0.05), (0.35, 0.02), (0.55, 0.2), (0.35, 0.42), (-1.2, 0.46), (-1.4, 0.40)]
    b.profile(track, 0.40, (0, 0, 0), "rubber")
    for k in range(12):
        b.box((0.03, 0.40, 0.05), (-1.2 + 0.13 * k, 0, 0.0), "rubber")
    tunnel = [(-1.35, 0.48), (0.3, 0.45), (0.3, 0.62), (-1.35, 0.58)]
    b.profile(tunnel, 0.46, (0, 0, 0), "aluminium")
    seat = [(-1.2, 0.60), (0.15, 0.62), (0.1, 0.80), (-0.5, 0.82), (-1.15, 0.92)]
    b.profile(seat, 0.34, (0, 0, 0), "black")
    sections = []
    for x, half, low, high in (
        (0.0, 0.26, 0.42, 0.85),
        (0.4, 0.36, 0.30, 0.98),
        (0.9, 0.36, 0.30, 0.86),
        (1.3, 0.22, 0.38, 0.62),
        (1.42, 0.08, 0.44, 0.54),
    ):
        a = np.arange(10) * 2 * np.pi / 10
        sections.append(
            np.stack([np.full(10, x), half * np.cos(a), (low + high) / 2 + (high - low) / 2 * np.sin(a)], 1)
        )
    b.loft(sections, color, crease_deg=55)
    glass = np.array(
        [[(0.62 - 0.10 * k, y, 0.92 + 0.16 * k) for y in (-0.28 + 0.05 * k, 0, 0.28 - 0.05 * k)] for k in range(3)]
    )
    glass[:, 1, 0] += 0.10
    b.sheet(glass, "dark glass", both_sides=True)
    handlebar(b, 0.22, 1.06, 0.36)
    b.rod((0.5, 0, 0.8), (0.22, 0, 1.06), 0.025, "black", sides=6)
    for side in (-1, 1):
        y = side * 0.48
        ski = [(0.35, 0.03), (1.35, 0.03), (1.55, 0.20), (1.50, 0.22), (1.30, 0.08), (0.35, 0.07)]
        b.profile(ski, 0.14, (0, y, 0), "black")
        b.rod((0.95, y, 0.06), (0.85, side * 0.30, 0.50), 0.035, "dark grey", sides=6)
        b.rod((0.70, side * 0.2, 0.35), (0.95, y, 0.20), 0.025, "dark grey", sides=5)
        b.ball((0.06, 0.12, 0.06), (1.22, side * 0.14, 0.66), "lamp", segments=8, rings=5)
        b.box((0.7, 0.16, 0.04), (-0.15, side * 0.30, 0.38), "black")
    b.box((0.04, 0.3, 0.08), (-1.36, 0, 0.62), "red")
    names = ("A yellow snowmobile", "A blue snowmobile")
    return fitted(b.build(names[variant], {"color": color}), ((3.0, 1.15, 1.25), (3.2, 1.2, 1.32))[variant])


@recipe("unicycle", 3, name="small_vehicles.unicycle")
def unicycle(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.5)
    color: Color = ("signal red", "aluminium", "signal blue")[variant]
    r = (0.255, 0.33, 0.22)[variant]
    spoked_wheel(b, (0, 0, r), r, 0.024, "aluminium", 12)
    seat = (0.95, 1.08, 0.80)[variant]
    for side in (-1, 1):
        b.tube(
            [(0, side * 0.055, r), (0, side * 0.05, 2 * r + 0.02), (0, side * 0.012, 2 * r + 0.09)],
            0.014,
            color,
            sides=6,
        )
        end = (side * 0.12, side * 0.10, r - side * 0.05)
        b.beam((0, side * 0.085, r), (end[0], side * 0.085, end[2]), 0.02, 0.014, "aluminium")
        b.box((0.10, 0.10, 0.025), (end[0], side * 0.14, end[2] - 0.012), "black", bevel=0.005)
    b.rod((0, 0, 2 * r + 0.05), (0, 0, seat - 0.06), 0.016, color, sides=8)
    b.cylinder(0.022, 0.04, (0, 0, 2 * r + 0.10), "black", segments=8)
    saddle = [
        (0.15, 0.045, 0.02),
        (0.09, 0.055, -0.015),
        (0.0, 0.045, -0.028),
        (-0.09, 0.07, -0.01),
        (-0.16, 0.08, 0.03),
    ]
    sections = [
        np.array([(x, w * np.cos(a), seat - 0.03 + z + 0.03 * np.sin(a)) for a in np.arange(8) * np.pi / 4])
        for x, w, z in saddle[::-1]
    ]
    b.loft(sections, shade(color, 0.35) if variant != 2 else "black", crease_deg=60)
    names = ("A red unicycle", "A tall aluminium unicycle", "A small blue unicycle")
    size = ((0.54, 0.36, 0.95), (0.70, 0.38, 1.10), (0.46, 0.34, 0.78))[variant]
    return fitted(b.build(names[variant], {"wheel_radius": r}), size)
