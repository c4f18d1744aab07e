"""Dishes as they are served: pasta, ramen, dumplings, spring rolls, sushi."""

import numpy as np

from ....meshes import shapes
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, shade
from ....meshes.recipe import recipe
from ...shared.forms import lumpy, painted, pillow, softened
from ...shared.sizes import varied_cm
from ...shared.skins import skin

CHINA = "#f2efe8"


def plate_under(b: MeshBuilder, radius: float, color: Color = CHINA, long: float = 1.0) -> None:
    """A shallow plate, its inner ground at z = 0.8; `long` stretches it along x."""
    with b.frame(scale=(long, 1, 1)):
        b.lathe(
            [
                (0, 0),
                (radius * 0.6, 0),
                (radius * 0.7, 0.5),
                (radius, 1.7),
                (radius * 0.98, 1.9),
                (radius * 0.68, 0.8),
                (0, 0.8),
            ],
            color=color,
            segments=28,
        )


def heap_of_noodles(
    b: MeshBuilder,
    rng: np.random.Generator,
    radius: float,
    low: float,
    height: float,
    colors: tuple[Color, ...],
    count: int,
    thick: float,
) -> None:
    """Loops of noodles wound over a mound."""
    for k in range(count):
        a0, r = rng.uniform(0, 2 * np.pi), radius * float(rng.uniform(0.35, 0.95))
        s = np.linspace(0, float(rng.uniform(2.2, 4.0)), 8)
        centre = rng.uniform(-0.25, 0.25, 2) * radius
        reach = np.minimum(
            np.hypot(centre[0] + r * 0.75 * np.cos(a0 + s), centre[1] + r * 0.75 * np.sin(a0 + s)) / radius, 1
        )
        z = low + height * (1 - reach**2) + rng.uniform(-0.2, 0.4) + 0.25 * np.sin(3 * s)
        path = np.column_stack([centre[0] + r * 0.75 * np.cos(a0 + s), centre[1] + r * 0.75 * np.sin(a0 + s), z])
        b.tube(path, thick, colors[k % len(colors)], sides=3)


@recipe("pasta", 3, name="dishes.pasta")
def pasta(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Spaghetti with tomato sauce and basil, tubes with pesto, meatballs; on a plate."""
    b = MeshBuilder(roughness=0.6)
    style = ("spaghetti", "penne", "meatballs")[variant % 3]
    plate_under(b, 11.5)
    b.lathe([(7.2, 0.8), (6.6, 2.2), (4.0, 3.8), (0, 4.6)], color="#e0b85a", segments=20, crease_deg=70)
    if style == "penne":
        for k in range(38):
            r, a = 6.6 * np.sqrt((k + 0.5) / 38), 2.4 * k
            z = 1.2 + 3.8 * (1 - (r / 7.4) ** 2)
            with b.frame((r * np.cos(a), r * np.sin(a), z), (0, float(rng.uniform(-25, 25)), 71 * k)):
                b.cylinder(
                    0.5, 3.2, (-1.6, 0, 0), ("#e6c46a", "#a8b84a", "#d8b860")[k % 3], turn_deg=(0, 90, 0), segments=7
                )
    else:
        heap_of_noodles(b, rng, 7.2, 1.2, 3.8, ("#ecc868", "#e2b852", "#f0d480"), 24, 0.24)
        b.add(lumpy(pillow((7.6, 7.2, 1.5), 1.0, 0.8, 18, 6), 0.12, rng, 2), "#b02a18", (0, 0, 4.5), crease_deg=80)
    if style == "meatballs":
        for x, y, z in ((1.8, 1.6, 6.2), (-2.0, 1.2, 6.2), (0.2, -2.0, 6.2), (3.6, -1.8, 5.0)):
            b.add(lumpy(shapes.ellipsoid(1.6, 12, 8), 0.06, rng, 3), "#5f3420", (x, y, z), crease_deg=80)
    for k in range(3):
        b.add(
            pillow((2.2, 1.2, 0.4), 0.8, 0.8, 10, 4),
            "leaf",
            (0.8 * np.cos(2.1 * k), 0.8 * np.sin(2.1 * k), 6.0 if style != "penne" else 5.4),
            turn_deg=(0, -18, 120 * k),
        )
    size = ((23, 22, 6.5), (25, 24.5, 6.2), (22, 21, 7.2))[variant % 3]
    return varied_cm(b, f"a plate of {style}", size, rng, {"style": style})


@recipe("ramen", 3, name="dishes.ramen")
def ramen(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A bowl of noodle soup with egg halves, pork, spring onions, seaweed; chopsticks across the third."""
    b = MeshBuilder(roughness=0.45)
    style = ("shoyu", "miso", "with chopsticks")[variant % 3]
    bowl_color, soup = (("#2a2a30", "#a8642a"), ("#a82a20", "#d09a4a"), ("#eeeae0", "#8a4a20"))[variant % 3]
    b.lathe(
        [(0, 0), (3.6, 0), (3.6, 0.9), (6.8, 3.0), (9.2, 6.6), (9.7, 9.6), (9.3, 9.6), (8.7, 7.2), (0, 7.2)],
        color=bowl_color,
        segments=28,
    )
    b.cylinder(8.75, 0.3, (0, 0, 7.3), soup, segments=26)
    b.ring(9.5, 0.2, (0, 0, 9.6), shade(bowl_color, 0.7), segments=28, sides=4)
    heap_of_noodles(b, rng, 7.4, 7.5, 1.1, ("#eed48a", "#e6c876"), 15, 0.28)
    for x, y, turn in ((3.4, 2.2, 20.0), (3.0, -1.0, -10.0)):
        with b.frame((x, y, 8.5), (0, 12, turn)):
            b.ball((1.9, 1.5, 1.2), (0, 0, 0), "#efe2cc", segments=14, rings=8)
            b.cylinder(0.95, 0.2, (0, 0, 1.08), "#f0a020", segments=14)
    for k in range(2):
        b.add(
            lumpy(pillow((5.2, 4.4, 0.9), 0.9, 0.6, 14, 6), 0.05, rng),
            ("#c98a64", "#b87850")[k],
            (-2.8, 2.6 - 2.4 * k, 8.2 + 0.4 * k),
            turn_deg=(8, -10, 40 * k),
        )
    b.box((0.15, 5.4, 5.2), (-6.2, -2.2, 7.2), "#16281e", turn_deg=(0, -18, -30))
    for k in range(16):
        r, a = 2.6 * np.sqrt(rng.uniform(0, 1)), rng.uniform(0, 2 * np.pi)
        b.ring(
            0.38,
            0.14,
            (0.6 + r * np.cos(a), -4.0 + r * np.sin(a), 8.7),
            ("#5f9a3a", "#8fc05a")[k % 2],
            segments=7,
            sides=3,
        )
    if style == "with chopsticks":
        for y in (4.6, 5.7):
            b.rod((-8.6, y, 9.9), (9.2, y - 1.6, 10.2), 0.3, "#a8341f", sides=6)
    size = ((19.5, 19.5, 10.0), (22, 22, 11), (18, 18, 9.6))[variant % 3]
    return varied_cm(b, f"a bowl of ramen, {style}", size, rng, {"style": style})


@recipe("dumplings", 3, name="dishes.dumplings")
def dumplings(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Steamed ones in a bamboo basket, fried crescents on a plate, one big bun-like pair."""
    b = MeshBuilder(roughness=0.6)
    style = ("bamboo basket", "fried on a plate", "pair")[variant % 3]
    places = [(4.4 * np.cos(a), 4.4 * np.sin(a)) for a in np.arange(6) * np.pi / 3] + [(0.0, 0.0)]
    ground = 1.8
    if style == "bamboo basket":
        b.lathe([(0, 0), (8.2, 0), (8.2, 4.2), (7.7, 4.2), (7.7, 1.8), (0, 1.8)], color="#cfa564", segments=28)
        for z in (0.6, 3.7):
            b.ring(8.25, 0.35, (0, 0, z), "#a87c3f", segments=28, sides=5)
    elif style == "fried on a plate":
        plate_under(b, 9.5, "#3f5f7a", 1.25)
        places, ground = [(-7.2 + 2.9 * k, 0.6 * (-1) ** k) for k in range(6)], 0.8
    else:
        places, ground = [(-2.6, 0.0), (2.6, 0.4)], 0.0
    for k, (x, y) in enumerate(places):
        with b.frame((x, y, ground), (0, 0, 60 * k if style != "fried on a plate" else 10)):
            if style == "fried on a plate":
                body = pillow((2.9, 8.4, 3.4), 0.9, 0.8, 16, 8)
                b.add(painted(body), image=skin(rng, ["#a8662c", "#e6cf9a", "#efe0b8"], noise=7))
                b.tube(
                    [
                        (0.1 * (-1) ** j, 4.0 * s, 3.4 * np.sqrt(max(1 - s * s, 0.02)) * 0.95)
                        for j, s in enumerate(np.linspace(-1, 1, 11))
                    ],
                    0.32,
                    "#e2c890",
                    sides=5,
                )
            else:
                body = ribbed_bun(2.35)
                b.add(painted(body), image=skin(rng, ["#e6dcc4", "#f2ead6", "#efe6d0"], noise=4), crease_deg=70)
                b.ball((0.45, 0.45, 0.4), (0, 0, 3.3), "#e6dcc4", segments=8, rings=5)
    size = ((17, 14.4, 5.5), (24, 19, 5.2), (9.5, 4.8, 3.4))[variant % 3]
    return varied_cm(b, f"dumplings: a {style}", size, rng, {"style": style})


def ribbed_bun(radius: float) -> shapes.Shape:
    """A bun gathered in pleats at its top."""
    body = shapes.lathe(
        softened([(0, 0), (radius * 0.8, 0.1), (radius, 0.9), (radius * 0.8, 2.1), (radius * 0.3, 3.0), (0, 3.2)], 8),
        16,
    )
    a = np.arctan2(body.vertices[:, 1], body.vertices[:, 0]) + 0.35 * body.vertices[:, 2]
    pleat = 1 + 0.07 * np.cos(8 * a) * np.clip(body.vertices[:, 2] / 3, 0, 1)
    return shapes.Shape(body.vertices * np.stack([pleat, pleat, np.ones_like(pleat)], 1), body.faces)


@recipe("spring rolls", 3, name="dishes.spring_rolls")
def spring_rolls(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Golden rolls on a plate with a dip, a stacked handful, translucent summer rolls."""
    b = MeshBuilder(roughness=0.5)
    style = ("plate", "stack", "summer rolls")[variant % 3]
    golden = skin(rng, ["#b8742c", "#d09440", "#c08034"], noise=10, flecks=("#8a4f1c", 60))
    fresh = skin(rng, ["#e6ead8", "#e9d9cc", "#c8d8a8", "#eceadc"], noise=8, flecks=("#e0703a", 40))
    spots = {
        "plate": [(0, -2.4, 0.8), (0, 0.2, 0.8), (0, 2.8, 0.8), (0.4, -1.0, 3.0)],
        "stack": [(0, -2.4, 0), (0, 0, 0), (0, 2.4, 0), (0, -1.2, 2.0), (0, 1.2, 2.0)],
        "summer rolls": [(0, -2.8, 0.8), (0, 0.2, 0.8), (0, 3.2, 0.8)],
    }[style]
    if style != "stack":
        plate_under(b, 6.6, CHINA if style == "plate" else "#2f3f4a", 1.3)
        b.lathe(
            [(0, 0), (1.6, 0), (2.1, 1.5), (1.9, 1.5), (1.7, 1.0), (0, 1.0)], (6.0, 4.2, 0.8), "#f4f0e6", segments=16
        )
        b.cylinder(1.7, 0.1, (6.0, 4.2, 1.8), "#b02a18", segments=14)
    for k, (x, y, z) in enumerate(spots):
        body = painted(lumpy(pillow((11, 2.5, 2.3), 0.35, 0.85, 18, 8), 0.02, rng, 3), 0)
        b.add(
            body,
            image=fresh if style == "summer rolls" else golden,
            at=(x, y, z),
            turn_deg=(0, 0, (14 if z > 2 else 3) * (-1) ** k),
            crease_deg=70,
        )
    size = ((16, 12, 4.6), (10.5, 7.4, 4.4), (18, 13.5, 4.3))[variant % 3]
    return varied_cm(b, f"spring rolls: {style}", size, rng, {"style": style})


@recipe("sushi", 3, name="dishes.sushi")
def sushi(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A wooden board with nigiri and rolls, one nigiri, a row of rolls on slate."""
    b = MeshBuilder(roughness=0.55)
    style = ("board", "nigiri", "rolls")[variant % 3]
    fish: tuple[Color, ...] = ("#f08a5a", "#d8404a", "#f2e2d4", "#f0a05a")

    def nigiri(x: float, y: float, z: float, top: Color) -> None:
        b.add(
            painted(lumpy(pillow((5.0, 2.4, 2.0), 0.6, 0.6, 14, 6), 0.03, rng, 4)),
            image=skin(rng, ["#f2efe6"], noise=10),
            at=(x, y, z),
            crease_deg=80,
        )
        slab = pillow((5.8, 2.7, 0.9), 0.6, 0.5, 14, 6)
        slab.vertices[:, 2] -= 0.06 * slab.vertices[:, 0] ** 2
        b.add(slab, top, (x, y, z + 1.75))
        for k in range(3):
            b.box(
                (0.22, 2.0, 0.1),
                (x - 1.4 + 1.4 * k, y, z + 2.56 - 0.06 * (1.4 * k - 1.4) ** 2),
                shade(top, 1.2),
                turn_deg=(0, 0, 24),
            )

    def maki(x: float, y: float, z: float, heart: Color) -> None:
        b.cylinder(1.5, 2.2, (x, y, z), "#1c2a20", segments=16)
        b.cylinder(1.32, 0.06, (x, y, z + 2.2), "#f4f1e8", segments=16)
        b.cylinder(0.6, 0.08, (x, y, z + 2.25), heart, segments=10)

    if style == "nigiri":
        nigiri(0, 0, 0, fish[0])
        b.add(pillow((1.0, 2.85, 2.85), 0.3, 0.35, 16, 6), "#1c2a20", (0, 0, -0.05))
    else:
        wide, deep = (21, 12) if style == "board" else (27, 10)
        b.box((wide, deep, 1.0), (0, 0, 0.8), "light wood" if style == "board" else "#3a3f44", bevel=0.15)
        for x in (-wide * 0.32, wide * 0.32):
            b.box((1.4, deep * 0.9, 0.9), (x, 0, 0), "wood" if style == "board" else "#2c3034")
        for k in range(4 if style == "board" else 0):
            with b.frame((-6.6 + 4.1 * k, 2.4, 1.8), (0, 0, 75)):
                nigiri(0, 0, 0, fish[k])
        for k in range(4 if style == "board" else 6):
            maki(
                -7.6 + 3.7 * k if style == "board" else -10 + 3.6 * k,
                -3.4 if style == "board" else 0.8 * (-1) ** k,
                1.8,
                ("#f08a5a", "#8fbb4a", "#d8404a")[k % 3],
            )
        b.ball((1.1, 1.0, 0.8), (wide * 0.40, -deep * 0.28, 2.2), "#8fae4a", segments=9, rings=5)
        b.add(lumpy(pillow((2.4, 2.6, 1.0), 0.9, 0.7, 12, 5), 0.15, rng, 3), "#f0b8a0", (wide * 0.40, deep * 0.24, 1.8))
    size = ((16, 10, 4.0), (6.2, 2.9, 3.4), (26, 9.5, 4.4))[variant % 3]
    return varied_cm(b, f"sushi: {style}", size, rng, {"style": style})
