"""Barbecue grills and solar panels."""

import numpy as np

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.recipe import recipe
from ..shared.facade_images import sign
from ..shared.outlines import arc, pairs
from ..shared.sizes import made


def _grill_cart(b: MeshBuilder) -> None:
    b.box((0.5, 0.6, 0.03), (0, 0, 0.14), "charcoal", bevel=0.006)
    b.box((0.5, 0.6, 0.55), (0, 0, 0.15), "dark grey", bevel=0.008)
    for y in (-0.15, 0.15):
        b.box((0.02, 0.27, 0.46), (0.25, y, 0.18), "charcoal", bevel=0.006)
        b.rod((0.275, y * 0.35, 0.3), (0.275, y * 0.35, 0.52), 0.009, "aluminium")
    b.box((0.52, 0.64, 0.16), (0, 0, 0.7), "aluminium", bevel=0.01)
    for k in range(3):
        b.cylinder(0.03, 0.03, (0.26, -0.18 + 0.18 * k, 0.78), "black", turn_deg=(0, 90, 0))
    b.profile([(-0.26, 0.86), (0.26, 0.86), *pairs(arc(0.26, 0, 180, 9, (0, 0.9), 0.75))], 0.62, color="black")
    b.tube([(0.25, -0.22, 0.95), (0.31, -0.22, 0.97), (0.31, 0.22, 0.97), (0.25, 0.22, 0.95)], 0.012, "aluminium")
    b.cylinder(0.04, 0.012, (0.2, 0, 1.01), "white", turn_deg=(0, 55, 0))
    for side in (-1, 1):
        b.box((0.4, 0.24, 0.03), (0, side * 0.44, 0.82), "aluminium", bevel=0.008)
        b.cylinder(0.075, 0.03, (-0.18, side * 0.28 + 0.015, 0.075), "rubber", turn_deg=(90, 0, 0))
        b.box((0.05, 0.05, 0.15), (0.2, side * 0.26, 0), "charcoal")


@recipe("barbecue grill", 3, name="yard_things.barbecue_grill")
def barbecue_grill(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A gas cart with a hood and side shelves, a kettle on three legs, a park grill on a post."""
    b = MeshBuilder(roughness=0.4)
    if variant % 3 == 0:
        _grill_cart(b)
        return made(b, "a gas grill on a cart", (0.6, 1.1, 1.07), style="gas cart")
    if variant % 3 == 1:
        color = "dark red"
        bowl = [(0.02, 0.5), (0.15, 0.53), (0.25, 0.62), (0.285, 0.72)]
        b.lathe([*bowl, (0.29, 0.725)], color=color, segments=24)
        b.lathe([(0.29, 0.735), (0.28, 0.78), (0.2, 0.9), (0.06, 0.96), (0, 0.965)], color=color, segments=24)
        b.ring(0.288, 0.008, (0, 0, 0.73), "black", segments=24, sides=6)
        b.tube([(0, -0.06, 0.95), (0, -0.05, 1.0), (0, 0.05, 1.0), (0, 0.06, 0.95)], 0.012, "black")
        b.cylinder(0.04, 0.01, (0.16, 0, 0.915), "aluminium", turn_deg=(0, 35, 0))
        for k in range(3):
            a = 2 * np.pi * k / 3 + 0.5
            foot = (0.31 * np.cos(a), 0.31 * np.sin(a), 0.07 if k else 0.0)
            b.rod((0.18 * np.cos(a), 0.18 * np.sin(a), 0.56), foot, 0.013, "aluminium")
            if k:
                b.cylinder(0.075, 0.03, (foot[0], foot[1] + 0.015, 0.075), "black", turn_deg=(90, 0, 0))
        b.lathe([(0.14, 0.3), (0.15, 0.32), (0.14, 0.325)], color="aluminium", segments=18)
        b.box((0.03, 0.12, 0.03), (0.0, 0.34, 0.7), "wood", bevel=0.008)
        return made(b, "a kettle grill", (0.6, 0.68, 1.0), style="kettle")
    b.cylinder(0.045, 0.6, color="charcoal")
    b.cylinder(0.16, 0.03, color="concrete")
    for side in (-1, 1):
        b.box((0.4, 0.02, 0.25), (0, side * 0.26, 0.6), "charcoal", bevel=0.004)
        b.box((0.06, 0.16, 0.02), (0.1, side * 0.33, 0.8), "light wood", bevel=0.005)
    b.box((0.02, 0.52, 0.25), (-0.2, 0, 0.6), "charcoal")
    b.box((0.4, 0.52, 0.02), (0, 0, 0.6), "charcoal")
    for k in range(13):
        b.rod((-0.2, -0.24 + 0.04 * k, 0.8), (0.2, -0.24 + 0.04 * k, 0.8), 0.006, "dark grey", sides=5)
    for x in (-0.18, 0.2):
        b.rod((x, -0.26, 0.8), (x, 0.26, 0.8), 0.008, "dark grey", sides=5)
    for _ in range(12):
        x, y = rng.uniform((-0.15, -0.2), (0.15, 0.2))
        b.box(
            (0.06, 0.06, 0.05),
            (float(x), float(y), 0.62),
            ("black", "orange", "dark red")[int(rng.integers(3))],
            (10, 20, 40),
        )
    for x in (-0.05, 0.1):
        b.ball((0.07, 0.05, 0.015), (x, -0.08 + x, 0.82), "brown", segments=10, rings=6)
    return made(b, "a park grill on a post", (0.46, 0.85, 0.9), style="park")


@recipe("solar energy infrastructure", 3, name="yard_things.solar_panels")
def solar_panels(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """One tilted panel on its frame, a ground array of two rows, a panel on a mast with its battery box; sun at +x."""
    b = MeshBuilder(roughness=0.25)
    image, draw = paint.canvas((120, 72), (20, 38, 82))
    for k in range(11):
        draw.line((12 * k, 0, 12 * k, 72), fill=(120, 138, 172))
    for k in range(7):
        draw.line((0, 12 * k, 120, 12 * k), fill=(120, 138, 172))
    draw.polygon([(20, 0), (50, 0), (14, 72), (0, 72), (0, 40)], fill=(44, 66, 118))

    def module(at: tuple[float, float, float], wide: float, tall: float, tilt: float) -> None:
        with b.frame(at, (0, -tilt, 0)):
            b.box((0.035, wide, tall), color="aluminium", skins={"+x": image})

    if variant % 3 == 0:
        module((0.3, 0, 0.3), 1.72, 1.05, 32.0)
        for y in (-0.65, 0.65):
            b.beam((0.34, y, 0.02), (-0.32, y, 0.02), 0.05, 0.04, "galvanised", bevel=0.006)
            b.beam((0.28, y, 0.02), (0.28, y, 0.34), 0.05, 0.04, "galvanised", bevel=0.006)
            b.beam((-0.22, y, 0.02), (-0.22, y, 1.1), 0.05, 0.04, "galvanised", bevel=0.006)
            b.box((0.2, 0.2, 0.06), (0.2, y, 0), "concrete", bevel=0.01)
            b.box((0.2, 0.2, 0.06), (-0.22, y, 0), "concrete", bevel=0.01)
        return made(b, "a solar panel on its frame", (0.7, 1.76, 1.2), panels=1)
    if variant % 3 == 1:
        for row in range(2):
            for c in range(5):
                z, x = 0.6 + 0.82 * row, 0.95 - 0.62 * row
                module((x, (c - 2) * 1.75, z), 1.7, 1.0, 37.0)
        for y in (-3.6, -1.2, 1.2, 3.6):
            b.cylinder(0.05, 0.75, (0.8, y, 0), "galvanised", segments=10)
            b.cylinder(0.05, 1.7, (-0.1, y, 0), "galvanised", segments=10)
            b.beam((0.95, y, 0.55), (-0.28, y, 2.16), 0.06, 0.08, "galvanised")
        b.box((0.3, 0.5, 0.7), (-0.2, 3.0, 0.5), "light grey", bevel=0.02)
        return made(b, "a ground array of ten solar panels", (1.9, 8.8, 2.2), panels=10)
    b.cylinder(0.05, 2.7, color="galvanised")
    b.cylinder(0.15, 0.03, color="dark grey")
    module((0.22, 0, 2.6), 1.2, 0.75, 40.0)
    b.rod((0.0, 0, 2.5), (0.02, 0, 2.85), 0.04, "galvanised")
    b.box((0.25, 0.35, 0.5), (0.02, 0, 1.5), "light grey", bevel=0.02)
    b.panel(sign("SOLAR", "light grey", "signal blue", (56, 16)), (0.148, 0, 1.8), 0.28, 0.08)
    return made(b, "a solar panel on a mast", (0.6, 1.2, 3.2), panels=1)
