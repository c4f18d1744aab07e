"""A robot's size and dynamics as a vector, for a policy that drives several robots.

In: `RobotSpec`. Out: (18,) f32, see `FIELDS`. When: once, at construction of an environment.

Lengths are those of the collision spheres in the pose at rest, from the root body's origin, whose heading frame is that
of all observations and actions: a policy that is told where the robot ends can keep a tail clear that swings out.
"""

from collections.abc import Callable
from typing import NamedTuple

import mujoco
import numpy as np

from ..datatypes import Response, RobotSpec
from ..datatypes.robot import DRIVES
from .description import at_rest
from .stance import stance


class Size(NamedTuple):
    """m: of the collision spheres ahead of the root body's origin, behind it and to the farther side, their top above
    the ground, and the lowest part that is no foot."""

    ahead: float
    behind: float
    half_width: float
    height: float
    clearance: float


def size_of(robot: RobotSpec) -> Size:
    """The size of a robot at rest."""
    model = mujoco.MjModel.from_xml_string(robot.mjcf)
    data = at_rest(model)
    root = model.body(robot.root_body).id
    solid = np.flatnonzero(model.geom_conaffinity)
    # A robot without spheres, as of kinematic engines, is the disc of its planner.
    if not len(solid):
        radius = robot.planner_radius
        return Size(radius, radius, radius, robot.planner_height, robot.step_height)
    radii = model.geom_size[solid, 0]
    place = (data.geom_xpos[solid] - data.xpos[root]) @ data.xmat[root].reshape(3, 3)
    ground = (data.geom_xpos[solid, 2] - radii).min()
    return Size(
        ahead=float((place[:, 0] + radii).max()),
        behind=float((radii - place[:, 0]).max()),
        half_width=float((np.abs(place[:, 1]) + radii).max()),
        height=float((data.geom_xpos[solid, 2] + radii).max() - ground),
        clearance=stance(robot).clearance or 0.0,
    )


#: Name -> value of a robot with its size and its response to commands. Units are chosen so that values of robots on
#: pavements are of order one.
_NUMBERS: dict[str, Callable[[RobotSpec, Size, Response], float]] = {
    "ahead, m": lambda robot, size, response: size.ahead,
    "behind, m": lambda robot, size, response: size.behind,
    "half width, 0.5 m": lambda robot, size, response: size.half_width / 0.5,
    "height, m": lambda robot, size, response: size.height,
    "clearance, 0.2 m": lambda robot, size, response: size.clearance / 0.2,
    "step height, 0.1 m": lambda robot, size, response: robot.step_height / 0.1,
    "top speed, 2 m/s": lambda robot, size, response: robot.max_speed / 2.0,
    "yaw rate, rad/s": lambda robot, size, response: robot.max_yaw_rate,
    "turns about a point behind, m": lambda robot, size, response: response.pivot,
    # Inverse values, because curvature and acceleration may be infinite.
    "turning radius, m": lambda robot, size, response: 1.0 / response.curvature,
    "1 / sideways acceleration, s²/m": lambda robot, size, response: 1.0 / response.lateral,
    "lag of the speed, 0.5 s": lambda robot, size, response: response.speed_lag / 0.5,
    "lag of the yaw rate, 0.5 s": lambda robot, size, response: response.turn_lag / 0.5,
}
#: What the values of `describe` are, in order: numbers, then whether the drive is of each kind.
FIELDS = (*_NUMBERS, *(f"drive: {kind}" for kind in DRIVES))


def describe(robot: RobotSpec) -> np.ndarray:
    """(18,) f32, the values of `FIELDS`; a robot whose response is not described has that of `Response()`."""
    size, response = size_of(robot), robot.response or Response()
    numbers = [value(robot, size, response) for value in _NUMBERS.values()]
    return np.array([*numbers, *(float(robot.drive == kind) for kind in DRIVES)], np.float32)
