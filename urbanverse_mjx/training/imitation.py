"""Learners of a student in a run folder: `Dagger`, `Cloning` or `Finetune` with logs, policies and exact resumption."""

import pathlib
from collections.abc import Callable
from typing import Any

import jax
from ml_collections import ConfigDict

from ..datatypes import PlacedBank, ValidationError
from ..envs import wrap_for_training
from .dagger import Dagger
from .iterative import Iterations, Validate
from .policy import PolicySpec, latest_policy, save_student
from .policy_files import FILE
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
    learner: Any,
    resume: bool = False,
    quiet: bool = False,
    begin: Callable[[], Any] | None = None,
    validate: Validate | None = None,
    start_from: pathlib.Path | None = None,
) -> TrainingResult:
    """Iterates a learner whose states hold the parameters of a policy; other arguments and errors as of `distil`.

    Args:
      learner: `Dagger`, `Cloning`, `finetune.Finetune` or `shared_ppo.SharedPPO`. One whose policy is no
        student has a method `write` with the arguments of `save_student`.
      begin: function that returns its state before the first iteration; default: its own, from random parameters.
      validate: see `iterative.Iterations`.
      start_from: policy with the initial parameters, for the record.

    Where the scenes of `env` come and go, `env.places` exchanges them between iterations.
    """
    places = getattr(env, "places", None)
    if places is None and isinstance(env.bank, PlacedBank):
        raise ValidationError(
            "training: found an environment whose scenes come and go without anything that exchanges them, needed "
            "`ScenePlaces` as a context around the training."
        )
    folder = folder.absolute()
    each, total = learner.steps_per_iteration, int(config.num_timesteps)

    def save(actor: Any, steps: int) -> pathlib.Path:
        write = getattr(learner, "write", save_student)
        return write(folder / "checkpoints", actor, PolicySpec.of(environment, env, config, steps))

    iterations = max(total // each, 1)
    run = Iterations(
        learner=learner,
        begin=begin or learner.begin,
        save=save,
        folder=folder,
        iterations=iterations,
        num_checkpoints=int(config.num_checkpoints),
        validate=validate,
        quiet=quiet,
        places=places,
    )
    if resume:
        # A run that was killed at its first checkpoint has a state, and no policy yet.
        if any(folder.glob(f"checkpoints/*/{FILE}")):
            check_scenes(PolicySpec.load(latest_policy(folder / "checkpoints")), env)
    else:
        check_new(folder)
        if jax.process_index() == 0:
            folder.mkdir(parents=True, exist_ok=True)
    if places is not None and not resume:
        places.begin(0, each)
    state = run.first_state(resume)
    done = int(state.steps)
    if places is not None and resume:
        places.begin(done * each, each)
    if resume and run.replace_missing_policy(state) and done == iterations:
        return run.run(state)  # only the last policy was missing
    if done >= iterations:
        raise ValidationError(f"num_timesteps: found {total}, but {done * each} are done already; ask for more.")
    record = begin_segment(folder, environment, env.config, config, done * each, start_from)
    if jax.process_index() == 0:
        record.save(folder)
    return run.run(state)
