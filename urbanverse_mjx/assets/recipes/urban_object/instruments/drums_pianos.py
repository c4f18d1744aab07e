"""Drums and pianos."""

import numpy as np
from PIL import Image

from ....meshes import paint
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, rgb, shade
from ....meshes.recipe import recipe
from ...shared.outlines import desk_panel
from ...shared.sizes import varied


def _drum(b: MeshBuilder, radius: float, deep: float, color: Color, lugs: int = 6, segments: int = 24) -> None:
    """A drum standing on its own bottom: shell, hoops, skin, lugs."""
    b.cylinder(radius, deep, color=color, segments=segments)
    for z in (0.012, deep - 0.012):
        b.ring(radius, 0.009, (0, 0, z), "aluminium", segments=segments, sides=4)
    b.cylinder(radius * 0.97, 0.004, (0, 0, deep - 0.001), "white", segments=segments)
    for k in range(lugs):
        a = 2 * np.pi * k / lugs
        x, y = (radius + 0.008) * np.cos(a), (radius + 0.008) * np.sin(a)
        b.rod((x, y, 0.01), (x, y, deep - 0.01), 0.005, "aluminium", sides=4)


@recipe("drum", 3, name="drums_pianos.drum")
def drum(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Floor tom with its sticks, drum kit with cymbals, wooden hand drum with ropes."""
    b = MeshBuilder(roughness=0.35)
    style = ("floor tom", "drum kit", "hand drum")[variant]
    if style == "floor tom":
        with b.frame((0, 0, 0.07)):
            _drum(b, 0.2, 0.31, "signal red", 8)
        for k in range(3):
            a = 2 * np.pi * k / 3 + 0.4
            x, y = 0.213 * np.cos(a), 0.213 * np.sin(a)
            b.tube([(x, y, 0.3), (x, y, 0.07), (x * 1.04, y * 1.04, 0.0)], 0.007, "aluminium", sides=6)
        for s in (-1, 1):
            b.tube(
                [(-0.16, 0.05 * s, 0.389), (0.12, 0.02 * s, 0.389), (0.15, 0.016 * s, 0.389)],
                [0.008, 0.006, 0.004],
                "light wood",
                sides=6,
            )
            b.ball(0.007, (0.155, 0.016 * s, 0.389), "light wood", segments=6, rings=4)
    elif style == "hand drum":
        b.lathe(
            [(0.11, 0.0), (0.1, 0.03), (0.07, 0.2), (0.09, 0.32), (0.155, 0.46), (0.165, 0.55), (0.16, 0.58)],
            color="wood",
            segments=22,
        )
        b.cylinder(0.16, 0.012, (0, 0, 0.578), "cream", segments=22)
        for z, r in ((0.56, 0.168), (0.5, 0.166), (0.28, 0.082)):
            b.ring(r, 0.007, (0, 0, z), "dark red", segments=22, sides=5)
        for k in range(20):
            a, c = 2 * np.pi * k / 20, 2 * np.pi * (k + 0.5) / 20
            for q in (a - np.pi / 20, a + np.pi / 20):
                b.rod(
                    (0.17 * np.cos(a), 0.17 * np.sin(a), 0.5),
                    (0.09 * np.cos(q), 0.09 * np.sin(q), 0.29),
                    0.003,
                    "cream",
                    sides=3,
                )
            b.ball(0.004, (0.17 * np.cos(c), 0.17 * np.sin(c), 0.56), "dark red", segments=5, rings=3)
    else:
        color: Color = "teal"
        with b.frame((0.42, 0, 0.29), (0, -90, 0)):
            _drum(b, 0.28, 0.4, color, 6, 18)
            b.cylinder(0.27, 0.004, (0, 0, -0.004), "white", segments=18)
            b.cylinder(0.1, 0.004, (0, 0, -0.006), "black", segments=18)
        for y, tilt in ((-0.19, 12), (0.19, -12)):
            with b.frame((0.2, y, 0.62), (tilt, -18, 0)):
                _drum(b, 0.155, 0.22, color, 5, 14)
        with b.frame((-0.25, -0.5, 0.3)):
            _drum(b, 0.21, 0.32, color, 4, 14)
        with b.frame((-0.25, 0.42, 0.48)):
            _drum(b, 0.18, 0.14, "aluminium", 4, 14)
        for x, y in ((-0.05, -0.5), (-0.4, -0.6), (-0.4, -0.38), (-0.25, 0.42)):
            b.rod((x, y, 0.0), (x, y, 0.48), 0.01, "aluminium", sides=5)
        for x, y, z, r in ((0.22, -0.62, 1.12, 0.24), (0.16, 0.62, 1.08, 0.22), (-0.05, 0.7, 0.8, 0.17)):
            b.rod((x, y, 0.05), (x, y, z), 0.01, "aluminium", sides=4)
            for k in range(3):
                a = 2 * np.pi * k / 3
                b.rod((x, y, 0.2), (x + 0.17 * np.cos(a), y + 0.17 * np.sin(a), 0.0), 0.009, "aluminium", sides=4)
            b.lathe([(r, 0.0), (r * 0.3, 0.022), (r * 0.2, 0.045), (0.0, 0.05)], (x, y, z), "brass", segments=10)
        b.cylinder(0.15, 0.08, (-0.6, 0, 0.45), "black", segments=18)
        b.cylinder(0.025, 0.45, (-0.6, 0, 0.0), "aluminium", segments=8)
    size = ((0.46, 0.45, 0.4), (1.3, 1.6, 1.15), (0.34, 0.34, 0.6))[variant]
    return varied(b, rng, size, f"a {style}", style)


def _white_keys(octaves: int) -> Image.Image:
    count = 7 * octaves + 3
    image, pen = paint.canvas((4 * count, 24), "white")
    for k in range(1, count):
        pen.line((4 * k, 0, 4 * k, 24), fill=(120, 120, 122))
    return image


def keyboard_of_piano(b: MeshBuilder, x: float, z: float, width: float, depth: float) -> None:
    """Seven octaves of keys lying level, centred across y, their front edge at x."""
    octaves = 7
    pitch = width / (7 * octaves + 3)
    b.box((depth, width, 0.02), (x - depth / 2, 0, z - 0.02), "off white")
    desk_panel(b, _white_keys(octaves), (x - depth / 2, 0, z + 0.001), width, depth)
    for k in range(7 * octaves + 2):
        if k % 7 not in (1, 4):
            b.box((depth * 0.62, pitch * 0.55, 0.012), (x - depth * 0.69, -width / 2 + (k + 1) * pitch, z), "black")


def _grand(b: MeshBuilder, wood: Color) -> None:
    """A grand piano with its lid up, the keys towards +x."""
    side = [
        (0.62, 0.72),
        (0.62, -0.72),
        (-0.1, -0.72),
        (-0.32, -0.62),
        (-0.42, -0.42),
        (-0.52, -0.05),
        (-0.72, 0.16),
        (-0.84, 0.42),
        (-0.78, 0.64),
        (-0.62, 0.72),
    ]
    inner = [
        (0.3, 0.66),
        (0.3, -0.66),
        (-0.1, -0.66),
        (-0.28, -0.57),
        (-0.37, -0.4),
        (-0.47, -0.02),
        (-0.66, 0.19),
        (-0.77, 0.43),
        (-0.72, 0.62),
        (-0.6, 0.66),
    ]
    b.extrude(side, 0.06, (0, 0, 0.6), wood)
    b.extrude(
        side[2:] + [(0.33, 0.72), (0.33, -0.72)],
        0.26,
        (0, 0, 0.64),
        wood,
        holes=[[(x * 0.97 - 0.004, y) for x, y in inner]],
    )
    b.extrude(inner, 0.01, (0, 0, 0.8), "gold")
    for k in range(14):
        y = -0.56 + 0.088 * k
        b.rod((0.26, y, 0.835), (max(-0.08 - 0.72 * (y + 0.56), -0.68), y + 0.04, 0.835), 0.004, "bronze", sides=3)
    keyboard_of_piano(b, 0.6, 0.71, 1.26, 0.15)
    for s in (-1, 1):
        b.box((0.3, 0.05, 0.2), (0.47, 0.695 * s, 0.66), wood, bevel=0.01)
    b.box((0.05, 1.36, 0.2), (0.42, 0, 0.68), wood)
    with b.frame((0.0, 0.72, 0.9), (-48, 0, 0)):
        b.extrude([(x, y - 0.72) for x, y in side[2:]] + [(0.33, 0.0), (0.33, -1.44)], 0.025, color=wood)
    b.rod((0.1, -0.55, 0.86), (0.1, -0.2, 1.42), 0.012, wood, sides=6)
    b.box((0.02, 0.6, 0.2), (0.3, 0, 0.9), wood, turn_deg=(0, -20, 0))
    for x, y in ((0.45, 0.6), (0.45, -0.6), (-0.58, 0.38)):
        b.box((0.09, 0.09, 0.54), (x, y, 0.07), wood, taper=(1.3, 1.3))
        b.cylinder(0.035, 0.03, (x, y + 0.015, 0.035), "brass", (90, 0, 0), segments=10)
    b.box((0.06, 0.2, 0.5), (0.3, 0, 0.12), wood)


@recipe("piano", 3, name="drums_pianos.piano")
def piano(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Black upright, black grand with its lid up, brown upright with candle holders; the player sits at +x."""
    b = MeshBuilder(roughness=0.25)
    style = ("black upright", "grand", "brown upright")[variant]
    wood: Color = ("black", "black", "wood")[variant]
    if style == "grand":
        _grand(b, wood)
    else:
        b.box((0.34, 1.46, 1.2), (-0.13, 0, 0.03), wood, bevel=0.01)
        b.box((0.37, 1.5, 0.04), (-0.13, 0, 1.21), wood, bevel=0.01)
        b.box((0.31, 1.46, 0.07), (0.17, 0, 0.6), wood, bevel=0.01)
        for s in (-1, 1):
            b.box((0.29, 0.08, 0.14), (0.17, 0.69 * s, 0.66), wood, bevel=0.02)
            b.box((0.08, 0.08, 0.6), (0.26, 0.66 * s, 0.02), wood, taper=(1.2, 1.0))
            b.box((0.42, 0.1, 0.05), (0.12, 0.66 * s, 0.0), wood)
        keyboard_of_piano(b, 0.305, 0.7, 1.28, 0.15)
        b.box((0.04, 1.3, 0.12), (0.1, 0, 0.68), shade(wood, 0.8))
        b.box((0.02, 0.9, 0.26), (0.075, 0, 0.9), shade(wood, 1.3) if variant else "charcoal", turn_deg=(0, -12, 0))
        sheet, pen = paint.canvas((96, 60), "off white")
        for r in range(4):
            for j in range(4):
                pen.line((4, 6 + 14 * r + 2 * j, 92, 6 + 14 * r + 2 * j), fill=(70, 70, 70))
            for k in range(9):
                pen.ellipse(
                    (8 + 9 * k, 4 + 14 * r + (5 * k + r) % 8, 11 + 9 * k, 7 + 14 * r + (5 * k + r) % 8), fill=(0, 0, 0)
                )
        pen.line((48, 0, 48, 60), fill=rgb("grey"))
        b.panel(sheet, (0.088, 0, 1.04), 0.46, 0.28, back="white", tilt_deg=12)
        for y in (-0.07, 0.0, 0.07):
            b.box((0.09, 0.03, 0.012), (0.07, y, 0.06), "brass")
        if variant == 2:
            for s in (-1, 1):
                b.tube([(0.04, 0.5 * s, 1.0), (0.14, 0.5 * s, 0.98), (0.14, 0.5 * s, 1.05)], 0.008, "brass", sides=5)
                b.cylinder(0.014, 0.12, (0.14, 0.5 * s, 1.05), "cream", segments=8)
    size = ((0.64, 1.5, 1.25), (1.5, 1.54, 1.38), (0.6, 1.45, 1.3))[variant]
    return varied(b, rng, size, f"a {style} piano", style)
