"""Boards and clocks on a pavement: bulletin boards, information points, clocks; faces at +x."""

import numpy as np
from PIL import Image, ImageDraw

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, rgb
from ...meshes.recipe import recipe
from ..shared.facade_images import sign
from ..shared.sizes import made


def notices(size: tuple[int, int], back: Color, rng: np.random.Generator, count: int = 9) -> Image.Image:
    """Papers of several colours pinned to a board."""
    image = paint.speckled((size[0] * 2, size[1] * 2), back, rng, 9.0)
    draw = ImageDraw.Draw(image)
    w, h = image.size
    columns = max(2, round((count * w / h) ** 0.5))
    rows = -(-count // columns)
    inks = ("white", "off white", "signal yellow", "light blue", "pink", "white", "lime", "orange")
    for k in range(count):
        c, r = k % columns, k // columns
        x = (c + 0.14 + float(rng.uniform(0, 0.1))) * w / columns
        y = (r + 0.12 + float(rng.uniform(0, 0.1))) * h / rows
        pw, ph = w / columns * float(rng.uniform(0.62, 0.74)), h / rows * float(rng.uniform(0.62, 0.74))
        draw.rectangle((x + 3, y + 3, x + pw + 3, y + ph + 3), fill=(60, 44, 30))
        draw.rectangle((x, y, x + pw, y + ph), fill=rgb(inks[int(rng.integers(len(inks)))]))
        draw.rectangle((x + pw * 0.15, y + ph * 0.12, x + pw * 0.85, y + ph * 0.24), fill=(40, 42, 60))
        if k % 3 == 1:
            tone = tuple(int(v) for v in rng.uniform(60, 190, 3))
            draw.rectangle((x + pw * 0.15, y + ph * 0.34, x + pw * 0.85, y + ph * 0.7), fill=tone)
        for line in range(3 if k % 3 == 1 else 6):
            level = y + ph * ((0.76 if k % 3 == 1 else 0.36) + 0.09 * line)
            draw.line((x + pw * 0.15, level, x + pw * 0.8, level), fill=(120, 120, 124), width=2)
        draw.ellipse((x + pw / 2 - 4, y + 1, x + pw / 2 + 4, y + 9), fill=rgb(("red", "signal blue")[k % 2]))
    return image.resize(size, Image.Resampling.LANCZOS)


def town_map(size: tuple[int, int], rng: np.random.Generator) -> Image.Image:
    """A street plan with a river, a park and a mark for where one stands."""
    w, h = size[0] * 3, size[1] * 3
    image, draw = paint.canvas((w, h), "#efe6cf")
    draw.polygon(
        [(w * 0.62, h * 0.1), (w * 0.95, h * 0.16), (w * 0.9, h * 0.42), (w * 0.6, h * 0.38)], fill=(150, 198, 120)
    )
    river = [(w * x, h * (0.75 + 0.13 * np.sin(5 * x))) for x in np.linspace(-0.05, 1.05, 24)]
    draw.line(river, fill=(120, 178, 218), width=w // 14)
    for k in range(4):
        y, x = h * (0.12 + 0.2 * k) + float(rng.uniform(-8, 8)), w * (0.12 + 0.24 * k)
        draw.line((0, y, w, y + float(rng.uniform(-24, 24))), fill=(255, 255, 255), width=7)
        draw.line(
            (x, 0, x + float(rng.uniform(-24, 24)), h), fill=(250, 208, 110) if k == 1 else (255, 255, 255), width=8
        )
    for _ in range(10):
        x, y = float(rng.uniform(0.04, 0.5)) * w, float(rng.uniform(0.04, 0.6)) * h
        draw.rectangle((x, y, x + 20, y + 14), fill=(206, 176, 150))
    draw.ellipse(
        (w * 0.44 - 12, h * 0.46 - 12, w * 0.44 + 12, h * 0.46 + 12),
        fill=rgb("signal red"),
        outline=(255, 255, 255),
        width=4,
    )
    draw.rectangle((0, 0, w - 1, h - 1), outline=(70, 70, 70), width=5)
    return paint.shrunk(image, size)


@recipe("bulletin board", 3, name="notices.bulletin_board")
def bulletin_board(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A glazed aluminium case, a roofed one on two posts, a cork board in a wooden frame."""
    b = MeshBuilder(roughness=0.6)
    if variant % 3 == 1:
        for y in (-0.82, 0.82):
            b.box((0.1, 0.1, 2.0), (0, y, 0), "dark wood", bevel=0.01)
        b.box((0.08, 1.56, 1.05), (0, 0, 0.85), "wood", bevel=0.01)
        b.box((0.12, 1.6, 0.06), (0, 0, 0.8), "dark wood", bevel=0.01)
        b.panel(notices((128, 80), "#c79a63", rng, 12), (0.043, 0, 1.37), 1.42, 0.92)
        b.panel(sign("PARISH NEWS", "dark wood", "cream", (128, 16)), (0.046, 0, 1.87), 1.5, 0.12)
        for side in (-1, 1):
            b.convex(
                [(side * s, y, z) for y in (-1.0, 1.0) for s, z in ((0, 2.2), (0, 2.15), (0.2, 2.0), (0.2, 1.96))],
                "terracotta",
            )
        return made(b, "a roofed notice board on two posts", (0.4, 2.0, 2.2), style="roofed")
    color, back, size = (("aluminium", "#b98d58", (0.1, 1.2, 1.1)), ("light wood", "#a87443", (0.05, 0.95, 0.7)))[
        variant // 2
    ]
    depth, w, h = size
    count = 9 if variant % 3 == 0 else 6
    b.box((depth * 0.5, w - 0.02, h - 0.02), (-depth * 0.2, 0, 0.01), "dark grey" if count == 9 else "brown")
    b.panel(
        notices((128, 112) if count == 9 else (112, 84), back, rng, count), (depth * 0.06, 0, h / 2), w - 0.1, h - 0.1
    )
    edge = 0.055
    for side in (-1, 1):
        b.box((depth, edge, h), (0, side * (w - edge) / 2, 0), color, bevel=0.008)
        b.box((depth, w - 2 * edge, edge), (0, 0, (h - edge) if side > 0 else 0), color, bevel=0.008)
    if count == 9:
        b.box((depth + 0.02, w, 0.09), (0, 0, h - 0.08), color, bevel=0.01)
        b.panel(sign("NOTICES", "signal blue", "white", (96, 14)), (depth / 2 + 0.012, 0, h - 0.035), 0.5, 0.075)
        b.box((depth * 0.7, 0.025, h - 0.16), (0.01, 0, 0.05), color)
        for z in (0.45, 0.6):
            b.cylinder(
                0.012, 0.014, (depth / 2, 0.03 if z > 0.5 else -0.03, z), "black", turn_deg=(0, 90, 0), segments=8
            )
    else:
        for sy in (-1, 1):
            for sz in (0.03, h - 0.03):
                b.cylinder(0.01, 0.006, (depth / 2, sy * (w / 2 - 0.03), sz), "brass", turn_deg=(0, 90, 0), segments=8)
        b.rod((0, -0.2, h), (0, 0.2, h), 0.008, "brass", sides=6)
    return made(b, f"a {color} notice board", size, style=("case", "cork")[variant // 2])


def info_mark(back: Color = "signal blue", ink: Color = "white") -> Image.Image:
    """A white i."""
    image, draw = paint.canvas((192, 192), back)
    draw.ellipse((80, 22, 116, 58), fill=rgb(ink))
    draw.polygon(
        [(66, 76), (116, 76), (116, 148), (132, 148), (132, 168), (64, 168), (64, 148), (80, 148), (80, 96), (66, 96)],
        fill=rgb(ink),
    )
    return paint.shrunk(image, (48, 48))


@recipe("information point", 3, name="notices.information_point")
def information_point(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A map board with an i on top, a dark stele with map and screen, a staffed booth."""
    b = MeshBuilder(roughness=0.5)
    plan = town_map((128, 96), rng)
    if variant % 3 == 0:
        for y in (-0.5, 0.5):
            b.cylinder(0.04, 1.8, (0, y, 0), "charcoal", segments=14)
            b.lathe([(0.125, 0), (0.125, 0.02), (0.05, 0.04), (0.042, 0.12)], (0, y, 0), "charcoal", segments=14)
        b.box((0.07, 1.06, 0.95), (0, 0, 0.8), "signal blue", bevel=0.012, skins={"+x": plan, "-x": plan})
        b.box((0.12, 1.1, 0.06), (0, 0, 1.75), "charcoal", bevel=0.01)
        b.box((0.09, 0.4, 0.4), (0, 0, 1.8), "signal blue", bevel=0.01, skins={"+x": info_mark(), "-x": info_mark()})
        return made(b, "a town map with an i above it", (0.25, 1.1, 2.2), style="map board")
    if variant % 3 == 1:
        b.box((0.34, 0.72, 0.05), color="dark concrete")
        b.box((0.2, 0.66, 2.5), (0, 0, 0.05), "charcoal", bevel=0.02)
        b.panel(info_mark("signal yellow", "black"), (0.103, 0, 2.24), 0.5, 0.5)
        tall = paint.shrunk(plan.rotate(90, expand=True), (72, 96))
        b.panel(tall, (0.103, 0, 1.42), 0.58, 0.8)
        b.panel(sign("CITY CENTRE", "charcoal", "white", (96, 16)), (0.103, 0, 1.9), 0.58, 0.1)
        for k, words in enumerate(("< Station", "Museum >", "< Market")):
            b.panel(sign(words, "charcoal", "signal yellow", (80, 14)), (0.103, 0, 0.86 - 0.14 * k), 0.54, 0.1)
        for y in (-0.34, 0.34):
            b.box((0.22, 0.03, 2.46), (0, y, 0.05), "signal yellow", bevel=0.008)
        for k in range(4):
            b.cylinder(0.012, 0.01, (0.1, 0.3 * (-1) ** k, 0.25 + 0.2 * (k // 2)), "black", (0, 90, 0), segments=8)
        return made(b, "a dark information stele", (0.32, 0.75, 2.6), style="stele")
    b.box((1.6, 2.2, 0.1), color="concrete", bevel=0.02)
    for y in (-0.7, 0.7):
        b.box((0.02, 0.5, 0.3), (0.74, y, 1.08), "white", turn_deg=(0, -20, 0), bevel=0.005)
    b.box((0.4, 0.45, 0.08), (0.0, 0.1, 0.55), "charcoal", bevel=0.03)
    b.box((1.3, 0.08, 2.3), (-0.1, -1.04, 0.1), "white")
    b.box((1.3, 0.08, 2.3), (-0.1, 1.04, 0.1), "white")
    b.panel(info_mark(), (-0.1, 1.083, 1.6), 0.8, 0.8, "+y")
    b.box((0.08, 2.1, 2.3), (-0.75, 0, 0.1), "white")
    b.panel(plan, (-0.7, 0, 1.6), 1.7, 1.1)
    b.box(
        (0.5, 2.1, 0.9),
        (0.5, 0, 0.1),
        "signal blue",
        skins={"+x": sign("i  INFORMATION", "signal blue", "white", (128, 44))},
    )
    b.box((0.62, 2.2, 0.05), (0.5, 0, 1.0), "light wood", bevel=0.01)
    b.box((1.9, 2.4, 0.14), (0, 0, 2.4), "signal blue", bevel=0.02)
    b.panel(sign("TOURIST INFO", "signal blue", "white", (160, 14)), (0.952, 0, 2.47), 2.0, 0.13)
    b.box((0.1, 0.5, 0.5), (0, 0, 2.54), "signal blue", skins={"+x": info_mark(), "-x": info_mark()})
    return made(b, "a staffed information booth", (1.9, 2.4, 3.05), 0.5, style="booth")


def clock_face(roman: bool, hour: float, back: Color = "white") -> Image.Image:
    """A dial with its hands at `hour`."""
    n = 320
    image, draw = paint.canvas((n, n), "charcoal")
    draw.ellipse((6, 6, n - 6, n - 6), fill=rgb(back), outline=(20, 20, 20), width=8)
    names = ("XII", "I", "II", "III", "IV", "V", "VI", "VII", "VIII", "IX", "X", "XI")
    for k in range(12):
        c, s = float(np.sin(np.pi * k / 6)), -float(np.cos(np.pi * k / 6))
        if roman:
            x, y = n / 2 + 118 * c, n / 2 + 118 * s
            paint.text(draw, names[k], (x - 26, y - 17, x + 26, y + 17), "black", bold=0.03)
        else:
            inner = 100 if k % 3 == 0 else 118
            draw.line(
                (n / 2 + inner * c, n / 2 + inner * s, n / 2 + 142 * c, n / 2 + 142 * s), fill=(20, 20, 20), width=12
            )
    for turn, length, width in ((hour / 12, 78, 14), (hour % 1.0, 118, 9)):
        c, s = float(np.sin(2 * np.pi * turn)), -float(np.cos(2 * np.pi * turn))
        draw.line(
            (n / 2 - 18 * c, n / 2 - 18 * s, n / 2 + length * c, n / 2 + length * s), fill=(10, 10, 10), width=width
        )
    draw.ellipse((n / 2 - 12, n / 2 - 12, n / 2 + 12, n / 2 + 12), fill=(10, 10, 10))
    return paint.shrunk(image, (80, 80))


def _drum(b: MeshBuilder, z: float, radius: float, depth: float, color: Color, image: Image.Image) -> None:
    """A round clock whose two dials look along +x and -x."""
    b.cylinder(radius, depth, (-depth / 2, 0, z), color, turn_deg=(0, 90, 0), segments=28)
    outline = [(0.88 * radius * float(np.cos(a)), 0.88 * radius * float(np.sin(a))) for a in np.arange(28) * np.pi / 14]
    b.plate(outline, depth + 0.01, (0, 0, z), image, color, both_faces=True)
    for x in (-depth / 2, depth / 2):
        b.ring(radius * 0.94, radius * 0.07, (x, 0, z), color, (0, 90, 0), segments=28, sides=6)


@recipe("street clock", 3, name="notices.street_clock")
def street_clock(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A cast-iron column with a round head, a lantern of four dials, a modern disc on a slender mast."""
    b = MeshBuilder(roughness=0.5)
    hour = float(rng.uniform(9.5, 11.0))
    if variant % 3 == 0:
        profile = [
            (0.27, 0),
            (0.27, 0.12),
            (0.2, 0.16),
            (0.2, 0.7),
            (0.23, 0.74),
            (0.12, 0.84),
            (0.08, 1.1),
            (0.065, 2.7),
        ]
        b.lathe([*profile, (0.11, 2.78), (0.08, 2.86), (0.14, 3.08), (0.1, 3.16)], color="dark green", segments=16)
        b.ring(0.1, 0.03, (0, 0, 1.2), "gold", segments=16, sides=6)
        for side in (-1, 1):
            curl = [(0, side * 0.08, 2.7), (0, side * 0.3, 2.85), (0, side * 0.34, 3.05), (0, side * 0.2, 3.1)]
            b.tube(curl, 0.022, "dark green", sides=6)
        _drum(b, 3.55, 0.43, 0.3, "dark green", clock_face(True, hour, "cream"))
        b.lathe([(0.12, 3.97), (0.16, 4.02), (0.06, 4.08), (0.05, 4.14), (0, 4.28)], color="gold", segments=12)
        return made(b, "a cast-iron street clock with two dials", (0.55, 0.9, 4.2), style="cast iron")
    if variant % 3 == 1:
        b.box((0.6, 0.6, 0.12), color="granite")
        b.box((0.4, 0.4, 0.6), (0, 0, 0.12), "black", bevel=0.02, taper=(0.7, 0.7))
        b.lathe([(0.12, 0.7), (0.09, 0.8), (0.08, 2.4), (0.14, 2.5), (0.2, 2.62)], color="black", segments=12)
        dial = clock_face(True, hour)
        b.box(
            (0.68, 0.68, 0.68), (0, 0, 2.62), "black", bevel=0.015, skins=dict.fromkeys(("+x", "-x", "+y", "-y"), dial)
        )
        b.box((0.78, 0.78, 0.07), (0, 0, 3.3), "black", bevel=0.02)
        b.convex([(0.36 * x, 0.36 * y, 3.37) for x in (-1, 1) for y in (-1, 1)] + [(0, 0, 3.68)], "verdigris")
        b.ball(0.05, (0, 0, 3.7), "gold")
        return made(b, "a street clock with four dials", (0.8, 0.8, 3.7), style="four dials")
    b.lathe([(0.2, 0), (0.2, 0.03), (0.08, 0.05), (0.07, 0.5)], color="dark grey", segments=18)
    b.cylinder(0.06, 4.3, color="galvanised", segments=16)
    _drum(b, 4.75, 0.55, 0.22, "charcoal", clock_face(False, hour))
    b.box((0.1, 0.7, 0.2), (0, 0, 3.5), "signal blue", skins={"+x": sign("CENTRAL", "signal blue", "white", (64, 18))})
    return made(b, "a modern street clock on a mast", (0.4, 1.2, 5.35), style="modern")
