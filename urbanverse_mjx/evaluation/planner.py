"""The privileged planner: a policy with full knowledge of the scene, an upper reference for benchmarks.

In:   the scene's clearance maps, an episode's route fields, the robot's pose and speed. Out: a waypoint, the same
action as that of other policies. When: every control step, inside jit, per env.

It evaluates a few hundred commands of two phases each by simulating a simple model of the robot: a first-order lag on
speed and yaw rate (`Motion`), with the robot's collision spheres as discs on the ground. The cost is the remaining
distance at the end (`route_fields`) and the nearness of discs to hulls and of wheels to edges. Freedom of contact is a
hard constraint: a command is allowed only if some continuation of it, such as stopping, stays free. This is the dynamic
window approach (Fox, Burgard, Thrun 1997) with a cost-to-go in place of its heading term, as in global dynamic window
planning (Brock, Khatib 1999).

Optionally it includes moving agents: their discs are extrapolated at constant velocity.
"""

import concurrent.futures
import dataclasses
import itertools
from collections.abc import Sequence
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ..datatypes import RobotSpec
from ..envs import NavEnv, NavState
from ..envs.navigation import terms
from ..envs.navigation.clearance_maps import CELL, MAX_DISTANCE, build_clearance_maps
from ..geometry import rotations
from ..robots.footprint import footprint
from ..robots.waypoint import WAYPOINT_REACH
from ..settings import num_threads
from .planner_options import PlannerOptions
from .route_fields import NODE, POOL, build_route_fields

_OPTIONS = PlannerOptions()
#: m, remaining route that counts as arrived.
GOAL_DISTANCE = _OPTIONS.goal_distance


@dataclasses.dataclass(frozen=True)
class Motion:
    """Model of a robot's response to a command (v, omega).

    Attributes:
      speed_lag, turn_lag: s, time constants; the second one of a turn on the spot.
      eases: m/s, speed at which the turn's lag is half of that, because rolling wheels turn more easily.
      pivot: m, distance behind the root body's origin of the point without lateral motion (the rear axle).
      curvature: 1/m, largest curvature; infinite for a robot that turns on the spot.
      dead: m/s and rad/s, half axes of the ellipse of commands (v, omega) at which the robot stands still; 0 for none.
      lateral: m/s², largest sideways acceleration, above which the robot slows down.
      climb: m/s lost per unit of slope uphill, and gained downhill, because the motors' speed gives way to their load.
      veer: rad/s per unit of slope, turn towards the lower side; `eases` applies to it as to the lag.
    """

    speed_lag: float
    turn_lag: float
    pivot: float
    curvature: float
    eases: float = np.inf
    dead: tuple[float, float] = (0.0, 0.0)
    lateral: float = np.inf
    climb: float = 0.0
    veer: float = 0.0

    def obeyed(self, v: Any, omega: Any) -> tuple[Any, Any]:
        """The velocity that a command (v, omega) reaches; 0 if it is too small to move the robot."""
        if np.isfinite(self.lateral):
            v = jnp.minimum(v, self.lateral / jnp.maximum(jnp.abs(omega), 1e-6))
        if not all(self.dead):
            return v, omega
        moves = ((v / self.dead[0]) ** 2 + (omega / self.dead[1]) ** 2 >= 1.0).astype(jnp.float32)
        return moves * v, moves * omega

    def drive(
        self, pose: Any, v: Any, w: Any, targets: tuple[Any, Any], dt: Any, slope: tuple[Any, Any] = (0.0, 0.0)
    ) -> tuple[Any, Any, Any]:
        """Pose (3,) x, y, yaw and speeds (v, w) after `dt` s.

        Args:
          targets: result of `obeyed` for the command.
          slope: rise of the ground per metre ahead and per metre to the left.
        """
        targets = (
            targets[0] - self.climb * slope[0],
            targets[1] - self.veer * slope[1] / (1.0 + jnp.abs(v) / self.eases),
        )
        new_v = targets[0] + (v - targets[0]) * jnp.exp(-dt / self.speed_lag)
        turn_lag = self.turn_lag / (1.0 + 0.5 * jnp.abs(new_v + v) / self.eases)
        new_w = targets[1] + (w - targets[1]) * jnp.exp(-dt / turn_lag)
        mean_v, mean_w = 0.5 * (new_v + v), 0.5 * (new_w + w)
        heading, side = pose[2] + 0.5 * mean_w * dt, self.pivot * mean_w
        c, s = jnp.cos(heading), jnp.sin(heading)
        return pose + dt * jnp.stack([c * mean_v - s * side, s * mean_v + c * side, mean_w]), new_v, new_w


#: Robot -> motion; for other robots see `motion_of`. tests/evaluation/test_planner.py compares these and those of gaits
#: with C MuJoCo.
MOTIONS = {
    "coco_differential": Motion(0.32, 0.60, 0.23, np.inf, 0.9, climb=2.4, veer=9.2),
    "coco_ackermann": Motion(0.32, 0.20, 0.23, np.tan(0.35) / 0.456, climb=2.4),
}
#: Robot -> `Motion.dead` of its gait, which stands still at small commands (docs/decisions/go2.md); the G1's does not
#: turn on the spot, and the Mini Cheetah's not always to the left.
DEAD = {"go2": (0.28, 0.45), "mini_cheetah": (0.27, 1.1), "b2": (0.2, 0.65), "g1": (0.3, np.inf)}
DEFAULT = Motion(0.3, 0.3, 0.0, np.inf)


def motion_of(robot: RobotSpec) -> Motion:
    """The model of a robot: that of `MOTIONS`, else of its description (`RobotSpec.response`), else `DEFAULT`."""
    known = robot.response
    if robot.name in MOTIONS or known is None:
        return MOTIONS.get(robot.name, DEFAULT)
    return Motion(
        known.speed_lag,
        known.turn_lag,
        known.pivot,
        known.curvature,
        dead=DEAD.get(robot.name, (0.0, 0.0)),
        lateral=known.lateral,
    )


class RouteField(NamedTuple):
    """The planner's data of one episode: see `RouteFields`.

    Data of a route in several parts have the same methods; `part` of this one is always 0.
    """

    origin: Any
    cost: Any

    def at(self, point: Any) -> Any:
        """() cost-metres to the goal from (2,) m."""
        return bilinear(self.cost, (point - self.origin) / NODE)

    def part(self, before: Any, xy: Any) -> Any:
        """() i32, the part of the route on which a robot is at (2,) m, after part `before`."""
        del xy
        return before

    def on(self, part: Any) -> "RouteField":
        """The data for a robot on a part."""
        del part
        return self

    def first_part(self) -> Any:
        """() i32, the part on which the robot is now."""
        return jnp.int32(0)


def _commands(robot: RobotSpec, motion: Motion, speeds: Sequence[float], turns: Sequence[float]) -> np.ndarray:
    """(K, 2) commands (m/s, rad/s) that the robot can follow."""
    top = np.array([robot.max_speed, robot.max_yaw_rate])
    found = np.array(list(itertools.product(speeds, turns))) * top
    if np.isfinite(motion.curvature):
        found = found[np.abs(found[:, 1]) <= found[:, 0] * motion.curvature + 1e-9]
    return found


class _Ahead(NamedTuple):
    """State and accumulated cost of a simulated drive."""

    pose: Any
    speed: Any
    turn: Any
    shy: Any
    mean: Any
    touched: Any
    left: Any
    driving: Any
    part: Any
    near: Any


class Planner:
    """The planner as a policy; `act` uses the env's complete state.

    Args:
      env: environment with the scenes.
      people: whether to include moving agents.
      comfort: m between bodies below which nearness to agents has a cost, and that cost relative to the one of nearness
        to obstacles; None for no such cost.

    Attributes:
      BEGINS_AMONG_AGENTS: whether a plan to wait that can begin at once does so where there are agents, too.
      AGENT_DEPTH: 1/m, what each metre nearer to an agent than the distance to keep counts beside contact with one, and
        both beside contact with the street; None for contact alone, whichever it is. Contact is a question of yes or
        no: where all commands come too near to somebody, the cheapest would drive on, through a wall as well.
    """

    BEGINS_AMONG_AGENTS = False
    AGENT_DEPTH: float | None = None

    def __init__(self, env: NavEnv, people: bool = True, comfort: tuple[float, float] | None = None) -> None:
        robot = env.robot
        self._comfort = comfort
        self._env, self._people = env, people and env.dynamic is not None
        self._root = env.mj_model.body(robot.root_body).id
        self._robot, self._motion = robot, motion_of(robot)
        self._body = footprint(robot)
        self._slower = _OPTIONS.reference_speed / robot.max_speed
        self._steps = np.array(_OPTIONS.steps) * np.where(
            np.arange(len(_OPTIONS.steps)) < _OPTIONS.first_steps, 1.0, self._slower
        )
        scenes = [int(s) for s in env.scenes]
        self._maps = build_clearance_maps(env.bank, scenes, robot.planner_height)
        self._to_hull, self._to_edge = (
            _Field.of(x, scenes, self._maps.origin, far)
            for x, far in ((self._maps.to_hull, MAX_DISTANCE), (self._maps.to_edge, -MAX_DISTANCE))
        )
        self._ground = _Field.of(self._maps.ground, scenes, self._maps.origin, 0.0)
        # (2, F): times the ground's heights under the feet, the slope ahead and to the left of the plane through them.
        self._plane = np.linalg.pinv(np.column_stack([self._body.feet, np.ones(len(self._body.feet))]))[:2]
        self._follow_speeds = jnp.array(_OPTIONS.follow_speeds) * robot.max_speed
        self.first = jnp.asarray(_commands(robot, self._motion, _OPTIONS.speeds, _OPTIONS.turns), jnp.float32)
        self._after = jnp.asarray(
            _commands(robot, self._motion, _OPTIONS.later_speeds, _OPTIONS.later_turns), jnp.float32
        )

    def prepare(self, scenes: np.ndarray, rows: np.ndarray) -> RouteField:
        """Privileged data of n episodes with a leading axis n.

        Args:
          scenes, rows: (n,) rows of the bank and of the scenes' episode tables.
        """
        return self._fields(scenes, rows, self._env.bank.episode_goal[scenes, rows])

    def widened(self, known: Any) -> Any:
        """Data of `prepare` in the shape that all episodes of the bank share, for programs that are compiled once.

        Windows grow to the size of the largest scene's map by repeating their border, so actions stay the same.
        """
        return known._replace(cost=self._widened(known.cost))

    def _widened(self, cost: Any) -> jax.Array:
        """(..., X, Y) fields in windows of the size of the maps."""
        whole = np.array(self._maps.to_hull.shape[1:]) // POOL
        missing = [(0, 0)] * (cost.ndim - 2) + [(0, int(n)) for n in whole - np.array(cost.shape[-2:])]
        # NumPy's: a JAX call would be compiled for every shape.
        return jnp.asarray(np.pad(np.asarray(cost), missing, mode="edge"))

    def _fields(self, scenes: np.ndarray, rows: np.ndarray, ends: np.ndarray) -> RouteField:
        """Fields over the windows of n routes, to ends (n, 2 or more) m, x and y first."""
        bank = self._env.bank
        start, route = bank.episode_start[scenes, rows], bank.episode_waypoints[scenes, rows]
        routes = np.concatenate([start[:, None, :2], route[..., :2]], 1).astype(np.float64)
        lengths = bank.episode_length[scenes, rows]
        goals = ends[:, :2].astype(np.float64)
        fields = build_route_fields(self._maps, scenes, goals, routes, lengths, self._body.half_width)
        return RouteField(jnp.asarray(fields.origin), jnp.asarray(fields.cost))

    def act(self, nav: NavState, route: RouteField) -> Any:
        """(2,) waypoint in [-1, 1]."""
        return self._waypoint(*self._first_costs(nav, route))

    def _waypoint(self, commands: Any, cost: Any) -> Any:
        """(2,) waypoint in [-1, 1] of the cheapest of commands (n, 2) with costs (n,)."""
        best = commands[jnp.argmin(cost)]
        return waypoint_of(best[0], best[1], self._robot.max_speed, self._env.dt)

    def _first_costs(self, nav: NavState, route: RouteField) -> tuple[Any, Any]:
        """(n, 2) commands of the first phase and (n,) their costs with the best of the second. Where nothing moves, or
        with `BEGINS_AMONG_AGENTS`, the last command is that of the second phase of a plan to wait, see `_at_once`."""
        xy, quaternion = nav.sim.xpos[self._root, :2], nav.sim.xquat[self._root]
        yaw = rotations.yaw_of(quaternion)
        speed = terms.to_body(nav.sim.qvel[:2], yaw)[0]
        agents = self._agents(nav) if self._people else None
        state = jnp.nan_to_num(jnp.stack([xy[0], xy[1], yaw, speed, nav.sim.qvel[5]]))
        costs = self.costs(nav.sim.scene, state, route, agents)
        if agents is not None and not self.BEGINS_AMONG_AGENTS:
            return self.first, costs.min(1)
        command, cost = self._at_once(nav.sim.scene, state, route, agents, costs)
        return jnp.concatenate([self.first, command[None]]), jnp.append(costs.min(1), cost)

    def _at_once(self, scene: Any, state: Any, route: RouteField, agents: Any, costs: Any) -> tuple[Any, Any]:
        """The command (2,) after the wait of the cheapest plan, and its cost: a little less than that of waiting if the
        robot stands and can begin without contact, else infinite.

        Where nothing is to be waited for such a plan can begin at once. Its end then differs, because the predictions
        end at the same time, and may be dearer; a robot that waits for that reason has the same choice in every step
        and never starts.
        """
        waiting = jnp.argmin(jnp.abs(self.first).sum(-1))
        after = jnp.argmin(costs[waiting])
        held, speeds = len(self._after), self._follow_speeds
        field = route.on(route.first_part())
        followed = self._downhill(scene, field, state[:3], speeds[jnp.clip(after - held, 0, len(speeds) - 1)])
        command = jnp.where(after < held, self._after[jnp.minimum(after, held - 1)], followed)
        waits = (jnp.argmin(costs.min(1)) == waiting) & (jnp.abs(state[3:]).max() < _OPTIONS.standing)
        least = costs[waiting, after]
        begins = self.costs(scene, state, route, agents, command[None]).min() < least + 0.5 * _OPTIONS.touch_cost
        return command, jnp.where(waits & begins, least - 1e-3, jnp.inf)

    def costs(self, scene: Any, state: Any, route: RouteField, agents: Any, first: Any = None) -> Any:
        """(first, after) cost of every command of the first phase with every command of the second; constant commands
        come before those that follow the field.

        Args:
          state: (5,) x, y, yaw, speed, yaw rate.
          agents: (A, 6), see `_agents`, or None.
          first: (first, 2) m/s, rad/s, other commands of the first phase than `self.first`.
        """
        zero = jnp.float32(0.0)
        begins = route.first_part()
        start = _Ahead(state[:3], state[3], state[4], zero, zero, zero, zero, jnp.float32(1.0), begins, zero)

        dts, numbers = jnp.asarray(self._steps, jnp.float32), jnp.arange(len(_OPTIONS.steps))
        ends = jnp.cumsum(dts)

        def drive(ahead: _Ahead, command: Any, part: slice, follow: bool = False) -> _Ahead:
            def lookahead_step(ahead: _Ahead, now: Any) -> tuple[_Ahead, None]:
                field = route.on(ahead.part)
                followed = self._downhill(scene, field, ahead.pose, command) if follow else command
                return self._lookahead_step(scene, route, agents, ahead, followed, *now), None

            # A loop compiles in a tenth of the time of unrolled steps.
            return jax.lax.scan(lookahead_step, ahead, (numbers[part], dts[part], ends[part]))[0]

        begin, go_on = slice(0, _OPTIONS.first_steps), slice(_OPTIONS.first_steps, None)

        def whole(first: Any) -> Any:
            middle = drive(start, first, begin)
            held = jax.vmap(lambda after: _cost(drive(middle, after, go_on)))(self._after)
            followed = jax.vmap(lambda v: _cost(drive(middle, v, go_on, follow=True)))(self._follow_speeds)
            return jnp.concatenate([held, followed])

        return jax.vmap(whole)(self.first if first is None else first)

    def _agents(self, nav: NavState) -> Any:
        """(A, 6) x, y, vx, vy, radius, presence of moving agents; long ones are enclosing discs."""
        dynamic, crowd = self._env.dynamic, nav.crowd
        assert dynamic is not None
        assert crowd is not None
        bodies = crowd.bodies
        size = jnp.asarray(dynamic.shapes.radius + dynamic.shapes.half_length)
        return jnp.stack([bodies.x, bodies.y, bodies.vx, bodies.vy, size, crowd.present.astype(jnp.float32)], -1)

    def _nose(self, scene: Any, route: RouteField, pose: Any, here: Any, side: float = 0.0) -> Any:
        """Cost-metres from the point `nose` m in front of a pose, `side` rad to its left; at least `here`, those of the
        pose itself, if an edge or a hull is in between.

        Behind a kerb the field may be metres lower than before it, and a robot that looked across would stay there.
        """
        points = np.outer(_OPTIONS.nose * np.array([0.6, 0.8, 1.0]), [np.cos(side), np.sin(side)])
        at = placed(pose, points)
        clear = jnp.minimum(self._to_hull.at(scene, *at), self._to_edge.at(scene, *at)).min() > _OPTIONS.nose_clearance
        found = _field_at(route, pose, _OPTIONS.nose, side)
        return jnp.where(clear, found, jnp.maximum(found, here))

    def _downhill(self, scene: Any, route: RouteField, pose: Any, speed: Any) -> Any:
        """(2,) command that turns to the descent direction of the field, and drives at up to `speed` when it points
        there."""
        here, angle = _field_at(route, pose, 0.0), _OPTIONS.nose_angle
        ahead, left, right = (self._nose(scene, route, pose, here, side) for side in (0.0, angle, -angle))
        # On a planar field with slope 1 in the direction e from straight ahead, these are sin e and cos e.
        sine, cosine = (
            (right - left) / (2.0 * _OPTIONS.nose * np.sin(_OPTIONS.nose_angle)),
            (here - ahead) / _OPTIONS.nose,
        )
        top = self._robot.max_yaw_rate
        omega = jnp.clip(_OPTIONS.follow_gain * jnp.arctan2(sine, cosine), -top, top)
        v = speed * jnp.clip(cosine, 0.0, 1.0)
        if np.isfinite(self._motion.curvature):
            v = speed
            omega = jnp.clip(omega, -v * self._motion.curvature, v * self._motion.curvature)
        return jnp.stack([v, omega])

    def _lookahead_step(
        self, scene: Any, route: RouteField, agents: Any, ahead: _Ahead, command: Any, k: Any, dt: Any, end: Any
    ) -> _Ahead:
        """Advances the drive to step `k`, `dt` s after the previous one and `end` s from now."""
        motion = self._motion
        slope = self._slope(scene, ahead.pose)
        pose, v, w = motion.drive(ahead.pose, ahead.speed, ahead.turn, motion.obeyed(command[0], command[1]), dt, slope)
        part = route.part(ahead.part, pose[:2])
        route = route.on(part)
        to_street, driving, uneasy, near = self._gap(scene, pose), ahead.driving, None, ahead.near
        gap, sooner = to_street, 2.0 - k / len(_OPTIONS.steps)
        if agents is not None:
            to_agents = self._agent_gap(agents, pose[:2], end)
            gap = jnp.minimum(gap, to_agents)
            if self.AGENT_DEPTH is not None:
                depth = jnp.maximum(_OPTIONS.touch_distance - to_agents, 0.0)
                near = jnp.maximum(near, driving * ((depth > 0.0) * sooner + self.AGENT_DEPTH * depth))
            if self._comfort is not None:
                distance, weight = self._comfort
                free = to_agents + _OPTIONS.agent_distance + _OPTIONS.agent_drift * end
                uneasy = weight * jnp.clip((distance - free) / distance, 0.0, 1.0)
        wanted = _OPTIONS.margin + _OPTIONS.margin_time * v
        shy = dt / self._slower * driving * jnp.clip((wanted - gap) / wanted, 0.0, 1.0) ** 2
        if uneasy is not None:
            shy += dt / self._slower * driving * uneasy
        touching = gap if self.AGENT_DEPTH is None else to_street
        touched = driving * (touching < _OPTIONS.touch_distance) * sooner
        here = _field_at(route, pose, 0.0)
        nose = self._nose(scene, route, pose, here)
        # The episode ends when the goal is reached, so later costs are ignored.
        driving = driving * (here > _OPTIONS.goal_distance)
        to_go = 0.5 * (here + nose) - _OPTIONS.goal_distance + _OPTIONS.nose
        left = driving * (to_go + self._more_to_go(scene, route, pose))
        mean = ahead.mean + left * dt / self._steps.sum()
        touched = jnp.maximum(ahead.touched, touched)
        return _Ahead(pose, v, w, ahead.shy + shy, mean, touched, left, driving, part, near)

    def _more_to_go(self, scene: Any, route: Any, pose: Any) -> Any:
        """Cost-metres at a pose beside those to the goal; 0 here."""
        del scene, route, pose
        return 0.0

    def _slope(self, scene: Any, pose: Any) -> tuple[Any, Any]:
        """Rise of the ground under the feet per metre ahead and to the left."""
        if not (self._motion.climb or self._motion.veer):
            return 0.0, 0.0
        height = self._ground.at(scene, *placed(pose, self._body.feet))
        # Steeper than any ramp is a foot behind an edge, where this plane is none.
        ahead, left = jnp.clip(jnp.asarray(self._plane, jnp.float32) @ height, -_OPTIONS.max_slope, _OPTIONS.max_slope)
        return ahead, left

    def _gap(self, scene: Any, pose: Any) -> Any:
        """m, least distance of discs to hulls, and of feet and low parts to an edge."""
        to_hull = self._to_hull.at(scene, *placed(pose, self._body.discs))
        to_edge = self._to_edge.at(scene, *placed(pose, np.concatenate([self._body.feet, self._body.low])))
        return jnp.minimum(
            (to_hull - self._body.discs[:, 2].astype(np.float32)).min(), to_edge.min() - _OPTIONS.edge_distance
        )

    def _agent_gap(self, agents: Any, xy: Any, ahead: Any) -> Any:
        dx, dy = agents[:, 0] + ahead * agents[:, 2] - xy[0], agents[:, 1] + ahead * agents[:, 3] - xy[1]
        gap = (
            jnp.sqrt(dx * dx + dy * dy)
            - agents[:, 4]
            - self._body.half_width
            - _OPTIONS.agent_distance
            - _OPTIONS.agent_drift * ahead
        )
        return jnp.where(agents[:, 5] > 0.0, gap, jnp.inf).min()


def placed(poses: Any, points: np.ndarray) -> tuple[Any, Any]:
    """World x and y (..., n) m of a robot's points (n, 2 or more) in its frame, at poses (..., 3) x, y, yaw."""
    px, py = points[:, 0].astype(np.float32), points[:, 1].astype(np.float32)
    x, y, yaw = (poses[..., k, None] for k in range(3))
    c, s = jnp.cos(yaw), jnp.sin(yaw)
    return x + c * px - s * py, y + s * px + c * py


def waypoint_of(v: Any, omega: Any, max_speed: float, control_period: float) -> Any:
    """(2,) m in [-1, 1], the waypoint that `robots.waypoint.pd_velocity` converts to (v, omega)."""
    horizon = max(WAYPOINT_REACH / max_speed, control_period)
    bearing = omega * horizon
    # A turn on the spot is a close waypoint; a waypoint of length 0 means to stand still.
    x = jnp.where((v < 1e-3) & (jnp.abs(omega) > 1e-3), 5e-3, v * horizon)
    y = x * jnp.tan(jnp.clip(bearing, -1.5, 1.5))
    return jnp.stack([x, y]) / jnp.maximum(jnp.maximum(jnp.abs(x), jnp.abs(y)), 1.0)


def _cost(ahead: _Ahead) -> Any:
    return (
        ahead.left
        + _OPTIONS.mean_weight * ahead.mean
        + _OPTIONS.margin_cost * ahead.shy
        + _OPTIONS.touch_cost * (ahead.touched + ahead.near)
    )


def _field_at(route: RouteField, pose: Any, ahead: float, side: float = 0.0) -> Any:
    """Cost-metres to the goal from the point `ahead` m in front of a pose (3,), `side` rad to its left."""
    angle = pose[2] + side
    point = pose[:2] + ahead * jnp.stack([jnp.cos(angle), jnp.sin(angle)]) if ahead else pose[:2]
    return route.at(point)


class _Field(NamedTuple):
    """Fields of scenes in half cells of the clearance maps, looked up without interpolation with an error of 1 cm.

    Each scene has a size of its own: those of a bank are padded to the largest, which is far more memory.

    Attributes:
      values: (n,) i16 mm, scene after scene.
      start: (Z,) index of a scene's first value.
      shape: (Z, 2) half cells of a scene.
      origin: (Z, 2) m.
    """

    values: Any
    start: Any
    shape: Any
    origin: Any

    @staticmethod
    def of(field: np.ndarray, scenes: Sequence[int], origin: np.ndarray, far: float) -> "_Field":
        """Field (Z, X, Y) m of some scenes; far: its value far from everything, such as in the padding."""
        cut = [_without_padding(field[scene], far) for scene in scenes]
        start, shape = np.zeros(len(field), np.int32), np.ones((len(field), 2), np.int32)
        length = 0
        for scene, cells in zip(scenes, cut, strict=True):
            start[scene], shape[scene] = length, (2 * cells.shape[0], 2 * cells.shape[1])
            length += 4 * cells.size
        # Filled in place and by several threads: the fields of 50 streets are gigabytes, and NumPy waits for memory.
        values = np.empty(length, np.int16)

        def fill(scene: int, cells: np.ndarray) -> None:
            part = values[start[scene] : start[scene] + 4 * cells.size]
            _fill_half_cells(cells, part.reshape(shape[scene]))

        with concurrent.futures.ThreadPoolExecutor(num_threads()) as pool:
            list(pool.map(fill, scenes, cut))
        return _Field(jnp.asarray(values), jnp.asarray(start), jnp.asarray(shape), jnp.asarray(origin, jnp.float32))

    def at(self, scene: Any, x: Any, y: Any) -> Any:
        """(...) m, values at world positions x, y (...) m."""
        shape = self.shape[scene]
        i = jnp.clip(((x - self.origin[scene, 0]) * (2 / CELL)).astype(jnp.int32), 0, shape[0] - 1)
        j = jnp.clip(((y - self.origin[scene, 1]) * (2 / CELL)).astype(jnp.int32), 0, shape[1] - 1)
        flat = self.start[scene] + i * shape[1] + j
        return self.values.at[flat].get(mode="promise_in_bounds").astype(jnp.float32) * 1e-3


def _without_padding(field: np.ndarray, far: float) -> np.ndarray:
    """A field (X, Y) up to its last values that are not `far`, and two cells more, so that its border is `far`."""
    near = field != np.asarray(far, field.dtype)
    sizes = [np.flatnonzero(near.any(1 - axis)).max(initial=-1) + 3 for axis in (0, 1)]
    return field[: sizes[0], : sizes[1]]


#: Rows of cells that are interpolated together: few enough that they stay in the processor's cache.
_ROWS = 32


def _fill_half_cells(cells: np.ndarray, fine: np.ndarray) -> None:
    """Fills (2 X, 2 Y) i16 with the millimetres of cells (X, Y) m, interpolated at the centres of their quarters."""
    for first in range(0, len(cells), _ROWS):
        last = min(first + _ROWS, len(cells))
        # With the rows before and after, which the outermost fine rows lie between.
        low, high = max(first - 1, 0), min(last + 1, len(cells))
        rows = _halved(cells[low:high].astype(np.float32))[2 * (first - low) : 2 * (last - low)]
        fine[2 * first : 2 * last] = np.rint(np.float32(1000.0) * _halved(rows.T).T)


def _halved(rows: np.ndarray) -> np.ndarray:
    """Linear interpolation of rows (n, m) f32 at the centres of their halves, (2 n, m); the outer ones are the rows."""
    fine = np.empty((2 * len(rows), *rows.shape[1:]), rows.dtype)
    fine[0], fine[-1] = rows[0], rows[-1]
    fine[1:-1:2] = rows[:-1] * np.float32(0.75) + rows[1:] * np.float32(0.25)
    fine[2::2] = rows[:-1] * np.float32(0.25) + rows[1:] * np.float32(0.75)
    return fine


def bilinear(field: Any, cell: Any, layer: Any = 0) -> Any:
    """Bilinear interpolation of a layer of fields (..., X, Y) at (2,) cells, whose centres are whole numbers; that of
    the border outside."""
    x, y = field.shape[-2:]
    cx, cy = jnp.clip(cell[0], 0.0, x - 1.001), jnp.clip(cell[1], 0.0, y - 1.001)
    i, j = cx.astype(jnp.int32), cy.astype(jnp.int32)
    fx, fy = cx - i, cy - j
    first = layer * (x * y) + i * y + j
    flat = field.reshape(-1).at[jnp.stack([first, first + 1, first + y, first + y + 1])]
    a, b, c, d = flat.get(mode="promise_in_bounds")
    return (a * (1.0 - fy) + b * fy) * (1.0 - fx) + (c * (1.0 - fy) + d * fy) * fx
