"""A training by imitation as a run folder: `dagger.Dagger` with logs, checkpoints and exact resumption."""

import contextlib
import pathlib
import sys
import time
from typing import Any

import jax
from ml_collections import ConfigDict

from ..datatypes import ValidationError
from ..envs import wrap_for_training
from . import sequences, snapshot
from .dagger import Dagger, DaggerState, Teacher
from .policy import PolicySpec, latest_policy, policy_path, save_student
from .progress import TrainingLog
from .record import begin_segment, check_scenes
from .run import TrainingResult

#: The whole state of the training at the newest checkpoint, beside the checkpoints, and at the checkpoint before it.
STATE, STATE_BEFORE = "state.npz", "state-before.npz"


def distil(
    environment: str,
    env: Any,
    config: ConfigDict,
    folder: pathlib.Path,
    teacher: Teacher,
    resume: bool = False,
    quiet: bool = False,
) -> TrainingResult:
    """Trains a student by DAgger and returns where its policy is.

    Args:
      environment: the name the env is registered under.
      env: not wrapped; its observations hold `student.SEEN` and `privileged_map`.
      config: see `dagger.default_dagger_config`, with `num_timesteps` and `num_checkpoints`.
      folder: run folder; checkpoints/<steps>/, state.npz, state-before.npz, log.jsonl and TensorBoard events go there.
      teacher: labels every visited state. resume: continue from the newest checkpoint there, bit-equal to an
        uninterrupted run if `num_timesteps` is unchanged. Where that checkpoint is damaged, from the one before it,
        with a line on standard error.

    Raises:
      ValidationError: a folder in use, no run to resume or one that is complete, or a resumed run with another
        configuration.
    """
    folder = folder.absolute()
    learner = Dagger(wrap_for_training(env, env.config.episode_length), teacher, config)
    each, total = learner.steps_per_iteration, int(config.num_timesteps)
    iterations = max(total // each, 1)
    state = _first_state(learner, env, folder, resume)
    done = int(state.steps)
    if resume:
        _replace_missing_policy(environment, env, config, folder, state.params, done * each)
    if done >= iterations:
        raise ValidationError(f"num_timesteps: found {total}, but {done * each} are done already; ask for more.")
    begin_segment(folder, environment, env.config, config, done * each).save(folder)
    log = TrainingLog(folder, iterations * each, done * each, quiet)
    begin = time.monotonic()
    last: list[pathlib.Path] = []
    every = max(iterations // max(int(config.num_checkpoints), 1), 1)

    def on_iteration(number: int, state: DaggerState, said: dict[str, float]) -> None:
        ended = said.pop("ended")
        # Shares of no episodes are undefined.
        shares = {f"episode/{k}": said.pop(k) for k in ("success", "hit", "off_traversable", "timeout")}
        log((number - done) * each, {**(shares if ended else {}), **{f"training/{k}": x for k, x in said.items()}})
        if number % every == 0 or number == iterations:
            if (folder / STATE).is_file():
                (folder / STATE).replace(folder / STATE_BEFORE)
            snapshot.save_state(folder / STATE, state)
            spec = PolicySpec.of(environment, env, config, number * each)
            last.append(save_student(folder / "checkpoints", state.params, spec))

    try:
        sequences.run(learner, iterations, float("inf"), on_iteration, state)
    finally:
        log.close()
    return TrainingResult(last[-1], iterations * each, time.monotonic() - begin, log.steps_per_second)


def _first_state(learner: Dagger, env: Any, folder: pathlib.Path, resume: bool) -> DaggerState:
    if resume:
        check_scenes(PolicySpec.load(latest_policy(folder / "checkpoints")), env)
        return _newest_state(folder, jax.eval_shape(learner.begin))
    checkpoints = folder / "checkpoints"
    if checkpoints.exists() and any(checkpoints.iterdir()):
        raise ValidationError(f"run folder: found checkpoints in {folder}, needed a new folder; or pass --resume.")
    folder.mkdir(parents=True, exist_ok=True)
    return learner.begin()


def _newest_state(folder: pathlib.Path, like: DaggerState) -> DaggerState:
    """The newest state in a run folder that is whole.

    Raises:
      ValidationError: there is none, or it is one of another training.
    """
    try:
        return snapshot.load_state(folder / STATE, like)
    except ValidationError as error:
        if not (folder / STATE_BEFORE).is_file():
            raise
        state = snapshot.load_state(folder / STATE_BEFORE, like)
        sys.stderr.write(f"{str(error).rstrip('.')}; going on from the state of the checkpoint before it\n")
        return state


def _replace_missing_policy(
    environment: str, env: Any, config: ConfigDict, folder: pathlib.Path, params: Any, steps: int
) -> None:
    """Writes the policy of the state from which a run continues, if a kill or damage removed it."""
    checkpoints = folder / "checkpoints"
    path = policy_path(checkpoints, steps)
    with contextlib.suppress(ValidationError):
        if latest_policy(path) == path:
            return
    save_student(checkpoints, params, PolicySpec.of(environment, env, config, steps))
