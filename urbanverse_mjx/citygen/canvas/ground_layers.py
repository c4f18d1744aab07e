"""Layered ground: a later area keeps its outline, and earlier ones are cut away under it.

The resulting regions tile without overlap. They are simple rings without holes on a fine raster, and neighbours share
their corners.
"""

import dataclasses
import itertools
import math
from collections.abc import Iterable, Sequence

import shapely
import shapely.ops

from ...datatypes import GroundRegion, ValidationError
from ...datatypes.ground import height_at
from ...geometry.polygons import MAX_OVERLAP

Corner = tuple[float, float]
Plane = tuple[float, float, float]

#: m, raster of all corners. Along a long skewed seam a coarser raster leaves overlaps that the compiler refuses.
GRID = 1e-5
#: m², fragments of regions up to this area are dropped: no object fits on them.
MAX_FRAGMENT_AREA = 1e-4


@dataclasses.dataclass(frozen=True)
class Layer:
    """A piece of ground as drawn: name, kind, outline (m) and top z = a x + b y + c."""

    name: str
    kind: str
    outline: shapely.Polygon
    plane: Plane


def level(z: float) -> Plane:
    return (0.0, 0.0, z)


def plane_through(points: Sequence[tuple[float, float, float]]) -> Plane:
    """Returns the plane through three points (x, y, z), rounded so that seams stay level within a micrometre.

    Raises:
      ValidationError: the points are in one line as seen from above.
    """
    (x0, y0, z0), (x1, y1, z1), (x2, y2, z2) = points
    area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
    if abs(area) < 1e-9:
        raise ValidationError(f"plane: found three points in one line, {points}; needed a triangle; move one of them.")
    a = ((z1 - z0) * (y2 - y0) - (z2 - z0) * (y1 - y0)) / area
    b = ((x1 - x0) * (z2 - z0) - (x2 - x0) * (z1 - z0)) / area
    c = z0 - a * x0 - b * y0
    return (round(a, 9) + 0.0, round(b, 9) + 0.0, round(c, 9) + 0.0)  # never -0.0


def outline(corners: Iterable[Corner]) -> shapely.Polygon:
    """Returns a polygon snapped to the raster.

    Raises:
      ValidationError: the ring crosses itself or has no area.
    """
    ring = shapely.Polygon([(round(x, 3), round(y, 3)) for x, y in corners])
    if not ring.is_valid or ring.area < MAX_FRAGMENT_AREA:
        found = shapely.is_valid_reason(ring) if not ring.is_valid else "a ring without area"
        raise ValidationError(f"outline: found {found}; needed a simple ring; put its corners in order.")
    return ring


def rectangle(x0: float, y0: float, x1: float, y1: float) -> list[Corner]:
    """Returns the corners of an axis-aligned rectangle."""
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


def disc(x: float, y: float, radius: float, corners: int = 16) -> list[Corner]:
    """Returns the corners of a regular polygon on a circle."""
    turn = math.tau / corners
    return [(x + radius * math.cos(turn * i), y + radius * math.sin(turn * i)) for i in range(corners)]


def polar(middle: Corner, degrees: float, reach: float) -> Corner:
    """Returns the point `reach` metres from a centre in a direction, counter-clockwise from +x."""
    return middle[0] + reach * math.cos(math.radians(degrees)), middle[1] + reach * math.sin(math.radians(degrees))


def strip(points: Sequence[Corner], width: float) -> list[Corner]:
    """Returns the corners of a band of the given width (m) around a polyline, with square ends and mitred bends."""
    band = shapely.LineString(points).buffer(width / 2, cap_style="flat", join_style="mitre")
    return [(x, y) for x, y in band.exterior.coords[:-1]]


def layer_at(layers: Sequence[Layer], x: float, y: float) -> Layer:
    """Returns the uppermost layer at a point.

    Raises: ValidationError: no ground there.
    """
    point = shapely.Point(x, y)
    for layer in reversed(layers):
        if layer.outline.intersects(point):
            return layer
    raise ValidationError(f"ground: found none at ({x:g}, {y:g}); needed some under it; lay it first.")


def top_at(layers: Sequence[Layer], x: float, y: float) -> float:
    """Returns the height (m) of the uppermost layer at a point."""
    return height_at(layer_at(layers, x, y).plane, x, y)


@dataclasses.dataclass(frozen=True)
class Cut:
    """A straight line (m) that splits the visible part of one layer, or of all layers if no name is given.

    Convex pieces need fewer prisms. Engines find prisms by axis-aligned boxes, so long ones at an angle are tested more
    often than necessary.
    """

    layer: str | None
    start: Corner
    end: Corner


def tiles(layers: Sequence[Layer], cuts: Sequence[Cut] = ()) -> list[GroundRegion]:
    """Returns the visible part of every layer as regions, in the order of the layers."""
    covered: shapely.Geometry = shapely.Polygon()
    visible: list[tuple[Layer, list[shapely.Polygon]]] = []
    for layer in reversed(layers):
        rest = shapely.difference(layer.outline, covered, grid_size=GRID)
        parts = [p for p in shapely.get_parts(rest) if isinstance(p, shapely.Polygon) and p.area > MAX_FRAGMENT_AREA]
        parts = [q for p in parts for q in _without_holes(p)]
        for cut in (c for c in cuts if c.layer in (None, layer.name)):
            parts = [q for p in parts for q in _parted(p, cut)]
        visible.append((layer, parts))
        covered = shapely.union(covered, layer.outline, grid_size=GRID)
    regions = []
    for layer, parts in reversed(visible):
        parts.sort(key=lambda p: p.bounds)
        for number, part in enumerate(parts):
            name = layer.name if len(parts) == 1 else f"{layer.name}_{number}"
            regions.append(GroundRegion(name, layer.kind, _ring(part), layer.plane))
    return regions


def _without_holes(part: shapely.Polygon) -> list[shapely.Polygon]:
    """Returns the part, cut through its holes until no piece has any."""
    if not part.interiors:
        return [part]
    x = round(part.interiors[0].centroid.x, 3)
    x0, y0, x1, y1 = part.bounds
    halves = [shapely.box(x0, y0, x, y1), shapely.box(x, y0, x1, y1)]
    pieces = [q for half in halves for q in shapely.get_parts(shapely.intersection(part, half, grid_size=GRID))]
    return [
        r for q in pieces if isinstance(q, shapely.Polygon) and q.area > MAX_FRAGMENT_AREA for r in _without_holes(q)
    ]


def _parted(part: shapely.Polygon, cut: Cut) -> list[shapely.Polygon]:
    pieces = shapely.get_parts(shapely.ops.split(part, shapely.LineString([cut.start, cut.end])))
    on_grid = [q for p in pieces for q in shapely.get_parts(shapely.set_precision(p, GRID))]
    return [q for q in on_grid if isinstance(q, shapely.Polygon) and q.area > MAX_FRAGMENT_AREA]


def _ring(part: shapely.Polygon) -> tuple[Corner, ...]:
    corners = [(round(x, 5), round(y, 5)) for x, y in shapely.normalize(part).exterior.coords[:-1]]
    return tuple(corners)


def dropped_kerb(
    layers: Sequence[Layer], name: str, foot: Corner, degrees: float, half_width: float, run: float, flare: float
) -> tuple[list[Layer], list[Cut]]:
    """Returns a ramp from the road up to the pavement with its two flares, and the cuts of the pavement beside it.

    Args:
      foot: on the kerb, middle of the ramp's lower edge.
      degrees: uphill, counter-clockwise from +x.
      half_width, run, flare: m, half the ramp's width, its length uphill, and how long the kerb tapers beside it.

    The flares' planes meet the ramp's and the pavement's along whole edges, so only the kerb itself is a step.
    """
    angle = math.radians(degrees)
    up, along = (math.cos(angle), math.sin(angle)), (math.sin(angle), -math.cos(angle))

    def at(right: float, ahead: float) -> Corner:
        return (
            round(foot[0] + right * along[0] + ahead * up[0], 3),
            round(foot[1] + right * along[1] + ahead * up[1], 3),
        )

    low, high = top_at(layers, *at(0.0, -0.05)), top_at(layers, *at(0.0, run + 0.05))
    left, right, left_top, right_top = at(-half_width, 0), at(half_width, 0), at(-half_width, run), at(half_width, run)
    slope = plane_through([(*left, low), (*right, low), (*left_top, high)])
    found = [Layer(name, "sidewalk", outline([left, right, right_top, left_top]), slope)]
    for side, inner, top in ((-1, left, left_top), (1, right, right_top)) if flare else ():
        outer = at(side * (half_width + flare), 0)
        tilt = plane_through([(*outer, high), (*inner, low), (*top, high)])
        ring = outline([outer, inner, top])
        found.append(Layer(f"{name}_flare_{'a' if side < 0 else 'b'}", "sidewalk", ring, tilt))
    behind = layer_at(layers, *at(0.0, run + 0.05)).name
    sides = [Cut(behind, at(side * half_width, run - 0.2), at(side * half_width, run + 30.0)) for side in (-1, 1)]
    return found, sides


def stairs(
    layers: Sequence[Layer], name: str, foot: Corner, degrees: float, width: float, count: int, tread: float = 0.32
) -> list[Layer]:
    """Returns `count` treads of equal height from the ground before `foot` to the ground behind the last one."""
    angle = math.radians(degrees)
    up, along = (math.cos(angle), math.sin(angle)), (math.sin(angle), -math.cos(angle))

    def at(right: float, ahead: float) -> Corner:
        return foot[0] + right * along[0] + ahead * up[0], foot[1] + right * along[1] + ahead * up[1]

    low, high = top_at(layers, *at(0.0, -0.05)), top_at(layers, *at(0.0, count * tread + 0.05))
    found = []
    for i in range(count):
        near, far, half = i * tread, (i + 1) * tread, width / 2
        ring = outline([at(-half, near), at(half, near), at(half, far), at(-half, far)])
        z = round(low + (high - low) * (i + 1) / (count + 1), 4)
        found.append(Layer(f"{name}_{i}", "sidewalk", ring, level(z)))
    return found


def seams(regions: Sequence[GroundRegion]) -> list[str]:
    """Returns the faults of the tiling: overlaps, and gaps between neighbours."""
    shapes = [shapely.Polygon(r.polygon) for r in regions]
    found = []
    for (a, p), (b, q) in itertools.combinations(zip(regions, shapes, strict=True), 2):
        if p.intersects(q) and p.intersection(q).area > MAX_OVERLAP:
            found.append(f"{a.id} and {b.id} share {p.intersection(q).area:.4f} m²")
    whole = shapely.union_all(shapes, grid_size=GRID)
    for part in shapely.get_parts(whole):
        for hole in part.interiors:
            if 5 * MAX_FRAGMENT_AREA < shapely.Polygon(hole).area < 0.5:
                x, y = hole.centroid.x, hole.centroid.y
                found.append(f"a slit of {shapely.Polygon(hole).area:.4f} m² at ({x:.2f}, {y:.2f})")
    return found
