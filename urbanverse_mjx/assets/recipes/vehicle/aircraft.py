"""Aircraft: airplanes, helicopters, drones, balloons."""

import numpy as np

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, rgb, shade
from ...meshes.recipe import recipe
from ...meshes.shapes import Point2, Point3
from ..shared.sizes import fitted
from ..street_user.animals import ring


def wing(b: MeshBuilder, plan: tuple[Point2, ...], z: float, thickness: float, dihedral: float, color: Color) -> None:
    """Both wings: `plan` = (x, y) of the left one's corners, counter-clockwise from above; tips rise by `dihedral`."""
    for side in (-1, 1):
        points = []
        for x, y in plan:
            thin = thickness * (1.0 if y < 0.6 * max(p[1] for p in plan) else 0.5)
            for dz in (-thin / 2, thin / 2):
                points.append((x, side * y, z + dihedral * y + dz))
        b.convex(points, color)


def fin(b: MeshBuilder, side_view: tuple[Point2, ...], thickness: float, color: Color, y: float = 0.0) -> None:
    b.profile(side_view, thickness, (0, y, 0), color)


def windows_row(b: MeshBuilder, x0: float, x1: float, y: float, z: float, count: int, size: Point2) -> None:
    for k in range(count):
        x = x0 + (x1 - x0) * k / max(count - 1, 1)
        for side in (-1, 1):
            b.box((size[0], 0.02, size[1]), (x, side * y, z), "dark glass", centered=True)


def landing_wheel(b: MeshBuilder, at: Point3, radius: float, top: float) -> None:
    x, y, _ = at
    b.cylinder(radius, radius * 0.6, (x, y + radius * 0.3, radius), "rubber", (90, 0, 0), segments=12)
    b.rod((x, y, radius), (x, y, top), radius * 0.2, "aluminium", sides=5)


@recipe("airplane", 3, name="aircraft.airplane")
def airplane(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.35)
    if variant == 1:
        return fitted(_airliner(b), (37.5, 34.0, 11.8))
    if variant == 2:
        return fitted(_light_plane(b), (8.2, 10.9, 2.7))
    # A business jet.
    rows = [
        (7.0, 1.55, 0.05, 0.05),
        (6.4, 1.6, 0.42, 0.42),
        (5.2, 1.75, 0.75, 0.80),
        (3.5, 1.85, 0.85, 0.92),
        (-3.0, 1.85, 0.85, 0.92),
        (-5.2, 2.05, 0.55, 0.62),
        (-6.8, 2.3, 0.12, 0.16),
    ]
    b.loft([ring(*row, points=14) for row in reversed(rows)], "white", crease_deg=60)
    wing(b, ((1.2, 0.3), (-1.4, 0.3), (-2.6, 6.5), (-1.8, 6.5)), 1.35, 0.22, 0.05, "light grey")
    wing(b, ((-6.2, 0.0), (-7.1, 0.0), (-7.6, 2.4), (-7.0, 2.4)), 4.1, 0.10, 0.0, "light grey")
    fin(b, ((-4.8, 2.5), (-6.9, 2.4), (-7.4, 4.2), (-6.3, 4.2)), 0.16, "signal blue")
    windows_row(b, 3.0, -1.8, 0.845, 2.05, 6, (0.32, 0.42))
    b.box((10.5, 1.72, 0.10), (-0.2, 0, 1.55), "signal blue", centered=True)
    b.convex(
        [(5.75, y, z) for y in (-0.55, 0.55) for z in (2.02, 2.1)]
        + [(5.0, y, 2.55) for y in (-0.45, 0.45)]
        + [(4.9, y, 2.25) for y in (-0.78, 0.78)],
        "dark glass",
    )
    for side in (-1, 1):
        with b.frame((-4.8, side * 1.25, 2.35), (0, 90, 0)):
            b.lathe(
                [(0.30, 0), (0.42, 0.5), (0.44, 1.6), (0.36, 2.1), (0.30, 2.1), (0.28, 1.8)],
                color="light grey",
                segments=14,
            )
        b.box((1.2, 0.6, 0.14), (-3.9, side * 0.9, 2.3), "white", centered=True)
        landing_wheel(b, (-0.8, side * 1.2, 0), 0.32, 1.3)
    landing_wheel(b, (5.0, 0, 0), 0.26, 1.1)
    return fitted(b.build("A white business jet with a blue line", {"kind": "jet"}), (14.2, 13.0, 4.25))


def _airliner(b: MeshBuilder) -> BuiltAsset:
    rows = [
        (18.8, 3.6, 0.1, 0.1),
        (17.8, 3.75, 1.1, 1.05),
        (15.8, 4.0, 1.75, 1.8),
        (13.0, 4.1, 1.95, 2.0),
        (-8.0, 4.1, 1.95, 2.0),
        (-14.0, 4.7, 1.2, 1.3),
        (-18.8, 5.4, 0.2, 0.3),
    ]
    b.loft([ring(*row, points=16) for row in reversed(rows)], "white", crease_deg=60)
    wing(b, ((5.0, 0.5), (-2.2, 0.5), (-3.0, 5.5), (-5.8, 17.0), (-4.4, 17.0)), 3.0, 0.6, 0.09, "light grey")
    wing(b, ((-14.6, 0.3), (-17.0, 0.3), (-18.4, 6.2), (-17.3, 6.2)), 5.1, 0.3, 0.08, "light grey")
    fin(b, ((-12.6, 5.8), (-17.4, 5.6), (-19.0, 11.8), (-17.0, 11.8)), 0.4, "signal red")
    windows_row(b, 13.0, -11.5, 1.93, 4.5, 28, (0.28, 0.4))
    for x in (14.2, -12.6):
        for side in (-1, 1):
            b.box(
                (0.9, 0.06, 1.8), (x, side * (1.92 if x > 0 else 1.42), 4.15 if x > 0 else 4.5), "grey", centered=True
            )
    b.convex(
        [(17.0, y, 4.35) for y in (-1.15, 1.15)]
        + [(17.5, y, 4.25) for y in (-0.8, 0.8)]
        + [(16.3, y, 5.1) for y in (-0.95, 0.95)]
        + [(17.75, 0, 4.3)],
        "dark glass",
    )
    image, pen = paint.canvas((384, 48), "white")
    paint.text(pen, "AIR MERIDIAN", (6, 4, 378, 44), "signal red", 0.04)
    for side, facing in ((1, "+y"), (-1, "-y")):
        b.panel(np.asarray(paint.shrunk(image, (192, 24))), (8.6, side * 1.80, 5.05), 8.0, 1.0, facing, tilt_deg=26)
        with b.frame((2.6, side * 5.4, 2.0), (0, 90, 0)):
            b.lathe(
                [(0.5, -2.4), (0.95, -1.0), (1.08, 1.2), (0.98, 1.6), (0.85, 1.55), (0.30, 1.2), (0.02, 1.45)],
                color="signal red",
                segments=16,
            )
        b.box((3.0, 0.25, 1.2), (1.2, side * 5.4, 2.9), "white", centered=True)
        for dx in (-0.5, 0.6):
            landing_wheel(b, (-1.0 + dx, side * 2.8, 0), 0.55, 2.8)
        b.convex(
            [
                (-5.0, side * 17.0, 4.5),
                (-5.8, side * 17.0, 4.5),
                (-6.4, side * 17.3, 6.3),
                (-5.9, side * 17.3, 6.3),
                (-5.4, side * 17.2, 4.5),
            ],
            "signal red",
        )
    landing_wheel(b, (14.5, 0.3, 0), 0.42, 2.4)
    landing_wheel(b, (14.5, -0.3, 0), 0.42, 2.4)
    return b.build("A white airliner with red tail and engines", {"kind": "airliner"})


def _light_plane(b: MeshBuilder) -> BuiltAsset:
    rows = [
        (2.9, 1.25, 0.25, 0.28),
        (2.6, 1.25, 0.48, 0.45),
        (1.4, 1.32, 0.56, 0.55),
        (0.9, 1.5, 0.56, 0.72),
        (-0.6, 1.5, 0.54, 0.70),
        (-1.6, 1.45, 0.40, 0.50),
        (-4.6, 1.55, 0.08, 0.14),
    ]
    b.loft([ring(*row, points=14) for row in reversed(rows)], "white", crease_deg=60)
    wing(b, ((1.1, 0.0), (-0.5, 0.0), (-0.35, 5.4), (0.75, 5.4)), 2.25, 0.2, 0.02, "white")
    wing(b, ((-3.9, 0.0), (-4.7, 0.0), (-4.7, 1.7), (-4.2, 1.7)), 1.6, 0.08, 0.0, "white")
    fin(b, ((-3.3, 1.6), (-4.7, 1.6), (-5.0, 2.75), (-4.4, 2.75)), 0.10, "signal red")
    b.box((6.0, 1.0, 0.12), (-1.0, 0, 1.35), "signal red", centered=True)
    for side in (-1, 1):
        b.beam((0.5, side * 0.5, 1.0), (0.3, side * 2.6, 2.25), 0.06, 0.10, "white")
        b.box((0.95, 0.03, 0.42), (0.55, side * 0.55, 1.80), "dark glass", centered=True)
        b.box((0.7, 0.03, 0.38), (-0.5, side * 0.52, 1.78), "dark glass", centered=True)
        b.rod((0.1, side * 0.4, 0.95), (0.0, side * 1.15, 0.22), 0.05, "white", sides=5)
        landing_wheel(b, (0.0, side * 1.18, 0), 0.24, 0.3)
    b.convex(
        [(1.35, y, 1.85) for y in (-0.48, 0.48)]
        + [(0.98, y, 2.2) for y in (-0.42, 0.42)]
        + [(0.9, y, 1.85) for y in (-0.52, 0.52)],
        "dark glass",
    )
    landing_wheel(b, (2.3, 0, 0), 0.2, 0.9)
    with b.frame((2.92, 0, 1.25), (0, 90, 0)):
        b.lathe([(0.16, 0), (0.14, 0.12), (0.02, 0.30)], color="signal red", segments=12)
    b.box((0.05, 0.16, 0.9), (2.98, 0, 1.25), "charcoal", (20, 0, 0))
    b.box((0.05, 0.16, 0.9), (2.98, 0, 1.25), "charcoal", (200, 0, 0))
    return b.build("A white high-winged light aircraft", {"kind": "light"})


@recipe("helicopter", 3, name="aircraft.helicopter")
def helicopter(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.4)
    color, band, words = (
        ("signal red", "white", "RESCUE"),
        ("#244a86", "signal yellow", "POLICE"),
        ("signal yellow", "signal red", "MEDIC"),
    )[variant]
    rows = [
        (3.0, 1.15, 0.12, 0.15),
        (2.7, 1.2, 0.55, 0.5),
        (2.0, 1.4, 0.85, 0.85),
        (1.0, 1.55, 0.95, 1.0),
        (-0.8, 1.6, 0.92, 0.95),
        (-1.9, 1.85, 0.55, 0.55),
        (-2.6, 2.0, 0.30, 0.30),
    ]
    b.loft([ring(*row, points=14) for row in reversed(rows)], color, crease_deg=60)
    nose = [(2.93, 1.35, 0.32, 0.28), (2.55, 1.55, 0.60, 0.42), (1.95, 1.75, 0.86, 0.52), (1.5, 1.9, 0.90, 0.55)]
    b.loft([ring(*row, points=14) for row in reversed(nose)], "dark glass", crease_deg=60)
    b.tube([(-2.2, 0, 1.95), (-5.6, 0, 2.15)], [0.30, 0.14], color, sides=10)
    fin(b, ((-5.1, 1.9), (-5.7, 1.6), (-6.3, 3.1), (-5.8, 3.1)), 0.10, band)
    wing(b, ((-4.6, 0.0), (-5.1, 0.0), (-5.1, 1.1), (-4.75, 1.1)), 2.1, 0.07, 0.0, band)
    b.box((2.4, 0.9, 0.55), (-0.5, 0, 2.35), shade(color, 0.9), bevel=0.2)
    b.cylinder(0.10, 0.75, (-0.2, 0, 2.7), "charcoal", segments=10)
    b.cylinder(0.28, 0.14, (-0.2, 0, 3.32), "charcoal", segments=12)
    for k in range(4):
        with b.frame((-0.2, 0, 3.39), (0, 0, 45 + 90 * k)):
            b.box((5.2, 0.32, 0.04), (2.7, 0, 0), "charcoal", (0, 0, 0))
            b.box((0.3, 0.33, 0.042), (5.2, 0, 0), "signal yellow")
    for k in range(2):  # the tail rotor
        with b.frame((-5.85, 0.16, 2.35), (0, 40 + 90 * k, 0)):
            b.box((1.7, 0.03, 0.14), color="charcoal", centered=True)
    image, pen = paint.canvas((192, 48), band)
    paint.text(pen, words, (6, 4, 186, 44), color, 0.05)
    for side, facing in ((1, "+y"), (-1, "-y")):
        b.panel(np.asarray(paint.shrunk(image, (96, 24))), (-0.1, side * 0.965, 1.25), 1.8, 0.42, facing)
        for x, w in ((0.75, 0.75), (-0.25, 0.7)):
            b.box((w, 0.04, 0.5), (x, side * 0.94, 1.9), "dark glass", centered=True)
        for x in (1.2, -0.9):
            b.tube([(x, side * 0.6, 0.8), (x, side * 1.1, 0.45), (x, side * 1.15, 0.06)], 0.05, "charcoal", sides=6)
        b.tube(
            [(2.3, side * 1.15, 0.22), (1.9, side * 1.15, 0.06), (-1.7, side * 1.15, 0.06)], 0.06, "charcoal", sides=6
        )
    names = ("A red rescue helicopter", "A blue police helicopter", "A yellow air ambulance")
    size = ((12.4, 8.5, 3.6), (11.0, 8.2, 3.3), (13.0, 9.5, 3.9))[variant]
    return fitted(b.build(names[variant], {"words": words}), size)


@recipe("drone", 3, name="aircraft.drone")
def drone(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.4)
    color, accent = (("light grey", "charcoal"), ("black", "signal red"), ("white", "signal blue"))[variant]
    arms = 4 if variant != 2 else 6
    body = [
        (0.085, 0.045, 0.01, 0.012),
        (0.07, 0.05, 0.03, 0.022),
        (0.0, 0.055, 0.042, 0.032),
        (-0.07, 0.055, 0.036, 0.028),
        (-0.10, 0.05, 0.02, 0.012),
    ]
    b.loft([ring(*row, points=12) for row in reversed(body)], color, crease_deg=55)
    for k in range(arms):
        a = np.pi / 4 + k * np.pi / 2 if arms == 4 else k * np.pi / 3 + np.pi / 6
        tip = np.array([0.145 * np.cos(a), 0.145 * np.sin(a), 0.065])
        b.beam((0.04 * np.cos(a), 0.03 * np.sin(a), 0.055), tuple(tip), 0.016, 0.012, color)
        b.cylinder(0.014, 0.028, (tip[0], tip[1], 0.055), accent, segments=10)
        for turn in (30 + 40 * k, 210 + 40 * k):
            with b.frame((tip[0], tip[1], 0.086), (0, 0, turn)):
                b.convex(
                    [
                        (0.0, -0.004, 0),
                        (0.0, 0.004, 0.002),
                        (0.03, 0.010, 0.003),
                        (0.03, -0.006, 0),
                        (0.062, 0.004, 0.002),
                        (0.062, -0.003, 0.0),
                        (0.02, 0.0, 0.004),
                    ],
                    accent,
                )
        if arms == 4:
            b.rod(tuple(tip - [0, 0, 0.01]), (tip[0] * 1.02, tip[1] * 1.02, 0.0), 0.006, color, sides=5)
            b.ball(0.006, (tip[0], tip[1], 0.05), "light red" if tip[0] < 0 else "light green", segments=6, rings=4)
    if variant == 2:  # skids, and a parcel between them
        for side in (-1, 1):
            b.tube(
                [(0.0, side * 0.04, 0.04), (0.0, side * 0.07, -0.06), (0.06, side * 0.07, -0.065)],
                0.006,
                accent,
                sides=5,
            )
            b.rod((-0.07, side * 0.07, -0.063), (0.07, side * 0.07, -0.063), 0.006, accent, sides=5)
        b.box((0.10, 0.085, 0.065), (0, 0, -0.045), "cardboard", bevel=0.003)
        b.box((0.102, 0.018, 0.067), (0, 0, -0.046), "beige")
    else:  # the camera on its gimbal
        b.box((0.02, 0.04, 0.02), (0.075, 0, 0.02), accent, bevel=0.004)
        b.ball(0.017, (0.09, 0, 0.018), "black", segments=9, rings=6)
        b.cylinder(0.009, 0.008, (0.102, 0, 0.018), "dark glass", (0, 90, 0), segments=9)
    names = ("A grey camera drone", "A black and red quadcopter", "A white delivery drone with a parcel")
    size = ((0.38, 0.37, 0.128), (0.34, 0.33, 0.10), (1.1, 1.0, 0.48))[variant]
    return fitted(b.build(names[variant], {"arms": arms}), size)


@recipe("hot-air balloon", 3, name="aircraft.hot_air_balloon")
def hot_air_balloon(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.85)
    colors = (("signal red", "signal yellow"), ("signal blue", "white"), ("#7a3f98", "orange"))[variant]
    profile = [
        (0.9, 5.2),
        (2.2, 6.6),
        (5.0, 9.6),
        (7.6, 13.0),
        (8.7, 16.2),
        (8.2, 19.0),
        (6.2, 21.0),
        (3.2, 22.0),
        (0.05, 22.3),
    ]
    image, pen = paint.canvas((384, 96), colors[0])
    if variant == 2:  # bands round the envelope instead of gores
        for k in range(5):
            pen.rectangle(
                (0, 12 + 18 * k, 384, 20 + 18 * k), fill=rgb(("orange", "signal yellow", "signal red")[k % 3])
            )
    else:
        for k in range(12):
            pen.rectangle((32 * k, 0, 32 * k + 15, 96), fill=rgb(colors[1]))
        pen.rectangle((0, 40, 384, 52), fill=rgb("white" if variant == 0 else "signal yellow"))
    a = np.linspace(0, 2 * np.pi, 25)
    grid = np.array([[(r * np.cos(t), r * np.sin(t), z) for t in a] for r, z in profile])
    b.lathe([(r * 0.985, z) for r, z in profile], color="charcoal", segments=16)
    b.sheet(grid, image=np.asarray(paint.shrunk(image, (192, 48))))
    b.box((1.5, 1.2, 1.1), (0, 0, 0), "#8a5c30", bevel=0.06)
    b.box((1.6, 1.3, 0.12), (0, 0, 1.05), "dark wood", bevel=0.04)
    for k in range(5):
        b.box((1.52, 1.22, 0.03), (0, 0, 0.15 + 0.2 * k), "#6d4522")
    for x in (-0.65, 0.65):
        for y in (-0.5, 0.5):
            b.rod((x, y, 1.1), (x * 0.8, y * 0.8, 2.9), 0.035, "aluminium", sides=5)
            b.rod((x * 0.8, y * 0.8, 2.9), (x * 1.0, y * 1.2, 5.2), 0.02, "black", sides=4)
    b.box((0.9, 0.7, 0.12), (0, 0, 2.85), "aluminium")
    b.cylinder(0.18, 0.4, (0, 0, 2.95), "galvanised", segments=10)
    b.cone(0.12, 1.1, (0, 0, 3.35), "amber", segments=8)
    for y in (-0.2, 0.2):
        b.ball((0.12, 0.12, 0.15), (0.1, y, 1.55), "skin light", segments=8, rings=6)
        b.box((0.25, 0.3, 0.45), (0.1, y * 1.4, 1.0), ("signal blue", "dark red")[y > 0], bevel=0.06)
    names = (
        "A red and yellow hot-air balloon",
        "A blue and white hot-air balloon",
        "A purple hot-air balloon with bands",
    )
    size = ((17.5, 17.5, 22.3), (19.0, 19.0, 24.0), (15.5, 15.5, 20.5))[variant]
    return fitted(b.build(names[variant], {"colors": list(colors)}), size)
