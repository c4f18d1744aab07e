"""Cuts the ground grid into regions: simple polygons with straight borders and planar tops."""

from collections.abc import Sequence

import numpy as np
import shapely

from ..datatypes import GROUND_KINDS, GroundRegion, ValidationError
from ..datatypes.ground import check_polygon
from . import coverage
from .dropped_kerbs import ramps
from .ground import CELL, DRIVEN, OPTIONS, WALKED, GroundMap, fit_plane

type Ring = tuple[tuple[float, float], ...]  # m

#: m^2; smaller pieces are caused by the rounding of a border and are dropped.
_MIN_PIECE_AREA = 0.02


def regions(seen: GroundMap) -> tuple[GroundRegion, ...]:
    """Simple polygons that tile the known ground, with planes fitted to the heights inside; neighbours share
    corners."""
    if not seen.kind.any():
        return ()
    areas = coverage.areas(seen.kind, seen.count > 0, _sorts(), seen.origin, CELL, OPTIONS.min_area, OPTIONS.fit)
    dropped = ramps(areas, seen)
    pieces, kinds = [p for _, p in dropped], [areas[number].label for number, _ in dropped]
    for number, area in enumerate(areas):
        level = area.polygon.difference(shapely.union_all([p for own, p in dropped if own == number]))
        for part in shapely.get_parts(level):
            found = _simple_pieces(part, seen, area.label)
            pieces += found
            kinds += [area.label] * len(found)
    made: list[GroundRegion] = []
    for ring, number in _shared(pieces):
        name = f"{GROUND_KINDS[kinds[number]]}_{len(made):02d}"
        plane, _ = fit_plane(seen, shapely.Polygon(ring), kinds[number])
        made.append(GroundRegion(name, GROUND_KINDS[kinds[number]], ring, plane))
    return tuple(made)


def _sorts() -> np.ndarray:
    """Sorts of borders by the kinds beside them: 0 with the outside, 2 along the carriageway, 1 any other."""
    on, off = (np.isin(GROUND_KINDS, kinds) for kinds in (DRIVEN, WALKED))
    sorts = 1 + (on[:, None] & off) + (off[:, None] & on)
    sorts[0, :] = sorts[:, 0] = 0
    return sorts


def _shared(pieces: Sequence[shapely.Polygon]) -> list[tuple[Ring, int]]:
    """Outlines rounded to whole millimetres, each with the number of its piece. Touching outlines share all corners of
    their border; otherwise rounding would make a long edge overlap the neighbour."""
    faces = coverage.tiled([shapely.LineString(p.exterior.coords) for p in pieces])
    tree, found = shapely.STRtree(pieces), []
    for face in faces:
        inside = tree.query(face.representative_point(), predicate="intersects")
        if not len(inside) or face.area < _MIN_PIECE_AREA:
            continue
        try:
            ring = check_polygon([list(c) for c in face.exterior.coords[:-1]], "ground")
        except ValidationError:
            continue
        found.append((ring, int(inside[0])))
    return sorted(found, key=lambda f: (f[1], f[0]))


def _simple_pieces(outline: shapely.Polygon, seen: GroundMap, kind: int) -> list[shapely.Polygon]:
    """Splits an outline until every piece has no hole, few corners and a top that one plane fits."""
    todo, done = [outline], []
    while todo:
        area = todo.pop()
        if area.is_empty or area.area < _MIN_PIECE_AREA:
            continue
        x0, y0, x1, y1 = area.bounds
        if area.interiors:
            hole = shapely.Polygon(area.interiors[0]).centroid
            at = (hole.x, hole.y)
        elif len(area.exterior.coords) > OPTIONS.max_corners or (
            min(x1 - x0, y1 - y0) > 1.0
            and max(x1 - x0, y1 - y0) > 6.0
            and fit_plane(seen, area, kind)[1] > OPTIONS.max_plane_error
        ):
            at = ((x0 + x1) / 2, (y0 + y1) / 2)
        else:
            done.append(area)
            continue
        halves = ((x0 - 1, y0 - 1, at[0], y1 + 1), (at[0], y0 - 1, x1 + 1, y1 + 1))
        if y1 - y0 > x1 - x0:
            halves = ((x0 - 1, y0 - 1, x1 + 1, at[1]), (x0 - 1, at[1], x1 + 1, y1 + 1))
        for half in halves:
            todo += [p for p in shapely.get_parts(area & shapely.box(*half)) if isinstance(p, shapely.Polygon)]
    return done
