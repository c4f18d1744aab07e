"""Training: Brax PPO, unmodified, over a `NavEnv`, with logs, checkpoints and resumption."""

import dataclasses
import pathlib
import time
from typing import Any

import jax
from ml_collections import ConfigDict

from ..datatypes import ValidationError
from ..datatypes import validation as v
from ..envs import wrap_for_training
from .brax_compat import load_ppo
from .config import brax_arguments
from .policy import PolicySpec, latest_policy, load_compatible, load_params, network_factory, save_policy
from .progress import TrainingLog
from .record import begin_segment, check_scenes
from .run_folder import check_new


@dataclasses.dataclass(frozen=True)
class TrainingResult:
    """The result of a training.

    Attributes:
      policy: folder of the last policy; None in all processes of a training over several hosts but the first.
      steps: env-steps in all segments.
      seconds: wall time of this segment, compilation included.
      steps_per_second: median over the run's logging intervals, compilation left out.
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


def _ppo_arguments(config: ConfigDict) -> dict[str, Any]:
    """Our hyper-parameters under the names of `ppo.train`."""
    same = brax_arguments(config)
    return {
        **same,
        "normalize_observations": False,
        "num_evals": config.num_checkpoints + 1,
        # Brax builds an evaluator even when it never runs it; the same size shares the render context.
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
    """Trains a policy and returns where it is.

    Args:
      environment: the name the env is registered under.
      env: not wrapped.
      ppo_config: see `config.default_ppo_config`.
      folder: run folder; checkpoints/<steps>/, log.jsonl and TensorBoard events go there.
      resume: continue from the newest checkpoint there. Brax restores the networks, but neither Adam's moments nor the
        running episodes: those start anew, with another seed, and the step counter continues. `environment`, the env's
        config and scenes and `ppo_config` must be the run's own but for `record.MAY_CHANGE`.
      start_from: a policy with the initial networks, e.g. one of another robot; with a new critic if it has none. Not
        with `resume`.

    Raises:
      ValidationError: sizes that do not divide, a folder in use, no run to resume, a resumed run with another
        configuration, networks of other shapes to start from.
    """
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
    if ppo_config.num_envs % jax.device_count():
        raise ValidationError(
            f"ppo.num_envs: found {ppo_config.num_envs}, needed a multiple of the {jax.device_count()} devices."
        )
    record = begin_segment(folder, environment, env.config, ppo_config, start, start_from)
    last: list[pathlib.Path] = []

    def keep(step: int, _: Any, params: Any) -> None:
        if step > 0:
            spec = PolicySpec.of(environment, env, ppo_config, start + step)
            last.append(save_policy(folder / "checkpoints", params, spec))

    if writes:
        folder.mkdir(parents=True, exist_ok=True)
        record.save(folder)
    log = TrainingLog(folder, total, start, quiet) if writes else None
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
            progress_fn=log or _say_nothing,
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


def _say_nothing(_: int, __: Any) -> None:
    pass


def join_processes(coordinator: str, num_processes: int | None, process_id: int | None) -> None:
    """Makes this process one of several that train together, each on the devices of its own host.

    To be called before anything asks JAX for a device. All processes then call `train` with the same arguments;
    `num_envs` counts the envs of all of them. Only the first writes.

    Args:
      coordinator: "host:port" of the first process; "auto" where JAX detects the cluster (Slurm, Open MPI, Kubernetes).
      num_processes, process_id: their number, and that of this one; needed unless "auto".

    Raises:
      ValidationError: a coordinator without numbers, or a number outside its range.
    """
    if coordinator == "auto":
        jax.distributed.initialize()
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
    # Processes on CPUs (tests, clusters without accelerators) need a library for their sums.
    jax.config.update("jax_cpu_collectives_implementation", "gloo")
    jax.distributed.initialize(coordinator, num_processes, process_id)
