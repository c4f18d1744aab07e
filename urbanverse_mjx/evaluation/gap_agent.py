"""The ceiling of `CrossStreet`: waits at the kerb for a gap in the traffic and then crosses without stopping.

In:   the state of an env. Out: a waypoint. When: every control step, inside jit, per env.

A gap is accepted if every vehicle comes to the robot's place on its lane later than the robot has left the lane, by
more than the time to a collision that counts as a near miss, or has left it before the robot comes, by more than the
post-encroachment time that does. This is gap acceptance with the critical gap of the Highway Capacity Manual (2000,
chapter 18), crossing time plus a margin, for each lane by itself.
"""

from typing import Any

import jax.numpy as jnp
import numpy as np

from ..crowds import KINDS
from ..crowds.crossings import OPTIONS as CROSSING
from ..envs import NavEnv, NavState
from ..envs.navigation import terms
from ..envs.navigation.tasks.cross import NEAR_MISS_POST_TIME, NEAR_MISS_TIME, CrossStreet
from ..envs.navigation.tasks.traffic import HALF_LENGTH, LANES, road_of

#: m between the robot's centre and the crosswalk before which it waits: COCO's wheels are behind the ramp then.
KERB_DISTANCE = 2.0
#: m behind that line from which on the robot goes on whatever comes.
COMMITTED = 0.3
#: m/s, mean speed over ramps and road, and s by which a start from rest takes longer.
CROSSING_SPEED, STARTING_TIME = 1.8, 0.4
#: s, additions to the times of near misses: drivers speed up, and the robot's speed varies.
SPARE_TIME = 0.5
#: m/s below which a vehicle counts as stopped; a faster one may go at its preferred speed.
STOPPED = CROSSING.stopped_speed
#: s in which the robot stops before the line.
BRAKING_TIME = 0.7


class GapAcceptor:
    """`agents.Privileged` for `CrossStreet`, which knows the vehicles that have not entered the street yet as well."""

    def __init__(self, env: NavEnv) -> None:
        assert isinstance(env.task, CrossStreet)
        self._task, self._traffic, self._roads = env.task, env.task.traffic, env.task.roads
        self._radius, self._top_speed = float(env.robot.planner_radius), float(env.robot.max_speed)

    def prepare(self, scenes: np.ndarray, rows: np.ndarray) -> Any:
        """Nothing: the state has all."""
        del rows
        return jnp.zeros((len(scenes), 0))

    def act(self, nav: NavState, known: Any = None) -> Any:
        """(2,) waypoint in [-1, 1]."""
        del known
        robot = self._task.pose(nav.sim)
        goal = terms.to_body(nav.goal[:2] - robot.xy, robot.yaw)
        to_line = self._to_line(nav)
        goes = (to_line < -COMMITTED) | self.accepts(nav)
        slow = jnp.clip(to_line / (BRAKING_TIME * self._top_speed), 0.0, 1.0)
        return jnp.where(goes, 1.0, slow) * goal / jnp.maximum(jnp.linalg.norm(goal), 1e-6)

    def _towards(self, nav: NavState) -> Any:
        """() 1 or -1, the direction across."""
        road = self._road(nav)
        ends = self._roads.beside(nav.sim.scene, road, jnp.stack([nav.start[:2], nav.goal[:2]]))
        return jnp.sign(ends[1, 0] - ends[0, 0])

    def _road(self, nav: NavState) -> Any:
        assert nav.crowd is not None
        return road_of(nav.crowd)

    def _to_line(self, nav: NavState) -> Any:
        """() m to the line at which the robot waits; negative behind it."""
        scene, road = nav.sim.scene, self._road(nav)
        across = self._towards(nav) * self._roads.beside(scene, road, self._task.pose(nav.sim).xy)[0]
        return -self._roads.half[scene, road, 0] - KERB_DISTANCE - across

    def accepts(self, nav: NavState) -> Any:
        """() bool, whether the robot can cross both lanes from where it is."""
        assert nav.crowd is not None
        crowd, scene, road, lane = nav.crowd, nav.sim.scene, self._road(nav), self._traffic.lane
        robot, sign = self._task.pose(nav.sim), self._towards(nav)
        station, _ = self._roads.along(scene, road, robot.xy)
        line, _ = self._roads.at(scene, road, jnp.arange(LANES), station)
        across = self._roads.across[scene, road]
        away = sign * ((line - robot.xy) @ across)
        reach = KINDS["car"].radius + self._radius
        pace = jnp.clip(sign * (robot.velocity @ across) / self._top_speed, 0.0, 1.0)

        def time(distance: Any) -> Any:
            return jnp.maximum(distance, 0.0) / CROSSING_SPEED + STARTING_TIME * (1.0 - pace)

        enters, leaves = time(away - reach)[lane], time(away + reach)[lane]
        speed = jnp.hypot(crowd.bodies.vx, crowd.bodies.vy)
        fast = jnp.where(speed > STOPPED, jnp.maximum(speed, crowd.speed), speed)
        to_place = station[lane] - crowd.anchor_x
        near = HALF_LENGTH + self._radius
        comes = jnp.maximum(to_place - near, 0.0) / jnp.maximum(fast, 0.05)
        gone = jnp.maximum(to_place + near, 0.0) / jnp.maximum(speed, 0.05)
        later = comes > leaves + NEAR_MISS_TIME + SPARE_TIME
        sooner = gone + NEAR_MISS_POST_TIME + SPARE_TIME < enters
        past = to_place < -near
        # Behind one that gives way nobody comes.
        stands = crowd.present & (speed < STOPPED) & (to_place > near)
        held = (stands & (lane[:, None] == lane) & (crowd.anchor_x > crowd.anchor_x[:, None])).any(1)
        return (later | sooner | past | held).all()
