"""Upholstered and hollow forms that recipes of several folders use."""

from collections.abc import Sequence

import numpy as np

from ...meshes import shapes
from ...meshes.mesh_builder import MeshBuilder
from ...meshes.palette import Color
from ...meshes.shapes import Point2, Point3


def soft(
    b: MeshBuilder,
    size: Point3,
    at: Point3,
    color: Color,
    turn_deg: Point3 = (0, 0, 0),
    plan: float = 6.0,
    side: float = 3.5,
    segments: int = 16,
    rings: int = 8,
) -> None:
    """A padded block standing on `at`: a superellipsoid of exponents `plan` seen from above and `side` from the side.

    2 is round, 10 nearly a block.
    """
    ball = shapes.ellipsoid(1.0, segments, rings)
    x, y, z = np.abs(ball.vertices.T)
    across = (x**plan + y**plan) ** (1.0 / plan)
    points = ball.vertices / ((across**side + z**side) ** (1.0 / side))[:, None]
    half = np.asarray(size, float) / 2
    placed = shapes.Shape(points * half + np.array([0.0, 0.0, half[2]]), ball.faces)
    b.add(placed, color, at, turn_deg, crease_deg=60.0)


def pouch(
    b: MeshBuilder, size: Point3, at: Point3, color: Color, turn_deg: Point3 = (0, 0, 0), plan: float = 5.0
) -> None:
    """A stuffed cover lying on `at`, thick in the middle, thin at its seam (cushions, pillows)."""
    ball = shapes.ellipsoid(1.0, 20, 8)
    x, y, z = ball.vertices.T
    level = np.maximum(np.hypot(x, y), 1e-9)
    square = level / np.maximum((np.abs(x) ** plan + np.abs(y) ** plan) ** (1.0 / plan), 1e-9)
    # Corners are drawn out a little, as the seams of a cover do.
    plump = np.sign(z) * np.abs(z) ** 1.25
    half = np.asarray(size, float) / 2
    points = np.column_stack([x * square, y * square, plump]) * half + np.array([0.0, 0.0, half[2]])
    b.add(shapes.Shape(points, ball.faces), color, at, turn_deg, crease_deg=75.0)


def hollow(
    b: MeshBuilder,
    outside: Sequence[Point2],
    wall: float,
    color: Color,
    at: Point3 = (0, 0, 0),
    segments: int = 20,
    floor: float | None = None,
) -> None:
    """An open vessel: the profile (radius, z) revolved, with an inner skin `wall` away and a bottom inside."""
    floor = outside[0][1] + wall if floor is None else floor
    heights = [z for _, z in outside]
    radii = [r for r, _ in outside]
    inner = [(max(r - wall, 0.002), z) for r, z in reversed(outside) if z > floor + 1e-6]
    bottom = (max(float(np.interp(floor, heights, radii)) - wall, 0.002), floor)
    b.lathe([*outside, *inner, bottom, (0.0, floor)], at, color, segments=segments)
