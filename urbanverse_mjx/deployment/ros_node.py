"""A ROS 2 node that is the robot's side of the bridge: `python -m urbanverse_mjx.deployment.ros_node`.

It subscribes to an image (sensor_msgs/Image, or sensor_msgs/CompressedImage where the topic ends in /compressed) and to
odometry (nav_msgs/Odometry), passes both on, and publishes the velocity that is in force (geometry_msgs/Twist or
TwistStamped). `urbanverse deploy --robot ros` starts it in a process of its own: when the loop is killed, this node
still publishes zeros. If this node is killed too, the base must stop by itself (`cmd_vel_timeout` of ros2_control).

In:   topics. Out: messages of `messages`, and a velocity topic. When: as messages arrive; velocities at `--rate`.
"""

import argparse
import io
import signal
import sys
from collections.abc import Sequence
from typing import Any

import numpy as np
from PIL import Image as PillowImage

from ..datatypes import ValidationError
from ..process_pool import end_with_parent
from .messages import COMMAND_PORT, SENSOR_PORT, Image, Odometry
from .robot_side import RobotLink

#: Encoding of sensor_msgs/Image -> (bytes of a pixel, its channels red, green, blue).
_ENCODINGS = {
    "rgb8": (3, [0, 1, 2]),
    "bgr8": (3, [2, 1, 0]),
    "rgba8": (4, [0, 1, 2]),
    "bgra8": (4, [2, 1, 0]),
    "mono8": (1, [0, 0, 0]),
}


def stamp_of(header: Any, now_ns: int) -> int:
    """ns of a std_msgs/Header; the present where it is not set."""
    stamp = header.stamp.sec * 10**9 + header.stamp.nanosec
    return stamp if stamp > 0 else now_ns


def pixels_of(message: Any) -> np.ndarray:
    """(H, W, 3) u8 of a sensor_msgs/Image.

    Raises:
      ValidationError: another encoding, or fewer bytes than its size needs.
    """
    if message.encoding not in _ENCODINGS:
        raise ValidationError(f"image: found the encoding {message.encoding!r}, needed one of {', '.join(_ENCODINGS)}.")
    size, channels = _ENCODINGS[message.encoding]
    data = np.frombuffer(message.data, np.uint8)
    if message.step < message.width * size or len(data) < message.step * message.height:
        raise ValidationError(f"image: found {len(data)} bytes in rows of {message.step}, needed more for its size.")
    rows = data[: message.step * message.height].reshape(message.height, message.step)[:, : message.width * size]
    return np.ascontiguousarray(rows.reshape(message.height, message.width, size)[..., channels])


def pixels_of_compressed(message: Any) -> np.ndarray:
    """(H, W, 3) u8 of a sensor_msgs/CompressedImage (JPEG or PNG).

    Raises:
      ValidationError: the bytes are no image.
    """
    try:
        return np.asarray(PillowImage.open(io.BytesIO(bytes(message.data))).convert("RGB"))
    except (OSError, PillowImage.DecompressionBombError) as error:
        raise ValidationError(f"image: found bytes that are no image ({error}), needed JPEG or PNG.") from error


def odometry_of(message: Any, now_ns: int) -> Odometry:
    """An `Odometry` of a nav_msgs/Odometry, whose twist is in the body frame.

    Raises:
      ValidationError: a number is not finite, or the orientation is no unit quaternion.
    """
    p, q = message.pose.pose.position, message.pose.pose.orientation
    linear, angular = message.twist.twist.linear, message.twist.twist.angular
    return Odometry(
        stamp_of(message.header, now_ns), (p.x, p.y, p.z), (q.w, q.x, q.y, q.z), (linear.x, linear.y), angular.z
    )


def _arguments(argv: Sequence[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        "python -m urbanverse_mjx.deployment.ros_node", description=(__doc__ or "").split("\n")[0]
    )
    parser.add_argument("--image", default="/camera/image_raw")
    parser.add_argument("--odometry", default="/odom")
    parser.add_argument("--command", default="/cmd_vel")
    parser.add_argument("--stamped", action="store_true", help="publish geometry_msgs/TwistStamped")
    parser.add_argument(
        "--fovy", type=float, default=0.0, help="rad, vertical field of view of the camera; 0: whole image"
    )
    parser.add_argument("--rate", type=float, default=50.0, help="Hz, of the velocity")
    parser.add_argument("--sensors", default=f"tcp://127.0.0.1:{SENSOR_PORT}", help="ZeroMQ endpoint to bind")
    parser.add_argument("--commands", default=f"tcp://127.0.0.1:{COMMAND_PORT}", help="ZeroMQ endpoint to bind")
    parser.add_argument("--parent", type=int, help="process id; the node ends 2 s after it")
    return parser.parse_args(list(argv))


class RosRobot:
    """Subscriptions and publisher on a node, and the link to `urbanverse deploy`."""

    def __init__(self, node: Any, link: RobotLink, options: argparse.Namespace) -> None:
        from geometry_msgs.msg import Twist, TwistStamped  # type: ignore[import-not-found]
        from nav_msgs.msg import Odometry as RosOdometry  # type: ignore[import-not-found]
        from rclpy.qos import qos_profile_sensor_data  # type: ignore[import-not-found]
        from sensor_msgs.msg import CompressedImage  # type: ignore[import-not-found]
        from sensor_msgs.msg import Image as RosImage  # type: ignore[import-not-found]

        self._node, self._link, self._options = node, link, options
        self._twist = TwistStamped if options.stamped else Twist
        compressed = options.image.endswith("/compressed")
        kind, self._pixels = (CompressedImage, pixels_of_compressed) if compressed else (RosImage, pixels_of)
        node.create_subscription(kind, options.image, self._take_image, qos_profile_sensor_data)
        node.create_subscription(RosOdometry, options.odometry, self._take_odometry, qos_profile_sensor_data)
        self._publisher = node.create_publisher(self._twist, options.command, 1)
        node.create_timer(1.0 / options.rate, self._drive)

    def _now(self) -> int:
        return self._node.get_clock().now().nanoseconds

    def _take_image(self, message: Any) -> None:
        try:
            stamp = stamp_of(message.header, self._now())
            self._link.publish(Image(stamp, self._options.fovy, self._pixels(message)))
        except ValidationError as error:
            self._node.get_logger().error(str(error), throttle_duration_sec=1.0)

    def _take_odometry(self, message: Any) -> None:
        try:
            self._link.publish(odometry_of(message, self._now()))
        except ValidationError as error:
            self._node.get_logger().error(str(error), throttle_duration_sec=1.0)

    def _drive(self) -> None:
        now = self._now()
        self._link.receive(now)
        self._send(*self._link.gate.velocity(now))

    def stand(self) -> None:
        """Publishes a velocity of zero."""
        self._send(0.0, 0.0)

    def _send(self, speed: float, turn: float) -> None:
        message: Any = self._twist()
        body = message.twist if self._options.stamped else message
        if self._options.stamped:
            message.header.stamp = self._node.get_clock().now().to_msg()
        body.linear.x, body.angular.z = speed, turn
        self._publisher.publish(message)


def main(argv: Sequence[str]) -> int:
    """Runs the node until it is interrupted."""
    options = _arguments(argv)
    try:
        import rclpy  # type: ignore[import-not-found]
        import rclpy.signals  # type: ignore[import-not-found]
    except ImportError as error:
        raise SystemExit(
            f"error: found no rclpy ({error}), needed a ROS 2 environment; source its setup file."
        ) from error
    if options.parent is not None:
        end_with_parent(options.parent, delay=2.0)
    # The handlers of rclpy would end its context in the middle of a callback.
    rclpy.init(args=[], signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    link, node = None, None
    try:
        link, node = RobotLink(options.sensors, options.commands), rclpy.create_node("urbanverse_deploy")
        robot = RosRobot(node, link, options)
        try:
            rclpy.spin(node)
        finally:
            robot.stand()
    except KeyboardInterrupt:
        pass
    finally:
        if link is not None:
            link.close()
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
