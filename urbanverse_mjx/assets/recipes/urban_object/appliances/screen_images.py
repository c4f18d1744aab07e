"""Images on screens: a desktop, a landscape, rows of icons, a chart, an arcade game."""

import numpy as np
from PIL import Image

from ....meshes import paint
from ....meshes.palette import mix, rgb

INKS = ("signal red", "amber", "green", "signal blue", "purple", "teal", "orange", "pink")


def landscape(size: tuple[int, int], dusk: bool = False) -> Image.Image:
    """Hills under a sky with a sun, as shop televisions show them."""
    w, h = size
    image, pen = paint.canvas(size, "white")
    top, low = ("dark blue", "orange") if dusk else ("signal blue", "light blue")
    for y in range(h):
        pen.line((0, y, w, y), fill=mix(top, low, min(y / (0.6 * h), 1.0)))
    sun = h * 0.11
    pen.ellipse((w * 0.7 - sun, h * 0.25 - sun, w * 0.7 + sun, h * 0.25 + sun), fill=rgb("lamp"))
    pen.polygon(
        [(0, h * 0.7), (w * 0.25, h * 0.3), (w * 0.5, h * 0.68), (w * 0.7, h * 0.42), (w, h * 0.75), (w, h), (0, h)],
        fill=rgb("purple" if dusk else "grey"),
    )
    pen.ellipse((-w * 0.3, h * 0.6, w * 0.7, h * 1.7), fill=rgb("dark green"))
    pen.ellipse((w * 0.3, h * 0.68, w * 1.4, h * 1.8), fill=rgb("grass"))
    return image


def desktop(size: tuple[int, int]) -> Image.Image:
    """Two windows of text and a chart over a blue desktop, a bar below."""
    w, h = size
    image, pen = paint.canvas(size, "#2f6fae")
    pen.rectangle((0, h * 0.92, w, h), fill=(24, 30, 40))
    for k in range(7):
        x = w * 0.3 + k * w * 0.06
        pen.rectangle((x, h * 0.94, x + w * 0.035, h * 0.985), fill=rgb(INKS[k]))
    pen.rectangle((w * 0.06, h * 0.1, w * 0.58, h * 0.8), fill=(244, 245, 247))
    pen.rectangle((w * 0.06, h * 0.1, w * 0.58, h * 0.17), fill=(70, 80, 98))
    for k in range(9):
        y = h * (0.23 + 0.058 * k)
        pen.line((w * 0.1, y, w * (0.34 + 0.19 * ((k * 5) % 7) / 7), y), fill=(120, 126, 136), width=max(1, h // 60))
    pen.rectangle((w * 0.5, h * 0.3, w * 0.93, h * 0.86), fill=(252, 252, 250))
    pen.rectangle((w * 0.5, h * 0.3, w * 0.93, h * 0.37), fill=(70, 80, 98))
    for k, share in enumerate((0.3, 0.5, 0.42, 0.75, 0.9)):
        x = w * (0.55 + 0.072 * k)
        pen.rectangle((x, h * (0.82 - 0.38 * share), x + w * 0.045, h * 0.82), fill=rgb(INKS[k]))
    return image


def icons(size: tuple[int, int], columns: int, rows: int, clock: str = "09:41") -> Image.Image:
    """A telephone's first page: clock, rows of icons, a dock of four."""
    w, h = size
    image, pen = paint.canvas(size, "white")
    for y in range(h):
        pen.line((0, y, w, y), fill=mix("dark blue", "pink", y / h))
    paint.text(pen, clock, (w * 0.2, h * 0.04, w * 0.8, h * 0.16), "white")
    step = w / columns
    for r in range(rows + 1):
        y = h * 0.9 if r == rows else h * 0.28 + r * (h * 0.52 / rows)
        for c in range(columns):
            x, s = (c + 0.5) * step, step * 0.3
            box = (x - s, y - s, x + s, y + s)
            pen.rounded_rectangle(box, s * 0.4, fill=rgb(INKS[(3 * r + 2 * c) % len(INKS)]))
    return image


def space_game(size: tuple[int, int], rng: np.random.Generator) -> Image.Image:
    """Rows of invaders over a ship in the dark, a score above."""
    w, h = size
    image, pen = paint.canvas(size, "#0a0a1e")
    for _ in range(40):
        pen.point((int(rng.integers(w)), int(rng.integers(h))), fill=(200, 200, 220))
    paint.text(pen, "SCORE 04200", (w * 0.08, h * 0.03, w * 0.92, h * 0.12), "signal yellow")
    cell = w / 40
    for r in range(4):
        for c in range(6):
            x, y = w * (0.1 + 0.14 * c), h * (0.2 + 0.12 * r)
            ink = rgb(("pink", "light green", "light blue", "amber")[r])
            pen.rectangle((x, y, x + 3 * cell, y + 2 * cell), fill=ink)
            for dx in (0, 2.2):
                pen.rectangle((x + dx * cell, y + 2 * cell, x + (dx + 0.8) * cell, y + 3 * cell), fill=ink)
    pen.polygon([(w * 0.5, h * 0.84), (w * 0.58, h * 0.93), (w * 0.42, h * 0.93)], fill=rgb("white"))
    pen.line((w * 0.5, h * 0.7, w * 0.5, h * 0.8), fill=rgb("light red"), width=2)
    return image


def race_game(size: tuple[int, int]) -> Image.Image:
    """A road to the horizon with a red car."""
    w, h = size
    image, pen = paint.canvas(size, "light blue")
    pen.rectangle((0, h * 0.45, w, h), fill=rgb("grass"))
    pen.polygon([(w * 0.47, h * 0.45), (w * 0.53, h * 0.45), (w * 1.05, h), (-w * 0.05, h)], fill=rgb("dark grey"))
    for k in range(4):
        y = h * (0.52 + 0.13 * k)
        pen.rectangle((w * 0.5 - 1 - k, y, w * 0.5 + 1 + k, y + h * 0.06), fill=rgb("white"))
    pen.rounded_rectangle((w * 0.36, h * 0.7, w * 0.64, h * 0.9), 4, fill=rgb("signal red"))
    pen.rectangle((w * 0.41, h * 0.65, w * 0.59, h * 0.75), fill=rgb("dark glass"))
    for x in (0.36, 0.57):
        pen.rectangle((w * x, h * 0.86, w * (x + 0.07), h * 0.93), fill=(15, 15, 15))
    paint.text(pen, "LAP 2", (w * 0.05, h * 0.04, w * 0.5, h * 0.16), "signal red", 0.04)
    return image
