"""`CrossStreet`: cross a road where cars come, at crosswalks with stripes, at which drivers give way, and without.

The measures and their sources:

* Time to collision below 1.5 s as a conflict: Sayed and Zein, "Traffic conflict standards for intersections",
  Transportation Planning and Technology 22 (1999); the same threshold is the default of the Surrogate Safety Assessment
  Model (Gettman and Head, FHWA-RD-03-050, 2003).
* Post-encroachment time: Allen, Shin and Cooper, "Analysis of traffic conflicts and collisions", Transportation
  Research Record 667 (1978): the time from one road user's leaving a place to the other's coming there.
* Delay: Highway Capacity Manual (2000), exhibit 18-13: at crossings without a signal, an average delay of pedestrians
  above 45 s is level of service F, with "very high likelihood of risk-taking".
"""

import functools
from collections.abc import Mapping
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int32, Key
from ml_collections import ConfigDict

from ....crowds import KINDS
from ....crowds.crowd import Crowd
from ....datatypes import RobotSpec, SceneBank, SimState, ValidationError
from ...types import NavState, Result
from ..dynamic import DynamicStreet
from ..scenarios import select_scenes
from . import carriageways, routes
from .carriageways import Carriageways, Road
from .people import MAX_TIME_TO_COLLISION, PeopleTask
from .social import reward_time_to_collision
from .task import Parts
from .traffic import HALF_LENGTH, LANES, Traffic, road_of

#: s, time to a collision, and time between two road users at one place, below which there is a near miss.
NEAR_MISS_TIME, NEAR_MISS_POST_TIME = 1.5, 1.0
#: s of delay at which the time's factor of the score is 0.
MAX_DELAY = 45.0
#: Factors of the score for each near miss and for each stop on the road; chosen here.
NEAR_MISS, STOP = 0.5, 0.8
#: m/s below which the robot stops, and from which on it goes again.
STANDING, GOING = 0.1, 0.3
#: s without a conflict after which the next one is another near miss.
APART = 1.0
#: s, largest reported post-encroachment time.
MAX_POST_TIME = 10.0
#: Number of vehicles of each lane in `privileged`, m by which places are divided, and m/s.
OBSERVED, UNIT, SPEED_UNIT = 2, 10.0, 8.0


class CrossState(NamedTuple):
    """Attributes:
    time: () s, to a collision with a vehicle while the robot is on the road; least: () s, the least so far.
    robot_in, vehicle_in: (2,) bool, whether the robot is in the path of each lane's vehicles, and whether one of them
      is where the robot crosses it. robot_left, vehicle_left: (2,) s since then.
    post: () s, the least post-encroachment time so far.
    near_misses: () number; safe: () s since the last step with a conflict; missed: () bool, whether one began in this
      step.
    stops: () number on the road; stopped: () bool, whether the robot stands.
    waited: () s for which the robot stood beside the road.
    on_road: () bool.
    """

    time: Float[Array, ""]
    least: Float[Array, ""]
    robot_in: Bool[Array, "2"]
    vehicle_in: Bool[Array, "2"]
    robot_left: Float[Array, "2"]
    vehicle_left: Float[Array, "2"]
    post: Float[Array, ""]
    near_misses: Float[Array, ""]
    safe: Float[Array, ""]
    missed: Bool[Array, ""]
    stops: Float[Array, ""]
    stopped: Bool[Array, ""]
    waited: Float[Array, ""]
    on_road: Bool[Array, ""]


class CrossStreet(PeopleTask):
    """Crossing a road with traffic: straight from the pavement 2.5-6 m before a crosswalk to 2.5-6 m behind it.

    The roads are those with two lanes over a crosswalk (`carriageways`); what stands in the lanes is taken away, and
    scenes without such a road are left out. On each lane `config.task.flow` vehicles come per hour (`traffic`). A share
    `config.task.marked` of the crosswalks has stripes, at which drivers give way to the robot as to a pedestrian; the
    others are lowered kerbs without stripes, and drivers give way to nobody there. `proprio` has after the speeds
    whether there are stripes. `privileged` begins its own part with that, has then how far the robot is within the
    kerbs and where it is across and along the road (units of 10 m), and of the `OBSERVED` next vehicles of each lane
    the time to the robot's place (units of 10 s) and the speed (units of 8 m/s).

    Ends: as point goals. Scores of an episode: score: 0 without arriving, else 1 minus the delay's share of 45 s, times
    0.5 for each near miss and 0.8 for each stop on the road; delay: s beyond the route at the robot's top speed.
    near_misses: conflicts, at least 1 s apart. A conflict is a step in which the robot's disc reaches over the kerb and
    the time to a collision with a vehicle, both at constant velocity, is below 1.5 s, or one at which the robot comes
    into the path of a lane's vehicles, or a vehicle to the robot's place there, less than 1 s after the other left it.
    near_miss: 1 if there was one. time_to_collision, post_encroachment_time: s, the least, at most 10. stops: on the
    road. waited: s beside it. marked: 1 if there are stripes. seconds: until the end. Additional terms of reward:
    near_miss and stop (1 in the step in which one begins), and time_to_collision (0 at `config.task.horizon` s, 1 at
    contact).

    Raises:
      ValidationError: a value is out of its range, there is no traffic, or no scene has a road to cross.
    """

    SCORES = (
        "score",
        "near_misses",
        "near_miss",
        "time_to_collision",
        "post_encroachment_time",
        "stops",
        "waited",
        "delay",
        "marked",
        "seconds",
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        options = parts.config.task
        if not options.horizon > NEAR_MISS_TIME:
            raise ValidationError(
                f"config.task.horizon: found {options.horizon:g} s, needed more than the {NEAR_MISS_TIME:g} s of a "
                "near miss."
            )
        assert isinstance(self.dynamic, Traffic)
        self.traffic, self.roads = self.dynamic, self.dynamic.roads
        self.horizon, self.top_speed = float(options.horizon), float(parts.robot.max_speed)

    @classmethod
    def _roads(cls, config: ConfigDict, bank: SceneBank, scenes: Any) -> tuple[dict[int, list[Road]], dict[int, Any]]:
        """The roads of scenes and whether each is marked."""
        share = float(config.task.marked)
        if not 0.0 <= share <= 1.0:
            raise ValidationError(f"config.task.marked: found {share:g}, needed a share of the crosswalks from 0 to 1.")
        roads = {int(z): carriageways.roads_of(bank, int(z)) for z in scenes}
        return roads, carriageways.marked_roads(roads, share)

    @classmethod
    def furnished(cls, config: ConfigDict, bank: SceneBank, robot: RobotSpec) -> SceneBank:
        """See `Task.furnished`: empty lanes, and crosswalks without stripes."""
        del robot
        roads, marked = cls._roads(config, bank, select_scenes(bank, config.scenes))
        return carriageways.unmarked(carriageways.cleared(bank, roads), roads, marked)

    @classmethod
    def episodes(
        cls, config: ConfigDict, bank: SceneBank, robot: RobotSpec, scenes: Int32[np.ndarray, " n"]
    ) -> tuple[SceneBank, Int32[np.ndarray, " n"], Any]:
        """See `Task.episodes`."""
        roads, marked = cls._roads(config, bank, scenes)
        make = functools.partial(carriageways.crossing_routes, roads=roads, robot=robot)
        needed = "a crosswalk between pavements over a road with two lanes"
        bank, usable = routes.with_routes(bank, scenes, robot, f"crossing {carriageways.parameters()}", make, needed)
        used = {int(z): roads[int(z)] for z in usable}
        return bank, usable, Carriageways.of(bank.num_scenes, used, marked)

    @classmethod
    def street(
        cls, config: ConfigDict, bank: SceneBank, scenes: Int32[np.ndarray, " n"], robot: RobotSpec, own: Any
    ) -> DynamicStreet:
        """See `Task.street`."""
        return Traffic(bank, scenes, config.crowd, float(config.task.flow), own, float(config.ctrl_dt), robot)

    def begin(self, key: Key[Array, ""], nav: NavState) -> NavState:
        """The first state of an episode."""
        del key
        zero, late, no = jnp.float32(0.0), jnp.float32(MAX_TIME_TO_COLLISION), jnp.bool_(False)
        long_ago, nobody = jnp.full(LANES, MAX_POST_TIME, jnp.float32), jnp.zeros(LANES, bool)
        # The robot begins at rest, which is no stop.
        state = CrossState(
            time=late,
            least=late,
            robot_in=nobody,
            vehicle_in=nobody,
            robot_left=long_ago,
            vehicle_left=long_ago,
            post=jnp.float32(MAX_POST_TIME),
            near_misses=zero,
            safe=late,
            missed=no,
            stops=zero,
            stopped=jnp.bool_(True),
            waited=zero,
            on_road=no,
        )
        return nav._replace(task=state)

    def advance(self, nav: NavState, sim: SimState, crowd: Crowd | None) -> dict[str, Any]:
        """See `Task.advance`."""
        assert crowd is not None
        before: CrossState = nav.task
        robot = self.pose(sim)
        scene, road = sim.scene, road_of(crowd)
        across, along = jnp.abs(self.roads.beside(scene, road, robot.xy))
        half = self.roads.half[scene, road]
        on_road = (across < half[0] + self.radius) & (along < half[1] + self.radius)
        away = self.time_to_collision(crowd, robot, crowd.present)
        time = jnp.where(on_road, away, MAX_TIME_TO_COLLISION)
        station, aside = self.roads.along(scene, road, robot.xy)
        robot_in = aside < KINDS["car"].radius + self.radius
        lane = self.traffic.lane
        at_place = crowd.present & (jnp.abs(crowd.anchor_x - station[lane]) < HALF_LENGTH + self.radius)
        vehicle_in = (at_place & (lane == jnp.arange(LANES)[:, None])).any(1)
        robot_left = jnp.where(before.robot_in, 0.0, before.robot_left) + self.dt
        vehicle_left = jnp.where(before.vehicle_in, 0.0, before.vehicle_left) + self.dt
        comes = robot_in & ~before.robot_in & ~vehicle_in
        passes = vehicle_in & ~before.vehicle_in & ~robot_in
        posts = jnp.where(comes, vehicle_left, jnp.where(passes, robot_left, MAX_POST_TIME))
        post = jnp.minimum(posts.min(), MAX_POST_TIME)
        conflict = (time < NEAR_MISS_TIME) | (post < NEAR_MISS_POST_TIME)
        missed = conflict & (before.safe >= APART)
        speed = jnp.linalg.norm(robot.velocity)
        stopped = jnp.where(before.stopped, speed < GOING, speed < STANDING)
        state = CrossState(
            time=time,
            least=jnp.minimum(before.least, time),
            robot_in=robot_in,
            vehicle_in=vehicle_in,
            robot_left=robot_left,
            vehicle_left=vehicle_left,
            post=jnp.minimum(before.post, post),
            near_misses=before.near_misses + missed,
            safe=jnp.where(conflict, 0.0, before.safe + self.dt),
            missed=missed,
            stops=before.stops + (on_road & stopped & ~before.stopped),
            stopped=stopped,
            waited=before.waited + self.dt * (stopped & ~on_road),
            on_road=on_road,
        )
        return {"task": state}

    def rewards(self, old: NavState, new: NavState) -> dict[str, Float[Array, ""]]:
        """See `Task.rewards`."""
        state: CrossState = new.task
        return {
            "near_miss": state.missed.astype(jnp.float32),
            "stop": state.stops - old.task.stops,
            "time_to_collision": reward_time_to_collision(state.time, self.horizon),
        }

    def marked(self, nav: NavState) -> Bool[Array, ""]:
        """() bool, whether the crosswalk of the episode has stripes."""
        assert nav.crowd is not None
        return self.roads.marked[nav.sim.scene, road_of(nav.crowd)]

    def scores(self, nav: NavState) -> dict[str, Float[Array, ""]]:
        """See `Task.scores`."""
        state: CrossState = nav.task
        seconds = nav.steps * self.dt
        delay = jnp.maximum(seconds - nav.route_length / self.top_speed, 0.0)
        factor = NEAR_MISS**state.near_misses * STOP**state.stops
        score = (nav.result == Result.GOAL) * jnp.clip(1.0 - delay / MAX_DELAY, 0.0, 1.0) * factor
        values = (
            score,
            state.near_misses,
            state.near_misses > 0.0,
            state.least,
            state.post,
            state.stops,
            state.waited,
            delay,
            self.marked(nav),
            seconds,
        )
        return {name: jnp.asarray(x, jnp.float32) for name, x in zip(self.SCORES, values, strict=True)}

    def proprio(self, nav: NavState) -> tuple[Float[Array, " n"], ...]:
        """See `Task.proprio`."""
        return (self.marked(nav)[None].astype(jnp.float32),)

    def privileged(self, nav: NavState) -> tuple[Float[Array, " n"], ...]:
        """See `Task.privileged`."""
        assert nav.crowd is not None
        crowd, robot = nav.crowd, self.pose(nav.sim)
        scene, road = nav.sim.scene, road_of(crowd)
        place = self.roads.beside(scene, road, robot.xy)
        within = self.roads.half[scene, road, 0] - jnp.abs(place[0])
        station, _ = self.roads.along(scene, road, robot.xy)
        lane = self.traffic.lane
        speed = jnp.hypot(crowd.bodies.vx, crowd.bodies.vy)
        left = station[lane] - crowd.anchor_x - HALF_LENGTH
        # A vehicle that stands far away comes late, one that has passed never.
        time = jnp.where(left < -2.0 * HALF_LENGTH, jnp.inf, jnp.maximum(left, 0.0) / jnp.maximum(speed, 0.1))
        time, speed = time.reshape(LANES, -1), speed.reshape(LANES, -1)
        order = jnp.argsort(time, axis=1)[:, :OBSERVED]
        soon = jnp.minimum(jnp.take_along_axis(time, order, 1) / MAX_TIME_TO_COLLISION, 1.0)
        fast = jnp.take_along_axis(speed, order, 1) / SPEED_UNIT
        told = self.marked(nav).astype(jnp.float32)[None]
        return told, within[None] / UNIT, place / UNIT, jnp.stack([soon, fast], -1).reshape(-1)

    def shown(self, nav: NavState) -> dict[str, Array]:
        """See `Task.shown`."""
        state: CrossState = nav.task
        return {"marked": self.marked(nav), "time": state.time, "misses": state.near_misses, "stops": state.stops}

    def note(self, values: Mapping[str, float]) -> str:
        """See `Task.note`."""
        where = "crosswalk" if values["marked"] else "no crosswalk"
        time = "-" if values["time"] >= MAX_TIME_TO_COLLISION else f"{values['time']:.1f} s"
        return f"{where}   to collision {time}   {values['misses']:.0f} near misses   {values['stops']:.0f} stops"
