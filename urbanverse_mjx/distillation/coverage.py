"""Converts a grid of labels to polygons with straight, shared borders."""

import dataclasses

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry
from shapely.ops import substring

from .borders import Stroke, strokes
from .straight_pieces import FitOptions, straight_pieces

#: m: corners are rounded to whole millimetres.
GRID = 1e-3
#: Label of a face that contains no cell centre.
_NO_LABEL = -1


@dataclasses.dataclass(frozen=True)
class TilingOptions:
    """Options for borders that neighbouring areas share.

    Set by hand on blocks whose kerbs are known (docs/decisions/generation.md).

    Attributes:
      max_extension: m, largest extension of a line that ends on another line.
      overshoot: m, by which it then crosses that line.
      unseen_border_weight: of a border between unseen cells, relative to one between seen cells.
      outer_noise_factor: on the noise of a border with the outside, which lies where visibility ends.
      rounds: in which small areas are merged into neighbours.
    """

    max_extension: float = 4.0
    overshoot: float = 0.01
    unseen_border_weight: float = 0.05
    outer_noise_factor: float = 2.0
    rounds: int = 8


_OPTIONS = TilingOptions()


@dataclasses.dataclass(frozen=True)
class Area:
    """A connected area of one label; it may have holes."""

    label: int
    polygon: shapely.Polygon


def areas(
    labels: np.ndarray,
    known: np.ndarray,
    sort_of: np.ndarray,
    origin: np.ndarray,
    cell: float,
    min_area: float,
    options: FitOptions | None = None,
) -> list[Area]:
    """Polygons with few corners that tile the labelled cells.

    Args:
      labels: (X, Y) u8; 0 = outside.
      known: (X, Y) bool, seen cells; borders between unseen cells may be straightened freely.
      sort_of: (L, L), see `borders.strokes`.
      origin: (2,) m of cell (0, 0)'s low corner.
      cell: m, its side.
      min_area: m^2; smaller areas are merged into the neighbour with the longest common border.

    Returns:
      Areas that touch and do not overlap; where two touch, both have all corners of their border.
    """
    found = strokes(labels, sort_of)
    lines = [_fitted(s, labels, known, origin, cell, options or FitOptions()) for s in found]
    lines = [_drawn_out(k, found, lines) for k in range(len(found))]
    faces = tiled(lines)
    votes = _votes(faces, labels, origin, cell)
    return _dissolved(faces, votes, min_area)


def tiled(lines: list[shapely.LineString]) -> list[shapely.Polygon]:
    """The faces between lines; corners are rounded to whole millimetres and shared by neighbouring faces."""
    noded = shapely.union_all(lines, grid_size=GRID)
    return list(shapely.get_parts(shapely.polygonize(shapely.get_parts(noded))))


def _fitted(
    stroke: Stroke, labels: np.ndarray, known: np.ndarray, origin: np.ndarray, cell: float, options: FitOptions
) -> shapely.LineString:
    corners = origin + stroke.corners * cell
    middles = (corners[:-1] + corners[1:]) / 2
    sure = np.pad(known, 1).ravel()[stroke.sides].mean(1)
    if (np.pad(labels, 1).ravel()[stroke.sides[0]] == 0).any():
        sure = np.ones(len(sure))
        factor = _OPTIONS.outer_noise_factor
        options = dataclasses.replace(options, noise=factor * options.noise, ceiling=factor * options.ceiling)
    made = straight_pieces(middles, np.maximum(sure, _OPTIONS.unseen_border_weight), stroke.closed, options)
    if stroke.closed:
        if len(made) < 3:  # an island of few cells has no long sides
            return shapely.LineString(shapely.get_coordinates(shapely.LineString(corners).simplify(cell)))
        made = np.concatenate([made, made[:1]])
    elif len(made) < 2:
        made = corners[[0, -1]]
    return shapely.LineString(made)


def _drawn_out(k: int, found: list[Stroke], lines: list[shapely.LineString]) -> shapely.LineString:
    """A line extended at its ends to the lines on which its stroke ends."""
    if found[k].closed:
        return lines[k]
    points = shapely.get_coordinates(lines[k])
    ends = [tuple(found[k].corners[0]), tuple(found[k].corners[-1])]
    for at_end, node in enumerate(ends):
        hosts = [lines[m] for m in range(len(found)) if m != k and (found[m].corners == node).all(1).any()]
        if hosts:
            points = _to_host(points if at_end else points[::-1], shapely.union_all(hosts))
            points = points if at_end else points[::-1]
    return shapely.LineString(points)


def _to_host(points: np.ndarray, host: BaseGeometry) -> np.ndarray:
    """The points, with the last moved onto the host line or just beyond it."""
    line = shapely.LineString(points)
    end = substring(line, line.length - min(_OPTIONS.max_extension, line.length / 2), line.length)
    if end.intersects(host):
        return points
    ahead = points[-1] - points[-2]
    ahead = ahead / max(float(np.linalg.norm(ahead)), 1e-9)
    hit = shapely.LineString([points[-1], points[-1] + _OPTIONS.max_extension * ahead]).intersection(host)
    if hit.is_empty:
        return np.vstack([points, _beyond(points[-1], host)])
    return np.vstack([points[:-1], _beyond(points[-1], hit)])


def _beyond(point: np.ndarray, host: BaseGeometry) -> np.ndarray:
    """The point just beyond the nearest point of a host line."""
    at = shapely.get_coordinates(shapely.shortest_line(shapely.Point(point), host))[-1]
    return at + _OPTIONS.overshoot * (at - point) / max(float(np.linalg.norm(at - point)), 1e-9)


def _votes(faces: list[shapely.Polygon], labels: np.ndarray, origin: np.ndarray, cell: float) -> np.ndarray:
    """(F, L) cells of each label in each face; cells outside the grid are of label 0."""
    votes = np.zeros((len(faces), int(labels.max(initial=0)) + 1))
    middles = origin + (np.argwhere(np.ones(labels.shape, bool)) + 0.5) * cell
    point, face = shapely.STRtree(faces).query_nearest(shapely.points(middles), max_distance=1e-9)[:, :]
    np.add.at(votes, (face, labels.ravel()[point]), 1.0)
    return votes


def _dissolved(faces: list[shapely.Polygon], votes: np.ndarray, min_area: float) -> list[Area]:
    """Merges faces of one label, and areas that are too small into the neighbour with the longest common border."""
    label = np.where(votes.sum(1) > 0, votes.argmax(1), _NO_LABEL)
    for _ in range(_OPTIONS.rounds):
        parts = _parts(faces, label)
        small = [p for p in parts if p.label == _NO_LABEL or (p.label and p.polygon.area < min_area)]
        if not small:
            break
        for part in sorted(small, key=lambda p: p.polygon.area):
            own = [f for f, face in enumerate(faces) if part.polygon.contains(face.representative_point())]
            label[own] = _neighbour(part, parts)
    return [p for p in _parts(faces, label) if p.label > 0]


def _neighbour(part: Area, parts: list[Area]) -> int:
    """The label with which a part shares the longest border; the outside counts only for slivers or without other
    neighbours."""
    border: dict[int, float] = {}
    for other in parts:
        if other is not part and other.label >= 0 and other.polygon.intersects(part.polygon):
            shared = float(shapely.length(part.polygon.boundary.intersection(other.polygon.boundary)))
            border[other.label] = border.get(other.label, 0.0) + shared
    border.pop(0, None)
    outside = part.polygon.length - sum(border.values())
    to = max(border, key=lambda k: (border[k], -k), default=0)
    return 0 if not border or border[to] <= 0 or (part.label == _NO_LABEL and outside > border[to]) else to


def _parts(faces: list[shapely.Polygon], label: np.ndarray) -> list[Area]:
    made = []
    for k in np.unique(label):
        whole = shapely.union_all([f for f, own in zip(faces, label, strict=True) if own == k])
        made += [Area(int(k), p) for p in shapely.get_parts(whole)]
    return made
