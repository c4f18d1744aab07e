"""`urbanverse deploy --robot ros` with ROS 2; skipped where it is not installed (it was run with Jazzy, rclpy 7.1)."""

import json
import math
import pathlib
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from typing import Any

import pytest

rclpy: Any = pytest.importorskip("rclpy", reason="needs a ROS 2 environment")
ROOT = pathlib.Path(__file__).parents[2]
STEP = 0.02


class Robot:
    """A point that obeys /cmd_vel at once; publishes /odom and /camera/image_raw.

    Attributes:
      moved: time (s) at which it last moved.
    """

    def __init__(self) -> None:
        from geometry_msgs.msg import Twist  # type: ignore[import-not-found]
        from nav_msgs.msg import Odometry  # type: ignore[import-not-found]
        from sensor_msgs.msg import Image  # type: ignore[import-not-found]

        self._types = Image, Odometry
        self.node = rclpy.create_node("robot")
        self._images = self.node.create_publisher(Image, "/camera/image_raw", 1)
        self._odometry = self.node.create_publisher(Odometry, "/odom", 1)
        self.node.create_subscription(Twist, "/cmd_vel", self._take, 1)
        self.node.create_timer(STEP, self._tick)
        self._velocity, self._pose, self.steps = (0.0, 0.0), [0.0, 0.0, 0.0], 0
        self.moved = 0.0

    def _take(self, message: Any) -> None:
        self._velocity = message.linear.x, message.angular.z

    def _tick(self) -> None:
        v, w = self._velocity
        if v or w:
            self.moved = time.monotonic()
        x, y, yaw = self._pose
        yaw += w * STEP
        self._pose = [x + v * STEP * math.cos(yaw), y + v * STEP * math.sin(yaw), yaw]
        image, odometry = (kind() for kind in self._types)
        image.header.stamp = odometry.header.stamp = self.node.get_clock().now().to_msg()
        if self.steps % 5 == 0:
            image.height, image.width, image.encoding, image.step = 12, 16, "bgr8", 48
            image.data = bytes((i + self.steps) % 256 for i in range(12 * 48))
            self._images.publish(image)
        pose, twist = odometry.pose.pose, odometry.twist.twist
        pose.position.x, pose.position.y = self._pose[:2]
        pose.orientation.w, pose.orientation.z = math.cos(self._pose[2] / 2), math.sin(self._pose[2] / 2)
        twist.linear.x, twist.angular.z = v, w
        self._odometry.publish(odometry)
        self.steps += 1


@pytest.fixture(scope="module")
def robot() -> Iterator[Robot]:
    rclpy.init()
    found = Robot()
    thread = threading.Thread(target=rclpy.spin, args=(found.node,), daemon=True)
    thread.start()
    yield found
    rclpy.shutdown()
    thread.join()


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGTERM, signal.SIGSTOP])
def test_a_robot_of_ros_drives_and_stands_within_the_limit(how: signal.Signals, robot: Robot, tmp_path) -> None:
    from tests.support.robot_policy import robot_policy

    policy = robot_policy(tmp_path / "policy.onnx")
    words = ["deploy", str(policy), "--robot", "ros", "--goal", "1000", "0", "--log", str(tmp_path / "run.log")]
    command = [sys.executable, "-m", "urbanverse_mjx.cli.main", *words]
    process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True)
    try:
        before = time.monotonic()
        while robot.moved < before:
            assert time.monotonic() < before + 30.0
            time.sleep(0.01)
        time.sleep(1.5)
        assert robot.moved > time.monotonic() - 0.1
        process.send_signal(how)
        began = time.monotonic()
        time.sleep(1.0)
        assert robot.moved <= began + 0.3
    finally:
        if how == signal.SIGSTOP:
            process.send_signal(signal.SIGCONT)
        if how != signal.SIGTERM:
            process.kill()
        out, _ = process.communicate()
    if how == signal.SIGTERM:
        assert json.loads(out)["actions"] >= 6
    time.sleep(3.0)  # the node ends
