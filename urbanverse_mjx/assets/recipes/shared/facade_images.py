"""Images for building fronts: walls, windows, doors, shop windows, signs."""

from collections.abc import Callable

import numpy as np
from PIL import Image, ImageDraw

from ...meshes import paint
from ...meshes.palette import Color, mix, rgb, shade

Pen = ImageDraw.ImageDraw


def wall(
    kind: str, size_m: tuple[float, float], color: Color, rng: np.random.Generator, pixels: int = 224
) -> Image.Image:
    """A wall of size_m = (width, height) metres: "brick", "plaster", "ashlar", "panel" or "boards"."""
    width_m, height_m = size_m
    scale = min(pixels / max(width_m, 1e-3), 256 / max(height_m, 1e-3))
    width, height = max(16, int(width_m * scale)), max(16, int(height_m * scale))
    y, x = np.mgrid[0:height, 0:width]
    base = np.array(rgb(color), float)
    grain = rng.normal(0, 1.0, (height, width))
    shadow = np.zeros((height, width))
    # Courses are drawn no finer than three pixels, or they would flicker.
    if kind == "brick":
        course, length = max(3, round(0.09 * scale)), max(7, round(0.26 * scale))
        row = y // course
        brick = (x + (row % 2) * (length // 2)) // length
        tone = rng.normal(0, 0.085, (height // course + 1, width // length + 2))[row, brick]
        joint = (y % course == 0) | ((x + (row % 2) * (length // 2)) % length == 0)
        shadow = tone + np.where(joint, 0.20, 0.0)
    elif kind == "ashlar":
        course, length = max(6, round(0.45 * scale)), max(12, round(0.9 * scale))
        row = y // course
        block = (x + (row % 2) * (length // 2)) // length
        shadow = rng.normal(0, 0.03, (height // course + 1, width // length + 2))[row, block]
        shadow -= np.where((y % course == 0) | ((x + (row % 2) * (length // 2)) % length == 0), 0.17, 0.0)
    elif kind == "panel":
        shadow -= np.where((y % max(8, round(1.2 * scale)) == 0) | (x % max(8, round(1.5 * scale)) == 0), 0.22, 0.0)
    elif kind == "boards":
        course = max(4, round(0.16 * scale))
        shadow -= np.where(y % course == 0, 0.22, 0.0) - rng.normal(0, 0.02, (height // course + 1,))[y // course]
    # Rain streaks from the top, splashes at the foot.
    streak = np.convolve(rng.normal(0, 1, width), np.ones(5) / 5, "same")[x] * 0.035
    foot = -0.16 * np.clip(1 - (height - 1 - y) / max(1.0, 0.5 * scale), 0, 1)
    image = base * (1 + shadow + 0.02 * grain + streak + foot)[..., None]
    return Image.fromarray(np.clip(image, 0, 255).astype(np.uint8))


def window(
    style: str, frame: Color, rng: np.random.Generator, size: tuple[int, int] = (36, 54), lit: bool = False
) -> Image.Image:
    """A window: "casement", "sash", "grid", "single" or "office"; curtains, blinds and a reflection at random."""
    scale = 4
    w, h = size[0] * scale, size[1] * scale
    image, pen = paint.canvas((w, h), frame)
    glass = mix("dark glass", "light blue", float(rng.uniform(0.05, 0.3)))
    glass = mix(glass, "lamp", 0.6) if lit else glass
    edge = 0.07 * w
    for i in range(24):  # glass is brighter above, where it mirrors the sky
        top = edge + (h - 2 * edge) * i / 24
        pen.rectangle((edge, top, w - edge, top + h / 24 + 1), fill=mix(glass, "light blue", 0.5 * (1 - i / 24)))
    choice = int(rng.integers(0, 4)) if style != "office" else 3
    if choice == 0:
        for side in (0, 1):
            points = [(edge, edge), (w * 0.36, edge), (w * 0.22, h * 0.55), (w * 0.2, h - edge), (edge, h - edge)]
            pen.polygon([(w - px if side else px, py) for px, py in points], fill=rgb("off white"))
    elif choice == 1:
        bottom = edge + (h - 2 * edge) * float(rng.uniform(0.25, 0.6))
        pen.rectangle((edge, edge, w - edge, bottom), fill=rgb("cream"))
    pen.polygon(
        [(w * 0.55, edge), (w * 0.75, edge), (w * 0.3, h - edge), (w * 0.1, h - edge)], fill=mix(glass, "white", 0.22)
    )
    bar = max(4, int(0.05 * w))
    if style in ("casement", "grid", "sash"):
        if style != "sash":
            pen.rectangle((w / 2 - bar, 0, w / 2 + bar, h), fill=rgb(frame))
        for k in (1, 2) if style == "grid" else (1,):
            level = h * k / 3 if style == "grid" else h * (0.5 if style == "sash" else 0.3)
            pen.rectangle((0, level - bar, w, level + bar), fill=rgb(frame))
    pen.rectangle((0, 0, w - 1, h - 1), outline=rgb(frame), width=int(edge))
    return paint.shrunk(image, size)


def door(color: Color, style: str = "panel", size: tuple[int, int] = (32, 64)) -> Image.Image:
    """A door: "panel" (wooden), "glass" (shop) or "double" (glass, two wings)."""
    scale = 4
    w, h = size[0] * scale, size[1] * scale
    image, pen = paint.canvas((w, h), color)
    if style == "panel":
        dark, light = shade(color, 0.7), shade(color, 1.2)
        for x0 in (0.14, 0.55):
            for y0, y1 in ((0.08, 0.38), (0.45, 0.62), (0.68, 0.94)):
                box = (w * x0, h * y0, w * (x0 + 0.31), h * y1)
                pen.rectangle(box, fill=dark)
                pen.rectangle((box[0] + 5, box[1] + 5, box[2], box[3]), fill=light if y0 < 0.4 else shade(color, 0.95))
    else:
        wings = 2 if style == "double" else 1
        for k in range(wings):
            x0, x1 = w * (k / wings) + 0.10 * w / wings, w * ((k + 1) / wings) - 0.10 * w / wings
            pen.rectangle((x0, h * 0.06, x1, h * 0.90), fill=rgb("dark glass"))
            pen.polygon(
                [(x0, h * 0.5), (x1, h * 0.2), (x1, h * 0.4), (x0, h * 0.7)], fill=mix("dark glass", "white", 0.25)
            )
    handle = w * 0.86 if style != "double" else w * 0.45
    pen.rectangle((handle - 4, h * 0.45, handle + 4, h * 0.58), fill=rgb("brass" if style == "panel" else "aluminium"))
    return paint.shrunk(image, size)


def sign(
    words: str, back: Color, ink: Color, size: tuple[int, int] = (224, 32), border: Color | None = None
) -> Image.Image:
    """A shop's fascia with its name."""
    big = paint.smooth(size, 3)
    image, pen = paint.canvas(big, back)
    if border is not None:
        pen.rectangle((6, 6, big[0] - 7, big[1] - 7), outline=rgb(border), width=5)
    paint.text(pen, words, (big[0] * 0.05, big[1] * 0.16, big[0] * 0.95, big[1] * 0.82), ink, 0.02)
    return paint.shrunk(image, size)


def awning(first: Color, second: Color | None, size: tuple[int, int] = (96, 24), stripes: int = 12) -> Image.Image:
    """Cloth of an awning, striped or plain."""
    return paint.stripes(size, [first, second] if second is not None else [first, shade(first, 0.92)], stripes)


# Shop windows: what stands behind the glass ---------------------------------------------------------------------------


def _shelves(
    pen: Pen, w: int, h: int, rng: np.random.Generator, rows: int, draw: Callable[[float, float, float], float]
) -> None:
    """Rows of shelves; `draw(x, y, height)` puts one article on a shelf and returns its width."""
    for k in range(rows):
        y = h * (0.30 + 0.62 * (k + 1) / rows)
        x = w * 0.04
        while x < w * 0.93:
            x += draw(x, y, h * 0.62 / rows * float(rng.uniform(0.45, 0.8))) + w * 0.008
        pen.rectangle((0, y, w, y + h * 0.02), fill=rgb("light wood"))


def _boxes(pen: Pen, w: int, h: int, rng: np.random.Generator, rows: int = 3, tall: float = 0.6) -> None:
    colors = ("red", "yellow", "green", "blue", "white", "orange", "teal", "pink", "cream")

    def one(x: float, y: float, height: float) -> float:
        width = height * float(rng.uniform(0.3, 1.0)) * tall
        pen.rectangle((x, y - height, x + width, y), fill=rgb(colors[int(rng.integers(len(colors)))]))
        return width

    _shelves(pen, w, h, rng, rows, one)


def _breads(pen: Pen, w: int, h: int, rng: np.random.Generator) -> None:
    def one(x: float, y: float, height: float) -> float:
        width = height * float(rng.uniform(1.0, 2.2))
        pen.ellipse(
            (x, y - height * 0.8, x + width, y + height * 0.1), fill=mix("#c98a3c", "#7a4a1e", float(rng.random()))
        )
        pen.line((x + width * 0.3, y - height * 0.6, x + width * 0.5, y - height * 0.2), fill=rgb("cream"), width=4)
        return width

    _shelves(pen, w, h, rng, 3, one)


def _books(pen: Pen, w: int, h: int, rng: np.random.Generator) -> None:
    def one(x: float, y: float, height: float) -> float:
        width = w * float(rng.uniform(0.008, 0.02))
        pen.rectangle(
            (x, y - height, x + width, y),
            fill=mix(("red", "blue", "green", "cream", "brown")[int(rng.integers(5))], "black", 0.2),
        )
        return width

    _shelves(pen, w, h, rng, 4, one)


def _clothes(pen: Pen, w: int, h: int, rng: np.random.Generator) -> None:
    for k in range(4):
        x, color = w * (0.14 + 0.24 * k), ("red", "teal", "charcoal", "pink", "cream", "blue")[int(rng.integers(6))]
        s = h * 0.085
        pen.ellipse((x - s * 0.6, h * 0.24, x + s * 0.6, h * 0.24 + s * 1.4), fill=rgb("skin light"))
        pen.polygon(
            [
                (x - s * 1.4, h * 0.38),
                (x + s * 1.4, h * 0.38),
                (x + s * 0.9, h * 0.60),
                (x + s * 1.6, h * 0.78),
                (x - s * 1.6, h * 0.78),
                (x - s * 0.9, h * 0.60),
            ],
            fill=rgb(color),
        )
        for dx in (-0.6, 0.6):
            pen.rectangle((x + dx * s - 5, h * 0.78, x + dx * s + 5, h * 0.95), fill=rgb("skin light"))


def _flowers(pen: Pen, w: int, h: int, rng: np.random.Generator) -> None:
    for k in range(9):
        x = w * (0.06 + 0.11 * k)
        top = h * float(rng.uniform(0.35, 0.6))
        pen.polygon(
            [(x - w * 0.03, h * 0.95), (x + w * 0.03, h * 0.95), (x + w * 0.04, h * 0.78), (x - w * 0.04, h * 0.78)],
            fill=rgb("galvanised"),
        )
        color = ("red", "pink", "yellow", "white", "purple", "orange")[int(rng.integers(6))]
        for _ in range(16):
            px, py = x + rng.normal(0, w * 0.025), top + abs(rng.normal(0, h * 0.11))
            pen.line((px, py, x, h * 0.8), fill=rgb("leaf"), width=5)
            pen.ellipse((px - 14, py - 14, px + 14, py + 14), fill=rgb(color))


def _tables(pen: Pen, w: int, h: int, rng: np.random.Generator) -> None:
    for k in range(4):
        x = w * (0.13 + 0.25 * k)
        pen.line((x, 0, x, h * 0.22), fill=rgb("black"), width=5)
        pen.polygon([(x - 12, h * 0.22), (x + 12, h * 0.22), (x + 34, h * 0.32), (x - 34, h * 0.32)], fill=rgb("amber"))
        pen.ellipse((x - w * 0.07, h * 0.66, x + w * 0.07, h * 0.71), fill=rgb("light wood"))
        pen.rectangle((x - 5, h * 0.7, x + 5, h * 0.95), fill=rgb("black"))
        for dx in (-0.085, 0.085):
            pen.ellipse(
                (x + w * dx - 22, h * 0.44, x + w * dx + 22, h * 0.54),
                fill=rgb(("skin light", "skin dark")[int(rng.integers(2))]),
            )
            pen.rectangle(
                (x + w * dx - 34, h * 0.54, x + w * dx + 34, h * 0.85),
                fill=rgb(("red", "blue", "teal", "charcoal")[int(rng.integers(4))]),
            )


def _bottles(pen: Pen, w: int, h: int, rng: np.random.Generator) -> None:
    def one(x: float, y: float, height: float) -> float:
        width = height * 0.28
        color = ("green", "amber", "dark red", "teal", "lamp")[int(rng.integers(5))]
        pen.rectangle((x, y - height * 0.6, x + width, y), fill=rgb(color))
        pen.rectangle((x + width * 0.3, y - height, x + width * 0.7, y - height * 0.5), fill=rgb(color))
        return width

    _shelves(pen, w, h, rng, 3, one)


def _salon(pen: Pen, w: int, h: int, rng: np.random.Generator) -> None:
    for k in range(3):
        x = w * (0.18 + 0.32 * k)
        pen.ellipse((x - w * 0.09, h * 0.18, x + w * 0.09, h * 0.62), fill=rgb("mirror"), outline=rgb("gold"), width=8)
        pen.rectangle((x - w * 0.05, h * 0.58, x + w * 0.05, h * 0.80), fill=rgb("dark red"))
        pen.rectangle((x - 7, h * 0.8, x + 7, h * 0.95), fill=rgb("aluminium"))


def _posters(pen: Pen, w: int, h: int, rng: np.random.Generator) -> None:
    for k in range(4):
        x0, x1 = w * (0.05 + 0.24 * k), w * (0.24 + 0.24 * k)
        back, ink = (("signal yellow", "red"), ("red", "white"), ("white", "blue"), ("green", "white"))[
            int(rng.integers(4))
        ]
        pen.rectangle((x0, h * 0.2, x1, h * 0.9), fill=rgb(back))
        paint.text(
            pen,
            f"{int(rng.integers(1, 9))}.{int(rng.integers(10, 99))}",
            (x0 + 12, h * 0.35, x1 - 12, h * 0.6),
            ink,
            0.03,
        )
        pen.rectangle((x0 + 20, h * 0.68, x1 - 20, h * 0.74), fill=rgb(ink))


_GOODS: dict[str, Callable[[Pen, int, int, np.random.Generator], None]] = {
    "boxes": _boxes,
    "breads": _breads,
    "books": _books,
    "clothes": _clothes,
    "flowers": _flowers,
    "tables": _tables,
    "bottles": _bottles,
    "salon": _salon,
    "posters": _posters,
}


def shop_window(
    goods: str, frame: Color, rng: np.random.Generator, size: tuple[int, int] = (144, 88), warm: bool = True
) -> Image.Image:
    """A lit shop window with what the shop sells, framed."""
    scale = 3
    w, h = size[0] * scale, size[1] * scale
    image, pen = paint.canvas((w, h), "black")
    back = mix("dark wood", "lamp", 0.35) if warm else mix("dark glass", "white", 0.55)
    for i in range(30):
        pen.rectangle((0, h * i / 30, w, h * (i + 1) / 30), fill=mix(back, "black", 0.45 * i / 30))
    _GOODS[goods](pen, w, h, rng)
    # What the pane mirrors: a pale sky above and a slanting streak.
    pixels = np.asarray(image, float)
    y, x = np.mgrid[0:h, 0:w]
    gleam = 0.28 * np.clip(1 - y / (0.5 * h), 0, 1) + 0.10 * (np.abs((x + 0.6 * y) / w - 0.55) < 0.06)
    image = Image.fromarray((pixels + (np.array([190, 208, 220]) - pixels) * gleam[..., None]).astype(np.uint8))
    pen = ImageDraw.Draw(image)
    pen.rectangle((0, 0, w - 1, h - 1), outline=rgb(frame), width=int(0.035 * h) + 2)
    for k in (1, 2):
        pen.rectangle((w * k / 3 - 5, 0, w * k / 3 + 5, h), fill=rgb(frame))
    return paint.shrunk(image, size)
