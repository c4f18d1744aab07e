"""A learner as a run folder: which of its checkpoints become policies, and what a resumed run begins with."""

import json
import pathlib
from collections.abc import Sequence
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import pytest

from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.training.iterative import STATE, STATE_BEFORE, VALIDATION, Iterations


class Counted(NamedTuple):
    """Attributes: steps: iterations done. params: the same number, as parameters."""

    steps: jax.Array
    params: jax.Array


class Counter:
    """A learner that counts its iterations."""

    steps_per_iteration = 10

    def placed(self, state: Counted) -> Counted:
        return state

    def actor(self, state: Counted) -> jax.Array:
        return state.params

    def iterate(self, state: Counted, progress: jax.Array) -> tuple[Counted, dict[str, jax.Array]]:
        del progress
        ends = dict.fromkeys(("success", "hit", "off_traversable", "timeout"), jnp.float32(0.25))
        return Counted(state.steps + 1, state.params + 1.0), {
            **ends,
            "ended": 4.0 * (state.steps % 2),
            "loss": jnp.ones(()),
        }


def counting(folder: pathlib.Path, rates: Sequence[float] | None, saved: list[int]) -> Iterations:
    """Rates: on validation after so many iterations."""

    def save(params: Any, steps: int) -> pathlib.Path:
        assert int(params) * 10 == steps
        saved.append(steps)
        return folder / str(steps)

    folder.mkdir(exist_ok=True)
    return Iterations(
        learner=Counter(),
        begin=lambda: Counted(jnp.int32(0), jnp.float32(0.0)),
        save=save,
        folder=folder,
        iterations=6,
        num_checkpoints=3,
        validate=None
        if rates is None
        else lambda params: {"a": rates[int(params)] - 0.1, "b": rates[int(params)] + 0.1},
        steps_before=1000,
        quiet=True,
    )


def test_without_validation_every_checkpoint_is_a_policy(tmp_path: pathlib.Path) -> None:
    saved: list[int] = []
    run = counting(tmp_path, None, saved)
    result = run.run(run.first_state(False))
    assert saved == [20, 40, 60]
    assert (result.policy, result.steps) == (tmp_path / "60", 1060)
    rows = [json.loads(line) for line in (tmp_path / "log.jsonl").read_text().splitlines()]
    assert [row["step"] for row in rows] == [1010, 1020, 1030, 1040, 1050, 1060]
    assert ["episode/success" in row for row in rows] == [False, True] * 3, "shares of no episodes are left out"
    assert all(row["training/loss"] == 1.0 for row in rows)


@pytest.mark.parametrize(
    ("rates", "policies", "best"),
    [
        ((0.2, 0, 0.6, 0, 0.5, 0, 0.4), [20], 2),
        ((0.2, 0, 0.3, 0, 0.3, 0, 0.4), [20, 40, 60], 6),
        ((0.9, 0, 0.3, 0, 0.5, 0, 0.4), [], 0),
    ],
)
def test_only_a_checkpoint_as_good_as_all_before_it_becomes_a_policy(
    tmp_path: pathlib.Path, rates: Sequence[float], policies: list[int], best: int
) -> None:
    """The begin counts too; where nothing was as good there is no policy."""
    saved: list[int] = []
    run = counting(tmp_path, rates, saved)
    result = run.run(run.first_state(False))
    assert saved == policies
    assert result.policy == (tmp_path / str(policies[-1]) if policies else None)
    body = json.loads((tmp_path / VALIDATION).read_text())
    assert (body["iteration"], body["success"]) == (best, pytest.approx(rates[best]))


def test_a_resumed_run_keeps_the_best_of_before_it(tmp_path: pathlib.Path) -> None:
    """Killed after the state of iteration 4: what was best stays best, and a policy that is missing is written."""
    rates = (0.2, 0, 0.3, 0, 0.8, 0, 0.4)
    saved: list[int] = []
    run = counting(tmp_path, rates, saved)
    run.run(run.first_state(False))
    assert saved == [20, 40]
    last = counting(tmp_path, rates, saved)
    assert not last.replace_missing_policy(last.first_state(True))
    assert saved == [20, 40], "the last state was not the best: it has no policy that could be missing"
    (tmp_path / STATE_BEFORE).replace(tmp_path / STATE)
    again = counting(tmp_path, rates, saved)
    state = again.first_state(True)
    assert (int(state.steps), float(state.params)) == (4, 4.0)
    saved.clear()
    assert again.replace_missing_policy(state)
    assert saved == [40]
    again.run(state)
    assert saved == [40], "0.4 is worse than 0.8"
    (tmp_path / STATE).unlink()
    (tmp_path / STATE_BEFORE).unlink(missing_ok=True)
    with pytest.raises(ValidationError, match="found no file"):
        again.first_state(True)
