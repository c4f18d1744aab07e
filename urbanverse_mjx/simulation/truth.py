"""C MuJoCo as the truth: the same drives in the scene's own MJCF and in an engine, and how far they part.

In:   scenes as `MjSpec` (the saved `scene.xml`), the engine, starts and commands.
Out:  `Drives`, `Trace`, `ParityReport`.
When: in tests and in `benchmarks/parity.py`, on the host.
"""

import dataclasses
from collections.abc import Sequence
from typing import Any

import jax
import mujoco
import numpy as np

from ..datatypes import RobotSpec, SceneBank
from .jax_engine import JaxEngine

#: How the scene's MJCF names what is no object.
_GROUND = "ground/"
_ROBOT = "robot/"


@dataclasses.dataclass(frozen=True)
class Drives:
    """N drives of T control steps.

    Attributes:
      scene: (N,) i32 rows of the bank.
      qpos: (N, nq) f32 starts, at rest.
      ctrl: (T, N, nu) f32 actuator commands.
    """

    scene: np.ndarray
    qpos: np.ndarray
    ctrl: np.ndarray


@dataclasses.dataclass(frozen=True)
class Trace:
    """What happened, S = T x physics steps per control step.

    Attributes:
      qpos: (N, S, nq) after each physics step.
      hit: (N, S) bool: the robot touched an object, or something that is no foot touched the ground.
      objects: N sets of the ids of the objects touched.
      ground: (N,) bool, whether something that is no foot touched the ground.
    """

    qpos: np.ndarray
    hit: np.ndarray
    objects: tuple[frozenset[str], ...]
    ground: np.ndarray


@dataclasses.dataclass(frozen=True)
class ParityReport:
    """Differences of an engine from C MuJoCo, per drive; positions of the robot's body.

    Attributes:
      before: (N,) m, largest until the earlier first touch (the whole drive where there is none).
      onset: (N,) i32 physics steps between the first touches; 0 where neither touches, -1 where only one does.
      after: (N,) m, one second after the first touch; NaN where there is none or the drive ends earlier.
      hit: (N,) bool, touched in C MuJoCo.
      objects_agree: (N,) bool: the engine names only objects that were touched, and the same about the ground.
    """

    before: np.ndarray
    onset: np.ndarray
    after: np.ndarray
    hit: np.ndarray
    objects_agree: np.ndarray

    def summary(self) -> dict[str, Any]:
        """The figures of the tolerances and the drives where they are largest."""
        after = self.after[~np.isnan(self.after)]
        return {
            "drives": len(self.hit),
            "hits": int(self.hit.sum()),
            "before_contact_max_mm": round(float(self.before.max()) * 1e3, 4),
            "before_contact_worst_drive": int(self.before.argmax()),
            "onset_max_steps": int(self.onset.max()),
            "hit_flags_differ": int((self.onset < 0).sum()),
            "objects_differ": int((~self.objects_agree).sum()),
            "after_1s_drives": len(after),
            "after_1s_median_mm": round(float(np.median(after)) * 1e3, 4) if len(after) else None,
            "after_1s_max_mm": round(float(after.max()) * 1e3, 4) if len(after) else None,
            "after_1s_worst_drive": int(np.nanargmax(self.after)) if len(after) else None,
        }


def truth_model(scene: mujoco.MjSpec, robot: RobotSpec) -> mujoco.MjModel:
    """The scene with the robot in it, with the robot's options (time step, integrator, cone)."""
    body = mujoco.MjSpec.from_string(robot.mjcf)
    for option in ("timestep", "integrator", "cone"):
        setattr(scene.option, option, getattr(body.option, option))
    scene.attach(body, prefix=_ROBOT, frame=scene.worldbody.add_frame())
    return scene.compile()


def aimed_drives(bank: SceneBank, robot: RobotSpec, count: int, steps: int, control_dt: float, seed: int) -> Drives:
    """Drives that start a few metres from an object and head for it, in all scenes by turns.

    The speed is constant and the yaw rate swings, so that most of them hit, at all angles.
    """
    rng = np.random.default_rng(seed)
    model = mujoco.MjModel.from_xml_string(robot.mjcf)
    scene = (np.arange(count) % bank.num_scenes).astype(np.int32)
    qpos = np.tile(model.qpos0.astype(np.float32), (count, 1))
    command = np.zeros((steps, count, 2), np.float32)
    time = np.arange(steps) * control_dt
    for i in range(count):
        start, yaw = _aim(bank, int(scene[i]), rng)
        qpos[i, :3] = start + (0.0, 0.0, robot.spawn_height)
        qpos[i, 3:7] = np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2)
        command[:, i, 0] = rng.uniform(0.4, 1.0) * robot.max_speed
        command[:, i, 1] = (
            rng.uniform(0, 0.5) * robot.max_yaw_rate * np.sin(rng.uniform(1, 3) * time + rng.uniform(0, 6))
        )
    return Drives(scene, qpos, np.array(jax.vmap(jax.vmap(robot.command))(command)))


def _aim(bank: SceneBank, scene: int, rng: np.random.Generator) -> tuple[np.ndarray, float]:
    """A start of the episode table with an object 1.5-4 m away, and the yaw (rad) that points about there."""
    present = bank.inst_hull[scene] >= 0
    targets = bank.inst_position[scene, present]
    rows = bank.episode_start[scene, : bank.num_episodes[scene], :3]
    apart = np.linalg.norm(rows[:, None, :2] - targets[None, :, :2], axis=-1)
    near = np.argwhere((apart > 1.5) & (apart < 4.0))
    row, target = near[rng.integers(len(near))] if len(near) else np.unravel_index(apart.argmin(), apart.shape)
    way = targets[target] - rows[row]
    return rows[row], float(np.arctan2(way[1], way[0]) + rng.uniform(-0.15, 0.15))


def drive_truth(models: Sequence[mujoco.MjModel], robot: RobotSpec, drives: Drives, control_dt: float) -> Trace:
    """The drives in C MuJoCo; `models` has one model per scene of the bank."""
    substeps = round(control_dt / robot.physics_timestep)
    feet = {_ROBOT + name for name in robot.foot_geoms}
    count, steps = len(drives.scene), len(drives.ctrl) * substeps
    qpos, hit = np.zeros((count, steps, drives.qpos.shape[1])), np.zeros((count, steps), bool)
    objects: list[frozenset[str]] = []
    ground = np.zeros(count, bool)
    for i, scene in enumerate(drives.scene):
        model = models[scene]
        names = [model.geom(g).name for g in range(model.ngeom)]
        data = mujoco.MjData(model)
        data.qpos[:] = drives.qpos[i]
        seen: set[str] = set()
        for step in range(steps):
            data.ctrl[:] = drives.ctrl[step // substeps, i]
            mujoco.mj_step(model, data)
            qpos[i, step] = data.qpos
            for contact in data.contact[: data.ncon]:
                own, other = sorted((names[g] for g in contact.geom), key=lambda n: not n.startswith(_ROBOT))
                if contact.dist >= 0 or (other.startswith(_GROUND) and own in feet):
                    continue
                hit[i, step] = True
                ground[i] |= other.startswith(_GROUND)
                seen |= set() if other.startswith(_GROUND) else {other.rsplit("/", 1)[0]}
        objects.append(frozenset(seen))
    return Trace(qpos, hit, tuple(objects), ground)


def drive_engine(engine: JaxEngine, bank: SceneBank, drives: Drives) -> Trace:
    """The drives in the engine, all in one batch."""
    step = jax.jit(jax.vmap(engine.step_and_record))
    model = engine.physics.model
    state = jax.jit(jax.vmap(engine.init))(
        drives.scene, drives.qpos, np.zeros((len(drives.scene), model.nv), np.float32)
    )
    qpos, hit, seen, ground = [], [], [set() for _ in drives.scene], np.zeros(len(drives.scene), bool)
    for ctrl in drives.ctrl:
        state, record = step(state, ctrl)
        qpos.append(np.array(record.qpos))
        hit.append(np.array(record.hit))
        ground |= np.array(state.contacts.hit_ground)
        for i, slot in enumerate(np.array(state.contacts.hit_object)):
            seen[i] |= {bank.meta["object_ids"][drives.scene[i]][slot]} if slot >= 0 else set()
    return Trace(np.concatenate(qpos, 1), np.concatenate(hit, 1), tuple(frozenset(s) for s in seen), ground)


def compare(truth: Trace, engine: Trace, robot: RobotSpec) -> ParityReport:
    """How far the engine parts from the truth."""
    count, steps = truth.hit.shape
    apart = np.linalg.norm(truth.qpos[..., :3] - engine.qpos[..., :3], axis=-1)
    second = round(1.0 / robot.physics_timestep)
    first = [np.where(t.hit.any(1), t.hit.argmax(1), steps) for t in (truth, engine)]
    both, either = np.maximum(*first), np.minimum(*first)
    before = np.array([apart[i, : max(int(either[i]), 1)].max() for i in range(count)])
    late = either + second
    after = np.where(late < steps, apart[np.arange(count), np.minimum(late, steps - 1)], np.nan)
    onset = np.where((both == steps) & (either < steps), -1, both - either)
    agree = np.array([e <= t for t, e in zip(truth.objects, engine.objects, strict=True)]) & (
        truth.ground == engine.ground
    )
    return ParityReport(before, onset.astype(np.int32), after, truth.hit.any(1), agree)
