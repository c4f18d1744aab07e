"""Checks whether movable objects keep their places as free bodies, by two seconds of simulation in C MuJoCo."""

import dataclasses

import mujoco
import numpy as np

from ..geometry import rotations
from .geometry import SceneGeometry
from .mjcf import scene_mjcf

SECONDS = 2.0
#: s, half the step of the scenes, at which light objects on many hulls do not jitter.
TIMESTEP = 0.005
#: m and rad, thresholds from which an object has moved. Overlapping hulls separate by up to 1 cm; a tipping object
#: rotates.
SHIFT, TILT = 0.05, np.radians(10.0)
#: m; fixed objects within this distance of movable objects are included. An object that moves farther counts as moved
#: anyway.
REACH = 0.5


@dataclasses.dataclass(frozen=True)
class Displacement:
    """An object that moved: its id, the displacement of its centre of mass (m), and its rotation (rad)."""

    id: str
    shift: float
    tilt: float


@dataclasses.dataclass(frozen=True)
class Motion:
    """Motion of n released objects: their ids, largest displacement of the centre of mass (n,) m and largest rotation
    (n,) rad at the checked times, infinite if a state is not finite; position (n, 3) m and quaternion (n, 4) of the
    bodies at the end."""

    ids: tuple[str, ...]
    shift: np.ndarray
    tilt: np.ndarray
    position: np.ndarray
    quaternion: np.ndarray


def displacements(
    scene: SceneGeometry, seconds: float = SECONDS, shift: float = SHIFT, tilt: float = TILT
) -> list[Displacement]:
    """The movable objects that leave their place within `seconds` at rest, the farthest first; empty when all stay.

    Every movable object has a free joint and starts in its place; only gravity and contacts act on it. A state that is
    not finite counts as an infinite displacement. `shift` (m) and `tilt` (rad): thresholds from which an object has
    moved.
    """
    motion = free_motion(scene, seconds)
    moved = [
        Displacement(n, float(s), float(t))
        for n, s, t in zip(motion.ids, motion.shift, motion.tilt, strict=True)
        if s > shift or t > tilt
    ]
    return sorted(moved, key=lambda m: -m.shift)


def free_motion(scene: SceneGeometry, seconds: float, timestep: float = TIMESTEP, instants: int = 1) -> Motion:
    """Simulates the movable objects as free bodies in C MuJoCo for `seconds` with steps of `timestep` s, and checks
    them at `instants` evenly spaced times, the last at the end."""
    scene = _around_movable(scene)
    if not scene.object_movable.any():
        return Motion((), np.zeros(0), np.zeros(0), np.zeros((0, 3)), np.zeros((0, 4)))
    text, _ = scene_mjcf(scene, visuals=False, free=True)
    model = mujoco.MjModel.from_xml_string(text)
    model.opt.timestep = timestep
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    names = tuple(np.array(scene.object_ids, dtype=object)[scene.object_movable])
    bodies = np.array([model.body(name).id for name in names], int)
    start, turned = data.xipos[bodies].copy(), data.xquat[bodies].copy()
    shift, tilt = np.zeros((2, len(bodies)))
    steps = np.diff(np.linspace(0, round(seconds / timestep), instants + 1).round().astype(int))
    for count in steps:
        mujoco.mj_step(model, data, int(count))
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        went = np.linalg.norm(data.xipos[bodies] - start, axis=1)
        alike = np.abs((data.xquat[bodies] * turned).sum(1))
        turn = 2.0 * np.arccos(np.clip(alike, 0.0, 1.0))
        went, turn = (np.where(np.isfinite(x), x, np.inf) for x in (went, turn))
        shift, tilt = np.maximum(shift, went), np.maximum(tilt, turn)
    return Motion(names, shift, tilt, data.xpos[bodies].copy(), data.xquat[bodies].copy())


def _around_movable(scene: SceneGeometry) -> SceneGeometry:
    """The scene with the movable objects and the fixed ones within `REACH` of them, by their upright boxes."""
    turns = rotations.matrix(scene.object_quaternion)
    low, high = np.full((2, len(scene.object_ids), 3), [[[np.inf]], [[-np.inf]]])
    for hull, o in zip(scene.inst_hull, scene.inst_object, strict=True):
        world = scene.hulls[hull] @ turns[o].T + scene.object_position[o]
        low[o], high[o] = np.minimum(low[o], world.min(0)), np.maximum(high[o], world.max(0))
    near = scene.object_movable.copy()
    for o in np.flatnonzero(scene.object_movable):
        near |= ((low <= high[o] + REACH) & (high >= low[o] - REACH)).all(1)
    return scene.with_objects(near)
