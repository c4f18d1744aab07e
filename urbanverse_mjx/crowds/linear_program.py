"""The two linear programs of ORCA, vectorised over agents.

In:   half-planes of permitted velocities, a largest speed and a preferred velocity, for each agent. Out: the permitted
velocity nearest to the preferred one; if none is permitted, the velocity that minimises the largest violation of the
soft half-planes. When: every crowd step, inside jit.

The method is the published one (van den Berg, Guy, Lin and Manocha, "Reciprocal n-body collision avoidance", 2011,
sections 5.2 and 5.3): half-planes are added one after the other, and if the current optimum violates the next one, the
new optimum lies on its line. It can be vectorised because the optimum *on* a line under the lines before it does not
depend on earlier results: all of them are computed in parallel, and the loop reduces to one select per line. The same
holds for the three-dimensional program of crowded situations, where "the lines before" are the bisectors between two
violations.

The first axis of arrays is the line, the last one the agent, so that agents are contiguous in memory.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

#: Offset of a half-plane without effect.
NO_LIMIT = -1e6
#: Sine of the angle below which two lines count as parallel: the published library's RVO_EPSILON.
PARALLEL_TOLERANCE = 1e-5
#: Tolerance of violations in units of the machine epsilon.
_ULPS = 16.0
#: Chunk size of the second program: one over its share of the agents, and its least number of agents.
_CHUNK_SHARE, _CHUNK_LEAST = 32, 64


class HalfPlanes(NamedTuple):
    """Velocities v with normal · v >= offset; the normal has length 1.

    Attributes:
      x: (N, ...), y: (N, ...) components of the normal.
      offset: (N, ...) m/s; `NO_LIMIT` where there is no constraint.
    """

    x: Any
    y: Any
    offset: Any

    def violation(self, vx: Any, vy: Any) -> Any:
        """(N, ...) m/s by which a velocity (...) fails each half-plane; negative inside."""
        return self.offset - self.x * vx - self.y * vy


def join(*parts: HalfPlanes) -> HalfPlanes:
    """All lines of several sets, in order."""
    return HalfPlanes(*(jnp.concatenate(column) for column in zip(*parts, strict=True)))


def _on_line(lines: HalfPlanes, j: int, limit: Any, target: Any) -> tuple[Any, Any, Any]:
    """The point on line j nearest to `target` within the speed limit and the lines before it.

    Positions on the line are measured from its point nearest to zero velocity along (y, -x) of its normal.

    Args:
      limit: (...) m/s.
      target: (...) m/s along the line, may be infinite.

    Returns:
      (...) x and y of the point, and bool, whether it exists.
    """
    nx, ny, offset = lines.x[j], lines.y[j], lines.offset[j]
    slack = _ULPS * jnp.finfo(offset.dtype).eps
    square = limit * limit - offset * offset
    possible = square >= -slack * jnp.maximum(limit * limit, 1.0)
    high = jnp.sqrt(jnp.maximum(square, 0.0))
    low = -high
    if j > 0:
        ox, oy, other = lines.x[:j], lines.y[:j], lines.offset[:j]
        sine = ox * ny - oy * nx
        needed = other - offset * (ox * nx + oy * ny)
        parallel = jnp.abs(sine) <= PARALLEL_TOLERANCE
        crossing = needed / jnp.where(parallel, 1.0, sine)
        low = jnp.maximum(low, jnp.max(jnp.where(parallel | (sine < 0.0), -jnp.inf, crossing), axis=0))
        high = jnp.minimum(high, jnp.min(jnp.where(parallel | (sine > 0.0), jnp.inf, crossing), axis=0))
        possible &= ~jnp.any(parallel & (needed > slack), axis=0)
    # An interval that is empty only by rounding is replaced by its centre.
    gap = low - high
    possible &= gap <= _ULPS * slack
    middle = 0.5 * (low + high)
    low, high = jnp.where(gap > 0.0, middle, low), jnp.where(gap > 0.0, middle, high)
    place = jnp.clip(target, low, high)
    return nx * offset + ny * place, ny * offset - nx * place, possible


def _add_in_turn(lines: HalfPlanes, limit: Any, x: Any, y: Any, targets: list[Any]) -> tuple[Any, Any, Any]:
    """Adds all lines to the optimum (x, y) without lines; stops when they exclude each other.

    Returns:
      (...) x and y, and i32, the first line that is infeasible, or N.
    """
    number = lines.offset.shape[0]
    slack = _ULPS * jnp.finfo(x.dtype).eps
    # The barriers prevent XLA from recomputing earlier selects for every use.
    places = jax.lax.optimization_barrier([_on_line(lines, j, limit, targets[j]) for j in range(number)])
    failed = jnp.full(x.shape, number, jnp.int32)
    for j, (new_x, new_y, possible) in enumerate(places):
        needed = (lines.offset[j] - lines.x[j] * x - lines.y[j] * y > slack) & (failed == number)
        failed = jnp.where(needed & ~possible, j, failed)
        x, y = jnp.where(needed & possible, new_x, x), jnp.where(needed & possible, new_y, y)
        x, y, failed = jax.lax.optimization_barrier((x, y, failed))
    return x, y, failed


def nearest_permitted(lines: HalfPlanes, limit: Any, preferred_x: Any, preferred_y: Any) -> tuple[Any, Any, Any]:
    """The permitted velocity nearest to the preferred velocity (the published linearProgram2).

    Args:
      lines: of (N, ...).
      limit: (...) m/s, largest speed.
      preferred_x, preferred_y: (...) m/s.

    Returns:
      (...) x and y m/s, and i32, the first line that makes the program infeasible, or N. If infeasible, x and y are the
      optimum under the lines before.
    """
    speed = jnp.sqrt(preferred_x * preferred_x + preferred_y * preferred_y)
    scale = jnp.minimum(1.0, limit / jnp.maximum(speed, 1e-9))
    x, y = preferred_x * scale, preferred_y * scale
    targets = [lines.y[j] * preferred_x - lines.x[j] * preferred_y for j in range(lines.offset.shape[0])]
    return _add_in_turn(lines, limit, x, y, targets)


def _bisectors(lines: HalfPlanes, num_hard: int) -> HalfPlanes:
    """For each soft line i, the lines of its program: (N, S, ...), S = N - num_hard.

    Entry (k, i) is the hard line k itself; for a soft line k before i, the velocities that violate i more than k;
    otherwise no limit.
    """
    number = lines.offset.shape[0]

    def pair(column: Any) -> tuple[Any, Any]:
        return column[:, None], column[None, num_hard:]

    (kx, ix), (ky, iy), (kb, ib) = (pair(column) for column in lines)
    dx, dy, db = kx - ix, ky - iy, kb - ib
    length = jnp.sqrt(dx * dx + dy * dy)
    ones = (1,) * (dx.ndim - 2)
    k = jnp.arange(number).reshape(number, 1, *ones)
    i = jnp.arange(num_hard, number).reshape(1, number - num_hard, *ones)
    # Parallel lines have no bisector; the stricter one is handled before.
    used = (k >= num_hard) & (k < i) & (length > PARALLEL_TOLERANCE)
    scale = 1.0 / jnp.where(used, length, 1.0)
    hard = k < num_hard
    nothing = jnp.zeros_like(dx)
    return HalfPlanes(
        jnp.where(used, dx * scale, jnp.where(hard, kx, nothing + 1.0)),
        jnp.where(used, dy * scale, jnp.where(hard, ky, nothing)),
        jnp.where(used, db * scale, jnp.where(hard, kb, nothing + NO_LIMIT)),
    )


def least_violation(lines: HalfPlanes, num_hard: int, limit: Any, x: Any, y: Any, failed: Any) -> tuple[Any, Any]:
    """The velocity that minimises the largest violation of soft lines (the published linearProgram3).

    Args:
      lines: (N, ...); the first `num_hard` are hard, the others soft.
      limit: (...) m/s.
      x, y, failed: result of `nearest_permitted`.

    Returns:
      (...) x and y, m/s; the input if the first program is feasible.
    """
    number = lines.offset.shape[0]
    if number == num_hard:
        return x, y
    soft_x, soft_y = lines.x[num_hard:], lines.y[num_hard:]
    program = HalfPlanes(*jax.lax.optimization_barrier(tuple(_bisectors(lines, num_hard))))
    # On each line, the direction that reduces its violation, within the bounds.
    targets = []
    for k in range(number):
        along = program.y[k] * soft_x - program.x[k] * soft_y
        targets.append(jnp.where(along > 0.0, jnp.inf, -jnp.inf))
    bound = jnp.broadcast_to(limit, soft_x.shape)
    best_x, best_y, stopped = _add_in_turn(program, bound, soft_x * bound, soft_y * bound, targets)
    deepest = jnp.zeros_like(x)
    for s in range(number - num_hard):
        i = num_hard + s
        worse = lines.offset[i] - lines.x[i] * x - lines.y[i] * y > deepest
        worse &= i >= failed
        found = worse & (stopped[s] == number)
        x, y = jnp.where(found, best_x[s], x), jnp.where(found, best_y[s], y)
        deepest = jnp.where(worse, lines.offset[i] - lines.x[i] * x - lines.y[i] * y, deepest)
        x, y, deepest = jax.lax.optimization_barrier((x, y, deepest))
    return x, y


def solve(lines: HalfPlanes, num_hard: int, limit: Any, preferred_x: Any, preferred_y: Any) -> tuple[Any, Any]:
    """New velocities of many agents.

    The second program costs about ten times as much as the first, and few agents need it; these are gathered and
    processed in chunks.

    Args:
      lines: of (N, B).
      num_hard: number of the first lines that are hard; together they must be feasible.
      limit: (B,) m/s, largest speed. preferred_x, preferred_y: (B,) m/s.

    Returns:
      (B,) x and y, m/s.
    """
    x, y, failed = nearest_permitted(lines, limit, preferred_x, preferred_y)
    number, total = lines.offset.shape
    chunk = min(total, max(_CHUNK_LEAST, -(-total // _CHUNK_SHARE)))
    if chunk == total:
        return least_violation(lines, num_hard, limit, x, y, failed)
    crowded = failed < number
    rows = jnp.nonzero(crowded, size=total + chunk, fill_value=total)[0]
    count = jnp.sum(crowded)

    def more(carry: tuple[Any, Any, Any]) -> Any:
        return carry[0] < count

    def one_chunk(carry: tuple[Any, Any, Any]) -> tuple[Any, Any, Any]:
        start, x, y = carry
        row = jax.lax.dynamic_slice_in_dim(rows, start, chunk)
        here = jnp.minimum(row, total - 1)
        few = HalfPlanes(*(column[:, here] for column in lines))
        new_x, new_y = least_violation(few, num_hard, limit[here], x[here], y[here], failed[here])
        return start + chunk, x.at[row].set(new_x, mode="drop"), y.at[row].set(new_y, mode="drop")

    _, x, y = jax.lax.while_loop(more, one_chunk, (jnp.zeros((), count.dtype), x, y))
    return x, y
