"""Upright boxes of a street: cabinets, vending machines, letter boxes, newspaper stands."""

import numpy as np
from PIL import Image, ImageDraw

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, rgb, shade
from ...meshes.recipe import Physics, recipe

CABINET = Physics(
    ("steel", "plastic"),
    260.0,
    (45.0, 400.0),
    0.5,
    False,
    "steel and polycarbonate cabinets weigh 60-250 kg on a concrete footing",
)


def door_image(width: int, height: int, color: Color, doors: int = 1) -> Image.Image:
    """Cabinet doors with seams, louvres and a handle."""
    image, draw = paint.canvas((width, height), color)
    dark, light = rgb(shade(color, 0.62)), rgb(shade(color, 1.15))
    for k in range(doors):
        left, right = k * width // doors, (k + 1) * width // doors - 1
        draw.rectangle((left + 2, 2, right - 2, height - 3), outline=dark)
        draw.rectangle((left + 3, 3, right - 3, height - 4), outline=light)
        for y in (*range(8, 18, 3), *range(height - 18, height - 8, 3)):
            draw.line((left + 8, y, right - 8, y), fill=dark)
        draw.rectangle((right - 9, height // 2 - 6, right - 6, height // 2 + 6), fill=(24, 24, 24))
    return image


@recipe("street cabinet", 4, CABINET, hulls=1, name="cabinets.street_cabinet")
def street_cabinet(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Telecom, traffic-signal, electricity and graffiti-covered double cabinets; doors at +x."""
    b = MeshBuilder(roughness=0.7)
    style = ("telecom", "traffic signal", "electricity", "painted")[variant % 4]
    color = ("dark green", "galvanised", "off white", "grey")[variant % 4]
    w, h, d = (float(v) for v in rng.uniform((0.7, 1.05, 0.36), (1.2, 1.4, 0.45)))
    if style == "traffic signal":
        w, h, d = 0.65, 1.45, 0.42
    image = door_image(64, 80, color, 1 if w < 0.8 else 2)
    draw = ImageDraw.Draw(image)
    if style == "electricity":
        draw.polygon([(16, 24), (26, 42), (6, 42)], fill=rgb("signal yellow"), outline=(0, 0, 0))
        draw.line((16, 28, 14, 34, 18, 34, 16, 40), fill=(0, 0, 0), width=2)
    if style == "painted":
        for k in range(9):
            x, y, r = (int(v) for v in rng.uniform((4, 14, 5), (58, 66, 14)))
            ink = rgb(("pink", "teal", "signal yellow", "purple", "light blue")[k % 5])
            draw.arc((x - r, y - r, x + r, y + r), 0, int(rng.uniform(120, 360)), fill=ink, width=4)
    b.box((d + 0.06, w + 0.06, 0.12), color="concrete")
    b.box((d, w, h - 0.16), (0, 0, 0.12), color, bevel=0.01, skins={"+x": image})
    b.box((d + 0.05, w + 0.05, 0.04), (0, 0, h - 0.04), shade(color, 0.85), bevel=0.012)
    return b.build(f"a {style} street cabinet", {"style": style})


VENDING = Physics(
    ("steel", "glass"),
    190.0,
    (180.0, 420.0),
    0.5,
    False,
    "drinks machines weigh 200-400 kg and are anchored against tipping",
)


def _bottles(rng: np.random.Generator, width: int, height: int, rows: int, columns: int) -> Image.Image:
    image, draw = paint.canvas((width, height), (22, 26, 34))
    inks = ("red", "signal yellow", "green", "light blue", "orange", "white", "purple", "lime")
    for r in range(rows):
        y = int((r + 1) * height / rows) - 3
        draw.rectangle((0, y, width, y + 2), fill=(150, 152, 156))
        for c in range(columns):
            x = int((c + 0.5) * width / columns)
            ink = rgb(inks[int(rng.integers(len(inks)))])
            size = int(height / rows * 0.55)
            draw.rectangle((x - 3, y - size, x + 3, y - 1), fill=ink)
            draw.rectangle((x - 1, y - size - 3, x + 1, y - size), fill=rgb("white"))
    return image


@recipe("vending machine", 3, VENDING, hulls=1, name="cabinets.vending_machine")
def vending_machine(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Drinks machine with lit display, snack machine with glass front, bright branded cooler; front +x."""
    b = MeshBuilder(roughness=0.35)
    style = ("drinks", "snacks", "coffee")[variant % 3]
    color = ("red", "charcoal", "blue")[variant % 3]
    w, d, h = float(rng.uniform(0.9, 1.05)), 0.8, float(rng.uniform(1.78, 1.88))
    image, draw = paint.canvas((96, 176), color)
    if style == "coffee":
        paint.text(draw, "COFFEE", (8, 8, 88, 32), "cream", bold=0.04)
        draw.rectangle((20, 48, 76, 96), fill=rgb("cream"))
        draw.polygon([(34, 62), (62, 62), (58, 88), (38, 88)], fill=rgb("brown"))
        draw.arc((58, 66, 72, 80), -90, 90, fill=rgb("brown"), width=3)
        for k in range(6):
            draw.rectangle(
                (22 + 20 * (k % 3), 104 + 12 * (k // 3), 34 + 20 * (k % 3), 112 + 12 * (k // 3)), fill=rgb("white")
            )
        draw.rectangle((24, 134, 72, 166), fill=(20, 20, 22))
    else:
        image.paste(_bottles(rng, 64, 120, 5 if style == "drinks" else 6, 6), (6, 22))
        paint.text(draw, "COLD DRINKS" if style == "drinks" else "SNACKS", (6, 4, 90, 19), "white", bold=0.04)
        draw.rectangle((74, 50, 91, 62), fill=rgb("light green"))
        for k in range(12):
            draw.rectangle(
                (74 + 6 * (k % 3), 68 + 6 * (k // 3), 78 + 6 * (k % 3), 72 + 6 * (k // 3)), fill=rgb("light grey")
            )
        draw.rectangle((78, 100, 88, 104), fill=(10, 10, 10))
        draw.rectangle((10, 150, 66, 168), fill=(20, 20, 22))
        draw.rectangle((10, 150, 66, 153), fill=rgb("grey"))
    b.box((d, w, h - 0.06), (0, 0, 0.06), color, bevel=0.015, skins={"+x": image})
    b.box((d - 0.1, w - 0.08, 0.06), color="black")
    return b.build(f"a {style} vending machine", {"style": style})


LETTERS = Physics(
    ("steel", "cast iron"),
    500.0,
    (8.0, 130.0),
    0.5,
    False,
    "house mailboxes weigh 5-25 kg with their post, collection boxes 60-130 kg; footed",
)


@recipe("mailbox", 3, LETTERS, hulls=2, name="cabinets.mailbox")
def mailbox(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Tunnel-shaped rural mailbox on a post, blue collection box, wall-style box on a stand. Door +x."""
    b = MeshBuilder(roughness=0.45)
    style = ("rural", "collection", "modern stand")[variant % 3]
    if style == "rural":
        color = ("white", "black", "dark red")[int(rng.integers(3))]
        b.box((0.1, 0.1, 1.05), (-0.1, 0, 0), "wood")
        b.beam((-0.1, 0, 0.7), (0.12, 0, 1.0), 0.06, 0.06, "wood")
        arch = [
            (-0.09, 0),
            (0.09, 0),
            (0.09, 0.13),
            *[(0.09 * np.cos(a), 0.13 + 0.09 * np.sin(a)) for a in np.linspace(0, np.pi, 9)[1:-1]],
            (-0.09, 0.13),
        ]
        with b.frame((-0.25, 0, 1.05)):
            b.extrude(arch, 0.5, color=color, turn_deg=(90, 0, 90))
            b.box((0.015, 0.06, 0.025), (0.505, 0, 0.17), "aluminium")
            b.box((0.02, 0.012, 0.2), (0.38, 0.096, 0.1), "signal red")
            b.box((0.08, 0.012, 0.06), (0.35, 0.096, 0.24), "signal red")
    elif style == "collection":
        color = "signal blue"
        profile = [
            (-0.27, 0.2),
            (0.27, 0.2),
            (0.27, 0.95),
            *[(0.27 * np.cos(a), 0.95 + 0.32 * np.sin(a)) for a in np.linspace(0, np.pi, 9)[1:-1]],
            (-0.27, 0.95),
        ]
        b.profile(profile, 0.5, color=color)
        for x in (-0.23, 0.23):
            for y in (-0.21, 0.21):
                b.box((0.06, 0.05, 0.22), (x, y, 0), color)
        b.box((0.02, 0.4, 0.2), (0.255, 0, 0.98), shade(color, 0.7), turn_deg=(0, -16, 0))
        b.rod((0.3, -0.12, 1.05), (0.3, 0.12, 1.05), 0.012, "aluminium", sides=6)
        image, draw = paint.canvas((64, 40), "white")
        paint.text(draw, "MAIL", (4, 4, 60, 26), "signal blue", bold=0.06)
        draw.rectangle((4, 30, 60, 35), fill=rgb("signal red"))
        b.panel(image, (0.273, 0, 0.68), 0.34, 0.21)
    else:
        b.box((0.06, 0.06, 1.2), (-0.05, -0.12, 0), "charcoal")
        b.box((0.06, 0.06, 1.2), (-0.05, 0.12, 0), "charcoal")
        b.box((0.2, 0.4, 0.34), (0, 0, 0.82), "light grey", bevel=0.01)
        b.box((0.24, 0.42, 0.03), (0.01, 0, 1.15), "charcoal", turn_deg=(0, 6, 0))
        b.box((0.01, 0.28, 0.03), (0.1, 0, 1.08), "black")
        b.cylinder(0.012, 0.01, (0.1, 0.12, 0.95), "brass", turn_deg=(0, 90, 0), segments=8)
    return b.build(f"a {style} mailbox", {"style": style})


@recipe("postbox", 3, LETTERS, hulls=2, name="cabinets.postbox")
def postbox(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Red pillar box, yellow box on a stand, blue-grey modern box; slot at +x."""
    b = MeshBuilder(roughness=0.4)
    style = ("pillar", "yellow stand", "modern")[variant % 3]
    if style == "pillar":
        r, h = float(rng.uniform(0.22, 0.25)), float(rng.uniform(1.5, 1.6))
        b.cylinder(r + 0.03, 0.16, color="black", segments=22)
        b.cylinder(r, h - 0.28, (0, 0, 0.14), "signal red", segments=22)
        b.cylinder(r + 0.035, 0.06, (0, 0, h - 0.2), "signal red", segments=22)
        b.lathe([(r + 0.02, h - 0.14), (r * 0.8, h - 0.05), (0, h)], color="signal red", segments=22)
        b.box((0.05, 0.26, 0.09), (r - 0.01, 0, h - 0.34), "signal red", bevel=0.01)
        b.box((0.02, 0.2, 0.035), (r + 0.032, 0, h - 0.315), "black")
        image, draw = paint.canvas((48, 64), "white")
        paint.text(draw, "POST\nTIMES", (5, 4, 43, 30), "black", bold=0.03)
        for k in range(4):
            draw.line((6, 38 + 6 * k, 42, 38 + 6 * k), fill=(90, 90, 90), width=2)
        b.panel(image, (r + 0.004, 0, h - 0.52), 0.15, 0.2)
    elif style == "yellow stand":
        b.box((0.12, 0.12, 0.6), color="charcoal")
        b.box((0.35, 0.45, 0.03), color="charcoal")
        profile = [(-0.17, 0.6), (0.17, 0.6), (0.17, 1.16), (0.1, 1.24), (-0.17, 1.27)]
        b.profile(profile, 0.46, color="signal yellow")
        image, draw = paint.canvas((64, 64), "signal yellow")
        draw.arc((16, 6, 48, 38), 150, 390, fill=(0, 0, 0), width=5)
        paint.text(draw, "POST", (6, 40, 58, 60), "black", bold=0.05)
        b.panel(image, (0.173, 0, 0.84), 0.32, 0.32)
        b.box((0.03, 0.36, 0.05), (0.165, 0, 1.08), "black")
    else:
        b.box((0.42, 0.5, 1.25), color="signal blue", bevel=0.04)
        b.box((0.44, 0.52, 0.1), color="charcoal", bevel=0.02)
        b.box((0.03, 0.4, 0.05), (0.205, 0, 1.0), "black")
        b.box((0.05, 0.44, 0.03), (0.215, 0, 1.06), "light grey")
        image, draw = paint.canvas((64, 48), "white")
        draw.rectangle((8, 8, 56, 40), outline=rgb("signal blue"), width=3)
        draw.line((8, 8, 32, 28, 56, 8), fill=rgb("signal blue"), width=3)
        b.panel(image, (0.214, 0, 0.7), 0.3, 0.22)
    return b.build(f"a {style} postbox", {"style": style})


STAND = Physics(
    ("steel", "plastic"),
    190.0,
    (15.0, 70.0),
    0.5,
    True,
    "newspaper boxes weigh 25-45 kg with ballast, wire racks 15 kg",
)


def front_page(width: int, height: int, rng: np.random.Generator, title: str = "DAILY") -> Image.Image:
    image, draw = paint.canvas((width, height), "off white")
    paint.text(draw, title, (3, 2, width - 3, height * 0.22), "black", bold=0.03)
    draw.rectangle((3, height * 0.28, width * 0.6, height * 0.62), fill=tuple(int(v) for v in rng.uniform(60, 180, 3)))
    for y in range(int(height * 0.28), height - 3, 4):
        left = 3 if y > height * 0.64 else int(width * 0.65)
        draw.line((left, y, width - 4, y), fill=(130, 130, 130))
    return image


@recipe("newspaper stand", 3, STAND, hulls=2, name="cabinets.newspaper_stand")
def newspaper_stand(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Coin box with window, twin boxes, sloped display rack; front +x."""
    b = MeshBuilder(roughness=0.5)
    style = ("box", "twin box", "rack")[variant % 3]
    if style != "rack":
        colors = (("blue",), ("red", "signal yellow"))[style == "twin box"]
        for k, color in enumerate(colors):
            with b.frame((0, 0.46 * (k - (len(colors) - 1) / 2), 0)):
                b.box((0.34, 0.4, 0.04), color="black")
                b.box((0.1, 0.1, 0.35), (0, 0, 0.03), "black")
                b.box((0.4, 0.42, 0.62), (0, 0, 0.38), color, bevel=0.02)
                b.panel(front_page(48, 56, rng), (0.204, 0, 0.74), 0.32, 0.36)
                b.box((0.03, 0.2, 0.03), (0.21, 0, 0.46), "aluminium")
                b.box((0.16, 0.16, 0.12), (0.08, 0, 1.0), shade(color, 0.7), bevel=0.01)
    else:
        for y in (-0.45, 0.45):
            b.beam((0.25, y, 0), (-0.2, y, 1.3), 0.04, 0.04, "charcoal")
            b.beam((-0.3, y, 0), (-0.15, y, 1.15), 0.04, 0.04, "charcoal")
        pages = [front_page(32, 40, rng, t) for t in ("NEWS", "SPORT", "CITY", "STYLE", "LIFE")]
        for row in range(3):
            z, x = 0.35 + 0.36 * row, 0.13 - 0.125 * row
            b.box((0.1, 0.94, 0.02), (x + 0.04, 0, z - 0.02), "charcoal")
            for k in range(4):
                b.panel(
                    pages[(row + k) % 5],
                    (x - 0.02, -0.34 + 0.227 * k, z + 0.14),
                    0.2,
                    0.27,
                    back="off white",
                    tilt_deg=19.0,
                )
    return b.build(f"a newspaper {style}", {"style": style})


def poster(width: int, height: int, rng: np.random.Generator, style: int) -> Image.Image:
    """An invented advertisement."""
    back, ink, spot = (
        ("teal", "white", "signal yellow"),
        ("signal yellow", "black", "red"),
        ("dark blue", "cream", "orange"),
    )[style % 3]
    image, draw = paint.canvas((width, height), back)
    c, r = (width * float(rng.uniform(0.35, 0.65)), height * 0.45), width * 0.3
    draw.ellipse((c[0] - r, c[1] - r, c[0] + r, c[1] + r), fill=rgb(spot))
    draw.polygon([(0, height), (0, height * 0.75), (width, height * 0.6), (width, height)], fill=rgb(shade(back, 0.75)))
    words = ("SUMMER\nSALE", "FRESH\nCOFFEE", "CITY\nFESTIVAL", "NEW\nALBUM")[int(rng.integers(4))]
    paint.text(draw, words, (width * 0.08, height * 0.05, width * 0.92, height * 0.34), ink, bold=0.04)
    paint.text(draw, "www.example.org", (width * 0.1, height * 0.86, width * 0.9, height * 0.95), ink)
    return image
