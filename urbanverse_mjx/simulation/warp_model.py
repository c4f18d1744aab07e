"""The physics model of the Warp engine: the robot's spheres and slots for hulls, over a library of all hulls of a bank.

In:   `SceneBank`, `RobotSpec`.
Out:  `WarpModel`: MuJoCo's model, MuJoCo Warp's model and the bank's tables on one Warp device.
When: once per device.

A slot is a mesh geom fixed to the world. MuJoCo Warp places such geoms once, in `make_data`; which hull one is, and
where, is decided per world by writing what the collision reads: pose, mesh, size and bounds.
"""

import dataclasses
from typing import Any

import jax
import mujoco
import mujoco_warp as mjw
import numpy as np
import warp as wp

from ..datatypes import SceneBank
from . import slots
from . import warp_kernels as kernels
from .physics_model import PhysicsModel, _bare

#: Bits by which robot and slots meet, and neither meets its own kind.
_SLOT, _ROBOT = 1, 0


@dataclasses.dataclass(frozen=True)
class SlotModel:
    """A robot among slots.

    Attributes:
      model: MuJoCo's model; its first geoms are the slots.
      num_objects, num_prisms: slots of either kind, objects first.
      is_foot: (ngeom,) i32.
      root: address in qpos of the robot's place.
      objects, prisms: the bank's instances, numpy.
    """

    model: mujoco.MjModel
    num_objects: int
    num_prisms: int
    is_foot: np.ndarray
    root: int
    objects: slots.InstanceTable
    prisms: slots.InstanceTable

    @property
    def num_slots(self) -> int:
        return self.num_objects + self.num_prisms


def build_slot_model(
    bank: SceneBank, physics: PhysicsModel, num_objects: int, num_prisms: int, iterations: int, line_steps: int
) -> SlotModel:
    """Compiles the robot with all hulls of the bank as meshes and the slots as geoms."""
    robot = physics.spec
    spec = _bare(mujoco.MjSpec.from_string(robot.mjcf))
    for geom in spec.geoms:
        geom.contype, geom.conaffinity = _ROBOT, _SLOT
    for t, (vertices, faces) in enumerate(zip(bank.hull_num_vertices, bank.hull_num_triangles, strict=True)):
        spec.add_mesh(
            name=f"hull_{t}",
            uservert=bank.hull_vertices[t, :vertices].ravel().tolist(),
            userface=bank.hull_triangles[t, :faces].ravel().tolist(),
            inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX,
        )
    for slot in range(num_objects + num_prisms):
        spec.worldbody.add_geom(
            name=f"slot_{slot}",
            type=mujoco.mjtGeom.mjGEOM_MESH,
            meshname="hull_0",
            contype=_SLOT,
            conaffinity=_ROBOT,
        )
    spec.option.iterations, spec.option.ls_iterations = iterations, line_steps
    model = spec.compile()
    names = [model.geom(g).name for g in range(model.ngeom)]
    first = int(model.jnt_qposadr[model.body_jntadr[model.body(robot.root_body).id]])
    is_foot = np.array([name in robot.foot_geoms for name in names], np.int32)
    tables = jax.device_get(slots.instance_tables(bank))
    return SlotModel(model, num_objects, num_prisms, is_foot, first, *tables)


def _instances(table: slots.InstanceTable) -> Any:
    out = kernels.Instances()
    for name in ("hull", "owner", "grid"):
        setattr(out, name, wp.array(getattr(table, name), dtype=int))
    for name in ("position", "box_centre", "box_half"):
        setattr(out, name, wp.array(getattr(table, name), dtype=wp.vec3))
    out.rotation = wp.array(table.rotation, dtype=wp.mat33)
    out.friction = wp.array(table.friction, dtype=float)
    return out


class DeviceModel:
    """MuJoCo Warp's model and the bank's tables on the current Warp device, shared by batches of all sizes."""

    def __init__(self, bank: SceneBank, slot_model: SlotModel, reach: float) -> None:
        self.slot_model = slot_model
        model = slot_model.model
        self.device = wp.get_device()
        self.model = mjw.put_model(model)
        # Overflows are reported as `slot_overflow`.
        self.model.opt.warn_overflow = 0
        self.is_foot = wp.array(slot_model.is_foot, dtype=int)
        self.tables = self._tables(bank, model, reach)

    def _tables(self, bank: SceneBank, model: mujoco.MjModel, reach: float) -> Any:
        start, number = model.mesh_vertadr, model.mesh_vertnum
        corners = [model.mesh_vert[s : s + n] for s, n in zip(start, number, strict=True)]
        low, high = np.array([c.min(0) for c in corners]), np.array([c.max(0) for c in corners])
        turn = np.zeros((model.nmesh, 9))
        for mesh in range(model.nmesh):
            mujoco.mju_quat2Mat(turn[mesh], model.mesh_quat[mesh])
        tables = kernels.Tables()
        tables.objects, tables.prisms = _instances(self.slot_model.objects), _instances(self.slot_model.prisms)
        tables.origin = wp.array(bank.grid_origin, dtype=wp.vec2)
        tables.cell, tables.reach = float(bank.grid_cell), reach
        tables.offset = wp.array(model.mesh_pos, dtype=wp.vec3)
        tables.turn = wp.array(turn.reshape(-1, 3, 3), dtype=wp.mat33)
        tables.centre = wp.array((low + high) / 2, dtype=wp.vec3)
        tables.half = wp.array((high - low) / 2, dtype=wp.vec3)
        tables.radius = wp.array([float(np.linalg.norm(c, axis=1).max()) for c in corners], dtype=float)
        return tables

    def per_world(self, number: int) -> Any:
        """The model with the fields of its own that each of `number` worlds needs to hold its own hulls."""
        model = self.slot_model.model

        def own(values: np.ndarray, dtype: Any, rows: int = number) -> wp.array:
            return wp.array(np.repeat(values[None], rows, axis=0), dtype=dtype)

        return dataclasses.replace(
            self.model,
            # Absent meshes are looked for only where there is more than one row.
            geom_dataid=own(model.geom_dataid, int, max(number, 2)),
            geom_size=own(model.geom_size, wp.vec3),
            geom_aabb=own(model.geom_aabb.reshape(-1, 2, 3), wp.vec3),
            geom_rbound=own(model.geom_rbound, float),
            geom_friction=own(model.geom_friction, wp.vec3),
        )
