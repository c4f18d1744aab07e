"""Behaviour cloning: a student with a camera fitted to the actions of recorded episodes, without a simulator.

All episodes lie one after another in a ring. Several readers go round it, each from a place of its own and a few steps
in every iteration, with the student's memory of the episode so far, which is emptied where the next episode begins.
Half of the readers see everything in a mirror (`sequences`).
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import optax
from ml_collections import ConfigDict

from .. import table_arguments
from .dagger import make_student
from .devices import ALONE
from .networks import PIXELS
from .sequences import LATERAL_ACTION, epochs, mirror_lateral, mirrored_view, relit
from .student import SEEN, initial_student

#: Parts of the config of a preset that belong to other stages than imitation.
_OTHER_STAGES = ("teacher", "finetune", "shares", "validation_episodes")


def cloning_config(config: ConfigDict) -> ConfigDict:
    """The imitation part of a preset's training config, for `Cloning`; unlocked."""
    return ConfigDict({k: x for k, x in config.to_dict().items() if k not in _OTHER_STAGES})


class Demonstrations(NamedTuple):
    """Steps of recorded episodes, whole episodes one after another.

    Attributes:
      obs: `SEEN`, each (N, ...), pixels u8 and the rest f32.
      action: (N, A) f32 in [-1, 1].
      begins: (N,) bool, the step is the first of an episode.
    """

    obs: Any
    action: Any
    begins: Any


class CloningState(NamedTuple):
    """The training state between iterations.

    Attributes:
      params, optimizer: of the student.
      memory: (n, memory) of the readers.
      place: (n,) i32, the step that each reader comes to next.
      key: typed.
      steps: () i32 iterations done.
    """

    params: Any
    optimizer: Any
    memory: jax.Array
    place: jax.Array
    key: jax.Array
    steps: jax.Array


class _Block(NamedTuple):
    """What the readers see in an iteration; all (T, n, ...)."""

    obs: Any
    action: jax.Array
    begins: jax.Array


class Cloning:
    """The algorithm; `imitation.fit` makes it a run folder.

    Args:
      demonstrations: at least one step.
      config: see `dagger.default_dagger_config`; `num_envs` is the number of readers, `unroll_length` the steps
        that each reads in an iteration, `epochs` the passes over these. `teacher_share`, `warm_up`, `noise` and
        `auxiliary` are not used.

    Raises:
      ValidationError: the readers do not divide into the minibatches.
    """

    def __init__(self, demonstrations: Demonstrations, config: ConfigDict) -> None:
        ALONE.check_shares(int(config.num_envs), {"ppo.minibatches": int(config.minibatches)})
        self.config = config
        self._data = jax.tree.map(jnp.asarray, demonstrations)
        self._count = int(demonstrations.begins.shape[0])
        self.student = make_student(config, int(demonstrations.action.shape[1]))
        self._rate = optax.cosine_decay_schedule(
            config.learning_rate, 1, config.final_learning_rate / config.learning_rate
        )
        self._optimizer = optax.chain(optax.clip_by_global_norm(config.max_grad_norm), optax.scale_by_adam())
        self.steps_per_iteration = int(config.num_envs) * int(config.unroll_length)
        self._compiled = table_arguments.jit(self._iterate, donate_argnums=0)

    def begin(self) -> CloningState:
        """The state before the first iteration; every reader stands at the first step of an episode."""
        n = int(self.config.num_envs)
        key, key_place = jax.random.split(jax.random.key(int(self.config.seed)))
        firsts = jnp.flatnonzero(self._data.begins, size=self._count, fill_value=0)
        episodes = self._data.begins.sum()
        place = firsts[jax.random.randint(key_place, (n,), 0, episodes)].astype(jnp.int32)
        sizes = {name: self._data.obs[name].shape[1:] for name in SEEN}
        params = initial_student(self.student, sizes, int(self.config.seed))
        optimizer = self._optimizer.init(params)
        memory = self.student.first_memory(n)
        return CloningState(params, optimizer, memory, place, key, jnp.zeros((), jnp.int32))

    def iterate(self, state: CloningState, progress: jax.Array) -> tuple[CloningState, dict[str, jax.Array]]:
        """One iteration, which takes the buffers of `state`; and its loss and mean absolute error.

        Args:
          progress: () in [0, 1], of the whole training; the learning rate follows it.
        """
        return self._compiled(state, self._data, progress)

    def placed(self, state: CloningState) -> CloningState:
        """A state of a file, on the device."""
        return state

    def actor(self, state: CloningState) -> Any:
        """The parameters of the student in a state."""
        return state.params

    def block(self, data: Demonstrations, place: jax.Array) -> _Block:
        """The next steps of the readers at `place` (n,), every second reader's mirrored."""
        rows = (place + jnp.arange(int(self.config.unroll_length))[:, None]) % self._count
        taken = jax.tree.map(lambda x: x[rows], data)
        mirrored = (jnp.arange(place.shape[0]) % 2 == 1) & bool(self.config.mirror)
        obs = jax.vmap(lambda obs: mirrored_view(obs, mirrored))(taken.obs)
        action = jax.vmap(lambda action: mirror_lateral(action, mirrored, LATERAL_ACTION))(taken.action)
        return _Block(obs, action, taken.begins)

    def _loss(self, params: Any, block: _Block, memory: jax.Array, key: jax.Array) -> tuple[jax.Array, Any]:
        pixels = relit(block.obs[PIXELS], key, self.config.light, self.config.pixel_noise, self.config.get("blur", 0.0))
        own, _, _ = self.student.apply(params, {**block.obs, PIXELS: pixels}, memory, block.begins)  # type: ignore[misc]
        loss = optax.huber_loss(own, block.action, delta=0.5).sum(-1).mean()
        return loss, (loss, jnp.abs(own - block.action).mean())

    def _iterate(
        self, state: CloningState, data: Demonstrations, progress: jax.Array
    ) -> tuple[CloningState, dict[str, jax.Array]]:
        key, key_learn = jax.random.split(state.key)
        block = self.block(data, state.place)
        (params, optimizer), (loss, error) = epochs(
            self._loss, self._optimizer, (state.params, state.optimizer), block, state.memory, key_learn,
            self._rate(progress), int(self.config.epochs), int(self.config.minibatches),
        )  # fmt: skip
        memory = state.memory
        if self.student.memory:
            _, memory, _ = self.student.apply(params, block.obs, memory, block.begins)  # type: ignore[misc]
        place = (state.place + int(self.config.unroll_length)) % self._count
        new = state._replace(
            params=params, optimizer=optimizer, memory=memory, place=place, key=key, steps=state.steps + 1
        )
        return new, {"cloning": loss, "error": error}
