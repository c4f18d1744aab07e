"""Runs an iterative learner (`dagger.Dagger`, `finetune.Finetune`) in a run folder: log, policies, validation and exact
resumption."""

import contextlib
import dataclasses
import pathlib
import sys
import time
from collections.abc import Callable
from typing import Any

import jax
import numpy as np
from jax.experimental import multihost_utils

from ..datatypes import ValidationError
from ..datatypes import validation as v
from ..envs.navigation.places import ScenePlaces
from . import sequences, snapshot
from .policy import latest_policy, policy_path
from .progress import TrainingLog
from .run import TrainingResult

#: Files of the state of the training at the newest checkpoint and at the one before it.
STATE, STATE_BEFORE = "state.npz", "state-before.npz"
#: File about the best checkpoint so far by success rate on validation scenes.
VALIDATION = "validation.json"
_ENDS = ("success", "hit", "off_traversable", "timeout")

#: Function (parameters of the actor) -> success rate by set of validation scenes.
Validate = Callable[[Any], dict[str, float]]


@dataclasses.dataclass(frozen=True)
class Iterations:
    """The run of a learner in a folder.

    Attributes:
      learner: learner with `iterate`, `steps_per_iteration`, `actor` (function from a state to the parameters of the
        actor) and `placed` (function from a state of a file to one that `iterate` takes).
      begin: function that returns its state before the first iteration.
      save: function (parameters of the actor, env-steps of this learner) that writes a policy folder to checkpoints/
        and returns it.
      folder: log.jsonl, TensorBoard's events, state.npz, state-before.npz and validation.json go there.
      iterations: number of iterations of the whole training.
      num_checkpoints: number of checkpoints, evenly spaced.
      validate: validation; if given, only checkpoints that are at least as good as all before them are saved as
        policies.
      steps_before: env-steps of earlier stages, for the log.
      places: whose scenes are exchanged between iterations of a learner with `reset_gone`; None where scenes stay.
    """

    learner: Any
    begin: Callable[[], Any]
    save: Callable[[Any, int], pathlib.Path]
    folder: pathlib.Path
    iterations: int
    num_checkpoints: int
    validate: Validate | None = None
    steps_before: int = 0
    quiet: bool = False
    places: ScenePlaces | None = None

    def first_state(self, resume: bool) -> Any:
        """The initial state: a new one, or for a resumed run the newest undamaged one in the folder.

        Raises:
          ValidationError: there is nothing to resume, or the state belongs to another training.
        """
        if not resume:
            return self.begin()
        return self.learner.placed(_newest_state(self.folder, jax.eval_shape(self.begin)))

    def replace_missing_policy(self, state: Any) -> bool:
        """Writes the policy of a state from which a run continues if the policy is missing; returns whether it was, in
        all of several processes."""
        missing = jax.process_index() == 0 and self._misses_policy(state)
        if missing:
            done = int(state.steps)
            self.save(self.learner.actor(state), done * self.learner.steps_per_iteration)
        if jax.process_count() == 1:
            return missing
        return bool(multihost_utils.broadcast_one_to_all(np.array(missing)))

    def _misses_policy(self, state: Any) -> bool:
        done = int(state.steps)
        if done == 0 or (self.validate is not None and self._best()[1] != done):
            return False
        steps = self.steps_before + done * self.learner.steps_per_iteration
        folder = policy_path(self.folder / "checkpoints", steps)
        with contextlib.suppress(ValidationError):
            return latest_policy(folder) != folder
        return True

    def run(self, state: Any) -> TrainingResult:
        """Iterates from `state` to the end; returns the newest policy, or None if no checkpoint is as good as the
        initial parameters, and in all but the first of several processes."""
        each, done = self.learner.steps_per_iteration, int(state.steps)
        before = self.steps_before
        writes = jax.process_index() == 0
        total, start = before + self.iterations * each, before + done * each
        log = TrainingLog(self.folder, total, start, self.quiet) if writes else None
        begin = time.monotonic()
        last: list[pathlib.Path] = []
        every = max(self.iterations // max(self.num_checkpoints, 1), 1)
        if writes and self.validate is not None and done == 0:
            self._judge(0, state)

        def on_iteration(number: int, state: Any, reported: dict[str, float]) -> None:
            at_checkpoint = number % every == 0 or number == self.iterations
            good = True
            if writes and at_checkpoint and self.validate is not None:
                good, rates = self._judge(number, state)
                reported = {**reported, **{f"validation/{name}": x for name, x in rates.items()}}
            if log is not None:
                log((number - done) * each, _named(reported | self._of_places()))
            if at_checkpoint:
                if writes and (self.folder / STATE).is_file():
                    (self.folder / STATE).replace(self.folder / STATE_BEFORE)
                snapshot.save_state(self.folder / STATE, state)
                if writes and good:
                    last.append(self.save(self.learner.actor(state), number * each))

        try:
            sequences.run(self.learner, self.iterations, float("inf"), on_iteration, state, self._exchanged)
        finally:
            if log is not None:
                log.close()
        if writes and not last:
            with contextlib.suppress(ValidationError):
                last.append(latest_policy(self.folder / "checkpoints"))
        if jax.process_count() > 1:
            # What the first process writes is there when any of them goes on.
            multihost_utils.sync_global_devices("end of the iterations")
        steps = before + self.iterations * each
        rate = log.steps_per_second if log is not None else 0.0
        return TrainingResult(last[-1] if last else None, steps, time.monotonic() - begin, rate)

    def _exchanged(self, number: int, state: Any) -> Any:
        """The state with which an iteration begins, after the exchanges of scenes before it."""
        if self.places is None:
            return state
        return self.places.before((number - 1) * self.learner.steps_per_iteration, state, self.learner.reset_gone)

    def _of_places(self) -> dict[str, float]:
        return {} if self.places is None else self.places.reported()

    def _best(self) -> tuple[float, int]:
        """Success rate and iteration of the best checkpoint so far."""
        if not (self.folder / VALIDATION).is_file():
            return -1.0, 0
        body = v.mapping(v.read_json(self.folder / VALIDATION, "validation"), "validation", ["success", "iteration"])
        return v.number(body["success"], "validation.success"), v.integer(body["iteration"], "validation.iteration", 0)

    def _judge(self, number: int, state: Any) -> tuple[bool, dict[str, float]]:
        """Validates a state: whether its mean success rate is at least that of all before it, and the rate of each set.

        A resumed run may validate the same states again; `>=` accepts the best of them again.
        """
        assert self.validate is not None
        rates = self.validate(self.learner.actor(state))
        mean = sum(rates.values()) / len(rates)
        good = mean >= self._best()[0]
        if good:
            v.write_json(self.folder / VALIDATION, {"success": mean, "iteration": number})
        return good, rates


def begun(folder: pathlib.Path) -> bool:
    """Whether a run folder holds a state from which `Iterations` can go on."""
    return any((folder / name).is_file() for name in (STATE, STATE_BEFORE))


def _named(reported: dict[str, float]) -> dict[str, float]:
    """Metrics of a learner under the names of the log; undefined ones (without ended episodes) are left out."""
    ended = reported.get("ended")
    named = {f"episode/{k}": reported[k] for k in _ENDS} if ended else {}
    rest = {k: x for k, x in reported.items() if k not in (*_ENDS, "ended")}
    return {**named, **{k if "/" in k else f"training/{k}": x for k, x in rest.items()}}


def _newest_state(folder: pathlib.Path, like: Any) -> Any:
    """The newest undamaged state in a run folder.

    Raises:
      ValidationError: there is none, or it belongs to another training.
    """
    try:
        return snapshot.load_state(folder / STATE, like)
    except ValidationError as error:
        if not (folder / STATE_BEFORE).is_file():
            raise
        state = snapshot.load_state(folder / STATE_BEFORE, like)
        sys.stderr.write(f"{str(error).rstrip('.')}; going on from the state of the checkpoint before it\n")
        return state
