"""The Unitree Go2, a quadruped of 15 kg.

In: none; a gait file. Out:  `RobotSpec`; `Gait`. When: once, at construction.

Its actuators take joint angles. A locomotion policy (`envs.joystick`), the gait, computes these angles; navigation
commands the gait by a body velocity (`simulation.gait_engine`).
"""

import functools
import math
import pathlib
from typing import Any

from ..datatypes import Response, RobotSpec
from . import go2_body as body
from . import legged
from .gait import Gait
from .go2_menagerie import make_menagerie_mjcf
from .waypoint import gait_command, pd_velocity

#: m/s, rad/s: limits of the commands in the training of `Go2Joystick`.
MAX_SPEED, MAX_YAW_RATE = 1.0, 1.0
#: m, radius of a turn on the spot: half the stance's diagonal plus a foot.
PLANNER_RADIUS = math.hypot(body.HIP_X, body.HIP_Y + body.HIP_TO_THIGH) + body.FOOT_RADIUS
PLANNER_HEIGHT = 0.5  # m, published_spec_typical.standing_size_m 0.4 plus the motion of the trunk
STEP_HEIGHT = 0.16  # m, published_spec_typical.step_height_m (go2.json, second hand)


def waypoint_to_velocity(waypoint: Any, control_period: float) -> tuple[Any, Any]:
    """`pd_velocity` of this robot: a waypoint 1 m ahead means 1 m/s. The robot could also move sideways, but then a
    waypoint would have another meaning than for wheeled robots."""
    return pd_velocity(waypoint, control_period, MAX_SPEED, MAX_YAW_RATE)


def load_gait(path: str | pathlib.Path | None = None) -> Gait:
    """Loads the gait of a file, or the one that ships with the package.

    Raises:
      ValidationError: the file does not exist or is not a gait.
    """
    return Gait.load(path or legged.gait_path("go2"))


def circumradius() -> float:
    """m, upper bound on the distance of any collision point from the trunk's origin: that of the hip plus the length of
    the leg."""
    hip = math.hypot(body.HIP_X, body.HIP_Y + body.HIP_TO_THIGH)
    return hip + body.THIGH_LENGTH + body.CALF_LENGTH + body.FOOT_RADIUS


def make_go2(menagerie: str | pathlib.Path | None = None) -> RobotSpec:
    """The Go2. Actuators: joint angles (rad) in the order of `go2_body.JOINT_NAMES`; its `command` is for a gait.

    Args:
      menagerie: folder unitree_go2 of mujoco_menagerie, whose masses, limits and meshes replace the built-in ones.

    Raises:
      ValidationError: the folder does not contain this model.
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
        # As tests/evaluation/test_planner.py compares them with its gait in C MuJoCo.
        response=Response(speed_lag=0.2, turn_lag=0.05),
        drive="gait",
    )
