"""`RouteFollower`: a scripted controller that uses the reference route and the distances to hulls and edges.

A dynamic window (Fox, Burgard and Thrun, "The Dynamic Window Approach to Collision Avoidance", 1997): of several dozen
constant commands, it selects the one whose arc keeps clear of hulls and edges and ends nearest to a point of the route
ahead. It uses distances that the environment computes anyway and needs no preparation, so it labels states for
imitation at a fraction of the cost of `Planner`, which plans better. It uses only the distance to moving agents.
"""

import itertools
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from ..datatypes import ValidationError
from ..envs import NavEnv, NavState
from ..envs.navigation import terms
from ..geometry import rotations
from ..robots.footprint import footprint
from .planner import motion_of, placed, waypoint_of

#: Shares of the top speed and of the top yaw rate that commands combine.
SPEEDS = (0.0, 0.2, 0.4, 0.7, 1.0)
TURNS = (-1.0, -0.6, -0.35, -0.2, -0.1, 0.0, 0.1, 0.2, 0.35, 0.6, 1.0)
#: s, prediction times at which a drive with a constant command is checked.
TIMES = (0.2, 0.4, 0.6, 0.9, 1.2, 1.6)
#: m, clearance below which the cost of a drive rises, and below which it counts as contact; the distances have an error
#: of half a cell of 0.2 m.
COMFORT_DISTANCE, CONTACT_DISTANCE = 0.4, 0.02
#: m, tolerance of the feet's distance to an edge, which is that of the nearest cell that is not completely walkable.
EDGE_TOLERANCE = 0.12
#: Cost in metres of zero clearance during the whole drive, and of a contact.
ZERO_CLEARANCE_COST, CONTACT_COST = 5.0, 30.0
#: m, spacing of the nodes of the cost-to-go; (X, Y, 2) m, nodes in the heading frame.
STEP = 0.3
NODES = np.stack(np.meshgrid(np.arange(-4, 17) * STEP, np.arange(-10, 11) * STEP, indexing="ij"), -1).astype(np.float32)
#: m, distance along the route from the point nearest to the robot to the target point.
LOOKAHEAD_DISTANCE = 3.5
#: Additional cost per metre where the robot does not fit, and number of sweeps of the cost-to-go.
BLOCKED_COST, SWEEPS = 20.0, 26
_NEIGHBOURS = tuple((i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0))


def route_point(start: Any, waypoints: Any, position: Any) -> Any:
    """(2,) m, point of the polyline start (3,), waypoints (W, 3) at an arc length (m); the end point beyond it."""
    points = jnp.concatenate([start[None, :2], waypoints[:, :2]])
    span = points[1:] - points[:-1]
    length = jnp.sqrt((span**2).sum(-1) + 1e-12)
    share = jnp.clip((position - (jnp.cumsum(length) - length)) / length, 0.0, 1.0)
    # Segments before the position count completely, those after it not at all.
    return points[0] + (share[:, None] * span).sum(0)


class RouteFollower:
    """The controller; `act` uses the env's complete state, see `agents.Privileged`.

    Args:
      env: environment with `action_mode="waypoint"`.

    Raises:
      ValidationError: the action mode is another one.
    """

    def __init__(self, env: NavEnv) -> None:
        robot, mode = env.robot, env.config.action_mode
        if mode != "waypoint":
            raise ValidationError(
                f"route follower: found action_mode {mode!r}, needed 'waypoint'; take a preset of PPO."
            )
        motion = motion_of(robot)
        commands = np.array(list(itertools.product(SPEEDS, TURNS))) * [robot.max_speed, robot.max_yaw_rate]
        if np.isfinite(motion.curvature):
            commands = commands[np.abs(commands[:, 1]) <= commands[:, 0] * motion.curvature + 1e-9]
        self._commands = jnp.asarray(commands, jnp.float32)
        self._env, self._robot, self._motion, self._body = env, robot, motion, footprint(robot)
        self._root = env.mj_model.body(robot.root_body).id

    def prepare(self, scenes: np.ndarray, rows: np.ndarray) -> None:
        """Returns no data, because the state contains the route."""

    def target(self, nav: NavState, xy: Any) -> Any:
        """(2,) m, the point to drive to from (2,) m."""
        here = terms.route_position(xy, nav.start, nav.waypoints)
        return route_point(nav.start, nav.waypoints, here + LOOKAHEAD_DISTANCE)

    def act(self, nav: NavState, known: Any = None) -> Any:
        """(2,) waypoint in [-1, 1]."""
        return self.towards(nav, self.target(nav, nav.sim.xpos[self._root, :2]))

    def towards(self, nav: NavState, place: Any) -> Any:
        """(2,) waypoint in [-1, 1] on the way to a place (2,) m."""
        xy, yaw = nav.sim.xpos[self._root, :2], rotations.yaw_of(nav.sim.xquat[self._root])
        target = terms.to_body(place - xy, yaw)
        speed = terms.to_body(nav.sim.qvel[:2], yaw)[0]
        pose = jnp.nan_to_num(jnp.stack([xy[0], xy[1], yaw]))
        to_go = self._cost_to_go(nav, pose, target)
        act = nav, pose, speed, nav.sim.qvel[5], to_go
        costs = jax.vmap(lambda command: self._cost(*act, command))(self._commands)
        v, omega = self._commands[costs.argmin()]
        return waypoint_of(v, omega, self._robot.max_speed, self._env.dt)

    def _cost_to_go(self, nav: NavState, pose: Any, target: Any) -> Any:
        """(X, Y) cost in metres, higher near obstacles, from each of the `NODES` around a pose (3,) to a target
        (2,)."""
        found = self._env.distances(nav, pose[:2] + terms.to_world(jnp.asarray(NODES), pose[2]))
        gap = jnp.minimum(found[..., 0] - self._body.half_width, found[..., 1])
        dear = 1.0 + BLOCKED_COST * jnp.clip((COMFORT_DISTANCE - gap) / COMFORT_DISTANCE, 0.0, 1.0) ** 2
        far = jnp.sqrt(((NODES - target) ** 2).sum(-1) + 1e-9)
        x, y = far.shape

        def sweep(_: int, cost: Any) -> Any:
            wide = jnp.pad(cost, 1, constant_values=1e3)
            for i, j in _NEIGHBOURS:
                moved = wide[1 + i : 1 + i + x, 1 + j : 1 + j + y] + STEP * np.hypot(i, j) * dear
                cost = jnp.minimum(cost, moved)
            return cost

        return jax.lax.fori_loop(0, SWEEPS, sweep, jnp.where(far < 1.5 * STEP, far, 1e3))

    def _cost(self, nav: NavState, start: Any, speed: Any, turn: Any, to_go: Any, command: Any) -> Any:
        """Cost of a drive: remaining metres after and during it, and nearness to objects."""
        motion = self._motion
        targets = motion.obeyed(command[0], command[1])
        pose, v, w, poses = start, speed, turn, []
        for dt in np.diff(TIMES, prepend=0.0).tolist():
            pose, v, w = motion.drive(pose, v, w, targets, dt)
            poses.append(pose)
        drive = jnp.stack(poses)
        gaps, times = self._gaps(nav, drive), np.array(TIMES)
        steps = np.diff(times, prepend=0.0) / times[-1]
        shy = (steps * jnp.clip((COMFORT_DISTANCE - gaps) / COMFORT_DISTANCE, 0.0, 1.0) ** 2).sum()
        # Later contacts cost less, because the next command can still avoid them.
        touched = ((gaps < CONTACT_DISTANCE) * (2.0 - times / times[-1])).max()
        nose = drive[:, :2] + 0.6 * jnp.stack([jnp.cos(drive[:, 2]), jnp.sin(drive[:, 2])], -1)
        local = terms.to_world(nose - start[:2], -start[2])
        left = _at(to_go, local)
        return left[-1] + (steps * left).sum() + ZERO_CLEARANCE_COST * shy + CONTACT_COST * touched

    def _gaps(self, nav: NavState, drive: Any) -> Any:
        """(T,) m, least distance of the robot at poses (T, 3) to hulls and of its feet to an edge."""
        discs, feet = self._body.discs, self._body.feet
        points = np.concatenate([discs[:, :2], feet[:, :2]])
        found = self._env.distances(nav, jnp.stack(placed(drive, points), -1))
        to_hull = found[:, : len(discs), 0] - discs[:, 2].astype(np.float32)
        return jnp.minimum(to_hull.min(-1), found[:, len(discs) :, 1].min(-1) + EDGE_TOLERANCE)


def _at(values: Any, points: Any) -> Any:
    """(n,) values of the `NODES` at points (n, 2) in the heading frame by bilinear interpolation; those of the border
    outside."""
    place = (points - NODES[0, 0]) / STEP
    return jax.scipy.ndimage.map_coordinates(values, [place[:, 0], place[:, 1]], order=1, mode="nearest")
