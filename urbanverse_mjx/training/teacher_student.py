"""Trains a policy with a camera in three stages: a privileged teacher by PPO, its imitation, and PPO fine-tuning.

The teacher uses the route and exact distances instead of images, so its training takes minutes. The student imitates it
by DAgger (`dagger`) and is then fine-tuned by PPO with a privileged critic (`finetune`).

Folder of a run: teacher/ (a run folder of Brax PPO), imitation/ and the run's own checkpoints/ (run folders of
`iterative`); each stage's complete.json names its policy. The number of a checkpoint counts the env-steps of all
stages, so the newest policy under the folder is the run's result.
"""

import contextlib
import dataclasses
import pathlib
import shutil
from collections.abc import Callable
from typing import Any

import jax
from ml_collections import ConfigDict

from ..datatypes import ValidationError
from ..datatypes import validation as v
from ..envs import wrap_for_training
from . import iterative, run
from .dagger import Dagger
from .devices import Devices
from .finetune import Finetune
from .iterative import Iterations, Validate
from .policy import (
    PolicySpec,
    latest_policy,
    load_compatible_student,
    load_student,
    network_factory,
    save_student,
)
from .record import RunRecord, begin_segment, check_scenes
from .run import TrainingResult
from .run_folder import check_new
from .student import Student

TEACHER, IMITATION, COMPLETE = "teacher", "imitation", "complete.json"
STAGES = ("teacher", "imitation", "finetune")


@dataclasses.dataclass(frozen=True)
class TeacherStudent:
    """A training in three stages.

    Attributes:
      environment: name under which the envs are registered.
      env: environment without wrappers, whose observations include `student.SEEN`, `privileged` and `privileged_map`.
      make_teacher_env: function that makes the same environment without a camera, for the first stage.
      config: of the student (`dagger.default_dagger_config`), with `num_timesteps` of all stages together, `shares` of
        the stages in them, `num_checkpoints` of each, `teacher` (PPO as in `config.default_ppo_config`) and
        `finetune` (`finetune.default_finetune_config`), both without `num_envs` and `seed`, which are the student's.
      validator: function from the student's network to a validation function of its parameters; None without validation
        scenes.
      start_from: student policy with the initial parameters of the imitation, e.g. of another robot.
    """

    environment: str
    env: Any
    make_teacher_env: Callable[[], Any]
    config: ConfigDict
    folder: pathlib.Path
    validator: Callable[[Student], Validate] | None = None
    start_from: pathlib.Path | None = None
    quiet: bool = False

    def train(self, resume: bool, say: Callable[[str], None] = lambda _: None) -> TrainingResult:
        """Trains the stages that are not complete; the result is the best student on the validation scenes, or the last
        one.

        Args:
          resume: whether to continue the run in `folder`. The student's stages continue bit-equal from their newest
            checkpoint; an incomplete teacher is trained again.

        Raises:
          ValidationError: the folder is in use, the run is complete, the scenes differ from the run's, the initial
            policy has other layers, or the envs do not divide into the minibatches of a stage on the devices.
        """
        self._check_devices()
        if resume and _complete(self.folder) is not None:
            raise ValidationError(f"--resume: found a complete run in {self.folder}, needed one that was cut off.")
        if not resume:
            check_new(self.folder)
        start_from = self._start_from(resume)
        imitated = (self.folder / IMITATION / COMPLETE).is_file()
        start = None if imitated else self._start(start_from)
        self._begin_segment(start_from)
        if not (self.folder / TEACHER / COMPLETE).is_file():
            self._train_teacher(say)
        teacher = self._teacher()
        check_scenes(PolicySpec.load(teacher), self.env)
        if not imitated:
            say("stage 2 of 3: the student imitates the teacher")
            self._imitate(teacher, start)
        say("stage 3 of 3: the student continues by PPO")
        return self._finetune(teacher, self.folder / IMITATION / str(_complete(self.folder / IMITATION)))

    def train_teacher(self, say: Callable[[str], None] = lambda _: None) -> pathlib.Path:
        """Trains the first stage of a new run alone, after which `train(resume=True)` continues; returns its policy.

        Raises:
          ValidationError: as for `train`.
        """
        self._check_devices()
        check_new(self.folder)
        self._begin_segment(self.start_from)
        self._train_teacher(say)
        return self._teacher()

    def _begin_segment(self, start_from: pathlib.Path | None) -> None:
        """Adds a segment to the record, which a new run has not got yet."""
        self.folder.mkdir(parents=True, exist_ok=True)
        done = _steps_done(self.folder)
        begin_segment(self.folder, self.environment, self.env.config, self.config, done, start_from).save(self.folder)

    def _teacher(self) -> pathlib.Path:
        """The policy of the complete first stage."""
        return self.folder / TEACHER / str(_complete(self.folder / TEACHER))

    def _check_devices(self) -> None:
        """Checks what the stages ask of the devices, before the first of them takes its time."""
        config, devices = self.config, Devices.every()
        parts = {"ppo.teacher": config.teacher, "ppo": config, "ppo.finetune": config.finetune}
        minibatches = {f"{section}.minibatches": int(part.minibatches) for section, part in parts.items()}
        if (self.folder / TEACHER / COMPLETE).is_file():
            del minibatches["ppo.teacher.minibatches"]
        devices.check_shares(int(config.num_envs), minibatches)
        devices.check_draws(wrap_for_training(self.env, self.env.config.episode_length).learns_episodes)

    def steps(self, stage: str) -> int:
        """Planned env-steps of a stage."""
        shares = self.config.shares
        return int(self.config.num_timesteps * shares[stage] / sum(shares[name] for name in STAGES))

    def _iterations(self, stage: str, each: int) -> int:
        """Number of iterations of a stage; each: env-steps per iteration."""
        return max(self.steps(stage) // each, 1)

    def _start_from(self, resume: bool) -> pathlib.Path | None:
        """The initial policy; that of the record for a resumed run."""
        if not resume:
            return self.start_from
        said = RunRecord.load(self.folder).segments[-1].get("start_from")
        return None if said is None else pathlib.Path(said)

    def _start(self, start_from: pathlib.Path | None) -> Any:
        """The initial parameters of the imitation, or None for random ones."""
        if start_from is None:
            return None
        return load_compatible_student(start_from, self.env, self.config)

    def _train_teacher(self, say: Callable[[str], None]) -> None:
        """Trains the teacher by PPO from random weights; removes files of an earlier attempt."""
        say("stage 1 of 3: the teacher, which sees no images")
        folder = self.folder / TEACHER
        if folder.exists():
            shutil.rmtree(folder)
        result = run.train(
            self.environment, self.make_teacher_env(), self.teacher_config(), folder, False, self.quiet
        )  # fmt: skip
        assert result.policy is not None
        _write_complete(folder, result.policy)

    def teacher_config(self) -> ConfigDict:
        """The complete PPO config of the teacher."""
        config = ConfigDict(self.config.teacher.to_dict())
        config.num_envs, config.seed = int(self.config.num_envs), int(self.config.seed)
        config.num_timesteps, config.num_checkpoints = self.steps("teacher"), int(self.config.num_checkpoints)
        config.minibatch = config.num_envs * config.unroll_length // int(config.minibatches)
        del config.minibatches
        return config.lock()

    def _teach(self) -> Callable[[Any, Any, jax.Array], jax.Array]:
        """Function (parameters of the teacher's actor, state of the envs, key) -> actions."""
        from brax.training.agents.ppo import networks as ppo_networks

        sizes = {name: tuple(shape) for name, shape in self.env.observation_size.items()}
        networks = network_factory(self.teacher_config())(sizes, self.env.action_size)
        make = ppo_networks.make_inference_fn(networks)
        return lambda params, state, key: make((None, params, None), deterministic=True)(state.obs, key)[0]

    def imitation(self, teacher: Any) -> Dagger:
        """The learner of the second stage; teacher: parameters of the teacher's actor."""
        wrapped = wrap_for_training(self.env, self.env.config.episode_length)
        return Dagger(wrapped, self._teach(), self.config, teacher)

    def finetuning(self, teacher: Any) -> Finetune:
        """The learner of the third stage; teacher: parameters of the teacher's actor."""
        config = ConfigDict(self.config.finetune.to_dict())
        config.num_envs, config.seed = int(self.config.num_envs), int(self.config.seed) + 1
        wrapped = wrap_for_training(self.env, self.env.config.episode_length)
        return Finetune(wrapped, self._teach(), self.config, config, teacher)

    def _imitate(self, teacher: pathlib.Path, start: Any) -> None:
        folder = self.folder / IMITATION
        folder.mkdir(exist_ok=True)
        learner = self.imitation(load_student(teacher))
        before = PolicySpec.load(teacher).steps
        stage = self._stage(learner, lambda: learner.begin(start), folder, "imitation", before)
        result = _continue(stage)
        _write_complete(folder, result.policy or latest_policy(folder))

    def _finetune(self, teacher: pathlib.Path, student: pathlib.Path) -> TrainingResult:
        learner = self.finetuning(load_student(teacher))
        # Counts from the end of the imitation, not from its best checkpoint, so that step numbers are unique.
        each = int(self.config.num_envs) * int(self.config.unroll_length)
        before = PolicySpec.load(teacher).steps + each * self._iterations("imitation", each)
        actor = load_student(student)
        stage = self._stage(learner, lambda: learner.begin(actor), self.folder, "finetune", before)
        result = _continue(stage)
        policy = result.policy or student
        _write_complete(self.folder, policy)
        return dataclasses.replace(result, policy=policy)

    def _stage(
        self,
        learner: Any,
        begin: Callable[[], Any],
        folder: pathlib.Path,
        name: str,
        before: int,
    ) -> Iterations:
        def save(actor: Any, steps: int) -> pathlib.Path:
            spec = PolicySpec.of(self.environment, self.env, self.config, before + steps)
            return save_student(folder / "checkpoints", actor, spec)

        validate = None if self.validator is None else self.validator(learner.student)
        iterations = self._iterations(name, learner.steps_per_iteration)
        return Iterations(
            learner=learner,
            begin=begin,
            save=save,
            folder=folder,
            iterations=iterations,
            num_checkpoints=int(self.config.num_checkpoints),
            validate=validate,
            steps_before=before,
            quiet=self.quiet,
        )


def _steps_done(folder: pathlib.Path) -> int:
    """Env-steps of the newest policy of any stage."""
    with contextlib.suppress(ValidationError):
        return PolicySpec.load(latest_policy(folder)).steps
    return 0


def _continue(stage: Iterations) -> TrainingResult:
    """Runs a stage to its end, from its newest state if there is one."""
    begun = iterative.begun(stage.folder)
    state = stage.first_state(begun)
    if begun:
        stage.replace_missing_policy(state)
    return stage.run(state)


def _write_complete(folder: pathlib.Path, policy: pathlib.Path) -> None:
    v.write_json(folder / COMPLETE, {"policy": str(policy.relative_to(folder))})


def _complete(folder: pathlib.Path) -> str | None:
    """The policy of a complete stage, relative to its folder."""
    if not (folder / COMPLETE).is_file():
        return None
    body = v.mapping(v.read_json(folder / COMPLETE, COMPLETE), COMPLETE, ["policy"])
    return v.text(body["policy"], f"{COMPLETE}: policy")
