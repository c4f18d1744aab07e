"""Loop-consistent poses: where a tour comes by again, things seen both times pull the two passes together.

Drift is slow, so the correction is a shift and a turn about z at knots along the tour, linear in between. Every thing
seen in two passes says that both sightings are one place; between knots the odometry says that the turn hardly changes,
changes evenly, and carries the way with it: a tour that bends by a degree is off by more the farther it goes. Wrong
pairs are outvoted: their weight falls with the square of their misfit (Geman and McClure), whose scale
shrinks from round to round (graduated non-convexity: Yang et al., "Graduated Non-Convexity for Robust Spatial
Perception", 2020).
"""

import dataclasses

import numpy as np
import scipy.spatial
from scipy.spatial.transform import Rotation

from .fusion import Placed
from .lifting import Views

#: Frames without a view after which seeing a thing is a new pass.
_GAP = 15
_KNOT = 8  # frames between knots
#: m; from round to round, how far apart two sightings of one thing may be.
_GATES = (8.0, 6.0, 4.0, 3.0)
#: m; larger things show another middle from another side.
_LARGEST = 2.5
_SIGHTING = 0.3  # m, error of a sighting
#: From knot to knot: m that the way is off beside what the turn does to it, rad by which the turn changes, and rad by
#: which that change changes. Drift of 1 % and 0.3° per 10 m is 0.11 m and 0.34° over a knot of 8 steps of 1.4 m.
_SHIFT_STEP, _TURN_STEP, _BEND_STEP = 0.15, np.radians(0.6), np.radians(0.2)
_ALIKE = 0.9
#: Fewer pairs that agree (to `_AGREED` m) in the end, or pairs that were this near (m) before: poses stay as they are.
_MIN_PAIRS, _OPEN, _AGREED = 8, 0.4, 1.5


@dataclasses.dataclass(frozen=True)
class _Sightings:
    """One row per thing and pass: center (s, 3) m, frame (s,) its middle, label (s,), sigma (s,) m."""

    center: np.ndarray
    frame: np.ndarray
    label: np.ndarray


def close_loops(
    views: Views, placed: Placed, thing: np.ndarray, poses: np.ndarray, alike: np.ndarray
) -> np.ndarray | None:
    """(m, 4, 4) corrected poses, or None where no loop was found or none was open.

    Args:
      views, placed: of the tour. thing: (n,) what each view shows, as far as it was found without loops.
      poses: (m, 4, 4) T_world_camera.
      alike: (L, L) similarity of labels.
    """
    seen = _sightings(views, placed, thing)
    knots = max(2, int(np.ceil((len(poses) - 1) / _KNOT)) + 1)
    places = np.linspace(0, len(poses) - 1, knots)
    at = _blend(np.arange(len(poses)), places)
    correction = np.zeros((knots, 4))
    pairs = np.zeros((0, 2), np.int64)
    for gate in _GATES:
        moved = _moved(seen, at, correction, poses)
        pairs = _pairs(seen, moved, alike, gate)
        if len(pairs) < _MIN_PAIRS:
            return None
        for _ in range(3):
            correction = _solve(seen, pairs, at, correction, poses, gate)
    moved = _moved(seen, at, correction, poses)
    after = np.linalg.norm(moved[pairs[:, 0]] - moved[pairs[:, 1]], axis=1)
    before = np.linalg.norm(seen.center[pairs[:, 0]] - seen.center[pairs[:, 1]], axis=1)
    agree = after < _AGREED
    # Sightings from two sides differ by some centimetres even where poses are perfect.
    if agree.sum() < _MIN_PAIRS or np.median(before[agree]) < max(_OPEN, 2.0 * float(np.median(after[agree]))):
        return None
    full = at @ correction
    out = poses.copy()
    out[:, :3, :3] = Rotation.from_rotvec(full[:, 3:] * [0.0, 0.0, 1.0]).as_matrix() @ poses[:, :3, :3]
    out[:, :3, 3] += full[:, :3]
    return out


def _sightings(views: Views, placed: Placed, thing: np.ndarray) -> _Sightings:
    size = (placed.high - placed.low)[:, :2].max(1)
    usable = np.flatnonzero((size < _LARGEST) & ~views.clipped.any(1))
    order = usable[np.lexsort((views.frame[usable], thing[usable]))]
    if not len(order):
        return _Sightings(np.zeros((0, 3)), np.zeros(0), np.zeros(0, np.int64))
    same = (np.diff(thing[order]) == 0) & (np.diff(views.frame[order]) <= _GAP)
    group = np.r_[0, np.cumsum(~same)]
    weight = 1.0 / placed.sigma[order] ** 2
    total = np.bincount(group, weight)
    center = np.stack([np.bincount(group, weight * placed.center[order, k]) / total for k in range(3)], -1)
    frame = np.bincount(group, weight * views.frame[order]) / total
    first = np.r_[0, np.flatnonzero(~same) + 1]
    # One view alone may be a detector's fancy.
    solid = np.bincount(group) >= 2
    return _Sightings(center[solid], frame[solid], views.label[order][first][solid])


def _blend(frames: np.ndarray, places: np.ndarray) -> np.ndarray:
    """(f, k) weights of knots at frames: linear in between."""
    return np.stack([np.interp(frames, places, row) for row in np.eye(len(places))], -1)


def _rows(seen: _Sightings, at: np.ndarray) -> np.ndarray:
    """(s, k) weights of knots at the sightings."""
    low = np.floor(seen.frame).astype(int)
    part = (seen.frame - low)[:, None]
    return (1 - part) * at[low] + part * at[np.minimum(low + 1, len(at) - 1)]


def _arms(seen: _Sightings, poses: np.ndarray) -> np.ndarray:
    """(s, 2) m from the camera to each sighting."""
    return seen.center[:, :2] - poses[np.round(seen.frame).astype(int), :2, 3]


def _moved(seen: _Sightings, at: np.ndarray, correction: np.ndarray, poses: np.ndarray) -> np.ndarray:
    """(s, 3) m: sightings under a correction (k, 4) of x, y, z, yaw."""
    change = _rows(seen, at) @ correction
    arm = _arms(seen, poses)
    c, s = np.cos(change[:, 3]), np.sin(change[:, 3])
    turned = np.stack([c * arm[:, 0] - s * arm[:, 1], s * arm[:, 0] + c * arm[:, 1]], -1) - arm
    return seen.center + change[:, :3] + np.c_[turned, np.zeros(len(arm))]


def _pairs(seen: _Sightings, moved: np.ndarray, alike: np.ndarray, gate: float) -> np.ndarray:
    """(p, 2) sightings of one label in different passes that are each other's nearest."""
    if len(moved) < 2:
        return np.zeros((0, 2), np.int64)
    tree = scipy.spatial.cKDTree(moved)
    pairs = tree.query_pairs(gate, output_type="ndarray").astype(np.int64)
    apart = np.abs(seen.frame[pairs[:, 0]] - seen.frame[pairs[:, 1]]) > _GAP
    pairs = pairs[apart & (alike[seen.label[pairs[:, 0]], seen.label[pairs[:, 1]]] >= _ALIKE)]
    distance = np.linalg.norm(moved[pairs[:, 0]] - moved[pairs[:, 1]], axis=1)
    nearest = np.full(len(moved), np.inf)
    np.minimum.at(nearest, pairs[:, 0], distance)
    np.minimum.at(nearest, pairs[:, 1], distance)
    return pairs[(distance <= nearest[pairs[:, 0]]) & (distance <= nearest[pairs[:, 1]])]


def _solve(
    seen: _Sightings, pairs: np.ndarray, at: np.ndarray, correction: np.ndarray, poses: np.ndarray, gate: float
) -> np.ndarray:
    """(k, 4) the correction after one step of Gauss-Newton with Geman-McClure weights of scale gate / 2."""
    knots = len(correction)
    weights, arm = _rows(seen, at), _arms(seen, poses)
    moved = _moved(seen, at, correction, poses)
    yaw = (weights @ correction)[:, 3]
    c, s = np.cos(yaw), np.sin(yaw)
    # d(place)/d(yaw) of a turned arm.
    slope = np.stack([-s * arm[:, 0] - c * arm[:, 1], c * arm[:, 0] - s * arm[:, 1], np.zeros(len(arm))], -1)
    i, j = pairs.T
    misfit = moved[i] - moved[j]
    trust = 1.0 / (1.0 + (misfit**2).sum(1) / (gate / 2) ** 2) / _SIGHTING
    blocks, values = [], []
    for axis in range(3):
        block = np.zeros((len(pairs), knots, 4))
        block[:, :, axis] = weights[i] - weights[j]
        block[:, :, 3] = weights[i] * slope[i, axis, None] - weights[j] * slope[j, axis, None]
        blocks.append((block * trust[:, None, None]).reshape(len(pairs), -1))
        values.append(-misfit[:, axis] * trust)
    flat = correction.ravel()
    for block, value in (_odometry(correction, at, poses), _anchor(correction)):
        blocks.append(block)
        values.append(value)
    step, *_ = np.linalg.lstsq(np.concatenate(blocks), np.concatenate(values), rcond=None)
    return (flat + step).reshape(knots, 4)


def _odometry(correction: np.ndarray, at: np.ndarray, poses: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rows of what the odometry says of the correction (k, 4): (r, 4 k) slopes and (r,) what is to be made up."""
    knots = len(correction)
    place = np.array([poses[int(column.argmax()), :3, 3] for column in at.T])
    way = np.diff(place, axis=0)
    change = np.diff(np.eye(knots), axis=0)
    turn = 0.5 * (correction[1:, 3] + correction[:-1, 3])
    c, s = np.cos(turn), np.sin(turn)
    bent = np.stack([(c - 1) * way[:, 0] - s * way[:, 1], s * way[:, 0] + (c - 1) * way[:, 1], 0 * c], -1)
    slope = np.stack([-s * way[:, 0] - c * way[:, 1], c * way[:, 0] - s * way[:, 1], 0 * c], -1)
    middle = 0.5 * np.abs(change)
    blocks, values = [], []
    for axis, sigma in enumerate((_SHIFT_STEP, _SHIFT_STEP, _SHIFT_STEP / 2)):
        block = np.zeros((knots - 1, knots, 4))
        block[:, :, axis] = change
        block[:, :, 3] = -slope[:, axis, None] * middle
        blocks.append(block.reshape(-1, knots * 4) / sigma)
        values.append(-(change @ correction[:, axis] - bent[:, axis]) / sigma)
    for rows, sigma in ((change, _TURN_STEP), (np.diff(np.eye(knots), n=2, axis=0), _BEND_STEP)):
        block = np.zeros((len(rows), knots, 4))
        block[:, :, 3] = rows
        blocks.append(block.reshape(-1, knots * 4) / sigma)
        values.append(-rows @ correction[:, 3] / sigma)
    return np.concatenate(blocks), np.concatenate(values)


def _anchor(correction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rows that hold the first knot."""
    block = np.zeros((4, correction.size))
    block[np.arange(4), np.arange(4)] = 1e3
    return block, -block @ correction.ravel()
