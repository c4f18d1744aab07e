"""Bollards and guard stones."""

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.recipe import Physics, recipe

CAST_IN = "set in the ground: heavy solid steel, stone or concrete, never shifted by hand"


@recipe(
    "bollard",
    4,
    Physics(("steel", "concrete"), 3000.0, (20.0, 220.0), 0.6, False, CAST_IN),
    hulls=1,
    name="posts.bollard",
)
def bollard(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Steel post with bands, cast-iron ball top, concrete dome, flexible delineator."""
    b = MeshBuilder(roughness=0.5)
    style = ("steel", "ball-top", "concrete", "flexible")[variant % 4]
    h = float(rng.uniform(0.85, 1.05))
    if style == "steel":
        r = float(rng.uniform(0.055, 0.075))
        b.lathe([(r, 0), (r, h), (r * 0.8, h + 0.02), (0, h + 0.03)], color="charcoal", segments=20)
        for z in (0.62, 0.8):
            b.cylinder(r + 0.003, 0.07, (0, 0, h * z), "white", segments=20)
        b.cylinder(r * 1.7, 0.012, color="dark grey", segments=20)
    elif style == "ball-top":
        r = 0.07
        foot = [(0.13, 0), (0.13, 0.08), (0.1, 0.13), (r, 0.18)]
        neck = [(r * 0.82, h * 0.72), (r * 1.2, h * 0.75), (r * 1.2, h * 0.8), (r * 0.6, h * 0.84)]
        b.lathe([*foot, *neck], color="black")
        b.ball(0.09, (0, 0, h * 0.84 + 0.07), "black")
        b.cylinder(r * 1.02, 0.05, (0, 0, h * 0.6), "gold")
    elif style == "concrete":
        dome = [(0.2, 0), (0.19, h * 0.55), (0.175, h * 0.66), (0.14, h * 0.74), (0.08, h * 0.79), (0, h * 0.81)]
        b.lathe(dome, color="concrete", segments=20)
    else:
        b.cylinder(0.12, 0.04, color="black")
        b.cylinder(0.04, h, (0, 0, 0.03), "safety orange", top_radius=0.035)
        for z in (0.55, 0.75):
            b.cylinder(0.043, 0.08, (0, 0, h * z), "white")
    return b.build(f"a {style} bollard", {"style": style})


@recipe(
    "guard stone",
    4,
    Physics(("granite",), 2600.0, (60.0, 900.0), 0.7, False, CAST_IN),
    hulls=1,
    name="posts.guard_stone",
)
def guard_stone(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Low stones that keep wheels off a corner: cone, post with rounded head, ball, obelisk-like block."""
    b = MeshBuilder(roughness=0.95)
    style = ("conical", "round-headed", "ball", "square")[variant % 4]
    color = ("granite", "sandstone", "dark concrete", "granite")[variant % 4]
    h = float(rng.uniform(0.5, 0.75))
    if style == "conical":
        profile = [(0.24, 0), (0.23, h * 0.25), (0.17, h * 0.75), (0.12, h * 0.93), (0.05, h), (0, h)]
        b.lathe(profile, color=color, segments=12)
    elif style == "round-headed":
        b.box((0.34, 0.34, h * 0.72), color=color, bevel=0.03, taper=(0.85, 0.85))
        b.ball((0.145, 0.145, 0.13), (0, 0, h * 0.74), color)
    elif style == "ball":
        b.ball(0.27, (0, 0, 0.29), color, segments=18, rings=12)
        b.cylinder(0.2, 0.08, color="granite", top_radius=0.17)
    else:
        b.box((0.3, 0.3, h), color=color, bevel=0.015, taper=(0.8, 0.8))
        b.box((0.32, 0.32, 0.1), color="dark concrete", bevel=0.02)
        b.box((0.25, 0.25, 0.1), (0, 0, h - 0.01), color, taper=(0.1, 0.1))
    return b.build(f"a {style} guard stone of {color}", {"style": style})
