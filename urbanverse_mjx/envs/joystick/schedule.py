"""Terrain curriculum: each env draws a kind by its share, at a level that follows the env's performance."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, Key
from ml_collections import ConfigDict

from ...datatypes import SceneBank, ValidationError

#: m; an episode with a shorter commanded path does not change the level.
_MIN_REQUEST = 2.0


class TerrainLevels:
    """Scenes "<kind>-<level>" of a bank, by `config.terrain` of a locomotion task.

    Attributes:
      kinds: T names.
      scenes: (T, L) i32, rows of the bank.

    Raises:
      ValidationError: scenes have other names, or kinds have different numbers of levels.
    """

    def __init__(self, bank: SceneBank, config: ConfigDict) -> None:
        self._config = config
        self.kinds, self.scenes, shares = _terrain_table(bank, config.shares)
        self._rows, self._ends = jnp.asarray(self.scenes), jnp.cumsum(shares)

    def first(self, key: Key[Array, ""]) -> Int[Array, " T"]:
        """(T,) i32, random low initial levels."""
        highest = min(int(self._config.first_levels), self.scenes.shape[1])
        return jax.random.randint(key, (len(self.kinds),), 0, highest, jnp.int32)

    def choose(self, key: Key[Array, ""], levels: Int[Array, " T"]) -> tuple[Int[Array, ""], Int[Array, ""]]:
        """() i32 kind and () i32 scene of the next episode, for levels (T,)."""
        kind = jnp.searchsorted(self._ends, jax.random.uniform(key)).astype(jnp.int32)
        kind = jnp.minimum(kind, len(self.kinds) - 1)
        return kind, self._rows[kind, levels[kind]]

    def after(
        self,
        key: Key[Array, ""],
        levels: Int[Array, " T"],
        kind: Int[Array, ""],
        lasted: Bool[Array, ""],
        distance: Float[Array, ""],
        asked: Float[Array, ""],
    ) -> Int[Array, " T"]:
        """(T,) levels after an episode on `kind`: higher after a success, lower after a failure.

        Args:
          lasted: () bool, whether it ended only by its time limit.
          distance, asked: () m along the commands, covered and commanded.
        """
        count = self.scenes.shape[1]
        share, long = distance / jnp.maximum(asked, 1e-3), asked > _MIN_REQUEST
        up = long & lasted & (share > self._config.promote)
        down = ~lasted | (long & (share < self._config.demote))
        level = levels[kind] + up.astype(jnp.int32) - down.astype(jnp.int32)
        # After the last level an env continues at a random one, so that training covers all levels.
        level = jnp.where(level >= count, jax.random.randint(key, (), 0, count, jnp.int32), jnp.maximum(level, 0))
        return levels.at[kind].set(level)


def _terrain_table(bank: SceneBank, shares: ConfigDict) -> tuple[tuple[str, ...], np.ndarray, jax.Array]:
    """Kinds of terrain in a bank, (T, L) i32 its scenes by kind and level, (T,) shares of episodes.

    Raises:
      ValidationError: scenes are not named "<kind>-<level>", or a required kind has none.
    """
    rows: dict[str, dict[int, int]] = {}
    for scene, name in enumerate(bank.scene_ids):
        kind, _, level = name.rpartition("-")
        if kind in shares and level.isdigit() and shares[kind] > 0.0:
            rows.setdefault(kind, {})[int(level)] = scene
    numbers = {len(levels) for levels in rows.values()}
    if len(numbers) != 1 or any(sorted(levels) != list(range(len(levels))) for levels in rows.values()):
        raise ValidationError(
            f"bank: found scenes {', '.join(bank.scene_ids[:5])}, needed terrains '<kind>-<level>' of the kinds "
            f"{', '.join(shares)}, all with the same levels; build one with `urbanverse scene terrain`."
        )
    kinds = tuple(rows)
    table = np.array([[rows[kind][level] for level in sorted(rows[kind])] for kind in kinds], np.int32)
    weights = np.array([shares[kind] for kind in kinds], np.float32)
    return kinds, table, jnp.asarray(weights / weights.sum())
