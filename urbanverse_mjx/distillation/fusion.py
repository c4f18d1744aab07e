"""Associates views of the same object: frame by frame with a map of earlier objects, then a pass over the map.

The cost of a frame depends on the objects near it, not on the number of earlier frames.
"""

import dataclasses
import functools

import numpy as np
import scipy.optimize
import scipy.spatial

from .lifting import Views

#: m, error of a view's position that does not grow with the range (border pixels, visible side).
MIN_POSITION_ERROR = 0.03


@dataclasses.dataclass(frozen=True)
class FusionOptions:
    """Conditions under which views show the same object and objects of the map are merged.

    Chosen manually; `benchmarks.fidelity` measures their effect (docs/decisions/generation.md).

    Attributes:
      min_view_score: least score at which a view is assigned to an object: boxes of one label overlap by half, or
        positions are two standard errors apart.
      min_merge_score: least score at which two objects of the map are merged, unless many frames show both.
      max_squared_distance: squared standard errors in three dimensions; positions farther apart are not compared (1 of
        400 true pairs).
      information_kept: share of an object's information that is kept when a view is added, because poses drift and
        depth errors of successive frames are correlated.
      max_shared_frames: two objects are merged only if at most this share of the frames of the rarer one shows both.
      max_gap: m; boxes farther apart than this are not compared.
      trim: quantile of a view's points that its box leaves out at each end.
      max_sigma: m; boxes of views with a larger standard error are not merged with more accurate ones.
      belief_power: beliefs of views are raised to this power before they are compared; with 1, neighbours with
        several likely labels each are merged too often.
    """

    min_view_score: float = 0.22
    min_merge_score: float = 0.4
    max_squared_distance: float = 14.0
    information_kept: float = 0.85
    max_shared_frames: float = 0.15
    max_gap: float = 6.0
    trim: float = 0.02
    max_sigma: float = 0.25
    belief_power: float = 2.0


_OPTIONS = FusionOptions()


@dataclasses.dataclass(frozen=True)
class Placed:
    """Views in the world: low, high (n, 3) m, their boxes; viewpoint (n, 3) m; sigma (n,) m along the line of sight."""

    low: np.ndarray
    high: np.ndarray
    viewpoint: np.ndarray
    sigma: np.ndarray

    @property
    def center(self) -> np.ndarray:
        """(n, 3) m, centres of the boxes."""
        return (self.low + self.high) / 2

    @functools.cached_property
    def gain(self) -> np.ndarray:
        """(n, 3, 3) 1/m^2: 1 / sigma^2 along the line of sight, and across it the error of a view's centre relative to
        the object's: different viewpoints show different sides."""
        line = self.center - self.viewpoint
        line /= np.maximum(np.linalg.norm(line, axis=1), 1e-6)[:, None]
        along = line[:, :, None] * line[:, None, :]
        across = across_error(self.low, self.high)
        deep = np.hypot(self.sigma, across)
        return along / deep[:, None, None] ** 2 + (np.eye(3) - along) / across[:, None, None] ** 2


def across_error(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """(n,) m: offset of a view's visible centre from the object's centre, in addition to the error of its depth."""
    return MIN_POSITION_ERROR + 0.15 * np.linalg.norm(high - low, axis=-1)


def world_points(views: Views, poses: np.ndarray, scale: np.ndarray, rows: np.ndarray | slice) -> np.ndarray:
    """(k, POINTS, 3) f64 m: the points of some views in the world."""
    frame = views.frame[rows]
    turned = np.einsum("kij,kpj->kpi", poses[frame, :3, :3], views.points[rows])
    return turned * scale[frame, None, None] + poses[frame, None, :3, 3]


def place(views: Views, poses: np.ndarray, scale: np.ndarray, noise: float) -> Placed:
    """Computes the world position of every view, in chunks that fit the processor's cache."""
    low, high = np.zeros((len(views), 3)), np.zeros((len(views), 3))
    reach = np.zeros(len(views))
    for start in range(0, len(views), 512):
        rows = slice(start, start + 512)
        points = world_points(views, poses, scale, rows)
        points.sort(axis=1)
        last = points.shape[1] - 1
        low[rows], high[rows] = points[:, round(_OPTIONS.trim * last)], points[:, round((1 - _OPTIONS.trim) * last)]
        high[rows, 2] = points[:, last - 1, 2]  # tops are thin
        reach[rows] = np.linalg.norm(points[:, last // 2] - poses[views.frame[rows], :3, 3], axis=1)
    return Placed(low, high, poses[views.frame, :3, 3], MIN_POSITION_ERROR + noise * reach)


class _Map:
    """The objects found so far: boxes, smallest sigma, votes for labels."""

    def __init__(self, capacity: int, labels: int) -> None:
        self.size = 0
        self.low, self.high = np.zeros((capacity, 3)), np.zeros((capacity, 3))
        self.sigma = np.zeros(capacity)
        self.votes, self.weight = np.zeros((capacity, labels), np.float32), np.zeros(capacity, np.float32)
        self.information, self.weighted = np.zeros((capacity, 3, 3)), np.zeros((capacity, 3))

    def near(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """(k,) objects whose box is within `max_gap` of the boxes of a frame."""
        a, b = low.min(0) - _OPTIONS.max_gap, high.max(0) + _OPTIONS.max_gap
        n = self.size
        return np.flatnonzero(((self.low[:n] < b) & (self.high[:n] > a)).all(1))

    def add(self, placed: Placed, rows: np.ndarray, votes: np.ndarray, scores: np.ndarray) -> np.ndarray:
        """Adds objects made from views and returns their numbers."""
        numbers = np.arange(self.size, self.size + len(rows))
        self.low[numbers], self.high[numbers], self.sigma[numbers] = (
            placed.low[rows],
            placed.high[rows],
            placed.sigma[rows],
        )
        self._vote(numbers, votes, scores)
        self._inform(numbers, placed, rows)
        self.size += len(rows)
        return numbers

    def _inform(self, objects: np.ndarray, placed: Placed, rows: np.ndarray) -> None:
        gained = placed.gain[rows]
        self.information[objects] = _OPTIONS.information_kept * self.information[objects] + gained
        moved = np.einsum("kij,kj->ki", gained, placed.center[rows])
        self.weighted[objects] = _OPTIONS.information_kept * self.weighted[objects] + moved

    def places(self, objects: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(k, 3) m centres and (k, 3, 3) m^2 covariances."""
        covariance = np.linalg.inv(self.information[objects])
        return np.einsum("kij,kj->ki", covariance, self.weighted[objects]), covariance

    def _vote(self, objects: np.ndarray, votes: np.ndarray, scores: np.ndarray) -> None:
        self.votes[objects] += votes * scores[:, None]
        self.weight[objects] += scores

    def share(self, objects: np.ndarray | slice) -> np.ndarray:
        """(k, L) mean of the votes of objects."""
        return self.votes[objects] / self.weight[objects, None]

    def update(
        self, objects: np.ndarray, placed: Placed, rows: np.ndarray, votes: np.ndarray, scores: np.ndarray
    ) -> None:
        """Updates objects: a much better view replaces an object's box, a similar one widens it, a worse one only votes
        for the label."""
        self._vote(objects, votes, scores)
        self._inform(objects, placed, rows)
        ratio = placed.sigma[rows] / self.sigma[objects]
        # With accurate depth every view widens the box, because a nearer view may show only a part.
        better = (ratio < 0.6) & (self.sigma[objects] > _OPTIONS.max_sigma)
        similar = ~better & ((ratio < 1.7) | (placed.sigma[rows] <= _OPTIONS.max_sigma))
        shrink = np.minimum(placed.sigma[rows, None], 0.25 * (placed.high - placed.low)[rows])
        low, high = placed.low[rows] + shrink, placed.high[rows] - shrink
        t, r = objects[similar], np.flatnonzero(similar)
        self.low[t], self.high[t] = np.minimum(self.low[t], low[r]), np.maximum(self.high[t], high[r])
        t, r = objects[better], rows[better]
        self.low[t], self.high[t] = placed.low[r], placed.high[r]
        self.sigma[objects] = np.minimum(self.sigma[objects], placed.sigma[rows])


def _overlap(
    low: np.ndarray, high: np.ndarray, other_low: np.ndarray, other_high: np.ndarray, slack: np.ndarray
) -> np.ndarray:
    """(...) in [0, 1], share of the smaller box that lies in the larger, combined with the distance of the centres.

    slack (...): m, tolerance of the boxes.
    """
    slack = slack[..., None]
    shared = np.minimum(high, other_high) - np.maximum(low, other_low) + slack
    smaller = np.minimum(high - low, other_high - other_low) + slack
    inside = np.clip(shared / smaller, 0.0, 1.0)
    apart = np.linalg.norm((low + high - other_low - other_high)[..., :2] / 2, axis=-1)
    reach = 0.5 * np.linalg.norm(smaller[..., :2], axis=-1)
    volume = inside[..., 0] * inside[..., 1] * np.minimum(1.0, 2.0 * inside[..., 2])
    return np.where(volume > 0, 0.6 * volume + 0.4 * np.exp(-0.5 * (apart / reach) ** 2), 0.0)


def _agreement(
    a: np.ndarray, a_covariance: np.ndarray, b: np.ndarray, b_covariance: np.ndarray, pairs: tuple
) -> np.ndarray:
    """(p,) in [0, 1], agreement of positions given their covariances."""
    i, j = pairs
    apart = a[i] - b[j]
    whole = a_covariance[i] + b_covariance[j]
    squared = np.einsum("pi,pi->p", apart, np.linalg.solve(whole, apart[..., None])[..., 0])
    return np.where(squared < _OPTIONS.max_squared_distance, np.exp(-squared / 8.0), 0.0)


def directions(views: Views, similarity: np.ndarray) -> np.ndarray:
    """(n, L) the views' sharpened beliefs b, scaled so that b S b = 1: b S c then is the cosine of two beliefs in the
    metric of the labels' similarity S, and for certain views the similarity of their labels."""
    sharp = views.belief**_OPTIONS.belief_power
    length = np.einsum("nl,nl->n", sharp @ similarity, sharp)
    return (sharp / np.sqrt(length)[:, None]).astype(np.float32)


def associate(views: Views, placed: Placed, similarity: np.ndarray) -> np.ndarray:
    """(n,) i32, the object that each view shows.

    Args:
      views, placed: the observations; frames in order.
      similarity: (L, L) in [0, 1], similarity of the meanings of two labels.
    """
    object_of_view = np.full(len(views), -1, np.int32)
    known = _Map(len(views), len(views.labels))
    votes = directions(views, similarity)
    covariances = np.linalg.inv(placed.gain)
    bounds = np.flatnonzero(np.diff(views.frame)) + 1
    for rows in np.split(np.arange(len(views)), bounds) if len(views) else []:
        near = known.near(placed.low[rows], placed.high[rows])
        matched = np.zeros(len(rows), bool)
        if len(near):
            likeness = known.share(near) @ similarity @ votes[rows].T
            slack = 2.0 * np.hypot(placed.sigma[rows][:, None], known.sigma[near][None])
            overlap = _overlap(
                placed.low[rows][:, None], placed.high[rows][:, None], known.low[near], known.high[near], slack
            )
            middle, covariance = known.places(near)
            gap = np.linalg.norm(placed.center[rows][:, None] - middle, axis=-1)
            pairs = np.nonzero(gap < _OPTIONS.max_gap)
            agree = np.zeros(gap.shape)
            agree[pairs] = _agreement(placed.center[rows], covariances[rows], middle, covariance, pairs)
            score = likeness.T * np.maximum(0.75 * overlap, 0.5 * (overlap + agree))
            a, b = scipy.optimize.linear_sum_assignment(score, maximize=True)
            good = score[a, b] >= _OPTIONS.min_view_score
            a, b = a[good], near[b[good]]
            matched[a] = True
            object_of_view[rows[a]] = b
            known.update(b, placed, rows[a], votes[rows[a]], views.score[rows[a]])
        fresh = rows[~matched]
        object_of_view[fresh] = known.add(placed, fresh, votes[fresh], views.score[fresh])
    return _merged(object_of_view, views, known, similarity)


def _merged(object_of_view: np.ndarray, views: Views, known: _Map, similarity: np.ndarray) -> np.ndarray:
    """Merges duplicate objects of the map, best score first, and renumbers the objects without gaps."""
    n = known.size
    if n < 2:
        return object_of_view
    low, high = known.low[:n], known.high[:n]
    tree = scipy.spatial.cKDTree((low + high)[:, :2] / 2)
    pairs = tree.query_pairs(_OPTIONS.max_gap, output_type="ndarray")
    a, b = pairs[:, 0], pairs[:, 1]
    share = known.share(slice(n))
    slack = 2.0 * np.hypot(known.sigma[a], known.sigma[b])
    overlap = _overlap(low[a], high[a], low[b], high[b], slack)
    middle, covariance = known.places(np.arange(n))
    agree = _agreement(middle, covariance, middle, covariance, (a, b))
    score = np.einsum("pl,pl->p", share[a] @ similarity, share[b]) * 0.5 * (overlap + agree)
    frames: list[set[int]] = [set() for _ in range(n)]
    for t, f in zip(object_of_view.tolist(), views.frame.tolist(), strict=True):
        frames[t].add(f)
    parent = np.arange(n)

    def root(i: int) -> int:
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = int(parent[i])
        return i

    for k in np.argsort(-score, kind="stable"):
        if score[k] < _OPTIONS.min_merge_score:
            break
        i, j = root(int(a[k])), root(int(b[k]))
        if i != j and len(frames[i] & frames[j]) <= _OPTIONS.max_shared_frames * min(len(frames[i]), len(frames[j])):
            parent[max(i, j)] = min(i, j)
            frames[min(i, j)] |= frames[max(i, j)]
    roots = np.array([root(i) for i in range(n)])
    return np.unique(roots[object_of_view], return_inverse=True)[1].astype(np.int32)
