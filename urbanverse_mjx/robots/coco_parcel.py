"""COCO with its arm, whose hand holds a parcel that it can release.

In:   -
Out:  `RobotSpec` with an `Arm` and a `Parcel`.
When: once, at construction.

The parcel hangs at the hand by three slides and a ball joint, which together allow every motion. Servos hold it at the
hand while their command is 1; their gains are affine in position and velocity, so that they give no force at all at 0,
and the parcel then moves as a free body: what it does relative to the hand is the difference of two motions, of which
none acts on the other. All engines compute this as they compute any joint, and its contacts as those of any sphere.
"""

import dataclasses
from typing import Any

import jax.numpy as jnp
import mujoco

from ..datatypes import Parcel, RobotSpec
from . import arm_body
from .coco_arm import make_coco_arm
from .description import reach

#: m, half a side of the cube, and kg: a small carton.
HALF_SIDE, MASS = 0.06, 0.5
#: m, radius of the spheres in its corners, which touch each other, so that a wall comes between by millimetres only.
CORNER_RADIUS = 0.5 * HALF_SIDE
#: m from the fingertip's centre to the parcel's middle, and that in the hand's frame.
AHEAD = arm_body.TIP_RADIUS + HALF_SIDE
PLACE = (arm_body.TO_TIP[0] + AHEAD, 0.0, 0.0)
#: kg and kg m^2 of the bodies between the joints, which MuJoCo does not allow to have none.
_LITTLE_MASS, _LITTLE_INERTIA = 1e-5, 1e-8
#: 1/s and damping ratio of the parcel at a hand that stands: as stiff as explicit servos are stable at 10 ms. It sags
#: by 3 mm.
_FREQUENCY, _DAMPING = 60.0, 0.4
_FRICTION = 0.6
#: Colour (linear RGBA) of the carton.
_COLOUR = (0.55, 0.36, 0.17, 1.0)
NAME = "parcel"


def corner_names() -> tuple[str, ...]:
    """Names of the spheres in the parcel's corners."""
    return tuple(f"{NAME}_{k}" for k in range(8))


def make_coco_parcel() -> RobotSpec:
    """`make_coco_arm` with a parcel at the hand.

    Actuators: those of COCO and its arm, then the six of `Parcel.actuators`, to which `command` gives 1. The fingertip
    and the parcel's spheres are the last of `foot_geoms`: what they touch of the ground and of a parcel box is no hit,
    and their forces are in `Contacts.foot_force`.
    """
    arm = make_coco_arm()
    assert arm.arm is not None
    spec = mujoco.MjSpec.from_string(arm.mjcf)
    spec.modelname = "coco_parcel"
    first = len(spec.actuators)
    _add_parcel(spec, spec.body(f"{arm.arm.joints[-1]}_link"))
    (key,) = spec.keys
    key.qpos = [*key.qpos, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]
    model = spec.compile()
    held, below = jnp.ones(6), arm.command

    def command(velocity: Any) -> Any:
        return jnp.concatenate([below(velocity), held])

    # Held, it reaches so far before the fingertip; what it does after its release needs no more.
    tip = model.geom(arm.arm.tip).id
    model.geom_size[tip, 0] += 2.0 * HALF_SIDE
    model.geom_conaffinity[[model.geom(name).id for name in corner_names()]] = 0
    return dataclasses.replace(
        arm,
        name="coco_parcel",
        mjcf=spec.to_xml(),
        foot_geoms=(*arm.foot_geoms, *corner_names()),
        circumradius=reach(model, model.body(arm.root_body).id),
        command=command,
        parcel=Parcel(NAME, corner_names(), tuple(range(first, first + 6)), HALF_SIDE, AHEAD),
    )


def _add_parcel(spec: mujoco.MjSpec, hand: mujoco.MjsBody) -> None:
    body, place = hand, PLACE
    for axis, name in enumerate("xyz"):
        body = body.add_body(name=f"{NAME}_{name}", pos=place)
        _weigh(body, _LITTLE_MASS, _LITTLE_INERTIA)
        along = [float(k == axis) for k in range(3)]
        body.add_joint(name=f"{NAME}_{name}", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=along)
        place = (0.0, 0.0, 0.0)
    body = body.add_body(name=NAME)
    inertia = MASS * (2.0 * HALF_SIDE) ** 2 / 6.0
    _weigh(body, MASS, inertia)
    body.add_joint(name=f"{NAME}_turn", type=mujoco.mjtJoint.mjJNT_BALL)
    middle = HALF_SIDE - CORNER_RADIUS
    for k, name in enumerate(corner_names()):
        at = [middle if k >> i & 1 else -middle for i in range(3)]
        body.add_geom(
            name=name,
            type=mujoco.mjtGeom.mjGEOM_SPHERE,
            pos=at,
            size=[CORNER_RADIUS, 0.0, 0.0],
            group=3,
            contype=0,
            conaffinity=1,
            friction=[_FRICTION, 0.005, 0.0001],
            rgba=(0.2, 0.6, 1.0, 0.3),
        )
    body.add_geom(
        type=mujoco.mjtGeom.mjGEOM_BOX, size=[HALF_SIDE] * 3, group=2, contype=0, conaffinity=0, mass=0.0, rgba=_COLOUR
    )
    # Affine gains: force = command * (-stiffness * position - damping * velocity).
    for name, axis, inertial in (
        *((f"{NAME}_{x}", 0, MASS) for x in "xyz"),
        *((f"{NAME}_turn", k, inertia) for k in range(3)),
    ):
        stiffness, damping = inertial * _FREQUENCY**2, 2.0 * _DAMPING * inertial * _FREQUENCY
        spec.add_actuator(
            name=f"{name}_{axis}",
            target=name,
            trntype=mujoco.mjtTrn.mjTRN_JOINT,
            gaintype=mujoco.mjtGain.mjGAIN_AFFINE,
            gainprm=[0.0, -stiffness, -damping, *[0.0] * 7],
            biastype=mujoco.mjtBias.mjBIAS_NONE,
            gear=[float(k == axis) for k in range(3)] + [0.0] * 3,
            ctrlrange=(0.0, 1.0),
            ctrllimited=True,
        )


def _weigh(body: mujoco.MjsBody, mass: float, inertia: float) -> None:
    body.explicitinertial, body.mass, body.ipos, body.inertia = True, mass, [0.0] * 3, [inertia] * 3
