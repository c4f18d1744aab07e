"""Loop closure: where a trajectory revisits a place, the objects seen in both passes correct the poses.

Drift is slow, so the correction is a shift and a turn about z at control points along the trajectory, linear in
between. Every object observed in two passes constrains both observations to one place; between control points the
odometry constrains the turn to change little and linearly, and the path turns with it: the position error of a
trajectory that bends by a degree grows with distance. Wrong pairs lose their influence: their weight falls with the
square of their misfit (Geman and McClure), whose scale shrinks from round to round (graduated non-convexity: Yang et
al., "Graduated Non-Convexity for Robust Spatial Perception", 2020).
"""

import dataclasses

import numpy as np
import scipy.spatial

from . import control_points
from .fusion import Placed
from .lifting import Views


@dataclasses.dataclass(frozen=True)
class LoopOptions:
    """Conditions and weights of loop closures from an object observed in two passes.

    Chosen manually; `benchmarks.fidelity` measures their effect (docs/decisions/generation.md).

    Attributes:
      pass_gap: frames without a view after which another view of an object starts a new pass.
      gates: m; largest distance between two sightings of one object, one value for each round.
      max_size: m; larger objects are not used, because their visible centre depends on the viewpoint.
      sighting_sigma: m, standard error of a sighting.
      min_similarity: least similarity of two labels that may denote the same object.
      min_pairs: fewest pairs that agree after the last round; with fewer, the poses are not changed.
      agreement: m; distance within which a pair agrees after the last round.
      min_opening: m; the poses are not changed either if the median distance of the agreeing pairs was less than this
        before.
    """

    pass_gap: int = 15
    gates: tuple[float, ...] = (8.0, 6.0, 4.0, 3.0)
    max_size: float = 2.5
    sighting_sigma: float = 0.3
    min_similarity: float = 0.9
    min_pairs: int = 8
    agreement: float = 1.5
    min_opening: float = 0.4


_OPTIONS = LoopOptions()


@dataclasses.dataclass(frozen=True)
class _Sightings:
    """One row per object and pass: center (s, 3) m, frame (s,) in the middle of the pass, label (s,), sigma (s,) m."""

    center: np.ndarray
    frame: np.ndarray
    label: np.ndarray


def close_loops(
    views: Views,
    placed: Placed,
    object_of_view: np.ndarray,
    poses: np.ndarray,
    alike: np.ndarray,
    options: LoopOptions = _OPTIONS,
) -> np.ndarray | None:
    """(m, 4, 4) corrected poses, or None if no loop was found or the loops were closed already.

    Args:
      views, placed: of the trajectory.
      object_of_view: (n,) object of each view, as found without loops.
      poses: (m, 4, 4) T_world_camera.
      alike: (L, L) similarity of labels.
    """
    seen = _sightings(views, placed, object_of_view, options)
    at = control_points.weights(len(poses))
    correction = np.zeros((at.shape[1], 4))
    pairs = np.zeros((0, 2), np.int64)
    for gate in options.gates:
        moved = _moved(seen, at, correction, poses)
        pairs = _pairs(seen, moved, alike, gate, options)
        if len(pairs) < options.min_pairs:
            return None
        for _ in range(3):
            correction = _solve(seen, pairs, at, correction, poses, gate, options.sighting_sigma)
    moved = _moved(seen, at, correction, poses)
    after = np.linalg.norm(moved[pairs[:, 0]] - moved[pairs[:, 1]], axis=1)
    before = np.linalg.norm(seen.center[pairs[:, 0]] - seen.center[pairs[:, 1]], axis=1)
    agree = after < options.agreement
    # Sightings from two sides differ by some centimetres even with perfect poses.
    if agree.sum() < options.min_pairs or np.median(before[agree]) < max(
        options.min_opening, 2.0 * float(np.median(after[agree]))
    ):
        return None
    return control_points.corrected(poses, at @ correction)


def _sightings(views: Views, placed: Placed, object_of_view: np.ndarray, options: LoopOptions) -> _Sightings:
    size = (placed.high - placed.low)[:, :2].max(1)
    usable = np.flatnonzero((size < options.max_size) & ~views.clipped.any(1))
    order = usable[np.lexsort((views.frame[usable], object_of_view[usable]))]
    if not len(order):
        return _Sightings(np.zeros((0, 3)), np.zeros(0), np.zeros(0, np.int64))
    same = (np.diff(object_of_view[order]) == 0) & (np.diff(views.frame[order]) <= options.pass_gap)
    group = np.r_[0, np.cumsum(~same)]
    weight = 1.0 / placed.sigma[order] ** 2
    total = np.bincount(group, weight)
    center = np.stack([np.bincount(group, weight * placed.center[order, k]) / total for k in range(3)], -1)
    frame = np.bincount(group, weight * views.frame[order]) / total
    first = np.r_[0, np.flatnonzero(~same) + 1]
    # A single view may be a false detection.
    solid = np.bincount(group) >= 2
    return _Sightings(center[solid], frame[solid], views.label[order][first][solid])


def _rows(seen: _Sightings, at: np.ndarray) -> np.ndarray:
    """(s, k) weights of control points at the sightings."""
    low = np.floor(seen.frame).astype(int)
    part = (seen.frame - low)[:, None]
    return (1 - part) * at[low] + part * at[np.minimum(low + 1, len(at) - 1)]


def _arms(seen: _Sightings, poses: np.ndarray) -> np.ndarray:
    """(s, 2) m from the camera to each sighting."""
    return seen.center[:, :2] - poses[np.round(seen.frame).astype(int), :2, 3]


def _moved(seen: _Sightings, at: np.ndarray, correction: np.ndarray, poses: np.ndarray) -> np.ndarray:
    """(s, 3) m, positions of the sightings after a correction (k, 4) of x, y, z, yaw."""
    change = _rows(seen, at) @ correction
    arm = _arms(seen, poses)
    c, s = np.cos(change[:, 3]), np.sin(change[:, 3])
    turned = np.stack([c * arm[:, 0] - s * arm[:, 1], s * arm[:, 0] + c * arm[:, 1]], -1) - arm
    return seen.center + change[:, :3] + np.c_[turned, np.zeros(len(arm))]


def _pairs(seen: _Sightings, moved: np.ndarray, alike: np.ndarray, gate: float, options: LoopOptions) -> np.ndarray:
    """(p, 2) pairs of sightings of one label in different passes that are mutual nearest neighbours."""
    if len(moved) < 2:
        return np.zeros((0, 2), np.int64)
    tree = scipy.spatial.cKDTree(moved)
    pairs = tree.query_pairs(gate, output_type="ndarray").astype(np.int64)
    apart = np.abs(seen.frame[pairs[:, 0]] - seen.frame[pairs[:, 1]]) > options.pass_gap
    pairs = pairs[apart & (alike[seen.label[pairs[:, 0]], seen.label[pairs[:, 1]]] >= options.min_similarity)]
    distance = np.linalg.norm(moved[pairs[:, 0]] - moved[pairs[:, 1]], axis=1)
    nearest = np.full(len(moved), np.inf)
    np.minimum.at(nearest, pairs[:, 0], distance)
    np.minimum.at(nearest, pairs[:, 1], distance)
    return pairs[(distance <= nearest[pairs[:, 0]]) & (distance <= nearest[pairs[:, 1]])]


def _solve(
    seen: _Sightings,
    pairs: np.ndarray,
    at: np.ndarray,
    correction: np.ndarray,
    poses: np.ndarray,
    gate: float,
    sigma: float,
) -> np.ndarray:
    """(k, 4) the correction after one Gauss-Newton step with Geman-McClure weights of scale gate / 2; sigma: m,
    standard error of a sighting."""
    count = len(correction)
    weights, arm = _rows(seen, at), _arms(seen, poses)
    moved = _moved(seen, at, correction, poses)
    yaw = (weights @ correction)[:, 3]
    c, s = np.cos(yaw), np.sin(yaw)
    # Derivative of the position with respect to yaw.
    slope = np.stack([-s * arm[:, 0] - c * arm[:, 1], c * arm[:, 0] - s * arm[:, 1], np.zeros(len(arm))], -1)
    i, j = pairs.T
    misfit = moved[i] - moved[j]
    trust = 1.0 / (1.0 + (misfit**2).sum(1) / (gate / 2) ** 2) / sigma
    blocks, values = [], []
    for axis in range(3):
        block = np.zeros((len(pairs), count, 4))
        block[:, :, axis] = weights[i] - weights[j]
        block[:, :, 3] = weights[i] * slope[i, axis, None] - weights[j] * slope[j, axis, None]
        blocks.append((block * trust[:, None, None]).reshape(len(pairs), -1))
        values.append(-misfit[:, axis] * trust)
    flat = correction.ravel()
    for block, value in (control_points.odometry(correction, at, poses), control_points.anchor(correction)):
        blocks.append(block)
        values.append(value)
    step, *_ = np.linalg.lstsq(np.concatenate(blocks), np.concatenate(values), rcond=None)
    return (flat + step).reshape(count, 4)
