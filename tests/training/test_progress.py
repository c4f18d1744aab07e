"""The line that a training writes about itself while it runs."""

import pathlib
from typing import Any

import pytest

from urbanverse_mjx.training import progress


@pytest.mark.parametrize(
    ("metrics", "end"),
    [
        ({"episode/success": 0.5, "episode/hit": 0.25, "episode/timeout": 0.25}, "success 50%, hit 25%"),
        ({"episode/success": 0.5, "episode/hit": 0.25, "episode/route_completion": 0.75}, ", route 75%"),
        ({"episode/sum_reward": 3.0, "episode/length": 40.0}, "return 3.00, length 40"),
    ],
    ids=["imitation", "PPO", "gait"],
)
def test_the_line_says_what_was_measured_and_no_more(metrics, end, tmp_path: pathlib.Path, monkeypatch) -> None:
    notes: list[str] = []

    class Recorder:
        def __init__(self, quiet: bool) -> None: ...

        def start(self) -> "Recorder":
            return self

        def stop(self) -> None: ...

        def task(self, *arguments: Any) -> Any:
            return lambda done, note: notes.append(note)

    monkeypatch.setattr(progress, "Progress", Recorder)
    log = progress.TrainingLog(tmp_path, total=100)
    for step in (10, 20):
        log(step, metrics)
    log.close()
    assert len(notes) == 1
    assert notes[0].endswith(end)
