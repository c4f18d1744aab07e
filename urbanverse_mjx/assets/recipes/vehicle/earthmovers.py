"""Machines of building sites: excavator, bulldozer, roller, forklift, tractor, crane."""

import numpy as np

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import recipe
from ..shared.sizes import fitted
from .armoured_vehicles import tracks
from .carts import solid_wheel
from .road_service import farm_wheel
from .service_trucks import blade, light_bar
from .wheels import road_wheels


def glass_cab(b: MeshBuilder, at: tuple[float, float, float], size: tuple[float, float, float], color: Color) -> None:
    """A driver's cab: dark glass between painted posts, a sill and a roof; `at` is the centre of its floor."""
    x, y, z = at
    length, width, height = size
    b.box((length * 0.94, width * 0.94, height), (x, y, z), "dark glass")
    b.box((length, width, height * 0.28), (x, y, z), color)
    b.box((length * 1.08, width * 1.06, height * 0.07), (x, y, z + height), color, bevel=0.02)
    for dx in (-0.5, 0.5):
        for dy in (-0.5, 0.5):
            post = (x + dx * (length - 0.07), y + dy * (width - 0.07), z)
            b.box((0.08, 0.08, height), post, color)


def arm(
    b: MeshBuilder, points: list[tuple[float, float]], depths: list[float], width: float, color: Color, y: float = 0.0
) -> None:
    """A boom drawn in (x, z) as a band round its middle line, `depths` wide at each point."""
    p = np.array(points)
    tangent = np.gradient(p, axis=0)
    normal = np.stack([-tangent[:, 1], tangent[:, 0]], 1) / np.linalg.norm(tangent, axis=1, keepdims=True)
    half = np.array(depths)[:, None] / 2
    outline = np.concatenate([p + normal * half, (p - normal * half)[::-1]])
    b.profile([tuple(v) for v in outline], width, (0, y, 0), color)


@recipe("excavator", 3, name="earthmovers.excavator")
def excavator(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.55)
    color = ("#f0b01c", "safety orange", "#e8c020")[variant]
    dark = "charcoal"
    if variant == 1:  # a wheeled one
        for x in (-1.1, 1.2):
            for side in (-1, 1):
                solid_wheel(b, (x, side * 0.98, 0.5), 0.5, 0.42, "light grey")
        b.box((3.1, 1.2, 0.4), (0, 0, 0.45), "dark grey")
        blade(b, -1.95, 2.3, 0.5, color, 180)
    else:
        tracks(b, 3.7, 0.85, 0.55, 1.95, 6)
        b.box((2.2, 1.4, 0.4), (0, 0, 0.45), dark)
    b.cylinder(0.75, 0.25, (0, 0, 0.82), dark, segments=16)
    # The upper carriage: engine, counterweight, cab on the left, boom in the middle.
    b.box((3.0, 2.4, 0.25), (-0.5, 0, 1.05), color)
    b.box((1.5, 2.4, 0.85), (-1.1, 0, 1.25), color, bevel=0.08)
    b.box((0.55, 2.5, 1.0), (-2.1, 0, 1.05), shade(color, 0.4), bevel=0.15)
    b.box((1.3, 0.8, 0.5), (0.3, -0.78, 1.25), color, bevel=0.05)
    glass_cab(b, (0.35, 0.72, 1.28), (1.35, 0.9, 1.45), color)
    b.cylinder(0.07, 0.45, (-1.3, -0.5, 2.05), "black", segments=8)
    for side, facing in ((1, "+y"), (-1, "-y")):
        b.panel(paint.lettering("DIGGER 210", color, "black", (64, 12)), (-1.1, side * 1.205, 1.65), 1.2, 0.24, facing)
    boom = [(0.55, 1.45), (1.3, 2.75), (2.2, 3.35), (3.2, 3.25), (4.4, 2.55)]
    arm(b, boom, [0.35, 0.45, 0.62, 0.45, 0.28], 0.36, color)
    stick = [(4.15, 3.05), (4.5, 2.55), (4.2, 0.85)]
    arm(b, stick, [0.25, 0.45, 0.22], 0.28, color)
    for a, c in (((0.9, 1.3), (2.0, 2.9)), ((2.4, 3.6), (4.1, 3.1))):
        for side in (-0.22, 0.22) if a[0] < 1 else (0.0,):
            b.rod((a[0], side, a[1]), ((a[0] + c[0]) / 2, side, (a[1] + c[1]) / 2), 0.09, dark, sides=7)
            b.rod((a[0], side, a[1]), (c[0], side, c[1]), 0.055, "aluminium", sides=6)
    bucket = [(4.25, 1.0), (4.05, 0.55), (3.65, 0.25), (3.3, 0.3), (3.25, 0.42), (3.55, 0.42), (3.8, 0.65), (3.95, 1.0)]
    b.profile(bucket, 1.0, (0, 0, 0), dark)
    for side in (-0.48, 0.48):
        b.profile([(4.25, 1.0), (4.05, 0.55), (3.65, 0.25), (3.3, 0.3), (3.9, 1.0)], 0.05, (0, side, 0), dark)
    for k in range(5):
        b.convex(
            [(3.35, -0.42 + 0.21 * k + dy, z) for dy in (-0.04, 0.04) for z in (0.28, 0.38)]
            + [(3.08, -0.42 + 0.21 * k, 0.36)],
            "galvanised",
        )
    names = ("A yellow tracked excavator", "An orange wheeled excavator", "A yellow mini excavator")
    size = ((7.8, 2.55, 3.05), (7.4, 2.5, 3.15), (4.2, 1.55, 2.4))[variant]
    return fitted(b.build(names[variant], {"kind": ("tracked", "wheeled", "mini")[variant]}), size)


@recipe("bulldozer", 3, name="earthmovers.bulldozer")
def bulldozer(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.55)
    color = ("#f0b01c", "#e8c020", "#d98a1e")[variant]
    tracks(b, 3.4, 1.05, 0.58, 1.9, 6)
    hood = [(-0.1, 0.75), (1.75, 0.75), (1.75, 1.75), (-0.1, 1.95)]
    b.profile(hood, 1.05, (0, 0, 0), color)
    b.box((0.06, 0.9, 0.8), (1.76, 0, 0.85), "black")
    b.cylinder(0.08, 0.75, (1.0, 0.2, 1.8), "black", segments=8)
    b.cylinder(0.12, 0.3, (0.5, -0.25, 1.85), "charcoal", segments=8)
    b.box((1.6, 1.3, 0.75), (-0.95, 0, 0.85), color, bevel=0.05)
    for side in (-1, 1):
        b.box((1.9, 0.5, 0.10), (-0.8, side * 0.9, 1.12), color)
    if variant != 2:
        glass_cab(b, (-0.75, 0, 1.5), (1.3, 1.4, 1.35), color)
    else:
        b.box((1.5, 1.6, 0.1), (-0.75, 0, 2.75), color, bevel=0.03)
        for x in (-1.35, -0.15):
            for side in (-1, 1):
                b.box((0.1, 0.1, 1.3), (x, side * 0.7, 1.5), color)
        b.box((0.5, 0.6, 0.6), (-1.0, 0, 1.55), "black", bevel=0.06)
    blade(b, 2.75, 3.1, 1.15, shade(color, 0.9), 0)
    for side in (-1, 1):
        b.beam((-0.4, side * 1.35, 0.55), (2.5, side * 1.35, 0.4), 0.16, 0.24, color)
        b.rod((1.7, side * 0.45, 1.3), (2.5, side * 0.5, 0.7), 0.06, "aluminium", sides=6)
    b.box((0.5, 1.6, 0.3), (-1.95, 0, 0.75), "dark grey")
    for y in (-0.65, 0.0, 0.65):  # the ripper's teeth
        b.profile([(-1.9, 0.95), (-2.35, 0.95), (-2.4, 0.15), (-2.15, 0.05), (-2.2, 0.6)], 0.14, (0, y, 0), "charcoal")
    names = ("A yellow bulldozer with a ripper", "A yellow crawler dozer", "An old orange bulldozer with an open cab")
    size = ((5.4, 3.15, 3.1), (6.2, 3.4, 3.4), (4.6, 2.7, 2.8))[variant]
    return fitted(b.build(names[variant], {"cab": variant != 2}), size)


def drum(b: MeshBuilder, x: float, radius: float, width: float, color: Color = "galvanised") -> None:
    b.cylinder(radius, width, (x, width / 2, radius), color, (90, 0, 0), segments=24)
    for side in (-1, 1):
        b.cylinder(
            radius * 0.5, 0.02, (x, side * (width / 2 + 0.01) + 0.01, radius), "dark grey", (90, 0, 0), segments=16
        )


@recipe("road roller", 3, name="earthmovers.road_roller")
def road_roller(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.5)
    color = ("#f0b01c", "safety orange", "#3f8f5a")[variant]
    if variant == 1:  # a tandem roller
        for x in (-1.0, 1.0):
            drum(b, x, 0.45, 1.2)
            for side in (-1, 1):
                b.box((1.0, 0.08, 0.14), (x, side * 0.66, 0.42), color)
            b.box((0.95, 1.4, 0.22), (x * 1.02, 0, 0.92), color, bevel=0.05)
        b.box((2.2, 1.0, 0.55), (0, 0, 0.75), color, bevel=0.08)
        b.box((0.5, 0.5, 0.55), (-0.1, 0, 1.2), "black", (0, -6, 0), bevel=0.08)
        b.rod((0.6, 0, 1.2), (0.4, 0, 1.75), 0.03, "black", sides=6)
        b.ring(0.18, 0.02, (0.38, 0, 1.78), "black", (0, -20, 0), 14, 5)
        b.tube([(-0.6, 0.5, 1.2), (-0.6, 0.5, 2.35), (-0.6, -0.5, 2.35), (-0.6, -0.5, 1.2)], 0.045, color, sides=6)
        return fitted(b.build("An orange tandem roller", {"kind": "tandem"}), (2.7, 1.35, 2.2))
    drum(b, 1.45, 0.75, 2.0 if variant == 0 else 1.6)
    wide = 1.12 if variant == 0 else 0.92
    for side in (-1, 1):
        b.box((2.1, 0.12, 0.3), (1.35, side * wide, 0.62), color)
        farm_wheel(b, (-1.35, side * 0.72, 0.72), 0.72, 0.5, color)
    for x in (0.4, 2.35):
        b.box((0.16, 2 * wide, 0.35), (x, 0, 0.6), color)
    b.box((1.7, 1.0, 0.85), (-1.6, 0, 0.9), color, bevel=0.12)
    b.box((0.9, 1.0, 0.5), (-0.3, 0, 0.7), "dark grey")
    b.box((1.2, 1.4, 0.3), (-0.35, 0, 1.15), color)
    if variant == 0:
        glass_cab(b, (-0.35, 0, 1.4), (1.2, 1.35, 1.35), color)
    else:
        for side in (-1, 1):
            b.tube(
                [(0.2, side * 0.6, 1.4), (0.15, side * 0.6, 2.7), (-0.9, side * 0.6, 2.7), (-0.95, side * 0.6, 1.4)],
                0.05,
                "black",
                sides=6,
            )
        b.box((1.4, 1.4, 0.08), (-0.4, 0, 2.7), color)
        b.box((0.45, 0.5, 0.6), (-0.6, 0, 1.4), "black", bevel=0.06)
        b.ring(0.18, 0.02, (-0.05, 0, 1.95), "black", (0, -30, 0), 14, 5)
    b.cylinder(0.08, 0.14, (-0.4, 0, 2.85 if variant == 0 else 2.78), "amber", segments=8)
    names = ("A yellow single-drum road roller", "", "A green road roller with an open canopy")
    size = ((4.6, 1.85, 2.85), (0, 0, 0), (5.0, 2.0, 2.95))[variant]
    return fitted(b.build(names[variant], {"kind": "single drum"}), size)


@recipe("forklift", 3, name="earthmovers.forklift")
def forklift(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.5)
    color = ("signal yellow", "signal red", "#2f8f46")[variant]
    for side in (-1, 1):
        solid_wheel(b, (0.62, side * 0.46, 0.30), 0.30, 0.22, color)
        solid_wheel(b, (-0.72, side * 0.42, 0.24), 0.24, 0.18, color)
    body = [(-1.15, 0.25), (0.75, 0.2), (0.75, 0.62), (0.25, 0.62), (0.1, 0.95), (-1.1, 1.05), (-1.2, 0.9)]
    b.profile(body, 1.05, (0, 0, 0), color)
    b.box((0.35, 1.12, 0.7), (-1.1, 0, 0.28), shade(color, 0.45), bevel=0.10)
    b.box((0.45, 0.5, 0.14), (-0.35, 0, 0.98), "black", bevel=0.03)
    b.box((0.12, 0.5, 0.5), (-0.58, 0, 1.05), "black", (0, -12, 0), bevel=0.03)
    b.rod((0.35, 0.0, 0.75), (0.12, 0.0, 1.2), 0.025, "black", sides=6)
    b.ring(0.16, 0.018, (0.10, 0.0, 1.23), "black", (0, -30, 0), 14, 5)
    for side in (-1, 1):  # the guard over the driver
        post = [
            (0.55, side * 0.45, 0.62),
            (0.30, side * 0.45, 2.08),
            (-0.75, side * 0.45, 2.08),
            (-0.95, side * 0.45, 1.0),
        ]
        b.tube(post, 0.04, "black", sides=6)
        b.box((0.10, 0.12, 2.15), (0.98, side * 0.30, 0.10), "charcoal")  # the mast
        b.box((1.1, 0.12, 0.045), (1.65, side * 0.25, 0.10), "charcoal")  # the forks
        b.box((0.05, 0.12, 0.55), (1.10, side * 0.25, 0.10), "charcoal")
        b.cylinder(0.07, 0.05, (0.58, side * 0.42, 1.35), "lamp", (0, 90, 0), segments=8)
    for k in range(5):
        b.box((0.03, 0.9, 0.04), (-0.62 + 0.22 * k, 0, 2.07), "black")
    for z in (0.5, 1.2, 2.15):
        b.box((0.08, 0.72, 0.09), (0.98, 0, z), "charcoal")
    for z in (0.22, 0.58):
        b.box((0.05, 0.95, 0.08), (1.08, 0, z), "charcoal")
    b.cylinder(0.05, 1.5, (0.94, 0, 0.3), "aluminium", segments=8)
    if variant == 1:  # carrying a crate on a pallet
        for y in (-0.45, 0, 0.45):
            b.box((1.0, 0.12, 0.10), (1.7, y, 0.15), "light wood")
        b.box((1.0, 1.05, 0.03), (1.7, 0, 0.25), "light wood")
        b.box((0.9, 0.95, 0.7), (1.7, 0, 0.28), "cardboard", bevel=0.02)
    if variant == 2:
        b.cylinder(0.15, 0.75, (-1.05, -0.38, 1.25), "light grey", (-90, 0, 0), segments=12)
    b.cylinder(0.06, 0.12, (-0.2, 0.3, 2.10), "amber", segments=8)
    names = ("A yellow forklift", "A red forklift with a crate", "A green gas-driven forklift")
    size = ((3.1, 1.16, 2.15), (3.2, 1.2, 2.2), (2.9, 1.12, 2.2))[variant]
    return fitted(b.build(names[variant], {"color": str(color)}), size)


@recipe("tractor", 3, name="earthmovers.tractor")
def tractor(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.5)
    color, rim = (("signal red", "off white"), ("#2f7d3a", "signal yellow"), ("#2d62a8", "off white"))[variant]
    for side in (-1, 1):
        farm_wheel(b, (-0.95, side * 0.76, 0.78), 0.78, 0.44, rim)
        farm_wheel(b, (1.15, side * 0.70, 0.46), 0.46, 0.30, rim)
        angles = np.radians(np.linspace(20, 165, 8))
        arch = [(-0.95 + 0.86 * np.cos(a), 0.78 + 0.86 * np.sin(a)) for a in angles]
        inner = [(-0.95 + 0.82 * np.cos(a), 0.78 + 0.82 * np.sin(a)) for a in angles[::-1]]
        b.profile([*arch, *inner], 0.5, (0, side * 0.74, 0), color)
    hood = [(-0.2, 0.85), (1.65, 0.72), (1.75, 0.8), (1.70, 1.35), (1.3, 1.48), (-0.2, 1.55)]
    b.profile(hood, 0.66, (0, 0, 0), color)
    b.box((0.04, 0.5, 0.5), (1.74, 0, 0.82), "black")
    for side in (-1, 1):
        b.box((1.1, 0.02, 0.35), (0.75, side * 0.335, 0.98), "black")
        b.box((0.03, 0.13, 0.09), (1.74, side * 0.22, 1.28), "lamp")
    b.box((1.9, 0.45, 0.5), (0.3, 0, 0.5), "charcoal")
    b.tube([(1.0, -0.42, 1.3), (1.0, -0.42, 2.3)], 0.05, "black", sides=7)
    if variant != 2:
        glass_cab(b, (-0.75, 0, 1.15), (1.25, 1.25, 1.35), color)
        b.cylinder(0.06, 0.12, (-0.9, 0.4, 2.58), "amber", segments=8)
    else:  # an old one: open seat, roll bar
        b.box((0.45, 0.5, 0.12), (-0.75, 0, 1.3), "black", bevel=0.04)
        b.box((0.10, 0.5, 0.4), (-0.95, 0, 1.38), "black", (0, -10, 0), bevel=0.03)
        b.rod((-0.1, 0, 1.4), (-0.35, 0, 1.72), 0.025, "black", sides=6)
        b.ring(0.2, 0.02, (-0.38, 0, 1.75), "black", (0, -35, 0), 14, 5)
        b.tube([(-1.3, 0.5, 1.1), (-1.3, 0.5, 2.35), (-1.3, -0.5, 2.35), (-1.3, -0.5, 1.1)], 0.045, "black", sides=6)
    for side in (-1, 1):
        b.rod((-1.5, side * 0.3, 0.75), (-2.15, side * 0.4, 0.5), 0.04, "charcoal", sides=5)
    b.box((0.06, 0.9, 0.08), (-2.15, 0, 0.46), "charcoal")
    names = ("A red tractor", "A green tractor with yellow wheels", "An old blue tractor")
    size = ((3.9, 1.95, 2.6), (4.3, 2.1, 2.75), (3.4, 1.75, 2.3))[variant]
    return fitted(b.build(names[variant], {"color": str(color)}), size)


def lattice(
    b: MeshBuilder, start: np.ndarray, end: np.ndarray, width: float, color: Color, bays: int, radius: float = 0.06
) -> None:
    """A square lattice mast or jib: four chords and a zigzag on each face."""
    axis = (end - start) / np.linalg.norm(end - start)
    u = np.cross(axis, [0, 1, 0] if abs(axis[1]) < 0.9 else [1, 0, 0])
    u /= np.linalg.norm(u)
    v = np.cross(axis, u)
    corners = [(u * i + v * j) * width / 2 for i, j in ((1, 1), (1, -1), (-1, -1), (-1, 1))]
    for c in corners:
        b.rod(start + c, end + c, radius, color, sides=4)
    for k in range(bays):
        p, q = start + (end - start) * k / bays, start + (end - start) * (k + 1) / bays
        for i in range(4):
            a, c = corners[i], corners[(i + 1) % 4]
            b.rod(p + (a if k % 2 else c), q + (c if k % 2 else a), radius * 0.6, color, sides=3)


@recipe("crane", 3, name="earthmovers.crane")
def crane(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.5)
    if variant == 1:
        return fitted(_tower_crane(b), (40.0, 5.5, 42.0))
    color = ("signal yellow", "", "safety orange")[variant]
    b.box((10.5, 2.5, 0.5), (0, 0, 0.75), "charcoal")
    b.box((10.5, 2.6, 0.35), (0, 0, 1.25), color, bevel=0.04)
    road_wheels(b, (-3.6, -2.2, 2.0, 3.5), 0.62, 1.3, 0.45)
    glass_cab(b, (4.5, 0.0, 1.1), (1.5, 2.5, 1.45), color)
    b.cylinder(1.1, 0.3, (-1.0, 0, 1.55), "dark grey", segments=16)
    b.box((3.4, 2.3, 0.9), (-1.9, 0, 1.8), color, bevel=0.06)
    b.box((0.9, 2.4, 1.3), (-3.8, 0, 1.6), "dark grey", bevel=0.05)
    glass_cab(b, (0.3, 0.85, 1.85), (1.5, 0.8, 1.3), color)
    foot = np.array([-2.4, -0.1, 2.9])
    tip = np.array([4.6, -0.1, 9.6]) if variant == 0 else np.array([6.2, -0.1, 6.8])
    for k, size in enumerate((0.72, 0.58, 0.44)):
        b.beam(
            tuple(foot + (tip - foot) * (0.30 * k)),
            tuple(foot + (tip - foot) * (0.42 + 0.29 * k)),
            size,
            size,
            color if k != 1 else shade(color, 0.9),
        )
    b.rod((-0.4, -0.1, 2.4), tuple(foot + (tip - foot) * 0.36 - [0, 0, 0.4]), 0.16, "aluminium", sides=8)
    b.rod(tuple(tip), (tip[0], tip[1], 3.2), 0.03, "black", sides=4)
    b.box((0.4, 0.3, 0.6), (tip[0], tip[1], 2.7), "signal red", bevel=0.05)
    b.tube(
        [(tip[0], tip[1], 2.7), (tip[0] + 0.2, tip[1], 2.5), (tip[0], tip[1], 2.25), (tip[0] - 0.2, tip[1], 2.4)],
        0.07,
        "black",
        sides=6,
    )
    for x in (-4.6, 2.9):  # outriggers
        for side in (-1, 1):
            b.box((0.3, 0.6, 0.25), (x, side * 1.4, 0.85), color)
            b.rod((x, side * 1.65, 0.9), (x, side * 1.65, 0.05), 0.08, "aluminium", sides=6)
            b.cylinder(0.25, 0.06, (x, side * 1.65, 0), "dark grey", segments=10)
    light_bar(b, 4.5, 2.65, 1.4, "amber")
    names = ("A yellow mobile crane", "", "An orange truck crane")
    return fitted(
        b.build(names[variant], {"kind": "mobile"}), ((12.0, 3.4, 11.0), (0, 0, 0), (12.8, 3.3, 8.2))[variant]
    )


def _tower_crane(b: MeshBuilder) -> BuiltAsset:
    yellow = "signal yellow"
    b.box((5.5, 5.5, 1.0), color="concrete")
    lattice(b, np.array([0, 0, 1.0]), np.array([0, 0, 35.0]), 1.8, yellow, 15, 0.12)
    lattice(b, np.array([1.0, 0, 36.0]), np.array([30.0, 0, 36.0]), 1.2, yellow, 18, 0.09)
    lattice(b, np.array([-1.0, 0, 36.0]), np.array([-10.0, 0, 36.0]), 1.2, yellow, 5, 0.09)
    b.box((2.2, 2.2, 1.2), (0, 0, 34.8), "dark grey")
    lattice(b, np.array([0, 0, 36.0]), np.array([0, 0, 42.0]), 1.0, yellow, 3, 0.1)
    for x, z in ((24.0, 36.6), (12.0, 36.6), (-9.5, 36.6)):
        b.rod((0, 0, 42.0), (x, 0, z), 0.06, "dark grey", sides=4)
    for k in range(4):
        b.box((0.6, 1.5, 2.6), (-9.6 + 0.75 * k, 0, 33.4), "concrete")
    glass_cab(b, (1.4, 1.4, 33.4), (1.4, 1.3, 1.9), yellow)
    b.box((1.2, 1.2, 0.4), (18, 0, 35.0), "dark grey")
    b.rod((18, 0, 35.2), (18, 0, 14.0), 0.05, "black", sides=4)
    b.box((0.5, 0.4, 0.9), (18, 0, 13.2), "signal red")
    b.box((2.6, 1.2, 0.9), (18, 0, 11.5), "wood")
    return b.build("A yellow tower crane lifting a load", {"kind": "tower"})
