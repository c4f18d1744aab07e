"""Bread, cakes and what else bakers sell. Long ones along x."""

from collections.abc import Sequence

import numpy as np

from ....meshes import shapes
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, shade
from ....meshes.recipe import recipe
from ....meshes.shapes import Shape
from ...shared.forms import lumpy, painted, pillow, softened
from ...shared.sizes import varied_cm
from ...shared.skins import skin

CRUST = ("#a8662c", "#c98a44", "#b87434")
GLAZES = ("#e8a0b4", "#5a3420", "#f4ecdc")


def baked(rng: np.random.Generator, colors: Sequence[Color] = CRUST, noise: float = 9.0) -> np.ndarray:
    """A crust: darker on top, mottled, with flour."""
    return skin(rng, ["#d9b070", *colors], noise=noise, flecks=("#e0bc84", 60))


def wavy_disc(radius: float, thick: float, wave: float, count: int, rng: np.random.Generator) -> Shape:
    """A leaf of lettuce or a slice that hangs over its edge: a disc with a wavy rim on z = 0."""
    disc = pillow((2 * radius, 2 * radius, thick), 1.0, 0.3, 24, 4)
    a = np.arctan2(disc.vertices[:, 1], disc.vertices[:, 0])
    r = np.linalg.norm(disc.vertices[:, :2], axis=1) / radius
    disc.vertices[:, 2] += wave * r**4 * np.sin(count * a + rng.uniform(0, 6))
    return disc


@recipe("bread", 3, name="baked.bread")
def bread(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """An oval loaf with cuts, a baguette, a tin loaf."""
    b = MeshBuilder(roughness=0.9)
    style = ("loaf", "baguette", "tin loaf")[variant % 3]
    if style == "tin loaf":
        low = pillow((26, 11, 7), 0.3, 0.25, 24, 8)
        b.add(painted(low), image=baked(rng))
        b.add(
            painted(lumpy(pillow((26.6, 12, 7), 0.4, 0.6, 24, 10), 0.03, rng, 3)),
            image=baked(rng, ("#a8662c", "#b87434", "#9a5a26")),
            at=(0, 0, 4.6),
            crease_deg=70,
        )
    else:
        size, cuts = ((26, 11, 9.5), 4) if style == "loaf" else ((58, 6.5, 5), 6)
        b.add(painted(lumpy(pillow(size, 0.8, 0.8, 28, 12), 0.02, rng, 3)), image=baked(rng), crease_deg=70)
        for k in range(cuts):
            x = size[0] * (-0.34 + 0.68 * k / (cuts - 1))
            drop = size[2] * np.sqrt(max(1 - (2 * x / size[0]) ** 2, 0.1)) * 0.5 + size[2] * 0.5
            b.add(
                pillow((size[0] * 0.17, size[1] * 0.22, size[2] * 0.16), 0.8, 0.8, 14, 6),
                "#efd6a0",
                (x, 0, drop - size[2] * 0.1),
                turn_deg=(0, np.degrees(np.arctan2(x, size[0])) * 0.8, 32),
            )
    size_cm = ((26, 11, 9.5), (58, 7.4, 6.0), (28, 12, 11.5))[variant % 3]
    return varied_cm(b, f"bread: a {style}", size_cm, rng, {"style": style})


@recipe("croissant", 3, name="baked.croissant")
def croissant(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A crescent of layers, a straight one, a chocolate-striped one; horns to the front."""
    b = MeshBuilder(roughness=0.6)
    style = ("crescent", "straight", "chocolate")[variant % 3]
    bow = (0.8, 0.3, 0.7)[variant % 3]
    fat = (0.7, 1.6, 2.3, 2.9, 3.1, 2.9, 2.3, 1.6, 0.7)
    image = skin(rng, ["#d8a050", "#c4813a", "#a8642a"], noise=9)
    for k, r in enumerate(fat):
        a = (k - 4) / 4 * 1.25
        at = (9 * np.sin(a), -5.5 * bow * (1 - np.cos(a)) * 1.5, r * 0.92)
        ring = painted(lumpy(pillow((5.2, 2 * r, 1.84 * r), 0.6, 0.9, 14, 6), 0.02, rng))
        b.add(ring, image=image, at=(at[0], at[1], 0), turn_deg=(0, 0, -np.degrees(a) * bow), crease_deg=70)
        if style == "chocolate":
            b.tube(
                [
                    (at[0] + d, at[1] + y * r, r * (0.92 + 0.94 * np.sqrt(max(1 - y * y, 0))))
                    for d, y in ((-0.6, -0.7), (0, 0), (0.6, 0.7))
                ],
                0.22,
                "#3a2014",
                sides=5,
            )
    size = ((16, 8.6, 5.8), (18, 7, 6.2), (15, 8.2, 5.4))[variant % 3]
    return varied_cm(b, f"a {style} croissant", size, rng, {"style": style})


@recipe("donuts", 3, name="baked.donuts")
def donuts(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A ring with pink icing and sprinkles, with chocolate, with sugar."""
    b = MeshBuilder(roughness=0.5)
    style = ("pink", "chocolate", "sugar")[variant % 3]
    ring = shapes.torus(2.9, 1.7, 22, 9)
    b.add(
        painted(ring),
        image=skin(rng, ["#c98a44", "#d89a50", "#e8c48a", "#d89a50"], noise=6),
        at=(0, 0, 1.6),
        scale=(1, 1, 0.95),
        crease_deg=80,
    )
    icing = shapes.torus(2.9, 1.78, 22, 9)
    a = np.arctan2(icing.vertices[:, 1], icing.vertices[:, 0])
    cut = 0.25 * np.sin(7 * a + 1) - 0.15
    icing.vertices[:, 2] = np.maximum(icing.vertices[:, 2], cut)
    b.add(icing, GLAZES[variant % 3], (0, 0, 1.66), crease_deg=60)
    colors = ("#3f7ab8", "#e8c93a", "#5fae5a", "#f4f0e6", "#d84a4a")
    for k in range(32 if style != "sugar" else 0):
        a, t = rng.uniform(0, 2 * np.pi), rng.uniform(-0.9, 0.9)
        at = ((2.9 + 1.78 * np.sin(t)) * np.cos(a), (2.9 + 1.78 * np.sin(t)) * np.sin(a), 1.66 + 1.78 * np.cos(t))
        b.box(
            (0.55, 0.16, 0.14),
            at,
            colors[k % 5] if style == "pink" else "#f0e2c8",
            turn_deg=(0, 0, float(rng.uniform(0, 180))),
            centered=True,
        )
    size = ((9.2, 9.2, 3.7), (9.8, 9.8, 3.5), (8.4, 8.4, 3.9))[variant % 3]
    return varied_cm(b, f"a {style} donut", size, rng, {"style": style})


@recipe("muffin", 3, name="baked.muffin")
def muffin(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A blueberry muffin in its pleated cup, a chocolate one, a cupcake with a swirl."""
    b = MeshBuilder(roughness=0.8)
    style = ("blueberry", "chocolate", "cupcake")[variant % 3]
    crumb: Color = ("#cf9a52", "#4a2c1c", "#d8ac68")[variant % 3]
    angles = np.arange(48) * 2 * np.pi / 48
    rows = [
        np.column_stack(
            [
                r * (1 + 0.035 * (-1) ** np.arange(48)) * np.cos(angles),
                r * (1 + 0.035 * (-1) ** np.arange(48)) * np.sin(angles),
                np.full(48, z),
            ]
        )
        for r, z in ((2.5, 0), (3.45, 4.2))
    ]
    b.loft(rows, ("#efe6d2", "#e8dcc4", "#e08aa4")[variant % 3], crease_deg=10)
    if style == "cupcake":
        b.cylinder(3.4, 0.6, (0, 0, 4.0), crumb, segments=20)
        turns = np.linspace(0, 3.3 * 2 * np.pi, 44)
        path = [((2.6 - 0.115 * t) * np.cos(t), (2.6 - 0.115 * t) * np.sin(t), 4.9 + 0.2 * t) for t in turns]
        b.tube(path, [0.2, 0.7, *(1.15 - 0.02 * k for k in range(42))], "#f6dfe6", sides=7)
        b.ball(0.8, (0, 0, 9.3), "#b8182c", segments=10, rings=7)
    else:
        dome = shapes.lathe(softened([(0, 3.6), (3.3, 3.6), (4.0, 4.4), (3.9, 5.3), (2.6, 6.8), (0, 7.5)], 12), 24)
        b.add(
            painted(lumpy(dome, 0.035, rng, 3)),
            image=skin(rng, [crumb, shade(crumb, 0.9), shade(crumb, 1.06)], noise=13),
            crease_deg=80,
        )
        for _ in range(12):
            a, r = rng.uniform(0, 2 * np.pi), 3.0 * np.sqrt(rng.uniform(0.05, 1))
            z = float(np.interp(r, [0, 2.6, 3.9], [7.4, 6.7, 5.2]))
            b.ball(
                (0.5, 0.5, 0.4),
                (r * np.cos(a), r * np.sin(a), z),
                "#2c3560" if style == "blueberry" else "#24140c",
                segments=7,
                rings=5,
            )
    size = ((7.8, 7.8, 7.0), (8.4, 8.4, 7.6), (7.4, 7.4, 9.6))[variant % 3]
    return varied_cm(b, f"a {style} muffin", size, rng, {"style": style})


@recipe("cake", 3, name="baked.cake")
def cake(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A round cream cake with cherries and a cut, a chocolate birthday cake with candles, one slice."""
    b = MeshBuilder(roughness=0.6)
    style = ("cream", "birthday", "slice")[variant % 3]
    if style == "slice":
        wedge = [(8, 0), (-4, -3.4), (-4, 3.4)]
        for k, (color, thick) in enumerate(
            (("#d8a860", 2.2), ("#f6ecdc", 0.6), ("#d8a860", 2.0), ("#d0506a", 0.5), ("#d8a860", 2.0), ("#f8f0e2", 0.8))
        ):
            z = (0, 2.2, 2.8, 4.8, 5.3, 7.3)[k]
            b.extrude(wedge, thick, (0, 0, z), color)
        b.box((0.8, 7.0, 8.1), (-4.2, 0, 0), "#f8f0e2", bevel=0.2)
        b.ball((1.2, 1.2, 0.9), (-2.6, 0, 8.6), "#f8f0e2", segments=10, rings=6)
        b.ball(0.9, (-2.6, 0, 9.8), "#b8182c", segments=12, rings=8)
        return varied_cm(b, "a slice of cake", (12, 7.4, 9), rng, {"style": style})
    body, cream = (("#f6ecdc", "#fbf6ea"), ("#5a3420", "#f0e0c0"))[variant % 3]
    b.lathe([(0, 0), (13, 0), (13, 0.4), (0, 0.4)], color="#e8e4da", segments=32)
    mouth = np.radians(np.linspace(22, 338 if style == "cream" else 382, 30))
    outline = [(10 * np.cos(a), 10 * np.sin(a)) for a in mouth] + ([(0.0, 0.0)] if style == "cream" else [])
    if style == "cream":
        for z, thick, color in ((0.4, 2.6, "#d8a860"), (3.0, 0.7, "#d0506a"), (3.7, 2.6, "#d8a860"), (6.3, 1.0, body)):
            b.extrude(outline, thick, (0, 0, z), color)
        rows = [np.column_stack([10.15 * np.cos(mouth), 10.15 * np.sin(mouth), np.full(30, z)]) for z in (0.4, 7.3)]
        b.sheet(np.array(rows), body)
    else:
        b.lathe([(0, 0.4), (9.9, 0.4), (10, 6.8), (9.6, 7.3), (0, 7.3)], color=body, segments=30)
        for k in range(10):
            b.ball(
                (1.0, 1.5, 1.3 + 0.8 * (k % 3)),
                (10 * np.cos(0.63 * k), 10 * np.sin(0.63 * k), 6.4),
                cream,
                turn_deg=(0, 0, 36 * k),
                segments=8,
                rings=5,
            )
    for k in range(9):
        a = np.radians(30 + 300 * k / 8 if style == "cream" else 40 * k)
        x, y = 8 * np.cos(a), 8 * np.sin(a)
        b.lathe([(1.4, 7.2), (1.1, 8.0), (0.1, 8.9)], (x, y, 0), cream, segments=8, crease_deg=10)
        if style == "cream":
            b.ball(0.85, (x, y, 9.1), "#b8182c", segments=8, rings=6)
    if style == "birthday":
        for k in range(7):
            x, y = (4.2 * np.cos(k), 4.2 * np.sin(k)) if k else (0.0, 0.0)
            b.cylinder(0.35, 5.4, (x, y, 7.2), ("#4a8ac8", "#e05a7a", "#f0c040")[k % 3], segments=7)
            b.ball((0.3, 0.3, 0.7), (x, y, 13.3), "#f8b030", segments=6, rings=5)
    size = ((20.5, 20.5, 10), (25, 25, 14.5))[variant % 3]
    return varied_cm(b, f"a {style} cake", (size[0], size[1] * 0.98, size[2]), rng, {"style": style})


@recipe("pancake", 3, name="baked.pancake")
def pancake(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A stack with butter and syrup, one with berries, a folded crêpe-like single stack with sugar."""
    b = MeshBuilder(roughness=0.6)
    style = ("butter and syrup", "berries", "thin stack")[variant % 3]
    count, thick = ((4, 1.0), (3, 1.1), (6, 0.4))[variant % 3]
    for k in range(count):
        cake_ = painted(lumpy(pillow((17, 17, thick), 1.0, 0.4, 26, 6), 0.02, rng, 2))
        b.add(
            cake_,
            image=skin(rng, ["#efd79c", "#e8c884", "#b8742c"], noise=7),
            at=(*(rng.uniform(-0.35, 0.35, 2).tolist()), k * thick * 0.93),
            turn_deg=(0, 0, 60 * k),
        )
    z = count * thick * 0.93
    if style == "butter and syrup":
        b.add(wavy_disc(6.4, 0.3, 0.05, 5, rng), "#8a4210", (0, 0, z - 0.05))
        for a in (0.4, 1.9, 3.4, 4.7):
            b.tube(
                [
                    (6 * np.cos(a), 6 * np.sin(a), z),
                    (8.2 * np.cos(a), 8.2 * np.sin(a), z + 0.05),
                    (8.5 * np.cos(a), 8.5 * np.sin(a), z - 0.5),
                    (8.55 * np.cos(a), 8.55 * np.sin(a), z - 2),
                ],
                [0.5, 0.5, 0.45, 0.4],
                "#8a4210",
                sides=6,
            )
        b.box((3.2, 3.2, 1.0), (0, 0, z + 0.1), "#f6df7a", bevel=0.25, turn_deg=(0, 0, 25))
    elif style == "berries":
        for k in range(9):
            r, a = 1.3 * np.sqrt(k) * 1.1, 2.4 * k
            b.ball(0.9, (r * np.cos(a), r * np.sin(a), z + 0.6), ("#2c3560", "#b8182c")[k % 2], segments=9, rings=6)
        b.ball((2.2, 2.2, 1.1), (-3.4, -3.2, z + 0.4), "#fbf6ea", segments=10, rings=6)
    else:
        for _ in range(24):
            r, a = 7 * np.sqrt(rng.uniform(0, 1)), rng.uniform(0, 2 * np.pi)
            b.box(
                (0.5, 0.5, 0.15), (r * np.cos(a), r * np.sin(a), z), "white", turn_deg=(0, 0, float(rng.uniform(0, 90)))
            )
    size = ((18, 18, 4.6), (16, 16, 5.2), (22, 22, 2.8))[variant % 3]
    return varied_cm(b, f"pancakes: {style}", size, rng, {"style": style})
