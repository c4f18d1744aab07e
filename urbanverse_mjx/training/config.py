"""PPO hyper-parameters of the registry, and their conversion to Brax's arguments."""

import math
from typing import Any

from ml_collections import ConfigDict

from ..datatypes import ValidationError
from ..datatypes import validation as v
from ..envs import registry


def default_ppo_config(preset: str = "paper", environment: str = "CocoNav") -> ConfigDict:
    """Returns a new, locked configuration from the function given to `registry.register_environment`.

    Raises:
      ValidationError: the environment or preset is unknown.
    """
    return registry.get_ppo_config(environment, preset)


#: Fields of which there is at least one, and the largest seed.
_COUNTS = (
    *("num_envs", "num_timesteps", "unroll_length", "minibatch", "minibatches", "epochs", "num_updates_per_batch"),
    "num_checkpoints",
)
_LAST_SEED = 2**32 - 1


def check_numbers(config: ConfigDict, where: str = "ppo") -> None:
    """Refuses hyper-parameters with which no training begins, before streets are compiled for it.

    Raises:
      ValidationError: a number is NaN or infinite, a size below 1, or a seed not one of 32 bits.
    """
    for key, value in config.items():
        if isinstance(value, ConfigDict):
            check_numbers(value, f"{where}.{key}")
        elif isinstance(value, float) and not math.isfinite(value):
            raise v.fail(f"{where}.{key}", v.show(value), "a finite number")
        elif key in _COUNTS and value is not None:
            v.integer(value, f"{where}.{key}", 1)
        elif key == "seed" and value is not None:
            v.integer(value, f"{where}.{key}", 0, _LAST_SEED)


#: Fields that have the same name in Brax's `ppo.train`.
_SAME = (
    "num_envs",
    "unroll_length",
    "num_updates_per_batch",
    "learning_rate",
    "learning_rate_schedule",
    "desired_kl",
    "discounting",
    "gae_lambda",
    "clipping_epsilon",
    "entropy_cost",
    "vf_loss_coefficient",
    "max_grad_norm",
    "reward_scaling",
    "normalize_advantage",
)


def brax_arguments(config: ConfigDict) -> dict[str, Any]:
    """Hyper-parameters under the names of `ppo.train`, including `batch_size` and `num_minibatches`.

    Raises:
      ValidationError: sizes are not divisible as required.
    """
    batch_size, num_minibatches = batch_shape(config)
    return {
        **{name: config[name] for name in _SAME},
        "batch_size": batch_size,
        "num_minibatches": num_minibatches,
        "learning_rate_schedule_max_lr": config.max_learning_rate,
    }


def brax_ppo_config(environment: str, preset: str | None = None) -> ConfigDict:
    """A preset's training as Playground's `config` modules have it: all but `network_factory` goes to `ppo.train` by
    name, with Brax's own networks on the observations `state` and `privileged_state`, which see no pixels.

    Raises:
      ValidationError: the environment or preset is unknown.
    """
    env, own = registry.get_default_config(environment, preset), registry.get_ppo_config(environment, preset)
    if "algorithm" in own:
        raise ValidationError(f"preset: found {preset!r}, which trains by {own.algorithm}, needed one of PPO.")
    sizes = {"policy_hidden_layer_sizes": (128, 128, 128), "value_hidden_layer_sizes": (256, 256, 256)}
    return ConfigDict(
        {
            **brax_arguments(own),
            "num_timesteps": own.num_timesteps,
            "num_evals": own.num_checkpoints + 1,
            "episode_length": env.episode_length,
            "action_repeat": 1,
            "normalize_observations": True,
            "network_factory": {**sizes, "policy_obs_key": "state", "value_obs_key": "privileged_state"},
        }
    )


def batch_shape(config: ConfigDict) -> tuple[int, int]:
    """(batch_size, num_minibatches) in Brax's sense: sequences per minibatch, minibatches per rollout.

    Raises:
      ValidationError: sizes are not divisible as required.
    """
    if config.minibatch % config.unroll_length:
        raise ValidationError(
            f"ppo.minibatch: found {config.minibatch}, needed a multiple of unroll_length {config.unroll_length}."
        )
    sequences = config.minibatch // config.unroll_length
    if config.num_envs % sequences:
        raise ValidationError(
            f"ppo.num_envs: found {config.num_envs}, needed a multiple of minibatch / unroll_length = {sequences}."
        )
    return sequences, config.num_envs // sequences


def steps_trained(config: ConfigDict, steps: int) -> int:
    """Computes the env-steps that Brax trains for `steps`, rounded up: whole rollouts (num_envs x unroll_length), at
    least one before each checkpoint, and as many before each.

    Raises:
      ValidationError: the sizes do not divide.
    """
    batch_size, num_minibatches = batch_shape(config)
    each = batch_size * num_minibatches * config.unroll_length * max(config.num_checkpoints, 1)
    return -(-steps // each) * each
