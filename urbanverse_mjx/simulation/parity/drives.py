"""Drives for comparing engines: starts, commands and intended obstacles.

In:   the bank, the robot, a seed.
Out:  `Drives`.
When: in tests and in `benchmarks/parity.py`, on the host.
"""

import dataclasses

import jax
import mujoco
import numpy as np

from ...datatypes import RobotSpec, SceneBank
from ...geometry import rotations

#: Intended obstacles of drives; an aimed one starts where an episode does and heads for an object at any angle.
KINDS = ("free", "ramp", "kerb", "graze", "head_on", "wedge", "aimed")
#: Proposals per round, and rounds, before a scene counts as having no such place.
_PROPOSALS, _ROUNDS = 64, 6
#: m between the robot's shell and whatever a drive shall not meet.
_CLEARANCE = 0.3
#: m between two places of a path at which the ground is compared; a kerb is a step, a ramp a slope.
_GROUND_SPACING = 0.1
_MIN_KERB, _MAX_RAMP_STEP, _MAX_UNEVENNESS = 0.05, 0.03, 0.004
#: m above the ground, where the robot is widest.
_WIDEST_HEIGHT = 0.3
#: m between two objects that let no robot through but hold it.
_TRAP_WIDTH = (0.35, 0.62)


@dataclasses.dataclass(frozen=True)
class Drives:
    """N drives of T control steps.

    Attributes:
      scene: (N,) i32 rows of the bank.
      qpos: (N, nq) f32 starts, at rest.
      ctrl: (T, N, nu) f32 actuator commands.
      kind: (N,) intended obstacle of each, of `KINDS`; empty if not given.
    """

    scene: np.ndarray
    qpos: np.ndarray
    ctrl: np.ndarray
    kind: tuple[str, ...] = ()


@dataclasses.dataclass(frozen=True)
class _Street:
    """One scene: its hulls as oriented boxes (n,), its ground prisms as planes (p, F, 4), its ends low, high (2,) m."""

    centre: np.ndarray
    rotation: np.ndarray
    half: np.ndarray
    planes: np.ndarray
    low: np.ndarray
    high: np.ndarray

    def height(self, points: np.ndarray) -> np.ndarray:
        """(n,) m of the ground under points (n, 2); NaN where there is none."""
        best = np.full(len(points), -np.inf)
        for planes in self.planes:
            normal, offset = planes[:, :3], planes[:, 3]
            rest = offset - points @ normal[:, :2].T
            up, down = normal[:, 2] > 1e-6, normal[:, 2] < -1e-6
            upright = ~(up | down)
            top = (rest[:, up] / normal[up, 2]).min(1)
            bottom = (rest[:, down] / normal[down, 2]).max(1)
            inside = (top >= bottom) & (rest[:, upright] >= -1e-6).all(1)
            best = np.where(inside, np.maximum(best, top), best)
        return np.where(np.isfinite(best), best, np.nan)

    def clearance(self, points: np.ndarray) -> np.ndarray:
        """(n,) m from points (n, 3) to the nearest box of a hull."""
        best = np.full(len(points), np.inf)
        for centre, rotation, half in zip(self.centre, self.rotation, self.half, strict=True):
            local = np.abs((points - centre) @ rotation) - half
            best = np.minimum(best, np.linalg.norm(np.maximum(local, 0.0), axis=1))
        return best


def _street(bank: SceneBank, scene: int) -> _Street:
    present = bank.inst_hull[scene] >= 0
    hull, rotation = bank.inst_hull[scene, present], bank.inst_rotation[scene, present].astype(np.float64)
    box = bank.hull_box[hull].astype(np.float64)
    centre = bank.inst_position[scene, present] + np.einsum("qij,qj->qi", rotation, box[:, 0])
    there = bank.prism_hull[scene] >= 0
    prisms, position = bank.prism_hull[scene, there], bank.prism_position[scene, there].astype(np.float64)
    planes = bank.hull_planes[prisms].astype(np.float64)
    planes[..., 3] += np.einsum("pfi,pi->pf", planes[..., :3], position)
    corners = bank.hull_vertices[prisms] + position[:, None]
    return _Street(centre, rotation, box[:, 1], planes, corners.min((0, 1))[:2], corners.max((0, 1))[:2])


def ground_height(bank: SceneBank, scene: int, points: np.ndarray) -> np.ndarray:
    """(n,) m of a scene's ground under points (n, 2); NaN where there is none."""
    return _street(bank, scene).height(points)


@dataclasses.dataclass(frozen=True)
class _Plan:
    """Proposed drives: place (n, 2) m, yaw (n,), speed (n,) m/s, yaw rate = swing sin(pulse t) (n,) rad/s, rad/s."""

    place: np.ndarray
    yaw: np.ndarray
    speed: np.ndarray
    swing: np.ndarray
    pulse: np.ndarray

    def path(self, seconds: float) -> np.ndarray:
        """(n, k, 2) m of an ideal robot, `_GROUND_SPACING` apart at full speed."""
        dt = _GROUND_SPACING / 2.0
        time = np.arange(0.0, seconds, dt)
        yaw = self.yaw[:, None] + self.swing[:, None] * np.cumsum(np.sin(self.pulse[:, None] * time), 1) * dt
        span = np.stack([np.cos(yaw), np.sin(yaw)], -1) * self.speed[:, None, None] * dt
        return self.place[:, None] + np.cumsum(span, 1) - span[:, :1]

    def row(self, number: int) -> "_Plan":
        return _Plan(*(getattr(self, f.name)[number : number + 1] for f in dataclasses.fields(self)))


def _anywhere(street: _Street, robot: RobotSpec, rng: np.random.Generator, turning: float) -> _Plan:
    n = _PROPOSALS
    place = rng.uniform(street.low, street.high, (n, 2))
    speed, swing = rng.uniform(0.3, 1.0, n) * robot.max_speed, rng.uniform(-turning, turning, n) * robot.max_yaw_rate
    return _Plan(place, rng.uniform(-np.pi, np.pi, n), speed, swing, rng.uniform(1.0, 3.0, n))


def _towards(
    street: _Street, robot: RobotSpec, rng: np.random.Generator, target: np.ndarray, aside: np.ndarray, yaw: np.ndarray
) -> _Plan:
    """Straight drives along `yaw` (n,) past `target` (n, 2) at the distance `aside` (n,), from a little before it."""
    n = len(target)
    ahead, left = np.stack([np.cos(yaw), np.sin(yaw)], -1), np.stack([-np.sin(yaw), np.cos(yaw)], -1)
    back = rng.uniform(0.9, 2.2, n)[:, None] + robot.circumradius
    place = target - ahead * back + left * aside[:, None]
    return _Plan(place, yaw, rng.uniform(0.3, 1.0, n) * robot.max_speed, np.zeros(n), np.ones(n))


def _at_objects(street: _Street, robot: RobotSpec, rng: np.random.Generator, graze: bool) -> _Plan | None:
    if not len(street.half):
        return None
    q = rng.integers(len(street.half), size=_PROPOSALS)
    yaw = rng.uniform(-np.pi, np.pi, _PROPOSALS)
    left = np.stack([-np.sin(yaw), np.cos(yaw), np.zeros(_PROPOSALS)], -1)
    reach = np.abs(np.einsum("nij,ni->nj", street.rotation[q], left) * street.half[q]).sum(1)
    shell = robot.planner_radius * rng.uniform(0.6, 0.75, _PROPOSALS)
    aside = reach + shell if graze else rng.uniform(-0.3, 0.3, _PROPOSALS) * reach
    side = rng.choice([-1.0, 1.0], _PROPOSALS)
    ahead = np.stack([np.cos(yaw), np.sin(yaw), np.zeros(_PROPOSALS)], -1)
    depth = np.abs(np.einsum("nij,ni->nj", street.rotation[q], ahead) * street.half[q]).sum(1)
    target = street.centre[q, :2] - ahead[:, :2] * depth[:, None]
    return _towards(street, robot, rng, target, aside * side, yaw)


def _between_objects(street: _Street, robot: RobotSpec, rng: np.random.Generator) -> _Plan | None:
    """Into gaps between two hulls that are too narrow for the robot."""
    ends = []
    signs = np.array([(a, b, -1.0) for a in (-1, 1) for b in (-1, 1)])
    corners = street.centre[:, None] + np.einsum("nij,nkj->nki", street.rotation, street.half[:, None] * signs)
    for a in range(len(corners)):
        local = np.einsum("nij,nki->nkj", street.rotation, corners[a][None] - street.centre[:, None])
        nearest = np.clip(local, -street.half[:, None], street.half[:, None])
        gap = np.linalg.norm((local - nearest)[..., :2], axis=-1)
        for b, k in np.argwhere((gap > _TRAP_WIDTH[0]) & (gap < _TRAP_WIDTH[1])):
            if b != a and gap[b].argmin() == k:
                there = street.centre[b] + street.rotation[b] @ nearest[b, k]
                ends.append((corners[a, k, :2], there[:2]))
    if not ends:
        return None
    one, other = np.array(ends)[rng.integers(len(ends), size=_PROPOSALS)].transpose(1, 0, 2)
    across = other - one
    yaw = np.arctan2(across[:, 1], across[:, 0]) + rng.choice([-0.5, 0.5], _PROPOSALS) * np.pi
    return _towards(street, robot, rng, (one + other) / 2, np.zeros(_PROPOSALS), yaw)


def _good_starts(street: _Street, robot: RobotSpec, plan: _Plan) -> np.ndarray:
    """Numbers of the plans that start on flat ground without an obstacle."""
    corners = robot.planner_radius * 0.8 * np.array([(0, 0), (1, 1), (1, -1), (-1, 1), (-1, -1)])
    height = street.height((plan.place[:, None] + corners).reshape(-1, 2)).reshape(-1, len(corners))
    free = street.clearance(np.column_stack([plan.place, height[:, 0] + _WIDEST_HEIGHT]))
    return np.flatnonzero((np.ptp(height, axis=1) < _MAX_UNEVENNESS) & (free > robot.planner_radius + 0.1))


def _suits(kind: str, street: _Street, robot: RobotSpec, path: np.ndarray) -> bool:
    """Whether a path (k, 2) meets the obstacle of its kind of drive, and no other."""
    ground = street.height(path)
    free = street.clearance(np.column_stack([path, np.full(len(path), ground[0] + _WIDEST_HEIGHT)])).min()
    if np.isnan(ground).any():
        return False
    if kind in ("graze", "head_on", "wedge"):
        return bool(np.ptp(ground) < _MAX_UNEVENNESS and free < robot.planner_radius)
    if free < robot.planner_radius + _CLEARANCE:
        return False
    step = np.abs(np.diff(ground)).max()
    if kind == "free":
        return bool(np.ptp(ground) < _MAX_UNEVENNESS)
    return bool(step > _MIN_KERB) if kind == "kerb" else bool(np.ptp(ground) > _MIN_KERB and step < _MAX_RAMP_STEP)


def _find(
    kind: str, street: _Street, robot: RobotSpec, seconds: float, rng: np.random.Generator
) -> tuple[_Plan, float] | None:
    """A plan of a kind in a street and the ground's height there (m), or None."""
    for _ in range(_ROUNDS):
        if kind == "wedge":
            plan = _between_objects(street, robot, rng)
        elif kind in ("graze", "head_on"):
            plan = _at_objects(street, robot, rng, kind == "graze")
        else:
            plan = _anywhere(street, robot, rng, 0.5 if kind == "free" else 0.1)
        if plan is None:
            return None
        for row in _good_starts(street, robot, plan):
            one = plan.row(row)
            if _suits(kind, street, robot, one.path(seconds)[0]):
                return one, float(street.height(one.place)[0])
    return None


def _aimed(bank: SceneBank, scene: int, robot: RobotSpec, rng: np.random.Generator) -> tuple[_Plan, float]:
    start, yaw = _aim(bank, scene, rng)
    speed, swing = rng.uniform(0.4, 1.0) * robot.max_speed, rng.uniform(0.0, 0.5) * robot.max_yaw_rate
    plan = _Plan(start[None, :2], *(np.array([x]) for x in (yaw, speed, swing, rng.uniform(1.0, 3.0))))
    return plan, float(start[2])


def mixed_drives(bank: SceneBank, robot: RobotSpec, count: int, steps: int, control_dt: float, seed: int) -> Drives:
    """Drives of all `KINDS` in all scenes by turns; where a scene has no place for a kind, the next takes its turn.

    Raises:
      ValueError: a scene has no place for any drive.
    """
    model = mujoco.MjModel.from_xml_string(robot.mjcf)
    scene = (np.arange(count) % bank.num_scenes).astype(np.int32)
    qpos = np.tile(_at_rest(model), (count, 1))
    command = np.zeros((steps, count, 2), np.float32)
    time, names = np.arange(steps) * control_dt, []
    streets = [_street(bank, z) for z in range(min(bank.num_scenes, count))]
    for i in range(count):
        first = scene[i] + i // bank.num_scenes
        for kind in (KINDS[(first + k) % len(KINDS)] for k in range(len(KINDS))):
            rng = np.random.default_rng([seed, i, KINDS.index(kind)])
            if kind == "aimed":
                found = _aimed(bank, int(scene[i]), robot, rng)
            else:
                found = _find(kind, streets[scene[i]], robot, steps * control_dt, rng)
            if found is not None:
                break
        else:
            raise ValueError(f"scene {bank.scene_ids[scene[i]]!r}: found no place for a drive; needed some free ground")
        (plan, ground), yaw = found, found[0].yaw[0]
        qpos[i, :3] = *plan.place[0], ground + robot.spawn_height
        qpos[i, 3:7] = rotations.from_yaw(yaw)
        command[:, i, 0] = plan.speed[0]
        command[:, i, 1] = plan.swing[0] * np.sin(plan.pulse[0] * time)
        names.append(kind)
    return Drives(scene, qpos, _commands(robot, command), tuple(names))


def aimed_drives(bank: SceneBank, robot: RobotSpec, count: int, steps: int, control_dt: float, seed: int) -> Drives:
    """Drives that start a few metres from an object and head for it, in all scenes by turns.

    The speed is constant and the yaw rate swings, so that most of them hit, at all angles.
    """
    rng = np.random.default_rng(seed)
    model = mujoco.MjModel.from_xml_string(robot.mjcf)
    scene = (np.arange(count) % bank.num_scenes).astype(np.int32)
    qpos = np.tile(_at_rest(model), (count, 1))
    command = np.zeros((steps, count, 2), np.float32)
    time = np.arange(steps) * control_dt
    for i in range(count):
        start, yaw = _aim(bank, int(scene[i]), rng)
        qpos[i, :3] = start + (0.0, 0.0, robot.spawn_height)
        qpos[i, 3:7] = rotations.from_yaw(yaw)
        command[:, i, 0] = rng.uniform(0.4, 1.0) * robot.max_speed
        command[:, i, 1] = (
            rng.uniform(0, 0.5) * robot.max_yaw_rate * np.sin(rng.uniform(1, 3) * time + rng.uniform(0, 6))
        )
    return Drives(scene, qpos, _commands(robot, command), ("aimed",) * count)


def _at_rest(model: mujoco.MjModel) -> np.ndarray:
    """(nq,) f32, the first keyframe, or the initial pose of the MJCF."""
    return (model.key_qpos[0] if model.nkey else model.qpos0).astype(np.float32)


def _commands(robot: RobotSpec, velocity: np.ndarray) -> np.ndarray:
    """(T, N, nu) actuator commands for (T, N, 2) (v, omega)."""
    return np.array(jax.vmap(jax.vmap(robot.command))(velocity))


def _aim(bank: SceneBank, scene: int, rng: np.random.Generator) -> tuple[np.ndarray, float]:
    """A start of the episode table with an object 1.5-4 m away, and the yaw (rad) that points about there."""
    present = bank.inst_hull[scene] >= 0
    targets = bank.inst_position[scene, present]
    rows = bank.episode_start[scene, : bank.num_episodes[scene], :3]
    apart = np.linalg.norm(rows[:, None, :2] - targets[None, :, :2], axis=-1)
    near = np.argwhere((apart > 1.5) & (apart < 4.0))
    row, target = near[rng.integers(len(near))] if len(near) else np.unravel_index(apart.argmin(), apart.shape)
    span = targets[target] - rows[row]
    return rows[row], float(np.arctan2(span[1], span[0]) + rng.uniform(-0.15, 0.15))
