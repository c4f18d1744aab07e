"""Overlays of a street: route, goal, driven path, hulls in reach, contacts. Lines in the world's frame, m."""

import functools

import jax
import jax.numpy as jnp
import numpy as np

from ..datatypes import SceneBank
from ..geometry import rotations
from ..simulation.collision_slots import static_slots
from .session import Frame, Machine

#: m, height of lines over the ground.
LIFT = 0.06
_RING = 48


def route_line(frame: Frame, robot: int) -> np.ndarray:
    """Returns (W + 1, 3), the start and the waypoints up to the goal."""
    nav = frame.nav
    start, waypoints = np.asarray(nav.start)[robot], np.asarray(nav.waypoints)[robot]
    number = int(np.asarray(nav.num_waypoints)[robot])
    return np.concatenate([start[None], waypoints[:number]]) + [0.0, 0.0, LIFT]


def goal_ring(frame: Frame, robot: int, radius: float) -> np.ndarray:
    """(48, 2, 3) segments of the circle in which the goal is reached."""
    turn = np.linspace(0.0, 2 * np.pi, _RING + 1)
    circle = np.stack([np.cos(turn), np.sin(turn), np.zeros_like(turn)], -1) * radius
    return segments(np.asarray(frame.nav.goal)[robot] + circle + [0.0, 0.0, LIFT])


def segments(points: np.ndarray) -> np.ndarray:
    """(n - 1, 2, 3) of a line through (n, 3); one without length where it is a single point."""
    points = np.concatenate([points, points]) if len(points) == 1 else points
    return np.stack([points[:-1], points[1:]], axis=1)


class HullsInReach:
    """The hulls in an engine's slots, all within a robot's reach.

    Args:
      machine: provides the environment with robot and bank.
    """

    def __init__(self, machine: Machine) -> None:
        env = machine.env
        self.bank: SceneBank = env.bank
        self._table = jax.tree.map(jnp.asarray, static_slots.instance_tables(self.bank)[0])
        shape = self.bank.hull_grid.shape[1:3]
        root = env.mj_model.body(env.robot.root_body).id
        reach = env.robot.circumradius + env.robot.max_speed * env.dt

        @functools.partial(jax.jit)
        def find(nav: object) -> static_slots.Slots:
            sim = nav.sim  # type: ignore[attr-defined]
            origin = jnp.asarray(self.bank.grid_origin)[sim.scene]
            cell = static_slots.grid_cell(origin, jnp.asarray(self.bank.grid_cell), shape, sim.xpos[root])
            taken = None if sim.bodies is None else sim.bodies.object_index
            number = self._table.grid.shape[-1]
            return static_slots.nearest(self._table, cell, sim.scene, sim.xpos[root], reach, number, taken)[0]

        self._find = find

    def __call__(self, frame: Frame, robot: int) -> np.ndarray:
        """(n, 2, 3) edges of the hulls in reach of a robot."""
        slots = self._find(jax.tree.map(lambda x: x[robot], frame.nav))
        found = np.flatnonzero(np.asarray(slots.valid))
        parts = [
            hull_edges(self.bank, int(slots.hull[i])) @ np.asarray(slots.rotation[i]).T + np.asarray(slots.position[i])
            for i in found
        ]
        return np.concatenate(parts) if parts else np.zeros((0, 2, 3))


def touched(bank: SceneBank, scene: int, frame: Frame, robot: int) -> np.ndarray:
    """Returns (n, 2, 3) edges of the hulls of the object that a robot touched in its last step, where it is now."""
    contacts = frame.nav.sim.contacts
    slot = int(np.asarray(contacts.hit_object)[robot])
    if slot < 0 or not bool(np.asarray(contacts.hit)[robot]):
        return np.zeros((0, 2, 3))
    move, turn = object_motion(bank, scene, frame, robot, slot)
    parts = []
    for i in np.flatnonzero(bank.inst_object[scene] == slot):
        edges = hull_edges(bank, int(bank.inst_hull[scene, i]))
        edges = edges @ bank.inst_rotation[scene, i].T.astype(np.float64) + bank.inst_position[scene, i]
        parts.append(edges @ turn.T + move)
    return np.concatenate(parts) if parts else np.zeros((0, 2, 3))


def object_motion(bank: SceneBank, scene: int, frame: Frame, robot: int, slot: int) -> tuple[np.ndarray, np.ndarray]:
    """(3,) and (3, 3): transform of a point of an object from its pose in the bank to its present one."""
    where = moved_objects(frame, robot).get(slot)
    if where is None:
        return np.zeros(3), np.eye(3)
    home = rotations.matrix_f64(bank.slot_quaternion[scene, slot])
    turn = rotations.matrix_f64(where[1]) @ home.T
    return where[0] - turn @ bank.slot_position[scene, slot], turn


def moved_objects(frame: Frame, robot: int) -> dict[int, tuple[np.ndarray, np.ndarray]]:
    """Slot -> place (3,) and quaternion (4,) of each object that is a body around a robot."""
    bodies = frame.nav.sim.bodies
    if bodies is None:
        return {}
    slots, places, turns = (np.asarray(x)[robot] for x in (bodies.object_index, bodies.position, bodies.quaternion))
    return {int(s): (places[i], turns[i]) for i, s in enumerate(slots) if s >= 0}


def hull_edges(bank: SceneBank, hull: int) -> np.ndarray:
    """(n, 2, 3) edges of a hull in its own frame: of its triangles, without those inside a flat face."""
    triangles = bank.hull_triangles[hull, : int(bank.hull_num_triangles[hull])]
    normals = bank.hull_planes[hull, : len(triangles), :3]
    corners = bank.hull_vertices[hull].astype(np.float64)
    beside: dict[tuple[int, int], list[int]] = {}
    for face, triangle in enumerate(triangles):
        for a, b in zip(triangle, np.roll(triangle, -1), strict=True):
            beside.setdefault((min(a, b), max(a, b)), []).append(face)
    seen = [
        edge for edge, faces in beside.items() if len(faces) != 2 or normals[faces[0]] @ normals[faces[1]] < 1 - 1e-4
    ]
    return corners[np.array(seen)] if seen else np.zeros((0, 2, 3))
