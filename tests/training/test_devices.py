"""A student trained on two devices is the one that a single device trains with the same number of envs."""

import json
import os
import pathlib
import subprocess
import sys

import jax
import jax.numpy as jnp
import pytest

from tests.training.test_student import seeing_env
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs import wrap_for_training
from urbanverse_mjx.training import dagger
from urbanverse_mjx.training.devices import Devices

ROOT = pathlib.Path(__file__).parents[2]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("stage", "engine"), [("imitation", "unicycle"), ("finetune", "unicycle"), ("imitation", "warp")]
)
def test_two_devices_train_what_one_trains(
    small_bank: SceneBank, tmp_path: pathlib.Path, stage: str, engine: str
) -> None:
    small_bank.save(tmp_path / "bank.npz")
    flags = "--xla_force_host_platform_device_count=2"
    command = [
        sys.executable,
        "-m",
        "tests.support.train_student_on_devices",
        str(tmp_path / "bank.npz"),
        stage,
        engine,
    ]
    env = {**os.environ, "JAX_PLATFORMS": "cpu", "PYTHONPATH": str(ROOT), "XLA_FLAGS": flags}
    done = subprocess.run([*command, str(tmp_path)], cwd=ROOT, env=env, capture_output=True, text=True, timeout=900)
    assert done.returncode == 0, done.stderr[-3000:]
    found = json.loads(done.stdout.splitlines()[-1])
    assert found["devices"] == found["actor_devices"] + 1 == 2
    assert found["envs_by_device"] == [4, 4]
    # Sums of other order, not other gradients: their mean over half of the envs differs as much as training moves.
    assert found["moved"] > 1e-3
    assert found["apart"] < 0.02 * found["moved"]
    assert found["metrics_apart"] < 1e-3
    assert found["resumed_apart"] == 0.0
    assert found["copies_apart"] == 0.0


def test_shares_that_are_not_equal_are_refused(small_bank: SceneBank) -> None:
    three = Devices(tuple(jax.devices()[:1]) * 3)
    env = seeing_env(small_bank)
    wrapped = wrap_for_training(env, env.config.episode_length)
    config = dagger.default_dagger_config()
    config.update({"num_envs": 8, "minibatches": 2})
    with pytest.raises(ValidationError, match="found 8, needed a multiple of 3 devices x 2 minibatches"):
        dagger.Dagger(wrapped, lambda *_: None, config, devices=three)  # type: ignore[arg-type]


def test_one_device_adds_nothing() -> None:
    alone = Devices(tuple(jax.devices()[:1]))
    values, key = jnp.arange(6.0), jax.random.key(3)
    assert alone.rows(values) is alone.mean(values) is alone.sum(values) is alone.place(values, None) is values
    assert alone.own_key(key) is key
