"""Robots of the street: humanoids, robot dogs, delivery robots."""

import dataclasses
import itertools

import numpy as np

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, shade
from ...meshes.recipe import Physics, recipe
from ..shared.sizes import fitted
from ..vehicle.carts import solid_wheel


def _limb(
    b: MeshBuilder, joints: list[tuple[float, float, float]], radii: list[float], shell: Color, joint: Color
) -> None:
    """A limb of tapering shells between dark ball joints."""
    for (p, q), (r, s) in zip(itertools.pairwise(joints), itertools.pairwise(radii), strict=True):
        a, c = np.array(p), np.array(q)
        b.tube([a + (c - a) * 0.10, a + (c - a) * 0.35, a + (c - a) * 0.90], [r * 0.85, r, s * 0.85], shell, sides=8)
    for p, r in zip(joints, radii, strict=True):
        b.ball(r * 0.92, p, joint, segments=8, rings=6)


@recipe("humanoid robot", 3, name="robots.humanoid_robot")
def humanoid_robot(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.35, metallic=0.15)
    if variant == 1:
        return fitted(_toy_robot(b), (0.34, 0.52, 0.95))
    shell, joint, glow = (("light grey", "charcoal", "light blue"), ("", "", ""), ("white", "black", "light green"))[
        variant
    ]
    for side in (-1, 1):
        y = side * 0.10
        _limb(b, [(0, y, 0.86), (0.05, y, 0.47), (-0.02, y, 0.09)], [0.075, 0.06, 0.042], shell, joint)
        b.box((0.25, 0.09, 0.07), (0.035, y, 0.0), joint, bevel=0.02, taper=(0.8, 0.85))
        elbow, hand = (-0.03, side * 0.265, 1.08), (0.12, side * 0.25, 0.86)
        _limb(b, [(0, side * 0.225, 1.36), elbow, hand], [0.062, 0.048, 0.036], shell, joint)
        for k in range(3):
            b.rod(hand, (0.16 + 0.02 * k, side * 0.25 + 0.025 * (k - 1), 0.78), 0.012, joint, sides=5)
    chest = [
        (0.0, 0.92, 0.085, 0.10),
        (0.0, 1.05, 0.075, 0.10),
        (0.0, 1.25, 0.11, 0.16),
        (0.0, 1.38, 0.10, 0.175),
        (0.0, 1.44, 0.05, 0.09),
    ]
    a = np.arange(12) * np.pi / 6
    rows = [
        np.stack(
            [
                x + d * np.sign(np.cos(a)) * np.abs(np.cos(a)) ** 0.6,
                w * np.sign(np.sin(a)) * np.abs(np.sin(a)) ** 0.6,
                np.full(12, z),
            ],
            1,
        )
        for x, z, d, w in chest
    ]
    b.loft(rows[:2], joint, crease_deg=50)
    b.loft(rows[1:], shell, crease_deg=50)
    b.box((0.15, 0.25, 0.10), (0, 0, 0.84), joint, bevel=0.03)
    b.cylinder(0.04, 0.10, (0, 0, 1.42), joint, segments=10)
    b.cylinder(0.045, 0.012, (0.105, 0, 1.28), glow, (0, 90, 0), segments=14)
    b.ball((0.095, 0.08, 0.115), (0, 0, 1.58), shell, segments=12, rings=8)
    b.ball((0.075, 0.07, 0.07), (0.035, 0, 1.585), "black", segments=12, rings=7)
    if variant == 0:
        b.box((0.01, 0.09, 0.016), (0.107, 0, 1.59), glow)
    else:
        b.ring(0.035, 0.007, (0.102, 0, 1.59), glow, (0, 90, 0), 14, 4)
    b.box((0.10, 0.22, 0.28), (-0.13, 0, 1.12), joint, bevel=0.03)
    names = ("A grey humanoid robot", "", "A white humanoid robot with a ring of light for a face")
    return fitted(
        b.build(names[variant], {"shell": shell}), ((0.35, 0.57, 1.62), (0, 0, 0), (0.38, 0.60, 1.75))[variant]
    )


def _toy_robot(b: MeshBuilder) -> BuiltAsset:
    """The boxy robot of image books."""
    steel: Color = "#9fb4bd"
    b.box((0.26, 0.38, 0.38), (0, 0, 0.30), steel, bevel=0.03)
    b.box((0.22, 0.28, 0.22), (0, 0, 0.72), steel, bevel=0.03)
    b.cylinder(0.05, 0.06, (0, 0, 0.67), "charcoal", segments=10)
    image, pen = paint.canvas((96, 72), "charcoal")
    pen.ellipse((10, 8, 46, 44), outline=paint.rgb("white"), width=4)
    pen.line((28, 28, 40, 14), fill=paint.rgb("signal red"), width=4)
    for k, ink in enumerate(("signal red", "amber", "light green")):
        pen.ellipse((56, 8 + 21 * k, 70, 22 + 21 * k), fill=paint.rgb(ink))
        pen.rectangle((76, 10 + 21 * k, 90, 20 + 21 * k), fill=paint.rgb("light grey"))
    b.panel(np.asarray(paint.shrunk(image, (48, 36))), (0.133, 0, 0.52), 0.28, 0.21, "+x")
    for side in (-1, 1):
        b.cylinder(0.045, 0.03, (0.10, side * 0.065, 0.86), "signal yellow", (0, 90, 0), segments=14)
        b.cylinder(0.02, 0.035, (0.10, side * 0.065, 0.86), "black", (0, 90, 0), segments=10)
        b.cylinder(0.035, 0.05, (0, side * 0.14 + 0.025, 0.83), "signal red", (90, 0, 0), segments=10)
        b.tube(
            [(0, side * 0.19, 0.60), (0.02, side * 0.27, 0.52), (0.10, side * 0.27, 0.36)],
            [0.04, 0.045, 0.04],
            "charcoal",
            sides=8,
        )
        with b.frame((0.11, side * 0.27, 0.34), (0, 60, 0)):  # claws
            for k in (-1, 1):
                b.tube([(0, 0, 0), (k * 0.05, 0, 0.05), (k * 0.03, 0, 0.11)], 0.014, "signal red", sides=6)
        b.cylinder(0.05, 0.24, (0, side * 0.10, 0.07), "charcoal", segments=10)
        b.box((0.22, 0.15, 0.09), (0.03, side * 0.10, 0), "signal red", bevel=0.02)
    b.box((0.012, 0.14, 0.03), (0.112, 0, 0.77), "black")
    b.rod((0, 0, 0.93), (0, 0, 1.03), 0.01, "charcoal", sides=6)
    b.ball(0.025, (0, 0, 1.05), "light red", segments=8, rings=6)
    return b.build("A boxy toy robot with dials on its chest", {"shell": "tin"})


@recipe("robot dog", 3, name="robots.robot_dog")
def robot_dog(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.4)
    color, joint = (("light grey", "charcoal"), ("signal yellow", "black"), ("signal red", "charcoal"))[variant]
    hip, half, gauge = 0.32, 0.22, 0.13
    b.box((0.56, 0.18, 0.12), (0, 0, hip - 0.03), color, bevel=0.035)
    b.box((0.36, 0.15, 0.03), (-0.02, 0, hip + 0.085), joint, bevel=0.01)
    for end in (-1, 1):
        b.box((0.10, 0.20, 0.13), (end * half, 0, hip - 0.045), joint, bevel=0.02)
        for side in (-1, 1):
            top = np.array([end * half, side * gauge, hip])
            knee = top + [-0.13, side * 0.01, -0.15]
            foot = np.array([end * half + 0.01 + 0.02 * side * end, side * (gauge + 0.01), 0.022])
            b.cylinder(0.052, 0.07, (top[0], top[1] + 0.035, top[2]), color, (90, 0, 0), segments=12)
            b.beam(tuple(top), tuple(knee), 0.042, 0.055, color if variant else joint, bevel=0.01)
            b.ball(0.028, tuple(knee), joint, segments=8, rings=6)
            b.tube([tuple(knee), tuple(foot)], [0.022, 0.014], joint, sides=7)
            b.ball(0.024, tuple(foot), "rubber", segments=8, rings=6)
    front = 0.28
    if variant == 0:  # a head with a screen-like face and a lidar under its chin
        b.box((0.12, 0.14, 0.11), (front + 0.07, 0, hip - 0.01), "charcoal", bevel=0.03)
        b.box((0.01, 0.10, 0.02), (front + 0.13, 0, hip + 0.06), "light blue")
        b.cylinder(0.035, 0.05, (front + 0.09, 0, hip - 0.06), "black", segments=12)
        b.cylinder(0.03, 0.05, (0.02, 0, hip + 0.10), "black", segments=12)
    else:
        b.box((0.04, 0.17, 0.10), (front + 0.02, 0, hip - 0.02), "black", bevel=0.015)
        for side in (-1, 1):
            b.cylinder(0.022, 0.012, (front + 0.035, side * 0.05, hip + 0.03), "glass", (0, 90, 0), segments=10)
            b.cylinder(0.012, 0.012, (front + 0.035, side * 0.05, hip - 0.005), "light red", (0, 90, 0), segments=8)
    if variant == 2:  # an arm with a gripper, folded over the back
        path = [(0.16, 0, hip + 0.10), (-0.10, 0, hip + 0.30), (0.24, 0, hip + 0.33), (0.36, 0, hip + 0.27)]
        b.tube(path, [0.04, 0.032, 0.028, 0.022], "black", sides=8)
        for side in (-1, 1):
            b.tube(
                [(0.36, 0, hip + 0.27), (0.42, side * 0.035, hip + 0.25), (0.47, side * 0.01, hip + 0.22)],
                0.012,
                color,
                sides=5,
            )
    names = ("A grey robot dog", "A yellow robot dog", "A red robot dog with an arm")
    size = ((0.70, 0.35, 0.42), (0.80, 0.40, 0.50), (0.78, 0.38, 0.68))[variant]
    return fitted(b.build(names[variant], {"arm": variant == 2}), size)


_ROBOT = Physics(
    ("plastic", "aluminium", "rubber"),
    350.0,
    (20.0, 80.0),
    0.6,
    True,
    "pavement delivery robots weigh 23-60 kg and roll when pushed",
)


def _logo(words: str, back: Color, ink: Color) -> np.ndarray:
    image, pen = paint.canvas((192, 48), back)
    paint.text(pen, words, (6, 4, 186, 44), ink, 0.03)
    return np.asarray(paint.shrunk(image, (64, 16)))


@recipe("delivery robot", 3, _ROBOT, hulls=2, name="carts.delivery_robot")
def delivery_robot(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.4)
    color, accent, name = (("white", "orange", "DASHBOT"), ("charcoal", "lime", "CURIO"), ("pink", "white", "HELLO"))[
        variant
    ]
    if variant == 1:  # a taller four-wheeler with a screen
        length, width, low, high, wheels = 0.80, 0.56, 0.18, 0.98, ((-0.27, 0.15), (0.27, 0.15))
    else:
        length, width, low, high, wheels = 0.70, 0.52, 0.14, 0.52, ((-0.25, 0.11), (0.0, 0.11), (0.25, 0.11))
    for x, r in wheels:
        for s in (-1, 1):
            solid_wheel(b, (x, s * (width / 2 - 0.02), r), r, 0.075, accent)
    with_taper = (0.88, 0.86)
    b.box(
        (length, width * 0.86, (high - low) * 0.55),
        (0, 0, low),
        shade(color, 0.72) if variant != 1 else "dark grey",
        bevel=0.04,
    )
    b.box((length, width, (high - low) * 0.62), (0, 0, low + (high - low) * 0.38), color, bevel=0.05, taper=with_taper)
    b.box((length * 0.9, width * 0.88, 0.012), (0, 0, low + (high - low) * 0.74), "black")
    for s, facing in ((1, "+y"), (-1, "-y")):
        b.panel(
            _logo(name, color, accent if variant != 2 else "white"),
            (0, s * (width / 2 * 0.985 + 0.003), low + (high - low) * 0.60),
            length * 0.5,
            length * 0.125,
            facing,
            tilt_deg=2.0,
        )
    # Face: cameras and headlights in front, tail lights behind, an orange flag on a rod.
    x = length / 2
    b.box((0.02, width * 0.55, 0.07), (x - 0.005, 0, low + (high - low) * 0.62), "black", bevel=0.01)
    for s in (-1, 1):
        b.cylinder(
            0.022,
            0.02,
            (x + 0.005, s * width * 0.18, low + (high - low) * 0.62 + 0.035),
            "light blue",
            (0, 90, 0),
            segments=10,
        )
        b.cylinder(
            0.03, 0.02, (x - 0.012, s * width * 0.33, low + (high - low) * 0.30), "lamp", (0, 90, 0), segments=10
        )
        b.box((0.02, 0.09, 0.03), (-x + 0.002, s * width * 0.30, low + (high - low) * 0.5), "red")
    if variant == 1:
        image, pen = paint.canvas((128, 96), "black")
        for k in (-1, 1):
            pen.ellipse((64 + k * 26 - 12, 30, 64 + k * 26 + 12, 58), fill=paint.rgb("light green"))
        pen.arc((44, 44, 84, 78), 20, 160, fill=paint.rgb("light green"), width=6)
        b.panel(paint.shrunk(image, (32, 24)), (x * 0.94 + 0.008, 0, high - 0.16), 0.30, 0.2, "+x", tilt_deg=4.0)
        b.cylinder(0.05, 0.06, (0, 0, high - 0.005), "black", segments=12)
    b.rod((-x + 0.06, width * 0.3, high - 0.05), (-x + 0.06, width * 0.3, high + 0.62), 0.006, "black", sides=5)
    b.quad(
        [
            (-x + 0.06, width * 0.3, high + 0.48),
            (-x - 0.10, width * 0.3, high + 0.50),
            (-x - 0.10, width * 0.3, high + 0.58),
            (-x + 0.06, width * 0.3, high + 0.61),
        ],
        "safety orange",
        both_sides=True,
    )
    names = (
        "A white six-wheeled delivery robot with a flag",
        "A dark four-wheeled delivery robot with a face on its screen",
        "A pink six-wheeled delivery robot",
    )
    built = b.build(names[variant], {"wheels": 2 * len(wheels), "name": name}, mass=(32.0, 55.0, 30.0)[variant])
    return dataclasses.replace(built, volume=(0.12, 0.28, 0.12)[variant])
