"""Plants in pots: planters, house plants, bonsai."""

import numpy as np

from ...meshes import shapes
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import Physics, recipe
from ..shared.sizes import fitted_as, size_of
from .foliage import leafy, small_leaves


@recipe("bonsai", 3, hulls=6, name="relics.bonsai")
def bonsai(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A bent trunk with pads of leaves in a shallow glazed tray: an old pine, a slanting maple, an upright juniper."""
    size, b = size_of("bonsai", variant), MeshBuilder(roughness=0.7)
    x, y, z = size
    glaze: Color = ("#2f5a7a", "#7a3a2a", "#3f5f4a")[variant]
    pot = 0.17 * z
    if variant == 1:
        with b.frame((0, 0, 0), scale=(x / y, 1.0, 1.0)):
            b.lathe(
                [(0.3 * y, 0.03 * z), (0.38 * y, pot), (0.42 * y, pot), (0.42 * y, 1.15 * pot), (0.36 * y, 1.15 * pot)],
                (0, 0, 0),
                glaze,
                segments=18,
            )
    else:
        b.box((0.66 * x, 0.62 * y, pot), (0, 0, 0.03 * z), glaze, taper=(1.14, 1.14))
        b.box((0.8 * x, 0.76 * y, 0.04 * z), (0, 0, pot), shade(glaze, 1.15))
    for sx in (-1, 1):
        for sy in (-1, 1):
            b.box((0.1 * x, 0.1 * y, 0.04 * z), (sx * 0.22 * x, sy * 0.2 * y, 0), shade(glaze, 0.8))
    b.ball((0.3 * x, 0.28 * y, 0.05 * z), (0, 0, pot + 0.03 * z), "#6f8a48", segments=12, rings=6)
    bend = (0.16, 0.3, -0.05)[variant] * y
    base = pot + 0.04 * z
    spine = [
        (0, -0.12 * y, base),
        (0.02 * x, 0.06 * y, 0.38 * z),
        (0, -0.4 * bend, 0.52 * z),
        (0, bend, 0.68 * z),
        (0, 0.7 * bend, 0.84 * z),
    ]
    b.tube(spine, [0.09 * y, 0.065 * y, 0.05 * y, 0.035 * y, 0.015 * y], ("bark", "#8a7a68", "#7a4f38")[variant], 8)
    for k in range(4):
        a = 1.5 * k + 0.4
        b.tube(
            [
                (0, -0.12 * y, base + 0.03 * z),
                (0.14 * x * np.cos(a), -0.12 * y + 0.14 * y * np.sin(a), base - 0.01 * z),
            ],
            [0.05 * y, 0.015 * y],
            "bark",
            6,
        )
    leaves = small_leaves(("dark leaf", "#c8502a", "#5f8f4a")[variant], rng)
    pads = (
        (0.0, -0.30, 0.46, 0.9),
        (0.04, 0.32, 0.56, 1.0),
        (-0.1, -0.22, 0.66, 0.8),
        (0.06, 0.12, 0.78, 0.9),
        (0.0, 0.0, 0.92, 0.7),
    )
    for px, py, pz, k in pads:
        end = (px * x, py * y + 0.4 * bend, pz * z)
        b.tube([(0, 0.3 * bend, (pz - 0.1) * z), (end[0], end[1], end[2] - 0.02 * z)], [0.03 * y, 0.012 * y], "bark", 6)
        leafy(b, end, (0.24 * k * x, 0.19 * k * y, 0.075 * z), leaves, rng, 10, 5, 0.12, 0.3 + 0.5 * pz)
        leafy(
            b,
            (end[0], end[1] + 0.09 * y, end[2] + 0.03 * z),
            (0.15 * k * x, 0.12 * k * y, 0.06 * z),
            leaves,
            rng,
            8,
            4,
            0.14,
            0.4 + 0.5 * pz,
        )
    if variant == 0:
        b.ball((0.06 * x, 0.07 * y, 0.05 * z), (0.18 * x, 0.24 * y, pot + 0.06 * z), "granite", segments=7, rings=4)
    names = ("pine bonsai in a blue tray", "maple bonsai in an oval red tray", "juniper bonsai in a green tray")
    return fitted_as(b.build(names[variant]), "bonsai", size)


POT = Physics(
    ("clay", "concrete", "soil"),
    900.0,
    (4.0, 260.0),
    0.6,
    True,
    "clay walls and damp soil of 1,400 kg/m3 with air between",
)


def pot(b: MeshBuilder, style: str, size: float, color: Color) -> tuple[float, float]:
    """A pot standing on the origin, filled with soil; returns (radius, height) of its soil."""
    if style == "trough":
        b.box((0.45, size * 2.2, 0.42), color=color, taper=(1.12, 1.04), bevel=0.015)
        b.box((0.4, size * 2.1, 0.02), (0, 0, 0.41), "soil")
        return 0.2, 0.42
    if style == "cube":
        b.box((size, size, size), color=color, bevel=0.02)
        b.box((size * 0.84, size * 0.84, 0.01), (0, 0, size), "soil")
        return size * 0.4, size
    r, h = size * 0.5, size * 0.9
    if style == "bowl":
        h = size * 0.55
        b.lathe(
            [
                (r * 0.45, 0),
                (r * 0.5, h * 0.1),
                (r * 0.9, h * 0.55),
                (r, h),
                (r * 0.9, h),
                (r * 0.85, h * 0.88),
                (0, h * 0.88),
            ],
            color=color,
            segments=22,
        )
    else:
        rim = [
            (r * 0.68, 0),
            (r * 0.92, h * 0.8),
            (r * 1.0, h * 0.8),
            (r * 1.02, h),
            (r * 0.9, h),
            (r * 0.86, h * 0.9),
            (0, h * 0.9),
        ]
        b.lathe(rim, color=color, segments=22)
    b.cylinder(r * 0.85, 0.01, (0, 0, h * 0.9), "soil", segments=22)
    return r * 0.8, h * 0.91


def leaf_blade(
    b: MeshBuilder, root: np.ndarray, yaw: float, length: float, rise: float, width: float, color: Color
) -> None:
    """An arching blade from the root outwards."""
    out, side = np.array([np.cos(yaw), np.sin(yaw), 0.0]), np.array([-np.sin(yaw), np.cos(yaw), 0.0])
    rows = []
    for s, w in ((0.0, 0.35), (0.35, 1.0), (0.7, 0.8), (1.0, 0.05)):
        mid = root + out * length * s + np.array([0, 0, rise * np.sin(np.pi * 0.62 * s)])
        rows.append([mid - side * width * w / 2, mid + side * width * w / 2])
    b.sheet(np.array(rows), color, both_sides=True)


@recipe("plant pot", 4, POT, hulls=1, name="civic.plant_pot")
def plant_pot(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Terracotta pot, concrete bowl, corten cube, timber trough; soil but no plant."""
    b = MeshBuilder(roughness=0.9)
    style, color = (("terracotta pot", "terracotta"), ("bowl", "concrete"), ("cube", "rust"), ("trough", "wood"))[
        variant % 4
    ]
    size = float(rng.uniform(*((0.4, 0.55), (0.8, 1.1), (0.5, 0.65), (0.5, 0.6))[variant % 4]))
    pot(b, style, size, color)
    return b.build(f"a {style} filled with soil", {"style": style, "size": round(size, 3)})


@recipe("potted plant", 4, POT, hulls=3, name="civic.potted_plant")
def potted_plant(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Box ball, arching grass, flowers in a trough, small clipped tree on a stem."""
    b = MeshBuilder(roughness=0.95)
    style = ("box ball", "agave", "flower trough", "clipped tree")[variant % 4]
    if style == "box ball":
        r, z = pot(b, "terracotta pot", float(rng.uniform(0.42, 0.5)), "terracotta")
        ball = shapes.ellipsoid((r * 1.45, r * 1.45, r * 1.4), 16, 10)
        lumpy = shapes.Shape(ball.vertices * rng.uniform(0.93, 1.07, (len(ball.vertices), 1)), ball.faces)
        b.add(lumpy, "leaf", (0, 0, z + r * 1.2), crease_deg=15)
    elif style == "agave":
        r, z = pot(b, "cube", float(rng.uniform(0.42, 0.52)), "charcoal")
        for ring, count in ((0, 5), (1, 8), (2, 9)):
            for k in range(count):
                yaw = 2 * np.pi * (k + 0.5 * ring) / count + float(rng.uniform(-0.1, 0.1))
                green = shade("leaf" if ring else "light leaf", float(rng.uniform(0.85, 1.15)))
                root = np.array([0, 0, z])
                leaf_blade(b, root, yaw, (0.12, 0.3, 0.42)[ring], (0.5, 0.42, 0.24)[ring], 0.07, green)
    elif style == "flower trough":
        _, z = pot(b, "trough", float(rng.uniform(0.45, 0.55)), "grey wood")
        for _ in range(16):
            x, y = float(rng.uniform(-0.13, 0.13)), float(rng.uniform(-0.45, 0.45))
            top = z + float(rng.uniform(0.16, 0.3))
            b.ball(
                (0.085, 0.085, 0.11),
                (x, y, z + 0.08),
                shade("leaf", float(rng.uniform(0.8, 1.15))),
                segments=6,
                rings=4,
            )
            b.rod((x, y, z), (x, y, top), 0.008, "light leaf", sides=3)
            ink = ("red", "signal yellow", "pink", "white", "purple")[int(rng.integers(5))]
            b.ball((0.05, 0.05, 0.03), (x, y, top), ink, segments=6, rings=4)
    else:
        r, z = pot(b, "cube", float(rng.uniform(0.42, 0.5)), "white")
        b.cylinder(0.022, 0.65, (0, 0, z), "bark", segments=8)
        for at, size in ((0.62, 0.27), (1.0, 0.19)):
            ball = shapes.ellipsoid(size, 14, 9)
            lumpy = shapes.Shape(ball.vertices * rng.uniform(0.92, 1.08, (len(ball.vertices), 1)), ball.faces)
            b.add(lumpy, "dark leaf", (0, 0, z + at + 0.1), crease_deg=15)
        b.cylinder(0.018, 0.3, (0, 0, z + 0.8), "bark", segments=6)
    return b.build(f"a potted plant, {style}", {"style": style})
