"""The camera that follows a robot stands behind it, above it, and looks ahead of it."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from urbanverse_mjx.simulation.rendering.cameras import following_cameras, free_shares, without_obstacles

RATE, HEIGHT = 25.0, 0.6


def test_the_camera_follows_the_heading_of_the_root_body() -> None:
    frames, heading, height = 30, 0.6, 1.0
    ahead = np.array([np.cos(heading), np.sin(heading), 0.0])
    xpos = np.zeros((frames, 3, 3))
    xpos[:, 1] = np.array([4.0, -2.0, 0.5]) + 0.1 * np.arange(frames)[:, None] * ahead
    turns = Rotation.from_euler("z", [[0.0], [heading], [-2.0]]).as_quat(scalar_first=True)
    places, views = following_cameras(xpos, np.broadcast_to(turns, (frames, 3, 4)), 10.0, height)
    offset = places - xpos[:, 1]
    left = np.array([-ahead[1], ahead[0], 0.0])
    np.testing.assert_allclose(offset @ left, 0.0, atol=1e-5)
    np.testing.assert_allclose(offset, np.broadcast_to(offset[0], offset.shape), atol=1e-5)
    assert offset[0] @ ahead < -height
    assert offset[0, 2] > 0.5 * height
    seen = Rotation.from_quat(views, scalar_first=True).apply([0.0, 0.0, -1.0])
    towards = xpos[:, 1] + 1.5 * ahead - places
    np.testing.assert_allclose(seen, towards / np.linalg.norm(towards, axis=1, keepdims=True), atol=1e-5)
    # Bodies of a robot that turns on the spot: the camera turns with it, up to the smoothing at both ends.
    spin = Rotation.from_euler("z", np.linspace(0.0, 1.0, 100)[:, None]).as_quat(scalar_first=True)
    places, _ = following_cameras(np.zeros((100, 2, 3)), np.stack([spin, spin], 1), 10.0, height)
    middle = np.arctan2(-places[20:80, 1], -places[20:80, 0])
    np.testing.assert_allclose(middle, np.linspace(0.0, 1.0, 100)[20:80], atol=1e-3)


def _straight_drive(frames: int) -> tuple[np.ndarray, np.ndarray]:
    """xpos, xquat of a robot that drives along x at 1 m/s."""
    xpos = np.zeros((frames, 2, 3))
    xpos[:, 1, 0] = np.arange(frames) / RATE
    return xpos, np.tile([1.0, 0.0, 0.0, 0.0], (frames, 2, 1))


def _without(post: float, walled: np.ndarray, frames: int) -> tuple[np.ndarray, ...]:
    """Cameras, rotations and their usual values of a straight drive.

    Args:
      post: share of each view that a post before the camera hides.
      walled: (T,) whether a wall stands 1.2 m behind the point above the robot.
    """
    xpos, xquat = _straight_drive(frames)
    usual, turn = following_cameras(xpos, xquat, RATE, HEIGHT)
    looks = np.unique(np.linspace(0, frames - 1, max(frames // 5, 2)).round().astype(int))
    above = xpos[looks, 1] + [0.0, 0.0, 0.8 * HEIGHT]

    def look(rows: np.ndarray, places: np.ndarray, turns: np.ndarray, fov: np.ndarray) -> np.ndarray:
        offset = above[rows] - places
        distance = np.linalg.norm(offset, axis=1)
        seen = Rotation.from_quat(turns, scalar_first=True).apply([0.0, 0.0, -1.0])
        np.testing.assert_allclose(seen, offset / distance[:, None], atol=1e-4)
        np.testing.assert_allclose(np.tan(fov / 2) * distance, 0.5, atol=1e-4)
        depth = np.full((len(rows), 10, 10), 7.0)  # what stands beyond the robot hides nothing
        depth[:, :, : round(10 * post)] = 0.2
        hidden = walled[looks[rows]] & (distance > 1.2)
        depth[hidden] = (distance[hidden] - 1.2)[:, None, None]
        return depth

    free = free_shares(look, xpos[looks], usual[looks], HEIGHT)
    return *without_obstacles(xpos, xquat, usual, looks, free, RATE, HEIGHT), usual, turn


def test_the_camera_stands_in_front_of_what_hides_the_robot() -> None:
    frames = 300
    at = np.arange(frames)
    cameras, turned, usual, turn = _without(0.0, (at >= 100) & (at <= 150), frames)
    robot = np.outer(at / RATE, [1.0, 0.0, 0.0])
    above = robot + [0.0, 0.0, 0.8 * HEIGHT]
    left = np.linalg.norm(cameras - above, axis=1)
    assert (left[100:151] < 1.2).all()
    assert (left[105:146] > 0.9).all(), "no nearer than it must"
    for free in (slice(0, 70), slice(190, frames)):
        np.testing.assert_allclose(cameras[free], usual[free], atol=1e-5)
        np.testing.assert_allclose(turned[free], turn[free], atol=1e-5)
    assert np.abs(np.diff(left)).max() < 0.1, "it goes in and out smoothly"
    # It stays on the line to its usual place, and looks at the same point ahead of the robot.
    np.testing.assert_allclose(np.cross(cameras - above, usual - above), 0.0, atol=1e-4)
    seen = Rotation.from_quat(turned, scalar_first=True).apply([0.0, 0.0, -1.0])
    towards = robot + [1.5, 0.0, 0.0] - cameras
    np.testing.assert_allclose(seen, towards / np.linalg.norm(towards, axis=1, keepdims=True), atol=1e-4)


@pytest.mark.parametrize("frames", [1, 2, 40])
def test_a_post_hides_too_little_and_half_of_the_view_brings_the_camera_to_the_robot(frames: int) -> None:
    nowhere = np.zeros(frames, bool)
    cameras, _, usual, _ = _without(0.2, nowhere, frames)
    np.testing.assert_allclose(cameras, usual, atol=1e-5)
    cameras, _, usual, _ = _without(0.5, nowhere, frames)
    above = np.outer(np.arange(frames) / RATE, [1.0, 0.0, 0.0]) + [0.0, 0.0, 0.8 * HEIGHT]
    np.testing.assert_allclose(cameras - above, 0.2 * (usual - above), atol=1e-5)
