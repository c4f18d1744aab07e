"""Traffic on the two lanes of a road: vehicles that follow each other and do not expect the robot.

In:   lanes of a road, the robot's pose. Out: `Crowd` states of vehicles, as agents for engine, renderer and distances.
When: at reset and every control step, inside jit, per env.

* Following: the Intelligent Driver Model, with the parameters for city traffic (Treiber and Kesting, "Traffic Flow
  Dynamics", 2013, table 11.2).
* Arrivals: shifted exponential headways (Cowan, "Useful headway models", Transportation Research 9, 1975, model M2).
* Reaction: drivers brake for something unexpected after 1.25 s (Green, "How long does it take to stop?",
  Transportation Human Factors 2, 2000).

Crowds avoid a robot some seconds ahead and at once, and a body that would touch it stays where it is. A driver who
comes along a road does neither: vehicles here keep to their lane, brake after a reaction for what is in it, and touch
what they cannot stop for. Behind the ends of a lane the vehicles go on unseen: one that leaves the street comes again
after a gap that is drawn, and is there before it enters.
"""

import dataclasses
from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, Key
from ml_collections import ConfigDict

from ....crowds import KINDS
from ....crowds.behaviours import ROAM
from ....crowds.bodies import Bodies
from ....crowds.crossings import OPTIONS as CROSSING
from ....crowds.crossings import Precedence
from ....crowds.crowd import Crowd
from ....datatypes import AgentMotion, RobotSpec, SceneBank, ValidationError
from ....geometry import rotations
from ...types import NavState
from ..dynamic import DynamicStreet, slot_kinds, slot_shapes
from ..dynamic_tables import ground_tables
from .carriageways import Carriageways

#: s, longest step of the model, and number folded into an episode's key for the vehicles.
_DT, _BEGIN, _STEP = 0.1, 211, 1000
#: Lanes of a road, and the least number of vehicles of each.
LANES, MIN_VEHICLES = 2, 3


@dataclasses.dataclass(frozen=True)
class TrafficOptions:
    """Drivers; those without a source are chosen here.

    Attributes:
      headway: s, time gap of the Intelligent Driver Model. distance: m, gap at rest. deceleration: m/s², comfortable.
      least_headway: s between the fronts of two vehicles that come.
      reaction: s.
      sight: m ahead of its front within which a driver sees the robot.
      beside: m between the robot's disc and the path of a vehicle within which it is in its path.
      kerb: m from a marked crosswalk within which a robot that heads for it is going to cross. COCO waits behind the
        ramp of the kerb, 2 m before it.
      stop_distance: m between a vehicle that gives way and the crosswalk, that of `crowds.crossings`.
    """

    headway: float = 1.0
    distance: float = 2.0
    deceleration: float = 1.5
    least_headway: float = 2.0
    reaction: float = 1.25
    sight: float = 40.0
    beside: float = 0.1
    kerb: float = 2.8
    stop_distance: float = CROSSING.stop_distance


OPTIONS = TrafficOptions()
_CAR = KINDS["car"]
#: m, half a vehicle's length.
HALF_LENGTH = _CAR.half_length + _CAR.radius


class RobotOnRoad(NamedTuple):
    """The robot as drivers see it.

    Attributes:
      station, aside: (2,) m along each lane and beside it.
      crosses: () bool, whether it is on the crosswalk, or at the kerb and heads for it.
    """

    station: Float[Array, "2"]
    aside: Float[Array, "2"]
    crosses: Bool[Array, ""]


def road_of(crowd: Crowd) -> Int[Array, ""]:
    """() i32, the road of an episode's vehicles, see `Traffic`."""
    return crowd.goal[0]


class Traffic(DynamicStreet):
    """The vehicles on the road of an episode, in place of a crowd.

    In its `Crowd`, `goal` is the road, `anchor_x` the station (m) of a vehicle's middle along its lane, `anchor_y` the
    time (s) for which its driver could see the robot in the path, `blocked` 1 if it gives way, and `arrived` how often
    it left the street. The first half of the slots is on the first lane.

    Args:
      bank: the scenes.
      scenes: (n,) rows of it in use.
      config: `config.crowd` of an environment, whose slots are cars.
      flow: vehicles per hour and lane.
      roads: the roads of the scenes.
      ctrl_dt: s, the control step.
      robot: robot that the drivers meet.

    Raises:
      ValidationError: the slots are no cars or too few, or the flow is out of its range.
    """

    def __init__(
        self,
        bank: SceneBank,
        scenes: np.ndarray,
        config: ConfigDict,
        flow: float,
        roads: Carriageways,
        ctrl_dt: float,
        robot: RobotSpec,
    ) -> None:
        self.kinds = slot_kinds(config)
        number = len(self.kinds)
        if set(self.kinds) != {"car"} or number % LANES or number < LANES * MIN_VEHICLES:
            raise ValidationError(
                f"config.crowd.slots: found {dict(config.slots)}, needed cars alone, an even number from "
                f"{LANES * MIN_VEHICLES} on, because the traffic is on two lanes."
            )
        most = 3600.0 / OPTIONS.least_headway
        if not 0.0 < flow < most:
            raise ValidationError(
                f"config.task.flow: found {flow:g} vehicles per hour and lane, needed more than 0 and less than "
                f"{most:g}, because vehicles are at least {OPTIONS.least_headway:g} s apart."
            )
        self.shapes = slot_shapes(self.kinds)
        self.roads, self.mean_headway = roads, 3600.0 / flow
        self._dt, self._steps = ctrl_dt, max(1, round(ctrl_dt / _DT))
        self._robot_radius = robot.planner_radius
        self._people = jnp.zeros(number, bool)
        self._lane = jnp.repeat(jnp.arange(LANES), number // LANES)
        same = np.arange(number)[:, None] // (number // LANES) == np.arange(number) // (number // LANES)
        self._same = jnp.asarray(same & ~np.identity(number, bool))
        self._height, self._origin, self._row = ground_tables(bank, scenes)

    @property
    def lane(self) -> Int[Array, " A"]:
        """(A,) i32, the lane of each vehicle."""
        return self._lane

    def begin(
        self,
        key: Key[Array, ""],
        scene: Int[Array, ""],
        start: Float[Array, "4"],
        waypoints: Float[Array, "W 3"],
        clearance: Callable[[Int[Array, ""], Float[Array, "n 2"]], Float[Array, "n 2"]],
    ) -> Crowd:
        """See `DynamicStreet.begin`; the road is that between start and goal, and vehicles drive at their speeds."""
        del clearance
        keys = jax.random.split(jax.random.fold_in(key, _BEGIN), 2)
        road = self.roads.nearest(scene, 0.5 * (start[:2] + waypoints[-1, :2]))
        number = len(self.kinds)
        speed = self._speeds(keys[0])
        gap = speed * self._headways(keys[1])
        # The first of a lane is anywhere in the last gap, the others behind it.
        behind = jnp.cumsum(gap.reshape(LANES, -1), axis=1).reshape(-1)
        station = self.roads.length[scene, road][self._lane] - behind
        zero, none = jnp.zeros(number), jnp.zeros(number, jnp.int32)
        crowd = Crowd(
            bodies=Bodies(zero, zero, zero, zero, zero),
            present=jnp.zeros(number, bool),
            speed=speed,
            goal=jnp.full(number, road),
            mode=jnp.full(number, ROAM, jnp.int32),
            anchor_x=station,
            anchor_y=zero,
            face=zero,
            blocked=zero,
            side=zero,
            still=zero,
            backing=zero,
            arrived=none,
        )
        return self._placed(crowd, scene, station, speed)

    def _speeds(self, key: Key[Array, ""]) -> Float[Array, " A"]:
        """(A,) m/s, preferred speeds."""
        noise = jax.random.truncated_normal(key, -2.0, 2.0, (len(self.kinds),))
        return jnp.clip(_CAR.speed + _CAR.spread * noise, 0.3 * _CAR.speed, _CAR.speed_limit)

    def _headways(self, key: Key[Array, ""]) -> Float[Array, " A"]:
        """(A,) s, between fronts."""
        more = jax.random.exponential(key, (len(self.kinds),))
        return OPTIONS.least_headway + (self.mean_headway - OPTIONS.least_headway) * more

    def _placed(self, crowd: Crowd, scene: Int[Array, ""], station: Array, speed: Array) -> Crowd:
        """The crowd with its vehicles at stations (A,) m with speeds (A,) m/s."""
        road = road_of(crowd)
        xy, heading = self.roads.at(scene, road, self._lane, station)
        length = self.roads.length[scene, road][self._lane]
        body = Bodies(xy[:, 0], xy[:, 1], speed * jnp.cos(heading), speed * jnp.sin(heading), heading)
        inside = (station > HALF_LENGTH) & (station < length - HALF_LENGTH)
        return crowd._replace(bodies=body, present=inside, anchor_x=station)

    def on_road(self, crowd: Crowd, scene: Int[Array, ""], xy: Float[Array, "2"], yaw: Float[Array, ""]) -> RobotOnRoad:
        """The robot at (2,) m with a yaw (rad) as drivers see it."""
        road = road_of(crowd)
        station, aside = self.roads.along(scene, road, xy)
        across, along = self.roads.beside(scene, road, xy)
        half = self.roads.half[scene, road]
        towards = -jnp.sign(across) * (self.roads.across[scene, road] @ jnp.stack([jnp.cos(yaw), jnp.sin(yaw)]))
        before = jnp.abs(across) - half[0]
        near = (before <= 0.0) | ((before < OPTIONS.kerb) & (towards > 0.5))
        return RobotOnRoad(station, aside, near & (jnp.abs(along) < half[1] + self._robot_radius))

    def advance(self, nav: NavState, root: int, rights: Precedence | None = None) -> tuple[Crowd, AgentMotion]:
        """See `DynamicStreet.advance`."""
        del rights
        sim, before = nav.sim, nav.crowd
        assert before is not None
        robot = self.on_road(before, sim.scene, sim.xpos[root, :2], rotations.yaw_of(sim.xquat[root]))
        key = jax.random.fold_in(nav.key, _STEP + nav.steps)

        def step(k: Int[Array, ""], crowd: Crowd) -> Crowd:
            return self.step(crowd, sim.scene, robot, self._dt / self._steps, jax.random.fold_in(key, k))

        crowd = jax.lax.fori_loop(0, self._steps, step, before)
        return crowd, self.motion(before, crowd, sim.scene)

    def step(self, crowd: Crowd, scene: Int[Array, ""], robot: RobotOnRoad, dt: float, key: Key[Array, ""]) -> Crowd:
        """The vehicles `dt` s later; the robot stands for that time."""
        road, lane, station = road_of(crowd), self._lane, crowd.anchor_x
        speed = jnp.hypot(crowd.bodies.vx, crowd.bodies.vy)
        front = station + HALF_LENGTH
        ahead = self._same & (station[None] > station[:, None])
        leader = jnp.argmin(jnp.where(ahead, station[None], jnp.inf), axis=1)
        gap = jnp.where(ahead.any(1), station[leader] - HALF_LENGTH - front, jnp.inf)
        push = following(speed, crowd.speed, gap, speed[leader])
        # What a driver brakes for: the robot in the path, and where there are stripes one that crosses.
        to_robot = robot.station[lane] - self._robot_radius - front
        reach = _CAR.radius + self._robot_radius + OPTIONS.beside
        in_path = (robot.aside[lane] < reach) & (to_robot > -2.0 * HALF_LENGTH) & (to_robot < OPTIONS.sight)
        line = self.roads.station[scene, road][lane] - self.roads.half[scene, road, 1] - OPTIONS.stop_distance
        to_line = line - front
        wants = self.roads.marked[scene, road] & robot.crosses & (to_line > -OPTIONS.stop_distance)
        seen = jnp.where(in_path | (wants & (to_line < OPTIONS.sight)), crowd.anchor_y + dt, 0.0)
        reacts = seen >= OPTIONS.reaction
        # As in `crowds.crossings`: who would have to brake harder than this goes on. A decision lasts.
        can = speed * speed < 2.0 * _CAR.braking * jnp.maximum(to_line, 0.0)
        yields = wants & ((reacts & can) | (crowd.blocked > 0.0))
        for acts, distance in ((in_path & reacts, to_robot), (yields, to_line + OPTIONS.distance)):
            push = jnp.where(acts, jnp.minimum(push, following(speed, crowd.speed, distance, 0.0)), push)
        new = jnp.maximum(speed + dt * jnp.maximum(push, -_CAR.braking), 0.0)
        station = station + 0.5 * dt * (speed + new)
        # One that has left the street comes again behind the last of its lane.
        left = station > self.roads.length[scene, road][lane]
        keys = jax.random.split(key, 2)
        wanted, headway = self._speeds(keys[0]), self._headways(keys[1])
        last = jnp.where(self._same, station[None], jnp.inf).min(1)
        wanted = jnp.where(left, wanted, crowd.speed)
        station = jnp.where(left, jnp.minimum(last, 0.0) - headway * wanted, station)
        crowd = crowd._replace(
            speed=wanted,
            anchor_y=jnp.where(left, 0.0, seen),
            blocked=(yields & ~left).astype(jnp.float32),
            arrived=crowd.arrived + left.astype(jnp.int32),
        )
        return self._placed(crowd, scene, station, jnp.where(left, wanted, new))


def following(speed: Array, wanted: Array, gap: Array, ahead: Array | float) -> Array:
    """(A,) m/s², acceleration of the Intelligent Driver Model at speeds (A,) m/s, wanted speeds (A,) m/s, gaps (A,) m
    and speeds (A,) m/s of what is ahead."""
    a, b = _CAR.acceleration, OPTIONS.deceleration
    closing = speed * (speed - ahead) / (2.0 * np.sqrt(a * b))
    desired = OPTIONS.distance + jnp.maximum(speed * OPTIONS.headway + closing, 0.0)
    return a * (1.0 - (speed / wanted) ** 4 - (desired / jnp.maximum(gap, 0.1)) ** 2)
