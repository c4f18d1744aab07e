"""Clocks, wall lamps, sewing machines and robot arms."""

import numpy as np
from PIL import Image

from ....meshes import paint
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, rgb
from ....meshes.recipe import recipe
from ....meshes.shapes import Shape
from ...shared.outlines import curve, ellipse, level, rounded, section
from ...shared.sizes import varied


def clock_face(size: int, ground: Color, ink: Color, hour: int, minute: int) -> Image.Image:
    """A dial with numerals and hands, drawn over the whole square."""
    n = size * 4
    image, pen = paint.canvas((n, n), ground)
    m = n / 2
    for k in range(60):
        a = np.radians(6 * k)
        inner = 0.9 if k % 5 else 0.84
        pen.line(
            [(m + m * r * np.sin(a), m - m * r * np.cos(a)) for r in (inner, 0.95)],
            fill=rgb(ink),
            width=3 if k % 5 else 9,
        )
    for k in range(1, 13):
        a = np.radians(30 * k)
        x, y, h = m + 0.68 * m * np.sin(a), m - 0.68 * m * np.cos(a), 0.12 * m
        paint.text(pen, str(k), (x - 1.4 * h, y - h, x + 1.4 * h, y + h), ink, 0.03)
    for angle, length, wide in ((30 * (hour + minute / 60), 0.46, 20), (6 * minute, 0.72, 13)):
        a = np.radians(angle)
        pen.line(
            (m - 0.1 * m * np.sin(a), m + 0.1 * m * np.cos(a), m + length * m * np.sin(a), m - length * m * np.cos(a)),
            fill=rgb(ink),
            width=wide,
        )
    pen.ellipse((m - 0.06 * m, m - 0.06 * m, m + 0.06 * m, m + 0.06 * m), fill=rgb("signal red"))
    return paint.shrunk(image, (size, size))


def dial(b: MeshBuilder, image: Image.Image, at: tuple[float, float, float], radius: float) -> None:
    """A round image looking along +x."""
    points = np.array([(0.0, y, z) for y, z in ellipse(radius, radius, 28)])
    uv = 0.5 + points[:, 1:] / (2 * radius)
    faces = np.stack([np.zeros(26, int), np.arange(1, 27), np.arange(2, 28)], 1)
    b.add(Shape(points, faces, uv), at=at, image=image)


@recipe("clock", 3, hulls=1, name="house_fixtures.clock")
def clock(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Round wall clock, alarm clock with two bells, wooden mantel clock."""
    b = MeshBuilder(roughness=0.35)
    style = ("wall", "alarm", "mantel")[variant]
    if style == "wall":
        b.cylinder(0.14, 0.03, (0, 0, 0.14), "black", (0, 90, 0), segments=32)
        b.ring(0.128, 0.012, (0.03, 0, 0.14), "charcoal", (0, 90, 0), segments=32, sides=6)
        dial(b, clock_face(96, "white", "black", 10, 9), (0.032, 0, 0.14), 0.124)
    elif style == "alarm":
        b.cylinder(0.05, 0.04, (-0.02, 0, 0.065), "signal red", (0, 90, 0), segments=24)
        b.ring(0.046, 0.006, (0.02, 0, 0.065), "aluminium", (0, 90, 0), segments=24, sides=6)
        dial(b, clock_face(80, "cream", "black", 7, 0), (0.0225, 0, 0.065), 0.045)
        for s in (-1, 1):
            with b.frame((0, 0.03 * s, 0.115), (-28 * s, 0, 0)):
                b.lathe([(0.026, 0.0), (0.024, 0.01), (0.015, 0.02), (0.0, 0.024)], color="aluminium", segments=16)
                b.ball(0.004, (0, 0, 0.026), "aluminium", segments=6, rings=4)
            b.rod((0, 0.024 * s, 0.03), (0, 0.045 * s, 0.0), 0.006, "aluminium", sides=8)
        b.rod((0, 0, 0.11), (0, 0, 0.142), 0.003, "aluminium", sides=6)
        b.ball(0.008, (0, 0, 0.142), "aluminium", segments=8, rings=5)
        b.tube(
            curve([(0, -0.03, 0.14), (0, -0.015, 0.165), (0, 0.015, 0.165), (0, 0.03, 0.14)], 3),
            0.003,
            "aluminium",
            sides=5,
        )
    else:
        arch = [
            (-0.12, 0.03),
            (0.12, 0.03),
            (0.12, 0.16),
            *ellipse(0.12, 0.12, 12, (0, 0.16), 0, 180)[1:-1],
            (-0.12, 0.16),
        ]
        b.extrude(arch, 0.1, (-0.05, 0, 0), "wood", (90, 0, 90))
        b.extrude(rounded(0.13, 0.3, 0.01), 0.03, color="dark wood")
        b.ring(0.09, 0.008, (0.05, 0, 0.16), "brass", (0, 90, 0), segments=26, sides=6)
        b.cylinder(0.088, 0.004, (0.048, 0, 0.16), "brass", (0, 90, 0), segments=26)
        dial(b, clock_face(96, "cream", "dark wood", 2, 20), (0.053, 0, 0.16), 0.084)
        for s in (-1, 1):
            b.lathe(
                [(0.016, 0), (0.01, 0.02), (0.01, 0.1), (0.016, 0.12)],
                (0.055, 0.115 * s, 0.03),
                "dark wood",
                segments=10,
            )
    size = ((0.055, 0.265, 0.275), (0.065, 0.115, 0.17), (0.13, 0.34, 0.32))[variant]
    return varied(b, rng, size, f"a {style} clock", style)


@recipe("sconce", 3, name="house_fixtures.sconce")
def sconce(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Brass arm with a shade, black lantern, two candles on scrolls; the wall plate is at -x."""
    b = MeshBuilder(roughness=0.4)
    style = ("shaded", "lantern", "twin candle")[variant]
    metal: Color = ("brass", "black", "bronze")[variant]
    b.extrude(
        rounded(0.1, 0.16, 0.03) if variant != 2 else ellipse(0.05, 0.09, 20),
        0.014,
        (-0.085, 0, 0.1),
        metal,
        (90, 0, 90),
    )
    if style == "shaded":
        b.tube(curve([(-0.075, 0, 0.1), (-0.03, 0, 0.06), (0.02, 0, 0.07), (0.025, 0, 0.12)], 4), 0.008, metal)
        b.lathe([(0.008, 0), (0.022, 0.01), (0.016, 0.05)], (0.025, 0, 0.11), metal, segments=14)
        shade_profile = [(0.085, 0.0), (0.055, 0.15), (0.05, 0.15), (0.08, 0.0)]
        b.lathe(shade_profile, (0.025, 0, 0.14), "cream", segments=22)
        b.ball((0.028, 0.028, 0.036), (0.025, 0, 0.19), "lamp", segments=10, rings=6)
        for z, r in ((0.14, 0.085), (0.29, 0.053)):
            b.ring(r, 0.003, (0.025, 0, z), metal, segments=22, sides=4)
    elif style == "lantern":
        b.tube(curve([(-0.075, 0, 0.13), (-0.02, 0, 0.23), (0.04, 0, 0.24), (0.04, 0, 0.2)], 4), 0.008, metal)
        with b.frame((0.04, 0, -0.06)):
            b.lathe(
                [(0.075, 0.2), (0.06, 0.225), (0.02, 0.25), (0.012, 0.27)], color=metal, turn_deg=(0, 0, 30), segments=6
            )
            b.lathe([(0.038, 0.03), (0.06, 0.2)], color="lamp", turn_deg=(0, 0, 30), segments=6)
            b.lathe([(0.01, 0.0), (0.02, 0.015), (0.045, 0.03)], color=metal, turn_deg=(0, 0, 30), segments=6)
            for k in range(6):
                a = np.radians(60 * k + 30)
                b.rod(
                    (0.04 * np.cos(a), 0.04 * np.sin(a), 0.03),
                    (0.064 * np.cos(a), 0.064 * np.sin(a), 0.2),
                    0.004,
                    metal,
                    sides=4,
                )
            b.ring(0.053, 0.003, (0, 0, 0.13), metal, segments=6, sides=4)
    else:
        for s in (-1, 1):
            path = [(-0.075, 0, 0.08), (-0.02, 0.03 * s, 0.03), (0.03, 0.08 * s, 0.03), (0.04, 0.09 * s, 0.08)]
            b.tube(curve(path, 4), 0.006, metal)
            with b.frame((0.04, 0.09 * s, 0.08)):
                b.lathe([(0.01, 0.0), (0.034, 0.012), (0.03, 0.016), (0.012, 0.016)], color=metal, segments=14)
                b.cylinder(0.011, 0.09, (0, 0, 0.014), "cream", segments=10)
                b.lathe([(0.004, 0.0), (0.012, 0.016), (0.007, 0.034), (0.0, 0.05)], (0, 0, 0.104), "lamp", segments=10)
        b.ball((0.01, 0.02, 0.03), (-0.07, 0, 0.2), metal, segments=10, rings=6)
    size = ((0.168, 0.195, 0.3), (0.19, 0.2, 0.36), (0.15, 0.28, 0.27))[variant]
    return varied(b, rng, size, f"a {style} wall lamp", style)


@recipe("sewing machine", 2, name="house_fixtures.sewing_machine")
def sewing_machine(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """White electric machine with thread, black cast-iron one with gold lines; seat at +x, needle at the left."""
    b = MeshBuilder(roughness=0.35)
    style = ("white electric", "black cast-iron")[variant]
    body, base = (("white", "light grey"), ("black", "wood"))[variant]
    power = 4.0 if variant == 0 else 2.6
    b.box((0.18, 0.4, 0.05 if variant == 0 else 0.045), color=base, bevel=0.008)
    b.box((0.13, 0.38, 0.018), (0.01, 0, 0.045), body, bevel=0.006)
    # The arm runs along y: a loft along x, turned; its far end is the needle's head.
    with b.frame((0, 0, 0), (0, 0, 90)):
        b.loft(
            [
                level(z, x, y, x=0.13, count=16, power=power)
                for z, x, y in ((0.05, 0.06, 0.06), (0.12, 0.042, 0.045), (0.22, 0.05, 0.052), (0.25, 0.05, 0.05))
            ],
            body,
        )
        b.loft(
            [
                section(x, y, h, 0.232, 16, power)
                for x, y, h in ((-0.19, 0.03, 0.03), (-0.18, 0.045, 0.05), (0.1, 0.042, 0.036), (0.18, 0.05, 0.05))
            ],
            body,
        )
        b.loft(
            [
                level(z, x, y, x=-0.145, count=14, power=power)
                for z, x, y in ((0.12, 0.03, 0.03), (0.14, 0.038, 0.04), (0.24, 0.042, 0.045))
            ],
            body,
        )
    y = -0.145
    b.rod((0, y, 0.065), (0, y, 0.13), 0.004, "aluminium", sides=6)
    b.box((0.03, 0.014, 0.006), (0.012, y, 0.068), "aluminium")
    b.rod((0.0, y + 0.012, 0.068), (0.0, y + 0.012, 0.13), 0.003, "aluminium", sides=5)
    b.box((0.07, 0.09, 0.004), (0.0, y, 0.0625), "aluminium")
    with b.frame((0, 0.182, 0.2), (-90, 0, 0)):
        b.cylinder(0.055, 0.022, (0, 0, 0.006), "aluminium" if variant else "grey", segments=20)
        b.ring(0.05, 0.007, (0, 0, 0.028), "black" if variant == 0 else "aluminium", segments=20, sides=5)
    b.lathe([(0.02, 0), (0.013, 0.006), (0.013, 0.03), (0.02, 0.036)], (0, 0.06, 0.275), "signal red", segments=12)
    b.rod((0, 0.06, 0.27), (0, 0.06, 0.32), 0.003, "aluminium", sides=5)
    b.tube(
        [(0.0, 0.06, 0.3), (0.0, -0.09, 0.29), (0.03, -0.145, 0.28), (0.045, -0.145, 0.15), (0.004, y, 0.09)],
        0.0014,
        "signal red",
        sides=3,
    )
    if variant == 0:
        for k in range(3):
            b.cylinder(
                0.017,
                0.014,
                (0.045, 0.06 + 0.042 * k, 0.236) if k < 2 else (0.05, 0.13, 0.13),
                ("grey", "pink", "teal")[k],
                (0, 90, 0),
                segments=12,
            )
        b.box((0.004, 0.1, 0.03), (0.044, -0.03, 0.222), "pink")
    else:
        for z in (0.225, 0.24):
            b.box((0.003, 0.2, 0.004), (0.0425, -0.02, z), "gold")
        b.box((0.003, 0.004, 0.05), (0.045, 0.13, 0.13), "gold")
        b.cylinder(0.01, 0.04, (0.02, 0.2, 0.2), "dark wood", (-90, 0, 0), segments=8)
    size = ((0.19, 0.42, 0.3), (0.21, 0.44, 0.32))[variant]
    return varied(b, rng, size, f"a {style} sewing machine", style)


@recipe("robot arm", 2, name="house_fixtures.robot_arm")
def robot_arm(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Orange welding robot with a torch, white collaborative arm with a two-finger gripper; it reaches along +x."""
    b = MeshBuilder(roughness=0.4)
    style = ("orange industrial", "white collaborative")[variant]
    arm, joint = (("safety orange", "charcoal"), ("white", "light blue"))[variant]
    thick = 1.0 if variant == 0 else 0.62
    b.cylinder(0.2, 0.03, (0, 0, 0), "dark grey", segments=20)
    b.lathe([(0.17, 0.0), (0.15, 0.16), (0.13, 0.2)], (0, 0, 0.03), arm, segments=20)
    b.box((0.24 * thick + 0.04, 0.2, 0.24), (-0.02, 0, 0.21), arm, bevel=0.04)
    shoulder, elbow, wrist, tip = (
        np.array(p) for p in ((0.06, 0, 0.42), (-0.1, 0, 0.92), (0.34, 0, 0.96), (0.4, 0, 0.74))
    )

    def hinge(at: np.ndarray, radius: float, width: float) -> None:
        b.cylinder(radius, width, at + [0, width / 2, 0], joint, (90, 0, 0), segments=18)
        b.cylinder(radius * 0.6, width + 0.012, at + [0, width / 2 + 0.006, 0], arm, (90, 0, 0), segments=14)

    b.beam(shoulder, elbow, 0.12 * thick, 0.15 * thick, arm, bevel=0.03 * thick)
    b.rod(elbow - [0.06, 0, 0], wrist, 0.062 * thick, arm, sides=14)
    b.beam(wrist, tip + [0, 0, 0.04], 0.08 * thick, 0.09 * thick, arm, bevel=0.02 * thick)
    for at, radius, width in ((shoulder, 0.12, 0.24), (elbow, 0.1, 0.2), (wrist, 0.068, 0.14)):
        hinge(at, radius * (0.4 + 0.6 * thick), width)
    b.cylinder(0.05, 0.05, tip, "dark grey", segments=14)
    if style == "orange industrial":
        b.tube([tip, tip - [0, 0, 0.1], tip + [0.05, 0, -0.17]], [0.022, 0.02, 0.012], "bronze", sides=8)
        b.tube(
            curve(
                [(-0.12, 0.12, 0.3), (-0.24, 0.12, 0.65), (-0.16, 0.11, 0.98), (0.1, 0.09, 1.06), (0.34, 0.06, 1.0)], 4
            ),
            0.02,
            "black",
            sides=6,
        )
    else:
        b.box((0.05, 0.13, 0.05), tip - [0, 0, 0.05], "charcoal", bevel=0.01)
        for s in (-1, 1):
            b.box((0.03, 0.016, 0.11), tip + [0, 0.045 * s, -0.15], "charcoal", bevel=0.004)
    for k in range(6):
        a = np.radians(60 * k)
        b.cylinder(0.014, 0.02, (0.18 * np.cos(a), 0.18 * np.sin(a), 0.025), "aluminium", segments=6)
    size = ((0.63, 0.41, 1.0), (0.7, 0.36, 1.2))[variant]
    return varied(b, rng, size, f"an {style} robot arm" if variant == 0 else f"a {style} robot arm", style)
