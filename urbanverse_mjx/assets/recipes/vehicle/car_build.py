"""Puts a car together: body, glass, lamps, doors, mirrors, wheels."""

import dataclasses

import numpy as np

from ...meshes.mesh_builder import MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import Physics
from .car_shapes import Places
from .vehicle_body import Body, BodyShape
from .wheels import grille_image, number_plate, rim_image, wheel

CAR = Physics(
    ("steel", "glass", "rubber", "plastic"),
    170.0,
    (950.0, 2600.0),
    0.6,
    False,
    "kerb weights of current cars are 1.0-2.5 t for 6-16 m^3 enclosed; with its brake on nobody shifts one; "
    "painted steel sheet slides at about 0.6",
)


@dataclasses.dataclass(frozen=True)
class CarStyle:
    """Details of a car.

    Attributes:
      lamps: "two-tone" (with amber indicators; such cars have mirrors with glass), "pair", "slim", "round" or "bar" (a
        strip of light from side to side).
      grille: a style of `grille_image`, or None for a closed nose.
      doors: x of the gaps between doors, rear to front, m.
      lower: colour of the bumpers; None for a dark shade of the car's.
      tyre: width of the tyres, m.
    """

    color: Color
    lamps: str = "two-tone"
    grille: str | None = "bars"
    rim: str = "spokes5"
    plate: str = "UV 204"
    doors: tuple[float, ...] = (-0.95, 0.05, 1.02)
    lower: Color | None = None
    tyre: float = 0.215
    glass: Color = "dark glass"

    @property
    def detailed(self) -> bool:
        return self.lamps == "two-tone"


def _two_tone_lamps(body: Body, places: Places) -> None:
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


def _lamps(b: MeshBuilder, body: Body, places: Places, style: CarStyle) -> None:
    low, high = places["lamp"]
    tail_low, tail_high = places["tail"]
    if style.lamps == "bar":
        body.across(low - 0.25, low + 0.75, -0.96, 0.96, "black", lift=0.010)
        body.across(low, low + 0.35, -0.95, 0.95, "white", lift=0.016)
        body.across(tail_high - 0.35, tail_high, -0.95, 0.95, "light red", lift=0.014)
    for side in (-1, 1):
        inner = {"pair": 0.60, "slim": 0.52, "round": 0.62, "bar": 0.72}[style.lamps]
        t0, t1 = sorted((side * inner, side * 0.96))
        if style.lamps == "round":
            middle = body._across_points(np.array([(low + high) / 2]), side * 0.78)[0]
            b.ball((0.06, 0.10, 0.10), tuple(middle), "lamp", segments=12, rings=6)
        else:
            body.across(low, high if style.lamps == "pair" else low + 0.55, t0, t1, "white", lift=0.020)
        body.across(tail_low, tail_high, t0, t1, "red", lift=0.012)


def _front_and_rear(b: MeshBuilder, body: Body, places: Places, style: CarStyle) -> None:
    """Lamps, grille, plates, and the bumpers: darker below, with the lower air intake."""
    if style.detailed:
        _two_tone_lamps(body, places)
    else:
        _lamps(b, body, places, style)
    if style.grille:
        body.across(*places["grille"], -0.45, 0.45, image=grille_image(style.grille), lift=0.012)
    plate, half = number_plate(style.plate), 0.29 if style.detailed else 0.27
    body.across(16.75, 17.3, -half, half, image=plate, lift=0.022)
    body.across(1.75, 2.35, -half, half, image=plate, lift=0.022)
    lower = style.lower or shade(style.color, 0.55)
    body.across(17.3, 18.0, -0.97, 0.97, lower, lift=0.006)
    body.across(17.45, 17.8, -0.6, 0.6, "black", lift=0.014)
    body.across(0.0, 1.0, -0.97, 0.97, lower, lift=0.006)


def _handle(b: MeshBuilder, body: Body, style: CarStyle, x: float, side: float) -> None:
    drop, thick, out = (0.16, 0.035, 0.012) if style.detailed else (0.13, 0.03, 0.008)
    z = body.shape.belt - drop
    y = float(body.half_width(x, z)) * side
    b.box((0.18, thick, thick), (x, y + side * out, z), shade(style.color, 0.85))


def _glass_mirror(b: MeshBuilder, body: Body, x: float, z: float, side: float, color: Color) -> None:
    y = float(body.half_width(x, z)) * side + side * 0.12
    b.box((0.16, 0.22, 0.14), (x, y, z), color, bevel=0.035)
    corners = ((1, 0.03), (-1, 0.03), (-1, 0.11), (1, 0.11))
    b.quad([(x - 0.082, y + k * 0.08, z + dz) for k, dz in corners], "mirror")


def _flanks(b: MeshBuilder, body: Body, style: CarStyle) -> None:
    """Gaps between doors, a sill of dark plastic between the wheels, handles and mirrors."""
    shape = body.shape
    low = shape.sill + 0.10
    for x in style.doors:
        body.line([(x, low), (x, shape.belt - 0.02)])
    if style.doors:
        body.line([(style.doors[0], low), (style.doors[-1], low)])
    radius = shape.wheel_radius + shape.arch + 0.03
    x0, x1 = shape.axles[0] + radius, shape.axles[-1] - radius
    body.side([(x0, shape.sill), (x1, shape.sill), (x1, shape.sill + 0.07), (x0, shape.sill + 0.07)], "charcoal", 0.005)
    handles = [x + 0.17 for x in style.doors[:-1]]
    if style.detailed:
        for x in handles:
            for side in (-1.0, 1.0):
                _handle(b, body, style, x, side)
        for side in (-1.0, 1.0):
            _glass_mirror(b, body, shape.upper[11][0] - 0.38, shape.belt + 0.02, side, style.lower or style.color)
        return
    for side in (-1.0, 1.0):
        for x in handles:
            _handle(b, body, style, x, side)
        mirror = shape.upper[11][0] - 0.30
        y = float(body.half_width(mirror, shape.belt)) * side
        b.box((0.12, 0.13, 0.12), (mirror, y + side * 0.05, shape.belt + 0.02), style.color, bevel=0.03)


def build_car(shape: BodyShape, places: Places, style: CarStyle, glass: dict | None) -> tuple[MeshBuilder, Body]:
    """A car; `glass` = arguments of `Body.glasshouse`, or None for an open car (which has its own windscreen)."""
    b = MeshBuilder(roughness=0.35, metallic=0.1)
    body = Body(b, shape)
    body.shell(style.color)
    if glass is not None:
        body.across(*places["front_glass"], -0.93, 0.93, style.glass)
        if places["rear_glass"][1] > places["rear_glass"][0]:
            body.across(*places["rear_glass"], -0.88, 0.88, style.glass)
        body.glasshouse(**glass, glass=style.glass)
    _front_and_rear(b, body, places, style)
    _flanks(b, body, style)
    rim = rim_image(style.rim)
    for axle in shape.axles:
        for side in (-1.0, 1.0):
            y = shape.width / 2 * 0.97 - (0.11 if style.detailed else style.tyre / 2)
            wheel(b, (axle, side * y, shape.wheel_radius), shape.wheel_radius, style.tyre, rim, side)
    return b, body


def roof_rails(builder: MeshBuilder, body: Body, x0: float, x1: float, z: float, color: Color) -> None:
    for side in (-1.0, 1.0):
        y = float(body.half_width(0.0, z)) * 0.93 * side
        builder.tube(
            [(x0, y, z - 0.02), (x0 + 0.12, y, z + 0.05), (x1 - 0.12, y, z + 0.05), (x1, y, z - 0.04)],
            0.018,
            color,
            sides=6,
        )
