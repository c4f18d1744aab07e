"""Static slots: the hulls and ground prisms near the robot, selected every control step.

In: the bank's instances of one scene, a position. Out: `Slots`, a fixed number of hulls with their poses, and the
number of hulls within reach without a slot. When: once per control step, per env, inside jit.

Hulls are ranked by the distance from the robot's centre to their oriented box. With bounding spheres, long slabs would
displace small posts, and the robot would drive through these (docs/sources/measured.md).
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ...datatypes import SceneBank


class InstanceTable(NamedTuple):
    """Instances of hulls in all scenes, leading axes (scene, instance); see `SceneBank` for the meaning."""

    hull: Any
    owner: Any
    position: Any
    rotation: Any
    friction: Any
    box_centre: Any
    box_half: Any
    grid: Any


class Slots(NamedTuple):
    """C hulls near one robot.

    Attributes:
      hull: (C,) i32, row of the hull table (0 where empty).
      owner: (C,) i32, object number; -1 = ground.
      valid: (C,) bool.
      position: (C, 3) m, rotation: (C, 3, 3): T_world_hull.
      friction: (C,).
    """

    hull: Any
    owner: Any
    valid: Any
    position: Any
    rotation: Any
    friction: Any


def instance_tables(bank: SceneBank, materials: bool = False) -> tuple[InstanceTable, InstanceTable]:
    """The objects' hulls and the ground prisms of a bank as NumPy arrays, i32 and f32, without copies where possible;
    materials: whether the ground has the friction of its materials.

    The grids are the largest part of a large bank; engines copy them to the device and do not keep these arrays.
    """

    def table(hull: Any, owner: Any, position: Any, rotation: Any, friction: Any, grid: Any) -> InstanceTable:
        box = bank.hull_box[np.maximum(hull, 0)]
        centre = position + np.einsum("zqij,zqj->zqi", rotation, box[:, :, 0])
        arrays = (hull, owner, position, rotation, friction, centre, box[:, :, 1], grid)
        return InstanceTable(*(np.asarray(a, np.int32 if a.dtype.kind == "i" else np.float32) for a in arrays))

    eye = np.broadcast_to(np.eye(3, dtype=np.float32), (*bank.prism_hull.shape, 3, 3))
    ground = np.full_like(bank.prism_hull, -1)
    slide = bank.prism_material_friction if materials else bank.prism_friction
    return (
        table(
            bank.inst_hull, bank.inst_object, bank.inst_position, bank.inst_rotation, bank.inst_friction, bank.hull_grid
        ),
        table(bank.prism_hull, ground, bank.prism_position, eye, slide, bank.prism_grid),
    )


def both_surfaces(least: bool, own: Any, other: Any) -> Any:
    """Friction of two surfaces in contact: the larger coefficient, as in MuJoCo, or the smaller (least)."""
    return jnp.minimum(own, other) if least else jnp.maximum(own, other)


def box_distance(point: Any, centre: Any, rotation: Any, half: Any) -> Any:
    """Distance (m) from a point (3,) to oriented boxes (n,); 0 inside."""
    local = jnp.einsum("nij,ni->nj", rotation, point - centre)
    return jnp.linalg.norm(jnp.maximum(jnp.abs(local) - half, 0.0), axis=-1)


def nearest(
    table: InstanceTable, cell: Any, scene: Any, centre: Any, reach: Any, number: int, taken: Any = None
) -> tuple[Slots, Any]:
    """The `number` hulls nearest to `centre` (3,) among those of a grid cell.

    Args:
      cell: (2,) i32 within the grid.
      scene: () i32.
      reach: m; hulls farther away leave their slot empty.
      taken: (M,) i32, objects that are bodies, whose hulls are skipped; None for none.

    Returns:
      The slots and () i32, how many hulls within reach found none.
    """
    listed = table.grid[scene, cell[0], cell[1]]
    if listed.shape[0] < number:
        listed = jnp.pad(listed, (0, number - listed.shape[0]), constant_values=-1)
    row = jnp.maximum(listed, 0)
    distance = box_distance(
        centre, table.box_centre[scene, row], table.rotation[scene, row], table.box_half[scene, row]
    )
    distance = jnp.where(listed >= 0, distance, jnp.inf)
    if taken is not None:
        owner = table.owner[scene, row]
        gone = ((owner[:, None] == taken) & (taken >= 0)).any(-1)
        distance = jnp.where(gone, jnp.inf, distance)
    found = jnp.sum(distance <= reach)
    negative, order = jax.lax.top_k(-distance, number)
    row, valid = row[order], -negative <= reach
    slots = Slots(
        hull=jnp.maximum(table.hull[scene, row], 0),
        owner=table.owner[scene, row],
        valid=valid,
        position=table.position[scene, row],
        rotation=table.rotation[scene, row],
        friction=table.friction[scene, row],
    )
    return slots, jnp.maximum(found - number, 0).astype(jnp.int32)


def join(first: Slots, second: Slots) -> Slots:
    """Both groups of slots one after the other."""
    return Slots(*(jnp.concatenate([a, b]) for a, b in zip(first, second, strict=True)))


def grid_cell(origin: Any, size: Any, shape: tuple[int, int], point: Any) -> Any:
    """(2,) i32: the cell that holds a point (3,); the nearest one for a point outside, the first for a NaN."""
    cell = jnp.floor((point[:2] - origin) / size)
    cell = jnp.clip(jnp.where(jnp.isfinite(cell), cell, 0.0), 0.0, jnp.array(shape, jnp.float32) - 1.0)
    return cell.astype(jnp.int32)
