"""Makes the MJCF and the description of a robot with legs.

In: `LeggedRow`. Out: MJCF text of one free body without ground and light; the fields of a robot.json. When: once, at
construction.

Every joint of a leg has a position servo. At the end of a leg is a foot of spheres, or a wheel: a sphere of its radius
on a hinge with a speed servo, as those of `robots.catalogue`.
"""

import math
from typing import Any

import numpy as np

from .. import catalogue
from ..catalogue.mjcf import factor_of, lags, motor, slide
from ..catalogue.rows import Row, WheelRow
from .appearance import Looks, looks
from .rows import AXES, LeggedRow, Link, Solid

#: Of parts other than feet and wheels (menagerie's Go2).
BODY_FRICTION = 0.6
#: s. 4 physics steps a control step of 20 ms, as rl_lab, isaaclab and mjlab have it.
PHYSICS_TIMESTEP = 0.005
ROOT, CAMERA = "base", "front_cam"


def describe(row: LeggedRow) -> dict[str, Any]:
    """The description of a robot, as `robots.load` reads it from a robot.json, and its MJCF in the field mjcf."""
    radius = max(math.hypot(*place[:2]) for place in row.ends()) + (row.wheel.radius if row.wheel else 0.03)
    described: dict[str, Any] = {
        "schema": "urbanverse.robot/1",
        "name": row.name,
        "mjcf": make_mjcf(row),
        "root_body": ROOT,
        "camera": CAMERA,
        "feet": list(row.foot_names),
        "max_speed": row.max_speed,
        "max_yaw_rate": row.max_yaw_rate,
        "spawn_height": row.spawn,
        "planner": {"radius": round(radius, 3), "height": row.size[2], "step": row.step},
    }
    speed, turn = row.lags
    if row.wheel is None:
        return described | {"drive": {"kind": "gait"}, "response": {"speed_lag": speed, "turn_lag": turn}}
    rover = as_rover(row)
    speed, turn = lags(rover)
    wheels = [
        {"x": round(float(x), 4), "y": round(float(y), 4), "radius": row.wheel.radius, "motor": f"{leg}_wheel"}
        for leg, (x, y, _) in zip(row.legs, row.ends(), strict=True)
    ]
    held = {
        name.removesuffix("_joint"): angle + 0.0 for name, angle in zip(row.joint_names, row.stand_pose, strict=True)
    }
    drive = {"kind": "wheels", "axle": rover.axle, "skid": factor_of(rover), "slide": slide(rover), "wheels": wheels}
    return described | {"drive": drive | {"held": held}, "response": {"speed_lag": speed, "turn_lag": turn}}


def as_rover(row: LeggedRow) -> Row:
    """A wheeled robot of `robots.catalogue` with these wheels, whose motors and skid steering this robot has."""
    assert row.wheel is not None
    places = list(row.ends())
    ends = sorted({round(float(x), 4) for x, _, _ in places}, reverse=True)
    side, wheel = round(float(abs(places[0][1])), 4), row.wheel
    rows = tuple(WheelRow(x, side, wheel.radius, wheel.width, wheel.mass, driven=True) for x in ends)
    body = catalogue.rows.Box((-0.5 * row.size[0], 0.5 * row.size[0]), 0.5 * row.size[1], (0.1, row.size[2]))
    return Row(
        row.name, row.title, row.kind, row.drive, "rover", row.paint, row.size, (body,), row.mass, (0.0, row.spawn),
        row.top_speed, row.max_yaw_rate, rows, row.source, row.typical, axle=round(sum(ends) / len(ends), 4),
        acceleration=wheel.acceleration,
    )  # fmt: skip


def make_mjcf(row: LeggedRow) -> str:
    """MJCF text of the robot. Actuators: joint angles (rad) in the order of `LeggedRow.joint_names`, then the speeds
    (rad/s) of wheels, leg by leg."""
    drawn, at = looks(row), row.camera
    legs = "".join(_leg(row, leg, drawn) for leg in row.legs)
    servos = [_servo(link, leg, *sides) for leg, sides in row.legs.items() for link in row.links]
    actuators = "\n    ".join([*servos, *(_speed_servo(row, leg) for leg in row.legs if row.wheel)])
    view = _numbers(math.sin(at.pitch), 0.0, math.cos(at.pitch))
    # A wheel's joint follows those of its leg; its actuator follows those of all legs.
    wheel = (0.0,) if row.wheel else ()
    angles = np.reshape(row.stand_pose, (len(row.legs), -1))
    pose = _numbers(0.0, 0.0, row.spawn, 1.0, 0.0, 0.0, 0.0, *(x for leg in angles for x in (*leg, *wheel)))
    return f"""<mujoco model="{row.name}">
  <compiler angle="radian" autolimits="true"/>
  <option timestep="{PHYSICS_TIMESTEP}" integrator="Euler" cone="pyramidal"/>
  <default>
    <default class="collision">
      <geom type="sphere" group="3" contype="0" conaffinity="1" friction="{BODY_FRICTION} 0.005 0.0001"
            rgba="0.2 0.6 1 0.3"/>
    </default>
    <default class="visual"><geom group="2" contype="0" conaffinity="0" mass="0"/></default>
  </default>
  <asset>
    {drawn.materials}
  </asset>
  <worldbody>
    <body name="{ROOT}" pos="0 0 {row.spawn}">
      <freejoint name="root"/>
      {_inertial(row.base)}
      <camera name="{CAMERA}" pos="{_numbers(*at.at)}" xyaxes="0 -1 0 {view}" fovy="{at.fovy}"/>
      {_spheres(ROOT, row.base)}{drawn.base}{legs}
    </body>
  </worldbody>
  <actuator>
    {actuators}
  </actuator>
  <keyframe>
    <key name="stand" qpos="{pose}" ctrl="{_numbers(*row.stand_pose, *wheel * len(row.legs))}"/>
  </keyframe>
</mujoco>
"""


def _leg(row: LeggedRow, leg: str, drawn: Looks) -> str:
    """The bodies of a leg, each within the one before."""
    front, left = row.legs[leg]
    shapes, text, closing = drawn.leg(left), "", ""
    for i, link in enumerate(row.links):
        pad = "  " * (3 + i)
        place = tuple(a + b for a, b in zip(row.mount, link.at, strict=True)) if not i else link.at
        x = place[0] * front if not i else place[0]
        turn = f' euler="0 {link.turn:.9g} 0"' if link.turn else ""
        lines = [
            _inertial(link.solid, front if link.mirrored else 1.0, left),
            _joint(link, leg, front, left),
            f"{_spheres(f'{leg}_{link.name}', link.solid, left)}{shapes[link.name]}",
        ]
        text += f'\n{pad}<body name="{leg}_{link.name}" pos="{_numbers(x, left * place[1], place[2])}"{turn}>'
        text += "".join(f"\n{pad}  {line}" for line in lines)
        closing = f"\n{pad}</body>{closing}"
    return text + (_wheel(row, leg, drawn) if row.wheel else _foot(row, leg)) + closing


def _foot(row: LeggedRow, leg: str) -> str:
    assert row.foot is not None
    pad, left = "  " * (3 + len(row.links)), row.legs[leg][1]
    return "".join(
        f'\n{pad}<geom name="{name}" class="collision" size="{row.foot.radius}" '
        f'pos="{_numbers(x, left * y, z)}"\n{pad}      friction="{row.foot.friction} 0.005 0.0001"/>'
        for name, (x, y, z) in zip(row.foot.names(leg), row.foot.at, strict=True)
    )


def _wheel(row: LeggedRow, leg: str, drawn: Looks) -> str:
    assert row.wheel is not None
    wheel, rover = row.wheel, as_rover(row)
    pad, left = "  " * (3 + len(row.links)), row.legs[leg][1]
    x, y, z = wheel.at
    return f"""
{pad}<body name="{leg}_wheel" pos="{_numbers(x, left * y, z)}">
{pad}  <inertial pos="0 0 0" mass="{wheel.mass}" diaginertia="{_numbers(*wheel.inertia)}"/>
{pad}  <joint name="{leg}_wheel_joint" axis="0 1 0" armature="{motor(rover, rover.wheels[0]).inertia:.6g}"/>
{pad}  <geom name="{leg}_wheel" class="collision" size="{wheel.radius}" friction="{wheel.friction} 0.005 0.0001"/>
{pad}  {drawn.wheel}
{pad}</body>"""


def _inertial(solid: Solid, front: float = 1.0, left: float = 1.0) -> str:
    """Mirroring an axis changes the sign of its coordinate, and of the products of inertia that contain it once."""
    (x, y, z), (xx, yy, zz, xy, xz, yz) = solid.centre, solid.inertia
    products = (xy * front * left, xz * front, yz * left)
    return (
        f'<inertial pos="{_numbers(x * front, y * left, z)}" mass="{solid.mass:.9g}" '
        f'fullinertia="{_numbers(xx, yy, zz, *products)}"/>'
    )


def _spheres(name: str, solid: Solid, left: float = 1.0) -> str:
    return "".join(
        f'<geom name="{name}_{i}" class="collision" size="{radius}" pos="{_numbers(x, left * y, z)}"/>'
        for i, (x, y, z, radius) in enumerate(solid.spheres)
    )


def _span(link: Link, front: float, left: float) -> str:
    low, high = link.range if front > 0 else link.rear_range
    return _numbers(low, high) if link.axis == "y" or left > 0 else _numbers(-high, -low)


def _joint(link: Link, leg: str, front: float, left: float) -> str:
    axis = " ".join(f"{x:g}" for x in AXES[link.axis])
    return (
        f'<joint name="{leg}_{link.name}_joint" axis="{axis}" damping="{link.damping}" armature="{link.armature}" '
        f'range="{_span(link, front, left)}"/>'
    )


def _servo(link: Link, leg: str, front: float, left: float) -> str:
    name = f"{leg}_{link.name}"
    # Damping is a joint property, so that all engines integrate it in the same way.
    return (
        f'<general name="{name}" joint="{name}_joint" biastype="affine" gainprm="{link.stiffness}" '
        f'biasprm="0 -{link.stiffness} 0" ctrlrange="{_span(link, front, left)}" '
        f'forcerange="-{link.torque} {link.torque}"/>'
    )


def _speed_servo(row: LeggedRow, leg: str) -> str:
    rover = as_rover(row)
    servo = motor(rover, rover.wheels[0])
    return (
        f'<general name="{leg}_wheel" joint="{leg}_wheel_joint" biastype="affine" gainprm="{servo.gain:.6g}" '
        f'biasprm="0 0 {-servo.gain:.6g}" forcerange="{-servo.torque:.6g} {servo.torque:.6g}"/>'
    )


def _numbers(*values: float) -> str:
    # Adding 0 turns -0, as of a mirrored 0, into 0.
    return " ".join(f"{v + 0.0:.9g}" for v in values)
