"""Approximates a noisy line by the fewest straight pieces, by dynamic programming over robust line fits.

The cost of a piece is a constant plus the squared distance of the points per metre, up to a ceiling. A bulge that costs
less than additional pieces is cut off, as in the weak string of Blake and Zisserman (Visual Reconstruction, 1987).
"""

import dataclasses
import itertools

import numpy as np
import shapely


@dataclasses.dataclass(frozen=True)
class FitOptions:
    """Options for fitting a line.

    Set by hand on blocks whose kerbs are known (docs/decisions/generation.md).

    Attributes:
      noise: m, standard error of a point across the line, due to cells of 0.25 m and wrong votes.
      ceiling: m; the cost of a point does not grow beyond this distance, because such a point does not belong to the
        line.
      piece: cost of a piece, in squared standard errors.
      deep: m; the cost of a bulge deeper than this grows with the square of its depth.
      bend: m, least deviation of the line from straight at a corner.
      correlation_length: m, over which the errors of neighbouring points are the same.
      max_corner_distance: m; if two pieces intersect farther from their common point than this, a straight connection
        replaces the corner.
      spike_cosine: cosine of the turn at which a corner is a spike and is cut off.
    """

    noise: float = 0.1
    ceiling: float = 0.25
    piece: float = 24.0
    deep: float = 1.5
    bend: float = 0.15
    correlation_length: float = 0.5
    max_corner_distance: float = 1.5
    spike_cosine: float = -0.4


@dataclasses.dataclass(frozen=True)
class _Line:
    cost: float
    middle: np.ndarray
    direction: np.ndarray

    def foot(self, point: np.ndarray) -> np.ndarray:
        return self.middle + self.direction * float((point - self.middle) @ self.direction)

    def distance(self, point: np.ndarray) -> float:
        away = point - self.middle
        return abs(float(away[1] * self.direction[0] - away[0] * self.direction[1]))


def straight_pieces(points: np.ndarray, weights: np.ndarray, closed: bool, options: FitOptions) -> np.ndarray:
    """Computes the corners of the fewest straight pieces along a line.

    Args:
      points: (n, 2) m in order, evenly spaced.
      weights: (n,) in [0, 1], weight of each point.
      closed: whether the line is a closed ring.

    Returns:
      (m, 2) m corners; the first of a closed line is not repeated. Lines of fewer than three points are returned
      unchanged.
    """
    if len(points) < 3:
        return points
    spacing = float(np.median(np.linalg.norm(np.diff(points, axis=0), axis=1)))
    weights = weights * spacing / (options.correlation_length * options.noise**2)
    if closed:
        begin = int(np.argmax(np.linalg.norm(points - points.mean(0), axis=1)))
        points, weights = np.roll(points, -begin, 0), np.roll(weights, -begin)
        points, weights = np.concatenate([points, points[:1]]), np.append(weights, weights[0])
    breaks, lines = _divided(points, weights, options)
    return _corners(points, breaks, lines, closed, options)


def _fit(points: np.ndarray, weights: np.ndarray, options: FitOptions) -> _Line:
    """Fits a line by least squares with Geman-McClure weights whose scale shrinks to the ceiling."""
    ceiling, weight = options.ceiling, weights
    middle, direction, square = points[0], np.array([1.0, 0.0]), np.zeros(len(points))
    for sharpen in (4.0, 2.0, 1.0, 1.0, 1.0):
        total = weight.sum()
        middle = weight @ points / total
        away = points - middle
        xx, yy = weight @ (away * away).reshape(-1, 2)
        xy = weight @ (away[:, 0] * away[:, 1])
        angle = 0.5 * np.arctan2(2.0 * xy, xx - yy)
        direction = np.array([np.cos(angle), np.sin(angle)])
        square = (away[:, 1] * direction[0] - away[:, 0] * direction[1]) ** 2
        largest = float(square.max())
        if largest < (0.5 * ceiling) ** 2:
            return _Line(float(weights @ square), middle, _forward(direction, points))
        weight = weights / (1.0 + square / (sharpen * ceiling) ** 2) ** 2
    cost = float(weights @ (np.minimum(square, ceiling**2) * np.maximum(1.0, np.sqrt(square) / options.deep) ** 2))
    return _Line(cost, middle, _forward(direction, points))


def _forward(direction: np.ndarray, points: np.ndarray) -> np.ndarray:
    return -direction if direction @ (points[-1] - points[0]) < 0 else direction


def _divided(points: np.ndarray, weights: np.ndarray, options: FitOptions) -> tuple[list[int], list[_Line]]:
    """The cheapest chain of pieces: the indices between them, and their lines."""
    last = len(points) - 1
    kept = shapely.get_coordinates(shapely.LineString(points).simplify(options.bend, preserve_topology=False))
    number = {tuple(p): k for k, p in reversed(list(enumerate(points.tolist())))}
    at = sorted({0, *(number[tuple(p)] for p in kept.tolist()[1:-1]), last})
    best, before = [0.0] + [np.inf] * (len(at) - 1), [0] * len(at)
    found: dict[tuple[int, int], _Line] = {}
    begins: list[int] = []
    for j in range(1, len(at)):
        begins.append(j - 1)
        for i in begins:
            found[i, j] = _fit(points[at[i] : at[j] + 1], weights[at[i] : at[j] + 1], options)
            # Points that leave a line and do not return are not a bulge: pieces are separated where both are near the
            # points.
            off = [found[i, j].distance(points[at[k]]) * weights[at[k]] ** 0.5 for k in (i, j)]
            lost = np.clip(max(off, default=0.0) / (options.ceiling * weights.max() ** 0.5) - 1.0, 0.0, 1.0)
            cost = best[i] + found[i, j].cost + options.piece * (1.0 + lost)
            if cost < best[j]:
                best[j], before[j] = cost, i
        # If a new piece at j costs no more, a longer piece cannot be cheaper (PELT: Killick et al., 2012).
        begins = [i for i in begins if best[i] + found[i, j].cost < best[j]]
    chain = [len(at) - 1]
    while chain[-1]:
        chain.append(before[chain[-1]])
    chain.reverse()
    return [at[k] for k in chain], [found[i, j] for i, j in itertools.pairwise(chain)]


def _corners(
    points: np.ndarray, breaks: list[int], lines: list[_Line], closed: bool, options: FitOptions
) -> np.ndarray:
    """Corners at the intersections of pieces; pieces without a nearby intersection are connected by a straight line."""
    out: list[np.ndarray] = [] if closed else [lines[0].foot(points[0])]
    for k, before in enumerate(lines if closed else lines[:-1]):
        after, at = lines[(k + 1) % len(lines)], points[breaks[k + 1]]
        meet = _meeting(before, after)
        sharp = before.direction @ after.direction < options.spike_cosine
        if meet is not None and not sharp and np.linalg.norm(meet - at) <= options.max_corner_distance:
            out.append(meet)
        else:
            feet = [before.foot(at), after.foot(at)]
            step = np.linalg.norm(feet[1] - feet[0])
            out += feet if step > options.ceiling or sharp else [(feet[0] + feet[1]) / 2]
    if not closed:
        out.append(lines[-1].foot(points[-1]))
    return np.array(out)


def _meeting(one: _Line, other: _Line) -> np.ndarray | None:
    cross = float(one.direction[0] * other.direction[1] - one.direction[1] * other.direction[0])
    if abs(cross) < 0.02:
        return None
    away = other.middle - one.middle
    return one.middle + one.direction * float(away[0] * other.direction[1] - away[1] * other.direction[0]) / cross
