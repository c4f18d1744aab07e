"""Appliances with screens: arcade cabinets, televisions, computers, telephones. The screen looks along +x."""

import numpy as np

from ....meshes import paint
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, shade
from ....meshes.recipe import recipe
from ....meshes.shapes import Point2
from ...shared.outlines import desk_panel, rounded
from ...shared.sizes import varied
from .screen_images import desktop, icons, landscape, race_game, space_game

_UPRIGHT: list[Point2] = [
    (-0.4, 0.0),
    (0.28, 0.0),
    (0.28, 0.78),
    (0.42, 0.88),
    (0.42, 0.94),
    (0.16, 1.02),
    (0.02, 1.42),
    (0.22, 1.5),
    (0.24, 1.75),
    (-0.34, 1.75),
    (-0.4, 1.65),
]
_SWEEPING: list[Point2] = [
    (-0.38, 0.0),
    (0.34, 0.0),
    (0.26, 0.6),
    (0.4, 0.82),
    (0.4, 0.9),
    (0.12, 1.0),
    (0.0, 1.36),
    (0.26, 1.62),
    (0.2, 1.85),
    (-0.2, 1.85),
    (-0.38, 1.5),
]


@recipe("arcade game cabinet", 3, hulls=1, name="screens.arcade_game_cabinet")
def arcade_game_cabinet(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Space game with two sticks, racing game with a wheel, white one with a big screen."""
    b = MeshBuilder(roughness=0.45)
    style = ("space game", "racing game", "puzzle game")[variant]
    outline = (_UPRIGHT, _SWEEPING, _UPRIGHT)[variant]
    side, core = (("dark blue", "black"), ("signal red", "charcoal"), ("white", "pink"))[variant]
    for s in (-1, 1):
        b.profile(outline, 0.03, (0, 0.32 * s, 0), side)
    b.profile([(x - 0.015 * np.sign(x), z * 0.99 + 0.004) for x, z in outline], 0.61, color=core)
    foot, head, screen_low, screen_top = (outline[k] for k in (2, 7, 5, 6))
    lean = float(np.degrees(np.arctan2(screen_low[0] - screen_top[0], screen_top[1] - screen_low[1])))
    middle = ((screen_low[0] + screen_top[0]) / 2, 0.0, (screen_low[1] + screen_top[1]) / 2)
    image = (space_game((96, 84), rng), race_game((96, 84)), space_game((96, 84), rng))[variant]
    with b.frame(middle, (0, -lean, 0)):
        b.panel(image, (0.004, 0, 0), 0.54, 0.37)
    words, ground, ink = (
        ("STAR RUSH", "purple", "signal yellow"),
        ("TURBO CUP", "signal yellow", "signal red"),
        ("BLOCK FEVER", "light blue", "dark blue"),
    )[variant]
    marquee, pen = paint.canvas((112, 36), ground)
    paint.text(pen, words, (5, 4, 107, 32), ink, 0.06)
    high = outline[8]
    tilt = float(np.degrees(np.arctan2(head[0] - high[0], high[1] - head[1])))
    with b.frame(((head[0] + high[0]) / 2, 0, (head[1] + high[1]) / 2), (0, -tilt, 0)):
        b.panel(marquee, (0.004, 0, 0), 0.6, 0.21)
    _controls(b, (outline[3], outline[4], outline[5]), style)
    b.box((0.012, 0.24, 0.3), (foot[0] - 0.012, 0, 0.22), "dark grey", bevel=0.003)
    for y in (-0.06, 0.06):
        b.box((0.01, 0.06, 0.09), (foot[0], y, 0.36), "black")
        b.box((0.012, 0.012, 0.04), (foot[0] + 0.002, y, 0.38), "amber")
    size = ((0.83, 0.69, 1.75), (0.86, 0.74, 1.9), (0.8, 0.66, 1.6))[variant]
    return varied(b, rng, size, f"an arcade cabinet of a {style}", style)


def _controls(b: MeshBuilder, edge: tuple[Point2, Point2, Point2], style: str) -> None:
    """Sticks and buttons, or a wheel, on the sloping board between two points of the side view."""
    (x0, z0), (x1, z1) = edge[1], edge[2]
    slope = float(np.degrees(np.arctan2(z1 - z0, x0 - x1)))
    with b.frame(((x0 + x1) / 2, 0, (z0 + z1) / 2), (0, slope, 0)):
        b.box((0.25, 0.66, 0.02), (0, 0, -0.012), "charcoal", bevel=0.004)
        if style == "racing game":
            with b.frame((0, 0, 0.02), (0, 38, 0)):
                b.cylinder(0.03, 0.09, (0, 0, -0.03), "black", segments=10)
                b.ring(0.13, 0.016, (0, 0, 0.07), "black", segments=20, sides=6)
                for turn in (90, 210, 330):
                    b.box(
                        (0.13, 0.028, 0.012),
                        (0.065 * np.cos(np.radians(turn)), 0.065 * np.sin(np.radians(turn)), 0.062),
                        "aluminium",
                        (0, 0, turn),
                    )
            return
        for y in (-0.2, 0.1):
            b.cylinder(0.035, 0.006, (0, y, 0.008), "grey", segments=12)
            b.cylinder(0.008, 0.08, (0, y, 0.01), "black", segments=8)
            b.ball(0.027, (0, y, 0.1), "signal red" if y < 0 else "signal blue", segments=10, rings=6)
            for k in range(4):
                ink = ("signal yellow", "signal red", "light green", "white")[k]
                b.cylinder(0.018, 0.014, (0.03 - 0.06 * (k % 2), y + 0.09 + 0.05 * (k // 2), 0.008), ink, segments=10)


@recipe("television", 3, name="screens.television")
def television(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Flat set on two feet, wooden set with a tube, large one on a pedestal."""
    b = MeshBuilder(roughness=0.3)
    style = ("flat-screen", "tube", "pedestal")[variant]
    if style == "tube":
        b.box((0.3, 0.6, 0.46), (0.08, 0, 0.02), "wood", bevel=0.012)
        b.box((0.2, 0.42, 0.34), (-0.17, 0, 0.06), "charcoal", bevel=0.03)
        b.box((0.02, 0.43, 0.41), (0.225, -0.075, 0.045), "charcoal", bevel=0.006)
        grid = [
            [(0.238 + 0.02 * (1 - u * u) * (1 - v * v), -0.075 + 0.18 * u, 0.25 + 0.165 * v) for u in _ARC]
            for v in _ARC
        ]
        b.sheet(np.array(grid), image=landscape((64, 52)))
        b.box((0.012, 0.12, 0.41), (0.228, 0.215, 0.045), "brown")
        for z in (0.38, 0.28):
            b.cylinder(0.032, 0.03, (0.23, 0.215, z), "aluminium", (0, 90, 0), segments=14)
        for k in range(7):
            b.box((0.006, 0.09, 0.008), (0.235, 0.215, 0.07 + 0.02 * k), "black")
        for s in (-1, 1):
            b.rod((0.0, 0.02 * s, 0.47), (-0.04, 0.2 * s, 0.8), 0.004, "aluminium", sides=5)
        b.box((0.08, 0.1, 0.02), (0.0, 0, 0.475), "black", bevel=0.005)
    else:
        image = landscape((144, 82), dusk=variant == 2)
        z = 0.07 if variant == 0 else 0.14
        b.box((0.022, 1.12, 0.64), (0.0, 0, z), "black", bevel=0.006)
        b.box((0.05, 0.7, 0.32), (-0.03, 0, z + 0.05), "charcoal", bevel=0.012)
        b.panel(image, (0.013, 0, z + 0.322), 1.09, 0.605)
        b.box((0.004, 0.06, 0.008), (0.012, 0, z + 0.006), "light grey")
        if style == "flat-screen":
            for y in (-0.4, 0.4):
                for x in (-0.11, 0.11):
                    b.beam((0, y, 0.09), (x, y, 0.008), 0.03, 0.016, "dark grey")
        else:
            b.box((0.26, 0.5, 0.014), color="dark grey", bevel=0.004)
            b.box((0.05, 0.16, 0.2), (-0.02, 0, 0.01), "dark grey", bevel=0.01)
    size = ((0.24, 1.12, 0.7), (0.48, 0.62, 0.72), (0.3, 1.6, 1.02))[variant]
    return varied(b, rng, size, f"a {style} television", style)


_ARC = np.linspace(-1, 1, 7)


@recipe("computer monitor", 3, name="screens.computer_monitor")
def computer_monitor(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Black office screen, very wide screen on a V foot, white all-in-one with a chin."""
    b = MeshBuilder(roughness=0.35)
    style = ("office", "very wide", "all-in-one")[variant]
    frame: Color = ("black", "charcoal", "white")[variant]
    width = (0.55, 0.8, 0.55)[variant]
    b.box((0.022, width, 0.34), (0.03, 0, 0.12), frame, bevel=0.005)
    b.box((0.03, width * 0.55, 0.2), (0.01, 0, 0.18), shade(frame, 0.9), bevel=0.01)
    chin = 0.06 if style == "all-in-one" else 0.016
    image = landscape((128, 72)) if style == "very wide" else desktop((128, 76))
    b.panel(image, (0.0425, 0, 0.29 + (chin - 0.012) / 2), width - 0.02, 0.34 - chin - 0.012)
    b.cylinder(
        0.006,
        0.003,
        (0.041, width * 0.46 if variant < 2 else 0.0, 0.128 if variant < 2 else 0.15),
        "light green",
        (0, 90, 0),
        segments=8,
    )
    if style == "very wide":
        b.box((0.04, 0.05, 0.24), (-0.02, 0, 0.02), frame, bevel=0.01)
        for s in (-1, 1):
            b.beam((-0.03, 0, 0.012), (0.11, 0.2 * s, 0.008), 0.035, 0.016, frame)
    else:
        stand: Color = "aluminium" if style == "all-in-one" else frame
        b.box((0.02, 0.08, 0.27), (-0.02, 0, 0.01), stand, bevel=0.006)
        b.extrude(rounded(0.2, 0.26, 0.03), 0.012, color=stand)
    size = ((0.2, 0.56, 0.46), (0.26, 0.86, 0.47), (0.2, 0.58, 0.5))[variant]
    return varied(b, rng, size, f"a {style} computer monitor", style)


def key_rows(
    b: MeshBuilder, rows: list[list[float]], at: Point2, z: float, pitch: float, color: Color, accent: Color
) -> None:
    """Rows of keys; each row lists its keys' widths in pitches (negative: a gap), from the left of the user at +x."""
    top: list[Color] = [color, accent]
    for r, row in enumerate(rows):
        y = at[1]
        for k, width in enumerate(row):
            span = abs(width) * pitch
            if width > 0:
                marked = (width > 1.4 and width < 4) or (r == 0 and k == 0)
                b.box(
                    (pitch * 0.86, span - pitch * 0.14, pitch * 0.4),
                    (at[0] + r * pitch, y + span / 2, z),
                    top[int(marked)],
                    taper=(0.84, 1 - 0.16 * pitch / span),
                )
            y += span


_FULL = [
    [1, -1, 4, -0.5, 4, -0.5, 4, -0.25, 1, 1, 1],
    [1] * 13 + [2, -0.25, 1, 1, 1, -0.25, 1, 1, 1, 1],
    [1.5] + [1] * 12 + [1.5, -0.25, 1, 1, 1, -0.25, 1, 1, 1, 1],
    [1.8] + [1] * 11 + [2.2, -3.5, 1, 1, 1],
    [2.3] + [1] * 10 + [2.7, -1.25, 1, -1.25, 1, 1, 1, 1],
    [1.3, 1.3, 1.3, 6.2, 1.3, 1.3, 2.3, -0.25, 1, 1, 1, -0.25, 2, 1, 1],
]
_COMPACT = [
    [1] * 13 + [2],
    [1.5] + [1] * 12 + [1.5],
    [1.8] + [1] * 11 + [2.2],
    [2.3] + [1] * 10 + [2.7],
    [1.3, 1.3, 1.3, 6.2, 1.3, 1.3, 2.3],
]


@recipe("keyboard", 3, hulls=1, name="screens.keyboard")
def keyboard(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Full-size black, compact white with coloured keys, old beige; the typist sits at +x."""
    b = MeshBuilder(roughness=0.6)
    style = ("full-size", "compact", "old beige")[variant]
    rows = _COMPACT if style == "compact" else _FULL
    case, key, accent = (
        ("black", "dark grey", "charcoal"),
        ("white", "off white", "orange"),
        ("beige", "cream", "grey"),
    )[variant]
    width = max(sum(abs(w) for w in row) for row in rows) + 0.6
    depth = len(rows) + 0.7
    with b.frame((0, 0, 0), (0, 4, 0)):
        b.box((depth, width, 0.6), (0, 0, 0), case, bevel=0.12)
        key_rows(b, rows, (-depth / 2 + 0.85, -width / 2 + 0.3), 0.6, 1.0, key, accent)
    size = ((0.138, 0.44, 0.031), (0.108, 0.3, 0.034), (0.185, 0.48, 0.045))[variant]
    return varied(b, rng, size, f"a {style} keyboard", style)


@recipe("laptop", 3, name="screens.laptop")
def laptop(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Closed aluminium machine, open silver one, open black one; the user sits at +x."""
    b = MeshBuilder(roughness=0.35, metallic=0.2)
    style = ("closed", "open silver", "open black")[variant]
    case, key = (("aluminium", "black"), ("aluminium", "charcoal"), ("charcoal", "black"))[variant]
    b.extrude(rounded(0.22, 0.316, 0.012), 0.009, color=case)
    if style == "closed":
        b.extrude(rounded(0.22, 0.316, 0.012), 0.007, (0, 0, 0.0095), shade(case, 0.97))
        b.box((0.21, 0.306, 0.002), (0, 0, 0.0085), "black")
        b.cylinder(0.02, 0.0006, (0, 0, 0.0165), "dark grey", segments=20)
        b.cylinder(0.012, 0.0009, (0.004, 0, 0.0165), "white", segments=16)
        b.rod((-0.107, -0.1, 0.0095), (-0.107, 0.1, 0.0095), 0.0055, "charcoal")
        b.box((0.006, 0.05, 0.003), (0.108, 0, 0.0075), "dark grey")
    else:
        b.box((0.1, 0.285, 0.0008), (-0.035, 0, 0.0088), shade(case, 0.8))
        key_rows(b, _COMPACT, (-0.073, -0.138), 0.0092, 0.0186, key, key)
        b.box((0.06, 0.1, 0.0008), (0.065, 0, 0.0088), shade(case, 0.88))
        with b.frame((-0.105, 0, 0.009), (0, -15, 0)):
            b.box((0.007, 0.316, 0.21), (0, 0, 0), case, bevel=0.002)
            b.box((0.001, 0.304, 0.196), (0.0036, 0, 0.007), "black")
            b.panel(
                desktop((112, 70)) if variant == 1 else landscape((112, 70), True), (0.0046, 0, 0.106), 0.292, 0.182
            )
        b.rod((-0.105, -0.12, 0.009), (-0.105, 0.12, 0.009), 0.005, "charcoal")
    size = ((0.222, 0.318, 0.018), (0.262, 0.316, 0.215), (0.275, 0.36, 0.245))[variant]
    return varied(b, rng, size, f"a {style} laptop computer", style)


@recipe("mobile phone", 3, hulls=1, name="screens.mobile_phone")
def mobile_phone(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Dark smartphone, white one with a photograph, old one with keys; standing, screen at +x."""
    b = MeshBuilder(roughness=0.25)
    style = ("dark smart", "white smart", "keypad")[variant]
    case: Color = ("charcoal", "off white", "dark blue")[variant]
    turned = (90, 0, 90)
    if style == "keypad":
        b.extrude(rounded(0.07, 0.13, 0.02), 0.018, (0, 0, 0.065), case, turned)
        screen, pen = paint.canvas((40, 32), "#8fae6a")
        paint.text(pen, "12:30", (3, 3, 37, 18), "black")
        for k in range(4):
            pen.rectangle((4 + 5 * k, 28 - 2 * k, 7 + 5 * k, 29), fill=(20, 24, 18))
        b.box((0.0012, 0.054, 0.045), (0.0182, 0, 0.075), "black")
        b.panel(screen, (0.0192, 0, 0.0975), 0.048, 0.038)
        b.box((0.003, 0.026, 0.01), (0.018, 0, 0.061), "light grey", bevel=0.001)
        for k in range(12):
            y, z = 0.018 * (k % 3 - 1), 0.047 - 0.012 * (k // 3)
            b.box((0.0025, 0.014, 0.008), (0.0185, y, z), "light grey", bevel=0.001, centered=True)
        b.cylinder(0.006, 0.012, (0.009, 0.024, 0.126), "black", segments=8)
    else:
        b.extrude(rounded(0.072, 0.148, 0.01), 0.0078, (0, 0, 0.074), case, turned)
        b.extrude(rounded(0.07, 0.146, 0.009), 0.0003, (0.0078, 0, 0.074), "black", turned)
        image = icons((60, 128), 4, 4) if variant == 0 else landscape((60, 128), True)
        b.panel(image, (0.00835, 0, 0.074), 0.066, 0.139)
        b.cylinder(0.0028, 0.0006, (0.0082, 0, 0.1385), "black", (0, 90, 0), segments=10)
        b.box((0.003, 0.001, 0.02), (0.004, 0.0362, 0.09), shade(case, 0.7))
        b.extrude(rounded(0.026, 0.026, 0.006), 0.0012, (-0.0012, -0.018, 0.128), shade(case, 0.8), turned)
        for dy, dz in ((-0.006, 0.006), (0.006, -0.006)):
            b.cylinder(0.005, 0.001, (-0.0022, -0.018 + dy, 0.128 + dz), "black", (0, 90, 0), segments=12)
    size = ((0.0092, 0.0735, 0.148), (0.0088, 0.077, 0.161), (0.021, 0.067, 0.131))[variant]
    return varied(b, rng, size, f"a {style} mobile phone", style, jitter=0.005)


@recipe("tablet", 2, hulls=1, name="screens.tablet")
def tablet(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Dark tablet with icons, white one with a chart; standing on its long side, screen at +x."""
    b = MeshBuilder(roughness=0.25)
    style = ("dark", "white")[variant]
    turned = (90, 0, 90)
    b.extrude(
        rounded(0.25, 0.175, 0.012), 0.0065, (0, 0, 0.0875), "galvanised" if variant == 0 else "aluminium", turned
    )
    b.extrude(rounded(0.247, 0.172, 0.011), 0.0004, (0.0065, 0, 0.0875), "black" if variant == 0 else "white", turned)
    image = icons((120, 78), 7, 3) if variant == 0 else desktop((120, 78))
    b.panel(image, (0.0071, 0, 0.0875), 0.226, 0.153)
    b.cylinder(0.005, 0.0004, (0.0068, 0.1185, 0.0875), "dark grey", (0, 90, 0), segments=12)
    b.cylinder(0.004, 0.0008, (-0.0008, -0.11, 0.16), "black", (0, 90, 0), segments=10)
    b.box((0.003, 0.02, 0.001), (0.0033, 0.1, 0.1748), "dark grey")
    size = ((0.0075, 0.25, 0.175), (0.0068, 0.281, 0.214))[variant]
    return varied(b, rng, size, f"a {style} tablet computer", style, jitter=0.005)


@recipe("projector", 3, hulls=1, name="screens.projector")
def projector(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """White conference projector, black cinema one, slide projector with its carousel; the lens looks along +x."""
    b = MeshBuilder(roughness=0.4)
    style = ("conference", "cinema", "slide")[variant]
    body: Color = ("white", "charcoal", "light grey")[variant]
    lens_y = (-0.09, 0.0, -0.07)[variant]
    b.box((0.25, 0.33, 0.09), (0, 0, 0.02), body, bevel=0.014)
    with b.frame((0.115, lens_y, 0.068), (0, 90, 0)):
        b.lathe([(0.042, 0.0), (0.042, 0.03), (0.036, 0.035), (0.036, 0.06)], color="black", segments=20)
        b.ring(0.036, 0.005, (0, 0, 0.06), "dark grey", segments=20, sides=5)
        b.ball((0.032, 0.032, 0.016), (0, 0, 0.055), "light blue", segments=16, rings=6)
    for k in range(8):
        b.box((0.006, 0.1, 0.004), (0.124, 0.09, 0.036 + 0.008 * k), "dark grey")
        b.box((0.1, 0.006, 0.004), (-0.04, 0.164, 0.036 + 0.008 * k), "dark grey")
    for x, y in ((0.09, -0.12), (0.09, 0.12), (-0.1, 0)):
        b.cylinder(0.014, 0.022, (x, y, 0), "black", segments=10)
    if style == "slide":
        b.cylinder(0.115, 0.035, (-0.01, 0.02, 0.11), "black", segments=28)
        for k in range(20):
            with b.frame((-0.01, 0.02, 0.145), (0, 0, 18 * k)):
                b.box((0.05, 0.005, 0.014), (0.085, 0, 0), "off white")
        b.cylinder(0.03, 0.02, (-0.01, 0.02, 0.145), "grey", segments=14)
    else:
        keys, pen = paint.canvas((48, 32), shade(body, 0.9))
        for k in range(3):
            pen.ellipse((6 + 14 * k, 4, 14 + 14 * k, 12), fill=(60, 62, 66))
        pen.ellipse((17, 15, 31, 29), outline=(60, 62, 66), width=2)
        desk_panel(b, keys, (-0.03, 0.06, 0.1105), 0.1, 0.08)
        b.ring(0.03, 0.004, (0.08, lens_y, 0.108), "dark grey", segments=16, sides=4)
    size = ((0.26, 0.33, 0.122), (0.34, 0.42, 0.17), (0.27, 0.3, 0.17))[variant]
    return varied(b, rng, size, f"a {style} projector", style)
