"""Traversability of a scene for the agents of a crowd: walls around each, and whether a step stays on free ground.

In:   a crowd's tables and kinds; bodies.
Out:  half-planes for `orca`; bools for `resolve_collisions`.
When: `Traversability` once; its methods every crowd step, inside jit, per env.
"""

from collections.abc import Sequence
from typing import Any

import jax.numpy as jnp
import numpy as np

from . import flats, open_ground
from .bodies import Bodies, Traits, num_wheeled
from .kinds import SURFACES, AgentKind
from .linear_program import HalfPlanes
from .orca import no_walls

#: Positions on a vehicle's axis that are checked for free ground; 1 is the front end. A car has 0.75 m between two of
#: them.
_AXIS_POSITIONS = (1.0, 0.5, 0.0, -0.5, -1.0)


class Traversability:
    """Surfaces of the A agents of a crowd.

    Args:
      walls: `Flats` by surface.
      ground: `OpenGround` by surface.
      kinds: (A,), walkers first.
      traits: (A,).
    """

    def __init__(
        self,
        walls: dict[str, flats.Flats],
        ground: dict[str, open_ground.OpenGround],
        kinds: Sequence[AgentKind],
        traits: Traits,
    ) -> None:
        self._flats, self._ground, self._traits = walls, ground, traits
        self._surfaces = {s: np.flatnonzero([k.surface == s for k in kinds]) for s in SURFACES}
        self._everybody = np.arange(len(kinds))
        self._vehicles = self._everybody[len(kinds) - num_wheeled(kinds) :]

    def _members(self, rows: np.ndarray) -> dict[str, np.ndarray]:
        """The agents that use each surface, for surfaces with agents."""
        found = {surface: np.intersect1d(members, rows) for surface, members in self._surfaces.items()}
        return {surface: some for surface, some in found.items() if len(some)}

    def _at(self, bodies: Bodies, some: np.ndarray, end: float) -> tuple[Any, Any]:
        """(n,) x and y m of points on the axes of some bodies."""
        half, heading = end * self._traits.half_length[some], bodies.heading[some]
        return bodies.x[some] + half * jnp.cos(heading), bodies.y[some] + half * jnp.sin(heading)

    def walls(self, bodies: Bodies, scene: Any) -> tuple[HalfPlanes, HalfPlanes]:
        """Half-planes of every agent's surface: (M, A) at the front discs and (M, W) at the rear discs of vehicles."""
        traits = self._traits

        def at(rows: np.ndarray, end: float) -> HalfPlanes:
            members = self._members(rows)
            if not members:
                return no_walls(0)
            found = [
                flats.walls_at(
                    self._flats[surface],
                    scene,
                    *self._at(bodies, some, end),
                    traits.radius[some],
                    traits.wall_horizon[some],
                )
                for surface, some in members.items()
            ]
            back = np.argsort(np.concatenate(list(members.values())))
            return HalfPlanes(*(jnp.concatenate(c, axis=1)[:, back] for c in zip(*found, strict=True)))

        return at(self._everybody, 1.0), at(self._vehicles, -1.0)

    def stays(self, before: Bodies, after: Bodies, scene: Any) -> Any:
        """(A,) bool, whether no point of a body's axis leaves the free ground. Agents off the free ground are not
        restricted."""
        found = jnp.ones(len(self._everybody), bool)
        for end in _AXIS_POSITIONS:
            for surface, some in self._members(self._everybody if end == 1.0 else self._vehicles).items():
                was, now = (
                    open_ground.is_open(self._ground[surface], scene, *self._at(bodies, some, end))
                    for bodies in (before, after)
                )
                found = found.at[some].set(found[some] & (now | ~was))
        return found
