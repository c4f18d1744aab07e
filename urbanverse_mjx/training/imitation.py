"""Imitation learning in a run folder: `Dagger` or `Cloning` with logs, policies and exact resumption."""

import pathlib
from typing import Any

from ml_collections import ConfigDict

from ..datatypes import ValidationError
from ..envs import wrap_for_training
from .cloning import Cloning
from .dagger import Dagger
from .iterative import Iterations
from .policy import PolicySpec, latest_policy, save_student
from .record import begin_segment, check_scenes
from .run import TrainingResult
from .run_folder import check_new
from .student_learner import Teacher


def distil(
    environment: str,
    env: Any,
    config: ConfigDict,
    folder: pathlib.Path,
    teacher: Teacher,
    resume: bool = False,
    quiet: bool = False,
) -> TrainingResult:
    """Trains a student by DAgger and returns the folder of its policy.

    Args:
      environment: the name the env is registered under.
      env: environment without wrappers, whose observations include `student.SEEN` and `privileged_map`.
      config: see `dagger.default_dagger_config`, with `num_timesteps` and `num_checkpoints`.
      folder: run folder; checkpoints/<steps>/, state.npz, state-before.npz, log.jsonl and TensorBoard events go there.
      teacher: teacher that labels every visited state.
      resume: whether to continue from the newest checkpoint, bit-equal to an uninterrupted run if `num_timesteps` is
        unchanged. If that checkpoint is damaged, the one before it is used, with a line on standard error.

    Raises:
      ValidationError: the folder is in use, there is no run to resume or it is complete, or a resumed run has another
        configuration.
    """
    learner = Dagger(wrap_for_training(env, env.config.episode_length), teacher, config)
    return fit(environment, env, config, folder, learner, resume, quiet)


def fit(
    environment: str,
    env: Any,
    config: ConfigDict,
    folder: pathlib.Path,
    learner: Dagger | Cloning,
    resume: bool = False,
    quiet: bool = False,
) -> TrainingResult:
    """Iterates a learner whose states hold the parameters of a student; arguments and errors as of `distil`."""
    folder = folder.absolute()
    each, total = learner.steps_per_iteration, int(config.num_timesteps)

    def save(actor: Any, steps: int) -> pathlib.Path:
        return save_student(folder / "checkpoints", actor, PolicySpec.of(environment, env, config, steps))

    iterations = max(total // each, 1)
    run = Iterations(
        learner=learner,
        begin=learner.begin,
        actor_of=lambda state: state.params,
        save=save,
        folder=folder,
        iterations=iterations,
        num_checkpoints=int(config.num_checkpoints),
        quiet=quiet,
    )
    if resume:
        check_scenes(PolicySpec.load(latest_policy(folder / "checkpoints")), env)
    else:
        check_new(folder)
        folder.mkdir(parents=True, exist_ok=True)
    state = run.first_state(resume)
    done = int(state.steps)
    if resume:
        run.replace_missing_policy(state)
    if done >= iterations:
        raise ValidationError(f"num_timesteps: found {total}, but {done * each} are done already; ask for more.")
    begin_segment(folder, environment, env.config, config, done * each).save(folder)
    return run.run(state)
