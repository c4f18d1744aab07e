"""PPO hyper-parameters of the locomotion task, as in public quadruped tasks (docs/decisions/go2.md):
`joystick_ppo_config(preset)` returns a new, locked `ConfigDict`."""

from ml_collections import ConfigDict

from ...datatypes import validation as v
from ..navigation.ppo import ppo_config


def _fast() -> ConfigDict:
    """8,192 envs, 24 steps, 5 epochs of 4 minibatches, usual values of rsl_rl for quadrupeds."""
    config = ppo_config("paper").unlock()
    config.num_timesteps = 393_216_000  # 2,000 rollouts
    config.num_envs = 8192
    config.unroll_length = 24
    config.minibatch = 49_152
    config.num_updates_per_batch = 5
    config.learning_rate = 1e-3
    config.max_learning_rate = 2e-3
    config.entropy_cost = 0.005
    config.reward_scaling = 1.0
    config.num_checkpoints = 20
    config.network = {"actor_hidden": (384, 256, 128), "critic_hidden": (512, 256, 128)}
    return config


def _cpu() -> ConfigDict:
    config = _fast()
    config.num_timesteps = 122_880
    config.num_envs = 64
    config.minibatch = 384
    config.num_checkpoints = 4
    config.network = {"actor_hidden": (128, 64), "critic_hidden": (128, 64)}
    return config


def joystick_ppo_config(preset: str = "fast") -> ConfigDict:
    """Returns a new configuration.

    Raises:
      ValidationError: the preset is unknown.
    """
    makers = {"fast": _fast, "cpu": _cpu}
    v.choice(preset, "preset", makers)
    return makers[preset]().lock()
