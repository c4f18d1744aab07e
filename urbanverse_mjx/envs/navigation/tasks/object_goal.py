"""`ObjectGoal`: find an object that a phrase names, "the red postbox", and stop beside it.

Rules and measures are those of object-goal navigation (ObjectNav):

* Batra et al., "ObjectNav Revisited: On Evaluation of Embodied Agents Navigating to Objects" (2020): success is a stop
  within 1.0 m of any object that is meant, from where it can be seen by turning; a stop elsewhere fails.
* Anderson et al., "On Evaluation of Embodied Navigation Agents" (2018): SPL, success weighted by path length.
* Chaplot et al., "Object Goal Navigation using Goal-Oriented Semantic Exploration" (2020): distance to success.
"""

from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, Int32
from ml_collections import ConfigDict

from ....crowds.crowd import Crowd
from ....datatypes import RobotSpec, SceneBank, SimState, ValidationError
from ...types import NavState, Result
from .. import terms
from ..surroundings import Surroundings
from .object_episodes import HIDING, ObjectGoals, sight_points, to_boxes, with_object_episodes
from .task import Parts, RobotPose, Task

#: m/s and rad/s below which a robot stands.
STANDING_SPEED, STANDING_TURN = 0.1, 0.2
#: m/s up to which `at_object` rewards slowness.
SLOW = 1.0


class ObjectState(NamedTuple):
    """Attributes:
    standing: () s for which the robot has stood.
    distance: () m to the nearest of the meant objects.
    nearest: (2,) m, its nearest point.
    reached: () bool, whether the robot is where a stop is a success.
    """

    standing: Float[Array, ""]
    distance: Float[Array, ""]
    nearest: Float[Array, "2"]
    reached: Bool[Array, ""]


class ObjectGoal(Task):
    """Finding a named object.

    An episode begins at a start of the street's table and asks for an object at the end of a path of
    `config.task.path_length` (m, least and greatest), by class, colour and, of several, what it stands next to
    (`object_names`). Where a phrase is true of several objects, any counts. The observation `goal` is the phrase's
    vector, of `object_names.EMBEDDING_SIZE` numbers, in place of the way to the goal. The goal of `privileged` and of
    rewards is the nearest place from which an object that is meant is within reach; `privileged` also has the nearest
    point of such an object in the heading frame (in units of 10 m, at most 2), whether a stop here is a success, and
    the share of `stop_time` for which the robot has stood.

    The robot stops by standing (below 0.1 m/s and 0.2 rad/s) for `config.task.stop_time` s. Ends: as point goals,
    without arriving; GOAL at a stop of the centre within `success_distance` m of the box of an object that is meant,
    with no hull on the line between them at the camera's height; STOPPED at a stop elsewhere. Scores of an episode:
    score: SPL, the route's length over the length driven if that is longer, 0 without success. distance_to_success: m
    from the distance of success at the end, 0 within it. Additional terms of reward: at_object (1 while it stands where
    a stop is a success, less at a speed) and stopped (elsewhere).

    Raises:
      ValidationError: a value is out of its range, or a scene has no object to ask for.
    """

    SCORES = ("score", "distance_to_success")
    GOAL_NAME = "object"

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        goals = parts.own
        assert isinstance(goals, ObjectGoals)
        options = parts.config.task
        if not options.stop_time >= self.dt:
            raise ValidationError(
                f"config.task.stop_time: found {options.stop_time:g} s, needed at least a control step, {self.dt:g} s."
            )
        self.reach, self.stop_time = float(options.success_distance), float(options.stop_time)
        self.goals = goals
        self._which, self._boxes = jnp.asarray(goals.which), jnp.asarray(goals.boxes)
        self._vectors = jnp.asarray(goals.vectors())
        self._hulls = Surroundings(parts.bank, HIDING[1], HIDING[0])
        view = parts.config.vision_config
        half = np.tan(0.5 * np.radians(float(parts.model.camera(parts.robot.camera).fovy[0])))
        #: rad, half the camera's horizontal field of view.
        self.half_view = float(np.arctan(half * view.width / view.height))

    @classmethod
    def episodes(
        cls, config: ConfigDict, bank: SceneBank, robot: RobotSpec, scenes: Int32[np.ndarray, " n"]
    ) -> tuple[SceneBank, Int32[np.ndarray, " n"], Any]:
        """See `Task.episodes`.

        Raises:
          ValidationError: see the class.
        """
        options = config.task
        low, high = (float(x) for x in options.path_length)
        if not 0.0 < low < high:
            raise ValidationError(f"config.task.path_length: found {low:g} to {high:g} m, needed 0 < least < greatest.")
        least = float(robot.planner_radius)
        if not options.success_distance > least:
            raise ValidationError(
                f"config.task.success_distance: found {options.success_distance:g} m, needed more than the robot's "
                f"radius, {least:.2f} m."
            )
        bank, goals = with_object_episodes(bank, scenes.tolist(), robot, float(options.success_distance), (low, high))
        return bank, scenes, goals

    def goal_name(self, scene: int, row: int) -> str:
        """The phrase of an episode."""
        return self.goals.texts[int(self.goals.which[scene, row])]

    def begin(self, key: Any, nav: NavState) -> NavState:
        """The first state of an episode."""
        del key
        return nav._replace(task=self._state(nav, nav.sim, jnp.float32(0.0)))

    def advance(self, nav: NavState, sim: SimState, crowd: Crowd | None) -> dict[str, Any]:
        """See `Task.advance`."""
        del crowd
        stands = (jnp.linalg.norm(sim.qvel[:2]) < STANDING_SPEED) & (jnp.abs(sim.qvel[5]) < STANDING_TURN)
        return {"task": self._state(nav, sim, jnp.where(stands, nav.task.standing + self.dt, 0.0))}

    def _state(self, nav: NavState, sim: SimState, standing: Float[Array, ""]) -> ObjectState:
        xy = self.pose(sim).xy
        distance, nearest, seen = self.sight(sim.scene, nav.episode, xy)
        best = jnp.argmin(distance)
        reached = ((distance <= self.reach) & seen).any()
        return ObjectState(standing, distance[best], nearest[best], reached)

    def sight(
        self, scene: Int[Array, ""], row: Int[Array, ""], xy: Float[Array, "2"]
    ) -> tuple[Float[Array, " I"], Float[Array, "I 2"], Bool[Array, " I"]]:
        """(I,) m from a point to the objects that an episode asks for, the nearest points (I, 2) m of these, and
        whether no hull is on the line to each."""
        distance, nearest = to_boxes(jnp, xy, self._boxes[self._which[scene, row]])
        line = sight_points(jnp, xy, nearest, distance)
        return distance, nearest, (self._hulls.distances(scene, line)[..., 0] > 0.0).all(0)

    def in_view(self, nav: NavState, reach: float) -> tuple[Bool[Array, ""], Float[Array, "2"]]:
        """() bool, whether the camera has an object that is meant within `reach` m in view, and the nearest point (2,)
        m of the nearest such object."""
        robot: RobotPose = self.pose(nav.sim)
        distance, nearest, free = self.sight(nav.sim.scene, nav.episode, robot.xy)
        away = terms.to_world(nearest - robot.xy, -robot.yaw)
        ahead = jnp.abs(jnp.arctan2(away[:, 1], away[:, 0])) < self.half_view
        seen = ahead & free & (distance < reach)
        return seen.any(), nearest[jnp.argmin(jnp.where(seen, distance, jnp.inf))]

    def result(self, nav: NavState, result: Int[Array, ""]) -> Int[Array, ""]:
        """See `Task.result`."""
        state: ObjectState = nav.task
        ended = (result != Result.RUNNING) & (result != Result.TIMEOUT)
        # Half a step of tolerance, because the time is a sum of steps.
        stopped = (state.standing > self.stop_time - 0.5 * self.dt) & ~ended
        how = jnp.where(state.reached, Result.GOAL, Result.STOPPED)
        return jnp.where(stopped, how, result).astype(jnp.int32)

    def rewards(self, old: NavState, new: NavState) -> dict[str, Float[Array, ""]]:
        """See `Task.rewards`."""
        del old
        state: ObjectState = new.task
        slow = jnp.clip(1.0 - jnp.linalg.norm(new.sim.qvel[:2]) / SLOW, 0.0, 1.0)
        return {"at_object": state.reached * slow, "stopped": jnp.float32(new.result == Result.STOPPED)}

    def scores(self, nav: NavState) -> dict[str, Float[Array, ""]]:
        """See `Task.scores`."""
        state: ObjectState = nav.task
        spl = nav.route_length / jnp.maximum(jnp.maximum(nav.driven, nav.route_length), 1e-6)
        return {
            "score": jnp.where(nav.result == Result.GOAL, spl, 0.0),
            "distance_to_success": jnp.maximum(state.distance - self.reach, 0.0),
        }

    def goal_observation(self, nav: NavState) -> Float[Array, " n"]:
        """See `Task.goal_observation`."""
        return self._vectors[self._which[nav.sim.scene, nav.episode]]

    def privileged(self, nav: NavState) -> tuple[Float[Array, " n"], ...]:
        """See `Task.privileged`."""
        state: ObjectState = nav.task
        robot = self.pose(nav.sim)
        away = jnp.clip(terms.to_body(state.nearest - robot.xy, robot.yaw) / 10.0, -2.0, 2.0)
        told = jnp.stack([state.reached.astype(jnp.float32), jnp.minimum(state.standing / self.stop_time, 1.0)])
        return away, told
