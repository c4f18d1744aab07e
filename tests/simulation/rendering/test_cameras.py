"""The camera that follows a robot stands behind it, above it, and looks ahead of it."""

import numpy as np
from scipy.spatial.transform import Rotation

from urbanverse_mjx.simulation.rendering.cameras import following_cameras, views_to_cameras, without_obstacles

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


def _from_above(xpos: np.ndarray, cameras: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Shares of the way from a point above the robot to each camera's place without obstacles; the way (T, 3)."""
    above = xpos[:, 1] + [0.0, 0.0, 0.8 * HEIGHT]
    usual, _ = following_cameras(xpos, np.tile([1.0, 0.0, 0.0, 0.0], (len(xpos), 2, 1)), RATE, HEIGHT)
    return np.linalg.norm(cameras - above, axis=1) / np.linalg.norm(usual - above, axis=1), usual - above


def test_the_camera_stands_in_front_of_what_hides_the_robot() -> None:
    """A wall 1.2 m behind the robot between seconds 4 and 6, seen in five views a second, of which two frames see half
    of it, and a post that hides a fifth of a view at second 9."""
    frames = 300
    xpos, xquat = _straight_drive(frames)
    usual, turn = following_cameras(xpos, xquat, RATE, HEIGHT)
    looks = np.arange(0, frames, 5)
    depth = np.zeros((len(looks), 10, 10))
    hidden = (looks >= 100) & (looks <= 150)
    depth[hidden] = 1.2
    depth[looks == 225, :, :2] = 0.4
    # The last view belongs to the last frame.
    looks[-1] = frames - 1
    cameras, turned = without_obstacles(xpos, xquat, usual, depth, RATE, HEIGHT)
    share, way = _from_above(xpos, cameras)
    distance = share * np.linalg.norm(way, axis=1)
    assert (distance[100:151] < 1.2).all()
    assert (distance[105:146] > 1.0).all(), "no nearer than it must"
    np.testing.assert_allclose(cameras[:70], usual[:70], atol=1e-5)
    np.testing.assert_allclose(turned[:70], turn[:70], atol=1e-5)
    np.testing.assert_allclose(cameras[190:], usual[190:], atol=1e-5, err_msg="the post hides too little")
    assert np.abs(np.diff(distance)).max() < 0.1, "it goes in and out smoothly"
    # It stays on the line to its usual place, and looks at the same point ahead of the robot.
    np.testing.assert_allclose(np.cross(cameras - (usual - way), way), 0.0, atol=1e-4)
    seen = Rotation.from_quat(turned, scalar_first=True).apply([0.0, 0.0, -1.0])
    towards = xpos[:, 1] + [1.5, 0.0, 0.0] - cameras
    np.testing.assert_allclose(seen, towards / np.linalg.norm(towards, axis=1, keepdims=True), atol=1e-4)


def test_the_views_look_from_above_the_robot_at_the_camera() -> None:
    xpos, xquat = _straight_drive(3)
    usual, _ = following_cameras(xpos, xquat, RATE, HEIGHT)
    places, turns, fov = views_to_cameras(xpos, usual, HEIGHT)
    np.testing.assert_allclose(places, xpos[:, 1] + [0.0, 0.0, 0.8 * HEIGHT], atol=1e-6)
    way = usual - places
    distance = np.linalg.norm(way, axis=1)
    seen = Rotation.from_quat(turns, scalar_first=True).apply([0.0, 0.0, -1.0])
    np.testing.assert_allclose(seen, way / distance[:, None], atol=1e-5)
    np.testing.assert_allclose(np.tan(fov / 2) * distance, 0.3, atol=1e-5)


def test_a_drive_of_one_frame_has_a_camera() -> None:
    xpos, xquat = _straight_drive(1)
    usual, _ = following_cameras(xpos, xquat, RATE, HEIGHT)
    cameras, _ = without_obstacles(xpos, xquat, usual, np.full((2, 3, 3), 0.9), RATE, HEIGHT)
    assert np.linalg.norm(cameras - xpos[:, 1] - [0.0, 0.0, 0.8 * HEIGHT]) < 0.9
