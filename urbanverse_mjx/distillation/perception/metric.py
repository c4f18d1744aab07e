"""Structure becomes metric and upright: the camera is carried at a known height above the ground that it sees."""

import dataclasses

import numpy as np

from ...datatypes import GROUND_KINDS, NounError
from .structure import Structure

#: Ground points fewer than this fit no plane worth the name.
MIN_POINTS = 20
#: Ground nearer than so many camera heights says how high the camera is.
_NEAR = 5.0
#: Of the camera's height: what still lies on the plane; a kerb of 0.15 m under a camera at 1.5 m is within.
_THICKNESS = 0.12
_TRIALS = 400
#: Walkers hold a camera level to this angle: the normal of the ground is within it of the cameras' mean up.
_TILT = np.radians(25.0)


@dataclasses.dataclass(frozen=True)
class Metric:
    """A structure in metres.

    Attributes:
      scale: metres per unit of the structure.
      poses: (m, 4, 4) f64 T_world_camera, z up, z = 0 on the ground under the first camera.
      points: (p, 3) f64 m, world. ground: (p,) u8 codes of `GROUND_KINDS` that most views of the point saw; 0 = none.
      heights: (m,) f64 m: of each camera above the ground near it, NaN where none is seen.
    """

    scale: float
    poses: np.ndarray
    points: np.ndarray
    ground: np.ndarray
    heights: np.ndarray


def to_metric(structure: Structure, codes: np.ndarray, camera_height: float) -> Metric:
    """Finds the ground, turns it level, and scales until the cameras are at their height above it.

    Args:
      codes: (o,) u8 surface code that each observation's pixel shows, see `Frame.surfaces`.
      camera_height: m above the ground walked on.

    Raises:
      NounError: too little ground among the points.
    """
    ground = _vote(structure, codes)
    on_ground = structure.points[ground > 0]
    if len(on_ground) < MIN_POINTS:
        raise NounError(
            f"metric scale: found {len(on_ground)} points on the ground, needed {MIN_POINTS}; film with the ground in "
            "the lower half of the picture."
        )
    rough = -structure.poses[:, :3, 1].mean(0)
    up = _normal(on_ground, structure.poses[:, :3, 3], rough / np.linalg.norm(rough))
    heights = _heights(on_ground, structure.poses[:, :3, 3], up)
    if np.isnan(heights).all():
        raise NounError("metric scale: found no ground near any camera, needed some; film with the ground in sight.")
    scale = camera_height / float(np.nanmedian(heights))
    turn = _level(up, structure.poses[:, :3, 3])
    first = heights[np.flatnonzero(~np.isnan(heights))[0]]
    origin = structure.poses[0, :3, 3] - first * up
    poses = np.tile(np.eye(4), (len(structure.poses), 1, 1))
    poses[:, :3, :3] = turn @ structure.poses[:, :3, :3]
    poses[:, :3, 3] = scale * (structure.poses[:, :3, 3] - origin) @ turn.T
    return Metric(scale, poses, scale * (structure.points - origin) @ turn.T, ground, scale * heights)


def _vote(structure: Structure, codes: np.ndarray) -> np.ndarray:
    """(p,) u8: the kind of ground that more than half of a point's views saw, else 0."""
    kinds = len(GROUND_KINDS)
    known = np.where(codes < kinds, codes, 0).astype(np.int64)
    votes = np.zeros((len(structure.points), kinds), np.int64)
    np.add.at(votes, (structure.point, known), 1)
    best = votes.argmax(1)
    return np.where(votes.max(1) * 2 > votes.sum(1), best, 0).astype(np.uint8)


def _normal(points: np.ndarray, cameras: np.ndarray, rough: np.ndarray) -> np.ndarray:
    """(3,) unit normal of the ground, upwards: random triples, then least squares over what agrees.

    Slopes bend the whole, so that a point only has to agree within a share of the camera's height.
    """
    height = float(np.median((cameras.mean(0) - points) @ rough))
    reach = _THICKNESS * abs(height)
    random = np.random.default_rng(0)
    best, most = np.zeros(len(points), bool), 0
    for _ in range(_TRIALS):
        a, b, c = points[random.choice(len(points), 3, replace=False)]
        normal = np.cross(b - a, c - a)
        length = np.linalg.norm(normal)
        if length < 1e-12:
            continue
        normal *= np.sign(normal @ rough) / length
        if normal @ rough < np.cos(_TILT):
            continue
        near = np.abs((points - a) @ normal) < reach
        if near.sum() > most:
            best, most = near, int(near.sum())
    if most < MIN_POINTS:
        return rough
    centred = points[best] - points[best].mean(0)
    normal = np.linalg.svd(centred, full_matrices=False)[2][2]
    normal *= np.sign(normal @ rough)
    # Points along one line fit planes at any angle about it.
    return normal if normal @ rough > np.cos(_TILT) else rough


def _heights(points: np.ndarray, cameras: np.ndarray, up: np.ndarray) -> np.ndarray:
    """(m,) of each camera above the middle of the ground near it, NaN where there is none."""
    out = np.full(len(cameras), np.nan)
    usual = abs(float(np.median((cameras.mean(0) - points) @ up)))
    for k, camera in enumerate(cameras):
        down = (camera - points) @ up
        aside = np.linalg.norm(points - camera + down[:, None] * up, axis=1)
        near = down[(aside < _NEAR * usual) & (down > 0.2 * usual)]
        if len(near) >= 3:
            out[k] = np.median(near)
    return out


def _level(up: np.ndarray, cameras: np.ndarray) -> np.ndarray:
    """(3, 3) rotation that turns up to z and the way from the first camera to the farthest to x."""
    way = cameras[np.argmax(np.linalg.norm(cameras - cameras[0], axis=1))] - cameras[0]
    along = way - (way @ up) * up
    if np.linalg.norm(along) < 1e-9:
        along = np.cross(up, [0.0, 1.0, 0.0] if abs(up[1]) < 0.9 else [1.0, 0.0, 0.0])
    along /= np.linalg.norm(along)
    return np.stack([along, np.cross(up, along), up])
