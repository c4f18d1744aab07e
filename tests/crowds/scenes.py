"""Known scenes of the field, and a plain loop that runs them."""

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from urbanverse_mjx.crowds import (
    KINDS,
    AgentKind,
    Bodies,
    HalfPlanes,
    Options,
    PreferredVelocity,
    Traits,
    deadlock,
    disturbed,
    half_planes,
    make_step,
    traits_of,
)

#: m, goals of flows, beyond reach, so that no arrived agent blocks others.
FAR = 100.0


@dataclasses.dataclass(frozen=True)
class Scene:
    """Agents with a goal each, in a plane with straight walls (rows: x, y of the outward unit vector, offset m)."""

    kinds: tuple[AgentKind, ...]
    start: np.ndarray
    goal: np.ndarray
    speed: np.ndarray
    walls: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros((0, 3)))
    heading: np.ndarray | None = None


@dataclasses.dataclass(frozen=True)
class Run:
    """Arrays over (time, agent): places, headings and velocities, one row a step."""

    dt: float
    x: np.ndarray
    y: np.ndarray
    vx: np.ndarray
    vy: np.ndarray
    heading: np.ndarray
    kinds: tuple[AgentKind, ...]

    def overlap(self) -> float:
        """m, deepest overlap of two bodies at any step; negative where they never touched."""
        r = np.array([k.radius for k in self.kinds])
        h = np.array([k.half_length for k in self.kinds])
        centre = np.stack([self.x, self.y], -1)
        axis = np.stack([np.cos(self.heading), np.sin(self.heading)], -1) * h[:, None]
        worst = -np.inf
        for i in range(len(r) - 1):
            points = centre[:, i, None] + np.linspace(-1, 1, 9)[:, None] * axis[:, i, None]
            apart = segment_distance(points, centre[:, i + 1 :], axis[:, i + 1 :])
            worst = max(worst, float((r[i] + r[i + 1 :] - apart).max()))
        return worst

    def away(self, scene: Scene) -> np.ndarray:
        """(A,) m from the goals at the end."""
        return np.hypot(self.x[-1] - scene.goal[:, 0], self.y[-1] - scene.goal[:, 1])

    def progress(self, scene: Scene) -> np.ndarray:
        """(A,) m gone towards the goals."""
        route = scene.goal - scene.start
        route /= np.linalg.norm(route, axis=1, keepdims=True)
        return (self.x[-1] - self.x[0]) * route[:, 0] + (self.y[-1] - self.y[0]) * route[:, 1]


def segment_distance(points: np.ndarray, centre: np.ndarray, axis: np.ndarray) -> np.ndarray:
    """(T, n) m, at each time the least distance of points (T, P, 2) to segments centre +- axis (T, n, 2)."""
    d = points[:, :, None] - centre[:, None]
    along = np.clip((d * axis[:, None]).sum(-1) / np.maximum((axis**2).sum(-1), 1e-12)[:, None], -1, 1)
    return np.linalg.norm(d - along[..., None] * axis[:, None], axis=-1).min(1)


def run(scene: Scene, seconds: float, dt: float = 0.1, seed: int = 0, **options: object) -> Run:
    """Preferred velocities towards the goals, slowing down there."""
    number = len(scene.kinds)
    rolling = sum(k.wheeled for k in scene.kinds)
    opts = Options(dt=dt, num_wheeled=rolling, **{"num_neighbours": min(8, max(1, number - 1)), **options})  # type: ignore[arg-type]
    step = make_step(opts)
    traits = Traits(*(a[:, 0] for a in traits_of(scene.kinds)))
    speed = jnp.asarray(scene.speed, jnp.float32)
    limit = jnp.minimum(traits.limit, speed * np.array([k.headroom for k in scene.kinds], np.float32))
    traits = traits._replace(limit=limit)
    goal, walls = jnp.asarray(scene.goal, jnp.float32), jnp.asarray(scene.walls, jnp.float32)
    toward = scene.goal - scene.start
    heading = np.arctan2(toward[:, 1], toward[:, 0]) if scene.heading is None else scene.heading
    columns = [scene.start[:, 0], scene.start[:, 1], np.zeros(number), np.zeros(number), heading]
    bodies = Bodies(*(jnp.asarray(c, jnp.float32) for c in columns))

    def fence(b: Bodies, end: float) -> HalfPlanes:
        ones = jnp.ones((len(walls), number))
        x = b.x + end * traits.half_length * jnp.cos(b.heading)
        y = b.y + end * traits.half_length * jnp.sin(b.heading)
        space = walls[:, 2:] - walls[:, :1] * x - walls[:, 1:2] * y
        outward = walls[:, :1] * ones, walls[:, 1:2] * ones
        rows = half_planes.towards_walls(outward, space, traits.radius, traits.wall_horizon)
        return rows if end > 0 else HalfPlanes(*(a[:, number - rolling :] for a in rows))

    side = deadlock.habitual_side(jax.random.key(seed + 1), number) * jnp.array([not k.wheeled for k in scene.kinds])

    def body(carry: tuple[Bodies, jax.Array, jax.Array], key: jax.Array) -> tuple[Any, Bodies]:
        b, blocked, side = carry
        dx, dy = goal[:, 0] - b.x, goal[:, 1] - b.y
        distance = jnp.sqrt(dx * dx + dy * dy)
        # Braking to rest at the goal: v² = 2 b d with half the braking.
        wanted = jnp.minimum(speed, jnp.sqrt(traits.braking * distance)) / jnp.maximum(distance, 1e-6)
        preferred_velocity = PreferredVelocity(dx * wanted, dy * wanted, jnp.arctan2(dy, dx))
        aside = deadlock.step_aside(preferred_velocity, blocked, side)
        new, _ = step(b, traits, disturbed(aside, key, side), fence(b, 1.0), fence(b, -1.0))
        blocked = deadlock.held_up(blocked, aside, (new.vx, new.vy), dt)
        side = deadlock.reconsider(side, blocked, jax.random.fold_in(key, 1), dt)
        return (new, blocked, side), new

    keys = jax.random.split(jax.random.key(seed), round(seconds / dt))
    _, path = jax.jit(lambda b: jax.lax.scan(body, (b, jnp.zeros(number), side), keys))(bodies)
    path = Bodies(*(np.concatenate([np.asarray(a)[None], np.asarray(p)]) for a, p in zip(bodies, path, strict=True)))
    return Run(dt, *path, kinds=scene.kinds)


PED, CHAIR, SCOOTER, BIKE, CAR = (KINDS[n] for n in ("pedestrian", "wheelchair", "scooter", "cyclist", "car"))


def _speeds(kinds: tuple[AgentKind, ...], seed: int | None) -> np.ndarray:
    if seed is None:
        return np.array([k.speed for k in kinds])
    noise = np.random.default_rng(seed).normal(size=len(kinds)).clip(-2, 2)
    return np.array([k.speed + k.spread * n for k, n in zip(kinds, noise, strict=True)])


def head_on(kind: AgentKind = PED, apart: float = 16.0, other: AgentKind | None = None) -> Scene:
    kinds = (kind, other or kind)
    start = np.array([[-apart / 2, 0.0], [apart / 2, 0.0]])
    return Scene(kinds, start, -start, _speeds(kinds, None))


def circle(number: int = 16, radius: float = 5.0) -> Scene:
    angle = 2 * np.pi * np.arange(number) / number
    start = radius * np.stack([np.cos(angle), np.sin(angle)], -1)
    return Scene((PED,) * number, start, -start, _speeds((PED,) * number, None))


def corridor(number: int = 12, width: float = 3.0, length: float = 14.0, seed: int = 1) -> Scene:
    """Two groups that meet between two walls."""
    rng = np.random.default_rng(seed)
    half = number // 2
    lane = np.linspace(-width / 2 + 0.6, width / 2 - 0.6, 3)
    row = np.arange(half)
    block = np.stack([-length / 2 - row // 3 * 1.2, lane[row % 3]], -1) + rng.uniform(-0.1, 0.1, (half, 2))
    other = block * [-1, 1] + rng.uniform(-0.1, 0.1, (half, 2))
    start = np.concatenate([block, other])
    goal = start + np.array([[FAR, 0]] * half + [[-FAR, 0]] * half)
    walls = np.array([[0, 1, width / 2], [0, -1, width / 2]])
    return Scene((PED,) * number, start, goal, _speeds((PED,) * number, seed), walls)


def crossing(number: int = 16, seed: int = 2) -> Scene:
    """Two flows at a right angle."""
    rng = np.random.default_rng(seed)
    half = number // 2
    row = np.arange(half)
    block = np.stack([-6 - row // 4 * 1.2, (row % 4 - 1.5) * 1.0], -1)
    start = np.concatenate([block, block[:, ::-1]]) + rng.uniform(-0.15, 0.15, (number, 2))
    goal = start + np.array([[FAR, 0]] * half + [[0, FAR]] * half)
    return Scene((PED,) * number, start, goal, _speeds((PED,) * number, seed))


def overtaking(width: float = 2.5) -> Scene:
    """A fast walker behind a slow one, between walls."""
    start, goal = np.array([[0.0, 0.05], [-3.0, 0.0]]), np.array([[14.0, 0.05], [20.0, 0.0]])
    return Scene((PED, PED), start, goal, np.array([0.6, 1.6]), np.array([[0, 1, width / 2], [0, -1, width / 2]]))
