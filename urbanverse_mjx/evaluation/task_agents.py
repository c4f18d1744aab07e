"""Reference agents of the tasks: a scripted baseline from a robot's own observations, and a planner with full knowledge
of the state, the ceiling."""

from typing import Any

import jax.numpy as jnp

from ..envs import NavEnv, NavState
from ..envs.navigation.tasks.follow import LEADER, FollowPerson
from ..envs.navigation.tasks.social import SocialNav
from .agents import Agent, Privileged, go_to_goal, keep_distance
from .planner import Planner
from .route_follower import TIMES, RouteFollower

#: `Planner`'s distance and cost where the comfort of people counts: beyond Hall's intimate distance of 0.45 m, and less
#: than the cost of an obstacle. A distance that must be kept stops it for good in a dense crowd.
COMFORT = (0.6, 0.15)
#: m between the centres of robot and person that the planner keeps, the middle of the band.
FOLLOWING_DISTANCE = 2.2
#: m from the robot's centre to the point that `RouteFollower` drives to the target.
NOSE = 0.6
#: s of the person's walk that the planner looks ahead: to the end of its drives.
ANTICIPATION = TIMES[-1]


class PersonFollower(RouteFollower):
    """`RouteFollower` that drives to a point behind the person of `FollowPerson`, which it always knows."""

    def target(self, nav: NavState, xy: Any) -> Any:
        """(2,) m, the point to drive to from (2,) m."""
        assert nav.crowd is not None
        body = nav.crowd.bodies
        velocity = jnp.stack([body.vx[LEADER], body.vy[LEADER]])
        person = nav.goal[:2] + ANTICIPATION * velocity
        away = person - xy
        return person - (FOLLOWING_DISTANCE - NOSE) * away / jnp.maximum(jnp.linalg.norm(away), 1e-6)


def planner_of(env: NavEnv) -> Privileged:
    """The planner with full knowledge of the state for an environment's task."""
    if isinstance(env.task, FollowPerson):
        return PersonFollower(env)
    if isinstance(env.task, SocialNav):
        return Planner(env, comfort=COMFORT)
    return Planner(env)


def baseline_of(env: NavEnv) -> tuple[str, Agent]:
    """Name and function of the scripted baseline for an environment's task, which uses `obs["goal"]` alone."""
    if isinstance(env.task, FollowPerson):
        return "keep_distance", keep_distance
    return "go_to_goal", go_to_goal
