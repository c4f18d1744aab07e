"""`FollowRoute`: follow pavements and crosswalks over 200 m, and obey the signals.

The score is that of the CARLA Autonomous Driving Leaderboard (Dosovitskiy et al., "CARLA: An Open Urban Driving
Simulator", 2017; leaderboard.carla.org, "Evaluation and metrics"): the completed share of the route times a factor of
each infraction, with its factors for red lights and for contacts.
"""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, Int32, Key
from ml_collections import ConfigDict

from ....crowds.crossings import CLEAR, STOP, UNSIGNALLED, WALK, Precedence
from ....crowds.crowd import Crowd
from ....datatypes import RobotSpec, SceneBank, SimState, ValidationError
from ...types import NavState, Result
from . import routes
from .crosswalks import Crosswalks, Rectangle, rectangles
from .people import nearest_agents
from .signals import Cycle
from .task import Parts, RobotPose, Task

#: Factors of the leaderboard: running a red light, contact with a pedestrian, a vehicle, and anything else.
RED_LIGHT, PEDESTRIAN, VEHICLE, STATIC = 0.70, 0.50, 0.60, 0.65
#: Kinds of agents that count as vehicles.
VEHICLES = ("car", "cyclist")
#: m and s by which the observed distance and times are divided.
DISTANCE_UNIT, TIME_UNIT = 20.0, 30.0
#: Words for phases in captions; the time beside the first is what is left of it, beside the others until it begins.
PHASES = {WALK: "walk", CLEAR: "clearance, walk in", STOP: "don't walk, walk in"}
#: Number of agents that teachers and critics observe.
OBSERVED = 4
#: m/s below which the robot stands.
STANDING = 0.1
#: m, range of the length of routes.
MIN_LENGTH, MAX_LENGTH = 20.0, 1000.0
#: m by which a position on the route may be ahead of the robot's: `terms.next_waypoint` passes them from 2 m on.
PASSED = 2.2
#: m from a crosswalk at which a robot has left it, so that one at its border does not enter it again and again.
LEFT = 0.5
#: Number folded into an episode's key for the signals.
_OFFSETS = 302
#: m between points at which a route is compared with the crosswalks.
_STEP = 0.25
#: Number of crosswalks of a scene for which `crossings.Crossings` has numbers.
_NUMBERS = 256


class Light(NamedTuple):
    """The signal of the next crosswalk of the route, or of the one on which the robot is.

    Attributes:
      distance: () m along the route to it; 0 on it.
      on: () bool, whether the robot is on it.
      row: () i32, the crosswalk; -1 if no other comes.
      phase: () i32, `WALK`, `CLEAR` or `STOP`; `UNSIGNALLED` if no other comes.
      to_walk, walk_left: () s until people may begin to cross, and for which they still may.
    """

    distance: Float[Array, ""]
    on: Bool[Array, ""]
    row: Int[Array, ""]
    phase: Int[Array, ""]
    to_walk: Float[Array, ""]
    walk_left: Float[Array, ""]


class RouteState(NamedTuple):
    """Attributes:
    offset: (C,) s, of the signals' cycles at the beginning of the episode.
    inside: () i32, the crosswalk on which the robot is; -1 for none.
    entries, violations: () crosswalks entered, and those of them while people must not begin to cross.
    violated: () bool, in the last step.
    standing: () s for which the robot stood.
    """

    offset: Float[Array, " C"]
    inside: Int[Array, ""]
    entries: Float[Array, ""]
    violations: Float[Array, ""]
    violated: Bool[Array, ""]
    standing: Float[Array, ""]


def crossings_of_route(
    points: Float[np.ndarray, "n 2"], held: Sequence[Rectangle]
) -> tuple[Float[np.ndarray, " m"], Int32[np.ndarray, " m"]]:
    """Where a line enters crosswalks: (m,) m of arc length in ascending order, and (m,) their rows.

    Args:
      points: (n, 2) m, corners of the line.
      held: the crosswalks.
    """
    span = np.diff(points, axis=0)
    length = np.linalg.norm(span, axis=-1)
    ends = np.cumsum(length)
    along = np.arange(0.0, ends[-1], _STEP)
    piece = np.minimum(np.searchsorted(ends, along, side="right"), len(span) - 1)
    share = (along - (ends - length)[piece]) / np.maximum(length[piece], 1e-9)
    at = points[piece] + share[:, None] * span[piece]
    arcs: list[float] = []
    rows: list[int] = []
    for row, rectangle in enumerate(held):
        on = rectangle.holds(at)
        entered = np.flatnonzero(on & ~np.insert(on[:-1], 0, False))
        arcs += along[entered].tolist()
        rows += [row] * len(entered)
    order = np.argsort(arcs, kind="stable")
    return np.array(arcs)[order], np.array(rows, np.int32)[order]


class FollowRoute(Task):
    """Following a route of `config.task.length` m over pavements and crosswalks with signals, past its waypoints.

    The route comes from `routes.long_routes`; scenes in which the robot comes over no crosswalk are left out, those
    without any only if `config.task.needs_crosswalk`. Each crosswalk has a signal, whose cycle of `config.task.cycle` s
    has `walk` s to begin to cross and begins anywhere (`signals`); people and vehicles obey it as well. The observation
    `goal` is the next waypoint. `proprio` has after the speeds, and `privileged` at its end, the `Light` as a signal's
    message tells it: distance (units of 20 m, at most 1), whether the robot is on it, whether people may begin, time
    until they may and time for which they still may (units of 30 s). Where there is a crowd, `privileged` ends with its
    `OBSERVED` nearest agents (`nearest_agents`).

    Ends: as point goals; at the goal only after all waypoints. Scores of an episode: score: completed share of the
    route, times 0.70 for each violation, times 0.50, 0.60 or 0.65 if it ends by contact with a person, a vehicle or
    anything else. violations: crosswalks entered by the robot's centre while people must not begin to cross. crossings:
    crosswalks entered. standing: s. seconds: until the end. Additional terms of reward: route (m of progress on the
    route in this step) and violation (1 in the step of one).

    Raises:
      ValidationError: a value is out of its range, or no scene has a crosswalk to come over.
    """

    SCORES = ("score", "violations", "crossings", "standing", "seconds")

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        options, bank = parts.config.task, parts.bank
        if parts.config.goal_mode != "waypoint":
            raise ValidationError(
                f"config.goal_mode: found {parts.config.goal_mode!r} for the task 'follow_route', needed 'waypoint', "
                "because its route leads back over itself."
            )
        used = [int(z) for z in parts.scenes]
        self.dynamic = parts.dynamic
        if parts.dynamic is None:
            self.crosswalks = Crosswalks.of(bank, used, None)
        else:
            tables, row = parts.dynamic.model.tables.crossings, parts.dynamic.row
            self.crosswalks = Crosswalks.of(bank, used, tables, lambda z: int(row(z)))
        widest = float(2.0 * self.crosswalks.half[..., 0].max())
        self.cycle = Cycle(float(options.cycle), float(options.walk)).check(widest)
        events = {z: self._events(bank, z) for z in used}
        most = max(arcs.shape[1] for arcs, _ in events.values())
        arc = np.full((*bank.episode_length.shape, most), np.inf, np.float32)
        which = np.full(arc.shape, -1, np.int32)
        for z, (arcs, rows) in events.items():
            arc[z, : len(arcs), : arcs.shape[1]], which[z, : len(rows), : rows.shape[1]] = arcs, rows
        self._arc, self._which = jnp.asarray(arc), jnp.asarray(which)
        kinds = () if parts.dynamic is None else parts.dynamic.kinds
        self._factor = jnp.array([*(VEHICLE if kind in VEHICLES else PEDESTRIAN for kind in kinds), STATIC])

    @classmethod
    def episodes(
        cls, config: ConfigDict, bank: SceneBank, robot: RobotSpec, scenes: Int32[np.ndarray, " n"]
    ) -> tuple[SceneBank, Int32[np.ndarray, " n"], Any]:
        """See `Task.episodes`."""
        length = float(config.task.length)
        if not MIN_LENGTH <= length <= MAX_LENGTH:
            raise ValidationError(f"config.task.length: found {length:g} m, needed {MIN_LENGTH:g} to {MAX_LENGTH:g} m.")
        return (*routes.with_long_routes(bank, scenes, robot, length, bool(config.task.needs_crosswalk)), None)

    def _events(self, bank: SceneBank, scene: int) -> tuple[np.ndarray, np.ndarray]:
        """(E, M) m of arc length and i32 rows, where the routes of a scene enter its crosswalks."""
        held, found = rectangles(bank, scene), []
        for row in range(int(bank.num_episodes[scene])):
            points = bank.episode_waypoints[scene, row, : int(bank.episode_num_waypoints[scene, row]), :2]
            corners = np.concatenate([bank.episode_start[scene, row, None, :2], points]).astype(np.float64)
            found.append(crossings_of_route(corners, held))
        most = max(1, *(len(arcs) for arcs, _ in found)) if found else 1
        arc, which = np.full((len(found), most), np.inf, np.float32), np.full((len(found), most), -1, np.int32)
        for row, (arcs, rows) in enumerate(found):
            arc[row, : len(arcs)], which[row, : len(rows)] = arcs, rows
        return arc, which

    def begin(self, key: Key[Array, ""], nav: NavState) -> NavState:
        """The first state of an episode, with signals anywhere in their cycle."""
        number = self.crosswalks.exists.shape[1]
        offset = jax.random.uniform(jax.random.fold_in(key, _OFFSETS), (number,), maxval=self.cycle.length)
        zero = jnp.float32(0.0)
        return nav._replace(task=RouteState(offset, jnp.int32(-1), zero, zero, jnp.bool_(False), zero))

    def phases(self, scene: Int[Array, ""], offset: Float[Array, " C"], steps: Int[Array, ""]) -> Int[Array, " C"]:
        """(C,) i32, the phase of each crosswalk after some control steps; that of rows without one is `UNSIGNALLED`."""
        crossing = 2.0 * self.crosswalks.half[scene, :, 0]
        phase = self.cycle.phase(offset + steps * self.dt, crossing)
        return jnp.where(self.crosswalks.exists[scene], phase, UNSIGNALLED)

    def rights(self, nav: NavState) -> Precedence:
        """See `Task.rights`."""
        scene, robot = nav.sim.scene, self.pose(nav.sim)
        phase = self.phases(scene, nav.task.offset, nav.steps)
        known = jnp.zeros(_NUMBERS, jnp.int32).at[self.crosswalks.number[scene]].max(phase)
        # Number 0 stands for places without a crosswalk.
        return Precedence(known.at[0].set(UNSIGNALLED), robot.xy[0], robot.xy[1], robot.yaw, jnp.bool_(True))

    def completed(
        self, nav: NavState, p_xy: Float[Array, "2"], distance: Float[Array, ""], driven: Float[Array, ""]
    ) -> Float[Array, ""]:
        """See `Task.completed`: up to the last waypoint passed, and from there as much as the robot is nearer to the
        next. The nearest point of the route may be on its way back."""
        del distance
        return jnp.minimum(self.position(nav, p_xy), driven)

    def position(self, nav: NavState, p_xy: Float[Array, "2"]) -> Float[Array, ""]:
        """() m of arc length of the route at (2,) m, on the way to the next waypoint."""
        corners = jnp.concatenate([nav.start[None, :2], nav.waypoints[:, :2]])
        ends = jnp.cumsum(jnp.linalg.norm(jnp.diff(corners, axis=0), axis=-1))
        end = ends[nav.waypoint]
        begin = jnp.where(nav.waypoint > 0, ends[nav.waypoint - 1], 0.0)
        return jnp.clip(end - jnp.linalg.norm(nav.waypoints[nav.waypoint, :2] - p_xy), begin, end)

    def light(self, nav: NavState) -> Light:
        """The signal that concerns the robot in a state."""
        state: RouteState = nav.task
        scene, p_xy = nav.sim.scene, self.pose(nav.sim).xy
        arcs, rows = self._arc[scene, nav.episode], self._which[scene, nav.episode]
        # A waypoint counts as passed `PASSED` m before it, and the crosswalk behind it is not left yet.
        comes = arcs > nav.route_done - PASSED
        first = jnp.argmax(comes)
        on = state.inside >= 0
        row = jnp.where(on, state.inside, jnp.where(comes.any(), rows[first], -1))
        some = row >= 0
        time = state.offset[row] + nav.steps * self.dt
        phase = self.phases(scene, state.offset, nav.steps)[row]
        left = jnp.maximum(arcs[first] - nav.route_done, self.crosswalks.away(scene, p_xy)[row])
        return Light(
            distance=jnp.where(on, 0.0, jnp.where(some, jnp.minimum(left, DISTANCE_UNIT), DISTANCE_UNIT)),
            on=on,
            row=row,
            phase=jnp.where(some, phase, UNSIGNALLED),
            to_walk=jnp.where(some, self.cycle.to_walk(time), 0.0),
            walk_left=jnp.where(some, self.cycle.walk_left(time), TIME_UNIT),
        )

    def advance(self, nav: NavState, sim: SimState, crowd: Crowd | None) -> dict[str, Any]:
        """See `Task.advance`."""
        del crowd
        before: RouteState = nav.task
        robot: RobotPose = self.pose(sim)
        away = self.crosswalks.away(sim.scene, robot.xy)
        nearest = jnp.argmin(away)
        stays = (before.inside >= 0) & (away[before.inside] < LEFT)
        inside = jnp.where(stays, before.inside, jnp.where(away[nearest] <= 0.0, nearest, -1)).astype(jnp.int32)
        entered = (inside >= 0) & (inside != before.inside)
        phase = self.phases(sim.scene, before.offset, nav.steps + 1)[inside]
        violated = entered & (phase != WALK)
        state = RouteState(
            offset=before.offset,
            inside=inside,
            entries=before.entries + entered,
            violations=before.violations + violated,
            violated=violated,
            standing=before.standing + self.dt * (jnp.linalg.norm(robot.velocity) < STANDING),
        )
        return {"task": state}

    def result(self, nav: NavState, result: Int[Array, ""]) -> Int[Array, ""]:
        """See `Task.result`."""
        early = (result == Result.GOAL) & (nav.waypoint < nav.num_waypoints - 1)
        late = jnp.where(nav.steps >= self.episode_length, Result.TIMEOUT, Result.RUNNING)
        return jnp.where(early, late, result).astype(jnp.int32)

    def rewards(self, old: NavState, new: NavState) -> dict[str, Float[Array, ""]]:
        """See `Task.rewards`."""
        return {"route": new.route_done - old.route_done, "violation": new.task.violated.astype(jnp.float32)}

    def scores(self, nav: NavState) -> dict[str, Float[Array, ""]]:
        """See `Task.scores`."""
        state: RouteState = nav.task
        agent = nav.sim.contacts.hit_agent
        touched = jnp.int32(-1) if agent is None else agent
        contact = (nav.result == Result.HIT) | (nav.result == Result.HIT_AGENT)
        factor = jnp.where(contact, self._factor[touched], 1.0) * RED_LIGHT**state.violations
        share = jnp.clip(nav.route_done / jnp.maximum(nav.route_length, 1e-6), 0.0, 1.0)
        values = (share * factor, state.violations, state.entries, state.standing, nav.steps * self.dt)
        return {name: jnp.float32(x) for name, x in zip(self.SCORES, values, strict=True)}

    def observed(self, nav: NavState) -> Float[Array, "5"]:
        """(5,) f32, the `Light` in a state."""
        light = self.light(nav)
        open_ = (light.phase == WALK) | (light.phase == UNSIGNALLED)
        times = jnp.clip(jnp.stack([light.to_walk, light.walk_left]) / TIME_UNIT, 0.0, 1.0)
        return jnp.concatenate([jnp.stack([light.distance / DISTANCE_UNIT, light.on, open_]), times])

    def proprio(self, nav: NavState) -> tuple[Float[Array, " n"], ...]:
        """See `Task.proprio`."""
        return (self.observed(nav),)

    def privileged(self, nav: NavState) -> tuple[Float[Array, " n"], ...]:
        """See `Task.privileged`."""
        if self.dynamic is None or nav.crowd is None:
            return (self.observed(nav),)
        return self.observed(nav), nearest_agents(self.dynamic, nav.crowd, self.pose(nav.sim), OBSERVED)

    def shown(self, nav: NavState) -> dict[str, Array]:
        """See `Task.shown`."""
        light = self.light(nav)
        seconds = jnp.where(light.phase == WALK, light.walk_left, light.to_walk)
        return {
            "phase": light.phase,
            "seconds": seconds,
            "metres": light.distance,
            "done": nav.route_done,
            "violations": nav.task.violations,
        }

    def note(self, values: Mapping[str, float]) -> str:
        """See `Task.note`."""
        phase = int(values["phase"])
        said = f"{values['done']:3.0f} m done   {values['violations']:.0f} violations"
        if phase == UNSIGNALLED:
            return f"{said}   no signal ahead"
        where = f"in {values['metres']:2.0f} m" if values["metres"] < DISTANCE_UNIT else "far"
        return f"{said}   signal {where}: {PHASES[phase]} {values['seconds']:2.0f} s"
