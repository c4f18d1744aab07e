"""The Unitree Go2's body as MJCF text: masses, joints, motors, collision spheres and visual geoms.

In: none. Out: MJCF text of one free body without ground and light. When: once, at construction.

Sources of the numbers, as docs/sources/go2.json lists them: "urdf" = unitree_ros go2_description.urdf at d6f13aa,
"menagerie" = mujoco_menagerie unitree_go2/go2.xml at 2ffe3e3, "rl_lab" = unitree_rl_lab's Go2 velocity task at e72a072,
"rl_mjlab" = unitree_rl_mjlab go2_constants.py at 5b7e396. Left and right, front and rear mirror each other.
"""

import dataclasses
import math

from .go2_appearance import base_appearance, leg_appearance, materials

# --- Kinematics (menagerie, equal to urdf; m) ---
HIP_X, HIP_Y = 0.1934, 0.0465  # of the abduction axis in the trunk
HIP_TO_THIGH = 0.0955
THIGH_LENGTH = CALF_LENGTH = 0.213
FOOT_RADIUS = 0.022
FOOT_IN_CALF = (-0.002, 0.0, -0.213)

#: Leg name -> (+1 front, -1 rear), (+1 left, -1 right).
LEGS = {"FL": (1.0, 1.0), "FR": (1.0, -1.0), "RL": (-1.0, 1.0), "RR": (-1.0, -1.0)}
JOINTS = ("hip", "thigh", "calf")
JOINT_NAMES = tuple(f"{leg}_{joint}_joint" for leg in LEGS for joint in JOINTS)
FOOT_NAMES = tuple(f"{leg}_foot" for leg in LEGS)


@dataclasses.dataclass(frozen=True)
class Link:
    """Mass (kg), centre of mass (m) and inertia about it in the link's axes (kg m^2: xx, yy, zz, xy, xz, yz), as the
    front left leg has them."""

    mass: float
    centre: tuple[float, float, float]
    inertia: tuple[float, float, float, float, float, float]


# --- Masses (urdf; the calf with its foot merged in: menagerie) ---
BASE = Link(6.921, (0.021112, 0.0, -0.005366), (0.02448, 0.098077, 0.107, 0.00012166, 0.0014849, -3.12e-05))
HIP = Link(0.678, (-0.0054, 0.00194, -0.000105), (0.00048, 0.000884, 0.000596, -3.01e-06, 1.11e-06, -1.42e-06))
THIGH = Link(1.152, (-0.00374, -0.0223, -0.0327), (0.00584, 0.0058, 0.00103, 8.72e-05, -0.000289, 0.000808))
CALF = Link(
    0.241352,
    (0.00629595, -0.000622121, -0.141417),
    (0.0014635375, 0.0014899929, 5.3269329e-05, 2.1754499e-07, 5.9668142e-06, 1.2247869e-05),
)


@dataclasses.dataclass(frozen=True)
class Motor:
    """Joint range (rad) of a front leg and of a rear one, torque (N m) and speed (rad/s) limits, rotor inertia at the
    joint (kg m^2)."""

    front: tuple[float, float]
    rear: tuple[float, float]
    torque: float
    speed: float
    armature: float


# Ranges and torques: urdf and menagerie; speeds: urdf; armature: rl_mjlab (menagerie has 0.01 for all).
MOTORS = {
    "hip": Motor((-1.0472, 1.0472), (-1.0472, 1.0472), 23.7, 30.1, 0.01),
    "thigh": Motor((-1.5708, 3.4907), (-0.5236, 4.5379), 23.7, 30.1, 0.01),
    "calf": Motor((-2.7227, -0.83776), (-2.7227, -0.83776), 45.43, 15.7, 0.02),
}
# --- Servo of all joints (rl_lab, which runs on the robot): N m/rad, N m s/rad ---
STIFFNESS, DAMPING = 40.0, 1.0
# --- Standing pose (rl_lab, equal to isaaclab's and unitree_rl_gym's; rad). A left hip's is positive: outward. ---
STAND_HIP, STAND_THIGH_FRONT, STAND_THIGH_REAR, STAND_CALF = 0.1, 0.8, 1.0, -1.5

# --- Contact (menagerie's feet 0.8, other geoms 0.6; with condim 3, the engines' own) ---
FOOT_FRICTION, BODY_FRICTION = 0.8, 0.6

# --- Collision spheres: centre (m) in the link of the front left leg, radius (m). They cover menagerie's boxes and
# cylinders; no point of those is 3 cm outside (tests/robots/test_go2.py). Head: the spheres of its go2_mjx.xml. ---
BASE_SPHERES = (
    *(((x, 0.0, 0.0), 0.065) for x in (-0.16, -0.08, 0.0, 0.08, 0.16)),
    ((0.285, 0.0, 0.01), 0.05),
    ((0.293, 0.0, -0.06), 0.047),
)
HIP_SPHERES = (((0.0, 0.08, 0.0), 0.046),)
THIGH_SPHERES = tuple(((0.0, 0.0, z), 0.022) for z in (-0.03, -0.09, -0.15, -0.2))
CALF_SPHERES = (((0.012, 0.0, -0.03), 0.016), ((0.012, 0.0, -0.09), 0.016), ((0.02, 0.0, -0.15), 0.014))

# --- Choices ---
#: s. 4 physics steps a control step of 20 ms, as rl_lab, isaaclab and mjlab have it.
PHYSICS_TIMESTEP = 0.005
#: m, the trunk's origin above flat ground at rest in the standing pose: the rear feet's 0.325 and the front ones'
#: 0.3346 (go2.json, standing_height_derived), the hips turned out by 0.1 rad.
SPAWN_HEIGHT = 0.33
#: 5 mm in front of the head's foremost point (`go2_appearance`, the lamp), pitched down by 10 degrees. go2.json has no
#: camera, so its pose is chosen here.
CAMERA_POSITION, CAMERA_PITCH_DOWN, CAMERA_FOVY_DEG = (0.352, 0.0, 0.0), 0.1745, 70.0


def stand_pose() -> tuple[float, ...]:
    """(12,) rad, joint angles in the order of `JOINT_NAMES`."""
    pose: list[float] = []
    for front, left in LEGS.values():
        pose += [left * STAND_HIP, STAND_THIGH_FRONT if front > 0 else STAND_THIGH_REAR, STAND_CALF]
    return tuple(pose)


def _numbers(*values: float) -> str:
    return " ".join(f"{v:.9g}" for v in values)


def _inertial(link: Link, front: float = 1.0, left: float = 1.0) -> str:
    """Mirroring an axis changes the sign of its coordinate, and of the products of inertia that contain it once."""
    (x, y, z), (xx, yy, zz, xy, xz, yz) = link.centre, link.inertia
    products = (xy * front * left, xz * front, yz * left)
    return (
        f'<inertial pos="{_numbers(x * front, y * left, z)}" mass="{link.mass:.9g}" '
        f'fullinertia="{_numbers(xx, yy, zz, *products)}"/>'
    )


def _spheres(name: str, spheres: tuple[tuple[tuple[float, float, float], float], ...], left: float = 1.0) -> str:
    return "".join(
        f'<geom name="{name}_{i}" class="collision" size="{radius}" pos="{_numbers(x, left * y, z)}"/>'
        for i, ((x, y, z), radius) in enumerate(spheres)
    )


def _joint(leg: str, joint: str, front: float) -> str:
    motor = MOTORS[joint]
    axis = "1 0 0" if joint == "hip" else "0 1 0"
    return (
        f'<joint name="{leg}_{joint}_joint" axis="{axis}" damping="{DAMPING}" armature="{motor.armature}" '
        f'range="{_numbers(*(motor.front if front > 0 else motor.rear))}"/>'
    )


def _leg(leg: str) -> str:
    front, left = LEGS[leg]
    shapes = leg_appearance(left)
    return f"""
      <body name="{leg}_hip" pos="{_numbers(front * HIP_X, left * HIP_Y, 0.0)}">
        {_inertial(HIP, front, left)}
        {_joint(leg, "hip", front)}
        {_spheres(f"{leg}_hip", HIP_SPHERES, left)}{shapes["hip"]}
        <body name="{leg}_thigh" pos="{_numbers(0.0, left * HIP_TO_THIGH, 0.0)}">
          {_inertial(THIGH, left=left)}
          {_joint(leg, "thigh", front)}
          {_spheres(f"{leg}_thigh", THIGH_SPHERES)}{shapes["thigh"]}
          <body name="{leg}_calf" pos="{_numbers(0.0, 0.0, -THIGH_LENGTH)}">
            {_inertial(CALF, left=left)}
            {_joint(leg, "calf", front)}
            {_spheres(f"{leg}_calf", CALF_SPHERES)}{shapes["calf"]}
            <geom name="{leg}_foot" class="collision" size="{FOOT_RADIUS}" pos="{_numbers(*FOOT_IN_CALF)}"
                  friction="{FOOT_FRICTION} 0.005 0.0001"/>
          </body>
        </body>
      </body>"""


def _actuator(leg: str, joint: str) -> str:
    motor, name = MOTORS[joint], f"{leg}_{joint}"
    span = motor.front if LEGS[leg][0] > 0 else motor.rear
    # Damping is a joint property, so that all engines integrate it in the same way.
    return (
        f'<general name="{name}" joint="{name}_joint" biastype="affine" gainprm="{STIFFNESS}" '
        f'biasprm="0 -{STIFFNESS} 0" ctrlrange="{_numbers(*span)}" forcerange="-{motor.torque} {motor.torque}"/>'
    )


def make_mjcf() -> str:
    """MJCF text of the robot. Actuators: joint angles (rad) in the order of `JOINT_NAMES`."""
    legs = "".join(_leg(leg) for leg in LEGS)
    actuators = "\n    ".join(_actuator(leg, joint) for leg in LEGS for joint in JOINTS)
    view = _numbers(math.sin(CAMERA_PITCH_DOWN), 0.0, math.cos(CAMERA_PITCH_DOWN))
    pose = _numbers(0.0, 0.0, SPAWN_HEIGHT, 1.0, 0.0, 0.0, 0.0, *stand_pose())
    return f"""<mujoco model="go2">
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
    {materials()}
  </asset>
  <worldbody>
    <body name="base" pos="0 0 {SPAWN_HEIGHT}">
      <freejoint name="root"/>
      {_inertial(BASE)}
      <camera name="front_cam" pos="{_numbers(*CAMERA_POSITION)}" xyaxes="0 -1 0 {view}" fovy="{CAMERA_FOVY_DEG}"/>
      {_spheres("base", BASE_SPHERES)}{base_appearance()}{legs}
    </body>
  </worldbody>
  <actuator>
    {actuators}
  </actuator>
  <keyframe>
    <key name="stand" qpos="{pose}" ctrl="{_numbers(*stand_pose())}"/>
  </keyframe>
</mujoco>
"""
