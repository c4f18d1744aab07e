"""`RobotSpec`: a robot as data: the MJCF, and parameters for driving, collision slots and hits."""

import dataclasses
import math
from collections.abc import Callable
from typing import Any

from . import validation as v

#: Kinds of drives: two sides of wheels; the same, whose tyres slide in turns; steered wheels in front; all wheels
#: steered and driven; a gait (`simulation.gait_engine`), which may be that of a balancer.
DRIVES = ("differential", "skid", "ackermann", "swerve", "gait")


@dataclasses.dataclass(frozen=True)
class Response:
    """How a robot on wheels answers to a commanded body velocity (v, omega), for controllers that predict it.

    Attributes:
      speed_lag, turn_lag: s, time constants of the speed and of the yaw rate.
      pivot: m behind the root body's origin, where the line across the robot lies that does not move sideways: the
        axle that is not steered.
      curvature: 1/m, largest curvature; infinite for a robot that turns on the spot.
      lateral: m/s², largest sideways acceleration; in sharper bends the robot slows down.
    """

    speed_lag: float = 0.3
    turn_lag: float = 0.3
    pivot: float = 0.0
    curvature: float = math.inf
    lateral: float = math.inf

    def __post_init__(self) -> None:
        for name in ("speed_lag", "turn_lag"):
            v.number(getattr(self, name), f"response.{name}", above=0.0, maximum=10.0)
        v.number(self.pivot, "response.pivot", minimum=-10.0, maximum=10.0)
        for name in ("curvature", "lateral"):
            if getattr(self, name) != math.inf:
                v.number(getattr(self, name), f"response.{name}", above=0.0)


@dataclasses.dataclass(frozen=True)
class Arm:
    """An arm of J hinge joints on a robot, each with a position servo.

    Attributes:
      joints: names of the joints, from the robot to the hand.
      actuators: their places in the robot's command, whose values are rad.
      folded: rad, the pose for driving, which `RobotSpec.command` keeps.
      tip: name of the collision sphere at the end of the hand, one of `RobotSpec.foot_geoms`.
      speed: rad/s, up to which the targets move.
    """

    joints: tuple[str, ...]
    actuators: tuple[int, ...]
    folded: tuple[float, ...]
    tip: str
    speed: float

    def __post_init__(self) -> None:
        v.number(self.speed, "arm.speed", above=0.0)
        if not len(self.joints) == len(self.actuators) == len(self.folded):
            sizes = len(self.joints), len(self.actuators), len(self.folded)
            raise v.fail("arm", f"{sizes} joints, actuators and angles", "as many of each")


@dataclasses.dataclass(frozen=True)
class Parcel:
    """A parcel at the hand of an arm, which falls when it is released.

    Attributes:
      body: name of its body.
      spheres: names of its collision spheres, of `RobotSpec.foot_geoms`.
      actuators: places in the robot's command of the values that hold it: 1, and 0 from the release on.
      half_side: m, of the cube.
      ahead: m from the fingertip's centre to its middle, along the hand.
    """

    body: str
    spheres: tuple[str, ...]
    actuators: tuple[int, ...]
    half_side: float
    ahead: float

    def __post_init__(self) -> None:
        v.number(self.half_side, "parcel.half_side", above=0.0)


@dataclasses.dataclass(frozen=True)
class RobotSpec:
    """A robot and how a body velocity becomes actuator commands.

    Attributes:
      name: e.g. "coco".
      mjcf: MJCF text with one free root body, no ground and no light. Every collision geom is a sphere.
      root_body: name of the free body.
      foot_geoms: names of collision geoms that may touch the ground (wheels, feet), and buttons (`arm.tip`).
      camera: name of the policy's camera.
      circumradius: m, farthest collision point from the root body's origin, in any joint position.
      spawn_height: m, root origin above the ground at rest.
      max_speed: m/s, max_yaw_rate: rad/s: the commands are clipped to these.
      physics_timestep: s, at most 0.010.
      command: (2,) (v m/s, omega rad/s) -> (nu,) actuator commands, or the (3,) command of a legged robot's gait
        (`simulation.gait_engine`); pure, runs under jit.
      waypoint_to_velocity: (waypoint (2,) m in the body frame, control period s) -> (v, omega); the ideal PD.
      planner_radius, planner_height, step_height: m, dimensions for route planning.
      response: how it answers to velocity commands; None where that was not described.
      arm: its arm; None where it has none.
      drive: one of `DRIVES`.
      parcel: what its hand holds; None where it holds nothing.
    """

    name: str
    mjcf: str
    root_body: str
    foot_geoms: tuple[str, ...]
    camera: str
    circumradius: float
    spawn_height: float
    max_speed: float
    max_yaw_rate: float
    physics_timestep: float
    command: Callable[[Any], Any]
    waypoint_to_velocity: Callable[[Any, float], tuple[Any, Any]]
    planner_radius: float
    planner_height: float
    step_height: float
    response: Response | None = None
    arm: Arm | None = None
    drive: str = "differential"
    parcel: Parcel | None = None

    def __post_init__(self) -> None:
        v.text(self.name, "robot.name")
        where = f"robot {self.name!r}"
        v.choice(self.drive, f"{where}.drive", DRIVES)
        for name in ("circumradius", "spawn_height", "max_speed", "max_yaw_rate", "planner_radius", "planner_height"):
            v.number(getattr(self, name), f"{where}.{name}", above=0.0)
        v.number(self.physics_timestep, f"{where}.physics_timestep", above=0.0, maximum=0.010)
        v.number(self.step_height, f"{where}.step_height", minimum=0.0)
        if self.arm is not None and self.arm.tip not in self.foot_geoms:
            raise v.fail(f"{where}.arm.tip", v.show(self.arm.tip), "one of its foot_geoms")
        if self.parcel is not None:
            for name in set(self.parcel.spheres) - set(self.foot_geoms):
                raise v.fail(f"{where}.parcel.spheres", v.show(name), "names of its foot_geoms")
