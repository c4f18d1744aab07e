"""One long mission: a robot, the loop of `urbanverse deploy`, people, and a scripted supervisor that takes over.

The `Controller` of `urbanverse deploy` drives the robot by its own messages, in simulated time: odometry 50 and images
5 times a second, commands that expire, its watchdogs. The supervisor stands for the person with the remote control of
the paper's mission: see `Supervisor`.
"""

import dataclasses
import itertools
import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from scipy import ndimage

from benchmarks.lib import shifts as s
from benchmarks.lib.mission_streets import Mission
from benchmarks.lib.street_world import TICK, World
from urbanverse_mjx.datatypes import RobotSpec, traversable
from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.datatypes.policy_file import RobotRecord
from urbanverse_mjx.deployment.contract import Contract
from urbanverse_mjx.deployment.controller import Controller, Limits, Request
from urbanverse_mjx.deployment.messages import Command, Image, Odometry
from urbanverse_mjx.deployment.robot_side import CommandGate
from urbanverse_mjx.geometry import rotations
from urbanverse_mjx.scene.geometry import SceneMap
from urbanverse_mjx.scene.planner import GoalField, RobotSize, free_space, resample

#: m between waypoints (the paper's GPS waypoints), m within which one counts as reached, s after which a mission ends.
SPACING, RADIUS, HORIZON = 10.0, 1.5, 1500.0
#: Ticks between two images, and between two steps of people and looks of the supervisor.
IMAGE, LOOK = 10, 5
NEAR = 3.0  # m, from a corner of a mission to its route
_EPOCH = 10**9  # ns that the robot's clock shows at the beginning
CAUSES = ("stuck", "near object", "near person", "leaving the pavement", "contact")


@dataclasses.dataclass(frozen=True)
class Watch:
    """When the supervisor takes over, and when it hands back; chosen by us.

    Attributes:
      ahead: s for which the present command is followed in thought; what it would touch or leave is about to happen. At
        2 m/s COCO needs 0.6 m to stop, so 0.5 s are late but not too late.
      gap: m between body and object that counts as touching.
      still, within: a robot that has moved less than `still` m in `within` s is stuck.
      drives: m that the supervisor drives before it hands back; at: m/s.
      give_up: s after which the supervisor gives the mission up.
    """

    ahead: float = 0.5
    gap: float = 0.03
    still: float = 1.0
    within: float = 20.0
    drives: float = 3.0
    at: float = 0.7
    give_up: float = 60.0


class Surroundings:
    """A scene's map for one robot: distances to objects, the traversable ground, and shortest routes."""

    def __init__(self, scene_map: SceneMap, height: float) -> None:
        self._map = scene_map
        self._space = free_space(scene_map, RobotSize(height=height))
        self._passable = np.argwhere(self._space.cost > 0.0)
        # A kerb is no object; what is lower than the robot over the ground is.
        solid = np.isnan(scene_map.height) | (scene_map.clearance < height)
        self._objects = ndimage.distance_transform_edt(~solid) * scene_map.resolution
        self._open = traversable(scene_map.kind)

    def _cells(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        cells = self._map.grid.cell(points)
        return cells[..., 0], cells[..., 1]

    def objects(self, points: np.ndarray) -> np.ndarray:
        """(...) m from points (..., 2) to the nearest object."""
        return self._objects[self._cells(points)]

    def is_open(self, points: np.ndarray) -> np.ndarray:
        """(...) bool, whether the robot may be at points (..., 2)."""
        return self._open[self._cells(points)]

    def _nearest(self, cells: np.ndarray, point: np.ndarray) -> np.ndarray:
        return cells[np.linalg.norm(self._space.coarse_center(cells) - point, axis=1).argmin()]

    def route(self, start: np.ndarray, goal: np.ndarray) -> np.ndarray:
        """(k, 2) m, shortest route over pavements and crossings from near `start` to near `goal`, (2,) m each."""
        field = GoalField(self._space, self._nearest(self._passable, goal))
        reachable = self._passable[np.isfinite(field.cost[tuple(self._passable.T)])]
        return field.paths(self._nearest(reachable, start)[None])[0]

    def waypoints(self, via: Sequence[tuple[float, float]]) -> np.ndarray:
        """(n, 2) m, places every `SPACING` along the shortest route through points, which is where it begins and
        ends.

        Raises:
          ValidationError: the route does not come near one of them.
        """
        points = np.array(via)
        parts = [self.route(a, b) for a, b in itertools.pairwise(points)]
        for part, (a, b) in zip(parts, itertools.pairwise(points), strict=True):
            off = max(np.linalg.norm(part[0] - a), np.linalg.norm(part[-1] - b))
            if off > NEAR:
                raise v.fail("mission", f"a route {off:.1f} m off its corner", f"at most {NEAR:g} m")
        route = np.concatenate([parts[0], *(part[1:] for part in parts[1:])])
        return np.concatenate([route[:1], resample(route, SPACING)])


class Supervisor:
    """Takes over when the robot is stuck, about to touch something or somebody, about to leave the traversable ground,
    or has touched something; drives along the route for a few metres and hands back.

    Attributes:
      active: whether it drives.
      causes: of its interventions, of `CAUSES`.
      lost: whether it has given up.
    """

    def __init__(
        self,
        world: World,
        near: Surroundings,
        gaps: Callable[[np.ndarray], np.ndarray],
        waypoints: np.ndarray,
        watch: Watch | None = None,
    ) -> None:
        self._world, self._gaps, self._watch = world, gaps, watch or Watch()
        self._near, self._waypoints = near, waypoints
        half_length, half_width = BODIES[world.robot.name.split("_")[0]]
        # Two discs along the body cover it.
        self._discs, self._radius = np.array([half_length - half_width, half_width - half_length]), half_width
        self.active, self.lost = False, False
        self.causes: list[str] = []
        self._track: list[np.ndarray] = []
        self._path = np.zeros((0, 2))
        self._begun, self._driven = 0.0, 0.0

    def look(self, velocity: tuple[float, float], waypoint: int) -> None:
        """Decides, every `LOOK` ticks; velocity: that in force. waypoint: number of the next one."""
        world, watch = self._world, self._watch
        self._track.append(world.pose)
        if self.active:
            step = self._track[-1][:2] - self._track[-2][:2]
            self._driven += float(np.hypot(*step))
            if world.time - self._begun > watch.give_up:
                self.lost = True
            elif self._driven >= watch.drives and self._danger(velocity) is None:
                self.active, world.hit = False, None
                self._track = self._track[-1:]
            return
        cause = "contact" if world.hit is not None else self._danger(velocity) or self._stuck()
        if cause is not None:
            self.causes.append(cause)
            self.active, self._begun, self._driven = True, world.time, 0.0
            goal = self._waypoints[min(waypoint, len(self._waypoints) - 1)]
            self._path = self._near.route(world.pose[:2], goal)

    def _stuck(self) -> str | None:
        number = round(self._watch.within / (LOOK * TICK))
        if len(self._track) <= number:
            return None
        moved = np.linalg.norm(self._track[-1][:2] - self._track[-1 - number][:2])
        return "stuck" if moved < self._watch.still else None

    def ahead(self, velocity: tuple[float, float]) -> np.ndarray:
        """(n, 3) poses that a velocity leads to within `Watch.ahead`."""
        x, y, yaw = self._world.pose
        speed, turn = velocity
        times = np.linspace(0.0, self._watch.ahead, 6)[1:]
        # Exact for a constant velocity.
        half = 0.5 * turn * times
        chord = speed * times * np.sinc(half / np.pi)
        return np.stack([x + chord * np.cos(yaw + half), y + chord * np.sin(yaw + half), yaw + turn * times], -1)

    def _danger(self, velocity: tuple[float, float]) -> str | None:
        """What the present motion would touch or leave; None without motion ahead."""
        if velocity[0] < 0.05:
            return None
        poses = self.ahead(velocity)
        along = np.stack([np.cos(poses[:, 2]), np.sin(poses[:, 2])], -1)
        discs = poses[:, None, :2] + self._discs[None, :, None] * along[:, None]
        here = self._world.pose
        now = here[:2] + self._discs[:, None] * np.array([math.cos(here[2]), math.sin(here[2])])
        touch = self._radius + self._watch.gap
        # Along something that is as near already is no danger; nearer to it is.
        objects = self._near.objects(discs)
        if (objects.min() < touch) and objects.min() < self._near.objects(now).min() - 0.01:
            return "near object"
        people = self._gaps(discs)
        if people.min() < touch:
            return "near person"
        if not self._near.is_open(poses[:, :2]).all():
            return "leaving the pavement"
        return None

    def velocity(self) -> tuple[float, float]:
        """Drives along its path: turns towards a point 1 m ahead on it, and waits for people."""
        world, watch = self._world, self._watch
        pose = world.pose
        if len(self._path) == 0:
            return 0.0, 0.0
        fine = resample(self._path, 0.1) if len(self._path) > 1 else self._path
        nearest = int(np.linalg.norm(fine - pose[:2], axis=1).argmin())
        target = fine[min(nearest + 10, len(fine) - 1)]
        bearing = math.atan2(target[1] - pose[1], target[0] - pose[0]) - pose[2]
        bearing = (bearing + math.pi) % (2.0 * math.pi) - math.pi
        speed = watch.at * max(0.0, math.cos(bearing)) if abs(bearing) < 0.6 else 0.0
        turn = float(np.clip(2.0 * bearing, -world.robot.max_yaw_rate, world.robot.max_yaw_rate))
        if speed > 0.0 and self._danger((speed, turn)) == "near person":
            return 0.0, 0.0
        return speed, turn


#: Half length and half width (m) of the robots' bodies, wheels and feet included.
BODIES = {"coco": (0.37, 0.28), "go2": (0.38, 0.22)}


class People:
    """The crowd of `envs.navigation` around one robot, on the host.

    Args:
      bank: of the street alone.
    """

    def __init__(self, bank: Any, robot: RobotSpec, filled: float) -> None:
        import jax

        from urbanverse_mjx.envs import registry
        from urbanverse_mjx.envs.navigation.dynamic import DynamicStreet, slot_appearances

        config = registry.get_default_config("CocoNav").crowd
        self._street = DynamicStreet(bank, np.zeros(1, np.int32), config, LOOK * TICK, robot)
        self.shapes = self._street.shapes
        self.appearances = slot_appearances(self._street.kinds, bank)
        model = self._street.model
        self._count = round(filled * model.num_agents)

        def step(crowd: Any, scene: Any, observer: Any, moving: Any, key: Any, number: Any) -> Any:
            return model.step(crowd, scene, observer, moving, jax.random.fold_in(key, number))

        self._init, self._step = jax.jit(model.init), jax.jit(step)
        self._places = jax.jit(lambda crowd: self._street.places(crowd, jax.numpy.int32(0)))
        self._key: Any = None
        self._crowd: Any = None

    def begin(self, seed: int, pose: np.ndarray) -> Any:
        """The crowd's first poses (`AgentMotion`) around a robot at (3,) x, y, yaw."""
        import jax

        self._key = jax.random.key(seed)
        self._crowd = self._init(self._key, 0, self._observer(pose), self._count)
        return self._poses()

    def step(self, number: int, pose: np.ndarray, velocity: np.ndarray) -> Any:
        """The poses after one more step; velocity: (2,) m/s of the robot in the world."""
        moving = tuple(np.float32(x) for x in velocity)
        self._crowd = self._step(self._crowd, 0, self._observer(pose), moving, self._key, np.uint32(number))
        return self._poses()

    def gaps(self, points: np.ndarray) -> np.ndarray:
        """(...) m from points (..., 2) to the nearest agent's body; infinite without any."""
        now, shapes = self._now, self.shapes
        dx, dy = points[..., :1] - now.position[:, 0], points[..., 1:] - now.position[:, 1]
        cos, sin = np.cos(now.heading), np.sin(now.heading)
        along = np.clip(cos * dx + sin * dy, -shapes.half_length, shapes.half_length)
        gap = np.hypot(dx - along * cos, dy - along * sin) - shapes.radius
        return np.where(now.present, gap, np.inf).min(-1)

    def _observer(self, pose: np.ndarray) -> Any:
        from urbanverse_mjx.crowds.spawning import Observer

        x, y, yaw = (np.float32(value) for value in pose)
        return Observer(x, y, yaw, np.array(True))

    def _poses(self) -> Any:
        places = self._places(self._crowd)
        self._now = type(places)(*(np.asarray(x) for x in places))
        return self._now


def contract_of(record: Any, observations: tuple[str, ...], robot: RobotSpec, where: str) -> Contract:
    """The contract of a policy's file, or of one without a file that drives by the goal alone."""
    if record is not None:
        return Contract.of(record, observations, where)
    own = RobotRecord(robot.name, robot.max_speed, robot.max_yaw_rate, 0.0)
    return Contract(observations, None, 200_000_000, "waypoint", 0.0, own)


class Deployed:
    """`urbanverse deploy` in simulated time: its controller, its gate on the robot, and the policy in this process."""

    def __init__(self, agent: Any, contract: Contract, waypoints: np.ndarray) -> None:
        goals = tuple((float(x), float(y)) for x, y in waypoints)
        self.controller = Controller(contract, goals, Limits(goal_radius=RADIUS), "0" * 16)
        self.gate, self._agent = CommandGate(), agent
        self.sees = contract.size is not None

    def message(self, message: Odometry | Image, now: int) -> None:
        """Passes on a message of the robot, and what follows from it."""
        outputs = list(self.controller.message(message.parts(), now))
        while outputs:
            output = outputs.pop(0)
            if isinstance(output, Request):
                outputs += self.controller.answer(output.number, self._answer(output), now)
            elif isinstance(output, Command):
                self.gate.receive(output.parts(), now)

    def _answer(self, request: Request) -> np.ndarray | None:
        if request.inputs is None:
            return None
        if request.begin:
            self._agent.begin(1)
        return np.asarray(self._agent(request.inputs), np.float32)


@dataclasses.dataclass
class Track:
    """Poses for a film, every `LOOK` ticks: of the robot's bodies, and of people."""

    xpos: list[np.ndarray] = dataclasses.field(default_factory=list)
    xquat: list[np.ndarray] = dataclasses.field(default_factory=list)
    people: list[Any] = dataclasses.field(default_factory=list)


def drive_mission(
    world: World,
    near: Surroundings,
    mission: Mission,
    agent: Any,
    contract: Contract,
    people: People | None,
    track: Track | None = None,
    horizon: float = HORIZON,
) -> dict[str, Any]:
    """Drives one mission.

    Returns:
      end: arrived, fall, given up or time; metres, seconds; waypoints reached and in all; interventions by cause;
      supervised: s that the supervisor drove; faults: how often each watchdog of `deploy` stopped the robot.
    """
    waypoints = near.waypoints(mission.via)
    first = waypoints[1] - waypoints[0]
    start = np.array([*waypoints[0], 0.0, math.atan2(first[1], first[0])])
    i, j = world.geometry.map.grid.cell(start[:2])
    start[2] = float(world.geometry.map.height[i, j])
    world.begin(start, s.Shifts().draw((mission.number,)))
    deployed = Deployed(agent, contract, waypoints[1:])
    far = np.full(1, np.inf)
    supervisor = Supervisor(world, near, people.gaps if people else lambda _: far, waypoints[1:])
    fovy = math.radians(float(world.model.camera(f"robot/{world.robot.camera}").fovy[0]))
    if people is not None:
        world.place_agents(people.begin(mission.seed, world.pose))
    metres, supervised, place, end, tick, reached = 0.0, 0.0, world.pose[:2], "time", 0, 0
    while world.time < horizon - 1e-9:
        now = _EPOCH + round(world.time * 1e9)
        if deployed.sees and tick % IMAGE == 0:
            deployed.message(Image(now, fovy, world.image()), now)
        deployed.message(_odometry(world, now), now)
        told = deployed.gate.velocity(now)
        reached = _reached(waypoints[1:], reached, world.pose)
        velocity = supervisor.velocity() if supervisor.active else told
        world.drive(velocity)
        tick += 1
        metres += float(np.linalg.norm(world.pose[:2] - place))
        place = world.pose[:2]
        supervised += TICK * supervisor.active
        if tick % LOOK == 0:
            if people is not None:
                world.place_agents(people.step(tick, world.pose, world.data.qvel[:2]))
            supervisor.look(velocity, reached)
            if track is not None:
                _note(track, world)
        if world.fallen or supervisor.lost or deployed.controller.arrived:
            end = "fall" if world.fallen else "given up" if supervisor.lost else "arrived"
            break
    return {
        "mission": mission.number,
        "end": end,
        "metres": round(metres, 1),
        "seconds": round(world.time, 1),
        "waypoints": reached,
        "of": len(waypoints) - 1,
        "interventions": {cause: supervisor.causes.count(cause) for cause in CAUSES},
        "supervised": round(supervised, 1),
        "faults": dict(deployed.controller.faults),
    }


def _reached(waypoints: np.ndarray, number: int, pose: np.ndarray) -> int:
    while number < len(waypoints) and np.linalg.norm(waypoints[number] - pose[:2]) < RADIUS:
        number += 1
    return number


def _odometry(world: World, now: int) -> Odometry:
    x, y, z = (float(value) for value in world.data.qpos[:3])
    w, a, b, c = (float(value) for value in rotations.unit(world.data.qpos[3:7]))
    ahead, left, turn = world.velocity
    return Odometry(now, (x, y, z), (w, a, b, c), (ahead, left), turn)


def _note(track: Track, world: World) -> None:
    bodies = [0, *(b for b in range(world.model.nbody) if world.model.body(b).name.startswith("robot/"))]
    track.xpos.append(world.data.xpos[bodies].astype(np.float32))
    track.xquat.append(world.data.xquat[bodies].astype(np.float32))
    track.people.append(world.people)
