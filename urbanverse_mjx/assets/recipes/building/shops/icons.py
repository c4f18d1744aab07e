"""Pictograms of what shops sell: drawn in a unit square (x right, y down), for shop windows and signs."""

import dataclasses
from collections.abc import Callable, Sequence

import numpy as np
from PIL import ImageDraw

from ....meshes import paint
from ....meshes.palette import Color, rgb

Pairs = Sequence[tuple[float, float]]


@dataclasses.dataclass(frozen=True)
class Ink:
    """A pen whose unit square lies at (x, y) with side `size`, pixels."""

    pen: ImageDraw.ImageDraw
    x: float
    y: float
    size: float

    def _place(self, points: Pairs) -> list[tuple[float, float]]:
        return [(self.x + px * self.size, self.y + py * self.size) for px, py in points]

    def rect(self, x0: float, y0: float, x1: float, y1: float, color: Color, round_: float = 0.0) -> None:
        (a, b), (c, d) = self._place([(x0, y0), (x1, y1)])
        self.pen.rounded_rectangle((a, b, c, d), round_ * self.size, fill=rgb(color))

    def disc(self, x: float, y: float, rx: float, color: Color, ry: float | None = None) -> None:
        ry = rx if ry is None else ry
        (a, b), (c, d) = self._place([(x - rx, y - ry), (x + rx, y + ry)])
        self.pen.ellipse((a, b, c, d), fill=rgb(color))

    def ring(self, x: float, y: float, r: float, color: Color, width: float, ry: float | None = None) -> None:
        ry = r if ry is None else ry
        (a, b), (c, d) = self._place([(x - r, y - ry), (x + r, y + ry)])
        self.pen.ellipse((a, b, c, d), outline=rgb(color), width=max(1, round(width * self.size)))

    def arc(self, x: float, y: float, r: float, start: float, end: float, color: Color, width: float = 0.06) -> None:
        """From `start` to `end` degrees, clockwise from three o'clock."""
        (a, b), (c, d) = self._place([(x - r, y - r), (x + r, y + r)])
        self.pen.arc((a, b, c, d), start, end, fill=rgb(color), width=max(1, round(width * self.size)))

    def poly(self, points: Pairs, color: Color) -> None:
        self.pen.polygon(self._place(points), fill=rgb(color))

    def line(self, points: Pairs, color: Color, width: float = 0.06) -> None:
        self.pen.line(self._place(points), fill=rgb(color), width=max(1, round(width * self.size)), joint="curve")

    def words(self, text: str, x0: float, y0: float, x1: float, y1: float, color: Color) -> None:
        (a, b), (c, d) = self._place([(x0, y0), (x1, y1)])
        paint.text(self.pen, text, (a, b, c, d), color, 0.03)

    def star(self, x: float, y: float, r: float, color: Color, points: int = 5, inner: float = 0.45) -> None:
        angles = np.arange(2 * points) * np.pi / points - np.pi / 2
        radii = np.where(np.arange(2 * points) % 2 == 0, r, r * inner)
        self.poly([(x + a * np.cos(t), y + a * np.sin(t)) for a, t in zip(radii, angles, strict=True)], color)


Icon = Callable[[Ink, Color], None]
ICONS: dict[str, Icon] = {}


def icon(function: Icon) -> Icon:
    """Decorator: enters a pictogram under its function's name."""
    ICONS[function.__name__] = function
    return function


# Food and drink ---------------------------------------------------------------------------------------------------


@icon
def wine(i: Ink, c: Color) -> None:
    i.rect(0.35, 0.4, 0.65, 0.98, c, 0.05)
    i.rect(0.44, 0.04, 0.56, 0.45, c)
    i.rect(0.43, 0.02, 0.57, 0.14, "gold")
    i.rect(0.35, 0.56, 0.65, 0.82, "cream")


@icon
def whisky(i: Ink, c: Color) -> None:
    i.rect(0.26, 0.3, 0.74, 0.98, "amber", 0.05)
    i.rect(0.4, 0.05, 0.6, 0.32, "black")
    i.rect(0.32, 0.5, 0.68, 0.85, c)


@icon
def wineglass(i: Ink, c: Color) -> None:
    i.poly([(0.22, 0.05), (0.78, 0.05), (0.68, 0.45), (0.5, 0.56), (0.32, 0.45)], "mirror")
    i.poly([(0.26, 0.22), (0.74, 0.22), (0.66, 0.43), (0.5, 0.53), (0.34, 0.43)], c)
    i.rect(0.46, 0.5, 0.54, 0.92, "mirror")
    i.rect(0.26, 0.9, 0.74, 0.97, "mirror")


@icon
def cutlery(i: Ink, c: Color) -> None:
    i.disc(0.5, 0.5, 0.32, "white")
    i.ring(0.5, 0.5, 0.22, c, 0.03)
    i.rect(0.05, 0.1, 0.1, 0.92, "aluminium")
    i.rect(0.02, 0.08, 0.13, 0.32, "aluminium")
    i.rect(0.9, 0.1, 0.96, 0.92, "aluminium", 0.02)


@icon
def bubbletea(i: Ink, c: Color) -> None:
    i.line([(0.55, 0.3), (0.68, 0.0)], "signal red", 0.08)
    i.poly([(0.22, 0.24), (0.78, 0.24), (0.68, 0.98), (0.32, 0.98)], c)
    i.rect(0.17, 0.18, 0.83, 0.28, "white", 0.04)
    for x, y in ((0.38, 0.9), (0.5, 0.92), (0.62, 0.9), (0.42, 0.78), (0.56, 0.78), (0.5, 0.66), (0.63, 0.72)):
        i.disc(x, y, 0.055, "#2a1a14")


@icon
def ham(i: Ink, c: Color) -> None:
    i.poly([(0.6, 0.55), (0.95, 0.88), (0.88, 0.96), (0.5, 0.68)], "cream")
    i.disc(0.93, 0.9, 0.07, "cream")
    i.disc(0.38, 0.4, 0.36, "#a5413c", 0.33)
    i.disc(0.28, 0.36, 0.16, "#e6a59b", 0.13)
    i.disc(0.28, 0.36, 0.06, "white")


@icon
def sausage(i: Ink, c: Color) -> None:
    i.line([(0.0, 0.02), (1.0, 0.02)], "aluminium", 0.03)
    for k in range(3):
        x = 0.18 + 0.32 * k
        i.line([(x, 0.0), (x, 0.3)], "cream", 0.03)
        i.rect(x - 0.1, 0.22, x + 0.1, 0.95, ("#9c3a2e", "#7a2c24", "#b5563f")[k], 0.1)


@icon
def cow(i: Ink, c: Color) -> None:
    i.rect(0.18, 0.3, 0.78, 0.66, c, 0.08)
    for x in (0.2, 0.32, 0.6, 0.7):
        i.rect(x, 0.6, x + 0.08, 0.95, c)
    i.poly([(0.74, 0.3), (0.95, 0.28), (0.98, 0.5), (0.8, 0.52)], c)
    i.line([(0.8, 0.28), (0.78, 0.16)], c, 0.05)
    i.line([(0.92, 0.28), (0.97, 0.16)], c, 0.05)
    i.line([(0.2, 0.35), (0.06, 0.7)], c, 0.04)


@icon
def cheese(i: Ink, c: Color) -> None:
    i.poly([(0.03, 0.55), (0.85, 0.2), (0.97, 0.55)], "#fbe28a")
    i.rect(0.03, 0.55, 0.97, 0.92, "#f2bd33")
    for x, y, r in ((0.22, 0.72, 0.09), (0.52, 0.8, 0.07), (0.76, 0.68, 0.1), (0.65, 0.42, 0.06)):
        i.disc(x, y, r, "#c98f1c")


@icon
def cheesewheel(i: Ink, c: Color) -> None:
    i.rect(0.05, 0.5, 0.95, 0.85, "#d89a2c")
    i.disc(0.5, 0.85, 0.45, "#d89a2c", 0.12)
    i.disc(0.5, 0.5, 0.45, "#f6d468", 0.16)
    i.poly([(0.5, 0.5), (0.9, 0.44), (0.93, 0.58)], "#8a5a14")


@icon
def burger(i: Ink, c: Color) -> None:
    i.disc(0.5, 0.42, 0.45, "#d98a35", 0.32)
    i.rect(0.0, 0.44, 1.0, 0.55, "#6cae3a", 0.05)
    i.rect(0.04, 0.54, 0.96, 0.68, "#5b2c18", 0.04)
    i.poly([(0.1, 0.54), (0.9, 0.54), (0.7, 0.64)], "signal yellow")
    i.rect(0.05, 0.68, 0.95, 0.88, "#d98a35", 0.1)
    for x, y in ((0.3, 0.26), (0.5, 0.2), (0.7, 0.26), (0.42, 0.33), (0.6, 0.33)):
        i.disc(x, y, 0.025, "cream")


@icon
def fries(i: Ink, c: Color) -> None:
    for k in range(7):
        x = 0.2 + 0.095 * k
        i.rect(x, 0.06 + 0.06 * ((k * 5) % 3), x + 0.07, 0.6, "signal yellow")
    i.poly([(0.14, 0.4), (0.86, 0.4), (0.76, 0.98), (0.24, 0.98)], "signal red")
    i.disc(0.5, 0.4, 0.2, "signal red", 0.1)


@icon
def apple(i: Ink, c: Color) -> None:
    i.disc(0.36, 0.6, 0.3, "red", 0.34)
    i.disc(0.64, 0.6, 0.3, "red", 0.34)
    i.line([(0.5, 0.34), (0.54, 0.08)], "brown", 0.05)
    i.disc(0.7, 0.16, 0.15, "green", 0.08)


@icon
def carrot(i: Ink, c: Color) -> None:
    i.poly([(0.3, 0.34), (0.7, 0.34), (0.5, 1.0)], "orange")
    for x in (0.28, 0.5, 0.72):
        i.line([(0.5, 0.36), (x, 0.02)], "green", 0.1)


@icon
def oranges(i: Ink, c: Color) -> None:
    for x, y in ((0.25, 0.76), (0.73, 0.76), (0.49, 0.36)):
        i.disc(x, y, 0.23, "#f08a1c")
        i.disc(x + 0.05, y - 0.16, 0.05, "green", 0.03)


@icon
def icecream(i: Ink, c: Color) -> None:
    i.poly([(0.24, 0.5), (0.76, 0.5), (0.5, 1.0)], "#d9a05a")
    i.line([(0.36, 0.52), (0.58, 0.8)], "#a86f30", 0.03)
    i.line([(0.64, 0.52), (0.42, 0.8)], "#a86f30", 0.03)
    i.disc(0.33, 0.4, 0.2, "pink")
    i.disc(0.67, 0.4, 0.2, "#6b4127")
    i.disc(0.5, 0.2, 0.2, "#fbf3d4")


@icon
def juice(i: Ink, c: Color) -> None:
    i.line([(0.5, 0.5), (0.72, 0.0)], "green", 0.07)
    i.poly([(0.2, 0.22), (0.8, 0.22), (0.7, 0.98), (0.3, 0.98)], "mirror")
    i.poly([(0.24, 0.36), (0.76, 0.36), (0.68, 0.95), (0.32, 0.95)], "#f5931e")
    i.disc(0.2, 0.24, 0.2, "#f5931e")
    i.ring(0.2, 0.24, 0.15, "cream", 0.03)


@icon
def cake(i: Ink, c: Color) -> None:
    i.rect(0.44, 0.02, 0.5, 0.22, "signal red")
    i.rect(0.2, 0.2, 0.8, 0.5, "pink", 0.04)
    i.rect(0.08, 0.48, 0.92, 0.84, "#f7e8d2", 0.04)
    for k in range(5):
        i.disc(0.16 + 0.17 * k, 0.5, 0.07, c)
    i.rect(0.0, 0.84, 1.0, 0.9, "aluminium")
    i.rect(0.44, 0.88, 0.56, 1.0, "aluminium")


@icon
def croissant(i: Ink, c: Color) -> None:
    for k in range(9):
        a = np.pi * (1 + k / 8)
        r = 0.12 + 0.09 * np.sin(np.pi * k / 8)
        i.disc(0.5 + 0.36 * np.cos(a), 0.74 + 0.4 * np.sin(a), r, ("#c47e33", "#a8652a")[k % 2])


@icon
def pizza(i: Ink, c: Color) -> None:
    i.poly([(0.04, 0.14), (0.96, 0.14), (0.5, 1.0)], "#f4c74a")
    i.rect(0.0, 0.04, 1.0, 0.2, "#b8702e", 0.08)
    for x, y in ((0.34, 0.34), (0.62, 0.32), (0.5, 0.58), (0.5, 0.8)):
        i.disc(x, y, 0.085, "signal red")
    i.disc(0.46, 0.44, 0.04, "green")
    i.disc(0.7, 0.46, 0.04, "green")


@icon
def pizzawhole(i: Ink, c: Color) -> None:
    i.disc(0.5, 0.5, 0.48, "#b8702e")
    i.disc(0.5, 0.5, 0.41, "#f4c74a")
    for k in range(6):
        i.disc(0.5 + 0.26 * np.cos(k * 1.05), 0.5 + 0.26 * np.sin(k * 1.05), 0.08, "signal red")
    i.disc(0.5, 0.5, 0.06, "green")


@icon
def beer(i: Ink, c: Color) -> None:
    i.ring(0.74, 0.58, 0.2, "mirror", 0.08)
    i.rect(0.16, 0.24, 0.7, 0.98, "#f0a818", 0.04)
    for x in (0.27, 0.43, 0.59):
        i.rect(x - 0.03, 0.4, x + 0.03, 0.9, "#d48a0c")
    for x in (0.2, 0.38, 0.56, 0.68):
        i.disc(x, 0.2, 0.13, "white")
    i.rect(0.14, 0.2, 0.72, 0.32, "white")


@icon
def fish(i: Ink, c: Color) -> None:
    i.poly([(0.65, 0.5), (1.0, 0.24), (1.0, 0.76)], c)
    i.disc(0.42, 0.5, 0.4, c, 0.24)
    i.disc(0.17, 0.44, 0.06, "white")
    i.disc(0.17, 0.44, 0.03, "black")
    i.arc(0.1, 0.5, 0.22, -50, 50, "white", 0.03)
    i.poly([(0.34, 0.28), (0.6, 0.28), (0.5, 0.12)], c)


@icon
def crab(i: Ink, c: Color) -> None:
    for s in (-1, 1):
        for y in (0.62, 0.72, 0.82):
            i.line([(0.5, 0.65), (0.5 + s * 0.36, y), (0.5 + s * 0.44, y + 0.12)], "signal red", 0.05)
        i.line([(0.5 + s * 0.25, 0.55), (0.5 + s * 0.4, 0.36)], "signal red", 0.07)
        i.disc(0.5 + s * 0.38, 0.24, 0.14, "signal red")
        i.poly([(0.5 + s * 0.38, 0.24), (0.5 + s * 0.3, 0.06), (0.5 + s * 0.46, 0.06)], "cream")
    i.disc(0.5, 0.62, 0.3, "signal red", 0.22)
    for s in (-0.08, 0.08):
        i.disc(0.5 + s, 0.42, 0.05, "white")


@icon
def bread(i: Ink, c: Color) -> None:
    i.disc(0.5, 0.6, 0.48, "#b8742f", 0.28)
    for x in (0.28, 0.5, 0.72):
        i.line([(x - 0.06, 0.7), (x + 0.06, 0.44)], "cream", 0.05)


def drawn(name: str, size: int, color: Color, back: Color) -> np.ndarray:
    """(size, size, 3): one pictogram on a plain ground with a margin."""
    image, pen = paint.canvas(paint.smooth((size, size), 3), back)
    side = 3 * size
    ICONS[name](Ink(pen, 0.12 * side, 0.12 * side, 0.76 * side), color)
    return np.asarray(paint.shrunk(image, (size, size)))
