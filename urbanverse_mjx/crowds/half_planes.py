"""Half-planes of permitted velocities: one for every neighbour, and one for every flat of the surrounding free space.

In: positions and velocities of bodies; the free space's flats. Out:  `HalfPlanes` for `linear_program`. When: every
crowd step, inside jit.

For discs these are the published half-planes (van den Berg et al. 2011, section 4). Bodies longer than wide are
capsules, whose half-plane is that of the discs at the two points where the bodies are nearest, as in the medial-axis
method of Ma, Manocha and Wang ("Efficient Reciprocal Collision Avoidance between Heterogeneous Agents using CTMAT",
2018).
"""

from typing import Any

import jax.numpy as jnp

from .linear_program import NO_LIMIT, HalfPlanes

_EPSILON = 1e-9


def towards_neighbours(
    apart: tuple[Any, Any],
    velocity: tuple[Any, Any],
    other_velocity: tuple[Any, Any],
    reach: Any,
    share: Any,
    spare: Any,
    side: Any,
    valid: Any,
    horizon: Any,
    dt: float,
) -> HalfPlanes:
    """Velocities that avoid each neighbour for `horizon` seconds if the neighbour takes its share.

    Args:
      apart: (K, ...) m, vector from the agent to each neighbour.
      velocity: (...) m/s of the agent.
      other_velocity: (K, ...) m/s.
      reach: (K, ...) m, sum of the two radii.
      share: (K, ...), part of the change that the agent takes on; the shares of a pair add up to 1.
      spare: (K, ...), share of spare room that the agent may use.
      side: (K, ...) 1 or -1, opposite for the two agents of a pair: direction of separation if they coincide.
      valid: (K, ...) bool, whether the neighbour exists.
      horizon: (...) s.
      dt: s, time in which overlapping bodies separate.

    Returns:
      Lines (K, ...).
    """
    (ax, ay), (vx, vy), (ox, oy) = apart, velocity, other_velocity
    rx, ry = vx - ox, vy - oy
    distance2 = ax * ax + ay * ay
    touching = distance2 <= reach * reach
    rate = jnp.where(touching, 1.0 / dt, 1.0 / horizon)
    # Vector from the centre of the cut-off disc of the velocity obstacle to the relative velocity.
    wx, wy = rx - ax * rate, ry - ay * rate
    length2 = wx * wx + wy * wy
    length = jnp.sqrt(length2)
    back = wx * ax + wy * ay
    on_disc = touching | ((back < 0.0) & (back * back > reach * reach * length2))
    still = length < _EPSILON
    scale = 1.0 / jnp.where(still, 1.0, length)
    disc_x, disc_y = jnp.where(still, side, wx * scale), jnp.where(still, 0.0, wy * scale)
    # The legs of the cone are tangent to the disc of radius `reach`: rotated from `apart` by asin(reach / distance).
    inverse2 = 1.0 / jnp.maximum(distance2, _EPSILON)
    leg = jnp.sqrt(jnp.maximum(distance2 - reach * reach, 0.0))
    turn = jnp.where(ax * wy - ay * wx > 0.0, 1.0, -1.0)
    leg_x = -turn * (turn * ax * reach + ay * leg) * inverse2
    leg_y = turn * (ax * leg - turn * ay * reach) * inverse2
    nx, ny = jnp.where(on_disc, disc_x, leg_x), jnp.where(on_disc, disc_y, leg_y)
    change = jnp.where(on_disc, reach * rate - length, -(nx * rx + ny * ry))
    offset = nx * vx + ny * vy + jnp.where(change > 0.0, share, spare) * change
    return HalfPlanes(jnp.where(valid, nx, 1.0), jnp.where(valid, ny, 0.0), jnp.where(valid, offset, NO_LIMIT))


def nearest_places(apart: tuple[Any, Any], axis: tuple[Any, Any], other_axis: tuple[Any, Any]) -> tuple[Any, Any, Any]:
    """The shortest path (m) between two capsules' axes, which are segments.

    Args:
      apart: (K, ...) m, from centre to centre.
      axis, other_axis: (...) and (K, ...) m, from the centre to the front end; zero for a disc.

    Returns:
      (K, ...) x and y from the agent's nearest point to the neighbour's, and the position of that point on the agent's
      axis: 1 at the front end, -1 at the rear.
    """
    (px, py), (ax, ay), (bx, by) = apart, axis, other_axis
    best_x, best_y, place, best = px, py, jnp.zeros_like(px), jnp.full_like(px, jnp.inf)

    def keep_shorter(dx: Any, dy: Any, at: Any) -> None:
        nonlocal best_x, best_y, place, best
        distance = dx * dx + dy * dy
        shorter = distance < best
        best_x, best_y = jnp.where(shorter, dx, best_x), jnp.where(shorter, dy, best_y)
        place, best = jnp.where(shorter, at, place), jnp.where(shorter, distance, best)

    own, other = 1.0 / jnp.maximum(ax * ax + ay * ay, _EPSILON), 1.0 / jnp.maximum(bx * bx + by * by, _EPSILON)
    for end in (1.0, -1.0):
        # From the ends of each axis to the other axis.
        dx, dy = px - end * ax, py - end * ay
        along = jnp.clip(-(dx * bx + dy * by) * other, -1.0, 1.0)
        keep_shorter(dx + along * bx, dy + along * by, end)
        dx, dy = px + end * bx, py + end * by
        along = jnp.clip((dx * ax + dy * ay) * own, -1.0, 1.0)
        keep_shorter(dx - along * ax, dy - along * ay, along)
    return best_x, best_y, place


def towards_walls(outward: tuple[Any, Any], space: Any, radius: Any, horizon: Any) -> HalfPlanes:
    """Velocities that keep a disc on the free side of flats for `horizon` seconds.

    These are the published half-planes for static obstacles (van den Berg et al. 2011, section 5.1): the agent takes
    the full share, and standing still is always permitted, so that these lines never exclude each other.

    Args:
      outward: (M, ...) unit normal from the free side into the flat.
      space: (M, ...) m from the disc's centre to the flat; infinite without a flat.
      radius: (...) m.
      horizon: (...) s.

    Returns:
      Lines (M, ...).
    """
    mx, my = outward
    free = jnp.maximum(space - radius, 0.0)
    return HalfPlanes(-mx, -my, jnp.where(jnp.isfinite(space), -free / horizon, NO_LIMIT))
