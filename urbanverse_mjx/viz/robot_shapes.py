"""Draws a robot's collision shapes and the spheres that replace them, from three sides."""

from collections.abc import Sequence

import cv2
import mujoco
import numpy as np

from ..datatypes import RobotSpec
from ..robots.collision import Fit

#: (H, W) px of a view, and its margin.
_SIZE, _RIM = (420, 420), 24
#: Name of a view, and the axes of the root's frame that point right and up in it, each with its sign.
_VIEWS = (("from the left", (0, 1), (2, 1)), ("from the front", (1, -1), (2, 1)), ("from above", (0, 1), (1, 1)))
_SHAPE, _SHAPE_RIM, _SPHERE, _FOOT, _INK = (205, 205, 205), (150, 150, 150), (200, 60, 40), (40, 110, 200), (40, 40, 40)


def robot_shapes(robot: RobotSpec, fits: Sequence[Fit]) -> np.ndarray:
    """Returns an image (420, 1260, 3) u8: fitted shapes in grey, spheres as red circles, spheres that may touch the
    ground in blue."""
    model = mujoco.MjModel.from_xml_string(robot.mjcf)
    data = mujoco.MjData(model)
    if model.nkey:
        data.qpos[:] = model.key_qpos[0]
    mujoco.mj_kinematics(model, data)
    shapes = [fit.points @ data.body(fit.body).xmat.reshape(3, 3).T + data.body(fit.body).xpos for fit in fits]
    spheres = np.flatnonzero(model.geom_conaffinity)
    centre, radius = data.geom_xpos[spheres], model.geom_size[spheres, 0]
    feet = np.isin(spheres, [model.geom(name).id for name in robot.foot_geoms])
    low = np.min([*(s.min(0) for s in shapes), (centre - radius[:, None]).min(0)], axis=0)
    high = np.max([*(s.max(0) for s in shapes), (centre + radius[:, None]).max(0)], axis=0)
    scale = (min(_SIZE) - 2 * _RIM) / (high - low).max()
    middle = (low + high) / 2
    views = []
    for name, (right, sign), (up, _) in _VIEWS:
        image = np.full((*_SIZE, 3), 255, np.uint8)

        def pixels(p: np.ndarray, right: int = right, sign: int = sign, up: int = up) -> np.ndarray:
            flat = np.stack([sign * (p - middle)[:, right], -(p - middle)[:, up]], -1) * scale
            return np.rint(flat + np.array(_SIZE[::-1]) / 2).astype(np.int32)

        for shape in shapes:
            outline = cv2.convexHull(pixels(shape))
            cv2.fillConvexPoly(image, outline, _SHAPE, cv2.LINE_AA)
            cv2.polylines(image, [outline], True, _SHAPE_RIM, 1, cv2.LINE_AA)
        for at, r, foot in zip(pixels(centre), radius, feet, strict=True):
            colour = _FOOT if foot else _SPHERE
            cv2.circle(image, (int(at[0]), int(at[1])), round(r * scale), colour, 1, cv2.LINE_AA)
        cv2.putText(image, name, (8, 16), cv2.FONT_HERSHEY_SIMPLEX, 0.45, _INK, 1, cv2.LINE_AA)
        views.append(image)
    return np.concatenate(views, axis=1)
