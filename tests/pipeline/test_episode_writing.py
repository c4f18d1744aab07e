"""Episodes that are encoded in several threads are written in their order, and none that was added is lost."""

import pathlib
import threading
import time
from typing import Any, cast

import numpy as np
import pytest

from tests.datasets.test_writer import frames_of
from urbanverse_mjx.datasets.video import encode, write_mp4
from urbanverse_mjx.pipeline.recording.cameras import FRONT
from urbanverse_mjx.pipeline.recording.driving import Driven
from urbanverse_mjx.pipeline.recording.encoding import Encoding, EpisodeWriting, Filmed

COUNT = 12
DRAWN = {"rgb": [np.zeros((2, 4, 4, 3), np.uint8)]}
SIZE = DRAWN["rgb"][0].nbytes


def driven(number: int) -> Driven:
    return Driven(0, number, 0, cast(Any, None), "goal", 1.0)


def filmed(episode: Driven, _: Any) -> Filmed:
    return Filmed(episode, b"", {}, {}, [])


def test_the_order_is_kept_and_encoding_runs_at_once() -> None:
    """Four at a time: a barrier that fewer threads could not pass; the first of each four is the slowest."""
    barrier = threading.Barrier(4, timeout=30)

    def slowly(episode: Driven, drawn: Any) -> Filmed:
        barrier.wait()
        time.sleep(0.02 * (3 - episode.row % 4))
        return filmed(episode, drawn)

    written: list[int] = []
    with EpisodeWriting(slowly, lambda x: written.append(x.driven.row), 4) as writing:
        for k in range(COUNT):
            writing.add(driven(k), DRAWN)
    assert written == list(range(COUNT))


def test_no_more_waits_than_is_allowed() -> None:
    """The fourth add returns only after an episode is written; one that is larger than the limit passes alone."""
    go, added, written = threading.Semaphore(0), threading.Semaphore(0), []

    def write(episode: Filmed) -> None:
        assert go.acquire(timeout=30)
        written.append(episode.driven.row)

    def as_large(episode: Driven, drawn: Any) -> Filmed:
        return Filmed(episode, b"", {}, {}, [], scans=drawn["rgb"])

    def add_all() -> None:
        with EpisodeWriting(as_large, write, 2, waiting=3 * SIZE) as writing:
            for k in range(5):
                writing.add(driven(k), {"rgb": DRAWN["rgb"] * (5 if k == 4 else 1)})
                added.release()

    thread = threading.Thread(target=add_all)
    thread.start()
    for _ in range(3):
        assert added.acquire(timeout=30)
    assert not added.acquire(timeout=0.2)
    go.release()
    assert added.acquire(timeout=30)
    assert not added.acquire(timeout=0.2)
    go.release(4)
    thread.join(30)
    assert written == list(range(5))


def test_an_encoded_episode_makes_room_before_it_is_written() -> None:
    """While files are written, drawing goes on: the images waiting are a twelfth of those drawn."""
    go, written = threading.Event(), []

    def write(episode: Filmed) -> None:
        assert go.wait(timeout=60)
        written.append(episode.driven.row)

    def smaller(episode: Driven, _: Any) -> Filmed:
        half = b"0" * (SIZE // 24)
        return Filmed(episode, half, {"depth": [half[1:], b"0"]}, {}, [])

    with EpisodeWriting(smaller, write, 2, waiting=2 * SIZE) as writing:
        for k in range(COUNT):
            writing.add(driven(k), DRAWN)
        assert written == []
        # Twelve more, of a twelfth each, are as much as may wait beside the one that is drawn.
        blocked = threading.Thread(target=lambda: [writing.add(driven(k), DRAWN) for k in range(COUNT, 3 * COUNT)])
        blocked.start()
        blocked.join(0.5)
        assert blocked.is_alive()
        go.set()
        blocked.join(60)
    assert written == list(range(3 * COUNT))


@pytest.mark.parametrize("where", ["encode", "write"])
def test_a_failure_reaches_the_block_and_ends_the_writing(where: str) -> None:
    written: list[int] = []

    def fails(name: str, row: int) -> None:
        if name == where and row == 3:
            raise OSError("full")

    def encoded(episode: Driven, drawn: Any) -> Filmed:
        fails("encode", episode.row)
        return filmed(episode, drawn)

    def write(episode: Filmed) -> None:
        fails("write", episode.driven.row)
        written.append(episode.driven.row)

    def add(count: int) -> None:
        with EpisodeWriting(encoded, write, 2, waiting=2 * SIZE) as writing:
            for k in range(count):
                writing.add(driven(k), DRAWN)

    for count in (100, 4):  # at an add, and at the end
        written.clear()
        with pytest.raises(OSError, match="full"):
            add(count)
        assert written == [0, 1, 2]


def test_waiting_ends_when_all_is_written() -> None:
    written: list[int] = []

    def write(episode: Filmed) -> None:
        time.sleep(0.02)
        if episode.driven.row == 7:
            raise OSError("full")
        written.append(episode.driven.row)

    def add() -> None:
        with EpisodeWriting(filmed, write, 2) as writing:
            for k in range(5):
                writing.add(driven(k), DRAWN)
            writing.wait()
            assert written == list(range(5))
            writing.add(driven(7), DRAWN)
            writing.wait()
            written.append(-1)

    with pytest.raises(OSError, match="full"):
        add()
    assert written == list(range(5))


def test_after_an_interrupt_what_was_added_is_written() -> None:
    written: list[int] = []

    def write(episode: Filmed) -> None:
        time.sleep(0.01)
        written.append(episode.driven.row)

    def add() -> None:
        with EpisodeWriting(filmed, write, 2) as writing:
            for k in range(COUNT):
                writing.add(driven(k), DRAWN)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        add()
    assert written == list(range(COUNT))


def test_a_video_of_parts_is_the_video_of_the_frames(tmp_path: pathlib.Path) -> None:
    """Frames of growing brightness in two parts; statistics count every fourth."""
    levels = np.arange(20, 180, 20)
    frames = np.broadcast_to(levels.astype(np.uint8)[:, None, None, None], (8, 24, 32, 3))
    drawn = {"rgb": [frames[:3], frames[3:]]}
    found = Encoding(5, ())(driven(0), drawn)
    assert found.video == encode(iter(frames), 24, 32, 5)
    write_mp4(tmp_path / "a.mp4", [found.video], 5)
    shown = [image.mean() for _, image in frames_of(tmp_path / "a.mp4")]
    np.testing.assert_allclose(shown, levels, atol=2)
    np.testing.assert_allclose(found.stats[FRONT]["mean"].ravel(), (20 + 100) / 2 / 255)
    assert found.stats[FRONT]["count"] == [2]
