"""Poses in which a rigid body of uniform density rests on level ground, from its collision hulls.

A body rests on a facet of the convex hull of all its hulls if the perpendicular from its centre of mass meets the facet
(Goldberg et al., "Part pose statistics: estimators and experiments", IEEE Trans. Robotics and Automation 15, 1999).
"""

import dataclasses
from collections.abc import Sequence

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from .rigid_body import convex_surface

#: rad; an object stands if it comes to rest this near to upright, on a facet that it leaves only when tipped by more
#: than the second angle. Garbage bags settle by 3.8 degrees; hulls that touch the ground in a narrow line have 0.3.
STAND, LEAST_MARGIN = np.radians(5.0), np.radians(0.5)
#: rad; poses that turn an object farther lay it on its head and are not considered.
MOST_TURN = np.radians(100.0)
#: m; corners this near to a facet's plane belong to it.
_ON_PLANE = 1e-3
#: rad; margins that differ by less are equal: a kite lies on its front as firmly as on its back.
_EQUAL = np.radians(0.5)


@dataclasses.dataclass(frozen=True)
class RestPose:
    """A pose at rest.

    Attributes:
      down: (3,) unit vector in the asset frame that points downwards.
      turn: rad, angle between this pose and upright.
      margin: rad, the least angle by which the body has to be tipped to leave the pose.
    """

    down: np.ndarray
    turn: float
    margin: float


def rest_poses(hulls: Sequence[np.ndarray]) -> list[RestPose]:
    """The poses in which hulls (each (n, 3) m, asset frame) rest as one body, those nearest to upright first."""
    solids = [convex_surface(h) for h in hulls]
    volumes = np.array([s.volume for s in solids])
    centre = volumes @ np.array([s.center_mass for s in solids]) / volumes.sum()
    points = np.concatenate([np.asarray(h, np.float64) for h in hulls])
    found: list[RestPose] = []
    for x, y, z, offset in ConvexHull(points).equations:
        down = np.array([x, y, z])
        if any(down @ pose.down > 1.0 - 1e-6 for pose in found):
            continue
        inside = _inside(points[np.abs(points @ down + offset) < _ON_PLANE], centre, down)
        if inside > 0.0:
            height = -float(centre @ down + offset)
            found.append(RestPose(down, float(np.arccos(np.clip(-z, -1.0, 1.0))), float(np.arctan2(inside, height))))
    return sorted(found, key=lambda pose: pose.turn)


def stands(hulls: Sequence[np.ndarray]) -> bool:
    """Whether hulls come to rest nearly upright when they are put on level ground."""
    return any(pose.turn <= STAND and pose.margin >= LEAST_MARGIN for pose in rest_poses(hulls))


def firmest_pose(hulls: Sequence[np.ndarray]) -> RestPose | None:
    """The pose that takes most to tip over, of equal ones the nearest to upright; None if there is none within
    `MOST_TURN`."""
    poses = [pose for pose in rest_poses(hulls) if pose.turn <= MOST_TURN]
    if not poses:
        return None
    most = max(pose.margin for pose in poses)
    equal = [pose for pose in poses if pose.margin > most - _EQUAL]
    return min(equal, key=lambda pose: (round(pose.turn, 3), *np.round(pose.down, 3).tolist()))


def _inside(facet: np.ndarray, centre: np.ndarray, down: np.ndarray) -> float:
    """m from the foot of the perpendicular from `centre` to the border of a facet (n, 3); negative outside, and -inf
    for a facet without area."""
    across = np.cross(down, np.identity(3)[int(np.argmin(np.abs(down)))])
    across /= np.linalg.norm(across)
    axes = np.stack([across, np.cross(down, across)], 1)
    try:
        border = ConvexHull(facet @ axes).equations
    except (QhullError, ValueError):
        return -np.inf
    return -float((border[:, :2] @ (centre @ axes) + border[:, 2]).max())
