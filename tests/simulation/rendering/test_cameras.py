"""The camera that follows a robot stands behind it, above it, and looks ahead of it."""

import numpy as np
from scipy.spatial.transform import Rotation

from urbanverse_mjx.simulation.rendering.cameras import following_cameras


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
