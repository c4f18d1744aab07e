"""Encounters: behaviours (`crowds.behaviours`) of people on and beside an episode's route.

In:   the route, the clearance of the ground, `config.crowd.encounters`.
Out:  a `Script` for the first walkers of a crowd.
When: when an episode begins, inside jit, per env.
"""

from collections.abc import Callable

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Key
from ml_collections import ConfigDict

from ...crowds import KINDS, behaviours
from ...crowds.behaviours import ROAM, Script
from ...datatypes import ValidationError

#: m from an agent's start to objects, and between the centres of agents.
_OBJECT_CLEARANCE, _AGENT_DISTANCE = KINDS["pedestrian"].radius + 0.1, 0.75
#: m, radius around the robot's start without agents.
_START_RADIUS = 2.2
#: m/s, typical speed of a robot, from which the start of crossing agents is computed so that both may meet.
_ROBOT_SPEED = 1.2

Pose = tuple[Float[Array, ""], Float[Array, ""], Float[Array, ""]]
Ranges = tuple[float, float]


def route_pose(start: Float[Array, " s"], waypoints: Float[Array, "W 3"], arc: Float[Array, ""] | float) -> Pose:
    """() x, y m and heading rad at an arc length () m of the route start (3+,), waypoints (W, 3); those of its end
    beyond it."""
    points = jnp.concatenate([start[None, :2], waypoints[:, :2]])
    span = jnp.diff(points, axis=0)
    length = jnp.linalg.norm(span, axis=-1)
    before = jnp.cumsum(length) - length
    # The last segment that begins before the position; segments between repeated waypoints are ignored.
    row = jnp.max(jnp.where((before <= arc) & (length > 1e-6), jnp.arange(len(length)), 0))
    direction = span[row] / jnp.maximum(length[row], 1e-6)
    x, y = points[row] + jnp.clip(arc - before[row], 0.0, length[row]) * direction
    return x, y, jnp.arctan2(direction[1], direction[0])


def _beside(pose: Pose, left: Float[Array, ""], ahead: float = 0.0) -> Pose:
    x, y, heading = pose
    cos, sin = jnp.cos(heading), jnp.sin(heading)
    return x + ahead * cos - left * sin, y + ahead * sin + left * cos, heading


def _head_on(pose: Pose, left: Float[Array, ""]) -> Script:
    return behaviours.head_on(*_beside(pose, 0.3 * left, -6.0), distance=6.0)


def _cross(pose: Pose, left: Float[Array, ""]) -> Script:
    # From the drawn side: rotated by half a turn, left becomes right.
    x, y, heading = pose
    return behaviours.cross(x, y, heading + jnp.where(left > 0.0, 0.0, jnp.pi), distance=0.0, aside=2.5)


def _obstruct(pose: Pose, left: Float[Array, ""]) -> Script:
    x, y, heading = _beside(pose, 0.2 * left)
    return behaviours.obstruct(x, y, heading + jnp.pi)


def _overtaken(pose: Pose, left: Float[Array, ""]) -> Script:
    return behaviours.overtaken(*_beside(pose, 0.3 * left), distance=0.0)


def _talk(pose: Pose, left: Float[Array, ""]) -> Script:
    x, y, heading = _beside(pose, left)
    return behaviours.talk(x, y, 2, heading)


def _queue(pose: Pose, left: Float[Array, ""]) -> Script:
    x, y, heading = _beside(pose, left)
    return behaviours.queue(x, y, heading, 3)


#: Name -> number of rows, range of its position along the route (m), and function from a pose of the route and a
#: lateral offset (m, left positive, drawn from [-1.2, 1.2]) to the script.
ENCOUNTERS: dict[str, tuple[int, Ranges, Callable[[Pose, Float[Array, ""]], Script]]] = {
    "head_on": (1, (8.0, 16.0), _head_on),
    # A crossing agent walks 2.5 m at 1.34 m/s to the route; the robot covers 2.2 m in this time.
    "cross": (1, (2.5 * _ROBOT_SPEED / 1.34 + 1.0, 2.5 * _ROBOT_SPEED / 1.34 + 3.0), _cross),
    "obstruct": (1, (4.0, 14.0), _obstruct),
    "overtaken": (1, (3.0, 6.0), _overtaken),
    "talk": (2, (4.0, 20.0), _talk),
    "queue": (3, (5.0, 20.0), _queue),
}


class Encounters:
    """Draws the encounters of an episode.

    Args:
      config: probability of each of `ENCOUNTERS` per episode.
      walkers: number of pedestrian slots; encounters that need more are left out.

    Raises:
      ValidationError: an encounter is unknown or its value is not a probability.
    """

    def __init__(self, config: ConfigDict, walkers: int) -> None:
        for name, chance in config.items():
            if name not in ENCOUNTERS or not 0.0 <= chance <= 1.0:
                raise ValidationError(
                    f"config.crowd.encounters: found {name!r}: {chance}, needed shares in [0, 1] of {list(ENCOUNTERS)}."
                )
        self._drawn: list[tuple[str, float]] = []
        rows = 0
        for name, (number, *_) in ENCOUNTERS.items():
            if config.get(name, 0.0) > 0.0 and rows + number <= walkers:
                self._drawn.append((name, float(config[name])))
                rows += number

    def draw(
        self,
        key: Key[Array, ""],
        start: Float[Array, " s"],
        waypoints: Float[Array, "W 3"],
        clearance: Callable[[Float[Array, "n 2"]], Float[Array, "n 2"]],
    ) -> Script | None:
        """The script of an episode, with `ROAM` in rows of encounters that are not drawn; None if all have probability
        0.

        Args:
          key: typed key, used once.
          start: (3+,) m.
          waypoints: (W, 3) m.
          clearance: function (n, 2) m -> (n, 2) m to the nearest hull and the walkable edge.
        """
        length = jnp.linalg.norm(jnp.diff(jnp.concatenate([start[None, :2], waypoints[:, :2]]), axis=0), axis=-1).sum()
        scripts: list[Script] = []
        for i, (name, chance) in enumerate(self._drawn):
            _, (low, high), make = ENCOUNTERS[name]
            keys = jax.random.split(jax.random.fold_in(key, i), 3)
            arc = jax.random.uniform(keys[0], (), minval=low, maxval=jnp.maximum(low, jnp.minimum(high, length - 1.0)))
            left = jax.random.uniform(keys[1], (), minval=-1.2, maxval=1.2)
            script = make(route_pose(start, waypoints, arc), left)
            here = jnp.stack([script.x, script.y], -1)
            fits = clearance(here).min() > _OBJECT_CLEARANCE
            apart = jnp.linalg.norm(here - start[:2], axis=-1).min() > _START_RADIUS
            for other in scripts:
                there = jnp.stack([other.x, other.y], -1)
                near = jnp.linalg.norm(here[:, None] - there, axis=-1) < _AGENT_DISTANCE
                apart &= ~(near & (other.mode != ROAM)).any()
            takes_place = (jax.random.uniform(keys[2]) < chance) & fits & apart
            scripts.append(script._replace(mode=jnp.where(takes_place, script.mode, ROAM)))
        return behaviours.together(*scripts) if scripts else None
