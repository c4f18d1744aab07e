"""Flags and pennants in the wind. The cloth faces +x."""

import numpy as np
from PIL import Image

from ....meshes import paint, shapes
from ....meshes.mesh_builder import BuiltAsset, ImageLike, MeshBuilder
from ....meshes.palette import Color, rgb
from ....meshes.recipe import recipe
from ...amenity.banners import FOLDED, ripple
from ...shared.sizes import made


def field(style: str, size: tuple[int, int] = (72, 48)) -> Image.Image:
    """The image of a flag: "tricolour", "cross", "wave"."""
    w, h = size[0] * 3, size[1] * 3
    image, draw = paint.canvas((w, h), "white")
    if style == "tricolour":
        for k, color in enumerate(("signal blue", "white", "signal red")):
            draw.rectangle((0, h * k / 3, w, h * (k + 1) / 3), fill=rgb(color))
    elif style == "cross":
        draw.rectangle((0, 0, w, h), fill=rgb("dark red"))
        for width, color in ((0.3, "white"), (0.16, "signal blue")):
            draw.rectangle((w * 0.36 - h * width / 2, 0, w * 0.36 + h * width / 2, h), fill=rgb(color))
            draw.rectangle((0, h / 2 - h * width / 2, w, h / 2 + h * width / 2), fill=rgb(color))
    else:
        draw.rectangle((0, 0, w, h), fill=rgb("green"))
        for k in range(3):
            y = h * (0.2 + 0.27 * k)
            draw.line([(x, y + 10 * np.sin(x / 16)) for x in range(0, w + 4, 4)], fill=rgb("signal yellow"), width=14)
    return paint.shrunk(image, size)


@recipe("flag", 3, hulls=4, name="flags.flag")
def flag(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Two flags on masts with truck, rope and foot; a tall feather flag on a cross base. The cloth flies towards +y."""
    b = MeshBuilder(roughness=0.7)
    if variant % 3 == 2:
        _feather(b, rng)
        return made(b, "a feather flag", (0.55, 0.82, 3.3), FOLDED / 2, style="feather")
    height, style = ((5.2, "tricolour"), (7.0, "cross"))[variant % 3]
    mast = ("off white", "wood")[variant % 3]
    b.lathe([(0.09, 0), (0.09, 0.03), (0.045, 0.05), (0.04, 0.3)], color="charcoal", segments=18)
    b.cylinder(0.036, height - 0.1, color=mast, top_radius=0.024, segments=14)
    b.lathe([(0.03, -0.1), (0.045, -0.07), (0.045, -0.03), (0, 0)], (0, 0, height), "gold", segments=12)
    w, h = 1.36 + 0.3 * (variant % 3), 0.9 + 0.2 * (variant % 3)
    low = height - 0.16 - h
    with b.frame((0, 0.03, low)):
        b.sheet(ripple(w, h, 0.16, 1.3, 0.12, 21, 6), image=field(style), both_sides=True)
    b.rod((0.04, 0.0, 0.9), (0.035, 0.0, height - 0.12), 0.006, "off white", sides=4)
    b.box((0.03, 0.02, 0.14), (0.045, 0, 0.9), "dark grey")
    for z in (low + 0.02, low + h - 0.02):
        b.ring(0.04, 0.008, (0, 0, z), "dark grey", segments=12, sides=4)
    size = ((0.18, 1.45, 5.2), (0.2, 1.75, 7.0))[variant % 3]
    return made(b, f"a {style} flag on a mast", size, FOLDED / 4, style=style)


def _feather(b: MeshBuilder, rng: np.random.Generator) -> None:
    for yaw in (45, 135):
        b.box((0.75, 0.05, 0.03), (0, 0, 0), "charcoal", turn_deg=(0, 0, yaw))
    b.ring(0.2, 0.07, (0, 0, 0.08), "dark blue", segments=18, sides=8)
    curve = [(0, 0, 0.03), (0, 0, 2.4), (0, 0.05, 2.85), (0, 0.2, 3.15), (0, 0.42, 3.26), (0, 0.62, 3.14)]
    b.tube(curve, 0.014, "aluminium", sides=8)
    levels = np.array([0.45, 0.8, 1.6, 2.4, 2.85, 3.1, 3.2])
    left = np.interp(levels, [c[2] for c in curve[:5]], [c[1] for c in curve[:5]])
    right = np.array([0.42, 0.55, 0.66, 0.7, 0.69, 0.62, 0.5])
    u = np.linspace(0, 1, 7)
    grid = [
        [(0.04 * np.sin(7 * s + z), a + (c - a) * s, z) for s in u] for a, c, z in zip(left, right, levels, strict=True)
    ]
    color = ("signal red", "orange")[int(rng.integers(2))]
    image, draw = paint.canvas((96, 384), color)
    for k, letter in enumerate("OPEN"):
        paint.text(draw, letter, (20, 66 + 72 * k, 74, 128 + 72 * k), "white", bold=0.05)
    draw.polygon([(0, 384), (96, 384), (96, 372)], fill=rgb("signal yellow"))
    b.sheet(np.array(grid), image=paint.shrunk(image, (48, 192)), both_sides=True, lettered=True)


@recipe("pennant", 3, name="flags.pennant")
def pennant(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A lettered triangle with a sleeve, a string of many colours, a swallow-tailed one on a stick."""
    b = MeshBuilder(roughness=0.9)
    if variant % 3 == 1:
        count, width = 12, 3.4
        inks = ("red", "signal yellow", "signal blue", "green", "orange", "white")
        y = np.linspace(0, width, 4 * count + 1)
        z = 0.25 * (2 * y / width - 1) ** 2
        b.tube(np.column_stack([np.zeros_like(y), y, z]), 0.006, "off white", sides=4)
        for k in range(count):
            i = 4 * k
            tip = ((y[i] + y[i + 4]) / 2, (z[i] + z[i + 4]) / 2 - 0.3)
            _bunting(b, [(y[i] + 0.02, z[i]), (y[i + 4] - 0.02, z[i + 4]), tip], inks[(k + variant) % 6])
        return made(b, "a string of pennants", (0.025, 3.4, 0.55), count=count)
    words, back, ink = (("TIGERS", "dark blue", "signal yellow"), ("REGATTA", "signal red", "white"))[variant // 2]
    image, draw = paint.canvas((288, 132), back)
    draw.rectangle((0, 0, 24, 132), fill=rgb(ink))
    paint.text(draw, words, (34, 34, 200, 98), ink, bold=0.03)
    w, h, notch = (0.66, 0.32, 0.0) if variant % 3 == 0 else (0.55, 0.26, 0.3)
    left = [(0.0, -h / 2), (0.0, 0.0), (0.0, h / 2)]
    for k in range(2):
        low, high = left[k], left[k + 1]
        inner = (w * (1 - notch), 0.0)
        if notch:
            outer = [(w, -h * 0.3), inner] if k == 0 else [inner, (w, h * 0.3)]
        else:
            outer = [(w, -0.006), inner] if k == 0 else [inner, (w, 0.006)]
        u, v = np.meshgrid(np.linspace(0, 1, 13), np.linspace(0, 1, 4))
        edges = [np.array(low)[None, None] * ((1 - u) * (1 - v))[..., None], np.array(high) * ((1 - u) * v)[..., None]]
        edges += [np.array(outer[0]) * (u * (1 - v))[..., None], np.array(outer[1]) * (u * v)[..., None]]
        flat = edges[0] + edges[1] + edges[2] + edges[3]
        grid = np.dstack([0.008 * np.sin(9 * flat[..., 0]), flat])
        _mapped(b, grid, paint.shrunk(image, (96, 44)), w, h)
    b.rod((0, 0, -h / 2 - (0.3 if notch else 0.0)), (0, 0, h / 2 + 0.01), 0.009, "wood" if notch else ink, sides=10)
    size = ((0.02, 0.7, 0.34), (0.0, 0.0, 0.0), (0.025, 0.58, 0.58))[variant % 3]
    return made(b, f"a pennant of the {words.lower()}", size, FOLDED, words=words)


def _bunting(b: MeshBuilder, corners: list[tuple[float, float]], color: Color) -> None:
    """A small triangle of cloth in the plane of y and z, with a lower part that turns in the wind."""
    b.extrude(corners, 0.004, (0.002, 0, 0), color, turn_deg=(90, 0, 90))


def _mapped(b: MeshBuilder, grid: np.ndarray, image: ImageLike, width: float, height: float) -> None:
    """A curved sheet whose image is laid flat over `width` by `height` from its left edge, seen from both sides."""
    sheet = shapes.sheet(grid)
    uv = np.clip(sheet.vertices[:, 1:] / (width, height) + (0.0, 0.5), 0.0, 1.0)
    cloth = shapes.Shape(sheet.vertices, sheet.faces, uv)
    b.add(cloth, image=image)
    b.add(cloth.flipped(), image=image)
