"""People riding bicycles and motorcycles."""

import dataclasses

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color
from ...meshes.recipe import Physics, recipe
from ..shared.sizes import fitted
from ..vehicle.bicycles import BIKES, build_bicycle
from ..vehicle.motorbikes import Motorbike, motorbike
from .figure import ANKLE_HEIGHT, FOREARM, SHANK, THIGH, UPPER_ARM, Figure, Person, Pose
from .limbs import reach_foot, reach_hand
from .worn_items import cap

_CYCLIST = Physics(
    ("flesh", "aluminium", "rubber"),
    500.0,
    (60.0, 130.0),
    0.6,
    False,
    "rider and bicycle together 75-110 kg; people are not shoved about",
)


@recipe("cyclist", 3, _CYCLIST, hulls=4, name="cyclists.cyclist")
def cyclist(variant: int, rng: np.random.Generator) -> BuiltAsset:
    bike = (BIKES[0], BIKES[1], dataclasses.replace(BIKES[3], color="light blue"))[variant]
    person = (
        Person(1.78, 1.0, "skin light", "short", "#4a3524", "jacket", "#8a2f2f", "trousers", "#2d3a55", "white"),
        Person(
            1.76, 0.92, "skin medium", "short", "#1e1612", "shirt", "signal yellow", "shorts", "black", "white", "short"
        ),
        Person(
            1.66, 0.95, "skin dark", "long", "#17100c", "shirt", "#d8e0e4", "trousers", "#5a6b4a", "#8a5a30", "long"
        ),
    )[variant]
    b = MeshBuilder(roughness=0.7)
    touch = build_bicycle(b, bike)
    lean = (24.0, 44.0, 18.0)[variant]
    hip = tuple(touch["saddle"] + [0.02, 0, 0.10])
    pose = Pose((78, 42), (84, 42), (40, 40), (14, 14), lean, (6, 6))
    figure = Figure(b, person, pose, hip)
    _reach(figure, touch)
    figure.build()
    if variant < 2:
        cap(figure, ("white", "black")[variant], "helmet")
    names = (
        "A commuter riding a city bicycle",
        "A racing cyclist in yellow",
        "A woman riding a blue step-through bicycle",
    )
    built = b.build(names[variant], {"kind": bike.kind}, mass=(95.0, 82.0, 78.0)[variant])
    return dataclasses.replace(built, volume=0.10)


def _reach(figure: Figure, touch: dict[str, np.ndarray]) -> None:
    """Moves feet onto the pedals and hands onto the grips, bending knees forwards and elbows downwards."""
    h = figure.person.height
    for k, side in ((0, "left"), (1, "right")):
        hip = figure.hip + [0, (1 if k == 0 else -1) * 0.052 * h, 0]
        ankle = touch[f"{side}_pedal"] + [-0.07, 0, ANKLE_HEIGHT * h + 0.015]
        figure.knees[k], figure.ankles[k] = _two_bones(hip, ankle, THIGH * h, SHANK * h, np.array([1.0, 0, 0.35]))
        wrist = touch[side] + [-0.05, 0, 0.03]
        elbow, wrist = _two_bones(
            figure.shoulders[k], wrist, UPPER_ARM * h, FOREARM * h, np.array([-0.4, 0.3 if k == 0 else -0.3, -1.0])
        )
        figure.elbows[k], figure.wrists[k] = elbow, wrist


def _two_bones(
    start: np.ndarray, end: np.ndarray, first: float, second: float, bend: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Joint and end of two bones that reach from start towards end, bent towards a direction."""
    axis = end - start
    distance = min(float(np.linalg.norm(axis)), 0.995 * (first + second))
    axis = axis / np.linalg.norm(axis)
    along = (first**2 - second**2 + distance**2) / (2 * distance)
    out = bend - axis * (bend @ axis)
    out /= np.linalg.norm(out)
    return start + axis * along + out * np.sqrt(max(first**2 - along**2, 0.0)), start + axis * distance


def full_helmet(f: Figure, color: Color) -> None:
    """A full-face helmet with a dark visor."""
    rx, ry, rz = f.head_radii
    b = f.builder
    with b.frame(tuple(f.head_center), (0, f.pose.lean * 0.3, f.pose.turn)):
        b.ball((1.32 * rx, 1.42 * ry, 1.20 * rz), (0, 0, 0.02 * rz), color, segments=12, rings=8)
        b.ball((1.05 * rx, 1.30 * ry, 0.42 * rz), (0.34 * rx, 0, 0.14 * rz), "black", segments=12, rings=6)
        b.ball((0.6 * rx, 0.9 * ry, 0.35 * rz), (0.85 * rx, 0, -0.62 * rz), color, segments=10, rings=6)


@recipe("motorcycle rider", 3, hulls=5, name="motorbikes.motorcycle_rider")
def motorcycle_rider(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.5)
    bike = (
        Motorbike("cruiser", "dark blue", "black", 0.76, 1.02),
        Motorbike("sport", "signal red", "black", 0.80, 0.93),
        Motorbike("cruiser", "black", "dark grey", 0.66, 1.06, (0.32, 0.31), 1.62),
    )[variant]
    touch = motorbike(b, bike)
    person = (
        Person(1.74, 1.1, "skin light", "bald", "black", "jacket", "#3a3f47", "trousers", "#2d3a55", "black"),
        Person(1.72, 1.0, "skin light", "bald", "black", "jacket", "signal red", "trousers", "charcoal", "black"),
        Person(1.78, 1.25, "skin medium", "bald", "black", "jacket", "#4a3020", "trousers", "#232833", "black"),
    )[variant]
    lean = (16.0, 42.0, 2.0)[variant]
    f = Figure(b, person, Pose(lean=lean, spread=(12, 12)), tuple(touch["hip"]))
    for k, side in enumerate((1.0, -1.0)):
        mirror = np.array([1.0, side, 1.0])
        peg = touch["peg"] + ([0.34, 0, 0.02] if variant == 2 else [0.0, 0, 0])
        reach_hand(f, k, touch["grip"] * mirror + [-0.04, 0, 0.03])
        reach_foot(f, k, peg * mirror + [-0.02, 0, 0.0], (1.0, side * 0.3, 0.4))
    f.build()
    full_helmet(f, ("white", "black", "charcoal")[variant])
    names = ("A rider on a blue motorcycle", "A rider crouched on a red sport motorcycle", "A rider on a black cruiser")
    size = ((2.10, 0.80, 1.52), (2.04, 0.74, 1.40), (2.36, 0.86, 1.50))[variant]
    return fitted(b.build(names[variant], {"bike": bike.style}), size)
