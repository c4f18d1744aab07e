"""Outlines, curves and cross sections that objects are drawn with."""

from collections.abc import Sequence

import numpy as np
from PIL import Image

from ...meshes.mesh_builder import MeshBuilder
from ...meshes.shapes import Point2, Point3


def rounded(width: float, height: float, radius: float, steps: int = 4, at: Point2 = (0.0, 0.0)) -> list[Point2]:
    """A rectangle with round corners, centred on `at`, counter-clockwise; `steps` edges a corner."""
    half_w, half_h = width / 2 - radius, height / 2 - radius
    points: list[Point2] = []
    for k, (sx, sy) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
        for a in np.linspace(0, np.pi / 2, steps + 1) + k * np.pi / 2:
            x, y = at[0] + sx * half_w + radius * np.cos(a), at[1] + sy * half_h + radius * np.sin(a)
            points.append((float(x), float(y)))
    return points


def ellipse(
    radius_x: float, radius_y: float, count: int = 20, at: Point2 = (0.0, 0.0), start: float = 0.0, end: float = 360.0
) -> list[Point2]:
    """Points on an ellipse about `at`, degrees `start` to `end` (the whole round does not repeat its first point)."""
    whole = abs(end - start) >= 360.0
    angles = np.radians(np.linspace(start, end, count, endpoint=not whole))
    return [(float(at[0] + radius_x * np.cos(a)), float(at[1] + radius_y * np.sin(a))) for a in angles]


def arc(
    radius: float, start_deg: float, end_deg: float, count: int = 12, at: Point2 = (0.0, 0.0), squash: float = 1.0
) -> np.ndarray:
    """(count, 2) points of an arc about `at`, both ends among them; `squash` scales its second coordinate."""
    angles = np.radians(np.linspace(start_deg, end_deg, count))
    return np.stack([at[0] + radius * np.cos(angles), at[1] + squash * radius * np.sin(angles)], 1)


def curve(points: Sequence[Point3], steps: int = 4, closed: bool = False) -> np.ndarray:
    """(n, 2 or 3) points of a Catmull-Rom spline through the points, `steps` edges between two."""
    p = np.asarray(points, float)
    padded = np.vstack([p[-1:], p, p[:2]]) if closed else np.vstack([2 * p[0] - p[1], p, 2 * p[-1] - p[-2]])
    rows = []
    for k in range(len(padded) - 3):
        a, b, c, d = padded[k : k + 4]
        for t in np.arange(steps) / steps:
            cubic = (3 * b - a - 3 * c + d) * t**3 + (2 * a - 5 * b + 4 * c - d) * t**2
            rows.append(0.5 * (cubic + (c - a) * t + 2 * b))
    return np.array(rows if closed else [*rows, p[-1]])


def pairs(points: np.ndarray) -> list[Point2]:
    """(n, 2) array as a list of points, for `MeshBuilder.extrude` and `lathe`."""
    return [(float(x), float(y)) for x, y in points]


def mirrored(half: Sequence[Point2]) -> list[Point2]:
    """An outline from its left half, drawn as (along, away from the axis); points on the axis are kept once."""
    other = [(x, -y) for x, y in reversed(half) if abs(y) > 1e-9]
    return [*half, *other]


def section(x: float, half_y: float, half_z: float, z: float = 0.0, count: int = 12, power: float = 2.0) -> np.ndarray:
    """(count, 3) superellipse across x, for lofts along x: power 2 is an ellipse, 4 nearly a rectangle."""
    a = (np.arange(count) + 0.5) * (2 * np.pi / count)
    c, s = np.cos(a), np.sin(a)
    y = half_y * np.sign(c) * np.abs(c) ** (2 / power)
    return np.stack([np.full(count, x), y, z + half_z * np.sign(s) * np.abs(s) ** (2 / power)], 1)


def level(z: float, half_x: float, half_y: float, x: float = 0.0, count: int = 16, power: float = 2.0) -> np.ndarray:
    """(count, 3) superellipse in a level plane, for lofts along z."""
    a = (np.arange(count) + 0.5) * (2 * np.pi / count)
    c, s = np.cos(a), np.sin(a)
    px = x + half_x * np.sign(c) * np.abs(c) ** (2 / power)
    return np.stack([px, half_y * np.sign(s) * np.abs(s) ** (2 / power), np.full(count, z)], 1)


def desk_panel(b: MeshBuilder, image: Image.Image, at: Point3, across: float, depth: float) -> None:
    """An image lying face up, legible from +x: `across` along y, `depth` along x."""
    b.panel(image.rotate(180), at, across, depth, "+z")
