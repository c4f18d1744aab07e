"""Loose objects of rooms: mirrors, coat racks, hangers, safes, trays, games, sleeping bags."""

import numpy as np

from ....meshes import paint
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import rgb, shade
from ....meshes.recipe import recipe
from ...shared.facade_images import sign
from ...shared.forms import soft
from ...shared.outlines import arc, pairs
from ...shared.sizes import made


@recipe("mirror", 3, name="room_things.mirror")
def mirror(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A gilt frame with a crest, a round one in black steel, a tall cheval glass on its stand; the glass at +x."""
    b = MeshBuilder(roughness=0.25)
    image, draw = paint.canvas((96, 128), "mirror")
    for k in range(32):
        draw.rectangle(
            (0, 4 * k, 96, 4 * k + 3),
            fill=tuple(int(a + (c - a) * k / 31) for a, c in zip((206, 220, 228), (140, 156, 166), strict=True)),
        )
    for x in (10, 46):
        draw.polygon([(x, 128), (x + 16, 128), (x + 46, 0), (x + 30, 0)], fill=(224, 234, 240))
    if variant % 3 == 1:
        t = np.arange(32) * np.pi / 16
        b.plate([(0.36 * float(np.cos(a)), 0.36 * float(np.sin(a))) for a in t], 0.02, (0, 0, 0.4), image, "black")
        b.ring(0.38, 0.018, (0, 0, 0.4), "black", (0, 90, 0), 36, 8)
        b.tube([(0, -0.12, 0.75), (0, 0, 0.9), (0, 0.12, 0.75)], 0.008, "brown", sides=6)
        return made(b, "a round mirror", (0.05, 0.8, 0.9), shape="round")
    w, h = ((0.56, 0.9), (0.5, 1.45))[variant // 2]
    frame = ("gold", "dark wood")[variant // 2]
    lift = 0.0 if variant % 3 == 0 else 0.18
    with b.frame((0, 0, lift), (0, 0 if variant % 3 == 0 else -5, 0)):
        b.box((0.012, w, h), (0, 0, 0.04), "charcoal", skins={"+x": image})
        for s in (-1, 1):
            b.box((0.04, 0.05, h + 0.08), (0, s * w / 2, 0), frame, bevel=0.014)
            b.box((0.04, w + 0.05, 0.05), (0, 0, 0 if s < 0 else h + 0.04), frame, bevel=0.014)
        if variant % 3 == 0:
            crest = [(-0.16, 0), (0.16, 0), (0.11, 0.05), (0.05, 0.055), (0.0, 0.11), (-0.05, 0.055), (-0.11, 0.05)]
            b.extrude(crest, 0.03, (-0.015, 0, h + 0.08), frame, turn_deg=(90, 0, 90))
            for s in (-1, 1):
                for z in (0.02, h + 0.06):
                    b.ball(0.035, (0.012, s * w / 2, z), frame, segments=10, rings=6)
    if variant % 3 == 0:
        return made(b, "a gilt mirror", (0.045, 0.65, 1.05), shape="rectangular")
    for s in (-1, 1):
        b.cylinder(0.02, 1.35, (-0.04, s * (w / 2 + 0.06), 0), frame, segments=12)
        b.ball(0.032, (-0.04, s * (w / 2 + 0.06), 1.36), frame, segments=10, rings=6)
        b.rod((-0.04, s * (w / 2 + 0.06), 0.95), (-0.04, s * w / 2, 0.95), 0.014, "brass")
        b.tube(
            [
                (0.16, s * (w / 2 + 0.06), 0.0),
                (0.05, s * (w / 2 + 0.06), 0.07),
                (-0.13, s * (w / 2 + 0.06), 0.07),
                (-0.24, s * (w / 2 + 0.06), 0.0),
            ],
            0.02,
            frame,
        )
    b.rod((-0.04, -w / 2 - 0.06, 0.12), (-0.04, w / 2 + 0.06, 0.12), 0.016, frame)
    return made(b, "a cheval glass", (0.38, 0.68, 1.7), shape="standing")


@recipe("coatrack", 3, name="room_things.coatrack")
def coatrack(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A bentwood stand with curled hooks, a steel tree with a hat and a coat, a wall rail with a shelf."""
    b = MeshBuilder(roughness=0.6)
    if variant % 3 == 2:
        b.box((0.02, 0.9, 0.14), (-0.1, 0, 0.1), "light wood", bevel=0.006)
        b.box((0.24, 0.9, 0.02), (0, 0, 0.28), "light wood", bevel=0.006)
        for k in range(5):
            y = -0.36 + 0.18 * k
            b.tube([(-0.09, y, 0.19), (-0.02, y, 0.2), (0.0, y, 0.24)], 0.008, "charcoal")
            b.tube([(-0.09, y, 0.14), (-0.03, y, 0.1), (0.0, y, 0.14)], 0.008, "charcoal")
        for s in (-1, 1):
            b.beam((-0.1, s * 0.4, 0.14), (0.08, s * 0.4, 0.27), 0.02, 0.02, "charcoal")
        b.lathe(
            [(0.13, 0), (0.13, 0.008), (0.07, 0.012), (0.065, 0.09), (0.05, 0.1)], (0, 0.2, 0.3), "brown", segments=18
        )
        return made(b, "a wall rail with hooks", (0.24, 0.9, 0.4), style="rail")
    color = ("dark wood", "charcoal")[variant % 3]
    b.lathe([(0.028, 0.1), (0.022, 0.9), (0.018, 1.6)], color=color, segments=12)
    b.ball(0.035, (0, 0, 1.63), color, segments=12)
    for k in range(4):
        with b.frame(turn_deg=(0, 0, 90 * k + 20)):
            b.tube([(0.0, 0, 0.42), (0.1, 0, 0.26), (0.19, 0, 0.08), (0.23, 0, 0.0)], 0.018, color)
            if variant % 3 == 0:
                b.tube([(0.0, 0, 1.35), (0.13, 0, 1.46), (0.2, 0, 1.6), (0.17, 0, 1.7), (0.12, 0, 1.66)], 0.013, color)
                b.tube([(0.0, 0, 1.25), (0.1, 0, 1.26), (0.16, 0, 1.33), (0.14, 0, 1.38)], 0.012, color)
            else:
                b.tube([(0.0, 0, 1.5 - 0.08 * k), (0.14, 0, 1.6 - 0.08 * k)], 0.012, color)
                b.ball(0.02, (0.14, 0, 1.6 - 0.08 * k), color, segments=8, rings=6)
    b.ring(0.13, 0.012, (0, 0, 0.3), color, segments=20, sides=6)
    if variant % 3 == 1:
        with b.frame((0.13, 0.05, 0)):
            soft(b, (0.16, 0.36, 0.85), (0, 0, 0.6), "dark blue", plan=3, side=5)
            for s in (-1, 1):
                b.tube(
                    [(0, s * 0.16, 1.38), (0, s * 0.22, 1.15), (0, s * 0.22, 0.85)], [0.05, 0.055, 0.05], "dark blue"
                )
        b.lathe(
            [(0.15, 0), (0.15, 0.01), (0.085, 0.015), (0.08, 0.1), (0.06, 0.11)], (0, 0, 1.64), "brown", segments=18
        )
    return made(b, "a coat stand", ((0.46, 0.43, 1.72), (0.5, 0.5, 1.8))[variant % 3], style="stand")


@recipe("hanger", 2, name="room_things.hanger")
def hanger(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A shaped wooden hanger with a trouser bar, a wire one; the shoulders along y."""
    b = MeshBuilder(roughness=0.5)
    hook = [(0, y, 0.155 + z) for y, z in [(0.0, -0.03), (0.0, 0.0), *pairs(arc(0.024, -60, 200, 12, (0.0, 0.032)))]]
    b.tube(hook, 0.0025, "aluminium", sides=6)
    if variant % 2 == 0:
        for s in (-1, 1):
            path = [(0, 0, 0.12), (0, s * 0.07, 0.105), (0, s * 0.14, 0.075), (0, s * 0.21, 0.03)]
            b.tube(path, [0.0075, 0.0085, 0.009, 0.008], "wood", sides=10)
            b.rod((0, s * 0.17, 0.056), (0, s * 0.17, 0.012), 0.004, "wood", sides=6)
        b.rod((0, -0.18, 0.014), (0, 0.18, 0.014), 0.005, "light wood", sides=8)
        return made(b, "a wooden hanger", (0.0155, 0.42, 0.22), material="wood")
    b.tube(
        [(0, 0, 0.125), (0, 0.2, 0.02), (0, 0.19, 0.005), (0, -0.19, 0.005), (0, -0.2, 0.02)],
        0.0035,
        "signal blue",
        sides=8,
        closed=True,
    )
    for k in range(5):
        b.cylinder(0.006, 0.008, (0, 0, 0.118 + 0.006 * k), "aluminium", segments=8)
    return made(b, "a wire hanger", (0.012, 0.4, 0.2), material="wire")


@recipe("safe box", 2, name="room_things.safe_box")
def safe_box(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A heavy safe with dial and spoked wheel, a small hotel safe with keypad; the door at +x."""
    b = MeshBuilder(roughness=0.4, metallic=0.2)
    color, (d, w, h) = (("dark green", (0.38, 0.36, 0.44)), ("charcoal", (0.26, 0.34, 0.24)))[variant % 2]
    b.box((d, w, h), (0, 0, 0.02), color, bevel=0.012)
    for sx in (-1, 1):
        for sy in (-1, 1):
            b.cylinder(0.025, 0.02, (sx * (d / 2 - 0.05), sy * (w / 2 - 0.05), 0), "black", segments=12)
    b.box((0.025, w - 0.05, h - 0.05), (d / 2, 0, 0.045), shade(color, 1.25), bevel=0.008)
    for z in (0.1, h - 0.09):
        b.cylinder(0.014, 0.06, (d / 2 + 0.01, w / 2 - 0.02, z), "aluminium", segments=12)
    x = d / 2 + 0.012
    if variant % 2 == 0:
        b.cylinder(0.045, 0.02, (x, -0.06, h * 0.62), "aluminium", turn_deg=(0, 90, 0), segments=24)
        b.cylinder(0.022, 0.02, (x + 0.02, -0.06, h * 0.62), "black", turn_deg=(0, 90, 0), segments=18)
        b.cylinder(0.014, 0.05, (x, 0.06, h * 0.45), "brass", turn_deg=(0, 90, 0), segments=12)
        for k in range(3):
            a = np.radians(90 + 120 * k)
            b.rod(
                (x + 0.04, 0.06, h * 0.45),
                (x + 0.04, 0.06 + 0.075 * np.cos(a), h * 0.45 + 0.075 * np.sin(a)),
                0.007,
                "brass",
            )
            b.ball(
                0.014, (x + 0.04, 0.06 + 0.075 * np.cos(a), h * 0.45 + 0.075 * np.sin(a)), "brass", segments=8, rings=6
            )
        b.panel(sign("SECURE", shade(color, 1.25), "gold", (64, 16)), (x + 0.002, 0, h * 0.85), 0.18, 0.045)
        return made(b, "a safe with a dial", (0.42, 0.38, 0.46), style="dial")
    b.box((0.012, 0.12, 0.12), (x, -0.06, 0.09), "black", bevel=0.004)
    for k in range(12):
        b.box((0.006, 0.022, 0.016), (x + 0.008, -0.09 + 0.03 * (k % 3), 0.1 + 0.02 * (k // 3)), "light grey")
    b.box((0.006, 0.085, 0.016), (x + 0.008, -0.06, 0.185), "light green")
    b.cylinder(0.024, 0.025, (x, 0.08, 0.14), "aluminium", turn_deg=(0, 90, 0), segments=18)
    b.box((0.01, 0.008, 0.044), (x + 0.028, 0.08, 0.118), "charcoal")
    return made(b, "a hotel safe", (0.32, 0.36, 0.26), style="keypad")


@recipe("serving tray", 2, name="room_things.serving_tray")
def serving_tray(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A wooden tray with two cut handles, a round steel one with a rim."""
    b = MeshBuilder(roughness=0.4)
    if variant % 2 == 1:
        b.lathe(
            [
                (0.14, 0),
                (0.15, 0.002),
                (0.17, 0.022),
                (0.178, 0.024),
                (0.178, 0.026),
                (0.165, 0.024),
                (0.148, 0.006),
                (0, 0.006),
            ],
            color="aluminium",
            segments=36,
        )
        b.ring(0.11, 0.0015, (0, 0, 0.006), "light grey", segments=28, sides=4)
        return made(b, "a round steel tray", (0.36, 0.36, 0.026), shape="round")
    b.box((0.42, 0.31, 0.008), color="wood", bevel=0.002)
    for s in (-1, 1):
        b.box((0.42, 0.012, 0.028), (0, s * 0.149, 0.003), "dark wood", bevel=0.004)
        outline = [
            (-0.149, 0),
            (0.149, 0),
            (0.149, 0.02),
            *pairs(arc(0.09, 10, 170, 9, (0, 0.02), 0.2)),
            (-0.149, 0.02),
        ]
        hole = [(0.05 * x, 0.018 + 0.008 * y) for x, y in arc(1.0, 0, 345, 16)]
        b.extrude(outline, 0.012, (s * 0.204 - 0.006, 0, 0), "dark wood", turn_deg=(90, 0, 90), holes=[hole])
    for k in range(3):
        b.box((0.39, 0.002, 0.001), (0, -0.075 + 0.075 * k, 0.008), "dark wood")
    return made(b, "a wooden tray", (0.42, 0.31, 0.033), shape="rectangular")


@recipe("chessboard", 2, name="room_things.chessboard")
def chessboard(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A board with pieces in play: wood, marble."""
    b = MeshBuilder(roughness=0.4)
    dark, light, white, black = (
        ("dark wood", "cream", "light wood", "#3a241a"),
        ("#4c6a58", "marble", "marble", "charcoal"),
    )[variant % 2]
    image, draw = paint.canvas((128, 128), dark)
    for k in range(64):
        if (k % 8 + k // 8) % 2:
            draw.rectangle((16 * (k % 8), 16 * (k // 8), 16 * (k % 8) + 15, 16 * (k // 8) + 15), fill=rgb(light))
    b.box((0.4, 0.4, 0.02), color=shade(dark, 0.8), bevel=0.005)
    b.panel(image, (0, 0, 0.021), 0.36, 0.36, "+z")
    step = 0.045
    pieces = [
        (0, c, tall) for c, tall in enumerate((0.05, 0.055, 0.06, 0.07, 0.065, 0.06, 0.055, 0.05)) if c not in (1, 5)
    ]
    pieces += [(1, c, 0.04) for c in range(8) if c not in (3, 4)] + [(3, 3, 0.04), (2, 5, 0.055)]
    for color, side in ((white, -1), (black, 1)):
        for r, c, tall in pieces:
            x, y = side * (3.5 - r) * step, side * (c - 3.5) * step
            r0 = 0.012 + 0.03 * (tall - 0.04)
            b.lathe(
                [
                    (r0 * 1.15, 0),
                    (r0, 0.006),
                    (r0 * 0.5, tall * 0.35),
                    (r0 * 0.45, tall * 0.6),
                    (r0 * 0.85, tall * 0.68),
                    (r0 * 0.6, tall * 0.92),
                    (0, tall),
                ],
                (x, y, 0.021),
                color,
                segments=6,
            )
            if tall > 0.065:
                b.box((0.003, 0.012, 0.004), (x, y, 0.021 + tall + 0.004), color)
    return made(b, "a chessboard with its pieces", ((0.4, 0.4, 0.09), (0.5, 0.5, 0.11))[variant % 2])


@recipe("sleeping bag", 2, name="room_things.sleeping_bag")
def sleeping_bag(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A rolled bag held by two straps, one in its stuff sack with a drawstring; lying along x."""
    b = MeshBuilder(roughness=0.9)
    if variant % 2 == 0:
        b.lathe(
            [
                (0.08, -0.2),
                (0.105, -0.19),
                (0.112, -0.12),
                (0.1, -0.1),
                (0.112, -0.06),
                (0.115, 0.05),
                (0.1, 0.1),
                (0.112, 0.13),
                (0.105, 0.19),
                (0.08, 0.2),
            ],
            (0, 0, 0.11),
            "signal blue",
            turn_deg=(0, 90, 0),
            segments=22,
        )
        for x in (-0.1, 0.1):
            b.ring(0.104, 0.008, (x, 0, 0.11), "black", (0, 90, 0), 22, 4)
            b.box((0.03, 0.03, 0.015), (x, 0, 0.208), "black", bevel=0.004)
        t = np.linspace(0, 6 * np.pi, 40)
        for s in (-0.201, 0.201):
            b.tube(
                [(s, (0.01 + 0.0042 * a) * np.cos(a), 0.11 + (0.01 + 0.0042 * a) * np.sin(a)) for a in t],
                0.004,
                "orange",
                4,
            )
        return made(b, "a rolled sleeping bag", (0.4, 0.23, 0.22), style="rolled")
    b.lathe(
        [
            (0.0, -0.18),
            (0.1, -0.17),
            (0.115, -0.1),
            (0.12, 0.0),
            (0.112, 0.11),
            (0.08, 0.16),
            (0.03, 0.175),
            (0.045, 0.2),
        ],
        (0, 0, 0.12),
        "safety orange",
        turn_deg=(0, 90, 0),
        segments=20,
        crease_deg=50,
    )
    b.ring(0.032, 0.006, (0.175, 0, 0.12), "charcoal", (0, 90, 0), 14, 5)
    for k in range(4):
        a = 2 * np.pi * k / 4 + 0.6
        b.beam(
            (-0.17, 0.1 * np.cos(a), 0.12 + 0.1 * np.sin(a)),
            (0.13, 0.115 * np.cos(a), 0.12 + 0.115 * np.sin(a)),
            0.02,
            0.008,
            "charcoal",
        )
    b.tube([(0.17, 0.03, 0.12), (0.22, 0.05, 0.08), (0.21, 0.08, 0.01)], 0.004, "black", sides=5)
    return made(b, "a sleeping bag in its sack", (0.38, 0.24, 0.24), style="sack")


@recipe("billiard table", 2, name="room_things.billiard_table")
def billiard_table(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A slate table with green or blue cloth, six pockets, balls in play and a cue; long side along y."""
    b = MeshBuilder(roughness=0.6)
    cloth, wood = (("green", "dark wood"), ("signal blue", "charcoal"))[variant % 2]
    hx, hy, top = 0.62, 1.2, 0.8
    b.box((2 * hx, 2 * hy, 0.05), (0, 0, top - 0.09), cloth)
    for s in (-1, 1):
        b.box((0.11, 2 * hy + 0.2, 0.09), (s * (hx + 0.045), 0, top - 0.08), wood, bevel=0.012)
        b.box((2 * hx, 0.11, 0.09), (0, s * (hy + 0.045), top - 0.08), wood, bevel=0.012)
        b.box((0.04, 2 * hy - 0.1, 0.035), (s * (hx - 0.02), 0, top - 0.045), shade(cloth, 0.85))
        b.box((2 * hx - 0.1, 0.04, 0.035), (0, s * (hy - 0.02), top - 0.045), shade(cloth, 0.85))
        b.box((0.05, 2 * hy, 0.16), (s * (hx - 0.02), 0, top - 0.24), wood)
        b.box((2 * hx, 0.05, 0.16), (0, s * (hy - 0.02), top - 0.24), wood)
        for y in (-hy, 0.0, hy):
            b.cylinder(0.055, 0.012, (s * (hx - 0.005), y * 0.995, top), "black", segments=14)
        for y in (-1, 1):
            b.box((0.16, 0.16, top - 0.08), (s * (hx - 0.12), y * (hy - 0.16), 0), wood, taper=(1.35, 1.35))
    inks = (
        "signal yellow",
        "signal red",
        "signal blue",
        "purple",
        "orange",
        "dark green",
        "dark red",
        "black",
        "white",
        "pink",
    )
    for k in range(10):
        x, y = (
            (0.05 * (k % 4 - 1.5), 0.55 + 0.055 * (k // 4))
            if k < 7
            else (float(rng.uniform(-0.4, 0.4)), float(rng.uniform(-0.8, 0.2)))
        )
        b.ball(0.029, (x, y, top - 0.012), inks[k], segments=8, rings=6)
    b.tube([(0.2, -1.15, top + 0.02), (-0.05, -0.1, top)], [0.014, 0.006], "light wood", sides=8)
    return made(b, "a billiard table", ((1.45, 2.6, 0.82), (1.3, 2.35, 0.8))[variant % 2], cloth=cloth)
