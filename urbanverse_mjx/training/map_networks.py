"""Networks for a privileged teacher of `NavEnv`, which uses a map of distances around the robot instead of a camera.

A convolutional encoder, which is translation-equivariant, processes the map `privileged_map`; an MLP processes the
vector `privileged` (goal, route, speeds, near distances).
"""

from collections.abc import Sequence
from typing import Any

import jax
import jax.numpy as jnp
from brax.training import distribution, networks, types
from brax.training.agents.ppo import networks as ppo_networks
from flax import linen as nn

from .networks import Encoder, goal_features

MAP, VECTOR = "privileged_map", "privileged"
#: Observation of a robot's size and dynamics (`robots.embodiment`).
ROBOT = "robot"
#: Shape of the flat observation `privileged_map`: cells along and across the heading, hull and edge.
MAP_SHAPE = (20, 16, 2)


class MapTrunk(nn.Module):
    """`privileged_map` and `privileged` to features: a convolutional encoder, then dense layers with ELU.

    Attributes:
      layers: (depth, kernel, stride) of the convolutions; empty to ignore the map.
      hidden: units of the dense layers.
    """

    layers: Sequence[tuple[int, int, int]]
    hidden: Sequence[int]
    convolution: str = "auto"

    @nn.compact
    def __call__(self, distances: jax.Array | None, vector: jax.Array) -> jax.Array:
        """(..., 640) u8 cm and (..., n) f32 -> (..., hidden[-1]) f32."""
        # The first six values are goal and two waypoints (m); the others are of order one.
        near = [goal_features(vector[..., k : k + 2]) for k in (0, 2, 4)]
        x = jnp.concatenate([*near, vector[..., 6:]], axis=-1)
        if distances is not None:
            cells = distances.reshape(*distances.shape[:-1], *MAP_SHAPE)
            seen = Encoder(self.layers, convolution=self.convolution, name="encoder")(cells)
            x = jnp.concatenate([nn.elu(nn.Dense(self.hidden[0], name="seen")(seen)), x], axis=-1)
        for i, size in enumerate(self.hidden):
            x = nn.elu(nn.Dense(size, name=f"hidden_{i}")(x))
        return x


class MapActor(nn.Module):
    """Mean of each action and its (before softplus) standard deviation, which does not depend on the observation."""

    trunk: MapTrunk
    action_size: int

    @nn.compact
    def __call__(self, distances: jax.Array | None, vector: jax.Array) -> jax.Array:
        x = self.trunk(distances, vector)
        small = nn.initializers.variance_scaling(0.01, "fan_in", "normal")
        mean = nn.Dense(self.action_size, name="mean", kernel_init=small)(x)
        std = self.param("std", nn.initializers.zeros_init(), (self.action_size,))
        return jnp.concatenate([mean, jnp.broadcast_to(std, mean.shape)], axis=-1)


class MapCritic(nn.Module):
    """Value of a state."""

    trunk: MapTrunk

    @nn.compact
    def __call__(self, distances: jax.Array | None, vector: jax.Array) -> jax.Array:
        return nn.Dense(1, name="value")(self.trunk(distances, vector))[..., 0]


def make_map_networks(
    observation_size: types.ObservationSize,
    action_size: int,
    preprocess_observations_fn: types.PreprocessObservationFn = types.identity_observation_preprocessor,
    map_layers: Sequence[tuple[int, int, int]] = ((32, 4, 2), (64, 4, 2)),
    hidden: Sequence[int] = (256, 256, 128),
    convolution: str = "auto",
    told: bool = False,
) -> ppo_networks.PPONetworks:
    """Brax's network factory for a teacher.

    Args:
      observation_size: shapes by name; needs `privileged`, `privileged_map` if `map_layers` are given, and `robot` if
        `told`.
      action_size: 2, or the number of actuators with action_mode="joint".
      preprocess_observations_fn: unused, because all observations have fixed scales.
      map_layers: (depth, kernel, stride) of the convolutions on the map; empty for a teacher without the map.
      hidden: units of the dense layers in actor and critic.
      convolution: see `networks.convolution_of`.
      told: whether actor and critic are told the size and the dynamics of the robot.
    """
    del preprocess_observations_fn
    sizes: Any = observation_size

    def map_of(obs: Any) -> Any:
        return obs[MAP] if map_layers else None

    def vector_of(obs: Any) -> Any:
        return jnp.concatenate([obs[VECTOR], obs[ROBOT]], axis=-1) if told else obs[VECTOR]

    layers, hidden = tuple(map_layers), tuple(hidden)
    actor = MapActor(MapTrunk(layers, hidden, convolution), action_size)
    critic = MapCritic(MapTrunk(layers, hidden, convolution))
    dummy = {VECTOR: jnp.zeros((1, *sizes[VECTOR]))}
    if told:
        dummy[ROBOT] = jnp.zeros((1, *sizes[ROBOT]))
    if map_layers:
        dummy[MAP] = jnp.zeros((1, *sizes[MAP]), jnp.uint8)
    return ppo_networks.PPONetworks(
        policy_network=networks.FeedForwardNetwork(
            init=lambda key: actor.init(key, map_of(dummy), vector_of(dummy)),
            apply=lambda _, params, obs: actor.apply(params, map_of(obs), vector_of(obs)),
        ),
        value_network=networks.FeedForwardNetwork(
            init=lambda key: critic.init(key, map_of(dummy), vector_of(dummy)),
            apply=lambda _, params, obs: critic.apply(params, map_of(obs), vector_of(obs)),
        ),
        parametric_action_distribution=distribution.NormalTanhDistribution(event_size=action_size),
    )
