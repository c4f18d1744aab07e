"""`Ahead`: items come in order from a thread of their own, which stays a few ahead and ends with the block."""

import threading
import time
from collections.abc import Iterator

import pytest

from urbanverse_mjx.pipeline.recording.ahead import Ahead


def counted(made: list[int], number: int = 1000) -> Iterator[int]:
    for k in range(number):
        made.append(k)
        yield k


def test_it_works_while_the_block_does_and_stays_a_few_ahead() -> None:
    made: list[int] = []
    with Ahead(counted(made), 3) as ahead:
        items = iter(ahead)
        end = time.monotonic() + 20.0
        while len(made) < 4 and time.monotonic() < end:
            time.sleep(0.01)
        time.sleep(0.3)
        assert made == [0, 1, 2, 3], "three wait, and the fourth is held by the thread"
        assert [next(items) for _ in range(2)] == [0, 1]
    # The block has ended: nothing more is made.
    count = len(made)
    time.sleep(0.3)
    assert len(made) == count <= 7
    assert not any(thread.name == "ahead" for thread in threading.enumerate())


def test_all_items_come_in_order_and_then_it_ends() -> None:
    with Ahead(counted([], 50), 2) as ahead:
        assert list(ahead) == list(range(50))


def test_a_failure_comes_after_the_items_before_it() -> None:
    def failing() -> Iterator[int]:
        yield 1
        raise OSError("the disk is full")

    seen: list[int] = []

    def take() -> None:
        with Ahead(failing()) as ahead:
            for item in ahead:
                seen.append(item)

    with pytest.raises(OSError, match="the disk is full"):
        take()
    assert seen == [1]


def test_an_error_of_the_block_ends_the_thread_within_an_item() -> None:
    begun, made = threading.Event(), list[int]()

    def slow() -> Iterator[int]:
        for k in range(1000):
            begun.set()
            time.sleep(0.05)
            made.append(k)
            yield k

    def interrupted() -> None:
        with Ahead(slow(), 100):
            begun.wait(20.0)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert len(made) <= 3
    assert not any(thread.name == "ahead" for thread in threading.enumerate())
