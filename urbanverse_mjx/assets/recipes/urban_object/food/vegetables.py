"""Vegetables that grow as roots, bulbs, pods and gourds. Lying ones along x, stalk to the front."""

from collections.abc import Sequence

import numpy as np

from ....meshes import shapes
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, shade
from ....meshes.recipe import recipe
from ...shared.forms import lumpy, painted, pillow, ribbed, softened
from ...shared.sizes import varied_cm
from ...shared.skins import skin
from .exotic_fruits import lying
from .fruits import stalk

CARROT = ((0, 0), (0.25, 0.4), (0.6, 4), (1.0, 9), (1.35, 13.5), (1.5, 16.5), (1.1, 17.8), (0, 17.6))
STRAIGHT = ((0, 0), (1.3, 0.5), (2.0, 2.2), (2.25, 6), (2.3, 15), (2.2, 24), (1.9, 28), (1.1, 29.6), (0, 30))
EGGPLANT = ((0, 0), (2.2, 0.5), (3.9, 3.0), (4.2, 6.5), (3.5, 11), (2.6, 15), (1.9, 17.6), (0, 18))
ONION = ((0, 0), (1.2, 0.1), (2.8, 1.2), (3.5, 3.0), (3.0, 4.8), (1.4, 5.9), (0.5, 6.6), (0.35, 7.4), (0, 7.5))
TOMATO = ((0, 0.2), (1.2, 0.0), (2.7, 0.9), (3.4, 2.7), (3.0, 4.4), (1.8, 5.3), (0.8, 5.3), (0, 4.9))
BULB = ((0, 0), (1.4, 0.1), (2.5, 0.9), (2.75, 1.9), (2.2, 3.0), (1.0, 3.9), (0.45, 4.6), (0.4, 5.6), (0, 5.6))
GOURD = ((0, 1.0), (4, 0.2), (9, 0.0), (13.5, 5), (14.5, 10.5), (13, 16), (8, 20), (3, 20.2), (0, 18.5))


@recipe("carrot", 3, name="vegetables.carrot")
def carrot(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Orange with a tuft, a bunch of three with their greens, a long bare purple one."""
    b = MeshBuilder(roughness=0.6)
    style = ("orange", "bunch", "purple")[variant % 3]
    color = "#e5731f" if style != "purple" else "#5b2a4e"
    for k, (y, z) in enumerate(((0.0, 0.0),) if style != "bunch" else ((-1.6, 0.0), (1.6, 0.0), (0.0, 2.4))):
        body = painted(lumpy(lying(CARROT, 16), 0.02, rng), 0)
        b.add(
            body,
            image=skin(
                rng, [color, shade(color, 1.1), shade(color, 0.9), color], noise=6, flecks=(shade(color, 0.7), 60)
            ),
            at=(k * 0.3, y, z),
            crease_deg=80,
        )
        for leaf in range(2 if style == "purple" else 5):
            a = 2 * np.pi * leaf / 5
            reach = 2.0 if style == "purple" else 6.0 + leaf % 2
            tip = (17.6 + reach, y + 1.2 * np.cos(a), z + 1.5 + 1.2 * np.sin(a))
            b.tube(
                [(17.4, y, z + 1.5), (17.6 + reach * 0.6, y + 0.5 * np.cos(a), z + 1.5 + 0.5 * np.sin(a)), tip],
                [0.25, 0.22, 0.5],
                "leaf",
                sides=5,
            )
            if style != "purple":
                b.ball((1.5, 0.7, 0.6), tip, ("leaf", "light leaf")[leaf % 2], segments=7, rings=4)
    size = ((18, 3.2, 3.2), (26, 8, 7), (22, 3.4, 3.4))[variant % 3]
    return varied_cm(b, f"a {style} carrot", size, rng, {"style": style})


def long_gourd(
    name: str, variant: int, rng: np.random.Generator, colors: Sequence[Color], size: tuple[float, float, float]
) -> BuiltAsset:
    """Cucumber and courgette: a bow-straight rod with stripes, a stalk with five edges, a flower scar."""
    b = MeshBuilder(roughness=0.5)
    body = lying(STRAIGHT, 16)
    body.vertices[:, 1] += 0.9 * np.sin(np.pi * body.vertices[:, 0] / 30) - 0.5
    image = skin(rng, colors, noise=6, flecks=(shade(colors[0], 1.6), 160))
    image[:, ::4] = np.clip(image[:, ::4].astype(float) * 1.18, 0, 255).astype(np.uint8)
    b.add(painted(lumpy(body, 0.025, rng, 8 if name == "cucumber" else 2), 0), image=image, crease_deg=80)
    if name == "zucchini":
        b.cylinder(1.5, 3.0, (29.3, -0.5, 2.3), shade(colors[0], 1.35), turn_deg=(0, 90, 0), top_radius=1.2, segments=6)
        b.cylinder(1.1, 0.5, (-0.3, -0.5, 2.3), "#c9b46a", turn_deg=(0, 90, 0), segments=8)
    else:
        b.cylinder(0.35, 0.9, (29.7, -0.5, 2.3), "#7d8a4a", turn_deg=(0, 90, 0), segments=6)
    kind = ("plain", "long", "small")[variant % 3]
    return varied_cm(b, f"a {kind} {name}", size, rng, {"kind": kind})


@recipe("cucumber", 3, name="vegetables.cucumber")
def cucumber(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Dark green, a long light one, a short pickling one."""
    colors: Sequence[Color] = (["#1f4a22", "#2a5a2a"], ["#3a6a30", "#4a7d3a"], ["#4f7a2c", "#86a04a"])[variant % 3]
    return long_gourd("cucumber", variant, rng, colors, ((30, 4.6, 4.6), (36, 4.4, 4.4), (17.5, 4.4, 4.4))[variant % 3])


@recipe("zucchini", 3, name="vegetables.zucchini")
def zucchini(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Green, pale green, yellow; with their angular stalks."""
    colors: Sequence[Color] = (["#2f5a26", "#3d6e2f"], ["#8aa85a", "#9cb86a"], ["#e0b020", "#ecc438"])[variant % 3]
    return long_gourd("zucchini", variant, rng, colors, ((20, 4.6, 4.6), (25, 5.2, 5.2), (16.5, 4.2, 4.2))[variant % 3])


@recipe("eggplant", 3, name="vegetables.eggplant")
def eggplant(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Nearly black, striped violet and white, a slim long one; green calyx and stalk."""
    b = MeshBuilder(roughness=0.2)
    style = ("black", "striped", "slim")[variant % 3]
    color: Color = ("#2b1734", "#8a4a86", "#4a2058")[variant % 3]
    image = skin(rng, [color, shade(color, 1.2), color], noise=3)
    if style == "striped":
        image[::3] = (226, 208, 222)
    body = lumpy(lying(EGGPLANT, 22), 0.01, rng)
    b.add(painted(body), image=image, crease_deg=80)
    for k in range(5):
        with b.frame((18, 0, 4.2), (72 * k, 0, 0)):
            b.convex(
                [(0.3, -1.3, 0.2), (0.3, 1.3, 0.2), (0.0, 0, 2.0), (-2.8, 0, 3.0), (-2.6, 0, 2.4), (0.3, 0, 0)],
                "#4f7034",
            )
    b.tube([(17.6, 0, 4.2), (19.5, 0, 4.5), (20.5, 0.2, 5.2)], [0.8, 0.6, 0.7], "#5f7d3a", sides=7)
    size = ((20.5, 8.6, 8.6), (17, 9.6, 9.6), (26, 6.4, 6.4))[variant % 3]
    return varied_cm(b, f"a {style} eggplant", size, rng, {"style": style})


@recipe("onion", 3, name="vegetables.onion")
def onion(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Brown, red, white; dry tip above, beard of roots below."""
    b = MeshBuilder(roughness=0.5)
    style = ("brown", "red", "white")[variant % 3]
    color: Color = ("#c07a34", "#8a2850", "#ece6d2")[variant % 3]
    image = skin(
        rng, [shade(color, 0.8), color, shade(color, 1.08), shade(color, 0.9), "#b8935a"], noise=3, size=(48, 32)
    )
    streak = 1 + 0.14 * np.sin(np.arange(48) * 1.9 + rng.uniform(0, 6)) + rng.normal(0, 0.04, 48)
    body = shapes.lathe(softened(ONION), 24)
    b.add(
        painted(lumpy(body, 0.02, rng)),
        image=np.clip(image * streak[None, :, None], 0, 255).astype(np.uint8),
        crease_deg=80,
    )
    for k in range(7):
        a = 0.9 * k
        b.tube(
            [(0.3 * np.cos(a), 0.3 * np.sin(a), 0.1), (0.8 * np.cos(a), 0.8 * np.sin(a), -0.15)],
            [0.12, 0.04],
            "#d8c9a0",
            sides=3,
        )
    b.tube([(0, 0, 7.0), (0.1, 0.1, 7.9), (0.5, 0.2, 8.6)], [0.36, 0.28, 0.4], "#b8935a", sides=6)
    size = ((7, 7, 7), (6.4, 6.4, 6.2), (8.4, 8.4, 8.6))[variant % 3]
    return varied_cm(b, f"a {style} onion", size, rng, {"style": style})


@recipe("garlic", 2, name="vegetables.garlic")
def garlic(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A white bulb of cloves, a violet-striped one; dry stalk, roots."""
    b = MeshBuilder(roughness=0.7)
    color: Color = ("#efe9dc", "#e2d3d8")[variant % 2]
    image = skin(rng, [shade(color, 0.92), color, shade(color, 0.95), "#cbb98f"], noise=3, size=(48, 32))
    image[:, :: 5 - variant % 2] = np.array([205, 190, 175] if variant % 2 == 0 else [150, 90, 130])
    body = ribbed(shapes.lathe(softened(BULB, 16), 40), 8, 0.10)
    b.add(painted(body), image=image, crease_deg=60)
    b.cylinder(0.9, 0.2, (0, 0, -0.15), "#b59a6a", segments=10)
    b.cylinder(0.36, 0.9, (0, 0, 5.3), "#c9b58a", segments=7)
    size = ((5.5, 5.5, 5.2), (6.3, 6.3, 6.8))[variant % 2]
    return varied_cm(b, "a bulb of garlic", size, rng, {"color": str(color)})


@recipe("ginger", 2, name="vegetables.ginger")
def ginger(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A knobbly hand of rhizomes with rings and a cut end."""
    b = MeshBuilder(roughness=0.8)
    color: Color = ("#c49a5c", "#b0854c")[variant % 2]
    image = skin(rng, [color, shade(color, 1.1), color], noise=8, flecks=(shade(color, 0.7), 90))
    image[::7] = np.array(shade(color, 0.74))  # the rings where leaves sat
    arms = (
        (0, 0, 0, 5.2, 1.9),
        (2.5, 1.0, 60, 4.2, 1.5),
        (-2.0, -0.8, -110, 3.8, 1.5),
        (4.0, 0, -35, 3.6, 1.4),
        (-3.6, 0.3, 130, 3.6, 1.4),
    )
    for x, y, yaw, length, fat in arms[: 5 - variant % 2]:
        body = lumpy(pillow((2 * length, 2 * fat, 1.9 * fat), 0.85, 0.9, 16, 10), 0.12, rng, 2)
        with b.frame((x, y, 0), (0, 0, yaw)):
            b.add(painted(body, 0), image=image, at=(length * 0.4 if yaw else 0, 0, 0), crease_deg=80)
    for x, y, z in ((1.4, 1.6, 2.4), (-1.8, 0.6, 3.2), (-4.6, -0.6, 2.2), (0.6, -1.9, 2.2), (3.0, 0.4, 3.2)):
        knob = lumpy(shapes.ellipsoid((1.0, 0.9, 1.0), 10, 7), 0.1, rng, 2)
        b.add(painted(knob), image=image, at=(x, y, z), crease_deg=80)
    for x, y, yaw in ((6.9, -2.0, -35.0), (-5.1, 0.0, 180.0))[: 2 - variant % 2]:
        b.ball((0.35, 0.95, 0.85), (x, y, 1.6), "#ecd98c", turn_deg=(0, 0, yaw), segments=10, rings=6)
    size = ((12.5, 7.5, 4.0), (15.5, 8.6, 4.4))[variant % 2]
    return varied_cm(b, "a hand of ginger", size, rng, {"kind": variant % 2})


@recipe("potato", 3, name="vegetables.potato")
def potato(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Yellow, red-skinned, a large baker; uneven, with eyes."""
    b = MeshBuilder(roughness=0.85)
    style = ("yellow", "red-skinned", "baking")[variant % 3]
    color: Color = ("#c9a360", "#a4524a", "#a07a4c")[variant % 3]
    body = lumpy(pillow((8.8, 6, 5.2), 0.9, 0.95, 24, 14), (0.05, 0.06, 0.04)[variant % 3], rng, 1.3)
    image = skin(rng, [shade(color, 0.94), color, shade(color, 1.05)], noise=7, flecks=(shade(color, 0.72), 90))
    for _ in range(9):
        row, column = int(rng.integers(6, 42)), int(rng.integers(1, 28))
        image[row : row + 2, column : column + 3] = [round(0.55 * c) for c in image[row, column]]
    b.add(painted(body), image=image, crease_deg=80)
    size = ((8.8, 6.0, 5.2), (7.4, 5.6, 5.0), (12.4, 7.2, 6.4))[variant % 3]
    return varied_cm(b, f"a {style} potato", size, rng, {"style": style})


@recipe("tomato", 3, name="vegetables.tomato")
def tomato(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Round red, ribbed beefsteak, small cherry; green star on top."""
    b = MeshBuilder(roughness=0.2)
    style = ("round", "beefsteak", "cherry")[variant % 3]
    color: Color = ("#c8281c", "#b8342a", "#d8321c")[variant % 3]
    body = shapes.lathe(softened(TOMATO), 32)
    body = ribbed(body, 9, 0.09) if style == "beefsteak" else lumpy(body, 0.015, rng)
    b.add(
        painted(body),
        image=skin(rng, [color, color, shade(color, 1.1), "#c86a2c" if style == "beefsteak" else color], noise=4),
        crease_deg=80,
    )
    for k in range(5):
        with b.frame((0, 0, 5.15), (0, 0, 72 * k)):
            b.convex(
                [(0, -0.3, 0), (0, 0.3, 0), (1.0, -0.35, 0.25), (1.0, 0.35, 0.25), (2.1, 0, 0.1), (0.4, 0, 0.35)],
                "#3f7a2c",
            )
    stalk(b, 5.2, 0.9, 0.22, "#4a7a30", 0.4)
    size = ((6.8, 6.8, 5.7), (9.2, 9.2, 6.6), (3.6, 3.6, 3.5))[variant % 3]
    return varied_cm(b, f"a {style} tomato", size, rng, {"style": style})


@recipe("pumpkin", 3, name="vegetables.pumpkin")
def pumpkin(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Orange with ribs and a curled stalk, a carved lantern, a flat green-grey one; the face at +x."""
    b = MeshBuilder(roughness=0.5)
    style = ("orange", "lantern", "flat grey")[variant % 3]
    color: Color = ("#d87a1e", "#e07f1c", "#8a9a86")[variant % 3]
    body = ribbed(shapes.lathe(softened(GOURD, 13), 60), 10, 0.13)
    image = skin(rng, [shade(color, 0.92), color, shade(color, 1.05), shade(color, 0.9)], noise=5)
    b.add(painted(body), image=image, crease_deg=80)
    b.tube([(0, 0, 18), (0.2, 0, 20.5), (1.2, 0.8, 23), (3.0, 1.4, 24)], [2.2, 1.3, 1.1, 1.4], "#5f6a30", sides=6)
    if style == "lantern":
        shapes_on = [
            [(-5.5, 12), (-1.6, 12.4), (-3.2, 16)],
            [(5.5, 12), (1.6, 12.4), (3.2, 16)],
            [(-1, 9.6), (1, 9.6), (0, 11.4)],
            [
                (-7.5, 7.6),
                (-4, 4.6),
                (0, 3.8),
                (4, 4.6),
                (7.5, 7.6),
                (4, 6.8),
                (2, 6.6),
                (1.6, 8),
                (0.2, 6.4),
                (-2, 6.6),
                (-2.6, 7.8),
                (-4, 6.8),
            ],
        ]
        for outline in shapes_on:
            b.extrude(outline, 3.2, (11.4, 0, 0), "#2a1606", turn_deg=(90, 0, 90))
            inner = np.array(outline)
            small = (inner.mean(0) + (inner - inner.mean(0)) * 0.72).tolist()
            b.extrude([(x, y) for x, y in small], 3.26, (11.4, 0, 0), "#f0b02c", turn_deg=(90, 0, 90))
    size = ((29, 29, 23), (31, 31, 26), (36, 36, 20))[variant % 3]
    return varied_cm(b, f"a {style} pumpkin", size, rng, {"style": style})
