"""Warning signs, and the other plates that stand at every junction: give way, crossing, roundabout, one way."""

import numpy as np
from PIL import Image, ImageDraw

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, rgb
from ...meshes.recipe import recipe
from ...meshes.shapes import Point2
from ..shared.sizes import fitted
from .signs import PX, SCALE, done, face, ngon, rectangle
from .speed_limits import sign_post

#: A plate that stands on its base, and one that stands on its tip; corners (right, up) over a unit side.
UPRIGHT = ((-0.5, -0.433), (0.5, -0.433), (0.0, 0.433))
INVERTED = ((0.5, 0.433), (-0.5, 0.433), (0.0, -0.433))


def walker(draw: ImageDraw.ImageDraw, at: Point2, size: float, color: Color) -> None:
    """A walking figure `size` pixels tall whose head's top is at `at`."""
    x, y = at
    ink = rgb(color)

    def place(points: tuple[Point2, ...]) -> list[Point2]:
        return [(x + px * size, y + py * size) for px, py in points]

    draw.ellipse((x - 0.085 * size, y, x + 0.085 * size, y + 0.17 * size), fill=ink)
    for limb, width in (
        (((0.0, 0.22), (-0.01, 0.52)), 0.17),
        (((0.0, 0.50), (0.10, 0.72), (0.20, 0.98)), 0.10),
        (((0.0, 0.50), (-0.08, 0.74), (-0.20, 0.98)), 0.10),
        (((0.02, 0.24), (0.16, 0.40), (0.24, 0.50)), 0.075),
        (((-0.02, 0.24), (-0.14, 0.40), (-0.22, 0.44)), 0.075),
    ):
        draw.line(place(limb), fill=ink, width=round(width * size), joint="curve")


def triangle_face(symbol: str, rim: Color = "signal red", ground: Color = "white") -> Image.Image:
    """A warning triangle over its own box: "!", "walker", "bend" or "bumps"."""
    image, draw = face(rim, PX, PX * 7 // 8)
    w, h = image.size
    draw.polygon([(w / 2, h * 0.22), (w * 0.13, h * 0.91), (w * 0.87, h * 0.91)], fill=rgb(ground))
    if symbol == "!":
        draw.polygon([(w * 0.45, h * 0.40), (w * 0.55, h * 0.40), (w * 0.525, h * 0.70), (w * 0.475, h * 0.70)], fill=0)
        draw.ellipse((w * 0.46, h * 0.75, w * 0.54, h * 0.85), fill=0)
    elif symbol == "walker":
        walker(draw, (w * 0.5, h * 0.40), h * 0.48, "black")
    elif symbol == "bend":
        points = [(w * 0.44, h * 0.86), (w * 0.44, h * 0.70), (w * 0.56, h * 0.62), (w * 0.56, h * 0.50)]
        draw.line(points, fill=0, width=round(w * 0.055), joint="curve")
        draw.polygon([(w * 0.56, h * 0.38), (w * 0.50, h * 0.52), (w * 0.62, h * 0.52)], fill=0)
    else:
        draw.rectangle((w * 0.24, h * 0.78, w * 0.76, h * 0.84), fill=0)
        for x in (0.38, 0.62):
            draw.pieslice((w * (x - 0.11), h * 0.64, w * (x + 0.11), h * 0.92), 180, 360, fill=0)
    return done(image)


def _diamond_face() -> Image.Image:
    """A yellow diamond with a winding arrow."""
    n = PX * SCALE
    image, draw = face("signal yellow")
    draw.polygon([(n / 2, 18), (n - 18, n / 2), (n / 2, n - 18), (18, n / 2)], outline=0, width=9)
    points = [(n * 0.44, n * 0.74), (n * 0.44, n * 0.60), (n * 0.57, n * 0.50), (n * 0.57, n * 0.40)]
    draw.line(points, fill=0, width=n // 14, joint="curve")
    draw.polygon([(n * 0.57, n * 0.24), (n * 0.47, n * 0.41), (n * 0.67, n * 0.41)], fill=0)
    return done(image)


def _caution_plate(words: str) -> Image.Image:
    image, draw = face("signal yellow", PX, PX // 2)
    w, h = image.size
    draw.rectangle((6, 6, w - 6, h - 6), outline=0, width=8)
    paint.text(draw, words, (w * 0.06, h * 0.16, w * 0.94, h * 0.84), "black", 0.05)
    return done(image)


@recipe("caution sign", 4, name="warning_signs.caution_sign")
def caution_sign(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.45)
    side, height = ((0.84, 2.50), (0.95, 2.75), (0.88, 2.65), (0.72, 2.35))[variant]
    if variant == 1:
        sign_post(b, height - 0.05, height - side, height, "square")
        b.plate(ngon(4, side / 2), 0.006, (0, 0, height - side / 2), _diamond_face(), "signal yellow")
        name = "A yellow warning diamond for a winding road"
    else:
        symbol, ground = (("!", "white"), ("", ""), ("walker", "white"), ("bumps", "signal yellow"))[variant]
        tall = side * 0.866
        plate = 0.34 if variant == 0 else 0.0
        sign_post(b, height - 0.12, height - tall, height, ("round", "", "round", "wooden")[variant])
        outline = [(x * side, z * side) for x, z in UPRIGHT]
        b.plate(outline, 0.006, (0, 0, height - tall / 2), triangle_face(symbol, ground=ground), "signal red")
        if plate:
            image = _caution_plate("CAUTION")
            b.plate(rectangle(0.68, plate), 0.006, (0, 0, height - tall - 0.03 - plate / 2), image)
        name = ("A warning triangle with CAUTION", "", "A warning triangle for pedestrians", "A speed bump warning")[
            variant
        ]
    return fitted(b.build(name, {"side": side}), (0, side, height))


def _crossing_face() -> Image.Image:
    n = PX * SCALE
    image, draw = face("signal blue")
    draw.rectangle((8, 8, n - 8, n - 8), outline=rgb("white"), width=8)
    draw.polygon([(n / 2, n * 0.12), (n * 0.08, n * 0.88), (n * 0.92, n * 0.88)], fill=rgb("white"))
    walker(draw, (n * 0.5, n * 0.28), n * 0.48, "black")
    for k in range(4):
        x = n * (0.19 + 0.17 * k)
        draw.polygon(
            [(x, n * 0.86), (x + n * 0.09, n * 0.86), (x + n * 0.11, n * 0.79), (x + n * 0.02, n * 0.79)], fill=0
        )
    return done(image)


def _yield_face() -> Image.Image:
    image, draw = face("signal red", PX, PX * 7 // 8)
    w, h = image.size
    draw.polygon([(w * 0.13, h * 0.10), (w * 0.87, h * 0.10), (w / 2, h * 0.78)], fill=rgb("white"))
    return done(image)


def _roundabout_face() -> Image.Image:
    n = PX * SCALE
    image, draw = face("signal blue")
    ink, c, r = rgb("white"), n / 2, n * 0.27
    for k in range(3):
        start = 120 * k + 10
        draw.arc((c - r, c - r, c + r, c + r), start, start + 70, fill=ink, width=n // 13)
        a = np.radians(start - 6)
        tip = [c + (r - n / 26) * np.cos(a - 0.38), c + (r - n / 26) * np.sin(a - 0.38)]
        wings = [(c + (r - n / 26 + d) * np.cos(a + 0.12), c + (r - n / 26 + d) * np.sin(a + 0.12)) for d in (-42, 42)]
        draw.polygon([tuple(tip), *wings], fill=ink)
    return done(image)


def _one_way_face() -> Image.Image:
    image, draw = face("signal blue", PX, PX // 2)
    w, h = image.size
    points = [(0.05, 0.34), (0.68, 0.34), (0.68, 0.12), (0.95, 0.5), (0.68, 0.88), (0.68, 0.66), (0.05, 0.66)]
    draw.polygon([(w * x, h * y) for x, y in points], fill=rgb("white"))
    paint.text(draw, "ONE WAY", (w * 0.09, h * 0.40, w * 0.72, h * 0.60), "signal blue", 0.05)
    return done(image)


@recipe("traffic sign", 4, name="warning_signs.traffic_sign")
def traffic_sign(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.45)
    side, height = ((0.68, 2.50), (0.90, 2.60), (0.62, 2.30), (0.80, 2.75))[variant]
    tall = side * (1.0, 0.866, 1.0, 0.5)[variant]
    kind = ("round", "round", "square", "wooden")[variant]
    sign_post(b, height - 0.03, height - tall, height, kind)
    middle = (0, 0, height - tall / 2)
    if variant == 0:
        b.plate(rectangle(side, side), 0.006, middle, _crossing_face())
    elif variant == 1:
        b.plate([(-x * side, z * side) for x, z in INVERTED][::-1], 0.006, middle, _yield_face(), "signal red")
    elif variant == 2:
        b.plate(ngon(32, side / 2), 0.006, middle, _roundabout_face())
    else:
        b.plate(rectangle(side, tall), 0.006, middle, _one_way_face())
    names = ("A pedestrian crossing sign", "A give way triangle", "A roundabout sign", "A one way sign")
    return fitted(b.build(names[variant], {"kind": names[variant][2:], "side": side}), (0, side, height))
