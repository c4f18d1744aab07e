"""Passenger cars: sedan, hatchback, SUV, van, minivan, pickup, taxi, police car."""

import dataclasses

import numpy as np

from .. import paint
from ..mesh_builder import BuiltAsset, MeshBuilder
from ..palette import Color, shade
from ..recipe import Physics, recipe
from .vehicle_body import Body, BodyShape
from .wheels import grille_picture, number_plate, rim_picture, wheel

_CAR = Physics(
    ("steel", "glass", "rubber", "plastic"), 170.0, (950.0, 2600.0), 0.6, False,
    "kerb weights of current cars are 1.0-2.5 t for 6-16 m^3 enclosed by the body; parked with the brake on nobody shifts one; "
    "painted steel sheet slides at about 0.6",
)  # fmt: skip

_SECTION = ((0.15, 0.90), (0.36, 0.975), (0.55, 1.0), (0.76, 0.985), (0.93, 0.945), (1.46, 0.72), (1.9, 0.55))

SEDAN = BodyShape(
    upper=(
        (-2.24, 0.28, 0.05), (-2.31, 0.44, 0.09), (-2.30, 0.62, 0.10), (-2.26, 0.80, 0.09), (-2.21, 0.97, 0.07),
        (-2.10, 1.02, 0.04), (-1.72, 1.05, 0.03), (-1.10, 1.36, 0.04), (-0.80, 1.435, 0.03), (-0.15, 1.46, 0.03),
        (0.28, 1.425, 0.03), (1.02, 1.01, 0.06), (1.18, 0.965, 0.05), (1.65, 0.895, 0.04), (2.03, 0.80, 0.06),
        (2.20, 0.72, 0.09), (2.28, 0.58, 0.12), (2.30, 0.42, 0.12), (2.24, 0.26, 0.10),
    ),
    width=1.82, section=_SECTION, axles=(-1.36, 1.38), wheel_radius=0.325, sill=0.20, belt=0.96,
)  # fmt: skip
_SEDAN_PLACES = {"rear_glass": (6.15, 7.6), "front_glass": (10.1, 10.95), "tail": (3.1, 3.9), "lamp": (15.0, 16.0), "grille": (15.5, 16.6)}

HATCHBACK = BodyShape(
    upper=(
        (-1.90, 0.28, 0.05), (-1.97, 0.44, 0.09), (-1.97, 0.62, 0.10), (-1.95, 0.80, 0.09), (-1.91, 0.97, 0.08),
        (-1.86, 1.06, 0.07), (-1.70, 1.30, 0.06), (-1.52, 1.43, 0.05), (-1.30, 1.475, 0.03), (-0.45, 1.51, 0.03),
        (0.10, 1.46, 0.03), (0.86, 1.03, 0.06), (1.02, 0.98, 0.05), (1.42, 0.91, 0.04), (1.72, 0.82, 0.07),
        (1.86, 0.73, 0.10), (1.93, 0.58, 0.12), (1.94, 0.42, 0.12), (1.89, 0.26, 0.10),
    ),
    width=1.74, section=_SECTION, axles=(-1.22, 1.22), wheel_radius=0.305, sill=0.20, belt=0.98,
)  # fmt: skip
_HATCH_PLACES = {"rear_glass": (5.2, 7.0), "front_glass": (10.1, 10.95), "tail": (3.2, 4.5), "lamp": (14.4, 15.7), "grille": (15.3, 16.5)}

_SUV_SECTION = ((0.2, 0.90), (0.45, 0.98), (0.68, 1.0), (0.92, 0.985), (1.10, 0.95), (1.72, 0.76), (2.1, 0.6))
SUV = BodyShape(
    upper=(
        (-2.24, 0.36, 0.05), (-2.31, 0.52, 0.08), (-2.30, 0.74, 0.09), (-2.28, 0.94, 0.08), (-2.24, 1.10, 0.07),
        (-2.20, 1.20, 0.06), (-2.06, 1.50, 0.05), (-1.96, 1.66, 0.05), (-1.80, 1.72, 0.03), (-0.55, 1.755, 0.03),
        (0.18, 1.70, 0.03), (0.92, 1.20, 0.06), (1.08, 1.15, 0.05), (1.65, 1.08, 0.04), (2.05, 0.98, 0.07),
        (2.20, 0.87, 0.09), (2.27, 0.68, 0.11), (2.28, 0.50, 0.11), (2.20, 0.34, 0.09),
    ),
    width=1.90, section=_SUV_SECTION, axles=(-1.38, 1.38), wheel_radius=0.375, sill=0.27, belt=1.13,
)  # fmt: skip
_SUV_PLACES = {"rear_glass": (5.3, 7.0), "front_glass": (10.1, 10.95), "tail": (3.3, 4.8), "lamp": (14.6, 15.6), "grille": (15.0, 16.6)}

_VAN_SECTION = ((0.2, 0.94), (0.5, 0.99), (0.8, 1.0), (1.08, 0.99), (1.22, 0.975), (2.1, 0.86), (2.6, 0.80))
VAN = BodyShape(
    upper=(
        (-2.62, 0.34, 0.02), (-2.68, 0.48, 0.04), (-2.66, 0.80, 0.04), (-2.65, 1.15, 0.03), (-2.64, 1.55, 0.03),
        (-2.62, 1.95, 0.03), (-2.58, 2.12, 0.03), (-2.40, 2.18, 0.03), (-1.0, 2.22, 0.03), (0.60, 2.20, 0.03),
        (1.00, 2.12, 0.04), (1.78, 1.28, 0.07), (1.92, 1.20, 0.07), (2.30, 1.08, 0.06), (2.52, 0.96, 0.08),
        (2.62, 0.80, 0.10), (2.66, 0.60, 0.11), (2.66, 0.45, 0.11), (2.60, 0.30, 0.09),
    ),
    width=1.98, section=_VAN_SECTION, axles=(-1.62, 1.75), wheel_radius=0.345, sill=0.25, belt=1.26,
)  # fmt: skip
_VAN_PLACES = {"rear_glass": (3.6, 5.2), "front_glass": (10.1, 10.95), "tail": (1.9, 3.2), "lamp": (13.9, 14.9), "grille": (14.5, 15.6)}

_MINIVAN_SECTION = ((0.15, 0.92), (0.40, 0.98), (0.62, 1.0), (0.88, 0.985), (1.03, 0.955), (1.68, 0.80), (2.0, 0.7))
MINIVAN = BodyShape(
    upper=(
        (-2.30, 0.30, 0.05), (-2.38, 0.45, 0.09), (-2.37, 0.68, 0.09), (-2.35, 0.88, 0.08), (-2.31, 1.05, 0.07),
        (-2.27, 1.16, 0.06), (-2.14, 1.48, 0.05), (-2.04, 1.64, 0.05), (-1.86, 1.715, 0.03), (-0.60, 1.75, 0.03),
        (0.38, 1.67, 0.03), (1.34, 1.09, 0.07), (1.48, 1.03, 0.06), (1.86, 0.94, 0.05), (2.14, 0.82, 0.08),
        (2.27, 0.72, 0.11), (2.34, 0.56, 0.13), (2.35, 0.42, 0.13), (2.29, 0.26, 0.10),
    ),
    width=1.90, section=_MINIVAN_SECTION, axles=(-1.42, 1.50), wheel_radius=0.33, sill=0.20, belt=1.06,
)  # fmt: skip
_MINIVAN_PLACES = {"rear_glass": (5.3, 7.0), "front_glass": (10.1, 10.95), "tail": (3.2, 5.0), "lamp": (14.3, 15.4), "grille": (15.2, 16.5)}

PICKUP = BodyShape(
    upper=(
        (-2.60, 0.42, 0.02), (-2.66, 0.56, 0.03), (-2.65, 0.78, 0.03), (-2.64, 0.98, 0.02), (-2.62, 1.12, 0.02),
        (-2.56, 1.14, 0.0), (-0.92, 1.14, 0.0), (-0.80, 1.62, 0.03), (-0.66, 1.74, 0.03), (-0.05, 1.78, 0.03),
        (0.45, 1.73, 0.03), (1.05, 1.24, 0.06), (1.20, 1.19, 0.05), (1.75, 1.13, 0.04), (2.20, 1.05, 0.06),
        (2.36, 0.94, 0.08), (2.44, 0.72, 0.10), (2.45, 0.54, 0.10), (2.38, 0.36, 0.08),
    ),
    width=1.92, section=_SUV_SECTION, axles=(-1.62, 1.58), wheel_radius=0.385, sill=0.32, belt=1.16,
)  # fmt: skip
_PICKUP_PLACES = {"rear_glass": (6.35, 7.3), "front_glass": (10.1, 10.95), "tail": (2.8, 4.0), "lamp": (14.6, 15.5), "grille": (14.9, 16.4)}


@dataclasses.dataclass(frozen=True)
class _Style:
    """One car: colour, rim, grille, plate; `doors` are x of the gaps between doors; `lower` is the bumpers' colour."""

    color: Color
    rim: str = "spokes5"
    grille: str = "bars"
    plate: str = "UV 204"
    lower: Color | None = None
    doors: tuple[float, ...] = (-0.95, 0.05, 1.02)


def _lights(body: Body, places: dict[str, tuple[float, float]], style: _Style) -> None:
    low, high = places["lamp"]
    for side in (-1, 1):
        t0, t1 = sorted((side * 0.60, side * 0.97))
        body.across(low, high, t0, t1, "white", lift=0.012)
        t0, t1 = sorted((side * 0.70, side * 0.90))
        body.across(low + 0.15, high - 0.2, t0, t1, "light blue", lift=0.018)
        low_t, high_t = places["tail"]
        t0, t1 = sorted((side * 0.66, side * 0.98))
        body.across(low_t, high_t, t0, t1, "red", lift=0.012)
        middle = (low_t + high_t) / 2
        body.across(middle, middle + 0.3, min(t0, t1) + 0.05, max(t0, t1) - 0.05, "amber", lift=0.017)
    body.across(*places["grille"], -0.45, 0.45, picture=grille_picture(style.grille), lift=0.012)
    plate = number_plate(style.plate)
    body.across(16.75, 17.3, -0.29, 0.29, picture=plate, lift=0.022)
    body.across(1.75, 2.35, -0.29, 0.29, picture=plate, lift=0.022)
    # Bumpers: darker below, and the lower air intake.
    lower = style.lower or shade(style.color, 0.55)
    body.across(17.3, 18.0, -0.97, 0.97, lower, lift=0.006)
    body.across(17.45, 17.8, -0.6, 0.6, "black", lift=0.014)
    body.across(0.0, 1.0, -0.97, 0.97, lower, lift=0.006)


def _mirrors(builder: MeshBuilder, body: Body, x: float, z: float, color: Color) -> None:
    for side in (-1.0, 1.0):
        y = float(body.half_width(x, z)) * side
        builder.box((0.16, 0.22, 0.14), (x, y + side * 0.12, z), color, bevel=0.035)
        builder.quad(
            [(x - 0.082, y + side * 0.12 + k * 0.08, z + dz) for k, dz in ((1, 0.03), (-1, 0.03), (-1, 0.11), (1, 0.11))],
            "mirror",
        )


def _doors(builder: MeshBuilder, body: Body, style: _Style) -> None:
    shape = body.shape
    low = shape.sill + 0.10
    for x in style.doors:
        body.line([(x, low), (x, shape.belt - 0.02)])
    body.line([(style.doors[0], low), (style.doors[-1], low)])
    # The sill between the wheels is dark plastic.
    radius = shape.wheel_radius + shape.arch + 0.03
    body.side(
        [(shape.axles[0] + radius, shape.sill), (shape.axles[-1] - radius, shape.sill),
         (shape.axles[-1] - radius, shape.sill + 0.07), (shape.axles[0] + radius, shape.sill + 0.07)], "charcoal", 0.005,
    )  # fmt: skip
    for x in style.doors[:-1]:
        z = shape.belt - 0.16
        for side in (-1.0, 1.0):
            y = float(body.half_width(x + 0.17, z)) * side
            builder.box((0.18, 0.035, 0.035), (x + 0.17, y + side * 0.012, z), shade(style.color, 0.85))


def _car(shape: BodyShape, places: dict[str, tuple[float, float]], style: _Style, glass: dict) -> tuple[MeshBuilder, Body]:
    builder = MeshBuilder(roughness=0.35, metallic=0.1)
    body = Body(builder, shape)
    body.shell(style.color)
    body.across(*places["front_glass"], -0.93, 0.93, "dark glass")
    if places["rear_glass"][1] > places["rear_glass"][0]:
        body.across(*places["rear_glass"], -0.88, 0.88, "dark glass")
    body.glasshouse(**glass)
    _lights(body, places, style)
    _doors(builder, body, style)
    x = shape.upper[11][0] - 0.38
    _mirrors(builder, body, x, shape.belt + 0.02, style.color if style.lower is None else style.lower)
    rim = rim_picture(style.rim)
    for axle in shape.axles:
        for side in (-1.0, 1.0):
            y = shape.width / 2 * 0.97 - 0.11
            wheel(builder, (axle, side * y, shape.wheel_radius), shape.wheel_radius, 0.215, rim, side)
    return builder, body


def _sedan_style(variant: int) -> tuple[BodyShape, _Style]:
    color = ("#a9b0b7", "dark blue", "dark red", "off white")[variant]
    rim = ("spokes5", "spokes10", "spokes5", "cap")[variant]
    grille = ("bars", "mesh", "twin", "bars")[variant]
    along, up = ((1.0, 1.0), (1.07, 0.99), (0.97, 1.0), (1.0, 1.03))[variant]
    plate = ("UV 204", "KR 8812", "B 3071", "7ATX52")[variant]
    return SEDAN.stretched(along, 1.0 + 0.5 * (along - 1), up), _Style(color, rim, grille, plate)


_SEDAN_GLASS = {"pillars": ((-0.32, 0.07), (-1.30, 0.05)), "span": (-1.72, 0.95)}


@recipe("sedan", 4, _CAR, hulls=6)
def sedan(variant: int, rng: np.random.Generator) -> BuiltAsset:
    shape, style = _sedan_style(variant)
    style = dataclasses.replace(style, doors=(-1.02, -0.30, 0.84))
    builder, body = _car(shape, _SEDAN_PLACES, style, _SEDAN_GLASS)
    names = ("A silver saloon car", "A long dark blue saloon car", "A dark red saloon car", "A white saloon car with steel wheels")
    return body.finish(names[variant], {"body": "sedan", "color": str(style.color), "plate": style.plate})


@recipe("hatchback car", 4, _CAR, hulls=6)
def hatchback(variant: int, rng: np.random.Generator) -> BuiltAsset:
    color = ("red", "#6fb3d2", "signal yellow", "charcoal")[variant]
    along, up = ((1.0, 1.0), (0.88, 1.04), (0.95, 1.0), (1.05, 0.99))[variant]
    style = _Style(color, ("spokes5", "cap", "spokes10", "spokes10")[variant], ("mesh", "bars", "mesh", "twin")[variant],
                   ("HX 51", "MN 7734", "E 902", "5KLM33")[variant], doors=(-0.98, -0.28, 0.76))  # fmt: skip
    builder, body = _car(
        HATCHBACK.stretched(along, 1.0, up), _HATCH_PLACES, style, {"pillars": ((-0.30, 0.07), (-1.08, 0.09)), "span": (-1.72, 0.85)}
    )
    names = ("A red hatchback", "A small light blue city car", "A yellow hatchback", "A dark grey compact car")
    return body.finish(names[variant], {"body": "hatchback", "color": str(color)})


def _roof_rails(builder: MeshBuilder, body: Body, x0: float, x1: float, z: float, color: Color) -> None:
    for side in (-1.0, 1.0):
        y = float(body.half_width(0.0, z)) * 0.93 * side
        builder.tube([(x0, y, z - 0.02), (x0 + 0.12, y, z + 0.05), (x1 - 0.12, y, z + 0.05), (x1, y, z - 0.04)], 0.018, color, sides=6)


@recipe("suv", 4, _CAR, hulls=6)
def suv(variant: int, rng: np.random.Generator) -> BuiltAsset:
    color = ("black", "white", "#4c5d46", "#9b3f2b")[variant]
    along, up = ((1.05, 1.02), (1.0, 1.0), (0.92, 1.06), (0.94, 0.96))[variant]
    style = _Style(color, ("spokes10", "spokes5", "cap", "spokes5")[variant], ("twin", "bars", "mesh", "mesh")[variant],
                   ("SUV 900", "WR 415", "G 4412", "8XYZ10")[variant], "charcoal", doors=(-1.05, -0.22, 0.82))  # fmt: skip
    shape = SUV.stretched(along, 1.0, up)
    builder, body = _car(shape, _SUV_PLACES, style, {"pillars": ((-0.24, 0.08), (-1.10, 0.10)), "span": (-2.1, 0.9)})
    _roof_rails(builder, body, -1.75 * along, 0.05, 1.74 * up, "aluminium" if variant % 2 == 0 else "black")
    if variant == 2:  # the spare wheel on the tailgate of an off-roader
        with builder.frame((shape.upper[4][0] - 0.13, 0, 1.0 * up), (0, 0, 90)):
            wheel(builder, (0, 0, 0), 0.33, 0.2, rim_picture("cap"), 1.0)
    names = ("A large black sport utility vehicle", "A white sport utility vehicle", "A green off-roader with a spare wheel", "A compact rust-red SUV")
    return body.finish(names[variant], {"body": "suv", "color": str(color)})


@recipe("van", 4, _CAR, hulls=4)
def van(variant: int, rng: np.random.Generator) -> BuiltAsset:
    color, letters, ink, band = (
        ("white", "CITY PARCEL", "signal blue", "signal blue"),
        ("#d8b13a", "GREEN GROCER", "dark green", "dark green"),
        ("#3a5f8a", "PLUMBING 24h", "white", "orange"),
        ("light grey", "", "black", "dark grey"),
    )[variant]
    style = _Style(color, "steel", "bars", ("VN 330", "GG 12", "P 2424", "TX 818")[variant], "charcoal", doors=(-0.35, 0.62, 1.62))
    along, up = ((1.0, 1.0), (0.94, 0.97), (1.12, 1.14), (1.0, 1.0))[variant]
    shape = VAN.stretched(along, 1.0, up)
    span = (0.55 * along, 1.72 * along) if variant != 3 else (-2.5, 1.72)
    pillars = ((0.62, 0.10),) if variant != 3 else ((0.62, 0.10), (-0.42, 0.10), (-1.5, 0.10))
    builder, body = _car(shape, _VAN_PLACES, style, {"pillars": pillars, "span": span, "top": 1.95 * up})
    body.line([(-2.4 * along, 0.62), (1.0, 0.62)], "charcoal", 0.05)
    if letters:
        image, pen = paint.canvas((384, 96), color)
        pen.rectangle((0, 84, 384, 96), fill=paint.rgb(band))
        paint.text(pen, letters, (8, 8, 376, 76), ink, 0.02)
        body.side_picture(-2.35 * along, -0.05, 1.02 * up, 1.62 * up, paint.shrunk(image, (192, 48)))
    names = ("A white delivery van", "A yellow greengrocer's van", "A tall blue craftsman's van", "A grey passenger van with side windows")
    return body.finish(names[variant], {"body": "van", "letters": letters})


@recipe("minivan", 3, _CAR, hulls=6)
def minivan(variant: int, rng: np.random.Generator) -> BuiltAsset:
    color = ("#7a2f3a", "#b9c0c4", "#2f5d62")[variant]
    style = _Style(color, ("spokes10", "cap", "spokes5")[variant], ("bars", "mesh", "twin")[variant],
                   ("MV 771", "F 66 02", "3ABC90")[variant], doors=(-1.0, 0.05, 1.15))  # fmt: skip
    along, up = ((1.0, 1.0), (0.95, 1.03), (1.06, 1.0))[variant]
    builder, body = _car(
        MINIVAN.stretched(along, 1.0, up), _MINIVAN_PLACES, style, {"pillars": ((0.05, 0.08), (-1.05, 0.10)), "span": (-2.15, 1.3)}
    )
    if variant != 1:
        _roof_rails(builder, body, -1.8 * along, 0.2, 1.735 * up, "aluminium")
    body.line([(-2.0 * along, shape_z := MINIVAN.belt * up - 0.08), (-1.0, shape_z)], "dark grey", 0.015)
    names = ("A wine-red family minivan", "A silver minivan", "A long teal minivan")
    return body.finish(names[variant], {"body": "minivan", "color": str(color)})


@recipe("pickup truck", 3, _CAR, hulls=6)
def pickup(variant: int, rng: np.random.Generator) -> BuiltAsset:
    color = ("dark red", "white", "#5b6b78")[variant]
    style = _Style(color, ("spokes5", "steel", "spokes10")[variant], ("twin", "bars", "mesh")[variant],
                   ("PU 150", "WK 77", "4TRK22")[variant], "charcoal", doors=(-0.80, 0.10, 1.0))  # fmt: skip
    along = (1.0, 1.0, 1.06)[variant]
    shape = PICKUP.stretched(along)
    builder, body = _car(shape, _PICKUP_PLACES, style, {"pillars": ((0.0, 0.09),), "span": (-0.86 * along, 1.0 * along)})
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
            builder.tube([(x1 - 0.75, side * y, z + 0.05), (x1 - 0.1, side * 0.68, z + 0.6), (x1 - 0.1, 0, z + 0.62)], 0.035, "black", sides=6)
    names = ("A dark red pickup truck", "A white work pickup with crates", "A grey pickup with a roll bar")
    return body.finish(names[variant], {"body": "pickup", "color": str(color)})


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


@recipe("taxi", 3, _CAR, hulls=6)
def taxi(variant: int, rng: np.random.Generator) -> BuiltAsset:
    color = ("signal yellow", "#e8e2c8", "black")[variant]
    base, places, glass = (
        (SEDAN, _SEDAN_PLACES, _SEDAN_GLASS),
        (SEDAN.stretched(1.03, 1.0, 1.02), _SEDAN_PLACES, _SEDAN_GLASS),
        (MINIVAN.stretched(0.96, 1.0, 1.04), _MINIVAN_PLACES, {"pillars": ((0.05, 0.08), (-1.05, 0.10)), "span": (-2.15, 1.3)}),
    )[variant]
    doors = (-1.02, -0.30, 0.84) if variant != 2 else (-1.0, 0.05, 1.1)
    style = _Style(color, ("cap", "spokes5", "spokes10")[variant], "bars", ("TX 1010", "TX 88", "TX 402")[variant], doors=doors)
    builder, body = _car(base, places, style, glass)
    z = base.upper[9][1] + 0.02
    back, ink = (("white", "black"), ("signal yellow", "black"), ("amber", "black"))[variant]
    sign = _roof_sign("TAXI", back, ink)
    builder.box((0.20, 0.62, 0.20), (-0.1, 0, z), back, taper=(0.6, 0.92), bevel=0.02)
    for facing, x in (("+x", 0.085), ("-x", -0.285)):
        builder.panel(sign, (x, 0, z + 0.10), 0.52, 0.16, facing, tilt_deg=11.0)
    middle = base.belt - 0.20
    if variant == 0:
        body.side_picture(doors[0], doors[-1], middle - 0.07, middle + 0.07, _chequer((128, 8), "black", "signal yellow"))
    else:
        image, pen = paint.canvas((256, 64), color)
        paint.text(pen, "TAXI" if variant == 1 else "CAB 402", (8, 4, 248, 60), "black" if variant == 1 else "amber", 0.03)
        body.side_picture(-0.15, 0.75, middle - 0.20, middle + 0.02, np.asarray(paint.shrunk(image, (64, 16))))
    names = ("A yellow taxi with a chequered band", "An ivory taxi saloon", "A black minicab taxi")
    return body.finish(names[variant], {"body": "taxi", "color": str(color)})


@recipe("police car", 3, _CAR, hulls=6)
def police_car(variant: int, rng: np.random.Generator) -> BuiltAsset:
    color = ("white", "black", "white")[variant]
    base, places, glass = (
        (SEDAN.stretched(1.02), _SEDAN_PLACES, _SEDAN_GLASS),
        (SEDAN.stretched(1.05, 1.02, 1.02), _SEDAN_PLACES, _SEDAN_GLASS),
        (SUV, _SUV_PLACES, {"pillars": ((-0.24, 0.08), (-1.10, 0.10)), "span": (-2.1, 0.9)}),
    )[variant]
    doors = (-1.02, -0.28, 0.84)
    style = _Style(color, "steel", "mesh", ("POL 01", "POL 17", "POL 33")[variant], doors=doors)
    builder, body = _car(base, places, style, glass)
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
    body.side_picture(-0.12 - half, -0.12 + half, middle - 0.13, middle + 0.13, np.asarray(paint.shrunk(image, (128, 24))))
    z = base.upper[9][1] + 0.01
    builder.box((0.26, 1.10, 0.05), (-0.2, 0, z), "charcoal")
    for side, lamp in ((-1.0, "signal blue"), (1.0, "signal red" if variant == 1 else "signal blue")):
        builder.box((0.24, 0.46, 0.11), (-0.2, side * 0.31, z + 0.05), lamp, bevel=0.03)
    builder.box((0.22, 0.14, 0.09), (-0.2, 0, z + 0.05), "white", bevel=0.02)
    names = ("A white police car with a blue band", "A black and white police car", "A police SUV with a chequered band")
    return body.finish(names[variant], {"body": "police", "color": str(color)})
