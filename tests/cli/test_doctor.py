"""`urbanverse doctor` reports broken parts and continues."""

import json
import os
import pathlib
import subprocess
import sys

import pytest

from urbanverse_mjx.cli import doctor, doctor_checks

ROOT = pathlib.Path(__file__).parents[2]


def ask(*checks: str, path: pathlib.Path | None = None, **environment: str) -> tuple[int, dict[str, dict[str, str]]]:
    """Exit status and findings; modules in `path` shadow the installed ones."""
    places = [str(p) for p in (path, ROOT) if p]
    done = subprocess.run(
        [sys.executable, "-m", "urbanverse_mjx.cli.main", "doctor", "--json", "--only", *checks],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(places), **environment},
    )
    return done.returncode, json.loads(done.stdout)["checks"]


def test_a_sound_package_is_ok() -> None:
    status, found = ask("python", "mujoco")
    assert status == 0
    assert found["mujoco"]["status"] == "ok"
    assert "4 contacts" in found["mujoco"]["detail"]


@pytest.mark.parametrize(
    ("body", "status", "detail", "fix"),
    [
        ("raise ModuleNotFoundError('No module', name='mujoco')", "missing", "no module 'mujoco'", " -m pip install "),
        ("raise ImportError('libGL.so.1: not found')", "problem", "ImportError: libGL.so.1", "--force-reinstall"),
        ("import sys; sys.exit('no licence')", "problem", "SystemExit: no licence", "--force-reinstall"),
        ("import os; os.abort()", "problem", "killed by SIGABRT", "--force-reinstall"),
        ("print('{}')\nimport os; os._exit(3)", "problem", "ended with status 3", "--force-reinstall"),
    ],
    ids=["missing", "broken", "exits", "crashes", "lies"],
)
def test_a_broken_package_costs_one_line(body, status, detail, fix, tmp_path: pathlib.Path) -> None:
    (tmp_path / "mujoco.py").write_text(body)
    code, found = ask("python", "mujoco", path=tmp_path)
    assert code == 1
    assert found["python"]["status"] == "ok"
    assert found["mujoco"]["status"] == status
    assert detail in found["mujoco"]["detail"]
    assert fix in found["mujoco"]["fix"]
    assert "mujoco>=3.17,<3.18" in found["mujoco"]["fix"].replace("<3.18,>=3.17", ">=3.17,<3.18")


def test_what_is_not_required_does_not_fail_the_doctor(tmp_path: pathlib.Path) -> None:
    code, found = ask("python", "gpu", PATH=str(tmp_path))
    assert code == 0
    assert found["gpu"]["status"] == "missing"


def test_without_numpy_the_doctor_still_answers(tmp_path: pathlib.Path) -> None:
    (tmp_path / "numpy.py").write_text("raise ModuleNotFoundError('No module', name='numpy')")
    code, found = ask("python", "cache", "mujoco", path=tmp_path, URBANVERSE_CACHE=str(tmp_path / "cache"))
    assert code == 1
    assert (found["python"]["status"], found["cache"]["status"]) == ("ok", "ok")
    assert "numpy" in found["mujoco"]["detail"]


@pytest.mark.extended
@pytest.mark.parametrize(
    ("body", "limits", "detail"),
    [
        ("import time; time.sleep(100)", {"idle": 3.0}, "no answer, and nothing computed for 3 s"),
        ("while True: pass", {"timeout": 1.0}, "no answer after 1 s of the processor's time"),
    ],
    ids=["waits", "computes"],
)
def test_a_check_that_never_ends_is_ended(body, limits, detail, tmp_path, monkeypatch) -> None:
    (tmp_path / "mujoco.py").write_text(body)
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(tmp_path), str(ROOT)]))
    row = doctor.examine("mujoco", **limits)
    assert row.finding.status == "problem"
    assert row.finding.detail == detail


@pytest.mark.extended
def test_a_slow_check_that_computes_is_waited_for(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As on a machine that is busy with other work: long by the clock, a little of the processor's time throughout."""
    (tmp_path / "mujoco.py").write_text(
        "import time\nend = time.monotonic() + 4\nwhile time.monotonic() < end:\n    sum(range(10**6))\n"
        "    time.sleep(0.05)\nraise SystemExit('done')"
    )
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(tmp_path), str(ROOT)]))
    row = doctor.examine("mujoco", timeout=60.0, idle=2.0)
    assert row.finding.detail == "SystemExit: done"


def test_an_unwritable_cache_is_a_problem_with_its_fix(tmp_path: pathlib.Path) -> None:
    (tmp_path / "file").write_text("in the way")
    code, found = ask("cache", URBANVERSE_CACHE=str(tmp_path / "file" / "cache"))
    assert code == 1
    assert "cannot be written" in found["cache"]["detail"]
    assert "export URBANVERSE_CACHE=" in found["cache"]["fix"]


@pytest.mark.parametrize(
    ("nvidia_smi", "status", "detail"),
    [
        (None, "missing", "no NVIDIA GPU"),
        ("exit 9", "missing", "no NVIDIA GPU"),
        ("echo 'NVIDIA H200, 570.12, 143771 MiB'", "problem", "1 x NVIDIA H200, 143771 MiB, driver 570.12"),
        ("echo 'NVIDIA H200, 580.65, 143771 MiB'; echo 'NVIDIA H200, 580.65, 143771 MiB'", "ok", "2 x NVIDIA H200"),
    ],
    ids=["no program", "no driver", "old driver", "two"],
)
def test_gpu_is_read_from_nvidia_smi(nvidia_smi, status, detail, tmp_path, monkeypatch) -> None:
    if nvidia_smi is not None:
        program = tmp_path / "nvidia-smi"
        program.write_text(f"#!/bin/sh\n{nvidia_smi}\n")
        program.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    found = doctor_checks.check_gpu()
    assert found.status == status
    assert detail in found.detail
    assert bool(found.fix) == (status == "problem")


def test_a_line_says_the_fix_below_the_problem() -> None:
    rows = [
        doctor.Row("jax", True, doctor_checks.Finding("missing", "no module 'jax'", "pip install jax")),
        doctor.Row("gpu", False, doctor_checks.Finding("missing", "no NVIDIA GPU", "")),
    ]
    lines = "\n".join(doctor.line(row) for row in rows).splitlines()
    assert lines[0].split() == ["jax", "missing", "no", "module", "'jax'"]
    assert lines[1].split() == ["fix:", "pip", "install", "jax"]
    assert lines[2].split()[:2] == ["gpu", "absent"]
    assert not doctor.able(rows)
    assert doctor.able(rows[1:])
