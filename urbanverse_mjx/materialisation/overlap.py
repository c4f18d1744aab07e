"""Finds penetrations between placed objects and resolves them by small movements.

An object is represented by vertical prisms over the outlines of its collision hulls, each with its range of heights, so
that a lamp may hang above a car and a chair may stand under a sunshade.
"""

import dataclasses
import math
from collections.abc import Iterable, Sequence

import numpy as np
import shapely
import shapely.ops

from ..datatypes import PAINT_KINDS, AssetRecord, GraphObject, GroundRegion, HullSet, PlacedGround, PlacedObject
from ..datatypes import validation as v
from ..geometry.polygons import rectangle

#: m, tolerated penetration; collision hulls of curved shapes are too large by about this much.
PENETRATION_TOLERANCE = 0.01
MAX_MOVE = 0.5  # m, largest movement of an object from its position in the graph
STEP = 0.05  # m
#: m, highest step that is a kerb; m of a step and m² of overlap below which an object stands next to the kerb.
HIGHEST_KERB, KERB_TOUCH, SHARED_KERB = 0.35, 0.02, 1e-3
DIRECTIONS = 16
#: Objects anchored in the ground, which are never moved, so that trees and poles keep their regular spacing.
ROOTED = frozenset(
    {"tree", "street light", "lamppost", "traffic light", "utility pole", "bus shelter", "fountain", "manhole cover"}
)


@dataclasses.dataclass(frozen=True)
class Prism:
    """A convex outline between two heights.

    Attributes:
      corners: (n, 2) m, the outline's corners in order, scene frame.
      normals: (n, 2) unit normals of its edges.
      low, high: m, the range of heights.
    """

    corners: np.ndarray
    normals: np.ndarray
    low: float
    high: float


@dataclasses.dataclass
class Body:
    """A placed object while penetrations are being resolved.

    Attributes:
      placed: the object at its position in the graph.
      record: record of its asset.
      prisms: its shape at that position.
      offset: (dx, dy) m, movement so far.
    """

    placed: PlacedObject
    record: AssetRecord
    prisms: list[Prism]
    offset: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        #: (prisms, 6) lower and upper x, y, z of every prism, and (6,) of the whole object, without the offset.
        self.boxes = np.array([[*p.corners.min(0), p.low, *p.corners.max(0), p.high] for p in self.prisms])
        self.box = np.concatenate([self.boxes[:, :3].min(0), self.boxes[:, 3:].max(0)])

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Lower and upper x, y with the offset."""
        dx, dy = self.offset
        return self.box[0] + dx, self.box[1] + dy, self.box[3] + dx, self.box[4] + dy

    @property
    def distance(self) -> float:
        """m, length of the movement, rounded to millimetres."""
        return round(math.hypot(*self.offset), 3)

    @property
    def rooted(self) -> bool:
        house = self.record.category[0] == "building" and self.record.width >= 3.0
        sign = self.record.category[1] == "traffic signs" and self.record.height > 1.8
        return house or sign or self.record.leaf in ROOTED


def moved(body: Body, lift: float = 0.0) -> PlacedObject:
    """The placed object with its offset, raised by `lift` m."""
    x, y, z = body.placed.position
    dx, dy = body.offset
    return dataclasses.replace(body.placed, position=(round(x + dx, 4), round(y + dy, 4), round(z + lift, 4)))


def prisms_of(placed: PlacedObject, hulls: HullSet) -> list[Prism]:
    """The shape of a placed asset; hulls that are flat from above are left out.

    Raises:
      ValidationError: no hull has an area seen from above.
    """
    x, y, z = placed.position
    c, s = math.cos(placed.yaw), math.sin(placed.yaw)
    shapes = []
    for corners in hulls.hulls:
        scaled = np.asarray(corners, float) * np.asarray(placed.scale)
        outline = shapely.MultiPoint(scaled[:, :2]).convex_hull
        if not isinstance(outline, shapely.Polygon):
            continue
        ring = np.asarray(outline.exterior.coords)[:-1] @ np.array([[c, s], [-s, c]]) + (x, y)
        edges = np.roll(ring, -1, axis=0) - ring
        normals = np.stack([edges[:, 1], -edges[:, 0]], 1) / np.linalg.norm(edges, axis=1, keepdims=True)
        shapes.append(Prism(ring, normals, z + float(scaled[:, 2].min()), z + float(scaled[:, 2].max())))
    if not shapes:
        where = f"object {placed.id!r} ({placed.asset_uid})"
        raise v.fail(
            where, "hulls without area in the ground plane", "at least one solid hull", "rebuild the asset's hulls"
        )
    return shapes


def _depth(a: Prism, b: Prism, shift: np.ndarray) -> float:
    """Penetration depth (m): the shortest movement that separates two convex outlines; 0 if they are apart.

    `shift` (2,) is added to the corners of `a`. By the separating axis theorem only the edges' normals are tested.
    """
    normals = np.concatenate([a.normals, b.normals])
    on_a, on_b = (a.corners + shift) @ normals.T, b.corners @ normals.T
    gap = np.minimum(on_a.max(0) - on_b.min(0), on_b.max(0) - on_a.min(0))
    return max(float(gap.min()), 0.0)


def penetration(a: Body, b: Body, offset: tuple[float, float] | None = None) -> float:
    """Deepest horizontal penetration (m) between two objects; `offset` replaces that of `a`."""
    shift = np.subtract(a.offset if offset is None else offset, b.offset)
    move = np.array([shift[0], shift[1], 0.0])
    low, high = a.box[:3] + move, a.box[3:] + move
    if (low >= b.box[3:] - PENETRATION_TOLERANCE).any() or (b.box[:3] >= high - PENETRATION_TOLERANCE).any():
        return 0.0
    starts, ends = a.boxes[:, None, :3] + move, a.boxes[:, None, 3:] + move
    shared = np.minimum(ends, b.boxes[None, :, 3:]) - np.maximum(starts, b.boxes[None, :, :3])
    deepest = 0.0
    for i, j in np.argwhere((shared > PENETRATION_TOLERANCE).all(-1)):
        deepest = max(deepest, _depth(a.prisms[i], b.prisms[j], shift))
    return deepest if deepest > PENETRATION_TOLERANCE else 0.0


def penetrating_pairs(bodies: Sequence[Body]) -> list[tuple[int, int]]:
    """Pairs (i < j) of objects that penetrate each other."""
    boxes = np.array([shapely.box(*b.bounds) for b in bodies], dtype=object)
    left, right = shapely.STRtree(boxes).query(boxes, predicate="intersects")
    near = sorted({(int(i), int(j)) for i, j in zip(left, right, strict=True) if i < j})
    return [(i, j) for i, j in near if penetration(bodies[i], bodies[j]) > 0.0]


def ground_box(obj: GraphObject) -> shapely.Polygon:
    """Footprint of a graph object's box."""
    return rectangle(*obj.size[:2], obj.yaw, *obj.center[:2])


class Support:
    """The ground under objects; used to reject movements over a kerb or onto another surface."""

    def __init__(self, regions: Sequence[tuple[shapely.Polygon, str, tuple[float, float, float]]]) -> None:
        self._regions = regions
        self._tree = shapely.STRtree([r[0] for r in regions])

    @staticmethod
    def of(ground: Iterable[GroundRegion | PlacedGround]) -> "Support":
        """That of ground without what is painted on it."""
        return Support([(shapely.Polygon(r.polygon), r.kind, r.plane) for r in ground if r.kind not in PAINT_KINDS])

    def at(self, x: float, y: float) -> list[tuple[float, str]]:
        """(height m, kind) of every region under a point, in order of height."""
        found = self._tree.query(shapely.Point(x, y), predicate="intersects")
        surfaces = []
        for k in found:
            _, kind, (a, b, c) = self._regions[int(k)]
            surfaces.append((a * x + b * y + c, kind))
        return sorted(surfaces)

    def under(self, obj: GraphObject) -> list[float]:
        """Height (m) of every region under a box, each at its point nearest to the centre of the box.

        The centre alone does not suffice: the centre of a lamp's box may be above the road while the lamp stands on the
        pavement.
        """
        box = ground_box(obj)
        middle, heights = shapely.Point(obj.center[:2]), []
        for k in sorted(int(k) for k in self._tree.query(box, predicate="intersects")):
            ring, _, (a, b, c) = self._regions[k]
            near = shapely.ops.nearest_points(ring.intersection(box), middle)[0]
            heights.append(a * near.x + b * near.y + c)
        return heights

    def near(self, obj: GraphObject, reach: float) -> list[float]:
        """Height (m) of the region nearest to an object's centre, at its nearest point; empty beyond `reach` m."""
        return self.near_point(*obj.center[:2], reach)

    def near_point(self, x: float, y: float, reach: float) -> list[float]:
        """Like `near`, for a point."""
        middle = shapely.Point(x, y)
        found = self._tree.query_nearest(middle, max_distance=reach, all_matches=False)
        if not len(found):
            return []
        ring, _, (a, b, c) = self._regions[int(found[0])]
        place = shapely.ops.nearest_points(ring, middle)[0]
        return [a * place.x + b * place.y + c]

    def in_kerb(self, body: Body, offset: tuple[float, float]) -> bool:
        """Whether an object on the ground penetrates adjacent higher ground, such as a wheel in a kerb."""
        foot = body.placed.position[2]
        for prism in body.prisms:
            if prism.low > foot + HIGHEST_KERB:
                continue
            outline = shapely.Polygon(prism.corners + np.array(offset))
            for k in self._tree.query(outline, predicate="intersects"):
                ring, _, (a, b, c) = self._regions[int(k)]
                shared = ring.intersection(outline)
                if shared.area > SHARED_KERB:
                    height = a * shared.centroid.x + b * shared.centroid.y + c
                    if max(foot, prism.low) + KERB_TOUCH < height <= foot + HIGHEST_KERB:
                        return True
        return False

    def step_up(self, body: Body) -> float:
        """m by which an object must be raised to stand on the pavement that it penetrates below its origin."""
        if not self.in_kerb(body, body.offset):
            return 0.0
        x, y, z = body.placed.position
        heights = [h - z for h, _ in self.at(x + body.offset[0], y + body.offset[1])]
        return max((h for h in heights if 0.0 < h <= HIGHEST_KERB), default=0.0)

    def carries(self, body: Body, offset: tuple[float, float]) -> bool:
        """Whether the ground below an object's origin has the object's height after a movement."""
        x, y, z = body.placed.position
        return any(abs(h - z) < 0.01 for h, _ in self.at(x + offset[0], y + offset[1]))

    def same(self, x: float, y: float, dx: float, dy: float) -> bool:
        """Whether the ground (height within 1 cm, and kind) is the same after a movement."""
        before, after = self.at(x, y), self.at(x + dx, y + dy)
        if not before or not after:
            return not before and not after
        return any(abs(h - k) < 0.01 and a == b for h, a in before for k, b in after)


def _within_reach(body: Body, bounds: tuple[float, float, float, float]) -> bool:
    """Whether an object could touch a rectangle (lower and upper x, y) after any allowed movement."""
    x0, y0, x1, y1 = body.box[[0, 1, 3, 4]]
    bx0, by0, bx1, by1 = bounds
    return bool(bx0 < x1 + MAX_MOVE and x0 - MAX_MOVE < bx1 and by0 < y1 + MAX_MOVE and y0 - MAX_MOVE < by1)


def free_offset(body: Body, bodies: Sequence[Body], support: Support, kerbs: bool) -> tuple[float, float] | None:
    """The smallest offset within `MAX_MOVE` at which the object has no contact; None if there is none."""
    stuck = kerbs and support.in_kerb(body, body.offset)
    others = [o for o in bodies if o is not body and _within_reach(body, o.bounds)]
    for ring in range(1, round(MAX_MOVE / STEP) + 1):
        for k in range(DIRECTIONS):
            angle = math.tau * k / DIRECTIONS
            shift = (ring * STEP * math.cos(angle), ring * STEP * math.sin(angle))
            here = support.carries(body, shift) if stuck else support.same(*body.placed.position[:2], *shift)
            if here and all(penetration(body, o, shift) == 0.0 for o in others):
                if not (kerbs and support.in_kerb(body, shift)):
                    return shift
    return None


def resolve(bodies: Sequence[Body], support: Support, kerbs: bool = False) -> list[tuple[int, int]]:
    """Moves objects (by changing their `offset`) to resolve penetrations; returns the pairs that remain.

    With `kerbs`, objects are also moved out of higher ground that they penetrate, if possible.

    Of a pair, the movable or lighter object is moved first; anchored objects are never moved. Objects are moved only to
    positions without contact, so every movement reduces the number of penetrations.
    """
    pairs, stuck = penetrating_pairs(bodies), set[int]()
    # A pair of equal indices is an object that penetrates a kerb.
    pairs += [(i, i) for i, body in enumerate(bodies) if kerbs and support.in_kerb(body, body.offset)]
    while True:
        candidates = {i for pair in pairs for i in pair if not bodies[i].rooted and i not in stuck}
        if not candidates:
            return [pair for pair in pairs if pair[0] != pair[1]]
        _, _, _, mover = min(
            (not bodies[i].record.movable, bodies[i].placed.mass, bodies[i].placed.id, i) for i in candidates
        )
        left_behind = bodies[mover].bounds
        shift = free_offset(bodies[mover], bodies, support, kerbs)
        if shift is None:
            stuck.add(mover)
            continue
        bodies[mover].offset = shift
        pairs = [pair for pair in pairs if mover not in pair]
        # the position that it left may now be free for another object
        stuck = {i for i in stuck if not _within_reach(bodies[i], left_behind)}
