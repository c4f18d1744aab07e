"""Training of the perception model: the clock's schedule, and going on where a run was stopped."""

import argparse
import pathlib

import jax
import numpy as np
import pytest

from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.distillation import train_perception
from urbanverse_mjx.distillation.train_perception import Learner, Progress


def _learner(width: int = 4) -> Learner:
    rng = np.random.default_rng(0)
    variables = {"params": {"a": {"kernel": rng.normal(size=(3, 3, 2, width)).astype(np.float32)}}}
    twice = jax.tree.map(lambda x: 2 * x, variables)
    return Learner(variables, twice, {"mu": twice["params"], "count": np.array(7, np.int32)})


def test_a_stopped_run_goes_on_with_all_that_it_knew(tmp_path: pathlib.Path):
    options = argparse.Namespace(out=tmp_path / "w.npz", state=tmp_path / "s.npz", batch=8, minutes=3.0)
    record = train_perception._keep(options, _learner(), Progress(20, 61.5), {"seed": 0})
    assert record == {"seed": 0, "steps": 20, "frames": 160, "minutes": 3.0}
    empty = jax.tree.map(np.zeros_like, _learner())
    learner, progress = train_perception._read_state(options.state, empty)
    assert progress == Progress(20, 61.5)
    assert jax.tree.structure(learner) == jax.tree.structure(empty)
    assert all((a == b).all() for a, b in zip(jax.tree.leaves(learner), jax.tree.leaves(_learner()), strict=True))
    with pytest.raises(ValidationError, match="another network"):
        train_perception._read_state(options.state, _learner(5))
    options.state.write_text("nothing")
    with pytest.raises(ValidationError, match="no state of this training"):
        train_perception._read_state(options.state, empty)


def test_the_rate_rises_and_ends_at_zero():
    rates = [train_perception.rate_at(x, 2e-3) for x in np.linspace(0.0, 1.0, 101)]
    assert rates[0] == 0.0
    assert rates[-1] == pytest.approx(0.0, abs=1e-9)
    assert max(rates) == pytest.approx(2e-3)
    assert (np.diff(rates[5:]) < 0).all()


def test_a_pause_needs_a_place_to_keep_the_run(capsys: pytest.CaptureFixture[str]):
    with pytest.raises(SystemExit):
        train_perception.parse(["--train", "a", "--test", "b", "--out", "c", "--pause-after", "1"])
    assert "--state" in capsys.readouterr().err
