"""Motorcycles in few triangles, so that a rider fits on them."""

import dataclasses

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import recipe
from ..shared.sizes import fitted
from .motorcycles import oval_yz
from .wheels import two_legged_stand


@dataclasses.dataclass(frozen=True)
class Motorbike:
    """style: "trail", "sport", "cruiser"; seat and bars: heights, m; wheels: (front, rear) radius."""

    style: str
    color: Color
    accent: Color
    seat: float = 0.80
    bars: float = 1.05
    wheels: tuple[float, float] = (0.32, 0.31)
    base: float = 1.40


def bike_wheel(b: MeshBuilder, x: float, radius: float, tyre: float, knobs: bool) -> None:
    b.ring(radius - tyre, tyre, (x, 0, radius), "rubber", (90, 0, 0), segments=16, sides=6)
    b.ring(radius - 2 * tyre, tyre * 0.3, (x, 0, radius), "aluminium", (90, 0, 0), segments=14, sides=4)
    b.cylinder(0.06, 0.10, (x, 0.05, radius), "dark grey", (90, 0, 0), segments=8)
    for k in range(6):
        a = k * np.pi / 3 + 0.2
        end = (x + (radius - 2 * tyre) * np.cos(a), 0, radius + (radius - 2 * tyre) * np.sin(a))
        b.rod((x, 0, radius), end, 0.012 if not knobs else 0.006, "aluminium", sides=3)
    for k in range(14 if knobs else 0):
        a = k * np.pi / 7
        at = (x + radius * np.cos(a), 0, radius + radius * np.sin(a))
        b.box((0.03, tyre * 1.7, 0.025), at, "rubber", (0, 90 - float(np.degrees(a)), 0), centered=True)


def _tail_rise(bike: Motorbike) -> float:
    """How far the tail stands above the seat, m."""
    return {"trail": 0.10, "sport": 0.06, "cruiser": -0.02}[bike.style]


def _engine_and_seat(b: MeshBuilder, bike: Motorbike) -> None:
    trail, s = bike.style == "trail", bike.seat
    # Engine, cylinder, exhaust.
    b.box((0.38, 0.24, 0.24), (0.05, 0, 0.27), "dark grey", bevel=0.05)
    b.box((0.17, 0.22, 0.20), (0.13, 0, 0.48), "aluminium", bevel=0.02)
    low = 0.42 if trail else 0.26
    b.tube(
        [
            (0.22, -0.08, 0.52),
            (0.30, -0.14, low - 0.04),
            (-0.05, -0.17, low),
            (-0.78, -0.17, low + 0.22 * trail + 0.10),
        ],
        [0.022, 0.024, 0.028, 0.055],
        "galvanised",
        sides=7,
    )
    # Tank, seat, tail, fenders.
    rows = ((0.42, 0.05, s + 0.04, s + 0.14), (0.30, 0.12, s, s + 0.19), (0.05, 0.14, s - 0.04, s + 0.16))
    tank = [*rows, (-0.12, 0.08, s - 0.04, s + 0.05)]
    b.loft([oval_yz(*row) for row in reversed(tank)], bike.color, crease_deg=60)
    up = _tail_rise(bike)
    seat = (
        (-0.06, 0.10, s - 0.06, s + 0.03),
        (-0.38, 0.13, s - 0.06, s + 0.02),
        (-0.74, 0.08, s + up - 0.05, s + up + 0.03),
    )
    b.loft([oval_yz(*row) for row in reversed(seat)], "black", crease_deg=60)
    tail = ((-0.45, 0.09, s - 0.12, s - 0.04), (-0.95, 0.07, s + up - 0.03, s + up + 0.02))
    b.loft([oval_yz(*row) for row in reversed(tail)], bike.color, crease_deg=60)


def motorbike(b: MeshBuilder, bike: Motorbike) -> dict[str, np.ndarray]:
    """The machine along x; returns where a rider touches it: hip, and grip and peg of the left side."""
    trail, sport, s = bike.style == "trail", bike.style == "sport", bike.seat
    front, rear = bike.base / 2, -bike.base / 2
    rf, rr = bike.wheels
    tyre = 0.05 if trail else 0.07
    bike_wheel(b, front, rf, tyre, trail)
    bike_wheel(b, rear, rr, tyre * 1.1, trail)
    head = np.array([front - (0.26 if sport else 0.32), 0.0, bike.bars - 0.10])
    for side in (-1, 1):
        y = side * 0.09
        b.rod((head[0], y, head[2]), (front, y, rf), 0.024, "gold" if trail else "aluminium", sides=6)
        b.rod((-0.12, y, 0.42), (rear, side * 0.08, rr), 0.025, "dark grey", sides=5)
        b.rod((-0.40, y, s - 0.08), (rear + 0.05, side * 0.08, rr + 0.03), 0.02, "aluminium", sides=5)
        b.box((0.09, 0.11, 0.025), (-0.10, side * 0.20, 0.34), "black")
    b.tube([tuple(head), (0.10, 0, s - 0.02), (-0.45, 0, s - 0.05)], 0.03, bike.accent, sides=6)
    b.tube([tuple(head - [0, 0, 0.1]), (0.24, 0, 0.36), (-0.15, 0, 0.32)], 0.028, bike.accent, sides=6)
    _engine_and_seat(b, bike)
    up = _tail_rise(bike)
    if trail:
        b.convex([(front + dx, y, rf + 0.38 + dz) for dx, dz in _FENDER for y in (-0.07, 0.07)], bike.color)
        b.box((0.02, 0.20, 0.24), (head[0] + 0.10, 0, bike.bars - 0.12), bike.accent, (0, -18, 0), bevel=0.008)
        for side in (-1, 1):  # radiator shrouds
            points = [(0.44, 0.10, s - 0.24), (0.52, 0.11, s + 0.04), (0.22, 0.13, s + 0.10), (0.16, 0.13, s - 0.10)]
            b.convex([(x, side * (y + d), z) for x, y, z in points for d in (0.0, 0.02)], shade(bike.color, 0.85))
    else:
        arch = [(front + (rf + 0.02) * np.cos(a), rf + (rf + 0.02) * np.sin(a)) for a in np.radians((35, 70, 105, 140))]
        b.tube([(x, 0, z) for x, z in arch], 0.06, bike.color, sides=6)
        b.ball((0.09, 0.10, 0.10), (front - 0.20, 0, bike.bars - 0.12), bike.color, segments=10, rings=6)
        b.ball((0.03, 0.08, 0.08), (front - 0.125, 0, bike.bars - 0.12), "lamp", segments=10, rings=5)
        b.box((0.02, 0.14, 0.06), (-0.96, 0, s + up - 0.05), "red")
    if sport:  # the fairing down both sides, and its screen
        for side in (-1, 1):
            points = [
                (0.56, 0.09, 0.84),
                (0.36, 0.17, 0.88),
                (0.06, 0.17, 0.62),
                (0.02, 0.15, 0.30),
                (0.40, 0.13, 0.36),
            ]
            b.convex([(x, side * y * d, z) for x, y, z in points for d in (0.75, 1.0)], bike.color)
        screen = [(0.56, 0.08, 0.90), (0.56, -0.08, 0.90), (0.36, -0.13, 1.10), (0.36, 0.13, 1.10), (0.34, 0.12, 0.95)]
        b.convex([*screen, (0.34, -0.12, 0.95)], "dark glass")
    grip = np.array([head[0] - (0.16 if not sport else 0.08), 0.34 if not sport else 0.28, bike.bars])
    path = [(head[0], 0.08, bike.bars - 0.06), (head[0] - 0.02, 0.20, bike.bars + 0.01), tuple(grip)]
    for side in (-1, 1):
        b.tube([(x, side * y, z) for x, y, z in path], [0.014, 0.014, 0.02], "black", sides=6)
        b.rod(
            (head[0], side * 0.16, bike.bars), (head[0] + 0.02, side * 0.27, bike.bars + 0.13), 0.006, "black", sides=3
        )
        b.ball((0.015, 0.05, 0.035), (head[0] + 0.02, side * 0.28, bike.bars + 0.15), "charcoal", segments=6, rings=4)
    return {"hip": np.array([-0.30, 0, s + 0.10]), "grip": grip, "peg": np.array([-0.14, 0.19, 0.42])}


_FENDER = ((-0.30, 0.06), (0.10, 0.10), (0.36, -0.02), (0.34, -0.04), (0.08, 0.07), (-0.28, 0.03))


@recipe("dirt bike", 3, hulls=5, name="motorbikes.dirt_bike")
def dirt_bike(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.5)
    color, accent = (("safety orange", "black"), ("#1f5fbf", "white"), ("#8fc31f", "black"))[variant]
    base = (1.46, 1.42, 1.38)[variant]
    motorbike(b, Motorbike("trail", color, accent, 0.92, 1.14, (0.35, 0.33), base))
    two_legged_stand(b, (-0.05, 0.12, 0.34), (0.0, 0.30), 0.012)
    names = ("An orange motocross bike", "A blue enduro bike", "A small green dirt bike")
    size = ((2.12, 0.80, 1.24), (2.20, 0.84, 1.28), (1.92, 0.74, 1.12))[variant]
    return fitted(b.build(names[variant], {"color": color}), size)
