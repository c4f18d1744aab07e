"""Which episodes a policy can learn most from: those that it sometimes reaches the goal in and sometimes not.

In:   ended episodes of a batch of envs: scene, row, whether the goal was reached.
Out:  weights of all episodes of all scenes, for `EpisodeSchedule.draw`.
When: at each step of a batch, inside jit, see `wrap_for_training`.

An episode that ends well with probability p has the variance p (1 - p), its learnability (Rutherford et al., "No
Regrets: Investigating and Improving Regret Approximations for Curriculum Discovery", 2024). p is an exponential mean
over the episode's own ends, of all envs of a batch.
"""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from ...datatypes import SceneBank
from ..types import Result

#: Weight of a new end in the mean; about the last five count.
NEW = 0.2
#: Of every episode, so that one which never or always succeeded is seen again.
LEAST = 0.01


class Learnability:
    """The tables' shape, and how a mean becomes weights.

    Args:
      bank: the scenes.
      scenes: (n,) rows of it in use.
    """

    def __init__(self, bank: SceneBank, scenes: Int[np.ndarray, " n"]) -> None:
        rows = np.arange(bank.episode_length.shape[1])
        used = np.zeros(bank.num_scenes, bool)
        used[scenes] = True
        self._exists = jnp.asarray(used[:, None] & (rows < bank.num_episodes[:, None]))

    def first(self) -> Float[Array, "Z E"]:
        """The means before any episode has ended: 0.5, the most learnable, so that each gets its turn."""
        return jnp.full(self._exists.shape, 0.5, jnp.float32)

    def updated(
        self,
        success: Float[Array, "Z E"],
        scene: Int[Array, " n"],
        row: Int[Array, " n"],
        result: Int[Array, " n"],
    ) -> Float[Array, "Z E"]:
        """The means after a step of n envs; result: `Result`, RUNNING where the episode goes on.

        Ends of one episode in the same step count once, by their mean.
        """
        over = (result != Result.RUNNING).astype(jnp.float32)
        reached = (result == Result.GOAL).astype(jnp.float32)
        zero = jnp.zeros_like(success)
        count = zero.at[scene, row].add(over)
        mean = zero.at[scene, row].add(reached) / jnp.maximum(count, 1.0)
        return jnp.where(count > 0.0, success + NEW * (mean - success), success)

    def bounds(self, success: Float[Array, "Z E"]) -> Float[Array, " ZE"]:
        """Cumulative weights of all episodes, scene by scene."""
        weights = jnp.where(self._exists, success * (1.0 - success) + LEAST, 0.0)
        return jnp.cumsum(weights.reshape(-1))


def drawn(bounds: Float[Array, " ZE"], number: int, uniform: Float[Array, ""]) -> tuple[Int[Array, ""], Int[Array, ""]]:
    """Scene and row () i32 of the episode whose part of `bounds` holds a share `uniform` in [0, 1) of the sum; number:
    E, rows of a table."""
    place = jnp.searchsorted(bounds, uniform * bounds[-1], side="right")
    # Rounding may reach the end of the sum, behind which nothing is.
    last = jnp.searchsorted(bounds, bounds[-1], side="left")
    place = jnp.minimum(place, last).astype(jnp.int32)
    return place // number, place % number
