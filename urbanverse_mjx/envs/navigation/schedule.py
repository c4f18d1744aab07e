"""Which scene and which row of its episode table an env gets next: all at random, or by a training schedule."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int, Key
from ml_collections import ConfigDict

from ...datatypes import SceneBank, ValidationError
from . import learnability

#: Folded into the key of a draw, so that no other draw changes.
_SHARE, _PLACE = 106, 107


class EpisodeSchedule:
    """Draws scenes and episodes, depending on an env's progress.

    Every env counts its own control steps and episodes, so the schedule needs no word from the trainer and is the same
    under any vmap, pmap or resumption of a state.

    * Scenes: all of them, or `resident_scenes` at a time, the next ones after every `episodes_per_swap` episodes
      (paper: 16 and 100, because of Isaac Sim's memory; a bank here needs no swapping). The order is a shuffle.
    * Routes: all of them, or at first only routes up to `start_distance` m (at least the shortest eight of a scene);
      the limit grows linearly with an env's control steps and is gone after `ramp_steps`.
    * Learnability: the share `learnable` of all draws goes by `learnability`, in training alone (`wrap_for_training`),
      which counts the ends of all envs of a batch; the rest are drawn as above.

    Args:
      config: `config.schedule` of an environment.
      bank: the scenes.
      scenes: (n,) i32, the rows of the bank in use.

    Raises:
      ValidationError: a negative value, no episodes between swaps, a limit without a ramp, or a share outside [0, 1] or
        together with the others.
    """

    #: Routes of a scene that are never left out, however short the limit: a single one could be memorised.
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
        # Policies saved before there was such a share do not have it.
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
        self._count = jnp.asarray(bank.num_episodes, jnp.int32)
        # Rows of each scene from the shortest route to the longest; rows that do not exist come last.
        exists = np.arange(bank.episode_length.shape[1]) < bank.num_episodes[:, None]
        lengths = np.where(exists, bank.episode_length, np.inf)
        self._rows = jnp.asarray(np.argsort(lengths, axis=1, kind="stable"), jnp.int32)
        self._lengths = jnp.asarray(np.sort(lengths, axis=1), jnp.float32)
        self._longest = float(lengths[exists].max())

    def draw(
        self,
        key: Key[Array, ""],
        age: Int[Array, ""],
        episodes: Int[Array, ""],
        bounds: Float[Array, " ZE"] | None = None,
    ) -> tuple[Int[Array, ""], Int[Array, ""]]:
        """Scene () i32 and row () i32 of the next episode.

        Args:
          key: typed, used up here.
          age: () i32 control steps, episodes: () i32 episodes, both behind this env.
          bounds: see `learnability.Learnability.bounds`; None = draw without.
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
        # scene ~ U over the resident ones, row ~ U over the routes within the limit
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
