"""Networks for tasks without pixels: an actor on proprioception, a critic with privileged observations.

Observations are scaled to about 1 (`envs.joystick`), so no running statistics are needed.
"""

from collections.abc import Sequence
from typing import Any

import jax
import jax.numpy as jnp
from brax.training import distribution, networks, types
from brax.training.agents.ppo import networks as ppo_networks
from flax import linen as nn

#: Initial parameter of the standard deviation; its softplus is 0.35. With 0.69 (a parameter of 0), robots fall at once,
#: because actions are about a radian.
FIRST_STD = -0.87


class Perceptron(nn.Module):
    """Dense layers with ELU, and a linear one of `outputs`, whose first weights are scaled by `gain`."""

    hidden: Sequence[int]
    outputs: int
    gain: float = 1.0

    @nn.compact
    def __call__(self, x: jax.Array) -> jax.Array:
        for i, size in enumerate(self.hidden):
            x = nn.elu(nn.Dense(size, name=f"hidden_{i}", kernel_init=nn.initializers.lecun_uniform())(x))
        last = nn.initializers.variance_scaling(self.gain, "fan_in", "normal")
        return nn.Dense(self.outputs, name="out", kernel_init=last)(x)


class GaussianActor(nn.Module):
    """Mean and (before softplus) standard deviation of each action; the latter does not depend on the observation."""

    hidden: Sequence[int]
    action_size: int

    @nn.compact
    def __call__(self, x: jax.Array) -> jax.Array:
        mean = Perceptron(self.hidden, self.action_size, 0.01, name="mean")(x)
        std = self.param("std", nn.initializers.constant(FIRST_STD), (self.action_size,))
        return jnp.concatenate([mean, jnp.broadcast_to(std, mean.shape)], axis=-1)


def make_mlp_networks(
    observation_size: types.ObservationSize,
    action_size: int,
    preprocess_observations_fn: types.PreprocessObservationFn = types.identity_observation_preprocessor,
    actor_hidden: Sequence[int] = (384, 256, 128),
    critic_hidden: Sequence[int] = (512, 256, 128),
    actor_sees: str = "history",
    critic_sees: str = "privileged",
) -> ppo_networks.PPONetworks:
    """Brax's network factory for `JoystickEnv`.

    Args:
      observation_size: shapes by name.
      action_size: number of joints.
      preprocess_observations_fn: unused.
      actor_hidden, critic_hidden: units of the layers.
      actor_sees, critic_sees: names of the observations.
    """
    del preprocess_observations_fn
    sizes: Any = observation_size
    actor = GaussianActor(tuple(actor_hidden), action_size)
    critic: Any = Perceptron(tuple(critic_hidden), 1)
    policy = networks.FeedForwardNetwork(
        init=lambda key: actor.init(key, jnp.zeros((1, *sizes[actor_sees]))),
        apply=lambda _, params, obs: actor.apply(params, obs[actor_sees]),
    )
    value = networks.FeedForwardNetwork(
        init=lambda key: critic.init(key, jnp.zeros((1, *sizes[critic_sees]))),
        apply=lambda _, params, obs: critic.apply(params, obs[critic_sees])[..., 0],
    )
    return ppo_networks.PPONetworks(
        policy_network=policy,
        value_network=value,
        parametric_action_distribution=distribution.NormalTanhDistribution(event_size=action_size),
    )
