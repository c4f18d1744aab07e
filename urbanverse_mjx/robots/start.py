"""Checks in C MuJoCo whether a robot on wheels falls over when it starts on level ground.

In:   `RobotSpec`. Out:  `Start`. When: when a robot is described; simulation does not need it.
"""

import dataclasses

import mujoco
import numpy as np

from ..datatypes import RobotSpec
from .wheel_drive import WheelDrive

#: Sliding friction of the streets' ground.
_FRICTION = 1.0
#: s at rest, then at full speed.
_REST, _DRIVE = 0.5, 2.0


@dataclasses.dataclass(frozen=True)
class Start:
    """A start from rest with the command for full speed straight ahead, as a waypoint 1 m ahead gives it.

    Attributes:
      touches: name of the first collision sphere other than feet that touched the ground; None where none did.
      after: s from the command until then; 0 where it touches the ground at rest.
    """

    touches: str | None
    after: float


def start(robot: RobotSpec) -> Start | None:
    """Simulates the start of a robot; None for one that walks."""
    if not isinstance(robot.command, WheelDrive):
        return None
    spec = mujoco.MjSpec.from_string(robot.mjcf)
    ground = spec.worldbody.add_geom(name="_ground", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[50.0, 50.0, 1.0])
    ground.friction[0], ground.contype, ground.conaffinity = _FRICTION, 1, 0
    model = spec.compile()
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    data.joint(model.body(robot.root_body).jntadr[0]).qpos[2] = robot.spawn_height
    feet = {model.geom(name).id for name in robot.foot_geoms}
    full = np.asarray(robot.command(np.array([robot.max_speed, 0.0])), np.float64)
    steps = int(_DRIVE / model.opt.timestep)
    for step in range(-int(_REST / model.opt.timestep), steps):
        data.ctrl[:] = full if step >= 0 else 0.0
        mujoco.mj_step(model, data)
        others = set(data.contact.geom.ravel().tolist()) - feet - {model.geom("_ground").id}
        if others:
            geom = min(others)
            return Start(model.geom(geom).name or f"geom {geom}", max(step, 0) * float(model.opt.timestep))
    return Start(None, _DRIVE)
