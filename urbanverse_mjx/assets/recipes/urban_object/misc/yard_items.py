"""Objects of yards and car parks: shopping carts, vehicle wheels, air pumps, easels."""

import numpy as np

from ....meshes import paint
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, rgb
from ....meshes.recipe import recipe
from ...shared.facade_images import sign
from ...shared.sizes import made
from ...vehicle.wheels import rim_image, wheel


def _wires(b: MeshBuilder, corners: np.ndarray, across: int, up: int, color: Color, radius: float = 0.004) -> None:
    """A grid of wires over four corners (lower left, lower right, upper right, upper left)."""
    a, c, d, e = corners
    for s in np.linspace(0, 1, across):
        b.rod(a + (c - a) * s, e + (d - e) * s, radius, color, sides=4)
    for s in np.linspace(0, 1, up):
        b.rod(a + (e - a) * s, c + (d - c) * s, radius, color, sides=4)


@recipe("shopping cart", 3, name="yard_things.shopping_cart")
def shopping_cart(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A wire basket tapering to the front on a wheeled frame, with a coloured handle; the user pushes from -x."""
    b = MeshBuilder(roughness=0.4, metallic=0.2)
    accent, wire, low = (
        ("signal red", "aluminium", 0.5),
        ("signal blue", "aluminium", 0.42),
        ("green", "light grey", 0.62),
    )[variant % 3]
    # (x, half width, z) of the basket's rim and floor, at the back and at the front.
    rim = {"back": np.array([-0.34, 0.27, 0.93]), "front": np.array([0.48, 0.21, 0.84])}
    base = {"back": np.array([-0.3, 0.23, low]), "front": np.array([0.4, 0.18, low + 0.06])}
    flip = np.array([1, -1, 1])
    for s in (np.ones(3), flip):
        _wires(b, np.array([base["back"] * s, base["front"] * s, rim["front"] * s, rim["back"] * s]), 12, 5, wire)
    for end in ("back", "front"):
        _wires(b, np.array([base[end] * flip, base[end], rim[end], rim[end] * flip]), 8, 5, wire)
    _wires(b, np.array([base["back"] * flip, base["back"], base["front"], base["front"] * flip]), 7, 9, wire)
    loop = [rim["back"], rim["front"], rim["front"] * flip, rim["back"] * flip]
    b.tube(loop, 0.009, wire, sides=6, closed=True)
    for side in (-1, 1):
        b.tube(
            [
                (-0.45, side * 0.25, 1.0),
                (-0.34, side * 0.26, 0.95),
                (-0.32, side * 0.25, low),
                (-0.36, side * 0.27, 0.16),
                (0.36, side * 0.2, 0.2),
            ],
            0.012,
            wire,
            sides=6,
        )
        b.rod((0.3, side * 0.2, 0.2), (0.2, side * 0.2, low + 0.03), 0.012, wire, sides=6)
        for x, y in ((-0.36, 0.27), (0.34, 0.2)):
            b.cylinder(0.06, 0.028, (x, side * y + 0.014, 0.06), "dark grey", turn_deg=(90, 0, 0), segments=14)
            b.box((0.05, 0.045, 0.08), (x, side * y, 0.08), "charcoal", taper=(0.6, 0.8))
    b.rod((-0.45, -0.25, 1.0), (-0.45, 0.25, 1.0), 0.017, accent, sides=10)
    b.box((0.02, 0.24, 0.08), (-0.3, 0, 0.84), accent, bevel=0.006)
    _wires(b, np.array([(-0.3, -0.22, 0.19), (-0.3, 0.22, 0.19), (0.34, 0.17, 0.22), (0.34, -0.17, 0.22)]), 5, 4, wire)
    b.box((0.012, 0.36, 0.1), (0.478, 0, 0.7), accent, turn_deg=(0, 8, 0))
    size = ((0.98, 0.58, 1.02), (1.08, 0.62, 1.06), (0.86, 0.55, 1.0))[variant % 3]
    return made(b, f"a shopping cart with a {accent} handle", size, 0.5, handle=accent)


@recipe("vehicle wheel", 3, name="yard_things.vehicle_wheel")
def vehicle_wheel(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A car wheel with alloy spokes, a steel one with a cap, a lorry's; standing, axle along y."""
    b = MeshBuilder(roughness=0.7)
    style, radius, width, share = (
        ("spokes5", 0.316, 0.215, 0.66),
        ("steel", 0.29, 0.175, 0.62),
        ("truck", 0.44, 0.3, 0.6),
    )[variant % 3]
    b_rim = rim_image(style, "aluminium" if variant % 3 != 1 else "light grey", 96)
    wheel(b, (0, 0, radius), radius, width, b_rim, 1.0, share, segments=32)
    b.panel(b_rim, (0, -width / 2 * 0.6, radius), radius * 0.9, radius * 0.9, "-y")
    grooves = (-0.3, -0.1, 0.1, 0.3) if variant % 3 < 2 else (-0.25, 0.0, 0.25)
    for g in grooves:
        b.ring(radius * 0.997, 0.004, (0, g * width, radius), "black", (90, 0, 0), 28, 4)
    for k in range(28):
        a = 2 * np.pi * k / 28
        for side in (-1, 1):
            b.box(
                (0.012, width * 0.16, 0.01),
                (radius * 0.95 * np.sin(a), side * width * 0.38, radius + radius * 0.95 * np.cos(a) - 0.005),
                "charcoal",
                turn_deg=(0, float(np.degrees(a)), 0),
            )
    return made(b, f"a vehicle wheel with a {style} rim", (2 * radius, width, 2 * radius), rim=style)


@recipe("air pump", 3, name="yard_things.air_pump")
def air_pump(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A bicycle floor pump, a forecourt tyre inflator on a post, a foot pump with two barrels."""
    b = MeshBuilder(roughness=0.45)
    if variant % 3 == 0:
        b.box((0.2, 0.07, 0.02), color="charcoal", bevel=0.006)
        b.cylinder(0.022, 0.44, (0, 0, 0.02), "signal red", segments=18)
        b.cylinder(0.026, 0.03, (0, 0, 0.44), "black", segments=18)
        b.cylinder(0.007, 0.15, (0, 0, 0.46), "aluminium", segments=10)
        b.rod((0, -0.09, 0.61), (0, 0.09, 0.61), 0.014, "black", sides=10)
        for y in (-0.065, 0.065):
            b.ball((0.02, 0.03, 0.02), (0, y, 0.61), "black", segments=10)
        b.cylinder(0.035, 0.02, (0.03, 0, 0.07), "black", turn_deg=(0, 90, 0), segments=18)
        b.cylinder(0.03, 0.003, (0.05, 0, 0.07), "white", turn_deg=(0, 90, 0), segments=18)
        b.rod((0.054, 0, 0.07), (0.054, 0.016, 0.085), 0.002, "signal red", sides=4)
        b.tube(
            [(-0.02, 0, 0.05), (-0.09, 0.02, 0.1), (-0.11, 0.02, 0.35), (-0.06, 0.01, 0.53), (-0.03, 0, 0.45)],
            0.006,
            "black",
        )
        b.box((0.03, 0.02, 0.05), (-0.03, 0, 0.4), "black", bevel=0.004)
        return made(b, "a bicycle floor pump", (0.24, 0.18, 0.62), style="floor pump")
    if variant % 3 == 1:
        b.box((0.26, 0.26, 0.04), color="charcoal", bevel=0.008)
        b.box((0.14, 0.18, 1.0), (0, 0, 0.03), "signal blue", bevel=0.02)
        b.cylinder(0.15, 0.1, (-0.05, 0, 1.17), "signal red", turn_deg=(0, 90, 0), segments=24)
        b.cylinder(0.125, 0.006, (0.05, 0, 1.17), "white", turn_deg=(0, 90, 0), segments=24)
        for k in range(9):
            a = np.radians(-220 + 32.5 * k)
            b.rod(
                (0.057, 0.085 * np.cos(a), 1.17 - 0.085 * np.sin(a)),
                (0.057, 0.11 * np.cos(a), 1.17 - 0.11 * np.sin(a)),
                0.004,
                "black",
                sides=4,
            )
        b.rod((0.06, 0, 1.17), (0.06, 0.06, 1.24), 0.005, "signal red", sides=4)
        b.panel(sign("AIR", "signal blue", "white", (40, 20)), (0.072, 0, 0.9), 0.15, 0.075)
        for k in range(3):
            b.ring(0.1 + 0.008 * k, 0.012, (0.09 + 0.02 * k, 0, 0.6), "black", (0, 90, 0), 18, 6)
        b.tube([(0.12, 0.1, 0.6), (0.12, 0.13, 0.35), (0.09, 0.09, 0.2), (0.08, 0.06, 0.45)], 0.011, "black")
        return made(b, "a tyre inflator on a post", (0.29, 0.27, 1.34), style="inflator")
    b.box((0.28, 0.12, 0.012), color="charcoal", bevel=0.004)
    for y in (-0.03, 0.03):
        with b.frame((-0.11, y, 0.04), (0, 68, 0)):
            b.cylinder(0.024, 0.2, color="signal yellow")
            b.cylinder(0.008, 0.06, (0, 0, 0.2), "aluminium", segments=8)
    for y in (-0.055, 0.055):
        b.rod((-0.12, y, 0.02), (0.1, y, 0.19), 0.008, "dark grey")
    b.box((0.09, 0.13, 0.02), (0.1, 0, 0.18), "black", turn_deg=(0, -20, 0), bevel=0.006)
    b.cylinder(0.03, 0.02, (-0.11, 0, 0.085), "white")
    b.tube([(-0.13, 0, 0.03), (-0.17, 0.05, 0.05), (-0.1, 0.085, 0.02), (0.1, 0.08, 0.02)], 0.006, "black")
    return made(b, "a foot pump", (0.3, 0.2, 0.23), style="foot pump")


@recipe("easel", 3, name="yard_things.easel")
def easel(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """An A-frame with a landscape on canvas, a studio easel with a portrait, a chalk board easel; image +x."""
    b = MeshBuilder(roughness=0.75)
    image, draw = paint.canvas((120, 90), "light blue")
    if variant % 3 == 0:
        draw.ellipse((84, 8, 104, 28), fill=rgb("signal yellow"))
        draw.polygon([(0, 60), (30, 26), (58, 56), (84, 34), (120, 62), (120, 90), (0, 90)], fill=(98, 110, 134))
        draw.polygon([(0, 64), (60, 56), (120, 66), (120, 90), (0, 90)], fill=rgb("grass"))
        draw.polygon([(50, 90), (62, 58), (66, 58), (84, 90)], fill=rgb("beige"))
    elif variant % 3 == 1:
        draw.rectangle((0, 0, 120, 90), fill=rgb("dark red"))
        draw.ellipse((42, 14, 78, 60), fill=rgb("skin light"))
        draw.pieslice((22, 54, 98, 140), 180, 360, fill=rgb("dark blue"))
        draw.pieslice((40, 8, 80, 46), 180, 360, fill=rgb("dark wood"))
    else:
        image, draw = paint.canvas((90, 110), (38, 44, 40))
        for k, words in enumerate(("OPEN", "LUNCH", "5 - 9")):
            paint.text(draw, words, (8, 8 + 32 * k, 82, 38 + 32 * k), ("white", "signal yellow", "pink")[k])
    wood = ("light wood", "wood", "dark wood")[variant % 3]
    w, h = ((0.62, 0.48), (0.5, 0.62), (0.55, 0.75))[variant % 3]
    for s in (-1, 1):
        b.beam((0.28, s * 0.36, 0), (0.02, s * 0.05, 1.66), 0.04, 0.025, wood, bevel=0.004)
    b.beam((-0.34, 0, 0), (0.0, 0, 1.6), 0.04, 0.025, wood, bevel=0.004)
    b.beam((0.13, -0.21, 0.72), (0.13, 0.21, 0.72), 0.05, 0.03, wood, bevel=0.004)
    b.box((0.08, w + 0.08, 0.03), (0.19, 0, 0.69), wood, bevel=0.005)
    if variant % 3 != 2:
        b.beam((0.22, 0, 0.3), (-0.02, 0, 1.68), 0.045, 0.025, wood, bevel=0.004)
    b.box((0.1, 0.1, 0.025), (0.05, 0, 0.72 + h), wood, bevel=0.004)
    with b.frame((0.2, 0, 0.72), (0, -9, 0)):
        b.box((0.025, w, h), color="white" if variant % 3 != 2 else wood, bevel=0.004, skins={"+x": image})
    size = ((0.75, 0.66, 1.68), (0.7, 0.6, 1.9), (0.68, 0.6, 1.35))[variant % 3]
    return made(b, "an easel with a picture" if variant % 3 < 2 else "an easel with a chalk board", size, wood=wood)
