"""Functions for the outlines of places and the trajectories along them."""

import math
import random
from collections.abc import Iterable

import shapely
from shapely.geometry.base import BaseGeometry

Corner = tuple[float, float]


def joined(shapes: Iterable[BaseGeometry]) -> shapely.Polygon:
    """Returns the union of overlapping shapes (m) as one outline without holes, on a raster of a millimetre."""
    whole = shapely.set_precision(shapely.union_all(list(shapes)), 0.001)
    parts = [part for part in shapely.get_parts(whole) if isinstance(part, shapely.Polygon)]
    return shapely.Polygon(max(parts, key=lambda part: part.area).exterior)


def inside(outline: BaseGeometry, by: float = 0.03) -> BaseGeometry:
    """Returns the part of an outline at least `by` metres from its border."""
    return outline.buffer(-by, join_style="mitre")


def corners(line: BaseGeometry) -> list[Corner]:
    """Returns the corners (m) of a line."""
    return [(x, y) for x, y in line.coords]


def ring(shape: shapely.Polygon) -> list[Corner]:
    """Returns the corners counter-clockwise, the first repeated at the end; the inside is to the left."""
    return corners(shapely.geometry.polygon.orient(shape).exterior)


def steps(rng: random.Random, low: float, high: float, end: float) -> list[float]:
    """Returns positions from about `low` to `end`, `low` to `high` apart."""
    found, x = [], rng.uniform(low, high)
    while x < end:
        found.append(round(x, 2))
        x += rng.uniform(low, high)
    return found


def winding(rng: random.Random, legs: int, low: float, high: float, most: float) -> list[Corner]:
    """Returns a polyline that bends to both sides, by up to `most` degrees at a bend and never backwards."""
    heading, x, y = rng.uniform(-20.0, 20.0), 0.0, 0.0
    points = [(0.0, 0.0)]
    for _ in range(legs):
        length = rng.uniform(low, high)
        x, y = x + length * math.cos(math.radians(heading)), y + length * math.sin(math.radians(heading))
        points.append((round(x, 2), round(y, 2)))
        turn = rng.uniform(12.0, most)
        heading += -turn if heading > 20.0 or (heading > -20.0 and rng.random() < 0.5) else turn
    return points
