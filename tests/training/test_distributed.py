"""Training over several processes, as on several hosts, and over several devices of one."""

import json
import os
import pathlib
import socket
import subprocess
import sys

import pytest

from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.training.policy import load_policy
from urbanverse_mjx.training.run import join_processes

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
    ("arguments", "word"),
    [(("host:1", None, 0), "--num-processes"), (("host", 2, 0), "HOST:PORT"), (("host:1", 2, 2), "--process-id")],
)
def test_wrong_numbers_are_refused(arguments: tuple[str, int | None, int | None], word: str) -> None:
    with pytest.raises(ValidationError, match=word):
        join_processes(*arguments)
