"""Slender things that stand on a pavement: bollards."""

import numpy as np

from ..mesh_builder import BuiltAsset, MeshBuilder
from ..recipe import Physics, recipe


@recipe(
    "bollard",
    variants=4,
    physics=Physics(
        ("steel", "concrete"), 3000.0, (20.0, 220.0), 0.6, False, "set in the ground: heavy solid steel or concrete, never shifted by hand"
    ),
    hulls=1,
)
def bollard(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Steel post with bands, cast-iron ball top, concrete block, flexible delineator."""
    b = MeshBuilder(roughness=0.5)
    style = ("steel", "ball", "concrete", "flexible")[variant % 4]
    height = float(rng.uniform(0.85, 1.05))
    if style == "steel":
        radius = float(rng.uniform(0.055, 0.075))
        b.cylinder(radius, height, color="charcoal", segments=20)
        b.lathe([(radius, 0), (radius * 0.8, 0.02), (0, 0.03)], (0, 0, height), "charcoal", segments=20)
        for z in (0.62, 0.8):
            b.cylinder(radius + 0.003, 0.07, (0, 0, height * z), "white", segments=20)
        b.cylinder(radius * 1.7, 0.012, color="dark grey", segments=20)
    elif style == "ball":
        r = 0.07
        b.lathe(
            [(0.13, 0), (0.13, 0.08), (0.1, 0.13), (r, 0.18), (r * 0.82, height * 0.72), (r * 1.2, height * 0.75), (r * 1.2, height * 0.8)]
            + [(r * 0.6, height * 0.84)],
            color="black",
        )
        b.ball(0.09, (0, 0, height * 0.84 + 0.07), "black")
        b.cylinder(r * 1.02, 0.05, (0, 0, height * 0.6), "gold")
    elif style == "concrete":
        b.lathe([(0.2, 0), (0.19, height * 0.55), (0.17, height * 0.7), (0.1, height * 0.78), (0, height * 0.8)], color="concrete", segments=20)
    else:
        b.cylinder(0.12, 0.04, color="black")
        b.cylinder(0.04, height, (0, 0, 0.03), "safety orange", top_radius=0.035)
        for z in (0.55, 0.75):
            b.cylinder(0.043, 0.08, (0, 0, height * z), "white")
    return b.build(f"a {style} bollard", {"style": style})
