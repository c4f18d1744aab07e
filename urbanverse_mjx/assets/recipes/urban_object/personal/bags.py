"""Bags and cases: backpacks, luggage, suitcases, briefcases, handbags, grocery bags, baskets, wallets. Front at +x."""

import numpy as np

from ....meshes import paint
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, rgb, shade
from ....meshes.recipe import recipe
from ...shared.forms import painted, pillow, stadium
from ...shared.outlines import arc
from ...shared.sizes import varied_cm
from ...shared.skins import label, weave


def grip(b: MeshBuilder, at: tuple[float, float, float], span: float, rise: float, radius: float, color: Color) -> None:
    """A carrying handle along y: an arch of `rise` over the point, its feet `span` apart."""
    x, y, z = at
    path = [(x, y + dy * span, z + dz * rise) for dy, dz in ((-0.5, 0), (-0.42, 0.75), (-0.25, 1), (0, 1.04))]
    path += [(px, 2 * y - py, pz) for px, py, pz in reversed(path[:-1])]
    b.tube(path, radius, color, sides=6)


def wheels(b: MeshBuilder, half_x: float, half_y: float, radius: float) -> None:
    """Four castors, their axles along y, standing on z = 0."""
    for x in (-half_x, half_x):
        for y in (-half_y, half_y):
            b.cylinder(radius, 1.4, (x, y + 0.7, radius), "rubber", turn_deg=(90, 0, 0), segments=10)
            b.box((radius * 1.2, 2.2, radius * 1.3), (x, y, radius * 0.9), "dark grey")


@recipe("backpack", 3, name="bags.backpack")
def backpack(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A day pack, a tall trekking pack with its mat, a round school bag; straps at the back."""
    b = MeshBuilder(roughness=0.9)
    style = ("day pack", "trekking pack", "school bag")[variant % 3]
    color: Color = ("#27476e", "#b8442c", "#5f9c7a")[variant % 3]
    dark, accent = shade(color, 0.6), ("#d9812f", "#3a3d42", "#f0cf5c")[variant % 3]
    wide, deep, tall = ((29, 15, 45), (29, 19, 58), (27, 15, 35))[variant % 3]
    b.add(pillow((deep, wide, tall), 0.45, 0.45), color)
    b.add(pillow((8, wide * 0.78, tall * 0.42), 0.5, 0.4), shade(color, 0.85), (deep * 0.45, 0, tall * 0.05))
    b.box((0.8, wide * 0.6, 1.0), (deep * 0.45 + 3.9, 0, tall * 0.38), accent)
    rim = [
        (deep * 0.34, y * wide * 0.92, z) for y, z in ((-0.5, tall * 0.42), (-0.47, tall * 0.8), (-0.3, tall * 0.93))
    ]
    b.tube([*rim, *((x, -y, z) for x, y, z in reversed(rim))], 0.5, accent, sides=5)
    for y in (-1, 1):
        strap = [(-deep * 0.35, tall * 0.9), (-deep * 0.78, tall * 0.7), (-deep * 0.75, tall * 0.35), (-deep * 0.3, 4)]
        b.tube([(x, y * wide * (0.2 + 0.1 * (z < 10)), z) for x, z in strap], [1.4, 1.6, 1.4, 0.7], dark, sides=6)
        b.add(pillow((deep * 0.6, 5, tall * 0.32), 0.6, 0.4, 12, 6), dark, (0, y * wide * 0.48, tall * 0.04))
    grip(b, (-deep * 0.3, 0, tall * 0.93), 8, 5, 0.7, dark)
    if style == "day pack":
        b.panel(label("TRAIL", dark, "white", (32, 16)), (deep * 0.45 + 4.2, 0, tall * 0.2), 10, 5)
    elif style == "trekking pack":
        b.add(pillow((deep * 1.1, wide * 0.95, 12), 0.4, 0.6), accent, (0, 0, tall * 0.9))
        b.cylinder(5.5, wide * 1.15, (3, -wide * 0.575, tall + 11), "#4f7d4a", turn_deg=(-90, 0, 0), segments=14)
        for y in (-8, 8):
            b.ring(5.8, 0.6, (3, y, tall + 11), "black", turn_deg=(90, 0, 0), segments=14, sides=5)
            b.box((1, 2, tall * 0.5), (deep * 0.52, y, tall * 0.45), "black", turn_deg=(0, 4, 0))
    else:
        for y in (-5, 5):
            b.ball((0.8, 2, 2), (deep * 0.5 + 0.6, y, tall * 0.68), "white", segments=10, rings=6)
            b.ball((0.8, 1, 1), (deep * 0.5 + 1.1, y, tall * 0.68), "black", segments=8, rings=5)
    size = ((21, 32, 47), (28, 33, 68), (19, 29, 40))[variant % 3]
    return varied_cm(b, f"a {style}", size, rng, {"style": style})


def hard_case(b: MeshBuilder, size: tuple[float, float, float], color: Color, at: tuple[float, float, float]) -> None:
    """A ribbed shell case, upright on its base (no wheels): size (x, y, z), its belt round the middle."""
    x, y, z = size
    with b.frame(at):
        b.add(pillow(size, 0.18, 0.2, 20, 10), color)
        b.box((0.5, y * 1.005, z * 1.004), color="charcoal", bevel=0.2)
        for k in range(5):
            across = y * (-0.34 + 0.17 * k)
            b.box((x + 1.0, y * 0.06, z * 0.8), (0, across, z * 0.1), shade(color, 0.86), bevel=0.5)


@recipe("suitcase", 3, name="bags.suitcase")
def suitcase(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A ribbed shell with its handle drawn out, an aluminium cabin case, a soft case with pockets; upright."""
    b = MeshBuilder(roughness=0.5 if variant % 3 != 2 else 0.9)
    style = ("hard shell", "aluminium cabin", "soft")[variant % 3]
    wide, deep, tall = ((45, 26, 50), (36, 22, 50), (46, 25, 64))[variant % 3]
    reach = (14, 3, 5)[variant % 3]
    wheels(b, deep * 0.32, wide * 0.38, 2.4)
    if style == "soft":
        b.add(pillow((deep, wide, tall), 0.22, 0.2), "#37404e", (0, 0, 4))
        for low, high in ((6, 0.42), (0.5 * tall + 4, 0.34)):
            b.add(pillow((5, wide * 0.82, tall * high), 0.25, 0.25, 16, 8), "#454f60", (deep / 2, 0, low))
            b.box((0.5, wide * 0.7, 0.8), (deep / 2 + 2.4, 0, low + tall * high - 4), "light grey")
    elif style == "aluminium cabin":
        b.add(pillow((deep, wide, tall), 0.12, 0.12), "aluminium", (0, 0, 4))
        for k in range(9):
            b.box((deep + 0.7, 1.5, tall * 0.84), (0, wide * (-0.4 + 0.1 * k), 4 + tall * 0.08), "#a2a8ad", bevel=0.3)
        for y in (-1, 1):
            for z in (4.2, tall - 2):
                b.box((deep + 1, 6, 6), (0, y * (wide / 2 - 3), z), "#70777e", bevel=1.5)
    else:
        hard_case(b, (deep, wide, tall), "#c8503c", (0, 0, 4))
    b.box((0.6, wide * 1.01, tall * 1.005), (0, 0, 4), "charcoal", bevel=0.3)
    for y in (-7, 7):
        b.rod((-deep * 0.28, y, tall), (-deep * 0.28, y, tall + 4 + reach), 0.7, "aluminium", sides=6)
    b.box((2.6, 18, 2.6), (-deep * 0.28, 0, tall + 3 + reach), "black", bevel=0.8)
    grip(b, (deep * 0.1, 0, tall + 3.4), 14, 3, 0.8, "black")
    size = ((26.5, 46, 68), (22, 36, 56), (29, 47, 74))[variant % 3]
    return varied_cm(b, f"a {style} suitcase", size, rng, {"style": style})


@recipe("luggage", 3, name="bags.luggage")
def luggage(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Two cases and a bag side by side, a holdall, a stack of old leather trunks."""
    b = MeshBuilder(roughness=0.7)
    style = ("group of cases", "holdall", "stack of trunks")[variant % 3]
    if style == "group of cases":
        hard_case(b, (22, 33, 44), "#2f6f7d", (-4, -15, 3))
        wheels(b, 12, 24, 1.8)
        hard_case(b, (17, 24, 33), "#d8a13a", (2, 17, 3))
        for y, z in ((-15, 46), (17, 36)):
            for dy in (-5, 5):
                b.rod((-8, y + dy, z), (-8, y + dy, z + 5), 0.6, "aluminium", sides=5)
            b.box((2, 12, 2), (-8, y, z + 4), "black", bevel=0.5)
        b.add(pillow((15, 26, 15), 0.6, 0.5), "#5b3a29", (12, 10, 0))
        grip(b, (12, 10, 13), 13, 8, 0.7, "#3d271c")
    elif style == "holdall":
        b.add(pillow((28, 27, 60), 0.95, 0.3, 20, 10), "#3b4f3a", (0, -30, 13.5), turn_deg=(-90, 0, 0))
        for y in (-15, 15):
            loop = [(13.6, y, 2), (14.4, y, 14), (9, y, 27.5), (6, y * 0.5, 33), (6, -y * 0.5, 33)]
            if y < 0:
                b.tube([*loop, (9, -y, 27.5), (14.4, -y, 14), (13.6, -y, 2)], 1.0, "#8a6a43", sides=6)
                back = [(-x, py, z) for x, py, z in [*loop, (9, -y, 27.5), (14.4, -y, 14), (13.6, -y, 2)]]
                b.tube(back, 1.0, "#8a6a43", sides=6)
        b.box((0.8, 46, 0.8), (0, 0, 28), "black")
        b.add(pillow((6, 24, 15), 0.4, 0.4, 16, 8), "#33452f", (12, 0, 5))
    else:
        for k, (wide, deep, tall, color) in enumerate(
            ((66, 40, 22, "#6d4326"), (56, 34, 19, "#94643a"), (42, 28, 15, "#4c6052"))
        ):
            z, turn = (0, 22.2, 41.4)[k], (0, 5, -7)[k]
            with b.frame((0, 0, z), (0, 0, turn)):
                b.box((deep, wide, tall), color=color, bevel=1.2)
                b.box((deep + 0.4, wide + 0.4, 0.6), (0, 0, tall * 0.62), shade(color, 0.55))
                for y in (-wide * 0.3, wide * 0.3):
                    b.box((deep + 1, 3, tall + 0.5), (0, y, -0.2), shade(color, 0.62), bevel=0.3)
                    b.box((0.8, 2.6, 3.4), (deep / 2 + 0.6, y, tall * 0.5), "brass")
                b.tube([(deep / 2 + x, y, tall * 0.45) for x, y in ((0, -5), (2, -4), (2, 4), (0, 5))], 0.7, "brown")
    size = ((34, 62, 52), (30, 58, 33), (42, 70, 58))[variant % 3]
    return varied_cm(b, f"luggage: a {style}", size, rng, {"style": style})


@recipe("briefcase", 3, name="bags.briefcase")
def briefcase(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A leather attaché case with locks, a ribbed aluminium case, a satchel with flap and buckles."""
    b = MeshBuilder(roughness=0.5)
    style = ("leather attaché", "aluminium", "satchel")[variant % 3]
    color: Color = ("#4a2a1a", "aluminium", "#9a5b2c")[variant % 3]
    if style == "satchel":
        b.add(pillow((13, 40, 28), 0.25, 0.22), color)
        b.extrude(stadium(20, 39, 3), 0.8, (6.3, 0, 17.5), shade(color, 0.82), turn_deg=(0, 90, 0))
        b.box((13, 39, 1), (0, 0, 27.3), shade(color, 0.82), bevel=0.4)
        for y in (-11, 11):
            b.box((0.8, 3, 20), (7.3, y, 6), shade(color, 0.6))
            b.box((0.6, 4, 3), (7.8, y, 8), "brass")
    else:
        b.box((11, 42, 28.5), color=color, bevel=1.2)
        b.box((0.5, 42.3, 28.8), (0, 0, -0.1), "charcoal" if variant else "#2c180f", bevel=0.5)
        if style == "aluminium":
            for k in range(10):
                b.box((11.8, 1.2, 24), (0, -18 + 4 * k, 2.2), "#a3a9ae", bevel=0.3)
            for y in (-20, 20):
                for z in (0, 24):
                    b.box((11.9, 3.4, 4.6), (0, y * 0.985, z), "#6c7379", bevel=0.8)
        for y in (-13, 13):
            b.box((4, 4.4, 2.2), (0.6, y, 27.6), "brass" if variant == 0 else "dark grey", bevel=0.3)
            b.box((0.8, 3.4, 4), (5.6, y, 24), "brass" if variant == 0 else "dark grey", bevel=0.2)
    grip(b, (0, 0, 28), 13, 4.4, 0.9, "#241610" if variant != 2 else shade(color, 0.6))
    size = ((12, 43, 32.5), (13.5, 46, 35), (14, 40, 33))[variant % 3]
    return varied_cm(b, f"a {style} briefcase", size, rng, {"style": style})


@recipe("handbag", 3, name="bags.handbag")
def handbag(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A tote with two handles, a flap bag on a chain, a round-topped bowling bag."""
    b = MeshBuilder(roughness=0.55)
    style = ("tote", "flap", "bowling")[variant % 3]
    color: Color = ("#8c2f39", "#1f1f23", "#c79a6b")[variant % 3]
    metal = "gold"
    if style == "tote":
        b.box((12, 30, 19), color=color, bevel=1.0, taper=(0.55, 0.86))
        b.box((7, 26.2, 1), (0, 0, 18.5), shade(color, 0.6), bevel=0.3)
        for x in (-3.4, 3.4):
            grip(b, (x, 0, 16), 14, 14, 0.6, shade(color, 0.7))
            for y in (-7, 7):
                b.box((0.8, 2, 4), (x * 1.25, y, 14), metal)
        b.panel(label("M", shade(color, 1.15), "gold", (16, 16)), (5.2, 0, 8), 5, 5, "+x", tilt_deg=8)
    elif style == "flap":
        b.add(pillow((9, 25, 15), 0.25, 0.3), color)
        flap = [(0, -12.6), (7, -12.6), (10, -8), (11, 0), (10, 8), (7, 12.6), (0, 12.6)]
        b.extrude(flap, 0.8, (4.2, 0, 14.6), shade(color, 1.5), turn_deg=(0, 84, 0))
        b.box((9, 25.2, 1), (-0.2, 0, 14), shade(color, 1.5), bevel=0.4)
        b.ring(1.3, 0.4, (6.2, 0, 5.6), metal, turn_deg=(0, 90, 0), segments=12, sides=5)
        for k, a in enumerate(np.linspace(-8, 188, 15)):
            y, z = 11.5 * np.cos(np.radians(a)), 15 + 14 * np.sin(np.radians(a))
            b.ring(1.25, 0.32, (0, y, z), metal, turn_deg=(a + 90, 0, 90 * (k % 2)), segments=8, sides=4)
    else:
        side = [(-16, 0), (16, 0), (17, 5), (14, 14), (8, 19), (0, 20), (-8, 19), (-14, 14), (-17, 5)]
        b.extrude(side, 14, (-7, 0, 0), color, turn_deg=(90, 0, 90))
        b.tube([(0, y * 1.01, z * 1.01 + 0.1) for y, z in side[1:]], 0.5, metal, sides=5)
        for x in (-5, 5):
            grip(b, (x, 0, 16.5), 13, 9, 0.8, "#6b4226")
        for y in (-7, 7):
            b.box((14.8, 2.4, 17), (0, y, 0.4), "#6b4226")
    size = ((13, 31, 30), (10, 26, 28), (17, 37, 29))[variant % 3]
    return varied_cm(b, f"a {style} handbag", size, rng, {"style": style})


@recipe("grocery bag", 3, name="bags.grocery_bag")
def grocery_bag(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A paper sack with bread and greens, a knotted-handle plastic bag, a cloth tote."""
    b = MeshBuilder(roughness=0.9)
    style = ("paper", "plastic", "cloth")[variant % 3]
    if style == "paper":
        b.box((17, 31, 27), color="cardboard", taper=(1.06, 1.03))
        b.box((16.6, 30, 0.6), (0, 0, 26.8), shade("cardboard", 0.55))
        b.panel(label("FRESH\nMARKET", "cardboard", "dark green", (64, 40)), (9.05, 0, 13), 20, 12, tilt_deg=-1)
        for k, (y, lean) in enumerate(((-8, -14), (-3, -6))):
            b.capsule(2.6, 34, (-2, y, 8 - 3 * k), "#c98a44", turn_deg=(lean, 6, 0), segments=10)
        for k in range(3):
            b.ball(3.3, (4.4, 1.0 + 5.6 * k, 27.6), ("red", "orange", "light leaf")[k], segments=12)
        for k in range(5):
            lean = 2.2 * (k - 2)
            root, fork = (-3.4, 5 + 0.3 * lean, 20), (-3.4, 5 + 0.5 * lean, 30)
            leek = [root, fork, (-3.4 + 0.8 * (k % 2), 5 + 1.6 * lean, 37.4 - abs(lean))]
            b.tube(leek, [1.5, 1.1, 0.35], ("light leaf", "leaf")[k % 2], sides=6)
        for x in (-9, 9):  # the zigzag that the paper is cut with
            teeth = [(-16.0, 26.6), *((-16 + 2 * k, 27 + 0.9 * (k % 2)) for k in range(17)), (16.0, 26.6)]
            b.extrude(teeth, 0.3, (x - 0.15, 0, 0), "cardboard", turn_deg=(90, 0, 90))
    elif style == "plastic":
        b.add(pillow((16, 32, 28), 0.6, 0.55), "#e8eef0")
        b.panel(label("THANK\nYOU", "#e8eef0", "red", (40, 40)), (8.05, 0, 14), 11, 11)
        for y in (-9, 9):
            loop = [(0, y - 5, 24), (0, y - 3.4, 32), (0, y, 39), (0, y + 3.4, 32), (0, y + 5, 24)]
            b.tube(loop, [2.2, 1.0, 0.8, 1.0, 2.2], "#dfe6e9", sides=6)
    else:
        b.box((14, 35, 34), color="#dcd2b8", bevel=2.0, taper=(0.5, 1.0))
        b.panel(label("LOCAL\nFARM", "#dcd2b8", "#2f6b4f", (48, 48)), (5.9, 0, 16), 20, 20, tilt_deg=6)
        for x in (-3, 3):
            grip(b, (x, 0, 31), 14, 14, 0.8, "#2f6b4f")
    size = ((18, 34, 38), (20, 33, 42), (15, 38, 44))[variant % 3]
    return varied_cm(b, f"a {style} grocery bag", size, rng, {"style": style})


@recipe("picnic basket", 3, name="bags.picnic_basket")
def picnic_basket(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Oblong wicker with two lids and a bow, a strapped hamper, an oval basket under a checked cloth."""
    b = MeshBuilder(roughness=0.9)
    style = ("two-lid", "hamper", "oval")[variant % 3]
    wicker, dark = (("#b98a4e", "#8f6232"), ("#9a6a3a", "#6e4624"), ("#cda566", "#a37b42"))[variant % 3]
    woven = weave(wicker, dark)
    plan = 0.25 if style != "oval" else 0.85
    body = pillow((28, 40, 19), plan, 0.15, 24, 8)
    body.vertices[:, :2] *= 0.86 + 0.14 * body.vertices[:, 2:] / 19
    b.add(painted(body), image=woven)
    if style == "oval":
        image, draw = paint.canvas((48, 48), "white")
        for k in range(0, 48, 12):
            draw.rectangle((k, 0, k + 5, 47), fill=rgb("#e08a84"))
        for k in range(0, 48, 12):
            draw.rectangle((0, k, 47, k + 5), fill=rgb("#c8322c"))
        b.add(painted(pillow((26, 37, 7), 0.85, 0.8, 20, 6)), image=image, at=(0, 0, 16))
        b.panel(image, (12.6, 0, 15), 16, 9, "+x", back="#c8322c")
    else:
        for y in (-10.2, 10.2) if style == "two-lid" else (0,):
            lid = (28.6, 20 if style == "two-lid" else 40.6, 2.4)
            b.add(painted(pillow(lid, 0.2, 0.3, 20, 6)), image=woven, at=(0, y, 18.5))
    ring = pillow((29, 41, 2), plan, 0.6, 24, 4)
    b.add(ring, dark, (0, 0, 17.4))
    if style == "hamper":
        for y in (-11, 11):
            b.box((29.6, 2.6, 0.8), (0, y, 20.6), "#5a3218")
            b.box((0.8, 2.6, 13), (14.6, y, 9), "#5a3218")
            b.box((0.9, 3.4, 2.6), (14.9, y, 12), "brass")
        grip(b, (14.6, 0, 15), 11, 3, 0.8, "#5a3218")
    else:
        x, z = arc(13.6, 0, 180, 13).T
        b.tube([(px, 0, 17 + 1.1 * pz) for px, pz in zip(x, z, strict=True)], 1.1, dark, sides=7)
    size = ((30, 42, 32), (33, 46, 25), (27, 37, 36))[variant % 3]
    return varied_cm(b, f"a {style} picnic basket", size, rng, {"style": style})


@recipe("wallet", 3, name="bags.wallet")
def wallet(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A bifold with cards showing, one standing open, a long zipped purse; upright, fold to one side."""
    b = MeshBuilder(roughness=0.5)
    style = ("bifold", "open bifold", "zipped purse")[variant % 3]
    color: Color = ("#5a3620", "#1d1d20", "#a2343f")[variant % 3]
    if style == "zipped purse":
        b.add(pillow((2.4, 19, 10), 0.25, 0.35), color)
        b.tube(
            [(0, y, z) for y, z in ((-9.3, 8.6), (-8.4, 9.7), (0, 10), (8.4, 9.7), (9.3, 8.6))], 0.25, "gold", sides=5
        )
        b.box((0.3, 0.5, 2), (0.5, 9.2, 7), "gold")
        b.box((0.2, 5, 2.4), (1.15, 0, 5), "gold", bevel=0.05)
    else:
        lean = 4.0 if style == "bifold" else 10.0
        for side in (-1, 1):
            with b.frame((side * 0.35, -5.5, 0), (0, 0, -side * lean)):
                b.box((0.55, 11, 9), (0, 5.5, 0), color, bevel=0.2)
                b.box((0.62, 10.2, 0.14), (0, 5.5, 0.5), shade(color, 1.6))
                b.box((0.62, 10.2, 0.14), (0, 5.5, 8.3), shade(color, 1.6))
                b.box((0.2, 8.4, 5.4), (-side * 0.3, 6, 3.8), ("light blue", "gold")[side > 0])
                b.box((0.15, 9.6, 8), (-side * 0.5, 6, 1.4), "#9db08a")
        b.add(pillow((1.2, 1.2, 9), 1.0, 0.2, 10, 6), color, (0, -5.4, 0))
    size = ((2.2, 11.2, 9.2), (3.3, 10.6, 9.6), (2.5, 19, 10))[variant % 3]
    return varied_cm(b, f"a {style} wallet", size, rng, {"style": style})
