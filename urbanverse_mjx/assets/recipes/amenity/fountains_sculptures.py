"""Ornament of squares: fountains and sculptures."""

import numpy as np

from ...meshes import paint, shapes
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import Physics, recipe

MASONRY = Physics(
    ("stone", "bronze"), 2200.0, (90.0, 9000.0), 0.7, False, "dressed stone of 2,200-2,600 kg/m3, bronze shells over it"
)


def water_disc(b: MeshBuilder, radius: float, z: float, rng: np.random.Generator) -> None:
    """A round pool surface with ripples."""
    image, draw = paint.canvas((96, 96), "water")
    for _ in range(14):
        x, y, r = (int(v) for v in rng.uniform((6, 6, 4), (90, 90, 16)))
        draw.arc(
            (x - r, y - r // 2, x + r, y + r // 2), 0, 300, fill=tuple(int(c * 1.25) for c in (92, 142, 164)), width=1
        )
    outline = [(radius * np.cos(a), radius * np.sin(a)) for a in np.linspace(0, 2 * np.pi, 32, endpoint=False)]
    with b.frame((0, 0, z), (0, -90, 0)):
        b.plate(outline, 0.004, (0, 0, 0), image, "water")


@recipe("fountain", 3, MASONRY, hulls=6, name="civic.fountain")
def fountain(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Two-bowl round basin, square modern pool with jets, wall-like drinking fountain trough."""
    b = MeshBuilder(roughness=0.6)
    style = ("tiered", "jets", "trough")[variant % 3]
    if style == "tiered":
        r = float(rng.uniform(1.5, 1.9))
        basin = [
            (r, 0),
            (r + 0.08, 0.06),
            (r - 0.02, 0.12),
            (r, 0.42),
            (r + 0.08, 0.45),
            (r + 0.08, 0.52),
            (r - 0.16, 0.52),
            (r - 0.17, 0.41),
            (0, 0.41),
        ]
        b.lathe(basin, color="sandstone", segments=32)
        water_disc(b, r - 0.165, 0.42, rng)
        b.lathe([(0.34, 0.3), (0.34, 0.5), (0.16, 0.58), (0.14, 1.05), (0.22, 1.12)], color="sandstone")
        b.lathe(
            [(0.1, 1.1), (0.5, 1.18), (0.78, 1.36), (0.82, 1.42), (0.74, 1.42), (0.73, 1.36), (0, 1.36)],
            color="sandstone",
            segments=24,
        )
        water_disc(b, 0.72, 1.37, rng)
        b.lathe([(0.12, 1.3), (0.08, 1.75), (0.16, 1.8), (0.3, 1.92), (0.28, 1.94), (0, 1.88)], color="sandstone")
        b.lathe([(0.05, 1.9), (0.035, 2.25), (0.06, 2.35), (0, 2.42)], color="water", segments=8)
        for k in range(8):
            a = 2 * np.pi * k / 8
            arc = [
                ((0.74 + 0.3 * s) * np.cos(a), (0.74 + 0.3 * s) * np.sin(a), 1.42 + 0.1 * s - 1.1 * s * s)
                for s in np.linspace(0, 1, 5)
            ]
            b.tube(arc, [0.02, 0.022, 0.024, 0.026, 0.03], "light blue", sides=5)
    elif style == "jets":
        s = float(rng.uniform(2.4, 3.0))
        for side in (-1, 1):
            b.box((0.32, s, 0.45), (side * (s / 2 - 0.16), 0, 0), "granite", bevel=0.02)
            b.box((s, 0.32, 0.45), (0, side * (s / 2 - 0.16), 0), "granite", bevel=0.02)
        image = paint.speckled((48, 48), "water", rng, 8.0, 4)
        b.box((s - 0.6, s - 0.6, 0.33), color="dark blue", skins={"+z": image})
        for x in (-0.5, 0.5):
            for y in (-0.5, 0.5):
                top = float(rng.uniform(1.1, 1.5))
                b.lathe(
                    [(0.03, 0.3), (0.05, top * 0.7), (0.1, top * 0.9), (0.05, top), (0, top + 0.03)],
                    (x, y, 0),
                    "light blue",
                    segments=8,
                )
    else:
        b.box((0.3, 1.3, 1.6), (-0.35, 0, 0), "granite", bevel=0.03)
        b.box((0.4, 1.5, 0.15), (-0.35, 0, 1.58), "granite", bevel=0.03)
        b.convex(
            [(-0.42, -0.5, 1.73), (-0.42, 0.5, 1.73), (-0.28, -0.5, 1.73), (-0.28, 0.5, 1.73), (-0.35, 0, 2.15)],
            "granite",
        )
        for at, size in (((0.42, 0), (0.12, 1.3)), ((0.1, 0.6), (0.6, 0.12)), ((0.1, -0.6), (0.6, 0.12))):
            b.box((*size, 0.6), (*at, 0), "granite")
        b.box((0.6, 1.1, 0.45), (0.1, 0, 0), "water")
        for y in (-0.3, 0.3):
            b.tube([(-0.2, y, 1.15), (0.0, y, 1.15), (0.03, y, 1.08)], 0.025, "bronze", sides=6)
            b.tube([(0.03, y, 1.08), (0.05, y, 0.8), (0.06, y, 0.46)], 0.016, "light blue", sides=5)
    return b.build(f"a {style} fountain", {"style": style})


def _statue(b: MeshBuilder, color: Color, h: float, arm_up: bool) -> None:
    """A robed standing figure of height h, facing +x."""
    robe = [
        (0.25, 0),
        (0.27, 0.05),
        (0.2, 0.3),
        (0.17, 0.5),
        (0.14, 0.58),
        (0.19, 0.74),
        (0.16, 0.8),
        (0.06, 0.84),
        (0.05, 0.87),
    ]
    folds = []
    for r, z in robe:
        angle = np.arange(16) * np.pi / 8
        depth = 0.12 * max(0.0, 0.55 - z)
        radius = r * h * 0.55 * (1 + depth * np.cos(5 * angle))
        folds.append(np.column_stack([0.75 * radius * np.cos(angle), radius * np.sin(angle), np.full(16, z * h)]))
    b.loft(folds, color, crease_deg=50)
    b.ball((0.062 * h, 0.055 * h, 0.075 * h), (0.01 * h, 0, 0.925 * h), color, segments=12, rings=8)
    for side in (-1, 1):
        shoulder = (0, side * 0.1 * h, 0.77 * h)
        if arm_up and side > 0:
            arm = [shoulder, (0.05 * h, 0.2 * h, 0.85 * h), (0.1 * h, 0.19 * h, 1.05 * h)]
        else:
            arm = [shoulder, (0.02 * h, side * 0.16 * h, 0.6 * h), (0.12 * h, side * 0.1 * h, 0.52 * h)]
        b.tube(arm, [0.04 * h, 0.032 * h, 0.024 * h], color, sides=8)
        b.ball(0.03 * h, arm[-1], color, segments=8, rings=6)


@recipe("sculpture", 4, MASONRY, hulls=6, name="civic.sculpture")
def sculpture(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Bronze figure on a plinth, abstract twisted column, stacked spheres, marble bust."""
    b = MeshBuilder(roughness=0.5)
    style = ("statue", "twisted", "rings", "bust")[variant % 4]
    stone = ("granite", "dark concrete", "charcoal", "sandstone")[variant % 4]
    if style == "statue":
        p = float(rng.uniform(1.1, 1.4))
        b.box((1.3, 1.3, 0.25), color=stone, bevel=0.03)
        b.box((0.95, 0.95, p - 0.4), (0, 0, 0.25), stone, bevel=0.02, taper=(0.9, 0.9))
        b.box((1.05, 1.05, 0.15), (0, 0, p - 0.15), stone, bevel=0.03)
        plaque, draw = paint.canvas((48, 24), "bronze")
        paint.text(draw, "1848", (6, 4, 42, 20), "gold", bold=0.02)
        b.panel(plaque, (0.465, 0, p * 0.55), 0.4, 0.2, tilt_deg=3.0)
        with b.frame((0, 0, p)):
            _statue(b, "verdigris", float(rng.uniform(1.9, 2.2)), arm_up=True)
    elif style == "twisted":
        b.box((1.1, 1.1, 0.3), color=stone, bevel=0.02)
        sections = []
        for s in np.linspace(0, 1, 15):
            r, a = 0.42 * (1 - 0.55 * s) + 0.05 * np.sin(6 * s), s * 2.4
            square = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * r
            turn = np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]])
            sections.append(np.column_stack([square @ turn.T, np.full(4, 0.3 + 2.4 * s)]))
        b.loft(sections, "rust", crease_deg=45)
    elif style == "rings":
        b.cylinder(0.6, 0.2, color=stone, segments=24)
        for k, (r, z, turn) in enumerate(
            ((0.75, 0.95, (90, 0, 20)), (0.5, 1.75, (90, 0, -50)), (0.32, 2.35, (90, 0, 80)))
        ):
            b.ring(r, 0.08 - 0.012 * k, (0, 0, z + 0.08), "mirror", turn, segments=32, sides=10)
    else:
        b.box((0.6, 0.6, 0.15), color=stone, bevel=0.02)
        b.box((0.42, 0.42, 1.05), (0, 0, 0.15), stone, taper=(0.9, 0.9))
        b.box((0.5, 0.5, 0.08), (0, 0, 1.2), stone, bevel=0.02)
        with b.frame((0, 0, 1.28)):
            b.lathe([(0.12, 0), (0.1, 0.06), (0.07, 0.1)], color="marble")
            b.add(
                shapes.lathe([(0.1, 0.09), (0.19, 0.16), (0.25, 0.28), (0.2, 0.36), (0.08, 0.41), (0.065, 0.47)]),
                "marble",
                scale=(0.65, 1, 1),
            )
            b.ball((0.115, 0.095, 0.145), (0.015, 0, 0.58), "marble", segments=16, rings=12)
            b.ball((0.1, 0.1, 0.09), (-0.02, 0, 0.66), shade("marble", 0.93), segments=12, rings=6)
            b.convex([(0.12, -0.02, 0.55), (0.12, 0.02, 0.55), (0.155, 0, 0.555), (0.118, 0, 0.62)], "marble")
    return b.build(f"a {style} sculpture", {"style": style})
