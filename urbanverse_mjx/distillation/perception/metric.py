"""Makes the structure metric and upright from the known height of the camera above the visible ground."""

import dataclasses

import numpy as np

from ...datatypes import GROUND_KINDS, ValidationError
from .pieces import Piece, cut, join
from .structure import Structure

#: Fewest ground points to which a plane is fitted.
MIN_POINTS = 20


@dataclasses.dataclass(frozen=True)
class MetricOptions:
    """Scale and vertical from the ground under a walker.

    Chosen manually; docs/decisions/gen_perception.md measures their effect on poses.

    Attributes:
      ranges: camera heights; ground nearer than the first gives the camera's height; the second is used if there is no
        nearer ground. The nearest ground is the one that the camera's carrier walks on; the road next to a pavement is
        lower.
      plane_error: share of the camera's height within which points are on the plane; a kerb of 0.15 m under a camera
        at 1.5 m is within.
      trials: random triples of ground points.
      max_tilt: rad; largest angle between the ground's normal and the cameras' mean up direction.
      drift_length: m of path after which the drift of the scale may take another course.
      drift_weight: frames with a height that weigh as much as a change of the scale between two such places, both
        relative; more make the drift stiffer.
      drift_error: share of the camera's height; heights that differ so much from the drift's count half.
      min_heights: fewest cameras with a height of a piece whose drift is corrected.
    """

    ranges: tuple[float, float] = (2.0, 5.0)
    plane_error: float = 0.12
    trials: int = 400
    max_tilt: float = np.radians(25.0)
    drift_length: float = 40.0
    drift_weight: float = 40.0
    drift_error: float = 0.03
    min_heights: int = 20


_OPTIONS = MetricOptions()


@dataclasses.dataclass(frozen=True)
class Metric:
    """A structure in metres, with those n of its m frames that could be located.

    Attributes:
      kept: (n,) rows of the structure's frames, ascending.
      scale: (n,) f64 metres per unit of the structure at each.
      poses: (n, 4, 4) f64 T_world_camera, z up, z = 0 on the ground under the first camera.
      points: (p, 3) f64 m, world.
      ground: (p,) u8 codes of `GROUND_KINDS` by majority of the views of each point; 0 = none, or a point that no kept
        frame sees.
      heights: (n,) f64 m: of each camera above the ground near it, NaN where none is seen.
      pieces: number of pieces from which the structure was joined.
    """

    kept: np.ndarray
    scale: np.ndarray
    poses: np.ndarray
    points: np.ndarray
    ground: np.ndarray
    heights: np.ndarray
    pieces: int


def to_metric(
    structure: Structure, codes: np.ndarray, camera_height: float, time_s: np.ndarray | None = None
) -> Metric:
    """Finds the ground of each piece, rotates the piece so that its ground is level, scales it to the camera height,
    corrects the drift of its scale, and joins the pieces.

    The camera's height is the same everywhere, so where it changes along a piece, the scale does (Song and Chandraker,
    "Robust Scale Estimation in Real-Time Monocular SFM for Autonomous Driving", CVPR 2014). A piece without visible
    ground is scaled to the speed of the others. A piece that cannot be joined is left out.

    Args:
      codes: (o,) u8 surface code that each observation's pixel shows, see `Frame.surfaces`.
      camera_height: m above the ground that the camera's carrier walks on.
      time_s: (n,) s of all frames, which tell where frames were left out; None if none were.

    Raises:
      ValidationError: too little ground among the points.
    """
    ground = _vote(structure, codes)
    if (ground > 0).sum() < MIN_POINTS:
        raise ValidationError(
            f"metric scale: found {(ground > 0).sum()} points on the ground, needed {MIN_POINTS}; film with the ground "
            "in the lower half of the image."
        )
    rows = cut(structure.model, structure.registered, structure.poses)
    owner = _owner(structure, rows)
    stands = [_stand(structure, own, structure.points[(ground > 0) & (owner == n)]) for n, own in enumerate(rows)]
    scales = _scales(structure, rows, [heights for _, heights in stands], camera_height)
    at = _intervals(structure, time_s)
    made = [
        _upright(structure, own, at[own], up, scale, camera_height / (scale * heights))
        for own, (up, heights), scale in zip(rows, stands, scales, strict=True)
    ]
    pieces, moved, factors = zip(*made, strict=True)
    places = join(pieces)
    joined = {n: place for n, place in enumerate(places) if place is not None}
    kept = np.concatenate([rows[n] for n in joined])
    poses = np.concatenate([place @ pieces[n].poses for n, place in joined.items()])
    scale = np.concatenate([scales[n] * factors[n] for n in joined])
    heights = scale * np.concatenate([stands[n][1] for n in joined])
    order = np.argsort(kept)
    kept, poses, heights, scale = kept[order], poses[order], heights[order], scale[order]
    world = np.eye(4)
    world[:3, :3] = _level(np.array([0.0, 0.0, 1.0]), poses[:, :3, 3])
    world[:3, 3] = -world[:3, :3] @ (poses[0, :3, 3] - [0.0, 0.0, heights[np.isfinite(heights)][0]])
    points = np.zeros((len(structure.points), 3))
    for n, place in joined.items():
        T = world @ place
        points[owner == n] = moved[n][owner == n] @ T[:3, :3].T + T[:3, 3]
    ground = np.where(np.isin(owner, list(joined)), ground, 0).astype(np.uint8)
    return Metric(kept, scale, world @ poses, points, ground, heights, len(joined))


def _intervals(structure: Structure, time_s: np.ndarray | None) -> np.ndarray:
    """(m,) times of the registered frames in usual intervals between frames."""
    if time_s is None or len(time_s) < 2:
        return structure.registered.astype(np.float64)
    return time_s[structure.registered] / max(float(np.median(np.diff(time_s))), 1e-9)


def _owner(structure: Structure, rows: list[np.ndarray]) -> np.ndarray:
    """(p,) number of the piece whose frames see each point most often, -1 if none does."""
    piece = np.full(len(structure.registered), len(rows), np.int64)
    for n, own in enumerate(rows):
        piece[own] = n
    votes = np.zeros((len(structure.points), len(rows) + 1), np.int64)
    np.add.at(votes, (structure.point, piece[structure.frame]), 1)
    return np.where(votes[:, :-1].any(1), votes[:, :-1].argmax(1), -1)


def _stand(structure: Structure, rows: np.ndarray, on_ground: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Up direction (3,) of a piece in the structure's axes, and the height (k,) of each camera above the ground points
    (g, 3) in the piece's unit, NaN if none are visible."""
    cameras = structure.poses[rows, :3, 3]
    rough = -structure.poses[rows, :3, 1].mean(0)
    rough /= np.linalg.norm(rough)
    if len(on_ground) < MIN_POINTS:
        return rough, np.full(len(rows), np.nan)
    up = _normal(on_ground, cameras, rough)
    return up, _heights(on_ground, cameras, up)


def _scales(
    structure: Structure, rows: list[np.ndarray], heights: list[np.ndarray], camera_height: float
) -> list[float]:
    """Metres per unit of every piece: from its cameras' height, else from the speed of those that have one."""
    steps = [structure.step(k) for k in rows]
    scales = [camera_height / float(np.nanmedian(h)) if np.isfinite(h).any() else np.nan for h in heights]
    if np.isnan(scales).all():
        raise ValidationError(
            "metric scale: found no ground near any camera, needed some; film with the ground in sight."
        )
    if not np.isnan(scales).any():
        return scales
    speed = float(np.nanmedian(np.array(scales) * steps))
    return [speed / max(float(u), 1e-12) if np.isnan(s) else s for s, u in zip(scales, steps, strict=True)]


def _upright(
    structure: Structure, rows: np.ndarray, at: np.ndarray, up: np.ndarray, scale: float, corrections: np.ndarray
) -> tuple[Piece, np.ndarray, np.ndarray]:
    """A piece in metres with its first camera at the origin; pieces of one model share the x direction. Also all points
    (p, 3) m of the structure in the piece's axes, and the factor (k,) by which the scale at each frame was corrected.

    Args:
      at: (k,) of `Piece`.
      corrections: (k,) factors that each camera's height asks for, NaN without a height.
    """
    model = int(structure.model[rows[0]])
    turn = _axes(up, structure.poses[structure.model == model][0, :3, 0])
    first = structure.poses[rows[0], :3, 3]
    centres = scale * (structure.poses[rows, :3, 3] - first) @ turn.T
    points = scale * (structure.points - first) @ turn.T
    factors = _drift(centres, corrections)
    moved = np.zeros_like(centres)
    np.cumsum(np.diff(centres, axis=0) * (factors[1:] + factors[:-1])[:, None] / 2, axis=0, out=moved[1:])
    # A point moves with the frames that see it.
    row = np.full(len(structure.registered), -1)
    row[rows] = np.arange(len(rows))
    own = row[structure.frame]
    point, own = structure.point[own >= 0], own[own >= 0]
    times = np.bincount(point, minlength=len(points))
    goal = moved[own] + factors[own, None] * (points[point] - centres[own])
    for axis in range(3):
        total = np.bincount(point, goal[:, axis], minlength=len(points))
        points[times > 0, axis] = total[times > 0] / times[times > 0]
    poses = np.tile(np.eye(4), (len(rows), 1, 1))
    poses[:, :3, :3] = turn @ structure.poses[rows, :3, :3]
    poses[:, :3, 3] = moved
    # Points that other pieces see more often are included too, because they determine the rotation between overlapping
    # pieces.
    return Piece(rows, structure.registered[rows], at, model, poses, points[times >= 2]), points, factors


def _drift(centres: np.ndarray, corrections: np.ndarray) -> np.ndarray:
    """(k,) factors of the scale along a path of centres (k, 3) m: their logarithm is linear between places
    `drift_length` apart and fits the corrections that are known, except outliers (kerbs, wrong ground)."""
    known = np.isfinite(corrections)
    along = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(centres, axis=0), axis=1))]
    if known.sum() < _OPTIONS.min_heights or along[-1] <= 0.0:
        return np.ones(len(centres))
    count = int(np.ceil(along[-1] / _OPTIONS.drift_length)) + 1
    place = along / along[-1] * (count - 1)
    weights = np.maximum(1.0 - np.abs(place[:, None] - np.arange(count)), 0.0)
    stiff = np.sqrt(_OPTIONS.drift_weight) * np.diff(np.eye(count), axis=0)
    asked = np.log(corrections[known])
    drift = np.full(count, np.median(asked))
    # From errors that no height exceeds: with small ones from the start, a large drift looks like outliers.
    for error in _OPTIONS.drift_error * np.geomspace(10.0, 1.0, 12):
        trust = 1.0 / np.hypot(1.0, (asked - weights[known] @ drift) / error)
        lines, values = trust[:, None] * weights[known], trust * asked
        drift = np.linalg.lstsq(np.concatenate([lines, stiff]), np.r_[values, np.zeros(count - 1)], rcond=None)[0]
    return np.exp(weights @ drift)


def _vote(structure: Structure, codes: np.ndarray) -> np.ndarray:
    """(p,) u8: the kind of ground that more than half of a point's views saw, else 0."""
    kinds = len(GROUND_KINDS)
    known = np.where(codes < kinds, codes, 0).astype(np.int64)
    votes = np.zeros((len(structure.points), kinds), np.int64)
    np.add.at(votes, (structure.point, known), 1)
    best = votes.argmax(1)
    return np.where(votes.max(1) * 2 > votes.sum(1), best, 0).astype(np.uint8)


def _normal(points: np.ndarray, cameras: np.ndarray, rough: np.ndarray) -> np.ndarray:
    """(3,) upward unit normal of the ground, by RANSAC over triples of points and least squares over the inliers.

    The inlier distance is a share of the camera's height, because slopes bend the ground.
    """
    height = float(np.median((cameras.mean(0) - points) @ rough))
    reach = _OPTIONS.plane_error * abs(height)
    random = np.random.default_rng(0)
    best, most = np.zeros(len(points), bool), 0
    for _ in range(_OPTIONS.trials):
        a, b, c = points[random.choice(len(points), 3, replace=False)]
        normal = np.cross(b - a, c - a)
        length = np.linalg.norm(normal)
        if length < 1e-12:
            continue
        normal *= np.sign(normal @ rough) / length
        if normal @ rough < np.cos(_OPTIONS.max_tilt):
            continue
        near = np.abs((points - a) @ normal) < reach
        if near.sum() > most:
            best, most = near, int(near.sum())
    if most < MIN_POINTS:
        return rough
    centred = points[best] - points[best].mean(0)
    normal = np.linalg.svd(centred, full_matrices=False)[2][2]
    normal *= np.sign(normal @ rough)
    # Points along one line do not determine the plane's angle about it.
    return normal if normal @ rough > np.cos(_OPTIONS.max_tilt) else rough


def _heights(points: np.ndarray, cameras: np.ndarray, up: np.ndarray) -> np.ndarray:
    """(m,) height of each camera above the median of the ground near it, NaN if there is none."""
    out = np.full(len(cameras), np.nan)
    usual = abs(float(np.median((cameras.mean(0) - points) @ up)))
    for k, camera in enumerate(cameras):
        down = (camera - points) @ up
        aside = np.linalg.norm(points - camera + down[:, None] * up, axis=1)
        below = down > 0.2 * usual
        found = [down[below & (aside < reach * usual)] for reach in _OPTIONS.ranges]
        near = next((heights for heights in found if len(heights) >= 3), None)
        if near is not None:
            out[k] = np.median(near)
    return out


def _level(up: np.ndarray, cameras: np.ndarray) -> np.ndarray:
    """(3, 3) rotation that maps up to z and the direction from the first camera to the farthest to x."""
    return _axes(up, cameras[np.argmax(np.linalg.norm(cameras - cameras[0], axis=1))] - cameras[0])


def _axes(up: np.ndarray, forward: np.ndarray) -> np.ndarray:
    """(3, 3) rotation that maps up to z and the horizontal part of `forward` to x."""
    along = forward - (forward @ up) * up
    if np.linalg.norm(along) < 1e-9:
        along = np.cross(up, [0.0, 1.0, 0.0] if abs(up[1]) < 0.9 else [1.0, 0.0, 0.0])
    along /= np.linalg.norm(along)
    return np.stack([along, np.cross(up, along), up])
