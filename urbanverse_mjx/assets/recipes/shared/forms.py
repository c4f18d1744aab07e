"""Solids that grow, are stuffed, wrapped or hollow: fruits, cushions, vessels.

Small objects are drawn in centimetres, near enough to their proportions; `sizes.varied_cm` brings them to their size.
"""

from collections.abc import Sequence

import numpy as np
from scipy.interpolate import PchipInterpolator

from ...meshes import shapes
from ...meshes.mesh_builder import MeshBuilder
from ...meshes.palette import Color
from ...meshes.shapes import Point2, Point3, Points3, Shape
from .outlines import arc


def painted(shape: Shape, axis: int = 2) -> Shape:
    """The shape with UV for a skin wrapped round one of its axes: v runs along the axis, u from the front round both
    sides to the back, mirrored, so that the skin closes without a seam.
    """
    low, high = shape.vertices.min(0), shape.vertices.max(0)
    unit = (shape.vertices - (low + high) / 2) / np.maximum((high - low) / 2, 1e-12)
    across, up = ((1, 2), (0, 2), (0, 1))[axis]
    u = np.abs(np.arctan2(unit[:, up], unit[:, across])) / np.pi
    return Shape(shape.vertices, shape.faces, np.stack([u, (unit[:, axis] + 1) / 2], 1))


def lumpy(shape: Shape, amount: float, rng: np.random.Generator, waves: float = 1.0) -> Shape:
    """The shape with bumps: points move away from its middle by up to `amount` of their distance.

    Args:
      waves: bumps along the shape's length, about.
    """
    middle = (shape.vertices.min(0) + shape.vertices.max(0)) / 2
    reach = np.ptp(shape.vertices, axis=0).max()
    swell = np.zeros(len(shape.vertices))
    for _ in range(6):
        direction = rng.normal(size=3)
        direction *= 2 * np.pi * waves * rng.uniform(0.6, 1.4) / (reach * np.linalg.norm(direction))
        swell += np.sin(shape.vertices @ direction + rng.uniform(0, 2 * np.pi)) / 3.0
    vertices = middle + (shape.vertices - middle) * (1 + amount * np.clip(swell, -1, 1))[:, None]
    return Shape(vertices, shape.faces, shape.uv)


def ribbed(shape: Shape, count: int, depth: float, phase: float = 0.0) -> Shape:
    """The shape with `count` grooves from pole to pole about z, `depth` of its radius deep."""
    angle = np.arctan2(shape.vertices[:, 1], shape.vertices[:, 0])
    factor = 1 - depth * (1 - np.abs(np.sin(angle * count / 2 + phase)))
    vertices = shape.vertices * np.stack([factor, factor, np.ones_like(factor)], 1)
    return Shape(vertices, shape.faces, shape.uv)


def pillow(size: Point3, plan: float = 0.5, side: float = 0.5, segments: int = 20, rings: int = 10) -> Shape:
    """A rounded block standing on z = 0 (a superellipsoid).

    Args:
      size: (x, y, z).
      plan, side: roundness seen from above and from the side: 1 an ellipse, 0.5 a cushion, 0.2 a block.
    """

    def bent(values: np.ndarray, power: float) -> np.ndarray:
        return np.sign(values) * np.abs(values) ** power

    around = (np.arange(segments) + 0.5) * 2 * np.pi / segments
    rows = []
    for up in np.linspace(-np.pi / 2, np.pi / 2, rings + 1):
        reach = bent(np.cos(up), side) if abs(up) < 1.57 else np.float64(0.0)  # exactly a point at the poles
        x, y = reach * bent(np.cos(around), plan), reach * bent(np.sin(around), plan)
        rows.append(np.stack([x, y, np.full(segments, bent(np.sin(up), side))], 1))
    skin = shapes.loft(rows, caps=True)
    half = np.abs(skin.vertices).max(0)
    return Shape(skin.vertices / half * (np.asarray(size, float) / 2) + [0, 0, size[2] / 2], skin.faces)


def stadium(length: float, width: float, corner: float, count: int = 5) -> list[Point2]:
    """Outline of a rectangle with round corners about the origin, `length` along x, counter-clockwise.

    `outlines.rounded` has other last bits, and these outlines' meshes are frozen.
    """
    points = []
    for k, (sx, sy) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
        turn = arc(corner, 90 * k, 90 * k + 90, count)
        points += [(sx * (length / 2 - corner) + x, sy * (width / 2 - corner) + y) for x, y in turn.tolist()]
    return points


def softened(profile: Sequence[Point2], count: int = 15) -> list[Point2]:
    """The profile (radius, z) redrawn as a smooth curve through its points, for bodies that have grown."""
    points = np.asarray(profile, float)
    run = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    curve = PchipInterpolator(run, points)(np.linspace(0, run[-1], count))
    return [(max(float(r), 0.0), float(z)) for r, z in curve]


def bead(path: Points3, radii: Sequence[float], sides: int = 10) -> Shape:
    """A round body along a path with a radius at each point, shut at its ends (a banana, a finger, a sausage)."""
    return shapes.tube(path, [max(r, 1e-3) for r in radii], sides)


def vessel(profile: Sequence[Point2], wall: float, floor: float) -> list[Point2]:
    """The profile (radius, z) of an open vessel: up its outside, over the rim and down its inside.

    Args:
      profile: the outside from the foot to the rim.
      wall: thickness of the side.
      floor: height of the inner ground.
    """
    inside = [(r - wall, max(z, floor)) for r, z in reversed(profile) if z > floor and r > wall]
    return [(0.0, profile[0][1]), *profile, *inside, (0.0, floor)]


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
