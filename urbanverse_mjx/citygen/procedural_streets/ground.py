"""Ground of procedural scenes: roads along arms, pavements beside them, crosswalks with dropped kerbs, lots for houses.

An arm is a centre line; where arms meet, their roads are merged. Everything is snapped to the millimetre before it is
cut, so that neighbours share their corners exactly.
"""

import dataclasses
import math
from collections.abc import Iterator, Sequence

import shapely
from shapely.geometry.base import BaseGeometry

from ...datatypes import GroundRegion
from ...geometry.polygons import MAX_OVERLAP
from ..section import (
    CROSSWALK_HALF_WIDTH,
    FLARE_LENGTH,
    KERB_HEIGHT,
    LOT_DEPTH,
    RAMP_HALF_WIDTH,
    RAMP_LENGTH,
    ROAD_PLANE,
    Plane,
)

PAVEMENT: Plane = (0.0, 0.0, KERB_HEIGHT)
_GRID = 0.001  # m
_MIN_AREA = 0.05  # m², pieces smaller than this are left out


@dataclasses.dataclass(frozen=True)
class Arm:
    """A stretch of street.

    Attributes:
      points: (x, y) m along the centre line.
      free: range (m) along it in which objects may stand, outside junctions.
      crosswalks: positions (m) along it; only where the arm is parallel to an axis.
      closed: whether a house closes the view at its (start, end).
    """

    points: tuple[tuple[float, float], ...]
    free: tuple[float, float]
    crosswalks: tuple[float, ...] = ()
    closed: tuple[bool, bool] = (True, True)

    @property
    def line(self) -> shapely.LineString:
        return shapely.LineString(self.points)

    def frame(self, s: float) -> tuple[tuple[float, float], tuple[float, float]]:
        """Returns the position at s metres and the direction of the arm there."""
        line = self.line
        a, b = line.interpolate(max(0.0, s - 0.01)), line.interpolate(min(line.length, s + 0.01))
        away = math.hypot(b.x - a.x, b.y - a.y)
        here = line.interpolate(s)
        return (here.x, here.y), ((b.x - a.x) / away, (b.y - a.y) / away)


@dataclasses.dataclass(frozen=True)
class Ground:
    """The result of `lay`.

    Attributes:
      regions: of the scene graph.
      walk: where people walk: pavements and plazas; houses keep off it.
      road: carriageways and crosswalks.
    """

    regions: tuple[GroundRegion, ...]
    walk: BaseGeometry
    road: BaseGeometry


def lay(arms: Sequence[Arm], half: float, pavement: float, plaza: shapely.Polygon | None = None) -> Ground:
    """Returns the ground of a scene.

    Args:
      half: m, half a carriageway.
      pavement: m, width of the pavements.
      plaza: paved ground level with the pavements, outside them.
    """
    road = _snap(_band(arms, half))
    walk = _snap(_band(arms, half + pavement).difference(road))
    square = _snap((plaza or shapely.Polygon()).difference(shapely.union_all([road, walk])))
    built = shapely.union_all([road, walk, square])
    outer = [_band(arms, half + pavement + LOT_DEPTH), square.buffer(LOT_DEPTH, join_style="mitre")]
    outer += [_end_lot(arm, at_end, half + pavement) for arm in arms for at_end in (False, True) if arm.closed[at_end]]
    lots = _snap(shapely.union_all(outer).difference(built))
    crossings, ramps = [], []
    for arm in arms:
        for s in arm.crosswalks:
            crossings.append(_snap(_crossing(arm, s, half)))
            for side in (1, -1):
                ramps += _ramp(arm, s, side, half, f"ramp_{len(ramps) // 3}")
    dropped = shapely.union_all([shapely.Polygon(r.polygon) for r in ramps])
    zebra = shapely.union_all(crossings)
    regions = [
        *_regions("road", "road", road.difference(zebra, grid_size=_GRID), ROAD_PLANE),
        *_regions("crosswalk", "crosswalk", zebra, ROAD_PLANE),
        *_regions("pavement", "sidewalk", walk.difference(dropped, grid_size=_GRID), PAVEMENT),
        *ramps,
        *_regions("plaza", "sidewalk", square, PAVEMENT),
    ]
    regions += _regions("lot", "sidewalk", lots, PAVEMENT, [shapely.Polygon(r.polygon) for r in regions])
    return Ground(tuple(regions), shapely.union_all([walk, square]), road)


def _snap(shape: BaseGeometry) -> BaseGeometry:
    return shapely.set_precision(shape, _GRID)


def _band(arms: Sequence[Arm], reach: float) -> BaseGeometry:
    """Returns the area within `reach` of the arms, with square ends."""
    return shapely.union_all([arm.line.buffer(reach, cap_style="flat", join_style="mitre") for arm in arms])


def _end_lot(arm: Arm, at_end: bool, reach: float) -> BaseGeometry:
    """Returns the ground under the house that closes an end of an arm."""
    (x, y), (u, v) = arm.frame(arm.line.length if at_end else 0.0)
    away = LOT_DEPTH if at_end else -LOT_DEPTH
    end = shapely.LineString([(x, y), (x + u * away, y + v * away)])
    return end.buffer(reach + LOT_DEPTH, cap_style="flat")


def _crossing(arm: Arm, s: float, half: float) -> BaseGeometry:
    (x, y), (u, v) = arm.frame(s)
    reach = CROSSWALK_HALF_WIDTH
    return shapely.LineString([(x - u * reach, y - v * reach), (x + u * reach, y + v * reach)]).buffer(
        half, cap_style="flat"
    )


def _ramp(arm: Arm, s: float, side: int, half: float, name: str) -> list[GroundRegion]:
    """Returns a dropped kerb and its two flares (see `section._ramp`) on the left (+1) or right (-1) of an arm."""
    (x, y), along = arm.frame(s)
    out = (-along[1] * side, along[0] * side)
    kerb = (x + out[0] * half, y + out[1] * half)

    def corner(t: float, d: float) -> tuple[float, float]:
        return (
            round(kerb[0] + along[0] * t + out[0] * d, 3),
            round(kerb[1] + along[1] * t + out[1] * d, 3),
        )

    def plane(slope: float, level: float) -> Plane:
        """Returns a plane that rises outwards from the kerb by the ramp's slope and along the arm by `slope`, with
        `level` at the kerb's middle."""
        rise = KERB_HEIGHT / RAMP_LENGTH
        a, b = rise * out[0] + slope * along[0], rise * out[1] + slope * along[1]
        return round(a, 9), round(b, 9), round(level - a * kerb[0] - b * kerb[1], 9)

    w, steep = RAMP_HALF_WIDTH, KERB_HEIGHT / FLARE_LENGTH
    parts = (
        ("", ((-w, 0.0), (w, 0.0), (w, RAMP_LENGTH), (-w, RAMP_LENGTH)), plane(0.0, 0.0)),
        ("_a", ((-w - FLARE_LENGTH, 0.0), (-w, 0.0), (-w, RAMP_LENGTH)), plane(-steep, -steep * w)),
        ("_b", ((w, 0.0), (w + FLARE_LENGTH, 0.0), (w, RAMP_LENGTH)), plane(steep, -steep * w)),
    )
    return [GroundRegion(f"{name}{tail}", "sidewalk", tuple(corner(*c) for c in ring), p) for tail, ring, p in parts]


def _regions(
    name: str, kind: str, shape: BaseGeometry, plane: Plane, beside: Sequence[BaseGeometry] = ()
) -> Iterator[GroundRegion]:
    """Returns a region for each simple piece of a shape; pieces with holes are cut through them, and all avoid
    `beside`."""
    number = 0
    for whole in _without_holes(shape):
        for piece in _apart(whole, beside):
            if piece.area >= _MIN_AREA:
                ring = tuple((round(x, 3), round(y, 3)) for x, y in piece.exterior.coords[:-1])
                yield GroundRegion(f"{name}_{number}", kind, ring, plane)
                number += 1


def _apart(piece: shapely.Polygon, beside: Sequence[BaseGeometry]) -> Iterator[shapely.Polygon]:
    """Returns the piece, cut back by two millimetres from a region that it overlaps. Where a cut meets a long slanted
    edge its corner is snapped, which moves the edge away from its neighbour's by up to half a millimetre."""
    exact = shapely.set_precision(piece, 0.0)  # on its grid it would share no corner
    over = [other for other in beside if exact.intersection(other).area > MAX_OVERLAP]
    if not over:
        yield piece
        return
    for other in over:
        exact = exact.difference(other.buffer(2 * _GRID, join_style="mitre"))
    yield from (part for part in shapely.get_parts(_snap(exact)) if isinstance(part, shapely.Polygon))


def _without_holes(shape: BaseGeometry) -> Iterator[shapely.Polygon]:
    for part in shapely.get_parts(shape):
        if not isinstance(part, shapely.Polygon) or part.is_empty:
            continue
        if not part.interiors:
            yield part
            continue
        x0, y0, x1, y1 = part.bounds
        x = round(shapely.Polygon(part.interiors[0]).centroid.x, 3)
        for half in (shapely.box(x0, y0, x, y1), shapely.box(x, y0, x1, y1)):
            yield from _without_holes(shapely.intersection(part, half, grid_size=_GRID))
