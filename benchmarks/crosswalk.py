"""Renders a video of a robot that waits for people at a crosswalk.

    python -m benchmarks.crosswalk --impl warp --seconds 32 --every 2 --quality 3 --out docs/crosswalk.mp4

drives COCO in the environment's own physics along an episode's route that uses a crosswalk, while four people come over
it towards the robot and the other agents move as in the scenario `dynamic`. The controller is a privileged rule, not a
policy: it follows the route, stops at the kerb while a person is on the crosswalk or a vehicle approaches it, and stops
for agents right ahead. The video shows the robot's camera image and the crosswalk from above. The last line of stdout
is one JSON object: waiting time, result, least distance to people.
"""

import argparse
import json
import pathlib
import sys
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from urbanverse_mjx.crowds import behaviours
from urbanverse_mjx.crowds.crossings import crossing_at
from urbanverse_mjx.crowds.spawning import Observer
from urbanverse_mjx.datatypes import KIND_INDEX, SceneBank, ValidationError
from urbanverse_mjx.envs import NavEnv, Result, registry
from urbanverse_mjx.envs.navigation import terms
from urbanverse_mjx.envs.navigation.dynamic import slot_appearances
from urbanverse_mjx.envs.navigation.encounters import route_pose
from urbanverse_mjx.geometry import rotations
from urbanverse_mjx.geometry.grids import cell_of
from urbanverse_mjx.simulation.rendering.cameras import look_at
from urbanverse_mjx.simulation.rendering.renderer import Renderer
from urbanverse_mjx.viz.video import write_video

HEIGHT, WIDTH, FOV = 180, 320, 0.9
#: m: look-ahead distance, waiting distance before the crosswalk, and distance at which it stops for people ahead.
_AHEAD, _LINE, _STOP = 0.8, 0.7, 1.3
#: m ahead of the robot's middle, points at which it checks for the crosswalk.
_FRONT = (0.7, 0.9, 1.1)
#: rad, candidate deviations from the direction; m, least distance from its centre to obstacles (contact at 0.4).
_TURNS, _CLEAR = jnp.radians(jnp.arange(-75.0, 76.0, 15.0)), 0.6
#: m, least length of the route before the crosswalk (at most twice that) and behind it.
_BEFORE, _BEHIND = 4.5, 2.6
#: m, the robot waits for vehicles within this distance of the crosswalk that are at least this fast (m/s).
_VEHICLE, _ROLLING = 12.0, 0.8
#: m/s, speeds of the people, so slow that they are still on the crosswalk when the robot arrives.
_STROLL = (0.7, 0.6, 0.55, 0.5)
#: m, position of the crosswalk camera beside and above the robot's path.
_CAMERA_POSITION = (6.0, 6.0)


def parse(argv: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.crosswalk", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--bank", help="bank file; default: the shipped streets")
    parser.add_argument("--scene", default="commercial_cafes")
    parser.add_argument("--out", type=pathlib.Path, required=True, help="mp4 to write")
    parser.add_argument("--seconds", type=float, default=24.0, help="longest drive")
    parser.add_argument("--impl", default="auto", help="engine")
    parser.add_argument("--every", type=int, default=1, help="control steps (0.1 s) for each frame")
    parser.add_argument("--quality", type=float, default=4.0, help="of the video, 0 to 10")
    parser.add_argument("--seed", type=int, default=0)
    return parser.parse_args(argv)


def crossing_rows(bank: SceneBank, scene: int) -> list[tuple[int, float, float]]:
    """Returns the rows of a scene's episode table whose route uses a crosswalk, with the start and end of the crossing
    (m), straightest crossings first."""
    origin, side = bank.map_origin[scene], float(bank.map_resolution)
    rows = []
    for row in range(int(bank.num_episodes[scene])):
        points = np.concatenate([bank.episode_start[scene, row, None, :2], bank.episode_waypoints[scene, row, :, :2]])
        step = np.linalg.norm(np.diff(points, axis=0), axis=1)
        arc = np.arange(0.0, step.sum(), side)
        xy = np.stack([np.interp(arc, np.concatenate([[0.0], np.cumsum(step)]), points[:, k]) for k in (0, 1)], -1)
        cell = cell_of(xy, origin, side, bank.map_kind.shape[1:])
        on = arc[bank.map_kind[scene, cell[:, 0], cell[:, 1]] == KIND_INDEX["crosswalk"]]
        if not len(on) or on[0] < _BEFORE:
            continue
        first, last = float(on[0]), float(on[on < on[0] + 15.0][-1])
        if first > 2.0 * _BEFORE or arc[-1] < last + _BEHIND:
            continue
        ends = [xy[round(a / side)] for a in (first - 1.5, last + 1.5)]
        rows.append(((last - first + 3.0) / float(np.linalg.norm(ends[1] - ends[0])), (row, first, last)))
    if not rows:
        raise ValidationError(f"--scene: found no route over a crosswalk in {bank.scene_ids[scene]}, needed one.")
    return [row for _, row in sorted(rows)]


def people_coming(start: Any, waypoints: Any, first: float, last: float) -> behaviours.Script:
    """Returns four people that start on the far pavement, two on either side of the route, and cross towards the
    robot."""
    scripts = []
    places = ((1.2, 2.0), (1.6, -2.2), (2.2, 1.0), (2.6, -1.2))
    for (back, left), speed in zip(places, _STROLL, strict=True):
        far, near = (route_pose(start, waypoints, arc) for arc in (last + back, max(first - 3.0, 0.5)))
        aside = np.copysign(1.6, left)
        x, y = (far[0] - left * jnp.sin(far[2]), far[1] + left * jnp.cos(far[2]))
        to = (near[0] - aside * jnp.sin(near[2]), near[1] + aside * jnp.cos(near[2]))
        x, y, to_x, to_y = (jnp.reshape(v, (1,)) for v in (x, y, *to))
        scripts.append(behaviours.go(x, y, to_x, to_y, speed))
    return behaviours.together(*scripts)


class Controller:
    """Rule-based controller; returns an action for a state of one env."""

    def __init__(self, env: NavEnv, scene: int, row: int, first: float, last: float) -> None:
        assert env.dynamic is not None, "the scenario is dynamic"
        self.env, self.dynamic, self.first = env, env.dynamic, first
        self.start, self.waypoints = (
            jnp.asarray(a[scene, row]) for a in (env.bank.episode_start, env.bank.episode_waypoints)
        )
        self.table = self.dynamic.model.tables.crossings
        x, y, _ = route_pose(self.start, self.waypoints, 0.5 * (first + last))
        self.scene, self.row = scene, self.dynamic.row(scene)
        self.number = crossing_at(self.table, self.row, x, y)
        self.middle = jnp.stack([x, y])
        self.over = jnp.stack(route_pose(self.start, self.waypoints, last)[:2])
        self.drives = jnp.array([k.surface == "road" for k in self.dynamic.model.kinds])

    def taken(self, crowd: Any) -> Any:
        """Returns () bool, whether a person is on or close to the crosswalk, or a moving vehicle approaches it."""
        body = crowd.bodies
        reach = jnp.array([0.0, 0.8])[:, None]
        x, y = (p + reach * f(body.heading) for p, f in ((body.x, jnp.cos), (body.y, jnp.sin)))
        on = (crossing_at(self.table, self.row, x, y) == self.number).any(0)
        away = jnp.hypot(body.x - self.middle[0], body.y - self.middle[1])
        nears = self.drives & (away < _VEHICLE) & (jnp.hypot(body.vx, body.vy) > _ROLLING)
        return (crowd.present & (on | nears)).any()

    def __call__(self, nav: Any) -> tuple[Any, Any]:
        """Returns the action (2,), and () bool, whether the robot waits."""
        root = self.env.mj_model.body(self.env.robot.root_body).id
        p_xy, yaw = nav.sim.xpos[root, :2], rotations.yaw_of(nav.sim.xquat[root])
        arc = terms.route_position(p_xy, self.start[:3], self.waypoints)
        line = self.first - _LINE - self.env.robot.planner_radius
        front = p_xy + terms.to_world(jnp.array([[0.0, 0.0], *([d, 0.0] for d in _FRONT)]), yaw)
        here, *edge = crossing_at(self.table, self.row, front[:, 0], front[:, 1]) == self.number
        taken = self.taken(nav.crowd)
        # The robot may leave its route to go around objects, so the distance ahead is checked as well as the distance
        # driven.
        comes = ~here & jnp.stack(edge).any()
        waits = taken & ((arc < self.first) | comes) & ~here
        aim = jnp.where(waits, jnp.minimum(arc + _AHEAD, line), arc + _AHEAD)
        x, y, _ = route_pose(self.start, self.waypoints, aim)
        walk = self.around(p_xy, jnp.stack([x, y]) - p_xy)
        walk = terms.to_body(walk, yaw)
        ahead = p_xy + terms.to_world(jnp.array([[0.6, 0.0], [1.1, 0.0]]), yaw)
        blocked = self.dynamic.gaps(nav.crowd, ahead).min() < _STOP - 0.6
        at_line = waits & (comes | (line - arc < 0.1))
        # A waiting robot faces the crosswalk: a waypoint 2 mm away turns it there without moving it.
        over = terms.limit_norm(terms.to_body(self.over - p_xy, yaw), 0.002)
        still = jnp.where(at_line & ~blocked, over, 0.0)
        # A waypoint 1 m ahead means 2 m/s: this is at most 1.1 m/s, less where it is to stop.
        stands = jnp.linalg.norm(nav.sim.qvel[:2]) < 0.1
        return jnp.where(blocked | at_line, still, terms.limit_norm(walk, 0.55)), stands & (waits | blocked)

    def around(self, p_xy: Any, walk: Any) -> Any:
        """A direction (2,) m rotated as little as needed for `_CLEAR` from obstacles: routes cut corners between
        waypoints."""
        turned = jax.vmap(lambda a: terms.to_world(walk, a))(_TURNS)
        ahead = turned / jnp.maximum(jnp.linalg.norm(walk), 1e-6)
        points = p_xy + jnp.array([0.4, 0.8, 1.2])[:, None, None] * ahead
        room = self.env._surroundings.distances(self.scene, points)[..., 0].min(0)
        cost = jnp.abs(_TURNS) + 10.0 * jnp.maximum(_CLEAR - room, 0.0)
        return turned[jnp.argmin(cost)]


def drive(env: NavEnv, controller: Controller, nav: Any, steps: int) -> tuple[Any, Any]:
    """Returns the last state, and the positions, waiting flags and distances to people at each step."""
    step = jax.jit(env.advance)
    act, where = jax.jit(controller), jax.jit(controller.dynamic.places)
    path = []
    for _ in range(steps):
        action, waits = act(nav)
        here = (nav.sim.xpos, nav.sim.xquat, where(nav.crowd, nav.sim.scene))
        nav, _, done, metrics = step(nav, action)
        path.append(jax.device_get((*here, waits, metrics["people_distance"])))
        if done:
            break
    return nav, jax.tree.map(lambda *x: np.stack(x), *path)


def film(env: NavEnv, controller: Controller, path: Any, every: int) -> list[np.ndarray]:
    """Renders the robot's camera image next to a view of the crosswalk from above."""
    assert env.dynamic is not None, "the scenario is dynamic"
    appearances = slot_appearances(env.dynamic.kinds, env.bank)
    renderer = Renderer(env.bank, env.robot, HEIGHT, WIDTH, shadows=True, agents=appearances)
    middle = np.asarray(controller.middle)
    along = np.asarray(controller.waypoints[-1, :2] - controller.start[:2])
    side = np.array([-along[1], along[0]]) / np.linalg.norm(along)
    camera_position = np.array([*(middle - _CAMERA_POSITION[0] * side), _CAMERA_POSITION[1]])
    turn = look_at(camera_position, np.array([*middle, 0.4]))
    seen = jax.jit(lambda p, q, a: renderer(controller.scene, p, q, 0, a)["rgb"])
    above = jax.jit(lambda p, q, a: renderer.view(controller.scene, camera_position, turn, FOV, p, q, 0, a)["rgb"])
    xpos, xquat, agents = path[:3]
    frames = []
    for t in range(0, len(xpos), every):
        now = (xpos[t], xquat[t], jax.tree.map(lambda x, t=t: x[t], agents))
        frames.append(np.concatenate([np.asarray(seen(*now)), np.asarray(above(*now))], axis=1))
    return frames


def main(argv: list[str] | None = None) -> int:
    arguments = parse(argv)
    bank = SceneBank.load(arguments.bank) if arguments.bank else registry.load_default_bank()
    overrides = {
        "scenario": "dynamic",
        "scenes": arguments.scene,
        "vision": False,
        "impl": arguments.impl,
        "ctrl_dt": 0.1,
        "episode_length": 10_000,
    }
    env = registry.load("CocoNav", config_overrides=overrides, bank=bank)
    scene = int(env.scenes[0])
    row, first, last = crossing_rows(bank, scene)[0]
    controller = Controller(env, scene, row, first, last)
    key = jax.random.key(arguments.seed)
    nav = jax.jit(env.begin_at)(key, jnp.int32(scene), jnp.int32(row))
    observer = Observer(controller.start[0], controller.start[1], controller.start[3], jnp.array(True))
    script = people_coming(controller.start, controller.waypoints, first, last)
    crowd = jax.jit(lambda k: controller.dynamic.model.init(k, controller.row, observer, None, script))(key)
    nav, path = drive(env, controller, nav._replace(crowd=crowd), round(arguments.seconds / env.dt))
    frames = film(env, controller, path, arguments.every)
    write_video(arguments.out, frames, 1.0 / (env.dt * arguments.every), quality=arguments.quality)
    waits, distance = path[3:]
    print(
        json.dumps(
            {
                "video": str(arguments.out),
                "bytes": arguments.out.stat().st_size,
                "scene": arguments.scene,
                "episode": row,
                "seconds": round(len(waits) * env.dt, 1),
                "waited_s": round(float(waits.sum()) * env.dt, 1),
                "ended": Result(int(nav.result)).name,
                "nearest_person_m": round(float(distance.min()), 2),
                "route_done_m": round(float(nav.route_done), 1),
                "crosswalk_m": [round(first, 1), round(last, 1)],
            }
        )
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
