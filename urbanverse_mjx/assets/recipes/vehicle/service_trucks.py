"""Working lorries and vans: ambulance, fire engine, refuse lorry, mixer, snow plough, recovery, camper."""

import dataclasses

import numpy as np

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import recipe
from ..shared.sizes import fitted
from .car_build import CarStyle, build_car
from .car_shapes import PICKUP, PICKUP_PLACES, VAN, VAN_PLACES
from .trucks import box_shape, forward_cab
from .vehicle_body import Body
from .wheels import number_plate, road_wheels


def chequer(first: Color, second: Color, columns: int = 12, rows: int = 2) -> np.ndarray:
    y, x = np.mgrid[0 : rows * 8, 0 : columns * 8]
    return np.array([paint.rgb(first), paint.rgb(second)], np.uint8)[(x // 8 + y // 8) % 2]


def light_bar(b: MeshBuilder, x: float, z: float, width: float, lamp: Color = "blue") -> None:
    b.box((0.24, width, 0.05), (x, 0, z), "charcoal")
    for side in (-1, 1):
        b.box((0.22, width * 0.40, 0.13), (x, side * width * 0.28, z + 0.05), lamp, bevel=0.03)
    b.box((0.20, width * 0.14, 0.11), (x, 0, z + 0.05), "white", bevel=0.02)


def star_of_life(size: int = 32) -> np.ndarray:
    image, pen = paint.canvas((size * 4, size * 4), "white")
    c = size * 2
    for k in range(3):
        a = np.radians(90 + 60 * k)
        d, w = np.array([np.cos(a), np.sin(a)]) * c * 0.92, np.array([-np.sin(a), np.cos(a)]) * c * 0.24
        corners = [(c + s * d + t * w) for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        pen.polygon([tuple(p) for p in corners], fill=paint.rgb("signal blue"))
    pen.line((c, c * 0.45, c, c * 1.55), fill=paint.rgb("white"), width=6)
    return np.asarray(paint.shrunk(image, (size, size)))


def tall_van(style: CarStyle, along: float, up: float, windows: float = 0.55) -> tuple[MeshBuilder, Body]:
    shape = VAN.stretched(along, 1.0, up)
    glass = {"pillars": ((0.62, 0.10),), "span": (windows * along, 1.72 * along), "top": 1.95 * up}
    return build_car(shape, VAN_PLACES, style, glass)


@recipe("ambulance", 3, name="service_trucks.ambulance")
def ambulance(variant: int, rng: np.random.Generator) -> BuiltAsset:
    if variant == 1:
        return fitted(_box_ambulance(), (6.6, 2.32, 2.85))
    color, ink = (("#f4e23a", "dark green"), ("", ""), ("white", "signal red"))[variant]
    style = CarStyle(color, "pair", "bars", "steel", "EMS 112", (-0.35, 0.62, 1.62), "charcoal")
    b, body = tall_van(style, 1.14, 1.20)
    if variant == 0:
        body.side_image(-2.9, 1.9, 0.72, 1.22, chequer("#f4e23a", "dark green", 10))
    else:
        body.side_image(-2.9, 1.9, 0.86, 1.12, paint.lettering("", "signal red", "white"))
        body.side([(-2.9, 0.62), (1.9, 0.62), (1.9, 0.72), (-2.9, 0.72)], "signal blue", 0.006)
    body.side_image(-2.6, 0.35, 1.72, 2.12, paint.lettering("AMBULANCE", color, ink, (128, 20)))
    body.side_image(-0.1, 0.45, 1.22, 1.72, star_of_life(), lift=0.016)
    body.across(12.0, 13.6, -0.55, 0.55, image=paint.lettering("AMBULANCE", color, ink, (96, 20))[:, ::-1], lift=0.014)
    body.across(4.2, 5.2, -0.6, 0.6, image=paint.lettering("AMBULANCE", color, ink, (96, 20)), lift=0.02)
    light_bar(b, 0.75, 2.60, 1.35, "blue")
    light_bar(b, -2.7, 2.60, 1.2, "blue")
    names = ("A yellow ambulance with green chequers", "", "A white ambulance with a red band")
    size = ((6.2, 2.18, 2.78), (0, 0, 0), (6.0, 2.12, 2.68))[variant]
    return fitted(body.finish(names[variant], {"body": "van"}), size)


def _box_ambulance() -> BuiltAsset:
    """A cab with a square box behind it, the American kind."""
    style = CarStyle("white", "pair", "bars", "steel", "EMS 911", (0.10, 1.0), "charcoal")
    shape = PICKUP.stretched(1.25, 1.0, 1.12)
    b, body = build_car(shape, PICKUP_PLACES, style, {"pillars": (), "span": (0.06, 1.25)})
    x0, x1, low, high = -3.30, -0.30, 0.72, 2.62
    b.box((x1 - x0, 2.1, high - low), ((x0 + x1) / 2, 0, low), "white", bevel=0.05)
    image, pen = paint.canvas((384, 240), "white")
    pen.rectangle((0, 150, 384, 196), fill=paint.rgb("safety orange"))
    paint.text(pen, "AMBULANCE", (110, 20, 374, 80), "safety orange", 0.04)
    image.paste(paint.Image.fromarray(star_of_life(80)), (14, 12))
    pen.rectangle((240, 96, 330, 144), fill=paint.rgb("dark glass"))
    small = np.asarray(paint.shrunk(image, (128, 80)))
    for side, facing in ((1, "+y"), (-1, "-y")):
        b.panel(small, ((x0 + x1) / 2, side * 1.053, 1.67), x1 - x0 - 0.1, 1.8, facing)
    b.panel(small, (x0 - 0.004, 0, 1.67), 1.9, 1.8, "-x")
    light_bar(b, x1 - 0.15, high - 0.1, 1.7, "light red")
    light_bar(b, x0 + 0.2, high - 0.1, 1.7, "light red")
    built = body.finish("A white box ambulance with an orange stripe", {"body": "box"})
    return dataclasses.replace(built, volume=built.volume + (x1 - x0) * 2.1 * 1.3)


def shutters(color: Color, count: int) -> np.ndarray:
    """Roller shutters of a fire engine's lockers."""
    image, pen = paint.canvas((96 * count, 144), color)
    for k in range(count):
        x = 96 * k
        pen.rectangle((x + 6, 8, x + 90, 136), fill=paint.rgb("aluminium"))
        for y in range(12, 136, 10):
            pen.line((x + 6, y, x + 90, y), fill=paint.rgb("grey"), width=3)
        pen.rectangle((x + 36, 126, x + 60, 133), fill=paint.rgb("black"))
    return np.asarray(paint.shrunk(image, (32 * count, 48)))


def ladder(b: MeshBuilder, start: np.ndarray, end: np.ndarray, width: float, color: Color, rungs: int) -> None:
    side = np.array([0, width / 2, 0])
    for s in (-1, 1):
        b.beam(start + s * side, end + s * side, 0.05, 0.09, color)
    for k in range(rungs):
        at = start + (end - start) * (k + 0.5) / rungs
        b.rod(at - side, at + side, 0.02, color, sides=4)


@recipe("fire truck", 3, name="service_trucks.fire_truck")
def fire_truck(variant: int, rng: np.random.Generator) -> BuiltAsset:
    length, color, band = (
        (8.6, "signal red", "white"),
        (10.8, "#b3141c", "signal yellow"),
        (7.4, "#d8e02a", "signal red"),
    )[variant]
    b = MeshBuilder(roughness=0.35)
    f, r = length / 2, -length / 2
    axles = (r + 2.0, f - 1.45)
    shape = box_shape(length, 2.85, 0.25, 0.52, axles, 1.55)
    body = Body(b, shape)
    body.shell(color)
    body.glasshouse([(f - 1.35, 0.14)], (f - 2.55, f - 0.25), frame=0.16, top=2.55)
    body.across(9.95, 10.98, -0.95, 0.95, "dark glass", lift=0.01)
    body.side([(r + 0.06, 0.72), (f - 0.06, 0.72), (f - 0.06, 1.0), (r + 0.06, 1.0)], band, 0.006)
    x0, x1 = r + 0.25, f - 2.75
    body.side_image(x0, x1, 1.08, 2.35, shutters(color, round((x1 - x0) / 1.3)), lift=0.014)
    body.side_image(x0, x1, 2.40, 2.72, paint.lettering("FIRE BRIGADE  112", color, "white", (128, 10)), lift=0.014)
    body.line([(f - 2.6, 0.5), (f - 2.6, 2.6)])
    body.across(12.0, 12.8, -0.62, 0.62, image=paint.lettering("FIRE", color, "white", (64, 20)), lift=0.016)
    body.across(2.2, 4.2, -0.75, 0.75, image=shutters(color, 1), lift=0.014)
    body.across(14.0, 15.0, -0.98, 0.98, "white", lift=0.01)
    for t0, t1 in ((-0.93, -0.64), (0.64, 0.93)):
        body.across(12.9, 13.5, t0, t1, "lamp", lift=0.014)
        body.across(1.3, 2.0, t0, t1, "red", lift=0.014)
    body.across(14.1, 14.6, -0.12, 0.12, image=number_plate("FD 112"), lift=0.02)
    light_bar(b, f - 0.9, 2.86, 1.7, "blue")
    b.cylinder(0.1, 0.16, (r + 0.4, 0.9, 2.86), "blue", segments=10)
    for side in (-1, 1):
        b.box((0.10, 0.2, 0.36), (f + 0.08, side * 1.12, 1.95), "black", bevel=0.03)
    if variant == 1:  # the turntable ladder reaches from the tail over the cab
        b.cylinder(0.8, 0.3, (r + 2.0, 0, 2.85), "dark grey", segments=16)
        for k, (w, z) in enumerate(((0.95, 3.15), (0.78, 3.28), (0.62, 3.40))):
            start, end = np.array([r + 0.5, 0, z]), np.array([f - 0.1 + 0.2 * k, 0, z + 0.12])
            ladder(b, start, end, w, "aluminium", 11 - 2 * k)
        b.box((0.7, 1.2, 0.75), (f + 0.1, 0, 3.05), band, bevel=0.03)
    else:
        for y in (-0.45, 0.5):
            ladder(b, np.array([r + 0.3, y, 2.98]), np.array([f - 1.9, y, 3.05]), 0.5, "aluminium", 12)
        b.cylinder(0.14, 0.35, (-0.2, 0.0, 2.85), "black", segments=10)
        b.rod((-0.2, 0, 3.2), (0.7, 0, 3.28), 0.06, "signal red", sides=7)
    road_wheels(b, axles, 0.52, 1.22)
    names = ("A red fire engine with ladders", "A fire truck with a turntable ladder", "A yellow airport fire engine")
    size = ((8.6, 2.52, 3.30), (11.2, 2.55, 3.75), (7.4, 2.45, 3.15))[variant]
    return fitted(body.finish(names[variant], {"length": length}), size)


def chassis(b: MeshBuilder, front: float, back: float, rears: tuple[float, ...], plate: str) -> None:
    """Frame, rear wheels with mudguards, tail lamps of a lorry; the cab's centre is at `front`."""
    deck = front - 1.0
    for side in (-1, 1):
        b.box((deck - back + 0.6, 0.10, 0.24), ((deck + back) / 2 + 0.2, side * 0.42, 0.62), "charcoal")
        b.box((0.05, 0.34, 0.12), (back - 0.02, side * 0.85, 0.62), "red")
        b.box((0.9, 0.06, 0.28), (deck - 1.2, side * 1.10, 0.45), "dark grey")
    b.box((0.08, 2.2, 0.14), (back + 0.02, 0, 0.50), "dark grey")
    b.panel(number_plate(plate), (back - 0.04, 0, 0.66), 0.5, 0.12, "-x", back="black")
    road_wheels(b, (front + 0.05, *rears), 0.45, 1.14)
    for x in rears:
        for side in (-1, 1):
            b.box((1.0, 0.34, 0.04), (x, side * 0.97, 0.94), "black")


@recipe("garbage truck", 3, name="service_trucks.garbage_truck")
def garbage_truck(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.5)
    color, cab, words = (
        ("safety orange", "safety orange", "CITY CLEAN"),
        ("#2f8f46", "white", "RECYCLE"),
        ("white", "signal blue", "WASTE CO"),
    )[variant]
    front, back = 3.4, -3.5
    forward_cab(b, front, cab, 0.45, "GT 2026")
    chassis(b, front, back, (-1.9, -0.6), "GT 2026")
    # The packer body swells; the tailgate bulges over its loading hopper.
    body = [(-2.5, 0.95), (2.3, 0.95), (2.3, 2.95), (1.9, 3.2), (-2.2, 3.2), (-2.5, 3.05)]
    b.profile(body, 2.4, (0, 0, 0), color)
    tail = [
        (-2.55, 0.85),
        (-3.9, 0.75),
        (-4.35, 1.05),
        (-4.35, 1.45),
        (-3.75, 1.75),
        (-3.95, 2.7),
        (-3.2, 3.3),
        (-2.55, 3.3),
    ]
    b.profile(tail, 2.3, (0, 0, 0), shade(color, 0.85))
    b.box((0.7, 1.9, 0.5), (-4.03, 0, 1.12), "black")
    for side, facing in ((1, "+y"), (-1, "-y")):
        for k in range(5):
            b.box((0.10, 0.08, 2.1), (-2.2 + 1.05 * k, side * 1.22, 0.98), shade(color, 0.8))
        b.panel(
            paint.lettering(words, color, "white" if variant < 2 else "signal blue", (96, 20)),
            (-0.1, side * 1.275, 2.3),
            3.4,
            0.7,
            facing,
        )
        b.rod((-2.6, side * 1.0, 3.1), (-3.8, side * 1.1, 1.6), 0.07, "aluminium", sides=6)
        b.box((0.06, 0.25, 0.6), (-4.36, side * 1.0, 1.5), "black")
        b.box((0.05, 0.5, 0.5), (-4.0, side * 1.35, 0.5), "charcoal")
        b.box((0.4, 0.35, 0.04), (-4.3, side * 1.0, 0.45), "galvanised")
    b.box((0.03, 1.9, 0.12), (-4.37, 0, 0.98), "signal yellow")
    b.cylinder(0.1, 0.16, (front - 0.2, 0.6, 2.7), "amber", segments=10)
    b.cylinder(0.1, 0.14, (-3.0, -0.9, 3.3), "amber", segments=10)
    if variant < 2:  # a bin on the lift
        b.box((0.6, 0.6, 0.9), (-4.75, 0.1, 0.75), ("dark grey", "dark green")[variant], taper=(1.15, 1.15), bevel=0.03)
        b.box((0.74, 0.74, 0.07), (-4.75, 0.1, 1.65), "charcoal", bevel=0.02)
    names = ("An orange refuse lorry lifting a bin", "A green recycling lorry", "A white and blue garbage truck")
    size = ((9.1, 2.52, 3.45), (9.3, 2.53, 3.5), (8.5, 2.48, 3.35))[variant]
    return fitted(b.build(names[variant], {"words": words}), size)


@recipe("cement mixer", 3, name="service_trucks.cement_mixer")
def cement_mixer(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.5)
    cab, drum, stripe = (
        ("white", "#d8dadc", "signal red"),
        ("signal yellow", "signal yellow", "black"),
        ("#2f5fa8", "white", "#2f5fa8"),
    )[variant]
    front, back = 2.5, -3.0
    forward_cab(b, front, cab, 0.45, "MIX 8")
    chassis(b, front, back, ((-1.5,), (-1.6,), (-1.4,))[variant], "MIX 8")
    profile = [(0.35, 0), (0.75, 0.15), (1.08, 1.2), (1.12, 2.2), (0.95, 3.2), (0.52, 4.3), (0.48, 4.5)]
    with b.frame((1.25, 0, 1.78), (0, -76, 0)):
        b.lathe(profile, color=drum, segments=20, crease_deg=50)
        for k in range(18):  # the spiral painted on the drum
            a, z = k * 0.80, 0.5 + 0.195 * k
            r = float(np.interp(z, [p[1] for p in profile], [p[0] for p in profile])) + 0.012
            step = np.array([np.cos(a), np.sin(a), 0]) * r + [0, 0, z]
            b.box((0.05, 0.75, 0.14), tuple(step), stripe, (14, 0, float(np.degrees(a))), centered=True)
        b.ring(1.12, 0.05, (0, 0, 2.6), "dark grey", segments=20, sides=5)
    b.box((0.4, 1.6, 1.0), (1.2, 0, 0.9), "dark grey")
    b.box((0.3, 1.7, 1.5), (-2.55, 0, 0.85), "dark grey", taper=(1, 0.8))
    with b.frame((-3.05, 0, 2.95), (0, -20, 0)):
        b.cylinder(0.25, 0.5, color=drum, top_radius=0.55, segments=12)
    chute = np.array(
        [
            [(-3.1 - 0.75 * t, y, 1.9 - 0.95 * t + 0.25 * (y / 0.3) ** 2) for y in (-0.3, -0.15, 0, 0.15, 0.3)]
            for t in (0.0, 1.0)
        ]
    )
    b.sheet(chute, "galvanised", both_sides=True)
    for side in (-1, 1):
        b.rod((-2.9, side * 0.5, 0.9), (-3.0, side * 0.3, 2.6), 0.04, "dark grey", sides=5)
    ladder(b, np.array([-2.85, 0.95, 0.7]), np.array([-2.95, 0.75, 2.9]), 0.36, "signal yellow", 6)
    names = ("A white concrete mixer with a red spiral", "A yellow cement mixer", "A blue cement mixer truck")
    size = ((6.9, 2.32, 3.30), (6.3, 2.28, 3.3), (7.6, 2.42, 3.6))[variant]
    return fitted(b.build(names[variant], {"drum": str(drum)}), size)


def blade(b: MeshBuilder, x: float, width: float, height: float, color: Color, yaw: float, low: float = 0.02) -> None:
    """A plough blade: a curved sheet with a dark cutting edge, its middle at x."""
    angles = np.radians(np.linspace(-62, 58, 6))
    r = height / (np.sin(angles[-1]) - np.sin(angles[0]))
    across = np.linspace(-width / 2, width / 2, 5)
    rows = [[(-r * np.cos(a) + r * 0.5, y, low + r * (np.sin(a) - np.sin(angles[0]))) for y in across] for a in angles]
    with b.frame((x, 0, 0), (0, 0, yaw)):
        b.sheet(np.array(rows), color)
        b.sheet(np.array(rows)[:, ::-1], shade(color, 0.6))
        b.box((0.06, width, 0.16), (0.0, 0, low), "charcoal")
        for y in (-0.3, 0.0, 0.3):
            b.box((0.05, 0.06, height * 0.9), (-0.30 * height - 0.1, y * width, low + 0.05), "charcoal")
        for side in (-1, 1):
            b.rod(
                (0.0, side * width * 0.46, height),
                (0.0, side * width * 0.46, height + 0.55),
                0.015,
                "signal red",
                sides=5,
            )


@recipe("plow truck", 3, name="service_trucks.plow_truck")
def plow_truck(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.5)
    color, edge = (
        ("safety orange", "signal yellow"),
        ("signal yellow", "safety orange"),
        ("#2e6aa8", "signal yellow"),
    )[variant]
    front, back = 2.2, -3.4
    forward_cab(b, front, color, 0.45, "WINTER 1")
    chassis(b, front, back, ((-1.9,), (-2.3, -1.0), (-1.9,))[variant], "WINTER 1")
    hopper = [(-3.1, 1.9), (-2.4, 1.0), (0.4, 1.0), (1.0, 1.9), (1.0, 2.5), (-3.1, 2.5)]
    b.profile(hopper, 2.1, (0, 0, 0), shade(color, 0.92))
    b.convex(
        [(x, y, z) for x in (-3.0, 0.9) for y in (-0.95, 0.95) for z in (2.5,)] + [(-2.0, 0, 2.95), (0.0, 0, 2.95)],
        "off white",
    )
    for k in range(4):
        for side in (-1, 1):
            b.box((0.08, 0.06, 0.6), (-2.8 + 1.15 * k, side * 1.06, 1.9), shade(color, 0.7))
    b.cylinder(0.45, 0.12, (-3.55, 0, 0.45), "galvanised", segments=14)  # the spinner that throws salt
    b.box((0.5, 0.6, 0.9), (-3.3, 0, 0.6), "dark grey", taper=(0.7, 0.7))
    for side in (-1, 1):
        b.box((0.9, 0.1, 0.14), (front + 1.3, side * 0.45, 0.55), "charcoal")
        b.cylinder(0.1, 0.16, (front - 0.2, side * 0.8, 2.7), "amber", segments=10)
    blade(b, front + 1.95, 2.75, 1.05, edge, (14, -16, 0)[variant])
    names = ("An orange snow plough lorry with a salt spreader", "A yellow plough truck", "A blue winter service truck")
    size = ((7.9, 2.78, 3.05), (8.3, 2.9, 3.1), (7.3, 2.75, 2.9))[variant]
    return fitted(b.build(names[variant], {"color": str(color)}), size)
