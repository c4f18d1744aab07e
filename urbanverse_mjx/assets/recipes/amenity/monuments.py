"""Stone of squares, parks and churchyards: obelisks, graves, drinking fountains, wells."""

import numpy as np
from PIL import Image

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, rgb, shade
from ...meshes.recipe import recipe
from ..shared.facade_images import wall
from ..shared.forms import hollow
from ..shared.outlines import arc, pairs
from ..shared.sizes import made


def inscription(words: str, stone: Color, ink: Color, size: tuple[int, int], lines: int = 3) -> Image.Image:
    """Letters cut into a stone face."""
    image, draw = paint.canvas((size[0] * 3, size[1] * 3), stone)
    w, h = image.size
    draw.rectangle((6, 6, w - 7, h - 7), outline=shade(stone, 0.75), width=4)
    paint.text(draw, words, (w * 0.1, h * 0.08, w * 0.9, h * 0.5), ink, bold=0.02)
    for k in range(lines):
        y = h * (0.62 + 0.3 * k / max(lines, 1))
        draw.line((w * 0.2, y, w * 0.8, y), fill=rgb(ink), width=6)
    return paint.shrunk(image, size)


@recipe("obelisk", 3, name="monuments.obelisk")
def obelisk(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A granite shaft on steps, a white one with a gilded tip, a squat sandstone one with ball feet."""
    b = MeshBuilder(roughness=0.8)
    stone, tip, size = (
        ("granite", "granite", (1.1, 1.1, 5.5)),
        ("marble", "gold", (2.0, 2.0, 11.0)),
        ("sandstone", "sandstone", (0.8, 0.8, 2.9)),
    )[variant % 3]
    width, height = size[0], size[2]
    z = 0.0
    for share, tall in ((1.0, 0.03), (0.84, 0.03)):
        b.box((width * share, width * share, height * tall), (0, 0, z), shade(stone, 0.86), bevel=width * 0.012)
        z += height * tall
    base = width * (0.6 if variant % 3 < 2 else 0.72)
    tall = height * 0.17
    image = inscription("IN\nMEMORY", stone, "charcoal" if variant % 3 < 2 else "dark wood", (48, 48))
    b.box((base, base, tall), (0, 0, z), stone, bevel=width * 0.01)
    for face in ("+x", "-x"):
        x = (base / 2 + 0.003) * (1 if face == "+x" else -1)
        b.panel(image, (x, 0, z + tall * 0.5), base * 0.72, tall * 0.72, face)
    z += tall
    b.box((base * 1.14, base * 1.14, height * 0.018), (0, 0, z), stone, bevel=width * 0.01)
    z += height * 0.018
    if variant % 3 == 2:
        for sx in (-1, 1):
            for sy in (-1, 1):
                b.ball(width * 0.07, (sx * base * 0.34, sy * base * 0.34, z + width * 0.06), "bronze", segments=12)
        b.box((base * 1.0, base * 1.0, 0.03), (0, 0, z + width * 0.12), stone)
        z += width * 0.12 + 0.03
    shaft, taper = height * 0.93 - z, 0.62
    b.box((base * 0.8, base * 0.8, shaft), (0, 0, z), stone, taper=(taper, taper), bevel=width * 0.01)
    b.box((base * 0.8 * taper,) * 2 + (height - z - shaft,), (0, 0, z + shaft), tip, taper=(0.02, 0.02), bevel=0.004)
    b.ring(base * 0.2, base * 0.03, (base * 0.4, 0, z + shaft * 0.12), "verdigris", (0, 90, 0), 18, 6)
    return made(b, f"an obelisk of {stone}", size, stone=stone)


def _headstone(b: MeshBuilder, kind: str, at: tuple[float, float], words: str, stone: Color) -> None:
    """A stone with its kerb and bed; the inscription looks along +x."""
    with b.frame((at[0], at[1], 0)):
        ink = "gold" if stone in ("charcoal", "black") else "charcoal"
        image = inscription(words, stone, ink, (48, 48))
        if kind == "round":
            outline = [(-0.36, 0.1), (0.36, 0.1), *pairs(arc(0.36, 0, 180, 13, (0, 0.68)))]
            b.extrude(outline, 0.14, (-0.07, 0, 0), stone, turn_deg=(90, 0, 90))
            b.box((0.3, 0.86, 0.12), color=shade(stone, 0.85), bevel=0.015)
            b.panel(image, (0.073, 0, 0.62), 0.52, 0.5)
        elif kind == "cross":
            b.box((0.3, 0.5, 0.2), color=shade(stone, 0.85), bevel=0.02)
            b.box((0.14, 0.16, 1.05), (0, 0, 0.2), stone, bevel=0.015)
            b.box((0.14, 0.62, 0.16), (0, 0, 0.86), stone, bevel=0.015)
            b.ring(0.2, 0.035, (0, 0, 0.94), stone, (0, 90, 0), 20, 6)
        else:
            b.box((0.34, 0.95, 0.12), color=shade(stone, 0.85), bevel=0.015)
            b.box((0.2, 0.8, 0.75), (0, 0, 0.12), stone, bevel=0.02, taper=(0.8, 0.94))
            b.panel(image, (0.1, 0, 0.5), 0.62, 0.55, tilt_deg=1.5)


def _bed(b: MeshBuilder, x0: float, x1: float, y: float, width: float, rng: np.random.Generator) -> None:
    """A kerbed bed in front of a stone, with flowers."""
    for side in (-1, 1):
        b.box((x1 - x0, 0.08, 0.14), ((x0 + x1) / 2, y + side * (width - 0.08) / 2, 0), "granite", bevel=0.012)
    b.box((0.08, width, 0.14), (x1, y, 0), "granite", bevel=0.012)
    b.box((x1 - x0, width - 0.1, 0.08), ((x0 + x1) / 2, y, 0), "soil")
    for _ in range(9):
        fx, fy = float(rng.uniform(x0 + 0.12, x1 - 0.12)), y + float(rng.uniform(-0.38, 0.38)) * (width - 0.2)
        b.ball((0.07, 0.07, 0.06), (fx, fy, 0.1), "leaf", segments=7, rings=4)
        b.ball(
            0.035,
            (fx, fy, 0.16),
            ("signal red", "signal yellow", "white", "pink")[int(rng.integers(4))],
            (0, 0, 0),
            7,
            4,
        )


@recipe("grave yard", 3, name="monuments.grave_yard")
def grave_yard(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A headstone with its kerbed bed, a cross on a plinth with a lantern, a plot of six stones on grass."""
    b = MeshBuilder(roughness=0.85)
    if variant % 3 == 0:
        _headstone(b, "round", (-0.3, 0), "A. STONE\n1921-2003", "light grey")
        _bed(b, -0.15, 0.4, 0.0, 0.92, rng)
        b.cylinder(0.05, 0.16, (0.3, 0.3, 0.08), "dark red", segments=12)
        return made(b, "a rounded headstone with its bed", (0.9, 1.0, 1.05), stones=1)
    if variant % 3 == 1:
        _headstone(b, "cross", (-0.25, 0), "", "granite")
        _bed(b, -0.1, 0.5, 0.0, 0.8, rng)
        return made(b, "a stone cross with its bed", (0.85, 0.8, 1.45), stones=1)
    b.box((3.2, 4.4, 0.04), color="grass")
    kinds = ("round", "slab", "cross", "slab", "round", "slab")
    for k, kind in enumerate(kinds):
        stone = ("light grey", "charcoal", "granite", "sandstone", "marble", "black")[int(rng.integers(6))]
        x, y = -1.2 + 1.55 * (k // 3), -1.45 + 1.45 * (k % 3)
        words = ("REST\nIN PEACE", "B. HILL\n1940", "M. ROSE\n1899")[k % 3]
        with b.frame((0, 0, 0.03), (0, 0, float(rng.uniform(-3, 3)))):
            _headstone(b, kind, (x, y), words, stone)
            b.box((0.85, 0.6, 0.06), (x + 0.65, y, 0), shade("grass", 0.8), bevel=0.03)
    return made(b, "a plot of six graves", (3.2, 4.4, 1.3), stones=6)


@recipe("water point", 3, name="monuments.water_point")
def water_point(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A pillar fountain with bowl and bubbler, a cast-iron hand pump, a stone post with tap and basin; user at +x."""
    b = MeshBuilder(roughness=0.5)
    style = ("drinking fountain", "hand pump", "stone tap")[variant % 3]
    if style == "drinking fountain":
        b.lathe([(0.17, 0), (0.17, 0.05), (0.11, 0.09), (0.085, 0.2), (0.08, 0.72), (0.12, 0.8)], color="dark green")
        hollow(
            b, [(0.06, 0.78), (0.15, 0.84), (0.19, 0.94), (0.195, 0.96)], 0.02, "dark green", segments=22, floor=0.86
        )
        b.cylinder(0.16, 0.012, (0, 0, 0.875), "water", segments=22)
        b.tube([(-0.13, 0, 0.9), (-0.13, 0, 0.99), (-0.1, 0, 1.02), (-0.06, 0, 1.0)], 0.013, "brass")
        b.tube([(-0.06, 0, 1.0), (-0.01, 0, 1.01), (0.04, 0, 0.96), (0.06, 0, 0.88)], 0.007, "light blue", sides=6)
        b.cylinder(0.02, 0.03, (0.185, 0, 0.9), "brass", turn_deg=(0, 90, 0), segments=12)
        hollow(b, [(0.07, 0.0), (0.11, 0.03), (0.12, 0.07)], 0.015, "galvanised", (0.16, 0, 0), 16)
        size = (0.42, 0.38, 1.02)
    elif style == "hand pump":
        b.box((0.4, 0.34, 0.12), (0.02, 0, 0), "sandstone", bevel=0.02)
        b.lathe([(0.12, 0.12), (0.1, 0.16), (0.075, 0.2), (0.065, 0.8), (0.09, 0.84), (0.09, 1.05)], color="dark green")
        b.lathe([(0.1, 1.05), (0.1, 1.08), (0.05, 1.14), (0.02, 1.17)], color="dark green")
        b.tube(
            [(0.06, 0, 0.92), (0.2, 0, 0.93), (0.26, 0, 0.88), (0.27, 0, 0.82)],
            [0.04, 0.032, 0.03, 0.032],
            "dark green",
        )
        b.rod((0, 0, 1.12), (0, 0, 1.28), 0.012, "galvanised")
        b.tube(
            [(0.06, 0, 1.26), (-0.02, 0, 1.3), (-0.2, 0, 1.2), (-0.34, 0, 0.95), (-0.38, 0, 0.7)], 0.018, "dark green"
        )
        b.ball(0.03, (-0.38, 0, 0.69), "black")
        hollow(b, [(0.11, 0.12), (0.14, 0.36)], 0.012, "galvanised", (0.27, 0, 0), 18)
        b.cylinder(0.125, 0.01, (0.27, 0, 0.3), "water", segments=18)
        size = (0.8, 0.36, 1.3)
    else:
        b.box((0.24, 0.4, 1.0), (-0.16, 0, 0), "sandstone", bevel=0.03)
        b.convex(
            [(-0.16 + sx * 0.15, sy * 0.23, 1.0) for sx in (-1, 1) for sy in (-1, 1)]
            + [(-0.16, s * 0.1, 1.12) for s in (-1, 1)],
            shade("sandstone", 0.9),
        )
        b.tube([(-0.05, 0, 0.72), (0.06, 0, 0.72), (0.1, 0, 0.7), (0.1, 0, 0.64)], 0.018, "brass")
        b.rod((0.03, -0.05, 0.78), (0.03, 0.05, 0.78), 0.01, "brass")
        b.rod((0.03, 0, 0.72), (0.03, 0, 0.78), 0.01, "brass")
        b.extrude(
            [(-0.06, -0.3), (0.3, -0.3), (0.3, 0.3), (-0.06, 0.3)],
            0.34,
            (0, 0, 0.06),
            "sandstone",
            holes=[[(0.0, -0.24), (0.24, -0.24), (0.24, 0.24), (0.0, 0.24)]],
        )
        b.box((0.5, 0.66, 0.06), (0.05, 0, 0), shade("sandstone", 0.85), bevel=0.01)
        b.box((0.25, 0.5, 0.2), (0.12, 0, 0.06), "water")
        size = (0.66, 0.64, 1.12)
    return made(b, f"a {style}", size, style=style)


@recipe("water well", 3, name="monuments.water_well")
def water_well(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A round stone well under a roof with windlass and bucket, one with an iron arch, a square brick one, covered."""
    b = MeshBuilder(roughness=0.9)
    stone = ("granite", "sandstone", "brick")[variant % 3]
    if variant % 3 < 2:
        for k in range(4):
            for j in range(15):
                tone = shade(stone, float(rng.uniform(0.78, 1.1)))
                with b.frame((0, 0, 0.19 * k), (0, 0, 24 * (j + 0.5 * (k % 2)))):
                    b.box((0.24, 0.27, 0.185), (0.58, 0, 0), tone)
        hollow(b, [(0.74, 0.76), (0.74, 0.86)], 0.3, shade(stone, 0.9), segments=24, floor=0.78)
        b.cylinder(0.46, 0.3, color="black", segments=20)
    else:
        image = wall("brick", (1.4, 0.8), "brick", rng, 96)
        b.box((1.4, 1.4, 0.8), color="brick", skins=dict.fromkeys(("+x", "-x", "+y", "-y"), image))
        b.box((1.5, 1.5, 0.1), (0, 0, 0.8), "sandstone", bevel=0.02)
        for k in range(5):
            b.box((0.9, 0.17, 0.04), (0, -0.36 + 0.18 * k, 0.9), "wood")
        b.box((0.06, 0.9, 0.03), (-0.3, 0, 0.94), "cast iron")
        b.box((0.06, 0.9, 0.03), (0.3, 0, 0.94), "cast iron")
    if variant % 3 == 1:
        b.tube(
            [(0, y, 0.85 + z) for y, z in [(-0.62, 0), *pairs(arc(0.62, 180, 0, 13, (0, 0.55))), (0.62, 0)]],
            0.025,
            "cast iron",
        )
        b.ring(0.09, 0.02, (0, 0, 1.85), "cast iron", (0, 90, 0), 16, 6)
        b.rod((0, 0, 1.15), (0, 0, 1.78), 0.01, "beige", sides=5)
        hollow(b, [(0.1, 0.9), (0.13, 1.15)], 0.015, "galvanised", segments=14)
        return made(b, "a round well under an iron arch", (1.5, 1.5, 2.05), stone=stone)
    for y in (-0.62, 0.62):
        b.box((0.1, 0.1, 1.2), (0, y, 0.8), "dark wood")
    b.cylinder(0.07, 1.1, (0, 0.55, 1.35), "wood", turn_deg=(90, 0, 0), segments=12)
    b.tube([(0, 0.6, 1.35), (0, 0.75, 1.35), (0, 0.75, 1.15), (0, 0.86, 1.15)], 0.015, "cast iron", sides=6)
    b.rod((0.07, 0, 1.1), (0.07, 0, 1.35), 0.01, "beige", sides=5)
    if variant % 3 == 0:
        hollow(b, [(0.09, 0.9), (0.12, 1.12)], 0.015, "dark wood", (0.07, 0, 0), 14)
    for side in (-1, 1):
        b.convex(
            [(side * x, y, z) for y in (-0.85, 0.85) for x, z in ((0, 2.2), (0, 2.13), (0.72, 1.8), (0.72, 1.73))],
            "terracotta" if variant % 3 == 0 else "dark grey",
        )
    b.rod((0, -0.87, 2.19), (0, 0.87, 2.19), 0.04, "dark red", sides=8)
    size = (1.55, 1.65, 2.2) if variant % 3 == 0 else (1.5, 1.8, 2.5)
    return made(b, f"a roofed well of {stone}", size, stone=stone)
