"""`MultiRobot`: several robots deliver in one street, each by a policy of its own that knows nothing of the others.

The measure is throughput, tasks finished in a time, that of lifelong multi-agent path finding (Ma et al., "Lifelong
Multi-Agent Path Finding for Online Pickup and Delivery Tasks", 2017; Stern et al., "Multi-Agent Pathfinding:
Definitions, Variants, and Benchmarks", 2019). Robots of one street are consecutive envs (`fleet`) that share the
policy's parameters (Gupta et al., "Cooperative Multi-agent Control Using Deep Reinforcement Learning", 2017).
"""

import dataclasses
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, Int32
from ml_collections import ConfigDict

from ....crowds.crowd import Crowd
from ....datatypes import RobotSpec, SceneBank, SimState, ValidationError
from ...types import NavState, Result
from .. import terms
from ..fleet import START_SPACING, Fleet, fleet_size
from .people import PeopleTask
from .task import Parts

#: Most routes of a street that are used: those from the starts nearest to the middle one, so that robots meet.
MOST_ROWS = 32
#: m, upper limit of the reported distance to another robot.
MAX_GAP = 30.0


class DeliveryState(NamedTuple):
    """Attributes:
    delivered: () number of ends of the route that the robot has reached.
    arrived: () bool, whether it reached one in the last step.
    gap: () m, least distance between the disc around the robot and another robot's body.
    """

    delivered: Float[Array, ""]
    arrived: Bool[Array, ""]
    gap: Float[Array, ""]


class MultiRobot(PeopleTask):
    """Deliveries by several robots in one street.

    Each robot drives from the start of its row's route to the goal, then back to the start, and so on; an end counts as
    reached within `config.task.arrival_distance` m, and there the next delivery begins at once. `config.task.robots`
    consecutive envs are the robots of a street: they collide with each other, see each other, and use one policy. The
    street's routes are those of at most `config.task.route_length` m from `MOST_ROWS` starts near each other, at least
    `START_SPACING` m apart. A robot whose episode ends early stands where it is in evaluations; in training it begins
    anew in the same street.

    Ends: as point goals, without arriving; HIT_AGENT is contact with another robot; at the time limit GOAL after at
    least `config.task.deliveries` deliveries, else TIMEOUT. Scores of an episode: score: throughput, deliveries per
    minute of the time limit times the number of robots, so that its mean over the robots of a street is that of the
    street; what is left after an early end counts. deliveries: of this robot. robot_contact: 1 if it touched another
    robot, else 0. robot_distance: m, the least distance to another robot, at most 30. Additional terms of reward:
    approach (m nearer to the current end) and delivered (1 in the step that reaches one). `privileged` has the nearest
    of the others, see `people_observed`.

    Raises:
      ValidationError: a value is out of its range, or a street has too few starts.
    """

    SCORES = ("score", "deliveries", "robot_contact", "robot_distance")
    GOAL_NAME = "delivery"

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        assert isinstance(self.dynamic, Fleet)
        options = parts.config.task
        if not options.arrival_distance > 0.0:
            raise ValidationError(
                f"config.task.arrival_distance: found {options.arrival_distance:g} m, needed a distance above 0."
            )
        if options.deliveries < 1:
            raise ValidationError(f"config.task.deliveries: found {options.deliveries}, needed 1 or more.")
        self.robots, self.arrival = self.dynamic.size, float(options.arrival_distance)
        self.needed = int(options.deliveries)
        bank = parts.bank
        self._start = jnp.asarray(bank.episode_start[..., :3])
        self._waypoints, self._goal = jnp.asarray(bank.episode_waypoints), jnp.asarray(bank.episode_goal)
        self._number = jnp.asarray(bank.episode_num_waypoints, jnp.int32)

    @classmethod
    def episodes(
        cls, config: ConfigDict, bank: SceneBank, robot: RobotSpec, scenes: Int32[np.ndarray, " n"]
    ) -> tuple[SceneBank, Int32[np.ndarray, " n"], Any]:
        """See `Task.episodes`.

        Raises:
          ValidationError: see the class.
        """
        del robot
        low, high = (float(x) for x in config.task.route_length)
        if not 0.0 < low < high:
            raise ValidationError(
                f"config.task.route_length: found {low:g} to {high:g} m, needed 0 < least < greatest."
            )
        size, names = fleet_size(config), ("start", "goal", "waypoints", "num_waypoints", "length")
        if not size:
            raise ValidationError(f"config.task.robots: found {config.task.get('robots', None)}, needed 2 to 8.")
        tables = {f"episode_{name}": np.array(getattr(bank, f"episode_{name}")) for name in names}
        number = np.array(bank.num_episodes)
        for scene in scenes.tolist():
            rows = _spread(bank, scene, (low, high))
            if len(rows) < size:
                raise ValidationError(
                    f"scene {bank.scene_ids[scene]!r}: found {len(rows)} starts {START_SPACING:g} m apart with a route "
                    f"of {low:g} to {high:g} m, needed {size}; widen config.task.route_length or take fewer robots."
                )
            number[scene] = len(rows)
            kept = np.resize(rows, tables["episode_length"].shape[1])
            for table in tables.values():
                table[scene] = table[scene, kept]
        return dataclasses.replace(bank, num_episodes=number, **tables), scenes, None

    def begin(self, key: Any, nav: NavState) -> NavState:
        """The first state of an episode."""
        del key
        assert nav.crowd is not None
        return nav._replace(task=DeliveryState(jnp.float32(0.0), jnp.bool_(False), self._gap(nav.crowd, nav.sim)))

    def _gap(self, crowd: Crowd, sim: SimState) -> Float[Array, ""]:
        gap = self.dynamic.gaps(crowd, self.pose(sim).xy).min() - self.radius
        return jnp.clip(gap, 0.0, MAX_GAP)

    def route(
        self, scene: Int[Array, ""], row: Int[Array, ""], back: Bool[Array, ""]
    ) -> tuple[Float[Array, "3"], Float[Array, "W 3"], Int[Array, ""]]:
        """Start (3,), waypoints (W, 3) and their number of a row's route, or of its way back."""
        start, waypoints, number = self._start[scene, row], self._waypoints[scene, row], self._number[scene, row]
        places = jnp.arange(len(waypoints))
        # From the last waypoint but one to the first, then the start, which repeats.
        turned = jnp.where((places < number - 1)[:, None], waypoints[jnp.maximum(number - 2 - places, 0)], start)
        return jnp.where(back, self._goal[scene, row], start), jnp.where(back, turned, waypoints), number

    def advance(self, nav: NavState, sim: SimState, crowd: Crowd | None) -> dict[str, Any]:
        """See `Task.advance`."""
        assert crowd is not None
        before: DeliveryState = nav.task
        arrived = jnp.linalg.norm(nav.goal[:2] - self.pose(sim).xy) < self.arrival
        delivered = before.delivered + arrived
        back = jnp.round(delivered).astype(jnp.int32) % 2 == 1
        start, waypoints, number = self.route(sim.scene, nav.episode, back)
        state = DeliveryState(delivered, arrived, jnp.minimum(before.gap, self._gap(crowd, sim)))
        length = terms.route_length(start, waypoints)
        new = {
            "start": start,
            "goal": waypoints[-1],
            "waypoints": waypoints,
            "route_length": length,
            "num_waypoints": number,
        }
        again = {"waypoint": jnp.int32(0), "route_done": jnp.float32(0.0)}
        again = {name: jnp.where(arrived, value, getattr(nav, name)) for name, value in again.items()}
        return {"task": state, **new, **again}

    def result(self, nav: NavState, result: Int[Array, ""]) -> Int[Array, ""]:
        """See `Task.result`."""
        well = nav.task.delivered >= self.needed
        return jnp.where((result == Result.TIMEOUT) & well, Result.GOAL, result).astype(jnp.int32)

    def rewards(self, old: NavState, new: NavState) -> dict[str, Float[Array, ""]]:
        """See `Task.rewards`."""
        state: DeliveryState = new.task
        # In the step that reaches an end the distance is already that to the next one.
        nearer = jnp.where(state.arrived, 0.0, old.goal_distance - new.goal_distance)
        return {"approach": nearer, "delivered": state.arrived.astype(jnp.float32)}

    def scores(self, nav: NavState) -> dict[str, Float[Array, ""]]:
        """See `Task.scores`."""
        state: DeliveryState = nav.task
        minutes = self.episode_length * self.dt / 60.0
        return {
            "score": self.robots * state.delivered / minutes,
            "deliveries": state.delivered,
            "robot_contact": (nav.result == Result.HIT_AGENT).astype(jnp.float32),
            "robot_distance": state.gap,
        }

    def privileged(self, nav: NavState) -> tuple[Float[Array, " n"], ...]:
        """See `Task.privileged`."""
        assert nav.crowd is not None
        return (self.people_observed(nav.crowd, self.pose(nav.sim), self.robots - 1),)


def _spread(bank: SceneBank, scene: int, lengths: tuple[float, float]) -> np.ndarray:
    """Rows of a scene's table with a route of the right length whose starts are `START_SPACING` m apart, those nearest
    to the middle of all, in order along the street."""
    rows = np.arange(int(bank.num_episodes[scene]))
    right = (bank.episode_length[scene, rows] >= lengths[0]) & (bank.episode_length[scene, rows] <= lengths[1])
    rows = rows[right]
    if not len(rows):
        return rows
    places = bank.episode_start[scene, rows, :2].astype(np.float64)
    away = np.linalg.norm(places - np.median(places, axis=0), axis=1)
    kept: list[int] = []
    for k in np.argsort(away, kind="stable").tolist():
        if len(kept) == MOST_ROWS:
            break
        if not kept or np.linalg.norm(places[kept] - places[k], axis=1).min() >= START_SPACING:
            kept.append(k)
    chosen = places[kept]
    _, _, axes = np.linalg.svd(chosen - chosen.mean(0), full_matrices=False)
    along = (chosen - chosen.mean(0)) @ axes[0] if len(kept) > 1 else np.zeros(1)
    return rows[np.array(kept)[np.argsort(along, kind="stable")]]
