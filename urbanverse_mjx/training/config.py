"""PPO hyper-parameters as the registry has them, and the sizes that Brax makes of them."""

from ml_collections import ConfigDict

from ..datatypes import NounError
from ..envs import registry


def default_ppo_config(preset: str = "paper", environment: str = "CocoNav") -> ConfigDict:
    """A fresh, locked configuration, as `registry.register_environment` was given it.

    Raises:
      NounError: unknown environment or preset.
    """
    return registry.get_ppo_config(environment, preset)


def batch_shape(config: ConfigDict) -> tuple[int, int]:
    """(batch_size, num_minibatches) in Brax's sense: sequences a minibatch, minibatches a rollout.

    Raises:
      NounError: the sizes do not divide.
    """
    if config.minibatch % config.unroll_length:
        raise NounError(
            f"ppo.minibatch: found {config.minibatch}, needed a multiple of unroll_length {config.unroll_length}."
        )
    sequences = config.minibatch // config.unroll_length
    if config.num_envs % sequences:
        raise NounError(
            f"ppo.num_envs: found {config.num_envs}, needed a multiple of minibatch / unroll_length = {sequences}."
        )
    return sequences, config.num_envs // sequences
