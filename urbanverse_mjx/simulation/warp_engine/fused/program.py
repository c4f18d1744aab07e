"""What the fused step knows of a robot: sizes and connections as constants of its program, numbers as an array.

In:   `RobotModel`, numbers of slots, contacts and agents.
Out:  `RobotProgram`.
When: once, at construction.
"""

import dataclasses
from typing import Any

import mujoco
import numpy as np

from ....datatypes import validation as v
from ...collision_slots import agent_slots
from ..model import RobotModel
from . import native

#: Lanes of a warp, and bits of the masks that say which velocities move a body.
MAX_VELOCITIES = 32
#: The number of slots is rounded up to a multiple of this, so that banks share programs.
_SLOTS_STEP = 8
_FIXED, _FREE, _SLIDE, _HINGE, _BALL = range(5)
_JOINTS = {
    int(mujoco.mjtJoint.mjJNT_FREE): _FREE,
    int(mujoco.mjtJoint.mjJNT_SLIDE): _SLIDE,
    int(mujoco.mjtJoint.mjJNT_HINGE): _HINGE,
    int(mujoco.mjtJoint.mjJNT_BALL): _BALL,
}
#: MuJoCo Warp's least tolerance of the solver in float32, and MuJoCo's smallest number that is not zero.
_LEAST_TOLERANCE, _MINIMUM = 1e-6, 1e-15
#: Share of the slope at the beginning at which a line search ends.
_LINE_TOLERANCE = 0.01


@dataclasses.dataclass(frozen=True)
class RobotProgram:
    """The program of a robot.

    Attributes:
      source: C++, see `native.preamble`.
      numbers: (K,) f32, what `source` calls `Robot`.
    """

    source: str
    numbers: np.ndarray


class NotFusible(v.ValidationError):
    """A robot that the fused step does not serve."""


def check_fusible(robot: RobotModel) -> None:
    """Refuses robots for which MuJoCo Warp is the only path.

    Raises:
      NotFusible: bodies that can be pushed, more than 32 velocities, another tree than one of free, slide,
        hinge and ball joints, one a body, or forces that the program does not know.
    """
    model = robot.model
    where, hint = f"robot {robot.physics.spec.name!r} with impl='warp-fused'", "use impl='warp'"
    if robot.bodies is not None:
        raise _not_fusible("engine.movable", f"{robot.bodies.number} bodies awake", "none with impl='warp-fused'", hint)
    if model.nv > MAX_VELOCITIES:
        raise _not_fusible(where, f"{model.nv} velocities", f"at most {MAX_VELOCITIES}", hint)
    several = model.body_jntnum.max() > 1 or len(np.unique(model.body_rootid[1:])) != 1
    if several or any(int(t) not in _JOINTS for t in model.jnt_type):
        needed = "one tree of free, slide, hinge and ball joints, at most one a body"
        raise _not_fusible(where, "other joints", needed, hint)
    plain = (
        model.actuator_trntype == mujoco.mjtTrn.mjTRN_JOINT,
        model.actuator_dyntype == mujoco.mjtDyn.mjDYN_NONE,
        np.isin(model.actuator_gaintype, (mujoco.mjtGain.mjGAIN_FIXED, mujoco.mjtGain.mjGAIN_AFFINE)),
        np.isin(model.actuator_biastype, (mujoco.mjtBias.mjBIAS_NONE, mujoco.mjtBias.mjBIAS_AFFINE)),
    )
    if not all(np.all(p) for p in plain):
        raise _not_fusible(where, "other actuators", "joint actuators of fixed or affine gain and affine bias", hint)
    balls = model.jnt_type[model.actuator_trnid[:, 0]] == mujoco.mjtJoint.mjJNT_BALL
    if ((model.actuator_gear[balls, :3] != 0.0).sum(1) != 1).any():
        raise _not_fusible(where, "an actuator that turns a ball joint aslant", "one about x, y or z", hint)
    options = model.opt
    extra = {
        "joint springs": model.jnt_stiffness.any(),
        "dry friction of joints": model.dof_frictionloss.any(),
        "margins": model.jnt_margin.any() or model.geom_margin.any(),
        "gravity compensation": model.body_gravcomp.any(),
        "limits of joint forces": model.jnt_actfrclimited.any(),
        "air": options.density != 0.0 or options.viscosity != 0.0 or options.wind.any(),
        "flags of MuJoCo's options": options.disableflags != 0 or options.enableflags != 0,
        "impratio": options.impratio != 1.0,
        "noslip iterations": options.noslip_iterations != 0,
    }
    for what, found in extra.items():
        if found:
            raise _not_fusible(where, what, "none", hint)


def _not_fusible(where: str, found: str, needed: str, hint: str) -> NotFusible:
    return NotFusible(str(v.fail(where, found, needed, hint)))


def build_program(robot: RobotModel, slots: int, contacts: int, agents: int) -> RobotProgram:
    """The program for so many slots of hulls, contacts at once and agents.

    Raises:
      NotFusible: see `check_fusible`.
    """
    check_fusible(robot)
    model, spheres, limits = robot.model, robot.physics.spheres, robot.physics.limits
    above = [_above(model, i) for i in range(model.nv)]
    by_depth = sorted(range(model.nv), key=lambda i: len(above[i]))
    depths = np.array([len(above[i]) for i in by_depth])
    entries = [(i, j) for i in by_depth for j in (*above[i], i)]
    steps = np.arange(depths.max() + 2)
    children = [np.flatnonzero(model.body_parentid == b).tolist() for b in range(model.nbody)]
    children[0].remove(0)
    depth = [0] * model.nbody
    for b in range(1, model.nbody):
        depth[b] = depth[model.body_parentid[b]] + 1
    order = sorted(range(model.nbody), key=lambda b: (depth[b], b))
    joint = [int(j) if n else -1 for j, n in zip(model.body_jntadr, model.body_jntnum, strict=True)]
    bodies = model.geom_bodyid[robot.sphere_geom]
    limit_of = np.full(model.nv, -1)
    limit_of[limits.dof] = np.arange(len(limits.dof))
    driven = model.actuator_trnid[:, 0]
    balls = model.jnt_type == mujoco.mjtJoint.mjJNT_BALL
    spin = np.where(balls[driven], (model.actuator_gear[:, :3] != 0.0).argmax(1), -1)
    numbers = {
        "NQ": model.nq,
        "NV": model.nv,
        "NB": model.nbody,
        "NS": len(bodies),
        "NUM_ACTUATORS": model.nu,
        "NU": max(model.nu, 1),
        "NUM_LIMITS": len(limits.dof),
        "NL": max(len(limits.dof), 1),
        "NUM_FEET": len(robot.physics.spec.foot_geoms),
        "FEET": max(len(robot.physics.spec.foot_geoms), 1),
        "NUM_AGENTS": agents,
        "AGENTS": max(agents, 1),
        "SLOTS": -(-slots // _SLOTS_STEP) * _SLOTS_STEP,
        "MAX_CONTACTS": contacts,
        "LEVELS": max(depth) + 1,
        "DEPTHS": int(depths.max()) + 1,
        "ENTRIES": len(entries),
        "ROOT_QPOS": robot.root,
        "DAMPED": int(model.dof_damping.any()),
        "SQUARES": int(np.all(spheres.solimp[:, 4] == 2.0) and np.all(limits.solimp[:, 4] == 2.0)),
        "FIRST_AGENT": agent_slots.FIRST_OWNER,
        "FIXED": _FIXED,
        "FREE": _FREE,
        "SLIDE": _SLIDE,
        "HINGE": _HINGE,
        "BALL": _BALL,
        "HAS_BALLS": int(balls.any()),
        "AFFINE_GAINS": int(np.any(model.actuator_gaintype == mujoco.mjtGain.mjGAIN_AFFINE)),
    }
    floats = {
        "AGENT_FRICTION": agent_slots.FRICTION,
        # m; see the constants of `contact` and `agents`.
        "FOOT_TOLERANCE": 1e-5,
        "ON_EDGE": 1e-6,
        "ON_AXIS": 1e-6,
        "MINIMUM": _MINIMUM,
        "LINE_TOLERANCE": _LINE_TOLERANCE,
    }
    tables = {
        "BODY_PARENT": model.body_parentid,
        "BODY_JOINT": [_FIXED if j < 0 else _JOINTS[int(model.jnt_type[j])] for j in joint],
        "BODY_QPOS": [0 if j < 0 else model.jnt_qposadr[j] for j in joint],
        "BODY_DOF": [0 if j < 0 else model.jnt_dofadr[j] for j in joint],
        "BODY_MASK": np.array([_mask(model, above, b) for b in range(model.nbody)], np.uint32),
        "CHILD": [c for b in children for c in b],
        "CHILD_START": np.cumsum([0, *map(len, children)]),
        "LEVEL_BODY": order,
        "LEVEL_START": np.searchsorted(sorted(depth), np.arange(max(depth) + 2)),
        "DOF_BODY": model.dof_bodyid,
        "DOF_DEPTH": [len(a) for a in above],
        "DOF_ABOVE": _padded(above),
        "DOF_MASK": np.array([sum(1 << j for j in a) for a in above], np.uint32),
        "DEPTH_DOF": by_depth,
        "DEPTH_START": np.searchsorted(depths, steps),
        "DEPTH_ENTRIES": np.searchsorted([len(above[i]) for i, _ in entries], steps),
        "DOF_LIMIT": limit_of,
        "ENTRY_ROW": [i for i, _ in entries],
        "ENTRY_COLUMN": [j for _, j in entries],
        "SPHERE_BODY": bodies,
        "SPHERE_FOOT": spheres.foot,
        "SPHERE_ALONE": spheres.own_friction.astype(int),
        "SPHERE_SLIPPERY": spheres.slippery.astype(int),
        "LIMIT_QPOS": _some(limits.qpos),
        "LIMIT_DOF": _some(limits.dof),
        "ACTUATOR_DOF": _some(model.jnt_dofadr[driven] + np.maximum(spin, 0), -1),
        "ACTUATOR_QPOS": _some(model.jnt_qposadr[driven]),
        "ACTUATOR_SPIN": _some(spin, -1),
    }
    values = _values(robot)
    source = native.preamble(numbers, floats, tables, values)
    return RobotProgram(source, np.concatenate([np.ravel(x) for x in values.values()]).astype(np.float32))


def _values(robot: RobotModel) -> dict[str, Any]:
    """The numbers of `Robot` in C++, in its order."""
    model, spheres, limits = robot.model, robot.physics.spheres, robot.physics.limits
    inertia, frame = np.zeros((model.nbody, 6)), np.zeros(9)
    for b in range(model.nbody):
        mujoco.mju_quat2Mat(frame, model.body_iquat[b])
        axes = frame.reshape(3, 3)
        full = axes @ np.diag(model.body_inertia[b]) @ axes.T
        inertia[b] = full[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    place, axis, zero = np.zeros((model.nbody, 3)), np.zeros((model.nbody, 3)), np.zeros(model.nbody)
    place[model.jnt_bodyid], axis[model.jnt_bodyid] = model.jnt_pos, model.jnt_axis
    zero[model.jnt_bodyid] = model.qpos0[model.jnt_qposadr]
    unlimited = np.array([-3e38, 3e38])
    affine = model.actuator_biastype == mujoco.mjtBias.mjBIAS_AFFINE
    sloped = model.actuator_gaintype == mujoco.mjtGain.mjGAIN_AFFINE
    balls = model.jnt_type[model.actuator_trnid[:, 0]] == mujoco.mjtJoint.mjJNT_BALL
    gear = np.where(balls, model.actuator_gear[:, :3].sum(1), model.actuator_gear[:, 0])
    return {
        "body_pos": model.body_pos,
        "body_quat": model.body_quat,
        "body_centre": model.body_ipos,
        "body_inertia": inertia,
        "body_mass": model.body_mass,
        "total_mass": model.body_mass.sum(),
        "joint_pos": place,
        "joint_axis": axis,
        "joint_zero": zero,
        "damping": model.dof_damping,
        "armature": model.dof_armature,
        "sphere_pos": model.geom_pos[robot.sphere_geom],
        "sphere_radius": spheres.radius,
        "sphere_friction": spheres.friction,
        "sphere_solref": spheres.solref,
        "sphere_solimp": spheres.solimp,
        "sphere_weight": spheres.invweight,
        "limit_range": _some(limits.range),
        "limit_solref": _some(limits.solref),
        "limit_solimp": _some(limits.solimp),
        "limit_weight": _some(limits.invweight),
        "gain": _some(model.actuator_gainprm[:, 0]),
        "gain_slope": _some(np.where(sloped[:, None], model.actuator_gainprm[:, 1:3], 0.0)),
        "bias": _some(np.where(affine[:, None], model.actuator_biasprm[:, :3], 0.0)),
        "gear": _some(gear),
        "ctrl_range": _some(np.where(model.actuator_ctrllimited[:, None], model.actuator_ctrlrange, unlimited)),
        "force_range": _some(np.where(model.actuator_forcelimited[:, None], model.actuator_forcerange, unlimited)),
        "gravity": model.opt.gravity,
        "timestep": model.opt.timestep,
        "tolerance": max(model.opt.tolerance, _LEAST_TOLERANCE),
        "scale": 1.0 / (model.stat.meaninertia * max(model.nv, 1)),
    }


def _above(model: mujoco.MjModel, dof: int) -> list[int]:
    """The velocities between a velocity and the root, from there on."""
    out, parent = [], int(model.dof_parentid[dof])
    while parent >= 0:
        out.append(parent)
        parent = int(model.dof_parentid[parent])
    return out[::-1]


def _mask(model: mujoco.MjModel, above: list[list[int]], body: int) -> int:
    """One bit for each velocity that moves a body."""
    while body > 0 and model.body_dofnum[body] == 0:
        body = model.body_parentid[body]
    if body == 0:
        return 0
    last = int(model.body_dofadr[body] + model.body_dofnum[body] - 1)
    return sum(1 << i for i in (*above[last], last))


def _padded(lists: list[list[int]]) -> np.ndarray:
    out = np.zeros((len(lists), max(1, *map(len, lists))), int)
    for row, values in zip(out, lists, strict=True):
        row[: len(values)] = values
    return out


def _some(array: Any, empty: float = 0) -> np.ndarray:
    """The array, with one row where it has none: C++ knows no arrays of length 0."""
    array = np.asarray(array)
    return array if len(array) else np.full((1, *array.shape[1:]), empty, array.dtype)
