"""Toilets and urinals; the user stands at +x."""

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import shade
from ...meshes.recipe import recipe
from ..shared.facade_images import door, sign
from ..shared.sizes import made
from ..urban_object.furniture.bathroom import basin, egg


@recipe("toilets", 3, name="sanitary.toilets")
def toilets(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A close-coupled bowl with its cistern, one with the lid up, a whole cubicle with the bowl inside."""
    b = MeshBuilder(roughness=0.25)
    if variant % 3 == 2:
        b.box((1.5, 1.0, 0.06), color="light grey")
        b.box((0.05, 1.0, 2.1), (-0.72, 0, 0.05), "teal")
        for s in (-1, 1):
            b.box((1.5, 0.04, 1.9), (0, s * 0.48, 0.2), "teal")
        b.box((1.54, 1.04, 0.05), (0, 0, 2.1), "white", bevel=0.01)
        with b.frame((0.72, -0.46, 0.2), (0, 0, -35)):
            b.box((0.03, 0.86, 1.85), (0, 0.43, 0), "signal blue", skins={"+x": door("signal blue", "panel")})
        b.panel(sign("WC", "signal blue", "white", (40, 20)), (0.772, 0.0, 2.125), 0.3, 0.05)
    with b.frame((-0.35 if variant % 3 == 2 else 0, 0, 0.06 if variant % 3 == 2 else 0)):
        bowl = egg(0.25, 0.185, 2.2, 24, 0.1)
        b.loft(
            [
                np.column_stack([np.array(egg(0.22, 0.13, 3)), np.full(24, 0.0)]),
                np.column_stack([np.array(egg(0.2, 0.11, 3)), np.full(24, 0.15)]),
                np.column_stack([np.array(bowl) * 0.9 + (0.04, 0), np.full(24, 0.3)]),
            ],
            "white",
            crease_deg=60,
        )
        basin(b, bowl, 0.045, 0.14, 0.4, "white", 0.85, (0.06, 0))
        b.cylinder(0.09, 0.005, (0.08, 0, 0.29), "water", segments=16)
        ring = egg(0.255, 0.188, 2.2, 24, 0.1)
        b.extrude(ring, 0.02, (0.06, 0, 0.4), "off white", holes=[[(x * 0.68, y * 0.66) for x, y in ring]])
        if variant % 3 == 0:
            b.extrude(ring, 0.018, (0.06, 0, 0.422), "white")
        else:
            with b.frame((-0.17, 0, 0.42), (0, -85, 0)):
                b.extrude(
                    [(x + 0.23, y) for x, y in ring], 0.018, (0, 0, 0), "off white" if variant % 3 == 2 else "wood"
                )
        b.box((0.17, 0.36, 0.36), (-0.27, 0, 0.4), "white", bevel=0.02, taper=(1.1, 1.06))
        b.box((0.2, 0.4, 0.03), (-0.27, 0, 0.76), "white", bevel=0.01)
        b.cylinder(0.025, 0.012, (-0.27, 0, 0.79), "aluminium", segments=14)
        b.box((0.16, 0.2, 0.4), (-0.22, 0, 0.0), "white", bevel=0.03)
    size = ((0.68, 0.38, 0.8), (0.7, 0.39, 0.84), (1.7, 1.1, 2.2))[variant % 3]
    return made(b, ("a toilet", "a toilet with its lid up", "a toilet cubicle")[variant % 3], size)


@recipe("urinal", 2, name="sanitary.urinal")
def urinal(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A ceramic bowl with a tall back, a long steel stall."""
    b = MeshBuilder(roughness=0.25)
    color = ("white", "aluminium")[variant % 2]
    t = np.radians(np.linspace(-90, 90, 13))
    rows = []
    for z, deep, lip in (
        (0.0, 0.12, 0.3),
        (0.06, 0.26, 0.55),
        (0.18, 0.32, 0.7),
        (0.26, 0.33, 0.74),
        (0.3, 0.16, 0.85),
        (0.48, 0.12, 0.95),
        (0.58, 0.1, 0.85),
        (0.6, 0.06, 0.7),
    ):
        half = 0.18 * lip
        outer = [(deep * float(np.cos(a)), half * float(np.sin(a)) * 1.0) for a in t]
        rows.append(np.column_stack([[(-0.0, -half), *outer[1:-1], (0.0, half)], np.full(13, z)]))
    b.loft(rows, color, crease_deg=60)
    hole = [(0.27 * x, 0.105 * y) for x, y in egg(0.5, 1.0, 2.2, 18)]
    b.extrude(hole, 0.004, (0.17, 0, 0.258), shade(color, 0.5))
    b.ball((0.05, 0.11, 0.16), (0.125, 0, 0.42), shade(color, 0.82), segments=16, rings=8)
    b.cylinder(0.03, 0.003, (0.2, 0, 0.262), "dark grey", segments=14)
    b.rod((0.05, 0, 0.59), (0.05, 0, 0.69), 0.014, "aluminium", sides=10)
    b.cylinder(0.028, 0.04, (0.03, 0, 0.66), "aluminium", turn_deg=(0, 90, 0), segments=14)
    b.rod((0.06, 0, -0.06), (0.06, 0, 0.02), 0.02, "aluminium", sides=10)
    return made(b, f"a {color} urinal", ((0.33, 0.36, 0.6), (0.3, 0.4, 0.95))[variant % 2], color=color)
