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
#: Of `without_obstacles`: half the height of the cone of rays at the camera (m), the share of them that a post may
#: hide, the gap between camera and obstacle (m), the least share of the camera's distance, and s over which it moves.
_CONE, _HIDDEN, _GAP, _NEAREST, _MOVING_TIME = 0.3, 0.3, 0.15, 0.2, 0.8
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
    ahead = _ahead(xquat, frames_per_second)
    near = 0.5 + 0.5 * height
    camera_position = xpos[:, 1] + near * (np.array([0.0, 0.0, _UP]) - _BACK * ahead)
    return camera_position.astype(np.float32), _turned(camera_position, xpos, ahead)


def _ahead(xquat: np.ndarray, frames_per_second: float) -> np.ndarray:
    """(T, 3) horizontal unit vectors, the root body's heading smoothed over time."""
    heading = rotations.matrix(xquat[:, 1])[:, :2, 0]
    window = min(round(_SMOOTHING_TIME * frames_per_second) // 2 * 2 + 1, len(heading))
    smooth = np.stack(
        [np.convolve(np.pad(h, window // 2, "edge"), np.ones(window) / window, "valid")[: len(h)] for h in heading.T],
        -1,
    )
    smooth /= np.maximum(np.linalg.norm(smooth, axis=-1, keepdims=True), 1e-6)
    return np.pad(smooth, ((0, 0), (0, 1)))


def _turned(camera_position: np.ndarray, xpos: np.ndarray, ahead: np.ndarray) -> np.ndarray:
    """(T, 4) wxyz, rotations of cameras that look ahead of the root body."""
    target = xpos[:, 1] + 1.5 * ahead
    return np.stack([look_at(e, t) for e, t in zip(camera_position, target, strict=True)]).astype(np.float32)


def views_to_cameras(
    xpos: Float[np.ndarray, "T nbody 3"], cameras: Float[np.ndarray, "T 3"], height: float
) -> tuple[Float[np.ndarray, "T 3"], Float[np.ndarray, "T 4"], Float[np.ndarray, " T"]]:
    """Views from above a robot to a camera that follows it, whose depth `without_obstacles` takes.

    Args:
      xpos: m, of the robot's bodies. cameras: m. height: m, of the robot.

    Returns:
      positions (T, 3) m and wxyz rotations (T, 4) of the views, and their vertical fields of view (T,), rad.
    """
    above = _above(xpos, height)
    turn = np.stack([look_at(p, c) for p, c in zip(above, cameras, strict=True)])
    fov = 2.0 * np.arctan(_CONE / np.linalg.norm(cameras - above, axis=-1))
    return above.astype(np.float32), turn.astype(np.float32), fov.astype(np.float32)


def without_obstacles(
    xpos: Float[np.ndarray, "T nbody 3"],
    xquat: Float[np.ndarray, "T nbody 4"],
    cameras: Float[np.ndarray, "T 3"],
    depth: Float[np.ndarray, "V H W"],
    frames_per_second: float,
    height: float,
) -> tuple[Float[np.ndarray, "T 3"], Float[np.ndarray, "T 4"]]:
    """Positions and wxyz rotations of `following_cameras` that stand in front of what would hide the robot, such as the
    crown of a tree; they approach it smoothly and in time.

    Args:
      xpos: m, xquat: wxyz, T_world_body of the robot's bodies. cameras: m. height: m, of the robot.
      depth: m, 0 = nothing hit, in the views of `views_to_cameras` without the robot, of V frames spread evenly from
        the first to the last.
    """
    above = _above(xpos, height)
    distance = np.linalg.norm(cameras - above, axis=-1)
    free = np.where(depth > 0.0, depth, np.inf).reshape(len(depth), -1)
    free = np.sort(free, axis=1)[:, int(_HIDDEN * free.shape[1])]
    # Each frame is judged by the views on both sides of it.
    at = np.linspace(0.0, len(free) - 1.0, len(cameras))
    free = np.minimum(free[np.floor(at).astype(int)], free[np.ceil(at).astype(int)])
    share = np.clip((free - _GAP) / distance, _NEAREST, 1.0)
    half = max(round(0.5 * _MOVING_TIME * frames_per_second), 1)
    window = np.lib.stride_tricks.sliding_window_view
    least = window(np.pad(share, 2 * half, "edge"), 2 * half + 1).min(1)
    share = window(least, 2 * half + 1).mean(1)
    nearer = above + share[:, None] * (cameras - above)
    return nearer.astype(np.float32), _turned(nearer, xpos, _ahead(xquat, frames_per_second))


def _above(xpos: np.ndarray, height: float) -> np.ndarray:
    """(T, 3) m, a point above the robot."""
    return xpos[:, 1] + np.array([0.0, 0.0, 0.8 * height])


def in_batches(function: Any, *columns: Any) -> np.ndarray:
    """Runs a vmapped function over pytrees of (T, ...) in batches of one size, so that it is compiled once."""
    total = len(jax.tree.leaves(columns)[0])
    size = min(_BATCH, total)
    out = []
    for i in range(0, total, size):
        rows = np.arange(i, i + size) % total
        out.append(np.asarray(function(*jax.tree.map(lambda x, rows=rows: x[rows], columns)))[: total - i])
    return np.concatenate(out)
