"""Makes the MJCF and the description of a robot of the table.

In: `Row`. Out: the fields of a robot.json, with the MJCF as text. When: once, at construction.

The chassis is one rigid body without suspension. A wheel is a sphere of its radius on a hinge, a steered one on a
knuckle with a hinge of its own; a caster is a sphere without friction. Boxes of the body are filled with spheres whose
surface is at most `GAP` behind the faces between two of them; edges and corners are round.
"""

import dataclasses
import itertools
import math
from typing import Any

import numpy as np

from ..wheel_drive import skid_factor
from .appearance import MATERIALS, draw
from .rows import Box, Row, WheelRow

#: m/s², the largest that motors give, and their largest share of the acceleration at which the robot tips over.
_ACCELERATION, _TIP_SHARE = 3.0, 0.6
#: Inertia of the motors behind their gears, by the robot's own at its wheels; of skid steering, whose stiff motors hold
#: against the sliding tyres. With it, a servo of the gain inertia / `_SERVO_STEPS` physics steps is stable.
_MOTOR_INERTIA, _SKID_INERTIA, _SERVO_STEPS = 0.5, 2.0, 1.25
#: COCO's tyres and body (coco_body.py).
_TYRE_FRICTION, _BODY_FRICTION = 0.7, 0.6
#: Friction of sliding tyres that motors reckon with: between that of tyres and that of streets of uniform friction, 1.
_SLIDE_FRICTION = 0.85
#: m between the spheres of the body and its faces, at most.
GAP = 0.03
#: N m/rad and s: servo of a steered wheel, and damping by stiffness.
_STEER_STIFFNESS, _STEER_DAMPING = 120.0, 0.08
_GRAVITY = 9.81
#: s, physics step.
_STEP = 0.01
#: Spheres of a person on a seat: x, y, z from the middle of the seat, radius (m), as the wheelchair's user.
RIDER = (
    ((0.0, 0.0, 0.10), 0.18),
    *(((0.22, y, 0.04), 0.11) for y in (0.09, -0.09)),
    *(((0.36, y, -0.16), 0.09) for y in (0.09, -0.09)),
    *(((0.14, y, 0.18), 0.09) for y in (0.19, -0.19)),
    *(((-0.05, y, 0.34), 0.16) for y in (0.07, -0.07)),
    *(((-0.05, y, 0.54), 0.13) for y in (0.10, -0.10)),
    ((-0.02, 0.0, 0.74), 0.12),
)


def describe(row: Row) -> dict[str, Any]:
    """The description of a robot, as `robots.load` reads it from a robot.json, and its MJCF in the field mjcf."""
    height = root_height(row)
    feet = [f"{name}_wheel" for name, *_ in placed_wheels(row)]
    reach = max(math.hypot(w.x, w.y) + w.radius for w in row.wheels)
    low = min(w.radius for w in row.wheels if not w.lift)
    described: dict[str, Any] = {
        "schema": "urbanverse.robot/1",
        "name": row.name,
        "mjcf": make_mjcf(row),
        "root_body": "base_link",
        "camera": "front_cam",
        "feet": feet,
        "max_speed": row.max_speed,
        "max_yaw_rate": row.max_yaw_rate,
        "spawn_height": height,
        "planner": {"radius": round(reach, 3), "height": row.size[2], "step": round(0.15 * low, 3)},
    }
    if row.drive == "balance":
        return described | {"drive": {"kind": "gait"}, "response": {"speed_lag": 0.8, "turn_lag": 0.3}}
    wheels = []
    for name, wheel, y in placed_wheels(row):
        if wheel.driven or wheel.steer:
            one: dict[str, Any] = {"x": wheel.x, "y": y, "radius": wheel.radius}
            one |= {"motor": f"{name}_motor"} if wheel.driven else {}
            wheels.append(one | ({"steer": f"{name}_steer"} if wheel.steer else {}))
    drive: dict[str, Any] = {"kind": "wheels", "axle": row.axle, "wheels": wheels}
    if row.drive == "skid":
        drive |= {"skid": factor_of(row), "slide": slide(row)}
    if row.drive == "differential":
        drive["bend"] = bend(row)
    if math.isfinite(row.lateral):
        drive["lateral"] = row.lateral
    speed, turn = lags(row)
    return described | {"drive": drive, "response": {"speed_lag": speed, "turn_lag": turn}}


def placed_wheels(row: Row) -> list[tuple[str, WheelRow, float]]:
    """(name, row, y) of every wheel."""
    return [(f"{side}_{i}", wheel, y) for i, wheel in enumerate(row.wheels) for side, y in wheel.sides()]


def root_height(row: Row) -> float:
    """m, height of the root body's origin above the ground: half that of the robot, which keeps its reach small."""
    return round(0.5 * max(z + r for _, _, z, r in body_spheres(row)), 3)


def body_spheres(row: Row) -> list[tuple[float, float, float, float]]:
    """(x, y, z, radius) m of the spheres of the body and of its rider, z above the ground."""
    spheres = [sphere for box in row.body for sphere in fill(box)]
    if row.rider is not None:
        x0, z0 = row.rider
        spheres += [(x0 + x, y, z0 + z, radius) for (x, y, z), radius in RIDER]
    return spheres


def fill(box: Box) -> list[tuple[float, float, float, float]]:
    """(x, y, z, radius) m of spheres that fill a box, none of which reaches beyond its faces."""
    spans = (box.x, (-box.y, box.y), box.z)
    radius = 0.5 * min(high - low for low, high in spans)
    gap = min(GAP, 0.3 * radius)
    spacing = 2.0 * math.sqrt(radius**2 - (radius - gap) ** 2)
    axes = [_centres(low + radius, high - radius, spacing) for low, high in spans]
    grid = itertools.product(*(range(len(axis)) for axis in axes))
    # Those in the middle, seen from above, are behind the ones around them.
    outer = [at for at in grid if any(at[k] in (0, len(axes[k]) - 1) for k in (0, 1))]
    return [(float(axes[0][i]), float(axes[1][j]), float(axes[2][k]), radius) for i, j, k in outer]


def _centres(low: float, high: float, spacing: float) -> np.ndarray:
    if high - low < 1e-6:
        return np.array([0.5 * (low + high)])
    return np.linspace(low, high, math.ceil((high - low) / spacing - 1e-9) + 1)


def chassis(row: Row) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass (kg), centre of mass (3,) m with z above the ground, and principal moments of inertia (3,) kg m^2 of all but
    the wheels: those of a box of the robot's size."""
    wheels = [(w.mass, np.array([w.x, y, w.radius + w.lift])) for _, w, y in placed_wheels(row)]
    mass = row.mass - sum(m for m, _ in wheels)
    whole = row.mass * np.array([row.centre[0], 0.0, row.centre[1]])
    centre = (whole - np.sum([m * p for m, p in wheels], axis=0)) / mass
    square = np.square(row.size)
    return mass, centre, mass / 12.0 * (square.sum() - square)


def motor_inertia(row: Row) -> float:
    """Inertia of the motors by that of the robot at its wheels."""
    if row.drive != "skid":
        return _MOTOR_INERTIA
    if not row.acceleration:
        return _SKID_INERTIA
    # Such that motors which hold tyres that slide in a turn on the spot accelerate the robot by no more.
    wheel = row.driven[0]
    along, across = (factor_of(row) - 1.0) * wheel.y, abs(wheel.x - row.axle)
    return along / math.hypot(along, across) * _GRAVITY / row.acceleration - 1.0


def acceleration(row: Row) -> float:
    """m/s², the largest at a start or stop."""
    if row.drive == "skid":  # a motor holds a wheel on ground with the friction 1
        return row.acceleration or _GRAVITY / (1.0 + _SKID_INERTIA)
    (x, z), ends = row.centre, [wheel.x for wheel in row.wheels]
    return min(_ACCELERATION, _TIP_SHARE * _GRAVITY * min(max(ends) - x, x - min(ends)) / z)


def lags(row: Row) -> tuple[float, float]:
    """s, time constants of speed and yaw rate; that of the speed is of a start to full speed."""
    servo = _SERVO_STEPS * _STEP * (1.0 + 1.0 / motor_inertia(row))
    speed = servo + 0.63 * row.max_speed / acceleration(row)
    if row.drive in ("ackermann", "swerve"):
        return speed, 0.25
    x, half = row.centre[0], row.driven[0].y
    inertia = chassis(row)[2][2] + row.mass * (x - row.axle) ** 2
    return speed, max(servo * inertia / (row.mass * half * half), 0.15)


def carrying(row: Row) -> int:
    """Number of driven wheels on the ground."""
    return sum(len(wheel.sides()) for wheel in row.driven if not wheel.lift)


@dataclasses.dataclass(frozen=True)
class Motor:
    """A speed servo: gain (N m s/rad), largest torque (N m), inertia behind its gear (kg m^2)."""

    gain: float
    torque: float
    inertia: float


def motor(row: Row, wheel: WheelRow) -> Motor:
    """The motor of a driven wheel."""
    if row.drive == "balance":
        return Motor(1.0, math.inf, 0.0)
    more = motor_inertia(row)
    share = row.mass * wheel.radius**2 / carrying(row)
    torque = (1.0 + more) * share / wheel.radius * acceleration(row)
    return Motor(more * share / (_SERVO_STEPS * _STEP), torque, more * share)


def bend(row: Row) -> float:
    """m/s per m/s², see `WheelTable.bend`."""
    wheel = row.driven[0]
    moment = row.mass * (row.centre[0] - row.axle)
    return moment / (wheel.y * carrying(row)) * wheel.radius**2 / motor(row, wheel).gain


def factor_of(row: Row) -> float:
    """The `skid_factor` of skid steering."""
    return skid_factor([wheel.x - row.axle for wheel in row.driven], row.driven[0].y)


def slide(row: Row) -> float:
    """m/s, see `WheelTable.slide`: the error of a motor's speed at which it holds against a tyre that slides."""
    wheel, load = row.driven[0], row.mass * _GRAVITY / carrying(row)
    return _SLIDE_FRICTION * load * wheel.radius**2 / motor(row, wheel).gain


def make_mjcf(row: Row) -> str:
    """MJCF text of one free body without ground and light."""
    height, (mass, centre, inertia) = root_height(row), chassis(row)
    camera = row.camera or (row.body[0].x[1] + 0.02, 0.0, min(max(0.8 * row.size[2], 0.35), 1.1))
    shapes, meshes = draw(row, height, camera)
    spheres = [
        f'<geom name="body_{i}" class="body" size="{radius:.4g}" pos="{_text(x, y, z - height)}"/>'
        for i, (x, y, z, radius) in enumerate(body_spheres(row))
    ]
    casters = [
        f'<geom name="{name}_wheel" class="caster" size="{w.radius:g}" pos="{_hub(w, y, height)}"/>'
        for name, w, y in placed_wheels(row)
        if w.caster
    ]
    wheels = [_wheel(row, name, w, y, height) for name, w, y in placed_wheels(row) if not w.caster]
    actuators = [_actuators(row, name, w) for name, w, _ in placed_wheels(row)]
    step = 0.5 * _STEP if row.drive == "balance" else _STEP
    paint = f'<material name="paint" rgba="{_text(*row.paint)} 1" specular="0.4" shininess="0.4"/>'
    new = "\n      "
    return f"""<mujoco model="{row.name}">
  <compiler angle="radian" autolimits="true"/>
  <option timestep="{step:g}" integrator="Euler" cone="pyramidal"/>
  <default>
    <default class="body">
      <geom type="sphere" group="3" contype="0" conaffinity="1" friction="{_BODY_FRICTION} 0.005 0.0001"/>
    </default>
    <default class="tyre">
      <geom type="sphere" group="3" contype="0" conaffinity="1" friction="{_TYRE_FRICTION} 0.005 0.0001"/>
    </default>
    <default class="caster">
      <geom type="sphere" group="3" contype="0" conaffinity="1" condim="1" priority="1"/>
    </default>
    <default class="visual"><geom group="2" contype="0" conaffinity="0" mass="0"/></default>
  </default>
  <asset>{paint}{MATERIALS}{"".join(meshes)}</asset>
  <worldbody>
    <body name="base_link" pos="0 0 {height:g}">
      <freejoint name="root"/>
      <inertial pos="{_text(*(centre - [0, 0, height]))}" mass="{mass:.6g}" diaginertia="{_text(*inertia)}"/>
      <camera name="front_cam" pos="{_text(*camera[:2], camera[2] - height)}" xyaxes="0 -1 0 0 0 1" fovy="75"/>
      {new.join([*spheres, *casters, *shapes, *wheels])}
    </body>
  </worldbody>
  <actuator>{"".join(actuators)}</actuator>
</mujoco>
"""


def _wheel(row: Row, name: str, wheel: WheelRow, y: float, height: float) -> str:
    """A wheel on its hinge; a steered one on a knuckle."""
    place = _hub(wheel, y, height)
    spin, side = 0.5 * wheel.mass * wheel.radius**2, wheel.mass * (wheel.radius**2 / 4 + wheel.width**2 / 12)
    inertia = motor(row, wheel).inertia if wheel.driven else 0.0
    damping = 0.0 if wheel.driven else 0.002 * wheel.mass * wheel.radius
    r, half = wheel.radius, wheel.width / 2
    where = "" if wheel.steer else f' pos="{place}"'
    body = f"""<body name="{name}_link"{where}>
        <inertial pos="0 0 0" mass="{wheel.mass:g}" diaginertia="{_text(side, spin, side)}"/>
        <joint name="{name}_joint" axis="0 1 0" damping="{damping:.6g}" armature="{inertia:.6g}"/>
        <geom name="{name}_wheel" class="tyre" size="{wheel.radius:g}"/>
        <geom class="visual" type="cylinder" size="{_text(r, half)}" zaxis="0 1 0" material="tyre"/>
        <geom class="visual" type="cylinder" size="{_text(0.6 * r, half + 0.004)}" zaxis="0 1 0" material="hub"/>
        <geom class="visual" type="box" size="{_text(0.5 * r, half + 0.006, 0.08 * r)}" material="dark"/>
      </body>"""
    if not wheel.steer:
        return body
    damping = _STEER_STIFFNESS * _STEER_DAMPING
    return f"""<body name="{name}_knuckle" pos="{place}">
        <inertial pos="0 0 0" mass="1e-4" diaginertia="1e-5 1e-5 1e-5"/>
        <joint name="{name}_steer_joint" axis="0 0 1" range="{-wheel.steer:g} {wheel.steer:g}" damping="{damping:g}"
               armature="0.02"/>
        {body}
      </body>"""


def _hub(wheel: WheelRow, y: float, height: float) -> str:
    """Place of a wheel's centre in the root body."""
    return _text(wheel.x, y, wheel.radius + wheel.lift - height)


def _actuators(row: Row, name: str, wheel: WheelRow) -> str:
    text = ""
    if wheel.driven:
        servo = motor(row, wheel)
        text += f'<general name="{name}_motor" joint="{name}_joint" gainprm="{servo.gain:.6g}"'
        if math.isfinite(servo.torque):
            text += f' biastype="affine" biasprm="0 0 {-servo.gain:.6g}"'
            text += f' forcerange="{-servo.torque:.6g} {servo.torque:.6g}"'
        text += "/>"
    if wheel.steer:
        end, gain = wheel.steer, _STEER_STIFFNESS
        text += f'<general name="{name}_steer" joint="{name}_steer_joint" ctrlrange="{-end:g} {end:g}" '
        text += f'gainprm="{gain:g}" biastype="affine" biasprm="0 -{gain:g} 0"/>'
    return text


def _text(*values: float) -> str:
    return " ".join(f"{value:.5g}" for value in values)
