"""Streets with a few movable objects in them, and drives into those in C MuJoCo and in an engine."""

import dataclasses
from collections.abc import Sequence
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import mujoco
import numpy as np

from tests.support.box_bank import KERB, box_scene, box_skies
from urbanverse_mjx.datatypes import RobotSpec, SceneBank
from urbanverse_mjx.geometry import rotations
from urbanverse_mjx.scene.bank import pack
from urbanverse_mjx.scene.geometry import SceneGeometry
from urbanverse_mjx.scene.mjcf import scene_mjcf
from urbanverse_mjx.simulation.engines import make_engine
from urbanverse_mjx.simulation.parity import c_mujoco

CONTROL_DT = 0.2
#: Where the robot starts, on a sidewalk, looking along x.
START = np.array([20.0, 6.0, KERB])


class MovableObject(NamedTuple):
    """A movable object: hulls (n, 3) each, place relative to `START` (m), yaw (rad), mass (kg), friction."""

    hulls: Sequence[np.ndarray]
    place: tuple[float, float, float]
    yaw: float = 0.0
    mass: float = 10.0
    friction: float = 0.6


class Push(NamedTuple):
    """Result of a drive of T control steps with M objects: robot (T, 7); places (T, M, 3), quaternions (T, M, 4) of the
    objects' frames, hit (T,) bool, object (T,) i32, the object that was hit, -1 = none."""

    robot: np.ndarray
    places: np.ndarray
    quaternions: np.ndarray
    hit: np.ndarray
    obj: np.ndarray


def box(length: float, width: float, height: float) -> np.ndarray:
    """(8, 3) m corners of a box that stands on its frame's origin."""
    unit = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (0.0, 1.0)], np.float32)
    return unit * np.array([length, width, height], np.float32)


def hulls_of(bank: SceneBank, category: str) -> tuple[list[np.ndarray], float, float]:
    """Hulls, mass and friction of the first movable object of a category in a bank."""
    wanted = bank.meta["categories"].index(category)
    z, slot = np.argwhere((bank.slot_category == wanted) & (bank.slot_movable > 0))[0]
    rows = np.flatnonzero(bank.inst_object[z] == slot)
    found = [bank.hull_vertices[t, : bank.hull_num_vertices[t]] for t in bank.inst_hull[z, rows]]
    return found, float(bank.slot_mass[z, slot]), float(bank.inst_friction[z, rows[0]])


def object_scene(objects: Sequence[MovableObject]) -> SceneGeometry:
    """A box street with these objects only."""
    base = box_scene(0, 0, 1)
    first = len(base.hulls) - len(base.prism_hull)
    hulls = [np.asarray(h, np.float32) for t in objects for h in t.hulls]
    count = len(objects)
    order = np.argsort([t.place[0] for t in objects], kind="stable")
    assert (order == np.arange(count)).all(), "objects in the order of x"
    yaw = np.array([t.yaw for t in objects])
    return dataclasses.replace(
        base,
        object_ids=tuple(f"thing_{i}" for i in range(count)),
        object_categories=("box",) * count,
        object_position=START + np.array([t.place for t in objects]),
        object_quaternion=rotations.from_yaw(yaw),
        object_mesh=np.zeros(count, np.int32),
        object_mass=np.array([t.mass for t in objects]),
        object_friction=np.array([t.friction for t in objects]),
        object_movable=np.ones(count, bool),
        hulls=(*hulls, *base.hulls[first:]),
        inst_hull=np.arange(len(hulls), dtype=np.int32),
        inst_object=np.repeat(np.arange(count), [len(t.hulls) for t in objects]).astype(np.int32),
        prism_hull=base.prism_hull - first + len(hulls),
    )


def first_qpos(robot: RobotSpec, size: int) -> np.ndarray:
    qpos = np.zeros(size)
    qpos[:4] = *START[:2], START[2] + robot.spawn_height, 1.0
    return qpos


def object_bank(scene: SceneGeometry) -> SceneBank:
    return pack([scene], ["train"], box_skies())


def push_reference(scene: SceneGeometry, robot: RobotSpec, commands: np.ndarray, aside: float = 0.0) -> Push:
    """The drive in C MuJoCo, objects on free joints; commands (T, 2) m/s, rad/s; it starts `aside` m to the left."""
    text, _ = scene_mjcf(scene, visuals=False, free=True)
    model = c_mujoco.reference_model(mujoco.MjSpec.from_string(text), robot)
    data = mujoco.MjData(model)
    root = model.joint(f"robot/{_root_joint(robot)}").qposadr[0]
    data.qpos[root : root + 7] = first_qpos(robot, 7)
    data.qpos[root + 1] += aside
    bodies = [model.body(name).id for name in scene.object_ids]
    names = [model.geom(g).name for g in range(model.ngeom)]
    substeps = round(CONTROL_DT / robot.physics_timestep)
    rows: list[Any] = []
    for command in commands:
        data.ctrl[:] = np.asarray(robot.command(jnp.asarray(command)))
        hit: set[str] = set()
        for _ in range(substeps):
            mujoco.mj_step(model, data)
            for contact in data.contact[: data.ncon]:
                pair = [names[g] for g in contact.geom]
                if contact.dist < 0 and any(n.startswith("robot/") for n in pair):
                    hit |= {n.split("/")[0] for n in pair if n.startswith("thing_")}
        mujoco.mj_kinematics(model, data)
        obj = int(sorted(hit)[0].split("_")[1]) if hit else -1
        rows.append((data.qpos[root : root + 7].copy(), data.xpos[bodies], data.xquat[bodies], bool(hit), obj))
    return Push(*(np.array(c) for c in zip(*rows, strict=True)))


def _root_joint(robot: RobotSpec) -> str:
    model = mujoco.MjModel.from_xml_string(robot.mjcf)
    return model.joint(int(model.body_jntadr[model.body(robot.root_body).id])).name


def push_engine(
    scene: SceneGeometry, robot: RobotSpec, commands: np.ndarray, impl: str, sizes: Any, objects: Any = None
) -> tuple[Push, Any]:
    """The same in an engine, and its last state; objects: the objects that are bodies, default the first ones."""
    bank = object_bank(scene)
    engine = make_engine(bank, robot, impl=impl, control_dt=CONTROL_DT, movable=sizes)
    slots = [bank.meta["object_ids"][0].index(name) for name in scene.object_ids]
    if objects is None:
        objects = (slots + [-1] * sizes.bodies)[: sizes.bodies]
    qpos = first_qpos(robot, engine.physics.model.nq)
    init, step = jax.jit(engine.init), jax.jit(engine.step)
    state = init(0, qpos, np.zeros(engine.physics.model.nv), np.asarray(objects))
    rows: list[Any] = []
    for command in commands:
        state = step(state, np.asarray(robot.command(jnp.asarray(command))))
        body, contacts = jax.device_get((state.bodies, state.contacts))
        hit = int(contacts.hit_object)
        rows.append(
            (
                np.asarray(state.qpos[:7]),
                body.position[: len(slots)],
                body.quaternion[: len(slots)],
                bool(contacts.hit),
                slots.index(hit) if hit >= 0 else -1,
            )
        )
    return Push(*(np.array(c) for c in zip(*rows, strict=True))), state


def tilt(quaternion: np.ndarray) -> np.ndarray:
    """(...,) rad between up and the third axis of frames (..., 4) wxyz."""
    return np.arccos(np.clip(1.0 - 2.0 * (quaternion[..., 1] ** 2 + quaternion[..., 2] ** 2), -1.0, 1.0))
