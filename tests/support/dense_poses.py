"""Poses of a robot with the most hulls and prisms in its reach, and its contacts there in C MuJoCo and both engines.

Contacts are tables (n, 3): pose, sphere (row of the engine's table) and distance (m, negative), sorted.
"""

from collections.abc import Sequence
from typing import Any

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import warp as wp

from urbanverse_mjx.datatypes import RobotSpec, SceneBank, traversable
from urbanverse_mjx.geometry import rotations
from urbanverse_mjx.simulation.collision_slots import static_slots
from urbanverse_mjx.simulation.parity.drives import ground_height
from urbanverse_mjx.simulation.warp_engine import contact, kernels
from urbanverse_mjx.simulation.warp_engine.batch import WorldBatch
from urbanverse_mjx.simulation.warp_engine.model import DeviceModel

#: m: a robot deeper in an object than this did not get there by driving.
DEEPEST = 0.02
#: m: below this what one side calls a touch may be none on the other.
TOUCH = 2e-5
#: Physics steps in which a robot settles from 1 cm above the ground around it.
_FALL = 40


def densest_places(bank: SceneBank, reach: float, number: int, spacing: int = 2) -> tuple[np.ndarray, np.ndarray]:
    """Scenes (n,) and places (n, 2) m with the most boxes of hulls and prisms within reach, seen from above.

    Args:
      spacing: every so many cells of the map along each axis are looked at.
    """
    tables, scenes, places, counts = static_slots.instance_tables(bank), [], [], []
    for scene in range(bank.num_scenes):
        cells = np.argwhere(traversable(bank.map_kind[scene])[::spacing, ::spacing]) * spacing
        xy = bank.map_origin[scene] + (cells + 0.5) * float(bank.map_resolution)
        count = np.zeros(len(xy), int)
        for table in (jax.device_get(t) for t in tables):
            for q in range(table.hull.shape[1]):
                if table.hull[scene, q] < 0:
                    continue
                half, turn = table.box_half[scene, q, :2], table.rotation[scene, q, :2, :2]
                offset = xy - table.box_centre[scene, q, :2]
                rows = np.flatnonzero((np.abs(offset) <= reach + np.linalg.norm(half)).all(1))
                out = np.maximum(np.abs(offset[rows] @ turn) - half, 0.0)
                count[rows] += np.linalg.norm(out, axis=1) <= reach
        first = np.argsort(-count, kind="stable")[:number]
        scenes.append(np.full(len(first), scene, np.int32))
        places.append(xy[first])
        counts.append(count[first])
    first = np.argsort(-np.concatenate(counts), kind="stable")[:number]
    return np.concatenate(scenes)[first], np.concatenate(places)[first]


def settled(
    bank: SceneBank,
    robot: RobotSpec,
    models: Sequence[mujoco.MjModel],
    scene: np.ndarray,
    place: np.ndarray,
    posture: Sequence[float] = (),
) -> tuple[np.ndarray, np.ndarray]:
    """Robots at any yaw, let go just above the ground and come to rest in C MuJoCo.

    Args:
      posture: rad, joint angles that the actuators hold; none where they are motors.

    Returns:
      Their qpos (n, nq) f32, and (n,) bool: whether none of their spheres is deep in an object.
    """
    rng = np.random.default_rng(0)
    around = place[:, None] + robot.planner_radius * np.array([[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1]])
    qpos, free = np.zeros((len(scene), models[0].nq), np.float32), np.zeros(len(scene), bool)
    for z in np.unique(scene):
        mine = np.flatnonzero(scene == z)
        ground = ground_height(bank, int(z), around[mine].reshape(-1, 2)).reshape(-1, 5)
        model, height = models[z], np.nanmax(ground, axis=1) + robot.spawn_height + 0.01
        data = mujoco.MjData(model)
        own = np.array([model.geom(g).name.startswith("robot/") for g in range(model.ngeom)])
        solid = np.array([model.geom(g).name.startswith("ground/") for g in range(model.ngeom)]) | own
        for i, z0 in zip(mine, height, strict=True):
            mujoco.mj_resetData(model, data)
            data.qpos[:3] = *place[i], z0
            data.qpos[3:7] = rotations.from_yaw(rng.uniform(-np.pi, np.pi))
            if len(posture):
                data.qpos[7:], data.ctrl[:] = posture, posture
            mujoco.mj_forward(model, data)
            free[i] = _deepest(data, solid) > -DEEPEST
            for _ in range(_FALL * free[i]):
                mujoco.mj_step(model, data)
            free[i] &= _deepest(data, solid) > -DEEPEST and bool(np.isfinite(data.qpos).all())
            qpos[i] = data.qpos
    return qpos, free


def _deepest(data: mujoco.MjData, solid: np.ndarray) -> float:
    """m, the distance of the robot from the object that it is deepest in."""
    found = data.contact
    return min(found.dist[~solid[found.geom].all(1)], default=0.0) if data.ncon else 0.0


def in_c_mujoco(
    models: Sequence[mujoco.MjModel], spheres: Sequence[str], scene: np.ndarray, qpos: np.ndarray
) -> np.ndarray:
    """The contacts that C MuJoCo finds among all hulls; spheres: names in the order of the engine's table."""
    rows = []
    for z in np.unique(scene):
        model, data = models[z], mujoco.MjData(models[z])
        number = {int(model.geom(f"robot/{name}").id): s for s, name in enumerate(spheres)}
        for i in np.flatnonzero(scene == z):
            data.qpos[:] = qpos[i]
            mujoco.mj_fwdPosition(model, data)
            for pair, distance in zip(data.contact.geom, data.contact.dist, strict=True):
                rows += [(i, number[int(g)], distance) for g in pair if int(g) in number and distance < 0]
    return _sorted(np.array(rows))


def in_jax_engine(engine: Any, scene: np.ndarray, qpos: np.ndarray) -> tuple[np.ndarray, int]:
    """The contacts that `JaxEngine` finds, and how many slots and contacts it misses."""

    @jax.jit
    @jax.vmap
    def find(scene: Any, centre: Any, balls: Any, origin: Any) -> Any:
        nearby, missing = engine.find_slots(scene, centre)
        nearby, radii = nearby._replace(position=nearby.position - origin), jnp.asarray(engine.physics.spheres.radius)
        found = engine.find_contacts(balls, radii.astype(jnp.float32), nearby)
        return found.sphere, found.distance, missing + found.missed

    spheres, distance, missed = (np.array(x) for x in find(scene, *_spheres(engine, qpos)))
    i, k = np.nonzero(distance < 0)
    return _sorted(np.column_stack([i, spheres[i, k], distance[i, k]])), int(missed.max())


def in_warp_engine(engine: Any, scene: np.ndarray, qpos: np.ndarray) -> tuple[np.ndarray, int]:
    """As `in_jax_engine` of `WarpEngine`."""
    n, room = len(scene), engine.num_contacts
    centre, balls, _ = _spheres(engine, qpos)
    with wp.ScopedDevice("cpu"):
        shared = DeviceModel(engine.bank, engine._robot_model, engine.reach)
        batch = WorldBatch(shared, n, engine.num_slots, engine.num_prism_slots, room, 0, graphs=False, agents=None)
        where = [shared.tables, wp.array(scene, dtype=int), wp.array(centre, dtype=wp.vec3), engine.num_slots]
        wp.launch(kernels.find_slots, dim=(n, 2), inputs=[*where, engine.num_prism_slots, batch.nearby, batch.nothing])
        wp.launch(kernels.place_slots, dim=batch.slots.hull.shape, inputs=[*where, batch.nearby, batch.slots])
        geoms = engine._robot_model.sphere_geom
        xpos = np.zeros((n, engine._robot_model.model.ngeom, 3), np.float32)
        xpos[:, geoms] = balls
        inputs = [shared.hulls, shared.spheres, batch.slots, wp.array(xpos, dtype=wp.vec3), batch.places]
        wp.launch(contact.find_contacts, dim=batch.slots.hull.shape, inputs=inputs)
        count, missing = batch.places.count.numpy(), batch.nearby.missing.numpy().sum(1)
        geom = batch.places.geom.numpy()[:, 0].reshape(n, room)
        distance = batch.places.dist.numpy().reshape(n, room)
    i, k = np.nonzero(np.arange(room) < count[:, None])
    sphere = np.searchsorted(geoms, geom[i, k])
    missed = int((missing + np.maximum(count - room, 0)).max())
    return _sorted(np.column_stack([i, sphere, distance[i, k]])), missed


def _spheres(engine: Any, qpos: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The robots' centres (n, 3), their spheres (n, S, 3) about whole metres, and these (n, 3)."""
    model = engine.physics.model
    data, centre, balls = mujoco.MjData(model), [], []
    for row in qpos:
        data.qpos[:] = row
        mujoco.mj_kinematics(model, data)
        centre.append(data.xpos[engine.physics.root].copy())
        balls.append(data.geom_xpos[engine.physics.spheres.geom].copy())
    centre = np.array(centre)
    origin = np.round(centre) * [1.0, 1.0, 0.0]
    parts = centre, np.array(balls) - origin[:, None], origin
    return tuple(x.astype(np.float32) for x in parts)  # pyright: ignore[reportReturnType]


def _sorted(rows: np.ndarray) -> np.ndarray:
    """Touches deeper than `TOUCH`, by pose, sphere and depth."""
    rows = rows.reshape(-1, 3)
    return rows[np.lexsort(rows.T[::-1])]
