"""Wheels with images of rims, number plates and stands, shared by the vehicles."""

import functools
from collections.abc import Sequence

import numpy as np
from PIL import Image

from ...meshes import paint
from ...meshes.mesh_builder import MeshBuilder
from ...meshes.palette import Color, rgb
from ...meshes.shapes import Point2, Point3


@functools.cache
def rim_image(style: str, color: Color = "aluminium", size: int = 48) -> Image.Image:
    """A rim seen from outside, with the tyre's black beyond it: "spokes5", "spokes10", "steel", "cap" or "truck"."""
    scale = 4
    n = size * scale
    image, pen = paint.canvas((n, n), (24, 24, 26))
    centre, radius = n / 2, n / 2 * 0.97

    def disc(share: float, fill: Color) -> None:
        r = radius * share
        pen.ellipse((centre - r, centre - r, centre + r, centre + r), fill=rgb(fill))

    def at(share: float, angle: float) -> tuple[float, float]:
        return centre + radius * share * np.cos(angle), centre + radius * share * np.sin(angle)

    disc(1.0, color)
    if style in ("spokes5", "spokes10"):
        disc(0.9, (30, 31, 34))
        count = 5 if style == "spokes5" else 10
        wide = 0.32 if count == 5 else 0.13
        for k in range(count):
            a = 2 * np.pi * k / count - np.pi / 2
            pen.polygon(
                [at(0.95, a - wide * 0.6), at(0.95, a + wide * 0.6), at(0.2, a + wide * 2), at(0.2, a - wide * 2)],
                fill=rgb(color),
            )
        disc(0.24, color)
        disc(0.13, (70, 72, 76))
    else:
        disc(0.88, (96, 98, 102) if style != "cap" else (150, 153, 157))
        disc(0.82, color)
        for k in range(8 if style != "truck" else 10):
            x, y = at(0.6, 2 * np.pi * k / (8 if style != "truck" else 10))
            r = radius * (0.1 if style != "truck" else 0.13)
            pen.ellipse((x - r, y - r, x + r, y + r), fill=(40, 41, 44))
        disc(0.36, (110, 112, 116) if style == "truck" else color)
        disc(0.2, (60, 62, 66))
    return paint.shrunk(image, (size, size))


def wheel(
    builder: MeshBuilder,
    at: tuple[float, float, float],
    radius: float,
    width: float,
    rim: Image.Image,
    outside: float,
    rim_share: float = 0.66,
    segments: int = 18,
) -> None:
    """A tyre with its axle along y, centred on `at`; the rim's image faces `outside` (+1 left, -1 right)."""
    half, shoulder = width / 2, min(0.3 * width, 0.18 * radius)
    profile = [
        (radius * 0.3, -half * 0.5),
        (radius * 0.9, -half),
        (radius, -half + shoulder),
        (radius, half - shoulder),
        (radius * 0.93, half),
        (radius * rim_share, half),
        (radius * rim_share, half - 0.03),
    ]
    with builder.frame(at, (-90.0 * outside, 0, 0)):
        builder.lathe(profile, (0, 0, 0), "rubber", segments=segments)
    side = radius * rim_share * 2.02
    builder.panel(rim, (at[0], at[1] + outside * (half - 0.018), at[2]), side, side, "+y" if outside > 0 else "-y")


def two_legged_stand(b: MeshBuilder, top: Point3, foot: Point2, radius: float) -> None:
    """What a parked two-wheeler stands on, a leg at each side: upright on one leg it would fall to the other side.

    Args:
      top: m, upper end of the left leg.
      foot: m, where it meets the ground.
      radius: m, of a leg.
    """
    x, y, z = (float(t) for t in top)
    aside = np.hypot(foot[0] - x, foot[1] - y)
    # The end of a slanting leg is a slanting disc: its lowest point is what stands.
    low = radius * aside / np.hypot(aside, z)
    for side in (1, -1):
        b.rod((x, side * y, z), (foot[0], side * foot[1], low), radius, "dark grey", sides=5)


@functools.cache
def road_wheels(
    b: MeshBuilder,
    axles: Sequence[float],
    radius: float,
    half_width: float,
    tyre: float = 0.30,
    segments: int = 14,
) -> None:
    """Pairs of truck wheels whose outsides are `half_width` from the middle; `tyre` is their width, m."""
    rim = rim_image("truck", "light grey")
    for x in axles:
        for side in (-1.0, 1.0):
            wheel(b, (x, side * (half_width - tyre / 2), radius), radius, tyre, rim, side, segments=segments)


def number_plate(
    text: str, back: Color = "white", ink: Color = "black", size: tuple[int, int] = (64, 16)
) -> Image.Image:
    """A number plate."""
    big = paint.smooth(size)
    image, pen = paint.canvas(big, back)
    pen.rectangle((0, 0, big[0] - 1, big[1] - 1), outline=rgb(ink), width=4)
    paint.text(pen, text, (big[0] * 0.06, big[1] * 0.16, big[0] * 0.94, big[1] * 0.84), ink, 0.03)
    return paint.shrunk(image, size)


@functools.cache
def grille_image(style: str, size: tuple[int, int] = (64, 24)) -> Image.Image:
    """A radiator grille: "bars", "mesh" or "twin"."""
    big = paint.smooth(size)
    image, pen = paint.canvas(big, (22, 22, 24))
    w, h = big
    if style == "bars":
        for k in range(1, 6):
            pen.rectangle((0, h * k / 6 - 3, w, h * k / 6 + 3), fill=(150, 152, 156))
    elif style == "mesh":
        for k in range(-6, 30):
            pen.line((k * w / 24, 0, k * w / 24 + h, h), fill=(70, 72, 76), width=4)
            pen.line((k * w / 24, h, k * w / 24 + h, 0), fill=(70, 72, 76), width=4)
    else:
        for k in range(1, 20):
            pen.rectangle((w * k / 20 - 2, 0, w * k / 20 + 2, h), fill=(120, 122, 126))
        pen.rectangle((w * 0.47, 0, w * 0.53, h), fill=(200, 203, 206))
    pen.rectangle((0, 0, w - 1, h - 1), outline=(205, 208, 212), width=6)
    pen.ellipse((w / 2 - h * 0.22, h * 0.28, w / 2 + h * 0.22, h * 0.72), fill=(215, 218, 222))
    return paint.shrunk(image, size)
