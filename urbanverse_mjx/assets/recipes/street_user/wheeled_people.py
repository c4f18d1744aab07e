"""People on small wheels: kick scooters, wheelchairs, roller skates; and infants."""

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color
from ...meshes.recipe import recipe
from ..shared.sizes import fitted
from ..vehicle.bicycles import spoked_wheel
from .figure import Figure, Person, Pose
from .limbs import reach_foot, reach_hand
from .uniforms import finished
from .worn_items import backpack, cap


def _scooter(b: MeshBuilder, color: Color, accent: Color, deck: float) -> None:
    """An electric kick scooter along x, its deck's upper side at `deck`."""
    for x in (0.45, -0.45):
        b.ring(0.082, 0.028, (x, 0, 0.11), "rubber", (90, 0, 0), segments=14, sides=6)
        b.cylinder(0.06, 0.04, (x, 0.02, 0.11), "aluminium", (90, 0, 0), segments=10)
    b.box((0.62, 0.17, 0.07), (-0.06, 0, deck - 0.07), color, bevel=0.02)
    b.box((0.12, 0.10, 0.03), (-0.44, 0, 0.225), accent, (0, -12, 0))
    b.tube([(0.20, 0, deck - 0.03), (0.33, 0, 0.22), (0.38, 0, 0.34)], 0.035, color, sides=7)
    b.rod((0.45, 0, 0.11), (0.36, 0, 0.36), 0.03, accent, sides=6)
    b.rod((0.38, 0, 0.30), (0.27, 0, 1.10), 0.026, color, sides=8)
    b.rod((0.27, -0.26, 1.11), (0.27, 0.26, 1.11), 0.016, "black", sides=6)
    b.box((0.06, 0.09, 0.05), (0.28, 0, 1.10), "black", bevel=0.01)
    b.cylinder(0.03, 0.03, (0.305, 0, 1.0), "lamp", (0, 90, 0), segments=8)


@recipe("electric scooter rider", 3, name="wheeled_people.electric_scooter_rider")
def electric_scooter_rider(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.7)
    deck = 0.17
    _scooter(b, ("charcoal", "white", "black")[variant], ("lime", "orange", "teal")[variant], deck)
    person = (
        Person(1.70, 1.0, "skin light", "short", "#4a3524", "jacket", "#3f6a8a", "trousers", "#2c2f3a", "white"),
        Person(1.64, 0.95, "skin dark", "long", "#15100d", "shirt", "#e0b23c", "trousers", "#5d6b7a", "#8a5a30"),
        Person(1.78, 1.05, "skin medium", "short", "#1e1612", "jacket", "#8a2f2f", "trousers", "black", "black"),
    )[variant]
    hip = (-0.12, 0.0, deck + 0.515 * person.height)
    f = Figure(b, person, Pose(lean=(6.0, 4.0, 8.0)[variant], spread=(8, 8)), hip)
    for k, side in enumerate((1.0, -1.0)):
        reach_hand(f, k, (0.24, side * 0.21, 1.13))
        x = 0.06 if k == variant % 2 else -0.27
        reach_foot(f, k, (x, side * 0.055, deck + 0.043 * person.height))
    f.build()
    if variant != 1:
        cap(f, ("white", "#2c2f3a")[variant // 2], "helmet")
    if variant != 2:
        backpack(f, ("dark grey", "dark red")[variant])
    names = ("A commuter riding an electric scooter", "A woman riding a scooter", "A man riding a black scooter")
    size = ((1.15, 0.54, 1.86), (1.12, 0.52, 1.80), (1.20, 0.56, 1.96))[variant]
    return fitted(b.build(names[variant], {"rider": person.height}), size)


@recipe("wheelchair user", 3, name="wheeled_people.wheelchair_user")
def wheelchair_user(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.7)
    frame, cloth = (("aluminium", "dark blue"), ("signal red", "black"), ("charcoal", "dark grey"))[variant]
    powered = variant == 2
    radius = 0.30 if not powered else 0.17
    for side in (-1, 1):
        at = (-0.12 if not powered else -0.20, side * 0.28, radius)
        if powered:
            b.ring(0.13, 0.045, at, "rubber", (90, 0, 0), segments=14, sides=6)
            b.cylinder(0.10, 0.05, (at[0], at[1] + 0.025, at[2]), "light grey", (90, 0, 0), segments=10)
        else:
            spoked_wheel(b, at, radius, 0.014, "aluminium", 6)
            b.ring(radius - 0.05, 0.009, (at[0], side * 0.315, at[2]), frame, (90, 0, 0), segments=16, sides=4)
        b.ring(0.065, 0.022, (0.34, side * 0.22, 0.087), "rubber", (90, 0, 0), segments=10, sides=5)
        b.tube(
            [(0.30, side * 0.23, 0.14), (0.30, side * 0.23, 0.44), (-0.26, side * 0.23, 0.46)], 0.014, frame, sides=5
        )
        b.tube([(0.30, side * 0.23, 0.42), (0.44, side * 0.20, 0.12), (0.52, side * 0.18, 0.10)], 0.014, frame, sides=5)
        b.tube(
            [(-0.24, side * 0.23, 0.34), (-0.29, side * 0.23, 0.90), (-0.40, side * 0.23, 0.92)], 0.014, frame, sides=5
        )
        b.box((0.20, 0.15, 0.02), (0.52, side * 0.10, 0.10), "black")
        b.box((0.34, 0.05, 0.035), (-0.04, side * 0.25, 0.68), "black", bevel=0.01)
        b.rod((0.10, side * 0.25, 0.45), (0.10, side * 0.25, 0.68), 0.012, frame, sides=5)
    b.box((0.46, 0.42, 0.06), (0.02, 0, 0.44), cloth, bevel=0.02)
    b.box((0.05, 0.42, 0.46), (-0.25, 0, 0.48), cloth, (0, -6, 0), bevel=0.02)
    if powered:
        b.box((0.52, 0.36, 0.22), (-0.08, 0, 0.14), "charcoal", bevel=0.04)
        b.rod((0.14, -0.25, 0.70), (0.14, -0.25, 0.80), 0.015, "black", sides=6)
    person = (
        Person(1.72, 1.0, "skin medium", "short", "#2b1d15", "shirt", "#5a8a5a", "trousers", "#39424f", "#5a3a22"),
        Person(1.64, 0.97, "skin light", "long", "#8a5a30", "jacket", "#c9656b", "trousers", "#2c3550", "white"),
        Person(1.68, 1.1, "skin dark", "short", "#c9c7c2", "jacket", "#6a6f58", "trousers", "#4a4440", "black"),
    )[variant]
    f = Figure(b, person, Pose((86, 86), (74, 74), (18, 18), (48, 48), -4.0, (10, 10)), (-0.15, 0.0, 0.575))
    for k, side in enumerate((1.0, -1.0)):
        reach_foot(f, k, (0.46, side * 0.10, 0.12 + 0.04 * person.height), (0.4, side * 0.2, 1.0))
        hand = (0.12, side * 0.25, 0.74) if powered else (-0.02, side * 0.31, 0.60)
        reach_hand(f, k, hand, (-1.0, side * 0.6, -0.4))
    f.build()
    names = ("A man in a wheelchair", "A woman in a red wheelchair", "An older man in a powered wheelchair")
    size = ((1.08, 0.65, 1.32), (1.02, 0.62, 1.26), (1.12, 0.68, 1.36))[variant]
    return fitted(b.build(names[variant], {"powered": powered}), size)


def _skate(f: Figure, k: int, color: Color) -> None:
    """A skate under foot k: boot, rail and four wheels in line."""
    h = f.person.height
    shin = f.pose.thigh[k] - f.pose.knee[k]
    pitch = float(np.clip(-shin * 0.75, -18, 55)) if shin < 0 else float(np.clip(-shin * 0.4, -18, 0))
    low = -0.039 * h
    with f.builder.frame(tuple(f.ankles[k]), (0, pitch, 0)):
        f.builder.box((0.11 * h, 0.055 * h, 0.085 * h), (0.01 * h, 0, low * 0.6), color, bevel=0.02)
        f.builder.box((0.145 * h, 0.018, 0.03), (0.035 * h, 0, low - 0.03), "black")
        for x in (-0.022, 0.016, 0.054, 0.092):
            f.builder.cylinder(0.036, 0.026, (x * h, 0.013, low - 0.042), "lime", (90, 0, 0), segments=9)


@recipe("roller skater", 3, name="wheeled_people.roller_skater")
def roller_skater(variant: int, rng: np.random.Generator) -> BuiltAsset:
    person = (
        Person(1.66, 0.95, "skin light", "bun", "#7a4a24", "shirt", "#d8508a", "shorts", "#2c3550", "white", "short"),
        Person(1.76, 1.0, "skin dark", "bald", "#15100d", "shirt", "lime", "trousers", "charcoal", "black", "short"),
        Person(1.62, 0.92, "skin medium", "long", "#2b1d15", "jacket", "teal", "shorts", "black", "white", "long"),
    )[variant]
    pose = (
        Pose((12, -12), (14, 14), (16, -14), (18, 22), 6.0, (28, 28)),
        Pose((26, -20), (40, 22), (28, -28), (50, 40), 18.0, (12, 12)),
        Pose((16, -6), (30, 10), (10, -8), (16, 20), 10.0, (55, 55)),
    )[variant]
    f = Figure(MeshBuilder(roughness=0.8), person, pose)
    f.build()
    b = f.builder
    for k in (0, 1):
        _skate(f, k, ("white", "signal red", "purple")[variant])
        b.ball((0.045, 0.055, 0.065), tuple(f.knees[k] + [0.035, 0, 0]), "black", segments=8, rings=5)
        b.ball((0.04, 0.04, 0.05), tuple(f.elbows[k] + [-0.02, 0, 0]), "black", segments=8, rings=5)
    if variant != 2:
        cap(f, ("signal blue", "black")[variant], "helmet")
    names = ("A girl roller skating in a helmet", "An inline skater at speed", "A skater with her arms spread")
    return finished(f, names[variant], ((0.60, 0.66, 1.76), (1.22, 0, 1.70), (0, 0, 0))[variant])


@recipe("infant", 3, name="wheeled_people.infant")
def infant(variant: int, rng: np.random.Generator) -> BuiltAsset:
    romper = ("#7fb2d9", "signal yellow", "pink")[variant]
    height, hair = (0.54, 0.70, 0.72)[variant], ("bald", "bald", "curly")[variant]
    skin = ("skin light", "skin medium", "skin dark")[variant]
    person = Person(height, 1.55, skin, hair, "#8a5a30", "shirt", romper, "trousers", romper, "white", "long", 2.15)
    standing = Pose((5, -5), (6, 8), (20, 24), (26, 26), 2.0, (26, 26))
    sitting = Pose((82, 82), (16, 24), (30, 44), (40, 50), 2.0, (24, 24))
    f = Figure(
        MeshBuilder(roughness=0.9),
        person,
        standing if variant == 0 else sitting,
        None if variant == 0 else (0, 0, 0.07),
    )
    f.build()
    b = f.builder
    b.loft([f.ring(-0.08, 0.07, 0.06), f.ring(-0.02, 0.10, 0.085), f.ring(0.05, 0.095, 0.075)], romper, crease_deg=60)
    if variant == 0:  # a dummy in the mouth, and a lock of hair
        rx, _, rz = f.head_radii
        b.ball((0.10 * rx, 0.22 * rx, 0.15 * rx), tuple(f.head_center + [0.90 * rx, 0, -0.50 * rz]), "light blue")
        b.ball((0.5 * rx, 0.4 * rx, 0.3 * rx), tuple(f.head_center + [0.25 * rx, 0, 0.80 * rz]), "#8a5a30")
    if variant == 1:
        cap(f, "white", "beanie")
        for k, color in enumerate(("red", "blue", "green")):
            b.box((0.055, 0.055, 0.055), (0.20, -0.08 + 0.075 * k, 0.0), color, (0, 0, 20.0 * k), bevel=0.006)
    if variant == 2:
        b.ball(0.05, tuple((f.hands[0] + f.hands[1]) / 2 + [0.03, 0, 0]), "red", segments=10, rings=7)
    names = ("An infant standing up in blue rompers", "A baby sitting among toy blocks", "A baby sitting with a ball")
    return finished(f, names[variant], ((0.268, 0.345, 0.625), (0, 0, 0.44), (0, 0, 0.46))[variant])
