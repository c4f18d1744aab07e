"""Draws the next scene and episode of an env: uniformly, or by a training schedule."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int, Key
from ml_collections import ConfigDict

from ...datatypes import SceneBank, ValidationError
from . import learnability

#: Folded into the key of a draw, so that other draws do not change.
_SHARE, _PLACE = 106, 107


def episode_rows(bank: SceneBank) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Numbers of episodes (Z,) i32 of each scene, their rows (Z, E) i32 by length of the route, padding rows last, and
    their lengths (Z, E) f32 m in this order, infinite for padding."""
    exists = np.arange(bank.episode_length.shape[1]) < bank.num_episodes[:, None]
    lengths = np.where(exists, bank.episode_length, np.inf)
    rows = np.argsort(lengths, axis=1, kind="stable").astype(np.int32)
    return bank.num_episodes.astype(np.int32), rows, np.sort(lengths, axis=1).astype(np.float32)


class EpisodeSchedule:
    """Draws scenes and episodes by an env's progress.

    Every env counts its control steps and episodes, so the schedule does not depend on the trainer and is the same
    under vmap, pmap or when a state is resumed.

    * Scenes: all of them, or `resident_scenes` at a time, the next ones after every `episodes_per_swap` episodes
      (paper: 16 and 100, because of Isaac Sim's memory; a bank here needs no swapping). The order is random.
    * Routes: all of them, or initially only routes up to `start_distance` m (at least the shortest eight of a scene);
      the limit grows linearly with an env's control steps and ends after `ramp_steps`.
    * Learnability: in training (`wrap_for_training`), the share `learnable` of all draws is weighted by `learnability`,
      from the results of all envs of a batch; the others are drawn as above.

    Args:
      config: `config.schedule` of an environment.
      bank: the scenes.
      scenes: (n,) i32, the rows of the bank in use.

    Raises:
      ValidationError: a value is negative, there are no episodes between swaps, a limit has no ramp, or a share is
        outside [0, 1] or combined with the other schedules.
    """

    #: Number of shortest routes of a scene that are always used, because a single one could be memorised.
    SHORTEST = 8

    def __init__(self, config: ConfigDict, bank: SceneBank, scenes: np.ndarray) -> None:
        for name in ("resident_scenes", "start_distance", "ramp_steps"):
            if config[name] < 0:
                raise ValidationError(f"config.schedule.{name}: found {config[name]}, needed 0 (off) or more.")
        if config.episodes_per_swap < 1:
            raise ValidationError(
                f"config.schedule.episodes_per_swap: found {config.episodes_per_swap}, needed 1 or more."
            )
        if (config.start_distance > 0) != (config.ramp_steps > 0):
            raise ValidationError(
                f"config.schedule: found start_distance {config.start_distance} and ramp_steps {config.ramp_steps}, "
                "needed both or neither."
            )
        # Configurations of older policies do not have this field.
        self.learnable = float(config.get("learnable", 0.0))
        if not 0.0 <= self.learnable <= 1.0:
            raise ValidationError(f"config.schedule.learnable: found {self.learnable}, needed a share between 0 and 1.")
        if self.learnable and (config.resident_scenes or config.ramp_steps):
            raise ValidationError(
                "config.schedule: found learnable together with resident_scenes or ramp_steps, needed one of them."
            )
        order = np.random.default_rng(config.seed).permutation(scenes) if config.resident_scenes else scenes
        self._scenes = jnp.asarray(order, jnp.int32)
        self._resident = min(int(config.resident_scenes) or len(scenes), len(scenes))
        self._per_swap = int(config.episodes_per_swap)
        self._start, self._ramp = float(config.start_distance), int(config.ramp_steps)
        self._count, self._rows, self._lengths = map(jnp.asarray, episode_rows(bank))
        exists = np.arange(bank.episode_length.shape[1]) < bank.num_episodes[:, None]
        self._longest = float(bank.episode_length[exists].max())

    def held(self) -> tuple[tuple["EpisodeSchedule", str], ...]:
        """The tables of `episode_rows`, for `table_arguments.Held`."""
        return (self, "_count"), (self, "_rows"), (self, "_lengths")

    def draw(
        self,
        key: Key[Array, ""],
        age: Int[Array, ""],
        episodes: Int[Array, ""],
        bounds: Float[Array, " ZE"] | None = None,
    ) -> tuple[Int[Array, ""], Int[Array, ""]]:
        """Scene () i32 and row () i32 of the next episode.

        Args:
          key: typed key, used once.
          age: () i32, control steps of this env. episodes: () i32, ended episodes of this env.
          bounds: see `learnability.Learnability.bounds`; None to draw without weights.
        """
        scene, row = self._draw(key, age, episodes)
        if bounds is None or not self.learnable:
            return scene, row
        chosen = jax.random.bernoulli(jax.random.fold_in(key, _SHARE), self.learnable)
        place = jax.random.uniform(jax.random.fold_in(key, _PLACE))
        other = learnability.drawn(bounds, self._rows.shape[1], place)
        return jnp.where(chosen, other[0], scene), jnp.where(chosen, other[1], row)

    def _draw(
        self, key: Key[Array, ""], age: Int[Array, ""], episodes: Int[Array, ""]
    ) -> tuple[Int[Array, ""], Int[Array, ""]]:
        key_scene, key_row = jax.random.split(key)
        # scene uniform over the resident ones, row uniform over the routes within the limit
        first = (episodes // self._per_swap) * self._resident
        place = first + jax.random.randint(key_scene, (), 0, self._resident)
        scene = self._scenes[place % len(self._scenes)]
        number = self._count[scene]
        if self._ramp:
            share = jnp.minimum(age / self._ramp, 1.0)
            limit = self._start + share * (self._longest - self._start)
            within = jnp.searchsorted(self._lengths[scene], limit, side="right").astype(jnp.int32)
            number = jnp.where(share < 1.0, jnp.clip(within, jnp.minimum(self.SHORTEST, number), number), number)
        return scene, self._rows[scene, jax.random.randint(key_row, (), 0, number)]
