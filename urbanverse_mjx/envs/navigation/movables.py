"""Selects the objects that can be pushed in an episode: those nearest to its route.

In:   an engine with body slots, the scene, the route.
Out:  objects for `engine.init`, metrics.
When: tables at construction; the rest at reset and every control step, inside jit, per env.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int
from ml_collections import ConfigDict

from ...datatypes import SceneBank, SimState, ValidationError
from . import terms

#: Largest number of objects of `config.randomization.clutter`; each costs time in every control step.
MAX_CLUTTER = 32
#: Whether the episode ended by touching a movable object; such a hit also counts as one of an object.
MOVABLE_METRICS = ("hit_movable",)


def body_sizes(config: ConfigDict) -> dict[str, int] | None:
    """Sizes of the body slots of an environment's config: its `movable` in the scenario dynamic, otherwise those for
    `randomization.clutter`, or None (also for older policies without these fields).

    Raises:
      ValidationError: a number is negative, more objects are awake than exist, or clutter is combined with the scenario
        dynamic.
    """
    sizes, dynamic = config.get("movable", None), config.get("scenario", "static") == "dynamic"
    clutter = config.get("randomization", {}).get("clutter", 0)
    if not 0 <= clutter <= MAX_CLUTTER or (clutter and dynamic):
        raise ValidationError(
            f"config.randomization.clutter: found {clutter}, needed 0 (off) to {MAX_CLUTTER} objects, and 0 in the "
            "scenario 'dynamic', which has its own."
        )
    if not dynamic:
        if sizes is None or not clutter:
            return None
        return {"bodies": int(clutter), "awake": min(int(sizes.awake), int(clutter)), "hulls": int(sizes.hulls)}
    if sizes is None or sizes.bodies == 0:
        return None
    if not 0 < sizes.awake <= sizes.bodies or sizes.hulls < 1:
        raise ValidationError(
            f"config.movable: found {ConfigDict(sizes).to_dict()}, needed bodies >= awake > 0 and hulls > 0; "
            "set bodies to 0 for none."
        )
    return {name: int(sizes[name]) for name in ("bodies", "awake", "hulls")}


class Movables:
    """The movable objects of every scene.

    Args:
      bank: the scenes.
      row: (Z, N) i32, -1 for fixed objects.
      number: M, objects of an env.
    """

    def __init__(self, bank: SceneBank, row: Int[np.ndarray, "Z N"], number: int) -> None:
        found = [np.flatnonzero(r >= 0) for r in row]
        width = max([number, *(len(f) for f in found)])
        objects = np.full((len(row), width), -1, np.int32)
        for line, slots in zip(objects, found, strict=True):
            line[: len(slots)] = slots
        place = np.take_along_axis(bank.slot_position[..., :2], np.maximum(objects, 0)[..., None], axis=1)
        self._objects, self._place, self._number = jnp.asarray(objects), jnp.asarray(place, jnp.float32), number

    def near(self, scene: Int[Array, ""], start: Float[Array, "3"], waypoints: Float[Array, "W 3"]) -> Int[Array, " M"]:
        """(M,) i32, objects nearest to the route start (3,), waypoints (W, 3) m; -1 if a scene has fewer."""
        corners = jnp.concatenate([start[None, :2], waypoints[:, :2]])
        distance = terms.distance_to_route(self._place[scene], corners)
        _, pick = jax.lax.top_k(-jnp.where(self._objects[scene] >= 0, distance, jnp.inf), self._number)
        return self._objects[scene][pick]

    def metrics(self, sim: SimState, ended: Bool[Array, ""]) -> dict[str, Float[Array, ""]]:
        """`MOVABLE_METRICS`; ended: () bool, whether the episode ended by touching an object."""
        hit = sim.contacts.hit_object
        assert sim.bodies is not None
        mine = (hit >= 0) & (hit == sim.bodies.object_index).any()
        return {MOVABLE_METRICS[0]: (ended & mine).astype(jnp.float32)}
