"""Penetrations between placed things, and small moves that end them.

A thing is the prisms over its collision hulls seen from above, each over its own range of heights: a lamp may hang
over a car and a chair may stand under a sunshade, but no two things share a place.
"""

import dataclasses
import math
from collections.abc import Sequence

import numpy as np
import shapely
from shapely import affinity

from ..datatypes import AssetRecord, HullSet, PlacedObject

#: m that two things may share: collision hulls overstate curved shapes by about this much.
TOUCH = 0.01
LIMIT = 0.5  # m, the farthest a thing is moved from where the graph has it
STEP = 0.05  # m
DIRECTIONS = 16
#: Never moved: what is rooted in the ground. Trees and poles stand where the street's rhythm wants them.
ROOTED = frozenset(
    {"tree", "street light", "lamppost", "traffic light", "utility pole", "bus shelter", "fountain", "manhole cover"}
)


@dataclasses.dataclass(frozen=True)
class Prism:
    """A convex outline (m, scene frame) between two heights (m)."""

    outline: shapely.Polygon
    low: float
    high: float


@dataclasses.dataclass
class Body:
    """A placed thing while penetrations are being resolved.

    Attributes:
      placed: where the graph has it.
      record: its asset.
      prisms: its shape at that place.
      offset: (dx, dy) m that it has been moved.
    """

    placed: PlacedObject
    record: AssetRecord
    prisms: list[Prism]
    offset: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        self.low, self.high = min(p.low for p in self.prisms), max(p.high for p in self.prisms)
        self._bounds = shapely.union_all([p.outline for p in self.prisms]).bounds

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        (x0, y0, x1, y1), (dx, dy) = self._bounds, self.offset
        return x0 + dx, y0 + dy, x1 + dx, y1 + dy

    @property
    def rooted(self) -> bool:
        house = self.record.category[0] == "building" and self.record.width >= 3.0
        sign = self.record.category[1] == "traffic signs" and self.record.height > 1.8
        return house or sign or self.record.leaf in ROOTED


def prisms_of(placed: PlacedObject, hulls: HullSet) -> list[Prism]:
    """The shape of a placed asset; hulls that are flat from above are left out."""
    x, y, z = placed.position
    shapes = []
    for corners in hulls.hulls:
        scaled = np.asarray(corners, float) * np.asarray(placed.scale)
        outline = shapely.MultiPoint(scaled[:, :2]).convex_hull
        if not isinstance(outline, shapely.Polygon):
            continue
        turned = affinity.rotate(outline, placed.yaw, origin=(0.0, 0.0), use_radians=True)
        low, high = float(scaled[:, 2].min()), float(scaled[:, 2].max())
        shapes.append(Prism(affinity.translate(turned, x, y), z + low, z + high))
    if not shapes:
        raise ValueError(
            f"object {placed.id!r}: found hulls without area seen from above, needed at least one solid hull."
        )
    return shapes


def _depth(a: shapely.Polygon, b: shapely.Polygon) -> float:
    """Least distance (m) by which one of two convex outlines must move to part from the other; 0 = apart."""
    least = math.inf
    for ring in (np.asarray(a.exterior.coords), np.asarray(b.exterior.coords)):
        edges = np.diff(ring, axis=0)
        lengths = np.linalg.norm(edges, axis=1)
        normals = np.stack([edges[:, 1], -edges[:, 0]], 1)[lengths > 1e-9] / lengths[lengths > 1e-9, None]
        on_a, on_b = np.asarray(a.exterior.coords) @ normals.T, np.asarray(b.exterior.coords) @ normals.T
        gap = np.minimum(on_a.max(0) - on_b.min(0), on_b.max(0) - on_a.min(0))
        least = min(least, float(gap.min()))
        if least <= 0.0:
            return 0.0
    return least


def penetration(a: Body, b: Body, shift: tuple[float, float] | None = None) -> float:
    """Deepest penetration (m, horizontal) between two things; `shift` tries another offset for `a`."""
    ax, ay = a.offset if shift is None else shift
    (x0, y0, x1, y1), (dx, dy) = a._bounds, (ax, ay)
    bx0, by0, bx1, by1 = b.bounds
    if x0 + dx > bx1 or bx0 > x1 + dx or y0 + dy > by1 or by0 > y1 + dy or a.low > b.high or b.low > a.high:
        return 0.0
    deepest = 0.0
    rx, ry = ax - b.offset[0], ay - b.offset[1]
    for p in a.prisms:
        outline = affinity.translate(p.outline, rx, ry) if (rx or ry) else p.outline
        for q in b.prisms:
            if min(p.high, q.high) - max(p.low, q.low) > TOUCH and outline.intersects(q.outline):
                deepest = max(deepest, _depth(outline, q.outline))
    return deepest if deepest > TOUCH else 0.0


def penetrating_pairs(bodies: Sequence[Body]) -> list[tuple[int, int]]:
    """Pairs (i < j) of things that share a place."""
    boxes = np.array([shapely.box(*b.bounds) for b in bodies], dtype=object)
    left, right = shapely.STRtree(boxes).query(boxes, predicate="intersects")
    near = sorted({(int(i), int(j)) for i, j in zip(left, right, strict=True) if i < j})
    return [(i, j) for i, j in near if penetration(bodies[i], bodies[j]) > 0.0]


class Support:
    """The ground that a thing stands on, so that no move takes it over a kerb or onto another surface."""

    def __init__(self, regions: Sequence[tuple[shapely.Polygon, str, tuple[float, float, float]]]) -> None:
        self._regions = regions
        self._tree = shapely.STRtree([r[0] for r in regions])

    def at(self, x: float, y: float) -> list[tuple[float, str]]:
        """(height m, kind) of every region under a point, in order of height."""
        found = self._tree.query(shapely.Point(x, y), predicate="intersects")
        surfaces = []
        for k in found:
            _, kind, (a, b, c) = self._regions[int(k)]
            surfaces.append((a * x + b * y + c, kind))
        return sorted(surfaces)

    def same(self, x: float, y: float, dx: float, dy: float) -> bool:
        """Whether the ground (height within 1 cm and kind) is the same after a move."""
        before, after = self.at(x, y), self.at(x + dx, y + dy)
        if not before or not after:
            return not before and not after
        return any(abs(h - k) < 0.01 and a == b for h, a in before for k, b in after)


def _free_offset(body: Body, bodies: Sequence[Body], support: Support) -> tuple[float, float] | None:
    """The least offset from the graph's place at which the thing touches nothing, or None within `LIMIT`."""
    x0, y0, x1, y1 = body._bounds
    others = []
    for o in bodies:
        bx0, by0, bx1, by1 = o.bounds
        if o is not body and bx0 < x1 + LIMIT and x0 - LIMIT < bx1 and by0 < y1 + LIMIT and y0 - LIMIT < by1:
            others.append(o)
    for ring in range(1, round(LIMIT / STEP) + 1):
        for k in range(DIRECTIONS):
            angle = math.tau * k / DIRECTIONS
            shift = (ring * STEP * math.cos(angle), ring * STEP * math.sin(angle))
            if support.same(*body.placed.position[:2], *shift) and all(
                penetration(body, o, shift) == 0.0 for o in others
            ):
                return shift
    return None


def resolve(bodies: Sequence[Body], support: Support) -> list[tuple[int, int]]:
    """Moves things (changing their `offset`) until none penetrate; returns the pairs that stay.

    Of a pair the movable and lighter thing gives way first, rooted things never. A move is taken only to a place
    where the thing touches nothing at all, so every move lowers the number of penetrations.
    """
    stuck: set[int] = set()
    while True:
        pairs = penetrating_pairs(bodies)
        candidates = {i for pair in pairs for i in pair if not bodies[i].rooted and i not in stuck}
        if not candidates:
            return pairs
        _, _, _, mover = min(
            (not bodies[i].record.movable, bodies[i].placed.mass, bodies[i].placed.id, i) for i in candidates
        )
        shift = _free_offset(bodies[mover], bodies, support)
        if shift is None:
            stuck.add(mover)
        else:
            bodies[mover].offset = shift
            # a place may have become free for those that found none
            stuck.clear()
