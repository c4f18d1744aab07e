"""Bodies of cars, vans and buses: a side outline with wheel arches, a width that varies, rounded edges.

`Body` places everything else on that surface: patches across the car (windscreen, grille, lights, plates) are
addressed by s (position along the upper outline, 0 = rear bottom, whole numbers = its points) and t (-1 right, 1 left);
patches on the flanks (windows, doors, writing) by (x, z).
"""

import dataclasses
import functools
import itertools
from collections.abc import Sequence

import numpy as np
import shapely

from ...meshes.mesh_builder import BuiltAsset, ImageLike, MeshBuilder
from ...meshes.palette import Color
from ...meshes.shapes import Point2, Shape, merged, sheet, welded

SUBDIVISION = 2
ARCH_SEGMENTS = 9


@dataclasses.dataclass(frozen=True)
class BodyShape:
    """Measures of a body, m, x forwards from the middle of the car.

    Attributes:
      upper: (x, z, bulge) from the rear's bottom edge over the roof to the front's; bulge = how far the middle
        of the car stands out from its edges there.
      width: over all.
      section: (z, share of the half width) from bottom to top.
      taper: (rear, front): share of the half width lost at the ends, over the last `taper_length` metres.
      axles: x of the wheels; wheel_radius.
      arch: gap above the tyre.
      sill: height of the lower edge.
      belt: height of the windows' lower edge.
      rounding: radius of the edge between top and flank.
    """

    upper: tuple[tuple[float, float, float], ...]
    width: float
    section: tuple[Point2, ...]
    axles: tuple[float, ...]
    wheel_radius: float
    sill: float
    belt: float
    taper: tuple[float, float] = (0.10, 0.13)
    taper_length: float = 0.9
    arch: float = 0.055
    rounding: float = 0.045

    def stretched(self, along: float, across: float = 1.0, up: float = 1.0) -> "BodyShape":
        """The shape scaled; wheels stay round and keep their size."""
        return dataclasses.replace(
            self,
            upper=tuple((x * along, z * up, b) for x, z, b in self.upper),
            width=self.width * across,
            section=tuple((z * up, share) for z, share in self.section),
            axles=tuple(x * along for x in self.axles),
            belt=self.belt * up,
        )


def _strip(rows: Sequence[np.ndarray]) -> Shape:
    """The open skin between polylines of equal length (a `loft` would close each of them to a ring)."""
    surface = sheet(np.stack(rows))
    return Shape(surface.vertices, surface.faces)


def _underside(rows: list[np.ndarray], ends: list[list[np.ndarray]]) -> Shape:
    """The skin between the lower edges (right, left), and at both its ends the sliver under the rounded bumper."""
    count = len(rows[0])
    shapes = [_strip(rows)]
    for k, row in ((0, ends[0]), (count - 1, ends[1])):
        chain = np.array([rows[0][k], *row, rows[1][k]])
        fan = np.array([(0, i, i + 1) for i in range(1, len(chain) - 1)])
        shapes.append(Shape(chain, fan[:, ::-1] if k == 0 else fan))
    return merged(shapes)


class Body:
    """A body under construction in a builder."""

    def __init__(self, builder: MeshBuilder, shape: BodyShape) -> None:
        self.builder, self.shape = builder, shape
        self.volume = 0.0
        self.length = max(p[0] for p in shape.upper) - min(p[0] for p in shape.upper)
        self._levels = [z for z, _ in shape.section][1:-1]
        ends = [p[0] for p in shape.upper]
        self._rear, self._front = min(ends), max(ends)
        inner = shape.taper_length
        self._columns = [
            self._rear + inner / 2,
            self._rear + inner,
            self._front - inner,
            self._front - inner / 2,
        ]

    def half_width(self, x: np.ndarray | float, z: np.ndarray | float) -> np.ndarray:
        """Half the width of the body at a place of the side view."""
        heights, shares = np.array(self.shape.section).T
        section = np.interp(z, heights, shares)
        length = self.shape.taper_length
        rear = np.clip((self._rear + length - np.asarray(x)) / length, 0.0, 1.0) ** 2 * self.shape.taper[0]
        front = np.clip((np.asarray(x) - self._front + length) / length, 0.0, 1.0) ** 2 * self.shape.taper[1]
        return self.shape.width / 2 * section * (1 - rear - front)

    @property
    def _rows(self) -> np.ndarray:
        """(5,) t of the skin's rows of vertices, between the rounded edges."""
        inset = self.shape.rounding / (self.shape.width / 2)
        return np.array([-1 + inset, -0.6, 0.0, 0.6, 1 - inset])

    @functools.cached_property
    def _spline(self) -> np.ndarray:
        """(n, 4) s, x, z, bulge along the upper outline: Catmull-Rom through its points."""
        p = np.array(self.shape.upper)
        p = np.vstack([2 * p[0] - p[1], p, 2 * p[-1] - p[-2]])
        rows = []
        for i in range(1, len(p) - 2):
            for f in np.arange(SUBDIVISION) / SUBDIVISION:
                a, b, c, d = p[i - 1], p[i], p[i + 1], p[i + 2]
                value = b + 0.5 * f * (c - a + f * (2 * a - 5 * b + 4 * c - d + f * (3 * (b - c) + d - a)))
                # Where corners are tight the straight line keeps the curve from bulging past them.
                rows.append([i - 1 + f, *(0.6 * value + 0.4 * (b + f * (c - b)))])
        rows.append([len(self.shape.upper) - 1, *self.shape.upper[-1]])
        return np.array(rows)

    def _upper(self, s: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Points (n, 2) in (x, z), outward normals (n, 2) and bulges (n,) at s."""
        table = self._spline
        at = np.stack([np.interp(s, table[:, 0], table[:, k]) for k in (1, 2)], 1)
        step = 0.35
        ahead = np.stack([np.interp(s + step, table[:, 0], table[:, k]) for k in (1, 2)], 1)
        behind = np.stack([np.interp(s - step, table[:, 0], table[:, k]) for k in (1, 2)], 1)
        along = ahead - behind
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        return at, np.stack([-along[:, 1], along[:, 0]], 1), np.interp(s, table[:, 0], table[:, 3])

    def _across_points(self, s: np.ndarray, t: np.ndarray | float, lift: float = 0.0) -> np.ndarray:
        """(n, 3) points of the upper skin; `lift` along the normal."""
        at, normal, bulge = self._upper(s)
        t = np.broadcast_to(np.asarray(t, float), s.shape)
        y = t * self.half_width(at[:, 0], at[:, 1])
        point = at + normal * (bulge * (1 - t**2) + lift)[:, None]
        return np.stack([point[:, 0], y, point[:, 1]], 1)

    @functools.cached_property
    def _lower(self) -> np.ndarray:
        """(n, 2) lower edge from the front to the rear, with wheel arches."""
        shape = self.shape
        radius = shape.wheel_radius + shape.arch
        start, end = shape.upper[-1], shape.upper[0]
        points = [(start[0] - 0.12, shape.sill + 0.02)]
        half = np.sqrt(max(radius**2 - (shape.wheel_radius - shape.sill) ** 2, 0.01))
        opening = np.arctan2(shape.sill - shape.wheel_radius, half)
        for axle in sorted(shape.axles, reverse=True):
            for a in np.linspace(opening, np.pi - opening, ARCH_SEGMENTS + 1):
                points.append((axle + radius * np.cos(a), shape.wheel_radius + radius * np.sin(a)))
        points.append((end[0] + 0.12, shape.sill + 0.04))
        return np.array(points)

    def _with_crossings(self, line: np.ndarray, *others: np.ndarray) -> list[np.ndarray]:
        """Points added to a polyline (n, 2) where it crosses the flank's grid, and to others (n, k) in step with it.

        The flank is cut along that grid; without these points its seams with the rest of the skin would gape.
        """
        together = np.hstack([line, *others])
        for axis, levels in ((0, self._columns), (1, self._levels)):
            for level in levels:
                above = together[:, axis] > level
                for i in np.flatnonzero(above[1:] != above[:-1])[::-1]:
                    a, b = together[i], together[i + 1]
                    point = a + (level - a[axis]) / (b[axis] - a[axis]) * (b - a)
                    point[axis] = level
                    if np.abs(point[:2] - a[:2]).max() > 1e-4 and np.abs(point[:2] - b[:2]).max() > 1e-4:
                        together = np.insert(together, i + 1, point, axis=0)
        widths = np.cumsum([line.shape[1]] + [o.shape[1] for o in others])[:-1]
        return np.split(together, widths, axis=1)

    def shell(self, color: Color, under: Color = "charcoal") -> None:
        """The skin, closed: flanks, top with rounded edges, underside and inner wheel arches. Sets `volume` (m^3)."""
        s = self._spline[:, 0]
        at, normal, _ = self._upper(s)
        # The largest rounding up to the wanted one that does not fold the outline over itself at a tight corner.
        trials = [self.shape.rounding * f for f in (1.0, 0.7, 0.5, 0.3, 0.15)]
        rounding = next((r for r in trials if shapely.Polygon(np.vstack([at - normal * r, self._lower])).is_valid), 0.0)
        middle = [self._across_points(s, t) for t in self._rows]
        edge, *middle = self._with_crossings(at - normal * rounding, *middle)
        (lower,) = self._with_crossings(self._lower)
        rim = np.vstack([edge, lower])
        y = self.half_width(rim[:, 0], rim[:, 1])
        sides = [np.stack([rim[:, 0], sign * y, rim[:, 1]], 1) for sign in (-1.0, 1.0)]
        n = len(edge)
        skin = _strip([sides[0][:n], *middle, sides[1][:n]])
        closing = [np.vstack([r[n - 1 :], r[:1]]) for r in sides]
        # The ends of the two skins meet along the bumpers' lower edges, where the upper one has more points across.
        ends = [[row[k] for row in middle] for k in (n - 1, 0)]
        flanks = self._flanks(shapely.Polygon(rim), 0.0, "lr")
        belly = _underside(closing, ends)
        with self.builder.solid():
            self.builder.add(skin, color, crease_deg=52.0)
            self.builder.add(flanks, color, crease_deg=25.0)
            self.builder.add(belly, under, crease_deg=30.0)
        whole = merged([skin, flanks, belly])
        a, b, c = (whole.vertices[whole.faces[:, i]] for i in range(3))
        self.volume = abs(float(np.einsum("ij,ij->", a, np.cross(b, c)))) / 6

    def _cells(self, polygon: shapely.Geometry) -> Shape:
        """Triangles of a polygon in (x, z), split along the flank's grid, as a flat shape (x, z, 0)."""
        xs = [-99.0, *self._columns, 99.0]
        zs = [-99.0, *self._levels, 99.0]
        triangles = []
        for x0, x1 in itertools.pairwise(xs):
            for z0, z1 in itertools.pairwise(zs):
                part = shapely.intersection(polygon, shapely.box(x0, z0, x1, z1))
                for piece in shapely.get_parts(part):
                    if piece.geom_type == "Polygon" and piece.area > 1e-10:
                        triangles += list(shapely.constrained_delaunay_triangles(piece).geoms)
        corners = np.array([shapely.geometry.polygon.orient(t).exterior.coords[:3] for t in triangles])[..., :2]
        flat = corners.reshape(-1, 2)
        shape = Shape(np.column_stack([flat, np.zeros(len(flat))]), np.arange(len(flat)).reshape(-1, 3))
        return welded(shape, 1e-4)

    def side(
        self,
        outline: np.ndarray | Sequence[Point2] | shapely.Polygon,
        color: Color,
        lift: float = 0.008,
        sides: str = "lr",
    ) -> None:
        """A piece of the flank drawn in (x, z), `lift` proud of it, on the left, the right or both."""
        polygon = outline if isinstance(outline, shapely.Polygon) else shapely.Polygon(outline)
        self.builder.add(self._flanks(polygon, lift, sides), color, crease_deg=25.0)

    def _flanks(self, polygon: shapely.Polygon, lift: float, sides: str) -> Shape:
        flat = self._cells(shapely.make_valid(polygon))
        x, z = flat.vertices[:, 0], flat.vertices[:, 1]
        y = self.half_width(x, z) + lift
        shapes = []
        if "r" in sides:
            shapes.append(Shape(np.stack([x, -y, z], 1), flat.faces))
        if "l" in sides:
            shapes.append(Shape(np.stack([x, y, z], 1), flat.faces[:, ::-1]))
        return merged(shapes)

    def side_image(self, x0: float, x1: float, z0: float, z1: float, image: ImageLike, lift: float = 0.012) -> None:
        """An image on both flanks, readable on both."""
        xs = np.unique(np.concatenate([np.linspace(x0, x1, 4), [c for c in self._columns if x0 < c < x1]]))
        zs = np.unique(np.concatenate([[z0, z1], [v for v in self._levels if z0 < v < z1]]))
        for sign in (1.0, -1.0):
            row = xs[::-1] if sign > 0 else xs
            grid = np.array([[(x, sign * (self.half_width(x, z) + lift), z) for x in row] for z in zs])
            # UV by place, not by row number: the grid is uneven.
            surface = sheet(grid)
            u = np.abs(grid[..., 0] - row[0]) / (x1 - x0)
            uv = np.stack([u, (grid[..., 2] - z0) / (z1 - z0)], -1).reshape(-1, 2)
            self.builder.add(Shape(surface.vertices, surface.faces, uv), image=image)

    def across(
        self,
        s0: float,
        s1: float,
        t0: float,
        t1: float,
        color: Color | None = None,
        image: ImageLike | None = None,
        lift: float = 0.008,
    ) -> None:
        """A patch of the upper skin between s0 < s1 and t0 < t1, `lift` above it."""
        samples, lines = self._spline[:, 0], self._rows
        t0, t1 = max(t0, lines[0]), min(t1, lines[-1])
        # The patch bends where the skin does, so that it stays `lift` above it everywhere.
        s = np.unique([s0, s1, *samples[(samples > s0) & (samples < s1)]])
        t = np.unique([t0, t1, *lines[(lines > t0) & (lines < t1)]])
        skin = np.stack([self._across_points(samples, line, lift) for line in lines], 1)
        along = np.array([[np.interp(s, samples, skin[:, j, k]) for k in range(3)] for j in range(len(lines))])
        grid = np.array([[[np.interp(b, lines, along[:, k, a]) for k in range(3)] for b in t] for a in range(len(s))])
        u, v = np.meshgrid((t - t0) / (t1 - t0), (s - s0) / (s1 - s0))
        at, _, _ = self._upper(np.array([(s0 + s1) / 2]))
        # In front s runs down and t to the viewer's right, at the back the reverse.
        if at[0, 0] > 0:
            grid, u, v = grid[::-1], u[::-1], 1 - v[::-1]
        else:
            grid, u, v = grid[:, ::-1], 1 - u[:, ::-1], v[:, ::-1]
        surface = sheet(grid)
        self.builder.add(
            Shape(surface.vertices, surface.faces, np.stack([u, v], -1).reshape(-1, 2)), color, image=image
        )

    def glasshouse(
        self,
        pillars: Sequence[Point2],
        span: Point2,
        glass: Color = "dark glass",
        frame: float = 0.075,
        top: float | None = None,
    ) -> None:
        """Side windows: the outline above the belt in span (x0, x1), drawn in by `frame`, cut by pillars (x, width)."""
        table = self._spline
        body = shapely.make_valid(shapely.Polygon(np.vstack([table[:, 1:3], self._lower])))
        high = 9.0 if top is None else top
        area = body.intersection(shapely.box(span[0], self.shape.belt - frame, span[1], high + frame)).buffer(
            -frame, join_style="mitre"
        )
        for x, width in pillars:
            area = area.difference(shapely.box(x - width / 2, 0, x + width / 2, 9))
        for piece in shapely.get_parts(area):
            if piece.area > 0.02:
                self.side(piece.buffer(-0.02, join_style="mitre").buffer(0.02), glass)

    def line(self, points: Sequence[Point2], color: Color = "black", thickness: float = 0.012) -> None:
        """A thin line on both flanks: door gaps, mouldings."""
        self.side(shapely.LineString(points).buffer(thickness / 2, cap_style="flat", join_style="mitre"), color, 0.004)

    def finish(self, description: str, params: dict) -> BuiltAsset:
        """The asset, its volume that of the body (the builder counts closed parts alone, and a body has three)."""
        return dataclasses.replace(self.builder.build(description, params), volume=self.volume)
