"""Food of street stalls: burgers, hot dogs, sandwiches, pizza, chips. Long ones along x."""

import numpy as np

from ....meshes import shapes
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, mix, shade
from ....meshes.recipe import recipe
from ...shared.forms import bead, lumpy, painted, pillow, softened
from ...shared.outlines import arc
from ...shared.sizes import varied_cm
from ...shared.skins import label, skin
from .baked import baked, wavy_disc


def seeds(
    b: MeshBuilder,
    rng: np.random.Generator,
    half: tuple[float, float],
    low: float,
    dome: float,
    count: int,
    color: Color = "#f3e2b4",
) -> None:
    """Sesame on a domed top (an ellipse of half axes, `dome` high over `low`)."""
    for _ in range(count):
        r, a = 0.8 * np.sqrt(rng.uniform(0, 1)), rng.uniform(0, 2 * np.pi)
        z = low + dome * np.sqrt(1 - r * r)
        b.ball(
            (0.25, 0.15, 0.12),
            (half[0] * r * np.cos(a), half[1] * r * np.sin(a), z),
            color,
            turn_deg=(0, 0, float(rng.uniform(0, 180))),
            segments=5,
            rings=3,
        )


@recipe("hamburger", 3, name="street_food.hamburger")
def hamburger(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Bun, patty, cheese and salad: a single, a double, one in a dark bun."""
    b = MeshBuilder(roughness=0.6)
    style = ("cheeseburger", "double", "dark bun")[variant % 3]
    bun: Color = "#c8843a" if style != "dark bun" else "#4a382c"
    z = 2.0
    b.add(
        painted(pillow((10.6, 10.6, 2.2), 1.0, 0.5, 20, 6)),
        image=skin(rng, [shade(bun, 0.9), mix(bun, "cream", 0.5), bun], noise=6),
    )
    for _ in range(2 if style == "double" else 1):
        b.add(wavy_disc(5.6, 0.5, 0.35, 7, rng), "#7fae3c", (0, 0, z))
        b.add(
            painted(lumpy(pillow((11, 11, 1.8), 1.0, 0.5, 20, 6), 0.03, rng, 4)),
            image=skin(rng, ["#4a2a1a", "#5f3822"], noise=14),
            at=(0, 0, z + 0.4),
            crease_deg=70,
        )
        b.box((8.2, 8.2, 0.3), (0, 0, z + 2.1), "#f2b532", turn_deg=(0, 0, 30 + 40 * z))
        for k in range(4):
            a = np.radians(75 + 40 * z + 90 * k)
            b.convex(
                [(4.9 * np.cos(a + d), 4.9 * np.sin(a + d), z + 2.3) for d in (-0.22, 0.22)]
                + [(5.75 * np.cos(a), 5.75 * np.sin(a), z + 1.2), (5.3 * np.cos(a), 5.3 * np.sin(a), z + 2.4)],
                "#f2b532",
            )
        z += 2.4
    for a in (0, 2.1, 4.2):
        b.cylinder(2.6, 0.5, (2.6 * np.cos(a), 2.6 * np.sin(a), z), "#c8321f", segments=14)
    top = shapes.lathe(softened([(0, 0), (5.1, 0), (5.45, 0.8), (4.9, 2.3), (3.0, 3.4), (0, 3.8)], 12), 24)
    b.add(
        painted(top),
        image=skin(rng, [mix(bun, "cream", 0.4), bun, shade(bun, 1.08)], noise=4),
        at=(0, 0, z + 0.5),
        crease_deg=80,
    )
    seeds(b, rng, (5.2, 5.2), z + 0.75, 3.5, 15, "#f3e2b4")
    size = ((10.8, 10.8, 7.5), (11.2, 11.2, 10.2), (10.2, 10.2, 7.0))[variant % 3]
    return varied_cm(b, f"a {style}", size, rng, {"style": style})


@recipe("hot dog", 3, name="street_food.hot_dog")
def hot_dog(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A sausage in a split bun with a zigzag of mustard, of ketchup, with onions and gherkins."""
    b = MeshBuilder(roughness=0.6)
    style = ("mustard", "ketchup", "onions")[variant % 3]
    image = skin(rng, ["#c98a44", "#d09048", "#c07c38"], noise=5)
    for side in (-1, 1):
        b.add(
            painted(pillow((16, 3.4, 4.2), 0.7, 0.8, 22, 10)),
            image=image,
            at=(0, side * 1.55, 0),
            turn_deg=(-14 * side, 0, 0),
        )
    b.add(pillow((15, 3.2, 1.8), 0.6, 0.6, 20, 6), "#f0dcb0", (0, 0, 0.5))
    sausage = bead(
        [(x, 0, 3.6 + 0.006 * x * x) for x in np.linspace(-9, 9, 11)], [0.3, 1.0, 1.2, *([1.25] * 5), 1.2, 1.0, 0.3], 10
    )
    b.add(sausage, ("#a8452a", "#b8502c", "#9a3c24")[variant % 3], crease_deg=80)
    colors: tuple[Color, ...] = (("#ecc02c",), ("#b81c1c",), ("#ecc02c",))[variant % 3]
    b.tube([(x, 0.65 * (-1) ** k, 4.85) for k, x in enumerate(np.linspace(-7.4, 7.4, 14))], 0.3, colors[0], sides=6)
    for k in range(16 if style == "onions" else 0):
        at = (float(rng.uniform(-7, 7)), float(rng.uniform(-1.2, 1.2)), 4.7 + float(rng.uniform(0, 0.5)))
        b.box((0.9, 0.5, 0.4), at, ("#d8a050", "#7f9a3a")[k % 2], turn_deg=(20 * k, 15 * k, 40 * k), bevel=0.1)
    size = ((18, 6.2, 5.5), (20, 6.6, 5.6), (17, 6.6, 6.2))[variant % 3]
    return varied_cm(b, f"a hot dog with {style}", size, rng, {"style": style})


@recipe("sandwich", 3, name="street_food.sandwich")
def sandwich(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A triangle of toast, a filled baguette, a club of three layers on sticks."""
    b = MeshBuilder(roughness=0.8)
    style = ("triangle", "baguette", "club")[variant % 3]
    if style == "baguette":
        b.add(painted(pillow((26, 9, 3.4), 0.7, 0.6, 26, 8)), image=baked(rng))
        for k in range(6):
            b.cylinder(2.4, 0.5, (-9.5 + 3.8 * k, 1.6 * (-1) ** k, 4.0), ("#c8321f", "#f0cf7a")[k % 2], segments=12)
        b.add(wavy_disc(4.9, 0.5, 0.6, 11, rng), "#7fae3c", (0, 0, 3.2), scale=(2.7, 1.0, 1.0))
        b.box((25, 8.6, 0.5), (0, 0, 4.3), "#e8a49a", bevel=0.2)
        b.add(
            painted(lumpy(pillow((26, 9, 4.2), 0.7, 0.7, 26, 8), 0.02, rng, 3)),
            image=baked(rng),
            at=(0, 0, 4.6),
            crease_deg=70,
        )
    else:
        bread_at = (0.0, 3.4) if style == "triangle" else (0.0, 2.8, 5.6)
        half = [(8, 0), (-3.5, -6.2), (-3.5, 6.2)]
        inside = [(7.4, 0), (-3.3, -5.9), (-3.3, 5.9)]
        for k, z in enumerate(bread_at):
            b.extrude(half, 1.3, (0, 0, z), "#b8793c")
            b.extrude([(8.05, 0), (-3.52, -6.25), (-3.52, 6.25)], 0.9, (0, 0, z + 0.2), "#f0dcb0")
            if k + 1 < len(bread_at):
                for n, (color, thick) in enumerate(
                    (("#7fae3c", 0.5), ("#e8a49a", 0.5), ("#f2c53c", 0.4), ("#c8321f", 0.4))
                ):
                    grow = 1.0 + 0.03 * (-1) ** n
                    b.extrude([(x * grow, y * grow) for x, y in inside], thick, (0, 0, z + 1.25 + 0.4 * n), color)
        if style == "club":
            for y in (-2.5, 2.5):
                b.rod((-1, y, 3), (-1, y, 9.6), 0.12, "light wood", sides=5)
                b.ball((0.7, 0.7, 0.7), (-1, y, 8.6), "#7f9a3a", segments=9, rings=6)
    size = ((16, 10, 6.5), (27, 9.5, 8.0), (15, 11, 9.5))[variant % 3]
    return varied_cm(b, f"a {style} sandwich", size, rng, {"style": style})


@recipe("pizza", 3, name="street_food.pizza")
def pizza(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Salami, margherita with basil, one with mushrooms and olives; a slice cut free."""
    b = MeshBuilder(roughness=0.8)
    style = ("salami", "margherita", "mushroom")[variant % 3]
    b.lathe(
        [(0, 0), (14.6, 0), (15.5, 0.7), (15.2, 1.7), (14.2, 1.9), (13.2, 1.2), (0, 1.0)], color="#cf9a52", segments=36
    )
    b.add(
        painted(wavy_disc(13.4, 0.5, 0.12, 9, rng)),
        image=skin(rng, ["#b83a20", "#c8452a"], noise=14),
        at=(0, 0, 0.85),
    )
    for _ in range(16):
        a, r = rng.uniform(0, 2 * np.pi), 11.6 * np.sqrt(rng.uniform(0, 1))
        b.ball(
            (2.3, 1.7, 0.3),
            (r * np.cos(a), r * np.sin(a), 1.35),
            "#f2d98a",
            turn_deg=(0, 0, float(rng.uniform(0, 180))),
            segments=9,
            rings=4,
        )
    for k in range(13):
        r, a = 11.6 * np.sqrt((k + 0.5) / 13), 2.4 * k
        at = (r * np.cos(a), r * np.sin(a), 1.4)
        if style == "salami":
            b.cylinder(1.7, 0.35, at, "#a8281e", segments=12)
        elif style == "margherita":
            b.add(pillow((2.6, 1.3, 0.4), 0.8, 0.8, 10, 4), "leaf", at, turn_deg=(0, 0, 70 * k))
        else:
            b.extrude(
                [
                    *((x, y) for x, y in arc(1.5, 0, 180, 7).tolist()),
                    (-0.4, 0.0),
                    (-0.4, -1.3),
                    (0.4, -1.3),
                    (0.4, 0.0),
                ],
                0.4,
                at,
                "#e6d6b8",
                turn_deg=(0, 0, 50 * k),
            )
            b.ring(0.55, 0.22, (at[1], -at[0], 1.65), "#2c2a26", segments=7, sides=4)
    for k in range(4):
        b.box((29, 0.25, 0.5), (0, 0, 1.1), "#8a4a24", turn_deg=(0, 0, 45 * k))
    size = ((31, 31, 2.2), (28, 28, 2.4), (34, 34, 2.6))[variant % 3]
    return varied_cm(b, f"a {style} pizza", size, rng, {"style": style})


@recipe("french fries", 3, name="street_food.french_fries")
def french_fries(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Chips standing in a red box, in a paper cone, heaped in a tray with ketchup."""
    b = MeshBuilder(roughness=0.8)
    style = ("box", "cone", "tray")[variant % 3]
    tones = ("#eec45a", "#e6b446", "#f2d070", "#d89c38")
    if style == "tray":
        b.box((12, 8, 3.6), color="#f2eee4", taper=(1.25, 1.25))
        b.box((14, 9.2, 0.3), (0, 0, 3.5), "#d8c890")
        for k in range(34):
            at = (float(rng.uniform(-4.6, 4.2)), float(rng.uniform(-2.6, 2.6)), 4.0 + 2.2 * rng.uniform(0, 1))
            b.box(
                (float(rng.uniform(5, 8)), 0.8, 0.8),
                at,
                tones[k % 4],
                turn_deg=(40 * k, float(rng.uniform(-16, 16)), 47 * k),
                centered=True,
            )
        b.ball((2.4, 2.0, 0.8), (2.0, 0.6, 6.2), "#b01c1c", segments=12, rings=6)
    else:
        if style == "box":
            low, high = (2.4, 4.2), (3.4, 6.0)
            corners = [
                (sx * x, sy * y, z) for (x, y), z in ((low, 0.0), (high, 7.5)) for sx in (-1, 1) for sy in (-1, 1)
            ]
            b.convex(corners, "#c8202a")
            x, z = arc(1.0, 180, 360, 11).T
            b.extrude(
                [*((6.0 * px, 7.5 + 1.6 * pz + 1.5) for px, pz in zip(x, z, strict=True)), (6.0, 7.2), (-6.0, 7.2)][
                    ::-1
                ],
                0.3,
                (-3.5, 0, 0),
                "#c8202a",
                turn_deg=(90, 0, 90),
            )
            b.panel(label("FRITES", "#c8202a", "#f6d040", (48, 24)), (3.02, 0, 4.2), 6.6, 3.4, tilt_deg=-7.6)
        else:
            b.lathe([(0.3, 0), (4.6, 8.4), (0, 8.4)], color="#efe6d0", segments=18)
            b.lathe([(3.7, 6.4), (4.75, 8.5), (0, 8.5)], color="#2f5f9a", segments=18)
        for k in range(30):
            u, v = ((k * 7) % 10 / 9 - 0.5), ((k * 3) % 5 / 4 - 0.5)
            reach = (4.6, 9.6) if style == "box" else (5.4, 5.4)
            top = float(rng.uniform(3.2, 6.4)) - 3.0 * abs(u)
            b.box(
                (0.85, 0.85, 4.5 + top),
                (v * reach[0], u * reach[1] * (0.85 if style == "cone" else 1), 6.2),
                tones[k % 4],
                turn_deg=(float(rng.uniform(-7, 7)) - 14 * u, 14 * v, 17 * k),
            )
    size = ((9, 14, 13), (10, 10.5, 15.5), (17.5, 12, 7.5))[variant % 3]
    return varied_cm(b, f"french fries in a {style}", size, rng, {"style": style})
