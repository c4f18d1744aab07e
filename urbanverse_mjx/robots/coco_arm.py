"""COCO with a light arm of five joints on its lid: drives as COCO does, and its fingertip can press.

In:   -
Out:  `RobotSpec` with an `Arm`.
When: once, at construction.
"""

from typing import Any

import jax.numpy as jnp
import mujoco

from ..datatypes import Arm, RobotSpec
from . import arm_body, coco_body
from .coco import clip_command, make_coco
from .description import reach
from .waypoint import clip_velocity, pd_velocity

#: m/s; half of COCO's, because the arm stands high on it.
MAX_SPEED = 1.0
MAX_YAW_RATE = 1.0
#: m in base_link: the arm's foot near the front edge of the lid, on a column that lifts the shoulder to 0.73 m, in the
#: middle of the heights of buttons.
RISER = 0.12
ARM_PLACE = (0.2, 0.0, coco_body.SHELL_Z + 0.5 * coco_body.BODY_HEIGHT + RISER)
#: m, the height up to which objects are obstacles: the hand when it is raised.
PLANNER_HEIGHT = 1.25


def _waypoint_to_velocity(waypoint: Any, control_period: float) -> tuple[Any, Any]:
    return pd_velocity(waypoint, control_period, MAX_SPEED, MAX_YAW_RATE)


def make_coco_arm() -> RobotSpec:
    """COCO (differential) with a ViperX 300, see `arm_body`.

    Actuators: those of COCO, then the targets (rad) of waist, shoulder, elbow, wrist angle and wrist rotation, which
    `command` leaves folded. The fingertip is the last of `foot_geoms`: what it touches of the ground and of buttons is
    no hit, and its force is in `Contacts.foot_force`.
    """
    coco = make_coco("differential")
    spec = mujoco.MjSpec.from_string(coco.mjcf)
    spec.modelname = "coco_arm"
    arm_body.add_arm(spec, coco.root_body, ARM_PLACE, RISER)
    wheels = [0.0] * len(coco_body.WHEELS)
    spec.add_key(name="folded", qpos=[0, 0, coco.spawn_height, 1, 0, 0, 0, *wheels, *arm_body.FOLDED])
    model = spec.compile()
    number = len(wheels)
    folded = jnp.array(arm_body.FOLDED)
    drive = coco.command

    def command(velocity: Any) -> Any:
        slow = clip_velocity(clip_command(velocity), MAX_SPEED, MAX_YAW_RATE)
        return jnp.concatenate([drive(slow), folded])

    names = tuple(joint.name for joint in arm_body.JOINTS)
    return RobotSpec(
        name="coco_arm",
        mjcf=spec.to_xml(),
        root_body=coco.root_body,
        foot_geoms=(*coco.foot_geoms, arm_body.TIP),
        camera=coco.camera,
        circumradius=reach(model, model.body(coco.root_body).id),
        spawn_height=coco.spawn_height,
        max_speed=MAX_SPEED,
        max_yaw_rate=MAX_YAW_RATE,
        physics_timestep=coco.physics_timestep,
        command=command,
        waypoint_to_velocity=_waypoint_to_velocity,
        planner_radius=coco.planner_radius,
        planner_height=PLANNER_HEIGHT,
        step_height=coco.step_height,
        response=coco.response,
        drive=coco.drive,
        arm=Arm(names, tuple(range(number, number + len(names))), arm_body.FOLDED, arm_body.TIP, arm_body.SPEED),
    )
