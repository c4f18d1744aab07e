"""A light arm of five joints on a robot: links, servos and collision spheres of the ViperX 300.

In:   a robot's MJCF as `MjSpec`, where the arm stands on it.
Out:  the same with the arm.
When: once, at construction.

Lengths, masses, centres of mass, moments of inertia, ranges and torques are those of the arm's description by its
maker (Interbotix/interbotix_ros_manipulators, interbotix_xsarm_descriptions/urdf/vx300.urdf.xacro): 5 joints, 750 mm of
reach. Products of inertia, which are small, and the friction of its joints are left out; the fingers are closed.
"""

import dataclasses

import mujoco
import numpy as np

#: (m, m, m) from a joint to the next one, from the arm's foot to the centre of the fingertip.
_TO_WAIST, _TO_SHOULDER = (0.0, 0.0, 0.079), (0.0, 0.0, 0.04805)
_TO_ELBOW, _TO_WRIST, _TO_ROTATE = (0.05955, 0.0, 0.3), (0.3, 0.0, 0.0), (0.069744, 0.0, 0.0)
#: The frame `ee_gripper_link` of the description, between the fingertips.
TO_TIP = (0.042825 + 0.025875 + 0.0385, 0.0, 0.0)
#: m, radius of the fingertip, which is chosen here.
TIP_RADIUS = 0.012
TIP = "fingertip"
#: rad, about the description's limit: hand above the robot, elbow behind the shoulder, nothing beyond a base of 0.7 m.
FOLDED = (0.0, -1.8, 1.55, 0.8, 0.0)
#: rad/s up to which targets move; the description allows pi, which the servos below do not reach under load.
SPEED = 1.0
#: Friction of the arm's surfaces, chosen here: that of COCO's shell.
_FRICTION = 0.6


@dataclasses.dataclass(frozen=True)
class Part:
    """A rigid part: mass (kg), centre of mass (3,) m and moments of inertia (3,) kg m^2 about it in a link's frame."""

    mass: float
    centre: tuple[float, float, float]
    inertia: tuple[float, float, float]


@dataclasses.dataclass(frozen=True)
class _Joint:
    """A joint with its link.

    Attributes:
      name: of the joint.
      place: m in the link before.
      axis: in its own link.
      limits: rad. torque: N m, largest.
      gain: N m/rad and damping: N m s/rad of its servo, armature: kg m^2, chosen here for a stable servo at 10 ms.
      parts: of the link.
      spheres: x, y, z, radius (m), chosen here.
      bars: visual capsules: x, y, z, x, y, z, radius (m).
    """

    name: str
    place: tuple[float, float, float]
    axis: tuple[int, int, int]
    limits: tuple[float, float]
    torque: float
    gain: float
    damping: float
    armature: float
    parts: tuple[Part, ...]
    spheres: tuple[tuple[float, ...], ...]
    bars: tuple[tuple[float, ...], ...]


#: The arm's foot. The description's inertial frames are turned by 90 degrees about z, so x and y are swapped here.
_FOOT = Part(0.969034, (-0.0534774, -0.000562575, 0.0205961), (0.0017, 0.006024, 0.007162))
JOINTS = (
    _Joint(
        "waist",
        _TO_WAIST,
        (0, 0, 1),
        (-3.14158, 3.14158),
        10.0,
        100.0,
        9.5,
        0.05,
        (Part(0.798614, (0.000259233, 0.0, 0.0116129), (0.001138, 0.0009388, 0.001201)),),
        ((0.0, 0.0, 0.048, 0.06),),
        ((0.0, 0.0, 0.0, 0.0, 0.0, 0.048, 0.05),),
    ),
    _Joint(
        "shoulder",
        _TO_SHOULDER,
        (0, 1, 0),
        (-1.850049, 1.256637),
        20.0,
        200.0,
        12.0,
        0.05,
        (Part(0.792592, (0.0206949, 0.0, 0.226459), (0.008937, 0.008925, 0.0009357)),),
        ((0.01, 0.0, 0.1, 0.05), (0.01, 0.0, 0.2, 0.05), (0.04, 0.0, 0.3, 0.055)),
        ((0.0, 0.0, 0.0, 0.0, 0.0, 0.3, 0.035), (0.0, 0.0, 0.3, 0.05955, 0.0, 0.3, 0.035)),
    ),
    _Joint(
        "elbow",
        _TO_ELBOW,
        (0, 1, 0),
        (-1.762783, 1.605703),
        15.0,
        150.0,
        7.0,
        0.05,
        (Part(0.544659, (0.181265, -0.0002065, 0.0), (0.0002267, 0.005447, 0.005574)),),
        ((0.1, 0.0, 0.0, 0.045), (0.2, 0.0, 0.0, 0.045)),
        ((0.0, 0.0, 0.0, 0.3, 0.0, 0.0, 0.03),),
    ),
    _Joint(
        "wrist_angle",
        _TO_WRIST,
        (0, 1, 0),
        (-1.867502, 2.234021),
        5.0,
        40.0,
        1.9,
        0.03,
        (Part(0.115395, (0.046743, 0.0, 0.010565), (0.00004514, 0.00004631, 0.0000527)),),
        ((0.0, 0.0, 0.0, 0.045),),
        ((0.0, -0.03, 0.0, 0.0, 0.03, 0.0, 0.03), (0.0, 0.0, 0.0, 0.07, 0.0, 0.0, 0.028)),
    ),
    _Joint(
        "wrist_rotate",
        _TO_ROTATE,
        (1, 0, 0),
        (-3.14158, 3.14158),
        1.0,
        10.0,
        0.5,
        0.01,
        (
            Part(0.097666, (0.023001, 0.0, 0.011523), (0.00002436, 0.00003268, 0.00002119)),
            Part(0.008009, (0.050878, 0.0, 0.0), (0.0000042979, 0.0000020386, 0.0000023796)),
            Part(0.150986, (0.049619, 0.0, -0.000776), (0.0003283, 0.00007895, 0.0003095)),
            Part(0.034796, (0.086044, 0.021, 0.0), (0.00001255, 0.00002433, 0.00001417)),
            Part(0.034796, (0.086044, -0.021, 0.0), (0.00001255, 0.00002433, 0.00001417)),
        ),
        ((0.02, 0.0, 0.0, 0.045), (0.07, 0.0, 0.0, 0.025)),
        ((0.02, 0.0, 0.0, 0.035, 0.0, 0.0, 0.038), (0.06, 0.0, 0.0, TO_TIP[0], 0.0, 0.0, TIP_RADIUS)),
    ),
)


def joined(parts: tuple[Part, ...]) -> tuple[Part, np.ndarray]:
    """Several rigid parts as one, and its inertia (3, 3) kg m^2 about its centre of mass, by the theorem of parallel
    axes."""
    masses = np.array([p.mass for p in parts])
    mass, centre = masses.sum(), masses @ np.array([p.centre for p in parts]) / masses.sum()
    inertia = np.zeros((3, 3))
    for part in parts:
        away = np.array(part.centre) - centre
        inertia += np.diag(part.inertia) + part.mass * ((away @ away) * np.identity(3) - np.outer(away, away))
    x, y, z = (float(x) for x in centre)
    return Part(float(mass), (x, y, z), (float(inertia[0, 0]), float(inertia[1, 1]), float(inertia[2, 2]))), inertia


def add_arm(spec: mujoco.MjSpec, body: str, place: tuple[float, float, float], riser: float) -> None:
    """Adds the arm, its position servos in the order of `JOINTS`, and the column on which it stands.

    Args:
      body: name of the body that carries it.
      place: m, the arm's foot in that body.
      riser: m, height of the column below.
    """
    carrier = spec.body(body)
    foot = carrier.add_body(name="arm_foot", pos=place)
    _weigh(foot, (_FOOT,))
    middle = -0.5 * riser
    _box(foot, (0.0, 0.0, middle), (0.07, 0.07, 0.5 * riser), (0.30, 0.31, 0.33, 1.0))
    _box(foot, (-0.03, 0.0, 0.025), (0.10, 0.07, 0.025), (0.10, 0.10, 0.11, 1.0))
    _sphere(foot, "arm_riser", (0.0, 0.0, middle), 0.09)
    _sphere(foot, "arm_foot", (0.0, 0.0, 0.03), 0.07)
    link = foot
    for joint in JOINTS:
        link = link.add_body(name=f"{joint.name}_link", pos=joint.place)
        _weigh(link, joint.parts)
        link.add_joint(
            name=joint.name,
            type=mujoco.mjtJoint.mjJNT_HINGE,
            axis=joint.axis,
            range=joint.limits,
            limited=True,
            damping=[joint.damping, 0.0, 0.0],
            armature=joint.armature,
        )
        for number, (*centre, radius) in enumerate(joint.spheres):
            _sphere(link, f"{joint.name}_{number}", tuple(centre), radius)
        for bar in joint.bars:
            link.add_geom(
                type=mujoco.mjtGeom.mjGEOM_CAPSULE,
                fromto=bar[:6],
                size=[bar[6], 0.0, 0.0],
                group=2,
                contype=0,
                conaffinity=0,
                mass=0.0,
                rgba=(0.13, 0.13, 0.15, 1.0),
            )
        spec.add_actuator(
            name=joint.name,
            target=joint.name,
            trntype=mujoco.mjtTrn.mjTRN_JOINT,
            biastype=mujoco.mjtBias.mjBIAS_AFFINE,
            gainprm=[joint.gain, *[0.0] * 9],
            biasprm=[0.0, -joint.gain, *[0.0] * 8],
            ctrlrange=joint.limits,
            ctrllimited=True,
            forcerange=(-joint.torque, joint.torque),
            forcelimited=True,
        )
    _sphere(link, TIP, TO_TIP, TIP_RADIUS)


def _weigh(body: mujoco.MjsBody, parts: tuple[Part, ...]) -> None:
    whole, inertia = joined(parts)
    body.explicitinertial = True
    body.mass, body.ipos = whole.mass, whole.centre
    body.fullinertia = [inertia[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]


def _sphere(body: mujoco.MjsBody, name: str, centre: tuple[float, ...], radius: float) -> None:
    body.add_geom(
        name=name,
        type=mujoco.mjtGeom.mjGEOM_SPHERE,
        pos=centre,
        size=[radius, 0.0, 0.0],
        group=3,
        contype=0,
        conaffinity=1,
        friction=[_FRICTION, 0.005, 0.0001],
        rgba=(0.2, 0.6, 1.0, 0.3),
    )


def _box(body: mujoco.MjsBody, centre: tuple[float, ...], half: tuple[float, ...], colour: tuple[float, ...]) -> None:
    body.add_geom(
        type=mujoco.mjtGeom.mjGEOM_BOX, pos=centre, size=half, group=2, contype=0, conaffinity=0, mass=0.0, rgba=colour
    )
