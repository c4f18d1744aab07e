"""Soft and wrapped shapes, painted skins and labels of small objects.

They are drawn in centimetres, near enough to their proportions; `sizes.varied_cm` brings them to their size in metres.
"""

from collections.abc import Sequence

import numpy as np
from PIL import Image
from scipy.interpolate import PchipInterpolator

from ...meshes import paint, shapes
from ...meshes.mesh_builder import ImageLike, MeshBuilder
from ...meshes.palette import Color, rgb
from ...meshes.shapes import Point2, Point3, Points3, Shape
from .outlines import arc

# Shapes ---------------------------------------------------------------------------------------------------------------


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
      wall: thickness of the side; floor: height of the inner ground.
    """
    inside = [(r - wall, max(z, floor)) for r, z in reversed(profile) if z > floor and r > wall]
    return [(0.0, profile[0][1]), *profile, *inside, (0.0, floor)]


def patch(
    b: MeshBuilder,
    image: ImageLike,
    radius: float | tuple[float, float],
    low: float,
    high: float,
    arc_deg: float = 150.0,
    facing_deg: float = 0.0,
) -> None:
    """A label bent round a standing vessel: radius (or that at its lower and upper edge), heights, degrees it covers.

    One that goes nearly round shows its image on the front and again on the back.
    """
    if arc_deg > 200:
        for turn_deg in (0, 180):
            patch(b, image, radius, low, high, arc_deg / 2, facing_deg + turn_deg)
        return
    columns = int(arc_deg / 12) + 2
    first, last = radius if isinstance(radius, tuple) else (radius, radius)
    turns = np.radians(facing_deg + np.linspace(-arc_deg / 2, arc_deg / 2, columns))
    rows = [
        np.stack([r * np.cos(turns), r * np.sin(turns), np.full(columns, z)], 1)
        for r, z in ((first, low), (last, high))
    ]
    b.sheet(np.stack(rows), image=image)


# Skins ----------------------------------------------------------------------------------------------------------------


def skin(
    rng: np.random.Generator,
    colors: Sequence[Color],
    blush: Color | None = None,
    noise: float = 5.0,
    flecks: tuple[Color, int] | None = None,
    size: tuple[int, int] = (32, 48),
) -> np.ndarray:
    """(h, w, 3) image for `painted` shapes: colours from the bottom to the top, a blush on the front, flecks.

    Args:
      noise: standard deviation, 0-255.
      flecks: colour and number of single dots.
      size: (width, height) pixels.
    """
    width, height = size
    stops = np.array([rgb(c) for c in colors], float)
    at = np.linspace(0, len(stops) - 1, height)[::-1]
    column = np.stack([np.interp(at, np.arange(len(stops)), stops[:, k]) for k in range(3)], 1)
    image = np.repeat(column[:, None], width, 1)
    if blush is not None:
        share = np.clip(1.1 - 1.5 * np.linspace(0, 1, width), 0, 0.85)[None, :, None]
        image = image * (1 - share) + share * np.array(rgb(blush), float)
    image = image + rng.normal(0, noise, (height, width, 1))
    if flecks is not None:
        rows, columns = rng.integers(1, height - 1, flecks[1]), rng.integers(0, width, flecks[1])
        image[rows, columns] = rgb(flecks[0])
    return np.clip(image, 0, 255).astype(np.uint8)


def weave(first: Color, second: Color, size: int = 64, strand: int = 4) -> np.ndarray:
    """(size, size, 3) basket work: strands over and under in turn, darker where they dip."""
    y, x = np.mgrid[:size, :size]
    over = (x // (2 * strand) + y // strand) % 2 == 0
    depth = np.where(over, np.abs((x % (2 * strand)) / strand - 1), np.abs((y % strand) / strand * 2 - 1))
    base = np.where(over[..., None], np.array(rgb(first), float), np.array(rgb(second), float))
    return np.clip(base * (1.05 - 0.45 * depth[..., None]), 0, 255).astype(np.uint8)


def label(
    words: str,
    color: Color,
    ink: Color,
    size: tuple[int, int] = (64, 48),
    band: Color | None = None,
    bold: float = 0.03,
) -> Image.Image:
    """A printed label: words between two bands."""
    image, draw = paint.canvas(paint.smooth(size, 2), color)
    width, height = image.size
    if band is not None:
        draw.rectangle((0, 0, width, height * 0.14), fill=rgb(band))
        draw.rectangle((0, height * 0.86, width, height), fill=rgb(band))
    paint.text(draw, words, (width * 0.08, height * 0.22, width * 0.92, height * 0.78), ink, bold=bold)
    return paint.shrunk(image, size)
