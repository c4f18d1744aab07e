"""PPO hyper-parameters by environment and preset; navigation's `paper` follows the paper's table "Optimization and
training hyperparameters", the walking task what public quadruped tasks share (docs/decisions/go2.md)."""

from ml_collections import ConfigDict

from ..datatypes import NounError


def _paper() -> ConfigDict:
    return ConfigDict(
        {
            "num_timesteps": 4_608_000,  # 1500 epochs x 32 steps x 96 envs
            "num_envs": 96,
            "unroll_length": 32,
            "minibatch": 512,  # transitions
            "num_updates_per_batch": 5,
            "learning_rate": 1e-4,
            "learning_rate_schedule": "ADAPTIVE_KL",
            "desired_kl": 0.01,
            # Brax lets it rise to 1e-2 while the policy changes little; at 135x240 that killed every ReLU of the last
            # convolution within 1 M steps, and the policy drove blind (docs/decisions/presets.md).
            "max_learning_rate": 1e-3,
            "discounting": 0.99,
            "gae_lambda": 0.95,
            "clipping_epsilon": 0.2,
            "entropy_cost": 0.002,
            "vf_loss_coefficient": 1.0,
            "max_grad_norm": 1.0,
            # Brax's critic regresses raw returns; 0.01 keeps the paper's +2000 near one hundredth of that.
            "reward_scaling": 0.01,
            "normalize_advantage": True,
            "num_checkpoints": 50,
            "seed": 0,
            "network": {
                "layers": ((16, 8, 4), (32, 4, 2), (64, 4, 2)),
                "critic_sees": "pixels",
                "bfloat16": True,  # the paper's mixed precision
                "convolution": "auto",
            },
        }
    )


def _urbansim_v0_1() -> ConfigDict:
    config = _paper()
    config.num_envs = 256
    config.minibatch = 2048
    config.learning_rate = 1e-3
    config.entropy_cost = 0.005
    config.num_timesteps = 3000 * 32 * 256
    return config


def _fast() -> ConfigDict:
    """Thousands of envs on a GPU: half the frame memory (no second CNN), larger minibatches, bfloat16 convolutions."""
    config = _paper()
    config.num_timesteps = 20_971_520  # 640 rollouts
    config.num_envs = 1024
    config.minibatch = 2048
    config.num_updates_per_batch = 4
    config.learning_rate = 3e-4
    config.reward_scaling = 0.2
    config.num_checkpoints = 20
    config.network.critic_sees = "privileged"
    return config


def _cpu() -> ConfigDict:
    config = _paper()
    config.num_timesteps = 196_608
    config.num_envs = 64
    config.num_updates_per_batch = 4
    config.learning_rate = 5e-4
    config.reward_scaling = 0.2
    config.num_checkpoints = 8
    config.network.layers = ((16, 4, 4), (32, 2, 2), (64, 2, 1))
    config.network.bfloat16 = False  # slow on a CPU
    config.network.critic_sees = "privileged"
    return config


def _joystick_fast() -> ConfigDict:
    """8,192 envs, 24 steps, 5 epochs of 4 minibatches, as rsl_rl's users train quadrupeds with."""
    config = _paper()
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


def _joystick_cpu() -> ConfigDict:
    config = _joystick_fast()
    config.num_timesteps = 122_880
    config.num_envs = 64
    config.minibatch = 384
    config.num_checkpoints = 4
    config.network = {"actor_hidden": (128, 64), "critic_hidden": (128, 64)}
    return config


_NAVIGATION = {"paper": _paper, "urbansim_v0_1": _urbansim_v0_1, "fast": _fast, "cpu": _cpu}
_WALKING = {"fast": _joystick_fast, "cpu": _joystick_cpu}


def default_ppo_config(preset: str = "paper", environment: str = "CocoNav") -> ConfigDict:
    """A fresh, locked configuration; environments named "...Joystick" walk, all others navigate.

    Raises:
      NounError: unknown preset.
    """
    makers = _WALKING if environment.endswith("Joystick") else _NAVIGATION
    if preset not in makers:
        raise NounError(f"preset: found {preset!r}, needed one of {', '.join(makers)}.")
    return makers[preset]().lock()


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
