"""Costs of the planner and of the route follower against the same formulas in NumPy, over smooth fields."""

import types
from typing import Any

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest
from scipy import ndimage
from scipy.sparse import coo_array, csgraph

from urbanverse_mjx.datatypes import RobotSpec
from urbanverse_mjx.envs.navigation.clearance_maps import CELL
from urbanverse_mjx.evaluation import planner as planner_module
from urbanverse_mjx.evaluation import route_follower
from urbanverse_mjx.evaluation.planner import Motion, Planner, RouteField, waypoint_of
from urbanverse_mjx.evaluation.planner_options import PlannerOptions
from urbanverse_mjx.evaluation.route_fields import NODE
from urbanverse_mjx.evaluation.route_follower import RouteFollower
from urbanverse_mjx.robots import make_coco, make_go2

OPTIONS = PlannerOptions()
#: m, a square of 20 m, and what lies in it: a post, a kerb to the north of y = 1.6, ground that rises to the east and
#: to the north.
ORIGIN, CELLS = np.array([-10.0, -10.0]), round(20.0 / CELL)
POST, POST_RADIUS, KERB = np.array([1.9, -0.4]), 0.3, 1.6
#: m, x, y, heading, m/s, rad/s.
STATE = np.array([0.13, 0.21, 0.3, 0.9, -0.35])
#: (A, 6) x, y, vx, vy, radius, presence.
AGENTS = np.array([[2.4, 1.0, -0.5, 0.1, 0.3, 1.0], [1.1, -1.3, 0.2, 0.6, 0.25, 1.0], [0.2, 0.2, 0.0, 0.0, 0.5, 0.0]])


def to_hull(x: Any, y: Any) -> Any:
    return np.hypot(x - POST[0], y - POST[1]) - POST_RADIUS


def to_edge(x: Any, y: Any) -> Any:
    return np.minimum(KERB - y + 0.0 * x, 1.0)


def ground(x: Any, y: Any) -> Any:
    return 0.06 * x + 0.04 * y


def to_goal(x: Any, y: Any) -> Any:
    """Cost-metres of a goal at (3, 0.5), dearer to the north."""
    return np.hypot(x - 3.0, y - 0.5) * (1.0 + 0.1 * np.tanh(y))


def sampled(field: Any) -> np.ndarray:
    """(1, X, Y), a field at the centres of the cells."""
    x, y = np.meshgrid(*(o + (np.arange(CELLS) + 0.5) * CELL for o in ORIGIN), indexing="ij")
    return np.clip(field(x, y), -30.0, 30.0)[None].astype(np.float32)


def robot(name: str) -> RobotSpec:
    if name == "go2":
        return make_go2()
    return make_coco("ackermann" if name == "coco_ackermann" else "differential")


def env_of(spec: RobotSpec) -> Any:
    """What the controllers read of an environment."""
    model = mujoco.MjModel.from_xml_string(spec.mjcf)
    config = types.SimpleNamespace(action_mode="waypoint")
    return types.SimpleNamespace(robot=spec, mj_model=model, scenes=[0], bank=None, dynamic=None, dt=0.2, config=config)


class Graded(Planner):
    """Nearness to agents counts by depth."""

    AGENT_DEPTH = 2.0


def planner_of(name: str, monkeypatch: pytest.MonkeyPatch, kind: type[Planner], comfort: Any = None) -> Planner:
    maps = types.SimpleNamespace(
        to_hull=sampled(to_hull), to_edge=sampled(to_edge), ground=sampled(ground), origin=ORIGIN[None]
    )
    monkeypatch.setattr(planner_module, "build_clearance_maps", lambda *_: maps)
    return kind(env_of(robot(name)), comfort=comfort)


def drive(motion: Motion, pose: Any, v: Any, w: Any, targets: Any, dt: float, slope: Any) -> Any:
    """First-order lags towards the targets, and the arc of the mean speeds about the point without lateral motion."""
    wanted_v = targets[0] - motion.climb * slope[0]
    wanted_w = targets[1] - motion.veer * slope[1] / (1 + np.abs(v) / motion.eases)
    new_v = wanted_v + (v - wanted_v) * np.exp(-dt / motion.speed_lag)
    lag = motion.turn_lag / (1 + 0.5 * np.abs(new_v + v) / motion.eases)
    new_w = wanted_w + (w - wanted_w) * np.exp(-dt / lag)
    mean_v, mean_w = (new_v + v) / 2, (new_w + w) / 2
    x, y, yaw = pose
    middle = yaw + mean_w * dt / 2
    lateral = motion.pivot * mean_w
    x = x + dt * (mean_v * np.cos(middle) - lateral * np.sin(middle))
    y = y + dt * (mean_v * np.sin(middle) + lateral * np.cos(middle))
    return (x, y, yaw + dt * mean_w), new_v, new_w


def obeyed(motion: Motion, v: Any, omega: Any) -> tuple[Any, Any]:
    if np.isfinite(motion.lateral):
        v = np.minimum(v, motion.lateral / np.maximum(np.abs(omega), 1e-6))
    if min(motion.dead) == 0.0:
        return v, omega
    moves = (v / motion.dead[0]) ** 2 + (omega / motion.dead[1]) ** 2 >= 1.0
    return np.where(moves, v, 0.0), np.where(moves, omega, 0.0)


def at(pose: Any, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    x, y, yaw = (np.asarray(p)[..., None] for p in pose)
    return (
        x + np.cos(yaw) * points[:, 0] - np.sin(yaw) * points[:, 1],
        y + np.sin(yaw) * points[:, 0] + np.cos(yaw) * points[:, 1],
    )


class ByHand:
    """The costs of a planner, for all pairs of commands at once."""

    def __init__(self, planner: Planner, name: str) -> None:
        self.spec, self.planner = robot(name), planner
        self.motion, self.body = planner_module.motion_of(self.spec), planner_module.footprint(self.spec)
        shape = len(planner.first), len(planner._after) + len(OPTIONS.follow_speeds)
        #: How near a decision was to be another one; and the pairs that are looked at.
        self.doubt, self.columns = np.full(shape, np.inf), slice(None)

    def decide(self, value: Any, limit: float) -> Any:
        part = self.doubt[: len(value), self.columns]
        part[:] = np.minimum(part, np.abs(value - limit))
        return value > limit

    def field(self, pose: Any, ahead: float, side: float = 0.0) -> Any:
        x, y, yaw = pose
        return to_goal(x + ahead * np.cos(yaw + side), y + ahead * np.sin(yaw + side))

    def nose(self, pose: Any, side: float = 0.0) -> Any:
        points = np.array([[a * np.cos(side), a * np.sin(side)] for a in (0.36, 0.48, 0.6)])
        gap = np.minimum(to_hull(*at(pose, points)), to_edge(*at(pose, points))).min(-1)
        far, here = self.field(pose, 0.6, side), self.field(pose, 0.0)
        return np.where(self.decide(gap, 0.05), far, np.maximum(far, here))

    def downhill(self, pose: Any, speed: Any) -> Any:
        here, ahead, left, right = (
            self.field(pose, 0.0),
            *(self.nose(pose, side) for side in (0.0, OPTIONS.nose_angle, -OPTIONS.nose_angle)),
        )
        error = np.arctan2((right - left) / (2 * 0.6 * np.sin(OPTIONS.nose_angle)), (here - ahead) / 0.6)
        omega = np.clip(OPTIONS.follow_gain * error, -self.spec.max_yaw_rate, self.spec.max_yaw_rate)
        if np.isfinite(self.motion.curvature):
            return speed, np.clip(omega, -speed * self.motion.curvature, speed * self.motion.curvature)
        return speed * np.clip((here - ahead) / 0.6, 0.0, 1.0), omega

    def costs(self, first: np.ndarray, agents: Any, depth: float | None, comfort: Any) -> np.ndarray:
        after, follow = np.asarray(self.planner._after), np.array(OPTIONS.follow_speeds) * self.spec.max_speed
        shape = (len(first), len(after) + len(follow))
        x, y, yaw, v, w = (np.full(shape, s) for s in STATE)
        slower = OPTIONS.reference_speed / self.spec.max_speed
        steps = [s if k < OPTIONS.first_steps else s * slower for k, s in enumerate(OPTIONS.steps)]
        shy, mean, touched, near, left = (np.zeros(shape) for _ in range(5))
        driving, time, pose = np.ones(shape), 0.0, (x, y, yaw)
        for k, dt in enumerate(steps):
            if k < OPTIONS.first_steps:
                command = first[:, None, 0] + 0 * x, first[:, None, 1] + 0 * x
            else:
                self.columns = slice(len(after), None)
                down = self.downhill(tuple(p[:, len(after) :] for p in pose), follow)
                self.columns = slice(None)
                command = tuple(
                    np.concatenate([np.tile(after[:, c], (len(first), 1)), down[c] + np.zeros((len(first), 1))], 1)
                    for c in (0, 1)
                )
            slope = 0.0, 0.0
            if self.motion.climb or self.motion.veer:
                heights = ground(*at(pose, self.body.feet))
                plane = np.column_stack([self.body.feet, np.ones(len(self.body.feet))])
                fitted = np.linalg.lstsq(plane, heights.reshape(-1, len(plane)).T, rcond=None)[0][:2]
                slope = tuple(s.reshape(shape) for s in fitted)
            pose, v, w = drive(self.motion, pose, v, w, obeyed(self.motion, *command), dt, slope)
            time += dt
            discs = self.body.discs
            street = (to_hull(*at(pose, discs[:, :2])) - discs[:, 2]).min(-1)
            low = np.concatenate([self.body.feet, self.body.low])
            street = np.minimum(street, to_edge(*at(pose, low)).min(-1) - OPTIONS.edge_distance)
            gap, weight, uneasy = street, 2.0 - k / len(steps), 0.0
            if agents is not None:
                here = [row for row in agents if row[5] > 0]
                apart = [np.hypot(a + time * va - pose[0], b + time * vb - pose[1]) - r for a, b, va, vb, r, _ in here]
                free = np.min(apart, axis=0) - self.body.half_width
                people = free - OPTIONS.agent_distance - OPTIONS.agent_drift * time
                gap = np.minimum(gap, people)
                if depth is not None:
                    deep = np.maximum(OPTIONS.touch_distance - people, 0.0)
                    touches = ~self.decide(people, OPTIONS.touch_distance)
                    near = np.maximum(near, driving * (touches * weight + depth * deep))
                if comfort is not None:
                    uneasy = comfort[1] * np.clip((comfort[0] - free) / comfort[0], 0.0, 1.0)
            wanted = OPTIONS.margin + OPTIONS.margin_time * v
            shy += dt / slower * driving * (np.clip((wanted - gap) / wanted, 0.0, 1.0) ** 2 + uneasy)
            counts = ~self.decide(gap if depth is None else street, OPTIONS.touch_distance)
            touched = np.maximum(touched, driving * counts * weight)
            here = self.field(pose, 0.0)
            driving = driving * self.decide(here, OPTIONS.goal_distance)
            left = driving * ((here + self.nose(pose)) / 2 - OPTIONS.goal_distance + OPTIONS.nose)
            mean += left * dt / sum(steps)
        return left + OPTIONS.mean_weight * mean + OPTIONS.margin_cost * shy + OPTIONS.touch_cost * (touched + near)


@pytest.mark.parametrize(
    ("name", "kind", "agents", "comfort"),
    [
        ("go2", Planner, False, None),
        ("coco_differential", Planner, True, (0.8, 0.5)),
        ("coco_ackermann", Graded, True, None),
    ],
)
def test_costs_are_those_of_their_formula(
    name: str, kind: type[Planner], agents: bool, comfort: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where no decision is a matter of millimetres, which cells of 5 cm round to."""
    planner = planner_of(name, monkeypatch, kind, comfort)
    first = np.asarray(planner.first)[::2]
    nodes = [o + np.arange(round(20.0 / NODE)) * NODE for o in ORIGIN]
    route = RouteField(jnp.asarray(ORIGIN), jnp.asarray(to_goal(*np.meshgrid(*nodes, indexing="ij"))))
    people = jnp.asarray(AGENTS) if agents else None
    run = jax.jit(lambda state, first: planner.costs(jnp.int32(0), state, route, people, first))
    found = np.asarray(run(jnp.asarray(STATE), jnp.asarray(first)))
    by_hand = ByHand(planner, name)
    expected = by_hand.costs(first, AGENTS if agents else None, kind.AGENT_DEPTH, comfort)
    sure = by_hand.doubt[: len(first)] > 0.03
    assert sure.mean() > 0.3
    assert len(np.unique(np.round(expected[sure], 2))) > 0.3 * sure.sum()
    assert (expected[sure] > 900.0).any()
    assert (expected[sure] < 900.0).any()
    off = np.abs(found - expected)[sure] / (1.0 + np.abs(expected)[sure])
    assert off.max() < 0.12
    assert np.quantile(off, 0.9) < 5e-3
    assert np.median(off) < 2e-3
    # The cheapest command is the one that is given, as a waypoint.
    cheapest = first[expected.min(1).argmin()]
    given = planner._waypoint(jnp.asarray(first), jnp.asarray(expected.min(1)))
    np.testing.assert_allclose(given, waypoint_of(cheapest[0], cheapest[1], planner._robot.max_speed, 0.2), atol=1e-5)


class FollowedByHand:
    """The costs of a route follower."""

    def __init__(self, follower: RouteFollower, name: str, target: np.ndarray) -> None:
        self.motion, self.body, self.target = follower._motion, follower._body, target
        self.to_go = self._cost_to_go()
        assert robot(name).max_speed == follower._robot.max_speed

    def _cost_to_go(self) -> np.ndarray:
        """Least cost along edges to the eight neighbours, of which each metre costs what it does where it begins."""
        nodes = route_follower.NODES.astype(float)
        x, y = at(STATE[:3], nodes.reshape(-1, 2))
        gap = np.minimum(to_hull(x, y) - self.body.half_width, to_edge(x, y))
        dear = 1.0 + 20.0 * np.clip((0.4 - gap) / 0.4, 0.0, 1.0) ** 2
        far = np.hypot(*(nodes.reshape(-1, 2) - self.target).T)
        number = np.arange(len(far)).reshape(nodes.shape[:2])
        rows: list[tuple[int, int, float]] = []
        for i in range(nodes.shape[0]):
            for j in range(nodes.shape[1]):
                for a in range(max(i - 1, 0), min(i + 2, nodes.shape[0])):
                    for b in range(max(j - 1, 0), min(j + 2, nodes.shape[1])):
                        if (a, b) != (i, j):
                            step = 0.3 * np.hypot(a - i, b - j) * dear[number[i, j]]
                            rows.append((int(number[a, b]), int(number[i, j]), float(step)))
        end = len(far)
        rows += [(end, int(n), float(far[n])) for n in np.flatnonzero(far < 0.45)]
        start, stop, cost = zip(*rows, strict=True)
        graph = coo_array((cost, (start, stop)), (end + 1, end + 1)).tocsr()
        return csgraph.dijkstra(graph, indices=end)[:end].reshape(nodes.shape[:2])

    def cost(self, command: np.ndarray) -> float:
        pose, v, w, before, total, shy, touched, left = tuple(STATE[:3]), STATE[3], STATE[4], 0.0, 0.0, 0.0, 0.0, 0.0
        for time in route_follower.TIMES:
            dt, before = time - before, time
            pose, v, w = drive(self.motion, pose, v, w, obeyed(self.motion, *command), dt, (0.0, 0.0))
            discs = self.body.discs
            gap = min(
                (to_hull(*at(pose, discs[:, :2])) - discs[:, 2]).min(), to_edge(*at(pose, self.body.feet)).min() + 0.12
            )
            share = dt / route_follower.TIMES[-1]
            shy += share * np.clip((0.4 - gap) / 0.4, 0.0, 1.0) ** 2
            touched = max(touched, (gap < 0.02) * (2.0 - time / route_follower.TIMES[-1]))
            nose = np.array([pose[0] + 0.6 * np.cos(pose[2]), pose[1] + 0.6 * np.sin(pose[2])]) - STATE[:2]
            c, s = np.cos(STATE[2]), np.sin(STATE[2])
            local = np.array([c * nose[0] + s * nose[1], c * nose[1] - s * nose[0]])
            place = (local - route_follower.NODES[0, 0]) / 0.3
            left = float(ndimage.map_coordinates(self.to_go, place[:, None], order=1, mode="nearest")[0])
            total += share * left
        return left + total + 5.0 * shy + 30.0 * touched


@pytest.mark.parametrize("name", ["coco_differential", "coco_ackermann"])
def test_the_route_follower_takes_the_command_of_least_cost(name: str) -> None:
    """Shortest paths by Dijkstra's algorithm, predicted drives in NumPy; past a post, along a kerb."""

    def distances(nav: Any, points: Any) -> Any:
        del nav
        x, y = points[..., 0], points[..., 1]
        hull = jnp.sqrt((x - POST[0]) ** 2 + (y - POST[1]) ** 2) - POST_RADIUS
        return jnp.stack([hull, jnp.minimum(KERB - y, 1.0)], -1)

    env = env_of(robot(name))
    env.distances = distances
    follower = RouteFollower(env)
    half = STATE[2] / 2
    moving = np.array([STATE[3] * np.cos(STATE[2]), STATE[3] * np.sin(STATE[2]), 0.0, 0.0, 0.0, STATE[4]])
    count = env.mj_model.nbody
    sim = types.SimpleNamespace(
        xpos=jnp.zeros((count, 3)).at[follower._root].set(jnp.array([*STATE[:2], 0.3])),
        xquat=jnp.zeros((count, 4)).at[follower._root].set(jnp.array([np.cos(half), 0.0, 0.0, np.sin(half)])),
        qvel=jnp.asarray(moving, jnp.float32),
    )
    route = jnp.asarray([[3.0, -0.2, 0.0], [3.0, 3.0, 0.0], [3.0, 3.0, 0.0]], jnp.float32)
    nav: Any = types.SimpleNamespace(sim=sim, start=jnp.array([-1.0, -0.2, 0.0, 0.0]), waypoints=route)
    # 3.5 m along the route from the nearest point of it: 1.13 m + 3.5 m, of which 4 m before the corner.
    place = np.array([3.0, -0.2 + 0.63])
    np.testing.assert_allclose(follower.target(nav, sim.xpos[follower._root, :2]), place, atol=1e-5)
    c, s = np.cos(STATE[2]), np.sin(STATE[2])
    away = place - STATE[:2]
    by_hand = FollowedByHand(follower, name, np.array([c * away[0] + s * away[1], c * away[1] - s * away[0]]))
    pose = jnp.asarray(STATE[:3], jnp.float32)
    found = follower._cost_to_go(nav, pose, jnp.asarray(by_hand.target, jnp.float32))
    np.testing.assert_allclose(found, by_hand.to_go, rtol=1e-4, atol=1e-3)
    commands = np.asarray(follower._commands, float)
    expected = np.array([by_hand.cost(command) for command in commands])
    run = jax.jit(jax.vmap(lambda one: follower._cost(nav, pose, jnp.float32(STATE[3]), sim.qvel[5], found, one)))
    np.testing.assert_allclose(run(follower._commands), expected, rtol=1e-3, atol=2e-3)
    assert (expected > 30.0).any()
    best = commands[expected.argmin()]
    assert np.diff(np.sort(expected))[0] > 5e-3, "one is the best"
    np.testing.assert_allclose(follower.act(nav), waypoint_of(best[0], best[1], env.robot.max_speed, env.dt), atol=1e-5)
    limit = follower._motion.curvature
    possible = [
        (v * env.robot.max_speed, w * env.robot.max_yaw_rate)
        for v in (0.0, 0.2, 0.4, 0.7, 1.0)
        for w in (-1.0, -0.6, -0.35, -0.2, -0.1, 0.0, 0.1, 0.2, 0.35, 0.6, 1.0)
        if not np.isfinite(limit) or abs(w) * env.robot.max_yaw_rate <= v * env.robot.max_speed * limit + 1e-9
    ]
    np.testing.assert_allclose(commands, possible, atol=1e-6)


def test_the_followers_grid_of_commands_and_times_covers_what_a_robot_does() -> None:
    """Commands to both sides alike, from standing to the top; between two checked times a robot drives less than its
    own length, and the last is the time in which it may stop."""
    assert list(route_follower.TURNS) == [-x for x in reversed(route_follower.TURNS)]
    for shares in (route_follower.SPEEDS, route_follower.TURNS):
        assert list(shares) == sorted(set(shares))
        assert shares[-1] == 1.0
    assert route_follower.SPEEDS[0] == 0.0
    steps = np.diff(route_follower.TIMES, prepend=0.0)
    assert (steps > 0.0).all()
    assert (np.diff(steps) > -1e-9).all(), "finer where the next command cannot change anything"
    for spec in (make_coco(), make_go2()):
        assert steps.max() * spec.max_speed < 2.0 * spec.planner_radius
    near = np.linalg.norm(route_follower.NODES, axis=-1)
    assert near.min() < 1e-6
    assert np.abs(route_follower.NODES).max(axis=(0, 1))[0] > route_follower.LOOKAHEAD_DISTANCE
    # A sweep carries costs to the next node: all are reached from one corner.
    assert route_follower.SWEEPS >= max(route_follower.NODES.shape[:2])
