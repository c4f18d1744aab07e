"""Compares drives in an engine with the same drives in C MuJoCo in the scene's MJCF.

In:   scenes as `MjSpec` (the saved `scene.xml`), engines, `Drives`.
Out:  `Trace`, `ParityReport`.
When: in tests and in `benchmarks/parity.py`, on the host.
"""

import dataclasses
from collections.abc import Sequence
from typing import Any

import jax
import mujoco
import numpy as np

from ...datatypes import RobotSpec, SceneBank
from ...geometry import rotations
from .drives import KINDS, Drives, aimed_drives, mixed_drives

__all__ = [
    "KINDS",
    "Drives",
    "ParityReport",
    "Trace",
    "aimed_drives",
    "compare",
    "drive_engine",
    "drive_reference",
    "mixed_drives",
    "reference_model",
]

#: Torsional and rolling friction, MuJoCo's defaults, which contacts of condim 3 do not use.
_DEFAULT_SPIN_FRICTION = (0.005, 0.0001, 0.0001)
#: Prefixes of names in the scene's MJCF that are not objects.
_GROUND = "ground/"
_ROBOT = "robot/"
#: Height of a contact's normal below which the ground is a kerb (45 degrees).
_MIN_GROUND_NORMAL = 0.7
#: cos of the tilt (60 degrees) at which a robot counts as fallen, as in `envs`.
_MIN_UP = 0.5


@dataclasses.dataclass(frozen=True)
class Trace:
    """The recorded run, S = T x physics steps per control step.

    Attributes:
      qpos: (N, S, nq) after each physics step.
      hit: (N, S) bool: the robot touched an object, or a part other than a foot touched the ground.
      objects: N sets of the ids of the objects touched.
      ground: (N,) bool, whether a part other than a foot touched the ground.
      met: (N, S) bool, hit, or a foot against a kerb; None if only hits were recorded.
    """

    qpos: np.ndarray
    hit: np.ndarray
    objects: tuple[frozenset[str], ...]
    ground: np.ndarray
    met: np.ndarray | None = None


@dataclasses.dataclass(frozen=True)
class ParityReport:
    """Differences of an engine from C MuJoCo, per drive; positions of the robot's body.

    Attributes:
      before: (N,) m, largest until the robot first meets an obstacle (else over the whole drive): an object, or a kerb
        against a foot, where micrometres decide whether it rolls over the edge.
      before_time: (N,) s into the drive, when that was.
      onset: (N,) i32 physics steps between the first touches; 0 where neither touches, -1 where only one does.
      after: (N,) m, one second after that; NaN where there is no obstacle or the drive ends earlier.
      after_time: (N,) s into the drive, when that was.
      hit: (N,) bool, touched in C MuJoCo.
      objects_agree: (N,) bool: the engine names only objects that were touched, and the same about the ground.
      ends_agree: (N,) bool: an episode would end for the same reason: a hit, a fall, a NaN, or none.
    """

    before: np.ndarray
    before_time: np.ndarray
    onset: np.ndarray
    after: np.ndarray
    after_time: np.ndarray
    hit: np.ndarray
    objects_agree: np.ndarray
    ends_agree: np.ndarray

    def summary(self) -> dict[str, Any]:
        """The statistics for the tolerances, and the drives with the largest differences."""
        known = np.flatnonzero(~np.isnan(self.after))
        first, last = int(self.before.argmax()), int(known[self.after[known].argmax()]) if len(known) else None
        return {
            "drives": len(self.hit),
            "hits": int(self.hit.sum()),
            "before_contact_max_mm": _millimetres(self.before[first]),
            "before_contact_worst_drive": first,
            "before_contact_worst_time_s": round(float(self.before_time[first]), 3),
            "onset_max_steps": int(self.onset.max()),
            "onset_worst_drive": int(self.onset.argmax()),
            "hit_flags_differ": int((self.onset < 0).sum()),
            "objects_differ": int((~self.objects_agree).sum()),
            "ends_differ": int((~self.ends_agree).sum()),
            "after_1s_drives": len(known),
            "after_1s_median_mm": _millimetres(np.median(self.after[known])) if len(known) else None,
            "after_1s_max_mm": _millimetres(self.after[last]) if last is not None else None,
            "after_1s_worst_drive": last,
            "after_1s_worst_time_s": round(float(self.after_time[last]), 3) if last is not None else None,
        }


def _millimetres(metres: Any) -> float:
    return round(float(metres) * 1e3, 4)


def reference_model(scene: mujoco.MjSpec, robot: RobotSpec, least: bool = False) -> mujoco.MjModel:
    """The scene with the robot in it, with the robot's options (time step, integrator, cone).

    Args:
      least: the smaller coefficient of two surfaces counts, by a contact pair for each of the robot's geoms and each of
        the scene, because MuJoCo's own rule is the larger one.
    """
    still = [geom for geom in scene.geoms if geom.contype or geom.conaffinity]
    body = mujoco.MjSpec.from_string(robot.mjcf)
    for option in ("timestep", "integrator", "cone"):
        setattr(scene.option, option, getattr(body.option, option))
    scene.attach(body, prefix=_ROBOT, frame=scene.worldbody.add_frame())
    own = [geom for geom in scene.geoms if geom.name.startswith(_ROBOT) and (geom.contype or geom.conaffinity)]
    for mine in own if least else ():
        for other in still:
            alone = mine.priority > other.priority
            friction = mine.friction[0] if alone else min(mine.friction[0], other.friction[0])
            scene.add_pair(
                geomname1=mine.name,
                geomname2=other.name,
                condim=mine.condim if alone else 3,
                friction=[friction, friction, *_DEFAULT_SPIN_FRICTION],
            )
    return scene.compile()


def drive_reference(models: Sequence[mujoco.MjModel], robot: RobotSpec, drives: Drives, control_dt: float) -> Trace:
    """The drives in C MuJoCo; `models` has one model per scene of the bank."""
    substeps = round(control_dt / robot.physics_timestep)
    feet = {_ROBOT + name for name in robot.foot_geoms}
    count, steps = len(drives.scene), len(drives.ctrl) * substeps
    qpos = np.zeros((count, steps, drives.qpos.shape[1]))
    hit, met = np.zeros((count, steps), bool), np.zeros((count, steps), bool)
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
                    met[i, step] |= contact.dist < 0 and abs(contact.frame[2]) < _MIN_GROUND_NORMAL
                    continue
                hit[i, step] = met[i, step] = True
                ground[i] |= other.startswith(_GROUND)
                seen |= set() if other.startswith(_GROUND) else {other.rsplit("/", 1)[0]}
        objects.append(frozenset(seen))
    return Trace(qpos, hit, tuple(objects), ground, met)


def scale_model(model: mujoco.MjModel, friction_scale: float, mass_scale: float) -> None:
    """Scales friction and mass of a model with a robot like `SimState.friction_scale` and `mass_scale`."""
    model.geom_friction[:, 0] *= friction_scale
    for field in (model.body_mass, model.body_inertia, model.body_subtreemass):
        field *= mass_scale


def drive_engine(
    engine: Any, bank: SceneBank, drives: Drives, friction_scale: float = 1.0, mass_scale: float = 1.0
) -> Trace:
    """The drives in an engine (`JaxEngine` or `WarpEngine`), all in one batch."""
    step = jax.jit(jax.vmap(engine.step_and_record))
    model = engine.physics.model
    state = jax.jit(jax.vmap(engine.init))(
        drives.scene, drives.qpos, np.zeros((len(drives.scene), model.nv), np.float32)
    )
    one = state.mass_scale
    state = state._replace(friction_scale=friction_scale * one, mass_scale=mass_scale * one)
    qpos, hit, seen, ground = [], [], [set() for _ in drives.scene], np.zeros(len(drives.scene), bool)
    for ctrl in drives.ctrl:
        state, record = step(state, ctrl)
        qpos.append(np.array(record.qpos))
        hit.append(np.array(record.hit))
        ground |= np.array(state.contacts.hit_ground)
        for i, slot in enumerate(np.array(state.contacts.hit_object)):
            seen[i] |= {bank.meta["object_ids"][drives.scene[i]][slot]} if slot >= 0 else set()
    return Trace(np.concatenate(qpos, 1), np.concatenate(hit, 1), tuple(frozenset(s) for s in seen), ground)


def _ends(trace: Trace) -> list[str]:
    """Reason why an episode would end, per drive; the first event counts, and a hit before a fall."""
    up = rotations.up_of(trace.qpos[..., 3:7])
    events = {"hit": trace.hit, "fall": up < _MIN_UP, "nan": ~np.isfinite(trace.qpos).all(-1)}
    first = {name: np.where(e.any(1), e.argmax(1), e.shape[1]) for name, e in events.items()}
    steps = trace.hit.shape[1]
    return [
        min(events, key=lambda name, i=i: first[name][i]) if min(f[i] for f in first.values()) < steps else "none"
        for i in range(len(trace.hit))
    ]


def compare(reference: Trace, engine: Trace, robot: RobotSpec) -> ParityReport:
    """Computes the differences of the engine from the reference."""
    count, steps = reference.hit.shape
    dt, rows = robot.physics_timestep, np.arange(count)
    apart = np.linalg.norm(reference.qpos[..., :3] - engine.qpos[..., :3], axis=-1)
    # NaN counts as an infinite distance.
    apart = np.where(np.isnan(apart), np.inf, apart)
    first = [np.where(t.hit.any(1), t.hit.argmax(1), steps) for t in (reference, engine)]
    both, either = np.maximum(*first), np.minimum(*first)
    onset = np.where((both == steps) & (either < steps), -1, both - either).astype(np.int32)
    if reference.met is not None:
        either = np.minimum(either, np.where(reference.met.any(1), reference.met.argmax(1), steps))
    worst = np.array([apart[i, : max(int(either[i]), 1)].argmax() for i in range(count)])
    late = either + round(1.0 / dt)
    agree = np.array([e <= t for t, e in zip(reference.objects, engine.objects, strict=True)])
    return ParityReport(
        before=apart[rows, worst],
        before_time=(worst + 1) * dt,
        onset=onset,
        after=np.where(late < steps, apart[rows, np.minimum(late, steps - 1)], np.nan),
        after_time=(late + 1) * dt,
        hit=reference.hit.any(1),
        objects_agree=agree & (reference.ground == engine.ground),
        ends_agree=np.array([a == b for a, b in zip(_ends(reference), _ends(engine), strict=True)]),
    )
