"""`PeopleTask`: base class of tasks with a crowd, and the times to collisions with its agents."""

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from ....crowds.crowd import Crowd
from ....datatypes import ValidationError
from .. import terms
from ..dynamic import DynamicStreet
from .task import Parts, RobotPose, Task

#: s, largest reported time to a collision.
MAX_TIME_TO_COLLISION = 10.0
#: m by which observed distances of agents are divided.
UNIT = 5.0


def time_to_collision(
    away: Float[Array, "n 2"], velocity: Float[Array, "n 2"], reach: Float[Array, " n"]
) -> Float[Array, " n"]:
    """(n,) s until discs touch at constant velocities, at most `MAX_TIME_TO_COLLISION`, 0 on overlap.

    Args:
      away: (n, 2) m, positions relative to the robot's.
      velocity: (n, 2) m/s, relative to the robot's.
      reach: (n,) m, sums of two radii.
    """
    a, b = (velocity * velocity).sum(-1), (away * velocity).sum(-1)
    c = (away * away).sum(-1) - reach * reach
    root = b * b - a * c
    meets = (b < 0.0) & (root > 0.0) & (a > 1e-9)
    time = c / jnp.maximum(-b + jnp.sqrt(jnp.maximum(root, 0.0)), 1e-9)
    return jnp.where(c <= 0.0, 0.0, jnp.where(meets, jnp.minimum(time, MAX_TIME_TO_COLLISION), MAX_TIME_TO_COLLISION))


def nearest_agents(dynamic: DynamicStreet, crowd: Crowd, robot: RobotPose, number: int) -> Float[Array, " n"]:
    """(5 number,) f32: of the nearest agents their position in the heading frame (in units of `UNIT`, at most 2), the
    velocity relative to the robot's in that frame (m/s), and whether there is such an agent."""
    gap = dynamic.gaps(crowd, robot.xy)
    nearest = jnp.argsort(gap)[:number]
    body = crowd.bodies
    away = jnp.stack([body.x, body.y], -1)[nearest] - robot.xy
    speed = jnp.stack([body.vx, body.vy], -1)[nearest] - robot.velocity
    here = jnp.isfinite(gap[nearest])[:, None]
    back = -robot.yaw
    place = jnp.clip(terms.to_world(away, back) / UNIT, -2.0, 2.0)
    values = jnp.concatenate([place, terms.to_world(speed, back), jnp.ones((len(nearest), 1))], -1)
    return jnp.where(here, values, 0.0).reshape(-1)


class PeopleTask(Task):
    """Base class of tasks that need a crowd.

    Raises:
      ValidationError: the scenario has none.
    """

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        if parts.dynamic is None:
            raise ValidationError(
                f"config.scenario: found {parts.config.scenario!r} for the task {parts.config.task.name!r}, needed "
                "'dynamic', because it is about moving agents."
            )
        self.dynamic = parts.dynamic
        self.radius = float(parts.robot.planner_radius)

    def time_to_collision(self, crowd: Crowd, robot: RobotPose, which: Bool[Array, " A"]) -> Float[Array, ""]:
        """() s, least time to a collision with one of some agents; long ones are the disc at the nearest point of their
        axis."""
        body, half = crowd.bodies, jnp.asarray(self.dynamic.shapes.half_length)
        away = jnp.stack([body.x, body.y], -1) - robot.xy
        axis = jnp.stack([jnp.cos(body.heading), jnp.sin(body.heading)], -1)
        along = jnp.clip(-(away * axis).sum(-1), -half, half)
        relative = jnp.stack([body.vx, body.vy], -1) - robot.velocity
        reach = jnp.asarray(self.dynamic.shapes.radius) + self.radius
        time = time_to_collision(away + along[:, None] * axis, relative, reach)
        return jnp.where(which, time, MAX_TIME_TO_COLLISION).min()

    def people_observed(self, crowd: Crowd, robot: RobotPose, number: int) -> Float[Array, " n"]:
        """See `nearest_agents`."""
        return nearest_agents(self.dynamic, crowd, robot, number)
