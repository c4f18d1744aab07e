"""Training of the perception model: the clock's schedule, and going on where a run was stopped."""

import argparse
import json
import os
import pathlib
import subprocess
import sys
from typing import Any

import jax
import numpy as np
import pytest
from flax.traverse_util import flatten_dict

from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.distillation import train_perception
from urbanverse_mjx.distillation.perception_model import network, weights
from urbanverse_mjx.distillation.train_perception import Learner, Progress

ROOT = pathlib.Path(__file__).parents[2]


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


def test_a_kept_size_needs_weights_whose_size_it_keeps(capsys: pytest.CaptureFixture[str]):
    with pytest.raises(SystemExit):
        train_perception.parse(["--train", "a", "--test", "b", "--out", "c", "--keep-size"])
    assert "--init" in capsys.readouterr().err


def test_without_trials_xla_takes_the_first_suggested_algorithm_of_programs_with_convolutions():
    options = train_perception.convolution_options(0)
    assert train_perception.convolution_options(1) is None
    image, kernel = np.ones((1, 8, 8, 3), np.float32), np.ones((3, 3, 3, 4), np.float32)
    # XLA refuses options that it does not know.
    program = jax.jit(lambda x, k: jax.lax.conv(x.transpose(0, 3, 1, 2), k.transpose(3, 2, 0, 1), (1, 1), "SAME"))
    compiled = program.lower(image, kernel).compile(compiler_options=options)
    assert float(compiled(image, kernel)[0, 0, 4, 4]) == 27.0


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """Options of a network of a few channels with as many levels as the real one."""
    monkeypatch.setattr(network, "_PYRAMID", (4, 4, 4, 4))
    monkeypatch.setattr(network, "BLOCKS", (1, 2, 3, 1, 2))
    return {"classes": 4, "leaves": 3, "widths": (4, 4, 4, 4, 6)}


def _random(model: network.PerceptionNetwork, seed: int) -> Any:
    shapes = jax.eval_shape(model.init, jax.random.key(0), np.zeros((1, 32, 32, 3), np.float32))
    rng = np.random.default_rng(seed)
    return jax.tree.map(lambda x: 0.1 + 0.3 * rng.random(x.shape).astype(np.float32), dict(shapes))


def _outputs(model: network.PerceptionNetwork, variables: Any) -> list[np.ndarray]:
    images = np.random.default_rng(5).random((1, 32, 32, 3)).astype(np.float32)
    return [np.asarray(x) for x in jax.jit(model.apply)(variables, images)]


@pytest.mark.extended
def test_a_scan_over_blocks_gives_the_same_outputs_and_its_variables_come_back(small: dict[str, Any]):
    plain, scanned = (network.PerceptionNetwork(**small, blocks=network.BLOCKS, scanned=s) for s in (False, True))
    variables = _random(plain, 1)
    stacked = network.stacked(variables)
    assert jax.tree.map(np.shape, stacked) == jax.tree.map(np.shape, _random(scanned, 1))
    for a, b in zip(_outputs(plain, variables), _outputs(scanned, stacked), strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-5, atol=1e-5)
    again = network.unstacked(stacked)
    assert jax.tree.structure(again) == jax.tree.structure(variables)
    assert all((a == b).all() for a, b in zip(jax.tree.leaves(again), jax.tree.leaves(variables), strict=True))


@pytest.mark.extended
def test_a_grown_network_gives_the_outputs_of_the_smaller_one(small: dict[str, Any], monkeypatch: pytest.MonkeyPatch):
    before = network.PerceptionNetwork(**small, blocks=(1, 1, 2, 1, 1))
    after = network.PerceptionNetwork(**small, blocks=network.BLOCKS)
    variables = _random(before, 2)
    assert network.blocks_of(variables) == (1, 1, 2, 1, 1)
    monkeypatch.setattr(weights, "network", lambda: after)
    fresh = train_perception.begin(jax.random.key(3), 32, 32)
    grown = network.grown(variables, fresh)
    assert network.blocks_of(grown) == network.BLOCKS
    for a, b in zip(_outputs(before, variables), _outputs(after, grown), strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-5, atol=1e-5)
    # The new blocks can learn: their kernels are not zero.
    assert all(np.asarray(x).any() for path, x in flatten_dict(grown["params"]).items() if path[-1] == "kernel")
    with pytest.raises(ValidationError, match=r"needed at most \[1, 2, 3, 1, 2\]"):
        network.grown(_random(network.PerceptionNetwork(**small, blocks=(1, 3, 3, 1, 2)), 2), fresh)
    foreign = _random(network.PerceptionNetwork(**{**small, "leaves": 5}, blocks=(1, 1, 2, 1, 1)), 2)
    with pytest.raises(ValidationError, match="needed a part of today's network"):
        network.grown(foreign, fresh)


def test_devices_have_to_share_a_batch_evenly(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: pathlib.Path
):
    words = ["--train", str(tmp_path / "a"), "--test", str(tmp_path / "b"), "--out", str(tmp_path / "c")]
    with pytest.raises(SystemExit):
        train_perception.parse([*words, "--devices", "0"])
    assert "--devices" in capsys.readouterr().err
    monkeypatch.setattr(jax, "devices", lambda: ["a", "b", "c", "d"])
    assert train_perception.sharing(3, 9) == ["a", "b", "c"]
    assert train_perception.sharing(9, 8) == ["a", "b", "c", "d"]
    # Before any file is read.
    with pytest.raises(ValidationError, match="--batch: found 32, needed a multiple of 3, the number of devices"):
        train_perception.train(train_perception.parse([*words, "--devices", "3"]))


@pytest.mark.extended
def test_two_devices_compute_the_mean_gradient_of_their_halves():
    flags = "--xla_force_host_platform_device_count=2"
    env = {**os.environ, "JAX_PLATFORMS": "cpu", "PYTHONPATH": str(ROOT), "XLA_FLAGS": flags}
    command = [sys.executable, "-m", "tests.support.perception_step_on_devices"]
    done = subprocess.run(command, cwd=ROOT, env=env, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr[-3000:]
    found = json.loads(done.stdout.splitlines()[-1])
    assert found["devices"] == 2
    assert found["apart"] < 1e-3
    assert found["halves_apart"] > 0.1
