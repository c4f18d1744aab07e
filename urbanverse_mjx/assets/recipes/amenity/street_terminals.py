"""Steel boxes with doors and screens: parcel and storage lockers, cash and payment machines, control cabinets."""

import numpy as np
from PIL import Image

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, rgb, shade
from ...meshes.recipe import recipe
from ..shared.facade_images import sign
from ..shared.sizes import made
from .cabinets import door_image


def screen_image(title: str, back: Color, lines: int = 3, size: tuple[int, int] = (64, 48)) -> Image.Image:
    """A lit touch screen with a heading and rows of buttons."""
    image, draw = paint.canvas(size, back)
    w, h = size
    paint.text(draw, title, (3, 2, w - 3, h * 0.32), "white", bold=0.03)
    for k in range(lines):
        top = h * (0.4 + 0.56 * k / lines)
        for left in (0.06, 0.54):
            draw.rectangle((w * left, top, w * (left + 0.4), top + h * 0.4 / lines), fill=rgb("off white"))
    draw.rectangle((0, 0, w - 1, h - 1), outline=(18, 18, 20), width=2)
    return image


def keypad(b: MeshBuilder, at: tuple[float, float, float], size: float, tilt: float = 0.0) -> None:
    """Twelve keys on a dark plate facing +x."""
    with b.frame(at, (0, -tilt, 0)):
        b.box((0.012, size, size * 1.1), (0, 0, -size * 0.55), "charcoal")
        for k in range(12):
            y, z = (k % 3 - 1) * size * 0.29, (1.5 - k // 3) * size * 0.25
            b.box((0.012, size * 0.2, size * 0.17), (0.008, y, z - size * 0.08), "light grey")


@recipe("parcel locker", 3, name="street_terminals.parcel_locker")
def parcel_locker(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A wall of doors of three heights with a screen in one column; a roof with its name. Doors at +x."""
    b = MeshBuilder(roughness=0.45)
    columns, depth, height, words, body, face = (
        (6, 0.62, 2.1, "PARCEL POINT", "charcoal", "signal yellow"),
        (8, 0.55, 2.3, "PACK & GO", "dark blue", "light grey"),
        (4, 0.7, 1.95, "LOCKER 24", "dark green", "off white"),
    )[variant % 3]
    width, low = 0.47, 0.1
    top = height - 0.22
    total = columns * width
    b.box((depth, total, low), (-0.02, 0, 0), "dark concrete")
    b.box((depth - 0.04, total, top - low), (-0.02, 0, low), body)
    x = depth / 2 - 0.03
    for c in range(columns):
        y, z = (c - (columns - 1) / 2) * width, low + 0.02
        if c == columns // 2:
            b.box((0.03, width - 0.02, top - z), (x, y, z), shade(body, 1.3))
            b.box((0.03, 0.34, 0.32), (x + 0.025, y, 1.12), "black", bevel=0.008)
            b.panel(screen_image("HELLO", "signal blue"), (x + 0.042, y, 1.28), 0.29, 0.24)
            keypad(b, (x + 0.02, y, 0.94), 0.15)
            b.box((0.02, 0.24, 0.03), (x + 0.02, y, 0.75), "black")
            continue
        sizes = rng.permutation([0.2, 0.2, 0.3, 0.3, 0.42, 0.42])
        for share in np.asarray(sizes) / sizes.sum():
            tall = float(share) * (top - low - 0.04)
            b.box((0.03, width - 0.02, tall - 0.015), (x, y, z), face)
            b.box((0.012, 0.025, 0.06), (x + 0.018, y + width * 0.38, z + tall / 2 - 0.03), "black")
            z += tall
    reach = 0.28 if variant % 3 != 1 else 0.06
    b.box((depth + reach, total + 0.06, 0.2), (reach / 2 - 0.02, 0, top + 0.02), body, bevel=0.015)
    b.panel(sign(words, body, "white", (160, 20)), (depth / 2 + reach - 0.018, 0, top + 0.12), total * 0.5, 0.15)
    size = (0.0, total + 0.06, height)
    return made(b, f"a parcel locker of {columns} columns", (min(depth + reach, 0.8) if variant else 0.66, *size[1:]))


@recipe("atm", 3, name="street_terminals.atm")
def atm(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A lobby machine with a hood and a sloped desk, a slim one under a lit sign, a broad wall module; user at +x."""
    b = MeshBuilder(roughness=0.4)
    color, band, size = (
        ("light grey", "signal blue", (0.72, 0.68, 1.5)),
        ("charcoal", "dark red", (0.55, 0.5, 1.75)),
        ("off white", "green", (0.95, 0.85, 1.62)),
    )[variant % 3]
    # Side view: foot, safe, desk that slopes to the user, screen leaning back, hood.
    side = [(-0.34, 0), (0.26, 0), (0.26, 0.74), (0.36, 0.84), (0.12, 0.93), (0.04, 1.3), (0.3, 1.34), (0.3, 1.5)]
    b.profile([*side, (-0.34, 1.5)], 0.66, color=color)
    for y in (-0.34, 0.34):
        b.profile([*side[:4], (0.3, 1.4), (0.3, 1.5), (-0.34, 1.5)], 0.03, (0, y, 0), shade(color, 0.75))
    b.panel(sign("CASH 24h" if variant % 3 else "ATM", band, "white", (96, 24)), (0.302, 0, 1.42), 0.64, 0.15)
    b.panel(screen_image("CASH", "signal blue", size=(72, 56)), (0.085, 0, 1.12), 0.34, 0.28, tilt_deg=12.0)
    with b.frame((0.24, -0.02, 0.9), (0, 67, 0)):
        keypad(b, (0, 0, 0), 0.15)
    for y, z, wide, ink in ((0.24, 1.13, 0.1, "light green"), (0.24, 1.0, 0.12, "black"), (-0.24, 1.08, 0.1, "black")):
        b.box((0.03, wide, 0.05), (0.1 - (z - 1.0) * 0.2, y, z), "dark grey", turn_deg=(0, -12, 0))
        b.box((0.036, wide * 0.75, 0.018), (0.102 - (z - 1.0) * 0.2, y, z + 0.016), ink, turn_deg=(0, -12, 0))
    b.box((0.05, 0.34, 0.07), (0.25, 0, 0.6), "black", bevel=0.01)
    b.box((0.03, 0.5, 0.06), (0.25, 0, 0.4), band)
    b.box((0.01, 0.52, 0.28), (0.26, 0, 0.06), shade(color, 0.85))
    b.cylinder(0.012, 0.02, (0.262, 0.2, 0.2), "black", turn_deg=(0, 90, 0), segments=10)
    return made(b, f"a {color} cash machine", size, band=band)


@recipe("self-service payment kiosk or terminal", 3, name="street_terminals.payment_kiosk")
def payment_kiosk(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Column with a leaning screen and card reader, a car-park machine with coin slot, a slim order terminal."""
    b = MeshBuilder(roughness=0.4)
    style = ("ticket column", "car park machine", "order terminal")[variant % 3]
    if style == "ticket column":
        b.box((0.44, 0.56, 0.04), color="charcoal", bevel=0.01)
        b.profile([(-0.2, 0.03), (0.16, 0.03), (0.2, 1.0), (0.06, 1.62), (-0.2, 1.62)], 0.54, color="signal blue")
        b.box((0.46, 0.58, 0.05), (-0.02, 0, 1.6), "white", bevel=0.015)
        b.panel(screen_image("TICKETS", "teal", 3, (80, 64)), (0.138, 0, 1.3), 0.4, 0.3, tilt_deg=12.7)
        keypad(b, (0.208, -0.12, 0.93), 0.13)
        b.box((0.05, 0.12, 0.14), (0.19, 0.14, 0.86), "black", bevel=0.012)
        b.box((0.02, 0.06, 0.015), (0.21, 0.14, 0.93), "light green")
        b.box((0.05, 0.3, 0.14), (0.165, 0, 0.5), "black", bevel=0.015)
        b.panel(sign("TICKETS", "white", "signal blue", (96, 20)), (0.178, 0, 0.72), 0.42, 0.09)
        size = (0.46, 0.58, 1.65)
    elif style == "car park machine":
        b.box((0.36, 0.46, 0.06), color="dark concrete")
        b.box((0.34, 0.44, 1.5), (0, 0, 0.05), "charcoal", bevel=0.02)
        b.convex([(x, y, z) for y in (-0.25, 0.25) for x, z in ((-0.2, 1.55), (0.26, 1.55), (0.2, 1.66), (-0.2, 1.72))])
        b.panel(sign("P", "signal blue", "white", (48, 48)), (0.173, 0, 1.34), 0.3, 0.3)
        b.panel(screen_image("PAY HERE", "green", 1, (64, 32)), (0.173, -0.04, 1.06), 0.26, 0.13)
        keypad(b, (0.175, 0.06, 0.86), 0.14)
        b.box((0.02, 0.07, 0.1), (0.172, -0.12, 0.82), "amber", bevel=0.005)
        b.box((0.03, 0.018, 0.05), (0.176, -0.12, 0.845), "black")
        b.box((0.05, 0.18, 0.12), (0.165, 0, 0.56), "light grey", bevel=0.012)
        b.box((0.055, 0.14, 0.07), (0.167, 0, 0.575), "black")
        size = (0.44, 0.5, 1.8)
    else:
        b.box((0.34, 0.5, 0.03), color="black", bevel=0.01)
        b.box((0.08, 0.34, 0.9), (-0.06, 0, 0.02), "light grey", bevel=0.01)
        b.box((0.07, 0.46, 0.85), (-0.04, 0, 0.62), "white", turn_deg=(0, -6, 0), bevel=0.02)
        image = screen_image("ORDER", "orange", 5, (64, 112))
        b.panel(image, (-0.047, 0, 1.06), 0.41, 0.74, tilt_deg=6.0)
        b.box((0.12, 0.1, 0.14), (0.04, 0, 0.7), "black", turn_deg=(0, -20, 0), bevel=0.015)
        b.box((0.09, 0.14, 0.1), (0.02, 0.13, 0.52), "charcoal", bevel=0.01)
        size = (0.36, 0.5, 1.45)
    return made(b, f"a {style}", size, style=style)


@recipe("control cabinets", 3, name="street_terminals.control_cabinets")
def control_cabinets(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A tall switchgear cabinet with lamps and an isolator, a wall-height pair with meters, a low desk; doors +x."""
    b = MeshBuilder(roughness=0.5)
    style = ("switchgear", "pair of cabinets", "control desk")[variant % 3]
    if style == "switchgear":
        b.box((0.4, 0.8, 0.1), color="charcoal")
        b.box((0.4, 0.8, 1.6), (0, 0, 0.1), "light grey", bevel=0.01)
        b.box((0.02, 0.74, 1.5), (0.2, 0, 0.15), "off white", bevel=0.006)
        for k, color in enumerate(("light red", "amber", "light green", "white")):
            b.cylinder(0.022, 0.03, (0.205, -0.24 + 0.1 * k, 1.5), color, turn_deg=(0, 90, 0), segments=12)
        for y in (0.14, 0.27):
            b.box((0.02, 0.1, 0.1), (0.207, y, 1.42), "black")
            b.panel(gauge_image(), (0.219, y, 1.47), 0.085, 0.085)
        b.cylinder(0.06, 0.03, (0.205, -0.2, 1.2), "signal yellow", turn_deg=(0, 90, 0))
        b.box((0.05, 0.03, 0.12), (0.235, -0.2, 1.14), "signal red")
        b.box((0.03, 0.025, 0.2), (0.21, 0.31, 0.85), "black")
        for k in range(5):
            b.box((0.012, 0.3, 0.015), (0.212, 0, 0.3 + 0.05 * k), "dark grey")
        size = (0.42, 0.8, 1.7)
    elif style == "pair of cabinets":
        for y, color in ((-0.38, "#8a9a8c"), (0.38, "#96a598")):
            b.box((0.45, 0.74, 0.08), (0, y, 0), "dark concrete")
            b.box((0.45, 0.75, 1.15), (0, y, 0.08), color, bevel=0.01)
            b.panel(door_image(64, 96, color, 2), (0.227, y, 0.66), 0.7, 1.08)
            b.panel(bolt_image(), (0.23, y - 0.19, 0.8), 0.16, 0.16)
            b.convex(
                [(sx * 0.27, y + sy * 0.39, 1.23) for sx in (-1, 1) for sy in (-1, 1)]
                + [(sx * 0.05, y + sy * 0.39, 1.31) for sx in (-1, 1) for sy in (-1, 1)],
                shade(color, 0.8),
            )
        for y in (-0.5, 0.2, 0.5):
            b.cylinder(0.03, 0.2, (-0.1, y, 1.2), "dark grey", segments=10)
        size = (0.5, 1.5, 1.35)
    else:
        b.profile(
            [(-0.35, 0), (0.25, 0), (0.25, 0.68), (0.37, 0.74), (0.02, 0.92), (-0.1, 1.25), (-0.35, 1.25)],
            1.2,
            color="#5b7286",
        )
        for y in (-0.38, 0.0, 0.38):
            b.panel(gauge_image(), (-0.02, y, 1.08), 0.2, 0.2, tilt_deg=20.0)
        for row in range(3):
            for k in range(10):
                x, z = 0.3 - 0.1 * row, 0.776 + 0.051 * row
                ink = ("light red", "amber", "light green", "white")[int(rng.integers(4))]
                b.box((0.04, 0.05, 0.02), (x, -0.5 + 0.11 * k, z), ink, turn_deg=(0, 27, 0))
        b.panel(door_image(96, 48, "#5b7286", 2), (0.252, 0, 0.35), 1.1, 0.58)
        size = (0.75, 1.25, 1.2)
    return made(b, f"a {style}", size, style=style)


def gauge_image() -> Image.Image:
    """A round instrument with a scale and a needle."""
    image, draw = paint.canvas((192, 192), "charcoal")
    draw.ellipse((8, 8, 184, 184), fill=rgb("white"), outline=(20, 20, 20), width=6)
    for k in range(9):
        a = np.radians(150 + 30 * k)
        c, s = float(np.cos(a)), float(np.sin(a))
        draw.line((96 + 60 * c, 96 + 60 * s, 96 + 78 * c, 96 + 78 * s), fill=(20, 20, 20), width=7)
    draw.line((96, 110, 140, 50), fill=rgb("signal red"), width=9)
    return paint.shrunk(image, (40, 40))


def bolt_image() -> Image.Image:
    """The yellow triangle that warns of electricity."""
    image, draw = paint.canvas((160, 160), "light grey")
    draw.polygon([(80, 10), (152, 148), (8, 148)], fill=rgb("signal yellow"), outline=(0, 0, 0), width=8)
    draw.line((88, 50, 66, 96, 94, 96, 74, 138), fill=(0, 0, 0), width=12)
    return paint.shrunk(image, (40, 40))


@recipe("storage locker", 3, name="street_terminals.storage_locker")
def storage_locker(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Three tall doors, a wall of small ones, a two-door one on a bench; louvres and locks at +x."""
    b = MeshBuilder(roughness=0.45)
    columns, rows, color, body, size = (
        (3, 1, "signal blue", "light grey", (0.5, 0.9, 1.8)),
        (4, 4, "orange", "charcoal", (0.45, 1.4, 1.95)),
        (2, 2, "#7d8c7a", "#64705f", (0.55, 0.62, 2.05)),
    )[variant % 3]
    depth, width, height = size
    foot = 0.1 if variant % 3 != 2 else 0.42
    for sy in (-1, 1):
        for sx in (-1, 1):
            b.box((0.04, 0.04, foot), (sx * (depth / 2 - 0.04), sy * (width / 2 - 0.04), 0), "charcoal")
    if variant % 3 == 2:
        b.box((depth + 0.16, width, 0.04), (0.08, 0, foot - 0.04), "light wood", bevel=0.01)
    b.box((depth, width, height - foot), (0, 0, foot), body, bevel=0.006)
    w, h = (width - 0.03) / columns, (height - foot - 0.05) / rows
    for c in range(columns):
        for r in range(rows):
            y, z = -width / 2 + 0.015 + (c + 0.5) * w, foot + 0.025 + r * h
            b.box((0.02, w - 0.015, h - 0.015), (depth / 2, y, z), color)
            for k in range(3):
                for at in (h - 0.08 - 0.03 * k, 0.06 + 0.03 * k) if rows < 3 else (h - 0.08 - 0.03 * k,):
                    b.box((0.006, w * 0.45, 0.012), (depth / 2 + 0.012, y, z + at), shade(color, 0.5))
            b.box((0.02, 0.03, 0.07), (depth / 2 + 0.014, y + w * 0.36, z + h * 0.5), "black")
            b.panel(number_image(c * rows + r + 1), (depth / 2 + 0.014, y, z + h * 0.76), 0.07, 0.07)
    return made(b, f"a locker of {columns * rows} doors", size if variant % 3 != 2 else (0.7, *size[1:]))


def number_image(number: int) -> Image.Image:
    """A small white plate with a number."""
    image, draw = paint.canvas((24, 24), "white")
    paint.text(draw, str(number), (3, 3, 21, 21), "black", bold=0.02)
    return image
