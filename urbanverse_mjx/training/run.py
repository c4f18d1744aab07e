"""Training by unmodified Brax PPO with logs, checkpoints and resumption."""

import dataclasses
import pathlib
import time
from typing import Any

import jax
from ml_collections import ConfigDict

from .. import settings
from ..datatypes import PlacedBank, ValidationError
from ..datatypes import validation as v
from ..envs import wrap_for_training
from .brax_compat import load_ppo
from .config import batch_shape, brax_arguments, steps_trained
from .devices import Devices, nearest
from .policy import PolicySpec, latest_policy, load_compatible, load_params, network_factory, save_policy
from .progress import TrainingLog
from .record import begin_segment, check_scenes
from .run_folder import check_new


@dataclasses.dataclass(frozen=True)
class TrainingResult:
    """The result of a training.

    Attributes:
      policy: folder of the last policy; None in all but the first process of a training over several hosts.
      steps: env-steps in all segments.
      seconds: wall time of this segment, compilation included.
      steps_per_second: median over the run's logging intervals, without compilation.
    """

    policy: pathlib.Path | None
    steps: int
    seconds: float
    steps_per_second: float


def _start_of(folder: pathlib.Path, resume: bool, env: Any) -> tuple[int, Any]:
    """Steps done and parameters of the newest checkpoint of a run folder, trained on the scenes of `env`."""
    checkpoints = folder / "checkpoints"
    if not resume:
        check_new(folder)
        return 0, None
    path = latest_policy(checkpoints)
    params = load_params(path)
    if not params[2]:
        raise ValidationError(
            f"--resume: found a policy without its critic in {path}, needed a checkpoint of a training."
        )
    spec = PolicySpec.load(path)
    check_scenes(spec, env)
    return spec.steps, params


def check_shares(config: ConfigDict, devices: Devices) -> None:
    """Checks that every device gets equally many envs of every minibatch of Brax PPO.

    Raises:
      ValidationError: it does not.
    """
    sequences, _ = batch_shape(config)
    if sequences % devices.count:
        fit = nearest(sequences, devices.count)
        raise ValidationError(
            f"ppo.minibatch: found {config.minibatch}, needed a multiple of {devices.count} devices x unroll_length "
            f"{config.unroll_length}; take --num-envs {nearest(config.num_envs, fit)} --ppo-overrides "
            f"'{{\"minibatch\": {fit * config.unroll_length}}}'{devices.remedy}."
        )


def _ppo_arguments(config: ConfigDict) -> dict[str, Any]:
    """Arguments of `ppo.train` from the config."""
    same = brax_arguments(config)
    return {
        **same,
        "normalize_observations": False,
        "num_evals": config.num_checkpoints + 1,
        # Brax builds an evaluator even if it never runs it; with the same size it shares the render context.
        "num_eval_envs": config.num_envs // jax.device_count(),
        "run_evals": False,
        "log_training_metrics": True,
        "training_metrics_steps": same["batch_size"] * same["num_minibatches"] * config.unroll_length,
    }


def train(
    environment: str,
    env: Any,
    ppo_config: ConfigDict,
    folder: pathlib.Path,
    resume: bool = False,
    quiet: bool = False,
    start_from: pathlib.Path | None = None,
) -> TrainingResult:
    """Trains a policy and returns its folder.

    Args:
      environment: name under which the env is registered.
      env: environment without wrappers.
      ppo_config: see `config.default_ppo_config`.
      folder: run folder; checkpoints/<steps>/, log.jsonl and TensorBoard events go there.
      resume: whether to continue from the newest checkpoint. Brax restores the networks, but not the optimizer state or
        the running episodes, which start again with another seed; the step counter continues. `environment`, the env's
        config and scenes and `ppo_config` must be those of the run, except for `record.MAY_CHANGE`.
      start_from: policy with the initial networks, e.g. of another robot; a new critic is initialised if it has none.
        Cannot be combined with `resume`.

    Raises:
      ValidationError: sizes are not divisible as required, the folder is in use, there is no run to resume, a resumed
        run has another configuration, or the initial networks have other shapes.
    """
    if isinstance(env.bank, PlacedBank):
        raise ValidationError(
            "config.schedule.places: found it with Brax's PPO, needed 0: its programs have no place for an exchange of "
            "scenes; take the preset 'quick' or 'tune', or keep all scenes on the device."
        )
    ppo = load_ppo()
    folder = folder.absolute()
    writes = jax.process_index() == 0
    start, params = _start_of(folder, resume, env)
    if start_from is not None:
        if resume:
            raise ValidationError("--start-from: found it together with --resume, needed one of them.")
        params = load_compatible(start_from, env, ppo_config)
    total = int(ppo_config.num_timesteps)
    if start >= total:
        raise ValidationError(f"ppo.num_timesteps: found {total}, but {start} are done already; ask for more.")
    check_shares(ppo_config, Devices.every())
    Devices.every().check_draws(wrap_for_training(env, env.config.episode_length).learns_episodes)
    record = begin_segment(folder, environment, env.config, ppo_config, start, start_from)
    last: list[pathlib.Path] = []

    def keep(step: int, _: Any, params: Any) -> None:
        if step > 0:
            spec = PolicySpec.of(environment, env, ppo_config, start + step)
            last.append(save_policy(folder / "checkpoints", params, spec))

    if writes:
        folder.mkdir(parents=True, exist_ok=True)
        record.save(folder)
    end = start + steps_trained(ppo_config, total - start)
    log = TrainingLog(folder, end, start, quiet) if writes else None
    begin = time.monotonic()
    try:
        ppo.train(
            environment=env,
            wrap_env_fn=wrap_for_training,
            episode_length=env.config.episode_length,
            num_timesteps=total - start,
            # A resumed run has another seed, because the same one would repeat the first segment's episodes.
            seed=ppo_config.seed + start,
            network_factory=network_factory(ppo_config),
            progress_fn=log or _ignore_progress,
            policy_params_fn=keep,
            restore_params=params,
            restore_value_fn=params is not None and bool(params[2]),
            **_ppo_arguments(ppo_config),
        )
        jax.effects_barrier()
    finally:
        if log is not None:
            log.close()
    return TrainingResult(
        policy=last[-1] if last else None,
        steps=PolicySpec.load(last[-1]).steps if last else total,
        seconds=time.monotonic() - begin,
        steps_per_second=log.steps_per_second if log is not None else 0.0,
    )


def _ignore_progress(_: int, __: Any) -> None:
    pass


def join_processes(coordinator: str, num_processes: int | None, process_id: int | None) -> None:
    """Joins this process to a training over several hosts, each of which uses all GPUs that it sees.

    Where Slurm or Open MPI started more processes than hosts, the k-th process of a host uses GPU k instead. The
    environment variable JAX_LOCAL_DEVICE_IDS (such as "0,1") selects others.

    Must be called before JAX initialises its devices. All processes then call `train` with the same arguments;
    `num_envs` is the total over all of them. Only the first process writes files.

    Args:
      coordinator: "host:port" of the first process, or "auto" if JAX can detect the cluster (Slurm, Open MPI,
        Kubernetes).
      num_processes, process_id: number of processes, and index of this one; required unless "auto".

    Raises:
      ValidationError: a number is missing or outside its range.
    """
    if coordinator == "auto":
        jax.distributed.initialize(local_device_ids=_local_device_ids())
        return
    if num_processes is None or process_id is None:
        raise ValidationError(
            f"--coordinator: found {coordinator!r} without --num-processes and --process-id, needed all three, or "
            "'auto' on a cluster that JAX detects."
        )
    v.integer(num_processes, "--num-processes", 1)
    v.integer(process_id, "--process-id", 0, num_processes - 1)
    if ":" not in coordinator:
        raise ValidationError(f"--coordinator: found {coordinator!r}, needed HOST:PORT of process 0.")
    # Processes on CPUs need a library for collective operations.
    jax.config.update("jax_cpu_collectives_implementation", "gloo")
    jax.distributed.initialize(coordinator, num_processes, process_id, _local_device_ids())


def _local_device_ids() -> list[int] | None:
    """The GPUs of this process for `jax.distributed.initialize`: [] for all, None for JAX's choice, which under Slurm
    and Open MPI is one for each process, even where a host has a single process."""
    return [] if settings.has_all_gpus() else None
