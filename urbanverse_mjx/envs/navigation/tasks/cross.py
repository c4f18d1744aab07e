"""`CrossStreet`: cross a road where vehicles come, at crosswalks at which drivers give way and at which they do not.

The measures and their sources:

* Time to collision below 1.5 s as a conflict: Sayed and Zein, "Traffic conflict standards for intersections",
  Transportation Planning and Technology 22 (1999); the same threshold is the default of the Surrogate Safety Assessment
  Model (Gettman and Head, FHWA-RD-03-050, 2003).
* Delay: Highway Capacity Manual (2000), exhibit 18-13: at crossings without a signal, an average delay of pedestrians
  above 45 s is level of service F, with "very high likelihood of risk-taking".
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int32, Key
from ml_collections import ConfigDict

from ....crowds.crossings import Precedence
from ....crowds.crowd import Crowd
from ....datatypes import RobotSpec, SceneBank, SimState, ValidationError
from ...types import NavState, Result
from . import routes
from .crosswalks import Crosswalks
from .people import MAX_TIME_TO_COLLISION, PeopleTask
from .route import VEHICLES
from .task import Parts

#: s, time to a collision with a vehicle below which there is a near miss.
NEAR_MISS_TIME = 1.5
#: s of delay at which the time's factor of the score is 0.
MAX_DELAY = 45.0
#: Factors of the score for each near miss and for each stop on the road; chosen here.
NEAR_MISS, STOP = 0.5, 0.8
#: m/s below which the robot stops, and from which on it goes again.
STANDING, GOING = 0.1, 0.3
#: s for which times to collisions have to be longer before the next near miss counts as another one.
APART = 1.0
#: Number of vehicles in `privileged`, and m by which their places are divided.
OBSERVED, UNIT = 4, 10.0
#: Number folded into an episode's key for the right of way, and number of crosswalks that `crossings` knows.
_PRIORITY, _NUMBERS = 303, 256


class CrossState(NamedTuple):
    """Attributes:
    priority: () bool, whether drivers give way to the robot at crosswalks.
    time: () s, to a collision with a vehicle; least: () s, the least so far.
    near_misses: () number; safe: () s since the last step with a time below the threshold.
    stops: () number on the road; stopped: () bool, whether the robot stands.
    waited: () s for which the robot stood beside the road.
    on_road: () bool.
    missed: () bool, whether a near miss began in this step.
    """

    priority: Bool[Array, ""]
    time: Float[Array, ""]
    least: Float[Array, ""]
    near_misses: Float[Array, ""]
    safe: Float[Array, ""]
    stops: Float[Array, ""]
    stopped: Bool[Array, ""]
    waited: Float[Array, ""]
    on_road: Bool[Array, ""]
    missed: Bool[Array, ""]


class CrossStreet(PeopleTask):
    """Crossing a road with traffic: from the pavement 2-6 m before a crosswalk that routes of vehicles pass to 2-6 m
    behind it (`routes.crossing_routes`); scenes without such a crosswalk are left out.

    In a share `config.task.priority` of the episodes drivers give way to the robot at crosswalks as to a pedestrian; in
    the others they do not, as at a place without a crosswalk, though they brake for what stands in their lane. (The
    kerbs of the scenes are lowered at crosswalks only.) `proprio` has after the speeds, and `privileged` begins its own
    part with, whether they do. `privileged` has then whether the robot is on the road, the time to a collision (units
    of 10 s), and the `OBSERVED` nearest vehicles: position (units of 10 m) and relative velocity (units of 5 m/s) in
    the heading frame, and whether there is one.

    Ends: as point goals. Scores of an episode: score: 0 without arriving, else 1 minus the delay's share of 45 s, times
    0.5 for each near miss and 0.8 for each stop on the road; delay: s beyond the route at the robot's top speed.
    near_misses: times that the time to a collision with a vehicle, both at constant velocity, fell below 1.5 s.
    time_to_collision: s, the least. stops: on the road. waited: s beside it. priority: 1 if drivers give way. seconds:
    until the end. Additional terms of reward: near_miss and stop (1 in the step in which one begins), and
    time_to_collision (0 at `config.task.horizon` s, 1 at contact).

    Raises:
      ValidationError: a value is out of its range, there is no vehicle or no crowd, or no scene has a road to cross.
    """

    SCORES = ("score", "near_misses", "time_to_collision", "stops", "waited", "delay", "priority", "seconds")

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        options = parts.config.task
        if not 0.0 <= options.priority <= 1.0:
            raise ValidationError(
                f"config.task.priority: found {options.priority:g}, needed a share of the episodes from 0 to 1."
            )
        if not options.horizon > NEAR_MISS_TIME:
            raise ValidationError(
                f"config.task.horizon: found {options.horizon:g} s, needed more than the {NEAR_MISS_TIME:g} s of a "
                "near miss."
            )
        #: (A,) bool, which agents are vehicles.
        self.vehicles = jnp.array([kind in VEHICLES for kind in self.dynamic.kinds])
        if not bool(self.vehicles.any()):
            raise ValidationError(
                f"config.crowd.slots: found no vehicle, needed at least one of {', '.join(VEHICLES)}."
            )
        self.options = options
        self.crosswalks = Crosswalks.of(parts.bank, [int(z) for z in parts.scenes], self.dynamic.model.tables.crossings)
        self.top_speed = float(parts.robot.max_speed)

    @classmethod
    def episodes(
        cls, config: ConfigDict, bank: SceneBank, robot: RobotSpec, scenes: Int32[Any, " n"]
    ) -> tuple[SceneBank, Int32[Any, " n"], Any]:
        """See `Task.episodes`."""

        def make(scene: int) -> routes.Routes | None:
            return routes.crossing_routes(bank, scene, robot)

        found = routes.with_routes(
            bank, scenes, robot, "crossing", make, "a crosswalk that routes of vehicles pass, between pavements"
        )
        return (*found, None)

    def begin(self, key: Key[Array, ""], nav: NavState) -> NavState:
        """The first state of an episode."""
        priority = jax.random.uniform(jax.random.fold_in(key, _PRIORITY)) < self.options.priority
        zero, late, no = jnp.float32(0.0), jnp.float32(MAX_TIME_TO_COLLISION), jnp.bool_(False)
        # The robot begins at rest, which is no stop.
        state = CrossState(priority, late, late, zero, late, zero, jnp.bool_(True), zero, no, no)
        return nav._replace(task=state)

    def rights(self, nav: NavState) -> Precedence:
        """See `Task.rights`."""
        robot = self.pose(nav.sim)
        return Precedence(jnp.zeros(_NUMBERS, jnp.int32), robot.xy[0], robot.xy[1], robot.yaw, nav.task.priority)

    def advance(self, nav: NavState, sim: SimState, crowd: Crowd | None) -> dict[str, Any]:
        """See `Task.advance`."""
        assert crowd is not None
        before: CrossState = nav.task
        robot = self.pose(sim)
        time = self.time_to_collision(crowd, robot, crowd.present & self.vehicles)
        near = time < NEAR_MISS_TIME
        missed = near & (before.safe >= APART)
        speed = jnp.linalg.norm(robot.velocity)
        stopped = jnp.where(before.stopped, speed < GOING, speed < STANDING)
        on_road = self.crosswalks.away(sim.scene, robot.xy).min() <= 0.0
        state = CrossState(
            priority=before.priority,
            time=time,
            least=jnp.minimum(before.least, time),
            near_misses=before.near_misses + missed,
            safe=jnp.where(near, 0.0, before.safe + self.dt),
            stops=before.stops + (on_road & stopped & ~before.stopped),
            stopped=stopped,
            waited=before.waited + self.dt * (stopped & ~on_road),
            on_road=on_road,
            missed=missed,
        )
        return {"task": state}

    def rewards(self, old: NavState, new: NavState) -> dict[str, Float[Array, ""]]:
        """See `Task.rewards`."""
        state: CrossState = new.task
        return {
            "near_miss": state.missed.astype(jnp.float32),
            "stop": state.stops - old.task.stops,
            "time_to_collision": jnp.clip(1.0 - state.time / self.options.horizon, 0.0, 1.0),
        }

    def scores(self, nav: NavState) -> dict[str, Float[Array, ""]]:
        """See `Task.scores`."""
        state: CrossState = nav.task
        seconds = nav.steps * self.dt
        delay = jnp.maximum(seconds - nav.route_length / self.top_speed, 0.0)
        factor = NEAR_MISS**state.near_misses * STOP**state.stops
        score = (nav.result == Result.GOAL) * jnp.clip(1.0 - delay / MAX_DELAY, 0.0, 1.0) * factor
        values = (score, state.near_misses, state.least, state.stops, state.waited, delay, state.priority, seconds)
        return {name: jnp.float32(x) for name, x in zip(self.SCORES, values, strict=True)}

    def proprio(self, nav: NavState) -> tuple[Float[Array, " n"], ...]:
        """See `Task.proprio`."""
        return (nav.task.priority[None].astype(jnp.float32),)

    def privileged(self, nav: NavState) -> tuple[Float[Array, " n"], ...]:
        """See `Task.privileged`."""
        assert nav.crowd is not None
        state: CrossState = nav.task
        known = jnp.stack([state.priority, state.on_road, state.time / MAX_TIME_TO_COLLISION])
        vehicles = nav.crowd._replace(present=nav.crowd.present & self.vehicles)
        rows = self.people_observed(vehicles, self.pose(nav.sim), OBSERVED, UNIT).reshape(-1, 5)
        return known, (rows * jnp.array([1.0, 1.0, 0.2, 0.2, 1.0])).reshape(-1)

    def shown(self, nav: NavState) -> dict[str, Array]:
        """See `Task.shown`."""
        state: CrossState = nav.task
        return {"priority": state.priority, "time": state.time, "misses": state.near_misses, "stops": state.stops}

    def note(self, values: Mapping[str, float]) -> str:
        """See `Task.note`."""
        who = "drivers give way" if values["priority"] else "drivers do not give way"
        time = "-" if values["time"] >= MAX_TIME_TO_COLLISION else f"{values['time']:.1f} s"
        return f"{who}   to collision {time}   {values['misses']:.0f} near misses   {values['stops']:.0f} stops"
