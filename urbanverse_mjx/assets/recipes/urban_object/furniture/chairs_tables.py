"""Chairs and tables of terraces and dining rooms."""

import numpy as np

from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color
from ....meshes.recipe import Physics, recipe

CHAIR = Physics(
    ("metal", "wood"), 600.0, (2.5, 9.0), 0.5, True, "terrace chairs weigh 2.5-8 kg and are meant to be carried"
)


def _legs(
    b: MeshBuilder, half_x: float, half_y: float, height: float, radius: float, color: Color, splay: float = 0.03
) -> None:
    for x in (-half_x, half_x):
        for y in (-half_y, half_y):
            foot = (x + np.sign(x) * splay, y + np.sign(y) * splay, 0.0)
            b.rod(foot, (x, y, height), radius, color, sides=6)


@recipe("chair", 4, CHAIR, hulls=3, name="seating.chair")
def chair(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Bistro chair, stacking plastic chair with arms, wooden folding chair, wicker chair. Sitters face +x."""
    b = MeshBuilder(roughness=0.6)
    style = ("bistro", "plastic", "folding", "wicker")[variant % 4]
    color = (("red", "teal", "green")[int(rng.integers(3))], "white", "wood", "beige")[variant % 4]
    seat = float(rng.uniform(0.43, 0.46))
    if style == "bistro":
        b.cylinder(0.2, 0.025, (0, 0, seat), color, segments=18)
        _legs(b, 0.13, 0.13, seat, 0.012, "charcoal", 0.06)
        arch = [(-0.17, -0.15, seat), (-0.24, -0.17, 0.75), (-0.27, -0.1, 0.86), (-0.28, 0, 0.89)]
        arch += [(x, -y, z) for x, y, z in reversed(arch[:-1])]
        b.tube(arch, 0.013, "charcoal", sides=6)
        b.beam((-0.25, -0.16, 0.7), (-0.25, 0.16, 0.7), 0.02, 0.12, color)
    elif style == "plastic":
        b.box((0.44, 0.44, 0.03), (0, 0, seat - 0.03), color, bevel=0.01)
        b.box((0.03, 0.42, 0.42), (-0.2, 0, seat), color, turn_deg=(0, -12, 0), bevel=0.01)
        for y in (-0.24, 0.24):
            b.beam((-0.26, y, seat + 0.2), (0.18, y, seat + 0.2), 0.05, 0.025, color)
            b.beam((0.22, y, 0), (0.17, y, seat + 0.2), 0.04, 0.03, color)
            b.beam((-0.26, y, 0), (-0.22, y, seat + 0.2), 0.04, 0.03, color)
    elif style == "folding":
        for k in range(5):
            b.box((0.065, 0.38, 0.018), (-0.15 + 0.078 * k, 0, seat - 0.018), color)
        for y in (-0.2, 0.2):
            b.beam((0.22, y, 0), (-0.26, y, 0.85), 0.03, 0.03, color)
            b.beam((-0.24, y, 0), (0.2, y, seat), 0.03, 0.03, color)
        for z in (0.66, 0.79):
            b.beam(
                (-0.33 + 0.56 * (0.85 - z) + 0.05, -0.2, z),
                (-0.33 + 0.56 * (0.85 - z) + 0.05, 0.2, z),
                0.018,
                0.08,
                color,
            )
    else:
        b.lathe([(0.25, seat - 0.06), (0.27, seat), (0, seat + 0.01)], color=color, segments=16)
        angles = np.linspace(np.pi * 0.45, np.pi * 1.55, 11)
        low = np.array([(0.26 * np.cos(a), 0.26 * np.sin(a), seat - 0.02) for a in angles])
        lift = np.interp(np.abs(angles - np.pi), [0, 0.9, 1.8], [0.4, 0.34, 0.2])
        high = low * np.array([1.15, 1.15, 1]) + np.column_stack([np.zeros(11), np.zeros(11), lift])
        b.sheet(np.stack([low, high]), color, both_sides=True)
        b.tube(high, 0.02, "brown", sides=6)
        _legs(b, 0.16, 0.16, seat - 0.03, 0.018, "brown", 0.04)
    return b.build(f"a {style} {color} chair", {"style": style, "color": color})


TABLE = Physics(
    ("wood", "metal"),
    500.0,
    (8.0, 45.0),
    0.5,
    True,
    "cafe tables weigh 8-20 kg, dining tables 25-45 kg; one person shifts them",
)


@recipe("table", 4, TABLE, hulls=4, name="seating.table")
def table(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Round bistro table on a pedestal, square cafe table, long dining table, high table."""
    b = MeshBuilder(roughness=0.55)
    style = ("bistro", "square cafe", "dining", "high")[variant % 4]
    if style in ("bistro", "high"):
        h = 0.74 if style == "bistro" else 1.08
        r = float(rng.uniform(0.3, 0.38))
        top = "marble" if style == "bistro" else "dark wood"
        b.cylinder(r, 0.03, (0, 0, h - 0.03), top, segments=24)
        b.cylinder(r + 0.005, 0.02, (0, 0, h - 0.035), "charcoal", segments=24)
        b.cylinder(0.035, h - 0.05, (0, 0, 0.02), "charcoal", segments=10)
        b.lathe([(0.22, 0), (0.21, 0.03), (0.06, 0.06), (0.035, 0.14)], color="charcoal", segments=18)
    elif style == "square cafe":
        s = float(rng.uniform(0.65, 0.75))
        b.box((s, s, 0.03), (0, 0, 0.72), "light wood", bevel=0.008)
        b.box((0.06, 0.06, 0.7), (0, 0, 0.02), "black")
        for yaw in (45, 135):
            b.box((s * 0.85, 0.06, 0.03), color="black", turn_deg=(0, 0, yaw))
            b.box((s * 0.7, 0.05, 0.025), (0, 0, 0.695), "black", turn_deg=(0, 0, yaw))
    else:
        length, depth = float(rng.uniform(1.4, 1.8)), 0.8
        for k in range(5):
            b.box((0.152, length, 0.035), (-depth / 2 + 0.08 + 0.16 * k, 0, 0.715), "wood")
        b.box((depth - 0.16, length - 0.2, 0.08), (0, 0, 0.635), "wood")
        for x in (-0.3, 0.3):
            for y in (-length / 2 + 0.12, length / 2 - 0.12):
                b.box((0.07, 0.07, 0.7), (x, y, 0), "dark wood")
    return b.build(f"a {style} table", {"style": style})
