"""Reference agents of the tasks: a scripted baseline from a robot's own observations, and a planner with full knowledge
of the state, the ceiling."""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ..crowds import half_planes
from ..crowds.crossings import STOP, UNSIGNALLED, WALK
from ..envs import NavEnv, NavState
from ..envs.navigation import terms
from ..envs.navigation.tasks.cross import CrossStreet
from ..envs.navigation.tasks.deliver import Deliver
from ..envs.navigation.tasks.drop_off import DropOff
from ..envs.navigation.tasks.follow import LEADER, FollowPerson
from ..envs.navigation.tasks.multi_robot import MultiRobot
from ..envs.navigation.tasks.object_goal import ObjectGoal
from ..envs.navigation.tasks.route import FollowRoute, RouteState
from ..envs.navigation.tasks.social import SocialNav
from .agents import Agent, Privileged, go_to_goal, keep_distance
from .doorbell_agent import DoorbellPresser, ParcelDropper
from .gap_agent import GapAcceptor
from .planner import GOAL_DISTANCE, Planner, RouteField, bilinear
from .route_fields import NODE, build_route_fields
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
#: m around the way from one waypoint to the next, margin of the window of its field.
LEG_MARGIN = 5.0
#: m between the robot's centre and a crosswalk before which it waits: COCO's wheels are behind the ramp then, on which
#: it rolls down at a command to stand; and beside others.
KERB_DISTANCE, SIDE_DISTANCE = 2.0, 0.25
#: Cost of a metre to the end of a crosswalk that the robot has to leave; one on the route costs 1.
LEAVING_COST = 3.0
#: Cost of a metre nearer to a closed crosswalk than the robot has to keep, and of being on it. More than what can be
#: gained on the way over it, and less than contact.
NEARER_COST, ENTRY_COST = 10.0, 60.0


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


class RouteLegs(NamedTuple):
    """A planner's data of a route past waypoints in one state: as `RouteField`, whose part is the next waypoint.

    Attributes:
      origin, cost: see `RouteField`, with a leading axis (W,): the fields to the waypoints.
      rest: (W,) cost-metres from each waypoint past the others to the goal.
      places: (W, 2) m, the waypoints; those after the goal repeat it.
      waypoint: () i32, the next one.
      kept: (C,) m from each crosswalk that the robot's centre should keep, minus infinity where it may enter.
      exit_at: (2,) m, middle of the end of a crosswalk by which the robot has to leave it. outwards: (2,) unit vector
        there, 0 if it does not have to.
    """

    origin: Any
    cost: Any
    rest: Any
    places: Any
    waypoint: Any
    kept: Any
    exit_at: Any
    outwards: Any

    def at(self, point: Any) -> Any:
        """See `RouteField.at`."""
        k = self.waypoint
        return bilinear(self.cost, (point - self.origin[k]) / NODE, k) + self.rest[k]

    def part(self, before: Any, xy: Any) -> Any:
        """See `RouteField.part`."""
        return terms.next_waypoint(xy, before, self.places, jnp.int32(len(self.places)))

    def on(self, part: Any) -> "RouteLegs":
        """See `RouteField.on`."""
        return self._replace(waypoint=part)

    def first_part(self) -> Any:
        """See `RouteField.first_part`."""
        return self.waypoint


class SignalPlanner(Planner):
    """The ceiling of `FollowRoute`: drives past the waypoints in their order, enters crosswalks while their signals let
    it, and leaves one on which people must not be any more by the shorter way.

    A closed crosswalk is no obstacle, because contact is a question of yes or no: a robot that comes to stand a
    centimetre too late would have contact whatever it does, and might as well drive on.
    """

    BEGINS_AMONG_AGENTS = True
    AGENT_DEPTH = 2.0

    def __init__(self, env: NavEnv) -> None:
        super().__init__(env)
        assert isinstance(env.task, FollowRoute)
        self._task, self._crosswalks = env.task, env.task.crosswalks

    def prepare(self, scenes: np.ndarray, rows: np.ndarray) -> RouteLegs:
        """See `Planner.prepare`: fields to all waypoints."""
        bank = self._env.bank
        number, places = bank.episode_num_waypoints[scenes, rows], bank.episode_waypoints[scenes, rows, :, :2]
        last = int(number.max())
        which = np.minimum(np.arange(last), number[:, None] - 1)
        places = np.take_along_axis(places, which[..., None], 1).astype(np.float64)
        corners = np.concatenate([bank.episode_start[scenes, rows, None, :2], places], 1).astype(np.float64)
        legs = np.stack([corners[:, :-1], corners[:, 1:]], 2)
        real = np.arange(last) < number[:, None]
        lengths = np.linalg.norm(np.diff(legs, axis=2)[:, :, 0], axis=-1)
        fields = build_route_fields(
            self._maps,
            np.repeat(scenes, number),
            legs[real][:, 1],
            legs[real],
            lengths[real],
            self._body.half_width,
            LEG_MARGIN,
        )
        # Row of each leg's field; those after the goal repeat the last.
        row = (np.cumsum(number) - number)[:, None] + which
        origin, cost = jnp.asarray(fields.origin)[row], jnp.asarray(fields.cost)[row]
        costs = jax.vmap(jax.vmap(lambda c, o, p: bilinear(c, (p - o) / NODE)))(cost, origin, legs[:, :, 0])
        costs = np.where(real, np.asarray(costs, np.float64), 0.0)
        rest = costs[:, ::-1].cumsum(1)[:, ::-1] - costs
        first, none = jnp.zeros(len(rows), jnp.int32), jnp.zeros((len(rows), 2))
        known = origin, cost, jnp.asarray(rest, jnp.float32), jnp.asarray(places, jnp.float32)
        return RouteLegs(*known, waypoint=first, kept=none, exit_at=none, outwards=none)

    def act(self, nav: NavState, route: RouteLegs) -> Any:
        """See `Planner.act`."""
        scene, robot = nav.sim.scene, self._task.pose(nav.sim)
        away = self._crosswalks.away(scene, robot.xy)
        # The nose stays off the next one of the route; past others the way may be narrow.
        next_one = jnp.arange(len(away)) == self._task.light(nav).row
        kept = jnp.where(next_one, KERB_DISTANCE, SIDE_DISTANCE)
        # A robot that is nearer already does not turn round.
        kept = jnp.minimum(kept, away)
        closed = self.closed(nav) & (away > 0.0)
        exit_at, outwards = self._exit(nav)
        kept = jnp.where(closed, kept, -jnp.inf)
        data: Any = route._replace(waypoint=nav.waypoint, kept=kept, exit_at=exit_at, outwards=outwards)
        return super().act(nav, data)

    def _exit(self, nav: NavState) -> tuple[Any, Any]:
        """The end by which the robot leaves a crosswalk sooner, and the direction out there, see `RouteLegs`."""
        state: RouteState = nav.task
        scene, row, robot = nav.sim.scene, state.inside, self._task.pose(nav.sim)
        axis = self._crosswalks.axis[scene, row]
        outwards = jnp.stack([axis, -axis])
        ends = self._crosswalks.centre[scene, row] + self._crosswalks.half[scene, row, 0] * outwards
        left = ((ends - robot.xy) * outwards).sum(-1)
        ahead = outwards @ jnp.stack([jnp.cos(robot.yaw), jnp.sin(robot.yaw)])
        turning = jnp.arccos(jnp.clip(ahead, -1.0, 1.0)) / self._robot.max_yaw_rate
        sooner = jnp.argmin(left / APPROACH_SPEED + turning)
        phase = self._task.phases(scene, state.offset, nav.steps)[row]
        leaves = (row >= 0) & (phase == STOP) & (left.min() > 0.0)
        return ends[sooner], jnp.where(leaves, outwards[sooner], 0.0)

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

    def _more_to_go(self, scene: Any, route: RouteLegs, pose: Any) -> Any:
        to_exit = ((route.exit_at - pose[:2]) * route.outwards).sum()
        away = self._crosswalks.away(scene, pose[:2])
        nearer = jnp.maximum(route.kept - away, 0.0).max()
        enters = ((away <= 0.0) & jnp.isfinite(route.kept)).any()
        return LEAVING_COST * jnp.maximum(to_exit, 0.0) + NEARER_COST * nearer + ENTRY_COST * enters


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
    for `HORIZON` s. A robot that stands takes none, so it is avoided in full, and the look-ahead drives around it: two
    that stand face to face would otherwise wait for each other.
    """

    def __init__(self, env: NavEnv) -> None:
        super().__init__(env)
        assert isinstance(env.task, MultiRobot)
        self._task = env.task

    def prepare(self, scenes: np.ndarray, rows: np.ndarray) -> Any:
        """Fields to the goals and to the starts of n episodes, over the same windows."""
        back = self._fields(scenes, rows, self._env.bank.episode_start[scenes, rows])
        return super().prepare(scenes, rows), back.cost

    def widened(self, known: Any) -> Any:
        """See `Planner.widened`."""
        there, back = known
        return super().widened(there), self._widened(back)

    def act(self, nav: NavState, route: Any) -> Any:
        """(2,) waypoint in [-1, 1]."""
        there, back = route
        goes_back = jnp.round(nav.task.delivered).astype(jnp.int32) % 2 == 1
        field = there._replace(cost=jnp.where(goes_back, back, there.cost))
        commands, costs = self._first_costs(nav, field)
        return self._waypoint(commands, costs + ORCA_COST * self._forbidden(nav, commands))

    def _agents(self, nav: NavState) -> Any:
        agents = super()._agents(nav)
        standing = jnp.hypot(agents[:, 2], agents[:, 3]) <= STANDING_ROBOT
        return agents.at[:, 5].set(jnp.where(standing, agents[:, 5], 0.0))

    def _forbidden(self, nav: NavState, commands: Any) -> Any:
        """(n,) m/s by which the velocity of each of the commands (n, 2) is outside of what ORCA permits."""
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
        heading = robot.yaw + 0.5 * commands[:, 1] * TURNING_TIME
        vx, vy = commands[:, 0] * jnp.cos(heading), commands[:, 0] * jnp.sin(heading)
        over = jax.vmap(lambda x, y: lines.violation(x, y).max())(vx, vy)
        return jnp.maximum(over, 0.0)


def planner_of(env: NavEnv) -> Privileged:
    """The planner with full knowledge of the state for an environment's task."""
    if isinstance(env.task, FollowPerson):
        return PersonFollower(env)
    if isinstance(env.task, FollowRoute):
        return SignalPlanner(env)
    if isinstance(env.task, CrossStreet):
        return GapAcceptor(env)
    if isinstance(env.task, SocialNav):
        return Planner(env, comfort=COMFORT)
    if isinstance(env.task, ObjectGoal):
        return ObjectPlanner(env)
    if isinstance(env.task, MultiRobot):
        return DeliveryPlanner(env)
    if isinstance(env.task, Deliver):
        return DoorbellPresser(env)
    if isinstance(env.task, DropOff):
        return ParcelDropper(env)
    return Planner(env)


def baseline_of(env: NavEnv) -> tuple[str, Agent | Privileged]:
    """Name and agent of the scripted baseline for an environment's task, which uses `obs["goal"]` alone, or for a
    phrase see `ObjectWanderer`."""
    if isinstance(env.task, Deliver):
        return "fixed_height", DoorbellPresser(env, float(np.mean(env.config.task.height)))
    if isinstance(env.task, DropOff):
        return "straight_ahead", ParcelDropper(env, straight=True)
    if isinstance(env.task, ObjectGoal):
        return "wander", ObjectWanderer(env)
    if isinstance(env.task, FollowPerson):
        return "keep_distance", keep_distance
    return "go_to_goal", go_to_goal
