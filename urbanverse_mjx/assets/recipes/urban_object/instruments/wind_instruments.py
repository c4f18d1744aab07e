"""Flutes, saxophones, trumpets and accordions."""

import numpy as np

from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, shade
from ....meshes.recipe import recipe
from ....meshes.shapes import Shape
from ...shared.outlines import curve
from ...shared.sizes import varied


@recipe("flute", 3, hulls=1, name="wind_instruments.flute")
def flute(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Silver concert flute with keys, wooden recorder, black piccolo; lying, the open end at +x."""
    b = MeshBuilder(roughness=0.2, metallic=0.4)
    style = ("silver concert flute", "recorder", "black piccolo")[variant]
    if style == "recorder":
        with b.frame((-0.17, 0, 0.016), (0, 90, 0)):
            bore = [
                (0.012, 0.0),
                (0.014, 0.05),
                (0.019, 0.075),
                (0.014, 0.085),
                (0.013, 0.24),
                (0.018, 0.25),
                (0.018, 0.27),
                (0.012, 0.28),
                (0.016, 0.34),
            ]
            b.lathe(bore, color="light wood", segments=14)
            b.cylinder(0.0195, 0.008, (0, 0, 0.073), "cream", segments=14)
            b.cylinder(0.0185, 0.008, (0, 0, 0.256), "cream", segments=14)
        b.box((0.012, 0.012, 0.004), (-0.115, 0, 0.028), "black")
        for k in range(7):
            b.cylinder(0.0038, 0.003, (-0.06 + 0.024 * k + (0.03 if k == 6 else 0), 0, 0.028), "black", segments=10)
    else:
        metal: Color = "light grey" if variant == 0 else "charcoal"
        long = 0.64 if variant == 0 else 0.32
        with b.frame((-long / 2, 0, 0.012), (0, 90, 0)):
            b.cylinder(0.0095, long, color=metal, segments=14)
            for z in (0.0, 0.2 * long, 0.33 * long, 0.86 * long, 0.985 * long):
                b.cylinder(0.0115, 0.012 if z else 0.02, (0, 0, z), shade(metal, 0.85), segments=14)
        b.extrude(
            [(x, y) for x, y in ((-0.016, -0.011), (0.016, -0.011), (0.016, 0.011), (-0.016, 0.011))],
            0.003,
            (-long * 0.28, 0, 0.0195),
            metal,
        )
        b.cylinder(0.005, 0.001, (-long * 0.28, 0, 0.0225), "black", segments=10)
        b.rod((-long * 0.14, 0.0125, 0.017), (long * 0.47, 0.0125, 0.017), 0.002, "aluminium", sides=5)
        for k in range(13):
            x = long * (-0.13 + 0.046 * k)
            b.cylinder(0.0075, 0.003, (x, 0.0, 0.0215), "aluminium" if variant else "galvanised", segments=10)
            b.rod((x, 0.0125, 0.017), (x, 0.002, 0.023), 0.0014, "aluminium", sides=4)
    size = ((0.64, 0.0285, 0.027), (0.34, 0.034, 0.034), (0.33, 0.03, 0.026))[variant]
    return varied(b, rng, size, f"a {style}", style)


@recipe("saxophone", 2, name="wind_instruments.saxophone")
def saxophone(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Golden alto saxophone, dark one with golden keys; lying on its side, the bow at -x."""
    b = MeshBuilder(roughness=0.2, metallic=0.5)
    style = ("golden", "dark")[variant]
    metal, keys = (("gold", "brass"), ("#3c2f2a", "gold"))[variant]
    z = 0.07
    path = curve(
        [
            (0.36, -0.05, z),
            (0.33, 0.0, z),
            (0.25, 0.012, z),
            (0.0, 0.0, z),
            (-0.22, -0.012, z),
            (-0.3, 0.03, z),
            (-0.28, 0.1, z),
            (-0.2, 0.13, z),
            (-0.05, 0.15, z),
            (0.03, 0.165, z),
        ],
        4,
    )
    radii = np.interp(
        np.linspace(0, 1, len(path)), [0, 0.2, 0.55, 0.72, 0.9, 1.0], [0.007, 0.012, 0.026, 0.034, 0.042, 0.066]
    )
    b.tube(path, radii.tolist(), metal, sides=14)
    end, ahead = path[-1], path[-1] - path[-2]
    b.add(_dark_mouth(end + 0.0015 * ahead / np.linalg.norm(ahead), ahead, 0.058), "#4a3210")
    with b.frame(end, (0, 0, float(np.degrees(np.arctan2(ahead[1], ahead[0]))))):
        b.ring(0.065, 0.004, color=metal, turn_deg=(0, 90, 0), segments=20, sides=5)
    b.tube(
        [path[0], path[0] + [0.02, -0.035, 0], path[0] + [0.025, -0.07, 0]], [0.0095, 0.009, 0.005], "black", sides=8
    )
    for k in range(10):
        x, y = 0.22 - 0.045 * k, 0.01 - 0.0009 * k
        r = 0.009 + 0.0009 * k
        b.cylinder(r, 0.006, (x, y, z + 0.014 + 0.0026 * k), keys, segments=12)
        b.cylinder(r * 0.5, 0.008, (x, y, z + 0.014 + 0.0026 * k), "white", segments=8)
    for s in (-1, 1):
        b.rod((0.2, 0.03 * s, z + 0.012), (-0.2, 0.04 * s - 0.01, z + 0.02), 0.003, keys, sides=5)
    for x, y in ((-0.27, 0.06), (-0.16, 0.135), (-0.08, 0.145)):
        b.cylinder(0.026, 0.008, (x, y, z + 0.036), keys, segments=14)
        b.ring(0.022, 0.002, (x, y, z + 0.045), metal, segments=14, sides=4)
    size = ((0.68, 0.255, 0.15), (0.74, 0.27, 0.16))[variant]
    return varied(b, rng, size, f"a {style} saxophone", style)


def _dark_mouth(at: np.ndarray, axis: np.ndarray, radius: float) -> Shape:
    """A disc across an axis, seen from where the axis points."""
    n = axis / np.linalg.norm(axis)
    side = np.cross(n, (0, 0, 1.0))
    up = np.cross(side, n)
    a = np.arange(16) * (2 * np.pi / 16)
    points = at + radius * (np.cos(a)[:, None] * side - np.sin(a)[:, None] * up)
    k = np.arange(1, 15)
    faces = np.stack([np.zeros(14, int), k, k + 1], 1)
    normal = np.cross(points[1] - points[0], points[2] - points[0])
    return Shape(points, faces if normal @ n > 0 else faces[:, ::-1])


@recipe("trumpet", 2, name="wind_instruments.trumpet")
def trumpet(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Golden trumpet, silver one with a mute; upright, the bell along +x."""
    b = MeshBuilder(roughness=0.15, metallic=0.5)
    style = ("golden", "silver")[variant]
    metal: Color = ("gold", "light grey")[variant]
    z, r = 0.105, 0.0065
    with b.frame((-0.09, 0, z), (0, 90, 0)):
        flare = [
            (r, 0.0),
            (0.008, 0.14),
            (0.012, 0.2),
            (0.021, 0.24),
            (0.037, 0.262),
            (0.061, 0.275),
            (0.058, 0.274),
            (0.03, 0.255),
            (0.0, 0.2),
        ]
        b.lathe(flare, color=metal, segments=18)
        b.ring(0.06, 0.002, (0, 0, 0.275), metal, segments=18, sides=3)
    loop = curve(
        [
            (-0.09, 0.0, z),
            (-0.14, 0.004, z - 0.006),
            (-0.165, 0.008, z - 0.033),
            (-0.14, 0.012, z - 0.06),
            (-0.02, 0.014, z - 0.06),
        ],
        4,
    )
    b.tube(loop, r, metal, sides=6)
    slide = curve(
        [
            (-0.3, 0.022, z),
            (0.0, 0.022, z),
            (0.08, 0.022, z - 0.005),
            (0.105, 0.022, z - 0.03),
            (0.08, 0.022, z - 0.057),
            (-0.02, 0.02, z - 0.06),
        ],
        3,
    )
    b.tube(slide, r * 0.85, metal, sides=6)
    with b.frame((-0.3, 0.022, z), (0, -90, 0)):
        b.lathe(
            [(0.005, -0.01), (0.006, 0.03), (0.013, 0.045), (0.0145, 0.052), (0.01, 0.052), (0.0, 0.04)],
            color=shade(metal, 0.9),
            segments=10,
        )
    for k in range(3):
        x = -0.065 + 0.033 * k
        b.cylinder(0.0125, 0.105, (x, 0.011, 0.012), metal, segments=10)
        for low in (0.004, 0.112):
            b.cylinder(0.0138, 0.01, (x, 0.011, low), shade(metal, 0.85), segments=10)
        b.rod((x, 0.011, 0.12), (x, 0.011, 0.14), 0.003, "aluminium", sides=6)
        b.cylinder(0.0085, 0.005, (x, 0.011, 0.14), "white", segments=8)
        b.tube(
            [
                (x, 0.011, 0.07 - 0.012 * k),
                (x, -0.028, 0.07 - 0.012 * k),
                (x, -0.028, 0.055 - 0.012 * k),
                (x, 0.011, 0.055 - 0.012 * k),
            ],
            0.005,
            metal,
            sides=6,
        )
    b.ring(0.012, 0.003, (0.06, 0.022, z + 0.018), metal, (90, 0, 0), segments=8, sides=5)
    if variant == 1:
        with b.frame((0.15, 0, z), (0, 90, 0)):
            b.lathe([(0.018, 0.0), (0.04, 0.08), (0.034, 0.1), (0.0, 0.1)], color="signal red", segments=18)
    size = ((0.48, 0.13, 0.158), (0.53, 0.128, 0.165))[variant]
    return varied(b, rng, size, f"a {style} trumpet", style)


@recipe("accordion", 2, hulls=1, name="wind_instruments.accordion")
def accordion(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Red piano accordion, black button accordion with pearl: keys at the viewer's left, bellows, bass buttons."""
    b = MeshBuilder(roughness=0.25)
    style = ("red piano", "black button")[variant]
    body: Color = ("red", "black")[variant]
    b.box((0.19, 0.13, 0.38), (0, -0.15, 0), body, bevel=0.016)
    b.box((0.19, 0.1, 0.34), (0, 0.19, 0.02), body, bevel=0.016)
    folds = 9
    for k in range(2 * folds + 1):
        y0 = -0.085 + 0.225 * k / (2 * folds + 1)
        deep = 0.17 if k % 2 else 0.186
        b.box(
            (deep, 0.225 / (2 * folds + 1), 0.3 + (0.016 if not k % 2 else 0)),
            (0, y0 + 0.006, 0.03 - (0.008 if not k % 2 else 0)),
            "white" if k % 2 else "charcoal",
        )
    with b.frame((0.0, -0.215, 0.0)):
        b.box((0.11, 0.05, 0.36), (0.02, 0.01, 0.01), "charcoal")
        if variant == 0:
            for k in range(16):
                b.box((0.085, 0.012, 0.0195), (0.04, -0.02, 0.02 + 0.0212 * k), "white")
                if k % 7 not in (2, 6) and k < 15:
                    b.box((0.05, 0.012, 0.011), (0.055, -0.028, 0.0355 + 0.0212 * k), "black")
        else:
            for k in range(30):
                place = (0.026 * (k % 3), -0.012, 0.03 + 0.031 * (k // 3) + 0.008 * (k % 3))
                b.cylinder(0.0085, 0.012, place, "white" if k % 4 else "charcoal", (90, 0, 0), segments=6)
    grille = [(0.0, 0.03), (0.09, 0.05), (0.11, 0.19), (0.09, 0.33), (0.0, 0.35)]
    b.extrude(
        [(y - 0.05, z) for y, z in grille],
        0.006,
        (0.093, -0.155, 0),
        "light grey" if variant == 0 else "gold",
        (90, 0, 90),
    )
    for k in range(5):
        b.box((0.008, 0.06 - 0.01 * abs(k - 2), 0.012), (0.097, -0.135, 0.09 + 0.045 * k), "black")
    for k in range(30):
        b.cylinder(
            0.005, 0.008, (-0.05 + 0.022 * (k % 5), 0.238, 0.07 + 0.04 * (k // 5)), "white", (-90, 0, 0), segments=6
        )
    b.tube(
        curve([(-0.09, -0.12, 0.36), (-0.14, -0.1, 0.3), (-0.14, -0.1, 0.1), (-0.09, -0.12, 0.02)], 3),
        0.012,
        "black",
        sides=6,
    )
    size = ((0.213, 0.46, 0.38), (0.2, 0.42, 0.35))[variant]
    return varied(b, rng, size, f"a {style} accordion", style)
