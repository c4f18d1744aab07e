"""Awnings over the pavement; the street is at +x."""

import numpy as np

from ....meshes import paint
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import shade
from ....meshes.recipe import Physics, recipe

AWNING = Physics(
    ("fabric", "aluminium"),
    60.0,
    (15.0, 120.0),
    0.6,
    False,
    "cassette awnings weigh 10-15 kg/m; screwed to a wall or standing on posts",
)


@recipe("awning", 4, AWNING, hulls=6, name="canopies.awning")
def awning(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Sloped and round-fronted wall awnings (no posts: place them at their height), and two on posts."""
    b = MeshBuilder(roughness=0.9)
    style = ("wall slope", "terrace on posts", "wall basket", "striped on posts")[variant % 4]
    w, d = float(rng.uniform(2.4, 3.6)), float(rng.uniform(1.1, 1.5))
    color = ("green", "beige", "dark red", "blue")[variant % 4]
    image = paint.stripes((128, 16), (color, "cream") if "strip" in style or style == "wall slope" else (color,), 15)
    low, high = (0.0, 0.75) if "wall" in style else (2.35, 2.95)
    x0, x1 = -d / 2, d / 2
    if style == "wall basket":
        rows = []
        for a in np.linspace(0, np.pi / 2, 6):
            x, z = x1 - d * (1 - np.cos(a)), low + 0.15 + 0.65 * np.sin(a)
            rows.append([(x, -w / 2, z), (x, w / 2, z)])
        b.sheet(np.array(rows), color, both_sides=True)
        for side in (-1, 1):
            edge = [rows[k][0 if side < 0 else 1] for k in range(6)]
            fan = np.array([edge, [(x0, side * w / 2, low + 0.15)] * 6])
            b.sheet(fan, shade(color, 0.85), both_sides=True)
    else:
        z1 = low + 0.2
        b.sheet(
            np.array([[(x1, -w / 2, z1), (x1, w / 2, z1)], [(x0, -w / 2, high), (x0, w / 2, high)]]),
            image=image,
            both_sides=True,
        )
        for y in (-w / 2, w / 2):
            b.rod((x0, y, z1), (x1, y, z1), 0.015, "aluminium", sides=6)
            b.rod((x0, y, high), (x1, y, z1), 0.015, "aluminium", sides=6)
    b.sheet(
        np.array([[(x1, -w / 2, low), (x1, w / 2, low)], [(x1, -w / 2, low + 0.2), (x1, w / 2, low + 0.2)]]),
        image=image,
        both_sides=True,
    )
    b.box((0.08, w, 0.1), (x0 + 0.04, 0, high - 0.07 if style != "wall basket" else low + 0.75), "aluminium")
    if "posts" in style:
        for x in (x0 + 0.04, x1 - 0.03):
            for y in (-w / 2 + 0.03, w / 2 - 0.03):
                b.box((0.05, 0.05, high - 0.05 if x < 0 else 2.55), (x, y, 0), "charcoal")
                b.cylinder(0.12, 0.015, (x, y, 0), "charcoal", segments=12)
    return b.build(f"a {style} awning {w:.1f} m wide", {"style": style, "width": round(w, 3)})
