"""Pictograms of further trades; importing this module enters them into `icons.ICONS`."""

import numpy as np

from ....meshes.palette import Color
from .icons import Ink, icon


@icon
def disco(i: Ink, c: Color) -> None:
    i.line([(0.5, 0.0), (0.5, 0.2)], "white", 0.03)
    i.disc(0.5, 0.58, 0.4, "mirror")
    colors = ("white", "purple", "light blue", "pink")
    for row in range(6):
        half = np.sqrt(max(0.4**2 - (0.13 * row - 0.33) ** 2, 0.0))
        for k in range(6):
            x = 0.5 - half + 2 * half * k / 6
            y = 0.25 + 0.115 * row
            i.rect(x + 0.01, y, x + half / 3 - 0.01, y + 0.09, colors[(k * 3 + row * 5) % 4])


@icon
def cocktail(i: Ink, c: Color) -> None:
    i.poly([(0.06, 0.1), (0.94, 0.1), (0.5, 0.56)], c)
    i.rect(0.47, 0.5, 0.53, 0.92, "white")
    i.rect(0.26, 0.9, 0.74, 0.97, "white")
    i.disc(0.8, 0.12, 0.12, "orange")
    i.line([(0.34, 0.3), (0.6, 0.0)], "white", 0.03)


@icon
def glasses(i: Ink, c: Color) -> None:
    for x in (0.25, 0.75):
        i.disc(x, 0.52, 0.2, "#bfe0ee", 0.17)
        i.ring(x, 0.52, 0.23, c, 0.06, 0.2)
    i.arc(0.5, 0.52, 0.08, 180, 360, c, 0.05)
    i.line([(0.03, 0.46), (0.0, 0.3)], c, 0.05)
    i.line([(0.97, 0.46), (1.0, 0.3)], c, 0.05)


@icon
def sunglasses(i: Ink, c: Color) -> None:
    i.rect(0.0, 0.34, 1.0, 0.43, c)
    for x in (0.04, 0.56):
        i.rect(x, 0.34, x + 0.4, 0.68, "black", 0.14)
        i.line([(x + 0.1, 0.56), (x + 0.22, 0.42)], "mirror", 0.05)


@icon
def eye(i: Ink, c: Color) -> None:
    i.poly([(0.0, 0.5), (0.28, 0.26), (0.5, 0.2), (0.72, 0.26), (1.0, 0.5), (0.72, 0.74), (0.5, 0.8), (0.28, 0.74)],
           "white")  # fmt: skip
    i.disc(0.5, 0.5, 0.22, c)
    i.disc(0.5, 0.5, 0.1, "black")


@icon
def camera(i: Ink, c: Color) -> None:
    i.rect(0.3, 0.14, 0.62, 0.32, "charcoal", 0.03)
    i.rect(0.02, 0.26, 0.98, 0.84, "charcoal", 0.07)
    i.rect(0.02, 0.36, 0.98, 0.44, c)
    i.disc(0.5, 0.56, 0.25, "aluminium")
    i.disc(0.5, 0.56, 0.18, "dark blue")
    i.disc(0.44, 0.5, 0.06, "white")
    i.disc(0.86, 0.33, 0.04, "signal red")


@icon
def portrait(i: Ink, c: Color) -> None:
    i.rect(0.08, 0.0, 0.92, 1.0, "gold")
    i.rect(0.15, 0.07, 0.85, 0.93, "light blue")
    i.poly([(0.2, 0.93), (0.28, 0.68), (0.5, 0.6), (0.72, 0.68), (0.8, 0.93)], c)
    i.disc(0.5, 0.4, 0.19, "dark wood", 0.23)
    i.disc(0.5, 0.44, 0.15, "skin light", 0.18)
    i.rect(0.08, 0.93, 0.92, 1.0, "gold")


@icon
def home(i: Ink, c: Color) -> None:
    i.poly([(0.5, 0.06), (1.0, 0.5), (0.0, 0.5)], "signal red")
    i.rect(0.14, 0.46, 0.86, 0.95, "cream")
    i.rect(0.42, 0.6, 0.62, 0.95, c)
    i.rect(0.22, 0.58, 0.36, 0.74, "light blue")


@icon
def listing(i: Ink, c: Color) -> None:
    i.rect(0.1, 0.0, 0.9, 1.0, "white")
    i.rect(0.17, 0.07, 0.83, 0.5, "light blue")
    i.poly([(0.5, 0.12), (0.74, 0.3), (0.26, 0.3)], "signal red")
    i.rect(0.32, 0.3, 0.68, 0.5, "cream")
    i.words("FOR SALE", 0.17, 0.56, 0.83, 0.74, "signal red")
    for y in (0.8, 0.88):
        i.rect(0.2, y, 0.8, y + 0.03, "grey")


@icon
def key(i: Ink, c: Color) -> None:
    i.ring(0.24, 0.5, 0.22, "gold", 0.09)
    i.rect(0.42, 0.45, 0.98, 0.55, "gold")
    i.rect(0.76, 0.5, 0.83, 0.72, "gold")
    i.rect(0.9, 0.5, 0.97, 0.68, "gold")


@icon
def bag(i: Ink, c: Color) -> None:
    i.arc(0.5, 0.32, 0.2, 180, 360, "black", 0.05)
    i.poly([(0.12, 0.3), (0.88, 0.3), (0.96, 0.98), (0.04, 0.98)], c)
    i.words("SALE", 0.18, 0.48, 0.82, 0.8, "white")


@icon
def heel(i: Ink, c: Color) -> None:
    i.poly([(0.04, 0.3), (0.2, 0.24), (0.42, 0.62), (0.78, 0.7), (0.99, 0.82), (0.97, 0.9), (0.6, 0.9), (0.34, 0.74),
            (0.14, 0.54)], c)  # fmt: skip
    i.poly([(0.06, 0.4), (0.18, 0.52), (0.13, 0.92), (0.08, 0.92)], c)


@icon
def sneaker(i: Ink, c: Color) -> None:
    i.poly([(0.02, 0.34), (0.3, 0.3), (0.42, 0.48), (0.6, 0.56), (0.9, 0.62), (0.98, 0.78), (0.02, 0.78)], c)
    i.rect(0.0, 0.76, 1.0, 0.88, "white", 0.05)
    for k in range(3):
        i.line([(0.38 + 0.09 * k, 0.46 + 0.05 * k), (0.3 + 0.09 * k, 0.6 + 0.04 * k)], "white", 0.04)
    i.line([(0.1, 0.7), (0.3, 0.56)], "white", 0.06)


@icon
def boot(i: Ink, c: Color) -> None:
    i.poly([(0.22, 0.04), (0.58, 0.04), (0.58, 0.56), (0.9, 0.64), (0.96, 0.84), (0.22, 0.84)], "#7a4a26")
    i.rect(0.2, 0.84, 0.98, 0.92, "black")
    i.rect(0.2, 0.84, 0.4, 0.98, "black")
    i.rect(0.22, 0.04, 0.58, 0.14, "cream")


@icon
def heart(i: Ink, c: Color) -> None:
    i.disc(0.3, 0.36, 0.23, "signal red")
    i.disc(0.7, 0.36, 0.23, "signal red")
    i.poly([(0.09, 0.44), (0.91, 0.44), (0.5, 0.96)], "signal red")
    i.line([(0.02, 0.76), (0.98, 0.24)], "aluminium", 0.06)
    i.poly([(0.98, 0.14), (1.0, 0.34), (0.84, 0.32)], "aluminium")
    i.rect(0.16, 0.46, 0.84, 0.64, "cream", 0.03)
    i.words("MOM", 0.26, 0.48, 0.74, 0.62, "black")


@icon
def skull(i: Ink, c: Color) -> None:
    i.line([(0.04, 0.7), (0.96, 0.98)], "white", 0.08)
    i.line([(0.96, 0.7), (0.04, 0.98)], "white", 0.08)
    i.disc(0.5, 0.4, 0.34, "white", 0.36)
    i.rect(0.33, 0.62, 0.67, 0.86, "white", 0.04)
    for x in (0.37, 0.63):
        i.disc(x, 0.44, 0.1, "black")
    i.poly([(0.5, 0.54), (0.55, 0.64), (0.45, 0.64)], "black")
    for x in (0.44, 0.56):
        i.line([(x, 0.72), (x, 0.86)], "black", 0.02)


@icon
def pipe(i: Ink, c: Color) -> None:
    i.line([(0.02, 0.3), (0.3, 0.42), (0.66, 0.78)], "black", 0.07)
    i.rect(0.58, 0.4, 0.94, 0.92, "#6b3518", 0.12)
    i.rect(0.56, 0.38, 0.96, 0.48, "#8a4a22", 0.03)
    i.arc(0.7, 0.2, 0.12, 90, 270, "mirror", 0.05)
    i.arc(0.7, 0.02, 0.1, -90, 90, "mirror", 0.05)


@icon
def cigars(i: Ink, c: Color) -> None:
    i.rect(0.02, 0.5, 0.98, 0.9, "#a5682c", 0.03)
    for k in range(6):
        i.rect(0.06 + 0.15 * k, 0.12, 0.18 + 0.15 * k, 0.6, "#5d3417", 0.05)
        i.rect(0.06 + 0.15 * k, 0.3, 0.18 + 0.15 * k, 0.4, "gold")
    i.words("HABANA", 0.1, 0.62, 0.9, 0.84, "cream")


@icon
def teddy(i: Ink, c: Color) -> None:
    for x in (0.28, 0.72):
        i.disc(x, 0.12, 0.11, "#a5692f")
        i.disc(x + (0.5 - x) * -0.35, 0.62, 0.12, "#a5692f", 0.16)
        i.disc(x + (0.5 - x) * 0.1, 0.9, 0.15, "#a5692f", 0.1)
    i.disc(0.5, 0.7, 0.27, "#a5692f", 0.25)
    i.disc(0.5, 0.3, 0.26, "#a5692f", 0.24)
    i.disc(0.5, 0.38, 0.12, "cream", 0.1)
    i.disc(0.5, 0.34, 0.045, "black")
    for x in (0.4, 0.6):
        i.disc(x, 0.24, 0.03, "black")
    i.disc(0.5, 0.72, 0.15, "cream", 0.15)


@icon
def blocks(i: Ink, c: Color) -> None:
    for x, y, color, letter in (
        (0.02, 0.52, "signal red", "A"),
        (0.52, 0.52, "signal blue", "B"),
        (0.27, 0.04, "signal yellow", "C"),
    ):
        i.rect(x, y, x + 0.46, y + 0.46, color, 0.04)
        i.words(letter, x + 0.09, y + 0.07, x + 0.37, y + 0.39, "white")


@icon
def plane(i: Ink, c: Color) -> None:
    i.poly([(0.5, 0.0), (0.57, 0.12), (0.57, 0.36), (1.0, 0.6), (1.0, 0.7), (0.57, 0.58), (0.55, 0.82), (0.7, 0.92),
            (0.7, 0.99), (0.5, 0.93), (0.3, 0.99), (0.3, 0.92), (0.45, 0.82), (0.43, 0.58), (0.0, 0.7), (0.0, 0.6),
            (0.43, 0.36), (0.43, 0.12)], c)  # fmt: skip


@icon
def beach(i: Ink, c: Color) -> None:
    i.rect(0.0, 0.0, 1.0, 1.0, "#7cc7ee")
    i.disc(0.78, 0.2, 0.13, "signal yellow")
    i.rect(0.0, 0.58, 1.0, 0.8, "#1c7fb5")
    i.rect(0.0, 0.78, 1.0, 1.0, "#f2dc9a")
    i.line([(0.34, 0.84), (0.4, 0.34)], "brown", 0.06)
    for a in (-2.9, -2.2, -1.2, -0.3, 0.3, 2.8):
        middle = (0.4 + 0.17 * np.cos(a), 0.3 + 0.14 * np.sin(a))
        i.line([(0.4, 0.34), middle, (0.4 + 0.3 * np.cos(a), 0.4 + 0.2 * np.sin(a))], "dark green", 0.06)


@icon
def gamepad(i: Ink, c: Color) -> None:
    i.disc(0.22, 0.6, 0.22, c, 0.28)
    i.disc(0.78, 0.6, 0.22, c, 0.28)
    i.rect(0.18, 0.32, 0.82, 0.68, c, 0.1)
    i.rect(0.14, 0.46, 0.38, 0.54, "white")
    i.rect(0.22, 0.38, 0.3, 0.62, "white")
    for x, y, color in (
        (0.66, 0.5, "signal yellow"),
        (0.76, 0.4, "signal red"),
        (0.86, 0.5, "light green"),
        (0.76, 0.6, "light blue"),
    ):
        i.disc(x, y, 0.05, color)


@icon
def invader(i: Ink, c: Color) -> None:
    rows = ("00100000100", "00010001000", "00111111100", "01101110110", "11111111111", "10111111101", "10100000101",
            "00011011000")  # fmt: skip
    for r, row in enumerate(rows):
        for k, bit in enumerate(row):
            if bit == "1":
                i.rect(k / 11, 0.1 + 0.1 * r, (k + 1.05) / 11, 0.205 + 0.1 * r, "light green")


@icon
def watch(i: Ink, c: Color) -> None:
    i.poly([(0.34, 0.0), (0.66, 0.0), (0.7, 0.3), (0.3, 0.3)], c)
    i.poly([(0.34, 1.0), (0.66, 1.0), (0.7, 0.7), (0.3, 0.7)], c)
    i.disc(0.5, 0.5, 0.32, "gold")
    i.disc(0.5, 0.5, 0.25, "white")
    i.line([(0.5, 0.5), (0.5, 0.32)], "black", 0.04)
    i.line([(0.5, 0.5), (0.64, 0.56)], "black", 0.04)


@icon
def clock(i: Ink, c: Color) -> None:
    i.disc(0.5, 0.5, 0.49, c)
    i.disc(0.5, 0.5, 0.42, "white")
    for k in range(12):
        a = np.pi * k / 6
        i.line([(0.5 + 0.33 * np.cos(a), 0.5 + 0.33 * np.sin(a)), (0.5 + 0.4 * np.cos(a), 0.5 + 0.4 * np.sin(a))],
               "black", 0.03)  # fmt: skip
    i.line([(0.5, 0.5), (0.5, 0.18)], "black", 0.045)
    i.line([(0.5, 0.5), (0.28, 0.4)], "black", 0.06)


@icon
def ball(i: Ink, c: Color) -> None:
    i.disc(0.5, 0.5, 0.48, "white")
    i.star(0.5, 0.5, 0.18, "black", 5, 0.8)
    for k in range(5):
        a = 1.257 * k - np.pi / 2
        i.disc(0.5 + 0.38 * np.cos(a), 0.5 + 0.38 * np.sin(a), 0.11, "black")


@icon
def dumbbell(i: Ink, c: Color) -> None:
    i.rect(0.1, 0.46, 0.9, 0.54, "aluminium")
    for x, y in ((0.06, 0.3), (0.18, 0.2), (0.72, 0.2), (0.84, 0.3)):
        i.rect(x, y, x + 0.1, 1 - y, c, 0.03)


@icon
def cross(i: Ink, c: Color) -> None:
    i.rect(0.36, 0.04, 0.64, 0.96, c)
    i.rect(0.04, 0.36, 0.96, 0.64, c)


@icon
def envelope(i: Ink, c: Color) -> None:
    i.rect(0.02, 0.2, 0.98, 0.8, c, 0.04)
    i.line([(0.04, 0.24), (0.5, 0.56), (0.96, 0.24)], "black", 0.05)


@icon
def book(i: Ink, c: Color) -> None:
    i.poly([(0.5, 0.3), (0.96, 0.16), (0.96, 0.76), (0.5, 0.9), (0.04, 0.76), (0.04, 0.16)], c)
    i.poly([(0.5, 0.34), (0.9, 0.22), (0.9, 0.7), (0.5, 0.82)], "white")
    i.poly([(0.5, 0.34), (0.1, 0.22), (0.1, 0.7), (0.5, 0.82)], "cream")
    i.line([(0.5, 0.32), (0.5, 0.86)], "black", 0.03)


@icon
def shield(i: Ink, c: Color) -> None:
    i.poly([(0.1, 0.1), (0.5, 0.0), (0.9, 0.1), (0.86, 0.6), (0.5, 1.0), (0.14, 0.6)], c)
    i.star(0.5, 0.46, 0.28, "gold", 6, 0.6)


@icon
def flame(i: Ink, c: Color) -> None:
    i.poly([(0.5, 0.0), (0.72, 0.32), (0.8, 0.24), (0.92, 0.64), (0.7, 0.98), (0.3, 0.98), (0.08, 0.64), (0.2, 0.4),
            (0.34, 0.46)], "signal red")  # fmt: skip
    i.poly([(0.52, 0.4), (0.7, 0.68), (0.6, 0.94), (0.4, 0.94), (0.3, 0.7)], "amber")
