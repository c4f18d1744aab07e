"""Fruits of a market stall, by family: round ones with a dimple, berries, tropical ones. Lying ones along x."""

import dataclasses
from collections.abc import Sequence

import numpy as np

from ....meshes import shapes
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color
from ....meshes.recipe import recipe
from ....meshes.shapes import Point2
from ...shared.forms import lumpy, painted, pillow, ribbed, softened
from ...shared.sizes import varied_cm
from ...shared.skins import skin

APPLE = (
    (0, 0.3),
    (0.9, 0.05),
    (1.6, 0.0),
    (2.7, 0.9),
    (3.6, 2.6),
    (3.9, 4.4),
    (3.5, 6.1),
    (2.4, 7.1),
    (1.2, 7.2),
    (0, 6.3),
)
PEACH = ((0, 0.0), (1.6, 0.2), (2.8, 1.2), (3.5, 3.0), (3.4, 4.6), (2.7, 5.9), (1.4, 6.5), (0.4, 6.2), (0, 5.7))
PEAR = (
    (0, 0.3),
    (1.2, 0.0),
    (2.6, 0.6),
    (3.6, 2.2),
    (3.8, 3.8),
    (3.2, 5.8),
    (2.2, 7.6),
    (1.7, 9.0),
    (1.3, 10.2),
    (0.6, 10.7),
    (0, 10.6),
)
ROUND = ((0, 0.1), (0.9, 0.0), (2.3, 0.7), (3.5, 2.2), (3.9, 3.9), (3.6, 5.5), (2.5, 6.9), (1.0, 7.5), (0, 7.4))
PLUM = ((0, 0.0), (1.0, 0.2), (2.0, 1.1), (2.5, 2.4), (2.3, 3.4), (1.5, 4.2), (0.5, 4.5), (0, 4.2))


@dataclasses.dataclass(frozen=True)
class Kind:
    """One kind of a round fruit: name, colours from below to above, blush, flecks, size (x, y, z) in cm."""

    name: str
    colors: Sequence[Color]
    blush: Color | None
    flecks: tuple[Color, int] | None
    size: tuple[float, float, float]
    leaf: bool = False


def leaf_blade(
    b: MeshBuilder, at: tuple[float, float, float], length: float, yaw: float, color: Color = "leaf"
) -> None:
    """A folded leaf from a point, drooping at its tip."""
    with b.frame(at, (0, -15, yaw)):
        blade = pillow((length, length * 0.45, length * 0.06), 0.8, 0.8, 12, 4)
        blade.vertices[:, 2] -= 0.5 * (blade.vertices[:, 0] / length) ** 2 * length - 0.25 * np.abs(
            blade.vertices[:, 1]
        )
        b.add(blade, color, (length / 2, 0, 0))


def fruit(
    b: MeshBuilder,
    profile: Sequence[Point2],
    kind: Kind,
    rng: np.random.Generator,
    lumps: float = 0.02,
    cleft: bool = False,
) -> None:
    """A lathed body under its skin, a little uneven; `cleft` draws the groove of stone fruits."""
    body = shapes.lathe(softened(profile), 24)
    if cleft:
        angle = np.arctan2(body.vertices[:, 1], body.vertices[:, 0])
        body.vertices[:, :2] *= (1 - 0.10 * np.exp(-((angle - 0.5) ** 2) / 0.02))[:, None]
    b.add(painted(lumpy(body, lumps, rng)), image=skin(rng, kind.colors, kind.blush, 5, kind.flecks), crease_deg=80)


def stalk(b: MeshBuilder, z: float, height: float, radius: float, color: Color = "#5b4327", lean: float = 0.3) -> None:
    b.tube(
        [(0, 0, z), (0.3 * lean * height, 0, z + height * 0.6), (lean * height, 0, z + height)],
        [radius, radius, radius * 1.3],
        color,
        sides=6,
    )


ROUND_FRUITS: dict[str, tuple[Sequence[Point2], bool, tuple[float, float, float], tuple[Kind, ...]]] = {
    # leaf -> profile, whether it has a cleft, stalk (foot, height, radius), kinds
    "apple": (APPLE, False, (6.0, 2.4, 0.17), (
        Kind("red apple", ["#8e1420", "#b01a22", "#a31620"], "#d9483a", ("#e8b38a", 40), (7.7, 7.7, 7.0), True),
        Kind("green apple", ["#7fa52c", "#9cc23c", "#8fb834"], None, ("#d8e59a", 40), (8.2, 8.2, 7.6)),
        Kind("striped apple", ["#d8b24a", "#d99a3c", "#c9a03c"], "#b8261f", ("#e8d79a", 40), (7.0, 7.0, 6.6), True))),
    "apricot": (PEACH, True, (5.6, 0.5, 0.2), (
        Kind("apricot", ["#e08a2c", "#ec9d3a", "#e08a2c"], "#d8542c", ("#c86a2a", 30), (4.5, 4.5, 4.4)),
        Kind("pale apricot", ["#e8b45a", "#efc06a", "#e2a84c"], "#e08a50", None, (4.0, 4.0, 4.1), True),
        Kind("red apricot", ["#d8762a", "#df7f30", "#c9622a"], "#a8322a", ("#b84a2a", 40), (5.0, 5.0, 4.8)))),
    "peach": (PEACH, True, (5.6, 0.6, 0.25), (
        Kind("peach", ["#e8a850", "#edb560", "#e29a4c"], "#bb2f33", None, (7.0, 7.0, 6.5), True),
        Kind("nectarine", ["#c85a30", "#d8743a", "#b8402c"], "#8e1b28", ("#e8b070", 30), (6.6, 6.6, 6.2)),
        Kind("white peach", ["#efd8b4", "#f2dcb8", "#e8c8a4"], "#d9707a", None, (7.6, 7.6, 6.9)))),
    "plum": (PLUM, True, (4.1, 0.9, 0.12), (
        Kind("blue plum", ["#3a2550", "#4a3266", "#3f2858"], "#6f6590", None, (5.0, 5.0, 4.4)),
        Kind("red plum", ["#7e1730", "#931d36", "#7e1730"], "#b8404a", ("#c98a8a", 30), (5.5, 5.5, 5.0), True),
        Kind("mirabelle", ["#d8aa30", "#e4bc44", "#d8aa30"], "#c87a34", ("#b8682a", 20), (3.8, 3.8, 3.6)))),
    "orange": (ROUND, False, (7.3, 0.25, 0.42), (
        Kind("orange", ["#e07a14", "#ee8a1c", "#e6801a"], None, ("#c8640c", 220), (7.8, 7.8, 7.5)),
        Kind("blood orange", ["#dd6f1c", "#e07a22", "#d05a1c"], "#b8341c", ("#b8500c", 200), (7.2, 7.2, 7.0), True),
        Kind("large orange", ["#ee9a20", "#f2a630", "#ee9a20"], None, ("#d07c10", 260), (8.8, 8.8, 8.5), True))),
    "pear": (PEAR, False, (10.4, 2.4, 0.17), (
        Kind("green pear", ["#9aae3a", "#b0c04a", "#9cb03c"], None, ("#7a6a2a", 90), (7.6, 7.6, 10.5)),
        Kind("red-cheeked pear", ["#c9bc4a", "#d4c656", "#c8b848"], "#b8442c", ("#8a6a2a", 60), (8.2, 8.2, 10.2), True),
        Kind("brown pear", ["#a07c3c", "#ac8844", "#96703a"], None, ("#7a5a2a", 120), (7.0, 7.0, 12.4)))),
}  # fmt: skip


def register(leaf: str) -> None:
    """Registers the kinds of a round fruit."""
    profile, cleft, (foot, height, radius), kinds = ROUND_FRUITS[leaf]

    def build(variant: int, rng: np.random.Generator) -> BuiltAsset:
        kind = kinds[variant % len(kinds)]
        b = MeshBuilder(roughness=0.5)
        fruit(b, profile, kind, rng, cleft=cleft)
        stalk(b, foot, height, radius, "#4f6a2a" if leaf == "orange" else "#5b4327", 0.25 if height > 1 else 0.0)
        if kind.leaf:
            leaf_blade(b, (0.1, 0, foot + height * 0.5), profile[-1][1] * 0.6, float(rng.uniform(40, 80)))
        return varied_cm(b, f"a {kind.name}", kind.size, rng, {"kind": kind.name})

    recipe(leaf, len(kinds), name=f"fruits.round_{leaf}")(build)


for _leaf in ROUND_FRUITS:
    register(_leaf)


@recipe("blueberry", 3, name="fruits.blueberry")
def blueberry(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A berry with its crown: dusty blue, nearly black, a flat reddish one."""
    b = MeshBuilder(roughness=0.7)
    color: Sequence[Color] = (
        ["#2c3a66", "#4a5c92", "#6c7db0"],
        ["#1d2140", "#2c3158", "#3a4270"],
        ["#4b2f5c", "#5c4478", "#6e5a94"],
    )[variant % 3]
    body = shapes.lathe(
        [(0, 0), (2.2, 0.3), (3.8, 1.6), (4.6, 3.8), (4.0, 6.0), (2.6, 7.2), (1.6, 7.5), (1.2, 7.0), (0, 6.8)], 22
    )
    b.add(
        painted(lumpy(body, 0.02, rng)),
        image=skin(rng, color, "#8a9ac4" if variant % 3 == 0 else None, 8),
        crease_deg=60,
    )
    b.cylinder(1.15, 0.1, (0, 0, 6.95), "#16182e", segments=10)
    for k in range(5):
        with b.frame((0, 0, 7.1), (0, 0, 72 * k)):
            b.convex([(1.1, -0.8, 0), (1.1, 0.8, 0), (2.2, 0, 0.9), (1.2, 0, -0.3), (1.3, 0, 0.5)], color[1])
    size = ((1.4, 1.4, 1.25), (1.15, 1.15, 1.05), (1.7, 1.7, 1.4))[variant % 3]
    return varied_cm(b, "a blueberry", size, rng, {"kind": variant % 3})


@recipe("cherry", 3, name="fruits.cherry")
def cherry(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """One on its stalk, a pair on joined stalks, a yellow-red one with a leaf."""
    b = MeshBuilder(roughness=0.25)
    style = ("single", "pair", "bicoloured")[variant % 3]
    body = shapes.lathe(
        softened([(0, 0), (3.5, 0.5), (6.0, 2.6), (6.8, 5.6), (6.0, 8.6), (4.0, 10.4), (1.4, 10.8), (0, 9.6)], 12), 20
    )
    colors: Sequence[Color] = (
        ["#7e0f1e", "#a3142a", "#8e1022"],
        ["#5e0a18", "#7a0f20", "#660c1c"],
        ["#d8a23a", "#e0b04a", "#d89a3a"],
    )[variant % 3]
    for y in (-6.4, 6.4) if style == "pair" else (0.0,):
        b.add(painted(lumpy(body, 0.02, rng)), image=skin(rng, colors, "#c4202e"), at=(0, y, 0), crease_deg=80)
        top = (0.0, 0.0, 27.0) if style == "pair" else (2.0, 2.0, 18.0)
        b.tube(
            [
                (0, y, 9.4),
                (0, y * 0.95 + 0.4, 14),
                (top[0], y * 0.6 + top[1] * 0.5, 20 if style == "pair" else 16),
                top,
            ],
            [0.5, 0.4, 0.4, 0.7],
            "#6f8f2e",
            sides=6,
        )
    if style == "bicoloured":
        leaf_blade(b, (2, 2, 17.6), 9, 140)
    size = ((2.6, 2.6, 4.0), (2.6, 5.0, 5.6), (2.9, 2.8, 4.4))[variant % 3]
    return varied_cm(b, f"a {style} cherry", size, rng, {"style": style})


@recipe("coconut", 3, name="fruits.coconut")
def coconut(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A hairy brown nut with its three eyes, an opened half, a green drinking nut with a straw."""
    b = MeshBuilder(roughness=0.95)
    style = ("brown", "half", "green drinking")[variant % 3]
    if style == "green drinking":
        body = shapes.lathe([(0, 0), (5, 0), (9.5, 5), (11, 11), (9.5, 17), (6.5, 20.5), (0, 20.5)], 18)
        b.add(
            painted(ribbed(body, 3, 0.08)), image=skin(rng, ["#6f9a3a", "#83ad48", "#78a240"], noise=7), crease_deg=50
        )
        b.cylinder(6.6, 0.6, (0, 0, 20.2), "#efe6cc", segments=18)
        b.cylinder(3.4, 0.3, (0, 0, 20.75), "#d8e4e0", segments=16)
        b.tube([(0, 0, 15), (1.5, 1, 24), (4.5, 2, 27)], 0.5, "red", sides=6)
    elif style == "half":
        bowl = [(0, 0), (4, 0.4), (6.2, 2.6), (6.7, 6.4), (6.0, 6.4), (5.6, 3.4), (3.6, 1.4), (0, 1.0)]
        b.lathe(bowl[:5], color="#5c3d24", segments=22)
        b.lathe([(6.7, 6.2), (6.55, 6.6), (6.2, 6.62), (0, 6.62)], color="#5c3d24", segments=22)
        b.lathe([(6.1, 6.64), (5.9, 6.75), (4.7, 6.75), (4.0, 5.4), (2.4, 4.0), (0, 3.6)], color="#f4efe2", segments=22)
        b.lathe([(0, 6.66), (4.6, 6.68), (4.4, 6.72), (0, 6.7)], color="#e3dccb", segments=22)
    else:
        body = lumpy(shapes.ellipsoid((6.7, 6.7, 6.5), 22, 14), 0.03, rng, 2)
        b.add(
            painted(body),
            image=skin(rng, ["#5a3a20", "#6b482a", "#5a3a20"], noise=16, flecks=("#9a7448", 200)),
            at=(0, 0, 6.5),
        )
        for k in range(3):
            with b.frame((0, 0, 6.5), (0, 0, 120 * k + 20)):
                b.ball((0.85, 0.85, 0.4), (1.7, 0, 6.25), "#2a1a10", segments=10, rings=5)
        hair(b, rng, 6.7, 6.5, 34)
    size = ((13.5, 13.5, 13), (12.8, 12.8, 9.6), (20, 20, 21.5))[variant % 3]
    return varied_cm(b, f"a {style} coconut", size, rng, {"style": style})


def hair(b: MeshBuilder, rng: np.random.Generator, radius: float, middle: float, count: int) -> None:
    """Coir fibres that stand off a nut."""
    for _ in range(count):
        a, z = rng.uniform(0, 2 * np.pi), rng.uniform(-0.75, 0.45)
        reach = np.sqrt(1 - z * z) * radius
        foot = np.array([reach * np.cos(a), reach * np.sin(a), middle + z * radius * 0.9])
        out = np.array([np.cos(a), np.sin(a), rng.uniform(-0.2, 0.9)])
        b.tube(
            [foot - 0.3 * out, foot + 0.25 * out, foot + 0.35 * out + [0, 0, 0.6]],
            [0.14, 0.1, 0.03],
            "#a37b4c",
            sides=3,
        )


@recipe("strawberry", 3, name="fruits.strawberry")
def strawberry(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Red with pale seeds and a green calyx on top: conical, round, long with its stalk."""
    b = MeshBuilder(roughness=0.4)
    style = ("conical", "round", "long")[variant % 3]
    profile = {
        "conical": [(0, 0), (0.7, 0.25), (1.35, 1.2), (1.75, 2.4), (1.7, 3.1), (1.1, 3.6), (0, 3.55)],
        "round": [(0, 0), (1.0, 0.2), (1.7, 0.9), (1.95, 1.9), (1.7, 2.7), (1.0, 3.1), (0, 3.0)],
        "long": [(0, 0), (0.5, 0.3), (1.0, 1.5), (1.4, 3.0), (1.45, 3.8), (0.9, 4.3), (0, 4.2)],
    }[style]
    body = shapes.lathe(softened(profile, 12), 20)
    image = skin(rng, ["#c8141e", "#d01c24", "#c81c22", "#d86a50"], noise=4, size=(40, 48))
    for k in range(4, 46, 4):
        for x in range((k // 4) % 2 * 3, 40, 6):
            image[k : k + 2, x] = (240, 205, 110)
    b.add(painted(lumpy(body, 0.03, rng)), image=image, crease_deg=80)
    top = profile[-1][1]
    for k in range(8):
        with b.frame((0, 0, top - 0.05), (0, 0, 45 * k + 10)):
            b.convex(
                [(0, 0, 0.12), (0.6, -0.26, 0.1), (0.6, 0.26, 0.1), (1.45, 0, 0.05 + 0.3 * (k % 2)), (0.6, 0, 0.22)],
                ("leaf", "light leaf")[k % 2],
            )
    stalk(b, top, 0.55 if style != "long" else 1.0, 0.1, "light leaf", 0.5)
    size = ((3.6, 3.6, 4.2), (4.2, 4.2, 3.9), (3.2, 3.2, 5.3))[variant % 3]
    return varied_cm(b, f"a {style} strawberry", size, rng, {"style": style})


@recipe("grapes", 3, name="fruits.grapes")
def grapes(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A bunch lying down, tapering to its tip: dark, green, red; stalk to the back."""
    b = MeshBuilder(roughness=0.35)
    color: Color = ("#3a2050", "#a8bf52", "#8e2f44")[variant % 3]
    image = skin(rng, [color, color, "#8f86a8" if variant % 3 != 1 else "#d4df94"], noise=5)
    berry = painted(shapes.ellipsoid((1.15, 1.05, 1.05), 8, 5))
    for x, wide, rows in ((-4.6, 3, 2), (-2.7, 4, 3), (-0.8, 4, 3), (1.1, 3, 3), (3.0, 3, 2), (4.7, 2, 1), (6.2, 1, 1)):
        for layer in range(rows):
            count = max(wide - layer, 1)
            for k in range(count):
                at = np.array([x + 0.5 * (layer % 2), (k - (count - 1) / 2) * 2.0, 1.05 + 1.65 * layer]) + rng.uniform(
                    -0.25, 0.25, 3
                )
                b.add(berry, image=image, at=tuple(at), turn_deg=(0, 0, float(rng.uniform(0, 90))), crease_deg=80)
    b.tube([(-3, 0, 3.2), (-6, 0.4, 4.2), (-8, 0, 4.8)], [0.28, 0.3, 0.4], "#7a6a34", sides=6)
    b.rod((-7.6, -1.4, 4.6), (-8.2, 1.2, 5.0), 0.35, "#6a5a2c", sides=6)
    if variant % 3 == 1:
        leaf_blade(b, (-5.6, 0.8, 4.4), 5.5, 60)
    size = ((15, 10, 8), (17, 11.5, 9), (13, 9, 7.2))[variant % 3]
    return varied_cm(b, f"a bunch of {('dark', 'green', 'red')[variant % 3]} grapes", size, rng, {"color": str(color)})
