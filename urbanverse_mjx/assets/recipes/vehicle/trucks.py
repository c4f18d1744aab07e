"""Buses and trucks."""

import dataclasses

import numpy as np

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import Physics, recipe
from .vehicle_body import Body, BodyShape
from .wheels import number_plate, road_wheels

_BUS = Physics(
    ("steel", "glass", "rubber"), 130.0, (6000.0, 18000.0), 0.6, False, "a 10 m city bus weighs 8-12 t empty"
)
_TRUCK = Physics(
    ("steel", "aluminium", "rubber"), 150.0, (3000.0, 16000.0), 0.6, False, "two-axle box trucks weigh 4-8 t empty"
)

_BOX_SECTION = ((0.25, 0.965), (0.55, 0.99), (1.0, 1.0), (1.35, 0.995), (2.75, 0.965), (3.3, 0.94))


def box_shape(
    length: float, height: float, nose: float, wheel_radius: float, axles: tuple[float, ...], belt: float
) -> BodyShape:
    """A bus-like outline: upright back, flat roof, a windscreen that leans back by `nose` metres."""
    r, f = -length / 2, length / 2
    return BodyShape(
        upper=(
            (r + 0.10, 0.34, 0.02),
            (r, 0.50, 0.04),
            (r, 1.10, 0.04),
            (r + 0.02, 1.75, 0.03),
            (r + 0.04, height - 0.32, 0.03),
            (r + 0.14, height - 0.08, 0.03),
            (r + 0.55, height, 0.03),
            (0.0, height + 0.02, 0.03),
            (f - nose - 0.55, height, 0.03),
            (f - nose - 0.12, height - 0.10, 0.05),
            (f - nose, height - 0.36, 0.08),
            (f - 0.10, 1.22, 0.10),
            (f - 0.03, 1.02, 0.10),
            (f, 0.75, 0.10),
            (f, 0.50, 0.10),
            (f - 0.08, 0.32, 0.07),
        ),
        width=2.5,
        section=_BOX_SECTION,
        axles=axles,
        wheel_radius=wheel_radius,
        sill=0.30,
        belt=belt,
        taper=(0.01, 0.03),
        taper_length=0.8,
        arch=0.07,
        rounding=0.07,
    )


@recipe("bus", 3, _BUS, hulls=6, name="trucks.bus")
def bus(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.4, metallic=0.05)
    color, band, line, length = (
        ("signal red", "white", "12 CENTRAL STATION", 12.0),
        ("#3f7fae", "white", "7 HARBOUR", 10.5),
        ("#e8e4d6", "dark green", "104 UNIVERSITY", 12.0),
    )[variant]
    axles = (-length * 0.25, length * 0.29)
    shape = box_shape(length, 3.0, 0.22, 0.47, axles, 1.42)
    body = Body(b, shape)
    body.shell(color)
    f, r = length / 2, -length / 2
    pillars = [(x, 0.10) for x in np.arange(r + 1.6, f - 1.0, 1.45)]
    body.glasshouse(pillars, (r + 0.25, f - 0.30), frame=0.16, top=2.72)
    body.side([(r + 0.08, 1.16), (f - 0.06, 1.16), (f - 0.06, 1.28), (r + 0.08, 1.28)], band, 0.006)
    # Doors on the right: two wings of glass each.
    for x in (f - 1.05, -0.35):
        body.side([(x - 0.62, 0.36), (x + 0.62, 0.36), (x + 0.62, 2.50), (x - 0.62, 2.50)], "charcoal", 0.014, "r")
        for k in (-1, 1):
            body.side(
                [
                    (x + k * 0.31 - 0.25, 0.50),
                    (x + k * 0.31 + 0.25, 0.50),
                    (x + k * 0.31 + 0.25, 2.40),
                    (x + k * 0.31 - 0.25, 2.40),
                ],
                "glass",
                0.022,
                "r",
            )
    body.across(9.95, 10.98, -0.95, 0.95, "dark glass", lift=0.01)
    body.across(9.35, 9.95, -0.80, 0.80, image=paint.lettering(line, "black", "amber", (128, 16), bold=0.02), lift=0.02)
    body.across(3.1, 4.2, -0.85, 0.85, "dark glass", lift=0.01)
    body.across(
        4.3,
        4.75,
        -0.35,
        0.35,
        image=paint.lettering(line.split()[0], "black", "amber", (48, 16), bold=0.02),
        lift=0.02,
    )
    for side in (-1, 1):
        t0, t1 = sorted((side * 0.62, side * 0.94))
        body.across(12.9, 13.5, t0, t1, "lamp", lift=0.014)
        body.across(1.35, 2.0, t0 if side < 0 else t0 + 0.12, t1 if side > 0 else t1 - 0.12, "red", lift=0.014)
        # Mirrors on arms like ears.
        y = side * 1.25
        b.tube(
            [(f - 0.40, y * 0.85, 2.72), (f + 0.12, y * 1.02, 2.66), (f + 0.14, y * 1.04, 2.30)],
            0.025,
            "black",
            sides=6,
        )
        b.box((0.12, 0.20, 0.36), (f + 0.14, y * 1.04, 2.00), "black", bevel=0.03)
    plate = number_plate("BUS 204")
    body.across(14.1, 14.6, -0.12, 0.12, image=plate, lift=0.02)
    body.across(1.0, 1.2, -0.12, 0.12, image=plate, lift=0.02)
    body.across(14.0, 15.0, -0.98, 0.98, "charcoal", lift=0.006)
    b.box((2.2, 1.6, 0.22), (r + 2.4, 0, 3.02), shade(color, 0.85), bevel=0.06)
    road_wheels(b, axles, 0.47, 1.24, 0.32, 18)
    names = ("A red city bus of line 12", "A blue midi bus of line 7", "A cream and green city bus")
    return body.finish(names[variant], {"line": line, "length": length})


def forward_cab(b: MeshBuilder, x: float, color: Color, low: float, plate: str) -> None:
    """A forward-control truck cab whose back is at x - 0.95 and whose front is at x + 0.95."""
    shape = BodyShape(
        upper=(
            (x - 0.94, low + 0.10, 0.0),
            (x - 0.95, low + 0.3, 0.0),
            (x - 0.95, 1.2, 0.0),
            (x - 0.95, 1.8, 0.0),
            (x - 0.93, 2.45, 0.0),
            (x - 0.80, 2.62, 0.03),
            (x - 0.2, 2.70, 0.03),
            (x + 0.35, 2.66, 0.04),
            (x + 0.55, 2.52, 0.06),
            (x + 0.80, 1.58, 0.10),
            (x + 0.88, 1.40, 0.10),
            (x + 0.95, 1.05, 0.10),
            (x + 0.96, 0.75, 0.10),
            (x + 0.92, low, 0.08),
        ),
        width=2.2,
        section=((0.3, 0.97), (0.8, 1.0), (1.3, 1.0), (1.5, 0.985), (2.7, 0.88), (3.0, 0.85)),
        axles=(x + 0.05,),
        wheel_radius=0.43,
        sill=low + 0.02,
        belt=1.52,
        taper=(0.0, 0.05),
        taper_length=0.6,
        arch=0.07,
        rounding=0.05,
    )
    body = Body(b, shape)
    body.shell(color)
    body.glasshouse([(x - 0.42, 0.10)], (x - 0.85, x + 0.75), frame=0.10)
    body.across(8.1, 8.95, -0.92, 0.92, "dark glass", lift=0.012)
    body.across(
        10.1, 11.0, -0.6, 0.6, image=paint.lettering("= = =", "black", "light grey", (48, 12), bold=0.02), lift=0.014
    )
    body.across(12.0, 12.95, -0.97, 0.97, "charcoal", lift=0.010)
    body.across(12.35, 12.75, -0.24, 0.24, image=number_plate(plate), lift=0.025)
    body.line([(x - 0.60, low + 0.35), (x - 0.60, 1.5)])
    body.line([(x + 0.62, 1.1), (x + 0.62, 1.5)])
    for side in (-1, 1):
        t0, t1 = sorted((side * 0.68, side * 0.95))
        body.across(11.1, 11.8, t0, t1, "lamp", lift=0.016)
        b.rod((x + 0.70, side * 0.98, 2.1), (x + 0.82, side * 1.20, 2.1), 0.018, "black", sides=5)
        b.box((0.10, 0.18, 0.42), (x + 0.82, side * 1.22, 1.72), "black", bevel=0.03)


@recipe("truck", 3, _TRUCK, hulls=5, name="trucks.truck")
def truck(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.5, metallic=0.1)
    color, plate, front = (
        ("white", "LKW 55", 2.35),
        ("safety orange", "TP 810", 2.05),
        ("dark blue", "MV 7002", 2.55),
    )[variant]
    forward_cab(b, front, color, 0.45, plate)
    back = -front - 0.55
    deck = front - 1.05
    length = deck - back
    middle = (deck + back) / 2
    for side in (-1, 1):
        b.box((length + 0.4, 0.10, 0.22), (middle + 0.2, side * 0.42, 0.62), "charcoal")
        b.box((0.8, 0.06, 0.30), (middle + 0.3, side * 1.08, 0.42), "dark grey")
    b.box((0.55, 0.42, 0.40), (deck - 0.7, 0.85, 0.42), "galvanised", bevel=0.05)
    if variant == 1:  # a tipper with gravel
        b.box((length, 2.3, 0.12), (middle, 0, 0.95), "dark grey")
        for side in (-1, 1):
            b.box((length, 0.08, 0.75), (middle, side * 1.11, 1.05), color)
            for k in range(5):
                b.box((0.10, 0.06, 0.72), (back + 0.2 + k * (length - 0.4) / 4, side * 1.17, 1.05), shade(color, 0.75))
            b.box((0.08, 2.14, 0.75 if side < 0 else 1.1), (middle + side * (length / 2 - 0.04), 0, 1.05), color)
        heap = np.array(
            [
                [
                    (
                        back + 0.1 + (length - 0.2) * u,
                        (v - 0.5) * 2.1,
                        1.55 + 0.45 * np.sin(np.pi * u) * np.sin(np.pi * v) + 0.04 * rng.normal(),
                    )
                    for u in np.linspace(0, 1, 9)
                ]
                for v in np.linspace(0, 1, 6)
            ]
        )
        b.sheet(heap, image=np.asarray(paint.speckled((48, 32), "#8d8375", rng, 18)))
    else:
        box_color = ("off white", "#d9dde0")[variant // 2]
        b.box((length, 2.4, 2.3), (middle, 0, 0.90), box_color, bevel=0.03)
        back_color, ink, name = (
            ("signal blue", "white", "NORDIC LOGISTICS"),
            ("dark blue", "signal yellow", "MOVE & STORE"),
        )[variant // 2]
        image = paint.lettering(name, back_color, ink, (192, 32), bold=0.02)
        for side, facing in ((1, "+y"), (-1, "-y")):
            b.panel(image, (middle, side * 1.205, 2.15), length * 0.82, length * 0.82 / 6, facing)
            b.box((length, 0.03, 0.12), (middle, side * 1.19, 0.92), shade(back_color, 0.8))
        b.box((0.02, 2.1, 2.05), (back - 0.008, 0, 1.0), shade(box_color, 0.92))
        for y in (-0.02, 0.5, -0.5):
            b.rod((back - 0.03, y, 1.05), (back - 0.03, y, 3.0), 0.018 if y != -0.02 else 0.012, "dark grey", sides=5)
        b.box((0.35, 1.6, 0.7), (deck - 0.05, 0, 2.35), "light grey", bevel=0.05)
    for side in (-1, 1):
        b.box((0.05, 0.34, 0.12), (back - 0.02, side * 0.85, 0.62), "red")
    b.panel(number_plate(plate), (back - 0.05, 0, 0.66), 0.5, 0.12, "-x", back="black")
    b.box((0.08, 2.2, 0.12), (back + 0.02, 0, 0.50), "dark grey")
    rear = back + length * 0.28
    road_wheels(b, (front + 0.05, rear), 0.43, 1.11, 0.32, 18)
    for side in (-1, 1):
        b.box((1.05, 0.36, 0.04), (rear, side * 0.95, 0.90), "black")
    names = ("A white box truck", "An orange tipper with gravel", "A dark blue removal truck")
    built = b.build(
        names[variant], {"kind": ("box", "tipper", "removal")[variant]}, mass=(5200.0, 7800.0, 6100.0)[variant]
    )
    return dataclasses.replace(built, volume=float(np.prod(built.mesh.extent)) * 0.7)
