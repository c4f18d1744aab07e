"""The benchmark of `urbanverse record`: its rates are those of the work that was done."""

import json
import pathlib
import threading
import time
import types
from typing import Any

import pytest

from benchmarks import recording
from tests.pipeline.test_recording import drawn_env, use
from urbanverse_mjx.datatypes import SceneBank

STEPS = 6


@pytest.mark.extended
def test_each_case_is_a_row(
    small_bank: SceneBank, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    use(drawn_env(small_bank, {"episode_length": STEPS}), monkeypatch)
    clock = iter(range(1000))
    monkeypatch.setattr(recording, "time", types.SimpleNamespace(perf_counter=lambda: float(next(clock))))
    said: list[dict[str, Any]] = []

    def recorded(folder: pathlib.Path, options: Any) -> dict[str, Any]:
        """Four seconds to compile, and then one for 10 frames."""
        folder.mkdir()
        (folder / "file").write_bytes(b"0" * 1000 * options.num_episodes)
        said.append({"frames": options.num_episodes * STEPS, "seconds": 4.0 + options.num_episodes * STEPS / 10})
        return said[-1]

    monkeypatch.setattr(recording.pipeline, "record", recorded)
    out = tmp_path / "rows.jsonl"
    words = ["--cases", "24x32@2,24x32@3", "--num-episodes", "3,5", "--with", "boxes", "--append", str(out)]
    status = recording.main([*words, "--disk", str(tmp_path / "disk")])
    rows = [json.loads(line) for line in out.read_text().splitlines()]
    assert status == 0, rows
    assert capsys.readouterr().out == out.read_text()
    assert [row["num_envs"] for row in rows] == [2, 3]
    # The clock is asked twice a part, so that each takes a second.
    for row in rows:
        for part in ("drive", "draw", "encode", "write", "bound"):
            assert row[f"{part}_frames_per_s"] == 3 * STEPS
        for part in ("drive", "draw", "encode", "write"):
            assert 0.0 <= row[f"{part}_processor_ms"] < 1e5
        assert row["frames_per_s"] == 10.0
        assert row["kilobytes_per_frame"] == round(1 / STEPS, 2)
    assert list((tmp_path / "disk").iterdir()) == []


def test_one_recording_is_timed_by_its_files(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Frames are on disk at known times; the first tenth of them, and what comes before, are not counted."""
    now, seen = [0.0], threading.Semaphore(0)
    monkeypatch.setattr(recording, "time", types.SimpleNamespace(perf_counter=lambda: now[0]))

    def busy() -> dict[str, float]:
        seen.release()
        return {"encode": 3.0 * now[0], "ffmpeg": 0.5 * now[0] ** 2}

    def recorded(folder: pathlib.Path, options: Any) -> dict[str, Any]:
        assert options.num_episodes == 7
        (folder / "meta").mkdir(parents=True)
        for seconds, frames in ((8.0, 1), (10.0, 10), (11.0, 55), (15.0, 100)):
            now[0] = seconds
            part = folder / "part"
            part.write_text(json.dumps({"total_frames": frames}))
            part.replace(folder / "meta/info.json")
            assert seen.acquire(timeout=60.0)
        return {"frames": 100, "seconds": 15.0, "results": {}}

    monkeypatch.setattr(recording.pipeline, "record", recorded)
    monkeypatch.setattr(recording, "ThreadTimes", lambda: busy)
    assert recording.main(["--once", "--cases", "24x32@2", "--num-episodes", "7", "--disk", str(tmp_path)]) == 0
    row = json.loads(capsys.readouterr().out)
    assert (row["num_episodes"], row["frames"]) == (7, 100)
    assert (row["counted_frames"], row["counted_seconds"], row["frames_per_s"]) == (90, 5.0, 18.0)
    assert row["cores"] == {"encode": 3.0, "ffmpeg": 12.5}
    with pytest.raises(SystemExit, match="needed lerobot"):
        recording.main(["--once", "--formats", "coco"])


def test_the_processor_time_of_each_thread_is_told_by_its_name() -> None:
    ended, times = threading.Event(), recording.ThreadTimes()

    def work() -> None:
        end = time.thread_time() + 0.5
        while time.thread_time() < end:
            pass
        ended.wait()

    threads = [threading.Thread(target=work, name=f"worker_{number}", daemon=True) for number in range(2)]
    before = times()
    for thread in threads:
        thread.start()
    deadline = time.monotonic() + 120.0
    while times().get("worker", 0.0) < 0.9:
        assert time.monotonic() < deadline
        time.sleep(0.05)
    ended.set()
    for thread in threads:
        thread.join()
    found = times()
    assert 0.9 <= found["worker"] < 1.3, "that of ended threads stays"
    assert found["MainThread"] >= before["MainThread"]
    assert found["other"] > -1.0
    assert "ffmpeg" in found


def test_a_case_that_fails_is_a_row_with_its_error(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(recording, "parts", lambda *_: {}["no such part"])
    assert recording.main(["--disk", str(tmp_path)]) == 1
    assert json.loads(capsys.readouterr().out)["error"] == "KeyError: 'no such part'"
    with pytest.raises(SystemExit, match="needed two numbers"):
        recording.main(["--num-episodes", "3,3"])
    with pytest.raises(SystemExit, match="at least the 32 envs"):
        recording.main(["--cases", "24x32@32", "--num-episodes", "31,64"])
