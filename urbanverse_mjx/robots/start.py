"""Checks in C MuJoCo whether a robot on wheels falls over when it starts or stops on level ground.

In:   `RobotSpec`. Out:  `Start`. When: when a robot is described; simulation does not need it.
"""

import dataclasses

import mujoco
import numpy as np

from ..datatypes import RobotSpec
from .wheel_drive import WheelDrive, WheelTable

#: Sliding friction of the streets' ground.
_FRICTION = 1.0
#: s at rest, then at full speed, then with the command to stop.
_STANDING_TIME, DRIVING_TIME, _STOPPING_TIME = 0.5, 2.0, 1.0
#: Shares of the motors' gain that are tried where a robot falls over.
_GAIN_SHARES = (1 / 2, 1 / 4, 1 / 8, 1 / 16, 1 / 32)
#: Share of `RobotSpec.max_speed` that motors must reach.
MIN_SPEED_SHARE = 0.8


@dataclasses.dataclass(frozen=True)
class Start:
    """A start from rest with the command for full speed straight ahead, as a waypoint 1 m ahead gives it, and a stop
    `DRIVING_TIME` s later.

    Attributes:
      touches: name of the first collision sphere other than feet that touched the ground; None where none did.
      after: s from the command to start until then; 0 where it touches the ground at rest, None where nothing touched.
      speed: m/s ahead when the command to stop comes, or at the touch before it.
    """

    touches: str | None
    after: float | None
    speed: float


@dataclasses.dataclass(frozen=True)
class WeakerMotors:
    """Weaker speed servos with which a robot stays on its feet.

    Attributes:
      share: of the gain of every driven wheel's actuator, and of what opposes it: its bias or its joint's damping.
      gain: `gainprm[0]` of the first wheel's actuator with that share.
      damping: N m s/rad of the first wheel's joint with that share; None where the actuator has a bias.
      start: how the robot starts with them.
    """

    share: float
    gain: float
    damping: float | None
    start: Start


def start(robot: RobotSpec, share: float = 1.0) -> Start | None:
    """Simulates the start of a robot; None for one that walks.

    Args:
      share: of the gain of its motors, see `WeakerMotors`.
    """
    command = robot.command
    if not isinstance(command, (WheelDrive, WheelTable)):
        return None
    spec = mujoco.MjSpec.from_string(robot.mjcf)
    ground = spec.worldbody.add_geom(name="_ground", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[50.0, 50.0, 1.0])
    ground.friction[0], ground.contype, ground.conaffinity = _FRICTION, 1, 0
    model = spec.compile()
    for actuator in command.motors:
        _weaken(model, actuator, share)
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    root = model.body(robot.root_body)
    data.joint(root.jntadr[0]).qpos[2] = robot.spawn_height
    feet = {model.geom(name).id for name in robot.foot_geoms}
    full, still = (np.asarray(command(np.array([v, 0.0])), np.float64) for v in (robot.max_speed, 0.0))
    speed = 0.0
    for step in range(
        -int(_STANDING_TIME / model.opt.timestep), int((DRIVING_TIME + _STOPPING_TIME) / model.opt.timestep)
    ):
        time = step * float(model.opt.timestep)
        data.ctrl[:] = full if 0.0 <= time < DRIVING_TIME else still
        mujoco.mj_step(model, data)
        others = set(data.contact.geom.ravel().tolist()) - feet - {model.geom("_ground").id}
        if others:
            geom = min(others)
            return Start(model.geom(geom).name or f"geom {geom}", max(time, 0.0), speed)
        if time < DRIVING_TIME:
            speed = float(data.joint(root.jntadr[0]).qvel[:3] @ data.body(root.id).xmat.reshape(3, 3)[:, 0])
    return Start(None, None, speed)


def weaker_motors(robot: RobotSpec) -> WeakerMotors | None:
    """The strongest motors of 1/2, 1/4, .. 1/32 of the gain with which a robot on wheels stays on its feet and nearly
    reaches its speed; None where there are none."""
    for share in _GAIN_SHARES:
        found = start(robot, share)
        if found is not None and found.touches is None and found.speed > MIN_SPEED_SHARE * robot.max_speed:
            model, wheel = mujoco.MjModel.from_xml_string(robot.mjcf), robot.command.motors[0]
            damping = _weaken(model, wheel, share)
            return WeakerMotors(share, float(model.actuator_gainprm[wheel, 0]), damping, found)
    return None


def _weaken(model: mujoco.MjModel, actuator: int, share: float) -> float | None:
    """Scales the speed servo of a wheel; returns the damping of its joint, or None where the servo has a bias."""
    model.actuator_gainprm[actuator, 0] *= share
    if model.actuator_biasprm[actuator].any():
        model.actuator_biasprm[actuator] *= share
        return None
    dof = model.jnt_dofadr[model.actuator_trnid[actuator, 0]]
    model.dof_damping[dof] *= share
    return float(model.dof_damping[dof])
