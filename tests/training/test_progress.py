"""The line that a training writes about itself while it runs."""

import pathlib
from typing import Any

import pytest
from tensorboardX.proto.event_pb2 import Event

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


def test_the_event_file_has_each_value_at_its_step(tmp_path: pathlib.Path) -> None:
    log = progress.TrainingLog(tmp_path, total=100, start=7, quiet=True)
    for step, value in ((10, 0.25), (20, 0.5)):
        log(step, {"episode/success": value})
    log.close()
    (path,) = tmp_path.glob("events.out.tfevents.*")
    body, found = path.read_bytes(), []
    while body:  # records of TensorFlow: length, its checksum, the event, its checksum
        length = int.from_bytes(body[:8], "little")
        event = Event.FromString(body[12 : 12 + length])
        found += [(event.step, value.tag, value.simple_value) for value in event.summary.value]
        body = body[16 + length :]
    success = [(step, value) for step, tag, value in found if tag == "episode/success"]
    assert success == [(17, 0.25), (27, 0.5)]
