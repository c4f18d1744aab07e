"""Bicycles."""

import dataclasses

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import Physics, recipe
from .wheels import two_legged_stand

_BICYCLE = Physics(
    ("aluminium", "rubber", "steel"),
    2700.0,
    (9.0, 25.0),
    0.7,
    True,
    "city bicycles weigh 12-18 kg and can be lifted; rubber tyres hold at about 0.7",
)


def spoked_wheel(
    b: MeshBuilder, at: tuple[float, float, float], radius: float, tyre: float, rim: Color, spokes: int = 10
) -> None:
    """A thin wheel with its axle along y."""
    b.ring(radius - tyre, tyre, at, "rubber", (90, 0, 0), segments=20, sides=5)
    b.ring(radius - 2.2 * tyre, tyre * 0.55, at, rim, (90, 0, 0), segments=20, sides=3)
    b.cylinder(0.022, 0.08, (at[0], at[1] + 0.04, at[2]), "dark grey", (90, 0, 0), segments=8)
    for k in range(spokes):
        a = 2 * np.pi * k / spokes
        end = (at[0] + (radius - 2.2 * tyre) * np.cos(a), at[1], at[2] + (radius - 2.2 * tyre) * np.sin(a))
        b.rod((at[0], at[1] + (0.025 if k % 2 else -0.025), at[2]), end, 0.0025, "aluminium", sides=3)


@dataclasses.dataclass(frozen=True)
class Bike:
    color: Color
    kind: str  # "city", "road", "mountain", "step"
    radius: float = 0.345
    tyre: float = 0.018
    extras: tuple[str, ...] = ()


_SADDLE = np.array([-0.24, 0.0, 0.95])


_CRANK = np.array([-0.06, 0.0, 0.29])


_HEAD_TOP, _HEAD_LOW = np.array([0.33, 0.0, 0.90]), np.array([0.39, 0.0, 0.70])


_FRONT, _REAR = 0.56, -0.50


def build_bicycle(b: MeshBuilder, bike: Bike) -> dict[str, np.ndarray]:
    """The bicycle standing along x; returns where a rider touches it: saddle, grips and pedals (left, right)."""
    r, c = bike.radius, bike.color
    for x in (_FRONT, _REAR):
        spoked_wheel(b, (x, 0, r), r, bike.tyre, "aluminium" if bike.kind != "road" else "charcoal")
    seat_low = _SADDLE - [-0.055, 0, 0.22]
    if bike.kind == "step":
        b.tube([_HEAD_LOW + [0, 0, 0.06], (0.16, 0, 0.42), tuple(_CRANK + [0.04, 0, 0.02])], 0.022, c)
        b.tube([_HEAD_LOW + [0.01, 0, -0.02], (0.14, 0, 0.34), tuple(_CRANK)], 0.02, c)
    else:
        b.rod(_HEAD_TOP - [0, 0, 0.04], seat_low if bike.kind != "mountain" else seat_low - [0, 0, 0.06], 0.016, c)
        b.rod(_HEAD_LOW, _CRANK, 0.02, c)
    b.rod(_CRANK, seat_low, 0.017, c)
    b.rod(seat_low, _SADDLE - [0, 0, 0.02], 0.013, "aluminium")
    b.rod(_HEAD_TOP + [-0.005, 0, 0.03], _HEAD_LOW, 0.021, c)
    for s in (-1, 1):
        b.tube(
            [tuple(_HEAD_LOW + [0, s * 0.03, 0]), (_FRONT - 0.09, s * 0.045, r + 0.20), (_FRONT, s * 0.045, r)],
            0.011,
            c,
            sides=6,
        )
        b.rod(_CRANK + [0, s * 0.03, 0], (_REAR, s * 0.05, r), 0.009, c, sides=6)
        b.rod(seat_low + [0, s * 0.015, 0], (_REAR, s * 0.05, r), 0.008, c, sides=6)
    # Saddle, crank, chain.
    b.loft(
        [
            _section(x, w, t)
            for x, w, t in (
                (-0.13, 0.05, 0.03),
                (-0.09, 0.075, 0.05),
                (0.0, 0.05, 0.045),
                (0.10, 0.022, 0.035),
                (0.14, 0.015, 0.02),
            )
        ],
        "black",
        tuple(_SADDLE),
    )
    b.cylinder(0.085, 0.012, tuple(_CRANK + [0, -0.045, 0]), "dark grey", (90, 0, 0), segments=14)
    b.beam(tuple(_CRANK + [-0.02, -0.055, 0.085]), (_REAR, -0.055, r + 0.04), 0.012, 0.012, "charcoal")
    b.beam(tuple(_CRANK + [-0.02, -0.055, -0.085]), (_REAR, -0.055, r - 0.04), 0.012, 0.012, "charcoal")
    pedals = []
    for s, dx in ((1, 1.0), (-1, -1.0)):
        end = _CRANK + [0.13 * dx, s * 0.09, -0.10 * dx]
        b.beam(tuple(_CRANK + [0, s * 0.07, 0]), tuple(end - [0, s * 0.02, 0]), 0.018, 0.014, "aluminium")
        b.box((0.09, 0.09, 0.02), tuple(end + [0, s * 0.05, 0]), "black", centered=True)
        pedals.append(end + [0, s * 0.05, 0.0])
    grips = _handlebar(b, bike)
    _bike_extras(b, bike)
    return {"saddle": _SADDLE, "left": grips[0], "right": grips[1], "left_pedal": pedals[0], "right_pedal": pedals[1]}


def _section(x: float, half_width: float, thickness: float) -> np.ndarray:
    a = np.arange(8) * np.pi / 4
    return np.stack([np.full(8, x), half_width * np.cos(a), thickness * (np.sin(a) * 0.5 + 0.5)], 1)


def _handlebar(b: MeshBuilder, bike: Bike) -> list[np.ndarray]:
    top = _HEAD_TOP + [-0.01, 0, 0.06]
    b.rod(_HEAD_TOP, top + [0, 0, 0.06], 0.015, "aluminium")
    z = top[2] + 0.06
    if bike.kind == "road":
        b.rod((top[0] + 0.08, -0.21, z), (top[0] + 0.08, 0.21, z), 0.013, "black")
        b.rod((top[0], 0, z), (top[0] + 0.08, 0, z), 0.014, "black")
        for s in (-1, 1):
            b.tube(
                [
                    (top[0] + 0.08, s * 0.21, z),
                    (top[0] + 0.17, s * 0.215, z - 0.01),
                    (top[0] + 0.19, s * 0.22, z - 0.08),
                    (top[0] + 0.06, s * 0.22, z - 0.14),
                ],
                0.014,
                "black",
                sides=6,
            )
        return [np.array([top[0] + 0.14, s * 0.21, z]) for s in (1, -1)]
    back, wide = (0.17, 0.29) if bike.kind in ("city", "step") else (0.03, 0.34)
    for s in (-1, 1):
        b.tube(
            [
                (top[0], 0, z),
                (top[0] + 0.05, s * 0.10, z + 0.02),
                (top[0] - back * 0.3, s * wide * 0.9, z + 0.04),
                (top[0] - back, s * wide, z + 0.02),
            ],
            0.011,
            "aluminium",
            sides=6,
        )
        b.rod((top[0] - back * 0.5, s * wide * 0.93, z + 0.035), (top[0] - back, s * wide, z + 0.02), 0.016, "black")
    return [np.array([top[0] - back, s * wide, z + 0.02]) for s in (1, -1)]


def _bike_extras(b: MeshBuilder, bike: Bike) -> None:
    r = bike.radius
    if "fenders" in bike.extras:
        for x, low, high in ((_FRONT, 50, 190), (_REAR, 20, 175)):
            angles = np.radians(np.linspace(low, high, 9))
            grid = np.array(
                [
                    [(x + (r + 0.025) * np.cos(a), y, r + (r + 0.025) * np.sin(a)) for y in (-0.028, 0.028)]
                    for a in angles[::-1]
                ]
            )
            b.sheet(grid[:, ::-1], shade(bike.color, 0.8), both_sides=True)
    if "rack" in bike.extras:
        for s in (-1, 1):
            b.rod((_REAR, s * 0.06, r), (_REAR - 0.05, s * 0.06, r + 0.40), 0.006, "black", sides=4)
        b.box((0.36, 0.13, 0.02), (_REAR + 0.02, 0, r + 0.40), "black")
    if "basket" in bike.extras:
        b.box((0.26, 0.36, 0.24), (0.56, 0, 0.80), "dark wood", taper=(1.15, 1.12))
        b.box((0.25, 0.35, 0.02), (0.56, 0, 1.03), "black", taper=(1.0, 1.0))
    if "lamp" in bike.extras:
        b.cylinder(0.035, 0.06, (0.44, 0, 0.90), "lamp", (0, 90, 0), segments=10)
        b.box((0.03, 0.05, 0.05), (_REAR - 0.175, 0, r + 0.40), "red", centered=True)


BIKES = (
    Bike("dark green", "city", extras=("fenders", "rack", "lamp")),
    Bike("red", "road", 0.34, 0.013),
    Bike("signal blue", "mountain", 0.34, 0.030),
    Bike("cream", "step", 0.345, 0.02, ("fenders", "basket", "rack", "lamp")),
)


@recipe("bicycle", 4, _BICYCLE, hulls=4, name="bicycles.bicycle")
def bicycle(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.45, metallic=0.2)
    build_bicycle(b, BIKES[variant])
    two_legged_stand(b, _CRANK + [-0.08, 0.03, 0.0], (-0.12, 0.16), 0.010)
    names = (
        "A dark green city bicycle with a rack",
        "A red racing bicycle",
        "A blue mountain bicycle",
        "A cream step-through bicycle with a basket",
    )
    built = b.build(names[variant], {"kind": BIKES[variant].kind}, mass=(16.5, 9.5, 13.5, 17.5)[variant])
    return dataclasses.replace(built, volume=0.02)
