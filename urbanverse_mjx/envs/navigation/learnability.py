"""Weights of training episodes by learnability: episodes that succeed sometimes are drawn most often.

In:   ended episodes of a batch of envs: scene, row, whether the goal was reached.
Out:  weights of all episodes of all scenes, for `EpisodeSchedule.draw`.
When: at each step of a batch, inside jit, see `wrap_for_training`.

An episode that succeeds with probability p has the variance p (1 - p), its learnability (Rutherford et al., "No
Regrets: Investigating and Improving Regret Approximations for Curriculum Discovery", 2024). p is the exponential moving
average of the results of the episode over all envs of a batch.
"""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from ...datatypes import SceneBank
from ..types import Result

#: Weight of a new result in the moving average, which covers about the last five results.
NEW_RESULT_WEIGHT = 0.2
#: Least weight of an episode, so that those which never or always succeeded are drawn again.
MIN_WEIGHT = 0.01


class Learnability:
    """Maintains success rates of episodes and computes their weights.

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
        """Initial success rates of 0.5, the most learnable value."""
        return jnp.full(self._exists.shape, 0.5, jnp.float32)

    def updated(
        self,
        success: Float[Array, "Z E"],
        scene: Int[Array, " n"],
        row: Int[Array, " n"],
        result: Int[Array, " n"],
    ) -> Float[Array, "Z E"]:
        """The success rates after a step of n envs; result: `Result`, RUNNING for episodes that continue.

        Several results of one episode in the same step count once, by their mean.
        """
        over = (result != Result.RUNNING).astype(jnp.float32)
        reached = (result == Result.GOAL).astype(jnp.float32)
        zero = jnp.zeros_like(success)
        count = zero.at[scene, row].add(over)
        mean = zero.at[scene, row].add(reached) / jnp.maximum(count, 1.0)
        return jnp.where(count > 0.0, success + NEW_RESULT_WEIGHT * (mean - success), success)

    def bounds(self, success: Float[Array, "Z E"]) -> Float[Array, " ZE"]:
        """Cumulative weights of all episodes, ordered by scene."""
        weights = jnp.where(self._exists, success * (1.0 - success) + MIN_WEIGHT, 0.0)
        return jnp.cumsum(weights.reshape(-1))


def drawn(bounds: Float[Array, " ZE"], number: int, uniform: Float[Array, ""]) -> tuple[Int[Array, ""], Int[Array, ""]]:
    """Scene and row () i32 of the episode at the share `uniform` in [0, 1) of the cumulative weights `bounds`; number:
    E, rows of a table."""
    place = jnp.searchsorted(bounds, uniform * bounds[-1], side="right")
    # Rounding may reach the end of the sum, beyond the last episode.
    last = jnp.searchsorted(bounds, bounds[-1], side="left")
    place = jnp.minimum(place, last).astype(jnp.int32)
    return place // number, place % number
