"""Cookware: chopping boards, pans, woks, teapots, spice racks. Handles and spouts to the front (+x)."""

import numpy as np

from ....meshes import shapes
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, shade
from ....meshes.recipe import recipe
from ...shared.forms import painted, pillow, softened, stadium, vessel
from ...shared.outlines import arc
from ...shared.sizes import varied_cm
from ...shared.skins import skin
from ..food.drinks import handle
from .tableware import STEEL


@recipe("chopping board", 3, name="cookware.chopping_board")
def chopping_board(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Beech strips with a groove, a round-cornered paddle with a hole, white plastic."""
    b = MeshBuilder(roughness=0.7)
    style = ("strips", "paddle", "plastic")[variant % 3]
    if style == "strips":
        for k in range(8):
            b.box((36, 3.0, 1.9), (0, -10.5 + 3.0 * k, 0), shade("light wood", 0.9 + 0.05 * ((k * 5) % 4)), bevel=0.12)
        groove = [(x, y, 1.9) for x, y in stadium(33, 21, 1.6, 4)]
        b.tube(groove, 0.2, shade("wood", 0.7), sides=4, closed=True)
    else:
        outline = stadium(34, 22, 4 if style == "paddle" else 1.5, 6)
        if style == "paddle":
            outline = [
                (-14, -10),
                (-12, -11),
                (12, -11),
                (14, -10),
                (15, -8),
                (15.4, -3.4),
                (17, -2.4),
                (25, -2.0),
                (26.2, -1),
                (26.2, 1),
                (25, 2.0),
                (17, 2.4),
                (15.4, 3.4),
                (15, 8),
                (14, 10),
                (12, 11),
                (-12, 11),
                (-14, 10),
                (-15, 8),
                (-15, -8),
            ]
            hole = (arc(0.9, 0, 330, 12) + [23.6, 0]).tolist()
            b.extrude(outline, 1.8, color="wood", holes=[[(x, y) for x, y in hole]])
            for y in (-7, -3.2, 1.5, 6):
                b.box((27, 0.25, 0.06), (-0.6, y, 1.8), shade("wood", 0.78))
        else:
            b.extrude(outline, 1.2, color="#eceae4", holes=[[(x * 1.0 + 13.5, y) for x, y in stadium(3, 9, 1.4, 4)]])
            b.tube([(x, y, 1.2) for x, y in stadium(30 - 1, 19, 1.5, 4)], 0.16, "#8fb0c8", sides=4, closed=True)
    size = ((36, 24, 1.95), (46, 22, 2.2), (32, 21, 1.3))[variant % 3]
    return varied_cm(b, f"a chopping board: {style}", size, rng, {"style": style})


@recipe("frying pan", 3, name="cookware.frying_pan")
def frying_pan(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Black non-stick, cast iron with its short handle and lips, steel with a fried egg in it."""
    b = MeshBuilder(roughness=0.4)
    style = ("non-stick", "cast iron", "steel with an egg")[variant % 3]
    body: Color = ("#2b2d30", "#33302e", STEEL)[variant % 3]
    b.lathe(
        vessel([(10, 0), (10.6, 0.2), (12.6, 2.6), (13.4, 4.4)], 0.35 if style != "cast iron" else 0.6, 0.45),
        color=body,
        segments=32,
    )
    b.cylinder(10.2, 0.08, (0, 0, 0.47), "#404347" if style != "steel with an egg" else "#9aa0a4", segments=28)
    if style == "cast iron":
        b.loft(
            [
                np.array([(x, y, z) for y, z in ((-w, 3.2), (w, 3.2), (w, 4.4), (-w, 4.4))])
                for x, w in ((12.6, 1.8), (16, 1.1), (22, 1.3), (25, 1.6))
            ],
            body,
            crease_deg=40,
        )
        b.tube([(-12.8, -2.4, 3.9), (-15.4, -1.6, 4.0), (-15.4, 1.6, 4.0), (-12.8, 2.4, 3.9)], 0.6, body, sides=7)
        for y in (-13.0, 13.0):
            b.ball((2.0, 1.0, 0.7), (0, y, 4.2), body, segments=10, rings=5)
    else:
        b.tube([(12.6, 0, 3.4), (15.5, 0, 4.6), (18, 0, 5.6)], [0.8, 0.7, 0.8], STEEL, sides=8)
        b.tube(
            [(17.4, 0, 5.4), (22, 0, 6.6), (30, 0, 7.4), (33, 0, 7.2)],
            [1.0, 1.25, 1.3, 0.9],
            "#222427" if variant % 3 == 0 else STEEL,
            sides=10,
        )
    if style == "steel with an egg":
        white = pillow((11, 9.4, 0.7), 0.8, 0.5, 22, 4)
        b.add(white, "#fbf8ee", (0.8, 0.4, 0.5))
        b.ball((2.2, 2.2, 1.2), (1.2, 0.6, 1.1), "#f2ac1c", segments=16, rings=8)
    size = ((46, 27.5, 7.5), (43, 28, 5.6), (50, 30, 8.4))[variant % 3]
    return varied_cm(b, f"a frying pan: {style}", size, rng, {"style": style})


@recipe("wok", 2, name="cookware.wok")
def wok(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Carbon steel with a long wooden handle, an iron one with two ears and vegetables in it."""
    b = MeshBuilder(roughness=0.5)
    style = ("long-handled", "two-eared")[variant % 2]
    body = "#3b3c3f" if variant % 2 == 0 else "#2a2a2c"
    outside = softened([(4, 0), (8, 0.9), (12, 3.6), (15, 7.4), (17, 11)], 9)
    b.lathe(vessel(outside, 0.3, 0.4), color=body, segments=32, crease_deg=70)
    b.ring(16.9, 0.3, (0, 0, 11), shade(body, 0.8), segments=32, sides=5)
    ears = (180.0,) if style == "long-handled" else (0.0, 180.0)
    for yaw in ears:
        with b.frame(turn_deg=(0, 0, yaw)):
            b.tube(
                [(16.2, -3.4, 10), (18.6, -2.6, 11.6), (19.2, 0, 12), (18.6, 2.6, 11.6), (16.2, 3.4, 10)],
                0.6,
                body,
                sides=7,
            )
    if style == "long-handled":
        b.tube([(16, 0, 9.6), (20, 0, 12), (22, 0, 13)], [0.9, 0.8, 1.0], STEEL, sides=8)
        b.tube([(21.4, 0, 12.8), (26, 0, 14.4), (34, 0, 15.6), (36, 0, 15.6)], [1.2, 1.5, 1.6, 1.1], "wood", sides=10)
    else:
        b.lathe([(12.4, 4.6), (8, 6.6), (0, 7.4)], color="#d9b45a", segments=22, crease_deg=70)
        for k in range(26):
            r, a = 11 * np.sqrt((k + 0.5) / 26), 2.4 * k
            at = (r * np.cos(a), r * np.sin(a), 7.6 - 2.2 * (r / 11) ** 2)
            b.box(
                (2.6, 0.9, 0.6),
                at,
                ("#c8321f", "#5f9a3a", "#e8902c", "#f0e2c0")[k % 4],
                turn_deg=(14 * k, 20 * (-1) ** k, 55 * k),
                bevel=0.2,
            )
    size = ((52, 34, 14), (42, 36, 12.5))[variant % 2]
    return varied_cm(b, f"a {style} wok", size, rng, {"style": style})


@recipe("teapot", 3, name="cookware.teapot")
def teapot(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Round porcelain, black cast iron with a bail handle, tall brown glazed; spout to the front."""
    b = MeshBuilder(roughness=0.4)
    style = ("porcelain", "cast iron", "brown glazed")[variant % 3]
    color: Color = ("#eef0f0", "#2b2c30", "#7a4426")[variant % 3]
    tall = (1.0, 0.78, 1.25)[variant % 3]
    profile = [(0, 0), (4.0, 0), (4.2, 0.5), (6.2, 2.6), (6.9, 5.2), (6.2, 8.0), (4.0, 9.9), (3.4, 10.2), (0, 10.2)]
    image = skin(rng, [color, color], noise=0.5, size=(64, 32))
    if style == "porcelain":
        for row, column in ((12, 8), (16, 22), (11, 38), (17, 50)):
            image[row - 2 : row + 3, column - 1 : column + 2] = image[row - 1 : row + 2, column - 2 : column + 3] = (
                56,
                96,
                168,
            )
    with b.frame(scale=(1, 1, tall)):
        b.add(painted(shapes.lathe(softened(profile, 14), 26)), image=image, crease_deg=60)
        for k in range(40 if style == "cast iron" else 0):
            a, z = 2.4 * k, 3.2 + 4.0 * (k % 5) / 5
            b.ball(0.4, (6.75 * np.cos(a), 6.75 * np.sin(a), z + 0.2), shade(color, 1.3), segments=5, rings=3)
        b.lathe(
            [(3.6, 10.0), (3.5, 10.5), (2.0, 11.3), (0.5, 11.6), (0.5, 11.9), (0.95, 12.4), (0.7, 13.0), (0, 13.2)],
            color=color,
            segments=22,
        )
        b.tube(
            [(5.6, 0, 3.6), (8.6, 0, 4.8), (9.8, 0, 7.2), (10.6, 0, 9.2), (11.8, 0, 10.2)],
            [1.9, 1.35, 1.0, 0.8, 0.75],
            color,
            sides=12,
        )
    if style == "cast iron":
        x, z = arc(1.0, 0, 180, 13).T
        b.tube([(5.6 * px, 0, 8.0 + 9.5 * pz) for px, pz in zip(x, z, strict=True)], 0.5, "#3a3b40", sides=8)
    else:
        with b.frame((-5.6, 0, 2.0 * tall), (0, 0, 180)):
            handle(b, (0, 0.4), 6.6 * tall, 4.6, 0.75, color)
    size = ((22.5, 13.5, 15), (19.5, 14.5, 18), (24, 13, 19))[variant % 3]
    return varied_cm(b, f"a {style} teapot", size, rng, {"style": style})


@recipe("spice rack", 3, name="cookware.spice_rack")
def spice_rack(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A wooden shelf of three tiers, a wire rack of two, a stepped stand; jars with labels and powder."""
    b = MeshBuilder(roughness=0.6)
    style = ("wooden", "wire", "stepped")[variant % 3]
    tiers, per, step = ((3, 6, 0.0), (2, 5, 0.0), (3, 5, 5.0))[variant % 3]
    wide, high = per * 5.2 + 2.0, 9.8
    frame: Color = ("wood", "charcoal", "dark wood")[variant % 3]
    powders = ("#b8321e", "#d8a02c", "#6f7a34", "#8a4a24", "#3a2c24", "#c9b48a")
    for t in range(tiers):
        x, z = -step * t, t * (high if step == 0 else 4.6)
        if style == "wire":
            for dx in (-3.4, 0, 3.4):
                b.rod((dx, -wide / 2, z + 0.4), (dx, wide / 2, z + 0.4), 0.22, frame, sides=5)
            b.rod((3.4, -wide / 2, z + 3), (3.4, wide / 2, z + 3), 0.22, frame, sides=5)
        elif step == 0:
            b.box((8, wide, 0.9), (0, 0, z), frame)
            b.box((0.7, wide, 1.6), (3.7, 0, z + 1.6), frame)
        else:
            b.box((step + 0.6, wide, z + 0.9), (x, 0, 0), shade(frame, 1.0 + 0.15 * t))
        for k in range(per):
            y, c = -wide / 2 + 1.0 + 5.2 * (k + 0.5), powders[(k + 2 * t) % 6]
            b.lathe([(0, 0.9), (2.0, 0.9), (2.05, 5.2), (1.5, 6.0), (0, 6.0)], (x, y, z), c, segments=10)
            b.cylinder(1.7, 1.1, (x, y, z + 6.0), ("black", STEEL, "gold")[variant % 3], segments=10)
            b.box((0.1, 2.2, 1.7), (x + 1.98, y, z + 2.6), "#f2ecdc")
    if style == "wooden":
        for y in (-wide / 2, wide / 2):
            b.box((8, 0.9, tiers * high), (0, y, 0), frame)
        b.box((8, wide, 0.9), (0, 0, tiers * high - 0.9), frame)
    elif style == "wire":
        for y in (-wide / 2, wide / 2):
            b.tube([(3.4, y, 0), (3.4, y, 13), (0, y, 22), (-3.4, y, 13), (-3.4, y, 0)], 0.35, frame, sides=6)
    size = ((13, 34, 30), (12, 28, 25), (16, 30, 17.5))[variant % 3]
    return varied_cm(b, f"a {style} spice rack", size, rng, {"style": style})
