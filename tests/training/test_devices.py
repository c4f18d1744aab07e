"""A student trained on two devices is the one that a single device trains with the same number of envs."""

import json
import os
import pathlib
import socket
import subprocess
import sys

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.support.unicycle import unicycle_env
from tests.training.test_student import OVERRIDES, seeing_env
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs import wrap_for_training
from urbanverse_mjx.training import dagger, finetune
from urbanverse_mjx.training.devices import EQUAL, Devices
from urbanverse_mjx.training.policy import load_student
from urbanverse_mjx.training.record import RunRecord

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


@pytest.mark.slow
def test_two_processes_train_and_resume_what_one_does(small_bank: SceneBank, tmp_path: pathlib.Path) -> None:
    small_bank.save(tmp_path / "bank.npz")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        coordinator = f"127.0.0.1:{free.getsockname()[1]}"
    command = [sys.executable, "-m", "tests.support.train_student_together", str(tmp_path / "bank.npz")]
    env = {**os.environ, "JAX_PLATFORMS": "cpu", "PYTHONPATH": str(ROOT), "XLA_FLAGS": ""}

    def start(folder: str, *together: str) -> subprocess.Popen[str]:
        words = [*command, str(tmp_path / folder), *together]
        return subprocess.Popen(words, cwd=ROOT, env=env, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    both = [start("both", coordinator, "2", str(k)) for k in range(2)]
    found = []
    for process in (*both, start("alone")):
        out, error = process.communicate(timeout=900)
        assert process.returncode == 0, error[-3000:]
        found.append(json.loads(out.splitlines()[-1]))
    names = [f"{steps:012d}" for steps in (64, 128)]
    assert found[0] == {"process": 0, "devices": 2, "policies": names}
    # One folder, which the first process writes.
    assert found[1] == {"process": 1, "devices": 2, "policies": [None, None]}
    assert found[2] == {"process": 0, "devices": 1, "policies": names}
    assert [s["from_steps"] for s in RunRecord.load(tmp_path / "both").segments] == [0, 64]
    leaves = {
        (run, name): np.concatenate(
            [np.asarray(x).ravel() for x in jax.tree.leaves(load_student(tmp_path / run / "checkpoints" / name))]
        )
        for run in ("both", "alone")
        for name in names
    }
    moved = np.abs(leaves["alone", names[1]] - leaves["alone", names[0]]).max()
    assert moved > 1e-3
    for name in names:
        # Policies are stored in half precision.
        np.testing.assert_allclose(leaves["both", name], leaves["alone", name], atol=0.05 * moved, rtol=1e-3)


def test_shares_that_are_not_equal_are_refused(small_bank: SceneBank) -> None:
    three = Devices(tuple(jax.devices()[:1]) * 3)
    env = seeing_env(small_bank)
    wrapped = wrap_for_training(env, env.config.episode_length)
    config = dagger.default_dagger_config()
    config.update({"num_envs": 8, "minibatches": 2})
    needed = "found 8, needed a multiple of 3 devices x 2 minibatches"
    with pytest.raises(ValidationError, match=rf"{needed} \(ppo\.minibatches\); take --num-envs 6, or fewer GPUs"):
        dagger.Dagger(wrapped, lambda *_: None, config, devices=three)  # type: ignore[arg-type]
    ppo = finetune.default_finetune_config()
    ppo.update({"num_envs": 8, "minibatches": 2})
    with pytest.raises(ValidationError, match=rf"{needed} \(ppo\.finetune\.minibatches\)"):
        finetune.Finetune(wrapped, lambda *_: None, config, ppo, devices=three)  # type: ignore[arg-type]


def test_the_number_of_envs_that_is_proposed_fits_all_stages() -> None:
    stages = {"ppo.minibatches": 8, "ppo.finetune.minibatches": 12}
    for count in range(1, 9):
        devices = Devices((None,) * count)
        with pytest.raises(ValidationError, match=r"\(ppo\.minibatches, ppo\.finetune\.minibatches\)") as error:
            devices.check_shares(4097, stages)
        words = str(error.value).replace(",", " ").replace(".", " ").split()
        devices.check_shares(int(words[words.index("--num-envs") + 1]), stages)
        assert ("CUDA_VISIBLE_DEVICES" in words) == (count > 1)
    with pytest.raises(ValidationError, match=r"ppo\.minibatches"):
        Devices((None,)).check_shares(8, {"ppo.minibatches": 0})


def test_episodes_drawn_by_their_success_rates_need_one_device(small_bank: SceneBank) -> None:
    env = unicycle_env(small_bank, {**OVERRIDES, "schedule.learnable": 0.5}, vision=True)
    wrapped = wrap_for_training(env, env.config.episode_length)
    config = dagger.default_dagger_config()
    config.update({"num_envs": 8, "minibatches": 2})
    two = Devices(tuple(jax.devices()[:1]) * 2)
    with pytest.raises(ValidationError, match=r"schedule\.learnable: found it together with 2 devices"):
        dagger.Dagger(wrapped, lambda *_: None, config, devices=two)  # type: ignore[arg-type]
    alone = Devices(tuple(jax.devices()[:1]))
    dagger.Dagger(wrapped, lambda *_: None, config, devices=alone)  # type: ignore[arg-type]


def test_one_device_adds_nothing() -> None:
    alone = Devices(tuple(jax.devices()[:1]))
    values, key = jnp.arange(6.0), jax.random.key(3)
    assert alone.rows(values) is alone.mean(values) is alone.sum(values) is values
    assert alone.place(values, EQUAL) is alone.local_copy(values) is values
    assert alone.own_key(key) is key
