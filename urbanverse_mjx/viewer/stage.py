"""Shows a session in viser's scene: the street once, then the changes of each frame."""

import dataclasses
from typing import Any

import numpy as np
import viser

from ..geometry import rotations
from ..viz.video import CAPTIONS
from . import layers
from .robot import robot_files
from .session import Session
from .street import Light, StreetMeshes

#: Layers that can be switched, with their initial visibility.
LAYERS = {"goal": True, "route": True, "path": True, "contacts": True, "hulls": False, "people": True}
_COLOURS = {
    "goal": (30, 160, 70),
    "route": (40, 110, 220),
    "path": (235, 120, 20),
    "contacts": (220, 30, 30),
    "hulls": (150, 60, 200),
}
_THICKNESS = {"goal": 0.08, "route": 0.05, "path": 0.05, "contacts": 0.03, "hulls": 0.02}
#: The light of the project's images, by this much brighter: the page darkens bright light more (ACES tones).
_EXPOSURE = 1.3
_HIDDEN_POSITION = (0.0, 0.0, -1000.0)


@dataclasses.dataclass
class _Robot:
    """The nodes of one robot; bodies: by number in the robot's model."""

    bodies: dict[int, Any]
    lines: dict[str, Any]
    flag: Any


class Stage:
    """Draws a session.

    Args:
      server: viser's.
      session: to show.
      street: its scene's meshes.
    """

    def __init__(self, server: viser.ViserServer, session: Session, street: StreetMeshes) -> None:
        self._scene, self.session, self._street = server.scene, session, street
        env = session.machine.env
        self._hulls: layers.HullsInReach | None = None
        self._shown = dict(LAYERS)
        self._places: dict[str, tuple[float, ...]] = {}
        with server.atomic():
            self._scene.reset()
            self._add_light(street.light())
            loose = env.movables is not None
            self._scene.add_glb("/street", street.fixed(loose))
            self._scene.add_glb("/sky", street.sky(), cast_shadow=False, receive_shadow=False)
            self._objects = self._add_objects() if loose else {}
            self._agents = self._add_agents()
            files = robot_files(env.robot)
            self._robots = [self._add_robot(number, files) for number in range(session.num_robots)]
            self.show(len(session) - 1)

    def _add_light(self, light: Light) -> None:
        scene = self._scene
        scene.configure_default_lights(False)
        scene.configure_environment_map(None)
        if light.sun_intensity > 1e-3:
            place = tuple(float(x) for x in light.sun * 100.0)
            strength = light.sun_intensity * _EXPOSURE
            scene.add_light_directional(
                "/sun",
                color=light.sun_colour,
                intensity=strength,
                cast_shadow=True,
                position=place,  # type: ignore[arg-type]
            )
        scene.add_light_hemisphere(
            "/daylight",
            sky_color=light.sky_colour,
            ground_color=light.ground_colour,
            intensity=light.sky_intensity * _EXPOSURE,
            position=(0.0, 0.0, 1.0),
        )

    def _add_objects(self) -> dict[int, Any]:
        """Slot -> node of each object that may be pushed."""
        nodes = {}
        for slot in map(int, self._street.movable):
            nodes[slot] = self._scene.add_glb(f"/objects/{slot}", self._street.object(slot))
        return nodes

    def _add_agents(self) -> list[Any]:
        """A node for each moving agent."""
        env = self.session.machine.env
        if env.dynamic is None:
            return []
        from ..envs.navigation.dynamic import slot_appearances

        return [
            self._scene.add_glb(f"/crowd/{i}", self._street.agent(appearance), visible=False)
            for i, appearance in enumerate(slot_appearances(env.dynamic.kinds, env.bank))
        ]

    def _add_robot(self, number: int, files: dict[int, bytes]) -> _Robot:
        scene, name = self._scene, f"/robot{number}"
        bodies = {body: scene.add_glb(f"{name}/body{body}", file) for body, file in files.items()}
        nothing = np.zeros((1, 2, 3), np.float32)
        lines = {
            layer: scene.add_line_segments(f"/layers/{layer}{number}", nothing, colour, thickness=_THICKNESS[layer])
            for layer, colour in _COLOURS.items()
        }
        flag = scene.add_label(f"/layers/goal{number}/label", "goal", position=(0.0, 0.0, 0.0))
        return _Robot(bodies, lines, flag)

    def switch(self, layer: str, shown: bool, index: int) -> None:
        """Shows or hides a layer of `LAYERS`; index: of the frame that stands on the page."""
        self._shown[layer] = shown
        for robot in self._robots:
            if layer in robot.lines:
                robot.lines[layer].visible = shown
            if layer == "goal":
                robot.flag.visible = shown
        self.show(index)

    def show(self, index: int) -> None:
        """Draws a frame of the session."""
        for number, robot in enumerate(self._robots):
            self._show_robot(index, number, robot)
        self._show_objects(index)
        self._show_agents(index)

    def _show_robot(self, index: int, number: int, robot: _Robot) -> None:
        session = self.session
        frame, machine = session.frames[index], session.machine
        xpos, xquat = (np.asarray(x)[number] for x in (frame.nav.sim.xpos, frame.nav.sim.xquat))
        for body, node in robot.bodies.items():
            self._place(node, xpos[body], xquat[body])
        drawn = {
            "goal": lambda: layers.goal_ring(frame, number, float(machine.env.config.success_radius)),
            "route": lambda: layers.segments(layers.route_line(frame, number)),
            "path": lambda: layers.segments(self._path(index, number)),
            "contacts": lambda: layers.touched(machine.env.bank, session.scene, frame, number),
            "hulls": lambda: self._hulls_in_reach(index, number),
        }
        for layer, draw in drawn.items():
            if self._shown[layer]:
                self._set_lines(robot.lines[layer], draw())
        goal = np.asarray(frame.nav.goal)[number]
        self._place(robot.flag, goal + [0.0, 0.0, 0.4], np.array([1.0, 0.0, 0.0, 0.0]))
        outcome = session.outcome(index, number)
        text = "goal" if outcome is None else CAPTIONS[outcome]
        if robot.flag.text != text:
            robot.flag.text = text

    def _path(self, index: int, number: int) -> np.ndarray:
        """The driven path on the ground."""
        path = self.session.path(index, number)
        path[:, 2] -= self.session.machine.env.robot.spawn_height - layers.LIFT
        return path

    def _hulls_in_reach(self, index: int, number: int) -> np.ndarray:
        if self._hulls is None:
            self._hulls = layers.HullsInReach(self.session.machine)
        return self._hulls(self.session.frames[index], number)

    def _show_objects(self, index: int) -> None:
        """Shows objects of the first robot's world, because robots and their pushed objects do not interact."""
        if not self._objects:
            return
        moved = layers.moved_objects(self.session.frames[index], 0)
        bank, scene = self.session.machine.env.bank, self.session.scene
        for slot, node in self._objects.items():
            home = bank.slot_position[scene, slot], bank.slot_quaternion[scene, slot]
            self._place(node, *moved.get(slot, home))

    def _show_agents(self, index: int) -> None:
        if not self._agents:
            return
        agents = self.session.agents(index) if self._shown["people"] else None
        for i, node in enumerate(self._agents):
            there = agents is not None and bool(agents.present[i])
            if there and agents is not None:
                yaw = float(agents.heading[i])
                self._place(
                    node, np.asarray(agents.position[i]), np.array([np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2)])
                )
            if node.visible != there:
                node.visible = there

    def _place(self, node: Any, position: np.ndarray, quaternion: np.ndarray) -> None:
        """Moves a node if its pose has changed; nodes at rest send no message."""
        pose = (*map(float, position), *map(float, quaternion))
        if self._places.get(node.name) != pose:
            self._places[node.name] = pose
            node.position, node.wxyz = pose[:3], pose[3:]

    def _set_lines(self, node: Any, points: np.ndarray) -> None:
        points = np.asarray(points, np.float32)
        if not len(points):
            points = np.full((1, 2, 3), _HIDDEN_POSITION, np.float32)  # viser draws no empty set of lines
        if node.points.shape != points.shape or not np.array_equal(node.points, points):
            node.points = points


def chase_view(session: Session, index: int, robot: int) -> tuple[np.ndarray, np.ndarray]:
    """(3,) position and (3,) target m of a camera behind a robot, its heading smoothed over the last two seconds."""
    env = session.machine.env
    root = env.mj_model.body(env.robot.root_body).id
    frames = session.frames[max(0, index - round(2.0 / env.dt)) : index + 1]
    heading = np.mean([_heading(np.asarray(f.nav.sim.xquat)[robot, root]) for f in frames], axis=0)
    heading = np.array([*heading, 0.0]) / max(float(np.linalg.norm(heading)), 1e-6)
    place = np.asarray(frames[-1].nav.sim.xpos)[robot, root].astype(np.float64)
    return place - 3.6 * heading + [0.0, 0.0, 2.2], place + 1.5 * heading


def _heading(quaternion: np.ndarray) -> np.ndarray:
    return rotations.matrix_f64(quaternion.astype(np.float64))[:2, 0]
