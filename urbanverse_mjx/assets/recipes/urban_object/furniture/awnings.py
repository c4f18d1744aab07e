"""Cloth over the pavement: food stalls with their carts, awnings; customers at +x."""

import numpy as np

from ....meshes import paint
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, shade
from ....meshes.recipe import Physics, recipe

STALL = Physics(
    ("steel", "fabric", "wood"),
    120.0,
    (60.0, 320.0),
    0.5,
    False,
    "hot-dog carts weigh 80-200 kg with stock, braked wheels",
)


def striped_canopy(b: MeshBuilder, x: float, y: float, z: float, rise: float, color: Color, count: int = 8) -> None:
    """A ridged cloth roof of half sizes x, y with its eaves at z, striped, with a scalloped edge."""
    picture = paint.stripes((96, 24), (color, "white"), count)
    for side in (1, -1):
        slope = np.array(
            [[(side * x, -side * y, z), (side * x, side * y, z)], [(0, -side * y, z + rise), (0, side * y, z + rise)]]
        )
        b.sheet(slope, picture=picture, both_sides=True)
        drop = np.array(
            [
                [(side * x, -side * y, z - 0.18), (side * x, side * y, z - 0.18)],
                [(side * x, -side * y, z), (side * x, side * y, z)],
            ]
        )
        b.sheet(drop, picture=picture, both_sides=True)
        b.sheet(
            np.array([[(x, side * y, z), (-x, side * y, z)], [(0, side * y, z + rise), (0, side * y, z + rise)]]),
            color,
            both_sides=True,
        )


def _cart(b: MeshBuilder, style: str) -> None:
    """A two-wheeled cart under a parasol."""
    color, words = (("signal red", "HOT DOGS"), ("pink", "ICE CREAM"))[style == "ice cream cart"]
    image, draw = paint.canvas((96, 48), color)
    paint.text(draw, words, (8, 10, 88, 38), "white", bold=0.04)
    b.box((0.75, 1.5, 0.65), (0, 0, 0.3), color, bevel=0.03, skins={"+x": image, "-x": image})
    b.box((0.9, 1.65, 0.05), (0, 0, 0.95), "aluminium", bevel=0.01)
    if style == "hot dog cart":
        b.box((0.5, 0.6, 0.2), (0, 0.35, 1.0), "galvanised", bevel=0.02)
        for k in range(3):
            b.cylinder(
                0.035,
                0.22,
                (0.2, -0.5 + 0.11 * k, 1.0),
                ("red", "signal yellow", "green")[k],
                top_radius=0.015,
                segments=10,
            )
    else:
        for k in range(4):
            b.ball(0.1, (0.1, -0.45 + 0.3 * k, 1.03), ("pink", "cream", "brown", "lime")[k], segments=10, rings=6)
    for y in (-0.8, 0.8):
        with b.frame((0.05, y, 0.28), (90, 0, 0)):
            b.ring(0.26, 0.03, color="rubber", segments=20, sides=6)
            for k in range(4):
                a = np.pi * k / 4
                b.rod(
                    (-0.26 * np.cos(a), -0.26 * np.sin(a), 0),
                    (0.26 * np.cos(a), 0.26 * np.sin(a), 0),
                    0.01,
                    "aluminium",
                    sides=4,
                )
    b.tube(
        [(-0.35, -0.6, 0.85), (-0.75, -0.55, 0.95), (-0.75, 0.55, 0.95), (-0.35, 0.6, 0.85)],
        0.02,
        "aluminium",
        sides=6,
    )
    b.rod((0, -0.1, 0.95), (0, -0.1, 2.35), 0.022, "aluminium")
    for k in range(8):
        a, c = 2 * np.pi * k / 8, 2 * np.pi * (k + 1) / 8
        p, q = ((1.1 * np.cos(t), 1.1 * np.sin(t) - 0.1, 1.98) for t in (a, c))
        b.sheet(np.array([[p, q], [(0, -0.1, 2.4)] * 2]), color if k % 2 else "cream", both_sides=True)


def _stall(b: MeshBuilder, style: str, rng: np.random.Generator) -> None:
    """A counter under a ridged canopy on four posts."""
    color = "green" if style == "fruit stall" else "signal blue"
    w = float(rng.uniform(2.1, 2.5))
    for x in (-0.85, 0.85):
        for y in (-w / 2, w / 2):
            b.rod((x, y, 0), (x, y, 2.15), 0.022, "galvanised")
    striped_canopy(b, 1.05, w / 2 + 0.15, 2.15, 0.5, color, 10)
    b.box((0.9, w - 0.1, 0.06), (0.15, 0, 0.8), "wood")
    skirt = (
        paint.stripes((64, 32), (color, "white"), 10)
        if style == "fruit stall"
        else paint.canvas((96, 32), "signal yellow")[0]
    )
    if style == "taco stand":
        skirt, draw = paint.canvas((96, 32), "signal yellow")
        paint.text(draw, "TACOS", (6, 4, 90, 28), "signal red", bold=0.05)
    b.box((0.85, w - 0.15, 0.7), (0.14, 0, 0.1), shade("wood", 0.8), skins={"+x": skirt})
    if style == "fruit stall":
        inks = ("red", "orange", "lime", "signal yellow", "purple", "green")
        for row in range(2):
            for k in range(5):
                y = -w / 2 + 0.3 + k * (w - 0.6) / 4
                with b.frame((0.36 - 0.42 * row, y, 0.88 + 0.12 * row), (0, 15, 0)):
                    b.box((0.36, 0.38, 0.1), color="light wood")
                    ink = inks[int(rng.integers(6))]
                    for i in range(3):
                        for j in range(3):
                            b.ball(0.06, (-0.11 + 0.11 * i, -0.12 + 0.12 * j, 0.12), ink, segments=6, rings=4)
    else:
        b.box((0.5, 0.8, 0.12), (0, -0.4, 0.86), "charcoal")
        b.cylinder(0.05, 0.5, (0, 0.5, 0.86), "aluminium", segments=10)
        b.lathe([(0.08, 0), (0.17, 0.25), (0.12, 0.42), (0.02, 0.45)], (0, 0.5, 0.92), "brown", segments=14)


@recipe("street food stall", 4, STALL, hulls=8, name="canopies.street_food_stall")
def street_food_stall(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Hot-dog cart with parasol, market stall with fruit, taco stand with canopy, ice-cream cart; customers at +x."""
    b = MeshBuilder(roughness=0.6)
    style = ("hot dog cart", "fruit stall", "taco stand", "ice cream cart")[variant % 4]
    if style in ("hot dog cart", "ice cream cart"):
        _cart(b, style)
    else:
        _stall(b, style, rng)
    return b.build(f"a {style}", {"style": style})


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
    picture = paint.stripes((128, 16), (color, "cream") if "strip" in style or style == "wall slope" else (color,), 15)
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
            picture=picture,
            both_sides=True,
        )
        for y in (-w / 2, w / 2):
            b.rod((x0, y, z1), (x1, y, z1), 0.015, "aluminium", sides=6)
            b.rod((x0, y, high), (x1, y, z1), 0.015, "aluminium", sides=6)
    b.sheet(
        np.array([[(x1, -w / 2, low), (x1, w / 2, low)], [(x1, -w / 2, low + 0.2), (x1, w / 2, low + 0.2)]]),
        picture=picture,
        both_sides=True,
    )
    b.box((0.08, w, 0.1), (x0 + 0.04, 0, high - 0.07 if style != "wall basket" else low + 0.75), "aluminium")
    if "posts" in style:
        for x in (x0 + 0.04, x1 - 0.03):
            for y in (-w / 2 + 0.03, w / 2 - 0.03):
                b.box((0.05, 0.05, high - 0.05 if x < 0 else 2.55), (x, y, 0), "charcoal")
                b.cylinder(0.12, 0.015, (x, y, 0), "charcoal", segments=12)
    return b.build(f"a {style} awning {w:.1f} m wide", {"style": style, "width": round(w, 3)})
