"""The student network: maps camera image, goal and proprioception to an action, with or without memory.

It also predicts the distances around the robot (`privileged_map`) for an optional auxiliary loss, which makes the
features encode the surroundings.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import jax
import jax.numpy as jnp
from flax import linen as nn

from .map_networks import MAP_SHAPE
from .networks import PIXELS, Encoder, goal_features

#: Observations of a student.
SEEN = (PIXELS, "goal", "proprio")
#: Cells of the predicted map, a quarter of `privileged_map`'s: (X, Y, hull and edge).
PREDICTED = (10, 8, 2)


class _Memory(nn.Module):
    """A GRU cell whose memory is reset when an episode begins."""

    size: int

    @nn.compact
    def __call__(self, memory: jax.Array, inputs: tuple[jax.Array, jax.Array]) -> tuple[jax.Array, jax.Array]:
        x, begins = inputs
        memory = jnp.where(begins[..., None], 0.0, memory)
        return nn.GRUCell(self.size, name="gru")(memory, x)


class Student(nn.Module):
    """A deterministic policy network.

    Attributes:
      layers: (depth, kernel, stride) of the conv layers.
      hidden: units of the dense layers.
      memory: units of the GRU; 0 = none.
      proprio: whether the network sees proprioception; without it zeros stand in its place.
      last_action: whether it sees the action before, the last part of proprioception; without it zeros stand in its
        place. A student that imitates recorded actions may repeat that one in place of looking (de Haan et al., "Causal
        Confusion in Imitation Learning", 2019).
      dtype: of the convolutions' arithmetic.
      single_step: whether sequences have one step and need no scan, because ONNX has no scan over a batch of unknown
        size.
    """

    layers: Sequence[tuple[int, int, int]]
    action_size: int
    hidden: int = 256
    memory: int = 256
    proprio: bool = True
    dtype: Any = jnp.float32
    convolution: str = "auto"
    single_step: bool = False
    last_action: bool = True

    @nn.compact
    def __call__(
        self, obs: Mapping[str, jax.Array], memory: jax.Array, begins: jax.Array
    ) -> tuple[jax.Array, jax.Array, jax.Array]:
        """Applies the network to a batch of sequences.

        Args:
          obs: `SEEN`, each (T, n, ...).
          memory: (n, memory) before the first step.
          begins: (T, n) bool, whether the observation is the first of an episode.

        Returns:
          actions (T, n, action_size) in [-1, 1], memory (n, memory) after the last step, and the predicted map
          (T, n, *PREDICTED) in units of 2.55 m.
        """
        seen = Encoder(self.layers, self.dtype, self.convolution, name="encoder")(obs[PIXELS])
        seen = nn.LayerNorm(name="seen_norm")(nn.Dense(self.hidden, name="seen")(seen))
        proprio = obs["proprio"] if self.proprio else jnp.zeros_like(obs["proprio"])
        if not self.last_action:
            kept, hidden = proprio[..., : -self.action_size], proprio[..., -self.action_size :]
            proprio = jnp.concatenate([kept, jnp.zeros_like(hidden)], axis=-1)
        x = jnp.concatenate([nn.elu(seen), goal_features(obs["goal"]), proprio], axis=-1)
        x = nn.elu(nn.Dense(self.hidden, name="joint")(x))
        if self.memory and self.single_step:
            memory, kept = _Memory(self.memory, name="memory")(memory, (x[0], begins[0]))
            x = jnp.concatenate([x, kept[None]], axis=-1)
        elif self.memory:
            scan = nn.scan(_Memory, variable_broadcast="params", split_rngs={"params": False}, in_axes=0, out_axes=0)
            memory, kept = scan(self.memory, name="memory")(memory, (x, begins))
            x = jnp.concatenate([x, kept], axis=-1)
        size = PREDICTED[0] * PREDICTED[1] * PREDICTED[2]
        predicted = nn.Dense(size, name="map")(nn.elu(nn.Dense(self.hidden, name="map_hidden")(x)))
        x = nn.elu(nn.Dense(self.hidden // 2, name="head")(x))
        small = nn.initializers.variance_scaling(0.01, "fan_in", "normal")
        action = jnp.tanh(nn.Dense(self.action_size, name="action", kernel_init=small)(x))
        return action, memory, predicted.reshape(*predicted.shape[:-1], *PREDICTED)

    def first_memory(self, *lead: int) -> jax.Array:
        """(..., memory) of an episode's first step."""
        return jnp.zeros((*lead, self.memory))


def predicted_target(distances: jax.Array) -> jax.Array:
    """(..., *MAP_SHAPE) u8 cm -> (..., *PREDICTED): means of two by two cells, in units of 2.55 m."""
    x = distances.astype(jnp.float32) / 255.0
    lead = x.shape[: -len(MAP_SHAPE)]
    return x.reshape(*lead, PREDICTED[0], 2, PREDICTED[1], 2, PREDICTED[2]).mean((-4, -2))


def initial_student(network: Student, observations: Mapping[str, Any], seed: int) -> Any:
    """Randomly initialised parameters for observations of the given shapes."""
    types = {PIXELS: jnp.uint8}
    obs = {name: jnp.zeros((1, 1, *observations[name]), types.get(name, jnp.float32)) for name in SEEN}
    return network.init(jax.random.key(seed), obs, network.first_memory(1), jnp.ones((1, 1), bool))


class StudentPolicy:
    """A student with its parameters as a recurrent agent for one env inside jit.

    `act(obs, memory, key)` returns (action, memory); an episode begins with `first_memory()`.
    """

    def __init__(self, network: Student, params: Any) -> None:
        self._network, self._params = network, params

    def first_memory(self) -> jax.Array:
        """(memory,) of an episode's first step."""
        return self._network.first_memory()

    def act(self, obs: Mapping[str, jax.Array], memory: jax.Array, key: jax.Array) -> tuple[jax.Array, jax.Array]:
        """The action (action_size,) of one env, and the new memory."""
        del key
        one = {name: obs[name][None, None] for name in SEEN}
        action, memory, _ = self._network.apply(self._params, one, memory[None], jnp.zeros((1, 1), bool))  # type: ignore[misc]
        return action[0, 0], memory[0]
