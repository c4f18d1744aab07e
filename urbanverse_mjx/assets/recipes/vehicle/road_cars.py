"""Passenger cars whose outline is their character: coupe, sports car, convertible, limousine, electric car."""

import dataclasses

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import recipe
from ..shared.fitted import fitted
from .car_shapes import HATCHBACK, HATCHBACK_PLACES, SEDAN, SEDAN_GLASS, SEDAN_PLACES, SUV, SUV_PLACES
from .coaches import lettering
from .vehicle_body import Body, BodyShape
from .wheels import grille_picture, number_plate, rim_picture, wheel

Places = dict[str, tuple[float, float]]


@dataclasses.dataclass(frozen=True)
class Trim:
    """Details of a car. lamps: "pair", "slim", "round" or "bar" (a strip of light from side to side).

    grille: a style of `grille_picture`, or None for a closed nose; doors: x of the gaps, rear to front;
    tyre: width of the tyres, m.
    """

    color: Color
    lamps: str = "pair"
    grille: str | None = "bars"
    rim: str = "spokes5"
    plate: str = "UV 310"
    doors: tuple[float, ...] = (-0.95, 0.05, 1.02)
    lower: Color | None = None
    tyre: float = 0.215
    glass: Color = "dark glass"


def _front_and_rear(b: MeshBuilder, body: Body, places: Places, trim: Trim) -> None:
    low, high = places["lamp"]
    tail_low, tail_high = places["tail"]
    if trim.lamps == "bar":
        body.across(low - 0.25, low + 0.75, -0.96, 0.96, "black", lift=0.010)
        body.across(low, low + 0.35, -0.95, 0.95, "white", lift=0.016)
        body.across(tail_high - 0.35, tail_high, -0.95, 0.95, "light red", lift=0.014)
    for side in (-1, 1):
        inner = {"pair": 0.60, "slim": 0.52, "round": 0.62, "bar": 0.72}[trim.lamps]
        t0, t1 = sorted((side * inner, side * 0.96))
        if trim.lamps == "round":
            middle = body._across_points(np.array([(low + high) / 2]), side * 0.78)[0]
            b.ball((0.06, 0.10, 0.10), tuple(middle), "lamp", segments=12, rings=6)
        else:
            body.across(low, high if trim.lamps == "pair" else low + 0.55, t0, t1, "white", lift=0.020)
        body.across(tail_low, tail_high, t0, t1, "red", lift=0.012)
    if trim.grille:
        body.across(*places["grille"], -0.45, 0.45, picture=grille_picture(trim.grille), lift=0.012)
    plate = number_plate(trim.plate)
    body.across(16.75, 17.3, -0.27, 0.27, picture=plate, lift=0.022)
    body.across(1.75, 2.35, -0.27, 0.27, picture=plate, lift=0.022)
    lower = trim.lower or shade(trim.color, 0.55)
    body.across(17.3, 18.0, -0.97, 0.97, lower, lift=0.006)
    body.across(17.45, 17.8, -0.6, 0.6, "black", lift=0.014)
    body.across(0.0, 1.0, -0.97, 0.97, lower, lift=0.006)


def _flanks(b: MeshBuilder, body: Body, trim: Trim, mirror_x: float) -> None:
    shape = body.shape
    low = shape.sill + 0.10
    for x in trim.doors:
        body.line([(x, low), (x, shape.belt - 0.02)])
    if trim.doors:
        body.line([(trim.doors[0], low), (trim.doors[-1], low)])
    radius = shape.wheel_radius + shape.arch + 0.03
    x0, x1 = shape.axles[0] + radius, shape.axles[-1] - radius
    body.side([(x0, shape.sill), (x1, shape.sill), (x1, shape.sill + 0.07), (x0, shape.sill + 0.07)], "charcoal", 0.005)
    for side in (-1.0, 1.0):
        for x in trim.doors[:-1]:
            z = shape.belt - 0.13
            y = float(body.half_width(x + 0.17, z)) * side
            b.box((0.18, 0.03, 0.03), (x + 0.17, y + side * 0.008, z), shade(trim.color, 0.85))
        y = float(body.half_width(mirror_x, shape.belt)) * side
        b.box((0.12, 0.13, 0.12), (mirror_x, y + side * 0.05, shape.belt + 0.02), trim.color, bevel=0.03)


def assembled(shape: BodyShape, places: Places, trim: Trim, glass: dict | None) -> tuple[MeshBuilder, Body]:
    """A car; `glass` = arguments of `Body.glasshouse`, or None for an open car (which has its own windscreen)."""
    b = MeshBuilder(roughness=0.35, metallic=0.1)
    body = Body(b, shape)
    body.shell(trim.color)
    if glass is not None:
        body.across(*places["front_glass"], -0.93, 0.93, trim.glass)
        body.across(*places["rear_glass"], -0.88, 0.88, trim.glass)
        body.glasshouse(**glass, glass=trim.glass)
    _front_and_rear(b, body, places, trim)
    _flanks(b, body, trim, shape.upper[11][0] - 0.30)
    rim = rim_picture(trim.rim)
    for axle in shape.axles:
        for side in (-1.0, 1.0):
            y = shape.width / 2 * 0.97 - trim.tyre / 2
            wheel(b, (axle, side * y, shape.wheel_radius), shape.wheel_radius, trim.tyre, rim, side)
    return b, body


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
    trim = (
        Trim("#5b7fa6", "slim", "mesh", "spokes10", "UV 204"),
        Trim("signal red", "pair", "bars", "cap", "RD 77", (-0.82, 0.06, 0.84)),
        Trim("#e7e7e3", "slim", "twin", "spokes5", "WH 812", lower="charcoal", doors=(-1.05, -0.22, 0.82)),
        Trim("#3d5a45", "round", "bars", "steel", "GN 1972", (-0.95, 0.0, 0.95)),
    )[variant]
    shape, places, glass = (
        (SEDAN, SEDAN_PLACES, SEDAN_GLASS),
        (HATCHBACK, HATCHBACK_PLACES, {"pillars": ((-0.28, 0.07),), "span": (-1.55, 0.8)}),
        (SUV.stretched(0.97, 0.96, 0.96), SUV_PLACES, {"pillars": ((-0.24, 0.08), (-1.10, 0.10)), "span": (-2.1, 0.9)}),
        (SEDAN.stretched(0.94, 0.94, 1.0), SEDAN_PLACES, SEDAN_GLASS),
    )[variant]
    _, body = assembled(shape, places, trim, glass)
    names = ("A blue family saloon", "A red hatchback", "A white crossover", "A green old saloon with round lamps")
    size = ((4.55, 1.88, 1.47), (3.95, 1.80, 1.50), (4.40, 1.95, 1.68), (4.30, 1.76, 1.44))[variant]
    return fitted(body.finish(names[variant], {"body": ("sedan", "hatchback", "suv", "sedan")[variant]}), size)


@recipe("coupe car", 3, name="road_cars.coupe")
def coupe(variant: int, rng: np.random.Generator) -> BuiltAsset:
    trim = (
        Trim("#2c4f8f", "slim", "mesh", "spokes10", "CP 220", (-0.62, 0.98)),
        Trim("#c8ccd0", "pair", "twin", "spokes5", "CL 550", (-0.58, 1.0)),
        Trim("signal yellow", "round", "mesh", "spokes5", "MU 68", (-0.60, 0.98), "black"),
    )[variant]
    glass = {"pillars": ((-0.66, 0.06),), "span": (-1.5, 0.95)}
    _, body = assembled(COUPE.stretched((1.0, 1.05, 0.97)[variant]), SEDAN_PLACES, trim, glass)
    if variant == 2:  # two black stripes from nose to tail
        for t in (-0.22, 0.10):
            body.across(10.95, 15.4, t, t + 0.12, "black", lift=0.007)
            body.across(8.0, 10.1, t, t + 0.12, "black", lift=0.007)
            body.across(4.2, 6.1, t, t + 0.12, "black", lift=0.007)
    names = ("A blue two-door coupe", "A large silver coupe", "A yellow muscle coupe with black stripes")
    size = ((4.55, 1.90, 1.37), (4.90, 1.94, 1.42), (4.42, 1.88, 1.34))[variant]
    return fitted(body.finish(names[variant], {"body": "coupe", "color": str(trim.color)}), size)


@recipe("sports car", 3, name="road_cars.sports_car")
def sports_car(variant: int, rng: np.random.Generator) -> BuiltAsset:
    trim = (
        Trim("signal red", "slim", None, "spokes10", "GT 458", (-0.55, 1.02), "black", 0.27),
        Trim("#f2a516", "slim", None, "spokes5", "LB 610", (-0.55, 1.02), "black", 0.29),
        Trim("#d9dcdf", "round", None, "spokes5", "RS 911", (-0.55, 0.95), "charcoal", 0.25),
    )[variant]
    shape = SPORT if variant < 2 else SPORT.stretched(0.97, 0.95, 1.06)
    glass = {"pillars": ((-0.60, 0.08),), "span": (-1.15, 1.0)}
    b, body = assembled(shape, SEDAN_PLACES, trim, glass)
    body.across(5.2, 6.2, -0.55, 0.55, "black", lift=0.010)  # louvres over the engine
    intake = [(-1.02, 0.42), (-0.62, 0.40), (-0.72, 0.66), (-0.98, 0.72)]
    body.side([(x * (1.0 if variant < 2 else 0.97), z) for x, z in intake], "black", 0.010)
    for t in (-0.92, 0.52):
        body.across(16.2, 17.2, t, t + 0.40, "black", lift=0.016)
    if variant != 2:  # a wing on two struts
        z = 1.13 if variant == 0 else 1.19
        for side in (-1, 1):
            b.box((0.10, 0.03, z - 0.90), (-2.02, side * 0.55, 0.90), "black")
            b.box((0.32, 0.02, 0.12), (-2.06, side * 0.80, z - 0.06), trim.color)
        b.box((0.30, 1.60, 0.03), (-2.06, 0, z), trim.color if variant == 0 else "black", (0, 8, 0))
    for side in (-1, 1):
        b.cylinder(0.055, 0.10, (-2.30, side * 0.30, 0.36), "aluminium", (0, 90, 0), segments=10)
    names = ("A red mid-engined sports car", "An orange sports car with a wing", "A silver rear-engined sports car")
    size = ((4.52, 1.96, 1.21), (4.62, 2.02, 1.22), (4.40, 1.88, 1.28))[variant]
    return fitted(body.finish(names[variant], {"body": "sports", "color": str(trim.color)}), size)


def _seat(b: MeshBuilder, x: float, y: float, color: Color) -> None:
    b.box((0.14, 0.46, 0.42), (x, y, 0.72), color, (0, -14, 0), bevel=0.05)
    b.box((0.09, 0.24, 0.17), (x - 0.10, y, 1.10), color, (0, -14, 0), bevel=0.03)


@recipe("convertible car", 3, name="road_cars.convertible")
def convertible(variant: int, rng: np.random.Generator) -> BuiltAsset:
    trim = (
        Trim("dark red", "pair", "mesh", "spokes10", "CB 330", (-0.75, 0.62)),
        Trim("#7fb7b0", "round", "bars", "cap", "1961 CV", (-0.75, 0.62), "white"),
        Trim("signal yellow", "slim", "mesh", "spokes5", "MX 5", (-0.75, 0.62)),
    )[variant]
    leather = ("#c9a26a", "white", "charcoal")[variant]
    shape = OPEN.stretched((1.0, 1.08, 0.92)[variant])
    k = (1.0, 1.08, 0.92)[variant]
    b, body = assembled(shape, SEDAN_PLACES, trim, None)
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
            b.profile([(x * k, z) for x, z in fin], 0.05, (0, side * 0.76, 0), trim.color)
        body.line([(-1.9, 0.62), (1.7, 0.66)], "aluminium", 0.035)
    names = ("A dark red open four-seater", "A turquoise convertible with tail fins", "A small yellow roadster")
    size = ((4.35, 1.86, 1.32), (4.75, 1.92, 1.34), (3.95, 1.74, 1.26))[variant]
    return fitted(body.finish(names[variant], {"body": "convertible", "color": str(trim.color)}), size)


@recipe("electric car", 3, name="road_cars.electric_car")
def electric_car(variant: int, rng: np.random.Generator) -> BuiltAsset:
    trim = (
        Trim("white", "bar", None, "spokes10", "E 2026", lower="charcoal"),
        Trim("#355f9e", "bar", None, "cap", "EV 100"),
        Trim("#b4b8bb", "bar", None, "cap", "CT 1", (-1.25, -0.2, 0.95), "dark grey", 0.26),
    )[variant]
    shape, places, glass = (
        (HATCHBACK.stretched(1.16, 1.04, 1.035), HATCHBACK_PLACES, {"pillars": ((-0.28, 0.07),), "span": (-1.8, 0.95)}),
        (SEDAN.stretched(1.02, 1.0, 1.02), SEDAN_PLACES, SEDAN_GLASS),
        (WEDGE, SEDAN_PLACES, {"pillars": ((-0.2, 0.06),), "span": (-1.5, 1.25)}),
    )[variant]
    b, body = assembled(shape, places, trim, glass)
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
        body.side_picture(
            -0.85, 0.75, 0.52, 0.78, lettering("100% ELECTRIC", trim.color, ("green", "white")[variant], (128, 20))
        )
    names = ("A white electric crossover", "A blue electric saloon", "An angular steel electric pickup")
    size = ((4.50, 1.90, 1.56), (4.70, 1.88, 1.48), (5.60, 2.04, 1.80))[variant]
    return fitted(body.finish(names[variant], {"body": "electric", "color": str(trim.color)}), size)


@recipe("limousine", 3, name="road_cars.limousine")
def limousine(variant: int, rng: np.random.Generator) -> BuiltAsset:
    extra = (2.15, 1.0, 3.3)[variant]
    color = ("black", "#23304a", "white")[variant]
    half = extra / 2
    doors = (-0.95 - half, -0.25 - half, -0.25 - half + 1.0, 0.15 + half, 1.02 + half)
    trim = Trim(color, "pair", "twin", ("spokes10", "spokes5", "cap")[variant], "LIMO 1", doors)
    shape = lengthened(SEDAN, extra, -0.3)
    count = (4, 3, 6)[variant]
    pillars = tuple((float(x), 0.08) for x in np.linspace(-1.28 - half, 0.05 + half, count + 1))
    b, body = assembled(shape, SEDAN_PLACES, trim, {"pillars": pillars, "span": (-1.72 - half, 0.95 + half)})
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
