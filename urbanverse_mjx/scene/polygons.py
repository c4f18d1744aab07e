"""Exact convex decomposition of simple polygons."""

from collections.abc import Sequence

import numpy as np
import shapely

#: m^2; corners with a smaller cross product count as straight.
_STRAIGHT_TOLERANCE = 1e-9
#: Number of merge orders to try.
_MERGE_ORDERS = 64

Ring = list[int]


def without_straight_corners(polygon: np.ndarray) -> np.ndarray:
    """(n, 2) ring without the corners that lie on the line between their neighbours."""
    ring = np.asarray(polygon, np.float64)
    while len(ring) > 3:
        before, after = np.roll(ring, 1, 0), np.roll(ring, -1, 0)
        turn = _cross(ring - before, after - ring)
        scale = np.linalg.norm(ring - before, axis=1) * np.linalg.norm(after - ring, axis=1)
        straight = np.flatnonzero(np.abs(turn) <= _STRAIGHT_TOLERANCE * np.maximum(scale, 1.0))
        if not len(straight):
            break
        ring = np.delete(ring, straight[0], 0)
    return ring


def convex_parts(polygon: np.ndarray, max_corners: int = 8) -> list[np.ndarray]:
    """Splits a simple counter-clockwise ring (n, 2) into few convex rings that cover it exactly.

    The only cuts are diagonals that remove a reflex corner or limit a convex part to `max_corners`. Corners of the
    parts are corners of the polygon, so no corner is rounded.
    """
    ring = without_straight_corners(polygon)
    rings = [list(range(len(ring)))]
    reflex = int(np.sum(_turns(ring, rings[0]) < -_STRAIGHT_TOLERANCE))
    if reflex:
        rings = _fewest(ring, _triangles(ring), bound=(reflex + 1) // 2 + 1)
    rings = [part for whole in rings for part in _chunks(whole, max_corners)]
    # Collinear corners, such as ramp tops along a pavement, may leave triangles without area.
    return [ring[part] for part in rings if shapely.Polygon(ring[part]).area > _STRAIGHT_TOLERANCE]


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _turns(corners: np.ndarray, ring: Ring) -> np.ndarray:
    p = corners[ring]
    return _cross(p - np.roll(p, 1, 0), np.roll(p, -1, 0) - p)


def _triangles(corners: np.ndarray) -> list[Ring]:
    """Constrained Delaunay triangles as counter-clockwise rings of corner numbers."""
    number = {tuple(c): i for i, c in enumerate(corners)}
    rings = []
    for triangle in shapely.get_parts(shapely.constrained_delaunay_triangles(shapely.Polygon(corners))):
        ring = [number[tuple(xy)] for xy in shapely.get_coordinates(triangle)[:3]]
        rings.append(ring if _turns(corners, ring)[0] > 0 else ring[::-1])
    return rings


def _fewest(corners: np.ndarray, triangles: list[Ring], bound: int) -> list[Ring]:
    """Tries several merge orders and returns the fewest parts; stops at the theoretical minimum."""
    generator = np.random.default_rng(0)
    best: list[Ring] = triangles
    for attempt in range(_MERGE_ORDERS):
        parts = _merge(corners, triangles, None if attempt == 0 else generator)
        if len(parts) < len(best):
            best = parts
        if len(best) <= bound:
            break
    return best


def _merge(corners: np.ndarray, triangles: list[Ring], generator: np.random.Generator | None) -> list[Ring]:
    """Removes every diagonal whose removal leaves a convex part, the longest first or in random order."""
    owner: dict[tuple[int, int], int] = {}
    parts: dict[int, Ring] = dict(enumerate(triangles))
    for number, ring in parts.items():
        owner |= dict.fromkeys(zip(ring, ring[1:] + ring[:1], strict=True), number)
    diagonals = [edge for edge in owner if edge[0] < edge[1] and edge[::-1] in owner]
    if generator is None:
        diagonals.sort(key=lambda e: -float(np.linalg.norm(corners[e[0]] - corners[e[1]])))
    else:
        generator.shuffle(diagonals)
    for a, b in (tuple(map(int, d)) for d in diagonals):
        left, right = owner[a, b], owner[b, a]
        merged = _join(parts[left], parts[right], a, b)
        if left != right and (_turns(corners, merged) >= -_STRAIGHT_TOLERANCE).all():
            del parts[right]
            parts[left] = merged
            owner |= dict.fromkeys(zip(merged, merged[1:] + merged[:1], strict=True), left)
    return list(parts.values())


def _join(left: Ring, right: Ring, a: int, b: int) -> Ring:
    """The ring around two parts that share the edge a-b (a to b in `left`)."""
    i, j = left.index(b), right.index(a)
    return [*(left[i:] + left[:i]), *(right[j:] + right[:j])[1:-1]]


def _chunks(ring: Ring, most: int) -> list[Ring]:
    """Splits a convex ring into rings of at most `most` corners that share the first corner."""
    parts = []
    while len(ring) > most:
        parts.append(ring[:most])
        ring = [ring[0], *ring[most - 1 :]]
    return [*parts, ring]


def triangulate(polygon: np.ndarray) -> np.ndarray:
    """(m, 3) int32 triangles over the corners of a simple counter-clockwise ring."""
    return np.array(_triangles(np.asarray(polygon, np.float64)), np.int32).reshape(-1, 3)


def union_area(rings: Sequence[np.ndarray]) -> float:
    """Area (m^2) covered by the rings together."""
    return float(shapely.union_all([shapely.Polygon(r) for r in rings]).area)
