"""Taxis and police cars."""

import numpy as np

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset
from ...meshes.palette import Color
from ...meshes.recipe import recipe
from .car_build import CAR, CarStyle, build_car
from .car_shapes import MINIVAN, MINIVAN_PLACES, SEDAN, SEDAN_GLASS, SEDAN_PLACES, SUV, SUV_PLACES


def _chequer(size: tuple[int, int], first: Color, second: Color, rows: int = 2) -> np.ndarray:
    width, height = size
    y, x = np.mgrid[0:height, 0:width]
    cell = height // rows
    table = np.array([paint.rgb(first), paint.rgb(second)], np.uint8)
    return table[(x // cell + y // cell) % 2]


def _roof_sign(words: str, back: Color, ink: Color) -> np.ndarray:
    image, pen = paint.canvas((256, 80), back)
    paint.text(pen, words, (14, 10, 242, 70), ink, 0.03)
    return np.asarray(paint.shrunk(image, (64, 20)))


@recipe("taxi", 3, CAR, hulls=7, name="service_cars.taxi")
def taxi(variant: int, rng: np.random.Generator) -> BuiltAsset:
    color = ("signal yellow", "#e8e2c8", "black")[variant]
    base, places, glass = (
        (SEDAN, SEDAN_PLACES, SEDAN_GLASS),
        (SEDAN.stretched(1.03, 1.0, 1.02), SEDAN_PLACES, SEDAN_GLASS),
        (
            MINIVAN.stretched(0.96, 1.0, 1.04),
            MINIVAN_PLACES,
            {"pillars": ((0.05, 0.08), (-1.05, 0.10)), "span": (-2.15, 1.3)},
        ),
    )[variant]
    doors = (-1.02, -0.30, 0.84) if variant != 2 else (-1.0, 0.05, 1.1)
    style = CarStyle(
        color,
        rim=("cap", "spokes5", "spokes10")[variant],
        grille="bars",
        plate=("TX 1010", "TX 88", "TX 402")[variant],
        doors=doors,
    )
    builder, body = build_car(base, places, style, glass)
    z = base.upper[9][1] + 0.02
    back, ink = (("white", "black"), ("signal yellow", "black"), ("amber", "black"))[variant]
    sign = _roof_sign("TAXI", back, ink)
    builder.box((0.20, 0.62, 0.20), (-0.1, 0, z), back, taper=(0.6, 0.92), bevel=0.02)
    for facing, x in (("+x", 0.085), ("-x", -0.285)):
        builder.panel(sign, (x, 0, z + 0.10), 0.52, 0.16, facing, tilt_deg=11.0)
    middle = base.belt - 0.20
    if variant == 0:
        body.side_image(doors[0], doors[-1], middle - 0.07, middle + 0.07, _chequer((128, 8), "black", "signal yellow"))
    else:
        image, pen = paint.canvas((256, 64), color)
        paint.text(
            pen, "TAXI" if variant == 1 else "CAB 402", (8, 4, 248, 60), "black" if variant == 1 else "amber", 0.03
        )
        body.side_image(-0.15, 0.75, middle - 0.20, middle + 0.02, np.asarray(paint.shrunk(image, (64, 16))))
    names = ("A yellow taxi with a chequered band", "An ivory taxi saloon", "A black minicab taxi")
    return body.finish(names[variant], {"body": "taxi", "color": str(color)})


@recipe("police car", 3, CAR, hulls=7, name="service_cars.police_car")
def police_car(variant: int, rng: np.random.Generator) -> BuiltAsset:
    color = ("white", "black", "white")[variant]
    base, places, glass = (
        (SEDAN.stretched(1.02), SEDAN_PLACES, SEDAN_GLASS),
        (SEDAN.stretched(1.05, 1.02, 1.02), SEDAN_PLACES, SEDAN_GLASS),
        (SUV, SUV_PLACES, {"pillars": ((-0.24, 0.08), (-1.10, 0.10)), "span": (-2.1, 0.9)}),
    )[variant]
    doors = (-1.02, -0.28, 0.84)
    style = CarStyle(color, rim="steel", grille="mesh", plate=("POL 01", "POL 17", "POL 33")[variant], doors=doors)
    builder, body = build_car(base, places, style, glass)
    low, high = base.sill + 0.14, base.belt - 0.06
    if variant == 1:  # black and white: the doors are white
        body.side([(doors[0], low), (doors[-1], low), (doors[-1], high), (doors[0], high)], "white", 0.006)
    band = ("signal blue", "white", "signal blue")[variant]
    image, pen = paint.canvas((512, 96), band)
    if variant == 2:
        pixels = _chequer((512, 96), "signal yellow", "signal blue", 2)
        image, pen = paint.Image.fromarray(pixels), None
        pen = paint.ImageDraw.Draw(image)
        pen.rectangle((130, 14, 382, 82), fill=paint.rgb("signal blue"))
    paint.text(pen, "POLICE", (140, 14, 372, 82), "white" if variant != 1 else "black", 0.04)
    middle = (low + high) / 2 + 0.04
    half = 1.15 if variant != 1 else 0.72
    body.side_image(
        -0.12 - half, -0.12 + half, middle - 0.13, middle + 0.13, np.asarray(paint.shrunk(image, (128, 24)))
    )
    z = base.upper[9][1] + 0.01
    builder.box((0.26, 1.10, 0.05), (-0.2, 0, z), "charcoal")
    for side, lamp in ((-1.0, "signal blue"), (1.0, "signal red" if variant == 1 else "signal blue")):
        builder.box((0.24, 0.46, 0.11), (-0.2, side * 0.31, z + 0.05), lamp, bevel=0.03)
    builder.box((0.22, 0.14, 0.09), (-0.2, 0, z + 0.05), "white", bevel=0.02)
    names = (
        "A white police car with a blue band",
        "A black and white police car",
        "A police SUV with a chequered band",
    )
    return body.finish(names[variant], {"body": "police", "color": str(color)})
