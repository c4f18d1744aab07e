"""Passenger cars: sedan, hatchback, SUV, van, minivan, pickup."""

import dataclasses

import numpy as np

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset
from ...meshes.recipe import recipe
from .car_build import CAR, CarStyle, build_car, roof_rails
from .car_shapes import (
    HATCHBACK,
    HATCHBACK_PLACES,
    MINIVAN,
    MINIVAN_PLACES,
    PICKUP,
    PICKUP_PLACES,
    SEDAN,
    SEDAN_GLASS,
    SEDAN_PLACES,
    SUV,
    SUV_PLACES,
    VAN,
    VAN_PLACES,
)
from .vehicle_body import BodyShape
from .wheels import rim_image, wheel


def _sedan_style(variant: int) -> tuple[BodyShape, CarStyle]:
    color = ("#a9b0b7", "dark blue", "dark red", "off white")[variant]
    rim = ("spokes5", "spokes10", "spokes5", "cap")[variant]
    grille = ("bars", "mesh", "twin", "bars")[variant]
    along, up = ((1.0, 1.0), (1.07, 0.99), (0.97, 1.0), (1.0, 1.03))[variant]
    plate = ("UV 204", "KR 8812", "B 3071", "7ATX52")[variant]
    return SEDAN.stretched(along, 1.0 + 0.5 * (along - 1), up), CarStyle(color, rim=rim, grille=grille, plate=plate)


@recipe("sedan", 4, CAR, hulls=7, name="cars.sedan")
def sedan(variant: int, rng: np.random.Generator) -> BuiltAsset:
    shape, style = _sedan_style(variant)
    style = dataclasses.replace(style, doors=(-1.02, -0.30, 0.84))
    _, body = build_car(shape, SEDAN_PLACES, style, SEDAN_GLASS)
    names = (
        "A silver saloon car",
        "A long dark blue saloon car",
        "A dark red saloon car",
        "A white saloon car with steel wheels",
    )
    return body.finish(names[variant], {"body": "sedan", "color": str(style.color), "plate": style.plate})


@recipe("hatchback car", 4, CAR, hulls=7, name="cars.hatchback")
def hatchback(variant: int, rng: np.random.Generator) -> BuiltAsset:
    color = ("red", "#6fb3d2", "signal yellow", "charcoal")[variant]
    along, up = ((1.0, 1.0), (0.88, 1.04), (0.95, 1.0), (1.05, 0.99))[variant]
    style = CarStyle(
        color,
        rim=("spokes5", "cap", "spokes10", "spokes10")[variant],
        grille=("mesh", "bars", "mesh", "twin")[variant],
        plate=("HX 51", "MN 7734", "E 902", "5KLM33")[variant],
        doors=(-0.98, -0.28, 0.76),
    )
    _, body = build_car(
        HATCHBACK.stretched(along, 1.0, up),
        HATCHBACK_PLACES,
        style,
        {"pillars": ((-0.30, 0.07), (-1.08, 0.09)), "span": (-1.72, 0.85)},
    )
    names = ("A red hatchback", "A small light blue city car", "A yellow hatchback", "A dark grey compact car")
    return body.finish(names[variant], {"body": "hatchback", "color": str(color)})


@recipe("suv", 4, CAR, hulls=7, name="cars.suv")
def suv(variant: int, rng: np.random.Generator) -> BuiltAsset:
    color = ("black", "white", "#4c5d46", "#9b3f2b")[variant]
    along, up = ((1.05, 1.02), (1.0, 1.0), (0.92, 1.06), (0.94, 0.96))[variant]
    style = CarStyle(
        color,
        rim=("spokes10", "spokes5", "cap", "spokes5")[variant],
        grille=("twin", "bars", "mesh", "mesh")[variant],
        plate=("SUV 900", "WR 415", "G 4412", "8XYZ10")[variant],
        lower="charcoal",
        doors=(-1.05, -0.22, 0.82),
    )
    shape = SUV.stretched(along, 1.0, up)
    builder, body = build_car(
        shape, SUV_PLACES, style, {"pillars": ((-0.24, 0.08), (-1.10, 0.10)), "span": (-2.1, 0.9)}
    )
    roof_rails(builder, body, -1.75 * along, 0.05, 1.74 * up, "aluminium" if variant % 2 == 0 else "black")
    if variant == 2:  # the spare wheel on the tailgate of an off-roader
        with builder.frame((shape.upper[4][0] - 0.13, 0, 1.0 * up), (0, 0, 90)):
            wheel(builder, (0, 0, 0), 0.33, 0.2, rim_image("cap"), 1.0)
    names = (
        "A large black sport utility vehicle",
        "A white sport utility vehicle",
        "A green off-roader with a spare wheel",
        "A compact rust-red SUV",
    )
    return body.finish(names[variant], {"body": "suv", "color": str(color)})


@recipe("van", 4, CAR, hulls=4, name="cars.van")
def van(variant: int, rng: np.random.Generator) -> BuiltAsset:
    color, letters, ink, band = (
        ("white", "CITY PARCEL", "signal blue", "signal blue"),
        ("#d8b13a", "GREEN GROCER", "dark green", "dark green"),
        ("#3a5f8a", "PLUMBING 24h", "white", "orange"),
        ("light grey", "", "black", "dark grey"),
    )[variant]
    style = CarStyle(
        color,
        rim="steel",
        grille="bars",
        plate=("VN 330", "GG 12", "P 2424", "TX 818")[variant],
        lower="charcoal",
        doors=(-0.35, 0.62, 1.62),
    )
    along, up = ((1.0, 1.0), (0.94, 0.97), (1.12, 1.14), (1.0, 1.0))[variant]
    shape = VAN.stretched(along, 1.0, up)
    span = (0.55 * along, 1.72 * along) if variant != 3 else (-2.5, 1.72)
    pillars = ((0.62, 0.10),) if variant != 3 else ((0.62, 0.10), (-0.42, 0.10), (-1.5, 0.10))
    _, body = build_car(shape, VAN_PLACES, style, {"pillars": pillars, "span": span, "top": 1.95 * up})
    body.line([(-2.4 * along, 0.62), (1.0, 0.62)], "charcoal", 0.05)
    if letters:
        image, pen = paint.canvas((384, 96), color)
        pen.rectangle((0, 84, 384, 96), fill=paint.rgb(band))
        paint.text(pen, letters, (8, 8, 376, 76), ink, 0.02)
        body.side_image(-2.35 * along, -0.05, 1.02 * up, 1.62 * up, paint.shrunk(image, (192, 48)))
    names = (
        "A white delivery van",
        "A yellow greengrocer's van",
        "A tall blue craftsman's van",
        "A grey passenger van with side windows",
    )
    return body.finish(names[variant], {"body": "van", "letters": letters})


@recipe("minivan", 3, CAR, hulls=7, name="cars.minivan")
def minivan(variant: int, rng: np.random.Generator) -> BuiltAsset:
    color = ("#7a2f3a", "#b9c0c4", "#2f5d62")[variant]
    style = CarStyle(
        color,
        rim=("spokes10", "cap", "spokes5")[variant],
        grille=("bars", "mesh", "twin")[variant],
        plate=("MV 771", "F 66 02", "3ABC90")[variant],
        doors=(-1.0, 0.05, 1.15),
    )
    along, up = ((1.0, 1.0), (0.95, 1.03), (1.06, 1.0))[variant]
    builder, body = build_car(
        MINIVAN.stretched(along, 1.0, up),
        MINIVAN_PLACES,
        style,
        {"pillars": ((0.05, 0.08), (-1.05, 0.10)), "span": (-2.15, 1.3)},
    )
    if variant != 1:
        roof_rails(builder, body, -1.8 * along, 0.2, 1.735 * up, "aluminium")
    body.line([(-2.0 * along, shape_z := MINIVAN.belt * up - 0.08), (-1.0, shape_z)], "dark grey", 0.015)
    names = ("A wine-red family minivan", "A silver minivan", "A long teal minivan")
    return body.finish(names[variant], {"body": "minivan", "color": str(color)})


@recipe("pickup truck", 3, CAR, hulls=7, name="cars.pickup")
def pickup(variant: int, rng: np.random.Generator) -> BuiltAsset:
    color = ("dark red", "white", "#5b6b78")[variant]
    style = CarStyle(
        color,
        rim=("spokes5", "steel", "spokes10")[variant],
        grille=("twin", "bars", "mesh")[variant],
        plate=("PU 150", "WK 77", "4TRK22")[variant],
        lower="charcoal",
        doors=(-0.80, 0.10, 1.0),
    )
    along = (1.0, 1.0, 1.06)[variant]
    shape = PICKUP.stretched(along)
    builder, body = build_car(
        shape, PICKUP_PLACES, style, {"pillars": ((0.0, 0.09),), "span": (-0.86 * along, 1.0 * along)}
    )
    # The load bed: a dark floor seen inside four walls, drawn as a sunken box on top of the deck.
    x0, x1, y, z = -2.50 * along, -1.02 * along, 0.80, 1.145
    builder.box((x1 - x0, 2 * y, 0.01), ((x0 + x1) / 2, 0, z), "black")
    for side in (-1.0, 1.0):
        builder.box((x1 - x0 + 0.16, 0.09, 0.10), ((x0 + x1) / 2, side * (y + 0.03), z - 0.02), color, bevel=0.02)
    builder.box((0.08, 2 * y, 0.10), (x0 - 0.02, 0, z - 0.02), color, bevel=0.02)
    if variant == 1:
        for k, (dx, dy, h) in enumerate(((0.4, -0.35, 0.34), (0.9, 0.3, 0.26), (1.15, -0.3, 0.22))):
            builder.box((0.5, 0.55, h), (x0 + dx, dy, z), ("cardboard", "wood", "dark green")[k], bevel=0.02)
    if variant == 2:
        for side in (-1.0, 1.0):
            builder.tube(
                [(x1 - 0.75, side * y, z + 0.05), (x1 - 0.1, side * 0.68, z + 0.6), (x1 - 0.1, 0, z + 0.62)],
                0.035,
                "black",
                sides=6,
            )
    names = ("A dark red pickup truck", "A white work pickup with crates", "A grey pickup with a roll bar")
    return body.finish(names[variant], {"body": "pickup", "color": str(color)})
