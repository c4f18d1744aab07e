"""Puts a car together: body, glass, lights, doors, mirrors, wheels."""

import dataclasses

from ...meshes.mesh_builder import MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import Physics
from .vehicle_body import Body, BodyShape
from .wheels import grille_picture, number_plate, rim_picture, wheel

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
    """One car: colour, rim, grille, plate; `doors` are x of the gaps between doors; `lower` is the bumpers' colour."""

    color: Color
    rim: str = "spokes5"
    grille: str = "bars"
    plate: str = "UV 204"
    lower: Color | None = None
    doors: tuple[float, ...] = (-0.95, 0.05, 1.02)


def _lights(body: Body, places: dict[str, tuple[float, float]], style: CarStyle) -> None:
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
            [
                (x - 0.082, y + side * 0.12 + k * 0.08, z + dz)
                for k, dz in ((1, 0.03), (-1, 0.03), (-1, 0.11), (1, 0.11))
            ],
            "mirror",
        )


def _doors(builder: MeshBuilder, body: Body, style: CarStyle) -> None:
    shape = body.shape
    low = shape.sill + 0.10
    for x in style.doors:
        body.line([(x, low), (x, shape.belt - 0.02)])
    body.line([(style.doors[0], low), (style.doors[-1], low)])
    # The sill between the wheels is dark plastic.
    radius = shape.wheel_radius + shape.arch + 0.03
    body.side(
        [
            (shape.axles[0] + radius, shape.sill),
            (shape.axles[-1] - radius, shape.sill),
            (shape.axles[-1] - radius, shape.sill + 0.07),
            (shape.axles[0] + radius, shape.sill + 0.07),
        ],
        "charcoal",
        0.005,
    )
    for x in style.doors[:-1]:
        z = shape.belt - 0.16
        for side in (-1.0, 1.0):
            y = float(body.half_width(x + 0.17, z)) * side
            builder.box((0.18, 0.035, 0.035), (x + 0.17, y + side * 0.012, z), shade(style.color, 0.85))


def build_car(
    shape: BodyShape, places: dict[str, tuple[float, float]], style: CarStyle, glass: dict
) -> tuple[MeshBuilder, Body]:
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


def roof_rails(builder: MeshBuilder, body: Body, x0: float, x1: float, z: float, color: Color) -> None:
    for side in (-1.0, 1.0):
        y = float(body.half_width(0.0, z)) * 0.93 * side
        builder.tube(
            [(x0, y, z - 0.02), (x0 + 0.12, y, z + 0.05), (x1 - 0.12, y, z + 0.05), (x1, y, z - 0.04)],
            0.018,
            color,
            sides=6,
        )
