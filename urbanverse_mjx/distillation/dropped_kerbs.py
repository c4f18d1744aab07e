"""Finds dropped kerbs (ramps from a crosswalk up to the pavement) in the observed heights."""

import dataclasses
import itertools
from collections.abc import Iterator, Sequence

import numpy as np
import shapely

from ..datatypes import KIND_INDEX
from .coverage import Area
from .ground import CELL, WALKED, GroundMap, fit_plane


@dataclasses.dataclass(frozen=True)
class RampOptions:
    """Conditions for a dropped kerb.

    Set by hand on blocks whose kerbs are known (docs/decisions/generation.md).

    Attributes:
      min_kerb: m, least height of the pavement above the crosswalk.
      dropped: largest remaining height at the edge of a ramp, as a share of the kerb's height.
      top: height at which a ramp ends, as a share of the kerb's height.
      min_width: m, least width along the edge.
      min_run, max_run: m, limits of a ramp's length into the pavement.
      crosswalk: m, distance from the edge at which the crosswalk's height is measured.
    """

    min_kerb: float = 0.06
    dropped: float = 0.5
    top: float = 0.9
    min_width: float = 1.0
    min_run: float = 0.5
    max_run: float = 2.5
    crosswalk: float = 0.5


_OPTIONS = RampOptions()


def ramps(areas: Sequence[Area], seen: GroundMap) -> list[tuple[int, shapely.Polygon]]:
    """(number of the area, polygon of the ramp) for every dropped kerb between a crosswalk and a walkable area."""
    walked = [KIND_INDEX[k] for k in WALKED]
    crosswalks = [a for a in areas if a.label == KIND_INDEX["crosswalk"]]
    found = []
    for number, area in enumerate(areas):
        for crosswalk in crosswalks if area.label in walked else ():
            for begin, end in _edges(area, crosswalk):
                ramp = _ramp(area, begin, end, seen)
                if ramp is not None:
                    found.append((number, ramp))
    return found


def _edges(area: Area, crosswalk: Area) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Straight parts of the common border, with the area on their left."""
    border = area.polygon.intersection(crosswalk.polygon)
    parts = [p for p in shapely.get_parts(border) if isinstance(p, shapely.LineString)]
    for line in shapely.get_parts(shapely.line_merge(shapely.MultiLineString(parts))):
        corners = shapely.get_coordinates(line.simplify(CELL / 4))
        for begin, end in itertools.pairwise(corners):
            if np.linalg.norm(end - begin) < _OPTIONS.min_width:
                continue
            beside = (begin + end) / 2 + 0.1 * _left(begin, end)
            inside = area.polygon.contains(shapely.Point(beside))
            yield (begin, end) if inside else (end, begin)


def _left(begin: np.ndarray, end: np.ndarray) -> np.ndarray:
    along = (end - begin) / np.linalg.norm(end - begin)
    return np.array([-along[1], along[0]])


def _ramp(area: Area, begin: np.ndarray, end: np.ndarray, seen: GroundMap) -> shapely.Polygon | None:
    """The ramp behind an edge; None if the kerb is not dropped or was not seen."""
    length, left = float(np.linalg.norm(end - begin)), _left(begin, end)
    along = (end - begin) / length
    s, t = np.arange(CELL / 2, length, CELL), np.arange(CELL / 2, _OPTIONS.max_run, CELL)
    places = begin + s[:, None, None] * along + t[:, None] * left
    kind, height = _at(seen, places)
    known = np.isfinite(height) & (kind == area.label)
    below = _at(seen, begin + s[:, None] * along - _OPTIONS.crosswalk * left)[1]
    if not known.any() or not np.isfinite(below).any():
        return None
    plane, _ = fit_plane(seen, area.polygon, area.label)
    kerb = places @ np.array(plane[:2]) + plane[2] - np.nanmedian(below)
    if np.median(kerb) < _OPTIONS.min_kerb:
        return None
    share = np.where(known, (height - np.nanmedian(below)) / kerb, np.nan)
    first, last = _longest(np.nan_to_num(share[:, :2], nan=1.0).mean(1) < _OPTIONS.dropped)
    if (last - first) * CELL < _OPTIONS.min_width:
        return None
    profile = np.nan_to_num(np.ma.median(np.ma.masked_invalid(share[first:last]), axis=0).filled(1.0), nan=1.0)
    up = np.flatnonzero(profile >= _OPTIONS.top)
    run = max(float(t[up[0]]) if len(up) else _OPTIONS.max_run, _OPTIONS.min_run)
    a, b = begin + first * CELL * along, begin + min(last * CELL, length) * along
    ramp = shapely.Polygon([a, b, b + run * left, a + run * left]).intersection(area.polygon)
    return ramp if isinstance(ramp, shapely.Polygon) and ramp.area > 0.5 * run * _OPTIONS.min_width else None


def _at(seen: GroundMap, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    kind, height = seen.at(places.reshape(-1, 2))
    return kind.reshape(places.shape[:-1]), height.reshape(places.shape[:-1])


def _longest(yes: np.ndarray) -> tuple[int, int]:
    """Half-open range of indices of the longest run of true values."""
    edges = np.flatnonzero(np.diff(np.r_[0, yes.astype(int), 0]))
    runs = edges.reshape(-1, 2)
    return tuple(runs[np.argmax(runs[:, 1] - runs[:, 0])].tolist()) if len(runs) else (0, 0)
