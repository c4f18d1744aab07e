"""Plain solids as vertices and faces: every function returns a `Shape` whose faces are counter-clockwise seen from
outside.

Upright solids (box, frustum, lathe, extrusion) stand on z = 0, centred on the z axis; round ones (ellipsoid, torus)
are centred on the origin. Lengths in metres. Vertices are shared between faces; `MeshBuilder` splits them at creases.
"""

import dataclasses
import math
from collections.abc import Sequence

import numpy as np
import shapely
import trimesh
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import ConvexHull

Point2 = tuple[float, float]
Point3 = Sequence[float] | np.ndarray
Points3 = Sequence[Point3] | np.ndarray


@dataclasses.dataclass(frozen=True)
class Shape:
    """Triangles without a material.

    Attributes:
      vertices: (V, 3) float, m.
      faces: (F, 3) int, counter-clockwise from outside.
      uv: (V, 2) in [0, 1] within an image, or None for parts of one colour.
    """

    vertices: np.ndarray
    faces: np.ndarray
    uv: np.ndarray | None = None

    def transformed(self, matrix: np.ndarray) -> "Shape":
        """The shape transformed by a (4, 4) affine matrix; mirroring also reverses the orientation of the faces."""
        vertices = product(self.vertices, matrix[:3, :3].T) + matrix[:3, 3]
        faces = self.faces[:, ::-1] if np.linalg.det(matrix[:3, :3]) < 0 else self.faces
        return Shape(vertices, faces, self.uv)

    def flipped(self) -> "Shape":
        """The same triangles seen from the other side."""
        return Shape(self.vertices, self.faces[:, ::-1], self.uv)


def product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Matrix product of (n, k) and (k, m) with the same rounding on every machine.

    BLAS fuses multiplications and additions on some processors only. The last bit may decide whether an edge is sharp
    and how a flat polygon is triangulated, and thereby the key of a mesh's hulls (`hulls.mesh_key`).
    """
    total = a[:, 0, None] * b[0]
    for k in range(1, len(b)):
        total = total + a[:, k, None] * b[k]
    return total


def length(vector: np.ndarray) -> float:
    """Length of a vector (3,) with the same rounding on every machine, like `product`."""
    x, y, z = vector.tolist()
    return math.sqrt(x * x + y * y + z * z)


def merged(shapes: Sequence[Shape]) -> Shape:
    """One shape of several (without UV)."""
    offsets = np.cumsum([0] + [len(s.vertices) for s in shapes[:-1]])
    faces = [s.faces + o for s, o in zip(shapes, offsets, strict=True)]
    return Shape(np.concatenate([s.vertices for s in shapes]), np.concatenate(faces))


def convex(points: Points3) -> Shape:
    """The convex hull of (n, 3) points."""
    points = np.asarray(points, float)
    hull = ConvexHull(points)
    faces = hull.simplices.copy()
    a, b, c = (points[faces[:, i]] for i in range(3))
    inwards = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0
    faces[inwards] = faces[inwards][:, ::-1]
    used, inverse = np.unique(faces, return_inverse=True)
    return Shape(points[used], inverse.reshape(faces.shape))


def box(size: Point3, bevel: float = 0.0, taper: Point2 = (1.0, 1.0)) -> Shape:
    """A box of size (x, y, z) standing on z = 0; `bevel` cuts all edges, `taper` scales the top's x and y."""
    half = np.asarray(size, float) / 2
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    if bevel <= 0:
        points = signs * half
    else:
        cut = min(bevel, 0.49 * float(size[0]), 0.49 * float(size[1]), 0.49 * float(size[2]))
        points = np.concatenate([signs * (half - cut * (1 - np.eye(3)[axis])) for axis in range(3)])
    points[:, 2] += half[2]
    weight = points[:, 2:3] / size[2]
    points[:, :2] *= 1 + weight * (np.asarray(taper) - 1)
    return convex(points)


def ring(radius: float, segments: int, z: float = 0.0, phase: float = 0.0) -> np.ndarray:
    """(segments, 3) points on a horizontal circle, counter-clockwise from above."""
    angle = np.arange(segments) * (2 * np.pi / segments) + phase
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), np.full(segments, z)], 1)


def loft(sections: Sequence[np.ndarray], caps: bool = True, closed: bool = False) -> Shape:
    """Skin through cross sections of equal length, each (n, 3) and counter-clockwise seen from the loft's far end.

    Caps are fans around each end's centre; `closed` joins the last section to the first.
    """
    rows = np.stack([np.asarray(s, float) for s in sections])
    count, n, _ = rows.shape
    pairs = count if closed else count - 1
    i, j = np.meshgrid(np.arange(pairs), np.arange(n), indexing="ij")
    low, high, step = i * n, ((i + 1) % count) * n, (j + 1) % n
    quads = np.stack([low + j, low + step, high + step, high + j], -1).reshape(-1, 4)
    faces = [quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]
    vertices = [rows.reshape(-1, 3)]
    if caps and not closed:
        centres = np.array([rows[0].mean(0), rows[-1].mean(0)])
        vertices.append(centres)
        k, nxt, base = np.arange(n), (np.arange(n) + 1) % n, count * n
        faces.append(np.stack([np.full(n, base), nxt, k], 1))
        faces.append(np.stack([np.full(n, base + 1), (count - 1) * n + k, (count - 1) * n + nxt], 1))
    return welded(Shape(np.concatenate(vertices), np.concatenate(faces)))


def frustum(bottom: float, top: float, height: float, segments: int = 16) -> Shape:
    """Cylinder (equal radii), cone (top 0) or anything between."""
    return loft([ring(bottom, segments), ring(top, segments, height)])


def lathe(profile: Sequence[Point2], segments: int = 16) -> Shape:
    """A profile of (radius, z), from bottom to top, revolved about z; the ends are closed."""
    return loft([ring(r, segments, z) for r, z in profile])


def ellipsoid(radii: Point3 | float, segments: int = 14, rings: int = 8) -> Shape:
    """A sphere or ellipsoid centred on the origin."""
    r = np.broadcast_to(np.asarray(radii, float), 3)
    angles = np.linspace(-np.pi / 2, np.pi / 2, rings + 1)
    ball = loft([ring(max(np.cos(a), 0.0), segments, np.sin(a)) for a in angles], caps=False)
    return Shape(ball.vertices * r, ball.faces)


def capsule(radius: float, length: float, segments: int = 12, rings: int = 4) -> Shape:
    """Round-ended rod along z, from z = 0 to z = length (length >= 2 radius)."""
    low = [(radius * np.cos(a), radius + radius * np.sin(a)) for a in np.linspace(-np.pi / 2, 0, rings + 1)]
    high = [(r, length - z) for r, z in reversed(low)]
    return lathe(low + high, segments)


def torus(radius: float, thickness: float, segments: int = 24, sides: int = 8) -> Shape:
    """A ring about z, centred on the origin; `thickness` is the radius of the tube."""
    angles = np.arange(segments) * (2 * np.pi / segments)
    circle = ring(thickness, sides)
    sections = [
        np.stack(
            [
                (radius + circle[:, 0]) * np.cos(a),
                (radius + circle[:, 0]) * np.sin(a),
                circle[:, 1],
            ],
            1,
        )[::-1]
        for a in angles
    ]
    return loft(sections, closed=True)


def extrusion(outline: Sequence[Point2], height: float, holes: Sequence[Sequence[Point2]] = ()) -> Shape:
    """A polygon in xy (either sense, may be concave, may have holes) raised from z = 0 to `height`."""
    polygon = shapely.geometry.polygon.orient(shapely.Polygon(outline, holes))
    if not polygon.is_valid:
        raise ValueError(
            "extrusion: found an outline that crosses itself, needed a simple polygon; reorder its points."
        )
    points, caps = trimesh.creation.triangulate_polygon(polygon, engine="earcut")
    a, b, c = (points[caps[:, i]] for i in range(3))
    clockwise = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0] < 0
    caps[clockwise] = caps[clockwise][:, ::-1]
    bottom = Shape(np.column_stack([points, np.zeros(len(points))]), caps[:, ::-1])
    top = Shape(np.column_stack([points, np.full(len(points), height)]), caps)
    sides = []
    for loop in (polygon.exterior, *polygon.interiors):
        edge = np.array(loop.coords)[:-1, :2]
        rows = [np.column_stack([edge, np.full(len(edge), z)]) for z in (0.0, height)]
        sides.append(loft(rows, caps=False))
    return welded(merged([bottom, top, *sides]))


def tube(path: Points3, radius: float | Sequence[float], sides: int = 8, closed: bool = False) -> Shape:
    """A pipe along a polyline; `radius` may be one number or one per point. Frames are carried without twist."""
    points = np.asarray(path, float)
    radii = np.broadcast_to(np.asarray(radius, float), len(points))
    ahead = np.roll(points, -1, 0) - points
    if closed:
        tangent = ahead / np.linalg.norm(ahead, axis=1, keepdims=True)
        tangent = tangent + np.roll(tangent, 1, 0)
    else:
        ahead[-1] = ahead[-2]
        unit = ahead / np.linalg.norm(ahead, axis=1, keepdims=True)
        tangent = unit + np.vstack([unit[:1], unit[:-1]])
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    side = np.cross(tangent[0], np.eye(3)[int(np.argmin(np.abs(tangent[0])))])
    angles = np.arange(sides) * (2 * np.pi / sides)
    sections = []
    for p, t, r in zip(points, tangent, radii, strict=True):
        side = side - t * (side * t).sum()
        side = side / length(side)
        other = np.cross(t, side)
        sections.append(p + r * (np.cos(angles)[:, None] * side + np.sin(angles)[:, None] * other))
    return loft(sections, closed=closed)


def quad(corners: Points3) -> Shape:
    """A rectangle of an image: lower left, lower right, upper right, upper left corner, seen from its visible side."""
    uv = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    return Shape(np.asarray(corners, float), np.array([(0, 1, 2), (0, 2, 3)]), uv)


def fan(corners: np.ndarray) -> Shape:
    """A flat convex polygon facing +x, (n, 3) counter-clockwise from its front, UV over its box."""
    flat = corners[:, 1:]
    uv = (flat - flat.min(0)) / (flat.max(0) - flat.min(0))
    k = np.arange(1, len(corners) - 1)
    return Shape(corners, np.stack([np.zeros_like(k), k, k + 1], 1), uv)


def sheet(grid: np.ndarray) -> Shape:
    """A curved surface through (rows, columns, 3) points, UV over the grid (columns right, rows up)."""
    grid = np.asarray(grid, float)
    rows, columns, _ = grid.shape
    i, j = np.meshgrid(np.arange(rows - 1), np.arange(columns - 1), indexing="ij")
    a = i * columns + j
    quads = np.stack([a, a + 1, a + columns + 1, a + columns], -1).reshape(-1, 4)
    u, v = np.meshgrid(np.linspace(0, 1, columns), np.linspace(0, 1, rows))
    faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return Shape(grid.reshape(-1, 3), faces, np.stack([u.ravel(), v.ravel()], 1))


def welded(shape: Shape, quantum: float = 1e-6) -> Shape:
    """Shares vertices that lie at the same place (shapes without UV)."""
    keys = np.round(shape.vertices / quantum).astype(np.int64)
    _, first, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    return _clean(Shape(shape.vertices[first], inverse.reshape(-1)[shape.faces]))


def _clean(shape: Shape) -> Shape:
    """Removes triangles without area (poles of a sphere, tips of a cone)."""
    a, b, c = (shape.vertices[shape.faces[:, i]] for i in range(3))
    keep = np.linalg.norm(np.cross(b - a, c - a), axis=1) > 1e-12
    return Shape(shape.vertices, shape.faces[keep], shape.uv)


def joined(parts: Sequence[Shape], uvs: Sequence[np.ndarray]) -> Shape:
    """The parts as one shape, with other texture coordinates, (n, 2) for each part."""
    starts = np.cumsum([0, *(len(p.vertices) for p in parts[:-1])])
    faces = [p.faces + start for p, start in zip(parts, starts, strict=True)]
    return Shape(np.concatenate([p.vertices for p in parts]), np.concatenate(faces), np.concatenate(uvs))


def split_at_creases(shape: Shape, crease_deg: float | np.ndarray, parts: Sequence[int] | None = None) -> Shape:
    """Splits vertices so that only faces across edges with less bend than the crease share them; drops unused vertices.

    Args:
      crease_deg: one number, or (f,) one per face.
      parts: number of faces of each part of `shape`; parts share no vertices (None: one part).
    """
    faces = shape.faces
    a, b, c = (shape.vertices[faces[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-15)
    corners = np.arange(faces.size).reshape(-1, 3)
    start, end = faces.ravel(), np.roll(faces, -1, 1).ravel()
    at_start, at_end = corners.ravel(), np.roll(corners, -1, 1).ravel()
    count = len(shape.vertices)
    forward, backward = start.astype(np.int64) * count + end, end.astype(np.int64) * count + start
    # Processed by part, so that the choice between two equal edges does not depend on other parts.
    ends = np.cumsum(parts if parts is not None else [len(faces)])[:-1] * 3
    blocks = np.split(forward, ends)
    order = np.concatenate([first + np.argsort(b, kind="stable") for first, b in zip([0, *ends], blocks, strict=True)])
    found = np.clip(np.searchsorted(forward[order], backward), 0, len(order) - 1)
    other = order[found]
    least = np.broadcast_to(np.cos(np.radians(crease_deg)), len(faces))
    face = np.arange(faces.size) // 3
    smooth = (forward[other] == backward) & (np.einsum("ij,ij->i", normals[face], normals[other // 3]) > least[face])
    rows = np.concatenate([at_start[smooth], at_end[smooth]])
    columns = np.concatenate([at_end[other[smooth]], at_start[other[smooth]]])
    graph = coo_matrix((np.ones(len(rows)), (rows, columns)), shape=(faces.size, faces.size))
    _, group = connected_components(graph, directed=False)
    _, first, inverse = np.unique(group, return_index=True, return_inverse=True)
    chosen = start[first]
    return Shape(shape.vertices[chosen], inverse.reshape(-1, 3), None if shape.uv is None else shape.uv[chosen])


def volume(shape: Shape) -> float:
    """m^3 enclosed, 0 for an open surface."""
    start, end = shape.faces.ravel(), np.roll(shape.faces, -1, 1).ravel()
    # An edge in either direction is encoded as one number, which sorts faster than rows.
    edges = np.sort(np.minimum(start, end).astype(np.int64) * len(shape.vertices) + np.maximum(start, end))
    pairs = edges.reshape(-1, 2) if len(edges) % 2 == 0 else None
    if pairs is None or (pairs[:, 0] != pairs[:, 1]).any() or (pairs[1:, 0] == pairs[:-1, 0]).any():
        return 0.0
    a, b, c = (shape.vertices[shape.faces[:, i]] for i in range(3))
    return abs(float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6)
