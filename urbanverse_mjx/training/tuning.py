"""PPO of a trained student on the streets of a bank, without a teacher: the preset `tune`.

For a policy that is to drive in one place: the bank holds digital cousins of that place (`urbanverse gen`), and
`finetune.Finetune` continues on them from the policy's parameters.
"""

import dataclasses
import pathlib
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from ml_collections import ConfigDict

from ..datatypes import ValidationError
from ..envs import wrap_for_training
from .finetune import Finetune
from .imitation import fit
from .iterative import Validate
from .policy import latest_policy, load_compatible_student
from .record import RunRecord
from .run import TrainingResult
from .student import Student

#: Weights of the teacher's labels in the loss.
_WEIGHTS = ("imitation", "final_imitation")


def tune(
    environment: str,
    env: Any,
    config: ConfigDict,
    folder: pathlib.Path,
    start_from: pathlib.Path | None,
    resume: bool = False,
    quiet: bool = False,
    validator: Callable[[Student], Validate] | None = None,
) -> TrainingResult:
    """Continues the training of a student by PPO and returns the folder of its policy.

    Args:
      environment: name under which the env is registered.
      env: environment without wrappers, whose observations include `student.SEEN`, `privileged` and `privileged_map`.
      config: `algorithm`, `num_envs`, `seed`, `num_timesteps`, `num_checkpoints` and `network` of the student (see
        `dagger.default_dagger_config`), and `finetune` (`finetune.default_finetune_config`) without `num_envs` and
        `seed`.
      folder: run folder, as of `imitation.distil`.
      start_from: policy or run folder with the initial parameters; a resumed run takes that of its record.
      resume: whether to continue bit-equal from the newest checkpoint.
      validator: function from the student's network to a validation function of its parameters. With it the best
        policy on the validation scenes is the result, be it the initial one; without it the last one.

    Raises:
      ValidationError: no initial policy is given or its network has other shapes, the labels of a teacher have a
        weight, or as in `imitation.distil`.
    """
    finetune = ConfigDict(config.finetune.to_dict())
    for name in _WEIGHTS:
        if finetune[name]:
            raise ValidationError(
                f"ppo.finetune.{name}: found {finetune[name]}, needed 0.0: this preset has no teacher whose actions "
                "could be imitated; take the preset 'best'."
            )
    if resume:
        said = RunRecord.load(folder).segments[-1].get("start_from")
        start_from = None if said is None else pathlib.Path(said)
    if start_from is None:
        raise ValidationError(
            "preset 'tune': found no --start-from, needed the policy that goes on; to train a new one take another "
            "preset."
        )
    # A resumed run has the parameters in its state.
    start = None if resume else load_compatible_student(start_from, env, config)
    finetune.num_envs, finetune.seed = int(config.num_envs), int(config.seed)
    wrapped = wrap_for_training(env, env.config.episode_length)
    learner = Finetune(wrapped, no_labels(env.action_size), config, finetune)
    result = fit(
        environment,
        env,
        config,
        folder,
        learner,
        resume,
        quiet,
        begin=lambda: learner.begin(start),
        validate=None if validator is None else validator(learner.student),
        start_from=start_from,
    )
    if jax.process_index() > 0:
        return result
    return dataclasses.replace(result, policy=result.policy or latest_policy(start_from))


def no_labels(action_size: int) -> Callable[[Any, Any, jax.Array], jax.Array]:
    """A `student_learner.Teacher` in place of one, for labels without weight in the loss; actions are zeros (n,
    action_size)."""
    return lambda _, state, __: jnp.zeros((*state.obs["goal"].shape[:-1], action_size))
