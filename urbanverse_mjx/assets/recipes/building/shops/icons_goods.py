"""Pictograms of goods other than food; importing this module enters them into `icons.ICONS`."""

import numpy as np

from ....meshes.palette import Color
from .icons import Ink, icon


@icon
def bike(i: Ink, c: Color) -> None:
    for x in (0.22, 0.78):
        i.ring(x, 0.66, 0.21, "black", 0.045)
    i.line([(0.22, 0.66), (0.38, 0.34), (0.68, 0.34), (0.48, 0.66), (0.22, 0.66)], c, 0.045)
    i.line([(0.38, 0.34), (0.48, 0.66)], c, 0.045)
    i.line([(0.78, 0.66), (0.65, 0.24), (0.78, 0.2)], c, 0.045)
    i.line([(0.38, 0.36), (0.35, 0.25)], c, 0.04)
    i.rect(0.26, 0.21, 0.45, 0.27, "black", 0.02)


@icon
def car(i: Ink, c: Color) -> None:
    i.poly([(0.2, 0.52), (0.34, 0.3), (0.68, 0.3), (0.84, 0.52)], c)
    i.poly([(0.28, 0.5), (0.38, 0.35), (0.49, 0.35), (0.49, 0.5)], "light blue")
    i.poly([(0.53, 0.5), (0.53, 0.35), (0.65, 0.35), (0.75, 0.5)], "light blue")
    i.rect(0.02, 0.5, 0.98, 0.74, c, 0.07)
    for x in (0.24, 0.77):
        i.disc(x, 0.74, 0.12, "black")
        i.disc(x, 0.74, 0.055, "aluminium")
    i.disc(0.95, 0.57, 0.03, "signal yellow")


@icon
def tyre(i: Ink, c: Color) -> None:
    i.disc(0.5, 0.5, 0.48, "black")
    i.disc(0.5, 0.5, 0.27, "aluminium")
    for k in range(5):
        i.disc(0.5 + 0.16 * np.cos(1.257 * k), 0.5 + 0.16 * np.sin(1.257 * k), 0.06, "black")


@icon
def dice(i: Ink, c: Color) -> None:
    i.rect(0.08, 0.08, 0.92, 0.92, "white", 0.12)
    for x, y in ((0.28, 0.28), (0.72, 0.28), (0.5, 0.5), (0.28, 0.72), (0.72, 0.72)):
        i.disc(x, y, 0.09, "signal red")


@icon
def ace(i: Ink, c: Color) -> None:
    i.rect(0.16, 0.02, 0.84, 0.98, "white", 0.07)
    i.poly([(0.5, 0.2), (0.74, 0.54), (0.26, 0.54)], "black")
    i.disc(0.37, 0.56, 0.13, "black")
    i.disc(0.63, 0.56, 0.13, "black")
    i.poly([(0.5, 0.5), (0.62, 0.82), (0.38, 0.82)], "black")


@icon
def slots(i: Ink, c: Color) -> None:
    i.rect(0.06, 0.2, 0.94, 0.84, "gold", 0.08)
    for k in range(3):
        i.rect(0.14 + 0.25 * k, 0.32, 0.36 + 0.25 * k, 0.72, "white")
        i.words("7", 0.16 + 0.25 * k, 0.34, 0.34 + 0.25 * k, 0.7, "signal red")


@icon
def clapper(i: Ink, c: Color) -> None:
    i.rect(0.06, 0.42, 0.94, 0.92, "black")
    i.rect(0.06, 0.3, 0.94, 0.42, "white")
    i.poly([(0.05, 0.26), (0.88, 0.04), (0.92, 0.17), (0.08, 0.39)], "white")
    for k in range(4):
        i.poly(
            [(0.1 + 0.22 * k, 0.42), (0.2 + 0.22 * k, 0.42), (0.26 + 0.22 * k, 0.3), (0.16 + 0.22 * k, 0.3)], "black"
        )
    i.words("FILM", 0.2, 0.52, 0.8, 0.82, "white")


@icon
def comic(i: Ink, c: Color) -> None:
    i.star(0.5, 0.5, 0.52, "signal red", 11, 0.66)
    i.star(0.5, 0.5, 0.42, "signal yellow", 11, 0.7)
    i.words("POW!", 0.2, 0.32, 0.8, 0.68, "black")


@icon
def hero(i: Ink, c: Color) -> None:
    i.poly([(0.3, 0.34), (0.7, 0.34), (0.92, 0.98), (0.08, 0.98)], "signal red")
    i.disc(0.5, 0.18, 0.14, "skin light")
    i.rect(0.36, 0.12, 0.64, 0.2, "black")
    i.rect(0.32, 0.32, 0.68, 0.72, "signal blue", 0.05)
    i.star(0.5, 0.48, 0.14, "signal yellow")
    for x in (0.34, 0.54):
        i.rect(x, 0.7, x + 0.12, 0.98, "signal blue")


@icon
def printer(i: Ink, c: Color) -> None:
    i.rect(0.24, 0.04, 0.76, 0.4, "white")
    i.rect(0.04, 0.34, 0.96, 0.76, "dark grey", 0.05)
    i.rect(0.2, 0.62, 0.8, 0.98, "white")
    for k in range(3):
        i.rect(0.27, 0.7 + 0.09 * k, 0.73, 0.73 + 0.09 * k, c)
    i.disc(0.86, 0.46, 0.04, "light green")


@icon
def sheets(i: Ink, c: Color) -> None:
    for k, (x, color) in enumerate(((0.05, "cream"), (0.2, c), (0.35, "white"))):
        i.rect(x, 0.08 + 0.07 * k, x + 0.55, 0.82 + 0.07 * k, color)
    for k in range(5):
        i.rect(0.42, 0.34 + 0.11 * k, 0.82 - 0.1 * (k % 2), 0.38 + 0.11 * k, "black")


@icon
def lipstick(i: Ink, c: Color) -> None:
    i.rect(0.3, 0.58, 0.7, 0.98, "black", 0.03)
    i.rect(0.35, 0.42, 0.65, 0.6, "gold")
    i.poly([(0.38, 0.44), (0.38, 0.18), (0.62, 0.04), (0.62, 0.44)], "#d8184a")


@icon
def perfume(i: Ink, c: Color) -> None:
    i.rect(0.2, 0.4, 0.8, 0.96, c, 0.08)
    i.rect(0.42, 0.24, 0.58, 0.42, "gold")
    i.disc(0.5, 0.16, 0.14, "gold", 0.12)
    i.rect(0.32, 0.56, 0.68, 0.8, "white")


@icon
def hanger(i: Ink, c: Color) -> None:
    i.arc(0.5, 0.12, 0.09, 150, 450, "dark grey", 0.035)
    i.line([(0.5, 0.2), (0.5, 0.26)], "dark grey", 0.035)
    i.poly([(0.36, 0.26), (0.64, 0.26), (0.98, 0.42), (0.9, 0.6), (0.74, 0.52), (0.74, 0.98), (0.26, 0.98),
            (0.26, 0.52), (0.1, 0.6), (0.02, 0.42)], c)  # fmt: skip
    i.poly([(0.4, 0.26), (0.6, 0.26), (0.5, 0.4)], "white")
    for y in (0.5, 0.64, 0.78):
        i.disc(0.5, y, 0.025, "white")


@icon
def vape(i: Ink, c: Color) -> None:
    i.rect(0.36, 0.44, 0.64, 1.0, c, 0.04)
    i.rect(0.42, 0.28, 0.58, 0.46, "aluminium")
    i.disc(0.5, 0.6, 0.06, "light green")
    for x, y, r in ((0.56, 0.2, 0.1), (0.68, 0.12, 0.13), (0.84, 0.16, 0.11)):
        i.disc(x, y, r, "mirror")


@icon
def television(i: Ink, c: Color) -> None:
    i.rect(0.0, 0.14, 1.0, 0.78, "black", 0.03)
    i.rect(0.04, 0.18, 0.96, 0.74, "light blue")
    i.poly([(0.04, 0.74), (0.34, 0.36), (0.56, 0.62), (0.7, 0.48), (0.96, 0.74)], "green")
    i.disc(0.78, 0.32, 0.08, "signal yellow")
    i.rect(0.3, 0.84, 0.7, 0.9, "dark grey")
    i.rect(0.46, 0.76, 0.54, 0.88, "dark grey")


@icon
def phone(i: Ink, c: Color) -> None:
    i.rect(0.26, 0.02, 0.74, 0.98, "black", 0.08)
    i.rect(0.31, 0.1, 0.69, 0.86, c)
    for k in range(6):
        i.rect(0.35 + 0.16 * (k % 2), 0.16 + 0.2 * (k // 2), 0.47 + 0.16 * (k % 2), 0.3 + 0.2 * (k // 2), "white", 0.03)


@icon
def computer(i: Ink, c: Color) -> None:
    i.rect(0.04, 0.08, 0.96, 0.7, "charcoal", 0.04)
    i.rect(0.1, 0.14, 0.9, 0.64, c)
    i.words("@", 0.3, 0.16, 0.7, 0.62, "white")
    i.rect(0.42, 0.7, 0.58, 0.84, "dark grey")
    i.rect(0.12, 0.84, 0.88, 0.94, "light grey", 0.03)


@icon
def wifi(i: Ink, c: Color) -> None:
    for r in (0.24, 0.44, 0.64):
        i.arc(0.5, 0.82, r, 225, 315, c, 0.1)
    i.disc(0.5, 0.82, 0.09, c)


@icon
def sofa(i: Ink, c: Color) -> None:
    i.rect(0.1, 0.22, 0.9, 0.66, c, 0.1)
    i.line([(0.5, 0.26), (0.5, 0.6)], "black", 0.02)
    i.rect(0.0, 0.4, 0.2, 0.82, c, 0.08)
    i.rect(0.8, 0.4, 1.0, 0.82, c, 0.08)
    i.rect(0.16, 0.58, 0.84, 0.82, "cream", 0.05)
    for x in (0.08, 0.86):
        i.rect(x, 0.82, x + 0.06, 0.94, "dark wood")


@icon
def lamp(i: Ink, c: Color) -> None:
    i.poly([(0.32, 0.04), (0.68, 0.04), (0.9, 0.44), (0.1, 0.44)], "amber")
    i.poly([(0.36, 0.08), (0.64, 0.08), (0.74, 0.44), (0.26, 0.44)], "lamp")
    i.rect(0.47, 0.44, 0.53, 0.9, "black")
    i.disc(0.5, 0.92, 0.24, "black", 0.06)


@icon
def bulb(i: Ink, c: Color) -> None:
    for k in range(7):
        a = np.pi * (k + 0.0) / 6 + np.pi
        i.line([(0.5 + 0.38 * np.cos(a), 0.42 + 0.38 * np.sin(a)), (0.5 + 0.5 * np.cos(a), 0.42 + 0.5 * np.sin(a))],
               "amber", 0.04)  # fmt: skip
    i.disc(0.5, 0.4, 0.3, "#ffe97a")
    i.poly([(0.32, 0.6), (0.68, 0.6), (0.62, 0.78), (0.38, 0.78)], "#ffe97a")
    i.rect(0.38, 0.76, 0.62, 0.96, "aluminium", 0.03)


@icon
def hammer(i: Ink, c: Color) -> None:
    i.line([(0.16, 0.95), (0.62, 0.32)], "wood", 0.11)
    i.poly([(0.36, 0.12), (0.5, 0.02), (0.94, 0.36), (0.84, 0.52)], "dark grey")


@icon
def wrench(i: Ink, c: Color) -> None:
    i.line([(0.2, 0.82), (0.74, 0.28)], "aluminium", 0.15)
    i.arc(0.78, 0.22, 0.22, -10, 280, "aluminium", 0.11)
    i.ring(0.2, 0.82, 0.16, "aluminium", 0.09)


@icon
def saw(i: Ink, c: Color) -> None:
    i.poly([(0.25, 0.36), (1.0, 0.5), (1.0, 0.62), (0.25, 0.76)], "aluminium")
    for k in range(8):
        x = 0.27 + 0.09 * k
        i.poly([(x, 0.73 - 0.017 * k), (x + 0.09, 0.72 - 0.017 * k), (x + 0.045, 0.84 - 0.02 * k)], "aluminium")
    i.ring(0.17, 0.55, 0.2, c, 0.1)


@icon
def diamond(i: Ink, c: Color) -> None:
    i.poly([(0.22, 0.14), (0.78, 0.14), (1.0, 0.4), (0.5, 0.95), (0.0, 0.4)], "#8fd0ee")
    i.poly([(0.36, 0.4), (0.64, 0.4), (0.5, 0.95)], "#d5f0fb")
    i.line([(0.0, 0.4), (1.0, 0.4)], "white", 0.03)
    i.line([(0.22, 0.14), (0.36, 0.4), (0.5, 0.14), (0.64, 0.4), (0.78, 0.14)], "white", 0.03)


@icon
def goldring(i: Ink, c: Color) -> None:
    i.ring(0.5, 0.66, 0.32, "gold", 0.08)
    i.poly([(0.34, 0.1), (0.66, 0.1), (0.78, 0.22), (0.5, 0.42), (0.22, 0.22)], "#c7ecfb")
    i.line([(0.22, 0.22), (0.78, 0.22)], "white", 0.025)


@icon
def washer(i: Ink, c: Color) -> None:
    i.rect(0.08, 0.02, 0.92, 0.98, "white", 0.04)
    i.rect(0.08, 0.02, 0.92, 0.2, "light grey", 0.04)
    i.disc(0.78, 0.11, 0.05, c)
    i.rect(0.16, 0.07, 0.42, 0.15, c)
    i.disc(0.5, 0.6, 0.31, "dark grey")
    i.disc(0.5, 0.6, 0.24, "light blue")
    i.arc(0.5, 0.66, 0.16, 200, 340, "white", 0.05)


@icon
def lotus(i: Ink, c: Color) -> None:
    for dx, dy in ((-0.36, 0.08), (0.36, 0.08), (-0.2, -0.1), (0.2, -0.1), (0.0, -0.2)):
        i.poly([(0.5, 0.86), (0.42 + dx, 0.52 + dy), (0.5 + dx * 1.25, 0.24 + dy), (0.58 + dx, 0.52 + dy)], c)
    i.line([(0.1, 0.92), (0.9, 0.92)], c, 0.05)


@icon
def massage(i: Ink, c: Color) -> None:
    i.rect(0.0, 0.66, 1.0, 0.74, "light wood")
    i.rect(0.1, 0.74, 0.16, 0.98, "wood")
    i.rect(0.84, 0.74, 0.9, 0.98, "wood")
    i.disc(0.14, 0.54, 0.11, "skin light")
    i.rect(0.22, 0.48, 0.62, 0.66, "skin light", 0.08)
    i.rect(0.52, 0.46, 0.98, 0.66, "white", 0.06)
    i.line([(0.62, 0.1), (0.5, 0.3), (0.4, 0.48)], "skin medium", 0.09)
    i.disc(0.66, 0.1, 0.1, "skin medium")


@icon
def guitar(i: Ink, c: Color) -> None:
    i.line([(0.5, 0.55), (0.5, 0.02)], "dark wood", 0.07)
    i.rect(0.42, 0.0, 0.58, 0.12, "black")
    i.disc(0.5, 0.52, 0.2, "#c9742c")
    i.disc(0.5, 0.76, 0.28, "#c9742c", 0.23)
    i.disc(0.5, 0.62, 0.09, "black")
    i.rect(0.4, 0.8, 0.6, 0.85, "black")


@icon
def violin(i: Ink, c: Color) -> None:
    i.line([(0.5, 0.5), (0.5, 0.04)], "black", 0.06)
    i.disc(0.5, 0.5, 0.17, "#7a3413")
    i.disc(0.5, 0.8, 0.21, "#7a3413", 0.18)
    i.rect(0.38, 0.5, 0.62, 0.8, "#7a3413")
    i.line([(0.82, 0.1), (0.72, 0.98)], "cream", 0.03)


@icon
def note(i: Ink, c: Color) -> None:
    i.disc(0.24, 0.82, 0.17, c, 0.13)
    i.disc(0.74, 0.72, 0.17, c, 0.13)
    i.rect(0.34, 0.14, 0.41, 0.82, c)
    i.rect(0.84, 0.06, 0.91, 0.72, c)
    i.poly([(0.34, 0.14), (0.91, 0.04), (0.91, 0.24), (0.34, 0.34)], c)
