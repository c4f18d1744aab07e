"""PPO hyper-parameters of the navigation task: `ppo_config(preset)` returns a new, locked `ConfigDict`.

`paper` follows the paper's table "Optimization and training hyperparameters".
"""

from ml_collections import ConfigDict

from ...datatypes import validation as v


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
            # Brax's adaptive rate may rise to 1e-2 while the policy changes little. At 135x240 this makes all ReLUs of
            # the last convolution inactive within 1 M steps, and the policy ignores the image
            # (docs/decisions/presets.md).
            "max_learning_rate": 1e-3,
            "discounting": 0.99,
            "gae_lambda": 0.95,
            "clipping_epsilon": 0.2,
            "entropy_cost": 0.002,
            "vf_loss_coefficient": 1.0,
            "max_grad_norm": 1.0,
            # Brax's critic regresses raw returns; this factor scales the paper's reward of 2000 to 20.
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


def imitation_config() -> ConfigDict:
    """Values of the DAgger fields for a GPU; see `training.dagger.default_dagger_config`."""
    return ConfigDict(
        {
            "algorithm": "dagger",
            "num_envs": 4096,
            "unroll_length": 16,
            "epochs": 2,
            "minibatches": 8,
            "learning_rate": 5e-4,
            "final_learning_rate": 3e-5,
            "max_grad_norm": 1.0,
            "teacher_share": 0.2,
            "warm_up": 2_000_000,
            "noise": 0.1,
            "auxiliary": 0.5,
            "mirror": True,
            "light": 0.2,
            "pixel_noise": 0.01,
            "blur": 0.0,
            "seed": 0,
            "network": {
                "layers": ((32, 4, 2), (64, 4, 2), (64, 4, 2)),
                "hidden": 256,
                "memory": 256,
                "proprio": True,
                "last_action": True,
                "bfloat16": True,
                "convolution": "auto",
            },
        }
    )


def finetune_config() -> ConfigDict:
    """Values of the PPO fine-tuning fields; see `training.finetune.default_finetune_config`."""
    return ConfigDict(
        {
            "num_envs": 4096,
            "unroll_length": 32,
            "epochs": 2,
            "minibatches": 16,
            "learning_rate": 1e-4,
            "final_learning_rate": 1e-5,
            "critic_learning_rate": 5e-4,
            "critic_only": 3_000_000,
            "max_grad_norm": 1.0,
            "clip": 0.2,
            "discounting": 0.99,
            "gae_lambda": 0.95,
            "reward_scaling": 0.2,
            "noise": 0.15,
            "imitation": 0.5,
            "final_imitation": 0.05,
            "auxiliary": 0.5,
            "mirror": True,
            "light": 0.2,
            "pixel_noise": 0.01,
            "blur": 0.0,
            "seed": 0,
            "map_layers": ((32, 4, 2), (64, 4, 2)),
            "critic_hidden": (256, 256, 128),
        }
    )


def _finetune_without_labels() -> ConfigDict:
    """`finetune_config` as a part of another config, with no weight of a teacher's labels, and for images that the
    environment varies."""
    config = finetune_config()
    config.imitation = config.final_imitation = 0.0
    config.light = config.pixel_noise = 0.0
    del config.num_envs, config.seed
    return config


def _quick() -> ConfigDict:
    """Imitation of a scripted controller on a CPU."""
    config = imitation_config()
    config.num_timesteps, config.num_checkpoints = 163_840, 4  # ten minutes on two cores
    config.num_envs, config.epochs, config.minibatches = 64, 4, 4
    config.learning_rate, config.final_learning_rate = 1e-3, 1e-4
    config.warm_up, config.noise = 20_000, 0.05
    config.network.layers = ((16, 4, 4), (32, 2, 2), (64, 2, 1))
    config.network.hidden, config.network.memory = 128, 0
    config.network.bfloat16 = False  # slow on a CPU
    return config


def _best() -> ConfigDict:
    """A privileged teacher, its imitation by a student with a camera, and PPO fine-tuning, on a GPU; for the fields see
    `training.teacher_student.TeacherStudent`."""
    config, teacher = imitation_config(), _fast()
    config.num_timesteps, config.num_checkpoints = 68_000_000, 10
    config.light = config.pixel_noise = 0.0  # the environment varies the images
    config.shares = {"teacher": 12.0, "imitation": 26.0, "finetune": 30.0}
    config.validation_episodes = 256
    for name in ("num_timesteps", "num_envs", "num_checkpoints", "minibatch", "seed"):
        del teacher[name]
    # Minibatches per rollout; the teacher generalises better without the map (docs/results.md).
    teacher.minibatches = 8
    teacher.network = {"map_layers": (), "hidden": (256, 256, 128)}
    config.teacher, config.finetune = teacher, _finetune_without_labels()
    return config


def _tune() -> ConfigDict:
    """PPO of a trained student on the streets of a bank, on a GPU; for the fields see `training.tuning.tune`."""
    student = imitation_config()
    kept = {name: student[name] for name in ("algorithm", "num_envs", "seed", "network")}
    own = {"num_timesteps": 20_971_520, "num_checkpoints": 4, "validation_episodes": 256}  # 160 iterations
    return ConfigDict({**kept, **own, "finetune": _finetune_without_labels()})


def ppo_config(preset: str = "paper") -> ConfigDict:
    """Returns a new configuration; its `algorithm` may be other than PPO, as for `quick`, `best` and `tune`.

    Raises:
      ValidationError: the preset is unknown.
    """
    makers = {
        "paper": _paper,
        "urbansim_v0_1": _urbansim_v0_1,
        "fast": _fast,
        "best": _best,
        "tune": _tune,
        "cpu": _cpu,
        "quick": _quick,
    }
    v.choice(preset, "preset", makers)
    return makers[preset]().lock()


def deliver_ppo_config(preset: str = "paper") -> ConfigDict:
    """`ppo_config` for a robot with an arm, whose mirror image has other joint angles: nothing is mirrored.

    Raises:
      ValidationError: the preset is unknown.
    """
    config = ppo_config(preset).copy_and_resolve_references().unlock()
    for part in (config, config.get("finetune", None)):
        if part is not None and "mirror" in part:
            part.mirror = False
    return config.lock()


def follow_route_ppo_config(preset: str = "paper") -> ConfigDict:
    """`ppo_config` with a teacher that looks ahead as far as a signal's cycle lasts.

    Raises:
      ValidationError: the preset is unknown.
    """
    config = ppo_config(preset).copy_and_resolve_references().unlock()
    if "teacher" in config:
        config.teacher.discounting = 0.995  # a mean of 40 s at 5 Hz
    return config.lock()
