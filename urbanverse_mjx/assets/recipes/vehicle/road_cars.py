"""Passenger cars whose outline is their character: coupe, sports car, convertible, limousine, electric car."""

import dataclasses

import numpy as np

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color
from ...meshes.recipe import recipe
from ..shared.sizes import fitted
from .car_build import CarStyle, build_car
from .car_shapes import HATCHBACK, HATCHBACK_PLACES, SEDAN, SEDAN_GLASS, SEDAN_PLACES, SUV, SUV_PLACES
from .vehicle_body import BodyShape


def lengthened(shape: BodyShape, extra: float, at: float) -> BodyShape:
    """The shape pulled apart by `extra` metres at x = at."""

    def moved(x: float) -> float:
        return x + (extra / 2 if x > at else -extra / 2)

    upper = tuple((moved(x), z, bulge) for x, z, bulge in shape.upper)
    return dataclasses.replace(shape, upper=upper, axles=tuple(moved(x) for x in shape.axles))


def outlined(base: BodyShape, line: str, **changes: object) -> BodyShape:
    """Another outline with the bulges of a known one; `line` = "x z, x z, ..." from the rear's foot to the front's."""
    points = [tuple(float(v) for v in pair.split()) for pair in line.split(",")]
    upper = tuple((x, z, old[2]) for (x, z), old in zip(points, base.upper, strict=True))
    return dataclasses.replace(base, upper=upper, **changes)


COUPE = outlined(
    SEDAN,
    "-2.24 .28,-2.31 .44,-2.31 .62,-2.28 .78,-2.23 .93,-2.12 .98,-1.88 1.01,-1.15 1.25,-.75 1.34,-.2 1.37,"
    ".2 1.345,1.0 .97,1.18 .92,1.65 .85,2.03 .76,2.18 .68,2.25 .55,2.27 .40,2.20 .25",
    belt=0.92,
    section=((0.15, 0.90), (0.36, 0.98), (0.55, 1.0), (0.76, 0.985), (0.90, 0.945), (1.37, 0.70), (1.9, 0.5)),
    wheel_radius=0.335,
)
SPORT = outlined(
    SEDAN,
    "-2.18 .28,-2.25 .42,-2.26 .60,-2.24 .76,-2.19 .88,-2.02 .935,-1.5 .99,-.95 1.10,-.5 1.18,-.1 1.205,"
    ".18 1.18,1.08 .84,1.28 .78,1.66 .685,1.95 .59,2.12 .51,2.21 .42,2.24 .32,2.17 .17",
    belt=0.82,
    sill=0.13,
    width=1.90,
    section=((0.12, 0.93), (0.32, 0.99), (0.5, 1.0), (0.68, 0.985), (0.82, 0.93), (1.21, 0.64), (1.6, 0.5)),
    wheel_radius=0.335,
    axles=(-1.28, 1.36),
)
OPEN = outlined(
    SEDAN,
    "-2.12 .28,-2.19 .44,-2.19 .60,-2.16 .76,-2.11 .88,-2.0 .93,-1.6 .95,-1.0 .94,-.93 .80,-.2 .78,"
    ".5 .80,.62 .94,.95 .93,1.5 .86,1.9 .77,2.05 .69,2.13 .56,2.15 .41,2.09 .25",
    belt=0.90,
    section=((0.15, 0.90), (0.36, 0.98), (0.55, 1.0), (0.76, 0.985), (0.92, 0.95), (1.2, 0.9)),
)
WEDGE = outlined(
    SEDAN,
    "-2.62 .42,-2.70 .56,-2.72 .76,-2.72 .96,-2.71 1.10,-2.68 1.18,-1.9 1.36,-1.2 1.52,-.6 1.66,.05 1.80,"
    ".18 1.79,1.5 1.28,1.7 1.21,2.15 1.07,2.5 .96,2.62 .90,2.70 .72,2.70 .56,2.62 .38",
    belt=1.14,
    sill=0.30,
    width=1.94,
    rounding=0.01,
    section=((0.2, 0.93), (0.5, 0.99), (0.8, 1.0), (1.0, 0.985), (1.14, 0.95), (1.8, 0.62), (2.2, 0.5)),
    wheel_radius=0.42,
    axles=(-1.72, 1.76),
)


@recipe("car", 4, name="road_cars.car")
def car(variant: int, rng: np.random.Generator) -> BuiltAsset:
    style = (
        CarStyle("#5b7fa6", "slim", "mesh", "spokes10", "UV 204"),
        CarStyle("signal red", "pair", "bars", "cap", "RD 77", (-0.82, 0.06, 0.84)),
        CarStyle("#e7e7e3", "slim", "twin", "spokes5", "WH 812", lower="charcoal", doors=(-1.05, -0.22, 0.82)),
        CarStyle("#3d5a45", "round", "bars", "steel", "GN 1972", (-0.95, 0.0, 0.95)),
    )[variant]
    shape, places, glass = (
        (SEDAN, SEDAN_PLACES, SEDAN_GLASS),
        (HATCHBACK, HATCHBACK_PLACES, {"pillars": ((-0.28, 0.07),), "span": (-1.55, 0.8)}),
        (SUV.stretched(0.97, 0.96, 0.96), SUV_PLACES, {"pillars": ((-0.24, 0.08), (-1.10, 0.10)), "span": (-2.1, 0.9)}),
        (SEDAN.stretched(0.94, 0.94, 1.0), SEDAN_PLACES, SEDAN_GLASS),
    )[variant]
    _, body = build_car(shape, places, style, glass)
    names = ("A blue family saloon", "A red hatchback", "A white crossover", "A green old saloon with round lamps")
    size = ((4.55, 1.88, 1.47), (3.95, 1.80, 1.50), (4.40, 1.95, 1.68), (4.30, 1.76, 1.44))[variant]
    return fitted(body.finish(names[variant], {"body": ("sedan", "hatchback", "suv", "sedan")[variant]}), size)


@recipe("coupe car", 3, name="road_cars.coupe")
def coupe(variant: int, rng: np.random.Generator) -> BuiltAsset:
    style = (
        CarStyle("#2c4f8f", "slim", "mesh", "spokes10", "CP 220", (-0.62, 0.98)),
        CarStyle("#c8ccd0", "pair", "twin", "spokes5", "CL 550", (-0.58, 1.0)),
        CarStyle("signal yellow", "round", "mesh", "spokes5", "MU 68", (-0.60, 0.98), "black"),
    )[variant]
    glass = {"pillars": ((-0.66, 0.06),), "span": (-1.5, 0.95)}
    _, body = build_car(COUPE.stretched((1.0, 1.05, 0.97)[variant]), SEDAN_PLACES, style, glass)
    if variant == 2:  # two black stripes from nose to tail
        for t in (-0.22, 0.10):
            body.across(10.95, 15.4, t, t + 0.12, "black", lift=0.007)
            body.across(8.0, 10.1, t, t + 0.12, "black", lift=0.007)
            body.across(4.2, 6.1, t, t + 0.12, "black", lift=0.007)
    names = ("A blue two-door coupe", "A large silver coupe", "A yellow muscle coupe with black stripes")
    size = ((4.55, 1.90, 1.37), (4.90, 1.94, 1.42), (4.42, 1.88, 1.34))[variant]
    return fitted(body.finish(names[variant], {"body": "coupe", "color": str(style.color)}), size)


@recipe("sports car", 3, name="road_cars.sports_car")
def sports_car(variant: int, rng: np.random.Generator) -> BuiltAsset:
    style = (
        CarStyle("signal red", "slim", None, "spokes10", "GT 458", (-0.55, 1.02), "black", 0.27),
        CarStyle("#f2a516", "slim", None, "spokes5", "LB 610", (-0.55, 1.02), "black", 0.29),
        CarStyle("#d9dcdf", "round", None, "spokes5", "RS 911", (-0.55, 0.95), "charcoal", 0.25),
    )[variant]
    shape = SPORT if variant < 2 else SPORT.stretched(0.97, 0.95, 1.06)
    glass = {"pillars": ((-0.60, 0.08),), "span": (-1.15, 1.0)}
    b, body = build_car(shape, SEDAN_PLACES, style, glass)
    body.across(5.2, 6.2, -0.55, 0.55, "black", lift=0.010)  # louvres over the engine
    intake = [(-1.02, 0.42), (-0.62, 0.40), (-0.72, 0.66), (-0.98, 0.72)]
    body.side([(x * (1.0 if variant < 2 else 0.97), z) for x, z in intake], "black", 0.010)
    for t in (-0.92, 0.52):
        body.across(16.2, 17.2, t, t + 0.40, "black", lift=0.016)
    if variant != 2:  # a wing on two struts
        z = 1.13 if variant == 0 else 1.19
        for side in (-1, 1):
            b.box((0.10, 0.03, z - 0.90), (-2.02, side * 0.55, 0.90), "black")
            b.box((0.32, 0.02, 0.12), (-2.06, side * 0.80, z - 0.06), style.color)
        b.box((0.30, 1.60, 0.03), (-2.06, 0, z), style.color if variant == 0 else "black", (0, 8, 0))
    for side in (-1, 1):
        b.cylinder(0.055, 0.10, (-2.30, side * 0.30, 0.36), "aluminium", (0, 90, 0), segments=10)
    names = ("A red mid-engined sports car", "An orange sports car with a wing", "A silver rear-engined sports car")
    size = ((4.52, 1.96, 1.21), (4.62, 2.02, 1.22), (4.40, 1.88, 1.28))[variant]
    return fitted(body.finish(names[variant], {"body": "sports", "color": str(style.color)}), size)


def _seat(b: MeshBuilder, x: float, y: float, color: Color) -> None:
    b.box((0.14, 0.46, 0.42), (x, y, 0.72), color, (0, -14, 0), bevel=0.05)
    b.box((0.09, 0.24, 0.17), (x - 0.10, y, 1.10), color, (0, -14, 0), bevel=0.03)


@recipe("convertible car", 3, name="road_cars.convertible")
def convertible(variant: int, rng: np.random.Generator) -> BuiltAsset:
    style = (
        CarStyle("dark red", "pair", "mesh", "spokes10", "CB 330", (-0.75, 0.62)),
        CarStyle("#7fb7b0", "round", "bars", "cap", "1961 CV", (-0.75, 0.62), "white"),
        CarStyle("signal yellow", "slim", "mesh", "spokes5", "MX 5", (-0.75, 0.62)),
    )[variant]
    leather = ("#c9a26a", "white", "charcoal")[variant]
    shape = OPEN.stretched((1.0, 1.08, 0.92)[variant])
    k = (1.0, 1.08, 0.92)[variant]
    b, body = build_car(shape, SEDAN_PLACES, style, None)
    body.across(7.15, 10.9, -0.84, 0.84, "#2a2523", lift=0.006)
    for side in (-1, 1):
        _seat(b, -0.42 * k, side * 0.36, leather)
        if variant == 1:
            _seat(b, -0.92 * k, side * 0.34, leather)
    b.box((0.16, 1.30, 0.14), (0.46 * k, 0, 0.84), leather, bevel=0.04)
    b.ring(0.17, 0.018, (0.30 * k, 0.36, 0.97), "black", (0, 64, 0), 14, 5)
    # The windscreen: a sheet of glass in a frame.
    foot, top = 0.66 * k, 0.24 * k
    half_low, half_top, high = 0.76, 0.64, 1.32
    glass = [(foot, half_low, 0.95), (foot, -half_low, 0.95), (top, -half_top, high), (top, half_top, high)]
    b.quad(glass, "glass", both_sides=True)
    b.tube([glass[0], glass[3], glass[2], glass[1]], 0.022, "aluminium" if variant == 1 else "black", sides=6)
    # The hood, folded behind the seats.
    b.box((0.36, 1.30, 0.14), (-1.16 * k, 0, 0.92), ("black", "white", "black")[variant], bevel=0.06)
    if variant == 1:  # tail fins and chrome
        for side in (-1, 1):
            fin = [(-2.15, 0.80), (-1.1, 0.92), (-2.02, 1.10), (-2.16, 1.10)]
            b.profile([(x * k, z) for x, z in fin], 0.05, (0, side * 0.76, 0), style.color)
        body.line([(-1.9, 0.62), (1.7, 0.66)], "aluminium", 0.035)
    names = ("A dark red open four-seater", "A turquoise convertible with tail fins", "A small yellow roadster")
    size = ((4.35, 1.86, 1.32), (4.75, 1.92, 1.34), (3.95, 1.74, 1.26))[variant]
    return fitted(body.finish(names[variant], {"body": "convertible", "color": str(style.color)}), size)


@recipe("electric car", 3, name="road_cars.electric_car")
def electric_car(variant: int, rng: np.random.Generator) -> BuiltAsset:
    style = (
        CarStyle("white", "bar", None, "spokes10", "E 2026", lower="charcoal"),
        CarStyle("#355f9e", "bar", None, "cap", "EV 100"),
        CarStyle("#b4b8bb", "bar", None, "cap", "CT 1", (-1.25, -0.2, 0.95), "dark grey", 0.26),
    )[variant]
    shape, places, glass = (
        (HATCHBACK.stretched(1.16, 1.04, 1.035), HATCHBACK_PLACES, {"pillars": ((-0.28, 0.07),), "span": (-1.8, 0.95)}),
        (SEDAN.stretched(1.02, 1.0, 1.02), SEDAN_PLACES, SEDAN_GLASS),
        (WEDGE, SEDAN_PLACES, {"pillars": ((-0.2, 0.06),), "span": (-1.5, 1.25)}),
    )[variant]
    b, body = build_car(shape, places, style, glass)
    if variant == 2:
        for axle in shape.axles:  # black angular arches
            arch = [(-0.56, 0.34), (-0.42, 0.86), (-0.20, 1.0), (0.20, 1.0), (0.42, 0.86), (0.56, 0.34)]
            inner = [(0.46, 0.34), (0.36, 0.74), (0.16, 0.88), (-0.16, 0.88), (-0.36, 0.74), (-0.46, 0.34)]
            body.side([(axle + x, z) for x, z in (*arch, *inner)], "black", 0.012)
    else:  # a charging cable in its socket, and what drives it written on the doors
        x, z = (-1.28, 0.86) if variant == 0 else (1.62, 0.72)
        y = float(body.half_width(x, z))
        b.cylinder(0.06, 0.05, (x, y + 0.03, z), "black", (90, 0, 0), segments=10)
        b.tube([(x, y + 0.03, z), (x, y + 0.10, z - 0.20), (x - 0.1, y + 0.08, 0.03)], 0.022, "light green", sides=5)
        body.side_image(
            -0.85,
            0.75,
            0.52,
            0.78,
            paint.lettering("100% ELECTRIC", style.color, ("green", "white")[variant], (128, 20)),
        )
    names = ("A white electric crossover", "A blue electric saloon", "An angular steel electric pickup")
    size = ((4.50, 1.90, 1.56), (4.70, 1.88, 1.48), (5.60, 2.04, 1.80))[variant]
    return fitted(body.finish(names[variant], {"body": "electric", "color": str(style.color)}), size)


@recipe("limousine", 3, name="road_cars.limousine")
def limousine(variant: int, rng: np.random.Generator) -> BuiltAsset:
    extra = (2.15, 1.0, 3.3)[variant]
    color = ("black", "#23304a", "white")[variant]
    half = extra / 2
    doors = (-0.95 - half, -0.25 - half, -0.25 - half + 1.0, 0.15 + half, 1.02 + half)
    style = CarStyle(color, "pair", "twin", ("spokes10", "spokes5", "cap")[variant], "LIMO 1", doors)
    shape = lengthened(SEDAN, extra, -0.3)
    count = (4, 3, 6)[variant]
    pillars = tuple((float(x), 0.08) for x in np.linspace(-1.28 - half, 0.05 + half, count + 1))
    b, body = build_car(shape, SEDAN_PLACES, style, {"pillars": pillars, "span": (-1.72 - half, 0.95 + half)})
    body.line([(-2.1 - half, 0.60), (2.0 + half, 0.60)], "aluminium", 0.025)
    if variant == 1:
        for side in (-1, 1):  # pennants of a state car
            b.rod((2.0 + half, side * 0.70, 0.80), (2.0 + half, side * 0.70, 1.12), 0.008, "aluminium", sides=5)
            x = 2.0 + half
            flag = [(x, side * 0.70, 0.98), (x - 0.24, side * 0.70, 0.98), (x - 0.24, side * 0.70, 1.11)]
            b.quad([*flag, (x, side * 0.70, 1.11)], "signal red", both_sides=True)
    b.tube([(-1.2 - half, 0, 1.45), (-1.3 - half, 0, 1.55)], 0.02, color, sides=5)
    names = ("A black stretched limousine", "A dark blue state limousine with pennants", "A long white party limousine")
    size = ((6.80, 1.96, 1.53), (5.60, 1.93, 1.52), (8.00, 1.98, 1.54))[variant]
    return fitted(body.finish(names[variant], {"extra": extra}), size)
