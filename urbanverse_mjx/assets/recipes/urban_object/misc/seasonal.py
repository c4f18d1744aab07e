"""Seasonal objects: Christmas trees, snowmen."""

import numpy as np

from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.recipe import recipe
from ...nature.vegetation import TREE, conifer
from ...shared.sizes import made


@recipe("christmas tree", 3, TREE, hulls=3, name="vegetation.christmas_tree")
def christmas_tree(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.8)
    height, radius = ((3.2, 1.05), (2.2, 0.75), (5.2, 1.6))[variant]
    conifer(b, height, radius, "#2f5f3a", rng)
    b.lathe([(0.32, 0), (0.36, 0.35), (0.30, 0.35)], color=("red", "dark wood", "concrete")[variant], segments=14)
    for k in range(34):
        f = (k + 0.5) / 34
        a, z = k * 2.39996, 0.55 + (height - 1.0) * f
        r = (radius * (1 - f) ** 0.85 + 0.12) * 0.93
        b.ball(
            0.055, (r * np.cos(a), r * np.sin(a), z), ("red", "gold", "lamp", "signal blue")[k % 4], segments=7, rings=5
        )
    star = [
        ((0.16 if k % 2 == 0 else 0.07) * np.sin(np.pi * k / 5), (0.16 if k % 2 == 0 else 0.07) * np.cos(np.pi * k / 5))
        for k in range(10)
    ]
    with b.frame((0, 0, b.bounds[1][2] + 0.06), (90, 0, 90)):
        b.extrude(star, 0.04, (0, 0, -0.02), "gold")
    names = (
        "A tall decorated Christmas tree in a red pot",
        "A small decorated Christmas tree",
        "A large public Christmas tree",
    )
    return b.build(names[variant], {"height": height}, mass=(60.0, 30.0, 220.0)[variant])


@recipe("snowman", 3, name="monuments.snowman")
def snowman(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Three balls with a top hat, two with a bucket, a small lopsided one in a bobble hat; all with a carrot."""
    b = MeshBuilder(roughness=0.95)
    radii, height = (
        ((0.42, 0.31, 0.21), 1.55),
        ((0.5, 0.34), 1.4),
        ((0.3, 0.22, 0.16), 0.98),
    )[variant % 3]
    z, tops = 0.0, []
    for k, r in enumerate(radii):
        lean = 0.0 if variant % 3 != 2 else 0.02 * k
        b.ball((r, r, r * 0.95), (0, lean, z + r * 0.95 - 0.03 * (k > 0)), "white", segments=20, rings=12)
        tops.append((lean, z + r * 0.95, r))
        z += 1.62 * r
    y, middle, r = tops[-1]
    b.lathe([(r * 0.17, 0), (0, r * 1.1)], (r * 0.9, y, middle), "orange", turn_deg=(0, 95, 0), segments=10)
    for side in (-1, 1):
        b.ball(r * 0.12, (r * 0.88, y + side * r * 0.35, middle + r * 0.3), "black", segments=8, rings=5)
        arm = tops[-2]
        reach = arm[2] * (1.25 if len(radii) == 2 else 1.65)
        foot = (0, arm[0] + side * arm[2] * 0.9, arm[1] + arm[2] * 0.2)
        hand = (0.1, side * reach, arm[1] + arm[2] * 0.9)
        b.tube([foot, (0.05, side * reach * 0.8, arm[1] + arm[2] * 0.45), hand], [0.02, 0.014, 0.01], "bark", sides=6)
        b.rod(
            (0.05, side * reach * 0.8, arm[1] + arm[2] * 0.45),
            (0.12, side * reach * 0.75, arm[1] + arm[2] * 0.9),
            0.008,
            "bark",
            sides=5,
        )
    for k in range(5):
        a = np.radians(-50 + 25 * k)
        b.ball(
            r * 0.06,
            (r * 0.9, y + r * 0.5 * float(np.sin(a)), middle - r * 0.42 * float(np.cos(a))),
            "black",
            segments=6,
            rings=4,
        )
    yb, zb, rb = tops[-2]
    for k in range(3):
        a = np.radians(-15 + 25 * k)
        b.ball(rb * 0.09, (rb * float(np.cos(a)), yb, zb + rb * 0.93 * float(np.sin(a))), "black", segments=8, rings=5)
    b.ring(
        r * 0.86,
        r * 0.2,
        (0, y, middle - r * 0.72),
        ("signal red", "green", "signal blue")[variant % 3],
        segments=18,
        sides=8,
    )
    top = middle + r * 0.72
    if variant % 3 == 0:
        b.lathe(
            [(r * 1.15, 0), (r * 1.15, 0.02), (r * 0.75, 0.03), (r * 0.78, r * 1.3)], (0, y, top), "black", segments=18
        )
        b.cylinder(r * 0.79, r * 0.25, (0, y, top + 0.03), "signal red", segments=18)
    elif variant % 3 == 1:
        b.lathe([(r * 0.95, 0), (r * 0.65, r * 1.1)], (0, y, top - 0.04), "galvanised", segments=18)
    else:
        b.lathe(
            [(r * 0.85, 0), (r * 0.88, r * 0.25), (r * 0.6, r * 0.6), (0, r * 0.8)],
            (0, y, top - 0.04),
            "signal red",
            segments=16,
        )
        b.ball(r * 0.25, (0, y, top + r * 0.8), "white", segments=10, rings=6)
    wide = (0.85, 1.1, 0.6)[variant % 3]
    return made(b, f"a snowman of {len(radii)} balls", (wide, wide, height), balls=len(radii))
