"""The COCO pavement delivery robot, with differential or Ackermann drive.

In:   the drive.
Out:  `RobotSpec`: MJCF and the mappings waypoint -> (v, omega) -> wheel commands.
When: once, at construction; the mappings run under jit.

There are two drives because the public sources differ (docs/sources/reference_systems.md b.5): in the paper, COCO is a
differential robot with commands (v, omega); the authors' asset steers its front axle by at most 20 degrees.

* `differential`: the two wheels of a side turn at the speed of that side. With friction on all four tyres, the robot
  could only turn by skidding, with a yaw rate that depends on load, heading and pushed objects. The paper's model is
  kinematic, so the front tyres slide freely on the ground (condim 1, ideal omni wheels), and the robot turns about the
  centre of its rear axle.
* `ackermann`: the front axle turns as a whole; every wheel gets the speed of its own path, so that no tyre slips.
"""

import functools
import math
from collections.abc import Callable
from typing import Any, Literal, get_args

import jax.numpy as jnp

from ..datatypes import Response, RobotSpec
from ..datatypes import validation as v
from . import coco_body as body
from .waypoint import STANDSTILL, clip_velocity, pd_velocity

Drive = Literal["differential", "ackermann"]

MAX_SPEED = 2.0  # m/s, design section 4; coco.json coco2play_kinematics.max_speed_mps
MAX_YAW_RATE = 1.0  # rad/s, design section 4; coco.json suggested_numbers_for_a_model.max_yaw_rate
PHYSICS_TIMESTEP = 0.010  # s, docs/sources/measured.md: sphere wheels over prism seams, 0.6 mm at 10 ms, 12 mm at 20 ms
PLANNER_HEIGHT = 1.0  # m, docs/sources/reference_systems.md b.5: the planner's disc needs this height (flag)
STEP_HEIGHT = 0.02  # m, tests/robots/test_coco_drive.py drives both robots over a step of this height
#: As tests/evaluation/test_planner.py measures them in C MuJoCo; `evaluation.planner.MOTIONS` knows slopes besides.
RESPONSES: dict[str, Response] = {
    "differential": Response(speed_lag=0.32, turn_lag=0.60, pivot=-body.REAR_AXLE_X),
    "ackermann": Response(
        speed_lag=0.32,
        turn_lag=0.20,
        pivot=-body.REAR_AXLE_X,
        curvature=math.tan(body.MAX_STEER) / body.WHEELBASE,
    ),
}


def _differential(command: Any) -> Any:
    speed, yaw_rate = command[0], command[1]
    # In a curve, the inertia of the mass in front of the rear axle pulls the axle sideways and forward. A servo
    # produces a torque only by a speed error, which is fed forward: (m/s) per N on one rear wheel.
    give = body.WHEEL_RADIUS**2 / body.make_servo("differential").wheel
    arm = body.TOTAL_MASS * (body.CENTRE_X - body.REAR_AXLE_X)
    half = 0.5 * body.TRACK * yaw_rate + give * arm * speed * yaw_rate / body.TRACK
    mean = speed - give * 0.5 * arm * yaw_rate * yaw_rate
    return jnp.stack([mean - half, mean + half, mean - half, mean + half]) / body.WHEEL_RADIUS


def _ackermann(command: Any) -> Any:
    speed, yaw_rate = command[0], command[1]
    # At rest the wheels do not turn, and only the sign of the angle is kept.
    angle = jnp.arctan2(body.WHEELBASE * yaw_rate, jnp.maximum(speed, STANDSTILL))
    angle = jnp.clip(angle, -body.MAX_STEER, body.MAX_STEER)
    turn = speed * jnp.tan(angle) / body.WHEELBASE
    front, half = speed / jnp.cos(angle), 0.5 * body.TRACK * turn
    wheels = jnp.stack([front - half, front + half, speed - half, speed + half]) / body.WHEEL_RADIUS
    return jnp.append(wheels, angle)


def clip_command(velocity: Any) -> Any:
    """(2,) (v m/s, omega rad/s) clipped to the robot's range, which does not include driving backwards."""
    return clip_velocity(velocity, MAX_SPEED, MAX_YAW_RATE)


def waypoint_to_velocity(waypoint: Any, control_period: float) -> tuple[Any, Any]:
    """`pd_velocity` of this robot: a waypoint 1 m ahead means 2 m/s; one behind the robot means a turn on the spot with
    the differential drive."""
    return pd_velocity(waypoint, control_period, MAX_SPEED, MAX_YAW_RATE)


def _command(convert: Callable[[Any], Any], velocity: Any) -> Any:
    return convert(clip_command(velocity))


def _circumradius(max_steer: float) -> float:
    """Farthest collision point (m) from base_link, the front axle turned by up to `max_steer` rad."""
    spheres = [((body.REAR_AXLE_X, body.WHEEL_Y, body.WHEEL_Z), body.WHEEL_RADIUS)]
    swing, half = body.WHEEL_Y * math.sin(max_steer), body.WHEEL_Y * math.cos(max_steer)
    spheres += [((body.FRONT_AXLE_X + swing, half, body.WHEEL_Z), body.WHEEL_RADIUS)]
    spheres += [(c, body.BODY_SPHERE_RADIUS) for c in body.BODY_SPHERES]
    return max(math.hypot(*centre) + radius for centre, radius in spheres)


def make_coco(drive: Drive = "differential") -> RobotSpec:
    """The COCO robot.

    Args:
      drive: "differential" (turns on the spot; preset `paper`) or "ackermann" (±20.05 degrees; `urbansim_v0_1`).

    Actuators: wheel speeds (rad/s) front left, front right, rear left, rear right, and for "ackermann" the angle of
    the front axle (rad).

    Raises:
      ValidationError: the drive is unknown.
    """
    v.choice(drive, "make_coco.drive", get_args(Drive))
    convert = _differential if drive == "differential" else _ackermann
    return RobotSpec(
        name=f"coco_{drive}",
        mjcf=body.make_mjcf(drive, body.make_servo(drive)),
        root_body="base_link",
        foot_geoms=tuple(f"{wheel}_wheel" for wheel in body.WHEELS),
        camera="front_cam",
        circumradius=_circumradius(body.MAX_STEER if drive == "ackermann" else 0.0),
        spawn_height=body.SPAWN_HEIGHT,
        max_speed=MAX_SPEED,
        max_yaw_rate=MAX_YAW_RATE,
        physics_timestep=PHYSICS_TIMESTEP,
        # A partial of functions of this module, because workers of process pools are sent robots.
        command=functools.partial(_command, convert),
        waypoint_to_velocity=waypoint_to_velocity,
        # Radius of the circle of a turn on the spot: the distance of the farthest wheel from base_link.
        planner_radius=math.hypot(body.REAR_AXLE_X, body.WHEEL_Y) + body.WHEEL_RADIUS,
        planner_height=PLANNER_HEIGHT,
        step_height=STEP_HEIGHT,
        response=RESPONSES[drive],
        drive=drive,
    )
