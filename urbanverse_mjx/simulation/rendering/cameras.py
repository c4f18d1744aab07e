"""Cameras for videos and images: towards a point, and behind a robot."""

from collections.abc import Callable
from typing import Any

import jax
import numpy as np
from jaxtyping import Float, Int
from scipy.spatial.transform import Rotation

from ...datatypes import ValidationError
from ...geometry import rotations

#: Vertical field of view of `following_cameras`, rad.
FOLLOWING_FOV = 1.05
#: Of a robot 1 m high; one half as high is seen from three quarters of that.
_BACK, _UP = 3.2, 1.9  # m
_SMOOTHING_TIME = 1.8  # s
#: Of `without_obstacles`: shares of the camera's distance that are tried, half the height of what is looked at around
#: the robot (m), the share of it that must be seen, the gap before it (m), and s over which the camera moves.
_SHARES = (1.0, 0.8, 0.65, 0.5, 0.35, 0.2)
_AROUND, _SEEN, _GAP, _MOVING_TIME = 0.5, 0.7, 0.15, 0.8
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


def free_shares(
    look: Callable[[np.ndarray, np.ndarray, np.ndarray, np.ndarray], np.ndarray],
    xpos: Float[np.ndarray, "V nbody 3"],
    cameras: Float[np.ndarray, "V 3"],
    height: float,
) -> Float[np.ndarray, " V"]:
    """Largest shares of the distance of cameras from a robot from where it is seen, which `without_obstacles` takes.

    Args:
      look: planar depth (n, H, W) m, 0 = nothing hit, without the robot, of the views at rows (n,) of the frames, with
        positions (n, 3) m, wxyz rotations (n, 4) and vertical fields of view (n,) rad. Called for fewer rows each time.
      xpos: m, of the robot's bodies. cameras: m. height: m, of the robot.
    """
    above = _above(xpos, height)
    distance = np.linalg.norm(cameras - above, axis=-1)
    free, hidden = np.full(len(cameras), _SHARES[-1]), np.arange(len(cameras))
    for share in _SHARES[:-1]:
        if not len(hidden):
            break
        targets, away = above[hidden], share * distance[hidden]
        places = targets + share * (cameras[hidden] - targets)
        turn = np.stack([look_at(e, t) for e, t in zip(places, targets, strict=True)])
        fov = 2.0 * np.arctan(_AROUND / away)
        depth = look(hidden, *(x.astype(np.float32) for x in (places, turn, fov)))
        seen = ((depth == 0.0) | (depth > away[:, None, None] - _GAP)).mean((1, 2)) >= _SEEN
        free[hidden[seen]] = share
        hidden = hidden[~seen]
    return free


def without_obstacles(
    xpos: Float[np.ndarray, "T nbody 3"],
    xquat: Float[np.ndarray, "T nbody 4"],
    cameras: Float[np.ndarray, "T 3"],
    looks: Int[np.ndarray, " V"],
    free: Float[np.ndarray, " V"],
    frames_per_second: float,
    height: float,
) -> tuple[Float[np.ndarray, "T 3"], Float[np.ndarray, "T 4"]]:
    """Positions and wxyz rotations of `following_cameras` that stand in front of what would hide the robot, such as the
    crown of a tree; they approach it smoothly and in time.

    Args:
      xpos: m, xquat: wxyz, T_world_body of the robot's bodies. cameras: m. height: m, of the robot.
      looks: increasing frames, the last frame among them. free: their `free_shares`.
    """
    # Each frame takes the nearer one of the places before and after it.
    at = np.searchsorted(looks, np.arange(len(cameras)))
    share = np.minimum(free[at], free[np.maximum(at - 1, 0)])
    half = max(round(0.5 * _MOVING_TIME * frames_per_second), 1)
    window = np.lib.stride_tricks.sliding_window_view
    least = window(np.pad(share, 2 * half, "edge"), 2 * half + 1).min(1)
    share = window(least, 2 * half + 1).mean(1)
    above = _above(xpos, height)
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
