"""Device data of the Warp engine: the robot for MuJoCo Warp, its spheres, the bank's hulls and scenes.

In:   `SceneBank`, `PhysicsModel`.
Out:  `RobotModel` on the host, once; `DeviceModel` once per Warp device, shared by batches of all sizes.
When: at construction, and when a device is first used.
"""

import dataclasses
import weakref
from typing import Any

import mujoco
import mujoco_warp as mjw
import numpy as np
import warp as wp

from ...datatypes import PlacedBank, SceneBank
from ...datatypes import validation as v
from ..collision_slots import static_slots
from ..collision_slots.body_table import BodyTable
from ..collision_slots.hull_contact import planes_and_edges
from ..physics_model import PhysicsModel, bare_robot
from . import body_types, contact, kernels
from .mujoco_warp_private import vec5  # pyright: ignore[reportAttributeAccessIssue] (its package is untyped)
from .places import PlacedHulls, empty_instances

#: Largest number of velocities of MuJoCo Warp's dense solver; up to 32 it factorises in one block, which is faster.
MAX_VELOCITIES = 60


@dataclasses.dataclass(frozen=True)
class RobotModel:
    """The robot and one geom of the world, to which contacts with hulls belong. No geom collides by itself.

    Attributes:
      model: MuJoCo's model.
      physics: what is known of the spheres, whose numbers in `model` are sphere_geom (S,).
      ground: number of the world's geom.
      root: address in qpos of the robot's place.
      bodies: the free bodies that movable objects take turns in, behind the robot's own; None where there are none.
    """

    model: mujoco.MjModel
    physics: PhysicsModel
    sphere_geom: np.ndarray
    ground: int
    root: int
    bodies: "FreeBodies | None" = None


@dataclasses.dataclass(frozen=True)
class FreeBodies:
    """W free bodies in the robot's model, each with a geom; their first addresses, and what they may be."""

    number: int
    qpos: int
    dof: int
    body: int
    geom: int
    table: BodyTable


def _add_free_bodies(spec: mujoco.MjSpec, number: int) -> None:
    """Bodies whose frames are their principal axes; mass and inertia are data of each world."""
    for b in range(number):
        body = spec.worldbody.add_body(name=f"movable/{b}", mass=1.0, inertia=[1.0, 1.0, 1.0], explicitinertial=True)
        body.add_freejoint(name=f"movable/{b}")
        size = [0.01, 0.0, 0.0]
        body.add_geom(name=f"movable/{b}", type=mujoco.mjtGeom.mjGEOM_SPHERE, size=size, contype=0, conaffinity=0)


def build_robot_model(
    physics: PhysicsModel,
    iterations: int,
    line_steps: int,
    awake: int = 0,
    table: BodyTable | None = None,
) -> RobotModel:
    """Compiles the robot for MuJoCo Warp.

    Args:
      awake: free bodies beside it.
      table: the objects that they may be.

    Raises:
      ValidationError: it has activations, equalities, tendons or mocap bodies, whose state the engine does not carry,
        or more velocities than the solver takes.
    """
    spec = bare_robot(mujoco.MjSpec.from_string(physics.spec.mjcf))
    for geom in spec.geoms:
        geom.contype = geom.conaffinity = 0
    size = [0.01, 0.0, 0.0]
    spec.worldbody.add_geom(name="hulls", type=mujoco.mjtGeom.mjGEOM_SPHERE, size=size, contype=0, conaffinity=0)
    _add_free_bodies(spec, awake)
    # By default MuJoCo Warp uses sparse rows above 32 velocities, for which it allocates no memory here because it does
    # not know of these contacts; everything would fall through the ground.
    spec.option.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    spec.option.iterations, spec.option.ls_iterations = iterations, line_steps
    model = spec.compile()
    if model.nv > MAX_VELOCITIES:
        found = f"{model.nv} velocities of the robot and {awake} bodies"
        raise v.fail("engine.movable.awake", found, f"at most {MAX_VELOCITIES}", "let fewer be awake at once")
    for name, what in (
        ("na", "activations"),
        ("neq", "equalities"),
        ("ntendon", "tendons"),
        ("nmocap", "mocap bodies"),
    ):
        if getattr(model, name):
            raise v.fail(
                f"robot {physics.spec.name!r}.mjcf", f"{getattr(model, name)} {what}", "none", "use impl='jax'"
            )
    geoms = np.array([model.geom(name).id for name in physics.spheres.name])
    first = int(model.jnt_qposadr[model.body_jntadr[physics.root]])
    bodies = None
    if awake and table is not None:
        joint = model.joint("movable/0")
        body, geom = int(model.body("movable/0").id), int(model.geom("movable/0").id)
        bodies = FreeBodies(awake, int(joint.qposadr[0]), int(joint.dofadr[0]), body, geom, table)
    return RobotModel(model, physics, geoms, int(model.geom("hulls").id), first, bodies)


class DeviceModel:
    """MuJoCo Warp's model and the bank's tables on the current Warp device."""

    def __init__(self, bank: SceneBank, robot: RobotModel, reach: float, materials: bool = False) -> None:
        self.robot, self.materials = robot, materials
        self.device = wp.get_device()
        self.model = mjw.put_model(robot.model)
        # Contacts that find no place are counted by `contact`, and become `slot_overflow`.
        self.model.opt.warn_overflow = 0
        foot_of = np.full(robot.model.ngeom, -1, np.int32)
        foot_of[robot.sphere_geom] = robot.physics.spheres.foot
        self.foot_of = wp.array(foot_of, dtype=int)
        self.num_feet = len(robot.physics.spec.foot_geoms)
        self.masses = kernels.Robot()
        self.masses.mass = wp.array(robot.model.body_mass, dtype=float)
        self.masses.inertia = wp.array(robot.model.body_inertia, dtype=wp.vec3)
        self.masses.subtree = wp.array(robot.model.body_subtreemass, dtype=float)
        self.spheres = _spheres(robot)
        #: Hulls of places whose scenes change; None where those of the bank stay.
        self.placed: PlacedHulls | None = None
        self.tables = kernels.Tables()
        instances = static_slots.instance_tables(bank, materials)
        if isinstance(bank, PlacedBank):
            self.placed = PlacedHulls(bank)
            instances = tuple(map(empty_instances, instances))
        else:
            self._own_hulls = _kept_hulls(bank, str(self.device))
        self.tables.objects, self.tables.prisms = map(_instances, instances)
        self.tables.origin = wp.array(bank.grid_origin, dtype=wp.vec2)
        self.tables.cell, self.tables.reach = float(bank.grid_cell), reach
        self.body_table = None if robot.bodies is None else _body_table(robot.bodies.table)

    @property
    def hulls(self) -> Any:
        """`contact.Hulls` of all scenes."""
        return self._own_hulls if self.placed is None else self.placed.hulls


def _spheres(robot: RobotModel) -> Any:
    table, out = robot.physics.spheres, contact.Spheres()
    out.geom = wp.array(robot.sphere_geom, dtype=int)
    for name in ("radius", "friction"):
        setattr(out, name, wp.array(getattr(table, name), dtype=float))
    for name in ("own_friction", "slippery"):
        setattr(out, name, wp.array(getattr(table, name).astype(np.int32), dtype=int))
    out.solref, out.solimp = wp.array(table.solref, dtype=wp.vec2), wp.array(table.solimp, dtype=vec5)
    return out


#: Name of the device, and arrays of a bank by their numbers in memory -> its hulls there. Engines of several robots in
#: the same streets share them: those of 160 streets take three seconds.
_HULLS: dict[tuple[Any, ...], Any] = {}


def _kept_hulls(bank: SceneBank, device: str) -> Any:
    """`_hulls`, kept as long as the bank's arrays; called by one thread at a time for each device."""
    arrays = (bank.hull_vertices, bank.hull_triangles, bank.hull_num_triangles, bank.hull_planes, bank.hull_box)
    key = device, *map(id, arrays)
    if key not in _HULLS:
        _HULLS[key] = _hulls(bank)
        for array in arrays:
            weakref.finalize(array, _HULLS.pop, key, None)
    return _HULLS[key]


def _hulls(bank: SceneBank) -> Any:
    parts = [
        planes_and_edges(bank.hull_vertices[t], bank.hull_triangles[t, :n], bank.hull_planes[t, :n])
        for t, n in enumerate(bank.hull_num_triangles)
    ]
    planes, edges = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
    starts = [np.concatenate([[0], np.cumsum([len(part[i]) for part in parts])]) for i in range(2)]
    out = contact.Hulls()
    out.plane_start, out.edge_start = (wp.array(start, dtype=int) for start in starts)
    out.normal, out.offset = wp.array(planes[:, :3], dtype=wp.vec3), wp.array(planes[:, 3], dtype=float)
    out.start, out.edge = wp.array(edges[:, :3], dtype=wp.vec3), wp.array(edges[:, 3:], dtype=wp.vec3)
    out.centre, out.half = (wp.array(bank.hull_box[:, i], dtype=wp.vec3) for i in range(2))
    return out


def _body_table(table: BodyTable) -> Any:
    out = body_types.BodyTable()

    def filled(array: np.ndarray) -> np.ndarray:
        return array if len(array) else np.zeros((1, *array.shape[1:]), array.dtype)

    for name in ("shape", "hull"):
        setattr(out, name, wp.array(filled(getattr(table, name)), dtype=int))
    for name in ("mass", "friction", "radius"):
        setattr(out, name, wp.array(filled(getattr(table, name)), dtype=float))
    for name in ("centre", "inertia", "points"):
        setattr(out, name, wp.array(filled(getattr(table, name)), dtype=wp.vec3))
    turn = np.zeros((max(len(table.axes), 1), 4))
    for quaternion, axes in zip(turn, table.axes, strict=False):
        mujoco.mju_mat2Quat(quaternion, axes.ravel())
    out.turn = wp.array(turn, dtype=wp.vec4)
    return out


def _instances(table: static_slots.InstanceTable) -> Any:
    out = kernels.Instances()
    for name in ("hull", "owner", "grid"):
        setattr(out, name, wp.array(getattr(table, name), dtype=int))
    for name in ("position", "box_centre", "box_half"):
        setattr(out, name, wp.array(getattr(table, name), dtype=wp.vec3))
    out.rotation = wp.array(table.rotation, dtype=wp.mat33)
    out.friction = wp.array(table.friction, dtype=float)
    return out
