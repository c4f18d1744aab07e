"""Reference agents of the tasks: a scripted baseline from a robot's own observations, and a planner with full knowledge
of the state, the ceiling."""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from ..crowds import half_planes
from ..crowds.crossings import UNSIGNALLED, WALK
from ..envs import NavEnv, NavState
from ..envs.navigation import terms
from ..envs.navigation.tasks.follow import LEADER, FollowPerson
from ..envs.navigation.tasks.multi_robot import MultiRobot
from ..envs.navigation.tasks.object_goal import ObjectGoal
from ..envs.navigation.tasks.route import FollowRoute, RouteState
from ..envs.navigation.tasks.social import SocialNav
from .agents import Agent, Privileged, go_to_goal, keep_distance
from .planner import GOAL_DISTANCE, Planner, RouteField
from .route_fields import build_route_fields
from .route_follower import LOOKAHEAD_DISTANCE, TIMES, RouteFollower, route_point

#: `Planner`'s distance and cost where the comfort of people counts: beyond Hall's intimate distance of 0.45 m, and less
#: than the cost of an obstacle. A distance that must be kept stops it for good in a dense crowd.
COMFORT = (0.6, 0.15)
#: m between the centres of robot and person that the planner keeps, the middle of the band.
FOLLOWING_DISTANCE = 2.2
#: m from the robot's centre to the point that `RouteFollower` drives to the target.
NOSE = 0.6
#: m at which `ObjectWanderer` recognises an object.
DETECTION_DISTANCE = 8.0
#: m within the distance of success at which a stop begins.
STOPPING_MARGIN = 0.05
#: m to the place of `ObjectPlanner` from which it drives straight, and its action there, a share of full speed.
APPROACH_DISTANCE, SLOW = 0.8, 0.3
#: s for which `DeliveryPlanner` avoids other robots, m that it keeps from them, and m/s below which one stands.
HORIZON, ROBOT_MARGIN, STANDING_ROBOT = 2.5, 0.15, 0.05
#: Cost per m/s outside of the velocities that ORCA permits, and s for which a command's turn counts in its velocity.
ORCA_COST, TURNING_TIME = 8.0, 0.8
#: s of the person's walk that the planner looks ahead: to the end of its drives.
ANTICIPATION = TIMES[-1]
#: m/s, mean speed with which the robot comes to a crosswalk, and s by which it has to be on it before people must not
#: begin to cross any more.
APPROACH_SPEED, SPARE_TIME = 1.2, 0.6
#: m of a part of a route for which there is a field, and least straight distance of its ends as a share of its length.
PART_LENGTH, PART_STRAIGHTNESS = 8.0, 0.65
#: m between the robot's centre and a crosswalk before which it waits: COCO's nose is 0.6 m ahead.
KERB_DISTANCE = 0.75


class RouteParts(NamedTuple):
    """Fields of the parts of one route: see `RouteField`, with a leading axis of parts; part: (W,) i32 of each
    waypoint."""

    origin: Any
    cost: Any
    part: Any


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


class ClosedField(NamedTuple):
    """A planner's data in one state: see `RouteField`, and (C,) m from each crosswalk that the robot's centre has to
    keep, minus infinity where it may enter."""

    origin: Any
    cost: Any
    kept: Any


class SignalPlanner(Planner):
    """The ceiling of `FollowRoute`: enters crosswalks while their signals let it, and follows the route part by
    part."""

    def __init__(self, env: NavEnv) -> None:
        super().__init__(env)
        assert isinstance(env.task, FollowRoute)
        self._task, self._crosswalks = env.task, env.task.crosswalks

    def prepare(self, scenes: np.ndarray, rows: np.ndarray) -> RouteParts:
        """See `Planner.prepare`: a field for each part of the routes."""
        bank = self._env.bank
        routes = np.concatenate(
            [bank.episode_start[scenes, rows, None, :2], bank.episode_waypoints[scenes, rows, :, :2]], 1
        )
        counts = bank.episode_num_waypoints[scenes, rows]
        ends = [route_parts(route[: count + 1]) for route, count in zip(routes, counts, strict=True)]
        whose = np.repeat(np.arange(len(rows)), [len(e) for e in ends])
        lines, lengths = [], []
        for route, own in zip(routes.astype(np.float64), ends, strict=True):
            for first, last in zip([0, *own[:-1]], own, strict=True):
                line = route[first : last + 1]
                lines.append(line)
                lengths.append(np.linalg.norm(np.diff(line, axis=0), axis=-1).sum())
        most = max(map(len, lines))
        padded = np.stack([np.concatenate([line, np.repeat(line[-1:], most - len(line), 0)]) for line in lines])
        fields = build_route_fields(
            self._maps, scenes[whose], padded[:, -1], padded, np.array(lengths), self._body.half_width
        )
        number, longest = max(map(len, ends)), routes.shape[1] - 1
        place = np.cumsum([0, *map(len, ends)])
        which = np.stack([np.minimum(place[k] + np.arange(number), place[k + 1] - 1) for k in range(len(rows))])
        # The part in which each waypoint is: the first that ends there or later.
        parts = np.stack([np.searchsorted(own, np.minimum(np.arange(1, longest + 1), own[-1])) for own in ends])
        return RouteParts(*(jnp.asarray(x) for x in (fields.origin[which], fields.cost[which], parts)))

    def act(self, nav: NavState, route: Any) -> Any:
        """See `Planner.act`; with the field of the part of the route on which the robot is."""
        scene, part = nav.sim.scene, route.part[nav.waypoint]
        away = self._crosswalks.away(scene, nav.sim.xpos[self._root, :2])
        # A robot that is nearer already, because one was closed just now, keeps where it is.
        kept = jnp.minimum(KERB_DISTANCE, away - 0.05)
        closed = self.closed(nav) & (away > 0.0)
        data: Any = ClosedField(route.origin[part], route.cost[part], jnp.where(closed, kept, -jnp.inf))
        return super().act(nav, data)

    def closed(self, nav: NavState) -> Any:
        """(C,) bool, the crosswalks that the robot should not enter, because it cannot in time; not the one on which it
        is."""
        state: RouteState = nav.task
        scene, task = nav.sim.scene, self._task
        phase = task.phases(scene, state.offset, nav.steps)
        left = task.cycle.walk_left(state.offset + nav.steps * task.dt)
        arrives = self._crosswalks.away(scene, task.pose(nav.sim).xy) / APPROACH_SPEED + SPARE_TIME
        enters = (phase == UNSIGNALLED) | ((phase == WALK) & (left > arrives))
        return ~enters & (jnp.arange(len(phase)) != state.inside)

    def _gap(self, scene: Any, pose: Any, route: ClosedField) -> Any:
        to_crosswalk = (self._crosswalks.away(scene, pose[:2]) - route.kept).min()
        return jnp.minimum(super()._gap(scene, pose, route), to_crosswalk)


def route_parts(corners: Float[np.ndarray, "W 2"]) -> list[int]:
    """Rows of the corners (W, 2) m of a route at which its parts end, the last corner among them: parts are at most
    `PART_LENGTH` m long and lead away from their beginning, so that a part is about the shortest path to its end."""
    length = np.linalg.norm(np.diff(corners, axis=0), axis=-1)
    found, first, last = [], 0, len(corners) - 1
    while first < last:
        end = first + 1
        for k in range(first + 2, last + 1):
            along = length[first:k].sum()
            if along > PART_LENGTH or np.linalg.norm(corners[k] - corners[first]) < PART_STRAIGHTNESS * along:
                break
            end = k
        found.append(end)
        first = end
    return found


class ObjectPlanner(Planner):
    """`Planner` that drives to the place of `ObjectGoal` from which the object is within reach, and stops there.

    The planner weighs where its nose is and halts before the place; the last metre is driven straight and slowly.
    """

    def __init__(self, env: NavEnv) -> None:
        super().__init__(env)
        assert isinstance(env.task, ObjectGoal)
        self._task = env.task

    def prepare(self, scenes: np.ndarray, rows: np.ndarray) -> RouteField:
        """See `Planner.prepare`; the field's goal is the place itself, not a disc around it."""
        route = super().prepare(scenes, rows)
        return route._replace(cost=route.cost + GOAL_DISTANCE)

    def act(self, nav: NavState, route: RouteField) -> Any:
        """(2,) waypoint in [-1, 1]."""
        robot = self._task.pose(nav.sim)
        left = terms.to_body(nav.goal[:2] - robot.xy, robot.yaw)
        away = jnp.linalg.norm(left)
        straight = SLOW * left / jnp.maximum(away, 1e-6)
        action = jnp.where(away < APPROACH_DISTANCE, straight, super().act(nav, route))
        there = nav.task.reached & (nav.task.distance < self._task.reach - STOPPING_MARGIN)
        return jnp.where(there, 0.0, action)


class ObjectWanderer(RouteFollower):
    """Searches for the object of `ObjectGoal` along the pavements: it follows the route that the street's table has
    from the same start, drives to the object when the camera has it in view within `DETECTION_DISTANCE` m, and stops
    within reach of it, or where the route ends.

    It knows distances and the route, as `RouteFollower` does, and recognises the object without error, but not where it
    is.
    """

    def __init__(self, env: NavEnv) -> None:
        super().__init__(env)
        assert isinstance(env.task, ObjectGoal)
        self._task = env.task

    def prepare(self, scenes: np.ndarray, rows: np.ndarray) -> Any:
        """(n, W, 3) m, the routes of the street's table."""
        return jnp.asarray(self._task.goals.routes[scenes, self._task.goals.source[scenes, rows]], jnp.float32)

    def act(self, nav: NavState, known: Any = None) -> Any:
        """(2,) waypoint in [-1, 1]."""
        seen, place = self._task.in_view(nav, DETECTION_DISTANCE)
        xy = nav.sim.xpos[self._root, :2]
        here = terms.route_position(xy, nav.start, known)
        ahead = route_point(nav.start, known, here + LOOKAHEAD_DISTANCE)
        left = jnp.linalg.norm(known[-1, :2] - xy)
        stop = (nav.task.reached & (nav.task.distance < self._task.reach - STOPPING_MARGIN)) | (~seen & (left < 1.0))
        return jnp.where(stop, 0.0, self.towards(nav, jnp.where(seen, place, ahead)))


class DeliveryPlanner(Planner):
    """`Planner` for `MultiRobot` to the current end of the route, which avoids the other robots reciprocally.

    Of the commands that keep clear of the street it prefers those whose velocity ORCA permits (van den Berg et al.,
    "Reciprocal n-Body Collision Avoidance", 2011): each robot of a pair takes half of the change that avoids the other
    for `HORIZON` s. Robots that stand for good take none, so these are avoided in full.
    """

    def __init__(self, env: NavEnv) -> None:
        super().__init__(env, people=False)
        assert isinstance(env.task, MultiRobot)
        self._task = env.task

    def prepare(self, scenes: np.ndarray, rows: np.ndarray) -> Any:
        """Fields to the goals and to the starts of n episodes, over the same windows."""
        back = self._fields(scenes, rows, self._env.bank.episode_start[scenes, rows])
        return super().prepare(scenes, rows), back.cost

    def act(self, nav: NavState, route: Any) -> Any:
        """(2,) waypoint in [-1, 1]."""
        there, back = route
        goes_back = jnp.round(nav.task.delivered).astype(jnp.int32) % 2 == 1
        field = there._replace(cost=jnp.where(goes_back, back, there.cost))
        return self._waypoint(self._first_costs(nav, field) + ORCA_COST * self._forbidden(nav))

    def _forbidden(self, nav: NavState) -> Any:
        """(first,) m/s by which the velocity of each command is outside of what ORCA permits."""
        assert nav.crowd is not None
        body, dynamic = nav.crowd.bodies, self._env.dynamic
        assert dynamic is not None
        robot = self._task.pose(nav.sim)
        size = jnp.asarray(dynamic.shapes.radius + dynamic.shapes.half_length)
        share = jnp.where(jnp.hypot(body.vx, body.vy) > STANDING_ROBOT, 0.5, 1.0)
        away = body.x - robot.xy[0], body.y - robot.xy[1]
        lines = half_planes.towards_neighbours(
            apart=away,
            velocity=(robot.velocity[0], robot.velocity[1]),
            other_velocity=(body.vx, body.vy),
            reach=2.0 * size + ROBOT_MARGIN,
            share=share,
            spare=share,
            side=jnp.zeros(()),
            valid=nav.crowd.present,
            horizon=jnp.float32(HORIZON),
            dt=self._env.dt,
        )
        # Where the robot is after half of a turn of the first phase.
        heading = robot.yaw + 0.5 * self.first[:, 1] * TURNING_TIME
        vx, vy = self.first[:, 0] * jnp.cos(heading), self.first[:, 0] * jnp.sin(heading)
        over = jax.vmap(lambda x, y: lines.violation(x, y).max())(vx, vy)
        return jnp.maximum(over, 0.0)


def planner_of(env: NavEnv) -> Privileged:
    """The planner with full knowledge of the state for an environment's task."""
    if isinstance(env.task, FollowPerson):
        return PersonFollower(env)
    if isinstance(env.task, FollowRoute):
        return SignalPlanner(env)
    if isinstance(env.task, SocialNav):
        return Planner(env, comfort=COMFORT)
    if isinstance(env.task, ObjectGoal):
        return ObjectPlanner(env)
    if isinstance(env.task, MultiRobot):
        return DeliveryPlanner(env)
    return Planner(env)


def baseline_of(env: NavEnv) -> tuple[str, Agent | Privileged]:
    """Name and agent of the scripted baseline for an environment's task, which uses `obs["goal"]` alone, or for a
    phrase see `ObjectWanderer`."""
    if isinstance(env.task, ObjectGoal):
        return "wander", ObjectWanderer(env)
    if isinstance(env.task, FollowPerson):
        return "keep_distance", keep_distance
    return "go_to_goal", go_to_goal
