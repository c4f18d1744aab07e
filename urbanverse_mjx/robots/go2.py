"""The Unitree Go2, a quadruped of 15 kg.

In: none; a gait file. Out:  `RobotSpec`; `Gait`. When: once, at construction.

Its actuators take joint angles. A policy (`envs.joystick`), its gait, gives the angles for walking; navigation commands
the gait by a body velocity (`simulation.gait_engine`).
"""

import functools
import math
import pathlib
from typing import Any

from ..datatypes import RobotSpec
from . import go2_body as body
from .gait import Gait
from .go2_menagerie import make_menagerie_mjcf
from .waypoint import gait_command, pd_velocity

#: m/s, rad/s: the commands that `Go2Joystick` trains.
MAX_SPEED, MAX_YAW_RATE = 1.0, 1.0
#: m. Half the stance's diagonal plus a foot: radius of a turn on the spot.
PLANNER_RADIUS = math.hypot(body.HIP_X, body.HIP_Y + body.HIP_TO_THIGH) + body.FOOT_RADIUS
PLANNER_HEIGHT = 0.5  # m, published_spec_typical.standing_size_m 0.4 and a swing of the trunk
STEP_HEIGHT = 0.16  # m, published_spec_typical.step_height_m (go2.json, second hand)


def waypoint_to_velocity(waypoint: Any, control_period: float) -> tuple[Any, Any]:
    """`pd_velocity` of this robot: a waypoint 1 m ahead means 1 m/s. It could go sideways as well, but then a waypoint
    would mean something else than to a robot on wheels."""
    return pd_velocity(waypoint, control_period, MAX_SPEED, MAX_YAW_RATE)


def load_gait(path: str | pathlib.Path | None = None) -> Gait:
    """The gait of a file, or the one that comes with the package.

    Raises:
      ValidationError: no such file, or no gait in it.
    """
    return Gait.load(path or pathlib.Path(__file__).parent / "go2_gait.npz")


def circumradius() -> float:
    """m, bound on the distance of any collision point from the trunk's origin: the hip's, and the leg stretched out."""
    hip = math.hypot(body.HIP_X, body.HIP_Y + body.HIP_TO_THIGH)
    return hip + body.THIGH_LENGTH + body.CALF_LENGTH + body.FOOT_RADIUS


def make_go2(menagerie: str | pathlib.Path | None = None) -> RobotSpec:
    """The Go2. Actuators: joint angles (rad) in the order of `go2_body.JOINT_NAMES`; its `command` is for a gait.

    Args:
      menagerie: folder unitree_go2 of mujoco_menagerie, whose masses, limits and meshes take the place of ours.

    Raises:
      ValidationError: no such model there.
    """
    return RobotSpec(
        name="go2",
        mjcf=make_menagerie_mjcf(menagerie) if menagerie else body.make_mjcf(),
        root_body="base",
        foot_geoms=body.FOOT_NAMES,
        camera="front_cam",
        circumradius=circumradius(),
        spawn_height=body.SPAWN_HEIGHT,
        max_speed=MAX_SPEED,
        max_yaw_rate=MAX_YAW_RATE,
        physics_timestep=body.PHYSICS_TIMESTEP,
        command=functools.partial(gait_command, max_speed=MAX_SPEED, max_yaw_rate=MAX_YAW_RATE),
        waypoint_to_velocity=waypoint_to_velocity,
        planner_radius=PLANNER_RADIUS,
        planner_height=PLANNER_HEIGHT,
        step_height=STEP_HEIGHT,
    )
