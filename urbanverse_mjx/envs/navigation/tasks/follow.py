"""`FollowPerson`: keep 1.5-3 m from one pedestrian through a crowd, and keep them in sight.

Person following is the social task of Habitat 3.0 (Puig et al., 2023), which scores the share of steps in a band of
distances in which the robot faces the person; the band here is wider, because COCO is 0.9 m long.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, Key

from ....crowds import goal_fields
from ....crowds.behaviours import ROAM
from ....crowds.bodies import Bodies
from ....crowds.crowd import Crowd
from ....datatypes import SimState, ValidationError
from ...types import NavState, Result
from .. import terms
from ..encounters import route_pose
from ..surroundings import Surroundings
from .people import PeopleTask
from .task import Parts, RobotPose

#: Slot of the pedestrian to follow.
LEADER = 0
#: Number of other agents in `privileged`.
OBSERVED = 5
#: m around the leader's first place without other agents.
FREE_RADIUS = 1.2
#: m above ground between which a hull hides the upper body of a person from a camera at 0.6 m.
HIDING = (0.9, 1.3)
#: Number of points at which a line of sight is checked.
POINTS = 24


class FollowState(NamedTuple):
    """Attributes:
    in_sight: () bool, whether the camera has the person in view.
    seen: (3,) m, where the person was seen last.
    unseen: () s since then.
    kept: () steps within the band and in sight; watched: () steps in sight.
    distance: () m between the centres of robot and person; distances: () its sum over the steps.
    """

    in_sight: Bool[Array, ""]
    seen: Float[Array, "3"]
    unseen: Float[Array, ""]
    kept: Float[Array, ""]
    watched: Float[Array, ""]
    distance: Float[Array, ""]
    distances: Float[Array, ""]


def reward_in_band(distance: Float[Array, ""], band: tuple[float, float]) -> Float[Array, ""]:
    """1 within the band (m), falling to 0 with the distance from it: 0.24 at 1 m, 0.04 at 2 m."""
    outside = jnp.maximum(jnp.maximum(band[0] - distance, distance - band[1]), 0.0)
    return 1.0 - jnp.tanh(outside)


class FollowPerson(PeopleTask):
    """Following one person, who walks about as others do.

    The person begins `config.task.start_distance` m ahead on the route of the episode's row and goes on from there to
    goals anywhere in the street, at a speed drawn from `config.task.speed` (m/s). In sight: within the horizontal field
    of view of the robot's camera and `sight` m, on a line that neither a hull (of 0.9-1.3 m above ground) nor another
    agent crosses. The observation `goal` is the place at which the person was seen last, as a detector or a tag tells
    it; `proprio` has, after the speeds, whether the person is in sight. The goal of `privileged` is where the person
    is; it also has the person's velocity in the heading frame (m/s), whether they are in sight, the share of
    `lost_time` for which they are not, and the `OBSERVED` nearest agents, see `people_observed`.

    Ends: as point goals, without arriving; LOST after `lost_time` s out of sight or at `lost_distance` m; at the time
    limit GOAL with a score of at least `success_share`, else TIMEOUT. Scores of an episode: score: share of the time
    limit within the `band` (m, between centres) and in sight; steps after an early end count as outside. in_sight:
    share of the time limit in sight. distance: m, mean until the end. Route completion is the share of the person's
    path to which the robot has come. Additional terms of reward: band (1 within it, less outside), in_sight, kept
    (both) and lost.

    Raises:
      ValidationError: a value is out of its range, there is no pedestrian or no crowd.
    """

    SCORES = ("score", "in_sight", "distance")
    GOAL_NAME = "person"

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        options = parts.config.task
        low, high = (float(x) for x in options.band)
        if not 0.0 < low < high:
            raise ValidationError(f"config.task.band: found {low:g} to {high:g} m, needed 0 < least < greatest.")
        slow, fast = (float(x) for x in options.speed)
        if not 0.0 < slow <= fast:
            raise ValidationError(f"config.task.speed: found {slow:g} to {fast:g} m/s, needed 0 < least <= greatest.")
        if not high < options.lost_distance <= options.sight:
            raise ValidationError(
                f"config.task.lost_distance: found {options.lost_distance:g} m, needed more than the band's {high:g} m "
                f"and at most sight, {options.sight:g} m."
            )
        if not options.lost_time > 0.0:
            raise ValidationError(f"config.task.lost_time: found {options.lost_time:g} s, needed a time above 0.")
        if not 0.0 < options.success_share <= 1.0:
            raise ValidationError(
                f"config.task.success_share: found {options.success_share:g}, needed a share above 0 and at most 1."
            )
        if "pedestrian" not in self.dynamic.kinds:
            raise ValidationError("config.crowd.slots: found no pedestrian, needed one to follow.")
        self.band, self.speed = (low, high), (slow, fast)
        self.options = options
        view = parts.config.vision_config
        half = np.tan(0.5 * np.radians(float(parts.model.camera(parts.robot.camera).fovy[0])))
        #: rad, half the horizontal field of view.
        self.half_view = float(np.arctan(half * view.width / view.height))
        self._hulls = Surroundings(parts.bank, HIDING[1], HIDING[0])
        self._others = jnp.arange(len(self.dynamic.kinds)) != LEADER

    def begin(self, key: Key[Array, ""], nav: NavState) -> NavState:
        """The first state of an episode, with the person ahead of the robot."""
        assert nav.crowd is not None
        crowd = self._placed(jax.random.fold_in(key, 301), nav.crowd, nav.sim.scene, nav)
        person = self._person(crowd, nav.goal[2])
        zero = jnp.float32(0.0)
        distance = jnp.linalg.norm(person[:2] - nav.start[:2])
        state = FollowState(jnp.bool_(True), person, zero, zero, zero, distance, zero)
        new = nav._replace(crowd=crowd, task=state, **self._target(nav, person), route_length=distance)
        return new._replace(goal_distance=distance, num_waypoints=jnp.int32(1))

    def _placed(self, key: Key[Array, ""], crowd: Crowd, scene: Int[Array, ""], nav: NavState) -> Crowd:
        """The crowd with the person on the route, walking along it, and nobody else there."""
        x, y, heading = route_pose(nav.start, nav.waypoints, float(self.options.start_distance))
        model, row = self.dynamic.model, self.dynamic.row(scene)
        routes, node = model.tables.routes["foot"], goal_fields.RULES["foot"].node
        goals = jnp.arange(routes.goal.shape[1])
        many = jnp.broadcast_to(x, goals.shape), jnp.broadcast_to(y, goals.shape)
        course = goal_fields.heading_at(routes, node, row, goals, *many)
        # Of the goals in whose direction the route leads, the best; the others are behind the robot.
        along = jnp.where(goals < routes.num_goals[row], jnp.cos(course - heading), -2.0)
        goal = jnp.argmax(along).astype(jnp.int32)
        body = crowd.bodies
        near = (body.x - x) ** 2 + (body.y - y) ** 2 < FREE_RADIUS**2
        speed = jax.random.uniform(key, minval=self.speed[0], maxval=self.speed[1])
        zero = jnp.zeros(())

        def put(column: Any, value: Any) -> Any:
            return column.at[LEADER].set(value)

        values = (x, y, zero, zero, heading)
        return crowd._replace(
            bodies=Bodies(*(put(column, value) for column, value in zip(body, values, strict=True))),
            present=put(crowd.present & ~near, True),
            speed=put(crowd.speed, speed),
            goal=put(crowd.goal, goal),
            mode=put(crowd.mode, ROAM),
            blocked=put(crowd.blocked, 0.0),
            still=put(crowd.still, 0.0),
        )

    def _person(self, crowd: Crowd, height: Float[Array, ""]) -> Float[Array, "3"]:
        return jnp.stack([crowd.bodies.x[LEADER], crowd.bodies.y[LEADER], height])

    def _target(self, nav: NavState, person: Float[Array, "3"]) -> dict[str, Any]:
        return {"goal": person, "waypoints": jnp.broadcast_to(person, nav.waypoints.shape)}

    def completed(
        self, nav: NavState, p_xy: Float[Array, "2"], distance: Float[Array, ""], driven: Float[Array, ""]
    ) -> Float[Array, ""]:
        """See `Task.completed`; the person's path may lead anywhere."""
        del p_xy
        return jnp.clip(nav.route_length - distance, 0.0, driven)

    def advance(self, nav: NavState, sim: SimState, crowd: Crowd | None) -> dict[str, Any]:
        """See `Task.advance`."""
        assert crowd is not None
        before: FollowState = nav.task
        robot = self.pose(sim)
        person = self._person(crowd, nav.goal[2])
        distance = jnp.linalg.norm(person[:2] - robot.xy)
        in_sight = self.sees(sim.scene, crowd, robot)
        kept = in_sight & (distance >= self.band[0]) & (distance <= self.band[1])
        state = FollowState(
            in_sight=in_sight,
            seen=jnp.where(in_sight, person, before.seen),
            unseen=jnp.where(in_sight, 0.0, before.unseen + self.dt),
            kept=before.kept + kept,
            watched=before.watched + in_sight,
            distance=distance,
            distances=before.distances + distance,
        )
        length = nav.route_length + jnp.linalg.norm(person[:2] - nav.goal[:2])
        return {"task": state, "route_length": length, **self._target(nav, person)}

    def sees(self, scene: Int[Array, ""], crowd: Crowd, robot: RobotPose) -> Bool[Array, ""]:
        """() bool, whether the robot's camera has the person in view; see the class."""
        person = jnp.stack([crowd.bodies.x[LEADER], crowd.bodies.y[LEADER]])
        away = person - robot.xy
        distance = jnp.linalg.norm(away)
        ahead = terms.to_body(away, robot.yaw)
        in_view = (jnp.abs(jnp.arctan2(ahead[1], ahead[0])) < self.half_view) & (distance < self.options.sight)
        points = robot.xy + jnp.linspace(0.0, 1.0, POINTS)[:, None] * away
        behind_hull = (self._hulls.distances(scene, points)[:, 0] <= 0.0).any()
        places = jnp.stack([crowd.bodies.x, crowd.bodies.y], -1) - robot.xy
        unit = away / jnp.maximum(distance, 1e-6)
        along = places @ unit
        aside = jnp.abs(places[:, 0] * unit[1] - places[:, 1] * unit[0])
        radius = jnp.asarray(self.dynamic.shapes.radius)
        between = (along > 0.0) & (along < distance) & (aside < radius) & crowd.present & self._others
        return in_view & crowd.present[LEADER] & ~behind_hull & ~between.any()

    def result(self, nav: NavState, result: Int[Array, ""]) -> Int[Array, ""]:
        """See `Task.result`."""
        state: FollowState = nav.task
        lost = (state.unseen > self.options.lost_time) | (state.distance > self.options.lost_distance)
        well = state.kept >= self.options.success_share * self.episode_length
        at_end = jnp.where(well, Result.GOAL, Result.TIMEOUT)
        result = jnp.where((result == Result.RUNNING) & lost, Result.LOST, result)
        return jnp.where(result == Result.TIMEOUT, at_end, result).astype(jnp.int32)

    def rewards(self, old: NavState, new: NavState) -> dict[str, Float[Array, ""]]:
        """See `Task.rewards`."""
        del old
        state: FollowState = new.task
        band, in_sight = reward_in_band(state.distance, self.band), state.in_sight.astype(jnp.float32)
        kept = in_sight * ((state.distance >= self.band[0]) & (state.distance <= self.band[1]))
        return {"band": band, "in_sight": in_sight, "kept": kept, "lost": jnp.float32(new.result == Result.LOST)}

    def scores(self, nav: NavState) -> dict[str, Float[Array, ""]]:
        """See `Task.scores`."""
        state: FollowState = nav.task
        return {
            "score": state.kept / self.episode_length,
            "in_sight": state.watched / self.episode_length,
            "distance": state.distances / jnp.maximum(nav.steps, 1),
        }

    def observed_goal(self, nav: NavState) -> Float[Array, "3"]:
        """(3,) m, where the person was seen last."""
        return nav.task.seen

    def proprio(self, nav: NavState) -> tuple[Float[Array, " n"], ...]:
        """See `Task.proprio`."""
        return (nav.task.in_sight.astype(jnp.float32)[None],)

    def privileged(self, nav: NavState) -> tuple[Float[Array, " n"], ...]:
        """See `Task.privileged`."""
        assert nav.crowd is not None
        state: FollowState = nav.task
        robot = self.pose(nav.sim)
        body = nav.crowd.bodies
        velocity = terms.to_body(jnp.stack([body.vx[LEADER], body.vy[LEADER]]), robot.yaw)
        unseen = state.unseen / self.options.lost_time
        told = jnp.stack([state.in_sight.astype(jnp.float32), unseen])
        others = nav.crowd._replace(present=nav.crowd.present & self._others)
        return velocity, told, self.people_observed(others, robot, OBSERVED)
