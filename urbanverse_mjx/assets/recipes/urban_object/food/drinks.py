"""Drinks in glasses, cups, cartons and square bottles. Handles and labels to the front (+x)."""

import numpy as np

from ....meshes import shapes
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, mix, shade
from ....meshes.recipe import recipe
from ...shared.forms import painted, stadium
from ...shared.outlines import arc
from ...shared.sizes import varied_cm
from ...shared.skins import label, patch
from .bottles import Bottle, round_bottle, tinted

GLASS = "#d3e0e4"


def filled(
    b: MeshBuilder, profile: list[tuple[float, float]], drink: Color, level: float, glass: Color = GLASS
) -> None:
    """A glass (radius, z) with a drink in it: its skin shows the level; the drink's surface lies inside the rim."""
    top = profile[-1][1]
    inner = float(np.interp(level, [z for _, z in profile], [r for r, _ in profile]))
    rim = profile[-1][0]
    body = shapes.lathe([(0, profile[0][1]), *profile, (rim - 0.25, top), (inner - 0.3, level), (0, level)], 24)
    b.add(painted(body), image=tinted(glass, (mix(drink, glass, 0.15), level - profile[0][1]), top - profile[0][1]))
    b.cylinder(inner - 0.28, 0.06, (0, 0, level - 0.02), drink, segments=24)


def straw(
    b: MeshBuilder, foot: tuple[float, float, float], tip: tuple[float, float, float], radius: float, color: Color
) -> None:
    b.rod(foot, tip, radius, color, sides=8)
    b.cylinder(radius * 0.7, 0.02, tip, "charcoal", segments=8)


def citrus_wheel(b: MeshBuilder, at: tuple[float, float, float], radius: float, color: Color, turn: float) -> None:
    """A slice of lemon or orange on the rim, its face towards +x."""
    with b.frame(at, (0, 0, turn)):
        b.cylinder(radius, 0.5, (-0.25, 0, 0), color, turn_deg=(0, 90, 0), segments=20)
        b.cylinder(radius * 0.86, 0.56, (-0.28, 0, 0), "#f3eecb", turn_deg=(0, 90, 0), segments=20)
        for k in range(6):
            a = np.radians(60 * k + 30)
            wedge = [
                (0.1 * np.cos(a), 0.1 * np.sin(a)),
                *(radius * 0.78 * np.array([(np.cos(a + d), np.sin(a + d)) for d in (-0.42, 0, 0.42)])).tolist(),
            ]
            b.extrude(
                [(float(y), float(z)) for y, z in wedge], 0.62, (-0.31, 0, 0), shade(color, 1.12), turn_deg=(90, 0, 90)
            )


@recipe("bubble tea", 3, name="drinks.bubble_tea")
def bubble_tea(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A clear cup with pearls at its ground, a domed lid or sealed film, a fat straw: milk tea, matcha, taro."""
    b = MeshBuilder(roughness=0.3)
    style = ("milk tea", "matcha", "taro")[variant % 3]
    tea: Color = ("#c99a6c", "#8fae62", "#b394c2")[variant % 3]
    filled(b, [(2.9, 0), (3.1, 0.4), (4.4, 13.5), (4.6, 13.8)], tea, 12.6, "#e6ebea")
    for k in range(26):
        a, z = 2.4 * k, 0.75 + 1.05 * (k // 9)
        r = 3.0 + 0.09 * z
        b.ball(0.6, (r * np.cos(a), r * np.sin(a), z), "#2a1a14", segments=7, rings=5)
    patch(b, label("BOBA", tea, "white", (48, 32)), (3.62, 3.95), 5, 9, 110)
    if style == "matcha":
        b.cylinder(4.55, 0.25, (0, 0, 13.75), "#7fa04a", segments=24)
    else:
        b.lathe(
            [(4.75, 13.6), (4.75, 14.2), (4.3, 15.6), (3.0, 16.8), (1.0, 17.2), (0, 17.2)], color="#eef2f2", segments=22
        )
    straw(b, (0, 0, 9), (1.0, 0.8, 21), 0.6, ("#c23a4a", "#e8e2d4", "#6a4a8a")[variant % 3])
    size = ((9.2, 9.2, 20), (9.0, 9.0, 20.8), (9.6, 9.6, 22))[variant % 3]
    return varied_cm(b, f"a {style} bubble tea", size, rng, {"style": style})


@recipe("cocktail", 3, name="drinks.cocktail")
def cocktail(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A martini with an olive, a tumbler with ice and orange, a tall curved glass with umbrella and straw."""
    b = MeshBuilder(roughness=0.2)
    style = ("martini", "tumbler", "hurricane")[variant % 3]
    if style == "martini":
        b.lathe([(0, 0), (3.6, 0), (3.5, 0.35), (0.6, 0.8), (0.4, 2), (0.4, 8.6), (0.7, 9.2)], color=GLASS, segments=24)
        filled(b, [(0.5, 9.0), (1.4, 10.0), (4.6, 15.2), (5.0, 15.9)], "#d8344a", 15.0)
        b.rod((1.2, -2.6, 13.2), (-1.0, 4.6, 17.0), 0.12, "light wood", sides=5)
        b.ball((0.75, 0.9, 0.75), (0.2, 0.6, 15.1), "#7f9a3a", segments=10, rings=7)
        citrus_wheel(b, (0.5, -4.4, 15.8), 1.8, "#e8c92c", 20)
    elif style == "tumbler":
        filled(b, [(3.6, 0), (3.8, 0.6), (4.1, 9.0)], "#d8842c", 6.6)
        for k in range(4):
            b.box(
                (2.2, 2.2, 2.2),
                (1.5 * np.cos(1.7 * k), 1.5 * np.sin(1.7 * k), 5.2 + 0.5 * (k % 2)),
                "#e8f1f4",
                turn_deg=(12 * k, 20, 25 * k),
                bevel=0.3,
            )
        citrus_wheel(b, (0.4, -3.6, 9.0), 2.3, "orange", 25)
    else:
        b.lathe([(0, 0), (3.4, 0), (3.2, 0.4), (0.7, 0.9), (0.6, 2.6), (1.6, 3.2)], color=GLASS, segments=22)
        filled(b, [(1.4, 3.0), (3.3, 4.6), (3.6, 7.0), (2.8, 11.5), (3.3, 15.5), (3.9, 17.0)], "#2f9ab8", 15.4)
        straw(b, (0, 0, 10), (2.8, 1.4, 23), 0.32, "white")
        b.rod((0, -1, 12), (-1.4, -2.6, 19.6), 0.12, "light wood", sides=5)
        b.lathe(
            [(2.6, -0.2), (1.3, 0.6), (0, 1.0)],
            (-1.35, -2.6, 19),
            "#e05a8a",
            turn_deg=(22, -12, 0),
            segments=10,
            crease_deg=10,
        )
        citrus_wheel(b, (0.6, 3.6, 17.0), 2.0, "#8fbb3a", -15)
    size = ((9.5, 9.5, 17), (9.2, 9.2, 11.5), (9.0, 9.0, 23))[variant % 3]
    return varied_cm(b, f"a {style} cocktail", size, rng, {"style": style})


@recipe("juice", 3, name="drinks.juice")
def juice(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A carton with a straw, a glass with orange on its rim, a bottle of red juice."""
    b = MeshBuilder(roughness=0.5)
    style = ("carton", "glass", "bottle")[variant % 3]
    if style == "carton":
        faces = {f: label("ORANGE\nJUICE", "#f2a12c", "white", (48, 80), band="#3f8a3a") for f in ("+x", "-x")}
        faces |= {f: label("1 L", "#ef9420", "white", (40, 80), band="#3f8a3a") for f in ("+y", "-y")}
        b.box((7, 7.5, 12.6), color="#ef9420", skins=faces)
        roof = [(-3.5, 0), (3.5, 0), (0.35, 2.6), (0.35, 3.6), (-0.35, 3.6), (-0.35, 2.6)]
        b.profile([(x, 12.6 + z) for x, z in roof], 7.5, color="#3f8a3a")
        b.cylinder(1.15, 1.3, (1.9, 0, 13.5), "white", turn_deg=(0, 50, 0), segments=16)
    elif style == "glass":
        filled(b, [(2.9, 0), (3.0, 0.4), (3.6, 13.0)], "#f09a1c", 11.4)
        citrus_wheel(b, (0.6, -3.2, 13.0), 2.6, "#ee8a1c", 20)
        straw(b, (-0.5, 0.5, 5), (0.5, 2.6, 18.5), 0.3, "#d83a34")
    else:
        profile = ((3.2, 0), (3.5, 0.5), (3.5, 11), (3.0, 13.5), (1.9, 15.6), (1.7, 17.4))
        round_bottle(
            b, Bottle(profile, "#b8283a", ("white", 1.95, 1.6), ("CHERRY", "#f6efe0", "#8a1c2c"), (3.5, 10), 190)
        )
    size = ((7.0, 7.5, 17.0), (8.0, 7.6, 16.5), (7.4, 7.4, 20))[variant % 3]
    return varied_cm(b, f"juice: a {style}", size, rng, {"style": style})


@recipe("milkshake", 3, name="drinks.milkshake")
def milkshake(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A fluted glass with whipped cream and a cherry: strawberry, chocolate; a paper cup with a dome, vanilla."""
    b = MeshBuilder(roughness=0.35)
    style = ("strawberry", "chocolate", "vanilla")[variant % 3]
    drink: Color = ("#eeb0b8", "#8a5a3c", "#f0e2b8")[variant % 3]
    if style == "vanilla":
        b.lathe([(0, 0), (3.0, 0), (4.3, 12.6), (0, 12.6)], color="#f4efe6", segments=22)
        patch(b, label("SHAKE", "#c8344a", "white", (64, 32)), (3.6, 4.05), 5, 9.5, 355)
        b.lathe([(4.6, 12.4), (4.6, 13), (4.3, 14.6), (3.0, 16.4), (1.0, 17), (0, 17)], color="#e6ecec", segments=22)
    else:
        b.lathe([(0, 0), (3.4, 0), (3.3, 0.5), (1.0, 1.2), (0.9, 2.2), (1.8, 2.8)], color=GLASS, segments=22)
        filled(b, [(1.6, 2.6), (2.2, 3.2), (2.6, 7), (3.6, 13.4), (4.1, 14.2)], drink, 13.4)
        for radius, z in ((3.6, 14.2), (2.7, 15.6), (1.7, 16.8)):
            for k in range(max(int(radius * 2), 3)):
                a = 2 * np.pi * k / max(int(radius * 2), 3) + z
                b.ball(
                    (0.45 * radius, 0.45 * radius, 0.85),
                    (0.6 * radius * np.cos(a), 0.6 * radius * np.sin(a), z),
                    "#fbf7ee",
                    segments=8,
                    rings=5,
                )
        b.ball(0.95, (0, 0, 18.3), "#b8182c", segments=12, rings=8)
        b.tube([(0, 0, 19), (0.3, 0.2, 19.8), (0.9, 0.4, 20.4)], 0.1, "#5a4a2a", sides=4)
    straw(b, (-1, 1, 10), (-2.2, 2.4, 20.5), 0.4, ("#d83a54", "white", "#3a7ab8")[variant % 3])
    size = ((9.2, 9.2, 20), (9.6, 9.6, 22), (9.0, 9.0, 18.5))[variant % 3]
    return varied_cm(b, f"a {style} milkshake", size, rng, {"style": style})


@recipe("whisky", 3, name="drinks.whisky")
def whisky(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A round bottle, a square one with a black label, a tumbler with ice."""
    b = MeshBuilder(roughness=0.2)
    style = ("bottle", "square bottle", "tumbler")[variant % 3]
    if style == "bottle":
        profile = ((4.0, 0), (4.3, 0.5), (4.3, 15), (3.6, 18), (1.7, 20.2), (1.4, 21), (1.5, 25))
        paper = ("SINGLE\nMALT", "#efe2c0", "#5a2a1c")
        round_bottle(
            b, Bottle(profile, "#d9b98a", ("#5a2a1c", 1.7, 1.6), paper, (4, 12), 150, ("#5a2a1c", 22), ("#b8641c", 18))
        )
    elif style == "square bottle":
        b.extrude(stadium(7.6, 7.6, 1.3), 17, color="#a8561a", crease_deg=50)
        b.loft([shapes_at(3.8, 17), shapes_at(3.4, 18.6), shapes_at(1.6, 20), shapes_at(1.4, 21)], "#c07a34")
        b.cylinder(1.35, 4.4, (0, 0, 21), "#c08a4c", segments=16)
        b.cylinder(1.6, 2.6, (0, 0, 24.6), "black", segments=18)
        for facing in ("+x", "-x"):
            b.panel(
                label("OLD\nNo. 9", "black", "white", (48, 64), band="charcoal"),
                ((3.84, 0, 8) if facing == "+x" else (-3.84, 0, 8)),
                5.6,
                10,
                facing,
            )
    else:
        filled(b, [(3.7, 0), (4.0, 0.8), (4.1, 9.2)], "#c8741c", 4.6)
        for k in range(9):
            with b.frame(turn_deg=(0, 0, 40 * k)):
                b.box((0.4, 1.1, 4.2), (3.9, 0, 0.2), mix(GLASS, "#c8741c", 0.6), bevel=0.15)
        for k in range(2):
            b.box(
                (2.8, 2.8, 2.8),
                (1.2 - 2.4 * k, 0.8 - 1.4 * k, 3.4 + 0.3 * k),
                "#e6eff3",
                turn_deg=(10, 15 * k, 30 * k),
                bevel=0.3,
            )
    size = ((8.6, 8.2, 27), (8.0, 8.0, 28.5), (8.4, 8.4, 9.4))[variant % 3]
    return varied_cm(b, f"whisky: a {style}", size, rng, {"style": style})


def shapes_at(half: float, z: float) -> np.ndarray:
    """(20, 3) a rounded square of half a width at a height."""
    return np.column_stack([np.array(stadium(2 * half, 2 * half, half * 0.36)), np.full(20, z)])


def handle(b: MeshBuilder, at: tuple[float, float], tall: float, out: float, radius: float, color: Color) -> None:
    """A mug's ear in the plane y = 0, at (x, z) of its lower foot, bowed towards +x."""
    x, z = arc(1.0, -90, 90, 9).T
    b.tube(
        [(at[0] + out * px, 0, at[1] + tall * (0.5 + 0.5 * pz)) for px, pz in zip(x, z, strict=True)],
        radius,
        color,
        sides=8,
    )


@recipe("cup", 3, name="drinks.cup")
def cup(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A mug with its ear, a paper cup with lid and sleeve, a tea cup on its saucer."""
    b = MeshBuilder(roughness=0.4)
    style = ("mug", "paper cup", "tea cup")[variant % 3]
    if style == "mug":
        color: Color = "#2f6f8f"
        b.lathe([(0, 0), (3.9, 0), (4.1, 0.3), (4.1, 9.2), (3.7, 9.2), (3.6, 1.0), (0, 1.0)], color=color, segments=24)
        b.lathe([(0, 7.6), (3.68, 7.6), (3.68, 7.7), (0, 7.7)], color="#3a2416", segments=24)
        handle(b, (3.9, 1.6), 6.2, 2.9, 0.55, color)
    elif style == "paper cup":
        b.lathe([(0, 0), (2.9, 0), (4.1, 13), (0, 13)], color="#f2eee4", segments=24)
        patch(b, label("COFFEE", "#8a5c36", "#f6ecd8", (64, 40)), (3.35, 3.85), 4, 9.2, 355)
        b.lathe(
            [(4.3, 12.8), (4.4, 13.2), (4.2, 13.6), (3.8, 14.4), (3.5, 14.4), (3.4, 14.0), (0, 14.0)],
            color="#2a2420",
            segments=24,
        )
    else:
        b.lathe([(0, 0), (3.0, 0), (6.6, 1.2), (7.0, 1.7), (3.4, 0.9), (0, 0.8)], color="#f1ede4", segments=28)
        b.lathe(
            [(0, 0.9), (2.0, 0.9), (2.2, 1.3), (4.0, 3.6), (4.6, 6.6), (4.3, 6.6), (3.7, 3.8), (1.6, 1.9), (0, 1.8)],
            color="#f1ede4",
            segments=24,
        )
        b.ring(4.5, 0.12, (0, 0, 6.6), "gold", segments=24, sides=4)
        b.ring(6.9, 0.12, (0, 0, 1.7), "gold", segments=28, sides=4)
        b.cylinder(4.0, 0.1, (0, 0, 5.6), "#a85a24", segments=24)
        handle(b, (4.0, 3.0), 3.0, 2.2, 0.32, "gold")
    size = ((10.8, 8.3, 9.2), (8.8, 8.8, 14.5), (13.5, 10.8, 7.2))[variant % 3]
    return varied_cm(b, f"a {style}", size, rng, {"style": style})
