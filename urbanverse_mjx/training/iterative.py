"""A learner that iterates (`dagger.Dagger`, `finetune.Finetune`) as a run folder: log, policies, validation and exact
resumption."""

import contextlib
import dataclasses
import pathlib
import sys
import time
from collections.abc import Callable
from typing import Any

import jax

from ..datatypes import ValidationError
from ..datatypes import validation as v
from . import sequences, snapshot
from .policy import latest_policy, policy_path
from .progress import TrainingLog
from .run import TrainingResult

#: The whole state of the training at the newest checkpoint, and at the checkpoint before it.
STATE, STATE_BEFORE = "state.npz", "state-before.npz"
#: The best checkpoint so far by success rate on validation scenes.
VALIDATION = "validation.json"
_ENDS = ("success", "hit", "off_traversable", "timeout")

#: (parameters of the actor) -> success rate by set of validation scenes.
Validate = Callable[[Any], dict[str, float]]


@dataclasses.dataclass(frozen=True)
class Iterations:
    """How a learner becomes a run folder.

    Attributes:
      learner: has `iterate` and `steps_per_iteration`.
      begin: its state before the first iteration.
      actor_of: the parameters of the actor in a state.
      save: (parameters of the actor, env-steps of this learner) -> the policy folder that it wrote, named by its steps
        in checkpoints/.
      folder: log.jsonl, TensorBoard's events, state.npz, state-before.npz and validation.json go there.
      iterations: of the whole training.
      num_checkpoints: evenly over it.
      validate: where given, only checkpoints that are at least as good as all before them become policies.
      steps_before: env-steps of the stages before this one, for the log.
    """

    learner: Any
    begin: Callable[[], Any]
    actor_of: Callable[[Any], Any]
    save: Callable[[Any, int], pathlib.Path]
    folder: pathlib.Path
    iterations: int
    num_checkpoints: int
    validate: Validate | None = None
    steps_before: int = 0
    quiet: bool = False

    def first_state(self, resume: bool) -> Any:
        """The state to begin with: a new one, or where a run is resumed the newest one in the folder that is whole.

        Raises:
          ValidationError: nothing to resume, or a state of another training.
        """
        return _newest_state(self.folder, jax.eval_shape(self.begin)) if resume else self.begin()

    def replace_missing_policy(self, state: Any) -> None:
        """Writes the policy of a state from which a run continues, if a kill or damage removed it."""
        done = int(state.steps)
        if self.validate is not None and self._best()[1] != done:
            return
        steps = done * self.learner.steps_per_iteration
        folder = policy_path(self.folder / "checkpoints", self.steps_before + steps)
        with contextlib.suppress(ValidationError):
            if latest_policy(folder) == folder:
                return
        if done:
            self.save(self.actor_of(state), steps)

    def run(self, state: Any) -> TrainingResult:
        """Iterates from `state` to the end; returns the newest policy, which is None where no checkpoint was as good as
        the initial parameters."""
        each, done = self.learner.steps_per_iteration, int(state.steps)
        before = self.steps_before
        log = TrainingLog(self.folder, before + self.iterations * each, before + done * each, self.quiet)
        begin = time.monotonic()
        last: list[pathlib.Path] = []
        every = max(self.iterations // max(self.num_checkpoints, 1), 1)
        if self.validate is not None and done == 0:
            self._judge(0, state)

        def on_iteration(number: int, state: Any, reported: dict[str, float]) -> None:
            at_checkpoint = number % every == 0 or number == self.iterations
            good = True
            if at_checkpoint and self.validate is not None:
                good, rates = self._judge(number, state)
                reported = {**reported, **{f"validation/{name}": x for name, x in rates.items()}}
            log((number - done) * each, _named(reported))
            if at_checkpoint:
                if (self.folder / STATE).is_file():
                    (self.folder / STATE).replace(self.folder / STATE_BEFORE)
                snapshot.save_state(self.folder / STATE, state)
                if good:
                    last.append(self.save(self.actor_of(state), number * each))

        try:
            sequences.run(self.learner, self.iterations, float("inf"), on_iteration, state)
        finally:
            log.close()
        if not last:
            with contextlib.suppress(ValidationError):
                last.append(latest_policy(self.folder / "checkpoints"))
        steps = before + self.iterations * each
        return TrainingResult(last[-1] if last else None, steps, time.monotonic() - begin, log.steps_per_second)

    def _best(self) -> tuple[float, int]:
        """Success rate and iteration of the best checkpoint so far."""
        if not (self.folder / VALIDATION).is_file():
            return -1.0, 0
        body = v.mapping(v.read_json(self.folder / VALIDATION, "validation"), "validation", ["success", "iteration"])
        return v.number(body["success"], "validation.success"), v.integer(body["iteration"], "validation.iteration", 0)

    def _judge(self, number: int, state: Any) -> tuple[bool, dict[str, float]]:
        """Whether a state is at least as good as all before it, by the mean over the sets, and the rate of each set.

        A run that was killed and has gone back judges the same states again; `>=` accepts the best of them once more.
        """
        assert self.validate is not None
        rates = self.validate(self.actor_of(state))
        mean = sum(rates.values()) / len(rates)
        good = mean >= self._best()[0]
        if good:
            v.write_json(self.folder / VALIDATION, {"success": mean, "iteration": number})
        return good, rates


def _named(reported: dict[str, float]) -> dict[str, float]:
    """What a learner reports under the names of the log; shares of no episodes are undefined and left out."""
    ended = reported.get("ended")
    named = {f"episode/{k}": reported[k] for k in _ENDS} if ended else {}
    rest = {k: x for k, x in reported.items() if k not in (*_ENDS, "ended")}
    return {**named, **{k if "/" in k else f"training/{k}": x for k, x in rest.items()}}


def _newest_state(folder: pathlib.Path, like: Any) -> Any:
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
