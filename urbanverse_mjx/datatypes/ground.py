"""Kinds of ground and their meaning for physics and for a robot on the pavement.

The numbers index `SceneBank.map_kind` and `maps.npz`; the names are those of CraftBench-Nav's maps
(docs/sources/reference_systems.md b.2), so that its routes and maps can be exchanged.
"""

import itertools
import math
from collections.abc import Sequence

import numpy as np

from . import validation as v

GROUND_KINDS = ("none", "road", "road_marking", "crosswalk", "sidewalk", "ground")
KIND_INDEX = {name: i for i, name in enumerate(GROUND_KINDS)}
#: Paint on top of another region: it is drawn, has no collision prism and may overlap.
PAINT_KINDS = ("road_marking",)
#: Where a pavement robot may be. Leaving these ends an episode as "off the traversable area".
TRAVERSABLE_KINDS = ("crosswalk", "sidewalk", "ground")
#: m, farthest coordinate: beyond it single precision resolves less than a centimetre.
LIMIT = 1e5
#: Steepest top: 2 is 63°.
MAX_SLOPE = 2.0


def traversable(kind: np.ndarray) -> np.ndarray:
    """Bool of the same shape: where a pavement robot may be, for kinds by number."""
    # Comparisons of whole maps are several times faster than a table look-up.
    found = kind == KIND_INDEX[TRAVERSABLE_KINDS[0]]
    for name in TRAVERSABLE_KINDS[1:]:
        found |= kind == KIND_INDEX[name]
    return found


def check_plane(value: object, where: str) -> tuple[float, ...]:
    """(a, b, c) of a top z = a x + b y + c.

    Raises:
      ValidationError: not three finite numbers, or steeper than `MAX_SLOPE`.
    """
    plane = v.vector(value, where, 3, minimum=-LIMIT, maximum=LIMIT)
    if max(abs(plane[0]), abs(plane[1])) > MAX_SLOPE:
        raise v.fail(where, v.show(plane), f"slopes of at most {MAX_SLOPE:g} (63°)", "z = a x + b y + c")
    return plane


def polygon_area(polygon: Sequence[Sequence[float]]) -> float:
    """Signed area (m^2) of a closed ring of (x, y); positive when counter-clockwise."""
    ring = [*polygon, polygon[0]]
    return 0.5 * sum(a[0] * b[1] - b[0] * a[1] for a, b in itertools.pairwise(ring))


def _cross(o: Sequence[float], a: Sequence[float], b: Sequence[float]) -> float:
    return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])


def _segments_meet(p: Sequence[float], q: Sequence[float], r: Sequence[float], s: Sequence[float]) -> bool:
    d1, d2, d3, d4 = _cross(r, s, p), _cross(r, s, q), _cross(p, q, r), _cross(p, q, s)
    if ((d1 > 0) != (d2 > 0)) and ((d3 > 0) != (d4 > 0)) and 0.0 not in (d1, d2, d3, d4):
        return True

    def on(a: Sequence[float], b: Sequence[float], c: Sequence[float], d: float) -> bool:
        return d == 0.0 and min(a[0], b[0]) <= c[0] <= max(a[0], b[0]) and min(a[1], b[1]) <= c[1] <= max(a[1], b[1])

    return on(r, s, p, d1) or on(r, s, q, d2) or on(p, q, r, d3) or on(p, q, s, d4)


def check_polygon(value: object, where: str, maximum: int = 512) -> tuple[tuple[float, float], ...]:
    """A simple ring of at least three corners, returned counter-clockwise.

    Raises:
      ValidationError: fewer than three corners, a repeated corner, edges that cross, or no area.
    """
    raw = v.items(value, where, minimum=3, maximum=maximum)
    ring = [v.vector(corner, f"{where}[{i}]", 2, minimum=-LIMIT, maximum=LIMIT) for i, corner in enumerate(raw)]
    n = len(ring)
    for i in range(n):
        if math.dist(ring[i], ring[(i + 1) % n]) < 1e-6:
            raise v.fail(f"{where}[{i}]", "the same corner twice in a row", "distinct corners", "remove one")
    for i in range(n):
        for j in range(i + 2, n):
            if i == 0 and j == n - 1:
                continue
            if _segments_meet(ring[i], ring[i + 1], ring[j], ring[(j + 1) % n]):
                raise v.fail(
                    where,
                    f"edges {i} and {j} that cross or touch",
                    "a ring that does not cross itself",
                    "split it into simple polygons",
                )
    area = polygon_area(ring)
    if abs(area) < 1e-4:
        raise v.fail(where, f"an area of {abs(area):.2g} m²", "a polygon of at least 1 cm²", "remove the region")
    return tuple((x, y) for x, y in (ring if area > 0 else reversed(ring)))


def height_at(plane: Sequence[float], x: float, y: float) -> float:
    """Height (m) of the planar top z = a x + b y + c."""
    a, b, c = plane
    return a * x + b * y + c
