"""Computes a robot's stance on level ground: clearance of parts other than feet, and the limit of tipping over.

In:   `RobotSpec`. Out:  `Stance`. When: when a robot is described; simulation does not need it.
"""

import dataclasses

import mujoco
import numpy as np
from scipy.spatial import ConvexHull, QhullError

from ..datatypes import RobotSpec
from .description import at_rest

#: m; feet within this height of the lowest one support the robot.
_SUPPORT_HEIGHT = 0.01
_GRAVITY = 9.81


@dataclasses.dataclass(frozen=True)
class Stance:
    """A robot at rest.

    Attributes:
      clearance: m, height of the lowest collision sphere other than feet above the ground; if negative, it has contact
        immediately. None if every collision sphere is a foot.
      margin: m, distance of the centre of mass from the border of the support polygon; if negative, the robot falls
        over.
      height: m, height of the centre of mass above the ground.
    """

    clearance: float | None
    margin: float
    height: float

    @property
    def tips_at(self) -> float:
        """m/s², the acceleration at which a rigid robot tips over its nearest edge: g margin / height."""
        return max(_GRAVITY * self.margin / self.height, 0.0)


def stance(robot: RobotSpec) -> Stance:
    """The stance of a robot in its first keyframe, or in the pose of its MJCF."""
    model = mujoco.MjModel.from_xml_string(robot.mjcf)
    data = at_rest(model)
    mujoco.mj_comPos(model, data)
    feet = [mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, name) for name in robot.foot_geoms]
    bottom = data.geom_xpos[:, 2] - model.geom_size[:, 0]
    ground = bottom[feet].min()
    others = [g for g in np.flatnonzero(model.geom_conaffinity) if g not in feet]
    root = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, robot.root_body)
    centre = data.subtree_com[root]
    carrying = np.array([data.geom_xpos[g, :2] for g in feet if bottom[g] <= ground + _SUPPORT_HEIGHT])
    return Stance(
        clearance=min((float(bottom[g] - ground) for g in others), default=None),
        margin=_inside(carrying, centre[:2]),
        height=float(centre[2] - ground),
    )


def _inside(corners: np.ndarray, point: np.ndarray) -> float:
    """m, distance of a point inside the convex hull of (n, 2) corners from its border; negative outside, or if the
    corners are collinear."""
    try:
        planes = ConvexHull(corners).equations
    except (QhullError, ValueError):  # fewer than three, or all on a line
        return -float(np.linalg.norm(corners - point, axis=1).min())
    return -float((planes[:, :2] @ point + planes[:, 2]).max())
