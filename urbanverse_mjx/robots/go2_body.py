"""The Unitree Go2's body: its row of `legged.toml` by the names that code of the Go2 alone uses.

In: none. Out: MJCF text of one free body without ground and light; numbers. When: once, at construction.
"""

from . import legged

ROW = legged.row("go2")
#: Leg name -> (+1 front, -1 rear), (+1 left, -1 right).
LEGS = ROW.legs
JOINTS = tuple(link.name for link in ROW.links)
JOINT_NAMES, FOOT_NAMES = ROW.joint_names, ROW.foot_names
#: m, of the first joint in the trunk, and from there to the thigh's; lengths of thigh and calf; radius of a foot.
HIP_X, HIP_Y, _ = ROW.mount
HIP_TO_THIGH = ROW.links[1].at[1]
THIGH_LENGTH = CALF_LENGTH = -ROW.links[2].at[2]
FOOT_RADIUS = ROW.foot.radius if ROW.foot else 0.0
#: m, the trunk's origin above flat ground at rest in the standing pose.
SPAWN_HEIGHT = ROW.spawn
PHYSICS_TIMESTEP = legged.PHYSICS_TIMESTEP


def stand_pose() -> tuple[float, ...]:
    """(12,) rad, joint angles in the order of `JOINT_NAMES`."""
    return ROW.stand_pose


def make_mjcf() -> str:
    """MJCF text of the robot. Actuators: joint angles (rad) in the order of `JOINT_NAMES`."""
    return legged.make_mjcf(ROW)
