"""Drives a robot with a policy's ONNX file, and replays the log of it."""

import contextlib
import dataclasses
import importlib.util
import os
import pathlib
import subprocess
import sys
from collections.abc import Callable, Iterator
from typing import Any

from ..datatypes import ValidationError
from ..datatypes import validation as v
from ..deployment.controller import Limits
from ..deployment.loop import Endpoints, drive
from ..deployment.replay import replay as replay


@dataclasses.dataclass(frozen=True)
class DeployOptions:
    """The robot, the goals and the limits."""

    robot: str = "127.0.0.1"
    """HOST or HOST:PORT of the robot's side of the bridge (sensors on PORT, commands on the next one; default 5601 and
    5602), or ros: topics of this machine's ROS 2."""
    goal: tuple[float, ...] = ()
    """X Y (m) in the odometry frame; further pairs are driven to in turn."""
    max_speed: float | None = None
    """m/s; default: the policy's."""
    max_yaw_rate: float | None = None
    """rad/s; default: the policy's."""
    max_tilt: float = Limits.max_tilt
    """rad from the vertical, beyond which the robot stands."""
    odometry_age: float = Limits.odometry_age
    """s after the newest odometry at which the robot stands."""
    image_age: float = Limits.image_age
    """s after the newest image at which the robot stands."""
    answer_time: float = Limits.answer_time
    """s in which the policy must answer."""
    recovery: float = Limits.recovery
    """s without a fault before the robot drives again."""
    goal_radius: float = Limits.goal_radius
    """m within which a goal is reached."""
    time_limit: float | None = None
    """s after which to stop."""
    log: pathlib.Path | None = None
    """File to write everything to, for --replay."""
    image_topic: str = "/camera/image_raw"
    """sensor_msgs/Image, or CompressedImage where it ends in /compressed; with --robot ros."""
    odometry_topic: str = "/odom"
    """nav_msgs/Odometry; with --robot ros."""
    command_topic: str = "/cmd_vel"
    """geometry_msgs/Twist; with --robot ros."""
    stamped: bool = False
    """Publish geometry_msgs/TwistStamped; with --robot ros."""
    camera_fovy: float = 0.0
    """rad, vertical field of view of the camera, 0: the whole image is what the policy should see; with --robot ros."""

    def limits(self) -> Limits:
        """The limits.

        Raises:
          ValidationError: one is negative, or zero where it must not be.
        """
        values = {field.name: getattr(self, field.name) for field in dataclasses.fields(Limits)}
        for name, value in values.items():
            if value is not None:
                bounds = {"minimum": 0.0} if name == "recovery" else {"above": 0.0}
                v.number(value, f"--{name.replace('_', '-')}", **bounds)
        return Limits(**values)

    def goals(self) -> tuple[tuple[float, float], ...]:
        """The goals.

        Raises:
          ValidationError: there is none, or an odd number of coordinates.
        """
        if not self.goal or len(self.goal) % 2:
            raise ValidationError(f"--goal: found {len(self.goal)} numbers, needed X Y in metres, or more such pairs.")
        numbers = [v.number(x, "--goal", minimum=-1e6, maximum=1e6) for x in self.goal]
        return tuple(zip(numbers[::2], numbers[1::2], strict=True))


def deploy(
    policy: str | os.PathLike[str],
    options: DeployOptions | None = None,
    say: Callable[[str], None] | None = None,
) -> dict[str, Any]:
    """Drives a robot to goals with a policy.

    Args:
      policy: ONNX file of `urbanverse export-onnx`.
      say: called when the robot drives, and with every reason to stand, once until it drives again.

    Returns:
      see `deployment.loop.drive`.

    Raises:
      ValidationError: an option is wrong, the policy cannot be driven, or there is no ROS 2.
    """
    options = options or DeployOptions()
    goals, limits = options.goals(), options.limits()
    if options.time_limit is not None:
        v.number(options.time_limit, "--time-limit", above=0.0)
    v.number(options.camera_fovy, "--camera-fovy", minimum=0.0, maximum=3.1)
    with _endpoints(options) as endpoints:
        return drive(pathlib.Path(policy), goals, endpoints, limits, options.log, options.time_limit, say)


@contextlib.contextmanager
def _endpoints(options: DeployOptions) -> Iterator[Endpoints]:
    if options.robot != "ros":
        yield Endpoints.of(options.robot)
        return
    if importlib.util.find_spec("rclpy") is None:
        raise ValidationError(
            "--robot: found ros but no package rclpy, needed a ROS 2 environment; source its setup file, or run the "
            "bridge's node on the robot (docs/tutorials/deploy.md)."
        )
    # Names that begin with @ are sockets without a file (Linux), so that a killed process leaves none.
    names = [f"ipc://@urbanverse-{os.getpid()}-{kind}" for kind in ("sensors", "commands")]
    words = ["--image", options.image_topic, "--odometry", options.odometry_topic, "--command", options.command_topic]
    words += ["--fovy", str(options.camera_fovy), "--sensors", names[0], "--commands", names[1]]
    words += ["--parent", str(os.getpid()), *(["--stamped"] if options.stamped else [])]
    # The node outlives a killed loop, to stop the robot.
    command = [sys.executable, "-m", "urbanverse_mjx.deployment.ros_node", *words]
    node = subprocess.Popen(command, start_new_session=True)
    try:
        yield Endpoints(*names)
    finally:
        node.terminate()
        node.wait()
