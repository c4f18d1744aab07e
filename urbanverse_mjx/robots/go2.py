"""The Unitree Go2, a quadruped of 15 kg.

In:   nothing.
Out:  `RobotSpec`.
When: once, at construction.

Its actuators take joint angles. Which angles make it walk is a policy's work (`envs.joystick`), so this description
turns no body velocity into commands by itself.
"""

import math
from typing import Any

from ..datatypes import NounError, RobotSpec
from . import go2_body as body

#: m/s, rad/s: a little above the commands of `Go2Joystick`; slots are streamed for this speed.
MAX_SPEED, MAX_YAW_RATE = 1.5, 1.5
#: m. Half the stance's diagonal and a foot: what a turn on the spot sweeps.
PLANNER_RADIUS = math.hypot(body.HIP_X, body.HIP_Y + body.HIP_TO_THIGH) + body.FOOT_RADIUS
PLANNER_HEIGHT = 0.5  # m, published_spec_typical.standing_size_m 0.4 and a swing of the trunk
STEP_HEIGHT = 0.16  # m, published_spec_typical.step_height_m (go2.json, second hand)


def _needs_gait(*_: Any) -> Any:
    raise NounError(
        "robot 'go2': found a body velocity to be turned into actuator commands, needed a gait; legs are driven by a "
        "policy trained in Go2Joystick."
    )


def circumradius() -> float:
    """m, bound on the distance of any collision point from the trunk's origin: the hip's, and the leg stretched out."""
    hip = math.hypot(body.HIP_X, body.HIP_Y + body.HIP_TO_THIGH)
    return hip + body.THIGH_LENGTH + body.CALF_LENGTH + body.FOOT_RADIUS


def make_go2() -> RobotSpec:
    """The Go2. Actuators: joint angles (rad) in the order of `go2_body.JOINT_NAMES`."""
    return RobotSpec(
        name="go2",
        mjcf=body.make_mjcf(),
        root_body="base",
        foot_geoms=body.FOOT_NAMES,
        camera="front_cam",
        circumradius=circumradius(),
        spawn_height=body.SPAWN_HEIGHT,
        max_speed=MAX_SPEED,
        max_yaw_rate=MAX_YAW_RATE,
        physics_timestep=body.PHYSICS_TIMESTEP,
        command=_needs_gait,
        waypoint_to_velocity=_needs_gait,
        planner_radius=PLANNER_RADIUS,
        planner_height=PLANNER_HEIGHT,
        step_height=STEP_HEIGHT,
    )
