"""Computes dense depth: the single-image prediction, fitted to the reconstruction and to the ground.

* The depth of ground is where the ray meets the level of its kind of ground near the camera.
* An object keeps the shape of the predicted depth; its distance is the weighted mean (of logarithms) of the points
  inside its mask, of its contact with the ground, and of the prediction.
* All other pixels take the prediction, scaled as a whole. The sky has no depth.
"""

import dataclasses

import numpy as np

from ...datatypes import GROUND_KINDS, Camera
from ...datatypes.recording import SKY
from .metric import Metric
from .observation import FrameObservation
from .structure import Structure


@dataclasses.dataclass(frozen=True)
class DepthOptions:
    """Weights of the estimates of a pixel's depth.

    Chosen manually; docs/decisions/gen_perception.md measures their effect on depth.

    Attributes:
      ground_range: m; beyond it the viewing angle is too flat to derive distance from the ground's height.
      level_range: m; ground points within this distance of the camera determine the height of their kind of ground.
      min_level_points: fewest such points.
      point_error: relative error (1 sigma) of a single point's depth.
      foot_error: relative error of the depth of an object's foot.
      guess_error: relative error of the network's depth after scaling.
      shared_point_error: common relative error of the points of one mask (all lie on one side of the object), a lower
        limit of the mean's error.
      foot_share: share of a mask's height within which its lowest pixels touch the ground; higher ones are gaps between
        wheels.
      min_points: fewest points from which an object's depth is estimated.
    """

    ground_range: float = 40.0
    level_range: float = 15.0
    min_level_points: int = 8
    point_error: float = 0.1
    foot_error: float = 0.06
    guess_error: float = 0.15
    shared_point_error: float = 0.03
    foot_share: float = 0.15
    min_points: int = 3


_OPTIONS = DepthOptions()


@dataclasses.dataclass(frozen=True)
class Levels:
    """Ground heights near each camera: (m, kinds) f64 m above the world's origin."""

    z: np.ndarray


def levels(metric: Metric) -> Levels:
    """Height of every kind of ground near every camera; a kind not seen there gets the mean height of all ground
    there."""
    cameras = metric.poses[:, :3, 3]
    known = ~np.isnan(metric.heights)
    frames = np.arange(len(cameras))
    height = np.interp(frames, frames[known], metric.heights[known])
    z = np.repeat((cameras[:, 2] - height)[:, None], len(GROUND_KINDS), 1)
    for k, camera in enumerate(cameras):
        near = np.linalg.norm(metric.points[:, :2] - camera[:2], axis=1) < _OPTIONS.level_range
        for kind in np.unique(metric.ground[near & (metric.ground > 0)]):
            own = metric.points[near & (metric.ground == kind), 2]
            if len(own) >= _OPTIONS.min_level_points:
                z[k, kind] = np.median(own)
    return Levels(z)


def dense_depth(
    row: int, observation: FrameObservation, structure: Structure, metric: Metric, ground: Levels
) -> np.ndarray:
    """(H, W) f32 m along the axis of a registered frame's camera; 0 where unknown.

    Args:
      row: of the registered frames.
      observation: what the straightened frame shows.
    """
    flat = _ground_depth(structure.camera, metric.poses[row], observation.surfaces, ground.z[row])
    mine = structure.frame == row
    pixel = np.floor(structure.pixel[mine]).astype(int)
    inside = (pixel >= 0).all(1) & (pixel < [structure.camera.width, structure.camera.height]).all(1)
    columns, rows = pixel[inside].T
    points = (structure.depth()[mine] * metric.scale[row])[inside]
    # Without a prediction, an object is a plane that faces the camera, and other pixels stay unknown.
    guess = np.ones_like(flat) if observation.depth is None else observation.depth.astype(np.float64)
    ratio = np.log(np.maximum(points, 1e-3) / np.maximum(guess[rows, columns], 1e-3))
    overall = _overall(ratio, flat, guess)
    out = guess * np.exp(overall) if observation.depth is not None else np.zeros_like(flat)
    owner = observation.masks[rows, columns]
    for k, box in enumerate(_boxes(observation.masks, len(observation.detections))):
        if box is None:
            continue
        mask = observation.masks[box] == k
        estimates = [(overall, _OPTIONS.guess_error)] if observation.depth is not None else []
        own = ratio[owner == k]
        if len(own) >= _OPTIONS.min_points:
            error = np.hypot(_OPTIONS.point_error / np.sqrt(len(own)), _OPTIONS.shared_point_error)
            estimates.append((float(np.median(own)), float(error)))
        foot = _foot(mask, box, flat, guess)
        if foot is not None:
            estimates.append((foot, _OPTIONS.foot_error))
        if estimates:
            value, sigma = np.array(estimates).T
            out[box][mask] = guess[box][mask] * np.exp(np.average(value, weights=sigma**-2.0))
    out = np.where(flat > 0, flat, out)
    return np.where(observation.surfaces == SKY, 0.0, out).astype(np.float32)


def _ground_depth(camera: Camera, pose: np.ndarray, surfaces: np.ndarray, z: np.ndarray) -> np.ndarray:
    """(H, W) f64 m, 0 where there is no ground or it is too far."""
    fall = camera.rays() @ pose[2, :3]
    kind = np.where(surfaces < len(GROUND_KINDS), surfaces, 0)
    drop = z[kind] - pose[2, 3]
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = drop / fall
    return np.where((kind > 0) & (fall < 0) & (drop < 0) & (depth < _OPTIONS.ground_range), depth, 0.0)


def _overall(ratio: np.ndarray, flat: np.ndarray, guess: np.ndarray) -> float:
    """Logarithm of the scale of a frame's prediction: half from its points, half from its ground."""
    at = flat[::4, ::4] > 0
    from_ground = np.log(flat[::4, ::4][at] / np.maximum(guess[::4, ::4][at], 1e-3))
    parts = [float(np.median(x)) for x in (ratio, from_ground) if len(x) >= 10]
    return float(np.mean(parts)) if parts else 0.0


def _boxes(masks: np.ndarray, count: int) -> list[tuple[slice, slice] | None]:
    from scipy import ndimage

    found = ndimage.find_objects(masks + 1, count)
    return [None if f is None else (f[0], f[1]) for f in found]


def _foot(mask: np.ndarray, box: tuple[slice, slice], flat: np.ndarray, guess: np.ndarray) -> float | None:
    """Logarithm of the scale that puts an object's foot on the ground; None if its foot is not visible."""
    columns = np.flatnonzero(mask.any(0))
    low = mask.shape[0] - 1 - mask[::-1, columns].argmax(0)
    stands = low >= (1.0 - _OPTIONS.foot_share) * (mask.shape[0] - 1)
    rows, columns = low[stands] + box[0].start, columns[stands] + box[1].start
    inside = rows + 1 < flat.shape[0]
    below = flat[rows[inside] + 1, columns[inside]]
    if (below > 0).sum() < max(2, 0.3 * len(rows)):
        return None
    guessed = guess[rows[inside], columns[inside]][below > 0]
    return float(np.median(np.log(below[below > 0] / np.maximum(guessed, 1e-3))))
