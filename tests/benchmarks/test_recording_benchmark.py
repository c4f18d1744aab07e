"""The benchmark of `urbanverse record`: its rates are those of the work that was done."""

import json
import pathlib
import types
from typing import Any

import pytest

from benchmarks import recording
from tests.pipeline.test_recording import drawn_env, use
from urbanverse_mjx.datatypes import SceneBank

STEPS = 6


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
