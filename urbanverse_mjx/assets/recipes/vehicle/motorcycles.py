"""Motorcycles and motor scooters."""

import dataclasses

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import Physics, recipe
from .wheels import number_plate, two_legged_stand

_MOTORCYCLE = Physics(
    ("steel", "aluminium", "rubber"),
    900.0,
    (95.0, 260.0),
    0.7,
    False,
    "scooters weigh 100-150 kg, motorcycles 150-260 kg: on its stand a robot cannot shift one",
)


def _thick_wheel(b: MeshBuilder, x: float, radius: float, width: float) -> None:
    b.ring(radius * 0.78, radius * 0.22, (x, 0, radius), "rubber", (90, 0, 0), segments=20, sides=8)
    b.cylinder(radius * 0.60, width * 0.5, (x, width * 0.25, radius), "aluminium", (90, 0, 0), segments=14)
    b.cylinder(radius * 0.45, width * 0.62, (x, width * 0.31, radius), "dark grey", (90, 0, 0), segments=12)


@recipe("motorcycle", 4, _MOTORCYCLE, hulls=5, name="motorcycles.motorcycle")
def motorcycle(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.4, metallic=0.2)
    if variant in (0, 2):
        _moped(b, ("light blue", "red")[variant // 2], box=variant == 2)
    else:
        _big_motorcycle(b, ("red", "black")[variant // 2], cruiser=variant == 3)
    names = (
        "A light blue motor scooter",
        "A red motorcycle",
        "A red delivery scooter with a box",
        "A black cruiser motorcycle",
    )
    built = b.build(
        names[variant],
        {"kind": ("scooter", "roadster", "scooter", "cruiser")[variant]},
        mass=(112.0, 195.0, 128.0, 245.0)[variant],
    )
    return dataclasses.replace(built, volume=(0.25, 0.32, 0.33, 0.38)[variant])


def _moped(b: MeshBuilder, color: Color, box: bool) -> None:
    front, rear, r = 0.66, -0.60, 0.235
    for x in (front, rear):
        _thick_wheel(b, x, r, 0.12)
    # Floorboard, rear body under the seat, leg shield, front fender.
    b.box((0.46, 0.30, 0.08), (0.12, 0, 0.27), shade(color, 0.8), bevel=0.03)
    ring = [
        (_s, w, z0, z1)
        for _s, w, z0, z1 in (
            (-0.93, 0.05, 0.52, 0.66),
            (-0.80, 0.15, 0.40, 0.72),
            (-0.45, 0.18, 0.30, 0.72),
            (-0.12, 0.15, 0.28, 0.66),
            (-0.06, 0.12, 0.28, 0.55),
        )
    ]
    b.loft([oval_yz(x, w, z0, z1) for x, w, z0, z1 in ring], color, crease_deg=60)
    b.loft(
        [
            oval_yz(x, w, z0, z1)
            for x, w, z0, z1 in (
                (-0.88, 0.08, 0.70, 0.80),
                (-0.55, 0.15, 0.69, 0.80),
                (-0.16, 0.12, 0.64, 0.74),
                (-0.08, 0.07, 0.64, 0.70),
            )
        ],
        "black",
        crease_deg=60,
    )
    shield = np.array(
        [
            [(0.36 + 0.08 * abs(y) * 3, y * (1.0 if z < 0.8 else 0.75), z) for y in (0.22, 0.12, 0.0, -0.12, -0.22)]
            for z in (0.30, 0.50, 0.70, 0.88)
        ]
    )
    shield[..., 0] += (shield[..., 2] - 0.3) * 0.15 - 0.16 * (shield[..., 1] / 0.22) ** 2
    b.sheet(shield[:, ::-1] + [0.05, 0, 0], color, both_sides=True)
    b.convex(
        [
            (0.46, -0.10, 0.86),
            (0.46, 0.10, 0.86),
            (0.60, 0, 0.93),
            (0.40, -0.13, 1.02),
            (0.40, 0.13, 1.02),
            (0.55, 0, 1.02),
            (0.36, -0.1, 0.86),
            (0.36, 0.1, 0.86),
        ],
        color,
    )
    b.ball((0.03, 0.07, 0.06), (0.555, 0, 0.965), "lamp", segments=10, rings=6)
    angles = np.radians(np.linspace(25, 165, 8))
    b.loft(
        [oval_yz_at(front + (r + 0.03) * np.cos(a), r + (r + 0.03) * np.sin(a), 0.085, 0.03, a) for a in angles],
        color,
        crease_deg=60,
    )
    b.rod((0.44, 0, 0.90), (front, 0, r), 0.035, "dark grey")
    b.tube([(0.34, 0.33, 1.04), (0.42, 0.14, 1.03), (0.42, -0.14, 1.03), (0.34, -0.33, 1.04)], 0.016, "black", sides=6)
    for s in (-1, 1):
        b.rod((0.42, s * 0.18, 1.03), (0.44, s * 0.26, 1.20), 0.008, "black", sides=4)
        b.ball((0.015, 0.06, 0.045), (0.44, s * 0.28, 1.23), "charcoal", segments=8, rings=5)
    b.box((0.02, 0.14, 0.06), (-0.935, 0, 0.56), "red")
    b.panel(number_plate("M 204", size=(32, 16)), (-0.95, 0, 0.46), 0.18, 0.10, "-x", back="black")
    b.cylinder(0.045, 0.34, (-0.86, -0.17, 0.27), "dark grey", (0, 90, 0), segments=10)
    two_legged_stand(b, (-0.05, 0.10, 0.28), (-0.02, 0.24), 0.014)
    if box:
        b.box((0.44, 0.46, 0.46), (-0.78, 0, 0.82), "white", bevel=0.03)
        b.box((0.446, 0.466, 0.10), (-0.78, 0, 0.98), "red", bevel=0.0)


def oval_yz(x: float, half_width: float, z0: float, z1: float) -> np.ndarray:
    a = np.arange(12) * np.pi / 6
    c, s = np.cos(a), np.sin(a)
    return np.stack(
        [
            np.full(12, x),
            half_width * np.sign(c) * np.abs(c) ** 0.7,
            (z0 + z1) / 2 + (z1 - z0) / 2 * np.sign(s) * np.abs(s) ** 0.7,
        ],
        1,
    )


def oval_yz_at(x: float, z: float, half_width: float, thickness: float, angle: float) -> np.ndarray:
    a = -np.arange(8) * np.pi / 4
    out = np.array([np.cos(angle), 0, np.sin(angle)])
    return np.array([x, 0, z]) + np.outer(np.sin(a) * thickness, out) + np.outer(np.cos(a) * half_width, [0, 1, 0])


def _big_motorcycle(b: MeshBuilder, color: Color, cruiser: bool) -> None:
    front, rear, r = (0.86, -0.76, 0.32) if cruiser else (0.72, -0.70, 0.31)
    for x in (front, rear):
        _thick_wheel(b, x, r, 0.15)
    seat = 0.68 if cruiser else 0.80
    tank = (
        (0.42, 0.06, seat + 0.02, seat + 0.16),
        (0.32, 0.14, seat - 0.02, seat + 0.22),
        (0.05, 0.16, seat - 0.04, seat + 0.20),
        (-0.12, 0.09, seat - 0.03, seat + 0.06),
    )
    b.loft([oval_yz(x, w, z0, z1) for x, w, z0, z1 in reversed(tank)], color, crease_deg=60)
    rear_seat = (
        (-0.10, 0.12, seat - 0.05, seat + 0.03),
        (-0.35, 0.15, seat - 0.06, seat + 0.02),
        (-0.62, 0.12, seat, seat + 0.10),
        (-0.80, 0.07, seat + 0.03, seat + 0.10),
    )
    b.loft([oval_yz(x, w, z0, z1) for x, w, z0, z1 in reversed(rear_seat)], "black", crease_deg=60)
    tail = (
        (-0.30, 0.10, seat - 0.14, seat - 0.03),
        (-0.70, 0.10, seat - 0.04, seat + 0.04),
        (-0.92, 0.05, seat + 0.0, seat + 0.07),
    )
    b.loft([oval_yz(x, w, z0, z1) for x, w, z0, z1 in reversed(tail)], color, crease_deg=60)
    # Engine with cooling fins, exhaust, frame.
    b.box((0.42, 0.26, 0.24), (0.06, 0, 0.26), "dark grey", bevel=0.04)
    for k in range(5):
        b.box((0.22, 0.30, 0.022), (0.12, 0, 0.50 + 0.035 * k), "aluminium")
    b.box((0.18, 0.24, 0.18), (0.12, 0, 0.49), "charcoal")
    for s in (-1, 1):
        b.tube(
            [
                (0.24, s * 0.10, 0.55),
                (0.36, s * 0.15, 0.40),
                (0.10, s * 0.18, 0.22),
                (-0.40, s * 0.19, 0.26),
                (-0.98, s * 0.20, 0.36 if not cruiser else 0.28),
            ],
            [0.02, 0.025, 0.025, 0.045, 0.05],
            "aluminium",
            sides=8,
        )
        b.rod((-0.05, s * 0.10, 0.36), (rear, s * 0.11, r), 0.028, "dark grey", sides=6)
        b.rod((-0.50, s * 0.10, seat - 0.05), (rear, s * 0.12, r + 0.02), 0.024, "aluminium", sides=6)
        b.rod((0.46, s * 0.10, seat + 0.14), (front, s * 0.11, r), 0.028, "aluminium", sides=6)
        b.ball((0.02, 0.05, 0.035), (0.36, s * 0.33, seat + 0.42), "charcoal", segments=8, rings=5)
        b.rod((0.36, s * 0.24, seat + 0.27), (0.36, s * 0.31, seat + 0.40), 0.007, "black", sides=4)
        b.box((0.08, 0.10, 0.025), (-0.02, s * 0.22, 0.30), "black")
    wide, back = (0.40, 0.10) if cruiser else (0.34, 0.22)
    b.tube(
        [
            (back, wide, seat + 0.26),
            (0.36, 0.20, seat + 0.26),
            (0.42, 0, seat + 0.22),
            (0.36, -0.20, seat + 0.26),
            (back, -wide, seat + 0.26),
        ],
        0.017,
        "black",
        sides=6,
    )
    b.ball((0.08, 0.095, 0.095), (0.54, 0, seat + 0.10), "charcoal", segments=12, rings=8)
    b.ball((0.03, 0.08, 0.08), (0.605, 0, seat + 0.10), "lamp", segments=12, rings=6)
    angles = np.radians(np.linspace(40, 150, 7))
    b.loft(
        [oval_yz_at(front + (r + 0.03) * np.cos(a), r + (r + 0.03) * np.sin(a), 0.075, 0.015, a) for a in angles],
        color,
        crease_deg=60,
    )
    b.box((0.02, 0.13, 0.06), (-0.93, 0, seat - 0.02), "red")
    b.panel(number_plate("MC 77", size=(32, 20)), (-0.95, 0, seat - 0.14), 0.20, 0.13, "-x", back="black")
    two_legged_stand(b, (-0.02, 0.12, 0.28), (0.02, 0.30), 0.016)
