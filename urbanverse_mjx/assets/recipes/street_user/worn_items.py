"""Clothes and bags of people."""

import numpy as np

from ...meshes.palette import Color, shade
from .figure import Figure


def backpack(figure: Figure, color: Color, size: float = 1.0) -> None:
    h = figure.person.height
    at = figure.trunk(0.20)
    with figure.builder.frame(
        (at[0] - (0.070 + 0.045 * size) * h * figure.person.girth, at[1], at[2]), (0, figure.pose.lean, 0)
    ):
        figure.builder.box(
            (0.085 * h * size, 0.165 * h * size, 0.235 * h * size), color=color, bevel=0.02 * h, centered=True
        )
        figure.builder.box(
            (0.03 * h, 0.12 * h * size, 0.10 * h * size),
            (-0.05 * h * size, 0, -0.055 * h * size),
            shade(color, 0.8),
            bevel=0.01 * h,
            centered=True,
        )
    for side in (-1, 1):
        y = side * 0.058 * h
        points = [
            figure.trunk(z) + [d * h * figure.person.girth, y, 0]
            for z, d in ((0.285, -0.055), (0.312, 0.0), (0.27, 0.068), (0.17, 0.066), (0.13, 0.02))
        ]
        figure.builder.tube(points, 0.012 * h, shade(color, 0.7), sides=5)


def shoulder_bag(figure: Figure, color: Color) -> None:
    h = figure.person.height
    hip = figure.trunk(0.0) + [0, -0.135 * h * figure.person.girth, -0.02 * h]
    figure.builder.box((0.16 * h, 0.05 * h, 0.12 * h), tuple(hip), color, bevel=0.012, centered=True)
    strap = [
        hip + [0.0, 0.01, 0.05 * h],
        figure.trunk(0.17) + [0.072 * h * figure.person.girth, -0.03 * h, 0],
        figure.trunk(0.305) + [0.0, 0.055 * h, 0],
        figure.trunk(0.17) + [-0.075 * h * figure.person.girth, -0.03 * h, 0],
    ]
    figure.builder.tube(strap, 0.007 * h, shade(color, 0.75), sides=4, closed=True)


def carried_bag(figure: Figure, k: int, color: Color, size: tuple[float, float, float] = (0.30, 0.12, 0.34)) -> None:
    """A bag hanging from hand k (0 left, 1 right)."""
    x, y, z = figure.hands[k]
    for dx in (-0.06, 0.06):
        figure.builder.rod((x, y, z), (x + dx, y, z - 0.18), 0.006, shade(color, 0.6), sides=4)
    figure.builder.box(size, (x, y, z - 0.18 - size[2]), color, bevel=0.015)


def cap(figure: Figure, color: Color, kind: str = "cap") -> None:
    """A baseball cap, a helmet, a police cap or a knitted hat."""
    rx, ry, rz = figure.head_radii
    b = figure.builder
    with b.frame(tuple(figure.head_center), (0, -6, figure.pose.turn)):
        if kind == "police":
            b.lathe(
                [
                    (ry * 1.10, 0.0),
                    (ry * 1.12, rz * 0.28),
                    (ry * 1.5, rz * 0.62),
                    (ry * 1.35, rz * 0.72),
                    (0.01, rz * 0.78),
                ],
                (-rx * 0.05, 0, rz * 0.42),
                color,
                segments=16,
            )
            b.cylinder(ry * 1.135, rz * 0.10, (-rx * 0.05, 0, rz * 0.50), "white", segments=16)
            b.ball((rx * 0.1, ry * 0.2, rz * 0.12), (rx * 1.05, 0, rz * 0.78), "gold", segments=6, rings=4)
            visor, level = rx * 0.55, rz * 0.42
        else:
            grow = {"cap": 1.13, "helmet": 1.24, "beanie": 1.14}[kind]
            profile = [(grow * np.cos(a), grow * np.sin(a)) for a in np.radians([0, 25, 50, 72, 89])]
            with b.frame((-rx * 0.04, 0, rz * 0.30), scale=(rx, ry, rz * 0.78)):
                b.lathe([(grow * 1.0, -0.16), *profile], color=color, segments=16, crease_deg=60)
            if kind == "beanie":
                b.ball(0.22 * rx, (-rx * 0.04, 0, rz * 1.24), shade(color, 1.3), segments=8, rings=5)
                return
            visor, level = (rx * 0.75 if kind == "cap" else rx * 0.40), rz * 0.22
        brim = [
            (rx * 0.75, ry * 0.95),
            (rx * 1.05 + visor * 0.8, ry * 0.62),
            (rx * 1.05 + visor, 0.0),
            (rx * 1.05 + visor * 0.8, -ry * 0.62),
            (rx * 0.75, -ry * 0.95),
        ]
        b.extrude(brim, rz * 0.06, (0, 0, level), "black" if kind == "police" else shade(color, 0.85))


def vest(figure: Figure, color: Color, stripe: Color = "light grey") -> None:
    """A high-visibility waistcoat with two bands and braces."""
    b = figure.builder
    rows = (
        (0.0, 0.104, 0.076),
        (0.10, 0.094, 0.070),
        (0.20, 0.106, 0.075),
        (0.255, 0.112, 0.069),
        (0.288, 0.094, 0.058),
        (0.306, 0.066, 0.047),
    )
    b.loft([figure.ring(*r) for r in rows], color, crease_deg=60)
    for low in (0.055, 0.145):
        wide = np.interp([low, low + 0.028], [r[0] for r in rows], [r[1] for r in rows]) + 0.002
        deep = np.interp([low, low + 0.028], [r[0] for r in rows], [r[2] for r in rows]) + 0.002
        b.loft([figure.ring(low, wide[0], deep[0]), figure.ring(low + 0.028, wide[1], deep[1])], stripe, crease_deg=60)
