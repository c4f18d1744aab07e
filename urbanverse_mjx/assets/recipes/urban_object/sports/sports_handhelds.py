"""Hand-held sports equipment: bats, gloves, rackets, flying discs, fishing rods. Long ones lie along x."""

import numpy as np

from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, shade
from ....meshes.recipe import recipe
from ...shared.outlines import curve, ellipse, pairs, rounded, section
from ...shared.sizes import varied


@recipe("baseball bat", 3, hulls=1, name="sports_gear.baseball_bat")
def baseball_bat(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Light wooden bat, dark wooden bat, blue metal bat; lying, the barrel at +x."""
    b = MeshBuilder(roughness=0.4)
    style = ("light wooden", "dark wooden", "blue metal")[variant]
    wood, grip = (("light wood", "brown"), ("#4a2616", "black"), ("blue", "black"))[variant]
    r = 0.0325
    barrel = [
        (0.012, 0.14),
        (0.0125, 0.28),
        (0.016, 0.4),
        (0.025, 0.54),
        (r, 0.66),
        (r, 0.8),
        (0.028, 0.83),
        (0.012, 0.84),
    ]
    with b.frame((0, 0, r), (0, 90, 0)):
        b.lathe(
            [(0.02, 0.0), (0.025, 0.008), (0.02, 0.016), (0.0125, 0.03)],
            color=wood if variant < 2 else grip,
            segments=16,
        )
        b.lathe([(0.0125, 0.028), (0.0135, 0.03), (0.013, 0.27), (0.012, 0.275)], color=grip, segments=14)
        for k in range(9):
            b.ring(0.0128, 0.0016, (0, 0, 0.05 + 0.025 * k), shade(grip, 1.4), (0, 6, 0), segments=12, sides=3)
        b.lathe(barrel, color=wood, segments=18)
        for z in (0.6, 0.615):
            b.cylinder(
                np.interp(z, [0.54, 0.66], [0.0253, r]) + 0.0006,
                0.006,
                (0, 0, z),
                "signal red" if variant < 2 else "white",
                segments=18,
            )
    size = ((0.84, 0.065, 0.065), (0.86, 0.0662, 0.0662), (0.72, 0.058, 0.058))[variant]
    return varied(b, rng, size, f"a {style} baseball bat", style, jitter=0.002)


_PALM = ((-0.135, 0.05, 0.0), (-0.11, 0.075, 0.0), (-0.04, 0.098, 0.0), (0.03, 0.098, 0.004), (0.06, 0.09, 0.01))


def _glove(b: MeshBuilder, leather: Color, lace: Color) -> None:
    """An open glove, its palm up and its fingers along +x."""
    b.loft([section(x, y, 0.028, 0.034 + lift, 16, 2.6) for x, y, lift in _PALM], leather)
    fingers = ((0.075, 0.125, 0.1), (0.035, 0.05, 0.135), (-0.004, -0.012, 0.14), (-0.042, -0.06, 0.125))
    for k, (y0, y1, length) in enumerate(fingers):
        path = curve([(0.02, y0, 0.04), (0.05 + 0.45 * length, (y0 + y1) / 2, 0.055), (0.05 + length, y1, 0.085)], 3)
        b.tube(path, [0.02, 0.021, 0.022, 0.022, 0.022, 0.02, 0.012], shade(leather, (1.12, 0.92)[k % 2]), sides=8)
    thumb = curve([(-0.07, -0.08, 0.045), (0.0, -0.135, 0.06), (0.1, -0.15, 0.085)], 3)
    b.tube(thumb, [0.024, 0.025, 0.025, 0.024, 0.023, 0.021, 0.013], shade(leather, 1.12), sides=8)
    # The web between thumb and forefinger: a lattice of laces.
    for share in np.linspace(0.0, 1.0, 5):
        b.rod(
            (0.03 + 0.08 * share, -0.14, 0.066 + 0.016 * share),
            (0.05 + 0.1 * share, -0.06, 0.06 + 0.02 * share),
            0.0055,
            lace,
            sides=5,
        )
    for y in (-0.12, -0.1, -0.08):
        b.rod((0.035, y, 0.068), (0.13, y, 0.083), 0.0055, lace, sides=5)
    for x, z in ((0.085, 0.088), (0.12, 0.098)):
        b.rod((x, -0.05, z), (x, 0.1, z - 0.004), 0.004, lace, sides=5)
    b.ball((0.075, 0.06, 0.012), (-0.015, -0.02, 0.062), shade(leather, 0.6), segments=16, rings=6)
    b.tube([(-0.12, 0.065, 0.045), (-0.135, 0.0, 0.06), (-0.12, -0.065, 0.045)], 0.014, lace, sides=6)


@recipe("baseball glove", 2, name="sports_gear.baseball_glove")
def baseball_glove(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Tan and dark brown gloves lying on their backs, the open palm towards +x; the dark one holds a ball."""
    b = MeshBuilder(roughness=0.75)
    style = ("tan", "dark with a ball")[variant]
    leather: Color = ("#b9793a", "#5c3018")[variant]
    lace: Color = ("#6e4420", "beige")[variant]
    with b.frame(turn_deg=(0, -24, 180)):
        _glove(b, leather, lace)
        if variant == 1:
            b.ball((0.037, 0.037, 0.042), (-0.02, 0.0, 0.1), "white", segments=14, rings=8)
            b.ring(0.0355, 0.002, (-0.02, 0.0, 0.105), "signal red", (25, 10, 0), segments=16, sides=3)
    size = ((0.29, 0.235, 0.13), (0.28, 0.255, 0.17))[variant]
    return varied(b, rng, size, f"a {style} baseball glove", style)


@recipe("tennis racket", 3, name="sports_gear.tennis_racket")
def tennis_racket(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Red and white, black and lime, old wooden one; lying, the head at +x."""
    b = MeshBuilder(roughness=0.4)
    style = ("red", "black and lime", "old wooden")[variant]
    frame, grip = (("signal red", "white"), ("black", "lime"), ("wood", "brown"))[variant]
    a, c = (0.172, 0.126) if variant < 2 else (0.15, 0.115)
    loop = [(x, y, 0) for x, y in ellipse(a, c, 30)]
    b.tube(loop, 0.0095, frame, sides=6, closed=True)
    for k in range(-6, 7):
        y = c * k / 7.2
        x = a * np.sqrt(1 - (y / c) ** 2)
        b.box((2 * x, 0.0014, 0.0012), (0, y, -0.0006), "off white")
    for k in range(-8, 9):
        x = a * k / 9.2
        y = c * np.sqrt(1 - (x / a) ** 2)
        b.box((0.0014, 2 * y, 0.0012), (x, 0, 0.0004), "off white")
    for s in (-1, 1):
        b.tube(
            curve([(-a * 0.82, s * c * 0.57, 0), (-a - 0.06, s * 0.022, 0), (-a - 0.13, s * 0.008, 0)], 3),
            0.009,
            frame,
            sides=6,
        )
    b.box((0.16, 0.022, 0.02), (-a - 0.17, 0, -0.01), frame, bevel=0.005)
    b.lathe(
        [(0.017, 0.0), (0.0195, 0.006), (0.0165, 0.03), (0.0165, 0.19)],
        (-a - 0.345, 0, 0),
        grip,
        (0, 90, 0),
        segments=8,
    )
    for k in range(7):
        b.ring(0.0165, 0.0013, (-a - 0.31 + 0.024 * k, 0, 0), shade(grip, 0.7), (0, 84, 0), segments=8, sides=3)
    size = ((0.685, 0.265, 0.031), (0.69, 0.27, 0.034), (0.66, 0.245, 0.03))[variant]
    return varied(b, rng, size, f"a {style} tennis racket", style)


@recipe("table tennis", 2, hulls=1, name="sports_gear.table_tennis")
def table_tennis(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A bat with its ball; two bats crossed with a ball."""
    b = MeshBuilder(roughness=0.6)
    style = ("bat and ball", "two bats and a ball")[variant]

    def bat(rubber: Color, other: Color) -> None:
        blade = pairs(
            curve(
                [
                    (-0.075, 0.02),
                    (-0.045, 0.062),
                    (0.02, 0.076),
                    (0.075, 0.045),
                    (0.083, 0.0),
                    (0.075, -0.045),
                    (0.02, -0.076),
                    (-0.045, -0.062),
                    (-0.075, -0.02),
                ],
                3,
            )
        )
        b.extrude(blade, 0.006, (0, 0, 0.004), "light wood")
        face = [(x * 0.985 + 0.004, y * 0.985) for x, y in blade if x > -0.055]
        b.extrude(face, 0.003, (0, 0, 0.0098), rubber)
        b.extrude(face, 0.003, (0, 0, 0.0012), other)
        b.extrude(
            [(-0.165, -0.017), (-0.165, 0.017), (-0.11, 0.0125), (-0.07, 0.02), (-0.07, -0.02), (-0.11, -0.0125)],
            0.021,
            (0, 0, -0.0035),
            "wood",
        )
        b.extrude(
            [(-0.16, -0.004), (-0.16, 0.004), (-0.085, 0.004), (-0.085, -0.004)], 0.0215, (0, 0, -0.0035), "dark blue"
        )

    bat("signal red", "black")
    if variant == 0:
        b.ball(0.02, (0.05, 0.05, 0.0235), "white", segments=14, rings=8)
    else:
        with b.frame((-0.01, 0.06, 0.026), (0, 0, -50)):
            bat("black", "signal red")
        b.ball(0.02, (0.07, -0.08, 0.0165), "orange", segments=14, rings=8)
    size = ((0.26, 0.155, 0.031), (0.28, 0.26, 0.055))[variant]
    return varied(b, rng, size, f"table tennis: {style}", style)


@recipe("frisbee", 3, hulls=1, name="sports_gear.frisbee")
def frisbee(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """White disc with a star, orange one with rings, small blue one; hollow below."""
    b = MeshBuilder(roughness=0.4)
    style = ("white with a star", "orange", "small blue")[variant]
    color: Color = ("white", "safety orange", "signal blue")[variant]
    b.lathe(
        [(0.127, 0.0), (0.1365, 0.006), (0.134, 0.02), (0.118, 0.029), (0.06, 0.031), (0.0, 0.031)],
        color=color,
        segments=36,
    )
    for r in (0.105, 0.09, 0.075):
        b.ring(r, 0.0012, (0, 0, 0.0302), shade(color, 0.8), segments=36, sides=4)
    if variant == 0:
        star = [(r * np.cos(a), r * np.sin(a)) for k in range(10) for r, a in (((0.06, 0.025)[k % 2], k * np.pi / 5),)]
        b.extrude(star, 0.001, (0, 0, 0.0305), "signal blue")
    else:
        b.extrude(
            ellipse(0.045, 0.045, 24),
            0.001,
            (0, 0, 0.0305),
            "black" if variant == 1 else "white",
            holes=[ellipse(0.033, 0.033, 24)],
        )
        b.extrude(rounded(0.05, 0.014, 0.006), 0.0012, (0, 0, 0.0305), "black" if variant == 1 else "white")
    size = ((0.273, 0.273, 0.031), (0.27, 0.27, 0.033), (0.22, 0.22, 0.025))[variant]
    return varied(b, rng, size, f"a flying disc, {style}", style, jitter=0.004)


@recipe("fishing rod", 2, name="sports_gear.fishing_rod")
def fishing_rod(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Spinning rod with its reel, short rod with a red float on the line; lying, the tip at +x."""
    b = MeshBuilder(roughness=0.35)
    style = ("spinning", "float")[variant]
    long = (2.2, 1.4)[variant]
    blank: Color = ("charcoal", "green")[variant]
    z = 0.085
    b.tube(
        [(-0.05, 0, z), (0.12, 0, z), (0.14, 0, z), (0.36, 0, z), (0.4, 0, z)],
        [0.012, 0.014, 0.016, 0.014, 0.009],
        "#b98a58",
        sides=10,
    )
    b.tube([(0.38, 0, z), (long * 0.6, 0, z), (long, 0, z)], [0.006, 0.0042, 0.0018], blank, sides=6)
    for k in range(7):
        x = 0.5 + (long - 0.52) * (k / 6) ** 0.85
        r = 0.016 - 0.0018 * k
        b.ring(r, 0.0015, (x, 0, z - r - 0.004), "aluminium", (0, 90, 0), segments=10, sides=4)
        b.cylinder(0.0065 - 0.0006 * k, 0.03, (x - 0.015, 0, z), "signal red", (0, 90, 0), segments=6)
    b.rod((0.2, 0, z - 0.01), (0.2, 0, z - 0.05), 0.006, "charcoal", sides=6)
    b.box((0.05, 0.03, 0.035), (0.195, 0, z - 0.075), "charcoal", bevel=0.008)
    b.lathe(
        [(0.024, 0.0), (0.018, 0.006), (0.018, 0.028), (0.025, 0.034)],
        (0.215, 0, z - 0.058),
        "aluminium",
        (0, 90, 0),
        segments=14,
    )
    b.tube(
        curve([(0.22, 0.0, z - 0.03), (0.255, 0.03, z - 0.045), (0.255, 0.03, z - 0.07), (0.22, 0.0, z - 0.088)], 3),
        0.002,
        "light grey",
        sides=4,
    )
    b.tube(
        [(0.19, 0.0, z - 0.06), (0.19, 0.05, z - 0.06), (0.165, 0.055, z - 0.06), (0.165, 0.07, z - 0.06)],
        0.004,
        "aluminium",
        sides=5,
    )
    b.ball(0.011, (0.165, 0.075, z - 0.06), "black", segments=8, rings=5)
    b.rod((0.24, 0, z - 0.05), (long, 0, z - 0.006), 0.0008, "light grey", sides=3)
    if variant == 1:
        b.lathe(
            [(0.002, -0.04), (0.014, 0.0), (0.014, 0.012), (0.004, 0.03)],
            (long - 0.1, 0.0, 0.016),
            "signal red",
            (0, 90, 0),
            segments=10,
        )
        b.rod((long, 0, z), (long - 0.06, 0, 0.016), 0.0008, "light grey", sides=3)
    size = ((2.3, 0.12, 0.1), (1.5, 0.11, 0.105))[variant]
    return varied(b, rng, size, f"a {style} fishing rod", style)
