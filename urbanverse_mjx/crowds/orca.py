"""One step of a crowd by ORCA: finds neighbours, chooses velocities and moves the bodies.

In: bodies, their parameters and preferred velocities, the walls around each. Out: the bodies after `dt`. When: every
crowd step, inside jit; per env, alone or under `jax.vmap`.
"""

import dataclasses
import math
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp

from ..datatypes import validation as v
from . import half_planes, motion, neighbours
from .batching import over_envs
from .bodies import Bodies, PreferredVelocity, Traits
from .linear_program import NO_LIMIT, HalfPlanes, join, solve

#: m/s, largest disturbance of a preferred velocity, which breaks perfect symmetry; the published library's examples
#: disturb every preferred velocity by up to 1e-4.
MAX_DISTURBANCE = 1e-3
#: m/s, largest retreat of a pedestrian against its preferred velocity. In the published program, agents that push each
#: other reach a common velocity, so that a group could push a single pedestrian back without limit.
MAX_RETREAT_SPEED = 0.3


@dataclasses.dataclass(frozen=True)
class Grid:
    """Options of the neighbour search in a grid, for large crowds; see `neighbours.in_grid`."""

    cell: float = 4.0
    cells: int = 16
    depth: int = 6


@dataclasses.dataclass(frozen=True)
class Options:
    """Options that are fixed when the step is compiled.

    Attributes:
      dt: s, length of a step.
      num_neighbours: K, number of bodies that each agent avoids at a time.
      num_wheeled: number of wheeled agents, which are the last ones.
      discs_only: whether every body is a disc (all `half_length` are 0), which makes the search for nearest points
        unnecessary.
      part_time: s, time in which bodies that are too near separate.
      hold_ground: whether the retreat of pedestrians is limited to `MAX_RETREAT_SPEED`.
      grid: options of the grid; None to compare all bodies.
    """

    dt: float = 0.1
    num_neighbours: int = 8
    num_wheeled: int = 0
    discs_only: bool = False
    part_time: float = 0.3
    hold_ground: bool = True
    grid: Grid | None = None

    def __post_init__(self) -> None:
        v.number(self.dt, "crowd options: dt", above=0.0)
        v.number(self.part_time, "crowd options: part_time", minimum=self.dt)
        v.integer(self.num_neighbours, "crowd options: num_neighbours", minimum=1)
        v.integer(self.num_wheeled, "crowd options: num_wheeled", minimum=0)


def look_around(bodies: Bodies, traits: Traits, agents: int, options: Options) -> neighbours.Neighbours:
    """The neighbours of the first `agents` bodies; arrays (B, E)."""
    size = traits.radius if options.discs_only else traits.radius + traits.half_length
    search = (bodies.x, bodies.y, size, traits.present, agents, options.num_neighbours)
    if options.grid is None:
        return neighbours.all_pairs(*search)
    return neighbours.in_grid(*search, options.grid.cell, options.grid.cells, options.grid.depth)


def permitted(
    bodies: Bodies, traits: Traits, agents: int, near: neighbours.Neighbours, options: Options
) -> tuple[HalfPlanes, Any]:
    """Half-planes (K, A, E) of the first A bodies for their neighbours.

    The second value (K, A, E) is the nearest position on the agent's axis: 1 at the front end, -1 at the rear.
    """
    envs = bodies.x.shape[1]
    row = near.index * envs + jnp.arange(envs, dtype=jnp.int32)

    def of_others(values: Any) -> Any:
        return jnp.take(values.reshape(-1), row, mode="clip")

    reach = traits.radius + traits.margin
    apart = of_others(bodies.x) - bodies.x[:agents], of_others(bodies.y) - bodies.y[:agents]
    place = jnp.zeros_like(apart[0])
    if not options.discs_only:
        ax, ay = traits.half_length * jnp.cos(bodies.heading), traits.half_length * jnp.sin(bodies.heading)
        *apart, place = half_planes.nearest_places(apart, (ax[:agents], ay[:agents]), (of_others(ax), of_others(ay)))

    def part_of(yielding: Any) -> Any:
        own, other = yielding[:agents], of_others(yielding)
        both = own + other
        return jnp.where(both > 0.0, own / jnp.where(both > 0.0, both, 1.0), 0.5)

    lines = half_planes.towards_neighbours(
        apart=(apart[0], apart[1]),
        velocity=(bodies.vx[:agents], bodies.vy[:agents]),
        other_velocity=(of_others(bodies.vx), of_others(bodies.vy)),
        reach=reach[:agents] + of_others(reach),
        share=part_of(_able(bodies, traits, agents, options)),
        spare=part_of(traits.yielding),
        side=jnp.where(near.index > jnp.arange(agents, dtype=jnp.int32)[:, None], 1.0, -1.0),
        valid=near.valid,
        horizon=traits.horizon[:agents],
        dt=options.part_time,
    )
    return lines, place


def _able(bodies: Bodies, traits: Traits, agents: int, options: Options) -> Any:
    """(B, E), weight of each body's share of the avoidance; a standing vehicle cannot step aside."""
    if not options.num_wheeled:
        return traits.yielding
    row = jnp.arange(bodies.x.shape[0])[:, None]
    rolls = (row >= agents - options.num_wheeled) & (row < agents)
    speed = jnp.sqrt(bodies.vx * bodies.vx + bodies.vy * bodies.vy)
    return traits.yielding * jnp.where(rolls, jnp.clip(speed, 0.05, 1.0), 1.0)


def stand(preferred_velocity: PreferredVelocity) -> HalfPlanes:
    """One half-plane (1, ...) per pedestrian (...) that limits its retreat to `MAX_RETREAT_SPEED`."""
    wants = (
        preferred_velocity.x * preferred_velocity.x + preferred_velocity.y * preferred_velocity.y
        > MAX_RETREAT_SPEED * MAX_RETREAT_SPEED
    )
    x, y = jnp.cos(preferred_velocity.face), jnp.sin(preferred_velocity.face)
    return HalfPlanes(x[None], y[None], jnp.where(wants, -MAX_RETREAT_SPEED, NO_LIMIT)[None])


def advance(
    bodies: Bodies,
    traits: Traits,
    preferred_velocity: PreferredVelocity,
    walls: HalfPlanes,
    rear: HalfPlanes,
    options: Options,
) -> tuple[Bodies, Any]:
    """Advances the first A bodies by one step, for many envs at once.

    Args:
      bodies, traits: (B, E); rows from A are bodies that are avoided but not moved (robots).
      preferred_velocity: (A, E).
      walls: (M, A, E), see `half_planes.towards_walls`, for walkers' bodies and the front discs of vehicles.
      rear: (M, W, E), the same for the rear discs of the W vehicles.

    Returns:
      Bodies (A, E) and (A, E) i32, see `Neighbours.missed`.
    """
    agents = preferred_velocity.x.shape[0]
    walkers = agents - options.num_wheeled
    # The barriers prevent XLA from recomputing the half-planes for every use.
    near = neighbours.Neighbours(*jax.lax.optimization_barrier(tuple(look_around(bodies, traits, agents, options))))
    lines, place = jax.lax.optimization_barrier(permitted(bodies, traits, agents, near, options))

    def rows(arrays: Any, part: slice) -> Any:
        return type(arrays)(*(a[..., part, :] for a in arrays))

    moved = []
    if walkers:
        part = slice(0, walkers)
        own, like, fence = rows(bodies, part), rows(traits, part), rows(walls, part)
        shape, aim = own.x.shape, rows(preferred_velocity, part)
        hard = (fence, stand(aim)) if options.hold_ground else (fence,)
        firm = join(*hard, rows(lines, part))
        flat = HalfPlanes(*jax.lax.optimization_barrier(tuple(a.reshape(a.shape[0], -1) for a in firm)))
        speeds = (a.reshape(-1) for a in (like.limit, aim.x, aim.y))
        chosen = [a.reshape(shape) for a in solve(flat, firm.offset.shape[0] - lines.offset.shape[0], *speeds)]
        velocity = motion.walk((chosen[0], chosen[1]), own, like, fence, options.dt)
        moved.append(motion.step_on(velocity, aim.face, own, like, options.dt))
    if options.num_wheeled:
        part = slice(walkers, agents)
        own, like = rows(bodies, part), rows(traits, part)
        fences = (rows(walls, part), rear)
        push, turn = motion.drive(rows(lines, part), place[:, part], fences, rows(preferred_velocity, part), own, like)
        moved.append(motion.roll(push, turn, rows(preferred_velocity, part), own, like, options.dt))
    here = rows(bodies, slice(0, agents))
    new = Bodies(*(jnp.concatenate(columns) for columns in zip(*moved, strict=True)))
    there = traits.present[:agents]
    return Bodies(*(jnp.where(there, a, b) for a, b in zip(new, here, strict=True))), near.missed


def disturbed(preferred_velocity: PreferredVelocity, key: Any, side: Any = 0.0) -> PreferredVelocity:
    """Disturbs preferred velocities (A,) by at most twice `MAX_DISTURBANCE` to break symmetry.

    Args:
      preferred_velocity: (A,).
      key: random key of this step.
      side: (A,), 1 to disturb to the left, -1 to the right, which determines the side for agents that meet head-on.
    """
    angle, size = jax.random.uniform(key, (2, *preferred_velocity.x.shape))
    angle, size = 2.0 * math.pi * angle, MAX_DISTURBANCE * size
    scale = (
        side
        * MAX_DISTURBANCE
        / jnp.maximum(
            jnp.sqrt(preferred_velocity.x * preferred_velocity.x + preferred_velocity.y * preferred_velocity.y),
            MAX_DISTURBANCE,
        )
    )
    x = preferred_velocity.x + size * jnp.cos(angle) - scale * preferred_velocity.y
    y = preferred_velocity.y + size * jnp.sin(angle) + scale * preferred_velocity.x
    return PreferredVelocity(x, y, preferred_velocity.face)


def make_step(options: Options) -> Callable[..., tuple[Bodies, Any]]:
    """A function (bodies, traits, preferred_velocity, walls, rear) -> (bodies, missed) over arrays of one env.

    This is `advance` without the env axis; see `over_envs`.
    """

    def step(
        bodies: Bodies, traits: Traits, preferred_velocity: PreferredVelocity, walls: HalfPlanes, rear: HalfPlanes
    ) -> tuple[Bodies, Any]:
        return advance(bodies, traits, preferred_velocity, walls, rear, options)

    return over_envs(step)


def no_walls(agents: int) -> HalfPlanes:
    """Walls (0, A) for an open plane."""
    return HalfPlanes(*(jnp.zeros((0, agents)) for _ in range(3)))
