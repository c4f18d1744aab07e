"""Contents of pockets and handbags: glasses, books, cigarettes, jewelry, watches. Front at +x."""

import numpy as np
from PIL import Image

from ....meshes import paint
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, rgb, shade
from ....meshes.recipe import recipe
from ...shared.forms import painted, pillow, stadium
from ...shared.outlines import arc
from ...shared.sizes import varied_cm
from ...shared.skins import skin


@recipe("a pair of glasses", 3, name="pocket_things.glasses")
def glasses(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Black frames, round wire ones, dark aviators; lenses at +x, temples to the back."""
    b = MeshBuilder(roughness=0.3)
    style = ("black-framed", "round wire", "aviator")[variant % 3]
    color: Color = ("black", "brass", "gold")[variant % 3]
    lens: Color = ("#c9dbe2", "#d3e2e4", "#2b3a33")[variant % 3]
    thick = (0.24, 0.12, 0.12)[variant % 3]
    for side in (-1, 1):
        if style == "black-framed":
            rim = stadium(3.8, 5.2, 1.1)
        elif style == "round wire":
            rim = [(float(x), float(y)) for x, y in arc(2.4, 0, 345, 24)]
        else:
            rim = [(1.7, -2.4), (1.9, 0), (1.6, 2.6), (0.2, 2.9), (-1.8, 1.9), (-2.3, 0.2), (-1.6, -1.7), (0.4, -2.6)]
        outline = [(0.0, side * (y + 3.4), x + 2.3) for x, y in rim]
        b.tube(outline, thick, color, sides=6, closed=True)
        b.convex([(x, y, z) for _, y, z in outline for x in (-0.06, 0.06)], lens)
        hinge = 6.3 if style != "round wire" else 5.9
        arm = [
            (0, side * hinge, 3.1),
            (-0.5, side * 6.9, 3.2),
            (-9.6, side * 6.7, 3.2),
            (-12, side * 6.4, 2.4),
            (-14, side * 6.2, 0.3),
        ]
        b.tube(arm, [thick, 0.22, 0.18, 0.24, 0.28], "black" if style != "round wire" else "brown", sides=6)
        b.ball((0.25, 0.3, 0.5), (-0.6, side * 1.2, 1.8), "off white", segments=8, rings=5)
    b.tube([(0, y, 2.7 + z) for y, z in ((-1.1, 0), (-0.5, 0.4), (0.5, 0.4), (1.1, 0))], thick, color, sides=6)
    if style == "aviator":
        b.tube([(0, -2.2, 4.2), (0, 2.2, 4.2)], 0.1, color, sides=6)
    size = ((14, 14.2, 4.4), (14.4, 13.4, 4.5), (13.6, 14.6, 5))[variant % 3]
    return varied_cm(b, f"a pair of {style} glasses", size, rng, {"style": style})


def cover(title: str, author: str, color: Color, ink: Color) -> Image.Image:
    """A book's front: title, an image of hills and a sun, author."""
    image, draw = paint.canvas((192, 288), color)
    draw.rectangle((10, 10, 181, 277), outline=rgb(ink), width=3)
    paint.text(draw, title, (20, 24, 172, 100), ink, bold=0.04)
    draw.ellipse((70, 118, 122, 170), fill=rgb(ink))
    draw.polygon([(24, 226), (70, 150), (110, 200), (140, 165), (168, 226)], fill=rgb(shade(color, 0.55)))
    paint.text(draw, author, (40, 238, 152, 262), ink)
    return paint.shrunk(image, (96, 144))


def spine(title: str, color: Color, ink: Color) -> Image.Image:
    """A book's back, its title reading downwards."""
    image, draw = paint.canvas((240, 40), color)
    paint.text(draw, title, (24, 6, 216, 34), ink, bold=0.03)
    return paint.shrunk(image, (120, 20)).rotate(-90, expand=True)


@recipe("book", 3, name="pocket_things.book")
def book(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Upright, spine to the front: a bound novel, a thick dictionary, one standing ajar."""
    b = MeshBuilder(roughness=0.7)
    style = ("novel", "dictionary", "open book")[variant % 3]
    title = ("THE LONG\nROAD", "WORDS\nA - Z", "CITY\nWALKS")[variant % 3]
    color: Color = ("dark blue", "dark red", "teal")[variant % 3]
    ink: Color = ("gold", "cream", "white")[variant % 3]
    deep, thick, tall = ((16.5, 2.6, 24), (17, 6, 25), (16, 2.8, 22))[variant % 3]
    front = cover(title, "A. WALKER", color, ink)
    opened = 24.0 if style == "open book" else 0.0
    for side in (-1, 1):
        with b.frame((deep / 2 - 0.3, side * thick / 2, 0), (0, 0, -side * opened)):
            b.box((deep, 0.28, tall), (-deep / 2 + 0.3, -side * 0.14, 0), color, bevel=0.05)
            where = (-deep / 2 + 0.2, side * 0.04, tall / 2)
            b.panel(
                front if side < 0 else cover(title, "", color, ink),
                where,
                deep - 0.3,
                tall - 0.2,
                "+y" if side > 0 else "-y",
            )
            if opened:
                for k in range(3):
                    with b.frame(turn_deg=(0, 0, side * (3 + 5 * k))):
                        b.box(
                            (deep - 1.2, 0.3, tall - 0.8),
                            (-deep / 2, -side * (0.5 + 0.2 * k), 0.4),
                            shade("cream", 1 - 0.06 * k),
                        )
    if not opened:
        b.box((deep - 0.9, thick - 0.5, tall - 0.8), (-0.15, 0, 0.4), "cream")
    b.add(pillow((1.4, thick + 0.02, tall), 0.9, 0.06, 14, 4), color, (deep / 2 - 0.5, 0, 0))
    b.panel(spine(title.replace("\n", " "), color, ink), (deep / 2 + 0.24, 0, tall / 2), thick * 0.7, tall * 0.8)
    size = ((16.5, 2.6, 24), (17.5, 6.2, 26), (15, 8.6, 22))[variant % 3]
    return varied_cm(b, f"a {style}", size, rng, {"style": style})


@recipe("cigarette", 3, name="pocket_things.cigarette")
def cigarette(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Filter cigarettes: a fresh one, one that burns, a brown slim one; mouth end at the back."""
    b = MeshBuilder(roughness=0.95)
    style = ("fresh", "burning", "brown slim")[variant % 3]
    paper: Color = ("#f3f0e8", "#f3f0e8", "#6b4528")[variant % 3]
    length = (84, 75, 96)[variant % 3]
    cork = skin(rng, ["#c98b4e", "#d79a5a"], noise=4, flecks=("#a86f38", 60))
    tube = painted(pillow((8, 8, 24), 1.0, 0.06, 18, 6))
    b.add(tube, image=cork, at=(0, 0, 4), turn_deg=(0, 90, 0))
    with b.frame((0, 0, 4)):
        b.cylinder(3.3, 0.4, (-0.3, 0, 0), "off white", turn_deg=(0, 90, 0), segments=16)
        b.cylinder(
            3.9, length - 24 - (12 if style == "burning" else 0), (23.6, 0, 0), paper, turn_deg=(0, 90, 0), segments=18
        )
        b.cylinder(4.02, 0.8, (23, 0, 0), "gold", turn_deg=(0, 90, 0), segments=18)
        if style == "burning":
            b.cylinder(3.95, 1.6, (length - 13.5, 0, 0), "black", turn_deg=(0, 90, 0), segments=16)
            b.cylinder(3.7, 1.6, (length - 12, 0, 0), "light red", turn_deg=(0, 90, 0), segments=16)
            b.cylinder(3.6, 10, (length - 10.6, 0, 0), "#a9a6a2", turn_deg=(0, 90, 0), top_radius=2.4, segments=9)
        else:
            b.cylinder(3.2, 0.4, (length - 0.6, 0, 0), "#7b5327", turn_deg=(0, 90, 0), segments=12)
    size = ((8.4, 0.79, 0.79), (7.5, 0.78, 0.78), (9.8, 0.62, 0.62))[variant % 3]
    return varied_cm(b, f"a {style} cigarette", size, rng, {"style": style})


def cut_stone(b: MeshBuilder, radius: float, at: tuple[float, float, float], color: Color) -> None:
    """A brilliant: table, crown and pavilion with eight facets."""
    profile = [(0.02, -radius * 0.9), (radius, 0), (radius * 0.62, radius * 0.42)]
    b.lathe(profile, at, color, segments=8, crease_deg=5.0)


@recipe("jewelry", 3, name="pocket_things.jewelry")
def jewelry(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A flower brooch, a ring with a brilliant, a pearl necklace laid down."""
    b = MeshBuilder(roughness=0.2, metallic=0.4)
    style = ("flower brooch", "diamond ring", "pearl necklace")[variant % 3]
    if style == "flower brooch":
        b.cylinder(1.6, 0.2, (0, 0, 0), "gold", segments=16)
        for k in range(6):
            with b.frame(turn_deg=(0, 0, 60 * k)):
                b.add(pillow((1.6, 1.25, 0.5), 0.9, 0.8, 12, 6), "gold", (1.15, 0, 0.2), turn_deg=(0, -14, 0))
                cut_stone(b, 0.3, (1.2, 0, 0.68), "#3f76c4")
        cut_stone(b, 0.55, (0, 0, 0.62), "#c22545")
        b.tube([(0.4, -1.2, 0.3), (1.4, -2.0, 0.4), (2.6, -2.1, 0.3)], 0.12, "gold", sides=6)
        b.add(pillow((1.2, 0.6, 0.3), 0.7, 0.8, 12, 5), "gold", (2.4, -1.7, 0.2), turn_deg=(0, 0, 30))
    elif style == "diamond ring":
        b.ring(1.0, 0.13, (0, 0, 1.1), "gold", turn_deg=(90, 0, 0), segments=28, sides=8)
        for k in range(4):
            c, s = np.cos(np.pi / 4 + np.pi / 2 * k), np.sin(np.pi / 4 + np.pi / 2 * k)
            b.tube(
                [(0.1 * c, 0.1 * s, 2.1), (0.42 * c, 0.42 * s, 2.55), (0.36 * c, 0.36 * s, 2.72)], 0.06, "gold", sides=5
            )
        cut_stone(b, 0.5, (0, 0, 2.58), "#dff1fa")
        for side in (-1, 1):
            cut_stone(b, 0.16, (side * 0.5, 0, 2.1), "#dff1fa")
    else:
        for k in range(28):
            a = 2 * np.pi * k / 28
            r = 7.4 * (1 + 0.05 * np.sin(3 * a + 1))
            if k:
                b.ball(
                    0.66 + 0.12 * np.cos(a), (r * np.cos(a), 0.86 * r * np.sin(a), 0.7), "#f2ebe0", segments=8, rings=5
                )
        b.ball((0.5, 0.9, 0.45), (7.5, 0, 0.5), "gold", segments=10, rings=6)
    size = ((4.5, 3.5, 1.5), (2.3, 1.05, 3.0), (18, 15.4, 1.5))[variant % 3]
    return varied_cm(b, f"a {style}", size, rng, {"style": style})


def dial(color: Color, ink: Color, digital: bool) -> Image.Image:
    """A watch face at ten past ten, or digits."""
    image, draw = paint.canvas((192, 192), color)
    if digital:
        paint.text(draw, "10:10", (20, 40, 172, 110), ink, bold=0.05)
        draw.rectangle((30, 130, 160, 146), fill=rgb("light green"))
        return paint.shrunk(image, (64, 64))
    for k in range(12):
        c, s = np.cos(np.radians(30 * k)), np.sin(np.radians(30 * k))
        draw.line((96 + 70 * c, 96 + 70 * s, 96 + 86 * c, 96 + 86 * s), fill=rgb(ink), width=8)
    for clock_deg, reach, wide in ((-55, 46, 12), (60, 66, 8)):
        c, s = np.cos(np.radians(clock_deg)), np.sin(np.radians(clock_deg))
        draw.line((96, 96, 96 + reach * s, 96 - reach * c), fill=rgb(ink), width=wide)
    draw.ellipse((88, 88, 104, 104), fill=rgb("red"))
    return paint.shrunk(image, (64, 64))


@recipe("watches", 3, name="pocket_things.watches")
def watches(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Closed on their sides, dial to the front: steel band, leather strap, square digital."""
    b = MeshBuilder(roughness=0.25, metallic=0.5 if variant == 0 else 0.1)
    style = ("steel", "leather", "digital")[variant % 3]
    case: Color = ("galvanised", "gold", "charcoal")[variant % 3]
    band: Color = ("aluminium", "#6b3f22", "black")[variant % 3]
    half = 1.0
    for k in range(22):
        a = np.radians(28 + (360 - 56) * k / 21)
        at = (2.45 * np.cos(a) - 0.1, 2.9 * np.sin(a), -half)
        link = 0.72 if style == "steel" else 0.86
        b.box(
            (0.34, link, 2 * half),
            at,
            band if k % 2 or style != "steel" else shade(band, 0.72),
            turn_deg=(0, 0, np.degrees(a)),
            bevel=0.06,
        )
    if style == "digital":
        b.box((0.9, 3.6, 4.2), (2.5, 0, 0), case, bevel=0.35, centered=True)
        b.panel(dial("#b7c4a8", "black", True), (2.98, 0, 0), 2.6, 2.6)
        for y in (-1.9, 1.9):
            for z in (-1, 1):
                b.box((0.4, 0.3, 0.5), (2.5, y, z), "aluminium", centered=True)
    else:
        b.cylinder(2.1, 0.8, (2.2, 0, 0), case, turn_deg=(0, 90, 0), segments=28)
        b.ring(1.9, 0.18, (3.0, 0, 0), case, turn_deg=(0, 90, 0), segments=28, sides=6)
        points = arc(1.75, 0, 345, 24)
        b.plate(
            [(float(y), float(z)) for y, z in points],
            0.06,
            (3.03, 0, 0),
            dial(("#1e3350", "white")[variant % 2], ("white", "black")[variant % 2], False),
            case,
        )
        b.cylinder(0.35, 0.5, (2.6, 0, 2.05), case, segments=10)
        for y in (-2.0, 2.0):
            b.box((0.7, 0.9, 1.9), (2.25, y, 0), case, centered=True, bevel=0.1)
    b.box((0.6, 1.6, 2.3), (-2.55, 0, 0), case, centered=True, bevel=0.15)
    size = ((5.5, 6.4, 5.1), (5.3, 6.2, 4.6), (5.8, 6.8, 4.4))[variant % 3]
    return varied_cm(b, f"a {style} watch", size, rng, {"style": style})
