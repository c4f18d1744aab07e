"""Lanterns."""

import numpy as np

from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.recipe import recipe
from ...shared.outlines import arc
from ...shared.sizes import made


@recipe("lantern", 3, name="masts.lantern")
def lantern(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A square glass lantern with a candle, a round paper lantern, a storm lantern with its bail."""
    b = MeshBuilder(roughness=0.5)
    style = ("glass", "paper", "storm")[variant % 3]
    if style == "glass":
        b.box((0.18, 0.18, 0.02), color="charcoal", bevel=0.005)
        for x in (-0.075, 0.075):
            for y in (-0.075, 0.075):
                b.box((0.012, 0.012, 0.2), (x, y, 0.02), "charcoal")
        b.cylinder(0.03, 0.08, (0, 0, 0.02), "cream", segments=14)
        b.lathe([(0.0, 0), (0.008, 0.012), (0, 0.035)], (0, 0, 0.105), "amber", segments=8)
        for z in (0.09, 0.155):
            for k in range(4):
                with b.frame((0, 0, z), (0, 0, 90 * k)):
                    b.box((0.006, 0.15, 0.006), (0.075, 0, 0), "charcoal")
        b.box((0.19, 0.19, 0.014), (0, 0, 0.22), "charcoal", bevel=0.004)
        b.box((0.16, 0.16, 0.06), (0, 0, 0.234), "charcoal", taper=(0.3, 0.3))
        b.ring(0.035, 0.005, (0, 0, 0.325), "charcoal", (90, 0, 0), 16, 6)
        size = (0.19, 0.19, 0.36)
    elif style == "paper":
        z = np.linspace(-1, 1, 15)
        ribs = np.sqrt(1 - 0.86 * z**2) * (1 - 0.04 * (np.arange(15) % 2))
        b.lathe([(0.19 * r, 0.22 + 0.17 * h) for r, h in zip(ribs, z, strict=True)], color="signal red", crease_deg=15)
        for level in (0.035, 0.39):
            b.cylinder(0.075, 0.02, (0, 0, level), "gold")
        b.cylinder(0.012, 0.06, (0, 0, -0.02), "gold", segments=8)
        b.lathe([(0.02, -0.14), (0.014, -0.05), (0.01, -0.02)], color="gold", segments=10)
        b.rod((0, 0, 0.4), (0, 0, 0.5), 0.003, "black", sides=4)
        size = (0.38, 0.38, 0.66)
    else:
        b.lathe([(0.08, 0), (0.085, 0.01), (0.08, 0.06), (0.03, 0.08), (0.045, 0.09)], color="dark red", segments=18)
        globe = [(0.04, 0.09), (0.06, 0.13), (0.058, 0.17), (0.035, 0.21)]
        b.lathe(globe, color="lamp", segments=18)
        b.lathe([(0.05, 0.21), (0.05, 0.225), (0.03, 0.25), (0.032, 0.28), (0.0, 0.295)], color="dark red", segments=18)
        for side in (-1, 1):
            b.tube(
                [(0, side * 0.075, 0.05), (0, side * 0.085, 0.13), (0, side * 0.07, 0.22), (0, side * 0.03, 0.26)],
                0.008,
                "dark red",
                sides=6,
            )
        b.tube([(0, y, z) for y, z in arc(0.085, 0, 180, 11, (0, 0.24))], 0.003, "galvanised", sides=5)
        size = (0.17, 0.17, 0.33)
    return made(b, f"a {style} lantern", size, style=style)
