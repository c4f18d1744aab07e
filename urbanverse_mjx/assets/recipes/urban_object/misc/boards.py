"""Equipment of teachers and photographers: blackboards, whiteboards, tripods. The written side looks along +x."""

import numpy as np
from PIL import Image, ImageDraw

from ....meshes import paint
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, rgb
from ....meshes.recipe import recipe
from ...shared.sizes import varied


def _sum_and_triangle(size: tuple[int, int], ground: Color, inks: list[Color]) -> Image.Image:
    """A board with a sum, a triangle and a line of writing."""
    big = paint.smooth(size, 2)
    w, h = big
    image, pen = paint.canvas(big, ground)
    paint.text(pen, "y = 3x + 7", (w * 0.06, h * 0.1, w * 0.62, h * 0.3), inks[0])
    paint.text(pen, "3 x 7 = 21", (w * 0.06, h * 0.4, w * 0.5, h * 0.56), inks[0])
    paint.text(pen, "HOMEWORK: p. 42", (w * 0.06, h * 0.74, w * 0.6, h * 0.88), inks[1])
    pen.polygon([(w * 0.66, h * 0.72), (w * 0.93, h * 0.72), (w * 0.66, h * 0.28)], outline=rgb(inks[2]), width=4)
    pen.rectangle((w * 0.66, h * 0.66, w * 0.69, h * 0.72), outline=rgb(inks[2]), width=3)
    return paint.shrunk(image, size)


def _plan(size: tuple[int, int]) -> Image.Image:
    """Boxes with arrows and coloured notes."""
    big = paint.smooth(size, 2)
    w, h = big
    image, pen = paint.canvas(big, "#f6f7f8")
    paint.text(pen, "SPRINT 14", (w * 0.05, h * 0.06, w * 0.4, h * 0.18), "dark blue", 0.03)
    for k in range(3):
        x = w * (0.06 + 0.2 * k)
        pen.rectangle((x, h * 0.3, x + w * 0.14, h * 0.46), outline=rgb("blue"), width=4)
        if k < 2:
            _arrow(pen, (x + w * 0.145, h * 0.38), (x + w * 0.195, h * 0.38))
    pen.line(
        [(w * (0.06 + 0.055 * k), h * (0.86 - 0.24 * (k / 10) ** 2 - 0.03 * (k % 2))) for k in range(11)],
        fill=rgb("green"),
        width=5,
    )
    pen.line((w * 0.06, h * 0.88, w * 0.63, h * 0.88), fill=(40, 40, 44), width=4)
    for k in range(6):
        x, y = w * (0.7 + 0.14 * (k % 2)), h * (0.14 + 0.26 * (k // 2))
        pen.rectangle((x, y, x + w * 0.11, y + h * 0.2), fill=rgb(("signal yellow", "pink", "lime")[k % 3]))
        for j in range(3):
            pen.line((x + 6, y + 10 + 10 * j, x + w * 0.09, y + 10 + 10 * j), fill=(90, 90, 90), width=2)
    return paint.shrunk(image, size)


def _arrow(pen: ImageDraw.ImageDraw, start: tuple[float, float], end: tuple[float, float]) -> None:
    pen.line((*start, *end), fill=rgb("signal red"), width=4)
    pen.polygon([end, (end[0] - 10, end[1] - 7), (end[0] - 10, end[1] + 7)], fill=rgb("signal red"))


def _framed(
    b: MeshBuilder, image: Image.Image, width: float, height: float, z: float, frame: Color, pens: list[Color]
) -> None:
    """A board in its frame with a tray below for chalk or pens, its middle at x = 0."""
    b.box((0.02, width, height), (0, 0, z), "dark grey")
    b.panel(image, (0.0112, 0, z + height / 2), width - 0.04, height - 0.04)
    for y in (-width / 2, width / 2):
        b.box((0.036, 0.04, height + 0.04), (0.002, y, z - 0.02), frame)
    for low in (z - 0.02, z + height - 0.02):
        b.box((0.036, width, 0.04), (0.002, 0, low), frame)
    b.box((0.07, width * 0.7, 0.014), (0.045, 0, z - 0.02), frame)
    for k, ink in enumerate(pens):
        b.cylinder(0.009, 0.12, (0.055, -0.3 * width + 0.14 * k, z + 0.003), ink, (-90, 0, 0), segments=6)
    b.box((0.04, 0.13, 0.035), (0.05, 0.24 * width, z - 0.006), "dark blue", bevel=0.006)
    b.box((0.042, 0.132, 0.012), (0.05, 0.24 * width, z - 0.006), "beige")


def _stand(b: MeshBuilder, width: float, height: float, color: Color) -> None:
    """Two wheeled posts that carry a board between them."""
    for s in (-1, 1):
        y = s * (width / 2 + 0.04)
        b.box((0.04, 0.04, height), (-0.02, y, 0.08), color)
        b.box((0.55, 0.05, 0.05), (-0.02, y, 0.07), color)
        for x in (-0.27, 0.23):
            b.cylinder(0.035, 0.03, (x, y + 0.015, 0.035), "black", (90, 0, 0), segments=12)
    b.rod((-0.02, -width / 2 - 0.04, 0.24), (-0.02, width / 2 + 0.04, 0.24), 0.018, color)


@recipe("blackboard", 3, name="boards.blackboard")
def blackboard(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Wall board with chalk writing, green board on wheels, small easel of a cafe."""
    b = MeshBuilder(roughness=0.85)
    style = ("wall", "green wheeled", "cafe easel")[variant]
    if style == "cafe easel":
        image, pen = paint.canvas((100, 130), "#24262a")
        paint.text(pen, "TODAY", (10, 8, 90, 36), "signal yellow")
        for k, words in enumerate(("soup 5", "pasta 9", "coffee 3")):
            paint.text(pen, words, (16, 46 + 24 * k, 84, 64 + 24 * k), "white")
        pen.line((12, 40, 88, 40), fill=rgb("pink"), width=2)
        for s in (-1, 1):
            b.beam((0.18, s * 0.29, 0), (0.0, s * 0.27, 1.15), 0.045, 0.03, "wood")
            b.beam((-0.22, s * 0.22, 0), (-0.01, s * 0.25, 1.12), 0.04, 0.025, "wood")
        with b.frame((0.1, 0, 0.3), (0, -8.9, 0)):
            b.box((0.018, 0.54, 0.78), (0.018, 0, 0), "wood")
            b.panel(image, (0.0285, 0, 0.39), 0.47, 0.71)
            b.box((0.06, 0.56, 0.02), (0.03, 0, -0.02), "wood")
        b.rod((-0.06, -0.24, 0.85), (0.06, -0.27, 0.85), 0.006, "brass", sides=5)
    else:
        green = style == "green wheeled"
        drawn = _sum_and_triangle((160, 132), "#1f4a3a" if green else "#23262a", ["white", "signal yellow", "pink"])
        frame: Color = "light wood" if not green else "aluminium"
        _framed(b, drawn, 1.3, 1.1, 0.02 if not green else 0.62, frame, ["white", "white", "signal yellow", "pink"])
        if green:
            _stand(b, 1.34, 1.7, "aluminium")
    size = ((0.09, 1.35, 1.2), (0.56, 1.9, 1.85), (0.45, 0.62, 1.15))[variant]
    return varied(b, rng, size, f"a {style} blackboard", style)


@recipe("whiteboard", 3, name="boards.whiteboard")
def whiteboard(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Wall board with a plan, wheeled one with a sum, flip chart on three legs."""
    b = MeshBuilder(roughness=0.4)
    style = ("wall", "wheeled", "flip chart")[variant]
    pens: list[Color] = ["signal red", "blue", "green", "black"]
    if style == "flip chart":
        image, pen = paint.canvas((96, 132), "white")
        paint.text(pen, "IDEAS", (16, 14, 80, 36), "signal red", 0.04)
        for k in range(4):
            pen.ellipse((12, 50 + 20 * k, 18, 56 + 20 * k), fill=rgb("blue"))
            pen.line((26, 53 + 20 * k, 84 - 9 * (k % 3), 53 + 20 * k), fill=rgb("dark blue"), width=2)
        for y0, y1 in ((-0.2, -0.34), (0.2, 0.34)):
            b.beam((0.0, y0, 1.7), (0.22, y1, 0), 0.03, 0.03, "dark grey")
        b.beam((-0.02, 0, 1.7), (-0.36, 0, 0), 0.03, 0.03, "dark grey")
        with b.frame((0.12, 0, 0.85), (0, -7.5, 0)):
            b.box((0.02, 0.68, 1.0), color="light grey")
            b.panel(image, (0.0145, 0, 0.48), 0.62, 0.9)
            b.box((0.012, 0.62, 0.9), (0.007, 0, 0.03), "white")
            b.box((0.05, 0.68, 0.06), (0.01, 0, 0.95), "charcoal", bevel=0.01)
            b.box((0.07, 0.68, 0.02), (0.04, 0, -0.01), "charcoal")
            for k, ink in enumerate(pens):
                b.cylinder(0.009, 0.12, (0.05, -0.28 + 0.14 * k, 0.019), ink, (-90, 0, 0), segments=6)
    else:
        wheeled = style == "wheeled"
        drawn = (
            _sum_and_triangle((160, 132), "#f6f7f8", ["dark blue", "signal red", "green"])
            if wheeled
            else _plan((160, 132))
        )
        _framed(b, drawn, 1.3, 1.1, 0.62 if wheeled else 0.02, "aluminium", pens)
        if wheeled:
            _stand(b, 1.34, 1.7, "galvanised")
    size = ((0.12, 1.35, 1.2), (0.58, 1.75, 1.9), (0.6, 0.72, 1.85))[variant]
    return varied(b, rng, size, f"a {style} whiteboard", style)


@recipe("tripod", 3, name="boards.tripod")
def tripod(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Photo tripod with a pan handle, yellow wooden one of surveyors, low video tripod."""
    b = MeshBuilder(roughness=0.45)
    style = ("photo", "surveyor's", "low video")[variant]
    top, reach = ((1.2, 0.47), (1.25, 0.5), (0.6, 0.36))[variant]
    for k in range(3):
        with b.frame(turn_deg=(0, 0, 120 * k + 30)):
            if style == "surveyor's":
                for s in (-1, 1):
                    b.beam((0.06, 0.045 * s, top), (reach * 0.6, 0.022 * s, top * 0.38), 0.022, 0.03, "signal yellow")
                b.beam((reach * 0.5, 0, top * 0.5), (reach - 0.02, 0, 0.06), 0.03, 0.03, "light wood")
                b.beam((reach * 0.58, 0, top * 0.41), (reach * 0.62, 0, top * 0.36), 0.08, 0.045, "signal red")
                b.cylinder(0.02, 0.07, (reach, 0, 0), "dark grey", top_radius=0.02, segments=8)
            else:
                for a, c, r, ink in (
                    (0.08, 0.42, 0.016, "charcoal"),
                    (0.4, 0.72, 0.0125, "aluminium"),
                    (0.7, 0.99, 0.0095, "charcoal"),
                ):
                    start, end = (np.array([0.04 + (reach - 0.04) * t, 0, top * (1 - t)]) for t in (a - 0.07, c))
                    b.rod(start, end, r, ink, sides=8)
                    b.rod(end - 0.03 * (end - start), end + 0.03 * (end - start), r * 1.45, "black", sides=8)
                b.ball(0.016, (reach, 0, 0.014), "black", segments=8, rings=5)
                b.rod((0.01, 0, top * 0.6), (reach * 0.42, 0, top * 0.6), 0.006, "grey", sides=5)
    if style == "surveyor's":
        b.cylinder(0.1, 0.04, (0, 0, top - 0.01), "dark grey", segments=18)
        b.cylinder(0.05, 0.03, (0, 0, top + 0.03), "signal yellow", segments=14)
    else:
        b.cylinder(0.05, 0.07, (0, 0, top - 0.04), "black", segments=12)
        b.cylinder(0.013, top * 0.62, (0, 0, top * 0.5), "aluminium", segments=10)
        b.cylinder(0.028, 0.06, (0, 0, top * 1.12), "black", segments=12)
        b.box((0.1, 0.07, 0.05), (0, 0, top * 1.12 + 0.06), "charcoal", bevel=0.008)
        b.box((0.11, 0.06, 0.014), (0, 0, top * 1.12 + 0.11), "signal red", bevel=0.003)
        b.rod((-0.03, 0.03, top * 1.12 + 0.08), (-0.26, 0.06, top * 1.12 - 0.02), 0.007, "black", sides=6)
        b.rod((-0.16, 0.045, top * 1.12 + 0.03), (-0.27, 0.062, top * 1.12 - 0.024), 0.014, "black", sides=8)
    size = ((0.87, 0.84, 1.35), (1.05, 1.0, 1.5), (0.75, 0.73, 0.85))[variant]
    return varied(b, rng, size, f"a {style} tripod", style)
