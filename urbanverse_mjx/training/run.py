"""Training: Brax PPO, unmodified, over a `NavEnv`, with logs, checkpoints and resumption."""

import dataclasses
import pathlib
import time
from typing import Any

import jax
from ml_collections import ConfigDict

from ..datatypes import NounError
from ..datatypes import validation as v
from ..envs import wrap_for_training
from .brax_compat import load_ppo
from .config import batch_shape
from .policy import PolicySpec, latest_policy, load_params, network_factory, save_policy
from .progress import TrainingLog


@dataclasses.dataclass(frozen=True)
class TrainingResult:
    """What a training left behind.

    Attributes:
      policy: folder of the last policy.
      steps: env-steps in all segments; seconds: wall time of this segment, compilation included.
      steps_per_second: median over the run's logging intervals, compilation left out.
    """

    policy: pathlib.Path
    steps: int
    seconds: float
    steps_per_second: float


def _start_of(folder: pathlib.Path, resume: bool) -> tuple[int, Any]:
    """Steps done and parameters of the newest checkpoint of a run folder."""
    checkpoints = folder / "checkpoints"
    if not resume:
        if checkpoints.exists() and any(checkpoints.iterdir()):
            raise NounError(f"run folder: found checkpoints in {folder}, needed a new folder; or pass --resume.")
        return 0, None
    path = latest_policy(checkpoints)
    return PolicySpec.load(path).steps, load_params(path)


def _ppo_arguments(config: ConfigDict) -> dict[str, Any]:
    """Our hyper-parameters under the names of `ppo.train`."""
    batch_size, num_minibatches = batch_shape(config)
    same = (
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
    return {
        **{name: config[name] for name in same},
        "batch_size": batch_size,
        "num_minibatches": num_minibatches,
        "learning_rate_schedule_max_lr": config.max_learning_rate,
        "normalize_observations": False,
        "num_evals": config.num_checkpoints + 1,
        # Brax builds an evaluator even when it never runs it; the same size shares the render context.
        "num_eval_envs": config.num_envs // jax.local_device_count(),
        "run_evals": False,
        "log_training_metrics": True,
        "training_metrics_steps": batch_size * num_minibatches * config.unroll_length,
    }


def train(
    environment: str,
    env: Any,
    ppo_config: ConfigDict,
    folder: pathlib.Path,
    resume: bool = False,
    quiet: bool = False,
) -> TrainingResult:
    """Trains a policy and returns where it is.

    Args:
      environment: the name the env is registered under.
      env: not wrapped.
      ppo_config: see `config.default_ppo_config`.
      folder: run folder; checkpoints/<steps>/, log.jsonl and TensorBoard events go there.
      resume: go on from the newest checkpoint there. Brax restores the networks, not Adam's moments and not the
        episodes under way: those start anew, with another seed, and the step counter goes on.

    Raises:
      NounError: sizes that do not divide, a folder in use, nothing to resume.
    """
    ppo = load_ppo()
    folder = folder.absolute()
    folder.mkdir(parents=True, exist_ok=True)
    start, params = _start_of(folder, resume)
    total = int(ppo_config.num_timesteps)
    if start >= total:
        raise NounError(f"ppo.num_timesteps: found {total}, but {start} are done already; ask for more.")
    v.write_json(
        folder / "config.json", {"environment": environment, "env": env.config.to_dict(), "ppo": ppo_config.to_dict()}
    )
    log = TrainingLog(folder, total, start, quiet)
    last: list[pathlib.Path] = []

    def keep(step: int, _: Any, params: Any) -> None:
        if step > 0:
            spec = PolicySpec.of(environment, env, ppo_config, start + step)
            last.append(save_policy(folder / "checkpoints", params, spec))

    begin = time.monotonic()
    try:
        ppo.train(
            environment=env,
            wrap_env_fn=wrap_for_training,
            episode_length=env.config.episode_length,
            num_timesteps=total - start,
            # Another seed after a resume: the same one would replay the first segment's episodes.
            seed=ppo_config.seed + start,
            network_factory=network_factory(ppo_config),
            progress_fn=log,
            policy_params_fn=keep,
            restore_params=params,
            **_ppo_arguments(ppo_config),
        )
        jax.effects_barrier()
    finally:
        log.close()
    return TrainingResult(
        policy=last[-1],
        steps=PolicySpec.load(last[-1]).steps,
        seconds=time.monotonic() - begin,
        steps_per_second=log.steps_per_second,
    )
