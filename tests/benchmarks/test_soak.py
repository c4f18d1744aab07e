"""Long trainings: memory, open files and compiled programs stay constant."""

import itertools
import pathlib
import threading
import time

import pytest

from benchmarks import soak
from benchmarks.lib import watched_training
from urbanverse_mjx.datatypes import ValidationError


def samples(**changes: float) -> list[soak.Sample]:
    """An hour that compiles and fills in its first ten minutes; changes per sample after it, of 40."""
    found: list[soak.Sample] = []
    for k in range(240):
        late = max(k - 100, 0)
        memory = 1000.0 + 5.0 * min(k, 40) + changes.get("memory", 0.0) * late + (0.4 if k % 2 else -0.4)
        # Files of a checkpoint that is being written, seen once more than before.
        files = 8 + (k % 10 == 0) + 3 * (k == 200) + int(changes.get("files", 0.0) * late)
        compiled = min(k, 40) + int(changes.get("compiled", 0.0) * late)
        found.append((15.0 * k, memory, files, compiled, 500.0 + changes.get("device", 0.0) * late, k // 20))
    return found


def test_what_settles_is_flat_and_growth_is_measured() -> None:
    flat = soak.judged(samples())
    assert flat["ok"]
    assert flat["memory_mib"] == pytest.approx(1200.0, abs=1.0)
    assert (flat["more_files"], flat["compiled_before"], flat["compiled_after"]) == (0, 40, 0)
    assert abs(flat["memory_growth_percent"]) < 0.1
    growing = soak.judged(samples(memory=0.2))
    assert not growing["ok"]
    assert soak.verdict(flat).startswith("ok: in 59.8 min memory changed by ")
    assert soak.verdict(growing).startswith("FAILED: in 59.8 min memory changed by +2.1")
    assert growing["memory_growth_percent"] == pytest.approx(100 * 0.2 * 131 / 1200, abs=0.2)
    assert growing["slope_mib_per_hour"] == pytest.approx(0.2 * 240, rel=0.25)


@pytest.mark.parametrize("what", ["files", "compiled", "device"])
def test_each_other_growth_is_a_failure(what: str) -> None:
    assert not soak.judged(samples(**{what: 0.05}))["ok"]


def test_too_few_checkpoints_are_said() -> None:
    with pytest.raises(ValidationError, match="needed three or more"):
        soak.judged(samples()[:20])


@pytest.mark.extended
def test_a_training_that_ends_by_itself_is_said() -> None:
    with pytest.raises(ValidationError, match="ended with status 2"):
        soak.soak(300.0, ["--preset", "none"], every=0.2)


def test_a_machine_without_a_gpu_is_told_so(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(soak, "device_mib", lambda: None)
    assert soak.main(["--gpu", "--seconds", "60"]) == 2
    assert capsys.readouterr().err.startswith("error: soak: found no GPU (nvidia-smi), needed one for --gpu")


def test_memory_on_the_device_is_told_from_the_first_checkpoint_on(tmp_path: pathlib.Path) -> None:
    """Each reading replaces the one before it, and a reader never sees half of one."""
    file, ended, counted = tmp_path / "device.txt", threading.Event(), itertools.count(1)
    thread = threading.Thread(
        target=watched_training.watch, args=(file, tmp_path, lambda: float(next(counted)), 0.01, ended)
    )
    thread.start()
    try:
        time.sleep(0.2)
        assert not file.exists()
        checkpoint = tmp_path / "run" / "checkpoints" / "100"
        checkpoint.mkdir(parents=True)
        (checkpoint / "policy.json").touch()
        found = list[float]()
        while not found or found[-1] < 5.0:
            found += [float(file.read_text())] if file.exists() else []
            assert thread.is_alive()
        assert found == sorted(found)
    finally:
        ended.set()
        thread.join(10.0)
    assert not thread.is_alive()


@pytest.mark.gpu
def test_a_training_on_a_gpu_keeps_memory_files_and_programs() -> None:
    found = soak.soak(gpu=True)
    assert found["ok"], found
    assert found["device_mib"] > 0.0


@pytest.mark.slow
def test_a_training_of_twenty_minutes_keeps_memory_files_and_programs() -> None:
    found = soak.soak(1200.0)
    assert found["ok"], found
