"""Cleaning tools and household textiles: brooms, pans, plungers, vacuum cleaners, irons, curtains, towels."""

import numpy as np

from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, shade
from ....meshes.recipe import recipe
from ...shared.forms import soft
from ...shared.sizes import made


@recipe("broom", 3, name="household.broom")
def broom(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A push broom with its stick, a besom of twigs, a plastic one with slanted bristles; standing on its bristles."""
    b = MeshBuilder(roughness=0.85)
    if variant % 3 == 1:
        b.tube([(0, 0, 0.45), (0.01, 0, 1.0), (0, 0, 1.45)], 0.014, "wood", sides=10)
        for k in range(46):
            a, r = float(rng.uniform(0, 2 * np.pi)), float(rng.uniform(0.3, 1.0))
            foot = (0.15 * r * np.cos(a), 0.15 * r * np.sin(a), 0.06 * float(rng.uniform(0, 1)) * (1 if k > 3 else 0))
            b.tube(
                [foot, (0.05 * r * np.cos(a), 0.05 * r * np.sin(a), 0.4), (0.015 * np.cos(a), 0.015 * np.sin(a), 0.56)],
                [0.003, 0.006, 0.005],
                ("bark", "brown", "dark wood")[k % 3],
                4,
            )
        for z in (0.43, 0.5):
            b.ring(0.036, 0.006, (0, 0, z), "beige", segments=14, sides=5)
        return made(b, "a besom", (0.3, 0.3, 1.45), style="besom")
    color, bristle, slant = (("wood", "#7a4a2a", 0.0), ("signal blue", "signal yellow", 0.05))[variant // 2]
    b.box((0.06, 0.34, 0.03), (0, 0, 0.085), color, bevel=0.01)
    for row in (-0.018, 0.0, 0.018):
        for k in range(15):
            y = -0.16 + 0.32 * k / 14
            b.tube([(row * 1.8, y * (1.06 + slant) + slant * 0.4, 0.0), (row, y, 0.09)], [0.0055, 0.009], bristle, 5)
    b.cylinder(0.02, 0.05, (-0.005, 0, 0.11), color, turn_deg=(0, -2, 0), segments=12)
    b.rod((0, 0, 0.12), (-0.045, 0, 1.32), 0.012, "light wood" if variant % 3 == 0 else "aluminium", sides=10)
    b.ball((0.013, 0.013, 0.018), (-0.045, 0, 1.32), color, segments=8, rings=6)
    return made(b, "a broom", ((0.12, 0.36, 1.32), (0.13, 0.4, 1.36))[variant // 2], style=color)


@recipe("dustpan", 2, name="household.dustpan")
def dustpan(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A hand pan with a rim and a brush beside it, a lobby pan on a long stick; the lip at +x."""
    b = MeshBuilder(roughness=0.5)
    color = ("signal red", "charcoal")[variant % 2]
    b.convex(
        [(0.16, y, z) for y in (-0.12, 0.12) for z in (0.0, 0.003)]
        + [(-0.06, y, z) for y in (-0.1, 0.1) for z in (0.008, 0.014)],
        color,
    )
    for s in (-1, 1):
        b.convex(
            [
                (0.15, s * 0.12, 0.0),
                (0.15, s * 0.117, 0.0),
                (0.15, s * 0.118, 0.006),
                (-0.06, s * 0.1, 0.0),
                (-0.06, s * 0.095, 0.0),
                (-0.06, s * 0.1, 0.07),
                (-0.06, s * 0.095, 0.07),
            ],
            color,
        )
    b.box((0.008, 0.2, 0.066), (-0.06, 0, 0.004), color)
    if variant % 2 == 0:
        b.tube([(-0.06, 0, 0.05), (-0.1, 0, 0.06), (-0.18, 0, 0.07)], [0.02, 0.012, 0.015], color, sides=10)
        b.ring(0.01, 0.003, (-0.185, 0, 0.075), color, (90, 0, 0), 10, 5)
        with b.frame((0.02, 0.0, 0.02), (0, -8, 62)):
            b.box((0.2, 0.03, 0.018), (-0.05, 0, 0.035), "wood", bevel=0.006)
            b.tube([(-0.14, 0, 0.045), (-0.22, 0, 0.05)], [0.012, 0.014], "wood", sides=8)
            for k in range(10):
                for y in (-0.008, 0.008):
                    b.tube(
                        [(-0.13 + 0.018 * k, y * 1.8, 0.0), (-0.13 + 0.018 * k, y, 0.037)], [0.006, 0.007], "cream", 5
                    )
        return made(b, "a dustpan with its brush", (0.32, 0.24, 0.1), style="hand")
    b.convex(
        [(x, y, 0.07) for x in (-0.065, 0.0) for y in (-0.1, 0.1)] + [(-0.065, y, 0.075) for y in (-0.1, 0.1)],
        shade(color, 1.3),
    )
    b.tube([(-0.06, 0, 0.06), (-0.1, 0, 0.4), (-0.14, 0, 0.78)], 0.011, "aluminium", sides=10)
    b.rod((-0.13, 0, 0.7), (-0.142, 0, 0.8), 0.016, color, sides=10)
    for s in (-1, 1):
        b.rod((-0.065, s * 0.1, 0.05), (-0.08, 0, 0.2), 0.006, "aluminium", sides=6)
        b.cylinder(0.015, 0.01, (-0.055, s * 0.1 + 0.005, 0.015), "black", turn_deg=(90, 0, 0), segments=12)
    return made(b, "a dustpan on a stick", (0.3, 0.26, 0.82), style="lobby")


@recipe("toilet plunger", 2, name="household.toilet_plunger")
def toilet_plunger(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A rubber cup on a wooden stick: a red bell, a black ribbed one."""
    b = MeshBuilder(roughness=0.7)
    cup, stick = (("#a8322a", "light wood"), ("charcoal", "signal blue"))[variant % 2]
    outside = [(0.066, 0), (0.07, 0.006), (0.062, 0.035), (0.04, 0.06), (0.02, 0.07)]
    if variant % 2:
        outside = [
            (0.06, 0),
            (0.066, 0.01),
            (0.056, 0.02),
            (0.064, 0.03),
            (0.052, 0.042),
            (0.058, 0.052),
            (0.03, 0.07),
            (0.02, 0.085),
        ]
    b.lathe([*outside, (0.018, outside[-1][1] + 0.03), (0.0, outside[-1][1] + 0.03)], color=cup, segments=28)
    b.lathe([(0.0115, 0.07), (0.011, 0.43), (0.013, 0.44), (0.011, 0.46), (0, 0.465)], color=stick, segments=14)
    return made(b, "a plunger", ((0.14, 0.14, 0.46), (0.125, 0.125, 0.4))[variant % 2], color=cup)


@recipe("vacuum cleaner", 3, name="household.vacuum_cleaner")
def vacuum_cleaner(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A cylinder cleaner with hose and floor head, an upright one, a drum for wet and dry; forward is +x."""
    b = MeshBuilder(roughness=0.4)
    if variant % 3 == 1:
        soft(b, (0.3, 0.32, 0.1), (0.1, 0, 0), "charcoal", plan=5, side=4)
        b.cylinder(0.05, 0.3, (-0.02, 0.15, 0.06), "signal red", turn_deg=(90, 0, 0))
        with b.frame((-0.02, 0, 0.08), (0, -14, 0)):
            b.cylinder(0.085, 0.42, (0, 0, 0.05), "purple", segments=20)
            b.cylinder(0.075, 0.2, (0.035, 0, 0.16), "light grey", segments=18)
            b.lathe([(0.085, 0.47), (0.07, 0.53), (0.02, 0.58)], color="charcoal", segments=18)
            b.rod((0, 0, 0.55), (0, 0, 1.0), 0.014, "aluminium", sides=10)
            b.tube([(0, 0, 0.98), (0.02, 0, 1.06), (0.09, 0, 1.06), (0.08, 0, 0.98), (0.01, 0, 0.93)], 0.014, "purple")
        for s in (-1, 1):
            b.cylinder(0.06, 0.03, (-0.09, s * 0.13 + 0.015, 0.06), "black", turn_deg=(90, 0, 0))
        return made(b, "an upright vacuum cleaner", (0.42, 0.31, 1.12), style="upright")
    if variant % 3 == 2:
        b.cylinder(0.17, 0.22, (0, 0, 0.07), "#3a4046", segments=24)
        b.lathe([(0.175, 0.29), (0.175, 0.32), (0.15, 0.38), (0.1, 0.42)], color="signal yellow", segments=24)
        b.tube([(-0.08, 0, 0.4), (-0.06, 0, 0.46), (0.06, 0, 0.46), (0.08, 0, 0.4)], 0.014, "black")
        for k in range(4):
            a = np.radians(45 + 90 * k)
            b.ball(0.035, (0.16 * np.cos(a), 0.16 * np.sin(a), 0.035), "black", segments=10, rings=6)
        b.cylinder(0.03, 0.05, (0.16, 0, 0.2), "black", turn_deg=(0, 90, 0))
        b.tube(
            [
                (0.2, 0, 0.2),
                (0.27, 0, 0.25),
                (0.26, 0.08, 0.45),
                (0.05, 0.2, 0.44),
                (-0.14, 0.16, 0.3),
                (-0.1, 0.2, 0.1),
            ],
            0.02,
            "dark grey",
            sides=8,
        )
        b.box((0.02, 0.07, 0.05), (0.155, 0, 0.35), "signal red", bevel=0.006)
        return made(b, "a wet and dry vacuum cleaner", (0.5, 0.42, 0.47), style="drum")
    soft(b, (0.34, 0.24, 0.19), (-0.03, 0, 0.03), "signal red", plan=3, side=3, segments=22, rings=10)
    soft(b, (0.35, 0.245, 0.05), (-0.03, 0, 0.06), "charcoal", plan=3, side=4, segments=22)
    for s in (-1, 1):
        b.cylinder(0.075, 0.035, (-0.11, s * 0.115 + 0.0175, 0.075), "black", turn_deg=(90, 0, 0), segments=20)
        b.cylinder(0.04, 0.04, (-0.11, s * 0.116 + 0.02, 0.075), "light grey", turn_deg=(90, 0, 0), segments=16)
    b.box((0.12, 0.03, 0.02), (-0.05, 0, 0.215), "charcoal", bevel=0.008)
    b.cylinder(0.028, 0.03, (0.12, 0, 0.13), "black", turn_deg=(0, 75, 0))
    hose = [
        (0.14, 0, 0.14),
        (0.2, 0.0, 0.2),
        (0.17, 0.06, 0.32),
        (0.02, 0.12, 0.33),
        (-0.1, 0.1, 0.24),
        (-0.1, 0.13, 0.12),
    ]
    b.tube(hose, 0.018, "dark grey", sides=8)
    b.box((0.09, 0.22, 0.03), (0.2, 0.0, 0.0), "charcoal", bevel=0.01)
    b.tube([(0.2, 0, 0.02), (0.17, 0.02, 0.08), (0.02, 0.115, 0.34)], 0.014, "aluminium", sides=10)
    return made(b, "a cylinder vacuum cleaner", (0.42, 0.29, 0.34), style="cylinder")


@recipe("clothes iron", 2, name="household.clothes_iron")
def clothes_iron(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A steam iron with its dial and cord, an old solid iron with a wooden grip; the tip at +x."""
    b = MeshBuilder(roughness=0.35)
    sole = [
        (0.14, 0.0),
        (0.1, 0.03),
        (0.03, 0.053),
        (-0.1, 0.056),
        (-0.125, 0.04),
        (-0.125, -0.04),
        (-0.1, -0.056),
        (0.03, -0.053),
        (0.1, -0.03),
    ]
    if variant % 2 == 0:
        b.extrude(sole, 0.008, color="aluminium")
        rows = [
            np.array([(x * s + o, y * s, z) for x, y in sole[::-1]])[::-1]
            for s, z, o in ((0.97, 0.008, 0), (0.93, 0.035, -0.002), (0.7, 0.06, -0.02), (0.45, 0.075, -0.03))
        ]
        b.loft(rows, "signal blue", crease_deg=50)
        b.tube(
            [(0.06, 0, 0.06), (0.05, 0, 0.11), (0.0, 0, 0.132), (-0.08, 0, 0.13), (-0.115, 0, 0.1), (-0.11, 0, 0.03)],
            [0.018, 0.018, 0.015, 0.015, 0.017, 0.02],
            "white",
            sides=12,
        )
        b.cylinder(0.022, 0.01, (-0.02, 0, 0.073), "white", segments=18)
        for y in (-0.008, 0.01):
            b.cylinder(0.007, 0.008, (0.035, y, 0.122), "signal red", segments=10)
        b.tube(
            [(-0.112, 0, 0.11), (-0.135, 0.0, 0.12), (-0.15, 0.03, 0.08), (-0.14, 0.05, 0.005), (-0.05, 0.06, 0.005)],
            0.004,
            "black",
            sides=6,
        )
        return made(b, "a steam iron", (0.28, 0.118, 0.145), style="steam")
    b.extrude([(x, y * 0.95) for x, y in sole], 0.045, color="cast iron")
    b.extrude([(x * 0.9, y * 0.85) for x, y in sole], 0.012, (0, 0, 0.045), "dark grey")
    for x in (-0.07, 0.07):
        b.tube([(x, 0, 0.05), (x * 1.05, 0, 0.1), (x * 0.8, 0, 0.13)], 0.009, "cast iron", sides=8)
    b.cylinder(0.016, 0.13, (-0.065, 0, 0.13), "wood", turn_deg=(0, 90, 0), segments=16)
    b.ring(0.017, 0.003, (-0.05, 0, 0.13), "brass", (0, 90, 0), 14, 5)
    return made(b, "an old solid iron", (0.24, 0.105, 0.15), style="solid")


@recipe("curtain", 3, name="household.curtain")
def curtain(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Two wings on a rod with finials, one drawn and tied back, a short pair with a frill; folds along y."""
    b = MeshBuilder(roughness=0.95)
    color, (depth, w, h) = (("dark red", (0.12, 1.4, 2.2)), ("#6d7f5c", (0.14, 1.7, 2.5)), ("cream", (0.1, 1.1, 1.2)))[
        variant % 3
    ]
    rod = "brass" if variant % 3 == 0 else "dark wood"
    b.rod((0, -w / 2 + 0.05, h - 0.04), (0, w / 2 - 0.05, h - 0.04), 0.016, rod, sides=10)
    for s in (-1, 1):
        b.ball(0.032, (0, s * (w / 2 - 0.03), h - 0.04), rod, segments=12)
        wing = w * (0.43 if variant % 3 != 1 else 0.45)
        u, v = np.linspace(0, 1, 25), np.linspace(0, 1, 6)
        rows = []
        for t in v:
            pinch = 1.0 if variant % 3 != 1 else 1 - 0.62 * np.exp(-(((t - 0.38) / 0.2) ** 2))
            fold = depth * 0.42 * np.sin(2 * np.pi * 5.5 * u) * (0.7 + 0.3 * (1 - t))
            y = s * (w / 2 - 0.05 - wing * pinch * u)
            rows.append(np.column_stack([fold, y, np.full(25, t * (h - 0.07))]))
        grid = np.array(rows)
        b.sheet(grid, color, both_sides=True)
        b.tube(grid[0], 0.006, shade(color, 0.8), sides=4)
        for k in range(6):
            b.ring(0.022, 0.004, (0, s * (w / 2 - 0.07 - wing * k / 5 * 0.95), h - 0.045), rod, (90, 0, 0), 10, 4)
        if variant % 3 == 1:
            b.ring(wing * 0.2, 0.014, (0, s * (w / 2 - 0.05 - wing * 0.19), h * 0.37), "gold", segments=14, sides=5)
    return made(b, f"a pair of {color} curtains", (depth, w, h), 0.35, color=color)


@recipe("towel", 3, name="household.towel")
def towel(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A folded bath towel, a rolled one with stripes, a small stack of three."""
    b = MeshBuilder(roughness=1.0)
    if variant % 3 == 1:
        b.cylinder(0.075, 0.42, (-0.21, 0, 0.075), "signal blue", turn_deg=(0, 90, 0), segments=22)
        for x in (-0.14, -0.1, 0.1, 0.14):
            b.cylinder(0.077, 0.016, (x, 0, 0.075), "white", turn_deg=(0, 90, 0), segments=22)
        t = np.linspace(0, 5 * np.pi, 34)
        for x in (-0.211, 0.211):
            r = 0.012 + 0.0038 * t
            b.tube(np.column_stack([np.full(34, x), r * np.cos(t), 0.075 + r * np.sin(t)]), 0.0022, "dark blue", 4)
        return made(b, "a rolled towel", (0.43, 0.16, 0.155), style="rolled")
    inks: tuple[Color, ...] = ("white",) if variant % 3 == 0 else ("teal", "off white", "amber")
    layer, z = (0.038 if len(inks) == 1 else 0.0255), 0.0
    for color in inks:
        for k in range(2):
            b.box((0.42, 0.3 - 0.004 * k, layer), (-0.015 + 0.004 * k, 0, z), color, bevel=layer * 0.3)
            z += layer
        # Where the cloth turns over, its two layers are one round edge.
        b.cylinder(layer, 0.294, (0.19, 0.147, z - layer), color, turn_deg=(90, 0, 0), segments=24)
    for x in (-0.17, -0.13):
        b.box((0.014, 0.28, 0.002), (x, 0, z), "signal blue" if len(inks) == 1 else "brown")
    size = (0.45, 0.3, 0.08) if len(inks) == 1 else (0.44, 0.3, 0.165)
    return made(b, "a folded towel" if len(inks) == 1 else "a stack of towels", size, style="folded")
