"""Pure functions of the navigation task: geometry, observations, rewards, terminations; per env, in f32.

Distances are on the ground plane. Rewards follow the paper's appendix; terms that the paper does not define are those
of the authors' released code, as stated in their docstrings.
"""

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from ..types import Result


def to_body(vector_world: Float[Array, "2"], yaw: Float[Array, ""]) -> Float[Array, "2"]:
    """Transforms a (2,) world vector to the heading frame (x forward, y left)."""
    c, s = jnp.cos(yaw), jnp.sin(yaw)
    x, y = vector_world[0], vector_world[1]
    return jnp.stack([c * x + s * y, -s * x + c * y])


def to_world(vectors_body: Float[Array, "*n 2"], yaw: Float[Array, ""]) -> Float[Array, "*n 2"]:
    """Transforms (..., 2) vectors from the heading frame to the world."""
    c, s = jnp.cos(yaw), jnp.sin(yaw)
    x, y = vectors_body[..., 0], vectors_body[..., 1]
    return jnp.stack([c * x - s * y, s * x + c * y], axis=-1)


def limit_norm(vector: Float[Array, " n"], limit: float) -> Float[Array, " n"]:
    """Limits the length of a vector to `limit`."""
    norm = jnp.linalg.norm(vector)
    return vector * jnp.minimum(1.0, limit / jnp.maximum(norm, 1e-6))


def distance_to_route(points: Float[Array, "*n 2"], corners: Float[Array, "W 2"]) -> Float[Array, "*n"]:
    """(...) m from points (..., 2) to the line through corners (W, 2)."""
    begin, span = corners[:-1], jnp.diff(corners, axis=0)
    away = points[..., None, :] - begin
    share = (away * span).sum(-1) / jnp.maximum((span * span).sum(-1), 1e-9)
    return jnp.linalg.norm(away - jnp.clip(share, 0.0, 1.0)[..., None] * span, axis=-1).min(-1)


def beside_route(
    corners: Float[Array, "W D"], along: Float[Array, " T"], aside: Float[Array, " T"]
) -> tuple[Float[Array, "T D"], Int[Array, " T"]]:
    """Points (T, D) m beside the line through corners (W, D), D 2 or 3, and (T,) i32, the segment beside which each
    lies.

    Args:
      along: m of arc length on the ground plane.
      aside: m to the left; the height is that of the line.
    """
    span = jnp.diff(corners, axis=0)
    length = jnp.linalg.norm(span[:, :2], axis=-1)
    ends = jnp.cumsum(length)
    piece = jnp.minimum(jnp.searchsorted(ends, along, side="right"), len(span) - 1).astype(jnp.int32)
    direction = span[piece] / jnp.maximum(length[piece], 1e-6)[:, None]
    points = corners[piece] + (along - (ends - length)[piece])[:, None] * direction
    left = jnp.stack([-direction[:, 1], direction[:, 0]], -1)
    return points.at[:, :2].add(aside[:, None] * left), piece


def route_length(start: Float[Array, "3"], waypoints: Float[Array, "W 3"]) -> Float[Array, ""]:
    """Length (m) of the polyline start (3,), waypoints (W, 3); repeated waypoints add no length."""
    points = jnp.concatenate([start[None, :2], waypoints[:, :2]])
    return jnp.linalg.norm(jnp.diff(points, axis=0), axis=-1).sum()


def route_position(
    p_xy: Float[Array, "2"], start: Float[Array, "3"], waypoints: Float[Array, "W 3"]
) -> Float[Array, ""]:
    """Arc length (m) of the point of the route nearest to `p_xy` (2,)."""
    points = jnp.concatenate([start[None, :2], waypoints[:, :2]])
    a, b = points[:-1], points[1:]
    span = b - a
    length = jnp.linalg.norm(span, axis=-1)
    t = jnp.clip(((p_xy - a) * span).sum(-1) / jnp.maximum(length**2, 1e-9), 0.0, 1.0)
    distance = jnp.linalg.norm(a + t[:, None] * span - p_xy, axis=-1)
    # Segments of length 0 (padding) must not be preferred to the last real one.
    best = jnp.argmin(jnp.where(length > 1e-6, distance, jnp.inf))
    before = jnp.cumsum(length) - length
    return before[best] + t[best] * length[best]


def route_completed(
    p_xy: Float[Array, "2"],
    start: Float[Array, "3"],
    waypoints: Float[Array, "W 3"],
    length: Float[Array, ""],
    left: Float[Array, ""],
    driven: Float[Array, ""],
) -> Float[Array, ""]:
    """Metres of a route of `length` m completed at `p_xy` (2,), for the paper's RC.

    On the route it is the arc length of the nearest point. A robot off the route may come near a later part of it, or
    near its end behind a wall. The remaining distance is therefore at least the straight line to the goal, and the
    completed one at most the distance driven.

    Args:
      left: () m, straight distance to the goal.
      driven: () m, distance driven.
    """
    return jnp.clip(jnp.minimum(route_position(p_xy, start, waypoints), length - left), 0.0, driven)


def next_waypoint(
    p_xy: Float[Array, "2"], waypoint: Int[Array, ""], waypoints: Float[Array, "W 3"], count: Int[Array, ""]
) -> Int[Array, ""]:
    """Index of the waypoint to drive to; advances within 2 m of the current one."""
    near = jnp.linalg.norm(waypoints[waypoint, :2] - p_xy) < 2.0
    return jnp.minimum(waypoint + near.astype(jnp.int32), count - 1)


def reward_arrived(result: Int[Array, ""]) -> Float[Array, ""]:
    """1 on the step that reaches the goal (paper R_A)."""
    return (result == Result.GOAL).astype(jnp.float32)


def reward_hit(hit: Bool[Array, ""]) -> Float[Array, ""]:
    """1 on a step with a hit (paper R_C)."""
    return hit.astype(jnp.float32)


def reward_off_traversable(result: Int[Array, ""]) -> Float[Array, ""]:
    """1 on the step that leaves the traversable area."""
    return (result == Result.OFF_TRAVERSABLE).astype(jnp.float32)


def reward_position(distance: Float[Array, ""], std: float) -> Float[Array, ""]:
    """1 - tanh(distance / std) in [0, 1] (paper R_P; the form is the released code's tracking term)."""
    return 1.0 - jnp.tanh(distance / std)


def reward_velocity_cosine(velocity_xy: Float[Array, "2"], to_goal_xy: Float[Array, "2"]) -> Float[Array, ""]:
    """Cosine between the velocity and the direction to the goal (paper R_V), 0 at rest.

    Below 5 cm/s it is scaled by the speed, so that the jitter of a standing robot has no reward.
    """
    norm = jnp.maximum(jnp.linalg.norm(velocity_xy), 0.05) * jnp.maximum(jnp.linalg.norm(to_goal_xy), 1e-6)
    return velocity_xy @ to_goal_xy / norm


def reward_velocity_dot(velocity_xy: Float[Array, "2"], to_goal_xy: Float[Array, "2"]) -> Float[Array, ""]:
    """Speed (m/s) towards the goal (released code's velocity term)."""
    return velocity_xy @ to_goal_xy / jnp.maximum(jnp.linalg.norm(to_goal_xy), 1e-6)


def reward_progress(previous_distance: Float[Array, ""], distance: Float[Array, ""]) -> Float[Array, ""]:
    """Decrease of the distance to the goal (m) in this step (after the released code's moving-towards-goal term)."""
    return previous_distance - distance


def reward_near_object(distance: Float[Array, ""]) -> Float[Array, ""]:
    """1 if a hull is 0.4 m from the robot's origin (COCO nearly touches it), falling to 0 at 1 m; not in the paper."""
    return jnp.clip((1.0 - distance) / 0.6, 0.0, 1.0)


def result_of(
    *,
    finite: Bool[Array, ""],
    fallen: Bool[Array, ""],
    hit: Bool[Array, ""],
    off_traversable: Bool[Array, ""],
    at_goal: Bool[Array, ""],
    out_of_time: Bool[Array, ""],
    hit_agent: Bool[Array, ""] | bool = False,
) -> Int[Array, ""]:
    """() i32 result code; if several apply, the first of non-finite, hit, fall, off, goal, timeout.

    Args:
      hit_agent: whether at least one of the hit bodies is an agent.

    Contact on arrival counts as a hit (paper: success is without collision).
    """
    code = jnp.int32(Result.RUNNING)
    for flag, value in (
        (out_of_time, Result.TIMEOUT),
        (at_goal, Result.GOAL),
        (off_traversable, Result.OFF_TRAVERSABLE),
        (fallen, Result.FALL),
        (hit, Result.HIT),
        (hit & hit_agent, Result.HIT_AGENT),
        (~finite, Result.NON_FINITE),
    ):
        code = jnp.where(flag, jnp.int32(value), code)
    return code
