"""Shared electric kick scooters, standing or fallen over."""

import dataclasses

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color
from ...meshes.recipe import Physics, recipe
from .wheels import two_legged_stand

_SCOOTER = Physics(
    ("aluminium", "rubber", "plastic"),
    2000.0,
    (10.0, 30.0),
    0.6,
    True,
    "shared electric kick scooters weigh 12-30 kg and are moved with one hand; grip tape and tyres rub at about 0.6",
)

#: Degrees about its length at which a fallen scooter rests on both tyres and a grip.
LYING = 79.6


def _kick_scooter(b: MeshBuilder, color: Color, accent: Color) -> None:
    front, rear, r = 0.46, -0.44, 0.11
    for x in (front, rear):
        b.ring(r * 0.74, r * 0.26, (x, 0, r), "rubber", (90, 0, 0), segments=16, sides=7)
        b.cylinder(r * 0.55, 0.04, (x, 0.02, r), "aluminium", (90, 0, 0), segments=12)
    b.box((0.58, 0.17, 0.075), (-0.08, 0, 0.085), color, bevel=0.02)
    b.box((0.50, 0.14, 0.006), (-0.08, 0, 0.158), "charcoal")
    angles = np.radians(np.linspace(35, 150, 7))
    grid = np.array(
        [
            [(rear + (r + 0.02) * np.cos(a), y, r + (r + 0.02) * np.sin(a)) for y in (0.045, -0.045)]
            for a in angles[::-1]
        ]
    )
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


@recipe("scooter", 4, _SCOOTER, hulls=4, name="kick_scooters.scooter")
def scooter(variant: int, rng: np.random.Generator) -> BuiltAsset:
    color, accent = (("charcoal", "lime"), ("white", "orange"), ("black", "teal"), ("dark grey", "signal red"))[variant]
    b = MeshBuilder(roughness=0.5, metallic=0.2)
    lying = variant in (1, 3)
    with b.frame(turn_deg=((LYING if variant == 1 else -LYING) if lying else 0, 0, 0)):
        _kick_scooter(b, color, accent)
    if not lying:
        two_legged_stand(b, (-0.12, 0.07, 0.09), (-0.16, 0.17), 0.009)
    state = "lying on its side" if lying else "standing"
    built = b.build(f"A shared electric kick scooter with {accent} marks, {state}", {"state": state}, mass=24.0)
    return dataclasses.replace(built, volume=0.015)
