"""How a robot stands on level ground: clearance of parts other than feet, and the limit of tipping over.

In:   `RobotSpec`. Out:  `Stance`. When: when a robot is described; simulation does not need it.
"""

import dataclasses

import mujoco
import numpy as np
from scipy.spatial import ConvexHull, QhullError

from ..datatypes import RobotSpec
from .description import at_rest

#: m; feet at most this much above the lowest one carry the robot.
_SUPPORT_HEIGHT = 0.01
_GRAVITY = 9.81


@dataclasses.dataclass(frozen=True)
class Stance:
    """A robot at rest.

    Attributes:
      clearance: m, of the lowest collision sphere other than feet above the ground; below 0 it hits the ground at once.
        None where every collision sphere is a foot.
      margin: m, of the centre of mass inside the area between the feet, seen from above; below 0 the robot falls over.
      height: m, of the centre of mass above the ground.
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
    """m, of a point inside the convex hull of (n, 2) corners; negative outside, or where they lie on a line."""
    try:
        planes = ConvexHull(corners).equations
    except (QhullError, ValueError):  # fewer than three, or all on a line
        return -float(np.linalg.norm(corners - point, axis=1).min())
    return -float((planes[:, :2] @ point + planes[:, 2]).max())
