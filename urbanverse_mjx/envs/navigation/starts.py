"""Random starts along and beside the route of an episode with any heading, to vary the episodes of a table.

In:   a row of an episode table.
Out:  another start, and the rest of the route from there.
When: at reset, inside jit, per env.

The distances do not include kerbs between two kinds of walkable ground; in the test streets, one start in 200 is beside
or on such a kerb.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, Key

from ...datatypes import RobotSpec
from . import terms
from .surroundings import CELL, Surroundings

#: m, least remaining length of the route, and largest distance from the route.
MIN_REMAINING_LENGTH, MAX_ROUTE_DISTANCE = 8.0, 2.0
#: m, additional clearance around the robot, as at the starts of the tables.
END_MARGIN = 0.15
#: Number of starts drawn for an episode (the table's start is kept if none is free), and of points checked on the line
#: to the next waypoint.
TRIES, POINTS = 16, 12
#: Folded into an env's key, so that other draws do not change.
_START = 108


class RandomStarts:
    """Draws random starts.

    Args:
      share: share of the episodes with a random start, in (0, 1].
      surroundings: distances in the streets.
      robot: robot of the environment.
    """

    def __init__(self, share: float, surroundings: Surroundings, robot: RobotSpec) -> None:
        self._share, self._surroundings = share, surroundings
        self._radius = float(robot.planner_radius)

    def draw(
        self,
        key: Key[Array, ""],
        scene: Int[Array, ""],
        start: Float[Array, "4"],
        waypoints: Float[Array, "W 3"],
        count: Int[Array, ""],
    ) -> tuple[Float[Array, "4"], Float[Array, "W 3"], Int[Array, ""]]:
        """Start (x, y, z, yaw), waypoints and their number for an episode of that row; those of the row if it is not
        changed or no position is free. The key is typed and can be reused."""
        keys = jax.random.split(jax.random.fold_in(key, _START), 4)
        corners = jnp.concatenate([start[None, :3], waypoints])
        length = terms.route_length(start[:3], waypoints)
        along = jax.random.uniform(keys[0], (TRIES,)) * jnp.maximum(length - MIN_REMAINING_LENGTH, 0.0)
        aside = jax.random.uniform(keys[1], (TRIES,), minval=-MAX_ROUTE_DISTANCE, maxval=MAX_ROUTE_DISTANCE)
        points, piece = terms.beside_route(corners, along, aside)
        free = self._free(scene, points[:, :2], waypoints[piece, :2])
        chosen = jnp.argmax(free)
        moved = free.any() & jax.random.bernoulli(keys[2], self._share)
        yaw = jax.random.uniform(keys[3], minval=-np.pi, maxval=np.pi)
        there = jnp.concatenate([points[chosen], yaw[None]])
        passed = jnp.where(moved, piece[chosen], 0)
        rest = waypoints[jnp.minimum(jnp.arange(len(waypoints)) + passed, count - 1)]
        return jnp.where(moved, there, start), jnp.where(moved, rest, waypoints), count - passed

    def _free(self, scene: Array, points: Float[Array, "T 2"], ahead: Float[Array, "T 2"]) -> Bool[Array, " T"]:
        """Whether the robot can stand at points and drive from there straight to the next waypoint."""
        at = self._surroundings.distances(scene, points)
        shares = jnp.linspace(0.0, 1.0, POINTS)[:, None, None]
        between = self._surroundings.distances(scene, points + shares * (ahead - points))
        # The error of a look-up is at most half a cell.
        stands = (at >= self._radius + END_MARGIN + CELL / 2).all(-1)
        return stands & (between >= self._radius).all((0, -1))
