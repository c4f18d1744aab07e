"""Cameras for videos and images: towards a point, and behind a robot."""

from typing import Any

import jax
import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from ...datatypes import ValidationError
from ...geometry import rotations

#: Vertical field of view of `following_cameras`, rad.
FOLLOWING_FOV = 1.05
#: Of a robot 1 m high; one half as high is seen from three quarters of that.
_BACK, _UP = 3.2, 1.9  # m
_SMOOTHING_TIME = 1.8  # s
_BATCH = 16


def look_at(camera_position: Any, target: Any, up: Any = (0.0, 0.0, 1.0)) -> np.ndarray:
    """(4,) wxyz rotation R_world_camera of a camera at `camera_position` towards `target` with `up` upwards (3,) each.

    Raises:
      ValidationError: camera position and target coincide, or the view is along `up`.
    """
    back = np.asarray(camera_position, np.float64) - np.asarray(target, np.float64)
    right = np.cross(np.asarray(up, np.float64), back)
    if np.linalg.norm(back) < 1e-9 or np.linalg.norm(right) < 1e-9 * np.linalg.norm(back):
        raise ValidationError(
            f"camera: found position {camera_position}, target {target}; needed points not above one another; move one"
        )
    back, right = back / np.linalg.norm(back), right / np.linalg.norm(right)
    return Rotation.from_matrix(np.column_stack([right, np.cross(back, right), back])).as_quat(scalar_first=True)


def following_cameras(
    xpos: Float[np.ndarray, "T nbody 3"], xquat: Float[np.ndarray, "T nbody 4"], frames_per_second: float, height: float
) -> tuple[Float[np.ndarray, "T 3"], Float[np.ndarray, "T 4"]]:
    """Position (T, 3) and wxyz rotation (T, 4) of a camera behind the root body, its heading smoothed over two seconds.

    Args:
      xpos: m, xquat: wxyz, T_world_body of the robot's bodies.
      height: m, of the robot.
    """
    heading = rotations.matrix(xquat[:, 1])[:, :2, 0]
    window = min(round(_SMOOTHING_TIME * frames_per_second) // 2 * 2 + 1, len(heading))
    smooth = np.stack(
        [np.convolve(np.pad(h, window // 2, "edge"), np.ones(window) / window, "valid")[: len(h)] for h in heading.T],
        -1,
    )
    smooth /= np.maximum(np.linalg.norm(smooth, axis=-1, keepdims=True), 1e-6)
    root = xpos[:, 1]
    near = 0.5 + 0.5 * height
    camera_position = root + near * (np.array([0.0, 0.0, _UP]) - _BACK * np.pad(smooth, ((0, 0), (0, 1))))
    target = root + 1.5 * np.pad(smooth, ((0, 0), (0, 1)))
    turn = np.stack([look_at(e, t) for e, t in zip(camera_position, target, strict=True)])
    return camera_position.astype(np.float32), turn.astype(np.float32)


def in_batches(function: Any, *columns: Any) -> np.ndarray:
    """Runs a vmapped function over pytrees of (T, ...) in batches of one size, so that it is compiled once."""
    total = len(jax.tree.leaves(columns)[0])
    size = min(_BATCH, total)
    out = []
    for i in range(0, total, size):
        rows = np.arange(i, i + size) % total
        out.append(np.asarray(function(*jax.tree.map(lambda x, rows=rows: x[rows], columns)))[: total - i])
    return np.concatenate(out)
