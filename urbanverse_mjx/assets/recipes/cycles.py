"""Two-wheelers and those who ride them: bicycle, motorcycle, kick scooter, cyclist."""

import dataclasses

import numpy as np

from ..mesh_builder import BuiltAsset, MeshBuilder
from ..palette import Color, shade
from ..recipe import Physics, recipe
from .figure import Figure, Look, Pose
from .people import cap
from .wheels import number_plate

_BICYCLE = Physics(
    ("aluminium", "rubber", "steel"), 2700.0, (9.0, 25.0), 0.7, True,
    "city bicycles weigh 12-18 kg and can be lifted; rubber tyres hold at about 0.7",
)  # fmt: skip
_MOTORCYCLE = Physics(
    ("steel", "aluminium", "rubber"), 900.0, (95.0, 260.0), 0.7, False,
    "scooters weigh 100-150 kg, motorcycles 150-260 kg: on its stand a robot cannot shift one",
)  # fmt: skip
_SCOOTER = Physics(
    ("aluminium", "rubber", "plastic"), 2000.0, (10.0, 30.0), 0.6, True,
    "shared electric kick scooters weigh 12-30 kg and are moved with one hand; grip tape and tyres rub at about 0.6",
)  # fmt: skip
_CYCLIST = Physics(
    ("flesh", "aluminium", "rubber"), 500.0, (60.0, 130.0), 0.6, False, "rider and bicycle together 75-110 kg; people are not shoved about"
)


def spoked_wheel(b: MeshBuilder, at: tuple[float, float, float], radius: float, tyre: float, rim: Color, spokes: int = 10) -> None:
    """A thin wheel with its axle along y."""
    b.ring(radius - tyre, tyre, at, "rubber", (90, 0, 0), segments=20, sides=5)
    b.ring(radius - 2.2 * tyre, tyre * 0.55, at, rim, (90, 0, 0), segments=20, sides=3)
    b.cylinder(0.022, 0.08, (at[0], at[1] + 0.04, at[2]), "dark grey", (90, 0, 0), segments=8)
    for k in range(spokes):
        a = 2 * np.pi * k / spokes
        end = (at[0] + (radius - 2.2 * tyre) * np.cos(a), at[1], at[2] + (radius - 2.2 * tyre) * np.sin(a))
        b.rod((at[0], at[1] + (0.025 if k % 2 else -0.025), at[2]), end, 0.0025, "aluminium", sides=3)


@dataclasses.dataclass(frozen=True)
class _Bike:
    color: Color
    kind: str  # "city", "road", "mountain", "step"
    radius: float = 0.345
    tyre: float = 0.018
    extras: tuple[str, ...] = ()


_SADDLE = np.array([-0.24, 0.0, 0.95])
_CRANK = np.array([-0.06, 0.0, 0.29])
_HEAD_TOP, _HEAD_LOW = np.array([0.33, 0.0, 0.90]), np.array([0.39, 0.0, 0.70])
_FRONT, _REAR = 0.56, -0.50


def build_bicycle(b: MeshBuilder, bike: _Bike) -> dict[str, np.ndarray]:
    """The bicycle standing along x; returns where a rider touches it: saddle, left and right grip, left and right pedal."""
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
        b.tube([tuple(_HEAD_LOW + [0, s * 0.03, 0]), (_FRONT - 0.09, s * 0.045, r + 0.20), (_FRONT, s * 0.045, r)], 0.011, c, sides=6)
        b.rod(_CRANK + [0, s * 0.03, 0], (_REAR, s * 0.05, r), 0.009, c, sides=6)
        b.rod(seat_low + [0, s * 0.015, 0], (_REAR, s * 0.05, r), 0.008, c, sides=6)
    # Saddle, crank, chain.
    b.loft([_section(x, w, t) for x, w, t in ((-0.13, 0.05, 0.03), (-0.09, 0.075, 0.05), (0.0, 0.05, 0.045), (0.10, 0.022, 0.035), (0.14, 0.015, 0.02))], "black", tuple(_SADDLE))
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


def _handlebar(b: MeshBuilder, bike: _Bike) -> list[np.ndarray]:
    top = _HEAD_TOP + [-0.01, 0, 0.06]
    b.rod(_HEAD_TOP, top + [0, 0, 0.06], 0.015, "aluminium")
    z = top[2] + 0.06
    if bike.kind == "road":
        b.rod((top[0] + 0.08, -0.21, z), (top[0] + 0.08, 0.21, z), 0.013, "black")
        b.rod((top[0], 0, z), (top[0] + 0.08, 0, z), 0.014, "black")
        for s in (-1, 1):
            b.tube([(top[0] + 0.08, s * 0.21, z), (top[0] + 0.17, s * 0.215, z - 0.01), (top[0] + 0.19, s * 0.22, z - 0.08), (top[0] + 0.06, s * 0.22, z - 0.14)], 0.014, "black", sides=6)
        return [np.array([top[0] + 0.14, s * 0.21, z]) for s in (1, -1)]
    back, wide = (0.17, 0.29) if bike.kind in ("city", "step") else (0.03, 0.34)
    for s in (-1, 1):
        b.tube([(top[0], 0, z), (top[0] + 0.05, s * 0.10, z + 0.02), (top[0] - back * 0.3, s * wide * 0.9, z + 0.04), (top[0] - back, s * wide, z + 0.02)], 0.011, "aluminium", sides=6)
        b.rod((top[0] - back * 0.5, s * wide * 0.93, z + 0.035), (top[0] - back, s * wide, z + 0.02), 0.016, "black")
    return [np.array([top[0] - back, s * wide, z + 0.02]) for s in (1, -1)]


def _bike_extras(b: MeshBuilder, bike: _Bike) -> None:
    r = bike.radius
    if "fenders" in bike.extras:
        for x, low, high in ((_FRONT, 50, 190), (_REAR, 20, 175)):
            angles = np.radians(np.linspace(low, high, 9))
            grid = np.array([[(x + (r + 0.025) * np.cos(a), y, r + (r + 0.025) * np.sin(a)) for y in (-0.028, 0.028)] for a in angles[::-1]])
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
    if "stand" in bike.extras:
        b.rod(tuple(_CRANK + [-0.08, 0.03, 0.0]), (-0.12, 0.16, 0.0), 0.010, "dark grey", sides=5)


_BIKES = (
    _Bike("dark green", "city", extras=("fenders", "rack", "lamp", "stand")),
    _Bike("red", "road", 0.34, 0.013),
    _Bike("signal blue", "mountain", 0.34, 0.030),
    _Bike("cream", "step", 0.345, 0.02, ("fenders", "basket", "rack", "lamp", "stand")),
)


@recipe("bicycle", 4, _BICYCLE, hulls=5)
def bicycle(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.45, metallic=0.2)
    build_bicycle(b, _BIKES[variant])
    names = ("A dark green city bicycle with a rack", "A red racing bicycle", "A blue mountain bicycle", "A cream step-through bicycle with a basket")
    built = b.build(names[variant], {"kind": _BIKES[variant].kind}, mass=(16.5, 9.5, 13.5, 17.5)[variant])
    return dataclasses.replace(built, volume=0.02)


@recipe("cyclist", 3, _CYCLIST, hulls=4)
def cyclist(variant: int, rng: np.random.Generator) -> BuiltAsset:
    bike = (_BIKES[0], _BIKES[1], dataclasses.replace(_BIKES[3], color="light blue"))[variant]
    bike = dataclasses.replace(bike, extras=tuple(e for e in bike.extras if e != "stand"))
    look = (
        Look(1.78, 1.0, "skin light", "short", "#4a3524", "jacket", "#8a2f2f", "trousers", "#2d3a55", "white"),
        Look(1.76, 0.92, "skin medium", "short", "#1e1612", "shirt", "signal yellow", "shorts", "black", "white", "short"),
        Look(1.66, 0.95, "skin dark", "long", "#17100c", "shirt", "#d8e0e4", "trousers", "#5a6b4a", "#8a5a30", "long"),
    )[variant]
    b = MeshBuilder(roughness=0.7)
    touch = build_bicycle(b, bike)
    lean = (24.0, 44.0, 18.0)[variant]
    hip = tuple(touch["saddle"] + [0.02, 0, 0.10])
    pose = Pose((78, 42), (84, 42), (40, 40), (14, 14), lean, (6, 6))
    figure = Figure(b, look, pose, hip)
    _reach(figure, touch)
    figure.build()
    if variant < 2:
        cap(figure, ("white", "black")[variant], "helmet")
    names = ("A commuter riding a city bicycle", "A racing cyclist in yellow", "A woman riding a blue step-through bicycle")
    built = b.build(names[variant], {"kind": bike.kind}, mass=(95.0, 82.0, 78.0)[variant])
    return dataclasses.replace(built, volume=0.10)


def _reach(figure: Figure, touch: dict[str, np.ndarray]) -> None:
    """Moves feet onto the pedals and hands onto the grips, bending knees forwards and elbows downwards."""
    from .figure import ANKLE_HEIGHT, FOREARM, SHANK, THIGH, UPPER_ARM

    h = figure.look.height
    for k, side in ((0, "left"), (1, "right")):
        hip = figure.hip + [0, (1 if k == 0 else -1) * 0.052 * h, 0]
        ankle = touch[f"{side}_pedal"] + [-0.07, 0, ANKLE_HEIGHT * h + 0.015]
        figure.knees[k], figure.ankles[k] = _two_bones(hip, ankle, THIGH * h, SHANK * h, np.array([1.0, 0, 0.35]))
        wrist = touch[side] + [-0.05, 0, 0.03]
        elbow, wrist = _two_bones(figure.shoulders[k], wrist, UPPER_ARM * h, FOREARM * h, np.array([-0.4, 0.3 if k == 0 else -0.3, -1.0]))
        figure.elbows[k], figure.wrists[k] = elbow, wrist


def _two_bones(start: np.ndarray, end: np.ndarray, first: float, second: float, bend: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Joint and end of two bones that reach from start towards end, bent towards a direction."""
    axis = end - start
    distance = min(float(np.linalg.norm(axis)), 0.995 * (first + second))
    axis = axis / np.linalg.norm(axis)
    along = (first**2 - second**2 + distance**2) / (2 * distance)
    out = bend - axis * (bend @ axis)
    out /= np.linalg.norm(out)
    return start + axis * along + out * np.sqrt(max(first**2 - along**2, 0.0)), start + axis * distance


# Motorcycles ------------------------------------------------------------------------------------------------------------


def _thick_wheel(b: MeshBuilder, x: float, radius: float, width: float) -> None:
    b.ring(radius * 0.78, radius * 0.22, (x, 0, radius), "rubber", (90, 0, 0), segments=20, sides=8)
    b.cylinder(radius * 0.60, width * 0.5, (x, width * 0.25, radius), "aluminium", (90, 0, 0), segments=14)
    b.cylinder(radius * 0.45, width * 0.62, (x, width * 0.31, radius), "dark grey", (90, 0, 0), segments=12)


@recipe("motorcycle", 4, _MOTORCYCLE, hulls=5)
def motorcycle(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.4, metallic=0.2)
    if variant in (0, 2):
        _moped(b, ("light blue", "red")[variant // 2], box=variant == 2)
    else:
        _big_motorcycle(b, ("red", "black")[variant // 2], cruiser=variant == 3)
    names = ("A light blue motor scooter", "A red motorcycle", "A red delivery scooter with a box", "A black cruiser motorcycle")
    built = b.build(names[variant], {"kind": ("scooter", "roadster", "scooter", "cruiser")[variant]}, mass=(112.0, 195.0, 128.0, 245.0)[variant])
    return dataclasses.replace(built, volume=(0.25, 0.32, 0.33, 0.38)[variant])


def _moped(b: MeshBuilder, color: Color, box: bool) -> None:
    front, rear, r = 0.66, -0.60, 0.235
    for x in (front, rear):
        _thick_wheel(b, x, r, 0.12)
    # Floorboard, rear body under the seat, leg shield, front fender.
    b.box((0.46, 0.30, 0.08), (0.12, 0, 0.27), shade(color, 0.8), bevel=0.03)
    ring = [(_s, w, z0, z1) for _s, w, z0, z1 in ((-0.93, 0.05, 0.52, 0.66), (-0.80, 0.15, 0.40, 0.72), (-0.45, 0.18, 0.30, 0.72), (-0.12, 0.15, 0.28, 0.66), (-0.06, 0.12, 0.28, 0.55))]
    b.loft([_oval_yz(x, w, z0, z1) for x, w, z0, z1 in ring], color, crease_deg=60)
    b.loft([_oval_yz(x, w, z0, z1) for x, w, z0, z1 in ((-0.88, 0.08, 0.70, 0.80), (-0.55, 0.15, 0.69, 0.80), (-0.16, 0.12, 0.64, 0.74), (-0.08, 0.07, 0.64, 0.70))], "black", crease_deg=60)
    shield = np.array([[(0.36 + 0.08 * abs(y) * 3, y * (1.0 if z < 0.8 else 0.75), z) for y in (0.22, 0.12, 0.0, -0.12, -0.22)] for z in (0.30, 0.50, 0.70, 0.88)])
    shield[..., 0] += (shield[..., 2] - 0.3) * 0.15 - 0.16 * (shield[..., 1] / 0.22) ** 2
    b.sheet(shield[:, ::-1] + [0.05, 0, 0], color, both_sides=True)
    b.convex([(0.46, -0.10, 0.86), (0.46, 0.10, 0.86), (0.60, 0, 0.93), (0.40, -0.13, 1.02), (0.40, 0.13, 1.02), (0.55, 0, 1.02), (0.36, -0.1, 0.86), (0.36, 0.1, 0.86)], color)
    b.ball((0.03, 0.07, 0.06), (0.555, 0, 0.965), "lamp", segments=10, rings=6)
    angles = np.radians(np.linspace(25, 165, 8))
    b.loft([_oval_yz_at(front + (r + 0.03) * np.cos(a), r + (r + 0.03) * np.sin(a), 0.085, 0.03, a) for a in angles], color, crease_deg=60)
    b.rod((0.44, 0, 0.90), (front, 0, r), 0.035, "dark grey")
    b.tube([(0.34, 0.33, 1.04), (0.42, 0.14, 1.03), (0.42, -0.14, 1.03), (0.34, -0.33, 1.04)], 0.016, "black", sides=6)
    for s in (-1, 1):
        b.rod((0.42, s * 0.18, 1.03), (0.44, s * 0.26, 1.20), 0.008, "black", sides=4)
        b.ball((0.015, 0.06, 0.045), (0.44, s * 0.28, 1.23), "charcoal", segments=8, rings=5)
    b.box((0.02, 0.14, 0.06), (-0.935, 0, 0.56), "red")
    b.panel(number_plate("M 204", size=(32, 16)), (-0.95, 0, 0.46), 0.18, 0.10, "-x", back="black")
    b.cylinder(0.045, 0.34, (-0.86, -0.17, 0.27), "dark grey", (0, 90, 0), segments=10)
    b.rod((-0.05, 0.10, 0.28), (-0.02, 0.24, 0.0), 0.014, "dark grey", sides=5)
    if box:
        b.box((0.44, 0.46, 0.46), (-0.78, 0, 0.82), "white", bevel=0.03)
        b.box((0.446, 0.466, 0.10), (-0.78, 0, 0.98), "red", bevel=0.0)


def _oval_yz(x: float, half_width: float, z0: float, z1: float) -> np.ndarray:
    a = np.arange(12) * np.pi / 6
    c, s = np.cos(a), np.sin(a)
    return np.stack(
        [np.full(12, x), half_width * np.sign(c) * np.abs(c) ** 0.7, (z0 + z1) / 2 + (z1 - z0) / 2 * np.sign(s) * np.abs(s) ** 0.7], 1
    )


def _oval_yz_at(x: float, z: float, half_width: float, thickness: float, angle: float) -> np.ndarray:
    a = -np.arange(8) * np.pi / 4
    out = np.array([np.cos(angle), 0, np.sin(angle)])
    return np.array([x, 0, z]) + np.outer(np.sin(a) * thickness, out) + np.outer(np.cos(a) * half_width, [0, 1, 0])


def _big_motorcycle(b: MeshBuilder, color: Color, cruiser: bool) -> None:
    front, rear, r = (0.86, -0.76, 0.32) if cruiser else (0.72, -0.70, 0.31)
    for x in (front, rear):
        _thick_wheel(b, x, r, 0.15)
    seat = 0.68 if cruiser else 0.80
    tank = ((0.42, 0.06, seat + 0.02, seat + 0.16), (0.32, 0.14, seat - 0.02, seat + 0.22), (0.05, 0.16, seat - 0.04, seat + 0.20), (-0.12, 0.09, seat - 0.03, seat + 0.06))
    b.loft([_oval_yz(x, w, z0, z1) for x, w, z0, z1 in reversed(tank)], color, crease_deg=60)
    rear_seat = ((-0.10, 0.12, seat - 0.05, seat + 0.03), (-0.35, 0.15, seat - 0.06, seat + 0.02), (-0.62, 0.12, seat, seat + 0.10), (-0.80, 0.07, seat + 0.03, seat + 0.10))
    b.loft([_oval_yz(x, w, z0, z1) for x, w, z0, z1 in reversed(rear_seat)], "black", crease_deg=60)
    tail = ((-0.30, 0.10, seat - 0.14, seat - 0.03), (-0.70, 0.10, seat - 0.04, seat + 0.04), (-0.92, 0.05, seat + 0.0, seat + 0.07))
    b.loft([_oval_yz(x, w, z0, z1) for x, w, z0, z1 in reversed(tail)], color, crease_deg=60)
    # Engine with cooling fins, exhaust, frame.
    b.box((0.42, 0.26, 0.24), (0.06, 0, 0.26), "dark grey", bevel=0.04)
    for k in range(5):
        b.box((0.22, 0.30, 0.022), (0.12, 0, 0.50 + 0.035 * k), "aluminium")
    b.box((0.18, 0.24, 0.18), (0.12, 0, 0.49), "charcoal")
    for s in (-1, 1):
        b.tube([(0.24, s * 0.10, 0.55), (0.36, s * 0.15, 0.40), (0.10, s * 0.18, 0.22), (-0.40, s * 0.19, 0.26), (-0.98, s * 0.20, 0.36 if not cruiser else 0.28)], [0.02, 0.025, 0.025, 0.045, 0.05], "aluminium", sides=8)
        b.rod((-0.05, s * 0.10, 0.36), (rear, s * 0.11, r), 0.028, "dark grey", sides=6)
        b.rod((-0.50, s * 0.10, seat - 0.05), (rear, s * 0.12, r + 0.02), 0.024, "aluminium", sides=6)
        b.rod((0.46, s * 0.10, seat + 0.14), (front, s * 0.11, r), 0.028, "aluminium", sides=6)
        b.ball((0.02, 0.05, 0.035), (0.36, s * 0.33, seat + 0.42), "charcoal", segments=8, rings=5)
        b.rod((0.36, s * 0.24, seat + 0.27), (0.36, s * 0.31, seat + 0.40), 0.007, "black", sides=4)
        b.box((0.08, 0.10, 0.025), (-0.02, s * 0.22, 0.30), "black")
    wide, back = (0.40, 0.10) if cruiser else (0.34, 0.22)
    b.tube([(back, wide, seat + 0.26), (0.36, 0.20, seat + 0.26), (0.42, 0, seat + 0.22), (0.36, -0.20, seat + 0.26), (back, -wide, seat + 0.26)], 0.017, "black", sides=6)
    b.ball((0.08, 0.095, 0.095), (0.54, 0, seat + 0.10), "charcoal", segments=12, rings=8)
    b.ball((0.03, 0.08, 0.08), (0.605, 0, seat + 0.10), "lamp", segments=12, rings=6)
    angles = np.radians(np.linspace(40, 150, 7))
    b.loft([_oval_yz_at(front + (r + 0.03) * np.cos(a), r + (r + 0.03) * np.sin(a), 0.075, 0.015, a) for a in angles], color, crease_deg=60)
    b.box((0.02, 0.13, 0.06), (-0.93, 0, seat - 0.02), "red")
    b.panel(number_plate("MC 77", size=(32, 20)), (-0.95, 0, seat - 0.14), 0.20, 0.13, "-x", back="black")
    b.rod((-0.02, 0.12, 0.28), (0.02, 0.30, 0.0), 0.016, "dark grey", sides=5)


# Kick scooters ----------------------------------------------------------------------------------------------------------


def _kick_scooter(b: MeshBuilder, color: Color, accent: Color) -> None:
    front, rear, r = 0.46, -0.44, 0.11
    for x in (front, rear):
        b.ring(r * 0.74, r * 0.26, (x, 0, r), "rubber", (90, 0, 0), segments=16, sides=7)
        b.cylinder(r * 0.55, 0.04, (x, 0.02, r), "aluminium", (90, 0, 0), segments=12)
    b.box((0.58, 0.17, 0.075), (-0.08, 0, 0.085), color, bevel=0.02)
    b.box((0.50, 0.14, 0.006), (-0.08, 0, 0.158), "charcoal")
    angles = np.radians(np.linspace(35, 150, 7))
    grid = np.array([[(rear + (r + 0.02) * np.cos(a), y, r + (r + 0.02) * np.sin(a)) for y in (0.045, -0.045)] for a in angles[::-1]])
    b.sheet(grid, accent, both_sides=True)
    b.tube([(0.18, 0, 0.13), (0.30, 0, 0.20), (0.37, 0, 0.30)], 0.035, color, sides=8)
    b.tube([(front, 0.045, r), (0.42, 0.04, 0.26), (0.395, 0, 0.30)], 0.018, color, sides=6)
    b.tube([(front, -0.045, r), (0.42, -0.04, 0.26), (0.395, 0, 0.30)], 0.018, color, sides=6)
    b.rod((0.40, 0, 0.24), (0.27, 0, 1.12), 0.028, color, sides=10)
    b.box((0.05, 0.06, 0.30), (0.355, 0, 0.52), accent, turn_deg=(0, -8.5, 0), bevel=0.01)
    b.rod((0.265, -0.26, 1.13), (0.265, 0.26, 1.13), 0.014, "dark grey", sides=8)
    for s in (-1, 1):
        b.rod((0.265, s * 0.15, 1.13), (0.265, s * 0.27, 1.13), 0.02, "black", sides=8)
        b.rod((0.285, s * 0.13, 1.12), (0.32, s * 0.24, 1.10), 0.006, "black", sides=4)
    b.box((0.05, 0.09, 0.04), (0.275, 0, 1.13), "black", bevel=0.01)
    b.cylinder(0.028, 0.03, (0.305, 0, 1.04), "lamp", (0, 90, 0), segments=10)
    b.box((0.012, 0.05, 0.03), (rear - 0.125, 0, r + 0.02), "red")
    b.rod((-0.12, 0.07, 0.09), (-0.16, 0.17, 0.0), 0.009, "dark grey", sides=5)


@recipe("scooter", 4, _SCOOTER, hulls=4)
def scooter(variant: int, rng: np.random.Generator) -> BuiltAsset:
    color, accent = (("charcoal", "lime"), ("white", "orange"), ("black", "teal"), ("dark grey", "signal red"))[variant]
    b = MeshBuilder(roughness=0.5, metallic=0.2)
    lying = variant in (1, 3)
    with b.frame((0, 0, 0.15 if lying else 0), ((86 if variant == 1 else -86) if lying else 0, 0, 0)):
        _kick_scooter(b, color, accent)
    state = "lying on its side" if lying else "standing"
    built = b.build(f"A shared electric kick scooter with {accent} marks, {state}", {"state": state}, mass=24.0)
    return dataclasses.replace(built, volume=0.015)
