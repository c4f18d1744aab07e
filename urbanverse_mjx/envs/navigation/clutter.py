"""Clutter: places movable objects of a street at random beside the route of each episode.

In:   an engine with body slots, the scene, the route. Out: objects for `engine.init`, and their poses. When: tables at
construction; the rest at reset, inside jit, per env.

A strip along the reference route, as wide as the robot with a margin, stays free. The objects are bodies, so they can
be seen, touched and pushed.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, Key

from ...datatypes import Bodies, RobotSpec, SceneBank
from ...geometry import rotations
from ..heights import GroundHeights
from . import terms
from .surroundings import Surroundings

#: m, least distance between the robot's outline on the route and an object.
ROUTE_MARGIN = 0.25
#: m, largest distance from the strip along the route; robots rarely meet objects farther away.
MAX_ROUTE_DISTANCE = 2.5
#: m, additional free radius around start and goal.
END_CLEARANCE = 1.5
#: m, least distance between an object and hulls, the walkable edge and other clutter.
MIN_GAP = 0.05
#: m; objects are taken from positions at least this far from the route.
MIN_SOURCE_DISTANCE = 6.0
#: m, largest difference of the ground's height under an object.
MAX_HEIGHT_DIFFERENCE = 0.03
#: m, side of the cells of the ground heights; finer ones take seconds per scene and gigabytes.
GROUND_CELL = 0.2
#: Directions in which the ground half a cell outside the object is compared with that at its centre; a kerb that cuts
#: off less than 2 % of that radius is not detected.
RIM = np.stack([np.cos(np.arange(16) * np.pi / 8), np.sin(np.arange(16) * np.pi / 8)], -1)
#: Number of positions drawn for each object; an object without a free one keeps its original position.
TRIES = 16
#: Folded into an env's key, so that other draws do not change.
_CHOOSE, _PLACE = 104, 105


def footprint_radii(bank: SceneBank, row: Int[np.ndarray, "Z N"]) -> Float[np.ndarray, "Z N"]:
    """(Z, N) m, radius of the circle around an object's origin that encloses its hulls; 0 for fixed objects."""
    radii = np.zeros(row.shape, np.float32)
    for z in range(bank.num_scenes):
        for q in np.flatnonzero(bank.inst_hull[z] >= 0):
            n = int(bank.inst_object[z, q])
            if n < 0 or row[z, n] < 0:
                continue
            hull = bank.inst_hull[z, q]
            corners = bank.hull_vertices[hull, : bank.hull_num_vertices[hull]] @ bank.inst_rotation[z, q].T
            away = (corners + bank.inst_position[z, q] - bank.slot_position[z, n])[:, :2]
            radii[z, n] = max(radii[z, n], float(np.linalg.norm(away, axis=1).max()))
    return radii


class Clutter:
    """Chooses and places objects.

    Args:
      bank: the scenes.
      row: (Z, N) i32, -1 for fixed objects.
      number: M, number of objects of an env.
      robot: robot of the environment.
      surroundings: distances in the original streets.
    """

    def __init__(
        self, bank: SceneBank, row: Int[np.ndarray, "Z N"], number: int, robot: RobotSpec, surroundings: Surroundings
    ) -> None:
        self._number, self._surroundings, self._ground = number, surroundings, GroundHeights(bank, GROUND_CELL)
        self._movable = jnp.asarray(row >= 0)
        self._radius = jnp.asarray(footprint_radii(bank, row))
        self._home = jnp.asarray(bank.slot_position, jnp.float32)
        self._width = float(robot.planner_radius) + ROUTE_MARGIN

    def choose(
        self, key: Key[Array, ""], scene: Int[Array, ""], start: Float[Array, "3"], waypoints: Float[Array, "W 3"]
    ) -> Int[Array, " M"]:
        """(M,) i32, objects of the scene, drawn from those away from the route; -1 if there are fewer. The key is typed
        and can be reused."""
        corners = jnp.concatenate([start[None, :2], waypoints[:, :2]])
        free = self._movable[scene] & (terms.distance_to_route(self._home[scene, :, :2], corners) > MIN_SOURCE_DISTANCE)
        priority = jax.random.uniform(jax.random.fold_in(key, _CHOOSE), free.shape)
        value, chosen = jax.lax.top_k(jnp.where(free, priority, -1.0), min(self._number, len(priority)))
        chosen = jnp.where(value >= 0.0, chosen, -1).astype(jnp.int32)
        return jnp.pad(chosen, (0, self._number - len(chosen)), constant_values=-1)

    def place(
        self,
        key: Key[Array, ""],
        scene: Int[Array, ""],
        start: Float[Array, "3"],
        goal: Float[Array, "3"],
        waypoints: Float[Array, "W 3"],
        bodies: Bodies,
    ) -> Bodies:
        """Moves the bodies of `engine.init` to positions beside the route with random rotations about z."""
        corners = jnp.concatenate([start[None, :2], waypoints[:, :2]])
        ends = jnp.stack([start[:2], goal[:2]])
        keys = jax.random.split(jax.random.fold_in(key, _PLACE), self._number)
        there = bodies.object_index >= 0
        radius = jnp.where(there, self._radius[scene, jnp.maximum(bodies.object_index, 0)], 0.0)

        def one(placed: Float[Array, "M 2"], inputs: tuple[Array, ...]) -> tuple[Array, tuple[Array, Array]]:
            number, key, r, known = inputs
            points = self._candidates(key, corners, r)
            good = self._free(scene, points, r, corners, ends) & known
            apart = jnp.linalg.norm(points[:, None] - placed, axis=-1) - radius - r
            good &= (apart >= MIN_GAP).all(-1)
            point = jnp.where(good.any(), points[jnp.argmax(good)], jnp.inf)
            return placed.at[number].set(point), (point, good.any())

        order = jnp.arange(self._number), keys, radius, there
        nowhere = jnp.full((self._number, 2), jnp.inf)
        _, (points, found) = jax.lax.scan(one, nowhere, order)
        points = jnp.where(found[:, None], points, bodies.position[:, :2])
        rise = self._ground(scene, points) - self._ground(scene, bodies.position[:, :2])
        turn = jax.random.uniform(jax.random.fold_in(key, _PLACE + 1), (self._number,), minval=-np.pi, maxval=np.pi)
        turned = rotations.product(rotations.from_yaw(turn), bodies.quaternion)
        position = jnp.concatenate([points, (bodies.position[:, 2] + rise)[:, None]], axis=-1)
        return bodies._replace(
            position=jnp.where(found[:, None], position, bodies.position),
            quaternion=jnp.where(found[:, None], turned, bodies.quaternion),
        )

    def _candidates(self, key: Key[Array, ""], corners: Float[Array, "W 2"], radius: Array) -> Float[Array, "T 2"]:
        """Points beside the route, uniform along it and across the strips for clutter on both sides."""
        key_along, key_across, key_side = jax.random.split(key, 3)
        whole = jnp.linalg.norm(jnp.diff(corners, axis=0), axis=-1).sum()
        along = jax.random.uniform(key_along, (TRIES,)) * whole
        side = jnp.where(jax.random.bernoulli(key_side, shape=(TRIES,)), 1.0, -1.0)
        across = side * (self._width + radius + MAX_ROUTE_DISTANCE * jax.random.uniform(key_across, (TRIES,)))
        return terms.beside_route(corners, along, across)[0]

    def _free(
        self, scene: Array, points: Float[Array, "T 2"], radius: Array, corners: Array, ends: Array
    ) -> Bool[Array, " T"]:
        """Whether an object may stand at points: away from route, start, goal, hulls and edge, on flat ground."""
        found = self._surroundings.distances(scene, points)
        away = jnp.linalg.norm(points[:, None] - ends, axis=-1).min(-1)
        rim = jnp.asarray(RIM, jnp.float32) * (radius + 0.5 * GROUND_CELL)
        step = jnp.abs(self._ground(scene, points[:, None] + rim) - self._ground(scene, points)[:, None]).max(-1)
        return (
            (terms.distance_to_route(points, corners) >= self._width + radius - 1e-4)
            & (away >= self._width + radius + END_CLEARANCE)
            & (found[:, 0] >= radius + MIN_GAP)
            & (found[:, 1] >= radius + MIN_GAP)
            & (step <= MAX_HEIGHT_DIFFERENCE)
        )

    def nearer(
        self, distances: Float[Array, "*n 2"], scene: Int[Array, ""], bodies: Bodies, p_xy: Float[Array, "*n 2"]
    ) -> Float[Array, "*n 2"]:
        """Distances (..., 2) m to hull and edge from points (..., 2); circles of bodies count as hulls."""
        there = bodies.object_index >= 0
        radius = self._radius[scene, jnp.maximum(bodies.object_index, 0)]
        away = jnp.linalg.norm(p_xy[..., None, :] - bodies.position[:, :2], axis=-1) - radius
        nearest = jnp.where(there, jnp.maximum(away, 0.0), jnp.inf).min(-1)
        return distances.at[..., 0].set(jnp.minimum(distances[..., 0], nearest))
