"""Training over several processes, as on several hosts, and over several devices of one."""

import inspect
import json
import os
import pathlib
import re
import socket
import subprocess
import sys

import jax
import pytest

from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.training.config import default_ppo_config
from urbanverse_mjx.training.devices import Devices
from urbanverse_mjx.training.policy import load_policy
from urbanverse_mjx.training.run import check_shares, join_processes

ROOT = pathlib.Path(__file__).parents[2]


def start(arguments: list[str], **environment: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "tests.support.train_together", *arguments]
    env = {**os.environ, "JAX_PLATFORMS": "cpu", "PYTHONPATH": str(ROOT), **environment}
    return subprocess.Popen(command, cwd=ROOT, env=env, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def answer(process: subprocess.Popen[str]) -> dict[str, object]:
    out, error = process.communicate(timeout=300)
    assert process.returncode == 0, error[-3000:]
    return json.loads(out.splitlines()[-1])


@pytest.fixture
def bank_file(small_bank: SceneBank, tmp_path: pathlib.Path) -> str:
    small_bank.save(tmp_path / "bank.npz")
    return str(tmp_path / "bank.npz")


@pytest.mark.slow
def test_two_processes_train_one_policy(bank_file: str, tmp_path: pathlib.Path) -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        coordinator = f"127.0.0.1:{free.getsockname()[1]}"
    folders = [tmp_path / "run0", tmp_path / "run1"]
    both = [start([bank_file, str(folders[i]), coordinator, "2", str(i)], XLA_FLAGS="") for i in range(2)]
    found = [answer(process) for process in both]
    for i in range(2):
        expected = {"process": i, "devices": 2, "sum_over_devices": 2.0, "steps": 1024, "wrote_policy": i == 0}
        assert found[i] == expected
    assert load_policy(folders[0])[1].steps == 1024
    assert not folders[1].exists(), "only the first process writes"


@pytest.mark.slow
def test_two_devices_of_one_process(bank_file: str, tmp_path: pathlib.Path) -> None:
    flags = "--xla_force_host_platform_device_count=2"
    found = answer(start([bank_file, str(tmp_path / "run")], XLA_FLAGS=flags))
    assert found == {"process": 0, "devices": 2, "sum_over_devices": 2.0, "steps": 1024, "wrote_policy": True}
    assert load_policy(tmp_path / "run")[1].steps == 1024


@pytest.mark.parametrize(
    ("variables", "gpus"),
    [
        ({}, []),
        ({"SLURM_NTASKS": "2", "SLURM_STEP_NUM_NODES": "2"}, []),
        ({"SLURM_NTASKS": "8", "SLURM_STEP_NUM_NODES": "2"}, None),
        ({"SLURM_NTASKS": "2", "SLURM_STEP_NUM_NODES": "2", "JAX_LOCAL_DEVICE_IDS": "0,1"}, None),
        ({"OMPI_COMM_WORLD_SIZE": "2", "OMPI_COMM_WORLD_LOCAL_SIZE": "1"}, []),
        ({"OMPI_COMM_WORLD_SIZE": "2", "OMPI_COMM_WORLD_LOCAL_SIZE": "2"}, None),
    ],
)
@pytest.mark.parametrize("arguments", [("auto", None, None), ("127.0.0.1:7777", 2, 0)])
def test_a_process_that_has_a_host_to_itself_has_all_its_gpus(
    variables: dict[str, str],
    gpus: list[int] | None,
    arguments: tuple[str, int | None, int | None],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """JAX restricts a process to its devices in a list that is not empty, and takes one itself for None."""
    for name in [name for name in os.environ if name.startswith(("SLURM_", "OMPI_", "JAX_LOCAL"))]:
        monkeypatch.delenv(name)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    # Collectives of CPUs stay as they are for the other tests of this process.
    monkeypatch.setattr(jax.config, "update", lambda *_: None)
    asked: list[inspect.BoundArguments] = []
    signature = inspect.signature(jax.distributed.initialize)
    monkeypatch.setattr(jax.distributed, "initialize", lambda *a, **k: asked.append(signature.bind(*a, **k)))
    join_processes(*arguments)
    assert [call.arguments["local_device_ids"] for call in asked] == [gpus]


@pytest.mark.parametrize(
    ("num_envs", "minibatch", "devices", "remedy"),
    [(96, 512, 5, "--num-envs 90 .*480"), (96, 512, 3, "--num-envs 90 .*480"), (96, 32, 2, "--num-envs 96 .*64")],
)
def test_shares_of_brax_ppo_that_are_not_equal_are_refused(
    num_envs: int, minibatch: int, devices: int, remedy: str
) -> None:
    config = default_ppo_config("paper")
    config.update({"num_envs": num_envs, "minibatch": minibatch})
    with pytest.raises(ValidationError, match=f"found {minibatch}, needed a multiple of {devices} devices") as error:
        check_shares(config, Devices((None,) * devices))
    found = re.search(r'--num-envs (\d+) --ppo-overrides \'\{"minibatch": (\d+)\}\', or fewer GPUs', str(error.value))
    assert found is not None
    assert re.search(remedy, str(error.value))
    # What the error proposes works.
    config.update({"num_envs": int(found[1]), "minibatch": int(found[2])})
    check_shares(config, Devices((None,) * devices))


@pytest.mark.parametrize(
    ("arguments", "word"),
    [(("host:1", None, 0), "--num-processes"), (("host", 2, 0), "HOST:PORT"), (("host:1", 2, 2), "--process-id")],
)
def test_wrong_numbers_are_refused(arguments: tuple[str, int | None, int | None], word: str) -> None:
    with pytest.raises(ValidationError, match=word):
        join_processes(*arguments)
