"""`urbanverse_mjx.progress` where standard error is no terminal."""

import multiprocessing
import re
import sys
import threading
import time

import pytest

from urbanverse_mjx import progress as module
from urbanverse_mjx.progress import Progress


@pytest.fixture
def quick_lines(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "LINE_EVERY", 0.05)


def _wait_for_lines(capsys: pytest.CaptureFixture[str], count: int) -> list[str]:
    said, limit = "", time.monotonic() + 20.0
    while said.count("\n") < count and time.monotonic() < limit:
        time.sleep(0.02)
        said += capsys.readouterr().err
    return said.splitlines()


@pytest.mark.usefixtures("quick_lines")
def test_a_line_tells_of_the_newest_task_even_while_it_stands_still(capsys: pytest.CaptureFixture[str]) -> None:
    with Progress() as progress:
        progress.task("loading", 3)(3)
        report = progress.task("training", 204_800, 1_024, "steps", "compiling")
        lines = _wait_for_lines(capsys, 2)
        report(2_048, note="310 steps/s")
        capsys.readouterr()
        later = _wait_for_lines(capsys, 2)[-1]
    assert len(lines) >= 2
    assert all(re.fullmatch(r"training: 1,024/204,800 steps, \d+ s, compiling", line) for line in lines)
    assert re.fullmatch(r"training: 2,048/204,800 steps, \d+ s, 310 steps/s", later)


@pytest.mark.usefixtures("quick_lines")
@pytest.mark.parametrize(
    ("total", "done", "count"),
    [(1, 0, "0/1 scene"), (1, 1, "1/1 scene"), (2, 1, "1/2 scenes"), (None, 1, "1 scene"), (None, 0, "0 scenes")],
)
def test_one_of_something_is_in_the_singular(
    capsys: pytest.CaptureFixture[str], total: int | None, done: int, count: str
) -> None:
    with Progress() as progress:
        progress.task("compiling", total, done, unit="scenes")
        assert _wait_for_lines(capsys, 1)[0].startswith(f"compiling: {count}, ")


@pytest.mark.usefixtures("quick_lines")
def test_a_total_may_be_known_late(capsys: pytest.CaptureFixture[str]) -> None:
    with Progress() as progress:
        report = progress.task("frames")
        assert re.fullmatch(r"frames: 0, \d+ s", _wait_for_lines(capsys, 1)[0])
        report(2, 8)
        capsys.readouterr()
        assert re.fullmatch(r"frames: 2/8, \d+ s", _wait_for_lines(capsys, 2)[-1])


def test_short_work_prints_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    with Progress() as progress:
        progress.task("bank", 1)(1)
    assert capsys.readouterr().err == ""


@pytest.mark.usefixtures("quick_lines")
def test_quiet_work_prints_nothing_and_no_thread_is_left(capsys: pytest.CaptureFixture[str]) -> None:
    with Progress(quiet=True) as progress:
        progress.task("bank", 1)
        time.sleep(0.2)
    assert capsys.readouterr().err == ""
    with pytest.raises(ZeroDivisionError), Progress() as progress:
        progress.task("bank", 1)(1 / 0)
    assert not [t for t in threading.enumerate() if t.name == "progress"]


def _work() -> None:
    module.LINE_EVERY = 0.05
    with Progress() as progress:
        progress.task("preparing", 3)
        time.sleep(0.5)
    print("done", file=sys.stderr, flush=True)


def test_a_process_that_works_for_another_one_writes_no_lines(capfd: pytest.CaptureFixture[str]) -> None:
    process = multiprocessing.get_context("spawn").Process(target=_work)
    process.start()
    process.join(60.0)
    assert capfd.readouterr().err == "done\n"
    assert process.exitcode == 0
