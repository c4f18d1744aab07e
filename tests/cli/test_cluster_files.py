"""Dry runs of the files in docs/cluster: what they start joins, with options that the command knows.

No scheduler is there: `srun` is a script that starts a process per host with the variables of Slurm, and the Kubernetes
file is compared with itself and with the command line.
"""

import json
import os
import pathlib
import subprocess
import sys
from typing import Any

import pytest
import tyro
import yaml

from urbanverse_mjx.cli.train import TrainArgs

ROOT = pathlib.Path(__file__).parents[2]
CLUSTER = ROOT / "docs" / "cluster"
SRUN = """#!/bin/bash
[ "$1" = --kill-on-bad-exit=1 ] || exit 9
shift
export SLURM_STEP_NUM_NODES=2
for i in 0 1; do SLURM_PROCID=$i SLURM_LOCALID=0 "$@" & jobs+=($!); done
for job in "${jobs[@]}"; do wait $job || exit 1; done
"""
#: In place of `urbanverse`: says what it was asked, and with JOIN whether the processes find each other.
COMMAND = """#!{python}
import json, os, sys
found = {{"argv": sys.argv[1:], "process": int(os.environ["SLURM_PROCID"])}}
if os.environ.get("JOIN"):
    import jax
    from urbanverse_mjx.training.run import join_processes
    join_processes("auto", None, None)
    found |= {{"index": jax.process_index(), "processes": jax.process_count(), "devices": jax.device_count()}}
    found |= {{"gpus": jax.config.read("jax_cuda_visible_devices")}}
sys.stdout.write(json.dumps(found) + "\\n")
"""


def submitted(tmp_path: pathlib.Path, *words: str, **environment: str) -> list[dict[str, Any]]:
    """Runs the batch file as Slurm does; returns what its two processes said."""
    venv = tmp_path / "venv" / "bin"
    venv.mkdir(parents=True)
    (venv / "activate").write_text(f'export PATH="{venv}:$PATH"\n')
    for name, text in (("srun", SRUN), ("urbanverse", COMMAND.format(python=sys.executable))):
        (venv / name).write_text(text)
        (venv / name).chmod(0o755)
    slurm = {"SLURM_JOB_ID": str(os.getpid()), "SLURM_STEP_NODELIST": "localhost", "SLURM_NTASKS": "2"}
    slurm |= {"SLURM_SUBMIT_DIR": str(tmp_path), "VENV": str(venv.parent), "PYTHONPATH": str(ROOT)}
    env = {**os.environ, **slurm, "JAX_PLATFORMS": "cpu", "XLA_FLAGS": "", **environment}
    command = ["bash", str(CLUSTER / "train.sbatch"), *words]
    done = subprocess.run(command, env=env, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr[-3000:]
    return sorted((json.loads(line) for line in done.stdout.splitlines()), key=lambda said: said["process"])


def options(words: list[str]) -> TrainArgs:
    """The options of `urbanverse train`, which exits at one that it does not know."""
    return tyro.cli(TrainArgs, args=words)


def test_slurm_starts_the_command_on_every_host(tmp_path: pathlib.Path) -> None:
    told = ["--preset", "paper", "--bank", "/shared/a bank.npz", "--num-envs", "4096"]
    said = submitted(tmp_path, *told)
    assert [x["process"] for x in said] == [0, 1]
    assert said[0]["argv"] == said[1]["argv"]
    assert said[0]["argv"][0] == "train"
    args = options(said[0]["argv"][1:])
    assert (args.coordinator, args.num_processes, args.process_id) == ("auto", None, None)
    assert (args.preset, args.bank, args.num_envs) == ("paper", pathlib.Path("/shared/a bank.npz"), 4096)
    assert args.logdir == tmp_path / "runs"
    text = (CLUSTER / "train.sbatch").read_text(encoding="utf-8")
    asked = dict(line.removeprefix("#SBATCH --").split("=") for line in text.splitlines() if line.startswith("#SBATCH"))
    assert asked["nodes"] == "2"
    assert asked["ntasks-per-node"] == "1", "a process uses all GPUs of its host"


@pytest.mark.slow
def test_processes_that_slurm_starts_find_each_other(tmp_path: pathlib.Path) -> None:
    said = submitted(tmp_path, JOIN="1")
    assert [(x["process"], x["index"], x["processes"], x["devices"]) for x in said] == [(0, 0, 2, 2), (1, 1, 2, 2)]
    assert [x["gpus"] for x in said] == ["all", "all"], "by default JAX gives each process one"


def test_kubernetes_gives_every_process_its_number_and_the_first_one_s_address() -> None:
    service, job = yaml.safe_load_all((CLUSTER / "train.yaml").read_text(encoding="utf-8"))
    assert (service["kind"], job["kind"], job["apiVersion"]) == ("Service", "Job", "batch/v1")
    spec = job["spec"]
    pod = spec["template"]["spec"]
    (container,) = pod["containers"]
    program, command, *words = container["command"]
    assert (program, command) == ("urbanverse", "train")
    assert spec["completionMode"] == "Indexed"
    # Kubernetes puts the index in place of the variable.
    index = "$(JOB_COMPLETION_INDEX)"
    assert f"--process-id={index}" in words
    found = [options([word.replace(index, str(k)) for word in words]) for k in range(spec["completions"])]
    assert [args.process_id for args in found] == list(range(spec["completions"]))
    assert {args.num_processes for args in found} == {spec["completions"]} == {spec["parallelism"]}
    # Pods of an indexed Job are called JOB-INDEX, and found as JOB-INDEX.SUBDOMAIN if a headless Service selects them.
    (coordinator,) = {args.coordinator for args in found}
    host, port = str(coordinator).split(":")
    assert host == f"{job['metadata']['name']}-0.{pod['subdomain']}"
    assert pod["subdomain"] == service["metadata"]["name"]
    assert service["spec"]["clusterIP"] == "None"
    assert service["spec"]["selector"] == {"job-name": job["metadata"]["name"]}
    assert int(port) in [p["port"] for p in service["spec"]["ports"]]
    # A process that is started again alone could not join the others.
    assert (spec["backoffLimit"], pod["restartPolicy"]) == (0, "Never")
    # What the command reads and writes lies on a volume that all mount.
    mounted = {mount["name"]: pathlib.Path(mount["mountPath"]) for mount in container["volumeMounts"]}
    assert {volume["name"] for volume in pod["volumes"]} == set(mounted)
    for path in (found[0].bank, found[0].logdir):
        assert path is not None
        assert path.is_relative_to(mounted["data"])
