"""Recovery vehicles, campers, caravans, trailers, snow clearers, armoured vehicles."""

import numpy as np

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import recipe
from ..shared.sizes import fitted
from .car_build import CarStyle, build_car
from .car_shapes import PICKUP, PICKUP_PLACES
from .carts import solid_wheel
from .service_trucks import blade, chassis, chequer, light_bar, tall_van
from .trucks import forward_cab
from .wheels import number_plate, rim_image, road_wheels, wheel


@recipe("roadside assistance vehicle", 3, name="road_service.roadside_assistance")
def roadside_assistance(variant: int, rng: np.random.Generator) -> BuiltAsset:
    if variant == 1:
        style = CarStyle("signal yellow", "pair", "bars", "steel", "AID 24", (-0.35, 0.62, 1.62), "charcoal")
        b, body = tall_van(style, 1.0, 1.0)
        body.side_image(-2.5, 1.6, 0.66, 0.92, chequer("signal yellow", "charcoal", 14, 1))
        words = paint.lettering("ROAD ASSISTANCE", "signal yellow", "black", (128, 24))
        body.side_image(-2.4, 0.3, 1.15, 1.65, words)
        body.across(
            4.2, 5.2, -0.6, 0.6, image=paint.lettering("24h AID", "signal yellow", "black", (64, 24)), lift=0.02
        )
        light_bar(b, 0.4, 2.22, 1.3, "amber")
        return fitted(body.finish("A yellow breakdown patrol van", {"kind": "van"}), (5.3, 2.05, 2.35))
    if variant == 2:
        style = CarStyle("signal red", "pair", "mesh", "steel", "TOW 1", (-0.8, 0.1, 1.0), "charcoal")
        b, body = build_car(
            PICKUP.stretched(1.1, 1.05, 1.1), PICKUP_PLACES, style, {"pillars": ((0.0, 0.09),), "span": (-0.95, 1.1)}
        )
        b.box((1.9, 1.8, 0.25), (-1.95, 0, 1.15), "white", bevel=0.04)
        for side in (-1, 1):
            b.beam((-1.2, side * 0.30, 1.35), (-3.25, side * 0.08, 2.25), 0.10, 0.14, "white")
            b.beam((-2.2, side * 0.26, 1.3), (-2.3, side * 0.22, 1.75), 0.08, 0.08, "dark grey")
        b.rod((-3.22, 0, 2.25), (-3.25, 0, 1.0), 0.02, "black", sides=5)
        b.tube([(-3.25, 0, 1.0), (-3.18, 0, 0.88), (-3.28, 0, 0.80), (-3.36, 0, 0.88)], 0.035, "signal yellow", sides=6)
        light_bar(b, -0.2, 1.98, 1.4, "amber")
        return fitted(body.finish("A red wrecker with a crane hook", {"kind": "wrecker"}), (5.9, 2.15, 2.35))
    b = MeshBuilder(roughness=0.5)
    front, back = 2.4, -3.4
    forward_cab(b, front, "signal yellow", 0.45, "TOW 24")
    chassis(b, front, back, (-1.7,), "TOW 24")
    b.box((4.9, 2.3, 0.14), (-0.95, 0, 0.96), "galvanised")
    for side, facing in ((1, "+y"), (-1, "-y")):
        b.box((4.9, 0.06, 0.2), (-0.95, side * 1.13, 0.92), "signal yellow")
        b.panel(
            paint.lettering("ROADSIDE ASSISTANCE 24h", "signal yellow", "black", (160, 8)),
            (-0.95, side * 1.163, 1.02),
            4.0,
            0.19,
            facing,
        )
        b.rod((-3.2, side * 0.85, 0.95), (-3.95, side * 0.85, 0.35), 0.06, "galvanised", sides=5)
        b.box((0.8, 0.4, 0.05), (-3.75, side * 0.75, 0.55), "galvanised", (0, 38, 0))
        b.rod((1.3, side * 1.0, 1.0), (1.3, side * 1.0, 2.4), 0.05, "signal yellow", sides=6)
    b.rod((1.3, -1.0, 2.4), (1.3, 1.0, 2.4), 0.05, "signal yellow", sides=6)
    b.cylinder(0.16, 0.6, (1.1, 0.3, 1.25), "dark grey", (90, 0, 0), segments=10)
    light_bar(b, front - 0.2, 2.70, 1.5, "amber")
    built = b.build("A yellow flatbed recovery lorry", {"kind": "flatbed"})
    return fitted(built, (6.9, 2.32, 2.58))


def _old_bus() -> BuiltAsset:
    """The round-nosed bus of the sixties in two colours."""
    b = MeshBuilder(roughness=0.4)
    side_view = [
        (-2.1, 0.35),
        (-2.15, 0.9),
        (-2.05, 1.5),
        (-1.85, 1.88),
        (1.5, 1.9),
        (1.9, 1.65),
        (2.1, 1.15),
        (2.15, 0.6),
        (2.1, 0.35),
    ]
    low = [(x, min(z, 1.08)) for x, z in side_view]
    b.profile(side_view, 1.68, (0, 0, 0), "cream")
    b.profile(low, 1.74, (0, 0, 0), "#3f8f9a")
    b.box((3.4, 1.5, 0.22), (-0.2, 0, 1.86), "cream", bevel=0.08)
    for side in (-1, 1):
        for k in range(4):
            b.box((0.72, 0.03, 0.42), (-1.52 + 0.86 * k, side * 0.845, 1.22), "dark glass")
        for x in (-1.25, 1.3):
            wheel(b, (x, side * 0.76, 0.33), 0.33, 0.19, rim_image("cap"), side)
        b.cylinder(0.12, 0.05, (2.12, side * 0.6, 0.85), "lamp", (0, 90, 0), segments=12)
        b.cylinder(0.07, 0.04, (-2.17, side * 0.65, 0.75), "red", (0, -90, 0), segments=10)
        b.quad(
            [
                (2.10, 0.06 + 0.36 * side - 0.34, 1.20),
                (2.10, 0.36 * side + 0.30, 1.20),
                (1.92, 0.36 * side + 0.28, 1.62),
                (1.92, 0.36 * side - 0.28, 1.62),
            ],
            "dark glass",
        )
    b.ring(0.20, 0.025, (2.155, 0, 0.85), "cream", (0, 90, 0), 16, 4)
    b.box((0.12, 1.7, 0.14), (2.12, 0, 0.36), "white", bevel=0.03)
    b.box((0.12, 1.7, 0.14), (-2.14, 0, 0.36), "white", bevel=0.03)
    b.box((1.2, 0.9, 0.25), (-0.4, 0, 2.08), "brown", bevel=0.05)
    return b.build("An old turquoise and cream camper bus", {"kind": "bus"})


@recipe("camper", 3, name="road_service.camper")
def camper(variant: int, rng: np.random.Generator) -> BuiltAsset:
    if variant == 0:
        style = CarStyle("off white", "pair", "bars", "cap", "CAMP 1", (0.62, 1.62), "charcoal")
        b, body = tall_van(style, 1.12, 1.16)
        for x0, x1 in ((-2.5, -1.6), (-0.9, 0.0)):
            body.side([(x0, 1.55), (x1, 1.55), (x1, 2.0), (x0, 2.0)], "dark glass", 0.012)
        body.side([(-2.9, 0.95), (1.9, 1.05), (1.9, 1.2), (-2.9, 1.15)], "teal", 0.006)
        body.side([(-2.9, 1.2), (0.6, 1.25), (0.6, 1.32), (-2.9, 1.28)], "orange", 0.006)
        b.box((2.6, 0.16, 0.16), (-1.2, -0.92, 2.42), "white", bevel=0.04)  # the rolled awning
        b.box((0.7, 0.7, 0.14), (-0.5, 0.1, 2.55), "light grey", bevel=0.04)
        for y in (-0.3, 0.3):  # bicycles' rack behind
            b.ring(0.30, 0.025, (-3.10, y, 1.25), "black", (0, 90, 0), 14, 4)
        b.box((0.06, 1.3, 0.06), (-3.08, 0, 0.9), "aluminium")
        return fitted(body.finish("A white van camper with an awning", {"kind": "van"}), (6.15, 2.15, 2.78))
    if variant == 1:  # a coachbuilt one: the cabin hangs over the cab
        style = CarStyle("white", "pair", "bars", "steel", "CAMP 2", (0.62, 1.62))
        b, body = tall_van(style, 1.2, 0.92)
        outline = [
            (-3.7, 0.75),
            (0.85, 0.75),
            (0.85, 1.95),
            (2.0, 2.1),
            (2.1, 2.55),
            (1.7, 2.85),
            (-3.4, 2.9),
            (-3.7, 2.7),
        ]
        b.profile(outline, 2.2, (0, 0, 0), "white")
        for side, facing in ((1, "+y"), (-1, "-y")):
            band = paint.lettering("WANDERER", "white", "#7a5a3a", (96, 16))
            b.panel(band, (-1.6, side * 1.106, 1.3), 3.6, 0.4, facing)
            for x, w in ((-2.8, 0.9), (-1.2, 1.0), (0.3, 0.5), (1.5, 0.5)):
                b.box((w, 0.03, 0.45), (x, side * 1.105, 2.0 if x < 1 else 2.35), "dark glass")
        b.box((0.65, 0.03, 1.75), (-0.35, -1.107, 0.85), "light grey")
        b.box((0.03, 1.2, 0.5), (-3.71, 0, 1.9), "dark glass")
        for side in (-1, 1):
            b.box((0.04, 0.2, 0.4), (-3.72, side * 0.9, 0.9), "red")
        return fitted(body.finish("A white coachbuilt motorhome", {"kind": "coachbuilt"}), (7.1, 2.3, 3.0))
    return fitted(_old_bus(), (5.0, 1.95, 2.42))


@recipe("caravan", 3, name="road_service.caravan")
def caravan(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.45)
    color, band = (("white", "signal blue"), ("#d9d2b8", "orange"), ("aluminium", "dark grey"))[variant]
    length, height, width = ((5.0, 2.35, 2.2), (3.6, 2.25, 2.0), (6.2, 2.4, 2.35))[variant]
    f, r, z = length / 2, -length / 2, 0.42
    if variant == 2:  # a riveted aluminium capsule
        side = [
            (
                f * 0.99 * np.cos(a) * abs(np.cos(a)) ** -0.35 if abs(np.cos(a)) > 0.05 else 0.0,
                z + 0.2 + (height - 0.75) * max(np.sin(a), -0.1) ** 1,
            )
            for a in np.radians(np.linspace(-6, 186, 15))
        ]
        b.profile([*side, (r + 0.1, z), (f - 0.1, z)], width * 0.9, (0, 0, 0), color)
        b.profile(
            [(x * 0.96, min(p, z + (height - 0.75) * 1.05)) for x, p in side] + [(r + 0.2, z), (f - 0.2, z)],
            width,
            (0, 0, 0),
            color,
        )
    else:
        outline = [
            (f, z + 0.1),
            (f, z + 0.9),
            (f - 0.30, height - 0.25),
            (f - 0.7, height),
            (r + 0.4, height),
            (r + 0.05, height - 0.3),
            (r, z + 0.1),
            (r + 0.1, z),
            (f - 0.1, z),
        ]
        b.profile(outline, width, (0, 0, 0), color)
    for side in (-1, 1):
        y = side * (width / 2 + 0.005)
        b.box((length * 0.92, 0.02, 0.12), (0, y, 0.88), band)
        b.box((length * 0.92, 0.02, 0.05), (0, y, 1.05), shade(band, 1.2))
        for share in (-0.28, 0.28) if variant != 2 else (-0.3, 0.0, 0.3):
            b.box((length * 0.2, 0.03, 0.5), (share * length, y, 1.32), "dark glass")
        wheel(b, (0, side * (width / 2 - 0.10), 0.33), 0.33, 0.19, rim_image("cap"), side)
        b.box((0.85, 0.03, 0.10), (0, y, 0.66), "charcoal")
        b.beam((f - 0.3, side * 0.6, 0.42), (f + 1.25, side * 0.03, 0.42), 0.07, 0.08, "dark grey")
        b.box((0.03, 0.18, 0.40), (r - 0.01, side * 0.8, 0.7), "red")
    b.box((0.65, 0.03, 1.7), (-0.05 if variant != 2 else -0.95, -width / 2 - 0.012, 0.55), shade(color, 0.9))
    b.box((0.03, width * 0.7, 0.5), (f - 0.14, 0, 1.45), "dark glass", (0, -20, 0))
    b.box((0.7, 0.5, 0.35), (f + 0.35, 0, 0.46), shade(color, 0.9), bevel=0.06)
    b.rod((f + 1.15, 0, 0.0), (f + 1.15, 0, 0.7), 0.03, "aluminium", sides=6)
    b.cylinder(0.08, 0.06, (f + 1.15, 0.03, 0.08), "rubber", (90, 0, 0), segments=8)
    b.ball(0.06, (f + 1.32, 0, 0.46), "black", segments=8, rings=5)
    b.box((0.6, 0.6, 0.12), (-0.2, 0, height - 0.02), "light grey", bevel=0.03)
    b.panel(number_plate("CV 88"), (r - 0.02, 0, 0.72), 0.5, 0.12, "-x")
    names = ("A white touring caravan with blue bands", "A small beige caravan", "A riveted aluminium caravan")
    size = ((6.4, 2.26, 2.55), (4.9, 2.05, 2.45), (7.4, 2.4, 2.7))[variant]
    return fitted(b.build(names[variant], {"axles": 1}), size)


@recipe("trailer", 3, name="road_service.trailer")
def trailer(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.6)
    if variant == 2:  # a curtain-sided semi-trailer on three axles
        b.box((12.6, 2.48, 2.75), (0, 0, 1.2), "signal blue", bevel=0.02)
        words = paint.lettering("TRANS EUROPA", "signal blue", "white", (192, 32))
        for side, facing in ((1, "+y"), (-1, "-y")):
            b.panel(words, (0, side * 1.246, 2.6), 9.0, 1.5, facing)
            for k in range(14):
                b.box((0.05, 0.03, 0.28), (-5.9 + 0.9 * k, side * 1.25, 1.12), "black")
            b.rod((4.2, side * 0.8, 0.0), (4.2, side * 0.8, 1.1), 0.08, "dark grey", sides=6)
        b.box((12.6, 0.9, 0.3), (0, 0, 0.9), "charcoal")
        road_wheels(b, (-5.2, -3.9, -2.6), 0.5, 1.22)
        b.box((0.03, 2.3, 2.5), (-6.32, 0, 1.3), "light grey")
        b.box((0.1, 2.4, 0.14), (-6.3, 0, 0.6), "signal red")
        return fitted(b.build("A blue curtain-sided semi-trailer", {"axles": 3}), (13.0, 2.5, 3.9))
    length, width, wall = ((2.6, 1.45, 0.55), (3.6, 1.7, 0.35))[variant]
    r = -length / 2
    b.box((length, width, 0.08), (0, 0, 0.58), "wood" if variant == 0 else "galvanised")
    for side in (-1, 1):
        b.box((length, 0.04, wall), (0, side * (width / 2 - 0.02), 0.62), "galvanised")
        for x in (0.0,) if variant == 0 else (-0.42, 0.42):
            wheel(b, (x, side * (width / 2 + 0.12), 0.31), 0.31, 0.18, rim_image("steel"), side)
        fender = [
            (-0.42 - 0.4 * variant, 0.5),
            (-0.36 - 0.4 * variant, 0.72),
            (0.36 + 0.4 * variant, 0.72),
            (0.42 + 0.4 * variant, 0.5),
        ]
        b.profile(fender, 0.22, (0, side * (width / 2 + 0.11), 0), "black")
        b.beam((length / 2 - 0.1, side * 0.45, 0.55), (length / 2 + 1.2, side * 0.03, 0.50), 0.06, 0.08, "galvanised")
        b.box((0.03, 0.2, 0.1), (r - 0.02, side * 0.6, 0.52), "red")
        for k in range(4):
            b.box((0.05, 0.05, wall), (r + 0.05 + k * (length - 0.1) / 3, side * width / 2, 0.62), "dark grey")
    for x in (r, length / 2 - 0.04):
        b.box((0.04, width, wall), (x + 0.02, 0, 0.62), "galvanised")
    b.rod((length / 2 + 1.0, 0, 0.05), (length / 2 + 1.0, 0, 0.75), 0.03, "aluminium", sides=6)
    b.cylinder(0.08, 0.06, (length / 2 + 1.0, 0.03, 0.08), "rubber", (90, 0, 0), segments=8)
    if variant == 0:  # under a tarpaulin on hoops
        hood = [
            (r + 0.02, 1.1),
            (length / 2 - 0.02, 1.1),
            (length / 2 - 0.02, 1.55),
            (length / 2 - 0.15, 1.66),
            (r + 0.15, 1.66),
            (r + 0.02, 1.55),
        ]
        b.profile(hood, width + 0.02, (0, 0, 0), "#3a6ea5")
        for k in range(6):
            b.box((0.05, width + 0.06, 0.05), (r + 0.2 + k * (length - 0.4) / 5, 0, 1.12), "black")
    else:  # carrying a heap of cut branches and a mower
        for k in range(6):
            b.ball(
                (0.5, 0.35, 0.28),
                (-1.2 + 0.45 * k, 0.25 * (-1) ** k, 0.85),
                ("leaf", "dark leaf")[k % 2],
                segments=8,
                rings=5,
            )
    names = ("A car trailer under a blue tarpaulin", "A twin-axle garden trailer")
    return fitted(b.build(names[variant], {"axles": variant + 1}), ((4.0, 1.85, 1.62), (4.8, 2.05, 1.2))[variant])


def farm_wheel(b: MeshBuilder, at: tuple[float, float, float], radius: float, width: float, rim: Color) -> None:
    """A tractor's wheel with slanting lugs."""
    solid_wheel(b, at, radius * 0.96, width, rim)
    for k in range(12):
        a = np.pi / 6 * k
        x, z = at[0] + radius * 0.94 * np.cos(a), at[2] + radius * 0.94 * np.sin(a)
        b.box((0.09, width, 0.07), (x, at[1], z), "rubber", (0, 90 - float(np.degrees(a)), 0), centered=True)


@recipe("snowplow", 3, name="road_service.snowplow")
def snowplow(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.5)
    if variant == 1:  # a municipal tractor for pavements
        for x in (-0.75, 0.75):
            for side in (-1, 1):
                farm_wheel(b, (x, side * 0.55, 0.36), 0.36, 0.22, "white")
        b.box((2.3, 0.8, 0.35), (0, 0, 0.40), "charcoal", bevel=0.05)
        b.box((1.0, 1.05, 0.45), (-0.75, 0, 0.72), "safety orange", bevel=0.08)
        b.box((1.25, 1.15, 1.15), (0.35, 0, 0.75), "dark glass", taper=(0.86, 0.9), bevel=0.06)
        for side in (-1, 1):
            b.beam((0.95, side * 0.55, 0.8), (0.82, side * 0.5, 1.9), 0.07, 0.07, "safety orange")
            b.beam((-0.25, side * 0.55, 0.8), (-0.18, side * 0.5, 1.9), 0.07, 0.07, "safety orange")
        b.box((1.2, 1.15, 0.10), (0.33, 0, 1.88), "safety orange", bevel=0.04)
        b.cylinder(0.08, 0.14, (0.2, 0.3, 1.97), "amber", segments=10)
        b.cylinder(0.3, 0.5, (-1.35, 0, 0.65), "signal yellow", segments=12, top_radius=0.45)
        blade(b, 1.75, 1.6, 0.62, "safety orange", 14)
        return fitted(b.build("An orange pavement snowplough", {"kind": "tractor"}), (3.6, 1.62, 2.1))
    color = ("signal yellow", "#b02a2a")[variant // 2]
    front, back = 0.9, -2.3
    forward_cab(b, front, color, 0.45, "SNOW 7")
    chassis(b, front, back, (-1.5,), "SNOW 7")
    b.box((2.4, 2.1, 0.8), (-1.3, 0, 0.95), shade(color, 0.85), taper=(1.0, 1.0), bevel=0.05)
    b.box((2.0, 1.7, 0.25), (-1.3, 0, 1.7), "off white", taper=(0.7, 0.6))
    b.cylinder(0.1, 0.16, (front - 0.2, 0, 2.68), "amber", segments=10)
    for side in (-1, 1):
        b.box((0.8, 0.1, 0.14), (front + 1.2, side * 0.45, 0.55), "charcoal")
    if variant == 0:
        blade(b, front + 1.8, 2.4, 1.0, "safety orange", 16)
    else:  # a rotary blower: drum, auger and chute
        b.box((0.9, 2.4, 1.1), (front + 1.75, 0, 0.05), "signal yellow")
        for k in range(9):
            b.cylinder(
                0.45, 0.06, (front + 2.25, -1.05 + 0.26 * k, 0.55), "dark grey", (90, 12 * (-1) ** k, 0), segments=12
            )
        b.tube(
            [(front + 1.7, 0, 1.1), (front + 1.7, 0, 2.3), (front + 1.8, 0.6, 2.7)],
            [0.28, 0.24, 0.18],
            "signal yellow",
            sides=10,
        )
    names = ("A yellow snowplough", "", "A red rotary snow blower")
    size = ((5.6, 2.5, 2.65), (0, 0, 0), (5.9, 2.6, 2.9))[variant]
    return fitted(b.build(names[variant], {"kind": ("blade", "", "blower")[variant]}), size)
